"""Joining patches: one is changed along an edge so that it continues another."""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.corrections import MEETING, Correction, greatest, require_tolerance, sizes
from rsym.surfaces.functions.formulas import entries_of
from rsym.surfaces.functions.univariate import Constant
from rsym.surfaces.joints.edges import NAMES, PatchEdge
from rsym.surfaces.joints.joined import JoinedPatch
from rsym.surfaces.joints.meeting import apart, require_meeting, sample_grid
from rsym.surfaces.patch import Patch

DEPTHS = {"G1": 1, "G2": 2}
SAMPLES = 17


def join(
    p: Patch,
    edge_p: str | None,
    q: Patch,
    edge_q: str | None,
    k: Any = 1.0,
    *,
    h: Any = 0.0,
    reverse: bool = False,
    continuity: str | None = None,
    transfinite: bool = False,
    blend: HermiteBlend | None = None,
    tolerance: float = MEETING,
) -> BicubicCoons | JoinedPatch:
    """The patch q, changed so that it continues p across a common edge; what it is along the opposite edge stays.

    Along the edge of q, with the parameter t that runs along it, n the way out of p and into q,

        q = p,   q_n = k p_n + h p_t,   for G2 also   q_nn = k^2 p_nn + 2 k h p_nt + h^2 p_tt.

    k = 1, h = 0 makes all these derivatives equal: C1 or C2, if both edges have intervals of one length. Two
    `BicubicCoons` with the same blend along the edge give one again: in its matrix the rows of the edge are those of
    p, times 1, k, k^2, whichever two of the sixteen pairs of edges and in either direction. Everything else gives a
    `JoinedPatch`: q and a loft of what is missing (the class-2 transfinite form, class 3 for G2). The attribute
    `correction` of either tells the gap that there was between the edges, and how far points of q were moved at most.

    Parameters
    ----------
    p, q : Patch
        p stays as it is.
    edge_p, edge_q : {"u0", "u1", "v0", "v1"} or None
        None for both: the two edges that are nearest, and the direction in which they are.
    k, h : number, SymPy expression or function of t
        k must be positive: of numbers and expressions that is proved, of a function of Python the least value seen is
        told by a warning. Where four patches meet, k must be the same along each whole line of edges.
    reverse : bool
        Whether the parameter of q's edge runs against that of p's.
    continuity : {"G1", "G2"}, optional
        Default: G2 for matrices of class 3, otherwise G1.
    transfinite : bool
        Take a `JoinedPatch` in any case.
    blend : HermiteBlend, optional
        What fades from the edge into a `JoinedPatch`; the default is q's own, or the cubic (G1) or quintic (G2) one.
    tolerance : float
        By which share of the size of the smaller patch the edges may miss one another, at the same parameters and at
        the defaults of letters. By default that is rounding; a larger one moves the edge of q to that of p on purpose.

    Raises
    ------
    RsymError
        For edges that do not meet (the greatest gap and its parameter are named), k that is not proved positive, an
        edge that is a point, and matrices whose blends along the edge differ: what one can be there the other cannot.

    Notes
    -----
    Derived for rsym from the two patch systems of a thesis on Coons patches with shape parameters (Central South
    University, 2009), whose own rules are lost.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> floor, ramp = ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, u))
    >>> smooth = join(floor, "u1", ramp, "u0", k=2)
    >>> smooth.derivative(0, 0.5).tolist(), smooth(1, 0.5).tolist()
    ([2.0, 0.0, 0.0], [2.0, 0.5, 1.0])
    >>> smooth.correction.gap, round(smooth.correction.moved, 3)
    (0.0, 0.21)
    >>> higher = ParametricSurface((1 + u, v, u + 0.01))
    >>> join(floor, "u1", higher, "u0")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: (u, v) = (0, 0) of q: the edge u1 of p and the edge u0 of q do not meet: they are 0.01...
    >>> join(floor, "u1", higher, "u0", tolerance=0.01).correction.gap
    0.01
    """
    if not isinstance(p, Patch) or not isinstance(q, Patch):
        raise RsymError(
            f"expected two patches, got {type(p).__name__} and {type(q).__name__}",
            code="patch",
            remedy="a list of patches is joined one by one",
        )
    if continuity not in (None, *DEPTHS):
        raise RsymError(f"patches are joined G1 or G2, got {continuity!r}", code="continuity", remedy='continuity="G1"')
    if edge_p is None and edge_q is None:
        edge_p, edge_q, reverse = nearest_edges(p, q)
    elif edge_p is None or edge_q is None:
        raise RsymError("one edge is given and the other is not", code="edge", remedy="give both, or None for both")
    require_tolerance(tolerance)
    first, second = PatchEdge(p, edge_p, reverse), PatchEdge(q, edge_q)
    for edge in (first, second):
        sample_grid(edge.patch)  # what is not finite is refused
        if edge.is_point():
            raise RsymError(
                f"the edge {edge.name} is a point, and nothing is joined along it",
                code="pole",
                remedy="join the edges that meet in it",
            )
    constant = all(isinstance(one, int | float | np.number) for one in (k, h))
    joined: BicubicCoons | JoinedPatch
    if isinstance(p, BicubicCoons) and isinstance(q, BicubicCoons) and constant and not h and not transfinite:
        depth = DEPTHS[continuity] if continuity else _own_depth(p, q)
        joined = joined_matrix(p, first, q, second, float(k), depth)
    else:
        joined = JoinedPatch(first, second, k, h, DEPTHS[continuity] if continuity else _own_depth(p, q), blend)
    require_meeting(first, second, tolerance)
    return joined


