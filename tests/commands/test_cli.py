import json
import logging
import os
import shlex
import subprocess
import sys
from argparse import ArgumentTypeError
from pathlib import Path

import matplotlib.pyplot
import numpy as np
import pytest
import tqdm
import trimesh

import rsym.commands.letters
from rsym.cli import COMMANDS, main
from rsym.commands.options import values

MODEL = """
letter r = 1 in [0.5, 3] "radius"
letter h = 2
variant wide: r = 2
bounds x [-2, 2] y [-2, 2] z [-2, 2]
ball = (r^2 - x^2 - y^2 - z^2)/(2*r)
slab = (h^2 - z^2)/(2*h)
omega = rfAND(ball, z)
"""


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "ball.rf"
    path.write_text(MODEL)
    return str(path)


@pytest.mark.slow
def test_fields_of_a_shipped_model(tmp_path, capsys):
    path = tmp_path / "sheet.png"
    assert main(["fields", "skeleton", "-o", str(path), "--resolution", "60", "--set", "a2=6"]) == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert "sheet.png" in capsys.readouterr().out


@pytest.mark.slow
def test_a_section_and_another_format(tmp_path, model):
    path = tmp_path / "sheet.svg"
    assert main(["fields", model, "-o", str(path), "--resolution", "40", "--section", "z=0.5"]) == 0
    assert b"<svg" in path.read_bytes()


def test_bounds_of_the_line_stand_for_those_of_the_model(tmp_path, model):
    path = tmp_path / "body.stl"
    arguments = ["mesh", model, "-o", str(path), "--resolution", "16", "--bounds", "z=0:0.5,x=-2:2,y=-2:2"]
    assert main(arguments) == 0
    assert np.allclose(trimesh.load_mesh(path).bounds, [[-1, -1, 0], [1, 1, 0.5]], atol=1e-2)


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


def test_a_mesh_that_is_cut_is_capped_or_open_in_either_method(tmp_path, model, capsys):
    path = tmp_path / "body.ply"
    common = ["mesh", model, "-o", str(path), "--resolution", "24", "--shape", "ball", "--set", "r=2.5"]
    volumes = {}
    for name, options in (("capped", []), ("open", ["--open"]), ("smooth", ["--method", "smooth"])):
        assert main([*common, *options]) == 0
        first, *remarks = capsys.readouterr().out.splitlines()[1:]
        assert all(remark.startswith("- ") for remark in remarks)
        assert any("the lower end of x" in remark for remark in remarks)
        body = trimesh.load_mesh(path)
        assert body.is_watertight == (name == "capped") == ("closed" in first)
        volumes[name] = body.volume
    # What the cube of side 4 cuts off the ball are six caps of height 0.5.
    assert abs(volumes["capped"] - np.pi * (4 / 3 * 2.5**3 - 6 * 0.25 * (3 * 2.5 - 0.5) / 3)) < 0.3


