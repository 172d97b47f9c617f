import html
import itertools
import multiprocessing
import re
import threading

import matplotlib.pyplot
import numpy as np
import pytest
from oracles import dying
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.errors import warn
from rsym.language.listing import definitions
from rsym.paper import MODELS, reproduction
from rsym.paper.drawing import Drawing, Recipe, Reproduced, Table, mesh_quietly
from rsym.paper.figures import BODIES, RECIPES, ROWS
from rsym.paper.models import GALLERY
from rsym.paper.page import page


@pytest.mark.slow
def test_stages_contain_each_other_where_the_paper_says_so():
    points = np.random.default_rng(2).uniform((-8, -16, -4), (8, 18, 9), (4000, 3)).T
    inside = {
        stage: rsym.compile(rsym.paper.car(stage=stage))(*points)["value"] > 0
        for stage in ("test1", "test2", "test3", "test4", "test5", "W")
    }
    assert (inside["test1"] >= inside["test2"]).all()
    assert (inside["test4"] >= inside["test3"]).all()
    assert (inside["test4"] >= inside["test5"]).all()
    assert (inside["test5"] >= inside["W"]).all()
    assert inside["W"].sum() > 200
    assert not inside["W"][(np.abs(points) > np.array([[7.9], [15.9], [8.9]])).any(axis=0)].any()


def test_the_values_under_figure_5():
    first, second = rsym.paper.car("a", "test1").letters, rsym.paper.car("b", "test1").letters
    printed = "a1 b1 z1 y2 z2 a3 b3 c3 y3 y4 ra y5 y6 xk2 xa xs".split()
    assert sorted(first) == sorted(printed)
    assert [float(first[n].default) for n in printed] == [8, 4, 4, 15, 5, 2.5, 10, 60, 18, 1, 3, 6, 7, 4, 1, 6]
    assert [float(second[n].default) for n in printed] == [9, 4, 4, 14, 4, 2.5, 10, 70, 18, 1, 1, 6, 7, 4, 1, 6]


def test_the_body_of_figure_11_has_its_tips_where_the_theory_says():
    lines = rsym.level_lines(rsym.paper.skeleton_body(), resolution=400)
    points = np.concatenate(list(lines))
    assert_close(points[:, 0].max(), 5.538102125054145, atol=1e-3)
    assert_close(points[:, 0].min(), -4.992121, atol=0.1)


@pytest.mark.parametrize(
    "call",
    [
        lambda: rsym.paper.car("c"),
        lambda: rsym.paper.car(stage="test9"),
        lambda: rsym.paper.car(reading="literal"),
        lambda: rsym.paper.skeleton_body("free"),
        lambda: rsym.paper.model_path("boat"),
        lambda: rsym.paper.reproduce("unused", only=["fig99"]),
        lambda: rsym.paper.reproduce("unused", only=["fig1"]),
    ],
)
def test_unknown_names(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RsymError):
        call()
    assert not list(tmp_path.iterdir())


def test_every_figure_has_its_recipe():
    names = [recipe.name for recipe in RECIPES]
    cars = "fig05a fig05b fig06a fig06b fig07a fig07b fig08a fig08b fig09a fig09b".split()
    rest = "fig10 fig11 fig12 fig13 fig14 table1 preference parts sections rendered revolution claims"
    rest += " atlas verdicts fitted solved growth"
    surfaces = "paraboloid twists torus joints hull network fitting".split()
    assert names == ["fig01", "fig02", *cars, *rest.split(), *surfaces, "gallery"]
    assert len(BODIES) == 6


@pytest.mark.slow
def test_figure_12_has_the_printed_letters():
    drawing = next(recipe for recipe in RECIPES if recipe.name == "fig12").draw()
    assert drawing.letters.startswith("a = 5, a2 = 5, p2 = 0.1, (a1, p1) = (8, 40), (8, 20)")
    assert drawing.triangles > 100_000
    assert [text.get_text() for text in drawing.figure.texts][5] == "$a_1 = 12$, $p_1 = 80$"


@pytest.mark.slow
@pytest.mark.parametrize(("model", "pieces"), [("valve", 1), ("streamlined", 5)])
def test_our_own_models_are_closed_and_inside_their_bounds(model, pieces):
    shape = getattr(rsym.paper, model)()
    status = mesh_quietly(shape, 300).status
    assert status.closed
    assert status.components == pieces  # the wheels turn freely in their arches
    for letter in shape.letters.values():
        assert letter.doc
        assert letter.minimum < letter.default < letter.maximum


