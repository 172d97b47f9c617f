"""What an exploration shows: pictures that are drawn again and again, without pyplot."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rsym.model.shape import Shape
from rsym.output import axes3d
from rsym.output.fields import Sheet, sheet_sampler
from rsym.output.pictures import whole
from rsym.output.surfaces import plot_mesh
from rsym.sampling.meshing import mesh

DPI = 90


class SheetView:
    """The sheet of some fields; sampled and compiled once, laid out once.

    Examples
    --------
    >>> import rsym
    >>> view = SheetView(rsym.paper.skeleton_body(), ("normalised",), resolution=16)
    >>> [len(view.draw({"a2": value}).axes) for value in (5.3, 6)]
    [2, 2]
    """

    def __init__(
        self,
        shape: Shape,
        fields: Sequence[str],
        *,
        resolution: int | Sequence[int],
        bounds: Any = None,
        section: Mapping[Any, float] | None = None,
    ) -> None:
        self._sampler = sheet_sampler(shape, fields, resolution=resolution, bounds=bounds, section=section)
        self._sheet: Sheet | None = None

    def draw(self, letters: Mapping[str, float], section: Mapping[Any, float] | None = None) -> Figure:
        """Draw at some letters; a letter that is refused leaves the figure as it was."""
        samples = self._sampler.at(letters, section)
        if self._sheet is None:
            sheet = Sheet(Figure(layout="compressed", dpi=DPI), samples)
            sheet.draw(samples)
            whole(sheet.figure).draw_without_rendering()
            # The places of panels and colour bars are found; finding them anew takes half of the time of a picture.
            whole(sheet.figure).set_layout_engine("none")
            self._sheet = sheet
        else:
            self._sheet.draw(samples)
        return whole(self._sheet.figure)


class BodyView:
    """The shaded surface, in a box that holds both the first body and the present one.

    Examples
    --------
    >>> import rsym
    >>> view = BodyView(rsym.revolve(rsym.paper.skeleton_body()), resolution=24)
    >>> view.draw({"a2": 6}, elevation=20, azimuth=-60).axes[0].azim
    -60
    """

    def __init__(self, shape: Shape, *, resolution: int | Sequence[int], bounds: Any = None) -> None:
        self._shape, self._resolution, self._bounds = shape, resolution, bounds
        self._first: Any = None

    def draw(self, letters: Mapping[str, float], *, elevation: float, azimuth: float) -> Figure:
        """Draw at some letters, seen from above by `elevation` degrees and from the side by `azimuth`."""
        body = mesh(self._shape, self._resolution, bounds=self._bounds, letters=letters)
        corners = body.vertices[np.unique(body.faces)]
        box = np.array([corners.min(axis=0), corners.max(axis=0)])
        self._first = box if self._first is None else self._first
        low, high = np.minimum(box, self._first)[0], np.maximum(box, self._first)[1]
        figure = Figure(dpi=DPI)
        axes = axes3d.page_axes(figure, low, high, elevation, azimuth)
        plot_mesh(body, ax=axes)
        axes3d.frame(axes, low, high, elevation, azimuth)
        axes3d.style(axes)
        return figure


def png(figure: Figure) -> bytes:
    """The figure in its own resolution; straight from the canvas, since `savefig` draws twice to find a layout."""
    data = io.BytesIO()
    FigureCanvasAgg(figure).print_png(data, metadata={"Software": "rsym"})
    return data.getvalue()
