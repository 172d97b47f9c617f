"""A mesh as one page of HTML that opens offline, turns with the mouse and zooms.

The page carries some 150 lines of WebGL and the light of printed pictures, so
it needs no package; its exact normals are why no plotting library draws it:
those take normals from the triangles.
"""

from __future__ import annotations

import base64
import json
from functools import lru_cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.output import shading
from rsym.output.ink import INK, SMOOTH, visible
from rsym.output.parts import face_colours
from rsym.output.shading import linear, split_sharp
from rsym.sampling.mesh import Mesh

# The eye of `plot_mesh`, and how far it stands from the unit ball round the body.
ELEVATION, AZIMUTH = np.radians(shading.ELEVATION), np.radians(shading.AZIMUTH)
DISTANCE = 5.0
# The share of the window that the body fills; turned about its upright axis it stays inside.
FILLED = 0.94
# Beyond this the data nears the longest text that browsers hold, half a billion characters.
MOST_TRIANGLES = 10_000_000


def page(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as HTML: positions float32 about the middle, normals int16, faces uint32, nothing that is fetched."""
    return _page(mesh, None)


def page_of_parts(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as HTML with a colour for each part."""
    return _page(mesh, face_colours(mesh))


def _page(mesh: Mesh, colours: NDArray[np.float64] | None) -> bytes:
    if len(mesh.faces) > MOST_TRIANGLES:
        raise RsymError(
            f"a page shows at most {MOST_TRIANGLES:,} triangles, the mesh has {len(mesh.faces):,}",
            code="format-size",
            remedy="mesh at a lower resolution, or write .glb",
        )
    shaded = split_sharp(mesh)
    low, high = shaded.vertices.min(axis=0), shaded.vertices.max(axis=0)
    middle = low + (high - low) / 2
    radius = float(np.linalg.norm(shaded.vertices - middle, axis=1).max())
    places = (shaded.vertices - middle) / (radius or 1.0)
    width, height = extent_on_screen(places)
    body = {
        "closed": mesh.status.closed,
        "eye": DISTANCE,
        "elevation": round(float(ELEVATION), 6),
        "azimuth": round(float(AZIMUTH), 6),
        "width": round(width, 6),
        "height": round(height, 6),
        "light": light(),
        "count": shaded.faces.size,
        "places": _packed(places, "<f4"),
        "normals": _packed(np.rint(shaded.normals * 32767), "<i2"),
        "faces": _packed(shaded.faces, "<u4"),
        "lines": _packed((_lines(mesh) - middle) / (radius or 1.0), "<f4"),
        "ink": linear(INK).tolist(),
    }
    if colours is not None:
        paints = np.zeros((len(shaded.vertices), 4))  # WebGL wants each vertex at a multiple of four bytes
        paints[shaded.faces, :3] = colours[:, None]
        body["paints"] = _packed(np.rint(paints * 65535), "<u2")
    return _template().replace("{{BODY}}", json.dumps(body)).encode()


def _lines(mesh: Mesh) -> NDArray[np.float64]:
    """The ends of the pieces of features that one sees as edges, (n, 2, 3)."""
    kept = [one.points for one in visible(mesh.features, SMOOTH)]
    return np.concatenate([np.zeros((0, 2, 3)), *(np.stack([line[:-1], line[1:]], axis=1) for line in kept)])


def extent_on_screen(places: NDArray[np.float64]) -> tuple[float, float]:
    """The width and height, on the screen at distance 1, that hold the body at every azimuth."""
    across, up = np.hypot(places[:, 0], places[:, 1]), np.abs(places[:, 2])
    sine, cosine = np.sin(ELEVATION), np.cos(ELEVATION)
    width = across / (DISTANCE - np.sqrt(across**2 + up**2))
    height = (up * cosine + across * sine) / (DISTANCE - up * sine - across * cosine)
    return float(width.max()) / FILLED, float(height.max()) / FILLED


def light() -> dict[str, Any]:
    """The light of printed pictures, as shaders take it."""
    return {
        "key": shading.unit(shading.KEY).tolist(),
        "fill": shading.unit(shading.FILL).tolist(),
        "outside": shading.linear(shading.BODY).tolist(),
        "inside": shading.linear(shading.INSIDE).tolist(),
        "keyStrength": shading.KEY_STRENGTH,
        "fillStrength": shading.FILL_STRENGTH,
        "ambient": shading.AMBIENT,
        "sky": shading.SKY,
        "rim": shading.RIM,
        "shine": shading.SHINE,
        "shineExponent": shading.SHINE_EXPONENT,
    }


def _packed(values: NDArray[Any], kind: str) -> str:
    return base64.b64encode(values.astype(kind).tobytes()).decode()


@lru_cache(maxsize=1)
def _template() -> str:
    return files("rsym.output").joinpath("interactive.html").read_text(encoding="utf-8")
