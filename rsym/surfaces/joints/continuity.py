"""How smoothly patches meet: every common edge found and measured, numerically and with an error estimate."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.surfaces.joints.borders import DIRECTIONS, Border, clusters, fan, spread
from rsym.surfaces.joints.edge_matching import (
    Comparison,
    Stretch,
    covered,
    flipped,
    free_intervals,
    shared_stretches,
    survey,
)
from rsym.surfaces.joints.edge_report import (
    CommonEdge,
    EdgeReport,
    FreeEdge,
    Greatest,
    Pole,
    Tolerances,
    badness,
    extreme,
)
from rsym.surfaces.joints.edges import edges_of
from rsym.surfaces.joints.meeting import extent, room_for, sample_grid
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Patch, own_letters
from rsym.surfaces.proofs.edge_formulas import PatchFormula
from rsym.surfaces.proofs.insides import doubt_inside
from rsym.surfaces.proofs.pole_proofs import Spoke, prove_pole
from rsym.surfaces.proofs.proving import prove
from rsym.surfaces.proofs.stretches import ProofTask

# Doubles leave 1e-16 of the size in points, 1e-8 of that in the second derivatives of what is computed by limits at
# poles; data met "to 1e-8", as networks are after reparametrisation, must pass. A kink of 1e-3 degrees must not.
GAP, ANGLE, CURVATURE = 1e-7, 1e-4, 1e-5
# Edges nearer than this share of the patches are taken as meant to meet.
REACH = 0.01
FREE_POINTS = 65


def continuity_report(
    surfaces: Patch | Sequence[Patch],
    *,
    gap: float = GAP,
    angle: float = ANGLE,
    curvature: float = CURVATURE,
    reach: float = REACH,
    letters: LetterValues = None,
    prove: bool = False,
) -> EdgeReport:
    """Every place where patches meet, how far it is from smooth, and where it is worst.

    Edges are matched by closest points, so parameters may run at any speed and in either direction, and one edge may
    meet several others; seams of one patch with itself and poles are found too. Along each common edge the gap, the
    angle between the normals (whichever side they point to) and the jump of the normal curvature across the edge are
    sampled until the greatest values stay. G1 surfaces whose normal curvatures agree in one direction other than
    the edge's are G2 (Pegna and Wolter 1992).

    Parameters
    ----------
    surfaces : Patch or sequence of Patch
        What is looked at.
    gap, curvature : float
        What counts as none, as shares: of the size of the smaller patch; of the greatest curvature along the edge, or
        one over the size if that is more.
    angle : float
        What counts as none, in degrees.
    reach : float
        Edges that are apart, but nearer than this share of the length of either and of the breadth of either patch,
        are reported as broken.
    letters : mapping, optional
        Values of letters by name.
    prove : bool
        Whether to prove what the formulas allow: edges whose parameters run at one speed, of patches that are formulas
        (`Patch.expression`) or B-splines. Of the gap, the angle and the jump of curvature each is then identically
        zero, by exact arithmetic; or within a hundred-thousandth of its tolerance all along the edge, by enclosures in
        balls; or more than that at one place; or not decided. Numbers in data are the decimals that they are written as
        in `Patch.expression`. It takes about three times as long. Between its edges a patch must be twice
        differentiable by its formula or its knots: where pieces meet inside, nothing is certified, and `split_patch`
        cuts it there.

    Returns
    -------
    EdgeReport
        `.edges`, `.poles`, `.free`, `.continuity` (the lowest, by samples, and no more than what is refuted leaves),
        `.verdict` (by proof) and `str()`.

    Raises
    ------
    RsymError
        What is given is not patches, or a tolerance is not positive.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> floor = ParametricSurface((u, v, 0))
    >>> ramp = ParametricSurface((u, -sp.sin(v), 2 - 2 * sp.cos(v)), ((0, 1), (0, 1)))
    >>> report = continuity_report([floor, ramp])
    >>> report.continuity, round(report.edges[0].curvature_jump.value, 9)
    ('G1', 2.0)
    >>> print(report)
    2 patches, 1 common edge: G1 (1 G1). Free: 0 u0, 0 u1, 0 v1, 1 u0, 1 u1, 1 v1. Numerical: decided by samples, \
