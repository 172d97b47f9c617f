"""B-spline surfaces: against exact fractions, fifty digits, geomdl and SciPy."""

import itertools

import mpmath
import numpy as np
import pytest
import sympy as sp
from geomdl import BSpline as rival
from geomdl import fitting
from oracles.closeness import assert_close
from scipy.interpolate import NdBSpline, make_interp_spline, make_lsq_spline

from rsym.errors import RsymError
from rsym.surfaces import symbols
from rsym.surfaces.bsplines.parameter_correction import Along, Plane, moved
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.symbols import t

RANDOM = np.random.default_rng(7)


def wave(rows, columns, warp=0.1):
    """Points of a curved sheet whose rows and columns are neither straight nor of equal length."""
    x, y = np.meshgrid(np.linspace(0, 3, rows), np.linspace(0, 2, columns), indexing="ij")
    return np.stack([x + warp * np.sin(5 * y), y + warp * x**2, np.sin(x) * np.cos(y)], axis=-1)


def sphere(rows, columns, dent=0.0):
    """Points that go round in u; the first and the last column are poles."""
    turn, height = 2 * np.pi * np.arange(rows)[:, None] / rows, np.linspace(0, np.pi, columns)
    radius = np.sin(height) * (1 + dent * np.cos(turn + 3 * height))
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), np.cos(height) + 0 * turn], axis=-1)


def basis(order, knots, number, place):
    """One basis function by its definition, in whatever numbers the knots are."""
    if order == 1:
        at_end = place == knots[-1] and knots[number] < knots[number + 1] == knots[-1]
        return int(bool(knots[number] <= place < knots[number + 1] or at_end))
    total = 0
    for first, last, inner in ((number, number + order - 1, number), (number + order, number + 1, number + 1)):
        if knots[first] != knots[last]:
            total += (place - knots[first]) * basis(order - 1, knots, inner, place) / (knots[last] - knots[first])
    return total


def uniform(order, count):
    return [0] * order + list(range(1, count - order + 1)) + [count - order + 1] * order


def refused(code, words, work):
    with pytest.raises(RsymError) as caught:
        work()
    assert caught.value.code == code, str(caught.value)
    assert words in str(caught.value), str(caught.value)


@pytest.mark.parametrize("order", [(4, 4), (2, 6), (5, 3)])
@pytest.mark.parametrize("rule", ["chord-length", "centripetal"])
def test_data_are_met_and_nets_are_those_of_geomdl(order, rule):
    points = wave(9, 7)
    surface = BSplineSurface.interpolate(points, order, parameters=rule)
    assert_close(surface.grid(*surface.parameters), points, atol=1e-12)
    theirs = fitting.interpolate_surface(
        points.reshape(-1, 3).tolist(), 9, 7, order[0] - 1, order[1] - 1, centripetal=rule == "centripetal"
    )
    assert_close(surface.net, np.reshape(theirs.ctrlpts, (9, 7, 3)), atol=1e-12)
    for mine, other in zip(surface.knots, (theirs.knotvector_u, theirs.knotvector_v), strict=True):
        assert_close(mine / mine[-1], other, atol=1e-14)


