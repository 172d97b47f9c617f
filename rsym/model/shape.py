"""A shape: one real function, positive inside, with letters and bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rsym.errors import RsymError
from rsym.model import named_parts, showing
from rsym.model.bounding import Bounds as Bounds
from rsym.model.letters import Letter
from rsym.model.logical import NoNumber, no_number
from rsym.model.motions import Movable
from rsym.model.operations import conjunction, difference, disjunction, exclusive_or, negation
from rsym.model.systems import RSystem, in_system

if TYPE_CHECKING:
    from rsym.analysis.contracts.summary import Contract


@dataclass(frozen=True, init=False, repr=False)
class Shape(NoNumber, Movable):
    """omega(x, y[, z]) > 0 inside, = 0 on the boundary, < 0 outside.

    Parameters
    ----------
    expression : sympy.Expr
        omega, in coordinates and letters; R-nodes are kept as they are.
    coordinates : sequence of symbols
        Two or three, in the order in which functions take them.
    letters : mapping, optional
        ``{symbol or name: number or Letter}``; every other symbol of the expression must be here.
    bounds : sequence of pairs, optional
        ``((xmin, xmax), (ymin, ymax)[, (zmin, zmax)])``, the window that one looks at, exact numbers. Without it that
        is all of the boundary, in a box that is proved at the values of the letters (`extent`); a boundary that goes
        on without end needs a window. What is made of shapes keeps a window that all of them state.

    The operators ``& | - ~ ^`` are conjunction, disjunction, difference,
    negation and exclusive or in system R_0. `parts` are the pieces that have a
    name, (name, expression); they outlive every operation, and meshes and
    pictures speak of them.

    Raises
    ------
    RsymError
        For an unknown symbol, conflicting letters, bounds that are not finite and increasing, or an expression that is
        undefined (nan), infinite or not real.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-1, 1), (-1, 1)))
    >>> half = disc & rsym.Shape(x, (x, y))
    >>> half.expression
    conjunction(-x**2/2 - y**2/2 + 1/2, x)
    """

    def named(self, name: str) -> Shape:
        """The same shape as a part of this name: meshes and pictures call its surface so, whatever it is combined with.

        Where parts lie in one another the smallest gives the name; several parts may share one.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)).named("ball")
        >>> [name for name, _ in (ball & rsym.Shape(x, (x, y, z)).named("cut")).parts]
        ['ball', 'cut']
        """
        if not isinstance(name, str) or not name.strip():
            raise RsymError(f"a part needs a name, got {name!r}", code="part-name", remedy='for example named("wheel")')
        others = tuple(part for part in self.parts if part[1] != self.expression)
        return replace(self, parts=(*others, (name, self.expression)))

    def part(self, name: str) -> Shape:
        """The part of this name as a shape, with the letters that it needs; several of one name are their disjunction.

        Raises
        ------
        RsymError
            For a name that no part has; the remedy says which is near.

        Examples
        --------
        >>> import rsym
        >>> list(rsym.load("car").part("headlights").letters)
        ['af', 'bf', 'cf', 'df', 'xf', 'yf', 'zf']
        """
        return named_parts.part_of(self, name)

    def with_part(self, name: str, other: Shape) -> Shape:
        """The same formula with another shape in the place of a part, which keeps its name in meshes and pictures.

        A group, several parts of one name, becomes one. Letters and bounds of the other join those of the shape; its
        own parts are not told apart any more. The part is replaced where R-operations combine it, or else, as in the
        sum of a blend on a skeleton, wherever it stands. What was made of derivatives (`normalise`) would keep those of
        the old part, so parts are replaced before.

        Parameters
        ----------
        name : str
            Of the part.
        other : Shape
            In the same coordinates.

        Raises
        ------
        RsymError
            For a name that no part has, for a part whose formula is that of another one elsewhere, that the formula
            moves or bends, or that SymPy has merged with what surrounds it, for what is no shape or one in other
            coordinates.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> plate = rsym.Shape(y, (x, y)) - rsym.disc(1).named("hole")
        >>> square = plate.with_part("hole", rsym.strip(-1, 1))
        >>> [name for name, _ in square.parts], square.part("hole").expression
        (['hole'], (1 - x)*(x + 1)/2)
        """
        return named_parts.with_part(self, name, other)

    def with_system(self, system: RSystem, *, letters: Mapping[Any, Letter | float] | None = None) -> Shape:
        """The same logic in another R-system: every conjunction and disjunction becomes that of `system`.

        The sign of an R-function depends on the signs of its operands alone, so among the systems R_0, R_1, R_alpha,
        R_0^m and R_p neither the inside nor the boundary changes; what changes is how smooth omega is, and to which
        order it is normalised: of leaves of order m, distances for one, R_p with an even p > m makes a function of
        order m. Blends stay as they are, min and max too; in a system of blends every edge becomes a fillet. What was
        made of derivatives (`normalise`) keeps those of the old system, so the system is changed before.

        Parameters
        ----------
        system : RSystem
            For example ``Rp(4)``.
        letters : mapping, optional
            The value of a letter that is the parameter of the system.

        Raises
        ------
        RsymError
            For what is no system, or one with an unknown letter.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> quadrant = rsym.Shape(x, (x, y)) & rsym.Shape(y, (x, y))
        >>> quadrant.with_system(rsym.Rp(4)).expression
        conjunction(x, y, system=Rp(4))
        >>> quadrant.contract().order, quadrant.with_system(rsym.Rp(4)).contract().order
        (1, 3)
        """
        if not isinstance(system, RSystem):
            raise RsymError(f"expected an R-system, got {system!r}", code="system", remedy="for example Rp(4) or R1")
        return replace(
            self,
            expression=in_system(self.expression, system),
            letters=self.letters.merge(letters),
            box=self.box and (self.box if system.keeps_sets else self.box.likely),
            definitions=tuple((name, in_system(value, system)) for name, value in self.definitions),
            parts=tuple((name, in_system(part, system)) for name, part in self.parts),
        )

    def contains(self, *coordinates: Any, letters: Mapping[Any, float] | None = None) -> Any:
        """Whether points belong to the shape: omega >= 0 there, in float64.

        The boundary belongs to the shape, that of what was cut off too; which side of a curved boundary a point counts
        that lies on it to rounding, rounding decides. Where omega is undefined (NaN) those points belong to the shape
        that do whatever the undefined parts are (Kleene: true or unknown is true).

        Parameters
        ----------
        *coordinates : numbers or arrays
            One for each coordinate; they broadcast.
        letters : mapping, optional
            Override the defaults.

        Returns
        -------
        bool, or array of bool
            One answer for numbers, else an array of the shape that the arrays broadcast to.

        Raises
        ------
        RsymError
            For another number of coordinates, what is no real number, an unknown letter.

        Examples
        --------
        >>> import rsym
        >>> disc = rsym.disc(1)
        >>> disc.contains(0, 0), disc.contains(1, 0), disc.contains(2, 0)
        (True, True, False)
        >>> disc.contains([0, 0.5, 1.5], [[0.0], [0.9]]).tolist()
        [[True, True, False], [True, False, False]]
        """
        from rsym.logic.inside import inside_kernel

        inside = inside_kernel(self)(*coordinates, letters=letters)["value"] >= 0
        return inside if inside.ndim else bool(inside)

    def contract(self) -> Contract:
        """What the shape promises: class, order of normalisation, singular sets, leaves, interval image.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> print(rsym.Shape(rsym.conjunction(x, 1 - y), (x, y)).contract())
        omega is continuous; normalised to order 1
          continuous (conjunction) where x = 1 - y = 0
          leaves, the exact distance: x; 1 - y
        """
        from rsym.analysis.contracts.summary import contract

        return contract(self)

    def __and__(self, other: Shape) -> Shape:
        return conjunction(self, no_number(other))  # type: ignore[no-any-return]

    def __or__(self, other: Shape) -> Shape:
        return disjunction(self, no_number(other))  # type: ignore[no-any-return]

    def __sub__(self, other: Shape) -> Shape:
        return difference(self, no_number(other))  # type: ignore[no-any-return]

    def __invert__(self) -> Shape:
        return negation(self)  # type: ignore[no-any-return]

    def __xor__(self, other: Shape) -> Shape:
        return exclusive_or(self, no_number(other))  # type: ignore[no-any-return]

    def __repr__(self) -> str:
        return showing.text(self)

    def _repr_latex_(self) -> str:
        return showing.displayed(self)

    def _repr_html_(self) -> str:
        if len(self.coordinates) != 3 or not self.box:
            return showing.table(self)
        from rsym.output.rendering import thumbnail

        return f"{thumbnail(self)}{showing.table(self)}"
