"""A common edge as both formulas of one parameter, on parts without pieces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from rsym.program.builder import Builder
from rsym.surfaces.functions.entries import exact
from rsym.surfaces.joints.edge_matching import Stretch
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.proofs.edge_formulas import ALONG, ORDERS, EdgeWalk, PatchFormula
from rsym.surfaces.proofs.enclosures import Pair
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part
from rsym.surfaces.proofs.unbroken import check_unbroken

# An end of a stretch that samples found is tried as a fraction so simple: knots and halves are, roots are not.
SIMPLE = 10_000
SNAP = 1e-9
# Two splines through fifteen points each have some thirty borders; nine splines have a hundred, which take a minute.
MOST_PARTS = 64


@dataclass(frozen=True)
class ProofTask:
    """A stretch, the formulas of its patches, what counts as none, and where the samples were worst.

    rooms: a gap (length), the sine of an angle, a jump of curvature. worst: parameters of the first edge at which the
    samples exceed them; gap: the greatest distance of the samples. even: the edges written with one parameter, and its
    interval, which take the place of those of the stretch.
    """

    stretch: Stretch
    formulas: tuple[PatchFormula, PatchFormula]
    rooms: tuple[float, float, float]
    worst: Sequence[float]
    gap: float
    even: tuple[tuple[PatchEdge, PatchEdge], Part] | None = None

    @property
    def edges(self) -> tuple[PatchEdge, PatchEdge]:
        """Both edges."""
        if self.even is not None:
            return self.even[0]
        first, second = self.stretch.borders
        return first.edge, second.edge


def ends_of(stretch: Stretch) -> tuple[Part, Part]:
    """Where a stretch begins and ends on both edges, the second as the first runs."""
    first, second = stretch.borders
    low, high = (_simple(t, first.edge.interval) for t in stretch.interval)
    start, stop = (_simple(float(s), second.edge.interval) for s in (stretch.s[0], stretch.s[-1]))
    if low == high or start == stop:
        raise NoProof("one of the edges is too short beside the other")
    return (low, high), (start, stop)


def walks(task: ProofTask) -> tuple[tuple[EdgeWalk, EdgeWalk], Part]:
    """Both parameters by that of the first edge, if they run at one speed, and the interval of it."""
    if task.even is not None:
        return (ALONG, ALONG), task.even[1]
    (low, high), (start, stop) = ends_of(task.stretch)
    speed = (stop - start) / (high - low)
    return (ALONG, EdgeWalk(start - speed * low, speed)), (low, high)


def _simple(value: float, interval: tuple[float, float]) -> Fraction:
    """An end of a stretch: an end of the edge, or a simple number next to it."""
    if value in interval:
        return Fraction(str(exact(value)))
    near = Fraction(value).limit_denominator(SIMPLE)
    return near if abs(float(near) - value) <= SNAP * (interval[1] - interval[0]) else Fraction(value)


def pairs(
    task: ProofTask, both: tuple[EdgeWalk, EdgeWalk], whole: Part, orders: Sequence[tuple[int, int]] = ORDERS
) -> list[Pair]:
    """Both patches on each part between the borders of their pieces; derivatives of other orders are taken as zero."""
    waiting = [whole]
    found: list[Pair] = []
    given = [*zip(task.formulas, task.edges, both, strict=True)]
    while waiting:
        part = waiting.pop()
        target = Builder((PARAMETER,), ())
        jets = [formula.jet(edge, target, part, walk, orders) for formula, edge, walk in given]
        borders = sorted({one for jet in jets for one in jet.borders if part[0] < one < part[1]})
        if len(borders) + len(waiting) + len(found) >= MOST_PARTS:
            raise NoProof(f"the formulas have more than {MOST_PARTS} pieces along the edge")
        if borders:
            waiting += [*pairwise([part[0], *borders, part[1]])][::-1]
        else:
            for jet, (formula, edge, walk) in zip(jets, given, strict=True):
                check_unbroken(formula, edge, part, walk, jet)
            found.append(Pair(target.nodes, [number for jet in jets for number in jet.nodes], part))
    return found
