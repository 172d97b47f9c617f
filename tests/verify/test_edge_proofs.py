"""Proofs along common edges against angles, jumps and joints that are known by hand."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from matplotlib.figure import Figure
from oracles.closeness import assert_close
from oracles.hermite_doubles import Lambdified

from rsym.output.joins import plot_continuity
from rsym.program.builder import Builder
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.coons_patches import CoonsPatch
from rsym.surfaces.coons.exact import ellipsoid, sphere, torus
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.joining import join
from rsym.surfaces.networks.gordon import GordonSurface, HermiteSurface, LagrangeSurface, TensorProductSurface
from rsym.surfaces.networks.transition import TransitionSurface
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.proofs.algebra import exact_values
from rsym.surfaces.splitting import split_patch
from rsym.surfaces.symbols import t, u, v

R = sp.Rational
FLOOR = ParametricSurface((u, v, 0))


def bezier(net):
    """The polynomial patch of a net (n, m, 3) of exact numbers, by Bernstein's polynomials."""
    rows, columns = len(net) - 1, len(net[0]) - 1

    def bernstein(degree, k, t):
        return math.comb(degree, k) * t**k * (1 - t) ** (degree - k)

    cells = itertools.product(range(rows + 1), range(columns + 1))
    weighted = [(bernstein(rows, i, u) * bernstein(columns, j, v), net[i][j]) for i, j in cells]
    return sp.Matrix([sum(weight * point[axis] for weight, point in weighted) for axis in range(3)])


def some_patch(seed=5):
    """A regular bicubic patch of integers over 8: near (u, v, 0)."""
    heights = np.random.default_rng(seed).integers(-3, 4, (4, 4))
    return bezier([[(R(i, 3), R(j, 3), R(int(heights[i, j]), 8)) for j in range(4)] for i in range(4)])


def continued(point, a, b, bend=(0, 0, 0), tilt=(0, 0, 0)):
    """What leaves the edge u = 1 with q_u = a p_u + b p_v + tilt, and to second order, but for bend, as p does."""
    p, p_u, p_v = (one.subs(u, 1) for one in (point, point.diff(u), point.diff(v)))
    second = a**2 * point.diff(u, 2) + 2 * a * b * point.diff(u, v) + b**2 * point.diff(v, 2)
    first = a * p_u + b * p_v + sp.Matrix(tilt)
    # Any vector of the tangent plane may be added to the second derivative.
    return ParametricSurface(p + u * first + u**2 / 2 * (second.subs(u, 1) + p_u / 3 - p_v / 5 + sp.Matrix(bend)))


def only_edge(*patches, **options):
    (edge,) = [one for one in continuity_report(patches, prove=True, **options).edges if one.patches == (0, 1)]
    return edge


def statuses(edge):
    return tuple(level.status for level in edge.proof.levels)


@pytest.mark.slow
@pytest.mark.parametrize(("a", "b"), [(1, 0), (R(3, 2), R(1, 7)), (1 + v / 2, v / 3 - R(1, 5))])
def test_bezier_patches_with_ribbons_of_any_speed_and_slant(a, b):
    """Geometric continuity does not ask for equal derivatives: G2 by construction, G1 with a bend added to q_uu."""
    point = some_patch()
    edge = only_edge(ParametricSurface(point), continued(point, a, b))
    assert (edge.verdict, edge.proved, statuses(edge)) == ("CERTIFIED", "G2", ("equal",) * 3)
    bent = only_edge(ParametricSurface(point), continued(point, a, b, bend=(0, 0, R(1, 1000))))
    assert (bent.verdict, bent.proved, statuses(bent)) == ("REFUTED", "G1", ("equal", "equal", "different"))
    # q_uu leaves the second form by n_z/1000, which is divided by the square of what q_u has across the edge.
    place, jump = bent.curvature_jump.parameters[0][1], bent.proof.levels[2]
    t_, d = (np.array(one.subs(u, 1).subs(v, place), float).ravel() for one in (point.diff(v), point.diff(u)))
    normal = np.cross(d, t_) / np.linalg.norm(np.cross(d, t_))
    width = np.linalg.norm(np.cross(d, t_)) / np.linalg.norm(t_) * float(sp.sympify(a).subs(v, place))
    assert_close(jump.least, abs(normal[2]) / 1000 / width**2, rtol=1e-9)
    assert 0.999 * jump.least < bent.curvature_jump.value < 1.001 * jump.least


