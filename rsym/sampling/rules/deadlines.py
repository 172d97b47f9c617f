"""The time that a rule of integration has."""

from __future__ import annotations

import math
import time
from numbers import Real

from rsym.errors import RsymError


class OutOfTime(Exception):
    """The time that a rule had is up."""


def deadline(timeout: float | None) -> float:
    """The time of the monotonic clock so many seconds from now; without any there is none."""
    if timeout is None:
        return math.inf
    if not isinstance(timeout, Real) or not float(timeout) > 0:
        raise RsymError(f"expected a number of seconds above 0, got timeout={timeout!r}", code="timeout")
    return time.monotonic() + float(timeout)


def require_time(until: float) -> None:
    """Stop where the time is up."""
    if until < math.inf and time.monotonic() > until:
        raise OutOfTime
