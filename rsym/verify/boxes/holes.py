"""Holes: where omega has no value, though a limit it may have: sin(x)/x and x**2 log|x| at x = 0."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rsym.bounds.balls import ctx
from rsym.logic.stripping import bare
from rsym.verify.boxes.breaks import changes_sign
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import PRECISION, Box, Local, Model
from rsym.verify.boxes.polynomials import polynomial_of

LOOKED_AT = 32  # boxes of those left over
LONGEST = 60  # letters of a formula: what is longer tells nobody where it holds


def some_of(boxes: Sequence[Box]) -> Sequence[Box]:
    """Those of many boxes that are looked at.

    Examples
    --------
    >>> len(some_of([((0.0, 1.0),)] * 100))
    34
    """
    return boxes[:: max(1, len(boxes) // LOOKED_AT)]


def holes(model: Model, boxes: Sequence[Box]) -> tuple[tuple[str, bool], ...]:
    """Of boxes left over, sentences on where omega has no value, each with whether it is proved.

    A denominator, or what a logarithm takes the modulus of, is zero within a box at whose corners it has both signs.

    Parameters
    ----------
    model : Model
        Of a plane shape or a body.
    boxes : sequence of Box
        On which nothing is proved; some of them are looked at.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> holes(Model(rsym.Shape(y - sp.sin(x) / x, (x, y)), {}), [((-0.1, 0.2), (0.9, 1.1))])
    (('omega has no value where x = 0', True),)
    """
    found: dict[str, None] = {}
    with ctx.workprec(PRECISION):
        for box in some_of(boxes):
            found.update(dict.fromkeys(_equations(model.over(box))))
    return tuple((f"omega has no value where {equation}", True) for equation in found)


def _equations(local: Local) -> Iterator[str]:
    builder = local.model.builder
    for part in sorted(generators(local, local.model.root).hard):
        operation, arguments, _ = builder.nodes[part]
        below = arguments[-1] if operation in {"div", "log"} else None
        if operation == "log" and below is not None:
            inner = builder.nodes[below]
            below = inner.arguments[0] if inner.operation == "abs" else None
        if below is not None and changes_sign(local, below := bare(builder, below)):
            formula = polynomial_of(local.model, below)
            equation = f"{formula} = 0"
            if formula is not None and len(equation) <= LONGEST:
                yield equation
