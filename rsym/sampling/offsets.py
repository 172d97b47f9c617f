"""How far a body that was grown or shrunk is from the one that it was made of, measured on the boundaries of both."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.errors import RsymError, RsymWarning, warn
from rsym.logic.faces import shape_faces
from rsym.model.shape import Shape
from rsym.sampling.distances import nearest_on_lines, nearest_on_mesh
from rsym.sampling.extent import extent
from rsym.sampling.labels import Labeller
from rsym.sampling.level_lines import dense_outline
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh

RESOLUTION = {2: 256, 3: 40}
SHARE = 0.01  # of the distance asked for: what is less off than this is not told
ON_FACE = 1e-7  # of the size: values of omega on a face
STEPS, HALVED = 12, 0.25  # towards the foot of a perpendicular, and by how much steps shrink that lead away from it


def tell_of_range(body: Shape, moved: Shape, distance: float, what: str, why: str) -> None:
    """Warn of the least and the largest distance of the boundary of `moved` from that of the body, if they differ.

    Where the two have no bounds, which cannot be measured, the warning says why alone.
    """
    if distance == 0:
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RsymWarning)
            found = _range(body, moved, abs(distance))
    except RsymError as error:
        if error.code != "empty":
            warn(f"the {what} may differ from {abs(distance):g}, and it could not be measured: {why}")
        return
    if found is not None:
        low, high = found
        warn(f"the {what} is {low:.4g} to {high:.4g} instead of {abs(distance):g}: {why}")


def tell_of_bulge(blended: Shape, sharp: Shape, operands: Sequence[Shape]) -> None:
    """Warn of the largest distance of a blend from faces that its operands share, which it was not to move."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RsymWarning)
            faces, others = (_boundary(one) for one in (sharp, blended))
    except RsymError:
        warn("the operands share a face: both are small along all of it, and the fillet may move it")
        return
    points = _points(faces)
    size = float(np.ptp(points, axis=0).max())
    on_both = np.all([np.abs(compile(one)(*points.T)["value"]) < ON_FACE * size for one in operands], axis=0)
    if not on_both.any():
        return
    points = points[on_both]
    found = _distance(points, blended, others, ON_FACE * size)
    largest = int(np.argmax(found))
    if found[largest] > ON_FACE * size:
        place = ", ".join(f"{coordinate:.4g}" for coordinate in points[largest])
        warn(
            f"the fillet moves a face that its operands share, by {found[largest]:.3g} at ({place}): both are small "
            "along all of it; round faces that meet, and cut with the rest of the body afterwards"
        )


def _boundary(shape: Shape) -> list[Floats] | Mesh:
    box = extent(shape)
    if shape.dimension == 2:
        return list(dense_outline(shape, RESOLUTION[2], box))
    return mesh(shape, RESOLUTION[3], bounds=box)


def _points(boundary: list[Floats] | Mesh) -> Floats:
    return np.concatenate(boundary) if isinstance(boundary, list) else boundary.vertices


def _distance(points: Floats, shape: Shape, boundary: list[Floats] | Mesh, asked: float) -> Floats:
    """The distance of points from the boundary of a shape, from its chords moved onto leaves, to rounding.

    The foot of a perpendicular stays where a point is moved into the tangent plane and onto the leaf again. For points
    farther away than what was asked for, which chords of a wall too thin for them tell, it is looked for on each leaf.
    """
    if isinstance(boundary, list):
        chords = nearest_on_lines(points, boundary)
    else:
        chords = nearest_on_mesh(points, boundary)
    label = Labeller(shape)
    feet, normals, there = label.onto(chords)
    feet[~there] = chords[~there]
    least, share = np.linalg.norm(points - feet, axis=1), np.ones(len(points))
    (going,) = np.nonzero(there)
    for _ in range(STEPS):
        if not len(going):
            break
        away, normal = points[going] - feet[going], normals[going]
        along = away - np.einsum("ij,ij->i", away, normal)[:, None] * normal
        moved, turned, there = label.onto(feet[going] + share[going, None] * along)
        found = np.linalg.norm(points[going] - moved, axis=1)
        nearer = there & (found < least[going])
        better = going[nearer]
        feet[better], normals[better], least[better] = moved[nearer], turned[nearer], found[nearer]
        share[going[~nearer]] *= HALVED
        going = going[np.linalg.norm(along, axis=1) * share[going] > ON_FACE * least[going]]
    (far,) = np.nonzero(least > asked)
    for number in range(len(shape_faces(shape).form.leaves) if len(far) else 0):
        leaf = np.full(len(far), number)
        found, _, there = label.onto(label.onto(points[far], leaf)[0], leaf)
        least[far[there]] = np.minimum(least[far[there]], np.linalg.norm(points[far[there]] - found[there], axis=1))
    return np.asarray(least)


def _range(body: Shape, moved: Shape, distance: float) -> tuple[float, float] | None:
    """The least and the largest distance, None where they are the one asked for."""
    faces, walls = _boundary(body), _boundary(moved)
    slack = SHARE * distance
    found = _distance(_points(walls), body, faces, distance + slack)
    low, high = float(found.min()), float(found.max())
    return (low, high) if low < distance - slack or high > distance + slack else None
