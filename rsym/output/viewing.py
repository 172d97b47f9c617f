"""A body in the browser: the page that `write` makes, in a temporary file, opened."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rsym.errors import RsymError, warn
from rsym.model.requirements import path_ending
from rsym.model.shape import Shape
from rsym.output.files import write
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh as mesh_of


def view(
    what: Mesh | Shape,
    *,
    colour_by: str | None = None,
    path: str | os.PathLike[str] | None = None,
    browser: bool = True,
    resolution: int | Sequence[int] = 128,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
) -> Path:
    """Open a mesh, or the mesh of a shape in space, in the browser: a page that turns with the mouse and zooms.

    The page is one file that needs nothing else. It is the one that ``write(mesh, "page.html")`` makes.

    Parameters
    ----------
    what : Mesh or Shape
        A mesh, or a shape in space, which is meshed.
    colour_by : "part", optional
        Give each part its colour.
    path : str or path-like, optional
        Where to keep the page, a name that ends in ``.html``; without it a temporary file, which stays until the system
        clears its folder.
    browser : bool
        Whether to open the page; without, it is only written.
    resolution, bounds, letters
        Of the mesh of a shape, as in `mesh`.

    Returns
    -------
    Path
        The path of the page.

    Raises
    ------
    RsymError
        For what is neither mesh nor shape, a shape in the plane, another suffix, and as `mesh` and `write`.

    Warns
    -----
    RsymWarning
        Where no browser can be opened.

    Examples
    --------
    >>> import rsym
    >>> page = rsym.view(rsym.sphere(1), resolution=16, browser=False)
    >>> page.suffix, page.stat().st_size > 10_000
    ('.html', True)
    >>> page.unlink()
    """
    if isinstance(what, Shape) and what.dimension == 2:
        raise RsymError(
            "a page shows a body in space, got a shape in the plane",
            code="dimension",
            remedy="use revolve(shape) or extrude(shape, lower, upper) first, or plot_field(shape)",
        )
    if path is not None:
        check_page(path)
    if isinstance(what, Shape):
        what = mesh_of(what, resolution, bounds=bounds, letters=letters)
    elif not isinstance(what, Mesh):
        raise RsymError(
            f"expected a Mesh or a Shape, got {type(what).__name__}",
            code="mesh",
            remedy="rsym.load(name) gives the shape of a name, patch.mesh() the mesh of a patch",
        )
    if not len(what.faces):
        raise RsymError("a mesh needs at least one triangle, got none", code="empty-mesh")
    page = _temporary() if path is None else check_page(path)
    try:
        write(what, page, colour_by=colour_by)
    except BaseException:
        if path is None:
            page.unlink()
        raise
    if browser and not webbrowser.open(page.resolve().as_uri()):
        warn(f"no browser could be opened; the page is {page}")
    return page


def check_page(path: str | os.PathLike[str]) -> Path:
    """The path of a page, if it ends in ``.html``."""
    return path_ending(path, ".html", "a page is")


def _temporary() -> Path:
    descriptor, name = tempfile.mkstemp(prefix="rsym-", suffix=".html")
    os.close(descriptor)
    return Path(name)
