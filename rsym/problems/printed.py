"""Solutions for print: the weight times a polynomial, an expression that meets the conditions on values identically."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import sympy as sp
from numpy.polynomial import legendre

from rsym.arrays import Floats
from rsym.problems.galerkin import Discretisation
from rsym.problems.splines.cardinals import derivatives, product_terms
from rsym.problems.systems.forms import CellPoints
from rsym.program.raising import raised


def printed(discrete: Discretisation, degree: int) -> sp.Expr:
    """The solution of Ritz and Galerkin by the weight times polynomials of a total degree, on the rule of a problem."""
    basis = _Polynomials(discrete, degree)
    size = basis.count
    matrix, right = np.zeros((size, size)), np.zeros(size)
    where: list[tuple[CellPoints, Any, Any]] = [(discrete.inside, discrete.equation_form, discrete.load_form)]
    where += [(part.where, part.form_at, part.load_at) for part in discrete.edge_parts]
    lift = discrete.problem.lift(discrete.problem.order)
    for points, form, load in where:
        for chunk in points.chunks():
            here = points.points[chunk.points]
            values, given = basis(here), form(chunk.points, here)
            against = load(chunk.points, here)[:, :, 0]
            if lift is not None:
                against = against - np.einsum("nkl,ln->nk", given, lift(here))
            right += np.einsum("nki,nk->i", values, against)
            tested = np.einsum("nki,nkl->nli", values, given)
            matrix += tested.reshape(-1, size).T @ values.reshape(-1, size)
    scale = 1 / np.sqrt(np.abs(np.diag(matrix)))
    found = scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * right)
    b = discrete.problem.form.builder
    beside = [raised(b.nodes, node) for node in discrete.problem.extra_nodes.values()]
    total = discrete.problem.lifted.expression + raised(b.nodes, discrete.problem.weight_node) * basis.expression(found)
    return sp.Add(total, *(float(a) * one for a, one in zip(found[size - len(beside) :], beside, strict=True)))


class _Polynomials:
    """The weight times products of Legendre polynomials on the box of the grid, then the functions beside."""

    def __init__(self, discrete: Discretisation, degree: int) -> None:
        self._discrete = discrete
        self._dimension = discrete.problem.dimension
        grid = discrete.splines
        self._half = grid.size * np.array(grid.counts) / 2
        self._centre = grid.lower + self._half
        every = product(range(degree + 1), repeat=self._dimension)
        self._powers = [index for index in every if sum(index) <= degree]
        self.count = len(self._powers) + discrete.extra_count

    def __call__(self, points: Floats) -> Floats:
        """The derivatives (n, kinds, functions) at points."""
        order, dimension = self._discrete.problem.order, self._dimension
        top = max(map(max, self._powers))
        table = []
        for axis in range(dimension):
            t = (points[:, axis] - self._centre[axis]) / self._half[axis]
            unit = np.eye(top + 1)
            rows = [[legendre.legval(t, legendre.legder(row, d)) for row in unit] for d in range(order + 1)]
            table.append(np.array(rows) / self._half[axis] ** np.arange(order + 1)[:, None, None])
        kinds = derivatives(dimension, order)
        plain = np.array(
            [
                [
                    np.prod([one[d, k] for one, d, k in zip(table, kind, power, strict=True)], axis=0)
                    for power in self._powers
                ]
                for kind in kinds
            ]
        )
        weight = self._discrete.tests(points)
        found = np.zeros((len(kinds), self.count, len(points)))
        for term in product_terms(dimension, order):
            found[term.whole, : len(self._powers)] += term.times * weight[term.left] * plain[term.right]
        found[:, len(self._powers) :] = self._discrete.extras(points)
        return np.ascontiguousarray(found.transpose(2, 0, 1))

    def expression(self, coefficients: Floats) -> sp.Expr:
        """The polynomial in the coordinates, by powers."""
        symbols = self._discrete.problem.shape.coordinates
        total = np.zeros((max(map(max, self._powers)) + 1,) * self._dimension)
        for power, value in zip(self._powers, coefficients, strict=False):
            part = np.array(value)
            for axis, k in enumerate(power):
                line = np.polynomial.Polynomial([-self._centre[axis] / self._half[axis], 1 / self._half[axis]])
                whole = np.polynomial.Polynomial(legendre.leg2poly(np.eye(k + 1)[k]))(line).coef
                part = np.multiply.outer(part, np.pad(whole, (0, len(total) - len(whole))))
            total += part
        largest = np.max(np.abs(total))
        terms = [
            sp.Float(value, 15) * sp.Mul(*(symbol**k for symbol, k in zip(symbols, index, strict=True)))
            for index, value in np.ndenumerate(total)
            if abs(value) > 1e-15 * largest
        ]
        return sp.Add(*terms)
