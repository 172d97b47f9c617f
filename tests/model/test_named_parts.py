"""Parts by name: taken out as shapes, put in anew, still called so on meshes."""

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, disjunction, x, y, z


def disc(cx, r=1):
    return Shape((r**2 - (x - cx) ** 2 - y**2) / (2 * r), (x, y), bounds=((cx - r, cx + r), (-r, r)))


def wagon():
    """A body on two wheels, all named."""
    body = rsym.rectangle(6, 2).translate(0, 1).named("body")
    return body | disc(-2).named("wheels") | disc(2).named("wheels")


def test_a_part_is_a_shape_with_the_letters_that_it_needs():
    car = rsym.paper.car()
    bonnet = car.part("bonnet")
    assert isinstance(bonnet, Shape)
    assert bonnet.bounds == car.bounds
    assert {"a3", "b3", "c3"} <= set(bonnet.letters)
    assert len(bonnet.letters) < len(car.letters)
    assert dict(bonnet.parts) == {"bonnet": bonnet.expression}


def test_several_parts_of_one_name_are_a_group():
    wheels = wagon().part("wheels")
    assert wheels.expression == disjunction(disc(-2).expression, disc(2).expression)
    assert [name for name, _ in wheels.parts] == ["wheels", "wheels"]


def test_a_part_within_another_of_the_same_name_is_not_counted_twice():
    inner = disc(0).named("wheel")
    outer = (inner & Shape(x, (x, y))).named("wheel")
    assert outer.part("wheel").expression == outer.expression


def test_parts_inside_a_part_go_with_it():
    rim = disc(0, 2).named("rim")
    wheel = (rim - disc(0).named("hole")).named("wheel")
    whole = wheel | rsym.rectangle(1, 1).named("block")
    assert sorted(name for name, _ in whole.part("wheel").parts) == ["hole", "rim", "wheel"]


@pytest.mark.parametrize("ask", [lambda s: s.part("whels"), lambda s: s.with_part("whels", disc(0))])
def test_an_unknown_part_is_answered_with_the_nearest(ask):
    with pytest.raises(RsymError, match="did you mean 'wheels'") as caught:
        ask(wagon())
    assert caught.value.code == "unknown-part"


def test_a_shape_without_parts_says_how_they_come_to_be():
    with pytest.raises(RsymError, match="named"):
        disc(0).part("wheel")


@pytest.mark.parametrize("wrong", [None, 3, object(), "wheel", []])
def test_only_a_shape_takes_the_place_of_a_part(wrong):
    with pytest.raises(RsymError, match="Shape"):
        wagon().with_part("wheels", wrong)
    with pytest.raises(RsymError):
        wagon().part(wrong if wrong != "wheel" else None)


def test_a_replaced_part_keeps_its_name_and_a_group_becomes_one():
    square = rsym.rectangle(1, 1).named("square")
    changed = wagon().with_part("wheels", square)
    body = rsym.rectangle(6, 2).translate(0, 1)
    assert changed.expression == disjunction(body.expression, square.expression)
    assert [name for name, _ in changed.parts] == ["body", "wheels"]
    assert changed.part("wheels").expression == square.expression


def test_a_part_that_is_taken_away_is_replaced_too():
    plate = rsym.rectangle(6, 4) - disc(1).named("hole")
    hole = disc(-1, 0.5)
    changed = plate.with_part("hole", hole)
    assert changed.expression == conjunction(rsym.rectangle(6, 4).expression, -hole.expression)
    kernel = rsym.compile(changed)
    assert float(kernel(1, 0)["value"]) > 0 > float(kernel(-1, 0)["value"])


def test_a_part_that_is_a_coordinate_is_replaced_as_an_operand_only():
    left, right = Shape(x, (x, y)).named("left"), Shape(1 - x, (x, y)).named("right")
    strip = left & right
    changed = strip.with_part("left", Shape(y, (x, y)))
    assert changed.expression == conjunction(y, 1 - x)
    assert dict(changed.parts) == {"left": y, "right": 1 - x}


def test_the_first_operands_of_a_longer_operation_are_a_part_of_it():
    f, g, h = (Shape(e, (x, y)) for e in (x - 1, y * x, 1 - y))
    whole = (f & g).named("pair") & h
    assert whole.with_part("pair", Shape(x + y, (x, y))).expression == conjunction(x + y, 1 - y)


