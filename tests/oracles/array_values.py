"""Values over arrays in extended precision, each node by its formula in books: an oracle without code of rsym."""

import math

import numpy as np
import sympy as sp

REAL = np.longdouble


def _fold(pair):
    return lambda part, values: _folded(pair, values, len(part.parameters))


def _folded(pair, values, count):
    parameters, (result, *rest) = values[:count], values[count:]
    for value in rest:
        result = pair(result, value, *parameters)
    return result


def _dual(pair):
    return lambda f, g, *parameters: -pair(-f, -g, *parameters)


def _r0(f, g):
    return f + g - np.hypot(f, g)


def _alpha(f, g, a):
    return (f + g - np.sqrt((f - a * g) ** 2 + (1 - a * a) * g**2)) / (1 + a)


def _rp(f, g, p):
    return f + g - (abs(f) ** p + abs(g) ** p) ** (1 / p)


def _circular(f, g, rho, cosine):
    s = f**2 + g**2 - rho**2
    return f + g - np.sqrt(f**2 + g**2 + s * (s - abs(s)) / (8 * rho**2))


def _cubic(f, g, rho, cosine, k):
    return f + g - np.sqrt(f**2 + g**2 + k * np.maximum(rho**2 - f**2 - g**2, 0) ** 3 / rho**4)


def _sardf(f, g, ratio):
    reach, low, high = 1 + ratio, np.minimum(f, g), np.maximum(f, g)
    inner = np.maximum(low, 0)
    outer = np.minimum(np.maximum(high, 0), reach * inner)
    radicand = 2 * reach**2 * inner * outer - (1 + 2 * ratio) * (inner**2 + outer**2)
    arc = (reach * (inner + outer) + np.sqrt(np.maximum(radicand, 0))) / (2 * reach**2 - ratio**2)
    return arc - np.hypot(np.minimum(low, 0), np.minimum(high, 0))


def _size(f, g, m):
    small, large = np.minimum(abs(f), abs(g)), np.maximum(abs(f), abs(g))
    return np.where(small == 0, small, small / (1 + (small / large) ** m) ** (1 / m))


def _trimming(f, t):
    root = np.sqrt(t**2 + f**4)
    return np.hypot(f, np.where(t > 0, f**4 / (2 * (root + t)), (root - t) / 2))


def _triangle(t, period):
    angle = REAL(math.pi) * t / period
    return period / REAL(math.pi) * np.arctan2(np.sin(angle), abs(np.cos(angle)))


SYSTEMS = {
    "R0": _r0,
    "R1": np.minimum,
    "RAlpha": _alpha,
    "R0m": lambda f, g, m: _r0(f, g) * np.hypot(f, g) ** m,
    "Rp": _rp,
    "Circular": _circular,
    "Cubic": _cubic,
    "Sardf": _sardf,
}
NODES = {f"{name}Conjunction": _fold(pair) for name, pair in SYSTEMS.items()}
NODES |= {f"{name}Disjunction": _fold(_dual(pair)) for name, pair in SYSTEMS.items()}
NODES |= {
    "Equivalence": _fold(lambda f, g, m: np.sign(f) * np.sign(g) * _size(f, g, m)),
    "Joining": _fold(_size),
    "Trimming": lambda part, values: _trimming(*values),
    "TriangleWave": lambda part, values: _triangle(*values),
    "Displacement": lambda part, v: v[0] / (1 + (v[3] / v[1]) ** 2 + (v[4] / v[2]) ** 2),
    "AbsolutePower": lambda part, values: abs(values[0]) ** values[1],
    "Choice": lambda part, v: np.where(v[0] > v[1], v[2], np.where(v[0] <= v[1], v[3], np.nan)),
    "Add": lambda part, values: sum(values),
    "Mul": lambda part, values: math.prod(values),
    "Pow": lambda part, v: v[0] ** (int(part.exp) if part.exp.is_Integer else v[1]),
    "Abs": lambda part, values: abs(values[0]),
    "Min": lambda part, values: _folded(np.minimum, values, 0),
    "Max": lambda part, values: _folded(np.maximum, values, 0),
    "atan2": lambda part, values: np.arctan2(*values),
}
NODES |= {f.__name__: lambda part, v, f=f: f(v[0]) for f in (np.sin, np.cos, np.tanh, np.exp, np.log)}


def evaluated(expressions, columns):
    """Values of expressions where symbols have columns of values."""
    like = next(iter(columns.values()))
    known, stack = (
        {symbol: np.asarray(column, REAL) for symbol, column in columns.items()},
        [(e, False) for e in expressions],
    )
    with np.errstate(all="ignore"):
        while stack:
            part, ready = stack.pop()
            if part in known:
                continue
            if not part.args or part.is_Rational:
                known[part] = np.full(len(like), REAL(str(sp.N(part, 25))))
            elif ready:
                known[part] = NODES[type(part).__name__](part, [known[argument] for argument in part.args])
            else:
                stack.append((part, True))
                stack.extend((argument, False) for argument in part.args)
    return [known[expression] for expression in expressions]
