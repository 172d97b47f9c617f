"""Conditions by name come to the right leaves; names that hold nothing are refused."""

import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.analysis.conditions import as_condition
from rsym.problems.conditions import resolved

A, B, C = rsym.dirichlet(1), rsym.neumann(2), rsym.robin(3, x)
PLATE = (rsym.disc(2).named("rim") & rsym.Shape(x, (x, y))).named("plate") - rsym.disc(1).named("bore")


def test_each_leaf_has_the_condition_of_its_part():
    assert resolved(PLATE, {"bore": 1, "rim": B}) == (B, None, A)
    assert resolved(PLATE, {"bore": A, ...: C}) == (C, C, A)
    assert resolved(PLATE, 0) == (as_condition(0),) * 3
    assert resolved(PLATE, {}) == (None,) * 3


def test_the_smallest_part_that_is_named_holds():
    assert resolved(PLATE, {"plate": A, "bore": B}) == (A, A, B)
    assert resolved(PLATE, {"plate": A, "rim": B, ...: C}) == (B, A, C)


def test_several_parts_of_one_name_have_one_condition():
    holes = [rsym.disc(0.1, (k, 0)).named("holes") for k in (-0.5, 0.5)]
    assert resolved(rsym.disc(1).named("rim") - holes[0] - holes[1], {"holes": A, "rim": B}) == (B, A, A)


def test_a_leaf_of_no_part_is_called_by_its_formula():
    assert resolved(rsym.disc(1).named("rim") & rsym.Shape(x, (x, y)), {"x": A, "rim": B}) == (B, A)


@pytest.mark.parametrize("name", ["bor", 3, None])
def test_an_unknown_part_is_refused_with_the_names(name):
    with pytest.raises(rsym.RsymError, match="it has rim, plate, bore") as raised:
        resolved(PLATE, {name: 1})
    assert raised.value.code == "unknown-part"


def test_a_condition_that_would_hold_nowhere_is_refused():
    inner = rsym.disc(2).named("rim") & rsym.Shape(x, (x, y)).named("cut")
    with pytest.raises(rsym.RsymError, match="all of that part belongs to rim, cut"):
        resolved(inner.named("plate"), {"plate": A, "rim": B, "cut": C})


def test_a_symbol_that_the_shape_does_not_know_is_refused_and_a_letter_is_none():
    c = sp.Symbol("c", real=True)
    with pytest.raises(rsym.RsymError, match="the rest contains c, neither") as raised:
        resolved(PLATE, {...: rsym.robin(c)})
    assert raised.value.code == "unknown-letter"
    known = PLATE.replace(letters={**PLATE.letters, "c": 1})
    assert resolved(known, {"bore": rsym.robin(c)})[2] == rsym.robin(c)
    with pytest.raises(rsym.RsymError, match="expected a Shape"):
        resolved(3, {})


def test_parts_of_one_formula_in_two_places_have_one_condition():
    left, right = ((x, "low", -2), (-x, "high", 2))
    halves = [
        rsym.Shape(side, (x, y)) & rsym.Shape(y, (x, y)).named(name) & rsym.disc(1 + abs(at))
        for side, name, at in (left, right)
    ]
    shape = halves[0] | halves[1]
    with pytest.raises(rsym.RsymError, match="'low' and 'high' have one formula") as raised:
        resolved(shape, {"low": A})
    assert (raised.value.code, bool(raised.value.remedy)) == ("ambiguous-part", True)
    assert A in resolved(shape, {"low": A, ...: A})
    # Two names of one place.
    model = rsym.loads("rim = 1 - x^2 - y^2; edge = rim; omega = rfAND(edge, x)")
    assert resolved(model, {"edge": A}) == (A, None)
