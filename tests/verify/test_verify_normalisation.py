"""Verdicts on normalisation: right where the truth is known, and never certified where a defect is planted."""

import json
import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.bounds.enclosures import ranges_of
from rsym.sampling.level_lines import dense_outline
from rsym.verify.boxes.local import Model
from rsym.verify.normalisation.cover import Enclosure
from rsym.verify.normalisation.derivatives import NormalDerivatives
from rsym.verify.normalisation.normalisation import verify_normalisation
from rsym.verify.normalisation.places import onto_boundary

BOX = ((-4, 4), (-2, 2))
ELLIPSE = Shape(1 - x**2 / 9 - y**2, (x, y), bounds=BOX)
UNIT = rsym.normalise(ELLIPSE)
LINE = ((-1, 1), (-1, 1))


def second_along_normal(function, gradient, point):
    """d^2/dnu^2 by differences with forty digits."""
    with mpmath.workdps(40):
        place = [mpmath.mpf(c) for c in point]
        slope = gradient(*place)
        normal = [c / mpmath.norm(slope) for c in slope]
        return float(mpmath.diff(lambda t: function(*(c + t * n for c, n in zip(place, normal, strict=True))), 0, 2))


def unit_ellipse(u, v):
    value, slope = 1 - u**2 / 9 - v**2, (-2 * u / 9, -2 * v)
    return value / mpmath.sqrt(value**2 + slope[0] ** 2 + slope[1] ** 2)


def test_an_equation_that_is_not_normalised_is_refuted_at_its_worst_point():
    report = verify_normalisation(ELLIPSE, resolution=64)
    (worst,) = report.worst
    assert report.verdict == "REFUTED"
    assert worst.proved
    assert_close(worst.deviation, 1.0, atol=1e-9)  # |grad| = 2 at (0, 1) and (0, -1)
    assert_close(np.abs(worst.point), [0, 1], atol=1e-4)


def test_a_normalised_ellipse_is_certified_to_order_1_and_refuted_at_order_2():
    report = verify_normalisation(UNIT, resolution=64)
    assert report.verdict == "CERTIFIED"
    assert 0 < report.proved_bounds[0] <= report.tolerance
    assert not len(report.uncovered)
    assert not len(report.singular)
    report = verify_normalisation(UNIT, 2, resolution=64)
    assert report.verdict == "REFUTED"
    worst = report.worst[1]
    slope = lambda u, v: (-2 * u / 9, -2 * v)  # noqa: E731
    assert_close(worst.deviation, second_along_normal(unit_ellipse, slope, worst.point), rtol=1e-9)
    angles = np.linspace(0, 2 * math.pi, 60)
    others = [second_along_normal(unit_ellipse, slope, (3 * math.cos(t), math.sin(t))) for t in angles]
    assert max(map(abs, others)) <= abs(worst.deviation) + 1e-12


@pytest.mark.slow
def test_order_2_is_found_at_the_points_of_the_second_normalisation():
    report = verify_normalisation(rsym.normalise(ELLIPSE, order=2), 2, resolution=48, work=0)
    assert [place.proved for place in report.worst] == [True, True]
    assert_close([place.deviation for place in report.worst], [0, 0], atol=1e-20)
    assert report.verdict == "UNDECIDED"  # without work there is no bound


@pytest.mark.slow
def test_the_body_of_the_paper_has_a_tip_and_is_normalised_to_first_order_only():
    body = rsym.normalise(rsym.paper.skeleton_body())
    report = verify_normalisation(body)
    assert report.verdict == "UNDECIDED"
    assert report.proved_bounds[0] <= report.tolerance
    assert len(report.singular) == 1
    assert_close(report.singular[0], [-4.992121096289474, 0], atol=1e-6)
    assert np.abs(report.uncovered - report.singular[0][:, None]).max() < 0.25
    report = verify_normalisation(body, 2)
    assert report.verdict == "REFUTED"
    assert 0.49 < report.worst[1].deviation < 0.53
    assert len(report.singular) == 1


