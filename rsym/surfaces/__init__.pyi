from .blending import HermiteBlend
from .callables import Called
from .coons import BicubicCoons, CoonsPatch
from .ferguson import with_twists
from .meshes import mesh_patches
from .parametric import ParametricSurface
from .patch import Patch
from .twists import estimate_twists
from .univariate import Formula

__all__ = [
    "BicubicCoons",
    "Called",
    "CoonsPatch",
    "Formula",
    "HermiteBlend",
    "ParametricSurface",
    "Patch",
    "estimate_twists",
    "mesh_patches",
    "with_twists",
]
