"""Images of leaves over many boxes at once, in float64 with outward rounding: values and derivatives.

A leaf is analytic on a box where each of its conditions holds, which are read off its operations: a root's radicand
is positive, a denominator is not zero, and so on. They are those of `generators`, for a whole level of boxes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations_with_replacement, product
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.bounds.interval_arithmetic import neighbours
from rsym.bounds.intervals import IntervalFunction
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.operations import OPERATIONS, POWERS
from rsym.program.program import Node, assemble, live
from rsym.program.row import SELF, SWITCH
from rsym.verify.boxes.domains import switch_of
from rsym.verify.boxes.generators import analytic_clauses
from rsym.verify.boxes.local import Interval, Model
from rsym.verify.cover.centred import Centred
from rsym.verify.cover.formation import Formation

Boxes: TypeAlias = Floats  # (n, k, 2): three sides in space, then those of the letters that range
Ends: TypeAlias = tuple[Floats, Floats]
NARROW = 2.0**-40  # of the range of a letter: narrower ones are not divided
SMALL = 25  # operations: to compile fewer takes longer than NumPy needs for a hundred thousand boxes
# Operations of what is asked of a few boxes, beyond which compiling takes longest: of the third derivatives of a tube
# about a helix 52 s, with NumPy 1.5 s.
RARE = 500


class Condition(NamedTuple):
    """A node that must not be zero, or must be positive; where it is, the operation is analytic.

    Where it is not known to be, the operation is still of class C^j for all whole j below `order`.
    """

    node: int
    positive: bool = False
    order: float = 0.0


def conditions(builder: Builder, number: int) -> list[tuple[Condition, ...]] | None:
    """For each operation that is not entire, tests of which one must hold for a node to be analytic; None if unknown.

    Examples
    --------
    >>> builder = Builder(("x", "y", "z"), ())
    >>> x, y = builder.input("x"), builder.input("y")
    >>> conditions(builder, builder.sqrt(builder.add(x, y)))
    [(Condition(node=2, positive=True, order=0.0),)]
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
    clauses = analytic_clauses(builder, part)
    if clauses is None or not is_legal(builder, part, analytic=True):
        return None
    return [tuple(_condition(builder, part, *test) for test in clause) for clause in clauses]


def _condition(builder: Builder, part: int, kind: str, place: int) -> Condition:
    operation, arguments, _ = builder.nodes[part]
    node = part if place == SELF else switch_of(builder, part) if place == SWITCH else arguments[place]
    exponent = builder.value(arguments[1]) if operation in POWERS else None
    order = 0.0 if exponent is None else max(0.0, float(exponent))
    return Condition(node, kind == "positive", order)


def _is_root(builder: Builder, node: Node) -> bool:
    """Whether an operation has no value where its first argument is negative."""
    exponent = builder.value(node.arguments[1]) if node.operation == "pow" else None
    return node.operation in {"sqrt", "log"} or (exponent is not None and exponent.denominator > 1)


def is_legal(builder: Builder, part: int, *, analytic: bool = False) -> bool:
    """Whether the parameter of an operation is a number in its range, or in that where the operation is analytic."""
    operation, arguments, _ = builder.nodes[part]
    row = OPERATIONS[operation]
    legal = row.analytic_parameter if analytic and row.analytic_parameter is not None else row.parameter
    if legal is None:
        return True
    value = builder.value(arguments[-1])
    return value is not None and legal.holds(value)