@pytest.mark.parametrize("size", [R(1, 10**6), R(1, 10**12)])
def test_a_control_point_off_by_little_is_refuted_or_bounded(size):
    """A flat net whose second row is lifted: the slope is 3 times the lift, the angle its arctangent."""
    net = [[(R(i, 3), R(j, 3), size if i == 1 else 0) for j in range(4)] for i in range(4)]
    lifted = ParametricSurface(bezier(net))
    edge = only_edge(ParametricSurface((-u, v, 0)), lifted)
    angle, level = math.degrees(math.atan(3 * size)), edge.proof.levels[1]
    if size > R(1, 10**9):
        assert (edge.verdict, edge.continuity, edge.proved) == ("REFUTED", "G0", "G0")
        assert_close(level.least, angle, rtol=1e-12)
        assert level.least <= angle
    else:
        assert (edge.verdict, edge.proved, level.status) == ("CERTIFIED", "G2", "within")
        assert angle <= level.most < level.room == pytest.approx(1e-9, rel=1e-9)


def test_the_jump_of_tangent_cylinders_is_enclosed():
    for first, second in ((1, 2), (R(1, 2), 3)):
        one = ParametricSurface((u, first * sp.sin(v), first * (1 - sp.cos(v))))
        other = ParametricSurface((1 - u, -second * sp.sin(v), second * (1 - sp.cos(v))))
        edge = only_edge(one, other)
        assert (edge.verdict, statuses(edge)) == ("REFUTED", ("equal", "equal", "different"))
        jump = float(1 / R(first) - 1 / R(second))
        assert_close(edge.proof.levels[2].least, jump, rtol=1e-12)
        assert edge.proof.levels[2].least <= jump


def test_a_surface_that_turns_back_on_itself_is_refuted():
    edge = only_edge(FLOOR, ParametricSurface((u, v * (1 + u / 10), v**2)))
    assert (edge.verdict, edge.proved, statuses(edge)) == ("REFUTED", "G0", ("equal", "different", "numerical"))
    assert edge.proof.levels[1].least == 90


@pytest.mark.slow
@pytest.mark.parametrize("pieces", [lambda: sphere(1)[:4], lambda: ellipsoid(3, 2, 1)[4:8], lambda: torus(3, 1)[:5]])
def test_exact_quadrics_and_tori_are_g2_identically(pieces):
    report = continuity_report(pieces(), prove=True)
    assert (report.verdict, report.proved) == ("CERTIFIED", "G2")
    assert {statuses(one) for one in report.meetings} == {("equal",) * 3}
    # The meridians of the quadrics end at a pole, where the normals fade.
    assert any(edge.proof.removed for edge in report.edges) == bool(report.poles)
    assert all(edge.proof.open == () for edge in report.edges)


@pytest.mark.slow
def test_arcs_of_any_blend_that_keeps_circles():
    blend = HermiteBlend.class2(R(3, 2), sp.pi / 2)
    report = continuity_report(sphere(2, blend_u=blend, blend_v=blend)[:3], prove=True)
    assert report.verdict == "CERTIFIED"
    other = sphere(R(2001, 1000))[4:5]
    worse = continuity_report([*sphere(2)[:3], *other], prove=True)
    assert worse.verdict != "CERTIFIED"


@pytest.mark.slow
def test_poles_of_cones_and_of_surfaces_with_and_without_a_tensor_of_curvature():
    def quarters(height):
        turns = [sp.pi * (u + k) / 2 for k in range(4)]
        return [ParametricSurface((v * sp.cos(a), v * sp.sin(a), height(a))) for a in turns]

    found = {
        "cone": continuity_report(quarters(lambda a: v), prove=True).poles[0],
        "bowl": continuity_report(quarters(lambda a: v**2 * (1 + sp.sin(a) ** 2) + v**3), prove=True).poles[0],
        "tip": continuity_report(quarters(lambda a: v**2 * (1 + sp.sin(2 * a) ** 2)), prove=True).poles[0],
    }
    assert {name: (pole.verdict, pole.proved) for name, pole in found.items()} == {
        "cone": ("REFUTED", None),
        "bowl": ("CERTIFIED", "G2"),
        "tip": ("REFUTED", "G1"),
    }
    # The curvature is 2 + 2 sin(2a)**2 in the direction a: no tensor is nearer than 1/2 to all of them, and so the
    # least greatest difference between two is no more than 2.
    assert 0.5 < found["tip"].proof.levels[2].least <= 2
    assert 89.9 < found["cone"].proof.levels[1].least <= 90


