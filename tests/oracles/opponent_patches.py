"""Paths and patches whose smoothness is known by the way they are made, and a judge of what is said of them.

A path or a pair of patches is first made smooth: one polynomial or analytic thing, cut and continued by its own Taylor
series in another parameter, moved and scaled. Then a defect of one order and a size is planted, or none. Nothing here
asks the code under test what is true.
"""

import math
import random
from dataclasses import dataclass

import sympy as sp

from rsym import Curve, continuity
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import u, v

R = sp.Rational
t = sp.Symbol("t", real=True)
CLASSES = ("broken", "G0", "G1", "G2", "G3")
SIZES = [R(1), R(1, 10**3), R(1, 10**6), R(1, 10**9), R(1, 10**12), sp.sqrt(2) / 10**4, sp.pi / 10**8]


@dataclass(frozen=True)
class Path:
    """Curves with the class of each joint, and of the whole."""

    name: str
    curves: tuple
    joints: tuple
    whole: str
    closed: bool = False

    def false(self, claim):
        """What is said wrongly of it, in words; and the verdict."""
        report = continuity(self.curves, closed=self.closed, claim=claim)
        least, wanted = CLASSES.index(self.whole), CLASSES.index(claim)
        wrong = []
        if report.verdict == "CERTIFIED" and least < wanted:
            wrong.append(f"CERTIFIED {claim}, but it is {self.whole}")
        if report.verdict == "REFUTED" and least >= wanted:
            wrong.append(f"REFUTED {claim}, but it is {self.whole}")
        if report.verdict == "DEGENERATE":
            wrong.append("DEGENERATE")
        if report.proved and CLASSES.index(report.proved) > least:
            wrong.append(f"proved {report.proved}, but it is {self.whole}")
        if len(report.joints) != len(self.joints):
            wrong.append(f"{len(report.joints)} joints of {len(self.joints)}")
        for joint, truth in zip(report.joints, self.joints, strict=False):
            smoother = CLASSES.index(joint.continuity) > CLASSES.index(truth)
            rougher = joint.kind != "smooth joint" and joint.continuity != truth
            if joint.proved and (smoother or rougher):
                wrong.append(f"a joint is proved {joint.continuity} ({joint.kind}), but it is {truth}")
        return wrong, report.verdict


def small(rng, most=8):
    return R(rng.randint(-most, most), 8 * most)


def base(rng, dimension):
    """A polynomial curve on [0, 1] with x' between 1/2 and 3/2."""
    degree = rng.randint(2, 5)
    x = t + sum(R(rng.choice((-1, 1)), 2 * degree * k * 2) * t**k for k in range(2, degree + 1))
    others = [sum(small(rng) * t**k for k in range(degree + 1)) for _ in range(dimension - 1)]
    return [x, *others]


def jets(coordinates, place, count=5):
    return [[sp.expand(sp.diff(e, t, k).subs(t, place)) for e in coordinates] for k in range(count)]


def followed(rng, coordinates, order, size):
    """What goes on from t = 1 with other speeds and, if an order is given, a jump across the tangent of that order."""
    p = jets(coordinates, 1)
    lam, mu, nu = R(rng.randint(2, 6), 4), small(rng), small(rng)
    q = [
        p[0],
        [lam * a for a in p[1]],
        [lam**2 * b + mu * a for a, b in zip(p[1], p[2], strict=True)],
        [lam**3 * c + 3 * lam * mu * b + nu * a for a, b, c in zip(*p[1:4], strict=True)],
        [small(rng) for _ in p[0]],
    ]
    if order is not None:
        # x' is positive: no multiple of the last axis is along the tangent.
        q[order][-1] += size
    return [sum(jet[axis] * t**k / sp.factorial(k) for k, jet in enumerate(q)) for axis in range(len(p[0]))]


def reparametrised(rng, coordinates, high, side):
    """The same curve on [0, 1], and whether it stands still at its end (side 1) or start (side 0)."""
    c = R(rng.randint(1, 5), 4)
    rising = [
        t,
        (t + c * t**2) / (1 + c),
        t / (1 + c * (1 - t)),
        sp.tan(sp.pi * t / 4),
        sp.log(1 + t) / sp.log(2),
        (sp.exp(t) - 1) / (sp.E - 1),
    ]
    standing = [t**2, t**3, (t**2 + t**3) / 2]
    if rng.random() < 0.25:
        by = rng.choice(standing)
        by = by if side == 0 else 1 - by.subs(t, 1 - t)
    else:
        by = rng.choice(rising)
    return [e.subs(t, high * by) for e in coordinates]


