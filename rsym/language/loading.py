"""Shapes from model files; text is parsed, never run."""

from __future__ import annotations

import codecs
from importlib.resources import files
from os import PathLike
from pathlib import Path

from rsym.errors import RsymError, warn
from rsym.garbage import uncollected
from rsym.language.assembly import assemble
from rsym.language.model import ModelFile, collect
from rsym.language.parser import parse
from rsym.language.scanner import LONGEST_TEXT
from rsym.language.syntax import Position
from rsym.language.vm import LONGEST_TEXT as LONGEST_LINES
from rsym.language.vm import chosen_shape, declared, is_vm
from rsym.model.shape import Shape
from rsym.model.wording import proposal

ROOMS = ("", "gallery", "problems")  # of the models that come with rsym
_LONGEST_FILE = 4 * LONGEST_TEXT + len(codecs.BOM_UTF8)  # bytes; UTF-8 needs at most four for a character
_LONGEST_LINES = LONGEST_LINES + len(codecs.BOM_UTF8)  # of a .vm file, which needs no other characters than ASCII's


def load(path: str | PathLike[str], *, shape: str | None = None, variant: str | None = None) -> Shape:
    r"""The shape that a model file describes; see `loads` for the language.

    A file whose name ends in ``.vm`` is a text of the kind of the public test models of fidget and MPR. A line is a
    name, an operation and its arguments, which are names of earlier lines: ``_3 add _1 _2``; ``#`` begins a comment.
    The operations are ``const``, exact as it is written, ``var-x``, ``var-y``, ``var-z``, ``add``, ``sub``, ``mul``,
    ``div``, ``neg``, ``square``, ``sqrt``, ``abs``, ``exp``, ``ln`` (or ``log``), ``sin``, ``cos``, ``tan``, ``asin``,
    ``acos``, ``atan``, ``atan2``, ``compare``, ``min`` and ``max``, which become R-operations of system R_1. The last
    line is the function, negative inside: omega is its opposite. Without ``var-z`` the shape lies in the plane; it has
    no letters, no parts and no bounds. Source: M. J. Keeter (2020), Massively parallel rendering of complex
    closed-form implicit surfaces.

    Parameters
    ----------
    path : str or path
        A text file in UTF-8, by custom with the suffix ``.rf``, or ``.vm``; or, where there is no such file, the name
        of a model that comes with rsym.
    shape, variant : str, optional
        As for `loads`; a ``.vm`` file has none to choose from.

    Raises
    ------
    RsymError
        If the file cannot be read, or as for `loads`.

    Examples
    --------
    >>> import rsym, tempfile
    >>> from pathlib import Path
    >>> rsym.load("skeleton").letters["a2"].default
    Fraction(53, 10)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "lens.vm")
    ...     lines = "_0 var-x", "_1 var-y", "_2 sub _0 _1", "_3 max _0 _2"
    ...     _ = path.write_text("\n".join(lines))
    ...     rsym.load(path).expression
    -disjunction(x, x - y, system=R1)
    """
    with uncollected():
        return read_model(path, shape=shape, variant=variant)[0]


def read_model(
    path: str | PathLike[str], *, shape: str | None = None, variant: str | None = None
) -> tuple[Shape, ModelFile]:
    """The shape that a file describes, and what it declares, all letters and variants."""
    if is_vm(path):
        made = chosen_shape(read_text(path), shape, variant)
        return made, declared(made)
    text = read_text(path)
    return loads(text, shape=shape, variant=variant), collect(parse(text))