def test_the_equation_of_the_source_in_exact_fractions():
    """6-83 with uniform knots; all chords are multiples of 5 and of 1."""
    steps, heights = [0, 1, 3, 4, 6], [0, 1, 2, 4]
    points = [[(3 * a, 4 * a, b + a * a % 7 * b) for b in heights] for a in steps]
    flat = [[(3 * a, 4 * a, b) for b in heights] for a in steps]
    order, (r, s) = (4, 3), (5, 4)
    u = [sp.Rational(a * (r - order[0] + 1), steps[-1]) for a in steps]
    w = [sp.Rational(b * (s - order[1] + 1), heights[-1]) for b in heights]
    n = sp.Matrix(r, r, lambda p, i: basis(order[0], uniform(order[0], r), int(i), u[int(p)]))
    m = sp.Matrix(s, s, lambda p, i: basis(order[1], uniform(order[1], s), int(i), w[int(p)]))
    made = BSplineSurface.interpolate(flat, order, knots="uniform")
    for mine, exact in zip(made.parameters, (u, w), strict=True):
        assert_close(mine, [float(one / exact[-1]) for one in exact], atol=1e-15)
    knots = uniform(order[0], r), uniform(order[1], s)
    as_printed = BSplineSurface.interpolate(flat, order, knots=knots)
    assert as_printed.domain == ((0, float(u[-1])), (0, float(w[-1])))
    for mine, exact in zip(as_printed.parameters, (u, w), strict=True):
        assert_close(mine, [float(one) for one in exact], atol=1e-15)
    given = BSplineSurface.interpolate(
        points, order, knots=knots, parameters=(list(map(float, u)), list(map(float, w)))
    )
    for axis in range(3):
        data = sp.Matrix(r, s, lambda p, q, axis=axis: points[p][q][axis])
        net = n.inv() * data * m.inv().T
        assert_close(given.net[:, :, axis], np.array(net.tolist(), float), atol=1e-12)


@pytest.mark.parametrize("vertices", [None, (5, 4)])
def test_parameters_of_each_point_as_the_source_prints_them(vertices):
    """6-83 and 6-84 with u_pq and w_pq, to fifty digits."""
    points, order = wave(6, 5), (4, 3)
    counts = vertices or (6, 5)
    with mpmath.workdps(50):
        data = [[mpmath.matrix(list(map(float, points[p, q]))) for q in range(5)] for p in range(6)]
        shares = np.empty((2, 6, 5), object)
        for q in range(5):
            shares[0, :, q] = chord_shares([data[p][q] for p in range(6)], counts[0] - order[0] + 1)
        for p in range(6):
            shares[1, p, :] = chord_shares(data[p], counts[1] - order[1] + 1)
        knots = [uniform(k, count) for k, count in zip(order, counts, strict=True)]
        c = mpmath.matrix(30, counts[0] * counts[1])
        for (p, q), (i, j) in itertools.product(np.ndindex(6, 5), np.ndindex(*counts)):
            n, m = basis(order[0], knots[0], i, shares[0, p, q]), basis(order[1], knots[1], j, shares[1, p, q])
            c[p * 5 + q, i * counts[1] + j] = n * m
        columns = [mpmath.lu_solve(c.T * c, c.T * mpmath.matrix(one.tolist())) for one in points.reshape(-1, 3).T]
    if vertices:
        surface = BSplineSurface.least_squares(points, vertices, order, knots=knots, per_point=True)
    else:
        surface = BSplineSurface.interpolate(points, order, knots=knots, per_point=True)
    for mine, exact in zip(surface.parameters, shares, strict=True):
        assert_close(mine, exact.astype(float), atol=1e-14)
    assert_close(surface.net.reshape(-1, 3), np.array([list(one) for one in columns], float).T, atol=1e-11)


def chord_shares(line, length):
    chords = [mpmath.norm(b - a) for a, b in itertools.pairwise(line)]
    return [mpmath.fsum(chords[:k]) / mpmath.fsum(chords) * length for k in range(len(line))]


def test_crowded_data_are_met_by_averaged_knots_and_refused_by_uniform_ones():
    x, y = np.array([0, 1, 2, 3, 4, 5, 100, 200, 300])[:, None] / 100, np.linspace(0, 2, 6)
    points = np.stack([x + 0 * y, y + 0 * x, np.sin(x + y)], axis=-1)
    surface = BSplineSurface.interpolate(points)
    assert_close(surface.grid(*surface.parameters), points, atol=1e-12)
    refused(
        "schoenberg-whitney",
        "the vertex 6 along u: no parameter left for it between its knots 0.5 and 1",
        lambda: BSplineSurface.interpolate(points, knots="uniform"),
    )
    refused("schoenberg-whitney", "vertex 6", lambda: BSplineSurface.least_squares(points, (8, 5), knots="uniform"))
    refused("singular", "vertex (6, ", lambda: BSplineSurface.interpolate(points, knots="uniform", per_point=True))


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("order", [(4, 4), (7, 3)])
def test_averaged_knots_follow_data_however_crowded(order, closed):
    turn, y = 5 * np.linspace(0, 1, 12)[:, None] ** 8, np.linspace(0, 2, 6)
    points = np.stack([np.cos(turn) + 0 * y, y + 0 * turn, np.sin(turn) + y], axis=-1)
    surface = BSplineSurface.interpolate(points, order, closed=(closed, False))
    assert_close(surface.grid(*surface.parameters), points, atol=1e-12)


