"""A B-spline surface of 50 x 50 vertices: rsym against SciPy and geomdl."""

import numpy as np
from geomdl import BSpline, fitting
from scipy.interpolate import NdBSpline, RectBivariateSpline, make_interp_spline

from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface

COUNT, CELLS, FEW = 50, 1000, 100
X, Y = np.meshgrid(np.linspace(0, 3, COUNT), np.linspace(0, 2, COUNT), indexing="ij")
NET = np.stack([X + 0.1 * np.sin(5 * Y), Y + 0.1 * X**2, np.sin(X) * np.cos(Y)], axis=-1)


def ours():
    return BSplineSurface(NET)


def theirs():
    surface = BSpline.Surface()
    surface.degree_u = surface.degree_v = 3
    surface.set_ctrlpts(NET.reshape(-1, 3).tolist(), COUNT, COUNT)
    surface.knotvector_u = surface.knotvector_v = ours().knots[0].tolist()
    return surface


def difference(truth):
    return lambda values: f"{np.abs(values - truth).max():.1e} from SciPy"


def test_a_grid(benchmark, contest):
    """50 x 50 vertices, 10**6 points of a grid"""
    surface = ours()
    places = np.linspace(0, 1, CELLS)
    pairs = np.stack(np.meshgrid(places, places, indexing="ij"), axis=-1)
    scipy = NdBSpline(surface.knots, NET, 3)
    fitpack = [RectBivariateSpline(X[:, 0], Y[0], NET[:, :, axis]) for axis in range(3)]
    for axis, one in enumerate(fitpack):
        one.tck = (*surface.knots, NET[:, :, axis].ravel())
    contenders = {
        "rsym, grid(u, v)": lambda: surface.grid(places, places),
        "SciPy, RectBivariateSpline, 3 times": lambda: np.stack([one(places, places) for one in fitpack], axis=-1),
        "SciPy, NdBSpline": lambda: scipy(pairs),
    }
    contest.points = CELLS**2
    contest.run(benchmark, contenders, difference(scipy(pairs)))


def test_scattered_points(benchmark, contest):
    """50 x 50 vertices, 10**5 scattered points"""
    surface = ours()
    u, v = np.random.default_rng(0).uniform(0, 1, (2, 10**5))
    scipy = NdBSpline(surface.knots, NET, 3)
    contenders = {
        "rsym, patch(u, v)": lambda: surface(u, v),
        "SciPy, NdBSpline": lambda: scipy(np.stack([u, v], axis=-1)),
    }
    contest.points = len(u)
    contest.run(benchmark, contenders, difference(scipy(np.stack([u, v], axis=-1))))


def test_against_geomdl(benchmark, contest):
    """50 x 50 vertices, 10**4 points of a grid"""
    surface, rival = ours(), theirs()
    places = np.linspace(0, 1, FEW)
    shares = np.linspace(0, 1, FEW)
    pairs = [(a, b) for a in shares for b in shares]
    rival.sample_size = FEW

    def whole():
        rival.reset(evalpts=True)
        return np.reshape(rival.evalpts, (FEW, FEW, 3))

    contenders = {
        "rsym, grid(u, v)": lambda: surface.grid(places, places),
        "geomdl, evalpts": whole,
        "geomdl, evaluate_list": lambda: np.reshape(rival.evaluate_list(pairs), (FEW, FEW, 3)),
    }
    contest.points = FEW**2
    truth = NdBSpline(surface.knots, NET, 3)(np.stack(np.meshgrid(places, places, indexing="ij"), axis=-1))
    contest.run(benchmark, contenders, difference(truth), rounds=3)


def test_through_data(benchmark, contest):
    """A surface through 50 x 50 points"""

    def scipy():
        surface = ours_through()
        u, v = surface.parameters
        first = make_interp_spline(u, NET, k=3, t=surface.knots[0]).c
        return make_interp_spline(v, first.swapaxes(0, 1), k=3, t=surface.knots[1]).c.swapaxes(0, 1)

    def ours_through():
        return BSplineSurface.interpolate(NET)

    truth = scipy()
    contenders = {
        "rsym, interpolate": lambda: ours_through().net,
        "geomdl, interpolate_surface": lambda: np.reshape(
            fitting.interpolate_surface(NET.reshape(-1, 3).tolist(), COUNT, COUNT, 3, 3).ctrlpts, NET.shape
        ),
    }
    contest.run(benchmark, contenders, difference(truth), rounds=2)
