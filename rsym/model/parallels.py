"""Bodies grown and shrunk leaf by leaf: every leaf moved by the distance, R-operations as they are.

The sign of an R-operation depends on the signs of its operands alone. So where the leaves measure distances, the moved
body is that of min and max of them plus the distance: the true offset for what is shrunk of intersections and for what
is grown of unions. A convex edge that grows keeps its corner, which then is farther from the body than its faces, and
so does a concave one that shrinks; edges that are round already keep the middle of their circle.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import sympy as sp

from rsym.model.arguments import LetterMapping, default
from rsym.model.blends.folds import BlendOperation
from rsym.model.blends.rho import CircularOperation
from rsym.model.distances import Coordinates, transnormal
from rsym.model.nodes import Scaled
from rsym.model.rnodes import R0Conjunction, R0Disjunction, R1Conjunction, R1Disjunction, ROperation
from rsym.model.shape import Shape


@dataclass
class Parallel:
    """What is moved, and whether the result is the true offset.

    images: moved forms of the parts met, by part and by how much they move. unknown: leaves that are not shown to be
    functions of a distance. sharp: whether edges keep their corners where those of the true offset are round.
    """

    coordinates: Coordinates
    letters: LetterMapping
    images: dict[tuple[sp.Expr, sp.Expr], sp.Expr] = field(default_factory=dict)
    unknown: list[sp.Expr] = field(default_factory=list)
    sharp: bool = False

    def moved(self, part: sp.Expr, distance: sp.Expr) -> sp.Expr:
        """The part grown by a distance: positive where its own signed distance is above -distance.

        Examples
        --------
        >>> import sympy as sp
        >>> from rsym import conjunction, x, y
        >>> Parallel((x, y), None).moved(conjunction(1 - x**2 / 4, y / 2), sp.Integer(-1))
        conjunction(1/2 - x**2/2, y - 1)
        """
        key = part, distance
        if key not in self.images:
            self.images[key] = self._moved(part, distance)
        return self.images[key]

    def _moved(self, part: sp.Expr, distance: sp.Expr) -> sp.Expr:
        factor, rest = part.as_coeff_Mul()
        if factor == -1:
            return -self.moved(rest, -distance)
        if factor != 1 and _is_gate(rest):  # of a scaled shape
            operands = [abs(factor) * operand for operand in rest.operands]
            inner = rest.func(*rest.parameters, *operands)
            return self.moved(inner, distance) if factor > 0 else -self.moved(inner, -distance)
        if isinstance(part, Scaled) and _is_gate(part.args[0]):
            return self.moved(part.args[0], distance)
        if isinstance(part, sp.Min | sp.Max):
            self._note_edges(distance, -1 if isinstance(part, sp.Min) else 1)
            return part.func(*(self.moved(operand, distance) for operand in part.args))
        if _is_gate(part):
            return self._operation(part, distance)
        found = transnormal(part, self.coordinates)
        if found is None:
            self.unknown.append(part)
            return part + distance
        return found.moved(distance, self.letters)

    def _operation(self, part: ROperation, distance: sp.Expr) -> sp.Expr:
        if isinstance(part, CircularOperation):
            return self._rounded(part, distance)
        self._note_edges(distance, part.sign)
        return part.func(*part.parameters, *(self.moved(operand, distance) for operand in part.operands))

    def _note_edges(self, distance: sp.Expr, sign: int) -> None:
        """What grows keeps convex edges sharp, what shrinks concave ones."""
        self.sharp = self.sharp or bool(default(distance, self.letters) * sign < 0)

    def _rounded(self, part: CircularOperation, distance: sp.Expr) -> sp.Expr:
        """Edges that are round already keep the middle of their circle."""
        radius, cosine = part.parameters
        wider = radius - part.sign * distance
        lengths = [one for operand in part.operands if (one := self._length(operand)) is not None]
        if len(lengths) < len(part.operands) or default(wider, self.letters) <= 0:
            self._note_edges(distance, part.sign)
            sharp = R0Conjunction if part.sign < 0 else R0Disjunction
            return sharp(*(self.moved(operand, distance) for operand in part.operands))
        return part.func(wider, cosine, *(one + distance for one in lengths))

    def _length(self, operand: sp.Expr) -> sp.Expr | None:
        found = None if _is_gate(operand) else transnormal(operand, self.coordinates)
        return None if found is None else found.distance(self.letters)

    @property
    def doubt(self) -> str:
        """Why the result may differ from the true offset; empty where it does not."""
        if self.unknown:
            leaf = sp.sstr(self.unknown[0])
            return f"omega measures distance on the boundary alone, in {leaf if len(leaf) < 80 else leaf[:76] + ' ...'}"
        return "edges keep their corners" if self.sharp else ""


def _is_gate(part: sp.Expr) -> bool:
    """Whether leaves are moved below a part; a blend of another kind is moved as a whole."""
    return isinstance(part, ROperation) and (
        not isinstance(part, BlendOperation) or isinstance(part, CircularOperation)
    )


def lengths(part: sp.Expr, coordinates: Coordinates, letters: LetterMapping = None) -> sp.Expr:
    """The distance as far as leaves know it: leaf by leaf, in min and max; what does not stays as it is.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> lengths(conjunction(1 - x**2 / 4, 3 * y), (x, y))
    conjunction(2 - Abs(x), y, system=R1)
    """
    factor, rest = part.as_coeff_Mul()
    if factor == -1:
        return -lengths(rest, coordinates, letters)
    if _is_gate(part) and not isinstance(part, BlendOperation):
        joined = R1Conjunction if part.sign < 0 else R1Disjunction
        return joined(*(lengths(operand, coordinates, letters) for operand in part.operands))
    found = transnormal(part, coordinates)
    return part if found is None else found.distance(letters)


def in_lengths(shape: Shape) -> Shape:
    """The shape as far as its leaves know lengths, its parts likewise.

    Examples
    --------
    >>> import rsym
    >>> in_lengths(rsym.rectangle(4, 2).named("plate")).parts
    (('plate', conjunction(2 - Abs(x), 1 - Abs(y), system=R1)),)
    """

    def measured(part: sp.Expr) -> sp.Expr:
        return lengths(part, shape.coordinates, shape.letters)

    parts = tuple((name, measured(part)) for name, part in shape.parts)
    return replace(shape, expression=measured(shape.expression), parts=parts)