@pytest.mark.slow
def test_a_system_that_rounding_spoils_is_refused():
    refused("ill-conditioned", "misses data", lambda: BSplineSurface.interpolate(wave(42, 42), per_point=True))
    refused("ill-conditioned", "reach to", lambda: BSplineSurface.interpolate(wave(46, 46), per_point=True))


@pytest.mark.random
@pytest.mark.parametrize("per_point", [False, True])
@pytest.mark.parametrize("knots", ["averaged", "uniform"])
@pytest.mark.parametrize("rows", [8, 9])
@pytest.mark.parametrize("order", range(2, 7))
def test_closed_spheres_with_poles(order, rows, knots, per_point):
    """Data met, poles too; the seam is as smooth as the rest, for even degrees and even numbers of points as well."""
    points = sphere(rows, 7, dent=0.3)
    surface = BSplineSurface.interpolate(points, (order, 4), closed=(True, False), knots=knots, per_point=per_point)
    u, v = np.broadcast_arrays(*surface.parameters) if per_point else np.meshgrid(*surface.parameters, indexing="ij")
    assert_close(surface(u, v), points, atol=1e-12)
    (low, high), heights = surface.domain[0], np.linspace(0, surface.domain[1][1], 5)
    assert surface.closed == (True, False)
    for n in range(order - 1):
        ends = [surface.derivative(end, heights, (n, 0)) for end in (low, high)]
        assert_close(ends[0], ends[1], atol=1e-11 * rows**n)
    assert_close(surface(low - 0.3, heights), surface(high - 0.3, heights), atol=1e-12)


def test_closed_curves_across_are_those_of_scipy():
    points = sphere(7, 5)[:, 1:4] * [2, 1, 1]
    surface = BSplineSurface.interpolate(points, (4, 2), closed=(True, False))
    u, v = surface.parameters
    turn = np.append(u, surface.domain[0][1])
    theirs = make_interp_spline(turn, np.concatenate([points, points[:1]]), k=3, bc_type="periodic")
    places = np.linspace(*surface.domain[0], 50)
    assert_close(surface.grid(places, v), theirs(places), atol=1e-12)


def test_even_degree_even_number_and_data_at_knots_is_refused():
    points = wave(8, 7)
    at_knots = {"closed": (True, False), "parameters": (range(9), range(7))}
    refused(
        "singular",
        "move the parameters of the closed direction by half a span",
        lambda: BSplineSurface.interpolate(points, (3, 4), knots="uniform", **at_knots),
    )
    for knots in ("averaged", (np.arange(9) + 2.5, "averaged")):
        surface = BSplineSurface.interpolate(points, (3, 4), knots=knots, **at_knots)
        assert_close(surface.grid(range(8), range(7)), points, atol=1e-12)


def test_poles_do_not_count_when_parameters_are_averaged():
    """A pole is one where coordinates of another size leave nothing but rounding of it, too."""
    points = sphere(8, 9) + np.array([1, 2, 3])
    u, _ = BSplineSurface.interpolate(points, (2, 2), closed=(True, False)).parameters
    assert_close(u, np.arange(8) / 8, atol=1e-14)
    refused("parameters", "along v coincide", lambda: BSplineSurface.interpolate(points[:, 3:4].repeat(5, axis=1)))


@pytest.mark.parametrize("scale", [1e-100, 1e-6, 1e6, 1e100])
def test_the_scale_of_data_does_not_matter(scale):
    points = wave(7, 6)
    assert_close(
        BSplineSurface.interpolate(points * scale).net / scale, BSplineSurface.interpolate(points).net, atol=1e-12
    )


