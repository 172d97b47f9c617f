"""Refuted for every value of letters: one joint that moves with the letters and jumps all the way.

Krawczyk's operator with the letters as intervals is, for each of their values, one with a value in place of each
interval: where its image of a box B lies inside B, the two equations of a joint have exactly one common zero in B
for every value. Tangents, curvatures and the turn of one arc into the other are enclosed over the box and all values
at once, so that a jump whose enclosure excludes zero is a jump for every value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rsym.bounds.balls import arb, ball, ctx, exact
from rsym.bounds.enclosures import ranges_of
from rsym.model.shape import Bounds, Shape
from rsym.sampling.lattice import bounds_of
from rsym.verify.answers.report import Joint, is_defect
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting, is_transversal, joint, locate, located, meeting
from rsym.verify.boxes.krawczyk import Point, image, inverse
from rsym.verify.boxes.local import Interval, Model
from rsym.verify.boxes.locus import reduce
from rsym.verify.cleaning import cleaned
from rsym.verify.cover.covering import PRECISION
from rsym.verify.revolution import meridian

# A box that holds its image is found by growing it to a little more than its image, as often as it is worth trying.
INFLATION, GROWTHS = 1.1, 10
NEAREST = 2.0**-20  # a box is no narrower than this, as a share of the extent: the point is known to fewer digits
TRIED = 3  # defects that are followed, the worst first


def refuted_throughout(
    shape: Shape,
    letters: Mapping[Any, Any],
    defects: Sequence[Joint],
    *,
    bounds: Any = None,
) -> Joint | None:
    """A defect that the boundary has for every value of the letters, proved; None if none is found.

    Parameters
    ----------
    shape : Shape
        In the plane, or a body of revolution.
    letters : mapping
        Numbers and pairs (low, high) by name.
    defects : sequence of Joint
        Defects at the middle of the ranges, as `verify_smoothness` finds them: where to look.
    bounds : sequence of pairs, optional
        The defect lies within these for every value.

    Returns
    -------
    Joint or None
        Its radius covers the motion, its errors all values.

    Source: Neumaier, Interval Methods for Systems of Equations (1990), section 5.1, on zeros that depend on parameters.

    Examples
    --------
    >>> import rsym
    >>> body = rsym.paper.skeleton_body()
    >>> defects = rsym.verify_smoothness(body, letters={"a2": 5.2}).defects
    >>> found = refuted_throughout(body, {"a2": (5.15, 5.25)}, defects)
    >>> found.kind, found.proved
    ('corner', True)
    >>> refuted_throughout(body, {"a2": (5.15, 5.35)}, defects) is None
    True
    """
    shape = shape if bounds is None else shape.replace(bounds=bounds)
    body = shape.dimension == 3
    plane = meridian(shape)[0] if body else shape
    ranges = ranges_of(shape.letters, letters)
    model = Model(plane.replace(expression=cleaned(plane.expression)), ranges, body=body)
    return Refuter(model, bounds_of(plane, None)).joint(ranges, defects)


class Refuter:
    """Follows joints of a model in the plane over ranges of its letters; they must stay inside the bounds."""

    def __init__(self, model: Model, bounds: Bounds) -> None:
        self.model, self.bounds = model, bounds

    def joint(self, ranges: Mapping[str, Interval], defects: Sequence[Joint]) -> Joint | None:
        """A defect for every value in the ranges, from those at their middle."""
        with ctx.workprec(PRECISION):
            followed = (self._followed(ranges, defect) for defect in defects[:TRIED] if defect.proved)
            return next((found for found in followed if found is not None), None)

    def _followed(self, ranges: Mapping[str, Interval], defect: Joint) -> Joint | None:
        """The joint in a box that grows until it holds its own image, at most so many times."""
        sides = [ball(exact(ranges[name][0]), exact(ranges[name][1])) for name in self.model.axes[2:]]
        extent = max(float(high) - float(low) for low, high in self.bounds)
        least = max(2 * defect.radius, NEAREST * extent)
        box = [arb(value, least) for value in defect.point]
        arcs = self._meeting([*box, *(side.mid() for side in sides)])
        if arcs is None:
            return None
        for _ in range(GROWTHS):
            moved = self._image(arcs.arcs[0], box, sides)
            if moved is None:
                return None
            if all(old.contains_interior(new) for old, new in zip(box, moved, strict=True)):
                return self._proved([*box, *sides])
            box = [arb(side.mid(), max(least, INFLATION * float(arb(side.rad())))) for side in moved]
        return None

    def _meeting(self, sides: Sequence[arb]) -> Meeting | None:
        local = self.model.on(sides)
        locus = reduce(local, self.model.root)
        found = generators(local, locus.nodes[0]) if locus.kind == "leaf" else None
        return None if found is not None and found.analytic else meeting(local, locus, found)

    def _image(self, arc: BoundaryArc, box: Sequence[arb], sides: Sequence[arb]) -> Point | None:
        """The image of a box under Krawczyk's operator; None where there is none, or one wider than the bounds."""
        pair, middle = (arc.function, arc.side), [side.mid() for side in box]
        centre = self.model.on([*middle, *(side.mid() for side in sides)])
        here, whole = self.model.on([*middle, *sides]), self.model.on([*box, *sides])
        near = inverse([centre.gradient(number) for number in pair])
        values = [value for value in map(here.value, pair) if value is not None]
        if near is None or len(values) < len(pair):
            return None
        found = image(near, values, [whole.gradient(number) for number in pair], tuple(box))
        reach = max(high - low for low, high in self.bounds)
        return None if found is None or any(float(side.rad()) > reach for side in found) else found

    def _proved(self, sides: Sequence[arb]) -> Joint | None:
        """The joint in a box for all letters in their ranges, if it is one, inside the bounds, and a defect."""
        local, arcs = self.model.on(sides), self._meeting(sides)
        if arcs is None or not is_transversal(local, arcs):
            return None
        zero = locate(local, arcs.arcs[0])
        if zero is None or zero.box is None or not zero.exists:
            return None
        inside = all(low < value and value < high for value, (low, high) in zip(zero.box, self.bounds, strict=True))
        found = joint(local, arcs, located(local, arcs, zero)) if inside else None
        return found if found is not None and found.proved and is_defect(found) else None
