"""`rsym verify`: what it prints, what it writes, and what its exit code says."""

import json
import math

import matplotlib.pyplot
import pytest
from oracles import body_reports, reports

import rsym.verify.smoothness
from rsym.cli import main
from rsym.commands.options import ranges
from rsym.commands.verify import CODES

MODEL = """
letter a = 2 in [1, 3] "half the length"
letter b = 1 in [0.5, 2] "half the height"
coordinates x y
bounds x [-3.5, 3.5] y [-2.5, 2.5]
ellipse = 1 - x^2/a^2 - y^2/b^2
half = rfAND(ellipse, x)
loops = x^2 - y^2 - (x^2 + y^2)^2
nothing = -1 - x^2
omega = ellipse
"""


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "ellipse.rf"
    path.write_text(MODEL)
    return str(path)


@pytest.mark.random
@pytest.mark.parametrize(
    ("arguments", "verdict", "code"),
    [
        ([], "CERTIFIED", 0),
        (["--set", "a=1.5:2.5"], "CERTIFIED", 0),
        (["--shape", "half"], "REFUTED", 1),
        (["--shape", "loops"], "DEGENERATE", 3),
        (["--shape", "nothing"], "DEGENERATE", 3),
        (["--revolve", "x"], "CERTIFIED", 0),
    ],
)
def test_the_exit_code_is_the_verdict(model, arguments, verdict, code, capsys):
    assert main(["verify", model, *arguments]) == code == CODES[verdict]
    assert capsys.readouterr().out.startswith(f"{verdict}: ")


def test_an_undecided_verdict_is_code_3(model, monkeypatch, capsys):
    monkeypatch.setattr(rsym.verify.smoothness, "verify_smoothness", lambda *_, **__: reports.undecided_disc())
    assert main(["verify", model]) == 3
    assert "neither proved nor refuted" in capsys.readouterr().out


SPACE = """
letter r = 1 in [0.5, 2] "radius"
coordinates x y z
bounds x [-1.3, 1.2] y [-1.3, 1.2] z [-1.3, 1.2]
ball = r^2 - x^2 - y^2 - z^2
cut = rfAND(ball, x - y/3 - 1/5)
cones = (x - y/8)^2 - (y + x/8)^2 - z^2
omega = ball
"""


@pytest.mark.random
@pytest.mark.parametrize(
    ("arguments", "verdict", "code", "told"),
    [
        ([], "CERTIFIED", 0, "the surface of revolution with the meridian"),
        (["--method", "space"], "CERTIFIED", 0, "all principal curvatures lie in"),
        # The plane is 0.2/|(1, -1/3)| from the middle of the ball of radius 1: the cosine of the turn.
        (["--shape", "cut"], "REFUTED", 1, f"turns by {math.degrees(math.acos(-0.06 * 10**0.5)):.12g} degrees"),
        (["--shape", "cones"], "DEGENERATE", 3, "  1. node of cones at (0, 0, 0)"),
    ],
)
def test_a_body_in_space_has_its_verdict(arguments, verdict, code, told, tmp_path, capsys):
    path = tmp_path / "ball.rf"
    path.write_text(SPACE)
    assert main(["verify", str(path), *arguments]) == code
    text = capsys.readouterr().out
    assert text.startswith(f"{verdict}: ")
    assert told in text


@pytest.mark.slow
def test_a_body_has_its_picture_and_its_record(tmp_path, monkeypatch, capsys):
    asked = []
    report = body_reports.box()
    monkeypatch.setattr(rsym.verify.smoothness, "verify_smoothness", lambda *_, **how: asked.append(how) or report)
    path, picture = tmp_path / "box.rf", tmp_path / "box.png"
    path.write_text("coordinates x y z\nbounds x [-2, 2] y [-2, 2] z [-2, 2]\nomega = rfAND(1 - x^2, 1 - y^2, 1 - z^2)")
    assert main(["verify", str(path), "--method", "space", "--json", "-o", str(picture)]) == 1
    assert asked[0]["method"] == "space"
    assert json.loads(capsys.readouterr().out)["format"] == "rsym-body-report"
    assert picture.stat().st_size > 20_000


@pytest.mark.slow
def test_the_corner_of_the_paper(capsys):
    assert main(["verify", "skeleton"]) == 1
    text = capsys.readouterr().out
    assert "-4.9921210962" in text
    assert "144.811726903" in text
    assert main(["verify", "skeleton", "--set", "a2=6"]) == 0
    assert "a2 = 6" in capsys.readouterr().out


@pytest.mark.slow
def test_a_letter_may_be_a_range(capsys):
    assert main(["verify", "skeleton", "--set", "a2=5.32:8", "--set", "p1=40"]) == 0
    assert "for every a2 in [5.32, 8] with a = 5" in capsys.readouterr().out


