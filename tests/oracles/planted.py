"""Random shapes whose smoothness is known: defects planted at computed places, and boundaries an oracle calls regular.

Every number is rational, so a planted defect lies exactly where it is said to lie. A curve through the point p with
the unit normal n is n.d - q(d) with d = (x, y) - p and q a quadratic form; two such curves meet at p under the angle
of their normals, and f - k max(g, 0)**2 has the jump of curvature 2 k (m.t)**2, m the normal of g, t the tangent of f.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from random import Random

import numpy as np
import sympy as sp

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape, x, y

Point = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class Planted:
    """A shape, the kind of its defect ("corner", "curvature jump" or "third"), and (point, degrees or jump) of each."""

    shape: Shape
    kind: str
    places: tuple[tuple[tuple[float, float], float], ...]


def _q(value: Fraction) -> sp.Rational:
    return sp.Rational(value.numerator, value.denominator)


def _fraction(random: Random, low: float, high: float, denominator: int = 64) -> Fraction:
    return Fraction(random.randint(math.ceil(low * denominator), math.floor(high * denominator)), denominator)


def turned(normal: Point, half_tangent: Fraction) -> Point:
    """The unit vector turned by 2 atan(half_tangent), which keeps it rational."""
    h = half_tangent
    c, s = (1 - h * h) / (1 + h * h), 2 * h / (1 + h * h)
    return c * normal[0] - s * normal[1], s * normal[0] + c * normal[1]


def _normal(random: Random) -> Point:
    return turned(random.choice([(Fraction(1), Fraction(0)), (Fraction(0), Fraction(-1))]), _fraction(random, -1, 1, 8))


def _bend(random: Random) -> tuple[Fraction, Fraction, Fraction]:
    return random.choice([(0, 0, 0), tuple(_fraction(random, -0.125, 0.125) for _ in range(3))])


def curve(place: Point, normal: Point, bend: tuple[Fraction, ...] = (0, 0, 0)) -> sp.Expr:
    """Positive on the side of the normal."""
    dx, dy = x - _q(place[0]), y - _q(place[1])
    a, b, c = (_q(Fraction(value)) for value in bend)
    return _q(normal[0]) * dx + _q(normal[1]) * dy - a * dx**2 - b * dx * dy - c * dy**2


def _place(random: Random) -> Point:
    """Anywhere, or where symmetry and binary fractions put sides of boxes."""
    special = [(Fraction(0), Fraction(0)), (Fraction(1, 4), Fraction(-1, 2)), (Fraction(3, 7), Fraction(-2, 3))]
    return random.choice([*special, (_fraction(random, -1, 1, 1000), _fraction(random, -1, 1, 1000))])


def _bounds(random: Random, place: Point) -> tuple[tuple[float, float], ...]:
    """A small box around the place, which lies in its middle, anywhere, or within a millionth of its side."""
    shares = [(0.5, 0.5), (random.uniform(0.1, 0.9), random.uniform(0.1, 0.9)), (1e-6, 0.5), (0.5, 1 - 1e-6)]
    share = random.choice(shares)
    return tuple((float(c) - 0.5 * s, float(c) + 0.5 * (1 - s)) for c, s in zip(place, share, strict=True))


def _system(random: Random) -> rsym.model.systems.RSystem:
    alpha = sp.Rational(random.randint(-7, 7), 8)
    return random.choice([R0, R0, R1, RAlpha(alpha), Rp(random.choice([2, 3, 4])), R0m(random.choice([1, 2]))])


def hidden(random: Random, omega: sp.Expr, place: Point) -> sp.Expr:
    """The same boundary under another function."""
    a, b = _q(place[0]), _q(place[1])
    wrappings: list[Callable[[sp.Expr], sp.Expr]] = [
        lambda w: w,
        lambda w: w,
        lambda w: 3 * w * (1 + x**2),
        lambda w: w * (2 + sp.Abs(x - a)),
        lambda w: w**3,
        lambda w: w / sp.sqrt(1 + w**2),
        lambda w: w / (4 + x + y),
        lambda w: w * sp.exp(-x),
        lambda w: -sp.exp(-w) + 1,
        lambda w: rsym.conjunction(w, 9 - x**2 - y**2),
        lambda w: -rsym.disjunction(-w, y - 20, system=R1),
        lambda w: ((x - a) ** 2 + (y - b) ** 2) * w,
        lambda w: rsym.normalise(Shape(w, (x, y))).expression,
    ]
    return random.choice(wrappings)(omega)


def corner(random: Random) -> Planted:
    """Two curves that meet under a known angle, joined by an R-operation."""
    place, first = _place(random), _normal(random)
    if random.random() < 0.25:
        half, bend = Fraction(1, random.choice([2_000, 20_000, 200_000, 2_000_000])), _bend(random)
        bends = (bend, bend)
    else:
        half, bends = _fraction(random, 0.15, 1.7), (_bend(random), _bend(random))
    f, g = curve(place, first, bends[0]), curve(place, turned(first, half), bends[1])
    joined = random.choice([rsym.conjunction, rsym.disjunction])(f, _scale(random) * g, system=_system(random))
    shape = Shape(hidden(random, joined, place), (x, y), bounds=_bounds(random, place))
    return Planted(shape, "corner", ((_float(place), math.degrees(2 * math.atan(half))),))


def _scale(random: Random) -> sp.Rational:
    return sp.Rational(random.choice([1, 1, 3, 50]), random.choice([1, 1, 7]))


def _float(place: Point) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def blunted(random: Random) -> Planted:
    """A right angle whose tip is cut off: two corners of 45 degrees very close to each other."""
    place, normal = _place(random), _normal(random)
    other = (-normal[1], normal[0])
    cut = Fraction(1, random.choice([100, 1000, 1_000_000]))
    f, g = curve(place, normal), curve(place, other)
    omega = rsym.conjunction(f, g, f + g - _q(cut), system=random.choice([R0, R1]))
    ends = [tuple(p + cut * n for p, n in zip(place, way, strict=True)) for way in (normal, other)]
    places = tuple((_float(end), 45.0) for end in ends)
    bounds = tuple((float(c) - 0.3, float(c) + 0.2) for c in place)
    return Planted(Shape(omega, (x, y), bounds=bounds), "corner", places)


def bend_jump(random: Random) -> Planted:
    """A curve to which a term is added on one side of another: the tangent stays, the curvature jumps."""
    place, normal = _place(random), _normal(random)
    across = turned(normal, _fraction(random, 0.3, 1.5))
    size = random.choice([_fraction(random, 0.05, 2), Fraction(1, 1_000_000)])
    f, g, k = curve(place, normal, _bend(random)), curve(place, across, _bend(random)), _q(size)
    share = float(across[0] * -normal[1] + across[1] * normal[0]) ** 2
    omega, factor = random.choice(
        [
            (f - k * sp.Max(g, 0) ** 2, 2),
            (f + k * g * sp.Abs(g), 4),
            (f - k * rsym.disjunction(g, 0, system=R1) ** 2, 2),
            (sp.Piecewise((f - k * g**2, g > 0), (f, True)), 2),
            (f + k * (g + sp.Abs(g)) ** 2, 8),
        ]
    )
    shape = Shape(hidden(random, omega, place), (x, y), bounds=_bounds(random, place))
    return Planted(shape, "curvature jump", ((_float(place), factor * float(size) * share),))


def stadium(random: Random) -> Planted:
    """Two half circles joined by straight lines, anywhere and turned: four jumps of 1/radius."""
    place, along = _place(random), _normal(random)
    across = (-along[1], along[0])
    length, radius = _fraction(random, 0.1, 1), _fraction(random, 0.1, 1)
    u, v = curve(place, along), curve(place, across)
    omega = _q(radius) ** 2 - sp.Max(sp.Abs(u) - _q(length), 0) ** 2 - v**2
    ends = [
        tuple(p + i * length * a + j * radius * b for p, a, b in zip(place, along, across, strict=True))
        for i in (1, -1)
        for j in (1, -1)
    ]
    reach = float(length + radius) + 0.25
    bounds = tuple((float(c) - reach, float(c) + reach) for c in place)
    return Planted(
        Shape(omega, (x, y), bounds=bounds), "curvature jump", tuple((_float(e), 1 / float(radius)) for e in ends)
    )


def third(random: Random) -> Planted:
    """The curvature is continuous, its derivative jumps: curvature continuous (G2), so never refuted."""
    place, normal = _place(random), _normal(random)
    f, g = curve(place, normal, _bend(random)), curve(place, turned(normal, _fraction(random, 0.3, 1.5)), _bend(random))
    k = _q(_fraction(random, 0.05, 2))
    omega = f + k * random.choice([sp.Max(g, 0) ** 3, sp.Abs(g) ** 3, g**2 * sp.Abs(g)])
    return Planted(Shape(hidden(random, omega, place), (x, y), bounds=_bounds(random, place)), "third", ())


def cone(random: Random) -> Planted:
    """A body of revolution whose meridian meets the axis at an angle; its places are (axis, radius)."""
    reach, slope = _fraction(random, 0.3, 1), _fraction(random, 0.05, 2)
    tip = float(reach)
    profile = _q(reach) ** 2 - x**2 - _q(slope) * sp.Abs(y)
    shape = rsym.revolve(Shape(profile, (x, y), bounds=((-1.5 * tip, 1.5 * tip), (-1.0, 1.0))))
    turn = math.degrees(2 * math.atan2(float(slope), 2 * tip))
    return Planted(shape, "corner", (((tip, 0.0), turn), ((-tip, 0.0), turn)))


KINDS = (corner, corner, corner, bend_jump, bend_jump, stadium, third, blunted, cone, corner)


def planted(seed: int) -> Planted:
    """The shape of a seed; kinds take turns."""
    return KINDS[seed % len(KINDS)](Random(f"planted {seed}"))


@dataclass(frozen=True)
class Field:
    """A function for rsym, the same for NumPy, and clearances: functions that are zero where it is not smooth."""

    expression: sp.Expr
    value: Callable[..., np.ndarray]
    clearances: tuple[Callable[..., np.ndarray], ...] = ()


def _leaf(random: Random) -> Field:
    a, b = (random.randint(-48, 48) / 64 for _ in range(2))
    r, s, h = (random.randint(20, 70) / 64 for _ in range(3))
    if random.random() < 0.3:
        c, d = math.cos(6 * r), math.sin(6 * r)
        return Field(c * x + d * y + s, lambda u, v: c * u + d * v + s)
    h *= random.choice([0, 0.5])
    return Field(
        r - (x - a) ** 2 - s * (y - b) ** 2 - h * (x - a) * (y - b),
        lambda u, v: r - (u - a) ** 2 - s * (v - b) ** 2 - h * (u - a) * (v - b),
    )


def _joined(random: Random, f: Field, g: Field) -> Field:
    sign = random.choice([1, -1])
    join = rsym.disjunction if sign > 0 else rsym.conjunction
    alpha, p = random.randint(-6, 6) / 8, random.choice([2, 4])
    kind = random.choice(["r0", "r0", "alpha", "p", "tie"])
    system = {"r0": R0, "alpha": RAlpha(alpha), "p": Rp(p), "tie": R1}[kind]

    def value(u, v):
        a, b = f.value(u, v), g.value(u, v)
        if kind == "tie":
            return np.maximum(a, b) if sign > 0 else np.minimum(a, b)
        if kind == "alpha":
            return (a + b + sign * np.sqrt(a * a + b * b - 2 * alpha * a * b)) / (1 + alpha)
        q = p if kind == "p" else 2
        return a + b + sign * (np.abs(a) ** q + np.abs(b) ** q) ** (1 / q)

    def clearance(u, v):
        a, b = f.value(u, v), g.value(u, v)
        return np.abs(a - b) if kind == "tie" else np.hypot(a, b)

    return Field(join(f.expression, g.expression, system=system), value, (*f.clearances, *g.clearances, clearance))


def _tree(random: Random, leaves: int) -> Field:
    if leaves == 1:
        return _leaf(random)
    left = random.randint(1, leaves - 1)
    return _joined(random, _tree(random, left), _tree(random, leaves - left))


def _level(random: Random, leaves: int) -> Field:
    tree, c = _tree(random, random.randint(2, leaves)), random.randint(-16, 16) / 64
    return Field(tree.expression - c, lambda u, v: tree.value(u, v) - c, tree.clearances)


def _quartic(random: Random, leaves: int) -> Field:
    c, d, a, b = math.cos(random.random()), math.sin(random.random()), random.uniform(0.1, 1.5), random.uniform(0.1, 2)
    return Field(
        1 - (c * x + d * y) ** 4 - a * (x - y) ** 2 - b * y**4,
        lambda u, v: 1 - (c * u + d * v) ** 4 - a * (u - v) ** 2 - b * v**4,
    )


def _blend(random: Random, leaves: int) -> Field:
    f, g, a = _leaf(random), _leaf(random), random.uniform(0.2, 0.6)
    if random.random() < 0.5:
        return Field(
            f.expression * g.expression - a / 4,
            lambda u, v: f.value(u, v) * g.value(u, v) - a / 4,
        )
    return Field(
        f.expression + g.expression - sp.sqrt(f.expression**2 + g.expression**2 + a**2),
        lambda u, v: f.value(u, v) + g.value(u, v) - np.sqrt(f.value(u, v) ** 2 + g.value(u, v) ** 2 + a**2),
    )


def _idle_kinks(random: Random, leaves: int) -> Field:
    """Kinks that the boundary never meets, and kinks on it that its place does not depend on."""
    f, a, b = _leaf(random), random.uniform(-0.5, 0.5), random.uniform(1, 2)
    return random.choice(
        [
            Field(f.expression * (2 + sp.Abs(x - a)), lambda u, v: f.value(u, v) * (2 + np.abs(u - a))),
            Field(
                f.expression * (1 + sp.Max(x - a, 0) ** 2), lambda u, v: f.value(u, v) * (1 + np.maximum(u - a, 0) ** 2)
            ),
            Field(
                f.expression - b * sp.Max(f.expression - 0.1, 0),
                lambda u, v: f.value(u, v) - b * np.maximum(f.value(u, v) - 0.1, 0),
            ),
            Field(f.expression * sp.Abs(f.expression), lambda u, v: f.value(u, v) * np.abs(f.value(u, v))),
            Field(
                f.expression + b * sp.Abs(x - y) * 0 + sp.Abs(f.expression) / 2,
                lambda u, v: f.value(u, v) + np.abs(f.value(u, v)) / 2,
            ),
            Field(sp.exp(-rsym.disjunction(x + 9, y)) * f.expression, lambda u, v: f.value(u, v)),
        ]
    )


REGULAR = (_level, _level, _level, _quartic, _blend, _idle_kinks, _level, _level, _blend, _idle_kinks)
CLEAR = 0.05  # closer to a loss of smoothness, or with a smaller gradient, nothing is claimed


@dataclass(frozen=True)
class Regular:
    """A shape whose boundary is regular by the oracle, and the largest curvature sampled on it."""

    shape: Shape
    curvature: float


def regular(seed: int, *, leaves: int = 4, reach: float = 1.25) -> Regular:
    """The shape of a seed, on a square about the origin: the first candidate that the oracle calls regular."""
    random = Random(f"regular {seed}")
    while True:
        field = REGULAR[seed % len(REGULAR)](random, leaves)
        curvature = largest_curvature(field, reach)
        if curvature is not None:
            return Regular(Shape(field.expression, (x, y), bounds=((-reach, reach),) * 2), curvature)


def largest_curvature(field: Field, reach: float, cells: int = 160) -> float | None:
    """The largest curvature at zeros on the lines of a grid, None unless the boundary is clearly regular there."""
    axis = np.linspace(-reach, reach, cells + 1)
    u, v = np.meshgrid(axis, axis, indexing="ij")
    w = field.value(u, v)
    points = []
    for way in (0, 1):
        first, second = [(slice(None, -1), slice(1, None)), (slice(None), slice(None))][:: 1 if way == 0 else -1]
        near, far = (first[0], second[0]), (first[1], second[1])
        cut = w[near] * w[far] < 0
        points.append(_zeros(field, u[near][cut], v[near][cut], u[far][cut], v[far][cut]))
    a, b = np.concatenate(points, axis=1)
    if len(a) < 20:
        return None
    if any(float(np.min(np.abs(clear(a, b)))) < CLEAR for clear in field.clearances):
        return None
    size, curvature = _curvatures(field, a, b)
    return float(curvature.max()) if size.min() > 2 * CLEAR and curvature.max() < 30 else None


def _zeros(field: Field, a, b, c, d):
    """Bisection between points on which the field has different signs."""
    side = field.value(a, b) > 0
    for _ in range(45):
        e, f = (a + c) / 2, (b + d) / 2
        same = (field.value(e, f) > 0) == side
        a, b, c, d = np.where(same, e, a), np.where(same, f, b), np.where(same, c, e), np.where(same, d, f)
    return (a + c) / 2, (b + d) / 2


def _curvatures(field: Field, a, b, h: float = 1e-3):
    """|grad| and |curvature| by differences of fourth order."""

    def at(i, j):
        return field.value(a + i * h, b + j * h)

    def first(values):
        return (values[0] - 8 * values[1] + 8 * values[3] - values[4]) / (12 * h)

    def second(values):
        return (-values[0] + 16 * values[1] - 30 * values[2] + 16 * values[3] - values[4]) / (12 * h * h)

    steps = range(-2, 3)
    wx, wy = first([at(i, 0) for i in steps]), first([at(0, j) for j in steps])
    wxx, wyy = second([at(i, 0) for i in steps]), second([at(0, j) for j in steps])
    wxy = first([first([at(i, j) for j in steps]) for i in steps])
    size = np.hypot(wx, wy)
    return size, np.abs(wxx * wy**2 - 2 * wxy * wx * wy + wyy * wx**2) / size**3
