"""Parts of sentences on bodies: counts, names, places, numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context

import numpy as np
from numpy.typing import NDArray

from rsym.verify.wording import number, plural

LONGEST = 40  # characters of a definition: one without a name goes by its formula
SHORT = 5  # digits where no error is known, or none matters
SEVERAL: Mapping[str, str] = {
    "tangency": "tangencies",
    "no sign change": "places without a change of sign",
    "unresolved": "unresolved places",
    "unbounded curvature": "places of unbounded curvature",
}


def between(names: Sequence[str]) -> str:
    """The two definitions that meet.

    Examples
    --------
    >>> between(("roof", "boot")), between(("roof", "roof")), between(("", ""))
    (' between roof and boot', ' within roof', '')
    """
    known = list(dict.fromkeys(cut(name) for name in names if name))
    return f" between {' and '.join(known)}" if len(known) > 1 else f" within {known[0]}" if known else ""


def of(names: Sequence[str]) -> str:
    """The definitions that meet in a point.

    Examples
    --------
    >>> of(("roof", "boot", "side")), of(())
    (' of roof, boot and side', '')
    """
    known = list(dict.fromkeys(cut(name) for name in names if name))
    return f" of {', '.join(known[:-1])}{' and ' if known[1:] else ''}{known[-1]}" if known else ""


def cut(name: str) -> str:
    """A definition's name, or its formula as far as a line has room.

    Examples
    --------
    >>> cut("bonnet"), cut("x**2 + y**2 + z**2 - 2*x*y - 2*y*z - 2*z*x - 1")
    ('bonnet', 'x**2 + y**2 + z**2 - 2*x*y - 2*y*z -...')
    """
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 3].rstrip()}..."


def counted(kind: str, count: int) -> str:
    """A kind of curve or point, with the count if there are several.

    Examples
    --------
    >>> counted("edge", 1), counted("edge", 12), counted("tangency", 2)
    ('edge', '12 edges', '2 tangencies')
    """
    return kind if count == 1 else plural(count, kind, SEVERAL.get(kind, ""))


def place(point: Sequence[float] | NDArray[np.float64]) -> str:
    """A point.

    Examples
    --------
    >>> place((1.0, -0.5, 1 / 3))
    '(1, -0.5, 0.333333333333)'
    """
    return f"({', '.join(map(number, point))})"


def short(value: float) -> str:
    """A number in few digits, without a negative zero.

    Examples
    --------
    >>> short(3.14159265), short(-1e-17)
    ('3.1416', '-1e-17')
    """
    return f"{value + 0.0:.{SHORT}g}"


def interval(low: float, high: float) -> str:
    """An enclosure in few digits that still encloses.

    Examples
    --------
    >>> interval(-1.000001, 2.000001), interval(0.99999, 1.00001)
    ('[-1.001, 2.001]', '[0.9999, 1.001]')
    """
    ends = (
        float(Context(4, rounding).create_decimal(end)) for end, rounding in ((low, ROUND_FLOOR), (high, ROUND_CEILING))
    )
    return f"[{', '.join(f'{end:.4g}' for end in ends)}]"