@pytest.mark.slow
def test_poles_of_whole_turns_of_half_turns_and_of_uneven_ones():
    """2 pi is taken exactly if it is given so; opposite directions say nothing of one another."""
    turn = ((0, 2 * sp.pi), (0, 1))
    ball = ParametricSurface((sp.sin(v) * sp.cos(u), sp.sin(v) * sp.sin(u), sp.cos(v)), turn)
    assert continuity_report(ball, prove=True).verdict == "CERTIFIED"

    def half(start, height):
        return ParametricSurface((v * sp.cos(sp.pi * u + start), v * sp.sin(sp.pi * u + start), height))

    two = continuity_report([half(0, v**2), half(sp.pi, v**2)], prove=True)
    assert two.verdict == "CERTIFIED"
    two = continuity_report([half(0, v**2), half(sp.pi, 2 * v**2)], prove=True)
    # Curvatures 2 and 4 in all directions.
    assert (two.poles[0].verdict, two.poles[0].proved) == ("REFUTED", "G1")
    assert 1 - 1e-9 < two.poles[0].proof.levels[2].least <= 2
    uneven = u + sp.sin(u) / 2
    bowl = ParametricSurface((v * sp.cos(uneven), v * sp.sin(uneven), v**2), ((0, 1), (0, 1)))
    assert continuity_report(bowl, prove=True).poles[0].verdict == "CERTIFIED"


def test_poles_that_are_not_proved_are_not_refuted():
    """Smooth surfaces, of which the parameters say little at the pole."""
    turned = u**3  # the directions stand still at u = 0
    heights = {
        "still": (v * sp.cos(turned), v * sp.sin(turned), v**2),
        "twice": (v**2 * sp.cos(u), v**2 * sp.sin(u), 0),
    }
    for point in heights.values():
        (pole,) = continuity_report(ParametricSurface(point, ((-1, 1), (0, 1))), prove=True).poles
        assert pole.verdict == "UNDECIDED"


def halves_of_a_spline(power, factor):
    """u**3 and u**3 + factor (u - 1/2)**power on both sides of u = 1/2, as nets of two B-spline surfaces."""
    parts = []
    for low, high, added in ((0.0, 0.5, 0.0), (0.5, 1.0, factor)):
        net = []
        for i in range(4):
            a = [high] * i + [low] * (3 - i)
            shifted = [one - 0.5 for one in a]
            # The blossoms of u**3 and of (u - 1/2)**power.
            picked = list(itertools.combinations(shifted, power))
            z = math.prod(a) + added * sum(map(math.prod, picked)) / len(picked)
            net.append([[sum(a) / 3, j / 4 * (j + 1) / 2, z] for j in range(4)])
        parts.append(BSplineSurface(net, knots=([low] * 4 + [high] * 4, [0.0] * 4 + [1.0] * 4)))
    return parts


@pytest.mark.parametrize(
    ("power", "verdict", "proved"), [(3, "CERTIFIED", "G2"), (2, "REFUTED", "G1"), (1, "REFUTED", "G0")]
)
def test_splines_across_a_knot_of_multiplicity_one_two_and_three(power, verdict, proved):
    edge = only_edge(*halves_of_a_spline(power, 0.375))
    assert (edge.verdict, edge.proved) == (verdict, proved)
    slope = 3 * 0.5**2
    if power == 2:
        assert_close(edge.proof.levels[2].least, 2 * 0.375 / (1 + slope**2) ** 1.5, rtol=1e-12)
    if power == 1:
        turn = math.degrees(math.atan(slope + 0.375) - math.atan(slope))
        assert_close(edge.proof.levels[1].least, turn, rtol=1e-12)


def test_edges_of_splines_with_many_knots_are_proved_span_by_span():
    rng = np.random.default_rng(3)
    net = np.stack([*np.meshgrid(np.arange(6.0), np.arange(7.0), indexing="ij"), rng.integers(-4, 5, (6, 7)) / 8], -1)
    surface = BSplineSurface(net)
    mirrored = BSplineSurface(net * (-1, 1, 1) + 0.0)
    edge = only_edge(surface, mirrored)
    # A mirror image leaves a kink of twice the slope, except where there is none.
    assert (edge.verdict, statuses(edge)[:2]) == ("REFUTED", ("equal", "different"))
    flat = net.copy()
    flat[1, :, 2] = flat[0, :, 2]
    edge = only_edge(BSplineSurface(flat), BSplineSurface(flat * (-1, 1, 1) + 0.0))
    assert (edge.verdict, statuses(edge)) == ("CERTIFIED", ("equal",) * 3)


