"""Solutions have functions of their own at corners, and singular problems are solved to many digits."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.problems.cornered import with_corners
from rsym.problems.corners.choice import chosen_corners
from rsym.problems.galerkin import Discretisation
from rsym.problems.places import rule_for
from rsym.problems.solving import problem_of
from rsym.problems.splines.evaluation import jets

L_DRUM = 9.639723844021941  # of three unit squares: Trefethen and Betcke (2006)
SQUARE = 0.14057701495515551


def side(angle, distance):
    return rsym.half_plane((math.cos(angle), math.sin(angle)), distance)


def ell(turn=0.0):
    whole = side(turn, -1)
    for k in (1, 2, 3):
        whole = whole & side(turn + k * math.pi / 2, -1)
    return whole & (side(turn + math.pi, 0) | side(turn + math.pi / 2, 0))


def found_by(problem):
    return with_corners(problem, 5).corners


def test_functions_vanish_on_leaves_with_values():
    problem = with_corners(problem_of(ell(0.2), "-laplacian(u) = 1", 0), 5)
    assert len(problem.corners.corners) == 6
    rule = rsym.quadrature(ell(0.2), cells=16, order=4)
    assert np.abs(problem.extras(rule.boundary.points, 0)).max() < 1e-13
    assert np.abs(problem.extras(rule.points, 0)).max() > 1e-2


def test_without_a_load_right_corners_have_none():
    unloaded = found_by(problem_of(ell(), "-laplacian(u) = 0", 0))
    assert [corner.point for corner in unloaded.corners] == [pytest.approx((0, 0), abs=1e-12)]
    assert unloaded.left == ()
    # Whole exponents too: at a re-entrant corner the weight is not smooth.
    assert [round(3 * term.exponent) for term in unloaded.functions.terms[:3]] == [2, 4, 6]
    # Of the load y the corners on y = 0 have none.
    half = found_by(problem_of(rsym.rectangle(1, 1).translate(0, sp.Rational(1, 2)), "-laplacian(u) = y", 0))
    assert [round(corner.point[1], 9) for corner in half.corners] == [1, 1]


def test_natural_conditions_are_met_by_the_cosine():
    free = found_by(problem_of(ell(), "-laplacian(u) + u = 1", {}))
    assert {term.kind for term in free.functions.terms} == {"cos"}


@pytest.mark.parametrize(
    ("equation", "axis"),
    [
        ("-laplacian(u) + dot([3, 1 + 2*y], grad(u)) = 1", None),
        ("-div((4 + x - y^2)*grad(u)) + dot([1, x], grad(u)) = 1", None),
        ("-laplacian(u) = 1", y),
    ],
)
def test_convection_and_diffusion_that_varies_are_those_of_functions_at_corners(equation, axis):
    """What the equation makes of them is of the order of c*u; without their factor it is one order more."""
    shape = ell(0.2).translate(3, 0)
    problem = problem_of(shape, equation, 0, axis=axis)
    (part,) = (one for one in with_corners(problem, 5).corners.functions.parts if one.corner.is_reentrant)
    assert part.growth is not None
    first = math.atan2(*part.corner.edges[0][::-1])

    def left(distance):
        ways = first + part.corner.angle * np.linspace(0.1, 0.9, 5)
        points = part.corner.point + distance * np.stack([np.cos(ways), np.sin(ways)], axis=1)
        _, by_x, by_y, xx, _, yy = part.derivatives(points, 2)[:, :, 0].T
        px, py = points.T
        k, kx, ky = {"4": (4 + px - py**2, 1, -2 * py)}.get(equation[6], (1, 0, 0))
        bx, by = {"3": (3, 1 + 2 * py), "1": (1, px)}.get(equation[equation.find("[") + 1], (0, 0))
        bx = bx - 1 / px if axis else bx
        return np.abs(-k * (xx + yy) - kx * by_x - ky * by_y + bx * by_x + by * by_y).max()

    assert left(1e-5) <= 1.2 * 0.01 ** part.terms[0].exponent * left(1e-3)


def test_a_diffusion_that_jumps_at_a_corner_has_no_factor():
    jump = sp.Piecewise((1, x < y), (5, True))
    problem = problem_of(ell(), "-div(k*grad(u)) = 1", 0, letters={"k": jump})
    assert all(
        part.growth is None for part in with_corners(problem, 5).corners.functions.parts if part.corner.is_reentrant
    )


def comb(count):
    """Teeth of a right angle: twice as many re-entrant corners."""
    teeth = [rsym.rectangle(sp.Rational(1, 4), 1).translate(sp.Rational(k, 2), sp.Rational(1, 2)) for k in range(count)]
    return rsym.disjunction(rsym.rectangle(count, 1).translate(sp.Rational(count - 1, 4), 0), *teeth)


def test_of_many_corners_the_sharpest_have_functions():
    shape = comb(6)
    some = chosen_corners(shape, (), lambda corners: [True] * len(corners), most=15)
    assert len(some.functions) <= 15
    assert all(corner.is_reentrant for corner in some.corners)
    assert 0 < len(some.corners) < 12
    # Right corners come last, and all get at least one before some get more.
    every = chosen_corners(shape, (), lambda corners: [True] * len(corners), most=40)
    assert len(every.functions) <= 40
    assert [len(every.corners) + len(every.left), every.left] == [28, ()]
    full = chosen_corners(shape, (), lambda corners: [True] * len(corners))
    assert 200 < len(full.functions) <= 400
    assert full.left == ()


def test_the_report_tells_of_corners():
    crescent = rsym.disc(1) - rsym.disc(sp.Rational(1, 2), (sp.Rational(1, 2), 0))
    cusp = rsym.solve(crescent, "-laplacian(u) = 1", 0, cells=16)
    assert (cusp.report.corners, cusp.report.left) == (0, 2)
    assert "2 corners without such functions" in str(cusp.report)
    kinked = rsym.Shape(rsym.conjunction(1 - x**2 - y**2, y + sp.Rational(1, 2) + sp.sqrt(x**2 + x**4)), (x, y))
    found = rsym.solve(kinked, "-laplacian(u) = 1", 0, cells=32)
    assert (found.report.corners, found.report.left, len(found.report.refused)) == (2, 0, 1)
    assert "kink" in str(found.report)
    assert 0 < found(0, 0.2) < 0.25
    assert "6 corners of the shape" in str(rsym.solve(ell(), "-laplacian(u) = 1", 0, cells=8).report)


def test_where_parts_run_along_each_other_corners_have_functions():
    """The sides x = 1 and y = 1 are those of both rectangles."""
    shape = rsym.rectangle(2, 2) - rsym.rectangle(1, 1).translate(sp.Rational(1, 2), sp.Rational(1, 2))
    (drum,) = rsym.modes(shape, 1, cells=16).modes
    assert (drum.report.corners, drum.report.refused) == (1, ())
    assert abs(drum.report.eigenvalue / L_DRUM - 1) < 5e-8


def test_letters_compile_nothing_at_corners(monkeypatch):
    a = sp.Symbol("a", real=True)
    notch = rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(a - x, y))
    shape = rsym.Shape(notch, (x, y), letters={a: 0})
    drum = rsym.solve(shape, "-laplacian(u) = 1", 0, cells=8)
    monkeypatch.setattr("rsym.backends.kernel.make_function", None)
    other = drum.with_letters({"a": 0.25})
    assert other.report.corners == 6
    monkeypatch.undo()
    direct = rsym.solve(shape.with_letters({"a": 0.25}), "-laplacian(u) = 1", 0, cells=8)
    assert other.integral() == direct.integral()
    assert other.integral() != drum.integral()


def test_it_pickles_with_corners():
    found = rsym.solve(ell(), "-laplacian(u) = 1", 0, cells=8)
    again = pickle.loads(pickle.dumps(found))
    assert again(0.3, 0.1) == found(0.3, 0.1)
    assert again.integral() == found.integral()


def bordered(threads=None):
    """The equations of an L with a hole at an unknown level: three kinds of functions."""
    bore = rsym.disc(sp.Rational(1, 5), (sp.Rational(-1, 2), sp.Rational(-1, 2))).named("bore")
    shape = (ell() - bore).replace(bounds=((-1.1, 1.1), (-1.1, 1.1)))
    problem = with_corners(problem_of(shape, "-laplacian(u) + u = 1", {"bore": rsym.constant(), ...: 0}), 6)
    return Discretisation(problem, rule_for(problem, 16, 7), 3, threads)


def test_rows_and_columns_of_functions_at_corners_are_their_integrals():
    discrete = bordered()
    points, weights = discrete.rule.points, discrete.rule.weights
    count = discrete.extra_count
    assert count > 20
    functions = discrete.extras(points)  # of all points, whether near or not
    inner = np.random.default_rng(5).standard_normal(discrete.splines.extension.shape[1])
    whole = discrete.splines.extension @ inner
    phi, weight = jets(discrete.splines, whole[None], points, 1)[:, 0], discrete.tests(points)
    field = np.stack([weight[0] * phi[0], *(weight[0] * phi[k] + weight[k] * phi[0] for k in (1, 2))])
    matrix = discrete.matrix.toarray()
    among = np.einsum("n,kin,kjn->ij", weights, functions, functions)
    np.testing.assert_allclose(matrix[-count:, -count:], among, atol=1e-13 * np.abs(among).max())
    across = np.einsum("n,kn,kjn->j", weights, field, functions)
    np.testing.assert_allclose(inner @ matrix[:-count, -count:], across, atol=1e-12 * np.abs(across).max())
    np.testing.assert_array_equal(matrix[-count:, :-count], matrix[:-count, -count:].T)
    np.testing.assert_allclose(discrete.right[-count:], functions[0] @ weights, atol=1e-15)


def test_threads_do_not_change_the_bits_of_rows_and_columns():
    one, three = (bordered(threads) for threads in (1, 3))
    assert (one.rule.points == three.rule.points).all()
    assert (one.matrix != three.matrix).nnz == 0
    assert (one.right == three.right).all()


@pytest.mark.parametrize(("turn", "share"), [(0.0, 3e-7), (0.3, 3e-6)])
def test_an_l_shaped_drum(turn, share):
    assert abs(rsym.modes(ell(turn), 1, cells=16).values[0] / L_DRUM - 1) < share
    assert abs(rsym.modes(ell(turn), 1, cells=16, corners=False).values[0] / L_DRUM - 1) > 1e-4


@pytest.mark.slow
def test_an_l_shaped_drum_to_ten_digits():
    assert abs(rsym.modes(ell(), 1, cells=32, degree=5).values[0] / L_DRUM - 1) < 2e-11
    assert abs(rsym.modes(ell(0.3), 1, cells=32, degree=5).values[0] / L_DRUM - 1) < 3e-10


def square(turn):
    whole = side(turn, -0.5)
    for k in (1, 2, 3):
        whole = whole & side(turn + k * math.pi / 2, -0.5)
    return whole


@pytest.mark.parametrize(("turn", "share"), [(0.0, 3e-11), (0.3, 1e-10)])
def test_the_torsion_of_a_square(turn, share):
    for shape in (square(turn), rsym.rectangle(1, 1).rotate(turn)):
        assert abs(float(rsym.torsion(shape, cells=16, degree=5)) / SQUARE - 1) < share


@pytest.mark.slow
def test_cells_so_small_that_splines_make_up_functions_of_corners():
    for degree in (5, 6):
        assert abs(float(rsym.torsion(rsym.rectangle(1, 1), cells=32, degree=degree)) / SQUARE - 1) < 1e-13


def test_the_torsion_of_an_l():
    assert abs(float(rsym.torsion(ell(), cells=16, degree=5)) - 0.8563032) < 5e-8


def test_mixed_conditions_at_a_straight_corner():
    """Half of a disc with the cut free: half of the torsion of the whole."""
    half = rsym.disc(1).named("rim") & rsym.half_plane((0, 1), 0)
    found = rsym.solve(half, "-laplacian(u) = 1", {"rim": 0}, cells=16)
    assert abs(found(0.3, 0.4) - 0.75 / 4) < 1e-10


def test_a_re_entrant_corner_with_mixed_conditions():
    """u = Im z**(1/3): 0 on one edge of a right re-entrant corner, no flow through the other."""
    inner = side(math.pi, 0).named("free") | side(math.pi / 2, 0).named("held")
    shape = rsym.disc(1).named("rim") & inner
    exact = (x**2 + y**2) ** sp.Rational(1, 6) * sp.sin((sp.pi / 2 + sp.atan2(-x, y)) / 3)
    conditions = {"held": 0, "free": rsym.neumann(0), "rim": rsym.robin(1, sp.Rational(4, 3) * exact)}
    found = rsym.solve(shape, "-laplacian(u) = 0", conditions, cells=24)
    for r, angle in ((0.5, 1.0), (0.1, 2.5), (0.001, 4.0)):
        value = found(r * math.cos(angle), r * math.sin(angle))
        assert abs(value - r ** (1 / 3) * math.sin(angle / 3)) < 1e-5


@pytest.mark.parametrize(("opening", "error"), [(1.0, 1e-6), (2.5, 5e-6), (4.0, 5e-6)])
def test_corners_of_any_opening_with_mixed_conditions(opening, error):
    """u = r**rate sin(rate*theta), rate = pi/2 over the opening: 0 on one edge, no flow through the other."""
    edges = side(math.pi / 2, 0).named("held"), side(opening - math.pi / 2, 0).named("free")
    wedge = (edges[0] & edges[1]) if opening < math.pi else (edges[0] | edges[1])
    rate, half = math.pi / 2 / opening, opening / 2
    angle = half + sp.atan2(y * math.cos(half) - x * math.sin(half), x * math.cos(half) + y * math.sin(half))
    exact = (x**2 + y**2) ** (rate / 2) * sp.sin(rate * angle)
    conditions = {"held": 0, "free": rsym.neumann(0), "rim": rsym.neumann(rate * exact)}
    shape = rsym.disc(1).named("rim") & wedge
    found = rsym.solve(shape, "-laplacian(u) = 0", conditions, cells=20, degree=5)
    assert found.report.corners == 1
    plain = rsym.solve(shape, "-laplacian(u) = 0", conditions, cells=20, degree=5, corners=False)
    r, share = np.array([[0.5, 0.3], [0.1, 0.5], [0.001, 0.9]]).T
    place, values = (r * np.cos(share * opening), r * np.sin(share * opening)), r**rate * np.sin(rate * share * opening)
    assert np.abs(found(*place) - values).max() < error < np.abs(plain(*place) - values).max() / 3


PAIR = rsym.disc(1).named("a") | rsym.disc(1, (1, 0)).named("b")


@pytest.mark.parametrize(
    ("equation", "conditions", "more", "cells"),
    [
        ("-div(K*grad(u)) = 1", {"a": 0}, {"letters": {"K": [[1, 0], [0, 10]]}}, 16),
        ("bilaplacian(u) = 1", rsym.clamped(), {"corners": False}, 48),
    ],
    ids=["different directions", "plate"],
)
def test_errors_at_corners_without_functions_are_estimated_by_fewer_cells(equation, conditions, more, cells):
    """Two degrees share the error that corners which point inwards leave: a tenth of it is their difference."""
    found = rsym.solve(PAIR, equation, conditions, **more, cells=cells)
    fine = rsym.solve(PAIR, equation, conditions, **{**more, "corners": True}, cells=96, degree=5, estimate=False)
    values, truth = (one.jets(found.rule.points, 0)[0] for one in (found, fine))
    error = np.sqrt(np.average((values - truth) ** 2, weights=found.rule.weights)) / np.abs(truth).max()
    assert error < 2 * found.report.estimate < 20 * error
    assert found.report.left == 2
    assert "2 corners without such functions" in str(found.report)
