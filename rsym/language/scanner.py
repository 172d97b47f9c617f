"""Text to tokens, each with its line and column.

A statement ends at a semicolon or a line end; a line end does not count inside
brackets, nor after a comma, a colon or a binary operator, nor after ``...``.
Statements of MATLAB that only draw, or only make a grid of points, are passed over.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rsym.language import matlab
from rsym.language.syntax import Position

LONGEST_TEXT = 200_000  # characters
MOST_TOKENS = 20_000
LONGEST_NAME = 32

Kind: TypeAlias = Literal["name", "number", "operator", "text", "end"]

_BLANK = re.compile(r"(?:[ \t]|[%#][^\n]*)+")
_PATTERN = re.compile(
    r"""(?P<number>(?:[0-9]+\.(?![*/^.])[0-9]*|\.[0-9]+|[0-9]+)(?:[eE][+-]?[0-9]+)?)  # 1./x is 1 ./ x
    |(?P<name>[A-Za-z_][A-Za-z0-9_]*)
    |(?P<operator>\*\*|\.\*|\./|\.\^|<=|>=|[-+*/^=()\[\],:<>])
    |(?P<text>"(?:[^"\n]|"")*")
    |(?P<end>[;\n])""",
    re.VERBOSE,
)
_BLOCK_BEGINS = re.compile(r"[ \t]*%\{[ \t]*(?:\n|$)")
_BLOCK = re.compile(r"[ \t]*%\{[ \t]*\n(?:.*\n)*?[ \t]*%\}[ \t]*(?=\n|$)")
_CONTINUES = frozenset(("+", "-", "*", "/", "^", "**", ".*", "./", ".^", ",", ":"))
_ANSWERS = {
    "&": "rsym joins functions, not truth values: write rfAND(f, g); in a condition and(x > 0, y > 0)",
    "|": "rsym joins functions, not truth values: write rfOR(f, g); in a condition or(x > 0, y > 0)",
    "~": "the negation of a function is rfNOT(f), which is -f; that of a condition not(x > 0)",
    "!": "the negation of a function is rfNOT(f), which is -f; that of a condition not(x > 0)",
    "'": 'texts stand in quotation marks: "wheel"',
}
_TWINS = dict(zip("авекмнорстухАВЕКМНОРСТУХіІ−–—×·÷“”„", 'abekmhopctyxABEKMHOPCTYXiI---**/"""', strict=True))


@dataclass(frozen=True, slots=True)
class Token:
    """A word of the text; the last token of a list is always an ``end`` without text."""

    kind: Kind
    text: str
    place: Position

    @property
    def quoted(self) -> str:
        """What a text says; a quotation mark in it is written twice."""
        return self.text[1:-1].replace('""', '"')

    @property
    def shown(self) -> str:
        """As a message names it."""
        return "the end of the statement" if self.kind == "end" else f"'{self.text[:40]}'"


def scan(text: str, notes: list[str] | None = None) -> list[Token]:
    """Split a model text; what is passed over with a word to whoever wrote it is added to `notes`.

    Examples
    --------
    >>> [token.text for token in scan("a = 1./x  % MATLAB")]
    ['a', '=', '1', './', 'x', '']
    """
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    if len(text) > LONGEST_TEXT:
        raise Position(1, 1).refuse(
            f"the text has {len(text)} characters; {LONGEST_TEXT} are the most", "too-large", "split the model"
        )
    tokens: list[Token] = []
    position, line, line_start, brackets = 0, 1, 0, 0
    while position < len(text):
        if end := _passed_over(text, position, line_start, tokens, line, notes):
            if newlines := text.count("\n", position, end):
                line, line_start = line + newlines, text.rindex("\n", position, end) + 1
            position = end
            continue
        place = Position(line, position - line_start + 1)
        match = _PATTERN.match(text, position)
        if match is None:
            raise _bad_character(text[position], place)
        token = Token(match.lastgroup, match.group(), place)  # type: ignore[arg-type]
        position = match.end()
        if token.text == "\n":
            line, line_start = line + 1, position
        brackets = _depth(brackets, token)
        if token.text != "\n" or not (brackets or (tokens and tokens[-1].text in _CONTINUES)):
            tokens.append(_checked(token, len(tokens)))
    return [*tokens, Token("end", "", Position(line, position - line_start + 1))]


def _passed_over(
    text: str, position: int, line_start: int, tokens: list[Token], line: int, notes: list[str] | None
) -> int:
    """Where blanks, comments, continuations and statements that are passed over end; 0 if none begins here."""
    if position == line_start and _BLOCK_BEGINS.match(text, position):
        if block := _BLOCK.match(text, position):
            return block.end()
        raise Position(line, 1).refuse("a block of comments that is not closed", "unclosed", "end it with a line %}")
    if blank := _BLANK.match(text, position):
        return blank.end()
    if text.startswith("...", position):
        return (text.find("\n", position) + 1) or len(text)
    if tokens and tokens[-1].kind != "end":
        return 0
    passed = matlab.passed_over(text, position)
    if passed is not None and passed.note and notes is not None:
        notes.append(f"line {line}: {passed.note}")
    return 0 if passed is None else passed.end


def _depth(brackets: int, token: Token) -> int:
    if token.text in ("(", "["):
        return brackets + 1
    if token.text == ";":
        return 0  # an unclosed bracket is an error of its own statement only
    return max(brackets - (token.text in (")", "]")), 0)


def _checked(token: Token, count: int) -> Token:
    if count >= MOST_TOKENS:
        raise token.place.refuse(f"more than {MOST_TOKENS} words", "too-large", "split the model into several files")
    if token.kind == "name" and (token.text.startswith("_") or len(token.text) > LONGEST_NAME):
        raise token.place.refuse(
            f"{token.shown} is not a name",
            "name",
            f"a name starts with a letter A-Z or a-z and has at most {LONGEST_NAME} letters, digits and underscores",
        )
    return token


def _bad_character(character: str, place: Position) -> Exception:
    if character == '"':
        return place.refuse("a text that is not closed on its line", "unclosed", 'end it with "')
    if character in _ANSWERS:
        return place.refuse(f"the character {character!r} has no meaning here", "character", _ANSWERS[character])
    if character.isascii():
        return place.refuse(
            f"the character {character!r} has no meaning here",
            "character",
            "names, numbers, + - * / ^ = ( ) [ ] , : ; and comments after % or # are understood",
        )
    title = unicodedata.name(character, "unnamed").capitalize()
    twin = _TWINS.get(character)
    return place.refuse(
        f"the character {title} (U+{ord(character):04X}) is not ASCII",
        "non-ascii",
        f"type {twin!r} on a Latin keyboard" if twin else "outside comments and quoted text use ASCII only",
    )
