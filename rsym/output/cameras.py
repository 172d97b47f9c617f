"""Where the eye stands: a camera, and what becomes of it over a body and a number of pixels, the one projection."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.wording import proposal
from rsym.output.shading import AZIMUTH, ELEVATION
from rsym.sampling.pencils import Pencil

# Elevation and azimuth. What drives along y, as the car does, is seen from its front at y > 0, from its left at x < 0;
# from the top x points to the right and y upwards, as on paper.
VIEWS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "front": (0.0, 90.0),
        "rear": (0.0, -90.0),
        "left": (0.0, 180.0),
        "right": (0.0, 0.0),
        "top": (90.0, -90.0),
        "bottom": (-90.0, -90.0),
        "front-left": (ELEVATION, 180.0 - AZIMUTH),
        "front-right": (ELEVATION, AZIMUTH),
        "rear-left": (ELEVATION, AZIMUTH - 180.0),
        "rear-right": (ELEVATION, -AZIMUTH),
    }
)
MARGIN = 0.03  # of the picture's shorter side, left free round what is shown
FIELDS = (1.0, 150.0)  # degrees of view: below nobody sees a difference to parallel rays, beyond all is distorted


@dataclass(frozen=True)
class Camera:
    """Where the eye stands and how much it sees; parallel rays unless a field of view is given.

    The picture's axes are, for the elevation e and the azimuth a,

        right = (-sin a, cos a, 0),  up = (-sin e cos a, -sin e sin a, cos e),  towards the eye = right x up.

    Parameters
    ----------
    elevation, azimuth : float
        The direction of the eye in degrees: above the xy-plane, and from the x-axis towards the y-axis.
    field_of_view : float, optional
        The angle in degrees that the height of the picture spans: rays from one eye. Without it rays are parallel, and
        equal lengths stay equal.
    target : three numbers, optional
        What is in the middle of the picture; without it the middle of the body as it is seen.
    distance : float, optional
        Of the eye from the target, with a field of view; without it such that the body fills the picture.
    up : three numbers, optional
        The direction that points upwards in the picture; without it z.
    zoom : float
        How much larger all is than what just fits.

    Raises
    ------
    RsymError
        For what is no finite number, a field of view outside of 1 to 150 degrees, a distance or a zoom that is not
        positive, a distance without a field of view, or an up that points along the line of sight.

    Examples
    --------
    >>> front = Camera.named("front")
    >>> front.elevation, front.azimuth
    (0.0, 90.0)
    >>> front.axes.round(12).tolist()
    [[-1.0, 0.0, 0.0], [-0.0, -0.0, 1.0], [0.0, 1.0, 0.0]]
    """

    elevation: float = ELEVATION
    azimuth: float = AZIMUTH
    field_of_view: float | None = None
    target: tuple[float, float, float] | None = None
    distance: float | None = None
    up: tuple[float, float, float] | None = None
    zoom: float = 1.0

    def __post_init__(self) -> None:
        for name in ("elevation", "azimuth", "zoom", "field_of_view", "distance"):
            given = getattr(self, name)
            if given is not None or name in ("elevation", "azimuth", "zoom"):
                object.__setattr__(self, name, _number(name, given))
        for name in ("target", "up"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _three(name, getattr(self, name)))
        if self.field_of_view is not None and not FIELDS[0] <= self.field_of_view <= FIELDS[1]:
            raise _refused("field_of_view", f"lies in {FIELDS[0]:g} to {FIELDS[1]:g} degrees", self.field_of_view, "35")
        if self.zoom <= 0:
            raise _refused("zoom", "is positive", self.zoom, "2")
        if self.distance is not None and (self.distance <= 0 or self.field_of_view is None):
            raise _refused("distance", "is positive and goes with a field of view", self.distance, "field_of_view=35")
        if not np.isfinite(self.axes).all():
            raise _refused("up", "does not point along the line of sight", self.up, "(0, 0, 1)")

    @classmethod
    def named(cls, name: str) -> Camera:
        """The camera of a name: front, rear, left, right, top, bottom, front-left, front-right, rear-left, rear-right.

        Raises
        ------
        RsymError
            For another name.
        """
        if name not in VIEWS:
            remedy = proposal(name, VIEWS, f"choose from {', '.join(VIEWS)}, or give a Camera(elevation=, azimuth=)")
            raise RsymError(f"no view {name!r}", code="camera", remedy=remedy)
        return cls(*VIEWS[name])

    @cached_property
    def axes(self) -> Floats:
        """The directions right, up and towards the eye as rows (3, 3), in the coordinates of the model."""
        e, a = math.radians(self.elevation), math.radians(self.azimuth)
        right = np.array([-math.sin(a), math.cos(a), 0.0])
        up = np.array([-math.sin(e) * math.cos(a), -math.sin(e) * math.sin(a), math.cos(e)])
        towards = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
        if self.up is not None:
            across = np.cross(self.up, towards)
            length = float(np.sqrt(across @ across))
            # A sine below 1e-9 is no direction in float64.
            right = across / length if length > 1e-9 * float(np.sqrt(np.dot(self.up, self.up))) else right * np.nan
            up = np.cross(towards, right)
        return np.stack([right, up, towards])

    def frame(self, points: Floats, size: tuple[int, int], whole: Floats | None = None) -> Viewport:
        """What a picture of so many pixels, width and height, shows: all points (n, 3), as large as they go.

        Parallel rays begin before all points of the `whole`, by default these.

        Examples
        --------
        >>> view = Camera.named("top").frame(np.array([[-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]]), (100, 100))
        >>> places, depths = view.project(np.array([[0.0, 0.0, 2.0], [0.0, 0.5, 0.0]]))
        >>> places.round(9).tolist(), bool(depths[1] - depths[0] == 2)
        ([[49.5, 49.5], [49.5, 26.0]], True)
        """
        axes, room = self.axes, np.array(size) / 2 - max(MARGIN * min(size), 1.0)
        centre = ((size[0] - 1) / 2, (size[1] - 1) / 2)
        seen = points @ axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        span = max(float((high - low).max()), float(np.finfo(np.float32).tiny))
        middle = (low + high) / 2 if self.target is None else axes @ self.target
        offsets = seen - middle
        reach = np.maximum(np.abs(offsets[:, :2]).max(axis=0), 1e-6 * span)
        beyond = seen if whole is None else whole @ axes.T
        front = float((beyond[:, 2] - middle[2]).max()) + 0.01 * span
        if self.field_of_view is None:
            pixel = float((reach / room).max()) / self.zoom
            return Viewport(size, axes, axes.T @ middle, pixel, None, max(front, 0.0), centre)
        slope = 2 * math.tan(math.radians(self.field_of_view) / 2) / size[1]
        near = offsets[:, 2] + (np.abs(offsets[:, :2]) / (slope * room)).max(axis=1)
        distance = (
            max(float(near.max()), float(offsets[:, 2].max()) + 0.01 * span) if self.distance is None else self.distance
        )
        return Viewport(size, axes, axes.T @ middle, slope * distance / self.zoom, distance, 0.0, centre)


@dataclass(frozen=True)
class Viewport:
    """A camera over so many pixels: which ray a pixel casts, and which pixel a point is seen at.

    The middle of pixel (row, column) has the place ``column, row``, the first row is at the top.

    Attributes
    ----------
    size : (int, int)
        Width and height in pixels.
    axes : (3, 3) array
        Right, up and towards the eye.
    middle : (3,) array
        What is seen in the middle of the picture.
    pixel : float
        The side of a pixel in the plane through the middle across the line of sight.
    distance : float or None
        From the eye to the middle; None for parallel rays.
    front : float
        How far before the middle parallel rays begin.
    centre : (float, float)
        The place, column and row, where the middle is seen.
    """

    size: tuple[int, int]
    axes: Floats
    middle: Floats
    pixel: float
    distance: float | None
    front: float
    centre: tuple[float, float]

    @cached_property
    def pencil(self) -> Pencil:
        """The rays through the middles of all pixels."""
        right, up, towards = self.axes
        column, row = self.centre
        corner = self.middle + self.front * towards + self.pixel * ((row + 0.5) * up - (column + 0.5) * right)
        across, down = self.pixel * right, -self.pixel * up
        if self.distance is None:
            return Pencil(self.size, _triple(corner), _triple(across), _triple(down), direction=_triple(-towards))
        eye = self.middle + self.distance * towards
        return Pencil(self.size, _triple(corner), _triple(across), _triple(down), eye=_triple(eye))

    def rays(self, columns: Floats, rows: Floats) -> tuple[Floats, Floats]:
        """The origins (n, 3) and unit directions (n, 3) of the rays of places (n,), which need not be whole numbers."""
        return self.pencil.rays(columns + 0.5, rows + 0.5)

    def pixel_at(self, depth: Floats) -> Floats:
        """The side of a pixel so far along its ray, the obliqueness of rays left out."""
        still, growing = self.pencil.pixel
        return np.asarray(still + growing * depth)

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """The places (n, 2), column and row, where points (n, 3) are seen, and how far along their rays they lie."""
        seen = (points - self.middle) @ self.axes.T
        if self.distance is None:
            scale, depth = np.full(len(seen), 1 / self.pixel), self.front - seen[:, 2]
        else:
            scale = self.distance / (self.pixel * (self.distance - seen[:, 2]))
            from_eye = seen - np.array([0.0, 0.0, self.distance])
            depth = np.sqrt(np.einsum("ij,ij->i", from_eye, from_eye))
        column, row = self.centre
        places = np.stack([column + seen[:, 0] * scale, row - seen[:, 1] * scale], axis=1)
        return places, depth


def _triple(values: Floats) -> tuple[float, float, float]:
    first, second, third = values.tolist()
    return first, second, third


def camera_of(camera: Any) -> Camera:
    """A camera, or that of a name; None is the usual one."""
    if camera is None or isinstance(camera, Camera):
        return camera or Camera()
    if isinstance(camera, str):
        return Camera.named(camera)
    raise RsymError(
        f"expected a Camera or a name, got {type(camera).__name__}", code="camera", remedy='for example "front-left"'
    )


def _number(name: str, given: Any) -> float:
    try:
        number = float(given)
    except (TypeError, ValueError):
        number = math.nan
    if isinstance(given, str | bool) or not math.isfinite(number):
        raise _refused(name, "is a finite number", given, "30")
    return number


def _three(name: str, given: Any) -> tuple[float, float, float]:
    if not isinstance(given, Sequence | np.ndarray) or isinstance(given, str) or len(given) != 3:
        raise _refused(name, "is three numbers", given, "(0, 0, 1)")
    first, second, third = (_number(name, one) for one in given)
    return first, second, third


def _refused(name: str, what: str, given: Any, example: str) -> RsymError:
    example = example if "=" in example else f"{name}={example}"
    return RsymError(f"{name} of a camera {what}, got {given!r}", code="camera", remedy=f"for example {example}")
