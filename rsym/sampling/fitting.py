"""Letters from data: those for which the boundary passes measured points as near as it can.

Least squares of the distance of first order f/sqrt(f**2/L**2 + |grad f|**2), f the leaf that bounds the body at a
point, by scipy's trust region with bounds. Value and exact derivatives by the letters are one compiled program, in
which letters are inputs. In a plane section the gradient is that in the plane; of a silhouette each point is a line of
sight.

The covariance of M-estimates: with u = residual/scale, psi(u) = u rho'(u**2), n points and k letters,

    cov = scale**2 * (sum psi**2/(n - k)) / (mean of psi')**2 * (J^T J)^-1

which for the linear loss is the variance of the residuals times (J^T J)^-1. It takes the errors of points, each times
the root of its weight, for independent and alike.

Source: G. Taubin (1991), Estimation of planar curves, surfaces and nonplanar space curves, IEEE PAMI 13, for the
distance of first order; P. J. Huber (1981), Robust statistics, section 7.6, for the covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from scipy.optimize import least_squares

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.model.requirements import require_positive, require_shape
from rsym.model.shape import Shape
from rsym.model.wording import listing, proposal
from rsym.reports.words import listed
from rsym.sampling.boundary_distances import Distances, boundary_distances
from rsym.sampling.fit_report import Fit
from rsym.sampling.plane import plane_section
from rsym.sampling.silhouettes import lines_of_sight
from rsym.sampling.windows import bounds_or_extent

EVALUATIONS = 200  # of the residuals in one search; the fits of the tests take below 30
TOLERANCE = 1e-12  # relative change of the sum, of the letters, and size of the gradient at which a search ends
ROUNDS = 8  # searches one after the other: points become defined, the scale of a robust loss settles
SETTLED = 0.01  # relative change of that scale
NORMAL = 1.4826  # the standard deviation of a normal distribution over its median absolute value
# Singular values of J, its columns brought to one length, below this share of the largest are those of rounding.
DEPENDENT = 1e-9
IDLE = 1e-9  # a letter that by its own size, 1 at least, changes residuals by less than this share of L changes none
FAR = 0.25  # of L: residuals that are larger as a rule say nothing of letters, omega_1 has levelled off
TOLD = 0.1  # of the largest share of a letter in a combination that is not determined

Loss: TypeAlias = tuple[Callable[[Floats], Floats], Callable[[Floats], Floats]]
# psi(u) and psi'(u) of the losses of scipy.
LOSSES: Mapping[str, Loss] = MappingProxyType(
    {
        "linear": (lambda u: u, np.ones_like),
        "huber": (lambda u: np.clip(u, -1, 1), lambda u: (np.abs(u) <= 1).astype(np.float64)),
        "soft_l1": (lambda u: u / np.sqrt(1 + u**2), lambda u: (1 + u**2) ** -1.5),
        "cauchy": (lambda u: u / (1 + u**2), lambda u: (1 - u**2) / (1 + u**2) ** 2),
    }
)


def fit(
    shape: Shape,
    points: Any,
    letters: Any,
    *,
    weights: Any = None,
    loss: str = "linear",
    scale: float | None = None,
    length: float | None = None,
    section: Mapping[Any, float] | None = None,
    silhouette: Any = None,
    bounds: Any = None,
) -> Fit:
    """The letters for which the boundary is nearest to measured points, in the sense of least squares.

    What is squared is omega_1 = omega/sqrt(omega**2/L**2 + |grad omega|**2), near the boundary the distance up to
    second order, and at most L; where R-operations join several leaves, that of the leaf that bounds the body there.
    The search starts at the defaults of the letters and stays within their ranges.

    Parameters
    ----------
    shape : Shape
        With letters; `with_letters` gives another start.
    points : (n, dim) array
        On the boundary, but for noise. At least as many as letters.
    letters : sequence of names or symbols
        Those to find; the others keep their values.
    weights : (n,) array, optional
        Factors of the squares: 1/variance; a factor that all have in common changes nothing.
    loss : {"linear", "huber", "soft_l1", "cauchy"}
        As in `scipy.optimize.least_squares`: all but the first bound the influence of outliers.
    scale : float, optional
        The size of a residual from which on it counts as an outlier. Without it 1.4826 times the median of their sizes,
        until it settles.
    length : float, optional
        L, in the unit of the coordinates; without it the diagonal of the box around the points. 1 is the form of
        `normalise` and of the field ``normalised``.
    section : mapping, optional
        ``{z: 1.0}``: points (n, 2) of the boundary in that plane, and the distance in it.
    silhouette : coordinate or vector of three numbers, optional
        The direction of view: points of the outline that a body in space shows. A coordinate takes points (n, 2) in the
        two others, a vector (n, 3) anywhere on the line of sight. The residual is the largest distance along the line.
    bounds : pairs, optional
        Where lines of sight are followed: between the planes across them that hold this box; by default that of the
        shape, or its extent at the start.

    Returns
    -------
    Fit
        ``.letters``, ``.standard_errors``, ``.residuals``, ``.shape`` with the letters found, ``.covariance``; what
        happened on the way is a report: ``print(fit)``.

    Raises
    ------
    RsymError
        For points that are not finite or too few, unknown letters, a letter that is a parameter of an R-operation,
        letters that the points do not determine, one by one or together, points far from the boundary, and words or
        numbers that are none of those above.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> a, b = sp.symbols("a b")
    >>> oval = rsym.Shape(1 - x**2 / a**2 - y**2 / b**2, (x, y), letters={a: 2, b: 2})
    >>> t = np.linspace(0, 6, 40)
    >>> found = rsym.fit(oval, np.stack([3 * np.cos(t), np.sin(t)], axis=1), letters=[a, b])
    >>> {name: round(value, 9) for name, value in found.letters.items()}
    {'a': 3.0, 'b': 1.0}
    """
    require_shape(shape)
    names = _checked_letters(shape, letters)
    if loss not in LOSSES:
        raise RsymError(
            f"no loss {loss!r}", code="loss", remedy=proposal(loss, LOSSES, f"choose from {listing(LOSSES)}")
        )
    for word, value in (("scale", scale), ("length", length)):
        if value is not None:
            require_positive(word, value, "or leave it out")
    if section and silhouette is not None:
        raise RsymError("points lie in a section or on a silhouette, not both", code="section", remedy="leave one out")
    if silhouette is not None and shape.dimension != 3:
        raise RsymError("a silhouette is that of a body in space", code="silhouette", remedy="leave silhouette out")
    flat, _ = plane_section(shape, section)
    given = _checked_points(points, flat.dimension, silhouette is not None)
    sights = None
    if silhouette is not None:
        coordinates = tuple(symbol.name for symbol in shape.coordinates)
        sights = lines_of_sight(given, silhouette, bounds_or_extent(shape, bounds), coordinates)
    size = float(np.linalg.norm(np.ptp(given, axis=0))) or 1.0
    span = size if length is None else float(length)
    data = _Data(boundary_distances(flat, names, given, span, sights), _roots(weights, len(given)) / size)
    start = np.array([float(shape.letters[name].default) for name in names])
    search = _searched(data, _ranges(shape, names), start, loss, None if scale is None else scale / size)
    values, free = search.values, ~search.at_bounds
    residuals, slopes = data.distances(values)
    used = data.used(residuals)
    _refuse_far(residuals[used], span)
    covariance = np.full((len(names), len(names)), np.nan)
    covariance[np.ix_(free, free)] = _covariance(data, search, names, loss)
    return Fit(
        shape=shape.with_letters(dict(zip(names, values.tolist(), strict=True))),
        letters=dict(zip(names, values.tolist(), strict=True)),
        standard_errors=dict(zip(names, np.sqrt(np.diag(covariance)).tolist(), strict=True)),
        residuals=residuals,
        covariance=covariance,
        points=given,
        start=dict(zip(names, start.tolist(), strict=True)),
        at_bounds=tuple(name for name, at in zip(names, search.at_bounds, strict=True) if at),
        left_out=np.flatnonzero(~used),
        without_derivative=np.flatnonzero(used & ~np.isfinite(slopes).all(axis=1)),
        loss=loss,
        scale=1.0 if loss == "linear" else search.scale * size,
        length=span,
        evaluations=search.evaluations,
        converged=search.converged,
        section={str(axis): float(value) for axis, value in section.items()} if section else None,
        silhouette=tuple(sights.direction.tolist()) if sights else None,
    )


@dataclass(frozen=True)
class _Data:
    """The residuals and their derivatives as functions of the letters, and the roots of the weights over a size."""

    distances: Distances
    roots: Floats

    def used(self, residuals: Floats) -> Flags:
        """Those points that take part."""
        return np.asarray(np.isfinite(residuals) & (self.roots > 0))

    def weighted(self, values: Floats, used: Flags) -> tuple[Floats, Floats]:
        """Residuals and derivatives times the roots of the weights; a point without derivatives moves nothing."""
        residuals, slopes = self.distances(values)
        slopes = np.where(np.isfinite(slopes).all(axis=1, keepdims=True), slopes, 0.0)
        return residuals[used] * self.roots[used], slopes[used] * self.roots[used, None]


class _Search(NamedTuple):
    """Where a search ended: values of the letters, which of them at their bounds, the points used, the scale."""

    values: Floats
    at_bounds: Flags
    used: Flags
    scale: float
    evaluations: int
    converged: bool


def _searched(data: _Data, ranges: tuple[Floats, Floats], start: Floats, loss: str, scale: float | None) -> _Search:
    """Searches one after the other, until the points that take part and the scale of a robust loss stay the same."""
    last = _Search(start, np.zeros(len(start), bool), np.zeros(len(data.roots), bool), 1.0, 0, False)
    for _ in range(ROUNDS):
        used = data.used(data.distances(last.values)[0])
        if used.sum() < len(start):
            raise RsymError(
                f"{len(start)} letters need as many points or more, {int(used.sum())} have a distance and a weight",
                code="too-few-points",
                remedy="give more points, or find fewer letters",
            )
        size = scale or 1.0
        if loss != "linear" and scale is None:
            usual = NORMAL * float(np.median(np.abs(data.weighted(last.values, used)[0])))
            size = max(usual, np.finfo(float).tiny)
        if (used == last.used).all() and abs(size / last.scale - 1) <= SETTLED:
            break
        last = _one_search(data, used, ranges, last, loss, size)
    return last


def _one_search(
    data: _Data, used: Flags, ranges: tuple[Floats, Floats], last: _Search, loss: str, scale: float
) -> _Search:
    """Least squares from where the last search ended; a point that loses its distance on the way pulls no more."""
    begun = data.weighted(last.values, used)
    known = {last.values.tobytes(): begun}

    def both(values: Floats) -> tuple[Floats, Floats]:
        key = values.tobytes()  # the solver asks for the residuals and then, at the same place, for the derivatives
        if key not in known:
            known.clear()
            residuals, slopes = data.weighted(values, used)
            known[key] = np.where(np.isfinite(residuals), residuals, begun[0]), slopes
        return known[key]

    found = least_squares(
        lambda values: both(values)[0],
        last.values,
        lambda values: both(values)[1],
        bounds=ranges,
        x_scale="jac",
        loss=loss,
        f_scale=scale,
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=EVALUATIONS,
    )
    at_bounds = found.active_mask != 0
    values = np.where(at_bounds, np.where(found.active_mask < 0, *ranges), found.x)
    return _Search(values, at_bounds, used, scale, last.evaluations + int(found.nfev), bool(found.success))


def _covariance(data: _Data, search: _Search, names: Sequence[str], loss: str) -> Floats:
    """The covariance of the letters that are not at their bounds; refused where they are not determined."""
    free = ~search.at_bounds
    residuals, slopes = data.weighted(search.values, search.used)
    chosen = [name for name, is_free in zip(names, free, strict=True) if is_free]
    _require_determined(slopes[:, free], chosen, np.maximum(np.abs(search.values[free]), 1.0))
    psi, slope = (part(residuals / search.scale) for part in LOSSES[loss])
    spare, mean = len(residuals) - len(names), float(slope.mean())
    variance = search.scale**2 * float((psi**2).sum()) / spare / mean**2 if spare > 0 and mean > 0 else np.nan
    _, upper = np.linalg.qr(slopes[:, free])
    inverse = np.linalg.inv(upper)
    covariance: Floats = variance * (inverse @ inverse.T)
    return covariance


def _require_determined(slopes: Floats, names: Sequence[str], units: Floats) -> None:
    """Refuse letters without influence, and combinations of letters that change no residual."""
    sizes = np.linalg.norm(slopes, axis=0)
    idle = [name for name, size in zip(names, sizes * units, strict=True) if size <= IDLE * len(slopes) ** 0.5]
    if idle:
        raise RsymError(
            f"the points do not determine {listed(idle)}: no residual depends on {'it' if len(idle) == 1 else 'them'}",
            code="undetermined",
            remedy="leave out what the points do not show, or measure where it does",
        )
    _, values, directions = np.linalg.svd(slopes / sizes, full_matrices=False)
    if values.size and values[-1] <= DEPENDENT * values[0]:
        steps = directions[-1] / sizes
        steps = steps / steps[np.abs(directions[-1]).argmax()]
        share = np.abs(directions[-1]) / np.abs(directions[-1]).max()
        moved = [f"{name} by {step:.3g}" for name, step, part in zip(names, steps, share, strict=True) if part > TOLD]
        raise RsymError(
            f"the points do not determine these letters all: moved together, {listed(moved)}, they change no residual",
            code="undetermined",
            remedy="find one of them less",
        )


def _refuse_far(residuals: Floats, length: float) -> None:
    """Refuse what is no fit at all."""
    usual = float(np.median(np.abs(residuals)))
    if usual > FAR * length:
        raise RsymError(
            f"the boundary stays far from the points: half of them by {usual:.3g} or more, of {length:.3g} at most",
            code="far",
            remedy="give other defaults, nearer to the points, or check units, axes and the letters to find",
        )


def _checked_letters(shape: Shape, letters: Any) -> tuple[str, ...]:
    if isinstance(letters, str | bytes | Mapping) or not isinstance(letters, Iterable):
        raise RsymError(
            f"letters are a list of names, got {letters!r}", code="letters", remedy='for example letters=["a", "b"]'
        )
    names = tuple(dict.fromkeys(str(letter) for letter in letters))
    unknown = [name for name in names if name not in shape.letters]
    if unknown or not names:
        known = listing(shape.letters)
        raise RsymError(
            f"no letter {unknown[0]!r}; the letters are: {known}" if unknown else "no letters to find were given",
            code="unknown-letter",
            remedy=proposal(unknown[0] if unknown else "", shape.letters, f"choose from: {known}"),
        )
    return names


def _ranges(shape: Shape, names: Sequence[str]) -> tuple[Floats, Floats]:
    """The ends of the ranges, infinite where they are open."""
    letters = [shape.letters[name] for name in names]
    low = np.array([-np.inf if one.minimum is None else float(one.minimum) for one in letters])
    high = np.array([np.inf if one.maximum is None else float(one.maximum) for one in letters])
    fixed = [name for name, a, b in zip(names, low, high, strict=True) if a >= b]
    if fixed:
        raise RsymError(
            f"the range of {listed(fixed)} is one value", code="letter-range", remedy="leave it out, or widen the range"
        )
    return low, high


def _checked_points(points: Any, dimension: int, silhouette: bool) -> Floats:
    """Finite points; those of silhouettes may have two coordinates or three."""
    try:
        given = np.array(points, np.float64)
    except (TypeError, ValueError):
        given = np.zeros(0)
    widths = (2, 3) if silhouette else (dimension,)
    if given.ndim != 2 or given.shape[1] not in widths or not len(given):
        raise RsymError(
            f"expected points (n, {' or '.join(map(str, widths))}), got {_kind(points, given)}",
            code="points",
            remedy="a row for each point, as numpy.loadtxt reads them",
        )
    (wrong,) = np.nonzero(~np.isfinite(given).all(axis=1))
    if wrong.size:
        raise RsymError(
            f"points must be finite, {wrong.size} of {len(given)} are not, the first is number {wrong[0]}",
            code="points",
            remedy="points[numpy.isfinite(points).all(axis=1)]",
        )
    return given


def _kind(points: Any, given: Floats) -> str:
    return f"the shape {given.shape}" if given.size else type(points).__name__


def _roots(weights: Any, count: int) -> Floats:
    """The roots of the weights, whose mean is 1."""
    if weights is None:
        return np.ones(count)
    try:
        given = np.array(weights, np.float64)
    except (TypeError, ValueError):
        given = np.zeros(0)
    if given.shape != (count,) or not np.isfinite(given).all() or not (given >= 0).all() or not given.any():
        raise RsymError(
            f"expected {count} weights >= 0, one for each point and not all 0, got {_kind(weights, given)}",
            code="weights",
            remedy="1/variance of each point, or leave weights out",
        )
    roots: Floats = np.sqrt(given / given.mean())
    return roots
