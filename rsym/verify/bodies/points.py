"""Singular points of a body: what subdivision could not settle, gathered into points, located and classified.

A point is proved by its sheets (their arrangement on small spheres), by second derivatives, or by the one-sided
derivative along all rays; what none of them decides is described by numbers and called so.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from rsym.codegen.balls import ctx
from rsym.verify.bodies.candidates import places
from rsym.verify.bodies.clusters import Cluster, clusters
from rsym.verify.bodies.corners import floats
from rsym.verify.bodies.even_roots import is_regular_through_root
from rsym.verify.bodies.formulas import Literal
from rsym.verify.bodies.judging import Names, called_of, classify_place
from rsym.verify.bodies.report import SingularCurve, SingularPoint
from rsym.verify.bodies.sheets import Sheets, sheets
from rsym.verify.bodies.spheres import COARSE, views
from rsym.verify.covering import PRECISION
from rsym.verify.generators import generators
from rsym.verify.local import Box, Model

# Kinds of points at which there is no surface; a tangency is one too where it is "broken".
DEGENERATIONS = frozenset({"node", "isolated point", "no sign change", "end"})
MOST_CLASSIFIED = 48  # clusters that are looked at closer, each for some tenths of a second
MOST_PROBED = 12  # of them by numbers
MOST_PLACES = 6  # guesses of the point of one cluster


@dataclass(frozen=True)
class Classified:
    """Points, undecided curves, and the boxes on which the boundary turned out to be regular and analytic."""

    points: tuple[SingularPoint, ...]
    curves: tuple[SingularCurve, ...]
    regular: tuple[Box, ...]


def is_degenerate(point: SingularPoint) -> bool:
    """Whether there is no surface at a point, if what is said of it holds."""
    return point.kind in DEGENERATIONS or (point.kind == "tangency" and point.continuity == "broken")


def classify_points(
    model: Model,
    left: Sequence[tuple[Box, Any]],
    extent: float,
    names: Names | None = None,
    curves: Sequence[SingularCurve] = (),
) -> Classified:
    """What the boxes that are left over hold: one point for each cluster of them, or an undecided curve.

    Parameters
    ----------
    model : Model
        Of three coordinates.
    left : sequence of pairs
        Boxes, each with what was found on it.
    extent : float
        The size of the whole.
    names : callable, optional
        What the definition is called that a node belongs to.
    curves : sequence of SingularCurve
        Those known already: undecided boxes along them are not reported as curves again.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> cone = Model(rsym.Shape(z**2 - x**2 - y**2, (x, y, z)), {})
    >>> (point,) = classify_points(cone, [(((-0.01, 0.02),) * 3, None)], 2.0).points
    >>> point.kind, point.point, point.proved, is_degenerate(point)
    ('node', (0.0, 0.0, 0.0), True, True)
    """
    points: list[SingularPoint] = []
    undecided: list[SingularCurve] = []
    regular: list[Box] = []
    for number, cluster in enumerate(clusters([box for box, _ in left])):
        if cluster.is_long:
            undecided += _unless_known(_curve(cluster), curves)
            continue
        if number < MOST_CLASSIFIED and is_regular(model, cluster):
            regular += cluster.boxes
            continue
        probe = len(points) < MOST_PROBED
        points.append(_classified(model, cluster, extent, names, probe) if number < MOST_CLASSIFIED else _open(cluster))
    return Classified(tuple(points), tuple(undecided), tuple(regular))


def _open(cluster: Cluster) -> SingularPoint:
    return SingularPoint(cluster.centre, cluster.radius, "unresolved", "broken", reason="nothing is proved here")


def _curve(cluster: Cluster) -> SingularCurve:
    points = cluster.ordered()
    unknown = np.full(len(points), math.nan)
    normals = np.full((len(points), 2, 3), math.nan)
    reason = f"{len(cluster.boxes)} boxes along a curve are undecided"
    away = 3 * cluster.width
    return SingularCurve(points, away, "unresolved", "broken", ("", ""), normals, unknown, unknown, reason=reason)


def _unless_known(curve: SingularCurve, known: Sequence[SingularCurve]) -> list[SingularCurve]:
    everything = [one.points for one in known if len(one.points)]
    if not everything:
        return [curve]
    others = np.concatenate(everything)
    distances = np.array([np.linalg.norm(others - point, axis=1).min() for point in curve.points])
    return [] if bool((distances < 4 * curve.radius).all()) else [curve]


def is_regular(model: Model, cluster: Cluster) -> bool:
    """Whether all boxes of a cluster hold one leaf, analytic (even in what is under its roots) and with a gradient."""
    with ctx.workprec(PRECISION):
        local = model.over((*cluster.hull, *cluster.boxes[0][3:]))
        found = sheets(local, model.root)
        if found is None or len(found.leaves) != 1:
            return False
        (leaf,) = found.leaves
        if generators(local, leaf).analytic:
            return any(slope > 0 or slope < 0 for slope in local.gradient(leaf))
        return is_regular_through_root(local, leaf)


def _classified(model: Model, cluster: Cluster, extent: float, names: Names | None, probe: bool) -> SingularPoint:
    """By the first place that proves something, else by numbers."""
    unresolved = _open(cluster)
    if len(model.axes) > 3:
        return unresolved
    with ctx.workprec(PRECISION):
        local = model.over(cluster.hull)
        found = sheets(local, model.root) or Sheets((model.root,), Literal(model.root), (model.root,))
    called = called_of(found, names)
    best = None
    reach = 2 * cluster.radius + cluster.width
    for place in islice(places(model, local, found, cluster.centre, reach), MOST_PLACES):
        best = place.point if best is None else best
        if place.proved:
            point = classify_place(model, place, names)
            if point is not None:
                return point
    if not probe:
        return replace(unresolved, names=called)
    centre, away = (cluster.centre, cluster.radius) if best is None else (floats(best), 0.0)
    return _probed(model, replace(unresolved, point=centre, names=called), away, extent)


def _probed(model: Model, point: SingularPoint, away: float, extent: float) -> SingularPoint:
    """What small spheres see, numerically; they stay larger than what is not known of the centre."""
    seen = views(model, point.point, max(extent / 400, 300 * away))
    last = seen[-1]
    reason = f"numerically: small spheres see {last}"
    if any((view.inside, view.outside) != (last.inside, last.outside) for view in seen[2:]):
        return replace(point, reason="the pieces that small spheres see do not settle")
    if last.undefined:
        return replace(point, kind="end", reason=reason)
    if min(last.inside, last.outside) == 0:
        return replace(point, reason=reason)  # an isolated point, or a spike too sharp to be seen
    if max(last.inside, last.outside) > 1:
        return replace(point, kind="node", reason=reason)
    off = abs(seen[-2].turn - last.turn) + COARSE
    reason += f"; the normals on them differ by up to {last.turn:.3g} degrees"
    if last.turn > 10 * off:
        kind = "cone tip" if len(point.names) < 2 else "corner"
        return replace(point, kind=kind, continuity="G0", tangent_jump=last.turn, tangent_jump_error=off, reason=reason)
    return replace(point, reason=reason)
