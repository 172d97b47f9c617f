"""The combinatorial surface of sign bits: closed, manifold, the same in pieces as whole."""

import dataclasses
import itertools
from concurrent.futures import ThreadPoolExecutor

import manifold3d
import numpy as np
import pytest
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import rsym.sampling.sharp.topology
from rsym.sampling.sharp.faces import connect
from rsym.sampling.sharp.pieces import crossing_names, crossing_places, vertex_names, vertex_places
from rsym.sampling.sharp.signs import list_edges
from rsym.sampling.sharp.topology import face_edges, patch_table, topology


def blocks_of(volume, start=(0, 0, 0)):
    """Corners and bits of the blocks of a volume of 8n + 1 points in each direction."""
    windows = np.lib.stride_tricks.sliding_window_view(volume, (9, 9, 9))[::8, ::8, ::8]
    signs = windows.reshape(-1, 729)
    kept = signs.any(axis=1) & ~signs.all(axis=1)
    corner = 8 * np.indices(windows.shape[:3]).reshape(3, -1)[:, kept] + np.array(start)[:, None]
    bits = np.zeros((kept.sum(), 96), np.uint8)
    bits[:, :92] = np.packbits(signs[kept], axis=1, bitorder="little")
    return np.ascontiguousarray(corner), bits


def apart(bodies, counts):
    """Bodies (n, a, b, c) side by side in one volume with a layer of outside around each."""
    n, *size = bodies.shape
    grid = np.zeros((int(np.prod(counts)), *(s + 1 for s in size)), bool)
    grid[:n, 1:, 1:, 1:] = bodies
    laid = grid.reshape(*counts, *grid.shape[1:]).transpose(0, 3, 1, 4, 2, 5)
    volume = laid.reshape([counts[axis] * grid.shape[1 + axis] for axis in range(3)])
    return np.pad(volume, [(0, 8 + 1 - m % 8) for m in volume.shape])


def random_volume(seed, bodies=300, points=8, counts=(7, 7, 7)):
    generator = np.random.default_rng(seed)
    density = generator.uniform(0, 1, (bodies, 1, 1, 1))
    return apart(generator.uniform(size=(bodies, points, points, points)) < density, counts)


def crossing_points(surface):
    """Middles of the crossed lattice edges."""
    x, y, z = np.empty((3, surface.crossings), np.int64)
    for axis in range(3):
        list_edges(surface.corner, surface.edges[axis], surface.edges_before[axis], 0, surface.corner.shape[1], x, y, z)
    points = np.array([x, y, z], float)
    for axis in range(3):
        points[axis, slice(*surface.axes[axis : axis + 2])] += 0.5
    return points


def mass_points(surface):
    ring, start = surface.ring, surface.ring_start[:-1]
    return np.add.reduceat(crossing_points(surface)[:, ring], start, axis=1) / np.diff(surface.ring_start)


def cell_centres(surface):
    place = vertex_places(surface)
    return surface.corner[:, place >> 9] + np.array([place >> 6 & 7, place >> 3 & 7, place & 7]) + 0.5


def triangles(surface, points=None):
    faces, sharp = np.empty((2 * surface.crossings, 3), np.int32), np.empty(surface.crossings, np.uint8)
    points = mass_points(surface) if points is None else points
    feature = np.zeros(surface.vertices, np.uint8)
    connect(0, surface.crossings, surface.quads, points, np.zeros((3, surface.crossings)), feature, faces, sharp)
    return points.T, faces


def is_manifold(faces):
    """Every directed edge once and its reverse once; the triangles around each vertex hang together."""
    n, count = int(faces.max()) + 1, len(faces)
    tail, head = faces.T.ravel().astype(np.int64), np.roll(faces, -1, axis=1).T.ravel().astype(np.int64)
    keys, back = tail * n + head, head * n + tail
    order = np.argsort(keys)
    found = order[np.searchsorted(keys, back, sorter=order).clip(max=len(keys) - 1)]
    if (np.diff(keys[order]) == 0).any() or (keys[found] != back).any():
        return False
    # Corner q*count + f of a triangle is at the tail of its edge q; the edge back ends there, so the next corner does.
    partner = (found + count) % (3 * count)
    graph = coo_array((np.ones(3 * count, np.int8), (np.arange(3 * count), partner)), shape=(3 * count,) * 2)
    return connected_components(graph)[0] == len(np.unique(faces))


def judge(volume):
    surface = topology(*blocks_of(volume))
    points, faces = triangles(surface)
    assert is_manifold(faces)
    assert len(np.unique(faces)) == surface.vertices
    # With vertices in the middle of their cells, the triangles bound the voxels around the points inside.
    v = cell_centres(surface).T[faces]
    assert np.rint(np.linalg.det(v * 2).sum()) == 6 * 8 * volume.sum()
    return surface, points, faces


def bits_of(number, *shape):
    return (np.arange(2**number)[:, None] >> np.arange(number) & 1).astype(bool).reshape(-1, *shape)


def test_every_mask_alone():
    surface, points, faces = judge(apart(bits_of(8, 2, 2, 2), (8, 8, 4)))
    assert trimesh.Trimesh(points, faces, process=False).is_volume
    assert surface.flips == 0


