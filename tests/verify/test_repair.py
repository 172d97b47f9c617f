"""Repair: certified candidates and what they cost, against numbers by hand."""

import json
from fractions import Fraction
from itertools import pairwise

import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.integrate import quad
from scipy.optimize import brentq

import rsym
from rsym import x, y
from rsym.cli import main
from rsym.output.repairs import plot_repair
from rsym.sampling.boundaries import boundary, distance
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.repair.moves import Move, MoveFamily
from rsym.verify.repair.repairing import repair

BOX = ((-2, 2), (-2, 2))
STADIUM = rsym.Shape(1 - y**2 - sp.Max(sp.Abs(x) - 1, 0) ** 2, (x, y), bounds=((-3, 3), (-2, 2)))
CORNER = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=BOX)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture(scope="module")
def nose():
    return repair(rsym.paper.skeleton_body(), moves=["letter", "round"], vary=["a2"], radius=0.02)


def blend(u, a2):
    return (8 - u) * (a2 + u) / 40 - 0.1


def skeleton_field(u, v, eps):
    """The trimmed segment, in floats, its root rounded."""
    t = (25 - u**2) / 10
    gap = (np.hypot(t, v**2) - t) / 2
    return np.sqrt(v**2 + gap**2 + eps**2)


def tip(a2, eps):
    return brentq(lambda u: blend(u, a2) - skeleton_field(u, 0.0, eps), -5.1, -4, xtol=1e-15)


def skeleton_area(a2, eps):
    """Twice the area over the axis, slice by slice; at both ends the slices shrink as a root or faster."""
    right = brentq(lambda u: blend(u, a2) - skeleton_field(u, 0.0, eps), 5, 6, xtol=1e-15)
    left = tip(a2, eps)

    def half(u):
        return brentq(lambda v: blend(u, a2) - skeleton_field(u, v, eps), 0, 2, xtol=1e-15)

    def substituted(s):  # u = left + w*s**2*(3 - 2*s), which makes roots at both ends smooth
        u = left + (right - left) * s * s * (3 - 2 * s)
        return half(u) * 6 * s * (1 - s) * (right - left)

    knots = [0, 0.02, 0.1, 0.5, 0.9, 0.98, 1]
    return 2 * sum(quad(substituted, a, b, epsabs=1e-11, limit=200)[0] for a, b in pairwise(knots))


@pytest.mark.slow
def test_the_nose_of_the_paper_has_two_certified_candidates(nose):
    assert nose.before.verdict == "REFUTED"
    assert [one.move for one in nose.candidates] == ["letter", "round"]
    for one in nose.candidates:
        assert rsym.verify_smoothness(one.shape).verdict == "CERTIFIED"
        assert one.report.continuity == "analytic"
    assert nose.shape.letters["a2"].default == Fraction(53, 10), "the shape that was given is as it was"


@pytest.mark.slow
def test_the_letter_goes_just_over_its_exact_threshold(nose):
    letter = nose.candidates[0]
    value, threshold = letter.shape.letters["a2"].default, 5 + Fraction(4, 13)
    assert threshold < value < threshold + Fraction(1, 10_000)
    assert value.denominator <= 10**6, "a short decimal"
    assert letter.change == f"a2 from 5.3 to {float(value)}"
    below = float(letter.note.split()[4])
    assert 5.3076 < below < float(threshold)
    assert "REFUTED" in letter.note
    assert letter.shape.expression == nose.shape.expression


@pytest.mark.slow
def test_the_rounded_root_is_the_trimming_by_name(nose):
    rounding = nose.candidates[1]
    assert rounding.change == "f_o rounded by 0.02"
    assert ("f_o", rounding.shape.parts[1][1]) == rounding.shape.parts[1]
    assert rounding.shape.expression.has(rounding.shape.parts[1][1]), "the part of this name changed with it"
    # Both in floats at a few places: the expression, and the formula of this test.
    values = rsym.compile(rounding.shape)(np.array([0.3, -5.2]), np.array([0.7, 0.1]))["value"]
    expected = [blend(u, 5.3) - skeleton_field(u, v, 0.02) for u, v in ((0.3, 0.7), (-5.2, 0.1))]
    assert_close(values, expected, rtol=1e-12)


