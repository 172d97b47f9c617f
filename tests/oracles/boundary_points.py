"""Points on the boundary of a shape and the normal derivatives there: an oracle for normalisation.

Series in t of omega(point + t*direction) are computed from the written-out
SymPy expression by power-series arithmetic in extended precision; nothing here
knows how rsym generates code or normalises.
"""

import math
from functools import cache
from itertools import product

import numpy as np
import sympy as sp

from oracles.closeness import assert_close
from oracles.power_series import FUNCTIONS, REAL, Series, piecewise
from rsym import Shape
from rsym.model.nodes import Fold, RealNode

PAIR = sp.symbols("f g", real=True, cls=sp.Dummy)


class Expansion:
    """Series of an expression, at the letters' defaults or at other values: {name: number}."""

    def __init__(self, shape, letters=None, expression=None):
        self.coordinates = shape.coordinates
        expression = shape.expression if expression is None else expression
        values = {name: letter.default for name, letter in shape.letters.items()} | dict(letters or {})
        numbers = {
            symbol: sp.sympify(values[symbol.name])
            for symbol in expression.free_symbols
            if symbol not in shape.coordinates
        }
        self.root = expression.xreplace(numbers)

    def series(self, points, directions, order, real=REAL):
        """Coefficients (order + 1, points) along point + t*direction."""
        return self._evaluated(points, directions, order, real)[0]

    def value_and_gradient(self, points, real=REAL):
        """Values (points,) and gradients (points, dimension)."""
        count, dimension = points.shape
        axes = np.repeat(np.eye(dimension), count, axis=0)
        series = self.series(np.tile(points, (dimension, 1)), axes, 1, real)
        return series[0, :count], series[1].reshape(dimension, count).T

    def clearance(self, points):
        """The least root of a radicand or size of an absolute value at each point: small near edges and apexes."""
        return np.fmin.reduce(self._evaluated(points, np.zeros_like(points), 0, REAL)[1])

    def _evaluated(self, points, directions, order, real):
        points, directions = np.asarray(points, real), np.asarray(directions, real)
        like = Series(np.zeros((order + 1, len(points)), real))
        values = {}
        for symbol, start, slope in zip(self.coordinates, points.T, directions.T, strict=True):
            values[symbol] = Series.constant(start, like)
            values[symbol].c[1:2] = slope
        evaluation = _Evaluation(like)
        with np.errstate(all="ignore"):
            return evaluation(self.root, values).c, evaluation.sizes


class _Evaluation:
    """One walk through an expression; `sizes` are the roots of its radicands and the sizes of its absolute values."""

    def __init__(self, like):
        self.like = like
        self.sizes = [np.full(like.c.shape[1:], np.inf, like.c.dtype)]

    def __call__(self, expression, values):
        for part in _in_order(expression):
            if part not in values:
                values[part] = self._value(part, values)
        return values[expression]

    def _value(self, part, values):
        if part.is_Rational:
            return Series.constant(REAL(str(part.p)) / REAL(str(part.q)), self.like)
        if part.is_NumberSymbol or part.is_Float:
            return Series.constant(REAL(str(sp.N(part, 30))), self.like)
        if isinstance(part, sp.Piecewise):
            return piecewise(part, values)
        arguments = [values[argument] for argument in part.args]
        if isinstance(part, Fold):
            return self._folded(part, arguments[part.parameter_count :])
        if isinstance(part, RealNode):
            stand_ins = [sp.Dummy(real=True) if argument.free_symbols else argument for argument in part.args]
            return self(part.func(*stand_ins).doit(), dict(zip(stand_ins, arguments, strict=True)))
        if part.is_Add or part.is_Mul:
            result, *others = arguments
            for other in others:
                result = result + other if part.is_Add else result * other
            return result
        if part.is_Pow:
            return self._power(part, *arguments)
        if isinstance(part, sp.Abs):
            self.sizes.append(np.abs(arguments[0].c[0]))
        return FUNCTIONS[part.func](*arguments)

    def _folded(self, node, arguments):
        """From the left, pair by pair: written out as a whole, what is folded would be written many times."""
        pair = node.pair_as_roots(*PAIR).doit()
        result, *others = arguments
        for other in others:
            result = self(pair, dict(zip(PAIR, (result, other), strict=True)))
        return result

    def _power(self, part, base, exponent):
        if part.exp.free_symbols:
            return (exponent * FUNCTIONS[sp.log](base)).exp()
        if part.base.free_symbols and not part.exp.is_Integer:
            self.sizes.append(np.sqrt(np.abs(base.c[0])))
        return base.power(exponent.c[0, 0])


@cache
def _in_order(root):
    """Every part once, arguments first."""
    done, stack = {}, [(root, False)]
    while stack:
        part, ready = stack.pop()
        if ready:
            done[part] = None
        elif part not in done:
            inside = [piece for piece, _ in part.args] if isinstance(part, sp.Piecewise) else part.args
            stack.append((part, True))
            stack.extend((argument, False) for argument in inside if not part.is_Rational)
    return tuple(done)


