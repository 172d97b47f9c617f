"""What every exploration has: sliders of letters, a picture that follows them, and what could not be done."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from html import escape
from types import MappingProxyType
from typing import Any

import ipywidgets
from matplotlib.figure import Figure

from rsym.errors import RsymError, RsymWarning
from rsym.model.letters import Letters
from rsym.output import controls
from rsym.output.views import png


class LetterSliders(ipywidgets.VBox):  # type: ignore[misc]
    """Sliders of letters, the first children in their order; a subclass says how to `draw`."""

    def __init__(self, letters: Letters) -> None:
        self._known = letters
        self._held = False
        self.figure: Figure | None = None
        self.letters: Mapping[str, Any] = MappingProxyType(
            {name: controls.letter_slider(name, letter) for name, letter in letters.items()}
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
