"""Refuted for every value of letters: one joint that moves with the letters and jumps all the way.

Krawczyk's operator with the letters as intervals is, for each of their values, one with a value in place of each
interval: where its image of a box B lies inside B, the two equations of a joint have exactly one common zero in B
for every value. Tangents, curvatures and the turn of one arc into the other are enclosed over the box and all values
at once, so that a jump whose enclosure excludes zero is a jump for every value.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rsym.codegen.balls import arb, ball, ctx, exact
from rsym.codegen.differentiation import derivative
from rsym.codegen.enclosures import ranges_of
from rsym.model.shape import Shape
from rsym.sampling.lattice import bounds_of
from rsym.verify.cleaning import cleaned
from rsym.verify.covering import PRECISION
from rsym.verify.generators import generators
from rsym.verify.joints import Meeting, is_transversal, joint, locate, meeting
from rsym.verify.local import Interval, Local, Model
from rsym.verify.locus import reduce
from rsym.verify.report import CONTINUITIES, Joint
from rsym.verify.revolution import meridian

# The box in which a joint is sought over its predicted motion: 1.2 suits motions that are nearly linear; a wider box
# bears more curved ones and is proved less often.
MARGINS = (1.2, 1.6, 2.4)
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
    return Refuter(shape, ranges_of(shape.letters, letters), bounds).joint(ranges_of(shape.letters, letters), defects)


class Refuter:
    """Follows joints of one shape over ranges of its letters, of which `values` tells which are ranges at all."""

    def __init__(self, shape: Shape, values: Mapping[str, Interval], bounds: Any = None) -> None:
        shape = shape if bounds is None else shape.replace(bounds=bounds)
        body = shape.dimension == 3
        self.plane = meridian(shape)[0] if body else shape
        self.bounds = bounds_of(self.plane, None)
        self.model = Model(self.plane.replace(expression=cleaned(self.plane.expression)), values, body=body)

    def joint(self, ranges: Mapping[str, Interval], defects: Sequence[Joint]) -> Joint | None:
        """A defect for every value in the ranges, from those at their middle."""
        with ctx.workprec(PRECISION):
            followed = (self._followed(ranges, defect) for defect in defects[:TRIED] if defect.proved)
            return next((found for found in followed if found is not None), None)

    def _followed(self, ranges: Mapping[str, Interval], defect: Joint) -> Joint | None:
        names = self.model.axes[2:]
        sides = [ball(exact(ranges[name][0]), exact(ranges[name][1])) for name in names]
        extent = max(float(high) - float(low) for low, high in self.bounds)
        least = max(2 * defect.radius, NEAREST * extent)
        motion = self._motion(defect, [side.mid() for side in sides], sides, least)
        if motion is None:
            return None
        for margin in MARGINS:
            box = [arb(centre, max(least, margin * way)) for centre, way in zip(defect.point, motion, strict=True)]
            found = self._proved([*box, *sides])
            if found is not None:
                return found
        return None

    def _meeting(self, sides: Sequence[arb]) -> Meeting | None:
        local = self.model.on(sides)
        locus = reduce(local, self.model.root)
        found = generators(local, locus.nodes[0]) if locus.kind == "leaf" else None
        return None if found is not None and found.analytic else meeting(local, locus, found)

    def _motion(
        self, defect: Joint, middle: Sequence[arb], sides: Sequence[arb], least: float
    ) -> tuple[float, float] | None:
        """How far the joint moves to first order, along both coordinates: dp = -J^-1 dH/dl dl."""
        arcs = self._meeting([*(arb(value, least) for value in defect.point), *middle])
        if arcs is None:
            return None
        at = self.model.on([*map(arb, defect.point), *middle])
        pair = (arcs.arcs[0].function, arcs.arcs[0].side)
        slopes = [self._slopes(at, number) for number in pair]
        if None in slopes:
            return None
        (a, b, *f), (c, d, *g) = (slope for slope in slopes if slope is not None)
        determinant = a * d - b * c
        if not determinant:
            return None
        radii = [float(arb(side.rad())) for side in sides]
        x = sum(abs((d * u - b * v) / determinant) * r for u, v, r in zip(f, g, radii, strict=True))
        y = sum(abs((a * v - c * u) / determinant) * r for u, v, r in zip(f, g, radii, strict=True))
        return x, y

    def _slopes(self, at: Local, number: int) -> list[float] | None:
        """The derivatives of a node along all axes, as floats: a prediction needs no proof."""
        found = [at.value(derivative(self.model.builder, number, name)) for name in self.model.axes]
        known = [float(value.mid()) for value in found if value is not None and value.is_finite()]
        return known if len(known) == len(found) else None

    def _proved(self, sides: Sequence[arb]) -> Joint | None:
        """The joint in a box for all letters in their ranges, if it is one, inside the bounds, and a defect."""
        local, arcs = self.model.on(sides), self._meeting(sides)
        if arcs is None or not is_transversal(local, arcs):
            return None
        zero = locate(local, arcs.arcs[0])
        if zero is None or zero.box is None or not zero.exists:
            return None
        inside = all(low < value and value < high for value, (low, high) in zip(zero.box, self.bounds, strict=True))
        found = joint(local, arcs, zero) if inside else None
        defective = found is not None and CONTINUITIES.index(found.continuity) < CONTINUITIES.index("G2")
        return found if found is not None and found.proved and defective else None
