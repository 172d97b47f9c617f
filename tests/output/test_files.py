import os
import stat

import numpy as np
import pytest
import trimesh

from rsym.atomic import write_atomically
from rsym.errors import RsymError
from rsym.output.files import write
from rsym.sampling.mesh import Mesh


def ball(radius=1.0, middle=(0.0, 0.0, 0.0)):
    sphere = trimesh.creation.icosphere(subdivisions=3)
    normals, faces = np.array(sphere.vertices), np.array(sphere.faces, np.int64)
    vertices = normals * radius + middle
    return Mesh(vertices, faces, normals[faces])


def test_a_ball_comes_back_closed_outward_and_with_its_volume(tmp_path):
    mesh = ball()
    path = write(mesh, tmp_path / "ball.STL")
    back = trimesh.load(path, file_type="stl")
    assert back.is_watertight
    assert back.volume == pytest.approx(mesh.status.volume, rel=1e-6)
    assert back.volume == pytest.approx(4 / 3 * np.pi, rel=0.02)
    assert path.stat().st_size == 84 + 50 * len(mesh.faces)
    assert (np.einsum("ij,ij->i", back.face_normals, back.triangles_center) > 0.9).all()


def test_the_same_mesh_gives_the_same_bytes(tmp_path):
    first, second = write(ball(), tmp_path / "a.stl"), write(ball(), str(tmp_path / "b.stl"))
    assert first.read_bytes() == second.read_bytes()


def test_an_unknown_suffix_is_refused_with_a_list(tmp_path):
    with pytest.raises(RsymError, match=r"\.stl") as caught:
        write(ball(), tmp_path / "ball.xyz")
    assert caught.value.code == "file-format"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("middle", [(1e3, 0, 0), (0, 0, -1e3)])
def test_stl_refuses_what_float32_cannot_hold(tmp_path, middle):
    with pytest.raises(RsymError, match="move the body to the origin") as caught:
        write(ball(1e-3, middle), tmp_path / "ball.stl")
    assert caught.value.code == "float32-precision"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("radius", [1e-42, 1e39])
def test_stl_refuses_sizes_beyond_float32(tmp_path, radius):
    with pytest.raises(RsymError, match="scale the body"):
        write(ball(radius), tmp_path / "ball.stl")


def test_a_small_body_away_from_the_origin_and_a_flat_one_are_written(tmp_path):
    write(ball(1.0, (1e3, 0, 0)), tmp_path / "away.stl")
    corners = np.array([[0, 0, 7.0], [1, 0, 7], [0, 1, 7]])
    faces = np.array([[0, 1, 2]])
    write(Mesh(corners, faces, np.zeros((1, 3, 3))), tmp_path / "flat.stl")
    assert {path.name for path in tmp_path.iterdir()} == {"away.stl", "flat.stl"}


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(RsymError, match="nowhere") as caught:
        write(ball(), tmp_path / "nowhere" / "ball.stl")
    assert caught.value.code == "file-folder"


@pytest.mark.parametrize("step", ["replace", "fsync"])
def test_a_failure_keeps_the_old_file_and_leaves_nothing_else(tmp_path, monkeypatch, step):
    def fail(*arguments):
        raise OSError(28, "No space left on device")

    path = tmp_path / "ball.stl"
    path.write_bytes(b"old")
    monkeypatch.setattr(os, step, fail)
    with pytest.raises(RsymError, match="No space left") as caught:
        write(ball(), path)
    assert caught.value.code == "file-write"
    assert [entry.name for entry in tmp_path.iterdir()] == ["ball.stl"]
    assert path.read_bytes() == b"old"


def test_an_interruption_leaves_nothing_behind(tmp_path, monkeypatch):
    def interrupt(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_atomically(tmp_path / "page.html", b"new")
    assert not list(tmp_path.iterdir())


def test_a_folder_in_the_place_of_the_file_is_refused(tmp_path):
    (tmp_path / "ball.stl").mkdir()
    with pytest.raises(RsymError, match="cannot be written"):
        write(ball(), tmp_path / "ball.stl")
    assert [entry.name for entry in tmp_path.iterdir()] == ["ball.stl"]


def test_the_file_and_its_folder_are_synced_around_the_renaming(tmp_path, monkeypatch):
    calls = []
    sync, replace = os.fsync, os.replace

    def record_sync(descriptor):
        calls.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        sync(descriptor)

    def record_replace(source, target):
        calls.append("replace")
        assert os.path.dirname(source) == os.path.dirname(target)
        replace(source, target)

    monkeypatch.setattr(os, "fsync", record_sync)
    monkeypatch.setattr(os, "replace", record_replace)
    assert write_atomically(tmp_path / "page.html", b"new").read_bytes() == b"new"
    assert calls == ["file", "replace", "folder"]


@pytest.mark.skipif(os.name != "posix", reason="permissions and links of POSIX")
def test_permissions_and_links_stay(tmp_path):
    target, link = tmp_path / "real.txt", tmp_path / "link.txt"
    target.write_bytes(b"old")
    target.chmod(0o640)
    link.symlink_to(target)
    write_atomically(link, b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    (tmp_path / "plain.txt").write_bytes(b"")
    fresh = write_atomically(tmp_path / "fresh.txt", b"new")
    assert fresh.stat().st_mode == (tmp_path / "plain.txt").stat().st_mode
