"""An opponent of pictures: bodies of balls, boxes and rods, of any size, thick or thin, and what rays meet by algebra.

Where a ray goes into and out of each piece is known in closed form, so where it meets the body is, whatever is joined,
cut out or hollowed to a wall. Some pieces are typed as steep functions or jumps. A picture shows all of the body; a ray
that is decided meets what it meets, at its depth; and what lies between rays, however thin, is painted.

    python tests/opponent/hunt.py pictures --count 2000 --start 1
"""

from __future__ import annotations

import random
import warnings

import numpy as np
import sympy as sp
from scipy import ndimage

import rsym
from rsym import x, y, z

SIZE = (32, 24)
DEPTH, GRAZE = 1e-7, 1e-9  # of the distance from the eye
WITHIN = 9  # rays along a side of a pixel that look what is between its middle and its sides


class Piece:
    """A ball, a box or a rod along z at a place: half sizes (3,), of a ball and a rod the first is the radius."""

    def __init__(self, chance, kind=None):
        self.kind = kind or chance.choice(("ball", "box", "rod"))
        self.middle = np.array([chance.uniform(-2, 2) for _ in range(3)])
        half = [10 ** chance.uniform(-0.7, 0.3) for _ in range(3)]
        if chance.random() < 0.3:  # a mast, a needle or a plate
            half[0] *= 10 ** chance.uniform(-3, -0.5)
        if chance.random() < 0.2:
            half[2] *= 10 ** chance.uniform(0.3, 1)
        self.half = np.array(half) if self.kind == "box" else np.array([half[0], half[0], half[2]])
        if self.kind == "ball":
            self.half[:] = half[0]
        self.typed = chance.choice(("plain", "plain", "plain", "tanh", "sign", "Piecewise"))

    def smaller(self, wall):
        """The same without a wall around it."""
        inner = object.__new__(Piece)
        inner.__dict__.update(self.__dict__, half=self.half - wall)
        return inner

    def shape(self):
        """As rsym has it, at rational numbers that are the floats."""
        middle, half = ([sp.Rational(float(value)) for value in row] for row in (self.middle, self.half))
        if self.kind == "box":
            return rsym.box(*(2 * side for side in half), centre=middle)
        if self.kind == "rod":
            return rsym.cylinder(half[0], 2 * half[2], middle)
        value = half[0] ** 2 - sum((one - place) ** 2 for one, place in zip((x, y, z), middle, strict=True))
        return rsym.Shape(
            {
                "plain": value,
                "tanh": sp.tanh(300 * value),
                "sign": sp.sign(value),
                "Piecewise": sp.Piecewise((1 + x**2, value > 0), (value, True)),
            }[self.typed],
            (x, y, z),
        )

    def met(self, start, way):
        """Where rays (n, 3) go in and out (2, n): equal where they miss."""
        start = start - self.middle
        with np.errstate(all="ignore"):
            ends = np.sort([(side - start) / way for side in (-self.half, self.half)], axis=0)
        axes = {"ball": [0, 1, 2], "rod": [0, 1], "box": []}[self.kind]
        first, last = (np.delete(row, axes, axis=1) for row in ends)
        first, last = first.max(axis=1, initial=-np.inf), last.min(axis=1, initial=np.inf)
        if axes:
            o, d = start[:, axes], way[:, axes]
            a, b, c = (d * d).sum(axis=1), (o * d).sum(axis=1), (o * o).sum(axis=1) - self.half[0] ** 2
            root = np.sqrt(np.maximum(b * b - a * c, 0))
            first, last = np.maximum(first, (-b - root) / a), np.minimum(last, (-b + root) / a)
        return np.array([first, np.maximum(first, last)])


