"""What is known of a mesh: what its mesher found on the way, and what its triangles tell."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from rsym.sampling.detail import Detail
from rsym.sampling.manifolds import Measures, Point, Side

# Walls of constant thickness below this share of a cell leave crumbs, which are told as small pieces anyway.
KNIFE_EDGE = 0.1
# A fold that covers less than this share of the area is a speck between two faces; the status counts it all the same.
NOTABLE_FOLD = 1e-6
# So many suspects of one kind are told in full; the others are counted.
TOLD = 3


class Suspect(Protocol):
    """A place where the mesh may not show what the equation says."""

    @property
    def kind(self) -> str:
        """One word, the same for all suspects that one sentence describes."""

    @property
    def remark(self) -> str:
        """A sentence that says what is there, and where."""


@dataclass(frozen=True)
class OffSurface:
    """Vertices off the surface: how many, how many cells off at worst, and where."""

    vertices: int
    cells: float
    worst_at: Point


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What a mesher knows when it is done, without another look at the triangles.

    Attributes
    ----------
    clipped_at : tuple of str
        The sides of the bounds through which the surface leaves, as ``"the upper end of x"``.
    capped : bool
        Whether flat caps close it there.
    sides : tuple of Side
        The sides of the bounds, all of them.
    nudged_zeros : int
        Samples exactly on the surface, counted as inside.
    kept : int
        Vertices left where linear interpolation put them.
    off_surface : OffSurface, optional
        Vertices that are not on the surface to rounding.
    unresolved : tuple of Suspect
        Where something may be thinner than a cell, a zero sheet has no change of sign, or bodies touch.
    thin, small : Detail, optional
        Walls and gaps thinner than a cell; pieces of less than three cells.
    """

    clipped_at: tuple[str, ...] = ()
    capped: bool = False
    sides: tuple[Side, ...] = ()
    nudged_zeros: int = 0
    kept: int = 0
    off_surface: OffSurface | None = None
    unresolved: tuple[Suspect, ...] = ()
    thin: Detail | None = None
    small: Detail | None = None

    def moved(self, image: Callable[[Point], Point], sides: tuple[Side, ...]) -> Findings:
        """The same of a mesh whose points have moved; `sides` are the images of the sides, those that are sides still.

        Sizes in cells are those of the lattice that the mesh comes from.
        """

        def at(found: Any, name: str) -> Any:
            place = getattr(found, name, None)
            return found if place is None else replace(found, **{name: image(place)})

        return replace(
            self,
            sides=sides,
            off_surface=at(self.off_surface, "worst_at"),
            unresolved=tuple(at(suspect, "place") for suspect in self.unresolved),
            thin=at(self.thin, "finest"),
            small=at(self.small, "finest"),
        )

    @property
    def clipped(self) -> bool:
        """Whether the surface leaves the bounds."""
        return bool(self.clipped_at)

    @property
    def sheets(self) -> tuple[Suspect, ...]:
        """Where the equation is zero without a change of sign, which no mesh can show."""
        return tuple(suspect for suspect in self.unresolved if suspect.kind == "sheet")

    @property
    def touches(self) -> tuple[Suspect, ...]:
        """Where bodies touch, and the surface is no manifold at any resolution."""
        return tuple(suspect for suspect in self.unresolved if suspect.kind == "touch")

    @property
    def remarks(self) -> tuple[str, ...]:
        """What one should know before using the mesh, a sentence each; `rsym.mesh` warns of them."""
        remarks = [*_of_clipping(self), *_of_suspects(self.unresolved)]
        if self.off_surface is not None:
            off = self.off_surface
            remarks.append(
                f"{_plural(off.vertices, 'vertex is', 'vertices are')} off the surface,"
                f" at worst by {off.cells:.2g} cells near {off.worst_at}."
            )
        if self.nudged_zeros:
            samples = _plural(self.nudged_zeros, "sample", "samples")
            remarks.append(
                f"{samples} lay exactly on the surface and were counted as inside; another resolution may avoid them."
            )
        return (*remarks, *_of_detail(self.thin, self.small))


@dataclass(frozen=True, kw_only=True)
class MeshStatus(Measures, Findings):
    """The findings of the mesher and the measures of the triangles, in one record."""

    @property
    def closed(self) -> bool:
        """Whether every directed edge occurs once and its reverse once."""
        return self.boundary_edges == 0 and self.repeated_edges == 0

    def __str__(self) -> str:
        pieces = "one piece" if self.components == 1 else f"{self.components} pieces"
        text = (
            f"{self.triangles} triangles in {pieces}, {self._state}; Euler characteristic {self.euler_characteristic}."
        )
        if self.kept:
            # No remark: float32 put them on a lattice point, so they are off by a ten-thousandth of a cell.
            text += f" Vertices unresolved, kept where linear interpolation put them: {self.kept}."
        return " ".join([text, *self.remarks])

    @property
    def _state(self) -> str:
        if self.closed:
            return f"closed: every edge joins two of them, and they enclose a volume of {self.volume:.6g}"
        if self.clipped and not self.repeated_edges:
            chains = _plural(len(self.loops), "loop", "loops")
            return f"clipped: {self.boundary_edges} open edges in {chains} on the sides of the bounds"
        return f"open: {self.boundary_edges} edges have one triangle, {self.repeated_edges} more than two"

    @property
    def remarks(self) -> tuple[str, ...]:
        """The remarks of the findings, and what is wrong with the triangles."""
        notable = self.folded if self.folded_share > NOTABLE_FOLD else 0
        faults = [
            (notable, f"facing inwards, {self.folded_share:.1e} of the area"),
            (self.degenerate, "without area"),
            (self.duplicates, "with the vertices of another"),
        ]
        remarks = [f"{_plural(count, 'triangle', 'triangles')} {what}." for count, what in faults if count]
        if self.pinched:
            remarks.append(f"At {_plural(self.pinched, 'vertex', 'vertices')} the surface touches itself.")
        return (*super().remarks, *remarks)


def _of_clipping(found: Findings) -> Iterable[str]:
    if found.clipped_at:
        sides = ", ".join(found.clipped_at)
        if found.capped:
            yield f"The body leaves the bounds and is clipped at {sides}; flat caps close it there."
        else:
            yield f"The surface leaves the bounds at {sides}; wider bounds close it."


def _of_suspects(suspects: tuple[Suspect, ...]) -> Iterable[str]:
    """The first suspects of each kind in their own words, the others counted."""
    for kind in dict.fromkeys(suspect.kind for suspect in suspects):
        alike = [suspect.remark for suspect in suspects if suspect.kind == kind]
        yield from alike[:TOLD]
        if len(alike) > TOLD:
            yield f"{_plural(len(alike) - TOLD, 'more place', 'more places')} like these."


def _of_detail(thin: Detail | None, small: Detail | None) -> Iterable[str]:
    if thin is not None:
        yield (
            f"At {_plural(thin.places, 'place', 'places')} a wall or a gap is thinner than a cell, at worst"
            f" {thin.cells:.2g} cells near {thin.finest}; {_finer(2, thin)}."
        )
    if small is not None:
        yield (
            f"{_plural(small.places, 'piece is', 'pieces are')} smaller than three cells, the smallest"
            f" {small.cells:.2g} cells near {small.finest}; {_finer(6, small)}."
        )


def _plural(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def _finer(cells: int, detail: Detail) -> str:
    """The resolution that puts so many cells across a detail; an edge like a knife's has none."""
    if detail.cells < KNIFE_EDGE:
        return "it may taper to an edge, which no resolution resolves"
    return f"{cells / detail.cells:.2g} times the resolution puts {cells} cells across it"
