"""A mesh as the bytes of a file: one function and one row of `FORMATS` for each format.

The same mesh gives the same bytes. Text, PLY and 3MF keep every digit of float64; STL and GLB hold float32 by
definition. Whatever lists formats, `write`, its docstring, the command line, reads the rows.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.visual.material import PBRMaterial

from rsym.errors import RsymError
from rsym.output.exchange import msh, vtu
from rsym.output.interactive import page, page_of_parts
from rsym.output.parts import part_colours
from rsym.output.shading import BODY, linear, split_sharp
from rsym.output.units import UNITS
from rsym.sampling.encoding import ply_faces, ply_header, ply_vertices, stl_faces, stl_header
from rsym.sampling.mesh import Mesh

# float32 keeps 7 digits: below this ratio of size to distance from the origin fewer than 3 of them describe the body.
SMALLEST_RATIO = 1e-4
# The first moment a zip file can name: with the true time no two files would be equal.
ZIP_EPOCH = (1980, 1, 1, 0, 0, 0)


def stl(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as binary STL: 80 empty bytes and the triangles in float32."""
    require_float32(mesh, "STL")
    return stl_header(len(mesh.faces)) + stl_faces(mesh.vertices[mesh.faces])


def ply(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as binary PLY: float64 vertices, int32 faces, little-endian."""
    return ply_header(len(mesh.vertices), len(mesh.faces)) + ply_vertices(mesh.vertices) + ply_faces(mesh.faces)


def obj(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as OBJ: shared vertices in full, and beside them a normal for each corner of each face."""
    shaded = split_sharp(mesh)
    pairs = np.stack([mesh.faces, shaded.faces], axis=2).reshape(-1, 6) + 1
    return _text(
        _lines("v {!r} {!r} {!r}", mesh.vertices),
        _lines("vn {:.6f} {:.6f} {:.6f}", shaded.normals),
        _lines("f {}//{} {}//{} {}//{}", pairs),
    )


def off(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as OFF text."""
    return _text(
        ["OFF", f"{len(mesh.vertices)} {len(mesh.faces)} 0"],
        _lines("{!r} {!r} {!r}", mesh.vertices),
        _lines("3 {} {} {}", mesh.faces),
    )


def glb(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as binary glTF 2.0: float32, turned to its y-up, with normals, vertices copied along sharp edges."""
    mesh = _in_metres(mesh, unit)
    require_float32(mesh, "GLB")
    return _glb({"body": _body(mesh, "body", BODY)})


def glb_of_parts(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as binary glTF 2.0 with an object for each part, its name and colour."""
    mesh = _in_metres(mesh, unit)
    require_float32(mesh, "GLB")
    colours = part_colours(mesh)
    assert mesh.leaf is not None
    name_of = mesh.labels.each
    bodies = {}
    for name, colour in colours.items():
        faces = name_of == name
        part = Mesh(mesh.vertices, mesh.faces[faces], mesh.normals[faces], leaf=mesh.leaf[faces], leaves=mesh.leaves)
        bodies[name] = _body(part, name, colour)
    return _glb(bodies)


def _body(mesh: Mesh, name: str, colour: str) -> trimesh.Trimesh:
    shaded = split_sharp(mesh)
    body = trimesh.Trimesh(_y_up(shaded.vertices), shaded.faces, vertex_normals=_y_up(shaded.normals), process=False)
    factor = (255 * np.append(linear(colour), 1.0)).round().astype(np.uint8)
    material = PBRMaterial(name=name, baseColorFactor=factor, metallicFactor=0.0, roughnessFactor=0.6)
    body.visual = trimesh.visual.TextureVisuals(material=material)
    return body


def _in_metres(mesh: Mesh, unit: str | None) -> Mesh:
    """The numbers of a mesh without a unit are taken for metres, which they are in glTF."""
    return mesh if unit is None else mesh.scale(UNITS[unit].metres)


def _glb(bodies: Mapping[str, trimesh.Trimesh]) -> bytes:
    data: bytes = trimesh.Scene(bodies).export(file_type="glb", include_normals=True)
    return data


def three_mf(mesh: Mesh, unit: str | None) -> bytes:
    """Encode as 3MF, which states its unit; the format is for bodies, so the mesh must be closed and not empty."""
    if not mesh.status.closed or mesh.status.volume <= 0:
        state = "an open surface" if not mesh.status.closed else f"a volume of {mesh.status.volume:.3g}"
        raise RsymError(
            f"3MF holds closed bodies with the inside inside, got {state}",
            code="format-body",
            remedy="widen the bounds until the body is whole, or write .ply",
        )
    parts = (
        ("[Content_Types].xml", _CONTENT_TYPES.encode()),
        ("_rels/.rels", _RELATIONS.encode()),
        ("3D/3dmodel.model", _model(mesh, UNITS[unit or "mm"].three_mf)),
    )
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, data in parts:
            entry = zipfile.ZipInfo(name, ZIP_EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return buffer.getvalue()


def _model(mesh: Mesh, unit: str) -> bytes:
    return _text(
        [
            _XML,
            f'<model unit="{unit}" xml:lang="en" xmlns="{_CORE}">',
            "<resources>",
            '<object id="1" type="model">',
        ],
        ["<mesh>", "<vertices>"],
        _lines('<vertex x="{!r}" y="{!r}" z="{!r}"/>', mesh.vertices),
        ["</vertices>", "<triangles>"],
        _lines('<triangle v1="{}" v2="{}" v3="{}"/>', mesh.faces),
        ["</triangles>", "</mesh>", "</object>", "</resources>", '<build><item objectid="1"/></build>', "</model>"],
    )


def require_float32(mesh: Mesh, name: str) -> None:
    """Refuse coordinates that float32, and so the format of this name, cannot tell apart, axis by axis."""
    corners = mesh.vertices[np.unique(mesh.faces)]
    extent, offset = np.ptp(corners, axis=0), np.abs(corners).max(axis=0)
    limits = np.finfo(np.float32)
    far = (extent > 0) & (extent < SMALLEST_RATIO * offset)
    if far.any():
        axis = int(np.argmax(far))
        raise RsymError(
            f"{name} keeps 7 digits, too few for a body {extent[axis]:.3g} wide at {'xyz'[axis]} = {offset[axis]:.6g}",
            code="float32-precision",
            remedy="move the body to the origin, or write .ply",
        )
    if offset.max() > limits.max or extent.max() < limits.tiny / SMALLEST_RATIO:
        raise RsymError(
            f"{name} holds numbers from {limits.tiny:.1g} to {limits.max:.1g}, the body is {extent.max():.3g} wide",
            code="float32-range",
            remedy="scale the body, or write .ply",
        )


def _y_up(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn z-up to y-up by a quarter turn about x, which programs with z up undo when they read."""
    return np.stack([vectors[:, 0], vectors[:, 2], -vectors[:, 1]], axis=1)


def _lines(pattern: str, rows: NDArray[Any]) -> Iterable[str]:
    """Write each row by the pattern; `repr` of a float64 gives back the same float64."""
    return (pattern.format(*row) for row in rows.tolist())


def _text(*parts: Iterable[str]) -> bytes:
    return "".join(f"{line}\n" for part in parts for line in part).encode()


_XML = '<?xml version="1.0" encoding="UTF-8"?>'
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_CONTENT_TYPES = f"""{_XML}
<Types xmlns="{_PACKAGE}/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""
_RELATIONS = f"""{_XML}
<Relationships xmlns="{_PACKAGE}/relationships">
<Relationship Id="model" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""


class Format(NamedTuple):
    """What rsym knows of a format: its suffix, what `write` says of it, and how a mesh in a unit is encoded.

    coloured: the same with a colour for each part, if it holds colours. package: which must be installed to write it.
    """

    suffix: str
    says: str
    encode: Callable[[Mesh, str | None], bytes]
    coloured: Callable[[Mesh, str | None], bytes] | None = None
    package: str = ""


_ROWS = (
    Format(".stl", "binary, float32, triangles without shared vertices", stl),
    Format(".ply", "binary, float64", ply),
    Format(".obj", "text, float64 in full, a normal for each corner of each face", obj),
    Format(".off", "text, float64 in full", off),
    Format(
        ".glb",
        "binary glTF 2.0, float32, y up (so x, z, -y), normals, copies along sharp edges",
        glb,
        coloured=glb_of_parts,
    ),
    Format(".3mf", "float64 in full, for printing: states its unit, closed bodies alone", three_mf),
    Format(".html", "a page that opens offline, turns with the mouse and zooms", page, coloured=page_of_parts),
    Format(".vtu", "of ParaView, float64, parts as numbers", vtu, package="meshio"),
    Format(".msh", "of Gmsh, text of version 2.2, float64 in full, parts as physical surfaces", msh, package="meshio"),
)
FORMATS: Mapping[str, Format] = MappingProxyType({row.suffix: row for row in _ROWS})


def coloured_formats() -> str:
    """The suffixes of the formats that hold colours, for a sentence."""
    return " or ".join(row.suffix for row in FORMATS.values() if row.coloured)


def listed_formats() -> str:
    """The suffixes of all formats, for a line of help: those that need a package last."""
    own = " ".join(row.suffix for row in FORMATS.values() if not row.package)
    others = {row.package: [one.suffix for one in FORMATS.values() if one.package == row.package] for row in _ROWS}
    return "; ".join([own, *(f"{' and '.join(those)} by {package}" for package, those in others.items() if package)])


def table_of_formats() -> str:
    """The rows as a table of a docstring."""
    rows = [
        (f"``{row.suffix}``", row.says + (f"; by the package {row.package}" if row.package else "")) for row in _ROWS
    ]
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    rule = " ".join("=" * width for width in wide)
    return "\n    ".join([rule, *(f"{name:<{wide[0]}} {says}" for name, says in rows), rule])
