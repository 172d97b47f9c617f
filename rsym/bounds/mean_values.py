"""The mean-value form: tighter images of nodes in which a coordinate repeats.

An image takes what stands twice for two things, so over a box of width h it is
too wide by a share of h. With v the coordinates that repeat, w the others and c
the middle of the side of v, the mean-value theorem along v gives

    f(v, w) in f(c, W) + sum_i df/dv_i(V, W) (V_i - c_i)

which is too wide by a share of h**2 only; the part without v keeps its exact
image. Both are true, so their intersection is.

Why it holds to the last bit: c is any float64 of the side (it is clamped into
it), taken as an interval of one point, and every operation on it is one of the
outward images, so each step encloses what it stands for whatever c is. Where
the theorem fails there is no bound: an end that is NaN, as from a derivative
without one or an infinite side, leaves the other image alone.

The theorem needs f to be Lipschitz in v along the side, with derivatives almost
everywhere inside the images of the rules: true of the operations in SMOOTH, whose
kinks have both slopes in the image and whose poles and ends of domain put a
division by an interval with 0 into the derivative. It is not true of jumps
(sign, select, atan2), so what holds one is left as it is; but an atan2 whose
first operand is never negative touches its cut from one side, and jumps in its
pole alone: boxes that may hold that are left.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rsym.bounds.box_images import BoxImages
from rsym.bounds.cancellations import cancelled
from rsym.bounds.interval_arithmetic import Interval, greatest, least, negative, product, sizes, total
from rsym.bounds.relations import relation
from rsym.program.builder import HALF, Builder
from rsym.program.differentiation import derivative
from rsym.program.operations import SMOOTH
from rsym.program.program import Node, live


def repeated(nodes: Sequence[Node], number: int, coordinates: Sequence[str]) -> tuple[str, ...]:
    """The coordinates that a node uses more than once, each square of one function counting once.

    Examples
    --------
    >>> builder = Builder(("x", "y"), ())
    >>> x, y = builder.input("x"), builder.input("y")
    >>> repeated(builder.nodes, builder.add(builder.square(x), builder.mul(x, y)), ("x", "y"))
    ('x',)
    """
    uses: dict[int, list[int]] = {}
    for k in live(nodes, [number]):
        operation, arguments, data = nodes[k]
        named, related = relation(nodes, k) or (operation, arguments)
        parts = [uses[argument] for argument in (related if named in {"square", "direction"} else arguments)]
        own = [int(operation == "input" and data == name) for name in coordinates]
        # More than two uses are no worse than two: the numbers stay small in a nest of five hundred.
        uses[k] = [min(2, sum(column)) for column in zip(own, *parts, strict=True)]
    return tuple(name for name, count in zip(coordinates, uses[number], strict=True) if count > 1)


def sharpen(images: BoxImages, numbers: Iterable[int]) -> None:
    """Intersect the images of these nodes with their mean-value form, where it can be tighter."""
    b = images.source
    for number in sorted(numbers):
        names, poles = repeated(b.nodes, number, b.coordinates), _poles(b, number)
        if names and poles is not None:
            # An angle is steep: first what it is made of.
            inner = {_within_abs(b, operand) for pole in poles for operand in pole}
            sharpen(images, inner - images.images.keys())
            image = _mean_value(images, number, names)
            for pole in poles:
                image = _off(images, pole, image)
            images.images[number] = _intersection(images.target, images[number], image)


def narrowed(images: BoxImages, number: int) -> Interval:
    """The image of a node; where terms of a slope cancel, without what they have in common."""
    other = cancelled(images.source, number)
    return images[number] if other is None else _intersection(images.target, images[other], images[number])


def _poles(b: Builder, number: int) -> Sequence[Sequence[int]] | None:
    """The operands of each atan2 in a node, the first of them not negative; None where it has other jumps."""
    nodes = [b.nodes[k] for k in live(b.nodes, [number]) if b.nodes[k].operation not in SMOOTH]
    known = all(node.operation == "atan2" and b.nonnegative[node.arguments[0]] for node in nodes)
    return [node.arguments for node in nodes] if known else None


def _within_abs(b: Builder, number: int) -> int:
    operation, arguments, _ = b.nodes[number]
    return arguments[0] if operation == "abs" else number


def _off(box: BoxImages, pole: Sequence[int], image: Interval) -> Interval:
    """The image where one of the two operands of an atan2, the first not negative, is 0 nowhere; else NaN."""
    b, (u, v) = box.target, (box[operand] for operand in pole)
    far = greatest(b, u.lower, sizes(b, v).lower)
    lower, upper = (b.select(far, b.const(0), end, b.undefined()) for end in (image.lower, image.upper))
    return Interval(lower, upper)


def _mean_value(box: BoxImages, number: int, names: Sequence[str]) -> Interval:
    middles = {name: _middle(box.target, box.side(name)) for name in names}
    centre = BoxImages(
        box.source, box.target, {**box.sides, **{v: Interval(c, c) for v, c in middles.items()}}, box.strict
    )
    image = centre[number]
    for name, c in middles.items():
        slope = narrowed(box, derivative(box.source, number, name))
        image = total(box.target, image, product(box.target, slope, _offset(box.target, box.side(name), c)))
    return image


def _middle(b: Builder, side: Interval) -> int:
    """A point of the side; the halves are added, for a sum may overflow."""
    half = b.const(HALF)
    return least(b, greatest(b, b.add(b.mul(half, side.lower), b.mul(half, side.upper)), side.lower), side.upper)


def _offset(b: Builder, side: Interval, c: int) -> Interval:
    return total(b, Interval(side.lower, side.upper), negative(b, Interval(c, c)))


def _intersection(b: Builder, u: Interval, v: Interval) -> Interval:
    """The part of u inside v; an end of v that is NaN says nothing."""
    lower = b.select(v.lower, u.lower, v.lower, u.lower)
    return Interval(lower, b.select(u.upper, v.upper, v.upper, u.upper), u.nonnegative)