def test_rational_arcs_and_edges_that_run_backwards():
    quarter = ((1 - u**2) / (1 + u**2), 2 * u / (1 + u**2))
    first = ParametricSurface((*quarter, v))
    second = ParametricSurface((-quarter[1], quarter[0], 1 - v))
    edge = only_edge(first, second)
    assert (edge.verdict, edge.flipped, statuses(edge)) == ("CERTIFIED", True, ("equal",) * 3)
    part = ParametricSurface((-quarter[1], quarter[0], R(1, 4) + v / 2))
    edge = only_edge(first, part)
    assert (edge.verdict, statuses(edge)) == ("CERTIFIED", ("equal",) * 3)
    assert_close(edge.intervals[0], (0.25, 0.75), atol=1e-9)


@pytest.mark.slow
def test_transitions_lofts_and_coons_patches():
    wall = ParametricSurface((2 + v / 5, v, 1 + u + u**2 * sp.exp(v) / 4))
    for order, proved in ((3, "G2"), (2, "G1")):
        fillet = TransitionSurface(FLOOR, "u1", wall, "u0", order=order)
        edge = only_edge(FLOOR, fillet)
        assert (edge.proved, statuses(edge)[:2]) == (proved, ("equal", "equal"))
    rows = [(u, R(k), R(k**2) * u) for k in range(3)]
    for kind in (HermiteSurface, LagrangeSurface):
        loft = kind(rows)
        assert only_edge(loft, ParametricSurface((u, 1 + v, (1 + v) ** 2 * u), ((0, 1), (1, 2)))).verdict == "CERTIFIED"
    given = (u, v, sp.sin(2 * u + v) / 4)
    beyond = ParametricSurface([sp.sympify(one).subs(u, 1 + u) for one in given])
    assert only_edge(CoonsPatch.of_surface(given, order=2), beyond).proved == "G1"
    grid = np.array([[[i, j, i * i - i * j] for j in range(4)] for i in range(4)], float)
    tensor = TensorProductSurface(grid, cardinals="lagrange")
    beyond = ParametricSurface((3 + u, 3 * v, (3 + u) ** 2 - 3 * (3 + u) * v))
    assert only_edge(tensor, beyond).verdict == "CERTIFIED"


@pytest.mark.slow
def test_joined_matrices_of_floats_are_bounded_all_along():
    rng = np.random.default_rng(2)
    base = np.zeros((6, 6, 3))
    base[1, :2, 0] = base[2:4, :2, 0] = base[:2, 1, 1] = base[:2, 2:4, 1] = 1
    p, q = (BicubicCoons(base + rng.normal(size=base.shape) / 20 + shift) for shift in (0, 0))
    joined = join(p, "u1", q, "u0", 1.7, continuity="G2", tolerance=1)
    edge = only_edge(p, joined)
    assert (edge.verdict, edge.proved) == ("CERTIFIED", "G2")
    assert {"within"} <= set(statuses(edge)) <= {"equal", "within"}
    assert all(level.most < level.room for level in edge.proof.levels)


def test_what_is_no_formula_or_runs_at_an_unknown_speed_is_called_numerical():
    double = Lambdified((u, -v, 0))
    edge = only_edge(FLOOR, double)
    assert (edge.verdict, edge.continuity, edge.proved, statuses(edge)) == (
        "UNDECIDED", "G2", None, ("numerical",) * 3,
    )  # fmt: skip
    assert "formulas" in edge.proof.reason
    edge = only_edge(
        ParametricSurface(((u + u**5) / 2, v, 0)), ParametricSurface(((sp.exp(u) - 1) / (sp.E - 1), -v, 0))
    )
    assert (edge.verdict, edge.continuity, statuses(edge)) == ("UNDECIDED", "G2", ("numerical",) * 3)
    assert "speeds" in edge.proof.reason


