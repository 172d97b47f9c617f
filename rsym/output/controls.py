"""The widgets of an exploration: one by one, and the sliders of letters with the picture that follows them."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from html import escape
from types import MappingProxyType
from typing import Any

import ipywidgets
from matplotlib.figure import Figure

from rsym.errors import RsymError, RsymWarning
from rsym.model.letters import Letter, Letters
from rsym.output.views import png
from rsym.program.fields import SIX

RESOLUTIONS = (40, 80, 160, 320, 640)
STEPS = 200  # of a slider, about: a round step is taken


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


def slider_range(letter: Letter) -> tuple[float, float]:
    """The range of a letter; an open end lies at 0 or at twice the default.

    Examples
    --------
    >>> slider_range(Letter(5)), slider_range(Letter(-2, maximum=1)), slider_range(Letter(0))
    ((0.0, 10.0), (-4.0, 1.0), (-1.0, 1.0))
    """
    default = float(letter.default)
    low = min(0.0, 2 * default) if letter.minimum is None else float(letter.minimum)
    high = max(0.0, 2 * default) if letter.maximum is None else float(letter.maximum)
    if low < high:
        return low, high
    # Nothing to scale by: the default is 0, or beyond the only end.
    return (
        default - 1 if letter.minimum is None else low,
        default + 1 if letter.maximum is None else high,
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


def camera_sliders(elevation: float, azimuth: float) -> tuple[Any, Any]:
    """Where the eye is, in degrees."""
    return (
        _slider(elevation, -90, 90, "elevation", "of the eye above the xy-plane, in degrees"),
        _slider(azimuth, -180, 180, "azimuth", "of the eye from the x-axis towards the y-axis, in degrees"),
    )


def button(word: str, help_text: str) -> Any:
    """A button as wide as its word."""
    return ipywidgets.Button(description=word, tooltip=help_text, layout={"width": "7em"})


def row(widgets: Sequence[Any], *, first: bool) -> Any:
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
