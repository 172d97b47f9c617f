"""Rules by which a verdict is judged: what it says that is not so."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

import rsym
from opponent.truth import Case, rank

SLACK = 1e-9  # of the extent: numbers of the opponent's own are no better


def smoothness(case: Case, budget: int) -> tuple[str, list[str]]:
    """The verdict on the smoothness of a case, and what is false in the report."""
    report = rsym.verify_smoothness(case.shape, budget=budget, **case.options)
    return report.verdict, falsehoods(case, report)


def falsehoods(case: Case, report) -> list[str]:
    """Every sentence of a report on smoothness that contradicts the truth."""
    return [*_verdict(case, report), *_defects(case, report), *_boxes(case, report), *_zeros(case, report)]


def _verdict(case: Case, report) -> list[str]:
    verdict, said = report.verdict, report.continuity
    found = []
    if verdict == "CERTIFIED":
        if rank(case.best) < rank("G2"):
            found.append(f"CERTIFIED {said}, the truth is {case.best}")
        elif rank(said) > rank(case.best):
            found.append(f"CERTIFIED with continuity {said}, the truth is {case.best}")
    if case.empty and verdict in ("CERTIFIED", "REFUTED"):
        found.append(f"{verdict}, there is no boundary")
    if report.curvature_bound < case.bend:
        found.append(f"no curvature beyond {report.curvature_bound}, one is {case.bend}")
    if verdict == "REFUTED":
        if rank(case.worst) >= rank("G2"):
            found.append(f"REFUTED {said}, the truth is {case.worst}")
        elif -1 < rank(said) < rank(case.worst):
            found.append(f"REFUTED with continuity {said}, the truth is {case.worst}")
    if verdict == "DEGENERATE" and not case.empty and case.worst != "broken" and has_boundary(case):
        found.append(f"DEGENERATE, the truth is {case.worst}")
    return found


def _pieces(report):
    """(points, radius, piece) of everything that a report lists."""
    if hasattr(report, "curves"):
        for curve in report.curves:
            yield curve.points, curve.radius, curve
        for point in report.points:
            yield np.array([point.point]), point.radius, point
    else:
        for joint in (*report.defects, *report.joints):
            yield np.array([joint.point]), joint.radius, joint


def _defects(case: Case, report) -> list[str]:
    """Proved defects must be true ones; true ones must be told."""
    found = []
    extent = _extent(case)
    known = [(np.array([float(sp.N(c, 20)) for c in spot.point]), spot) for spot in (*case.spots, *case.unsure)]
    if getattr(report, "body", False):
        known = []
    pieces = list(_pieces(report))
    for points, radius, piece in pieces:
        if not piece.proved or case.loose or getattr(report, "body", False) or "letters" in case.options:
            continue
        near = [s for p, s in known if np.linalg.norm(points - p, axis=1).min() <= radius + SLACK * extent]
        if rank(piece.continuity) >= rank("G2"):
            if near and all(rank(s.grade) < rank(piece.continuity) for s in near):
                found.append(f"{piece.kind} proved {piece.continuity} at {points[0]}, the truth is {near[0].grade}")
            continue
        if not near:
            found.append(f"{piece.kind} {piece.continuity} proved at {points[0]} within {radius:.1e}: nothing is there")
        elif all(s.grade != piece.continuity for s in near):
            found.append(f"{piece.kind} proved {piece.continuity} at {points[0]}, the truth is {near[0].grade}")
        else:
            found.extend(_sizes(piece, near, case))
    return found


def _sizes(piece, near, case: Case) -> list[str]:
    turns = [s.turn for s in near if s.turn is not None and s.grade == piece.continuity]
    jumps = [s.jump for s in near if s.jump is not None and s.grade == piece.continuity]
    found = []
    if len(near) == 1 and turns and not _close(piece.tangent_jump, turns[0], piece.tangent_jump_error):
        found.append(f"a turn of {piece.tangent_jump} (+- {piece.tangent_jump_error}), the truth is {turns[0]}")
    error = getattr(piece, "curvature_jump_error", math.nan)
    jump = getattr(piece, "curvature_jump", math.nan)
    if len(near) == 1 and jumps and not _close(jump, jumps[0], error):
        found.append(f"a jump of {jump} (+- {error}), the truth is {jumps[0]}")
    return found


def _close(value: float, truth: float, error: float) -> bool:
    if math.isnan(value):
        return True
    return abs(value - truth) <= (0 if math.isnan(error) else error) + 1e-9 * abs(truth) + 1e-12


def _extent(case: Case) -> float:
    return max(high - low for low, high in case.shape.bounds)


def _within(boxes, point, slack):
    return ((boxes[:, :, 0] - slack <= point) & (point <= boxes[:, :, 1] + slack)).all(axis=1)


def _boxes(case: Case, report) -> list[str]:
    """No defect lies inside a certified box; every one lies in a joined or an undecided one, or is listed."""
    if getattr(report, "body", False) or "letters" in case.options or not case.placed:
        return []
    found = []
    extent = _extent(case)
    cover = report.cover
    pieces = [(points, radius) for points, radius, piece in _pieces(report)]
    for spot in case.spots:
        point = np.array([float(sp.N(c, 20)) for c in spot.point])
        if rank(spot.grade) < rank("G2") and _within(cover.certified, point, -1e-12 * extent).any():
            found.append(f"a certified box holds the {spot.grade} at {point}")
        told = any(np.linalg.norm(points - point, axis=1).min() <= radius + SLACK * extent for points, radius in pieces)
        left = (
            _within(cover.undecided, point, SLACK * extent).any() or _within(cover.joined, point, SLACK * extent).any()
        )
        curved = hasattr(report, "curves")
        if rank(spot.grade) < rank("G2") and not told and not (left and (curved or not report.verdict == "CERTIFIED")):
            found.append(f"nothing is told of the {spot.grade} at {point}")
    return found


def evaluator(shape):
    """omega by NumPy from SymPy's own tree, without the program of rsym."""
    function = sp.lambdify(shape.coordinates, shape.expression.doit(), "numpy")

    def value(points):
        with np.errstate(all="ignore"):
            answer = function(*points)
            return np.broadcast_to(np.asarray(answer, dtype=float), points[0].shape)

    return value


