import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import R0, R1, conjunction, disjunction, trimming, x, y, z
from rsym.model.nodes import Held
from rsym.model.rnodes import R0Conjunction


def test_n_ary_nodes_are_flat_and_mean_the_left_fold():
    assert conjunction(x, y, z) == conjunction(conjunction(x, y), z)
    assert conjunction(x, y, z) != conjunction(x, conjunction(y, z))
    assert conjunction(x, y, z).doit() == conjunction(conjunction(x, y).doit(), z).doit()


def test_r0_is_not_associative_with_the_known_numbers():
    assert_close(float(conjunction(1, 2, 3).evalf()), 0.66819, atol=5e-6)
    assert_close(float(conjunction(1, conjunction(2, 3)).evalf()), 0.67850, atol=5e-6)
    assert_close(float(conjunction(1, 2, 3, 4).evalf()), 0.6128, atol=5e-5)


def test_operands_are_never_reordered():
    assert conjunction(z, x, y).args == (z, x, y)
    assert disjunction(y, x).args == (y, x)


@pytest.mark.parametrize("system", [R0, R1])
def test_de_morgan(system):
    left = -system.conjunction(x, y)
    right = system.disjunction(-x, -y)
    assert sp.simplify(left.doit() - right.doit()) == 0


@pytest.mark.parametrize("node", [conjunction(x, y, z), disjunction(x * y, z, y), trimming(x, y)])
def test_fdiff_is_the_derivative_of_the_square_roots(node):
    for symbol in (x, y, z):
        difference = sp.diff(node, symbol).doit() - sp.diff(node.doit(), symbol)
        at = {x: sp.Rational(3, 7), y: -sp.Rational(2, 5), z: sp.Rational(9, 8)}
        assert abs(difference.subs(at).evalf(30)) < sp.Float("1e-25")


def test_evalf_does_not_cancel():
    value = conjunction(sp.Rational(1, 10**20), 1).evalf(30)
    exact = sp.Rational(1, 10**20)
    exact = (exact + 1 - sp.sqrt(exact**2 + 1)).evalf(30, maxn=200)
    assert abs(value / exact - 1) < sp.Float("1e-28")


def test_a_float_operand_does_not_make_its_neighbours_floats():
    assert conjunction(x / 3, 0.5).args[0] == x / 3


def test_latex_uses_the_symbols_of_the_source():
    assert sp.latex(conjunction(x, y)) == r"\left(x \wedge_0 y\right)"
    assert sp.latex(disjunction(x + 1, y, system=R1)) == r"\left(\left(x + 1\right) \vee_1 y\right)"
    assert sp.latex(conjunction(x, y) ** 2) == r"\left(x \wedge_0 y\right)^{2}"


@pytest.mark.parametrize("cse", [False, True])
def test_plain_lambdify_works_at_once(cse):
    function = sp.lambdify((x, y), [conjunction(x, y) + 2, disjunction(x, y) * conjunction(x, y)], cse=cse)
    first, second = function(np.array([3.0, 1e-20]), np.array([4.0, 1.0]))
    assert_close(first, [4.0, 2.0], rtol=1e-15)
    assert_close(second, [24.0, 2e-20], rtol=1e-15)


def test_lambdify_on_other_packages():
    derivative = sp.diff(disjunction(x, y, system=R1), x)
    for node in (conjunction(x, y), disjunction(x, y, system=R1), trimming(x, y), derivative):
        exact = sp.lambdify((x, y), node, modules="mpmath")(mpmath.mpf(3), mpmath.mpf(-4))
        plain = sp.lambdify((x, y), node, modules="math")(3.0, -4.0)
        assert_close(float(plain), float(exact), rtol=1e-15)


def test_the_runtime_keeps_the_sign_of_tiny_numbers_and_nan():
    tiny = np.array([1e-170, -1e-170, 1e-170])
    other = np.array([-1e-170, 1e-170, 1e-180])
    both, either = sp.lambdify((x, y), [conjunction(x, y), disjunction(x, y)])(tiny, other)
    assert np.sign(both).tolist() == [-1, -1, 1]
    assert np.sign(either).tolist() == [1, 1, 1]
    for node in (conjunction(x, y, system=R1), disjunction(x, y, system=R1), conjunction(x, y)):
        function = sp.lambdify((x, y), node)
        assert np.isnan(function(np.array([np.nan, 1.0]), np.array([1.0, np.nan]))).all()


def test_a_deep_nest_prints_a_call_for_each_node_and_not_an_expansion():
    nest = x
    for k in range(12):
        nest = conjunction(nest - k, disjunction(nest, y))
    source = sp.lambdify((x, y), nest, cse=True).__doc__
    assert len(source) < 4000


def test_assumptions():
    node = conjunction(x, y)
    assert node.is_real
    assert node.is_extended_real
    assert node.is_commutative


def test_single_operand_and_text():
    assert conjunction(x) == x
    assert R0Conjunction(x) == x
    with pytest.raises(rsym.RsymError) as caught:
        conjunction("x", y)
    assert caught.value.code == "expression"
    with pytest.raises(rsym.RsymError):
        conjunction()


def test_the_derivative_of_r1_is_one_zero_or_undefined():
    ahead = sp.diff(disjunction(x, y, system=R1), x)
    assert sp.latex(ahead) == r"\left[x > y\right]"
    assert [float(ahead.subs({x: value, y: 2}).evalf()) for value in (1, 3)] == [0, 1]
    assert ahead.subs({x: 2, y: 2}).evalf() is sp.nan
    values = rsym.compile(rsym.Shape(ahead, (x, y)))([1, 2, 3], 2)["value"]
    assert_close(values[[0, 2]], [0, 1], atol=1e-300)
    assert np.isnan(values[1])


def test_held_constants_are_opaque_and_differentiate_to_zero():
    held = Held(sp.sqrt(2, evaluate=False))
    assert sp.Abs(held - 3, evaluate=False).has(Held)
    assert not held.is_number
    assert sp.diff(held * x, x) == held
