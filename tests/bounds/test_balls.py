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
from backends.test_backends import OPERATION_NAMES, PARAMETRISED, single
from flint import arb, ctx
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf
from oracles.tiers import examples
from oracles.trees import trees, x, y

from rsym.backends.interpreter import interpret
from rsym.bounds.balls import IMAGES, BallFunction, ball, enclose_nodes, exact, hypotenuse, root, square
from rsym.model.operations import equivalence, joining, trimming
from rsym.model.systems import R0, R1, R0m, RAlpha, Rp
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower
from rsym.program.operations import OPERATIONS

CASES = [*((name, None) for name in OPERATION_NAMES if name != "const"), *PARAMETRISED]
NAN, INFINITY = mpf("nan"), mpf("inf")
SYSTEMS = (R0, R1, RAlpha(sp.Rational(1, 2)), R0m(2), Rp(4), Rp(sp.Rational(5, 2)))
# Their images are put together from those of their parts, and so are wider than their ranges.
COMPOSED = {"select", "r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"}


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
    "erf": mp.erf,
    "asinh": mp.asinh,
    "floor": mp.floor,
    "softplus": lambda a: max(a, 0) + mp.log1p(mp.exp(-abs(a))),
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
    "zero_with": lambda f, g: g if f else f,
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
    return arb(0, math.inf) if math.isinf(high) else ball(arb(low), arb(high))


def random_box(rng):
    """An interval: a point, narrow, wide, with 0 at an end, or the whole line."""
    kind, middle = rng.integers(13) // 2, float(rng.normal()) * 2
    if kind >= 5:
        return (min(0.0, middle), max(0.0, middle)) if kind == 5 else (-math.inf, math.inf)
    return (middle, middle + [0.0, 1e-9, 1e-3, 0.1, 3.0][kind])


def points_of(rng, boxes, count):
    """Corners and inner points of a box given by intervals by name."""

    def within(low, high):
        if math.isinf(high):
            return max(low, float(rng.normal()) * 10.0 ** rng.integers(-5, 12))
        inner = low + rng.random() * (high - low)
        return min(max(rng.choice([low, high, 0.0, inner]), low), high)

    return [{name: within(*ends) for name, ends in boxes.items()} for _ in range(count)]


def nonnegative(ends):
    """An interval of sizes."""
    return (0.0, math.inf) if math.isinf(ends[1]) else tuple(sorted(map(abs, ends)))


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
            for name in {"trimming": ("u0",), "normalised": ("u1",)}.get(operation, ()):
                box[name] = nonnegative(box[name])
            box |= {name: parameter_box(rng, operation, parameter) for name in program.letters}
            balls = function.balls({name: boxed(*ends) for name, ends in box.items()})
            for point in points_of(rng, box, points):
                found, compared = violations(program.nodes, balls, point)
                wrong += [(box, point, item) for item in found]
                count += compared
    return wrong, count


@pytest.mark.slow
def test_balls_contain_the_values_of_single_operations():
    wrong, count = operation_violations(np.random.default_rng(7), CASES, boxes=12, points=4)
    assert not wrong, wrong[0]
    assert count > 10_000


def candidates(box):
    """The places of an interval where a function that is monotone, or monotone in sizes, has its extremes."""
    low, high = box
    beside = [value for value in (0.0, 1e-30, -1e-30) if low <= value <= high]
    peaks = range(math.ceil(low / math.pi * 2), math.floor(high / math.pi * 2) + 1)
    return [low, high, *beside, *(k * math.pi / 2 for k in peaks)]


@pytest.mark.random
@pytest.mark.parametrize(("operation", "parameter"), [case for case in CASES if case[0] not in COMPOSED])
def test_an_image_is_no_wider_than_the_range(operation, parameter):
    """The extremes of every such operation lie at ends and beside zeros, of sine and cosine at their peaks."""
    program, _ = single(operation, parameter)
    rng, (output,) = np.random.default_rng(11), [number for _, number in program.outputs]
    function = BallFunction(program.nodes, [output])
    for _ in range(16):
        box = {name: random_box(rng) for name in program.coordinates}
        if operation in {"trimming", "gap", "normalised", "log", "sqrt", "pow"}:
            box = {name: nonnegative(ends) for name, ends in box.items()}
        if any(math.isinf(high) for _, high in box.values()) or (operation == "atan2" and 0 in box["u0"]):
            continue  # an end at 0 may be -0.0: then both sides of the cut of atan2 count
        (got,) = function({name: boxed(*ends) for name, ends in box.items()})
        places = itertools.product(*(candidates(ends) for ends in box.values()))
        inputs = [{name: mpf(value) for name, value in zip(box, place, strict=True)} for place in places]
        values = [values_of(program.nodes, point)[output] for point in inputs]
        known = [value for value in values if not mpmath.isnan(value)]
        assert (got is None) == (not known), (box, got)
        if got is None or any(mpmath.isinf(value) or abs(value) > 1e12 for value in known):
            continue
        low, high = min(known), max(known)
        hair = float(max((high - low) / 1000, max(abs(low), abs(high)) * mpf("1e-9")))
        assert got.lower() >= arb(low) - hair, (box, got)
        assert got.upper() <= arb(high) + hair, (box, got)


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


