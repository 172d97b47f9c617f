"""A mesh in pieces into a file: the bytes of the uncut one, whatever happens on the way."""

import errno
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import RsymError, x, y, z
from rsym.cli import main
from rsym.sampling import streaming
from rsym.sampling.sharp import mending

a = sp.Symbol("a", real=True)
BOUNDS = ((-0.9, 0.8), (-0.7, 0.7), (-0.5, 1.0))
CUBE = rsym.conjunction(a - abs(x + y / 3), a - abs(y - z / 5), a - abs(z - x / 4))
FOAM = sp.sin(23 * x) * sp.sin(19 * y) * sp.sin(29 * z) + sp.cos(31 * x + 7 * y) * sp.sin(37 * z) / 2 - 0.2
CUT_CUBE = rsym.conjunction(CUBE, 0.3 - x**2 - y**2 + z)
# Full of ambiguous faces, folds and crumbs.
CRUMBLED = rsym.disjunction(CUT_CUBE, rsym.conjunction(FOAM, -x - y))
CELLS, CRUMBS = 64, 32  # crumbs take their time

pytestmark = pytest.mark.filterwarnings("ignore::rsym.errors.RsymWarning")


@pytest.fixture(scope="module")
def crumbled():
    return rsym.Shape(CRUMBLED, (x, y, z), letters={a: 0.6}, bounds=BOUNDS)


@pytest.fixture(scope="module")
def uncut(crumbled):
    return rsym.mesh(crumbled, CRUMBS)


@pytest.fixture(scope="module")
def cube():
    return rsym.Shape(CUT_CUBE, (x, y, z), letters={a: 0.6}, bounds=BOUNDS)


@pytest.fixture
def small(monkeypatch):
    """What pieces may take, whatever the process takes."""
    monkeypatch.setattr(streaming, "_free", lambda memory: memory)
    monkeypatch.setattr(mending, "PART", 0)


def bytes_written(mesh, path):
    return rsym.write(mesh, path).read_bytes()


@pytest.mark.parametrize(("suffix", "memory", "fewest"), [(".ply", 1e6, 4), (".stl", 2e6, 2), (".ply", 4e5, 15)])
def test_the_bytes_are_those_of_the_uncut_mesh(cube, tmp_path, small, suffix, memory, fewest):
    """The last one cuts layers, and rows of layers."""
    made = rsym.mesh(cube, CELLS, into=tmp_path / f"body{suffix}", memory=memory)
    assert made.status.pieces >= fewest
    assert made.path.read_bytes() == bytes_written(rsym.mesh(cube, CELLS), tmp_path / f"uncut{suffix}")
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"body{suffix}", f"uncut{suffix}"]


def test_what_was_measured_is_what_the_uncut_mesh_measures(cube, tmp_path, small):
    made, uncut = rsym.mesh(cube, CELLS, into=tmp_path / "body.stl", memory=6e5), rsym.mesh(cube, CELLS)
    status = uncut.status
    assert (made.vertices, made.faces) == (len(uncut.vertices), len(uncut.faces))
    assert made.status.closed == status.closed
    assert made.bounds == uncut.bounds
    assert made.status.clipped_at == status.clipped_at != ()
    assert made.status.off_surface == status.off_surface
    assert np.allclose([made.volume, made.area], [status.volume, status.area], rtol=1e-12)
    assert str(made.faces) in str(made.status)


@pytest.mark.slow
@pytest.mark.parametrize("around", [2, 0])
def test_flaws_in_pieces_are_mended(crumbled, uncut, tmp_path, small, monkeypatch, around):
    """Vertices move and go, triangles change and go; a part that is too small grows."""
    monkeypatch.setattr(mending, "AROUND", around)
    kept = []
    plain = mending.mend
    monkeypatch.setattr(streaming, "mend", lambda *given: kept.append(plain(*given)) or kept[0])
    made = rsym.mesh(crumbled, CRUMBS, into=tmp_path / "body.ply", memory=1e6)
    (changes,) = kept
    assert min(len(changes.moved), len(changes.gone), (changes.corners[:, 0] >= 0).sum()) > 10
    assert (changes.corners[:, 0] < 0).any()
    assert made.status.pieces >= 4
    assert made.path.read_bytes() == bytes_written(uncut, tmp_path / "uncut.ply")


def models():
    yield "car", rsym.paper.car(), 160
    yield "gear", rsym.load("gear"), 97
    yield "skeleton", rsym.revolve(rsym.paper.skeleton_body()), 256
    yield "valve", rsym.paper.valve(), 160