def moved(rng, *pieces):
    """All by one motion and scaling."""
    c, s = rng.choice(
        [(1, 0), (0, 1), (R(3, 5), R(4, 5)), (-1, 0), (sp.sqrt(2) / 2, sp.sqrt(2) / 2), (sp.cos(1), sp.sin(1))]
    )
    scale, shift = rng.choice([R(1), R(1, 1000), R(7, 3), sp.sqrt(3)]), small(rng)
    found = []
    for x, y, *rest in pieces:
        found.append([scale * one for one in (c * x - s * y + shift, s * x + c * y, *rest)])
    return found


def as_curve(coordinates, low=0, high=1, backwards=False):
    return Curve(coordinates, t, *((high, low) if backwards else (low, high)))


def spline_path(rng):
    """Two polynomials with a planted jump of order 0 to 3, each in a parameter of its own."""
    order = rng.choice([0, 1, 2, 3, None, None])
    size = rng.choice(SIZES)
    first = base(rng, rng.choice((2, 2, 3)))
    second = followed(rng, first, order, size)
    first, second = moved(rng, first, second)
    first, second = reparametrised(rng, first, 1, 1), reparametrised(rng, second, R(1, 8), 0)
    truth = "G3" if order is None else CLASSES[order]
    curves = as_curve(first), as_curve(second)
    if rng.random() < 0.3:
        curves = as_curve(second, backwards=True), as_curve(first, backwards=True)
    return Path(f"spline {order} {size}", curves, (truth,), truth)


def arc_path(rng):
    """Lines and arcs that touch, closed or not."""
    radius = rng.choice([R(1), R(5, 3), sp.sqrt(2), sp.pi])
    other = radius * (1 + rng.choice([0, *SIZES]))
    first = [radius * sp.sin(t), radius - radius * sp.cos(t)]
    second = [other * sp.sin(t), other - other * sp.cos(t)]
    line, cubic = [t, R(0)], [t, t**3 / 6]
    pairs = {
        "arcs": (first, second, "G1" if other != radius else "G3"),
        "line and arc": (line, second, "G1"),
        "line and spiral": (line, cubic, "G2"),
        "lines": (line, line, "G3"),
        "spirals": (cubic, cubic, "G3"),
    }
    name = rng.choice(sorted(pairs))
    *pieces, truth = pairs[name]
    before, after = moved(rng, *pieces)
    return Path(name, (as_curve(before, R(-1, 2), 0), as_curve(after, 0, R(1, 2))), (truth,), truth)


def closed_path(rng):
    """A stadium, or a circle of three arcs, one of them shifted or not."""
    radius = rng.choice([R(1), sp.sqrt(2), R(1, 7)])
    if rng.random() < 0.5:
        length = rng.choice([R(1), sp.sqrt(5), R(1, 10**6)])
        pieces = [
            ([t, -radius], -length, length),
            ([length + radius * sp.cos(t), radius * sp.sin(t)], -sp.pi / 2, sp.pi / 2),
            ([-t, radius], -length, length),
            ([-length + radius * sp.cos(t), radius * sp.sin(t)], sp.pi / 2, 3 * sp.pi / 2),
        ]
        truths = ("G1",) * 4
    else:
        size = rng.choice([0, *SIZES])
        third = 2 * sp.pi / 3
        pieces = [([radius * sp.cos(t), radius * sp.sin(t)], k * third, (k + 1) * third) for k in range(3)]
        pieces[1] = ([pieces[1][0][0] + size, pieces[1][0][1]], *pieces[1][1:])
        truths = ("broken", "broken", "G3") if size else ("G3",) * 3
    coordinates = moved(rng, *(piece[0] for piece in pieces))
    curves = tuple(as_curve(one, *piece[1:]) for one, piece in zip(coordinates, pieces, strict=True))
    return Path("closed", curves, truths, min(truths, key=CLASSES.index), closed=True)


def inner_path(rng):
    """A curve with a cusp or an inflection of its parameter inside, and its own continuation."""
    place = rng.choice([R(0), R(1, 3), sp.sqrt(2) / 4])
    h = t - place
    kinds = [
        ([h**2, h**3], "G0"),
        ([h**3, h**4], "G1"),
        ([h**3, h**5], "G1"),
        ([h**3, h**6], "G3"),
        ([h**3, h**6 + h**7], "G2"),
        ([h**3, h**9], "G3"),
        ([h**2 + h**3, h**4], "G0"),
        ([h, h**2], "G3"),
    ]
    coordinates, truth = rng.choice(kinds)
    (moved_,) = moved(rng, coordinates)
    curves = as_curve(moved_, -1, R(3, 4)), as_curve(moved_, R(3, 4), 1)
    # The velocity of the fifth and seventh vanishes at other places outside of [-1, 1] only, or is no factor of all.
    return Path("inside", curves, ("G3",), truth)


