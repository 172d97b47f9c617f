"""A field of a shape on a plane lattice: the shape's own plane, or a section of a shape in space."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.backends.kernel import Kernel, compile_program
from rsym.errors import RsymError
from rsym.logic.inside import known_kernel
from rsym.model.bounding import hull
from rsym.model.letters import real_number
from rsym.model.recent import recently
from rsym.model.shape import Bounds, Shape
from rsym.model.wording import proposal
from rsym.program.calculus import SCALARS
from rsym.program.fields import program_of
from rsym.sampling.lattice import Lattice, lattice_over
from rsym.sampling.memory import Demand
from rsym.sampling.windows import SURROUNDINGS, bounds_or_extent, check_letters

# Of one field that is drawn, measured on a section of the car at 4000 cells.
SAMPLES = Demand(memory=85.0, time=4e-7)


@runtime_checkable
class GivenField(Protocol):
    """A field on a shape that is no field of the shape: a solution of an equation there."""

    @property
    def shape(self) -> Shape:
        """What it is a field on."""

    def sampled(
        self, *coordinates: Any, field: str = "value", letters: Mapping[Any, float] | None = None
    ) -> dict[str, NDArray[Any]]:
        """One of `GIVEN_FIELDS` with its gradient at points, as a kernel has them; beside the shape as it goes on."""

    def with_letters(self, values: Mapping[Any, float]) -> GivenField:
        """The same for other letters."""


GIVEN = "u"  # what such a field is called
GIVEN_FIELDS = ("value", "gradient_squared", "laplacian")


@dataclass(frozen=True)
class PlaneSampler:
    """Values and in-plane gradient of one scalar field, as functions of the two free coordinates.

    What it is evaluated by is made when it is asked for, if no kernel, of other fields say, is given.
    """

    shape: Shape
    field: str
    lattice: Lattice
    free: tuple[int, int]
    fixed: Mapping[int, float]
    letters: Mapping[Any, float] | None
    bounds: Bounds
    given: Callable[..., dict[str, NDArray[Any]]] | None = None

    @property
    def names(self) -> tuple[str, str]:
        """The names of the free coordinates."""
        first, second = (self.shape.coordinates[k].name for k in self.free)
        return first, second

    @cached_property
    def kernel(self) -> Any:
        """Value and gradient of the field."""
        return _kernel(self.shape, self.field, bool(self.fixed)) if self.given is None else self.given

    @property
    def regions(self) -> Any:
        """Of the value of a large plane shape kernels that evaluate at each place what matters there; else None.

        Of a section they take longer to make than they spare: of 1000 balls 1.5 s for 0.1 s in each picture.
        """
        return _regions(self.shape) if self.field == "value" and not self.fixed else None

    def at(self, letters: Mapping[Any, float] | None, section: Mapping[Any, float] | None = None) -> PlaneSampler:
        """The same with other letters, and in another section along the same coordinates; nothing is compiled."""
        fixed = dict(self.fixed)
        if section is not None:
            fixed = fixed_coordinates([symbol.name for symbol in self.shape.coordinates], section)
            if fixed.keys() != self.fixed.keys():
                raise RsymError("the section must fix the same coordinates as before", code="section")
        return replace(self, letters=letters, fixed=fixed)

    def values(self) -> Floats:
        """The field on the lattice, (nx, ny); infinite and undefined values as NaN."""
        if self.regions is None:
            return self.samples()["value"]
        from rsym.sampling.plane_regions import values_on

        return values_on(self.regions, self.lattice, self.shape.letters.values_with(self.letters))

    def signs(self) -> Floats:
        """The sign of the value on the lattice, (nx, ny): 1 inside and on the boundary, -1 outside, else NaN."""
        if self.large is not None:
            found, undefined = self.large.signs_on(self.lattice)
            if not undefined:
                return np.asarray(found, np.float64)
        values = self.values()
        if self.known is not None and not np.isnan(values).all():
            u, v = self.lattice.open_axes()
            values = self._call(u, v, self.known)["value"]
        signs: Floats = np.where(np.isnan(values), np.nan, np.where(values >= 0, 1.0, -1.0))
        return signs

    def samples(self) -> dict[str, Floats]:
        """Every scalar field of the kernel on the lattice, as `values`."""
        found = self._call(*self.lattice.open_axes())
        return {name: np.where(np.isfinite(found[name]), found[name], np.nan) for name in found if name in SCALARS}

    def value_and_gradient(self, points: Floats) -> tuple[Floats, Floats]:
        """At points (n, 2): the value (n,) and the gradient (n, 2)."""
        result = self._call(points[:, 0], points[:, 1])
        return result["value"], result["gradient"][:, list(self.free)]

    def inside(self, points: Floats) -> Flags:
        """Whether the value at points (n, 2) is positive; of a large shape 0 is inside, as on the lattice of signs."""
        if self.known is not None:
            return self._call(points[:, 0], points[:, 1], self.known)["value"] > 0
        if self.large is None:
            positive: Flags = self.value_and_gradient(points)[0] > 0
            return positive
        found: Flags = self.large.value(points)[0] >= 0
        return found

    @cached_property
    def large(self) -> Any:
        """The sign form of the value of a large shape, evaluated by what matters at a place; else None."""
        if self.field != "value":
            return None
        return large_form(self.shape, self.free, self.fixed, self.letters, self.bounds)

    @cached_property
    def known(self) -> Kernel | None:
        """What has the signs of the value where that says too little: it jumps, or parts of it have none."""
        return None if self.field != "value" or self.given is not None else known_kernel(self.shape)

    def _call(self, u: Floats, v: Floats, by: Any = None) -> dict[str, NDArray[Any]]:
        coordinates: list[Any] = [None] * (2 + len(self.fixed))
        coordinates[self.free[0]], coordinates[self.free[1]] = u, v
        for position, value in self.fixed.items():
            coordinates[position] = value
        found: dict[str, NDArray[Any]] = (by or self.kernel)(*coordinates, letters=self.letters)
        return found


def plane_sampler(
    shape: Shape | GivenField,
    field: str,
    *,
    resolution: Any,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    held: int = 1,
    force: bool | None = None,
) -> PlaneSampler:
    """Prepare a field for sampling in the plane; `section={z: 1.0}` cuts a shape in space.

    More samples than there is memory for, where so many fields are held at once, are refused, unless forced; None
    where the caller cannot be.
    """
    checked_scalar(field)
    on, given = (shape.shape, partial(shape.sampled, field=field)) if isinstance(shape, GivenField) else (shape, None)
    if given is not None:
        if field not in GIVEN_FIELDS:
            raise RsymError(
                f"a solution has no field {field!r}",
                code="unknown-field",
                remedy=f"choose from {', '.join(GIVEN_FIELDS)}; solution.shape has those of the shape",
            )
        if letters:
            raise RsymError(
                "a solution is one for its letters", code="letters", remedy="draw solution.with_letters({...})"
            )
        field = GIVEN if field == "value" else field
    if field == "curvature" and section:
        on, bounds = plane_section(on, section, bounds)
        section = None
    names = [symbol.name for symbol in on.coordinates]
    fixed = fixed_coordinates(names, section)
    free = _free_coordinates(names, fixed)
    box, lattice = _lattice_of_view(on, free, resolution, bounds, letters, section)
    replace(SAMPLES, memory=held * SAMPLES.memory, time=held * SAMPLES.time).check(
        resolution, lattice.counts, force=force
    )
    return PlaneSampler(on, field, lattice, free, fixed, letters, box, given)


@recently(16)
def _kernel(shape: Shape, field: str, cut: bool) -> Kernel:
    """Value and gradient of a field; where regions have the values of a lattice few points are left to a tape."""
    program = program_of(shape, ("value", "gradient"), of=field, share=None)
    backend = "tape" if field == "value" and not cut and _regions(shape) is not None else None
    return compile_program(program, ("value", "gradient"), shape, backend=backend)


def _regions(shape: Shape) -> Any:
    """Kernels for the value of a large shape, where the packages for them are there."""
    try:
        from rsym.sampling.plane_regions import value_kernels
    except (ImportError, OSError):
        return None
    return value_kernels(shape)


def large_form(
    shape: Shape,
    free: tuple[int, int],
    fixed: Mapping[int, float],
    letters: Mapping[Any, float] | None,
    bounds: Bounds | None,
) -> Any:
    """The sign form of a large shape in a plane, by tapes, where the packages for them are there; else None."""
    try:
        from rsym.sampling.plane_regions import plane_form
    except (ImportError, OSError):
        return None
    return plane_form(shape, free, fixed, letters, bounds)


@dataclass(frozen=True)
class PlaneView:
    """A plane shape, and the lattice on which it is looked at."""

    shape: Shape
    lattice: Lattice

    @property
    def names(self) -> tuple[str, str]:
        """The names of the coordinates."""
        first, second = (symbol.name for symbol in self.shape.coordinates)
        return first, second


def signs_of(view: PlaneView, letters: Mapping[Any, float] | None = None) -> NDArray[np.int8]:
    """The sign at the points of the lattice, (nx, ny): 1 inside and on the boundary, -1 elsewhere."""
    try:
        from rsym.sampling.plane_regions import signs_on
    except (ImportError, OSError):  # without the packages for them every point is asked
        inside = _kernel(view.shape, "value", False)(*view.lattice.open_axes(), letters=letters)["value"] >= 0
        return np.where(inside, 1, -1).astype(np.int8)
    return signs_on(view.shape, view.lattice, letters)


def plane_view(
    shape: Shape,
    resolution: Any,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
) -> PlaneView:
    """The shape, or its section, with the lattice that a sampler of it would have; nothing is compiled."""
    flat, box = plane_section(shape, section, bounds)
    free = _free_coordinates([symbol.name for symbol in flat.coordinates], {})
    return PlaneView(flat, _lattice_of_view(flat, free, resolution, box, letters)[1])


def _lattice_of_view(
    shape: Shape,
    free: tuple[int, int],
    resolution: Any,
    bounds: Any,
    letters: Mapping[Any, float] | None,
    section: Mapping[Any, float] | None = None,
) -> tuple[Bounds, Lattice]:
    """The bounds of the free coordinates, and a lattice over them: those of a section, where only that is bounded."""
    box = bounds
    if bounds is None or len(bounds) == len(shape.coordinates):
        box = bounds_of_sections(shape, bounds, [section] if section else [], letters)
        box = tuple(box[k] for k in free) if len(box) == len(shape.coordinates) else box
    else:
        check_letters(shape, letters)
    flat = Shape(0, [shape.coordinates[k] for k in free], bounds=box)
    assert flat.bounds is not None
    return flat.bounds, lattice_over(flat.bounds, resolution, math.inf)


def bounds_of_sections(
    shape: Shape, bounds: Any, sections: Sequence[Mapping[Any, float]], letters: Mapping[Any, float] | None
) -> Bounds:
    """The bounds of a shape, or in the plane of all that sections of it hold, where it goes on without end."""
    try:
        return bounds_or_extent(shape, bounds, letters, room=SURROUNDINGS)
    except RsymError as error:
        if error.code != "unbounded" or not sections:
            raise
    boxes = []
    for section in sections:
        try:
            boxes.append(bounds_or_extent(plane_section(shape, section)[0], None, letters, room=SURROUNDINGS))
        except RsymError as error:
            if error.code != "empty" or (section is sections[-1] and not boxes):
                raise
    found = hull(boxes)
    assert found is not None
    return found


def plane_section(shape: Shape, section: Mapping[Any, float] | None, bounds: Any = None) -> tuple[Shape, Any]:
    """A section as a shape in the plane, with its fixed coordinate as a letter, and the bounds for it.

    What belongs to the plane line alone, such as its curvature, is derived from this shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> flat, _ = plane_section(rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)), {z: 0.6})
    >>> flat.coordinates, flat.letters["z"].default
    ((x, y), 0.6)
    """
    if not section:
        return shape, bounds
    names = [symbol.name for symbol in shape.coordinates]
    fixed = fixed_coordinates(names, section)
    free = _free_coordinates(names, fixed)
    given = tuple(bounds[k] for k in free) if bounds is not None and len(bounds) == len(names) else bounds
    own = shape.box and shape.box.mapped(lambda ends: tuple(ends[k] for k in free))
    letters: dict[str, Any] = {**shape.letters, **{names[k]: value for k, value in fixed.items()}}
    return Shape(shape.expression, [shape.coordinates[k] for k in free], letters=letters, box=own), given


def checked_scalar(field: str) -> str:
    """The name of a field with one value at a point."""
    if field not in SCALARS:
        remedy = proposal(field, SCALARS, f"choose from {', '.join(SCALARS)}")
        raise RsymError(f"no scalar field {field!r}", code="unknown-field", remedy=remedy)
    return field


def _free_coordinates(names: list[str], fixed: Mapping[int, float]) -> tuple[int, int]:
    free = [k for k in range(len(names)) if k not in fixed]
    if len(free) != 2:
        last = names[-1]
        cut = f"give section={{{last}: value}}, on the command line --section {last}=VALUE"
        raise RsymError(
            f"a picture in the plane needs two free coordinates, the shape has {', '.join(names)}",
            code="section",
            remedy=cut if len(free) > 2 else "leave out section",
        )
    return free[0], free[1]


def fixed_coordinates(names: list[str], section: Mapping[Any, float] | None) -> dict[int, float]:
    """The coordinates that a section fixes, by number."""
    fixed: dict[int, float] = {}
    for key, value in (section or {}).items():
        if str(key) not in names:
            raise RsymError(f"no coordinate {key} in {', '.join(names)}", code="section")
        fixed[names.index(str(key))] = float(real_number(value, f"section {key}"))
    return fixed
