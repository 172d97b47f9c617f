"""Moves: the declared ways to change a shape, each a family with one size, zero the shape as it is.

Two of them stand here: a letter takes another value; "round" keeps a root from zero that vanishes where the boundary
is defective.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context
from fractions import Fraction
from itertools import combinations
from typing import TypeAlias

import sympy as sp

from rsym.model.letters import Letter
from rsym.model.nodes import Trimming
from rsym.model.rnodes import R0mOperation, R0Operation, R1Operation, RAlphaOperation, ROperation
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of, with_arguments
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.repair.anatomy import Anatomy, Culprit, Verdict, anatomy, troubles

# A shape, its verdict and a size to the changed shape and what was done, or to None if there is nothing to change.
Operation: TypeAlias = Callable[[sp.Expr, sp.Expr], sp.Expr]
Step: TypeAlias = Callable[[Shape, Verdict, Fraction], tuple[Shape, str] | None]
# Of the extent. The smallest curvature that a rounding can have is about its inverse; below, only needles.
SCALE = (Fraction(1, 1000), Fraction(1, 300), Fraction(1, 100), Fraction(1, 30), Fraction(1, 10))
# Bodies that do not turn about an axis: boxes are as small as a fillet, so one of a hundredth takes a million.
SCALE_IN_SPACE = (Fraction(1, 30), Fraction(1, 10))
ROUNDS = 4  # a change may uncover what lay hidden, max(|x| - 1, 0) the |x|
# The move "letter": a letter goes to the nearest value that certifies.
# Shares of the way from a letter's value to the end of its range, of which the smallest that helps is narrowed down.
WAY = (Fraction(1, 64), Fraction(1, 32), Fraction(1, 16), Fraction(1, 8), Fraction(1, 4), Fraction(1, 2), Fraction(1))


@dataclass(frozen=True)
class MoveFamily:
    """One way to change a shape, by more and more.

    Attributes
    ----------
    move : str
        The name of the move.
    what : str
        What is changed.
    sizes : ascending
        The sizes to try.
    step : callable
        ``step(shape, verdict, size)`` changes what the verdict finds wrong.
    rounds : int
        How often it may be applied, each time to its last result.
    rest : callable, optional
        The step for what is still wrong when there is nothing left for `step`.
    unit : Fraction, optional
        If given, the smallest size that helps is narrowed down between those tried, to a small share of this; else a
        second and gentler one is offered beside the first.
    """

    move: str
    what: str
    sizes: tuple[Fraction, ...]
    step: Step
    rounds: int = 1
    rest: Step | None = None
    unit: Fraction | None = None


@dataclass(frozen=True)
class Request:
    """What is to be repaired, and what the designer has said.

    `size` fixes the radius of roundings and blends, a length; `vary` are the letters that may be moved, None for all.
    """

    shape: Shape
    report: Verdict
    size: Fraction | None = None
    vary: Sequence[str] | None = None

    def scale(self) -> tuple[Fraction, ...]:
        """Sizes of roundings, in units of length."""
        if self.size is not None:
            return (self.size,)
        assert self.shape.bounds is not None
        extent = max(high - low for low, high in self.shape.bounds)
        shares = SCALE_IN_SPACE if isinstance(self.report, BodyReport) else SCALE
        return tuple(short(float(share) * extent, 1) for share in shares)


class Move(ABC):
    """A declared way to change a shape; a new one is a class with a name and its families.

    Examples
    --------
    >>> import rsym
    >>> from rsym.verify.repair.repairing import MOVES
    >>> sorted(MOVES)
    ['letter', 'pasko', 'rho', 'round']
    """

    name: str

    @abstractmethod
    def families(self, request: Request) -> list[MoveFamily]:
        """The ways in which this move may change a shape."""


def short(value: float, digits: int = 2, *, up: bool = False) -> Fraction:
    """A number of few digits near a positive one, or just above it.

    Examples
    --------
    >>> short(0.012345), short(0.012345, 3, up=True)
    (Fraction(3, 250), Fraction(31, 2500))
    """
    context = Context(digits, ROUND_CEILING) if up else Context(digits)
    return Fraction(context.create_decimal(value))


def changed(shape: Shape, changes: Mapping[sp.Expr, Callable[[sp.Expr], sp.Expr]]) -> Shape:
    """A shape with parts of its expression replaced by functions of themselves, their arguments already changed.

    Named parts change with it and keep their names.
    """
    roots = (shape.expression, *(part for _, part in shape.parts))
    done: dict[sp.Basic, sp.Basic] = {}
    for part in postorder(*roots):
        arguments = tuple(done[argument] for argument in part.args)
        new = part if arguments == part.args else with_arguments(part, arguments)
        done[part] = changes[part](new) if part in changes else new
    parts = tuple((name, done[part]) for name, part in shape.parts)
    return Shape(done[shape.expression], shape.coordinates, letters=shape.letters, bounds=shape.bounds, parts=parts)


def pair_of(part: sp.Expr, level: int) -> tuple[sp.Expr, sp.Expr]:
    """The two operands of a fold at a level, all before as one; the arguments of other parts."""
    if not isinstance(part, ROperation):
        return part.args[0], part.args[1]
    return part.func(*part.parameters, *part.operands[: level - 1]), part.operands[level - 1]


def folded(part: sp.Expr, levels: Mapping[int, Operation]) -> sp.Expr:
    """A fold with other operations at some levels, 2 the first."""
    if not isinstance(part, ROperation):
        return levels[2](*part.args)
    result, *rest = part.operands
    for level, operand in enumerate(rest, 2):
        result = levels[level](result, operand) if level in levels else part.func(*part.parameters, result, operand)
    return result


def name_of(shape: Shape, part: sp.Expr, longest: int = 40) -> str:
    """What a part is called in the model, else its formula, cut if it is long."""
    for name, named in shape.parts:
        if named == part:
            return name
    text = str(part)
    return text if len(text) <= longest else f"{text[: longest - 3]}..."


def number_text(value: Fraction) -> str:
    """A short number as a decimal."""
    return f"{float(value):.12g}"


class LetterMove(Move):
    """One letter is moved, up or down, within its range (half to twice its value if it has none)."""

    name = "letter"

    def families(self, request: Request) -> list[MoveFamily]:
        """Two for each letter that is in the expression."""
        return list(_families(self.name, request))


def _families(move: str, request: Request) -> Iterator[MoveFamily]:
    shape = request.shape
    used = {symbol.name for symbol in symbols_of(shape.expression)}
    for name, letter in shape.letters.items():
        if name not in used or (request.vary is not None and name not in request.vary):
            continue
        value = letter.fraction
        for end, sign, word in zip(ends(letter), (-1, 1), ("down", "up"), strict=True):
            room = abs(end - value)
            if room > 0:
                sizes = tuple(room * share for share in WAY)
                what = f"{name} from {number_text(value)} {word} to {number_text(end)}"
                yield MoveFamily(move, what, sizes, _to(name, value, sign), unit=abs(value) or room)


def ends(letter: Letter) -> tuple[Fraction, Fraction]:
    """The range of a letter; where it is open, half and twice its value.

    Examples
    --------
    >>> ends(Letter(4, minimum=1))
    (Fraction(1, 1), Fraction(8, 1))
    """
    value = letter.fraction
    half, double = sorted((value / 2, value * 2))
    low = half if letter.minimum is None else Fraction(letter.minimum)
    high = double if letter.maximum is None else Fraction(letter.maximum)
    return min(low, value), max(high, value)


def _to(name: str, value: Fraction, sign: int) -> Step:
    def step(shape: Shape, _: Verdict, size: Fraction) -> tuple[Shape, str]:
        new = value + sign * size
        return shape.with_letters({name: new}), f"{name} from {number_text(value)} to {number_text(new)}"

    return step


class Round(Move):
    """A root r is replaced by sqrt(r**2 + eps**2): |u|, sqrt(u), a trimming, the root of an R-operation.

    eps is a length times the slope of the root, so that the boundary moves by about this length; normalisation is
    lost there.
    """

    name = "round"

    def families(self, request: Request) -> list[MoveFamily]:
        """One family: all roots that vanish at the defects."""
        return [MoveFamily(self.name, "rounding of roots", request.scale(), rounded, ROUNDS)]


def rounded(shape: Shape, report: Verdict, size: Fraction) -> tuple[Shape, str] | None:
    """The shape with the roots rounded that vanish where the verdict finds it wrong.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> roof = rsym.Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> found = rounded(roof, rsym.verify_smoothness(roof), Fraction(1, 10))
    >>> found[0].expression, found[1]
    (-y - sqrt(x**2 + 1/100) + 1, '|x| rounded by 0.1')
    """
    body, culprits = anatomy(shape, troubles(report, shape))
    levels: dict[sp.Expr, list[Culprit]] = {}
    for culprit in culprits:
        if _root(culprit) is not None:
            levels.setdefault(culprit.part, []).append(culprit)
    if not levels:
        return None
    changes, words = {}, []
    for part, found in levels.items():
        sizes = {culprit.level: _size(body, culprit, size) for culprit in found}
        changes[part] = _change(part, sizes)
        amounts = ", ".join(dict.fromkeys(map(number_text, sizes.values())))
        words.append(f"{_title(shape, part)} rounded by {amounts}")
    return changed(body.shape, changes), "; ".join(words)


def _size(body: Anatomy, culprit: Culprit, size: Fraction) -> Fraction:
    """Eps in the unit of the root."""
    slope = body.slope(_root(culprit), culprit.point)
    return short(float(size) * slope) if 0 < slope < float("inf") else size


def _title(shape: Shape, part: sp.Expr) -> str:
    if isinstance(part, sp.Abs):
        return f"|{name_of(shape, part.args[0])}|"
    return f"the root of {name_of(shape, part)}" if isinstance(part, ROperation) else name_of(shape, part)


def _root(culprit: Culprit) -> sp.Expr | None:
    """The root that vanishes at the culprit's point, None if there is none that this move can round."""
    part = culprit.part
    if isinstance(part, sp.Pow):
        return part.base if isinstance(part.base, sp.Abs) else sp.sqrt(part.base)
    if isinstance(part, sp.Max | sp.Min):
        return sum((sp.Abs(a - b) for a, b in combinations(part.args, 2)), sp.S.Zero)
    if not isinstance(part, ROperation):
        return part
    f, g = pair_of(part, culprit.level)
    if isinstance(part, R1Operation):
        return sp.Abs(f - g, evaluate=False)
    plain = isinstance(part, R0Operation | RAlphaOperation) and not isinstance(part, R0mOperation)
    return sp.sqrt(f**2 + g**2) if plain else None


