"""Slits without width: where a formula is zero inside and the shape is on both sides, because "f or not f" is in it.

An alternative abs(f), or a square, is that too. What is typed so is meant as a slit, and as a set it is none. Where
abs(f) is no alternative, as of mirrored halves, parts share an edge.
"""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds, Shape
from rsym.problems.pointwise import compiled, with_derivatives
from rsym.sampling.labels import LEAST

LATTICE, STEPS = {2: 33, 3: 13}, 30  # places along each axis that Newton's method starts from, and steps
ON, BESIDE = 1e-9, 1e-4  # of the size: how far off zeros are, and places on both sides


def slit_of(shape: Shape, form: SignForm, box: Bounds) -> tuple[float, ...] | None:
    """A place on a slit of the form of a shape, at the defaults of its letters; None where it has none.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import shape_form
    >>> slit = rsym.disc(1) & (rsym.Shape(abs(y), (x, y)) | rsym.half_plane((-1, 0), 0))
    >>> place = slit_of(slit, shape_form(slit), ((-1, 1), (-1, 1)))
    >>> place[0] >= 0, place[1] == 0
    (True, True)
    """
    if not (zeros := _zeros(form)):
        return None
    b, size = form.builder, float(np.ptp(np.array(box, float), axis=1).max())
    leaves = compiled(shape, b, {f"{k}": leaf for k, leaf in enumerate(form.leaves)})

    def value(points: Floats) -> Floats:
        found: Floats = through(form.gates, list(leaves(points)), lambda gate, f, g: LEAST[gate.operation](f, g))[-1]
        return found

    for zero in zeros:
        own = compiled(shape, b, with_derivatives(b, {"": zero}, b.coordinates, 1))
        axes = [np.linspace(low, high, LATTICE[shape.dimension]) for low, high in np.array(box, float)]
        points = np.stack([axis.ravel() for axis in np.meshgrid(*axes)], axis=1)
        with np.errstate(all="ignore"):
            for _ in range(STEPS):
                here, *slopes = own(points)
                points = points - (here / np.sum(np.square(slopes), axis=0) * np.array(slopes)).T
            here, *slopes = own(points)
            steep = np.linalg.norm(slopes, axis=0)
            ways = BESIDE * size * (np.array(slopes) / steep).T
            good = (np.abs(here) <= ON * size * steep) & (np.abs(value(points)) <= ON * size)
            good &= (value(points + ways) > 0) & (value(points - ways) > 0)
        if good.any():
            return tuple(points[int(np.argmax(good))].tolist())
    return None


def _zeros(form: SignForm) -> list[int]:
    """Nodes that are zero on slits: of alternatives that are nowhere negative, or stand beside their negatives."""
    b, found = form.builder, list[int]()

    def join(gate: Gate, one: frozenset[int], other: frozenset[int]) -> frozenset[int]:
        if gate.operation != "max":
            return frozenset()
        for leaf in (joined := one | other):
            node, inner = b.nodes[leaf], {*b.nodes[leaf].arguments}
            if b.neg(leaf) in joined:
                found.append(leaf)
            elif b.nonnegative[leaf] and len(inner) == 1 and node.operation in ("abs", "powi", "mul"):
                found.append(min(inner))
        return joined

    through(form.gates, [frozenset([leaf]) for leaf in form.leaves], join)
    return [*dict.fromkeys(found)]
