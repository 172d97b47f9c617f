"""R-nodes: one SymPy function per operation and system, never expanded on its own.

A node is n-ary and flat and *means* the left fold: R_0 is not associative, so
neither the order nor the grouping of its operands is ever changed. Last come equivalence and joining, whose zero set
is the union of the zero sets of their operands.
"""

from __future__ import annotations

from typing import Any, ClassVar

import sympy as sp

from rsym.model.nodes import Ahead, Fold
from rsym.model.powers import absolute_power, plain_absolute_power, signed_power


class ROperation(Fold):
    """A conjunction or disjunction: parameters of the system first, then two or more operands."""

    sign: ClassVar[int]  # -1 for conjunction, +1 for disjunction
    # The order of normalisation that it keeps, of one that is analytic but where f = g = 0 and not promised otherwise.
    kept: ClassVar[int | None] = None

    def infix(self, printer: Any) -> str:
        """A wedge or a vee with the indices of the system."""
        return (r"\wedge" if self.sign < 0 else r"\vee") + self.system_latex(printer)

    def system_latex(self, printer: Any) -> str:
        """The indices of the symbol that name the system."""
        raise NotImplementedError

    def system_text(self, printer: Any) -> str:
        """What `system=` would be given."""
        raise NotImplementedError

    def _sympystr(self, printer: Any) -> str:
        name = "conjunction" if self.sign < 0 else "disjunction"
        operands = ", ".join(printer._print(operand) for operand in self.operands)
        system = self.system_text(printer)
        return f"{name}({operands}{system and f', system={system}'})"


class R0Operation(ROperation):
    """System R_0: f + g -+ sqrt(f**2 + g**2)."""

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return f + g + s*sqrt(f**2 + g**2), s = -1 for conjunction."""
        return f + g + self.sign * sp.sqrt(f**2 + g**2)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return 1 + s*f/sqrt(f**2 + g**2)."""
        return 1 + self.sign * f / sp.sqrt(f**2 + g**2)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """Where the terms cancel, the product form 2 f g / (f + g - s r)."""
        root, total = sp.sqrt(f**2 + g**2), f + g
        cancels = total * self.sign < 0
        return 2 * f * g / (total - self.sign * root) if cancels else total + self.sign * root

    def system_latex(self, printer: Any) -> str:
        """Return _0."""
        return "_0"

    def system_text(self, printer: Any) -> str:
        """Return nothing: R_0 is the default."""
        return ""


class R0Conjunction(R0Operation):
    """Conjunction of system R_0."""

    sign = -1
    runtime_name = "r0_conjunction"


class R0Disjunction(R0Operation):
    """Disjunction of system R_0."""

    sign = 1
    runtime_name = "r0_disjunction"


