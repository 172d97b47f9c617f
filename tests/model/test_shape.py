import pickle

import pytest
import sympy as sp

import rsym
from rsym import Letter, RsymError, Shape, conjunction, x, y, z
from rsym.program.fields import program_of

a = sp.Symbol("a", real=True)
b = sp.Symbol("b", real=True)


def test_foreign_symbols_become_the_real_ones_of_the_same_name():
    u, v = sp.symbols("x y")
    shape = Shape(u**2 + v, (u, v))
    assert shape.coordinates == (x, y)
    assert shape.expression == x**2 + y


def test_two_symbols_of_one_name_become_one():
    shape = Shape(sp.Symbol("x") - sp.Symbol("x", positive=True) + y, (x, y))
    assert shape.expression == y


def test_operators_are_the_operations():
    p, q = Shape(x, (x, y)), Shape(y, (x, y))
    assert (p & q).expression == conjunction(x, y)
    assert (p | q).expression == rsym.disjunction(x, y)
    assert (p - q).expression == conjunction(x, -y)
    assert (~p).expression == -x
    assert (p ^ q).expression == rsym.exclusive_or(x, y)


def test_operator_chains_give_the_same_program_as_one_operation():
    f, g, h = (Shape(e, (x, y)) for e in (x - 1, y * x, 1 - y))
    chained = program_of(f & g & h, ("value",))
    assert str(chained) == str(program_of(conjunction(f, g, h), ("value",)))
    assert str(chained) == str(program_of(conjunction(conjunction(f, g), h), ("value",)))


def test_combining_merges_letters_and_boxes():
    p = Shape(a - x, (x, y), letters={a: 1}, bounds=((-1, 1), (-1, 1)))
    q = Shape(b - y, (x, y), letters={b: 2}, bounds=((0, 3), (-2, 0)))
    both = p | q
    assert list(both.letters) == ["a", "b"]
    assert both.bounds is None
    assert both.box.ends == ((-1, 3), (-2, 1))
    assert (p & Shape(y, (x, y))).bounds == (p | p).bounds == (p - q).bounds == p.bounds


def test_conflicting_letters_are_refused():
    p, q = (Shape(a - x, (x, y), letters={a: value}) for value in (1, 2))
    with pytest.raises(RsymError) as caught:
        p & q
    assert caught.value.code == "letter-conflict"


def test_different_coordinates_are_refused():
    with pytest.raises(RsymError) as caught:
        Shape(x, (x, y)) & Shape(x, (x, y, z))
    assert caught.value.code == "coordinates"


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ((a * x, (x, y)), "unknown-letter"),
        (("x", (x, y)), "expression"),
        ((x, (x,)), "coordinates"),
        ((x, (x, x)), "coordinates"),
        ((x, "xy"), "coordinates"),
    ],
)
def test_bad_shapes_are_refused(arguments, code):
    with pytest.raises(RsymError) as caught:
        Shape(*arguments)
    assert caught.value.code == code


@pytest.mark.parametrize("bounds", [((0, 1),), ((1, 0), (0, 1)), ((0, float("inf")), (0, 1)), 3, (("a", 1), (0, 1))])
def test_bad_bounds_are_refused(bounds):
    with pytest.raises(RsymError) as caught:
        Shape(x, (x, y), bounds=bounds)
    assert caught.value.code == "bounds"


def test_letters_are_immutable_and_checked():
    shape = Shape(a - x, (x, y), letters={a: Letter(5, minimum=1, maximum=10)})
    with pytest.raises(TypeError):
        shape.letters["a"] = Letter(1)
    with pytest.raises(RsymError) as caught:
        Letter(11, minimum=1, maximum=10)
    assert caught.value.code == "letter-range"
    with pytest.raises(RsymError):
        Letter(float("nan"))
    with pytest.raises(RsymError):
        shape.with_letters({"a": 0})
    with pytest.raises(RsymError):
        shape.with_letters({"q": 1})
    assert shape.with_letters({"a": 2}).letters["a"] == Letter(2, minimum=1, maximum=10)
    assert shape.letters["a"].default == 5


def test_shapes_are_frozen_hashable_and_pickle():
    shape = Shape(conjunction(a - x, y), (x, y), letters={a: 1}, bounds=((0, 1), (0, 1)))
    with pytest.raises(AttributeError):
        shape.expression = x
    copy = pickle.loads(pickle.dumps(shape))
    assert copy == shape
    assert hash(copy) == hash(shape)


def test_latex_of_a_shape():
    assert Shape(conjunction(x, y), (x, y))._repr_latex_() == (
        r"$\displaystyle \omega\left(x, y\right) = x \wedge_0 y$"
    )
    text = Shape(x - a, (x, y), letters={a: 0.5}, bounds=((-1, 1), (0, 2.5)))._repr_latex_()
    assert r"\\ & x \in [-1, 1],\quad y \in [0, 2.5] \\ & a = 0.5 \end{aligned}$" in text


@pytest.mark.slow
@pytest.mark.parametrize(("system", "depth"), [(rsym.R0, 500), (rsym.R1, 250)])
def test_a_deep_nest(system, depth):
    nest = x
    for k in range(depth):
        nest = system.conjunction(nest, y - k) if k % 2 else system.disjunction(nest, -y - k)
    shape = Shape(nest, (x, y))
    kernel = rsym.compile(shape, ("value", "gradient"))
    assert kernel(1.0, 2.0)["value"] < 0
    assert len(rsym.gradient(shape)) == 2


@pytest.mark.parametrize("value", [sp.nan * y, sp.oo * y, y - sp.oo, y + sp.zoo, y + sp.I, sp.sqrt(-2) * y])
def test_what_has_no_real_value_is_no_shape(value):
    with pytest.raises(RsymError, match="not a real number"):
        Shape(value, (x, y))
    with pytest.raises(RsymError, match="not a real number"):
        Shape(rsym.conjunction(x, value), (x, y))


def test_a_branch_may_be_undefined():
    assert Shape(sp.Piecewise((x, x > y), (sp.nan, True)), (x, y)).dimension == 2
    kinked = rsym.gradient(Shape(sp.Max(x, y), (x, y)))
    assert Shape(kinked[0], (x, y)).dimension == 2


def test_a_value_just_outside_its_range_is_shown_in_full():
    with pytest.raises(RsymError, match=r"must lie in \[6.1, 10\], got 6.0999999;"):
        Letter(7, minimum=6.1, maximum=10).check(6.0999999, "the letter")
