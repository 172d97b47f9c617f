"""Bounds over boxes: containment against sixty digits, exact images, whole lines, the same bits everywhere."""

import itertools
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from backends.test_backends import BACKENDS, OPERATION_NAMES, PARAMETRISED, single
from hypothesis import Phase, given, seed, settings
from hypothesis import strategies as st
from oracles import sixty_digits
from oracles.closeness import assert_close
from oracles.tiers import examples
from oracles.trees import trees, x, y, z

import rsym
from rsym.backends.interpreter import interpret
from rsym.backends.llvm_code import LlvmFunction
from rsym.bounds import interval_arithmetic, interval_monotone
from rsym.bounds.box_images import IMAGES
from rsym.bounds.intervals import IntervalFunction
from rsym.model.systems import R0, R1, R0m, RAlpha, Rp
from rsym.program.builder import Builder
from rsym.program.fields import program_of
from rsym.program.operations import OPERATIONS

a = sp.Symbol("a", real=True)
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


def escapes(program, generator, count, *, size=1.0, points=1, letters=None, backend="numpy", function=None):
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
    assert all(IMAGES[operation] for operation in set(OPERATIONS) - {"input", "select"})


def assert_within(program, columns, inputs, backend, letters=()):
    """Boxes of one point: the plain meaning lies within the bounds wherever there is one, and no bound is NaN."""
    expected = np.broadcast_to(interpret(program, inputs)["value"], columns[0].shape)
    lower, upper = degenerate(program, columns, backend, letters)
    assert not np.isnan(lower).any()
    assert not np.isnan(upper).any()
    known = ~np.isnan(expected)
    assert ((lower <= expected) & (expected <= upper))[known].all()


@pytest.mark.random
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_the_shared_suite_lies_within_the_bounds(operation, backend):
    program, columns = single(operation)
    assert_within(program, columns, dict(zip(program.coordinates, columns, strict=True)), backend)


@pytest.mark.random
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("operation", "parameter"), PARAMETRISED)
def test_the_shared_suite_with_a_parameter_lies_within_the_bounds(operation, parameter, backend):
    """A number in the generated source, a letter in the compiled code."""
    letter = backend == "llvm"
    program, columns = single(operation, parameter, letter)
    inputs = dict(zip(program.coordinates, columns, strict=True), parameter=float(parameter))
    assert_within(program, columns, inputs, backend, [float(parameter)] * letter)


@pytest.mark.random
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_containment_of_an_operation(operation):
    program, _ = single(operation)
    wrong, seen = escapes(program, np.random.default_rng(4), 120, points=2, backend="llvm")
    assert not wrong
    assert seen or operation == "undefined"


@pytest.mark.random
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


LEAVES = (
    rsym.trimming(y, 1 - x**2 / 4),
    rsym.joining(x, y - 1),
    rsym.equivalence(x + y, x - z),
    (1 - x**2 - y**2) / sp.sqrt((1 - x**2 - y**2) ** 2 + 4 * x**2 + 4 * y**2),
    abs(x) - z,
    sp.sin(x * y),
    sp.Min(x, a * y),
    sp.sqrt(x**2 + y**2) - a,
    sp.Piecewise((x, x > y), (y**3, True)),
)
SYSTEMS = (R0, R1, RAlpha(sp.Rational(1, 2)), RAlpha(a), R0m(2), Rp(4), Rp(3))


@pytest.mark.slow
@pytest.mark.parametrize("fields", [("value",), ("value", "gradient", "hessian")], ids=["values", "derivatives"])
def test_containment_of_trees(fields):
    """Random R-trees over all systems and leaves, their derivatives, a letter that is a number or an interval."""
    seen = []

    @seed(7)
    @given(trees(SYSTEMS, 4 if len(fields) > 1 else 9, LEAVES), st.integers(0, 2**20))
    @settings(max_examples=examples(25), deadline=None, database=None, phases=[Phase.generate])
    def check(tree, number):
        generator = np.random.default_rng(number)
        shape = rsym.Shape(tree, (x, y, z), letters={a: 1} if tree.has(a) else None)
        ranges = {"a": (0.5, 1.0) if number % 2 else (0.75, 0.75)}
        size = float(generator.choice([1.0, 0.1, 1e-3, 1e-8]))
        wrong, count = escapes(program_of(shape, fields), generator, 12, size=size, letters=ranges, backend="numpy")
        assert not wrong
        seen.append(count)

    check()
    assert sum(seen) > (1000 if len(fields) > 1 else 250)


