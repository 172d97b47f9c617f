"""An equation becomes its coefficients, whichever way it is written; what is none is refused with a remedy."""

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.problems.equations import equation_of

K = sp.exp(x) * (2 + sp.cos(y))
NAMES = {"k": K, "c": lambda x, y: x}
U = sp.Function("u")(x, y)


def applied(equation, u):
    """The equation at a function: the left side minus the right one, by SymPy alone."""
    axes = range(len(equation.coordinates))
    slope = [u.diff(symbol) for symbol in equation.coordinates]
    flux = [sum(equation.diffusion[i][j] * slope[j] for j in axes) for i in axes]
    total = -sum(flux[i].diff(equation.coordinates[i]) for i in axes)
    total += sum(b * s for b, s in zip(equation.convection, slope, strict=True)) + equation.reaction * u
    laplacian = sum(u.diff(symbol, 2) for symbol in equation.coordinates)
    total += equation.bending * sum(laplacian.diff(symbol, 2) for symbol in equation.coordinates)
    return total - equation.load


def laplacian(u):
    return u.diff(x, 2) + u.diff(y, 2)


MEANINGS = {
    "-laplacian(u) = 2*x": lambda u: -laplacian(u) - 2 * x,
    "laplacian(u) = u - pi": lambda u: -laplacian(u) + u - sp.pi,
    "-div(k*grad(u)) + y*u = 1": lambda u: -(K * u.diff(x)).diff(x) - (K * u.diff(y)).diff(y) + y * u - 1,
    "-k*laplacian(u) = 0": lambda u: -K * laplacian(u),
    "-laplacian(k*u) = 0": lambda u: -laplacian(K * u),
    "-diff(u, x, x) - 2*diff(u, y, y) + diff(u, x, y)/2 = sin(x)": lambda u: (
        -u.diff(x, 2) - 2 * u.diff(y, 2) + u.diff(x, y) / 2 - sp.sin(x)
    ),
    "-laplacian(u) + dot([y, 2], grad(u)) = div([x^2, y])": lambda u: (
        -laplacian(u) + y * u.diff(x) + 2 * u.diff(y) - 2 * x - 1
    ),
    "-laplacian(u) - x*diff(u, x)/(1 + y^2) = 0": lambda u: -laplacian(u) - x * u.diff(x) / (1 + y**2),
    "-div(grad(u) + [x, y]*u) = 0": lambda u: -laplacian(u) - (x * u).diff(x) - (y * u).diff(y),
    "-div([2*diff(u, x) + k*diff(u, y), k*diff(u, x) + (3*diff(u, y) + x*u)]) = 1": lambda u: (
        -(2 * u.diff(x) + K * u.diff(y)).diff(x) - (K * u.diff(x) + 3 * u.diff(y) + x * u).diff(y) - 1
    ),
    "-div([[2, k], [y, 3]]*(grad(u) + [x, 1]*u)) = 1": lambda u: (
        -(2 * (u.diff(x) + x * u) + K * (u.diff(y) + u)).diff(x)
        - (y * (u.diff(x) + x * u) + 3 * (u.diff(y) + u)).diff(y)
        - 1
    ),
    "3*bilaplacian(u) - laplacian(u) = x": lambda u: 3 * laplacian(laplacian(u)) - laplacian(u) - x,
    "laplacian(laplacian(u)) = 1": lambda u: laplacian(laplacian(u)) - 1,
}


@pytest.mark.parametrize("text", MEANINGS)
def test_a_text_means_its_formula(text):
    equation = equation_of(text, (x, y), NAMES)
    u = x**4 * y + sp.sin(x) * y**3 + x * y**4
    assert sp.simplify(applied(equation, u) - MEANINGS[text](u)) == 0


@pytest.mark.parametrize(
    "given",
    [
        sp.Eq(-U.diff(x, 2) - U.diff(y, 2) + x * U, y),
        -((2 + x**2) * U.diff(x)).diff(x) - U.diff(y, 2) + U.diff(y),
        sp.Eq(U.diff(x, 4) + 2 * U.diff(x, 2, y, 2) + U.diff(y, 4), 5),
    ],
)
def test_an_equation_of_sympy_means_itself(given):
    equation = equation_of(given, (x, y))
    u = x**4 * y + sp.sin(x) * y**3 + x**3 * y**4
    whole = given.lhs - given.rhs if isinstance(given, sp.Equality) else given
    assert sp.simplify(applied(equation, u) - whole.subs(U, u).doit()) == 0


