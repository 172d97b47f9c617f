"""Three-dimensional axes for a body: true proportions, few ticks, nothing that overlaps or is cut off."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.backend_bases import RendererBase
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure, FigureBase
from matplotlib.legend import Legend
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import Axes3D

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.output.cameras import Camera
from rsym.output.shading import unit

WIDTH = 7.0  # inches, of a figure made here; its height follows from the body
LOWEST, HIGHEST = 3.2, 7.5
MARGIN, TOP_MARGIN = 47.0, 10.0  # points around the box, for ticks and labels; none stand above it
TICK_OFFSET, LABEL_OFFSET, STEEP_OFFSET = 9.0, 28.0, 9.0  # points from an axis line
TICK_SPACING, TICK_CLEARANCE = 42.0, 7.0  # points between ticks, and from the ends
NUMBER_SIZE = (22.0, 11.0)  # points, of the label of a tick
GREY = "#555555"
BAR_ROOM = 0.95  # inches for a colour bar


class BodyAxes(Axes3D):  # type: ignore[misc]
    """3D axes whose square may hang out of the figure; only the visible part counts when a picture is trimmed."""

    def get_window_extent(self, renderer: RendererBase | None = None) -> Bbox:
        """Return the visible part of the axes in pixels."""
        return Bbox.intersection(self.bbox, self.figure.bbox) or self.bbox


def new_axes(low: Floats, high: Floats, elevation: float, azimuth: float, camera: Camera | None = None) -> Axes3D:
    """Make a pyplot figure whose height suits the body, filled by one 3D axes."""
    from matplotlib import pyplot as plt

    return page_axes(plt.figure(), low, high, elevation, azimuth, camera)


def page_axes(
    figure: Figure, low: Floats, high: Floats, elevation: float, azimuth: float, camera: Camera | None = None
) -> Axes3D:
    """Fill an empty figure by one 3D axes and give it a height that suits the body.

    mplot3d draws into a square round the middle of the box. The square is made
    so large that box and labels just fill the figure.
    """
    figure.set_size_inches(WIDTH, WIDTH)
    axes = add_axes(figure, (0.0, 0.0, 1.0, 1.0))
    frame(axes, low, high, elevation, azimuth, camera=camera)
    corners = (_silhouette(axes) - axes.bbox.size / 2) / figure.dpi
    least, most = corners.min(axis=0), corners.max(axis=0)
    margin, above = MARGIN / 72, (MARGIN if elevation < 0 else TOP_MARGIN) / 72
    growth = (WIDTH - 2 * margin) / (most[0] - least[0])
    height = float(np.clip(growth * (most[1] - least[1]) + margin + above, LOWEST, HIGHEST))
    growth = min(growth, (height - margin - above) / (most[1] - least[1]))
    size = np.array([WIDTH, height])
    centre = (size + np.array([0.0, margin - above]) - growth * (least + most)) / 2
    half = np.maximum(centre, size - centre).max()
    figure.set_size_inches(*size)
    axes.set_position((*((centre - half) / size), *(2 * half / size)))
    return axes


def add_axes(figure: FigureBase, place: Any) -> BodyAxes:
    """Put 3D axes with a faint grid into a figure or a part of one; left, bottom, width, height are shares of it."""
    with rc_context({"grid.color": "#e6e6e6", "grid.linewidth": 0.6}):
        axes = BodyAxes(figure, place)
    figure.add_axes(axes)
    axes.patch.set_in_layout(False)
    axes.patch.set_visible(False)
    return axes


@dataclass(frozen=True)
class Bar:
    """What a colour bar shows: a scale, its name, at which ends values lie beyond, and where its ticks are."""

    scale: ScalarMappable
    label: str
    extend: str | None = None  # as the colours have it
    ticks: tuple[float, ...] | None = None


def colour_bar(axes: Axes3D, shown: Bar) -> None:
    """Widen a figure that one 3D axes fills, and put a colour bar beside it."""
    figure: Any = axes.figure
    left = _widen(axes, BAR_ROOM)
    width = figure.get_size_inches()[0]
    place = figure.add_axes((left, 0.2, 0.16 / width, 0.6))
    bar = figure.colorbar(shown.scale, cax=place, extend=shown.extend, ticks=shown.ticks)
    bar.set_label(shown.label)
    bar.ax.tick_params(labelsize=8, length=2)


def legend(axes: Axes3D, colours: Mapping[str, str]) -> None:
    """Widen a figure that one 3D axes fills, and list names and their colours beside it."""
    figure: Any = axes.figure
    key = named_colours(figure, colours)
    width = key.get_window_extent(figure.canvas.get_renderer()).width / figure.dpi
    key.set_bbox_to_anchor((_widen(axes, width + 0.2), 0.5))


def named_colours(figure: Figure, colours: Mapping[str, str]) -> Legend:
    """List names and their colours in a figure, to be put in a place."""
    handles = [Patch(facecolor=colour, edgecolor=GREY, linewidth=0.5, label=name) for name, colour in colours.items()]
    return figure.legend(handles=handles, loc="center left", frameon=False, fontsize=9, borderaxespad=0.0)


def _widen(axes: Axes3D, room: float) -> float:
    """Add so many inches on the right of all that a figure shows; return the share where they begin."""
    figure: Any = axes.figure
    width, height = figure.get_size_inches()
    wide = width + room
    figure.set_size_inches(wide, height)
    for one in figure.axes:
        place = one.get_position(original=True)
        one.set_position((place.x0 * width / wide, place.y0, place.width * width / wide, place.height))
    return float(width / wide)


def add_room(axes: Axes3D, *, below: float, above: float) -> None:
    """Add so many inches below and above all that a figure shows."""
    figure: Any = axes.figure
    width, height = figure.get_size_inches()
    tall = height + below + above
    figure.set_size_inches(width, tall)
    for one in figure.axes:
        place = one.get_position(original=True)
        one.set_position((place.x0, (place.y0 * height + below) / tall, place.width, place.height * height / tall))


def require_axes3d(axes: object) -> Axes3D:
    """Refuse axes that are not three-dimensional."""
    if not isinstance(axes, Axes3D):
        raise RsymError(
            f"a mesh is drawn on 3D axes, got {type(axes).__name__}",
            code="axes",
            remedy='make them by figure.add_subplot(projection="3d"), or leave ax out',
        )
    return axes


def frame(
    axes: Axes3D,
    low: Floats,
    high: Floats,
    elevation: float,
    azimuth: float,
    *,
    margin: float = MARGIN,
    camera: Camera | None = None,
) -> None:
    """Point the camera and fit the box [low, high] into the axes with equal scales, so many points from their ends.

    A camera stands in the place of elevation and azimuth, and says how rays run.
    """
    size = np.maximum(high - low, 1e-3 * max(float((high - low).max()), np.finfo(float).tiny))
    middle = (low + high) / 2
    if camera is None:
        axes.view_init(elev=elevation, azim=azimuth)
    else:
        point_camera(axes, camera)
    for set_limits, centre, length in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, size, strict=True):
        set_limits(centre - 0.51 * length, centre + 0.51 * length)
    zoom = 1.0
    # Perspective makes the size of the picture not quite proportional to the zoom: a few steps settle it.
    for _ in range(4):
        axes.set_box_aspect(size, zoom=zoom)
        zoom *= _room(axes, margin)
    if camera is not None and camera.zoom != 1:
        axes.set_box_aspect(size, zoom=camera.zoom * zoom)


def point_camera(axes: Axes3D, camera: Camera) -> None:
    """Look from where a camera stands, with parallel rays or its field of view."""
    if camera.target is not None or camera.distance is not None:
        raise RsymError(
            "axes show the whole body: their camera has no target and no distance",
            code="camera",
            remedy="leave them out, or render(shape, camera=)",
        )
    # mplot3d turns the picture about the line of sight, from where z points upwards.
    right, up, _ = replace(camera, up=None).axes
    roll = float(np.degrees(np.arctan2(camera.axes[1] @ right, camera.axes[1] @ up)))
    axes.view_init(elev=camera.elevation, azim=camera.azimuth, roll=roll)
    if camera.field_of_view is None:
        axes.set_proj_type("ortho")
    else:
        axes.set_proj_type("persp", focal_length=1 / np.tan(np.radians(camera.field_of_view) / 2))


def _silhouette(axes: Axes3D) -> Floats:
    """Return the eight corners of the box in pixels, (8, 2)."""
    axes.apply_aspect()
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    corners = np.stack(np.meshgrid(*limits, indexing="ij"), axis=-1).reshape(-1, 3)
    return project(axes, corners)[:, :2]


def project(axes: Axes3D, points: Floats) -> Floats:
    """Project points (n, 3) to x, y in pixels of the figure and depth, by the camera's present place."""
    homogeneous = points @ axes.get_proj()[:, :3].T + axes.get_proj()[:, 3]
    screen: Floats = homogeneous[:, :3] / homogeneous[:, 3:]
    screen[:, :2] = axes.transData.transform(screen[:, :2])
    return screen


