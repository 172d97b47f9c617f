"""Spline spaces: a degree and knots, open or closed, and what their basis functions are.

B_(i,1)(t) = 1 for t_i <= t < t_(i+1), else 0
B_(i,k)(t) = (t - t_i)/(t_(i+k-1) - t_i) B_(i,k-1)(t) + (t_(i+k) - t)/(t_(i+k) - t_(i+1)) B_(i+1,k-1)(t)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, NdBSpline, PPoly

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.functions.formulas import entries_of
from rsym.surfaces.functions.polynomials import Polynomials
from rsym.surfaces.parameters import Interval, real_array

Spaces: TypeAlias = "tuple[SplineSpace, SplineSpace]"

# Share of the period by which the knots of one turn may differ from those of the next: they come from sums.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class SplineSpace:
    """The piecewise polynomials of a degree over knots; closed: those whose period is the interval.

    Parameters
    ----------
    degree : int
        One less than the order.
    knots : array
        Open: as many as vertices and order together. Closed: one period and `degree` more on each side.
    closed : bool
        Whether vertex i + count is vertex i again.

    Examples
    --------
    >>> space = SplineSpace(2, np.array([0.0, 0, 0, 1, 2, 2, 2]))
    >>> space.count, space.domain
    (4, (0.0, 2.0))
    >>> space.matrix(np.array([0.0, 1.0])).tolist()
    [[1.0, 0.0, 0.0, 0.0], [0.0, 0.5, 0.5, 0.0]]
    """

    degree: int
    knots: Floats
    closed: bool = False

    @property
    def count(self) -> int:
        """The number of vertices."""
        return len(self.knots) - self.degree - 1 - (self.degree if self.closed else 0)

    @property
    def domain(self) -> Interval:
        """The interval where the basis functions sum to one."""
        return float(self.knots[self.degree]), float(self.knots[-self.degree - 1])

    def unrolled(self, vertices: Floats) -> Floats:
        """The vertices, along the first axis, one for every basis function on the line."""
        return np.concatenate([vertices, vertices[: self.degree]]) if self.closed else vertices

    def spline(self, vertices: Floats) -> BSpline:
        """The function with these vertices, along the first axis."""
        return BSpline(self.knots, self.unrolled(vertices), self.degree)

    def local(self, t: Floats) -> tuple[NDArray[np.intp], Floats]:
        """Numbers and values of the `degree + 1` basis functions that matter at each t, (len t, degree + 1) both."""
        design = BSpline.design_matrix(t, self.knots, self.degree)
        shape = (len(t), self.degree + 1)
        return design.indices.reshape(shape).astype(np.intp) % self.count, design.data.reshape(shape)

    def matrix(self, t: Floats) -> Floats:
        """The values of all basis functions, (len t, count); closed: cyclic."""
        result = np.zeros((len(t), self.count))
        columns, values = self.local(t)
        result[np.arange(len(t))[:, None], columns] = values
        return result

    def expressions(self) -> list[sp.Expr]:
        """The basis functions in `rsym.surfaces.symbols.t`, valid in the interval; knots as fractions."""
        each = [PPoly.from_spline(self.spline(row)) for row in np.eye(self.count)]
        return entries_of(Polynomials(inner_pieces(each, self.domain)).expressions())

    @property
    def pieces(self) -> int:
        """The number of polynomials along the interval."""
        low, high = self.domain
        return len(np.unique(self.knots[(self.knots >= low) & (self.knots <= high)])) - 1


def derivative(spline: BSpline, t: Floats, order: int) -> Floats:
    """The derivative of a spline; of an order above the degree 0 in every span.

    There SciPy 1.13 writes beyond its arrays.
    """
    if order <= spline.k:
        return np.asarray(spline(t, order))
    return np.zeros(spline.c.shape[1:]) * t.reshape((*t.shape, *(1,) * (spline.c.ndim - 1)))


def inner_pieces(each: list[PPoly], domain: Interval) -> PPoly:
    """Splines over the same knots as one piecewise polynomial without empty pieces, on the interval alone."""
    low, high = domain
    starts = each[0].x[:-1]
    inner = (np.diff(each[0].x) > 0) & (starts >= low) & (starts < high)
    return PPoly(np.stack([one.c[:, inner] for one in each], axis=-1), np.append(starts[inner], high))


def tensor_values(spaces: Spaces, net: Floats, u: Floats, v: Floats, order: tuple[int, int] = (0, 0)) -> Floats:
    """The derivative of this order of the tensor product with this net, at arrays that broadcast, (..., 3).

    Arrays that vary along different axes are combined one direction after the other.
    """
    shape = np.broadcast_shapes(u.shape, v.shape)
    rows, columns = ((1,) * (len(shape) - one.ndim) + one.shape for one in (u, v))
    if any(k > one.degree for k, one in zip(order, spaces, strict=True)):
        return np.zeros(3) * (u + v)[..., None]
    if all(m == 1 or n == 1 for m, n in zip(rows, columns, strict=True)):
        return _separable(spaces, net, u.reshape(rows), v.reshape(columns), order)
    control = spaces[1].unrolled(spaces[0].unrolled(net).swapaxes(0, 1)).swapaxes(0, 1)
    surface = NdBSpline(tuple(one.knots for one in spaces), control, tuple(one.degree for one in spaces))
    return np.asarray(surface(np.stack(np.broadcast_arrays(u, v), axis=-1), nu=order))


def _separable(spaces: Spaces, net: Floats, u: Floats, v: Floats, order: tuple[int, int]) -> Floats:
    """Curves of u with vertices that are curves of v."""
    across = spaces[1].spline(net.swapaxes(0, 1))(v.ravel(), order[1])
    along = spaces[0].spline(np.ascontiguousarray(across.swapaxes(0, 1)))(u.ravel(), order[0])
    # Axes of u and of v alternate: those of u come first, then all go where they belong.
    split = along.reshape(*u.shape, *v.shape, along.shape[-1])
    n = u.ndim
    joined = split.transpose(*[axis for pair in zip(range(n), range(n, 2 * n), strict=True) for axis in pair], 2 * n)
    return np.asarray(joined.reshape(*np.broadcast_shapes(u.shape, v.shape), along.shape[-1]))


def checked_space(order: Any, knots: ArrayLike | None, count: int, closed: bool, name: str) -> SplineSpace:
    """A space with so many vertices; uniform knots over [0, 1] where none are given.

    Knots of a closed direction are given for one period, `count + 1`, or for all.
    """
    degree = checked_order(order, count, name) - 1
    if knots is None:
        return uniform_space(degree, count, closed)
    given = _finite_knots(knots, name)
    if closed and len(given) == count + 1:
        given = around(given, degree)
    expected = count + degree + 1 + (degree if closed else 0)
    if len(given) != expected:
        period = f" (or {count + 1}, for one period)" if closed else ""
        raise RsymError(
            f"{count} vertices of order {degree + 1} along {name} need {expected} knots{period}, got {len(given)}",
            code="knots",
            remedy="as many knots as vertices and order together",
        )
    _check_multiplicities(given, degree, name)
    room = ROUNDING * float(given[-1] - given[0])
    if closed and not np.allclose(around(given[degree : -degree or None], degree), given, rtol=0, atol=room):
        raise RsymError(
            f"the knots of a closed direction must repeat after one period, those along {name} do not",
            code="knots",
            remedy=f"give the {count + 1} knots of one period alone",
        )
    return SplineSpace(degree, given, closed)


def checked_order(order: Any, count: int, name: str) -> int:
    """An order k with 2 <= k <= count."""
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 2:
        raise RsymError(f"an order is an integer >= 2, got {order!r} along {name}", code="order")
    if count < order:
        raise RsymError(
            f"order {order} along {name} needs {order} or more vertices, got {count}",
            code="order",
            remedy="lower the order or take more vertices",
        )
    return int(order)


def uniform_space(degree: int, count: int, closed: bool, interval: Interval = (0.0, 1.0)) -> SplineSpace:
    """Equal spans, closed as many as vertices, open so many less the degree; open ends stand degree + 1 times."""
    spans = count if closed else count - degree
    low, high = interval
    inner = low + (high - low) * (np.arange(spans + 1) / spans)
    return SplineSpace(degree, around(inner, degree) if closed else clamped(inner, degree), closed)


def clamped(inner: Floats, degree: int) -> Floats:
    """The knots with both ends `degree + 1` times."""
    return np.concatenate([np.full(degree, inner[0]), inner, np.full(degree, inner[-1])])


def around(period: Floats, degree: int) -> Floats:
    """The knots of one period with `degree` more on each side."""
    length = period[-1] - period[0]
    return np.concatenate([period[-degree - 1 : -1] - length, period, period[1 : degree + 1] + length])


def _finite_knots(knots: ArrayLike, name: str) -> Floats:
    try:
        given = np.array(real_array(knots))
    except (TypeError, ValueError) as error:
        raise RsymError(f"the knots along {name} must be numbers", code="knots") from error
    if given.ndim != 1 or not np.isfinite(given).all():
        raise RsymError(f"the knots along {name} must be one row of finite numbers", code="knots")
    if (np.diff(given) < 0).any():
        place = int(np.flatnonzero(np.diff(given) < 0)[0])
        raise RsymError(
            f"knots must not decrease, but {given[place]:g} is followed by {given[place + 1]:g}"
            f" at the knot {place} along {name}",
            code="knots",
        )
    return given


def _check_multiplicities(knots: Floats, degree: int, name: str) -> None:
    """A knot may be repeated `degree` times inside, once more at the ends: otherwise the spline is torn."""
    low, high = knots[degree], knots[-degree - 1]
    values, times = np.unique(knots, return_counts=True)
    allowed = degree + ((values <= low) | (values >= high))
    if low == high or (times > allowed).any():
        worst = values[np.argmax(times - allowed)]
        raise RsymError(
            f"the knot {worst:g} stands {int(times[values == worst][0])} times along {name}, degree {degree}",
            code="knots",
            remedy=f"a knot inside may stand {degree} times, one at an end {degree + 1} times",
        )
