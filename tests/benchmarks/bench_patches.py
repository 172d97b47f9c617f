"""Points of a bicubic patch: a million scattered ones, and a million on a grid."""

import numpy as np
from geomdl import BSpline

from rsym.surfaces.coons.bicubic import BicubicCoons

RANDOM = np.random.default_rng(0)
MATRIX = RANDOM.normal(size=(4, 4, 3))
PATCH = BicubicCoons(MATRIX)
COUNT, SIDE = 10**6, 1000
# Of a hundredth of the points geomdl takes seconds.
GEOMDL_SIDE = 100
TO_BEZIER = np.array([[1, 0, 0, 0], [1, 0, 1 / 3, 0], [0, 1, 0, -1 / 3], [0, 1, 0, 0]])


def blend(t):
    return np.stack([1 - 3 * t**2 + 2 * t**3, 3 * t**2 - 2 * t**3, t - 2 * t**2 + t**3, t**3 - t**2], axis=-1)


def by_einsum(u, v, optimize):
    return np.einsum("pa,abc,pb->pc", blend(u), MATRIX, blend(v), optimize=optimize)


def in_blocks(u, v, size=8192):
    """Faster than all at once: temporary arrays stay in the cache."""
    starts = range(0, len(u), size)
    return np.concatenate([by_einsum(u[k : k + size], v[k : k + size], False) for k in starts])


def bezier_surface(side):
    """The same surface in geomdl."""
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = 3
    points = np.einsum("ia,abc,jb->ijc", TO_BEZIER, MATRIX, TO_BEZIER)
    surface.set_ctrlpts(points.reshape(-1, 3).tolist(), 4, 4)
    surface.knotvector_u = surface.knotvector_v = [0.0] * 4 + [1.0] * 4
    surface.sample_size = side
    return surface


def test_scattered_points_of_a_bicubic_patch(benchmark, contest):
    """Bicubic patch, 1 000 000 scattered points"""
    contest.points = COUNT
    u, v = RANDOM.uniform(size=(2, COUNT))
    surface = bezier_surface(GEOMDL_SIDE)
    few = np.stack([u, v], axis=-1)[: GEOMDL_SIDE**2].tolist()
    contenders = {
        "rsym": lambda: PATCH(u, v),
        "numpy.einsum": lambda: by_einsum(u, v, False),
        "numpy.einsum(optimize=True)": lambda: by_einsum(u, v, True),
        "  in blocks of 8192 points": lambda: in_blocks(u, v),
        "geomdl, from 10 000 points": lambda: np.array(surface.evaluate_list(few)),
    }
    exact = by_einsum(u, v, False)
    shares = {"geomdl, from 10 000 points": COUNT / GEOMDL_SIDE**2}
    contest.run(benchmark, contenders, lambda points: told(points, exact[: len(points)]), shares=shares)


def test_a_grid_on_a_bicubic_patch(benchmark, contest):
    """Bicubic patch, a grid of 1000 by 1000"""
    contest.points = SIDE**2
    line = np.linspace(0, 1, SIDE)
    surface = bezier_surface(GEOMDL_SIDE)

    def on_the_grid(*, optimize):
        return np.einsum("ia,abc,jb->ijc", blend(line), MATRIX, blend(line), optimize=optimize)

    def by_geomdl():
        surface.evaluate()
        return np.array(surface.evalpts).reshape(GEOMDL_SIDE, GEOMDL_SIDE, 3)

    contenders = {
        "rsym": lambda: PATCH.grid(line, line),
        "numpy.einsum": lambda: on_the_grid(optimize=False),
        "numpy.einsum(optimize=True)": lambda: np.ascontiguousarray(on_the_grid(optimize=True)),
        "  coordinate by coordinate in memory": lambda: on_the_grid(optimize=True),
        "geomdl, from 100 by 100": by_geomdl,
    }
    few = np.linspace(0, 1, GEOMDL_SIDE)
    exact = {
        SIDE: on_the_grid(optimize=False),
        GEOMDL_SIDE: np.einsum("ia,abc,jb->ijc", blend(few), MATRIX, blend(few)),
    }
    shares = {"geomdl, from 100 by 100": SIDE**2 / GEOMDL_SIDE**2}
    contest.run(benchmark, contenders, lambda points: told(points, exact[len(points)]), shares=shares)


def told(points, exact):
    return f"{np.abs(points - exact).max():.1e} from numpy.einsum, of values up to {np.abs(exact).max():.0f}"
