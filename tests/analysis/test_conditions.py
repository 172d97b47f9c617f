"""Conditions as data: what may be given, and what it means."""

import pickle

import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.analysis.conditions import as_condition


def test_numbers_are_exact_and_symbols_real():
    assert rsym.dirichlet(0.1).value == sp.Rational(1, 10)
    assert rsym.robin(sp.Symbol("c"), sp.Symbol("x") * y).values == (sp.Symbol("c", real=True), x * y)


def test_a_bare_value_is_that_of_the_function_and_a_flux_alone_has_no_coefficient():
    assert as_condition(x) == rsym.dirichlet(x)
    assert as_condition(rsym.clamped(x)) == rsym.clamped(x, 0)
    assert rsym.neumann(x) == rsym.robin(0, x) != rsym.robin(x)


def test_shapes_and_functions_stay_what_they_are():
    field = rsym.disc(1)
    assert rsym.dirichlet(field).value is field
    assert rsym.robin(max, field).values == (max, field)
    assert as_condition(field) == rsym.dirichlet(field)


@pytest.mark.parametrize(
    "make", [rsym.dirichlet, rsym.neumann, rsym.robin, rsym.clamped, rsym.supported, lambda v: rsym.robin(1, v)]
)
@pytest.mark.parametrize("wrong", ["x", None, sp.nan, 1j, sp.Symbol, [1, 2], float("inf")])
def test_what_is_no_value(make, wrong):
    with pytest.raises(rsym.RsymError) as raised:
        make(wrong)
    assert raised.value.code == "condition"


def test_conditions_travel_and_are_keys():
    given = [rsym.robin(2, x), rsym.constant(), rsym.clamped(), rsym.supported(y)]
    assert pickle.loads(pickle.dumps(given)) == given
    assert len({*given, rsym.constant()}) == 4
