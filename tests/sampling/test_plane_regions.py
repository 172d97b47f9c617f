"""Signs and values on plane lattices by regions, against NumPy's reading of texts and against kernels that see all."""

import math

import matplotlib.figure
import numpy as np
import pytest
import sympy as sp
from oracles.line_texts import lettering, lines_of, numbers_of

import rsym
from rsym import x, y, z
from rsym.sampling.lattice import lattice_over
from rsym.sampling.plane import plane_sampler, plane_view, signs_of
from rsym.sampling.plane_regions import signs_on, value_kernels


@pytest.fixture(scope="module")
def text():
    made = lettering(14, 16)
    assert len(lines_of(made)) >= 5000
    return made


@pytest.fixture(scope="module")
def letters(text, tmp_path_factory):
    path = tmp_path_factory.mktemp("texts") / "letters.vm"
    path.write_text(text)
    return rsym.load(path)


def box_of(shape):
    return shape.bounds or ((-1.0, 1.0), (-1.0, 1.0))


def points_of(lattice):
    return np.stack(np.meshgrid(*(lattice.axis(k) for k in range(2)), indexing="ij"))


@pytest.mark.parametrize("cells", [2, 100, (130, 67)])
def test_signs_of_a_text_are_those_of_numpy(text, letters, cells):
    lattice = lattice_over(box_of(letters), cells, math.inf)
    points = points_of(lattice)
    expected = numbers_of(text, points.reshape(2, -1)).reshape(points.shape[1:]) <= 0
    signs = signs_on(letters, lattice)
    assert signs.dtype == np.int8
    np.testing.assert_array_equal(signs == 1, expected)
    assert expected.any() == (signs == 1).any()


def test_signs_do_not_depend_on_threads(letters):
    lattice = lattice_over(box_of(letters), 300, math.inf)
    np.testing.assert_array_equal(signs_on(letters, lattice, threads=1), signs_on(letters, lattice, threads=2))


def test_values_of_a_text_are_those_of_its_kernel_to_the_bit(letters):
    assert value_kernels(letters) is not None
    sampler = plane_sampler(letters, "value", resolution=90, bounds=box_of(letters))
    assert sampler.regions is not None
    np.testing.assert_array_equal(sampler.values(), sampler.samples()["value"])


def test_values_are_undefined_where_a_kernel_has_none_or_infinite_ones(letters):
    both = rsym.disjunction(letters.expression, sp.exp(1000 * x) - 2, sp.sqrt(x + 0.9) - 1, system=rsym.R1)
    shape = rsym.Shape(both, (x, y), bounds=((-1.0, 1.0), (-0.5, 0.5)))
    sampler = plane_sampler(shape, "value", resolution=61)
    assert sampler.regions is not None
    values = sampler.values()
    np.testing.assert_array_equal(values, sampler.samples()["value"])
    points = points_of(sampler.lattice)[0]
    np.testing.assert_array_equal(np.isnan(values), (points < -0.9) | (points > math.log(np.finfo(float).max) / 1000))


def test_level_lines_of_a_text_are_closed_and_lie_on_the_level(text, letters):
    # The ring of a dot is as wide as its radius: in its middle the hole is one point, where the text is 0.
    dots = [(row, column) for row in range(14) for column in range(16) if (row + 5 * column) % 6 == 2]
    centres = [((7 * column - 53) / 56, (9 * row - 56.5) / 70) for row, column in dots]
    with pytest.warns(rsym.RsymWarning, match="Unresolved"):
        lines = rsym.level_lines(letters, resolution=256, bounds=box_of(letters))
    assert lines.status.unseen == len(dots)
    assert np.abs(np.subtract(centres, lines.status.places[0])).max(axis=1).min() < lines.status.finer
    assert lines.status.open == 0
    points = np.concatenate(list(lines)).T
    distance = np.abs(numbers_of(text, points))
    assert np.quantile(distance, 0.9) < 1e-9


@pytest.mark.parametrize("model", ["skeleton", "clip", "snowflake", "streamlined"])
def test_signs_are_those_of_the_values_of_a_kernel(model):
    shape = rsym.load(model)
    section = {shape.coordinates[2]: 0.05} if shape.dimension == 3 else None
    view = plane_view(shape, 77, section=section)
    sampler = plane_sampler(shape, "value", resolution=77, section=section)
    assert view.lattice == sampler.lattice
    np.testing.assert_array_equal(signs_of(view) == 1, sampler.samples()["value"] >= 0)


def test_in_a_hole_of_the_domain_what_has_a_value_decides():
    shape = rsym.Shape(rsym.disjunction(sp.sqrt(x), y), (x, y))
    lattice = lattice_over(((-1, 1), (-1, 1)), 40, math.inf)
    u, v = points_of(lattice)
    off = (u != 0) & (v != 0)
    np.testing.assert_array_equal(signs_on(shape, lattice)[off], np.where((u > 0) | (v > 0), 1, -1)[off])


def test_what_has_no_value_is_outside():
    shape = rsym.Shape(x ** (y**2 + sp.Rational(1, 2)), (x, y))
    lattice = lattice_over(((-1, 1), (-1, 1)), 40, math.inf)
    signs = signs_on(shape, lattice)
    grid = points_of(lattice)
    assert (signs[grid[0] < 0] == -1).all()
    assert (signs[grid[0] > 0] == 1).all()


def test_letters_move_the_sign():
    r = sp.Symbol("r", real=True)
    disc = rsym.Shape(r - x**2 - y**2, (x, y), letters={r: 1})
    lattice = lattice_over(((-2, 2), (-2, 2)), 60, math.inf)
    area = [(signs_on(disc, lattice, {"r": value}) == 1).sum() * math.prod(lattice.spacing) for value in (1.0, 2.0)]
    assert area == pytest.approx([math.pi, 2 * math.pi], rel=0.03)


def test_a_picture_of_a_sign_has_two_colours_and_no_levels():
    disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-1.5, 1.5)))
    ax = matplotlib.figure.Figure().add_subplot()
    image = rsym.plot_field(disc, "sign", ax=ax, resolution=64)
    pixels = image.get_array()
    left, right, below, above = image.get_extent()
    column, row = (np.array([0.9, -0.3]) - (left, below)) / (right - left, above - below)
    assert pixels[int(row * pixels.shape[0]), int(column * pixels.shape[1])] == 1
    assert pixels[0, 0] == -1
    assert set(np.unique(pixels)) == {-1, 1}
    with pytest.raises(rsym.RsymError, match="two colours"):
        rsym.plot_field(disc, "sign", ax=ax, levels=[0, 1])
    ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1, 1),) * 3)
    with pytest.raises(rsym.RsymError, match="section"):
        rsym.plot_field(ball, "sign", ax=ax)
