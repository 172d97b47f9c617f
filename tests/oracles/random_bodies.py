"""Random bodies of which it is known by construction whether their boundary is curvature-continuous.

Regular ones: bases without singular points, moved, joined where they are disjoint, multiplied by positive functions
with kinks, normalised, blended by G2 fillets within a window. Planted ones: the same with a defect that is certain to
lie on the boundary: an edge, a jump of curvature, a cone, a point of contact.
"""

import numpy as np
import sympy as sp

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape, x, y, z
from rsym.model.powers import absolute_power

HALF = sp.Rational(1, 2)
SYSTEMS = (R0, R1, RAlpha(HALF), Rp(4), R0m(1))
SPACE = sp.Matrix([x, y, z])


def rational(random, low, high, digits=100):
    return sp.Rational(int(random.integers(int(low * digits), int(high * digits) + 1)), digits)


def rotation(random):
    """A rational rotation, from a quaternion of small whole numbers."""
    while True:
        a, b, c, d = (int(value) for value in random.integers(-3, 4, 4))
        if n := a * a + b * b + c * c + d * d:
            break
    return (
        sp.Matrix(
            [
                [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
                [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
            ]
        )
        / n
    )


def placed(random, expression, reach=0.2):
    """The expression in turned and shifted coordinates; also these coordinates."""
    shift = sp.Matrix([rational(random, -reach, reach) for _ in range(3)])
    u, v, w = rotation(random).T * (SPACE - shift)
    return expression.subs({x: u, y: v, z: w}, simultaneous=True), (u, v, w)


def ellipsoid(random):
    a, b, c = (rational(random, 0.6, 1.2) for _ in range(3))
    return 1 - x**2 / a**2 - y**2 / b**2 - z**2 / c**2


def quartic(random):
    """Star-shaped about the origin, for every term falls along each ray."""
    a, b, c, d = (rational(random, 0.2, 1) for _ in range(4))
    return 1 - a * x**2 - b * y**2 - (x**2 + y**2 + z**2) ** 2 - c * x**2 * z**2 - d * z**2


def torus(random):
    major, minor = rational(random, 0.6, 0.8), rational(random, 0.2, 0.4)
    return (4 * major**2 * (x**2 + y**2) - (x**2 + y**2 + z**2 + major**2 - minor**2) ** 2) / 4


def superellipsoid(random):
    return 1 - x**4 - rational(random, 0.8, 2) * y**4 - rational(random, 0.8, 2) * z**4


def bulged(random):
    """A ball with a cubic kink, |x|^3: of class C2 exactly."""
    return 1 - x**2 - y**2 - z**2 - rational(random, 0.2, 1) * absolute_power(x, sp.Integer(3))


BASES = (ellipsoid, quartic, torus, superellipsoid, bulged)
WINDOW = ((-1.61, 1.6), (-1.6, 1.62), (-1.59, 1.6))


def base(random):
    """A regular body around the origin, within the unit ball or a little more, that holds a point near its middle."""
    return placed(random, BASES[random.integers(len(BASES))](random), 0.1)[0]


def dressed(random, expression):
    """The same zero set in another dress."""
    kind = random.integers(5)
    if kind == 0:
        return expression * (2 + sp.Abs(x - rational(random, -1, 1), evaluate=False))
    if kind == 1:
        return expression / (1 + x**2 + y**2)
    if kind == 2:
        return rsym.normalise(Shape(expression, (x, y, z))).expression
    return expression


def regular(random):
    """A body with a boundary of class G2 or better within the window."""
    kind = random.integers(5)
    if kind == 0:  # hollow: a small ball cut out of the middle of a thick one
        inner = rational(random, 0.1, 0.3) ** 2 - x**2 - y**2 - z**2
        outer = ellipsoid(random)
        system = SYSTEMS[random.integers(len(SYSTEMS))]
        return dressed(random, system.conjunction(outer, -inner))
    if kind == 1:  # two that are apart
        balls = [(rational(random, 0.2, 0.6)) ** 2 - (x - s) ** 2 - y**2 - z**2 for s in (-HALF - 1, 1 + HALF)]
        system = SYSTEMS[random.integers(len(SYSTEMS))]
        return placed(random, system.disjunction(*(ball.subs(x, 2 * x) for ball in balls)), 0)[0]
    if kind == 2:  # a cubic fillet between planes at right angles
        _, (u, v, _) = placed(random, x, 0.2)
        return rsym.conjunction(u, v, system=rsym.Rho(rational(random, 0.3, 0.8), "G2"))
    return dressed(random, base(random))


def planted(random):
    """A body with a defect on its boundary, well inside the window; and what it is called."""
    kind = ("edge", "edge", "crease", "jump", "fillet", "cone", "contact", "dent")[random.integers(8)]
    system = SYSTEMS[random.integers(len(SYSTEMS))]
    if kind == "edge":  # a plane through the inside of a body cuts its boundary, nowhere at right angles to nothing
        normal = rotation(random)[:, 0]
        cut = normal.dot(SPACE) - rational(random, -0.1, 0.1)
        join = system.conjunction if random.random() < 0.5 else system.disjunction
        return kind, dressed(random, join(ellipsoid(random), cut))
    if kind == "crease":  # |u| bends the boundary where the plane u = 0 cuts it
        body, (u, _, _) = placed(random, ellipsoid(random), 0.1)
        return kind, body + rational(random, 0.001, 0.2, 1000) * sp.Abs(u, evaluate=False)
    if kind == "jump":
        body, (u, _, _) = placed(random, ellipsoid(random), 0.1)
        return kind, body + rational(random, 0.01, 0.3) * sp.Max(
            u - rational(random, -0.3, 0.3), 0, evaluate=False
        ) ** 2
    if kind == "fillet":
        _, (u, v, _) = placed(random, x, 0.2)
        return kind, rsym.conjunction(u, v, system=rsym.Rho(rational(random, 0.3, 0.8)))
    if kind == "cone":
        cone, _ = placed(random, rational(random, 0.3, 2) * z - sp.sqrt(x**2 + y**2), 0.2)
        return kind, cone
    if kind == "contact":
        r, s = rational(random, 0.2, 0.5), rational(random, 0.2, 0.5)
        balls = r**2 - (x + r) ** 2 - y**2 - z**2, s**2 - (x - s) ** 2 - y**2 - z**2
        return kind, placed(random, system.disjunction(*balls), 0.2)[0]
    # A small dent: a ball of a hundredth about a point of the boundary.
    body = ellipsoid(random)
    along = sp.Matrix([1, 0, 0])
    radius = 1 / sp.sqrt(-(body.subs({y: 0, z: 0}) - 1).coeff(x, 2))
    small = rational(random, 0.01, 0.05) ** 2 - (SPACE - radius * along).dot(SPACE - radius * along)
    return kind, system.conjunction(body, -small)


def body_of(expression):
    return Shape(expression, (x, y, z), bounds=WINDOW)


def numbered(kind, number):
    """One of the bodies of a kind, from a generator of its own."""
    return kind(np.random.default_rng([20261121, number]))
