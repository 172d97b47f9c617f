from . import paper, primitives, surfaces
from .analysis.conditions import clamped, constant, dirichlet, neumann, robin, supported, switched
from .analysis.differential import (
    curvature,
    gaussian_curvature,
    gradient,
    hessian,
    laplacian,
    mean_curvature,
    principal_curvatures,
)
from .analysis.latex import latex
from .analysis.normalisation import implicit, normalise
from .analysis.structures import SolutionStructure
from .analysis.transformations import transform
from .backends.jax_functions import to_jax
from .backends.kernel import Kernel, compile
from .backends.plain import lambdify
from .backends.source import source
from .backends.torch_functions import to_torch
from .bounds.enclosures import enclose
from .errors import RsymError, RsymWarning
from .language.loading import load, loads
from .language.writing import dumps
from .model.blends.displacement import bounded_blend, displacement_blend
from .model.blends.fillets import fillet
from .model.blends.rho import Rho
from .model.blends.sardf import Sardf
from .model.constructions import extrude, offset, product, revolve, section, shell, sweep
from .model.letters import Letter
from .model.operations import (
    conjunction,
    difference,
    disjunction,
    equivalence,
    exclusive_or,
    implication,
    joining,
    negation,
    rfAND,
    rfNOT,
    rfOR,
    trimming,
)
from .model.primitives.curves import arc, circle, graph, helix, polyline, segment, space_curve
from .model.primitives.helical import helicoid, helix_tube
from .model.primitives.periodic import gyroid, lidinoid, neovius, schwarz_d, schwarz_p
from .model.primitives.plane import disc, ellipse, half_plane, line, rectangle, strip, superellipse
from .model.primitives.polygons import polygon, regular_polygon
from .model.primitives.quadrics import ellipsoid, quadric, torus
from .model.primitives.space import box, capsule, cone, cylinder, double_cone, frustum, half_space, nappe, slab, sphere
from .model.shape import Shape
from .model.skeletons import analytic_condition, blend_on_skeleton
from .model.symbols import x, y, z
from .model.symmetry.cyclic import cyclic
from .model.symmetry.mirrors import kaleidoscope, mirror_group, mirrored
from .model.symmetry.rows import grid, row
from .model.symmetry.screws import coil, screw, wound
from .model.symmetry.waves import triangle_wave
from .model.systems import R0, R1, R0m, RAlpha, Rp
from .output.atlas import plot_atlas
from .output.cameras import Camera
from .output.cards import cards, plot_gallery
from .output.combs import plot_curvature_comb
from .output.deformations import plot_deformation
from .output.designs import plot_designs
from .output.exchange import to_meshio, to_pyvista, to_trimesh
from .output.explore import explore, explore_patches
from .output.fairness import plot_fairness
from .output.fields import plot_field, plot_fields
from .output.files import write, write_features
from .output.fits import plot_fit, plot_sensitivity
from .output.image_axes import plot_image
from .output.images import Image
from .output.joins import plot_continuity
from .output.models import load_letters, save, save_letters
from .output.modes import plot_modes
from .output.patches import compare_patches, plot_patches
from .output.rendering import render
from .output.repairs import plot_repair
from .output.sections import plot_sections, write_sections
from .output.surfaces import plot_mesh
from .output.sweep import plot_sweep
from .output.systems import SystemRow, SystemTable, compare_systems
from .output.torsion import plot_torsion
from .output.verdicts import plot_verdict
from .output.viewing import view
from .problems.elastic.equilibrium import Forces
from .problems.elastic.result import ElasticSolution, PlaneTensor
from .problems.elastic.solving import elasticity
from .problems.elastic.supports import displacement, fixed, pressure, roller, traction
from .problems.extremes import Attained
from .problems.interpolation import interpolate
from .problems.solution import Solution
from .problems.solution_report import SolutionReport
from .problems.solution_structures import solution_structure
from .problems.solving import solve
from .problems.spectra import Spectrum, modes
from .problems.stated import StatedProblem, load_problem
from .problems.torsion import Torsion, torsion
from .problems.weak_solving import solve_form
from .program.fields import SIX
from .sampling.contours import LevelLines
from .sampling.curvatures import corner_curvatures, vertex_curvatures
from .sampling.extent import extent
from .sampling.fit_report import Fit
from .sampling.fitting import fit
from .sampling.level_lines import level_lines
from .sampling.mesh import Mesh
from .sampling.mesh_file import MeshFile
from .sampling.meshing import Mesher, mesh
from .sampling.rules.integrals import integrate
from .sampling.rules.measures import MeasureReport, measure
from .sampling.rules.quadrature import BoundaryQuadrature, Quadrature, quadrature
from .sampling.samples import Samples, sample
from .sampling.sections import Section, sections
from .sampling.sensitivity import Sensitivity, sensitivity
from .sampling.sharp.features import Feature
from .verify.answers.body_report import BodyCover, BodyReport
from .verify.answers.report import Joint, SmoothnessReport
from .verify.answers.singular import SingularCurve, SingularPoint
from .verify.atlas.atlas import smoothness_atlas
from .verify.atlas.report import SmoothnessAtlas, ThresholdCurve
from .verify.continuity.continuity import ContinuityReport, continuity
from .verify.continuity.curves import Curve
from .verify.fairness.designs import DesignTable, compare_designs
from .verify.fairness.fairness import fairness
from .verify.fairness.report import FairnessReport
from .verify.lint.linting import lint
from .verify.lint.report import Finding, LintReport
from .verify.normalisation.normalisation import verify_normalisation
from .verify.normalisation.report import NormalisationReport
from .verify.repair.prices import Price
from .verify.repair.repairing import repair
from .verify.repair.report import RepairReport
from .verify.smoothness import verify_smoothness
from .verify.threshold import Threshold, smoothness_threshold
from .version import __version__

