"""Lines along the height of cut pieces: where they are inside, and where the form changes its sign, on which leaf.

A value within the tolerance at an end of a line is a zero there: the boundary may run along the end. It is counted in
the piece whose inside it bounds, and only if the signs that leaves have beyond make the outside. Crossings closer to
each other than some tolerances are one; of leaves that have one surface it is the first that bounds. Where some of
them are ends of domains the gates decide: another one bounds if the form is negative with all others negative and the
domains not ended, for then omega is zero there; else it ends. Folds bound nothing: intervals inside end and begin
there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.sampling.compiled import loop, step

SAME = 4.0  # tolerances; breaks and roots so close are one
ACROSS, BETWEEN, FIRST, LAST = 0, 1, 2, 3  # a line for the inside, or on upright leaves: within a piece, at its ends


@step
def form_sign(gates: Any, signs: Any, known: Any) -> int:
    """The sign of a form whose leaves have signs; `known` is room for those of leaves and gates."""
    leaves = len(signs)
    for k in range(leaves):
        known[k] = signs[k]
    for k in range(len(gates)):
        a, b = known[gates[k, 1]], known[gates[k, 2]]
        if gates[k, 0] == 0:
            known[leaves + k] = min(a, b)
        else:
            known[leaves + k] = max(a, b)
    sign: int = known[leaves + len(gates) - 1]
    return sign


@step
def sort_crossings(first: int, last: int, tolerance: float, below: Any, above: Any, root: Any, order: Any) -> int:
    """The leaves of a line that change their sign on it, by height; how many."""
    count = 0
    for k in range(first, last):
        if min(below[k], above[k]) < -tolerance and max(below[k], above[k]) > tolerance:
            j = count
            while j > 0 and root[order[j - 1]] > root[k]:
                order[j] = order[j - 1]
                j -= 1
            order[j] = k
            count += 1
    return count


@step
def start_signs(
    first: int, last: int, tolerance: float, leaf: Any, upright: Any, below: Any, above: Any, past: Any, line: bool,
    signs: Any,
) -> None:  # fmt: skip
    """The signs of leaves just above the lower end; those of upright leaves only if asked.

    A leaf that is zero at both ends has the sign that it has beyond them, or beside the line, if that is one.
    """
    for k in range(first, last):
        if upright[k] and not line:
            continue
        if abs(below[k]) <= tolerance and abs(above[k]) <= tolerance and past[0, k] * past[1, k] > 0:
            signs[leaf[k]] = past[0, k]
        elif abs(below[k]) <= tolerance:
            signs[leaf[k]] = 1 if above[k] > 0 else -1
        else:
            signs[leaf[k]] = 1 if below[k] > 0 else -1


@step
def first_bounding(gates: Any, domains: Any, signs: Any, known: Any, here: Any) -> int:
    """Of the leaves marked in `here`, which have one surface, the one that bounds there; -1 if there are none.

    `signs` are those of the leaves on one side; those of leaves here are lost.
    """
    face, end = -1, -1
    for k in range(len(signs)):
        if here[k]:
            signs[k] = 1 if domains[k] else -1
            if domains[k] and end < 0:
                end = k
            elif not domains[k] and face < 0:
                face = k
    if face < 0 or (end >= 0 and form_sign(gates, signs, known) > 0):
        face = end
    return face


@step
def bounding(
    gates: Any, domains: Any, folds: Any, first: int, last: int, tolerance: float, leaf: Any, upright: Any, value: Any,
    past: Any, signs: Any, known: Any, beyond: Any, here: Any,
) -> int:  # fmt: skip
    """The leaf along which the boundary runs at an end of a line that is inside there; -1 if none.

    `past` are signs beyond the end; 0 the other one.
    """
    found = -1
    for k in range(len(signs)):
        beyond[k], here[k] = signs[k], False
    for k in range(first, last):
        if not upright[k] and abs(value[k]) <= tolerance:
            beyond[leaf[k]] = past[k] if past[k] != 0 else -signs[leaf[k]]
            here[leaf[k]] = signs[leaf[k]] > 0 and not folds[leaf[k]]
    if form_sign(gates, beyond, known) <= 0:
        found = first_bounding(gates, domains, beyond, known, here)
    return found


@step
def note(room: Any, numbers: Any, count: int, low: float, high: float, weight: float, line: int, leaf: int) -> int:
    """Write down an interval of a line; how many there are then."""
    room[0, count], room[1, count], room[2, count] = low, high, weight
    numbers[0, count], numbers[1, count] = line, leaf
    return count + 1


@step
def cross(start: int, count: int, tolerance: float, leaf: Any, root: Any, order: Any, signs: Any) -> int:
    """Change the signs of the leaves that cross where the first of them does; the number of the next one."""
    number = start
    while number < count and root[order[number]] - root[order[start]] <= SAME * tolerance:
        k = leaf[order[number]]
        signs[k] = -signs[k]
        number += 1
    return number


@loop
def walk_inside(
    gates: Any, domains: Any, folds: Any, tolerance: float, ends: Any, weight: Any, begin: Any, leaf: Any,
    upright: Any, below: Any, above: Any, root: Any, past: Any, signs: Any, panels: Any, panel_numbers: Any,
    edges: Any, edge_numbers: Any, sizes: Any, order: Any,
) -> None:  # fmt: skip
    """The intervals inside and the crossings of the boundary on each line between `ends`.

    Some leaves are ends of `domains`: of those that have one surface another one bounds; `folds` bound nothing.
    `signs` (lines, leaves) are those of leaves that do not matter; others are found and changed on the way.
    """
    known, beyond = np.empty(signs.shape[1] + len(gates), np.int8), np.empty(signs.shape[1], np.int8)
    here = np.empty(signs.shape[1], np.bool_)
    inner, outer = 0, 0
    for line in range(len(weight)):
        first, last, own = begin[line], begin[line + 1], signs[line]
        count = sort_crossings(first, last, tolerance, below, above, root, order)
        start_signs(first, last, tolerance, leaf, upright, below, above, past, True, own)
        at, top, share = ends[0, line], ends[1, line], weight[line]
        inside = form_sign(gates, own, known) > 0
        if inside:
            found = bounding(
                gates, domains, folds, first, last, tolerance, leaf, upright, below, past[0], own, known, beyond, here
            )
            if found >= 0:
                outer = note(edges, edge_numbers, outer, at, at, share, line, found)
        number = 0
        while number < count:
            place = root[order[number]]
            following = cross(number, count, tolerance, leaf, root, order, own)
            now = form_sign(gates, own, known) > 0
            if now != inside:
                for k in range(len(own)):
                    beyond[k], here[k] = own[k], False
                for j in range(number, following):
                    k = leaf[order[j]]
                    here[k] = (own[k] > 0) == now and not folds[k]
                found = first_bounding(gates, domains, beyond, known, here)
                outer = note(edges, edge_numbers, outer, place, place, share, line, found)
                if inside:
                    inner = note(panels, panel_numbers, inner, at, place, share, line, -1)
                at = place
            elif inside:
                folded = False
                for j in range(number, following):
                    folded = folded or folds[leaf[order[j]]]
                if folded and place > at:
                    inner = note(panels, panel_numbers, inner, at, place, share, line, -1)
                    at = place
            inside, number = now, following
        if inside:
            inner = note(panels, panel_numbers, inner, at, top, share, line, -1)
            found = bounding(
                gates, domains, folds, first, last, tolerance, leaf, upright, above, past[1], own, known, beyond, here
            )
            if found >= 0:
                outer = note(edges, edge_numbers, outer, top, top, share, line, found)
    sizes[0], sizes[1] = inner, outer


@loop
def walk_parts(
    tolerance: float, ends: Any, weight: Any, begin: Any, leaf: Any, upright: Any, below: Any, above: Any, root: Any,
    walls: Any, panels: Any, panel_numbers: Any, edges: Any, edge_numbers: Any, sizes: Any, order: Any,
) -> None:  # fmt: skip
    """All intervals between crossings on each line, and the crossings of walls; ~leaf where one is at an end.

    A wall at an end belongs to the piece in which it is positive.
    """
    inner, outer = 0, 0
    for line in range(len(weight)):
        first, last, at, share = begin[line], begin[line + 1], ends[0, line], weight[line]
        count = sort_crossings(first, last, tolerance, below, above, root, order)
        for end in range(2):
            found = -1
            for k in range(first, last):
                here, there = (below[k], above[k]) if end == 0 else (above[k], below[k])
                if walls[k] and not upright[k] and found < 0 and abs(here) <= tolerance and there > tolerance:
                    found = k
            if found >= 0:
                outer = note(edges, edge_numbers, outer, ends[end, line], ends[end, line], share, line, ~leaf[found])
        number = 0
        while number < count:
            here, found = root[order[number]], -1
            while number < count and root[order[number]] - here <= SAME * tolerance:
                k = order[number]
                if walls[k] and (found < 0 or leaf[k] < leaf[found]):
                    found = k
                number += 1
            if found >= 0:
                outer = note(edges, edge_numbers, outer, here, here, share, line, leaf[found])
            if here > at:
                inner = note(panels, panel_numbers, inner, at, here, share, line, -1)
            at = here
        if ends[1, line] > at:
            inner = note(panels, panel_numbers, inner, at, ends[1, line], share, line, -1)
    sizes[0], sizes[1] = inner, outer


@loop
def walk_upright(
    gates: Any, domains: Any, folds: Any, tolerance: float, ends: Any, kind: Any, weight: Any, begin: Any, leaf: Any,
    upright: Any, below: Any, above: Any, root: Any, past: Any, left: Any, right: Any, edges: Any, edge_numbers: Any,
    sizes: Any, order: Any,
) -> None:  # fmt: skip
    """The intervals of lines on upright leaves where the inside is on one side only.

    `left`, `right` (lines, leaves) are the signs of leaves that stand there, on either side.
    """
    known, beyond = np.empty(left.shape[1] + len(gates), np.int8), np.empty(left.shape[1], np.int8)
    here = np.empty(left.shape[1], np.bool_)
    outer = 0
    for line in range(len(kind)):
        first, last = begin[line], begin[line + 1]
        count = sort_crossings(first, last, tolerance, below, above, root, order)
        start_signs(first, last, tolerance, leaf, upright, below, above, past, False, left[line])
        start_signs(first, last, tolerance, leaf, upright, below, above, past, False, right[line])
        at, number = ends[0, line], 0
        while number <= count:
            end = root[order[number]] if number < count else ends[1, line]
            one, other = form_sign(gates, left[line], known) > 0, form_sign(gates, right[line], known) > 0
            # Beyond an end of the piece, the boundary belongs to the side that is inside.
            mine = kind[line] == BETWEEN or (kind[line] == FIRST and other) or (kind[line] == LAST and one)
            if one != other and mine and end > at:
                for j in range(left.shape[1]):
                    beyond[j], here[j] = left[line, j], False
                for k in range(first, last):
                    j = leaf[k]
                    stands = upright[k] and not folds[j]
                    here[j] = stands and left[line, j] != right[line, j] and (left[line, j] > 0) == one
                found = first_bounding(gates, domains, beyond, known, here)
                outer = note(edges, edge_numbers, outer, at, end, weight[line], line, found)
            at, following = end, number + 1
            if number < count:
                following = cross(number, count, tolerance, leaf, root, order, left[line])
                cross(number, count, tolerance, leaf, root, order, right[line])
            number = following
    sizes[0] = outer
