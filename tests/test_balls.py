"""The ball backend: what it encloses is held against textbook formulas at sixty digits."""

import itertools
import math
import subprocess
import sys
from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from flint import arb, ctx
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from test_backends import OPERATION_NAMES, PARAMETERS, PARAMETRISED, single
from trees import trees, x, y, z

from rsym.codegen.balls import IMAGES, BallFunction, ball, enclose_nodes, exact, hypotenuse, root, square
from rsym.codegen.builder import Builder
from rsym.codegen.differentiation import derivative
from rsym.codegen.interpreter import interpret
from rsym.codegen.lowering import lower
from rsym.codegen.operations import OPERATIONS
from rsym.model.operations import equivalence, joining, trimming
from rsym.model.systems import R0, R1, R0m, RAlpha, Rp

CASES = [*((name, None) for name in OPERATION_NAMES if name != "const"), *PARAMETRISED]
NAN, INFINITY = mpf("nan"), mpf("inf")
SYSTEMS = (R0, R1, RAlpha(sp.Rational(1, 2)), R0m(2), Rp(4), Rp(sp.Rational(5, 2)))
# Their images are put together from those of their parts, and so are wider than their ranges.
COMPOSED = {"select", "r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"}
LEGAL = {"r_alpha": (-1, 1), "r0m": (1, 9), "rp": (1, 9), "equivalence": (1, 9), "joining": (1, 9), "norm": (0, 9)}


@pytest.fixture(autouse=True)
def _sixty_digits_against_sixty_four_bits():
    before = ctx.prec
    ctx.prec = 64
    with mp.workdps(60):
        yield
    ctx.prec = before


def divide(a, b):
    if b == 0:
        return NAN if a == 0 or mpmath.isnan(a) else INFINITY
    return a / b


def raised(u, a):
    """u**a as float_power has it: real, 0**0 = 1."""
    if u == 0:
        return mpf(a == 0) if a >= 0 else INFINITY
    return u**a if u > 0 or a == int(a) else NAN


def length(f, g, p=2):
    size = raised(abs(f), p) + raised(abs(g), p)
    return raised(size, 1 / mpf(p))


def inside(value, low, high, strict=False):
    return (low < value if strict else low <= value) and value <= high


def r_alpha(sign):
    def value(f, g, alpha):
        radius = mp.sqrt(max(f * f + g * g - 2 * alpha * f * g, mpf(0)))
        return (f + g + sign * radius) / (1 + alpha) if inside(alpha, -1, 1, strict=True) else NAN

    return value


def r0m_partial(f, g, m):
    r = length(f, g)
    if r == 0 or m < 1:
        return mpf(0) if m >= 1 else NAN
    return (1 - f / r) * r**m + m * f * (f + g - r) * r ** (m - 2)


def monomial(f, g, m, powers):
    (a, b, c), r = powers, length(f, g)
    if r == 0:
        return mpf(0) if m + a + b + c > 0 else NAN
    return f**a * g**b * r ** (m + c)


def signed(u, a):
    return mp.sign(u) * raised(abs(u), a) if u != 0 else (mpf(0) if a > 0 else NAN)


def gap(s, t):
    return (length(s, t) - t) / 2


def joint(f, g, m):
    n = length(f, g, m)
    return NAN if m < 1 else abs(f) * abs(g) / n if n != 0 else mpf(0)


def logarithm(u):
    return mp.log(u) if u > 0 else -INFINITY if u == 0 else NAN


TEXTBOOK = {
    "undefined": lambda: NAN,
    "add": lambda a, b: a + b,
    "mul": lambda a, b: a * b,
    "div": divide,
    "neg": lambda a: -a,
    "powi": lambda a, n: a**n,
    "pow": raised,
    "sqrt": lambda a: mp.sqrt(a) if a >= 0 else NAN,
    "abs": abs,
    "sign": mp.sign,
    "min": lambda a, b: min(a, b) if a == a and b == b else NAN,
    "max": lambda a, b: max(a, b) if a == a and b == b else NAN,
    "select": lambda a, b, yes, no: yes if a > b else no,
    "sin": mp.sin,
    "cos": mp.cos,
    "exp": mp.exp,
    "log": logarithm,
    "atan2": mp.atan2,
    "r0_conjunction": lambda f, g: f + g - length(f, g),
    "r0_disjunction": lambda f, g: f + g + length(f, g),
    "versine": lambda f, g: 1 - divide(f, length(f, g)),
    "r_alpha_conjunction": r_alpha(-1),
    "r_alpha_disjunction": r_alpha(1),
    "r0m_conjunction": lambda f, g, m: (f + g - length(f, g)) * length(f, g) ** m if m >= 1 else NAN,
    "r0m_disjunction": lambda f, g, m: (f + g + length(f, g)) * length(f, g) ** m if m >= 1 else NAN,
    "r0m_partial": r0m_partial,
    "monomial": monomial,
    "norm": length,
    "rp_conjunction": lambda f, g, p: f + g - length(f, g, p) if p > 1 else NAN,
    "rp_disjunction": lambda f, g, p: f + g + length(f, g, p) if p > 1 else NAN,
    "rp_versine": lambda f, g, p: 1 - signed(divide(f, length(f, g, p)), p - 1) if p > 1 else NAN,
    "equivalence": lambda f, g, m: mp.sign(f) * mp.sign(g) * joint(f, g, m),
    "joining": joint,
    "absolute_power": lambda u, a: raised(abs(u), a),
    "signed_power": signed,
    "gap": gap,
    "trimming": lambda s, t: mp.sqrt(s + gap(s, t) ** 2),
    "normalised": lambda f, q: divide(f, mp.sqrt(f * f + q)),
}


