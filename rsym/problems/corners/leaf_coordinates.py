"""Leaf coordinates at a corner, in which both edges are straight: what they are, how they bend, how far they go."""

from __future__ import annotations

import math

import numpy as np

from rsym.arrays import Floats
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.leaf_jets import Bend, LeafJets

CIRCLE = 720  # places around a corner, at its reach, of which the nearest in leaf coordinates is the radius
MARGIN = 0.999  # of that radius, for what lies between the places
STRAIGHT, MOST_BENT = 1e-12, 20.0  # the least and most that leaves bend within a reach for what follows


def bends(corner: PlaneCorner, jets: LeafJets) -> tuple[complex, tuple[Bend, ...]]:
    """The c below, and factors of both leaves by which leaf coordinates are conformal to second order.

    None, and c is 0, where edges are straight, or too bent. In the directions t, n of the first edge u = x + Re(c z**2)
    and v = y + Im(c z**2), z = x + i*y: along each edge the second order of its leaf is given, which makes c; what is
    left of it is the leaf times something linear.
    """
    (t, s), alpha = corner.edges, corner.angle
    normals = np.array(corner.gradients)
    lengths = np.hypot(*normals.T)
    n, m = normals / lengths[:, None]
    xx, xy, yy = jets.at(np.array([corner.point]))[:, 3:, 0].T / (2 * lengths)
    bent = np.stack([xx, xy, xy, yy], axis=-1).reshape(2, 2, 2)  # of both leaves
    if not np.abs(bent).max() * corner.reach > STRAIGHT:
        return 0j, ()
    # Re z**2 and Im z**2 as forms.
    real, imaginary = np.outer(t, t) - np.outer(n, n), np.outer(t, n) + np.outer(n, t)
    down = t @ bent[0] @ t
    if corner.is_flat:  # u stands for the second leaf
        along, (s, m) = 0.0, (n, t)
        second = -down * imaginary
    else:
        along = -(s @ bent[1] @ s + down * math.cos(alpha)) / math.sin(alpha)
        u, v = along * real - down * imaginary, down * real + along * imaginary
        second = u * math.sin(alpha) - v * math.cos(alpha)
    rests = down * real + along * imaginary - bent[0], second - bent[1]
    slopes = [
        2 * (edge @ rest @ normal) * edge + (normal @ rest @ normal) * normal
        for rest, edge, normal in zip(rests, (t, s), (n, m), strict=True)
    ]
    if max(np.hypot(*slope) for slope in slopes) * corner.reach > MOST_BENT:
        return 0j, ()
    return complex(along, down), tuple(Bend(corner.point, (float(p), float(q))) for p, q in slopes)


def largest_radius(corner: PlaneCorner, jets: LeafJets) -> float:
    """The largest radius in leaf coordinates of a disc that lies within the reach."""
    around = np.linspace(0, 2 * math.pi, CIRCLE, endpoint=False)
    places = corner.point + corner.reach * np.stack([np.cos(around), np.sin(around)], axis=1)
    u, v, _ = coordinates_of(corner, jets.at(places)[:, 0])
    return MARGIN * float(np.hypot(u, v).min())


def coordinates_of(corner: PlaneCorner, leaves: Floats) -> tuple[Floats, Floats, Floats]:
    """Leaf coordinates u, v and w of anything linear in the two leaves (2, ...)."""
    first, second = (math.hypot(*slope) for slope in corner.gradients)
    if corner.is_flat:
        return leaves[1], leaves[0] / first, leaves[0] / first
    v, w = leaves[0] / first, leaves[1] / second
    return (w + v * math.cos(corner.angle)) / math.sin(corner.angle), v, w
