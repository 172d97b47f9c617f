"""Functions and conditions without an operation of their own: values, slopes and enclosures are those of the functions.

Truth is mpmath, or the plain meaning of a step; at a step there is no slope, and never an impulse.
"""

import mpmath
import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.model.rewriting import REWRITTEN, in_known_functions

POINTS = np.array([-1.7, -0.9, -0.31, -1e-9, 1e-9, 0.3, 0.8, 1.4, 2.9])
# The function, its value at a number, and its slope there; None for those of a step.
SMOOTH = {
    "sec": (sp.sec(x), mpmath.sec),
    "csc": (sp.csc(x + 4), lambda t: mpmath.csc(t + 4)),
    "sech": (sp.sech(x), mpmath.sech),
    "csch": (sp.csch(x + 4), lambda t: mpmath.csch(t + 4)),
    "coth": (sp.coth(x + 4), lambda t: mpmath.coth(t + 4)),
    "acot": (sp.acot(x + 4), lambda t: mpmath.acot(t + 4)),
    "asec": (sp.asec(x + 4), lambda t: mpmath.asec(t + 4)),
    "acsc": (sp.acsc(x + 4), lambda t: mpmath.acsc(t + 4)),
    "asinh": (sp.asinh(3 * x), lambda t: mpmath.asinh(3 * t)),
    "acosh": (sp.acosh(x + 3), lambda t: mpmath.acosh(t + 3)),
    "atanh": (sp.atanh(x / 3), lambda t: mpmath.atanh(t / 3)),
    "acoth": (sp.acoth(x + 4), lambda t: mpmath.acoth(t + 4)),
    "erfc": (sp.erfc(x), mpmath.erfc),
    "sinc": (sp.sinc(3 * x), lambda t: mpmath.sinc(3 * t)),
}
STEPS = {
    "Heaviside": (sp.Heaviside(x), lambda t: 0.5 * (1 + np.sign(t)), 0.0, 0.0),
    "Heaviside, 1 at 0": (sp.Heaviside(x, 1), lambda t: 1.0 * (t >= 0), 0.0, 0.0),
    "floor": (sp.floor(2 * x), lambda t: np.floor(2 * t), 0.0, 0.5),
    "ceiling": (sp.ceiling(x), np.ceil, 0.0, 1.0),
    "frac": (sp.frac(x), lambda t: t - np.floor(t), 1.0, -1.0),
    "Mod": (sp.Mod(x, sp.Rational(3, 4)), lambda t: t % 0.75, 1.0, 0.75),
    "unequal": (sp.Piecewise((x, sp.Ne(x, 1)), (5, True)), lambda t: np.where(t == 1, 5, t), 1.0, 1.0),
    "equal": (sp.Piecewise((5, sp.Eq(x, 1)), (x, True)), lambda t: np.where(t == 1, 5, t), 1.0, 1.0),
}


def shape(function):
    return rsym.Shape(function - y, (x, y), bounds=((-2, 3), (-9, 9)))


@pytest.mark.parametrize("backend", ["numpy", "llvm"])
@pytest.mark.parametrize("name", SMOOTH)
def test_values_and_slopes_of_smooth_functions(name, backend):
    function, truth = SMOOTH[name]
    found = rsym.compile(shape(function), ("value", "gradient"), backend=backend)(POINTS, 0.25)
    with mpmath.workdps(40):
        values = np.array([float(truth(mpmath.mpf(t))) for t in POINTS])
        slopes = np.array([float(mpmath.diff(truth, mpmath.mpf(t))) for t in POINTS])
    # A few roundings, of intermediate values up to 8.
    assert np.abs(found["value"] + 0.25 - values).max() <= 16 * 2**-52 * max(1, np.abs(values).max())
    near = np.abs(POINTS) > 1e-3 if name == "sinc" else np.isfinite(slopes)  # (cos u - sinc u)/u cancels
    assert np.abs(found["gradient"][:, 0] - slopes)[near].max() <= 64 * 2**-52 * max(1, np.abs(slopes).max())