def loads(text: str, *, shape: str | None = None, variant: str | None = None) -> Shape:
    """The shape that a model text describes.

    Statements are ``letter a = 5 in [1, 10] "what it is"``, ``variant b: a = 9``,
    ``coordinates x y z``, ``bounds x [-8, 8] y [-4, 4]``, ``system R0`` and
    ``name = formula "what it is"``, each on its line or ended by a semicolon, the
    texts not needed. Formulas are
    written as in MATLAB with rfAND, rfOR, rfNOT, trimming, sqrt, abs, min, max,
    sin, cos, tan, exp, log, atan2 and pi; decimals are exact; ``%`` and ``#``
    begin comments. ``piecewise(1 - x, x > 0, 1 + x)`` chooses, conditions are joined by and(...), or(...), not(...);
    ``30 deg`` is pi/6; ``part "bonnet" = f`` names a part. Of MATLAB are taken ``for k = 0:5 ... end`` over numbers,
    unrolled, in which a name may be defined anew; ``...`` at the end of a line; ``%{ ... %}``; and ``clear``, ``clc``,
    ``close`` are passed over, lines with meshgrid or of drawing too, with a note. In a model that says ``verbatim``, as
    those of `dumps` do, operations stay as they are written, decimals are floats and no letter is left out. Lines
    ``equation -laplacian(u) = 1`` and ``on rim = 0`` state a problem on the shape, which `load_problem` reads.

    Parameters
    ----------
    text : str
        The model.
    shape : str, optional
        The name of the formula that is the shape; by default ``omega``, or else the last one.
    variant : str, optional
        The variant whose values the letters take.

    Returns
    -------
    Shape
        With the letters that the formula uses, with the formulas that it needs as
        `definitions`, and as `parts` those whose text says what they are, or else all.

    Raises
    ------
    RsymError
        For any text that is not such a model, with line, column and remedy; the
        text is never run, and its size and that of its numbers are bounded.

    Warns
    -----
    RsymWarning
        For statements that are passed over, but those of housekeeping.

    Examples
    --------
    >>> disc = loads("letter r = 2.5 in [1, 10]; omega = (r^2 - x^2 - y^2)/(2*r)")
    >>> disc.letters["r"].default
    Fraction(5, 2)
    >>> loads("f = 1 - x.^2; g = rfAND(f, y)").expression
    conjunction(1 - x**2, y)
    >>> loads("f = 1 - x^2; g = rfAND(f, y)", shape="f").expression
    1 - x**2
    """
    if not isinstance(text, str):
        raise RsymError(
            f"a model is a text, got {type(text).__name__}", code="text", remedy="decode it, or use load for a file"
        )
    try:
        notes: list[str] = []
        made = assemble(collect(parse(text, notes)), shape, variant)
    except RecursionError:
        raise RsymError(
            "the model is nested too deeply", code="too-deep", remedy="give names to parts of the formula"
        ) from None
    for note in notes:
        warn(note)
    return made


def read_text(path: str | PathLike[str]) -> str:
    """The text of a model file; what is not UTF-8 is refused at its place."""
    data = _read(path)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8")
        place = Position(before.count("\n") + 1, len(before) - (before.rfind("\n") + 1) + 1)
        remedy = "save the file as UTF-8"
        raise place.refuse(f"the byte 0x{data[error.start]:02X} is not UTF-8", "encoding", remedy) from None


def shipped(name: str) -> Path | None:
    """The file of a model that comes with rsym, by its name; None for any other name.

    Examples
    --------
    >>> shipped("car").name, shipped("no-such-model")
    ('car.rf', None)
    """
    if not name.isidentifier():
        return None
    return next((path for path in (_models() / room / f"{name}.rf" for room in ROOMS) if path.is_file()), None)


def _models() -> Path:
    return Path(str(files("rsym"))) / "paper"


def _read(path: str | PathLike[str]) -> bytes:
    """The bytes of a file, no more than a model can have."""
    longest = _LONGEST_LINES if is_vm(path) else _LONGEST_FILE
    try:
        with Path(path).open("rb") as file:
            data = file.read(longest + 1)
    except FileNotFoundError:
        if (model := shipped(str(path))) is not None:
            return model.read_bytes()
        known = [file.stem for room in ROOMS for file in sorted((_models() / room).glob("*.rf"))]
        remedy = proposal(path, known, "check the path, or name a shipped model")
        raise RsymError(f"no file {str(path)!r}", code="missing-file", remedy=remedy) from None
    except (OSError, ValueError, TypeError) as error:
        raise RsymError(f"cannot read {path!r}: {error}", code="unreadable-file", remedy="give a text file") from None
    if len(data) > longest:
        raise RsymError(f"{str(path)!r} has more than {longest} bytes", code="too-large", remedy="split the model")
    return data
