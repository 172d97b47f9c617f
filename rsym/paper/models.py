"""The models that come with rsym, written in its model language."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from rsym.errors import RsymError
from rsym.model.language.loading import load
from rsym.model.shape import Shape

MODELS: tuple[str, ...] = ("car", "skeleton")
READINGS = {"standard": "omega", "literal": "omega_literal"}


def model_path(name: str) -> Path:
    """The file of a shipped model.

    Examples
    --------
    >>> model_path("car").name
    'car.rf'
    """
    if name not in MODELS:
        raise RsymError(f"no shipped model {name!r}", code="unknown-model", remedy=f"choose from {', '.join(MODELS)}")
    return Path(str(files("rsym.paper") / f"{name}.rf"))


def car(variant: str = "a", stage: str = "W") -> Shape:
    """The car of the source paper at one stage of its construction.

    Parameters
    ----------
    variant : {"a", "b"}
        Values of Figs 5a to 10, or of Figs 5b to 7b.
    stage : {"test1", "test2", "test3", "test4", "test5", "W"}
        Arches; rounding; sides; wheels; windows; headlights. Any other definition of the model can be asked for too.

    x is across the car, y along it with the front at +y, z up. The roof and the
    boot are restored: their equations are lost.
    Source: Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> rsym.paper.car().letters["ra"].default
    3
    """
    return load(model_path("car"), shape=stage, variant=variant)


def skeleton_body(reading: str = "standard") -> Shape:
    """The plane body blended on a segment, omega = -f_o + (a1 - x)*(a2 + x)/p1 - p2, of Fig. 11.

    Parameters
    ----------
    reading : {"standard", "literal"}
        The standard reading takes f_o as the normalised segment (trimming); the
        literal one has f_1**2 outside the outer root, as the transcription prints it.

    Source: Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> list(rsym.paper.skeleton_body().letters)
    ['a', 'a1', 'a2', 'p1', 'p2']
    """
    if reading not in READINGS:
        raise RsymError(f"no reading {reading!r}", code="unknown-reading", remedy=f"choose from {', '.join(READINGS)}")
    return load(model_path("skeleton"), shape=READINGS[reading])