@pytest.mark.slow
def test_the_price_of_the_nose_by_hand(nose):
    """The farthest points of both boundaries are their tips; areas slice by slice."""
    letter, rounding = nose.candidates
    a2 = float(letter.shape.letters["a2"].default)
    before = skeleton_area(5.3, 0)
    for one, values in ((letter, (a2, 0)), (rounding, (5.3, 0.02))):
        assert_close(one.price.distance, abs(tip(*values) - tip(5.3, 0)), rtol=2e-3)
        assert_close(one.price.volume, skeleton_area(*values) / before - 1, atol=2e-7)
        assert one.price.normalisation == "none"
    assert rounding.price.curvature_bound < letter.price.curvature_bound


@pytest.mark.slow
def test_a_bound_of_the_curvature_is_kept_and_so_are_the_bounds():
    """The largest curvature of an ellipse is a/b**2 for a > b: at most 2 from b = 1 on for a = 2."""
    a, b = sp.symbols("a b", real=True)
    letters = {a: rsym.Letter(2, minimum=2, maximum=2), b: rsym.Letter(sp.Rational(1, 2), maximum=2)}
    ellipse = rsym.Shape(1 - x**2 / a**2 - y**2 / b**2, (x, y), letters=letters, bounds=((-3, 3), (-3, 3)))
    found = repair(ellipse, moves=["letter"], curvature=2)
    (one,) = found.candidates
    assert one.price.curvature_bound <= 2
    assert 1 < one.shape.letters["b"].default < 1.03
    assert "its curvature only bounded by 8" in str(found)
    # Taller than the bounds it would have no end.
    found = repair(ellipse, moves=["letter"], curvature=0.6, bounds=((-3, 3), (-1.5, 1.5)))
    assert found.candidates == ()
    assert "leaves the bounds" in found.rejected[-1].reason


@pytest.mark.slow
def test_a_body_is_repaired_through_its_meridian_and_comes_back_as_a_body():
    found = repair(rsym.revolve(STADIUM), moves=["round"], radius=0.1)
    (one,) = found.candidates
    assert one.shape.dimension == 3
    assert rsym.verify_smoothness(one.shape).verdict == "CERTIFIED"
    assert one.change == "Max(0, Abs(x) - 1) rounded by 0.1; then |x| rounded by 0.1"

    def radius_squared(u):
        along = np.sqrt(u * u + 0.01)
        return 1 - ((along - 1 + np.sqrt((along - 1) ** 2 + 0.01)) / 2) ** 2

    end = brentq(radius_squared, 1, 3)
    volume = 2 * np.pi * quad(radius_squared, 0, end)[0]
    assert_close(one.price.volume, volume / (2 * np.pi + 4 * np.pi / 3) - 1, atol=1e-7)
    assert one.price.dimension == 3


def test_the_tips_of_a_spindle_are_rounded():
    found = repair(rsym.revolve(rsym.Shape(1 - sp.Abs(y) - x**2, (x, y), bounds=BOX)), moves=["round"], radius=0.1)
    (one,) = found.candidates
    assert one.change == "sqrt(y**2 + z**2) rounded by 0.1"
    assert one.shape.expression.has(sp.sqrt(y**2 + rsym.z**2 + sp.Rational(1, 100)))
    assert_close(one.price.distance, 1 - np.sqrt(1 - 0.1), rtol=2e-3)


@pytest.mark.slow
def test_the_jumps_of_a_stadium_are_rounded_and_with_them_the_kink_that_comes_to_light():
    found = repair(STADIUM, radius=0.1)
    (one,) = found.candidates
    assert one.report.continuity == "analytic"
    assert {other.move for other in found.rejected} == {"rho", "pasko"}
    assert one.price.curvature_bound < 1.2


def depth(reach):
    """How far the cubic fillet of a right angle is from the corner: 2*f*g = k*(t**2 - r**2)**3/t**4, r**2 = 2*f*g."""
    return reach * np.sqrt(brentq(lambda u: u - (1 - u) ** 3 / 5, 0, 1))


