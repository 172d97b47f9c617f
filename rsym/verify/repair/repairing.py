"""Repair: candidates for a boundary of continuous curvature, each proved, each with its price.

Along every family of moves the smallest change that certifies is sought.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.model.requirements import require_positive, require_shape
from rsym.model.shape import Shape
from rsym.model.wording import listing, proposal
from rsym.reports.document import CERTIFIED, REFUTED
from rsym.reports.numbers import at_most, number
from rsym.sampling.progress import Effort, Progress, report
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.blending import PaskoBlend, RhoBlend
from rsym.verify.repair.moves import LetterMove, Move, MoveFamily, Request, Round, short
from rsym.verify.repair.prices import measured, price
from rsym.verify.repair.report import Candidate, Rejected, RepairReport
from rsym.verify.smoothness import verdict_of, verify_smoothness

GENTLER = 10  # the second size that is offered is at least so many times the first
DIGITS = (3, 4, 6, 9)  # of a size that was narrowed down, as few as certify: three add at most a hundredth
ENOUGH = 1000  # a size is not narrowed down closer than a share of this: it is rounded to three digits
QUICK = 4_000  # boxes for a verdict on the way: the body of Fig. 11 takes 130
NARROWED = 12  # verdicts that narrow a letter down
# The moves that are known by name.
MOVES: Mapping[str, Move] = MappingProxyType(
    {move.name: move for move in (LetterMove(), Round(), RhoBlend(), PaskoBlend())}
)


def repair(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    moves: Sequence[str | Move] | None = None,
    vary: Sequence[Any] | None = None,
    curvature: float | None = None,
    radius: float | None = None,
    tolerance: float = 1e-5,
    method: str = "auto",
    timeout: float | None = None,
    progress: Progress | None = None,
) -> RepairReport:
    """Candidates for the smallest change that makes the boundary curvature-continuous (G2); the shape is not changed.

    Each declared move is tried at growing sizes until `verify_smoothness` certifies the result:

    - "letter": one letter goes to the nearest value that certifies, up or down within its range; between sizes tried
      the threshold is bracketed by verdicts.
    - "round": roots r that vanish at the defects become sqrt(r**2 + eps**2).
    - "rho": edges of conjunctions and disjunctions become cubic rho-blends, G2, nothing moved outside a tube.
    - "pasko": edges become displacement blends, analytic, everything moved a little.

    Sizes of the last three are shares of the extent of the bounds, from a thousandth to a tenth; the smallest that
    certifies is offered, and one ten times larger that bends less. For bodies that do not turn about an axis they are
    a thirtieth and a tenth: there a verdict takes minutes, the longer the smaller the fillet.

    Parameters
    ----------
    shape : Shape
        In the plane or in space; a body of revolution is judged by its meridian, and bodies come back.
    bounds : sequence of pairs, optional
        The statements are about the boundary within these; by default the bounds of the shape.
    letters : mapping, optional
        Values by name, numbers.
    moves : sequence of str or Move, optional
        The moves to try, by default all; a move of your own is a `Move` with its families.
    vary : sequence of names, optional
        The letters that may be moved, by default all.
    curvature : float, optional
        The largest curvature allowed, in 1/length: only shapes whose proved bound keeps it are candidates.
    radius : float, optional
        The size of roundings and blends, a length, in place of those tried.
    tolerance : float
        How closely the threshold of a letter is bracketed, as a share of its size.
    method : str
        That of `verify_smoothness`.
    timeout : float, optional
        Seconds after which nothing more is tried: what was not is rejected, and the candidates so far come back.
    progress : callable, optional
        ``progress(verdicts, about how many)``, also within a verdict; an answer of False cancels.

    Returns
    -------
    RepairReport
        ``.before``, ``.candidates`` (those that move the boundary least first), ``.rejected``, ``.needed``;
        ``str(report)`` is text.

    Raises
    ------
    RsymError
        Without bounds, for unknown letters or moves, letters that are ranges, sizes that are not positive.

    Source: smooth maxima and minima; Rvachev (1982) for the rho-blend, Pasko and Savchenko (1994) for displacements.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=((-0.5, 1.5), (-0.5, 1.5)))
    >>> found = rsym.repair(quadrant, moves=["rho"], radius=0.1)
    >>> found.before.verdict, [one.report.continuity for one in found.candidates]
    ('REFUTED', ['G2'])
    """
    shape = _fixed(shape, bounds, letters)
    request = _request(shape, vary, radius, curvature, tolerance)
    chosen = chosen_moves(moves)
    effort = Effort(timeout=timeout)
    before = verify_smoothness(shape, method=method, timeout=timeout, progress=within(progress, 0, 1))
    judge = RepairJudge(before, curvature, method, progress, effort=effort)
    if not judge.failure(before):
        return RepairReport(shape, before, (), (), needed=False)
    families = [family for move in chosen for family in move.families(Request(shape, before, *request))]
    judge.total = sum(len(family.sizes) + NARROWED * (family.unit is not None) for family in families)
    found = [outcome for family in families for outcome in outcomes(family, shape, judge, tolerance)]
    good = _distinct(outcome for outcome in found if not outcome.failure)
    bad = [Rejected(outcome.move, outcome.text, outcome.failure) for outcome in found if outcome.failure]
    return _priced(shape, before, good, bad)


def _distinct(found: Iterable[Outcome]) -> list[Outcome]:
    """Each shape once: what does not depend on a size comes with every size."""
    return list({outcome.shape: outcome for outcome in reversed(list(found))}.values())


def _fixed(shape: Shape, bounds: Any, letters: Mapping[Any, Any] | None) -> Shape:
    """The shape with the bounds and the values that are asked for."""
    require_shape(shape)
    for name, (low, high) in ranges_of(shape.letters, letters).items():
        if low != high:
            raise RsymError(
                f"the letter {name} has a range; repair takes numbers", code="range", remedy="vary=[...] names letters"
            )
    stated = bounds is None and shape.bounds is not None  # as exact numbers
    window = shape if stated else shape.replace(bounds=bounds_or_extent(shape, bounds, letters))
    return window.with_letters(letters or {})


def _request(
    shape: Shape, vary: Sequence[Any] | None, radius: Any, curvature: Any, tolerance: Any
) -> tuple[Fraction | None, list[str] | None]:
    for name, value in (("radius", radius), ("curvature", curvature), ("tolerance", tolerance)):
        if value is not None:
            require_positive(name, value, f"{name}=0.01")
    if vary is not None and (isinstance(vary, str) or not isinstance(vary, Sequence)):
        raise RsymError(f"vary must be a list of letters, got {vary!r}", code="letters", remedy=f'such as ["{vary}"]')
    names = None if vary is None else [str(name) for name in vary]
    for name in names or []:
        shape.letters.values_with({name: shape.letters[name].default if name in shape.letters else 0})
    return None if radius is None else Fraction(str(float(radius))), names


def _priced(shape: Shape, before: Any, good: list[Outcome], bad: list[Rejected]) -> RepairReport:
    """Candidates with their prices, sorted; a boundary that leaves the bounds by the change is none."""
    if not good:
        return RepairReport(shape, before, (), tuple(bad))
    original = measured(shape, before)
    candidates = []
    for one in good:
        assert one.report is not None
        new = measured(one.shape, one.report)
        if math.isnan(new.volume) and not math.isnan(original.volume):
            bad.append(Rejected(one.move, one.text, "the boundary leaves the bounds, within which it is certified"))
            continue
        cost = price(original, new, one.report)
        candidates.append(Candidate(one.shape, one.move, one.text, one.report, cost, one.note))
    candidates.sort(key=lambda one: (one.price.distance, one.price.curvature_bound))
    return RepairReport(shape, before, tuple(candidates), tuple(bad))


def chosen_moves(moves: Sequence[str | Move] | None) -> list[Move]:
    """The moves that are asked for, by name or as they are; all that are known for None.

    Examples
    --------
    >>> [move.name for move in chosen_moves(["round"])]
    ['round']
    """
    names = list(MOVES) if moves is None else moves
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise RsymError(f"moves must be a list, got {moves!r}", code="move", remedy=f"such as {list(MOVES)[:2]}")
    for name in names:
        if not isinstance(name, Move) and name not in MOVES:
            raise RsymError(
                f"no move {name!r}; the moves are: {listing(MOVES)}",
                code="move",
                remedy=proposal(name, MOVES, "use one of these, or a Move of your own"),
            )
    return [name if isinstance(name, Move) else MOVES[name] for name in names]


@dataclass
class RepairJudge:
    """Asks for verdicts, counts them, and says whether they are good enough."""

    before: Verdict
    curvature: float | None = None
    method: str = "auto"
    progress: Progress | None = None
    total: int = 0
    effort: Effort = field(default_factory=Effort)
    asked: int = field(default=0, init=False)

    def report(self, shape: Shape) -> Verdict:
        """The whole verdict."""
        self._count()
        progress = within(self.progress, self.asked, self._expected())
        return verify_smoothness(shape, method=self.method, timeout=self.effort.left, progress=progress)

    def quick(self, shape: Shape) -> str:
        """What a shape lacks, as far as a verdict without a sharp bound of the curvature tells."""
        if self.method != "auto":
            return self.failure(self.report(shape))
        self._count()
        word = verdict_of(shape, bounds=None, letters=None, budget=QUICK, effort=self.effort.again())
        if word != CERTIFIED or self.curvature is None:
            return "" if word == CERTIFIED else word
        return self.failure(self.report(shape))

    def failure(self, verdict: Verdict) -> str:
        """What a verdict lacks."""
        if verdict.verdict != CERTIFIED:
            return verdict.verdict
        if self.curvature is not None and verdict.curvature_bound > self.curvature:
            bound = at_most(verdict.curvature_bound)
            return f"certified, but the curvature is only bounded by {bound}, not by {number(self.curvature)}"
        return ""

    def judged(self, shape: Shape, *, last: bool) -> tuple[Verdict | None, str]:
        """A verdict and what it lacks; none where a quick look shows that it lacks something nobody will go on from."""
        if last or isinstance(self.before, BodyReport):  # the verdict on a body takes a minute
            failure = self.quick(shape)
            if failure and (last or failure != REFUTED):
                return None, failure
        verdict = self.report(shape)
        return verdict, self.failure(verdict)

    def _count(self) -> None:
        self.asked += 1
        report(self.progress, self.asked, self._expected())

    def _expected(self) -> int:
        return max(self.total, self.asked + 1)


@dataclass(frozen=True, eq=False)
class Outcome:
    """A changed shape, what was done, and its verdict; `failure` says what it lacks, nothing if it lacks nothing."""

    move: str
    text: str
    shape: Shape
    report: Verdict | None
    failure: str = ""
    note: str = ""


def outcomes(family: MoveFamily, shape: Shape, judge: RepairJudge, tolerance: float) -> list[Outcome]:
    """The smallest changes of a family that are good enough; else one outcome that says why there are none."""
    tried: list[Outcome] = []
    for position, size in enumerate(family.sizes):
        if judge.effort.is_over:
            return [Outcome(family.move, family.what, shape, None, f"{len(tried)} tried when the time allowed ended")]
        outcome = attempt(family, shape, size, judge)
        if outcome is None:
            return [Outcome(family.move, family.what, shape, None, "it has nothing to change at the defects")]
        tried.append(outcome)
        if outcome.failure:
            continue
        if family.unit is None:
            return [outcome, *_gentler(family, shape, position, judge)]
        before = family.sizes[position - 1] if position else Fraction(0)
        narrowed = _narrowed(family, shape, (before, size), judge, tolerance)
        return [outcome if narrowed.failure and judge.effort.is_over else narrowed]
    last = tried[-1]
    return [Outcome(family.move, family.what, shape, last.report, f"{len(tried)} tried, the last {last.failure}")]


def attempt(family: MoveFamily, shape: Shape, size: Fraction, judge: RepairJudge) -> Outcome | None:
    """A change of this size, applied until it helps; None if there is nothing to change."""
    verdict: Verdict | None = judge.before
    current, words, failure = shape, list[str](), ""
    try:
        for _ in range(family.rounds):
            found = None if verdict is None else family.step(current, verdict, size)
            if found is None and words and verdict is not None and family.rest is not None:
                found = family.rest(current, verdict, size)
            if found is None:
                break
            current = found[0]
            words.append(found[1])
            verdict, failure = judge.judged(current, last=family.rounds == 1)
            if not failure:
                break
    except RsymError as error:
        if error.code == "cancelled":
            raise
        verdict, failure = None, error.message
    return Outcome(family.move, "; then ".join(words), current, verdict, failure) if words or failure else None


def within(progress: Progress | None, done: int, total: int) -> Progress | None:
    """The progress of one verdict among many: the count stands still, an answer of False cancels.

    Examples
    --------
    >>> within(lambda done, total: print(done, "of", total), 2, 5)(900, 1000)
    2 of 5
    """
    return None if progress is None else lambda *_: progress(done, total)


def _gentler(family: MoveFamily, shape: Shape, position: int, judge: RepairJudge) -> list[Outcome]:
    """A much larger size that is good too, the smallest tried."""
    first = family.sizes[position]
    for size in family.sizes[position + 1 :]:
        if size >= GENTLER * first and not judge.effort.is_over:
            outcome = attempt(family, shape, size, judge)
            if outcome is not None and not outcome.failure:
                return [outcome]
    return []


def _narrowed(
    family: MoveFamily, shape: Shape, bracket: tuple[Fraction, Fraction], judge: RepairJudge, tolerance: float
) -> Outcome:
    """The smallest good size within the tolerance, in few digits, and what is known of a smaller one."""
    assert family.unit is not None
    bad, good = bracket
    note = ""
    while good - bad > max(Fraction(tolerance) * family.unit, good / ENOUGH) and not judge.effort.is_over:
        # Long fractions cost time: the verdict is about exact numbers.
        middle = round((bad + good) / 2, 1 - Decimal(float(good - bad)).adjusted())
        found = family.step(shape, judge.before, middle)
        failure = judge.quick(found[0]) if found is not None else "nothing"
        if failure:
            bad = middle
            if found is not None and failure == REFUTED:
                note = f"{found[1]} is not enough, REFUTED"
        else:
            good = middle
    for size in (*(short(float(good), digits, up=True) for digits in DIGITS), good):
        outcome = attempt(family, shape, size, judge)
        if outcome is not None and not outcome.failure:
            break
    assert outcome is not None
    return replace(outcome, note=note)
