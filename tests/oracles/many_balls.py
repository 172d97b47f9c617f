"""Disjoint discs or balls on a grid: models of many leaves, of which everything is known."""

import math

import numpy as np

import rsym
from rsym import x, y, z


def many_balls(count, dimension, system=None, seed=7):
    """The shape, their centres (n, dimension) and their radii (n,)."""
    generator = np.random.default_rng(seed)
    side = math.ceil(count ** (1 / dimension) - 1e-9)
    axis = (np.arange(side) + 0.5) / side * 2 - 1
    grid = np.stack(np.meshgrid(*[axis] * dimension, indexing="ij")).reshape(dimension, -1).T[:count]
    centres = np.round(grid + generator.uniform(-0.1, 0.1, grid.shape) / side, 6)
    radii = np.round(generator.uniform(0.5, 0.8, count) / side, 6)
    coordinates = (x, y, z)[:dimension]
    parts = [
        rsym.Shape(r**2 - sum((u - a) ** 2 for u, a in zip(coordinates, centre, strict=True)), coordinates)
        for centre, r in zip(centres.tolist(), radii.tolist(), strict=True)
    ]
    whole = rsym.disjunction(*parts, system=rsym.R0 if system is None else system)
    return whole.replace(bounds=((-1.2, 1.2),) * dimension), centres, radii
