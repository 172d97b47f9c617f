"""The notebooks as they are committed: run, small, and free of what belongs to one machine. CI runs them anew."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from oracles import notebooks

FOLDER = Path(__file__).parents[2] / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
LARGEST = 1_500_000  # bytes; reviewers and browsers load it whole


def test_the_notebooks_are_there():
    names = [path.name for path in NOTEBOOKS]
    assert names == [
        "01_level_lines.ipynb",
        "02_car.ipynb",
        "03_r_systems.ipynb",
        "04_gallery.ipynb",
        "04_meshes.ipynb",
        "05_is_it_smooth.ipynb",
        "06_surfaces.ipynb",
        "07_fields.ipynb",
        "07_see_it.ipynb",
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_was_run_and_shows_its_picture_first(path):
    notebook = notebooks.read(path)
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    assert any("image/png" in output.get("data", {}) for output in code[0]["outputs"])
    assert [cell["cell_type"] for cell in notebook["cells"][:2]] == ["markdown", "code"]
    assert "RSYM_FAST" in code[0]["source"]
    for cell in code:
        assert not [output for output in cell["outputs"] if output["output_type"] == "error"]
        assert not [output for output in cell["outputs"] if output.get("name") == "stderr"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_small_and_belongs_to_no_machine(path):
    text = path.read_text()
    assert len(text) < LARGEST
    words = re.sub(r"[A-Za-z0-9+/=]{200,}", "", text)  # pictures are letters at random, paths among them
    assert len(words) < len(text) / 2
    assert not re.search(r"/(home|root|tmp|usr|work)/|[A-Z]:\\\\", words)
    metadata = notebooks.read(path)["metadata"]
    assert set(metadata) == {"kernelspec", "language_info"}
    assert "widgets" not in metadata


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_text_is_text_and_begins_with_one_title(path):
    text = [cell["source"] for cell in notebooks.read(path)["cells"] if cell["cell_type"] == "markdown"]
    assert re.match(r"# [A-Z]", text[0])
    lines = "\n".join(text).splitlines()
    assert sum(line.startswith("# ") for line in lines) == 1, "headings of sections have two signs"
    assert sum(line.startswith("## ") for line in lines) > 3


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_says(path):
    """In a process of its own: the words, and numbers to one in their last place."""
    pytest.importorskip("IPython")
    environment = {name: value for name, value in os.environ.items() if name != "RSYM_FAST"}
    environment["PYTHONPATH"] = os.pathsep.join(map(str, (FOLDER.parent, FOLDER.parent / "tests")))
    command = [sys.executable, "-m", "oracles.notebooks", str(path)]
    done = subprocess.run(command, cwd=FOLDER, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    every = zip(notebooks.stored(notebooks.read(path)), json.loads(done.stdout.splitlines()[-1]), strict=True)
    found = {k + 1: differ for k, (said, made) in enumerate(every) if (differ := notebooks.differences(said, made))}
    assert not found, f"outputs of cells are not those of running them: {found}"


def test_printed_numbers_agree_to_one_in_their_last_place():
    assert not notebooks.differences("1.25 of 3e-16, -0.00", "1.26 of  4.1e-15, 0.00")
    assert notebooks.differences("1.25", "1.27") == [("1.25", "1.27")]
    assert notebooks.differences("2.5e-05", "2.7e-05") == [("2.5e-05", "2.7e-05")]
    assert notebooks.differences("one 1", "two 1")


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_valid(path):
    nbformat = pytest.importorskip("nbformat")
    nbformat.validate(nbformat.read(path, as_version=4))
