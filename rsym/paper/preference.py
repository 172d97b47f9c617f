"""Why omega_n is preferred to omega: gradients, range, and error as a distance, measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.model.shape import Shape
from rsym.paper.drawing import mesh_quietly
from rsym.paper.models import car, skeleton_body
from rsym.sampling.distances import distance_to_lines, distance_to_mesh
from rsym.sampling.level_lines import dense_outline

FIELDS = ("value", "gradient_squared", "normalised", "normalised_gradient_squared")
NAMES = (("ω", "value"), ("ωₙ", "normalised"))
QUANTILES = (0.0, 0.25, 0.5, 0.75, 1.0)
BAND = 0.2  # how far from the boundary, in units of the model; farther off omega_n bends towards 1
WIDE = 0.5  # a second band, wide enough to show the bend
# Nearer to the boundary the distance from a polyline or a mesh is not exact enough to divide by.
NEAREST = 0.02
POINTS = 60_000  # thrown into the bounds; those in the band are used
SEED = 2013
BINS = 20
MOST_SHOWN = 0.6
COLOURS = {"value": "#c2571a", "normalised": "#2a6fa8"}


@dataclass(frozen=True)
class Quartiles:
    """Least value, quartiles and greatest value of one quantity for one function of one body."""

    body: str
    quantity: str
    function: str
    quantiles: tuple[float, float, float, float, float]


@dataclass(frozen=True)
class Band:
    """Points near a boundary: their distances, negative outside, and the fields there."""

    body: str
    distance: Floats
    fields: dict[str, Floats]

    def error(self, name: str) -> Floats:
        """|omega|/distance - 1, or the same of omega_n."""
        result: Floats = np.abs(self.fields[name]) / np.abs(self.distance) - 1
        return result


@lru_cache(maxsize=1)
def measure() -> tuple[tuple[Quartiles, ...], tuple[Band, ...]]:
    """Both bodies: the body of Fig. 11 in the plane and the whole car in space."""
    body, whole = skeleton_body(), car()
    lines = dense_outline(body, 800)
    # Its vertices avoid edges, where omega has no gradient; those of a sharp mesh lie on them.
    triangles = mesh_quietly(whole, 200, method="smooth")
    used = triangles.vertices[np.unique(triangles.faces)]
    studies = (
        _study("body of Fig. 11", body, np.concatenate(list(lines)), lambda points: distance_to_lines(points, lines)),
        _study("car", whole, used, lambda points: distance_to_mesh(points, triangles)),
    )
    return tuple(spread for spreads, _ in studies for spread in spreads), tuple(band for _, band in studies)


def _study(
    name: str, shape: Shape, boundary: Floats, distance: Callable[[Floats], Floats]
) -> tuple[list[Quartiles], Band]:
    """Measure on the boundary, in the band and in the bounds."""
    assert shape.bounds is not None
    kernel = compile(shape, FIELDS)
    low, high = np.array(shape.bounds).T
    points = np.random.default_rng(SEED).uniform(low, high, (POINTS, shape.dimension))
    on_it, around = kernel(*boundary.T), kernel(*points.T)
    distances = distance(points)
    band, wide = (_band(name, around, distances, reach) for reach in (BAND, WIDE))
    spreads = []
    for symbol, field in NAMES:
        squared = "gradient_squared" if field == "value" else "normalised_gradient_squared"
        quantities = {
            f"|∇{symbol}| on the boundary": np.sqrt(on_it[squared]),
            f"|∇{symbol}| in the band": np.sqrt(band.fields[squared]),
            f"{symbol} in the bounds": around[field],
            f"|{symbol}|/distance − 1 in the band": band.error(field),
            f"the same up to {WIDE:g} from the boundary": wide.error(field),
        }
        spreads += [Quartiles(name, title, symbol, _quantiles(values)) for title, values in quantities.items()]
    return spreads, band


def _band(name: str, around: dict[str, Floats], distances: Floats, reach: float) -> Band:
    """The points that lie between NEAREST and `reach` from the boundary."""
    near = (distances < reach) & (distances > NEAREST)
    fields = {field: around[field][near] for field in FIELDS}
    return Band(name, np.copysign(distances[near], fields["value"]), fields)


def _quantiles(values: Floats) -> tuple[float, float, float, float, float]:
    """Of the values that exist: at corners and on the skeleton there is no gradient."""
    least, first, middle, third, greatest = np.quantile(values[np.isfinite(values)], QUANTILES).tolist()
    return least, first, middle, third, greatest


def draw() -> Figure:
    """Two panels, one for each body: the values against the distance, median and middle 90 %."""
    _, bands = measure()
    figure = Figure(figsize=(9.0, 3.8), layout="constrained")
    for ax, band in zip(figure.subplots(1, 2), bands, strict=True):
        _panel(ax, band)
    return figure


def _panel(ax: Axes, band: Band) -> None:
    edges = np.linspace(-BAND, BAND, BINS + 1)
    number = np.digitize(band.distance, edges) - 1
    filled = np.unique(number)
    middles = ((edges[1:] + edges[:-1]) / 2)[filled]
    reach = BAND
    for symbol, (_, name) in zip((r"\omega", r"\omega_n"), NAMES, strict=True):
        values = band.fields[name]
        low, median, high = np.array([np.quantile(values[number == k], (0.05, 0.5, 0.95)) for k in filled]).T
        reach = max(reach, float(np.abs([low, high]).max()))
        ax.fill_between(middles, low, high, color=COLOURS[name], alpha=0.22, linewidth=0)
        ax.plot(middles, median, color=COLOURS[name], linewidth=1.6, label=f"${symbol}$: median, middle 90 %")
    ax.plot([-BAND, BAND], [-BAND, BAND], color="black", linewidth=0.9, linestyle="--", label="the distance itself")
    ax.axhline(0, color="0.8", linewidth=0.6, zorder=0)
    ax.axvline(0, color="0.8", linewidth=0.6, zorder=0)
    reach = min(1.1 * reach, MOST_SHOWN)
    ax.set(title=band.body, xlabel="signed distance from the boundary", xlim=(-BAND, BAND), ylim=(-reach, reach))
    ax.legend(fontsize=8, frameon=False, loc="upper left")
