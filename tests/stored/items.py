"""The outputs that are stored, in groups; an item is a name and what it is made by, which gives what `record` keeps."""

import json
from functools import cache

import numpy as np
import sympy as sp

import rsym
from rsym import x, y
from rsym.logic.sign_form import shape_form, surface_form
from rsym.sampling.kernels.form_code import LeafFormulas
from rsym.sampling.kernels.mesher_code import mesher_code
from rsym.sampling.kernels.picture_code import caster_code
from rsym.sampling.kernels.ray_code import RayFormulas
from stored.models import CLOSED, FUNCTIONS, LARGE, MODELS, PLANE, THIN
from stored.record import EPS, digest, numbers

FIELDS = {"value": ("value",), "gradient": ("gradient",), "six fields": rsym.SIX}
POINTS = 61


@cache
def model(name):
    return MODELS[name]()


def points_of(shape):
    """Points in the bounds, along a line that no period of a model divides; their coordinates are rounded the same."""
    shares = np.modf(np.arange(1.0, POINTS + 1)[:, None] * np.sqrt([2.0, 3.0, 7.0])[: shape.dimension])[0]
    low, high = np.array(shape.box.ends).T
    return (low + (high - low) * shares).T


@cache
def evaluated(name, backend):
    wanted = dict.fromkeys(field for fields in FIELDS.values() for field in fields)
    return rsym.compile(model(name), tuple(wanted), backend=backend)(*points_of(model(name)))


def kernel(name, fields, backend):
    arrays = [evaluated(name, backend)[field] for field in FIELDS[fields]]
    if name not in FUNCTIONS or backend != "numpy":
        return digest(*arrays)
    # Functions of NumPy and of libm are right to 4 ulp; the formulas have some ten operations of condition about one.
    whole = np.concatenate([array.ravel() for array in arrays])
    return numbers(whole, 100 * EPS * float(np.linalg.norm(whole[np.isfinite(whole)])))


def kernels(backend, names):
    return {
        f"{name}, {fields}": lambda name=name, fields=fields: kernel(name, fields, backend)
        for name in names
        for fields in FIELDS
    }


def mesh(name, resolution, method):
    found = rsym.mesh(model(name), resolution, method=method)
    return digest(found.vertices, found.faces.astype(np.int64))


def meshes(sizes, method="sharp"):
    return {
        f"{name}, {cells} cells, {method}": lambda name=name, cells=cells: mesh(name, cells, method)
        for name, cells in sizes.items()
    }


def texts(names):
    """LLVM's text of the mesher and of the caster, without what a processor has a part in."""
    return {
        f"{name}, mesher": lambda name=name: digest(*mesher_code(LeafFormulas(surface_form(shipped(name)).capped())))
        for name in names
    } | {
        f"{name}, caster": lambda name=name: digest(caster_code(RayFormulas(shape_form(shipped(name)))))
        for name in names
    }


@cache
def shipped(name):
    return rsym.load(name)


def rule(name, cells, order):
    """Gauss's nodes are right to a few ulp; a root found on a leaf moves by the rounding of the leaf over its slope."""
    found = rsym.quadrature(model(name), cells=cells, order=order)
    arrays = [found.points, found.weights, found.boundary.points, found.boundary.weights]
    return digest(*arrays)


def rules(sizes, order=5):
    return {
        f"{name}, {cells} cells, order {order}": lambda name=name, cells=cells: rule(name, cells, order)
        for name, cells in sizes.items()
    }


def picture(name, more):
    return digest(rsym.render(model(name), size=(64, 48), **more).pixels)


def solution(name):
    """Values at the points of the rule.

    A solver by factors or steps is backward stable: the error is that of a system whose entries, sums over the points
    of a cell, are rounded. It is at most the condition of the scaled matrix times so many ulp as there are terms.
    """
    found = SOLUTIONS[name]()
    points = found.rule.points
    values = np.array(found(*points.T))
    report = found.report
    # Of systems that are not symmetric and definite none is told: a hundred times that of the Laplacian there.
    condition = report.condition or 1e5
    return numbers(values, condition * 100 * EPS * float(np.linalg.norm(values)))


def finding(report):
    """What was found, without names, bounds and words."""
    told = json.loads(report.to_json())
    kept = {
        name: told[name] for name in ("verdict", "continuity", "defects", "curvature_bound", "order") if name in told
    }
    return digest(json.dumps(kept, sort_keys=True))


@cache
def verdict(name):
    return rsym.verify_smoothness(model(name))


DISC = rsym.disc(1).named("rim")
RING = DISC - rsym.disc(sp.Rational(1, 2)).named("bore")
BALL = rsym.sphere(1).named("ball")
EXACT = sp.exp(x) * sp.cos(2 * y)


