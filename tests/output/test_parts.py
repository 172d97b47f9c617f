"""Colours of parts: each name one colour, the same at every letter, different where parts meet."""

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import pytest
from matplotlib import pyplot as plt
from oracles.closeness import assert_close
from sampling.test_features import cube

import rsym
from rsym import RsymError
from rsym.output.paints import Spots, coat_of
from rsym.output.parts import PALETTE, colours_of, face_colours, part_colours
from rsym.output.shading import INSIDE, linear
from rsym.sampling.mesh import Mesh


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


SIDES = ("left", "right", "front", "back", "lid", "lid")


def test_each_part_on_the_surface_has_its_own_colour_in_the_order_of_the_leaves():
    vertices, faces, leaf = cube(2)
    mesh = Mesh(vertices, faces, leaf=leaf, leaves=SIDES)
    colours = part_colours(mesh)
    assert list(colours) == ["left", "right", "front", "back", "lid"]
    assert len(set(colours.values())) == 5
    assert len(set(PALETTE)) == len(PALETTE)
    for number, name in enumerate(SIDES):
        assert_close(face_colours(mesh)[leaf == number], np.tile(linear(colours[name]), (8, 1)), atol=1e-15)
    less = Mesh(vertices, faces[leaf > 1], leaf=leaf[leaf > 1], leaves=SIDES)
    assert part_colours(less) == {name: colours[name] for name in ("front", "back", "lid")}


def test_as_many_parts_as_a_car_has_names_have_as_many_colours():
    """No two closer in Oklab than the closest that are in print, 0.06."""
    colours = list(colours_of([f"part {k}" for k in range(28)], range(28), []).values())
    mixed = np.array([linear(colour) for colour in colours]) @ np.transpose(
        [[0.4122, 0.5363, 0.0514], [0.2119, 0.6807, 0.1074], [0.0883, 0.2817, 0.6300]]
    )
    seen = np.cbrt(mixed) @ np.transpose(
        [[0.2105, 0.7936, -0.0041], [1.9780, -2.4286, 0.4506], [0.0259, 0.7828, -0.8087]]
    )
    apart = np.linalg.norm(seen[:, None] - seen, axis=2)
    assert apart[np.triu_indices(28, 1)].min() > 0.06


def test_more_parts_than_colours_share_them_but_not_where_they_meet():
    """A square of fields as many across as there are colours: taken in turn they would repeat in each column."""
    side, count = len(PALETTE), len(PALETTE) ** 2
    i, j = np.divmod(np.arange(count), side)
    corner = (side + 1) * i + j
    faces = (corner[:, None, None] + [[0, side + 1, side + 2], [0, side + 2, 1]]).reshape(-1, 3)
    grid = np.indices((side + 1, side + 1, 1)).reshape(3, -1).T.astype(float)
    leaf = np.repeat(np.arange(count), 2)
    mesh = Mesh(grid, faces, leaf=leaf, leaves=tuple(f"field {k}" for k in range(count)))
    colour = np.array(list(part_colours(mesh).values())).reshape(side, side)
    assert (colour[1:] != colour[:-1]).all()
    assert (colour[:, 1:] != colour[:, :-1]).all()
    assert set(colour.ravel()) == set(PALETTE)


def test_a_part_is_painted_outside_in_its_colour_and_inside_like_any_surface():
    vertices, faces, leaf = cube(1)
    mesh = Mesh(vertices, faces, leaf=leaf, leaves=SIDES)
    coat = coat_of(mesh, mesh.normals, "red", "part", None, None)
    spots = Spots(np.array([0, 4, 4]), np.full((3, 3), 1 / 3), None, np.array([1, 1, -1]), np.eye(3))
    colours = [linear(coat.parts[SIDES[leaf[k]]]) for k in (0, 4)]
    assert_close(coat.paint(spots), [*colours, linear(INSIDE)], atol=1e-15)


@pytest.mark.slow
def test_a_new_figure_lists_the_parts_and_given_axes_stay_as_they_are():
    vertices, faces, leaf = cube(1)
    mesh = Mesh(vertices, faces, leaf=leaf, leaves=SIDES)
    artist = rsym.plot_mesh(mesh, colour_by="part")
    (legend,) = artist.get_figure().legends
    assert [text.get_text() for text in legend.get_texts()] == list(artist.parts)
    figure = artist.get_figure()
    figure.canvas.draw()
    box = legend.get_window_extent()
    assert box.x0 > artist.get_window_extent().x1
    assert box.x1 < figure.bbox.x1
    rsym.plot_mesh(mesh, ax=artist.axes, colour_by="part")
    assert figure.legends == [legend]


def test_a_mesh_that_does_not_know_its_parts_is_refused():
    vertices, faces, _ = cube(1)
    with pytest.raises(RsymError) as caught:
        rsym.plot_mesh(Mesh(vertices, faces), colour_by="part")
    assert caught.value.code == "parts"
