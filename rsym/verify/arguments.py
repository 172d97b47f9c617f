"""What all questions to a shape refuse alike: no shape, sizes that are not positive, budgets that buy nothing."""

from __future__ import annotations

import math
from numbers import Integral
from typing import Any

from rsym.errors import RsymError
from rsym.model.shape import Shape


def require_shape(shape: Any) -> None:
    """Refuse what is no shape.

    Examples
    --------
    >>> require_shape("ball")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a Shape, got str; remedy: Shape(expression, (x, y))
    """
    if not isinstance(shape, Shape):
        raise RsymError(
            f"expected a Shape, got {type(shape).__name__}", code="shape", remedy="Shape(expression, (x, y))"
        )


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
