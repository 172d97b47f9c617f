"""What the pixels of a picture of rays are painted with: by the rows of the table of maps, as meshes are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from matplotlib.cm import ScalarMappable
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.logic.faces import BETWEEN
from rsym.model.wording import proposal
from rsym.output.paints import MAPS, ValueColours, in_room, reflected_heights, zebra_colours
from rsym.output.parts import PALETTE, colours_of
from rsym.output.shading import BODY, decode, linear
from rsym.output.sights import Probe, Sight, neighbours

COLOURINGS = ("part", "zebra", "normal", *MAPS)
# Caps of sections: paper, and lines at 45 degrees across it, so many to the shorter side of a picture.
CAP, HATCH = "#f4e6d0", "#9c6b3c"
HATCHES, HATCH_WIDTH, CLOSEST = 70, 0.17, 5.0  # lines; their width as a share of the distance; pixels between them

# The linear colours (m, 3) of what a sight meets; the sight, and of each of its hits the number of the nearest one in
# the picture's own sight, for what only neighbours tell.
Colouring: TypeAlias = Callable[[Sight, Any], NDArray[np.floating[Any]]]


@dataclass(frozen=True)
class Brush:
    """Colours of what a picture sees, whether light falls on them, and what they mean."""

    begin: Callable[[Sight], Colouring]
    lit: bool = True
    scale: ScalarMappable | None = None
    label: str = ""
    parts: Mapping[str, str] = field(default_factory=dict)


def checked_colouring(name: Any) -> str | None:
    """What pictures may be coloured by, or None."""
    if name is None or (isinstance(name, str) and name in COLOURINGS):
        return name
    remedy = f"choose from {', '.join(COLOURINGS)}, or leave it out"
    raise RsymError(
        f"no colouring {name!r}", code="colour-by", remedy=proposal(name, COLOURINGS, remedy) if name else remedy
    )


def brush_of(
    name: str | None,
    sights: Sequence[Sight],
    probe: Callable[[], Probe],
    colour: str = BODY,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
) -> Brush:
    """The brush of a colouring for pictures of a body.

    `sights` show its parts; a probe tells of all of the body, so that values have one colour from every side.
    """
    if name is None:
        body = linear(colour).astype(np.float32)
        return Brush(lambda own: lambda seen, numbers: np.broadcast_to(body, (len(seen.met), 3)))
    if name == "part":
        return _of_parts(part_colours_of(sights))
    if name == "zebra":
        return Brush(partial(_zebra, probe().box))
    if name == "normal":
        return Brush(lambda own: lambda seen, numbers: decode((seen.normals + 1) / 2), lit=False)
    return _of_values(name, probe(), limits, colour_map)


def part_colours_of(sights: Sequence[Sight]) -> dict[str, str]:
    """The parts that are seen, each with its colour, that of meshes."""
    names: dict[str, None] = {}
    seen: set[str] = set()
    meet: list[tuple[str, str]] = []
    for sight in sights:
        own = sight.called.names
        names.update(dict.fromkeys(own))
        seen.update(own[number] for number in np.unique(sight.called.number).tolist() if number >= 0)
        meet += [(own[first], own[second]) for first, second in neighbours(sight).tolist()]
    every = tuple(names)
    return colours_of(every, [number for number, name in enumerate(every) if name in seen], meet)


def _of_parts(parts: Mapping[str, str]) -> Brush:
    def colours(seen: Sight, numbers: Any) -> NDArray[np.float32]:
        names = seen.called.names
        table = [linear(parts.get(name, parts.get(name.split(BETWEEN)[0], PALETTE[0]))) for name in names]
        return np.array([*table, linear(CAP)], np.float32)[seen.called.number]

    return Brush(lambda own: colours, parts=parts)


def _of_values(
    name: str, probe: Probe, limits: tuple[float, float] | None = None, colour_map: str | None = None
) -> Brush:
    field, label, power, of = MAPS[name]
    unit = (2 / max(float(np.ptp(probe.box, axis=0).max()), 1e-300)) ** power
    values = probe.values(lambda sight: of(sight.field(field)))
    if not values.size:
        values, shares = np.zeros(1), np.ones(1)
    else:
        shares = probe.shares
    colours = ValueColours.of(values, label, unit, limits, shares, colour_map)
    return Brush(
        lambda own: lambda seen, numbers: colours(of(seen.field(field))), scale=colours.scale, label=colours.label
    )


def _zebra(box: Floats, own: Sight) -> Colouring:
    """Stripes as wide as pixels see them: heights differ between neighbours, the less of two on either side."""
    low, high = box

    def heights(seen: Sight) -> NDArray[np.float32]:
        places = in_room(seen.points_at(slice(None)), low, high)
        return reflected_heights(seen.normals, places, own.view.axes).astype(np.float32)

    here = heights(own)
    width, height = own.view.size
    whole = np.full(height * width, np.nan, np.float32)
    whole[own.met] = here
    steps = _steps(whole.reshape(height, width)).reshape(-1)[own.met]

    def colours(seen: Sight, numbers: Any) -> Floats:
        return zebra_colours(here, steps) if seen is own else zebra_colours(heights(seen), steps[numbers])

    return colours


def _steps(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """How much values differ from one pixel to the next, along rows and columns together; 0 where none is known."""
    total = np.zeros_like(values)
    for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        difference = np.abs(values[other] - values[one])
        least = np.full_like(values, np.nan)
        least[one] = difference
        least[other] = np.fmin(least[other], difference)
        total += np.nan_to_num(least)
    return total


def hatched(column: Floats, row: Floats, size: tuple[int, int]) -> NDArray[np.float32]:
    """The linear colours (n, 3) of caps at places of a picture of so many pixels: lines at 45 degrees.

    Examples
    --------
    >>> caps = hatched(np.arange(400.0), np.zeros(400), (400, 400))
    >>> bool(caps.max() == np.float32(linear(CAP)).max()), bool(abs(caps[8, 0] - caps[0, 0]) < 1e-6)
    (True, True)
    """
    apart = max(min(size) / HATCHES, CLOSEST) * np.sqrt(2.0)
    apart = float(np.round(apart))  # along rows and columns, so that every line looks alike
    from_line = np.abs((column + row + apart / 2) % apart - apart / 2) / np.sqrt(2.0)
    ink = np.clip(HATCH_WIDTH * apart / np.sqrt(2.0) / 2 + 0.5 - from_line, 0.0, 1.0)[:, None]
    return np.asarray(ink * linear(HATCH) + (1 - ink) * linear(CAP), np.float32)
