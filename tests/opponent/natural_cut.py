"""Bodies that are sawn, drilled, milled, turned and put together: most have an edge, and where is plain to see."""

import sympy as sp

import rsym
from rsym import R1, R0m, RAlpha, Rho, Rp, Sardf, x, y, z

Q = sp.Rational
DISC = (x, y)


def shape(expression, size):
    """A body within a cube."""
    return rsym.Shape(expression, (x, y, z), bounds=((-size, size),) * 3)


def pole(radius, where, axis=z):
    """An endless round bar."""
    across = [c for c in (x, y, z) if c != axis]
    return rsym.Shape(radius**2 - sum((c - c0) ** 2 for c, c0 in zip(across, where, strict=True)), (x, y, z))


def prism(points, depth):
    """The prism over a polygon."""
    return rsym.extrude(rsym.polygon(points), 0, depth)


def halves(*planes):
    """Intersection of the half-spaces a x + b y + c z <= d."""
    return rsym.conjunction(*(d - a * x - b * y - c * z for a, b, c, d in planes))


def plate_with_holes():
    plate = rsym.box(6, 4, Q(1, 2))
    for a, b in ((2, 1), (-2, 1), (2, -1), (-2, -1)):
        plate -= pole(Q(1, 2), (a, b))
    return plate


def hex_nut():
    return rsym.extrude(rsym.regular_polygon(6, 2), 0, 1) - pole(1, (0, 0))


def pyramid():
    return shape(halves((2, 0, 1, 2), (-2, 0, 1, 2), (0, 2, 1, 2), (0, -2, 1, 2), (0, 0, -1, 0)), 3)


def dodecahedron():
    g = (1 + sp.sqrt(5)) / 2
    turns = [(0, 1, g), (1, g, 0), (g, 0, 1)]
    signs = [(a, b) for a in (1, -1) for b in (1, -1)]
    normals = []
    for normal in turns:
        places = [k for k in range(3) if normal[k] != 0]
        for a, b in signs:
            one = [0, 0, 0]
            one[places[0]], one[places[1]] = a * normal[places[0]], b * normal[places[1]]
            normals.append(one)
    return shape(halves(*((*normal, 2) for normal in normals)), 2)


def mug():
    cup = rsym.cylinder(1, height=2) - rsym.cylinder(Q(4, 5), height=2, centre=(0, 0, Q(1, 5)))
    handle = shape(Q(1, 100) - (sp.sqrt((x - Q(11, 10)) ** 2 + z**2) - Q(3, 5)) ** 2 - y**2, 2)
    outside = pole(Q(9, 10), (0, 0))
    return cup | (handle - outside)


def countersunk():
    return rsym.box(3, 3, 1) - pole(Q(1, 2), (0, 0)) - rsym.frustum(Q(1, 4), Q(5, 4), 1, base=(0, 0, Q(-2, 5)))


def die():
    body = rsym.box(2, 2, 2) & rsym.sphere(Q(7, 5))
    for centre in ((1, 0, 0), (0, 1, Q(1, 2)), (0, 1, Q(-1, 2))):
        body -= rsym.sphere(Q(1, 5), centre=centre)
    return body


def v_block():
    return rsym.box(4, 3, 2) - rsym.box(2, 4, 2).rotate(sp.pi / 4, axis=y).translate(0, 0, 1)


def clevis():
    fork = rsym.box(3, 2, 2) - rsym.box(2, 1, 3).translate(1, 0, 0)
    return fork - pole(Q(2, 5), (1, 0), y)


def piston():
    body = rsym.cylinder(2, height=4) - pole(Q(1, 2), (0, Q(-1, 2)), x)
    groove = rsym.cylinder(3, height=Q(2, 5), centre=(0, 0, 1)) - rsym.cylinder(Q(9, 5))
    return body - groove


def pencil():
    bar = rsym.extrude(rsym.regular_polygon(6, 1), -3, 3)
    return bar & rsym.nappe(sp.pi / 8).rotate(sp.pi, axis=x).translate(0, 0, 2)


def ring_with_stone():
    stone = shape(Q(1, 2) - abs(x - 2) - abs(y) - abs(z), 3)
    return rsym.torus(2, Q(1, 4)) | stone


def knob():
    return rsym.cylinder(2, height=1) - rsym.cyclic(rsym.cylinder(Q(3, 10)), 8, radius=2)


def milling_cutter():
    flute = pole(Q(2, 5), (1, 0))
    return rsym.cylinder(1, height=3) - (flute | pole(Q(2, 5), (-1, 0)))


def turned(points):
    """A body turned about x, its section above the axis a polygon."""
    return rsym.revolve(rsym.polygon(points))


def pulley():
    section = rsym.rectangle(1, 4) - rsym.disc(Q(2, 5), centre=(0, 2)) - rsym.disc(Q(2, 5), centre=(0, -2))
    return rsym.revolve(section)


def ogive():
    return rsym.revolve(rsym.disc(5, centre=(0, -4)) & rsym.disc(5, centre=(0, 4)))


