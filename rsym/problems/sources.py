"""Sources with poles: those that no integral has are refused, with the place.

Boxes in which the formula has no bounds are divided, down to the rounding of places. About what is left it is asked of
values how the formula grows, like the distance to the power -a, and of boxes how many dimensions the pole leaves, k: it
has an integral for a < k alone, and the solution has a gradient with one for a < 1 + k/2.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.logic.sign_form import shape_builder, shape_form
from rsym.model.recent import recently
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.problems.pointwise import PointFormulas, formulas
from rsym.program.lowering import lower
from rsym.sampling.form_signs import Boxes, grid, halves
from rsym.sampling.windows import bounds_or_extent

FIRST, DEEPEST, FEW = 16, 30, 256  # boxes along an axis, halvings, and boxes that go on
ASIDE = 1e-3  # of the shape: poles nearer to the boundary are not looked at, where values are given they do no harm
LOOKED_AT = 16  # of these
FINE = {2: 32, 3: 12}  # divisions of a box about a pole, and as many again
NEAR, WAYS = 1e-4, 64  # of the shape, a quarter of which is nearer still, and directions: how values grow
UNSURE = 0.02  # of powers: 1/x has 1.0000, log(x) 0.1


def require_integrable(shape: Shape, source: sp.Expr, called: str, unknown: Collection[str] = ()) -> None:
    """Refuse a source with a pole inside that has no integral; `unknown` are the names of Python functions.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> require_integrable(rsym.disc(1), 1 / sp.sqrt(x**2 + y**2), "the right side")
    >>> require_integrable(rsym.disc(1), 1 / (x**2 + y**2), "the right side")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: the right side has a pole at (0, 0), where it grows like the distance to the power -2: \
it has no integral; remedy: cut the place out of the shape, or give a source without the pole
    """
    for pole in poles_in(shape, source, (*unknown,)):
        if pole.power > min(pole.left, 1 + pole.left / 2) - UNSURE:
            place = ", ".join(f"{value:.4g}" for value in pole.place)
            raise RsymError(
                f"{called} has a pole at ({place}), where it grows like the distance to the power {-pole.power:.3g}: "
                "it has no integral",
                code="pole",
                remedy="cut the place out of the shape, or give a source without the pole",
            )


class SourcePole(NamedTuple):
    """A place, by which power of the inverse distance values grow, and the dimensions of the space less the pole's."""

    place: tuple[float, ...]
    power: float
    left: float


@recently(16)
def poles_in(shape: Shape, source: sp.Expr, unknown: tuple[str, ...] = ()) -> tuple[SourcePole, ...]:
    """Places inside a shape where a source has no bound, some of each pole."""
    if not _may_have_poles(source, shape) or {symbol.name for symbol in symbols_of(source)} & {*unknown}:
        return ()
    letters, builder = shape.letters.values_with(None), shape_builder(shape)
    bounds = IntervalFunction(builder.program({"": lower(builder, source)}), "numpy", threads=1)
    box = Boxes(*np.array(bounds_or_extent(shape, None)).T[:, :, None])
    size, values = float(box.sides.max()), formulas(shape, {"": source})
    places, found = _places(shape, bounds, box, letters), []
    for place in places[:: max(1, len(places) // LOOKED_AT)]:
        power, left = _power(values, place, size), _codimension(bounds, place, size, letters)
        if power > UNSURE:
            found.append(SourcePole(tuple(round(one / size, 6) * size + 0.0 for one in place.tolist()), power, left))
    return tuple(found)


def _may_have_poles(source: sp.Expr, shape: Shape) -> bool:
    """Whether something in it divides by what varies, or is a function that may grow beyond bounds."""
    coordinates = {*shape.coordinates}
    plain = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.Abs, sp.Max, sp.Min, sp.sign, sp.atan, sp.atan2)
    return any(
        {*symbols_of(part)} & coordinates and not (part.exp.is_nonnegative if part.is_Pow else isinstance(part, plain))
        for part in postorder(source)
        if isinstance(part, sp.Function | sp.Pow)
    )


def _open(function: IntervalFunction, boxes: Boxes, letters: dict[str, float]) -> Boxes:
    """Those in which a formula has no bounds."""
    low, high = function(list(boxes.lower), list(boxes.upper), letters)[""]
    return boxes[~np.broadcast_to(np.isfinite(low) & np.isfinite(high), len(boxes))]


def _places(shape: Shape, bounds: IntervalFunction, box: Boxes, letters: dict[str, float]) -> Floats:
    """Some points (n, dim) inside a shape next to which a formula has no bounds."""
    form, size = shape_form(shape), float(box.sides.max())
    inside = IntervalFunction(form.builder.program({"": form.value}), "numpy", threads=1)
    boxes = _open(bounds, grid(box, FIRST), letters)
    for _ in range(DEEPEST):
        boxes = boxes[inside(list(boxes.lower), list(boxes.upper), letters)[""][1] >= 0]
        boxes = boxes[np.arange(0, len(boxes), max(1, len(boxes) // FEW))]
        if not len(boxes):
            return np.empty((0, shape.dimension))
        boxes = _open(bounds, halves(boxes)[0], letters)
    ends = boxes.centres - ASIDE * size, boxes.centres + ASIDE * size
    within = inside(list(ends[0]), list(ends[1]), letters)[""][0] > 0
    return np.ascontiguousarray(boxes.centres.T[within])


def _power(values: PointFormulas, pole: Floats, size: float) -> float:
    """By which power of the inverse distance from a pole values grow, in most directions."""
    ways = np.random.default_rng(0).normal(size=(WAYS, len(pole)))
    ways *= NEAR * size / np.linalg.norm(ways, axis=1, keepdims=True)
    with np.errstate(all="ignore"):
        far, near = (np.abs(values(pole + ways / times)[0]) for times in (1, 4))
        powers = np.log(near / far) / np.log(4)
    powers[np.isinf(near)] = np.inf
    return float(np.nanmedian(powers)) if not np.isnan(powers).all() else 0.0


def _codimension(bounds: IntervalFunction, pole: Floats, size: float, letters: dict[str, float]) -> float:
    """The dimensions of the space less those of the pole: twice the divisions have more boxes with it by these."""
    half = NEAR * size * np.array([1.0, 0.91, 0.83])[: len(pole)]
    about = Boxes((pole - 0.57 * half)[:, None], (pole + half)[:, None])
    counts = [len(_open(bounds, grid(about, times * FINE[len(pole)]), letters)) for times in (1, 2)]
    return len(pole) - float(np.log2(counts[1] / counts[0]))
