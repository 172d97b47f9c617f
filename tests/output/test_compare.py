import json

import matplotlib.pyplot
import mpmath as mp
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y
from rsym.cli import main
from rsym.output.designs import plot_designs
from rsym.output.fairness import plot_fairness
from rsym.verify.fairness.designs import compare_designs
from rsym.verify.fairness.fairness import fairness

MODEL = """
letter a = 2 in [0.5, 3] "half axis"
letter idle = 1
variant round: a = 1.25
variant long: a = 3
bounds x [-4, 4] y [-2, 2]
omega = 1 - x^2/a^2 - y^2
"""
A = sp.Symbol("a", real=True)
OVAL = rsym.Shape(1 - x**2 / A**2 - y**2, (x, y), letters={A: 2}, bounds=((-4, 4), (-2, 2)))
STADIUM = rsym.Shape(1 - sp.Max(sp.Abs(x) - 1, 0) ** 2 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "oval.rf").write_text(MODEL)
    for name, value in (("blunt", 1.25), ("sharp", 3)):
        rsym.save_letters({"a": value, "idle": 2}, tmp_path / f"{name}.json")
    return tmp_path


@pytest.fixture(scope="module")
def table():
    return compare_designs(OVAL, {"blunt": {"a": 1.25}, "sharp": {"a": 3}}, tolerance=0.1)


@pytest.mark.slow
def test_designs_keep_their_order_and_the_best_is_marked(table):
    assert [design.name for design in table.designs] == ["blunt", "sharp"]
    assert table.differing == ("a",)
    text = str(table).splitlines()
    assert text[0].split()[0] == "design"
    assert [line.split()[0] for line in text[1:3]] == ["blunt", "sharp"]
    marked = {table.columns[column - 1].heading: row for row, column in table.best()}
    # The curvature runs from 1/a**2 to a: the blunt one is better at either end and in both energies.
    assert marked == dict.fromkeys(
        ["|curvature| <=", "curvature >=", "curvature <=", "variation <=", "bending energy", "variation energy"], 0
    )
    assert text[1].count("*") == 6
    assert text[2].count("*") == 0
    assert table._repr_html_().count("<b>") == 6


def test_bounds_in_the_table_are_rounded_outwards(table):
    for design, a in zip(table.designs, (1.25, 3), strict=True):
        cells = {column.heading: column.text(design) for column in table.columns}
        assert float(cells["curvature >="]) <= design.peak("least").bound <= 1 / a**2
        assert a <= design.peak("greatest").bound <= float(cells["curvature <="])


def test_the_table_as_a_record(table):
    record = json.loads(table.to_json())
    assert record["format"] == "rsym-design-table"
    assert [row["letters"]["a"] for row in record["designs"]] == [1.25, 3]
    assert [row["report"]["verdict"] for row in record["designs"]] == ["CERTIFIED"] * 2


