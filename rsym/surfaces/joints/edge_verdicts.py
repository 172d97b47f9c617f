"""Common edges with what is proved of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rsym.bounds.enclosures import ranges_of
from rsym.surfaces.joints.borders import Border
from rsym.surfaces.joints.edge_matching import Stretch
from rsym.surfaces.joints.edge_report import CommonEdge, Pole
from rsym.surfaces.joints.poles import SAMPLES, fan, spread
from rsym.surfaces.patch import LetterValues, Patch
from rsym.surfaces.proofs.edge_formulas import PatchFormula
from rsym.surfaces.proofs.pole_proofs import Spoke, prove_pole
from rsym.surfaces.proofs.proving import prove
from rsym.surfaces.proofs.stretches import Task

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
    return replace(edge, proof=prove(Task(stretch, (first, second), rooms, worst, edge.gap.value)))


def pole_with_proof(pole: Pole, group: Sequence[Border], formulas: Sequence[PatchFormula]) -> Pole:
    """The same pole with its proof."""
    directions = fan(group, SAMPLES[0])
    angles = spread(directions)[1]
    pair = np.unravel_index(int(np.argmax(np.nan_to_num(angles))), angles.shape)
    worst = []
    for place in map(int, pair):
        number = place // SAMPLES[0]
        along = 1 - group[number].edge.across
        worst.append((number, float(directions.parameters[place][along])))
    room = math.sin(math.radians(STRICTNESS * pole.tolerances.angle))
    spokes = [Spoke(border.edge, formulas[border.index]) for border in group]
    return replace(pole, proof=prove_pole(spokes, (room, STRICTNESS * pole.tolerances.curvature), worst))
