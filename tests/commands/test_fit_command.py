"""`rsym fit`: points from a file, letters to a file that other commands take."""

import json

import matplotlib.pyplot
import numpy as np
import pytest

import rsym
from rsym.cli import main
from rsym.output.points import load_points

BALL = """
letter r = 1 in [0.5, 3] "radius"
letter h = 0.2 in [-1, 1]
omega = rfAND((r^2 - x^2 - y^2 - z^2)/(2*r), z - h)
"""


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def test_letters_of_the_body_from_a_file(tmp_path, capsys):
    truth = {"a2": 5.9, "p1": 36.0}
    points = rsym.sample(rsym.paper.skeleton_body().with_letters(truth), 80, over="boundary", rng=1).points
    np.savetxt(tmp_path / "points.csv", points, delimiter=",", header="x,y", comments="")
    letters, picture = tmp_path / "letters.json", tmp_path / "fit.png"
    command = ["fit", "skeleton", str(tmp_path / "points.csv"), "--find", "a2, p1"]
    assert main([*command, "-o", str(letters), "--picture", str(picture)]) == 0
    told = capsys.readouterr().out
    assert "80 points determine a2 and p1" in told
    assert picture.read_bytes().startswith(b"\x89PNG")
    found = json.loads(letters.read_text())
    assert abs(found["p1"] - 36) < 1e-9
    assert list(found) == list(rsym.paper.skeleton_body().letters)
    assert main(["letters", "skeleton", "--letters", str(letters)]) == 0
    assert "36 " in capsys.readouterr().out


def test_a_section_and_a_silhouette(tmp_path, capsys):
    model, points = tmp_path / "cap.rf", tmp_path / "points.txt"
    model.write_text(BALL)
    turn = np.linspace(0, 6, 20)
    np.savetxt(points, np.stack([1.2 * np.cos(turn), 1.2 * np.sin(turn)], axis=1))
    assert main(["fit", str(model), str(points), "--find", "r", "--section", "z=0.5"]) == 0
    assert "1.3 " in capsys.readouterr().out
    assert main(["fit", str(model), str(points), "--find", "r", "--silhouette", "z"]) == 0
    assert "of a silhouette determine r" in capsys.readouterr().out


def test_what_is_refused(tmp_path, capsys):
    points = tmp_path / "points.csv"
    points.write_text("x,y\n1,2\n3\n")
    assert main(["fit", "skeleton", str(points), "--find", "a2"]) == 1
    assert "points.csv, line 3: expected 2 numbers, got 1" in capsys.readouterr().err
    assert main(["fit", "skeleton", str(tmp_path / "none.csv"), "--find", "a2"]) == 1
    assert main(["fit", "skeleton", str(points), "--find", "q"]) == 1
    assert main(["fit", "skeleton", str(points), "--find", "a2", "--picture", "x.gif"]) == 1


@pytest.mark.parametrize(
    "text", ["1,2\n3,4", "1 2\n3 4\n", "x;y\n1;2\n\n3;4", "# made\n1\t2 # one\n3\t4", "\ufeff1,2\n3,4"]
)
def test_points_in_many_hands(text, tmp_path):
    path = tmp_path / "points.txt"
    path.write_text(text, encoding="utf-8")
    assert load_points(path, 2).tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize("text", ["x,y\nu,v\n1,2", "1,2\na,b", "1,2,3", "__import__('os'),2\n3,4,5"])
def test_lines_that_are_no_points(text, tmp_path):
    path = tmp_path / "points.txt"
    path.write_text(text)
    with pytest.raises(rsym.RsymError) as raised:
        load_points(path, 2)
    assert raised.value.code == "points-file"
