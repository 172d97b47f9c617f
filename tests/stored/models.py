"""The shapes that outputs are stored of, by name.

They stand in families in which nothing is wrong: all parts of one shape differ in their leaves and nowhere coincide,
omega has a value everywhere in the bounds, and the bounds hold the body, with room to spare. So what changes in what is
made of them was right before.
"""

import sympy as sp

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape, conjunction, disjunction, x, y, z

HALF, THIRD = sp.Rational(1, 2), sp.Rational(1, 3)
a, b = sp.symbols("a b", real=True)
SQUARE, CUBE = ((-2, 2),) * 2, ((-2, 2),) * 3
BITTEN = 1 - x**2 - y**2, x**2 + (y - THIRD) ** 2 - HALF
SYSTEMS = {
    "R0": R0,
    "R1": R1,
    "RAlpha": RAlpha(HALF),
    "R0m": R0m(2),
    "Rp": Rp(4),
    "Sardf": rsym.Sardf(),
    "Rho": rsym.Rho(THIRD),
}


def plane(expression, bounds=SQUARE, **letters):
    return Shape(expression, (x, y), bounds=bounds, letters={sp.Symbol(n, real=True): v for n, v in letters.items()})


def space(expression, bounds=CUBE, **letters):
    return Shape(expression, (x, y, z), bounds=bounds, letters={sp.Symbol(n, real=True): v for n, v in letters.items()})


def plane_tree(system):
    """A lens with a notch and an ear."""
    lens = system.conjunction(1 - (x + THIRD) ** 2 - y**2, 1 - (x - THIRD) ** 2 - y**2)
    ear = HALF**4 - (x - HALF) ** 2 - (y - HALF) ** 2
    return plane(system.conjunction(system.disjunction(lens, ear), y + HALF + x / 5))


def space_tree(system):
    """A block of a ball and two slanting planes, with a notch."""
    block = system.conjunction(1 - x**2 - y**2 - z**2, HALF - x / 3 - z, y + x / 4 + HALF)
    return space(system.conjunction(block, -system.conjunction(x + y / 5 - THIRD / 2, z + x / 7 - THIRD / 4)))