class Images:
    """What float64 intervals say of the leaves of a formation, and of other nodes, over boxes."""

    def __init__(self, model: Model, formed: Formation, letters: Mapping[str, Interval]) -> None:
        self.model, self.formed, self.letters = model, formed, letters
        self._slopes: dict[int, _Slopes] = {}
        self._single: dict[int, IntervalFunction] = {}
        self._signs: dict[tuple[int, ...], IntervalFunction] = {}
        self._bends: dict[int, IntervalFunction] = {}
        self._rates: dict[int, IntervalFunction] = {}

    @cached_property
    def _values(self) -> IntervalFunction:
        nodes = {f"leaf {k}": node for k, node in enumerate(self.formed.leaves)}
        nodes |= {f"test {k}": node for k, node in enumerate(self.formed.tests)}
        return self._function({**nodes, "whole": self.model.root}, sharpened=tuple(nodes))

    @cached_property
    def _ends(self) -> Mapping[str, tuple[float, float]]:
        return {name: (neighbours(low)[0], neighbours(high)[1]) for name, (low, high) in self.letters.items()}

    @cached_property
    def ranges(self) -> Floats:
        """The ends (m, 2) of the letters that range, rounded outward."""
        return np.array([self._ends[name] for name in self.model.axes[3:]], np.float64).reshape(-1, 2)

    def _function(
        self, outputs: Mapping[str, int], *, sharpened: Sequence[str] = (), strict: bool = True, rare: bool = False
    ) -> IntervalFunction:
        builder = self.model.builder
        program = assemble(builder.nodes, builder.coordinates, builder.letters, outputs).varying(self.model.axes[3:])
        numbers = dict(program.outputs)
        backend = "numpy" if len(program) <= SMALL or (rare and len(program) > RARE) else None
        nodes = tuple(numbers[name] for name in sharpened)
        return IntervalFunction(program, backend, sharpened=nodes, strict=strict)

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

    @cached_property
    def _where_defined(self) -> IntervalFunction:
        """Omega where it is defined, and the arguments that must not be negative for it to be."""
        builder = self.model.builder
        operations = [builder.nodes[part] for part in live(builder.nodes, [self.model.root])]
        chosen = any(node.operation == "select" for node in operations)  # a branch that is not taken may be undefined
        roots = [node.arguments[0] for node in operations if not chosen and _is_root(builder, node)]
        outputs = {"whole": self.model.root} | {f"root {k}": node for k, node in enumerate(dict.fromkeys(roots))}
        return self._function(outputs, strict=False)

    def is_empty(self, boxes: Boxes) -> Flags:
        """Where omega certainly is zero at no point of a box at which it is defined, or is defined at none."""
        found = dict(self._on(self._where_defined, boxes))
        low, high = found.pop("whole")
        empty: Flags = np.logical_or.reduce([(low > 0) | (high < 0), *(top < 0 for _, top in found.values())])
        return empty

    def influence(self, boxes: Boxes) -> Floats:
        """How much more each letter that ranges changes a leaf that is alive than the coordinates do, (n, m)."""
        result = np.zeros((len(boxes), len(self.ranges)))
        for leaf, own in zip(self.formed.leaves, self.alive(boxes)[0], strict=True):
            result = np.maximum(result, np.where(own[:, None], self.influence_on(leaf, boxes), 0.0))
        return result

    def influence_on(self, node: int, boxes: Boxes) -> Floats:
        """How much more each letter that ranges changes a node over boxes than the coordinates do, (n, m).

        Over a box of the width h_i along side i a function f changes by at most |df/di| h_i; at a kink, where there is
        no bound, by what the other sides tell. A range too narrow to be divided counts for nothing.
        """
        axes = self.model.axes
        if node not in self._rates:
            rates = {axis: derivative(self.model.builder, node, axis) for axis in axes}
            self._rates[node] = self._function(rates, strict=False)
        found, width = self._on(self._rates[node], boxes), (boxes[..., 1] - boxes[..., 0]).T
        with np.errstate(all="ignore"):
            rates = np.abs([found[axis] for axis in axes]).max(axis=1)
            bounded = np.where(np.isfinite(rates), rates, 0.0).max(axis=0)
            changes = np.minimum(rates, np.where(bounded > 0, bounded, 1.0)) * width
            ratio = (changes[3:] / changes[:3].max(axis=0)).T
        wide = boxes[:, 3:, 1] - boxes[:, 3:, 0] > NARROW * (self.ranges[:, 1] - self.ranges[:, 0])
        return np.where(wide, np.nan_to_num(ratio), 0.0)

    def sign(self, boxes: Boxes) -> NDArray[np.int8]:
        """The sign of omega on boxes, 0 where it is not known."""
        low, high = self._on(self._values, boxes)["whole"]
        return (low > 0).astype(np.int8) - (high < 0).astype(np.int8)

    def _on(self, function: IntervalFunction, boxes: Boxes) -> Mapping[str, Ends]:
        """The bounds of outputs over boxes; where these have sides in space only, letters have their whole ranges."""
        sides = [*boxes[..., 0].T], [*boxes[..., 1].T]
        if boxes.shape[1] == 3:
            for end, column in enumerate(sides):
                column += [np.full(len(boxes), value) for value in self.ranges[:, end]]
        letters = {name: self._ends[name] for name in function.program.letters}
        with np.errstate(all="ignore"):
            return function(*sides, letters)

    def value(self, node: int, boxes: Boxes) -> Ends:
        """The value (n,) of a node over boxes."""
        operation, arguments, _ = self.model.builder.nodes[node]
        if operation == "neg":
            low, high = self.value(arguments[0], boxes)
            return -high, -low
        if node not in self._single:
            self._single[node] = self._function({"value": node}, sharpened=("value",))
        return self._on(self._single[node], boxes)["value"]

    def signs(self, nodes: Sequence[int], boxes: Boxes) -> NDArray[np.int8]:
        """The signs of nodes all over boxes, (nodes, n); 0 where they are not known or a node may be undefined."""
        numbers = {f"node {node}": node for node in nodes}
        if (*nodes,) not in self._signs:
            self._signs[*nodes,] = self._function(numbers)
        found = self._on(self._signs[*nodes,], boxes)
        low, high = (np.array([found[name][end] for name in numbers]) for end in (0, 1))
        return (low > 0).astype(np.int8) - (high < 0).astype(np.int8)

    def slopes(self, node: int, boxes: Boxes) -> tuple[Floats, Floats, Floats]:
        """The gradient of a node over boxes, (3, n) lower and upper, and its order (n,).

        The node is of class C^j on a box for all whole j below the order: infinite where it is certainly analytic,
        and 5/2 where nothing else is known than that it is made of analytic operations and of |u|**(5/2). Sums,
        products and compositions of functions of class C^j are of class C^j.
        """
        _, (low, high), order = self._first(node, boxes)
        return low, high, order

    def first(self, node: int, boxes: Boxes) -> tuple[Ends, Ends, Flags]:
        """The value (n,) and the gradient (3, n) of a node over boxes, and where it is certainly analytic."""
        value, slopes, order = self._first(node, boxes)
        return value, slopes, np.isinf(order)

    def _first(self, node: int, boxes: Boxes) -> tuple[Ends, Ends, Floats]:
        if node not in self._slopes:
            self._slopes[node] = self._made(node)
        made = self._slopes[node]
        found = self._on(made.function, boxes)
        order = np.full(len(boxes), 0.0 if made.tests is None else np.inf)
        for tests in made.tests or ():
            best = np.zeros(len(boxes))
            for test in tests:
                low, high = found[f"node {test.node}"]
                holds = (low > 0) if test.positive else (low > 0) | (high < 0)
                best = np.maximum(best, np.where(holds, np.inf, test.order))
            order = np.minimum(order, best)
        low, high = (np.array([found[f"slope {k}"][end] for k in range(3)]) for end in (0, 1))
        return found["value"], (low, high), order

    def _made(self, node: int) -> _Slopes:
        tests = conditions(self.model.builder, node)
        outputs = {f"slope {k}": slope for k, slope in enumerate(self.model.gradient(node))}
        outputs |= {"value": node} | {f"node {test.node}": test.node for either in tests or () for test in either}
        return _Slopes(self._function(outputs, sharpened=[name for name in outputs if name.startswith("slope")]), tests)

    def bends(self, node: int, boxes: Boxes) -> tuple[Centred, Centred]:
        """The second (3, 3, n) and third (3, 3, 3, n) derivatives of a node over boxes."""
        if node not in self._bends:
            self._bends[node] = self._function(self._higher(node), rare=True)
        found = self._on(self._bends[node], boxes)
        tensors = []
        for order in (2, 3):
            places = list(combinations_with_replacement(range(3), order))
            low, high = (np.array([found[str(place)][end] for place in places]) for end in (0, 1))
            index = [places.index((*sorted(place),)) for place in product(range(3), repeat=order)]
            tensors.append(Centred.between(low, high)[np.array(index).reshape([3] * order)])
        return tensors[0], tensors[1]

    def _higher(self, node: int) -> dict[str, int]:
        """The second and third derivatives by the coordinates along which they are taken."""
        b, names = self.model.builder, self.model.builder.coordinates
        made: dict[tuple[int, ...], int] = {(k,): slope for k, slope in enumerate(self.model.gradient(node))}
        for order in (2, 3):
            for places in combinations_with_replacement(range(3), order):
                made[places] = derivative(b, made[places[:-1]], names[places[-1]])
        return {str(places): number for places, number in made.items() if len(places) > 1}


class _Slopes(NamedTuple):
    function: IntervalFunction
    tests: list[tuple[Condition, ...]] | None