def test_cubic_interpolation_is_of_the_fourth_order():
    def error(count):
        places = np.linspace(0, 2, count)
        x, y = np.meshgrid(places, places, indexing="ij")
        points = np.stack([x, y, np.sin(2 * x) * np.exp(y)], axis=-1)
        surface = BSplineSurface.interpolate(points, parameters=(places, places))
        fine = np.linspace(0, 2, 83)
        return np.abs(surface.grid(fine, fine)[..., 2] - np.sin(2 * fine)[:, None] * np.exp(fine)).max()

    assert 3.7 < np.log2(error(17) / error(33)) < 4.6


@pytest.mark.parametrize("knots", ["averaged", "uniform"])
def test_least_squares_are_no_worse_than_those_of_scipy(knots):
    points = wave(31, 23)
    surface = BSplineSurface.least_squares(points, (9, 8), knots=knots)
    u, v = surface.parameters
    first = make_lsq_spline(u, points, surface.knots[0], k=3).c
    theirs = make_lsq_spline(v, first.swapaxes(0, 1), surface.knots[1], k=3).c.swapaxes(0, 1)
    assert_close(surface.net, theirs, atol=1e-10)

    def rms(net):
        values = NdBSpline(surface.knots, net, 3)(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1))
        return np.sqrt(((values - points) ** 2).sum(axis=-1).mean())

    assert rms(surface.net) <= rms(theirs) * (1 + 1e-14)
    assert_close(surface.residual.rms, rms(surface.net), rtol=1e-12)


@pytest.mark.parametrize("order", [3, 4])
def test_closed_least_squares_are_those_of_the_cyclic_system(order):
    """Basis functions of all turns, added."""
    points = sphere(20, 9, dent=0.3)
    surface = BSplineSurface.least_squares(points, (8, 9), (order, 4), closed=(True, False))
    knots, (u, v) = surface.knots[0], surface.parameters
    all_turns = np.array([[basis(order, knots, i, at) for i in range(8 + order - 1)] for at in u])
    cyclic = all_turns[:, :8]
    cyclic[:, : order - 1] += all_turns[:, 8:]
    rows = np.linalg.lstsq(cyclic, points.reshape(20, -1), rcond=None)[0].reshape(8, 9, 3)
    values = np.einsum("ai,ijx->ajx", cyclic, rows)
    assert_close(surface.grid(u, v), values, atol=1e-12)


def test_least_squares_keep_digits_that_normal_equations_lose():
    """A polynomial in knots so uneven that its squared system has the condition 1e15."""
    u = np.concatenate([np.geomspace(1e-7, 1, 40), [0.0]])
    u.sort()
    v = np.linspace(0, 1, 5)
    knots = np.concatenate([[0] * 4, np.geomspace(1e-6, 0.3, 12), [1] * 4])
    truth = RANDOM.normal(size=(16, 4, 3))
    points = BSplineSurface(truth, knots=(knots, None)).grid(u, v)
    surface = BSplineSurface.least_squares(points, (16, 4), parameters=(u, v), knots=(knots, [0] * 4 + [1] * 4))
    assert_close(surface.net, truth, atol=1e-9)


def test_the_report_names_the_worst_datum():
    points = wave(12, 10)
    points[4, 7] += [0, 0, 0.5]
    residual = BSplineSurface.least_squares(points, (6, 6)).residual
    assert residual.worst == (4, 7)
    assert 0.2 < residual.maximum < 0.5
    assert "worst at datum (4, 7)" in str(residual)


def test_a_correction_finds_the_place_of_a_point_to_the_second_order():
    knots = uniform(4, 6)
    skew = BSplineSurface(wave(6, 6) @ [[1, 0, 0], [0.8, 1, 0], [0, 0, 1]], knots=(knots, knots))
    truth = np.stack(np.meshgrid(np.linspace(0, 3, 9), np.linspace(0, 3, 8), indexing="ij"))
    inner = truth[:, 1:-1, 1:-1]
    points = skew(*inner)

    def error(step):
        u, v = moved(skew.spaces, skew.net, points, (inner[0] + step, inner[1] - step))
        return max(np.abs(u - inner[0]).max(), np.abs(v - inner[1]).max())

    assert error(1e-3) < 2e-5
    assert 80 < error(1e-3) / error(1e-4) < 120


