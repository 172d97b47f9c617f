"""What a report says, to people and to programs; the numbers of the reports are made by hand."""

import dataclasses
import html.parser
import json
import math

import pytest
import sympy as sp
from oracles import reports
from oracles.schema import own_keys, strictly_read

import rsym
from rsym import x, y
from rsym.reports.numbers import at_most, measured
from rsym.verify.answers.report import Joint


@pytest.mark.parametrize("make", reports.EVERY)
def test_a_text_is_a_paragraph_and_a_line_for_each_place(make):
    report = make()
    first, *rest = str(report).splitlines()
    assert first.startswith(f"{report.verdict}: ")
    assert report.continuity in first or report.verdict in ("DEGENERATE", "UNDECIDED")
    assert len(rest) == len(report.defects) + len(report.joints)
    assert [line.split(".")[0].strip() for line in rest] == [str(k + 1) for k in range(len(report.defects))]
    assert "nan" not in str(report)
    assert "inf" not in str(report)


def test_the_text_gives_the_turn_and_says_what_is_proved():
    first, corner = str(reports.refuted_corner()).splitlines()
    assert "not G2 but G0; this is proved" in first
    assert "Proved: two analytic arcs" in first
    assert "Numerical, not proved: there is no other defect" in first
    assert "(-4.99212109629, 0)" in corner
    assert "turns by 144.811726903 degrees" in corner
    assert "0.0433063556 on both sides" in corner
    guess = dataclasses.replace(reports.refuted_corner().defects[0], proved=False, reason="by extrapolation")
    assert str(guess).endswith("not proved; by extrapolation")


def test_letters_that_are_intervals_come_first():
    assert "for every b in [0.5, 1] with a = 2" in str(reports.certified_ellipse())


@pytest.mark.parametrize(
    ("joint", "words"),
    [
        (Joint((0.0, 0.0), 0.0, "cusp", "G0"), "runs back"),
        (Joint((0.0, 0.0), 0.0, "unbounded curvature", "G1"), "without bound"),
        (Joint((0.0, 0.0), 0.0, "node", "broken", 6), "6 branches"),
        (Joint((0.0, 0.0), 0.0, "smooth joint", "G2", derivative_jump=2.0), "derivative jumps by 2;"),
        (Joint((0.0, 0.0), 0.0, "smooth joint", "G3", derivative_jump=0.0), "curvature is continuous;"),
        (Joint((0.0, 0.0), 0.0, "corner", "G0", tangent_jump=90.0, tangent_jump_error=0.01), "90.00 ± 0.02 degrees;"),
        (Joint((0.0, 0.0), 0.1, "unresolved", "unknown"), "(0, 0) within 0.1"),
    ],
)
def test_every_kind_of_place_has_its_words(joint, words):
    assert words in str(joint)


def test_what_is_printed_of_a_bound_is_a_bound():
    for value in (108.7101, 1.00001, 9.9999999, 1e-300, 123456.7, 0.1 + 0.2):
        for digits in (1, 2, 4):
            assert value <= float(at_most(value, digits)) <= value * (1 + 10.0 ** (1 - digits))
    for value, error in ((144.8117269, 2.3e-4), (1.0, 0.99), (0.0, 3e-7), (1e6, 40.0)):
        shown, _, margin = measured(value, error).partition(" ± ")
        assert abs(float(shown) - value) + error <= float(margin) <= 3 * error + 1


@pytest.mark.parametrize("make", reports.EVERY)
def test_json_has_stable_keys_and_finite_numbers(make):
    report = make()
    record = strictly_read(report.to_json())
    assert (
        own_keys(record)
        == (
            "body_of_revolution letters curvature_bound defects joints bounds boxes_examined boxes_counted boxes"
        ).split()
    )
    assert (record["format"], record["version"]) == ("rsym-smoothness-report", 1)
    assert record["verdict"] == report.verdict
    assert record["curvature_bound"] == (report.curvature_bound if math.isfinite(report.curvature_bound) else None)
    assert record["boxes"]["undecided"] == report.undecided.tolist()
    assert [one["point"] for one in record["defects"]] == [list(joint.point) for joint in report.defects]
    assert set(json.loads(report.to_json(boxes=True))["boxes"]) == {"certified", "joined", "undecided"}


def test_the_keys_of_a_defect_are_those_of_a_joint():
    (corner,) = json.loads(reports.refuted_corner().to_json())["defects"]
    assert list(corner) == [part.name for part in dataclasses.fields(Joint)]
    assert corner["derivative_jump"] is None
    assert corner["tangent_jump"] == 144.811726903428


class Tags(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.rows = [], 0

    def handle_starttag(self, tag, attributes):
        if tag != "br":
            self.open.append(tag)
        self.rows += tag == "tr"

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize("make", reports.EVERY)
def test_the_table_of_a_notebook_is_whole_and_runs_nothing(make):
    report = make()
    text = report._repr_html_()
    tags = Tags()
    tags.feed(text)
    assert tags.open == []
    assert tags.rows == (1 + len(report.defects) + len(report.joints) if report.defects or report.joints else 0)
    assert report.verdict in text
    assert "<script" not in text


def test_the_table_escapes_what_it_is_given():
    report = dataclasses.replace(reports.refuted_corner(), letters={"<b>": (1.0, 1.0)}, statements=(("1 < 2", True),))
    assert "&lt;b&gt; = 1" in report._repr_html_()
    assert "1 &lt; 2" in report._repr_html_()


def test_a_report_says_whether_ends_of_domains_count_as_boundary():
    round_part = sp.sqrt(1 - x**2 - y**2) + 1
    for omega, said in ((round_part, "does not count"), (rsym.disjunction(round_part, y - 3), "that counts")):
        report = rsym.verify_smoothness(rsym.Shape(omega, (x, y), bounds=((-2, 2),) * 2))
        (statement,) = [text for text, _ in report.statements if "no value beyond" in text]
        assert said in statement
    report = rsym.verify_smoothness(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2),) * 2))
    assert not any("no value beyond" in text for text, _ in report.statements)
