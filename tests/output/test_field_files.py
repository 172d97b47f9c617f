"""Fields in files of other programs: read by meshio and held against functions that are known."""

import sys

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x
from rsym.sampling.mesh import Mesh

meshio = pytest.importorskip("meshio")
RING = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
U = rsym.solve(rsym.disc(1), "-laplacian(u) = 4", 0, cells=8)  # 1 - r^2
FLAT = Mesh(np.eye(3), np.array([[0, 1, 2]]))


def read(field, folder, **options):
    path = rsym.write(field, folder / "field.vtu", **options)
    found = meshio.read(path)
    assert found.points.shape[1] == 3
    return found


def test_a_solution_in_the_plane(tmp_path):
    found = read(U, tmp_path, resolution=24)
    a, b, c = found.points.T
    assert not c.any()
    assert_close(found.point_data["u"], 1 - a * a - b * b, atol=1e-9)
    assert_close(found.point_data["gradient"], -2 * found.points, atol=1e-8)
    corners = found.points[found.cells_dict["triangle"]][..., :2]
    area = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 2
    assert_close(area, np.pi, rtol=3e-3)
    again = rsym.write(U, tmp_path / "again.vtu", resolution=24)
    assert again.read_bytes() == (tmp_path / "field.vtu").read_bytes()


def test_half_a_section_and_a_body_in_space(tmp_path):
    half = rsym.disc(1).named("wall") & rsym.half_plane((0, 1), 0)
    turned = read(rsym.solve(half, "-laplacian(u) = 6", {"wall": 0}, axis=x, cells=6), tmp_path, resolution=16)
    ball = read(rsym.solve(rsym.sphere(1), "-laplacian(u) = 6", 0, cells=4, degree=2), tmp_path, resolution=8)
    for found, kind in ((turned, "triangle"), (ball, "tetra")):
        assert set(found.cells_dict) == {kind}
        assert_close(found.point_data["u"], 1 - np.sum(found.points**2, axis=1), atol=1e-6)
        assert_close(found.point_data["gradient"], -2 * found.points, atol=1e-4)
    assert turned.points[:, 1].min() > -1e-12


def test_modes_a_shaft_and_an_elastic_ring(tmp_path):
    drum = rsym.modes(rsym.rectangle(2, 1), 2, cells=8)
    found = read(drum, tmp_path, resolution=12)
    a, b, _ = (np.pi * found.points).T
    first = np.sqrt(2) * np.cos(a / 2) * np.cos(b)  # of the mean square 1 by the mass, area 2
    assert set(found.point_data) == {"mode_1", "mode_2"}
    assert_close(found.point_data["mode_1"], first, atol=1e-4)

    found = read(rsym.torsion(rsym.disc(1), cells=8), tmp_path, resolution=12)
    a, b, _ = found.points.T
    assert_close(found.point_data["stress"], np.stack([-b, a, 0 * a], axis=1), atol=1e-8)

    # Lame's ring under the pressure 1 inside, by hand: sigma = A -+ B/r^2, A = 1/3, B = 4/3 radii 1 and 2.
    ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    quarter = ring & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("below")
    held = {"bore": rsym.pressure(1), "left": rsym.roller(), "below": rsym.roller()}
    found = read(rsym.elasticity(quarter, held, young=1, poisson=0.25, cells=10), tmp_path, resolution=16)
    radius = np.linalg.norm(found.points, axis=1)
    stress = found.point_data["stress"]
    assert stress.shape[1] == 6
    assert_close(stress[:, 0] + stress[:, 1], np.full(len(radius), 2 / 3), atol=0.02)
    assert not stress[:, [2, 4, 5]].any()
    radial, around = 1 / 3 - 4 / 3 / radius**2, 1 / 3 + 4 / 3 / radius**2
    assert_close(found.point_data["von_mises"], np.sqrt(radial**2 + around**2 - radial * around), rtol=5e-3)
    out = np.sum(found.point_data["displacement"] * found.points, axis=1) / radius
    assert_close(out, 0.75 * radius / 3 + 1.25 * 4 / 3 / radius, rtol=1e-3)


def test_what_is_infinite_at_a_corner_is_nan_there_alone():
    corner = rsym.rectangle(2, 2) - rsym.rectangle(2, 2).translate(1, 1)
    found = rsym.to_meshio(rsym.solve(corner, "-laplacian(u) = 1", 0, cells=8), resolution=24)
    unknown = np.isnan(found.point_data["gradient"]).any(axis=1)
    assert np.isfinite(found.point_data["u"]).all()
    assert_close(found.points[unknown], np.zeros((unknown.sum(), 3)), atol=1e-12)


def test_what_is_smaller_than_a_cell_is_warned_of():
    holed = rsym.rectangle(2, 2) - rsym.disc(0.24)
    u = rsym.solve(holed, "-laplacian(u) = 1", 0, cells=10)
    with pytest.warns(rsym.RsymWarning, match=r"cells have \d+% .* than the shape.*resolution="):
        rsym.to_meshio(u, resolution=4)


def test_refusals_leave_no_file(tmp_path, monkeypatch):
    for name, options, words in (
        ("u.stl", {}, "a field is written as .vtu"),
        ("u.vtu", {"unit": "mm"}, "takes resolution, got unit"),
        ("u.vtu", {"resolution": 0}, "resolution must be"),
        ("no/u.vtu", {}, "folder"),
    ):
        with pytest.raises(RsymError, match=words):
            rsym.write(U, tmp_path / name, **options)
    with pytest.raises(RsymError, match=r"rsym\.mesh"):
        rsym.write(FLAT, tmp_path / "a.stl", resolution=3)
    with pytest.raises(RsymError, match=r"rsym\.mesh"):
        rsym.to_meshio(FLAT, resolution=3)
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(RsymError, match="pip install meshio"):
        rsym.write(U, tmp_path / "u.vtu")
    assert not list(tmp_path.iterdir())


def test_pyvista_is_given_cells_and_data(monkeypatch):
    """A stand-in with its constructor: cells by kind, and points."""

    class Grid:
        def __init__(self, cells, points):
            self.cells, self.points, self.point_data = cells, points, {}

    class Kinds:
        TRIANGLE = 5

    monkeypatch.setitem(sys.modules, "pyvista", type("pyvista", (), {"UnstructuredGrid": Grid, "CellType": Kinds}))
    grid, same = rsym.to_pyvista(U, resolution=16), rsym.to_meshio(U, resolution=16)
    assert np.array_equal(grid.cells[5], same.cells_dict["triangle"])
    assert np.array_equal(grid.points, same.points)
    assert np.array_equal(grid.point_data["u"], same.point_data["u"])
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(RsymError, match="pip install pyvista"):
        rsym.to_pyvista(U)
