"""Singular points of a body: what subdivision could not settle, gathered into points, located and classified.

A point is proved by its sheets (their arrangement on small spheres), by second derivatives, or by the one-sided
derivative along all rays; what none of them decides is described by numbers and called so.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import islice, product
from typing import Any

import numpy as np

from rsym.bounds.balls import arb, ctx
from rsym.logic.kleene import Literal, as_gate
from rsym.sampling.progress import Effort
from rsym.verify.answers.singular import SingularCurve, SingularPoint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import PRECISE, PRECISION, Box, Local, Model, side
from rsym.verify.boxes.sheets import Sheets, sheets
from rsym.verify.boxes.vectors import floats
from rsym.verify.points.candidates import cuts_of_curves, systems_in_space
from rsym.verify.points.clusters import Cluster, clusters
from rsym.verify.points.contacts import touch_once
from rsym.verify.points.corners import Corner, corner, doubted
from rsym.verify.points.even_roots import is_regular_through_root
from rsym.verify.points.judging import Names, called_of, classify_place
from rsym.verify.points.locating import ZeroPlace, located
from rsym.verify.points.spheres import COARSE, Sampler, sampler, views

MOST_CLASSIFIED = 48  # clusters that are looked at closer, each for some tenths of a second
MOST_PROBED = 12  # of them by numbers
MOST_PLACES = 6  # guesses of the point of one cluster
LEAST = 1e-12  # of a value that may be zero at a point that was found
APPARENT = (30, 12)  # digits of what is taken for zero where nothing is proved: all, or those of a model in floats
SHORT = 1_000  # of the extent: what is undecided along less than that is a point, of a cusp perhaps
VIEWS = 5  # spheres around a point, each a quarter as large as the one before


@dataclass(frozen=True)
class Classified:
    """What boxes that were left over turned out to hold.

    Attributes
    ----------
    points, curves
        What is singular or undecided there.
    regular : tuple of Box
        Those on which the boundary is a regular analytic sheet.
    corners : tuple of (Box, Corner)
        Those on which three sheets are proved to meet in one of the points, or along their edges alone.
    """

    points: tuple[SingularPoint, ...]
    curves: tuple[SingularCurve, ...]
    regular: tuple[Box, ...] = ()
    corners: tuple[tuple[Box, Corner], ...] = ()


def classify_points(
    model: Model,
    left: Sequence[tuple[Box, Any]],
    extent: float,
    names: Names | None = None,
    curves: Sequence[SingularCurve] = (),
    *,
    effort: Effort | None = None,
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
    effort : Effort, optional
        When its time is over the boxes that are left are not looked at: of these nothing is said.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.answers.conclusions import is_degenerate
    >>> cone = Model(rsym.Shape(z**2 - x**2 - y**2, (x, y, z)), {})
    >>> (point,) = classify_points(cone, [(((-0.01, 0.02),) * 3, None)], 2.0).points
    >>> point.kind, point.point, point.proved, is_degenerate(point)
    ('node', (0.0, 0.0, 0.0), True, True)
    """
    classifier, effort = _Classifier(model, extent, names), effort or Effort()
    for cluster in clusters([box for box, _ in left], 3, effort):
        if cluster.is_long and cluster.radius > extent / SHORT:
            classifier.curves += _unless_known(_curve(cluster), curves)
            classifier.add_point_of(cluster)
        else:
            classifier.add(cluster)
    return classifier.result


def _is_within(model: Model, place: ZeroPlace) -> bool | None:
    """Whether a place lies within the bounds; the boxes that hold it do, but for the rounding of their sides."""
    with ctx.workprec(PRECISE):
        return is_within(model.on(place.point), tuple(place.zeros))


def _open(cluster: Cluster) -> SingularPoint:
    return SingularPoint(cluster.centre, cluster.radius, "unresolved", "unknown", reason="nothing is proved here")


def _curve(cluster: Cluster) -> SingularCurve:
    points = cluster.ordered()
    unknown = np.full(len(points), math.nan)
    normals = np.full((len(points), 2, 3), math.nan)
    reason = f"{len(cluster.boxes)} boxes along a curve are undecided"
    away = 3 * cluster.width
    return SingularCurve(points, away, "unresolved", "unknown", ("", ""), normals, unknown, unknown, reason=reason)


def _unless_known(curve: SingularCurve, known: Sequence[SingularCurve]) -> list[SingularCurve]:
    everything = [one.points for one in known if len(one.points)]
    if not everything:
        return [curve]
    others = np.concatenate(everything)
    distances = np.array([np.linalg.norm(others - point, axis=1).min() for point in curve.points])
    return [] if bool((distances < 4 * curve.radius).all()) else [curve]


def is_regular(local: Local) -> bool:
    """Whether a box holds one leaf alone, analytic (even in what is under its roots) and with a gradient.

    The sign must be that of the leaf, or its opposite: of min(u, -u), whose only leaf is u too, it never changes.
    """
    found = sheets(local, local.model.root)
    if found is None or len(found.leaves) != 1 or as_gate(found.formula) is None:
        return False
    (leaf,) = found.leaves
    if generators(local, leaf).analytic:
        return any(slope > 0 or slope < 0 for slope in local.gradient(leaf))
    return is_regular_through_root(local, leaf)


