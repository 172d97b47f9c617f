"""Level lines of a field, and those that bound a shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, overload

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import real_number
from rsym.model.requirements import require_shape
from rsym.model.shape import Bounds, Shape
from rsym.program.calculus import FORMS
from rsym.sampling.contours import (
    LevelLines,
    LevelLinesStatus,
    move_onto_level,
    sparse,
    told,
    turned_like,
    turns,
    within,
)
from rsym.sampling.isolines import index_lines
from rsym.sampling.outlines import known_outline, level_outline
from rsym.sampling.plane import GivenField, PlaneSampler, plane_sampler, plane_section
from rsym.sampling.undefined import warn_undefined


@overload
def level_lines(
    shape: Shape | GivenField,
    level: float = 0.0,
    *,
    field: str = "value",
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    force: bool = False,
) -> LevelLines: ...
@overload
def level_lines(
    shape: Shape | GivenField,
    level: Sequence[float] | Floats,
    *,
    field: str = "value",
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    force: bool = False,
) -> tuple[LevelLines, ...]: ...
def level_lines(
    shape: Shape | GivenField,
    level: float | Sequence[float] | Floats = 0.0,
    *,
    field: str = "value",
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    force: bool = False,
) -> LevelLines | tuple[LevelLines, ...]:
    """The curves field = level, every vertex moved onto the level by Newton steps.

    Parameters
    ----------
    shape : Shape, Solution or Torsion
        A shape in the plane, or one in space with ``section={z: 1.0}``; or what `solve` found, lines end with it.
    level : float or sequence of float
        The level, or several: the field is compiled and sampled once for all of them.
    field : str
        A scalar field of `compile`.
    resolution : int or two ints
        Square cells along the longer side, or cells along each axis.
    bounds, letters
        Override those of the shape; lines end at them. Without any bounds those of `extent` are taken, and an eighth
        around them.
    force : bool
        Whether to go on where the estimate says that there is not memory enough.

    Returns
    -------
    LevelLines, or a tuple of them
        For each level, in the order given, a sequence of (n, 2) arrays with the region where the field exceeds the
        level to their left; ``.length``, ``.area`` and ``.to_shapely()`` measure it. At level 0, and at others of a
        value that is a min and max (of R1), corners are exact, but those under roots, and vertices on straight parts
        are left out; ``.status`` counts corners that are cut off, and the vertices that could not be moved. What is
        thinner than a cell is looked for where omega, or omega normalised, is 0; elsewhere ``.status`` says that it
        was not.

    Raises
    ------
    RsymError
        For a shape in space without a section, a zero set without end and no bounds, an unknown field.

    Warns
    -----
    RsymWarning
        Where omega has no value in some of the bounds: there the parts that have one decide.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-1.5, 1.5), (-1.5, 1.5)))
    >>> (circle,) = rsym.level_lines(disc, resolution=32)
    >>> bool(abs(np.hypot(*circle.T) - 1).max() < 1e-12)
    True
    >>> [round(float(np.hypot(*lines[0].T).max()), 3) for lines in rsym.level_lines(disc, [0.75, 0.19], resolution=32)]
    [0.5, 0.9]
    """
    require_shape(shape.shape if isinstance(shape, GivenField) else shape)
    asked: Any = level if isinstance(level, Sequence | np.ndarray) and not isinstance(level, str) else [level]
    wanted = [float(real_number(one, "the level")) for one in asked]
    if not wanted:
        raise RsymError("no level is given", code="levels", remedy="level=0, or level=[-1, 0, 1]")
    options: dict[str, Any] = {"resolution": resolution, "bounds": bounds, "letters": letters, "section": section}
    sampler = plane_sampler(shape, field, force=force, **options)
    values = sampler.values()
    if isinstance(shape, GivenField):
        inside = plane_sampler(shape.shape, "value", resolution=resolution, bounds=bounds, section=section, force=force)
        values = np.where(inside.values() >= 0, values, np.nan)
    elif field == "value":
        warn_undefined(plane_section(shape, section)[0], sampler.bounds, letters)
    zero: LevelLines | None = None
    if 0 in wanted and field in {"normalised", *FORMS} and isinstance(shape, Shape):  # zero where omega is
        zero = replace(level_lines(shape, force=force, **options), field=field)
    found = tuple(
        zero if one == 0 and zero is not None else trace(sampler, one, field, values=values, bounds=sampler.bounds)
        for one in wanted
    )
    return found if asked is level else found[0]


def dense_outline(shape: Shape, resolution: int, bounds: Bounds | None = None) -> LevelLines:
    """The lines omega = 0 of a plane shape with a vertex on each edge of the lattice, on straight parts too.

    Examples
    --------
    >>> import rsym
    >>> [len(lines(rsym.rectangle(1, 1), resolution=16)[0]) for lines in (level_lines, dense_outline)]
    [5, 61]
    """
    return told(known_outline(plane_sampler(shape, "value", resolution=resolution, bounds=bounds), cut=True))


def trace(
    sampler: PlaneSampler,
    level: float,
    field: str = "value",
    *,
    values: Floats | None = None,
    bounds: Bounds | None = None,
) -> LevelLines:
    """The level lines of a prepared field over its lattice, or within bounds; `values` are its samples, if known."""
    if level == 0 and field == "value" and sampler.given is None:
        return told(sparse(known_outline(sampler, cut=bounds is not None)))
    values = sampler.values() if values is None else values
    if field == "value" and sampler.given is None and not np.isnan(values).all():
        exact = level_outline(sampler, level, values, cut=bounds is not None)
        if exact is not None:
            return told(sparse(exact))
    undefined = int(np.count_nonzero(np.isnan(values)))
    if undefined == values.size:
        raise RsymError(f"the field {field!r} is undefined in all of the bounds", code="undefined")
    found = [line[::-1] for line in index_lines(values, level)]
    every = sampler.lattice.points(np.concatenate([*found, np.empty((0, 2))]))
    points, good = move_onto_level(sampler, every, level)  # all at once: each vertex goes by itself
    parts = np.cumsum([len(line) for line in found])[:-1]
    pieces = zip(np.split(points, parts), np.split(good, parts), found, strict=True) if found else ()
    moved = [turned_like((place, arrived), line) for place, arrived, line in pieces]
    if bounds is not None:
        moved = within(sampler, moved, level, bounds)
    lines = tuple(line for line, _ in moved)
    closed = sum(bool((line[0] == line[-1]).all()) for line in lines)
    status = LevelLinesStatus(
        vertices=sum(map(len, lines)),
        kept=sum(int((~good).sum()) for _, good in moved),
        undefined_samples=undefined,
        closed=closed,
        open=len(lines) - closed,
        unresolved_corners=turns(sampler, lines),
        examined=False,
    )
    return sparse(LevelLines(lines, level, field, status))
