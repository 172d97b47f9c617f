"""Equations for pages that must open without a network and without scripts: LaTeX to inline SVG."""

from __future__ import annotations

import re
from functools import lru_cache
from xml.sax.saxutils import quoteattr

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.textpath import TextPath

from rsym.errors import RsymError

SIZE = 14.5  # CSS pixels
FONT = "stix"  # Times-like, beside a serif text
MARGIN = 1.0
STEPS = 20  # per CSS pixel: whole numbers keep pages small
_LETTERS = {int(Path.MOVETO): "m", int(Path.LINETO): "l", int(Path.CURVE3): "q", int(Path.CURVE4): "c"}
_CORNERS = {"m": 1, "l": 1, "q": 2, "c": 3}


@lru_cache(maxsize=1024)
def equation(latex: str, size: float = SIZE) -> str:
    r"""A formula as an ``<svg>`` element; its LaTeX stays in it as the label for readers that do not see.

    Parameters
    ----------
    latex : str
        In the subset of LaTeX that matplotlib's mathtext knows, without dollar signs.
    size : float
        Height of the letters in CSS pixels.

    Raises
    ------
    RsymError
        For LaTeX that mathtext does not know.

    Examples
    --------
    >>> text = equation(r"f_{1} = x \wedge_0 y")
    >>> text.startswith("<svg "), r'aria-label="f_{1} = x \wedge_0 y"' in text
    (True, True)
    """
    font = FontProperties(math_fontfamily=FONT)
    try:
        outline = TextPath((0, 0), f"${_for_mathtext(latex)}$", size=size, prop=font)
    except ValueError as error:
        raise RsymError(
            f"this LaTeX cannot be drawn: {latex}", code="latex", remedy="keep to what matplotlib's mathtext knows"
        ) from error
    low, high = outline.vertices.min(axis=0) - MARGIN, outline.vertices.max(axis=0) + MARGIN
    box = " ".join(_short(STEPS * number) for number in (low[0], -high[1], *(high - low)))
    width, height = (_short(length) for length in high - low)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label={quoteattr(latex)} '
        f'width="{width}" height="{height}" viewBox="{box}"><path fill="currentColor" d="{_commands(outline)}"/></svg>'
    )


def _for_mathtext(latex: str) -> str:
    """Fractions in full size, and room on both sides of an R-operation: mathtext sets it before the subscript."""
    spaced = re.sub(r"\\(wedge|vee|sim|cup)((?:[_^](?:\w|\{[^{}]*\}))+)", r"\\;{\\\1}\2\\;", latex)
    return spaced.replace(r"\frac", r"\dfrac")


def _commands(outline: Path) -> str:
    """The outline as SVG path commands in whole steps, each relative to the last, y downwards."""
    parts: list[str] = []
    here = start = np.zeros(2, np.int64)
    for vertices, code in outline.iter_segments(curves=True, simplify=False):
        letter = _LETTERS.get(int(code))
        if letter is None:
            parts.append("z")
            here = start
            continue
        corners = np.rint(np.asarray(vertices).reshape(-1, 2)[: _CORNERS[letter]] * (STEPS, -STEPS)).astype(np.int64)
        parts.append(letter + " ".join(f"{u} {v}" for u, v in corners - here))
        here = corners[-1]
        start = here if letter == "m" else start
    return "".join(parts)


def _short(number: float) -> str:
    return f"{number:.6g}"
