"""A report of fairness for programs: JSON with stable keys."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from rsym.reports.render import plain

if TYPE_CHECKING:
    from rsym.verify.fairness.report import CurvatureBounds, Extremum, FairnessReport, Peak

FORMAT = "rsym-fairness-report"
# Raised when a key changes its meaning or goes; a key may be added without.
VERSION = 1


def fairness_json(report: FairnessReport) -> str:
    """A report as JSON text: every number is finite, and null says unknown or no bound."""
    return json.dumps(fairness_record(report), indent=2, allow_nan=False)


def fairness_record(report: FairnessReport) -> dict[str, Any]:
    """What JSON says of a report."""
    return {
        "format": FORMAT,
        "version": VERSION,
        "kind": report.kind,
        "coordinates": list(report.coordinates),
        "verdict": report.verdict,
        "continuity": report.continuity,
        "letters": {name: plain(ends) for name, ends in report.smoothness.letters.items()},
        "curvatures": [_bounds(bounds) for bounds in report.curvatures],
        "extrema": [_extremum(one) for one in report.extrema],
        "inflections": [_extremum(one) for one in report.inflections],
        "complete": report.complete,
        "constant": list(report.constant),
        "measures": {
            name: {"value": plain(measure.value), "estimated_error": plain(measure.error)}
            for name, measure in report.measures.items()
        },
        "statements": [{"text": sentence, "proved": proved} for sentence, proved in report.statements],
    }


def _bounds(bounds: CurvatureBounds) -> dict[str, Any]:
    peaks = {name: _peak(getattr(bounds, name)) for name in ("least", "greatest", "variation")}
    return {"name": bounds.name, **peaks}


def _peak(peak: Peak) -> dict[str, Any]:
    return {name: plain(value) for name, value in asdict(peak).items()}


def _extremum(one: Extremum) -> dict[str, Any]:
    return {name: plain(value) for name, value in asdict(one).items()}
