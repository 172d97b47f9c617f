"""The gallery: every piece of the language has its card, every model is closed, portraits show what is there."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from oracles import notebooks
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x, y
from rsym.cli import main
from rsym.language.pieces import PIECES
from rsym.output.cards import draw_portrait
from rsym.paper.drawing import mesh_quietly
from rsym.paper.models import GALLERY, model_path
from rsym.paper.verdicts import BODIES

NOTEBOOK = notebooks.read(Path(__file__).parents[2] / "notebooks" / "04_gallery.ipynb")
CODE = [cell for cell in NOTEBOOK["cells"] if cell["cell_type"] == "code"]
DISC = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-1, 1), (-1, 1)))
# Cells along the longest side, and the Euler characteristic that counts the holes: 2 - 2 for each.
CHARACTERISTICS = {
    ("bone", "omega"): (60, 2),
    ("bracket", "omega"): (60, 2 - 2 * 4),
    ("clip", "omega"): (120, 2),
    ("gear", "omega"): (100, 2 - 2 * 7),
    ("gyroid", "omega"): (60, -18),
    ("jack", "omega"): (60, 2),
    ("lattice", "omega"): (80, 2 * (27 - 54)),  # 27 joints and 54 struts between them
    ("snowflake", "omega"): (90, 2),
    ("solids", "capsule_body"): (60, 2),
    ("solids", "coil_body"): (60, 2),
    ("solids", "cone_body"): (60, 2),
    ("solids", "helicoid_body"): (90, 2),
    ("solids", "torus_body"): (60, 0),
    ("spanner", "omega"): (120, 0),
    ("spring", "omega"): (60, 2),
    ("vase", "omega"): (120, 2),
}


def drawn(shape, **options):
    """The pixels of a portrait, (240, 300, 3)."""
    figure = Figure((3.0, 2.4), dpi=100)
    draw_portrait(shape, figure, **options)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def test_every_piece_of_the_language_is_called_and_has_a_card():
    called = {
        node.func.attr
        for cell in CODE
        for node in ast.walk(ast.parse(cell["source"]))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute)
    }
    assert set(PIECES) - called == set()
    pages = [
        "".join(output["data"].get("text/html", "")) for cell in CODE for output in cell["outputs"] if "data" in output
    ]
    titles = re.findall(r"<div style=\"overflow-x: auto; margin: 2px\"><b>(.*?)</b></div>", "".join(pages))
    assert set(PIECES) - {title.split(",")[0] for title in titles} == set()
    assert len(titles) == len(set(titles)) == "".join(pages).count("data:image/webp;base64,")


def test_the_page_of_bodies_shows_every_model_and_the_test_below_all_of_its_bodies():
    assert {model for _, model, _, _ in BODIES} == set(GALLERY)
    assert {(model, shape) for _, model, shape, _ in BODIES} == set(CHARACTERISTICS)


@pytest.mark.random
@pytest.mark.parametrize("body", CHARACTERISTICS, ids="-".join)
def test_a_model_is_closed_in_one_piece_with_the_holes_it_should_have(body):
    model, name = body
    cells, characteristic = CHARACTERISTICS[body]
    shape = rsym.load(model_path(model), shape=name)
    status = mesh_quietly(shape, cells).status
    assert status.closed
    assert not status.clipped
    assert (status.components, status.euler_characteristic) == (1, characteristic)
    for letter in shape.letters.values():
        assert letter.doc
        assert letter.minimum < letter.default < letter.maximum


@pytest.mark.slow
def test_volumes_of_bodies_that_are_known():
    """Pappus for torus and coil, whose ends are cut across; the cone."""

    def volume(model, shape, cells):
        return mesh_quietly(rsym.load(model_path(model), shape=shape), cells).status.volume

    turn = 2 * np.pi * np.hypot(3, 5 / (2 * np.pi))
    assert_close(volume("solids", "torus_body", 200), 2 * np.pi**2 * 3, rtol=4e-3)
    assert_close(volume("solids", "cone_body", 200), np.pi * 9 * 5 / 3, rtol=4e-3)
    assert_close(volume("solids", "coil_body", 200), np.pi * 3 * turn, rtol=4e-3)


def test_the_flank_of_the_gear_is_the_involute_and_its_field_the_distance_from_it():
    """A string unwound from the base circle: its end runs on the involute, and the string is the normal there."""
    gear = rsym.load(model_path("gear"), shape="flank")
    pressure = np.radians(25)
    base = 24 * np.cos(pressure)
    start = np.pi / 48 + np.tan(pressure) - pressure
    unwound = np.linspace(0.3, 0.6, 7)
    contact = start - unwound
    for beyond in (-0.2, 0.0, 0.3):
        length = base * unwound + beyond
        place = base * np.array([np.cos(contact), np.sin(contact)])
        place = place + length * np.array([-np.sin(contact), np.cos(contact)])
        assert_close(rsym.compile(gear)(*place, 0.0)["value"], -beyond * np.ones(7), atol=1e-9)


@pytest.mark.slow
def test_a_shipped_name_serves_the_command_line(tmp_path, capsys):
    path = tmp_path / "bone.stl"
    assert main(["mesh", "bone", "-o", str(path), "--resolution", "40"]) == 0
    assert path.stat().st_size > 10_000
    assert main(["show", "gear"]) == 0
    assert "cyclic" in capsys.readouterr().out


def test_a_portrait_shows_the_boundary_as_a_black_line_of_the_right_radius():
    dark = drawn(DISC).sum(axis=2) < 60
    rows, columns = np.nonzero(dark)
    scale = 240 / 2.4  # pixels for a unit: the height of 2 and a tenth of that on both sides
    radius = np.hypot(rows - 119.5, columns - 149.5) / scale
    assert len(radius) > 500
    assert_close(radius, np.ones(len(radius)), atol=0.03)


def test_a_curve_without_inside_is_drawn_as_a_stroke():
    dark = drawn(rsym.segment((-1, 0), (1, 0))).sum(axis=2) < 30
    rows, columns = np.nonzero(dark)
    assert np.ptp(columns) > 0.7 * 300
    assert np.ptp(rows) < 8


@pytest.mark.slow
def test_a_body_fills_its_place_and_a_curve_in_space_is_a_thin_tube():
    seen = (drawn(rsym.sphere(2), resolution=30) < 250).any(axis=2)
    assert np.ptp(np.nonzero(seen)[0]) > 220
    tube = (drawn(rsym.circle(1, (0, 0, 0)), resolution=60) < 250).any(axis=2)
    assert 0.02 < tube.mean() < 0.2


def test_what_has_no_bounds_is_seen_as_far_as_asked():
    half = rsym.half_plane((1, 0), 3)
    near, far = (rsym.cards({"half": half}, reach=reach).cards[0].picture for reach in (2, 4))
    assert near != far
    with pytest.raises(RsymError):
        rsym.cards({"half": half})


@pytest.mark.slow
def test_cards_show_name_picture_formula_and_contract():
    shown = rsym.cards({"a < b": DISC, "long": rsym.regular_polygon(9)}, columns=2)
    page = shown._repr_html_()
    for part in ("<b>a &lt; b</b>", "data:image/webp;base64,", "normalised to order 1", "repeat(2,"):
        assert part in page
    first, second = (card._repr_html_() for card in shown.cards)
    assert r"$\omega\left(x, y\right) =" in first
    assert "<summary>formula</summary>" not in first
    assert "<summary>formula</summary>" in second
    assert "base64" not in repr(shown)
    named = rsym.cards({"segment": rsym.segment((-1, 0), (1, 0))})._repr_html_()
    assert r"\mathrm{segment}" in named
    assert re.search(r"<summary>written out</summary><small>\$\\omega.*\\rho", named)


def test_a_gallery_has_its_titles_in_rows_and_is_never_empty():
    figure = rsym.plot_gallery({name: DISC for name in "abc"}, columns=2)
    places = {text.get_text(): text.get_position() for text in figure.texts}
    assert places["a"][1] == places["b"][1] > places["c"][1]
    assert places["a"][0] == places["c"][0] < places["b"][0]
    with pytest.raises(RsymError):
        rsym.plot_gallery({})
    with pytest.raises(RsymError):
        rsym.cards({})
