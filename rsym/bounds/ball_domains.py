"""Where operations are certainly defined: what a comparison must know before it is decided for a whole box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from rsym.bounds.ball_arithmetic import ONE, ZERO, arb
from rsym.program.program import Node, live

Test: TypeAlias = Callable[..., bool]


def _nonzero(*operands: arb) -> bool:
    return any(operand > ZERO or operand < ZERO for operand in operands)


def _order(f: arb, g: arb, m: arb) -> bool:
    return m >= ONE


def _alpha(f: arb, g: arb, alpha: arb) -> bool:
    return alpha > -ONE and alpha <= ONE


def _degree(f: arb, g: arb, p: arb) -> bool:
    return p > ONE


# What is not here is defined wherever its arguments are. A test may be too strict, never too lax.
TESTS: dict[str, Test] = {
    "undefined": lambda: False,
    "sqrt": lambda a: a >= ZERO,
    "div": lambda a, b: _nonzero(b),
    "log": lambda a: a > ZERO,
    "pow": lambda a, b: a > ZERO,
    "versine": _nonzero,
    "normalised": _nonzero,
    "r_alpha_conjunction": _alpha,
    "r_alpha_disjunction": _alpha,
    "r0m_conjunction": _order,
    "r0m_disjunction": _order,
    "r0m_partial": _order,
    "joining": _order,
    "equivalence": _order,
    "norm": _degree,
    "rp_conjunction": _degree,
    "rp_disjunction": _degree,
    "rp_versine": lambda f, g, p: p > ONE and _nonzero(f, g),
    "monomial": lambda f, g, m: _nonzero(f, g),
    "absolute_power": lambda a, b: b >= ZERO or _nonzero(a),
    "signed_power": lambda a, b: b > ZERO or _nonzero(a),
}


def doubts(nodes: Sequence[Node], numbers: Sequence[int]) -> list[tuple[Test, tuple[int, ...]]]:
    """The tests, with the nodes they take, that make these nodes defined all over a box."""
    partial = [nodes[number] for number in live(nodes, numbers) if nodes[number].operation in TESTS]
    return [(TESTS[node.operation], node.arguments) for node in partial]