CUBIC = (u, v, u**3 + u * v + v**2)
TUBE = (sp.cos(u), sp.sin(u), v)
HURRIED = {
    "polynomial": (CUBIC, u, (u + u**2) / 2),
    "backwards": (CUBIC, u, 1 - (u + u**2) / 2),
    "rational": (CUBIC, u / (2 - u), u),
    "both": ((u, v, u * v + v**2), (u + u**2) / 2, (u + u**3) / 2),
    "arc": (TUBE, u, (u + u**2) / 2),
    "root": ((u, v, u * v), u, sp.sqrt(1 + 3 * u) - 1),
    "conic": (((1 - u**2) / (1 + u**2), 2 * u / (1 + u**2), v), u, sp.sin(sp.pi * u / 2) / (1 + sp.cos(sp.pi * u / 2))),
}


@pytest.mark.random
@pytest.mark.parametrize("name", sorted(HURRIED))
def test_edges_that_run_at_other_speeds_are_proved_by_one_parameter(name):
    """One surface on both sides of v = 0, cut and run at two speeds, then with a kink and a jump of curvature."""
    surface, here, there = HURRIED[name]

    def sheet(by, across, lift=0):
        point = [sp.sympify(one).subs({u: by, v: across}, simultaneous=True) for one in surface]
        return ParametricSurface((*point[:2], point[2] + lift))

    first = sheet(here, v)
    edge = only_edge(first, sheet(there, -v))
    assert (edge.verdict, statuses(edge)) == ("CERTIFIED", ("equal",) * 3)
    # Of the tube only what moves it along x is across.
    lift = v if name not in {"arc", "conic"} else 0
    for order, proved in ((1, "G0"), (2, "G1")):
        if lift != 0:
            edge = only_edge(first, sheet(there, -v, lift**order / 1000))
            assert (edge.verdict, edge.proved) == ("REFUTED", proved)
            level = edge.proof.levels[order]
            assert 0 <= level.place <= 1
            found = (edge.angle, edge.curvature_jump)[order - 1]
            assert level.least <= found.value * (1 + 1e-6)


def test_a_parameter_that_is_no_more_than_near_is_none():
    """Edges apart by less than what counts as a gap, and a function that does not end where the other edge does."""
    nearly = sp.sqrt(R(1, 4) + 2 * u) - R(1, 2) + u * (1 - u) / 10**12
    assert only_edge(ParametricSurface(((u + u**2) / 2, v, 0)), ParametricSurface((u, -v, u / 10**10))).proved is None
    edge = only_edge(FLOOR, ParametricSurface((nearly, -v, 0)))
    assert "different" not in statuses(edge)


def test_a_patch_without_normals_is_degenerate():
    cusp = ParametricSurface((u, -(v**2), v**3))
    assert only_edge(FLOOR, cusp).verdict == "DEGENERATE"
    fading = ParametricSurface((u, -v * (u - R(1, 3)) ** 2, 0))
    edge = only_edge(FLOOR, fading)
    assert (edge.verdict, edge.proved) == ("UNDECIDED", "G0")


def test_a_plane_whose_parameter_stands_still_on_the_edge_is_not_called_degenerate():
    for height in (0, v**4, v**6):
        assert only_edge(FLOOR, ParametricSurface((u, -(v**2), height))).verdict == "UNDECIDED"


THIRD = R(1, 3)


def pieces(below, above, at, place=THIRD):
    """A function that is one thing below a place, another above it, and a third there."""
    return sp.Piecewise((below, u < place), (above, u > place), (at, True))


@pytest.mark.random
@pytest.mark.parametrize(
    ("floor", "wall"),
    [
        (0, pieces(0, 0, 1)),
        (pieces(0, 0, 1), pieces(0, 0, 1)),
        (0, pieces(0, 0, 1, 0)),
        (0, pieces(0, 0, 1, 1)),
        (0, sp.Piecewise((1, sp.And(u <= THIRD, u >= THIRD)), (0, True))),
        (sp.Piecewise((0, u < THIRD), (1, True)), sp.Piecewise((0, u < THIRD), (1, True))),
        (0, pieces(0, 0, 1, R(1, 2))),  # samples find this one, and leave it out
        (0, v * pieces(0, 0, 1) + pieces(0, 0, R(1, 10**9))),
    ],
)
def test_the_value_of_a_formula_at_one_place_counts(floor, wall):
    """Samples pass it by, and the pieces on both sides of it are equal: it is torn at that place."""
    report = continuity_report([ParametricSurface((u, v, floor)), ParametricSurface((u, -v, wall))], prove=True)
    assert report.edges
    assert {edge.verdict for edge in report.edges} == {"UNDECIDED"}


