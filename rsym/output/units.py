"""Lengths in files: the units that they know, and how large a body gets in them."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from rsym.errors import RsymError
from rsym.model.requirements import require_kind, require_positive
from rsym.sampling.mesh import Mesh


class Unit(NamedTuple):
    """A unit: its length in metres, its number in DXF ($INSUNITS) and its name in 3MF."""

    metres: float
    dxf: int
    three_mf: str


UNITS: Mapping[str, Unit] = MappingProxyType(
    {
        "mm": Unit(0.001, 4, "millimeter"),
        "cm": Unit(0.01, 5, "centimeter"),
        "m": Unit(1.0, 6, "meter"),
        "in": Unit(0.0254, 1, "inch"),
    }
)


def check_unit(unit: Any, scale: Any = 1.0) -> None:
    """Refuse a unit that files do not know, and a scale that is not positive.

    Examples
    --------
    >>> check_unit("furlong")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected one of the units mm, cm, m, in, got 'furlong'; remedy: for example unit="mm"
    """
    if not isinstance(unit, str) or unit not in UNITS:
        raise RsymError(
            f"expected one of the units {', '.join(UNITS)}, got {unit!r}", code="unit", remedy='for example unit="mm"'
        )
    require_positive("scale", scale, "for example scale=10")


def sized(mesh: Mesh, *, unit: Any = None, size: Any = None, scale: Any = None) -> tuple[Mesh, str | None]:
    """A mesh in the numbers that a file shall hold, and their unit, if one is named.

    Parameters
    ----------
    mesh : Mesh
        In units of the model.
    unit : {"mm", "cm", "m", "in"}, optional
        The unit of the numbers; without it that of `size`, if it names one.
    size : number or text, optional
        How long the longest side of the mesh gets, in `unit` or as in "120mm".
    scale : float, optional
        How many units one unit of the model becomes, in place of `size`.

    Examples
    --------
    >>> import rsym
    >>> mesh = rsym.mesh(rsym.box(1, 2, 4), 12, bounds=((-1, 1), (-2, 2), (-3, 3)))
    >>> larger, unit = sized(mesh, size="12cm", unit="mm")
    >>> unit, [round(high - low, 9) for low, high in larger.bounds]
    ('mm', [30.0, 60.0, 120.0])
    """
    require_kind(Mesh, mesh, "mesh")
    longest = max(high - low for low, high in mesh.bounds)
    factor, unit = factor_of(longest, unit=unit, size=size, scale=scale)
    return mesh if factor == 1.0 else mesh.scale(factor), unit


def factor_of(longest: float, *, unit: Any = None, size: Any = None, scale: Any = None) -> tuple[float, str | None]:
    """How many units, and of which, one unit of the model becomes whose longest side is so long; as `sized`.

    Examples
    --------
    >>> factor_of(4.0, size="12cm", unit="mm"), factor_of(4.0, scale=2)
    ((30.0, 'mm'), (2.0, None))
    """
    check_size(unit=unit, size=size, scale=scale)
    factor = 1.0 if scale is None else float(scale)
    if size is not None:
        length, own = _length(size)
        unit = unit or own
        if not longest:
            raise RsymError("a mesh of one point has no size", code="size", remedy="give scale instead")
        factor = length * (UNITS[own].metres / UNITS[unit].metres if own and own != unit else 1.0) / longest
    return factor, unit


def check_size(*, unit: Any = None, size: Any = None, scale: Any = None) -> None:
    """Refuse what `sized` would, before there is a mesh.

    Examples
    --------
    >>> check_size(size=3, scale=2)
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: size and scale both say how large the mesh gets; remedy: give one of them, size or scale
    """
    if unit is not None:
        check_unit(unit)
    if size is not None and scale is not None:
        raise RsymError(
            "size and scale both say how large the mesh gets", code="size", remedy="give one of them, size or scale"
        )
    if size is not None:
        _length(size)
    if scale is not None:
        require_positive("scale", scale, "for example scale=10")


def _length(size: Any) -> tuple[float, str | None]:
    """A positive number, and the unit behind it, if there is one."""
    number, unit = size, None
    if isinstance(size, str):
        found = re.fullmatch(rf"\s*(.*?)\s*({'|'.join(UNITS)})?\s*", size, re.DOTALL)
        assert found is not None  # the groups may be empty
        number, unit = found.groups()
    try:
        length = float(number)
        good = 0 < length < math.inf and not isinstance(size, bool)
    except (TypeError, ValueError):
        good = False
    if not good:
        raise RsymError(
            f"expected the length of the longest side, a positive number that may have a unit, got {size!r}",
            code="size",
            remedy='for example size=120 or size="120mm"',
        )
    return length, unit
