"""Leaves evaluated one by one through the general machinery: what compiled kernels of a sign form must agree with."""

import numpy as np

from rsym.backends.kernel import compiled, run_in_blocks
from rsym.bounds.intervals import IntervalFunction
from rsym.program.differentiation import gradient
from rsym.program.program import FLOAT64


class LeafKernels:
    """`enclose` and `evaluate` leaves by number, `active` the form."""

    def __init__(self, form, letters, backend="numpy"):
        b = form.builder
        self.form = form
        programs = [
            b.program({"value": leaf, **{f"gradient_{k}": d for k, d in enumerate(gradient(b, leaf))}})
            for leaf in form.leaves
        ]
        self.letters = [float(letters[name]) for name in b.letters]
        self.points = [compiled(program, backend, FLOAT64, lambda made: None) for program in programs]
        self.boxes = [IntervalFunction(program, backend=backend, threads=1) for program in programs]

    def enclose(self, ids, lower, upper):
        value, slope = np.empty((2, len(ids))), np.empty((3, 2, len(ids)))
        for leaf in np.unique(ids):
            some = np.flatnonzero(ids == leaf)
            bounds = self.boxes[leaf](list(lower[:, some]), list(upper[:, some]), self.letters)
            value[:, some] = bounds["value"]
            for k in range(3):
                slope[k][:, some] = bounds[f"gradient_{k}"]
        return value, slope

    def evaluate(self, ids, points):
        value, slope = np.empty(len(ids)), np.empty((3, len(ids)))
        for leaf in np.unique(ids):
            some = np.flatnonzero(ids == leaf)
            out = np.empty((4, len(some)))
            run_in_blocks(
                self.points[leaf], [np.ascontiguousarray(row) for row in points[:, some]], self.letters, out, 1
            )
            value[some], slope[:, some] = out[0], out[1:]
        return value, slope

    def active(self, points):
        """The value of the form, and the number of the leaf that gives it."""
        count = points.shape[1]
        nodes = [
            (self.evaluate(np.full(count, k, np.int16), points)[0], np.full(count, k, np.int16))
            for k in range(len(self.form.leaves))
        ]
        for operation, first, second in self.form.gates:
            (u, i), (v, j) = nodes[first], nodes[second]
            take = u < v if operation == "min" else u > v
            nodes.append((np.where(take, u, v), np.where(take, i, j)))
        return nodes[-1]
