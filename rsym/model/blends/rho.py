r"""Rho-blends: conjunctions whose edge is rounded inside a tube of given radius and untouched outside it.

In the operands x, y as coordinates let c be the product of the unit normals,
T = x**2 + y**2 - 2*c*x*y, r = sqrt(T) and t = rho*(1 - c). The general form is

    (x + y - sqrt(T + q))/(1 + c),    q = 0 where r >= t,

and where r < t either q = (t**2 - T)**2/(4*t**2), the circle, or
q = k*(t**2 - T)**3/t**4, the cubic. For the circle T + q is the square of
(T + t**2)/(2*t): there the blend *is* the normalised disc of radius rho that
touches both sides, and it falls short of the sharp conjunction by
(t - r)**2/(2*t*(1 + c)).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any, ClassVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.blends.folds import BlendOperation, Pair, in_range, infix_index, where_legal
from rsym.model.choices import Choice
from rsym.model.nodes import expand_nodes, written_out
from rsym.model.rnodes import R0Conjunction, R1Conjunction, R1Disjunction, RAlphaConjunction, ROperation
from rsym.model.systems import RSystem

# For k in (0, 125/72) the blend is monotone in both operands: the slope of sqrt(T + q) against sqrt(T)
# is at most 1 just where 9*k*(1 - u)**2*u <= 1 + 5*u for u = T/t**2 in [0, 1]; the minimum of
# (1 + 5*u)/(9*u*(1 - u)**2) lies at u = 1/5. Between perpendicular lines the fillet is convex up to 16/27.
LARGEST_COEFFICIENT = sp.Rational(125, 72)
# Between perpendicular lines, largest curvature times rho and bending energy times rho, by k:
# 0.16: 1.347, 1.767; 0.182: 1.279 (the least), 1.728; 0.2: 1.294, 1.715; 0.21: 1.311, 1.713 (the least);
# 0.25 (as deep at the corner as the circle): 1.401, 1.735; 0.302 (through the middle of the circle): 1.532, 1.817.
# At 1/5 both are within 1.3 % of the least, and the gradient on the fillet has a length between 0.993 and 1.028.
DEFAULT_COEFFICIENT = sp.Rational(1, 5)
CONTINUITIES = ("G1", "G2")


@dataclass(frozen=True)
class Rho(RSystem):
    """The rho-blend: R-operations whose edges are fillets of radius rho.

    Conjunction of f and g, with s = f**2 + g**2 - rho**2 and cosine 0:
    f + g - sqrt(f**2 + g**2 + s*(s - |s|)/(8*rho**2)) for G1 and
    f + g - sqrt(f**2 + g**2 + k*max(-s, 0)**3/rho**4) for G2;
    the disjunction is dual, f or g = -(-f and -g).

    Where s >= 0 it is the operation of R_0 (of R_alpha with alpha the cosine),
    so the rest of the boundary is not moved; inside the tube s < 0 the
    conjunction is smaller and cuts the edge. It is monotone in both operands.

    G1: the zero set inside the tube is exactly the circle
    (f - rho)**2 + (g - rho)**2 = rho**2; the curvature jumps by 1/rho where it
    ends. It keeps normalisation to order 1 on the faces, and if the gradients
    of f and g have the product `cosine` on the fillet too. Analytic except on s = 0.

    G2: twice continuously differentiable everywhere, f = g = 0 included, so the
    curvature is continuous; order 1 on the faces, not on the fillet.

    Parameters
    ----------
    radius : number or expression in letters
        rho > 0, in the unit of the operands (a length if they are normalised).
    continuity : {"G1", "G2"}
        Circle or cubic.
    cosine : number or expression in letters
        In (-1, 1): the product of the unit normals of the two faces, 0 if they are perpendicular.
        Planes whose product it is get a fillet of exactly this radius.
    coefficient : number or expression in letters, optional
        k in (0, 125/72), for G2: without unit; k/rho**4 multiplies the cube, in 1/length**4. By default 1/5.

    Raises
    ------
    RsymError
        For numbers out of these ranges. A letter out of range gives NaN.

    Source: Rvachev (1982), Shapiro (2007), section 3, for the circle.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.conjunction(x, y, system=Rho(2))
    conjunction(x, y, system=Rho(2))
    >>> float(rsym.conjunction(x, y, system=Rho(2)).subs({x: 2, y: 0}).evalf())
    0.0
    """

    keeps_sets: ClassVar[bool] = False
    radius: Any
    continuity: str = "G1"
    cosine: Any = 0
    coefficient: Any = None

    def __post_init__(self) -> None:
        if self.continuity not in CONTINUITIES:
            raise RsymError(f"continuity must be G1 or G2, got {self.continuity!r}", code="continuity")
        if self.continuity == "G1" and self.coefficient is not None:
            raise RsymError("the circular blend has no coefficient", code="parameter", remedy='continuity="G2"')
        coefficient = DEFAULT_COEFFICIENT if self.coefficient is None else self.coefficient
        store = object.__setattr__
        store(self, "radius", in_range(self.radius, "the radius", 0, sp.oo))
        store(self, "cosine", in_range(self.cosine, "the cosine", -1, 1))
        if self.continuity == "G2":
            store(self, "coefficient", in_range(coefficient, "the coefficient", 0, LARGEST_COEFFICIENT))

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """The radius, the cosine and for G2 the coefficient."""
        return (self.radius, self.cosine) if self.continuity == "G1" else (self.radius, self.cosine, self.coefficient)

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Positive where every operand is, less the edges; folded from the left."""
        return (CircularConjunction if self.continuity == "G1" else CubicConjunction)(*self.parameters, *operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Positive where some operand is, with the inner edges filled; folded from the left."""
        return (CircularDisjunction if self.continuity == "G1" else CubicDisjunction)(*self.parameters, *operands)


class RhoOperation(BlendOperation):
    """Outside the tube the operation of R_alpha, alpha the cosine; inside it the edge is rounded.

    Smaller than that conjunction or equal to it, so f and g are positive where it
    is; monotone in both. Outside the tube it keeps the order of R_alpha.
    """

    @property
    def tube(self) -> sp.Expr:
        """T - (rho*(1 - cosine))**2 of the first two operands: zero where the fillet ends, negative inside."""
        return self._square(*self.operands[:2]) - self._reach**2

    @property
    def guarantee(self) -> str:
        """What is promised of the fillet."""
        radius, cosine, *rest = self.parameters
        faces = "at right angles" if cosine == 0 else f"whose unit normals have the product {cosine}"
        if rest:
            return f"fillet between the ends of a circle of radius {radius}, faces {faces}: G2"
        return (
            f"circular fillet of radius {radius} between faces {faces}: G1, curvature jumps by 1/radius where it ends"
        )

    @property
    def _reach(self) -> sp.Expr:
        return self.parameters[0] * (1 - self.parameters[1])

    def _square(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        cosine = self.parameters[1]
        # As a sum of squares it is never negative, whatever is rounded.
        return f**2 + g**2 if cosine == 0 else ((1 - cosine) * (f + g) ** 2 + (1 + cosine) * (f - g) ** 2) / 2

    def conjunction_of(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The blend of two operands."""
        return where_legal(self.legal(), self.blended(f, g))

    def blended(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The conjunction where the parameters are legal."""
        raise NotImplementedError

    def gates(self, operands: Sequence[sp.Expr]) -> sp.Expr:
        """Smooth operands stay in one function: the fillet joins them without an edge."""
        return super().gates(operands) if any(operand.has(ROperation) for operand in operands) else self

    def conjunction_gates(self, values: Pair, signs: Pair) -> sp.Expr:
        """Both operands, and outside the tube or inside the fillet."""
        outside = self._square(*values) - self._reach**2
        return R1Conjunction(*signs, R1Disjunction(outside, where_legal(self.legal(), self.blended(*values))))

    def sharp(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The conjunction without a blend."""
        cosine = self.parameters[1]
        return R0Conjunction(f, g) if cosine == 0 else RAlphaConjunction(cosine, f, g)

    def legal(self) -> list[sp.Expr]:
        """What must be positive."""
        radius, cosine, *_ = self.parameters
        return [radius, 1 - cosine**2]

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (f + g + s*sqrt(T + q))/(1 + c), s = -1 for conjunction."""
        square = self._square(f, g)
        return (f + g + self.sign * sp.sqrt(square + self.lift(square - self._reach**2))) / (1 + self.parameters[1])

    def lift(self, s: sp.Expr) -> sp.Expr:
        """The term q that rounds the edge, s = T - t**2."""
        raise NotImplementedError

    def system_latex(self, printer: Any) -> str:
        """Return _{rho=1/5} and the like."""
        names = ["rho", "c", "k"][: len(self.parameters)]
        shown = [(name, value) for name, value in zip(names, self.parameters, strict=True) if (name, value) != ("c", 0)]
        return infix_index(shown, printer)

    def system_text(self, printer: Any) -> str:
        """Return Rho(radius) with what is not by default."""
        radius, cosine, *rest = self.parameters
        texts = [printer._print(radius)]
        texts += ['"G2"'] if rest else []
        texts += [f"cosine={printer._print(cosine)}"] if cosine != 0 else []
        texts += [f"coefficient={printer._print(k)}" for k in rest if k != DEFAULT_COEFFICIENT]
        return f"Rho({', '.join(texts)})"


class CircularOperation(RhoOperation):
    """G1: inside the tube the normalised disc that touches both faces.

    Once continuously differentiable, second derivatives jump on `tube` = 0;
    analytic elsewhere, f = g = 0 included. Of three operands and more, the distance from the rounded edge of the first
    is blended with the next: values inside the tube of the first edge are no distances, and corners would not be balls.
    """

    parameter_count = 2

    def carried(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The distance from the rounded edge: ball to the next operand, where the disc would be an egg."""
        return self.rounded(f, g) if self.sign < 0 else -self.rounded(-f, -g)

    def rounded(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Of distances the distance: rho - sqrt(u**2 + v**2 - 2*c*u*v)/sqrt(1 - c**2), u = rho - f and v = rho - g.

        So where the nearest point lies on the fillet, u > c*v and v > c*u; elsewhere the smaller of f and g.
        Associative for faces at right angles.
        """
        rho, cosine = self.parameters
        u, v = rho - f, rho - g
        square = ((u - cosine * v) ** 2 + (1 - cosine**2) * v**2) / (1 - cosine**2)
        edge, faces = rho - sp.sqrt(square), R1Conjunction(f, g)
        return Choice(u, cosine * v, Choice(v, cosine * u, edge, faces), faces)

    def gates(self, operands: Sequence[sp.Expr]) -> sp.Expr:
        """Every face and, for two and three of them that are near, the cylinder or the ball that touches them."""
        (rho, cosine), lengths = self.parameters, [-self.sign * operand for operand in self.operands]
        edged = len(lengths) > 2 or any(operand.has(sp.Abs) for operand in lengths)
        if cosine != 0 or not edged or rho.free_symbols:
            return super().gates(operands)
        gates = [-self.sign * operand for operand in operands]
        for count in (2, 3):
            for chosen in combinations(lengths, count):
                beyond = [f - rho for f in chosen]
                touching = rho / 2 - sp.Add(*(u**2 for u in beyond)) / (2 * rho)
                gates.append(R1Disjunction(*beyond, touching))
        return -self.sign * R1Conjunction(*gates)

    def as_roots(self) -> sp.Expr:
        """The formula as books have it, of what is carried and the last operand."""
        if len(self.operands) == 2:
            return super().as_roots()
        carried = self.carried(*self.operands[:2])
        for operand in self.operands[2:-1]:
            carried = self.carried(carried, operand)
        return self.pair_as_roots(expand_nodes(written_out(carried)), self.operands[-1])

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The formula of numbers."""
        return self.func(*arguments).composition().evalf(arguments[0]._prec // 3)

    def blended(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Near the edge the disc, elsewhere sharp(f, g) - max(t - r, 0)**2/(2*t*(1 + c)), r = sqrt(T).

        They are the same inside the tube. The first is smooth where f = g = 0; the second keeps the sign of small
        operands and shows how it joins. Where they change the disc is negative: the boundary is elsewhere.
        """
        cosine, square, reach = self.parameters[1], self._square(f, g), self._reach
        depth = reach - sp.sqrt(square)
        # Not Max: its derivative is undefined where depth = 0. In this order NaN in the depth gives NaN.
        lift = Choice(0, depth, 0, depth) ** 2 / (2 * reach * (1 + cosine))
        near = (1 - cosine) * reach**2 / 16
        return Choice(near, square, self._disc(f, g), self.sharp(f, g) - lift)

    def _disc(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """(rho**2 - (f - rho)**2 - (g - rho)**2)/(2*rho), in the metric of the cosine, as a sum of squares.

        For perpendicular faces each operand stands in it once, so its interval image is exact.
        """
        rho, cosine = self.parameters
        if cosine == 0:
            return (rho**2 - (f - rho) ** 2 - (g - rho) ** 2) / (2 * rho)
        across, along = (f - g) ** 2 / (1 - cosine), (f + g - 2 * rho) ** 2 / (1 + cosine)
        return rho / 2 - (across + along) / (4 * rho)

    def lift(self, s: sp.Expr) -> sp.Expr:
        """s*(s - |s|)/(8*t**2)."""
        return s * (s - sp.Abs(s, evaluate=False)) / (8 * self._reach**2)


class CubicOperation(RhoOperation):
    """G2: twice continuously differentiable everywhere; third derivatives jump on `tube` = 0, else analytic."""

    parameter_count = 3

    def legal(self) -> list[sp.Expr]:
        """What must be positive."""
        k = self.parameters[2]
        return [*super().legal(), k, LARGEST_COEFFICIENT - k]

    def blended(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Near the edge (f + g - R)/(1 + c), R = sqrt(T + q), elsewhere sharp(f, g) - q/((1 + c)*(R + sqrt(T))).

        They are the same; the first is smooth where f = g = 0, the second keeps the sign of small operands.
        Where they change, T + q > 2*T >= (f + g)**2, so the boundary is elsewhere.
        """
        _, cosine, k = self.parameters
        square, reach = self._square(f, g), self._reach
        depth = reach**2 - square
        # Not Max: its derivative is undefined where depth = 0. In this order NaN in the depth gives NaN.
        lift = k * Choice(0, depth, 0, depth) ** 3 / reach**4
        size, bare = sp.sqrt(square + lift), sp.sqrt(square)
        near = (f + g - size) / (1 + cosine)
        # The bound holds wherever `far` is chosen; it keeps intervals of the quotient finite.
        both = R1Disjunction(size + bare, sp.sqrt(k) * reach / 2)
        far = self.sharp(f, g) - lift / ((1 + cosine) * both)
        return Choice(k * reach**2 / 16, square, near, far)

    def lift(self, s: sp.Expr) -> sp.Expr:
        """k*max(-s, 0)**3/t**4."""
        return self.parameters[2] * ((sp.Abs(s, evaluate=False) - s) / 2) ** 3 / self._reach**4


class CircularConjunction(CircularOperation):
    """Conjunction with a circular edge."""

    sign = -1


class CircularDisjunction(CircularOperation):
    """Disjunction with a circular fillet."""

    sign = 1


class CubicConjunction(CubicOperation):
    """Conjunction with an edge of continuous curvature."""

    sign = -1


class CubicDisjunction(CubicOperation):
    """Disjunction with a fillet of continuous curvature."""

    sign = 1