not proved; size 2.288.
      1. 0 v0 - 1 v0: G1; the curvature across jumps by 2; worst at (0, 0, 0), (u, v) = (0, 0) and (0, 0); \
normals to different sides
    """
    patches = tuple(surfaces or ()) if surfaces is None or isinstance(surfaces, Iterable) else (surfaces,)
    _check(patches, {"gap": gap, "angle": angle, "curvature": curvature, "reach": reach})
    values = own_letters(patches, letters)
    grids = [sample_grid(patch, own) for patch, own in zip(patches, values, strict=True)]
    borders = [one for k, patch in enumerate(patches) for one in _borders(k, patch, grids[k], gap, reach, values[k])]
    lines, points = ([one for one in borders if one.is_point == which] for which in (False, True))
    stretches = shared_stretches(lines)
    joined = covered(stretches, lines)
    free = [
        FreeEdge(border.index, border.edge.name, one, border.edge.position(np.linspace(*one, FREE_POINTS)))
        for border in lines
        for one in free_intervals(border, joined[border])
    ]
    edges = [_common_edge(one, angle, curvature) for one in stretches]
    groups = clusters(points)
    poles = [_pole(group, angle, curvature) for group in groups]
    doubts: tuple[str, ...] = ()
    if prove:
        formulas = formulas_of(patches, values)
        edges = [with_proof(one, stretch, formulas) for one, stretch in zip(edges, stretches, strict=True)]
        poles = [pole_with_proof(one, group, formulas) for one, group in zip(poles, groups, strict=True)]
        doubts = tuple(doubt_inside(patch, formula) for patch, formula in zip(patches, formulas, strict=True))
    edges.sort(key=badness)
    poles.sort(key=badness)
    size = extent(*grids) if grids else 0.0
    return EdgeReport(tuple(edges), tuple(poles), tuple(free), len(patches), size, doubts)


def _check(patches: Sequence[object], tolerances: dict[str, float]) -> None:
    for place, patch in enumerate(patches):
        if not isinstance(patch, Patch):
            raise RsymError(
                f"surfaces are patches, got {type(patch).__name__} at place {place}",
                code="type",
                remedy="meshes and shapes have no edges; give patches of rsym.surfaces",
            )
    for name, value in tolerances.items():
        if not isinstance(value, int | float | np.number) or not value > 0:
            raise RsymError(f"{name} must be positive, got {value!r}", code="tolerance", remedy="leave it out")


def _borders(
    index: int, patch: Patch, grid: Floats, gap: float, reach: float, letters: LetterValues
) -> Iterator[Border]:
    """The edges of a patch, with the gaps that count as none and as meant to be none."""
    size = extent(grid)
    none = room_for(gap, grid)
    breadths = [np.linalg.norm(np.diff(grid, axis=axis), axis=-1).sum(axis=axis) for axis in (0, 1)]
    for edge in edges_of(patch, letters):
        length, breadth = float(breadths[1 - edge.across][-1 if edge.upper else 0]), float(breadths[edge.across].mean())
        is_point = edge.is_point(size)
        near = reach * (breadth if is_point else min(length, breadth))
        yield Border(index, edge, size, none, near, is_point)


def _common_edge(stretch: Stretch, angle: float, curvature: float) -> CommonEdge:
    first, second = stretch.borders
    gap, size = min(first.gap, second.gap), min(first.size, second.size)

    def room(samples: Comparison) -> Floats:
        strongest = float(np.nanmax(samples.curvatures, initial=0.0))
        return np.array([gap, angle, curvature * max(1 / size, strongest)])

    found = survey(stretch, room)
    samples = found.samples
    places = (first.edge.parameters(samples.t), second.edge.parameters(samples.s))
    measured = zip(samples.values, found.errors, strict=True)
    apart, kink, jump = (extreme(values, error, samples.points, places) for values, error in measured)
    tolerances = Tolerances(*room(samples))
    return CommonEdge(
        (first.index, second.index),
        (first.edge.name, second.edge.name),
        Greatest(apart, kink, jump, tolerances),
        int(np.isnan(samples.angles).sum()),
        (stretch.interval, (float(samples.s[0]), float(samples.s[-1]))),
        flipped(stretch),
        samples.points,
        samples.gaps,
        samples.angles,
        samples.curvature_jumps,
        np.stack([np.stack(place, axis=-1) for place in places], axis=1),
    )


def _pole(group: Sequence[Border], angle: float, curvature: float) -> Pole:
    """The patches of a pole compared in all directions, with twice as many for the error."""
    coarse, fine = (fan(group, count) for count in DIRECTIONS)
    strongest = float(np.nanmax(np.abs(fine.tensors), initial=0.0))
    size = min(border.size for border in group)
    tolerances = Tolerances(min(border.gap for border in group), angle, curvature * max(1 / size, strongest))
    extremes = []
    for before, now in zip(spread(coarse), spread(fine), strict=True):
        moved = abs(float(np.nanmax(now, initial=0.0)) - float(np.nanmax(before, initial=0.0)))
        one, other = (index.ravel() for index in np.indices(now.shape))
        places = tuple((fine.parameters[index, 0], fine.parameters[index, 1]) for index in (one, other))
        extremes.append(extreme(now.ravel(), moved, fine.points[one], places))
    apart, kink, jump = extremes
    return Pole(
        tuple(border.index for border in group),
        tuple(border.edge.name for border in group),
        Greatest(apart, kink, jump, tolerances),
        int(np.isnan(fine.normals).any(axis=-1).sum()),
        tuple(map(float, fine.points[0])),
    )


# Common edges with what is proved of them.
# The share of what samples tolerate that a proof does: gaps of 1e-12 of the size, angles of 1e-9 degrees. Rounding in
# data is far below, and a change of a control point by a millionth is far above.
STRICTNESS = 1e-5


def formulas_of(patches: Sequence[Patch], values: Sequence[LetterValues]) -> list[PatchFormula]:
    """The formulas of some patches with the values of their letters."""
    letters = [ranges_of(patch.letters, own) for patch, own in zip(patches, values, strict=True)]
    return [
        PatchFormula(patch, {name: low for name, (low, _) in own.items()})
        for patch, own in zip(patches, letters, strict=True)
    ]


def with_proof(edge: CommonEdge, stretch: Stretch, formulas: Sequence[PatchFormula]) -> CommonEdge:
    """The same edge with its proof."""
    room, along = edge.tolerances, 1 - stretch.borders[0].edge.across
    rooms = (STRICTNESS * room.gap, math.sin(math.radians(STRICTNESS * room.angle)), STRICTNESS * room.curvature)
    found = (edge.gap.value, math.radians(edge.angle.value), edge.curvature_jump.value)
    extremes = zip((edge.gap, edge.angle, edge.curvature_jump), found, rooms, strict=True)
    worst = [one.parameters[0][along] for one, value, most in extremes if value > most]
    first, second = (formulas[place] for place in edge.patches)
    return replace(edge, proof=prove(ProofTask(stretch, (first, second), rooms, worst, edge.gap.value)))


def pole_with_proof(pole: Pole, group: Sequence[Border], formulas: Sequence[PatchFormula]) -> Pole:
    """The same pole with its proof."""
    directions = fan(group, DIRECTIONS[0])
    angles = spread(directions)[1]
    pair = np.unravel_index(int(np.argmax(np.nan_to_num(angles))), angles.shape)
    worst = []
    for place in map(int, pair):
        number = place // DIRECTIONS[0]
        along = 1 - group[number].edge.across
        worst.append((number, float(directions.parameters[place][along])))
    room = math.sin(math.radians(STRICTNESS * pole.tolerances.angle))
    spokes = [Spoke(border.edge, formulas[border.index]) for border in group]
    return replace(pole, proof=prove_pole(spokes, (room, STRICTNESS * pole.tolerances.curvature), worst))
