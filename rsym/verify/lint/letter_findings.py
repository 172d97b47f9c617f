"""Letters in words: what their values and ranges do to the formula."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.bounds.intervals import IntervalFunction
from rsym.model.letters import Letter, Letters
from rsym.model.nodes import Fold, written_out
from rsym.model.rnodes import EquivalenceOperation, R0mOperation, RAlphaOperation, RpOperation
from rsym.model.shape import Shape
from rsym.model.symbols import postorder
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.verify.lint.places import ModelPlace, text_of
from rsym.verify.lint.report import LETTER_RANGE, Finding

SEEN = 50  # points inside: of a shape with more of them one without any is no accident


def letter_findings(shape: Shape, cloud: Floats) -> Iterator[Finding]:
    """Findings on letters, each under the letters that it is about."""
    letters = shape.letters
    told: set[str] = set()
    for parameter in parameters(shape.expression, letters):
        told.add(parameter.name)
        yield Finding(
            LETTER_RANGE,
            (_place(letters, parameter.name),),
            f"the parameter {parameter.symbol} of an R-operation must be {parameter.wanted}; "
            f"not so {' and '.join(parameter.wrong)}",
            f"declare a range within which it is {parameter.wanted}",
        )
    for breach in breaches(written_out(shape.expression), letters):
        told |= set(breach.values)
        yield _of_breach(breach, letters)
    yield from _at_ends(shape, cloud, told)


def _of_breach(breach: Breach, letters: Letters) -> Finding:
    condition = breach.condition
    values = " and ".join(f"{name} = {value:.4g}" for name, value in breach.values.items())
    which = "which are the values given" if breach.at_default else "which the ranges allow"
    open_ended = [name for name in breach.values if letters[name].minimum is None or letters[name].maximum is None]
    narrow = f"declare a range for {' and '.join(open_ended)}" if open_ended else "narrow the ranges"
    return Finding(
        LETTER_RANGE,
        tuple(_place(letters, name) for name in breach.values),
        f"the {condition.role} {text_of(condition.expression)} {condition.demand}, but is not so from {values} on, "
        f"{which}",
        "choose other values" if breach.at_default else f"{narrow} so that this cannot happen",
    )


def _at_ends(shape: Shape, cloud: Floats, told: set[str]) -> Iterator[Finding]:
    """Letters at whose ends omega is undefined where it is not otherwise, or positive nowhere."""
    before, inside = _shares(shape, cloud, {})
    for name, letter in shape.letters.items():
        for word, end in (("minimum", letter.minimum), ("maximum", letter.maximum)):
            if end is None or name in told:
                continue
            undefined, within = _shares(shape, cloud, {name: end})  # as it is: its float may lie beyond it
            here, at = (_place(shape.letters, name),), f"at its {word} {float(end):g}"
            if undefined > before:
                message, share = f"{at} omega is undefined in {undefined:.0%} of the bounds", (undefined, undefined)
                yield Finding(LETTER_RANGE, here, message, "narrow its range", range=share)
            elif within == 0 and inside > SEEN / len(cloud):
                message = f"{at} the shape is empty, or outside its bounds"
                yield Finding(LETTER_RANGE, here, message, "narrow its range, or widen the bounds")


def _shares(shape: Shape, cloud: Floats, letters: Mapping[str, Any]) -> tuple[float, float]:
    """In what shares of the bounds omega is undefined, and positive."""
    values = compile(shape)(*cloud.T, letters=letters)["value"]
    return float(np.isnan(values).mean()), float((values > 0).mean())


def _place(letters: Letters, name: str) -> ModelPlace:
    letter = letters[name]
    range_text = f" in {letter.range}" if letter.range else " without a range"
    return ModelPlace(f"letter, {float(letter.default):g}{range_text}", letter.doc, name)


# Letters that are parameters of R-operations, and the values that their systems allow.
Accepts: TypeAlias = Callable[[float, bool], bool]  # a value, and whether it is taken rather than an end of a range


@dataclass(frozen=True)
class Parameter:
    """A letter that is the parameter of an R-operation, what it must be, and which of its values are not."""

    name: str
    symbol: str
    wanted: str
    wrong: tuple[str, ...]


def parameters(expression: sp.Expr, letters: Letters) -> list[Parameter]:
    """The letters that are parameters of R-operations, whose default or range is not legal throughout.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> from rsym.model.letters import Letter, as_letters
    >>> alpha = sp.Symbol("alpha", real=True)
    >>> given = as_letters({alpha: Letter(0, minimum=-1, maximum=1)})
    >>> parameters(rsym.conjunction(x, y, system=rsym.RAlpha(alpha)), given)
    [Parameter(name='alpha', symbol='alpha', wanted='in (-1, 1]', wrong=('its minimum -1',))]
    """
    found: dict[tuple[str, type], Parameter] = {}
    for part in postorder(expression):
        for kind, (symbol, wanted, accepts) in _LEGAL.items():
            if isinstance(part, kind) and part.parameters[0].is_Symbol:
                name = part.parameters[0].name
                wrong = tuple(_wrong(letters[name], accepts))
                if wrong:
                    found[name, kind] = Parameter(name, symbol, wanted, wrong)
    return list(found.values())


def _wrong(letter: Letter, accepts: Accepts) -> Iterator[str]:
    if not accepts(float(letter.default), True):
        yield f"its default {float(letter.default):g}"
    for name, end, value in (("minimum", letter.minimum, -math.inf), ("maximum", letter.maximum, math.inf)):
        if end is not None and not accepts(float(end), False):
            yield f"its {name} {float(end):g}"
        elif end is None and not accepts(value, False):
            yield f"its {name}, which is open"


_LEGAL: Mapping[type[Fold], tuple[str, str, Accepts]] = {
    RAlphaOperation: ("alpha", "in (-1, 1]", lambda a, exact: -1 < a <= 1),
    R0mOperation: ("m", "a positive integer", lambda m, exact: m >= 1 and (not exact or m == int(m))),
    RpOperation: ("p", "above 1", lambda p, exact: p > 1),
    EquivalenceOperation: ("m", "a positive integer", lambda m, exact: m >= 1 and (not exact or m == int(m))),
}


# Letters whose values or ranges a formula does not bear: divisors that vanish, roots of negative numbers.
NONZERO, NONNEGATIVE, POSITIVE = "must not be zero", "must not be negative", "must be positive"

FAR = (1.0, 10.0, 1000.0)  # steps beyond the default towards an open end, in units of 1 + |default|
ALONG = 33  # values of a letter between its ends
MOST_CORNERS = 10  # letters whose ends are all combined
SCATTERED = 2000  # values of all letters at random
HALVINGS = 40  # of the way from the default to a value that fails


@dataclass(frozen=True)
class LetterCondition:
    """An expression in letters alone, what it must not be, and what it is in the formula."""

    expression: sp.Expr
    demand: str
    role: str


@dataclass(frozen=True)
class Breach:
    """A condition that values in the ranges of letters break, the values, and whether the defaults do."""

    condition: LetterCondition
    values: Mapping[str, float]
    at_default: bool


def conditions(expression: sp.Expr, letters: Letters) -> list[LetterCondition]:
    """What the formula asks of letters alone.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.model.letters import as_letters
    >>> r = sp.Symbol("r", real=True)
    >>> [(item.expression, item.demand) for item in conditions(1 / (2 * r) + sp.sqrt(r - 1), as_letters({r: 1}))]
    [(r, 'must not be zero'), (r - 1, 'must not be negative')]
    """
    found: dict[LetterCondition, None] = {}
    for part in postorder(expression):
        inner, demand, role = _demand(part)
        if inner is not None and inner.free_symbols and all(s.name in letters for s in inner.free_symbols):
            found[LetterCondition(inner, demand, role)] = None
    return sorted(found, key=lambda one: sp.default_sort_key(one.expression))


def _demand(part: sp.Basic) -> tuple[sp.Expr | None, str, str]:
    """The argument that must be in a domain, the domain, and what it is."""
    if isinstance(part, sp.log):
        return part.args[0], POSITIVE, "argument of a logarithm"
    if not isinstance(part, sp.Pow) or part.base == sp.E:
        return None, "", ""
    if part.exp.is_Integer:
        return (part.base, NONZERO, "divisor") if part.exp < 0 else (None, "", "")
    inverse = bool(part.exp.is_negative)
    return part.base, POSITIVE if inverse or not part.exp.is_Rational else NONNEGATIVE, "radicand"


def breaches(expression: sp.Expr, letters: Letters) -> list[Breach]:
    """The conditions that some values of letters within their ranges break, those of the defaults first.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.model.letters import Letter, as_letters
    >>> a, b = sp.symbols("a b", real=True)
    >>> given = as_letters({a: Letter(3, minimum=2, maximum=5), b: Letter(1, minimum=0, maximum=4)})
    >>> (found,) = breaches(1 / (a - b), given)
    >>> found.at_default, {name: round(value, 6) for name, value in found.values.items()}
    (False, {'a': 3.0, 'b': 3.0})
    """
    found = [_breach(condition, letters) for condition in conditions(expression, letters)]
    return sorted((one for one in found if one is not None), key=lambda one: not one.at_default)


def _breach(condition: LetterCondition, letters: Letters) -> Breach | None:
    names = sorted(symbol.name for symbol in condition.expression.free_symbols)
    builder = Builder(tuple(names), ())
    bounds = IntervalFunction(builder.program({"value": lower(builder, condition.expression)}), backend="numpy")
    chosen = [letters[name] for name in names]
    start = np.array([float(letter.default) for letter in chosen])
    sign = _fails(bounds, condition, start[None], 0)
    if sign[0]:
        return Breach(condition, dict(zip(names, start.tolist(), strict=True)), True)
    side = int(np.sign(_ends(bounds, start[None])[0][0]))
    if not _fails_somewhere(bounds, condition, chosen, side):
        return None
    for trials in _trials(chosen, start):
        failing = trials[_fails(bounds, condition, trials, side)]
        if len(failing):
            nearest = failing[np.argmin(np.abs(failing - start).max(axis=1))]
            value = _first_failure(bounds, condition, start, nearest, side)
            return Breach(condition, dict(zip(names, value.tolist(), strict=True)), False)
    return None


def _ends(bounds: IntervalFunction, points: Floats) -> tuple[Floats, Floats]:
    return bounds(list(points.T), list(points.T))["value"]


def _fails(bounds: IntervalFunction, condition: LetterCondition, points: Floats, side: int) -> NDArray[np.bool_]:
    """Whether values break a condition; `side` is the sign that a divisor has at the defaults, 0 for none."""
    low, high = _ends(bounds, points)
    if condition.demand == NONNEGATIVE:
        return np.asarray(high < 0)
    if condition.demand == POSITIVE:
        return np.asarray(low <= 0)
    return np.asarray((low <= 0) & (high >= 0) if side == 0 else low * side <= 0 if side > 0 else high >= 0)


def _fails_somewhere(bounds: IntervalFunction, condition: LetterCondition, chosen: list[Letter], side: int) -> bool:
    """Whether a failure is not excluded by the bounds over all ranges at once."""
    low = [-math.inf if letter.minimum is None else float(letter.minimum) for letter in chosen]
    high = [math.inf if letter.maximum is None else float(letter.maximum) for letter in chosen]
    least, most = (float(end) for end in bounds(low, high)["value"])
    if condition.demand == NONNEGATIVE:
        return least < 0
    return least <= 0 if condition.demand == POSITIVE or side > 0 else most >= 0


def _trials(chosen: list[Letter], start: Floats) -> Iterator[Floats]:
    """Values to try: one letter at a time, then the ends of all, then some at random."""
    lines = [_along(letter) for letter in chosen]
    for column, line in enumerate(lines):
        points = np.tile(start, (len(line), 1))
        points[:, column] = line
        yield points
    if 1 < len(lines) <= MOST_CORNERS:
        yield np.array(list(itertools.product(*(sorted({*line[[0, -1]], *line[line == 0]}) for line in lines))))
    if len(lines) > 1:
        generator = np.random.default_rng(20130605)
        yield np.column_stack([generator.choice(line, SCATTERED) for line in lines])


def _along(letter: Letter) -> Floats:
    """Values of a letter over its range, ends and zero included."""
    default = float(letter.default)
    far = np.array(FAR) * (1 + abs(default))
    low = default - far if letter.minimum is None else np.array([float(letter.minimum)])
    high = default + far if letter.maximum is None else np.array([float(letter.maximum)])
    between = np.linspace(low.min() if letter.minimum is not None else default - far[0], high.min(), ALONG)
    values = np.unique([*low, *high, *between, 0.0])
    within: Floats = values[(values >= low.min()) & (values <= high.max())]
    return within


def _first_failure(
    bounds: IntervalFunction, condition: LetterCondition, start: Floats, end: Floats, side: int
) -> Floats:
    """The point nearest to the start on the way to a failure from which on the condition is broken."""
    good, bad = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (good + bad) / 2
        if _fails(bounds, condition, (start + middle * (end - start))[None], side)[0]:
            bad = middle
        else:
            good = middle
    first: Floats = start + bad * (end - start)
    return first
