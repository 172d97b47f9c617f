import itertools

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.hermite_doubles import Corners, Lambdified, sheet, sphere

import rsym
from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.exact import sphere as sphere_patches
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.joining import join
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v

EDGES = ("u0", "u1", "v0", "v1")
CASES = list(itertools.product(EDGES, EDGES, (False, True)))
S = np.linspace(0, 1, 11)
FAR = 100  # sheets of random data do not meet: their edges are moved

# Where the parameter s of an edge is, which derivative leads along it and which across, and whether that is outwards.
PLACES = {
    "u0": (lambda s: (0 * s, s), (0, 1), (1, 0), -1),
    "u1": (lambda s: (0 * s + 1, s), (0, 1), (1, 0), 1),
    "v0": (lambda s: (s, 0 * s), (1, 0), (0, 1), -1),
    "v1": (lambda s: (s, 0 * s + 1), (1, 0), (0, 1), 1),
}
OPPOSITE = {"u0": "u1", "u1": "u0", "v0": "v1", "v1": "v0"}


def times(order, count):
    return tuple(count * one for one in order)


def plus(one, other):
    return tuple(a + b for a, b in zip(one, other, strict=True))


def out_of(patch, edge, s, along=0, across=0):
    """A derivative of a patch on an edge, across it outwards."""
    place, runs, leads, sign = PLACES[edge]
    return sign**across * patch.derivative(*place(s), plus(times(runs, along), times(leads, across)))


def check_joined(p, edge_p, q, edge_q, k, h=lambda s: 0 * s, *, reverse, depth=1, atol=1e-12):
    """Values and derivatives into q are those out of p, by the chain rule written out."""
    s = 1 - S if reverse else S
    turn = -1 if reverse else 1
    ratio, slant = k(S)[:, None], h(S)[:, None]
    out = [[turn**i * out_of(p, edge_p, s, i, j) for j in range(3)] for i in range(3)]
    assert_close(out_of(q, edge_q, S), out[0][0], atol=atol)
    assert_close(-out_of(q, edge_q, S, 0, 1), ratio * out[0][1] + slant * out[1][0], atol=atol)
    if depth == 2:
        second = ratio**2 * out[0][2] + 2 * ratio * slant * out[1][1] + slant**2 * out[2][0]
        assert_close(out_of(q, edge_q, S, 0, 2), second, atol=atol)


@pytest.fixture(scope="module")
def pair():
    return BicubicCoons(sheet(1)), BicubicCoons(sheet(2))


@pytest.mark.random
@pytest.mark.parametrize(("edge_p", "edge_q", "reverse"), CASES)
def test_all_edges_join_in_both_directions(pair, edge_p, edge_q, reverse):
    p, q = pair
    doubles = Corners(p.matrix), Corners(join(p, edge_p, q, edge_q, k=1.7, reverse=reverse, tolerance=FAR).matrix)
    check_joined(doubles[0], edge_p, doubles[1], edge_q, lambda s: 0 * s + 1.7, reverse=reverse)
    for across in (0, 1):
        kept = [out_of(one, OPPOSITE[edge_q], S, 0, across) for one in (doubles[1], Corners(q.matrix))]
        # The ends of the opposite edge are common to both, and stay.
        assert_close(kept[0], kept[1], atol=1e-12)
    report = continuity_report(doubles)
    (edge,) = [one for one in report.edges if one.patches == (0, 1)]
    assert (edge.edges, edge.continuity) == ((edge_p, edge_q), "G1")
    assert (edge.intervals[1][0] > edge.intervals[1][1]) == reverse


@pytest.mark.slow
@pytest.mark.parametrize(("edge_p", "edge_q", "reverse"), [("u1", "u0", False), ("v1", "u1", True), ("u0", "v0", True)])
def test_matrices_of_class_3_join_with_continuous_curvature(edge_p, edge_q, reverse):
    p, q = (BicubicCoons(sheet(seed, 3, 0.1)) for seed in (1, 2))
    joined = Corners(join(p, edge_p, q, edge_q, k=1.3, reverse=reverse, tolerance=FAR).matrix)
    double = Corners(p.matrix)
    check_joined(double, edge_p, joined, edge_q, lambda s: 0 * s + 1.3, reverse=reverse, depth=2, atol=1e-10)
    assert continuity_report([double, joined]).continuity == "G2"
    only = Corners(join(p, edge_p, q, edge_q, reverse=reverse, continuity="G1", tolerance=FAR).matrix)
    assert continuity_report([double, only]).continuity == "G1"


def test_the_transfinite_form_of_matrices_is_the_matrix_again():
    blend = HermiteBlend.class2(1, sp.pi / 2)
    p, q = (BicubicCoons(sheet(seed), blend, blend) for seed in (1, 2))
    one, other = (
        join(p, "u1", q, "v1", k=0.6, reverse=True, transfinite=form, tolerance=FAR) for form in (False, True)
    )
    places = np.random.default_rng(0).random((2, 30))
    for order in ((0, 0), (1, 0), (1, 2)):
        assert_close(other.derivative(*places, order), one.derivative(*places, order), atol=1e-11)


