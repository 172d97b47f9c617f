"""What sums, products, powers and the elementary functions promise."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import combinations

import sympy as sp
from sympy.core.relational import Relational

from rsym.analysis.contracts import ends
from rsym.analysis.contracts.promises import Ends, Promise, Signs, Singularity, weakest
from rsym.analysis.contracts.squares import squares_of
from rsym.model.functions import FUNCTIONS, Function
from rsym.model.nodes import Ahead, Held, ZeroWith
from rsym.model.powers import AbsolutePower, SignedPower

Least = Callable[[sp.Expr], sp.Expr | None]  # the least value of an exponent in letters, None where unknown
Rule = Callable[..., Promise]


def below(exponent: sp.Expr | None) -> int:
    """The greatest whole number below a > 0, the class of |u|**a at u = 0; -1 for other exponents.

    Examples
    --------
    >>> import sympy as sp
    >>> below(sp.Rational(5, 2)), below(sp.Integer(3)), below(sp.Integer(-1))
    (2, 2, -1)
    """
    return int(sp.ceiling(exponent)) - 1 if exponent is not None and exponent > 0 else -1


def _sum(part: sp.Add, least: Least) -> Promise:
    def truth(signs: Signs) -> int | None:
        kinds = set(signs) - {0}
        return None if len(kinds) > 1 else sum(kinds)

    law = "the sign of the terms where they agree"
    return Promise(part.args, law=law, truth=truth, monotone=(1,) * len(part.args), image=ends.total)


def _product(part: sp.Mul, least: Least) -> Promise:
    scaled = len(part.args) == 2 and part.args[0].is_Rational
    number = part.args[0]
    return Promise(
        part.args,
        law="the product of the signs",
        truth=math.prod,
        order=lambda orders: orders[1] if scaled and number == -1 else None,
        monotone=(None, int(sp.sign(number))) if scaled else (None,) * len(part.args),
        image=ends.product,
    )


def _power(part: sp.Expr, least: Least) -> Promise:
    base, exponent = part.as_base_exp() if isinstance(part, sp.exp) else part.args
    if base == sp.E:
        return Promise(
            (exponent,),
            law="positive",
            truth=lambda s: 1,
            monotone=(1,),
            image=ends.rising(_plain(sp.exp)),
        )
    if exponent.is_Integer:
        return _whole_power(base, exponent)
    squares, value = squares_of(base), least(exponent)
    doubled = value if value is None or squares is None else 2 * value
    name = "square root" if abs(exponent) == sp.Rational(1, 2) else "power"
    grows = 1 if exponent.is_positive else -1 if exponent.is_negative else None
    return Promise(
        (base, exponent),
        law="positive where the base is",
        truth=lambda s: 1 if s[0] > 0 else 0 if s[0] == 0 and grows == 1 else None,
        singular=(Singularity(squares or (base,), below(doubled), name),),
        monotone=(grows, None),
        image=lambda u, a: ends.real_power(u, a[0]),
    )


def _whole_power(base: sp.Expr, exponent: sp.Integer) -> Promise:
    odd, kink = exponent % 2 == 1, _kink(base)
    lost: tuple[Singularity, ...] = ()
    if exponent < 0:
        lost = (Singularity(squares_of(base) or (base,), -1, "division"),)
    elif kink is not None:
        lost = (Singularity((kink,), int(exponent) - 1, "power of a kink"),)
    return Promise(
        (base,),
        through=(kink,) if lost and kink is not None and exponent > 0 else None,
        law="the sign of the base" if odd else "positive off the zeros of the base",
        truth=lambda s: s[0] ** int(abs(exponent)) if s[0] or exponent > 0 else None,
        singular=lost,
        monotone=(1 if odd and exponent > 0 else None,),
        image=lambda u: ends.whole_power(u, exponent),
    )


def _kink(base: sp.Expr) -> sp.Expr | None:
    """The u of |u|, max(u, 0) and min(u, 0)."""
    if isinstance(base, sp.Abs):
        return base.args[0]
    if isinstance(base, sp.Max | sp.Min) and len(base.args) == 2 and 0 in base.args:
        return next(argument for argument in base.args if argument != 0)
    return None


def _entire(image: Callable[..., Ends], monotone: int | None, law: str = "", sign: int | None = None) -> Rule:
    """A function of one operand that is analytic everywhere."""

    def rule(part: sp.Expr, least: Least) -> Promise:
        odd = law.startswith("the sign")
        return Promise(
            part.args,
            law=law,
            truth=lambda s: s[0] if odd else sign,
            monotone=(monotone,),
            image=image,
        )

    return rule


def _lost_where(
    zero: Callable[..., tuple[sp.Expr, ...]],
    continuity: int,
    image: Callable[..., Ends],
    monotone: tuple[int | None, ...] = (None,),
    name: str = "",
) -> Rule:
    """A function that is analytic but where some expressions in its operands vanish together."""

    def rule(part: sp.Expr, least: Least) -> Promise:
        lost = Singularity(zero(*part.args), continuity, name or type(part).__name__)
        return Promise(part.args, singular=(lost,), monotone=monotone, image=image)

    return rule


def _absolute(part: sp.Abs, least: Least) -> Promise:
    return Promise(
        part.args,
        law="positive off the zeros of the operand",
        truth=lambda s: abs(s[0]),
        singular=(Singularity(part.args, 0, "absolute value"),),
        order=lambda orders: orders[0],
        monotone=(None,),
        image=ends.size,
    )


def _extremum(part: sp.Expr, least: Least) -> Promise:
    lowest = isinstance(part, sp.Min)
    pick = min if lowest else max
    return Promise(
        part.args,
        law="positive where every operand is" if lowest else "positive where some operand is",
        truth=pick,
        singular=tuple(Singularity((f - g,), 0, pick.__name__) for f, g in combinations(part.args, 2)),
        order=lambda orders: weakest(*orders),
        monotone=(1,) * len(part.args),
        image=ends.rising(ends.least if lowest else ends.greatest),
    )


def _piecewise(part: sp.Piecewise, least: Least) -> Promise:
    """Nothing is known of how the branches meet."""
    values = tuple(pair.args[0] for pair in part.args)
    conditions = [test for pair in part.args for test in pair.args[1].atoms(Relational)]
    return Promise(
        values,
        law="the sign of all branches where they agree",
        truth=lambda signs: signs[0] if len(set(signs)) == 1 else None,
        singular=tuple(Singularity((test.lhs - test.rhs,), -1, "choice of a branch") for test in conditions),
        monotone=(None,) * len(values),
        image=ends.hull,
    )


def _absolute_power(part: AbsolutePower, least: Least) -> Promise:
    base, exponent = part.args
    even = exponent.is_Integer and exponent % 2 == 0 and exponent > 0
    return Promise(
        part.args,
        law="positive off the zeros of the base",
        truth=lambda s: abs(s[0]) if below(least(exponent)) >= 0 else None,
        singular=() if even else (Singularity((base,), below(least(exponent)), "power of |u|"),),
        order=lambda orders: orders[0] if exponent == 1 else None,
        monotone=(None, None),
        image=lambda u, a: ends.real_power(ends.size(u), a[0]),
    )


def _signed_power(part: SignedPower, least: Least) -> Promise:
    base, exponent = part.args
    grows = below(least(exponent)) >= 0
    odd = exponent.is_Integer and exponent % 2 == 1 and exponent > 0
    return Promise(
        part.args,
        law="the sign of the base",
        truth=lambda s: s[0],
        singular=() if odd else (Singularity((base,), below(least(exponent)), "power of |u|"),),
        monotone=(1 if grows else None, None),
        image=lambda u, a: ends.rising(lambda end: SignedPower(end, a[0]))(u) if grows else (sp.nan, sp.nan),
    )


def _ahead(part: Ahead, least: Least) -> Promise:
    return Promise(
        part.args,
        law="never negative",
        singular=(Singularity((part.args[0] - part.args[1],), -1, "the larger of two"),),
        monotone=(1, -1),
        image=lambda f, g: (sp.S.Zero, sp.S.One),
    )


def _held(part: Held, least: Least) -> Promise:
    return Promise(part.args, law="the sign of what is held", truth=lambda s: s[0], monotone=(1,), image=lambda u: u)


def _zero_with(part: ZeroWith, least: Least) -> Promise:
    """A function that goes to 0 where another does."""
    return Promise(
        part.args[1:],
        law="the sign of the second, 0 where the first is",
        truth=lambda s: s[0],
        monotone=(1,),
        image=lambda u: (ends.least(sp.S.Zero, u[0]), ends.greatest(sp.S.Zero, u[1])),
    )


def _plain(function: Callable[..., sp.Expr]) -> Callable[..., sp.Expr]:
    return partial(function, evaluate=False)


def growing(row: Function) -> Rule:
    """An entire function that grows everywhere."""
    law = "the sign of the operand" if row.sign == "odd" else row.sign
    return _entire(ends.rising(_plain(row.kind)), row.grows, law, 1 if row.sign == "positive" else None)


ELEMENTARY: dict[type[sp.Basic], Rule] = {
    sp.Add: _sum,
    sp.Mul: _product,
    sp.Pow: _power,
    sp.exp: _power,
    sp.Abs: _absolute,
    sp.Min: _extremum,
    sp.Max: _extremum,
    sp.Piecewise: _piecewise,
    AbsolutePower: _absolute_power,
    SignedPower: _signed_power,
    Ahead: _ahead,
    Held: _held,
    ZeroWith: _zero_with,
    sp.sin: _entire(lambda u: ends.turned(u, -sp.pi / 2), None),
    sp.cos: _entire(lambda u: ends.turned(u, sp.S.Zero), None),
    **{row.kind: growing(row) for row in FUNCTIONS.values() if row.entire and row.grows and row.kind is not sp.exp},
    sp.cosh: _entire(lambda u: ends.rising(_plain(sp.cosh))(ends.size(u)), None, "positive", 1),
    sp.tan: _lost_where(lambda u: (sp.cos(u),), -1, ends.tangent),
    sp.cot: _lost_where(lambda u: (sp.sin(u),), -1, lambda u: (sp.nan, sp.nan)),
    sp.log: _lost_where(lambda u: (u,), -1, ends.rising(_plain(sp.log)), (1,), "logarithm"),
    sp.sign: _lost_where(lambda u: (u,), -1, ends.rising(_plain(sp.sign)), (1,)),
    sp.floor: _lost_where(lambda u: (sp.sin(sp.pi * u),), -1, ends.rising(_plain(sp.floor)), (1,)),
    sp.asin: _lost_where(lambda u: (1 - u**2,), 0, ends.rising(_plain(sp.asin)), (1,)),
    sp.acos: _lost_where(lambda u: (1 - u**2,), 0, ends.falling(_plain(sp.acos)), (-1,)),
    sp.atan2: _lost_where(lambda v, u: (sp.sqrt(u**2 + v**2) + u,), -1, ends.angle, (None, None)),
}
