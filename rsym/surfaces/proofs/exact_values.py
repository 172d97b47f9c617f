"""Programs evaluated in exact arithmetic: the values of nodes as functions of t, or at one place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm

from rsym.program.program import Data, Node, live
from rsym.surfaces.proofs.algebra import PI, Angle, E, EdgeField, Quotient, T, angle_of


def exact_values(nodes: Sequence[Node], outputs: Sequence[int], at: Fraction | None = None) -> list[Quotient]:
    """The values of some nodes as functions of t, or at one place.

    Raises
    ------
    NoProof
        For what has no place in this arithmetic.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> builder = Builder(("t",), ())
    >>> t = builder.input("t")
    >>> double = builder.make("sin", builder.mul(builder.const(2), t))
    >>> product = builder.mul(builder.const(2), builder.mul(builder.make("sin", t), builder.make("cos", t)))
    >>> [one.is_zero for one in exact_values(builder.nodes, [builder.sub(double, product), double])]
    [True, False]
    """
    field, order = EdgeField(), live(nodes, outputs)
    parameter = field.generator(T) if at is None else field.rational(at)
    angles: list[Angle] = []
    _evaluated(field, nodes, order, parameter, angles)
    field.measures = [_measure([angle[kind] for angle in angles]) for kind in range(4)]
    known = _evaluated(field, nodes, order, parameter, None)
    return [field.cancelled(value) for number in outputs if (value := known[number]) is not None]


def _measure(parts: Sequence[Fraction]) -> Fraction:
    """The greatest common measure of some numbers; 0 of none."""
    used = [abs(one) for one in parts if one]
    if not used:
        return Fraction(0)
    below = lcm(*(one.denominator for one in used))
    return Fraction(gcd(*(int(one * below) for one in used)), below)


def _evaluated(
    field: EdgeField, nodes: Sequence[Node], order: Sequence[int], parameter: Quotient, angles: list[Angle] | None
) -> dict[int, Quotient | None]:
    """All values; with a list for angles only those that need no sines, and the angles are collected."""
    known: dict[int, Quotient | None] = {}
    for number in order:
        operation, arguments, data = nodes[number]
        inner = [known[one] for one in arguments]
        values = [one for one in inner if one is not None]
        if len(values) < len(inner):
            known[number] = None
        elif operation in {"sin", "cos"} and angles is not None:
            angle = angle_of(values[0])
            angles += [] if angle is None else [angle]
            known[number] = None
        elif operation == "input":
            known[number] = parameter
        else:
            known[number] = _image(field, operation, values, data)
    return known


def _image(field: EdgeField, operation: str, values: Sequence[Quotient], data: Data) -> Quotient:
    if operation == "const":
        if isinstance(data, Fraction):
            return field.rational(data)
        return field.generator({"pi": PI, "e": E}[str(data)])
    if operation == "powi" and isinstance(data, int) and data >= 0:
        return values[0] ** data
    if operation in {"sin", "cos"}:
        return field.turned(values[0])[operation == "sin"]
    if operation == "sqrt":
        return field.root(values[0])
    image = _FIELD.get(operation)
    if image is not None:
        return image(*values)
    return field.named((operation, data, *((one.above, frozenset(one.below.items())) for one in values)))


_FIELD: Mapping[str, Callable[..., Quotient]] = {
    "add": lambda a, b: a + b,
    "mul": lambda a, b: a * b,
    "neg": lambda a: -a,
    "div": lambda a, b: a / b,
}
