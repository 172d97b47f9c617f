"""Explorations of a shape, and of patches: sliders of letters and the picture that follows them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets
import numpy as np
from matplotlib.figure import Figure

from rsym.model.constructions import revolve
from rsym.model.shape import Shape
from rsym.output import axes3d, controls
from rsym.output.controls import LetterSliders
from rsym.output.paints import MAPS
from rsym.output.patches import Lines, Patches, coat_of_patches, merged_letters, shaded, tessellations
from rsym.output.presets import load_letters, save_letters
from rsym.output.shading import AZIMUTH, BODY, ELEVATION
from rsym.output.surfaces import explain
from rsym.output.views import DPI, BodyView, SheetView
from rsym.program.fields import SIX, checked_fields
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.lattice import checked_cells

RESOLUTION = 160
MANY = 12  # letters


class Explorer(LetterSliders):
    """Sliders of letters and one picture, above the sliders if they are many.

    The first children are the sliders, in the order of the letters.

    Examples
    --------
    >>> import rsym
    >>> widget = Explorer(rsym.paper.skeleton_body(), resolution=16)
    >>> widget.children[0].value = 4.5
    >>> widget.values["a"]
    4.5
    """

    def __init__(
        self,
        shape: Shape,
        fields: Sequence[str] = SIX,
        *,
        axis: Any = None,
        bounds: Any = None,
        resolution: int = RESOLUTION,
    ) -> None:
        super().__init__(shape.letters)
        self._shape, self._bounds = shape, bounds
        self._axis = shape.coordinates[0] if axis is None else axis
        self._box = dict(zip(map(str, shape.coordinates), bounds_or_extent(shape, bounds), strict=True))
        self._views: dict[Any, Any] = {}
        self.view = controls.view_buttons("sheet" if shape.dimension == 2 else "body")
        self.fields = controls.field_choice(checked_fields(fields))
        self.resolution = controls.resolution_choice(checked_cells(resolution))
        self.section: tuple[Any, ...] = () if shape.dimension == 2 else controls.section_choice(self._box)
        self.camera = controls.camera_sliders(ELEVATION, AZIMUTH)
        self.reset = controls.button("reset", "all letters back to their defaults")
        self.path = ipywidgets.Text("letters.json", description="preset")
        self.save = controls.button("save", "write the letters to the file")
        self.load = controls.button("load", "read the letters from the file")
        rows = (
            (self.view, self.resolution, self.fields, *self.section, *self.camera),
            (self.reset, self.path, self.save, self.load),
            (self.message,),
            (self.picture,),
        )
        # Beneath many sliders the picture would be out of sight.
        self.add_rows(controls.row(row, first=len(self.letters) > MANY) for row in rows)
        self._follow()
        self.redraw()

    def _follow(self) -> None:
        """From now on the picture follows the widgets."""
        changing = (*self.letters.values(), self.view, self.resolution, self.fields, *self.section[1:], *self.camera)
        for widget in changing:
            widget.observe(self.redraw, "value")
        for coordinate in self.section[:1]:
            coordinate.observe(self._move_section, "value")
        self.reset.on_click(lambda _: self.attempt(self.reset_letters))
        self.save.on_click(lambda _: self.attempt(self._save))
        self.load.on_click(lambda _: self.attempt(self._load))

    def draw(self) -> Figure:
        """The sheet or the body at the letters as the sliders stand."""
        body = self.view.value == "body"
        for widget in self.camera:
            widget.layout.display = None if body else "none"
        for widget in (self.fields, *self.section):
            widget.layout.display = "none" if body else None
        return self._draw_body() if body else self._draw_sheet()

    def _draw_sheet(self) -> Figure:
        fields, cells = self.fields.value, self.resolution.value
        cut = {self.section[0].value: self.section[1].value} if self.section else None
        key = (fields, cells, *(cut or ()))
        if key not in self._views:
            self._views[key] = SheetView(self._shape, fields, resolution=cells, bounds=self._bounds, section=cut)
        figure: Figure = self._views[key].draw(self.values, cut)
        return figure

    def _draw_body(self) -> Figure:
        cells = self.resolution.value
        if cells not in self._views:
            flat = self._shape if self._bounds is None else self._shape.replace(bounds=self._bounds)
            self._views[cells] = BodyView(revolve(flat, self._axis) if flat.dimension == 2 else flat, resolution=cells)
        elevation, azimuth = (slider.value for slider in self.camera)
        figure: Figure = self._views[cells].draw(self.values, elevation=elevation, azimuth=azimuth)
        return figure

    def _move_section(self, _: Any) -> None:
        """The slider of the section over the sides of the box along the new coordinate."""
        coordinate, place = self.section
        with self.together(), place.hold_trait_notifications():
            place.min, place.max = self._box[coordinate.value]
            place.value = (place.min + place.max) / 2

    def _save(self) -> None:
        save_letters(self.values, self.path.value)

    def _load(self) -> None:
        self.set_letters(load_letters(self.path.value))


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