@pytest.mark.slow
def test_json_is_all_that_is_printed(model, tmp_path, capsys):
    picture = tmp_path / "verdict.png"
    assert main(["verify", model, "--shape", "half", "--json", "-o", str(picture)]) == 1
    printed = capsys.readouterr()
    record = json.loads(printed.out)
    assert record["verdict"] == "REFUTED"
    assert {defect["kind"] for defect in record["defects"]} == {"corner"}
    assert record["letters"]["a"] == [2, 2]
    assert printed.err == ""
    assert picture.stat().st_size > 20_000


@pytest.mark.slow
def test_the_same_picture_twice(model, tmp_path):
    for name in ("a.svg", "b.svg"):
        assert main(["verify", model, "-o", str(tmp_path / name)]) == 0
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.slow
def test_a_threshold_is_a_bracket(model, tmp_path, capsys):
    corner = tmp_path / "corner.rf"
    corner.write_text("letter t = 1 in [0.2, 3]\nbounds x [-2, 2] y [-2, 2]\nomega = rfOR(1 - x^2 - y^2, y - t)")
    arguments = ["verify", str(corner), "--threshold", "t", "--set", "t=0.5:1.5"]
    assert main(arguments) == 0
    text = capsys.readouterr().out
    assert abs(float(text.split()[2]) - 1) < 1e-4
    assert "certified above" in text
    assert main([*arguments, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["refuted"] <= 1 <= record["certified"] < record["refuted"] + 1e-2


def test_normalisation_has_its_own_verdict(tmp_path, capsys):
    disc = tmp_path / "disc.rf"
    disc.write_text(
        "coordinates x y\nbounds x [-2, 2] y [-2, 2]\nhalf = (1 - x^2 - y^2)/2\n"
        "far = 1 - sqrt(x^2 + y^2)\nomega = 1 - x^2 - y^2"
    )
    assert main(["verify", str(disc), "--normalisation", "1"]) == 1
    assert main(["verify", str(disc), "--normalisation", "1", "--shape", "half"]) == 0
    assert main(["verify", str(disc), "--normalisation", "2", "--shape", "half"]) == 1
    capsys.readouterr()
    assert main(["verify", str(disc), "--normalisation", "2", "--shape", "far", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["order"] == 2


@pytest.mark.random
@pytest.mark.parametrize(
    "arguments",
    [
        ["verify", "skeleton", "--normalisation", "0"],
        ["verify", "skeleton", "--normalisation", "1", "--set", "a2=5:6"],
        ["verify", "skeleton", "--normalisation", "1", "-o", "report.png"],
        ["verify", "skeleton", "--threshold", "q"],
        ["verify", "skeleton", "--threshold", "a2", "-o", "report.png"],
        ["verify", "skeleton", "--threshold", "a2", "--set", "a1=5:6"],
        ["verify", "skeleton", "-o", "report.doc"],
        ["verify", "skeleton", "-o", "nowhere/report.png"],
        ["verify", "skeleton", "--set", "a2=6:5", "-o", "report.png"],
        ["verify", "skeleton", "--set", "a2=5:", "-o", "report.png"],
        ["verify", "skeleton", "--set", "a2=5:inf", "-o", "report.png"],
        ["verify", "skeleton", "--set", "a2=5:99", "-o", "report.png"],
        ["verify", "skeleton", "--set", "q=1:2", "-o", "report.png"],
        ["verify", "skeleton", "--set", "q=1", "-o", "report.png"],
        ["verify", "skeleton", "--revolve", "z", "-o", "report.png"],
        ["verify", "missing.rf", "-o", "report.png"],
    ],
)
def test_refused_input_is_code_1_with_one_line_and_no_file(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    printed = capsys.readouterr()
    assert printed.err.startswith("rsym: ")
    assert len(printed.err.splitlines()) == 1
    assert printed.out == ""
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["skeleton", "--json", "x.json"],
        ["skeleton", "--normalisation", "two"],
        ["skeleton", "--normalisation", "1", "--threshold", "a2"],
    ],
)
def test_wrong_usage_is_code_2(arguments):
    with pytest.raises(SystemExit) as caught:
        main(["verify", *arguments])
    assert caught.value.code == 2


def test_an_interrupt_leaves_nothing(tmp_path, monkeypatch, capsys):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(rsym.verify.smoothness, "verify_smoothness", interrupt)
    assert main(["verify", "skeleton", "-o", "report.png"]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_settings_with_one_value_are_left_alone():
    assert ranges(["a=1", "b = 2:3", "c"], "--set") == (["a=1", "c"], {"b": (2.0, 3.0)})
