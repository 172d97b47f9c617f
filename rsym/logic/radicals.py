"""Leaves that are singular along curves by their form alone, as others of the same sign that are not.

An odd power rises with what it is a power of, so u**n + c*v**n, with c not negative, has the sign of u + c**(1/n)*v:
along u = v = 0, where all slopes of the first vanish, the second has some.
"""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

from rsym.logic.stripping import Signed, sum_terms
from rsym.program.builder import Builder


def odd_powers(builder: Builder, number: int) -> Signed | None:
    """What has the sign of a sum u**n + c*v**n with an odd n: u + c**(1/n)*v; else None.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> u, v = b.input("x"), b.input("y")
    >>> odd_powers(b, b.sub(b.mul(b.const(2), b.powi(v, 3)), b.powi(u, 3))) == Signed(
    ...     b.sub(u, b.mul(b.make("pow", b.const(2), b.const(Fraction(1, 3))), v)), -1
    ... )
    True
    """
    found = sum_terms(builder, number)
    if found is None or found[1] or len(found[0]) < 2:
        return None
    terms = {term: (times, _factors(builder, term)) for term, times in found[0].items()}
    for term, (times, own) in terms.items():
        (base, n), *more = own.items()
        if more or n % 2 == 0 or n == 1:
            continue
        others = [(share / times, factors) for part, (share, factors) in terms.items() if part != term]
        shared = [v for v in others[0][1] if all(factors[v] >= n for _, factors in others)]
        for v in shared:
            for sign in (1, -1):
                c = _sum(builder, [(sign * share, factors - Counter({v: n})) for share, factors in others])
                if builder.nonnegative[c]:
                    root = builder.make("pow", c, builder.const(Fraction(1, n)))
                    turn = builder.add if sign > 0 else builder.sub
                    return Signed(turn(base, builder.mul(root, v)), 1 if times > 0 else -1)
    return None


def _factors(builder: Builder, number: int) -> Counter[int]:
    """A product as powers of its factors."""
    found: Counter[int] = Counter()
    stack = [(number, 1)]
    while stack:
        part, times = stack.pop()
        operation, arguments, data = builder.nodes[part]
        if operation == "mul":
            stack += [(argument, times) for argument in arguments]
        elif operation == "powi" and isinstance(data, int) and data > 0:
            stack.append((arguments[0], times * data))
        else:
            found[part] += times
    return found


def _sum(builder: Builder, terms: list[tuple[Fraction, Counter[int]]]) -> int:
    total = builder.const(0)
    for times, factors in terms:
        part = builder.const(times)
        for factor, power in factors.items():
            part = builder.mul(part, builder.powi(factor, power))
        total = builder.add(total, part)
    return total
