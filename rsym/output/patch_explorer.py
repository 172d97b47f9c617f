"""An exploration of patches: sliders of letters and the shaded surface that follows them."""

from __future__ import annotations

import ipywidgets
import numpy as np
from matplotlib.figure import Figure

from rsym.output import axes3d, controls
from rsym.output.paints import MAPS
from rsym.output.patches import Lines, Patches, coat_of_patches, merged_letters, shaded, tessellations
from rsym.output.shading import AZIMUTH, BODY, ELEVATION
from rsym.output.sliders import LetterSliders
from rsym.output.surfaces import explain
from rsym.output.views import DPI


class PatchExplorer(LetterSliders):
    """Sliders of letters, the colours and the camera above one picture.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> k = sp.Symbol("k")
    >>> widget = PatchExplorer(ParametricSurface((u, v, k * u * v), letters={k: 1}), resolution=8)
    >>> widget.letters["k"].value = 2
    >>> widget.colours.value = "zebra"
    >>> widget.values, widget.message.value
    ({'k': 2.0}, '')
    """

    def __init__(
        self, patches: Patches, *, colour_by: str | None = None, lines: Lines = 8, resolution: int | None = None
    ) -> None:
        super().__init__(merged_letters(patches))
        self._patches, self._lines, self._resolution = patches, lines, resolution
        self._box = np.zeros((0, 3))
        options = [("one colour", None), *((name.replace("_", " "), name) for name in (*MAPS, "zebra", "patch"))]
        self.colours = ipywidgets.Dropdown(options=options, value=colour_by, description="colours")
        self.camera = controls.camera_sliders(ELEVATION, AZIMUTH)
        rows = ((self.colours, *self.camera), (self.message,), (self.picture,))
        self.add_rows(controls.row(row, first=False) for row in rows)
        for widget in (*self.letters.values(), self.colours, *self.camera):
            widget.observe(self.redraw, "value")
        self.redraw()

    def draw(self) -> Figure:
        """The surface, in a box that holds all that were drawn before: so one sees what a letter does."""
        elevation, azimuth = (slider.value for slider in self.camera)
        curved = self.colours.value in MAPS
        parts = tessellations(self._patches, self._lines, self._resolution, self.values, curved=curved)
        artist = shaded(parts, coat_of_patches(parts, BODY, self.colours.value), self._lines, True, ())
        corners = np.concatenate([self._box, [artist.low, artist.high]])
        low, high = corners.min(axis=0), corners.max(axis=0)
        self._box = np.stack([low, high])
        figure = Figure(dpi=DPI)
        axes = axes3d.page_axes(figure, low, high, elevation, azimuth)
        axes3d.style(axes)
        axes.add_artist(artist)
        explain(artist)
        return figure
