"""Loops over the cells of a grid: the matrices and loads of forms on splines, gathered row by row.

The weight is in the form already: of a form B on the derivatives of w*phi it is that on the derivatives of phi, so
a loop knows splines alone. Each cell has a matrix of its own, whoever computes it; they are added in the order of
cells, so results do not depend on threads.
"""

from __future__ import annotations

from typing import Any

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.splines.evaluation import tabulate
from rsym.sampling.compiled import loop, step

LANES = 16  # numbers that are worked on at once


@loop
def pull_back(terms: Ints, tests: Floats, trials: Floats, forms: Floats, out: Floats) -> None:
    """Forms (n, kinds, kinds) on the derivatives of products, as forms on those of their second factors.

    tests, trials : the derivatives (kinds, n) of the first factors.
    """
    kinds = forms.shape[1]
    for k in range(len(forms)):
        for i in range(kinds):
            for j in range(kinds):
                out[k, i, j] = 0.0
        for a in range(len(terms)):
            first = terms[a, 3] * tests[terms[a, 1], k]
            for b in range(len(terms)):
                value = forms[k, terms[a, 0], terms[b, 0]]
                if value != 0.0:
                    out[k, terms[a, 2], terms[b, 2]] += value * first * terms[b, 3] * trials[terms[b, 1], k]


@loop
def pull_back_loads(terms: Ints, tests: Floats, loads: Floats, out: Floats) -> None:
    """Loads (n, kinds, functions) likewise."""
    for k in range(len(loads)):
        for i in range(loads.shape[1]):
            for j in range(loads.shape[2]):
                out[k, i, j] = 0.0
        for a in range(len(terms)):
            first = terms[a, 3] * tests[terms[a, 1], k]
            for j in range(loads.shape[2]):
                out[k, terms[a, 2], j] += first * loads[k, terms[a, 0], j]


@step
def spread(table: Floats, local: Ints, kinds: Ints, phi: Floats) -> None:
    """The derivatives (kinds, splines) of tensor products of what is tabulated."""
    last, wide = len(table) - 1, table.shape[2]
    for kind in range(len(kinds)):
        along = table[last, kinds[kind, last]]
        for row in range(0, len(local), wide):
            value = 1.0
            for axis in range(last):
                value *= table[axis, kinds[kind, axis], local[row, axis]]
            for spline in range(wide):
                phi[kind, row + spline] = value * along[spline]


