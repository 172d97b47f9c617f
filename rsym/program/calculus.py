"""What calculus makes of one scalar node, and the table of its scalar fields: a row each.

To add a scalar field, write its row: kernels, level lines, pictures with their titles, refusals and docstrings read it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from rsym.program import differentiation
from rsym.program.builder import Builder
from rsym.program.curvatures import Curvatures
from rsym.program.differentiation import derivative, dot
from rsym.program.normalisation import next_order
from rsym.program.one_sided import gradient_of_one_side, unless_equal

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
