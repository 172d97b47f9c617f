"""What a person at a terminal meets first: help in groups, what was meant, models, quiet, completion, prisms."""

import importlib.metadata
import io
import logging
import os
import subprocess
import sys
import types

import pytest

import rsym
from rsym.cli import COMMANDS, GROUPS, main
from rsym.commands.options import QUIET, progress_bar

FLAT = "letter h = 2 in [1, 3]\nbounds x [-2, 2] y [-2, 2]\nomega = (h - x^2 - y^2)/2\n"


@pytest.fixture
def flat(tmp_path):
    (tmp_path / "flat.rf").write_text(FLAT)
    return str(tmp_path / "flat.rf")


def test_the_version_is_that_of_the_package(capsys):
    assert rsym.__version__ == importlib.metadata.version("rsym")
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"rsym {rsym.__version__}\n"


def test_help_names_every_command_once_in_its_group(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    lines = capsys.readouterr().out.splitlines()
    for title in GROUPS:
        assert f"{title}:" in lines
    for command in COMMANDS:
        name = command.__name__.rpartition(".")[2]
        assert sum(line.startswith(f"  {name} ") for line in lines) == 1
    assert max(map(len, lines)) <= 100


def test_models_are_listed_with_a_line_each(capsys):
    assert main(["models"]) == 0
    lines = capsys.readouterr().out.splitlines()[1:]
    assert [line.split()[0] for line in lines] == list(rsym.paper.MODELS)
    assert all(len(line.split()) > 3 for line in lines)


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["mehs", "car", "-o", "x.stl"], "'mesh'"),
        (["mesh", "car", "-o", "x.stl", "--resoluton", "4"], "'--resolution'"),
        (["mesh", "car", "-o", "x.stl", "--method", "shrap"], "'sharp'"),
    ],
)
def test_wrong_usage_is_answered_with_what_was_meant(arguments, meant, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    assert f"did you mean {meant}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["letters", "car", "--set", "xk=1"], "'xk1'"),
        (["show", "lattise"], "'lattice'"),
        (["show", "car", "--latex", "--field", "laplacien"], "'laplacian'"),
        (["show", "car", "--shape", "tset4"], "'test4'"),
        (["show", "car", "--variant", "B1"], "'b'"),
    ],
)
def test_wrong_names_are_answered_with_what_was_meant(arguments, meant, capsys):
    assert main(arguments) == 1
    assert "did you mean" in (error := capsys.readouterr().err)
    assert meant in error


def test_unknown_fields_are_answered_with_the_nearest():
    with pytest.raises(rsym.RsymError, match="did you mean 'gradient'"):
        rsym.compile(rsym.disc(1), ("gradeint",))
    with pytest.raises(rsym.RsymError, match="did you mean 'laplacian'"):
        rsym.level_lines(rsym.disc(1), field="laplacien")


@pytest.mark.slow
def test_quiet_shows_no_bar_and_no_notice(flat, tmp_path, monkeypatch, capsys):
    shown = []

    def bar(*arguments, disable, **options):
        shown.append(disable)
        return _Bar()

    class _Bar:
        total = n = 0

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def refresh(self):
            pass

        def set_description_str(self, *_, **__):
            pass

        set_postfix_str = set_description_str

    import tqdm

    monkeypatch.setattr(tqdm, "tqdm", bar)
    with progress_bar("step", "working"):
        pass
    assert main(["mesh", flat, "--extrude", "1", "-o", str(tmp_path / "a.stl"), "--resolution", "8", "--quiet"]) == 0
    assert shown[0] is None
    assert set(shown[1:]) == {True}
    assert not QUIET.get()


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_bar_shows_which_loop_is_compiled(monkeypatch):
    terminal, compiler = Terminal(), logging.getLogger("rsym.sampling.sharp.loops")
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress_bar("step", "meshing") as progress:
        compiler.info("compiling loop 3: scan")
        assert "compiling loop 3: scan" in terminal.getvalue()
        progress(1, 2)
        before = len(terminal.getvalue())
        progress(2, 2)
        assert "scan" not in terminal.getvalue()[before:]
    assert not compiler.handlers
    assert not compiler.isEnabledFor(logging.INFO)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_can_be_quiet(command, capsys):
    with pytest.raises(SystemExit):
        main([command.__name__.rpartition(".")[2], "--help"])
    assert "--quiet" in capsys.readouterr().out


def test_a_plane_model_becomes_a_prism(flat, tmp_path, capsys):
    import trimesh

    path = tmp_path / "prism.stl"
    assert main(["mesh", flat, "--extrude", "3", "-o", str(path), "--resolution", "48"]) == 0
    body = trimesh.load(path)
    assert body.is_watertight
    assert abs(body.volume - 3 * 3.141592653589793 * 2) < 0.1
    assert main(["mesh", flat, "--extrude", "0", "-o", str(path)]) == 1
    assert main(["mesh", "solids", "--extrude", "2", "-o", str(path)]) == 1
    assert "extrude" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        main(["mesh", flat, "--extrude", "3", "--revolve", "x", "-o", str(path)])


def test_a_shell_that_completes_is_answered_where_argcomplete_is_installed(monkeypatch, capsys):
    asked = []
    fake = types.ModuleType("argcomplete")
    fake.autocomplete = lambda parser: asked.append(parser.prog)
    monkeypatch.setitem(sys.modules, "argcomplete", fake)
    monkeypatch.setenv("_ARGCOMPLETE", "1")
    assert main(["models"]) == 0
    assert asked == ["rsym"]
    monkeypatch.setitem(sys.modules, "argcomplete", None)
    assert main(["models"]) == 0


def test_models_and_files_are_completed(flat, monkeypatch, tmp_path):
    from rsym.commands.options import _completed

    monkeypatch.chdir(tmp_path)
    assert _completed("s") == ["shaft", "skeleton", "snowflake", "solids", "spanner", "spring", "streamlined"]
    assert _completed("fl") == ["flat.rf"]
    (tmp_path / "lens.vm").touch()
    assert _completed("le") == ["lens.vm"]


def test_argcomplete_itself_completes(tmp_path):
    pytest.importorskip("argcomplete")
    line = "rsym mesh sp"
    answer = tmp_path / "answer"
    environment = {
        **os.environ,
        **{"_ARGCOMPLETE": "1", "COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE_IFS": "\n"},
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
    }
    subprocess.run([sys.executable, "-m", "rsym.cli"], env=environment, capture_output=True, timeout=60)
    assert {word.strip() for word in answer.read_text().split("\n")} == {"spanner", "spring"}