@pytest.mark.slow
@pytest.mark.parametrize("name", ["car", "gear", "skeleton", "valve"])
@pytest.mark.parametrize("suffix", [".ply", ".stl"])
def test_models_with_edges(name, suffix, tmp_path, small):
    shape, resolution = next((shape, resolution) for one, shape, resolution in models() if one == name)
    made = rsym.mesh(shape, resolution, into=tmp_path / f"a{suffix}", memory=1e6)
    whole = rsym.mesh(shape, resolution)
    assert made.status.pieces > 2
    assert made.path.read_bytes() == bytes_written(whole, tmp_path / f"b{suffix}")
    assert made.status.closed
    assert whole.status.closed


def counted(monkeypatch):
    calls = []
    plain = streaming.own_piece
    monkeypatch.setattr(streaming, "own_piece", lambda *given: calls.append(1) or plain(*given))
    return calls


def test_boxes_are_cut_by_what_they_hold(tmp_path, small, monkeypatch):
    """A ball with a pin: in equal parts some would hold little, and others would be cut again."""
    pin = rsym.conjunction(0.02 - y**2 - z**2, 4 - x, x + 1)
    body = rsym.Shape(
        rsym.disjunction(1 - (x + 1) ** 2 - y**2 - z**2, pin), (x, y, z), bounds=((-2.1, 4.2), (-1.1, 1.1), (-1.1, 1.1))
    )
    asked, plain = [], streaming.assemble
    monkeypatch.setattr(streaming, "assemble", lambda *given: asked.append(1) or plain(*given))
    made = rsym.mesh(body, 240, into=tmp_path / "pin.ply", memory=1e6)
    assert made.status.closed
    assert len(asked) <= 1.3 * made.status.pieces


def test_a_cancel_keeps_what_is_done(cube, tmp_path, small, monkeypatch):
    path = tmp_path / "cube.ply"
    path.write_bytes(b"older")
    calls = counted(monkeypatch)
    with pytest.raises(RsymError, match="cancelled"):
        rsym.mesh(cube, CELLS, into=path, memory=6e5, progress=lambda done, total: len(calls) < 3)
    assert path.read_bytes() == b"older"
    begun = len(calls)
    assert begun in (3, 4)
    kept = sum(one.is_dir() for one in streaming.parts_of(path).iterdir())
    assert begun - kept in (0, 1)  # the last one is cut out and kept beside what was cancelled
    reports = []
    made = rsym.mesh(
        cube, CELLS, into=path, memory=6e5, progress=lambda done, total: reports.append((done, total)) or True
    )
    assert len(calls) == begun + made.status.pieces - kept
    assert path.read_bytes() == bytes_written(rsym.mesh(cube, CELLS), tmp_path / "uncut.ply")
    assert reports == sorted(reports)
    assert reports[-1] == (1000, 1000)


def test_a_kill_keeps_what_is_done(tmp_path):
    """A process that kills itself between two pieces, and one that goes on."""
    program = """
import os, signal, sys, pathlib, rsym
from rsym import x, y, z
from rsym.sampling import streaming
streaming._free = lambda memory: memory
ball = rsym.Shape(1 - x**2 - y**2 - z**2 / 2, (x, y, z), bounds=((-1.1, 1.1), (-1.1, 1.1), (-1.1, 1.5)))
kept, plain = [], streaming.keep
def keep(*given):
    plain(*given)
    kept.append(1)
    if len(kept) == int(sys.argv[2]):
        os.kill(os.getpid(), signal.SIGKILL)
streaming.keep = keep
made = rsym.mesh(ball, 64, into=sys.argv[1], memory=1.5e6)
print(len(kept), made.status.pieces)
"""
    path = tmp_path / "ball.ply"
    command = [sys.executable, "-W", "ignore", "-c", program, str(path)]
    killed = subprocess.run([*command, "2"], check=False, capture_output=True)
    assert killed.returncode == -signal.SIGKILL
    assert not path.exists()
    done = subprocess.run([*command, "0"], check=True, capture_output=True, text=True)
    computed, pieces = map(int, done.stdout.split())
    assert 0 < computed == pieces - 2
    ball = rsym.Shape(1 - x**2 - y**2 - z**2 / 2, (x, y, z), bounds=((-1.1, 1.1), (-1.1, 1.1), (-1.1, 1.5)))
    assert path.read_bytes() == bytes_written(rsym.mesh(ball, 64), tmp_path / "uncut.ply")
    assert not streaming.parts_of(path).exists()


