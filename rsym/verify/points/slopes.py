"""One-sided derivatives of a program at a point, in all directions at once.

The slope of u at p is H(d) = lim (u(p + r d) - u(p))/r for r -> 0+. Every operation here is continuous where it is
used, and the limit is uniform in d (B-differentiability), which chains: with u = u(p) + r H + o(r),
- an operation g that is C^1 at u(p) has the slope g'(u(p)) H;
- one that is Lipschitz and positively homogeneous of degree 1 (|.|, min, max, R_0, the norms) has, where all its
  arguments vanish, the slope g(H), for g(r H + o(r)) = r g(H) + o(r).
Sources: Shapiro, On concepts of directional differentiability, J. Optim. Theory Appl. 66 (1990), 477-487; Scholtes,
Introduction to Piecewise Differentiable Equations (2012), chapter 3.

All decisions are taken on a box that is a neighbourhood of p, so that they hold around p and not only there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rsym.bounds.balls import arb, exact, run
from rsym.program.differentiation import RULES
from rsym.program.operations import BRANCHING, CHOOSING, HOMOGENEOUS, POWERS, those
from rsym.verify.boxes.domains import is_defined, is_legal
from rsym.verify.boxes.generators import generators, is_analytic_at
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import chosen
from rsym.verify.boxes.vanishing import Exact
from rsym.verify.points.slope_rules import Homogeneous, Length, Linear, Rule, Size, Tie, TrimmedEnd, Vector

# Of class C^1, for p > 1, where the operands are not both zero.
_P_SYSTEMS = those(lambda row: row.analytic_even is not None and bool(row.grows))
_CORNERED = HOMOGENEOUS - BRANCHING


@dataclass(frozen=True)
class Slopes:
    """The rules that lead from the slopes of the coordinates to that of a node."""

    number: int
    coordinates: tuple[int, ...]
    rules: tuple[tuple[int, Rule], ...]

    def at(self, direction: Vector) -> dict[int, arb | None]:
        """The slopes in some directions, by node."""
        known: dict[int, arb | None] = dict(zip(self.coordinates, direction, strict=True))
        run([(part, rule.slope, rule.arguments) for part, rule in self.rules], known)
        return known

    def gradient(self, direction: Vector) -> Vector | None:
        """A box of all limits of the gradient of the node at p + r d for r -> 0, d in some directions."""
        places = range(len(self.coordinates))
        return self._limits(direction, [tuple(arb(int(own == other)) for other in places) for own in places])

    def growth(self, direction: Vector, way: Vector) -> arb | None:
        """A ball around all limits of the derivative in one way at p + r d for r -> 0, d in some directions."""
        found = self._limits(direction, [(part,) for part in way])
        return None if found is None else found[0]

    def _limits(self, direction: Vector, seeds: Sequence[Vector]) -> Vector | None:
        """Derivatives, given those of the coordinates."""
        slopes = self.at(direction)
        found = dict(zip(self.coordinates, seeds, strict=True))
        for part, rule in self.rules:
            own = [slope for argument in rule.arguments if (slope := slopes[argument]) is not None]
            gradients = [found[argument] for argument in rule.arguments if argument in found]
            if len(own) == len(gradients) == len(rule.arguments):
                value = rule.gradient(own, gradients)
                if value is not None:
                    found[part] = value or tuple(arb(0) for _ in seeds[0])  # of a constant
        return found.get(self.number)


def slopes_of(local: Local, known: Exact, number: int) -> Slopes | None:
    """The slopes of a node; None where a rule is missing."""
    builder = local.model.builder
    coordinates = tuple(builder.input(name) for name in builder.coordinates)
    rules: dict[int, Rule] = {}
    for part in local.model.order(number):
        rule = None if part in coordinates else _rule(local, known, part)
        if rule is not None and all(argument in rules or argument in coordinates for argument in rule.arguments):
            rules[part] = rule
    if number not in rules and number not in coordinates:
        return None
    needed, stack = set(), [number]
    while stack:
        part = stack.pop()
        if part not in needed and part in rules:
            needed.add(part)
            stack.extend(rules[part].arguments)
    return Slopes(number, coordinates, tuple((part, rule) for part, rule in rules.items() if part in needed))


def _rule(local: Local, known: Exact, part: int) -> Rule | None:
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[part]
    if builder.uniform[part]:
        return Linear((), ()) if is_defined(local, part) else None
    if operation in CHOOSING and (branch := chosen(local, part)) is not None:
        return Linear((branch[0],), (arb(branch[1]),))
    fixed = arguments[1:] if operation in POWERS else arguments[2:]  # parameters, as which the rules take them
    if not all(builder.uniform[parameter] for parameter in fixed):
        return None
    if is_analytic_at(local, part) or (operation in _P_SYSTEMS and _is_apart(local, part)):
        return _linear(local, known, part)
    if operation in _CORNERED and known.vanishes(*arguments[:2]) and is_legal(local, part):
        return Homogeneous(arguments[:2], local, part)
    if operation in {"min", "max"}:
        tie = known.vanishes(*arguments) or known.vanishes(builder.sub(*arguments))
        return Tie(arguments, operation) if tie else None
    if operation == "abs":
        return Size(arguments) if known.vanishes(*arguments) else None
    if operation in {"r0m_conjunction", "r0m_disjunction"}:
        flat = known.vanishes(*arguments[:2]) and is_legal(local, part)
        return Linear(arguments[:2], (arb(0), arb(0))) if flat else None
    return _rarer(local, known, part)


def _rarer(local: Local, known: Exact, part: int) -> Rule | None:
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[part]
    if operation == "trimming":
        s, t = arguments
        inner = builder.nodes[s]
        if not known.vanishes(s):
            return None
        if inner.operation != "mul" or inner.arguments[0] != inner.arguments[1]:
            found = squares(local, known, s) if local.sign(t) > 0 else None  # sqrt(s) but for the fourth order of it
            return None if found is None else _length([*found, (arb(0), t)])
        f = inner.arguments[0]
        if not known.vanishes(f):
            return None
        if local.sign(t) > 0:  # the gap is of the fourth order in f, but it must be continuous: t is an argument too
            return Size((f, t))
        return TrimmedEnd((f, t)) if known.vanishes(t) else None
    if operation == "sqrt":
        found = squares(local, known, arguments[0])
        return None if found is None else _length(found)
    if operation in POWERS and known.vanishes(arguments[0]):
        exponent = builder.value(arguments[1])
        if exponent == 1:
            return Size(arguments[:1]) if operation == "absolute_power" else Linear(arguments[:1], (arb(1),))
        return Linear(arguments[:1], (arb(0),)) if exponent is not None and exponent > 1 else None
    return None


def _length(pairs: list[tuple[arb, int]]) -> Length:
    return Length(tuple(node for _, node in pairs), tuple(factor for factor, _ in pairs))


def _is_apart(local: Local, part: int) -> bool:
    """Whether an operation with the norm of order p is C^1: p > 1 and its arguments are not both zero."""
    f, g, p = local.model.builder.nodes[part].arguments
    order = local.value(p)
    return order is not None and bool(order > 1) and (local.nonzero(f) or local.nonzero(g))


def _linear(local: Local, known: Exact, part: int) -> Rule | None:
    """The chain rule; each partial derivative is the rule of differentiation for a unit vector of derivatives."""
    builder = local.model.builder
    node = builder.nodes[part]
    factors, arguments = [], []
    for place, argument in enumerate(node.arguments):
        unit = [builder.const(int(other == place)) for other in range(len(node.arguments))]
        derived = RULES[node.operation](builder, part, node, unit)
        if builder.value(derived) == 0:
            continue
        rational = known.value(derived)
        value = local.value(derived) if rational is None else exact(rational)
        if value is None or not value.is_finite():
            return None
        factors.append(value)
        arguments.append(argument)
    return Linear(tuple(arguments), tuple(factors))


def squares(local: Local, known: Exact, number: int) -> list[tuple[arb, int]] | None:
    """A node as a sum of c u**2 but for higher orders, c > 0 near the point and each u zero at it: pairs of c and u.

    In the place of u = x - p stands the coordinate x, which has the same slope.
    """
    builder = local.model.builder
    operation, arguments, data = builder.nodes[number]
    if operation == "add":
        parts = [squares(local, known, argument) for argument in arguments]
        if None in parts:
            return _valley(local, known, number)
        return [pair for part in parts if part is not None for pair in part]
    if operation == "powi" and isinstance(data, int) and data % 2 == 0:
        return [(arb(0), arguments[0])] if known.vanishes(arguments[0]) else None
    if operation != "mul":
        return _valley(local, known, number)
    if arguments[0] == arguments[1]:
        return [(arb(1), arguments[0])] if known.vanishes(arguments[0]) else None
    for factor, other in (arguments, arguments[::-1]):
        value = local.value(factor)
        if value is not None and local.sign(factor) > 0 and is_defined(local, factor):
            found = squares(local, known, other)
            # The factor must be continuous: it is listed with the weight 0, so that a slope of it must be known.
            return None if found is None else [(value * c, u) for c, u in found] + [(arb(0), factor)]
    return _valley(local, known, number)


def _valley(local: Local, known: Exact, number: int) -> list[tuple[arb, int]] | None:
    """An analytic node g of one coordinate x with g = g' = 0 < g'' at the point, and so g > 0 beside it.

    g = c (x - p)**2 + o(|x - p|**2), c = g''/2, and its root has the slope of that of c (x - p)**2.
    """
    model = local.model
    inputs = [part for part in model.order(number) if model.builder.nodes[part].operation == "input"]
    coordinates = [part for part in inputs if not model.builder.uniform[part]]
    if len(coordinates) != 1 or not generators(local, number).analytic or not known.vanishes(number):
        return None
    axis = model.builder.coordinates.index(str(model.builder.nodes[coordinates[0]].data))
    slope = model.gradient(number)[axis]
    bend = local.value(model.gradient(slope)[axis]) if known.vanishes(slope) else None
    return [(bend / 2, coordinates[0])] if bend is not None and bend > 0 else None
