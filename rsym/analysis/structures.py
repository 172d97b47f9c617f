"""Solution structures: expressions with undetermined functions that meet boundary conditions whatever these are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Robin, Supported, UnknownLevel
from rsym.analysis.differential import derivative
from rsym.analysis.transfinite import OnPart, inverse_distances, taylor, zero_with
from rsym.errors import RsymError
from rsym.model.arguments import number
from rsym.model.letters import Letter, Letters
from rsym.model.rnodes import Equivalence
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import real_symbol, substitute, symbols_of
from rsym.model.vectors import dot
from rsym.model.wording import listing

NO_LETTERS = Letters({})
POWER = 2  # of inverse distances: values and first derivatives, and no absolute values


class Conditioned(NamedTuple):
    """A condition, its values being expressions, and where it holds.

    Attributes
    ----------
    condition : BoundaryCondition
        What is to be met.
    weight : sympy.Expr
        A function that vanishes where it holds, normalised to order 1, positive inside.
    factor : sympy.Expr
        Another one, which need not be normalised; the undetermined functions are multiplied by it.
    """

    condition: BoundaryCondition
    weight: sp.Expr
    factor: sp.Expr


@dataclass(frozen=True)
class SolutionStructure:
    """A function that meets conditions on the boundary of a shape whatever its undetermined functions are.

    Attributes
    ----------
    formula : sympy.Expr
        The function; the undetermined functions and their first derivatives in it are letters, ``Phi_1``, ``Phi_1_x``,
        ``Phi_1_y`` and so on. There are two functions where conditions speak of slopes, else one.
    unknowns : tuple of str
        The names of the undetermined functions.
    constants : tuple of str
        The letters that stand for the levels of parts with the condition `constant`.
    coordinates, letters, bounds
        As a shape has them.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quarter = rsym.disc(1) & rsym.Shape(x, (x, y)).named("cut")
    >>> structure = rsym.solution_structure(quarter, {"cut": rsym.neumann(3)})
    >>> structure.unknowns
    ('Phi_1', 'Phi_2')
    >>> structure.with_functions(sp.exp(y), 0).expression
    -3*x + exp(y)
    """

    formula: sp.Expr
    unknowns: tuple[str, ...]
    constants: tuple[str, ...]
    coordinates: tuple[sp.Symbol, ...]
    letters: Letters
    bounds: Bounds | None = None

    @property
    def expression(self) -> sp.Expr:
        """The formula with undetermined functions of SymPy, ``Phi_1(x, y)``, and their derivatives.

        Examples
        --------
        >>> import rsym
        >>> rsym.solution_structure(rsym.disc(1), 5).expression
        (-x**2/2 - y**2/2 + 1/2)*Phi_1(x, y) + 5
        """
        return self._with([sp.Function(name)(*self.coordinates) for name in self.unknowns], sp.Derivative)

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {sp.latex(self.expression)}$"

    def with_functions(self, *functions: Any, letters: Mapping[Any, Letter | float] | None = None) -> Shape:
        """The structure as a shape, these expressions being its undetermined functions.

        Parameters
        ----------
        *functions : numbers or expressions
            One for each undetermined function, in coordinates and letters.
        letters : mapping, optional
            New ones in them, ``{symbol or name: number or Letter}``.

        Raises
        ------
        RsymError
            For another number of functions, for symbols that are neither coordinates nor letters.

        Examples
        --------
        >>> import rsym, sympy as sp
        >>> from rsym import x, y
        >>> c = sp.Symbol("c", real=True)
        >>> rsym.solution_structure(rsym.disc(1), 5).with_functions(c * y, letters={c: 2}).expression
        c*y*(-x**2/2 - y**2/2 + 1/2) + 5
        """
        if len(functions) != len(self.unknowns):
            raise RsymError(
                f"the structure has the undetermined functions {listing(self.unknowns)}, got {len(functions)} for them",
                code="arity",
                remedy="give an expression, or 0, for each",
            )
        given = [number(function, name) for function, name in zip(functions, self.unknowns, strict=True)]
        whole = self._with(given, derivative)
        return Shape(whole, self.coordinates, letters=self.letters.merge(letters), bounds=self.bounds)

    def with_values(self) -> Shape:
        """The structure as a shape of which the undetermined functions and their first derivatives are letters.

        Functions of JAX and PyTorch take arrays for letters and have derivatives by them, so that a network and its
        gradient can be given for them: see `solution_structure`.

        Examples
        --------
        >>> import rsym
        >>> list(rsym.solution_structure(rsym.disc(1), rsym.neumann(0)).with_values().letters)
        ['Phi_1', 'Phi_1_x', 'Phi_1_y', 'Phi_2']
        """
        there = set(symbols_of(self.formula))
        names = [_slope(name, symbol) for name in self.unknowns for symbol in (None, *self.coordinates)]
        values = {name: 0 for name in names if name in self.unknowns or real_symbol(name) in there}
        return Shape(self.formula, self.coordinates, letters=self.letters.merge(values), bounds=self.bounds)

    def _with(self, functions: Sequence[sp.Expr], slope: Callable[[sp.Expr, sp.Symbol], sp.Expr]) -> sp.Expr:
        """The formula with functions in it, and what `slope` makes of them and a coordinate."""
        places, there = dict[sp.Symbol, sp.Expr](), set(symbols_of(self.formula))
        for name, function in zip(self.unknowns, functions, strict=True):
            places[real_symbol(name)] = function
            for symbol in self.coordinates:
                if (place := real_symbol(_slope(name, symbol))) in there:
                    places[place] = slope(function, symbol)
        return substitute(self.formula, places)


def _slope(name: str, coordinate: sp.Symbol | None) -> str:
    return name if coordinate is None else f"{name}_{coordinate}"


def structure_of(
    pieces: Sequence[Conditioned],
    coordinates: tuple[sp.Symbol, ...],
    letters: Letters = NO_LETTERS,
    bounds: Bounds | None = None,
) -> SolutionStructure:
    """The structure of conditions and weights.

    With D, C, R the parts with values, with values and slopes (clamped), and with du/dn + c*u = h, n outward:

        w = I + F_D * F_C**2 * Phi_1
        u = w - o * A + F_D * F_C**2 * F_R**2 * Phi_2

    I interpolates the values on D and the Taylor forms on C; F are factors, o is the joining of all weights, and A
    interpolates grad(w_i).grad(w) - c*w + h on the parts of R, 0 on C. On a part of R o = 0 and -do/dn = 1, so
    u = w and du/dn = dw/dn + A = h - c*u; on D and C the second term is 0, on C with its slope. Without R it is w.
    Source: Rvachev and Sheiko (1995), Sukumar and Srivastava (2022), (24), (25), (33); of A the interpolation.

    Examples
    --------
    >>> from rsym import x, y
    >>> from rsym.analysis.conditions import robin
    >>> structure_of([Conditioned(robin(2, 5), y, y)], (x, y)).expression
    y**2*Phi_2(x, y) + Phi_1(x, y) - y*(-2*Phi_1(x, y) + Derivative(Phi_1(x, y), y) + 5)
    """
    robin = [piece for piece in pieces if isinstance(piece.condition, Robin)]
    unknowns = ("Phi_1", "Phi_2") if robin else ("Phi_1",)
    levels = [f"C_{k + 1}" for k in range(sum(isinstance(piece.condition, UnknownLevel) for piece in pieces))]
    taken = letters.keys() & {*levels, *(_slope(name, one) for name in unknowns for one in (None, *coordinates))}
    if taken:
        raise RsymError(
            f"the letter {min(taken)!r} is the name of something undetermined",
            code="letter-conflict",
            remedy="rename it",
        )
    fixed, left, factor = list[OnPart](), iter(levels), sp.S.One
    for piece in pieces:
        if not isinstance(piece.condition, Robin):
            fixed.append(OnPart(_held(piece, coordinates, left), piece.weight))
            factor *= piece.factor ** (2 if isinstance(piece.condition, Clamped) else 1)
    lifted = inverse_distances(fixed, POWER) if fixed else sp.S.Zero
    whole = lifted + factor * real_symbol("Phi_1")
    if robin:
        corrected = _correction(pieces, whole, "Phi_1", coordinates)
        for piece in robin:
            factor *= piece.factor**2
        whole += factor * real_symbol("Phi_2") - corrected
    every = letters.merge(dict.fromkeys(levels, 0))
    return SolutionStructure(whole, unknowns, tuple(levels), coordinates, every, bounds)


def _held(piece: Conditioned, coordinates: Sequence[sp.Symbol], levels: Iterator[str]) -> sp.Expr:
    """What takes the value, and the slope, of a condition on its part."""
    condition = piece.condition
    if isinstance(condition, Clamped):
        return taylor(piece.weight, coordinates, [condition.value, condition.slope])
    if isinstance(condition, Dirichlet | Supported):
        return condition.value
    return real_symbol(next(levels))


def _correction(
    pieces: Sequence[Conditioned], whole: sp.Expr, unknown: str, coordinates: Sequence[sp.Symbol]
) -> sp.Expr:
    """The product o*A."""
    slopes = [
        derivative(whole, symbol) + derivative(whole, real_symbol(unknown)) * real_symbol(_slope(unknown, symbol))
        for symbol in coordinates
    ]
    defects = list[OnPart]()
    for condition, weight, _ in pieces:
        if isinstance(condition, Robin):
            along = dot([derivative(weight, symbol) for symbol in coordinates], slopes)
            defects.append(OnPart(along - condition.coefficient * whole + condition.flux, weight))
        elif isinstance(condition, Clamped):
            defects.append(OnPart(sp.S.Zero, weight))
    joined = Equivalence(sp.Integer(POWER), *(piece.weight for piece in pieces))
    return zero_with(joined, joined * inverse_distances(defects, POWER))
