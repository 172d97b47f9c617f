"""`rsym solve`, `modes`, `torsion`, `measure`: fields on shapes from the command line."""

import json
import math
import re
import sys

import matplotlib.pyplot
import numpy as np
import pytest

import rsym
from rsym.cli import main
from rsym.paper.models import PROBLEMS

RING = """
letter q = 1 in [0, 9] "heat"
letter b = 1
letter r = 0.5 in [0.2, 0.8]
rim = (1 - x^2 - y^2)/2 "rim"
bore = (x^2 + y^2 - r^2)/(2*r) "the bore"
omega = rfAND(rim, bore)
"""
STATED = "equation -laplacian(u) = q\non rim = b\n"


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture
def ring(tmp_path):
    (tmp_path / "ring.rf").write_text(RING)
    return str(tmp_path / "ring.rf")


@pytest.fixture
def stated(tmp_path):
    (tmp_path / "stated.rf").write_text(RING + STATED)
    return str(tmp_path / "stated.rf")


def told(text, word):
    """The number behind a word."""
    return float(re.search(rf"{word} +([^\s,]+)", text)[1])


def test_a_problem_on_the_line(ring, tmp_path, capsys):
    path = tmp_path / "field.png"
    line = ["--equation", "-laplacian(u) = 0", "--on", "rim=0", "--on", "the bore=log(2)", "--cells", "10"]
    assert main(["solve", ring, *line, "-o", str(path)]) == 0
    out = capsys.readouterr().out
    assert path.read_bytes().startswith(b"\x89PNG")
    assert out.endswith(f"{path}\n")
    assert main(["solve", ring, *line, "-o", str(tmp_path / "lines.dxf")]) == 0
    assert "U_0P1" in (tmp_path / "lines.dxf").read_text()
    capsys.readouterr()
    assert main(["modes", ring, "-o", str(tmp_path / "lines.dxf")]) == 1
    assert "a picture is written as" in capsys.readouterr().err
    # u = -log r
    assert told(out, "maximum") == pytest.approx(math.log(2), rel=1e-3)
    assert told(out, "minimum") == 0
    assert told(out, "integral") == pytest.approx(math.pi * (0.375 - math.log(2) / 4), rel=1e-3)
    assert re.match(
        r"The error, an estimate, is about \S+ of the largest value, in the root of the mean square\. \d+ u", out
    )


def test_the_file_states_it_and_letters_change_it(stated, capsys):
    line = ["--cells", "8", "--on", "others=0", "--on", "the bore=neumann(0)"]
    assert main(["solve", stated, "--cells", "8", "--set", "q=0", "--set", "b=3"]) == 0
    assert told(capsys.readouterr().out, "integral") == pytest.approx(3 * math.pi * 0.75, rel=1e-3)
    assert main(["solve", stated, "--set", "q=4", *line]) == 0
    # u = 1 - r^2 + log(r)/2 by hand, with no flux through r = 1/2
    assert told(capsys.readouterr().out, "maximum") == pytest.approx(0.75 - math.log(2) / 2, rel=1e-3)


def test_the_estimate_is_told(stated, capsys):
    assert main(["solve", stated, "--tolerance", "1e-3"]) == 0
    out = capsys.readouterr().out
    assert re.match(r"The error, an estimate, is about \S+ of the largest value", out)
    assert "cells  degree  unknowns  estimate" in out


def test_modes_of_a_drum(ring, tmp_path, capsys):
    path = tmp_path / "modes.png"
    assert main(["modes", ring, "--count", "2", "--cells", "10", "-o", str(path)]) == 0
    out = capsys.readouterr().out
    assert path.read_bytes().startswith(b"\x89PNG")
    # The first zero of J0(k)Y0(k/2) - J0(k/2)Y0(k) is k = 6.24606...
    assert told(out, " 1 ") == pytest.approx(39.0133, rel=1e-4)


def test_modes_take_conditions_and_the_operator(ring, capsys):
    line = ["--count", "2", "--cells", "10", "--equation", "-4*laplacian(u) = 1", "--on", "rim=0"]
    assert main(["modes", ring, *line]) == 0
    # The first zero of J0(k)Y1(k/2) - J1(k/2)Y0(k) is k = 3.4069...; a bore that is free.
    assert told(capsys.readouterr().out, " 1 ") / 4 < 0.5 * 39.0133


def test_torsion_of_a_tube(ring, tmp_path, capsys):
    path = tmp_path / "stress.svg"
    assert main(["torsion", ring, "--cells", "10", "-o", str(path)]) == 0
    out = capsys.readouterr().out
    assert b"<svg" in path.read_bytes()
    assert told(out, "rigidity") == pytest.approx(math.pi / 2 * (1 - 0.5**4), rel=1e-4)
    assert told(out, "greatest stress") == pytest.approx(1, rel=1e-3)
    assert told(out, "of the area") == pytest.approx(math.pi / 4, rel=1e-3)