class R1Operation(ROperation):
    """System R_1: (f + g -+ |f - g|)/2, that is min and max."""

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (f + g + s*|f - g|)/2, s = -1 for conjunction."""
        return (f + g + self.sign * sp.Abs(f - g, evaluate=False)) / 2

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return 1 where f decides, 0 where g does, undefined on f = g."""
        return Ahead(g, f) if self.sign < 0 else Ahead(f, g)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The smaller or the larger."""
        return min(f, g) if self.sign < 0 else max(f, g)

    def system_latex(self, printer: Any) -> str:
        """Return _1."""
        return "_1"

    def system_text(self, printer: Any) -> str:
        """Return R1."""
        return "R1"


class R1Conjunction(R1Operation):
    """Conjunction of system R_1."""

    sign = -1
    runtime_name = "r1_conjunction"


class R1Disjunction(R1Operation):
    """Disjunction of system R_1."""

    sign = 1
    runtime_name = "r1_disjunction"


class RAlphaOperation(ROperation):
    """System R_alpha: (f + g -+ sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha)."""

    parameter_count = 1

    def _root(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        return sp.sqrt(f**2 + g**2 - 2 * self.parameters[0] * f * g)

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (f + g + s*r)/(1 + alpha), r the root, s = -1 for conjunction."""
        return (f + g + self.sign * self._root(f, g)) / (1 + self.parameters[0])

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (1 + s*(f - alpha*g)/r)/(1 + alpha)."""
        alpha = self.parameters[0]
        return (1 + self.sign * (f - alpha * g) / self._root(f, g)) / (1 + alpha)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """Where the terms cancel, the product form 2 f g / (f + g - s r); the radicand as a sum of squares."""
        (alpha,) = parameters
        root, total = sp.sqrt((f - alpha * g) ** 2 + (1 - alpha) * (1 + alpha) * g**2), f + g
        if total * self.sign < 0:
            return 2 * f * g / (total - self.sign * root)
        return (total + self.sign * root) / (1 + alpha)

    def system_latex(self, printer: Any) -> str:
        """Return _{alpha=1/2} and the like."""
        return f"_{{{_named(r'alpha', self.parameters[0], printer)}}}"

    def system_text(self, printer: Any) -> str:
        """Return RAlpha(alpha)."""
        return f"RAlpha({printer._print(self.parameters[0])})"


class RAlphaConjunction(RAlphaOperation):
    """Conjunction of system R_alpha."""

    sign = -1
    runtime_name = "r_alpha_conjunction"


class RAlphaDisjunction(RAlphaOperation):
    """Disjunction of system R_alpha."""

    sign = 1
    runtime_name = "r_alpha_disjunction"


class R0mOperation(R0Operation):
    """System R_0^m: (f + g -+ sqrt(f**2 + g**2))*(f**2 + g**2)**(m/2), the operation of R_0 times a power."""

    parameter_count = 1

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (f + g + s*r)*r**m with r = sqrt(f**2 + g**2), s = -1 for conjunction."""
        return super().pair_as_roots(f, g) * (f**2 + g**2) ** (self.parameters[0] / 2)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return (1 + s*f/r)*r**m + m*f*(f + g + s*r)*r**(m - 2)."""
        m, squares = self.parameters[0], f**2 + g**2
        change = m * f * super().pair_as_roots(f, g) * squares ** ((m - 2) / 2)
        return super().partial(f, g) * squares ** (m / 2) + change

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The operation of R_0, free of cancellation, times r**m."""
        return super().pair_numeric(f, g) * sp.sqrt(f**2 + g**2) ** parameters[0]

    def system_latex(self, printer: Any) -> str:
        """Return _0^m."""
        return f"_{{0}}^{{{printer._print(self.parameters[0])}}}"

    def system_text(self, printer: Any) -> str:
        """Return R0m(m)."""
        return f"R0m({printer._print(self.parameters[0])})"


class R0mConjunction(R0mOperation):
    """Conjunction of system R_0^m."""

    sign = -1
    runtime_name = "r0m_conjunction"


class R0mDisjunction(R0mOperation):
    """Disjunction of system R_0^m."""

    sign = 1
    runtime_name = "r0m_disjunction"


class RpOperation(ROperation):
    """System R_p: f + g -+ (|f|**p + |g|**p)**(1/p)."""

    parameter_count = 1

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return f + g + s*(|f|**p + |g|**p)**(1/p), s = -1 for conjunction."""
        (p,) = self.parameters
        return f + g + self.sign * (plain_absolute_power(f, p) + plain_absolute_power(g, p)) ** (1 / p)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return 1 + s*sign(f)*(|f|/r)**(p - 1), r the root."""
        (p,) = self.parameters
        powers = absolute_power(f, p) + absolute_power(g, p)
        return 1 + self.sign * signed_power(f, p - 1) * powers ** ((1 - p) / p)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """With b the larger in size, a the other, r = |b|(1 + e): a + s*|b|*e or a + s*|b|*(2 + e), never a difference.

        e = (1 + |a/b|**p)**(1/p) - 1 is taken with as many more bits as the subtraction costs.
        """
        (p,) = parameters
        large, small = (f, g) if abs(f) > abs(g) else (g, f)
        if large == 0:
            return small
        power = abs(small / large) ** p
        lost = 0 if power == 0 else max(0, -int(sp.log(power, 2).evalf(5)))
        wide = sp.Float(power, precision=power._prec + lost) if power != 0 else power
        excess = (1 + wide) ** (1 / sp.Float(p, precision=wide._prec)) - 1 if power != 0 else power
        return small - large * excess if self.sign * large < 0 else small + large * (2 + excess)

    def system_latex(self, printer: Any) -> str:
        """Return _{p=4} and the like."""
        return f"_{{{_named('p', self.parameters[0], printer)}}}"

    def system_text(self, printer: Any) -> str:
        """Return Rp(p)."""
        return f"Rp({printer._print(self.parameters[0])})"


