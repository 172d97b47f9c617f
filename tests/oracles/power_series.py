"""Power series of functions in extended precision, many points at once: an oracle that knows no code of rsym."""

import numpy as np
import sympy as sp

REAL = np.longdouble


class Series:
    """A power series in t for each of many points: coefficients of shape (order + 1, points)."""

    def __init__(self, coefficients):
        self.c = coefficients

    @classmethod
    def constant(cls, value, like):
        coefficients = np.zeros_like(like.c)
        coefficients[0] = value
        return cls(coefficients)

    def __add__(self, other):
        return Series(self.c + other.c)

    def __sub__(self, other):
        return Series(self.c - other.c)

    def __mul__(self, other):
        a, b = self.c, other.c
        return Series(np.stack([np.sum(a[: k + 1] * b[k::-1], axis=0) for k in range(len(a))]))

    def __truediv__(self, other):
        a, b, q = self.c, other.c, np.zeros_like(self.c)
        for k in range(len(a)):
            q[k] = (a[k] - np.sum(q[:k] * b[k:0:-1], axis=0)) / b[0]
        return Series(q)

    def integral(self, value, slope):
        """The series that begins with `value` and whose derivative in t is slope(t)*self'(t)."""
        v = np.zeros_like(self.c)
        v[0] = value
        for k in range(1, len(v)):
            v[k] = sum(i * self.c[i] * slope.c[k - i] for i in range(1, k + 1)) / k
        return Series(v)

    def power(self, exponent):
        """A constant power; a whole one by multiplication, which a base of zero survives."""
        if exponent == int(exponent):
            result, base = Series.constant(1, self), self
            for bit in bin(abs(int(exponent)))[:1:-1]:
                result = result * base if bit == "1" else result
                base = base * base
            return result if exponent > 0 else Series.constant(1, self) / result
        u, v = self.c, np.zeros_like(self.c)
        v[0] = np.sqrt(u[0]) ** (2 * exponent)
        for k in range(1, len(v)):
            v[k] = sum((exponent * i - (k - i)) * u[i] * v[k - i] for i in range(1, k + 1)) / (k * u[0])
        return Series(v)

    def exp(self):
        v = np.zeros_like(self.c)
        v[0] = np.exp(self.c[0])
        for k in range(1, len(v)):
            v[k] = sum(i * self.c[i] * v[k - i] for i in range(1, k + 1)) / k
        return Series(v)

    def sine_and_cosine(self):
        s, c = np.zeros_like(self.c), np.zeros_like(self.c)
        s[0], c[0] = np.sin(self.c[0]), np.cos(self.c[0])
        for k in range(1, len(s)):
            s[k] = sum(i * self.c[i] * c[k - i] for i in range(1, k + 1)) / k
            c[k] = -sum(i * self.c[i] * s[k - i] for i in range(1, k + 1)) / k
        return Series(s), Series(c)

    def step(self, function):
        """A function that is constant near every point."""
        return Series.constant(function(self.c[0]), self)


def _atan(u):
    return u.integral(np.arctan(u.c[0]), Series.constant(1, u) / (Series.constant(1, u) + u * u))


def _atan2(v, u):
    first, second = (Series.constant(part.c[0], part) for part in (u, v))
    turned = _atan((v * first - u * second) / (u * first + v * second))
    return Series.constant(np.arctan2(v.c[0], u.c[0]), u) + turned


def _asin(u):
    return u.integral(np.arcsin(u.c[0]), (Series.constant(1, u) - u * u).power(REAL(-0.5)))


def _hyperbolic(sign):
    def half(u):
        return Series.constant(REAL(0.5), u) * (u.exp() + Series.constant(sign, u) * (u * Series.constant(-1, u)).exp())

    return half


def _chosen(better):
    def choose(first, *others):
        for other in others:
            first = Series(np.where(better(first.c[0], other.c[0]), first.c, other.c))
        return first

    return choose


def piecewise(expression, values):
    result = np.full_like(next(iter(values.values())).c, np.nan)
    for piece, condition in reversed(expression.args):
        symbols = sorted(condition.free_symbols, key=str)
        where = sp.lambdify(symbols, condition)(*(values[symbol].c[0] for symbol in symbols))
        result = np.where(where, values[piece].c, result)
    return Series(result)


FUNCTIONS = {
    sp.exp: Series.exp,
    sp.log: lambda u: u.integral(np.log(u.c[0]), Series.constant(1, u) / u),
    sp.sin: lambda u: u.sine_and_cosine()[0],
    sp.cos: lambda u: u.sine_and_cosine()[1],
    sp.tan: lambda u: (lambda pair: pair[0] / pair[1])(u.sine_and_cosine()),
    sp.sinh: _hyperbolic(-1),
    sp.cosh: _hyperbolic(1),
    sp.tanh: lambda u: _hyperbolic(-1)(u) / _hyperbolic(1)(u),
    sp.asin: _asin,
    sp.acos: lambda u: Series.constant(np.arccos(REAL(0)), u) - _asin(u),
    sp.atan: _atan,
    sp.atan2: _atan2,
    sp.Abs: lambda u: u * u.step(np.sign),
    sp.sign: lambda u: u.step(np.sign),
    sp.floor: lambda u: u.step(np.floor),
    sp.ceiling: lambda u: u.step(np.ceil),
    sp.Mod: lambda u, v: u - v * (u / v).step(np.floor),
    sp.Max: _chosen(np.greater_equal),
    sp.Min: _chosen(np.less_equal),
}
