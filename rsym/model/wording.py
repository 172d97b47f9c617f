"""What a message proposes instead of an unknown word, and how it lists the known ones."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def proposal(name: object, known: Iterable[str], otherwise: str) -> str:
    """A remedy that names the closest known words, or `otherwise` if none is close.

    Examples
    --------
    >>> proposal("rfand", ["rfAND", "rfOR"], "see the list of functions")
    "did you mean 'rfAND'?"
    """
    by_lower = {word.lower(): word for word in known}
    lower = str(name).lower()[:40]
    close = [lower] if lower in by_lower else get_close_matches(lower, by_lower, n=3, cutoff=0.6)
    return f"did you mean {' or '.join(repr(by_lower[word]) for word in close)}?" if close else otherwise


def listing(known: Iterable[str]) -> str:
    """The known words for a message, the first thirty."""
    words = list(known)
    more = f" and {len(words) - 30} more" if len(words) > 30 else ""
    return (", ".join(words[:30]) or "none") + more


def within(texts: Sequence[str], room: int, more: str = "and {} more") -> list[str]:
    """As many texts as there is room for, in characters, the first at least; then how many more there are.

    Examples
    --------
    >>> within(["alpha", "beta", "gamma"], 12)
    ['alpha', 'beta', 'and 1 more']
    """
    shown = list[str]()
    for text in texts:
        room -= len(text) + 1
        if room < 0 and shown:
            return [*shown, more.format(len(texts) - len(shown))]
        shown.append(text)
    return shown


def documented(**texts: str) -> Callable[[F], F]:
    """A decorator: in the docstring a name in braces stands for the text, made of the table that holds its rows.

    Examples
    --------
    >>> @documented(known="a, b or c")
    ... def chosen(name):
    ...     "Choose from {known}."
    >>> chosen.__doc__
    'Choose from a, b or c.'
    """

    def written(function: F) -> F:
        for name, text in texts.items():
            function.__doc__ = (function.__doc__ or "").replace(f"{{{name}}}", text)
        return function

    return written
