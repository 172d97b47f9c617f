"""One page of HTML that opens offline and shows a shape from its equation, with a slider for each letter.

A body is drawn by casting rays at its sign form, a shape in the plane as the level lines of a field; both by programs
that the graphics processor compiles once. Beyond `MOST_OPERATIONS` the page shows a mesh.
"""

from __future__ import annotations

import base64
import io
import json
import os
import shlex
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from rsym.atomic import write_atomically
from rsym.errors import RsymWarning
from rsym.logic.leaf_names import leaf_names
from rsym.logic.separation import separated
from rsym.logic.sign_form import SignForm, shape_form
from rsym.model.requirements import file_path, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.output.design.forms import form_texts, operations_of
from rsym.output.design.letters import listed_letters
from rsym.output.design.plane import MOST_LEVELS, plane_looks, plane_texts
from rsym.output.fields import plot_field
from rsym.output.gallery import Gallery
from rsym.output.ink import INK
from rsym.output.interactive import AZIMUTH, ELEVATION, extent_on_screen, light, page_of_parts
from rsym.output.parts import PALETTE
from rsym.output.shading import linear
from rsym.output.surfaces import plot_mesh
from rsym.program.program import live
from rsym.sampling.mesh import Mesh
from rsym.sampling.meshing import mesh
from rsym.sampling.ray_steps import PAGE_CROSSING, PAGE_SHORTEST, PATIENCE
from rsym.sampling.windows import bounds_or_extent

# Of a formula that is drawn. Unions of balls of 308, 583, 862 and 1077 operations take 2.5, 7, 7 and 13 s to their
# first picture without a graphics processor, and compile in nearly all of it.
MOST_OPERATIONS = 500
CELLS = 64  # of the mesh of a still picture
STILL_SIZE = (4.0, 3.0)  # hundreds of pixels: some 5 kB
SAVING = {"stl": "for printing", "3mf": "for printing, with its unit", "glb": "for viewers"}


@dataclass(frozen=True)
class Source:
    """How the commands that a page shows name its model.

    Attributes
    ----------
    mesh, verify, lint : str
        Commands, with ``{letters}`` where those that were moved go, and ``{file}`` for the name of a file.
    python : bool
        Whether they are lines of Python.
    """

    mesh: str = 'rsym.write(rsym.mesh(shape, "auto", letters={letters}), {file})'
    verify: str = "rsym.verify_smoothness(shape, letters={letters})"
    lint: str = "rsym.lint(shape.with_letters({letters}))"
    python: bool = True


@dataclass(frozen=True)
class DesignPage:
    """A page: its HTML; in a notebook it shows itself, also after the notebook has become a page of its own.

    Examples
    --------
    >>> import rsym
    >>> page = DesignPage(page_of(rsym.disc(1)))
    >>> page._repr_html_().startswith("<iframe srcdoc="), "<script src" in page.html
    (True, False)
    """

    html: str = field(repr=False)
    height: int = 560

    def __repr__(self) -> str:
        return f"DesignPage({len(self.html) / 1000:.0f} kB)"

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 1px solid #d5d9df"
        return f'<iframe srcdoc="{escape(self.html)}" style="{style}" title="a model and its letters"></iframe>'

    def write(self, path: str | os.PathLike[str]) -> Path:
        """Write the page to a file, whole or not at all."""
        return write_atomically(file_path(path), self.html.encode())


class _Picture(NamedTuple):
    """What a page draws: its scripts, shaders by name, functions of letters in JavaScript, data, a still picture."""

    scripts: tuple[str, ...]
    shaders: Mapping[str, str]
    formulas: str
    data: Mapping[str, Any]
    still: str = ""


def page_of(
    shape: Shape,
    *,
    title: str = "",
    source: Source | None = None,
    served: bool = False,
    bounds: Any = None,
    resolution: int | Sequence[int] = 128,
) -> str:
    """The page of a shape as HTML; `served` pages ask who serves them for files and verdicts.

    The `resolution` is that of the mesh of a formula that is too long to be drawn.
    """
    require_shape(shape)
    source, title = source or Source(), title or "shape"
    box, apart = bounds_or_extent(shape, bounds), separated(shape)  # a leaf of two parts is two, each with its colour
    form = shape_form(apart)
    names = leaf_names(form, apart)
    if shape.dimension == 2:
        picture = _of_plane(shape, form, box)
    elif operations_of(form) <= MOST_OPERATIONS:
        picture = _of_space(shape, form, box)
    else:
        shown = page_of_parts(mesh(shape, resolution, bounds=box), None).decode()
        picture = _Picture(("page.js", "mesh.js"), {}, "{}", {"mesh": shown})
    data = {
        "title": title,
        "letters": listed_letters(shape.letters),
        "coordinates": [symbol.name for symbol in shape.coordinates],
        "bounds": [[float(end) for end in side] for side in box],
        "leaves": list(names),
        "parts": _parts(form, names, apart),
        "served": served,
        "python": source.python,
        "services": _services(shape, source, title),
        **picture.data,
    }
    shaders = [
        f'<script type="x-shader" id="shader-{name}">\n{text}</script>' for name, text in picture.shaders.items()
    ]
    return _filled(
        TITLE=escape(title),
        CONNECT="'self'" if served else "'none'",
        STYLE=_text("page.css"),
        STILL=picture.still,
        SHADERS="\n".join(shaders),
        DATA=json.dumps(data, separators=(",", ":")).replace("<", "\\u003c"),
        FORMULAS=picture.formulas,
        SCRIPT="\n".join(_text(name) for name in picture.scripts),
    )


