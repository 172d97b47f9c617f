"""Weights: functions that, inside a shape and on its boundary, vanish on a part of the boundary and nowhere else.

Of a leaf of the part it is the leaf. A minimum of f and g is inside where both are, so the weights of both are
multiplied: of a shape whose operands are all joined by "and" the weight is the product of its leaves, analytic at its
corners too. A maximum f or g has the boundary f = 0 only where g <= 0, which

    weight(f) or (g - f),    "or" being the disjunction of an R-system,

tells: it vanishes where weight(f) = 0 and g <= f = 0; where f = 0 < g it is positive; and where it would vanish for
g - f = 0, both being negative, nothing is inside. It is analytic but at f = g = 0, where the corner is re-entrant. If
the part has all leaves of f or g, that is f or g itself. Such a product is no predicate: outside it may be positive.
Source: of products of conjuncts V. L. Rvachev (1982).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction
from typing import NamedTuple

import sympy as sp

from rsym.analysis.differential import gradient
from rsym.analysis.normalisation import normalise
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Shape
from rsym.model.symbols import symbols_of
from rsym.model.vectors import squared
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.program.raising import raised


class Joins(NamedTuple):
    """How weights are put together: a product, or by equivalence, which keeps an order of normalisation.

    soft : a distance about corners, within which the first order is given up for f*g/sqrt(f**2 + g**2 + soft**2),
        which is as smooth as weights are.
    """

    order: int | None = None
    soft: float = 0.0

    def both(self, b: Builder, f: int, g: int) -> int:
        """What vanishes where one of two weights does; f*g/sqrt(f**2 + g**2) and the like keep an order."""
        if self.soft:
            squares = [b.mul(f, f), b.mul(g, g), b.const(Fraction(self.soft) ** 2)]
            return b.div(b.mul(f, g), b.sqrt(b.add(b.add(*squares[:2]), squares[2])))
        return b.mul(f, g) if self.order is None else b.make("equivalence", f, g, b.const(even(self.order)))

    def either(self, b: Builder, f: int, g: int) -> int:
        """The disjunction."""
        if self.order is None or self.order == 1:
            return b.make("r0_disjunction", f, g)
        return b.make("rp_disjunction", f, g, b.const(even(self.order + 1)))

    def all_of(self, b: Builder, f: int, g: int) -> int:
        """The conjunction."""
        if self.order is None or self.order == 1:
            return b.make("r0_conjunction", f, g)
        return b.make("rp_conjunction", f, g, b.const(even(self.order + 1)))


PRODUCT = Joins()
MOST_FACTORS = 6  # the leaves of the car have values of hundreds


def even(number: int) -> int:
    """The least even number from here on: such powers need no absolute values.

    Examples
    --------
    >>> even(2), even(3)
    (2, 4)
    """
    return number + number % 2


class _Part(NamedTuple):
    """An operand of the form: its weight if any of its leaves are wanted, its own function, whether all are."""

    weight: int | None
    node: int
    all: bool


def weight(
    form: SignForm, wanted: Collection[int], leaves: Sequence[int] | None = None, joins: Joins = PRODUCT
) -> int | None:
    """The node of a weight of some leaves of a form, given by their numbers; None of none.

    Other functions with the same zeros and signs may stand for the `leaves`, normalised ones for example.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import shape_form
    >>> form = shape_form(rsym.Shape(rsym.conjunction(x, y, rsym.disjunction(1 - x, 2 - y)), (x, y)))
    >>> for wanted in ([0, 1], [2, 3], [0, 2]):
    ...     print(raised(form.builder.nodes, weight(form, wanted)))
    x*y
    disjunction(1 - x, 2 - y)
    x*disjunction(1 - x, x - y + 1)
    """
    b = form.builder
    nodes = form.leaves if leaves is None else leaves
    parts = [_Part(node if number in wanted else None, node, number in wanted) for number, node in enumerate(nodes)]

    def both(f: int | None, g: int | None) -> int | None:
        return joins.both(b, f, g) if f is not None and g is not None else g if f is None else f

    def join(gate: Gate, f: _Part, g: _Part) -> _Part:
        if gate.operation == "min":
            return _Part(both(f.weight, g.weight), joins.all_of(b, f.node, g.node), f.all and g.all)
        whole = joins.either(b, f.node, g.node)
        if f.all and g.all:
            return _Part(whole, whole, True)
        kept = [
            None if one.weight is None else joins.either(b, one.weight, b.sub(other.node, one.node))
            for one, other in ((f, g), (g, f))
        ]
        return _Part(both(*kept), whole, False)

    return through(form.gates, parts, join)[-1].weight


class Weights:
    """The weights of parts of a shape as expressions, letters symbolic and R-nodes kept, normalised to an order.

    Leaves are divided by the length of their gradient on the boundary where that is constant, as of planes and
    spheres; others are normalised by Rvachev's theorem, with the length L. Weights of several leaves are put together
    by equivalence, so that all of them have the same order, but at corners.

    Examples
    --------
    >>> import rsym
    >>> from rsym.logic.sign_form import shape_form
    >>> ring = rsym.disc(2) - rsym.disc(1)
    >>> Weights(ring, shape_form(ring)).of([1])
    x**2/2 + y**2/2 - 1/2
    """

    def __init__(
        self, shape: Shape, form: SignForm, order: int = 1, length: sp.Expr = sp.S.One, soft: float = 0.0
    ) -> None:
        self.shape, self.form, self.order, self.length, self.soft = shape, form, order, length, soft
        self._leaves, self._factors = zip(*map(self._normalised, form.leaves), strict=True)

    def of(self, wanted: Collection[int]) -> sp.Expr:
        """The weight of some leaves; 1 of none."""
        return self._raised(wanted, self._leaves, Joins(self.order, self.soft))

    def factor(self, wanted: Collection[int]) -> sp.Expr:
        """One as smooth as can be, not normalised: the product of leaves; of many, which would be huge, the weight."""
        return self.of(wanted) if len(wanted) > MOST_FACTORS else self._raised(wanted, self._factors, PRODUCT)

    def _raised(self, wanted: Collection[int], leaves: Sequence[int], joins: Joins) -> sp.Expr:
        node = weight(self.form, wanted, leaves, joins)
        return sp.S.One if node is None else raised(self.form.builder.nodes, node)

    def _normalised(self, leaf: int) -> tuple[int, int]:
        """A leaf normalised, and as a factor."""
        b = self.form.builder
        bare = self.shape.replace(expression=raised(b.nodes, leaf))
        speed = constant_speed(bare, self.order)
        if speed is not None:
            return (lower(b, bare.expression / speed),) * 2
        return lower(b, normalise(bare, self.order, self.length, keep_sign=True).expression), leaf


def constant_speed(shape: Shape, order: int = 1) -> sp.Expr | None:
    """The length of the gradient of omega on its zero set where a formula without coordinates gives it, else None.

    |grad u|**2 + c*u does not depend on the point if u is linear, or the square of a distance, from a point, a line or
    a plane, and a constant. Of the second kind u over the length is normalised to order 1 only.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> constant_speed(rsym.Shape(8 - 2 * x**2 - 2 * (y - 1)**2, (x, y)))
    8
    >>> constant_speed(rsym.ellipse(2, 1)) is None
    True
    """
    coordinates = shape.coordinates
    polynomial = _polynomial(shape.expression, coordinates)
    if polynomial is None or polynomial.total_degree() not in range(1, 3 if order == 1 else 2):
        return None
    leading = next((c for c in (polynomial.coeff_monomial(s**2) for s in coordinates) if c != 0), sp.S.Zero)
    rest = sp.expand(squared(gradient(shape)) - 4 * leading * shape.expression)
    if set(symbols_of(rest)) & set(coordinates):
        return None
    rest = sp.factor(rest)
    if rest.is_number and not rest.is_positive:
        return None
    return sp.sqrt(rest)


def _polynomial(expression: sp.Expr, coordinates: tuple[sp.Symbol, ...]) -> sp.Poly | None:
    """An expression as a polynomial in the coordinates if it is a short one that looks like one."""
    if not expression.is_polynomial(*coordinates):
        return None
    try:
        return sp.Poly(expression, *coordinates)
    except sp.PolynomialError:
        return None
