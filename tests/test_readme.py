"""What the README says is what happens."""

import re
from pathlib import Path

import matplotlib.pyplot
import numpy as np
import pytest
import trimesh

import rsym
from rsym.cli import main

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text()
BLOCKS = re.findall(r"```(\w*)\n(.*?)```", TEXT, re.DOTALL)
PYTHON = [code for language, code in BLOCKS if language == "python"]
PLAIN = [code for language, code in BLOCKS if not language]


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    yield
    matplotlib.pyplot.close("all")


def test_the_first_lines():
    assert len(PYTHON[0].splitlines()) <= 12
    space = {}
    exec(PYTHON[0], space)
    assert Path("fields.png").stat().st_size > 50_000
    assert space["mesh"].status.closed
    assert trimesh.load_mesh("nose.stl").is_watertight


def test_the_lines_about_a_shape():
    space = {}
    exec(PYTHON[0].splitlines()[0] + "\n" + PYTHON[0].splitlines()[1] + "\n" + PYTHON[1], space)
    assert str(space["half"].expression) == re.search(r"half.expression +# (.*)", PYTHON[1]).group(1)
    fields = space["fields"]
    assert fields["value"].shape == (2,)
    assert fields["gradient"].shape == (2, 2)
    assert not fields["singular"].any()
    assert np.abs(np.hypot(*space["circle"].T) - 2).max() < 1e-12


def test_the_model_file_and_the_commands():
    (model,) = [code for code in PLAIN if code.startswith("letter")]
    Path("ball.rf").write_text(model)
    (commands,) = [code for code in PLAIN if code.startswith("rsym mesh")]
    for command in commands.strip().splitlines():
        assert main([*command.split()[1:], "--resolution", "48"]) == 0
    for name in ("ball.stl", "car.stl"):
        assert trimesh.load_mesh(name).is_watertight
    assert Path("sheet.png").stat().st_size > 20_000
    assert rsym.load("ball.rf").letters["r"].doc == "radius of the ball"


def test_the_two_commands_are_there():
    assert PLAIN[1].strip() == "pip install . && rsym reproduce --out figures"
    assert PLAIN[2].strip() == 'pip install ".[test]" && pytest'


def test_folders_and_picture_exist():
    for path in re.findall(r"^- `([\w./]+)`:", TEXT, re.MULTILINE):
        assert (ROOT / path).exists(), path
    for path in re.findall(r"!\[.*?\]\((.*?)\)", TEXT):
        assert (ROOT / path).exists(), path


def test_the_number_of_letters_under_the_picture():
    # x_s closes Figs 5 and 6 only, so the whole car has one letter less than the paper's list.
    used = set(rsym.paper.car().letters) | set(rsym.paper.car(stage="test1").letters)
    assert len(used) == int(re.search(r"with (\d+) letters", TEXT).group(1))
