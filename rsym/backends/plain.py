"""The plain SymPy route: a shape as a function made by `sympy.lambdify`.

The shape is lowered to a program, differentiated there, and every node goes
back to SymPy as one assignment: SymPy prints them and NumPy runs them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from rsym.errors import RsymError
from rsym.model.equivalences import Equivalence, Joining
from rsym.model.nodes import ZeroWith
from rsym.model.powers import absolute_power, signed_power
from rsym.model.requirements import require_shape
from rsym.model.rnodes import (
    R0Conjunction,
    R0Disjunction,
    R0mConjunction,
    R0mDisjunction,
    R1Conjunction,
    R1Disjunction,
    RAlphaConjunction,
    RAlphaDisjunction,
    RpConjunction,
    RpDisjunction,
)
from rsym.model.shape import Shape
from rsym.program.fields import checked_fields, gather, program_of
from rsym.program.program import Program

Fields: TypeAlias = dict[str, NDArray[Any]]


def lambdify(shape: Shape, fields: Sequence[str] = ("value",)) -> Callable[..., Fields]:
    """A function of the coordinates (and ``letters=``) made by `sympy.lambdify` with shared subexpressions.

    It is called like a `Kernel`. Readable, a tenth of the speed; the source is
    in ``function.__doc__``. Fields are those of `compile`.

    Raises
    ------
    RsymError
        For an unknown field or a formula that a program cannot hold.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> function = rsym.lambdify(rsym.Shape(rsym.conjunction(x, y), (x, y)), ("value", "laplacian"))
    >>> function(3.0, [4.0, -4.0])["value"].tolist()
    [2.0, -6.0]
    """
    require_shape(shape)
    names = checked_fields(fields)
    program = program_of(shape, names)
    arguments = [sp.Symbol(name, real=True) for name in (*program.coordinates, *program.letters)]
    assignments, outputs = _assignments(program)
    raw = sp.lambdify(arguments, outputs, modules="numpy", cse=lambda expressions: (assignments, expressions))
    size = len(program.coordinates)

    def function(*coordinates: ArrayLike, letters: Mapping[Any, float] | None = None) -> Fields:
        values = shape.letters.values_with(letters)
        if len(coordinates) != size:
            raise RsymError(f"this function takes {size} coordinates, got {len(coordinates)}", code="arity")
        arrays = np.broadcast_arrays(*(np.asarray(array, np.float64) for array in coordinates))
        with np.errstate(all="ignore"):
            results = raw(*arrays, *(values[name] for name in program.letters))
        full = [np.array(np.broadcast_to(result, arrays[0].shape), np.float64) for result in results]
        return gather(dict(zip((name for name, _ in program.outputs), full, strict=True)), names, size)

    function.__doc__ = raw.__doc__
    return function


def _assignments(program: Program) -> tuple[list[tuple[sp.Symbol, sp.Expr | None]], list[sp.Expr]]:
    """Each node as `symbol = expression`, deleted (None) after its last use, and the outputs."""
    last_use = {argument: number for number, node in enumerate(program.nodes) for argument in node.arguments}
    outputs = {number for _, number in program.outputs}
    values: list[sp.Expr] = []
    assignments: list[tuple[sp.Symbol, sp.Expr | None]] = []
    for number, (operation, arguments, data) in enumerate(program.nodes):
        if operation == "const":
            values.append({"pi": sp.pi, "e": sp.E}[data] if isinstance(data, str) else sp.Rational(data))
        elif operation == "input":
            values.append(sp.Symbol(str(data), real=True))
        else:
            inner = [values[argument] for argument in arguments]
            expression = _formula(operation, inner, data)
            symbol = sp.Symbol(f"_{number}", real=True)  # a name that no model can use
            assignments.append((symbol, expression))
            values.append(symbol)
            done = [a for a in dict.fromkeys(arguments) if last_use[a] == number and a not in outputs]
            assignments.extend(
                (values[a], None) for a in done if values[a].is_Symbol and values[a].name.startswith("_")
            )
    return assignments, [values[number] for _, number in program.outputs]


def _formula(operation: str, inner: list[sp.Expr], data: Any) -> sp.Expr:
    if operation == "powi":
        return inner[0] ** data
    return _FORMULAS[operation](*inner) if data is None else _monomial(*inner, *data)


def _monomial(f: sp.Expr, g: sp.Expr, m: sp.Expr, a: int, b: int, c: int) -> sp.Expr:
    """f**a * g**b * r**(m + c), its limit at r = 0."""
    squares = f**2 + g**2
    limit = sp.Piecewise((0, m + a + b + c > 0), (sp.S.NaN, True))
    return sp.Piecewise((f**a * g**b * squares ** ((m + c) / 2), squares > 0), (limit, True))


def _r0m_partial(f: sp.Expr, g: sp.Expr, m: sp.Expr) -> sp.Expr:
    """The derivative of the conjunction of R_0^m with respect to f, 0 at f = g = 0."""
    squares = f**2 + g**2
    size = sp.sqrt(squares)
    partial = (1 - f / size) * size**m + m * f * (f + g - size) * size ** (m - 2)
    return sp.Piecewise((partial, squares > 0), (0, True))


def _norm(f: sp.Expr, g: sp.Expr, p: sp.Expr) -> sp.Expr:
    return (absolute_power(f, p) + absolute_power(g, p)) ** (1 / p)


def _gap(s: sp.Expr, t: sp.Expr) -> sp.Expr:
    return (sp.sqrt(t**2 + s**2) - t) / 2


_FORMULAS: dict[str, Callable[..., sp.Expr]] = {
    "undefined": lambda: sp.S.NaN,
    "add": lambda a, b: a + b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "pow": lambda a, b: a**b,
    "sqrt": sp.sqrt,
    "abs": sp.Abs,
    "sign": sp.sign,
    "min": R1Conjunction,  # not Min: old versions of SymPy print that of a number and an array as one of a ragged list
    "max": R1Disjunction,
    "select": lambda a, b, yes, no: sp.Piecewise((yes, a > b), (no, True)),
    "sin": sp.sin,
    "cos": sp.cos,
    "exp": sp.exp,
    "log": sp.log,
    "atan2": sp.atan2,
    "r0_conjunction": R0Conjunction,
    "r0_disjunction": R0Disjunction,
    "versine": lambda f, g: 1 - f / sp.sqrt(f**2 + g**2),
    "r_alpha_conjunction": lambda f, g, alpha: RAlphaConjunction(alpha, f, g),
    "r_alpha_disjunction": lambda f, g, alpha: RAlphaDisjunction(alpha, f, g),
    "r0m_conjunction": lambda f, g, m: R0mConjunction(m, f, g),
    "r0m_disjunction": lambda f, g, m: R0mDisjunction(m, f, g),
    "r0m_partial": _r0m_partial,
    "norm": _norm,
    "rp_conjunction": lambda f, g, p: RpConjunction(p, f, g),
    "rp_disjunction": lambda f, g, p: RpDisjunction(p, f, g),
    "rp_versine": lambda f, g, p: 1 - signed_power(f, p - 1) / _norm(f, g, p) ** (p - 1),
    "equivalence": lambda f, g, m: Equivalence(m, f, g),
    "joining": lambda f, g, m: Joining(m, f, g),
    "absolute_power": absolute_power,
    "signed_power": signed_power,
    "gap": _gap,
    "trimming": lambda s, t: sp.sqrt(s + _gap(s, t) ** 2),
    "normalised": lambda f, q: f / sp.sqrt(f**2 + q),
    "zero_with": ZeroWith,
}
