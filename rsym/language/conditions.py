"""The text of a condition on a part of the boundary: a value, or a call of what makes a condition."""

from __future__ import annotations

from rsym.language.expressions import ExpressionParser
from rsym.language.scanner import Cursor, scan
from rsym.language.syntax import ARITIES, Call, ConditionStatement, Position, postorder

# Fewest and most arguments.
CONDITIONS: dict[str, tuple[int, int | None]] = {
    "dirichlet": (1, 1),
    "neumann": (0, 1),
    "robin": (1, 2),
    "constant": (0, 1),
    "clamped": (0, 2),
    "supported": (0, 1),
}
OTHERS = "others"
_EXAMPLE = 'for example: on rim = 0; on "wheel arch" = robin(2, 1); on others = neumann(0)'


def part_named(cursor: Cursor) -> str | None:
    """The name of a part at a cursor, in quotation marks or not; None for the rest."""
    token = cursor.read() if cursor.token.kind in ("name", "text") else None
    if token is None:
        raise cursor.unexpected("the name of a part", _EXAMPLE)
    if token.kind == "name":
        return None if token.text == OTHERS else token.text
    return token.quoted


def conditioned(cursor: Cursor, place: Position, part: str | None) -> ConditionStatement:
    """The statement that ends with ``= value`` or ``= robin(2, 1)`` at a cursor."""
    cursor.expect("=", _EXAMPLE)
    value = ExpressionParser(cursor, {**ARITIES, **CONDITIONS}).expression()
    alone = isinstance(value, Call) and value.function in CONDITIONS
    for inner in postorder(value):
        if isinstance(inner, Call) and inner.function in CONDITIONS and inner is not value:
            raise inner.place.refuse(
                f"{inner.function} is a condition, no number", "condition", f"it stands alone; {_EXAMPLE}"
            )
    if alone:
        assert isinstance(value, Call)
        return ConditionStatement(place, part, value.function, value.parts)
    return ConditionStatement(place, part, "", (value,))


def parse_condition(text: str) -> ConditionStatement:
    """A condition of its own, the name of its part as it stands before the first ``=``; ``...`` is the rest too.

    Examples
    --------
    >>> made = parse_condition("wheel arch = robin(2, 1)")
    >>> made.part, made.kind, len(made.values), parse_condition("... = 0").part
    ('wheel arch', 'robin', 2, None)
    """
    name, equals, _ = text.partition("=")
    name = name.strip()
    if name.startswith('"'):
        cursor = Cursor(scan(text))
        part = part_named(cursor)
    else:
        # Blanks in its place, so that columns are those of the text.
        cursor = Cursor(scan(" " * text.index("=") + text[text.index("=") :] if equals else text))
        part = None if name in (OTHERS, "...") else name
    if not equals or part == "":
        raise Position(1, 1).refuse(f"expected PART=CONDITION, got {text!r}", "syntax", "rim=0, or bore=robin(2, 1)")
    made = conditioned(cursor, Position(1, 1), part)
    if not cursor.at_end:
        raise cursor.unexpected("the end of the condition", "one condition for each part")
    return made
