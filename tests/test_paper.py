import re

import matplotlib.pyplot
import numpy as np
import pytest
from closeness import assert_close

import rsym
from rsym import RsymError
from rsym.paper.figures import BODIES, RECIPES
from rsym.paper.reproduction import Reproduced, page


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


def test_the_literal_reading_is_another_function():
    standard, literal = rsym.paper.skeleton_body(), rsym.paper.skeleton_body("literal")
    gradient = rsym.compile(literal, ("gradient_squared",))(-4.992121, 0.0)["gradient_squared"]
    assert_close(np.sqrt(gradient), 0.317, atol=5e-4)
    assert rsym.compile(standard)(0, 1)["value"] != rsym.compile(literal)(0, 1)["value"]


@pytest.mark.parametrize(
    "call",
    [
        lambda: rsym.paper.car("c"),
        lambda: rsym.paper.car(stage="test9"),
        lambda: rsym.paper.skeleton_body("free"),
        lambda: rsym.paper.model_path("boat"),
        lambda: rsym.paper.reproduce("unused", only=["fig99"]),
    ],
)
def test_unknown_names(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RsymError):
        call()
    assert not list(tmp_path.iterdir())


def test_every_figure_has_its_recipe():
    names = [recipe.name for recipe in RECIPES]
    assert names == "fig05a fig05b fig06a fig06b fig07a fig07b fig08a fig08b fig09a fig09b fig10 fig11 fig12".split()
    assert len(BODIES) == 6


def test_figure_12_has_the_printed_letters():
    drawing = RECIPES[-1].draw()
    assert drawing.letters.startswith("a = 5, a2 = 5, p2 = 0.1, (a1, p1) = (8, 40), (8, 20)")
    assert drawing.triangles > 100_000
    assert [text.get_text() for text in drawing.figure.texts][5] == "$a_1 = 12$, $p_1 = 80$"


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
    assert not re.search(r"https?://", text)


def test_the_same_picture_has_the_same_bytes(tmp_path):
    first = rsym.paper.reproduce(tmp_path / "a", only=["fig10"])[0]
    second = rsym.paper.reproduce(tmp_path / "b", only=["fig10"])[0]
    assert first.path.read_bytes() == second.path.read_bytes()
    assert first.triangles == second.triangles > 10_000


def test_cancelling_leaves_no_page(tmp_path):
    with pytest.raises(RsymError) as caught:
        rsym.paper.reproduce(tmp_path, only=["fig10"], progress=lambda *state: False)
    assert caught.value.code == "cancelled"
    assert not list(tmp_path.iterdir())


def test_the_page_shows_published_seconds_and_escapes_text(tmp_path):
    row = Reproduced("fig05a", "A <title>", tmp_path, "a < b", 1234567, 1.26, "23.32", "r")
    text = page([row])
    assert "1 234 567" in text
    assert "23.32" in text
    assert "A &lt;title&gt;" in text
    assert "Fig. 5a" in text
