"""The plain SymPy route: a shape as a function made by `sympy.lambdify`.

The shape is lowered to a program, differentiated there, and every node goes
back to SymPy as one assignment: SymPy prints them and NumPy runs them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol
from rsym.program.fields import checked_fields, gather, program_of
from rsym.program.operations import OPERATIONS
from rsym.program.program import Program
from rsym.program.raising import raised_node

# What NumPy has no function of is computed by its plain meaning.
_MISSING = {
    name: partial(row.meaning, np)
    for name, row in OPERATIONS.items()
    if isinstance(row.formula, type) and row.formula.__name__ == name and not hasattr(np, name)
}
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
    raw = sp.lambdify(
        arguments, outputs, modules=[_MISSING, "numpy"], cse=lambda expressions: (assignments, expressions)
    )
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
    for number, node in enumerate(program.nodes):
        arguments = node.arguments
        expression = raised_node(node, [values[argument] for argument in arguments])
        if node.operation in {"const", "input"}:
            values.append(expression)
        else:
            symbol = real_symbol(f"_{number}")  # a name that no model can use
            assignments.append((symbol, expression))
            values.append(symbol)
            done = [a for a in dict.fromkeys(arguments) if last_use[a] == number and a not in outputs]
            assignments.extend(
                (values[a], None) for a in done if values[a].is_Symbol and values[a].name.startswith("_")
            )
    return assignments, [values[number] for _, number in program.outputs]
