"""Where a program is defined: on which boxes no part of it can be NaN."""

from __future__ import annotations

from rsym.program.builder import Builder
from rsym.verify.local import Local

# Operations whose plain meaning is NaN for some real arguments.
PARTIAL = frozenset(
    "undefined div pow sqrt log select min max r_alpha_conjunction r_alpha_disjunction r0m_conjunction "
    "r0m_disjunction rp_conjunction rp_disjunction versine rp_versine r0m_partial monomial norm joining equivalence "
    "absolute_power signed_power normalised trimming".split()
)


# Those that are NaN on thin sets only, where a denominator or a root is zero.
_THIN = frozenset(
    "div versine rp_versine monomial norm joining equivalence absolute_power signed_power normalised".split()
)
_THICK = PARTIAL - _THIN


def is_defined(local: Local, number: int, *, but_for_thin_sets: bool = False) -> bool:
    """Whether the node is certainly defined on the whole box, or on all of it but curves and points."""
    key = (number, but_for_thin_sets)
    if key not in local.defined:
        local.value(number)
        partial = local.model.parts(number, _THICK if but_for_thin_sets else PARTIAL)
        local.defined[key] = all(is_defined_itself(local, part) for part in partial)
    return local.defined[key]


def is_defined_itself(local: Local, number: int) -> bool:
    """Whether the node is defined wherever its arguments are."""
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[number]
    if operation in {"min", "max", "select"}:
        return True
    if operation == "undefined":
        return False
    if operation in {"sqrt", "trimming"}:  # not >= 0: what is defined on the box must be so around it
        return builder.nonnegative[arguments[0]] or local.sign(arguments[0]) > 0
    if operation in {"log", "pow"}:
        return local.sign(arguments[0]) > 0
    if operation == "div":
        return local.nonzero(arguments[1])
    if operation in {"normalised", "absolute_power", "signed_power"}:
        return local.nonzero(arguments[0]) or local.sign(arguments[1]) > 0
    if operation in {"versine", "rp_versine", "monomial"} and not any(local.nonzero(a) for a in arguments[:2]):
        return False
    return is_legal(local, number)


def switch_of(builder: Builder, number: int) -> int:
    """The node whose sign decides which branch of abs, sign, min, max, select, or atan2 to the left, is taken."""
    if number not in builder.switches:
        operation, arguments, _ = builder.nodes[number]
        alone = operation in {"abs", "sign", "atan2"}
        builder.switches[number] = arguments[0] if alone else builder.sub(arguments[0], arguments[1])
    return builder.switches[number]


def is_legal(local: Local, number: int) -> bool:
    """Whether the parameter of an R-operation, its last argument, is certainly in its range."""
    operation, arguments, _ = local.model.builder.nodes[number]
    if len(arguments) == 2:
        return True
    parameter = local.value(arguments[2])
    if parameter is None:
        return False
    if operation.startswith("r_alpha"):
        return bool(parameter > -1) and bool(parameter <= 1)
    return bool(parameter > 1) if operation.startswith("rp") else bool(parameter >= 1)