def _of_plane(shape: Shape, form: SignForm, box: Bounds) -> _Picture:
    texts = plane_texts(shape, form)
    head, foot = f"{_text('head.glsl')}#define MOST {MOST_LEVELS}\n", _text("plane.glsl")
    shaders = {f"field-{k}": f"{head}{text}\n{foot}" for k, text in enumerate(texts.shaders)}
    scripts = ("page.js", "webgl.js", "plane.js")
    return _Picture(scripts, shaders, texts.script, {"fields": plane_looks(shape, box)}, _still_of_plane(shape, box))


def _of_space(shape: Shape, form: SignForm, box: Bounds) -> _Picture:
    texts = form_texts(form)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # of a mesh that is only looked at, small and for a moment
        body = mesh(shape, CELLS, bounds=box)
    head, rays = _text("head.glsl"), _text("rays.glsl")
    own = head + texts.uniforms.declaration + rays
    steps = f"const float CROSSING = {PAGE_CROSSING}, SHORTEST = {PAGE_SHORTEST}, PATIENCE = {PATIENCE};\n"
    shaders = {
        "trace": f"{own}{steps}{texts.point}\n{texts.model}\n{_text('trace.glsl')}",
        "surface": f"{own}{texts.leaf}\n{_text('surface.glsl')}",
        "curvature": f"{own}{texts.second}\n{_text('curvature.glsl')}",
        "shade": head + rays + _text("shade.glsl"),
        "show": head + _text("show.glsl"),
    }
    scripts, formulas = ("page.js", "webgl.js", "space.js"), f"{{letters: {texts.uniforms.script}}}"
    return _Picture(scripts, shaders, formulas, {"light": _light(), **_eye(body, box)}, _still_of_body(body))


def _filled(**parts: str) -> str:
    """The template with its parts, each put in once: what they say is not looked at."""
    pieces = _text("page.html").split("{{")
    result = [pieces[0]]
    for piece in pieces[1:]:
        name, _, rest = piece.partition("}}")
        result += [parts[name], rest]
    return "".join(result)


def _parts(form: SignForm, names: Sequence[str], shape: Shape) -> dict[str, Any]:
    """The parts by name: their colours, and the numbers of the letters that their leaves depend on."""
    places = {name: k for k, name in enumerate(shape.letters)}
    parts: dict[str, Any] = {}
    for name, leaf in zip(names, form.leaves, strict=True):
        colour = PALETTE[len(parts) % len(PALETTE)]
        part = parts.setdefault(name, {"colour": colour, "paint": linear(colour).round(4).tolist(), "letters": []})
        nodes = form.builder.nodes
        inputs = {str(nodes[number].data) for number in live(nodes, [leaf]) if nodes[number].operation == "input"}
        part["letters"] = sorted({*part["letters"], *(places[name] for name in inputs if name in places)})
    return parts


def _services(shape: Shape, source: Source, title: str) -> list[dict[str, str]]:
    """What Python does: files of the body, the verdict on its smoothness, the lint."""
    rows = []
    for suffix, purpose in SAVING.items() if shape.dimension == 3 else ():
        file = f"{title}.{suffix}"
        command = source.mesh.replace("{file}", repr(file) if source.python else shlex.quote(file))
        rows.append((suffix.upper(), f"body.{suffix}", f"A file {purpose}, of a mesh.", command))
    rows.append(("Verdict", "verdict", "Whether the curvature of the boundary is continuous.", source.verify))
    rows.append(("Lint", "lint", "What keeps the model from being normalised.", source.lint))
    return [dict(zip(("title", "path", "says", "command"), row, strict=True)) for row in rows]


def _light() -> dict[str, Any]:
    """The light, its numbers as short as shaders can tell them apart."""
    return {name: np.round(value, 4).tolist() for name, value in {**light(), "ink": linear(INK)}.items()}


def _eye(body: Mesh, box: Bounds) -> dict[str, Any]:
    """Where the eye looks and from how far: at the body as it is, or at its bounds where there is none."""
    corners = body.vertices if len(body.vertices) else np.array(box).T
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = low + (high - low) / 2
    radius = float(np.linalg.norm(corners - middle, axis=1).max()) or 1.0
    return {
        "middle": np.round(middle, 6).tolist(),
        "radius": round(radius, 6),
        "extent": np.round(extent_on_screen((corners - middle) / radius), 6).tolist(),
        "azimuth": round(float(AZIMUTH), 6),
        "elevation": round(float(ELEVATION), 6),
    }


def _still_of_body(body: Mesh) -> str:
    """The picture that stands until the shaders are compiled, and where they cannot be."""
    if not len(body.faces):
        return _image(Figure(STILL_SIZE, dpi=100))
    gallery = Gallery(Figure(dpi=100), 1, 1, width=STILL_SIZE[0])
    plot_mesh(body, ax=gallery.axes[0][0])
    gallery.arrange()
    return _image(gallery.figure)


def _still_of_plane(shape: Shape, box: Bounds) -> str:
    figure = Figure(STILL_SIZE, dpi=100)
    plot_field(shape, ax=figure.add_subplot(), resolution=CELLS, bounds=box)
    return _image(figure)


def _image(figure: Figure) -> str:
    data = io.BytesIO()
    figure.savefig(data, format="webp", pil_kwargs={"quality": 50})
    image = base64.b64encode(data.getvalue()).decode()
    return f'<img id="still" alt="the model as it was written" src="data:image/webp;base64,{image}">'


@lru_cache
def _text(name: str) -> str:
    """A file of this room, without indents and lines that are comments: a tenth of a page."""
    text = files("rsym.output.design").joinpath(name).read_text(encoding="utf-8")
    lines = map(str.strip, text.splitlines())
    return "".join(f"{line}\n" for line in lines if line and not line.startswith("//"))
