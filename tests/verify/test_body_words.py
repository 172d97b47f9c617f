"""What a report on a body says, to people and to programs; the numbers of the reports are made by hand."""

import dataclasses
import json
import math

import numpy as np
import pytest
from oracles import body_reports
from oracles.closeness import assert_close
from oracles.schema import own_keys, strictly_read
from verify.test_reports import Tags

from rsym.reports.numbers import interval
from rsym.verify.answers.singular import SingularCurve, SingularPoint


@pytest.mark.parametrize("make", body_reports.EVERY)
def test_a_text_is_a_paragraph_and_a_line_for_each_group(make):
    report = make()
    first, *rest = str(report).splitlines()
    assert first.startswith(f"{report.verdict}: ")
    assert report.continuity in first or report.verdict in ("DEGENERATE", "UNDECIDED")
    groups = {(one.kind, frozenset(one.names)) for one in (*report.curves, *report.points)}
    assert len(rest) == len(groups)
    assert [line.split(".")[0].strip() for line in rest] == [str(k + 1) for k in range(len(rest))]
    for unknown in ("nan", "inf", "None"):
        assert unknown not in str(report)


def test_the_box_is_told_exactly():
    first, *rest = str(body_reports.box()).splitlines()
    assert first == (
        "REFUTED: the boundary within [-2, 2] x [-2, 2] x [-2, 2] is not G2 but G0; this is proved. "
        "1000 boxes were examined. Proved: every edge was followed from corner to corner. "
        "Numerical, not proved: no other curve was found."
    )
    assert rest[0] == (
        "  1. edge between back and top from (-1, 0.8, 0.6) to (1, 0.8, 0.6), length 2: the tangent plane turns by "
        "90 degrees, the angle through the inside is 90; G0, proved; traced with proof"
    )
    assert rest[12] == (
        "  13. corner of right, back and top at (1, 0.8, 0.6): the normals differ by up to 90 degrees; G0, proved"
    )


def test_equal_curves_are_told_together():
    first, line = str(body_reports.capsule()).splitlines()
    assert "with r = 0.5, is not G2 but G1; this is proved" in first
    assert "all principal curvatures lie in [0, 2.063]; those found go from 0 to 2." in first
    assert "2 curvature jumps between tube and cap, closed, within [-0.5, 0.5] x [-0.5, 0.5] x [-1, 1]" in line
    # The circumference of a polygon of 64 sides.
    assert f"total length {2 * 64 * math.sin(math.pi / 64):.4g}:" in line
    assert "the normal curvature jumps by 2; G1, proved" in line


def test_a_concave_edge_has_more_than_half_a_turn_inside():
    _, step, inner = str(body_reports.notched()).splitlines()
    assert "turns by 90 degrees, the angle through the inside is 90;" in step
    assert "turns by 90 degrees, the angle through the inside is 270;" in inner


def test_of_a_varying_edge_the_range_is_told():
    plain = body_reports.edge([[0, 0, 0], [0, 1, 0], [0, 2, 0]], [0, 0, 1], [1, 0, 0], ("a", "a"))
    turns = np.array([30.0, 60.0, 80.0])
    varying = dataclasses.replace(
        plain, tangent_jumps=turns, tangent_jump=80.123456, tangent_jump_error=1e-4, traced=False, proved=False
    )
    assert "edge within a from" in str(varying)
    assert "turns by 30 to 80.12 degrees, the angle through the inside is between 100 and 150" in str(varying)
    assert str(varying).endswith("G0, not proved; traced numerically")
    doubtful = dataclasses.replace(plain, tangent_jump_error=1e-4)
    assert "turns by 90.0000 ± 0.0002 degrees, the angle through the inside is 90.0000 ± 0.0002;" in str(doubtful)


def test_what_is_not_known_of_an_edge_is_not_told():
    plain = body_reports.edge([[0, 0, 0], [0, 1, 0]], [0, 0, 1], [1, 0, 0], ("", ""))
    worst_unknown = dataclasses.replace(plain, tangent_jump=math.nan, tangent_jump_error=math.nan)
    assert "edge from (0, 0, 0) to (0, 1, 0), length 1: the tangent plane turns by 90 degrees" in str(worst_unknown)
    nothing = dataclasses.replace(worst_unknown, tangent_jumps=np.full(2, math.nan))
    assert ": the tangent plane turns; G0" in str(nothing)


@pytest.mark.parametrize(
    ("kind", "continuity", "words"),
    [
        ("smooth joint", "G2", "the curvature is continuous; G2"),
        ("unbounded curvature", "G1", "the curvature grows without bound; G1"),
        ("unresolved", "unknown", "not resolved; unknown"),
    ],
)
def test_every_kind_of_curve_has_its_words(kind, continuity, words):
    curve = dataclasses.replace(body_reports.capsule().curves[0], kind=kind, continuity=continuity, reason="why.")
    assert words in str(curve)
    assert str(curve).endswith("; traced with proof")
    assert str(dataclasses.replace(curve, proved=False)).endswith(", not proved; traced with proof; why")
    report = dataclasses.replace(body_reports.capsule(), curves=(curve,))
    assert str(report).splitlines()[1].startswith("  also " if continuity == "G2" else "  1. ")