@pytest.mark.parametrize("backend", ["numpy", "llvm"])
@pytest.mark.parametrize("name", STEPS)
def test_steps_have_values_everywhere_and_no_slope_where_they_jump(name, backend):
    function, truth, slope, jump = STEPS[name]
    kernel = rsym.compile(shape(function), ("value", "gradient"), backend=backend)
    at = np.append(POINTS, jump)
    found = kernel(at, 0.25)
    assert np.abs(found["value"] + 0.25 - truth(at)).max() <= 4 * 2**-52
    assert (found["gradient"][:-1, 0] == slope).all()
    assert np.isnan(found["gradient"][-1, 0])
    assert np.isnan(kernel(np.nan, 0.25)["value"])


@pytest.mark.parametrize("name", [*SMOOTH, *STEPS])
def test_model_files_keep_them_and_people_get_no_impulse(name):
    made = shape({**SMOOTH, **STEPS}[name][0])
    again = rsym.loads(rsym.dumps(made))
    values = [rsym.compile(one)(POINTS, 0.25)["value"] for one in (made, again)]
    assert np.array_equal(*values)
    slope = rsym.gradient(made)[0]
    assert not slope.has(sp.DiracDelta, sp.Derivative)
    assert made.contract() is not None


@pytest.mark.parametrize("backend", ["interval", "ball"])
@pytest.mark.parametrize("name", [*SMOOTH, *STEPS])
def test_enclosures_hold_the_values(name, backend):
    made = shape({**SMOOTH, **STEPS}[name][0])
    for low, high in ((-1.25, -1.125), (0.125, 0.375), (0.25, 1.0), (0.9, 1.6), (2.8, 2.95)):
        inside = rsym.compile(made)(np.linspace(low, high, 101), 0.25)["value"]
        bottom, top = rsym.enclose(made, ((low, high), (0.25, 0.25)), backend=backend)["value"]
        assert bottom <= inside.min()
        assert inside.max() <= top


TEXTS = {
    "sec(x)": sp.sec(x),
    "csc(x + 4)": sp.csc(x + 4),
    "asinh(x)": sp.asinh(x),
    "acosh(x + 3)": sp.acosh(x + 3),
    "atanh(x/4)": sp.atanh(x / 4),
    "sinc(x)": sp.sinc(x),
    "heaviside(x)": sp.Heaviside(x),
    "floor(x)": sp.floor(x),
    "ceil(x)": sp.ceiling(x),
    "mod(x, 2)": sp.Mod(x, 2),
}


@pytest.mark.parametrize("text", TEXTS)
def test_the_language_has_them(text):
    read = rsym.loads(f"omega = {text} - y")
    made = [rsym.compile(one)(POINTS, 0.25)["value"] for one in (read, shape(TEXTS[text]))]
    assert np.allclose(*made, rtol=1e-14, atol=1e-14)


def test_constants_are_folded_exactly():
    read = rsym.loads("omega = floor(7/2) + ceil(7/2) + mod(-1, 3) + heaviside(-2) - x - y")
    assert rsym.compile(read)(0, 0)["value"] == 9


def test_steps_inside_r_operations_of_expressions():
    made = rsym.Shape(rsym.conjunction(sp.floor(x), y), (x, y))
    assert made.contains([0.5, 1.5], 1).tolist() == [True, True]
    assert not made.contains(-0.5, 1)


def test_what_has_none_of_them_is_the_same_object():
    expression = rsym.conjunction(sp.sin(x), y)
    assert in_known_functions(expression) is expression
    assert not any(
        in_known_functions(kind(x, y) if kind in (sp.Mod, sp.Ne, sp.Eq) else kind(x)).has(kind)
        for kind in REWRITTEN
        if kind not in (sp.Ne, sp.Eq)
    )
