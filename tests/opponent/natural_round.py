"""Bodies without an edge: quartics, blobs, bottles, periodic walls, and what is nearly so."""

import sympy as sp

import rsym
from opponent.natural_cut import Q, pole, shape, within
from rsym import x, y, z

r2 = x**2 + y**2 + z**2
s = sp.Symbol("s", real=True)
k = sp.Symbol("k", real=True)


def turned(squared, low, high, size):
    """A body turned about x whose squared radius is a function of x."""
    return rsym.revolve(rsym.Shape(squared - y**2, (x, y), bounds=((low, high), (-size, size))))


def blob(centres, level):
    """Where the sum of Gaussian hills is above a level."""
    hills = sum(sp.exp(-((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2)) for a, b, c in centres)
    return shape(hills - level, 3)


def charges(centres, level):
    """Where the potential of charges is above a level."""
    potential = sum(1 / ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2 + Q(1, 10)) for a, b, c in centres)
    return shape(potential - level, 3)


def positive(u):
    return sp.Max(u, 0)


def rounded_box(power):
    """The sum of powers of what a point is beyond a box."""
    beyond = (positive(abs(c) - a) for c, a in ((x, 1), (y, Q(1, 2)), (z, Q(1, 4))))
    return shape(Q(1, 2) ** power - sum(b**power for b in beyond), 2)


def genus_two():
    return shape(Q(1, 100) - (x**2 * (1 - x**2) - y**2) ** 2 - z**2, Q(3, 2))


def cyclide(a, b, c, d):
    return shape(4 * ((a * x - c * d) ** 2 + b**2 * y**2) - (r2 + b**2 - d**2) ** 2, 6)


def twisted_bar():
    return within(rsym.screw(rsym.ellipse(2, 1), 8), 3)


def twisted_beam():
    return within(rsym.screw(rsym.rectangle(2, 1), 8), Q(3, 2))


def banana():
    """An ellipsoid bent along a parabola."""
    return shape(1 - x**2 / 4 - y**2 - (z - x**2 / 4) ** 2, 3)


def tapered_column():
    a = sp.Symbol("a", real=True)
    profile = rsym.Shape(a**2 - x**2 - y**2, (x, y), letters={a: 1})
    return rsym.sweep(profile, {a: 2 - z / 4}, 0, 4).replace(bounds=((-3, 3), (-3, 3), (-1, 5)))


def tapered_square():
    a = sp.Symbol("a", real=True)
    profile = rsym.Shape(rsym.conjunction(a**2 - x**2, a**2 - y**2), (x, y), letters={a: 1})
    return rsym.sweep(profile, {a: 2 - z / 4}, 0, 4).replace(bounds=((-3, 3), (-3, 3), (-1, 5)))


def skeleton_rod():
    return rsym.blend_on_skeleton(rsym.segment((-1, 0, 0), (1, 0, 0)), Q(1, 2))


def skeleton_bow():
    return rsym.blend_on_skeleton(rsym.arc(2, 0, sp.pi / 2, centre=(0, 0, 0)), Q(1, 2))


def hull():
    """A canoe: parabolic water lines and sections, open above."""
    return rsym.Shape(
        rsym.conjunction((1 - x**2 / 16) * (z + 1) - y**2, -z), (x, y, z), bounds=((-5, 5), (-2, 2), (Q(-3, 4), 1))
    )


def propeller_hub():
    return rsym.cyclic(rsym.ellipsoid(1, Q(1, 4), Q(1, 2)), 3, radius=Q(3, 2)) | rsym.sphere(Q(4, 5))


