"""Python functions as curves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.surfaces.functions.chebyshev import Interpolant
from rsym.surfaces.functions.univariate import Curve, LetterValues
from rsym.surfaces.parameters import Interval, as_interval

Array: TypeAlias = NDArray[np.float64]
Layout: TypeAlias = Callable[[Array], Array]

PROBES = 5  # not 3, so that points and components cannot be mistaken for one another


class Called(Curve):
    """A curve that a Python function gives: t to a point.

    The function takes an array (n,) and gives (n, 3), three components, or (3, n); or it takes one number and gives
    three. Derivatives that are not given come from a Chebyshev interpolant that has converged.

    Examples
    --------
    >>> circle = Called(lambda t: (np.cos(t), np.sin(t), 0 * t), domain=(0, np.pi))
    >>> circle(np.pi / 2).round(12).tolist(), (circle(0.0, 1).round(9) + 0).tolist()
    ([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
    """

    def __init__(
        self,
        function: Callable[[Any], Any],
        derivatives: Sequence[Callable[[Any], Any]] = (),
        domain: Interval = (0.0, 1.0),
        *,
        closed: bool = False,
    ) -> None:
        self.shape = (3,)
        self.domain = as_interval(domain, "a curve")
        self.closed = closed
        self.known = tuple(_vectorised(one, self.domain) for one in (function, *derivatives))

    @cached_property
    def _interpolant(self) -> Interpolant:
        return Interpolant(self.known[-1], self.domain)

    def evaluate(self, t: Array, orders: Sequence[int], letters: LetterValues = None) -> list[Array]:
        """The derivatives of these orders."""
        flat = t.reshape(-1)
        given = len(self.known) - 1
        parts = [
            self.known[order](flat) if order <= given else self._interpolant.derivative(flat, order - given)
            for order in orders
        ]
        return [part.reshape(*t.shape, 3) for part in parts]


def _vectorised(function: Callable[[Any], Any], domain: Interval) -> Layout:
    """The function from (n,) to (n, 3), however it is written."""
    probes = np.linspace(*domain, PROBES)
    for layout in (_by_rows, _by_components):
        try:
            found = layout(function, probes)
        except (TypeError, ValueError, IndexError):
            continue
        if found.shape == (PROBES, 3):
            return _Points(function, layout)
    try:
        found = _one_by_one(function, probes)
    except (TypeError, ValueError, IndexError) as error:
        raise RsymError(f"a curve must be a function of one number: {error}", code="curve") from error
    if found.shape != (PROBES, 3):
        raise RsymError(
            f"a curve must give points (x, y, z), got values of the shape {found.shape[1:]}",
            code="curve",
            remedy="return three coordinates, such as (cos(t), sin(t), t)",
        )
    return _Points(function, _one_by_one)


@dataclass(frozen=True)
class _Points:
    """A function from (n,) to (n, 3) that was written in one of the layouts; what is not finite is refused."""

    function: Callable[[Any], Any]
    layout: Callable[[Callable[[Any], Any], Array], Array]

    def __call__(self, t: Array) -> Array:
        found = self.layout(self.function, t)
        bad = np.isfinite(t) & ~np.isfinite(found).all(axis=-1)
        if bad.any():
            raise RsymError(f"a curve is not finite at t = {t[bad][0]:.17g}", code="curve", remedy="mend it there")
        return found


def _by_rows(function: Callable[[Any], Any], t: Array) -> Array:
    found = function(t)
    return np.asarray(found, np.float64) if isinstance(found, np.ndarray) else np.empty(0)


def _by_components(function: Callable[[Any], Any], t: Array) -> Array:
    return np.stack([np.broadcast_to(np.asarray(part, np.float64), t.shape) for part in function(t)], axis=-1)


def _one_by_one(function: Callable[[Any], Any], t: Array) -> Array:
    found = [np.asarray(function(float(one)), np.float64).reshape(-1) for one in t]
    return np.array(found) if found else np.empty((0, 3))
