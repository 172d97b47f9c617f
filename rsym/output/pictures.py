"""Figures to files: the format by suffix, the file whole or not at all, the same bytes every time."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import matplotlib
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from rsym.errors import RsymError
from rsym.output.atomic import write_atomically

# What matplotlib would write of the day and of itself, by suffix.
METADATA: Mapping[str, Mapping[str, str | None]] = MappingProxyType(
    {".png": {"Software": "rsym"}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
)
DPI = 150


def write_picture(figure: Figure, path: str | os.PathLike[str], *, dpi: float = DPI) -> Path:
    """Write a figure as ``.png``, ``.svg`` or ``.pdf``, trimmed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_picture(Figure((2, 1)), Path(folder, "empty.png")).read_bytes()[1:4]
    b'PNG'
    """
    suffix = picture_suffix(path)
    data = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "rsym"}):
        figure.savefig(data, format=suffix[1:], dpi=dpi, bbox_inches="tight", metadata=dict(METADATA[suffix]))
    return write_atomically(path, data.getvalue())


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