@pytest.mark.slow
def test_the_essential_is_said_in_three_lines(tmp_path, capsys):
    common = ["mesh", "car", "-q", "-o", str(tmp_path / "car.stl")]
    assert main(common) == 0
    _, resolution, first, *caveats = capsys.readouterr().out.splitlines()
    assert resolution == "resolution 346"
    assert "in 5 pieces, closed" in first
    assert "Euler characteristic 0" in first
    common += ["--resolution", "128"]
    assert main(common) == 0
    _, first, *caveats = capsys.readouterr().out.splitlines()
    assert "closed" in first
    assert len(caveats) <= 3
    assert "24 gaps" in caveats[0]
    assert "0.74 cells wide near (4.001, -8.754, 0.9074)" in caveats[0]
    assert "--resolution 346 puts 2 cells across every wall and gap; --verbose tells all 30 places" in caveats[-1]
    assert main([*common, "--verbose"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2 + 30


def test_features_and_a_model_without_bounds(tmp_path, capsys):
    path, edges = tmp_path / "lens.rf", tmp_path / "edges.dxf"
    path.write_text("coordinates x y z; a = 1 - (x - 9)^2 - y^2 - z^2; b = x - 9; omega = rfAND(a, b)")
    arguments = ["mesh", str(path), "-o", str(tmp_path / "lens.stl"), "--resolution", "32", "--features", str(edges)]
    assert main(arguments) == 0
    assert capsys.readouterr().out.splitlines()[:2] == [str(edges), str(tmp_path / "lens.stl")]
    assert edges.read_text().count("POLYLINE") == 1
    (tmp_path / "lens.stl").unlink()
    assert main([*arguments, "--method", "smooth"]) == 1
    assert "sharp" in capsys.readouterr().err
    assert not (tmp_path / "lens.stl").exists()


def test_a_notice_is_one_line_beside_the_output(monkeypatch, capsys):
    def slow(options):
        logging.getLogger("rsym.sampling.sharp.loops").warning("this takes a while")
        print("done")

    monkeypatch.setattr(rsym.commands.letters, "run", slow)
    for _ in range(2):
        assert main(["letters", "car"]) == 0
        assert capsys.readouterr() == ("done\n", "rsym: this takes a while\n")


def test_letters_are_a_table(model, capsys):
    assert main(["letters", model]) == 0
    assert [line.split() for line in capsys.readouterr().out.splitlines()] == [
        ["letter", "value", "range", "wide", "meaning"],
        ["r", "1", "[0.5,", "3]", "2", "radius"],
        ["h", "2"],
    ]
    assert main(["letters", model, "--variant", "wide", "--shape", "ball"]) == 0
    assert [line.split()[:2] for line in capsys.readouterr().out.splitlines()] == [["letter", "value"], ["r", "2"]]


def test_a_model_as_text(model, capsys):
    assert main(["show", model, "--set", "r=2.5"]) == 0
    text = capsys.readouterr().out
    assert text.splitlines() == [
        "coordinates  x y z",
        "bounds       x [-2, 2]  y [-2, 2]  z [-2, 2]",
        "system       R0",
        "letters      r = 2.5",
        "",
        "ball = (r**2 - x**2 - y**2 - z**2)/(2*r)",
        "omega = conjunction(ball, z)",
    ]


def test_a_model_in_another_language(tmp_path, model, capsys):
    path = tmp_path / "ball.mjs"
    arguments = ["source", model, "--language", "javascript", "--fields", "value, gradient", "--set", "r=1.5"]
    assert main(arguments) == 0
    text = capsys.readouterr().out
    assert "r = 1.5" in text
    assert "out3[i] = " in text
    assert main([*arguments, "--constants", "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    assert "letters" not in path.read_text()


def test_a_model_as_latex(model, capsys):
    assert main(["show", model, "--latex", "--shape", "slab"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(r"\documentclass{article}")
    assert "$x \\in [-2, 2]$, $y" in text
    assert "$h = 2$." in text
    assert r"\mathrm{slab} &= \frac{h^{2} - z^{2}}{2 h}" in text
    assert "ball" not in text
    assert text.count(r"\begin") == text.count(r"\end") == 2
    assert main(["show", "car", "--latex"]) == 0
    text = capsys.readouterr().out
    assert r"W &= \mathrm{test}_{5} \wedge_0 \left(-\omega_{far}\right)" in text
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")


def test_a_preset_sets_letters_and_a_single_value_beats_it(tmp_path, model, capsys):
    preset = tmp_path / "wide.json"
    rsym.save_letters({"r": 1.5, "h": 3}, preset)
    assert main(["letters", model, "--letters", str(preset)]) == 0
    assert [line.split()[1] for line in capsys.readouterr().out.splitlines()] == ["value", "1.5", "3"]
    path = tmp_path / "body.stl"
    common = ["mesh", model, "-o", str(path), "--shape", "ball", "--resolution", "32", "--letters", str(preset)]
    assert main(common) == 0
    assert abs(trimesh.load_mesh(path).extents.max() - 3) < 0.05
    assert main([*common, "--set", "r=1"]) == 0
    assert abs(trimesh.load_mesh(path).extents.max() - 2) < 0.05


@pytest.mark.slow
def test_a_strip_of_small_multiples(tmp_path, model):
    sweep = ["sweep", model, "--letter", "r", "--values", "1,1.5", "--resolution", "24"]
    assert main([*sweep, "-o", str(tmp_path / "bodies.png"), "--shape", "ball"]) == 0
    assert main([*sweep, "-o", str(tmp_path / "cuts.svg"), "--section", "z=0.5", "--columns", "1"]) == 0
    assert (tmp_path / "bodies.png").read_bytes().startswith(b"\x89PNG")
    first = (tmp_path / "cuts.svg").read_bytes()
    assert main([*sweep, "-o", str(tmp_path / "cuts.svg"), "--section", "z=0.5", "--columns", "1"]) == 0
    assert (tmp_path / "cuts.svg").read_bytes() == first


@pytest.mark.parametrize(
    ("text", "expected"),
    [("0:1:0.1", [k / 10 for k in range(11)]), ("1:0:-0.5", [1, 0.5, 0]), ("2:2:1", [2]), ("0:1:0.4", [0, 0.4, 0.8])],
)
def test_a_run_of_values_counts_in_decimals(text, expected):
    assert values(text) == expected


@pytest.mark.parametrize("text", ["", "1:0:1", "0:1:0", "0:1", "0:1:2:3", "0:1e9:1e-3", "a:b:c", "0:inf:1", "nan:1:1"])
def test_a_wrong_run_of_values_is_refused(text):
    with pytest.raises(ArgumentTypeError, match="start:stop:step"):
        values(text)


@pytest.mark.slow
def test_sections_are_layers_or_a_stack(tmp_path, model):
    cut = ["sections", model, "--shape", "ball", "--values", "0,0.6", "--resolution", "32"]
    assert main([*cut, "-o", str(tmp_path / "layers.svg"), "--scale", "10"]) == 0
    assert (tmp_path / "layers.svg").read_text().count("<path") == 2
    assert main([*cut, "-o", str(tmp_path / "layers.dxf"), "--unit", "in"]) == 0
    assert (tmp_path / "layers.dxf").read_text().count("POLYLINE") == 2
    assert main([*cut, "-o", str(tmp_path / "stack.png"), "--axis", "x"]) == 0
    assert (tmp_path / "stack.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_warning_is_one_line(tmp_path, model, capsys):
    sweep = ["sweep", model, "--letter", "r", "--values", "2.5", "--resolution", "24", "--shape", "ball"]
    assert main([*sweep, "-o", str(tmp_path / "bodies.png")]) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("rsym: warning: r = 2.5: ")


SQUARE = """
coordinates x y
bounds x [-2, 2] y [-2, 2]
omega = conjunction(1 - x, 1 + x, 1 - y, 1 + y)
"""


@pytest.mark.slow
def test_the_logic_in_another_system(tmp_path, capsys):
    """In R_0 the half-planes of a square are of order 1, in R_4 of order 3."""
    path = tmp_path / "square.rf"
    path.write_text(SQUARE)
    found = {}
    for system in ("R0", "Rp(4)"):
        main(["verify", str(path), "--normalisation", "2", "--system", system, "--json"])
        found[system] = json.loads(capsys.readouterr().out)["worst"][1]["deviation"]
    assert abs(found["R0"]) > 0.4
    assert abs(found["Rp(4)"]) < 1e-3


def test_the_resolution_of_each_axis(tmp_path, model):
    path = tmp_path / "body.stl"
    assert main(["mesh", model, "-o", str(path), "--resolution", "16,20,24"]) == 0
    assert trimesh.load_mesh(path).is_watertight


def test_a_mesh_is_coloured_by_part(tmp_path, model):
    path = tmp_path / "body.glb"
    assert main(["mesh", model, "-o", str(path), "--resolution", "24", "--colour-by", "part"]) == 0
    assert len(trimesh.load_scene(path).geometry) > 1


@pytest.mark.random
@pytest.mark.parametrize(
    "arguments",
    [
        ["mesh", "skeleton", "-o", "body.stl"],
        ["mesh", "car", "-o", "body.doc", "--resolution", "16"],
        ["mesh", "car", "-o", "body.stl", "--resolution", "16", "--colour-by", "part"],
        ["fields", "skeleton", "-o", "sheet.doc"],
        ["fields", "skeleton", "-o", "sheet.png", "--set", "a=long"],
        ["fields", "skeleton", "-o", "sheet.png", "--set", "q=1"],
        ["fields", "skeleton", "-o", "nowhere/sheet.png", "--resolution", "16"],
        ["fields", "missing.rf", "-o", "sheet.png"],
        ["fields", "skeleton", "-o", "sheet.png", "--letters", "missing.json"],
        ["fields", "skeleton", "-o", "sheet.png", "--resolution", "1"],
        ["fields", "skeleton", "-o", "sheet.png", "--section", "z"],
        ["fields", "car", "-o", "sheet.png", "--section", "w=1"],
        ["fields", "car", "-o", "sheet.png", "--section", "z=1", "--system", "Rq 4"],
        ["fields", "car", "-o", "sheet.png", "--section", "z=1", "--system", "Rp"],
        ["fields", "car", "-o", "sheet.png", "--section", "z=1", "--system", "R1\nf = 2"],
        ["fields", "car", "-o", "sheet.png", "--section", "z=nan"],
        ["fields", "car", "-o", "sheet.png", "--shape", "test1", "--section", "z=1", "--set", "h5=4"],
        ["sweep", "skeleton", "-o", "strip.png", "--letter", "p9", "--values", "1,2"],
        ["sweep", "skeleton", "-o", "strip.png", "--letter", "p1", "--values", "20,1e9"],
        ["sweep", "skeleton", "-o", "strip.png", "--letter", "p1", "--values", "20", "--columns", "0"],
        ["sweep", "skeleton", "-o", "strip.gif", "--letter", "p1", "--values", "20"],
        ["show", "skeleton", "--variant", "a"],
        ["mesh", "car", "-o", "car.stl", "--bounds", "x=-1:1"],
        ["mesh", "car", "-o", "car.stl", "--bounds", "x=-1:1,y=0:1,w=0:1"],
        ["mesh", "car", "-o", "car.stl", "--bounds", "x=-1:1,y=0:1,z=1:0"],
        ["mesh", "car", "-o", "car.stl", "--bounds", "x=-1:1,y=0:1,z=0"],
        ["letters", "car", "--set", "raa=1"],
        ["source", "skeleton", "--language", "vm", "--fields", "gradient", "-o", "x.vm"],
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
    for arguments in (["fly"], ["fields", "car", "-o", "a.png", "--resolution", "4z"], ["sweep", "car"]):
        with pytest.raises(SystemExit) as caught:
            main(arguments)
        assert caught.value.code == 2


@pytest.mark.slow
def test_the_remedy_names_what_was_probably_meant(capsys):
    for arguments, meant in [
        (["show", "skeletn"], "'skeleton'"),
        (["letters", "car", "--set", "a11=3"], "'a1'"),
        (["letters", "car", "--set", "ra=50"], "[0.5, 5]"),
    ]:
        assert main(arguments) == 1
        assert meant in capsys.readouterr().err


def test_every_command_has_an_example_that_is_no_wrong_usage(monkeypatch, capsys):
    for command in COMMANDS:
        monkeypatch.setattr(command, "run", lambda options: None)
    names = [command.__name__.rpartition(".")[2] for command in COMMANDS]
    for name in names:
        with pytest.raises(SystemExit) as caught:
            main([name, "--help"])
        assert caught.value.code == 0
        example = capsys.readouterr().out.rstrip().splitlines()[-1]
        example = shlex.split(example.split(" > ")[0])
        assert example[:2] == ["rsym", name]
        assert main(example[1:]) == 0
    folder = Path(rsym.__file__).parent / "commands"
    assert {path.stem for path in folder.glob("*.py")} == {*names, "__init__", "options", "field_options"}


def test_the_version(capsys):
    with pytest.raises(SystemExit) as caught:
        main(["--version"])
    assert caught.value.code == 0
    assert capsys.readouterr().out.startswith("rsym ")


@pytest.mark.parametrize(
    "arguments",
    [
        ["fields", "skeleton", "-o", "sheet.png", "--resolution", "16"],
        ["sweep", "skeleton", "-o", "strip.png", "--letter", "p1", "--values", "20", "--resolution", "16"],
        ["mesh", "skeleton", "--revolve", "x", "-o", "nose.stl", "--resolution", "16"],
    ],
)
def test_an_interrupt_leaves_nothing(arguments, tmp_path, monkeypatch, capsys):
    def interrupt(bar):
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tqdm.tqdm, "refresh", interrupt)
    assert main(arguments) == 130
    assert "interrupted" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="pipes of POSIX")
def test_a_reader_that_leaves():
    reader, writer = os.pipe()
    os.close(reader)
    command = [sys.executable, "-m", "rsym.cli", "letters", "skeleton"]
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert done.returncode == 1
    assert done.stderr.startswith("rsym: whoever read the output left")
    assert len(done.stderr.splitlines()) == 1


WRITING = {
    **{name: ["-o"] for name in ("fields", "mesh", "render", "sections", "sweep")},
    **{
        name: ["-o"]
        for name in ("compare", "design", "modes", "repair", "solve", "source", "torsion", "verify", "view")
    },
    "fit": ["-o", "--picture"],
    "mesh --features": ["--features"],
}
NEEDED = {
    "sections": ["--values", "1"],
    "sweep": ["--letter", "r", "--values", "1"],
    "source": ["--language", "c"],
    "fit": ["points.txt", "--find", "r"],
}


@pytest.mark.parametrize("command", WRITING)
def test_a_folder_that_is_not_there_is_refused_before_the_work(command, tmp_path, capsys):
    name = command.split()[0]
    for option in WRITING[command]:
        there = ["-o", str(tmp_path / "body.stl")] if option == "--features" else []
        line = [name, "no-such-model.rf", *NEEDED.get(name, ()), *there, option, str(tmp_path / "no" / "file.xyz")]
        assert main(line) == 1
        assert "there is no folder" in capsys.readouterr().err


SUFFIXES = [name for name in WRITING if name not in ("source", "fit")]


@pytest.mark.parametrize("command", SUFFIXES)
def test_a_suffix_that_is_not_known_is_refused_before_the_work(command, tmp_path, capsys, model, monkeypatch):
    name, option = command.split()[0], WRITING[command][0]
    for slow in ("sampling.meshing.mesh", "output.rendering.render", "sampling.sections.sections"):
        monkeypatch.setattr(f"rsym.{slow}", None)
    there = ["-o", str(tmp_path / "body.stl")] if option == "--features" else []
    assert main([name, model, *NEEDED.get(name, ()), *there, option, str(tmp_path / "file.abc")]) == 1
    assert "file.abc" in capsys.readouterr().err
