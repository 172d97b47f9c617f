"""Bounds over boxes: containment against sixty digits, exact images, whole lines, the same bits everywhere."""

import numpy as np
import pytest
import sixty_digits
from test_backends import BACKENDS, OPERATION_NAMES, PARAMETRISED, single

from rsym.codegen.interpreter import interpret
from rsym.codegen.interval_images import IMAGES
from rsym.codegen.intervals import IntervalFunction
from rsym.codegen.operations import OPERATIONS

INFINITE = (-np.inf, np.inf)


def random_boxes(generator, dimension, count, size):
    """Boxes around points of all magnitudes, some flat, some touching 0 or symmetric about it."""
    centre = generator.normal(size=(dimension, count)) * 2.0 ** generator.integers(-4, 3, (dimension, count))
    width = size * generator.random((dimension, count)) * (generator.random((dimension, count)) < 0.9)
    lower, upper = centre - width, centre + width
    lower[generator.random((dimension, count)) < 0.05] = 0.0
    upper = np.maximum(upper, lower)
    return lower, upper


def interior(generator, lower, upper):
    """A point of each box; some at corners."""
    share = generator.random(lower.shape)
    share = np.where(generator.random(lower.shape) < 0.3, np.round(share), share)
    return np.clip(lower + share * (upper - lower), lower, upper)


def escapes(program, generator, count, *, size=1.0, points=1, letters=None, backend="llvm", function=None):
    """Points whose value is outside the bounds, and how many had a value."""
    lower, upper = random_boxes(generator, len(program.coordinates), count, size)
    ranges = letters or {}
    ranges = {name: ranges.get(name, (1.0, 1.0)) for name in program.letters}
    bounds = (function or IntervalFunction(program, backend, 1))(list(lower), list(upper), ranges)
    wrong, seen = [], 0
    for _ in range(points):
        inside = interior(generator, lower, upper)
        for k in range(count):
            inputs = dict(zip(program.coordinates, map(float, inside[:, k]), strict=True))
            inputs |= {name: float(generator.uniform(*ends)) for name, ends in ranges.items()}
            for name, value in sixty_digits.values(program, inputs).items():
                low, high = (float(end[k]) for end in bounds[name])
                assert not np.isnan(low + high) or (low, high) == INFINITE
                if value is not None:
                    seen += 1
                    if not low <= value <= high:
                        wrong.append((name, inputs, low, high, value))
    return wrong, seen


def degenerate(program, columns, backend, letters=()):
    return IntervalFunction(program, backend, 1)(columns, columns, letters)["value"]


def test_every_operation_has_an_image():
    assert set(IMAGES) | {"input", "select"} == set(OPERATIONS)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_the_shared_suite_lies_within_the_bounds(operation, backend):
    program, columns = single(operation)
    expected = np.broadcast_to(
        interpret(program, dict(zip(program.coordinates, columns, strict=True)))["value"], columns[0].shape
    )
    lower, upper = degenerate(program, columns, backend)
    known = ~np.isnan(expected)
    assert not np.isnan(lower).any()
    assert not np.isnan(upper).any()
    assert ((lower <= expected) & (expected <= upper))[known].all()


@pytest.mark.parametrize("letter", [False, True])
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("operation", "parameter"), PARAMETRISED)
def test_the_shared_suite_with_a_parameter_lies_within_the_bounds(operation, parameter, backend, letter):
    program, columns = single(operation, parameter, letter)
    inputs = dict(zip(program.coordinates, columns, strict=True), parameter=float(parameter))
    expected = np.broadcast_to(interpret(program, inputs)["value"], columns[0].shape)
    lower, upper = degenerate(program, columns, backend, [float(parameter)] * letter)
    known = ~np.isnan(expected)
    assert not np.isnan(lower).any()
    assert not np.isnan(upper).any()
    assert ((lower <= expected) & (expected <= upper))[known].all()


@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_containment_of_an_operation(operation):
    program, _ = single(operation)
    wrong, seen = escapes(program, np.random.default_rng(4), 120)
    assert not wrong
    assert seen or operation == "undefined"


@pytest.mark.parametrize(("operation", "parameter"), PARAMETRISED)
def test_containment_of_an_operation_with_a_parameter(operation, parameter):
    """The parameter a number, and any number of an interval around it."""
    generator = np.random.default_rng(5)
    program, _ = single(operation, parameter)
    wrong, seen = escapes(program, generator, 30)
    program, _ = single(operation, parameter, letter=True)
    around = {"parameter": (float(parameter) - 0.375, float(parameter) + 0.5)}
    more, others = escapes(program, generator, 60, letters=around)
    assert not wrong + more
    assert seen + others
