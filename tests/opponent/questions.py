"""The other verdict functions: normalisation, thresholds, atlases, fairness, repairs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

import mpmath
import numpy as np
import sympy as sp

import rsym
from opponent.germs_plane import GERMS
from opponent.judge import evaluator
from opponent.kinks import Q
from opponent.placing import placed, rotation
from opponent.truth import Case, rank
from rsym import RsymError, Shape, x, y

A, B = sp.symbols("a b", real=True)


@dataclass(frozen=True)
class Question:
    """A shape, and what answers the question that is put to it: the word of the verdict, and what is false."""

    family: str
    text: str
    answer: Callable[[], tuple[str, list[str]]]

    def __str__(self) -> str:
        return self.text


def _frame(random: Random) -> tuple[sp.Expr, sp.Expr]:
    """Coordinates along and across a line, turned and moved exactly."""
    turn = rotation(random, 2)
    moved = turn.T * (sp.Matrix([x, y]) - sp.Matrix([random.choice([0, Q(1, 3), Q(-1, 7)]) for _ in range(2)]))
    return moved[0], moved[1]


def normalisation(random: Random) -> Question:
    """A distance times a factor: |grad omega| - 1 on the boundary is what the factor says."""
    s, d = _frame(random)
    kind = random.choice(["line", "line", "circle"])
    if kind == "circle":
        d = 1 - sp.sqrt(x**2 + y**2)
        s = x
    e = random.choice([Q(0), Q(1, 2000), Q(1, 500), Q(1), Q(-1, 500), Q(-1, 2)])
    bump = random.choice(
        [
            e,
            e * s**2 / 4,
            e * sp.exp(-((200 * (s - Q(3, 10))) ** 2)),
            sp.Piecewise((e, (s > Q(3, 10)) & (s < Q(3, 10) + Q(1, 10**6))), (0, True)),
            sp.Piecewise((0, s < Q(1, 5)), (0, s > Q(1, 5)), (1, True)),
            e * sp.sign(s) ** 2 / 2,
        ]
    )
    c = random.choice([0, 0, Q(1, 1000), 1])
    omega = d * (1 + bump) + c * d**2
    if random.random() < 0.15:
        omega, bump = random.choice([(d * sp.Abs(d), -1), (d**3, -1), (d + sp.Abs(d) / 2, Q(1, 2))])
    shape = Shape(omega, (x, y), bounds=((-1.1, 1.2), (-1.3, 1.1)))
    order = random.choice([1, 1, 2])
    return Question(
        "normalisation", f"{shape.expression} order {order}", lambda: _normalised(shape, bump, s, d, c, order, kind)
    )


def _normalised(shape: Shape, bump, s, d, c, order: int, kind: str) -> tuple[str, list[str]]:
    report = rsym.verify_normalisation(shape, order, resolution=24, work=2e6)
    tolerance = Q(1, 1000)
    sizes = sp.lambdify((x, y), sp.Abs(sp.sympify(bump)) + 0 * x, "numpy")
    t = np.linspace(-2, 2, 4001)
    if kind == "circle":
        points = np.cos(t * 2), np.sin(t * 2)
    else:
        along = np.array([float(sp.N(s.diff(q))) for q in (x, y)])
        foot = [float(sp.N(q)) for q in (foot_of(s, d))]
        points = tuple(foot[k] + along[k] * t for k in (0, 1))
    inside = np.logical_and.reduce(
        [(low <= p) & (p <= high) for p, (low, high) in zip(points, shape.bounds, strict=True)]
    )
    values = np.broadcast_to(sizes(*points), t.shape)[inside]
    least = float(values.max(initial=0))  # the deviation is at least this
    found = []
    thin = sp.sympify(bump).has(sp.Piecewise) or sp.sympify(bump).has(sp.sign)
    if thin:
        least = max(least, 0.0)
    if report.verdict == "CERTIFIED":
        if least > tolerance * (1 + 1e-9):
            found.append(f"CERTIFIED, the gradient is off by {least}")
        if order == 2 and kind == "line" and abs(2 * c) > tolerance:
            found.append(f"CERTIFIED to order 2, the second derivative is {2 * c}")
        if thin and bump != 0:
            found.append("CERTIFIED, on a thin set the gradient is not there or another")
    plain = not thin and not sp.sympify(bump).has(sp.exp)
    if (
        report.verdict == "REFUTED"
        and plain
        and least <= tolerance
        and (order == 1 or c <= tolerance / 2)
        and kind == "line"
    ):
        second = sp.sympify(bump).diff(x).has(x) or sp.sympify(bump).diff(y).has(y)
        if order == 1 or not second:
            found.append(f"REFUTED, the gradient is off by {least} only")
    if report.verdict == "DEGENERATE":
        found.append("DEGENERATE, there is a boundary")
    if len(report.proved_bounds) and report.proved_bounds[0] < least * (1 - 1e-9) and not len(report.uncovered):
        found.append(f"proved to be off by {report.proved_bounds[0]} at most, it is {least}")
    return report.verdict, found


def foot_of(s: sp.Expr, d: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Where both of two linear functions with orthonormal gradients are zero."""
    at = {x: 0, y: 0}
    return tuple(-(s.subs(at) * s.diff(q) + d.subs(at) * d.diff(q)) for q in (x, y))


