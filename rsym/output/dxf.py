"""Layers of lines and features as DXF: release 12 in ASCII, which every program that cuts or mills reads."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.output.units import UNITS
from rsym.sampling.sharp.features import Feature
from rsym.verify.answers.singular import SingularCurve

Tags = Iterable[tuple[int, Any]]


def features_dxf(features: Sequence[Feature | SingularCurve], unit: str, scale: float) -> bytes:
    """Encode features, or singular curves: polylines in space, those between two parts on one layer named after both.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball, side = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)).named("ball"), rsym.Shape(x, (x, y, z)).named("cut")
    >>> features_dxf(rsym.mesh(ball & side, 16).features, "mm", 1.0).count(b"BALL-CUT") > 40
    True
    """
    return layers_dxf([(_layer_of(feature.names), scale * feature.points) for feature in features], unit, flat=False)


def _layer_of(names: Sequence[str]) -> str:
    """What release 12 allows in a name, and short enough for two in the 31 characters of a layer."""
    return "-".join(re.sub(r"[^A-Z0-9]+", "_", name.upper())[:15] for name in names if name) or "CURVES"


def layers_dxf(lines: Sequence[tuple[str, Floats]], unit: str, *, flat: bool) -> bytes:
    """Lines (n, 3) on layers; flat ones are drawn in the plane at the height of their first point."""
    layers = list(dict.fromkeys(layer for layer, _ in lines))
    tags = [*_header([line for _, line in lines], unit), *_tables(layers), (0, "SECTION"), (2, "ENTITIES")]
    for layer, line in lines:
        tags.extend(_polyline(layer, line, flat))
    tags += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code:3d}\n{_written(value)}\n" for code, value in tags).encode("ascii")


def layer_name(name: str) -> str:
    """A name as in z=-2.5 in the letters, digits and signs that release 12 allows: Z_-2P5.

    Examples
    --------
    >>> [layer_name(name) for name in ("z=-0.5", "u=1e-07", "outline")]
    ['Z_-0P5', 'U_1E-07', 'OUTLINE']
    """
    return name.replace("=", "_").replace(".", "P").replace("+", "").upper()


def _header(lines: Sequence[Floats], unit: str) -> Tags:
    points = np.concatenate(lines)
    yield from [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (9, "$INSUNITS"), (70, UNITS[unit].dxf)]
    for name, corner in (("$EXTMIN", points.min(axis=0)), ("$EXTMAX", points.max(axis=0))):
        yield from [(9, name), (10, corner[0]), (20, corner[1]), (30, corner[2])]
    yield 0, "ENDSEC"


def _tables(layers: Sequence[str]) -> Tags:
    yield from [(0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LTYPE"), (70, 1), (0, "LTYPE"), (2, "CONTINUOUS")]
    yield from [(70, 0), (3, "Solid line"), (72, 65), (73, 0), (40, 0.0), (0, "ENDTAB")]
    yield from [(0, "TABLE"), (2, "LAYER"), (70, len(layers))]
    for name in layers:
        yield from [(0, "LAYER"), (2, name), (70, 0), (62, 7), (6, "CONTINUOUS")]
    yield from [(0, "ENDTAB"), (0, "ENDSEC")]


def _polyline(layer: str, line: Floats, flat: bool) -> Tags:
    """A closed line does not repeat its first vertex."""
    closed = bool((line[0] == line[-1]).all())
    height, kind = (line[0, 2], 0) if flat else (0.0, 8)
    yield from [(0, "POLYLINE"), (8, layer), (66, 1), (10, 0.0), (20, 0.0), (30, height), (70, kind + closed)]
    for point in line[:-1] if closed else line:
        yield from [(0, "VERTEX"), (8, layer), *zip((10, 20, 30), point, strict=True)]
        yield from [] if flat else [(70, 32)]
    yield from [(0, "SEQEND"), (8, layer)]


def _written(value: Any) -> str:
    """A float64 to the last digit; never a negative zero, in which two equal drawings could differ."""
    return repr(float(value) + 0.0) if isinstance(value, float) else str(value)
