"""Measured points from text: a row of numbers each, between commas, semicolons, tabs or blanks."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError

LARGEST_FILE = 1 << 29  # bytes: ten million points in full
BETWEEN = re.compile(r"\s*[,;]\s*|\s+")


def load_points(path: str | os.PathLike[str], columns: int) -> Floats:
    r"""Read points (n, columns) from a text file; a first line of words, empty lines and those after # do not count.

    Raises
    ------
    RsymError
        For a file that cannot be read or is too large, and a line without so many numbers, with its number.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "points.csv")
    ...     _ = path.write_text("x, y\n1, 2.5\n# a remark\n3; 4e-1\n")
    ...     load_points(path, 2).tolist()
    [[1.0, 2.5], [3.0, 0.4]]
    """
    rows: list[list[float]] = []
    lines = [line.partition("#")[0].strip() for line in _text(path).splitlines()]
    for number, line in enumerate(lines, 1):
        if not line:
            continue
        row = _numbers(line)
        if row is None and not rows and not any(lines[: number - 1]):
            continue  # names of the columns
        if row is None or len(row) != columns:
            got = f"{len(row)}" if row is not None else "words"
            raise RsymError(
                f"expected {columns} numbers, got {got}",
                code="points-file",
                where=f"{os.fspath(path)}, line {number}",
                remedy="a row for each point, one number for each coordinate: 1.5, 2, -0.25",
            )
        rows.append(row)
    return np.array(rows).reshape(-1, columns)


def _numbers(line: str) -> list[float] | None:
    try:
        return [float(word) for word in BETWEEN.split(line)]
    except ValueError:
        return None


def _text(path: str | os.PathLike[str]) -> str:
    try:
        with Path(path).open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
        text = data.decode("utf-8-sig")
    except (OSError, ValueError, TypeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise RsymError(
            f"cannot read the points: {reason}", code="points-file", where=str(path), remedy="check the path"
        ) from None
    if len(data) > LARGEST_FILE:
        raise RsymError(
            f"points take at most {LARGEST_FILE} bytes", code="points-file", where=str(path), remedy="give fewer"
        )
    return text
