"""Curvatures of level sets as nodes of a program, positive where the inside is convex.

Everything is written with the unit vector of the gradient and with tangent
vectors, so that no power of the gradient overflows, and the principal values
differ by twice the root of a sum of squares, so that an umbilic is no special case.
Source: Goldman, Curvature formulas for implicit curves and surfaces, CAGD 22 (2005) 632-658.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

from rsym.errors import RsymError
from rsym.program.builder import HALF, Builder
from rsym.program.differentiation import dot

Vector = Sequence[int]


@dataclass(frozen=True)
class Curvatures:
    """Curvatures from the gradient and the rows of the Hessian of one scalar node."""

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
        self._require(2, "curvature", "in space choose mean_curvature, gaussian_curvature or principal_curvatures")
        x, y = self.normal
        tangent = [self.builder.neg(y), x]
        return self._bent(tangent, tangent)

    @cached_property
    def mean(self) -> int:
        """(n^T Hs n - tr Hs)/(2 |grad|) with the unit normal n."""
        self._require_space("mean_curvature")
        b = self.builder
        trace = reduce(b.add, [self.hessian[k][k] for k in range(3)])
        return b.div(b.mul(b.const(HALF), b.sub(self._form(self.normal, self.normal), trace)), self.slope)

    @cached_property
    def gaussian(self) -> int:
        """n^T adj(Hs) n/|grad|**2 with the unit normal n."""
        self._require_space("gaussian_curvature")
        b = self.builder
        rows = [[self._cofactor(i, j) for j in range(3)] for i in range(3)]
        form = dot(b, self.normal, [dot(b, row, self.normal) for row in rows])
        return b.div(b.div(form, self.slope), self.slope)

    @cached_property
    def principal(self) -> tuple[int, int]:
        """The larger and the smaller principal curvature: m + r and m - r, m the mean, r the root of `_deviator`."""
        self._require_space("principal_curvatures")
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
        self._require_space("principal_directions")
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
        self._require_space("principal_curvatures")
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

    def _require_space(self, field: str) -> None:
        self._require(3, field, "in the plane choose curvature")

    def _require(self, dimension: int, field: str, remedy: str) -> None:
        names = self.builder.coordinates
        if len(names) != dimension:
            raise RsymError(
                f"{field} needs {dimension} coordinates, the shape has {', '.join(names)}",
                code="dimension",
                remedy=remedy,
            )
