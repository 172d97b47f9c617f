"""The move "letter": a letter goes to the nearest value that certifies."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from rsym.model.letters import Letter
from rsym.model.shape import Shape
from rsym.model.traversal import symbols_of
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.moves import Family, Move, Request, Step, number_text

# Shares of the way from a letter's value to the end of its range, of which the smallest that helps is narrowed down.
WAY = (Fraction(1, 64), Fraction(1, 32), Fraction(1, 16), Fraction(1, 8), Fraction(1, 4), Fraction(1, 2), Fraction(1))


class LetterMove(Move):
    """One letter is moved, up or down, within its range (half to twice its value if it has none)."""

    name = "letter"

    def families(self, request: Request) -> list[Family]:
        """Two for each letter that is in the expression."""
        return list(_families(self.name, request))


def _families(move: str, request: Request) -> Iterator[Family]:
    shape = request.shape
    used = {symbol.name for symbol in symbols_of(shape.expression)}
    for name, letter in shape.letters.items():
        if name not in used or (request.vary is not None and name not in request.vary):
            continue
        value = Fraction(letter.default)
        for end, sign, word in zip(ends(letter), (-1, 1), ("down", "up"), strict=True):
            room = abs(end - value)
            if room > 0:
                sizes = tuple(room * share for share in WAY)
                what = f"{name} from {number_text(value)} {word} to {number_text(end)}"
                yield Family(move, what, sizes, _to(name, value, sign), unit=abs(value) or room)


def ends(letter: Letter) -> tuple[Fraction, Fraction]:
    """The range of a letter; where it is open, half and twice its value.

    Examples
    --------
    >>> ends(Letter(4, minimum=1))
    (Fraction(1, 1), Fraction(8, 1))
    """
    value = Fraction(letter.default)
    half, double = sorted((value / 2, value * 2))
    low = half if letter.minimum is None else Fraction(letter.minimum)
    high = double if letter.maximum is None else Fraction(letter.maximum)
    return min(low, value), max(high, value)


def _to(name: str, value: Fraction, sign: int) -> Step:
    def step(shape: Shape, _: Verdict, size: Fraction) -> tuple[Shape, str]:
        new = value + sign * size
        return shape.with_letters({name: new}), f"{name} from {number_text(value)} to {number_text(new)}"

    return step