def test_the_boundary_is_certified_without_its_corner():
    corner = Shape(rsym.conjunction(x, 1 - y), (x, y), bounds=((-2, 2), (-2, 2)))
    report = verify_normalisation(corner, resolution=64)
    assert report.verdict == "CERTIFIED"
    assert "all along its boundary but at its corners" in str(report)
    assert_close(report.singular, [[0, 1]], atol=1e-6)
    assert report.proved_bounds[0] <= 1e-12
    assert len(report.crossed) == 1
    assert (report.crossed[0, :, 0] <= [0, 1]).all()
    assert (report.crossed[0, :, 1] >= [0, 1]).all()


CORNERED = [
    rsym.rectangle(2, 1),
    rsym.disc(1) & Shape(x, (x, y)),
    rsym.disc(1) - rsym.disc(1).translate(1, 0),
    rsym.polygon([(0, 0), (1, 0), (0, 1)]),
    rsym.polygon([(0, 0), (4, 0), (4, 3), (1, 1)], system=rsym.R1),
    rsym.rectangle(2, 1, system=rsym.RAlpha(0.5)) | rsym.disc(1).translate(1, 0),
    rsym.rectangle(1, 1) | rsym.rectangle(1, 1).translate(2, 0),
    rsym.box(2, 1, 1),
    rsym.cylinder(1, 2),
    rsym.sphere(1) - rsym.cylinder(sp.Rational(1, 2), 3),
]


@pytest.mark.random
@pytest.mark.parametrize("shape", CORNERED, ids=range(len(CORNERED)))
def test_shapes_with_corners_are_certified_but_there(shape):
    bounds = tuple((low - 0.2, high + 0.2) for low, high in rsym.extent(shape))
    report = verify_normalisation(shape, bounds=bounds, resolution=32)
    assert report.verdict == "CERTIFIED"
    assert "edges and corners" in str(report) if shape.dimension == 3 else "its corners" in str(report)
    plane = shape.dimension == 2
    points = np.vstack(rsym.level_lines(shape, bounds=bounds).lines) if plane else rsym.mesh(shape, 24).vertices
    low, high = (report.covered[:, :, end][:, None] for end in (0, 1))
    assert ((low - 1e-9 <= points) & (points <= high + 1e-9)).all(axis=2).any(axis=0).all()  # all of the boundary


def flush(system):
    """Two squares with a common side line: on it both are 0, and their disjunction is 2 + sqrt(2) times as steep."""
    first, second = rsym.rectangle(2, 2), rsym.rectangle(2, 2).translate(1, 0)
    return rsym.Shape(system.disjunction(first.expression, second.expression), (x, y))


@pytest.mark.parametrize(
    ("shape", "verdict"),
    [
        (flush(rsym.R0), "UNDECIDED"),
        (flush(rsym.R1), "UNDECIDED"),  # min and max of equal functions have no derivative that the program shows
        (rsym.disc(1) | rsym.disc(1, (2, 0)), "UNDECIDED"),  # they touch: no boxes are small enough to show two lines
        (rsym.rectangle(2, 1, system=rsym.R0m(2)), "REFUTED"),
        (Shape(rsym.conjunction(x, y / 2), (x, y), bounds=LINE), "REFUTED"),
        (Shape(rsym.conjunction(x, y + 1e-6 * y**2, system=rsym.Rp(4)), (x, y), bounds=LINE), "CERTIFIED"),
    ],
    ids=["flush", "flush in R1", "touching", "R0m", "steep", "nearly"],
)
def test_what_meets_otherwise_than_at_a_corner_is_not_certified(shape, verdict):
    bounds = shape.bounds or ((-1.5, 2.6), (-1.4, 1.4))
    assert verify_normalisation(shape, bounds=bounds, resolution=32, work=1e7).verdict == verdict