def value_of(node, operands, inputs):
    """The textbook value of a node."""
    if node.operation == "input":
        return inputs[node.data]
    if node.operation == "const":
        named = {"pi": +mp.pi, "e": +mp.e}
        return named[node.data] if isinstance(node.data, str) else mpf(node.data.numerator) / node.data.denominator
    data = () if node.data is None else (node.data,)
    if any(mpmath.isnan(operand) for operand in operands) and node.operation != "select":
        return NAN
    try:
        return TEXTBOOK[node.operation](*operands, *data)
    except (ZeroDivisionError, OverflowError, ValueError):
        return NAN if not any(map(mpmath.isinf, operands)) else None


def values_of(nodes, inputs):
    """The textbook values of all nodes; None behind what mpmath cannot tell about infinities."""
    values = []
    for node in nodes:
        operands = [values[argument] for argument in node.arguments]
        values.append(None if None in operands else value_of(node, operands, inputs))
    return values


def violations(nodes, balls, inputs):
    """The nodes whose value at a point is not in their ball, and how many were compared."""
    values = values_of(nodes, {name: mpf(value) for name, value in inputs.items()})
    finite = [abs(value) for value in values if value is not None and mpmath.isfinite(value)]
    noise = max([mpf(1), *finite]) * mpf("1e-40")
    wrong, count = [], 0
    for number, value in enumerate(values):
        if number not in balls or value is None or mpmath.isnan(value):
            continue
        count += 1
        around = balls[number]
        outside = around is None or (mpmath.isinf(value) and around.is_finite())
        if outside or (mpmath.isfinite(value) and not around.overlaps(arb(value, noise))):
            wrong.append((number, nodes[number], value, around))
    return wrong, count


def boxed(low, high):
    """The ball of an interval of float64 numbers."""
    return ball(arb(low), arb(high))


def random_box(rng):
    """An interval: a point, narrow, wide, beside 0, or with 0 at an end."""
    kind, middle = rng.integers(6), float(rng.normal()) * 2
    width = [0.0, 1e-9, 1e-3, 0.1, 3.0, abs(middle)][kind]
    return (middle, middle + width) if kind < 5 else (min(0.0, middle), max(0.0, middle))


def points_of(rng, boxes, count):
    """Corners and inner points of a box given by intervals by name."""
    for _ in range(count):
        at = {name: rng.choice([0.0, 1.0, 0.5, rng.random()]) for name in boxes}
        yield {name: min(max(low + at[name] * (high - low), low), high) for name, (low, high) in boxes.items()}


@pytest.mark.parametrize(("operation", "parameter"), CASES)
def test_an_operation_on_points_means_the_same_in_balls(operation, parameter):
    """The shared suite on point balls: undefined, unbounded and finite where the plain meaning is, and tight."""
    program, columns = single(operation, parameter)
    expected = np.broadcast_to(
        interpret(program, dict(zip(program.coordinates, columns, strict=True)))["value"], columns[0].shape
    )
    function = BallFunction(program.nodes, [number for _, number in program.outputs])
    for point, plain in zip(zip(*columns, strict=True), map(float, expected), strict=True):
        if not all(value == 0 or 1e-40 < abs(value) < 1e20 for value in point):
            continue
        (got,) = function({name: arb(float(value)) for name, value in zip(program.coordinates, point, strict=True)})
        assert (got is None) == math.isnan(plain), point
        if got is None or (operation == "atan2" and point[0] == 0):
            continue
        assert got.is_finite() == math.isfinite(plain), point
        if math.isfinite(plain):
            error = 4e-14 * abs(plain) + 1e-300
            assert got.overlaps(arb(plain, error)), point
            assert got.rad() <= error, point


def parameter_box(rng, operation, value):
    """A parameter: the number itself, or an interval that may leave the admissible range."""
    number = float(value)
    return (number, number) if rng.random() < 0.5 else (number - rng.choice([0.0, 0.3]), number + rng.random())


