"""R-operations on expressions or on shapes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rsym.errors import RsymError
from rsym.model.bounding import BoundingBox, around, combined, lines, opposite
from rsym.model.equation import combine
from rsym.model.nodes import Trimming
from rsym.model.rnodes import Equivalence, Joining
from rsym.model.symbols import as_expression
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
    return combine(system.conjunction, *_some(operands), box=combined("intersection", exactly=system.keeps_sets))


def disjunction(*operands: Any, system: RSystem = R0) -> Any:
    """Union, f or g: positive where some operand is.

    R_0: f + g + sqrt(f**2 + g**2); more operands are folded from the left.

    Examples
    --------
    >>> from rsym import disjunction, x, y
    >>> disjunction(x, y).doit()
    x + y + sqrt(x**2 + y**2)
    """
    return combine(system.disjunction, *_some(operands), box=combined("union", exactly=system.keeps_sets))


def negation(operand: Any) -> Any:
    """Complement: -f.

    Examples
    --------
    >>> from rsym import negation, x, y
    >>> negation(x - y)
    -x + y
    """
    return combine(lambda f: -f, operand, box=lambda boxes: opposite(boxes)[0])


def difference(minuend: Any, *subtrahends: Any, system: RSystem = R0) -> Any:
    """Return f and not g: what is in the first and in none of the others.

    Examples
    --------
    >>> from rsym import difference, x, y
    >>> difference(x, y)
    conjunction(x, -y)
    """
    return combine(
        lambda f, *rest: system.conjunction(f, *(-g for g in rest)),
        minuend,
        *subtrahends,
        box=combined("difference", exactly=system.keeps_sets),
    )


def exclusive_or(f: Any, g: Any, system: RSystem = R0) -> Any:
    """Return (f and not g) or (not f and g).

    Examples
    --------
    >>> from rsym import exclusive_or, x, y
    >>> exclusive_or(x, y)
    disjunction(conjunction(x, -y), conjunction(-x, y))
    """
    return combine(lambda a, b: system.disjunction(system.conjunction(a, -b), system.conjunction(-a, b)), f, g)


def implication(f: Any, g: Any, system: RSystem = R0) -> Any:
    """Return (not f) or g: positive where f is negative or g is positive.

    Examples
    --------
    >>> from rsym import implication, x, y
    >>> implication(x, y)
    disjunction(-x, y)
    """
    return disjunction(negation(f), g, system=system)


def equivalence(*operands: Any, order: Any = 2) -> Any:
    """The normalised equivalence f g/(|f|**m + |g|**m)**(1/m), m the order: positive where the signs agree.

    Its zero set is the union of the zero sets. It is associative, 0 where an
    operand is 0, and where the operands are normalised to order m so is the
    result, except where two of them vanish. For even m it is analytic away
    from there. More operands: the sign is the product of the signs.
    Source: Sukumar and Srivastava (2022), equations 9 and 10.

    Parameters
    ----------
    *operands : expressions or shapes
        What is compared.
    order : positive integer or letter
        m, by default 2.

    Raises
    ------
    RsymError
        For no operand, or an order that is neither a positive integer nor a letter.

    Examples
    --------
    >>> from rsym import equivalence, x, y
    >>> equivalence(x, y).doit()
    x*y/sqrt(x**2 + y**2)
    """
    m = _order(order)

    def box(boxes: Sequence[BoundingBox | None]) -> BoundingBox | None:
        return opposite([around(boxes)])[0] if len(boxes) % 2 == 0 else around(boxes)

    return combine(lambda *f: Equivalence(m, *f), *_some(operands), box=box)


def joining(*curves: Any, order: Any = 2) -> Any:
    """The curves f = 0, g = 0, ... as one: |f| |g|/(|f|**m + |g|**m)**(1/m), m the order; never negative.

    Normalised to order m where the operands are, except where two of them
    vanish; associative. Segments and arcs (`trimming`) become polylines and
    graphs, the skeletons of blended bodies.
    Source: Sukumar and Srivastava (2022), equations 9 and 10.

    Parameters
    ----------
    *curves : expressions or shapes
        Functions that are zero on the curves.
    order : positive integer or letter
        m, by default 2; m = 1 has the smallest Laplacian, a large m comes near to the minimum.

    Raises
    ------
    RsymError
        For no operand, or an order that is neither a positive integer nor a letter.

    Examples
    --------
    >>> from rsym import joining, trimming, x, y
    >>> cross = joining(trimming(x, 1 - y**2), trimming(y, 1 - x**2))
    >>> float(cross.subs({x: 0.5, y: 0}).evalf())
    0.0
    """
    m = _order(order)
    return combine(lambda *f: Joining(m, *f), *_some(curves), box=lines)


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
    return combine(Trimming, f, t, box=lambda boxes: lines(boxes[:1]))


rfAND, rfOR, rfNOT = conjunction, disjunction, negation  # the source's own names


def _order(order: Any) -> Any:
    m = as_expression(order)
    if not m.is_Symbol and not (m.is_Integer and m >= 1):
        raise RsymError(f"the order must be a positive integer or a letter, got {order!r}", code="order")
    return m


def _some(operands: tuple[Any, ...]) -> tuple[Any, ...]:
    if not operands:
        raise RsymError("an R-operation needs at least one operand, got none", code="arity")
    return operands
