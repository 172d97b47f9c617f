"""Nets of vertices for data: D = C B with C_(pq),(ij) = N_i(u_pq) M_j(w_pq), solved by orthogonal reflections.

Source: Rogers and Adams (1990), equations 6-83 (as many vertices as data) and 6-84 (fewer). The book inverts C or
C^T C; here C is never squared. Parameters that are alike in all rows and columns give C = N x M and two small systems.

Smoothness is data too: rows that ask second derivatives to vanish,
s sum_ij A_ij (|B_uu|^2 + 2 |B_uv|^2 + |B_vv|^2) with the vertices B_uu, B_uv, B_vv of the derivatives and the integrals
A_ij of their basis functions, parameters brought to [0, 1]. It is no less than s times the thin-plate energy
integral |p_uu|^2 + 2 |p_uv|^2 + |p_vv|^2, since basis functions are positive and their sum is 1, and vanishes with it:
for planes with u and v proportional to lengths. The idea of such a penalty: Eilers and Marx (1996).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dtrcon

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.reports.document import Document, Sentence, Tabular, numerical
from rsym.reports.numbers import number
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.sampling.memory import free_memory
from rsym.surfaces.bsplines.band_qr import DEPENDENT, BandQR
from rsym.surfaces.bsplines.data_parameters import are_settled, check_data
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, tensor_values
from rsym.surfaces.corrections import sizes

Pair: TypeAlias = tuple[Floats, Floats]
# Share of the size of the data by which an interpolating surface may miss them: regular systems stay below 1e-14, nets
# over averaged knots through crowded random points below 1e-11.
MET = 1e-11
# Vertices this many times as far out as the data have lost as many digits; order 7 through points crowded by 1e-9 takes
# nets over averaged knots to 7e7 times, and still meets the data to 1e-13.
FAR = 1e8
# One over the condition from which on a system of scattered data has no unique solution. Of 1500 random ones some were
# singular and no column of the triangle showed it: these come to at most 7e-16, regular ones to 2e-15 or more.
CONDITION = 1e-15
# The matrix of all points and what its triangle takes beside it: 2.4 of its size was measured; smoothing takes more.
COPIES = 4


@dataclass(frozen=True)
class Residual:
    """How far a surface passes from its data, each point against its own parameters.

    Parameters
    ----------
    maximum, rms : float
        The largest distance, and the root of the mean square.
    worst : tuple of int
        The row and column of the datum with the largest distance; of scattered points and of curves its number alone.
    place : tuple of float
        Its parameters.

    Examples
    --------
    >>> print(Residual(0.25, 0.1, (2, 3), (0.5, 1.0)))
    at most 0.25, rms 0.1; worst at datum (2, 3), u = 0.5, v = 1
    """

    maximum: float
    rms: float
    worst: tuple[int, ...]
    place: tuple[float, ...]

    def __str__(self) -> str:
        datum = self.worst if len(self.worst) > 1 else self.worst[0]
        names = "uv" if len(self.place) > 1 else "t"
        place = ", ".join(f"{name} = {number(value, 6)}" for name, value in zip(names, self.place, strict=True))
        return f"at most {number(self.maximum, 3)}, rms {number(self.rms, 3)}; worst at datum {datum}, {place}"


@dataclass(frozen=True, eq=False)
class SplineFit(Report):
    """The data of a surface or a curve, and how it came to them.

    Parameters
    ----------
    points : array (r, s, 3), or (n, 3) of scattered points and of curves
        The data.
    parameters : tuple of arrays
        Of the rows and of the columns; or of each point, (r, s) both. Scattered: (n,) both. Of a curve one alone, (n,).
    history : tuple of Residual
        Before the corrections of parameters and constraints, and after each step that was kept; the last one holds.
    converged : bool
        False where vertices kept on planes or curves were still moving at the last step.

    Examples
    --------
    >>> from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
    >>> points = [[[i, j, abs(i - 3) * j] for j in range(5)] for i in range(7)]
    >>> fit = BSplineSurface.least_squares(points, (5, 4), corrections=3).fit
    >>> len(fit.history), fit.history[0].rms > fit.residual.rms
    (4, True)
    >>> print(BSplineSurface.interpolate(points).fit)  # doctest: +ELLIPSIS
    35 data are missed by at most ...
    """

    points: Floats
    parameters: tuple[Floats, ...]
    history: tuple[Residual, ...]
    converged: bool = True

    @property
    def residual(self) -> Residual:
        """The residual of the surface."""
        return self.history[-1]

    def document(self) -> Document:
        """How far the surface misses the data, step by step; measured, not proved."""
        steps = tuple((f"{k}", number(one.maximum, 3), number(one.rms, 3)) for k, one in enumerate(self.history))
        moving = () if self.converged else numerical(["Vertices kept on planes or curves were still moving."])
        return Document(
            "spline-fit",
            Sentence(f"{plural(self.points.size // 3, 'datum', 'data')} are missed by {self.residual}.", False),
            sentences=moving,
            tables=(Tabular(("step", "greatest distance", "rms"), steps),) if len(steps) > 1 else (),
            data={"history": self.history, "converged": self.converged},
        )


def broadcast(parameters: Pair) -> Pair:
    """Parameters that broadcast to the net of data."""
    u, v = parameters
    return (u[:, None] if u.ndim == 1 else u), (v[None, :] if v.ndim == 1 else v)


def residual_of(spaces: Spaces, net: Floats, points: Floats, parameters: Pair) -> Residual:
    """The distances of the points from the surface at their parameters."""
    u, v = broadcast(parameters)
    return residual_at(points, tensor_values(spaces, net, u, v), (u, v))


def residual_at(points: Floats, values: Floats, parameters: tuple[Floats, ...]) -> Residual:
    """The distances of points (..., 3) from values at their parameters."""
    distances = sizes(points - values)
    worst = tuple(int(one) for one in np.unravel_index(int(distances.argmax()), distances.shape))
    place = tuple(float(np.broadcast_to(one, distances.shape)[worst]) for one in parameters)
    return Residual(float(distances[worst]), float(np.sqrt((distances**2).mean())), worst, place)


def fitted_net(spaces: Spaces, points: Floats, parameters: Pair, smoothing: float = 0.0) -> Floats:
    """The net whose surface passes the points nearest in the sense of least squares, and is smooth."""
    if smoothing:
        solve = _smooth_solver(spaces, parameters, smoothing)
    else:
        solve = _tensor_solver(spaces, parameters) if parameters[0].ndim == 1 else _solver(spaces, parameters)
    net = solve(points)
    check_near(net, points)
    return net


def check_near(net: Floats, points: Floats) -> None:
    """Refuse vertices so far from the data that these hardly determine them."""
    size = float(np.abs(points).max())
    if not np.abs(net).max() <= FAR * size:
        raise _spoilt(f"these reach to {np.abs(net).max():.2g}, data of the size {size:.2g}")


def check_met(residual: Residual, points: Floats) -> None:
    """Refuse a surface that should pass its data and, for rounding, does not."""
    size = float(np.abs(points).max())
    if not residual.maximum <= MET * size:
        raise _spoilt(f"the surface misses data of the size {size:.2g} by {residual.maximum:.2g}")


def _spoilt(what: str) -> RsymError:
    return RsymError(
        f"the data hardly determine the vertices: {what}",
        code="ill-conditioned",
        remedy='take parameters alike in all rows (per_point=False) and knots="averaged", or fewer vertices',
    )


def collocation_matrix(spaces: Spaces, parameters: Pair) -> Floats:
    """C: a row for each point, column i*(m+1) + j with N_i(u) M_j(v)."""
    u, v = (one.ravel() for one in np.broadcast_arrays(*broadcast(parameters)))
    need, free = float(COPIES * 8 * len(u) * spaces[0].count * spaces[1].count), free_memory()
    if need > free:
        raise RsymError(
            f"{len(u)} points and {spaces[0].count} x {spaces[1].count} vertices need {need / 2**30:.2g} GiB of memory,"
            f" {free / 2**30:.2g} GiB are free",
            code="memory",
            remedy="take fewer points or vertices, or a net of points with parameters alike in all rows",
        )
    (rows, n), (columns, m) = (space.local(values) for space, values in zip(spaces, (u, v), strict=True))
    matrix = np.zeros((len(u), spaces[0].count * spaces[1].count))
    numbers = rows[:, :, None] * spaces[1].count + columns[:, None, :]
    matrix[np.arange(len(u))[:, None, None], numbers] = n[:, :, None] * m[:, None, :]
    return matrix


def _tensor_solver(spaces: Spaces, parameters: Pair) -> Callable[[Floats], Floats]:
    """B = N^+ D (M^+)^T."""
    systems = []
    for space, values, name in zip(spaces, parameters, "uv", strict=True):
        check_data(values, space, name)
        settled = are_settled(values, space)
        systems.append(BandQR(space.matrix(values), 0.0 if settled else DEPENDENT))
        dependent = systems[-1].dependent if settled else undetermined(systems[-1])
        if dependent is not None:
            raise singular(spaces, f"the vertex {dependent} along {name}")
    along, across = systems
    return lambda right: across.solve(along.solve(right).swapaxes(0, 1)).swapaxes(0, 1)


def _solver(spaces: Spaces, parameters: Pair) -> Callable[[Floats], Floats]:
    """The one system of all points."""
    shape = (spaces[0].count, spaces[1].count)
    system = BandQR(collocation_matrix(spaces, parameters))
    # A net of data is met or refused; scattered points, one column, may be fewer than they seem.
    dependent = undetermined(system) if parameters[0].shape[-1] == 1 else system.dependent
    if dependent is not None:
        row, column = divmod(dependent, shape[1])
        raise singular(spaces, f"the vertex ({row}, {column})")
    return lambda right: system.solve(right.reshape(-1, 3)).reshape(*shape, 3)


def _smooth_solver(spaces: Spaces, parameters: Pair, smoothing: float) -> Callable[[Floats], Floats]:
    """One system of all points, each with its share of the mean square, and of what is to be smooth."""
    shape = (spaces[0].count, spaces[1].count)
    matrix, rows = collocation_matrix(spaces, parameters), smoothness_rows(spaces)
    scale = float(np.sqrt(len(matrix)))
    system = BandQR(np.concatenate([matrix / scale, np.sqrt(smoothing) * rows]))
    dependent = undetermined(system)
    if dependent is not None:
        row, column = divmod(dependent, shape[1])
        raise singular(spaces, f"the vertex ({row}, {column})")
    still = np.zeros((len(rows), 3))
    return lambda right: system.solve(np.concatenate([right.reshape(-1, 3) / scale, still])).reshape(*shape, 3)


def undetermined(system: BandQR) -> int | None:
    """The number of an unknown that least squares do not determine, or None.

    A column that depends on those before it need not show in its own rest: rounding has had all of them to hide in. So
    the condition of R, its columns brought to one length, is asked too; the unknown is the one that varies most at no
    cost, by inverse iteration.
    """
    if system.dependent is not None:
        return system.dependent
    upper = system.upper
    upper = upper / np.sqrt(np.einsum("ij,ij->j", upper, upper))
    if dtrcon(upper)[0] > CONDITION:
        return None
    x = np.ones(len(upper))
    for _ in range(2):
        x = solve_triangular(upper, solve_triangular(upper, x, trans="T"))
        x /= np.abs(x).max()
    return int(np.abs(x).argmax())


def singular(spaces: Sequence[SplineSpace], vertex: str) -> RsymError:
    """The refusal of a system without a unique solution."""
    halved = any(space.closed for space in spaces)
    return RsymError(
        f"the data do not determine {vertex}: it depends on those before it",
        code="singular",
        remedy='take fewer vertices or knots="averaged"'
        + (", or least_squares with smoothing=1e-6" if len(spaces) > 1 else "")
        + (", or move the parameters of the closed direction by half a span" if halved else ""),
    )


def checked_smoothing(given: Any) -> float:
    """A finite number that is not negative.

    Examples
    --------
    >>> checked_smoothing(1e-6)
    1e-06
    """
    try:
        value = math.nan if isinstance(given, bool | str) else float(given)
    except (TypeError, ValueError):
        value = math.nan
    if not 0 <= value < math.inf:
        raise RsymError(
            f"smoothing is a number >= 0, got {given!r}", code="smoothing", remedy="1e-6 for data that leave holes"
        )
    return value


def smoothness_rows(spaces: Spaces) -> Floats:
    """Rows (m, vertices of u times those of v) whose squares sum up to the penalty above for s = 1."""
    (n, n_u, n_uu), (m, m_v, m_vv) = (_derivatives(space) for space in spaces)
    return np.concatenate([np.kron(n_uu, m), math.sqrt(2) * np.kron(n_u, m_v), np.kron(n, m_vv)])


def _derivatives(space: SplineSpace) -> list[Floats]:
    """For the function and its first two derivatives the vertices, each times the root of its integral."""
    low, high = space.domain
    knots, matrix = (space.knots - low) / (high - low), space.unrolled(np.eye(space.count))
    found = []
    for degree in range(space.degree, space.degree - 3, -1):
        if degree < 0:  # straight between its knots
            found.append(np.zeros((0, space.count)))
            continue
        integrals = (knots[degree + 1 :] - knots[: -degree - 1]) / (degree + 1)
        rows = np.sqrt(integrals)[:, None] * matrix
        found.append(rows[: space.count] if space.closed else rows)
        if degree:
            lengths = (knots[degree + 1 : -1] - knots[1 : -degree - 1])[:, None]
            steps = degree * np.diff(matrix, axis=0)
            # Where knots stand so often that there is a kink, the derivative has one vertex less.
            matrix = np.divide(steps, lengths, out=np.zeros_like(steps), where=lengths > 0)
            knots = knots[1:-1]
    return found
