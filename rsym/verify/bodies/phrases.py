"""Parts of sentences on bodies: counts, names, places, numbers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from decimal import ROUND_CEILING, Context, Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.verify.wording import DIGITS, rounded_up, significant

LONGEST = 48  # characters of a definition: one without a name goes by its formula
SHORT = 4  # digits where no error is known, or none matters
LEAST_SHARE = 0.001  # per cent
NOTHING = -9  # the power of ten of a scale that is nothing beside it
SLACK = 1e-6  # of a unit: what is so near a round number is that number
SINGLE: Mapping[str, str] = {"unresolved": "unresolved place"}
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
    >>> cut("bonnet"), cut("x**2 + y**2 + z**2 - 2*x*y - 2*y*z - 2*z*x - x - y - z")
    ('bonnet', 'x**2 + y**2 + z**2 - 2*x*y - 2*y*z - 2*z*x -...')
    """
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 3].rstrip()}..."


def counted(kind: str, count: int) -> str:
    """A kind of curve or point, with the count if there are several.

    Examples
    --------
    >>> counted("edge", 1), counted("edge", 12), counted("tangency", 2)
    ('edge', '12 edges', '2 tangencies')
    """
    return noun(kind, count) if count == 1 else f"{count} {noun(kind, count)}"


def noun(kind: str, count: int) -> str:
    """What one or several of a kind are called.

    Examples
    --------
    >>> noun("node", 1), noun("node", 2), noun("unresolved", 1)
    ('node', 'nodes', 'unresolved place')
    """
    return SINGLE.get(kind, kind) if count == 1 else SEVERAL.get(kind, f"{kind}s")


def kinds_text(found: Iterable[Any]) -> str:
    """How many curves or points there are of each kind.

    Examples
    --------
    >>> from rsym.verify.bodies.report import SingularPoint
    >>> kinds_text([SingularPoint((0.0, 0.0, k), 0.0, kind, "G0") for k, kind in enumerate(("corner", "node", "node"))])
    '1 corner, 2 nodes'
    """
    counts = Counter(one.kind for one in found)
    return ", ".join(f"{count} {noun(kind, count)}" for kind, count in counts.items())


def share_text(share: float) -> str:
    """A share in per cent, rounded up.

    Examples
    --------
    >>> share_text(0.00512), share_text(1e-14)
    ('0.52 %', 'less than 0.001 %')
    """
    return f"{rounded_up(100 * share, 2)} %" if 100 * share >= LEAST_SHARE else f"less than {LEAST_SHARE} %"


def place(point: Sequence[float] | NDArray[np.float64], digits: int = DIGITS) -> str:
    """A point; what is nothing beside its largest coordinate is 0.

    Examples
    --------
    >>> place((1.0, -0.5, 1 / 3)), place((1e-40, 0.0, 0.2)), place((1 / 3, 0, 0), 4)
    ('(1, -0.5, 0.333333333333)', '(0, 0, 0.2)', '(0.3333, 0, 0)')
    """
    nothing = significant(*point)
    return f"({', '.join(f'{end + 0.0 if abs(end) > nothing else 0.0:.{digits}g}' for end in point)})"


def short(value: float, scale: float = 0.0) -> str:
    """A number in few digits, 0 if it is nothing beside the scale.

    Examples
    --------
    >>> short(3.14159265), short(-1e-17), short(-1e-17, scale=1.0)
    ('3.142', '-1e-17', '0')
    """
    return "0" if abs(value) < 10.0**NOTHING * scale else f"{value + 0.0:.{SHORT}g}"


def interval(low: float, high: float, scale: float = 0.0) -> str:
    """An enclosure in few digits that still encloses, none of them beyond a billionth of the scale and the ends.

    Examples
    --------
    >>> interval(-1.000001, 2.000001), interval(0.99999, 1.00001)
    ('[-1.001, 2.001]', '[0.9999, 1.001]')
    >>> interval(-3e-300, 0.5), interval(-2e-28, 1e-28, scale=1.0)
    ('[-1e-10, 0.5]', '[-1e-09, 1e-09]')
    """
    largest = max(abs(low), abs(high), scale)
    nothing = Decimal(10) ** (NOTHING + math.floor(math.log10(largest))) if largest > 0 else Decimal(0)
    return f"[{_outward(-Decimal(low), nothing, -1)}, {_outward(Decimal(high), nothing, 1)}]"


def _outward(end: Decimal, nothing: Decimal, sign: int) -> str:
    """sign*end rounded away from the inside, its size `nothing` at least or 0."""
    if abs(end) < nothing:
        end = nothing if end > 0 else Decimal(0)
    return f"{sign * float(Context(4, ROUND_CEILING).create_decimal(end)) + 0.0:.4g}"


def extents(points: NDArray[np.float64]) -> str:
    """The box about points (n, 3), rounded outward to a hundredth of its size.

    Examples
    --------
    >>> extents(np.array([[-0.8659, 0, 0.5], [0.8657, 0.1, 0.5]]))
    '[-0.87, 0.87] x [0, 0.1] x [0.5, 0.5]'
    """
    low, high = points.min(axis=0), points.max(axis=0)
    # Far from the origin floats know no more.
    size = max(float((high - low).max()), 1e-6 * float(np.abs(points).max()), np.finfo(float).tiny)
    places = 2 - math.floor(math.log10(size))
    low, high = np.floor(low * 10.0**places + SLACK), np.ceil(high * 10.0**places - SLACK)
    return " x ".join(f"[{_rounded(a, places)}, {_rounded(b, places)}]" for a, b in zip(low, high, strict=True))


def _rounded(count: float, places: int) -> str:
    return f"{round(count / 10.0**places, places) + 0.0:.12g}"
