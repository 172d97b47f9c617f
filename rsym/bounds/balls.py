"""The ball backend: where the nodes of a program can be, over a whole box of inputs.

A ball contains the value of a node at every point of the box where the node is defined, that is, where its
plain meaning in exact arithmetic is not NaN. No ball (None) says that there is no such point. The images of
operations are exact, so what is lost is only what operands have in common; the most frequent such losses
(squares, u/|u|, f/sqrt(f**2 + g**2)) are recognised.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import TypeAlias

from rsym.bounds import ball_arithmetic, ball_systems
from rsym.bounds.ball_arithmetic import (
    ONE,
    WHOLE,
    ZERO,
    arb,
    ball,
    chosen,
    constant,
    ctx,
    direction,
    either,
    exact,
    hypotenuse,
    root,
    square,
)
from rsym.bounds.ball_systems import gap_share, norm_share, share
from rsym.bounds.relations import relation
from rsym.program.operations import OPERATIONS, PARTIAL
from rsym.program.program import Data, Node, live
from rsym.program.row import Test as Condition

__all__ = ["IMAGES", "BallFunction", "arb", "ball", "ctx", "enclose_nodes", "exact", "hypotenuse", "root", "square"]

Image: TypeAlias = Callable[..., arb | None]


def _given(value: arb) -> arb:
    return value


class BallImages(dict[str, Image]):
    """By operation: balls of the arguments, then the data of the node, if any. What is monotone is left to its row."""

    def __missing__(self, name: str) -> Image:
        return ball_systems.monotone(OPERATIONS[name])


IMAGES = BallImages(
    {
        "const": constant,
        "input": _given,
        "undefined": lambda: None,
        "add": operator.add,
        "mul": ball_arithmetic.product,
        "div": ball_arithmetic.quotient,
        "neg": operator.neg,
        "powi": ball_arithmetic.whole_power,
        "pow": ball_arithmetic.power,
        "sqrt": root,
        "abs": ball_arithmetic.size,
        "sign": ball_arithmetic.sign,
        "min": ball_arithmetic.smaller,
        "max": ball_arithmetic.larger,
        "select": chosen,
        "sin": ball_arithmetic.sine,
        "cos": ball_arithmetic.cosine,
        "exp": ball_arithmetic.exponential,
        "log": ball_arithmetic.logarithm,
        "atan2": ball_arithmetic.angle,
        "versine": ball_systems.versine,
        "r0m_conjunction": ball_systems.r0m_conjunction,
        "r0m_disjunction": ball_systems.r0m_disjunction,
        "r0m_partial": ball_systems.r0m_partial,
        "monomial": ball_systems.monomial,
        "norm": ball_systems.norm,
        "rp_versine": ball_systems.rp_versine,
        "equivalence": ball_systems.equivalence,
        "absolute_power": ball_arithmetic.power_of_size,
        "signed_power": ball_arithmetic.signed_power,
        "normalised": ball_systems.normalised,
        "zero_with": ball_systems.zero_with,
    }
)


# One evaluation: the node, its image and the nodes that the image takes. A plain tuple is taken apart in half the time
# of a named one, which counts in `run`.
Step: TypeAlias = tuple[int, Image, tuple[int, ...]]


def step(nodes: Sequence[Node], number: int) -> Step:
    """How a node is enclosed: by the image of its operation, or by a tighter one of what its operands share."""
    operation, arguments, data = nodes[number]
    if operation == "const":
        return number, partial(constant, data), ()
    if operation == "select":
        return number, *_selection(nodes, arguments)
    if data is not None:
        return number, partial(_with_data, IMAGES[operation], data), arguments
    return number, *(related(nodes, number) or (IMAGES[operation], arguments))


def _with_data(image: Image, data: Data, *operands: arb) -> arb | None:
    return image(*operands, data)


def _selection(nodes: Sequence[Node], arguments: tuple[int, ...]) -> tuple[Image, tuple[int, ...]]:
    """`no` counts too where an operand of the comparison may be undefined: such a comparison is false."""
    tests = doubts(nodes, arguments[:2])
    if not tests:
        return chosen, arguments

    def image(*balls: arb | None) -> arb | None:
        value, operands = chosen(*balls[:4]), iter(balls[4:])
        for test, needed in tests:
            own = [next(operands) for _ in needed]
            if None in own or not test(*own):
                return either(value, balls[3])
        return value

    return image, arguments + tuple(argument for _, needed in tests for argument in needed)


def _of_undefined(image: Image, a: arb | None, b: arb | None) -> arb | None:
    """What an operation makes of an undefined operand: nothing, but a power u**0 or 1**u is 1, and `zero_with` 0."""
    if image is ball_systems.zero_with:
        return ZERO if a is not None and a.contains(ZERO) else None
    if image not in (ball_arithmetic.power, ball_arithmetic.power_of_size):
        return None
    if a is None:
        return ONE if b is not None and b.contains(ZERO) else None
    return ONE if a.contains(ONE) or a.contains(-ONE) else None


def _bounded(value: arb) -> arb:
    return value if value.is_finite() else WHOLE


def run(steps: Iterable[Step], balls: dict[int, arb | None]) -> None:
    """Evaluate the steps in order; NaN and all that is unbounded become the whole line."""
    for number, image, arguments in steps:
        if len(arguments) == 2:
            a, b = balls[arguments[0]], balls[arguments[1]]
            value = _of_undefined(image, a, b) if a is None or b is None else image(a, b)
        elif len(arguments) == 1:
            a = balls[arguments[0]]
            value = None if a is None else image(a)
        else:
            operands = [balls.get(argument) for argument in arguments]
            value = None if len(operands) == 3 and None in operands else image(*operands)
        balls[number] = value if value is None or value.is_finite() else WHOLE


def enclose_nodes(
    nodes: Sequence[Node],
    order: Sequence[int],
    inputs: Mapping[str, arb],
    known: dict[int, arb | None] | None = None,
) -> dict[int, arb | None]:
    """The balls of nodes over a box, by number.

    Parameters
    ----------
    nodes : sequence of Node
        The nodes of a program, or of a builder.
    order : sequence of int
        The nodes to enclose, ascending: arguments before their users.
    inputs : mapping of str to arb
        The box: a ball for every coordinate and letter that these nodes take.
    known : dict, optional
        Balls found before on the same box; they are kept, the new ones are added.

    Returns
    -------
    dict of int to (arb or None)
        None for a node that is undefined all over the box; the whole line where nothing is known.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> builder = Builder(("x",), ())
    >>> x = builder.input("x")
    >>> root = builder.sqrt(builder.sub(builder.const(1), builder.square(x)))
    >>> balls = enclose_nodes(builder.nodes, range(root + 1), {"x": arb(0.0, 0.5)})
    >>> float(balls[root].lower()) > 0.86, balls[root] < 1.0001
    (True, True)
    >>> enclose_nodes(builder.nodes, range(root + 1), {"x": arb(3)})[root] is None
    True
    """
    balls: dict[int, arb | None] = {} if known is None else known
    steps = []
    for number in order:
        if number not in balls:
            if nodes[number].operation == "input":
                balls[number] = _bounded(inputs[str(nodes[number].data)])
            else:
                steps.append(step(nodes, number))
    run(steps, balls)
    return balls


class BallFunction:
    """Some nodes of a program, made ready to be enclosed over many boxes.

    ``function(inputs)`` gives the balls of the outputs in order, None for what is undefined all over the box.
    Constants are enclosed once for every working precision.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.program.fields import program_of
    >>> program = program_of(rsym.Shape(rsym.conjunction(x, y), (x, y)), ("value",))
    >>> function = BallFunction(program.nodes, [number for _, number in program.outputs])
    >>> (value,) = function({"x": arb(4), "y": arb(3.5, 0.5)})
    >>> float(value.mid()) > 1, value.contains(arb(2))
    (True, True)
    """

    def __init__(self, nodes: Sequence[Node], outputs: Iterable[int]) -> None:
        self.outputs = tuple(outputs)
        order = live(nodes, self.outputs)
        self._inputs = [(number, str(nodes[number].data)) for number in order if nodes[number].operation == "input"]
        self._constants = [step(nodes, number) for number in order if nodes[number].operation == "const"]
        self._steps = [step(nodes, number) for number in order if nodes[number].operation not in {"const", "input"}]
        self._known: dict[int, dict[int, arb | None]] = {}

    def __call__(self, inputs: Mapping[str, arb]) -> list[arb | None]:
        """The balls of the outputs over the box."""
        balls = self.balls(inputs)
        return [balls[number] for number in self.outputs]

    def balls(self, inputs: Mapping[str, arb]) -> dict[int, arb | None]:
        """The balls of all nodes that the outputs need, by number."""
        precision = ctx.prec
        if precision not in self._known:
            self._known[precision] = {}
            run(self._constants, self._known[precision])
        balls = self._known[precision].copy()
        for number, name in self._inputs:
            balls[number] = _bounded(inputs[name])
        run(self._steps, balls)
        return balls


Test: TypeAlias = Callable[..., bool]


def holds(condition: Condition, *operands: arb) -> bool:
    """Whether a condition holds all over the balls of the arguments."""
    kind, place = condition
    operand = operands[place]
    if kind == "nonnegative":
        return bool(operand >= ZERO)
    return bool(operand > ZERO) or (kind != "positive" and bool(operand < ZERO))


def is_defined(operation: str, *operands: arb) -> bool:
    """Whether an operation is certainly defined wherever its arguments are. It may be too strict, never too lax."""
    row = OPERATIONS[operation]
    if row.parameter is not None and not row.parameter.holds(operands[-1]):
        return False
    for clause in row.domain:  # asked a million times: without generators
        for condition in clause:
            if holds(condition, *operands):
                break
        else:
            return False
    return True


def doubts(nodes: Sequence[Node], numbers: Sequence[int]) -> list[tuple[Test, tuple[int, ...]]]:
    """The tests, with the nodes they take, that make these nodes defined all over a box."""
    partial_nodes = [nodes[number] for number in live(nodes, numbers) if nodes[number].operation in PARTIAL]
    return [(partial(is_defined, node.operation), node.arguments) for node in partial_nodes]


RELATED: dict[str, Image] = {
    "square": square,
    "direction": direction,
    "share": share,
    "norm_share": norm_share,
    "gap_share": gap_share,
}


def related(nodes: Sequence[Node], number: int) -> tuple[Image, tuple[int, ...]] | None:
    """The image of a product or quotient and the nodes it takes, if its operands are related."""
    found = relation(nodes, number)
    return None if found is None else (RELATED[found[0]], found[1])
