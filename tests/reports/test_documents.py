"""Every public report is data and one document; text, HTML and JSON come from it, by one schema."""

import copy
import dataclasses
import itertools
import json
import random
import re
from decimal import Decimal

import pytest
from oracles import body_reports, reports
from oracles.schema import SCHEMA, complaints, not_finite
from verify.test_reports import Tags

import rsym
from rsym.reports import render
from rsym.reports.document import Document, Entry, Sentence, Tabular
from rsym.reports.numbers import at_least, at_most, extents, interval, measured, share
from rsym.reports.render import Report, as_html, as_text

MAKERS = [*reports.EVERY, *body_reports.EVERY]


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_a_report_is_its_document(make):
    report = make()
    document = report.document()
    assert isinstance(report, Report)
    sentences = [document.headline, *document.sentences, *document.statements, *document.notes]
    assert all(isinstance(one, Sentence) and type(one.proved) is bool for one in sentences)
    assert all(type(entry.proved) is bool and entry.text for entry in document.entries)
    assert all(len(entry.cells) in (0, len(document.columns)) for entry in document.entries)
    assert all(len(row) == len(table.header) for table in document.tables for row in table.rows)
    assert str(report) == as_text(document)
    assert report._repr_html_() == as_html(document)
    if document.verdict:
        assert document.headline.text.startswith(document.verdict)
    assert not re.search(r"\b(nan|inf|None)\b", str(report))


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_json_keeps_the_schema(make):
    def refuse(constant):
        raise AssertionError(constant)

    record = json.loads(make().to_json(), parse_constant=refuse)
    assert complaints(record, SCHEMA) == []
    assert not_finite(record) == []
    assert record["format"].startswith("rsym-")
    assert [one["text"] for one in record["entries"]] == [entry.text for entry in make().document().entries]


def test_the_schema_is_the_documented_one():
    assert re.findall(r"^(\w+) {2,}\S", render.__doc__, re.MULTILINE) == list(SCHEMA)


def test_the_check_of_the_schema_sees_what_is_wrong():
    """Red proof."""
    record = json.loads(reports.refuted_corner().to_json())
    for damage in (
        lambda r: r.pop("headline"),
        lambda r: r["sentences"][0].pop("proved"),
        lambda r: r["entries"].append("a string"),
        lambda r: r.update(version=2),
        lambda r: r.update(verdict="MAYBE"),
    ):
        damaged = copy.deepcopy(record)
        damage(damaged)
        assert complaints(damaged, SCHEMA)


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_html_is_whole_and_runs_nothing(make):
    tags = Tags()
    tags.feed(make()._repr_html_())
    assert tags.open == []
    assert "<script" not in make()._repr_html_()


def test_every_public_report_has_a_document():
    kinds = [getattr(rsym, name) for name in rsym.__all__ if name.endswith(("Report", "Status"))]
    assert {kind.__name__ for kind in kinds} >= {"SmoothnessReport", "BodyReport"}
    made = {type(make()) for make in MAKERS}
    for kind in kinds:
        if kind in made:
            assert dataclasses.is_dataclass(kind)
            assert issubclass(kind, Report)


def test_numbers_and_labels_of_entries():
    entries = tuple(Entry(f"{k}", True, told=k != 1, label="also" if k == 4 else None) for k in range(6))
    document = Document("x", Sentence("Six.", True), entries=entries, most=4)
    assert as_text(document).splitlines() == ["Six.", "  1. 0", "  3. 2", "  4. 3", "  also 4", "  and 1 more"]


def test_tables_in_text_and_html():
    table = Tabular(("what", "class"), (("<seam>", "G1"), ("hull", "G2")), frozenset({(1, 1)}), "Edges")
    document = Document("x", Sentence("Two.", False), tables=(table,))
    assert as_text(document).splitlines() == ["Two.", "Edges", "  what    class", "  <seam>  G1", "  hull    G2*"]
    assert "<b>G2</b>" in as_html(document)
    assert "&lt;seam&gt;" in as_html(document)


def values(count=400):
    """Numbers of all sizes, many of them near a round one."""
    draw = random.Random(7)
    for _ in range(count):
        size = 10.0 ** draw.uniform(-300, 300) if draw.random() < 0.2 else 10.0 ** draw.uniform(-12, 12)
        value = draw.choice((draw.random(), float(draw.randint(1, 999)), round(draw.random(), 3), 1 - 2.0**-53))
        yield draw.choice((-1, 1)) * size * value
    yield from (0.0, 1.0, -1.0, 0.1 + 0.2, 3e-308)


@pytest.mark.parametrize("digits", [1, 2, 4, 5, 9])
def test_a_printed_bound_is_a_bound(digits):
    for value in values():
        room = abs(Decimal(value)) * Decimal(10) ** (1 - digits)
        assert 0 <= Decimal(at_most(value, digits)) - Decimal(value) <= room
        assert 0 <= Decimal(value) - Decimal(at_least(value, digits)) <= room


def test_a_printed_enclosure_encloses():
    found = list(values())
    for one, other in itertools.pairwise(found):
        low, high = min(one, other), max(one, other)
        first, last = map(Decimal, interval(low, high).strip("[]").split(", "))
        assert first <= Decimal(low)
        assert Decimal(high) <= last


def test_a_printed_value_is_within_its_printed_error():
    draw = random.Random(8)
    for value in values():
        error = abs(value) * 10.0 ** draw.uniform(-11, 2)
        shown, _, margin = measured(value, error).partition(" ± ")
        off = abs(Decimal(shown) - Decimal(value)) + Decimal(error)
        assert off <= Decimal(margin or 0) if margin else off <= abs(Decimal(value)) * Decimal("2e-11")


def test_a_printed_box_holds_its_points_but_for_a_millionth_of_the_last_digit():
    draw = random.Random(9)
    for _ in range(200):
        size = 10.0 ** draw.uniform(-6, 6)
        ends = [sorted((draw.uniform(-size, size), draw.uniform(-size, size))) for _ in range(3)]
        low, high = zip(*ends, strict=True)
        printed = [part.strip("[]").split(", ") for part in extents(low, high).split(" x ")]
        for (a, b), (first, last) in zip(ends, printed, strict=True):
            assert float(first) <= a + 1e-7 * size
            assert float(last) >= b - 1e-7 * size


def test_a_printed_share_is_a_bound():
    for part in (0.0, 1e-14, 9.9e-6, 1.1e-5, 0.12345, 0.999, 1.0):
        shown = Decimal(re.search(r"[\d.]+", share(part)).group())
        assert shown >= 100 * Decimal(part) * (1 - Decimal("1e-15"))
