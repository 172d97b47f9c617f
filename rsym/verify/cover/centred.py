"""Arrays of intervals as middles and radii, for tensors over many boxes at once, rounding included.

Source: Rump, Fast and parallel interval arithmetic (1999).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from rsym.arrays import Floats

Ends: TypeAlias = tuple[Floats, Floats]

# Sums of at most nine products err by ten units of 2**-53 of the sum of their sizes, thrice; the radius is such a sum.
SLACK = 2.0**-48
TINY = 1e-300  # more than what a product loses by underflow
FAINT = 1e-280  # of a larger sum SLACK covers underflow too


@dataclass(frozen=True)
class Centred:
    """All numbers within `radius` of `middle`; where either is not finite, nothing is said.

    Examples
    --------
    >>> a = Centred.between(np.array([1.0]), np.array([2.0]))
    >>> low, high = (a + a - Centred.exact(np.array([1.0]))).ends
    >>> bool(0.99 < low[0] <= 1), bool(3 <= high[0] < 3.01)
    (True, True)
    >>> low, high = contracted("n,n->n", a, a).ends
    >>> bool(low[0] <= 1), bool(high[0] >= 4)
    (True, True)
    """

    middle: Floats
    radius: Floats

    @classmethod
    def exact(cls, values: Floats) -> Centred:
        """The numbers themselves."""
        return cls(values, np.zeros_like(values))

    @classmethod
    def between(cls, low: Floats, high: Floats) -> Centred:
        """The intervals with these ends."""
        with np.errstate(all="ignore"):
            middle = np.where(np.isfinite(low) & np.isfinite(high), low / 2 + high / 2, 0.0)
            radius = np.maximum(high - middle, middle - low)
            return cls(middle, radius + SLACK * radius + TINY * np.sign(radius))

    @property
    def ends(self) -> Ends:
        """Lower and upper ends."""
        with np.errstate(all="ignore"):
            radius = self.radius + SLACK * (np.abs(self.middle) + self.radius)
            low, high = self.middle - radius, self.middle + radius
        return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)

    def __getitem__(self, key: Any) -> Centred:
        return Centred(self.middle[key], self.radius[key])

    def __add__(self, other: Centred) -> Centred:
        with np.errstate(all="ignore"):
            middle, radius = self.middle + other.middle, self.radius + other.radius
            return Centred(middle, radius + SLACK * (np.abs(middle) + radius))

    def __neg__(self) -> Centred:
        return Centred(-self.middle, self.radius)

    def __sub__(self, other: Centred) -> Centred:
        return self + -other

    def meet(self, other: Centred) -> Centred:
        """What lies in both."""
        (a, b), (c, d) = self.ends, other.ends
        low, high = np.maximum(a, c), np.minimum(b, d)
        return Centred.between(low, np.maximum(low, high))

    def reciprocal(self) -> Centred:
        """One over it where it is positive; elsewhere nothing is said."""
        low, high = self.ends
        with np.errstate(all="ignore"):
            low = np.where(low > 0, low, np.nan)
            return Centred.between(1 / high * (1 - SLACK), 1 / low * (1 + SLACK))


def contracted(rule: str, a: Centred, b: Centred) -> Centred:
    """Sums of at most nine products, as `numpy.einsum` writes them.

    |a b - a0 b0| <= (|a0| + ra)(|b0| + rb) - |a0||b0| for a within ra of a0 and b within rb of b0.
    """
    sizes, others = np.abs(a.middle), np.abs(b.middle)
    with np.errstate(all="ignore"):
        whole = np.einsum(rule, sizes + a.radius, others + b.radius)
        radius = whole - np.einsum(rule, sizes, others) + SLACK * whole
        if (whole < FAINT).any():
            radius += TINY * np.einsum(rule, np.sign(sizes + a.radius), np.sign(others + b.radius))
        return Centred(np.einsum(rule, a.middle, b.middle), radius)
