import itertools
import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.hermite_doubles import Corners, Lambdified, sheet, sphere

from rsym.errors import RsymError
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import u, v

QUARTER = math.pi / 2
FLOOR = Lambdified((u, v, 0))


def octants():
    """The upper four walk eastwards, the lower four westwards: parameters run against each other on the equator."""
    upper = [sphere((k * QUARTER, (k + 1) * QUARTER), (0, QUARTER)) for k in range(4)]
    return upper + [sphere(((k + 1) * QUARTER, k * QUARTER), (0, -QUARTER)) for k in range(4)]


def ramp(degrees, shape=v):
    """Joins the floor along v = 0, turned by an angle."""
    angle = math.radians(degrees)
    return Lambdified((u, -v * math.cos(angle), shape * math.sin(angle)))


def names(edge):
    return tuple(f"{patch} {name}" for patch, name in zip(edge.patches, edge.edges, strict=True))


def halves(matrix):
    """The two halves in u of a bicubic patch: Hermite data over half the interval."""
    whole = Corners(matrix)
    rows = []
    for low in (0.0, 0.5):
        places = np.array([low, low + 0.5])
        half = np.empty((4, 4, 3))
        for k, j in itertools.product((0, 1), (0, 1)):
            data = whole.derivatives(places[:, None], np.array([0.0, 1.0])[None], ((k, j),))[0]
            half[2 * k : 2 * k + 2, 2 * j : 2 * j + 2] = data * 0.5**k
        rows.append(half)
    return rows


@pytest.mark.slow
def test_the_octants_of_a_sphere_are_g2_poles_included():
    report = continuity_report(octants())
    assert report.continuity == "G2"
    assert len(report.edges) == 12
    assert report.free == ()
    assert sorted(pole.patches for pole in report.poles) == [(0, 1, 2, 3), (4, 5, 6, 7)]
    for meeting in report.meetings:
        assert meeting.gap.at_most < 1e-13
        assert meeting.angle.at_most < 1e-11
        assert meeting.curvature_jump.at_most < 1e-12
    assert not any(edge.flipped for edge in report.edges)
    heights = sorted(pole.point[2] for pole in report.poles)
    assert_close(heights, [-1, 1], atol=1e-14)


@pytest.mark.slow
def test_an_octant_out_of_place_leaves_a_crack_that_is_measured():
    moved = octants()
    moved[2] = sphere((2 * QUARTER, 3 * QUARTER), (0, QUARTER), shift=(0, 0, 1e-3))
    report = continuity_report(moved)
    broken = [one for one in report.edges if one.continuity == "broken"]
    assert {names(one) for one in broken} == {("1 u1", "2 u0"), ("2 u1", "3 u0"), ("2 v0", "6 v0")}
    assert len(report.edges) == 12
    assert report.free == ()
    for one in broken:
        # Lifted by 1e-3: at the equator by as much, on meridians less, as the lifted one is also met further down.
        assert_close(one.gap.value, 1e-3, rtol=1e-3)
    assert [one.continuity for one in report.poles] == ["broken", "G2"]
    assert_close(report.poles[0].gap.value, 1e-3, rtol=1e-9)


def test_a_patch_that_is_turned_is_reported_with_its_angle():
    for degrees in (1e-3, 0.5, 30, 90, 150):
        (edge,) = continuity_report([FLOOR, ramp(degrees)]).edges
        assert edge.continuity == "G0"
        assert_close(edge.angle.value, degrees, rtol=1e-9)
    (edge,) = continuity_report([FLOOR, ramp(1e-3)], angle=1e-2).edges
    assert edge.continuity == "G2"


def test_a_surface_that_turns_back_on_itself_is_not_smooth():
    back = Lambdified((u, v * (1 + u / 10), v**2))
    report = continuity_report([FLOOR, back])
    (edge,) = [one for one in report.edges if names(one) == ("0 v0", "1 v0")]
    assert (edge.continuity, edge.angle.value) == ("G0", 180.0)


def test_a_narrow_kink_is_found_at_its_place():
    place, slope = 0.3137, 0.1
    bump = slope * sp.exp(-(((u - place) / 0.02) ** 2))
    (edge,) = continuity_report([FLOOR, Lambdified((u, -v, v * bump))]).edges
    assert edge.continuity == "G0"
    assert_close(edge.angle.value, math.degrees(math.atan(slope)), rtol=1e-8)
    assert edge.angle.error < 1e-3
    assert_close(edge.worst.point, (place, 0, 0), atol=1e-5)
    assert_close(edge.worst.parameters, [(place, 0), (place, 0)], atol=1e-5)
    assert (edge.points[np.argmax(edge.angles)] == edge.worst.point).all()
    assert {"G0", "G2"} <= set(edge.classes)