def taken(inner, outer, reach):
    """The area that a fillet takes from a corner of the square, ray by ray; u and v count from its sides."""

    def cubic(f, g):
        return f + g - np.sqrt(f * f + g * g + max(reach**2 - f * f - g * g, 0) ** 3 / 5 / reach**4)

    def sector(s):  # the angle is a polynomial in s that is flat at both ends, where r goes as its cube root
        angle, speed = np.pi / 2 * s**3 * (10 - 15 * s + 6 * s * s), 15 * np.pi * (s * (1 - s)) ** 2
        u, v = np.cos(angle), np.sin(angle)
        r = brentq(lambda r: outer(cubic, inner(r * u), r * v), 1e-9, 1.1 * reach, xtol=1e-15)
        return r * r / 2 * speed

    return quad(sector, 1e-4, 1 - 1e-4, epsabs=1e-10, limit=200)[0]


@pytest.mark.slow
def test_the_corners_of_a_box_are_blended():
    square = rsym.Shape(rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y), (x, y), bounds=BOX)
    found = repair(square, moves=["rho"], radius=0.1)
    (one,) = found.candidates
    assert one.report.continuity == "G2"
    assert one.change == "edges of x + 1 and y + 1, 1 - x and y + 1 and 2 more blended with radius 0.1"

    def sharp(f, g):
        return f + g - np.hypot(f, g)

    upper = taken(lambda u: sharp(u, 2 - u), lambda cubic, f, v: cubic(f, v), 0.1)
    lower = taken(lambda u: sharp(u, 2 - u), lambda cubic, f, v: cubic(sharp(f, 2 - v), v), 0.1)
    assert_close(one.price.volume, -2 * (upper + lower) / 4, atol=1e-7)
    assert 1.29 / 0.1 < one.price.curvature_bound < 1.3 * 1.295 / 0.1
    assert one.price.normalisation == "lost"
    assert one.price.deviations[0] < 1e-6


@pytest.mark.slow
def test_only_the_faces_that_meet_are_blended_and_parts_keep_their_names():
    disc = rsym.Shape(4 - x**2 - y**2, (x, y), bounds=((-3, 3), (-3, 3))).named("disc")
    half = disc & rsym.Shape(2 * x - y, (x, y)).named("cut")
    found = repair(half, moves=["rho", "pasko"], radius=0.05)
    assert [one.change for one in found.candidates] == [
        "edge of disc and cut blended with radius 0.05",
        "edge of disc and cut displaced within 0.05",
    ]
    for one in found.candidates:
        assert [name for name, _ in one.shape.parts] == ["disc", "cut"]
        assert all(one.shape.expression.has(part) for _, part in one.shape.parts)
        assert rsym.verify_smoothness(one.shape).verdict == "CERTIFIED"
    # The faces are perpendicular, with slopes 4 and sqrt(5): the fillet is that of unit slopes.
    assert_close(found.candidates[0].price.distance, depth(0.05), rtol=0.007)


@pytest.mark.slow
def test_a_circular_fillet_becomes_cubic_and_keeps_its_radius():
    round_corner = rsym.Shape(rsym.conjunction(x, y, system=rsym.Rho(1)), (x, y), bounds=BOX)
    found = repair(round_corner, moves=["rho", "pasko"])
    (one,) = found.candidates
    assert one.change == "edge of x and y made cubic, radius 1 kept"
    assert one.shape.expression == rsym.conjunction(x, y, system=rsym.Rho(1, "G2"))
    assert np.isnan(one.price.volume), "the boundary has ends at the bounds"


def test_a_minimum_whose_value_matters_is_no_edge():
    """The kink of min(x, y)**3 - 1/8 is no logic: a conjunction of system R_1 elsewhere than at the top has a value."""
    shape = rsym.Shape(rsym.conjunction(x, y, system=rsym.R1) ** 3 - sp.Rational(1, 8), (x, y), bounds=BOX)
    found = repair(shape, moves=["rho", "round"], radius=0.05)
    assert [one.move for one in found.candidates] == ["round"]
    assert [other.move for other in found.rejected] == ["rho"]
    # (f + g - sqrt((f - g)**2 + e**2))/2 with e = sqrt(2)*radius takes e/2 from the diagonal.
    assert_close(found.candidates[0].price.distance, 0.071 / 2 * np.sqrt(2), rtol=3e-3)


