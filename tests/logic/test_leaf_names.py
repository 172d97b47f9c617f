"""Parts of a shape outlive its operations and name the leaves of its sign form."""

import pickle

import pytest
import sympy as sp

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.logic import leaf_names as naming
from rsym.logic.leaf_names import leaf_names, leaf_parts
from rsym.logic.sign_form import surface_form

SPACE = (x, y, z)
ball = Shape(4 - x**2 - y**2 - z**2, SPACE).named("ball")
slab = Shape(1 - z**2, SPACE).named("slab")


def names(shape):
    return leaf_names(surface_form(shape), shape)


def test_parts_outlive_operations():
    body = (ball & slab) | ~slab
    assert body.parts == (*ball.parts, *slab.parts)
    assert rsym.conjunction(ball, x, slab, system=rsym.Rp(4)).parts == body.parts
    assert body.replace(bounds=((-3, 3),) * 3).parts == body.parts
    assert rsym.normalise(body).parts == body.parts
    assert pickle.loads(pickle.dumps(body)).parts == body.parts
    r = sp.Symbol("r")
    disc = Shape(r - x**2 - y**2, (x, y), letters={r: 1}).named("disc")
    real = sp.Symbol("r", real=True)
    assert disc.with_letters({"r": 2}).parts == (("disc", real - x**2 - y**2),)
    assert rsym.revolve(disc, axis=y).parts == (("disc", real - x**2 - y**2 - z**2),)


@pytest.mark.parametrize(
    "moved",
    [
        lambda one: one.scale(2),
        lambda one: one.scale(sp.Rational(3, 10)).rotate(1),
        lambda one: one.rotate(sp.pi / 4).scale(3, centre=(1, 2)),
        lambda one: one.translate(1, 0.5).rotate(2).scale(sp.Rational(7, 10)),
        lambda one: one.scale((2, 3)),
    ],
    ids=["enlarged", "turned", "eighth", "all", "stretched"],
)
def test_holes_keep_their_names_when_they_are_moved(moved):
    cut = rsym.disc(1).named("hole"), rsym.half_plane((1, 1), 2).named("chamfer"), rsym.ellipse(2, 1).named("oval")
    plate = rsym.rectangle(6, 5).named("plate") - cut[0] - cut[1] - cut[2].translate(-1, 1)
    assert {*names(moved(plate))} == {*names(plate)} == {"plate", "hole", "chamfer", "oval"}


def test_a_new_name_replaces_the_old_one_and_an_empty_one_is_refused():
    assert ball.named("sphere").parts == (("sphere", ball.expression),)
    with pytest.raises(RsymError, match="needs a name"):
        ball.named(" ")


def test_the_smallest_part_names_a_leaf_and_of_equal_ones_the_first():
    assert names((ball & slab).named("lens")) == ("ball", "slab")
    body = (ball & Shape(x - y, SPACE)).named("half")
    assert names(body | slab) == ("ball", "half", "slab")
    twice = names((body.named("other") | slab.named("plate")) - body)
    assert twice == ("ball", "other / half", "plate", "ball", "other / half")  # one body by two names
    late = (Shape(x, SPACE) & Shape(y, SPACE)).named("both") | Shape(x, SPACE).named("one")  # named after the larger
    assert names(late) == ("one / both", "both")  # in both parts, neither of which is around the other
    assert leaf_parts(surface_form(late), late) == (("one", "both"), ("both",))
    twins = Shape(x, SPACE).named("one") | Shape(2 * x, SPACE).named("two")
    assert names(twins) == ("one",)


@pytest.mark.parametrize("cut", [lambda a, b: a - b, lambda a, b: ~(~a | b), lambda a, b: ~(b - ~a) & ~b])
def test_a_part_keeps_its_name_as_a_hole(cut):
    assert set(names(cut(slab, ball))) == {"slab", "ball"}


