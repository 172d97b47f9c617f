"""Nodes that SymPy keeps whole: what they share, trimming, constants it must not evaluate, and folds of operands."""

from __future__ import annotations

from collections.abc import Container
from typing import Any, ClassVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.symbols import postorder, rebuild, symbols_inside

_RUNTIME = "rsym.backends.runtime."


class RealNode(sp.Function):  # type: ignore[misc]
    """A real function of real arguments, printed as a call to a small runtime function."""

    is_commutative = True
    runtime_name: ClassVar[str] = ""
    of_shapes: ClassVar[bool] = False  # whether operands are shapes, as those of logic

    def __new__(cls, *arguments: Any, **options: Any) -> sp.Expr:
        """Know from the start which symbols are inside: SymPy asks often, and asks by recursion."""
        node = super().__new__(cls, *arguments, **options)
        node._free_symbols = symbols_inside(node.args)
        return node

    @property
    def free_symbols(self) -> set[sp.Basic]:
        """The symbols inside."""
        return set(self._free_symbols)

    @property
    def is_number(self) -> bool:
        """Whether there are none."""
        return not self._free_symbols

    @classmethod
    def _should_evalf(cls, argument: sp.Expr) -> int:
        return -1  # one float among the arguments must not turn the exact numbers beside it into floats

    def _eval_is_real(self) -> bool:
        return True

    def _eval_is_extended_real(self) -> bool:
        return True

    def as_roots(self) -> sp.Expr:
        """The node itself, not what is below it, in plain arithmetic."""
        raise NotImplementedError

    def doit(self, **hints: Any) -> sp.Expr:
        """The whole expression in plain arithmetic, square roots written out."""
        return expand_nodes(self)

    def _eval_evalf(self, precision: int) -> sp.Expr:
        wider = precision + 10
        arguments = [_evaluated(argument, wider) for argument in self.args]
        if not all(argument.is_Float or argument.is_Rational for argument in arguments):
            return self.func(*arguments)
        value = self.numeric([sp.Float(argument, precision=wider) for argument in arguments])
        return value if value is sp.S.NaN else sp.Float(value, precision=precision)

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The value at high precision, free of cancellation."""
        raise NotImplementedError

    def _runtime_call(self, printer: Any) -> str:
        function = printer._module_format(_RUNTIME + self.runtime_name)
        return f"{function}({', '.join(printer._print(argument) for argument in self.args)})"

    _numpycode = _pythoncode = _mpmathcode = _jaxcode = _torchcode = _cupycode = _runtime_call


class Composition(RealNode):
    """A node that stands for a formula in other nodes, kept whole for people and for its contract.

    `written_out` is what is lowered, differentiated and evaluated; a subclass says it once, in `composition`.
    """

    def composition(self) -> sp.Expr:
        """The formula."""
        raise NotImplementedError

    def as_roots(self) -> sp.Expr:
        """The formula, its own nodes in plain arithmetic."""
        return expand_nodes(written_out(self.composition()))

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """Not asked for: derivatives are those of the formula."""
        raise NotImplementedError("differentiate written_out(expression)")

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The formula at high precision."""
        return written_out(self.func(*arguments).composition()).evalf(arguments[0]._prec // 3)

    def _runtime_call(self, printer: Any) -> str:
        text: str = printer._print(self.composition())
        return f"({text})"

    _numpycode = _pythoncode = _mpmathcode = _jaxcode = _torchcode = _cupycode = _runtime_call


class Scaled(Composition):
    """f times a factor that is positive wherever the shape has a boundary: the sign and the zero set are those of f."""

    of_shapes = True

    def composition(self) -> sp.Expr:
        """The product."""
        f, factor = self.args
        return f * factor

    def _sympystr(self, printer: Any) -> str:
        text: str = printer._print(self.composition())
        return text

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = printer._print(self.composition())
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"


class Trimming(RealNode):
    """The curve f = 0 kept where t >= 0: sqrt(f**2 + ((sqrt(t**2 + f**4) - t)/2)**2)."""

    runtime_name, of_shapes = "trimming", True

    def _eval_is_nonnegative(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def as_roots(self) -> sp.Expr:
        """The formula."""
        f, t = self.args
        return sp.sqrt(f**2 + ((sp.sqrt(t**2 + f**4) - t) / 2) ** 2)

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """With q = sqrt(t**2 + f**4), u = (q - t)/2, rho the node: f*(1 + u*f**2/q)/rho and -u**2/(q*rho)."""
        f, t = self.args
        root = sp.sqrt(t**2 + f**4)
        gap = (root - t) / 2
        return f * (1 + gap * f**2 / root) / self if argindex == 1 else -(gap**2) / (root * self)

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The formula, the inner difference without cancellation."""
        f, t = arguments
        root = sp.sqrt(t**2 + f**4)
        gap = (root - t) / 2 if t <= 0 else f**4 / (2 * (root + t))
        return sp.sqrt(f**2 + gap**2)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = rf"\rho\left({printer._print(self.args[0])};\, {printer._print(self.args[1])}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"trimming({', '.join(printer._print(argument) for argument in self.args)})"


class Ahead(RealNode):
    """1 where f > g, 0 where f < g, undefined on f = g: the derivative of max(f, g) with respect to f.

    It is constant wherever it is defined; SymPy's own forms of it lead to Dirac impulses.
    """

    runtime_name = "ahead"

    def as_roots(self) -> sp.Expr:
        """(1 + (f - g)/|f - g|)/2."""
        f, g = self.args
        return (1 + (f - g) / sp.Abs(f - g, evaluate=False)) / 2

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """0."""
        return sp.S.Zero

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """1, 0 or NaN."""
        f, g = arguments
        return sp.S.NaN if f == g else sp.Integer(bool(f > g))

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = rf"\left[{printer._print(self.args[0])} > {printer._print(self.args[1])}\right]"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"ahead({', '.join(printer._print(argument) for argument in self.args)})"


class ZeroWith(RealNode):
    """The value of g, which goes to 0 where f does, and 0 where f = 0, even if g is undefined there.

    Such is the correction of `normalise`: at a corner its derivatives do not exist. It prints as g, and is
    differentiated as g: derivatives that do not exist stay undefined.
    """

    runtime_name = "zero_with"

    def as_roots(self) -> sp.Expr:
        """Return g."""
        return self.args[1]

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """0 for f, 1 for g."""
        return sp.Integer(argindex == 2)

    def _eval_evalf(self, precision: int) -> sp.Expr:
        f, g = self.args
        size = f.evalf(precision // 3)
        return sp.S.Zero if size == 0 else g.evalf(precision // 3)

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = printer._print(self.args[1])
        bare = exp is None and not self.args[1].is_Add
        return text if bare else rf"\left({text}\right)" + ("" if exp is None else f"^{{{exp}}}")

    def _sympystr(self, printer: Any) -> str:
        text = printer._print(self.args[1])
        return f"({text})" if self.args[1].is_Add else text


class Held(RealNode):
    """A number without a rational value, sqrt(2) or sin(pi/7), which SymPy must not evaluate.

    Deciding whether such a number is zero can take SymPy for ever; a model file could make it try.
    """

    is_number = False

    def as_roots(self) -> sp.Expr:
        """What is held."""
        return self.args[0]

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """Its value."""
        return arguments[0]

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """A constant does not change."""
        return sp.S.Zero

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = printer._print(self.args[0])
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        text = printer._print(self.args[0])
        return f"({text})" if self.args[0].args else text

    def _runtime_call(self, printer: Any) -> str:
        return f"({printer._print(self.args[0])})"

    _numpycode = _pythoncode = _mpmathcode = _jaxcode = _torchcode = _cupycode = _runtime_call


def _evaluated(argument: sp.Expr, precision: int) -> sp.Expr:
    value = argument._eval_evalf(precision)
    return argument if value is None else value


def written_out(expression: sp.Expr, kept: Container[type[sp.Basic]] = ()) -> sp.Expr:
    """Replace every composition by its formula, but those of the classes that are kept; other R-nodes stay."""

    def stands_for_another(part: sp.Basic) -> bool:
        return isinstance(part, Composition) and type(part) not in kept

    while any(map(stands_for_another, postorder(expression))):
        expression = rebuild(expression, lambda part: part.composition() if stands_for_another(part) else None)
    return expression


def without_zeros(expression: sp.Expr) -> sp.Expr:
    """Every `ZeroWith` as its second operand, undefined where that is.

    Examples
    --------
    >>> from rsym import x, y
    >>> without_zeros(1 + ZeroWith(x, x**2 / y))
    x**2/y + 1
    """
    return rebuild(expression, lambda part: part.args[1] if isinstance(part, ZeroWith) else None)


def expand_nodes(expression: sp.Expr) -> sp.Expr:
    """Write every R-node out in square roots.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> expand_nodes(rsym.conjunction(x, y))
    x + y - sqrt(x**2 + y**2)
    """
    return rebuild(expression, lambda part: part.as_roots() if isinstance(part, RealNode) else None)


class Fold(RealNode):
    """A symmetric operation on two operands, folded from the left: parameters first, then two or more operands.

    Neither the order nor the grouping of the operands is ever changed.
    """

    of_shapes = True
    parameter_count: ClassVar[int] = 0

    def __new__(cls, *arguments: Any, **options: Any) -> sp.Expr:
        """Flatten on the left, where the fold begins; a single operand is what `alone` makes of it."""
        arguments = tuple(sp.sympify(argument, strict=True) for argument in arguments)
        parameters, operands = arguments[: cls.parameter_count], arguments[cls.parameter_count :]
        if operands and type(operands[0]) is cls and operands[0].parameters == parameters:
            operands = (*operands[0].operands, *operands[1:])
        if len(operands) == 1:
            return cls.alone(operands[0])
        return super().__new__(cls, *parameters, *operands, **options)

    @classmethod
    def alone(cls, operand: sp.Expr) -> sp.Expr:
        """The fold of one operand: itself."""
        return operand

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """alpha, m or p."""
        return tuple(self.args[: self.parameter_count])

    @property
    def operands(self) -> tuple[sp.Expr, ...]:
        """What is combined, in the order of the fold."""
        return tuple(self.args[self.parameter_count :])

    @property
    def head(self) -> sp.Expr:
        """The fold of all operands but the last."""
        return self.func(*self.args[:-1])

    def pair_as_roots(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The operation on two operands in plain arithmetic."""
        raise NotImplementedError

    def partial(self, f: sp.Expr, g: sp.Expr) -> sp.Expr:
        """The derivative of the operation on two operands with respect to the first (it is symmetric)."""
        raise NotImplementedError

    def pair_numeric(self, f: sp.Float, g: sp.Float, *parameters: sp.Float) -> sp.Expr:
        """The operation on two numbers, free of cancellation."""
        raise NotImplementedError

    def as_roots(self) -> sp.Expr:
        """The left fold in plain arithmetic."""
        result, *rest = self.operands
        for operand in rest:
            result = self.pair_as_roots(result, operand)
        return result

    def numeric(self, arguments: list[sp.Float]) -> sp.Expr:
        """The left fold of numbers."""
        parameters = arguments[: self.parameter_count]
        result, *rest = arguments[self.parameter_count :]
        for operand in rest:
            result = self.pair_numeric(result, operand, *parameters)
        return result

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The partial derivative with respect to one operand, nodes kept."""
        if argindex <= self.parameter_count:
            raise RsymError(
                f"{self.args[argindex - 1]} is the parameter of an R-operation, which is not differentiated through",
                code="parameter-derivative",
                remedy="differentiate node.doit(), in which the operation is written out",
            )
        position = argindex - self.parameter_count
        fold, last = self.head, self.operands[-1]
        if position == len(self.operands):
            return self.partial(last, fold)
        outer = self.partial(fold, last)
        if len(self.operands) > 2:
            return outer * fold.fdiff(argindex)
        return outer if fold == self.operands[0] else outer * fold.fdiff()  # its absolute value, say

    def infix(self, printer: Any) -> str:
        """What stands between operands in LaTeX."""
        raise NotImplementedError

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        """Operands that are sums or have a sign need brackets."""
        printed = [(operand, printer._print(operand)) for operand in self.operands]
        parts = [rf"\left({text}\right)" if u.is_Add or u.could_extract_minus_sign() else text for u, text in printed]
        text = rf"\left({f' {self.infix(printer)} '.join(parts)}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"