def test_what_is_certified_is_left_alone():
    found = repair(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=BOX))
    assert (found.candidates, found.rejected, found.needed) == ((), (), False)
    assert str(found) == "CERTIFIED, analytic, as it is: nothing to repair."


def test_what_nothing_helps_is_said():
    found = repair(rsym.Shape(x**3 - y**2, (x, y), bounds=BOX))
    assert found.candidates == ()
    assert [other.move for other in found.rejected] == ["round", "rho", "pasko"]
    assert "no candidate was found" in str(found)


def test_where_nothing_could_be_tried_the_repair_has_failed_too():
    """There is no letter to move: neither a corner nor a curvature that is too large is then called repaired."""
    for found in (
        repair(CORNER, moves=["letter"]),
        repair(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=BOX), moves=["letter"], curvature=0.5),
    ):
        assert (found.candidates, found.rejected, found.needed) == ((), (), True)
        assert str(found).endswith("no candidate was found.")


@pytest.mark.slow
def test_a_boundary_may_begin_to_exist():
    c = sp.Symbol("c", real=True)
    letters = {c: rsym.Letter(-1, minimum=-2, maximum=3)}
    nothing = rsym.Shape(c - x**2 - y**2, (x, y), letters=letters, bounds=BOX)
    found = repair(nothing, moves=["letter"])
    (one,) = found.candidates
    assert found.before.verdict == "DEGENERATE"
    assert 0 < one.shape.letters["c"].default < 0.1
    assert (one.price.distance, np.isnan(one.price.volume)) == (np.inf, True)
    assert json.loads(found.to_json())["candidates"][0]["price"]["distance"] is None
    assert len(plot_repair(found).axes) == 2


class Shrink(Move):
    """A stranger's move: the boundary omega = level."""

    name = "level"

    def families(self, request):
        def step(shape, _, size):
            return shape.replace(expression=shape.expression - sp.Rational(size)), f"level {float(size):g}"

        return [MoveFamily(self.name, "another level", (Fraction(1, 10), Fraction(1, 5)), step)]


def test_a_move_of_ones_own():
    (one,) = repair(CORNER, moves=[Shrink()]).candidates
    assert (one.move, one.change, one.report.verdict) == ("level", "level 0.1", "CERTIFIED")
    # x + y - sqrt(x**2 + y**2) = c meets the diagonal at c/(2 - sqrt(2)).
    assert_close(one.price.distance, 0.1 / (2 - np.sqrt(2)) * np.sqrt(2), rtol=2e-3)


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ({"moves": ["rond"]}, "move"),
        ({"vary": ["q"]}, "unknown-letter"),
        ({"letters": {"q": 1}}, "unknown-letter"),
        ({"radius": 0}, "radius"),
        ({"curvature": -1}, "curvature"),
    ],
)
def test_bad_input_is_refused(arguments, code):
    with pytest.raises(rsym.RsymError) as raised:
        repair(CORNER, **arguments)
    assert raised.value.code == code


def test_a_letter_must_have_a_value():
    with pytest.raises(rsym.RsymError, match="has a range") as raised:
        repair(rsym.paper.skeleton_body(), letters={"a2": (5, 6)})
    assert raised.value.code == "range"


def test_false_cancels():
    with pytest.raises(rsym.RsymError) as raised:
        repair(CORNER, progress=lambda done, total: done < 2)
    assert raised.value.code == "cancelled"


@pytest.mark.slow
def test_the_report_for_people_and_for_programs(nose):
    text = str(nose)
    assert "1. a2 from 5.3 to 5.30" in text
    assert "rejected: a2 from 5.3 down to 1" in text
    assert "numerical" in text
    record = json.loads(nose.to_json())
    assert record["before"] == {"verdict": "REFUTED", "continuity": "G0"}
    assert record["candidates"][1]["price"]["distance"] == nose.candidates[1].price.distance
    assert nose._repr_html_().count("<tr>") == 3


