"""Shapes from shapes of another dimension; bodies grown, shrunk and hollowed out by the distance omega measures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, positive
from rsym.model.bounding import BoundingBox, without
from rsym.model.equation import moved_part, substituted
from rsym.model.letters import Letters
from rsym.model.named_parts import Inside
from rsym.model.parallels import Parallel, in_lengths, lengths
from rsym.model.primitives.formulas import ROOM, between
from rsym.model.requirements import require_shape
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import as_expression, real_symbol, substitute, symbols_of, x
from rsym.model.systems import R0, RSystem


def revolve(shape: Shape, axis: Any = x) -> Shape:
    """The body swept by a plane shape turning about one of its coordinate axes.

    About x: omega(x, sqrt(y**2 + z**2)). The substitution comes before any
    derivative, and sqrt(y**2 + z**2)**2 becomes y**2 + z**2, so a profile that
    is smooth in y**2 has a smooth body on the axis too.

    Parameters
    ----------
    shape : Shape
        A shape in the plane.
    axis : symbol
        The coordinate that stays.

    Raises
    ------
    RsymError
        For a shape in space, or an axis that is not one of its coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.revolve(rsym.Shape(1 - x**2 - y**2, (x, y))).expression
    -x**2 - y**2 - z**2 + 1
    """
    require_shape(shape)
    names = [symbol.name for symbol in shape.coordinates]
    if shape.dimension != 2 or str(axis) not in names:
        raise RsymError(
            f"revolve needs a plane shape and one of its coordinates as axis, got {names} and {axis}",
            code="revolve",
            remedy="revolve(shape, axis=x) with a shape in (x, y)",
        )
    third = _third(shape)
    turning = shape.coordinates[1 - names.index(str(axis))]
    radius = sp.sqrt(turning**2 + third**2)

    def swept(ends: Bounds) -> Bounds:
        reach = max(abs(end) for end in ends[1 - names.index(str(axis))])
        around, kept = (-reach, reach), ends[names.index(str(axis))]
        return (kept, around, around) if names.index(str(axis)) == 0 else (around, kept, around)

    box = shape.box and shape.box.mapped(swept)
    return substituted(shape, {turning: radius}, coordinates=(*shape.coordinates, third), box=box)


def extrude(shape: Shape, lower: Any, upper: Any, *, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The prism over a plane shape between two heights: omega(x, y) and (upper - z)(z - lower)/(upper - lower).

    Normalised to order 1 where the shape is; smoothness is lost on the rims.

    Raises
    ------
    RsymError
        For a shape in space, or heights that do not increase.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.extrude(rsym.Shape(1 - x**2 - y**2, (x, y)), 0, 2).expression
    conjunction(-x**2 - y**2 + 1, z*(2 - z)/2)
    """
    require_shape(shape)
    _plane(shape, "extrude")
    third, given = _third(shape), shape.letters.merge(letters)
    low, high = number(lower, "the lower end"), number(upper, "the upper end")
    slab = between(third, low, high, given, not system.keeps_sets)
    heights = (default(low, given), default(high, given))
    return _joined(shape, slab, (third,), system, letters, _with_heights(shape.box, heights))


