"""The contract of a shape: what all promises of its formula come to."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from rsym.analysis.contracts.display import contract_document, normalisation, smoothness
from rsym.analysis.contracts.leaves import Leaf, decided_by, is_logical, leaves, names_of, parts_around, promised_parts
from rsym.analysis.contracts.orders import boundary_of, leaf_order
from rsym.analysis.contracts.promises import Ends, Order, Singularity
from rsym.analysis.contracts.squares import never_zero_together
from rsym.analysis.contracts.table import Promises, number_itself
from rsym.errors import RsymError
from rsym.model.choices import Choice
from rsym.model.letters import Letters
from rsym.model.nodes import without_zeros
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression, real_symbol, substitute
from rsym.reports.document import Document
from rsym.reports.render import Report

NO_LETTERS = Letters({})


@dataclass(frozen=True, repr=False)
class Contract(Report):
    """What a shape promises, by its formula alone.

    continuity : infinity where omega is analytic everywhere, else k: it is at least of class C^k, -1: it may jump
    order : the order to which omega is normalised, at the regular points of its boundary: off the singular sets, where
        one leaf vanishes and its gradient does not; infinity for a distance, 0 for not normalised, None for not shown
    singular : where omega may not be analytic, and of which class it is there
    exceptions : where on the boundary the order does not hold: on the fillets of blends, and where a
        function that was normalised to order 2 or more vanishes again, far from what it was made of
    leaves : what R-operations combine, each with its own order

    A promise is never more than what holds; the truth may be better.
    """

    expression: sp.Expr
    coordinates: tuple[sp.Symbol, ...]
    continuity: float
    order: Order
    exceptions: tuple[str, ...]
    singular: tuple[Singularity, ...]
    leaves: tuple[Leaf, ...]
    _names: Mapping[sp.Expr, str] = field(repr=False, compare=False)
    _promises: Promises = field(repr=False, compare=False)

    def __repr__(self) -> str:
        return f"Contract({smoothness(self.continuity)}; {self._normalisation})"

    def document(self) -> Document:
        """All that is promised."""
        return self._document

    @cached_property
    def _document(self) -> Document:
        """Made once: SymPy takes hundredths of a second to print its equations, as text and as LaTeX."""
        data = {
            "class": self.continuity,
            "order": self.order,
            "exact_distance": self.order == math.inf,
            "exceptions": self.exceptions,
            "singular_sets": len(self.singular),
            "leaves": [{"name": leaf.name, "part": leaf.part, "order": leaf.order} for leaf in self.leaves],
        }
        return contract_document(self.continuity, self._normalisation, self.singular, self.leaves, self._names, data)

    @property
    def _normalisation(self) -> str:
        return "; ".join([normalisation(self.order), *(self.exceptions if self.order else ())])

    @property
    def not_normalised(self) -> tuple[Leaf, ...]:
        """The leaves of order 0, and those of which nothing is shown."""
        return tuple(leaf for leaf in self.leaves if not leaf.order)

    def monotone(self, part: Any) -> int | None:
        """How omega changes with one part of it, all others held: +1 never falls, -1 never grows, 0 not at all.

        None where nothing is promised; part: a leaf, a letter or any other expression within.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> rsym.Shape(rsym.conjunction(x, -y), (x, y)).contract().monotone(y)
        -1
        """
        return slope_of(self._promises, as_expression(part.expression if isinstance(part, Leaf) else part))

    def image(self, bounds: Mapping[Any, tuple[Any, Any]]) -> Ends:
        """Expressions for the lower and the upper end of omega over a box.

        bounds: {symbol: (lower, upper)}, numbers or symbols; every other symbol stands for one value. An end that is
        undefined once evaluated says nothing; rounding is that of who evaluates.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> rsym.Shape(rsym.conjunction(x, -y), (x, y)).contract().image({x: (0, 1), y: (2, 3)})
        (conjunction(0, -3), conjunction(1, -2))
        """
        given = {as_expression(key): tuple(map(as_expression, ends)) for key, ends in bounds.items()}
        unknown = [str(key) for key in given if not key.is_Symbol]
        if unknown:
            raise RsymError(f"bounds are given for symbols, got {unknown[0]}", code="bounds")
        return image(self._promises, given)


def contract(shape: Shape) -> Contract:
    """What a shape promises: class, order, singular sets, leaves, monotonicity and interval image.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> found = contract(rsym.Shape((1 - x**2 - y**2) / 2, (x, y)) & rsym.Shape(x, (x, y)))
    >>> found.continuity, found.order
    (0, 1)
    >>> found.singular[0].equations
    (-x**2/2 - y**2/2 + 1/2, x)
    """
    promises = Promises(shape.expression, _LeastOf(shape.letters))
    lost = singularities(promises, shape.coordinates, shape.letters)
    found = leaves(promises)
    names, around = names_of(shape), parts_around(shape, promises)
    orders = {leaf: leaf_order(leaf, shape.coordinates) for leaf in found}
    return Contract(
        shape.expression,
        shape.coordinates,
        min((item.continuity for item in lost), default=math.inf),
        _order(promises, orders),
        _exceptions(promises, orders),
        lost,
        tuple(Leaf(leaf, names.get(leaf, ""), part, orders[leaf]) for leaf, part in zip(found, around, strict=True)),
        names,
        promises,
    )


def slope_of(promises: Promises, wanted: sp.Expr) -> int | None:
    """How a formula changes with one part: +1, -1, 0 or None where nothing is promised."""
    known: dict[int, int | None] = {}
    for piece in promises.parts():
        if hash(piece) == hash(wanted) and piece == wanted:
            known[id(piece)] = 1
            continue
        made = promises[piece]
        slopes = made.monotone or (None,) * len(made.operands)
        inner = [known[id(operand)] for operand in made.operands]
        known[id(piece)] = _agreed(list(map(_chained, inner, slopes)))
    return known[id(promises.root)]


def singularities(
    promises: Promises, coordinates: tuple[sp.Symbol, ...], letters: Letters = NO_LETTERS
) -> tuple[Singularity, ...]:
    """The distinct singular sets, in the order of the formula, but those that no point can belong to."""
    found: dict[Singularity, None] = {}
    for part in promises.parts(through=True):
        for lost in promises[part].singular:
            if any(equation.free_symbols & set(coordinates) for equation in lost.equations):
                found[lost] = None
    nonzero = _not_zero(letters)
    return tuple(lost for lost in found if not never_zero_together(lost.equations, coordinates, nonzero))


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


def _not_zero(letters: Letters) -> Callable[[sp.Expr], bool]:
    """Whether an expression in letters is not zero: at their defaults, nor by a factor whose range holds zero."""
    defaults = {real_symbol(name): sp.sympify(letter.default) for name, letter in letters.items()}

    def may_be_zero(factor: sp.Expr) -> bool:
        letter = letters.get(factor.name) if factor.is_Symbol else None
        low, high = (None, None) if letter is None else (letter.minimum, letter.maximum)
        return (low is not None or high is not None) and (low is None or low <= 0) and (high is None or high >= 0)

    def nonzero(value: sp.Expr) -> bool:
        if value == 0 or any(may_be_zero(factor) for factor in value.as_powers_dict()):
            return False
        return not defaults or bool(substitute(value, defaults) != 0)

    return nonzero


def _order(promises: Promises, orders: Mapping[sp.Expr, Order]) -> Order:
    known: dict[int, Order] = {}
    for part in promises.parts():
        if part in orders:
            known[id(part)] = orders[part]
        elif is_logical(part) and all(id(operand) in known for operand in decided_by(part, promises)):
            inner = [known.get(id(operand)) for operand in promises.inward(part)]
            known[id(part)] = promises[part].order(inner)
    return known[id(promises.root)]


def _exceptions(promises: Promises, orders: Mapping[sp.Expr, Order]) -> tuple[str, ...]:
    parts = [part for part in promised_parts(promises.root, promises) if is_logical(part)]
    texts = [text for part in parts if (text := promises[part].exception)]
    bare = {without_zeros(leaf): order for leaf, order in orders.items()}
    if any(order and boundary_of(leaf) != leaf for leaf, order in bare.items()):
        texts.append("it holds where the common factor of the terms of a leaf is zero, not where the other factor is")
    return tuple(dict.fromkeys(texts))


@dataclass(frozen=True)
class _LeastOf:
    """The least value of a letter: its minimum, or its default where it has none."""

    letters: Letters

    def __call__(self, exponent: sp.Expr) -> sp.Expr | None:
        letter = self.letters.get(exponent.name) if exponent.is_Symbol else None
        if letter is None:
            return number_itself(exponent)
        return sp.sympify(letter.default if letter.minimum is None else letter.minimum)


def _chained(inner: int | None, slope: int | None) -> int | None:
    if inner == 0:
        return 0
    return None if inner is None or slope is None else inner * slope


def _agreed(slopes: list[int | None]) -> int | None:
    moving = {slope for slope in slopes if slope != 0}
    if len(moving) > 1:
        return None
    return moving.pop() if moving else 0
