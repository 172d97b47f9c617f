"""The interval image of a formula: its lower and upper end as expressions in the ends of its symbols."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from rsym.analysis.contracts.promises import Ends
from rsym.analysis.contracts.table import Promises
from rsym.model.choices import Choice


def image(promises: Promises, given: Mapping[sp.Symbol, Ends]) -> Ends:
    """Lower and upper end of the formula; a symbol without ends stands for one value.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import conjunction, x, y
    >>> low, high = sp.symbols("x_lower x_upper", real=True)
    >>> image(Promises(conjunction(x, y)), {x: (low, high)})
    (conjunction(x_lower, y), conjunction(x_upper, y))
    """
    known: dict[int, Ends] = {}
    for part in promises.parts():
        operands = [known[id(operand)] for operand in promises.inward(part)]
        if not operands:
            known[id(part)] = given.get(part, (part, part))
        elif all(low is high for low, high in operands) and not isinstance(part, Choice):  # whose tests are no operands
            known[id(part)] = (part, part)
        else:
            known[id(part)] = promises[part].image(*operands)
    return known[id(promises.root)]