def product(first: Shape, second: Any, *, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The Cartesian product omega_1(x, y) and omega_2(z): points whose (x, y) lies in one and whose z in the other.

    Parameters
    ----------
    first : Shape
        In the plane.
    second : expression
        In the third coordinate and letters, positive inside.

    Raises
    ------
    RsymError
        For a shape in space, or a factor with a coordinate of the first in it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> rsym.product(rsym.Shape(1 - x**2 - y**2, (x, y)), (4 - z**2) / 4).expression
    conjunction(-x**2 - y**2 + 1, 1 - z**2/4)
    """
    require_shape(first)
    _plane(first, "product")
    expression, third = as_expression(second), _third(first)
    overlap = {symbol.name for symbol in symbols_of(expression)} & {symbol.name for symbol in first.coordinates}
    if overlap:
        raise RsymError(
            f"the second factor of a product contains {min(overlap)}, a coordinate of the first",
            code="coordinates",
            remedy=f"write it in {third.name} and letters",
        )
    if not system.keeps_sets:
        expression = lengths(expression, (third,), first.letters.merge(letters))
    return _joined(first, expression, (third,), system, letters, None)


def section(shape: Shape, axis: Any, place: Any = 0, *, letters: LetterMapping = None) -> Shape:
    """The plane shape that a body cuts out of the plane where one coordinate has a value.

    Where the plane meets the boundary at an angle below 90 degrees, omega is not normalised any more.

    Parameters
    ----------
    axis : symbol
        The coordinate that is fixed.
    place : number or expression
        Its value; in letters and, for a slanted or bent cut, in the other coordinates.

    Raises
    ------
    RsymError
        For a shape in the plane, or something that is not one of its coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> rsym.section(rsym.Shape(4 - x**2 - y**2 - z**2, (x, y, z)), z, 1).expression
    -x**2 - y**2 + 3
    """
    require_shape(shape)
    names = [symbol.name for symbol in shape.coordinates]
    if shape.dimension != 3 or str(axis) not in names:
        raise RsymError(
            f"section needs a shape in space and one of its coordinates, got {names} and {axis}",
            code="section",
            remedy="section(shape, z, 1)",
        )
    gone = names.index(str(axis))
    coordinates = tuple(symbol for k, symbol in enumerate(shape.coordinates) if k != gone)
    box = shape.box and shape.box.mapped(lambda ends: tuple(pair for k, pair in enumerate(ends) if k != gone))
    places = {shape.coordinates[gone]: number(place, "the place")}
    return substituted(shape, places, coordinates=coordinates, letters=letters, box=box)


def sweep(
    profile: Shape,
    changes: Mapping[Any, Any] | Sequence[Any],
    lower: Any,
    upper: Any,
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """The body between two heights whose profile changes with the height: letters of it are functions of z.

    Where the profile changes the sides are inclined and omega is not normalised there; `implicit` normalises it.
    The bounds of the profile hold for its own letters, not for those that change: such a body has none of its own.

    Parameters
    ----------
    profile : Shape
        In the plane, with letters.
    changes : mapping or pairs
        {letter: expression in z and letters}.

    Raises
    ------
    RsymError
        For a shape in space, letters it has not, or heights that do not increase.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> r = sp.Symbol("r", real=True)
    >>> profile = rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 2})
    >>> rsym.sweep(profile, {r: 2 - z / 4}, 0, 4).expression
    conjunction(-x**2 - y**2 + (2 - z/4)**2, z*(4 - z)/4)
    """
    require_shape(profile)
    _plane(profile, "sweep")
    pairs = [(str(letter), number(value, f"the letter {letter}")) for letter, value in _pairs(changes)]
    for name, _ in pairs:
        if name not in profile.letters:
            raise RsymError(f"the profile has no letter {name!r}", code="unknown-letter", remedy="name one of its own")
    new = dict(pairs)
    formulas = (profile.expression, *(part for _, part in profile.parts))
    changed = {symbol: new[symbol.name] for symbol in symbols_of(*formulas) if symbol.name in new}
    kept = Letters({name: letter for name, letter in profile.letters.items() if name not in new})
    mentioned = {symbol.name for symbol in symbols_of(*new.values())} & profile.letters.keys()
    kept = kept.merge(Letters({name: profile.letters[name] for name in mentioned}))
    moving = Shape(
        substitute(profile.expression, changed),
        (*profile.coordinates, _third(profile)),
        letters=kept.merge(letters),
        parts=tuple((name, moved_part(part, changed)) for name, part in profile.parts),
    )
    low, high = number(lower, "the lower end"), number(upper, "the upper end")
    box = _with_heights(None if changed else profile.box, (default(low, moving.letters), default(high, moving.letters)))
    slab = between(_third(profile), low, high, moving.letters, not system.keeps_sets)
    return _joined(moving, slab, (), system, None, box)


def _plane(shape: Shape, what: str) -> None:
    require_shape(shape)
    if shape.dimension != 2:
        raise RsymError(
            f"{what} needs a plane shape, got one in {', '.join(symbol.name for symbol in shape.coordinates)}",
            code="dimension",
            remedy="use section for a plane shape from a body",
        )


def _third(shape: Shape) -> sp.Symbol:
    """The coordinate that a plane shape lacks."""
    names = [symbol.name for symbol in shape.coordinates]
    return real_symbol(next(name for name in "zyx" if name not in names))


def _pairs(changes: Mapping[Any, Any] | Sequence[Any]) -> list[tuple[Any, Any]]:
    pairs = list(changes.items()) if isinstance(changes, Mapping) else [tuple(pair) for pair in changes]
    if not pairs or any(len(pair) != 2 for pair in pairs):
        raise RsymError(
            f"changes are pairs of a letter and an expression, got {changes!r}", code="sweep", remedy="{letter: value}"
        )
    return pairs


def _joined(
    shape: Shape,
    other: sp.Expr,
    more: tuple[sp.Symbol, ...],
    system: RSystem,
    letters: LetterMapping,
    box: BoundingBox | None,
) -> Shape:
    """The conjunction with an expression in more coordinates; a system that rounds edges is given lengths."""
    shape = shape if system.keeps_sets else in_lengths(shape)
    return Shape(
        system.conjunction(shape.expression, other),
        (*shape.coordinates, *more),
        letters=shape.letters.merge(letters),
        box=box,
        parts=shape.parts,
    )


def _with_heights(box: BoundingBox | None, heights: tuple[float, float]) -> BoundingBox | None:
    """The box of a plane shape made a box in space, a tenth of the height free above and below.

    Beside a box about what is cut out of the plane, the faces at both heights go on without end.
    """
    room = ROOM * (heights[1] - heights[0])
    if box is None or not box.solid:
        return None
    return box.mapped(lambda ends: (*ends, (heights[0] - room, heights[1] + room)))


def _grown(box: BoundingBox, room: float) -> BoundingBox:
    """The box of what grew by some length, likely."""
    return box.mapped(lambda ends: tuple((low - room, high + room) for low, high in ends)).likely


def offset(shape: Shape, distance: Any, *, letters: LetterMapping = None) -> Shape:
    """The body grown by a distance, shrunk by a negative one: every leaf moved by it, in the same R-operations.

    Leaves that are functions of a distance (planes, slabs, discs, balls, cylinders, cones, tori, capsules, moved and
    scaled) move by exactly that, others as far as omega measures distance: omega + distance. Edges stay edges; fillets
    of `Rho` keep the middle of their circle. Where that is not known to be the true offset, as at convex edges that
    grow, its distance from the body is measured, and an RsymWarning says between what it is if that is a hundredth off.

    Raises
    ------
    RsymError
        For a distance that is no number.

    Examples
    --------
    >>> import rsym
    >>> rsym.offset(rsym.disc(10), 2).expression == rsym.disc(12).expression
    True
    >>> rsym.offset(rsym.box(60, 40, 25), -2).expression
    conjunction(14 - x**2/56, 9 - y**2/36, 21/4 - z**2/21)
    """
    require_shape(shape)
    grown, known = number(distance, "a distance"), shape.letters.merge(letters)
    box = shape.box and _grown(shape.box, max(default(grown, known), 0.0))
    parallel = Parallel(shape.coordinates, known)
    expression = parallel.moved(shape.expression, grown)
    parts = tuple(_moved_parts(shape, expression, known, grown))
    moved = Shape(expression, shape.coordinates, letters=known, box=box, parts=parts)
    _tell_of_range(parallel, shape, moved, default(grown, known), "offset")
    return moved


def _moved_parts(
    shape: Shape, expression: sp.Expr, letters: Letters, distance: sp.Expr
) -> Iterator[tuple[str, sp.Expr]]:
    """The parts of a shape where its offset, this expression, has them: those that are cut out are moved inwards."""
    inside = Inside(expression)
    for name, part in shape.parts:
        for by in (distance, -distance):
            moved = Parallel(shape.coordinates, letters).moved(part.as_coeff_Mul()[1], by)
            if moved in inside:
                yield name, moved


def shell(shape: Shape, thickness: Any, *, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The wall inside a body, from its boundary to the depth `thickness`: omega, and not the body shrunk by it.

    The body is shrunk as `offset` does it, so that the wall has this thickness wherever leaves know their distances;
    elsewhere the true one is measured, and an RsymWarning says between what it is. The two boundaries never meet, so
    nothing is lost in smoothness; normalised to order 1 where omega is.

    Raises
    ------
    RsymError
        For a thickness that is not positive.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.shell(rsym.Shape(x, (x, y)), 2).expression
    conjunction(x, 2 - x)
    >>> round(rsym.measure(rsym.shell(rsym.rectangle(6, 4), 1)).area, 9)
    16.0
    """
    require_shape(shape)
    known = shape.letters.merge(letters)
    depth = positive(thickness, "the thickness", known)
    parallel = Parallel(shape.coordinates, known)
    inner_box = shape.box
    if shape.box is not None and not shape.box.solid and shape.bounds is None:  # what shrinks is outside of the box
        inner_box = _grown(shape.box, default(depth, known))
    inner = Shape(parallel.moved(shape.expression, -depth), shape.coordinates, letters=known, box=inner_box)
    _tell_of_range(parallel, shape, inner, default(depth, known), "thickness")
    wall = system.conjunction(shape.expression, -inner.expression)
    return Shape(wall, shape.coordinates, letters=known, box=without([shape.box, inner_box]), parts=shape.parts)


def _tell_of_range(parallel: Parallel, body: Shape, moved: Shape, distance: float, what: str) -> None:
    """Have it measured how far the moved boundary is from that of the body, where that is in doubt."""
    if parallel.doubt:
        from rsym.sampling.offsets import tell_of_range

        tell_of_range(body, moved, distance, what, parallel.doubt)
