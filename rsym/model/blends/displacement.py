"""Displacement blends: an R-operation plus a bump around the edge of its operands, everywhere or within a solid."""

from __future__ import annotations

from typing import Any, ClassVar

import sympy as sp

from rsym.model.arguments import LetterMapping, number, positive
from rsym.model.blends.operands import Operands
from rsym.model.choices import Choice
from rsym.model.nodes import Composition
from rsym.model.shape import Shape
from rsym.model.systems import R0, RSystem


class _Bump(Composition):
    """What is added to an operation: scales first, then operands."""

    of_shapes = True
    name: ClassVar[str]
    scale_count: ClassVar[int]

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        parts = self.args[: self.scale_count], self.args[self.scale_count :]
        scales, operands = (", ".join(map(printer._print, part)) for part in parts)
        text = rf"\operatorname{{disp}}_{{{scales}}}\left({operands}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"{self.name}({', '.join(map(printer._print, self.args))})"


class Displacement(_Bump):
    """Displacement(a0, a1, a2, f, g): a0/(1 + (f/a1)**2 + (g/a2)**2).

    Analytic, between 0 and a0, and a0 where f = g = 0; it falls in f**2 and g**2.
    """

    name, scale_count = "displacement", 3

    def composition(self) -> sp.Expr:
        """The formula."""
        a0, a1, a2, f, g = self.args
        return a0 / (1 + (f / a1) ** 2 + (g / a2) ** 2)


class BoundedDisplacement(_Bump):
    """BoundedDisplacement(a0, a1, a2, a3, f, g, h): a0*n**6/(2 - n**2), n = k/sqrt(k**2 + r**2), where h > 0, else 0.

    r**2 = (f/a1)**2 + (g/a2)**2 and k = h/a3. Between 0 and a0; five times
    continuously differentiable except where f = g = h = 0, where the edge of f
    and g leaves the solid h >= 0: there it jumps. Analytic except on h = 0.
    """

    name, scale_count = "bounded_displacement", 4

    def composition(self) -> sp.Expr:
        """The formula: with r2 = max(k, 0), n is r2/sqrt(r1**2 + r2**2), so that nothing is 0/0 inside the solid."""
        a0, a1, a2, a3, f, g, h = self.args
        inward = h / a3
        unit = inward / sp.sqrt(inward**2 + (f / a1) ** 2 + (g / a2) ** 2)
        return Choice(inward, 0, a0 * unit**6 / (2 - unit**2), 0)


def displacement_blend(
    f: Any,
    g: Any,
    a0: Any,
    a1: Any = 1,
    a2: Any = 1,
    *,
    operation: str = "union",
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Any:
    """The operation on f and g plus a0/(1 + (f/a1)**2 + (g/a2)**2).

    a0 > 0 adds material, a0 < 0 removes it: the edge f = g = 0 is moved by a0
    in value. The boundary is displaced everywhere, the less the farther from
    the edge, and normalisation is not kept. What adds material may leave the bounds of the operands, so that shape
    has none of its own. In system R_0 the boundary avoids
    f = g = 0, the only singular set, so it is analytic wherever its gradient
    does not vanish; a0 = 0 gives the operation itself.

    Parameters
    ----------
    f, g : shapes or expressions
        The operands.
    a0 : number or expression in letters
        Height of the displacement, in the unit of the operands.
    a1, a2 : number or expression in letters
        Positive: the values of f and g that halve it, in their units.
    operation : {"union", "intersection", "difference"}
        What is blended.
    system : RSystem
        System of the operation.
    letters : mapping, optional
        Values of letters in the numbers.

    Raises
    ------
    RsymError
        For a1 or a2 that is not positive, or an unknown operation.

    Source: Pasko and Savchenko (1994).

    Examples
    --------
    >>> from rsym import x, y
    >>> displacement_blend(x, y, 1).subs({x: 0, y: 0}).evalf(3)
    1.00
    """
    operands = Operands.of(f, g, letters=letters)
    height = number(a0, "a0")
    widths = [positive(value, name, operands.letters) for name, value in (("a1", a1), ("a2", a2))]
    blended = operands.combined(operation, system, lambda a, b: Displacement(height, *widths, a, b))
    if not isinstance(blended, Shape) or height.is_nonpositive:
        return blended
    return Shape(blended.expression, blended.coordinates, letters=blended.letters, parts=blended.parts)


def bounded_blend(
    f: Any,
    g: Any,
    bounding: Any,
    a0: Any,
    a1: Any = 1,
    a2: Any = 1,
    a3: Any = 1,
    *,
    operation: str = "union",
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Any:
    """The operation on f and g plus a displacement within the bounding solid alone.

    a0*(1 - r**2)**3/(1 + r**2) with r**2 = r1**2/(r1**2 + r2**2),
    r1**2 = (f/a1)**2 + (g/a2)**2 and r2 = max(h, 0)/a3, h the bounding solid.
    Outside it the boundary of the operation is not moved, and normalisation is
    kept as the operation keeps it. Where the blend ends on a face it joins with
    continuous derivatives to order 5 (G2 and more); where the edge f = g = 0
    leaves the bounding solid the field jumps from a0 to 0.

    Parameters
    ----------
    f, g : shapes or expressions
        The operands.
    bounding : shape or expression
        Positive where the blend may act.
    a0 : number or expression in letters
        Height of the displacement; positive adds material, negative removes it.
    a1, a2, a3 : number or expression in letters
        Positive: scales of f, of g and of the bounding solid, in their units.
    operation : {"union", "intersection", "difference"}
        What is blended.
    system : RSystem
        System of the operation.
    letters : mapping, optional
        Values of letters in the numbers.

    Raises
    ------
    RsymError
        For a scale that is not positive, or an unknown operation.

    Source: Pasko, Pasko and Kunii (2005).

    Examples
    --------
    >>> from rsym import x, y
    >>> blend = bounded_blend(x, y, 1 - x**2 - y**2, sp.Rational(1, 2))
    >>> blend.subs({x: 0, y: 0}).evalf(3), blend.subs({x: 3, y: -4}).evalf(3)
    (0.500, 4.00)
    """
    operands = Operands.of(f, g, bounding, letters=letters)
    height = number(a0, "a0")
    names = (("a1", a1), ("a2", a2), ("a3", a3))
    scales = [positive(value, name, operands.letters) for name, value in names]
    return operands.combined(operation, system, lambda a, b, h: BoundedDisplacement(height, *scales, a, b, h))
