"""A verdict on a body for programs: JSON with stable keys."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from rsym.verify.records import plain

if TYPE_CHECKING:
    from rsym.verify.bodies.report import BodyReport, Defect, SingularCurve

FORMAT = "rsym-body-report"
# Raised when a key changes its meaning or goes; a key may be added without.
VERSION = 1


def body_json(report: BodyReport, *, boxes: bool = False) -> str:
    """A report as JSON text: every number is finite, and null says unknown or, for an end of an enclosure, none.

    Parameters
    ----------
    report : BodyReport
        What to write.
    boxes : bool
        Whether to list the certified and the joined boxes too, of which there may be thousands.

    Examples
    --------
    >>> import json, math
    >>> import numpy as np
    >>> from rsym.verify.bodies.report import BodyCover, BodyReport
    >>> none = np.empty((0, 3, 2))
    >>> unbounded, cover = (-math.inf, math.inf), BodyCover(((-2, 2),) * 3, none, none, none, 1)
    >>> report = BodyReport("DEGENERATE", "broken", (), (), unbounded, (math.nan, math.nan), cover, {})
    >>> record = json.loads(body_json(report))
    >>> record["verdict"], record["curvatures"], record["version"]
    ('DEGENERATE', [None, None], 1)
    """
    cover = report.cover
    kinds = {"certified": cover.certified, "joined": cover.joined, "undecided": cover.undecided}
    record = {
        "format": FORMAT,
        "version": VERSION,
        "verdict": report.verdict,
        "continuity": report.continuity,
        "letters": {name: plain(ends) for name, ends in report.letters.items()},
        "curvatures": plain(report.curvatures),
        "curvatures_attained": plain(report.attained),
        "curves": [_curve(curve) for curve in report.curves],
        "points": [_parts(point) for point in report.points],
        "statements": [{"text": sentence, "proved": proved} for sentence, proved in report.statements],
        "bounds": plain(cover.bounds),
        "undecided_share": report.undecided_share,
        "boxes_examined": cover.examined,
        "boxes_counted": {name: len(found) for name, found in kinds.items()},
        "boxes": {name: plain(found) for name, found in kinds.items() if boxes or name == "undecided"},
    }
    return json.dumps(record, indent=2, allow_nan=False)


def _curve(curve: SingularCurve) -> dict[str, Any]:
    """What was found, and what follows from it."""
    angles = plain(curve.dihedral_angles)
    return {**_parts(curve), "closed": curve.closed, "length": curve.length, "dihedral_angles": angles}


def _parts(one: Defect) -> dict[str, Any]:
    return {part.name: plain(getattr(one, part.name)) for part in fields(one)}
