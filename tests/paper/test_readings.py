"""Every consequence that the table of readings states, checked on the models."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y
from rsym.paper import READINGS
from rsym.paper.drawing import mesh_quietly


def value(shape, *point):
    return float(rsym.compile(shape)(*point)["value"])


def volume(shape):
    return mesh_quietly(shape, 150).status.volume


def test_the_printed_f_o_is_flat_on_its_segment_and_the_repaired_one_is_normalised():
    line, disc = y, (25 - x**2) / 10
    repaired = rsym.trimming(line, disc).doit()
    printed = (sp.sqrt(line**4 + disc**2) - disc) / 2 + line**2
    slopes = [sp.diff(f_o, y).subs({x: 2, y: sp.Rational(1, 10**6)}).evalf(30) for f_o in (repaired, printed)]
    assert_close([float(slope) for slope in slopes], [1, 0], atol=1e-5)
    for f_o, shape in ((repaired, rsym.paper.skeleton_body()), (printed, rsym.paper.skeleton_body("literal"))):
        omega = -f_o + (8 - x) * (sp.Rational(53, 10) + x) / 40 - sp.Rational(1, 10)
        assert_close(value(shape, -1.3, 0.7), float(omega.subs({x: -1.3, y: 0.7})), rtol=1e-12)


def test_the_body_of_figure_11_has_a_corner_on_its_skeleton_in_one_reading_only():
    root = float(sp.nsolve((8 - x) * (sp.Rational(53, 10) + x) / 40 - sp.Rational(1, 10), -4.99))
    assert_close(root, -4.992121, atol=5e-7)
    above, below = (
        rsym.compile(rsym.paper.skeleton_body(), ("gradient",))(root, side)["gradient"] for side in (1e-9, -1e-9)
    )
    turn = np.degrees(np.arccos(above @ below / np.linalg.norm(above) / np.linalg.norm(below)))
    assert_close(turn, 144.8117, atol=1e-3)
    fields = rsym.compile(rsym.paper.skeleton_body("literal"), ("value", "gradient"))(root, 0.0)
    assert_close(fields["value"], 0, atol=1e-12)
    assert_close(fields["gradient"], [0.317, 0], atol=5e-4)


@pytest.mark.slow
def test_as_printed_all_outer_space_is_inside():
    directions = np.random.default_rng(5).normal(size=(500, 3))
    far = (100 * directions / np.linalg.norm(directions, axis=1, keepdims=True)).T
    assert (rsym.compile(rsym.paper.car(reading="printed-W"))(*far)["value"] > 0).all()
    assert (rsym.compile(rsym.paper.car())(*far)["value"] < 0).all()
    points = np.random.default_rng(6).uniform((-8, -16, -4), (8, 18, 9), (20_000, 3)).T
    printed, test5, far = (
        rsym.compile(shape)(*points)["value"]
        for shape in (
            rsym.paper.car(reading="printed-W"),
            rsym.paper.car(stage="test5"),
            rsym.paper.car(stage="omega_far"),
        )
    )
    assert ((printed < 0) == ((test5 < 0) & (far > 0))).all()


@pytest.mark.slow
def test_z_b_agrees_at_the_letters_b_and_not_at_a():
    standard, text = rsym.paper.car("b"), rsym.paper.car("b", reading="text-zb")
    assert standard == text
    assert rsym.paper.car("a", reading="text-zb").letters["zb"].default == 2.5
    ratio = volume(rsym.paper.car(reading="text-zb")) / volume(rsym.paper.car())
    assert_close(100 * (ratio - 1), 0.74, atol=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(("reading", "reach"), [("standard", 7.3), ("strip", 6.0)])
def test_the_strip_decides_the_width_of_figure_7(reading, reach):
    body = mesh_quietly(rsym.paper.car(stage="test3", reading=reading), 100)
    assert_close(np.abs(body.vertices[:, 0]).max(), reach, atol=0.01)


@pytest.mark.slow
def test_roof_and_boot_reach_as_far_as_their_letters_say():
    roof, boot = rsym.paper.car(stage="f1"), rsym.paper.car(stage="f2")
    assert_close([value(roof, 0, 8, 4), value(roof, 0, -8, 4), value(roof, 0, 0, 8)], [0, 0, 0], atol=1e-12)
    assert_close([value(boot, 0, -15, 2), value(boot, 0, 0, 2), value(boot, 0, -7, 5)], [0, 0, 0], atol=1e-12)
    kernel = rsym.compile(boot, ("gradient_squared",))
    assert_close(kernel([0.0, 0.0], [-15.0, -7.0], [2.0, 5.0])["gradient_squared"], [1, 1], atol=1e-12)
    assert abs(rsym.compile(roof, ("gradient_squared",))(0.0, 8.0, 4.0)["gradient_squared"] - 1) > 0.5


def test_the_car_has_46_letters_of_which_one_closes_two_figures_only():
    everything = {name for stage in ("test1", "W") for name in rsym.paper.car(stage=stage).letters}
    assert len(everything) == 46
    assert everything - set(rsym.paper.car().letters) == {"xs"}


def test_every_body_of_figure_12_meets_its_skeleton():
    from rsym.paper.figures import BODIES

    for a1, p1 in BODIES:
        body = rsym.paper.skeleton_body().with_letters({"a2": 5, "a1": a1, "p1": p1})
        assert_close(value(body, -5, 0), -0.1, atol=1e-12)
        assert value(body, 0, 0) > 0


def test_every_other_reading_can_be_asked_for():
    others = [reading.other for reading in READINGS if reading.other]
    assert len(others) == 4
    for call in others:
        name, _, argument = call.partition("(reading='")
        assert getattr(rsym.paper, name)(reading=argument.removesuffix("')")).letters
    for reading in READINGS:
        assert all(getattr(reading, part) for part in ("transcription", "repair", "reason", "consequence", "used"))
