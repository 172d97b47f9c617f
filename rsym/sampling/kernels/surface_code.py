"""The routines of the mesher as LLVM text: what it asks of a sign form, over boxes, blocks, edges and points.

An array of points is three rows of a stated length. Every routine works on eight
lanes at a time, and no lane depends on another.
"""

from __future__ import annotations

from rsym.backends.llvm_code import VECTORS, declarations
from rsym.sampling.kernels.form_code import form, named, value
from rsym.sampling.kernels.lattice_code import boxes, crossings, signs
from rsym.sampling.kernels.leaf_code import enclose, leaf, slide
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.kernels.surface_formulas import SurfaceFormulas

# What calls nothing of each other: LLVM compiles one after the other, and between two of them whoever waits for it,
# as the import of numba does, has its turn.
MODULES = ((boxes,), (form, named, signs, crossings), (value,), (leaf, slide), (enclose,))


def surface_code(formulas: SurfaceFormulas) -> tuple[str, ...]:
    """The modules: first the constants, which run once for each choice of letters; last `enclose`."""
    nodes = [*formulas.points.program.nodes, *formulas.bounds.program.nodes]
    head = [
        *declarations(VECTORS["float64"], nodes),
        "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
        f"declare i{LANES} @llvm.cttz.i{LANES}(i{LANES}, i1)",
    ]
    constants = [formulas.points.constants_text("point_constants"), formulas.bounds.constants_text("box_constants")]
    bodies = [constants, *([routine(formulas).text for routine in module] for module in MODULES)]
    return tuple("\n".join([*head, *body]) for body in bodies)
