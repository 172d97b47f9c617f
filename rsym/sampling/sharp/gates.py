"""What matters in a box: signs of leaves forwards through the gates of a region, needs backwards.

What is needed there is simple if one direction rises on all cones of gradients. The largest smallest cosine that any
direction has with a set of unit vectors is the distance of the origin from their convex hull, and the nearest point of
the hull is that direction; Gilbert's algorithm finds it. On the way every point of the hull refutes what is larger than
its own length, and the few vectors that it is made of are the conflict. A box of gradients needs only its eight
corners: d.g - c|g| is concave in g.

Source: E. G. Gilbert, SIAM J. Control 4 (1966) 61-80.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.sampling.regions.regions import INFINITE, MAX, MIN
from rsym.sampling.sharp.loops import loop, step

DISCARDED, SIMPLE, OPEN, UNRESOLVED = 0, 1, 2, 3

# Of the car at 256**3 3, 5, 12 and 30 turns leave 532, 518, 518 and 518 cells; of the tilted torus of a depth of one
# 644, 620, 584 and 563. What takes longer counts as a conflict and is split.
TURNS = 12


@loop
def reach(first: Any, entries: Any, reached: Any) -> None:
    """Mark the leaves, (regions, leaves), that are entries of regions."""
    for region in range(len(reached)):
        for i in range(first[region], first[region + 1]):
            if entries[i, 0] >= 0:
                reached[region, entries[i, 0]] = True


def judge(
    first: Any,
    entries: Any,
    leaves: int,
    region: Any,
    start: Any,
    leaf: Any,
    skip: Any,
    value: Any,
    gradient: Any,
    cosine: float,
    verdict: Any,
    kept: Any,
) -> None:
    """The verdict of each box and which of its leaves matter; skipped operands of entries are noted.

    `value` (2, m) and `gradient` (3, 2, m) enclose the leaves; a cosine of 1 or more asks for no direction.
    """
    size, most = _most(np.diff(first)), _most(np.diff(start))
    marks, rows = np.zeros((2, leaves), np.int8), np.zeros((2, size), np.int8)
    bounds, scratch = (value, gradient, cosine), (marks, rows, *_scratch(most))
    _judge(first, entries, region, start, leaf, skip, *bounds, verdict, kept, *scratch)


def _most(counts: Any) -> int:
    return int(counts.max(initial=1))


def _scratch(most: int) -> tuple[Any, Any, Any]:
    """Chosen pairs, their unit vectors, and members of a conflict."""
    return np.empty(most, np.int64), np.empty((3, 8 * most)), np.empty(TURNS, np.int64)


@loop
def _judge(
    first: Any,
    entries: Any,
    region: Any,
    start: Any,
    leaf: Any,
    skip: Any,
    value: Any,
    gradient: Any,
    cosine: float,
    verdict: Any,
    kept: Any,
    marks: Any,
    rows: Any,
    chosen: Any,
    units: Any,
    members: Any,
) -> None:
    """`marks` (2, leaves) are the sign of each leaf and whether it is wanted."""
    for box in range(len(verdict)):
        count = 0
        begin, end = start[box], start[box + 1]
        if end - begin == 1:  # the form is this leaf
            kept[begin] = _sign(value, begin) == 0
        else:
            for pair in range(begin, end):
                marks[0, leaf[pair]], marks[1, leaf[pair]] = _sign(value, pair), 0
            if _is_open(entries, first[region[box]], first[region[box] + 1], skip, box, marks, rows):
                for pair in range(begin, end):
                    kept[pair] = marks[1, leaf[pair]] != 0
        for pair in range(begin, end):
            if kept[pair]:
                chosen[count] = pair
                count += 1
        if count == 0:
            verdict[box] = DISCARDED
        else:
            simple = cosine < 1 and conflict(gradient, chosen, count, cosine, units, members) == 0
            verdict[box] = SIMPLE if simple else OPEN


@step
def _is_open(entries: Any, first: int, last: int, skip: Any, box: int, marks: Any, rows: Any) -> bool:
    """Whether the sign of a region stays open; if so, marks the leaves it needs and notes what is skipped.

    `rows` (2, entries) are the sign of each entry and whether it is needed.
    """
    count = last - first
    for i in range(count):
        what = entries[first + i, 0]
        if what >= 0:
            rows[0, i] = marks[0, what]
        elif what == MIN or what == MAX:
            neutral = -1 if what == MAX else 1
            a = neutral if _skipped(skip, box, 2 * i) else rows[0, entries[first + i, 1]]
            b = neutral if _skipped(skip, box, 2 * i + 1) else rows[0, entries[first + i, 2]]
            rows[0, i] = a if (a > b) == (what == MAX) else b
        else:
            rows[0, i] = 1 if what == INFINITE else -1
    if rows[0, count - 1] != 0:
        return False
    for i in range(count):
        rows[1, i] = i == count - 1
    for i in range(count - 1, -1, -1):
        what = entries[first + i, 0]
        if rows[1, i] == 0:
            continue
        if what >= 0:
            marks[1, what] = 1
        elif what == MIN or what == MAX:
            for operand in range(2):
                bit = 2 * i + operand
                if rows[0, entries[first + i, 1 + operand]] != 0:
                    skip[box, bit >> 6] |= np.uint64(1) << np.uint64(bit & 63)
                elif not _skipped(skip, box, bit):
                    rows[1, entries[first + i, 1 + operand]] = 1
    return True


def judge_groups(
    ends: Any, start: Any, value: Any, gradient: Any, cosine: float, last: bool, member: Any, verdict: Any
) -> None:
    """Groups of boxes, ``ends[k]`` to ``ends[k + 1]``: simple, or open or unresolved and then with a conflict marked.

    A group is unresolved before the last level where the middles of *sure* pairs conflict: there the leaf is the
    only one that matters, and with 0 in the middle half of its values it surely vanishes in the box.
    """
    scratch = _scratch(_most(np.diff(start[ends])))
    _judge_groups(ends, start, value, gradient, cosine, last, member, verdict, *scratch)


@loop
def _judge_groups(
    ends: Any,
    start: Any,
    value: Any,
    gradient: Any,
    cosine: float,
    last: bool,
    member: Any,
    verdict: Any,
    chosen: Any,
    units: Any,
    members: Any,
) -> None:
    for group in range(len(verdict)):
        count, found, sure = 0, 0, 0
        for box in range(ends[group], ends[group + 1]):
            if start[box + 1] - start[box] == 1 and _surely_vanishes(value, start[box]):
                chosen[count] = start[box]
                count += 1
        if count and not last:
            sure = central_conflict(gradient, chosen, count, cosine, units, members)
        if sure == 0:
            first, count = start[ends[group]], start[ends[group + 1]] - start[ends[group]]
            for k in range(count):
                chosen[k] = first + k
            found = conflict(gradient, chosen, count, cosine, units, members) if count else 0
        for k in range(sure + found):
            member[chosen[members[k]]] = True
        verdict[group] = UNRESOLVED if sure or (found and last) else OPEN if found else SIMPLE


@step
def _surely_vanishes(value: Any, pair: int) -> Any:
    return 2 * abs(value[0, pair] + value[1, pair]) < value[1, pair] - value[0, pair]


@step
def _sign(value: Any, pair: int) -> int:
    """1 or -1 where the sign is known, else 0."""
    if value[0, pair] > 0:
        return 1
    return -1 if value[1, pair] < 0 else 0


@step
def _skipped(skip: Any, box: int, bit: int) -> Any:
    return (skip[box, bit >> 6] >> np.uint64(bit & 63)) & np.uint64(1) != 0


@step
def conflict(gradient: Any, chosen: Any, count: int, cosine: float, units: Any, members: Any) -> int:
    """How many of the chosen boxes of gradients (3, 2, pairs) no direction serves; 0 if one direction serves all.

    A direction d serves if d.g > cosine*|g| for every g in the boxes. `members` receives the positions, among the
    first `count` chosen, of boxes that conflict (TURNS at most); `units` (3, 8*count or more) is scratch.
    Zero is proved, up to the rounding of a scalar product, which `cosine` outweighs; a conflict may be an oversight.
    """
    known, x, y, z = _middle(gradient, chosen, count, units)
    if known and x * x + y * y + z * z > 0 and _serves(gradient, chosen, count, cosine, x, y, z):
        return 0
    for k in range(count):
        for corner in range(8):
            a, b, c = _corner(gradient, chosen[k], corner)
            size = np.sqrt(a * a + b * b + c * c)
            if not 0 < size < np.inf:
                members[0] = k
                return 1
            at = 8 * k + corner
            units[0, at], units[1, at], units[2, at] = a / size, b / size, c / size
    return _nearest(units, 8 * count, 8, cosine, members)


@step
def central_conflict(gradient: Any, chosen: Any, count: int, cosine: float, units: Any, members: Any) -> int:
    """As `conflict`, for the middles of the boxes of gradients only; none is found where one has no direction."""
    known, _, _, _ = _middle(gradient, chosen, count, units)
    return _nearest(units, count, 1, cosine, members) if known else 0


@step
def _middle(gradient: Any, chosen: Any, count: int, units: Any) -> Any:
    """Whether all middles have directions, and their sum; the directions go to `units`."""
    x = y = z = 0.0
    for k in range(count):
        pair = chosen[k]
        a = gradient[0, 0, pair] + gradient[0, 1, pair]
        b = gradient[1, 0, pair] + gradient[1, 1, pair]
        c = gradient[2, 0, pair] + gradient[2, 1, pair]
        size = np.sqrt(a * a + b * b + c * c)
        if not 0 < size < np.inf:
            return False, 0.0, 0.0, 0.0
        units[0, k], units[1, k], units[2, k] = a / size, b / size, c / size
        x, y, z = x + units[0, k], y + units[1, k], z + units[2, k]
    return True, x, y, z


@step
def _corner(gradient: Any, pair: int, corner: int) -> Any:
    return gradient[0, corner & 1, pair], gradient[1, corner >> 1 & 1, pair], gradient[2, corner >> 2, pair]


@step
def _serves(gradient: Any, chosen: Any, count: int, cosine: float, x: float, y: float, z: float) -> bool:
    bound = cosine * cosine * (x * x + y * y + z * z)
    for k in range(count):
        for corner in range(8):
            a, b, c = _corner(gradient, chosen[k], corner)
            along = a * x + b * y + c * z
            if not (along > 0 and along * along > bound * (a * a + b * b + c * c)):
                return False
    return True


@step
def _nearest(units: Any, count: int, each: int, cosine: float, members: Any) -> int:
    """Gilbert: from a point of the hull towards the vertex that lies least along it; a box has `each` vertices."""
    x, y, z = units[0, 0], units[1, 0], units[2, 0]
    members[0], found = 0, 1
    for _ in range(TURNS - 1):
        least, at = np.inf, 0
        for k in range(count):
            along = x * units[0, k] + y * units[1, k] + z * units[2, k]
            if along < least:
                least, at = along, k
        size = np.sqrt(x * x + y * y + z * z)
        if least > cosine * size:
            return 0
        if size <= cosine:
            break
        a, b, c = units[0, at] - x, units[1, at] - y, units[2, at] - z
        share = -(x * a + y * b + z * c) / (a * a + b * b + c * c)
        share = share if share < 1 else 1.0
        x, y, z = x + share * a, y + share * b, z + share * c
        known = False
        for k in range(found):
            known |= members[k] == at // each
        if not known:
            members[found] = at // each
            found += 1
    return found
