"""Families of curves that surfaces pass through."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rsym.errors import RsymError
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.functions.univariate import Stack, Univariate, on_interval

# Parameters along each curve at which neighbours are measured against one another.
SAMPLES = 33


def family(given: Sequence[Any], letters: Mapping[Any, Any] | None, what: str, least: int = 2) -> Stack:
    """The curves side by side, all brought to the interval of the first.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> family([(t, 0, 0), [[0, 1, 0], [1, 1, 1]]], None, "the curve")(0.5).tolist()
    [[0.5, 0.0, 0.0], [0.5, 1.0, 0.5]]
    """
    if not isinstance(given, Sequence | np.ndarray) or len(given) < least:
        got = len(given) if isinstance(given, Sequence | np.ndarray) else type(given).__name__
        raise RsymError(
            f"{what}s: expected a sequence of {least} or more, got {got}",
            code="family",
            remedy="give every curve as SymPy expressions, a function, points or a Nurbs",
        )
    curves = [as_curve(one, letters, what=f"{what} {number}") for number, one in enumerate(given)]
    return Stack([on_interval(curve, *curves[0].domain) for curve in curves])


def across(curves: Univariate, knots: Sequence[Any] | str | None, closed: bool) -> Sequence[Any]:
    """The knots of a family: as given; 0, 1, 2, ... by default; for "chord" the mean distances between neighbours.

    A closed family of n curves has n + 1 knots: the last one is the first curve again.
    """
    count = curves.shape[0] + closed
    if knots is None:
        return range(count)
    if not isinstance(knots, str):
        if len(knots) != count:
            again = ", the last of them for the first curve again" if closed else ""
            raise RsymError(
                f"{curves.shape[0]} curves need {count} knots{again}, got {len(knots)}",
                code="knots",
                remedy="one knot for each curve, in the order of the curves",
            )
        return knots
    if knots != "chord":
        raise RsymError(f'knots are numbers or "chord", got {knots!r}', code="knots", remedy='knots="chord"')
    points = curves(np.linspace(*curves.domain, SAMPLES))
    points = np.concatenate([points, points[:, :1]], axis=1) if closed else points
    steps = np.sqrt(((points[:, 1:] - points[:, :-1]) ** 2).sum(axis=-1)).mean(axis=0)
    if (steps == 0).any():
        row = int(np.flatnonzero(steps == 0)[0])
        raise RsymError(
            f"the curves {row} and {(row + 1) % curves.shape[0]} are the same",
            code="family",
            remedy="leave one of them out",
        )
    return [0.0, *(np.cumsum(steps) / steps.mean())]
