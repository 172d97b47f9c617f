"""What was missing: of boxes on which nothing is proved, what stands in the way of a proof, and where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from rsym.bounds.balls import ctx
from rsym.program.operations import LOGICAL
from rsym.reports.numbers import short
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.holes import LONGEST, some_of
from rsym.verify.boxes.local import PRECISION, Box, Local, Model
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.boxes.sheets import sheets
from rsym.verify.boxes.touching import related

TOLD = 4  # sentences
LONG = 50  # sides of a box: what hangs on boxes farther apart is no point
OMEGA, LEAF = "omega", "a leaf"
TOGETHER = "two operands of a logical operation in it vanish"
EDGES = {
    "div": "its denominator vanishes",
    "sqrt": "what is under its root vanishes",
    "pow": "the base of its power vanishes",
    "log": "what it takes the logarithm of vanishes",
}
Names: TypeAlias = Callable[[int], str]


def lacking(model: Model, boxes: Sequence[Box], names: Names | None = None) -> tuple[tuple[str, bool], ...]:
    """Of boxes left over, sentences on what was missing there; none of them is proved.

    Parameters
    ----------
    model : Model
        Of a plane shape or a body.
    boxes : sequence of Box
        On which nothing is proved; some of them are looked at.
    names : callable, optional
        What a leaf is called; without it by its formula, if that is a short polynomial.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> lens = rsym.Shape(rsym.conjunction(1 - x**2 - y**2, y + sp.cos(x) - 2), (x, y))
    >>> lacking(Model(lens, {}), [((-0.1, 0.2), (0.9, 1.1))])[0][0]
    'near (0, 0.9): -x**2 - y**2 + 1 and a leaf may touch, as their gradients may be parallel'
    """
    found: dict[str, list[Box]] = {}
    with ctx.workprec(PRECISION):
        for box in some_of(boxes):
            reason = _reason(model.over(box), names or (lambda leaf: _formula(model, leaf)))
            found.setdefault(reason, []).append(box[: model.dimension])
    told = sorted(found.items(), key=lambda item: -len(item[1]))[:TOLD]
    return tuple((f"{_place(own)}: {reason}", False) for reason, own in told)


def _place(boxes: Sequence[Box]) -> str:
    """The middle of one of the boxes, and whether they are far apart."""
    low = [min(box[axis][0] for box in boxes) for axis in range(len(boxes[0]))]
    high = [max(box[axis][1] for box in boxes) for axis in range(len(boxes[0]))]
    width = max(b - a for box in boxes for a, b in box)
    middle = (short(round((a + b) / 2 / width) * width) for a, b in boxes[len(boxes) // 2])
    far = max(b - a for a, b in zip(low, high, strict=True)) > LONG * width
    return f"{'along a curve by' if far else 'near'} ({', '.join(middle)})"


def _reason(local: Local, names: Names) -> str:
    """What keeps a box open: a leaf that has no bounds, or no gradient, or leaves that touch."""
    found = sheets(local, local.model.root)
    if found is None or not found.leaves:
        return "the form of omega shows no leaf that has its sign"
    nodes = local.model.builder.nodes
    for leaf in found.leaves:
        own = generators(local, leaf)
        if own.hard:
            kinds = sorted({nodes[part].operation for part in own.hard if nodes[part].operation not in LOGICAL})
            where = EDGES.get(kinds[0], f"its {kinds[0]} is not analytic") if kinds else TOGETHER
            return f"derivatives of {names(leaf)} have no bound where {where}"
        if own.switches:
            return f"{names(leaf)} has other formulas across a switch, and how they continue each other is not proved"
    if len(found.leaves) == 1:
        (leaf,) = found.leaves
        if not local.ball(leaf).is_finite():
            return f"the values of {names(leaf)} have no bound on boxes of this size"
        if any(slope > 0 or slope < 0 for slope in local.gradient(leaf)):
            return f"{names(leaf)} is regular here, but the search ended before: a larger budget may decide"
        return f"the gradient of {names(leaf)} may vanish"
    called = list(dict.fromkeys(map(names, found.leaves)))
    if len(found.leaves) > 2:
        return f"{len(found.leaves)} leaves meet, among them {' and '.join(called[:2])}"
    both = (
        " and ".join(called) if len(called) > 1 else "two leaves" if called == [LEAF] else f"two leaves of {called[0]}"
    )
    if any(related(local, found.leaves)):
        return f"{both} may touch, as their gradients may be parallel"
    return f"{both} cross, and that they do so once is not proved"


def _formula(model: Model, leaf: int) -> str:
    """A leaf by its formula, if that is short."""
    formula = f"{polynomial_of(model, leaf) or ''}"
    return formula if 0 < len(formula) <= LONGEST else OMEGA if leaf == model.root else LEAF
