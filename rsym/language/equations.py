"""The text of a differential equation to a syntax tree: two sides, with the operators that formulas do not have."""

from __future__ import annotations

from rsym.language.expressions import ExpressionParser
from rsym.language.scanner import Cursor, scan
from rsym.language.syntax import ARITIES, EquationStatement, Expression, Position

UNKNOWN = "u"

# Fewest and most arguments.
OPERATORS: dict[str, tuple[int, int | None]] = {
    "grad": (1, 1),
    "div": (1, 1),
    "laplacian": (1, 1),
    "bilaplacian": (1, 1),
    "dot": (2, 2),
    "diff": (2, None),
}
_EXAMPLE = 'for example "-div(k*grad(u)) + c*u = f"'


def parse_equation(text: str) -> tuple[Expression, Expression]:
    """The two sides of an equation.

    Examples
    --------
    >>> left, right = parse_equation("-laplacian(u) = 2*x")
    >>> left.parts[0].function, [part.parts for part in right.parts]
    ('laplacian', [(), ()])
    """
    cursor = Cursor(scan(text.strip()))
    both = sides(cursor)
    if not cursor.at_end:
        raise cursor.unexpected("the end of the equation", _EXAMPLE)
    return both


def parse_statement(text: str) -> EquationStatement:
    """An equation of its own as the statement of a model that it is.

    Examples
    --------
    >>> parse_statement(" -laplacian(u) = 2").text
    '-laplacian(u) = 2'
    """
    left, right = parse_equation(text)
    return EquationStatement(Position(1, 1), left, right, text.strip())


def sides(cursor: Cursor) -> tuple[Expression, Expression]:
    """The two sides of an equation that begins at a cursor."""
    parser = ExpressionParser(cursor, {**ARITIES, **OPERATORS}, vectors=True)
    left = parser.expression()
    cursor.expect("=", _EXAMPLE)
    return left, parser.expression()