def test_corrected_parameters_fit_better():
    """Points of a surface with few vertices, at places that chord lengths do not guess."""
    truth = BSplineSurface(wave(5, 5) + RANDOM.normal(scale=0.2, size=(5, 5, 3)))
    shares = np.linspace(0, 1, 14) ** 1.3
    points = truth.grid(shares, shares)
    surface = BSplineSurface.least_squares(points, (5, 5), knots="uniform", corrections=25)
    rms = [one.rms for one in surface.fit.history]
    assert len(rms) > 10
    assert all(b < a for a, b in itertools.pairwise(rms))
    assert rms[1] < 0.75 * rms[0]
    assert rms[-1] < 0.5 * rms[0]
    u, v = surface.parameters
    assert u.shape == v.shape == (14, 14)
    assert (u[0] == 0).all()
    assert (v[:, -1] == 1).all()
    gaps = np.linalg.norm(surface(u, v) - points, axis=-1)
    assert_close(surface.residual.maximum, gaps.max(), rtol=1e-12)


def test_vertices_kept_on_planes_are_where_the_constrained_fit_wants_them():
    points, normals = wave(15, 13), np.array([[1, 0.2, 0.3], [0.1, 1, 0.9]])
    loci = [Plane((1.5, 0, 0), normal) for normal in normals]
    surface = BSplineSurface.least_squares(points, (7, 6), kept=[(np.s_[3, :], loci[0]), (np.s_[4, 1:4], loci[1])])
    numbers = [*range(18, 24), *range(25, 28)]
    each = normals[[0] * 6 + [1] * 3]
    heights = np.einsum("ij,ij->i", surface.net.reshape(-1, 3)[numbers] - [1.5, 0, 0], each)
    assert_close(heights, np.zeros(9), atol=1e-14)
    assert surface.fit.converged
    assert surface.fit.history[1].rms > surface.fit.history[0].rms
    # Lagrange's equations of the same problem.
    n, m = (space.matrix(place) for space, place in zip(surface.spaces, surface.parameters, strict=True))
    c = np.kron(np.kron(n, m), np.eye(3))
    rows = np.zeros((9, 126))
    for row, (number, normal) in enumerate(zip(numbers, each, strict=True)):
        rows[row, 3 * number : 3 * number + 3] = normal
    system = np.block([[c.T @ c, rows.T], [rows, np.zeros((9, 9))]])
    right = np.concatenate([c.T @ points.ravel(), each @ [1.5, 0, 0]])
    assert_close(surface.net.ravel(), np.linalg.solve(system, right)[:126], atol=1e-10)


def test_all_vertices_may_be_kept():
    points = wave(9, 8) * [1, 1, 0.1]
    surface = BSplineSurface.least_squares(points, (6, 5), kept=[(np.s_[:, :], Plane((0, 0, 0), (0, 0, 1)))])
    flat = BSplineSurface.least_squares(points, (6, 5)).net * [1, 1, 0]
    assert_close(surface.net, flat, atol=1e-12)


def test_the_foot_on_a_curve_is_its_nearest_point():
    curve = as_curve((2 * sp.cos(t), sp.sin(t), t / 4), domain=(0, 6))
    places = RANDOM.uniform(-3, 3, (30, 3))
    feet, tangents, ends = Along(curve).frames(places)
    fine = curve(np.linspace(0, 6, 20001))
    distances = np.linalg.norm(fine - places[:, None], axis=-1).min(axis=1)
    assert_close(np.linalg.norm(feet - places, axis=-1), distances, atol=1e-6)
    slopes = np.einsum("ni,ni->n", tangents[:, :, 0], places - feet)
    assert_close(slopes[ends == 0], np.zeros((ends == 0).sum()), atol=1e-12)
    assert (slopes * ends >= 0).all()
    assert (ends != 0).any()