@pytest.mark.slow
def test_different_blends_along_the_edge_are_refused_and_join_transfinitely():
    cubic, other = HermiteBlend.cubic(), HermiteBlend.class2(2, sp.pi / 2)
    p, q = BicubicCoons(sheet(1), cubic, cubic), BicubicCoons(sheet(2), other, other)
    with pytest.raises(RsymError, match="transfinite=True"):
        join(p, "u1", q, "v0")
    check_joined(
        p, "u1", join(p, "u1", q, "v0", transfinite=True, tolerance=FAR), "v0", lambda s: 0 * s + 1, reverse=False
    )
    # Only the blend along the edge matters.
    mixed = BicubicCoons(sheet(2), cubic, other)
    assert isinstance(join(p, "u1", mixed, "v0", tolerance=FAR), BicubicCoons)


@pytest.mark.slow
def test_a_blend_that_is_not_symmetric_joins_in_one_direction_only():
    step = t**2 * (3 - 2 * t) + t**2 * (1 - t) ** 2
    lopsided = HermiteBlend.from_smoothstep(step, sp.pi / 2)
    p, q = (BicubicCoons(sheet(seed), lopsided, lopsided) for seed in (1, 2))
    check_joined(p, "u1", join(p, "u1", q, "u0", tolerance=FAR), "u0", lambda s: 0 * s + 1, reverse=False)
    with pytest.raises(RsymError, match="run backwards"):
        join(p, "u1", q, "u0", reverse=True)


@pytest.mark.slow
@pytest.mark.parametrize(("continuity", "depth"), [("G1", 1), ("G2", 2)])
def test_ratio_and_slant_may_vary_along_the_edge(continuity, depth):
    p = Lambdified((u, v + u**2 / 3, sp.sin(u + v) / 2))
    q = Lambdified((1 + u + u * v / 5, v + u**2, sp.cos(2 * v) * u))
    for slant in (sp.sin(3 * t) / 2, lambda t: np.sin(3 * t) / 2):
        joined = join(p, "u1", q, "v0", k=1 + t / 2, h=slant, reverse=True, continuity=continuity, tolerance=FAR)
        check_joined(
            p,
            "u1",
            joined,
            "v0",
            lambda s: 1 + s / 2,
            lambda s: np.sin(3 * s) / 2,
            reverse=True,
            depth=depth,
            atol=1e-9,
        )
        (edge,) = [one for one in continuity_report([p, joined]).edges if one.patches == (0, 1)]
        assert edge.continuity == continuity
        for across in range(depth + 1):
            assert_close(out_of(joined, "v1", S, 0, across), out_of(q, "v1", S, 0, across), atol=1e-12)


def test_other_intervals_and_patches():
    p = sphere((0, 1), (0, 1))
    q = Lambdified((2 + u, v / 2, u * v / 9), ((0.0, 3.0), (1.0, 5.0)))
    joined = join(p, "v0", q, "u1", k=2.0, continuity="G2", tolerance=FAR)
    assert joined.domain == q.domain
    runs = (np.full(11, 3.0), 1 + 4 * S)
    assert_close(joined(*runs), p(S, 0 * S), atol=1e-12)
    assert_close(-joined.derivative(*runs, (1, 0)), -2 * p.derivative(S, 0 * S, (0, 1)), atol=1e-12)
    assert_close(joined.derivative(*runs, (2, 0)), 4 * p.derivative(S, 0 * S, (0, 2)), atol=1e-12)
    assert_close(joined.derivative(*runs, (0, 1)), p.derivative(S, 0 * S, (1, 0)) / 4, atol=1e-12)
    assert continuity_report([p, joined]).continuity == "G2"


def test_a_joined_patch_is_a_formula_if_its_parts_are():
    a = sp.Symbol("a")
    p = ParametricSurface((u, v, a * u * sp.sin(v)), ((0, 1), (0, 2)), letters={a: 2})
    q = ParametricSurface((1 + u, v, sp.sin(u)))
    joined = join(p, "u1", q, "u0", k=1 + t / 3, h=0.25, reverse=True, tolerance=FAR)
    places = np.random.default_rng(0).random((2, 20))
    for value, order in itertools.product((2.0, -1.0), ((0, 0), (1, 2))):
        formula = sp.lambdify((u, v, a), list(joined.expression().diff(u, order[0]).diff(v, order[1])))
        expected = np.stack(np.broadcast_arrays(places[0], *formula(*places, value))[1:], axis=-1)
        assert_close(joined.derivative(*places, order, letters={"a": value}), expected, atol=1e-11)


def test_letters_stay_letters_in_a_matrix():
    a = sp.Symbol("a")
    matrix = sp.MutableDenseNDimArray(sp.Array(sheet(1)))
    matrix[3, 2, 2] = a
    p, q = BicubicCoons(matrix, letters={a: 1}), BicubicCoons(sheet(2))
    joined = join(p, "u1", q, "v1", k=2.0, tolerance=FAR)
    for value in (1.0, 3.0):
        slope = -joined.derivative(S, 1 + 0 * S, (0, 1), letters={"a": value})
        assert_close(slope, 2 * p.derivative(1 + 0 * S, S, letters={"a": value}), atol=1e-12)