def turning(axes: Axes3D, points: Floats, normals: Floats) -> Floats:
    """Return for points (n, 3) of a surface how far it turns to the eye: > 0 if it winds counter-clockwise there."""
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    nearby = 1e-4 * float(np.ptp(limits, axis=1).max())
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    along = unit(np.cross(normals, least))
    across = np.cross(normals, along)
    here, right, up = (project(axes, points + nearby * way)[:, :2] for way in (0 * along, along, across))
    (a, b), (c, d) = (right - here).T, (up - here).T
    area: Floats = a * d - b * c
    return area


def camera(axes: Axes3D) -> tuple[Floats, int]:
    """Return the matrix that turns normals of the data to the camera's right, up and towards, and a handedness.

    Normals go by the inverse of the stretch from data to box. The sign is -1
    where inverted axes mirror the body, so that its triangles wind the other way.
    """
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    stretch = np.asarray(axes.get_box_aspect()) / np.diff(limits, axis=1)[:, 0]
    right, up = unit(axes.get_proj()[:2, :3] / stretch)
    turn = np.stack([right, up, np.cross(right, up)])
    return turn / stretch * np.abs(stretch).max(), int(np.sign(stretch.prod()))


def _room(axes: Axes3D, margin: float) -> float:
    """Return by how much the box may grow, with a margin in points, in the visible part of the axes."""
    figure = axes.figure
    low, high = np.maximum(axes.bbox.min, figure.bbox.min), np.minimum(axes.bbox.max, figure.bbox.max)
    margin = min(margin * figure.dpi / 72, 0.16 * float((high - low).min()))
    above = min(TOP_MARGIN * figure.dpi / 72, margin) if axes.elev >= 0 else margin
    middle = (axes.bbox.min + axes.bbox.max) / 2
    corners = _silhouette(axes) - middle
    low, high = low + margin - middle, high - (margin, above) - middle
    return float(min((low / corners.min(axis=0)).min(), (high / corners.max(axis=0)).min()))