def test_pieces_that_meet_are_one_formula():
    cube = (u - THIRD) ** 3
    floor = ParametricSurface((u, v, sp.Piecewise((0, u < THIRD), (cube, True))))
    for wall in (sp.Piecewise((cube, u > THIRD), (0, True)), pieces(0, cube, 0), sp.Max(u - THIRD, 0) ** 3):
        assert only_edge(floor, ParametricSurface((u, -v, wall))).verdict == "CERTIFIED"


def test_letters_have_their_values():
    r = sp.Symbol("r")
    tube = ParametricSurface((u, r * sp.sin(v), r * (1 - sp.cos(v))), letters={r: 1})
    fixed = ParametricSurface((1 - u, -2 * sp.sin(v), 2 * (1 - sp.cos(v))))
    assert only_edge(tube, fixed).verdict == "REFUTED"
    assert only_edge(tube, fixed, letters={"r": 2}).verdict == "CERTIFIED"


@pytest.mark.parametrize(
    ("expression", "zero"),
    [
        (sp.cos(3 * v) - 4 * sp.cos(v) ** 3 + 3 * sp.cos(v), True),
        (sp.sin(sp.pi * v / 2) ** 2 + sp.cos(sp.pi * v / 2) ** 2 - 1, True),
        (sp.sin(sp.pi * (v + R(1, 3))) - sp.sin(sp.pi * v) / 2 - sp.sqrt(3) / 2 * sp.cos(sp.pi * v), True),
        (sp.sqrt(6) * v - sp.sqrt(2) * sp.sqrt(3) * v, True),
        ((v**2 - 1) / (v + 1) - v + 1, True),
        (sp.sqrt(1 + v**2) ** 3 / sp.sqrt(1 + v**2) - v**2 - 1, True),
        (sp.cos(3 * v) - 4 * sp.cos(v) ** 3 + R(29, 10) * sp.cos(v), False),
        (sp.pi * v - R(355, 113) * v, False),
        (sp.exp(v) - 1 - v, False),
    ],
)
def test_exact_arithmetic_knows_zero(expression, zero):
    from rsym.program.lowering import lower

    builder = Builder(("v",), ())
    (value,) = exact_values(builder.nodes, [lower(builder, expression)])
    assert value.is_zero is zero


def test_the_report_says_what_is_proved():
    ramp = ParametricSurface((u, -v * sp.cos(R(1, 2)), v * sp.sin(R(1, 2))))
    report = continuity_report([FLOOR, ramp, ParametricSurface((1 + u, v, 0))], prove=True)
    assert (report.verdict, report.proved) == ("REFUTED", "G0")
    text, html = str(report), report._repr_html_()
    assert "Proofs: REFUTED (1 of 2 edges CERTIFIED, 1 of 2 edges REFUTED, 1 exactly)." in text
    assert "proved: the gap is 0; the angle is at least 28.64 degrees at t = " in text
    assert "REFUTED: proved: the gap is 0" in html
    silent = continuity_report([FLOOR, ramp])
    assert (silent.verdict, silent.proved, silent.edges[0].proof) == (None, None, None)
    assert "proved:" not in str(silent)


@pytest.mark.slow
def test_no_random_join_is_judged_wrongly():
    """Planted jumps of the second derivative from none to large: what is said must be true of each."""
    rng = np.random.default_rng(7)
    for seed in range(4):
        point = some_patch(seed)
        planted = [R(0), R(1, 10**13), R(1, 10**6), R(1, 10)][seed % 4]
        a, b = (R(int(one), 4) for one in rng.integers(2, 7, 2))
        edge = only_edge(ParametricSurface(point), continued(point, a, b, bend=(0, 0, planted)))
        level = edge.proof.levels[2]
        assert level.status == ("equal" if planted == 0 else "within" if planted < R(1, 10**9) else "different")
        if level.status == "within":
            assert 0 < level.least <= level.most <= level.room
        assert Fraction(level.least) >= 0


