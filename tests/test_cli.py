import subprocess
import sys

import pytest
import trimesh

from rsym.cli import main

MODEL = """
letter r = 1 in [0.5, 3] "radius"
bounds x [-2, 2] y [-2, 2] z [-2, 2]
ball = (r^2 - x^2 - y^2 - z^2)/(2*r)
omega = rfAND(ball, z)
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "ball.rf"
    path.write_text(MODEL)
    return str(path)


def test_fields_of_a_shipped_model(tmp_path, capsys):
    path = tmp_path / "sheet.png"
    assert main(["fields", "skeleton", "-o", str(path), "--resolution", "60", "--set", "a2=6"]) == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert "sheet.png" in capsys.readouterr().out


def test_a_section_and_another_format(tmp_path, model):
    path = tmp_path / "sheet.svg"
    assert main(["fields", model, "-o", str(path), "--resolution", "40", "--section", "z=0.5"]) == 0
    assert b"<svg" in path.read_bytes()


def test_mesh_with_letters_and_shape(tmp_path, model, capsys):
    path = tmp_path / "body.stl"
    arguments = ["mesh", model, "-o", str(path), "--resolution", "40", "--set", "r=1.5", "--shape", "ball"]
    assert main(arguments) == 0
    assert "closed" in capsys.readouterr().out
    body = trimesh.load_mesh(path)
    assert body.is_watertight
    assert abs(body.volume - 4 / 3 * 3.141592653589793 * 1.5**3) < 0.1


def test_mesh_of_a_plane_model_turned(tmp_path):
    path = tmp_path / "nose.stl"
    assert main(["mesh", "skeleton", "-o", str(path), "--resolution", "60", "--revolve", "x"]) == 0
    assert trimesh.load_mesh(path).is_watertight


@pytest.mark.parametrize(
    "arguments",
    [
        ["mesh", "skeleton", "-o", "body.stl"],
        ["mesh", "car", "-o", "body.doc", "--resolution", "16"],
        ["fields", "skeleton", "-o", "sheet.doc"],
        ["fields", "skeleton", "-o", "sheet.png", "--set", "a=long"],
        ["fields", "skeleton", "-o", "sheet.png", "--set", "q=1"],
        ["fields", "skeleton", "-o", "nowhere/sheet.png", "--resolution", "16"],
        ["fields", "missing.rf", "-o", "sheet.png"],
        ["reproduce", "--only", "fig99", "--out", "figures"],
    ],
)
def test_refused_input_is_exit_code_1_with_one_line_and_no_file(arguments, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    message = capsys.readouterr().err.strip().splitlines()[-1]
    assert message.startswith("rsym: ")
    assert not list(tmp_path.iterdir())


def test_wrong_usage_is_exit_code_2():
    for arguments in ([], ["fly"], ["fields"]):
        done = subprocess.run([sys.executable, "-m", "rsym.cli", *arguments], capture_output=True, check=False)
        assert done.returncode in (0, 2)
    with pytest.raises(SystemExit) as caught:
        main(["fly"])
    assert caught.value.code == 2
