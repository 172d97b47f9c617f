"""Reproducing the paper: every figure to a file, and a page that shows them.

Figures are drawn in this process one after the other, or in several that draw while this one writes. A row of figures
that share a mesh or a compiled model stays in one process; the costliest rows come first, so that all end together.
"""

from __future__ import annotations

import gc
import io
import multiprocessing
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, TypeAlias

from rsym.atomic import write_atomically
from rsym.errors import RsymError, RsymWarning, warn
from rsym.model.requirements import require_count
from rsym.paper.drawing import Recipe, Reproduced, Table
from rsym.paper.figures import RECIPES, ROWS
from rsym.paper.page import page

DPI = 150
LEAVE = 5.0  # seconds that a process has to end in


def reproduce(
    out: str | Path,
    *,
    only: Sequence[str] = (),
    progress: Callable[[int, int, str], Any] | None = None,
    processes: int = 1,
) -> list[Reproduced]:
    """Draw the figures of the source paper and of parametric surfaces into a folder, with a page `index.html`.

    Parameters
    ----------
    out : path
        The folder; it is made if it is not there.
    only : sequence of str
        Names such as ``fig11``, ``fig05a`` or ``table1``; ``fig05`` takes both parts. Without it, all.
    progress : callable, optional
        ``progress(done, total, name)`` before each figure; returning False cancels.
    processes : int
        How many processes draw; 1 is this one. Where this one has threads they import what they need anew, so a
        script that asks for more does so under ``if __name__ == "__main__":``. The pictures do not depend on it.

    Raises
    ------
    RsymError
        For a name that no figure has, a folder that cannot be made, a number of processes that is none, a process
        that ended, or a cancel.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(reproduce(folder, only=["fig10"])[0].path.name)
    fig10.png
    """
    recipes = _chosen(only)
    require_count("processes", processes, "1 for this one, or 2")
    folder = Path(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RsymError(f"cannot make the folder {folder}: {error.strerror}", code="folder") from error
    done: dict[str, Reproduced] = {}

    def begin(name: str) -> None:
        if progress is not None and progress(len(done), len(recipes), name) is False:
            raise RsymError("the reproduction was cancelled", code="cancelled")

    rows = _rows(recipes)
    alone = min(processes, len(rows)) == 1
    with closing(_drawn_here(recipes, begin) if alone else _drawn_by(processes, rows, begin)) as drawn:
        for recipe, picture in drawn:
            done[recipe.name] = _written(recipe, picture, folder)
    results = [done[recipe.name] for recipe in recipes]
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


def _rows(recipes: Sequence[Recipe]) -> list[list[Recipe]]:
    """The figures in rows that one process draws, in their order there, the costliest row first."""
    left = {recipe.name: recipe for recipe in recipes}
    rows = [[left.pop(name) for name in row if name in left] for row in ROWS]
    return [row for row in (*rows, *([recipe] for recipe in left.values())) if row]


@dataclass(frozen=True)
class _Picture:
    """What drawing one recipe gave: the bytes of its files, and what the page says of it."""

    png: bytes
    letters: str
    triangles: int
    seconds: float
    remark: str
    table: Table | None
    files: dict[str, bytes]


def _draw(recipe: Recipe) -> _Picture:
    start = time.perf_counter()
    try:
        drawing = recipe.draw()
        picture = io.BytesIO()
        drawing.figure.savefig(picture, format="png", dpi=DPI, bbox_inches="tight", metadata={"Software": "rsym"})
    except RsymError as error:
        where = f"{recipe.name}, {error.where}" if error.where else recipe.name
        raise RsymError(error.message, code=error.code, where=where, remedy=error.remedy) from error
    except Exception as error:
        error.add_note(f"while drawing {recipe.name}")
        raise
    _close(drawing.figure)
    return _Picture(
        picture.getvalue(),
        drawing.letters,
        drawing.triangles,
        time.perf_counter() - start,
        drawing.remark,
        drawing.table,
        dict(drawing.files),
    )


def _close(figure: Any) -> None:
    import matplotlib.pyplot

    matplotlib.pyplot.close(figure)


def _written(recipe: Recipe, picture: _Picture, folder: Path) -> Reproduced:
    path = folder / f"{recipe.name}.png"
    write_atomically(path, picture.png)
    for name, data in picture.files.items():
        write_atomically(folder / name, data)
    return Reproduced(
        recipe.name,
        recipe.title,
        path,
        picture.letters,
        picture.triangles,
        picture.seconds,
        recipe.published,
        picture.remark,
        picture.table,
        tuple(picture.files),
        recipe.model,
        recipe.equations,
    )


Drawn: TypeAlias = Generator[tuple[Recipe, _Picture], None, None]


def _drawn_here(recipes: Sequence[Recipe], begin: Callable[[str], None]) -> Drawn:
    for recipe in recipes:
        begin(recipe.name)
        yield recipe, _draw(recipe)


def _drawn_by(processes: int, rows: Sequence[list[Recipe]], begin: Callable[[str], None]) -> Drawn:
    """Each hand takes the next row that nobody has begun; whatever ends this ends all of them."""
    left = list(rows)
    with ExitStack() as stack:
        hands = [stack.enter_context(_Hand()) for _ in rows[:processes]]
        while True:
            for hand in hands:
                if hand.recipe is None and (hand.row or left):
                    hand.row = hand.row or left.pop(0)
                    hand.take(hand.row.pop(0), begin)
            at_work = [hand for hand in hands if hand.recipe is not None]
            if not at_work:
                return
            ready = wait([hand.connection for hand in at_work])
            yield from (hand.give() for hand in at_work if hand.connection in ready)


_ends: list[Connection] = []  # by which this process asks


@dataclass
class _Hand:
    """A process that draws one figure after the other, as it is told."""

    connection: Connection = field(init=False)
    row: list[Recipe] = field(default_factory=list)
    recipe: Recipe | None = None

    def __enter__(self) -> _Hand:
        # A copy of this process has all imports, but might hold locks that its threads have; a new one imports anew.
        copies = sys.platform == "linux" and threading.active_count() == 1
        context: Any = multiprocessing.get_context("fork" if copies else "spawn")
        self.connection, other = context.Pipe()
        _ends.append(self.connection)
        self._process = context.Process(target=_draw_as_told, args=(other,), daemon=True)
        self._process.start()
        other.close()
        return self

    def __exit__(self, *_: object) -> None:
        """One that is idle ends by itself, one that draws is ended."""
        self.connection.close()
        _ends.remove(self.connection)
        if self.recipe is not None:
            self._process.terminate()
        self._process.join(LEAVE)
        if self._process.is_alive():
            self._process.kill()

    def take(self, recipe: Recipe, begin: Callable[[str], None]) -> None:
        """Have a figure drawn."""
        begin(recipe.name)
        self.recipe = recipe
        self.connection.send(recipe.name)

    def give(self) -> tuple[Recipe, _Picture]:
        """The figure that was drawn, or the error that it met."""
        recipe = self.recipe
        assert recipe is not None
        try:
            answer = self.connection.recv()
        except EOFError as error:
            raise RsymError(
                f"the process that drew {recipe.name} has ended",
                code="process",
                remedy="memory may be short: draw that figure alone",
            ) from error
        self.recipe = None
        if isinstance(answer, Exception):
            raise answer
        picture, told = answer
        for message in told:
            warn(message)
        return recipe, picture


def _draw_as_told(connection: Connection) -> None:
    """Draw what is named until nobody listens; who asked ends this process, and an interrupt is for them."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    for end in _ends:  # of a copy: while anyone holds them open, nobody is told that the asker has gone
        end.close()
    # What is imported stays: to look for garbage in it, again and again, takes a twentieth of the time.
    gc.freeze()
    recipes = {recipe.name: recipe for recipe in RECIPES}
    try:
        while True:
            recipe = recipes[connection.recv()]
            try:
                with warnings.catch_warnings(record=True) as noted:
                    warnings.simplefilter("always", RsymWarning)
                    picture = _draw(recipe)
                told = [str(one.message) for one in noted if issubclass(one.category, RsymWarning)]
                connection.send((picture, told))
            except Exception as error:
                error.add_note(traceback.format_exc())
                connection.send(error)
    except (EOFError, BrokenPipeError):
        return
