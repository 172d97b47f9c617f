"""Torsion against exact rigidities, hollow sections and letters; curves of boundaries."""

import math

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.problems.loops import loops_of

SQUARE = 0.14057701495515551  # of the unit square, by its series


def test_the_series_of_the_square():
    terms = (math.tanh((2 * k + 1) * math.pi / 2) / (2 * k + 1) ** 5 for k in range(2000))
    assert abs((1 - 192 / math.pi**5 * sum(terms)) / 3 - SQUARE) < 1e-15


def test_squares_wherever_they_lie():
    square = rsym.rectangle(1, 1)
    for shape, shares in ((square, (2e-6, 1e-7)), (square.rotate(0.3), (1e-5, 6e-7))):
        for cells, share in zip((8, 16), shares, strict=True):
            assert abs(rsym.torsion(shape, cells=cells).rigidity / SQUARE - 1) < share


def test_a_hollow_shaft_and_its_stress():
    shaft = rsym.torsion(rsym.disc(1) - rsym.disc(sp.Rational(1, 2)), tolerance=1e-9)
    assert abs(float(shaft) / (15 / 32 * math.pi) - 1) < 1e-11
    assert abs(shaft.levels[0] - 0.375) < 1e-11
    np.testing.assert_allclose(shaft.stress(0.6, [0.3, -0.5]), [[-0.3, 0.6], [0.5, 0.6]], atol=1e-6)
    assert shaft.grades[-1].estimate < 1e-9


def test_confocal_ellipses_are_exact():
    """Of the ellipses a, b and k*a, k*b the rigidity is pi a^3 b^3 (1 - k^4)/(a^2 + b^2)."""
    tube = rsym.ellipse(2, 1) - rsym.ellipse(1, sp.Rational(1, 2))
    exact = math.pi * 8 * (1 - 1 / 16) / 5
    assert abs(float(rsym.torsion(tube, cells=20, degree=5)) / exact - 1) < 1e-6


def test_six_holes_of_a_shaft():
    """By symmetry they have one level, and of 2 all over the rim's disc the flux is 2 pi 3^2; stresses are bounded."""
    shaft = rsym.disc(3).named("rim")
    for k in range(6):
        shaft = shaft - rsym.disc(sp.Rational(9, 20), (2 * sp.cos(k * sp.pi / 3), 2 * sp.sin(k * sp.pi / 3)))
    found = rsym.torsion(shaft, cells=16)
    assert np.ptp(found.levels) < 1e-3 * found.levels[0]
    assert abs(found.solution.flux("rim") / (-18 * math.pi) - 1) < 1e-2
    assert 1 < found.greatest_stress().value < 6


def test_letters_compile_nothing(monkeypatch):
    d = sp.Symbol("d", real=True)
    shaft = rsym.torsion(rsym.disc(1) - rsym.disc(d, letters={d: 0.5}), cells=16)
    monkeypatch.setattr("rsym.backends.kernel.make_function", None)
    monkeypatch.setattr("rsym.problems.problem.shape_form", None)  # nor is the shape lowered again
    for value in (0.4, 0.6):
        exact = (1 - value**4) * math.pi / 2
        assert abs(float(shaft.with_letters({"d": value})) / exact - 1) < 3e-7


def test_the_function_of_a_shaft_for_other_letters():
    d = sp.Symbol("d", real=True)
    solid = rsym.torsion(rsym.disc(d, letters={d: 2}), cells=8).solution.with_letters({"d": 1})
    assert abs(2 * solid.integral() - math.pi / 2) < 1e-9
    hollow = rsym.torsion(rsym.disc(1) - rsym.disc(d, letters={d: 0.5}), cells=8).solution
    with pytest.raises(rsym.RsymError, match="twisted shaft"):
        hollow.with_letters({"d": 0.4})


def test_curves_of_a_boundary():
    slot = rsym.rectangle(sp.Rational(3, 10), 1).translate(0, 1)
    loops = loops_of(rsym.disc(1) - slot - rsym.disc(sp.Rational(2, 5)))
    assert [(len(loop.leaves), loop.hole) for loop in loops] == [(3, False), (1, True)]


def test_what_is_no_section_of_one_shaft_is_refused():
    with pytest.raises(rsym.RsymError, match="2 outer boundaries"):
        rsym.torsion(rsym.disc(1) | rsym.disc(1, (3, 0)), cells=16)
    two = rsym.Shape((x**2 - 1) ** 2 + y**2 - sp.Rational(1, 10), (x, y))
    with pytest.raises(rsym.RsymError, match="several holes"):
        rsym.torsion(rsym.disc(2) & two, cells=16)
    half = rsym.disc(1).named("rim") & rsym.half_plane((1, 0), 0)
    with pytest.raises(rsym.RsymError, match="all of a closed curve"):
        rsym.solve(half, "-laplacian(u) = 1", {"rim": rsym.constant(), ...: 0}, cells=16)


def test_holes_are_found_again_for_other_letters():
    """A disc that bounded a hole of its own joins another one: two leaves around one level."""
    d = sp.Symbol("d", real=True)
    fifth = sp.Rational(1, 5)
    apart = rsym.disc(1) - rsym.disc(fifth, (d, 0), letters={d: 0.4}).named("moved") - rsym.disc(fifth, (-0.4, 0))
    joined = rsym.torsion(apart.with_letters({"d": -0.2}), cells=16)
    assert len(joined.levels) == 1
    moved = rsym.torsion(apart, cells=16).with_letters({"d": -0.2})
    assert abs(float(moved) / float(joined) - 1) < 1e-8
    levels = {"moved": rsym.constant(), ...: 0}
    found = rsym.solve(apart, "-laplacian(u) = 2", levels, cells=16)
    with pytest.raises(rsym.RsymError, match="goes on from it"):
        found.with_letters({"d": -0.2})


def test_holes_too_small_to_be_seen_are_refused():
    """A disc inside what it is joined to bounds nothing, and is none."""
    drilled = rsym.disc(1).named("rim") - rsym.disc(sp.Rational(3, 1000), (0.31, 0.22)).named("bore")
    with pytest.raises(rsym.RsymError, match="bore bounds something too small"):
        rsym.torsion(drilled, cells=16)
    with pytest.raises(rsym.RsymError, match="bore bounds something too small"):
        rsym.solve(drilled, "-laplacian(u) = 1", {"rim": 0, "bore": rsym.constant()}, cells=16)
    assert len(loops_of(rsym.disc(1) | rsym.disc(sp.Rational(1, 5)))) == 1
