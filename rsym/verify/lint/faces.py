"""Common faces in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rsym.verify.lint.report import COINCIDENT, LONE_SHEET, ZERO_SHEET, Finding
from rsym.verify.lint.sheets import CommonFace
from rsym.verify.lint.survey import Survey

_MESSAGES = {
    ZERO_SHEET: "the sets that this disjunction joins share a face: omega is zero there, inside the shape",
    LONE_SHEET: "the sets of this conjunction have only a face in common: a shape without thickness, omega <= 0",
}
_REMEDIES = {
    ZERO_SHEET: "let the sets overlap, or join them before they are cut: build both from one common primitive",
    LONE_SHEET: "let the sets overlap, or leave the conjunction out",
    COINCIDENT: "leave one of the two out, move one face off the other, or normalise the result",
}


def face_findings(survey: Survey, faces: Sequence[CommonFace]) -> Iterator[Finding]:
    """A finding for each common face."""
    for kind in (COINCIDENT, ZERO_SHEET, LONE_SHEET):
        for face in faces:
            if face.kind == kind:
                point = face.points[len(face.points) // 2]
                where = dict.fromkeys((survey.places[face.first], survey.places[face.second]))
                yield Finding(kind, tuple(where), _message(face), _REMEDIES[kind], tuple(point.tolist()))


def _message(face: CommonFace) -> str:
    if face.kind != COINCIDENT:
        return _MESSAGES[face.kind]
    word, sign = ("conjunction", "-") if face.conjunction else ("disjunction", "+")
    return (
        f"the operands of this {word} are zero on the same face, which loses normalisation: "
        f"in R_0, f with itself gives (2 {sign} sqrt(2))*f"
    )
