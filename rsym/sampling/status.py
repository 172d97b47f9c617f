"""What is known of a mesh: what its mesher found on the way, and what its triangles tell."""

from __future__ import annotations

import collections
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

from rsym.reports.document import Document, Entry, Sentence
from rsym.reports.numbers import point
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.sampling.detail import Detail
from rsym.sampling.lattice import BoundsSide
from rsym.sampling.manifolds import Measures, Point

# Walls of constant thickness below this share of a cell leave crumbs, which are told as small pieces anyway.
KNIFE_EDGE = 0.1
# A fold that covers less than this share of the area is a speck between two faces; the status counts it all the same.
NOTABLE_FOLD = 1e-6
# Of cells of which nothing is proved: more are no places but a surface whose bounds are wide, which a finer lattice
# leaves unproved too, after a long time.
PLACES = 4096


class Wording(NamedTuple):
    """What a suspect is called, alone and among several, and the sentence that describes it."""

    one: str
    many: str
    sentence: str


_THIN = "{self.thickness:.2g} cells {wide} {near}; {self.finer:.2g} times the resolution puts 2 cells across it"
UNRESOLVED = "Unresolved: "
KINDS = {
    "wall": Wording("wall", "walls", "a wall{of}, " + _THIN.replace("{wide}", "thick")),
    "gap": Wording("gap", "gaps", "a gap{of}, " + _THIN.replace("{wide}", "wide")),
    "sheet": Wording(
        "sheet without a change of sign",
        "sheets without a change of sign",
        "the equation is zero without a change of sign{of}, in {cells} {near}; a mesh cannot show that",
    ),
    "touch": Wording(
        "contact of bodies",
        "contacts of bodies",
        "bodies touch{of} {near}; at no resolution is the surface a manifold there",
    ),
    "knife": Wording(
        "edge that tapers to nothing",
        "edges that taper to nothing",
        "an edge{of} tapers to nothing, in {cells} {near}; no resolution resolves all of it",
    ),
    "apex": Wording(
        "tip", "tips", "the gradient{of} vanishes on the surface {near}, as at a tip; no resolution resolves that"
    ),
    "unresolved": Wording(
        "place of which nothing is proved",
        "places of which nothing is proved",
        "nothing is proved of the surface{of} in {cells} {near}, where it may turn too sharply",
    ),
}