@pytest.mark.random
@pytest.mark.parametrize("shift", [0, 1])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_every_mask_beside_every_mask(axis, shift):
    """In all three directions, and at both parities of the lower cell."""
    shape = [2, 2, 2]
    shape[axis] = 3
    volume = apart(bits_of(12, *shape), (16, 16, 16))
    judge(np.pad(volume, [(shift, 8 - shift)] * 3))


@pytest.mark.slow
def test_random_volumes():
    volume = random_volume(5)
    surface, points, faces = judge(volume)
    assert surface.flips > 1000
    mesh = trimesh.Trimesh(points, faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    solid = manifold3d.Manifold(manifold3d.Mesh(points.astype(np.float32), faces.astype(np.uint32)))
    assert solid.status() == manifold3d.Error.NoError


def test_without_separation_random_volumes_are_not_manifold(monkeypatch):
    """Red proof."""
    monkeypatch.setattr(rsym.sampling.sharp.topology, "separate", lambda *_: 0)
    assert not is_manifold(triangles(topology(*blocks_of(random_volume(5, 8, 8, (2, 2, 2)))))[1])


def test_no_blocks_no_surface():
    surface = topology(np.empty((3, 0), np.int64), np.empty((0, 96), np.uint8))
    assert (surface.vertices, surface.crossings, surface.axes) == (0, 0, [0, 0, 0, 0])


def test_threads_change_nothing():
    corner, bits = blocks_of(random_volume(6))
    with ThreadPoolExecutor(3) as pool:
        one, many = topology(corner, bits), topology(corner, bits, pool)
    for field in dataclasses.fields(one):
        np.testing.assert_array_equal(getattr(one, field.name), getattr(many, field.name))


def test_patches_meet_at_most_one_face_of_a_cell_twice():
    """What lets `separate` look at two cells alone."""
    around = patch_table().patch[::2][:, face_edges()].astype(int)
    double = (around.max(axis=2) == around.min(axis=2)) & (around.max(axis=2) < 4)
    assert double.sum() == 36
    assert double.sum(axis=1).max() == 1
    np.testing.assert_array_equal(np.argwhere(double)[:, 1], patch_table().twice[double.any(axis=1)])


def test_the_order_of_blocks_changes_no_pairing():
    corner, bits = blocks_of(random_volume(8))
    order = np.random.default_rng(8).permutation(len(bits))
    one, other = topology(corner, bits), topology(corner[:, order], bits[order])
    extent = tuple(corner.max(axis=1) // 8 + 1)
    names, others = vertex_names(one, extent), vertex_names(other, extent)
    cases, other_cases = (np.repeat(surface.case, np.diff(surface.start)) for surface in (one, other))
    np.testing.assert_array_equal(names, np.sort(others))
    np.testing.assert_array_equal(cases, other_cases[np.argsort(others)])


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("outward", [1.0, -1.0])
def test_the_diagonal_that_does_not_fold(turn, outward):
    """A quad with a corner that points inwards has one diagonal inside."""
    points = np.array([[0.0, 3.0, 0.5, 0.0], [0.0, 0.0, 0.5, 3.0], [0.0, 0.0, 0.0, 0.0]])
    quad = np.roll([0, 1, 2, 3] if outward > 0 else [3, 2, 1, 0], turn).astype(np.int32)
    faces, sharp = np.empty((2, 3), np.int32), np.empty(1, np.uint8)
    feature = np.array([0, 0, turn & 1, 0], np.uint8)
    connect(0, 1, quad[None], points, np.array([[0.0], [0.0], [-outward]]), feature, faces, sharp)
    corners = points.T[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] * outward > 0).all()
    assert abs(normals[:, 2]).sum() == 3.0
    assert sharp[0] == turn & 1


def test_pieces_with_a_halo_of_one_block_weld_to_the_whole():
    extent, cuts = (8, 8, 8), ((0, 3, 8), (0, 5, 8), (0, 2, 4, 8))
    volume = random_volume(7, 64, 15, (4, 4, 4))[:65, :65, :65]
    volume[[0, -1]] = volume[:, [0, -1]] = volume[:, :, [0, -1]] = False
    whole = topology(*blocks_of(volume))
    points, faces = triangles(whole)
    vertices, crossings = vertex_names(whole, extent), crossing_names(whole, extent)
    assert (np.diff(vertices) > 0).all()
    assert (np.diff(crossings) > 0).all()
    welded, placed = np.full_like(faces, -1), np.full_like(points, np.nan)
    for ends in itertools.product(*(itertools.pairwise(c) for c in cuts)):
        low, high = np.transpose(ends)
        begin, end = np.maximum(low - 1, 0), np.minimum(high + 1, 8)
        box = tuple(slice(8 * p, 8 * q + 1) for p, q in zip(begin, end, strict=True))
        piece = topology(*blocks_of(volume[box], 8 * begin))
        positions, local = triangles(piece)
        owned = ((piece.corner >= 8 * low[:, None]) & (piece.corner < 8 * high[:, None])).all(axis=0)
        mine, own = owned[vertex_places(piece) >> 9], owned[crossing_places(piece) >> 9]
        number = np.searchsorted(vertices, vertex_names(piece, extent))
        placed[number[mine]] = positions[mine]
        at = np.searchsorted(crossings, crossing_names(piece, extent)[own])
        welded[2 * at], welded[2 * at + 1] = number[local[::2][own]], number[local[1::2][own]]
    np.testing.assert_array_equal(placed, points)
    np.testing.assert_array_equal(welded, faces)
