"""Solutions in space that are known, and bodies typed in two ways: `python tests/opponent/hunt.py solids`.

Balls, boxes, cylinders and what is made of them, flush or overlapping; a plane through them may be a part of its own,
with a value, a flux or Robin's condition. The true error may be three times the estimate. Of two typings the integral
and the least eigenvalue differ by three times both estimates, the volume by rounding.
"""

from dataclasses import dataclass

import numpy as np
import sympy as sp

import rsym
from opponent.fields import away, put
from opponent.typings import SYSTEMS, rational
from rsym import x, y, z
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.logic.sign_form import shape_form
from rsym.program.raising import raised

XYZ = (x, y, z)
FEW = 3  # leaves whose product is still smooth enough to be told from nothing


def body(random):
    """What a body is called, and itself."""
    a, b, c = (rational(random, 1, 2) for _ in range(3))
    made = {
        "ball": lambda: rsym.sphere(a),
        "ellipsoid": lambda: rsym.ellipsoid(a, b, c),
        "box": lambda: rsym.box(a, b, c),
        "cylinder": lambda: rsym.cylinder(a, 2 * b),
        "balls": lambda: rsym.sphere(a) | rsym.sphere(b, (a, 0, 0)),
        "lens": lambda: rsym.sphere(a + 1) & rsym.sphere(b + 1, (1, 0, 0)),
        "shell": lambda: rsym.sphere(a + 1) - rsym.sphere(b / 3),
        "bored": lambda: rsym.box(2 * a, 2 * b, c) - rsym.cylinder(rational(random, 0.4, 0.7), 4),
        "flush": lambda: rsym.box(2, 2, 2) | rsym.box(a, 2, 2, (1 + a / 2, 0, 0)),
        "overlapping": lambda: rsym.box(2, 2, 2) | rsym.box(a, 2, 2, (sp.Rational(9, 10) + a / 2, 0, 0)),
        "step": lambda: rsym.box(2, 2, 2) | rsym.box(a, 2, 1, (1 + a / 2, 0, 0)),
        "prism": lambda: rsym.extrude(rsym.polygon([(-a, -1), (b, -1), (0, a)]), -c / 2, c / 2),
        "turned": lambda: rsym.box(a, b, c).rotate(rational(random, 0, 6), (1, 2, 2)),
    }
    kind = list(made)[random.integers(len(made))]
    return kind, made[kind]()


def half(random):
    """A half-space whose plane goes through a body."""
    normal = [(1, 0, 0), (0, 0, 1), (1, 2, 2), (2, -3, 6), (0, 3, 4)][random.integers(5)]
    return rsym.half_space(normal, rational(random, -0.4, 0.4))


def cut(random, shape):
    """The pieces of a body on both sides of a plane, together again."""
    one = half(random)
    over = sp.S.Zero if random.random() < 0.6 else sp.Rational(1, int(random.choice([20, 100, 1000])))
    pieces = [shape & rsym.Shape(sign * one.expression + over, XYZ) for sign in (1, -1)]
    return pieces[0] | pieces[1]


def retyped(random, shape):
    """The same body, or one moved, and how many times as large it is."""
    way = ("cut", "cut", "system", "times", "moved")[random.integers(5)]
    if way == "cut":
        return way, cut(random, shape), 1.0
    if way == "system":
        return way, shape.with_system(SYSTEMS[random.integers(len(SYSTEMS))]), 1.0
    if way == "times":
        power = int(random.choice([1, 3]))
        return way, shape.replace(expression=1000 * shape.expression**power), 1.0
    scale = sp.Integer(10) ** int(random.integers(-3, 4))
    moved = shape.rotate(rational(random, 0, 6), (2, 1, 2)).translate(*(rational(random, -3, 3) for _ in XYZ))
    return way, moved.scale(scale), float(scale)


def known(random):
    """A function."""
    a, b, c = (rational(random, -2, 2) for _ in range(3))
    return [
        a * x**3 + b * x * y * z + c * z**2 + 1,
        sp.sin((1 + a) * x + b) * sp.cosh(y / 2) + c * z,
        1 / ((x - 5 - a) ** 2 + (y - b) ** 2 + z**2),
        sp.exp(-((x - a / 3) ** 2) - (y - b / 3) ** 2 - (z - c / 3) ** 2),
        sp.tanh(x + a * y / 2 - b * z / 2) + c,
    ][random.integers(5)]


