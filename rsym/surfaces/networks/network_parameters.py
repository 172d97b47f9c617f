"""At which parameters the curves of two families meet: one intersection for each pair, in one order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import enough
from rsym.surfaces.networks.intersections import Intersection, Polygon, intersections

Table: TypeAlias = list[list[list[Intersection]]]


def meeting_parameters(
    u_polygons: Sequence[Polygon], v_polygons: Sequence[Polygon], tolerance: float, size: float
) -> tuple[Floats, Floats, Floats]:
    """Arrays u_ij, v_ij and gaps: the v-curve i meets the u-curve j at u_ij on the u-curve and v_ij on the v-curve.

    Curves may miss one another by a share of the size. Parameters increase with i and with j; along curves whose ends
    meet they go on beyond the end. They are NaN on curves that are points, where any parameter does.

    Raises
    ------
    RsymError
        If a pair does not meet, meets more than once, or out of order; it names the pair.
    """
    table = [
        [_meeting(i, j, one, other, tolerance, size) for j, one in enumerate(u_polygons)]
        for i, other in enumerate(v_polygons)
    ]
    _drop_out_of_order(table, u_polygons, v_polygons)
    for i, row in enumerate(table):
        for j, found in enumerate(row):
            if len(found) != 1:
                raise _several(i, j, found)
    of_u, of_v, gaps = (np.array([[found[0][part] for found in row] for row in table]) for part in range(3))
    _order(of_u, u_polygons, "u", "v")
    _order(of_v.T, v_polygons, "v", "u")
    return of_u, of_v, gaps


def _meeting(i: int, j: int, one: Polygon, other: Polygon, tolerance: float, size: float) -> list[Intersection]:
    found = intersections(one, other, tolerance * size)
    if found[0].gap > tolerance * size:
        nearest = found[0]
        raise RsymError(
            f"the u-curve {j} and the v-curve {i} do not meet: their smallest distance is {nearest.gap:.4g}, at "
            f"u = {nearest.first:.6g} and v = {nearest.second:.6g}",
            code="network",
            where=f"the pair (v-curve {i}, u-curve {j})",
            remedy="every curve of one family must meet all of the other; measured ones need "
            f"tolerance={enough(nearest.gap / size)} or more, a share of the size of the network",
        )
    return found


def _drop_out_of_order(table: Table, u_polygons: Sequence[Polygon], v_polygons: Sequence[Polygon]) -> None:
    """Of pairs that meet more than once leave what can stand between its neighbours."""
    rows, columns = len(table), len(table[0])
    changed = any(len(found) > 1 for row in table for found in row)
    while changed:
        changed = False
        for i, row in enumerate(table):
            for j, found in enumerate(row):
                along = [] if u_polygons[j].closes else _neighbours(table, i, j, (1, 0), rows, 0)
                over = [] if v_polygons[i].closes else _neighbours(table, i, j, (0, 1), columns, 1)
                kept = [one for one in found if all(_fits(one[axis], *limits) for axis, limits in (*along, *over))]
                if kept and len(kept) < len(found):
                    row[j], changed = kept, True


def _neighbours(
    table: Table, i: int, j: int, step: tuple[int, int], count: int, axis: int
) -> list[tuple[int, tuple[float, float]]]:
    """What the pairs before and after allow the parameter of this axis to be."""
    place = (i, j)[axis]
    before = table[i - step[0]][j - step[1]] if place > 0 else []
    after = table[i + step[0]][j + step[1]] if place < count - 1 else []
    low = min((one[axis] for one in before), default=-np.inf)
    high = max((one[axis] for one in after), default=np.inf)
    return [(axis, (low, high))]


def _fits(value: float, low: float, high: float) -> bool:
    return not (value <= low or value >= high)


def _several(i: int, j: int, found: list[Intersection]) -> RsymError:
    places = " and ".join(f"(u, v) = ({one.first:.6g}, {one.second:.6g})" for one in found)
    return RsymError(
        f"the u-curve {j} and the v-curve {i} meet {len(found)} times: at {places}",
        code="network",
        where=f"the pair (v-curve {i}, u-curve {j})",
        remedy="cut the curves so that each pair meets once",
    )


def _order(values: Floats, polygons: Sequence[Polygon], along: str, over: str) -> None:
    """Check in place that the parameters on each curve (column) increase; where its ends meet, turn them first."""
    known = values[0, ~np.isnan(values[0])]
    for j, part in enumerate(polygons):
        column = values[:, j]
        length = part.curve.domain[1] - part.curve.domain[0]
        if part.closes:
            column -= length * np.round((column[0] - known[0]) / length) if known.size else 0.0
            column[1:] = column[0] + np.mod(column[1:] - column[0], length)
        bad = np.flatnonzero(np.diff(column) <= 0)
        if len(bad):
            i = int(bad[0])
            raise RsymError(
                f"the {along}-curve {j} meets the {over}-curve {i} at {along} = {column[i]:.6g} and the {over}-curve "
                f"{i + 1} at {along} = {column[i + 1]:.6g}: not in the order of the family",
                code="network",
                where=f"the {along}-curve {j}",
                remedy=f"sort the {over}-curves along {along}, and let all {along}-curves run the same way",
            )
