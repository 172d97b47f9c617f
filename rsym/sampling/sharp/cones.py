"""Cones of gradients: whether one direction rises on all of them.

The largest smallest cosine that any direction has with a set of unit vectors is
the distance of the origin from their convex hull, and the nearest point of the
hull is that direction; Gilbert's algorithm finds it. On the way every point of
the hull refutes what is larger than its own length, and the few vectors that it
is made of are the conflict. A box of gradients needs only its eight corners:
d.g - c|g| is concave in g.

Source: E. G. Gilbert, SIAM J. Control 4 (1966) 61-80.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.sampling.sharp.loops import step

# Of the car at 256**3 3, 5, 12 and 30 turns leave 532, 518, 518 and 518 cells; of the tilted torus of a depth of one
# 644, 620, 584 and 563. What takes longer counts as a conflict and is split.
TURNS = 12


@step
def conflict(gradient: Any, chosen: Any, count: int, cosine: float, units: Any, members: Any) -> int:
    """How many of the chosen boxes of gradients (3, 2, pairs) no direction serves; 0 if one direction serves all.

    A direction d serves if d.g > cosine*|g| for every g in the boxes. `members` receives the positions, among the
    first `count` chosen, of boxes that conflict (TURNS at most); `units` (3, 8*count or more) is scratch.
    Zero is proved, up to the rounding of a scalar product, which `cosine` outweighs; a conflict may be an oversight.
    """
    x, y, z = _middle(gradient, chosen, count, units)
    if x * x + y * y + z * z > 0 and _serves(gradient, chosen, count, cosine, x, y, z):
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
    """As `conflict`, for the middles of the boxes of gradients only."""
    _middle(gradient, chosen, count, units)
    return _nearest(units, count, 1, cosine, members)


@step
def _middle(gradient: Any, chosen: Any, count: int, units: Any) -> Any:
    """The sum of the directions of the middles, zero if one has none; the directions go to `units`."""
    x = y = z = 0.0
    for k in range(count):
        pair = chosen[k]
        a = gradient[0, 0, pair] + gradient[0, 1, pair]
        b = gradient[1, 0, pair] + gradient[1, 1, pair]
        c = gradient[2, 0, pair] + gradient[2, 1, pair]
        size = np.sqrt(a * a + b * b + c * c)
        if not 0 < size < np.inf:
            return 0.0, 0.0, 0.0
        units[0, k], units[1, k], units[2, k] = a / size, b / size, c / size
        x, y, z = x + units[0, k], y + units[1, k], z + units[2, k]
    return x, y, z


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
        share = min(1.0, -(x * a + y * b + z * c) / (a * a + b * b + c * c))
        x, y, z = x + share * a, y + share * b, z + share * c
        known = False
        for k in range(found):
            known |= members[k] == at // each
        if not known:
            members[found] = at // each
            found += 1
    return found