def _own_depth(p: Patch, q: Patch) -> int:
    """What matrices hold: two derivatives across their edges in class 3, otherwise one."""
    return 2 if all(isinstance(one, BicubicCoons) and len(one.matrix) == 6 for one in (p, q)) else 1


def nearest_edges(p: Patch, q: Patch) -> tuple[str, str, bool]:
    """The pair of edges of two patches that are nearest to one another, and whether their parameters run oppositely.

    Raises
    ------
    RsymError
        If two pairs are equally near.
    """
    shares = np.linspace(0, 1, SAMPLES)
    found = []
    for name in NAMES:
        for other in NAMES:
            for reverse in (False, True):
                edges = PatchEdge(p, name, reverse), PatchEdge(q, other)
                first, second = (
                    edge.position(low + shares * (high - low))
                    for edge, (low, high) in ((edge, edge.interval) for edge in edges)
                )
                found.append((float(np.linalg.norm(first - second, axis=-1).max()), name, other, reverse))
    best, second_best = sorted(found)[:2]
    if second_best[0] <= 1.01 * best[0]:
        raise RsymError(
            f"the edges {best[1]} and {best[2]} are no nearer than {second_best[1]} and {second_best[2]}",
            code="edge",
            remedy="say which edges are to be joined, and whether one is reversed",
        )
    return best[1:]


# Joining patches that are matrices of corner information: rows of one become rows of the other.
# Blends are one and the same if they agree here to rounding; families with different parameters differ by far more.
PLACES = np.linspace(0.0, 1.0, 23)
ROUNDING = 1e-12


def joined_matrix(
    p: BicubicCoons, first: PatchEdge, q: BicubicCoons, second: PatchEdge, k: float, depth: int
) -> BicubicCoons:
    """The patch q with the rows of its edge taken from p: those of order n times k^n, counted out of p and into q."""
    if not 0 < k < np.inf:
        raise RsymError(f"k must be positive, got {k!r}", code="k", remedy="k < 0 would fold q back over p")
    along_p, along_q = (_blend_along(edge) for edge in (first, second))
    if not _agree(along_p, along_q, first.reverse):
        how = " run backwards" if first.reverse else ""
        raise RsymError(
            f"along the edge {second.name} q has the blend {along_q!r}, and p another along its {first.name}{how}",
            code="blend",
            remedy="give both patches the same blend along the edge, or join with transfinite=True",
        )
    if depth >= along_q.order:
        raise RsymError(
            f"matrices of class {along_q.order} hold no derivatives of order {depth}",
            code="class",
            remedy="matrices (6, 6, 3), or transfinite=True",
        )
    source, given = _entries(p), _entries(q)
    target = given.astype(np.result_type(source, given))
    rows_p, rows_q = _rows(source, first), _rows(target, second)
    # Out of p is towards growing u at its upper edge, into q at its lower one.
    factor = k if first.upper != second.upper else -k
    for order in range(depth + 1):
        row = rows_p[2 * order + int(first.upper)]
        rows_q[2 * order + int(second.upper)] = factor**order * (_backwards(row) if first.reverse else row)
    letters = p.data.letters.merge(q.data.letters)
    joined = BicubicCoons(target, q.blend_u, q.blend_v, letters=letters if len(letters) else None)
    added = q.with_matrix(joined.matrix - q.matrix)
    moved, (u, v) = greatest(lambda u, v: sizes(added(u, v)), *added.domain)
    joined.correction = Correction(apart(first, second)[0], moved, (u, v))
    return joined


def _entries(patch: BicubicCoons) -> np.ndarray[Any, Any]:
    """The matrix: numbers, or expressions if it has letters."""
    if isinstance(patch.data, Constant):
        return patch.data.values
    expressions = patch.data.expressions()
    assert expressions is not None
    return np.array(entries_of(expressions), dtype=object).reshape(patch.data.shape)


def _rows(matrix: np.ndarray[Any, Any], edge: PatchEdge) -> np.ndarray[Any, Any]:
    """The matrix as a view whose rows run along the edge."""
    return matrix if edge.across == 0 else np.swapaxes(matrix, 0, 1)


def _backwards(row: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The same curve from its end: both ends change places, derivatives of odd order their sign."""
    pairs = row.reshape(-1, 2, *row.shape[1:])[:, ::-1].copy()
    pairs[1::2] *= -1
    return pairs.reshape(row.shape)


def _blend_along(edge: PatchEdge) -> HermiteBlend:
    patch = edge.patch
    assert isinstance(patch, BicubicCoons)
    return patch.blend_v if edge.across == 0 else patch.blend_u


def _agree(one: HermiteBlend, other: HermiteBlend, reverse: bool) -> bool:
    """Whether a curve in the first blend, run backwards if so said, is the one in the second blend of the same data."""
    if one.order != other.order or one.letters != other.letters:
        return False
    values = np.moveaxis(_backwards(np.moveaxis(one(1 - PLACES), -1, 0)), 0, -1) if reverse else one(PLACES)
    return bool(np.abs(values - other(PLACES)).max() <= ROUNDING)