def test_the_nearest_edges_are_found_with_their_direction():
    p, q = BicubicCoons(sheet(1, bump=0.1)), sheet(2, bump=0.1)
    q[:2, :2, 0] += 1.1
    for turned, edge in ((q, "u0"), (np.swapaxes(q, 0, 1), "v0"), (q[[1, 0, 3, 2]], "u1")):
        joined = join(p, None, BicubicCoons(turned), None, tolerance=FAR)
        assert (joined.matrix == join(p, "u1", BicubicCoons(turned), edge, tolerance=FAR).matrix).all()
    backwards = q[:, [1, 0, 3, 2]] * np.array([1, 1, -1, -1])[:, None]
    joined = join(p, None, BicubicCoons(backwards), None, tolerance=FAR)
    assert (joined.matrix == join(p, "u1", BicubicCoons(backwards), "u0", reverse=True, tolerance=FAR).matrix).all()
    with pytest.raises(RsymError, match="no nearer than"):
        join(p, None, p, None)


@pytest.mark.parametrize(
    ("k", "told"),
    [
        (1 - sp.Rational(11, 10) * sp.exp(-((t - sp.Rational(1, 3)) ** 2) * 10**8), r"got -0\.1 at 0\.3333"),
        (1 - 2 * sp.exp(-((t - sp.sqrt(2) / 2) ** 2) * 10**12), r"got -1?\.?[\d.e-]+ at 0\.7071|not proved"),
        ((t - sp.Rational(1, 3)) ** 2, r"at 0\.3333"),
        (sp.Abs(t - sp.Rational(1, 7)), r"at 0\.1428"),
        (1 + sp.Rational(1, 10**6) / (sp.Rational(1, 3) - t), r"at 0\.3333"),
        (sp.sqrt(t - sp.Rational(1, 10**4)) + 1, "got nan at 0"),
    ],
    ids=["dip", "needle", "touch", "kink", "pole", "undefined"],
)
def test_a_factor_is_proved_positive_all_along_the_edge_or_refused(pair, k, told):
    p, q = pair
    with pytest.raises(RsymError, match=rf"k must be positive all along the edge, .*({told})"):
        join(p, "u1", q, "u0", k=k, tolerance=FAR)


@pytest.mark.parametrize(
    "k", [1 - sp.Rational(9, 10) * sp.exp(-((t - sp.Rational(1, 3)) ** 2) * 10**8), 1 + sp.sin(40 * t) * 0.999, 1e-9]
)
def test_a_factor_that_is_small_and_positive_is_taken(pair, k):
    p, q = pair
    join(p, "u1", q, "u0", k=k, tolerance=FAR, transfinite=True)


def test_of_a_factor_that_python_gives_it_is_said_that_nothing_is_proved(pair):
    p, q = pair
    with pytest.warns(rsym.RsymWarning, match=r"least value seen is 0\.5, at t = 0;"):
        join(p, "u1", q, "u0", k=lambda s: 0.5 + s, tolerance=FAR)
    with pytest.raises(RsymError, match=r"positive all along the edge, got -9\.99"):
        join(p, "u1", q, "u0", k=lambda s: (s - 1 / 3) ** 2 - 1e-7, tolerance=FAR)


def test_what_cannot_be_joined_is_refused(pair):
    p, q = pair
    for k in (0.0, -1.0, np.nan):
        with pytest.raises(RsymError, match=r"positive|number"):
            join(p, "u1", q, "u0", k=k)
    with pytest.raises(RsymError, match=r"positive all along the edge, got -0.5 at 1"):
        join(p, "u1", q, "u0", k=0.5 - t)
    with pytest.raises(RsymError, match="class 2 hold no derivatives of order 2"):
        join(p, "u1", q, "u0", continuity="G2")
    with pytest.raises(RsymError, match="an edge is one of"):
        join(p, "left", q, "u0")
    with pytest.raises(RsymError, match="one edge is given"):
        join(p, "u1", q, None)
    with pytest.raises(RsymError, match="the edge v1 is a point"):
        join(sphere((0, 1), (0, sp.pi / 2)), "v1", q, "u0")
    with pytest.raises(RsymError, match="needs a blend of class 3"):
        join(p, "u1", q, "u0", continuity="G2", transfinite=True, blend=HermiteBlend.cubic())


@pytest.mark.slow
def test_octants_continue_one_another_as_the_ratio_says():
    p, q = sphere_patches(2, pieces=(4, 2))[0::2][:2]
    assert_close(p(1, 0.3), q(0, 0.3), atol=1e-15)
    same = join(p, "u1", q, "u0")
    assert_close(same.matrix, q.matrix, atol=1e-14)
    noise = 3e-11 * np.random.default_rng(0).normal(size=q.matrix.shape)
    assert continuity_report([p, same.with_matrix(q.matrix + noise)]).continuity == "G2"
    stretched = join(p, "u1", q, "u0", k=1.7)
    report = continuity_report([p, stretched])
    assert [one.continuity for one in report.edges] == ["G1"]
    (pole,) = report.poles
    assert pole.continuity == "G1"
