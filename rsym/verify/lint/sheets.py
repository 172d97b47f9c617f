"""Faces that two operands of an R-operation have in common, and what that does to omega.

At a point of a common face with normal n each operand has a sign ahead, behind,
and is zero between. Both rising: the conjunction of f with itself is (2 - sqrt 2) f, the
disjunction (2 + sqrt 2) f. One rising, one falling: the disjunction is positive on both sides of a
sheet of zeros, the conjunction negative on both sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.logic.gates import Gate, through
from rsym.sampling.form_signs import joined_signs
from rsym.verify.lint.logic import Logic
from rsym.verify.lint.report import COINCIDENT, LONE_SHEET, ZERO_SHEET
from rsym.verify.lint.zeros import CONVERGED, Functions, Ints, Zeros, onto, tangents

BESIDE = 1e-5  # of the diagonal: where signs ahead of and behind a face are taken
THIN = 0.1  # of its values beside it is the most that omega may have on a face
AROUND = 1e-2  # of the diagonal: so far around a point of a common face both leaves are zero together
SHARE = 0.75  # of the points around must lie on it
FEWEST = 3  # points on a common face; of a curve where two surfaces touch there is hardly one
ASKED = 12  # points of a face around which more of it is sought


class LocalSigns(NamedTuple):
    """The signs (literals and gates, n) at points, ahead of them and behind, and where omega bears them out.

    Beside an edge a blend may have another sign than the operation that it blends.
    """

    at: NDArray[np.int8]
    ahead: NDArray[np.int8]
    behind: NDArray[np.int8]
    confirmed: NDArray[np.bool_]


@dataclass(frozen=True)
class CommonFace:
    """A face that two leaves have in common: what it is, the leaves, and points of it with normals."""

    kind: str
    first: int
    second: int
    conjunction: bool
    points: Floats
    normals: Floats


def common_faces(logic: Logic, functions: Functions, zeros: Zeros, size: float) -> list[CommonFace]:
    """The common faces that matter: where they are zeros of omega; leaves are the first functions, omega is the last.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.verify.lint.linting import survey_of
    >>> survey = survey_of(rsym.Shape(rsym.disjunction(x, -3 * x), (x, y)), ((-1, 1), (-1, 1)))
    >>> [face.kind for face in common_faces(survey.logic, survey.functions, *survey.near)]
    ['zero sheet']
    """
    zeros = zeros[zeros.signed & (zeros.which < len(logic.leaves))]
    found: dict[tuple[str, int, int], CommonFace] = {}
    for face, which in _faces(logic, functions, zeros, size):
        if _is_patch(face, which, logic, functions, size):
            key = face.kind, min(face.first, face.second), max(face.first, face.second)
            if key not in found or len(found[key].points) < len(face.points):
                found[key] = face
    return list(found.values())


def _faces(logic: Logic, functions: Functions, zeros: Zeros, size: float) -> Iterator[tuple[CommonFace, Ints]]:
    """What looks like a common face at single points."""
    local = _local(logic, functions, zeros, size)
    gates = zip(logic.gates, logic.keeps, _active(logic, local)[len(logic.literals) :], strict=True)
    for gate, keeps, active in gates:
        for kind, here in _kinds(gate, keeps, local).items():
            columns = np.flatnonzero(here & active & local.confirmed).tolist()
            pairs = [tuple(_leaf_at(logic, local, operand, k) for operand in gate[1:]) for k in columns]
            for first, second in dict.fromkeys(pairs):
                part = zeros[[k for k, pair in zip(columns, pairs, strict=True) if pair == (first, second)]]
                if len(part.which) >= FEWEST:
                    yield CommonFace(kind, first, second, gate.operation == "min", part.points, part.sides), part.which


def _kinds(gate: Gate, keeps: bool, local: LocalSigns) -> dict[str, NDArray[np.bool_]]:
    """Where the operands of a gate have a face in common, by what it does to the gate and to omega."""
    one, other = gate.first, gate.second
    both = (local.at[one] == 0) & (local.at[other] == 0)
    alike = (local.ahead[one] == local.ahead[other]) & (local.behind[one] == local.behind[other])
    crosses = local.ahead[-1] != local.behind[-1]
    if gate.operation == "min":
        sheet = (local.ahead[-1] < 0) & (local.behind[-1] < 0)
    else:
        sheet = (local.ahead[-1] > 0) & (local.behind[-1] > 0)
    kinds = {LONE_SHEET if gate.operation == "min" else ZERO_SHEET: both & ~alike & sheet}
    return kinds if keeps else kinds | {COINCIDENT: both & alike & crosses}


def _local(logic: Logic, functions: Functions, zeros: Zeros, size: float) -> LocalSigns:
    """The signs of all steps at points of zero sets."""
    count = len(logic.leaves)
    at, omega = np.empty((count, len(zeros.which)), np.int8), np.empty(len(zeros.which))
    for start in range(0, len(zeros.which), functions.portion):
        here = slice(start, start + functions.portion)
        values, gradients = functions(zeros.points[here])
        near = np.abs(values) <= CONVERGED * size * np.linalg.norm(gradients, axis=2)
        at[:, here], omega[here] = np.where(near, 0, np.nan_to_num(np.sign(values)))[:count], values[-1]
    at[zeros.which, np.arange(len(zeros.which))] = 0
    (ahead, before), (behind, after) = (
        functions.signs(zeros.points + step * size * zeros.sides) for step in (BESIDE, -BESIDE)
    )
    ahead, behind = (_steps(logic, signs[:count]) for signs in (ahead, behind))
    confirmed = (np.sign(before) == ahead[-1]) & (np.sign(after) == behind[-1])
    # Where a normalised omega is zero on a sheet it is 0/0.
    confirmed &= ~(np.abs(omega) > THIN * np.minimum(np.abs(before), np.abs(after)))
    return LocalSigns(_steps(logic, at), ahead, behind, confirmed)


def _steps(logic: Logic, signs: NDArray[np.int8]) -> NDArray[np.int8]:
    """The signs of all steps from those of the leaves."""
    literals = [literal.sign * signs[literal.leaf] for literal in logic.literals]
    return np.array(through(logic.gates, literals, joined_signs), np.int8)


def _active(logic: Logic, local: LocalSigns) -> NDArray[np.bool_]:
    """Where the zero of a step is one of omega."""
    result = np.zeros(local.at.shape, bool)
    result[-1] = local.at[-1] == 0
    for number in reversed(range(len(logic.gates))):
        for operand in logic.gates[number][1:]:
            result[operand] |= result[len(logic.literals) + number] & (local.at[operand] == 0)
    return result


def _leaf_at(logic: Logic, local: LocalSigns, number: int, column: int) -> int:
    """A leaf that makes a step zero at a point."""
    while number >= len(logic.literals):
        gate = logic.gates[number - len(logic.literals)]
        number = gate.first if local.at[gate.first, column] == 0 else gate.second
    return logic.literals[number].leaf


def _is_patch(face: CommonFace, which: Ints, logic: Logic, functions: Functions, size: float) -> bool:
    """Whether what is common is an open piece of surface: points around lie on it too."""
    some = slice(None, None, -(-len(which) // ASKED))
    points, normals, leaf = face.points[some], face.normals[some], which[some]
    starts = [points + sign * AROUND * size * tangent for tangent in tangents(normals) for sign in (1, -1)]
    around, arrived = onto(functions, np.tile(leaf, len(starts)), np.vstack(starts), size)
    around = around[arrived]
    values, gradients = functions(around)
    with np.errstate(all="ignore"):
        distances = np.abs(values) / np.linalg.norm(gradients, axis=2)
    near = distances[[face.first, face.second]] <= CONVERGED * size
    return bool(len(around) and near.all(axis=0).mean() >= SHARE)
