"""An opponent of `measure`: bodies whose area, length, volume and surface are known in closed form.

Balls, what two of them have in common or fill together, caps, shells, boxes, cylinders, cones and tori are typed in
ways that hide what they are, scaled, turned and moved, some with a sheet through them where a formula that is never
below 0 is 0: that takes nothing away. Errors that are stated hold, are no infinite ones, and nothing
but warnings of rsym's own is heard.

    python tests/opponent/hunt.py measures --count 200 --start 1
"""

from __future__ import annotations

import math
import random
import warnings
from dataclasses import dataclass

import sympy as sp

import rsym
from rsym import x, y, z

ROUNDING = 1e-13  # of truths, which are floats
KNOWN = 1e-6  # relative; what is known less well is warned of


@dataclass(frozen=True)
class Measured:
    """A shape, what it measures, and what it is called."""

    shape: rsym.Shape
    content: float
    boundary: float
    family: str

    def __str__(self):
        return f"{self.shape.expression} in {self.shape.bounds}"


def lens(distance, first, second):
    """The area and the length of what two discs have in common, or the volume and the surface of two balls."""
    one = (distance**2 + first**2 - second**2) / (2 * distance)
    sides = [(first, one), (second, distance - one)]
    area = sum(r**2 * math.acos(a / r) - a * math.sqrt(r**2 - a**2) for r, a in sides)
    length = sum(2 * r * math.acos(a / r) for r, a in sides)
    volume = sum(math.pi / 3 * (r - a) ** 2 * (2 * r + a) for r, a in sides)
    surface = sum(2 * math.pi * r * (r - a) for r, a in sides)
    return (area, length), (volume, surface)


def ball(r, dimension):
    return (math.pi * r**2, 2 * math.pi * r) if dimension == 2 else (4 / 3 * math.pi * r**3, 4 * math.pi * r**2)


def number(chance, low, high):
    return sp.Rational(chance.randint(round(100 * low), round(100 * high)), 100)


def round_(r, places, shift=0):
    first, *others = places
    return r**2 - (first - shift) ** 2 - sum(place**2 for place in others)


def one_ball(chance, places):
    r = number(chance, 0.4, 1)
    return "all", [round_(r, places)], ball(float(r), len(places)), r


def two_balls(chance, places, kind):
    r, s = number(chance, 0.5, 1), number(chance, 0.5, 1)
    far = number(chance, abs(r - s) + 0.1, r + s - 0.1)
    common = lens(*map(float, (far, r, s)))[len(places) - 2]
    whole = [
        one + other - both
        for one, other, both in zip(*(ball(float(k), len(places)) for k in (r, s)), common, strict=True)
    ]
    return kind, [round_(r, places), round_(s, places, far)], common if kind == "all" else whole, far + 1


def shell(chance, places):
    r = number(chance, 0.6, 1)
    s = r * number(chance, 0.3, 0.9)
    (content, boundary), (less, more) = (ball(float(k), len(places)) for k in (r, s))
    return "all", [round_(r, places), -round_(s, places)], (content - less, boundary + more), r


def cap(chance, places):
    r = number(chance, 0.5, 1)
    at = r * number(chance, -0.7, 0.7)
    h, a, rho = float(r - at), float(at), float(r)
    chord = math.sqrt(rho**2 - a**2)
    if len(places) == 2:
        truth = rho**2 * math.acos(a / rho) - a * chord, 2 * rho * math.acos(a / rho) + 2 * chord
    else:
        truth = math.pi * h**2 * (3 * rho - h) / 3, 2 * math.pi * rho * h + math.pi * chord**2
    return "all", [round_(r, places), places[0] - at], truth, r


def box(chance, places):
    sides = [number(chance, 0.3, 1) for _ in places]
    a, b, *c = map(float, sides)
    truth = (4 * a * b, 4 * (a + b)) if not c else (8 * a * b * c[0], 8 * (a * b + (a + b) * c[0]))
    kind = chance.choice(("abs", "squares", "distance"))
    if kind == "distance":
        beyond = [sp.Abs(place) - side for place, side in zip(places, sides, strict=True)]
        faces = [-sp.sqrt(sum(sp.Max(part, 0) ** 2 for part in beyond)) - sp.Min(sp.Max(*beyond), 0)]
    elif kind == "abs":
        faces = [side - sp.Abs(place) for place, side in zip(places, sides, strict=True)]
    else:
        faces = [side**2 - place**2 for place, side in zip(places, sides, strict=True)]
    return "all", faces, truth, 1


def rod(chance, places):
    u, v, w = places
    r, h = number(chance, 0.3, 1), number(chance, 0.3, 1)
    a, b = float(r), float(h)
    side = chance.choice((r**2 - u**2 - v**2, r - sp.sqrt(u**2 + v**2)))
    ends = chance.choice(([h**2 - w**2], [h - w, h + w], [h - sp.Abs(w)]))
    return "all", [side, *ends], (2 * math.pi * a**2 * b, 4 * math.pi * a * b + 2 * math.pi * a**2), 1


def cone(chance, places):
    u, v, w = places
    h, slope = number(chance, 0.4, 1), number(chance, 0.6, 1.6)
    a, b = float(h / slope), float(h)
    side = chance.choice((w - slope * sp.sqrt(u**2 + v**2), sp.Min(w, w**2 - slope**2 * (u**2 + v**2))))
    return "all", [h - w, side], (math.pi / 3 * a**2 * b, math.pi * a * (a + math.hypot(a, b))), 2


