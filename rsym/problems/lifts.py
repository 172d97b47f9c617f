"""Lifts: functions with the values of u on the boundary, so that what is left to be found is 0 there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Supported, UnknownLevel
from rsym.analysis.differential import derivative
from rsym.analysis.meeting_parts import MeetingParts, Vanishing, by_pairs, joined_values
from rsym.analysis.transfinite import OnPart, inverse_distances
from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.logic.weights import MOST_FACTORS, weight
from rsym.model.nodes import RealNode
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.model.wording import listing
from rsym.problems.boundary_data import kept_to_boundary
from rsym.problems.conditions import Name
from rsym.problems.interpolation import interpolate
from rsym.problems.jumps import jumps_of, with_jumps
from rsym.problems.parts import Parts, formula, parts_of
from rsym.program.raising import raised
from rsym.reports.words import plural

MOST_SIDES = 6  # leaves, each of which is a part of its own: straight ones make smooth lifts, their products do not
DEGREE = 3  # of Taylor's polynomials of differences of data
REACH = 0.25  # of the longest side: how far from corners maps to curved parts are good
TANGENT = 0.999  # the cosine between parts that are taken for one curve where they meet
ROUGH = 1e4  # third derivatives on the boundary, by the longest side, beyond which data have roots or poles beside it
ENTIRE = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh)
ANALYTIC = (sp.log, sp.tan, sp.tanh, sp.atan, sp.asin, sp.acos, sp.asinh, sp.acosh, sp.atanh, sp.erf)


class Lift(NamedTuple):
    """A function with the values of u on the boundary, and how it was found, for reports."""

    expression: sp.Expr
    how: tuple[str, ...] = ()


def lift_of(shape: Shape, conditions: Mapping[Name, BoundaryCondition], jumping: bool = False) -> Lift:
    """An expression that is u, and has the slopes of u, on the parts where these are given; 0 where they are 0.

    Of one value for all of these parts it is that; else, without slopes, `lift_on`. Where parts meet at an angle it is
    smooth, or its second derivatives are bounded where parts are curved; they grow like 1/r where it has the shares of
    distances alone: where parts touch, for values with kinks or with poles beside the shape, and for parts of more
    than 6 leaves.

    Raises
    ------
    RsymError
        As `interpolate`: for parts that are not there, and values that differ where parts meet.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> lift_of(ring, {"rim": rsym.dirichlet(x), ...: rsym.neumann()}).expression
    x
    """
    data: dict[Name, tuple[sp.Expr, ...]] = {}
    how: tuple[str, ...] = ()
    for name, condition in conditions.items():
        if isinstance(condition, UnknownLevel):
            data[name] = (sp.S.Zero,)
        elif isinstance(condition, Dirichlet | Clamped | Supported):
            data[name] = tuple(_expression(shape, value, name) for value in condition.values)
    for place, what in enumerate(("Values", "Slopes")):
        some = {name: given[place] for name, given in data.items() if len(given) > place}
        if any(symbols_of(value) for value in some.values()):
            kept = kept_to_boundary(shape, some)
            rough = ["the rest" if name is ... else repr(name) for name, value in kept.items() if some[name] != value]
            told = f"{what} on {listing(rough)} are kept to the boundary: their formulas are rough inside."
            how += (told,) if rough else ()
            for name, value in kept.items():
                data[name] = (*data[name][:place], value, *data[name][place + 1 :])
    values = {given[0] for given in data.values()}
    if len(values) < 2:
        value = values.pop() if values else sp.S.Zero
        level = not set(symbols_of(value)) & set(shape.coordinates)
        if all(len(given) == 1 or (level and given[1] == 0) for given in data.values()):
            return Lift(value, how)
    if any(len(given) > 1 for given in data.values()):
        return Lift(interpolate(shape, data).expression, (*how, "Values and slopes go inside by distances from parts."))
    made = lift_on(parts_of(shape, data), {name: given[0] for name, given in data.items()}, {}, jumping)
    return Lift(made.expression, how + made.how)


def lift_on(
    parts: Parts, values: Mapping[Name, sp.Expr], factors: Mapping[int, sp.Expr], jumping: bool = False
) -> Lift:
    """An expression with values on parts; the weights of some leaves have factors.

    Parts that meet are one cluster, with a function of its own (`_joined`); of several clusters it is the sum of
    u_i/w_i over that of 1/w_i, w_i the smooth weight of a cluster: like the distance from it but at corners, so that u
    is nowhere steeper than what lies between. The factors are 0 in points at most. Powers of the weights themselves,
    which they stand for, have gradients beyond all bounds where their parts meet others. Only if `jumping` may values
    differ at corners.
    """
    parts.require_all()
    own: dict[int, sp.Expr] = {leaf: values[name] for name, leaves in parts.leaves.items() for leaf in leaves}
    if not own:
        return Lift(sp.S.Zero)
    if jumping and (jumps := jumps_of(parts, own)):
        given = {name: value for name, value in values.items() if name in parts.leaves}
        parts.require_agreement(given, [jump.corner.point for jump in jumps])
        function, left = with_jumps(parts, own, jumps)
        jump = (f"Values jump at {plural(len(jumps), 'corner')}: near to it they go as the angle between its edges.",)
        if all(value == 0 for value in left.values()):
            return Lift(function, jump)
        single = replace(parts, leaves={f"leaf {leaf}": (leaf,) for leaf in left})
        rest = lift_on(single, {f"leaf {leaf}": value for leaf, value in left.items()}, factors)
        return Lift(function + rest.expression, jump + rest.how)
    parts.require_agreement({name: value for name, value in values.items() if name in parts.leaves})
    alike: dict[object, list[int]] = {}
    for leaf, value in own.items():
        alike.setdefault(value, []).append(leaf)
    sides, parts = _sides(parts, own, list(alike.values()))
    links = coo_matrix((len(sides),) * 2)
    if len(sides) > 1:
        met = [pair for pair in combinations(range(len(sides)), 2) if len(_meeting(parts, sides, pair))]
        one, other = np.array(met, np.int64).reshape(-1, 2).T
        links = coo_matrix((np.ones(len(met)), (one, other)), shape=links.shape)
    count, cluster = connected_components(links, directed=False)
    found, how = [], list[str]()
    for number in range(count):
        leaves = {leaf: own[leaf] for k in np.flatnonzero(cluster == number) for leaf in sides[k].leaves}
        made = Lift(next(iter(leaves.values())))
        if len({*leaves.values()}) > 1:
            made = _joined(parts, leaves, factors)
        how += made.how
        found.append((made.expression, [*leaves]))
    if count == 1:
        return Lift(found[0][0], tuple(how))
    weights = parts.smooth_weights()
    pieces = []
    for function, chosen in found:
        more = dict.fromkeys(factors[leaf] for leaf in chosen if leaf in factors)
        pieces.append(OnPart(function, sp.Mul(*more) * weights.of(chosen)))
    how.append(f"Between {count} groups of parts that do not meet values go by normalised weights.")
    return Lift(inverse_distances(pieces, 1), tuple(how))


def _sides(parts: Parts, own: Mapping[int, sp.Expr], groups: Sequence[Sequence[int]]) -> tuple[list[_Side], Parts]:
    """Groups of leaves with one value as parts: by the names that these have, where that is all of them."""
    named = {tuple(leaves): name for name, leaves in parts.leaves.items()}
    sides = [
        _Side(named.get(tuple(leaves), f"side {k} of {leaves[0]}"), own[leaves[0]], tuple(leaves))
        for k, leaves in enumerate(groups)
    ]
    if {side.name for side in sides} != {*parts.leaves}:  # where these meet is known
        parts = replace(parts, leaves={side.name: side.leaves for side in sides})
    return sides, parts


def _meeting(parts: Parts, sides: Sequence[_Side], pair: tuple[int, int]) -> Floats:
    """The points where two sides meet."""
    return parts.meeting(sides[pair[0]].name, sides[pair[1]].name)[0]


def _joined(parts: Parts, own: Mapping[int, sp.Expr], factors: Mapping[int, sp.Expr]) -> Lift:
    """A function with values on leaves that meet, `by_pairs` of those that do."""
    alike: dict[object, list[int]] = {}
    for leaf, value in own.items():
        alike.setdefault(leaf if len(own) <= MOST_SIDES else value, []).append(leaf)
    sides, parts = _sides(parts, own, list(alike.values()))
    pieces = [OnPart(side.value, _weight(parts, side, factors)) for side in sides]
    made: list[tuple[tuple[int, ...], sp.Expr]] = []
    rough = 0
    for one, other in combinations(range(len(sides)), 2):
        points = _meeting(parts, sides, (one, other))
        if len(points):
            both = sides[one], sides[other]
            switched = any(leaf in factors for side in both for leaf in side.leaves)
            corner = None if switched else _corner(parts, *both, points)
            rough += corner is None and both[0].value != both[1].value and not switched
            made.append(((one, other), joined_values(pieces[one], pieces[other], parts.shape.coordinates, corner)))
    alone = {*range(len(sides))} - {number for pair, _ in made for number in pair}
    how = [f"Values of {plural(len(sides), 'side')} that meet go inside by pairs."]
    if rough:
        how.append(f"Of {rough} of these pairs by shares of distances alone: there splines are less accurate.")
    function = by_pairs(_of_usual_size(parts, pieces), [*made, *(((k,), pieces[k].function) for k in sorted(alone))])
    return Lift(function, tuple(how))


class _Side(NamedTuple):
    """Leaves with one value."""

    name: Name
    value: sp.Expr
    leaves: tuple[int, ...]


def _weight(parts: Parts, side: _Side, factors: Mapping[int, sp.Expr]) -> sp.Expr:
    node = weight(parts.form, side.leaves)
    assert node is not None
    own = dict.fromkeys(factors[leaf] for leaf in side.leaves if leaf in factors)
    return sp.Mul(*own) * raised(parts.form.builder.nodes, node)


def _corner(parts: Parts, one: _Side, other: _Side, points: Floats) -> MeetingParts | None:
    """What maps to parts are made of; None where nothing of few factors is 0 on them, or values are not smooth."""
    if one.value == other.value or max(len(one.leaves), len(other.leaves)) > MOST_FACTORS:
        return None
    if not _smooth(parts, other.value - one.value, points):
        return None
    nodes, zeros, slopes = parts.form.builder.nodes, [], []
    for side in (one, other):
        function = sp.Mul(*(raised(nodes, parts.form.leaves[leaf]) for leaf in side.leaves))
        kernel = compile(parts.shape.replace(expression=function), ("gradient",), backend="numpy")
        with np.errstate(all="ignore"):
            slopes.append(kernel(*points.T)["gradient"])
        steep = np.linalg.norm(slopes[-1], axis=1)
        if not (np.isfinite(steep).all() and steep.all()):
            return None
        zeros.append(Vanishing(function, _near_power(float(np.median(steep)))))
    lengths = np.prod([np.linalg.norm(slope, axis=1) for slope in slopes], axis=0)
    if (np.abs(np.sum(slopes[0] * slopes[1], axis=1)) > TANGENT * lengths).any():
        return None
    return MeetingParts(zeros[0], zeros[1], _near_power(REACH * float(np.diff(parts.box, axis=1).max())), DEGREE)


def _smooth(parts: Parts, value: sp.Expr, met: Floats) -> bool:
    """Whether a formula has derivatives all over the shape: it is entire, or its roots and the like are far away."""
    doubtful = False
    for part in postorder(value):
        if isinstance(part, sp.Function | sp.Pow) and not part.is_number:
            entire = isinstance(part, ENTIRE) or (
                part.is_Pow and (part.base.is_number or (part.exp.is_Integer and part.exp > 0))
            )
            doubtful |= not entire
            if not (entire or part.is_Pow or isinstance(part, ANALYTIC)):
                return False
        elif not (part.is_Add or part.is_Mul or part.is_Symbol or part.is_number):
            return False
    if not doubtful:
        return True
    shape, size = parts.shape, float(np.diff(parts.box, axis=1).max())
    points = np.vstack([met, *(parts.points(name) for name in parts.leaves)])
    with np.errstate(all="ignore"):
        usual = np.abs(compile(shape.replace(expression=value), backend="numpy")(*points.T)["value"]).max()
        for symbol in shape.coordinates:
            steeper = shape.replace(expression=derivative(value, symbol))
            third = np.abs(compile(steeper, ("hessian",), backend="numpy")(*points.T)["hessian"]).max()
            if not third * size**3 <= ROUGH * usual:
                return False
    return True


def _near_power(size: float) -> sp.Rational:
    """The power of 2 next to it."""
    return sp.Integer(2) ** round(math.log2(size))


def _of_usual_size(parts: Parts, pieces: Sequence[OnPart]) -> list[OnPart]:
    """The pieces with weights that are about 1 on the other parts."""
    points = [parts.points(name) for name in parts.leaves]
    found = []
    for k, piece in enumerate(pieces):
        others = np.vstack([some for j, some in enumerate(points) if j != k])
        kernel = compile(parts.shape.replace(expression=piece.weight), backend="numpy")
        with np.errstate(all="ignore"):
            usual = float(np.nanmax(np.abs(kernel(*others.T)["value"])))
        scale = _near_power(usual) if np.isfinite(usual) and usual > 0 else sp.S.One
        # At re-entrant corners weights have kinks, their squares less so.
        power = 2 if any(isinstance(part, RealNode) for part in postorder(piece.weight)) else 1
        found.append(piece._replace(weight=(piece.weight / scale) ** power))
    return found


def _expression(shape: Shape, value: Any, name: Name) -> sp.Expr:
    return formula(value, shape, f"the value on {'the rest' if name is ... else repr(name)}")[0]
