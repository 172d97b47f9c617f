"""How slopes and gradients pass through an operation at a point: one rule for each way of being not smooth.

A rule takes the slopes of its arguments in some directions d to its own slope; and, from their gradients at the
points p + r d, r -> 0, to its own: a box of all limits (of the generalised gradient, where there is a kink).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from rsym.bounds.ball_arithmetic import size
from rsym.bounds.balls import IMAGES, arb, root, square
from rsym.program.differentiation import RULES
from rsym.verify.boxes.local import Local

Vector: TypeAlias = tuple[arb, ...]


def _combined(factors: Sequence[arb], gradients: Sequence[Vector]) -> Vector:
    scaled = ([factor * part for part in gradient] for factor, gradient in zip(factors, gradients, strict=True))
    return tuple(sum(parts, arb(0)) for parts in zip(*scaled, strict=True))


def _either(a: Vector, b: Vector) -> Vector:
    return tuple(first.union(second) for first, second in zip(a, b, strict=True))


@dataclass(frozen=True)
class Linear:
    """A C^1 operation: the chain rule with its partial derivatives near the point."""

    arguments: tuple[int, ...]
    factors: tuple[arb, ...]

    def slope(self, *slopes: arb) -> arb | None:
        """The sum of the factors times the slopes."""
        total = arb(0)
        for factor, slope in zip(self.factors, slopes, strict=True):
            total += factor * slope
        return total

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """The sum of the factors times the gradients."""
        return _combined(self.factors, gradients)


@dataclass(frozen=True)
class Size:
    """|u| where u is zero, also as trimming or a power; further arguments must be continuous, no more."""

    arguments: tuple[int, ...]

    def slope(self, *slopes: arb) -> arb | None:
        """The size of the first slope."""
        return size(slopes[0])

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """That of u or of -u."""
        own, slope = gradients[0], slopes[0]
        opposite = tuple(-part for part in own)
        if slope > 0:
            return own
        return opposite if slope < 0 else _either(own, opposite)


@dataclass(frozen=True)
class Tie:
    """The larger or the smaller of two arguments that are equal at the point."""

    arguments: tuple[int, ...]
    operation: str

    def slope(self, *slopes: arb) -> arb | None:
        """The larger or the smaller slope."""
        return IMAGES[self.operation](*slopes)

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """That of the argument that counts, or either."""
        first, second = slopes if self.operation == "max" else slopes[::-1]
        if first > second:
            return gradients[0]
        return gradients[1] if first < second else _either(*gradients)


@dataclass(frozen=True)
class Homogeneous:
    """An operation of degree 1 where its first two arguments vanish; its partial derivatives are of degree 0."""

    arguments: tuple[int, ...]
    local: Local
    part: int

    @property
    def _parameters(self) -> dict[int, arb | None]:
        return {number: self.local.value(number) for number in self.local.model.builder.nodes[self.part].arguments[2:]}

    def slope(self, *slopes: arb) -> arb | None:
        """The operation of the slopes."""
        image: Callable[..., arb | None] = IMAGES[self.local.model.builder.nodes[self.part].operation]
        return image(*slopes, *self._parameters.values())

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """The chain rule with the partial derivatives at the slopes, to which the arguments over r tend."""
        builder = self.local.model.builder
        node = builder.nodes[self.part]
        factors = []
        for place in range(2):
            unit = [builder.const(int(other == place)) for other in range(len(node.arguments))]
            partial = RULES[node.operation](builder, self.part, node, unit)
            known = {**dict(zip(node.arguments, slopes, strict=False)), **self._parameters}
            known[self.part] = self.slope(*slopes)
            self.local.model.enclose(partial, self.local.inputs, known)
            value = known[partial]
            if value is None or not value.is_finite():
                return None
            factors.append(value)
        return _combined(factors, gradients)


@dataclass(frozen=True)
class Length:
    """sqrt(sum of c u**2) where every u vanishes."""

    arguments: tuple[int, ...]
    factors: tuple[arb, ...]

    def slope(self, *slopes: arb) -> arb | None:
        """The same of the slopes."""
        total = arb(0)
        for factor, slope in zip(self.factors, slopes, strict=True):
            total += factor * square(slope)
        return root(total)

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """The sum of c u grad u, over the length."""
        length = self.slope(*slopes)
        if length is None or not length > 0:
            return None
        return _combined([c * u / length for c, u in zip(self.factors, slopes, strict=True)], gradients)


@dataclass(frozen=True)
class TrimmedEnd:
    """sqrt(f**2 + gap**2) at the end of a trimmed curve, f = t = 0: the distance from what is kept."""

    arguments: tuple[int, ...]

    def slope(self, *slopes: arb) -> arb | None:
        """sqrt(f'**2 + max(-t', 0)**2)."""
        f, t = slopes
        return root(square(f) + square((-t).max(arb(0))))

    def gradient(self, slopes: Sequence[arb], gradients: Sequence[Vector]) -> Vector | None:
        """(f grad f - gap (gap/q) grad t)/length, gap/q being 1 where t < 0 and 0 where t > 0."""
        f, t = slopes
        length = self.slope(f, t)
        if length is None or not length > 0:
            return None
        share = arb(0) if t > 0 else arb(1) if t < 0 else arb(0.5, 0.5)
        return _combined([f / length, -(-t).max(arb(0)) * share / length], gradients)


Rule: TypeAlias = Linear | Size | Tie | Homogeneous | Length | TrimmedEnd