def span(program, lower, upper):
    """The least and the largest value at the corners, at the zeros and in the middle of a box."""
    sides = [
        sorted({low, high, (low + high) / 2, min(max(0.0, low), high)}) for low, high in zip(lower, upper, strict=True)
    ]
    values = [
        sixty_digits.values(program, dict(zip(program.coordinates, point, strict=True)))["value"]
        for point in itertools.product(*sides)
    ]
    known = [value for value in values if value is not None] or [-mpmath.inf, mpmath.inf]
    return min(known), max(known)


MONOTONE = [
    *((name, None) for name in ("r0_conjunction", "r0_disjunction", "versine", "gap", "trimming", "normalised")),
    *((name, None) for name in ("sqrt", "abs", "sign", "min", "max", "exp", "powi", "mul")),
    *(
        case
        for case in PARAMETRISED
        if case[0] not in {"r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"}
    ),
]


@pytest.mark.random
@pytest.mark.parametrize(("operation", "parameter"), MONOTONE)
def test_images_are_exact_where_an_operation_is_monotone(operation, parameter):
    """No wider than the values at corners, zeros and middles by more than 1e-13 of the largest number about."""
    program, _ = single(operation, parameter)
    lower, upper = random_boxes(np.random.default_rng(11), len(program.coordinates), 24, 1.0)
    for first, position in (("sqrt", 0), ("trimming", 0), ("normalised", 1)):
        if operation == first:
            lower[position] = np.abs(lower[position])
            upper[position] = lower[position] + 1
    low, high = IntervalFunction(program, "numpy")(list(lower), list(upper))["value"]
    for k in range(lower.shape[1]):
        least, largest = span(program, lower[:, k], upper[:, k])
        if np.isfinite([low[k], high[k]]).all():
            tolerance = 1e-13 * float(1 + max(abs(least), abs(largest), np.abs(upper).max()))
            assert least - low[k] <= tolerance
            assert high[k] - largest <= tolerance
        else:
            assert operation in {"absolute_power", "signed_power"}
            assert (lower[:, k] <= 0).any()


def bounds_of(expression, *sides, letters=None, ranges=(), backend="numpy"):
    """Bounds of an expression of x and y over one box and of its letters over theirs."""
    sides = [*sides, (0.0, 1.0), (0.0, 1.0)][:2]
    function = IntervalFunction(program_of(rsym.Shape(expression, (x, y), letters=letters), ("value",)), backend, 1)
    lower, upper = function([low for low, _ in sides], [high for _, high in sides], ranges)["value"]
    return float(lower), float(upper)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("expression", "side"),
    [
        (1 / x, (-1.0, 1.0)),
        (1 / x, (0.0, 1.0)),
        ((x + 1) / sp.sqrt(x), (0.0, 1.0)),
        (sp.exp(x) - sp.exp(x + 1), (800.0, 900.0)),
        (x**2 - x**4, (1e200, 1e200)),
        (sp.sqrt(x), (-2.0, -1.0)),
        (sp.log(x) + 1, (-2.0, -1.0)),
        (1 + sp.Min(sp.log(x), y), (-2.0, -1.0)),
        (sp.Piecewise((1, sp.log(x) > 0), (2, True)) + sp.sqrt(x), (-2.0, -1.0)),
        (x + y, (np.nan, np.nan)),
    ],
)
def test_where_nothing_can_be_said_the_bounds_are_infinite(expression, side, backend):
    assert bounds_of(expression, side, backend=backend) == INFINITE


