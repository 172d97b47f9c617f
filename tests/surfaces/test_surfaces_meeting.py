"""What is meant to meet and does not: refused with the gap, or closed on purpose and told how far."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.hermite_doubles import Lambdified, sheet

from rsym.errors import RsymError
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.coons_patches import CoonsPatch
from rsym.surfaces.joints.joining import join
from rsym.surfaces.networks.composite import CompositeCoons
from rsym.surfaces.networks.gordon import GordonSurface
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v

S = np.linspace(0, 1, 201)
SQUARE = ParametricSurface((u, v, u * v))
BEYOND = ParametricSurface((1 + u, v, v * (1 - u)))


def refused(words, work):
    with pytest.raises(RsymError) as caught:
        work()
    assert all(word in str(caught.value) for word in words), str(caught.value)
    return caught.value


def far(shift, form):
    patches = SQUARE, ParametricSurface((1 + shift + u, v, v * (1 - u)))
    return patches if form == "formulas" else [BicubicCoons(corner_data(one)) for one in patches]


def corner_data(surface):
    found = surface.derivatives(
        np.array([[0.0], [1.0]]), np.array([0.0, 1.0]), [(i, j) for i in (0, 1) for j in (0, 1)]
    )
    return np.concatenate([np.concatenate(found[2 * i : 2 * i + 2], axis=1) for i in (0, 1)])


@pytest.mark.random
@pytest.mark.parametrize("form", ["formulas", "matrices"])
@pytest.mark.parametrize(("edges", "shift"), [(("u1", "u0"), 10), ((None, None), 0.5)])
def test_a_patch_far_away_is_not_joined(form, edges, shift):
    p, q = far(shift, form)
    error = refused(
        [f"the edge u1 of p and the edge u0 of q do not meet: they are {shift} apart at t = ", "tolerance=", "moves q"],
        lambda: join(p, edges[0], q, edges[1]),
    )
    assert error.code == "gap"
    assert error.where.startswith("(u, v) = (0, ")
    joined = join(p, edges[0], q, edges[1], tolerance=10)
    assert_close(joined(0, S), p(1, S), atol=1e-12)
    assert_close(joined.correction.gap, shift, atol=1e-12)
    assert shift - 1e-12 <= joined.correction.moved < shift + 0.1


def test_the_gap_is_found_where_it_is_greatest_and_the_remedy_is_enough():
    """A bump of height 0.028 at t = 0.3, a hundredth wide."""
    bump = sp.Rational(28, 1000) * sp.exp(-((100 * (v - sp.Rational(3, 10))) ** 2))
    q = Lambdified((1 + u, v, v * (1 - u) + bump))
    error = refused(["are 0.028 apart at t = 0.3", "of the size"], lambda: join(SQUARE, "u1", q, "u0"))
    share = float(error.remedy.split("tolerance=")[1].split(",")[0].split(" ")[0])
    join(SQUARE, "u1", q, "u0", tolerance=share)
    refused(["0.028 apart"], lambda: join(SQUARE, "u1", q, "u0", tolerance=0.9 * share))


@pytest.mark.random
@pytest.mark.parametrize("tiny", [1e-6, 1, 1e6])
def test_rounding_is_no_gap_and_the_size_of_the_patches_does_not_matter(tiny):
    p, q = (ParametricSurface(tuple(tiny * one for one in patch.expression())) for patch in (SQUARE, BEYOND))
    near, off = (ParametricSurface(tuple(one + tiny * shift for one in q.expression())) for shift in (1e-10, 1e-8))
    assert join(p, "u1", q, "u0").correction.gap <= 1e-15 * tiny
    assert_close(join(p, "u1", near, "u0").correction.gap / tiny, 3**0.5 * 1e-10, rtol=1e-4)
    refused(["apart"], lambda: join(p, "u1", off, "u0"))


def test_coordinates_far_from_the_origin_round_by_their_own_size():
    p, q = (ParametricSurface(tuple(one + 1e8 + sp.pi for one in patch.expression())) for patch in (SQUARE, BEYOND))
    assert join(p, "u1", q, "u0").correction.gap < 1e-6


def test_edges_that_meet_the_other_way_round_are_told():
    turned = ParametricSurface((1 + u, 1 - v, (1 - v) * (1 - u)))
    refused(["are 1.41 apart", "reverse=True"], lambda: join(SQUARE, "u1", turned, "u0"))
    assert join(SQUARE, "u1", turned, "u0", reverse=True).correction.gap < 1e-15
    refused(["are 1.41 apart", "reverse=False"], lambda: join(SQUARE, "u1", BEYOND, "u0", reverse=True))


def test_one_curve_at_two_paces_is_told_from_two_curves():
    other = ParametricSurface((1 + u, v**2, v**2 * (1 - u)))
    refused(
        ["0.354 apart at t = 0.5", "though along one curve at another pace"], lambda: join(SQUARE, "u1", other, "u0")
    )
    joined = join(SQUARE, "u1", other, "u0", tolerance=0.3)
    assert_close(joined(0, S), SQUARE(1, S), atol=1e-12)
    error = refused(["apart"], lambda: join(SQUARE, "u1", ParametricSurface((1 + u, v**2, v)), "u0"))
    assert "pace" not in str(error)


def test_what_is_not_finite_is_refused_by_name():
    refused(["is not finite everywhere"], lambda: join(SQUARE, "u1", ParametricSurface((1 + u, v, sp.log(u))), "u0"))


@pytest.mark.parametrize("wrong", [0, -1, np.nan, "1", None, np.inf, 1j])
def test_a_tolerance_is_positive(wrong):
    refused(["tolerance must be a positive number"], lambda: join(SQUARE, "u1", BEYOND, "u0", tolerance=wrong))
    edges = [(0, t, 0), (1, t, t), (t, 0, 0), (t, 1, t)]
    refused(["tolerance must be a positive number"], lambda: CoonsPatch(*edges, tolerance=wrong))


@pytest.mark.parametrize("form", ["matrices", "transfinite"])
def test_how_far_the_patch_was_moved_is_told(form):
    """Against the distances of the two patches on a fine grid."""
    p, q = (BicubicCoons(sheet(seed)) for seed in (1, 2))
    joined = join(p, "u1", q, "v0", k=1.7, tolerance=10, transfinite=form == "transfinite")
    distances = np.linalg.norm(joined.grid(S, S) - q.grid(S, S), axis=-1)
    gaps = np.linalg.norm(p(1, S) - q(S, 0), axis=-1)
    found = joined.correction
    assert distances.max() <= found.moved <= distances.max() * 1.001
    assert gaps.max() <= found.gap <= gaps.max() * 1.001
    moved = np.linalg.norm(joined(*found.parameters) - q(*found.parameters))
    assert_close(moved, found.moved, rtol=1e-9)
    assert f"{found.gap:.3g}" in str(found)
    assert f"{found.moved:.3g}" in str(found)
    assert q.correction is None


def measured(seed, noise):
    """Points on the four edges of a bent square, each edge measured anew."""
    generator = np.random.default_rng(seed)
    s, zero = np.linspace(0, 1, 9), np.zeros(9)
    edges = [(zero, s, s * s), (zero + 1, s, np.sin(s)), (s, zero, s * 0), (s, zero + 1, 1 - s + np.sin(1) * s)]
    return [np.stack(one, axis=-1) + generator.uniform(-noise, noise, (9, 3)) for one in edges]


PLACES = {"u0": (0 * S, S), "u1": (0 * S + 1, S), "v0": (S, 0 * S), "v1": (S, 0 * S + 1)}


@pytest.mark.parametrize("order", [1, 2])
def test_measured_curves_become_a_patch_and_the_correction_is_told(order):
    curves = measured(3, 1e-3)
    refused(["corner (0, 0)", "a gap of", "tolerance="], lambda: CoonsPatch(*curves, order=order))
    patch = CoonsPatch(*curves, order=order, tolerance=5e-3)
    from rsym.surfaces.coons.coons_patches import unit_curve

    moved = []
    for name, given in zip(PLACES, curves, strict=True):
        away = np.linalg.norm(patch(*PLACES[name]) - unit_curve(given, None, name)(S), axis=-1)
        moved.append(away.max())
        # Blended in: greatest at the corners, where it is half of the gap.
        assert_close(away.max(), max(away[0], away[-1]), rtol=1e-12)
    assert 1e-4 < max(moved) < 2e-3
    found = patch.correction
    assert_close(found.moved, max(moved), rtol=1e-9)
    assert_close(found.gap, 2 * max(moved), rtol=1e-9)
    ends = np.array([[c[0], c[-1]] for c in curves])
    pairs = [ends[0, 0] - ends[2, 0], ends[0, 1] - ends[3, 0], ends[1, 0] - ends[2, 1], ends[1, 1] - ends[3, 1]]
    assert_close(found.gap, np.linalg.norm(pairs, axis=-1).max(), rtol=1e-12)


def test_curves_that_meet_are_kept_to_the_last_bit():
    patch = CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, t), tolerance=1e-2)
    same = CoonsPatch((0, t, 0), (1, t, t), (t, 0, 0), (t, 1, t))
    assert (patch.grid(S[::20], S[::20]) == same.grid(S[::20], S[::20])).all()
    assert (patch.correction.gap, patch.correction.moved) == (0, 0)


def test_tangents_that_miss_a_little_are_blended_too():
    """A ribbon of u0 that misses the tangent of v0 by 1e-3: both get half, all else stays."""
    smooth = CoonsPatch.of_surface((u, v, sp.exp(u * v)), order=2)
    point = smooth.expression()
    rows = {f"u{i}": point.diff(u).subs(u, i).subs(v, t) for i in (0, 1)}
    rows |= {f"v{j}": point.diff(v).subs(v, j).subs(u, t) for j in (0, 1)}
    off = rows | {"u0": rows["u0"] + sp.Matrix([0, 0, sp.Rational(1, 1000)])}
    edges = [point.subs(one, k).subs(other, t) for one, other in ((u, v), (v, u)) for k in (0, 1)]
    refused(["the first derivative across the edge u0 at v = 0"], lambda: CoonsPatch(*edges, order=2, ribbons=off))
    patch = CoonsPatch(*edges, order=2, ribbons=off, tolerance=1e-2)
    assert_close(patch.derivative(0, 0, (1, 0)), [1, 0, 0.0005], atol=1e-12)
    found = patch.correction
    assert found.gap == 0
    assert_close(found.moved, 0.0005 * 4 / 27, rtol=1e-3)  # the greatest value of t - 2 t**2 + t**3
    assert_close(found.parameters[0], 1 / 3, atol=1e-2)


def test_twists_are_refused_beyond_the_same_tolerance():
    edges = [(0, t, 0), (1, t, 0), (t, 0, 0), (t, 1, 0)]
    ribbons = {"u0": (1, 0, sp.Rational(1, 1000) * t * (1 - t)), "u1": (1, 0, 0), "v0": (0, 1, 0), "v1": (0, 1, 0)}
    make = {"order": 2, "ribbons": ribbons, "corners": "refuse"}
    refused(["disagree by 0.001"], lambda: CoonsPatch(*edges, **make))
    assert CoonsPatch(*edges, **make, tolerance=1e-2)(0.5, 0.5).shape == (3,)


def test_letters_that_part_the_edges_are_refused_where_they_are_given():
    a = sp.Symbol("a")
    patch = CoonsPatch((0, t, 0), (1, t, a * t), (t, 0, 0), (t, 1, t), letters={a: 1})
    assert_close(patch(1, 0.5, letters={"a": 1 + 1e-12}), [1, 0.5, 0.5], atol=1e-9)
    error = refused(["(1, 1, 2) and the edge v1 at u = 1 is (1, 1, 1)"], lambda: patch(0.5, 0.5, letters={"a": 2}))
    assert error.where == "corner (1, 1)"


def measured_network(noise):
    """Curves of a bent sheet through points that are measured for each family anew."""
    generator, s = np.random.default_rng(5), np.linspace(0, 1, 9)

    def rough(x, y):
        points = np.stack(np.broadcast_arrays(x, y, np.sin(2 * x) * y), axis=-1)
        return points + generator.uniform(-noise, noise, points.shape)

    return [rough(s, y) for y in (0, 0.3, 0.7, 1)], [rough(x, s) for x in (0, 0.4, 0.6, 1)]


@pytest.mark.parametrize("kind", [GordonSurface, CompositeCoons])
def test_a_network_of_measured_curves_tells_how_far_it_passes_from_them(kind):
    along, over = measured_network(1e-3)
    error = refused(["do not meet: their smallest distance is 0.00", "tolerance="], lambda: kind(along, over))
    share = float(error.remedy.split("tolerance=")[1].split(" ")[0])
    assert 1e-4 < share < 5e-3
    surface = kind(along, over, tolerance=1e-2)
    net = surface.network
    (a, b), (c, d) = surface.domain
    s = np.linspace(a, b, 301)
    away = [
        np.linalg.norm(surface(s, at) - one(s), axis=-1)
        for at, one in zip(net.v_knots, net.u_curves.curves, strict=True)
    ]
    assert_close(surface.correction.gap, net.gaps().max(), rtol=1e-12)
    assert np.max(away) <= surface.correction.moved <= 1.001 * np.max(away)
    u, v = surface.correction.parameters
    assert v in net.v_knots
    assert a <= u <= b
    s = np.linspace(c, d, 31)
    for at, one in zip(net.u_knots, net.v_curves.curves, strict=True):
        assert_close(surface(at, s), one(s), atol=1e-13)
    exact = kind([(t, y, t * y) for y in (0, 1, 2)], [(x, 2 * t, 2 * t * x) for x in (0, 1)])
    assert exact.correction.moved < 1e-14


@pytest.mark.parametrize("wrong", [0, "1", None, np.nan])
def test_the_tolerance_of_a_network_is_positive(wrong):
    along, over = [(t, y, 0) for y in (0, 1)], [(x, t, 0) for x in (0, 1)]
    refused(["tolerance must be a positive number"], lambda: GordonSurface(along, over, tolerance=wrong))