__all__ = [
    "R0",
    "R1",
    "SIX",
    "Attained",
    "BodyCover",
    "BodyReport",
    "BoundaryQuadrature",
    "Camera",
    "ContinuityReport",
    "Curve",
    "DesignTable",
    "ElasticSolution",
    "FairnessReport",
    "Feature",
    "Finding",
    "Fit",
    "Forces",
    "Image",
    "Joint",
    "Kernel",
    "Letter",
    "LevelLines",
    "LintReport",
    "MeasureReport",
    "Mesh",
    "MeshFile",
    "Mesher",
    "NormalisationReport",
    "PlaneTensor",
    "Price",
    "Quadrature",
    "R0m",
    "RAlpha",
    "RepairReport",
    "Rho",
    "Rp",
    "RsymError",
    "RsymWarning",
    "Samples",
    "Sardf",
    "Section",
    "Sensitivity",
    "Shape",
    "SingularCurve",
    "SingularPoint",
    "SmoothnessAtlas",
    "SmoothnessReport",
    "Solution",
    "SolutionReport",
    "SolutionStructure",
    "Spectrum",
    "StatedProblem",
    "SystemRow",
    "SystemTable",
    "Threshold",
    "ThresholdCurve",
    "Torsion",
    "__version__",
    "analytic_condition",
    "arc",
    "blend_on_skeleton",
    "bounded_blend",
    "box",
    "capsule",
    "cards",
    "circle",
    "clamped",
    "coil",
    "compare_designs",
    "compare_patches",
    "compare_systems",
    "compile",
    "cone",
    "conjunction",
    "constant",
    "continuity",
    "corner_curvatures",
    "curvature",
    "cyclic",
    "cylinder",
    "difference",
    "dirichlet",
    "disc",
    "disjunction",
    "displacement",
    "displacement_blend",
    "double_cone",
    "dumps",
    "elasticity",
    "ellipse",
    "ellipsoid",
    "enclose",
    "equivalence",
    "exclusive_or",
    "explore",
    "explore_patches",
    "extent",
    "extrude",
    "fairness",
    "fillet",
    "fit",
    "fixed",
    "frustum",
    "gaussian_curvature",
    "gradient",
    "graph",
    "grid",
    "gyroid",
    "half_plane",
    "half_space",
    "helicoid",
    "helix",
    "helix_tube",
    "hessian",
    "implication",
    "implicit",
    "integrate",
    "interpolate",
    "joining",
    "kaleidoscope",
    "lambdify",
    "laplacian",
    "latex",
    "level_lines",
    "lidinoid",
    "line",
    "lint",
    "load",
    "load_letters",
    "load_problem",
    "loads",
    "mean_curvature",
    "measure",
    "mesh",
    "mirror_group",
    "mirrored",
    "modes",
    "nappe",
    "negation",
    "neovius",
    "neumann",
    "normalise",
    "offset",
    "paper",
    "plot_atlas",
    "plot_continuity",
    "plot_curvature_comb",
    "plot_deformation",
    "plot_designs",
    "plot_fairness",
    "plot_field",
    "plot_fields",
    "plot_fit",
    "plot_gallery",
    "plot_image",
    "plot_mesh",
    "plot_modes",
    "plot_patches",
    "plot_repair",
    "plot_sections",
    "plot_sensitivity",
    "plot_sweep",
    "plot_torsion",
    "plot_verdict",
    "polygon",
    "polyline",
    "pressure",
    "primitives",
    "principal_curvatures",
    "product",
    "quadrature",
    "quadric",
    "rectangle",
    "regular_polygon",
    "render",
    "repair",
    "revolve",
    "rfAND",
    "rfNOT",
    "rfOR",
    "robin",
    "roller",
    "row",
    "sample",
    "save",
    "save_letters",
    "schwarz_d",
    "schwarz_p",
    "screw",
    "section",
    "sections",
    "segment",
    "sensitivity",
    "shell",
    "slab",
    "smoothness_atlas",
    "smoothness_threshold",
    "solution_structure",
    "solve",
    "solve_form",
    "source",
    "space_curve",
    "sphere",
    "strip",
    "superellipse",
    "supported",
    "surfaces",
    "sweep",
    "switched",
    "to_jax",
    "to_meshio",
    "to_pyvista",
    "to_torch",
    "to_trimesh",
    "torsion",
    "torus",
    "traction",
    "transform",
    "triangle_wave",
    "trimming",
    "verify_normalisation",
    "verify_smoothness",
    "vertex_curvatures",
    "view",
    "wound",
    "write",
    "write_features",
    "write_sections",
    "x",
    "y",
    "z",
]
