"""Functions: nanoseconds and errors of sin, cos, exp, log, pow and atan2."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from rivals import compiled_c

import rsym
from rsym import x, y

RANDOM = np.random.default_rng(0)
POINTS = [RANDOM.uniform(0.1, 3, 2**20), RANDOM.uniform(-3, 3, 2**20)]
FORMULAS = {
    "sin": (sp.sin(x), lambda u, v: mpmath.sin(u)),
    "cos": (sp.cos(x), lambda u, v: mpmath.cos(u)),
    "exp": (sp.exp(x), lambda u, v: mpmath.exp(u)),
    "log": (sp.log(x), lambda u, v: mpmath.log(u)),
    "pow": (x**y, mpmath.power),
    "atan2": (sp.atan2(x, y), mpmath.atan2),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_a_function(benchmark, contest, tmp_path, name):
    expression, truth = FORMULAS[name]
    shape = rsym.Shape(expression, (x, y))
    contest.title, contest.points = f"{name}, {len(POINTS[0])} points", len(POINTS[0])
    single = [column.astype(np.float32) for column in POINTS]
    llvm, numpy = (rsym.compile(shape, backend=backend, threads=1) for backend in ("llvm", "numpy"))
    half = rsym.compile(shape, dtype="float32", threads=1)
    contenders = {
        "backend llvm, float64": lambda: llvm(*POINTS)["value"],
        "backend llvm, float32": lambda: half(*single)["value"],
        "backend numpy, float64": lambda: numpy(*POINTS)["value"],
        **dict(list(compiled_c(shape, POINTS, tmp_path).items())[:1]),
    }

    def error(values):
        columns = single if values.dtype == np.float32 else POINTS
        worst = 0.0
        with mpmath.workdps(50):
            for got, u, v in zip(values[:2000], *columns, strict=False):
                exact = truth(mpmath.mpf(float(u)), mpmath.mpf(float(v)))
                worst = max(worst, float(abs(float(got) - exact)) / float(np.spacing(abs(values.dtype.type(exact)))))
        return f"{worst:.2f} ulp at the worst of 2000 points"

    contest.run(benchmark, contenders, error)
