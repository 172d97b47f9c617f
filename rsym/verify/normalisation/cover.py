"""A bound on the deviations from normalised, proved on boxes that together hold all of a boundary.

On a box B with middle m where omega is analytic and grad omega is not zero, each deviation F is continuously
differentiable, and for every number c the mean value form

    F(p) - c omega(p)  in  F(m) - c omega(m) + (grad F(B) - c grad omega(B)) . (B - m)

holds for all p in B. On the boundary omega(p) = 0, so it encloses F there. If F vanishes on the boundary,
grad F is a multiple of grad omega there; with c that multiple at m both terms are of second order in the width of B.
Only boxes where omega cannot vanish are left out: there is no sampling in the argument. The values come from the
interval backend, all boxes of a level at once; whether omega is analytic on a box is decided with balls.
Where operations keep the order, each leaf that may vanish on a box stands for omega (see `leaves`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from rsym.arrays import Flags, Floats
from rsym.backends.registry import default_backend
from rsym.bounds.balls import ctx
from rsym.bounds.intervals import Bounds, IntervalFunction
from rsym.logic.gates import Gate
from rsym.logic.stripping import Signed, unscaled
from rsym.program.builder import Builder
from rsym.sampling.progress import Effort
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import PRECISION, Box, side
from rsym.verify.cover.covering import OFF_CENTRE
from rsym.verify.normalisation.derivatives import NormalDerivatives
from rsym.verify.normalisation.leaves import active, crosses

COARSEST = 8  # boxes along the extent before a bound is tried: on wider ones it would be in vain
# Nodes of the deviations and their gradients. The program of their bounds has a dozen times as many: at the first
# number it compiles in about two seconds and runs 200 times as fast as with NumPy, at the second NumPy takes seconds.
COMPILED, LARGEST = 1_200, 6_000
# Of the sum of the sizes: fifty float64 operations round by less, and TINY is more than what they lose to underflow.
ROUNDING, TINY = 1e-14, 1e-300


@dataclass(frozen=True, eq=False)
class NormalCover:
    """Boxes (n, dim, 2) with proved bounds and those without.

    `bounds` are the largest proved, order by order, for as many orders as were tried; they hold on `crossed`, a part
    of `covered`, but where leaves meet; `exhausted` says that the number of boxes allowed was used up.
    """

    bounds: list[float]
    covered: Floats
    crossed: Floats
    uncovered: Floats
    examined: int
    exhausted: bool


def feasible_order(derivatives: NormalDerivatives) -> int:
    """The greatest order whose deviations are small enough to be bounded on boxes."""
    orders = range(1, len(derivatives.deviations) + 1)
    return next((order - 1 for order in orders if derivatives.cost(order) > LARGEST), len(orders))


def cover_boundary(
    gates: Sequence[Gate],
    leaves: Sequence[NormalDerivatives],
    bounds: Box,
    *,
    tolerance: float,
    smallest: float,
    work: float,
    effort: Effort | None = None,
) -> NormalCover:
    """Subdivide until every box is free of the boundary, has bounds below the tolerance, or is too small.

    `gates` are how omega is made of its leaves. `work` limits the number of boxes times nodes; it is spent as well when
    the time is over.
    """
    effort, allowed = effort or Effort(), work
    order = min(map(feasible_order, leaves))
    made = {leaf: Enclosure(leaf, order) for leaf in dict.fromkeys(leaves)}
    enclosures = [made[leaf] for leaf in leaves]
    region = np.array(bounds, np.float64)
    extent = float((region[:, 1] - region[:, 0]).max())
    boxes, examined = halves(region[None], OFF_CENTRE), 0
    analytic = np.zeros((len(boxes), len(leaves)), bool)
    limits, none = np.zeros(order), region[None][:0]
    covered, crossed, uncovered = [none], [none], [none]
    while len(boxes) and work > 0:
        effort.reach(1 - work / allowed)
        if effort.is_over:
            work = 0.0
            break
        examined += len(boxes)
        work -= len(boxes) * sum(enclosure.level_cost for enclosure in enclosures)
        width = float((boxes[:, :, 1] - boxes[:, :, 0]).max())
        levels = {enclosure: enclosure.level(boxes) for enclosure in made.values()}
        needed = active(gates, [levels[enclosure] for enclosure in enclosures])
        kept = needed.any(axis=1)
        boxes, analytic, needed = boxes[kept], analytic[kept], needed[kept]
        if width * COARSEST <= extent:
            for enclosure, known, used in zip(enclosures, analytic.T, needed.T, strict=True):
                known[used] = enclosure.are_analytic(boxes[used], known[used])
            work -= 2 * sum((needed & analytic).sum(axis=0) * [enclosure.cost for enclosure in enclosures])
            if work > 0:
                found = _deviations(enclosures, boxes, needed, analytic)
                settled = (found <= tolerance).all(axis=1)
                limits = np.maximum(limits, found[settled].max(axis=0, initial=0.0))
                covered.append(boxes[settled])
                crossed.append(boxes[settled & (needed.sum(axis=1) > 1)])
                boxes, analytic = boxes[~settled], analytic[~settled]
        if width <= smallest:
            uncovered.append(boxes)
            boxes = boxes[:0]
        if work > 0:
            boxes, analytic = halves(boxes, 0.5), np.repeat(analytic, 2 ** len(region), axis=0)
    left = np.concatenate([*uncovered, boxes])
    return NormalCover(
        list(map(float, limits)), np.concatenate(covered), np.concatenate(crossed), left, examined, len(boxes) > 0
    )


def _deviations(enclosures: Sequence[Enclosure], boxes: Floats, needed: Flags, analytic: Flags) -> Floats:
    """Bounds of the deviations of all leaves needed on boxes, (n, order), infinite where two are not known to cross."""
    found = np.zeros((len(boxes), enclosures[0].order))
    gradients = np.full((len(enclosures), 2, boxes.shape[1], len(boxes)), math.nan)
    for enclosure, gradient, used, known in zip(enclosures, gradients, needed.T, analytic.T, strict=True):
        found[used & ~known] = math.inf
        used = used & known
        sizes, gradient[:, :, used] = enclosure.deviations(boxes[used])
        found[used] = np.maximum(found[used], sizes)
    for first, second in combinations(range(len(enclosures)), 2):
        both = needed[:, first] & needed[:, second]
        if both.any():
            found[both] = np.where(
                crosses(gradients[first][..., both], gradients[second][..., both])[:, None], found[both], math.inf
            )
    return found


class Enclosure:
    """Bounds over boxes of what the mean value forms need."""

    def __init__(self, derivatives: NormalDerivatives, order: int) -> None:
        builder = derivatives.model.builder
        self.size, self.order, self.cost = derivatives.size, order, derivatives.cost(order)
        self._leaf = derivatives
        number, self._sign = level_of(builder, derivatives.root)
        level = builder.program({"level": number})
        self.level_cost = len(level)
        outputs = {"value": derivatives.root, "squared": derivatives.squared}
        outputs |= {f"gradient_{axis}": node for axis, node in enumerate(derivatives.gradient)}
        for k in range(order):
            outputs[f"deviation_{k}"] = derivatives.deviations[k]
            outputs |= {f"slope_{k}_{axis}": node for axis, node in enumerate(derivatives.slopes(k))}
        self._letters = derivatives.model.letters
        self._level = IntervalFunction(level)
        self._function = IntervalFunction(
            builder.program(outputs), default_backend() if self.cost <= COMPILED else "numpy"
        )

    def level(self, boxes: Floats) -> tuple[Floats, Floats]:
        """Bounds over boxes (n, dim, 2) of what is zero where the leaf is, and has its sign."""
        lower, upper = self._on(self._level, boxes)["level"]
        return (lower, upper) if self._sign > 0 else (-upper, -lower)

    def are_analytic(self, boxes: Floats, known: Flags) -> Flags:
        """On which boxes the leaf is certainly analytic; parts of a box on which it is need no second look."""
        pairs = zip(boxes, known, strict=True)
        return np.array([before or is_analytic(self._leaf, box) for box, before in pairs], bool)

    def _on(self, function: IntervalFunction, boxes: Floats) -> Bounds:
        return function(list(boxes[:, :, 0].T), list(boxes[:, :, 1].T), self._letters)

    def deviations(self, boxes: Floats) -> tuple[Floats, Floats]:
        """Bounds of the deviations where the leaf vanishes in boxes on which it is analytic, (n, order).

        And the least and the greatest components of its gradient, (2, dim, n).
        """
        middle = boxes.mean(axis=2)
        reach = np.maximum(boxes[:, :, 1] - middle, middle - boxes[:, :, 0])
        whole = self._on(self._function, boxes)
        at = self._on(self._function, np.repeat(middle[:, :, None], 2, axis=2))
        with np.errstate(all="ignore"):
            found = np.stack([self._deviation(k, reach, whole, at) for k in range(self.order)], axis=1)
        gradient = np.array([[whole[f"gradient_{axis}"][end] for axis in range(self.size)] for end in (0, 1)])
        return np.where(np.isnan(found) | (whole["squared"][0] <= 0)[:, None], math.inf, found), gradient

    def _deviation(self, k: int, reach: Floats, whole: Bounds, at: Bounds) -> Floats:
        slopes = [f"slope_{k}_{axis}" for axis in range(self.size)]
        own = [f"gradient_{axis}" for axis in range(self.size)]
        multiple = self._multiple(at, slopes, own)
        total, scale = difference(at[f"deviation_{k}"], multiple, at["value"])
        for axis in range(self.size):
            size, sizes = difference(whole[slopes[axis]], multiple, whole[own[axis]])
            total, scale = total + size * reach[:, axis], scale + sizes * reach[:, axis]
        return total + ROUNDING * scale + TINY

    @staticmethod
    def _multiple(at: Bounds, slopes: list[str], own: list[str]) -> Floats:
        """About grad F . grad omega/|grad omega|**2 at the middle; any number keeps the form valid."""
        above = sum(centre(at[a]) * centre(at[b]) for a, b in zip(slopes, own, strict=True))
        below = sum(centre(at[b]) ** 2 for b in own)
        multiple = np.asarray(above / below)
        return np.where(np.isfinite(multiple), multiple, 0.0)


def centre(bounds: tuple[Floats, Floats]) -> Floats:
    """The middle of intervals."""
    return 0.5 * (bounds[0] + bounds[1])


def difference(first: tuple[Floats, Floats], multiple: Floats, second: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """The greatest size in first - multiple*second, not rounded outwards, and the sum of the sizes of what it is of."""
    ends = multiple * second[0], multiple * second[1]
    low, high = first[0] - np.maximum(*ends), first[1] - np.minimum(*ends)
    sizes = np.maximum(np.abs(first[0]), np.abs(first[1])) + np.maximum(np.abs(ends[0]), np.abs(ends[1]))
    return np.maximum(np.abs(low), np.abs(high)), sizes


def level_of(builder: Builder, number: int) -> Signed:
    """A simpler node that vanishes wherever this one does, and the sign that makes it positive where this one is.

    Without constant factors, and omega of omega/sqrt(omega**2 + q).
    """
    sign = 1
    while True:
        number, turned = unscaled(builder, number)
        sign *= turned
        operation, arguments, _ = builder.nodes[number]
        if operation != "normalised":
            return Signed(number, sign)
        number = arguments[0]


def is_analytic(derivatives: NormalDerivatives, box: Floats) -> bool:
    """Whether the function is certainly analytic on the box."""
    with ctx.workprec(PRECISION):
        local = derivatives.model.on([side(float(low), float(high)) for low, high in box])
        return generators(local, derivatives.root).analytic


def halves(boxes: Floats, share: float) -> Floats:
    """The boxes cut in two across every coordinate, the parts of each together.

    Examples
    --------
    >>> halves(np.array([[[0.0, 1.0]], [[4.0, 8.0]]]), 0.5)[:, 0].tolist()
    [[0.0, 0.5], [0.5, 1.0], [4.0, 6.0], [6.0, 8.0]]
    """
    for axis in range(boxes.shape[1]):
        at = boxes[:, axis, 0] + share * (boxes[:, axis, 1] - boxes[:, axis, 0])
        parts = np.repeat(boxes, 2, axis=0)
        parts[0::2, axis, 1], parts[1::2, axis, 0] = at, at
        boxes = parts
    return boxes
