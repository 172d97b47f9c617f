"""Exploring a shape, or patches, in a notebook."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, overload

from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.output.field_data import FIELDS, Field
from rsym.output.patches import Lines, Patches
from rsym.problems.stated import StatedProblem
from rsym.program.fields import SIX
from rsym.sampling.plane import GIVEN_FIELDS

if TYPE_CHECKING:
    from rsym.output.explorer import Explorer, PatchExplorer
    from rsym.output.solution_explorer import SolutionExplorer


@overload
def explore(
    shape: Shape,
    fields: Sequence[str] = SIX,
    *,
    axis: Any = None,
    bounds: Any = None,
    resolution: int = 160,
) -> Explorer: ...
@overload
def explore(
    shape: Field | StatedProblem,
    fields: Sequence[str] = SIX,
    *,
    axis: Any = None,
    bounds: Any = None,
    resolution: int = 160,
) -> SolutionExplorer: ...
def explore(
    shape: Shape | Field | StatedProblem,
    fields: Sequence[str] = SIX,
    *,
    axis: Any = None,
    bounds: Any = None,
    resolution: int = 160,
) -> Explorer | SolutionExplorer:
    """A slider for each letter, driving the sheet of six fields or the shaded body.

    A shape in the plane shows its sheet, or the body that it sweeps when it turns
    about `axis`; a shape in space its body, or the sheet of a section. What `solve`, `modes`, `torsion` or
    `elasticity` answered is found anew for the letters as they stand, with nothing compiled, and shows its picture.

    Parameters
    ----------
    shape : Shape, Solution, Spectrum, Torsion, ElasticSolution or StatedProblem
        With letters; a slider spans the range of its letter, or 0 to twice its default. A problem of `load_problem` is
        solved first, refined as ``problem.solve()`` is.
    fields : sequence of str
        Scalar fields of the sheet; it can be changed in the widget. Of a solution those to choose from: "value",
        "gradient_squared", "laplacian", by default all.
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
        could not be. ``.view.value`` is ``"sheet"`` or ``"body"``; ``.picture`` is the widget that shows it,
        ``.camera`` the sliders of elevation and azimuth. ``.page()`` is a page with live letters that needs
        no Python; a notebook keeps it when it becomes HTML, and ``rsym.write(shape, "page.html")`` makes it a file.
        That of a solution has ``.found``, the solution at these letters, ``.field`` and ``.steady``: whether colours
        stay what they are.

    Raises
    ------
    RsymError
        If ipywidgets is not installed, no bounds are found for it, the resolution is no number of cells, or a solution
        has no letters.

    Examples
    --------
    >>> import rsym
    >>> widget = rsym.explore(rsym.paper.skeleton_body(), ["normalised"], resolution=32)
    >>> widget.letters["a2"].value = 6.0
    >>> widget.values["a2"], widget.message.value
    (6.0, '')
    """
    if isinstance(shape, (*FIELDS, StatedProblem)):
        if axis is not None:
            raise RsymError("a solution knows its axis", code="axis", remedy="leave axis= out")
        with _widgets_needed():
            from rsym.output.solution_explorer import SolutionExplorer
        solution = shape.solve() if isinstance(shape, StatedProblem) else shape
        names = GIVEN_FIELDS if fields is SIX else fields
        return SolutionExplorer(solution, names, bounds=bounds, resolution=resolution)
    require_shape(shape)
    with _widgets_needed():
        from rsym.output.explorer import Explorer
    return Explorer(shape, fields, axis=axis, bounds=bounds, resolution=resolution)


def explore_patches(
    patches: Patches, *, colour_by: str | None = None, lines: Lines = 8, resolution: int | None = None
) -> PatchExplorer:
    """A slider for each letter of one or several patches, driving their picture.

    Parameters
    ----------
    patches, lines, resolution
        As for `plot_patches`.
    colour_by : str, optional
        The first map; it can be changed in the widget.

    Returns
    -------
    ipywidgets.VBox
        ``.letters["k"].value = 0.7`` moves a slider and draws at once; ``.values`` are the letters, ``.colours.value``
        the map, ``.camera`` the sliders of elevation and azimuth, ``.figure`` what is drawn, ``.picture`` the widget
        that shows it, ``.message`` says what could not be.

    Raises
    ------
    RsymError
        If ipywidgets is not installed, and as `plot_patches`.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> k = sp.Symbol("k")
    >>> widget = explore_patches(ParametricSurface((u, v, k * u * v), letters={k: 1}), resolution=8)
    >>> widget.set_letters({"k": 2})
    >>> float(widget.figure.axes[0].get_zlim()[1].round(2))
    2.02
    """
    with _widgets_needed():
        from rsym.output.explorer import PatchExplorer
    return PatchExplorer(patches, colour_by=colour_by, lines=lines, resolution=resolution)


@contextmanager
def _widgets_needed() -> Iterator[None]:
    """Say what is missing where ipywidgets cannot be imported."""
    try:
        yield
    except ImportError as error:
        if not (error.name or "").startswith("ipywidgets"):
            raise
        raise RsymError(
            "exploring needs the package ipywidgets, which cannot be imported",
            code="missing-package",
            remedy='pip install "rsym[notebook]"',
        ) from error
