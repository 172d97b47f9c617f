"""The locus: on one box, the simplest function with the same zero set and the same signs as omega.

The sign of an R-operation depends only on the signs of its arguments, so where one operand of a conjunction is
positive the boundary is that of the other; positive factors drop, odd powers and normalisation too. What drops
takes its kinks with it: (1 - x**2 - y**2)*(2 + |x|) has the boundary of 1 - x**2 - y**2. Only what is defined on
the whole box may drop: (1 - x**2 - y**2)*(2 + sqrt(x)) has half that circle. Normalisation is the exception: on the
curves and points where |grad omega| does not exist, omega decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from rsym.logic.sign_form import beside_idle
from rsym.logic.stripping import Signed, Stripping, constant_sign, even_root, keeps_sign
from rsym.program.builder import Builder
from rsym.program.operations import CONJUNCTIONS, LOGICAL
from rsym.verify.boxes.domains import is_defined, is_legal, switch_of
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.polynomials import same_zeros


@dataclass(frozen=True)
class Locus:
    """A zero set on a box.

    kind: "none", no zeros; "leaf", that of one node, inside where it is positive; "double", that of one node,
    which is zero without a change of sign; "conjunction" or "disjunction" of two leaves; "product" of two
    factors that may both vanish; "several", anything else.
    """

    kind: str
    nodes: tuple[int, ...] = ()


NONE = Locus("none")


DEEPEST = 60  # operations within operations, each with two parts that count: where so many meet is not asked


def reduce(local: Local, number: int, depth: int = 0) -> Locus:
    """The locus of a node on the box."""
    part = Signed(number)
    for part in stripping(local, partial(_decided, local)).steps(number):
        value = local.value(part.number)
        if value is None or not value.contains(0):
            return NONE
    return _reduced(local, *part, depth)


def stripping(local: Local, otherwise: Callable[[int], Signed | None] | None = None) -> Stripping:
    """What drops on a box: factors that are defined and of one sign on all of it."""
    return Stripping(
        local.model.builder, partial(_sure_sign, local), keeps=partial(_keeps_sign, local), otherwise=otherwise
    )


def _sure_sign(local: Local, number: int) -> int:
    """The sign that a node has on the whole box, which it is defined on; 0 if there is none."""
    sign = local.sign(number)
    return sign if sign and is_defined(local, number) else 0


def _decided(local: Local, number: int) -> Signed | None:
    """What is left of an operation with branches, and of a conjunction or disjunction of which one operand is idle."""
    builder = local.model.builder
    branching = builder.nodes[number].operation in {"abs", "min", "max", "select"}
    if branching and (branch := chosen(local, number)) is not None:
        return Signed(*branch)
    return beside_idle(builder, number, partial(_sure_sign, local), partial(is_legal, local))


def _keeps_sign(local: Local, number: int) -> bool:
    """Whether the node is zero exactly where its first argument is, with the same sign."""
    operation, arguments, data = local.model.builder.nodes[number]
    if operation == "powi":
        return isinstance(data, int) and data % 2 == 1
    if operation == "normalised":
        return is_defined(local, arguments[1], but_for_thin_sets=True)
    return local.sign(arguments[1]) > 0


def chosen(local: Local, number: int) -> tuple[int, int] | None:
    """The argument, and a sign, that an operation with branches equals on the box, if that is certain.

    A choice between what is one function on the box is that function, whatever it tests.
    """
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[number]
    switch = switch_of(builder, number)
    sign = local.sign(switch)
    if not is_defined(local, switch):
        return None
    if not sign:
        same = operation == "select" and _taken(local, arguments[2]) == _taken(local, arguments[3])
        return (_taken(local, arguments[2]), 1) if same else None
    if operation == "abs":
        return arguments[0], sign
    if operation == "select":
        return arguments[2 if sign > 0 else 3], 1
    first = (sign > 0) == (operation == "max")
    return arguments[0 if first else 1], 1


def _taken(local: Local, number: int) -> int:
    """What a choice leads to, through the choices that follow."""
    while local.model.builder.nodes[number].operation == "select" and (branch := chosen(local, number)) is not None:
        number = branch[0]
    return number


def _reduced(local: Local, number: int, sign: int, depth: int) -> Locus:
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[number]
    if operation in LOGICAL and is_legal(local, number):
        return _combined(local, arguments[:2], sign, depth, conjunction=operation in CONJUNCTIONS)
    if operation == "mul" or operation == "equivalence":
        return _product(local, number, sign, depth)
    if operation in {"abs", "absolute_power", "sqrt", "trimming", "gap"} or operation == "powi":
        return Locus("double", (number if operation in {"trimming", "gap"} else arguments[0],))
    return Locus("leaf", (number if sign > 0 else builder.neg(number),))


def _combined(local: Local, both: tuple[int, ...], sign: int, depth: int, *, conjunction: bool) -> Locus:
    """The locus of sign*(f and g), sign*(f or g): De Morgan turns -(f and g) into -f or -g."""
    builder = local.model.builder
    if any(local.sign(one) == (-1 if conjunction else 1) for one in both):
        return NONE
    if depth == DEEPEST:
        return Locus("several")
    operands = []
    for operand in both:
        inner = reduce(local, operand if sign > 0 else builder.neg(operand), depth + 1)
        if inner.kind != "leaf":
            return Locus("several")
        operands.append(inner.nodes[0])
    if operands[0] == operands[1]:
        return Locus("leaf", (operands[0],))
    return Locus("conjunction" if conjunction == (sign > 0) else "disjunction", tuple(operands))


def _product(local: Local, number: int, sign: int, depth: int) -> Locus:
    """A product of two factors that may both vanish; u*|u| and the like have the locus of u."""
    builder = local.model.builder
    u, v = builder.nodes[number].arguments[:2]
    (first, times, first_odd), (second, also, second_odd) = _zeros(builder, u), _zeros(builder, v)
    if first == second or same_zeros(local.model, first, second):
        if first_odd == second_odd:
            return Locus("double", (first,))
        changing = Signed(first if first_odd else second, sign * times * also)
        return reduce(local, changing.made(builder), depth)
    return Locus("product", (u, v) if sign > 0 else (builder.neg(u), v))


def _zeros(builder: Builder, number: int) -> tuple[int, int, bool]:
    """(u, s, odd): s times a node has the zeros of u and its sign, or, not odd, is never negative."""
    stripped = Stripping(builder, partial(constant_sign, builder), keeps=partial(_is_odd_power, builder))
    inner, sign = stripped(number)
    odd = True
    while (root := even_root(builder, inner)) is not None:
        inner, odd = stripped(root).number, False
    return inner, sign, odd


def _is_odd_power(builder: Builder, number: int) -> bool:
    return builder.nodes[number].operation == "powi" and keeps_sign(builder, number)
