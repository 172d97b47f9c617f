"""Is a motif its own mirror image? What triangle waves need to know."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator
from functools import partial, reduce

import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.model.nodes import written_out
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, real_symbol, substitute, with_arguments

PLACES = 48  # a bump of a twentieth of the box is met by chance in 9 of 10 cases; each place costs about 0.1 ms a node
FEWEST = 8
WORK = 30_000  # nodes at places, above which there are fewer places: about 3 s
AGREEMENT = sp.Float("1e-10")  # of the largest value: decimals of 15 digits in a motif must not make it uneven
DIGITS = 20
SPREAD = 0.3  # letters are tried up to this share of their default away from it
_PLAIN: dict[type[sp.Basic], Callable[[list[sp.Basic]], sp.Basic]] = {
    sp.Add: partial(reduce, operator.add),
    sp.Mul: partial(reduce, operator.mul),
    sp.Min: min,
    sp.Max: max,
}
UNBOUNDED = 2.0  # half the side of the box in which a motif without bounds is looked at


def check_even(shape: Shape, symbol: sp.Symbol) -> None:
    """Refuse a shape that is not even in one of its coordinates, whatever its letters.

    By form if that tells, else by value at 48 places, less where the formula is long, with the letters at their
    defaults and around them.

    Raises
    ------
    RsymError
        Where omega is not the same on both sides.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> check_even(rsym.Shape(1 - x - y**2, (x, y)), y)
    """
    expression = written_out(shape.expression)
    opposite = substitute(expression, {symbol: -symbol})
    if opposite == expression:
        return
    seen = []
    places = max(FEWEST, min(PLACES, WORK // len(postorder(expression))))
    for place in _places(shape, places):
        here, there = _value(expression, place), _value(opposite, place)
        if here is not None and there is not None:
            seen.append((here, there, place))
    largest = max((abs(value) for here, there, _ in seen for value in (here, there)), default=sp.S.Zero)
    uneven = [item for item in seen if abs(item[0] - item[1]) > AGREEMENT * largest]
    if uneven:
        crossing = [item for item in uneven if item[0] * item[1] < 0]
        raise _refusal(shape, symbol, *(crossing or uneven)[0], alike=not crossing)


def _refusal(
    shape: Shape, symbol: sp.Symbol, here: sp.Float, there: sp.Float, place: dict[sp.Symbol, sp.Float], *, alike: bool
) -> RsymError:
    where = ", ".join(f"{name} = {float(value):.4g}" for name, value in place.items())
    normal = tuple(int(coordinate == symbol) for coordinate in shape.coordinates)
    remedy = f'mirrored(motif, {normal}) makes it even, motif="any" takes it as it is'
    if alike:
        remedy += (
            "; its set looks even: combine what mirrors each other first, "
            "conjunction(f, g, h) with g the mirror image of f, since R-operations are not associative"
        )
    return RsymError(
        f"the motif must be even in {symbol}, but omega = {float(here):.6g} at {where}, "
        f"and {float(there):.6g} at {symbol} = {-float(place[symbol]):.4g}",
        code="not-even",
        remedy=remedy,
    )


def _places(shape: Shape, number: int) -> Iterator[dict[sp.Symbol, sp.Float]]:
    """Spread evenly over the box and, from the second half on, over values of the letters."""
    box = shape.box.ends if shape.box else ((-UNBOUNDED, UNBOUNDED),) * shape.dimension
    count = shape.dimension + len(shape.letters)
    root = 2.0  # of root**(count + 1) = root + 1; its powers spread best
    for _ in range(60):
        root = (1 + root) ** (1 / (count + 1))
    for k in range(1, number + 1):
        shares = [(k * root ** -(i + 1) + 0.5) % 1 for i in range(count)]
        place = {
            coordinate: sp.Float(low + share * (high - low), DIGITS)
            for coordinate, (low, high), share in zip(shape.coordinates, box, shares, strict=False)
        }
        changed = k > number // 2
        for (name, letter), share in zip(shape.letters.items(), shares[shape.dimension :], strict=True):
            place[real_symbol(name)] = sp.Float(
                _tried(letter, share) if changed else sp.sympify(letter.default), DIGITS
            )
        yield place


def _tried(letter: Letter, share: float) -> float:
    default = float(letter.default)
    value = default + (abs(default) or 1.0) * SPREAD * (2 * share - 1)
    low = value if letter.minimum is None else max(value, float(letter.minimum))
    return low if letter.maximum is None else min(low, float(letter.maximum))


def _value(expression: sp.Expr, place: dict[sp.Symbol, sp.Float]) -> sp.Float | None:
    """The number at a place, shared parts once; None where there is none."""
    known: dict[int, sp.Basic] = {}
    for part in postorder(expression):
        arguments = [known[id(argument)] for argument in part.args]
        known[id(part)] = place.get(part, part) if part.is_Symbol else _applied(part, arguments)
    result = known[id(expression)]
    return result if result.is_Float or result.is_Rational else None


def _applied(part: sp.Basic, arguments: list[sp.Basic]) -> sp.Basic:
    """The part over other arguments; of numbers SymPy itself would take hundreds of times as long."""
    plain = next((function for kind, function in _PLAIN.items() if isinstance(part, kind)), None)
    if plain is not None and all(argument.is_Float or argument.is_Rational for argument in arguments):
        return plain(arguments)
    candidate = with_arguments(part, tuple(arguments)) if arguments else part
    return candidate.evalf(DIGITS) if isinstance(candidate, sp.Expr) and not candidate.is_Rational else candidate