PLANE = {
    "slanting edge": lambda: plane(conjunction(x / 2 + y / 3 - sp.Rational(1, 7), 1 - x**2 - y**2)),
    "disc": lambda: rsym.disc(1),
    "ellipse": lambda: plane(1 - x**2 / 3 - y**2),
    "quartic": lambda: plane(1 - x**4 - y**4 + x * y / 2),
    **{f"plane tree of {name}": (lambda system=system: plane_tree(system)) for name, system in SYSTEMS.items()},
    "letters": lambda: plane(conjunction(a - x**2 - y**2, y + b, x + 1 - b * y), a=2, b=0.25),
    "quotients": lambda: plane(conjunction(x / (2 + y**2) + THIRD, 1 - x**2 - y**2)),
    "absolute values": lambda: plane(1 - abs(x) ** 3 - abs(y - x / 4)),
    "cases": lambda: plane(sp.Piecewise((1 - x**2 - y**2, x > 0), (1 - x**2 / 2 - y**2, True))),
    "minimum": lambda: plane(sp.Min(1 - x, 1 + x - y / 5, 1 - y, 1 + y, evaluate=False)),
    "distance": lambda: plane(1 - sp.sqrt((x - THIRD) ** 2 + y**2)),
    "equivalence": lambda: plane(conjunction(rsym.equivalence(*BITTEN, order=2), 2 - x**2 - y**2)),
    "joining": lambda: plane(conjunction(rsym.joining(*BITTEN, order=2), 2 - x**2 - y**2)),
    "trimming": lambda: plane(THIRD - rsym.trimming(y, (1 - x**2) / 2)),
    "rectangle": lambda: rsym.rectangle(2, 1),
    "moved": lambda: rsym.rectangle(2, 1).rotate(sp.pi / 6).scale(THIRD * 2).translate((THIRD, -HALF)),
    "bored plate": lambda: rsym.rectangle(3, 2) - rsym.disc(THIRD, (HALF, 0)) - rsym.disc(HALF, (-HALF, 0)),
    "cyclic": lambda: rsym.cyclic(rsym.disc(THIRD, (1, 0)), 5),
    "normalised": lambda: rsym.normalise(plane(1 - x**4 - y**4 + x * y / 2)),
    "skeleton body": rsym.paper.skeleton_body,
}
SPACE = {
    "ball": lambda: rsym.sphere(1),
    "ellipsoid": lambda: space(1 - x**2 / 3 - y**2 - z**2 / 2),
    "torus": lambda: rsym.torus(1, THIRD),
    "box": lambda: rsym.box(2, 1, HALF),
    "capsule": lambda: rsym.capsule([-1, 0, 0], [1, HALF, 0], THIRD),
    "cone": lambda: rsym.cone(1, 2),
    "frustum": lambda: rsym.frustum(1, HALF, 1),
    "quartic body": lambda: space(1 - x**4 - y**4 - z**4 + x * y * z),
    **{f"space tree of {name}": (lambda system=system: space_tree(system)) for name, system in SYSTEMS.items()},
    "letters in space": lambda: space(conjunction(a - x**2 - y**2 - z**2, z + b * x), a=2, b=0.25),
    "three cylinders": lambda: space(conjunction(1 - x**2 - y**2, 1 - y**2 - z**2, 1 - z**2 - x**2)),
    "bored ball": lambda: space(conjunction(1 - x**2 - y**2 - z**2, x**2 + (y - THIRD / 2) ** 2 - THIRD**2)),
    "two balls": lambda: space(disjunction(1 - x**2 - y**2 - z**2, 1 - (x - THIRD) ** 2 - y**2 - (z - 1) ** 2)),
    "minimum in space": lambda: space(sp.Min(1 - x, 1 + x - y / 5, 1 - y, 1 + y + z / 3, 1 - z**2, evaluate=False)),
    "extruded": lambda: rsym.extrude(rsym.disc(1) - rsym.disc(THIRD, (HALF, 0)), 0, 1),
    "revolved": lambda: rsym.revolve(rsym.disc(HALF, (0, 1)) & rsym.half_plane((THIRD, 1), THIRD), x),
    "moved block": lambda: rsym.box(2, 1, 1).rotate(sp.pi / 6, z).translate((THIRD, 0, -HALF)),
    "blended": lambda: rsym.fillet(rsym.sphere(1), rsym.sphere(HALF, (1, 0, 0)), THIRD),
    "bone": lambda: rsym.load("bone"),
    "valve": rsym.paper.valve,
    "streamlined": rsym.paper.streamlined,
}
# What passes through sine, exponential and the like: NumPy's own are not the same on every processor.
FUNCTIONS = {
    "waves": lambda: plane(conjunction(HALF - y + sp.sin(3 * x) / 3, HALF + y, 1 - x**2)),
    "exponential": lambda: plane(2 - sp.exp(x) * (1 + y**2) - x**2),
    "logarithm": lambda: plane(conjunction(sp.log(3 + y) - HALF, 1 - x**2 - y**2)),
    "angle": lambda: plane(1 - x**2 - y**2 + sp.atan2(y, 3 + x)),
    "hyperbolic": lambda: plane(sp.tanh(x) + 1 - x**2 - y**2),
    "powers": lambda: plane_tree(Rp(sp.Rational(5, 2))),
    "superellipse": lambda: rsym.superellipse(1, HALF, sp.Rational(5, 2)),
    "ball of gyroid": lambda: space(
        conjunction(
            sp.sin(3 * x) * sp.cos(3 * y) + sp.sin(3 * y) * sp.cos(3 * z) + sp.sin(3 * z) * sp.cos(3 * x),
            1 - x**2 - y**2 - z**2,
        )
    ),
    "coil": lambda: rsym.coil(1, sp.Rational(1, 4), 1, turns=2),
}
# Constructions whose formulas may be written otherwise.
MADE = {
    "polygon": lambda: rsym.polygon([(0, 0), (2, 0), (2, 1), (1, HALF), (0, 2)]),
    "hexagon": lambda: rsym.regular_polygon(6, 1),
    "kaleidoscope": lambda: rsym.kaleidoscope(rsym.disc(THIRD, (1, THIRD)), 6),
    "row": lambda: rsym.row(rsym.disc(THIRD), 1, count=3),
    "offset": lambda: rsym.offset(rsym.disc(1), THIRD),
    "bracket": lambda: rsym.load("bracket"),
    "spanner": lambda: rsym.load("spanner"),
    "jack": lambda: rsym.load("jack"),
}
MODELS = PLANE | SPACE | FUNCTIONS | MADE
LARGE = ("bone", "valve", "streamlined", "bracket", "spanner", "jack")
CLOSED = ("ball", "torus", "box", "frustum", "quartic body", "space tree of R0", "three cylinders", "extruded")
THIN = ("space tree of Rho", "ball of gyroid", "coil")  # against a cell, or not proved to be resolved