def path(seed):
    """A path, by its number."""
    rng = random.Random(f"path {seed}")
    maker = rng.choices([spline_path, arc_path, closed_path, inner_path], [5, 2, 1, 2])[0]
    return maker(rng), rng.choice(["G1", "G2", "G2", "G3"])


@dataclass(frozen=True)
class Patches:
    """Patches with the order of the one defect of their one meeting that is looked at; None if it is smooth.

    amount: what the gap, the angle in degrees or the jump of curvature is at least, somewhere; 0 if not known.
    """

    name: str
    patches: tuple
    order: int | None
    amount: float = 0.0
    pole: bool = False
    broken: bool = False

    def false(self):
        """What is said wrongly of it, in words; and the verdict."""
        report = continuity_report(self.patches, prove=True)
        meetings = report.poles if self.pole else [one for one in report.edges if one.patches == (0, 1)]
        wrong, verdicts = [], set()
        for meeting in meetings:
            proof = meeting.proof
            verdicts.add(meeting.verdict)
            if meeting.verdict == "DEGENERATE":
                wrong.append("DEGENERATE")
            # Of several stretches of one edge only one need have the defect.
            if len(meetings) == 1:
                for number, level in enumerate(proof.levels):
                    wrong += [f"level {number}: {one}" for one in self._false_level(number, level)]
            held = all(level.holds for level in proof.levels)
            if (meeting.verdict == "CERTIFIED") != (held and not proof.open):
                wrong.append("the verdict does not follow from the levels")
        if self.broken and verdicts == {"CERTIFIED"}:
            wrong.append("CERTIFIED, but torn at one place")
        if report.verdict == "CERTIFIED" and any(one.verdict != "CERTIFIED" for one in report.meetings):
            wrong.append("the report is better than its meetings")
        order = ("REFUTED", "DEGENERATE", "UNDECIDED", "CERTIFIED")
        return wrong, next((one for one in order if one in verdicts), "none")

    def _false_level(self, number, level):
        smooth = self.order is None or number < self.order
        if level.status == "equal" and number == self.order:
            yield "proved equal"
        if level.status == "within" and number == self.order and level.most < self.amount * (1 - 1e-9):
            yield f"proved to be at most {level.most}, but it is {self.amount}"
        if level.status == "different" and smooth and not self.broken:
            yield f"proved to differ by {level.least}"


def surfaces(rng):
    """A regular analytic surface near u, v in [-1, 1]."""
    a, b, c = (R(rng.randint(1, 6), 4) for _ in range(3))
    heights = [
        a * u**2 / 3 + b * u * v / 4 - c * v**3 / 5,
        sp.sin(a * u + v) / 3,
        sp.exp(u / 2) * v / 3 + u**3 / 7,
        sp.sqrt(8 - u**2 - v**2),
        R(0),
    ]
    kinds = [
        *[(u, v, height) for height in heights],
        (sp.cos(u) * (3 + sp.cos(v)), sp.sin(u) * (3 + sp.cos(v)), sp.sin(v)),
        (a * sp.cos(u), a * sp.sin(u), v),
        ((2 + u) * sp.cos(v), (2 + u) * sp.sin(v), b * v),
        (sp.cos(u / 2) * sp.cos(v / 2), sp.sin(u / 2) * sp.cos(v / 2), sp.sin(v / 2)),
        (u, v * (1 + u / 9), a * u * v / 5 + u**2 * v**2 / 7),
    ]
    return [sp.sympify(one) for one in rng.choice(kinds)]


def normal_at(point, place):
    """The normal of a surface on the line u = 0 at v = place, as floats."""
    first, second = ([float(sp.diff(one, w).subs({u: 0, v: place})) for one in point] for w in (u, v))
    cross = [first[i - 2] * second[i - 1] - first[i - 1] * second[i - 2] for i in range(3)]
    length = math.sqrt(sum(one * one for one in cross))
    return [one / length for one in cross], first, second


