"""The studies behind the figures: revolving and normalising, omega_n as a distance, the cost of drawing."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.undefined import without_value

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.paper import preference, studies

PROFILE = Shape(1 - x**2 / 4 - y**2 + x * y**4 / 8, (x, y))
RHO = sp.sqrt(y**2 + z**2)


def test_the_gradient_commutes_with_revolution_and_the_laplacian_gains_one_term():
    solid = rsym.revolve(PROFILE)
    squared = sum(part**2 for part in rsym.gradient(PROFILE))
    assert sp.simplify(sum(part**2 for part in rsym.gradient(solid)) - squared.subs(y, RHO)) == 0
    plane = rsym.laplacian(PROFILE) + rsym.gradient(PROFILE)[1] / y
    assert sp.simplify(rsym.laplacian(solid) - plane.subs(y, RHO)) == 0
    assert sp.simplify(studies.gain(PROFILE).expression - rsym.gradient(PROFILE)[1] / y) == 0


@pytest.mark.slow
def test_normalising_and_revolving_commute():
    before, after = rsym.revolve(rsym.normalise(PROFILE)), rsym.normalise(rsym.revolve(PROFILE))
    assert sp.simplify(before.expression**2 - after.expression**2) == 0
    body = rsym.paper.skeleton_body()
    points = np.random.default_rng(3).uniform((-7, -3, -3), (8, 3, 3), (300, 3)).T
    values = [
        rsym.compile(shape)(*points)["value"]
        for shape in (rsym.revolve(rsym.normalise(body)), rsym.normalise(rsym.revolve(body)))
    ]
    assert_close(values[0], values[1], atol=1e-12)


def test_the_laplacian_of_the_revolved_body_of_figure_11():
    """Against central differences of the plane field."""
    body = rsym.paper.skeleton_body()
    normalised = rsym.compile(body, ("normalised",))
    points = np.random.default_rng(4).uniform((-4, 0.5), (4, 2), (50, 2))
    step = 1e-4

    def at(across, along):
        return normalised(points[:, 0] + across * step, points[:, 1] + along * step)["normalised"]

    plane = (at(1, 0) + at(-1, 0) + at(0, 1) + at(0, -1) - 4 * at(0, 0)) / step**2
    slope = (at(0, 1) - at(0, -1)) / (2 * step)
    revolved = rsym.compile(rsym.revolve(body), ("normalised_laplacian",))(*points.T, 0.0)["normalised_laplacian"]
    assert_close(revolved, plane + slope / points[:, 1], atol=1e-5)


@pytest.mark.slow
def test_the_preference_is_measured():
    spreads, bands = preference.measure()
    by_name = {(one.body, one.quantity): one.quantiles for one in spreads}
    assert len(spreads) == 20
    for body in ("body of Fig. 11", "car"):
        assert_close(by_name[body, "|∇ωₙ| on the boundary"], np.ones(5), atol=1e-6)
        least, *_, greatest = by_name[body, "ωₙ in the bounds"]
        assert -1 <= least < 0 < greatest <= 1
    assert by_name["car", "|∇ω| on the boundary"][4] > 5
    assert by_name["car", "ω in the bounds"][0] < -50
    for band in bands:
        assert ((np.abs(band.distance) > preference.NEAREST) & (np.abs(band.distance) < preference.BAND)).all()
        assert np.median(np.abs(band.error("normalised"))) <= 0.8 * np.median(np.abs(band.error("value")))


def test_a_normalised_disc_is_off_by_half_its_distance():
    """|omega| = (1 - r**2)/2 = d - d**2/2, so the error of omega is -d/2: known exactly."""
    disc = Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    lines = rsym.level_lines(disc, resolution=400)
    distance = lambda points: np.abs(np.hypot(*points.T) - 1)  # noqa: E731
    _, band = preference._study("disc", disc, lines[0], distance)
    assert_close(band.error("value"), -band.distance / 2, atol=1e-12)


@pytest.mark.parametrize("boxes", [1, 3])
def test_sub_boxes_cover_the_body(boxes):
    """A plane across the box is drawn in every sub-box that it meets: its area is that of its triangles."""
    wall = Shape(x - 0.1, (x, y, z), bounds=((-1, 1),) * 3)
    per_box = 2 * (12 // boxes - 2 + 1) ** 2
    assert sum(piece.status.triangles for piece in studies.meshes(wall, 12, boxes).values()) == per_box * boxes**2


@pytest.mark.slow
def test_the_cost_counts_what_it_is_asked_for(monkeypatch):
    monkeypatch.setattr(studies, "COMBINATIONS", ((20, (1, 2)), (30, (1, 2))))
    costs = studies.measure()
    assert [(one.points, one.boxes) for one in costs] == [(8000, 1), (8000, 8), (27000, 1), (27000, 8)]
    assert all(one.seconds > 0 and one.megabytes > 8e-6 * one.points / one.boxes for one in costs)
    drawing = studies.draw_cost()
    assert len(drawing.table.rows) == 4
    assert len(drawing.table.header) == len(drawing.table.rows[0])


def test_an_undefined_value_in_a_sub_box_is_not_passed_over():
    with pytest.raises(RsymError, match="undefined"):
        studies.meshes(Shape(without_value(-x) + z - 1, (x, y, z), bounds=((-2, 2),) * 3), 20, 2)


@pytest.mark.slow
def test_the_stack_of_sections_comes_with_its_layers():
    drawing = studies.draw_sections()
    (layers,) = drawing.files.values()
    assert layers.count(b'inkscape:label="z=') == len(studies.HEIGHTS) == 22
    assert studies.HEIGHTS[-1] == 7.75
