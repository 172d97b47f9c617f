"""A piece a thousand times smaller or larger is the same piece: no sign depends on the unit of length."""

import numpy as np
import pytest
import sympy as sp

import rsym

POINTS = np.random.default_rng(1).uniform(-3, 3, (3, 2000))
KITE = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
PIECES = {
    "disc": lambda s: rsym.disc(2 * s, (s, 0)),
    "ellipse": lambda s: rsym.ellipse(2 * s, s),
    "superellipse": lambda s: rsym.superellipse(2 * s, s, 4),
    "rectangle": lambda s: rsym.rectangle(2 * s, s),
    "strip": lambda s: rsym.strip(-s, 2 * s, (1, 2)),
    "polygon": lambda s: rsym.polygon([(a * s, b * s) for a, b in KITE]),
    "regular_polygon": lambda s: rsym.regular_polygon(5, 2 * s),
    "cyclic": lambda s: rsym.cyclic(rsym.disc(s / 2), 7, radius=2 * s),
    "row": lambda s: rsym.row(rsym.disc(s / 3), s, count=4),
    "kaleidoscope": lambda s: rsym.kaleidoscope(rsym.disc(s / 2, (2 * s, s / 2)), 6),
    "fillet": lambda s: rsym.fillet(rsym.half_plane(), rsym.half_plane((0, 1)), s / 2, "G2"),
    "ellipsoid": lambda s: rsym.ellipsoid(3 * s, 2 * s, s),
    "box": lambda s: rsym.box(s, 2 * s, 3 * s),
    "cylinder": lambda s: rsym.cylinder(s, 2 * s),
    "cone": lambda s: rsym.cone(s, 2 * s),
    "frustum": lambda s: rsym.frustum(2 * s, s, s),
    "capsule": lambda s: rsym.capsule((0, 0, -s), (s, 0, s), s),
    "torus": lambda s: rsym.torus(2 * s, s / 2),
    "helicoid": lambda s: rsym.helicoid(3 * s, s / 5),
    "helix_tube": lambda s: rsym.helix_tube(2 * s, s / 2, 2 * s),
    "coil": lambda s: rsym.coil(2 * s, s / 2, 2 * s, turns=3),
    "gyroid": lambda s: rsym.gyroid(3 * s),
    "lidinoid": lambda s: rsym.lidinoid(3 * s),
    "screw": lambda s: rsym.screw(rsym.rectangle(2 * s, s), 4 * s),
}


@pytest.mark.random
@pytest.mark.parametrize("name", PIECES)
def test_no_sign_depends_on_the_unit_of_length(name):
    signs = []
    for scale in (sp.Integer(1), sp.Rational(1, 1000), sp.Integer(1000)):
        shape = PIECES[name](scale)
        places = POINTS[: shape.dimension] * float(scale)
        signs.append(np.sign(rsym.compile(shape, backend="numpy")(*places)["value"]))
    assert (signs[0] == signs[1]).all()
    assert (signs[0] == signs[2]).all()
    assert {-1, 1} <= set(signs[0])
