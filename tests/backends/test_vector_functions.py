"""The functions on vectors against fifty digits, at special values, and in every place of a vector."""

import mpmath
import numpy as np
import pytest
from backends.test_backends import run, single

from rsym.backends import vector_functions
from rsym.backends.vector_functions import ARITIES, definitions
from rsym.program.program import FLOAT32, FLOAT64

TRUTH = {
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "exp": mpmath.exp,
    "log": mpmath.log,
    "pow": mpmath.power,
    "atan2": mpmath.atan2,
}
ULPS = {"sin": 1, "cos": 1, "exp": 1, "log": 1, "pow": 1, "atan2": 2}
RANDOM = np.random.default_rng(1993)
COUNT = 400


def uniform(low, high):
    return RANDOM.uniform(low, high, COUNT)


def spread(low, high):
    """Of both signs, all magnitudes alike."""
    return np.exp(uniform(np.log(low), np.log(high))) * RANDOM.choice([-1.0, 1.0], COUNT)


BOUND = vector_functions.TRIGONOMETRIC_BOUND
ANGLES = [
    (uniform(-1, 1),),
    (uniform(-20, 20),),
    (uniform(-BOUND, BOUND),),
    (spread(1e-300, BOUND),),
    (np.pi / 2 * RANDOM.integers(1, 10**6, COUNT),),
    # Of all float64 below the bound the nearest to a multiple of pi/2: 6e-19 from 29 pi/2.
    (np.array([45.553093477052, 91.106186954104, 1457.698991265664, 321307.9594422229, 642615.9188844458]),),
    (spread(BOUND / 2, 1e300),),  # libm takes over here
]
ARGUMENTS = {
    "sin": ANGLES,
    "cos": ANGLES,
    "exp": [(uniform(-1, 1),), (uniform(-708, 709.7),), (spread(1e-300, 1),), (uniform(-745, -708),)],
    "log": [(uniform(0.5, 2),), (np.abs(spread(5e-324, 1.7e308)),), (1 + spread(1e-16, 0.01),)],
    "atan2": [
        (uniform(-1, 1), uniform(-1, 1)),
        (spread(1e-3, 1e3), spread(1e-3, 1e3)),
        (spread(1e-300, 1e300), spread(1e-300, 1e300)),
        (spread(5e-324, 1e-300), spread(5e-324, 1e-300)),
        (spread(1e300, 1.7e308), spread(1e300, 1.7e308)),
    ],
    "pow": [
        (uniform(0, 3), uniform(-10, 10)),
        (uniform(0.5, 2), uniform(-1000, 1000)),
        (1 + spread(1e-16, 0.01), spread(1, 1e4)),
        (np.abs(spread(1e-300, 1e300)), spread(1e-10, 1)),
        (1 + uniform(0, 1), -1040 + uniform(0, 40)),
    ],
}


def evaluate(operation, arguments, precision=FLOAT64):
    columns = [np.ascontiguousarray(argument, precision.dtype) for argument in arguments]
    return run("llvm", single(operation)[0], columns, precision=precision)


def errors_in_ulp(operation, arguments, precision=FLOAT64):
    arguments = [argument.astype(precision.dtype) for argument in arguments]
    errors = []
    with mpmath.workdps(50):
        for got, *place in zip(evaluate(operation, arguments, precision), *arguments, strict=True):
            truth = TRUTH[operation](*(mpmath.mpf(float(number)) for number in place))
            ulp = float(np.spacing(np.abs(precision.dtype.type(truth))))
            errors.append(float(abs(mpmath.mpf(float(got)) - truth) / ulp))
    return np.array(errors)


@pytest.mark.random
@pytest.mark.parametrize(("operation", "case"), [(name, k) for name in TRUTH for k in range(len(ARGUMENTS[name]))])
def test_against_fifty_digits(operation, case):
    assert errors_in_ulp(operation, ARGUMENTS[operation][case]).max() <= ULPS[operation]


