"""The models that come with rsym, written in its model language."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path

from rsym.errors import RsymError
from rsym.language.loading import load, shipped
from rsym.model.shape import Shape

# One model or more for each family of pieces, in the folder `gallery`.
GALLERY = (
    "bone",
    "bracket",
    "clip",
    "gear",
    "gyroid",
    "jack",
    "lattice",
    "snowflake",
    "solids",
    "spanner",
    "spring",
    "vase",
)
# Those that state a problem too, in the folder `problems`.
PROBLEMS = ("plate", "shaft")
MODELS: tuple[str, ...] = ("car", "skeleton", "valve", "streamlined", *GALLERY, *PROBLEMS)
# The stages that a reading changes, and what they are called in the file.
CAR_READINGS: Mapping[str, Mapping[str, str]] = {
    "standard": {},
    "printed-W": {"W": "W_printed"},
    "text-zb": {},
    "strip": {stage: f"{stage}_strip" for stage in ("test3", "test4", "test5", "W")},
}
SKELETON_READINGS: Mapping[str, str] = {"standard": "omega", "literal": "omega_literal"}

# Fig. 12: a = a2 = 5 and p2 = 0.1 are printed; the pairs (a1, p1) are ours.
BODIES = ((8, 40), (8, 20), (6, 40), (10, 40), (10, 60), (12, 80))


def model_path(name: str) -> Path:
    """The file of a shipped model.

    Examples
    --------
    >>> model_path("car").name
    'car.rf'
    """
    if name not in MODELS:
        raise RsymError(f"no shipped model {name!r}", code="unknown-model", remedy=f"choose from {', '.join(MODELS)}")
    path = shipped(name)
    assert path is not None
    return path


def model_title(name: str) -> str:
    """What a shipped model is: the first line of its file.

    Examples
    --------
    >>> model_title("bracket")
    'A bracket: two plates joined by a fillet of continuous curvature, with rounded corners and four holes.'
    """
    return model_path(name).read_text(encoding="utf-8").partition("\n")[0].removeprefix("#").strip()


def car(variant: str = "a", stage: str = "W", *, reading: str = "standard") -> Shape:
    """The car of the source paper at one stage of its construction.

    Parameters
    ----------
    variant : {"a", "b"}
        Values of Figs 5a to 10, or of Figs 5b to 7b.
    stage : {"test1", "test2", "test3", "test4", "test5", "W"}
        Arches; rounding; sides; wheels; windows; headlights. Any other definition of the model can be asked for too.
    reading : {"standard", "printed-W", "text-zb", "strip"}
        How the doubtful places are read: as repaired; W = test5 or not headlights, as printed; z_b = z_2/2, as in the
        text; the strip of Figs 5 and 6 kept in the body. `rsym.paper.READINGS` says what follows from each.

    x is across the car, y along it with the front at +y, z up. The roof and the
    boot are restored: their equations are lost.
    Source: Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> rsym.paper.car().letters["ra"].default
    3
    >>> rsym.paper.car(reading="text-zb").letters["zb"].default
    Fraction(5, 2)
    """
    _check_reading(reading, CAR_READINGS)
    shape = load(model_path("car"), shape=CAR_READINGS[reading].get(stage, stage), variant=variant)
    if reading == "text-zb" and "zb" in shape.letters:
        return shape.with_letters({"zb": Fraction(shape.letters["z2"].default) / 2})
    return shape


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
    _check_reading(reading, SKELETON_READINGS)
    return load(model_path("skeleton"), shape=SKELETON_READINGS[reading])


def valve() -> Shape:
    """An engine poppet valve, for Figs 1 and 2; the source's equation is lost, this one is ours.

    A body of revolution about z with a slot in the face of its head, in millimetres.

    Examples
    --------
    >>> import rsym
    >>> float(rsym.paper.valve().letters["rs"].default)
    3.5
    """
    return load(model_path("valve"))


def streamlined() -> Shape:
    """A car of unusual shape blended on four skeletons, for Figs 13 and 14; the source prints none, this one is ours.

    Axes as in `car`.

    Examples
    --------
    >>> import rsym
    >>> rsym.paper.streamlined().dimension
    3
    """
    return load(model_path("streamlined"))


def _check_reading(reading: str, known: Mapping[str, object]) -> None:
    if reading not in known:
        raise RsymError(f"no reading {reading!r}", code="unknown-reading", remedy=f"choose from {', '.join(known)}")