def test_vertices_kept_along_a_curve_cannot_slide_to_a_better_place():
    points = wave(15, 13)
    curve = (sp.Rational(1, 10) * sp.sin(5 * t), t, sp.Rational(1, 20) * t * (2 - t))
    locus = as_curve(curve, domain=(-1, 3))
    surface = BSplineSurface.least_squares(points, (7, 6), kept=[(np.s_[0, :], locus)])
    assert surface.fit.converged
    x, y, z = surface.net[0].T
    assert_close(x, np.sin(5 * y) / 10, atol=1e-13)
    assert_close(z, y * (2 - y) / 20, atol=1e-13)
    c = np.kron(*(space.matrix(place) for space, place in zip(surface.spaces, surface.parameters, strict=True)))

    def missed(places):
        rest = points.reshape(-1, 3) - c[:, :6] @ locus(places)
        return np.linalg.norm(rest - c[:, 6:] @ np.linalg.lstsq(c[:, 6:], rest, rcond=None)[0])

    best = missed(y)
    assert_close(surface.residual.rms * np.sqrt(15 * 13), best, rtol=1e-10)
    for j, way in itertools.product(range(6), (-1e-3, 1e-3)):
        assert missed(y + way * (np.arange(6) == j)) > best


def test_a_curve_holds_its_vertices_at_its_ends_and_corrections_go_between():
    points = wave(15, 13)
    short = [[0, 0.5, 0], [0, 1, 0.1], [0, 1.5, 0]]
    surface = BSplineSurface.least_squares(points, (7, 6), kept=[((0, slice(None)), short)], corrections=3)
    assert surface.fit.converged
    assert_close(surface.net[0, [0, -1]], np.array(short)[[0, -1]], atol=1e-14)
    rms = [one.rms for one in surface.fit.history]
    assert rms[0] < rms[1] > rms[2]


def test_derivatives_of_any_order_are_those_of_the_definition():
    surface = BSplineSurface.interpolate(wave(6, 4), (4, 3), parameters=([0, 1, 2, 3.5, 4, 6], range(4)))
    u, v = [0.3, 2.0, 4.9], [0.2, 2.5]
    with mpmath.workdps(50):
        for i, j in itertools.product(range(5), range(4)):
            n, m = basis_derivatives(surface, 0, u, i), basis_derivatives(surface, 1, v, j)
            expected = np.einsum("ai,bj,ijx->abx", n, m, surface.net)
            assert_close(surface.derivative(np.array(u)[:, None], v, (i, j)), expected, atol=1e-11)


def basis_derivatives(surface, axis, places, order):
    knots = [mpmath.mpf(float(knot)) for knot in surface.knots[axis]]
    return [
        [
            float(mpmath.diff(lambda at, i=i: basis(surface.order[axis], knots, i, at), place, order))
            for i in range(surface.net.shape[axis])
        ]
        for place in places
    ]


def test_formulas_are_the_surface():
    surface = BSplineSurface.interpolate(wave(6, 4), (4, 3), closed=(True, False))
    u, v = np.linspace(0, 1, 7), np.linspace(0, 1, 5)
    formula = sp.lambdify((symbols.u, symbols.v), list(surface.expression()))
    assert_close(surface.grid(u, v), [[formula(a, b) for b in v] for a in u], atol=1e-13)
    assert r"\sum_{j=1}^{4} B_{i,j}\, N_{i,4}(u)\, M_{j,3}(v)$" in surface._repr_latex_()
    refused("no-formula", "fewer vertices", BSplineSurface.interpolate(wave(30, 30)).expression)


def test_values_are_those_of_geomdl_and_of_scipy():
    net = wave(7, 6)
    surface = BSplineSurface(net, (4, 3))
    theirs = rival.Surface()
    theirs.degree_u, theirs.degree_v = 3, 2
    theirs.set_ctrlpts(net.reshape(-1, 3).tolist(), 7, 6)
    theirs.knotvector_u, theirs.knotvector_v = (knots.tolist() for knots in surface.knots)
    u, v = RANDOM.uniform(0, 1, 20), RANDOM.uniform(0, 1, 20)
    expected = [theirs.evaluate_single((a, b)) for a, b in zip(u, v, strict=True)]
    assert_close(surface(u, v), expected, atol=1e-14)
    assert_close(
        surface.grid(u, v),
        NdBSpline(surface.knots, net, (3, 2))(np.stack(np.meshgrid(u, v, indexing="ij"), -1)),
        atol=1e-14,
    )


