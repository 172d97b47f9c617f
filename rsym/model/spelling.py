"""American spellings of what rsym spells as the British do: who types one is told the word that is taken."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable
from types import CodeType, FunctionType
from typing import Any, TypeVar, cast

from rsym.errors import RsymError

F = TypeVar("F", bound=Callable[..., Any])

_SPELT = (
    (re.compile(r"our(?=s?$|ed$|ing$)"), "or"),
    (re.compile(r"tre(?=s?$)"), "ter"),
    (re.compile(r"tre(?=d$)"), "tere"),
    (re.compile(r"grey"), "gray"),
    (re.compile(r"is(?=e[ds]?$|ing$|ation$)"), "iz"),
    (re.compile(r"lys(?=e[ds]?$)"), "lyz"),
)


def american(words: Iterable[str]) -> dict[str, str]:
    """How Americans spell these words, those alone that they spell otherwise; to each what was given.

    Examples
    --------
    >>> american(["colour_by", "centre", "bounds", "normalise"])
    {'color_by': 'colour_by', 'center': 'centre', 'normalize': 'normalise'}
    """
    return {spelt: word for word in words if (spelt := _american(word)) != word}


def _american(word: str) -> str:
    parts = word.split("_")
    for ours, theirs in _SPELT:
        parts = [ours.sub(theirs, part) for part in parts]
    return "_".join(parts)


def british(function: F) -> F:
    """The function; an argument that it is given by an American name is refused, and the remedy says the British one.

    Without such a parameter it is the function itself; else calls cost a tenth of a microsecond more.

    Examples
    --------
    >>> import rsym
    >>> rsym.disc(1, center=(1, 0))
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: disc takes no argument 'center'; remedy: rsym spells it 'centre'
    """
    code: CodeType = function.__code__
    spellings = american(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])
    if not spellings or hasattr(function, "__wrapped__"):
        return function

    name, refuse = function.__qualname__.removesuffix(".__init__").rpartition(".")[2], _refuse

    def answered(*arguments: Any, **keywords: Any) -> Any:
        if not spellings.keys().isdisjoint(keywords):
            refuse(name, spellings, keywords)
        return function(*arguments, **keywords)

    # In the module of the function: there doctest looks for it.
    made = FunctionType(answered.__code__, function.__globals__, function.__name__, None, answered.__closure__)
    return cast(F, functools.update_wrapper(made, function))


def _refuse(function: str, spellings: dict[str, str], keywords: Iterable[str]) -> None:
    wrong = next(name for name in keywords if name in spellings)
    raise RsymError(
        f"{function} takes no argument {wrong!r}", code="spelling", remedy=f"rsym spells it {spellings[wrong]!r}"
    )