def test_in_space_there_are_three_derivatives():
    equation = equation_of("-laplacian(u) + dot([1, 2, 3], grad(u)) = z", (x, y, z))
    assert [row[k] for k, row in enumerate(equation.diffusion)] == [1, 1, 1]
    assert (equation.convection, equation.load) == ((1, 2, 3), z)


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("u = 1", "not-elliptic", "not elliptic"),
        ("-laplacian(u) = u^2", "equation", "not linear"),
        ("-laplacian(u) = u*u", "equation", "not linear"),
        ("-laplacian(sin(u)) = 1", "equation", "not linear"),
        ("-laplacian(laplacian(laplacian(u))) = 1", "equation", "order"),
        ("-laplacian(u)", "unfinished", "'=' must follow"),
        ("-laplacian(u) = q", "unknown-name", "'q'"),
        ("-c*laplacian(u) = 1", "equation", "Python function"),
        ("grad(u) = 1", "equation", "vector"),
        ("-laplacian(u) = 1 2", "syntax", "end of the equation"),
        ("-laplace(u) = 1", "unknown-name", "no function 'laplace'"),
        ("-laplacian(u) = __import__(1)", "name", "not a name"),
        ("-diff(u, k) = 1", "equation", "by coordinates"),
        ("(1 + x^2)*bilaplacian(u) = 1", "equation", "depends on x"),
        ("-dot(grad(u), grad(u)) = 1", "equation", "without u"),
        ("-div([[2, 1], 3]*grad(u)) = 1", "equation", "a vector has 2 numbers"),
        ("-div([[2, 1, 0], [1, 3, 0]]*grad(u)) = 1", "equation", "a vector has 2 numbers"),
        ("-div(grad(u)*[[2, 1], [1, 3]]) = 1", "equation", "product of vectors"),
        ("[[2, 1], [1, 3]]*grad(u) = 1", "equation", "a vector stands"),
        ("[[2, 1], [1, 3]] = u", "equation", "a matrix stands"),
        ("-div(grad([[2, 1], [1, 3]])) = u", "equation", "grad takes a number"),
        ("-laplacian(u) = sin([[2, 1], [1, 3]])", "equation", "sin of a vector or a matrix"),
        ("-div([laplacian(u), 0]) = 1", "equation", "order"),
    ],
)
def test_what_is_no_equation_is_refused_with_a_remedy(text, code, words):
    with pytest.raises(rsym.RsymError, match=words) as raised:
        equation_of(text, (x, y), NAMES)
    assert raised.value.code == code
    assert raised.value.remedy


TENSOR = sp.Matrix([[2 + x, y], [x, 3]])


@pytest.mark.parametrize("matrix", [TENSOR, [[2 + x, y], [x, 3]], ((2 + x, rsym.Shape(y, (x, y))), (x, 3))])
@pytest.mark.parametrize("vector", [sp.Matrix([y, 2]), (y, 2)])
def test_matrices_and_vectors_are_coefficients(matrix, vector):
    text = "-div(2*k*grad(u)/3) - div((k + [[1, 0], [0, 1]])*[x*u, 1]) + dot(b, grad(u)) = dot(b, [1, x])"
    equation = equation_of(text, (x, y), {"k": matrix, "b": vector})
    u = x**4 * y + sp.sin(x) * y**3
    flux = sp.Rational(2, 3) * TENSOR * sp.Matrix([u.diff(x), u.diff(y)]) + (TENSOR + sp.eye(2)) * sp.Matrix([x * u, 1])
    wanted = -flux[0].diff(x) - flux[1].diff(y) + y * u.diff(x) + 2 * u.diff(y) - y - 2 * x
    assert sp.simplify(applied(equation, u) - wanted) == 0


def test_entries_of_a_matrix_may_be_functions():
    equation = equation_of("-div(k*grad(u)) = 1", (x, y), {"k": [[lambda x, y: 2 + x, 0], [0, 1]]})
    ((name, function),) = equation.functions.items()
    assert equation.diffusion == ((sp.Symbol(name, real=True), 0), (0, 1))
    assert function(3.0, 0.0) == 5.0


@pytest.mark.parametrize("wrong", [(1, 2, 3), ((1, 2), 3), ((1, 2, 3), (4, 5, 6)), (((1, 2), 3), (4, 5))])
def test_what_is_no_matrix_of_the_plane_is_refused(wrong):
    with pytest.raises(rsym.RsymError, match="neither a vector of 2") as raised:
        equation_of("-div(k*grad(u)) = 1", (x, y), {"k": wrong})
    assert raised.value.code == "equation"


def test_several_unknown_functions_are_refused():
    other = sp.Function("v")(x, y)
    with pytest.raises(rsym.RsymError, match="one unknown function"):
        equation_of(-U.diff(x, 2) - other, (x, y))