def test_every_way_to_span_a_grid_gives_its_points():
    surface = BSplineSurface(wave(7, 6))
    u, v = np.linspace(0, 1, 5), np.linspace(0, 1, 3)
    scattered = surface(*np.broadcast_arrays(u[:, None], v))
    assert_close(surface.grid(u, v), scattered, atol=1e-14)
    assert_close(surface(u, v[:, None]), scattered.swapaxes(0, 1), atol=1e-14)
    assert_close(surface(u[:, None, None], v[:2, None] + 0 * u[:1]), scattered[:, :2, None], atol=1e-14)
    assert_close(surface(1.0, v), surface(np.ones(3), v), atol=1e-14)
    assert surface(1.0, 1.0).shape == (3,)
    assert np.isnan(surface(np.nan, v)).all()
    part = surface.grid(u[2:4], v)
    assert (part == surface.grid(u, v)[2:4]).all()


def test_repeated_knots_and_closed_knots_are_taken_as_given():
    knots = ([0, 0, 0, 1, 1, 2, 2, 2], [0, 1, 3, 4, 5])
    surface = BSplineSurface(wave(5, 4), (3, 3), knots, closed=(False, True))
    assert surface.domain == ((0, 2), (0, 5))
    again = BSplineSurface(surface.net, surface.order, surface.knots, surface.closed)
    assert (again.grid([0.5, 1.5], [2.5]) == surface.grid([0.5, 1.5], [2.5])).all()
    assert_close(surface.derivative(1.0, 5.0, (0, 1)), surface.derivative(1.0, 0.0, (0, 1)), atol=1e-13)


POINTS, SIDE = wave(9, 7), Plane((0, 0, 0), (1, 0, 0))
KNOTS = np.arange(16.0) ** 2
interpolate, approximate = BSplineSurface.interpolate, BSplineSurface.least_squares
TWICE = np.insert(POINTS, 3, POINTS[3], axis=0)
HOLE = np.where(np.arange(189).reshape(9, 7, 3) == 50, np.nan, POINTS)


