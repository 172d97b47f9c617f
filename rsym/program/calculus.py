"""What calculus makes of one scalar node, and the table of its scalar fields: a row each.

To add a scalar field, write its row: kernels, level lines, pictures with their titles, refusals and docstrings read it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any, NamedTuple

from rsym.errors import RsymError
from rsym.program import differentiation
from rsym.program.builder import HALF, Builder
from rsym.program.differentiation import derivative, dot, gradient_of_one_side, unless_equal
from rsym.program.normalisation import next_order

Vector = Sequence[int]


@dataclass(frozen=True)
class Curvatures:
    """Curvatures of the level sets of one node, positive where the inside is convex, from its gradient and Hessian.

    Everything is written with the unit vector of the gradient and with tangent
    vectors, so that no power of the gradient overflows, and the principal values
    differ by twice the root of a sum of squares, so that an umbilic is no special case.
    Source: Goldman, Curvature formulas for implicit curves and surfaces, CAGD 22 (2005) 632-658.
    """

    builder: Builder
    gradient: Vector
    hessian: Sequence[Vector]

    @cached_property
    def slope(self) -> int:
        """|grad|."""
        return self.builder.sqrt(dot(self.builder, self.gradient, self.gradient))

    @cached_property
    def normal(self) -> list[int]:
        """The unit vector of the gradient, which points inwards.

        Each component is one operation of component and rest, whose image over a box is exact: bounds of curvatures
        are half as wide as with quotients by |grad|.
        """
        b, result = self.builder, []
        for k, component in enumerate(self.gradient):
            rest = reduce(b.add, [b.square(other) for j, other in enumerate(self.gradient) if j != k])
            result.append(component if b.value(component) == 0 else b.normalised(component, rest))
        return result

    @cached_property
    def plane(self) -> int:
        """-t^T Hs t/|grad| with the unit tangent t, the curvature of a level line."""
        self._require(2, "curvature")
        x, y = self.normal
        tangent = [self.builder.neg(y), x]
        return self._bent(tangent, tangent)

    @cached_property
    def mean(self) -> int:
        """(n^T Hs n - tr Hs)/(2 |grad|) with the unit normal n."""
        self._require(3, "mean_curvature")
        b = self.builder
        trace = reduce(b.add, [self.hessian[k][k] for k in range(3)])
        return b.div(b.mul(b.const(HALF), b.sub(self._form(self.normal, self.normal), trace)), self.slope)

    @cached_property
    def gaussian(self) -> int:
        """n^T adj(Hs) n/|grad|**2 with the unit normal n."""
        self._require(3, "gaussian_curvature")
        b = self.builder
        rows = [[self._cofactor(i, j) for j in range(3)] for i in range(3)]
        form = dot(b, self.normal, [dot(b, row, self.normal) for row in rows])
        return b.div(b.div(form, self.slope), self.slope)

    @cached_property
    def principal(self) -> tuple[int, int]:
        """The larger and the smaller principal curvature: m + r and m - r, m the mean, r the root of `_deviator`."""
        self._require(3, "principal_curvatures")
        b, (u, v) = self.builder, self._frame
        middle = b.mul(b.const(HALF), b.add(self._bent(u, u), self._bent(v, v)))
        _, _, scale, root = self._deviator
        radius = b.mul(scale, root)
        return b.add(middle, radius), b.sub(middle, radius)

    @cached_property
    def directions(self) -> tuple[list[int], list[int]]:
        """Unit tangent vectors of the larger and the smaller principal curvature; at an umbilic any such pair.

        (root + d, s) and (s, root - d) are both eigenvectors of [[d, s], [s, -d]]; the one without cancellation is
        taken, and (1, 0) where both vanish.
        """
        self._require(3, "principal_directions")
        b, (u, v) = self.builder, self._frame
        d, s, _, root = self._deviator
        large = self._or_one(b.add(root, b.abs(d)))
        length = b.sqrt(b.add(b.square(large), b.square(s)))
        along, across = b.div(large, length), b.div(s, length)
        zero = b.const(0)
        first, second = b.select(zero, d, across, along), b.select(zero, d, along, across)
        return (
            [b.add(b.mul(first, p), b.mul(second, q)) for p, q in zip(u, v, strict=True)],
            [b.sub(b.mul(first, q), b.mul(second, p)) for p, q in zip(u, v, strict=True)],
        )

    @cached_property
    def _frame(self) -> tuple[list[int], list[int]]:
        """Two unit tangent vectors, orthogonal to rounding for every normal (Duff et al., JCGT 6 (2017) 1)."""
        b, z = self.builder, self.normal[2]
        one = b.const(1)
        return self._frame_on(b.select(b.const(0), z, b.neg(one), one))

    def _frame_on(self, sign: int) -> tuple[list[int], list[int]]:
        b, (x, y, z) = self.builder, self.normal
        one = b.const(1)
        a = b.div(b.const(-1), b.add(sign, z))
        product = b.mul(b.mul(x, y), a)
        return (
            [b.add(one, b.mul(sign, b.mul(b.square(x), a))), b.mul(sign, product), b.neg(b.mul(sign, x))],
            [product, b.add(sign, b.mul(b.square(y), a)), b.neg(y)],
        )

    @cached_property
    def _deviator(self) -> tuple[int, int, int, int]:
        """d, s, scale and the root of d**2 + s**2, where scale [[d, s], [s, -d]] is the shape operator less its mean.

        The larger of |d| and |s| is 1, so that their squares neither overflow nor vanish; at an umbilic all are 0.
        """
        b, (u, v) = self.builder, self._frame
        difference = b.mul(b.const(HALF), b.sub(self._bent(u, u), self._bent(v, v)))
        shear = self._bent(u, v)
        scale = b.make("max", b.abs(difference), b.abs(shear))
        d, s = (b.div(part, self._or_one(scale)) for part in (difference, shear))
        return d, s, scale, b.sqrt(b.add(b.square(d), b.square(s)))

    def operator(self, side: int) -> tuple[int, int, int]:
        """The shape operator (uu, uv, vv) in a frame that is smooth unless the normal is (0, 0, -side); side: 1, -1."""
        self._require(3, "principal_curvatures")
        u, v = self._frame_on(side)
        return self._bent(u, u), self._bent(u, v), self._bent(v, v)

    def _or_one(self, size: int) -> int:
        """A size, 1 where it is 0; NaN stays NaN."""
        b = self.builder
        return b.select(size, b.const(0), size, b.add(b.const(1), size))

    def _bent(self, u: Vector, v: Vector) -> int:
        """The shape operator between two unit tangent vectors."""
        return self.builder.neg(self.builder.div(self._form(u, v), self.slope))

    def _form(self, u: Vector, v: Vector) -> int:
        return dot(self.builder, u, [dot(self.builder, row, v) for row in self.hessian])

    def _cofactor(self, i: int, j: int) -> int:
        b, h = self.builder, self.hessian
        (p, q), (r, s) = ([k for k in range(3) if k != skipped] for skipped in (i, j))
        minor = b.sub(b.mul(h[p][r], h[q][s]), b.mul(h[p][s], h[q][r]))
        return minor if (i + j) % 2 == 0 else b.neg(minor)

    def _require(self, dimension: int, field: str) -> None:
        names, space = self.builder.coordinates, "mean_curvature, gaussian_curvature or principal_curvatures"
        if len(names) != dimension:
            raise RsymError(
                f"{field} needs {dimension} coordinates, the shape has {', '.join(names)}",
                code="dimension",
                remedy=f"in space choose {space}" if dimension == 2 else "in the plane choose curvature",
            )


# Order 4 of an ellipse would take half a million operations: far more than compiling is worth.
HIGHEST = 3
FORMS: tuple[str, ...] = tuple(
    f"normalised_{order}{kept}" for order in range(2, HIGHEST + 1) for kept in ("", "_keep_sign")
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
        order, keep_sign, rest = parsed(field)
        calculus = self.normalised_to(order, keep_sign=keep_sign)
        row = ROWS.get(rest)
        found = row.of(calculus) if row else getattr(calculus, "gradient" if rest == "singular" else rest)
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


class ScalarField(NamedTuple):
    """A scalar field: its name, its node, the order of the highest derivative in it, its title, and what it is.

    normalised: whether it is a field of omega normalised too, as `normalised_laplacian` is.
    """

    name: str
    of: Callable[[Calculus], int]
    order: int
    title: str
    says: str = ""
    normalised: bool = False


ROWS: dict[str, ScalarField] = {
    row.name: row
    for row in (
        ScalarField("value", lambda one: one.value, 0, r"$\omega$", normalised=True),
        ScalarField("gradient_squared", lambda one: one.gradient_squared, 1, r"$(\nabla\omega)^2$", normalised=True),
        ScalarField("laplacian", lambda one: one.laplacian, 2, r"$\Delta\omega$", normalised=True),
        ScalarField("curvature", lambda one: one.curvature, 2, r"curvature $\kappa$", "of level lines in the plane"),
        ScalarField("mean_curvature", lambda one: one.mean_curvature, 2, "mean curvature $H$", "in space"),
        ScalarField("gaussian_curvature", lambda one: one.gaussian_curvature, 2, "Gaussian curvature $K$", "in space"),
    )
}


def of_form(form: str, name: str) -> str:
    """The name of a field of omega normalised: that of its value is the form alone."""
    return form if name == "value" else f"{form}_{name}"


_BOTH, _ALONE = ([name for name, row in ROWS.items() if row.normalised is both] for both in (True, False))
SCALARS: tuple[str, ...] = (
    *(field for name in _BOTH for field in (name, of_form("normalised", name))),
    *_ALONE,
    *(of_form(form, name) for form in FORMS for name in _BOTH),
)
# For docstrings: the fields of omega, those of omega normalised, and the others with what they are.
LISTED = {
    "plain": ", ".join(["value", "gradient", "hessian", *_BOTH[1:], "singular"]),
    "normalised": ", ".join(
        ["normalised", "normalised_gradient", *(of_form("normalised", name) for name in _BOTH[1:])]
    ),
    "others": ", ".join(f"``{name}`` {ROWS[name].says}" for name in _ALONE),
}


def title_of(field: str) -> str:
    r"""The title of a scalar field in pictures.

    Examples
    --------
    >>> print(title_of("laplacian"), title_of("normalised"), title_of("normalised_2_laplacian"))
    $\Delta\omega$ $\omega_n$ $\Delta\omega_{n,2}$
    >>> print(title_of("normalised_3_keep_sign"))
    $\omega_{n,3}^\pm$
    """
    order, keep_sign, rest = parsed(field)
    letter = [r"\omega", r"\omega_n"][order] if order < 2 else rf"\omega_{{n,{order}}}"
    return ROWS[rest].title.replace(r"\omega", letter + r"^\pm" * keep_sign)


def parsed(field: str) -> tuple[int, bool, str]:
    """The order of normalisation, whether the sign is kept, and the field of that function.

    Examples
    --------
    >>> [parsed(field) for field in ("laplacian", "normalised", "normalised_gradient", "normalised_3_keep_sign")]
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
    order, _, rest = parsed(field)
    return order + (ROWS[rest].order if rest in ROWS else {"gradient": 1, "singular": 1}.get(rest, 2))