class Body:
    """Some pieces joined, some of them hollow, some cut out."""

    def __init__(self, seed):
        self.chance = chance = random.Random(seed)
        self.pieces, self.signs = [], []
        for number in range(chance.randint(1, 3)):
            cut = number and chance.random() < 0.3
            piece = Piece(chance)
            self.pieces.append(piece)
            self.signs.append("-" if cut else "|")
            if not cut and chance.random() < 0.3:
                self.pieces.append(piece.smaller(piece.half.min() * 10 ** chance.uniform(-5, -0.5)))
                self.signs.append("-")
        self.family = "hollow" if len(self.pieces) > 1 and self.signs[1] == "-" else "joined"
        self.camera = rsym.Camera(chance.uniform(-180, 180), chance.uniform(-80, 80))

    def __str__(self):
        rows = zip(self.signs, self.pieces, strict=True)
        return " ".join(f"{sign} {one.typed} {one.kind}({one.half}, {one.middle})" for sign, one in rows)

    def shape(self):
        """As rsym has it."""
        made = None
        for sign, piece in zip(self.signs, self.pieces, strict=True):
            shape = piece.shape()
            made = shape if made is None else made | shape if sign == "|" else made - shape
        return made

    def inside(self, held):
        """Whether what lies in pieces (pieces, ...) lies in the body."""
        found = np.zeros(held.shape[1:], np.bool_)
        for sign, own in zip(self.signs, held, strict=True):
            found = found | own if sign == "|" else found & ~own
        return found

    def first(self, start, way):
        """Where rays meet the body first, inf if they do not, and whether that is sure."""
        spans = np.array([piece.met(start, way) for piece in self.pieces])
        ends = np.sort(spans.reshape(-1, len(start)), axis=0)
        middle = (ends[1:] + ends[:-1]) / 2
        held = (spans[:, None, 0] < middle) & (middle < spans[:, None, 1])
        within = self.inside(held) & (middle > 0) & (ends[1:] > ends[:-1])
        depth = np.where(within.any(axis=0), ends[within.argmax(axis=0), np.arange(len(start))], np.inf)
        size = np.linalg.norm(start, axis=1)
        # Beside an edge or an outline, and in a sheet, roundings decide.
        spans = np.abs(np.diff(spans, axis=1))[:, 0]
        sure = ~((np.diff(ends, axis=0) < GRAZE * size) & (np.diff(ends, axis=0) > 0)).any(axis=0)
        return depth, sure & ~((spans > 0) & (spans < np.sqrt(GRAZE) * size)).any(axis=0)


case = Body


def asked(case):
    """A word, and rays that are wrong and not told."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            image = rsym.render(case.shape(), camera=case.camera, size=SIZE, background=None)
        except rsym.RsymError as error:
            return error.code, [] if error.code in ("empty", "no-extent") else [str(error)]
    rows, columns = np.indices(image.depth.shape).reshape(2, -1)
    start, way = image.view.rays(columns, rows)
    start = np.broadcast_to(start, way.shape)
    depth, sure = case.first(start, np.broadcast_to(way, start.shape))
    found, undecided = image.depth.ravel(), image.undecided.ravel()
    found = np.where(np.isfinite(found), found, np.inf)
    with np.errstate(invalid="ignore"):
        same = (found == depth) | (np.abs(found - depth) <= DEPTH * (1 + np.linalg.norm(start, axis=1)))
    wrong = np.flatnonzero(sure & ~undecided & ~same)
    said = [
        f"{len(wrong)} rays, as {columns[k]}, {rows[k]}: depth {found[k]:.9g} for {depth[k]:.9g}" for k in wrong[:1]
    ]
    word = "told" if undecided.any() else "decided"
    if not any("thinner than a pixel" in str(one.message) for one in told):
        said += passed_by(case, image)
    return word, said + cut_off(case, image)


def passed_by(case, image):
    """Pixels where the body is between the rays through middles, none of which meet it nearby, and nothing is shown."""
    columns, rows = ((np.arange(WITHIN * side) + 0.5) / WITHIN - 0.5 for side in SIZE)
    columns, rows = (one.ravel() for one in np.meshgrid(columns, rows))
    start, way = image.view.rays(columns, rows)
    depth, sure = case.first(np.broadcast_to(start, way.shape), np.broadcast_to(way, start.shape))
    there = np.zeros(SIZE[::-1], np.bool_)
    met = sure & np.isfinite(depth)
    there[np.rint(rows[met]).astype(int), np.rint(columns[met]).astype(int)] = True
    nearby = ndimage.binary_dilation(np.isfinite(image.depth) | image.undecided, np.ones((5, 5)))
    missing = np.argwhere(there & ~nearby & (np.asarray(image)[..., 3] == 0))
    return (
        [f"{len(missing)} pixels are empty, as {missing[0][::-1]}, and hold some of the body"] if len(missing) else []
    )


def cut_off(case, image):
    """Ends of the body along the axes of the picture that it does not show."""
    directions = np.random.default_rng(1).normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    said = []
    for sign, piece in zip(case.signs, case.pieces, strict=True):
        # Rays from around to the middle of a piece that is joined meet the body somewhere.
        if sign == "|":
            start = piece.middle - directions * (10 * np.linalg.norm(piece.half) + 100)
            depth, sure = case.first(start, directions)
            points = (start + depth[:, None] * directions)[sure & np.isfinite(depth)]
            places = np.array(image.view.project(points)[0]) if len(points) else np.empty((0, 2))
            beyond = ((places < -1) | (places > np.array(SIZE))).any(axis=1)
            if beyond.any():
                said.append(f"{points[beyond][0]} of the body lies beyond the picture")
    return said
