"""Functions of the square of a coordinate: F(x, r) = G(x, r**2) has F_r/r = 2 G', which is analytic at r = 0 too."""

from __future__ import annotations

from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.expansion import SIMPLE
from rsym.program.program import live

SQUARE = "the square of the radius"  # an input that no program keeps


def derivative_in_square(builder: Builder, number: int, name: str) -> int | None:
    """The node 2 dG/d(r**2) of a node that is G(r**2), r the input of this name; None if it is not seen to be."""
    radius, square = builder.input(name), builder.input(SQUARE)
    inner = {radius: None, builder.square(radius): square}
    powers = {
        part: builder.powi(square, node.data // 2)
        for part in live(builder.nodes, [number])
        if (node := builder.nodes[part]).operation == "powi"
        and node.arguments == (radius,)
        and isinstance(node.data, int)
        and node.data % 2 == 0
    }
    outer = substituted(builder, number, {**inner, **powers})
    if outer is None:
        return None
    slope = derivative(builder, outer, SQUARE)
    half = substituted(builder, slope, {square: builder.square(radius)})
    return None if half is None else builder.mul(builder.const(2), half)


def substituted(builder: Builder, number: int, given: dict[int, int | None]) -> int | None:
    """The node with other nodes in the place of some; None where it needs one that is given as None."""
    done: dict[int, int | None] = {}
    for part in live(builder.nodes, [number]):
        if part in given:
            done[part] = given[part]
            continue
        operation, arguments, data = builder.nodes[part]
        inner = [done[argument] for argument in arguments]
        known = [argument for argument in inner if argument is not None]
        if len(known) < len(inner):
            done[part] = None
        else:
            done[part] = part if tuple(known) == arguments else _made(builder, operation, known, data)
    return done[number]


def _made(builder: Builder, operation: str, arguments: list[int], data: object) -> int:
    if operation in SIMPLE:
        return SIMPLE[operation](builder, *arguments)
    if operation == "powi":
        return builder.powi(arguments[0], int(str(data)))
    if operation == "div":
        return builder.div(*arguments)
    return builder.make(operation, *arguments, data=data)  # type: ignore[arg-type]
