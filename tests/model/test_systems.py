"""The table of R-systems, checked symbolically: derivatives, normalisation, smoothness at the corner, De Morgan."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import (
    R0,
    R1,
    R0m,
    RAlpha,
    Rp,
    RsymError,
    Shape,
    conjunction,
    disjunction,
    equivalence,
    joining,
    trimming,
    x,
    y,
    z,
)

alpha, p, m = sp.symbols("alpha p m", real=True)
u, v = sp.symbols("u v", positive=True)
SYSTEMS = [R0, R1, RAlpha(sp.Rational(1, 3)), RAlpha(-sp.Rational(1, 2)), R0m(1), R0m(2), Rp(4), Rp(3)]
KINDS = {"conjunction": -1, "disjunction": 1}


def on_face(expression, order):
    """The derivative of that order along x, on x = 0 with y = v > 0."""
    return sp.simplify(sp.diff(expression, x, order).subs({x: 0, y: v}).doit())


def face_of(system, kind):
    """Written out, with the sign that makes the face x = 0 a boundary: y > 0 for a conjunction, y < 0 for the other."""
    return getattr(system, kind)(x, -KINDS[kind] * y).doit()


@pytest.mark.parametrize("kind", KINDS)
def test_r0_has_the_derivatives_of_the_table(kind):
    node, s, r = getattr(R0, kind)(x, y), KINDS[kind], sp.sqrt(x**2 + y**2)
    table = {(x,): 1 + s * x / r, (y,): 1 + s * y / r, (x, x): s * y**2 / r**3, (x, y): -s * x * y / r**3}
    table[y, y] = s * x**2 / r**3
    for variables, expected in table.items():
        assert sp.simplify(sp.diff(node, *variables).doit() - expected) == 0


@pytest.mark.parametrize("kind", KINDS)
def test_r_alpha_keeps_order_one_and_misses_order_two_by_what_the_table_says(kind):
    node = face_of(RAlpha(alpha), kind)
    assert sp.simplify(node.subs({x: 0, y: v})) == 0
    assert on_face(node, 1) == 1
    assert sp.simplify(on_face(node, 2) - KINDS[kind] * (1 - alpha) / v) == 0


def test_r_alpha_joins_r0_and_r1():
    assert RAlpha(0).conjunction(x, y).doit() == R0.conjunction(x, y).doit()
    kernel = rsym.compile(Shape(disjunction(x, y, system=RAlpha(alpha)), (x, y), letters={alpha: 0.5}))
    points = np.random.default_rng(1).normal(size=(2, 50))
    assert_close(kernel(*points, letters={"alpha": 1})["value"], np.maximum(*points), rtol=4e-16)
    assert_close(kernel(*points, letters={"alpha": 0})["value"], points.sum(0) + np.hypot(*points), atol=4e-15)


@pytest.mark.random
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("order", [2, 4, 6])
def test_rp_keeps_order_p_minus_one_and_no_more(order, kind):
    node = face_of(Rp(order), kind)
    derivatives = [on_face(node, k) for k in range(order + 1)]
    assert derivatives[:-1] == [0, 1] + [0] * (order - 2)
    assert derivatives[-1] != 0


@pytest.mark.random
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("order", [1, 2, 3])
def test_r0m_is_of_class_m_at_the_corner_and_no_more(order, kind):
    """Homogeneous of degree m + 1: derivatives to order m go to 0, those of order m + 1 depend on the direction."""
    node = getattr(R0m(order), kind)(x, y).doit()
    for k in range(order + 2):
        for ways in range(k + 1):
            derivative = sp.diff(node, x, ways, y, k - ways)
            scaled = derivative.subs({x: u * v, y: 2 * u * v}, simultaneous=True)
            assert sp.simplify(scaled - u ** (order + 1 - k) * derivative.subs({x: v, y: 2 * v})) == 0
    last = sp.diff(node, x, order + 1)
    towards = [sp.simplify(last.subs({x: a, y: b})) for a, b in ((1, 0), (0, 1), (-1, 1))]
    assert len(set(towards)) > 1


@pytest.mark.parametrize("order", [1, 2])
def test_the_compiled_r0m_has_zero_derivatives_at_the_corner_up_to_order_m(order):
    shape = Shape(conjunction(x, y, system=R0m(order)), (x, y))
    for backend in ("numpy", "llvm"):
        got = rsym.compile(shape, ("value", "gradient", "hessian", "singular"), backend=backend)(0.0, 0.0)
        assert got["value"] == 0
        assert got["gradient"].tolist() == [0, 0]
        assert not got["singular"]
        assert np.array_equal(np.isnan(got["hessian"]), np.full((2, 2), order == 1))


def test_r0m_does_not_keep_normalisation():
    assert on_face(face_of(R0m(3), "conjunction"), 1) == v**3


@pytest.mark.parametrize("system", [RAlpha(alpha), RAlpha(sp.Rational(1, 3)), Rp(4), Rp(p), Rp(3), R0m(2)])
def test_de_morgan_is_exact(system):
    left, right = -system.conjunction(x, y, z), system.disjunction(-x, -y, -z)
    assert sp.simplify(left.doit() - right.doit()) == 0


@pytest.mark.parametrize("system", SYSTEMS)
def test_de_morgan_to_the_last_bit(system):
    points = np.random.default_rng(2).normal(size=(3, 200)) * 10.0 ** np.random.default_rng(3).integers(-9, 9, (3, 200))
    first = rsym.compile(Shape(-system.conjunction(x, y, z), (x, y, z)))(*points)["value"]
    second = rsym.compile(Shape(system.disjunction(-x, -y, -z), (x, y, z)))(*points)["value"]
    assert np.array_equal(first, second)


@pytest.mark.parametrize("order", [1, 2, 4])
def test_equivalence_is_normalised_to_its_order(order):
    """On x = 0 with y = v > 0, from the side x > 0 (odd orders have |x|)."""
    node = equivalence(u, v, order=order).doit()
    derivatives = [sp.limit(sp.diff(node, u, k), u, 0) for k in range(order + 2)]
    assert derivatives[:-1] == [0, 1] + [0] * (order - 1)
    assert derivatives[-1] != 0


def test_equivalence_is_associative_and_positive_where_signs_agree():
    flat, nested = equivalence(x, y, z, order=3), equivalence(x, equivalence(y, z, order=3), order=3)
    points = np.random.default_rng(5).normal(size=(3, 100))
    first, second = (rsym.compile(Shape(node, (x, y, z)))(*points)["value"] for node in (flat, nested))
    assert_close(first, second, rtol=1e-14)
    assert np.array_equal(np.sign(first), np.sign(points.prod(axis=0)))


def test_joining_is_zero_on_each_curve_stable_beside_it_and_never_negative():
    shape = Shape(joining(x, y, z), (x, y, z))
    kernel = rsym.compile(shape, ("value", "gradient"))
    got = kernel([0.0, 1e-200, -3.0, 0.0, -2.0], [2.0, 5.0, 1e-300, 0.0, 2.0], [-1.0, 3.0, 4.0, 1.0, 2.0])
    assert_close(got["value"], [0, 1e-200, 1e-300, 0, 2 / np.sqrt(3)], rtol=1e-15)
    assert_close(got["gradient"][4], np.array([-1, 1, 1]) / 3**1.5, rtol=1e-14)
    assert (kernel(*np.random.default_rng(6).normal(size=(3, 100)))["value"] >= 0).all()


def test_joined_segments_have_distance_one_gradient_near_both():
    bent = joining(rsym.trimming(y, x * (4 - x) / 4), rsym.trimming(x, y * (4 - y) / 4))
    kernel = rsym.compile(Shape(bent, (x, y)), ("gradient_squared",))
    assert_close(kernel([2.0, 1e-4, -1e-4], [1e-4, 2.0, 2.0])["gradient_squared"], np.ones(3), atol=1e-6)


def test_parameters_are_never_differentiated_through():
    with pytest.raises(RsymError) as caught:
        sp.diff(conjunction(x, y, system=Rp(p)), p)
    assert caught.value.code == "parameter-derivative"
    with pytest.raises(RsymError) as caught:
        rsym.compile(Shape(conjunction(x, y, system=RAlpha(z)), (x, y, z)))
    assert caught.value.code == "parameter"


@pytest.mark.parametrize(
    ("build", "value"),
    [
        *((RAlpha, value) for value in (-1, 1.01, sp.oo, "1")),
        *((R0m, value) for value in (0, 1.5)),
        *((Rp, value) for value in (1, sp.nan, sp.I)),
        *((lambda k: joining(x, y, order=k), value) for value in (0, 1.5, "2")),
    ],
)
def test_a_parameter_outside_its_range_is_refused(build, value):
    with pytest.raises(RsymError) as caught:
        build(value)
    assert caught.value.code in {"parameter", "order", "expression"}


def test_letters_as_parameters_never_recompile_and_give_what_numbers_give():
    names = ("value", "gradient", "laplacian")
    points = np.random.default_rng(8).normal(size=(3, 40))
    for family, letter, values in ((RAlpha, alpha, (0.25, -0.5)), (R0m, m, (1, 2)), (Rp, p, (2, 4, 2.5))):
        kernel = rsym.compile(Shape(family(letter).conjunction(x, y, z), (x, y, z), letters={letter: values[0]}), names)
        for value in values:
            got = kernel(*points, letters={letter.name: value})
            expected = rsym.compile(Shape(family(value).conjunction(x, y, z), (x, y, z)), names)(*points)
            for name in names:
                assert_close(got[name], expected[name], atol=1e-12 * np.abs(expected[name]).max())


@pytest.mark.random
@pytest.mark.parametrize("system", [RAlpha(sp.Rational(1, 3)), R0m(2), Rp(4), Rp(3), Rp(p)])
@pytest.mark.parametrize("kind", KINDS)
def test_plain_lambdify_and_evalf_agree_with_the_kernel(system, kind):
    node = getattr(system, kind)(x, y, z).subs(p, sp.Rational(7, 2))
    points = np.array([[1.0, 1e-12, -2.0, 3.0], [2.0, 1.0, 0.5, -3.0], [-1.5, 1.0, -0.25, 3.5]])
    compiled = rsym.compile(Shape(node, (x, y, z)), ("value", "gradient"))(*points)
    plain = rsym.lambdify(Shape(node, (x, y, z)), ("value", "gradient"))(*points)
    assert_close(plain["value"], compiled["value"], rtol=1e-13)
    assert_close(plain["gradient"], compiled["gradient"], atol=2e-15 * np.abs(compiled["gradient"]).max())
    assert_close(sp.lambdify((x, y, z), node)(*points), compiled["value"], rtol=1e-13)
    for k, point in enumerate(points.T):
        exact = node.subs(dict(zip((x, y, z), map(sp.Rational, point), strict=True))).evalf(30)
        assert_close(compiled["value"][k], float(exact), rtol=1e-14)


NODES = [
    *(system.conjunction(x, disjunction(y, z, system=system)) for system in SYSTEMS if system is not R1),
    Rp(sp.Rational(7, 2)).disjunction(x, y, z),
    *(equivalence(x, y, z, order=order) for order in (1, 2, 3)),
    *(joining(x, y, z, order=order) for order in (1, 2, 3)),
    joining(x),
]


@pytest.mark.random
@pytest.mark.parametrize("node", NODES)
def test_fdiff_is_the_derivative_of_the_plain_formula_to_second_order(node):
    place = (0.5, -0.375, 1.125)
    exact = sp.lambdify((x, y, z), node.doit(), modules="mpmath")
    for symbol, order in zip((x, y, z), np.eye(3, dtype=int).tolist(), strict=True):
        first = sp.diff(node, symbol)
        for expression, orders in ((first, order), (sp.diff(first, y), np.add(order, (0, 1, 0)).tolist())):
            with mpmath.workdps(50):
                expected = mpmath.diff(exact, tuple(map(mpmath.mpf, place)), tuple(orders))
            got = expression.subs(dict(zip((x, y, z), map(sp.Rational, place), strict=True))).evalf(30)
            assert_close(float(got), float(expected), atol=1e-12)


@pytest.mark.parametrize("node", [*NODES, trimming(x, y)])
def test_the_runtime_of_a_node_agrees_with_its_formula(node):
    points = np.random.default_rng(9).normal(size=(3, 20))
    exact = sp.lambdify((x, y, z), node.doit(), modules="mpmath")
    expected = [float(exact(*map(mpmath.mpf, point))) for point in points.T]
    assert_close(sp.lambdify((x, y, z), node)(*points), expected, rtol=1e-12)
    assert_close(
        float(sp.lambdify((x, y, z), node, modules="mpmath")(*map(mpmath.mpf, points[:, 0]))), expected[0], rtol=1e-12
    )


@pytest.mark.random
@pytest.mark.parametrize("system", [R0, RAlpha(sp.Rational(1, 3)), R0m(1), R0m(3), Rp(4), Rp(3), Rp(sp.Rational(5, 2))])
@pytest.mark.parametrize("kind", KINDS)
def test_each_partial_derivative_keeps_its_digits_where_one_operand_is_far_larger(system, kind):
    s = KINDS[kind]
    node = getattr(system, kind)(x, y)
    for place in ((-s * 1e6, -s), (-s, -s * 1e-6), (-s * 1e-5, -s * 3e3)):
        got = rsym.compile(Shape(node, (x, y)), ("gradient",))(*place)["gradient"]
        exact = sp.lambdify((x, y), node.doit(), modules="mpmath")
        with mpmath.workdps(80):
            expected = [float(mpmath.diff(exact, tuple(map(mpmath.mpf, place)), order)) for order in ((1, 0), (0, 1))]
        assert_close(got, expected, rtol=1e-12)


def test_the_runtime_of_equivalence_keeps_the_sign_of_tiny_numbers():
    function = sp.lambdify((x, y), [equivalence(x, y), joining(x, y)])
    signed, size = function(np.array([1e-200, -1e-200, 0.0]), np.array([-1e-200, -2e-200, 0.0]))
    assert np.sign(signed).tolist() == [-1, 1, 0]
    assert np.sign(size).tolist() == [1, 1, 0]


@pytest.mark.parametrize("power", [3, 4, sp.Rational(5, 2)])
def test_evalf_of_rp_does_not_cancel(power):
    small = sp.Rational(1, 10**9)
    node = conjunction(small, 1, system=Rp(power))
    assert abs(node.evalf(30) / node.doit().evalf(30, maxn=300) - 1) < sp.Float("1e-28")


def test_latex_names_the_system():
    assert sp.latex(conjunction(x, y, system=RAlpha(alpha))) == r"\left(x \wedge_{\alpha} y\right)"
    assert sp.latex(disjunction(x, y, system=RAlpha(0.5))) == r"\left(x \vee_{\alpha=0.5} y\right)"
    assert sp.latex(conjunction(x, y, system=R0m(2))) == r"\left(x \wedge_{0}^{2} y\right)"
    assert sp.latex(conjunction(x, y, system=Rp(4))) == r"\left(x \wedge_{p=4} y\right)"
    assert sp.latex(equivalence(x, y)) == r"\left(x \sim_{2} y\right)"
    assert sp.latex(joining(x, y, order=m)) == r"\left(x \cup_{m} y\right)"
    assert str(conjunction(x, y, system=Rp(4))) == "conjunction(x, y, system=Rp(4))"


def test_a_picture_of_a_model_in_another_system_needs_one_line():
    model = "letter q = 1/2 in [0, 1]\nsystem {}\nomega = rfAND(1 - x^2, 1 - y^2)"
    at = {"Ralpha q": RAlpha(sp.Rational(1, 2)), "Rp 4": Rp(4), "R0m 2": R0m(2)}
    for text, system in at.items():
        shape = rsym.loads(model.format(text))
        expected = rsym.compile(Shape(system.conjunction(1 - x**2, 1 - y**2), (x, y)))(0.3, 0.4)["value"]
        assert_close(rsym.compile(shape)(0.3, 0.4)["value"], float(expected), rtol=1e-14)


MODEL = """
coordinates x y
letter a = 2
f = conjunction(a - x, y)
g = disjunction(1 - y, x + 3)
omega = difference(f, g)
"""


@pytest.mark.parametrize("system", SYSTEMS)
def test_another_system_is_the_same_logic(system):
    body = rsym.rectangle(2, 2) | Shape(x + y - 1, (x, y)) & Shape(2 - x, (x, y))
    moved = body.with_system(system)
    points = np.random.default_rng(7).uniform(-3, 3, (2, 500))
    before, after = (rsym.compile(shape, backend="numpy")(*points)["value"] for shape in (body, moved))
    assert (np.sign(before) == np.sign(after)).all()
    assert moved.with_system(R0) == body


def test_another_system_reaches_parts_definitions_and_what_lies_within_sums():
    body = rsym.loads(MODEL)
    moved = body.named("body").with_system(Rp(4))
    assert dict(moved.parts)["body"] == moved.expression
    assert [str(value) for _, value in moved.definitions] == [
        "conjunction(a - x, y, system=Rp(4))",
        "disjunction(1 - y, x + 3, system=Rp(4))",
        "conjunction(f, -g, system=Rp(4))",
    ]
    assert moved.letters == body.letters
    offset = Shape(conjunction(x, y) - 1, (x, y)).with_system(Rp(4))
    assert offset.expression == conjunction(x, y, system=Rp(4)) - 1


def test_another_system_leaves_blends_and_other_functions():
    blend = Shape(rsym.Rho(1).conjunction(x, y) + sp.Min(x, y), (x, y))
    assert blend.with_system(R1) == blend


def test_a_system_may_bring_a_letter():
    moved = (Shape(x, (x, y)) & Shape(y, (x, y))).with_system(RAlpha(alpha), letters={alpha: 0.5})
    assert moved.expression == conjunction(x, y, system=RAlpha(alpha))
    assert moved.letters["alpha"].default == 0.5
    with pytest.raises(RsymError, match="neither coordinate nor letter"):
        (Shape(x, (x, y)) & Shape(y, (x, y))).with_system(RAlpha(alpha))


@pytest.mark.parametrize("wrong", ["Rp", 4, Rp, None])
def test_what_is_no_system_is_refused(wrong):
    with pytest.raises(RsymError, match="expected an R-system"):
        Shape(x, (x, y)).with_system(wrong)
