"""The gallery: one body or more for each family of pieces, every one a short model file."""

from __future__ import annotations

from rsym.language.loading import load
from rsym.output.cards import plot_gallery
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.paper.models import model_path

RESOLUTION = 160
COLUMNS = 4
OURS = "ours; rsym show prints the formulas of each, rsym mesh makes a mesh of it"
# A name, the model, one of its definitions, and what the body is there to show.
BODIES = (
    ("torus", "solids", "torus_body", "a primitive"),
    ("cone", "solids", "cone_body", "a primitive: the exact distance from its mantle"),
    ("helicoid", "solids", "helicoid_body", "a sheet about a ruled surface"),
    ("coil", "solids", "coil_body", "a tube about a helix"),
    ("gear", "gear", "omega", "cyclic symmetry, the flanks exact involutes"),
    ("spring", "spring", "omega", "screw symmetry"),
    ("bracket", "bracket", "omega", "fillets"),
    ("gyroid", "gyroid", "omega", "a periodic surface"),
    ("bone", "bone", "omega", "blending on a skeleton"),
    ("vase", "vase", "omega", "a profile swept with changing letters"),
    ("snowflake", "snowflake", "omega", "six mirrors through an axis"),
    ("clip", "clip", "omega", "segments and arcs in space"),
    ("jack", "jack", "omega", "motions"),
    ("spanner", "spanner", "omega", "plane shapes, extruded"),
    ("lattice", "lattice", "omega", "a grid"),
    ("capsule", "solids", "capsule_body", "a primitive"),
)


def draw_gallery() -> Drawing:
    """All bodies under their names, and what each shows."""
    shapes = {name: load(model_path(model), shape=shape) for name, model, shape, _ in BODIES}
    figure = plot_gallery(shapes, columns=COLUMNS, resolution=RESOLUTION)
    table = Table(("body", "model file", "what it shows"), tuple((n, f"{m}.rf", shows) for n, m, _, shows in BODIES))
    return Drawing(figure, "as in the model files", triangles_in(figure), OURS, table)
