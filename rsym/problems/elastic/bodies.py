"""An elastic body in the plane: its shape, what it is made of, what holds and what loads it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from typing import Any

import numpy as np
import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Dirichlet, Value, dirichlet
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.logic.sign_form import SignForm, shape_form
from rsym.logic.weights import weight
from rsym.model.shape import Shape
from rsym.model.wording import listing
from rsym.problems.conditions import Name, assigned
from rsym.problems.corners.choice import CornerChoice, chosen_waves
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.goursat import EdgeConditions, of_body
from rsym.problems.elastic.supports import Displaced, Fixed, Pressure, Roller, Traction
from rsym.problems.equations import equation_of
from rsym.problems.given_functions import as_formulas
from rsym.problems.interfaces import Interfaces, interfaces_of
from rsym.problems.left_behind import portable
from rsym.problems.like_slopes import of_like_slopes
from rsym.problems.pointwise import PointFormulas, compiled, first_place, require_numbers, with_derivatives
from rsym.problems.problem import Problem, value_at
from rsym.problems.seams.seamless import Seamless
from rsym.problems.shares import jumps_in
from rsym.problems.systems.borders import Beside, BesideAt
from rsym.program.differentiation import derivative

STRESS, STRAIN = "stress", "strain"
Held = Mapping[Name, tuple[int, ...]]


@dataclass(frozen=True, eq=False)
class ElasticBody:
    """A shape with Young's modulus, Poisson's ratio, forces on a volume, and conditions by the names of parts.

    plane : "stress" for a thin plate, "strain" for a long body that cannot become longer.
    seams : the shape as it was typed.
    corners : functions of corners; None if there are to be none.
    """

    shape: Shape
    named: Mapping[Name, BoundaryCondition]
    young: Value
    poisson: Value
    loads: tuple[Value, ...]
    plane: str
    seams: Seamless
    corners: CornerChoice | None = None

    def __getstate__(self) -> dict[str, Any]:
        """What was compiled on the way is made again; functions that no pickle holds stay behind."""
        state = {name: self.__dict__[name] for name in self.__dataclass_fields__}
        words = {
            "named": "the condition",
            "young": "Young's modulus",
            "poisson": "Poisson's ratio",
            "loads": "the load",
        }
        return state | {name: portable(state[name], word) for name, word in words.items()}

    def __deepcopy__(self, memo: Any) -> ElasticBody:
        """Itself: nothing of it changes."""
        return self

    @cached_property
    def form(self) -> SignForm:
        """The sign form of the shape."""
        return shape_form(self.shape)

    @cached_property
    def names(self) -> tuple[Name, ...]:
        """Which of the names with conditions each leaf goes by."""
        return assigned(self.shape, self.named)

    def condition(self, leaf: int) -> BoundaryCondition | None:
        """That on a leaf."""
        return self.named.get(self.names[leaf])

    @cached_property
    def held(self) -> tuple[Held, ...]:
        """Along each coordinate the leaves whose displacement is given, by the names of the parts."""
        found: list[dict[Name, tuple[int, ...]]] = [{} for _ in self.shape.coordinates]
        for leaf, name in enumerate(self.names):
            for axis in self._held_along(leaf):
                found[axis][name] = (*found[axis].get(name, ()), leaf)
        return tuple(found)

    def _held_along(self, leaf: int) -> list[int]:
        condition, axes = self.condition(leaf), range(len(self.shape.coordinates))
        if isinstance(condition, Fixed):
            return list(axes)
        if isinstance(condition, Displaced):
            return [self._axis(name) for name, _ in condition.components]
        if not isinstance(condition, Roller):
            return []
        b = self.form.builder
        across = [axis for axis in axes if derivative(b, self.form.leaves[leaf], b.coordinates[axis]) != b.const(0)]
        if len(across) != 1:
            raise RsymError(
                f"the rollers on {self._called(leaf)} are on a part that is not straight along an axis",
                code="condition",
                remedy="turn the shape so that the part is parallel to an axis, or give a displacement",
            )
        return across

    def _axis(self, name: str) -> int:
        known = [symbol.name for symbol in self.shape.coordinates]
        if name not in known:
            raise RsymError(
                f"a displacement along {name!r} is given, the coordinates are {listing(known)}", code="condition"
            )
        return known.index(name)

    def _called(self, leaf: int) -> str:
        name = self.names[leaf]
        return "the rest" if name is ... else repr(name)

    @cached_property
    def problems(self) -> tuple[Problem, ...]:
        """Of each displacement the problem whose weight and lift are its own; the equation in it is not asked."""
        equation, found = equation_of("-laplacian(u) = 0", self.shape.coordinates), []
        for axis, (held, (given, _)) in enumerate(zip(self.held, self._given, strict=True)):
            if any(condition.value != 0 for condition in given.values()):
                for name, leaves in held.items():
                    self._require_whole(name, leaves, axis)
            kept = {leaf for leaves in held.values() for leaf in leaves}
            on_leaves = [given[name] if leaf in kept else None for leaf, name in enumerate(self.names)]
            own = None if self.corners is None else self.corners.component(axis)
            made = Problem(self.shape, equation, given, tuple(on_leaves), corners=own, seams=self.seams)
            found.append(replace(made, interfaces=self.interfaces))
            for jump in jumps_in(found[-1]):
                place, values = (
                    ", ".join(f"{value:.6g}" for value in some) for some in (jump.corner.point, jump.values)
                )
                raise RsymError(
                    f"displacements along {self.shape.coordinates[axis]} jump at ({place}): {values}",
                    code="contradiction",
                    remedy="give displacements that agree where parts meet",
                )
        return tuple(found)

    @cached_property
    def interfaces(self) -> Interfaces:
        """Where moduli and loads jump or have kinks."""
        return interfaces_of(
            self.shape, [one for one in (self.young, self.poisson, *self.loads) if isinstance(one, sp.Expr)]
        )

    @cached_property
    def without_corners(self) -> ElasticBody:
        """The same body without functions of corners."""
        return self if self.corners is None else replace(self, corners=None)

    def beside_at(self, points: Floats) -> BesideAt:
        """The functions beside splines, both components with first derivatives, at points."""
        near = () if self.corners is None else self.corners.functions.near(points)
        return BesideAt(points, [Beside(first, len(part.terms), on, part.derivatives) for first, part, on in near], 1)

    def _require_whole(self, name: Name, leaves: tuple[int, ...], axis: int) -> None:
        if len(leaves) != self.names.count(name):
            raise RsymError(
                f"of {'the rest' if name is ... else repr(name)} only some sides are held along "
                f"{self.shape.coordinates[axis]}, and other parts are displaced",
                code="condition",
                remedy="name the sides apart",
            )

    @cached_property
    def _given(self) -> tuple[tuple[Mapping[Name, Dirichlet], float], ...]:
        """Along each coordinate the displacements, and how far formulas are off that stand for functions."""
        found = []
        for axis, held in enumerate(self.held):
            own = {name: self._displacement(name, axis) for name in held}
            made, off = as_formulas(self.shape, {**self.named, **own})
            found.append(({name: one for name in held if isinstance(one := made[name], Dirichlet)}, off))
        return tuple(found)

    @property
    def off(self) -> float:
        """How far formulas are off that stand for functions on the boundary, as a share of their largest values."""
        return max(off for _, off in self._given)

    def _displacement(self, name: Name, axis: int) -> Dirichlet:
        condition = self.named[name]
        if isinstance(condition, Displaced):
            return dirichlet({self._axis(one): value for one, value in condition.components}[axis])
        return Dirichlet(sp.S.Zero)

    def _jets(self, node: int) -> PointFormulas:
        b = self.form.builder
        return compiled(self.shape, b, with_derivatives(b, {"": node}, b.coordinates, 1))

    @cached_property
    def shares(self) -> tuple[Mapping[Name, Callable[[Floats], Floats]], ...]:
        """Along each coordinate, of each part that is held, the derivatives of a function that is 1 there, 0 on others.

        (1/w_i)/(sum of 1/w_j), w_i the weights of the parts: they are 1 together.
        """
        b, found, like = self.form.builder, [], of_like_slopes(self.shape, self.form)
        for held in self.held:
            made = {name: weight(self.form, leaves, like) for name, leaves in held.items()}
            weights = {name: node for name, node in made.items() if node is not None}
            others = {
                name: reduce(b.mul, [w for other, w in weights.items() if other != name], b.const(1)) for name in held
            }
            total = reduce(b.add, others.values(), b.const(0))
            found.append({name: self._jets(b.div(node, total)) for name, node in others.items()})
        return tuple(found)

    def moduli(self, points: Floats) -> tuple[Floats, Floats]:
        """Lame's numbers at points, in plane stress with the first such that the stresses in the plane are right."""
        young, poisson = (value_at(self.shape, value, points) for value in (self.young, self.poisson))
        most = 0.5
        wrong = ~(young > 0) | ~(poisson > -1)
        wrong |= ~(poisson < most) if self.plane == STRAIN else ~(poisson <= most)
        if wrong.any():
            k = int(np.argmax(wrong))
            raise RsymError(
                f"at {first_place(points, wrong)} Young's modulus is {young[k]:.6g} "
                f"and Poisson's ratio {poisson[k]:.6g}",
                code="material",
                remedy="young > 0 and -1 < poisson < 0.5",
            )
        shear = young / (2 * (1 + poisson))
        if self.plane == STRAIN:
            return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), shear
        return young * poisson / (1 - poisson**2), shear

    def kolosov(self, points: Floats) -> Floats:
        """Kolosov's number at points; NaN where Poisson's ratio is none."""
        nu = value_at(self.shape, self.poisson, points)
        nu = np.where((nu > -1) & (nu <= 0.5), nu, np.nan)
        return np.asarray(3 - 4 * nu if self.plane == STRAIN else (3 - nu) / (1 + nu))

    def traction(self, leaf: int, points: Floats, normals: Floats) -> Floats | None:
        """The force (2, n) on an area at points of a leaf; None where none is given."""
        force = self.traction_there(leaf, points, normals)
        if force is not None:
            require_numbers(f"the force on {self._called(leaf)}", force.sum(axis=0), points)
        return force

    def traction_there(self, leaf: int, points: Floats, normals: Floats) -> Floats | None:
        """The same, NaN where it is undefined, as polar formulas are at a corner."""
        condition = self.condition(leaf)
        if not isinstance(condition, Pressure | Traction):
            return None
        if isinstance(condition, Pressure):
            return np.asarray(-value_at(self.shape, condition.pressure, points) * normals.T)
        return np.array([value_at(self.shape, value, points) for value in condition.force])

    def load(self, points: Floats) -> Floats:
        """The force (2, n) on a volume."""
        force = np.array([value_at(self.shape, value, points) for value in self.loads])
        require_numbers("the force on a volume", force.sum(axis=0), points)
        return force


def with_corners(body: ElasticBody, degree: int) -> ElasticBody:
    """The same body with functions for the corners of its shape, for splines of a degree."""
    if len(body.form.leaves) < 2:
        return body

    def conditions(corner: PlaneCorner) -> EdgeConditions | None:
        point, pulls = np.array([corner.point]), []
        for leaf, slope in zip(corner.leaves, np.array(corner.gradients), strict=True):
            force = body.traction_there(leaf, point, -slope[None] / np.hypot(*slope))
            pulls.append(0j if force is None else complex(*force[:, 0]))
        kappa = float(body.kolosov(point)[0])
        if not np.isfinite([kappa, *map(abs, pulls)]).all():
            return None
        held = [[any(leaf in own for own in held.values()) for held in body.held] for leaf in corner.leaves]
        made = of_body(corner, held, kappa, pulls)
        # With logarithms functions are not 0 on edges that are held.
        return made if made.fits or not any(map(any, held)) else None

    return replace(body, corners=chosen_waves(body.shape, conditions, degree=degree))
