"""Rays at what is thinner than a pixel, and at steep functions: against spheres, cylinders and planes in closed form.

A case knows by construction where each ray meets the body first, and on which leaf. Rays that pass an edge of the
answer within a thousandth of a pixel are not asked; what is said to be undecided is counted.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import sympy as sp
from oracles.tiers import SEED, examples

import rsym
from rsym import x, y, z
from rsym.errors import RsymWarning
from rsym.sampling import rays as casting
from rsym.sampling.ray_march import ArrayRays

D = 1 - x**2 - y**2 - z**2
BOX = ((-1.3, 1.3),) * 3
SIZE = (64, 48)


def chord(origins, directions, centre, radius):
    """Where rays come into a ball and leave it; inf where they miss it."""
    to = origins - np.array(centre)
    b = (to * directions).sum(axis=-1)
    square = b * b - (to * to).sum(axis=-1) + radius * radius
    root = np.sqrt(np.maximum(square, 0))
    return np.where(square > 0, -b - root, np.inf), np.where(square > 0, root - b, np.inf)


def looked_at(shape, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        return rsym.render(shape, size=SIZE, lines=False, **options)


def wrong(image, depth, wider, leaf=0):
    """How many decided rays meet what they should not or miss what they should meet, elsewhere, or on another leaf.

    Where the body is met, and where one a little wider is, or nothing: inf.
    """
    meets = np.isfinite(depth)
    asked = (meets == np.isfinite(wider)) & ~image.undecided
    other = asked & (meets != (image.leaf >= 0))
    both = asked & meets & (image.leaf >= 0)
    with np.errstate(invalid="ignore"):
        away = both & ~(np.abs(image.depth - depth) < 1e-9)
    return int(other.sum()), int(away.sum()), int((both & (image.leaf != leaf)).sum())


def ball_seen(image, radius=1.0):
    """Depths of a ball, and which rays pass its outline by more than a thousandth of a pixel."""
    origins, directions = image.rays
    depth, _ = chord(origins, directions, (0, 0, 0), radius)
    wider = chord(origins, directions, (0, 0, 0), radius + 1e-3 * image.view.pixel)[0]
    return depth, np.where(np.isfinite(depth), depth, wider)


@pytest.mark.parametrize("thickness", [1e-1, 1e-3, 3e-4, 1e-6, 1e-8])
def test_a_shell_is_met_on_its_outside_however_thin_it_is(thickness):
    image = looked_at(rsym.sphere(1) - rsym.sphere(1 - thickness))
    depth, wider = ball_seen(image)
    assert wrong(image, depth, wider) == (0, 0, 0)
    assert not image.undecided.any()


def test_a_shell_of_roundings_is_undecided_and_told():
    body = rsym.sphere(1) - rsym.sphere(1 - 1e-13)
    with pytest.warns(RsymWarning, match="rays undecided"):
        image = rsym.render(body, size=SIZE, lines=False)
    depth, wider = ball_seen(image)
    assert wrong(image, depth, wider)[0] == 0
    assert image.undecided.sum() > 0.9 * np.isfinite(depth).sum()
    assert f"{image.undecided.sum()} rays undecided" in image.status


STEEP = {
    "a profile": sp.tanh(10**6 * D),
    "a sign": sp.sign(D),
    "a jump": sp.Piecewise((1 + x**2, D > 0), (-1 - y**2, True)),
    "tiny": D / 10**300,
    "huge": D * 10**200,
    "a power": D**5,
    "a flat power": D**3 * (2 + x) ** 40,
}


@pytest.mark.parametrize("name", STEEP)
def test_a_steep_ball_is_met_where_a_ball_is(name):
    image = looked_at(rsym.Shape(STEEP[name], (x, y, z), bounds=BOX))
    depth, wider = ball_seen(image)
    assert wrong(image, depth, wider) == (0, 0, 0)
    assert not image.undecided.any()


def test_where_leaves_have_a_cut_nothing_is_undecided():
    """The angle jumps by a turn at y = 0, x < 0, and the form does not: enclosures there stay as wide."""
    lobes = 1 + sp.cos(12 * sp.atan2(y, x)) / 20 - sp.sqrt(x**2 + y**2)
    body = rsym.Shape(rsym.conjunction(lobes, 1 - z**2), (x, y, z), bounds=BOX)
    assert not looked_at(body, camera="front").undecided.any()


def test_without_a_compiler_rays_meet_the_same(monkeypatch):
    shell = rsym.sphere(1) - rsym.sphere(1 - 1e-4)
    bodies = [shell.replace(bounds=BOX), rsym.Shape(STEEP["a jump"], (x, y, z), bounds=BOX)]
    fast = [looked_at(body) for body in bodies]
    monkeypatch.setattr(casting, "default_backend", lambda: "numpy")
    for body, image in zip(bodies, fast, strict=True):
        again = rsym.Shape(body.expression, body.coordinates, bounds=body.bounds)
        assert isinstance(casting.Caster(again)._kernels, ArrayRays)
        other = looked_at(again)
        assert (image.leaf == other.leaf).all()
        met = image.leaf >= 0
        assert np.abs(image.depth[met] - other.depth[met]).max() < 1e-12


def random_walls(seed):
    """A body of balls with thin walls, needles and slits, and its first meeting with rays by Boolean chords."""
    generator = np.random.default_rng([SEED, seed])
    centre = generator.uniform(-0.3, 0.3, 3)
    outer = generator.uniform(0.4, 0.8)
    inner = outer - 10 ** generator.uniform(-7, -1)
    slit = 10 ** generator.uniform(-4, -1)
    place = generator.uniform(-0.2, 0.2)
    normal = generator.normal(size=3)
    normal /= np.linalg.norm(normal)
    cx, cy, cz, a, b, c = (sp.Float(float(v), 17) for v in (*centre, *normal))
    square = (x - cx) ** 2 + (y - cy) ** 2 + (z - cz) ** 2
    distance = a * x + b * y + c * z - sp.Float(place, 17)
    kind = int(generator.integers(3))
    steep = [1, 10**40, sp.Rational(1, 10**40)][int(generator.integers(3))]
    if kind == 0:  # a shell
        expression = rsym.conjunction(outer**2 - square, (square - inner**2) * steep)
    elif kind == 1:  # a disc: a ball between two planes
        expression = rsym.conjunction(outer**2 - square, (slit**2 - distance**2) * steep)
    else:  # a ball with a slit
        expression = rsym.conjunction(outer**2 - square, (distance**2 - slit**2) * steep)
    body = rsym.Shape(expression, (x, y, z), bounds=BOX)

    def first(origins, directions, grow=0.0):
        """With the wall so much thicker, and the slit so much narrower."""
        near, far = chord(origins, directions, centre, outer + grow)
        along, at = directions @ normal, origins @ normal - place
        if kind == 0:
            return near, np.zeros(near.shape, int)
        half = slit + (grow if kind == 1 else -grow)
        ends = np.sort(np.stack([(-half - at) / along, (half - at) / along]), axis=0)
        if kind == 1:
            start = np.maximum(near, ends[0])
            depth = np.where(start < np.minimum(far, ends[1]), start, np.inf)
            return depth, np.where(near >= ends[0], 0, 1)
        inside = (near > ends[0]) & (near < ends[1])
        depth = np.where(inside, np.where(ends[1] < far, ends[1], np.inf), near)
        return depth, np.where(inside, 1, 0)

    return body, first


@pytest.mark.random
@pytest.mark.parametrize("seed", range(examples(60)))
def test_random_walls_needles_and_slits(seed):
    body, first = random_walls(seed)
    generator = np.random.default_rng([SEED, seed, 1])
    eye = rsym.Camera(generator.uniform(-80, 80), generator.uniform(0, 360), [None, 40.0][seed % 2])
    image = looked_at(body, camera=eye)
    origins, directions = image.rays
    depth, leaf = first(origins, directions)
    grow = 1e-6 * image.view.pixel
    around = [first(origins, directions, sign * grow)[0] for sign in (-1, 1)]
    sure = ~image.undecided
    with np.errstate(invalid="ignore"):
        for other in around:
            sure &= (np.isfinite(depth) == np.isfinite(other)) & ~(np.abs(depth - other) > image.view.pixel)
    met, seen = np.isfinite(depth), image.leaf >= 0
    assert (met == seen)[sure].all()
    both = sure & met & seen
    assert np.abs(image.depth[both] - depth[both]).max(initial=0) < 1e-8
    # Where both leaves are met within roundings either is right.
    assert (image.leaf != leaf)[both].sum() <= 0.002 * both.sum() + 1
    assert image.undecided.sum() <= 0.002 * image.undecided.size
