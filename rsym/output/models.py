"""Shapes as model files."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from rsym.language.writing import dumps
from rsym.model.requirements import file_path
from rsym.model.shape import Shape
from rsym.output.atomic import write_atomically


def save(shape: Shape, path: str | PathLike[str]) -> Path:
    """Write a shape as a model file that `load` reads as the same shape; see `dumps`.

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
    ...     print(rsym.load(path) == rsym.disc(2))
    True
    """
    text = dumps(shape)
    return write_atomically(file_path(path), text.encode())