@dataclass(frozen=True)
class Case:
    """A shape with a solution, or with another typing of itself."""

    family: str
    shape: rsym.Shape
    cells: int
    u: sp.Expr | None = None
    data: tuple = ()
    other: rsym.Shape | None = None
    scale: float = 1.0

    def __str__(self):
        typed = "" if self.other is None else f" typed {self.other.expression}"
        return f"{self.shape.expression}{typed} u={self.u} {self.data} {self.cells}"


def case(seed):
    """The case of a seed, every third a pair."""
    random = np.random.default_rng(seed)
    kind, shape = body(random)
    if seed % 3 == 2:
        way, typed, scale = retyped(random, shape)
        question = (integral, drum)[random.integers(2)]
        return Case(f"{way} {kind}", shape, int(random.integers(4, 6)), data=(question,), other=typed, scale=scale)
    way = ("value", "value", "flux", "robin", "values")[random.integers(5)]
    if way != "value":
        shape = shape.named("outside") & half(random).named("cut")
    elif random.random() < 0.3:
        shape = cut(random, shape)
    k = (sp.Integer(1), sp.Integer(2), 2 + sp.sin(x), 1 + x**2 + z**2)[random.integers(4)]
    c = (0, 0, 1, y**2)[random.integers(4)]
    beta = rational(random, -2, 2) if random.random() < 0.3 else 0
    turned = way != "value" and random.random() < 0.3 and kind in ("ball", "ellipsoid")
    return Case(f"{way} {kind}", shape, int(random.integers(4, 8)), known(random), (way, k, beta, c, turned))


def outward(leaf, u):
    """du/dn on the boundary of a leaf."""
    slope = [sp.diff(leaf, one) for one in XYZ]
    along = sum(one * sp.diff(u, other) for one, other in zip(slope, XYZ, strict=True))
    return -along / sp.sqrt(sum(one**2 for one in slope))


def asked(case):
    """The word and what is wrong."""
    return put((lambda: pair(case)) if case.u is None else lambda: field(case))


def field(case):
    """The error of a solution, and its estimate."""
    (way, k, beta, c, turned), u = case.data, case.u
    f = -sum(sp.diff(k * sp.diff(u, one), one) for one in XYZ) + beta * sp.diff(u, z) + c * u
    form = shape_form(case.shape)
    leaves = [raised(form.builder.nodes, leaf) for leaf in form.leaves]
    inside = u + (sp.Mul(*leaves) * (1 + x / 2) if len(leaves) <= FEW else 0)  # u on the boundary, not inside
    conditions = {...: inside}
    if way != "value":
        number = [parts[-1] for parts in shape_leaf_parts(case.shape)].index("cut")
        natural, other = ("outside", "cut") if turned else ("cut", "outside")
        leaf = leaves[1 - number if turned else number]
        slope = outward(leaf, u)
        given = {"flux": rsym.neumann(slope), "robin": rsym.robin(2, slope + 2 * u), "values": inside}[way]
        conditions = {natural: given, other: inside}
    letters = {"k": k, "b": sp.sympify(beta), "c": sp.sympify(c), "f": f}
    equation = "-div(k*grad(u)) + dot([0, 0, b], grad(u)) + c*u = f"
    found = rsym.solve(case.shape, equation, conditions, letters=letters, cells=case.cells)
    return away(found, u), found.report.estimate


def pair(case):
    """How far numbers of both typings are apart, each with its estimate."""
    ((one, near), (other, about)) = (case.data[0](shape, case.cells) for shape in (case.shape, case.other))
    volume, again = (float(rsym.measure(shape).volume) for shape in (case.shape, case.other))
    size = case.scale ** (5 if case.data[0] is integral else -2)
    return [(abs(one - other / size), near + about / size), (abs(again / volume / case.scale**3 - 1), 1e-9)]


def integral(shape, cells):
    """That of Poisson's equation, which is as far off as values are on an average."""
    found = rsym.solve(shape, "-laplacian(u) = 1", 0, cells=cells)
    largest = np.abs(found.jets(found.rule.points, 0)[0]).max()
    return found.integral(), found.report.estimate * largest * found.rule.weights.sum()


def drum(shape, cells):
    """The least eigenvalue."""
    found = rsym.modes(shape, 1, cells=cells)
    return found.values[0], found.values[0] * found.grades[-1].estimate
