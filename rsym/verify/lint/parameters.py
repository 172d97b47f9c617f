"""Letters that are parameters of R-operations, and the values that their systems allow."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from rsym.model.equivalences import EquivalenceOperation
from rsym.model.folds import Fold
from rsym.model.letters import Letter, Letters
from rsym.model.rnodes import R0mOperation, RAlphaOperation, RpOperation
from rsym.model.traversal import postorder

Accepts: TypeAlias = Callable[[float, bool], bool]  # a value, and whether it is taken rather than an end of a range


@dataclass(frozen=True)
class Parameter:
    """A letter that is the parameter of an R-operation, what it must be, and which of its values are not."""

    name: str
    symbol: str
    wanted: str
    wrong: tuple[str, ...]


def parameters(expression: sp.Expr, letters: Letters) -> list[Parameter]:
    """The letters that are parameters of R-operations, whose default or range is not legal throughout.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> from rsym.model.letters import Letter, as_letters
    >>> alpha = sp.Symbol("alpha", real=True)
    >>> given = as_letters({alpha: Letter(0, minimum=-1, maximum=1)})
    >>> parameters(rsym.conjunction(x, y, system=rsym.RAlpha(alpha)), given)
    [Parameter(name='alpha', symbol='alpha', wanted='in (-1, 1]', wrong=('its minimum -1',))]
    """
    found: dict[tuple[str, type], Parameter] = {}
    for part in postorder(expression):
        for kind, (symbol, wanted, accepts) in _LEGAL.items():
            if isinstance(part, kind) and part.parameters[0].is_Symbol:
                name = part.parameters[0].name
                wrong = tuple(_wrong(letters[name], accepts))
                if wrong:
                    found[name, kind] = Parameter(name, symbol, wanted, wrong)
    return list(found.values())


def _wrong(letter: Letter, accepts: Accepts) -> Iterator[str]:
    if not accepts(float(letter.default), True):
        yield f"its default {float(letter.default):g}"
    for name, end, value in (("minimum", letter.minimum, -math.inf), ("maximum", letter.maximum, math.inf)):
        if end is not None and not accepts(float(end), False):
            yield f"its {name} {float(end):g}"
        elif end is None and not accepts(value, False):
            yield f"its {name}, which is open"


_LEGAL: Mapping[type[Fold], tuple[str, str, Accepts]] = {
    RAlphaOperation: ("alpha", "in (-1, 1]", lambda a, exact: -1 < a <= 1),
    R0mOperation: ("m", "a positive integer", lambda m, exact: m >= 1 and (not exact or m == int(m))),
    RpOperation: ("p", "above 1", lambda p, exact: p > 1),
    EquivalenceOperation: ("m", "a positive integer", lambda m, exact: m >= 1 and (not exact or m == int(m))),
}