def edge_pair(rng):
    """Two pieces of one surface on both sides of u = 0, the second in other parameters, with a planted defect."""
    point = surfaces(rng)
    order = rng.choice([None, None, 0, 1, 2, 3])
    size = rng.choice(SIZES)
    bumps = [R(1), R(1), 1 + v, sp.exp(-((40 * (v - R(3, 10))) ** 2)), (v - R(1, 3)) ** 2 + 0 * u, v * (1 - v)]
    bump = rng.choice(bumps)
    a, b, slant = R(rng.randint(2, 6), 4), small(rng), small(rng)
    along = rng.choice([v, v, v, 1 - v, (v + v**2) / 2, v / (2 - v), sp.sin(sp.pi * v / 2)])
    # The second goes on to u > 0: U = a w + b w**2, V = along + slant w.
    inner = {u: a * u + b * u**2, v: along + slant * u}
    second = [one.subs(inner, simultaneous=True) for one in point]
    place = R(3, 10) if bump.has(sp.exp) else R(1, 2)
    met = along.subs(v, place)
    normal, first, _ = normal_at(point, met)
    axis = max(range(3), key=lambda k: abs(normal[k]))
    if order is not None:
        second[axis] += size * bump * u**order
    amount = 0.0
    if order in (0, 1, 2):
        # A small share of what the defect is at that place: no bound may be below it.
        lift = float(size * bump.subs(v, place)) * abs(normal[axis])
        speed = float(a) * math.sqrt(sum(one * one for one in first)) + 1
        amount = (0.2 * lift, math.degrees(math.atan(0.2 * lift / speed)), 0.2 * lift / speed**2)[order]
    patches = ParametricSurface(point, ((-1, 0), (0, 1))), ParametricSurface(second, ((0, R(1, 4)), (0, 1)))
    # A gap is told by the closest points, a lift of less than everything by none.
    name = f"edge {order} {size} {bump} {along}"
    return Patches(name, patches, order if order != 3 else None, amount)


def thin_pair(rng):
    """Patches that are torn at one place of the edge by a value of their formula there."""
    place = rng.choice([R(0), R(1, 3), R(1, 2), R(1)])
    size = rng.choice([R(1), R(1, 10**6), sp.sqrt(2)])
    base_ = rng.choice([R(0), v**2, u * v**3, sp.sin(u)])
    torn = rng.choice(
        [
            sp.Piecewise((base_, u < place), (base_, u > place), (base_ + size, True)),
            sp.Piecewise((base_ + size, sp.And(u <= place, u >= place)), (base_, True)),
            base_ + sp.Piecewise((0, u < place), (0, u > place), (size, True)) * (1 + v),
        ]
    )
    other = base_.subs(v, -v)
    low = ParametricSurface((u, v, other if rng.random() < 0.7 else torn.subs(v, -v)), ((0, 1), (-1, 0)))
    return Patches(f"thin {torn}", (low, ParametricSurface((u, v, torn))), 0, 0.0, broken=True)


def pole(rng):
    """Patches round a pole of a graph: smooth, a cone, or with curvatures that belong to no tensor."""
    count = rng.choice([1, 2, 3, 4])
    a, b = R(rng.randint(1, 5), 3), R(rng.randint(1, 5), 4)
    radius = rng.choice([v, v + v**2, sp.sin(v), v / (1 + v)])
    x, y = radius * sp.cos(u), radius * sp.sin(u)
    order = rng.choice([None, None, 1, 2])
    size = rng.choice(SIZES)
    height = rng.choice(
        [a * x**2 + b * y**2, a * x**2 + x * y - x**3, sp.sqrt(9 - radius**2), sp.exp(-(radius**2)), R(0)]
    )
    amount = 0.0
    if order == 1:
        height += size * radius
        amount = 0.5 * math.degrees(math.atan(float(size)))
    if order == 2:
        height += size * radius**2 * sp.cos(3 * u)
        amount = 0.2 * float(size)
    turn = 2 * sp.pi / count
    pieces = [[sp.sympify(one).subs(u, turn * (u + k)) for one in (x, y, height)] for k in range(count)]
    if rng.random() < 0.3:
        pieces = [[one.subs(v, 1 - v) for one in piece] for piece in pieces]
    return Patches(
        f"pole {order} {size} {count} {radius}", tuple(map(ParametricSurface, pieces)), order, amount, pole=True
    )


def patches(seed):
    """Patches, by their number."""
    rng = random.Random(f"patches {seed}")
    return rng.choices([edge_pair, thin_pair, pole], [6, 1, 2])[0](rng)