@pytest.mark.slow
def test_the_picture_shows_every_candidate_at_the_worst_defect(nose):
    figure = plot_repair(nose)
    titles = [ax.get_title() for ax in figure.axes]
    assert titles[0].startswith("REFUTED")
    assert titles[1:] == [f"{k}   {one.change}" for k, one in enumerate(nose.candidates, 1)]
    for ax, one in zip(figure.axes[1:], nose.candidates, strict=True):
        assert f"{one.price.distance:.3g}" in ax.get_xlabel()
        after, before = sorted(ax.collections, key=lambda artist: artist.get_zorder())
        ends = [np.concatenate(artist.get_segments())[:, 0].min() for artist in (before, after)]
        assert_close(ends[0], 0, atol=1e-4)
        assert_close(abs(ends[1]), one.price.distance, rtol=5e-3)


@pytest.mark.slow
def test_the_command(tmp_path, capsys):
    picture = tmp_path / "nose.png"
    arguments = ["repair", "skeleton", "--move", "round", "--radius", "0.05", "-o", str(picture)]
    assert main(arguments) == 0
    assert "f_o rounded by 0.05: CERTIFIED" in capsys.readouterr().out
    assert picture.read_bytes()[1:4] == b"PNG"
    assert main(["repair", "skeleton", "--move", "rho", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["candidates"] == []
    assert main(["repair", "skeleton", "--move", "rond"]) == 1


@pytest.mark.slow
def test_boundaries_follow_tips_holes_and_ends():
    """A disc with a square hole, and a wedge of 20 degrees: areas and the distance of parallel lines, exactly."""
    hole = rsym.conjunction(4 - x**2 - y**2, -rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y))
    found = boundary(rsym.Shape(hole, (x, y)), ((-3, 3), (-3, 3)), 64)
    assert len(found.lines) == 2
    assert found.closed
    assert_close(found.area(), 4 * np.pi - 4, atol=1e-6)
    slope = sp.Rational(1763, 10_000)
    wedge = rsym.Shape(rsym.conjunction(slope * x - y, slope * x + y, 2 - x), (x, y))
    tipped = boundary(wedge, ((-1, 3), (-1, 1)), 40)
    assert_close(tipped.points.min(axis=0)[0], 0, atol=1e-7)
    assert_close(tipped.area(), 4 * 0.1763, atol=1e-7)
    strips = [boundary(rsym.Shape(y - c, (x, y)), BOX, 16) for c in (0.1, 0.4)]
    assert not strips[0].closed
    assert_close(distance(*strips), 0.3, atol=1e-12)


@pytest.mark.slow
def test_any_body_in_space_is_repaired():
    """Half a ball, its rim rounded: 2*f*g = e**2 with f = 1 - x**2 - r**2 and g = 2*x, slopes 2 at the rim."""
    ball = rsym.Shape(1 - x**2 - y**2 - rsym.z**2, (x, y, rsym.z), bounds=((-2, 2),) * 3).named("ball")
    half = ball & rsym.Shape(2 * x, (x, y, rsym.z)).named("cut")
    found = repair(half, moves=["round", "letter"], radius=0.25, method="space")
    assert isinstance(found.before, BodyReport)
    (one,) = found.candidates
    assert (one.report.verdict, one.report.continuity) == ("CERTIFIED", "analytic")
    amount = float(one.change.split()[-1])
    assert amount == 0.5

    def radius_squared(u):
        return 1 - u * u - amount**2 / (4 * u)

    low, high = brentq(radius_squared, 1e-3, 0.5), brentq(radius_squared, 0.5, 1)
    volume = np.pi * quad(radius_squared, low, high)[0]
    assert_close(one.price.volume, volume / (2 * np.pi / 3) - 1, atol=2e-3)
    along = np.linspace(low, high, 10_001)
    nearest = np.hypot(along, 1 - np.sqrt(np.maximum(radius_squared(along), 0))).min()
    assert_close(one.price.distance, max(nearest, low), rtol=9e-3)
    whole, window = plot_repair(found).axes
    assert "section" in whole.get_title()
    assert window.get_title().startswith("1   the root of")
