"""Points proved by the one-sided derivative of omega along all rays (blow-up).

omega(p + r d) = r H(d) + o(r), uniformly in the direction d (`slopes`), and omega(p) = 0. Where H is not 0, omega has
its sign near p. So, for all small spheres around p:
- H > 0 in all directions, or H < 0: p is an isolated point of the boundary;
- the directions with H > 0 are parted by those with H < 0 (or the other way round): so is the inside. No surface has
  that: both its sides are connected near each of its points. p is a node.
- there is a v to which every limit of grad omega makes an acute angle, in all directions where H may vanish, and
  H(-v) < 0 < H(v): along each line in the direction v near p omega has one zero, where it grows. The boundary is the
  graph of a Lipschitz function over the plane across v: a surface (G0).
- a surface with a tangent plane at p has H >= 0 on one side of it and H <= 0 on the other. So where positive multiples
  of directions with H > 0 add up to one with H < 0, or the other way round, there is none: it is no better than G0.
Directions are points of the cube [-1, 1]^3; its faces are divided where H is not proved to have a sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from rsym.arrays import Floats
from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.local import PRECISE, Model
from rsym.verify.boxes.vanishing import Exact
from rsym.verify.boxes.vectors import sign_of
from rsym.verify.points.directions import same_sign
from rsym.verify.points.slope_rules import Vector
from rsym.verify.points.slopes import Slopes, slopes_of

COARSEST, FINE, FINEST = 2, 5, 7  # halvings of a face: cells of 4 degrees, or of 1
CROWD = 3000  # undecided cells: a closed curve around the cube crosses 200 to 800, an area thousands
TRIED = 60  # directions tried as sums of others
NOTHING = arb(0)


@dataclass(frozen=True, eq=False)
class Rays:
    """The sign of H on cells of the cube of directions: boxes (n, 3, 2), signs (n,), 0 where it is not proved.

    Attributes
    ----------
    slopes : Slopes
        How H and the limits of the gradient are computed.
    """

    slopes: Slopes
    boxes: Floats
    signs: NDArray[np.int8]

    def components(self, sign: int) -> int:
        """How many pieces the directions of a sign certainly fall into."""
        own = self.signs == sign
        possible = own | (self.signs == 0)
        labels = np.full(len(own), -1)
        labels[possible] = connected_components(self._touching[possible][:, possible])[1]
        return len(set(labels[own].tolist()))

    @cached_property
    def _touching(self) -> coo_array:
        low, high = self.boxes[..., 0], self.boxes[..., 1]
        near = np.ones((len(low), len(low)), bool)
        for axis in range(3):
            near &= (low[:, None, axis] <= high[None, :, axis]) & (low[None, :, axis] <= high[:, None, axis])
        return coo_array(near).tocsr()

    @cached_property
    def upward(self) -> tuple[float, ...] | None:
        """A direction v along which omega certainly grows near the boundary, from outside to inside."""
        undecided = [_direction(box) for box in self.boxes[self.signs == 0]]
        gradients = [self.slopes.gradient(direction) for direction in undecided]
        middles = np.array([[float(part.mid()) for part in gradient] for gradient in gradients if gradient is not None])
        if not len(middles) or len(middles) < len(gradients) or not np.isfinite(middles).all():
            return None
        v = tuple(arb(part) for part in _steepest(middles).tolist())
        for direction in undecided:
            growth = self.slopes.growth(direction, v)
            if growth is None or not growth > 0:
                return None
        opposite = tuple(-part for part in v)
        return tuple(map(float, v)) if (self.sign(v), self.sign(opposite)) == (1, -1) else None

    @cached_property
    def is_bent(self) -> bool:
        """Whether there is certainly no tangent plane."""
        middles = self.boxes.mean(axis=2)
        return any(
            self._is_spanned(middles[self.signs == sign], middles[self.signs == -sign], sign) for sign in (1, -1)
        )

    def _is_spanned(self, own: Floats, others: Floats, sign: int) -> bool:
        """Whether directions of one sign add up to one of the other."""
        for direction in others[:: max(1, len(others) // TRIED)]:
            weights, residual = nnls(own.T, direction)
            if residual > 1e-9:
                continue
            total = [NOTHING, NOTHING, NOTHING]
            for at in np.flatnonzero(weights):
                for axis in range(3):
                    total[axis] += arb(float(weights[at])) * arb(float(own[at, axis]))
            if self.sign(tuple(total)) == -sign:
                return True
        return False

    def sign(self, direction: Vector) -> int:
        """The sign of H in some directions, 0 where it is not proved."""
        return _sign(self.slopes, direction)


def rays_at(model: Model, known: Exact, finest: int = FINE) -> Rays | None:
    """The signs of H around a point; None where H is not known, or vanishes on an area.

    Parameters
    ----------
    model : Model
        Without ranges of letters.
    known : Exact
        What is known exactly at the point, on a box that is a neighbourhood of it.
    finest : int
        How often the faces of the cube of directions are halved where H may vanish.

    Examples
    --------
    >>> import rsym
    >>> from fractions import Fraction
    >>> from rsym import x, y, z
    >>> import sympy as sp
    >>> from rsym.verify.boxes.vanishing import exact_at
    >>> model = Model(rsym.Shape(z - sp.sqrt(x**2 + y**2), (x, y, z)), {})
    >>> origin = [arb(0)] * 3
    >>> rays = rays_at(model, exact_at(model, origin, dict.fromkeys("xyz", Fraction(0)), frozenset()))
    >>> rays.components(1), rays.components(-1), rays.upward is not None, rays.is_bent
    (1, 1, True, True)
    """
    with ctx.workprec(PRECISE):
        node = same_sign(known.local, known, model.root)
        if not (known.vanishes(node) or known.vanishes(model.root)):
            return None
        slopes = slopes_of(known.local, known, node)
        if slopes is None:
            return None
        cells, signs = _first_cells(), []
        settled: list[tuple[Floats, int]] = []
        for level in range(COARSEST, finest + 1):
            signs = [_sign(slopes, _direction(box)) for box in cells]
            if level == finest:
                break
            settled += [(box, sign) for box, sign in zip(cells, signs, strict=True) if sign]
            cells = [part for box, sign in zip(cells, signs, strict=True) if not sign for part in _quarters(box)]
            if len(cells) > CROWD:
                return None
        everything = [*settled, *zip(cells, signs, strict=True)]
        boxes = np.array([box for box, _ in everything])
        return Rays(slopes, boxes, np.array([sign for _, sign in everything], np.int8))


def _sign(slopes: Slopes, direction: Vector) -> int:
    return sign_of(slopes.at(direction)[slopes.number])


def _direction(box: Floats) -> Vector:
    return tuple(arb(float(low)).union(arb(float(high))) for low, high in box)


def _first_cells() -> list[Floats]:
    ends = np.linspace(-1, 1, 2**COARSEST + 1)
    cells = []
    for axis, side in product(range(3), (-1.0, 1.0)):
        for a, b in product(range(2**COARSEST), repeat=2):
            cell = [[ends[a], ends[a + 1]], [ends[b], ends[b + 1]]]
            cell.insert(axis, [side, side])
            cells.append(np.array(cell))
    return cells


def _quarters(box: Floats) -> list[Floats]:
    flat = int((box[:, 0] == box[:, 1]).argmax())
    middle = box.mean(axis=1)
    parts = []
    for halves in product((0, 1), repeat=2):
        part, rest = box.copy(), iter(halves)
        for axis in range(3):
            if axis != flat:
                part[axis, 1 - next(rest)] = middle[axis]
        parts.append(part)
    return parts


def _steepest(gradients: Floats) -> Floats:
    """The v in [-1, 1]^3 with the largest least product with the gradients."""
    rows = gradients / np.maximum(np.linalg.norm(gradients, axis=1, keepdims=True), 1e-300)
    bounds = [(-1, 1)] * 3 + [(None, None)]
    ones = np.ones((len(rows), 1))
    found = linprog([0, 0, 0, -1], A_ub=np.hstack([-rows, ones]), b_ub=np.zeros(len(rows)), bounds=bounds)
    return np.asarray(found.x[:3] if found.success else np.zeros(3), dtype=np.float64)
