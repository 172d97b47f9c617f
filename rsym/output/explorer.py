"""Explorations of a shape, and of patches: sliders of letters, other widgets, and the picture that follows them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from types import MappingProxyType
from typing import Any

import ipywidgets
import numpy as np
from matplotlib.figure import Figure

from rsym.errors import RsymError, RsymWarning
from rsym.model.constructions import revolve
from rsym.model.letters import Letter, Letters
from rsym.model.shape import Shape
from rsym.output import axes3d
from rsym.output.bodies import explain
from rsym.output.design.letters import slider_range
from rsym.output.design.pages import DesignPage, page_of
from rsym.output.models import load_letters, save_letters
from rsym.output.paints import MAPS
from rsym.output.patches import Lines, Patches, coat_of_patches, merged_letters, shaded, tessellations
from rsym.output.shading import AZIMUTH, BODY, ELEVATION
from rsym.output.views import DPI, BodyView, SheetView, png
from rsym.program.fields import SIX, checked_fields
from rsym.sampling.lattice import checked_cells
from rsym.sampling.windows import bounds_or_extent

RESOLUTIONS = (40, 80, 160, 320, 640)
STEPS = 200  # of a slider, about: a round step is taken
RESOLUTION = 160
MANY = 12  # letters


# What every exploration has: sliders of letters, a picture that follows them, and what could not be done.
class LetterSliders(ipywidgets.VBox):  # type: ignore[misc]
    """Sliders of letters, the first children in their order; a subclass says how to `draw`."""

    def __init__(self, letters: Letters) -> None:
        self._known = letters
        self._held = False
        self.figure: Figure | None = None
        self.letters: Mapping[str, Any] = MappingProxyType(
            {name: letter_slider(name, letter) for name, letter in letters.items()}
        )
        self.message = ipywidgets.HTML()
        self.picture = ipywidgets.Image(format="png", layout={"max_width": "100%", "object_fit": "contain"})
        super().__init__([*self.letters.values()], layout={"flex_flow": "row wrap"})

    def add_rows(self, rows: Iterable[Any]) -> None:
        """Put rows of other widgets after the sliders."""
        self.children = (*self.letters.values(), *rows)

    def draw(self) -> Figure:
        """The picture at the letters as the sliders stand."""
        raise NotImplementedError

    @property
    def values(self) -> dict[str, float]:
        """The letters as the sliders stand."""
        return {name: slider.value for name, slider in self.letters.items()}

    def set_letters(self, values: Mapping[str, float]) -> None:
        """Move several sliders and draw once; unknown letters and values outside their range are refused."""
        self._known.values_with(values)
        with self.together():
            for name, value in values.items():
                self.letters[str(name)].value = float(value)

    def reset_letters(self) -> None:
        """All letters back to their defaults."""
        self.set_letters({name: float(letter.default) for name, letter in self._known.items()})

    @contextmanager
    def together(self) -> Iterator[None]:
        """Several changes, one picture."""
        self._held = True
        try:
            yield
        finally:
            self._held = False
        self.redraw()

    def attempt(self, action: Any) -> None:
        """What is refused is said beneath the sliders; the picture stays as it was."""
        try:
            action()
        except RsymError as error:
            self.message.value = f"<b>not done:</b> {escape(str(error))}"

    def redraw(self, _: Any = None) -> None:
        """Draw anew, unless several changes are under way."""
        if not self._held:
            self.attempt(self._show)

    def _show(self) -> None:
        with warnings.catch_warnings(record=True) as remarks:
            warnings.simplefilter("always", RsymWarning)
            self.figure = self.draw()
        self.message.value = "<br>".join(escape(str(remark.message)) for remark in remarks)
        self.picture.value = png(self.figure)


class Explorer(LetterSliders):
    """Sliders of letters and one picture, above the sliders if they are many.

    The first children are the sliders, in the order of the letters.

    Examples
    --------
    >>> import rsym
    >>> widget = Explorer(rsym.paper.skeleton_body(), ["normalised"], resolution=16)
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
        self.view = view_buttons("sheet" if shape.dimension == 2 else "body")
        self.fields = field_choice(checked_fields(fields))
        self.resolution = resolution_choice(checked_cells(resolution))
        self.section: tuple[Any, ...] = () if shape.dimension == 2 else section_choice(self._box)
        self.camera = camera_sliders(ELEVATION, AZIMUTH)
        self.reset = button("reset", "all letters back to their defaults")
        self.path = ipywidgets.Text("letters.json", description="preset")
        self.save = button("save", "write the letters to the file")
        self.load = button("load", "read the letters from the file")
        rows = (
            (self.view, self.resolution, self.fields, *self.section, *self.camera),
            (self.reset, self.path, self.save, self.load),
            (self.message,),
            (self.picture,),
        )
        # Beneath many sliders the picture would be out of sight.
        self.add_rows(row_of(row, first=len(self.letters) > MANY) for row in rows)
        self._follow()
        self.redraw()

    def _follow(self) -> None:
        """From now on the picture follows the widgets."""
        changing = (*self.letters.values(), self.view, self.resolution, self.fields, *self.section[1:], *self.camera)
        for widget in changing:
            widget.observe(self.redraw, "value")
        for coordinate in self.section[:1]:
            coordinate.observe(lambda _: move_section(self, self.section, self._box), "value")
        self.reset.on_click(lambda _: self.attempt(self.reset_letters))
        self.save.on_click(lambda _: self.attempt(lambda: save_letters(self.values, self.path.value)))
        self.load.on_click(lambda _: self.attempt(lambda: self.set_letters(load_letters(self.path.value))))

    def page(self, title: str = "") -> DesignPage:
        """The shape as a page of HTML with live letters, which needs neither Python nor a widget.

        In a notebook it shows itself, also where the notebook has become a page of its own; ``page().write(path)`` puts
        it into a file. Its letters begin as the sliders stand.

        Examples
        --------
        >>> import rsym
        >>> Explorer(rsym.paper.skeleton_body(), resolution=16).page("nose").html.count("<script")
        8
        """
        shape = self._shape.with_letters(self.values)
        return DesignPage(page_of(shape, title=title, bounds=self._bounds))

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
        self.camera = camera_sliders(ELEVATION, AZIMUTH)
        rows = ((self.colours, *self.camera), (self.message,), (self.picture,))
        self.add_rows(row_of(row, first=False) for row in rows)
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


