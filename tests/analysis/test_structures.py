"""Structures meet their conditions identically: reduced modulo w = 0 and |grad w| = 1, for any w and any functions."""

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.analysis.conditions import clamped, constant, dirichlet, neumann, robin, supported
from rsym.analysis.structures import Conditioned, structure_of
from rsym.model.letters import Letters
from rsym.model.nodes import without_zeros

w = sp.Function("w", real=True)(x, y)
p, q = sp.symbols("p q", real=True)
G, H, K = (sp.Function(name, real=True)(x, y) for name in "GHK")


def plain(structure):
    """The expression in plain arithmetic."""
    return without_zeros(structure.expression).doit()


def slope(u, weight):
    """The derivative along the inner normal."""
    return sum(sp.diff(weight, s) * sp.diff(u, s) for s in (x, y))


def on_the_zero_set(expression, weight=w):
    """Reduced by w = 0 and w_x**2 + w_y**2 = 1: what is left of an identity is 0."""
    second = {sp.Derivative(weight, (s, 2)): sp.Symbol(f"second_{s}") for s in (x, y)}
    second |= {sp.Derivative(weight, x, y): sp.Symbol("mixed"), sp.Derivative(weight, y, x): sp.Symbol("mixed")}
    first = {sp.Derivative(weight, x): p, sp.Derivative(weight, y): q}
    reduced = sp.expand(expression.subs(second).subs(first).subs(weight, 0).doit())
    return sp.expand(sp.rem(reduced, p**2 + q**2 - 1, q)) if reduced.has(q) else reduced


def alone(condition):
    return plain(structure_of([Conditioned(condition, w, w)], (x, y)))


def test_dirichlet():
    for given in (dirichlet(G), supported(G)):
        assert on_the_zero_set(alone(given) - G) == 0


@pytest.mark.parametrize("condition", [robin(K, H), robin(3, x), neumann(H)])
def test_robin(condition):
    u = alone(condition)
    residual = -slope(u, w) + condition.coefficient * u - condition.flux
    assert on_the_zero_set(residual) == 0
    assert on_the_zero_set(residual + slope(w * x, w)) != 0  # red proof


def test_clamped():
    u = alone(clamped(G, H))
    assert on_the_zero_set(u - G) == 0
    assert on_the_zero_set(-slope(u, w) - H) == 0


def test_nothing_said_is_met_by_anything():
    assert structure_of([], (x, y)).expression == sp.Function("Phi_1")(x, y)


CORNER = {"left": x, "floor": y}  # x = 0 and y = 0, each normalised


def on(u, side):
    """Value and outward slope on a side of the quadrant."""
    values = []
    for expression in (u, -sp.diff(u, side)):
        t = sp.Symbol("t", positive=True)
        other = y if side == x else x
        values.append(sp.simplify(expression.subs(other, t).doit().subs(side, 0).doit().subs(t, other)))
    return values


MIXED = [
    [dirichlet(x * y + 1), robin(2, sp.sin(x))],
    [neumann(y), robin(x + 1, 3)],
    [clamped(2, x + y), robin(5, x)],
    [clamped(x**2, 1), dirichlet(y * x)],
    [dirichlet(1), constant()],
    [clamped(1, y), clamped(x + 1, 2)],
]


@pytest.mark.parametrize("conditions", MIXED, ids=lambda pair: " and ".join(type(one).__name__ for one in pair))
def test_mixed_at_a_right_corner(conditions):
    pieces = [Conditioned(one, side, side) for one, side in zip(conditions, (x, y), strict=True)]
    structure = structure_of(pieces, (x, y))
    images = [sp.exp(x - 2 * y), x + sp.cos(y)][: len(structure.unknowns)]
    u = without_zeros(structure.with_functions(*images).expression).doit()
    for condition, side in zip(conditions, (x, y), strict=True):
        value, outward = on(u, side)
        at = {side: 0}
        if condition == constant():
            assert value == sp.Symbol("C_1", real=True)
        elif hasattr(condition, "coefficient"):
            residual = outward + (condition.coefficient * value - condition.flux).subs(at)
            assert sp.simplify(residual) == 0
        else:
            assert sp.simplify(value - condition.value.subs(at)) == 0
        if hasattr(condition, "slope"):
            assert sp.simplify(outward - condition.slope.subs(at)) == 0


def test_expressions_functions_and_letters_are_one_structure():
    structure = structure_of([Conditioned(robin(2, 5), y, y)], (x, y))
    f, g = sp.sin(x * y), x - y
    functions = {sp.Function("Phi_1"): f, sp.Function("Phi_2"): g}
    written = structure.expression
    for name, image in functions.items():
        written = written.replace(name, sp.Lambda((x, y), image)).doit()
    assert sp.expand(without_zeros(written - structure.with_functions(f, g).expression)) == 0
    shape = structure.with_values()
    values = {"Phi_1": f, "Phi_1_y": sp.diff(f, y), "Phi_2": g}
    assert set(shape.letters) == set(values)
    placed = shape.expression.subs({sp.Symbol(name, real=True): value for name, value in values.items()})
    assert sp.expand(without_zeros(placed - structure.with_functions(f, g).expression)) == 0


def test_in_space():
    u = structure_of([Conditioned(robin(2, x), z, z)], (x, y, z)).with_functions(x * y + sp.sin(z), z).expression
    at_floor = [sp.simplify(without_zeros(e).subs(z, 0)) for e in (u, -sp.diff(without_zeros(u), z))]
    assert sp.simplify(at_floor[1] + 2 * at_floor[0] - x) == 0


def test_what_is_refused():
    structure = structure_of([Conditioned(dirichlet(1), y, y)], (x, y))
    with pytest.raises(rsym.RsymError, match="undetermined functions Phi_1, got 2"):
        structure.with_functions(1, 2)
    with pytest.raises(rsym.RsymError, match="neither coordinate nor letter"):
        structure.with_functions(sp.Symbol("k"))
    for name in ("Phi_1", "Phi_1_y", "C_1"):
        taken = Letters({name: rsym.Letter(1)})
        with pytest.raises(rsym.RsymError, match=f"{name!r} is the name of something undetermined"):
            structure_of([Conditioned(constant(), y, y)], (x, y), taken)