def threshold(random: Random) -> Question:
    """A letter beyond whose value there is a defect, and none before, or the other way round."""
    at = random.choice([Q(1, 3), Q(1, 2), Q(2, 7), sp.sqrt(2) / 4])
    s, d = _frame(random)
    over = random.choice([A - at, at - A])
    beyond = sp.Max(over, 0)
    omega, smooth_when = random.choice(
        [
            (d - s**4 - beyond * sp.Abs(s), False),
            (d - s**2 - beyond**2 * sp.Abs(s), False),
            (d - s**2 / 3 - beyond * s * sp.Abs(s), False),
            (d - sp.sqrt(s**2 + beyond), True),
            (d - sp.sqrt(s**2 + beyond**2), True),
            (rsym.conjunction(s, d) - beyond, True),
        ]
    )
    shape = Shape(omega, (x, y), letters={A: 0.4}, bounds=((-1.1, 1.2), (-1.3, 1.1)))
    return Question("threshold", str(omega), lambda: _threshold(shape, over, smooth_when))


def _threshold(shape: Shape, over: sp.Expr, smooth_beyond: bool) -> tuple[str, list[str]]:
    (at,), certified_above = sp.solve(over, A), (sp.diff(over, A) > 0) == smooth_beyond
    try:
        found = rsym.smoothness_threshold(shape, "a", between=(0, 1), tolerance=1e-3)
    except RsymError as error:
        return f"refused ({error.code})", []
    ok = found.refuted <= at <= found.certified if certified_above else found.certified <= at <= found.refuted
    wrong = [] if ok else [f"{found}, the truth is {at}"]
    for value, word in found.trials:
        smooth = bool(over.subs(A, Q(value)) > 0) == smooth_beyond  # exactly: the end belongs to the other side
        if (word == "CERTIFIED" and not smooth) or (word == "REFUTED" and smooth) or word == "DEGENERATE":
            wrong.append(f"{word} at {value}, the truth changes at {at}")
    return "found", wrong


def atlas(random: Random) -> Question:
    """Two letters and a line between them on one side of which there is a defect."""
    s, d = _frame(random)
    at = random.choice([Q(3, 4), Q(1), Q(9, 7)])
    over = random.choice([A + B - at, at - A - B, A * B - at / 4])
    beyond = sp.Max(over, 0)
    omega, smooth_beyond = random.choice(
        [
            (d - s**2 - beyond * sp.Abs(s), False),
            (d - sp.sqrt(s**2 + beyond), True),
            (d - s**2 - over * sp.Abs(s), False),
            (rsym.conjunction(s, d) - over, True),
        ]
    )
    shape = Shape(omega, (x, y), letters={A: 0.5, B: 0.5}, bounds=((-1.1, 1.2), (-1.3, 1.1)))
    linear = not omega.has(sp.Max)
    return Question("atlas", str(omega), lambda: _atlas(shape, over, smooth_beyond, linear))


def _atlas(shape: Shape, over: sp.Expr, smooth_beyond: bool, linear: bool) -> tuple[str, list[str]]:
    found = rsym.smoothness_atlas(shape, "a", "b", between=((0, 1), (0, 1)), tolerance=0.2, budget=30, sharpening=0)
    side = sp.lambdify((A, B), over, "math")
    wrong = []
    for rectangle, word in zip(found.rectangles, found.verdicts, strict=True):
        for p in (0.01, 0.3, 0.5, 0.9, 0.99):
            for q in (0.01, 0.4, 0.99):
                a, b = (low + share * (high - low) for share, (low, high) in zip((p, q), rectangle, strict=True))
                value = side(a, b)
                if abs(value) < 1e-9:
                    continue
                smooth = linear and smooth_beyond if linear else (value > 0) == smooth_beyond
                false = word in ("CERTIFIED", "REFUTED") and smooth != (word == "CERTIFIED")
                if false or (word == "DEGENERATE" and _has_sides(shape, a, b)):
                    wrong.append(f"{word} at ({a}, {b}), where the letters are {value} beyond")
    share = found.share
    return "CERTIFIED or REFUTED" if share["UNDECIDED"] < 0.9 else "UNDECIDED", wrong[:3]


def _has_sides(shape: Shape, a: float, b: float) -> bool:
    """Whether omega has both signs within the bounds, on a grid."""
    grid = np.meshgrid(*(np.linspace(*ends, 200) for ends in shape.bounds))
    values = evaluator(shape.replace(expression=shape.expression.subs({A: a, B: b}), letters={}))(grid)
    return bool((values > 0).any() and (values < 0).any())


