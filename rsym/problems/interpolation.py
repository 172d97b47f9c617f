"""Transfinite interpolation: a function with given values and normal derivatives on parts of the boundary."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet
from rsym.analysis.transfinite import OnPart, inverse_distances, joined_weights, taylor
from rsym.errors import RsymError
from rsym.logic.weights import even
from rsym.model.arguments import LetterMapping, whole
from rsym.model.requirements import require_mapping, require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import symbols_of
from rsym.model.wording import proposal
from rsym.problems.conditions import Name
from rsym.problems.parts import formula, parts_of
from rsym.problems.seams.seamless import seamless

BLENDS = {"inverse": inverse_distances, "joined": joined_weights}
MOST = 3  # the formula of omega normalised to order 3 is a thousand times as long as that of omega


def interpolate(
    shape: Shape,
    data: Mapping[Any, Any],
    order: int = 1,
    *,
    weights: str = "inverse",
    length: Any = None,
    letters: LetterMapping = None,
) -> Shape:
    """A function that has given values, and normal derivatives, on named parts of the boundary of a shape.

    With w_i a function that vanishes on part i alone, normalised to order m,

        u = sum of w_i**-k * u_i / sum of w_j**-k,    k the even number of m + 1 and m + 2

    has on part i the derivatives of u_i to order m. u_i is the value g_i given there, or the generalised Taylor form
    sum of (-1)**l * h_l(x - w_i grad w_i) * w_i**l / l! for the value and the derivatives h_l along the outward normal.
    Values and derivatives are met exactly, but for rounding, in the closed shape; of what u is outside nothing is said.

    Parameters
    ----------
    shape : Shape
        In the plane or in space; its parts have names, by ``shape.named(name)``.
    data : mapping
        Names of parts to data, ``...`` for the rest: a number, an expression in coordinates and letters or a shape for
        the value; a tuple (value, slope, ...) of them for derivatives too; or the conditions `dirichlet` and
        `clamped`. A part of which nothing is said is met by no data.
    order : int
        m, from 1 to 3, the order of the derivatives that may be given. Where a value alone is given, u has with it the
        derivatives that its formula has there.
    weights : "inverse" or "joined"
        Inverse distances, as above, or the shares o_i**k/(sum of o_j**k) where o_i, the joining of the weights of all
        parts but i, is (sum of w_j**-k over j other than i)**(-1/k). For up to two parts they are the same.
    length : number or expression, optional
        That of `normalise`, to which w_i of what is no plane, sphere or circle tends far away; by default the power of
        2 next to half the longest side of the bounds.
    letters : mapping, optional
        Of the data, ``{symbol or name: number or Letter}``.

    Returns
    -------
    Shape
        Its expression is u, in closed form, letters live, in the coordinates and bounds of the shape: for level lines,
        fields, `compile`, `to_jax` and the like. The sign of u has no meaning. Where parts meet its value is that of
        the one named first, gradients do not exist there.

    Raises
    ------
    RsymError
        ``unknown-part``; ``vanished-part`` for one that has nothing of the boundary; ``contradiction`` for values that
        differ where two parts meet, with the place and both values; ``singular-part`` for slopes where the gradient of
        the formula is zero; all where letters have their defaults. A shape without bounds that goes on without end;
        data without a formula, or of more derivatives than the order.

    Source: Rvachev, Sheiko, Shapiro and Tsukanov (2001); the Taylor form: Rvachev (1982).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> u = rsym.interpolate(ring, {"rim": x, "bore": (0, 3)})
    >>> found = rsym.compile(u, ("value", "gradient"))([2.0, 1.2, 0.0], [0.0, 1.6, 1.0])
    >>> found["value"].tolist(), found["gradient"][2].tolist()  # the outward normal of the hole is (0, -1) there
    ([2.0, 1.2, 0.0], [0.0, -3.0])
    """
    require_shape(shape)
    require_mapping(data, "data", 'for example {"rim": 0, "bore": x}')
    degree = whole(order, "the order", 1)
    if degree > MOST:
        raise RsymError(f"the order may be from 1 to {MOST}, got {order}", code="order", remedy="order=1")
    if weights not in BLENDS:
        raise RsymError(
            f"no weights {weights!r}", code="weights", remedy=proposal(weights, BLENDS, '"inverse" or "joined"')
        )
    known, slopes = _formulas(seamless(shape.replace(letters=shape.letters.merge(letters)), False).shape, data, degree)
    if not slopes:
        raise RsymError("there are no data to interpolate", code="data", remedy='for example {"rim": 0, ...: x}')
    parts = parts_of(known, slopes)
    parts.require_all()
    parts.require_agreement({name: given[0] for name, given in slopes.items() if name in parts.leaves})
    found = parts.weights(degree, length)
    weighed = {name: found.of(leaves) for name, leaves in parts.leaves.items()}
    parts.require_slopes({name: w for name, w in weighed.items() if len(slopes[name]) > 1})
    pieces = [OnPart(taylor(w, shape.coordinates, slopes[name]), w) for name, w in weighed.items()]
    u = BLENDS[weights](pieces, even(degree + 1))
    return Shape(u, shape.coordinates, letters=known.letters, bounds=parts.box)


def _formulas(shape: Shape, data: Mapping[Any, Any], order: int) -> tuple[Shape, dict[Name, list[sp.Expr]]]:
    """The shape with the letters of the data, and these as formulas: value, slope and so on."""
    found, letters = dict[Name, list[sp.Expr]](), shape.letters
    for name, given in data.items():
        values = _values(given, name, order)
        found[name] = []
        for value in values:
            expression, more = formula(value, shape, f"the value on {name!r}")
            found[name].append(expression)
            letters = letters.merge(more)
    known = {*letters, *(symbol.name for symbol in shape.coordinates)}
    for name, formulas in found.items():
        for symbol in symbols_of(*formulas):
            if symbol.name not in known:
                raise RsymError(
                    f"the value on {name!r} contains {symbol}, neither coordinate nor letter",
                    code="unknown-letter",
                    remedy=f"give letters={{'{symbol}': value}}",
                )
    return shape.replace(letters=letters), found


def _values(given: Any, name: Any, order: int) -> tuple[Any, ...]:
    """What is given for a part as value, slope and so on."""
    if isinstance(given, BoundaryCondition) and not isinstance(given, Dirichlet | Clamped):
        raise RsymError(
            f"on {name!r} a value, or value and slope, can be interpolated, not {given}",
            code="condition",
            remedy="rsym.solution_structure meets such conditions",
        )
    values = given.values if isinstance(given, BoundaryCondition) else given if isinstance(given, tuple) else (given,)
    if not 1 <= len(values) <= order + 1:
        raise RsymError(
            f"on {name!r} there are {len(values)} data, the value and {order} derivatives at most",
            code="order",
            remedy=f"order={len(values) - 1}" if values else "give a value",
        )
    return tuple(values)