def zeros(shape, count: int = 400, seed: int = 0):
    """Places (m, dim) within the bounds where omega changes its sign, by bisection along random chords."""
    random = np.random.default_rng(seed)
    low, high = np.array(shape.bounds, float).T
    a, b = (low[:, None] + (high - low)[:, None] * random.random((len(low), count)) for _ in range(2))
    try:
        value = evaluator(shape)
        first, second = value(a), value(b)
    except (TypeError, NameError, ValueError, KeyError, AttributeError):
        return np.empty((0, len(low)))
    cut = first * second < 0
    a, b, side = a[:, cut], b[:, cut], first[cut] > 0
    for _ in range(60):
        middle = (a + b) / 2
        same = (value(middle) > 0) == side
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    return ((a + b) / 2).T


def _has_sides(shape, place, distance: float) -> bool:
    """Whether omega has both signs around a place, with 50 digits: floats may see a change of sign where none is."""
    steps = [sign * distance * axis for axis in np.eye(len(place)) for sign in (1, -1)]
    signs = set()
    for step in steps:
        point = {c: sp.Rational(float(v)) for c, v in zip(shape.coordinates, place + step, strict=True)}
        signs.add(bool(sp.N(shape.expression.doit().subs(point), 50) > 0))
    return len(signs) == 2


def has_boundary(case: Case) -> bool:
    """Whether omega changes its sign within the bounds, by sampling."""
    return len(zeros(case.shape)) > 0


def _zeros(case: Case, report) -> list[str]:
    """The boundary lies in the boxes of the report."""
    if getattr(report, "body", False) or "letters" in case.options or case.shape.letters:
        return []
    places = zeros(case.shape, 100)
    cover = report.cover
    boxes = np.concatenate([cover.certified, cover.joined, cover.undecided])
    extent = _extent(case)
    pieces = [(points, radius) for points, radius, _ in _pieces(report)]
    for place in places:
        if not _within(boxes, place, SLACK * extent).any():
            if any(
                np.linalg.norm(points - place, axis=1).min() <= radius + SLACK * extent for points, radius in pieces
            ):
                continue
            if _has_sides(case.shape, place, 1e-6 * extent):
                return [f"the boundary at {place} lies in no box"]
    return []