@dataclass(frozen=True)
class Suspect:
    """Something that a lattice may have missed.

    Attributes
    ----------
    kind : {"wall", "gap", "sheet", "touch", "knife", "apex", "unresolved"}
        A wall or a gap that is thin; a zero set where the sign does not change; bodies that touch; an edge that
        tapers to nothing; a point of the surface where the gradient vanishes; none of these.
    place : (x, y, z)
        Where it is thinnest.
    thickness : float
        Across it, in cells; 0 but for walls and gaps.
    cells : int
        How many cells without a certificate belong to it.
    leaves : tuple of int
        The leaves that meet there.
    names : tuple of str
        What they are called.

    Examples
    --------
    >>> print(Suspect("gap", (0.0, 1.0, 2.0), 0.5, 12, (0, 3), ("arch", "wheel")).remark)
    Unresolved: a gap between arch and wheel, 0.5 cells wide near (0, 1, 2); 4 times the resolution puts 2 cells \
across it.
    """

    kind: str
    place: tuple[float, float, float]
    thickness: float
    cells: int
    leaves: tuple[int, ...]
    names: tuple[str, ...] = ()

    @property
    def remark(self) -> str:
        """A sentence that says what is there, and where."""
        cells = plural(self.cells, "cell")
        near = f"near {point(self.place, 4)}"
        sentence = KINDS[self.kind].sentence.format(self=self, of=self._of, near=near, cells=cells)
        return f"{UNRESOLVED}{sentence}."

    @property
    def _of(self) -> str:
        if not self.names:
            return ""
        return f" {'of' if len(self.names) == 1 else 'between'} {' and '.join(self.names)}"

    @property
    def finer(self) -> float:
        """How many times the resolution puts two cells across it; infinite where none resolves it."""
        return 2 / self.thickness if self.thickness else math.inf


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
    sides : tuple of BoundsSide
        The sides of the bounds, all of them.
    resolution : int or three ints, optional
        Cells along the longest side, or along each axis.
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
    examined : bool
        Whether what is thinner than a cell was looked for.
    """

    clipped_at: tuple[str, ...] = ()
    capped: bool = False
    sides: tuple[BoundsSide, ...] = ()
    resolution: int | Sequence[int] | None = None
    nudged_zeros: int = 0
    kept: int = 0
    off_surface: OffSurface | None = None
    unresolved: tuple[Suspect, ...] = ()
    thin: Detail | None = None
    small: Detail | None = None
    examined: bool = True

    def moved(self, image: Callable[[Point], Point], sides: tuple[BoundsSide, ...]) -> Findings:
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
    def finer(self) -> float | None:
        """How many times the resolution puts two cells across every unresolved wall and gap; None if there is none."""
        return max((suspect.finer for suspect in self.unresolved if suspect.thickness), default=None)

    @property
    def refinable(self) -> float | None:
        """How many times the resolution may leave less to say; None where no resolution does."""
        details = (_times(2, self.thin), _times(6, self.small))
        unproved = sum(one.cells for one in self.unresolved if one.kind == "unresolved")
        doubled = [2.0] if self.off_surface or 0 < unproved <= PLACES else []
        known = (*doubled, *(times for times in (self.finer, *details) if times is not None))
        return max(known, default=None)

    @property
    def remarks(self) -> tuple[str, ...]:
        """All that one should know before using the mesh, a sentence each."""
        return (*self._of_clipping(), *(suspect.remark for suspect in self.unresolved), *self._of_the_rest())

    @property
    def brief(self) -> tuple[str, ...]:
        """The same in three lines at most: what is unresolved is counted, and its worst place told."""
        lines = (*self._of_clipping(), *_in_brief(self.unresolved), " ".join(self._of_the_rest()))
        return tuple(line for line in lines if line)

    def _of_clipping(self) -> Iterable[str]:
        if self.clipped_at:
            sides = ", ".join(self.clipped_at)
            if self.capped:
                yield f"The body leaves the bounds and is clipped at {sides}; flat caps close it there."
            else:
                yield f"The surface leaves the bounds at {sides}; wider bounds close it."

    def _of_the_rest(self) -> Iterable[str]:
        if self.off_surface is not None:
            off = self.off_surface
            yield (
                f"{plural(off.vertices, 'vertex is', 'vertices are')} off the surface,"
                f" at worst by {off.cells:.2g} cells near {off.worst_at}."
            )
        if self.nudged_zeros:
            samples = plural(self.nudged_zeros, "sample")
            yield f"{samples} lay exactly on the surface and were counted as inside; another resolution may avoid them."
        if self.thin is not None:
            yield (
                f"At {plural(self.thin.places, 'place')} a wall or a gap is thinner than a cell, at worst"
                f" {self.thin.cells:.2g} cells near {self.thin.finest}; {_finer(2, self.thin)}."
            )
        if self.small is not None:
            yield (
                f"{plural(self.small.places, 'piece is', 'pieces are')} smaller than three cells, the smallest"
                f" {self.small.cells:.2g} cells near {self.small.finest}; {_finer(6, self.small)}."
            )


@dataclass(frozen=True, kw_only=True)
class MeshStatus(Measures, Findings, Report):
    """The findings of the mesher and the measures of the triangles, in one record."""

    @property
    def closed(self) -> bool:
        """Whether every directed edge occurs once and its reverse once."""
        return self.boundary_edges == 0 and self.repeated_edges == 0

    def document(self) -> Document:
        """All that the status says; nothing of it is proved."""
        pieces = "one piece" if self.components == 1 else f"{self.components} pieces"
        shape = f"{self.triangles} triangles in {pieces}, {self._state}"
        # No remark: float32 put them on a lattice point, so they are off by a ten-thousandth of a cell.
        kept = [f"Vertices unresolved, kept where linear interpolation put them: {self.kept}."] if self.kept else []
        kept += [] if self.examined else ["What is thinner than a cell was not looked for."]
        places = tuple(Entry(suspect.remark, False, told=False) for suspect in self.unresolved)
        return Document(
            "mesh-status",
            Sentence(f"{shape}; Euler characteristic {self.euler_characteristic}.", False),
            sentences=tuple(Sentence(text, False) for text in (*kept, *self.brief)),
            entries=places,
            data={
                "closed": self.closed,
                "clipped_at": self.clipped_at,
                "capped": self.capped,
                "nudged_zeros": self.nudged_zeros,
                "unresolved": self.unresolved,
                **{part.name: getattr(self, part.name) for part in fields(Measures) if part.name != "loops"},
            },
        )

    @property
    def _state(self) -> str:
        if self.closed:
            return f"closed: every edge joins two of them, and they enclose a volume of {self.volume:.6g}"
        if self.clipped and not self.repeated_edges:
            chains = plural(len(self.loops), "loop")
            return f"clipped: {self.boundary_edges} open edges in {chains} on the sides of the bounds"
        return f"open: {self.boundary_edges} edges have one triangle, {self.repeated_edges} more than two"

    def _of_the_rest(self) -> Iterable[str]:
        """What the findings say, and what is wrong with the triangles."""
        yield from super()._of_the_rest()
        notable = self.folded if self.folded_share > NOTABLE_FOLD else 0
        faults = [
            (notable, f"facing inwards, {self.folded_share:.1e} of the area"),
            (self.degenerate, "without area"),
            (self.duplicates, "with the vertices of another"),
        ]
        yield from (f"{plural(count, 'triangle')} {what}." for count, what in faults if count)
        if self.pinched:
            yield f"At {plural(self.pinched, 'vertex', 'vertices')} the surface touches itself."


def _in_brief(suspects: tuple[Suspect, ...]) -> Iterable[str]:
    """How many of each kind there are, and the worst of them: the thinnest, or the first."""
    if len(suspects) > 1:
        kinds = collections.Counter(suspect.kind for suspect in suspects)
        *some, last = (plural(count, KINDS[kind].one, KINDS[kind].many) for kind, count in kinds.items())
        worst = min(suspects, key=lambda suspect: suspect.thickness or math.inf).remark.removeprefix(UNRESOLVED)
        yield f"{UNRESOLVED}{', '.join(some)}{' and ' if some else ''}{last}; at worst {worst}"
    else:
        yield from (suspect.remark for suspect in suspects)


def _finer(cells: int, detail: Detail) -> str:
    """The resolution that puts so many cells across a detail; an edge like a knife's has none."""
    times = _times(cells, detail)
    if times is None:
        return "it may taper to an edge, which no resolution resolves"
    return f"{times:.2g} times the resolution puts {cells} cells across it"


def _times(cells: int, detail: Detail | None) -> float | None:
    return None if detail is None or detail.cells < KNIFE_EDGE else cells / detail.cells