class RpConjunction(RpOperation):
    """Conjunction of system R_p."""

    sign = -1
    runtime_name = "rp_conjunction"


class RpDisjunction(RpOperation):
    """Disjunction of system R_p."""

    sign = 1
    runtime_name = "rp_disjunction"


def _named(name: str, parameter: sp.Expr, printer: Any) -> str:
    """The parameter as an index: alpha=1/2, or alpha alone if that is what the letter is called."""
    greek: str = printer._print(sp.Symbol(name))
    return greek if parameter.is_Symbol and parameter.name == name else f"{greek}={printer._print(parameter)}"


class EquivalenceOperation(Fold):
    """f g/(|f|**m + |g|**m)**(1/m) up to sign; associative; with normalised operands normalised to order m."""

    parameter_count = 1

    def _powers(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        (m,) = self.parameters
        return absolute_power(f, m) + absolute_power(g, m)

    def _root(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        (m,) = self.parameters
        return (plain_absolute_power(f, m) + plain_absolute_power(g, m)) ** (1 / m)

    def _size(self, f: sp.Float, g: sp.Float, m: sp.Float) -> sp.Expr:
        """The absolute value: the smaller size over (1 + ratio**m)**(1/m), 0 if one operand is."""
        small, large = sorted((abs(f), abs(g)))
        return sp.S.Zero if small == 0 else small / (1 + (small / large) ** m) ** (1 / m)

    def _sympystr(self, printer: Any) -> str:
        name = type(self).__name__.lower()
        operands = ", ".join(printer._print(operand) for operand in self.operands)
        return f"{name}({operands}, order={printer._print(self.parameters[0])})"


class Equivalence(EquivalenceOperation):
    """f g/(|f|**m + |g|**m)**(1/m): positive where the signs agree."""

    runtime_name = "equivalence"

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The formula."""
        return f * g / self._root(f, g)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return sign(g) (|g|/N)**(m + 1) with N = (|f|**m + |g|**m)**(1/m)."""
        (m,) = self.parameters
        return signed_power(g, m + 1) / self._powers(f, g) ** ((m + 1) / m)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The value, stable at zero."""
        return sp.sign(f) * sp.sign(g) * self._size(f, g, *parameters)

    def infix(self, printer: Any) -> str:
        """A tilde with the order below."""
        return rf"\sim_{{{printer._print(self.parameters[0])}}}"


class Joining(EquivalenceOperation):
    """|f| |g|/(|f|**m + |g|**m)**(1/m): never negative, zero where one operand is."""

    runtime_name = "joining"

    @classmethod
    def alone(cls, operand: sp.Expr) -> sp.Expr:
        """The absolute value."""
        return operand if operand.is_nonnegative else absolute_power(operand, sp.S.One)

    def _eval_is_nonnegative(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The formula."""
        size = [h if h.is_nonnegative else plain_absolute_power(h, sp.S.One) for h in (f, g)]
        return size[0] * size[1] / self._root(f, g)

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """Return sign(f) (|g|/N)**(m + 1) with N = (|f|**m + |g|**m)**(1/m); undefined at f = 0 if f changes sign."""
        (m,) = self.parameters
        sign = sp.S.One if f.is_nonnegative else signed_power(f, sp.S.Zero)
        return sign * absolute_power(g, m + 1) / self._powers(f, g) ** ((m + 1) / m)

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The value, stable at zero."""
        return self._size(f, g, *parameters)

    def infix(self, printer: Any) -> str:
        """A cup with the order below."""
        return rf"\cup_{{{printer._print(self.parameters[0])}}}"