def boundary_points(shape, count=200, *, bounds=None, letters=None, seed=0, clearance=1e-2, away_from=()):
    """`count` points of omega = 0 inside the bounds, to extended precision: (points, inner unit normals).

    Starts are random in the box; Newton's steps go along the gradient. Left out
    are points where a radicand or an absolute value of the formula is nearer to zero
    than `clearance` times the extent of the box (edges, apexes), and those where one of
    `away_from` is: expressions in coordinates and letters, or functions of points (n, d).
    """
    box = np.array(bounds or shape.box.ends, float)
    assert box.shape == (shape.dimension, 2), "give bounds"
    low, extent = box[:, 0], float(np.ptp(box, axis=1).max())
    expansion, random = Expansion(shape, letters), np.random.default_rng(seed)
    edges = [edge if callable(edge) else _function(Expansion(shape, letters, sp.sympify(edge))) for edge in away_from]
    found, tries = [], 0
    while sum(map(len, found)) < count:
        tries += 1
        assert tries < 40, f"only {sum(map(len, found))} of {count} boundary points were found"
        points = _on_boundary(expansion, low + np.ptp(box, axis=1) * random.random((2 * count, len(box))), extent)
        keep = ((points >= low) & (points <= box[:, 1])).all(axis=1)
        if clearance:
            keep &= expansion.clearance(points) > clearance * extent
        for edge in edges:
            keep &= np.abs(edge(points)) > clearance * extent
        found.append(points[keep])
    points = np.concatenate(found)[:count]
    gradients = expansion.value_and_gradient(points)[1]
    return points, gradients / np.sqrt((gradients**2).sum(axis=1))[:, None]


def _function(expansion):
    return lambda points: expansion.series(points, np.zeros_like(points), 0)[0]


def _on_boundary(expansion, points, extent):
    """Newton in double precision until half of the points have arrived, then for these in extended precision."""
    for _ in range(25):
        points, lengths, _ = _newton(expansion, points, extent, np.float64)
        arrived = lengths < 1e-9 * extent
        if 2 * arrived.sum() >= len(points):
            break
    points = points[arrived]
    for _ in range(3):
        points, lengths, squares = _newton(expansion, points, extent, REAL)
    return points[(lengths < 1e-15 * extent) & (squares > 1e-12)]


def _newton(expansion, points, extent, real):
    """A step along the gradient: points, lengths of the steps, squares of the gradients, where these are defined."""
    value, gradients = expansion.value_and_gradient(points, real)
    squares = (gradients**2).sum(axis=1)
    with np.errstate(all="ignore"):
        steps = -(value / squares)[:, None] * gradients
        lengths = np.sqrt((steps**2).sum(axis=1))
        steps *= np.minimum(1, 0.2 * extent / lengths)[:, None]
    keep = np.isfinite(steps).all(axis=1) | (value == 0)
    return points.astype(real)[keep] + np.nan_to_num(steps[keep]), np.nan_to_num(lengths[keep]), squares[keep]


def normal_derivatives(shape, points, normals, order, *, letters=None, offset=0.0):
    """d^k omega/d nu^k for k = 0..order, shape (order + 1, points), along the unit normals.

    With `offset`, at point + offset*normal: the one-sided limit of an unsigned
    field, which has a kink on its curve, is approached from there.
    """
    series = Expansion(shape, letters).series(points + REAL(offset) * normals, normals, order)
    return series * np.array([math.factorial(k) for k in range(order + 1)], REAL)[:, None]


def assert_normalised(
    shape,
    order,
    count=200,
    *,
    bounds=None,
    letters=None,
    seed=0,
    clearance=1e-2,
    away_from=(),
    gradient_tolerance=1e-12,
    higher_tolerance=1e-9,
):
    """|gradient| = 1 on the boundary to 1e-12, and the normal derivatives 2..order are zero.

    The k-th derivative is compared times extent**(k - 1). Returns the points.
    """
    points, normals = boundary_points(
        shape, count, bounds=bounds, letters=letters, seed=seed, clearance=clearance, away_from=away_from
    )
    gradients = Expansion(shape, letters).value_and_gradient(points)[1]
    assert_close(np.sqrt((gradients**2).sum(axis=1)), np.ones(count), atol=gradient_tolerance)
    extent = float(np.ptp(np.array(bounds or shape.box.ends, float), axis=1).max())
    derivatives = normal_derivatives(shape, points, normals, order, letters=letters)
    for k in range(2, order + 1):
        assert_close(derivatives[k] * extent ** (k - 1), np.zeros(count), atol=higher_tolerance)
    return points


def random_motion(shape, seed=0, *, bounds=None):
    """The shape turned and moved at random, by substitution of exact rationals; its bounds are moved along."""
    random = np.random.default_rng(seed)
    matrix = sp.Matrix(_rotation(shape.dimension, random))
    move = sp.Matrix([sp.Rational(int(random.integers(-30, 31)), 10) for _ in shape.coordinates])
    old = matrix.T * (sp.Matrix(shape.coordinates) - move)
    expression = shape.expression.xreplace(dict(zip(shape.coordinates, old, strict=True)))
    box = bounds or shape.box.ends
    corners = np.array(list(product(*box))) @ np.array(matrix, float).T + np.array(move.T, float)
    moved = list(zip(corners.min(axis=0), corners.max(axis=0), strict=True))
    return Shape(expression, shape.coordinates, letters=shape.letters, bounds=moved)


def _rotation(dimension, random):
    """A rotation with rational entries, from a whole-numbered complex number or quaternion."""
    a, b, c, d = (int(part) for part in random.choice([-7, -5, -4, -3, -2, -1, 1, 2, 3, 4, 5, 6], 4))
    if dimension == 2:
        square = a * a + b * b
        cosine, sine = sp.Rational(a * a - b * b, square), sp.Rational(2 * a * b, square)
        return [[cosine, -sine], [sine, cosine]]
    square = sp.Integer(a * a + b * b + c * c + d * d)
    rows = [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ]
    return [[entry / square for entry in row] for row in rows]
