"""The shared suite: every operation, over awkward arguments, on every backend, against its plain meaning."""

import itertools
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from rsym.backends.interpreter import interpret, interpret_nodes
from rsym.backends.llvm_code import LlvmFunction
from rsym.backends.numpy_backend import NumpyFunction
from rsym.backends.tape import TapeFunction
from rsym.program.builder import Builder
from rsym.program.expansion import expand
from rsym.program.operations import OPERATIONS, PRIMITIVES
from rsym.program.program import FLOAT32, FLOAT64, PRECISIONS

AWKWARD = [0.0, -0.0, 1.0, -1.0, 0.5, -3.0, 1e-9, -1e-20, 1e-170, 5e-324, 1e20, -1e170, 1e300, np.inf, -np.inf, np.nan]
# The same for float32: squares leave its range in both directions.
SINGLE = [0.0, -0.0, 1.0, -1.0, 0.5, -3.0, 1e-9, -1e-20, 1e-25, 1e-45, 1e10, -1e20, 3e38, np.inf, -np.inf, np.nan]
MILD = [0.0, -0.0, 0.25, -2.0, np.nan]
BACKENDS = {"numpy": NumpyFunction, "llvm": LlvmFunction, "tape": TapeFunction}
EXACT = {"add", "mul", "div", "neg", "sqrt", "abs", "sign", "min", "max", "select", "undefined", "zero_with", "floor"}
LIBM = {"sin", "cos", "exp", "log", "pow", "atan2", "erf", "softplus", "asinh"}
ALPHAS, ORDERS, POWERS = [0, Fraction(1, 2), 1, Fraction(-3, 4)], [1, 2, 3, 6], [2, 4, 6, 3, Fraction(5, 2)]
PARAMETERS = {
    "r_alpha_conjunction": ALPHAS,
    "r_alpha_disjunction": ALPHAS,
    "r0m_conjunction": ORDERS,
    "r0m_disjunction": ORDERS,
    "r0m_partial": ORDERS,
    "monomial": [-1, 0, 1, 2],
    "norm": POWERS,
    "rp_conjunction": POWERS,
    "rp_disjunction": POWERS,
    "rp_versine": POWERS,
    "equivalence": ORDERS,
    "joining": ORDERS,
    "absolute_power": [1, 2, 3, -1, Fraction(1, 2)],
    "signed_power": [1, 2, 3, -1, 0, Fraction(1, 2)],
}
PARAMETRISED = [(operation, value) for operation, values in PARAMETERS.items() for value in values]
NONNEGATIVE_FIRST = {"trimming", "gap"}


def single(operation, parameter=None, letter=False):
    """A program of one operation on inputs, and awkward arguments for it; the parameter a constant or a letter."""
    arity = OPERATIONS[operation].arity - (parameter is not None)
    names = tuple(f"u{k}" for k in range(max(arity, 1)))
    builder = Builder(names, ("parameter",) if letter else ())
    data = {"powi": 5, "const": Fraction(1, 3), "monomial": (2, 1, -2)}.get(operation)
    arguments = [builder.input(name) for name in names[:arity]]
    if parameter is not None:
        arguments.append(builder.input("parameter") if letter else builder.const(parameter))
    node = builder.make(operation, *arguments, data=data)
    program = builder.program({"value": node})
    columns = np.array(list(itertools.product(AWKWARD if arity <= 2 else MILD, repeat=max(arity, 1)))).T
    if operation in NONNEGATIVE_FIRST:
        columns[0] = np.abs(columns[0])
    if operation == "normalised":
        columns[1] = np.abs(columns[1])
    return program, [np.ascontiguousarray(column) for column in columns]


def run(backend, program, columns, letters=(), precision=FLOAT64):
    output = np.empty(len(columns[0]), precision.dtype)
    BACKENDS[backend](expand(program), precision).run(columns, list(letters), [output])
    return output


def in_float32(columns):
    """The same places in a table of arguments, filled with those of float32."""
    single = {abs(double): abs(value) for double, value in zip(AWKWARD, SINGLE, strict=True)}
    return [np.array([np.copysign(single.get(abs(v), v), v) for v in column], np.float32) for column in columns]