@pytest.mark.parametrize("knots", [128, 33 * 88 // 11])
def test_gaps_that_vanish_at_all_the_knots_are_found(knots):
    waves = Lambdified((u, -v + sp.Rational(1, 10**5) * sp.sin(knots * sp.pi * u), 0))
    (edge,) = continuity_report([FLOOR, waves]).edges
    assert edge.continuity == "broken"
    assert_close(edge.gap.value, 1e-5, rtol=1e-3)


@pytest.mark.parametrize("radius", [0.5, 3.0])
def test_the_jump_of_curvature_is_that_of_tangent_cylinders(radius):
    for other, sign in ((1.0, 1), (2.0, -1)):
        first = Lambdified((u, radius * sp.sin(v), radius * (1 - sp.cos(v))))
        second = Lambdified((1 - u, -other * sp.sin(v), sign * other * (1 - sp.cos(v))))
        (edge,) = continuity_report([first, second]).edges
        assert (edge.continuity, edge.flipped) == ("G1", False)
        assert_close(edge.curvature_jump.value, abs(1 / radius - sign / other), rtol=1e-12)
        turned = Lambdified([one.subs(u, 1 - u) for one in second.point])
        (edge,) = continuity_report([first, turned]).edges
        assert (edge.continuity, edge.flipped) == ("G1", True)
        assert_close(edge.curvature_jump.value, abs(1 / radius - sign / other), rtol=1e-12)


def test_edges_may_run_at_different_speeds_and_meet_at_a_slant():
    speed = (u + u**2) / 2
    upper, lower = sphere((0, 1), (0, 1)), sphere((0, 1), (0, -1))
    for running in (speed, 1 - speed):
        slanted = Lambdified([one.subs(u, running + v / 3, simultaneous=True) for one in lower.point])
        report = continuity_report([upper, slanted])
        assert [names(one) for one in report.edges] == [("0 v0", "1 v0")]
        assert report.continuity == "G2"
        (edge,) = report.edges
        assert edge.gap.at_most < 1e-14
        assert edge.flipped == (running == speed)


def test_one_edge_may_meet_parts_of_others():
    long = sphere((0, 1.5), (0, 0.5))
    short = [sphere((-0.5, 0.5), (-0.5, 0)), sphere((0.5, 0.501), (0, -0.5)), sphere((0.8, 1.5), (-0.5, 0))]
    report = continuity_report([long, *short])
    assert report.continuity == "G2"
    along = {names(one)[1]: np.array(one.intervals[0]) * 1.5 for one in report.edges if one.patches[0] == 0}
    assert_close(along["1 v1"], (0, 0.5), atol=1e-12)
    assert_close(along["2 v0"], (0.5, 0.501), atol=1e-12)
    assert_close(along["3 v1"], (0.8, 1.5), atol=1e-12)
    partners = {names(one)[1]: one.intervals[1] for one in report.edges}
    assert_close(partners["1 v1"], (0.5, 1), atol=1e-12)
    free = {(one.patch, one.edge): one.interval for one in report.free}
    assert_close(np.array(free[0, "v0"]) * 1.5, (0.501, 0.8), atol=1e-12)
    assert_close(free[1, "v1"], (0, 0.5), atol=1e-12)
    assert (2, "v0") not in free


def test_edges_that_part_are_joined_up_to_there():
    parting = Lambdified((u, -v, sp.Piecewise((0, u < 0.4), ((u - 0.4) ** 2, True))))
    (edge,) = continuity_report([FLOOR, parting]).edges
    assert_close(edge.intervals[0][1], 0.4 + math.sqrt(edge.tolerances.gap), atol=1e-5)
    assert all(one == "G2" for one, x in zip(edge.classes, edge.points[:, 0], strict=True) if x < 0.4)


def test_edges_that_only_touch_are_not_common():
    crossing = Lambdified((u, 2 * (u - 0.5) + 0 * v, v))
    beside = Lambdified((1 + v, u / 2 - 3, u + v))
    corner = Lambdified((1 + u, 1 + v, u * v))
    assert continuity_report([FLOOR, crossing, beside, corner]).edges == ()
    assert continuity_report([FLOOR, beside]).continuity is None


def test_what_is_joined_elsewhere_is_not_a_crack():
    lid, wall = Lambdified((u, v, 0.005)), Lambdified((0.7 * u, 0, 0.005 * v))
    assert [names(one) for one in continuity_report([FLOOR, lid]).edges if one.continuity == "broken"] == [
        (f"0 {name}", f"1 {name}") for name in ("u0", "u1", "v0", "v1")
    ]
    edges = continuity_report([FLOOR, lid, wall]).edges
    assert {names(one) for one in edges if "v0" in one.edges} == {("0 v0", "2 v0"), ("1 v0", "2 v1")}


def test_seams_and_poles_of_one_patch():
    around = ((0.0, 2 * math.pi), (0.0, 2 * math.pi))
    torus = Lambdified(((2 + sp.cos(v)) * sp.cos(u), (2 + sp.cos(v)) * sp.sin(u), sp.sin(v)), around, (True, True))
    report = continuity_report(torus)
    assert [names(one) for one in report.edges] == [("0 u0", "0 u1"), ("0 v0", "0 v1")]
    assert (report.continuity, report.free) == ("G2", ())
    cone = Lambdified((v * sp.cos(u), v * sp.sin(u), v), ((0.0, 2 * math.pi), (0.0, 1.0)), (True, False))
    report = continuity_report(cone)
    (pole,) = report.poles
    assert (pole.continuity, pole.patches, pole.edges, report.edges[0].continuity) == ("G0", (0,), ("v0",), "G2")
    assert_close(pole.angle.value, 90, rtol=1e-12)
    # A bowl whose curvature changes round the pole: 2 along x, 4 along y.
    bowl = Lambdified((v * sp.cos(u), v * sp.sin(u), v**2 * (1 + sp.sin(u) ** 2)), cone.domain, (True, False))
    assert continuity_report(bowl).continuity == "G2"
    tip = Lambdified((v * sp.cos(u), v * sp.sin(u), v**2 * (1 + sp.sin(2 * u) ** 2)), cone.domain, (True, False))
    (pole,) = continuity_report(tip).poles
    assert pole.continuity == "G1"


def test_poles_of_half_powers():
    """Of r**(3/2) curvatures grow without bound, which are 0 at the pole of r**(5/2)."""
    for power, continuity in ((sp.Rational(3, 2), "G1"), (sp.Rational(4, 3), "G1"), (sp.Rational(5, 2), "G2")):
        dish = ParametricSurface((v * sp.cos(u), v * sp.sin(u), v**power), ((0, 2 * sp.pi), (0, 1)))
        assert continuity_report(dish).continuity == continuity


def test_normals_at_a_pole_are_turned_to_one_side_patch_by_patch():
    """The normals of opposite pieces of a steep cone differ by more than a right angle."""
    turns = [(k * QUARTER, (k + 1) * QUARTER)[::way] for k, way in enumerate((1, -1, -1, 1))]
    angles = [a + (b - a) * u for a, b in turns]
    pieces = [Lambdified((v * sp.cos(angle), v * sp.sin(angle), 2 * v)) for angle in angles]
    report = continuity_report(pieces)
    assert {edge.flipped for edge in report.edges} == {False, True}
    assert {edge.continuity for edge in report.edges} == {"G2"}
    (pole,) = report.poles
    assert (pole.continuity, pole.patches) == ("G0", (0, 1, 2, 3))
    assert_close(pole.angle.value, 180 - 2 * math.degrees(math.atan(0.5)), rtol=1e-9)


def test_a_moebius_band_is_smooth_and_one_sided():
    angle = 2 * sp.pi * u
    out = 1 + (v - 0.5) * sp.cos(angle / 2) / 2
    band = Lambdified((out * sp.cos(angle), out * sp.sin(angle), (v - 0.5) * sp.sin(angle / 2) / 2))
    report = continuity_report(band)
    (edge,) = report.edges
    assert (names(edge), edge.continuity, edge.flipped) == (("0 u0", "0 u1"), "G2", True)
    assert_close(edge.intervals[1], (1, 0), atol=1e-12)
    assert {one.edge for one in report.free} == {"v0", "v1"}


@pytest.mark.random
@pytest.mark.parametrize(("radius", "shift"), [(1, (1e4, -2e4, 3e3)), (1e-4, (1, 0, 0)), (1e5, (0, 0, 0))])
def test_size_and_place_do_not_matter(radius, shift):
    pieces = [sphere(east, (0, QUARTER), radius, shift) for east in ((0, QUARTER), (2 * QUARTER, QUARTER))]
    report = continuity_report(pieces)
    assert (report.continuity, len(report.edges), len(report.poles)) == ("G2", 1, 1)
    pieces[1] = sphere((2 * QUARTER, QUARTER), (0, QUARTER), radius * (1 + 1e-5), shift)
    assert continuity_report(pieces).continuity == "broken"


def test_closed_edges_that_begin_at_different_places():
    tube = Lambdified((sp.cos(u), sp.sin(u), v), ((0.0, 2 * math.pi), (0.0, 1.0)), (True, False))
    dome = Lambdified(
        (sp.cos(1 - u) * sp.cos(v), sp.sin(1 - u) * sp.cos(v), 1 + sp.sin(v)), ((0.0, 2 * math.pi), (0.0, QUARTER))
    )
    report = continuity_report([tube, dome])
    common = sorted((one for one in report.edges if one.patches == (0, 1)), key=lambda one: one.intervals[0])
    assert_close([one.intervals[0] for one in common], [(0, 1), (1, 2 * math.pi)], atol=1e-10)
    assert_close([one.intervals[1] for one in common], [(1, 0), (2 * math.pi, 1)], atol=1e-10)
    assert {one.continuity for one in common} == {"G1"}
    for one in common:
        assert_close(one.curvature_jump.value, 1, rtol=1e-9)


@pytest.mark.slow
def test_noise_does_not_refute_and_a_real_perturbation_does():
    matrix = sheet(3)
    noise = 1e-12 * np.random.default_rng(4).normal(size=matrix.shape)
    split = halves(matrix)
    assert continuity_report([Corners(split[0]), Corners(split[1])]).continuity == "G2"
    assert continuity_report([Corners(split[0]), Corners(split[1] + noise)]).continuity == "G2"
    for row, continuity in ((0, "broken"), (2, "G0")):
        changed = split[1].copy()
        changed[row, 3] += (0, 0, 1e-3)
        (edge,) = continuity_report([Corners(split[0]), Corners(changed)]).edges
        assert edge.continuity == continuity
        # G1(v) = v^3 - v^2 is greatest in size at 2/3.
        assert_close(edge.worst.parameters, [(1, 2 / 3), (0, 2 / 3)], atol=0.05)


def test_letters_belong_to_the_patches_that_have_them():
    r = sp.Symbol("r")
    tube = ParametricSurface((u, r * sp.sin(v), r * (1 - sp.cos(v))), letters={r: 1})
    floor = ParametricSurface((1 - u, -v, 0))
    assert_close(continuity_report([tube, floor]).edges[0].curvature_jump.value, 1, rtol=1e-12)
    assert_close(continuity_report([tube, floor], letters={"r": 4}).edges[0].curvature_jump.value, 0.25, rtol=1e-12)
    with pytest.raises(RsymError, match="no letter 'q'"):
        continuity_report([tube, floor], letters={"q": 4})


def test_the_report_reads_as_words_and_as_a_table():
    report = continuity_report([FLOOR, ramp(30), Lambdified((1 + u, v, 0))])
    text = str(report)
    assert "3 patches, 2 common edges: G0 (1 G0, 1 G2)" in text
    assert "0 v0 - 1 v0: G0; the normals differ by 30 degrees; worst at" in text
    assert "normals to different sides" in text
    assert "not proved" in text
    assert "Free: 0 u0, 0 v1, 1 u0, 1 u1, 1 v1, 2 u1, 2 v0, 2 v1" in text
    html = report._repr_html_()
    assert html.count("<tr>") == 3
    assert "30°" in html
    assert "nothing meets" in str(continuity_report(FLOOR))


def test_what_is_no_patch_is_refused():
    with pytest.raises(RsymError, match="surfaces are patches, got int at place 1"):
        continuity_report([FLOOR, 3])
    with pytest.raises(RsymError, match="angle must be positive"):
        continuity_report([FLOOR], angle=0)
    assert continuity_report([]).continuity is None


@pytest.mark.parametrize(
    ("height", "continuity"), [(0, "G2"), (v**6, "G2"), (v**4, "G1"), (v**3, "G1"), (v**2, "G0")], ids=str
)
@pytest.mark.parametrize("flipped", [False, True])
def test_an_edge_on_which_a_parameter_stands_still(height, continuity, flipped):
    """With w = v**2 the second patch is z = w**3, w**2 (curvature 2), w**1.5 (unbounded), w (a kink of 45 degrees)."""
    floor, wall = ParametricSurface((u, v, 0)), (u, -(v**2), height)
    if flipped:
        wall = [sp.sympify(part).subs(v, 1 - v) for part in wall]
    report = continuity_report([floor, ParametricSurface(wall)])
    assert report.continuity == continuity
    if continuity == "G0":
        assert_close(report.edges[0].angle.value, 45.0, atol=1e-9)
