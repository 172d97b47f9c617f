"""Fields: the functions that are derived from omega, as nodes of one program."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property, reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.wording import proposal
from rsym.program import differentiation
from rsym.program.builder import Builder
from rsym.program.curvatures import Curvatures
from rsym.program.differentiation import derivative, dot
from rsym.program.jumps import Jumps, doubt, unless
from rsym.program.lowering import lower
from rsym.program.normalisation import next_order
from rsym.program.one_sided import gradient_of_one_side, unless_equal
from rsym.program.precision import FLOAT64
from rsym.program.program import Program

SIX: tuple[str, ...] = (
    "value",
    "normalised",
    "gradient_squared",
    "normalised_gradient_squared",
    "laplacian",
    "normalised_laplacian",
)
CURVATURES: tuple[str, ...] = ("curvature", "mean_curvature", "gaussian_curvature")
# Order 4 of an ellipse would take half a million operations: far more than compiling is worth.
HIGHEST = 3
FORMS: tuple[str, ...] = tuple(
    f"normalised_{order}{kept}" for order in range(2, HIGHEST + 1) for kept in ("", "_keep_sign")
)
NORMALISED: tuple[str, ...] = tuple(
    f"{form}{suffix}" for form in FORMS for suffix in ("", "_gradient_squared", "_laplacian")
)
SCALARS: tuple[str, ...] = (*SIX, *CURVATURES, *NORMALISED)
FIELDS: tuple[str, ...] = (
    *SCALARS,
    *(f"{form}_gradient" for form in ("normalised", *FORMS)),
    "gradient",
    "hessian",
    "singular",
    "principal_curvatures",
    "principal_directions",
)
# Of these there are those of one side at corners.
ONE_SIDED = frozenset(
    f"{form}{field}" for form in ("", "normalised_") for field in ("gradient", "gradient_squared")
) | {"singular"}


class Calculus:
    """What calculus makes of one scalar node; nothing is built before it is asked for."""

    def __init__(self, builder: Builder, value: int) -> None:
        self.builder = builder
        self.value = value

    @cached_property
    def gradient(self) -> list[int]:
        """The first derivatives with respect to the coordinates."""
        return differentiation.gradient(self.builder, self.value)

    @cached_property
    def gradient_squared(self) -> int:
        """|grad|**2."""
        return dot(self.builder, self.gradient, self.gradient)

    @cached_property
    def laplacian(self) -> int:
        """The sum of the unmixed second derivatives."""
        return self._divergence(self.gradient)

    def _divergence(self, vector: Sequence[int]) -> int:
        b = self.builder
        total = b.const(0)
        for component, name in zip(vector, b.coordinates, strict=True):
            total = b.add(total, derivative(b, component, name))
        return total

    def second(self, i: int, j: int) -> int:
        """The second derivative with respect to coordinates i and j."""
        low, high = sorted((i, j))
        return derivative(self.builder, self.gradient[low], self.builder.coordinates[high])

    @cached_property
    def normalised(self) -> Calculus:
        """omega/sqrt(omega**2 + |grad omega|**2)."""
        return Calculus(self.builder, self.builder.normalised(self.value, self.gradient_squared))

    def normalised_to(self, order: int, *, keep_sign: bool = False) -> Calculus:
        """omega_m of `rsym.normalise` with L = 1; omega itself for the order 0."""
        lower = self.normalised if order else self
        for step in range(2, order + 1):
            lower = Calculus(self.builder, next_order(self.builder, lower.value, step, keep_sign=keep_sign))
        return lower

    @cached_property
    def hessian(self) -> list[list[int]]:
        """The rows of second derivatives."""
        size = len(self.builder.coordinates)
        return [[self.second(i, j) for j in range(size)] for i in range(size)]

    @cached_property
    def curvatures(self) -> Curvatures:
        """Curvatures of the level sets."""
        return Curvatures(self.builder, self.gradient, self.hessian)

    @property
    def curvature(self) -> int:
        """The curvature of the level lines in the plane, positive where the inside is convex."""
        return self.curvatures.plane

    @property
    def mean_curvature(self) -> int:
        """The mean of the principal curvatures of the level surfaces."""
        return self.curvatures.mean

    @property
    def gaussian_curvature(self) -> int:
        """The product of the principal curvatures of the level surfaces."""
        return self.curvatures.gaussian

    @property
    def principal_curvatures(self) -> tuple[int, int]:
        """The principal curvatures of the level surfaces, the larger first."""
        return self.curvatures.principal

    @property
    def principal_directions(self) -> tuple[list[int], list[int]]:
        """Their directions."""
        return self.curvatures.directions

    def derivatives(self, order: int) -> list[int]:
        """The value, the gradient, or the different second derivatives."""
        size = range(len(self.builder.coordinates))
        second = [(i, j) for i in size for j in size if i <= j] if order == 2 else []
        return [[self.value], self.gradient][order] if order < 2 else [self.second(i, j) for i, j in second]

    def nodes(self, field: str) -> Any:
        """The node of a scalar field, or the nodes of another, nested as its axes are."""
        order, keep_sign, rest = _parsed(field)
        calculus = self.normalised_to(order, keep_sign=keep_sign)
        found = getattr(calculus, "gradient" if rest == "singular" else rest)
        # It goes to 0 where omega does, at corners too, where derivatives do not exist.
        return self.builder.zero_with(self.value, found) if order and rest == "value" else found


class OneSided(Calculus):
    """Calculus whose gradients are those of one side at corners, of omega and of omega_1; other fields are as ever."""

    @cached_property
    def gradient(self) -> list[int]:
        """The first derivatives with respect to the coordinates."""
        return gradient_of_one_side(self.builder, self.value)

    @cached_property
    def two_sided(self) -> Calculus:
        """What is made of second derivatives, which no side of a corner has."""
        return Calculus(self.builder, self.value)

    @cached_property
    def normalised(self) -> Calculus:
        """Omega_1, whose gradient where omega is 0 is that of omega, of length 1."""
        b = self.builder
        size, length = b.abs(self.value), b.sqrt(self.gradient_squared)
        slopes = self.two_sided.normalised.gradient
        found = Calculus(b, self.two_sided.normalised.value)
        found.gradient = [
            unless_equal(b, size, slope, b.div(own, length)) for slope, own in zip(slopes, self.gradient, strict=True)
        ]
        return found

    def nodes(self, field: str) -> Any:
        """The node of a scalar field, or the nodes of another, nested as its axes are."""
        return super().nodes(field) if field in ONE_SIDED else self.two_sided.nodes(field)


def outputs_of(calculus: Calculus, field: str) -> dict[str, int]:
    """The scalar outputs that make up a field."""
    names = _part_names(field, len(calculus.builder.coordinates))
    return dict(zip(names.flat, np.asarray(calculus.nodes(field)).flat, strict=True))


def _parsed(field: str) -> tuple[int, bool, str]:
    """The order of normalisation, whether the sign is kept, and the field of that function.

    Examples
    --------
    >>> [_parsed(field) for field in ("laplacian", "normalised", "normalised_gradient", "normalised_3_keep_sign")]
    [(0, False, 'laplacian'), (1, False, 'value'), (1, False, 'gradient'), (3, True, 'value')]
    """
    found = re.fullmatch(r"normalised(?:_(\d+))?(_keep_sign)?(?:_(.+))?", field)
    if found is None:
        return 0, False, field
    order, kept, rest = found.groups()
    return int(order or 1), kept is not None, rest or "value"


def order_of(field: str) -> int:
    """The order of the highest derivative that a field is made of.

    Examples
    --------
    >>> [order_of(field) for field in ("value", "normalised", "hessian", "normalised_laplacian", "normalised_3")]
    [0, 1, 2, 3, 3]
    """
    order, _, rest = _parsed(field)
    return order + {"value": 0, "gradient": 1, "gradient_squared": 1, "singular": 1}.get(rest, 2)


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
        if _parsed(field)[2] != "value":
            return unless(b, doubts, node)
        # What is normalised is 0 with omega, whatever becomes of its derivatives.
        zero = unless(b, self.doubts(1), node)
        return b.select(b.abs(self.calculus.value), b.const(0), unless(b, doubts, node), zero)


def gather(parts: Mapping[str, NDArray[Any]], fields: Sequence[str], size: int) -> dict[str, NDArray[Any]]:
    """The fields from their scalar parts: gradient (..., dim), hessian (..., dim, dim), singular boolean and so on."""
    result: dict[str, NDArray[Any]] = {}
    for field in fields:
        if field in SCALARS:
            result[field] = parts[field]
            continue
        names = _part_names(field, size)
        stack = np.stack([parts[name] for name in names.flat], axis=-1)
        whole = stack.reshape((*stack.shape[:-1], *names.shape))
        result[field] = np.asarray(~np.isfinite(whole).all(axis=-1)) if field == "singular" else whole
    return result


def _part_names(field: str, size: int) -> NDArray[np.str_]:
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
    order, _, rest = _parsed(field)
    known = rest if rest in FIELDS else "value"
    if order == 0:
        return f"order 0 is `{known}`" if field.startswith("normalised_0") else "no such field is derived from omega_1"
    if order == 1:
        return f"order 1 is `{f'normalised_{known}'.removesuffix('_value')}`"
    if order > HIGHEST:
        return "orders 2 and 3 are derived in the program; a higher one is `compile(normalise(shape, order))`"
    return f"no such field is derived from omega_{order}"


def surface_program(shape: Shape, fields: Sequence[str]) -> Program:
    """The program of a function with the same zero set and signs: constant factors drop, omega_n goes back to omega.

    Where derivatives of omega do not exist a normalised value need not exist; omega does.
    """
    builder = _builder_for(shape)
    node, sign = lower(builder, shape.expression), 1
    while True:
        operation, arguments, _ = builder.nodes[node]
        factor = builder.value(arguments[0]) if operation == "mul" else None
        if operation == "zero_with":
            node = arguments[1]
        elif operation in {"neg", "normalised"}:
            node, sign = arguments[0], -sign if operation == "neg" else sign
        elif factor:
            node, sign = arguments[1], sign if factor > 0 else -sign
        else:
            break
    return fields_program(Calculus(builder, node if sign > 0 else builder.neg(node)), fields)


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
    builder = _builder_for(shape)
    calculus = (OneSided if one_sided else Calculus)(builder, lower(builder, shape.expression))
    if of != "value":
        calculus = Calculus(builder, calculus.nodes(of))
    return fields_program(calculus, fields, share)


def _builder_for(shape: Shape) -> Builder:
    return Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))


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