@pytest.mark.slow
@settings(
    max_examples=examples(24),
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
    assert count > 2 * len(nodes)


@pytest.mark.parametrize("operation", ["r0_conjunction", "mul", "sqrt", "versine", "trimming"])
def test_the_suite_sees_an_image_that_is_too_narrow(operation, monkeypatch):
    """Red proof: a ball of nine tenths of the radius misses values."""
    true = IMAGES[operation]

    def narrow(*operands):
        around = true(*operands)
        return around if around is None else arb(around.mid(), around.rad() * 0.9)

    monkeypatch.setitem(IMAGES, operation, narrow)
    wrong, _ = operation_violations(np.random.default_rng(7), [(operation, None)], boxes=12, points=4)
    assert wrong


def enclosed(make, **boxes):
    """The ball of a node made by a function of a builder and its inputs."""
    builder = Builder(tuple(boxes), ())
    node = make(builder, *(builder.input(name) for name in boxes))
    return enclose_nodes(builder.nodes, range(len(builder.nodes)), boxes)[node]


def image(operation, *operands):
    around = IMAGES[operation](*operands)
    return "nothing" if around is None else around if around.is_finite() else "whole line"


A, B = arb(-2, 1), arb(1, 2)  # certainly negative, and both signs


@pytest.mark.parametrize(
    ("operation", "operands", "expected"),
    [
        ("undefined", (), "nothing"),
        ("sqrt", (A,), "nothing"),
        ("log", (A,), "nothing"),
        ("log", (B,), "whole line"),
        ("div", (A, B), "whole line"),
        ("div", (arb(0), arb(0)), "nothing"),
        ("div", (A, arb(0)), "whole line"),
        ("pow", (A, arb(0.5)), "nothing"),
        ("pow", (B, arb(-1)), "whole line"),
        ("versine", (arb(0), arb(0)), "nothing"),
        ("normalised", (arb(0), arb(0)), "nothing"),
        ("signed_power", (arb(0), arb(0)), "nothing"),
        ("monomial", (arb(0), arb(0), arb(0), (1, 0, -1)), "nothing"),
        ("r_alpha_conjunction", (A, B, arb(2)), "nothing"),
        ("r_alpha_disjunction", (A, B, arb(-1)), "nothing"),
        ("r_alpha_conjunction", (A, B, arb(-1, 0.5)), "whole line"),
        ("rp_conjunction", (A, B, arb(1)), "nothing"),
        ("rp_versine", (A, B, arb(0.5)), "nothing"),
        ("r0m_disjunction", (A, B, arb(0.5)), "nothing"),
        ("r0m_partial", (A, B, arb(0.5)), "nothing"),
        ("joining", (A, B, arb(0)), "nothing"),
        ("equivalence", (A, B, arb(0)), "nothing"),
    ],
)
def test_what_is_undefined_and_what_is_unknown(operation, operands, expected):
    assert image(operation, *operands) == expected


@pytest.mark.parametrize(
    ("operation", "operands", "values"),
    [
        ("div", (arb(0), B), [0]),
        ("select", (None, A, arb(1), arb(2)), [2]),
        ("pow", (A, arb(2.5, 1)), [-27, -8, 1, 4]),
        ("pow", (B, arb(2)), [0, 1, 9]),
        ("equivalence", (B, arb(2), arb(2, 1)), [-2 / (1 + 2**3) ** (1 / 3), 6 / (27 + 8) ** (1 / 3)]),
        ("atan2", (B, B), [-3.14159, 0, 3.14159]),
        ("atan2", (arb(0), A), [3.14159]),
    ],
)
def test_values_that_are_easily_missed(operation, operands, values):
    for value in values:
        assert IMAGES[operation](*operands).overlaps(arb(value, 1e-4))


def test_products_of_wide_balls_are_sharp():
    got = IMAGES["mul"](arb(1, 0.125), arb(2, 0.25))
    assert got.overlaps(arb(1.125 * 2.25, 1e-6))
    assert got >= 0.875 * 1.75 - 1e-6


def test_nan_is_the_whole_line(monkeypatch):
    assert enclosed(lambda b, u: u, u=arb.nan()).contains(arb(5))
    monkeypatch.setitem(IMAGES, "sin", lambda u: arb.nan())
    assert enclosed(lambda b, u: b.make("sin", u), u=B).contains(arb(5))
    assert not enclosed(lambda b, u: b.make("sin", u), u=B).is_nan()


def test_a_part_that_is_undefined_makes_its_users_undefined():
    assert enclosed(lambda b, u: b.add(b.sqrt(u), b.const(1)), u=A) is None
    assert enclosed(lambda b, u: b.make("min", b.sqrt(u), u), u=A) is None
    assert enclosed(lambda b, u: b.div(u, b.abs(u)), u=arb(0)) is None


@pytest.mark.parametrize("operation", ["pow", "absolute_power"])
def test_a_power_may_be_one_where_its_operand_is_undefined(operation):
    """NaN**0 = 1**NaN = 1 in the plain meaning of a power."""
    nan = float("nan")
    assert OPERATIONS[operation].meaning(np, nan, 0.0) == OPERATIONS[operation].meaning(np, 1.0, nan) == 1
    assert enclosed(lambda b, u, v: b.make(operation, b.sqrt(u), v), u=A, v=B).contains(arb(1))
    assert enclosed(lambda b, u, v: b.make(operation, v, b.sqrt(u)), u=A, v=B).contains(arb(1))
    assert enclosed(lambda b, u, v: b.make(operation, b.sqrt(u), v), u=A, v=arb(2)) is None
    assert enclosed(lambda b, u, v: b.make(operation, v, b.sqrt(u)), u=A, v=arb(2)) is None


def test_a_comparison_decides_only_where_it_is_defined():
    """Where an operand is NaN, and so no comparison true, the other branch counts."""

    def chosen(condition):
        return lambda b, u: b.make("select", condition(b, u), b.const(0), b.const(5), b.const(7))

    def positive_root(b, u):
        return b.add(b.sqrt(u), b.const(1))

    assert enclosed(chosen(positive_root), u=arb(2, 1)) == 5
    assert enclosed(chosen(positive_root), u=A) == 7
    assert enclosed(chosen(positive_root), u=B).contains(ball(arb(5), arb(7)))
    assert enclosed(chosen(lambda b, u: b.neg(positive_root(b, u))), u=B) == 7
    assert enclosed(chosen(lambda b, u: u), u=B).contains(ball(arb(5), arb(7)))


@pytest.mark.parametrize(
    ("make", "low", "high"),
    [
        (lambda b, u, v: b.square(u), 0, 9),
        (lambda b, u, v: b.div(u, b.abs(u)), -1, 1),
        (lambda b, u, v: b.div(b.abs(u), u), -1, 1),
        (lambda b, u, v: b.div(v, b.abs(v)), 1, 1),
        (lambda b, u, v: b.div(v, b.sqrt(b.add(b.square(u), b.square(v)))), 0.5**0.5 / 5**0.5, 1),
        (lambda b, u, v: b.mul(u, b.div(b.const(1), b.sqrt(b.add(b.square(u), b.square(v))))), -(0.8**0.5), 1),
        (lambda b, u, v: b.div(u, b.make("norm", v, u, b.const(4))), -1, 1),
        (lambda b, u, v: b.div(b.make("gap", v, u), b.sqrt(b.add(b.square(v), b.square(u)))), 0, 1),
    ],
)
def test_operands_that_have_something_in_common(make, low, high):
    """Over -2 <= u <= 3, 1 <= v <= 3: bounds that hold, some not attained, where the operands alone tell less."""
    got = enclosed(make, u=arb(0.5, 2.5), v=arb(2, 1))
    assert got >= low - 1e-7
    assert got <= high + 1e-7


def test_balls_that_are_known_are_kept():
    builder = Builder(("x",), ())
    node = builder.square(builder.input("x"))
    known = {0: arb(3)}
    assert enclose_nodes(builder.nodes, range(len(builder.nodes)), {"x": arb(5)}, known) is known
    assert known[node] == 9


@pytest.mark.parametrize("bits", [53, 333])
def test_constants_are_enclosed_at_the_working_precision(bits):
    builder = Builder((), ())
    numbers = [builder.make("const", data=value) for value in ("pi", "e", Fraction(1, 3), Fraction(3, 4))]
    function = BallFunction(builder.nodes, numbers)
    for precision in (bits, 20, bits):
        with ctx.workprec(precision), mp.workprec(2000):
            for got, true in zip(function({}), (+mp.pi, +mp.e, mpf(1) / 3, mpf(3) / 4), strict=True):
                middle, radius = (arb(got.mid()), got.rad())
                with ctx.workprec(2000):
                    assert abs(middle - arb(true)) <= radius
                    assert radius <= arb(2) ** (4 - precision)
    assert exact(Fraction(3, 4)).is_exact()


def test_helpers():
    assert square(arb(0, 0.1)) >= 0
    assert root(arb(0, 4)) <= 2.0000001
    assert root(arb(-2, 1)) is None
    assert hypotenuse(arb(3), arb(-4)).overlaps(arb(5))
    assert ball(arb(3), arb(-1)).contains(ball(arb(-1), arb(3)))


@pytest.mark.slow
@pytest.mark.parametrize(
    "proof",
    [
        "rsym.enclose(shape, [[0, 1], [0, 1]])",
        "rsym.verify_smoothness(shape)",
        "rsym.verify_normalisation(shape)",
        "rsym.continuity([])",
    ],
)
def test_without_python_flint_there_is_a_remedy(proof):
    script = (
        "import sys; sys.modules['flint'] = None\n"
        "import rsym\n"
        "shape = rsym.Shape(rsym.x, (rsym.x, rsym.y))\n"
        f"try: {proof}\n"
        "except rsym.RsymError as error: print(error.code, error.remedy)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "missing-package pip install python-flint"


def test_every_operation_has_an_image():
    assert all(IMAGES[operation] for operation in OPERATIONS)
    assert {operation for operation, _ in CASES} | {"const", "input"} == set(OPERATIONS)
