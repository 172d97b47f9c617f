"""Meshes as shaded pictures on three-dimensional matplotlib axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import ArrayLike, NDArray

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.model.requirements import require_kind
from rsym.model.shape import Shape
from rsym.model.wording import documented
from rsym.output import axes3d
from rsym.output.bodies import FEATURE_WIDTH, Body, show
from rsym.output.cameras import Camera, camera_of
from rsym.output.castings import ShadedShape, shaded_shape
from rsym.output.ink import SMOOTH, Stroke, draw_lines, visible
from rsym.output.paints import NAMES_OF_MAPS, Coat, Spots, coat_of
from rsym.output.rasteriser import ScreenTriangles, picked, rasterise, snap
from rsym.output.shading import AZIMUTH, BODY, ELEVATION, HOLLOW_RADIUS, hollows, mean_depth, reduce, shade, unit
from rsym.output.singular import mark_curves
from rsym.sampling.mesh import Mesh
from rsym.sampling.sharp.features import Feature
from rsym.verify.answers.singular import SingularCurve

SAMPLES = 2  # per pixel and direction
BATCH = 1 << 14  # samples shaded at once: what is between steps stays in the cache, three times as fast as 1 << 18
EDGE_WIDTH = 0.3  # points
EDGE_LIGHT = 0.25  # what is left of the light on an edge


@documented(maps=NAMES_OF_MAPS)
def plot_mesh(
    mesh: Mesh | Shape,
    *,
    ax: Axes3D | None = None,
    colour: str = BODY,
    camera: Camera | str | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    edges: bool = False,
    features: bool | float = True,
    colour_by: str | ArrayLike | None = None,
    shape: Shape | None = None,
    letters: Mapping[Any, float] | None = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
    curves: Sequence[SingularCurve | Feature] = (),
) -> ShadedMesh | ShadedShape:
    """Draw a mesh, or a shape without one, as a shaded body with hidden surfaces removed.

    A shape is drawn by rays cast at its equation, as `render` does it: exact at any size, for less than a mesh takes.

    Parameters
    ----------
    mesh : Mesh or Shape
        The triangles; where the surface is open its inside shows in a warmer colour. Or a shape in space.
    ax : Axes3D, optional
        Where to draw; a new pyplot figure is made if it is left out.
    colour : str
        The colour of the body, as matplotlib writes colours.
    camera : Camera or str, optional
        Where the eye stands, or a name, as for `render`; parallel rays unless it has a field of view.
    elevation, azimuth : float
        Without a camera, in perspective, the direction of the eye in degrees: above the xy-plane, and from the x-axis
        towards the y-axis.
    edges : bool
        Whether to draw the edges of the triangles of a mesh.
    features : bool or float
        Whether to draw `mesh.features`, the curves along which leaves meet; a number is the least angle in degrees
        of those that are drawn, by default 10.
    colour_by : str or array, optional
        {maps}: a map of the exact curvature at every pixel, that
        of the leaf up to each edge; for a mesh of patches exact at every vertex and linear between;
        ``zebra``: the reflection of level stripes, kinked where the curvature jumps and broken at an edge;
        ``part``: a colour for each part of the shape (`Shape.named`, or the texts of a model file);
        or an array with one value for each vertex, or for each corner of each face. A new figure has a colour bar or
        the names of the parts, otherwise ``figure.colorbar(artist.scale, ax=ax)`` makes one, and ``artist.parts``
        maps names to colours.
    shape, letters
        What the mesh was made of: needed for curvatures (not by a mesh of patches), and for a zebra that is exact
        between vertices.
    limits : pair of numbers, optional
        The ends of a scale of values; by default 2 % of the surface lie below and 2 % above, or what is farther from
        zero of the two on both sides. Beyond the ends colours stay those of the ends, and the colour bar points there.
    colour_map : str, optional
        The colours of values; without it ``coolwarm`` for limits about zero, otherwise ``viridis``.
    curves : sequence
        Singular curves of a `BodyReport`, or `mesh.features`: edges in colours of the dihedral angle, jumps of the
        curvature dashed; ``artist.bars`` has the scales of their colours.

    Returns
    -------
    Artist
        The picture; its figure is ``artist.get_figure()``.

    Raises
    ------
    RsymError
        If `ax` is not three-dimensional, for an unknown camera or map, a mesh of unknown parts, an array that does not
        fit, limits that are not two numbers, the smaller first, or a shape where triangles or curves are asked for.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from rsym.sampling.mesh import Mesh
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> sides = np.cross(corners[faces[:, 1]] - corners[faces[:, 0]], corners[faces[:, 2]] - corners[faces[:, 0]])
    >>> normals = np.repeat(sides[:, None], 3, axis=1)
    >>> axes = Figure().add_subplot(projection="3d")
    >>> artist = plot_mesh(Mesh(corners, faces, normals), ax=axes)
    >>> artist.axes is axes
    True
    """
    eye = None if camera is None else camera_of(camera)
    if eye is not None:
        elevation, azimuth = eye.elevation, eye.azimuth
    if isinstance(mesh, Shape):
        if edges or curves or shape is not None or not isinstance(features, bool):
            raise RsymError(
                "edges, curves, shape and an angle of features belong to a mesh, got a Shape",
                code="mesh",
                remedy="leave them out, or draw rsym.mesh(shape)",
            )
        cast = shaded_shape(mesh, colour, colour_by, letters, limits, colour_map, lines=features)
        return show(cast, ax, elevation, azimuth, eye)
    require_kind(Mesh, mesh, "mesh")
    if not len(mesh.faces):
        raise RsymError(
            "the mesh has no triangles", code="no-surface", remedy="look where the surface lies: rsym.extent"
        )
    coat = coat_of(mesh, mesh.normals, colour, colour_by, shape, letters, limits, colour_map)
    marks = mark_curves(curves, float(np.ptp(mesh.vertices, axis=0).max()))
    artist = ShadedMesh(mesh, coat, edges=edges, features=features, strokes=marks.strokes, bars=marks.bars)
    return show(artist, ax, elevation, azimuth, eye)


class ShadedMesh(Body):
    """A mesh that is projected, rasterised and lit anew, at the renderer's own resolution, whenever it is drawn."""

    def __init__(
        self,
        mesh: Mesh,
        coat: Coat,
        *,
        edges: bool = False,
        features: bool | float = True,
        strokes: Sequence[Stroke] = (),
        bars: Sequence[axes3d.Bar] = (),
    ) -> None:
        self.mesh = mesh
        self.edges = edges
        self.lines, self.beside = _lines(mesh, SMOOTH if features is True else 180.1 if features is False else features)
        self.strokes = tuple(stroke for stroke in strokes if len(stroke.pieces))
        shown = [mesh.vertices[np.unique(mesh.faces)], *(stroke.pieces.reshape(-1, 3) for stroke in self.strokes)]
        super().__init__(np.concatenate(shown), coat.scale, coat.label, coat.parts, bars)
        self.normals = mesh.normals
        self.paint = coat.paint

    def _picture(self, axes: Axes3D, scale: float, point: float) -> tuple[Ints, NDArray[np.uint8]]:
        corners = _on_screen(axes, self.mesh.vertices, scale)[self.mesh.faces]
        # Half of a line along an outline lies beside the body.
        widths = [FEATURE_WIDTH if len(self.lines) else 0.0, *(stroke.width for stroke in self.strokes)]
        room, places = np.ceil(max(widths) * point / 2), _on_screen(axes, self.points, scale)[:, :2]
        least, most = places.min(axis=0) - room, places.max(axis=0) + room
        low = np.maximum(np.floor(least), 0).astype(np.int64)
        high = np.minimum(np.ceil(most), np.ceil(axes.bbox.size * scale)).astype(np.int64)
        width, height = np.maximum(high - low, 0) * SAMPLES
        if not width or not height:
            return low, np.zeros((0, 0, 4), np.uint8)
        corners[..., :2] = (corners[..., :2] - low) * SAMPLES
        edge = EDGE_WIDTH * point * SAMPLES if self.edges else 0.0
        turn, mirrored = axes3d.camera(axes)
        triangles, names = self._facing_triangles(corners, mirrored)
        nearest = rasterise(triangles, (int(height), int(width)))
        samples = self._samples(triangles, names, nearest, turn, mirrored, edge)
        features = self.lines[self._may_be_seen(axes, mirrored)] if len(self.lines) else self.lines
        for stroke in (Stroke(features, width=FEATURE_WIDTH), *self.strokes):
            lines = _on_screen(axes, stroke.pieces.reshape(-1, 3), scale).reshape(stroke.pieces.shape)
            lines[..., :2] = (lines[..., :2] - low) * SAMPLES
            width = stroke.width * point * SAMPLES
            draw_lines(samples, nearest, triangles, lines, width, stroke.colour, stroke.hidden)
        return low, reduce(samples, SAMPLES)

    def _samples(
        self, triangles: ScreenTriangles, names: Ints, nearest: Ints, turn: Floats, mirrored: int, line: float
    ) -> NDArray[np.float32]:
        """Return linear light and coverage of samples, (h, w, 4)."""
        size = nearest.shape
        samples, depth = np.zeros((*size, 4), np.float32), np.full(size, np.nan)
        places = np.flatnonzero(nearest >= 0)
        for start in range(0, len(places), BATCH):
            place = places[start : start + BATCH]
            row, column = np.divmod(place, size[1])
            faces = nearest.ravel()[place]
            weights = triangles.weights(faces, row, column)
            depth.ravel()[place] = (weights * picked(triangles.depth, faces)).sum(axis=1)
            shifted = partial(_shifted_weights, triangles, faces, row, column)
            side = triangles.facing[faces] * mirrored
            spots = Spots(names[faces], weights, shifted, side, turn)
            normals = unit((turn @ spots.mean(self.normals, weights).T).T)
            light = shade(normals * side[:, None], self.paint(spots))
            if line:
                light *= _edge_light(triangles.distances(faces, row, column), line)[:, None]
            for channel, shown in zip(samples.reshape(-1, 4).T, (*light.T, 1.0), strict=True):
                channel[place] = shown
        factors = hollows(mean_depth(depth, SAMPLES), max(int(HOLLOW_RADIUS * max(size) / SAMPLES), 1))
        samples[..., :3] *= factors.repeat(SAMPLES, axis=0).repeat(SAMPLES, axis=1)[..., None]
        return samples.clip(0.0, 1.0)

    def _may_be_seen(self, axes: Axes3D, mirrored: int) -> NDArray[np.bool_]:
        """Whether a surface beside a line faces the eye; where insides show, any line may be seen."""
        if not self.mesh.status.closed:
            return np.ones(len(self.lines), np.bool_)
        points = np.broadcast_to(self.lines[:, :, None], self.beside.shape).reshape(-1, 3)
        towards = mirrored * axes3d.turning(axes, points, self.beside.reshape(-1, 3))
        return np.asarray(towards.reshape(len(self.lines), -1).max(axis=1) > 0)

    def _facing_triangles(self, corners: Floats, mirrored: int) -> tuple[ScreenTriangles, Ints]:
        """Return the triangles to draw and their names in the mesh: those that face the eye if no inside can show."""
        triangles = snap(corners)
        if not self.mesh.status.closed:
            return triangles, np.arange(len(corners))
        names = np.flatnonzero(triangles.facing == mirrored)
        return triangles[names], names


