"""The equilibrium of an elastic body as a linear system on weighted splines, and the forces in it.

The displacement along coordinate i is u_i = g_i + omega_i*phi_i: a function with the values given, a weight that
vanishes where they are, a spline. For all displacements v that vanish there the work of the stresses is that of loads,

    integral of sigma(u) : grad v = integral of f . v + integral along the boundary of t . v,
    sigma_ik = lambda*delta_ik*div u + mu*(d_k u_i + d_i u_k).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy import sparse

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.wording import listing
from rsym.problems.conditions import Name
from rsym.problems.elastic.bodies import ElasticBody
from rsym.problems.galerkin import Discretisation
from rsym.problems.systems.borders import BesideAt, SystemBorder
from rsym.problems.systems.families import Family, with_families
from rsym.problems.systems.forms import CellPoints, LoadAt, Some, extended
from rsym.sampling.rules.quadrature import Quadrature

AXES = range(2)
# Of the square of a rigid motion, a share: rounding leaves 1e-16, a part of a thousandth of the length 1e-10.
FREE = 1e-13


class Forces(NamedTuple):
    """A force (f_x, f_y) and its moment about the origin, positive against the clock.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> wall = rsym.half_plane((1, 0), 0).named("wall")
    >>> beam = rsym.rectangle(4, 1) & wall
    >>> held = rsym.elasticity(beam, {"wall": rsym.fixed()}, young=1, poisson=0.3, loads=(0, -1), cells=8)
    >>> [round(float(one), 9) + 0.0 for one in held.reactions["wall"].force]
    [0.0, 2.0]
    """

    force: tuple[float, float]
    moment: float


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A body on a rule of integration, by splines of a degree."""

    body: ElasticBody
    rule: Quadrature
    degree: int
    threads: int | None = None

    @cached_property
    def discrete(self) -> tuple[Discretisation, ...]:
        """Of both displacements, by the same splines."""
        alone = self.body.without_corners.problems
        return tuple(Discretisation(one, self.rule, self.degree, self.threads) for one in alone)

    @cached_property
    def moduli(self) -> tuple[Floats, Floats]:
        """Lame's numbers at the points inside, times the weights of the rule."""
        first, shear = self.body.moduli(self.rule.points)
        return self.rule.weights * first, self.rule.weights * shear

    @cached_property
    def loaded(self) -> tuple[tuple[CellPoints, Floats], ...]:
        """Of each leaf with a force on it the points, and the force (2, n) times the weights of the rule."""
        boundary, found = self.rule.boundary, []
        for leaf in range(len(self.body.names)):
            on = boundary.leaves == leaf
            points = np.ascontiguousarray(boundary.points[on])
            force = self.body.traction(leaf, points, boundary.normals[on])
            if force is not None and force.any():
                found.append((CellPoints(points, boundary.cells[on]), boundary.weights[on] * force))
        return tuple(found)

    # -- the system ------------------------------------------------------------------------------------------------

    @cached_property
    def _functions(self) -> BesideAt:
        return self.body.beside_at(self.rule.points)

    @property
    def extra_count(self) -> int:
        """How many functions there are beside the splines."""
        return 0 if self.body.corners is None else len(self.body.corners.functions)

    def _border(self, where: CellPoints) -> SystemBorder:
        one = self.discrete[0]
        functions = self._functions if where is one.inside else self.body.beside_at(where.points)
        return SystemBorder(one.assembler, [own.tests for own in self.discrete], where, functions, self.extra_count)

    def form(self, some: Some, points: Floats) -> Floats:
        """Of the stresses, (n, 6, 6), on the derivatives of both displacements: of those tested, then those acting."""
        first, shear = self.moduli[0][some], self.moduli[1][some]
        found = np.zeros((len(points), 2, 3, 2, 3))
        for i in AXES:
            for j in AXES:
                # sigma_ik(e_j w) d_k v: lambda d_j w d_i v + mu (delta_ij d_k w + delta_jk d_i w) d_k v.
                found[:, i, 1 + i, j, 1 + j] += first
                found[:, i, 1 + j, j, 1 + i] += shear
                if i == j:
                    for k in AXES:
                        found[:, i, 1 + k, j, 1 + k] += shear
        return found.reshape(-1, 6, 6)

    @cached_property
    def matrix(self) -> sparse.csr_matrix:
        """Of the inner splines along x, then of those along y, then of the functions beside them."""
        blocks: list[list[sparse.csr_matrix | None]] = [[None, None], [None, None]]
        for i, j in ((0, 0), (1, 1), (0, 1)):
            rows, columns = (slice(3 * k, 3 * k + 3) for k in (i, j))

            def form(some: Some, points: Floats, rows: slice = rows, columns: slice = columns) -> Floats:
                return self.form(some, points)[:, rows, columns]

            one, other = self.discrete[i], self.discrete[j]
            own = one.assembler.matrix(one.inside, form, one.tests, other.tests, symmetric=i == j)
            blocks[i][j] = extended(one.splines, own)
        blocks[1][0] = blocks[0][1].T  # type: ignore[union-attr]
        own = self._with_corners(sparse.bmat(blocks, format="csr"))
        folds = self._folds
        if not folds:
            return own
        border = self._border if self.extra_count else None
        one = self.discrete[0]
        plain = [replace(each.families[0], component=axis) for axis, each in enumerate(self.discrete)]
        return with_families(own, [*plain, *folds], one.assembler, [(one.inside, self.form)], border, True, len(plain))

    @cached_property
    def _folds(self) -> list[Family]:
        """Splines with kinks on interfaces, of one displacement, then of the other."""
        return [replace(one, component=axis) for axis, each in enumerate(self.discrete) for one in each.families[1:]]

    @property
    def beside_count(self) -> int:
        """How many functions there are beside the splines, those of kinks among them."""
        return self.extra_count + sum(one.count for one in self._folds)

    def parted(self, values: Floats) -> tuple[Floats, Floats]:
        """The coefficients (2, families, active) of splines, and those of functions of corners."""
        plain = [each.families[0] for each in self.discrete]
        counts = [*(one.count for one in plain), self.extra_count, *(one.count for one in self._folds)]
        first, second, others, *folds = np.split(values, np.cumsum(counts)[:-1])
        some = [one.sums @ own for one, own in zip([*plain, *self._folds], [first, second, *folds], strict=True)]
        half = (len(some) - len(plain)) // 2
        return np.array([[some[axis], *some[2 + axis * half :][:half]] for axis in AXES]), others

    def _with_corners(self, own: sparse.csr_matrix) -> sparse.csr_matrix:
        """With the rows and columns of functions of corners."""
        if not self.extra_count:
            return own
        columns = self._border(self.discrete[0].inside).columns(self.form, symmetric=True)
        extension = self.discrete[0].splines.extension.T
        active = extension.shape[1]
        across = sparse.vstack([extension @ columns[:active], extension @ columns[active : 2 * active]])
        return sparse.bmat([[own, across], [across.T, columns[2 * active :]]], format="csr")

    @cached_property
    def right(self) -> Floats:
        """The work of loads, without that of the stresses of the displacements that are given."""
        force = self.rule.weights * self.body.load(self.rule.points)
        stress = self.stress(self.lifted(self.rule.points), self.moduli)

        def load(some: Some, points: Floats) -> Floats:
            found = np.concatenate([force[:, None, some], -stress[:, :, some]], axis=1)
            return found.reshape(6, -1).T[:, :, None]

        def pulled(acting: Floats) -> LoadAt:
            def load(some: Some, points: Floats) -> Floats:
                found = np.zeros((len(points), 2, 3, 1))
                found[:, :, 0, 0] = acting[:, some].T
                return found.reshape(-1, 6, 1)

            return load

        every = [(self.discrete[0].inside, load), *((where, pulled(acting)) for where, acting in self.loaded)]
        return np.asarray(np.sum([self._loads(*one) for one in every], axis=0))

    def _loads(self, where: CellPoints, load: LoadAt) -> Floats:
        """Those of a load on both displacements and their derivatives, (n, 6, 1)."""

        def along(axis: int) -> LoadAt:
            return lambda some, points: load(some, points)[:, 3 * axis : 3 * axis + 3]

        parts, folds = [], []
        for axis, one in enumerate(self.discrete):
            plain, fold = np.split(one.loads(where, along(axis))[0], [one.families[0].count])
            parts.append(plain)
            folds.append(fold)
        if self.extra_count:
            parts.append(self._border(where).loads(load, 1)[0])
        return np.concatenate([*parts, *folds])

    def lifted(self, points: Floats) -> Floats:
        """The derivatives (2, 3, n) of the displacements that are given."""
        lifts = [one.lift(1) for one in self.body.problems]
        return np.array([np.zeros((3, len(points))) if lift is None else lift(points) for lift in lifts])

    @cached_property
    def lift_size(self) -> float:
        """The root of the energy of these: if they are the solution what is left of loads is rounding beside it."""
        jets = self.lifted(self.rule.points)
        return float(np.sqrt(np.sum(self.stress(jets, self.moduli) * jets[:, 1:])))

    @staticmethod
    def stress(jets: Floats, moduli: tuple[Floats, Floats]) -> Floats:
        """The stresses (2, 2, n) in the plane of displacements with the derivatives (2, 3, n)."""
        gradient = jets[:, 1:]
        first, shear = moduli
        found = shear * (gradient + gradient.transpose(1, 0, 2))
        spread = first * (gradient[0, 0] + gradient[1, 1])
        for axis in AXES:
            found[axis, axis] += spread
        return found

    # -- what is not held, and what holds ----------------------------------------------------------------------------

    def require_held(self) -> None:
        """Refuse a body that can move without being strained."""
        boundary = self.rule.boundary
        middle = self.rule.weights @ self.rule.points / self.rule.weights.sum()
        size = float(np.max(np.ptp(self.rule.points, axis=0)))
        gram = np.zeros((3, 3))
        for axis, held in enumerate(self.body.held):
            on = np.isin(boundary.leaves, [leaf for leaves in held.values() for leaf in leaves])
            apart = (boundary.points[on] - middle) / size
            # What shifts along x, shifts along y and a turn do along the axis.
            rows = np.zeros((len(apart), 3))
            rows[:, axis] = 1.0
            rows[:, 2] = (-apart[:, 1], apart[:, 0])[axis]
            gram += np.einsum("n,ni,nj->ij", boundary.weights[on] / size, rows, rows)
        sizes, ways = np.linalg.eigh(gram)
        if sizes[0] > FREE:
            return
        free = ways[:, sizes <= FREE]
        names = [f"a shift along {symbol}" for symbol in self.body.shape.coordinates] + ["a turn"]
        motions = [name for name, row in zip(names, free, strict=True) if np.abs(row).max() > np.sqrt(FREE)]
        raise RsymError(
            f"nothing hinders {listing(motions)} of the body",
            code="singular",
            remedy="hold a part by rsym.fixed(), straight ones by rsym.roller(), or give a displacement",
        )

    def reactions(self, jets: Floats) -> dict[Name, Forces]:
        """The forces of the parts that are held, of displacements with the derivatives (2, 3, n) at the points inside.

        That along coordinate i of a part is the work on the displacement e_i*s, s being 1 there and 0 on other parts
        that are held: as exact as the energy, and in balance with the loads.
        """
        found: dict[Name, np.ndarray] = {}
        for axis in AXES:
            for name, share in self.body.shares[axis].items():
                at = found.setdefault(name, np.zeros(3))
                for points, stress, force in self._work(jets):
                    s = share(points)
                    lever, slope = _lever(axis, points)
                    at[axis] += np.sum(stress[axis] * s[1:]) - np.sum(force[axis] * s[0])
                    turned = lever * s[1:]
                    turned[1 - axis] += slope * s[0]
                    at[2] += np.sum(stress[axis] * turned) - np.sum(force[axis] * s[0] * lever)
        return {name: _forces(values) for name, values in found.items()}

    def _work(self, jets: Floats) -> Iterator[tuple[Floats, Floats, Floats]]:
        """Points, stresses and forces on them, times the weights of the rule: inside, then on the boundary."""
        force = self.rule.weights * self.body.load(self.rule.points)
        yield self.rule.points, self.stress(jets, self.moduli), force
        for where, acting in self.loaded:
            yield where.points, np.zeros((2, 2, len(where.points))), acting

    def loads(self) -> Forces:
        """All that acts on the body but for what holds it."""
        total = np.zeros(3)
        acting = [(self.rule.points, self.rule.weights * self.body.load(self.rule.points))]
        for points, force in [*acting, *((where.points, force) for where, force in self.loaded)]:
            for axis in AXES:
                total[axis] += np.sum(force[axis])
                total[2] += np.sum(force[axis] * _lever(axis, points)[0])
        return _forces(total)


def _lever(axis: int, points: Floats) -> tuple[Floats, float]:
    """What a turn does along an axis, and the slope of that along the other one."""
    return (points[:, 0], 1.0) if axis else (-points[:, 1], -1.0)


def _forces(values: Floats) -> Forces:
    x, y, moment = (float(one) for one in values)
    return Forces((x, y), moment)
