"""Polynomials in one unknown over the integers modulo a prime: tuples of coefficients, the constant first."""

from __future__ import annotations

from typing import TypeAlias

Polynomial: TypeAlias = tuple[int, ...]

PRIME = 2**61 - 1  # Mersenne's ninth: a false identity of degree d passes with probability d/2**61


def trimmed(coefficients: list[int]) -> Polynomial:
    """Without leading zeros, every coefficient from 0 to PRIME - 1."""
    reduced = [coefficient % PRIME for coefficient in coefficients]
    while reduced and reduced[-1] == 0:
        reduced.pop()
    return tuple(reduced)


def added(f: Polynomial, g: Polynomial) -> Polynomial:
    """The sum.

    Examples
    --------
    >>> added((1, 2), (4, PRIME - 2))
    (5,)
    """
    if len(f) < len(g):
        f, g = g, f
    return trimmed([u + v for u, v in zip(f, g, strict=False)] + list(f[len(g) :]))


def multiplied(f: Polynomial, g: Polynomial) -> Polynomial:
    """The product.

    Examples
    --------
    >>> multiplied((1, 1), (2, 1))
    (2, 3, 1)
    """
    if not f or not g:
        return ()
    result = [0] * (len(f) + len(g) - 1)
    for i, u in enumerate(f):
        for j, v in enumerate(g):
            result[i + j] += u * v
    return trimmed(result)


def divided(f: Polynomial, g: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Quotient and remainder.

    Examples
    --------
    >>> divided((3, 3, 1), (1, 1))
    ((2, 1), (1,))
    """
    rest, quotient = list(f), [0] * max(0, len(f) - len(g) + 1)
    inverse = pow(g[-1], -1, PRIME)
    for shift in range(len(f) - len(g), -1, -1):
        factor = rest[shift + len(g) - 1] * inverse % PRIME
        quotient[shift] = factor
        for k, v in enumerate(g):
            rest[shift + k] = (rest[shift + k] - factor * v) % PRIME
    return trimmed(quotient), trimmed(rest[: len(g) - 1] if len(f) >= len(g) else rest)


def common_divisor(f: Polynomial, g: Polynomial) -> Polynomial:
    """The greatest common divisor, up to a factor."""
    while g:
        f, g = g, divided(f, g)[1]
    return f


def inverted(f: Polynomial, modulus: Polynomial) -> Polynomial | None:
    """The inverse modulo a polynomial; None where the two have a common divisor.

    Examples
    --------
    >>> multiplied((1, 1), inverted((1, 1), (0, 0, 1))) == added((1,), (0, 0, PRIME - 1))
    True
    """
    before: tuple[Polynomial, Polynomial] = modulus, ()
    after: tuple[Polynomial, Polynomial] = divided(f, modulus)[1], (1,)
    while len(after[0]) > 1:
        quotient, rest = divided(before[0], after[0])
        step = added(before[1], multiplied((PRIME - 1,), multiplied(quotient, after[1])))
        before, after = after, (rest, step)
    if not after[0]:
        return None
    return divided(multiplied((pow(after[0][0], -1, PRIME),), after[1]), modulus)[1]


def square_free(f: Polynomial) -> Polynomial:
    """The product of the distinct factors."""
    derivative = trimmed([k * coefficient for k, coefficient in enumerate(f)][1:])
    return divided(f, common_divisor(f, derivative))[0] if derivative else f
