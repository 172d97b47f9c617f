"""Singular curves and points on the picture of a body: edges coloured by dihedral angle, jumps of curvature dashed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, product
from types import MappingProxyType
from typing import TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D

from rsym.arrays import Floats
from rsym.output.axes3d import Bar
from rsym.output.certificates import CERTIFICATES, DEFECT
from rsym.output.ink import INK, SMOOTH, Stroke, dots, visible
from rsym.output.paints import UNDEFINED
from rsym.output.shading import decode, linear
from rsym.reports.words import plural
from rsym.sampling.sharp.features import Feature
from rsym.verify.answers.singular import SingularCurve, SingularPoint, counted

Limits: TypeAlias = tuple[float, float]

HIDDEN, HIDDEN_POINT = 0.15, 0.5  # the share that shows through the body
MANY, THIN = 40, 0.65  # more curves or points are drawn so much thinner, and hidden ones not at all
CASING = 1.4  # points of white around a line, so that it stands out from stripes and colours
FINE, DASH = 0.01, 0.02  # of the body's size: the pieces of a line, and of a dashed one
# Parts of perceptually uniform maps: a yellow line is too pale on a pale body, and no colour is in both.
MAPS = {"angle": ("plasma", 0.0, 0.87), "jump": ("viridis", 0.8, 0.3)}
ROUND = 30.0  # degrees: the ends and ticks of a scale of angles are multiples of it
LEAST_BOX, CROWD = 0.014, 0.02  # of the body's size: a box is drawn no smaller, and none so near another
UNDECIDED = CERTIFICATES["undecided"].colour


@dataclass(frozen=True)
class EdgeLook:
    """How curves of one kind are drawn: by the colours of a scale, or in one."""

    width: float
    dash: float = 0.0
    scale: str = ""
    colour: str = INK


LOOKS: Mapping[str, EdgeLook] = MappingProxyType(
    {
        "smooth joint": EdgeLook(0.8, colour="#5b6470"),
        "curvature jump": EdgeLook(2.4, DASH, "jump"),
        "unbounded curvature": EdgeLook(2.4, DASH / 2, colour=INK),
        "unresolved": EdgeLook(2.4, DASH / 2, colour=UNDECIDED),
        "edge": EdgeLook(2.8, scale="angle"),
    }
)
LABELS = 8  # more points than these are told apart by their dots alone
CORNER, MARK = 3.4, 6.0  # points
POINTS: Mapping[str, tuple[float, str]] = MappingProxyType({"corner": (CORNER, INK), "unresolved": (MARK, UNDECIDED)})


@dataclass(frozen=True)
class Marks:
    """What is drawn on a body, the scales of its colours with their names, and what a legend says of the rest."""

    strokes: tuple[Stroke, ...] = ()
    bars: tuple[Bar, ...] = ()
    handles: tuple[Artist, ...] = ()

    def __add__(self, other: Marks) -> Marks:
        """Draw others on top."""
        return Marks(self.strokes + other.strokes, self.bars + other.bars, self.handles + other.handles)


def mark_curves(
    curves: Sequence[SingularCurve | Feature], size: float, angles: Limits | None = None, jumps: Limits | None = None
) -> Marks:
    """Curves as lines on a body of this size: edges in colours of the dihedral angle, curvature jumps dashed.

    Of features of a mesh, those that one sees as edges. Ends of the scales may be given; otherwise they follow from
    the curves.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> half = rsym.Shape(rsym.conjunction(1 - x**2 - y**2 - z**2, z), (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> marks = mark_curves(rsym.mesh(half, 16).features, 2.0)
    >>> [(bar.label, bar.ticks) for bar in marks.bars]
    [('dihedral angle in degrees', (60.0, 90.0, 120.0))]
    """
    known = [*(one for one in curves if isinstance(one, SingularCurve)), *_edges(curves)]
    between = angles or angle_limits(known)
    first, last = (math.ceil(end / ROUND) for end in between)
    ticks = tuple(ROUND * k for k in range(first, last + 1))
    bars = {
        "angle": Bar(_scale("angle", between), "dihedral angle in degrees", "neither", ticks),
        "jump": Bar(_scale("jump", jumps or jump_limits(known)), "jump of normal curvature, dashed", "neither"),
    }
    known, places = [one for one in known if len(one.points) > 1], [one for one in known if len(one.points) == 1]
    width, hidden = (THIN, 0.0) if len(known) > MANY else (1.0, HIDDEN)
    drawn, handles, used = [], list[Artist](), list[Bar]()
    for kind, look in LOOKS.items():
        alike = [curve for curve in known if curve.kind == kind]
        if not alike:
            continue
        bar = bars.get(look.scale)
        pieces, light = _coloured(alike, look, bar, size)
        drawn.append(Stroke(pieces, look.colour if light is None else light, width * look.width, hidden))
        used += [bar] if bar else []
        handles += [] if bar else [_handle(counted(kind, len(alike)), look)]
    cased = [Stroke(stroke.pieces, "white", stroke.width + width * CASING) for stroke in drawn]
    return Marks((*cased, *drawn), tuple(used[::-1]), tuple(handles)) + _open_places(places)


def _open_places(curves: Sequence[SingularCurve]) -> Marks:
    """What may be a curve and has one point as dots."""
    if not curves:
        return Marks()
    places = np.concatenate([curve.points for curve in curves])
    handle = _dot("unresolved", len(curves), CORNER, UNDECIDED)
    return Marks(tuple(dots(places, UNDECIDED, CORNER, HIDDEN)), (), (handle,))


def _handle(label: str, look: EdgeLook) -> Artist:
    style = (0, (1.2, 0.8)) if look.dash else "solid"
    return Line2D([], [], color=look.colour, linewidth=look.width, linestyle=style, label=label)


def labelled(points: Sequence[SingularPoint]) -> tuple[SingularPoint, ...]:
    """The points that have their kind beside them: a few, none of them a corner."""
    rare = tuple(point for point in points if point.kind != "corner")
    return rare if len(rare) <= LABELS else ()


def mark_points(points: Sequence[SingularPoint]) -> Marks:
    """Points as dots, corners smaller than others, with the count of each kind that has no label for a legend."""
    marks, told = Marks(), {point.kind for point in labelled(points)}
    for kind, count in Counter(point.kind for point in points).items():
        size, colour = POINTS.get(kind, (MARK, DEFECT))
        size, shows = (THIN * size, 0.0) if count > MANY else (size, HIDDEN if kind == "corner" else HIDDEN_POINT)
        places = np.array([point.point for point in points if point.kind == kind])
        handle = _dot(kind, count, size, colour)
        marks += Marks(tuple(dots(places, colour, size, shows)), (), () if kind in told else (handle,))
    return marks


def _dot(kind: str, count: int, size: float, colour: str) -> Artist:
    return Line2D([], [], marker="o", markersize=size, color=colour, linestyle="", label=counted(kind, count))


def mark_boxes(boxes: Floats, size: float) -> Marks:
    """Outlines of the boxes (n, 3, 2) in which nothing is proved, the small ones enlarged and thinned out."""
    if not len(boxes):
        return Marks()
    middles, halves = boxes.mean(axis=2), np.maximum(np.diff(boxes, axis=2)[..., 0], LEAST_BOX * size) / 2
    _, kept = np.unique(np.floor(middles / (CROWD * size)), axis=0, return_index=True)
    shown = np.stack([middles - halves, middles + halves], axis=2)[kept]
    handle = Line2D([], [], marker="s", markersize=6, markerfacecolor="none", color=UNDECIDED, linestyle="")
    handle.set_label(f"undecided: {plural(len(boxes), 'box', 'boxes')}")
    return Marks((Stroke(outlines(shown), UNDECIDED, 1.0, HIDDEN if len(shown) <= MANY else 0.0),), (), (handle,))


def outlines(boxes: Floats) -> Floats:
    """The edges (12n, 2, 3) of boxes (n, 3, 2).

    Examples
    --------
    >>> np.abs(np.diff(outlines(np.array([[[0, 1], [0, 2], [0, 3]]])), axis=1)).sum()
    np.int64(24)
    """
    corners = list(product((0, 1), repeat=3))
    ends = np.array([(a, b) for a, b in combinations(corners, 2) if sum(map(int.__ne__, a, b)) == 1])
    edges: Floats = np.take_along_axis(boxes[:, None, None], ends[None, ..., None], axis=4)[..., 0]
    return edges.reshape(-1, 2, 3)


def _edges(curves: Sequence[SingularCurve | Feature]) -> list[SingularCurve]:
    """The features that are seen, as edges of which nothing is proved."""
    features = visible([one for one in curves if isinstance(one, Feature)], SMOOTH)
    return [
        SingularCurve(
            one.points, math.nan, "edge", "G0", one.names, one.normals, one.angles, np.full(len(one.points), math.nan)
        )
        for one in features
    ]


def _coloured(
    curves: Sequence[SingularCurve], look: EdgeLook, bar: Bar | None, size: float
) -> tuple[Floats, Floats | None]:
    """Pieces of all curves of one kind, and their light if it follows from a scale."""
    found = [_pieces(curve.points, _values(curve, look.scale), size, look.dash) for curve in curves]
    pieces, values = (np.concatenate(part) for part in zip(*found, strict=True))
    if bar is None:
        return pieces, None
    light = decode(bar.scale.to_rgba(values)[:, :3])
    light[np.isnan(values)] = linear(UNDEFINED)
    return pieces, light


def _values(curve: SingularCurve, scale: str) -> Floats:
    """What the colours of a curve show."""
    if not scale:
        return np.zeros(len(curve.points))
    return curve.dihedral_angles if scale == "angle" else curve.curvature_jumps


def _pieces(points: Floats, values: Floats, size: float, dash: float) -> tuple[Floats, Floats]:
    """Short pieces (n, 2, 3) of a polyline, every second one left out if it is dashed, and their values (n,)."""
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    step = max((dash or FINE) * size, 1e-9 * along[-1])
    count = max(2 * round(along[-1] / step / 2), 1)
    cuts = along[-1] * np.arange(count + 1) / count
    at = np.unique(np.concatenate([along, cuts]))
    places = np.stack([np.interp(at, along, points[:, axis]) for axis in range(3)], axis=1)
    middles = (at[1:] + at[:-1]) / 2
    number = np.searchsorted(cuts, middles) - 1
    kept = number % 2 == 0 if dash else np.full(len(middles), True)
    pieces = np.stack([places[:-1], places[1:]], axis=1)
    return pieces[kept], np.interp(middles, along, values)[kept]


def _scale(name: str, limits: Limits) -> ScalarMappable:
    colours, first, last = MAPS[name]
    table = ListedColormap(colormaps[colours](np.linspace(first, last, 256)), f"part of {colours}")
    return ScalarMappable(Normalize(*limits), table)


def angle_limits(curves: Sequence[SingularCurve]) -> Limits:
    """Multiples of 30 degrees, between which the dihedral angles of the edges lie."""
    known = _finite([curve.dihedral_angles for curve in curves if curve.kind == "edge"])
    if not len(known):
        return 0.0, 180.0
    # Half a degree short of a round angle is rounding, or the mesh.
    low, high = math.floor((known.min() + 0.5) / ROUND) * ROUND, math.ceil((known.max() - 0.5) / ROUND) * ROUND
    return (low, high) if low < high else (low - ROUND, high + ROUND)


def jump_limits(curves: Sequence[SingularCurve]) -> Limits:
    """From none to the largest."""
    largest = _finite([curve.curvature_jumps for curve in curves if curve.kind == "curvature jump"]).max(initial=0.0)
    return 0.0, float(largest) or 1.0


def _finite(samples: Sequence[Floats]) -> Floats:
    known = np.concatenate([np.empty(0), *samples])
    return np.asarray(known[np.isfinite(known)])
