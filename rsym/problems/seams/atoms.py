"""Atoms: the factors of the leaves of a form, each once, of whose signs that of the form is made.

The leaves of two squares side by side, 1/4 - x**2 and the like, are zero on their boundary and where they meet; of
their factors each is zero on one line, and a line in both squares is one atom.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.backends.interpreter import interpret
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.gates import through
from rsym.logic.lifting import unfolded
from rsym.logic.sign_form import SignForm, has_kinks, shape_builder, shape_form
from rsym.model.shape import Bounds, Shape
from rsym.problems.pointwise import PointFormulas, compiled, with_derivatives
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.program.raising import raised
from rsym.sampling.labels import LEAST
from rsym.sampling.windows import bounds_or_extent

MOST_DEGREE, MOST_TERMS = 12, 120  # of a polynomial whose factors are looked for
ALIKE = 1e-12  # of their size at places all over the box: so near to each other two atoms are one

Signs = NDArray[np.int8]  # 1, 0, -1


class LeafFactors(NamedTuple):
    """A leaf as a product: the sign of its constant, and its atoms with their powers."""

    sign: int
    powers: tuple[tuple[int, int], ...]


@dataclass(frozen=True, eq=False)
class SignAtoms:
    """The atoms of a shape where its letters have their defaults.

    Attributes
    ----------
    form : SignForm
        That of the shape, with choices in its leaves as gates.
    functions : tuple of expressions
        The atoms.
    leaves : tuple of LeafFactors
        Of each leaf of the form.
    box : pairs
        Beyond it there is no boundary, or the shape does not go on.
    reduced : bool
        Whether a leaf has a root inside, and its atom none.

    Examples
    --------
    >>> import rsym
    >>> pair = rsym.rectangle(1, 1) | rsym.rectangle(1, 1).translate(1, 0)
    >>> atoms = atoms_of(pair)
    >>> sorted(map(str, atoms.functions))
    ['2*x + 1', '2*x - 1', '2*x - 3', '2*y + 1', '2*y - 1']
    """

    shape: Shape
    form: SignForm
    functions: tuple[sp.Expr, ...]
    leaves: tuple[LeafFactors, ...]
    box: Bounds
    reduced: bool

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.functions)

    @property
    def shared(self) -> bool:
        """Whether an atom stands in two places, or a leaf has a power: else parts share no edge."""
        places = Counter(operand for gate in self.form.gates for operand in gate[1:])
        every = [atom for leaf in self.leaves for atom, _ in leaf.powers]
        powers = [power for leaf in self.leaves for _, power in leaf.powers]
        return len({*every}) < len(every) or max([*places.values(), *powers], default=1) > 1

    @property
    def size(self) -> float:
        """The longest side of the box."""
        return float(np.ptp(np.array(self.box), axis=1).max())

    def inside(self, signs: NDArray[Any]) -> NDArray[Any]:
        """The sign of the form (n,) for signs (atoms, n) of the atoms; 0 where zeros leave it open or make it zero."""
        own = []
        for leaf in self.leaves:
            found = np.full(signs.shape[1:], leaf.sign, np.int8)
            for atom, power in leaf.powers:
                found = found * (signs[atom] if power % 2 else np.abs(signs[atom]))
            own.append(found)
        return through(self.form.gates, own, lambda gate, one, other: LEAST[gate.operation](one, other))[-1]

    def holds(self, signs: NDArray[Any]) -> Flags:
        """Whether the form is positive for all signs that zeros of the atoms may turn into."""
        found = np.ones(signs.shape[1], np.bool_)
        zeros = np.flatnonzero((signs == 0).any(axis=1))
        for turn in range(1 << len(zeros)):
            turned = signs.copy()
            for k, atom in enumerate(zeros):
                turned[atom][signs[atom] == 0] = 1 if turn >> k & 1 else -1
            found &= self.inside(turned) > 0
        return found

    @cached_property
    def _built(self) -> tuple[Builder, dict[str, int]]:
        builder = shape_builder(self.shape)
        nodes = {f"atom {k}": lower(builder, function) for k, function in enumerate(self.functions)}
        return builder, with_derivatives(builder, nodes, builder.coordinates, 1)

    @cached_property
    def _formulas(self) -> PointFormulas:
        return compiled(self.shape, *self._built)

    @cached_property
    def _bounds(self) -> IntervalFunction:
        builder, nodes = self._built
        return IntervalFunction(
            builder.program({f"{k}": node for k, node in enumerate([*nodes.values()][:: 1 + self.shape.dimension])}),
            threads=1,
        )

    def at(self, points: Floats) -> Floats:
        """Values and gradients (atoms, 1 + dim, n) at points (n, dim)."""
        with np.errstate(all="ignore"):
            return self._formulas(points).reshape(self.count, 1 + self.shape.dimension, len(points))

    @cached_property
    def never(self) -> list[tuple[int, int, int, int]]:
        """Signs that two atoms have nowhere, zeros like them: (atom, sign, other atom, its sign).

        Of f = a*g + d with a constant d > 0 there is no place where f <= 0 and a*g >= 0.
        """
        low, high = np.array(self.box, float).T
        values = self.at(low + np.random.default_rng(35).uniform(0, 1, (16, len(low))) * (high - low))
        found = []
        for one, other in combinations(range(self.count), 2):
            f, g = values[one], values[other]
            with np.errstate(all="ignore"):
                times = np.vdot(g[1:], f[1:]) / np.vdot(g[1:], g[1:])
            left = f - times * g
            sign = int(np.sign(left[0, 0]))
            if sign and np.abs(left[1:]).max() <= ALIKE * np.abs(f[1:]).max() and np.ptp(left[0]) <= ALIKE * self.size:
                found.append((one, -sign, other, sign * int(np.sign(times))))
        return found

    def signs(self, points: Floats) -> Signs:
        """The signs of the atoms (atoms, n) at points."""
        return np.nan_to_num(np.sign(self.at(points)[:, 0])).astype(np.int8)

    def over(self, lower: Floats, upper: Floats) -> Signs:
        """Those over boxes (n, dim), 0 where they are not known."""
        found = self._bounds(list(lower.T), list(upper.T), self.shape.letters.values_with(None))
        low, high = (
            np.array([np.broadcast_to(found[f"{k}"][end], len(lower)) for k in range(self.count)]) for end in (0, 1)
        )
        return (low > 0).astype(np.int8) - (high < 0)


def atoms_of(shape: Shape) -> SignAtoms:
    """The atoms of a shape, letters symbolic."""
    form = shape_form(shape)
    if any(has_kinks(form.builder, leaf) for leaf in form.leaves):
        form = unfolded(form)
    box = bounds_or_extent(shape, None)
    known = _Known(shape, box)
    leaves = tuple(known.factored(raised(form.builder.nodes, leaf)) for leaf in form.leaves)
    return SignAtoms(shape, form, tuple(known.functions), leaves, box, known.reduced)


class _Known:
    """The atoms that were found so far."""

    def __init__(self, shape: Shape, box: Bounds) -> None:
        self.shape, self.functions, self.reduced = shape, list[sp.Expr](), False
        self._values: list[Floats] = []
        low, high = np.array(box, float).T
        places = np.random.default_rng(36).uniform(-0.2, 1.2, (16, len(low)))
        self._places = low + places * (high - low)

    def factored(self, leaf: sp.Expr) -> LeafFactors:
        """A leaf, its new atoms added."""
        sign, powers = 1, dict[int, int]()
        for part, power in _factors(leaf, self.shape.coordinates):
            factor = _without_root(part)
            self.reduced |= factor is not part
            atom, turned = self._number(factor)
            if atom >= 0:
                powers[atom] = powers.get(atom, 0) + power
            sign *= turned**power
        return LeafFactors(sign, tuple(powers.items()))

    def _number(self, factor: sp.Expr) -> tuple[int, int]:
        """The number of an atom and the sign of a factor to it; -1 of a constant, its sign 0 if it has no value."""
        values = self._at(factor)
        usual = np.nanmax(np.abs(values), initial=0.0)
        if not set(factor.free_symbols) & set(self.shape.coordinates):
            return -1, int(np.nan_to_num(np.sign(values[0])))
        values = values / usual
        for number, other in enumerate(self._values):
            for sign in (1, -1):
                if np.nanmax(np.abs(values - sign * other), initial=0.0) <= ALIKE:
                    return number, sign
        self.functions.append(factor)
        self._values.append(values)
        return len(self.functions) - 1, 1

    def _at(self, factor: sp.Expr) -> Floats:
        builder = shape_builder(self.shape)
        program = builder.program({"": lower(builder, factor)})
        inputs = {**dict(zip(program.coordinates, self._places.T, strict=True)), **self.shape.letters.values_with(None)}
        found = np.broadcast_to(interpret(program, inputs)[""], len(self._places))
        return np.where(np.isfinite(found), found, np.nan)


def _factors(leaf: sp.Expr, coordinates: Sequence[sp.Symbol]) -> list[tuple[sp.Expr, int]]:
    """What a formula is a product of, with whole powers; constants too."""
    found = []
    for part in sp.Mul.make_args(leaf):
        base, power = part.as_base_exp()
        if not (power.is_Integer and power > 0):
            base, power = part, sp.S.One
        if base.is_number or not base.is_polynomial(*coordinates) or not base.is_Add:
            found.append((base, int(power)))
            continue
        polynomial = sp.Poly(base, *coordinates)
        if (
            polynomial.total_degree() < 2
            or polynomial.total_degree() > MOST_DEGREE
            or len(polynomial.terms()) > MOST_TERMS
        ):
            found.append((base, int(power)))
            continue
        times, factors = sp.factor_list(base, *coordinates)
        if len(factors) == 1 and factors[0][1] == 1:
            found.append((base, int(power)))
        else:
            found += [(times, int(power)), *((factor, int(power) * inner) for factor, inner in factors)]
    return found


def _without_root(formula: sp.Expr) -> sp.Expr:
    """A formula a - b*sqrt(q) as a**2 - b**2*q for positive numbers a and b: where q is 0 inside, it has no kink.

    Examples
    --------
    >>> from rsym import x, y
    >>> _without_root(2 - sp.sqrt(x**2 + y**2)), _without_root(sp.sqrt(x**2 + y**2) - 1)
    (-x**2 - y**2 + 4, x**2 + y**2 - 1)
    """
    constant, rest = formula.as_coeff_Add()
    times, root = rest.as_coeff_Mul()
    if not (isinstance(root, sp.Pow) and root.exp == sp.Rational(1, 2) and constant * times < 0):
        return formula
    return sp.sign(constant) * (constant**2 - times**2 * root.base)