@pytest.mark.slow
def test_order_2_is_kept_at_corners_by_r_p_only():
    strips = [rsym.normalise(Shape(c * (2 - c), (x, y)), order=2).expression for c in (x, y)]
    for system, verdict in ((rsym.Rp(4), "CERTIFIED"), (rsym.R0, "REFUTED")):
        shape = Shape(system.conjunction(*strips), (x, y), bounds=((-1, 3), (-1, 3)))
        report = verify_normalisation(shape, 2, tolerance=0.05, resolution=32, work=2e7)
        assert report.verdict == verdict


def strip(width):
    """A line with |grad| = 1, but 1.003 where it passes a strip."""
    return sp.Piecewise((1.003 * y, (x > 0.3) & (x < 0.3 + width)), (y, True))


BUMP = y * (1 + sp.exp(-((200 * (x - sp.Rational(3, 10))) ** 2)) / 400)


@pytest.mark.random
@pytest.mark.parametrize("omega", [BUMP, strip(0.01), strip(1e-4), strip(1e-9)], ids=["bump", "0.01", "1e-4", "1e-9"])
def test_a_defect_that_sampling_misses_is_not_certified(omega):
    shape = Shape(omega, (x, y), bounds=LINE)
    report = verify_normalisation(shape, resolution=6)
    assert abs(report.worst[0].deviation) < 1e-3  # or it would not be missed
    assert report.verdict == "UNDECIDED"
    assert np.abs(report.uncovered.mean(axis=2) - [0.3, 0]).min() < 0.02


def test_a_bound_is_not_below_the_truth():
    shape = Shape(y * (1 + x**2 / 100), (x, y), bounds=LINE)
    report = verify_normalisation(shape, tolerance=0.0101, resolution=32)
    assert report.verdict == "CERTIFIED"
    assert 0.01 <= report.proved_bounds[0] <= 0.0101
    assert verify_normalisation(shape, tolerance=0.0099, resolution=32).verdict == "REFUTED"


@pytest.mark.random
@pytest.mark.parametrize(
    "omega", [UNIT.expression, ELLIPSE.expression + x * y / 5, rsym.conjunction(x + 2, 1 - y - x / 9)]
)
def test_bounds_on_boxes_hold_at_points_of_the_boundary(omega):
    shape = Shape(omega, (x, y), bounds=BOX)
    derivatives = NormalDerivatives(Model(shape, ranges_of(shape.letters, None)), 2)
    generator = np.random.default_rng(8)
    (line, *_) = dense_outline(shape, 40)
    middles = line[generator.integers(0, len(line), 100)] + generator.uniform(-0.01, 0.01, (100, 2))
    sizes = generator.uniform(0.001, 0.05, (100, 2))
    boxes = np.stack([middles - sizes, middles + sizes], axis=2)
    limits, _ = Enclosure(derivatives, 2).deviations(boxes)
    seeds = boxes[:, None, :, 0] + generator.uniform(0, 1, (100, 30, 2)) * 2 * sizes[:, None]
    points, arrived = onto_boundary(derivatives, seeds.reshape(-1, 2), 0.1)
    inside = (points.reshape(100, 30, 2) > boxes[:, None, :, 0]) & (points.reshape(100, 30, 2) < boxes[:, None, :, 1])
    found = np.abs(derivatives.at(points).deviations.reshape(100, 30, 2))
    counted = inside.all(axis=2) & arrived.reshape(100, 30)
    assert counted.sum() > 300
    assert np.isfinite(limits).mean() > 0.9
    assert (found <= limits[:, None] + 1e-9)[counted].all()


@pytest.mark.slow
def test_where_there_is_no_boundary():
    report = verify_normalisation(Shape(1 + x**2 + y**2, (x, y), bounds=LINE), resolution=16)
    assert report.verdict == "DEGENERATE"
    assert ("omega has no zero within the bounds", True) in report.statements
    touching = verify_normalisation(
        Shape(-((x**2 + y**2 - sp.Rational(1, 4)) ** 2), (x, y), bounds=LINE), resolution=16
    )
    assert touching.verdict == "UNDECIDED"  # no sample is no proof that there is nothing
    assert not any(proved for _, proved in touching.statements)