def test_normalised_and_revolved_parts_keep_their_names():
    disc = Shape(1 - x**2 - y**2, (x, y)).named("disc")
    tube = Shape(y - 2, (x, y)).named("tube")
    assert names(rsym.normalise(rsym.revolve(disc - tube))) == ("disc", "tube")


def test_a_leaf_of_no_part_is_called_by_its_formula_or_its_number():
    long = sum(sp.sin(k * x) for k in range(1, 30)) + y
    doubled = x
    for _ in range(60):  # written out, more characters than there is memory
        doubled = rsym.joining(doubled, rsym.trimming(doubled, y))
    body = rsym.conjunction(ball, -x - y, long, rsym.disjunction(sp.Min(x, y**3), doubled))
    assert names(body) == ("ball", "-x - y", "leaf 2", "x", "y**3", "leaf 5")
    assert names(Shape(x - z, SPACE)) == ("x - z",)


def test_letters_that_cancelled_take_their_part_out():
    text = 'letter a = 1; f = a*x "gone"; g = f/a + y "left"; omega = rfAND(g, z)'
    assert names(rsym.loads(text)) == ("left", "z")


def test_texts_of_a_model_name_its_parts_and_without_any_the_names_of_its_formulas_do():
    text = "u = z - 1; disc = rfAND(4 - x^2 - y^2, u*u - 9) {}; omega = rfAND(disc, y) {}"
    assert names(rsym.loads(text.format("", ""))) == ("disc", "disc", "omega")
    assert names(rsym.loads(text.format('"a disc"', ""))) == ("a disc", "a disc", "y")
    assert names(rsym.loads(text.format("", '"half"'))) == ("half", "half", "half")


def test_every_leaf_of_the_car_belongs_to_a_told_part():
    shape = rsym.paper.car()
    told = {name for name, _ in shape.parts}
    assert {"bonnet", "wheel arches", "roof", "wheels", "side windows", "headlights"} < told
    assert set(names(shape)) == told


def test_sides_of_the_bounds_are_caps():
    assert leaf_names(surface_form(ball).capped(), ball) == (
        "ball",
        *(f"cap {axis} {side}" for axis in "xyz" for side in ("lower", "upper")),
    )


FLOATS = [0.5, -0.1, 100.0, 1e-8, -2.5e300, 1 / 3, 123456.0, 1234567890123456.7, 1e15, 1e16, 0.0001, 9.999999999999999]


def test_a_text_is_never_shorter_than_it_must_be():
    a, third = sp.Symbol("alpha", real=True), sp.Rational(1, 3)
    formulas = [
        x - y,
        -(x**2) - 2 * y + third,
        sp.Rational(-17, 4) * (x + 1) / (y - a),
        (x - sp.Rational(617, 500)) ** 2 / 3 - sp.sqrt(x * y + 2) ** -3,
        a**-third * (x * y - 1) ** -2 + sp.sin(12345 * x),
        2**x * sp.Abs(y - 10) - 1 / x,
        sp.Mul(-1, x + y, evaluate=False),
        sp.Rational(1, 100) - rsym.conjunction(x, y),
        *[sp.Float(number) * x - y + sp.Float(number) for number in FLOATS],
        *[sp.Float(number, 30) - x for number in FLOATS],
    ]
    for formula in formulas:
        assert 0 < naming._least_length(formula) <= len(sp.sstr(formula))


def test_what_is_too_long_is_not_written(monkeypatch):
    long = sp.Rational(1, 4) - sum((u - sp.Rational(617, 500)) ** 2 for u in (x, y, z))
    monkeypatch.setattr(naming.sp, "sstr", lambda formula: pytest.fail("written"))
    for some in (long, 0.372 - sum((u - 0.94037) ** 2 for u in (x, y, z))):
        shape = rsym.Shape(rsym.disjunction(some, some.subs(x, x + 5)), (x, y, z))
        assert names(shape) == ("leaf 0", "leaf 1")
