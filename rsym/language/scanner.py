"""Text to tokens, each with its line and column, and a cursor that goes along them or says what should stand there.

A statement ends at a semicolon or a line end; a line end does not count inside
brackets, nor after a comma, a colon or a binary operator, nor after ``...``.
Statements of MATLAB that say nothing of a shape are passed over: housekeeping, grids of points, drawing.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, NamedTuple, TypeAlias

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
    passed = passed_over(text, position)
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


class Cursor:
    """Reads tokens one after the other and says what is wrong with the next one."""

    def __init__(self, tokens: list[Token]) -> None:
        self._tokens = tokens
        self._index = 0

    @property
    def token(self) -> Token:
        """The next token."""
        return self._tokens[self._index]

    @property
    def following(self) -> Token:
        """The token after the next one."""
        return self._tokens[min(self._index + 1, len(self._tokens) - 1)]

    @property
    def previous(self) -> Token:
        """The token read last."""
        return self._tokens[max(self._index - 1, 0)]

    @property
    def at_end(self) -> bool:
        """Whether the text is over."""
        return self._index == len(self._tokens) - 1

    @property
    def statement_over(self) -> bool:
        """Whether nothing more of the statement follows."""
        return self.token.kind == "end"

    def read(self) -> Token:
        """The next token, and step behind it; the closing one is never left."""
        token = self.token
        self._index = min(self._index + 1, len(self._tokens) - 1)
        return token

    def accept(self, *texts: str) -> Token | None:
        """The next token if it is one of these operators or words."""
        return self.read() if self.token.text in texts else None

    def expect(self, text: str, remedy: str) -> Token:
        """The next token, which must be this one."""
        if self.token.text == text:
            return self.read()
        raise self.unexpected(f"'{text}'", remedy)

    def expect_kind(self, kind: Kind, what: str, remedy: str) -> Token:
        """The next token, which must be of this kind."""
        if self.token.kind == kind:
            return self.read()
        raise self.unexpected(what, remedy)

    def close(self, opening: Token, text: str) -> Token:
        """The bracket that closes `opening`."""
        if self.token.text == text:
            return self.read()
        token = self.token
        if token.kind == "end" or token.text == "=" or token.place.line > self.previous.place.line:
            raise opening.place.refuse(
                f"the bracket {opening.shown} opened here is not closed", "unclosed", f"add the missing '{text}'"
            )
        raise self.unexpected(f"an operator or '{text}'", "write * for a product, and close every bracket")

    def unexpected(self, what: str, remedy: str) -> Exception:
        """The error of a next token that does not fit: unfinished, a decimal comma, or anything else."""
        if comma := self.decimal_comma(self._index, self._index + 1):
            return comma
        if self.token.kind == "end":
            return self.previous.place.refuse(
                f"the statement stops after {self.previous.shown}, where {what} must follow", "unfinished", remedy
            )
        return self.token.place.refuse(f"expected {what}, got {self.token.shown}", "syntax", remedy)

    def decimal_comma(self, start: int | None = None, stop: int | None = None) -> Exception | None:
        """The error of the first comma that stands tight between two numbers, if any; by default the comma just read.

        A comma between digits may separate arguments, so callers ask only where something is wrong already.
        """
        start = self._index - 1 if start is None else start
        for index in range(max(start, 1), min(self._index if stop is None else stop, len(self._tokens) - 1)):
            before, comma, after = self._tokens[index - 1 : index + 2]
            if comma.text == "," and _tight(before, comma) and _tight(comma, after):
                return comma.place.refuse(
                    f"'{before.text},{after.text}' has a decimal comma",
                    "decimal-comma",
                    f"write {before.text}.{after.text}; to separate two numbers put a space behind the comma",
                )
        return None

    def mark(self) -> int:
        """The index of the next token, for `decimal_comma` and `written`."""
        return self._index

    def written(self, start: int) -> str:
        """The words from a mark to the last that was read, as they stand, without comments and ends of lines."""
        words = self._tokens[start : self._index]
        gaps = [" " * (not _touching(*pair)) for pair in pairwise(words)]
        return "".join(word.text + gap for word, gap in zip(words, [*gaps, ""], strict=True))


def _tight(left: Token, right: Token) -> bool:
    return _touching(left, right) and "number" in (left.kind, right.kind)


def _touching(left: Token, right: Token) -> bool:
    return right.place == Position(left.place.line, left.place.column + len(left.text))


HOUSEKEEPING = ("clear", "clearvars", "clc", "close", "format", "more")
DRAWING = (
    *("figure", "hold", "axis", "contour", "contourf", "contour3", "surf", "surfc", "mesh", "meshc", "plot", "plot3"),
    *("fimplicit", "fimplicit3", "ezplot", "isosurface", "patch", "colorbar", "colormap", "shading", "title"),
    *("xlabel", "ylabel", "zlabel", "legend", "view", "camlight", "lighting", "print", "saveas", "drawnow", "grid"),
    *("subplot", "set", "disp", "fprintf", "pause"),
)
UNSUPPORTED = ("while", "if", "else", "elseif", "function", "switch", "try", "return", "global")

# To the end of the statement; a semicolon in brackets or in a text does not end it.
# Nothing is tried twice: a text without its bracket must not be searched for ever. As groups, for Python 3.11.2 takes
# "(?:...)*+" for more than it is.
_GOES_ON = r"\.\.\.[^\n]*\n"
_BRACKETS = rf"\((?>(?:{_GOES_ON}|[^()\n]|\((?>(?:{_GOES_ON}|[^()\n])*)\))*)\)"
_REST = rf"""(?>(?:"[^"\n]*"|'[^'\n]*'|{_BRACKETS}|\[(?>(?:{_GOES_ON}|[^\]\n])*)\]|{_GOES_ON}|[^;\n%#"'(\[])*)"""
_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
_WORDS = re.compile(rf"({'|'.join((*HOUSEKEEPING, *DRAWING))})\b(?![ \t]*=(?!=))({_REST})")
_GRID = re.compile(rf"\[([^\]\n]*)\][ \t]*=[ \t]*(meshgrid|ndgrid)\b({_REST})")
_RUN = re.compile(
    rf"([A-Za-z]\w*)[ \t]*=[ \t]*(?:linspace\b{_REST}"
    rf"|\[?{_NUMBER}[ \t]*:[ \t]*{_NUMBER}(?:[ \t]*:[ \t]*{_NUMBER})?\]?(?=[ \t]*(?:[;\n%#]|$)))"
)
_ENDS = re.compile(
    rf"({_NUMBER})[ \t]*:(?:[ \t]*{_NUMBER}[ \t]*:)?[ \t]*({_NUMBER})"
    rf"|linspace\([ \t]*({_NUMBER})[ \t]*,[ \t]*({_NUMBER})"
)


class Passed(NamedTuple):
    """Where a statement ends, and what to tell whoever wrote it."""

    end: int
    note: str = ""


def passed_over(text: str, position: int) -> Passed | None:
    """The statement that begins here, if it is one that says nothing of a shape.

    Examples
    --------
    >>> passed_over("clear all; w = x", 0)
    Passed(end=9, note='')
    >>> passed_over("[x, y] = meshgrid(-5:0.1:5, -4:0.1:4);", 0).note
    'meshgrid is passed over, rsym takes its own points; the box of pictures is said by: bounds x [-5, 5] y [-4, 4]'
    >>> passed_over("w = x", 0)
    """
    if found := _WORDS.match(text, position):
        word = found.group(1)
        note = f"{word} is passed over: a model says what a shape is; rsym fields and rsym mesh draw it"
        return Passed(found.end(), "" if word in HOUSEKEEPING else note)
    if found := _GRID.match(text, position):
        names = re.findall(r"\w+", found.group(1))
        return Passed(found.end(), _said(found.group(2), names, found.group(3)))
    if found := _RUN.match(text, position):
        return Passed(found.end(), _said(f"a row of values of {found.group(1)}", [found.group(1)], found.group()))
    return None


def _said(what: str, names: list[str], text: str) -> str:
    ends = [tuple(filter(None, groups)) for groups in _ENDS.findall(text)]
    if len(ends) == 1 < len(names):
        ends *= len(names)  # meshgrid(v) is meshgrid(v, v)
    known = len(ends) == len(names)
    box = zip(names, ends, strict=True) if known else zip(("x", "y"), (("-5", "5"),) * 2, strict=True)
    example = " ".join(f"{name.lower()} [{low}, {high}]" for name, (low, high) in box)
    return f"{what} is passed over, rsym takes its own points; the box of pictures is said by: bounds {example}"
