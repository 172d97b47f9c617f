"""Solutions that are known, and what is said of their errors: `python tests/opponent/hunt.py fields`.

u is a polynomial, a wave, a source nearby or a steep layer; the equation diffuses, carries and takes up, with constant
or varying coefficients; the right side and the data are made of it. The true error, in the root of the mean square, may
be three times the estimate, and above thirty times only with a warning.
"""

import warnings

import numpy as np
import sympy as sp

import rsym
from opponent.typings import body, cut, rational
from rsym import x, y
from rsym.logic.sign_form import shape_form
from rsym.program.raising import raised

TIMES, FAR = 3, 30
ROUNDING = 1e-11


def known(random):
    """A function."""
    a, b, c = (rational(random, -2, 2) for _ in range(3))
    kind = ("polynomial", "wave", "source", "layer", "bump")[random.integers(5)]
    made = {
        "polynomial": lambda: a * x**3 + b * x * y**2 + c * y + 1,
        "wave": lambda: sp.sin((2 + a) * x + b) * sp.cosh(y / 2) + c,
        "source": lambda: sp.log((x - 5 - a) ** 2 + (y - b) ** 2),
        "layer": lambda: sp.tanh(3 * (x + a * y / 2 - b / 2)) + c,
        "bump": lambda: sp.exp(-4 * ((x - a / 3) ** 2 + (y - b / 3) ** 2)),
    }[kind]()
    return kind, made


def away(found, u):
    """How far a solution is from another function, in the root of the mean square, of the largest value."""
    rule = found.rule
    truth = rsym.compile(found.shape.replace(expression=sp.sympify(u)), backend="numpy")(*rule.points.T)["value"]
    apart = found.jets(rule.points, 0)[0] - truth
    return np.sqrt(np.sum(rule.weights * apart**2) / np.sum(rule.weights)) / np.abs(truth).max()


def put(question, allowed=("cells", "seam")):
    """The word and what is wrong about the errors that a question finds, each with its estimate."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            found = np.reshape(question(), (-1, 2))
        except rsym.RsymError as refused:
            return f"refused: {refused.code}", [] if refused.code in allowed else [str(refused)]
    error, estimate = max(found, key=lambda pair: (pair[0] - ROUNDING) / pair[1] if pair[1] else pair[0] > ROUNDING)
    if error <= TIMES * estimate + ROUNDING:
        return "within", []
    words = f"error {error:.2e}, estimate {estimate:.2e}"
    if told:
        return "warned", []
    return ("far" if error > FAR * estimate + ROUNDING else "beyond"), [words]


class Case:
    """A shape, an equation and its solution."""

    def __init__(self, family, shape, u, k, beta, c, natural, cells, leaves):
        self.family, self.shape, self.u, self.k, self.beta, self.c = family, shape, u, k, beta, c
        self.natural, self.cells, self.leaves = natural, cells, leaves

    def __str__(self):
        return f"{self.shape.expression} u={self.u} k={self.k} b={self.beta} c={self.c} {self.natural} {self.cells}"


def case(seed):
    """The case of a seed."""
    random = np.random.default_rng(seed)
    kind, shape = body(random)
    typed = cut(random, shape) if random.random() < 0.3 else shape
    what, u = known(random)
    k = (sp.Integer(1), sp.Integer(2), 2 + sp.sin(x), 1 + x**2 + y**2)[random.integers(4)]
    beta = (0, 0) if random.random() < 0.7 else (1, rational(random, -2, 2))
    c = (0, 1, x**2)[random.integers(3)]
    natural = random.random() < 0.3 and kind in ("disc", "ellipse")
    form = shape_form(shape)
    leaves = [raised(form.builder.nodes, leaf) for leaf in form.leaves]
    return Case(f"{what} {kind}", typed, u, k, beta, c, natural, int(random.integers(10, 33)), leaves)


def asked(case):
    """The word and what is wrong."""
    u, k, (p, q), c = case.u, case.k, case.beta, case.c
    flux = [k * sp.diff(u, one) for one in (x, y)]
    f = -sp.diff(flux[0], x) - sp.diff(flux[1], y) + p * sp.diff(u, x) + q * sp.diff(u, y) + c * u
    # u on the boundary, something else inside.
    condition = u + sp.Mul(*case.leaves) * (1 + x / 2)
    if case.natural:
        slope = [sp.diff(case.leaves[0], one) for one in (x, y)]
        length = sp.sqrt(slope[0] ** 2 + slope[1] ** 2)
        outward = -(slope[0] * sp.diff(u, x) + slope[1] * sp.diff(u, y)) / length
        condition = rsym.robin(1, outward + u)
    equation = "-div(k*grad(u)) + dot([p, q], grad(u)) + c*u = f"
    letters = {"k": k, "p": sp.sympify(p), "q": sp.sympify(q), "c": sp.sympify(c), "f": f}

    def question():
        found = rsym.solve(case.shape, equation, condition, letters=letters, cells=case.cells)
        return away(found, u), found.report.estimate

    return put(question)
