"""Principal curvatures of a surface and their gradients along it, in float64 from the third derivatives of omega.

With unit tangent vectors u, v, w, the normal N = grad F/g that points inwards and II(u, v) = -F_uv/g, the derivative
of the second fundamental form is

    C(u, v, w) = -(F_uvw + II(u, v) F_wN + II(v, w) F_uN + II(w, u) F_vN)/g,

symmetric by Codazzi's equations, and the derivative of a principal curvature k with the direction e along v is
C(e, e, v).
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from rsym.arrays import Floats
from rsym.backends.kernel import run_in_blocks
from rsym.backends.registry import make_function
from rsym.program.expansion import expand
from rsym.program.precision import FLOAT64
from rsym.verify.boxes.local import Model

QUANTITIES = ("smaller principal curvature", "larger principal curvature", "mean curvature")


class CurvedSurface:
    """The surface omega = 0 with what bends it, at any points near it."""

    def __init__(self, model: Model) -> None:
        self._places = [index for order in range(4) for index in combinations_with_replacement(range(3), order)]
        nodes = {}
        for index in self._places:
            node = model.root
            for axis in index:
                node = model.gradient(node)[axis]
            nodes[str(index)] = node
        program = model.builder.program(nodes)
        self._function = make_function(expand(program), "numpy", FLOAT64)
        self._letters = [float(model.letters[name][0]) for name in program.letters]

    def __call__(self, points: Floats) -> SurfaceBending:
        """What is known at points (n, 3)."""
        out = np.empty((len(self._places), len(points)))
        with np.errstate(all="ignore"):
            run_in_blocks(self._function, list(points.T), self._letters, out, 1)
            return SurfaceBending(dict(zip(self._places, out, strict=True)), len(points))


class SurfaceBending:
    """Offset from the surface, normal, the three `QUANTITIES` (n, 3) and their gradients along it (n, 3, 3)."""

    def __init__(self, partials: dict[tuple[int, ...], Floats], count: int) -> None:
        def tensor(order: int) -> Floats:
            indices = np.ndindex(*(3,) * order)
            rows = [partials[tuple(sorted(index))] for index in indices]
            return np.stack(rows, axis=-1).reshape(count, *(3,) * order)

        gradient, hessian, third = tensor(1), tensor(2), tensor(3)
        slope = np.linalg.norm(gradient, axis=1)
        self.normal = gradient / slope[:, None]
        self.offset = partials[()] / slope
        frame = _frame(self.normal)
        form = -np.einsum("nai,nij,nbj->nab", frame, hessian, frame) / slope[:, None, None]
        good = np.isfinite(form).all(axis=(1, 2))
        values, vectors = np.linalg.eigh(np.where(good[:, None, None], form, 0.0))
        self.directions = np.einsum("nab,nai->nbi", vectors, frame)
        mixed = np.einsum("nai,nij,nj->na", self.directions, hessian, self.normal)
        slopes = np.empty((count, 2, 2))
        for k in range(2):
            for along in range(2):
                e, v = self.directions[:, k], self.directions[:, along]
                bent = np.einsum("nijk,ni,nj,nk->n", third, e, e, v) + values[:, k] * mixed[:, along]
                if k == along:
                    bent += 2 * values[:, k] * mixed[:, k]
                slopes[:, k, along] = -bent / slope
        gradients = np.einsum("nka,nai->nki", slopes, self.directions)
        self.values = np.concatenate([values, values.mean(axis=1, keepdims=True)], axis=1)
        self.gradients = np.concatenate([gradients, gradients.mean(axis=1, keepdims=True)], axis=1)
        self.values[~good] = np.nan


def _frame(normal: Floats) -> Floats:
    """Two unit vectors (n, 2, 3) across each normal."""
    least = np.eye(3)[np.abs(np.nan_to_num(normal)).argmin(axis=1)]
    first = np.cross(normal, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([first, np.cross(normal, first)], axis=1)
