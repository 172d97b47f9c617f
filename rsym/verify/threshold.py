"""From verdict to design: the value of a letter that separates refuted from certified."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, REFUTED, UNDECIDED, Document, Sentence, Tabular
from rsym.reports.numbers import enclosing, number
from rsym.reports.render import Report
from rsym.sampling.progress import Effort, Progress, report
from rsym.verify.smoothness import verdict_of

SCAN = 12  # parts into which the range is cut in search of a change
SCAN_BUDGET = 4_000  # boxes for each verdict: the body of Fig. 11 takes 130
TRIED = (Fraction(1, 2), Fraction(3, 8), Fraction(5, 8))  # where a bracket is cut, until a verdict falls


@dataclass(frozen=True)
class Threshold(Report):
    """The bracket: the verdict is REFUTED at `refuted` and CERTIFIED at `certified`, both proved.

    Between them nothing is said; `trials` are the values tried, with their verdicts, in order. All are floats, and the
    verdicts are those of exactly these numbers.

    Examples
    --------
    >>> print(Threshold("a2", 5.3076, 5.3078, ((5.3, "REFUTED"), (5.35, "CERTIFIED"))))
    a2 = 5.3077 (between 5.3076 and 5.3078): certified above, refuted on the other side; 2 values tried
    """

    letter: str
    refuted: float
    certified: float
    trials: tuple[tuple[float, str], ...]

    @property
    def middle(self) -> float:
        """Half way between the two."""
        return (self.refuted + self.certified) / 2

    def document(self) -> Document:
        """The bracket, rounded outwards, and what was tried."""
        low, high = sorted((self.refuted, self.certified))
        first, last = enclosing(low, high, 9)
        side = "above" if self.certified > self.refuted else "below"
        tried = Tabular((self.letter, "verdict"), tuple((number(k), word) for k, word in self.trials), told=False)
        found = f"{self.letter} = {number(self.middle, 6)} (between {first} and {last})"
        return Document(
            "threshold",
            Sentence(f"{found}: certified {side}, refuted on the other side; {len(self.trials)} values tried", True),
            tables=(tried,),
            data={
                "letter": self.letter,
                "refuted": self.refuted,
                "certified": self.certified,
                "trials": self.trials,
            },
        )


def smoothness_threshold(
    shape: Shape,
    letter: Any,
    *,
    between: tuple[Any, Any] | None = None,
    tolerance: float = 1e-5,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> Threshold:
    """Bracket the value of a letter at which the boundary becomes, or ceases to be, curvature-continuous.

    The range is scanned for neighbouring values of which one is refuted and the other certified, nearest to the
    default, and the gap is halved by further verdicts until it is narrower than `tolerance` times the size of the
    letter, or until no verdict falls inside it.

    Parameters
    ----------
    letter : str or symbol
        The name of the letter to vary; `letters` fixes others.
    between : pair of numbers, optional
        Where to search; by default the range of the letter, or half to twice its default.
    timeout : float, optional
        Seconds after which the bracket comes back as it is then: both of its ends are proved.
    progress : callable, optional
        ``progress(tried, about how many)``; an answer of False cancels.

    Raises
    ------
    RsymError
        For an unknown letter, or if no change from refuted to certified is found, within the time allowed.

    Examples
    --------
    >>> import rsym
    >>> found = rsym.smoothness_threshold(rsym.paper.skeleton_body(), "a2", between=(5.3, 5.35), tolerance=1e-3)
    >>> found.refuted < 5 + 4 / 13 < found.certified
    True
    """
    require_shape(shape)
    name = str(letter)
    values = ranges_of(shape.letters, letters)
    if name not in values:
        ranges_of(shape.letters, {name: 0})  # raises, with a proposal
    low, high = range_of(shape, name, between)
    effort = Effort(timeout=timeout)
    trials: list[tuple[float, str]] = []

    def verdict(value: Fraction) -> str:
        given = {**(letters or {}), name: value}
        result = verdict_of(shape, bounds=bounds, letters=given, budget=SCAN_BUDGET, effort=effort.again())
        trials.append((float(value), result))
        report(progress, len(trials), max(len(trials), 2 * SCAN + 1))
        return result

    low, high = map(Fraction, inward(low, high))
    default = Fraction(float(values[name][0]))
    inner = {_short(low + (high - low) * k / SCAN, (high - low) / SCAN) for k in range(1, SCAN)} | {default}
    values_tried = sorted({low, high} | {value for value in inner if low < value < high})
    start = default if low <= default <= high else (low + high) / 2
    bracket = _scan(values_tried, start, verdict, effort)
    if bracket is None and effort.is_over:
        raise RsymError(
            f"no change from REFUTED to CERTIFIED was found for {name} in the time allowed, in {len(trials)} trials",
            code="timeout",
            remedy="allow more time, or give between=(low, high) around the change",
        )
    if bracket is None:
        tried = ", ".join(f"{value:g} {word}" for value, word in sorted(trials))
        raise RsymError(
            f"no change from REFUTED to CERTIFIED was found for {name} in [{float(low):g}, {float(high):g}]: {tried}",
            code="no-threshold",
            remedy="give between=(low, high) around the change",
        )
    refuted, certified = _narrowed(*bracket, verdict, Fraction(tolerance), effort)
    return Threshold(name, float(refuted), float(certified), tuple(trials))


def range_of(shape: Shape, name: str, between: tuple[Any, Any] | None = None) -> tuple[Fraction, Fraction]:
    """Where a letter is varied: between two values, else over its own range, else from half to twice its default."""
    item = shape.letters[name]
    default = item.fraction
    half, double = sorted((default / 2, default * 2))
    low, high = between or (
        half if item.minimum is None else item.minimum,
        double if item.maximum is None else item.maximum,
    )
    return ranges_of(shape.letters, {name: (low, high)})[name]


def inward(low: Fraction, high: Fraction) -> tuple[float, float]:
    """The widest interval between floats in a range: what is said of its ends is said of the numbers as they print."""
    first, last = float(low), float(high)
    return (
        first if Fraction(first) >= low else math.nextafter(first, math.inf),
        last if Fraction(last) <= high else math.nextafter(last, -math.inf),
    )


def _scan(
    values: list[Fraction], start: Fraction, verdict: Callable[[Fraction], str], effort: Effort
) -> tuple[Fraction, Fraction] | None:
    """(refuted, certified) for the decided neighbours nearest to the start that differ so.

    At the threshold itself, which may well be a round number, the verdict is often neither.
    """
    known: dict[Fraction, str] = {}
    for value in sorted(values, key=lambda value: abs(value - start)):
        if effort.is_over:
            break
        if (word := verdict(value)) in {REFUTED, CERTIFIED}:
            known[value] = word
        for first, second in pairwise(sorted(known)):
            if {known[first], known[second]} == {REFUTED, CERTIFIED}:
                return (first, second) if known[first] == REFUTED else (second, first)
    return None


def _narrowed(
    refuted: Fraction, certified: Fraction, verdict: Callable[[Fraction], str], tolerance: Fraction, effort: Effort
) -> tuple[Fraction, Fraction]:
    while abs(certified - refuted) > tolerance * max(abs(certified), abs(refuted)):
        for share in TRIED:
            value = _short(refuted + (certified - refuted) * share, abs(certified - refuted))
            word = UNDECIDED if effort.is_over or value in (refuted, certified) else verdict(value)
            if word in {REFUTED, CERTIFIED}:
                break
        else:
            break
        refuted, certified = (value, certified) if word == REFUTED else (refuted, value)
    return refuted, certified


def _short(value: Fraction, width: Fraction) -> Fraction:
    """A nearby float with few bits: long numbers only cost time, and what is proved is said of floats."""
    step = Fraction(2) ** math.floor(math.log2(width / 64)) if width else Fraction(1)
    return Fraction(float(round(value / step) * step))
