"""Regions under attack: numbers that are lifted, what is undefined, and letters that several ask for at once."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.undefined import without_value

import rsym
from rsym import RsymError, x, y, z
from rsym.logic.sign_form import surface_form
from rsym.sampling.kernels.mesher_kernels import columns, mesher_kernels, padded
from rsym.sampling.lattice import lattice_over
from rsym.sampling.plane_regions import signs_on
from rsym.sampling.regions.region_kernels import RegionKernels, region_kernels
from rsym.sampling.regions.regions import INSIDE, KEPT, OUTSIDE

a, b = sp.symbols("a b", real=True)
CUBE = ((-1.0, 1.0),) * 3


def one_by_one(call, count, grain):
    return [call(0, count)]


def kernels_of(formula, letters, moved=None):
    """Kernels with everything lifted."""
    shape = rsym.Shape(formula, (x, y, z), letters=letters)
    kernels = RegionKernels(surface_form(shape), shared=True)
    kernels.set(shape.letters.values_with(moved), CUBE)
    return kernels


def values(kernels, points):
    """Without the scale of the active leaf."""
    count = points.shape[1]
    value, leaf = np.empty(padded(count)), np.empty(padded(count), np.int16)
    kernels.value(count, columns(points), value, leaf)
    return value[:count] / np.asarray(kernels._given[1])[leaf[:count]]


def ends_around(points, half):
    ends = np.empty((6, points.shape[1]))
    ends[::2], ends[1::2] = points - half, points + half
    return ends


def test_bounds_of_numbers_with_an_end_in_common_do_not_move_to_other_leaves():
    """1/10 and the float 0.1 are two numbers with one upper end, 3/10 and 0.3 too: the rows keep their length."""
    tenth, three = sp.Float(0.1), sp.Float(0.3)
    formula = rsym.conjunction(
        x - sp.Rational(1, 10), y + tenth, 2 * z + sp.Rational(3, 10), 5 * x + three * y + 7, x * y + 11
    )
    kernels = kernels_of(formula, {})
    points = np.random.default_rng(3).uniform(-1, 1, (3, 64))
    u, v, w = points
    expected = np.min([u - 0.1, v + 0.1, 2 * w + 0.3, 5 * u + 0.3 * v + 7, u * v + 11], axis=0)
    sides, _ = kernels.sides(ends_around(points, 1e-6), np.zeros(64, np.int64), None, one_by_one)
    np.testing.assert_array_equal(sides, np.where(expected > 0, INSIDE, OUTSIDE))


def test_powers_of_letters_are_lifted():
    points = np.random.default_rng(5).uniform(-1, 1, (3, 16))
    kernels = kernels_of(rsym.conjunction(a**3 * x + a**5 / 7, y + a**-2), {a: 2.0}, {"a": 1.5})
    expected = np.minimum(1.5**3 * points[0] + 1.5**5 / 7, points[1] + 1.5**-2)
    np.testing.assert_array_equal(values(kernels, points) > 0, expected > 0)


def test_a_letter_may_be_a_leaf_by_itself():
    points = np.random.default_rng(7).uniform(-1, 1, (3, 16))
    kernels = kernels_of(rsym.disjunction(x - sp.Rational(1, 2), a, y - b), {a: 1.0, b: 0.5}, {"a": -2.0})
    expected = np.max([points[0] - 0.5, np.full(16, -2.0), points[1] - 0.5], axis=0)
    np.testing.assert_array_equal(values(kernels, points) > 0, expected > 0)


def test_the_sign_picture_keeps_what_is_undefined():
    """A disc or what is undefined left of an axis: outside there everywhere, not only near the circle."""
    shape = rsym.Shape(rsym.disjunction(1 - x**2 - y**2, without_value(-x) - 4), (x, y))
    lattice = lattice_over(((-1.5, 1.5), (-1.5, 1.5)), 60, math.inf)
    u, v = np.meshgrid(
        *(o + h * np.arange(n) for o, h, n in zip(lattice.origin, lattice.spacing, lattice.counts, strict=True)),
        indexing="ij",
    )
    inside = (u >= 0) & (u**2 + v**2 <= 1)
    np.testing.assert_array_equal(signs_on(shape, lattice), np.where(inside, 1, -1))


def test_the_value_keeps_what_is_undefined():
    """Of max(min(undefined, -1 - x**2), 9) the first operand is below the second in the whole box."""
    formula = rsym.disjunction(rsym.conjunction(without_value(-x) + 1, -1 - z**2), 9 + y)
    points = np.random.default_rng(11).uniform(-1, 1, (3, 400))
    found = values(kernels_of(formula, {}), points)
    np.testing.assert_array_equal(np.isnan(found), points[0] < 0)


def test_a_box_with_something_undefined_is_kept():
    kernels = kernels_of(rsym.disjunction(without_value(-x), 9 + y), {})
    ends = ends_around(np.array([[-0.5, 0.5, 0.0], [0.0] * 3, [0.0] * 3]), 0.1)
    sides, _ = kernels.sides(ends, np.zeros(3, np.int64), None, one_by_one)
    assert sides.tolist() == [KEPT, INSIDE, KEPT]


def test_beyond_the_end_of_a_domain_the_partner_decides():
    kernels = kernels_of(rsym.disjunction(sp.log(x), 9 + y), {})
    ends = ends_around(np.array([[-0.5, 0.5, 0.0], [0.0] * 3, [0.0] * 3]), 0.1)
    sides, _ = kernels.sides(ends, np.zeros(3, np.int64), None, one_by_one)
    assert sides.tolist() == [INSIDE] * 3
    shape = rsym.Shape(rsym.disjunction(1 - x**2 - y**2, sp.sqrt(x) - sp.Rational(7, 5)), (x, y))
    lattice = lattice_over(((-1.5, 1.5), (-1.5, 1.5)), 60, math.inf)
    disc = shape.replace(expression=1 - x**2 - y**2)
    np.testing.assert_array_equal(signs_on(shape, lattice), signs_on(disc, lattice))


def test_zero_and_minus_zero_are_two_letters():
    kernels = kernels_of(rsym.conjunction(y + 1 / a, x + 3), {a: 1.0})
    for letter, sign in ((0.0, 1), (-0.0, -1), (0.0, 1)):
        kernels.set({"a": letter}, CUBE)
        assert np.sign(values(kernels, np.zeros((3, 8)))).tolist() == [sign] * 8


def test_letters_of_another_thread_are_not_taken():
    """The other one sets its letters while this one compares."""
    kernels = kernels_of(rsym.conjunction(x + a, y + 3), {a: 1.0})
    other = kernels.copy()

    class Meeting(float):
        def __eq__(self, another):
            other.set({"a": 2.0}, CUBE)
            return float(self) == another

        __hash__ = float.__hash__

    for _ in range(2):
        kernels.set({"a": 1.0}, ((Meeting(-1.0), 1.0), *CUBE[1:]))
        assert values(kernels, np.zeros((3, 8))).tolist() == [1.0] * 8


@pytest.mark.parametrize("make", [region_kernels, mesher_kernels])
def test_kernels_of_another_system_do_not_bring_its_parameters(make):
    """The forms are the same min; one has no parameter, that of the other is a letter."""
    shapes = [
        rsym.Shape(rsym.conjunction(x + a, y, system=system), (x, y, z), letters={a: 0.5})
        for system in (rsym.R0, rsym.RAlpha(a))
    ]
    first, second = (make(surface_form(shape)) for shape in shapes)
    first.set({"a": 3.0}, CUBE)
    with pytest.raises(RsymError, match="out of its range"):
        second.set({"a": 3.0}, CUBE)
