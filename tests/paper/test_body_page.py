"""The page of verdicts: what is judged, as what it is told, and that the scales of its pictures are one."""

import matplotlib.pyplot
import pytest
from oracles import body_reports
from oracles.closeness import assert_close

import rsym
from rsym.paper import verdicts


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture
def small(monkeypatch):
    """Two bodies instead of seven, with reports made by hand."""
    shapes = {
        "A box": (body_reports.BOX, body_reports.box()),
        "A capsule": (body_reports.CAPSULE, body_reports.capsule()),
    }
    found = {shape.expression: report for shape, report in shapes.values()}
    asked = []

    def verify_smoothness(shape, *, method):
        asked.append(method)
        return found[shape.expression]

    monkeypatch.setattr(verdicts, "verify_smoothness", verify_smoothness)
    monkeypatch.setattr(verdicts, "bodies", lambda: [(name, shape, None, -55.0) for name, (shape, _) in shapes.items()])
    monkeypatch.setattr(verdicts, "CELLS", 24)
    return asked


def test_the_verdicts_are_found_in_the_run_by_boxes_in_space(small):
    (box, capsule) = verdicts.judge()
    assert small == ["space", "space"]
    assert (box.report.verdict, box.summary) == ("REFUTED", "12 edges, 8 corners")
    assert capsule.summary == "2 curvature jumps"


@pytest.mark.slow
def test_the_page_shows_the_bodies_and_lists_what_was_found(small, tmp_path):
    (result,) = rsym.paper.reproduce(tmp_path, only=["verdicts"])
    rows = result.table.rows
    assert [row[:2] for row in rows if row[0]] == [("A box", "REFUTED"), ("A capsule", "REFUTED")]
    assert len(rows) == 2 + 12 + 8 + 1
    assert rows[-1][2:] == (
        *("curvature jump", "2", "tube | cap", "length 6.281", "the normal curvature jumps by 2", "G1"),
        *("✓ yes", "2 of 2"),
    )
    text = (tmp_path / "index.html").read_text()
    assert "<h2>Bodies with their verdicts</h2>" in text
    assert "tube | cap" in text
    assert result.path.stat().st_size > 20_000


@pytest.mark.slow
def test_all_pictures_share_their_scales(small):
    figure = verdicts.draw_verdicts().figure
    labels = {one.get_ylabel(): one.get_ylim() for one in figure.axes if one.get_ylabel()}
    assert_close(labels["dihedral angle in degrees"], (60, 120), atol=1e-12)
    assert_close(labels["jump of normal curvature, dashed"], (0, 2), atol=1e-12)
    titles = [text.get_text() for text in figure.texts]
    assert titles == ["A box: REFUTED, G0", "12 edges, 8 corners", "A capsule: REFUTED, G1", "2 curvature jumps"]


def test_the_bodies_of_the_page_are_those_that_the_captions_promise():
    """The radius of the fillet is that of the arc between its faces, and the noses differ by one letter."""
    shapes = {name: shape for name, shape, _, _ in verdicts.bodies()}
    assert len(shapes) == 7
    rounded = rsym.compile(shapes["A fillet of radius ½"], ("value", "principal_curvatures"))
    middle = 0.5 - 0.5 / 2**0.5
    fields = rounded(middle, 0.0, middle)
    assert_close(fields["value"], 0, atol=1e-15)
    assert_close(fields["principal_curvatures"], [0, -2], atol=1e-12)
    noses = [shape for name, shape in shapes.items() if name.startswith("Fig. 12")]
    assert [float(nose.letters["a2"].default) for nose in noses] == [5.3, 6]