OPERATION_NAMES = sorted(set(OPERATIONS) - {"input"} - set(PARAMETERS))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_an_operation_means_the_same_on_every_backend(operation, backend):
    program, columns = single(operation)
    got = run(backend, program, columns)
    inputs = dict(zip(program.coordinates, columns, strict=True))
    expected = np.broadcast_to(interpret(program, inputs)["value"], got.shape)
    assert np.array_equal(np.isnan(got), np.isnan(expected))
    if operation in EXACT:
        assert np.array_equal(got, expected, equal_nan=True)
    else:
        known = np.isfinite(expected)
        assert np.array_equal(got[~known], expected[~known], equal_nan=True)
        assert (np.abs(got[known] - expected[known]) <= 1e-14 * np.abs(expected[known]) + 1e-300).all()
        assert np.array_equal(np.sign(got)[known], np.sign(expected)[known])


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_an_operation_in_float32(operation, backend):
    """Arithmetic is rounded once; the rest is near the float64 meaning wherever float32 can hold its squares."""
    program, columns = single(operation)
    columns = in_float32(columns)
    got = run(backend, program, columns, precision=FLOAT32)
    inputs = dict(zip(program.coordinates, columns, strict=True))
    rounded, expected = (
        np.broadcast_to(interpret_nodes(program, inputs, precision)[-1], got.shape) for precision in (FLOAT32, FLOAT64)
    )
    assert got.dtype == np.float32
    if operation in EXACT:
        assert np.array_equal(got, rounded, equal_nan=True)
    fair = np.all([((np.abs(c) < 1e10) & (np.abs(c) > 1e-10)) | (c == 0) for c in columns], axis=0)
    fair &= np.abs(expected) < 3e38
    assert (np.abs(got[fair] - expected[fair]) <= 4e-7 * np.abs(expected[fair]) + 1e-45).all()


@pytest.mark.random
@pytest.mark.parametrize("letter", [False, True])
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(("operation", "parameter"), PARAMETRISED)
def test_an_operation_with_a_parameter_means_the_same_on_every_backend(operation, parameter, backend, letter):
    """Where the squares leave the range of float64 the sign is right, the value need not be."""
    program, columns = single(operation, parameter, letter)
    got = run(backend, program, columns, [float(parameter)] * letter)
    inputs = dict(zip(program.coordinates, columns, strict=True), parameter=float(parameter))
    expected = np.broadcast_to(interpret(program, inputs)["value"], got.shape)
    finite = np.all([np.isfinite(column) for column in columns], axis=0)
    fair = finite & np.all([(np.abs(c) < 1e20) & ((np.abs(c) > 1e-40) | (c == 0)) for c in columns], axis=0)
    assert np.array_equal(np.isnan(got)[fair], np.isnan(expected)[fair])
    assert np.isnan(got[np.any([np.isnan(column) for column in columns], axis=0)]).all()
    known = fair & np.isfinite(expected)
    assert (np.abs(got[known] - expected[known]) <= 4e-14 * np.abs(expected[known]) + 1e-300).all()
    if operation.split("_")[-1] in {"conjunction", "disjunction", "equivalence", "joining"}:
        assert np.array_equal(np.sign(got[finite]), np.sign(expected[finite]))


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("operation", "outside"),
    [
        ("r_alpha_conjunction", -1.0),
        ("r_alpha_disjunction", 1.5),
        ("rp_disjunction", 1.0),
        ("r0m_conjunction", 0.5),
        ("joining", 0.0),
        ("equivalence", np.nan),
    ],
)
def test_a_letter_outside_the_range_of_its_system_gives_nan(operation, outside, backend):
    program, _ = single(operation, 1, letter=True)
    columns = [np.array([1.0, -2.0, 0.5]), np.array([2.0, 3.0, -0.5])]
    assert np.isnan(run(backend, program, columns, [outside])).all()


