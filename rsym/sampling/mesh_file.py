"""A mesh that is in a file, never in memory as a whole, with what is known of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rsym.model.shape import Bounds
from rsym.reports.document import Document, Entry, Sentence
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.sampling.memory import size_of
from rsym.sampling.status import Findings

SUFFIXES = (".ply", ".stl")


@dataclass(frozen=True, kw_only=True)
class FileStatus(Findings, Report):
    """The findings of the mesher, and what was measured while triangles went by.

    Attributes
    ----------
    vertices, triangles : int
    unpaired : int
        0 where every directed edge occurs as often as its reverse, else some other number: the sum of a 64-bit hash of
        each edge, with the sign of its direction.
    volume, area : float
    bounds : ((xmin, xmax), (ymin, ymax), (zmin, zmax))
    pieces : int
        In how many pieces the surface was computed.
    memory : float
        The bytes that were allowed.
    """

    vertices: int
    triangles: int
    unpaired: int
    volume: float
    area: float
    bounds: Bounds
    pieces: int
    memory: float

    @property
    def closed(self) -> bool:
        """Whether every directed edge occurs as often as its reverse, but for one chance in 1e19."""
        return self.unpaired == 0

    def document(self) -> Document:
        """All that the status says; nothing of it is proved."""
        state = "closed: they enclose a volume of" if self.closed else "open: some edges have one triangle; the sum is"
        head = (
            f"{self.triangles} triangles, {state} {self.volume:.6g}; computed in {plural(self.pieces, 'piece')} within"
            f" {size_of(self.memory)}."
        )
        return Document(
            "mesh-file",
            Sentence(head, False),
            sentences=tuple(Sentence(text, False) for text in self.brief),
            entries=tuple(Entry(suspect.remark, False, told=False) for suspect in self.unresolved),
            data={
                "closed": self.closed,
                "clipped_at": self.clipped_at,
                "capped": self.capped,
                "unresolved": self.unresolved,
                **{name: getattr(self, name) for name in _MEASURED},
            },
        )

    def _of_the_rest(self) -> Iterable[str]:
        yield from super()._of_the_rest()
        if not self.closed:
            yield "The triangles do not close."


_MEASURED = ("vertices", "triangles", "volume", "area", "bounds", "pieces", "memory")


@dataclass(frozen=True, repr=False)
class MeshFile:
    """A mesh in a file: what `rsym.mesh` gives when it is told where to put the triangles.

    Attributes
    ----------
    path : Path
        The file.
    status : FileStatus
        What is known of the triangles: how many, whether they close, volume, area, bounds; what the lattice may have
        missed.

    Examples
    --------
    >>> import tempfile, rsym
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     made = rsym.mesh(rsym.box(1, 2, 3), 12, bounds=((-1, 1), (-2, 2), (-2, 2)), into=folder + "/box.ply")
    ...     made.path.name, made.status.closed, round(made.volume, 9)
    ('box.ply', True, 6.0)
    """

    path: Path
    status: FileStatus

    @property
    def findings(self) -> Findings:
        """What the mesher knows beside the triangles."""
        return self.status

    @property
    def vertices(self) -> int:
        """How many vertices there are."""
        return self.status.vertices

    @property
    def faces(self) -> int:
        """How many triangles there are."""
        return self.status.triangles

    @property
    def volume(self) -> float:
        """The volume that the triangles enclose, sum a x b . c/6 over them."""
        return self.status.volume

    @property
    def area(self) -> float:
        """The area of the triangles."""
        return self.status.area

    @property
    def bounds(self) -> Bounds:
        """The box around the triangles."""
        return self.status.bounds

    def __repr__(self) -> str:
        return f"MeshFile({str(self.path)!r}, {self.vertices} vertices, {self.faces} triangles)"
