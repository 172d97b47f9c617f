"""A boundary value problem as data, and the functions that its solution is made of, compiled when they are asked for.

u = g + omega*phi + a*e: a lift g of the values on the boundary, the weight omega, a spline phi, and a few functions e
beside: such as the one that is 1 on a hole at an unknown level, and those of corners.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from threading import RLock
from typing import Any

import numpy as np
import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Supported, UnknownLevel
from rsym.arrays import Floats
from rsym.backends.kernel import Kernel, compile_program
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.logic.sign_form import SignForm, shape_form
from rsym.logic.weights import weight
from rsym.model.equation import Equation
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.problems.conditions import Name, assigned, require_part
from rsym.problems.corners.choice import CornerChoice
from rsym.problems.equations import EllipticEquation
from rsym.problems.interfaces import NO_INTERFACES, Interfaces
from rsym.problems.left_behind import portable
from rsym.problems.lifts import Lift, lift_of, lift_on
from rsym.problems.like_slopes import of_like_slopes
from rsym.problems.parts import Parts, formula
from rsym.problems.pointwise import PointFormulas, at_letters, formulas, values_of, with_derivatives
from rsym.problems.seams.seamless import Seamless
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.switches import EdgeCut, Switches, split_form
from rsym.problems.systems.borders import Beside, BesideAt
from rsym.problems.weak.weak_form import WeakForm, sized
from rsym.program.lowering import lower
from rsym.program.raising import raised
from rsym.sampling.labels import Labeller
from rsym.sampling.rules.quadrature import BoundaryQuadrature
from rsym.sampling.windows import bounds_or_extent

VALUE, FLUX = "value", "flux"
# Where conditions change on an edge weights have roots in them. In a lift they are multiplied by this power of
# r**2/(r**2 + a**2), r the distance from there, a this share of the size of a shape.
SMOOTHLY, ABOUT = 2, 0.25
VALUED = (Dirichlet, UnknownLevel, Clamped, Supported)


@dataclass(frozen=True, eq=False)
class _Lowered:
    """The sign form of a shape, and kernels of what was made of it, which other values of its letters have in common.

    The lock is for the builder of the form, to which nodes are added.
    """

    form: SignForm
    kernels: dict[tuple[tuple[int, ...], int], Kernel]
    lock: AbstractContextManager[Any]

    def kernel(self, shape: Shape, nodes: Callable[[], Mapping[str, int]], order: int) -> Kernel:
        """The derivatives of nodes up to an order."""
        with self.lock:
            b, named = self.form.builder, nodes()
            key = tuple(named.values()), order
            if key not in self.kernels:
                program = b.program(with_derivatives(b, named, b.coordinates, order))
                self.kernels[key] = compile_program(program, (), shape)
            return self.kernels[key]


@recently(16, written)
def _lowered(shape: Shape) -> _Lowered:
    return _Lowered(shape_form(shape), {}, RLock())


@dataclass(frozen=True, eq=False)
class Problem:
    """A shape, an equation, and a condition on each leaf of the shape.

    named : the conditions by the names of parts.
    conditions : in the order of the leaves of `shape_form`; None where nothing is said, so nothing flows.
    axis : the coordinate whose axis the shape is turned about, -1 in the plane and in space.
    levels : the leaves of the parts at unknown levels, one part after the other.
    flows : what flows through each of these parts, outwards.
    corners, interfaces : functions of corners, None if there are to be none; where coefficients jump or have kinks.
    poisson : Poisson's ratio of a plate, where it matters.
    cuts : leaves on which conditions change; what holds outside stands after the conditions of all leaves.
    seams : the shape as it was typed, and leaves that belong to two parts.
    mean : of the solution, where nothing else fixes its level.
    given : the conditions whose values may be functions; formulas stand for these in `named`, `off` by that share.
    """

    shape: Shape
    equation: EllipticEquation | WeakForm
    named: Mapping[Name, BoundaryCondition]
    conditions: tuple[BoundaryCondition | None, ...]
    axis: int = -1
    levels: tuple[tuple[int, ...], ...] = ()
    flows: tuple[float, ...] = ()
    corners: CornerChoice | None = None
    poisson: float | None = None
    cuts: tuple[EdgeCut, ...] = ()
    seams: Seamless | None = None
    mean: float | None = None
    interfaces: Interfaces = NO_INTERFACES
    given: Mapping[Name, BoundaryCondition] | None = None
    off: float = 0.0

    def __getstate__(self) -> dict[str, Any]:
        """What was compiled on the way is made again; functions that no pickle holds stay behind."""
        state = {name: self.__dict__[name] for name in self.__dataclass_fields__}
        equation = replace(self.equation, functions=portable(self.equation.functions, ""))
        held = {name: portable(state[name], "the condition") for name in ("named", "given", "conditions")}
        return state | {"equation": equation} | held

    def __deepcopy__(self, memo: Any) -> Problem:
        """Itself: nothing of it changes."""
        return self

    @property
    def dimension(self) -> int:
        """Of the shape."""
        return len(self.shape.coordinates)

    @cached_property
    def form(self) -> SignForm:
        """The sign form of the shape."""
        return self._lowered.form

    @cached_property
    def _lowered(self) -> _Lowered:
        return _lowered(self.shape)

    @cached_property
    def split(self) -> SignForm:
        """The form with two leaves for each that is cut."""
        with self._lowered.lock:
            return split_form(self.form, self.cuts) if self.cuts else self.form

    @cached_property
    def switches(self) -> Switches:
        """Where conditions change."""
        return Switches(self.shape, self.split, self.cuts, self.conditions)

    @property
    def origins(self) -> tuple[int, ...]:
        """Of each leaf with a condition the number in the form."""
        return (*range(len(self.form.leaves)), *(cut.leaf for cut in self.cuts))

    def leaves(self, *kinds: type[BoundaryCondition]) -> tuple[int, ...]:
        """The leaves with conditions of some kinds."""
        return tuple(k for k, condition in enumerate(self.conditions) if isinstance(condition, kinds))

    @property
    def order(self) -> int:
        """Of the highest derivatives that are integrated."""
        return self.equation.highest

    @cached_property
    def weight_node(self) -> int:
        """What vanishes where u is given, and twice where its slope is too."""
        with self._lowered.lock:
            return self.form.builder.mul(self._vanishing(self.leaves(*VALUED)), self._vanishing(self.leaves(Clamped)))

    @cached_property
    def _like_leaves(self) -> tuple[int, ...]:
        with self._lowered.lock:
            return of_like_slopes(self.shape, self.split)

    def _vanishing(self, leaves: Collection[int]) -> int:
        found = weight(self.split, leaves, self._like_leaves)
        return self.form.builder.const(1) if found is None else found

    def weight(self, order: int) -> PointFormulas:
        """The derivatives of the weight up to an order."""
        return self.with_derivatives("weight", order, lambda: {"": self.weight_node})

    @cached_property
    def lifted(self) -> Lift:
        """A function with the values of u on the boundary."""
        if self.cuts:
            return self._lift_on_leaves()
        names = assigned(self.shape, self.named)
        kept = {name for name, one in zip(names, self.conditions, strict=True) if one is not None}
        return lift_of(self.shape, {name: one for name, one in self.named.items() if name in kept}, self.alike)

    @property
    def alike(self) -> bool:
        """Whether it is one of the plane and of the second order that diffuses alike in all directions."""
        diffusion = self.equation.diffusion
        alike = diffusion[0][0] == diffusion[-1][-1] and not any(
            value for i, row in enumerate(diffusion) for j, value in enumerate(row) if i != j
        )
        return self.dimension == 2 and self.order == 1 and alike

    def _lift_on_leaves(self) -> Lift:
        """That of values on leaves of the split form, where no name tells these apart."""
        own: dict[sp.Expr, list[int]] = {}
        for leaf in self.leaves(Dirichlet, UnknownLevel):
            condition = self.conditions[leaf]
            value = (
                formula(condition.value, self.shape, "the value")[0] if isinstance(condition, Dirichlet) else sp.S.Zero
            )
            own.setdefault(value, []).append(leaf)
        named: dict[Name, list[int]] = {f"where it is {value}": leaves for value, leaves in own.items()}
        box = bounds_or_extent(self.shape, None)
        pairs = [(cut.leaf, len(self.form.leaves) + k) for k, cut in enumerate(self.cuts)]
        about = sp.Float((ABOUT * float(np.diff(box, axis=1).max())) ** 2)
        factors: dict[int, sp.Expr] = {}
        for cut, pair in zip(self.cuts, pairs, strict=True):
            edge = raised(self.form.builder.nodes, self.form.leaves[cut.leaf])
            away = edge**2 + cut.where**2
            factors |= dict.fromkeys(pair, (away / (away + about)) ** SMOOTHLY)
        between = {both: len(self.conditions) + k for k, pair in enumerate(pairs) for both in (pair, pair[::-1])}
        return lift_on(Parts(self.shape, named, self.split, box, between), dict(zip(named, own, strict=True)), factors)

    def lift(self, order: int) -> PointFormulas | None:
        """Its derivatives; None where it is 0."""
        if (function := self.lifted.expression) == 0:
            return None
        return self.with_derivatives("lift", order, lambda: {"": lower(self.form.builder, function)})

    @cached_property
    def extra_nodes(self) -> dict[str, int]:
        """The functions e: W/(W + w) is 1 where the weight w of a hole is 0, and 0 where one of the others is.

        1/W is the sum of 1/w of the others, which do not meet: their product would be so large beside w that e fell
        from 1 to 0 within a thousandth of a cell.
        """
        b, found = self.form.builder, {}
        level = {leaf for hole in self.levels for leaf in hole}
        outer = [leaf for leaf in self.leaves(*VALUED) if leaf not in level]
        with self._lowered.lock:
            holes = [self._vanishing(hole) for hole in self.levels]
            for number, own in enumerate(holes):
                others = [*([self._vanishing(outer)] if outer else []), *holes[:number], *holes[number + 1 :]]
                joint = reduce(lambda f, g: b.div(b.mul(f, g), b.add(f, g)), others) if others else b.const(1)
                found[f"level {number}"] = b.div(joint, b.add(joint, own))
        return found

    @property
    def extra_count(self) -> int:
        """How many functions there are beside the splines: levels, then those of corners."""
        return len(self.levels) + (0 if self.corners is None else len(self.corners.functions))

    @property
    def has_corners(self) -> bool:
        """Whether functions of corners are among them."""
        return self.corners is not None and len(self.corners.functions) > 0

    def extras(self, points: Floats, order: int) -> Floats:
        """Their derivatives (kinds, functions, n)."""
        found = np.zeros((len(derivatives(self.dimension, order)), self.extra_count, len(points)))
        for one in self.beside(points):
            found[:, one.numbers, one.where] = one.derivatives(points[one.where], order).transpose(1, 2, 0)
        return found

    def beside(self, points: Floats) -> tuple[Beside, ...]:
        """The same functions in groups, levels and each corner, where they are not 0."""
        found = []
        if self.levels:
            found.append(Beside(0, len(self.levels), np.arange(len(points)), self._levels_at))
        if self.corners is not None:
            for first, part, near in self.corners.functions.near(points):
                found.append(Beside(len(self.levels) + first, len(part.terms), near, part.derivatives))
        return tuple(found)

    def _levels_at(self, points: Floats, order: int) -> Floats:
        """The derivatives (n, kinds, functions) of the functions e."""
        values = self.with_derivatives("extra", order, lambda: self.extra_nodes)(points)
        return np.ascontiguousarray(values.reshape(len(self.levels), -1, len(points)).transpose(2, 1, 0))

    def leaf_jets(self, points: Floats, order: int) -> Floats:
        """The derivatives (leaves, kinds, n) of all leaves of the form at points."""
        nodes = {f"leaf {number}": node for number, node in enumerate(self.form.leaves)}
        found = self.with_derivatives("every leaf", order, lambda: nodes)(points)
        return found.reshape(len(nodes), -1, len(points))

    def with_derivatives(self, name: str, order: int, nodes: Callable[[], Mapping[str, int]]) -> PointFormulas:
        """What was compiled is kept."""
        if (name, order) not in self._made:
            self._made[name, order] = at_letters(self.shape, self._lowered.kernel(self.shape, nodes, order))
        return self._made[name, order]

    @cached_property
    def _made(self) -> dict[tuple[str, int], PointFormulas]:
        return {}

    @cached_property
    def coefficients(self) -> PointFormulas:
        """The coefficients of the equation, in the order of `EllipticEquation.expressions`."""
        return formulas(self.shape, self.equation.expressions, self.equation.functions)

    def radius(self, points: Floats) -> Floats:
        """What an integral about an axis is weighed by: the distance from it, 2 pi apart; else 1."""
        if self.axis < 0:
            return np.ones(len(points))
        return np.abs(points[:, 1 - self.axis])


def beside_at(problem: Problem, points: Floats, order: int | None = None) -> BesideAt:
    """The functions of a problem beside splines, at points, up to an order: that of what is integrated by default."""
    return BesideAt(points, problem.beside(points), problem.order if order is None else order)


def oriented(problem: Problem, points: Floats) -> Problem:
    """The same problem with the equation times -1 where its leading coefficient is negative at the first of points."""
    leading = problem.equation.leading
    if leading.is_positive or not len(points):
        return problem
    place = list(problem.equation.expressions.values()).index(leading)
    negative = problem.coefficients(points[:1])[place, 0] < 0
    return replace(problem, equation=problem.equation.negated) if negative else problem


def on_cells(problem: Problem, size: float) -> Problem:
    """The same problem where a form speaks of the size of cells."""
    equation = problem.equation
    if isinstance(equation, WeakForm) and equation.sized:
        return replace(problem, equation=sized(equation, size))
    return problem


def value_at(shape: Shape, value: Any, points: Floats) -> Floats:
    """An expression, a shape or a Python function at points."""
    if isinstance(value, Equation):
        value = value.expression
    if isinstance(value, sp.Basic):
        row: Floats = formulas(shape, {VALUE: value})(points)[0]
        return row
    found: Floats = values_of(FLUX, value, list(np.ascontiguousarray(points.T)))
    return found


def on_part(problem: Problem, boundary: BoundaryQuadrature, part: str) -> Any:
    """Which of the points of a rule lie on a part."""
    every = shape_leaf_parts(problem.shape)
    names = [every[leaf] for leaf in problem.origins]
    require_part(part, names, "use one of these")
    found = np.isin(boundary.leaves, [leaf for leaf, one in enumerate(names) if part in one])
    if problem.seams is not None and problem.seams.divided and found.any():
        found[found] = Labeller(problem.seams.typed).nearest(boundary.points[found]).on(part)
    if not found.any():
        raise vanished(part)
    return found


def vanished(part: str) -> RsymError:
    """The error for a part that the boundary has nothing of."""
    return RsymError(
        f"the part {part!r} has nothing of the boundary",
        code="vanished-part",
        remedy="leave it out, or change the letters, the shape or its bounds so that it is there",
    )