@pytest.mark.slow
@pytest.mark.parametrize("omega", [y * abs(y), y**3, y * abs(x)])
def test_a_boundary_without_a_gradient_is_there_all_the_same(omega):
    report = verify_normalisation(Shape(omega, (x, y), bounds=LINE), resolution=16)
    assert report.verdict in {"UNDECIDED", "REFUTED"}
    assert "no boundary" not in str(report)


def test_in_space():
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.3, 1.3),) * 3)
    report = verify_normalisation(rsym.normalise(ball), resolution=16, tolerance=0.3)
    assert report.verdict == "CERTIFIED"
    report = verify_normalisation(ball, resolution=16)
    assert report.verdict == "REFUTED"
    assert_close(report.worst[0].deviation, 1.0, atol=1e-12)


def test_what_lies_outside_the_bounds_does_not_count():
    shape = Shape(y * (1 + x**2), (x, y))
    report = verify_normalisation(shape, bounds=((-1 / 64, 1 / 64), (-1 / 32, 1 / 32)), resolution=16)
    assert report.verdict == "CERTIFIED"
    assert abs(report.worst[0].point[0]) <= 1 / 64


def test_letters_are_numbers():
    k = sp.Symbol("k", real=True)
    shape = Shape(k * y, (x, y), letters={k: 2}, bounds=LINE)
    assert verify_normalisation(shape, letters={"k": 1}, resolution=16).verdict == "CERTIFIED"
    assert verify_normalisation(shape, resolution=16).verdict == "REFUTED"
    with pytest.raises(RsymError, match="range"):
        verify_normalisation(shape, letters={"k": (1, 2)})


@pytest.mark.parametrize(("order", "tolerance"), [(0, 1e-3), (1.0, 1e-3), (True, 1e-3), (1, 0), (1, -1), (1, math.nan)])
def test_wrong_orders_and_tolerances_are_refused(order, tolerance):
    with pytest.raises(RsymError):
        verify_normalisation(ELLIPSE, order, tolerance=tolerance)


def test_the_report_says_what_is_proved():
    report = verify_normalisation(UNIT, resolution=48, tolerance=0.01)
    text = str(report)
    assert text.startswith("CERTIFIED: omega within [-4, 4] x [-2, 2] is normalised to order 1 within 0.01")
    assert "Proved: |d omega/d nu - 1| <= 0.00" in text
    record = json.loads(report.to_json())
    assert record["verdict"] == "CERTIFIED"
    assert record["boxes_counted"] == {"covered": len(report.covered), "crossed": 0, "uncovered": 0}
    assert len(json.loads(report.to_json(boxes=True))["covered"]) == len(report.covered)
    assert "CERTIFIED" in report._repr_html_()
    refuted = verify_normalisation(ELLIPSE, resolution=48)
    assert json.loads(refuted.to_json())["proved_bounds"] == [None]
    assert "not normalised to order 1" in str(refuted)


@pytest.mark.parametrize(
    "shape",
    [
        rsym.normalise(rsym.rectangle(2, 1)),
        rsym.normalise(rsym.rectangle(2, 1), length=3),
        rsym.normalise(Shape(rsym.conjunction(1 - x**2 - y**2, x - y**3), (x, y), bounds=((-2, 2), (-2, 2)))),
    ],
    ids=["rectangle", "length", "cubic"],
)
def test_what_is_normalised_as_a_whole_is_so_all_along_its_boundary_but_at_its_corners(shape):
    report = verify_normalisation(shape, resolution=32, tolerance=0.01)
    assert report.verdict == "CERTIFIED"
    assert len(report.crossed)


def test_what_was_missing_is_said_with_its_place():
    diamond = rsym.normalise(Shape(1 - abs(x) - abs(y), (x, y)))
    report = verify_normalisation(diamond, resolution=16)
    assert report.verdict == "UNDECIDED"
    assert any("two leaves cross, and that they do so once is not proved" in text for text, _ in report.statements)
    assert "two leaves cross" in str(report)