def beam_with_rounded_end():
    slot = rsym.rectangle(4, 2) | rsym.disc(1, centre=(2, 0))
    return rsym.extrude(slot, 0, 1) - pole(Q(1, 2), (2, 0))


def roman_arch():
    return rsym.box(6, 1, 4) - pole(Q(3, 2), (0, -2), y)


def tower():
    wall = rsym.cylinder(2, height=4) - pole(Q(3, 2), (0, 0))
    return wall - rsym.box(1, 5, 1).translate(0, 0, 2) - rsym.box(5, 1, 1).translate(0, 0, 2)


def hinge():
    leaf = rsym.box(3, 2, Q(2, 5)).translate(Q(3, 2), 0, 0)
    return (leaf | (pole(Q(1, 2), (0, 0), y) & rsym.slab(-1, 1, direction=(0, 1, 0)))) - pole(Q(1, 4), (0, 0), y)


def axle():
    return turned(
        [(-3, -1), (-1, -1), (-1, -2), (0, -2), (0, -1), (3, -1), (3, 1), (0, 1), (0, 2), (-1, 2), (-1, 1), (-3, 1)]
    )


def within(body, size):
    return body.replace(bounds=((-size, size),) * 3)


BODIES = {
    "angle bracket": (lambda: prism([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], 2), "G0"),
    "T-slot bar": (lambda: prism([(0, 0), (4, 0), (4, 2), (3, 2), (3, 1), (1, 1), (1, 2), (0, 2)], 5), "G0"),
    "I-beam": (
        lambda: prism(
            [(0, 0), (4, 0), (4, 1), (3, 1), (3, 4), (4, 4), (4, 5), (0, 5), (0, 4), (1, 4), (1, 1), (0, 1)], 6
        ),
        "G0",
    ),
    "door wedge": (lambda: prism([(0, 0), (4, 0), (4, 1)], 1), "G0"),
    "star plate": (
        lambda: prism([(3, 0), (1, 1), (0, 3), (-1, 1), (-3, 0), (-1, -1), (0, -3), (1, -1)], 1),
        "G0",
    ),
    "arrow plate": (lambda: prism([(0, -1), (3, -1), (3, -2), (5, 0), (3, 2), (3, 1), (0, 1)], 1), "G0"),
    "rack": (
        lambda: prism([(0, 0), (6, 0), (6, 1), (5, 2), (4, 1), (3, 2), (2, 1), (1, 2), (0, 1)], 1),
        "G0",
    ),
    "plate with 4 holes": (plate_with_holes, "G0"),
    "washer": (lambda: rsym.cylinder(2, height=Q(2, 5)) - rsym.cylinder(1), "G0"),
    "hexagon nut": (hex_nut, "G0"),
    "pyramid": (pyramid, "G0"),
    "octahedron": (lambda: shape(1 - abs(x) - abs(y) - abs(z), Q(3, 2)), "G0"),
    "tetrahedron": (lambda: shape(halves((1, 1, 1, 1), (1, -1, -1, 1), (-1, 1, -1, 1), (-1, -1, 1, 1)), 2), "G0"),
    "dodecahedron": (dodecahedron, "G0"),
    "truncated cube": (lambda: rsym.box(2, 2, 2) & shape(Q(5, 2) - abs(x) - abs(y) - abs(z), 2), "G0"),
    "pipe tee": (lambda: within(pole(1, (0, 0), x) | pole(Q(1, 2), (0, 0), z), 2), "G0"),
    "pipe cross cut": (lambda: within(pole(1, (0, 0), x) & pole(1, (0, 0), z), 2), "G0"),
    "biconvex lens": (lambda: rsym.sphere(2, centre=(0, 0, -1)) & rsym.sphere(2, centre=(0, 0, 1)), "G0"),
    "biconvex lens tilted": (
        lambda: (rsym.sphere(2, centre=(0, 0, -1)) & rsym.sphere(2, centre=(0, 0, 1))).rotate(Q(1, 2), axis=(1, 1, 0)),
        "G0",
    ),
    "meniscus": (lambda: rsym.sphere(2) - rsym.sphere(2, centre=(0, 0, 1)), "G0"),
    "dome": (lambda: rsym.sphere(2) & rsym.half_space((0, 0, 1), 0), "G0"),
    "oblique ball cut": (lambda: rsym.sphere(2) & rsym.half_space((1, 2, 3), 1), "G0"),
    "bowl": (lambda: rsym.shell(rsym.sphere(2), Q(1, 5)) & rsym.half_space((0, 0, -1), Q(-1, 2)), "G0"),
    "bolt": (
        lambda: rsym.cylinder(1, height=4) | rsym.extrude(rsym.regular_polygon(6, 2), 2, 3),
        "G0",
    ),
    "mug": (mug, "G0"),
    "countersunk plate": (countersunk, "G0"),
    "die": (die, "G0"),
    "V-block": (v_block, "G0"),
    "clevis": (clevis, "G0"),
    "piston": (piston, "G0"),
    "pencil": (pencil, "G0"),
    "ring with stone": (ring_with_stone, "G0"),
    "knob with 8 grips": (knob, "G0"),
    "two-flute cutter": (milling_cutter, "G0"),
    "keyed shaft": (lambda: rsym.cylinder(1, height=4) - rsym.box(1, 1, 5).translate(1, 0, 0), "G0"),
    "stepped axle": (axle, "G0"),
    "pulley": (pulley, "G0"),
    "ogive": (ogive, "G0"),
    "cone stand": (lambda: rsym.frustum(2, 1, 3) | rsym.sphere(1, centre=(0, 0, 3)), "G0"),
    "ice cream": (lambda: rsym.cone(1, 3).rotate(sp.pi, axis=x) | rsym.sphere(Q(6, 5), centre=(0, 0, Q(1, 2))), "G0"),
    "forked rod": (beam_with_rounded_end, "G0"),
    "arch": (roman_arch, "G0"),
    "tower with gates": (tower, "G0"),
    "hinge": (hinge, "G0"),
    "house": (
        lambda: rsym.extrude(rsym.polygon([(-2, 0), (2, 0), (2, 2), (0, 4), (-2, 2)]), 0, 5) - rsym.box(1, 2, 1),
        "G0",
    ),
    "picture frame": (lambda: rsym.box(4, 3, Q(1, 2)) - rsym.box(3, 2, 1), "G0"),
    "skew beam": (lambda: rsym.box(4, 1, Q(1, 2)).rotate(Q(3, 10), axis=(1, 1, 1)), "G0"),
    "two beams crossed": (lambda: rsym.box(4, 1, 1) | rsym.box(1, 4, Q(1, 2)), "G0"),
    "caltrop": (lambda: rsym.sphere(1) | rsym.box(4, Q(1, 3), Q(1, 3)) | rsym.box(Q(1, 3), 4, Q(1, 3)), "G0"),
    "ball in R1": (lambda: rsym.disjunction(rsym.sphere(1), rsym.box(3, 1, 1), system=R1), "G0"),
    "lens in Rp(3)": (
        lambda: rsym.conjunction(rsym.sphere(2, centre=(0, 0, 1)), rsym.sphere(2, centre=(0, 0, -1)), system=Rp(3)),
        "G0",
    ),
    "lens in Ralpha": (
        lambda: rsym.conjunction(
            rsym.sphere(2, centre=(1, 0, 0)), rsym.sphere(2, centre=(-1, 0, 0)), system=RAlpha(Q(1, 2))
        ),
        "G0",
    ),
    "cut ball in R0m": (
        lambda: rsym.conjunction(rsym.sphere(2), rsym.half_space((0, 0, 1), 1), system=R0m(2)),
        "G0",
    ),
    "edge in Rho": (lambda: shape(rsym.conjunction(1 - x, 1 - z, system=Rho(Q(1, 2))), 2), "G1"),
    "lens in Sardf": (
        lambda: rsym.conjunction(
            rsym.sphere(2, centre=(0, 0, 1)), rsym.sphere(2, centre=(0, 0, -1)), system=Sardf(Q(1, 2))
        ),
        "G0",
    ),
    "cut ellipsoid": (lambda: rsym.ellipsoid(3, 2, 1) & rsym.half_space((1, 0, 1), 1), "G0"),
    "torus half": (lambda: rsym.torus(2, 1) & rsym.half_space((0, 1, 0), 0), "G0"),
    "torus quarter": (lambda: rsym.torus(2, 1) & rsym.half_space((0, 1, 0), 0) & rsym.half_space((1, 0, 0), 0), "G0"),
    "torus drilled": (lambda: rsym.torus(3, 1) - pole(Q(1, 2), (3, 0)), "G0"),
    "ball drilled": (lambda: rsym.sphere(2) - pole(Q(1, 2), (0, 0)), "G0"),
    "ball drilled thrice": (
        lambda: rsym.sphere(2) - pole(Q(1, 2), (0, 0), x) - pole(Q(1, 2), (0, 0), y) - pole(Q(1, 2), (0, 0), z),
        "G0",
    ),
    "ball with eccentric hole": (lambda: rsym.sphere(2) - pole(Q(1, 2), (1, 0)), "G0"),
    "snowman": (lambda: rsym.sphere(1) | rsym.sphere(Q(3, 4), centre=(0, 0, Q(5, 4))), "G0"),
    "molecule": (
        lambda: (
            rsym.sphere(1)
            | rsym.sphere(Q(3, 5), centre=(Q(4, 5), Q(3, 5), 0))
            | rsym.sphere(Q(3, 5), centre=(Q(-4, 5), Q(3, 5), 0))
        ),
        "G0",
    ),
    "Reuleaux body": (
        lambda: rsym.conjunction(*(rsym.sphere(2, centre=p) for p in ((1, 0, 0), (-1, 0, 0), (0, sp.sqrt(3), 0)))),
        "G0",
    ),
    "rugby ball": (lambda: rsym.revolve(rsym.disc(3, centre=(0, -2)) & rsym.disc(3, centre=(0, 2))), "G0"),
    "bead": (lambda: rsym.revolve(rsym.disc(2) & rsym.Shape(y**2 - 1, DISC, bounds=((-2, 2),) * 2)), "G0"),
}