def fairness(random: Random) -> Question:
    """Graphs whose curvature is known: no value beyond the bounds, and all extrema and inflections told."""
    s, d = _frame(random)
    h, _ = random.choice(
        [
            (s**2 / 2, 0),
            (s**3, 1),
            (sp.sin(2 * s), None),
            (s**4 - s**2, 2),
            (s**3 / 3 + s**2, None),
            (s**4, 0),
            (s**5, 1),
        ]
    )
    bounds = ((-0.9, 0.8), (-0.85, 0.9))
    shape = Shape(random.choice([1, 3, -1]) * (d - h), (x, y), bounds=bounds)
    return Question("fairness", str(shape.expression), lambda: _fair(shape, s, d, h))


def _fair(shape: Shape, s, d, h) -> tuple[str, list[str]]:
    report = rsym.fairness(shape, budget=3000)
    (bounds,) = report.curvatures
    place = sp.solve([s - A, d - B], [x, y])
    spot = sp.lambdify((A, B), [place[x], place[y]], "numpy")
    t = np.linspace(-1.6, 1.6, 20001)
    slope, second = (
        sp.lambdify(A, sp.diff(h.subs(x, place[x]).subs(y, place[y]).subs(B, 0), A, k) + 0 * A, "numpy") for k in (1, 2)
    )
    height = sp.lambdify(A, h.subs(x, place[x]).subs(y, place[y]).subs(B, 0) + 0 * A, "numpy")
    points = np.array(np.broadcast_arrays(*spot(t, height(t) + 0 * t)))
    inside = np.logical_and.reduce(
        [(low <= p) & (p <= high) for p, (low, high) in zip(points, shape.bounds, strict=True)]
    )
    bend = (second(t) + 0 * t) / (1 + slope(t) ** 2) ** 1.5
    size = np.abs(bend[inside]).max()
    wrong = []
    if report.smoothness.verdict != "CERTIFIED":
        return report.smoothness.verdict, wrong
    if bounds.size.proved and size > bounds.size.bound * (1 + 1e-9) + 1e-12:
        wrong.append(f"no curvature beyond {bounds.size.bound}, one is {size}")
    if report.complete and not any(report.constant):
        changes = np.diff(np.sign(bend))
        flexes = sum(1 for k in np.flatnonzero(changes) if inside[max(k - 3, 0)] and inside[min(k + 3, len(t) - 1)])
        runs = np.flatnonzero(np.diff(inside.astype(int)))
        told = [one for one in report.inflections if not one.flat]
        edge = 1e-3
        if len(told) < _robust(bend, inside, t, edge):
            wrong.append(f"{len(told)} inflections, complete; there are {flexes} {runs}")
    return "complete" if report.complete else "CERTIFIED", wrong


def _robust(bend, inside, t, edge) -> int:
    """Changes of sign well inside, each between values that are certainly of their sign."""
    count, last = 0, 0.0
    for value, here in zip(bend, inside, strict=True):
        if not here:
            last = 0.0
            continue
        if abs(value) > edge:
            count += last * value < 0
            last = value
    return count


def repair(random: Random) -> Question:
    """What is repaired needed it, and what needs it is not called whole."""
    while True:
        case = placed(random, random.choice(GERMS)(random), 2)
        if not case.unsure and not case.loose and 0.1 < case.length < 10:
            return Question("repair", str(case), lambda case=case: _repaired(case))


def _repaired(case: Case) -> tuple[str, list[str]]:
    try:
        report = rsym.repair(case.shape, moves=["round"], radius=case.length / 50)
    except RsymError as error:
        return f"refused ({error.code})", []
    wrong = []
    if not report.needed and rank(case.best) < rank("G2"):
        wrong.append(f"needs no repair, the truth is {case.best}")
    for one in report.candidates:
        corner = _sharpest(one.shape)
        if corner > 1 and corner > 3 * one.report.curvature_bound:
            wrong.append(f"{one.change}: certified, curvature {corner} beyond the bound {one.report.curvature_bound}")
    return f"{len(report.candidates)} candidates" if report.needed else "not needed", wrong


def _sharpest(shape: Shape) -> float:
    """The largest curvature that SymPy and mpmath find at sampled points of the boundary."""
    from opponent.judge import zeros

    omega = shape.expression.doit()
    places = zeros(shape, 60)
    largest = 0.0
    p, q = shape.coordinates
    first = [omega.diff(s) for s in (p, q)]
    bend = (
        omega.diff(p, 2) * first[1] ** 2 - 2 * omega.diff(p, q) * first[0] * first[1] + omega.diff(q, 2) * first[0] ** 2
    ) / (first[0] ** 2 + first[1] ** 2) ** Q(3, 2)
    try:
        value = sp.lambdify((p, q), bend, "mpmath")
        for place in places[:20]:
            with mpmath.workdps(30):
                largest = max(largest, abs(float(value(*map(mpmath.mpf, place)))))
    except (TypeError, NameError, ValueError, ZeroDivisionError, AttributeError):
        return 0.0
    return 0.0 if math.isnan(largest) else largest


FAMILIES = (normalisation, normalisation, threshold, atlas, fairness, repair)


def case(seed: int) -> Question:
    """The question of a seed; families take turns."""
    return FAMILIES[seed % len(FAMILIES)](Random(f"opponent questions {seed}"))


def asked(case: Question) -> tuple[str, list[str]]:
    """The answer, and what is false in it."""
    return case.answer()
