"""Figures to files: the format by suffix, the file whole or not at all, the same bytes every time."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from rsym.atomic import write_atomically
from rsym.errors import RsymError

# What matplotlib would write of the day and of itself, by suffix.
METADATA: Mapping[str, Mapping[str, str | None]] = MappingProxyType(
    {".png": {"Software": "rsym"}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".eps": {"Creator": "rsym"}}
)
PATH, DECIMALS = re.compile(rb'(?<= d=")[^"]*'), re.compile(rb"(\.\d{3})\d+")
DAY = re.compile(rb"%%CreationDate: [^\n]*\n")
DPI = (200, 150)  # of pixels among lines, and of a picture of pixels


def write_picture(figure: Figure, path: str | os.PathLike[str], *, dpi: float | None = None) -> Path:
    """Write a figure as ``.png``, ``.svg``, ``.pdf`` or ``.eps``, trimmed; what is shaded there has 200 dots per inch.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_picture(Figure((2, 1)), Path(folder, "empty.png")).read_bytes()[1:4]
    b'PNG'
    """
    suffix = picture_suffix(path)
    data = io.BytesIO()
    pixels = [part for part in figure.findobj(lambda part: bool(part.get_rasterized())) if suffix == ".eps"]
    for part in pixels:  # which PostScript writes out in figures, ten megabytes of them
        part.set_rasterized(False)
    with matplotlib.rc_context({"svg.hashsalt": "rsym"}):
        figure.savefig(
            data,
            format=suffix[1:],
            dpi=dpi or DPI[suffix == ".png"],
            bbox_inches="tight",
            metadata=dict(METADATA[suffix]),
        )
    for part in pixels:
        part.set_rasterized(True)
    written = data.getvalue()
    if suffix in (".svg", ".eps"):
        written = shorter(written) if suffix == ".svg" else DAY.sub(b"", written)
    return write_atomically(path, written)


def shorter(drawing: bytes) -> bytes:
    """An SVG drawing whose paths have three decimals, a thousandth of a point, where matplotlib writes six.

    Examples
    --------
    >>> shorter(b'<path d="M 1.234567 0.5" transform="scale(0.015625)"/>')
    b'<path d="M 1.234 0.5" transform="scale(0.015625)"/>'
    """
    return PATH.sub(lambda path: DECIMALS.sub(rb"\1", path[0]), drawing)


def figure_of(artist: Artist) -> Figure:
    """The whole figure that an artist stands in, also from within a subfigure.

    Examples
    --------
    >>> figure = Figure()
    >>> figure_of(figure.subfigures().add_subplot()) is figure
    True
    """
    # An artist knows its subfigure, and that its figure; get_figure(root=True) is younger than the oldest matplotlib
    # that is supported.
    figure: Any = artist.figure
    whole = figure.figure
    assert isinstance(whole, Figure)
    return whole


def require_axes(axes: Any) -> Axes:
    """Refuse what nothing in the plane is drawn on."""
    if not isinstance(axes, Axes):
        raise RsymError(
            f"ax must be an Axes of matplotlib, got {type(axes).__name__}",
            code="axes",
            remedy="ax=figure.add_subplot(), one of those that subplots(1, 2) makes, or leave ax out",
        )
    return axes


def page(
    figure: Figure | SubFigure | None, *, layout: str | None = None, size: tuple[float, float] | None = None
) -> Figure | SubFigure:
    """The figure that was given, as it is, or a new one of pyplot.

    Examples
    --------
    >>> part = Figure().subfigures()
    >>> page(part) is part, whole(part) is part
    (True, False)
    """
    if figure is None:
        import matplotlib.pyplot

        new: Figure = matplotlib.pyplot.figure(layout=layout, figsize=size)
        return new
    if not isinstance(figure, Figure | SubFigure):
        raise RsymError(
            f"figure must be a Figure or a SubFigure of matplotlib, got {type(figure).__name__}",
            code="figure",
            remedy="figure=matplotlib.pyplot.figure(), or one of figure.subfigures(1, 2)",
        )
    return figure


def whole(figure: Figure | SubFigure) -> Figure:
    """The figure that a part belongs to."""
    root: Any = figure.figure
    assert isinstance(root, Figure)
    return root


def checked_titles(titles: Any, own: Sequence[str]) -> Sequence[str]:
    """The titles that somebody gave, as many as there are panels; else their own.

    Examples
    --------
    >>> checked_titles(None, ["a"]), checked_titles(["the first"], ["a"])
    (['a'], ['the first'])
    """
    if titles is None:
        return own
    if isinstance(titles, str) or not isinstance(titles, Sequence) or len(titles) != len(own):
        raise RsymError(
            f"titles are as many as pictures, {len(own)}, got {titles!r}", code="titles", remedy="leave them out"
        )
    return [str(title) for title in titles]


def require_report(given: object, expected: type, question: str) -> None:
    """Refuse to draw what no answer to the question is.

    Examples
    --------
    >>> require_report(3, dict, "rsym.repair(shape)")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a dict, got int; remedy: ask rsym.repair(shape)
    """
    if not isinstance(given, expected):
        raise RsymError(
            f"expected a {expected.__name__}, got {type(given).__name__}", code="report", remedy=f"ask {question}"
        )


def picture_suffix(path: str | os.PathLike[str]) -> str:
    """The suffix of a picture's name, one that `write_picture` knows: asked before the work, not after it."""
    suffix = Path(path).suffix.lower()
    if suffix not in METADATA:
        raise RsymError(
            f"a picture is written as {', '.join(METADATA)}, got the suffix {Path(path).suffix!r}",
            code="file-format",
            where=str(path),
            remedy=f"end the name with one of: {', '.join(METADATA)}",
        )
    return suffix