@pytest.mark.slow
def test_the_command_end_to_end(folder, capsys):
    picture = folder / "designs.png"
    files = [str(folder / "sharp.json"), str(folder / "blunt.json")]
    assert main(["compare", str(folder / "oval.rf"), "--letters", *files, "-o", str(picture)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines[1:3]] == [
        ["sharp", "CERTIFIED", "analytic"],
        ["blunt", "CERTIFIED", "analytic"],
    ]
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_command_prints_json(folder, capsys):
    assert main(["compare", str(folder / "oval.rf"), "--letters", str(folder / "blunt.json"), "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["designs"]
    assert row["name"], row["letters"] == ("blunt", {"a": 1.25})


@pytest.mark.slow
def test_without_letters_the_variants_are_compared(folder, capsys):
    assert main(["compare", str(folder / "oval.rf")]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()[1:3]] == ["round", "long"]


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ('{"a": 1, "b": 2}', "'b'"),
        ('{"a": 7}', "[0.5, 3]"),
        ("{", "no JSON"),
        (None, "cannot read"),
    ],
)
def test_a_bad_file_is_named_before_any_work(folder, capsys, monkeypatch, text, meant):
    monkeypatch.setattr("rsym.verify.fairness.designs.fairness", lambda *_, **__: pytest.fail("work was done"))
    bad = folder / "bad.json"
    if text is not None:
        bad.write_text(text)
    assert main(["compare", str(folder / "oval.rf"), "--letters", str(folder / "blunt.json"), str(bad)]) == 1
    error = capsys.readouterr().err
    assert str(bad) in error
    assert meant in error


def test_other_input_that_is_refused(folder, capsys):
    model, file = str(folder / "oval.rf"), str(folder / "blunt.json")
    for arguments, meant in [
        (["--letters", file, file], "twice"),
        (["--letters", file, "-o", "designs.txt"], ".png"),
        (["--set", "a=x"], "--set"),
    ]:
        assert main(["compare", model, *arguments]) == 1
        assert meant in capsys.readouterr().err
    (folder / "plain.rf").write_text("bounds x [-2, 2] y [-2, 2]\nomega = 1 - x^2 - y^2\n")
    assert main(["compare", str(folder / "plain.rf")]) == 1
    assert "--letters" in capsys.readouterr().err


@pytest.mark.slow
def test_two_files_of_one_name_are_told_apart(folder, capsys):
    (folder / "other").mkdir()
    rsym.save_letters({"a": 2.5}, folder / "other" / "blunt.json")
    files = [str(folder / "blunt.json"), str(folder / "other" / "blunt.json")]
    assert main(["compare", str(folder / "oval.rf"), "--letters", *files, "--json"]) == 0
    assert [row["name"] for row in json.loads(capsys.readouterr().out)["designs"]] == files


def test_a_letter_out_of_range_names_the_design():
    letters = {"a": rsym.Letter(2, minimum=1, maximum=3)}
    shape = rsym.Shape(1 - x**2 / A**2 - y**2, (x, y), letters=letters, bounds=((-4, 4), (-2, 2)))
    with pytest.raises(rsym.RsymError, match="thin"):
        compare_designs(shape, {"fine": {}, "thin": {"a": 9}})
    with pytest.raises(rsym.RsymError, match="at least one"):
        compare_designs(shape, {})


def test_the_picture_of_designs_has_one_scale(table):
    figure = plot_designs(table)
    first, second, bar = figure.axes
    limits = [ax.collections[0].get_clim() for ax in (first, second)]
    assert limits[0] == limits[1]
    assert_close(limits[0], (1 / 9, 3), rtol=1e-12)
    assert bar.get_ylabel() == r"curvature $\kappa$"
    assert first.get_title().startswith("blunt")


def test_the_picture_of_a_curve_shows_extrema_and_the_proved_band():
    report = fairness(OVAL, tolerance=0.1)
    curve, graph, _ = plot_fairness(report).axes
    marks = [line.get_xydata()[0] for line in curve.lines if len(line.get_xydata()) == 1]
    assert sorted((round(px), round(py)) for px, py in marks) == [(-2, 0), (0, -1), (0, 1), (2, 0)]
    assert sorted(text.get_text() for text in curve.texts) == ["1", "2", "3", "4"]
    (line,) = (line for line in graph.lines if len(line.get_xydata()) > 100)
    along, bend = line.get_xydata().T
    assert_close(along[-1], report.measures["length"].value, rtol=1e-12)
    bands = [path.vertices for path in graph.collections[0].get_paths()]
    for place, value in zip(along[1:-1], bend[1:-1], strict=True):
        assert any(
            (band.min(axis=0) <= (place, value)).all() and ((place, value) <= band.max(axis=0)).all() for band in bands
        )


@pytest.mark.slow
def test_a_broken_curve_and_a_body_of_revolution_can_be_drawn():
    curve, _, _ = plot_fairness(STADIUM).axes
    crosses = next(line.get_xydata() for line in curve.lines if line.get_marker() == "x")
    assert sorted(map(tuple, crosses.round(9).tolist())) == [(-1, -1), (-1, 1), (1, -1), (1, 1)]
    body = plot_fairness(fairness(rsym.revolve(OVAL), tolerance=0.1)).axes[1]
    assert [text.get_text() for text in body.get_legend().get_texts()] == [
        "curvature of the meridian",
        "curvature across the meridian",
    ]
    assert_close(body.get_xlim()[1], 4 * mp.ellipe(0.75), rtol=1e-9)  # half of the ellipse
