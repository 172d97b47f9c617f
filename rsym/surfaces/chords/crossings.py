"""Crossings of lines: any two lines must have one of their own, in the domain."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import combinations
from types import MappingProxyType
from typing import TypeAlias

from rsym.errors import RsymError
from rsym.surfaces.chords.lines import NEGLIGIBLE, Chord, Line, Point

Nodes: TypeAlias = Mapping[tuple[int, int], Point]


def crossings(lines: Sequence[Line], chords: Sequence[Chord]) -> Nodes:
    """The points where two lines cross, by the pair of their numbers.

    Raises
    ------
    RsymError
        Where three lines go through one point, or two cross outside of their chords.
    """
    pairs = combinations(range(len(lines)), 2)
    nodes = MappingProxyType({(i, j): lines[i].meet(lines[j]) for i, j in pairs})
    _refuse_concurrent(lines, chords, nodes)
    _refuse_outside(lines, chords, nodes)
    return nodes


def refuse_parallel(lines: Sequence[Line]) -> None:
    """Refuse lines of which two do not cross."""
    for (i, first), (j, second) in combinations(enumerate(lines), 2):
        (a, b), (c, d) = first.normal, second.normal
        if abs(a * d - b * c) <= NEGLIGIBLE * math.hypot(a, b) * math.hypot(c, d):
            raise RsymError(
                f"the lines {first} and {second} are parallel",
                code="lines",
                where=f"lines[{i}] and lines[{j}]",
                remedy="any two must cross: turn one of them, or leave one out",
            )


def _refuse_concurrent(lines: Sequence[Line], chords: Sequence[Chord], nodes: Nodes) -> None:
    reach = max(float(chord.length) for chord in chords)
    for (i, j), node in nodes.items():
        for k in range(j + 1, len(lines)):
            line = lines[k]
            if abs(float(line.at(node))) <= NEGLIGIBLE * reach * math.hypot(*line.normal):
                raise RsymError(
                    f"three lines go through one point, ({float(node[0]):g}, {float(node[1]):g})",
                    code="lines",
                    where=f"lines[{i}], lines[{j}] and lines[{k}]",
                    remedy="any two must cross at a point of their own: shift one of them",
                )


def _refuse_outside(lines: Sequence[Line], chords: Sequence[Chord], nodes: Nodes) -> None:
    for pair, node in nodes.items():
        for k in pair:
            chord = chords[k]
            steps = [float(d) for d in chord.direction]
            share = sum(float(p - m) * d for p, m, d in zip(node, chord.middle, steps, strict=True))
            half = math.sqrt(float(chord.square)) * math.hypot(*steps) ** 2
            if abs(share) > half * (1 + NEGLIGIBLE):
                raise RsymError(
                    f"the lines {lines[pair[0]]} and {lines[pair[1]]} cross outside the domain,"
                    f" at ({float(node[0]):g}, {float(node[1]):g})",
                    code="lines",
                    where=f"lines[{pair[0]}] and lines[{pair[1]}]",
                    remedy="widen the domain, or move one of the lines",
                )
