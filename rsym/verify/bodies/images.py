"""Images of leaves over many boxes at once, in float64 with outward rounding: values, gradients, shape operators.

A leaf is analytic on a box where each of its conditions holds, which are read off its operations: a root's radicand
is positive, a denominator is not zero, and so on. They are those of `generators`, for a whole level of boxes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.builder import Builder
from rsym.codegen.fields import Calculus
from rsym.codegen.intervals import IntervalFunction, Range
from rsym.codegen.program import assemble, live
from rsym.verify.bodies.formation import Formation
from rsym.verify.domains import switch_of
from rsym.verify.generators import ENTIRE, JOINT, NORMS
from rsym.verify.local import Interval, Model

Array: TypeAlias = NDArray[np.float64]
Boxes: TypeAlias = NDArray[np.float64]  # (n, 3, 2)
Ends: TypeAlias = tuple[Array, Array]
Flags: TypeAlias = NDArray[np.bool_]

SIDE = "side of the frame"  # an input; no letter of a user has a space in its name
OPERATOR = ("uu", "uv", "vv")
LARGEST = 2_000  # operations of a shape operator whose images are sharpened, which multiplies them by ten


class Condition(NamedTuple):
    """A node that must not be zero, or must be positive."""

    node: int
    positive: bool = False


def conditions(builder: Builder, number: int) -> list[tuple[Condition, ...]] | None:
    """For each operation that is not entire, tests of which one must hold for a node to be analytic; None if unknown.

    Examples
    --------
    >>> builder = Builder(("x", "y", "z"), ())
    >>> x, y = builder.input("x"), builder.input("y")
    >>> conditions(builder, builder.sqrt(builder.add(x, y)))
    [(Condition(node=2, positive=True),)]
    >>> conditions(builder, builder.mul(x, y))
    []
    """
    found: list[tuple[Condition, ...]] = []
    for part in live(builder.nodes, [number]):
        tests = _tests(builder, part)
        if tests is None:
            return None
        found.extend(tests)
    return list(dict.fromkeys(found))


def _tests(builder: Builder, part: int) -> list[tuple[Condition, ...]] | None:
    operation, arguments, _ = builder.nodes[part]
    if operation in ENTIRE:
        return []
    if operation in {"abs", "sign", "min", "max", "select"}:
        return [(Condition(switch_of(builder, part)),)]
    if operation == "div":
        return [(Condition(arguments[1]),)]
    if operation in {"sqrt", "log", "pow"}:
        return [(Condition(arguments[0], True),)]
    if operation in {"absolute_power", "signed_power"}:
        return [(Condition(arguments[0]),)]
    if operation == "trimming":
        return [(Condition(part, True),)]
    if operation in {"normalised", "atan2"}:
        return [(Condition(arguments[0]), Condition(arguments[1], True))]
    if operation in JOINT or operation == "monomial" or operation in {"r_alpha_conjunction", "r_alpha_disjunction"}:
        either = (Condition(arguments[0]), Condition(arguments[1]))
        return [either] if _is_legal(builder, part) else None
    if operation in NORMS and _is_legal(builder, part):
        order = builder.value(arguments[2])
        even = order is not None and order.denominator == 1 and order % 2 == 0
        if even and operation not in {"joining", "rp_versine"}:
            return [(Condition(arguments[0]), Condition(arguments[1]))]
        return [(Condition(arguments[0]),), (Condition(arguments[1]),)]
    return None


def _is_legal(builder: Builder, part: int) -> bool:
    """Whether the parameter of an R-operation is a number in its range."""
    operation, arguments, _ = builder.nodes[part]
    if len(arguments) == 2:
        return True
    value = builder.value(arguments[2])
    if value is None:
        return False
    if operation.startswith("r_alpha"):
        return -1 < value < 1
    return value > 1 if operation.startswith("rp") else value >= 1


class Images:
    """What float64 intervals say of the leaves of a formation, and of other nodes, over boxes."""

    def __init__(self, model: Model, formed: Formation, letters: Mapping[str, Interval]) -> None:
        self.model, self.formed, self.letters = model, formed, letters
        self._slopes: dict[int, _Slopes] = {}
        self._bending: dict[int, _Bent] = {}

    @cached_property
    def _values(self) -> IntervalFunction:
        nodes = {f"leaf {k}": node for k, node in enumerate(self.formed.leaves)}
        nodes |= {f"test {k}": node for k, node in enumerate(self.formed.tests)}
        return self._function({**nodes, "whole": self.model.root}, sharpened=tuple(nodes))

    def _function(
        self, outputs: Mapping[str, int], *, more: tuple[str, ...] = (), sharpened: Sequence[str] = ()
    ) -> IntervalFunction:
        builder = self.model.builder
        program = assemble(builder.nodes, builder.coordinates, (*builder.letters, *more), outputs)
        numbers = dict(program.outputs)
        return IntervalFunction(program, sharpened=tuple(numbers[name] for name in sharpened), strict=True)

    def alive(self, boxes: Boxes) -> tuple[Flags, NDArray[np.int8], Flags, NDArray[np.int8]]:
        """The leaves alive on boxes, what joins them, where omega is certainly defined all over the box, and signs.

        The signs are those of leaves and tests, 0 where they are not known.
        """
        found = self._on(self._values, boxes)
        leaves = [found[f"leaf {k}"] for k in range(len(self.formed.leaves))]
        tests = [found[f"test {k}"] for k in range(len(self.formed.tests))]
        low, high = (np.array([bounds[end] for bounds in (*leaves, *tests)]) for end in (0, 1))
        count = len(leaves)
        alive, joined = self.formed.alive(low[:count], high[:count], (low[count:], high[count:]))
        signs = (low > 0).astype(np.int8) - (high < 0).astype(np.int8)
        whole = found["whole"]
        return alive, joined, np.isfinite(whole[0]) & np.isfinite(whole[1]), signs

    def sign(self, boxes: Boxes) -> NDArray[np.int8]:
        """The sign of omega on boxes, 0 where it is not known."""
        low, high = self._on(self._values, boxes)["whole"]
        return (low > 0).astype(np.int8) - (high < 0).astype(np.int8)

    def _on(
        self, function: IntervalFunction, boxes: Boxes, side: float | None = None, more: Sequence[Array] = ()
    ) -> Mapping[str, Ends]:
        letters: Mapping[str, Range] = self.letters if side is None else {**self.letters, SIDE: side}
        with np.errstate(all="ignore"):
            return function([*boxes[..., 0].T, *more], [*boxes[..., 1].T, *more], letters)

    def slopes(self, node: int, boxes: Boxes) -> tuple[Array, Array, Flags]:
        """The gradient of a node over boxes, (3, n) lower and upper, and where the node is certainly analytic."""
        if node not in self._slopes:
            self._slopes[node] = self._made(node)
        made = self._slopes[node]
        found = self._on(made.function, boxes)
        analytic = np.full(len(boxes), made.tests is not None)
        for tests in made.tests or ():
            holds = np.zeros(len(boxes), bool)
            for test in tests:
                low, high = found[f"node {test.node}"]
                holds |= (low > 0) if test.positive else (low > 0) | (high < 0)
            analytic &= holds
        low, high = (np.array([found[f"slope {k}"][end] for k in range(3)]) for end in (0, 1))
        return low, high, analytic

    def _made(self, node: int) -> _Slopes:
        tests = conditions(self.model.builder, node)
        outputs = {f"slope {k}": slope for k, slope in enumerate(self.model.gradient(node))}
        outputs |= {f"node {test.node}": test.node for either in tests or () for test in either}
        return _Slopes(self._function(outputs, sharpened=[name for name in outputs if name.startswith("slope")]), tests)

    def curvatures(self, node: int, boxes: Boxes) -> tuple[Ends, Ends]:
        """Bounds (low, high) of the principal curvatures of the zero set of a node in boxes, and of its value.

        On f = 0 the shape operator is what it is plus any multiple of f: the multiple that cancels its slope along
        the normal in the middle of a box leaves an image too wide by the square of the width only.
        """
        if node not in self._bending:
            self._bending[node] = self._bent(node)
        bent = self._bending[node]
        low, high, _ = self.slopes(node, boxes)
        upper = low[2] + high[2] >= 0
        found = np.empty((4, 2, len(boxes)))
        for own, side in ((upper, 1.0), (~upper, -1.0)):
            leans = bent.leans(self._on(bent.slopes, _middles(boxes[own]), side))
            bounds = self._on(bent.operator, boxes[own], side, leans)
            found[..., own] = [bounds[name] for name in (*OPERATOR, "value")]
        (al, ah), (sl, sh), (cl, ch), (value, top) = found
        shear = np.maximum(np.abs(sl), np.abs(sh))
        return (_eigenvalue(al, cl, shear, -1), _eigenvalue(ah, ch, shear, 1)), (value, top)

    def _bent(self, node: int) -> _Bent:
        b = self.model.builder
        operator = Calculus(b, node).curvatures.operator(b.input(SIDE))
        sharp = len(live(b.nodes, operator)) < LARGEST
        slopes = {f"value {k}": value for k, value in enumerate(self.model.gradient(node))}
        outputs, leans = {"value": node}, []
        for part, entry in zip(OPERATOR, operator, strict=True):
            if sharp:
                leans.append(f"lean {part}")
                slopes |= {f"{part} {k}": value for k, value in enumerate(self.model.gradient(entry))}
                entry = b.add(entry, b.mul(b.input(leans[-1]), node))
            outputs[part] = entry
        program = self._function(outputs, more=(SIDE, *leans), sharpened=tuple(outputs) if sharp else ("value",))
        varying = replace(program, program=program.program.varying(leans))
        return _Bent(varying, self._function(slopes, more=(SIDE,)), len(leans))


class _Bent(NamedTuple):
    """The shape operator of a node over boxes, its slopes at points, and how many of its entries lean on the node."""

    operator: IntervalFunction
    slopes: IntervalFunction
    entries: int

    def leans(self, slopes: Mapping[str, Ends]) -> list[Array]:
        """The multiples of the node that cancel the slopes of the entries along its gradient; 0 where there is none."""
        middle = {name: (low + high) / 2 for name, (low, high) in slopes.items()}
        normal = [middle[f"value {k}"] for k in range(3)]
        result = []
        with np.errstate(all="ignore"):
            for part in OPERATOR[: self.entries]:
                product = sum(middle[f"{part} {k}"] * normal[k] for k in range(3))
                lean = -product / sum(np.square(component) for component in normal)
                result.append(np.where(np.isfinite(lean), lean, 0.0))
        return result


class _Slopes(NamedTuple):
    function: IntervalFunction
    tests: list[tuple[Condition, ...]] | None


def _middles(boxes: Boxes) -> Boxes:
    middle = boxes.mean(axis=-1)
    return np.stack([middle, middle], axis=-1)


def _eigenvalue(a: Array, c: Array, shear: Array, sign: int) -> Array:
    """The larger (sign 1) or smaller (-1) eigenvalue of [[a, s], [s, c]], rounded that way.

    x*x*a + y*y*c + 2*x*y*s on unit vectors is at most what the upper ends of a, c, |s| give, and at least what the
    lower ends of a, c and the upper of |s| give. Each of the five operations errs by half a unit of the largest.
    """
    with np.errstate(all="ignore"):
        value = 0.5 * (a + c) + sign * np.hypot(0.5 * (a - c), shear)
        error = 2.0**-49 * (np.abs(a) + np.abs(c) + shear)
    result: Array = np.where(np.isnan(value), sign * np.inf, value + sign * error)
    return result
