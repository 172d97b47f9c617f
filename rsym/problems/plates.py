"""Plates: what the equation of bending needs beside that of diffusion.

The work of Kirchhoff's plate is D times the integral of

    nu*lap u*lap v + (1 - nu)*(u_xx v_xx + 2 u_xy v_xy + u_yy v_yy);

nu, Poisson's ratio, does not matter inside, nor on edges that are clamped, nor on straight ones that are supported.
"""

from __future__ import annotations

import numpy as np

from rsym.analysis.conditions import Clamped, Robin, Supported
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.arguments import number
from rsym.problems.problem import Problem
from rsym.problems.splines.cardinals import derivatives
from rsym.problems.weak.weak_form import WeakForm
from rsym.program.differentiation import derivative

EDGES = "of plates edges are rsym.clamped(), rsym.supported(), or free where nothing is said"


def bending(dimension: int, poisson: float | None) -> Floats:
    """The form on second derivatives, in the order of `derivatives`: without a ratio that of Laplacians.

    Examples
    --------
    >>> bending(2, 0.25).tolist()
    [[1.0, 0.0, 0.25], [0.0, 1.5, 0.0], [0.25, 0.0, 1.0]]
    """
    seconds = derivatives(dimension, 2)[1 + dimension :]
    pure = np.array([2.0 in index for index in seconds], float)
    nu = 1.0 if poisson is None else poisson
    return nu * np.outer(pure, pure) + (1 - nu) * np.diag(2 - pure)


def checked_ratio(poisson: object) -> float | None:
    """Poisson's ratio, if there is one."""
    if poisson is None:
        return None
    value = number(poisson, "Poisson's ratio")
    if not value.is_number or not -1 < value < 1:
        raise RsymError(f"Poisson's ratio is from -1 to 1, got {poisson}", code="material", remedy="poisson=0.3")
    return float(value)


def require_edges(problem: Problem, *, single: bool) -> None:
    """Refuse conditions that are not those of the equation, and a plate that may move as a whole if `single`."""
    if problem.equation.order == 2:
        if problem.leaves(Clamped, Supported):
            raise RsymError(
                "clamped and supported edges are those of plates, the equation is of the order 2",
                code="condition",
                remedy='"bilaplacian(u) = f", or a value, rsym.robin and the like',
            )
        return
    if isinstance(problem.equation, WeakForm):
        return  # what is natural on an edge is for the form to say
    if problem.axis >= 0 or (problem.dimension != 2 and problem.poisson is not None):
        raise RsymError("plates are in the plane", code="equation", remedy="leave axis= out, in space poisson= too")
    supported = problem.leaves(Supported)
    free = tuple(leaf for leaf, one in enumerate(problem.conditions) if one is None)
    if len(supported) + len(free) + len(problem.leaves(Clamped)) < len(problem.conditions):
        given = "a flux" if problem.leaves(Robin) else "a value"
        raise RsymError(f"{given} alone is given on an edge of a plate", code="condition", remedy=EDGES)
    matters = [leaf for leaf in supported if not _straight(problem, leaf)] or free
    if matters and problem.poisson is None and problem.dimension == 2:
        raise RsymError(
            "on edges that are free, or supported and curved, Poisson's ratio matters",
            code="material",
            remedy="poisson=0.3",
        )
    turns = len(supported) < 2 and all(_linear(problem, leaf) for leaf in supported)
    if single and turns and not problem.leaves(Clamped) and problem.equation.reaction == 0:
        raise RsymError("nothing hinders the plate from moving as a whole", code="singular", remedy=EDGES)


def _straight(problem: Problem, leaf: int) -> bool:
    """Whether a leaf is a straight line, or several that are parallel to an axis."""
    b = problem.form.builder
    slopes = [derivative(b, problem.form.leaves[leaf], name) for name in b.coordinates]
    return sum(slope != b.const(0) for slope in slopes) == 1 or _linear(problem, leaf)


def _linear(problem: Problem, leaf: int) -> bool:
    b = problem.form.builder
    slopes = [derivative(b, problem.form.leaves[leaf], name) for name in b.coordinates]
    return all(derivative(b, slope, name) == b.const(0) for slope in slopes for name in b.coordinates)
