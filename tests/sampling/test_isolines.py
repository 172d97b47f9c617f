"""Lines in arrays are those of scikit-image, to the bit, which goes from square to square."""

import numpy as np
import pytest
from skimage.measure import find_contours

from rsym.sampling import isolines
from rsym.sampling.isolines import index_lines


def arrays(kind):
    """Arrays of many sizes and a level: with saddles, NaN, entries on the level, signs alone."""
    generator = np.random.default_rng(20260711)
    for _ in range(150):
        size = generator.integers(2, 24, 2)
        values = generator.normal(size=size)
        if kind == "waves":
            u, v = np.meshgrid(np.linspace(0, 9, size[1]), np.linspace(0, 4, size[0]))
            values = np.sin(u + generator.uniform()) * np.cos(v) + generator.uniform(-0.5, 0.5)
        elif kind == "holes":
            values[generator.random(size) < 0.1] = np.nan
        elif kind == "signs":
            values = np.sign(values)
        elif kind == "steps":
            values = np.round(2 * values)
        yield values, 0.0 if kind in {"signs", "steps"} else float(generator.normal() / 4)


@pytest.mark.parametrize("kind", ["noise", "waves", "holes", "signs", "steps"])
def test_lines_of_an_array(monkeypatch, kind):
    if kind != "steps":  # their lines meet in entries, and how they go on there is left to scikit-image
        monkeypatch.setattr(isolines, "find_contours", None)
    count = 0
    for values, level in arrays(kind):
        lines, expected = index_lines(values, level), find_contours(values, level)
        assert [line.tolist() for line in lines] == [line.tolist() for line in expected]
        count += len(lines)
    assert count > 300


def test_infinite_entries_and_arrays_without_lines():
    for values in (np.array([[np.inf, 0.0], [0.0, 1.0]]), np.zeros((3, 3)), np.full((2, 2), np.nan)):
        lines, expected = index_lines(values, 0.5), find_contours(values, 0.5)
        assert len(lines) == len(expected)
        for line, other in zip(lines, expected, strict=True):
            np.testing.assert_array_equal(line, other)
