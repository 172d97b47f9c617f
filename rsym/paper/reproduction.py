"""Reproducing the paper: every figure to a file, and a page that shows them."""

from __future__ import annotations

import html
import io
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rsym.errors import RsymError
from rsym.output.files import write_atomically
from rsym.paper.figures import RECIPES, Recipe

DPI = 150


@dataclass(frozen=True)
class Reproduced:
    """One figure on disk and how it came about; `seconds` covers model, mesh and picture."""

    name: str
    title: str
    path: Path
    letters: str
    triangles: int
    seconds: float
    published: str
    remark: str


def reproduce(
    out: str | Path,
    *,
    only: Sequence[str] = (),
    progress: Callable[[int, int, str], Any] | None = None,
) -> list[Reproduced]:
    """Draw the figures of the source paper into a folder, with an `index.html` that shows them.

    Parameters
    ----------
    out : path
        The folder; it is made if it is not there.
    only : sequence of str
        Names such as ``fig11`` or ``fig05a``; ``fig05`` takes both. Without it, all.
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
    write_atomically(folder / "index.html", page(results).encode())
    return results


def _chosen(only: Sequence[str]) -> list[Recipe]:
    names = [only] if isinstance(only, str) else list(only)
    known = [recipe.name for recipe in RECIPES]
    for name in names:
        if not any(_matches(recipe, name) for recipe in RECIPES):
            raise RsymError(f"no figure {name!r}", code="unknown-figure", remedy=f"choose from {', '.join(known)}")
    return [recipe for recipe in RECIPES if not names or any(_matches(recipe, name) for name in names)]


def _matches(recipe: Recipe, name: str) -> bool:
    return recipe.name == name or recipe.name[:-1] == name


def _draw(recipe: Recipe, folder: Path) -> Reproduced:
    start = time.perf_counter()
    drawing = recipe.draw()
    picture = io.BytesIO()
    drawing.figure.savefig(picture, format="png", dpi=DPI, bbox_inches="tight", metadata={"Software": "rsym"})
    _close(drawing.figure)
    path = folder / f"{recipe.name}.png"
    write_atomically(path, picture.getvalue())
    seconds = time.perf_counter() - start
    return Reproduced(
        recipe.name, recipe.title, path, drawing.letters, drawing.triangles, seconds, recipe.published, drawing.remark
    )


def _close(figure: Any) -> None:
    import matplotlib.pyplot

    matplotlib.pyplot.close(figure)


def page(results: Sequence[Reproduced]) -> str:
    """The HTML page: each picture with its letters, triangles, seconds, and the published seconds beside them."""
    sections = "\n".join(_section(result) for result in results)
    return _PAGE.format(sections=sections)


def _section(result: Reproduced) -> str:
    rows = [
        ("letters", result.letters),
        ("triangles", f"{result.triangles:,}".replace(",", " ") if result.triangles else "none: a plane picture"),
        ("seconds", f"{result.seconds:.1f}"),
        ("seconds in the paper", result.published or "not given"),
        ("remark", result.remark),
    ]
    table = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(text)}</td></tr>" for name, text in rows)
    name, title = html.escape(result.name), html.escape(result.title)
    number = name.removeprefix("fig").lstrip("0")
    return (
        f'<section id="{name}"><h2>Fig. {number}: {title}</h2>'
        f'<img src="{name}.png" alt="{title}"><table>{table}</table></section>'
    )


_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Car surfaces by R-functions, reproduced</title>
<style>
body {{ font: 16px/1.5 Georgia, serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; color: #222; }}
section {{ border-top: 1px solid #ccc; padding: 1rem 0; }}
img {{ display: block; max-width: 100%; margin: 0 auto 1rem; }}
table {{ border-collapse: collapse; font-size: 0.9rem; }}
th {{ text-align: left; vertical-align: top; white-space: nowrap; padding: 0.15rem 1rem 0.15rem 0; font-weight: 600; }}
</style></head><body>
<h1>Car surfaces by R-functions, reproduced</h1>
<p>The figures of D. A. Lisin, K. V. Maksimenko-Sheiko and T. I. Sheiko, <em>Mathematical modelling of car surfaces
by R-functions</em> (2013), made again from their equations. The equations of the roof and the boot are lost in the
source; they are restored from their letters and the values under the figures. Of the car the source prints
test5 &or; &not;far, which makes all outer space inside; test5 &and; &not;far is drawn. The pairs (a1, p1) of
Fig. 12 are not printed; they are ours. Seconds cover model, mesh and picture; those of the paper were measured
on a computer of 2013.</p>
{sections}
</body></html>
"""