@pytest.mark.random
@pytest.mark.parametrize("operation", TRUTH)
def test_in_float32_the_nearest_but_for_a_millionth(operation):
    within = [tuple(np.clip(np.abs(a), 1e-4, 80) for a in case) for case in ARGUMENTS[operation][:2]]
    for arguments in within if operation != "pow" else [(uniform(0.1, 3), uniform(-10, 10))]:
        assert errors_in_ulp(operation, arguments, FLOAT32).max() <= 0.5 + 1e-6


SPECIAL = [0.0, 1.0, 2.0, 2.5, 3.0, 5e-324, 1e-310, 2.0**-1022, 1.7e308, 710.0, 745.2, 1e17 + 16, 1e19, np.inf]
SPECIAL = np.array([*SPECIAL, *(-number for number in SPECIAL), np.nan])


@pytest.mark.parametrize("operation", TRUTH)
def test_special_values_and_the_signs_of_zeros(operation):
    """The oracle is NumPy, which follows the C standard."""
    arguments = [SPECIAL] if ARITIES[operation] == 1 else [a.ravel() for a in np.meshgrid(SPECIAL, SPECIAL)]
    got = evaluate(operation, arguments)
    with np.errstate(all="ignore"):
        expected = {"pow": np.power, "atan2": np.arctan2}.get(operation, getattr(np, operation, None))(*arguments)
    assert np.array_equal(np.isnan(got), np.isnan(expected))
    known = ~np.isnan(expected)
    assert np.array_equal(np.signbit(got[known]), np.signbit(expected[known]))
    ordinary = np.isfinite(expected) & (expected != 0)
    assert np.array_equal(got[known & ~ordinary], expected[known & ~ordinary])
    got, expected = got[ordinary], expected[ordinary]
    assert (np.abs(got - expected) <= 3 * np.spacing(np.abs(expected))).all()


@pytest.mark.random
@pytest.mark.parametrize("precision", [FLOAT64, FLOAT32], ids=["float64", "float32"])
@pytest.mark.parametrize("operation", TRUTH)
def test_the_same_bits_beside_any_neighbours(operation, precision):
    """Alone, and shuffled among arguments that go to libm."""
    parts = [np.concatenate([case[k][:20] for case in ARGUMENTS[operation]]) for k in range(ARITIES[operation])]
    with np.errstate(over="ignore"):
        arguments = [np.concatenate([part, SPECIAL, SPECIAL[::-1]]).astype(precision.dtype) for part in parts]
    reference = evaluate(operation, arguments, precision)
    for _ in range(5):
        order = RANDOM.permutation(len(reference))
        shuffled = evaluate(operation, [argument[order] for argument in arguments], precision)
        assert np.array_equal(shuffled, reference[order], equal_nan=True)
    for k in range(0, len(reference), 7):
        alone = evaluate(operation, [argument[k : k + 1] for argument in arguments], precision)
        assert np.array_equal(alone, reference[k : k + 1], equal_nan=True)


def test_constants_in_several_pieces():
    with mpmath.workdps(60):
        for pieces, whole, bits in [
            (vector_functions._HALF_PI, mpmath.pi / 2, 150),
            (vector_functions._RIGHT_ANGLE, mpmath.pi / 2, 106),
            (vector_functions._ATAN_HALF, mpmath.atan(0.5), 106),
            (vector_functions._ATAN_ONE, mpmath.pi / 4, 106),
            (vector_functions._LOG2, mpmath.log(2), 86),
            (vector_functions._LOG2_OF_1_5, mpmath.log(1.5, 2), 80),
        ]:
            assert abs(mpmath.fsum(map(mpmath.mpf, pieces)) - whole) < mpmath.mpf(2) ** -bits


def test_no_fast_math_flag_and_no_fused_operation():
    text = "\n".join(definitions(ARITIES, 8))
    for flag in ("fast", "nnan", "ninf", "contract", "reassoc", "arcp", "afn", "fma", "fmuladd"):
        assert flag not in text
