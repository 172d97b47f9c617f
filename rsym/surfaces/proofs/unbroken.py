"""Formulas with pieces: whether what they say where a comparison has equal sides is what the pieces tend to there.

A proof takes the pieces that hold on parts of an edge, inside the patch. Where they meet the formula may say a third
thing: ``Piecewise((0, u < 1), (0, u > 1), (1, True))`` is nought but for a point. It is a function without a break only
if at each such place its own value is the limit of the pieces on both sides, by exact arithmetic. Of a place on an
edge that goes for the derivatives across the edge too: ``u*Piecewise((0, v < 1), (0, v > 1), (1, True))`` is nought on
the edge u = 0, and has a break on the line v = 1 that leads to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from rsym.program.builder import Builder
from rsym.surfaces.proofs.edge_formulas import ORDERS, EdgeJet, EdgeWalk, PatchFormula
from rsym.surfaces.proofs.exact_values import exact_values
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part

if TYPE_CHECKING:
    from rsym.surfaces.joints.edges import PatchEdge

POSITION = ORDERS[:1]
ACROSS = tuple(order for order in ORDERS if order[0] == 0)
AXES = 3


def check_unbroken(formula: PatchFormula, edge: PatchEdge, part: Part, walk: EdgeWalk, jet: EdgeJet) -> None:
    """Compare an edge with what its formula says where pieces meet on a part, which has none of its own.

    Raises
    ------
    NoProof
        It says something else there, or is not proved to say the same.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.joints.edges import PatchEdge
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.proofs.edge_formulas import ALONG
    >>> from rsym.surfaces.symbols import u, v
    >>> patch = ParametricSurface((u, v, sp.Piecewise((0, u > 0), (1, True))))
    >>> edge, formula, part = PatchEdge(patch, "v0"), PatchFormula(patch, {}), (Fraction(0), Fraction(1))
    >>> check_unbroken(formula, edge, part, ALONG, formula.jet(edge, Builder(("t",), ()), part, ALONG, POSITION))
    Traceback (most recent call last):
    ...
    rsym.surfaces.proofs.specialised.NoProof: the pieces of a formula do not meet at t = 0
    """
    for place in sorted(jet.joins):
        target = Builder((PARAMETER,), ())
        still = EdgeWalk(walk(place), Fraction(0))
        said = formula.jet(edge, target, (place, place), still, ACROSS, literal=True).nodes
        _compare(target, formula.jet(edge, target, part, walk, ACROSS).nodes, said, place)
    if jet.lies_on_border:
        target = Builder((PARAMETER,), ())
        taken, said = (
            formula.jet(edge, target, part, walk, POSITION, literal=literal).nodes[:AXES] for literal in (False, True)
        )
        _compare(target, taken, said, None)


def _compare(target: Builder, taken: Sequence[int], said: Sequence[int], place: Fraction | None) -> None:
    """Compare what the pieces make with what the formula says."""
    values = exact_values(target.nodes, [*taken, *said], place)
    if not all((a - b).is_zero for a, b in zip(values[: len(taken)], values[len(taken) :], strict=True)):
        where = "along the edge" if place is None else f"at t = {place}"
        raise NoProof(f"the pieces of a formula do not meet {where}")
