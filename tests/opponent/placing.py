"""Germs brought to any place by exact motions and scalings, and windows that hold a defect, cut it, or just miss it."""

from __future__ import annotations

from random import Random

import mpmath
import numpy as np
import sympy as sp

import rsym
from opponent.kinks import Q
from opponent.truth import Case, Germ, Spot, t, u, v, w
from rsym import x, y, z

SPACE = (x, y, z)
LOCAL = (u, v, w)
RATIONAL = (
    (Q(3, 5), Q(4, 5)),
    (Q(-5, 13), Q(12, 13)),
    (Q(0), Q(1)),
    (Q(-1), Q(0)),
    (Q(1), Q(0)),
    (Q(99, 101), Q(-20, 101)),
)
IRRATIONAL = ((sp.sqrt(2) / 2, sp.sqrt(2) / 2), (sp.sqrt(3) / 2, -Q(1, 2)), (sp.cos(1), sp.sin(1)))
PLACES = (Q(0), Q(1, 4), Q(-1, 2), Q(3, 7), Q(-2, 3), Q(1, 3), sp.sqrt(2) / 3, sp.pi / 7, sp.exp(-1))
LENGTHS = (Q(1),) * 6 + (Q(1, 1000), Q(1000), Q(1, 10**6), Q(10**6), Q(22, 7))
NEAR = (Q(1, 10**3), Q(1, 10**6), Q(1, 10**9), Q(1, 10**12))


def _angle(random: Random) -> tuple[sp.Expr, sp.Expr]:
    return random.choice(RATIONAL + RATIONAL[2:5] * 2 + (IRRATIONAL if random.random() < 0.5 else ()))


def rotation(random: Random, dimension: int) -> sp.Matrix:
    """An orthogonal matrix of determinant 1, its entries exact."""
    turn = sp.eye(dimension)
    for first, second in (
        [(0, 1)] if dimension == 2 else random.sample([(0, 1), (1, 2), (0, 2)], random.choice([0, 1, 1, 2]))
    ):
        c, s = _angle(random)
        step = sp.eye(dimension)
        step[first, first] = step[second, second] = c
        step[first, second], step[second, first] = -s, s
        turn = step * turn
    return turn


def number(value: sp.Expr) -> mpmath.mpf:
    """Fifty digits of an exact number."""
    return mpmath.mpf(str(sp.N(value, 50)))


def placed(random: Random, germ: Germ, dimension: int) -> Case:
    """The germ somewhere, turned, in some size, seen through some window."""
    length = random.choice(LENGTHS)
    turn = rotation(random, dimension)
    shift = sp.Matrix([random.choice(PLACES) * length for _ in range(dimension)])
    with mpmath.workdps(50):
        return _placed(random, germ, dimension, length, turn, shift)


def on_an_axis(random: Random, germ: Germ) -> Case:
    """A body of revolution about w, with a coordinate axis for w, anywhere along it, in some size."""
    length, along = random.choice(LENGTHS), random.randrange(3)
    turn = sp.zeros(3)
    for place, other in enumerate([(along + 1) % 3, (along + 2) % 3, along]):
        turn[other, place] = 1
    shift = sp.zeros(3, 1)
    shift[along] = random.choice(PLACES) * length
    with mpmath.workdps(50):
        return _placed(random, germ, 3, length, turn, shift)


def as_it_stands(random: Random, germ: Germ, dimension: int) -> Case:
    """Neither moved nor scaled."""
    with mpmath.workdps(50):
        return _placed(random, germ, dimension, Q(1), sp.eye(dimension), sp.zeros(dimension, 1))


def _placed(random: Random, germ: Germ, dimension: int, length, turn, shift) -> Case:
    space, local = SPACE[:dimension], LOCAL[:dimension]
    back = turn.T * (sp.Matrix(space) - shift) / length
    omega = germ.omega.subs(dict(zip(local, back, strict=True)), simultaneous=True)
    if random.random() < 0.3:
        omega = random.choice([Q(1, 10**6), Q(10**6), Q(-1), Q(7, 3)]) * omega
    spots = [
        Spot(
            tuple(shift + length * turn * sp.Matrix(s.point)),
            s.grade,
            s.turn,
            None if s.jump is None else s.jump / float(length),
        )
        for s in germ.spots
    ]
    centre = [float(number(c)) for c in (spots[0].point if spots else shift)]
    bounds = _window(
        random, centre, [number(c) for c in spots[0].point] if spots else None, germ.reach * float(length), dimension
    )
    inside, unsure = _sorted(spots, bounds)
    if germ.loose and not inside:
        inside, unsure = _along(germ, spots, bounds, lambda point: shift + length * turn * sp.Matrix(point))
    shape = rsym.Shape(omega, space, bounds=bounds, letters=germ.letters or None)
    options = {"letters": germ.ranges} if germ.ranges else {}
    return Case(germ.family, shape, tuple(inside), tuple(unsure), germ.loose, options, float(length))


def _window(random: Random, centre, exact, reach, dimension):
    """Bounds within the reach: the place in the middle, anywhere, exactly on a division, at the edge or just beyond."""
    half = reach / dimension**0.5 * 0.99
    kind = random.choice(["middle", "any", "any", "any", "edge", "miss", "hit"] if exact else ["middle", "any"])
    bounds = []
    for c in centre:
        share = 0.5 if kind == "middle" else random.uniform(0.05, 0.95)
        bounds.append([c - half * share, c + half * (1 - share)])
    axis, side = random.randrange(dimension), random.randrange(2)
    if kind == "edge":
        bounds[axis][side] = centre[axis]
    if kind in ("miss", "hit"):
        away = float(random.choice(NEAR)) * half * (1 if side else -1) * (1 if kind == "hit" else -1)
        bounds[axis][side] = centre[axis] + away
    return tuple((low, high) for low, high in bounds)


def _sorted(spots, bounds):
    """Those certainly within the bounds, and those too near their edge to tell."""
    inside, unsure = [], []
    for spot in spots:
        rooms = [min(number(c) - low, high - number(c)) for c, (low, high) in zip(spot.point, bounds, strict=True)]
        room = min(rooms)
        extent = max(high - low for low, high in bounds)
        scale = max(max(abs(low), abs(high)) for low, high in bounds)
        if room > 1e-14 * extent + 4e-16 * scale:
            inside.append(spot)
        elif room > -1e-14 * extent - 4e-16 * scale:
            unsure.append(spot)
    return inside, unsure


def _along(germ: Germ, spots, bounds, carried):
    """What is known of a defect of which no sample lies within the bounds: many samples of its curve, if it has one."""
    if not germ.curve:
        return [], spots
    path = carried(germ.curve)
    at = sp.lambdify(t, list(path), "numpy")
    points = np.array(np.broadcast_arrays(*at(np.linspace(-0.3, 0.3, 4001))), float)
    low, high = np.array(bounds).T
    room = np.minimum(points - low[:, None], high[:, None] - points).min(axis=0).max()
    near = 1e-14 * (high - low).max() + 4e-16 * np.abs(bounds).max()
    if room < -near:
        return [], []
    return [], spots
