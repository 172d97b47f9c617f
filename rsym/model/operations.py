"""R-operations on expressions or on shapes."""

from __future__ import annotations

from typing import Any

from rsym.errors import RsymError
from rsym.model.nodes import Trimming
from rsym.model.shape import combine
from rsym.model.systems import R0, RSystem


def conjunction(*operands: Any, system: RSystem = R0) -> Any:
    """Intersection, f and g: positive where every operand is.

    R_0: f + g - sqrt(f**2 + g**2); more operands are folded from the left.
    Operands are expressions or shapes; the result is a shape if one of them is.

    Raises
    ------
    RsymError
        For no operand, text, or shapes in different coordinates.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> conjunction(x, y)
    conjunction(x, y)
    """
    return combine(system.conjunction, *_some(operands))


def disjunction(*operands: Any, system: RSystem = R0) -> Any:
    """Union, f or g: positive where some operand is.

    R_0: f + g + sqrt(f**2 + g**2); more operands are folded from the left.

    Examples
    --------
    >>> from rsym import disjunction, x, y
    >>> disjunction(x, y).doit()
    x + y + sqrt(x**2 + y**2)
    """
    return combine(system.disjunction, *_some(operands))


def negation(operand: Any) -> Any:
    """Complement: -f.

    Examples
    --------
    >>> from rsym import negation, x, y
    >>> negation(x - y)
    -x + y
    """
    return combine(lambda f: -f, operand)


def difference(minuend: Any, *subtrahends: Any, system: RSystem = R0) -> Any:
    """Return f and not g: what is in the first and in none of the others.

    Examples
    --------
    >>> from rsym import difference, x, y
    >>> difference(x, y)
    conjunction(x, -y)
    """
    return combine(lambda f, *rest: system.conjunction(f, *(-g for g in rest)), minuend, *subtrahends)


def exclusive_or(f: Any, g: Any, system: RSystem = R0) -> Any:
    """Return (f and not g) or (not f and g).

    Examples
    --------
    >>> from rsym import exclusive_or, x, y
    >>> exclusive_or(x, y)
    disjunction(conjunction(x, -y), conjunction(-x, y))
    """
    return combine(lambda a, b: system.disjunction(system.conjunction(a, -b), system.conjunction(-a, b)), f, g)


def trimming(f: Any, t: Any) -> Any:
    """The curve f = 0 kept where t >= 0: sqrt(f**2 + ((sqrt(t**2 + f**4) - t)/2)**2).

    Not negative, and zero just on the kept part; normalised where f is.
    Source: Sukumar and Srivastava (2022), equation 6.

    Examples
    --------
    >>> from rsym import trimming, x, y
    >>> trimming(y, 1 - x**2).subs({x: 0, y: 0}).evalf()
    0
    """
    return combine(Trimming, f, t)


rfAND, rfOR, rfNOT = conjunction, disjunction, negation  # the source's own names


def _some(operands: tuple[Any, ...]) -> tuple[Any, ...]:
    if not operands:
        raise RsymError("an R-operation needs at least one operand, got none", code="arity")
    return operands
