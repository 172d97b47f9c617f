"""A picture of rays as an array, with what every pixel sees."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Shorts
from rsym.atomic import write_atomically
from rsym.errors import RsymError
from rsym.model.requirements import file_path
from rsym.output.cameras import Camera, Viewport
from rsym.sampling.hits import Hits
from rsym.sampling.stills import png


@dataclass(frozen=True, eq=False, repr=False)
class Image:
    """A picture as `render` makes it: an array (h, w, 4) of uint8, red, green, blue and how opaque, row by row.

    What a pixel sees is that of the ray through its middle, in arrays (h, w): the numbers of what is not asked for are
    not computed.

    Attributes
    ----------
    pixels : (h, w, 4) array of uint8
        As ``np.asarray(image)``.
    view : Viewport
        The camera over these pixels: ``view.project(points)`` says where points are seen.
    camera : Camera
        The camera.
    leaves : tuple of str
        The names of the leaves, behind them the sections.
    scale, scale_label
        The colours of values for ``figure.colorbar(image.scale)`` and their name; None and empty without.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> image = rsym.render(rsym.sphere(2).named("ball"), size=(40, 30))
    >>> np.asarray(image).shape, image.parts
    ((30, 40, 4), {'ball': '#77aadd'})
    >>> image.leaf.max(), image.part.max(), image.curvature[15, 20].round(9).tolist()
    (np.int16(0), np.int16(0), [0.5, 0.5])
    """

    pixels: NDArray[np.uint8]
    view: Viewport
    camera: Camera
    hits: Hits
    leaves: tuple[str, ...]
    coordinates: tuple[str, ...]
    scale: ScalarMappable | None
    scale_label: str
    parts_seen: Callable[[], Mapping[str, str]] = field(repr=False)
    legend: bool = False

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False and dtype not in (None, np.uint8):
            raise ValueError("another type of numbers needs a copy")
        return np.array(self.pixels, dtype) if copy or dtype not in (None, np.uint8) else self.pixels

    @property
    def shape(self) -> tuple[int, int, int]:
        """Height, width and 4."""
        height, width, channels = self.pixels.shape
        return height, width, channels

    @property
    def depth(self) -> Floats:
        """How far the body is along each ray, in units of the model; inf where nothing is hit."""
        return self.hits.depth

    @property
    def leaf(self) -> Shorts:
        """The number of the leaf that is seen, an index into `leaves`; -1 where there is none."""
        return self.hits.leaf

    @property
    def normal(self) -> Floats:
        """The outer unit normals (h, w, 3) of the leaves; NaN where nothing is hit."""
        return self.hits.normal

    @property
    def points(self) -> Floats:
        """The points of the surface (h, w, 3); NaN where nothing is hit."""
        return self.hits.points

    @property
    def rays(self) -> tuple[Floats, Floats]:
        """The origins and unit directions of the rays, (h, w, 3) each."""
        return self.hits.rays

    @property
    def undecided(self) -> Flags:
        """Where a ray came to a limit, so that what is said of it is not certain; painted in magenta."""
        return self.hits.undecided

    @cached_property
    def curvature(self) -> Floats:
        """Both principal curvatures (h, w, 2) of the leaves, the larger first; NaN where nothing is hit."""
        return self.hits.fields("principal_curvatures")["principal_curvatures"]

    @cached_property
    def parts(self) -> Mapping[str, str]:
        """The parts that are seen, in the order of the leaves, each with its colour."""
        return self.parts_seen()

    @cached_property
    def part(self) -> Shorts:
        """The number of the part among `parts`; -1 where there is none, and on a section."""
        numbers, labels = {name: number for number, name in enumerate(self.parts)}, self.hits.labels
        found = np.full(self.leaf.shape, -1, np.int16)
        found[self.hits.met] = np.array([*(numbers.get(name, -1) for name in labels.names), -1])[labels.number]
        return found

    @property
    def status(self) -> str:
        """In a line, how much is seen, and whether every ray is decided."""
        height, width, _ = self.shape
        share = np.count_nonzero(self.leaf >= 0) / (height * width)
        count = int(np.count_nonzero(self.undecided))
        rays = counted(count) if count else "every ray decided"
        return f"{width} x {height} pixels, {100 * share:.3g} % on the body; {rays}"

    def __repr__(self) -> str:
        return f"Image({self.status})"

    def _repr_png_(self) -> bytes:
        return png(self.pixels if (self.pixels[..., 3] < 255).any() else self.pixels[..., :3])

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the picture as ``.png``, whole or not at all; the same pixels give the same bytes.

        Raises
        ------
        RsymError
            For another suffix, or a folder that is missing or cannot be written.
        """
        return write_atomically(check_picture(path), self._repr_png_())


def counted(undecided: int) -> str:
    """The words for so many rays."""
    return f"{undecided} ray{'s' * (undecided > 1)} undecided, painted magenta"


def check_picture(path: str | os.PathLike[str]) -> Path:
    """The path of a rendered picture, if it ends in ``.png``: asked before the work, not after it."""
    path = file_path(path)
    if path.suffix.lower() != ".png":
        raise RsymError(
            f"a rendered picture is written as .png, got the suffix {path.suffix!r}",
            code="file-format",
            where=str(path),
            remedy="end the name with .png; for .svg, .pdf save the figure of rsym.plot_image(image)",
        )
    return path
