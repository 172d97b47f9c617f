"""SymPy expressions of parameters and letters: compiled, derivatives to any order included, and entry by entry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.backends.interpreter import CHECK_POINTS, check_at, interpret
from rsym.backends.kernel import checked_threads, compiled, run_in_blocks
from rsym.backends.registry import CompiledFunction, default_backend
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.symbols import as_expression, real_replacements, symbols_of
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower_all
from rsym.program.program import FLOAT64, Program
from rsym.surfaces.parameters import Interval

Order: TypeAlias = tuple[int, ...]


class CompiledFormulas:
    """Expressions of named parameters: one program and one kernel for each set of derivatives asked for.

    Examples
    --------
    >>> from rsym.surfaces.symbols import u, v
    >>> formulas = CompiledFormulas([u * v**2, u + v], ("u", "v"), Letters({}), ((0.0, 1.0), (0.0, 1.0)))
    >>> places = [np.array([2.0, 3.0]), np.array([1.0, 1.0])]
    >>> [part.tolist() for part in formulas.evaluate(places, [(0, 0), (0, 1)], {})]
    [[[2.0, 3.0], [3.0, 4.0]], [[4.0, 1.0], [6.0, 1.0]]]
    """

    def __init__(
        self,
        expressions: Sequence[sp.Expr],
        parameters: tuple[str, ...],
        letters: Letters,
        domain: Sequence[Interval],
    ) -> None:
        self.expressions = tuple(expressions)
        self.parameters = parameters
        self.letters = letters
        self.domain = tuple(domain)
        self._functions: dict[tuple[Order, ...], tuple[Program, CompiledFunction]] = {}
        taken = sorted(set(parameters) & set(letters))
        if taken:
            raise RsymError(
                f"{taken[0]!r} is the name of a letter and of a parameter of the surface",
                code="letter",
                remedy="give the letter another name",
            )

    def __getstate__(self) -> dict[str, Any]:
        """Without machine code, which another process compiles anew."""
        return {**self.__dict__, "_functions": {}}

    def program(self, orders: Sequence[Order]) -> Program:
        """The program of the derivatives, order by order and expression by expression."""
        builder = Builder(self.parameters, tuple(self.letters))
        outputs: dict[str, int] = {}
        values = lower_all(builder, self.expressions)
        for order in orders:
            for number, node in enumerate(values):
                for name, times in zip(self.parameters, order, strict=True):
                    for _ in range(times):
                        node = derivative(builder, node, name)
                outputs[f"{number}{''.join(f'_{times}' for times in order)}"] = node
        return builder.program(outputs)

    def evaluate(self, arrays: Sequence[Floats], orders: Sequence[Order], letters: Mapping[str, float]) -> list[Floats]:
        """The derivatives (*shape, len expressions) of each order, which may be asked for twice; arrays broadcast."""
        wanted = [tuple(order) for order in orders]
        asked = tuple(dict.fromkeys(wanted))
        if asked not in self._functions:
            program = self.program(asked)
            function = compiled(program, default_backend(), FLOAT64, lambda made: self._check(program, made))
            self._functions[asked] = program, function
        program, function = self._functions[asked]
        full = np.broadcast_arrays(*arrays)
        # Side by side in memory, as points are wanted: to bring them there later takes twice as long as all the rest.
        out = np.empty((*full[0].shape, len(asked), len(self.expressions)))
        lines = np.moveaxis(out.reshape(*full[0].shape, len(program.outputs)), -1, 0)
        run_in_blocks(function, full, [letters[name] for name in program.letters], lines, checked_threads(None))
        return [np.ascontiguousarray(out[..., asked.index(order), :]) for order in wanted]

    def interpreted(self, places: Floats, orders: Sequence[Order], letters: Mapping[str, float]) -> Floats:
        """Of functions of one parameter (orders, expressions, places), node by node: nothing is compiled."""
        program = self.program(orders)
        found = interpret(program, {self.parameters[0]: places, **{name: letters[name] for name in self.letters}})
        rows = [np.broadcast_to(found[name], places.shape) for name, _ in program.outputs]
        return np.array(rows).reshape(len(orders), len(self.expressions), len(places))

    def _check(self, program: Program, function: CompiledFunction) -> None:
        generator = np.random.default_rng(19740501)
        points = [generator.uniform(low, high, CHECK_POINTS) for low, high in self.domain]
        check_at(program, function, FLOAT64, points, [float(self.letters[name].default) for name in program.letters])


def real_expressions(
    expressions: Sequence[sp.Expr], parameter: sp.Symbol, names: Sequence[str], letters: Letters, what: str
) -> tuple[list[sp.Expr], Letters]:
    """The expressions in real symbols and one parameter, which may be written by any of the names; and their letters.

    Raises
    ------
    RsymError
        For a symbol that is neither the parameter nor a letter, or a parameter under two names.
    """
    free = {symbol.name for symbol in symbols_of(*expressions)}
    used = sorted(name for name in free if name in names and name not in letters)
    unknown = sorted(free - set(used) - set(letters))
    if any(expression.has(sp.I) for expression in expressions):
        raise RsymError(f"{what} must be real, it has the imaginary unit", code="real", remedy="take its real part")
    if unknown or len(used) > 1:
        found = f"the unknown symbol {unknown[0]!r}" if unknown else f"the parameters {' and '.join(used)}"
        raise RsymError(
            f"{what} has one parameter, written {' or '.join(names)}, and letters; it has {found}",
            code="unknown-letter",
            remedy=f"declare it: letters={{{unknown[0]!r}: number}}" if unknown else "write it in one parameter",
        )
    changes: dict[Any, Any] = dict(real_replacements(expressions))
    if used and used[0] != parameter.name:
        changes |= {symbol: parameter for symbol in symbols_of(*expressions) if symbol.name == used[0]}
    replaced = [expression.xreplace(changes) for expression in expressions]
    return replaced, Letters({name: letters[name] for name in letters if name in free})


def exact(value: float) -> sp.Expr:
    """The shortest decimal that is this float64, as a fraction.

    Examples
    --------
    >>> exact(0.1), exact(3.0)
    (1/10, 3)
    """
    if not np.isfinite(value):
        raise RsymError(f"a finite number is expected, got {value!r}", code="number", remedy="mend the number")
    return sp.Rational(repr(float(value)))


def entries_of(array: sp.NDimArray) -> list[sp.Expr]:
    """The entries of an array in their order; of one without axes its only entry."""
    return list(sp.flatten(array.tolist())) if array.shape else [array[()]]


def entries_and_shape(given: Any) -> tuple[list[sp.Expr], tuple[int, ...]]:
    """A nested sequence, matrix or array of expressions as a list and its shape."""
    if isinstance(given, sp.MatrixBase) and 1 in given.shape:
        given = list(given)
    if isinstance(given, sp.Expr):
        return [given], ()
    if isinstance(given, sp.NDimArray) and not given.shape:
        return [as_expression(given[()])], ()
    array = np.array(given.tolist() if isinstance(given, sp.MatrixBase | sp.NDimArray) else given, dtype=object)
    return [as_expression(entry) for entry in array.flat], array.shape