def _change(part: sp.Expr, sizes: dict[int, Fraction]) -> Callable[[sp.Expr], sp.Expr]:
    if isinstance(part, ROperation):
        return lambda new: folded(new, {level: _operation(new, eps) for level, eps in sizes.items()})
    eps = sp.Rational(*sizes[0].as_integer_ratio())
    return lambda new: _rounded(new, eps)


def _operation(part: ROperation, size: Fraction) -> Operation:
    """The operation in plain arithmetic, its root rounded."""
    eps = sp.Rational(*size.as_integer_ratio())
    if isinstance(part, R1Operation):
        return lambda f, g: (f + g + part.sign * sp.sqrt((f - g) ** 2 + eps**2)) / 2
    alpha = part.parameters[0] if isinstance(part, RAlphaOperation) else sp.S.Zero
    return lambda f, g: (f + g + part.sign * sp.sqrt(f**2 + g**2 - 2 * alpha * f * g + eps**2)) / (1 + alpha)


def _rounded(part: sp.Expr, eps: sp.Rational) -> sp.Expr:
    """|u|, a power, a trimming, a minimum or maximum with its root rounded."""
    if isinstance(part, sp.Abs):
        return sp.sqrt(part.args[0] ** 2 + eps**2)
    if isinstance(part, sp.Pow):
        base = part.base
        return (sp.sqrt(base.args[0] ** 2 + eps**2) if isinstance(base, sp.Abs) else base + eps**2) ** part.exp
    if isinstance(part, Trimming):
        f, t = part.args
        return sp.sqrt(f**2 + ((sp.sqrt(t**2 + f**4) - t) / 2) ** 2 + eps**2)
    result, *rest = part.args
    sign = 1 if isinstance(part, sp.Max) else -1
    for operand in rest:
        result = (result + operand + sign * sp.sqrt((result - operand) ** 2 + eps**2)) / 2
    return result
