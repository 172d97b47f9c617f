"""An exploration: sliders of letters and the picture that follows them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from types import MappingProxyType
from typing import Any

import ipywidgets
from matplotlib.figure import Figure

from rsym.codegen.fields import SIX, checked_fields
from rsym.errors import RsymError, RsymWarning
from rsym.model.motions import revolve
from rsym.model.shape import Shape
from rsym.output import controls
from rsym.output.presets import load_letters, save_letters
from rsym.output.views import BodyView, SheetView, png
from rsym.sampling.extent import bounds_or_extent
from rsym.sampling.lattice import checked_cells

RESOLUTION = 160
MANY = 12  # letters


class Explorer(ipywidgets.VBox):  # type: ignore[misc]
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
        self._shape, self._bounds = shape, bounds
        self._axis = shape.coordinates[0] if axis is None else axis
        self._box = dict(zip(map(str, shape.coordinates), bounds_or_extent(shape, bounds), strict=True))
        self._views: dict[Any, Any] = {}
        self._held = False
        self.figure: Figure | None = None
        self.letters: Mapping[str, Any] = MappingProxyType(
            {name: controls.letter_slider(name, letter) for name, letter in shape.letters.items()}
        )
        self.view = controls.view_buttons("sheet" if shape.dimension == 2 else "body")
        self.fields = controls.field_choice(checked_fields(fields))
        self.resolution = controls.resolution_choice(checked_cells(resolution))
        self.section: tuple[Any, ...] = () if shape.dimension == 2 else controls.section_choice(self._box)
        self.camera = controls.camera_sliders(22.0, -55.0)
        self.reset = controls.button("reset", "all letters back to their defaults")
        self.path = ipywidgets.Text("letters.json", description="preset")
        self.save = controls.button("save", "write the letters to the file")
        self.load = controls.button("load", "read the letters from the file")
        self.message = ipywidgets.HTML()
        self.picture = ipywidgets.Image(format="png", layout={"max_width": "100%", "object_fit": "contain"})
        rows = (
            (self.view, self.resolution, self.fields, *self.section, *self.camera),
            (self.reset, self.path, self.save, self.load),
            (self.message,),
            (self.picture,),
        )
        # Beneath many sliders the picture would be out of sight.
        lines = [controls.row(row, first=len(self.letters) > MANY) for row in rows]
        super().__init__([*self.letters.values(), *lines], layout={"flex_flow": "row wrap"})
        self._follow()
        self._redraw()

    def _follow(self) -> None:
        """From now on the picture follows the widgets."""
        changing = (*self.letters.values(), self.view, self.resolution, self.fields, *self.section[1:], *self.camera)
        for widget in changing:
            widget.observe(self._redraw, "value")
        for coordinate in self.section[:1]:
            coordinate.observe(self._move_section, "value")
        self.reset.on_click(lambda _: self._attempt(self._reset))
        self.save.on_click(lambda _: self._attempt(self._save))
        self.load.on_click(lambda _: self._attempt(self._load))

    @property
    def values(self) -> dict[str, float]:
        """The letters as the sliders stand."""
        return {name: slider.value for name, slider in self.letters.items()}

    def set_letters(self, values: Mapping[str, float]) -> None:
        """Move several sliders and draw once; unknown letters and values outside their range are refused."""
        self._shape.letters.values_with(values)
        with self._together():
            for name, value in values.items():
                self.letters[str(name)].value = float(value)

    @contextmanager
    def _together(self) -> Iterator[None]:
        """Several changes, one picture."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        self._redraw()

    def _attempt(self, action: Any) -> None:
        """What is refused is said beneath the sliders; the picture stays as it was."""
        try:
            action()
        except RsymError as error:
            self.message.value = f"<b>not done:</b> {escape(str(error))}"

    def _redraw(self, _: Any = None) -> None:
        if not self._held:
            self._attempt(self._draw)

    def _draw(self) -> None:
        body = self.view.value == "body"
        for widget in self.camera:
            widget.layout.display = None if body else "none"
        for widget in (self.fields, *self.section):
            widget.layout.display = "none" if body else None
        with warnings.catch_warnings(record=True) as remarks:
            warnings.simplefilter("always", RsymWarning)
            self.figure = self._draw_body() if body else self._draw_sheet()
        self.message.value = "<br>".join(escape(str(remark.message)) for remark in remarks)
        self.picture.value = png(self.figure)

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
        with self._together(), place.hold_trait_notifications():
            place.min, place.max = self._box[coordinate.value]
            place.value = (place.min + place.max) / 2

    def _reset(self) -> None:
        self.set_letters({name: float(letter.default) for name, letter in self._shape.letters.items()})

    def _save(self) -> None:
        save_letters(self.values, self.path.value)

    def _load(self) -> None:
        self.set_letters(load_letters(self.path.value))
