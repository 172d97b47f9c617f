"""Is a function normalised on its boundary? Proved, refuted, or honestly left open."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.logic.gates import Gate
from rsym.model.equation import with_exact_letters
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.sampling.lattice import lattice_over
from rsym.sampling.outlines import known_outline
from rsym.sampling.plane import plane_sampler
from rsym.sampling.progress import Effort, Progress, Stages
from rsym.sampling.smooth import smooth_mesh
from rsym.sampling.windows import outer_bounds
from rsym.verify.boxes.lacking import lacking
from rsym.verify.boxes.local import Box, Model
from rsym.verify.cover.box_arrays import listed
from rsym.verify.normalisation.cover import NormalCover, cover_boundary, feasible_order
from rsym.verify.normalisation.derivatives import NormalDerivatives
from rsym.verify.normalisation.leaves import leaves_of
from rsym.verify.normalisation.places import breaks, enclosed, inside, onto_boundary, thinned, zoomed
from rsym.verify.normalisation.report import NormalDerivative, NormalisationReport

SMALLEST = 2.0**-14  # of the extent: a box of this size without a bound is left uncovered
BESIDE = 1e-6  # of a cell: lines have points on corners, from where no deviation can be followed and enclosed
TRIED = 4  # points of the boundary, where the worst one is not proved
WORK = 5e8  # the body of Fig. 11 takes a twentieth of it


def verify_normalisation(
    shape: Shape,
    order: int = 1,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    resolution: int | Sequence[int] = 128,
    tolerance: float = 1e-3,
    work: float = WORK,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> NormalisationReport:
    """Prove or refute that omega is normalised to an order m, each derivative within a tolerance.

    On omega = 0, with the inner unit normal nu: d omega/d nu = 1 and d^k omega/d nu^k = 0 for k = 2..m. These are
    derivatives along the straight line with the direction of nu.

    1. The boundary is sampled (level lines, in space the vertices of a mesh), the largest deviation of each order
       followed to where it is largest, and enclosed there at high precision. A deviation above the tolerance at a
       point proved to lie on the boundary refutes.
    2. If nothing refutes, the bounds are subdivided. Boxes where omega certainly has no zero are left out; on the
       others a mean value form bounds the deviations on the part of the box with omega = 0. Bounds below the
       tolerance on all of them certify. Boxes on which omega is not analytic, or that grow too small or
       too many, are left uncovered, and named.
    3. At corners and edges omega has no gradient; the verdict is on the boundary without them, and says so. Near one
       each leaf is bounded by itself, if the operations keep the order, and leaves are proved to cross.

    Parameters
    ----------
    shape : Shape
        In the plane or in space. In space a proof takes very many boxes: the default tolerance is out of reach even
        for an ellipsoid, 0.1 or more is not; the worst deviations are found all the same.
    order : int
        m >= 1. Derivatives of what `normalise` gave grow tenfold with each order: the bound for order 2 of
        a normalised ellipse takes seconds, that of the body of Fig. 11 is not sought (38 926 nodes), and
        order 3 of `normalise(shape, order=3)` takes minutes before its worst places are known.
    bounds, letters
        Override those of the shape. A letter is a number, taken at its exact value.
    resolution : int
        Cells for the search for the boundary.
    tolerance : float
        The greatest deviation that counts as normalised; that of order k has the dimension length**(1 - k).
    work : float
        The greatest number of boxes times nodes to enclose.
    timeout : float, optional
        Seconds after which the subdivision ends; the search of the boundary before it is not cut short.
    progress : callable, optional
        ``progress(done, total)`` of the subdivision; an answer of False cancels.

    Returns
    -------
    NormalisationReport
        ``.verdict``, ``.worst``, ``.proved_bounds``, ``.singular``, ``.uncovered``; ``str(report)`` is a paragraph.

    Raises
    ------
    RsymError
        Without bounds, for an order that is not a positive integer, a tolerance that is not positive, a letter
        that is a range.

    Source: the definition after Rvachev (1982); Shapiro and Suplin (1).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-1.5, 1.5), (-1.5, 1.5)))
    >>> report = rsym.verify_normalisation(disc, resolution=32)
    >>> report.verdict, round(report.worst[0].deviation, 9), report.worst[0].proved
    ('REFUTED', 1.0, True)
    >>> report = rsym.verify_normalisation(rsym.normalise(disc), resolution=32, tolerance=0.01)
    >>> report.verdict, report.proved_bounds[0] <= 0.01
    ('CERTIFIED', True)
    """
    _check(shape, order, tolerance)
    shape, letters = with_exact_letters(shape, letters)
    effort = Effort(progress, timeout)
    box: Box = outer_bounds(shape, bounds, ranges_of(shape.letters, letters))
    derivatives = NormalDerivatives(_model(shape, letters), order)
    extent = max(high - low for low, high in box)
    points, ends, cell, remarks = _boundary(shape, derivatives, box, resolution)
    points, arrived = onto_boundary(derivatives, points, cell)
    kept = inside(points, box)
    points, arrived = points[kept], arrived[kept]
    regular = derivatives.at(points).regular & arrived
    broken = breaks(derivatives, *ends, cell)
    singular = [points[~regular], broken[inside(broken, box)]]
    apart = np.array(
        [np.linalg.norm(broken - point, axis=1).min(initial=cell) > BESIDE * cell for point in points], bool
    )
    worst = _worst(derivatives, points[regular & apart], cell, box)
    refuted = any(place.proved and abs(place.deviation) - place.error > tolerance for place in worst)
    exists = any(place.proved for place in worst) or _has_point(derivatives, points[regular & apart], box)
    found, none = None, np.empty((0, len(box), 2))
    gates, leaves = ((), [derivatives]) if refuted else _leaves(shape, derivatives, order)
    if not refuted and all(map(feasible_order, leaves)):
        effort.begin("boxes", Stages.TOTAL)
        smallest = SMALLEST * extent
        found = cover_boundary(gates, leaves, box, tolerance=tolerance, smallest=smallest, work=work, effort=effort)
        effort.finish()
        if not found.exhausted:
            singular.append(found.uncovered.mean(axis=2))
    return NormalisationReport(
        verdict=REFUTED if refuted else _verdict(worst, found, exists),
        order=order,
        tolerance=float(tolerance),
        worst=worst,
        proved_bounds=_proved(found, order),
        covered=none if found is None else found.covered,
        crossed=none if found is None else found.crossed,
        uncovered=none if found is None else found.uncovered,
        singular=thinned(np.vstack(singular), 4 * cell),
        bounds=box,
        letters={name: (float(low), float(high)) for name, (low, high) in derivatives.model.letters.items()},
        samples=int(regular.sum()),
        examined=0 if found is None else found.examined,
        statements=(
            *((remark, False) for remark in remarks),
            *([] if refuted else _statements(leaves, found)),
            *([] if found is None else lacking(derivatives.model, listed(found.uncovered))),
            *effort.statements,
        ),
    )


def _check(shape: Any, order: Any, tolerance: Any) -> None:
    require_shape(shape)
    if isinstance(order, bool) or not isinstance(order, int) or order < 1:
        raise RsymError(f"the order must be a positive integer, got {order!r}", code="order", remedy="use order=1")
    if not tolerance > 0:
        raise RsymError(f"the tolerance must be positive, got {tolerance}", code="tolerance", remedy="use 1e-3")


def _model(shape: Shape, letters: Mapping[Any, Any] | None) -> Model:
    values = ranges_of(shape.letters, letters)
    ranges = [name for name, (low, high) in values.items() if low != high]
    if ranges:
        raise RsymError(
            f"the letter {ranges[0]} has a range; verify_normalisation takes numbers", code="range", remedy="a number"
        )
    return Model(shape, values, signs=False)


def _leaves(
    shape: Shape, derivatives: NormalDerivatives, order: int
) -> tuple[tuple[Gate, ...], list[NormalDerivatives]]:
    """How leaves make up omega to an order, and the derivatives of each occurrence of a leaf."""
    gates, nodes = leaves_of(derivatives.model, shape.expression, order)
    made = {node: NormalDerivatives(derivatives.model, order, node) for node in set(nodes) - {derivatives.root}}
    return gates, [made.get(node, derivatives) for node in nodes]


def _boundary(
    shape: Shape, derivatives: NormalDerivatives, box: Box, resolution: int | Sequence[int]
) -> tuple[NDArray[np.float64], tuple[NDArray[np.float64], NDArray[np.float64]], float, Sequence[str]]:
    """Points of the boundary, the ends of the edges between them, the size of a cell, and remarks."""
    values = {name: float(low) for name, (low, _) in derivatives.model.letters.items()}
    lattice = lattice_over(box, resolution)
    none = np.empty((0, len(box)))
    if shape.dimension == 2:
        sampler = plane_sampler(shape, "value", resolution=resolution, bounds=box, letters=values)
        found = known_outline(sampler, cut=True)
        lines, remarks = found.lines, (found.status.remark,) if found.status.remark else ()
        points = np.vstack([none, *lines])
        edges = np.vstack([none, *(line[:-1] for line in lines)]), np.vstack([none, *(line[1:] for line in lines)])
        return points, edges, max(lattice.spacing), remarks
    try:
        surface = smooth_mesh(shape, lattice, values, None, None)
    except RsymError as error:
        if error.code != "no-surface":
            raise
        return none, (none, none), max(lattice.spacing), ()
    first, second = np.unique(np.sort(surface.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0).T
    ends = surface.vertices[first], surface.vertices[second]
    return surface.vertices, ends, max(lattice.spacing), surface.status.brief


def _worst(
    derivatives: NormalDerivatives, points: NDArray[np.float64], cell: float, bounds: Box
) -> tuple[NormalDerivative, ...]:
    """The largest deviation of each order."""
    if not len(points):
        return ()
    sizes = np.abs(derivatives.at(points).deviations)
    starts = [points[int(np.argmax(column))] for column in sizes.T]
    places = [zoomed(derivatives, start, k, cell, bounds) for k, start in enumerate(starts)]
    return tuple(enclosed(derivatives, list(place), k, bounds) for k, place in enumerate(places))


def _has_point(derivatives: NormalDerivatives, points: NDArray[np.float64], bounds: Box) -> bool:
    """Whether a point of the boundary is proved, by some of those found: the worst one may be next to a corner."""
    some = points[:: max(1, len(points) // TRIED)]
    return any(enclosed(derivatives, point.tolist(), 0, bounds).proved for point in some)


def _verdict(worst: Sequence[NormalDerivative], found: NormalCover | None, exists: bool) -> str:
    """The strongest word that the evidence bears: that there is no boundary is proved by boxes, not by samples."""
    if found is not None and not (found.exhausted or len(found.covered) or len(found.uncovered)):
        return DEGENERATE
    if not worst:
        return UNDECIDED
    complete = found is not None and not len(found.uncovered) and len(found.bounds) == len(worst)
    return CERTIFIED if complete and exists else UNDECIDED


def _statements(leaves: Sequence[NormalDerivatives], found: NormalCover | None) -> list[tuple[str, bool]]:
    result = []
    largest = min(leaves, key=feasible_order)
    tried = feasible_order(largest)
    if tried < len(largest.deviations):
        text = f"no bound is sought for order {tried + 1} and above: {largest.cost(tried + 1)} nodes are too many"
        result.append((text, False))
    if found is None:
        return result
    if found.exhausted:
        result.append(("the work allowed was used up before all boxes were settled", False))
    if not found.exhausted and not len(found.covered) and not len(found.uncovered):
        result.append(("omega has no zero within the bounds", True))
    return result


def _proved(found: NormalCover | None, order: int) -> tuple[float, ...]:
    """The proved bounds, NaN for orders without one."""
    bounds = found.bounds if found is not None and len(found.covered) else []
    return (*bounds, *[math.nan] * (order - len(bounds)))