BODIES = {
    "ball by distance": (lambda: rsym.sphere(1, exact=True), "analytic"),
    "ball far off": (lambda: rsym.sphere(1, centre=(100, 50, -20)), "analytic"),
    "ball of a micron": (lambda: rsym.sphere(1).scale(Q(1, 10**6)), "analytic"),
    "ellipsoid turned": (lambda: rsym.ellipsoid(3, 2, 1).rotate(Q(7, 10), axis=(1, 2, 3)), "analytic"),
    "ring tilted": (lambda: rsym.torus(3, 1).rotate(Q(1, 2), axis=x), "analytic"),
    "ring thin": (lambda: rsym.torus(3, Q(1, 10)), "analytic"),
    "ring quartic": (lambda: shape(4 * 9 * (x**2 + y**2) - (r2 + 9 - 1) ** 2, 5), "analytic"),
    "Dupin cyclide": (lambda: cyclide(3, sp.sqrt(8), 1, 2), "analytic"),
    "genus two": (genus_two, "analytic"),
    "decocube": (
        lambda: shape(
            Q(1, 50)
            - ((x**2 + y**2 - Q(16, 25)) ** 2 + (z**2 - 1) ** 2)
            * ((y**2 + z**2 - Q(16, 25)) ** 2 + (x**2 - 1) ** 2)
            * ((z**2 + x**2 - Q(16, 25)) ** 2 + (y**2 - 1) ** 2),
            Q(3, 2),
        ),
        None,
    ),
    "tanglecube": (lambda: shape(-(x**4 - 5 * x**2 + y**4 - 5 * y**2 + z**4 - 5 * z**2 + Q(118, 10)), 3), "analytic"),
    "Goursat cushion": (lambda: shape(Q(1, 2) * r2 + Q(1, 4) - x**4 - y**4 - z**4, 2), "analytic"),
    "p-norm 4": (lambda: shape(1 - x**4 - y**4 - z**4, Q(3, 2)), "analytic"),
    "p-norm 8": (lambda: shape(1 - x**8 - y**8 - z**8, Q(3, 2)), "analytic"),
    "superellipsoid 4, 2": (lambda: shape(1 - (x**2 + y**2) ** 2 - z**4, Q(3, 2)), "analytic"),
    "p-norm 7/2": (lambda: shape(1 - sum(abs(c) ** Q(7, 2) for c in (x, y, z)), Q(3, 2)), "G3"),
    "cushion of exponents 2, 4, 6": (lambda: shape(1 - x**2 - y**4 - z**6, Q(3, 2)), "analytic"),
    "superellipse rod": (lambda: within(rsym.Shape(1 - x**4 - y**4, (x, y, z)), 2), "analytic"),
    "superellipse turned": (lambda: rsym.revolve(rsym.superellipse(2, 1, 4)), "analytic"),
    "Clebsch cubic": (
        lambda: shape(
            81 * (x**3 + y**3 + z**3)
            - 189 * (x**2 * y + x**2 * z + y**2 * x + y**2 * z + z**2 * x + z**2 * y)
            + 54 * x * y * z
            + 126 * (x * y + x * z + y * z)
            - 9 * r2
            - 9 * (x + y + z)
            + 1,
            1,
        ),
        "analytic",
    ),
    "Cayley cubic": (lambda: shape(r2 + 2 * x * y * z - 1, 2), "broken"),
    "double cone": (lambda: within(rsym.double_cone(), 1), "broken"),
    "saddle": (lambda: shape(z - x * y, 1), "analytic"),
    "monkey saddle": (lambda: shape(z - x**3 + 3 * x * y**2, 1), "analytic"),
    "egg crate": (lambda: shape(z - sp.sin(x) * sp.cos(y), 4), "analytic"),
    "ripple": (lambda: shape(z - sp.cos(x**2 + y**2) / 4, 2), "analytic"),
    "chimney": (lambda: shape(1 + z**2 - x**2 - y**2, 2), "analytic"),
    "two-sheet mirror": (lambda: shape(z**2 - x**2 - y**2 - 1, 3), "analytic"),
    "gyroid cell": (lambda: within(rsym.gyroid(2), 1), "analytic"),
    "gyroid wall": (lambda: within(rsym.gyroid(2, thickness=Q(1, 5)), 1), "analytic"),
    "gyroid level": (lambda: within(rsym.gyroid(2, level=Q(1, 10)), Q(3, 2)), "analytic"),
    "gyroid plain": (
        lambda: shape(sp.sin(x) * sp.cos(y) + sp.sin(y) * sp.cos(z) + sp.sin(z) * sp.cos(x), 3),
        "analytic",
    ),
    "Schwarz P": (lambda: within(rsym.schwarz_p(2), 1), "analytic"),
    "Schwarz D": (lambda: within(rsym.schwarz_d(2), 1), "analytic"),
    "Neovius": (lambda: within(rsym.neovius(2), 1), "analytic"),
    "Schwarz P in a box": (lambda: within(rsym.schwarz_p(2), 2) & rsym.box(Q(3, 2), Q(3, 2), Q(3, 2)), "G0"),
    "blob of two": (lambda: blob([(1, 0, 0), (-1, 0, 0)], Q(1, 2)), "analytic"),
    "blob of four": (lambda: blob([(1, 0, 0), (-1, 0, 0), (0, Q(3, 2), 0), (0, 0, 1)], Q(1, 2)), "analytic"),
    "potential of three": (lambda: charges([(1, 0, 0), (-1, 0, 0), (0, 1, 1)], 2), "analytic"),
    "peanut": (lambda: shape(Q(6, 5) - ((x - 1) ** 2 + y**2 + z**2) * ((x + 1) ** 2 + y**2 + z**2), 3), "analytic"),
    "two drops": (lambda: shape(Q(9, 10) - ((x - 1) ** 2 + y**2 + z**2) * ((x + 1) ** 2 + y**2 + z**2), 3), "analytic"),
    "blood cell": (lambda: shape(Q(1, 4) - (r2 + Q(1, 4)) ** 2 + Q(11, 10) * (x**2 + y**2), 2), "analytic"),
    "egg": (lambda: turned((1 - x**2) / (1 + x / 3), -2, 2, 2), "analytic"),
    "bottle": (lambda: turned((9 - x**2) * (2 + x**2 / 4 - x) / 20, -4, 4, 3), "analytic"),
    "vase": (lambda: turned((sp.sin(x) / 2 + 1) ** 2, -3, 3, 2), "analytic"),
    "baluster": (lambda: turned((sp.cos(3 * x) / 4 + 1) * (4 - x**2) / 4, -3, 3, 2), "analytic"),
    "vase cut": (
        lambda: rsym.revolve(
            rsym.Shape(rsym.conjunction(2 + sp.sin(x) - y**2, 4 - x**2), (x, y), bounds=((-3, 3), (-2, 2)))
        ),
        "G0",
    ),
    "drop": (lambda: turned((1 - x) * (1 + x) ** 3 / 2, -2, 2, 2), "broken"),
    "horns that touch": (lambda: turned((1 - x) * (1 + x) ** 2, -2, 2, 2), "broken"),
    "banana": (banana, "analytic"),
    "chair seat": (lambda: shape(1 - x**2 - y**2 / 2 - (z - x * y / 2) ** 2 * 9, 2), "analytic"),
    "twisted bar": (twisted_bar, "analytic"),
    "twisted beam": (twisted_beam, "G0"),
    "tapered column": (tapered_column, "G0"),
    "tapered square": (tapered_square, "G0"),
    "shell of an ellipsoid": (lambda: rsym.shell(rsym.ellipsoid(3, 2, 2), Q(1, 2)), "analytic"),
    "shell of a ring": (lambda: rsym.shell(rsym.torus(3, 1), Q(1, 4)), "analytic"),
    "ring grown": (lambda: rsym.offset(rsym.torus(3, 1), Q(1, 4)), "analytic"),
    "capsule": (lambda: rsym.capsule((0, 0, -1), (0, 0, 1), 1), "G1"),
    "capsule aslant": (lambda: rsym.capsule((0, 0, 0), (1, 2, 2), Q(1, 2)), "G1"),
    "capsule with a hole": (lambda: rsym.capsule((0, 0, -1), (0, 0, 1), 1) - pole(Q(1, 3), (0, 0), x), "G0"),
    "two capsules": (
        lambda: rsym.capsule((-1, 0, 0), (1, 0, 0), Q(1, 2)) | rsym.capsule((0, -1, 0), (0, 1, 0), Q(1, 3)),
        "G0",
    ),
    "rounded box, squares": (lambda: rounded_box(2), "G1"),
    "rounded box, cubes": (lambda: rounded_box(3), "G2"),
    "rod on a skeleton": (skeleton_rod, "analytic"),
    "bow on a skeleton": (skeleton_bow, "analytic"),
    "canoe": (hull, "G0"),
    "propeller": (propeller_hub, "G0"),
    "balls apart": (lambda: rsym.sphere(1, centre=(2, 0, 0)) | rsym.sphere(1, centre=(-2, 0, 0)), "analytic"),
    "balls that touch": (lambda: rsym.sphere(1, centre=(1, 0, 0)) | rsym.sphere(1, centre=(-1, 0, 0)), "broken"),
    "ball in a shell": (lambda: rsym.shell(rsym.sphere(3), Q(1, 2)) | rsym.sphere(1), "analytic"),
    "six balls around": (lambda: rsym.cyclic(rsym.sphere(Q(1, 2)), 6, radius=2), "analytic"),
    "five balls around": (lambda: rsym.cyclic(rsym.sphere(Q(1, 2)), 5, radius=2), "analytic"),
    "four pegs in a row": (
        lambda: rsym.row(rsym.sphere(Q(2, 5)), 1, count=4).replace(bounds=((-1, 4), (-1, 1), (-1, 1))),
        "analytic",
    ),
    "pins in a grid": (
        lambda: rsym.grid(rsym.cylinder(Q(1, 4), height=1), (1, 1), counts=(3, 2)).replace(
            bounds=((-1, 3), (-1, 2), (-1, 1))
        ),
        "G0",
    ),
    "pair mirrored": (lambda: rsym.mirrored(rsym.sphere(1, centre=(2, 0, 0)), (1, 0, 0)), "analytic"),
    "lens mirrored": (lambda: rsym.mirrored(rsym.sphere(1, centre=(Q(1, 2), 0, 0)), (1, 0, 0)), "G0"),
    "kaleidoscope of 3": (
        lambda: within(rsym.kaleidoscope(rsym.sphere(Q(1, 2), centre=(sp.sqrt(3), 1, 0)), 3), 3),
        "analytic",
    ),
    "tetrahedral balls": (
        lambda: within(rsym.mirror_group(rsym.sphere(Q(1, 4), centre=(2, 1, 0)), "tetrahedral"), 3),
        "analytic",
    ),
    "icosahedral cut": (
        lambda: rsym.sphere(1) & within(rsym.mirror_group(rsym.Shape(Q(9, 10) - z, (x, y, z)), "icosahedral"), 2),
        "G0",
    ),
    "hole with a fillet": (
        lambda: rsym.fillet(rsym.Shape(-z, (x, y, z)), pole(1, (0, 0)), Q(1, 4)).replace(
            bounds=((-2, 2), (-2, 2), (-1, 1))
        ),
        "G1",
    ),
    "wedge with a fillet": (
        lambda: shape(rsym.fillet(1 - x, 1 - z, Q(1, 2), operation="intersection"), 2),
        "G1",
    ),
    "wedge with a G2 fillet": (
        lambda: shape(rsym.fillet(1 - x, 1 - z, Q(1, 2), continuity="G2", operation="intersection"), 2),
        "G2",
    ),
    "cross blended": (
        lambda: rsym.displacement_blend(pole(1, (0, 0), x), pole(1, (0, 0), z), Q(1, 2)).replace(bounds=((-2, 2),) * 3),
        None,
    ),
    "ball with a letter": (
        lambda: rsym.Shape(s**2 - r2, (x, y, z), letters={s: Q(3, 2)}, bounds=((-2, 2),) * 3),
        "analytic",
    ),
    "lens with letters": (
        lambda: rsym.Shape(
            rsym.conjunction(s**2 - r2, s**2 - x**2 - y**2 - (z - k) ** 2),
            (x, y, z),
            letters={s: 2, k: 1},
            bounds=((-2, 2), (-2, 2), (-2, 3)),
        ),
        "G0",
    ),
}
