"""Fields: the functions that are derived from omega, as nodes of one program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.wording import proposal
from rsym.program.builder import Builder
from rsym.program.calculus import FORMS, HIGHEST, ONE_SIDED, SCALARS, Calculus, OneSided, order_of, parsed
from rsym.program.elementary import bearing
from rsym.program.lowering import lower
from rsym.program.operations import OPERATIONS, TORN
from rsym.program.program import FLOAT64, Node, Program, live
from rsym.program.row import unbounded

SIX: tuple[str, ...] = (
    "value",
    "normalised",
    "gradient_squared",
    "normalised_gradient_squared",
    "laplacian",
    "normalised_laplacian",
)
FIELDS: tuple[str, ...] = (
    *SCALARS,
    *(f"{form}_gradient" for form in ("normalised", *FORMS)),
    "gradient",
    "hessian",
    "singular",
    "principal_curvatures",
    "principal_directions",
)


def outputs_of(calculus: Calculus, field: str) -> dict[str, int]:
    """The scalar outputs that make up a field."""
    names = part_names(field, len(calculus.builder.coordinates))
    return dict(zip(names.flat, np.asarray(calculus.nodes(field)).flat, strict=True))


class Existence:
    """Where the derivatives of a function exist, as nodes of its program: NaN takes the place of those that do not.

    `share` is the part of the size of a derivative that a difference between the sides of a switch must exceed to
    count; less is rounding.
    """

    def __init__(self, calculus: Calculus, share: Fraction) -> None:
        self.calculus = calculus
        self.builder = calculus.builder
        self.share = share
        self.jumps = Jumps(calculus.builder)
        self._doubts: dict[int, int] = {}

    def _size(self, order: int) -> int:
        """What a jump is measured by: the derivatives of this order, for the value what moves it in its last places."""
        b, found = self.builder, self.calculus.derivatives(order)
        sizes = [b.abs(node) for node in found]
        if order == 0:
            names = zip(self.calculus.gradient, b.coordinates, strict=True)
            sizes += [b.abs(b.mul(slope, b.input(name))) for slope, name in names]
        return reduce(b.add, sizes)

    def doubts(self, order: int) -> int:
        """Positive where some derivative below an order jumps, else 0; from the third on, on any border at all."""
        if order not in self._doubts:
            b = self.builder
            if order > 2:
                smooth = all(self._total(k) == b.const(0) for k in range(3))
                found = b.const(0) if smooth else self.jumps.borders(self.calculus.value)
            else:
                below = [doubt(b, self._total(k), self._size(k), self.share) for k in range(order)]
                found = reduce(b.add, below, b.const(0))
            self._doubts[order] = found
        return self._doubts[order]

    def _total(self, order: int) -> int:
        b = self.builder
        return reduce(b.add, [self.jumps[node] for node in self.calculus.derivatives(order)])

    def kept(self, field: str, node: int) -> int:
        """The node of a field, NaN where a derivative that it is made of does not exist."""
        b, order = self.builder, order_of(field)
        if order == 0:
            return node
        doubts = self.doubts(order)
        if order <= 2:
            own = self.jumps[node] if field in {"gradient", "singular", "hessian"} else self._total(order)
            doubts = b.add(doubts, doubt(b, own, self._size(order), self.share))
        if parsed(field)[2] != "value":
            return unless(b, doubts, node)
        # What is normalised is 0 with omega, whatever becomes of its derivatives.
        zero = unless(b, self.doubts(1), node)
        return b.select(b.abs(self.calculus.value), b.const(0), unless(b, doubts, node), zero)


def gather(parts: Mapping[str, Any], fields: Sequence[str], size: int, xp: Any = np) -> dict[str, Any]:
    """The fields from their scalar parts: gradient (..., dim), hessian (..., dim, dim), singular boolean and so on.

    The arrays are those of the package `xp`, with names as NumPy has them.
    """
    result: dict[str, Any] = {}
    for field in fields:
        if field in SCALARS:
            result[field] = parts[field]
            continue
        names = part_names(field, size)
        stack = xp.stack([parts[name] for name in names.flat], axis=-1)
        whole = stack.reshape((*stack.shape[:-1], *names.shape))
        result[field] = xp.asarray(~xp.isfinite(whole).all(axis=-1)) if field == "singular" else whole
    return result


def part_names(field: str, size: int) -> NDArray[np.str_]:
    """The names of the scalar outputs that make up a field, in the shape of its last axes."""
    if field.endswith("gradient") or field == "singular":
        return np.array([f"{field.replace('singular', 'gradient')}_{i}" for i in range(size)])
    if field == "hessian":
        return np.array([[f"hessian_{min(i, j)}_{max(i, j)}" for j in range(size)] for i in range(size)])
    if field == "principal_curvatures":
        return np.array([f"{field}_{k}" for k in range(2)])
    if field == "principal_directions":
        return np.array([[f"{field}_{k}_{i}" for i in range(3)] for k in range(2)])
    return np.array(field)


def checked_fields(fields: Sequence[str]) -> tuple[str, ...]:
    """The fields as a tuple of known names; one name alone is accepted too."""
    if not isinstance(fields, Iterable):
        raise RsymError(
            f"fields are names, got {fields!r}", code="unknown-field", remedy='for example ("value", "gradient")'
        )
    names = (fields,) if isinstance(fields, str) else tuple(fields)
    unknown = [name for name in names if name not in FIELDS]
    if unknown and str(unknown[0]).startswith("normalised"):
        raise RsymError(
            f"no field {unknown[0]!r}: {_instead(str(unknown[0]))}",
            code="unknown-field",
            remedy=f"choose from {', '.join(name for name in FIELDS if name.startswith('normalised'))}",
        )
    if unknown or not names:
        raise RsymError(
            f"no field {unknown[0]!r}" if unknown else "no field was asked for",
            code="unknown-field",
            remedy=proposal(unknown[0] if unknown else "", FIELDS, f"choose from {', '.join(FIELDS)}"),
        )
    return tuple(dict.fromkeys(names))


def _instead(field: str) -> str:
    """What is meant by a field of omega normalised that there is none of."""
    order, _, rest = parsed(field)
    known = rest if rest in FIELDS else "value"
    if order == 0:
        return f"order 0 is `{known}`" if field.startswith("normalised_0") else "no such field is derived from omega_1"
    if order == 1:
        return f"order 1 is `{f'normalised_{known}'.removesuffix('_value')}`"
    if order > HIGHEST:
        return "orders 2 and 3 are derived in the program; a higher one is `compile(normalise(shape, order))`"
    return f"no such field is derived from omega_{order}"


def program_of(
    shape: Shape,
    fields: Sequence[str],
    *,
    of: str = "value",
    share: Fraction | None = FLOAT64.rounding,
    one_sided: bool = False,
) -> Program:
    """The program that computes the fields of a shape, or of the scalar field `of` of the shape.

    Where a derivative does not exist it is NaN; without a `share` that tells a jump from rounding it is that of one
    side on the border of a choice. Gradients that are `one_sided` are that at corners too.
    """
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))
    calculus = (OneSided if one_sided else Calculus)(builder, lower(builder, shape.expression))
    if of != "value":
        calculus = Calculus(builder, calculus.nodes(of))
    return fields_program(calculus, fields, share)


def fields_program(calculus: Calculus, fields: Sequence[str], share: Fraction | None = None) -> Program:
    """The program that computes the fields of one node; `share` as in `program_of`."""
    found = {field: outputs_of(calculus, field) for field in checked_fields(fields)}
    if share is not None:
        existence = Existence(Calculus(calculus.builder, calculus.value), share)
        for field, parts in found.items():
            if isinstance(calculus, OneSided) and field in ONE_SIDED:
                continue
            found[field] = {name: existence.kept(field, node) for name, node in parts.items()}
    return calculus.builder.program({name: node for parts in found.values() for name, node in parts.items()})


class Jumps:
    """Where the two sides of a switch differ: at such a point a derivative does not exist.

    A program differentiates each branch of a choice on its own, which is right wherever no choice is on its border.
    At a point of a border let a node have the values v_s on the sides s, each side a formula that is smooth there.
    Here every node u gets a companion J(u), also a node of the program, with

        |v_s - v| <= J(u) on all sides s, v the value that the program computes,

    and J(u) = 0 where no choice below u is on its border. If J(f) = 0 and J(D) = 0 for the formula D = df/dx, then
    all f_s(p + h) = f(p) + h D + o(h), whichever side p + h lies on: df/dx exists and is D. Where J(f) > 0 the
    function jumps, where J(D) > 0 it has a kink. The argument repeats for D in the place of f, to any order.

    J follows from bounds of the slopes of the operations: what is bounded times what vanishes has no jump, so
    x**2 sign(x) has the gradient 0 at 0, and no second derivative. Companions are made when they are asked for: the
    constant 0 where no choice matters.

    Examples
    --------
    >>> builder = Builder(("x",), ())
    >>> x, zero = builder.input("x"), builder.const(0)
    >>> positive = builder.select(x, zero, x, zero)
    >>> jumps = Jumps(builder)
    >>> builder.value(jumps[x]), builder.value(jumps[positive])
    (Fraction(0, 1), None)
    """

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self._known: dict[int, int] = {}

    def __getitem__(self, number: int) -> int:
        b = self.builder
        zero = b.const(0)
        for part in live(b.nodes, [number]):
            if part not in self._known:
                node = b.nodes[part]
                inner = [self._known[argument] for argument in node.arguments]
                smooth = node.operation not in TORN and all(jump == zero for jump in inner)
                self._known[part] = zero if smooth or b.uniform[part] else self._companion(part, node, inner)
        return self._known[number]

    def _companion(self, number: int, node: Node, inner: Sequence[int]) -> int:
        if node.operation in {"sin", "cos"}:
            return self._without_turns(node.arguments[0], Fraction(1))
        return (OPERATIONS[node.operation].jump or unbounded)(self.builder, number, node, inner)

    def _without_turns(self, number: int, factor: Fraction) -> int:
        """J of an angle of which whole turns do not count: the cut of atan2, times a whole number, is none."""
        b = self.builder
        operation, arguments, _ = b.nodes[number]
        if operation == "neg":
            return self._without_turns(arguments[0], factor)
        if operation == "add":
            return b.add(*(self._without_turns(argument, factor) for argument in arguments))
        value = b.value(arguments[0]) if operation == "mul" else None
        if value is not None:
            return b.mul(b.const(abs(value)), self._without_turns(arguments[1], factor * value))
        if operation == "atan2" and factor.denominator == 1:
            return bearing(b, number, b.nodes[number], [self[argument] for argument in arguments])
        return self[number]

    def borders(self, number: int) -> int:
        """A node that is positive where a choice below a node is on its border, else 0."""
        b = self.builder
        total = b.const(0)
        for part in live(b.nodes, [number]):
            operation, arguments, _ = b.nodes[part]
            if operation in TORN and self[part] != b.const(0):
                apart = b.sub(*arguments[:2]) if operation == "select" else arguments[0]
                apart = b.sub(apart, part) if operation == "floor" else apart
                total = b.add(total, b.select(b.abs(apart), b.const(0), b.const(0), b.const(1)))
        return total


def doubt(b: Builder, jump: int, size: int, share: Fraction) -> int:
    """1 where a jump is more than this share of the size, or unknown, else 0: what is less is rounding."""
    zero, one = b.const(0), b.const(1)
    if jump == zero:
        return zero
    unknown = b.select(jump, b.const(-1), zero, one)
    return b.select(b.mul(b.const(share), size), jump, zero, b.select(jump, zero, one, unknown))


def unless(b: Builder, doubts: int, value: int) -> int:
    """The value, or NaN where there is a doubt."""
    return value if b.value(doubts) == 0 else b.select(doubts, b.const(0), b.undefined(), value)
