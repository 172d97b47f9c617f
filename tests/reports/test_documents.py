"""Every public report is data and one document; text, HTML and JSON come from it, by one schema."""

import copy
import dataclasses
import functools
import itertools
import json
import random
import re
import tempfile
from decimal import Decimal

import pytest
import sympy as sp
from oracles import body_reports, reports
from oracles.schema import SCHEMA, complaints, not_finite, strictly_read
from verify.test_reports import Tags

import rsym
from rsym import x, y, z
from rsym.reports import render
from rsym.reports.document import Document, Entry, Sentence, Tabular
from rsym.reports.numbers import at_least, at_most, extents, interval, measured, share
from rsym.reports.render import Report, as_html, as_text
from rsym.surfaces import BSplineSurface, CoonsPatch, HermiteBlend, continuity_report, torus
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v
from rsym.verify.answers.report import Verdict
from rsym.verify.threshold import Threshold

BOX = ((-2, 2), (-2, 2))
a = sp.Symbol("a", real=True)


def fair_ellipse():
    return rsym.fairness(rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2))))


def fitted():
    return rsym.fit(
        rsym.disc(a, letters={a: rsym.Letter(1.5, minimum=1.2)}), [[1, 0], [0, 1], [-1, 0.1]], [a], loss="huber"
    )


def moving():
    return rsym.sensitivity(rsym.disc(a, letters={a: 1}), a, resolution=32)


def measured_oval():
    return rsym.measure(rsym.Shape(1 - x**2 / 4 - y**2, (x, y)).named("oval"))


def solved_disc():
    return rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8).report


def designs():
    oval = rsym.Shape(1 - x**2 / a**2 - y**2, (x, y), letters={a: 2}, bounds=((-4, 4), (-2, 2)))
    return rsym.compare_designs(oval, {"round": {"a": 1.25}, "long": {"a": 3}}, tolerance=0.1)


def repaired_roof():
    return rsym.repair(rsym.Shape(1 - abs(x) - y, (x, y), bounds=BOX), moves=["round"], radius=0.1)


def nothing_to_repair():
    return rsym.repair(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=BOX))


def lint():
    return rsym.lint(rsym.Shape(rsym.conjunction(2 * x, y), (x, y), bounds=BOX))


def clean():
    return rsym.lint(rsym.Shape(x, (x, y), bounds=BOX))


def normalised_line():
    return rsym.verify_normalisation(rsym.Shape(2 * x, (x, y), bounds=BOX), resolution=16)


def atlas():
    wall = rsym.Shape(y - abs(x - 1) + 2, (x, y), letters={"a": 1, "b": 2}, bounds=((-3, 3), (-4, 3)))
    return rsym.smoothness_atlas(wall, "a", "b")


def path():
    line, arc = rsym.Curve((x, 0), x, -1, 0), rsym.Curve((sp.sin(x), 1 - sp.cos(x)), x, 0, 1)
    return rsym.continuity([line, arc])


def edges():
    return continuity_report(torus(3, 1)[:2], prove=True)


def edges_by_samples():
    return continuity_report([ParametricSurface((u, v, 0)), ParametricSurface((u, -v, v))])


def threshold():
    return Threshold("a2", 5.3076, 5.3078, ((5.3, "REFUTED"), (5.35, "CERTIFIED")))


def systems():
    quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=BOX)
    return rsym.compare_systems(quadrant, systems=(rsym.R0, rsym.Rp(4)))


def mesh_status():
    return rsym.mesh(rsym.sphere(), 8).status


def file_status():
    with tempfile.TemporaryDirectory() as folder:
        return rsym.mesh(rsym.sphere(), 8, into=f"{folder}/ball.ply").status


def clipped_mesh():
    tube = rsym.Shape(1 - x**2 - y**2, (x, y, z), bounds=((-2, 2), (-2, 2), (-1, 1)))
    with pytest.warns(rsym.RsymWarning, match="clipped"):
        return rsym.mesh(tube, 8).status


def level_lines():
    return rsym.level_lines(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=BOX), resolution=16).status


def refused_blend():
    return HermiteBlend.class2(4, 1).is_monotone()


def corrected_patch():
    return CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, 0.99 * t), tolerance=0.02).correction


def corrected_fit():
    points = [[[i, j, abs(i - 3) * j] for j in range(5)] for i in range(7)]
    return BSplineSurface.least_squares(points, (5, 4), corrections=3).fit


def contract():
    return rsym.Shape(rsym.conjunction(x, 2 * y), (x, y)).contract()


REAL = [
    contract,
    fair_ellipse,
    designs,
    repaired_roof,
    nothing_to_repair,
    lint,
    clean,
    normalised_line,
    atlas,
    path,
    edges,
]
REAL += [edges_by_samples, threshold, systems, mesh_status, file_status, clipped_mesh]
REAL += [level_lines, refused_blend, corrected_patch, corrected_fit, fitted, moving, measured_oval, solved_disc]
MAKERS = [functools.cache(make) for make in (*reports.EVERY, *body_reports.EVERY, *REAL)]


@pytest.mark.random
@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_a_report_is_its_document(make):
    report = make()
    document = report.document()
    assert isinstance(report, Report)
    sentences = [document.headline, *document.sentences, *document.statements, *document.remarks]
    assert all(isinstance(one, Sentence) and type(one.proved) is bool for one in sentences)
    assert all(one.text for one in sentences if one is not document.headline)
    assert all(type(entry.proved) is bool and entry.text for entry in document.entries)
    assert all(len(entry.cells) in (0, len(document.columns)) for entry in document.entries)
    assert all(len(row) == len(table.header) for table in document.tables for row in table.rows)
    assert str(report) == as_text(document)
    assert report._repr_html_() == as_html(document)
    assert not re.search(r"\b(nan|inf|None)\b", str(report))


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_json_keeps_the_schema(make):
    record = strictly_read(make().to_json())
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
    """What is public and called a report, a table, an atlas, a threshold or a status is one, and is tested here."""
    made = {type(make()) for make in MAKERS}
    words = ("Report", "Table", "Atlas", "Threshold", "Status")
    public = {getattr(room, name) for room in (rsym, rsym.surfaces) for name in room.__all__ if name.endswith(words)}
    public |= set(subclasses(Report)) - {Verdict}
    assert len(public) >= 12
    for kind in public:
        assert dataclasses.is_dataclass(kind)
        assert issubclass(kind, Report), kind
        assert {"__str__", "_repr_html_"}.isdisjoint(vars(kind)), f"{kind}: text and HTML come from the document"
    assert public == made


def subclasses(kind):
    return [one for each in kind.__subclasses__() for one in (each, *subclasses(each))]


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