def _lines(mesh: Mesh, least: float) -> tuple[Floats, Floats]:
    """Return the pieces of features of this angle at least, (n, 2, 3), and the normals at their ends, (n, 2, 2, 3)."""
    kept = visible(mesh.features, least) if least <= 180 else []
    pieces = [np.stack([one.points[:-1], one.points[1:]], axis=1) for one in kept]
    beside = [np.stack([one.normals[:-1], one.normals[1:]], axis=1) for one in kept]
    return np.concatenate([np.zeros((0, 2, 3)), *pieces]), np.concatenate([np.zeros((0, 2, 2, 3)), *beside])


def _on_screen(axes: Axes3D, points: Floats, scale: float) -> Floats:
    """Project points to pixels of an image, from the lower left corner of the axes, and depth."""
    screen = axes3d.project(axes, points)
    screen[:, :2] = (screen[:, :2] - axes.bbox.min) * scale
    return screen


def _shifted_weights(
    triangles: ScreenTriangles, faces: Ints, row: Ints, column: Ints, rows: int, columns: int
) -> Floats:
    return triangles.weights(faces, row + rows, column + columns)


def _edge_light(distances: Floats, width: float) -> Floats:
    """Darken samples nearer to an edge than half the line's width; both neighbours draw one half each."""
    ink = np.clip(width / 2 + 0.5 - distances, 0.0, min(width, 1.0))
    return 1 - (1 - EDGE_LIGHT) * ink