@pytest.mark.parametrize("backend", BACKENDS)
def test_overflow_stays_within_the_bounds(backend):
    """The square of 1e200 is a number, larger than float64 can hold."""
    low, high = bounds_of(x**2, (1e200, 1e200), backend=backend)
    assert low < 1.8e308
    assert high == np.inf
    low, high = bounds_of(-(x**2), (1e200, 1e200), backend=backend)
    assert low == -np.inf
    assert high > -1.8e308
    low, high = bounds_of(rsym.conjunction(x, y), (1e200, 1e200), (1e200, 1e200), backend=backend)
    assert low <= 0.58e200
    assert high >= 0.59e200


def test_part_of_a_box_outside_the_domain():
    low, high = bounds_of(sp.sqrt(x), (-1.0, 4.0))
    assert low == 0
    assert 2 <= high < 2 + 1e-14
    low, high = bounds_of(sp.log(x), (-1.0, 1.0))
    assert low == -np.inf
    assert 0 <= high < 1e-13
    assert bounds_of(x / abs(x), (-1.0, 1.0)) == (-1, 1)


def test_an_undefined_comparison_counts_as_false():
    """select(sqrt(x) > 1/2, 1, 2) is 2 where x is negative."""
    builder = Builder(("x",), ())
    root = builder.sqrt(builder.input("x"))
    node = builder.select(root, builder.const(Fraction(1, 2)), builder.const(1), builder.const(2))
    function = IntervalFunction(builder.program({"value": node}), "numpy")
    lower, upper = function([[-1.0, 1.0, -1.0]], [[4.0, 4.0, 0.1]])["value"]
    assert (lower[0], upper[0]) == (1, 2)
    assert lower[1] == 1
    assert upper[2] == 2


def test_letters_are_numbers_or_intervals():
    expression, letters = a * x - sp.Rational(1, 3), {a: 1}
    bounds = bounds_of(expression, (1.0, 2.0), letters=letters, ranges=[(3, 4)])
    assert_close(bounds, [8 / 3, 23 / 3], atol=1e-13)
    assert bounds == bounds_of(expression, (1.0, 2.0), letters=letters, ranges={"a": (3, 4)})
    low, high = bounds_of(a + 0 * x, letters=letters, ranges=[Fraction(1, 10)])
    assert Fraction(low) < Fraction(1, 10) < Fraction(high)
    expression, point = rsym.conjunction(x, y, system=RAlpha(a)), ((1.0, 1.0), (1.0, 1.0))
    assert_close(bounds_of(expression, *point, letters=letters, ranges=[(0, 1)]), [2 - 2**0.5, 1], atol=1e-13)
    assert bounds_of(expression, *point, letters=letters, ranges=[(2, 3)]) == INFINITE


def test_ranges_of_letters_may_differ_from_box_to_box():
    """Also those of a parameter of an R-operation: on f = g = 1 a conjunction is 2/(2 + sqrt(2 - 2 alpha))."""
    shape = rsym.Shape(rsym.conjunction(x, y, system=RAlpha(a)), (x, y), letters={a: 1})
    program = program_of(shape, ("value",)).varying(["a"])
    ends = np.array([0.0, 0.5, 0.5]), np.array([0.5, 0.5, 1.0])
    lower, upper = IntervalFunction(program, "numpy")([1.0, 1.0, ends[0]], [1.0, 1.0, ends[1]])["value"]
    for bound, alpha in zip((lower, upper), ends, strict=True):
        assert_close(bound, 2 / (2 + np.sqrt(2 - 2 * alpha)), atol=1e-13)


def arithmetic_program():
    """Without sin, cos, exp, log, pow, atan2."""
    tree = rsym.disjunction(
        rsym.conjunction(1 - x**2 - y**2, x - a * y, 2 - z / (x**2 + 1)), rsym.trimming(y, z - x), abs(z) / 3 - x * y
    )
    return program_of(rsym.Shape(tree, (x, y, z), letters={a: 1}), ("value", "gradient"))