class _Classifier:
    """Takes one cluster after the other."""

    def __init__(self, model: Model, extent: float, names: Names | None) -> None:
        self.model, self.extent, self.names = model, extent, names
        self.curves: list[SingularCurve] = []
        self._points: list[SingularPoint] = []
        self._regular: list[Box] = []
        self._corners: list[tuple[Box, Corner]] = []
        self._looked_at = self._probed = 0

    @property
    def result(self) -> Classified:
        return Classified(tuple(self._points), tuple(self.curves), tuple(self._regular), tuple(self._corners))

    def add(self, cluster: Cluster) -> None:
        """Settle the boxes of a cluster, or note one point for it."""
        self._looked_at += 1
        if self._looked_at > MOST_CLASSIFIED:
            self._points.append(_open(cluster))
            return
        with ctx.workprec(PRECISION):
            local = self.model.over((*cluster.hull, *cluster.ranges))
            if is_regular(local):
                self._regular += cluster.boxes
                return
            # Where letters range a corner has another place for each value, perhaps beyond the bounds.
            found = corner(local, names=self.names) if len(self.model.axes) == 3 else None
        if found is None:
            point = self._classified(cluster)
            self._points.append(point)
            if point.continuity == "analytic" and point.proved and self._is_all(cluster, point):
                self._regular += cluster.boxes
            return
        self._corners += [(box, found) for box in cluster.boxes]
        if found.point is not None:
            self._points.append(found.point)

    def add_point_of(self, curve: Cluster) -> None:
        """Note one point of an undecided curve, if powers in a leaf are steep or two leaves touch there, proved."""
        box, model = curve.boxes[len(curve.boxes) // 2], self.model
        with ctx.workprec(PRECISION):
            local = model.over(box)
            found = sheets(local, model.root)
        if found is None or not 1 <= len(found.leaves) <= 2 or len(model.axes) > 3:
            return
        middle = tuple((low + high) / 2 for low, high in box)
        for place in located(model, cuts_of_curves(local, found.leaves, middle), middle, 4 * curve.width, LEAST):
            point = classify_place(model, place, self.names) if place.proved and _is_within(model, place) else None
            if point is not None:
                self._points.append(point)
                return

    def _is_all(self, cluster: Cluster, point: SingularPoint) -> bool:
        """Whether two leaves touch at a point and nowhere else in the hull of a cluster, which holds the point."""
        with ctx.workprec(PRECISION):
            place = [arb(part, point.radius) for part in point.point]
            local = self.model.on([side(*ends).union(part) for ends, part in zip(cluster.hull, place, strict=True)])
            found = sheets(local, self.model.root)
            if found is None or len(found.leaves) != 2 or not all(generators(local, f).analytic for f in found.leaves):
                return False
            f, g = found.leaves
            return touch_once(local, self.model.on(place), f, g)

    def _classified(self, cluster: Cluster) -> SingularPoint:
        """By the first place that proves something, else by numbers."""
        model, names = self.model, self.names
        if len(model.axes) > 3:
            return _open(cluster)
        with ctx.workprec(PRECISION):
            local = model.over(cluster.hull)
            found = sheets(local, model.root) or Sheets((model.root,), Literal(model.root), (model.root,))
        systems = systems_in_space(local, found)
        guesses = islice(located(model, systems, cluster.centre, cluster.radius, LEAST), MOST_PLACES)
        near: list[ZeroPlace] = []
        for place in guesses:
            if cluster.may_hold(place.point) and (within := _is_within(model, place)) is not False:
                near.append(place)
                if place.proved and (point := classify_place(model, place, names)) is not None:
                    return point if within else doubted(point)
        for digits, place in product(APPARENT, near):
            if (point := classify_place(model, place, names, apparent=digits)) is not None:
                return point
        unresolved = replace(_open(cluster), names=called_of(found, names))
        if self._probed >= MOST_PROBED:
            return unresolved
        self._probed += 1
        if near:
            return self._seen_from(replace(unresolved, point=floats(near[0].point)))
        (view,) = views(self._sampler, cluster.centre, [4 * cluster.radius])
        return replace(unresolved, reason=f"numerically: a sphere four times as large sees {view}")

    @cached_property
    def _sampler(self) -> Sampler:
        return sampler(self.model)

    def _seen_from(self, point: SingularPoint) -> SingularPoint:
        """What ever smaller spheres see around a point, numerically."""
        seen = views(self._sampler, point.point, [self.extent / 400 / 4**step for step in range(VIEWS)])
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
        turn, off = last.turn, abs(seen[-2].turn - last.turn) + COARSE
        reason += f"; the normals on them differ by up to {turn:.3g} degrees"
        if not turn > 10 * off:
            return replace(point, reason=reason)
        kind = "cone tip" if len(point.names) < 2 else "corner"
        return replace(point, kind=kind, continuity="G0", tangent_jump=turn, tangent_jump_error=off, reason=reason)
