"""Enclosures of fields over boxes: against compiled kernels at points, and against ranges known in closed form."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y
from rsym.bounds.enclosures import BACKENDS

a = sp.Symbol("a", real=True)
CORNER = Shape(rsym.conjunction(x, y), (x, y))
STRIP = Shape((a**2 - x**2) / (2 * a), (x, y), letters={a: rsym.Letter(5, minimum=1)})
ENCLOSED = ("value", "normalised", "laplacian", "normalised_laplacian", "curvature", "gradient", "hessian")


def boxes_of(rng, count, size=0.3, dimension=2):
    low = rng.uniform(-3, 3, (count, dimension))
    return np.stack([low, low + size * rng.random((count, dimension))], axis=-1)


@pytest.mark.random
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("shape", [rsym.paper.skeleton_body(), CORNER], ids=["skeleton", "corner"])
def test_what_a_kernel_computes_lies_in_its_enclosure(shape, backend):
    rng = np.random.default_rng(5)
    boxes = boxes_of(rng, 60)
    bounds, kernel = rsym.enclose(shape, boxes, ENCLOSED, backend=backend), rsym.compile(shape, ENCLOSED)
    for _ in range(5):
        points = boxes[..., 0] + rng.random((60, 2)) * (boxes[..., 1] - boxes[..., 0])
        for name, values in kernel(*points.T).items():
            low, high = np.moveaxis(bounds[name], -1, 0)
            rounding = 1e-11 * (1 + np.abs(values))
            assert bounds[name].shape == (*values.shape, 2)
            assert (np.isnan(values) | ((values >= low - rounding) & (values <= high + rounding))).all(), name


@pytest.mark.parametrize("backend", BACKENDS)
def test_exact_ranges(backend):
    """The conjunction is monotone: its range is spanned by its values at two corners."""
    boxes = [[[[-1.0, 2.0], [0.5, 3.0]], [[3.0, 3.0], [4.0, 4.0]]]]
    low, high = rsym.enclose(CORNER, boxes, backend=backend)["value"][0].T
    assert_close(low, [-0.5 - math.sqrt(1.25), 2], rtol=1e-8)
    assert_close(high, [5 - math.sqrt(13), 2], rtol=1e-8)
    versine = rsym.enclose(CORNER, [[0.0, 1.0], [1.0, 2.0]], "gradient", backend=backend)["gradient"]
    assert_close(versine, [[1 - 1 / math.sqrt(2), 1], [0, 1 - 1 / math.sqrt(2)]], atol=1e-8)


def test_ends_are_rounded_outward():
    third = Shape(x / 3, (x, y))
    low, high = rsym.enclose(third, [[1.0, 1.0], [0.0, 0.0]])["value"]
    assert low < high == np.nextafter(low, 1)
    assert sp.Rational(low) < sp.Rational(1, 3) < sp.Rational(high)
    large = rsym.enclose(Shape(sp.exp(x), (x, y)), [[1000.0, 1000.0], [0.0, 0.0]])["value"]
    assert large.tolist() == [np.finfo(float).max, math.inf]


@pytest.mark.parametrize("backend", BACKENDS)
def test_letters_are_numbers_or_ranges(backend):
    """(a**2 - 1)/(2 a) grows with a, from 0 at 1."""
    box = [[1.0, 1.0], [0.0, 0.0]]
    assert_close(rsym.enclose(STRIP, box, backend=backend)["value"], [2.4, 2.4], rtol=1e-12)
    assert_close(rsym.enclose(STRIP, box, letters={"a": 2}, backend=backend)["value"], [0.75, 0.75], rtol=1e-12)
    low, high = rsym.enclose(STRIP, box, letters={a: (2, 4)}, backend=backend)["value"]
    assert low <= 0.75 < 1.875 <= high
    assert rsym.enclose(STRIP, box, letters={a: (sp.Rational(5, 2), 3.0)}, backend=backend)["value"][0] > 0


def test_undefined_and_unbounded():
    root = Shape(sp.sqrt(x) / y, (x, y))
    bounds = rsym.enclose(root, [[[-2.0, -1.0], [1.0, 2.0]], [[1.0, 2.0], [-1.0, 1.0]]])["value"]
    assert np.isnan(bounds[0]).all()
    assert bounds[1].tolist() == [-math.inf, math.inf]


@pytest.mark.parametrize(
    ("code", "arguments"),
    [
        ("array", {"boxes": [0.0, 1.0]}),
        ("array", {"boxes": [[0.0, 1.0]]}),
        ("array", {"boxes": [[1.0, 0.0], [0.0, 1.0]]}),
        ("array", {"boxes": [[0.0, math.inf], [0.0, 1.0]]}),
        ("unknown-field", {"fields": ("colour",)}),
        ("unknown-field", {"fields": ("singular",)}),
        ("unknown-backend", {"backend": "taylor"}),
        ("unknown-letter", {"letters": {"b": 1}}),
        ("number", {"letters": {"a": (3, 2)}}),
        ("number", {"letters": {"a": (1, 2, 3)}}),
        ("number", {"letters": {"a": "5"}}),
        ("letter-range", {"letters": {"a": (0.5, 2)}}),
    ],
)
def test_what_is_refused(code, arguments):
    with pytest.raises(RsymError) as refusal:
        rsym.enclose(STRIP, **({"boxes": [[0.0, 1.0], [0.0, 1.0]]} | arguments))
    assert refusal.value.code == code


def test_both_backends_enclose_the_same_values():
    """Two sound bounds of one range overlap; and neither is much the wider here."""
    boxes = boxes_of(np.random.default_rng(6), 40)
    first, second = (rsym.enclose(rsym.paper.skeleton_body(), boxes, backend=name)["value"] for name in BACKENDS)
    assert (first[:, 0] <= second[:, 1]).all()
    assert (second[:, 0] <= first[:, 1]).all()
    assert_close(first, second, atol=1e-2)
