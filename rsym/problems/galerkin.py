"""Galerkin's equations of a boundary value problem on weighted splines: what is integrated, and the system.

Conditions on fluxes are integrals along the boundary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial, reduce
from itertools import product
from operator import add
from typing import Any

import numpy as np
import sympy as sp
from scipy import sparse

from rsym.analysis.conditions import Robin
from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.model.symbols import real_symbol
from rsym.problems.plates import bending
from rsym.problems.pointwise import defined, first_place, formulas, require_numbers
from rsym.problems.problem import Problem, beside_at, on_part, value_at
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.splines.rules import splines_of
from rsym.problems.splines.web import WebSplines
from rsym.problems.systems.borders import BesideAt, SystemBorder
from rsym.problems.systems.families import Family, wider_sums, with_families
from rsym.problems.systems.forms import (
    Assembler,
    CellPoints,
    FormAt,
    LoadAt,
    Some,
    applied_form,
    energy,
    extended,
    transposed,
)
from rsym.problems.weak.weak_form import BOUNDARY, NORMALS, FormTerms, GivenValues, WeakForm, form_name, load_name
from rsym.sampling.rules.quadrature import Quadrature

BENDING = "d"  # the coefficient of a bilaplacian


@dataclass(frozen=True)
class EdgePart:
    """A form and a load at points of the boundary, weights in them, by the derivatives of v and u that they are on."""

    where: CellPoints
    form: Mapping[tuple[int, int], Floats]
    load: Mapping[int, Floats]
    kinds: int
    symmetric: bool = True

    @property
    def has_form(self) -> bool:
        """Whether there is a form that is not 0 at all points."""
        return any(values.any() for values in self.form.values())

    @property
    def has_load(self) -> bool:
        """Whether there is such a load."""
        return any(values.any() for values in self.load.values())

    @property
    def holds_level(self) -> bool:
        """Whether the form of a constant u is something."""
        return any(values.any() for (_, trial), values in self.form.items() if trial == 0)

    def form_at(self, some: Some, points: Floats) -> Floats:
        """The form (n, kinds, kinds) at some of the points."""
        found = np.zeros((len(points), self.kinds, self.kinds))
        for (test, trial), values in self.form.items():
            found[:, test, trial] = values[some]
        return found

    def load_at(self, some: Some, points: Floats) -> Floats:
        """The load (n, kinds, 1) there."""
        found = np.zeros((len(points), self.kinds, 1))
        for test, values in self.load.items():
            found[:, test, 0] = values[some]
        return found


@dataclass(frozen=True)
class Discretisation:
    """A problem on a rule of integration, by splines of a degree; `functions` are those beside them, if known."""

    problem: Problem
    rule: Quadrature
    degree: int
    threads: int | None = None
    functions: BesideAt | None = None

    @cached_property
    def splines(self) -> WebSplines:
        """The splines of the grid of the rule; of those that have no cell half inside each is part of others."""
        return splines_of(self.rule, self.degree)

    @property
    def kinds(self) -> int:
        """How many derivatives are integrated."""
        return len(derivatives(self.problem.dimension, self.problem.order))

    @cached_property
    def assembler(self) -> Assembler:
        """Of matrices."""
        return Assembler(self.splines, self.problem.order, self.threads)

    @cached_property
    def inside(self) -> CellPoints:
        """The points inside."""
        return CellPoints(self.rule.points, self.rule.cells, self.rule.full, self.rule.order)

    @property
    def extra_count(self) -> int:
        """How many functions there are beside the splines."""
        return self.problem.extra_count

    def tests(self, points: Floats) -> Floats:
        """The weight and its derivatives (kinds, n)."""
        return self.problem.weight(self.problem.order)(points)

    @cached_property
    def families(self) -> tuple[Family, ...]:
        """The splines times the weight, and those of kinks on interfaces."""

        def tests(number: int, points: Floats) -> Floats:
            found: Floats = self.problem.interfaces.weights(self.tests(points), points, self.problem.order)[number]
            return found

        plain = Family(self.tests, self.splines.extension)
        count = len(self.problem.interfaces.functions)
        sums = wider_sums(self.splines, count) if count else None
        return (plain, *(Family(partial(tests, 1 + k), sums) for k in range(count)))

    @property
    def beside_count(self) -> int:
        """How many functions there are beside the splines, those of kinks among them."""
        return self.extra_count + sum(one.count for one in self.families[1:])

    def parted(self, values: Floats) -> tuple[Floats, Floats]:
        """The coefficients (families, active) of splines, and those of other functions, of the values of a system."""
        counts = [self.families[0].count, self.extra_count, *(one.count for one in self.families[1:])]
        own, others, *folds = np.split(values, np.cumsum(counts)[:-1])
        return np.array([one.sums @ some for one, some in zip(self.families, [own, *folds], strict=True)]), others

    def extras(self, points: Floats) -> Floats:
        """The derivatives (kinds, functions, n) of the functions beside the splines."""
        return self.problem.extras(points, self.problem.order)

    def border(self, where: CellPoints) -> SystemBorder:
        """These functions at the points of a rule."""
        functions = self._functions if where is self.inside else beside_at(self.problem, where.points)
        return SystemBorder(self.assembler, (self.tests,), where, functions, self.extra_count)

    @cached_property
    def _functions(self) -> BesideAt:
        return self.functions or beside_at(self.problem, self.inside.points)

    # -- forms at points -------------------------------------------------------------------------------------------

    def equation_form(self, some: Some, points: Floats) -> Floats:
        """Of the equation: rows are tests, columns u."""
        dimension = self.problem.dimension
        weights = self.rule.weights[some] * self.problem.radius(points)
        values = self.coefficients(points)
        self._require_elliptic(values, points)
        form = np.zeros((len(points), self.kinds, self.kinds))
        expressions = self.problem.equation.expressions
        for (test, trial), name in self.problem.equation.places.items():
            if expressions[name] != 0:
                form[:, test, trial] = weights * values[name]
        if BENDING in values and self.problem.order == 2:
            second = slice(1 + dimension, None)
            work = bending(dimension, self.problem.poisson)
            form[:, second, second] = (weights * values[BENDING])[:, None, None] * work
        return form

    def load_form(self, some: Some, points: Floats) -> Floats:
        """Of the right side, (n, kinds, 1)."""
        values, weights = self.coefficients(points), self.rule.weights[some] * self.problem.radius(points)
        found = np.zeros((len(points), self.kinds, 1))
        for test, name in self.problem.equation.load_places.items():
            found[:, test, 0] = weights * values[name]
        return found

    @cached_property
    def _constant(self) -> bool:
        """Whether all coefficients, the load too, are the same everywhere."""
        equation = self.problem.equation
        varying = {*equation.coordinates, *map(real_symbol, equation.functions)}
        return not any(varying.intersection(value.free_symbols) for value in equation.expressions.values())

    def coefficients(self, points: Floats) -> dict[str, Floats]:
        """The coefficients of the equation at points, by name; those that are the same everywhere at one."""
        some = points[:1] if self._constant else points
        found = dict(zip(self.problem.equation.expressions, self.problem.coefficients(some), strict=True))
        for name, values in found.items():
            require_numbers(f"the coefficient {name!r}", values, some)
        return found

    def _require_elliptic(self, values: Mapping[str, Floats], points: Floats) -> None:
        dimension, equation = self.problem.dimension, self.problem.equation
        if equation.order == 4:
            wrong = ~(values[BENDING] > 0) if BENDING in values else self._folded(values)
        elif set(equation.places) == {(0, 0)}:
            return  # what is solved is no equation but a projection
        else:
            # Sylvester: the leading minors of the symmetric part are positive.
            a = [[(values[f"a{i}{j}"] + values[f"a{j}{i}"]) / 2 for j in range(dimension)] for i in range(dimension)]
            minors = [a[0][0], a[0][0] * a[1][1] - a[0][1] ** 2]
            if dimension == 3:
                twice = 2 * a[0][1] * a[1][2] * a[0][2]
                minors.append(minors[1] * a[2][2] + twice - a[0][0] * a[1][2] ** 2 - a[1][1] * a[0][2] ** 2)
            wrong = ~np.all([minor > 0 for minor in minors], axis=0)
        if wrong.any():
            raise RsymError(
                f"the equation is not elliptic at {first_place(points, wrong)}",
                code="not-elliptic",
                remedy="the coefficients of the second derivatives must be positive definite all over the shape",
            )

    def _folded(self, values: Mapping[str, Floats]) -> Flags:
        """Where a form of second derivatives is not above 0 for waves in each of a few directions."""
        every = derivatives(self.problem.dimension, 2)
        ways = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=self.problem.dimension) if any(way)])
        waves = np.array([np.prod(ways**index, axis=1) if sum(index) == 2 else 0 * ways[:, 0] for index in every])
        total = sum(
            np.multiply.outer(waves[test] * waves[trial], values[name])
            for (test, trial), name in self.problem.equation.places.items()
        )
        wrong: Flags = ~np.all(total > 0, axis=0)
        return wrong

    # -- the boundary ----------------------------------------------------------------------------------------------

    @cached_property
    def edge_parts(self) -> tuple[EdgePart, ...]:
        """What is integrated along each leaf of the boundary."""
        found = []
        boundary, problem = self.rule.boundary, self.problem
        terms = self._edge_terms
        for leaf in sorted({*problem.leaves(Robin), *terms}):
            on = boundary.leaves == leaf
            where = CellPoints(np.ascontiguousarray(boundary.points[on]), boundary.cells[on])
            weights = boundary.weights[on] * problem.radius(where.points)
            if not len(weights):
                continue
            condition = problem.conditions[leaf]
            if leaf in terms:
                found.append(self._edge_part(where, weights, terms[leaf], boundary.normals[on]))
                for values in (*found[-1].form.values(), *found[-1].load.values()):
                    require_numbers("what is given on the boundary", values, where.points)
            elif isinstance(condition, Robin):
                both = [
                    value_at(problem.shape, value, where.points) for value in (condition.coefficient, condition.flux)
                ]
                for values in both:
                    require_numbers("what is given on the boundary", values, where.points)
                # du/dn is along A n: the flux of the equation is A grad u . n.
                weights = weights * self._conductivity(where.points)
                found.append(EdgePart(where, {(0, 0): weights * both[0]}, {0: weights * both[1]}, self.kinds))
        return tuple(found)

    @cached_property
    def _edge_terms(self) -> dict[int, FormTerms]:
        """The terms of a weak form on the leaves of the boundary that have some."""
        problem, equation = self.problem, self.problem.equation
        if not isinstance(equation, WeakForm):
            return {}
        for name in (name for own in equation.edges for name in own):
            if isinstance(name, str) and name != BOUNDARY:
                on_part(problem, self.rule.boundary, name)
        parts = shape_leaf_parts(problem.shape)
        terms = {leaf: equation.on_leaf(parts[origin]) for leaf, origin in enumerate(problem.origins)}
        return {leaf: one for leaf, one in terms.items() if one.form or one.load}

    def _edge_part(self, where: CellPoints, weights: Floats, terms: FormTerms, normals: Floats) -> EdgePart:
        """The terms at points of a leaf."""
        beside = {name: GivenValues(column) for name, column in zip(NORMALS, np.transpose(normals), strict=False)}
        functions: dict[str, Callable[..., Any]] = {**self.problem.equation.functions, **beside}
        values = formulas(self.problem.shape, terms.expressions, functions)(where.points)
        named = dict(zip(terms.expressions, weights * values, strict=True))
        form = {pair: named[form_name(*pair)] for pair in terms.form}
        return EdgePart(where, form, {kind: named[load_name(kind)] for kind in terms.load}, self.kinds, terms.symmetric)

    def _conductivity(self, points: Floats) -> Floats:
        """The number k, at points, of a diffusion that is k times the identity."""
        problem = self.problem
        diffusion = problem.equation.diffusion
        n = range(problem.dimension)
        if any(diffusion[i][j] != (diffusion[0][0] if i == j else 0) for i in n for j in n):
            raise RsymError(
                "a condition on du/dn needs an equation that diffuses alike in all directions",
                code="condition",
                remedy='"-div(k*grad(u)) = f" with a number or an expression k; rsym.solve_form of forms, in which the '
                "flux is what is natural",
            )
        found: Floats = problem.coefficients(points)[0]
        return found

    # -- the system ------------------------------------------------------------------------------------------------

    @cached_property
    def matrix(self) -> sparse.csr_matrix:
        """Of all functions: inner splines, then the others."""
        return self.of_forms(self.forms(), self.problem.equation.symmetric)

    def of_forms(self, forms: Sequence[tuple[CellPoints, FormAt]], symmetric: bool = True) -> sparse.csr_matrix:
        """The matrix of all functions of a sum of forms."""
        own = reduce(add, (self.assembler.matrix(*form, self.tests, symmetric=symmetric) for form in forms))
        bordered = self._with_extras(extended(self.splines, own), forms, symmetric)
        if len(self.families) == 1:
            return bordered
        border = self.border if self.extra_count else None
        return with_families(bordered, self.families, self.assembler, forms, border, symmetric)

    def mass(self, density: sp.Expr | Callable[..., Any] = sp.S.One) -> sparse.csr_matrix:
        """Of the products of functions."""
        values = value_at(self.problem.shape, density, self.rule.points) * self.rule.weights
        form = at_values(values * self.problem.radius(self.rule.points), self.kinds)
        return self.of_forms([(self.inside, form)])

    @cached_property
    def right(self) -> Floats:
        """Of the load, the fluxes and the lift."""
        total = self.loads(self.inside, self.load_form)
        for part in self.edge_parts:
            if part.has_load:
                total = total + self.loads(part.where, part.load_at)
        lift = self.problem.lift(self.problem.order)
        if lift is not None:
            given = defined("the value on the boundary, as it goes on inside,", lift)
            for where, form in self.forms():
                total = total - self.loads(where, applied_form(form, given))
        for number, flow in enumerate(self.problem.flows):
            total[0, self.families[0].count + number] += flow
        right: Floats = total[0]
        return right

    @cached_property
    def lift_size(self) -> float:
        """The root of the energy of the lift: if it is the solution what is left of its loads is rounding beside it."""
        lift = self.problem.lift(self.problem.order)
        if lift is None:
            return 0.0
        given = defined("the value on the boundary, as it goes on inside,", lift)
        return float(np.sqrt(sum(energy(*part, given) for part in self.forms())))

    def forms(self) -> list[tuple[CellPoints, FormAt]]:
        """The forms of the whole equation, with where they are integrated."""
        on_edges = [(part.where, part.form_at) for part in self.edge_parts if part.has_form]
        return [(self.inside, self.equation_form), *on_edges]

    def loads(self, where: CellPoints, load: LoadAt, count: int = 1) -> Floats:
        """The loads (count, functions) of inner splines, then of the others."""
        own, *folds = (one.loads(self.assembler, where, load, count) for one in self.families)
        beside = [self.border(where).loads(load, count)] if self.extra_count else []
        return np.concatenate((own, *beside, *folds), axis=1)

    def _with_extras(
        self, own: sparse.csr_matrix, forms: Sequence[tuple[CellPoints, FormAt]], symmetric: bool
    ) -> sparse.csr_matrix:
        """With the rows and columns of functions of corners and levels."""
        count = self.extra_count
        if not count:
            return own
        active = len(self.splines.active)
        columns = sparse.csr_matrix((active + count, count))
        rows = sparse.csr_matrix((active, count))
        for where, form in forms:
            border = self.border(where)
            columns = columns + border.columns(form, symmetric=symmetric)
            if not symmetric:
                rows = rows + border.columns(transposed(form), symmetric=False, among=False)[:active]
        inner = self.splines.extension.T
        across, among = inner @ columns[:active], columns[active:]
        down = across if symmetric else inner @ rows
        return sparse.bmat([[own, across], [down.T, among]], format="csr")


def at_values(weights: Floats, kinds: int) -> FormAt:
    """The form weights*u*v."""

    def form(some: Some, points: Floats) -> Floats:
        found = np.zeros((len(points), kinds, kinds))
        found[:, 0, 0] = weights[some]
        return found

    return form
