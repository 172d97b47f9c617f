"""What is proved of patches between their edges: that their formulas are analytic there, without tears and kinks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import live
from rsym.program.row import NOWHERE, SELF, SWITCH, Test
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.parameters import Interval
from rsym.surfaces.patch import Domain, Patch
from rsym.surfaces.proofs.edge_formulas import PatchFormula
from rsym.surfaces.proofs.specialised import NoProof, line_of

# Boxes along each parameter on which a formula is enclosed.
PARTS = 16
# Derivatives that a spline must have inside to have continuous curvature.
WANTED = 2


def doubt_inside(patch: Patch, formula: PatchFormula) -> str:
    """Why it is not proved that a patch is twice differentiable between its edges; empty where it is.

    A formula is analytic where each of its operations is, by enclosures on boxes; a spline is as smooth as its knots
    leave it. Where parameters stand still an analytic patch may yet have an edge: that is not looked at.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> patches = [ParametricSurface((u, v, f)) for f in (sp.sin(u * v), abs(u), abs(u - v))]
    >>> [doubt_inside(patch, PatchFormula(patch, {})) for patch in patches]
    ['', '', 'pieces of its formula meet near (u, v) = (0.03125, 0.03125)']
    """
    whole = formula.patch
    if isinstance(whole, BSplineSurface):
        return _doubt_of_knots(whole, patch.domain)
    try:
        builder, known = formula.program
    except NoProof as error:
        return error.message
    return _doubt(builder, known[0, 0], patch.domain, {name: float(value) for name, value in formula.letters.items()})


def _doubt_of_knots(surface: BSplineSurface, domain: Domain) -> str:
    for space, (low, high), name in zip(surface.spaces, domain, "uv", strict=True):
        knots, counts = np.unique(space.knots, return_counts=True)
        weak = knots[(knots > low) & (knots < high) & (space.degree - counts < WANTED)]
        if len(weak):
            return f"its pieces meet in the knot {name} = {weak[0]:.6g}"
    return ""


def _doubt(builder: Builder, outputs: Iterable[int], domain: Domain, letters: dict[str, float]) -> str:
    tests = [
        (number, [[(test, _tested(builder, number, test)) for test in clause] for clause in row.analytic or [()]])
        for number in live(builder.nodes, outputs)
        if (row := OPERATIONS[builder.nodes[number].operation]).analytic != () and row.domain != NOWHERE
    ]
    asked = {node for _, clauses in tests for clause in clauses for _, node in clause}
    if not tests:
        return ""
    program = builder.program({f"{node}": node for node in asked})
    lower, upper = _boxes(domain)
    function = IntervalFunction(program, "numpy", sharpened=tuple(number for _, number in program.outputs))
    images = function(lower, upper, letters) if asked else {}
    for number, clauses in tests:
        jumps = OPERATIONS[builder.nodes[number].operation].jumping
        for clause in clauses:
            if any(_holds(builder, test, node, images[f"{node}"], jumps) for test, node in clause):
                continue
            if not clause:
                return "its formula has an operation that is not analytic"
            low, high = images[f"{clause[0][1]}"]
            place = int(np.argmax((low <= 0) & (high >= 0)))
            middle = ", ".join(f"{(a[place] + b[place]) / 2:.6g}" for a, b in zip(lower, upper, strict=True))
            what = "pieces of its formula meet" if clause[0][0].place == SWITCH else "a root or a denominator vanishes"
            return f"{what} near (u, v) = ({middle})"
    return ""


def _tested(builder: Builder, number: int, test: Test) -> int:
    """The node that a condition is about."""
    arguments = builder.nodes[number].arguments
    if test.place == SWITCH:
        return builder.sub(arguments[0], arguments[1]) if len(arguments) > 1 else arguments[0]
    return number if test.place == SELF else arguments[test.place]


def _holds(builder: Builder, test: Test, node: int, image: tuple[Floats, Floats], jumps: bool) -> bool:
    """Whether a condition holds inside: of what is linear in the parameters zeros on the border are none inside.

    What does not jump may reach the zeros of its switch, if it does not pass them.
    """
    low, high = image
    inner = line_of(builder, node, {}) is not None and bool((low < high).all())
    above = bool((low > 0).all()) or (bool((low >= 0).all()) and inner)
    below = bool((high < 0).all()) or (bool((high <= 0).all()) and inner)
    if test.kind in {"nonzero", "apart"}:
        reaches = test.place == SWITCH and (bool((high <= 0).all()) or (not jumps and bool((low >= 0).all())))
        return above or below or reaches
    return above or (test.kind == "nonnegative" and builder.nonnegative[node])


def _boxes(domain: Sequence[Interval]) -> tuple[list[Floats], list[Floats]]:
    ends = [np.linspace(low, high, PARTS + 1) for low, high in domain]
    lower = [one.ravel() for one in np.meshgrid(*(axis[:-1] for axis in ends), indexing="ij")]
    upper = [one.ravel() for one in np.meshgrid(*(axis[1:] for axis in ends), indexing="ij")]
    return lower, upper
