"""Gaps in a shape that are thinner than the cells of a rule, so that what lives on cells ties their sides together.

A gap is crossed along a normal of the boundary, from a point of the rule outwards, back into the shape within a cell.
It keeps its sides apart if no short way inside leads around it: of a notch the two sides meet below.
"""

from __future__ import annotations

from itertools import combinations, pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import cKDTree

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.quadrature import Quadrature

STEPS = 20  # of half the length each: a gap is seen down to a millionth of a cell
SHARPER = 14  # halvings of the step in which a normal comes in again
SEEN = 32  # points in a cell of which is asked whether they see each other
FEW, MORE = 5, 64  # points in a cell that normals are followed from, and where one has come in again
# In cells: a way around that is as short does no harm; steps of ways, and the lattice that they go over.
AROUND, STEP, MESH = 4.0, 0.75, 2
CLOSE = 4  # points along a side of a cell
# A notch becomes thinner towards its end: so much, at least, within half of such a way.
THINNER = 0.8
TOUCHING = 1e-3
ALIKE = 1e-9  # of directions, and of cells
BESIDE = 0.05  # of a cell: where is looked for inside beside a contact
PARALLEL = 0.5  # the cosine of the angle between two leaves in a cell where they may touch
MOST_CONTACTS = 256  # cells that are looked at
HALVINGS = 40
AT_ONCE = 64  # crossings whose ways are looked for at once
PAIRS = 2**18  # of points and leaves that are looked at at once


class Gap(NamedTuple):
    """Where a shape has a gap: the middle of it, its width, and the parts on both sides.

    side : of cells that lie in it from wall to wall, less than its width if it is askew to them; 0 of a contact.

    Examples
    --------
    >>> Gap((0.5, 0.0), 0.02, ("left", "right"), 0.02).width
    0.02
    """

    point: tuple[float, ...]
    width: float
    parts: tuple[str, str]
    side: float


def thin_gap(functions: Any, rule: Quadrature) -> Gap | None:
    """The thinnest gap that is thinner than the cells of a rule and keeps apart what lies on both sides; or None.

    A gap askew to the cells is so, too, where both sides are in one of them. If there is no gap, a contact of leaves in
    a cell that holds more than one side of it. functions : the leaves that the rule was made of.

    Examples
    --------
    >>> import rsym
    >>> from rsym.sampling.rules.quadrature import prepared
    >>> discs = prepared(rsym.disc(1, (-1.1, 0)) | rsym.disc(1, (1.1, 0)), None, None)
    >>> round(thin_gap(discs.functions, discs.rule(16, 8)).width, 2), thin_gap(discs.functions, discs.rule(32, 8))
    (0.2, None)
    """
    contacts = _contacts(functions, rule)
    near = np.array([contact.point for contact in contacts]).reshape(-1, functions.dimension)
    return _thinnest(functions, rule, near) or next(iter(contacts), None)


def _thinnest(functions: Any, rule: Quadrature, contacts: Floats) -> Gap | None:
    """The thinnest gap; where leaves touch, (k, dim), there is none."""
    boundary, size = rule.boundary, rule.grid.size
    few = _few(boundary.cells, FEW)
    met = np.isfinite(_crossed(functions, boundary.points[few].T, boundary.normals[few].T, size))
    if not met.any():
        return None
    some = _few(boundary.cells, MORE)
    some = some[np.isin(boundary.cells[some], boundary.cells[few[met]])]
    width = _crossed(functions, boundary.points[some].T, boundary.normals[some].T, size)
    # The thinnest crossing from each cell.
    order = np.lexsort((width, boundary.cells[some]))
    order = order[np.unique(boundary.cells[some][order], return_index=True)[1]]
    order = order[(width[order] < size) | _fall_apart(functions, rule, boundary.cells[some[order]])]
    if not len(order):
        return None
    some, width = some[order], width[order]
    start, normal = boundary.points[some].T, boundary.normals[some].T
    held = _ways(functions, rule, start, normal, width) > AROUND * size
    if len(contacts):
        held &= cKDTree(contacts).query(start.T)[0] > AROUND / 2 * size
    _let_notches(start, width, AROUND / 2 * size, held)
    if not held.any():
        return None
    thinnest = int(np.argmin(np.where(held, width, np.inf)))
    middle = start[:, thinnest] + normal[:, thinnest] * width[thinnest] / 2
    across = start[:, thinnest] + normal[:, thinnest] * width[thinnest]
    other = boundary.leaves[int(np.argmin(np.sum((boundary.points - across) ** 2, axis=1)))]
    one, two = sorted((rule.parts[boundary.leaves[some[thinnest]]], rule.parts[other]))
    side = float(width[thinnest] / np.abs(normal[:, thinnest]).sum())
    return Gap(tuple(float(place) for place in middle), float(width[thinnest]), (one, two), side)


