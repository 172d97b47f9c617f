"""How steep leaves and terms are: the gradient on the zero set of a leaf, and what to divide by; terms that saturate.

Far from its zero set a saturated term is nearly constant, whatever is added to or joined with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.model.functions import FUNCTIONS
from rsym.model.nodes import Fold, Trimming
from rsym.model.powers import AbsolutePower
from rsym.model.rnodes import R0mOperation
from rsym.model.symbols import postorder
from rsym.verify.lint.places import text_of

# u/sqrt(1 + u**2) has a twelfth of its greatest slope where it has reached nine tenths of its greatest value;
# a strip that the bounds just hold is as high in a third of them, but as flat only in a tenth.
HIGH = 0.9
FLAT = 0.1
MUCH = 1 / 3  # of the bounds
MOST_TERMS = 40
_BOUNDED = tuple(row.kind for row in FUNCTIONS.values() if row.levels)
MOST_PIECES = 60  # of a formula whose divisor is sought
CONSTANT = 1e-6  # relative: lengths of the gradient that differ by less are one
VANISHING = 1e-3  # of the greatest length of a gradient, which at random points comes that near to a zero


def operands_of(part: sp.Expr) -> tuple[sp.Expr, ...]:
    """What the zeros of an operation are those of."""
    if isinstance(part, Fold):
        return part.operands
    if isinstance(part, Trimming | AbsolutePower):
        return tuple(part.args[:1])
    return tuple(operand for operand in part.args if operand != -1)


def breaks_normalisation(part: sp.Expr) -> bool:
    """Whether an operation is not normalised whatever its operands are: of R_0^m, where |grad| = |g|**m on f = 0."""
    return isinstance(part, R0mOperation)


def message_of(slopes: Floats) -> str:
    """What is wrong with a leaf.

    Examples
    --------
    >>> import numpy as np
    >>> message_of(np.array([0.5, 2.0])), message_of(np.array([2.5, 2.5]))
    ('|grad| on its zero set is 0.5 .. 2, not 1', '|grad| on its zero set is 2.5, not 1')
    """
    low, high = float(slopes.min()), float(slopes.max())
    if is_constant(slopes) and abs(high - 1) < CONSTANT:
        return "|grad| on its zero set is 1 at these letters, but not at others"
    size = f"{high:.4g}" if is_constant(slopes) else f"{low:.4g} .. {high:.4g}"
    return f"|grad| on its zero set is {size}, not 1"


def remedy_of(leaf: sp.Expr, slopes: Floats, coordinates: Sequence[sp.Symbol]) -> str:
    """What to do about it: the divisor where the leaf has a constant one, else a normalisation.

    Examples
    --------
    >>> import numpy as np
    >>> from rsym import x, y
    >>> remedy_of(3 * x + 4 * y, np.array([5.0, 5.0]), (x, y))
    'divide by 5'
    """
    if slopes.max() < CONSTANT:
        return "the gradient vanishes on the zero set: take the function itself, not its power"
    if is_constant(slopes):
        found = divisor(leaf, coordinates)
        return f"divide by {f'{slopes.mean():.6g}' if found is None else text_of(found)}"
    if slopes.min() < VANISHING * slopes.max():
        return "take a primitive; rsym.normalise does not help where the gradient vanishes on the zero set"
    return "take a primitive, or rsym.normalise: f/sqrt(f^2/L^2 + |grad f|^2), L the size of the model"


def is_constant(slopes: Floats) -> bool:
    """Whether the gradient has one length all along the zero set."""
    return bool(np.ptp(slopes) <= CONSTANT * slopes.max())


def divisor(leaf: sp.Expr, coordinates: Sequence[sp.Symbol]) -> sp.Expr | None:
    """The length of the gradient on the zero set: of a linear function, of a quadratic one in one coordinate.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> a, b = sp.symbols("a b", real=True)
    >>> divisor(a * x - b * y + 1, (x, y)), divisor((b - x) * (x - a), (x, y)), divisor(x * y, (x, y))
    (sqrt(a**2 + b**2), Abs(a - b), None)
    """
    pieces = postorder(leaf)
    used = [symbol for symbol in coordinates if symbol in pieces]
    if not used or len(pieces) > MOST_PIECES or not leaf.is_polynomial(*used):
        return None
    polynomial = sp.Poly(leaf.doit(), *used)  # sums in sums, as texts may have them, are one sum
    if polynomial.total_degree() == 1:
        return sp.sqrt(sp.Add(*(polynomial.coeff_monomial(symbol) ** 2 for symbol in used)))
    if polynomial.total_degree() == 2 and len(used) == 1:
        return sp.sqrt(sp.factor(polynomial.discriminant()))
    return None


def level(values: Floats, slopes: Floats, slope: float) -> tuple[float, float]:
    """The greatest size of a function at points, and the share of them where it is near it and flat.

    slopes: the lengths of its gradient at the points; slope: that on its zero set.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-10, 10, 101)
    >>> greatest, share = level(np.tanh(t), 1 / np.cosh(t) ** 2, 1.0)
    >>> round(greatest, 3), share > 0.8
    (1.0, True)
    >>> level(t, np.ones(101), 1.0)[1]
    0.0
    """
    known = np.isfinite(values) & np.isfinite(slopes)
    sizes = np.abs(values[known])
    if not len(sizes):
        return 0.0, 0.0
    return float(sizes.max()), float(((sizes > HIGH * sizes.max()) & (slopes[known] < FLAT * slope)).mean())


def terms_of(leaves: Sequence[sp.Expr], coordinates: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """Terms inside leaves that may be bounded, each added to another one that depends on the coordinates.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> terms_of([y + x / sp.sqrt(1 + x**2), 1 - sp.tanh(x)], (x, y))
    [x/sqrt(x**2 + 1)]
    """
    found: dict[sp.Expr, None] = {}
    for leaf in leaves:
        for total in _sums(leaf):
            varying = [term for term in total.args if term.free_symbols.intersection(coordinates)]
            if len(varying) > 1:
                found |= dict.fromkeys(term for term in varying if _may_be_bounded(term, coordinates))
    return list(found)[:MOST_TERMS]


def _sums(leaf: sp.Expr) -> Iterator[sp.Expr]:
    """The sums in a leaf, but for those under roots."""
    parts = postorder(leaf)
    under = {id(part.base) for part in parts if part.is_Pow and not part.exp.is_Integer}
    return (part for part in parts if part.is_Add and id(part) not in under)


def _may_be_bounded(term: sp.Expr, coordinates: Sequence[sp.Symbol]) -> bool:
    """Whether it is a quotient by a root in the coordinates, or made with a function that levels off."""
    pieces = [term, *(factor for factor in sp.Mul.make_args(term))]
    quotient = any(
        piece.is_Pow and piece.exp.is_negative and piece.base.free_symbols.intersection(coordinates) for piece in pieces
    )
    return quotient or any(isinstance(part, _BOUNDED) for part in postorder(term))
