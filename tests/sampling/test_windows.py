"""What is looked at where nobody gave bounds: all of the boundary, at the values of the letters."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.errors import RsymError
from rsym.sampling.windows import bounds_or_extent

A = sp.Symbol("a", real=True)
NAIL = rsym.sphere(1) | (rsym.cylinder(sp.Rational(1, 2)) & rsym.slab(3, 6))  # the rod does not touch the ball


def square(low, high):
    """The square [low, high]**2 of four half-planes: no piece of it is bounded."""
    sides = [((1, 0), low), ((-1, 0), -high), ((0, 1), low), ((0, -1), -high)]
    return rsym.conjunction(*(rsym.half_plane(*side) for side in sides))


def test_nothing_is_stated_by_a_piece():
    assert rsym.disc(1).bounds is None
    assert "bounds" not in repr(rsym.disc(1) | rsym.rectangle(2, 3))
    assert rsym.disc(1).replace(bounds=((0, 1), (0, 2))).bounds == ((0, 1), (0, 2))


def test_a_body_of_a_bounded_piece_and_one_without_bounds_is_whole():
    volume = 4 / 3 * math.pi + 0.75 * math.pi
    assert_close(rsym.mesh(NAIL, 96).volume, volume, rtol=3e-3)
    assert bounds_or_extent(NAIL, None)[2][1] > 6
    points = rsym.sample(NAIL, 500, rng=1).points
    assert (points[:, 2] > 3).mean() > 0.2


@pytest.mark.parametrize(
    "other",
    [
        square(2, 4),
        rsym.implicit(1 - x**2 - (y - 3) ** 2),
    ],
    ids=["half planes", "implicit"],
)
@pytest.mark.parametrize("operation", [rsym.disjunction, rsym.exclusive_or])
def test_a_disc_and_something_that_brings_no_box(other, operation):
    both = operation(rsym.disc(1), other)
    assert max(line[:, 1].max() for line in rsym.level_lines(both)) > 3.9


def test_long_tools_do_not_stretch_what_they_cut():
    drilled = rsym.box(10, 10, 2) - rsym.cylinder(3, 200)
    assert_close(rsym.mesh(drilled).volume, 200 - 18 * math.pi, rtol=2e-3)
    tube = rsym.mesh(rsym.sphere(20) - rsym.cylinder(17, 200), 64)
    assert tube.status.euler_characteristic == 0
    cut = rsym.level_lines(rsym.disc(1) - rsym.rectangle(500, sp.Rational(1, 5)))
    half = math.acos(0.1) - 0.1 * math.sqrt(1 - 0.01)
    assert_close(cut.area, 2 * half, rtol=1e-3)
    assert_close(rsym.level_lines(rsym.disc(1) - rsym.rectangle(5000, sp.Rational(1, 5))).area, 2 * half, rtol=1e-3)


def test_what_is_cut_off_does_not_say_where_to_look():
    plate = square(0, 10) - rsym.disc(1)
    assert_close(rsym.measure(plate).area, 100 - math.pi / 4, rtol=1e-6)
    assert_close(rsym.level_lines(plate).area, 100 - math.pi / 4, rtol=1e-3)


def test_what_goes_on_without_end_is_refused_with_its_directions():
    for ask in (rsym.level_lines, rsym.measure, rsym.verify_smoothness):
        with pytest.raises(RsymError, match=r"directions -y, \+y") as caught:
            ask(rsym.disc(1) | rsym.half_plane((1, 0), 0))
        assert caught.value.code == "unbounded"


def test_a_section_that_ends_of_a_body_that_does_not():
    paraboloid = rsym.Shape(z - x**2 - y**2, (x, y, z))
    assert rsym.level_lines(paraboloid, section={z: 4}, resolution=64).area == pytest.approx(4 * math.pi, rel=2e-3)
    areas = [one.lines.area for one in rsym.sections(paraboloid, [1, 4, -1], resolution=64)]
    assert areas == pytest.approx([math.pi, 4 * math.pi, 0], rel=2e-3)
    with pytest.raises(RsymError, match=r"in the directions \+z"):
        rsym.level_lines(paraboloid, section={x: 0}, resolution=64)


def test_letters_move_what_is_looked_at():
    disc, ball = rsym.disc(A, letters={A: 1}), rsym.sphere(A, letters={A: 1})
    assert_close(rsym.level_lines(disc, letters={"a": 5}).area, 25 * math.pi, rtol=1e-3)
    assert_close(rsym.level_lines(disc.with_letters({"a": 5})).area, 25 * math.pi, rtol=1e-3)
    assert_close(rsym.level_lines(disc, letters={"a": 0.01}).area, 1e-4 * math.pi, rtol=1e-3)
    assert_close(rsym.mesh(ball, 48, letters={"a": 5}).volume, 4 / 3 * math.pi * 125, rtol=5e-3)
    assert rsym.verify_smoothness(disc, letters={"a": 5}).verdict == "CERTIFIED"
    assert rsym.verify_smoothness(ball, letters={"a": 5}, method="space").verdict == "CERTIFIED"


def test_a_window_that_somebody_states_stays():
    window = ((-1, 1), (0, 2))
    disc = rsym.disc(A, letters={A: 1}).replace(bounds=window)
    assert disc.with_letters({"a": 5}).bounds == window
    assert (disc - rsym.rectangle(500, 1)).bounds == window
    assert (disc & rsym.Shape(x, (x, y))).bounds == window
    assert (disc | rsym.Shape(x, (x, y), bounds=window)).bounds == window
    assert (disc | rsym.Shape(x, (x, y))).bounds is None
    assert disc.translate(3, 0).bounds == ((2, 4), (0, 2))
    assert disc.translate(A, 0).bounds is None


def test_bounds_are_exact_numbers():
    corner = rsym.loads("bounds x [-1, 0.6] y [-1, 1]\nomega = rfAND(0.6 - x, y)")
    assert rsym.verify_smoothness(corner).verdict != "CERTIFIED"
    again = rsym.loads(rsym.dumps(corner))
    assert again.box == corner.box
    turned = rsym.Shape(y, (x, y), bounds=((-1, 1), (-1, 1))).rotate(
        1
    )  # ends of 17 digits are the floats that they are
    assert rsym.loads(rsym.dumps(turned)).box == turned.box
    inside = rsym.Shape(rsym.conjunction(sp.sqrt(2) - x, y), (x, y), bounds=((-1, sp.sqrt(2)), (-1, 1)))
    assert rsym.verify_smoothness(inside).verdict != "CERTIFIED"


@pytest.mark.parametrize(("expression", "value"), [(x**2 - y**2 + A**2 - 2, sp.sqrt(2)), (sp.sin(A) - x**2, sp.pi)])
def test_proofs_take_letters_as_the_numbers_that_they_are(expression, value):
    """At the nearest float both are regular, at the number two lines cross, or there is no change of sign."""
    shape = rsym.Shape(expression, (x, y), letters={A: 1}, bounds=((-1, 1), (-1, 1)))
    for asked in (
        rsym.verify_smoothness(shape.with_letters({A: value})),
        rsym.verify_smoothness(shape, letters={A: value}),
    ):
        assert asked.verdict in {"DEGENERATE", "UNDECIDED"}
    assert shape.with_letters({A: value}).letters["a"].default == value
    assert (
        rsym.compile(shape)(0.0, 0.0, letters={"a": value})["value"]
        == rsym.compile(shape)(0.0, 0.0, letters={"a": float(value)})["value"]
    )


def test_what_asks_for_verdicts_takes_windows_and_letters_exactly():
    corner = rsym.loads("bounds x [-1, 0.6] y [-1, 1]; omega = rfAND(0.6 - x, y)")
    assert rsym.repair(corner, moves=["rho"], radius=0.1).needed
    b, c = sp.symbols("b c", real=True)
    line = b * c * y - (A**2 - 2) * 10**17 * abs(x)
    shape = rsym.Shape(line, (x, y), letters={A: sp.sqrt(2), b: 1, c: 1}, bounds=((-2, 2), (-2, 2)))
    atlas = rsym.smoothness_atlas(shape, b, c, between=((1, 2), (1, 2)), tolerance=0.5, budget=1, sharpening=0)
    assert atlas.verdict_at(1.5, 1.5) == "CERTIFIED"


def test_a_window_over_ranges_of_letters_holds_the_body_at_all_of_them():
    """The disc is at the origin at both ends and in the middle, and 1.5396 away between."""
    disc = rsym.disc(1, (16 * A * (1 - A) * (1 - 2 * A), 0), letters={A: 0})
    report = rsym.verify_smoothness(disc, letters={A: (0, 1)})
    ((left, right), _) = report.cover.bounds
    assert (left < -2.539, right > 2.539) == (True, True)
    assert report.verdict == "CERTIFIED"
    assert ("all of the boundary lies within these bounds", True) in report.statements


def test_verdicts_find_bounds_where_none_are_stated():
    disc = rsym.loads("omega = 1 - x^2 - y^2")
    assert rsym.verify_smoothness(disc).verdict == "CERTIFIED"
    assert rsym.fairness(disc).verdict
    assert rsym.repair(disc).before.verdict == "CERTIFIED"
    assert rsym.verify_normalisation(rsym.disc(1), tolerance=0.01).verdict != "REFUTED"


def test_boxes_of_pieces_hold_them():
    turned = rsym.torus(3, 1).rotate(1, axis=x)
    for shape in (NAIL & rsym.sphere(4), turned ^ rsym.box(1, 2, 3), ~rsym.sphere(2), turned - NAIL):
        box, found = np.array(bounds_or_extent(shape, None)), np.array(rsym.extent(shape))
        inner = found + np.array([[0.03, -0.03]]) * np.ptp(found, axis=1)[:, None]
        assert (box[:, 0] <= inner[:, 0]).all()
        assert (inner[:, 1] <= box[:, 1]).all()


def test_the_wall_around_what_is_cut_out_is_whole():
    wall = rsym.shell(~rsym.disc(1), 1)
    (low, high), _ = bounds_or_extent(wall, None)
    assert low < -2
    assert high > 2
    assert rsym.measure(wall).area == pytest.approx(3 * math.pi, rel=1e-9)
    stated = rsym.disc(1).replace(bounds=((-3, 3), (-3, 3)))
    assert rsym.shell(~stated, 1).bounds == stated.bounds


@pytest.mark.parametrize("curve", [~rsym.disc(1), rsym.segment((0, 0), (1, 1))], ids=["outside", "curve"])
def test_a_prism_over_what_has_no_end_has_none(curve):
    for body in (rsym.extrude(curve, 0, 2), rsym.sweep(curve.replace(letters={A: 1}), {A: z}, 0, 2)):
        with pytest.raises(rsym.RsymError):
            rsym.mesh(body, 8)


@pytest.mark.parametrize(
    ("shape", "window", "words"),
    [
        (rsym.disc(1), None, "all of the boundary lies within these bounds"),
        (rsym.disc(1), ((-2, 2), (-2, 2)), "all of the boundary lies within these bounds"),
        (rsym.disc(1), ((-2, 2), (0, 2)), "the boundary goes on beyond these bounds"),
        (rsym.Shape(y - x, (x, y)), ((-2, 2), (-2, 2)), "the boundary goes on beyond these bounds"),
        (rsym.disc(1) | rsym.disc(1, (9, 0)), ((-2, 2), (-2, 2)), "the boundary goes on beyond these bounds"),
        (rsym.sphere(1), ((-2, 2),) * 3, "all of the boundary lies within these bounds"),
    ],
)
def test_a_verdict_says_whether_the_boundary_goes_on_beyond_its_window(shape, window, words):
    report = rsym.verify_smoothness(shape, bounds=window)
    assert (words, True) in report.statements
    assert words in str(report)
