"""How large a body gets in a file, and what the file says of its unit."""

import re
import zipfile

import numpy as np
import pytest
import trimesh
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.cli import main
from rsym.sampling.mesh import Mesh

BRICK = rsym.box(1, 2, 4).named("brick")


@pytest.fixture(scope="module")
def brick():
    return rsym.mesh(BRICK, 12, bounds=((-1, 1), (-2, 2), (-3, 3)))


def sides(path):
    return np.ptp(trimesh.load_mesh(path).vertices, axis=0)


def unit_of(path):
    with zipfile.ZipFile(path) as archive:
        return re.search(rb'unit="(\w+)"', archive.read("3D/3dmodel.model")).group(1).decode()


@pytest.mark.parametrize(
    ("asked", "length", "unit"),
    [
        ({}, 4, "millimeter"),
        ({"scale": 25}, 100, "millimeter"),
        ({"size": 120}, 120, "millimeter"),
        ({"size": "120mm"}, 120, "millimeter"),
        ({"size": "12 cm"}, 12, "centimeter"),
        ({"size": "12cm", "unit": "mm"}, 120, "millimeter"),
        ({"size": "1in", "unit": "mm"}, 25.4, "millimeter"),
        ({"size": 12, "unit": "in"}, 12, "inch"),
        ({"size": "  1.5e-1 m "}, 0.15, "meter"),
        ({"scale": 2, "unit": "cm"}, 8, "centimeter"),
    ],
)
def test_3mf_has_the_size_and_states_the_unit(tmp_path, brick, asked, length, unit):
    path = rsym.write(brick, tmp_path / "brick.3mf", **asked)
    assert unit_of(path) == unit
    assert_close(sides(path), np.array([1, 2, 4]) * length / 4, rtol=1e-12)


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".off"])
def test_formats_without_a_unit_hold_numbers_in_the_one_given(tmp_path, brick, suffix):
    path = rsym.write(brick, tmp_path / f"brick{suffix}", size="12cm", unit="mm")
    assert_close(sides(path), [30, 60, 120], rtol=1e-6)


def test_gltf_is_in_metres(tmp_path, brick):
    assert_close(sides(rsym.write(brick, tmp_path / "a.glb"))[[0, 2, 1]], [1, 2, 4], rtol=1e-6)
    assert_close(sides(rsym.write(brick, tmp_path / "b.glb", scale=3))[[0, 2, 1]], [3, 6, 12], rtol=1e-6)
    path = rsym.write(brick, tmp_path / "c.glb", size="120mm", colour_by="part")
    scene = trimesh.load_scene(path)
    assert list(scene.geometry) == ["brick"]
    assert_close(np.ptp(scene.bounds, axis=0)[[0, 2, 1]], [0.03, 0.06, 0.12], rtol=1e-6)


def test_without_a_size_the_bytes_are_those_of_the_mesh(tmp_path, brick):
    plain = rsym.write(brick, tmp_path / "a.stl").read_bytes()
    assert rsym.write(brick, tmp_path / "b.stl", unit="mm", scale=1).read_bytes() == plain


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"unit": "furlong"}, "units mm, cm, m, in, got 'furlong'"),
        ({"unit": 3}, "units mm"),
        ({"size": 0}, "longest side"),
        ({"size": "big"}, "longest side.*'big'"),
        ({"size": "12 parsec"}, "longest side"),
        ({"size": float("nan")}, "longest side"),
        ({"size": "mm"}, "longest side"),
        ({"size": True}, "longest side"),
        ({"size": [3]}, "longest side"),
        ({"scale": -1}, "scale must be a positive number"),
        ({"scale": "2"}, "scale must be a positive number"),
        ({"size": 3, "scale": 2}, "both"),
    ],
    ids=str,
)
def test_sizes_that_are_none_are_refused_and_no_file_stays(tmp_path, brick, asked, said):
    with pytest.raises(RsymError, match=said):
        rsym.write(brick, tmp_path / "brick.stl", **asked)
    assert not list(tmp_path.iterdir())


def test_a_point_cannot_be_given_a_size(tmp_path):
    with pytest.raises(RsymError, match="one point"):
        rsym.write(Mesh(np.zeros((3, 3)), np.array([[0, 1, 2]])), tmp_path / "point.stl", size=3)


def test_layers_in_metres(tmp_path):
    stack = rsym.sections(rsym.sphere(1), [0], resolution=24, bounds=((-1.2, 1.2),) * 3)
    text = rsym.write_sections(stack, tmp_path / "a.svg", unit="m", scale=0.002).read_text()
    assert "1 unit of the model is 2 mm" in text
    lines = rsym.write_sections(stack, tmp_path / "a.dxf", unit="m").read_text().splitlines()
    assert lines[lines.index("$INSUNITS") + 2].strip() == "6"


def test_the_command_takes_size_unit_and_scale(tmp_path, capsys):
    model = tmp_path / "brick.rf"
    model.write_text('half = rfAND(0.5 - x, 0.5 + x) "side"; omega = rfAND(half, 1 - y, 1 + y, 2 - z, 2 + z)')
    path, edges = tmp_path / "brick.3mf", tmp_path / "edges.dxf"
    common = ["mesh", str(model), "-o", str(path), "--resolution", "12", "--features", str(edges)]
    assert main([*common, "--size", "120mm"]) == 0
    printed = capsys.readouterr().out
    assert "size 30 x 60 x 120 mm" in printed
    assert "volume of 216000" in printed
    assert unit_of(path) == "millimeter"
    text = edges.read_text().splitlines()
    corner = [float(text[text.index("$EXTMAX") + k]) for k in (2, 4, 6)]
    assert_close(corner, [15, 30, 60], rtol=1e-9)
    assert main([*common, "--scale", "2", "--unit", "in"]) == 0
    assert "size 2 x 4 x 8 in" in capsys.readouterr().out
    assert unit_of(path) == "inch"
    assert text[text.index("$INSUNITS") + 2].strip() == "4"
    assert main([*common, "--size", "large"]) == 1
    assert "longest side" in capsys.readouterr().err