@pytest.mark.parametrize("lift", [R(1, 1000), R(1, 10**8)])
def test_a_crack_is_proved_by_the_distance_of_one_point_from_the_other_edge(lift):
    """The edge that is lifted runs at another speed: the point that is farthest is compared with all of the other."""
    arch = ParametricSurface((u, -v, u * (1 - u)))
    lifted = ParametricSurface(((u + u**2) / 2, v, (u + u**2) / 2 * (1 - (u + u**2) / 2) + lift))
    edge = only_edge(arch, lifted)
    gap = edge.proof.levels[0]
    assert (edge.verdict, edge.proved, gap.status) == ("REFUTED", None, "different")
    assert 0.99 * edge.gap.value < gap.least <= edge.gap.value * (1 + 1e-9) <= lift * (1 + 1e-8)


@pytest.mark.slow
def test_one_spline_across_its_own_knots_and_a_loft_across_its_sections():
    """A simple knot of a cubic is C2, a double one C1, a triple one C0; composite Hermite functions are C1."""
    rng = np.random.default_rng(11)
    for count, proved in ((1, "G2"), (2, "G1"), (3, "G0")):
        knots = [0.0] * 4 + [0.5] * count + [1.0] * 4
        along = [np.mean(knots[i + 1 : i + 4]) for i in range(4 + count)]
        grid = np.meshgrid(along, np.arange(4.0) / 3, indexing="ij")
        net = np.stack([*grid, rng.integers(-8, 9, (4 + count, 4)) / 16], -1)
        first, second = split_patch(BSplineSurface(net, knots=(knots, [0.0] * 4 + [1.0] * 4)))
        assert only_edge(first, second).proved == proved
    loft = HermiteSurface([(u, R(k), R(k**3) * u) for k in range(4)])
    assert [only_edge(*split_patch(loft, v=[k])).proved for k in (1, 2)] == ["G1", "G1"]
    assert only_edge(*split_patch(loft, v=[0.5])).proved == "G2"


def test_on_a_line_between_pieces_the_side_of_the_patch_counts():
    kinked = ParametricSurface((u, v, sp.Piecewise((0, u < 1), (u - 1, True))), ((0, 2), (0, 1)))
    first, second = split_patch(kinked, u=[1])
    flat = ParametricSurface((1 + u, v, 0))
    assert (only_edge(first, flat).verdict, only_edge(first, second).verdict) == ("CERTIFIED", "REFUTED")


@pytest.mark.slow
def test_gordon_surfaces():
    """A network of a polynomial surface goes on as it does; cardinal functions of Hermite are C1 at their knots."""

    def height(x, y):
        return x**2 * y + x * y**2 / 2 - sp.sin(2 * x) * y**3 / 3

    along = [(t, y, height(t, y)) for y in (0, R(1, 4), R(1, 2), 1)]
    over = [(x, t, height(x, t)) for x in (0, R(1, 2), 1)]
    surface = GordonSurface(along, over)
    for lift, verdict, proved in ((0, "CERTIFIED", "G2"), (u * v, "REFUTED", "G0"), (u**2 * v, "REFUTED", "G1")):
        beyond = ParametricSurface((1 + u, v, height(1 + u, v) + lift / 1000))
        edge = only_edge(surface, beyond)
        assert (edge.verdict, edge.proved) == (verdict, proved)
    assert only_edge(*split_patch(surface, u=[0.5])).verdict == "CERTIFIED"
    assert only_edge(*split_patch(surface, u=[0.3])).verdict == "CERTIFIED"
    more = [(x, t, height(x, t)) for x in (0, R(1, 4), R(1, 2), R(4, 5), 1)]
    bent = GordonSurface(along[:3], more, cardinals_u="hermite")
    assert only_edge(*split_patch(bent, u=[0.5])).proved == "G1"
    assert only_edge(*split_patch(bent, u=[0.3])).verdict == "CERTIFIED"


def test_the_legend_of_a_picture_counts_what_is_proved():
    axes = Figure().add_subplot(projection="3d")
    patches = [FLOOR, ParametricSurface((-u, v, u)), ParametricSurface((1 + u, v, 0)), Lambdified((u, -v, 0))]
    report = continuity_report(patches, prove=True)
    found = plot_continuity(patches, report, ax=axes, resolution=4).parts
    assert list(found) == ["G0: 1 proved", "G2: 2, 1 proved"]


@pytest.mark.parametrize("power", [1, 2])
def test_a_value_on_a_line_that_leads_to_the_edge_is_a_break(power):
    thin = sp.Piecewise((0, v < THIRD), (0, v > THIRD), (1, True))
    first = ParametricSurface((u, v, u * v + u**2))
    second = ParametricSurface((1 + u, v, (1 + u) * v + (1 + u) ** 2 + u**power * thin))
    assert continuity_report([first, second], prove=True).verdict != "CERTIFIED"