@pytest.mark.slow
def test_the_bounds_hold_the_valve_with_every_letter_at_either_end():
    shape = rsym.paper.valve()
    for end in ("minimum", "maximum"):
        extreme = {name: getattr(letter, end) for name, letter in shape.letters.items()}
        body = mesh_quietly(shape, 90, letters=extreme)
        assert body.status.closed
        assert np.hypot(*body.vertices.T[:2]).max() <= extreme["R"] + 1e-9, "the fillet stands out of the rim"


def ends_of_letters(shape):
    """The defaults, then every pair of ends of the letters that decide the fillet."""
    default = {name: letter.default for name, letter in shape.letters.items()}
    names = ("rs", "R", "m", "hs", "q", "g", "rf")
    ends = [(shape.letters[name].minimum, shape.letters[name].maximum) for name in names]
    return [default, *({**default, **dict(zip(names, values, strict=True))} for values in itertools.product(*ends))]


def test_the_fillet_touches_stem_and_back_whatever_the_letters():
    """The section of the valve has no corner where the arc begins and ends: exact places, and their directions."""
    shape = rsym.paper.valve()
    kernel = rsym.compile(shape, ("value", "gradient"))
    for exact in ends_of_letters(shape):
        value = {name: float(number) for name, number in exact.items()}
        k = np.sqrt(1 + value["g"] ** 2)
        centre = value["rs"] + value["rf"]
        base = value["m"] + value["hs"] + value["g"] * (value["R"] - value["q"] * value["hs"] - centre)
        angle = np.linspace(np.pi + 0.05, 1.5 * np.pi - np.arctan(value["g"]) - 0.05, 9)
        across, up = np.cos(angle), np.sin(angle)
        arc = centre + value["rf"] * across, 0.0, base + value["rf"] * (k + up)
        fields = kernel(*arc, letters=exact)
        assert_close(fields["value"], np.zeros(9), atol=1e-12)
        normals = fields["gradient"] / np.linalg.norm(fields["gradient"], axis=1, keepdims=True)
        assert_close(normals, np.stack([across, 0 * up, up], axis=1), atol=1e-9)


@pytest.mark.slow
def test_one_figure_is_drawn_with_its_page(tmp_path):
    seen = []
    results = rsym.paper.reproduce(tmp_path, only=["fig11"], progress=lambda *state: seen.append(state))
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["fig11.png", "index.html"]
    assert seen == [(0, 1, "fig11"), (1, 1, "done")]
    picture = matplotlib.pyplot.imread(results[0].path)
    assert picture.shape[0] > 800
    assert picture[..., :3].std() > 0.1
    text = (tmp_path / "index.html").read_text()
    assert "a = 5, a1 = 8, a2 = 5.3, p1 = 40, p2 = 0.1" in text
    assert 'src="fig11.png"' in text
    assert not re.search(r"<script|src=.https?:|href=.https?:", text)


@pytest.mark.slow
def test_the_same_picture_has_the_same_bytes(tmp_path):
    first = rsym.paper.reproduce(tmp_path / "a", only=["fig10"])[0]
    second = rsym.paper.reproduce(tmp_path / "b", only=["fig10"])[0]
    assert first.path.read_bytes() == second.path.read_bytes()
    assert first.triangles == second.triangles > 10_000


@pytest.mark.slow
def test_two_processes_draw_the_same_pictures_in_the_same_order(tmp_path):
    names, seen = ["fig02", "fig11", "fig14"], []
    one = rsym.paper.reproduce(tmp_path / "one", only=names)
    two = rsym.paper.reproduce(tmp_path / "two", only=names, processes=2, progress=lambda *state: seen.append(state))
    for first, second in zip(one, two, strict=True):
        assert first.path.read_bytes() == second.path.read_bytes()
        assert (first.name, first.triangles, first.table) == (second.name, second.triangles, second.table)
    assert seen[-1] == (3, 3, "done")
    assert sorted(name for _, _, name in seen[:-1]) == sorted(names)
    assert [done for done, _, _ in seen] == sorted(done for done, _, _ in seen)
    assert "index.html" in {path.name for path in (tmp_path / "two").iterdir()}
    assert not multiprocessing.active_children()


def test_every_row_of_figures_is_of_figures_and_none_is_in_two():
    rows = [name for row in ROWS for name in row]
    assert len(set(rows)) == len(rows)
    assert set(rows) <= {recipe.name for recipe in RECIPES}


@pytest.mark.parametrize("processes", [0, 1.5, True, "2"])
def test_a_number_of_processes_that_is_none(processes, tmp_path):
    with pytest.raises(RsymError, match="processes must be a positive integer"):
        rsym.paper.reproduce(tmp_path / "new", processes=processes)
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_an_interrupt_ends_the_processes_and_leaves_no_page(tmp_path):
    def interrupt(done, total, name):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rsym.paper.reproduce(tmp_path, only=["fig02", "torus", "fig13"], processes=2, progress=interrupt)
    assert not multiprocessing.active_children()
    assert not [path for path in tmp_path.iterdir() if path.suffix != ".png"]