def _few(cells: Ints, most: int) -> Ints:
    """Some things that lie in cells, at most so many in each."""
    order = np.argsort(cells, kind="stable")
    _, first, counts = np.unique(cells[order], return_index=True, return_counts=True)
    rank, count = np.arange(len(cells)) - np.repeat(first, counts), np.repeat(counts, counts)
    found: Ints = np.sort(order[rank * most // count != (rank - 1) * most // count])
    return found


def signs(functions: Any, points: Floats) -> Floats:
    """The signs of the form at points (dim, n)."""
    size = max(1, PAIRS // functions.count)
    some = [functions.sign(points[:, first : first + size]) for first in range(0, points.shape[1], size)]
    return np.concatenate(some) if some else np.empty(0)


def _crossed(functions: Any, start: Floats, normal: Floats, size: float) -> Floats:
    """How far from boundary points, along outward normals, the shape begins again; infinite if not within a cell.

    That is the way from corner to corner.
    """
    far = size * np.append(0.5 ** np.arange(STEPS, -1, -1), [(1 + len(start) ** 0.5) / 2, len(start) ** 0.5])
    points = start[:, None] + far[:, None] * normal[:, None]
    inside = signs(functions, points.reshape(len(start), -1)).reshape(len(far), -1) > 0
    back = np.logical_or.accumulate(~inside, axis=0) & inside
    width = np.where(back.any(axis=0), far[np.argmax(back, axis=0)], np.inf)
    met = np.flatnonzero(np.isfinite(width))
    low, high = far[np.argmax(back[:, met], axis=0) - 1], width[met]
    for _ in range(SHARPER):
        middle = (low + high) / 2
        inside = signs(functions, start[:, met] + middle * normal[:, met]) > 0
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    width[met] = high
    return width


def _fall_apart(functions: Any, rule: Quadrature, cells: Ints) -> Flags:
    """Whether some points of a rule in each of some cells do not all see each other, one by the other, in the shape."""
    every = np.flatnonzero(np.isin(rule.cells, cells))
    every = every[_few(rule.cells[every], SEEN)]
    points, owner = rule.points[every].T, rule.cells[every]
    apart = [np.stack(np.triu_indices(int(n), 1)) for n in np.unique(owner, return_counts=True)[1]]
    begins = np.unique(owner, return_index=True)[1]
    links = np.concatenate([np.empty((2, 0), np.int64), *(pair + b for pair, b in zip(apart, begins, strict=True))], 1)
    links = links[:, _seen(functions, points, links)]
    joined = sparse.csr_matrix((np.ones(links.shape[1]), (links[0], links[1])), (len(every),) * 2)
    group = connected_components(joined, directed=False)[1]
    several = owner[1:][(np.diff(owner) == 0) & (np.diff(group) != 0)]
    found: Flags = np.isin(cells, several)
    return found


def _contacts(functions: Any, rule: Quadrature) -> list[Gap]:
    """Where two leaves touch, inside on both sides, in a cell whose points do not all see each other.

    Where outside is on both sides, as between holes, inside ends in cusps, of which splines know little anyway.
    """
    boundary, found = rule.boundary, list[Gap]()
    pairs, place = np.unique(np.stack([boundary.cells, boundary.leaves]), axis=1, return_inverse=True)
    normals = np.stack([np.bincount(place.ravel(), column, len(pairs[0])) for column in boundary.normals.T], axis=1)
    lengths = np.linalg.norm(normals, axis=1)
    along = np.abs(np.sum(normals[1:] * normals[:-1], axis=1)) >= PARALLEL * lengths[1:] * lengths[:-1]
    cells = np.unique(pairs[0, 1:][(np.diff(pairs[0]) == 0) & along])[:MOST_CONTACTS]
    for cell in cells[_fall_apart(functions, rule, cells)] if len(cells) else cells:
        on = boundary.cells == cell
        points = boundary.points[on].T
        count = points.shape[1]
        values, _ = functions.evaluate(np.repeat(np.arange(functions.count), count), np.tile(points, functions.count))
        own = np.argmin(np.abs(values.reshape(-1, count)), axis=0)
        for pair in combinations(np.unique(own), 2):
            where = _contact(functions, np.array(pair), points.mean(axis=1), rule.grid.size)
            low, high = (side[:, 0] for side in rule.grid.corners(np.array([cell])))
            if where is not None and np.all(np.abs(where - (low + high) / 2) <= (0.5 + TOUCHING) * rule.grid.size):
                one, other = sorted(rule.parts[boundary.leaves[on][own == leaf][0]] for leaf in pair)
                found.append(Gap(tuple(float(value) for value in where), 0.0, (one, other), 0.0))
    return found


def _contact(functions: Any, pair: Ints, point: Floats, size: float) -> Floats | None:
    """Where two leaves are 0 with gradients along one line, by Gauss and Newton's steps, half as long each time."""
    slopes = np.zeros((2, len(point)))
    for _ in range(HALVINGS):
        values, gradients = functions.evaluate(pair, np.stack([point, point], axis=1))
        slopes = gradients.T
        if not (np.isfinite(values).all() and np.isfinite(slopes).all()):
            return None
        step = np.linalg.pinv(slopes, rcond=1e-12) @ values
        point = point - step * min(1.0, size / max(float(np.linalg.norm(step)), size))
    lengths = np.linalg.norm(slopes, axis=1)
    along = abs(float(slopes[0] @ slopes[1])) >= (1 - ALIKE) * float(lengths[0] * lengths[1])
    if not along or np.abs(values).max() > ALIKE * size:
        return None
    across = BESIDE * size * slopes[0] / lengths[0]
    return point if (signs(functions, np.stack([point - across, point + across], axis=1)) > 0).all() else None


def _let_notches(start: Floats, width: Floats, near: float, held: Flags) -> None:
    """Crossings are not held apart next to which a thinner one is not: one notch, whose sides meet at its end.

    They meet, too, where a gap is as good as nothing against what it is beside: where circles touch.
    """
    others = cKDTree(start.T).query_ball_point(start.T, near)
    for number in np.argsort(width, kind="stable"):
        beside = np.array(others[number])
        touches = width[number] <= TOUCHING * width[beside].max()
        if touches or (~held[beside] & (width[beside] <= THINNER * width[number])).any():
            held[number] = False


def _ways(functions: Any, rule: Quadrature, start: Floats, normal: Floats, width: Floats) -> Floats:
    """How long the shortest way inside is from one side of each crossing to the other; infinite if it is too long.

    Ways lead over a lattice, and over points close to the boundary, which are also where the shape is thin.
    """
    size, count, reach = rule.grid.size, len(width), AROUND / 2 + 1
    few = _few(rule.boundary.cells, MORE)
    edge, outward = rule.boundary.points[few].T, rule.boundary.normals[few].T
    near = np.isfinite(cKDTree(start.T).query(edge.T, distance_upper_bound=reach * size)[0])
    # Where leaves touch a rule has many points: one is kept of those that lie close, by the direction of normals.
    places = np.concatenate([np.floor(edge[:, near] / size * CLOSE), np.round(outward[:, near])])
    near = np.flatnonzero(near)[np.unique(places, axis=1, return_index=True)[1]]
    withdrawn = (_withdrawn(functions, *pair, size) for pair in ((start, normal), (edge[:, near], outward[:, near])))
    nodes = np.concatenate([next(withdrawn), start + width * normal, next(withdrawn), _lattice(start, reach, size)], 1)
    known = np.arange(nodes.shape[1]) < 2 * count
    nodes = nodes[:, known | (signs(functions, nodes) > 0)]
    links = cKDTree(nodes.T).query_pairs(STEP * size, output_type="ndarray").T
    links = links[:, _seen(functions, nodes, links)]
    length = np.sqrt(np.sum((nodes[:, links[0]] - nodes[:, links[1]]) ** 2, axis=0))
    graph = sparse.csr_matrix((length, (links[0], links[1])), (nodes.shape[1],) * 2)
    found = np.empty(count)
    for first in range(0, count, AT_ONCE):
        some = np.arange(first, min(first + AT_ONCE, count))
        lengths = dijkstra(graph, directed=False, indices=some, limit=AROUND * size)
        found[some] = lengths[np.arange(len(some)), count + some]
    return found


def _lattice(points: Floats, reach: float, size: float) -> Floats:
    """The points (dim, n) of a lattice, MESH to a cell along each axis, in cells near to some points."""
    dimension, wide = len(points), int(reach)
    cells = np.unique(np.floor(points / size).astype(np.int64), axis=1)
    around = np.indices((2 * wide + 1,) * dimension).reshape(dimension, 1, -1) - wide
    cells = np.unique((cells[:, :, None] + around).reshape(dimension, -1), axis=1)
    within = (np.indices((MESH,) * dimension).reshape(dimension, 1, -1) + 0.5) / MESH
    return ((cells[:, :, None] + within) * size).reshape(dimension, -1)


def _withdrawn(functions: Any, points: Floats, outward: Floats, size: float) -> Floats:
    """Boundary points moved inwards, less where the shape is thin."""
    found = points.copy()
    for step in (18, 12, 6):
        moved = points - size * 0.5**step * outward
        inside = signs(functions, moved) > 0
        found[:, inside] = moved[:, inside]
    return found


def _seen(functions: Any, nodes: Floats, links: Ints) -> Flags:
    """Whether straight steps between nodes inside stay there."""
    size = max(1, PAIRS // functions.count)
    some = [_stays(functions, *nodes[:, links[:, k : k + size]].swapaxes(0, 1)) for k in range(0, links.shape[1], size)]
    return np.concatenate(some) if some else np.empty(0, np.bool_)


def _stays(functions: Any, begin: Floats, end: Floats) -> Flags:
    """Whether straight steps between points inside stay there: the form is asked between the roots of leaves."""
    along = end - begin
    stays = np.ones(begin.shape[1], np.bool_)
    for lower, upper in pairwise(np.sort(leaf_roots(functions, begin, along), axis=0)):
        asked = np.flatnonzero(np.isfinite(upper) & stays)
        if not len(asked):
            break
        middle = (lower[asked] + upper[asked]) / 2
        stays[asked] = signs(functions, begin[:, asked] + middle * along[:, asked]) > 0
    return stays


def leaf_roots(functions: Any, begin: Floats, along: Floats) -> Floats:
    """Where leaves are 0 on short steps along from some points, in [0, 1]: (2 leaves, n), infinite where they are not.

    Along a step each leaf is taken for the cubic with its values and slopes at both ends; between ends of one sign it
    has two roots if it comes down to 0.
    """
    count = begin.shape[1]
    leaf = np.repeat(np.arange(functions.count), count)
    (first, rising), (last, falling) = (
        (value.reshape(-1, count), np.einsum("dk,dlk->lk", along, gradient.reshape(len(begin), -1, count)))
        for value, gradient in (
            functions.evaluate(leaf, np.tile(one, functions.count)) for one in (begin, begin + along)
        )
    )
    apart = np.sign(first) != np.sign(last)
    dips = ~apart & (np.sign(first) * rising < 0) & (np.sign(last) * falling > 0)
    roots = np.full((2, *first.shape), np.inf)
    with np.errstate(all="ignore"):
        for some in (apart, dips):
            roots[:, some] = _roots(first[some], last[some], rising[some], falling[some])
    return roots.reshape(-1, count)


def _roots(first: Floats, last: Floats, rising: Floats, falling: Floats) -> Floats:
    """Where cubics on [0, 1] of such values and slopes are 0, (2, n): between ends of one sign twice, or never.

    Between ends of one sign it is asked where the slope is 0, rising + 2 b t + 3 a t**2.
    """
    a, b = rising + falling - 2 * (last - first), 3 * (last - first) - 2 * rising - falling

    def at(t: Floats) -> Floats:
        return first + t * (rising + t * (b + t * a))

    part = b + np.copysign(np.sqrt(np.maximum(b * b - 3 * a * rising, 0)), b)
    turn, other = -rising / part, -part / (3 * a)
    turn = np.where((turn > 0) & (turn < 1), turn, other)
    apart = np.sign(first) != np.sign(last)
    middle = np.where(apart, 1.0, np.clip(np.nan_to_num(turn), 0, 1))
    low, high, back, far = np.zeros_like(first), middle.copy(), middle.copy(), np.ones_like(first)
    for _ in range(HALVINGS):
        half, later = (low + high) / 2, (back + far) / 2
        before, behind = at(half) * first > 0, at(later) * last > 0
        low, high = np.where(before, half, low), np.where(before, high, half)
        back, far = np.where(behind, back, later), np.where(behind, later, far)
    met = at(middle) * first <= 0
    return np.stack([np.where(met, high, np.inf), np.where(met & ~apart, back, np.inf)])
