"""Reports on bodies made by hand, so that what shows a verdict is tested without what finds one."""

import itertools
import math

import numpy as np

import rsym
from rsym import x, y, z
from rsym.verify.answers.body_report import BodyCover, BodyReport
from rsym.verify.answers.singular import SingularCurve, SingularPoint

NONE = np.empty((0, 3, 2))
BOUNDS = ((-2.0, 2.0),) * 3
NOWHERE = (-math.inf, math.inf)
UNKNOWN = (math.nan, math.nan)

HALVES = (1.0, 0.8, 0.6)  # of the box
SIDES = {(0, 1): "right", (0, -1): "left", (1, 1): "back", (1, -1): "front", (2, 1): "top", (2, -1): "bottom"}
BOX = rsym.Shape(
    rsym.conjunction(*(half - sign * axis for half, axis in zip(HALVES, (x, y, z), strict=True) for sign in (1, -1))),
    (x, y, z),
    bounds=BOUNDS,
)
BALL = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=BOUNDS)
RADIUS, LONG = 0.5, 1.0  # of the capsule: its radius, half its straight part
CAPSULE = rsym.capsule((0, 0, -LONG), (0, 0, LONG), RADIUS).replace(bounds=BOUNDS)
# A quarter of a block is cut out: its inner edge, along y, is concave.
NOTCHED = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, 1 - z**2, rsym.disjunction(-x, -z)), (x, y, z), bounds=BOUNDS)


def cover(certified=NONE, joined=NONE, undecided=NONE, examined=1000):
    return BodyCover(BOUNDS, certified, joined, undecided, examined)


def cubes(points, size):
    """Boxes with this side about points (n, 3)."""
    points = np.asarray(points, float)
    return np.stack([points - size / 2, points + size / 2], axis=2)


def edge(points, first, second, names, **changes):
    """An edge between two planes with these outward normals, known exactly; the first lies on its left."""
    points = np.asarray(points, float)
    normals = np.broadcast_to(np.array([first, second], float), (len(points), 2, 3))
    turn = math.degrees(math.acos(np.dot(first, second)))
    facts = dict(tangent_jump=turn, tangent_jump_error=0.0, traced=True, proved=True) | changes
    turns, jumps = np.full(len(points), turn), np.full(len(points), np.nan)
    return SingularCurve(points, 0.0, "edge", "G0", names, normals, turns, jumps, **facts)


def box_edges(count=2):
    """The twelve edges of the box, each by so many points."""
    for along in range(3):
        for signs in itertools.product((1, -1), repeat=2):
            u, v = (along + 1) % 3, (along + 2) % 3
            ends = np.zeros((count, 3))
            ends[:, u], ends[:, v] = signs[0] * HALVES[u], signs[1] * HALVES[v]
            ends[:, along] = signs[0] * signs[1] * np.linspace(-1, 1, count) * HALVES[along]
            names = SIDES[u, signs[0]], SIDES[v, signs[1]]
            yield edge(ends, signs[0] * np.eye(3)[u], signs[1] * np.eye(3)[v], names)


def box():
    """Twelve edges of 90 degrees, eight corners."""
    corners = tuple(
        SingularPoint(
            tuple(sign * half for sign, half in zip(signs, HALVES, strict=True)),
            0.0,
            "corner",
            "G0",
            tuple(SIDES[axis, sign] for axis, sign in enumerate(signs)),
            90.0,
            0.0,
            proved=True,
        )
        for signs in itertools.product((1, -1), repeat=3)
    )
    statements = (("every edge was followed from corner to corner", True), ("no other curve was found", False))
    boxes = cover(joined=cubes([corner.point for corner in corners], 0.1))
    return BodyReport("REFUTED", "G0", tuple(box_edges()), corners, (0.0, 0.0), (0.0, 0.0), boxes, {}, statements)


def circle(radius, height, count=65):
    angle = np.linspace(0, 2 * math.pi, count)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height)], axis=1)
    points[-1] = points[0]
    return points


def capsule():
    """Two circles along which the normal curvature jumps by the reciprocal radius."""
    rims = []
    for height in (-LONG, LONG):
        points = circle(RADIUS, height)
        normals = np.repeat((points * [1, 1, 0] / RADIUS)[:, None], 2, axis=1)
        turns, jumps = np.zeros(len(points)), np.full(len(points), 1 / RADIUS)
        facts = dict(tangent_jump=0.0, curvature_jump=1 / RADIUS, curvature_jump_error=1e-12, traced=True, proved=True)
        names = "tube", "cap"
        rims.append(SingularCurve(points, 1e-12, "curvature jump", "G1", names, normals, turns, jumps, **facts))
    boxes = cover(cubes(circle(RADIUS, 0.0), 0.1), cubes(circle(RADIUS, LONG), 0.1))
    return BodyReport("REFUTED", "G1", tuple(rims), (), (0.0, 2.0625), (0.0, 2.0), boxes, {"r": (0.5, 0.5)})


def notched():
    """Convex and concave edges of one block: a few of them suffice."""
    inner = edge([[0, 1, 0], [0, -1, 0]], [0, 0, 1], [1, 0, 0], ("floor", "wall"))
    step = edge([[0, -1, 1], [0, 1, 1]], [0, 0, 1], [1, 0, 0], ("top", "wall"))
    edges = step, inner
    return BodyReport("REFUTED", "G0", edges, (), (0.0, 0.0), UNKNOWN, cover(), {})


def ball(letters=None):
    boxes = cover(cubes(circle(1.0, 0.0), 0.1), examined=3097)
    return BodyReport("CERTIFIED", "analytic", (), (), (0.9375, 1.0625), (1.0, 1.0), boxes, letters or {})


def double_cone():
    tip = SingularPoint((0.0, 0.0, 0.0), 0.0, "node", "broken", ("upper", "lower"), proved=True)
    return BodyReport("DEGENERATE", "broken", (), (tip,), NOWHERE, UNKNOWN, cover(), {})


def undecided():
    left = cubes(circle(1.0, 0.0, 5)[:2], 0.5)
    statements = (("where nothing is proved omega changes its sign", False),)
    boxes = cover(cubes(circle(1.0, 0.5, 99), 1.0), NONE, left)
    return BodyReport("UNDECIDED", "unknown", (), (), (-0.125, 1.5), UNKNOWN, boxes, {"a": (1.0, 2.0)}, statements)


EVERY = (box, capsule, notched, ball, double_cone, undecided)