def test_a_process_that_ends_is_said_with_its_figure(tmp_path, monkeypatch):
    monkeypatch.setattr(reproduction, "_draw_as_told", dying.die_drawing)
    with pytest.raises(RsymError, match=r"the process that drew fig(02|10) has ended") as caught:
        rsym.paper.reproduce(tmp_path, only=["fig02", "fig10"], processes=2)
    assert caught.value.code == "process"
    assert not multiprocessing.active_children()


def failing(error):
    def draw():
        raise error

    return Recipe("fig02", "A failure", "", draw)


def told(recipe, monkeypatch):
    """What a process answers that is asked for a figure."""
    monkeypatch.setattr(reproduction, "RECIPES", [recipe])
    monkeypatch.setattr(reproduction.signal, "signal", lambda *_: None)
    near, far = multiprocessing.Pipe()
    drawing = threading.Thread(target=reproduction._draw_as_told, args=(far,))
    drawing.start()
    near.send(recipe.name)
    answer = near.recv()
    near.close()
    drawing.join()
    return answer


def test_an_error_names_its_figure_here_and_in_another_process(tmp_path, monkeypatch):
    refused = failing(RsymError("no such letter", code="letter", where="line 3"))
    monkeypatch.setattr(reproduction, "RECIPES", [refused])
    with pytest.raises(RsymError) as caught:
        rsym.paper.reproduce(tmp_path)
    assert str(caught.value) == "fig02, line 3: no such letter"
    assert str(told(refused, monkeypatch)) == "fig02, line 3: no such letter"
    defect = told(failing(KeyError("leaf")), monkeypatch)
    assert isinstance(defect, KeyError)
    assert defect.__notes__[0] == "while drawing fig02"
    assert "in draw" in defect.__notes__[1]


def test_a_warning_of_another_process_is_given_here(monkeypatch):
    def draw():
        warn("the surface is cut")
        return Drawing(matplotlib.pyplot.figure(), "", 0, "")

    _, warnings = told(Recipe("fig02", "A warning", "", draw), monkeypatch)
    assert warnings == ["the surface is cut"]


def test_cancelling_leaves_no_page(tmp_path):
    with pytest.raises(RsymError) as caught:
        rsym.paper.reproduce(tmp_path, only=["fig10"], progress=lambda *state: False)
    assert caught.value.code == "cancelled"
    assert not list(tmp_path.iterdir())


def test_the_page_shows_published_seconds_and_escapes_text(tmp_path):
    table = Table(("a", "b"), (("1 < 2", "3"),))
    row = Reproduced("fig05a", "A <title>", tmp_path, "a < b", 1234567, 1.26, "23.32", "r", table, ("layers.svg",))
    text = page([row])
    assert "1 234 567" in text
    assert "23.32" in text
    assert "A &lt;title&gt;" in text
    assert "Fig. 5a" in text
    assert "<td>1 &lt; 2</td>" in text
    assert 'href="layers.svg"' in text


@pytest.mark.slow
def test_the_whole_page_has_every_definition_once_and_the_lost_figures_in_their_places(tmp_path):
    rows = [
        Reproduced(one.name, one.title, tmp_path, "", 0, 1.0, one.published, "", None, (), one.model, one.equations)
        for one in RECIPES
    ]
    text = page(rows, whole=True)
    order = re.findall('<section id="([^"]*)">', text)
    lost, readings = ["fig03", "fig04"], ["readings"]
    assert order == [
        *(r.name for r in RECIPES[:2]),
        *lost,
        *(r.name for r in RECIPES[2:18]),
        *readings,
        *order[18 - len(RECIPES) :],
    ]
    assert re.findall('<a href="#([^"]*)">', text) == order
    labels = [html.unescape(label) for label in re.findall('aria-label="([^"]*)"', text)]
    models = {
        name: {one.latex for one in definitions(rsym.paper.model_path(name))} for name in MODELS if name not in GALLERY
    }
    for model, shape in {one.model for one in RECIPES if one.model}:
        for definition in definitions(rsym.paper.model_path(model), shape=shape):
            wanted = sum(definition.latex in known for known in models.values())
            assert labels.count(definition.latex) == max(wanted, 1), definition.latex
    for reading in rsym.paper.READINGS:
        assert html.escape(reading.consequence) in text
    assert not re.search(r"<script|src=.https?:|href=.https?:", text)
