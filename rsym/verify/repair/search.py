"""The search along one family for the smallest change that certifies."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from decimal import Decimal
from fractions import Fraction

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, REFUTED
from rsym.reports.numbers import at_most, number
from rsym.sampling.progress import Effort, Progress, report
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.moves import MoveFamily, short
from rsym.verify.smoothness import verdict_of, verify_smoothness

GENTLER = 10  # the second size that is offered is at least so many times the first
DIGITS = (3, 4, 6, 9)  # of a size that was narrowed down, as few as certify: three add at most a hundredth
ENOUGH = 1000  # a size is not narrowed down closer than a share of this: it is rounded to three digits
QUICK = 4_000  # boxes for a verdict on the way: the body of Fig. 11 takes 130


@dataclass(frozen=True, eq=False)
class Outcome:
    """A changed shape, what was done, and its verdict; `failure` says what it lacks, nothing if it lacks nothing."""

    move: str
    text: str
    shape: Shape
    report: Verdict | None
    failure: str = ""
    note: str = ""


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


def within(progress: Progress | None, done: int, total: int) -> Progress | None:
    """The progress of one verdict among many: the count stands still, an answer of False cancels.

    Examples
    --------
    >>> within(lambda done, total: print(done, "of", total), 2, 5)(900, 1000)
    2 of 5
    """
    return None if progress is None else lambda *_: progress(done, total)


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