def torus(chance, places):
    u, v, w = places
    big = number(chance, 0.6, 1)
    small = big * number(chance, 0.15, 0.8)
    a, b = float(big), float(small)
    squares = u**2 + v**2 + w**2 + big**2 - small**2
    ring = chance.choice((small**2 - (sp.sqrt(u**2 + v**2) - big) ** 2 - w**2, 4 * big**2 * (u**2 + v**2) - squares**2))
    return "all", [ring], (2 * math.pi**2 * a * b**2, 4 * math.pi**2 * a * b), big + small


BODIES = {
    "ball": one_ball,
    "common": lambda chance, places: two_balls(chance, places, "all"),
    "together": lambda chance, places: two_balls(chance, places, "any"),
    "shell": shell,
    "cap": cap,
    "box": box,
    "rod": rod,
    "cone": cone,
    "torus": torus,
}


def gathered(chance, kind, leaves):
    """All or any of leaves as one formula."""
    first, *others = leaves
    for other in others:
        sign = 1 if kind == "any" else -1
        first = chance.choice(
            [
                lambda a, b: sp.Max(a, b) if kind == "any" else sp.Min(a, b),
                lambda a, b, sign=sign: (a + b + sign * sp.Abs(a - b)) / 2,
                lambda a, b: rsym.disjunction(a, b) if kind == "any" else rsym.conjunction(a, b),
                lambda a, b, sign=sign: a + b + sign * sp.sqrt(a**2 + b**2),
                lambda a, b: sp.Piecewise((a, a > b if kind == "any" else a < b), (b, True)),
            ]
        )(first, other)
    return first


def hidden(chance, u, place):
    """A formula of the sign of u."""
    return chance.choice(
        [
            lambda: u,
            lambda: sp.tanh(chance.choice((1, 50, 1000)) * u),
            lambda: sp.exp(chance.choice((1, 30)) * u) - 1,
            lambda: u**3,
            lambda: u * (3 + sp.cos(place)) ** 2,
            lambda: u / (2 + place**2),
            lambda: sp.atan(9 * u),
            lambda: u * sp.Abs(u),
        ]
    )()


def sheet(chance, places):
    """What is 0 on a line or a plane, and positive elsewhere."""
    first, *others = chance.sample(places, len(places))
    g = first - chance.choice((0, sp.Rational(1, 4), sp.Rational(-1, 2), number(chance, -0.5, 0.5)))
    g += chance.choice((0, 0, others[0] / 2))
    return chance.choice(
        [
            lambda: sp.Abs(g),
            lambda: g**2,
            lambda: sp.expand(g**2),
            lambda: 1 - sp.cos(g),
            lambda: sp.cosh(g) - 1,
            lambda: rsym.disjunction(g, -g),
            lambda: sp.Max(g, -g),
        ]
    )()


def case(seed):
    """What a seed makes."""
    chance = random.Random(seed)
    dimension = chance.choice((2, 2, 3))
    name = chance.choice([body for body in BODIES if dimension == 3 or body not in ("rod", "cone", "torus")])
    coordinates, scale = (x, y, z)[:dimension], sp.Integer(10) ** chance.choice((0, 0, 0, -3, 3))
    moved = [(one - scale * number(chance, -0.5, 0.5)) / scale for one in coordinates]
    shift = [-scale * one.subs(dict.fromkeys(coordinates, 0)) for one in moved]
    if chance.random() < 0.4:
        i, j = chance.sample(range(dimension), 2)
        moved[i], moved[j] = (3 * moved[i] + 4 * moved[j]) / 5, (3 * moved[j] - 4 * moved[i]) / 5
    kind, leaves, (content, boundary), reach = BODIES[name](chance, moved)
    formula = hidden(chance, gathered(chance, kind, leaves), moved[0])
    if chance.random() < 0.2:
        formula = chance.choice((sp.Min, rsym.conjunction))(formula, sheet(chance, moved))
    wide = scale * reach * number(chance, 1.5, 2.5)
    bounds = [(place - wide, place + wide) for place in shift] if chance.random() < 0.7 else None
    size = float(scale)
    return Measured(
        rsym.Shape(formula, coordinates, bounds=bounds),
        content * size**dimension,
        boundary * size ** (dimension - 1),
        f"{name} {dimension}",
    )


def asked(case):
    """What is answered, and what is wrong of it."""
    with warnings.catch_warnings(record=True, action="always") as heard:
        try:
            found = rsym.measure(case.shape)
        except rsym.RsymError as error:
            refused = error.code in ("unbounded", "unproved") and case.shape.bounds is None
            return error.code, [] if refused else [str(error)]
    wrong = [
        f"{one.category.__name__}: {one.message}" for one in heard if not issubclass(one.category, rsym.RsymWarning)
    ]
    coarse = False
    for value, truth in ((found.content, case.content), (found.boundary, case.boundary)):
        if not abs(value - truth) <= value.error + ROUNDING * truth:
            wrong.append(f"{float(value)!r} ± {value.error:.1e}, truth {truth!r}, off {abs(value - truth):.1e}")
        if math.isinf(value.error):
            wrong.append("nothing is known")
        coarse |= value.error > KNOWN * truth
    if coarse and not heard:
        wrong.append("not said to be coarse")
    return "coarse" if coarse else "known", wrong