@loop
def cell_matrices(
    begins: Ints,
    chosen: Ints,
    cells: Ints,
    points: Floats,
    forms: Floats,
    lower: Floats,
    size: Floats,
    coefficients: Floats,
    local: Ints,
    kinds: Ints,
    symmetric: bool,
    table: Floats,
    phi: Floats,
    psi: Floats,
    out: Floats,
) -> None:
    """The matrices (splines, splines) of some of the cells, of a symmetric form the lower triangle alone.

    phi, psi : room for (kinds, splines), and `out` for matrices, with columns of 0 up to a multiple of `LANES`.
    """
    count, features = len(local), len(kinds)
    for n in range(len(chosen)):
        c = chosen[n]
        matrix = out[c]
        for i in range(count):
            for j in range(matrix.shape[1]):
                matrix[i, j] = 0.0
        for k in range(begins[c], begins[c + 1]):
            tabulate(points[k], cells[c], lower, size, coefficients, table)
            spread(table, local, kinds, phi)
            for g in range(features):
                for i in range(phi.shape[1]):
                    psi[g, i] = 0.0
                for f in range(features):
                    value = forms[k, f, g]
                    if value != 0.0:
                        for i in range(phi.shape[1]):
                            psi[g, i] += value * phi[f, i]
            for i in range(count):
                # Whole lots of lanes take less time than what is left of one.
                last = min((i // LANES + 1) * LANES, matrix.shape[1]) if symmetric else matrix.shape[1]
                row = matrix[i]
                for g in range(features):
                    value = psi[g, i]
                    other = phi[g]
                    for j in range(last):
                        row[j] += value * other[j]


@loop
def whole_cell_matrices(
    begins: Ints,
    forms: Floats,
    chosen: Ints,
    pairs: Ints,
    parents: Ints,
    along: Floats,
    places: Ints,
    symmetric: bool,
    scratch: Floats,
    out: Floats,
) -> None:
    """The matrices of some of the cells, those of a plain Gauss rule, one axis summed after the other, the last first.

    pairs, parents : of each axis, and each combination of derivatives that is left, which product of two derivatives
        along this axis it is, and which combination of the axes before; -1 behind the last.
    along : (derivatives, points, splines**2), the products along an axis, in all cells and along all axes alike.
    places : where the entry (i, j) of a matrix is in a product of those of the axes.
    scratch : (2, largest) numbers.
    """
    count, points, square = along.shape[0], along.shape[1], along.shape[2]
    wide = round(square**0.5)
    features = forms.shape[1]
    for c in range(len(chosen)):
        first = begins[chosen[c]]
        total = begins[chosen[c] + 1] - first
        given, made = scratch[0], scratch[1]
        for f in range(features):
            for g in range(features):
                for k in range(total):
                    given[(f * features + g) * total + k] = forms[first + k, f, g]
        rest, before = 1, total
        for axis in range(len(pairs) - 1, -1, -1):
            before //= points
            last = 0
            for combination in range(pairs.shape[1]):
                if pairs[axis, combination] >= 0 and parents[axis, combination] >= last:
                    last = parents[axis, combination] + 1
            for k in range(last * before * square * rest):
                made[k] = 0.0
            for combination in range(pairs.shape[1]):
                pair = pairs[axis, combination]
                if pair < 0 or pair >= count:
                    continue
                for q in range(before):
                    target = (parents[axis, combination] * before + q) * square * rest
                    for k in range(points):
                        source = ((combination * before + q) * points + k) * rest
                        products = along[pair, k]
                        if rest == 1:
                            value = given[source]
                            if value != 0.0:
                                row = made[target : target + square]
                                for ij in range(square):
                                    row[ij] += value * products[ij]
                        else:
                            right = given[source : source + rest]
                            for ij in range(square):
                                if symmetric and axis == 0 and ij // wide < ij % wide:
                                    continue
                                value = products[ij]
                                row = made[target + ij * rest : target + ij * rest + rest]
                                for r in range(rest):
                                    row[r] += value * right[r]
            given, made = made, given
            rest *= square
        matrix = out[chosen[c]]
        for i in range(len(matrix)):
            for j in range(i + 1 if symmetric else len(matrix)):
                matrix[i, j] = given[places[i, j]]


@loop
def whole_cell_loads(begins: Ints, loads: Floats, chosen: Ints, phi: Floats, out: Floats) -> None:
    """The loads of such cells; phi : (points, kinds, splines), in all of them alike."""
    for c in range(len(chosen)):
        first, total = begins[chosen[c]], out[chosen[c]]
        for j in range(len(total)):
            row = total[j]
            for i in range(len(row)):
                row[i] = 0.0
            for k in range(len(phi)):
                for f in range(phi.shape[1]):
                    value = loads[first + k, f, j]
                    if value != 0.0:
                        splines = phi[k, f]
                        for i in range(len(row)):
                            row[i] += value * splines[i]


@loop
def cell_loads(
    begins: Ints,
    chosen: Ints,
    cells: Ints,
    points: Floats,
    loads: Floats,
    lower: Floats,
    size: Floats,
    coefficients: Floats,
    local: Ints,
    kinds: Ints,
    table: Floats,
    phi: Floats,
    out: Floats,
) -> None:
    """The loads (functions, splines) of some of the cells."""
    for n in range(len(chosen)):
        c = chosen[n]
        for j in range(out.shape[1]):
            for i in range(len(local)):
                out[c, j, i] = 0.0
        for k in range(begins[c], begins[c + 1]):
            tabulate(points[k], cells[c], lower, size, coefficients, table)
            spread(table, local, kinds, phi)
            for f in range(len(kinds)):
                for j in range(out.shape[1]):
                    value = loads[k, f, j]
                    if value != 0.0:
                        for i in range(len(local)):
                            out[c, j, i] += value * phi[f, i]


@loop
def apply_forms(forms: Floats, functions: Floats, out: Floats) -> None:
    """The loads (n, kinds, functions) that forms (n, kinds, kinds) make of functions (n, kinds, functions)."""
    for k in range(len(forms)):
        for i in range(out.shape[1]):
            for j in range(out.shape[2]):
                out[k, i, j] = 0.0
            for other in range(forms.shape[2]):
                value = forms[k, i, other]
                if value != 0.0:
                    for j in range(out.shape[2]):
                        out[k, i, j] += value * functions[k, other, j]


@loop
def tested_loads(functions: Floats, loads: Floats, out: Floats) -> None:
    """Add the products of functions (n, kinds, functions) and loads (n, kinds, count) to out (functions, count)."""
    for k in range(len(loads)):
        for i in range(functions.shape[1]):
            for f in range(functions.shape[2]):
                value = functions[k, i, f]
                if value != 0.0:
                    for j in range(loads.shape[2]):
                        out[f, j] += value * loads[k, i, j]


@step
def flat_number(cell: Any, local: Any, shape: Ints) -> int:
    """The number of a spline of a cell."""
    flat = 0
    for axis in range(len(shape)):
        flat = flat * shape[axis] + cell[axis] + local[axis]
    return flat


@loop
def gather(
    cells: Ints,
    split: Flags,
    matrices: Floats,
    local: Ints,
    shape: Ints,
    number: Ints,
    symmetric: bool,
    stencil: Floats,
) -> None:
    """Add the matrices of cells to the rows (active, (2*degree + 1)**dimension) of a stencil, cell after cell.

    split : cells that are left out.
    """
    count, dimension = local.shape
    wide = 2 * local[count - 1, 0] + 1
    for c in range(len(cells)):
        if split[c]:
            continue
        for i in range(count):
            row = number[flat_number(cells[c], local[i], shape)]
            for j in range(i + 1 if symmetric else count):
                place, mirrored = 0, 0
                for axis in range(dimension):
                    apart = local[j, axis] - local[i, axis]
                    place = place * wide + apart + wide // 2
                    mirrored = mirrored * wide - apart + wide // 2
                value = matrices[c, i, j]
                stencil[row, place] += value
                if symmetric and j < i:
                    stencil[number[flat_number(cells[c], local[j], shape)], mirrored] += value


@loop
def gather_loads(functions: Ints, loads: Floats, out: Floats) -> None:
    """Add the loads of cells to those (functions, active) of all splines; functions : those of each cell."""
    for c in range(len(functions)):
        for i in range(functions.shape[1]):
            at = functions[c, i]
            for j in range(len(out)):
                out[j, at] += loads[c, j, i]


@loop
def compressed(
    stencil: Floats,
    active: Ints,
    offsets: Ints,
    shape: Ints,
    number: Ints,
    begins: Ints,
    columns: Ints,
    values: Floats,
) -> int:
    """The entries of a stencil by rows, those that are 0 left out; how many there are."""
    found = 0
    for row in range(len(active)):
        begins[row] = found
        for place in range(len(offsets)):
            value = stencil[row, place]
            if value != 0.0:
                rest, flat, times = active[row], 0, 1
                for axis in range(len(shape) - 1, -1, -1):
                    flat += (rest % shape[axis] + offsets[place, axis]) * times
                    times *= shape[axis]
                    rest //= shape[axis]
                columns[found] = number[flat]
                values[found] = value
                found += 1
    begins[len(active)] = found
    return found
