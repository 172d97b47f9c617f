"""Reports made by hand, so that what shows a verdict is tested without what finds one."""

import math

import numpy as np

from rsym.verify.answers.report import Cover, Joint, SmoothnessReport

NONE = np.empty((0, 2, 2))
BODY_LETTERS = {"a": (5.0, 5.0), "a1": (8.0, 8.0), "a2": (5.3, 5.3), "p1": (40.0, 40.0), "p2": (0.1, 0.1)}


def boxes_along(points, size):
    """Square boxes about points (n, 2), none twice."""
    corners = np.unique(np.floor(np.asarray(points) / size), axis=0) * size
    return np.stack([corners, corners + size], axis=2)


def ring(radius=1.0, size=0.1, across=1.0):
    angle = np.linspace(0, 2 * math.pi, 2000)
    return boxes_along(np.stack([radius * np.cos(angle), across * radius * np.sin(angle)], axis=1), size)


def refuted_corner():
    """The verdict of Fig. 11 at the printed letters; its numbers are those of the theory."""
    corner = Joint(
        (-4.992121096289474, 0.0),
        1e-15,
        "corner",
        "G0",
        tangent_jump=144.811726903428,
        tangent_jump_error=1e-12,
        curvatures=(0.0433063556, 0.0433063556),
        curvature_jump=0.0,
        curvature_jump_error=1e-12,
        proved=True,
    )
    cover = Cover(((-8.0, 9.0), (-4.0, 4.0)), NONE, boxes_along([corner.point], 1e-3), NONE, 6257)
    statements = (("two analytic arcs meet in the corner", True), ("there is no other defect", False))
    return SmoothnessReport("REFUTED", "G0", (corner,), (), 2.75, cover, BODY_LETTERS, statements)


def certified_ellipse():
    cover = Cover(((-3.0, 3.0), (-3.0, 3.0)), ring(2.0, 0.1, 0.5), NONE, NONE, 3097)
    return SmoothnessReport("CERTIFIED", "analytic", (), (), 2.000001, cover, {"a": (2.0, 2.0), "b": (0.5, 1.0)})


def degenerate_lemniscate():
    node = Joint((0.0, 0.0), 0.0, "node", "broken", branches=4, proved=True)
    cover = Cover(((-2.0, 2.0), (-1.0, 1.0)), NONE, boxes_along([(0.0, 0.0)], 1e-3), NONE, 9517)
    return SmoothnessReport("DEGENERATE", "broken", (node,), (), math.inf, cover, {})


def undecided_disc():
    strip = np.array([[[0.99, 1.01], [k / 100, (k + 1) / 100]] for k in range(-3, 3)])
    cover = Cover(((-2.0, 2.0), (-2.0, 2.0)), ring(), NONE, strip, 512)
    return SmoothnessReport("UNDECIDED", "unknown", (), (), 1.2, cover, {})


def stadium(count=4):
    """Four proved jumps of the curvature, or some number of them."""
    ends = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
    jumps = tuple(
        Joint(ends[k % 4], 1e-20, "curvature jump", "G1", 2, 0.0, 0.0, (0.0, 1.0), 1.0, 1e-24, proved=True)
        for k in range(count)
    )
    cover = Cover(((-3.0, 3.0), (-2.0, 2.0)), NONE, NONE, NONE, 1217)
    return SmoothnessReport("REFUTED", "G1", jumps, (), 1.01, cover, {})


EVERY = (refuted_corner, certified_ellipse, degenerate_lemniscate, undecided_disc, stadium)
