"""Sources with poles: refused with the place where they have no integral, else taken."""

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.problems.sources import require_integrable

PLATE, BOX = rsym.rectangle(2, 1), rsym.box(2, 1, 1)
FLAT, ROUND = x**2 + y**2, x**2 + y**2 + z**2
REFUSED = {
    1 / x: "(0, ",
    1 / FLAT: "(0, 0)",
    sp.tan(3 * x): "(-0.5236, ",
    1 / (x - sp.Rational(1, 7)): "(0.1429, ",
    1 / (FLAT - sp.Rational(1, 5)): "power -1",
    sp.exp(1 / FLAT): "(0, 0)",
    1 / (x - y): "power -1",
    1 / (x**2 + y**2 + z**2) ** sp.Rational(3, 2): "(0, 0, 0)",
    1 / (x + z): "power -1",
    1 / (x**2 + z**2): "power -2",
}
TAKEN = [
    sp.log(FLAT),
    1 / sp.sqrt(FLAT),
    x / FLAT,
    sp.sin(x) / x,
    1 / sp.sqrt(sp.Abs(x)),
    sp.log(sp.Abs(x)),
    1 / (FLAT + sp.Rational(1, 1000)),
    1 / (x**2 - 2 * x * y + y**2 + sp.Rational(1, 10000)),
    1 / (x - 2),
    1 / (1 - x),
    1 / sp.Max(sp.Rational(1, 10), sp.Abs(x)),
    sp.Piecewise((1 / x, x > sp.Rational(1, 10)), (10, True)),
    sp.sqrt(1 + x) / (1 + x),
    1 / sp.sqrt(ROUND),
    1 / ROUND,
    1 / sp.sqrt(x**2 + z**2),
]


@pytest.mark.parametrize("source", REFUSED, ids=str)
def test_poles_without_an_integral_are_refused_with_the_place(source):
    shape = BOX if source.has(z) else PLATE
    with pytest.raises(rsym.RsymError) as refused:
        rsym.solve(shape, "-laplacian(u) = f", 0, letters={"f": source}, cells=4)
    assert refused.value.code == "pole"
    assert REFUSED[source] in str(refused.value)


@pytest.mark.parametrize("source", TAKEN, ids=str)
def test_others_are_taken(source):
    require_integrable(BOX if source.has(z) else PLATE, source, "the right side")


@pytest.mark.parametrize("degree", [4, 5])
def test_a_pole_that_has_an_integral_is_right_to_its_estimate(degree):
    # Of 1/r on the disc the solution is 1 - r.
    u = rsym.solve(rsym.disc(1), "-laplacian(u) = 1/sqrt(x**2 + y**2)", 0, cells=33, degree=degree)
    assert abs(u(0.3, 0.4) - 0.5) <= 3 * u.report.estimate < 0.03


def test_letters_weak_forms_and_bodies_are_looked_at_too():
    a = sp.Symbol("a", real=True)
    shape = PLATE.replace(letters={"a": 2})
    u = rsym.solve(shape, "-laplacian(u) = 1/(x - a)", 0, cells=8)
    with pytest.raises(rsym.RsymError, match="has a pole"):
        u.with_letters({"a": 0.5})
    load = (1 / (x - sp.Rational(1, 3)), 0)
    with pytest.raises(rsym.RsymError, match="the force on a volume has a pole"):
        rsym.elasticity(PLATE, {...: rsym.fixed()}, young=1, poisson=0.3, loads=load, cells=8)
    assert a.name in u.shape.letters
