"""Points inside where a form is zero and all around is not, as of x**2 + y**2 - x**4 - y**4 in the middle."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np
import sympy as sp
from scipy.ndimage import minimum_filter

from rsym.arrays import Floats
from rsym.backends.interpreter import interpret
from rsym.logic.gates import through
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds, Shape
from rsym.sampling.labels import LEAST

LATTICE = {2: 65, 3: 25}  # points along each axis
ZOOMS, CLOSER, ACROSS = 16, 0.3, 9  # lattices, each so much smaller than the one before, of so many points
FALLS = 0.7  # what the least value of a lattice is at most of that before, where there is a zero
MOST = 64  # least values of a lattice that are looked at
AROUND, DIRECTIONS, FEW = 1e-3, 4096, 2e-3  # of the size; points there; of the usual value
ROUNDING = 1e-13  # of the largest value
NEXT = 1e-5  # of the size: a fraction with such a denominator that is a zero is taken for the place
WITHIN = 0.4  # of the distance to what is not inside


class IsolatedZero(NamedTuple):
    """Where it is, and a radius within which all else is inside."""

    place: tuple[sp.Rational, ...]
    radius: sp.Rational

    def ball(self, shape: Shape) -> sp.Expr:
        """A function that is positive within the radius."""
        square = sum((one - at) ** 2 for one, at in zip(shape.coordinates, self.place, strict=True))
        return sp.expand((self.radius**2 - square) / (2 * self.radius))


def isolated_zeros(shape: Shape, form: SignForm, box: Bounds) -> tuple[IsolatedZero, ...]:
    """Those of the form of a shape, at the defaults of its letters.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import shape_form
    >>> shape = rsym.Shape(x**2 + y**2 - x**4 - y**4, (x, y))
    >>> isolated_zeros(shape, shape_form(shape), ((-1.2, 1.2), (-1.2, 1.2)))
    (IsolatedZero(place=(0, 0), radius=5/12),)
    """
    values = _Values(shape, form)
    dimension, low, high = shape.dimension, *np.array(box, float).T
    count = LATTICE[dimension]
    axes = [low[k] + (high[k] - low[k]) * (np.arange(count) + 0.5) / count for k in range(dimension)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    found = values(points.reshape(-1, dimension)).reshape((count,) * dimension)
    with np.errstate(invalid="ignore"):
        least = (found >= 0) & (found <= minimum_filter(found, 3, mode="constant", cval=-np.inf))
    outside, size = points[~(found >= 0)], float(np.max(high - low))
    noise = ROUNDING * float(np.nanmax(np.abs(found)))
    zeros = []
    for place in points[least][:MOST]:
        at = values.nearest_zero(place, (high - low) / count, noise)
        if at is None or not values.positive_around(at, AROUND * size):
            continue
        radius = WITHIN * float(np.min(np.linalg.norm(outside - at, axis=1), initial=size))
        simple = [sp.Rational(Fraction(float(one)).limit_denominator(round(size / NEXT))) for one in at]
        if values(np.array([simple], float))[0] > noise:
            simple = [sp.Rational(float(one)) for one in at]
        zeros.append(IsolatedZero(tuple(simple), sp.Rational(Fraction(radius).limit_denominator(16))))
    return tuple(zeros)


class _Values:
    """The values of a form at points (n, dim)."""

    def __init__(self, shape: Shape, form: SignForm) -> None:
        self.form, self.letters = form, shape.letters.values_with(None)
        self.program = form.builder.program({f"{k}": leaf for k, leaf in enumerate(form.leaves)})

    def __call__(self, points: Floats) -> Floats:
        inputs = {**dict(zip(self.program.coordinates, points.T, strict=True)), **self.letters}
        every = interpret(self.program, inputs)
        leaves = [np.broadcast_to(every[f"{k}"], len(points)) for k in range(len(self.form.leaves))]
        return through(self.form.gates, leaves, lambda gate, one, other: LEAST[gate.operation](one, other))[-1]

    def nearest_zero(self, place: Floats, side: Floats, noise: float) -> Floats | None:
        """Where the form falls to zero about a place, if it does: the least of lattices, each smaller than the last."""
        steps = np.stack(np.meshgrid(*([np.linspace(-1, 1, ACROSS)] * len(place)), indexing="ij"), axis=-1)
        steps = steps.reshape(-1, len(place))
        before = float(self(place[None])[0])
        for _ in range(ZOOMS):
            near = place + steps * side
            found = self(near)
            best = int(np.nanargmin(found))
            if not -noise <= found[best] <= max(FALLS * before, noise):
                return None
            place, before, side = near[best], float(found[best]), side * CLOSER
        return place if before <= noise else None

    def positive_around(self, place: Floats, radius: float) -> bool:
        """Whether the form is so on a circle or a sphere about a place, and nowhere on it nearly zero: on no line."""
        ways = np.random.default_rng(40).normal(size=(DIRECTIONS, len(place)))
        found = self(place + radius * ways / np.linalg.norm(ways, axis=1, keepdims=True))
        return bool(found.min() > FEW * np.median(found))
