"""Shapes under any smooth map whose inverse is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rsym.analysis.normalisation import normalise
from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, number
from rsym.model.bounding import stated_box
from rsym.model.equation import substituted
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape


def transform(
    shape: Shape,
    inverse: Mapping[Any, Any] | Sequence[Any],
    *,
    renormalise: bool = False,
    length: Any = 1,
    bounds: Any = None,
    letters: LetterMapping = None,
) -> Shape:
    """The image of a shape under a smooth map that is given by its inverse: omega(inverse(p)).

    Parameters
    ----------
    inverse : mapping or sequence
        Where the point (x, y[, z]) of the image comes from: {coordinate: expression}, those that stay left out, or
        one expression for each coordinate.
    renormalise : bool
        Divide by sqrt(omega**2/length**2 + |grad omega|**2): a map that does not keep distances loses the
        normalisation.
    bounds : sequence of pairs, optional
        Of the image; not known otherwise.

    Raises
    ------
    RsymError
        For something that is no coordinate, or the wrong number of expressions.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> strip = rsym.Shape(1 - y**2, (x, y))
    >>> rsym.transform(strip, {y: y - x**2}).expression
    1 - (-x**2 + y)**2
    >>> bent = rsym.transform(strip, {y: y - x**2}, renormalise=True)
    >>> round(float(rsym.compile(bent, ("gradient_squared",))(2.0, 5.0)["gradient_squared"]), 12)
    1.0
    """
    require_shape(shape)
    known = {symbol.name: symbol for symbol in shape.coordinates}
    if isinstance(inverse, Mapping):
        given = {str(name): value for name, value in inverse.items()}
    else:
        listed = list(inverse) if isinstance(inverse, Sequence) else []
        given = dict(zip(known, listed, strict=True)) if len(listed) == len(known) else {}
    if not given or given.keys() - known.keys():
        raise RsymError(
            f"a map needs an expression for each of {', '.join(known)}, got {inverse!r}",
            code="map",
            remedy="for example {x: x - y**2}",
        )
    places = {known[name]: number(value, f"the place of {name}") for name, value in given.items()}
    box = None if bounds is None else stated_box(bounds, shape.dimension)
    image = substituted(shape, places, letters=letters, box=box)
    return normalise(image, length=length) if renormalise else image
