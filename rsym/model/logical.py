"""What shapes are not, truth values and numbers: Python would answer some of it without a word."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Number
from typing import Any, NoReturn

from rsym.errors import RsymError

_UNION = "a | b is the union, a & b the intersection, a - b the difference"
_POINTS = "shape.contains(x, y) says whether points lie in it, shape.expression is omega"


def _refused(sign: str, remedy: str) -> Callable[[Any, Any], NoReturn]:
    """The method of an operator that a shape does not have."""

    def operator(self: Any, other: Any = None) -> NoReturn:
        raise RsymError(f"shapes have no operator {sign}", code="operator", remedy=remedy)

    return operator


def no_number(other: Any) -> Any:
    """What a shape is combined with, if it is no number: one would be all of the plane or nothing of it."""
    if isinstance(other, Number) or getattr(other, "is_number", False):
        raise RsymError(
            f"{other} is no shape: a shape and a number are not combined",
            code="operator",
            remedy="rsym.offset(shape, distance) grows or shrinks it; shape.expression - 1 is another omega",
        )
    return other


class NoNumber:
    """Refuses what a shape would do as a truth value or as a number, and says what it does instead.

    Examples
    --------
    >>> import rsym
    >>> rsym.disc(1) + rsym.disc(2)
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: shapes have no operator +; remedy: a | b is the union, a & b the intersection, a - b the \
difference
    """

    def __bool__(self) -> NoReturn:
        """Refused: of `a and b` Python would take b, and `not a` would be False."""
        raise RsymError(
            "a shape is neither true nor false: `and`, `or` and `not` do not combine it",
            code="truth",
            remedy="combine shapes by a & b, a | b, ~a; shape is None asks whether there is one",
        )

    __add__ = __radd__ = _refused("+", _UNION)
    __mul__ = __rmul__ = _refused("*", f"{_UNION}; shape.scale(2) enlarges, shape.expression is omega")
    __truediv__ = __rtruediv__ = _refused("/", "shape.scale(1/2) makes it smaller, a - b is the difference")
    __neg__ = _refused("- with one operand", "~a is the complement")
    __lt__ = __le__ = __gt__ = __ge__ = _refused("that compares", _POINTS)
    __contains__ = _refused("in", _POINTS)