@pytest.mark.parametrize("precision", PRECISIONS.values(), ids=PRECISIONS)
@pytest.mark.parametrize("operation", sorted(set(OPERATION_NAMES) - LIBM))
def test_all_backends_give_the_same_bits_for_arithmetic(operation, precision):
    same_bits(operation, precision, ["numpy", "llvm", "tape"])


@pytest.mark.parametrize("precision", PRECISIONS.values(), ids=PRECISIONS)
@pytest.mark.parametrize("operation", OPERATION_NAMES)
def test_tapes_have_the_bits_of_llvm(operation, precision):
    same_bits(operation, precision, ["llvm", "tape"])


def same_bits(operation, precision, backends):
    program, columns = single(operation)
    if precision is FLOAT32:
        columns = in_float32(columns)
    first, *others = (run(backend, program, columns, precision=precision) for backend in backends)
    known, bits = ~np.isnan(first), f"i{precision.dtype.itemsize}"
    for other in others:
        assert np.array_equal(np.isnan(first), np.isnan(other))
        assert np.array_equal(first[known].view(bits), other[known].view(bits))


@pytest.mark.parametrize("precision", PRECISIONS.values(), ids=PRECISIONS)
@pytest.mark.parametrize("operation", ["r0_conjunction", "r0_disjunction"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_r0_against_sixty_digits(operation, backend, precision):
    """The sign is right for every pair of finite numbers; the value where squares stay within the range."""
    program, columns = single(operation)
    if precision is FLOAT32:
        columns = in_float32(columns)
    f, g = (column[np.isfinite(columns[0]) & np.isfinite(columns[1])] for column in columns)
    sizes, limits = np.maximum(np.abs(f), np.abs(g)), np.finfo(precision.dtype)
    fair = (sizes > np.sqrt(limits.tiny) * 1e4) & (sizes < np.sqrt(limits.max) / 1e4)
    got = run(backend, program, [f, g], precision=precision)
    with mpmath.workdps(700):
        sign = -1 if operation == "r0_conjunction" else 1
        pairs = [(mpmath.mpf(float(a)), mpmath.mpf(float(b))) for a, b in zip(f, g, strict=True)]
        expected = [a + b + sign * mpmath.hypot(a, b) for a, b in pairs]
        for value, truth, is_fair in zip(map(float, got), expected, fair, strict=True):
            assert mpmath.sign(value) == mpmath.sign(truth)
            if is_fair:
                assert abs(value - truth) <= 2 * float(limits.eps) * abs(truth) + float(limits.smallest_subnormal)


def test_homogeneity_under_powers_of_two():
    program, _ = single("r0_conjunction")
    rng = np.random.default_rng(3)
    f, g = rng.normal(size=(2, 1000))
    reference = run("llvm", program, [f, g])
    for power in (-100, 100):
        k = 2.0**power
        scaled = run("llvm", program, [k * f, k * g])
        assert (np.abs(scaled / k - reference) <= 2 * np.spacing(np.abs(reference))).all()


def test_expansion_leaves_primitives_alone():
    for operation, parameter in [*((name, None) for name in OPERATION_NAMES), *PARAMETRISED]:
        program, _ = single(operation, parameter)
        assert {node.operation for node in expand(program).nodes} <= PRIMITIVES


def test_no_fast_math_flag_and_no_contraction_in_the_code():
    program, _ = single("r0_conjunction")
    source = LlvmFunction(expand(program)).source
    for flag in ("fast", "nnan", "ninf", "contract", "reassoc", "arcp", "afn", "fma"):
        assert flag not in source


def test_the_suite_sees_a_wrong_operation(monkeypatch):
    """Red proof: a disjunction in place of a conjunction must differ."""
    row = OPERATIONS["r0_conjunction"]
    monkeypatch.setitem(OPERATIONS, "r0_conjunction", replace(row, expansion=OPERATIONS["r0_disjunction"].expansion))
    with pytest.raises(AssertionError):
        test_an_operation_means_the_same_on_every_backend("r0_conjunction", "llvm")
