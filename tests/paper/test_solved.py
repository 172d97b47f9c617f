"""The figure of solved equations: its shapes, and values that are known otherwise."""

import math

import numpy as np
import pytest

import rsym
from rsym.paper import fields


def test_the_gear_has_its_teeth_and_is_one_smooth_function():
    angles = np.linspace(0, 2 * np.pi, 721)
    edge = rsym.level_lines(fields.gear(), resolution=128)
    assert len(edge) == 1
    radius = np.interp(angles, *_sorted(edge[0]), period=2 * np.pi)
    assert np.sum(np.diff(np.sign(radius - radius.mean())) != 0) == 2 * fields.TEETH
    # Where r**10 is t, the top of a tooth has t/(1 + t**2)/2 = r**2 - 1.
    assert radius.max() ** 2 - 1 == pytest.approx(_share(radius.max()) / 2, abs=1e-4)


def _share(radius):
    return radius**fields.TEETH / (1 + radius ** (2 * fields.TEETH))


def _sorted(line):
    angle = np.arctan2(line[:, 1], line[:, 0]) % (2 * np.pi)
    order = np.argsort(angle)
    return angle[order], np.hypot(*line[order].T)


def test_the_plate_and_the_shaft_have_their_parts():
    measured = rsym.measure(fields.plate(), tolerance=1e-6)
    assert measured.parts == pytest.approx({"edge": 20, "holes": 6 * 2 * math.pi * 0.45}, rel=1e-6)
    assert list(fields.shaft().letters) == ["d"]


@pytest.mark.slow
def test_the_figure_is_drawn_with_its_table():
    drawing = fields.draw_solved()
    values = {row[:2]: float(row[2]) for row in drawing.table.rows}
    # A tube without its keyway is stiffer, one cut down to the keyway's floor softer.
    floor = 1 - fields.DEPTH
    assert math.pi / 2 * (floor**4 - 0.4**4) < values["shaft", "rigidity J"] < math.pi / 2 * (1 - 0.4**4)
    # The drum lies between two discs, and a larger drum is deeper.
    least, most = (5.783185962946785 / radius**2 for radius in (1.12, 0.88))
    assert least < values["drum", "eigenvalue 1"] < most
    assert values["drum", "eigenvalue 2"] == pytest.approx(values["drum", "eigenvalue 3"], rel=1e-5)
    titles = [ax.get_title() for ax in drawing.figure.axes]
    assert "a plate that cools in its holes" in titles
    assert sum(title.startswith(r"$\lambda") for title in titles) == fields.COUNT