def solve(shape, text, conditions, cells=8, **more):
    return lambda: rsym.solve(shape, text, conditions, cells=cells, **more)


SOLUTIONS = {
    **{f"disc, degree {k}": solve(DISC, "-laplacian(u) = 1 + x", 0, degree=k) for k in range(1, 7)},
    "values on the rim": solve(DISC, "-laplacian(u) = exp(x)", EXACT),
    "diffusion": solve(DISC, "-div((2 + x)*grad(u)) + y^2*u = 1", y),
    "convection": solve(DISC, "-laplacian(u) + dot([3, y], grad(u)) = 1", 0),
    "anisotropy": solve(DISC, "-2*diff(u, x, x) - diff(u, y, y) + diff(u, x, y) = x", 0),
    "indefinite": solve(DISC, "-laplacian(u) - 3*u = 1", 0),
    "reaction": solve(DISC, "-laplacian(u) + u = x*y", {"rim": rsym.neumann(1)}),
    "robin": solve(DISC, "-laplacian(u) = 1", {"rim": rsym.robin(2, x)}),
    "ring": solve(RING, "-laplacian(u) = 0", {"rim": 0, "bore": 1}, 12),
    "ring, flux": solve(RING, "-laplacian(u) = 1", {"rim": 0, "bore": rsym.neumann(x)}, 12),
    "ring, level": solve(RING, "-laplacian(u) = 4", {"rim": 0, "bore": rsym.constant()}, 12),
    "about an axis": solve(DISC & rsym.half_plane((1, 0), 0), "-laplacian(u) = 1", {"rim": 0}, axis=y),
    "plate": solve(DISC, "bilaplacian(u) = 1 + x", rsym.clamped()),
    "square": solve(rsym.rectangle(2, 1), "-laplacian(u) = 1", 0),
    "ellipse": solve(rsym.ellipse(2, 1), "-laplacian(u) = x", y),
    "ball": solve(BALL, "-laplacian(u) = 6 + x", 0, 4, degree=2),
    "elastic disc": lambda: rsym.elasticity(
        DISC, {"rim": rsym.fixed()}, young=1, poisson=sp.Rational(3, 10), loads=(1, y), cells=6
    ),
}


def reports(proved, names):
    """What of a verdict does not depend on names and bounds, and all of it; of the rest all there is."""
    return {
        "verdicts": {name: lambda name=name: finding(verdict(name)) for name in proved},
        "words of verdicts": {name: lambda name=name: digest(verdict(name).to_json()) for name in proved},
        "lint": {name: lambda name=name: digest(rsym.lint(model(name)).to_json()) for name in names},
        "contracts": {name: lambda name=name: digest(model(name).contract().to_json()) for name in names},
    }


BACKENDS = ("numpy", "llvm", "tape")
SMALL = [name for name in MODELS if name not in LARGE]
FLAT = [name for name in SMALL if model(name).dimension == 2]
BODIES = [name for name in SMALL if name not in FLAT]
SHIPPED = [name for name in rsym.paper.models.MODELS if name not in ("skeleton", "plate", "shaft")]  # those in space
SLOWLY = ("cyclic", "joining", "equivalence", "plane tree of Rho", "skeleton body", "kaleidoscope")  # to be proved
PROVED = [name for name in PLANE if name not in SLOWLY]
QUICK = {
    **{f"kernels by {backend}": kernels(backend, SMALL) for backend in BACKENDS},
    "meshes": meshes(dict.fromkeys([name for name in BODIES if name not in THIN], 16)),
    "smooth meshes": meshes(dict.fromkeys(CLOSED, 20), "smooth"),
    "texts": texts(("jack", "vase", "lattice", "car")),
    "rules in the plane": rules(dict.fromkeys([name for name in FLAT if name not in SLOWLY], 6)),
    "rules in space": rules(dict.fromkeys(CLOSED[:5], 3), 3),
    "pictures": {name: lambda name=name: picture(name, {}) for name in CLOSED},
    "solutions": {name: lambda name=name: solution(name) for name in SOLUTIONS},
    **reports(PROVED, PROVED),
}
SLOW = {
    **{f"kernels by {backend}, large models": kernels(backend, LARGE) for backend in BACKENDS},
    "meshes of large models": meshes({"bone": 64, "valve": 96, "bracket": 80, "spanner": 128, "jack": 80}),
    "texts of other models": texts([name for name in SHIPPED if name not in ("jack", "vase", "lattice", "car")]),
    "other rules": rules({**dict.fromkeys(FLAT, 9), **dict.fromkeys(CLOSED, 5)}, 7),
    **{f"{kind}, others": items for kind, items in reports((*SLOWLY, "ball", "torus"), [*SLOWLY, *BODIES]).items()},
}
GROUPS = QUICK | SLOW
