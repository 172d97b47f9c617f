"""Shapes as model files, and values of their letters as small JSON files, one name and one number a line."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from rsym.atomic import write_atomically
from rsym.errors import RsymError
from rsym.language.writing import dumps
from rsym.model.letters import as_letters
from rsym.model.requirements import file_path
from rsym.model.shape import Shape

# A thousand letters with long names; a model file holds no more than 200 000 characters in all.
LARGEST_FILE = 100_000


def save(shape: Shape, path: str | PathLike[str]) -> Path:
    """Write a shape as a model file that `load` reads as the same formula, letters, window and parts; see `dumps`.

    The box that a piece brings is no statement and is not written: what `load` reads is looked at in its `extent`, and
    compares as another shape.

    Parameters
    ----------
    shape : Shape
        However it was made.
    path : str or path
        By custom with the suffix ``.rf``. The file appears whole or not at all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    RsymError
        For what the language cannot say, and a file that cannot be written.

    Examples
    --------
    >>> import rsym, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = rsym.save(rsym.disc(2).named("disc"), f"{folder}/disc.rf")
    ...     print(rsym.load(path).expression == rsym.disc(2).expression)
    True
    """
    text = dumps(shape)
    return write_atomically(file_path(path), text.encode())


def save_letters(letters: Shape | Mapping[Any, Any], path: str | os.PathLike[str]) -> Path:
    """Write the values of letters to a JSON file, in their order, whole or not at all.

    Parameters
    ----------
    letters : Shape or mapping
        A shape, whose defaults are written, or ``{name or symbol: number or Letter}``.
    path : str or path-like
        Where to; by custom with the suffix ``.json``.

    Returns
    -------
    Path
        The path of the file; `load_letters` gives back the same float64 values.

    Raises
    ------
    RsymError
        For a value that is not a finite number, or a file that cannot be written.

    Examples
    --------
    >>> import tempfile, rsym
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = rsym.save_letters(rsym.paper.skeleton_body(), Path(folder, "thin.json"))
    ...     print(path.read_text().splitlines()[3])
      "a2": 5.3,
    """
    chosen = letters.letters if isinstance(letters, Shape) else as_letters(letters)
    values = {name: _written(letter.default) for name, letter in chosen.items()}
    return write_atomically(file_path(path), (json.dumps(values, indent=2) + "\n").encode())


def load_letters(path: str | os.PathLike[str]) -> dict[str, float]:
    """Read the values that `save_letters` has written, or that were written by hand.

    The file is one JSON object of names and finite numbers: ``{"a": 5, "b": 0.25}``.

    Parameters
    ----------
    path : str or path-like
        The file, in UTF-8.

    Returns
    -------
    dict
        Names and values in the order of the file, fit for ``letters=`` and ``with_letters``.

    Raises
    ------
    RsymError
        For a file that cannot be read or is too large, that is no such object, a name
        that comes twice, a value that is not a finite number; with line and column.

    Examples
    --------
    >>> import tempfile, rsym
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rsym.load_letters(rsym.save_letters({"a": 5, "b": 0.1}, Path(folder, "thin.json")))
    {'a': 5.0, 'b': 0.1}
    """
    text = _text(path)
    try:
        pairs = json.loads(text, object_pairs_hook=tuple, parse_int=float)
    except json.JSONDecodeError as error:
        raise _refuse(f"no JSON: {error.msg}", path, text, error.pos) from None
    except RecursionError:
        raise _refuse("expected names and numbers, got nested brackets", path, text, 0) from None
    if not isinstance(pairs, tuple):
        raise _refuse("expected names and numbers in braces", path, text, 0)
    values: dict[str, float] = {}
    for name, value in pairs:
        if name in values:
            raise _refuse(f"the letter {name!r} comes twice", path, text, text.rfind(json.dumps(name)))
        if not isinstance(value, float) or not math.isfinite(value):
            got = "a nested value" if isinstance(value, list | tuple) else json.dumps(value)[:40]
            message = f"the letter {name!r} must be a finite number, got {got}"
            raise _refuse(message, path, text, text.find(json.dumps(name)))
        values[name] = value
    return values


def _written(value: Any) -> int | float:
    """A whole number as it is, every other as the nearest float64."""
    return int(value) if float(value).is_integer() and abs(value) < 1e15 else float(value)


def _text(path: str | os.PathLike[str]) -> str:
    try:
        with Path(path).open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError, TypeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise RsymError(
            f"cannot read the letters: {reason}", code="preset-file", where=str(path), remedy="check the path"
        ) from None
    if len(data) > LARGEST_FILE:
        raise RsymError(
            f"letters take at most {LARGEST_FILE} bytes",
            code="preset-file",
            where=str(path),
            remedy="give a file that rsym.save_letters has written",
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise RsymError(
            "the file is not UTF-8", code="preset-file", where=str(path), remedy="save it as UTF-8"
        ) from None


def _refuse(message: str, path: str | os.PathLike[str], text: str, place: int) -> RsymError:
    """The error for a place in the text; a name that is written with escapes is not found, so at the beginning."""
    place = max(place, 0)
    line, column = text.count("\n", 0, place) + 1, place - text.rfind("\n", 0, place)
    where = f"{os.fspath(path)}, line {line}, column {column}"
    return RsymError(message, code="preset", where=where, remedy='write names and numbers: {"a": 5, "b": 0.25}')
