"""Points per second: the value of the car at 2**22 points."""

import numpy as np
from rivals import compiled_c, expanded, lambdified

import rsym

CAR = rsym.paper.car()
POINTS = [np.random.default_rng(0).uniform(*side, 2**22) for side in CAR.bounds]


def in_blocks(function, size=8192):
    """Faster than all at once: temporary arrays stay in the cache, whatever the state of the memory."""
    starts = range(0, len(POINTS[0]), size)
    return np.concatenate([function(*(column[start : start + size] for column in POINTS)) for start in starts])


def test_value_of_the_car(benchmark, contest, tmp_path):
    """Car, 4 194 304 points"""
    contest.points = len(POINTS[0])
    single = [column.astype(np.float32) for column in POINTS]
    plain = lambdified(CAR, expanded(CAR))
    kernels = {
        (dtype, threads): rsym.compile(CAR, dtype=dtype, threads=threads)
        for dtype in ("float64", "float32")
        for threads in (1, None)
    }
    by_numpy = rsym.compile(CAR, backend="numpy", threads=1)
    contenders = {
        "float64, one thread": lambda: kernels["float64", 1](*POINTS)["value"],
        "float64, all threads": lambda: kernels["float64", None](*POINTS)["value"],
        "float32, one thread": lambda: kernels["float32", 1](*single)["value"],
        "float32, all threads": lambda: kernels["float32", None](*single)["value"],
        "backend numpy, one thread": lambda: by_numpy(*POINTS)["value"],
        "sympy.lambdify(cse=True)": lambda: plain(*POINTS),
        "  in blocks of 8192 points": lambda: in_blocks(plain),
        **compiled_c(CAR, POINTS, tmp_path),
    }
    exact = kernels["float64", 1](*POINTS)["value"]
    rounded = kernels["float64", 1](*single)["value"]

    def error(values):
        truth = rounded if values.dtype == np.float32 else exact
        return f"{np.abs(values - truth).max():.1e} from the kernel, of values up to {np.abs(truth).max():.0f}"

    contest.run(benchmark, contenders, error)