@pytest.mark.random
@pytest.mark.parametrize("block", [8, 1000, None])
def test_the_same_bits_from_every_backend_block_and_thread(block, monkeypatch):
    program = arithmetic_program()
    lower, upper = random_boxes(np.random.default_rng(2), 3, 1503, 1.0)
    arguments = list(lower), list(upper), [(0.5, 0.75)]
    reference = IntervalFunction(program, "numpy", 1)(*arguments)
    if block:
        monkeypatch.setattr(LlvmFunction, "block_size", block)
    for backend, threads in (("llvm", 1), ("llvm", 3), ("numpy", 2)):
        for name, ends in IntervalFunction(program, backend, threads)(*arguments).items():
            for end, expected in zip(ends, reference[name], strict=True):
                assert np.array_equal(end.view("i8"), expected.view("i8"))


@pytest.mark.slow
def test_the_car_is_discarded_as_by_exact_images():
    """Of 32**3 boxes 5436 may meet the surface by exact images (measured apart); with roots written out, all."""
    car = rsym.paper.car()
    axes = [np.linspace(low, high, 33) for low, high in ((-8, 8), (-16, 17.5), (-4, 9))]
    lower, upper = (
        np.meshgrid(*(axis[part] for axis in axes), indexing="ij") for part in (slice(None, -1), slice(1, None))
    )
    letters = {name: float(letter.default) for name, letter in car.letters.items()}
    low, high = IntervalFunction(program_of(car, ("value",)), "numpy")(lower, upper, letters)["value"]
    assert 4000 < ((low <= 0) & (high >= 0)).sum() <= 5436


@pytest.mark.parametrize("operation", ["add", "mul", "sqrt", "r0_conjunction", "trimming", "versine"])
def test_without_its_margin_an_operation_escapes(operation, monkeypatch):
    """Red proof: rounding to nearest alone does not enclose."""
    for module in (interval_arithmetic, interval_monotone):
        monkeypatch.setattr(module, "margin", lambda b, v, error, tiny: b.const(0))
    program, _ = single(operation)
    wrong, _ = escapes(program, np.random.default_rng(4), 120, size=1e-3, backend="numpy")
    assert wrong


def test_wrong_input_is_refused():
    program = program_of(rsym.Shape(a * x + y, (x, y), letters={a: 1}), ("value",))
    function = IntervalFunction(program, "numpy")
    for arguments, code in [
        (([0.0], [1.0], [1]), "arity"),
        (([0.0, 2.0], [1.0, 1.0], [1]), "box"),
        (([0.0, 0.0], [1.0, 1.0]), "letters"),
        (([0.0, 0.0], [1.0, 1.0], {"b": 1}), "letters"),
        (([0.0, 0.0], [1.0, 1.0], [1, 2]), "letters"),
        (([0.0, 0.0], [1.0, 1.0], [(2, 1)]), "letters"),
    ]:
        with pytest.raises(rsym.RsymError) as error:
            function(*arguments)
        assert error.value.code == code


def enclosed(expression, *sides):
    """The interval of an expression over a box of x and y."""
    function = IntervalFunction(program_of(rsym.Shape(expression, (x, y)), ("value",), share=None), "numpy")
    low, high = function(*([np.array([side[end]]) for side in sides] for end in (0, 1)))["value"]
    return float(low[0]), float(high[0])


def test_the_cut_of_an_angle_is_none_where_turns_or_signs_do_not_count():
    """About (-10, 0) the angle is pi but for 0.01; pi +- 0.01 thrice, its cosine is within 0.03^2/2 of -1."""
    angle, about = sp.atan2(y, x), ((-10.05, -9.95), (-0.1, 0.1))
    assert enclosed(angle, *about)[0] < -3.1  # the cut is there
    low, high = enclosed(angle**2, *about)
    assert np.pi**2 - 0.1 < low < high < np.pi**2 + 0.1
    low, high = enclosed(sp.cos(3 * angle - sp.Rational(1, 10) + sp.Rational(1, 10) * x**0), *about)
    assert -1 <= low < high < -1 + 1e-3
    assert enclosed(sp.sin(2 * angle), *about)[1] < 0.05
    low, high = enclosed(sp.cos(angle / 2), *about)  # half turns do count
    assert (low < 0.01, high > 0.5) == (True, True)
