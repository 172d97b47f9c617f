"""Sections of a body by parallel planes: the layers of a slicer, the paths of a mill."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError, warn
from rsym.model.letters import real_number
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import z
from rsym.reports.words import plural
from rsym.sampling.contours import LevelLines, sparse
from rsym.sampling.outlines import outline_within
from rsym.sampling.plane import bounds_of_sections, plane_sampler
from rsym.sampling.plane_leaves import leaves_of
from rsym.sampling.progress import Progress, Steps


@dataclass(frozen=True)
class Section:
    """The boundary of a body in the plane axis = value.

    Attributes
    ----------
    axis : str
        The coordinate that is constant.
    value : float
        Its value.
    coordinates : tuple of two str
        The coordinates of the plane, those of the columns of each line.
    lines : LevelLines
        The boundary, the body to its left: closed lines run counter-clockwise round material.
    normal : int
        The place of `axis` among the coordinates of the shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> (section,) = rsym.sections(ball, [0.6], resolution=32)
    >>> section.axis, section.value, section.coordinates, len(section.lines)
    ('z', 0.6, ('x', 'y'), 1)
    """

    axis: str
    value: float
    coordinates: tuple[str, str]
    lines: LevelLines
    normal: int

    def in_space(self, line: Floats) -> Floats:
        """Points (n, 2) of the plane as points (n, 3) of space."""
        return np.insert(line, self.normal, self.value, axis=1)


def sections(
    shape: Shape,
    values: Sequence[float],
    *,
    axis: Any = z,
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> tuple[Section, ...]:
    """The boundary of a body in the planes axis = value, every vertex and every corner exact.

    No triangulation comes between the equation and its sections: vertices lie on
    omega = 0 to rounding, and where two leaves of the sign form meet, their common
    point is a vertex. A plane that does not meet the body gives a section without lines.

    Parameters
    ----------
    shape : Shape
        A shape in space.
    values : sequence of float
        Where to cut.
    axis : symbol
        The coordinate that is constant on each section.
    resolution : int or two ints
        Square cells along the longer side of the plane, or cells along each axis of it.
    bounds, letters
        Override those of the shape; lines end at them.
    progress : callable, optional
        ``progress(done, total)`` after each section; returning False cancels with an RsymError.
    force : bool
        Whether to go on where the estimate says that there is not memory enough.

    Returns
    -------
    tuple of Section
        One for each value, in the order given.

    Raises
    ------
    RsymError
        For a shape in the plane, an unknown axis, no values, or a value that is not a finite number.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> [len(section.lines) for section in rsym.sections(ball, [-1.5, 0, 0.6], resolution=32)]
    [0, 1, 1]
    """
    require_shape(shape)
    names = [symbol.name for symbol in shape.coordinates]
    if shape.dimension != 3 or str(axis) not in names:
        raise RsymError(
            f"sections need a shape in space and one of its coordinates, got {', '.join(names)} and {axis}",
            code="section",
            remedy="sections(shape, values, axis=z) with a shape in (x, y, z)",
        )
    if not isinstance(values, Iterable):
        raise RsymError(
            f"sections take several values, got {values!r}", code="section", remedy=f"for one section [{values!r}]"
        )
    heights = [float(real_number(value, f"a section {axis}")) for value in values]
    if not heights:
        raise RsymError("sections need at least one value, got none", code="section", remedy="for example [0.5, 1.0]")
    box = bounds
    if bounds is None:
        box = bounds_of_sections(shape, None, [{axis: height} for height in heights], letters)
    first = plane_sampler(
        shape, "value", resolution=resolution, bounds=box, letters=letters, section={axis: heights[0]}, force=force
    )
    normal = names.index(str(axis))
    leaves = leaves_of(shape, first.free, first.fixed, letters, first.bounds)
    steps, found = Steps(len(heights), progress), []
    for height in heights:
        fixed = {normal: height}
        here = leaves.at(fixed)
        lines = sparse(outline_within(replace(first, fixed=fixed), here))
        found.append(Section(names[normal], height, first.names, lines, normal))
        steps.advance()
    unseen = [section for section in found if section.lines.status.remark]
    if unseen:
        others = f" (and in {plural(len(unseen) - 1, 'other section')})" if unseen[1:] else ""
        warn(f"{axis} = {unseen[0].value:g}{others}: {unseen[0].lines.status.remark}")
    return tuple(found)
