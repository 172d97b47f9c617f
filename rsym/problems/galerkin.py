"""Galerkin's equations of a boundary value problem on weighted splines: what is integrated, and the system.

Conditions on fluxes are integrals along the boundary.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from scipy import sparse

from rsym.analysis.conditions import Dirichlet, Robin
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.problems.plates import bending
from rsym.problems.problem import Problem, value_at
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.splines.web import WebSplines, web_splines
from rsym.problems.systems.cell_code import apply_forms, tested_loads
from rsym.problems.systems.forms import Assembler, CellPoints, extended
from rsym.sampling.rules.quadrature import Quadrature

Jets = Callable[[Floats], Floats]

# Of a cell: with whole cells alone, more splines are parts of others that are farther away, and the error of an ellipse
# that is turned and shifted at 12 cells of degree 4 changes by a factor of 2.3 and not by 1.2; the condition of the
# scaled matrix is 600 to 1300 then and not 1800 to 2100. With a third it is up to 5400, and nothing is gained.
HALF = 0.5


@dataclass(frozen=True)
class Discretisation:
    """A problem on a rule of integration, by splines of a degree."""

    problem: Problem
    rule: Quadrature
    degree: int
    threads: int | None = None

    @cached_property
    def splines(self) -> WebSplines:
        """The splines of the grid of the rule; of those that have no cell half inside each is part of others."""
        grid, rule = self.rule.grid, self.rule
        content = np.bincount(rule.cells, rule.weights, int(np.prod(grid.counts)))
        inner = np.flatnonzero(content >= HALF * grid.size ** len(grid.counts))
        return web_splines(grid.lower, grid.size, grid.counts, self.degree, rule.touched, inner)

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

    def extras(self, points: Floats) -> Floats:
        """The derivatives (kinds, functions, n) of the functions beside the splines."""
        key = hash(points.tobytes())
        if key not in self._lately:
            self._lately.clear()
            self._lately[key] = self.problem.extras(points, self.problem.order)
        return self._lately[key]

    @cached_property
    def _lately(self) -> dict[int, Floats]:
        """The last that were asked for: they are asked for again."""
        return {}

    # -- forms at points -------------------------------------------------------------------------------------------

    def equation_form(self, some: slice, points: Floats) -> Floats:
        """Of the equation: rows are tests, columns u."""
        dimension = self.problem.dimension
        weights = self.rule.weights[some] * self.problem.radius(points)
        values = dict(zip(self.problem.equation.expressions, self.problem.coefficients(points), strict=True))
        self._require_elliptic(values, points)
        form = np.zeros((len(points), self.kinds, self.kinds))
        for i in range(dimension):
            form[:, 0, 1 + i] = weights * values[f"b{i}"]
            for j in range(dimension):
                form[:, 1 + i, 1 + j] = weights * values[f"a{i}{j}"]
        form[:, 0, 0] = weights * values["c"]
        if self.problem.order == 2:
            second = slice(1 + dimension, None)
            work = bending(dimension, self.problem.poisson)
            form[:, second, second] = (weights * values["d"])[:, None, None] * work
        return form

    def load_form(self, some: slice, points: Floats) -> Floats:
        """Of the right side, (n, kinds, 1)."""
        place = list(self.problem.equation.expressions).index("f")
        found = np.zeros((len(points), self.kinds, 1))
        found[:, 0, 0] = (
            self.rule.weights[some] * self.problem.radius(points) * self.problem.coefficients(points)[place]
        )
        return found

    def _require_elliptic(self, values: Mapping[str, Floats], points: Floats) -> None:
        dimension = self.problem.dimension
        if self.problem.order == 2:
            wrong = ~(values["d"] > 0)
        else:
            # Sylvester: the leading minors of the symmetric part are positive.
            a = [[(values[f"a{i}{j}"] + values[f"a{j}{i}"]) / 2 for j in range(dimension)] for i in range(dimension)]
            minors = [a[0][0], a[0][0] * a[1][1] - a[0][1] ** 2]
            if dimension == 3:
                twice = 2 * a[0][1] * a[1][2] * a[0][2]
                minors.append(minors[1] * a[2][2] + twice - a[0][0] * a[1][2] ** 2 - a[1][1] * a[0][2] ** 2)
            wrong = ~np.all([minor > 0 for minor in minors], axis=0)
        if wrong.any():
            place = ", ".join(f"{value:.4g}" for value in points[int(np.argmax(wrong))])
            raise RsymError(
                f"the equation is not elliptic at ({place})",
                code="not-elliptic",
                remedy="the coefficients of the second derivatives must be positive definite all over the shape",
            )

    # -- the boundary ----------------------------------------------------------------------------------------------

    @cached_property
    def flux_parts(self) -> tuple[tuple[CellPoints, Floats, Floats, Floats], ...]:
        """Of each leaf with a condition on the flux: points, weights, the coefficient of u and the flux there."""
        found = []
        boundary, problem = self.rule.boundary, self.problem
        for leaf in problem.leaves(Robin):
            condition = problem.conditions[leaf]
            assert isinstance(condition, Robin)
            on = boundary.leaves == leaf
            where = CellPoints(np.ascontiguousarray(boundary.points[on]), boundary.cells[on])
            weights = boundary.weights[on] * problem.radius(where.points)
            both = [value_at(problem.shape, value, where.points) for value in (condition.coefficient, condition.flux)]
            # du/dn is along A n: the flux of the equation is A grad u . n.
            found.append((where, weights * self._conductivity(where.points), *both))
        return tuple(found)

    def _conductivity(self, points: Floats) -> Floats:
        """The number k, at points, of a diffusion that is k times the identity."""
        problem = self.problem
        diffusion = problem.equation.diffusion
        n = range(problem.dimension)
        if any(diffusion[i][j] != (diffusion[0][0] if i == j else 0) for i in n for j in n):
            raise RsymError(
                "a condition on du/dn needs an equation that diffuses alike in all directions",
                code="condition",
                remedy='"-div(k*grad(u)) = f" with a number or an expression k',
            )
        found: Floats = problem.coefficients(points)[0]
        return found

    def require_level(self) -> None:
        """Refuse a problem whose solutions differ by constants, whatever makes its coefficients 0."""
        problem = self.problem
        if problem.order != 1 or problem.leaves(Dirichlet) or any(part[2].any() for part in self.flux_parts):
            return
        if not problem.coefficients(self.rule.points)[list(problem.equation.expressions).index("c")].any():
            raise RsymError(
                "nothing fixes the level of the solution: with it every u + constant is one",
                code="singular",
                remedy="give a value on some part, rsym.robin on one, or a term c*u in the equation",
            )

    # -- the system ------------------------------------------------------------------------------------------------

    @cached_property
    def matrix(self) -> sparse.csr_matrix:
        """Of all functions: inner splines, then the others."""
        symmetric = self.problem.equation.symmetric
        own = self.assembler.matrix(self.inside, self.equation_form, self.tests, symmetric=symmetric)
        for where, weights, coefficient, _ in self.flux_parts:
            if len(weights) and coefficient.any():
                own = own + self.assembler.matrix(where, at_values(weights * coefficient, self.kinds), self.tests)
        return self._bordered(extended(self.splines, own), self._forms, symmetric)

    def mass(self, density: sp.Expr | Callable[..., Any] = sp.S.One) -> sparse.csr_matrix:
        """Of the products of functions."""
        values = value_at(self.problem.shape, density, self.rule.points) * self.rule.weights
        form = at_values(values * self.problem.radius(self.rule.points), self.kinds)
        own = self.assembler.matrix(self.inside, form, self.tests)

        return self._bordered(extended(self.splines, own), lambda: [(self.inside, form)], True)

    @cached_property
    def right(self) -> Floats:
        """Of the load, the fluxes and the lift."""
        total = self.loads(self.inside, self.load_form)
        for where, weights, _, flux in self.flux_parts:
            if len(weights) and flux.any():
                total = total + self.loads(where, single_load(weights * flux, self.kinds))
        lift = self.problem.lift(self.problem.order)
        if lift is not None:
            for where, form in self._forms():
                total = total - self.loads(where, applied_form(form, lambda points: lift(points)[:, None]))
        for number, flow in enumerate(self.problem.flows):
            total[0, total.shape[1] - self.extra_count + number] += flow
        right: Floats = total[0]
        return right

    def _forms(self) -> list[tuple[CellPoints, Any]]:
        """The forms of the whole equation, with where they are integrated."""
        found: list[tuple[CellPoints, Any]] = [(self.inside, self.equation_form)]
        for where, weights, coefficient, _ in self.flux_parts:
            found.append((where, at_values(weights * coefficient, self.kinds)))
        return found

    def loads(self, where: CellPoints, load: Any, count: int = 1) -> Floats:
        """The loads (count, functions) of inner splines, then of the others."""
        own = self.assembler.loads(where, load, self.tests, count) @ self.splines.extension
        if not self.extra_count:
            return np.asarray(own)
        extra = np.zeros((count, self.extra_count))
        for chunk in where.chunks():
            points = where.points[chunk.points]
            tested_loads(self.extras(points), load(chunk.points, points), extra)
        return np.concatenate((own, extra), axis=1)

    def _bordered(self, own: sparse.csr_matrix, forms: Any, symmetric: bool) -> sparse.csr_matrix:
        """With the rows and columns of the other functions."""
        count = self.extra_count
        if not count:
            return own
        columns = np.zeros((own.shape[0] + count, count))
        rows = np.zeros((count, own.shape[0] + count))
        for where, form in forms():
            columns += self.loads(where, applied_form(form, self.extras), count).T
            if not symmetric:
                rows += self.loads(where, applied_form(form, self.extras, transposed=True), count)
        if symmetric:
            rows = columns.T
        n = own.shape[0]
        blocks = [
            [own, sparse.csr_matrix(columns[:n])],
            [sparse.csr_matrix(rows[:, :n]), sparse.csr_matrix(columns[n:])],
        ]
        return sparse.bmat(blocks, format="csr")


def at_values(weights: Floats, kinds: int) -> Callable[[slice, Floats], Floats]:
    """The form weights*u*v."""

    def form(some: slice, points: Floats) -> Floats:
        found = np.zeros((len(points), kinds, kinds))
        found[:, 0, 0] = weights[some]
        return found

    return form


def single_load(weights: Floats, kinds: int) -> Callable[[slice, Floats], Floats]:
    """The load weights*v."""

    def load(some: slice, points: Floats) -> Floats:
        found = np.zeros((len(points), kinds, 1))
        found[:, 0, 0] = weights[some]
        return found

    return load


def applied_form(form: Any, given: Jets, *, transposed: bool = False) -> Callable[[slice, Floats], Floats]:
    """The load that a form makes of given functions, whose derivatives are (kinds, functions, n)."""

    def load(some: slice, points: Floats) -> Floats:
        values = form(some, points)
        if transposed:
            values = values.transpose(0, 2, 1)
        functions = np.ascontiguousarray(given(points))
        found = np.empty((*values.shape[:2], functions.shape[1]))
        apply_forms(np.ascontiguousarray(values), functions, found)
        return found

    return load
