"""Simplifications are exact: they change neither values nor where a value is undefined."""

from fractions import Fraction

import numpy as np
import pytest

from rsym.backends.interpreter import interpret
from rsym.program.builder import Builder


@pytest.fixture
def b():
    return Builder(("u", "v"), ("a",))


def test_equal_nodes_exist_once(b):
    u, v = b.input("u"), b.input("v")
    assert b.add(u, v) == b.add(v, u)
    assert b.mul(u, v) == b.mul(v, u)
    assert b.sub(u, v) != b.sub(v, u)


def test_constants_fold_exactly(b):
    third = b.const(Fraction(1, 3))
    assert b.value(b.add(third, b.const(Fraction(1, 6)))) == Fraction(1, 2)
    assert b.value(b.div(third, b.const(7))) == Fraction(1, 21)
    assert b.value(b.powi(third, -5)) == 243
    assert b.value(b.sqrt(b.const(Fraction(4, 9)))) == Fraction(2, 3)
    assert b.value(b.sqrt(b.const(2))) is None
    assert b.value(b.sqrt(b.const(-4))) is None
    assert b.value(b.mul(b.const(2), b.mul(b.const(5), b.input("u")))) is None
    assert b.mul(b.const(2), b.mul(b.const(5), b.input("u"))) == b.mul(b.const(10), b.input("u"))


def test_folding_stops_before_it_costs_time(b):
    number = b.const(3)
    for _ in range(40):
        number = b.square(number)
    assert all(node.data is None or node.data.numerator.bit_length() <= 4096 for node in b.nodes)


def test_neutral_elements_and_signs(b):
    u, v = b.input("u"), b.input("v")
    zero, one = b.const(0), b.const(1)
    assert [b.add(u, zero), b.mul(u, one), b.div(u, one), b.neg(b.neg(u)), b.powi(u, 1)] == [u] * 5
    assert [b.mul(u, zero), b.div(zero, u)] == [zero, zero]
    assert b.mul(b.neg(u), b.neg(v)) == b.mul(u, v)
    assert b.div(b.neg(u), v) == b.neg(b.div(u, v)) == b.div(u, b.neg(v))
    assert b.powi(b.neg(u), 3) == b.neg(b.powi(u, 3))
    assert b.powi(b.neg(u), 4) == b.powi(u, 4)
    assert b.abs(b.neg(u)) == b.abs(u)


def test_roots_and_squares(b):
    u, v = b.input("u"), b.input("v")
    squares = b.add(b.square(u), b.square(v))
    assert b.square(b.sqrt(squares)) == squares
    assert b.powi(b.sqrt(squares), 4) == b.square(squares)
    assert b.sqrt(b.square(u)) == b.abs(u)
    assert b.abs(squares) == squares


def test_the_square_of_a_root_stays_undefined_where_the_root_is(b):
    node = b.square(b.sqrt(b.input("u")))
    value = interpret(b.program({"f": node}), {"u": -1.0, "v": 0.0, "a": 0.0})["f"]
    assert np.isnan(value)


def test_a_division_by_letters_is_an_inversion_once_for_all_points(b):
    quotient = b.div(b.input("u"), b.square(b.input("a")))
    operation, arguments, _ = b.nodes[quotient]
    assert operation == "mul"
    assert sum(b.uniform[argument] for argument in arguments) == 1


def test_normalisation_needs_something_that_is_not_negative(b):
    u, v = b.input("u"), b.input("v")
    assert b.normalisation(u, b.sqrt(b.add(b.square(u), b.square(v)))) == b.normalised(u, b.square(v))
    assert b.normalisation(u, b.sqrt(b.add(b.square(u), v))) is None
    assert b.normalisation(u, b.sqrt(b.square(v))) is None
    assert b.normalisation(u, b.add(u, v)) is None
