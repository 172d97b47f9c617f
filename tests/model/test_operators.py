"""What Python would answer of shapes without a word, and what is refused instead."""

import math
import operator

import pytest
import sympy as sp

import rsym
from rsym import x, y

DISC, OTHER = rsym.disc(1), rsym.disc(2)
REFUSED = {
    "and": (lambda: DISC and OTHER, "a & b"),
    "or": (lambda: DISC or OTHER, "a | b"),
    "not": (lambda: not DISC, "~a"),
    "if": (lambda: 1 if DISC else 2, "shape is None"),
    "plus": (lambda: DISC + OTHER, "a | b is the union"),
    "sum": (lambda: sum([DISC, OTHER]), "a | b is the union"),
    "times": (lambda: DISC * OTHER, "a & b the intersection"),
    "twice": (lambda: 2 * DISC, "shape.scale(2)"),
    "over": (lambda: DISC / 2, "shape.scale(1/2)"),
    "minus": (lambda: -DISC, "~a is the complement"),
    "less a number": (lambda: DISC - 1, "rsym.offset(shape, distance)"),
    "less": (lambda: DISC < 1, "shape.contains(x, y)"),
    "max": (lambda: max(DISC, OTHER), "shape.contains(x, y)"),
    "in": (lambda: (0, 0) in DISC, "shape.contains(x, y)"),
}


@pytest.mark.parametrize(("question", "remedy"), REFUSED.values(), ids=REFUSED)
def test_what_is_no_logic_of_shapes_names_what_is(question, remedy):
    with pytest.raises(rsym.RsymError) as raised:
        question()
    assert remedy in raised.value.remedy


def test_remedies_of_operators_are_carried_out():
    a, b, shape = DISC, rsym.disc(1, (1, 0)), DISC
    assert [s.contains(0.9, 0) for s in (a | b, a & b, a - b, ~a)] == [True, True, False, False]
    assert shape.scale(2).contains(1.5, 0)
    assert not shape.scale(1 / 2).contains(0.9, 0)
    assert shape is not None
    assert shape.expression.subs({x: 0, y: 0}) > 0


def test_shapes_are_still_compared_and_kept_in_lists():
    assert operator.eq(DISC, rsym.disc(1))
    assert DISC in [OTHER, DISC]
    assert DISC != 1


@pytest.mark.parametrize("given", [90, 360, -45, 7.5])
def test_degrees_where_radians_are_meant_are_told(given):
    with pytest.warns(rsym.RsymWarning, match=r"radians.*degrees=True, or math.radians"):
        DISC.rotate(given)


@pytest.mark.filterwarnings("error")
def test_other_angles_are_not():
    a = sp.Symbol("a", real=True)
    for given in (3, -6.28, 4 * sp.pi, math.radians(450), 20 * a):
        DISC.rotate(given, letters={a: 1})
    DISC.rotate(450, degrees=True)


def test_an_arc_in_degrees_is_told_of_them():
    with pytest.raises(rsym.RsymError) as raised:
        rsym.arc(2, 0, 90)
    assert "degrees=True" in raised.value.remedy
    rsym.arc(2, 0, 90, degrees=True)
