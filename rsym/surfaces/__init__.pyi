from . import projections
from .blends.blending import HermiteBlend
from .blends.blending_checks import Answer
from .bsplines.parameter_correction import Plane
from .bsplines.spline_surfaces import BSplineSurface
from .coons.bicubic import BicubicCoons
from .coons.coons_patches import CoonsPatch
from .coons.energies import energy
from .coons.exact import (
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
from .coons.optimal import Optimum, optimal_parameters
from .coons.revolution import Arc, Revolution, Segment
from .coons.twists import estimate_twists, with_twists
from .corrections import Correction
from .functions.curves import Called
from .functions.nurbs import Nurbs
from .functions.univariate import Formula
from .joints.continuity import continuity_report
from .joints.edge_report import EdgeReport
from .joints.joining import join
from .meshes import mesh_patches
from .networks.composite import CompositeCoons
from .networks.gordon import GordonSurface, HermiteSurface, LagrangeSurface, SplineLoft, TensorProductSurface
from .networks.transition import TransitionSurface
from .parametric import ParametricSurface
from .patch import Patch
from .proofs.edge_proof import EdgeProof
from .splitting import PatchPiece, split_patch

__all__ = [
    "Answer",
    "Arc",
    "BSplineSurface",
    "BicubicCoons",
    "Called",
    "CompositeCoons",
    "CoonsPatch",
    "Correction",
    "EdgeProof",
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
    "PatchPiece",
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
    "split_patch",
    "torus",
    "torus_quarter",
    "with_twists",
]