class InnerTicks(MaxNLocator):
    """A few round ticks, none so near another or an end that labels meet.

    Parameters
    ----------
    span : (2,) array
        How far the axis runs on the page, in points.
    """

    def __init__(self, span: Floats) -> None:
        self.length = max(float(np.hypot(*span)), 1.0)
        self.count = int(np.clip(self.length / TICK_SPACING, 1, 8))
        # Numbers are wider than high: two of them are clear of each other sideways or upwards.
        self.apart = min(
            room / max(abs(part) / self.length, 1e-3) for room, part in zip(NUMBER_SIZE, span, strict=True)
        )
        super().__init__(nbins=self.count, steps=[1, 2, 2.5, 5, 10])

    def tick_values(self, vmin: float, vmax: float) -> Sequence[float]:
        """Return the ticks for an axis from vmin to vmax, two or more if that can be had."""
        low, high = min(vmin, vmax), max(vmin, vmax)
        gap = min(TICK_CLEARANCE / self.length, 0.25) * (high - low)
        for count in range(self.count, 2 * self.count + 5):
            self.set_params(nbins=count)
            ticks = [tick for tick in super().tick_values(low, high) if low + gap <= tick <= high - gap]
            if len(ticks) > 1:
                distance = (ticks[1] - ticks[0]) / (high - low) * self.length
                stride = int(np.ceil(self.apart / distance))
                return ticks[(len(ticks) - 1) % stride // 2 :: stride]
        return ticks


def style(axes: Axes3D) -> None:
    """Label the axes, thin the ticks, and make the panes step back."""
    figure = axes.figure
    points = 72 / figure.dpi
    axis_lines = (axes.xaxis, axes.yaxis, axes.zaxis)
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    middle = limits.mean(axis=1)
    ends = np.where(np.eye(3, dtype=bool)[:, None, :], limits.T[None], middle).reshape(-1, 3)
    spans = (np.diff(project(axes, ends)[:, :2].reshape(3, 2, 2), axis=1)[:, 0]) * points
    for index, (axis, label) in enumerate(zip(axis_lines, "xyz", strict=True)):
        axis.set_label_text(label)
        axis.set_major_locator(InnerTicks(spans[index]))
        unit_offset = _offset(axes, spans, index)
        # Numbers are wider than high: beside a steep axis they need more room.
        extra = STEEP_OFFSET * abs(spans[index, 1]) / max(float(np.hypot(*spans[index])), 1e-9)
        axis.set_tick_params(pad=(TICK_OFFSET + extra) / unit_offset - 8, labelsize=8, labelcolor=GREY, color=GREY)
        axis.labelpad = (LABEL_OFFSET + 1.5 * extra) / unit_offset - 21
        axis.label.set_size(10)
        axis.line.set_color("#aaaaaa")
        axis.line.set_linewidth(0.7)
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.pane.set_edgecolor("#e0e0e0")


def _offset(axes: Axes3D, spans: Floats, index: int) -> float:
    """Return by how many points one unit of padding moves a label away from an axis line.

    mplot3d moves labels along the other two axes by 8 % of *their* lengths
    times 48 over the axes' size in points, per unit: far from a short axis
    of a slender body, not at all from its long one. With this number the
    padding can be chosen so that each label gets the distance asked for.
    """
    figure: Any = axes.figure
    size = float(np.sum(axes.bbox.size)) * 72 / figure.dpi
    along = spans[index] / max(float(np.hypot(*spans[index])), 1e-9)
    others = np.delete(spans, index, axis=0)
    across = np.abs(others[:, 0] * along[1] - others[:, 1] * along[0]).sum()
    return float(max(across, 1.0) * 0.08 * 48 / size)