def test_an_unresolved_box_is_a_place():
    normals = body_reports.capsule().curves[0].normals[:1]
    unknown = np.array([math.nan])
    points = np.array([[0.5, 1e-40, 2.0]])
    box = SingularCurve(points, 0.0123, "unresolved", "G0", ("a", "b"), normals, unknown, unknown, reason="why")
    assert str(box) == (
        "unresolved place between a and b at (0.5, 0, 2) within 0.013: what happens here is not resolved; "
        "G0, not proved; why"
    )
    other = dataclasses.replace(box, points=points + 1, reason="why not")
    report = dataclasses.replace(body_reports.undecided(), curves=(box, other))
    line = str(report).splitlines()[1]
    assert line == (
        "  1. 2 unresolved places between a and b, within [0.5, 1.5] x [0, 1] x [2, 3]: "
        "what happens here is not resolved; G0, not proved; why; why not"
    )


@pytest.mark.parametrize("kind", ["cone tip", "node", "tangency", "isolated point", "end", "no sign change"])
def test_every_kind_of_point_has_its_words(kind):
    point = SingularPoint((0.0, 0.5, -0.0), 0.25, kind, "broken", tangent_jump=60.0, tangent_jump_error=0.01)
    assert str(point).startswith(f"{kind} at (0, 0.5, 0) within 0.25: ")
    assert "60.00 ± 0.02 degrees" in str(point)
    assert str(point).endswith("broken, not proved")


def test_what_degenerates_a_body_comes_before_its_edges():
    report = dataclasses.replace(body_reports.double_cone(), curves=body_reports.notched().curves)
    assert "1. node of upper and lower at (0, 0, 0)" in str(report).splitlines()[1]


def test_the_share_that_is_undecided_is_a_bound():
    report = body_reports.undecided()
    # Two boxes of side 1/2 among 99 of side 1, counted by the squares of their sides.
    assert_close(report.undecided_share, 0.5 / 99.5, rtol=1e-12)
    assert "Of the boundary 0.51 %, in 2 boxes, is undecided." in str(report)
    assert "for every a in [1, 2]" in str(report)


@pytest.mark.parametrize(
    "ends", [(-1.000001, 2.000001), (0.123456, 0.123457), (-5e-9, 1.0), (0.0, 0.1 + 0.2), (-1e-300, 0.2)]
)
def test_what_is_printed_of_an_enclosure_encloses(ends):
    low, high = map(float, interval(*ends).strip("[]").split(","))
    assert low <= ends[0] < ends[1] <= high
    assert_close([low, high], ends, rtol=2e-3, atol=1e-9)


@pytest.mark.parametrize("make", body_reports.EVERY)
def test_json_has_stable_keys_and_finite_numbers(make):
    report = make()
    record = strictly_read(report.to_json())
    assert (
        own_keys(record)
        == (
            "letters curvatures curvatures_attained curves points undecided_share bounds boxes_examined boxes_counted "
            "boxes"
        ).split()
    )
    assert (record["format"], record["version"]) == ("rsym-body-report", 1)
    assert (record["verdict"], record["continuity"]) == (report.verdict, report.continuity)
    assert record["curvatures"] == [end if math.isfinite(end) else None for end in report.curvatures]
    assert record["boxes"]["undecided"] == report.undecided.tolist()
    assert set(json.loads(report.to_json(boxes=True))["boxes"]) == {"certified", "joined", "undecided"}


def test_a_curve_and_a_point_can_be_read_back():
    for report in (body_reports.box(), body_reports.capsule()):
        record = json.loads(report.to_json())
        for kept, read in zip((*report.curves, *report.points), record["curves"] + record["points"], strict=True):
            kind = SingularCurve if "normals" in read else SingularPoint
            parts = [part.name for part in dataclasses.fields(kind)]
            assert [name for name in read if name not in ("closed", "length", "dihedral_angles")] == parts
            for name in parts:
                value = getattr(kept, name)
                if isinstance(value, np.ndarray):
                    again = np.array(read[name], float)  # null becomes NaN
                    assert again.shape == value.shape
                    assert np.array_equal(again, value, equal_nan=True)
                elif isinstance(value, float) and math.isnan(value):
                    assert read[name] is None
                else:
                    assert read[name] == (list(value) if isinstance(value, tuple) else value)


@pytest.mark.parametrize("make", body_reports.EVERY)
def test_the_table_of_a_notebook_is_whole_and_runs_nothing(make):
    report = make()
    text = report._repr_html_()
    tags = Tags()
    tags.feed(text)
    assert tags.open == []
    lines = len(str(report).splitlines()) - 1
    assert tags.rows == (1 + lines if lines else 0)
    assert report.verdict in text
    assert "<script" not in text


def test_the_table_escapes_what_it_is_given():
    edge = body_reports.edge([[0, 0, 0], [0, 1, 0]], [0, 0, 1], [1, 0, 0], ("x < 1", "<b>"))
    text = dataclasses.replace(body_reports.notched(), curves=(edge,))._repr_html_()
    assert "x &lt; 1 | &lt;b&gt;" in text
    assert "90 degrees" in text
