from . import projections
from .blending import HermiteBlend
from .blending_checks import Answer
from .bspline_loci import Plane
from .bsplines import BSplineSurface
from .callables import Called
from .composite import CompositeCoons
from .continuity import continuity_report
from .coons import BicubicCoons, CoonsPatch
from .edge_report import EdgeReport
from .energies import energy
from .exact import (
    cone,
    cone_quarter,
    cylinder,
    cylinder_quarter,
    ellipsoid,
    ellipsoid_octant,
    sphere,
    sphere_octant,
    torus,
    torus_quarter,
)
from .ferguson import with_twists
from .gordon import GordonSurface
from .joining import join
from .lofts import HermiteSurface, LagrangeSurface, SplineLoft
from .meridians import Arc, Segment
from .meshes import mesh_patches
from .nurbs import Nurbs
from .optimal import Optimum, optimal_parameters
from .parametric import ParametricSurface
from .patch import Patch
from .revolution import Revolution
from .tensor import TensorProductSurface
from .transition import TransitionSurface
from .twists import estimate_twists
from .univariate import Formula

__all__ = [
    "Answer",
    "Arc",
    "BSplineSurface",
    "BicubicCoons",
    "Called",
    "CompositeCoons",
    "CoonsPatch",
    "EdgeReport",
    "Formula",
    "GordonSurface",
    "HermiteBlend",
    "HermiteSurface",
    "LagrangeSurface",
    "Nurbs",
    "Optimum",
    "ParametricSurface",
    "Patch",
    "Plane",
    "Revolution",
    "Segment",
    "SplineLoft",
    "TensorProductSurface",
    "TransitionSurface",
    "cone",
    "cone_quarter",
    "continuity_report",
    "cylinder",
    "cylinder_quarter",
    "ellipsoid",
    "ellipsoid_octant",
    "energy",
    "estimate_twists",
    "join",
    "mesh_patches",
    "optimal_parameters",
    "projections",
    "sphere",
    "sphere_octant",
    "torus",
    "torus_quarter",
    "with_twists",
]
