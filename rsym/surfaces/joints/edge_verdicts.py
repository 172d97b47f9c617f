"""Common edges with what is proved of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from rsym.codegen.enclosures import ranges_of
from rsym.surfaces.joints.edge_matching import Stretch
from rsym.surfaces.joints.edge_report import CommonEdge
from rsym.surfaces.patch import LetterValues, Patch
from rsym.surfaces.proofs.edge_formulas import PatchFormula
from rsym.surfaces.proofs.proving import Task, prove

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
    worst = [one.parameters[0][along] for one in (edge.gap, edge.angle, edge.curvature_jump)]
    first, second = (formulas[place] for place in edge.patches)
    return replace(edge, proof=prove(Task(stretch, (first, second), rooms, worst)))
