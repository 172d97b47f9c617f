"""Where a program is defined: on which boxes no part of it can be NaN."""

from __future__ import annotations

from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS, PARTIAL, THICK
from rsym.program.row import SELF, SWITCH, Clauses
from rsym.verify.boxes.local import Local


def is_defined(local: Local, number: int, *, but_for_thin_sets: bool = False) -> bool:
    """Whether the node is certainly defined on the whole box, or on all of it but curves and points."""
    key = (number, but_for_thin_sets)
    if key not in local.defined:
        local.value(number)
        partial = local.model.parts(number, THICK if but_for_thin_sets else PARTIAL)
        local.defined[key] = all(is_defined_itself(local, part) for part in partial)
    return local.defined[key]


def is_defined_itself(local: Local, number: int) -> bool:
    """Whether the node is defined wherever its arguments are."""
    return is_legal(local, number) and meets(local, number, OPERATIONS[_operation(local, number)].domain)


def _operation(local: Local, number: int) -> str:
    return local.model.builder.nodes[number].operation


def meets(local: Local, number: int, clauses: Clauses) -> bool:
    """Whether a node certainly meets conditions on its arguments, all over the box."""
    for clause in clauses:  # asked a million times: without generators
        for kind, place in clause:
            if _holds(local, number, kind, place):
                break
        else:
            return False
    return True


def _holds(local: Local, number: int, kind: str, place: int) -> bool:
    """One condition. What is defined on the box must be so around it: zero is enough only where a form shows it."""
    builder = local.model.builder
    if place == SELF:
        tested = number
    elif place == SWITCH:
        tested = switch_of(builder, number)
    else:
        tested = builder.nodes[number].arguments[place]
    if kind in {"nonzero", "apart"}:
        return local.nonzero(tested) and (kind == "nonzero" or is_defined(local, tested))
    return (kind == "nonnegative" and builder.nonnegative[tested]) or local.sign(tested) > 0


def switch_of(builder: Builder, number: int) -> int:
    """The node whose sign decides which branch of abs, sign, min, max, select, or atan2 to the left, is taken."""
    if number not in builder.switches:
        operation, arguments, _ = builder.nodes[number]
        alone = operation in {"abs", "sign", "atan2"}
        builder.switches[number] = arguments[0] if alone else builder.sub(arguments[0], arguments[1])
    return builder.switches[number]


def is_legal(local: Local, number: int, *, analytic: bool = False) -> bool:
    """Whether the parameter of an operation is certainly in its range, or in that where the operation is analytic."""
    row = OPERATIONS[_operation(local, number)]
    legal = row.parameter
    if legal is None:
        return True
    if analytic and row.analytic_parameter is not None:
        legal = row.analytic_parameter
    parameter = local.value(local.model.builder.nodes[number].arguments[-1])
    return parameter is not None and legal.holds(parameter)
