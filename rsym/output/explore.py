"""Exploring a shape in a notebook."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rsym.codegen.fields import SIX
from rsym.errors import RsymError
from rsym.model.shape import Shape

if TYPE_CHECKING:
    from rsym.output.explorer import Explorer


def explore(
    shape: Shape,
    fields: Sequence[str] = SIX,
    *,
    axis: Any = None,
    bounds: Any = None,
    resolution: int = 160,
) -> Explorer:
    """A slider for each letter, driving the sheet of six fields or the shaded body.

    A shape in the plane shows its sheet, or the body that it sweeps when it turns
    about `axis`; a shape in space its body, or the sheet of a section.

    Parameters
    ----------
    shape : Shape
        With letters; a slider spans the range of its letter, or 0 to twice its default.
    fields : sequence of str
        Scalar fields of the sheet; it can be changed in the widget.
    axis : symbol, optional
        The axis of revolution of a plane shape, by default its first coordinate.
    bounds
        Override those of the shape; without any, those that hold all of it are found.
    resolution : int
        Cells along the longer side of a sheet or a body.

    Returns
    -------
    ipywidgets.VBox
        ``.letters["a"].value = 0.7`` moves a slider and draws at once; ``.values``
        are the letters, ``.figure`` is what is drawn, ``.message`` says what
        could not be. ``.view.value`` is ``"sheet"`` or ``"body"``; ``.picture`` is
        the widget that shows it, ``.camera`` the sliders of elevation and azimuth.

    Raises
    ------
    RsymError
        If ipywidgets is not installed, no bounds are found for it, or the resolution is no number of cells.

    Examples
    --------
    >>> import rsym
    >>> widget = rsym.explore(rsym.paper.skeleton_body(), resolution=32)
    >>> widget.letters["a2"].value = 6.0
    >>> widget.values["a2"], widget.message.value
    (6.0, '')
    """
    try:
        from rsym.output.explorer import Explorer
    except ImportError as error:
        if not (error.name or "").startswith("ipywidgets"):
            raise
        raise RsymError(
            "exploring needs the package ipywidgets, which cannot be imported",
            code="missing-package",
            remedy='pip install "rsym[notebook]"',
        ) from error
    return Explorer(shape, fields, axis=axis, bounds=bounds, resolution=resolution)
