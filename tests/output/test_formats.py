"""Every format read back by a reader that shares no code with its writer."""

import json
import re
import zipfile

import numpy as np
import pytest
import trimesh
from oracles.closeness import assert_close
from sampling.test_features import tube

from rsym.errors import RsymError
from rsym.output.files import write
from rsym.output.formats import FORMATS
from rsym.output.parts import part_colours
from rsym.output.shading import linear, split_sharp
from rsym.sampling.mesh import Mesh

OWN = [suffix for suffix, row in FORMATS.items() if not row.package]
FLOAT64 = (".ply", ".obj", ".off", ".3mf")


def ball(scale=1.0, middle=(0.0, 0.0, 0.0)):
    sphere = trimesh.creation.icosphere(subdivisions=2)
    normals, faces = np.array(sphere.vertices), np.array(sphere.faces, np.int64)
    # Thirds need all 17 digits; unlike half-axes show a swapped coordinate.
    vertices = normals * np.array([1, 2, 4]) / 3 * scale + middle
    return Mesh(vertices, faces, normals[faces])


def cube():
    solid = trimesh.creation.box()
    vertices, faces = np.array(solid.vertices), np.array(solid.faces, np.int64)
    normals = np.repeat(np.array(solid.face_normals)[:, None], 3, axis=1)
    return Mesh(vertices, faces, normals)


@pytest.mark.parametrize("suffix", FLOAT64)
@pytest.mark.parametrize("scale", [1.0, 1e-9, 1e12])
def test_float64_comes_back_to_the_last_bit(tmp_path, suffix, scale):
    mesh = ball(scale, (1e3 * scale, 0, -np.pi * scale))
    back = trimesh.load_mesh(write(mesh, tmp_path / f"ball{suffix}"), process=False)
    assert np.array_equal(back.vertices, mesh.vertices)
    assert np.array_equal(back.faces, mesh.faces)


@pytest.mark.parametrize("suffix", [suffix for suffix in OWN if suffix != ".html"])
def test_every_format_gives_a_closed_outward_body(tmp_path, suffix):
    for mesh in (ball(), cube()):
        back = trimesh.load_mesh(write(mesh, tmp_path / f"body{suffix}"))
        back.merge_vertices(merge_norm=True)
        assert back.is_watertight
        assert_close(back.volume, mesh.status.volume, rtol=1e-6)


@pytest.mark.parametrize("suffix", OWN)
def test_the_same_mesh_gives_the_same_bytes(tmp_path, suffix, monkeypatch):
    first = write(ball(), tmp_path / f"first{suffix}").read_bytes()
    monkeypatch.setattr("time.time", lambda: 2e9)
    assert write(ball(), tmp_path / f"second{suffix}").read_bytes() == first


def test_ply_is_what_its_header_says(tmp_path):
    mesh = ball()
    header, _, data = write(mesh, tmp_path / "ball.ply").read_bytes().partition(b"end_header\n")
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    assert [line for line in lines if line.startswith("property double")] == [f"property double {c}" for c in "xyz"]
    assert len(data) == 24 * len(mesh.vertices) + 13 * len(mesh.faces)


def test_obj_shares_vertices_and_splits_normals(tmp_path):
    mesh = cube()
    text = write(mesh, tmp_path / "cube.obj").read_text()
    rows = {kind: re.findall(rf"^{kind} (.*)$", text, re.MULTILINE) for kind in ("v", "vn", "f")}
    assert {kind: len(found) for kind, found in rows.items()} == {"v": 8, "vn": 24, "f": 12}
    normals = np.array([row.split() for row in rows["vn"]], float)
    for face, row in enumerate(rows["f"]):
        places, directions = np.array(re.findall(r"(\d+)//(\d+)", row), int).T - 1
        assert np.array_equal(places, mesh.faces[face])
        assert_close(normals[directions], mesh.normals[face], atol=1e-6)


