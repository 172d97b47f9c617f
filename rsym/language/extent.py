"""What a piece of a model costs SymPy, known before SymPy sees it.

SymPy distributes (2*x)**n, merges sums into sums and compares trees without
regard to shared parts; twenty lines of doubling definitions would keep it busy
for hours. Sizes are therefore added up first, and a model beyond them is refused.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import sympy as sp

from rsym.language.syntax import Position
from rsym.model.symbols import postorder

LARGEST_SIZE = 100_000  # nodes of one formula with every name written out
DEEPEST = 1_000  # levels of one formula with every name written out
HIGHEST_DEGREE = 1_000  # integer exponents of powers of powers, multiplied
MOST_WORK = 60_000  # units of 20 to 40 microseconds: what SymPy was measured to need for one term of a sum
_BITS_SQUARED = 100_000_000  # an exact operation on b bits was measured to take less than b*b/_BITS_SQUARED units


@dataclass(frozen=True, slots=True)
class Extent:
    """The size of a formula, shared parts counted as often as they stand in it."""

    size: int = 1
    depth: int = 1
    width: int = 1  # terms and factors that merge with those around them
    bits: int = 0  # of the exact coefficients, if all of them met
    degree: int = 1

    def opaque(self, arguments: int) -> Extent:
        """The same formula as a function: no number in it meets those around it; ten arguments cost one unit."""
        return Extent(self.size, self.depth, 1 + arguments // 10)

    def raised(self, exponent: int, *, distributes: bool) -> Extent:
        """The same formula to an integer power, which SymPy distributes over factors, not over terms."""
        times = max(abs(exponent), 1)
        return replace(self, bits=self.bits * (times if distributes else 1), degree=self.degree * times)

    def of_terms(self) -> Extent:
        """The same formula as a true sum: exponents around it do not multiply those inside."""
        return replace(self, degree=1)


def joined(extents: Iterable[Extent]) -> Extent:
    """The extent of an operation on formulas of these extents."""
    parts = list(extents)
    return Extent(
        1 + sum(part.size for part in parts),
        1 + max(part.depth for part in parts),
        sum(part.width for part in parts),
        sum(part.bits for part in parts),
        max(part.degree for part in parts),
    )


def measured(expression: sp.Expr) -> Extent:
    """The extent of a formula that stands already; exponents of sums multiply those within, as they do for numbers.

    Examples
    --------
    >>> from rsym import x, y
    >>> measured(x**2 + y).size, measured((x**2 + y) ** 3).degree
    (5, 6)
    """
    known: dict[int, tuple[int, int, int]] = {}
    for part in postorder(expression):
        inner = [known[id(argument)] for argument in part.args]
        bits = int(part.p).bit_length() + int(part.q).bit_length() if isinstance(part, sp.Rational) else 0
        sizes = (1 + sum(size for size, _, _ in inner), 1 + max((depth for _, depth, _ in inner), default=0))
        known[id(part)] = (*sizes, bits + (sum(own for _, _, own in inner) if part.is_Add or part.is_Mul else 0))
    size, depth, bits = known[id(expression)]
    return Extent(size, depth, max(len(expression.args), 1), bits, _highest_degree(expression))


def _highest_degree(expression: sp.Expr) -> int:
    """Exponents of powers of powers, multiplied, functions apart: a number b bits long would grow to b times that."""
    known: dict[int, sp.Rational] = {}
    highest = sp.S.One
    for part in postorder(expression):
        inner = [known[id(argument)] for argument in part.args]
        degree = max(inner, default=sp.S.One) if part.is_Add or part.is_Mul or part.is_Pow else sp.S.One
        if part.is_Pow and part.exp.is_Rational:
            degree = known[id(part.base)] * abs(part.exp)
        known[id(part)], highest = degree, max(highest, degree)
    return int(highest)


def check_degree(extent: Extent, place: Position) -> None:
    """Refuse powers in which a number would be without end."""
    if extent.degree > HIGHEST_DEGREE:
        raise place.refuse(
            f"an exponent above {HIGHEST_DEGREE}, powers of powers multiplied", "too-large", "use smaller exponents"
        )


class Work:
    """How much work one model may still cause."""

    def __init__(self) -> None:
        self._work = 0

    def afford(self, extent: Extent, place: Position, *, sorts: bool = False) -> Extent:
        """The extent, if it and all that came before it is not too much; sorting arguments looks at all of them."""
        self._work += extent.width + extent.bits**2 // _BITS_SQUARED + sorts * extent.size // 50
        if extent.depth > DEEPEST:
            raise place.refuse(
                f"with every name written out the formula is more than {DEEPEST} levels deep",
                "too-deep",
                "combine many shapes in one rfAND or rfOR instead of one after the other",
            )
        check_degree(extent, place)
        if extent.size > LARGEST_SIZE:
            raise place.refuse(
                f"with every name written out the formula has more than {LARGEST_SIZE} parts",
                "too-large",
                "use each name less often",
            )
        if self._work > MOST_WORK:
            raise place.refuse(
                "the sums and products of this model are too long to be kept exact",
                "too-large",
                "use long sums less often, and numbers with fewer digits",
            )
        return extent