def test_a_field_for_paraview(ring, tmp_path, capsys, monkeypatch):
    meshio = pytest.importorskip("meshio")
    path = tmp_path / "field.VTU"
    line = ["--equation", "-laplacian(u) = 0", "--on", "rim=0", "--on", "the bore=log(2)", "--cells", "10"]
    assert main(["solve", ring, *line, "-o", str(path)]) == 0
    assert capsys.readouterr().out.endswith(f"{path}\n")
    found = meshio.read(path, file_format="vtu")
    radius = np.linalg.norm(found.points, axis=1)
    np.testing.assert_allclose(found.point_data["u"], -np.log(radius), atol=1e-3)
    assert main(["modes", ring, "--count", "2", "--cells", "10", "-o", str(tmp_path / "modes.vtu")]) == 0
    assert set(meshio.read(tmp_path / "modes.vtu").point_data) == {"mode_1", "mode_2"}
    monkeypatch.setitem(sys.modules, "meshio", None)
    assert main(["torsion", ring, "--cells", "10", "-o", str(tmp_path / "no.vtu")]) == 1
    assert "pip install meshio" in capsys.readouterr().err


def test_a_field_in_space_has_no_picture_and_a_file(tmp_path, capsys):
    (tmp_path / "ball.rf").write_text("omega = 1 - x^2 - y^2 - z^2; equation -laplacian(u) = 6; on omega = 0")
    line = ["solve", str(tmp_path / "ball.rf"), "--cells", "4", "--degree", "2"]
    assert main([*line, "-o", str(tmp_path / "ball.png")]) == 1
    assert "remedy: -o field.vtu" in capsys.readouterr().err
    assert main([*line, "--section", "z=0", "-o", str(tmp_path / "disc.png")]) == 0


def test_the_models_that_state_a_problem(tmp_path, capsys):
    for name in PROBLEMS:
        problem = rsym.load_problem(name)
        assert problem.equation is not None
        assert set(problem.conditions) == {part for part, _ in problem.shape.parts}
        for letter in problem.shape.letters.values():
            assert letter.doc
            assert letter.minimum < letter.default < letter.maximum
    assert main(["solve", "plate", "--cells", "16", "-o", str(tmp_path / "plate.png")]) == 0
    out = capsys.readouterr().out
    assert told(out, "maximum") == 1
    assert told(out, "minimum") == pytest.approx(0.1398, abs=2e-3)


@pytest.mark.slow
def test_it_needs_no_option(tmp_path, capsys):
    """The shaft is Weber's: (s^2 - d^2)/2 (2 t/s^2 - 1), s from the middle of the keyway, t below it."""
    meshio = pytest.importorskip("meshio")
    assert main(["solve", "shaft", "-o", str(tmp_path / "shaft.vtu")]) == 0
    integral = told(capsys.readouterr().out, "integral")
    found = meshio.read(tmp_path / "shaft.vtu")
    across, up, _ = found.points.T
    square = across**2 + (1 - up) ** 2
    exact = (square - 0.09) / 2 * (2 * (1 - up) / square - 1)
    np.testing.assert_allclose(found.point_data["u"], exact, atol=1e-7)
    assert main(["torsion", "shaft", "--cells", "32"]) == 0
    out = capsys.readouterr().out
    assert told(out, "rigidity") == pytest.approx(2 * integral, rel=1e-3)
    assert told(out, "greatest stress") == pytest.approx(1.7, rel=1e-3)


def test_a_measure(ring, capsys):
    assert main(["measure", ring, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["content"] == pytest.approx(0.75 * math.pi, rel=1e-12)
    assert found["parts"] == pytest.approx({"rim": 2 * math.pi, "the bore": math.pi}, rel=1e-12)
    assert main(["measure", ring, "--set", "r=0.25"]) == 0
    assert capsys.readouterr().out.startswith("Area 2.9452431127")


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--on", "rim=0"], "states no equation"),
        (["--equation", "-laplacian(u) = u^2", "--on", "rim=0"], "not linear"),
        (["--equation", "-laplacian(u) = w", "--on", "rim=0"], "unknown name 'w'"),
        (["--equation", "-laplacian(u) = 1", "--on", "rmi=0"], "no part 'rmi'"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim"], "PART=CONDITION"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim=robbin(2, 1)"], "robbin"),
        (["--equation", "-laplacian(u) = 1"], "nothing fixes"),
        (["--equation", "bilaplacian(u) = 1", "--on", "rim=clamped()"], "Poisson's ratio matters"),
        (["--equation", "bilaplacian(u) = 1", "--on", "rim=clamped()", "--poisson", "7"], "from -1 to 1"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim=__import__('os')"], "--on"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim=0", "--degree", "9"], "degree"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim=0", "-o", "field.doc"], "a picture is written as"),
        (["--equation", "-laplacian(u) = 1", "--on", "rim=0", "--set", "q=2"], "q"),
    ],
)
def test_what_is_refused(arguments, word, ring, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["solve", ring, "--cells", "8", *arguments]) == 1
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert message.startswith("rsym: ")
    assert word in message
    assert [path.name for path in tmp_path.iterdir()] == ["ring.rf"]
