import pickle

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.sampling.lattice import sides_of
from rsym.sampling.mesh import Mesh
from rsym.sampling.status import Findings, OffSurface, Suspect

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def status(corners, faces, **findings):
    return Mesh(corners, faces, found=Findings(**findings)).status


def test_a_tetrahedron():
    found = status(CORNERS, FACES)
    assert found.closed
    assert (found.components, found.euler_characteristic, found.genera) == (1, 2, (0,))
    assert_close(found.volume, 1 / 6, rtol=1e-14)
    assert_close(found.area, 1.5 + np.sqrt(3) / 2, rtol=1e-14)
    assert_close(found.worst_angle, 45.0, rtol=1e-14)
    assert_close(status(CORNERS + 1e6, FACES[:, ::-1]).volume, -1 / 6, rtol=1e-8)


def test_a_missing_triangle_is_open_or_clipped():
    assert "open" in str(status(CORNERS, FACES[1:]))
    found = status(CORNERS, FACES[1:], sides=sides_of("xyz", [(-1, 2), (-1, 2), (0, 2)]), clipped_at=("the floor",))
    assert "clipped" in str(found)
    (loop,) = found.loops
    # The triangle (0, 2, 1) is gone; what remains runs the other way round.
    assert loop.vertices in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    assert loop.sides == ("the lower end of z",)
    (loop,) = status(CORNERS, FACES[1:], sides=sides_of("xyz", [(0, 2), (-1, 2), (-1, 2)])).loops
    assert loop.sides == ()


def test_a_turned_triangle_is_seen():
    turned = FACES.copy()
    turned[0] = turned[0, ::-1]
    found = status(CORNERS, turned)
    assert not found.closed
    assert found.repeated_edges == 3


def test_two_pieces():
    found = status(np.vstack([CORNERS, CORNERS + 5]), np.vstack([FACES, FACES + 4]))
    assert (found.components, found.euler_characteristic, found.closed) == (2, 4, True)
    assert "2 pieces" in str(found)


def test_unresolved_and_zeros_are_told():
    text = str(status(CORNERS, FACES, nudged_zeros=3, kept=2))
    assert "unresolved" in text
    assert "3 samples lay exactly" in text
    assert status(CORNERS, FACES, nudged_zeros=1).remarks[0].startswith("1 sample lay")


def test_each_suspect_is_told_and_in_brief_they_are_counted():
    thin = tuple(Suspect("gap", (k, 0.0, 0.0), 1.5 - 0.5 * k, 4, (0, 1), ("arch", "wheel")) for k in range(3))
    sheet, touch = (Suspect(kind, (7.0, 0.0, 0.0), 0.0, 5, (1,)) for kind in ("sheet", "touch"))
    found = status(CORNERS, FACES, unresolved=(*thin, sheet, touch), nudged_zeros=1)
    assert (found.sheets, found.touches, found.finer) == ((sheet,), (touch,), 4)
    assert found.remarks[:5] == tuple(one.remark for one in found.unresolved)
    assert found.brief == (
        "Unresolved: 3 gaps, 1 sheet without a change of sign and 1 contact of bodies; at worst a gap between arch and"
        " wheel, 0.5 cells wide near (2, 0, 0); 4 times the resolution puts 2 cells across it.",
        found.remarks[5],
    )
    assert str(found).endswith(" ".join(found.brief))
    alone = status(CORNERS, FACES, unresolved=(sheet,))
    assert alone.brief == alone.remarks == (sheet.remark,)
    assert alone.finer is None


def test_vertices_off_the_surface_and_caps_are_told():
    found = status(
        CORNERS, FACES, clipped_at=("the floor",), capped=True, off_surface=OffSurface(2, 0.25, (0.0, 1.0, 2.0))
    )
    assert found.clipped
    assert found.closed
    assert found.remarks == (
        "The body leaves the bounds and is clipped at the floor; flat caps close it there.",
        "2 vertices are off the surface, at worst by 0.25 cells near (0.0, 1.0, 2.0).",
    )


def test_normals_come_from_an_array_a_rule_or_the_triangles():
    flat = Mesh(CORNERS, FACES).normals
    assert_close(flat[0], np.array([[0, 0, -1.0]] * 3), atol=1e-15)
    given = np.full((4, 3, 3), np.nan)
    given[1] = [0, -2, 0]
    assert_close(Mesh(CORNERS, FACES, given).normals, flat, atol=1e-15)
    leaf = np.array([2, 1, 0, 3])
    directions = -np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, -1, -1.0]])

    def rule(leaf, points):
        assert points.shape == (len(leaf), 3)
        return directions[leaf]

    mesh = Mesh(CORNERS, FACES, rule, leaf=leaf)
    assert_close(mesh.normals, flat, atol=1e-15)
    assert mesh.status.folded == 0
    wrong = Mesh(CORNERS, FACES, rule, leaf=np.array([2, 1, 0, 2])).status
    assert wrong.folded == 1
    assert_close(wrong.folded_share, np.sqrt(3) / (3 + np.sqrt(3)), rtol=1e-14)
    assert any("facing inwards" in remark for remark in wrong.remarks)


def test_a_mesh_is_pickled_with_its_normals():
    mesh = Mesh(
        CORNERS, FACES, lambda leaf, points: points - 0.25, Findings(kept=1), np.arange(4), ("a", "b", "c", "d")
    )
    back = pickle.loads(pickle.dumps(mesh))
    assert np.array_equal(back.normals, mesh.normals)
    assert back.leaves == mesh.leaves
    assert back.status == mesh.status


@pytest.mark.parametrize(
    ("corners", "faces"),
    [
        (CORNERS, FACES[:0]),
        (CORNERS, FACES + 1),
        (CORNERS, FACES - 1),
        (CORNERS[:, :2], FACES),
        (CORNERS, FACES[:, :2]),
        (CORNERS * np.nan, FACES),
    ],
)
def test_what_is_no_mesh_is_refused(corners, faces):
    with pytest.raises(RsymError):
        status(corners, faces)


def test_what_a_finer_lattice_may_settle_asks_for_it():
    def asked(*suspects):
        return status(CORNERS, FACES, unresolved=suspects).refinable

    place = (0.0, 0.0, 0.0)
    assert asked() is None
    assert asked(Suspect("knife", place, 0.0, 9, (0,)), Suspect("touch", place, 0.0, 9, (0,))) is None
    assert asked(Suspect("gap", place, 0.5, 9, (0,)), Suspect("unresolved", place, 0.0, 9, (0,))) == 4
    assert asked(Suspect("unresolved", place, 0.0, 9, (0,))) == 2
    assert asked(Suspect("unresolved", place, 0.0, 99_999, (0,))) is None


@pytest.mark.slow
def test_the_vase_has_no_remark():
    """Its twelve lobes are cosines of twelve times an angle, whose cut is none."""
    assert rsym.mesh(rsym.load("vase")).status.remarks == ()
