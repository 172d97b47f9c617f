"""Pictures of nothing: what a picture in the plane does not show, where that may be seen instead."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Bounds, Shape
from rsym.sampling.extent import extent
from rsym.sampling.plane import PlaneSampler, plane_section

MOST_UNDEFINED = 0.5  # of the samples of a picture
# A zero set without inside, a curve, is between samples: there omega is less than what it changes over so many cells.
NEAR = 2.0
EXACT = 1e-9  # of a step: what is rounded already stays


def missing_boundary(shape: Shape, omega: PlaneSampler, values: Floats, lines: Sequence[Any]) -> str:
    """The words for a picture without boundary: what is seen, and where there is one; empty if nothing is missing.

    Parameters
    ----------
    shape : Shape
        What is drawn.
    omega : PlaneSampler
        The samples of omega in the picture.
    values, lines
        What they are, and the boundary that was found in them.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.sampling.plane import plane_sampler
    >>> disc = rsym.Shape(1 - (x - 9)**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> seen = plane_sampler(disc, "value", resolution=16)
    >>> print(missing_boundary(disc, seen, seen.values(), ()))
    no boundary in the bounds ((-2, 2), (-2, 2)): omega is negative all over; \
remedy: bounds=((7.98, 10.02), (-1.02, 1.02)), where the boundary lies
    """
    if not lines and (_is_zero(values) or not _may_touch_zero(omega, values)):
        return _no_boundary(shape, omega, values)
    return "; remedy: ".join(_outside_bounds(shape, omega)) if omega.fixed else ""


def undefined_picture(field: str, values: Floats) -> str:
    """The words for a field that is undefined on most of a picture; empty for one that is not.

    Examples
    --------
    >>> undefined_picture("curvature", np.array([1.0, np.nan, np.nan, np.nan]))
    "the field 'curvature' is undefined on 75 % of the picture; remedy: other bounds, or a field that is defined there"
    >>> undefined_picture("curvature", np.array([1.0, 2.0, np.nan, 0.0]))
    ''
    """
    share = float(np.isnan(values).mean())
    if share <= MOST_UNDEFINED:
        return ""
    return (
        f"the field {field!r} is undefined on {min(99.0, 100 * share):.0f} % of the picture; "
        "remedy: other bounds, or a field that is defined there"
    )


def where_it_lies(shape: Shape, letters: Mapping[Any, float] | None) -> str:
    """The bounds of the boundary of a shape as they are written in a call; empty where they cannot be found.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> where_it_lies(rsym.Shape(1 - x**2 - y**2, (x, y)), None)
    'bounds=((-1.02, 1.02), (-1.02, 1.02))'
    """
    found = _extent(shape, letters)
    return f"bounds={_written(found)}" if isinstance(found, tuple) else ""


def _no_boundary(shape: Shape, omega: PlaneSampler, values: Floats) -> str:
    names = omega.kernel.program.coordinates
    signs = "positive" if np.nanmin(values) > 0 else "negative" if np.nanmax(values) < 0 else "of no sign that changes"
    signs = "0" if _is_zero(values) else signs
    cut = ", ".join(f"{names[k]} = {value:.6g}" for k, value in omega.fixed.items())
    where = f"in the section {cut}" if cut else f"in the bounds {_written(omega.bounds)}"
    flat, _ = plane_section(shape, {names[k]: value for k, value in omega.fixed.items()})
    text = f"no boundary {where}: omega is {signs} all over"
    found = _extent(flat, omega.letters)
    if isinstance(found, tuple):
        return f"{text}; remedy: bounds={_written(found)}, where the boundary lies"
    whole = _extent(shape, omega.letters) if omega.fixed else found
    if isinstance(whole, tuple):
        ends = ", ".join(f"{names[k]} between {whole[k][0]:.3g} and {whole[k][1]:.3g}" for k in omega.fixed)
        return f"{text}; remedy: a section with {ends}, where the boundary lies"
    nowhere = not omega.fixed and found == "empty"
    return f"{text}; remedy: {'check signs and letters, for there is none anywhere' if nowhere else 'other bounds'}"


def _outside_bounds(shape: Shape, omega: PlaneSampler) -> Iterator[str]:
    """That a section lies outside the bounds of the shape, and what lies inside."""
    names = omega.kernel.program.coordinates
    if shape.bounds is not None and len(shape.bounds) == len(names):
        for k, value in omega.fixed.items():
            low, high = shape.bounds[k]
            if not low <= value <= high:
                yield f"the section {names[k]} = {value:.6g} lies outside the bounds of the shape"
                yield f"{names[k]} between {low:.6g} and {high:.6g}"
                return


def _is_zero(values: Floats) -> bool:
    """Whether a field is 0 wherever it is defined."""
    return bool((np.abs(values) > 0).sum() == 0 < np.isfinite(values).sum())


def _may_touch_zero(omega: PlaneSampler, values: Floats) -> bool:
    """Whether there may be a zero between samples, beside the one that is nearest to it."""
    if np.isnan(values).all():
        return True
    place = np.unravel_index(np.nanargmin(np.abs(values)), values.shape)
    with np.errstate(all="ignore"):
        value, gradient = omega.value_and_gradient(omega.lattice.points(np.array([place])))
    steepness = float(np.hypot(*gradient[0]))
    cell = max(omega.lattice.spacing)
    return not np.isfinite(steepness) or float(np.abs(value[0])) <= NEAR * cell * steepness


def _extent(shape: Shape, letters: Mapping[Any, float] | None) -> Bounds | str:
    """The box around the boundary, or the code of the reason why there is none."""
    try:
        return extent(shape, letters)
    except RsymError as error:
        return error.code


def _written(bounds: Bounds) -> str:
    """Three digits, rounded outwards."""
    ends = []
    for low, high in bounds:
        step = 10.0 ** (math.floor(math.log10(high - low)) - 2)
        ends.append(f"({math.floor(low / step + EXACT) * step:.6g}, {math.ceil(high / step - EXACT) * step:.6g})")
    return f"({', '.join(ends)})"
