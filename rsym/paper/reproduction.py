"""Reproducing the paper: every figure to a file, and a page that shows them."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rsym.errors import RsymError
from rsym.output.atomic import write_atomically
from rsym.paper.drawing import Recipe, Reproduced
from rsym.paper.figures import RECIPES
from rsym.paper.page import page

DPI = 150


def reproduce(
    out: str | Path,
    *,
    only: Sequence[str] = (),
    progress: Callable[[int, int, str], Any] | None = None,
) -> list[Reproduced]:
    """Draw the figures of the source paper and of parametric surfaces into a folder, with a page `index.html`.

    Parameters
    ----------
    out : path
        The folder; it is made if it is not there.
    only : sequence of str
        Names such as ``fig11``, ``fig05a`` or ``table1``; ``fig05`` takes both parts. Without it, all.
    progress : callable, optional
        ``progress(done, total, name)``; returning False cancels after the figure at work.

    Raises
    ------
    RsymError
        For a name that no figure has, a folder that cannot be made, or a cancel.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(reproduce(folder, only=["fig10"])[0].path.name)
    fig10.png
    """
    recipes = _chosen(only)
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RsymError(f"cannot make the folder {folder}: {error.strerror}", code="folder") from error
    results = []
    for number, recipe in enumerate(recipes):
        if progress is not None and progress(number, len(recipes), recipe.name) is False:
            raise RsymError("the reproduction was cancelled", code="cancelled")
        results.append(_draw(recipe, folder))
    if progress is not None:
        progress(len(recipes), len(recipes), "done")
    write_atomically(folder / "index.html", page(results, whole=not only).encode())
    return results


def _chosen(only: Sequence[str]) -> list[Recipe]:
    names = [only] if isinstance(only, str) else list(only)
    known = [recipe.name for recipe in RECIPES]
    for name in names:
        if not any(_matches(recipe, name) for recipe in RECIPES):
            raise RsymError(f"no figure {name!r}", code="unknown-figure", remedy=f"choose from {', '.join(known)}")
    return [recipe for recipe in RECIPES if not names or any(_matches(recipe, name) for name in names)]


def _matches(recipe: Recipe, name: str) -> bool:
    return name in (recipe.name, recipe.name.rstrip("ab"))


def _draw(recipe: Recipe, folder: Path) -> Reproduced:
    start = time.perf_counter()
    drawing = recipe.draw()
    picture = io.BytesIO()
    drawing.figure.savefig(picture, format="png", dpi=DPI, bbox_inches="tight", metadata={"Software": "rsym"})
    _close(drawing.figure)
    path = folder / f"{recipe.name}.png"
    write_atomically(path, picture.getvalue())
    for name, data in drawing.files.items():
        write_atomically(folder / name, data)
    return Reproduced(
        recipe.name,
        recipe.title,
        path,
        drawing.letters,
        drawing.triangles,
        time.perf_counter() - start,
        recipe.published,
        drawing.remark,
        drawing.table,
        tuple(drawing.files),
        recipe.model,
        recipe.equations,
    )


def _close(figure: Any) -> None:
    import matplotlib.pyplot

    matplotlib.pyplot.close(figure)
