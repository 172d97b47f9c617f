"""A verdict for programs: JSON with stable keys."""

from __future__ import annotations

import json
import math
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from rsym.verify.report import Joint, SmoothnessReport

FORMAT = "rsym-smoothness-report"
# Raised when a key changes its meaning or goes; a key may be added without.
VERSION = 1


def report_json(report: SmoothnessReport, *, boxes: bool = False) -> str:
    """A report as JSON text: every number is finite, and null says unknown or, for the curvature bound, none.

    Parameters
    ----------
    report : SmoothnessReport
        What to write.
    boxes : bool
        Whether to list the certified and the joined boxes too, of which there may be thousands.

    Examples
    --------
    >>> import json, math
    >>> import numpy as np
    >>> from rsym.verify.report import Cover, SmoothnessReport
    >>> none = np.empty((0, 2, 2))
    >>> cover = Cover(((-2, 2), (-2, 2)), none, none, none, 1)
    >>> record = json.loads(report_json(SmoothnessReport("DEGENERATE", "broken", (), (), math.inf, cover, {})))
    >>> record["verdict"], record["curvature_bound"], record["version"]
    ('DEGENERATE', None, 1)
    """
    cover = report.cover
    kinds = {"certified": cover.certified, "joined": cover.joined, "undecided": cover.undecided}
    listed = {name: plain(found) for name, found in kinds.items() if boxes or name == "undecided"}
    record = {
        "format": FORMAT,
        "version": VERSION,
        "verdict": report.verdict,
        "continuity": report.continuity,
        "body_of_revolution": report.body,
        "letters": {name: plain(ends) for name, ends in report.letters.items()},
        "curvature_bound": plain(report.curvature_bound),
        "defects": [_joint(joint) for joint in report.defects],
        "joints": [_joint(joint) for joint in report.joints],
        "statements": [{"text": sentence, "proved": proved} for sentence, proved in report.statements],
        "bounds": plain(cover.bounds),
        "boxes_examined": cover.examined,
        "boxes_counted": {name: len(found) for name, found in kinds.items()},
        "boxes": listed,
    }
    return json.dumps(record, indent=2, allow_nan=False)


def _joint(joint: Joint) -> dict[str, Any]:
    return {part.name: plain(getattr(joint, part.name)) for part in fields(joint)}


def plain(value: Any) -> Any:
    """Lists for arrays and tuples; null for what is not finite."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
