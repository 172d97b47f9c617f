"""Rows of R_alpha: (f + g -+ r)/(1 + alpha) with r**2 = f**2 + g**2 - 2 alpha f g, for -1 < alpha <= 1.

r**2 = (f - alpha g)**2 + (1 - alpha**2) g**2, so 1 -+ (f - alpha g)/r >= 0: both operations grow with f and g. The
conjunction is 2 f g/(f + g + r); where f g > 0 the root falls as alpha grows, where f g < 0 it grows, and in each of
the three cases (f, g > 0; f, g < 0; f g < 0) the quotient rises. The disjunction is -conjunction(-f, -g).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from rsym.model.rnodes import RAlphaConjunction, RAlphaDisjunction
from rsym.program.powers import at_most, root, where_above
from rsym.program.program import Node
from rsym.program.r0 import pair
from rsym.program.row import DOWN, UP, Admissible, Expansion, Nodes, Operation, Rule, homogeneous, nonzero, summed


def _meaning(sign: int) -> Callable[..., Any]:
    """Min or max where r is 0 or infinite."""

    def meaning(np: Any, f: Any, g: Any, alpha: Any) -> Any:
        f, g, alpha = np.broadcast_arrays(f, g, np.where((alpha > -1) & (alpha <= 1), alpha, np.nan))
        low, high = np.minimum(f, g), np.maximum(f, g)
        near, far = (low, high) if sign < 0 else (high, low)
        size, total = np.hypot(f - alpha * g, np.sqrt((1 - alpha) * (1 + alpha)) * g), f + g
        cancels = sign * total < 0
        value = np.where(cancels, 2 * near * (far / (total - sign * size)), (total + sign * size) / (1 + alpha))
        fails = (f * f + g * g == 0) | np.isinf(f * f + g * g) | (alpha == 1)
        return np.where(fails & ~np.isnan(alpha), near, value)

    return meaning


def _expansion(sign: int) -> Expansion:
    """R = sqrt((f - alpha g)**2 + (1 - alpha**2) g**2), a sum of squares, which rounding cannot make negative.

    For alpha = 1 that is |f - g|, which is finite where f + g + r is not: there the operation is written as min, max.
    """

    def expansion(b: Nodes, node: Node) -> int:
        f, g, alpha = node.arguments
        if b.value(alpha) == 1:
            return b.make("min" if sign < 0 else "max", f, g)
        alpha = where_above(b, alpha, -1, at_most(b, alpha, 1))
        rest = b.sqrt(b.mul(b.sub(b.const(1), alpha), b.add(b.const(1), alpha)))
        sheared = root(b, b.sub(f, b.mul(alpha, g)), b.mul(rest, g))
        return pair(b, sign, f, g, sheared, b.add(b.const(1), alpha))

    return expansion


def _derivative(sign: int) -> Rule:
    """(1 + s (f - alpha g)/r) f'/(1 + alpha) and the same with f and g exchanged: the versine of a sheared pair."""

    def rule(b: Nodes, number: int, node: Node, d: Sequence[int]) -> int:
        f, g, alpha = node.arguments
        one = b.const(1)
        rest = b.sqrt(b.mul(b.sub(one, alpha), b.add(one, alpha)))

        def partial(u: int, v: int) -> int:
            sheared = b.sub(u, b.mul(alpha, v))
            return b.make("versine", sheared if sign < 0 else b.neg(sheared), b.mul(rest, v))

        u, v = partial(f, g), partial(g, f)
        return b.div(b.add(b.mul(u, d[0]), b.mul(v, d[1])), b.add(one, alpha))

    return rule


def _jump(b: Nodes, number: int, node: Node, jumps: Sequence[int]) -> int:
    """No partial derivative is larger than 2/(1 + alpha)."""
    return b.div(b.mul(b.const(2), summed(b, jumps[:2])), b.add(b.const(1), node.arguments[2]))


def _conjunction_at(f: Any, g: Any, alpha: Any) -> Any:
    total, sheared = f + g, f - alpha * g
    radius = ((sheared * sheared).nonnegative_part() + (1 - alpha) * (1 + alpha) * g * g).sqrt()
    return 2 * f * g / (total + radius) if total > 0 else (total - radius) / (1 + alpha)


def _operation(sign: int) -> Operation:
    kind = RAlphaConjunction if sign < 0 else RAlphaDisjunction
    return Operation(
        3,
        _meaning(sign),
        _expansion(sign),
        _derivative(sign),
        _jump,
        homogeneous,
        lambda f, g, alpha: kind(alpha, f, g),
        grows=(UP, UP, UP if sign < 0 else DOWN),
        at=_conjunction_at if sign < 0 else lambda f, g, alpha: -_conjunction_at(-f, -g, alpha),
        rounding="sum over 1 + parameter",
        parameter=Admissible(-1, 1),
        analytic_parameter=Admissible(-1, 1, below=True),
        analytic=(nonzero(0, 1),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        logic="and" if sign < 0 else "or",
        zeros=("00", "0+", "+0") if sign < 0 else ("00", "0-", "-0"),
    )


R_ALPHA: dict[str, Operation] = {"r_alpha_conjunction": _operation(-1), "r_alpha_disjunction": _operation(1)}