@pytest.mark.parametrize(
    "sector", [sp.Piecewise((0, v - THIRD > 2 * u), (1, v - THIRD > u), (0, True)), abs(v - u - THIRD)]
)
def test_pieces_that_meet_obliquely_to_an_edge_are_not_told_by_it(sector):
    """A sector reaches the edge in one point only: on the edge nothing of it is seen, beside it the patch is torn."""
    first = ParametricSurface((u, v, u * v + u**2))
    second = ParametricSurface((1 + u, v, (1 + u) * v + (1 + u) ** 2 + u * sector))
    assert continuity_report([first, second], prove=True).verdict != "CERTIFIED"


HALF = sp.Rational(1, 2)
INSIDE = {
    "torn": sp.Piecewise((0, u < HALF), (1, True)),
    "kinked": sp.Piecewise((0, u < HALF), (u - HALF, True)),
    "abs": abs(u - HALF) - HALF + u,
    "bent": sp.Max(0, u - HALF) ** 2,
    "oblique": sp.Max(0, u + v - 1),
    "torn on a line": sp.Piecewise((0, (u - HALF) ** 2 > 0), (1, True)),
    "root": u**3 * sp.sqrt((u - sp.Rational(1, 3)) ** 2 * (1 + v**2)),
    "pole": u**3 / (u - sp.Rational(1, 3)),
}


@pytest.mark.parametrize("height", INSIDE.values(), ids=list(INSIDE))
def test_what_is_torn_or_kinked_between_its_edges_is_not_certified(height):
    report = continuity_report([ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, height))], prove=True)
    assert report.verdict != "CERTIFIED"
    assert report.doubts[1]
    assert not report.doubts[0]
    assert "inside patch 1 nothing is proved" in str(report).lower()


@pytest.mark.parametrize(
    "height",
    [
        abs(1 + u) * u**3,
        sp.Max(u - 1, 0) + u**3,
        sp.Piecewise((u**3, u < 1), (9, True)),
        u**3 * sp.exp(v),
        u**3 / (1 + u),
    ],
)
def test_what_is_smooth_between_its_edges_is_certified(height):
    report = continuity_report([ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, height))], prove=True)
    assert (report.verdict, report.doubts) == ("CERTIFIED", ("", ""))
    assert "Inside, all patches are twice differentiable; their normals are not examined." in str(report)


def test_the_pieces_of_what_is_cut_are_certified_if_they_fit():
    height = sp.Piecewise((0, u < HALF), ((u - HALF) ** 3, True))
    patch = ParametricSurface((u, v, height))
    assert continuity_report([patch, ParametricSurface((u - 1, v, 0))], prove=True).verdict == "UNDECIDED"
    cut = continuity_report([*split_patch(patch, u=[0.5]), ParametricSurface((u - 1, v, 0))], prove=True)
    assert cut.verdict == "CERTIFIED"


@pytest.mark.parametrize("degree", [2, 3])
def test_a_spline_inside_is_as_smooth_as_its_knots(degree):
    net = np.stack([*np.meshgrid(np.arange(6.0), np.arange(6.0), indexing="ij"), np.zeros((6, 6))], -1)
    shifted = net + np.array([5, 0, 0])
    report = continuity_report([BSplineSurface(one, degree=(degree, 3)) for one in (net, shifted)], prove=True)
    assert (report.verdict, bool(report.doubts[0])) == (("UNDECIDED", True) if degree == 2 else ("CERTIFIED", False))


@pytest.mark.parametrize(
    ("height", "least"), [(sp.Rational(1, 10**6) * u**2, "G1"), (sp.Rational(1, 10**8) * u, "G0")], ids=["bend", "kink"]
)
def test_the_class_is_no_more_than_a_proof_leaves(height, least):
    patches = [ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, height))]
    assert continuity_report(patches).continuity == "G2"
    report = continuity_report(patches, prove=True)
    assert (report.verdict, report.continuity, report.proved) == ("REFUTED", least, least)
    assert (report.edges[0].continuity, len(report.defects)) == (least, 1)
    assert least in report.edges[0].classes
    assert f"1 common edge: {least} (1 {least})" in str(report)
    assert report.document().continuity == least
