"""Meshes handed to other packages, and the files that one of them writes."""

import sys
import xml.etree.ElementTree
from types import SimpleNamespace

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.sampling.mesh import Mesh

BORED = rsym.sphere(1).named("ball") - rsym.cylinder(0.4).named("the bore")
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
BARE = Mesh(CORNERS, FACES)


@pytest.fixture(scope="module")
def bead():
    return rsym.mesh(BORED, 16, bounds=((-1.2, 1.2),) * 3)


def bore_of(mesh):
    return np.array(mesh.leaves)[mesh.leaf] == "the bore"


def test_trimesh_has_vertices_faces_and_parts(bead):
    body = rsym.to_trimesh(bead)
    assert np.array_equal(body.vertices, bead.vertices)
    assert np.array_equal(body.faces, bead.faces)
    assert body.is_watertight
    assert_close(body.volume, bead.volume, rtol=1e-12)
    names = np.array(body.metadata["parts"])[body.face_attributes["part"]]
    assert np.array_equal(names == "the bore", bore_of(bead))
    body.vertices[0] += 1
    assert_close(np.linalg.norm(bead.vertices, axis=1).max(), 1.0, rtol=1e-9)
    assert "part" not in rsym.to_trimesh(BARE).face_attributes


def test_pyvista_has_vertices_faces_and_parts(bead):
    pytest.importorskip("pyvista")
    surface = rsym.to_pyvista(bead)
    assert surface.is_manifold
    assert_close(surface.volume, bead.volume, rtol=1e-9)
    assert np.array_equal(np.array(surface.field_data["parts"])[surface.cell_data["part"]] == "the bore", bore_of(bead))
    assert rsym.to_pyvista(BARE).n_cells == 4


def test_pyvista_is_given_what_it_takes(bead, monkeypatch):
    """A stand-in with its constructor: a row of counts and vertices for each face, one after the other."""

    def poly_data(points, faces):
        return SimpleNamespace(points=points, faces=faces, cell_data={}, field_data={})

    monkeypatch.setitem(sys.modules, "pyvista", SimpleNamespace(PolyData=poly_data))
    surface = rsym.to_pyvista(bead)
    assert np.array_equal(surface.faces.reshape(-1, 4)[:, 1:], bead.faces)
    assert (surface.faces[::4] == 3).all()
    assert surface.field_data["parts"].tolist() == ["ball", "the bore"]
    assert np.array_equal(surface.cell_data["part"] == 1, bore_of(bead))


def test_meshio_has_points_cells_and_parts(bead):
    meshio = pytest.importorskip("meshio")
    given = rsym.to_meshio(bead)
    assert isinstance(given, meshio.Mesh)
    assert np.array_equal(given.points, bead.vertices)
    assert np.array_equal(given.cells_dict["triangle"], bead.faces)
    assert np.array_equal(given.cell_data["part"][0] == 1, bore_of(bead))
    assert {name: value.tolist() for name, value in given.field_data.items()} == {"ball": [1, 2], "the bore": [2, 2]}
    assert not rsym.to_meshio(BARE).cell_data


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_files_by_meshio_come_back_to_the_last_bit(tmp_path, bead, suffix):
    meshio = pytest.importorskip("meshio")
    path = rsym.write(bead, tmp_path / f"bead{suffix}", scale=3)
    back = meshio.read(path)
    assert np.array_equal(back.points, bead.vertices * 3)
    assert np.array_equal(back.cells_dict["triangle"], bead.faces)
    part = back.cell_data["part"][0] if suffix == ".vtu" else back.cell_data["gmsh:physical"][0] - 1
    assert np.array_equal(part == 1, bore_of(bead))
    assert rsym.write(bead, tmp_path / f"again{suffix}", scale=3).read_bytes() == path.read_bytes()
    if suffix == ".msh":
        assert path.read_text().startswith("$MeshFormat\n2.2 0 8")
        assert '2 2 "the bore"' in path.read_text()
    else:
        assert xml.etree.ElementTree.parse(path).getroot().get("type") == "UnstructuredGrid"
    assert len(meshio.read(rsym.write(BARE, tmp_path / f"bare{suffix}")).cells_dict["triangle"]) == 4


@pytest.mark.parametrize("suffix", [".vtu", ".msh"])
def test_without_meshio_the_remedy_is_told_and_no_file_stays(tmp_path, monkeypatch, suffix):
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(RsymError, match="pip install meshio"):
        rsym.write(BARE, tmp_path / f"x{suffix}")
    assert not list(tmp_path.iterdir())


def test_an_unknown_suffix_names_all_formats(tmp_path):
    with pytest.raises(RsymError, match=r"\.stl.*\.vtu, \.msh"):
        rsym.write(BARE, tmp_path / "x.doc")


@pytest.mark.parametrize("name", ["trimesh", "pyvista", "meshio"])
def test_a_missing_package_and_a_wrong_kind(name, monkeypatch):
    function = getattr(rsym, f"to_{name}")
    with pytest.raises(RsymError, match="expected a Mesh, got Shape"):
        function(BORED)
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(RsymError, match=f"pip install {name}"):
        function(BARE)


@pytest.mark.parametrize("other", [rsym.box(2, 2, 1).translate(3, 0, 0), rsym.box(2, 2, 3).translate(0, 0, 4)])
def test_bodies_with_planes_in_common_keep_their_names_in_files(tmp_path, other):
    mesh = rsym.mesh(rsym.box(2, 2, 1).named("A") | other.named("B"), 16)
    areas = [16, pytest.approx(rsym.mesh(other, 16).area, rel=1e-9)]
    rsym.write(mesh, tmp_path / "pair.glb", colour_by="part")
    objects = pytest.importorskip("trimesh").load(tmp_path / "pair.glb").geometry
    assert [objects[name].area for name in "AB"] == areas
    pytest.importorskip("meshio")
    given = rsym.to_meshio(mesh)
    corners = given.points[given.cells_dict["triangle"]]
    across = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    numbers = {name: int(number) - 1 for name, (number, _) in given.field_data.items()}
    assert [across[given.cell_data["part"][0] == numbers[name]].sum() for name in "AB"] == areas
