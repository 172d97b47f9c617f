"""A part is a place: equal leaves in several parts are told apart by what bounds the body at a point."""

import math

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import Shape, x, y, z
from rsym.backends.kernel import compile_program
from rsym.logic.faces import shape_faces
from rsym.output.design.pages import page_of
from rsym.sampling.labels import Labeller

SQUARES = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0).named("B")
BOSS = rsym.box(2, 2, 1).named("plate") | rsym.cylinder(0.5, 1, (3, 0, 0)).named("boss")
OVERLAP = rsym.box(2, 2, 1).named("A") | rsym.box(2, 2, 1).translate(0.7, 0.6, 0).named("B")


def areas(mesh):
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return {name: float(sizes[mesh.part == k].sum()) for k, name in enumerate(mesh.parts) if (mesh.part == k).any()}


def parts(shape):
    return {name: float(value) for name, value in rsym.measure(shape).parts.items()}


def test_parts_with_leaves_in_common_have_faces_of_their_own():
    assert parts(SQUARES) == pytest.approx({"A": 4, "B": 4}, rel=1e-12)
    assert parts(BOSS) == pytest.approx({"plate": 16, "boss": 1.5 * math.pi}, rel=1e-11)
    assert rsym.integrate(1, SQUARES, over="B") == pytest.approx(4, rel=1e-12)
    assert rsym.quadrature(SQUARES, cells=8).boundary.of("B").weights.sum() == pytest.approx(4, rel=1e-12)
    assert areas(rsym.mesh(BOSS, 24)) == pytest.approx({"plate": 16, "boss": 1.5 * math.pi}, rel=0.01)


def test_where_faces_coincide_both_names_are_kept():
    both = 2 * 1.3 * 1.4
    own = 16 - both - 1.3 - 1.4  # two lids, and of the sides what the other box does not hide
    truth = {"A": own, "A / B": both, "B": own}
    assert parts(OVERLAP) == pytest.approx(truth, rel=1e-10)
    assert areas(rsym.mesh(OVERLAP, 40)) == pytest.approx(truth, rel=0.03)
    assert rsym.integrate(1, OVERLAP, over="A") == pytest.approx(own + both, rel=1e-10)
    assert rsym.integrate(1, OVERLAP, over="A / B") == pytest.approx(both, rel=1e-10)


@pytest.mark.parametrize("scale", [10, 25.4, 1 / 3])
def test_parts_whose_numbers_are_floats_keep_their_names_when_they_are_scaled(scale):
    """SymPy multiplies sums out, each float rounded for itself, of the part and not inside of the shape."""
    made = rsym.disc(1.5).named("rim")
    for radius, place in ((1 / 4, 1 / 2), (1 / 7, -1 / 3)):
        made = made - rsym.disc(radius, (place, 0)).named("hole")
    row = rsym.row(rsym.disc(0.1271), 0.7, count=3).translate(5.1 / 3, 1 / 7).named("row")
    found = rsym.measure((made | row).scale(scale).rotate(0.3).scale(1 / 7)).parts
    sizes = {"rim": 1.5, "hole": 1 / 4 + 1 / 7, "row": 3 * 0.1271}
    assert found == {name: pytest.approx(2 * math.pi * size * scale / 7) for name, size in sizes.items()}


@pytest.mark.parametrize("scale", [1, 3, 1.7])
def test_a_group_of_one_box_twice_goes_without_saying_when_it_is_scaled(scale):
    pair = (rsym.rectangle(2, 1).named("A") | rsym.rectangle(2, 1).named("B")).named("E")
    moved = pair.scale(scale).translate(1, 2).rotate(0.3)
    assert rsym.measure(moved).parts == {"A / B": pytest.approx(6 * scale)}


@pytest.mark.parametrize("turned", [False, True])
def test_the_name_does_not_depend_on_the_leaf_that_an_engine_found(turned):
    # Two formulas of the plane z = 0: which one is found first depends on the engine.
    lid = (Shape(-z, (x, y, z)) & rsym.cylinder(1, 4)).named("lid")
    sheet = (Shape(other_plane(z), (x, y, z)) & rsym.box(6, 6, 4)).named("sheet")
    body = (sheet | lid) if turned else (lid | sheet)
    points = np.array([[0.2, 0.1, 0.0], [2.0, 0.1, 0.0]])
    planes = [k for k, leaf in enumerate(shape_faces(body).form.leaves) if _vanishes(body, leaf, points)]
    assert len(planes) == 2
    for leaf in planes:
        assert Labeller(body)(points, np.full(2, leaf)).each.tolist() == ["lid / sheet", "sheet"]


def other_plane(u):
    return -u * (2 + u)  # zero at u = 0, no multiple of u


def _vanishes(body, leaf, points):
    kernel = compile_program(shape_faces(body).form.builder.program({"leaf": leaf}), ("leaf",), body)
    return (kernel(*points.T)["leaf"] == 0).all()


