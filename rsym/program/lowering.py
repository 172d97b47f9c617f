"""From SymPy to a program: one node for each shared part, R-nodes kept.

The walk is iterative: a nest of five hundred R-operations is as good as one. What does not fit is refused by name.

On the way squares are completed. (b - x)*(x - a) uses x twice; interval bounds of it overestimate. As
((b - a)/2)**2 - (x - (a + b)/2)**2 it uses x once and its range is exact.
Only numbers are divided by: a letter as leading coefficient could be zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TypeAlias

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import BooleanAtom, BooleanFunction

from rsym.errors import RsymError
from rsym.model import powers, rnodes
from rsym.model.choices import Choice
from rsym.model.functions import FUNCTIONS
from rsym.model.nodes import Ahead, Composition, Fold, Held, RealNode, Trimming, ZeroWith, written_out
from rsym.model.rewriting import REWRITTEN, in_known_functions
from rsym.model.symbols import postorder
from rsym.program.builder import HALF, Builder
from rsym.program.operations import OPERATIONS

Lowered = Sequence[int]
Names: TypeAlias = dict[int, frozenset[str]]  # of the symbols in each part


def lower(builder: Builder, expression: sp.Expr) -> int:
    """The node that computes the expression.

    Raises
    ------
    RsymError
        For anything that is not a real elementary function of the inputs, by name.
    """
    return lower_all(builder, [expression])[0]


def lower_all(builder: Builder, expressions: Sequence[sp.Expr]) -> list[int]:
    """The nodes that compute the expressions; what they share is walked once."""
    parts = postorder(*expressions)
    if any(isinstance(part, Composition) or type(part) in REWRITTEN for part in parts):
        return lower_all(builder, [in_known_functions(written_out(expression)) for expression in expressions])
    done: dict[int, int] = {}
    inside: Names = {}
    for part in parts:
        inside[id(part)] = _names_inside(part, inside)
        if isinstance(part, Relational | BooleanFunction | BooleanAtom | ExprCondPair):
            continue  # conditions are read by the Piecewise that owns them
        arguments = [done[id(argument)] for argument in part.args if id(argument) in done]
        if isinstance(part, sp.Add):
            done[id(part)] = sum_with_squares_completed(builder, part, arguments, inside)
        else:
            done[id(part)] = _lower_part(builder, part, arguments, done)
    return [done[id(expression)] for expression in expressions]


def _names_inside(part: sp.Basic, inside: Names) -> frozenset[str]:
    """The names of the symbols in a part, from those in its arguments: asked of every term, each walk would be long."""
    if part.is_Symbol:
        return frozenset((part.name,))
    sets = {inside[id(argument)] for argument in part.args}
    return sets.pop() if len(sets) == 1 else frozenset().union(*sets)


def _lower_part(b: Builder, part: sp.Basic, arguments: Lowered, done: dict[int, int]) -> int:
    if isinstance(part, sp.Symbol):
        return _input(b, part)
    if part is sp.nan:
        return b.undefined()  # the derivative of min and max on a tie
    if part.is_Number or isinstance(part, sp.NumberSymbol):
        return _constant(b, part)
    if isinstance(part, sp.Piecewise):
        return _piecewise(b, part, done)
    for kind, function in LOWERINGS.items():
        if isinstance(part, kind):
            return function(b, part, arguments)
    if isinstance(part, RealNode) and part.runtime_name in OPERATIONS:
        return _fold(part.runtime_name)(b, part, arguments)  # the operation of that name, of folds one after the other
    raise RsymError(
        f"a program cannot hold {type(part).__name__}: {sp.sstr(part)[:80]}",
        code="unsupported-function",
        remedy=f"write it with + - * / powers, sqrt, Piecewise, {', '.join(FUNCTIONS)}, and R-operations",
    )


def _input(b: Builder, symbol: sp.Symbol) -> int:
    if symbol.name not in b.coordinates and symbol.name not in b.letters:
        raise RsymError(f"{symbol.name!r} is neither coordinate nor letter", code="unknown-letter")
    return b.input(symbol.name)


def _constant(b: Builder, number: sp.Expr) -> int:
    if isinstance(number, sp.Rational) and number.is_finite:
        return b.const(Fraction(int(number.p), int(number.q)))
    if isinstance(number, sp.Float):
        sign, mantissa, exponent, _ = number._mpf_
        return b.const((-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** int(exponent))
    if number in (sp.pi, sp.E):
        return b.make("const", data="pi" if number == sp.pi else "e")
    if isinstance(number, sp.NumberSymbol):
        return b.const(Fraction(float(number)))
    raise RsymError(f"{number} is not a finite real number", code="number", remedy="remove the division by zero")


def _mul(b: Builder, part: sp.Mul, arguments: Lowered) -> int:
    """Numerator over denominator; f/sqrt(f**2 + q) becomes one node, a product of two linear factors a square."""
    numerator: list[int] = []
    denominator: list[int] = []
    for factor, number in zip(part.args, arguments, strict=True):
        inverse = _reciprocal(b, factor, number)
        if inverse is None:
            numerator.append(number)
        else:
            denominator.append(inverse)
    numerator = two_linear_factors(b, part, arguments, numerator)
    for divisor in list(denominator):
        for position, factor_number in enumerate(numerator):
            unit = b.normalisation(factor_number, divisor)
            if unit is not None:
                numerator[position] = unit
                denominator.remove(divisor)
                break
    top = _product(b, numerator)
    return b.div(top, _product(b, denominator)) if denominator else top


def _reciprocal(b: Builder, factor: sp.Expr, number: int) -> int | None:
    """The node u of a factor 1/u, if it is one."""
    if isinstance(factor, sp.Rational):
        return None
    node = b.nodes[number]
    is_inverse = node.operation == "div" and b.value(node.arguments[0]) == 1
    return node.arguments[1] if is_inverse else None


def _product(b: Builder, factors: Sequence[int]) -> int:
    result = b.const(1)
    for factor in factors:
        result = b.mul(result, factor)
    return result


def _pow(b: Builder, part: sp.Pow, arguments: Lowered) -> int:
    base, exponent = arguments
    if isinstance(part, sp.exp) or part.base == sp.E:
        return b.make("exp", exponent)
    value = b.value(exponent)
    if value is not None and value.denominator == 1 and abs(value) <= 2**31:
        return b.powi(base, int(value))
    if value is not None and value.denominator == 2 and abs(value) <= 2**31:
        root = b.sqrt(base)
        whole, halves = divmod(abs(value.numerator), 2)
        power = b.mul(b.powi(base, whole), root) if whole and halves else root
        return power if value > 0 else b.div(b.const(1), power)
    return b.make("pow", base, exponent)


def _fold(operation: str) -> Callable[[Builder, sp.Basic, Lowered], int]:
    def lowering(b: Builder, part: sp.Basic, arguments: Lowered) -> int:
        if OPERATIONS[operation].arity == 1:
            return b.make(operation, *arguments)
        count = part.parameter_count if isinstance(part, Fold) else 0
        parameters, (result, *rest) = arguments[:count], arguments[count:]
        _check_parameters(b, part, parameters)
        for operand in rest:
            result = b.make(operation, result, operand, *parameters)
        return result

    return lowering


def _check_parameters(b: Builder, part: sp.Basic, parameters: Lowered) -> None:
    if not all(b.uniform[parameter] for parameter in parameters):
        raise RsymError(
            f"the parameter {part.args[0]} of an R-operation varies from point to point",
            code="parameter",
            remedy="use a number or a letter",
        )


def _elementary(operation: str) -> Callable[[Builder, sp.Basic, Lowered], int]:
    return lambda b, part, arguments: b.make(operation, *arguments)


def _trimming(b: Builder, part: Trimming, arguments: Lowered) -> int:
    """The node takes the square of the trimmed function: on a revolved one that is smooth on the axis."""
    f, t = arguments
    return b.make("trimming", b.square(f), t)


def _ahead(b: Builder, part: Ahead, arguments: Lowered) -> int:
    f, g = arguments
    return b.select(f, g, b.const(1), b.select(g, f, b.const(0), b.undefined()))


def _exponentials(b: Builder, u: int) -> tuple[int, int]:
    return b.make("exp", u), b.make("exp", b.neg(u))


def _sinh(b: Builder, part: sp.Basic, arguments: Lowered) -> int:
    up, down = _exponentials(b, arguments[0])
    return b.mul(b.const(HALF), b.sub(up, down))


def _cosh(b: Builder, part: sp.Basic, arguments: Lowered) -> int:
    up, down = _exponentials(b, arguments[0])
    return b.mul(b.const(HALF), b.add(up, down))


def _tanh(b: Builder, part: sp.Basic, arguments: Lowered) -> int:
    """1 - 2/(exp(2u) + 1), which does not overflow to NaN."""
    double = b.make("exp", b.mul(b.const(2), arguments[0]))
    return b.sub(b.const(1), b.div(b.const(2), b.add(double, b.const(1))))


def _complement(b: Builder, u: int) -> int:
    return b.sqrt(b.mul(b.sub(b.const(1), u), b.add(b.const(1), u)))


def _piecewise(b: Builder, part: sp.Piecewise, done: dict[int, int]) -> int:
    """From the last branch inwards; what no condition covers is undefined."""
    result = b.undefined()
    for value, condition in reversed([pair.args for pair in part.args]):
        result = _choose(b, condition, done[id(value)], result, done)
    return result


def _choose(b: Builder, condition: sp.Basic, yes: int, no: int, done: dict[int, int]) -> int:
    """`yes` where the condition holds, `no` where it does not, NaN where it has no truth."""
    if condition in (sp.true, sp.false):
        return yes if condition == sp.true else no
    if isinstance(condition, sp.Not):
        return _choose(b, condition.args[0], no, yes, done)
    if isinstance(condition, sp.ITE):  # of Piecewise inside conditions
        yes, no = (_choose(b, chosen, yes, no, done) for chosen in condition.args[1:])
        return _choose(b, condition.args[0], yes, no, done)
    if isinstance(condition, sp.And | sp.Or):
        is_and = isinstance(condition, sp.And)
        for inner in condition.args:
            yes, no = (_choose(b, inner, yes, no, done), no) if is_and else (yes, _choose(b, inner, yes, no, done))
        return yes if is_and else no
    strict = isinstance(condition, sp.StrictGreaterThan | sp.StrictLessThan)
    if not strict and not isinstance(condition, sp.GreaterThan | sp.LessThan):
        raise RsymError(f"a condition must be made of < <= > >=, and, or, not; got {condition}", code="condition")
    large, small = done[id(condition.gts)], done[id(condition.lts)]
    if strict:
        return b.step(large, small, yes, _unless_nan(b, large, small, no))
    return b.step(small, large, no, _unless_nan(b, large, small, yes))


def _unless_nan(b: Builder, u: int, v: int, value: int) -> int:
    """The value where u - v is a number: |u - v| > -1 is false for NaN alone."""
    gap = b.abs(b.sub(u, v))
    return value if b.value(gap) is not None else b.step(gap, b.const(-1), value, b.undefined())


def two_linear_factors(b: Builder, part: sp.Mul, arguments: Sequence[int], numerator: Sequence[int]) -> list[int]:
    """In a product with just two varying factors p*v + c and q*v + d, p and q numbers, complete the square.

    (p v + c)(q v + d) = p q ((v + s)**2 - h**2), s = (c/p + d/q)/2, h = (c/p - d/q)/2.
    """
    varying = [
        (factor, number)
        for factor, number in zip(part.args, arguments, strict=True)
        if number in numerator and not b.uniform[number]
    ]
    lines = [_line(b, factor) for factor, _ in varying]
    if len(lines) != 2 or lines[0] is None or lines[1] is None or lines[0][0] != lines[1][0]:
        return list(numerator)
    (name, p, c), (_, q, d) = lines[0], lines[1]
    first, second = b.mul(b.const(1 / p), c), b.mul(b.const(1 / q), d)
    half = b.const(Fraction(1, 2))
    shift, reach = b.mul(half, b.add(first, second)), b.mul(half, b.sub(first, second))
    square = b.sub(b.square(b.add(b.input(name), shift)), b.square(reach))
    rest = list(numerator)
    for _, number in varying:
        rest.remove(number)
    return [*rest, b.const(p * q), square]


def _line(b: Builder, factor: sp.Expr) -> tuple[str, Fraction, int] | None:
    """(name, p, c) if the factor is p*v + c with a number p, a coordinate v and c free of coordinates."""
    from_terms = _linear_terms(b, factor)
    if from_terms is None:
        return None
    name, slope, rest = from_terms
    constant = b.const(0)
    for term in rest:
        lowered = _lower_uniform(b, term)
        if lowered is None:
            return None
        constant = b.add(constant, lowered)
    return name, slope, constant


def _linear_terms(b: Builder, factor: sp.Expr) -> tuple[str, Fraction, list[sp.Expr]] | None:
    name, slope, rest = "", Fraction(0), []
    for term in sp.Add.make_args(factor):
        coefficient, bare = term.as_coeff_Mul()
        if bare.is_Symbol and bare.name in b.coordinates and isinstance(coefficient, sp.Rational):
            if name:
                return None
            name, slope = bare.name, Fraction(int(coefficient.p), int(coefficient.q))
        else:
            rest.append(term)
    return (name, slope, rest) if name and slope else None


def _lower_uniform(b: Builder, term: sp.Expr) -> int | None:
    """A rational number, or a rational multiple of a letter."""
    coefficient, bare = term.as_coeff_Mul()
    if not isinstance(coefficient, sp.Rational):
        return None
    factor = b.const(Fraction(int(coefficient.p), int(coefficient.q)))
    if bare == 1:
        return factor
    if bare.is_Symbol and bare.name in b.letters:
        return b.mul(factor, b.input(bare.name))
    return None


def sum_with_squares_completed(b: Builder, part: sp.Add, arguments: Sequence[int], inside: Names) -> int:
    """The sum of the terms in order; p*v**2 + q*v with a number p becomes p*(v + q/(2p))**2 - q**2/(4p)."""
    terms = dict(enumerate(zip(part.args, arguments, strict=True)))
    extra: list[int] = []
    for name in b.coordinates:
        pair = _square_and_line(b, name, [(k, term) for k, (term, _) in terms.items()], inside)
        if pair is not None:
            square_at, leading, line_at, slope = pair
            del terms[square_at], terms[line_at]
            shift = b.mul(b.const(1 / (2 * leading)), slope)
            extra.append(b.mul(b.const(leading), b.square(b.add(b.input(name), shift))))
            extra.append(b.mul(b.const(-leading), b.square(shift)))
    numbers = [number for _, number in terms.values()] + extra
    result = numbers[0]
    for number in numbers[1:]:
        result = b.add(result, number)
    return result


def _square_and_line(
    b: Builder, name: str, terms: Sequence[tuple[int, sp.Expr]], inside: Names
) -> tuple[int, Fraction, int, int] | None:
    square: tuple[int, Fraction] | None = None
    line: tuple[int, int] | None = None
    for position, term in terms:
        coefficient, bare = term.as_coeff_Mul()
        if bare.is_Pow and bare.exp == 2 and bare.base.is_Symbol and bare.base.name == name:
            if square is not None or not isinstance(coefficient, sp.Rational):
                return None
            square = (position, Fraction(int(coefficient.p), int(coefficient.q)))
        elif name in inside[id(term)]:
            slope = _slope(b, name, term)
            if slope is None or line is not None:
                return None  # the coordinate stands elsewhere too: nothing is gained
            line = (position, slope)
    return (*square, *line) if square is not None and line is not None else None


def _slope(b: Builder, name: str, term: sp.Expr) -> int | None:
    """The factor of v in number*v or number*letter*v."""
    factors = [factor for factor in sp.Mul.make_args(term) if not (factor.is_Symbol and factor.name == name)]
    if len(factors) != len(sp.Mul.make_args(term)) - 1:
        return None
    return _lower_uniform(b, sp.Mul(*factors))


LOWERINGS: dict[type[sp.Basic], Callable[..., int]] = {
    sp.Mul: _mul,
    sp.Pow: _pow,
    **{row.kind: _elementary(row.operation) for row in FUNCTIONS.values() if row.operation},
    rnodes.R1Conjunction: _fold("min"),
    rnodes.R1Disjunction: _fold("max"),
    powers.AbsolutePower: lambda b, part, arguments: b.absolute_power(*arguments),
    powers.SignedPower: lambda b, part, arguments: b.signed_power(*arguments),
    Trimming: _trimming,
    Ahead: _ahead,
    ZeroWith: lambda b, part, arguments: b.zero_with(*arguments),
    Choice: lambda b, part, arguments: b.select(*arguments),
    Held: lambda b, part, arguments: arguments[0],
    sp.Min: _fold("min"),
    sp.Max: _fold("max"),
    sp.Abs: lambda b, part, arguments: b.abs(arguments[0]),
    sp.tan: lambda b, part, arguments: b.div(b.make("sin", arguments[0]), b.make("cos", arguments[0])),
    sp.cot: lambda b, part, arguments: b.div(b.make("cos", arguments[0]), b.make("sin", arguments[0])),
    sp.atan: lambda b, part, arguments: b.make("atan2", arguments[0], b.const(1)),
    sp.asin: lambda b, part, arguments: b.make("atan2", arguments[0], _complement(b, arguments[0])),
    sp.acos: lambda b, part, arguments: b.make("atan2", _complement(b, arguments[0]), arguments[0]),
    sp.sinh: _sinh,
    sp.cosh: _cosh,
    sp.tanh: _tanh,
}