def interrupted(shape, path, monkeypatch, **options):
    """Leave some pieces of a mesh beside a file."""
    calls = counted(monkeypatch)
    with pytest.raises(RsymError, match="cancelled"):
        rsym.mesh(shape, CELLS, into=path, memory=6e5, progress=lambda done, total: len(calls) < 3, **options)
    return calls


@pytest.mark.parametrize("options", [{"letters": {"a": 0.55}}, {"bounds": ((-0.9, 0.8), (-0.7, 0.7), (-0.5, 0.9))}])
def test_pieces_of_another_mesh_are_not_taken(cube, tmp_path, small, monkeypatch, options):
    path = tmp_path / "cube.ply"
    calls = interrupted(cube, path, monkeypatch, **options)
    made = rsym.mesh(cube, CELLS, into=path, memory=6e5)
    assert len(calls) == 3 + made.status.pieces
    assert path.read_bytes() == bytes_written(rsym.mesh(cube, CELLS), tmp_path / "uncut.ply")


def test_pieces_of_another_version_are_not_taken(cube, tmp_path, small, monkeypatch):
    path = tmp_path / "cube.ply"
    calls = interrupted(cube, path, monkeypatch)
    monkeypatch.setattr(streaming, "__version__", "another")
    made = rsym.mesh(cube, CELLS, into=path, memory=6e5)
    assert len(calls) == 3 + made.status.pieces


def test_a_folder_of_somebody_else_is_left_alone(cube, tmp_path, small):
    folder = tmp_path / "cube.ply.parts"
    folder.mkdir()
    (folder / "letters.txt").write_text("dear")
    with pytest.raises(RsymError, match="something else"):
        rsym.mesh(cube, CELLS, into=tmp_path / "cube.ply", memory=6e5)
    assert (folder / "letters.txt").read_text() == "dear"


def test_a_full_disk_is_an_error_of_ours(cube, tmp_path, small, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(streaming, "keep", full)
    with pytest.raises(RsymError, match="No space left"):
        rsym.mesh(cube, CELLS, into=tmp_path / "cube.ply", memory=6e5)
    assert not (tmp_path / "cube.ply").exists()


def test_a_folder_that_is_missing_is_named(cube, tmp_path):
    with pytest.raises(RsymError, match="there is no folder"):
        rsym.mesh(cube, CELLS, into=tmp_path / "nowhere" / "cube.ply")


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"into": "a.obj"}, "file-format"),
        ({"into": "a.ply", "method": "smooth"}, "streamed"),
        ({"into": "a.ply", "cap": False}, "streamed"),
        ({"memory": "1GB"}, "memory"),
        ({"into": "a.ply", "memory": "much"}, "memory"),
        ({"into": "a.ply", "memory": -1}, "memory"),
        ({"into": "a.ply", "memory": "1MB"}, "memory"),
    ],
)
def test_what_cannot_be_streamed_is_refused(cube, tmp_path, monkeypatch, options, code):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RsymError) as caught:
        rsym.mesh(cube, CELLS, **options)
    assert caught.value.code == code
    assert not list(tmp_path.iterdir())


def test_no_surface_leaves_nothing(tmp_path, small):
    nothing = rsym.Shape(-1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1, 1),) * 3)
    with pytest.raises(RsymError) as caught:
        rsym.mesh(nothing, 16, into=tmp_path / "nothing.ply", memory=1e7)
    assert caught.value.code == "no-surface"
    assert not list(tmp_path.iterdir())


def test_the_command_streams(tmp_path, capsys, small):
    arguments = ["mesh", "gear", "--resolution", "48", "--quiet", "-o"]
    assert main([*arguments, str(tmp_path / "a.ply"), "--memory", "20MB"]) == 0
    assert "computed in" in capsys.readouterr().out
    assert main([*arguments, str(tmp_path / "b.ply")]) == 0
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert main([*arguments, str(tmp_path / "c.obj"), "--memory", "20MB"]) != 0


@pytest.mark.slow
def test_the_peak_stays_below_the_bound(tmp_path):
    """The uncut mesh takes half a gigabyte."""
    program = f"""
import rsym
rsym.mesh(rsym.paper.car(), 1024, into={str(tmp_path / "car.ply")!r}, memory='400MB')
print(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')).split()[1])
"""  # what `getrusage` tells of a child counts its parent
    run = subprocess.run([sys.executable, "-W", "ignore", "-c", program], check=True, capture_output=True, text=True)
    assert 1024 * int(run.stdout) < 400e6
    assert (tmp_path / "car.ply").exists()
