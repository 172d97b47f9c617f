"""A common edge as both formulas of one parameter, on parts without pieces.

A proof takes the pieces that hold on parts of an edge, inside the patch. Where they meet the formula may say a third
thing: ``Piecewise((0, u < 1), (0, u > 1), (1, True))`` is nought but for a point. It is a function without a break only
if at each such place its own value is the limit of the pieces on both sides, by exact arithmetic. Of a place on an
edge that goes for the derivatives across the edge too: ``u*Piecewise((0, v < 1), (0, v > 1), (1, True))`` is nought on
the edge u = 0, and has a break on the line v = 1 that leads to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from rsym.program.builder import Builder
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.joints.edge_matching import Stretch
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.proofs.algebra import exact_values
from rsym.surfaces.proofs.edge_formulas import ALONG, ORDERS, EdgeJet, EdgeWalk, PatchFormula
from rsym.surfaces.proofs.enclosures import Pair
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part

POSITION = ORDERS[:1]
ACROSS = tuple(order for order in ORDERS if order[0] == 0)
AXES = 3
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


def check_unbroken(formula: PatchFormula, edge: PatchEdge, part: Part, walk: EdgeWalk, jet: EdgeJet) -> None:
    """Compare an edge with what its formula says where pieces meet on a part, which has none of its own.

    Raises
    ------
    NoProof
        It says something else there, or is not proved to say the same.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.joints.edges import PatchEdge
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.proofs.edge_formulas import ALONG
    >>> from rsym.surfaces.symbols import u, v
    >>> patch = ParametricSurface((u, v, sp.Piecewise((0, u > 0), (1, True))))
    >>> edge, formula, part = PatchEdge(patch, "v0"), PatchFormula(patch, {}), (Fraction(0), Fraction(1))
    >>> check_unbroken(formula, edge, part, ALONG, formula.jet(edge, Builder(("t",), ()), part, ALONG, POSITION))
    Traceback (most recent call last):
    ...
    rsym.surfaces.proofs.specialised.NoProof: the pieces of a formula do not meet at t = 0
    """
    for place in sorted(jet.joins):
        target = Builder((PARAMETER,), ())
        still = EdgeWalk(walk(place), Fraction(0))
        said = formula.jet(edge, target, (place, place), still, ACROSS, literal=True).nodes
        _compare(target, formula.jet(edge, target, part, walk, ACROSS).nodes, said, place)
    if jet.lies_on_border:
        target = Builder((PARAMETER,), ())
        taken, said = (
            formula.jet(edge, target, part, walk, POSITION, literal=literal).nodes[:AXES] for literal in (False, True)
        )
        _compare(target, taken, said, None)


def _compare(target: Builder, taken: Sequence[int], said: Sequence[int], place: Fraction | None) -> None:
    """Compare what the pieces make with what the formula says."""
    values = exact_values(target.nodes, [*taken, *said], place)
    if not all((a - b).is_zero for a, b in zip(values[: len(taken)], values[len(taken) :], strict=True)):
        where = "along the edge" if place is None else f"at t = {place}"
        raise NoProof(f"the pieces of a formula do not meet {where}")
