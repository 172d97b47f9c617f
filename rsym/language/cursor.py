"""A place in the list of tokens, and the errors of a text that does not go on as it must."""

from __future__ import annotations

from rsym.language.scanner import Kind, Token
from rsym.language.syntax import Position


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
        """The index of the next token, for `decimal_comma`."""
        return self._index


def _tight(left: Token, right: Token) -> bool:
    touching = right.place == Position(left.place.line, left.place.column + len(left.text))
    return touching and "number" in (left.kind, right.kind)