def test_glb_is_y_up_with_exact_normals(tmp_path):
    mesh = ball()
    data = write(mesh, tmp_path / "ball.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    tree, numbers = json.loads(data[20 : 20 + length]), data[28 + length :]

    def array(name):
        accessor = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"][name]]
        view = tree["bufferViews"][accessor["bufferView"]]
        return np.frombuffer(numbers, "<f4", 3 * accessor["count"], view["byteOffset"]).reshape(-1, 3)

    places, normals = array("POSITION"), array("NORMAL")
    assert_close(np.ptp(places, axis=0), np.array([2, 8, 4]) / 3, rtol=1e-6)
    x, y, z = places.T
    # The tall axis points up, and what was in front, at -y, faces the reader, at +z.
    assert_close(normals, np.stack([3 * x, 3 / 4 * y, 3 / 2 * z], axis=1), atol=1e-6)
    assert tree["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] == 0


def test_3mf_declares_millimetres_and_refuses_what_cannot_be_printed(tmp_path):
    path = write(ball(), tmp_path / "ball.3mf")
    with zipfile.ZipFile(path) as archive:
        assert b'unit="millimeter"' in archive.read("3D/3dmodel.model")
    whole = ball()
    faces = whole.faces[1:]
    for vertices, faces, said in (
        (whole.vertices, whole.faces[1:], "open surface"),
        (whole.vertices, whole.faces[:, ::-1], "volume of -"),
    ):
        with pytest.raises(RsymError, match=said) as caught:
            write(Mesh(vertices, faces, np.zeros((len(faces), 3, 3))), tmp_path / "no.3mf")
        assert caught.value.code == "format-body"


@pytest.mark.parametrize("suffix", [".stl", ".glb"])
def test_float32_formats_say_their_name(tmp_path, suffix):
    with pytest.raises(RsymError, match=f"{suffix[1:].upper()} keeps 7 digits"):
        write(ball(1e-3, (1e3, 0, 0)), tmp_path / f"ball{suffix}")
    with pytest.raises(RsymError, match=f"{suffix[1:].upper()} holds numbers"):
        write(ball(1e39), tmp_path / f"ball{suffix}")


def test_vertices_split_where_their_corners_differ_and_only_there():
    smooth, sharp = split_sharp(ball()), split_sharp(cube())
    assert len(smooth.vertices) == len(ball().vertices)
    assert len(sharp.vertices) == 24
    assert np.array_equal(sharp.vertices[sharp.faces], cube().vertices[cube().faces])
    assert_close(sharp.normals[sharp.faces], cube().normals, atol=1e-12)
    assert_close(smooth.normals[smooth.faces], ball().normals, atol=1e-12)


def test_normals_of_a_blunt_edge_are_averaged_and_unused_vertices_left_out():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [9, 9, 9.0]])
    faces = np.array([[0, 1, 2], [0, 3, 1]])
    tilt = np.array([[0, np.sin(a), np.cos(a)] for a in np.radians([10, -10])])
    mesh = Mesh(vertices, faces, np.repeat(tilt[:, None], 3, axis=1))
    split = split_sharp(mesh)
    assert split.source.tolist() == [0, 1, 2, 3]
    assert_close(split.normals[:2], np.array([[0, 0, 1.0]] * 2), atol=1e-12)
    assert_close(split.normals[2:], tilt, atol=1e-12)


def test_leaves_that_meet_at_a_blunt_edge_keep_their_normals(tmp_path):
    """A roof of 10 degrees whose faces know their leaves: sharp in every format that has normals."""
    rise = np.tan(np.radians(5))
    vertices = np.array([[0, -1, 0], [1, -1, 0], [0, 0, rise], [1, 0, rise], [0, 1, 0], [1, 1, 0]])
    faces = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]], np.int32)
    slopes = np.array([[0, -rise, 1], [0, rise, 1]])
    leaf = np.array([0, 0, 1, 1], np.int16)
    roof = Mesh(vertices, faces, lambda leaf, points: 3 * slopes[leaf], leaf=leaf, leaves=("south", "north"))
    expected = (slopes / np.linalg.norm(slopes, axis=1)[:, None])[leaf]
    assert_close(roof.normals, np.repeat(expected[:, None], 3, axis=1), atol=1e-15)
    split = split_sharp(roof)
    assert len(split.vertices) == 8
    assert_close(split.normals[split.faces], roof.normals, atol=1e-15)
    back = trimesh.load_mesh(write(roof, tmp_path / "roof.glb"), process=False)
    turned = back.vertex_normals[back.faces]
    assert_close(np.stack([turned[..., 0], -turned[..., 2], turned[..., 1]], axis=-1), roof.normals, atol=1e-6)
    text = write(roof, tmp_path / "roof.obj").read_text()
    assert (text.count("\nv "), text.count("vn ")) == (5, 8)
    assert len(split_sharp(Mesh(vertices, faces, roof.normals)).vertices) == 6


def test_glb_of_parts_holds_an_object_of_each_name_and_colour(tmp_path):
    vertices, faces, leaf = tube(12)
    mesh = Mesh(vertices, faces, leaf=leaf, leaves=("bottom", "mantle", "top"))
    scene = trimesh.load_scene(write(mesh, tmp_path / "tube.glb", colour_by="part"))
    assert list(scene.geometry) == list(mesh.leaves)
    for number, (name, part) in enumerate(scene.geometry.items()):
        there = vertices[np.unique(faces[leaf == number])][:, [0, 2, 1]] * [1, 1, -1]
        assert {tuple(row) for row in part.vertices.round(5)} == {tuple(row) for row in there.round(5)}
        assert len(part.faces) == (leaf == number).sum()
        assert_close(part.visual.material.baseColorFactor[:3] / 255, linear(part_colours(mesh)[name]), atol=0.002)
    whole = scene.to_mesh()
    whole.merge_vertices(merge_norm=True, merge_tex=True)
    assert_close(whole.volume, mesh.status.volume, rtol=1e-6)


@pytest.mark.parametrize(("name", "colour"), [("a.stl", "part"), ("a.glb", "leaf"), ("a.html", "zebra")])
def test_colours_that_a_file_cannot_hold_are_refused(tmp_path, name, colour):
    with pytest.raises(RsymError) as caught:
        write(cube(), tmp_path / name, colour_by=colour)
    assert caught.value.code == "colour-by"
    assert not list(tmp_path.iterdir())