def operation_violations(rng, cases, boxes, points):
    wrong, count = [], 0
    for operation, parameter in cases:
        program, _ = single(operation, parameter, letter=parameter is not None)
        function = BallFunction(program.nodes, range(len(program)))
        for _ in range(boxes):
            box = {name: random_box(rng) for name in program.coordinates}
            if operation in {"trimming", "gap"}:
                box["u0"] = tuple(sorted(map(abs, box["u0"])))
            if operation == "normalised":
                box["u1"] = tuple(sorted(map(abs, box["u1"])))
            box |= {name: parameter_box(rng, operation, parameter) for name in program.letters}
            balls = function.balls({name: boxed(*ends) for name, ends in box.items()})
            for point in points_of(rng, box, points):
                found, compared = violations(program.nodes, balls, point)
                wrong += [(box, point, item) for item in found]
                count += compared
    return wrong, count


def test_balls_contain_the_values_of_single_operations():
    wrong, count = operation_violations(np.random.default_rng(7), CASES, boxes=12, points=4)
    assert not wrong, wrong[0]
    assert count > 10_000


def candidates(box):
    """The places of a box where a function that is monotone, or monotone in sizes, has its extremes."""
    low, high = box
    near = [0.0, 1e-30, -1e-30] if low <= 0 <= high else []
    turns = [k * math.pi / 2 for k in range(math.ceil(low / math.pi * 2), math.floor(high / math.pi * 2) + 1)]
    return [low, high, *(value for value in near if low <= value <= high), *turns[:4]]


@pytest.mark.parametrize(("operation", "parameter"), [case for case in CASES if case[0] not in COMPOSED])
def test_an_image_is_no_wider_than_the_range(operation, parameter):
    """The extremes of every such operation lie at ends and beside zeros (of sine and cosine at their peaks)."""
    program, _ = single(operation, parameter)
    rng, (output,) = np.random.default_rng(11), [number for _, number in program.outputs]
    function = BallFunction(program.nodes, [output])
    for _ in range(12):
        box = {name: random_box(rng) for name in program.coordinates}
        if operation in {"trimming", "gap", "normalised", "log", "sqrt", "pow"}:
            box = {name: tuple(sorted(map(abs, ends))) for name, ends in box.items()}
        if operation == "atan2" and box["u0"][0] * box["u0"][1] == 0:
            continue  # an end at 0 may be -0.0: both sides of the cut count
        (got,) = function({name: boxed(*ends) for name, ends in box.items()})
        values = []
        for point in itertools.product(*(candidates(ends) for ends in box.values())):
            inputs = {name: mpf(value) for name, value in zip(box, point, strict=True)}
            values.append(values_of(program.nodes, inputs)[output])
        known = [value for value in values if not mpmath.isnan(value)]
        if got is None:
            assert not known
        elif got.is_finite():
            low, high = min(known), max(known)
            hair = float(max((high - low) / 1000, max(abs(low), abs(high)) * mpf("1e-9")))
            assert got.lower() >= arb(low) - hair, (operation, box, got)
            assert got.upper() <= arb(high) + hair, (operation, box, got)
        else:
            assert operation in {"div", "log", "pow", "absolute_power", "signed_power", "norm"}, (operation, box)
            assert any(mpmath.isinf(value) or abs(value) > 1e12 for value in values) or NAN in map(type, values), box


def seasoned(expression):
    """Expressions that bring in what the R-operations of a tree do not."""
    f, t = y - x**2 / 5, sp.Rational(7, 10) - x**2 / 3
    return (
        expression,
        trimming(expression, t),
        equivalence(expression, f),
        joining(sp.Abs(expression), f, order=3),
        sp.Max(expression, sp.sin(x) * sp.exp(y / 2) - sp.Rational(1, 5)),
        expression / sp.sqrt(expression**2 + t**2 + 1),
        sp.Piecewise((sp.log(2 + x) * expression, sp.sqrt(x + 1) > y), (sp.cos(3 * x), True)),
        sp.sqrt(sp.Abs(f)) * expression + sp.atan2(y, x),
    )


def second_order(expression):
    """The nodes of an expression with its derivatives to second order in x and y."""
    builder = Builder(("x", "y", "z"), ())
    value = lower(builder, expression)
    first = [derivative(builder, value, name) for name in ("x", "y")]
    for node, name in ((first[0], "x"), (first[0], "y"), (first[1], "y")):
        derivative(builder, node, name)
    return builder.nodes


def tree_violations(rng, nodes, boxes, points):
    wrong, count = [], 0
    for _ in range(boxes):
        box = {name: random_box(rng) for name in ("x", "y", "z")}
        balls = enclose_nodes(nodes, range(len(nodes)), {name: boxed(*ends) for name, ends in box.items()})
        for point in points_of(rng, box, points):
            found, compared = violations(nodes, balls, point)
            wrong += [(box, point, item) for item in found]
            count += compared
    return wrong, count


COMPARED = []


@settings(
    max_examples=24,
    deadline=None,
    derandomize=True,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(trees(SYSTEMS, max_leaves=4), st.integers(0, 7))
def test_balls_contain_the_values_of_trees_and_their_derivatives(tree, kind):
    nodes = second_order(seasoned(tree)[kind])
    wrong, count = tree_violations(np.random.default_rng(len(nodes)), nodes, boxes=2, points=2)
    assert not wrong, wrong[0]
    COMPARED.append(count)
