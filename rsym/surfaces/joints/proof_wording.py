"""What is proved of common edges, in words."""

from __future__ import annotations

from collections import Counter
from decimal import ROUND_FLOOR, Context
from typing import TYPE_CHECKING

from rsym.reports.numbers import at_most, number
from rsym.reports.words import plural
from rsym.surfaces.proofs.edge_proof import DIFFERENT, EQUAL, WITHIN, EdgeProof, Level

if TYPE_CHECKING:
    from rsym.surfaces.joints.edge_report import EdgeReport

# What each level is about, and its unit.
AMOUNTS = {"G0": ("the gap", ""), "G1": ("the angle", " degrees"), "G2": ("the jump of curvature", "")}
DIGITS = 4


def verdict_text(report: EdgeReport) -> str:
    """The verdict on all meetings, and how many of each are proved.

    Examples
    --------
    >>> from rsym.surfaces import continuity_report, torus
    >>> verdict_text(continuity_report(torus(3, 1)[:2], prove=True))
    'Proofs: CERTIFIED (1 of 1 edge CERTIFIED, 1 exactly).'
    """
    parts = []
    for meetings, noun in ((report.edges, "edge"), (report.poles, "pole")):
        counts = Counter(one.verdict for one in meetings)
        parts += [f"{counts[word]} of {plural(len(meetings), noun)} {word}" for word in sorted(counts)]
    exactly = sum(_exact(one.proof) for one in report.meetings if one.proof)
    parts += [f"{exactly} exactly"] if exactly else []
    return f"Proofs: {report.verdict} ({', '.join(parts)})."


def proof_text(proof: EdgeProof) -> str:
    """What is proved of one edge.

    Examples
    --------
    >>> equal, within = Level("G0", EQUAL, most=0.0), Level("G1", WITHIN, most=2.1e-13)
    >>> proof_text(EdgeProof("REFUTED", (equal, within, Level("G2", DIFFERENT, least=2.0, place=0.5))))
    'proved: the gap is 0; the angle is at most 2.1e-13 degrees; the jump of curvature is at least 2 at t = 0.5'
    """
    said = [_level_text(one) for one in proof.levels if one.holds or one.status == DIFFERENT]
    text = f"proved: {'; '.join(said)}" if said else "not proved"
    if proof.open:
        text += f", but for t in {' and '.join(f'[{number(a)}, {number(b)}]' for a, b in proof.open)}"
    if proof.removed:
        text += f", at t = {' and '.join(map(number, proof.removed))} of the normals over the distance to the pole"
    return f"{text}; {proof.reason}" if proof.reason else text


def _level_text(level: Level) -> str:
    what, unit = AMOUNTS[level.name]
    if level.status == EQUAL:
        return f"{what} is 0"
    if level.status == WITHIN:
        return f"{what} is at most {at_most(level.most, DIGITS)}{unit}"
    least = Context(DIGITS, ROUND_FLOOR).create_decimal(level.least)
    return f"{what} is at least {float(least):.{DIGITS}g}{unit} at t = {number(level.place)}"


def _exact(proof: EdgeProof) -> bool:
    return all(one.status == EQUAL for one in proof.levels)
