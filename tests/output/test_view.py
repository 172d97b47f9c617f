"""The page in the browser, from Python and from the command line."""

import tempfile
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

import numpy as np
import pytest

import rsym
from rsym import RsymError
from rsym.cli import main
from rsym.sampling.mesh import Mesh

BALL = rsym.sphere(1).named("ball")


@pytest.fixture
def opened(monkeypatch, tmp_path):
    """What the browser is asked to open; temporary files in a folder of the test."""
    found = []
    monkeypatch.setattr("webbrowser.open", lambda url: found.append(url) or True)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return found


def test_a_shape_or_its_mesh_is_opened(opened, tmp_path):
    page = rsym.view(BALL, resolution=16)
    (url,) = opened
    assert Path(url2pathname(urlparse(url).path)) == page
    assert page.parent == tmp_path
    assert page.read_bytes() == rsym.write(rsym.mesh(BALL, 16), tmp_path / "same.html").read_bytes()
    rsym.view(rsym.mesh(BALL, 16))
    assert len(set(opened)) == 2


def test_a_path_with_blanks_parts_in_colour_and_no_browser(opened, tmp_path):
    path = tmp_path / "a ball.html"
    assert rsym.view(BALL, resolution=16, colour_by="part", path=path, browser=False) == path
    assert opened == []
    assert b'"paints"' in path.read_bytes()
    rsym.view(BALL, resolution=16, path=path)
    assert opened[0].endswith("/a%20ball.html")


def test_without_a_browser_the_place_is_told(monkeypatch, tmp_path):
    monkeypatch.setattr("webbrowser.open", lambda url: False)
    with pytest.warns(rsym.RsymWarning, match=r"no browser.*ball\.html"):
        rsym.view(BALL, resolution=16, path=tmp_path / "ball.html")


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ("car", "expected a Mesh or a Shape, got str.*load"),
        (rsym.disc(1), "in space.*plot_field"),
        (Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)), "at least one triangle"),
        (rsym.surfaces.sphere_octant(), r"patch\.mesh"),
    ],
    ids=["name", "plane", "empty", "patch"],
)
def test_what_cannot_be_seen_is_refused(opened, tmp_path, what, said):
    with pytest.raises(RsymError, match=said):
        rsym.view(what)
    assert opened == []
    assert not list(tmp_path.iterdir())


def test_a_page_that_cannot_be_written_leaves_nothing(opened, tmp_path):
    bare = Mesh(np.eye(3), np.array([[0, 1, 2]]))
    with pytest.raises(RsymError, match="parts"):
        rsym.view(bare, colour_by="part")
    with pytest.raises(RsymError, match=r"\.html"):
        rsym.view(bare, path=tmp_path / "ball.stl")
    assert not list(tmp_path.iterdir())
    assert opened == []


def test_the_command(opened, tmp_path, capsys):
    model = tmp_path / "ball.rf"
    model.write_text("coordinates x y z; letter r = 1; omega = r^2 - x^2 - y^2 - z^2")
    common = ["view", str(model), "--resolution", "16", "--set", "r=2"]
    assert main(common) == 0
    page, told, *_ = capsys.readouterr().out.splitlines()
    assert "closed" in told
    assert opened == [Path(page).as_uri()]
    path = tmp_path / "kept.html"
    assert main([*common, "--no-open", "-o", str(path), "--colour-by", "part"]) == 0
    assert capsys.readouterr().out.splitlines()[0] == str(path)
    assert path.exists()
    assert len(opened) == 1
    assert main([*common, "-o", "ball.stl"]) == 1
    assert ".html" in capsys.readouterr().err
