"""The verdict on a body: boxes, curves and points put together."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import TypeVar

import numpy as np

from rsym.arrays import Floats
from rsym.logic.faces import BETWEEN
from rsym.logic.leaf_names import leaf_names
from rsym.logic.sign_form import SignForm
from rsym.model.blends.gates import without_rounded_levels
from rsym.model.shape import Bounds, Shape
from rsym.program.builder import Builder
from rsym.program.program import live
from rsym.sampling.labels import Labeller
from rsym.sampling.progress import Effort
from rsym.verify.answers.account import audited, distinct, missing
from rsym.verify.answers.body_report import BodyCover, BodyReport
from rsym.verify.answers.conclusions import Tally, badness, conclude
from rsym.verify.answers.report import is_defect
from rsym.verify.answers.singular import Defect, SingularCurve, SingularPoint
from rsym.verify.boxes.contact_relations import contacts_of
from rsym.verify.boxes.domains import is_legal
from rsym.verify.boxes.holes import holes
from rsym.verify.boxes.lacking import lacking
from rsym.verify.boxes.local import Box, Interval, Model
from rsym.verify.cells import within_cells
from rsym.verify.cleaning import cleaned, spread, without_scale
from rsym.verify.cover.bending import UNBOUNDED, bending
from rsym.verify.cover.box_arrays import at
from rsym.verify.cover.forming import formation
from rsym.verify.cover.images import Images
from rsym.verify.cover.inspection import OPEN
from rsym.verify.cover.octree import Octree
from rsym.verify.cover.repetition import Repetition, repetition, turning
from rsym.verify.cover.subdivision import Subdivision, joined_boxes
from rsym.verify.curves.tracing import trace
from rsym.verify.everywhere import exists_for_every_value, for_every_value
from rsym.verify.points.space import classify_points

BUDGET = 1_000_000  # boxes: a ball takes 8 000, the car 120 000
INSPECTIONS = 20_000  # boxes that balls look at, a millisecond or a few each; the car takes 1 300
SMALLEST = 2.0**-22  # of the extent: what is smaller is located, not divided
SAME = 1e-12  # of the extent: points that are nearer than their accuracies and this are one
SHARES = 500, 200, 150, 150  # of what is reported: boxes, curves, points, curvatures
CROWD = 5_000  # boxes left over where letters range: of more nothing is said
TRIED = 2_000  # boxes at whose corners a change of sign is sought


@dataclass(frozen=True)
class Study:
    """A body and what was found on its boxes."""

    images: Images
    region: Box
    found: Subdivision
    naming: Naming
    effort: Effort
    piece: Repetition | None = None  # what was searched, if its images are the rest

    @property
    def ranging(self) -> bool:
        """Whether letters range."""
        return len(self.region) > 3

    @property
    def extent(self) -> float:
        """The longest side of the region in space."""
        return max(high - low for low, high in self.region[:3])


def study_body(
    shape: Shape,
    bounds: Bounds,
    letters: Mapping[str, Interval],
    *,
    smallest: float = SMALLEST,
    budget: int = BUDGET,
    effort: Effort | None = None,
) -> Study:
    """Subdivide the bounds of a body."""
    region: Box = tuple((float(low), float(high)) for low, high in bounds)
    effort = effort or Effort()
    effort.begin("boxes", SHARES[0])
    width = smallest * max(high - low for low, high in region)
    search = partial(Octree, smallest=width, budget=budget, inspections=INSPECTIONS, effort=effort)
    turned = turning(shape, region)
    if turned is not None:
        study = _searched(_subject(shape, turned.region, letters, effort), search, turned)
        if study is not None:
            return replace(study, region=(*region, *study.region[3:]))
    study = _subject(shape, region, letters, effort)
    mirrored = repetition(study.images.model, study.region)
    found = None if mirrored is None else _searched(study, search, mirrored)
    return replace(study, found=search(study.images, study.region).run()) if found is None else found


def _subject(shape: Shape, region: Box, letters: Mapping[str, Interval], effort: Effort) -> Study:
    """A body before it is searched."""
    expression = within_cells(spread(cleaned(without_rounded_levels(shape.expression))), shape.coordinates, region)
    model = Model(shape.replace(expression=without_scale(expression)), letters, bounds=region)
    whole = model.over(region)
    formed = formation(model, lambda number: is_legal(whole, number))
    images = Images(model, formed, letters)
    region = (*region, *((float(low), float(high)) for low, high in images.ranges))
    values = {name: float(low) for name, (low, _) in model.letters.items()}
    naming = Naming(shape, model.builder, formed.definitions, formed.origins, values)
    return Study(images, region, Subdivision(), naming, effort)


def _searched(study: Study, search: Callable[..., Octree], piece: Repetition) -> Study | None:
    """A body of which one piece was searched; None if that holds more than regular sheets, or nothing."""
    region = (*piece.region[:3], *study.region[3:])
    study = replace(study, found=search(study.images, region, piece=piece).run(), piece=piece)
    if not study.found.regular or study.found.has_more:
        return None
    curves, open_boxes = _curves(study, [])
    return None if curves or open_boxes else study


def report_body(study: Study, *, sharpened: bool = True) -> BodyReport:
    """The report on a body that was studied; `sharpened`: with bounds of the curvatures, which take longest.

    It says UNDECIDED where something that was found is not in it.
    """
    model, found, effort = study.images.model, study.found, study.effort
    effort.begin("curves", SHARES[1])
    if study.ranging:
        found = for_every_value(model, found, study.extent, effort)
    corners = [
        (box, replace(one.point, names=tuple(dict.fromkeys(map(study.naming, one.sheets)))))
        for box, one in found.corners
        if one.point is not None
    ]
    curves, open_boxes = ([], []) if study.ranging else _curves(study, corners)
    found = replace(found, left=[*found.left, *((box, OPEN) for box in open_boxes)])
    effort.begin("points", SHARES[2])
    looked_at = found.left if not study.ranging or len(found.left) <= CROWD else []
    classified = classify_points(model, looked_at, study.extent, study.naming, curves, effort=effort)
    # Of breaks one point stands for all that lie on one curve.
    located = [*(point for _, point in corners), *(pairs[0][1] for pairs in found.broken.values()), *classified.points]
    points = distinct(located, badness, SAME * study.extent)
    curves = [study.naming.there(curve) for curve in (*curves, *classified.curves)]
    points = [study.naming.there(one) for one in points]
    found = found.with_late(classified.regular, classified.corners)
    everything: list[Defect] = [*curves, *points]
    if not any(one.proved and is_defect(one) for one in everything):
        found = found.without_crossings()
    exists = exists_for_every_value(study.images, found, TRIED) if study.ranging else _exists(study.images, found)
    tally = _tally(found, exists)
    effort.begin("curvatures", SHARES[3])
    bent = bending(study.images, found, effort) if sharpened and exists else UNBOUNDED
    effort.finish()
    left = [box for box, _ in found.left]
    gaps = (*(() if study.ranging else holes(model, left)), *lacking(model, left, study.naming))
    said = conclude(tally, everything, 3, (*gaps, *_repeated(study), *effort.statements), ranging=study.ranging)
    draft = BodyReport(
        verdict=said.verdict,
        continuity=said.continuity,
        curves=tuple(sorted(curves, key=badness)),
        points=tuple(sorted(points, key=badness)),
        curvatures=(-math.inf, math.inf) if found.has_gaps else bent.enclosure,
        attained=bent.attained,
        cover=_cover(study, found),
        letters={name: (float(low), float(high)) for name, (low, high) in model.letters.items()},
        statements=said.statements,
    )
    wrong = missing(located, draft.points, found.balance, near=SAME * study.extent, boxes=_unlisted(study, draft))
    return audited(draft, wrong)


def _unlisted(study: Study, draft: BodyReport) -> int:
    """How many boxes on which something was found are in no list of the report."""
    found = study.found
    held = [*(part for parts in found.regular.values() for part in parts), *joined_boxes(found)]
    count = sum(map(len, held)) + len(found.double) + len(found.breaks) + len(found.leaps) + len(found.left)
    cover = draft.cover
    return max(0, count - len(cover.certified) - len(cover.joined) - len(cover.undecided))


def _curves(study: Study, corners: Sequence[tuple[Box, SingularPoint]]) -> tuple[list[SingularCurve], list[Box]]:
    """The curves of each pair of sheets, by the boxes in which these meet; and boxes that may hold more of one."""
    curves: list[SingularCurve] = []
    open_boxes: list[Box] = []
    for number, (meeting, groups) in enumerate(study.found.joined.items()):
        leaves = contacts_of(study.images.model).leaves
        names = tuple(study.naming(leaves.get(arc.function, arc.function)) for arc in meeting.arcs)
        boxes = [_box(box) for group in groups for box in group.tolist()]
        found = trace(
            study.images.model,
            meeting,
            (names[0], names[1]),
            boxes,
            extent=study.extent,
            corners=corners,
            effort=study.effort,
            done=(number, len(study.found.joined)),
        )
        for curve in found:
            single = curve.kind == "unresolved" and len(curve.points) == 1
            held = [box for box in boxes if single and _holds(box, curve.points[0])][:1]
            open_boxes += held
            curves += [] if held else [curve]
    return curves, open_boxes


def _holds(box: Box, point: Floats) -> bool:
    return all(low <= value <= high for value, (low, high) in zip(point, box, strict=False))


def _box(sides: Sequence[Sequence[float]]) -> Box:
    return tuple((low, high) for low, high in sides)


def _exists(images: Images, found: Subdivision) -> bool | None:
    """Whether there is a point of the boundary: True and False are proved, None is neither."""
    late = [np.array([box[:3]]) for box in found.late]
    boxes = [part for parts in found.regular.values() for part in parts] + list(joined_boxes(found)) + late
    if boxes:
        settled = np.concatenate(boxes)[:TRIED]
        corners = [at(settled[:, range(3), list(ends)], settled) for ends in product((0, 1), repeat=3)]
        signs = np.array([images.sign(points) for points in corners])
        if ((signs > 0).any(axis=0) & (signs < 0).any(axis=0)).any():
            return True
    return True if found.broken else None if boxes or found.left or found.double or found.leaps else False


def _tally(found: Subdivision, exists: bool | None) -> Tally:
    counts = {
        "regular": sum(len(part) for parts in found.regular.values() for part in parts) + len(found.late),
        "joined": sum(len(part) for parts in found.joined.values() for part in parts),
        "double": len(found.double),
        "corner": len(found.corners),
        "leap": len(found.leaps),
        "broken": len(found.breaks) if found.broken else 0,
        "open": len(found.left),
    }
    return Tally(counts, found.order, exists)


def _cover(study: Study, found: Subdivision) -> BodyCover:
    region = study.region
    none = np.empty((0, len(region), 2))
    late: Floats = np.array([box[:3] for box in found.late], dtype=np.float64).reshape(-1, 3, 2)
    boxes = [*(box for box, _ in found.left), *found.double, *found.leaps, *(box for box, _ in found.breaks)]
    left: Floats = np.array([box[:3] for box in boxes], dtype=np.float64).reshape(-1, 3, 2)
    regular = (part for parts in found.regular.values() for part in parts)
    certified = np.concatenate([late, np.concatenate([none, *regular])[:, :3]])
    joined = np.concatenate([none, *joined_boxes(found)])[:, :3]
    if study.piece is not None:
        certified, joined = (study.piece.images(boxes, region) for boxes in (certified, joined))
    return BodyCover(
        bounds=region[:3],
        certified=certified,
        joined=joined,
        undecided=left,
        examined=found.examined,
    )


def _repeated(study: Study) -> tuple[tuple[str, bool], ...]:
    return () if study.piece is None else ((study.piece.sentence, True),)


# What the sheets of a boundary are called: by the definitions that they come from.
NUMBERED = "leaf "  # a definition without a name whose formula is too long to be one
D = TypeVar("D", SingularCurve, SingularPoint)
ON_LEAF = 1e-9  # as a share of the largest coordinate


class Naming:
    """Names of nodes: that of the definition itself, of the one that a factor or a continued sheet was made of.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.local import Model
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)).named("ball")
    >>> shape = ball & rsym.Shape(z, (x, y, z)).named("table")
    >>> model = Model(shape, {})
    >>> naming = Naming(shape, model.builder, model.builder.nodes[model.root].arguments, {})
    >>> [naming(node) for node in model.builder.nodes[model.root].arguments]
    ['ball', 'table']
    """

    def __init__(
        self,
        shape: Shape,
        builder: Builder,
        definitions: Sequence[int],
        origins: Mapping[int, Sequence[int]],
        letters: Mapping[str, float] | None = None,
    ) -> None:
        self._builder = builder
        self._labeller = Labeller(shape, letters)
        names = leaf_names(SignForm(builder, tuple(definitions), ()), shape)
        if len(names) == 1 and names[0].startswith(NUMBERED):
            names = ("omega",)
        self._names = dict(zip(definitions, names, strict=True))
        for node, own in origins.items():
            self._names[node] = BETWEEN.join(dict.fromkeys(self._names[one] for one in own))
        self._parts = {node: frozenset(live(builder.nodes, [node])) for node in self._names}

    def __call__(self, node: int) -> str:
        """The name of a node, or of its negative; of others that of the definition with which it shares most."""
        for one in (node, self._builder.neg(node)):
            if one in self._names:
                return self._names[one]
        own = frozenset(live(self._builder.nodes, [node]))
        shares = {one: len(own & parts) / len(own | parts) for one, parts in self._parts.items()}
        self._names[node] = name = self._names[max(shares, key=lambda one: (shares[one], -one))]
        return name

    def there(self, defect: D) -> D:
        """A curve or a point that names of what several parts share only those with a face there."""
        places = np.atleast_2d(defect.points if isinstance(defect, SingularCurve) else defect.point)
        within = max(defect.radius, ON_LEAF * float(np.abs(places).max()))
        names = [self._labeller.there(name, places, within) for name in defect.names]
        if isinstance(defect, SingularCurve):
            return replace(defect, names=(names[0], names[1]))
        return replace(defect, names=tuple(dict.fromkeys(names)))
