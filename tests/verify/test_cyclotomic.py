"""Exact numbers of turns and roots, against floats of 60 digits and against numbers that are nearly theirs."""

from fractions import Fraction
from random import Random

import mpmath
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.verify.boxes.cyclotomic import Field, order_for_root
from rsym.verify.boxes.folding import folded
from rsym.verify.boxes.local import Model
from rsym.verify.boxes.polynomials import multiplicity, ring_of, same_zeros

DIGITS = 60
BOX = ((-1, 1),) * 3


def number(field, element):
    with mpmath.workdps(DIGITS):
        return mpmath.mpf(sp.N(field.written(element), DIGITS))


@pytest.mark.random
@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16, 20, 24, 28, 32, 36, 192])
def test_cosines_and_what_is_made_of_them(order):
    field, chance = Field(order), Random(order)
    with mpmath.workdps(DIGITS):
        for k in (0, 1, order // 3, order // 2, order - 1, order + 2, -3):
            cosine = field.cosine(Fraction(k, order))
            assert abs(number(field, cosine) - mpmath.cos(2 * mpmath.pi * k / order)) < 1e-50
        for _ in range(5):
            parts = [field.cosine(Fraction(chance.randrange(order), order)) for _ in range(3)]
            parts = [part + field.rational(Fraction(chance.randint(-9, 9), 7)) for part in parts]
            total = parts[0] * parts[1] - parts[2]
            value = number(field, parts[0]) * number(field, parts[1]) - number(field, parts[2])
            assert abs(number(field, total) - value) < 1e-45
            assert field.sign(total) == (0 if abs(value) < 1e-45 else mpmath.sign(value))
            root = field.root(total * total)
            assert root in (total, -total)
            assert field.sign(root) >= 0
    assert field.cosine(Fraction(1, 5 * order if order % 5 else 7 * order)) is None


@pytest.mark.parametrize(
    "value", [Fraction(2), Fraction(3), Fraction(5, 4), Fraction(7, 12), Fraction(30), Fraction(1, 49)]
)
def test_roots_of_fractions(value):
    field = Field(order_for_root(value))
    root = field.root(field.rational(value))
    assert root * root == field.rational(value)
    assert field.sign(root) > 0
    assert field.sign(root - field.rational(Fraction(str(round(float(value) ** 0.5, 8))) - Fraction(1, 10**7))) > 0
    assert field.root(field.rational(-value)) is None


def model_of(expression):
    return Model(rsym.Shape(expression, (x, y, z)), {})


@pytest.mark.random
@pytest.mark.parametrize("order", [3, 4, 5, 7, 8, 9, 12, 16, 24])
def test_a_turn_leaves_the_distance_from_the_axis(order):
    """Sines and cosines as SymPy writes them, roots within roots among them."""
    angle = sp.pi / order
    u, v = x * sp.cos(angle) + y * sp.sin(angle), y * sp.cos(angle) - x * sp.sin(angle)
    model = model_of(sp.Add(u**2, v**2, z))
    ring = ring_of(model)
    assert ring.polynomial(model.root).as_expr() == x**2 + y**2 + z
    near = model_of(sp.Add(u**2, v**2, z, x * y * sp.Rational(1, 10**40)))
    assert ring_of(near).polynomial(near.root).as_expr() != x**2 + y**2 + z


@pytest.mark.parametrize("step", [0, sp.Rational(1, 10**9), sp.Rational(1, 10**60)])
def test_what_nearly_cancels_does_not(step):
    """The third of a turn with a root of 3 that is right, and with one that is a little off."""
    root = sp.Rational(str(sp.N(sp.sqrt(3), 80))) if step == 0 else sp.sqrt(3) + step
    for other, exact in ((sp.sqrt(3), True), (root, False)):
        model = model_of(sp.Abs(sp.sqrt(3) * x - y) * sp.Abs(other * x - y) + z)
        product = (sp.sqrt(3) * x - y) ** 2 + z
        found = folded(model.over(BOX), model.root)
        assert (found is not None) == exact
        if exact:
            assert found == ring_of(model).polynomial(rsym.verify.boxes.polynomials.lower(model.builder, product))


@pytest.mark.parametrize("off", [0, sp.Rational(1, 10**30)])
def test_division_is_exact(off):
    border = sp.cos(sp.pi / 7) * x - sp.sin(sp.pi / 7) * y
    lower = rsym.verify.boxes.polynomials.lower
    model = model_of(border)
    difference = lower(model.builder, border * (x - sp.sin(3 * sp.pi / 7) * z) + off * z)
    assert multiplicity(model, difference, model.root) == (1 if off == 0 else 0)
    squared = lower(model.builder, border**2 * (1 + z))
    assert multiplicity(model, squared, model.root) == 2
    assert same_zeros(model, lower(model.builder, off * x - border), model.root) == (off == 0)


def test_numbers_of_no_such_field_are_left_alone():
    for strange in (sp.sqrt(1 + sp.sqrt(2)), sp.cos(1), sp.exp(1), sp.log(2), sp.cos(sp.pi / 1009)):
        model = model_of(strange * x - y)
        assert ring_of(model).polynomial(model.root) is None
        assert multiplicity(model, model.root, model.root) == 0
