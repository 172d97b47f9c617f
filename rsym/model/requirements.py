"""What public functions refuse alike: things of a wrong kind, sizes that are not positive, budgets that buy nothing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from importlib import import_module
from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from rsym.errors import RsymError
from rsym.model.equation import Equation

T = TypeVar("T")

_ARTICLES = {letter: "an" for letter in "AEIOU"}
_REMEDIES = {
    "Shape": "Shape(expression, (x, y))",
    "Mesh": "rsym.mesh(shape), or patch.mesh() of a patch",
    "Patch": "a patch of rsym.surfaces",
    "Section": "what rsym.sections(shape, values) gives",
    "Spectrum": "what rsym.modes(shape, count) gives",
    "Torsion": "what rsym.torsion(shape) gives",
    "ElasticSolution": "what rsym.elasticity(shape, conditions, young=1, poisson=0.3) gives",
}
# What is drawn by a function of its own.
_DRAWN = {
    "Spectrum": "rsym.plot_modes draws it; one of its .modes is a field",
    "ElasticSolution": "rsym.plot_deformation draws it; its .shape is a shape",
    "SolutionStructure": ".with_values() is a shape, with letters for what is unknown, .with_functions(f) one with f",
    "Mesh": "the shape that it was made of, for a mesh has no equation",
}


def require_shape(shape: Any) -> None:
    """Refuse what is no shape.

    Examples
    --------
    >>> require_shape("ball")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a Shape, got str; remedy: rsym.load(name) gives the shape of a name
    """
    if not isinstance(shape, Equation):
        remedy = "rsym.load(name) gives the shape of a name" if isinstance(shape, str) else _REMEDIES["Shape"]
        if isinstance(getattr(shape, "shape", None), Equation):
            remedy = "its .shape is one; a field on a shape is called with coordinates"
        got = type(shape).__name__
        raise RsymError(f"expected a Shape, got {got}", code="shape", remedy=_DRAWN.get(got, remedy))


def require_kind(kind: type[T], value: Any, code: str, remedy: str = "") -> T:
    """The value, if it is of this kind.

    Examples
    --------
    >>> from rsym import Shape
    >>> require_kind(Shape, 1j, "shape")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a Shape, got complex; remedy: Shape(expression, (x, y))
    """
    if not isinstance(value, kind):
        raise RsymError(
            f"expected {_ARTICLES.get(kind.__name__[0], 'a')} {kind.__name__}, got {type(value).__name__}",
            code=code,
            remedy=remedy or _REMEDIES.get(kind.__name__, ""),
        )
    return value


def several(kind: type[T], values: Any, code: str) -> list[T]:
    """One thing of a kind or an iterable of them, as a list; anything else is refused.

    Examples
    --------
    >>> from rsym import Shape
    >>> several(Shape, 3, "shape")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a Shape or several, got int; remedy: Shape(expression, (x, y))
    """
    if isinstance(values, kind):
        return [values]
    found = list(values) if isinstance(values, Iterable) and not isinstance(values, str | Mapping) else [values]
    wrong = next((one for one in found if not isinstance(one, kind)), None)
    if wrong is not None or (found and not all(isinstance(one, kind) for one in found)):
        raise RsymError(
            f"expected {_ARTICLES.get(kind.__name__[0], 'a')} {kind.__name__} or several, got {type(wrong).__name__}",
            code=code,
            remedy=_REMEDIES.get(kind.__name__, ""),
        )
    return found


def require_mapping(values: Any, code: str, remedy: str) -> Mapping[Any, Any]:
    """The mapping; anything else is refused.

    Examples
    --------
    >>> require_mapping([], "shape", 'for example {"disc": rsym.disc()}')
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a mapping of names, got list; remedy: for example {"disc": rsym.disc()}
    """
    if not isinstance(values, Mapping):
        raise RsymError(f"expected a mapping of names, got {type(values).__name__}", code=code, remedy=remedy)
    return values


def file_path(path: Any) -> Path:
    """The path of a file; what cannot be one is refused.

    Examples
    --------
    >>> file_path(None)
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected the path of a file, got NoneType; remedy: for example "body.stl"
    """
    if not isinstance(path, str | PathLike):
        raise RsymError(
            f"expected the path of a file, got {type(path).__name__}", code="path", remedy='for example "body.stl"'
        )
    return Path(path)


def path_ending(path: Any, suffix: str, what: str) -> Path:
    """The path of a file, if it ends as it must: asked before the work, not after it.

    Examples
    --------
    >>> path_ending("page.pdf", ".html", "a page is")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: a page is written as .html, got 'page.pdf'; remedy: end the name with .html
    """
    named = file_path(path)
    if named.suffix.lower() != suffix:
        raise RsymError(
            f"{what} written as {suffix}, got {str(named)!r}", code="suffix", remedy=f"end the name with {suffix}"
        )
    return named


def require_positive(name: str, value: Any, remedy: str) -> None:
    """Refuse a size that is no finite positive number.

    Examples
    --------
    >>> require_positive("tolerance", -1, "for example 0.01")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: tolerance must be a positive number, got -1; remedy: for example 0.01
    """
    try:
        good = 0 < float(value) < math.inf
    except (TypeError, ValueError):
        good = False
    if not good or isinstance(value, str | bool):
        raise RsymError(f"{name} must be a positive number, got {value!r}", code=name, remedy=remedy)


def require_count(name: str, value: Any, remedy: str) -> None:
    """Refuse a number of things that is no positive integer.

    Examples
    --------
    >>> require_count("budget", 0, "for example 1000")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: budget must be a positive integer, got 0; remedy: for example 1000
    """
    if isinstance(value, bool) or not isinstance(value, Integral) or value < 1:
        raise RsymError(f"{name} must be a positive integer, got {value!r}", code=name, remedy=remedy)


def optional_package(name: str, what: str) -> Any:
    """A package that rsym does without until someone asks for what needs it.

    Examples
    --------
    >>> optional_package("no_such_package", "a tune")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: a tune needs the package no_such_package, which cannot be imported; remedy: pip install \
no_such_package
    """
    try:
        return import_module(name)
    except (ImportError, OSError) as error:  # OSError: the package is there, its library is not
        raise RsymError(
            f"{what} needs the package {name}, which cannot be imported",
            code="missing-package",
            remedy=f"pip install {name}",
        ) from error