def test_a_plane_that_is_a_part_by_itself_gives_its_name_to_no_side_of_another_part():
    hole = rsym.cylinder(1).named("hole")
    pin = rsym.cylinder(1, 2, (0, 0, 2)).named("pin")
    body = (rsym.box(4, 4, 2).named("plate") - hole) | pin
    points = np.array([[1.0, 0, 0.5], [1.0, 0, 2]])
    faces = shape_faces(body)
    bores = [k for k, face in enumerate(faces.faces) if face.parts == ("hole",)]
    assert bores
    assert [face.parts for face in faces.faces if face.parts[0] == "pin"] == [("pin",)] * 2
    found = Labeller(body)(points, np.array([faces.faces[bores[0]].leaf] * 2))
    assert found.each.tolist() == ["hole", "pin"]


def test_nested_parts_and_parts_of_one_name_stay_as_they_were():
    lens = (rsym.disc(2).named("rim") & Shape(x, (x, y))).named("half")
    assert parts(lens) == pytest.approx({"rim": 2 * math.pi, "half": 4}, rel=1e-11)
    pair = rsym.rectangle(1, 1).named("box") | rsym.rectangle(1, 1).translate(2, 0).named("box")
    assert parts(pair) == pytest.approx({"box": 8}, rel=1e-12)
    assert not shape_faces(pair).shared


def test_names_follow_the_defaults_of_letters():
    a = sp.Symbol("a", real=True)
    right = rsym.rectangle(2, a, letters={a: 2}).translate(1, 0).named("right")
    lids = np.array([[-0.5, 1.0], [0.5, 1.0]])
    names = []
    for value in (2, 1, 2):  # of one expression, so what was compiled is kept
        pair = rsym.rectangle(2, 2).named("left") | right.with_letters({"a": value})
        names.append(Labeller(pair).nearest(lids).each.tolist())
    assert names == [["left", "left / right"], ["left", "left"], ["left", "left / right"]]


def test_what_has_no_name_is_called_by_its_formula_beside_a_part_that_has_the_leaf():
    body = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0)
    found = parts(body)
    assert found.pop("A") == pytest.approx(4, rel=1e-12)
    assert sum(found.values()) == pytest.approx(4, rel=1e-12)


def test_points_are_drawn_on_the_part_that_was_asked_for():
    on = rsym.sample(SQUARES, 400, over="B", rng=1)
    assert set(on.parts.tolist()) == {"B"}
    for axis, side in ((0, 1.5), (0, 2.5), (1, -0.5), (1, 0.5)):
        assert (np.abs(on.points[:, axis] - side) < 1e-12).sum() > 60
    space = rsym.sample(BOSS, 300, over="boss", rng=1, resolution=24)
    assert (np.hypot(space.points[:, 0] - 3, space.points[:, 1]) < 0.5 + 1e-9).all()
    assert (space.points[:, 2] > 0.5 - 1e-9).sum() > 20


def test_features_end_where_the_part_beside_them_does():
    found = rsym.mesh(BOSS, 24).features
    assert {frozenset(one.names) for one in found} == {frozenset(["plate"]), frozenset(["boss"])}
    assert len(found) == 14


def test_rays_see_the_part_that_bounds_the_body():
    image = rsym.render(BOSS, camera="top", size=(80, 60), colour_by="part")
    assert list(image.parts) == ["plate", "boss"]
    names = np.array([*image.parts, ""])[image.part]
    there = image.points[..., 0]
    assert set(names[there > 2].tolist()) == {"boss"}
    assert set(names[there < 2].tolist()) == {"plate"}
    both = rsym.render(OVERLAP, camera="top", size=(80, 60), colour_by="part")
    seen = np.array([*both.parts, ""])[both.part][np.isfinite(both.points[..., 0])]
    assert set(seen.tolist()) == {"A", "B", "A / B"}


def test_the_lint_says_which_parts_have_a_face_in_common():
    (found,) = rsym.lint(rsym.rectangle(2, 1).named("A") | rsym.rectangle(2, 1).translate(1, 0).named("B")).findings
    assert found.kind == "coincident faces"
    assert "the face is one of A and B" in found.message
    assert rsym.lint(SQUARES).clean


def test_the_floor_of_one_box_on_the_lid_of_the_next_is_a_face_of_neither():
    stack = rsym.rectangle(2, 1).named("below") | rsym.rectangle(2, 1).translate(0, 1).named("above")
    hole = rsym.rectangle(1, 1).translate(0, 1).named("hole")
    found = parts(stack - hole)
    assert found == pytest.approx({"below": 4, "above": 3, "hole": 3}, rel=1e-11)


def test_a_page_shows_each_part_by_a_leaf_of_its_own():
    page = page_of(SQUARES)
    assert '"leaves":["A","A","B","B"]' in page


def test_what_is_offset_keeps_its_names():
    plate = rsym.rectangle(8, 6).named("plate") - rsym.disc(0.5).named("hole") - rsym.disc(0.2, (-2, 0)).named("hole")
    grown = rsym.offset(plate.named("all").scale(2), -0.1)
    truth = {"plate": 56 - 8 * 0.1, "hole": 2 * math.pi * (1.4 + 0.2)}
    assert rsym.measure(grown).parts == {name: pytest.approx(size) for name, size in truth.items()}