def test_a_part_within_a_part_changes_what_it_is_in():
    wheel = (disc(0, 2) - disc(0).named("hole")).named("wheel")
    changed = (wheel | rsym.rectangle(1, 1)).with_part("hole", disc(1, 0.5))
    assert changed.part("wheel").expression == conjunction(disc(0, 2).expression, -disc(1, 0.5).expression)


def test_a_part_is_replaced_in_the_bump_of_a_blend_too():
    """Found beside, as an operand of logic, the bump must not keep the old one."""
    f, g, other = rsym.rectangle(2, 2), disc(1), disc(0, 0.5)
    blended = rsym.displacement_blend(f, g.named("boss"), 0.1) | g.named("boss")
    wanted = rsym.displacement_blend(f, other, 0.1) | other
    assert blended.with_part("boss", other).expression == wanted.expression


def test_a_multiple_of_a_part_is_that_of_the_new_one():
    part = Shape(x * y, (x, y)).named("saddle")
    whole = Shape(conjunction(3 * x * y, y), (x, y), parts=part.parts)
    assert whole.with_part("saddle", Shape(x + y, (x, y))).expression == conjunction(3 * x + 3 * y, y)


def test_a_part_of_a_sum_is_replaced_in_the_sum():
    """As the segment of a skeleton body is."""
    body = rsym.paper.skeleton_body()
    changed = body.with_part("f_o", Shape(x**2 + y**2, (x, y)))
    at = {"x": 0.7, "y": -0.3}
    values = {name: float(letter.default) for name, letter in body.letters.items()}
    wanted = -(0.7**2 + 0.3**2) + (values["a1"] - 0.7) * (values["a2"] + 0.7) / values["p1"] - values["p2"]
    assert_close(rsym.compile(changed)(*at.values())["value"], wanted, atol=1e-14)
    assert "a" not in changed.letters  # the segment's own letter has gone with it


def test_a_part_that_has_dissolved_in_the_formula_is_refused():
    named = Shape(x + y, (x, y)).named("slope")
    dissolved = Shape(x + 2 * y, (x, y), parts=named.parts)
    with pytest.raises(RsymError, match="slope") as caught:
        dissolved.with_part("slope", disc(0))
    assert caught.value.code == "part"
    assert "named" in str(caught.value)


def test_what_was_made_of_derivatives_keeps_those_of_the_old_part_and_is_refused():
    with pytest.raises(RsymError, match="before normalise"):
        rsym.normalise(wagon()).with_part("wheels", disc(0))


@pytest.mark.slow
def test_every_part_of_every_model_can_be_taken_and_replaced_by_itself():
    for name in rsym.paper.MODELS:
        shape = rsym.load(name)
        for part in dict.fromkeys(part for part, _ in shape.parts):
            taken = shape.part(part)
            assert taken.coordinates == shape.coordinates
            if sum(one == part for one, _ in shape.parts) == 1:
                same = shape.with_part(part, taken)
                assert same.expression == shape.expression
                assert sorted(same.parts, key=str) == sorted(shape.parts, key=str)


def test_letters_and_bounds_of_the_new_part_join_those_of_the_shape():
    import sympy as sp

    r = sp.Symbol("r", real=True)
    big = Shape(r - x**2 - y**2, (x, y), letters={r: 9}, bounds=((-3, 3), (-3, 3)))
    changed = wagon().with_part("wheels", big)
    assert list(changed.letters) == ["r"]
    assert changed.bounds is None
    assert changed.box.ends == ((-3.6, 3.6), (-3, 3))
    with pytest.raises(RsymError, match="cannot be combined"):
        wagon().with_part("wheels", rsym.sphere(1))


def test_meshes_and_pictures_call_the_new_part_by_the_old_name():
    ball = rsym.sphere(1).named("ball")
    post = rsym.Shape(1 - (x - 1) ** 2 - y**2, (x, y, z), bounds=((0, 2), (-1, 1), (-1, 1))).named("post")
    changed = (ball | post).with_part("post", rsym.box(4, 1, 1).named("bar"))
    mesh = rsym.mesh(changed, 16)
    assert {mesh.leaves[number] for number in np.unique(mesh.leaf)} == {"ball", "post"}


def test_of_parts_of_one_formula_neither_is_changed_for_the_other():
    left, right = disc(0).named("left") & Shape(-x, (x, y)), disc(0).named("right") & Shape(x, (x, y))
    with pytest.raises(RsymError, match="same formula as right"):
        (left | right).with_part("left", disc(1))
