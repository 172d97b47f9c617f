"""Corners and other singular points of bodies, against normals and angles worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp
from closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.verify.bodies.corners import Corner, corner
from rsym.verify.bodies.report import SingularPoint
from rsym.verify.local import Model


def model_of(expression):
    return Model(rsym.Shape(expression, (x, y, z)), {})


def box_around(point, width, shift=0.1):
    """A box that holds a point off its middle."""
    return tuple((float(c) - width * (0.5 + shift), float(c) + width * (0.5 - shift)) for c in point)


def corner_of(expression, point=(0, 0, 0), width=0.25) -> Corner | None:
    model = model_of(expression)
    return corner(model.over(box_around(point, width)), names=lambda node: f"node {node}")


def proved_corner(expression, point=(0, 0, 0), width=0.25) -> tuple[Corner, SingularPoint]:
    found = corner_of(expression, point, width)
    assert found is not None
    assert found.exists
    assert found.point is not None
    assert found.point.proved
    return found, found.point


def turned(vector, point):
    """A linear form with this normal that vanishes at the point."""
    return sum(sp.sympify(a) * (c - p) for a, c, p in zip(vector, (x, y, z), point, strict=True))


ROTATION = sp.Matrix([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
PLACES = [(sp.Rational(3, 7), sp.Rational(-2, 5), sp.Rational(11, 13)), (sp.sqrt(2), sp.sqrt(3) / 3, -sp.sqrt(5))]


@pytest.mark.parametrize("place", PLACES)
def test_the_corner_of_a_cube_anywhere(place):
    rows = [list(ROTATION.row(k)) for k in range(3)]
    found, point = proved_corner(rsym.conjunction(*(turned(row, place) for row in rows)), place)
    assert (point.kind, point.continuity, found.exists, len(point.names)) == ("corner", "G0", True, 3)
    assert_close(point.point, [float(c) for c in place], atol=1e-15)
    assert point.radius < 1e-14
    assert_close(point.tangent_jump, 90, atol=1e-12)
    assert found.edges == ((0, 1), (0, 2), (1, 2))
    assert (found.pinched, found.cracked) == ((), False)
    assert_close(np.array(found.normals), -np.array(rows, float), atol=1e-15)


def test_two_reentrant_edges_and_a_convex_one():
    # A quarter x, y > 0 joined to the half space z < 0: the edge x = y = 0 is convex above z = 0, the others reentrant.
    found, point = proved_corner(rsym.disjunction(rsym.conjunction(x, y), -z))
    assert (point.kind, point.tangent_jump) == ("corner", 90.0)
    assert_close(np.array(found.normals), [[-1, 0, 0], [0, -1, 0], [0, 0, 1]], atol=1e-15)
    assert found.edges == ((0, 1), (0, 2), (1, 2))


OPPOSITE = rsym.disjunction(rsym.conjunction(x, y, z), rsym.conjunction(-x, -y, -z))
TWO_OF_THREE = rsym.disjunction(rsym.conjunction(x, y), rsym.conjunction(y, z), rsym.conjunction(z, x))


@pytest.mark.parametrize(
    ("expression", "kind", "edges", "pinched"),
    [
        (rsym.exclusive_or(rsym.exclusive_or(x, y), z), "node", 0, 3),  # four octants, no two with a common face
        (OPPOSITE, "node", 3, 0),
        (rsym.conjunction(rsym.exclusive_or(x, y), z), "node", 2, 1),  # two opposite wedges cut off
        (TWO_OF_THREE, "corner", 3, 0),  # +++ and its three neighbours: a surface, for all grows along (1, 1, 1)
    ],
)
def test_octants(expression, kind, edges, pinched):
    found, point = proved_corner(expression)
    assert (point.kind, len(found.edges), len(found.pinched)) == (kind, edges, pinched)
    assert point.continuity == ("G0" if kind == "corner" else "broken")


def test_a_sheet_without_a_change_of_sign_is_a_crack():
    whole = rsym.disjunction(rsym.conjunction(x, y), rsym.conjunction(x, -y))  # x > 0 but for y = 0
    found, point = proved_corner(rsym.conjunction(whole, z))
    assert found.cracked
    assert point.kind == "node"


def test_three_planes_of_a_prism_have_no_common_point():
    # Nearly parallel to one line: they meet at z = 20 alone.
    sides = (x - z / 100 + 0.2, y - x - z / 100 + 0.2, -y - z / 100 + 0.2)
    found = corner_of(rsym.conjunction(*sides), width=1)
    assert found is not None
    assert (found.exists, found.point, found.normals) == (False, None, ())
    parallel = (x + 0.2, y - x + 0.2, 0.2 - y)
    assert corner_of(rsym.conjunction(*parallel), width=1) is None  # dependent: the octree divides on


def test_sheets_that_do_not_count_are_dropped():
    # Absorbed: x | (x & y) is x; so there are two sheets only, and no corner.
    absorbed = rsym.disjunction(x, rsym.conjunction(x, y))
    assert corner_of(rsym.conjunction(absorbed, z)) is None
    # A fourth sheet far away, a positive factor and normalisation are dropped too.
    body = rsym.conjunction(x * (2 + sp.exp(y)), y / (3 + z), z**3, 5 - x)
    _, point = proved_corner(body)
    assert point.tangent_jump == 90


def test_pieces_of_absolute_values_are_sheets():
    # The ridge of the roof z = 1 - |x| ends in the wall y = 0: normals (1, 0, 1), (-1, 0, 1) and (0, -1, 0).
    found, point = proved_corner(rsym.conjunction(1 - abs(x) - z, y), (0, 0, 1))
    assert_close(point.point, (0, 0, 1), atol=1e-15)
    assert_close(point.tangent_jump, 90, atol=1e-12)
    assert found.edges == ((0, 1), (0, 2), (1, 2))
    assert len(set(found.origins)) == 2  # the roof is one definition


def test_curved_sheets_meet_at_the_angles_of_their_normals():
    # A sphere about 0 through (1, 2, 2)/3*s with the planes x = 1 and y = 2: normals (1, 2, 2)/3, -e1, -e2.
    _, point = proved_corner(rsym.conjunction(9 - x**2 - y**2 - z**2, x - 1, y - 2), (1, 2, 2))
    assert_close(point.point, (1, 2, 2), atol=1e-15)
    assert_close(point.tangent_jump, math.degrees(math.acos(-2 / 3)), atol=1e-12)
    assert point.tangent_jump_error < 1e-12


def test_a_corner_outside_the_box_is_known_but_not_its_own():
    model = model_of(rsym.conjunction(x, y, z))
    found = corner(model.over(((0.01, 0.11), (-0.05, 0.05), (-0.05, 0.05))))
    assert found is not None
    assert (found.exists, found.point) == (True, None)