def letter_slider(name: str, letter: Letter) -> Any:
    """A slider over the range of a letter; it tells its change when it is let go.

    Examples
    --------
    >>> slider = letter_slider("a", Letter(5, minimum=1, maximum=10, unit="mm", doc="reach"))
    >>> slider.description, slider.tooltip, slider.min, slider.max, slider.step
    ('a [mm]', 'reach', 1.0, 10.0, 0.02)
    """
    low, high = slider_range(letter)
    return _slider(
        float(letter.default), low, high, f"{name} [{letter.unit}]" if letter.unit else name, letter.doc or name
    )


def view_buttons(view: str) -> Any:
    """The choice between sheet and body."""
    return ipywidgets.ToggleButtons(options=["sheet", "body"], value=view, style={"button_width": "5em"})


def field_choice(fields: Sequence[str]) -> Any:
    """The fields asked for, all six, or one of them."""
    sets = dict.fromkeys([tuple(fields), SIX, *((field,) for field in SIX)])
    words = [("six fields" if names == SIX else ", ".join(names).replace("_", " "), names) for names in sets]
    return ipywidgets.Dropdown(options=words, value=tuple(fields), layout={"width": "16em"})


def resolution_choice(resolution: int) -> Any:
    """Cells along the longer side of a sheet."""
    options = sorted({resolution, *RESOLUTIONS})
    return ipywidgets.Dropdown(options=options, value=resolution, description="cells", layout={"width": "12em"})


def section_choice(box: Mapping[str, tuple[float, float]]) -> tuple[Any, Any]:
    """The coordinate that a section fixes, by default the last, and its value, by default in the middle."""
    names = list(box)
    low, high = box[names[-1]]
    coordinate = ipywidgets.Dropdown(options=names, value=names[-1], description="section", layout={"width": "12em"})
    return coordinate, _slider((low + high) / 2, low, high, "at", "where the section lies")


def move_section(widget: LetterSliders, section: tuple[Any, ...], box: Mapping[str, tuple[float, float]]) -> None:
    """The slider of a section over the sides of a box along its new coordinate."""
    coordinate, place = section
    with widget.together(), place.hold_trait_notifications():
        place.min, place.max = box[coordinate.value]
        place.value = (place.min + place.max) / 2


def camera_sliders(elevation: float, azimuth: float) -> tuple[Any, Any]:
    """Where the eye is, in degrees."""
    return (
        _slider(elevation, -90, 90, "elevation", "of the eye above the xy-plane, in degrees"),
        _slider(azimuth, -180, 180, "azimuth", "of the eye from the x-axis towards the y-axis, in degrees"),
    )


def button(word: str, help_text: str) -> Any:
    """A button as wide as its word."""
    return ipywidgets.Button(description=word, tooltip=help_text, layout={"width": "7em"})


def row_of(widgets: Sequence[Any], *, first: bool) -> Any:
    """Widgets beside each other, in a line of their own; above all other children if it is to be seen first."""
    layout = {"width": "100%", "flex_flow": "row wrap", "order": "-1" if first else "0"}
    return ipywidgets.Box(list(widgets), layout=layout)


def _slider(value: float, low: float, high: float, description: str, help_text: str) -> Any:
    return ipywidgets.FloatSlider(
        value=value,
        min=low,
        max=high,
        step=_round_step((high - low) / STEPS),
        description=description,
        tooltip=help_text,
        readout_format=".4g",
        continuous_update=False,
        layout={"width": "20em"},
        style={"description_width": "5.5em"},
    )


def _round_step(step: float) -> float:
    """1, 2 or 5 times a power of ten, not above the step by more than its rounding."""
    power = 10.0 ** math.floor(math.log10(step))
    return float(f"{next(factor for factor in (5, 2, 1) if factor * power <= step * (1 + 1e-9)) * power:.3g}")
