"""Sliders that move a solution; what is found is held against what is known."""

import importlib.util
import os

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import RsymError, x, y, z

if importlib.util.find_spec("ipywidgets") is None and not os.environ.get("CI"):
    pytest.skip("ipywidgets is not installed", allow_module_level=True)

r, q = sp.symbols("r q", real=True)
RADIUS = rsym.Letter(1, minimum=0.5, maximum=3)
DISC = rsym.disc(r, letters={r: RADIUS}).named("rim")


def test_a_letter_of_the_shape_and_one_of_the_equation_move_a_solution(monkeypatch):
    u = rsym.solve(DISC, "-laplacian(u) = q", 0, letters={"q": 4}, cells=6)  # q (r^2 - x^2 - y^2)/4
    widget = rsym.explore(u, resolution=30)
    assert set(widget.letters) == {"r", "q"}
    before = widget.picture.value
    assert bytes(before).startswith(b"\x89PNG")
    with monkeypatch.context() as patch:
        patch.setattr("rsym.backends.kernel.make_function", lambda *_: pytest.fail("compiled again"))
        widget.letters["r"].value = 2.0
        widget.letters["q"].value = 1.0
    assert widget.message.value == ""
    assert widget.picture.value != before
    assert float(widget.found(0, 1)) == pytest.approx(0.75, abs=1e-9)
    widget.reset.click()
    assert float(widget.found(0, 0)) == pytest.approx(1, abs=1e-9)
    assert u.shape.letters["r"].default == 1


def test_colours_stay_while_they_are_kept_and_fields_are_chosen():
    u = rsym.solve(DISC, "-laplacian(u) = 4", 0, cells=6)
    widget = rsym.explore(u, resolution=30)
    ends = widget.figure.axes[1].get_ylim()
    widget.steady.value = True
    widget.letters["r"].value = 2
    assert widget.figure.axes[1].get_ylim() == ends
    widget.steady.value = False
    widget.letters["r"].value = 1.5
    assert widget.figure.axes[1].get_ylim()[1] == pytest.approx(2.25, abs=0.3)
    widget.field.value = "gradient_squared"
    assert widget.figure.axes[0].get_title() == r"$|\nabla u|^2$"
    (only,) = rsym.explore(u, ["laplacian"], resolution=16).field.options
    assert only == ("laplacian", "laplacian")


def test_what_cannot_be_solved_is_said_and_the_picture_stays():
    hole = rsym.disc(r, letters={r: rsym.Letter(0.25, maximum=3)}).translate(0.5, 0)
    u = rsym.solve((rsym.disc(1) - hole.named("hole")), "-laplacian(u) = 1", {"hole": 0, ...: 1}, cells=8)
    widget = rsym.explore(u, resolution=24)
    before, found = widget.picture.value, widget.found
    for radius in (2.0, 0.0):  # nothing of the disc is left; 0/0
        widget.letters["r"].value = radius
        assert widget.message.value.startswith("<b>not done:</b>")
    assert widget.picture.value == before
    assert widget.found is found


@pytest.mark.slow
def test_modes_a_shaft_and_an_elastic_body():
    drum = rsym.explore(rsym.modes(DISC, 2, cells=6), resolution=24)
    drum.letters["r"].value = 2
    assert drum.found.values[0] == pytest.approx(5.783186 / 4, rel=1e-4)
    assert len(drum.figure.axes) == 2
    shaft = rsym.explore(rsym.torsion(DISC, cells=6), resolution=24)
    shaft.letters["r"].value = 2
    assert float(shaft.found) == pytest.approx(np.pi / 2 * 16, rel=1e-6)
    ring = DISC - rsym.disc(0.4).named("bore")
    body = rsym.elasticity(ring, {"rim": 0, "bore": rsym.pressure(1)}, young=1, poisson=0.3, cells=8)
    held = rsym.explore(body, resolution=24)
    held.letters["r"].value = 1.5
    assert held.found.shape.letters["r"].default == 1.5
    assert held.message.value == ""


@pytest.mark.slow
def test_a_solution_in_space_shows_its_sections():
    ball = rsym.Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: 1})
    widget = rsym.explore(rsym.solve(ball, "-laplacian(u) = 6", 0, cells=4, degree=3), resolution=16)
    assert widget.figure.axes[0].get_xlabel() == "$x$"
    widget.section[0].value = "x"
    assert widget.figure.axes[0].get_xlabel() == "$y$"
    assert widget.message.value == ""


def test_a_problem_of_a_file_is_solved_and_moved(tmp_path):
    path = tmp_path / "round.rf"
    path.write_text("letter h = 1 in [0, 9]\nrim = (1 - x^2 - y^2)/2\nequation -laplacian(u) = h\non rim = 0\n")
    widget = rsym.explore(rsym.load_problem(path), resolution=16)
    widget.letters["h"].value = 2
    assert float(widget.found(0, 0)) == pytest.approx(0.5, abs=1e-8)


def test_refusals():
    with pytest.raises(RsymError, match="no letters to move"):
        rsym.explore(rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=6))
    u = rsym.solve(DISC, "-laplacian(u) = 1", 0, cells=6)
    with pytest.raises(RsymError, match="fields of a solution"):
        rsym.explore(u, ["normalised"])
    with pytest.raises(RsymError, match="leave axis= out"):
        rsym.explore(u, axis=y)