@pytest.mark.parametrize(
    ("code", "words", "work"),
    [
        ("points", "(r, s, 3)", lambda: interpolate(POINTS[:, :, :2])),
        ("points", "(r, s, 3)", lambda: BSplineSurface(POINTS[0])),
        ("parameters", "need parameters for each", lambda: interpolate(POINTS[:7, 0], vertices=(1, 7))),
        ("points", "array of numbers", lambda: interpolate([[1, 2], [3]])),
        ("points", "entry (2, 2, 2) is nan", lambda: interpolate(HOLE)),
        ("points", "entry (2, 2, 2) is nan", lambda: BSplineSurface(HOLE)),
        ("parameters", "rows 3 and 4", lambda: interpolate(TWICE)),
        ("parameters", "(9,) or (9, 7), got (8,)", lambda: interpolate(POINTS, parameters=(range(8), range(7)))),
        ("parameters", "must not decrease", lambda: interpolate(POINTS, parameters=(range(9)[::-1], range(7)))),
        ("parameters", "'centripetal'", lambda: interpolate(POINTS, parameters="arc")),
        ("knots", "'uniform'", lambda: interpolate(POINTS, knots="arc")),
        ("knots", "need 13 knots, got 3", lambda: interpolate(POINTS, knots=([0, 1, 2], None))),
        ("knots", "stands 4 times along u", lambda: BSplineSurface(POINTS, knots=([0] * 4 + [1] * 4 + [2] * 5, None))),
        ("knots", "must not decrease", lambda: BSplineSurface(POINTS, knots=(range(13)[::-1], None))),
        (
            "knots",
            "repeat after one",
            lambda: BSplineSurface(POINTS, knots=(KNOTS, None), closed=(True, False)),
        ),
        ("order", "needs 8 or more vertices, got 7", lambda: interpolate(POINTS, (4, 8))),
        ("order", "integer >= 2", lambda: interpolate(POINTS, (4, 1))),
        ("pair", "order must be a pair", lambda: interpolate(POINTS, 4)),
        ("vertices", "at most 9 vertices, got 10", lambda: approximate(POINTS, (10, 7))),
        ("closed", "last row", lambda: interpolate(TWICE[[*range(9), 0]], closed=(True, False))),
        ("corrections", "number >= 0", lambda: approximate(POINTS, (5, 5), corrections=-1)),
        ("kept", "no vertices", lambda: approximate(POINTS, (5, 5), kept=[((7, 0), SIDE)])),
        ("kept", "no vertices", lambda: approximate(POINTS, (5, 5), kept=[(np.s_[3:3], SIDE)])),
        ("pair", "closed must be a pair", lambda: interpolate(POINTS, closed=True)),
        ("pair", "vertices must be a pair", lambda: approximate(POINTS, 5)),
        ("kept", "two loci", lambda: approximate(POINTS, (5, 5), kept=[((1, 0), SIDE)] * 2)),
        ("plane", "not zero", lambda: Plane((0, 0, 0), (0, 0, 0))),
        ("no-data", "made of vertices", lambda: BSplineSurface(POINTS).parameters),
        ("domain", "u must lie in [0, 1]", lambda: BSplineSurface(POINTS)(7, 0)),
    ],
)
def test_what_is_refused(code, words, work):
    refused(code, words, work)


def test_degrees_are_orders_less_one():
    for make in (BSplineSurface, interpolate, lambda points, **how: approximate(points, (7, 6), **how)):
        one, other = make(POINTS, order=(5, 3)), make(POINTS, degree=(4, 2))
        assert (one.net == other.net).all()
        assert one.order == other.order == (5, 3)
        assert one.degree == other.degree == (4, 2)
        assert make(POINTS).degree == (3, 3)
        refused("order", "give one of them", lambda make=make: make(POINTS, order=(4, 4), degree=(3, 3)))
        refused("degree", "a degree is an integer >= 1", lambda make=make: make(POINTS, degree=(3, 0)))
        refused("pair", "degree must be a pair", lambda make=make: make(POINTS, degree=3))


@pytest.mark.parametrize("closed", [(False, False), (True, False)])
def test_parameters_run_from_0_to_1_unless_knots_or_parameters_are_given(closed):
    points = sphere(9, 7, dent=0.3) if closed[0] else POINTS
    for knots in ("averaged", "uniform"):
        assert interpolate(points, knots=knots, closed=closed).domain == ((0, 1), (0, 1))
        assert approximate(points, (7, 6), knots=knots, closed=closed).domain == ((0, 1), (0, 1))
    assert BSplineSurface(points, closed=closed).domain == ((0, 1), (0, 1))
    given = [0] * 4 + [1, 3] + [7] * 4
    assert interpolate(points[:, :6], knots=("averaged", given), closed=closed).domain == ((0, 1), (0, 7))
    rows = range(10) if closed[0] else range(9)
    assert interpolate(points, parameters=(rows, range(7)), closed=closed).domain == ((0, rows[-1]), (0, 6))


def test_derivatives_above_the_degree_are_zero():
    """SciPy 1.13 is not asked for them: it writes beyond its arrays."""
    surface = BSplineSurface(np.random.default_rng(7).normal(size=(5, 6, 3)), order=(3, 4))
    for order in ((3, 0), (0, 4), (5, 1), (9, 9)):
        assert np.array_equal(surface.derivative([0.1, 0.2], [0.3, 0.4], order), np.zeros((2, 3)))
        assert np.array_equal(surface.derivative([[0.1], [0.2]], [0.3, 0.4, 0.5], order), np.zeros((2, 3, 3)))
    assert np.abs(surface.derivative(0.1, 0.2, (2, 3))).max() > 0
