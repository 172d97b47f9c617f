"""Formulas at a glance: names as the source prints them; what lies deep below as parts that have a name and a size.

A notebook prints whatever a line ends with, and SymPy prints every shared part
as often as it is used; so the work here is bounded by what is shown.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count
from typing import NamedTuple

import sympy as sp

from rsym.model.nodes import Fold, ZeroWith
from rsym.model.symbols import real_symbol, with_arguments

_GREEK = frozenset(
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi"
    " omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split()
)


def typeset_name(name: str) -> str:
    r"""A name as the source prints it: one letter or a Greek one, the rest as a subscript; words upright.

    Examples
    --------
    >>> print(*map(typeset_name, ("a1", "xk2", "omega_bkka", "eps", "test1", "W")))
    a_{1} x_{k2} \omega_{bkka} \varepsilon \mathrm{test}_{1} W
    """
    head, _, tail = name.partition("_")
    word, digits = _split(head)
    if word == "eps":
        base, index = r"\varepsilon", ""
    elif word in _GREEK:
        base, index = rf"\{word}", ""
    elif len(word) <= 2:
        base, index = word[:1], word[1:]
    else:
        base, index = rf"\mathrm{{{word}}}", ""
    below = ",".join(part for part in (index + digits, tail.strip("_").replace("_", ",")) if part)
    return f"{base}_{{{below}}}" if below else base


def _split(head: str) -> tuple[str, str]:
    match = re.fullmatch(r"([A-Za-z]+)(\w*)", head)
    assert match is not None
    return match.group(1), match.group(2)


def symbol_names(symbols: Iterable[sp.Symbol]) -> dict[sp.Symbol, str]:
    """What `sympy.latex` takes to print symbols in this way; what no model file could name stays as SymPy has it."""
    return {symbol: typeset_name(symbol.name) for symbol in symbols if re.fullmatch(r"[A-Za-z]\w*", symbol.name)}


ROOM = 160  # parts of a formula that is printed whole
TOP = 30  # parts of the top of a longer one
SMALL = 7  # parts that need no name
COUNTED = 1000  # more parts than these are not counted
LONG_NUMBER = 128  # bits of a number that is written out

_OPEN = (sp.Add, sp.Mul, sp.Pow, Fold, sp.Abs, sp.Min, sp.Max)
_KINDS = ((sp.Add, "sum"), (sp.Mul, "product"), (sp.Pow, "power"), (sp.Number, "number"))


class Omitted(NamedTuple):
    """A part that is not written out: its name, and what it is in words."""

    name: str
    words: str


def abridged(expression: sp.Expr, taken: Collection[str] = ()) -> tuple[sp.Expr, tuple[Omitted, ...]]:
    """A formula of bounded length, and the parts that are only named in it; `taken` are names in use.

    Examples
    --------
    >>> from rsym import x, y
    >>> abridged(x + y)
    (x + y, ())
    >>> abridged(1 / sum((x - k) ** 2 for k in range(100)))  # doctest: +ELLIPSIS
    (1/omega_1, (Omitted(name='omega_1', words='sum of 30... parts'),))
    """
    if weight(expression, ROOM) <= ROOM:
        return expression, ()
    names = _Names(taken)
    places = [_Shown(expression)]
    for place in places:  # it grows
        if isinstance(place.part, ZeroWith):
            place.part = place.part.args[1]  # as which it is printed
        part = place.part
        if part.is_Symbol or weight(part, SMALL) <= SMALL:
            place.shown = part
        elif isinstance(part, _OPEN) and len(places) + len(part.args) <= TOP:
            place.inside = [_Shown(argument) for argument in part.args]
            places.extend(place.inside)
        else:
            place.shown = names.of(part)
    for place in reversed(places):
        if place.inside:
            place.shown = with_arguments(place.part, tuple(inner.shown for inner in place.inside))
    return places[0].shown, tuple(names.named)


@dataclass
class _Shown:
    """A part where it stands: a shared part stands in several places."""

    part: sp.Expr
    inside: list[_Shown] = field(default_factory=list)
    shown: sp.Expr = sp.S.Zero


class _Names:
    def __init__(self, taken: Collection[str]) -> None:
        self.free = (name for name in numbered("omega") if name not in taken)
        self.known: dict[int, sp.Symbol] = {}
        self.named: list[Omitted] = []

    def of(self, part: sp.Expr) -> sp.Symbol:
        """The name of a part, the same wherever it stands."""
        if id(part) not in self.known:
            name = next(self.free)
            self.known[id(part)] = real_symbol(name)
            self.named.append(Omitted(name, in_words(part)))
        return self.known[id(part)]


def numbered(stem: str) -> Iterator[str]:
    """stem_1, stem_2, ..."""
    return (f"{stem}_{number}" for number in count(1))


def weight(expression: sp.Basic, limit: int) -> int:
    """How many parts a printer would meet, shared ones as often as they are used; at most one more than the limit.

    Examples
    --------
    >>> from rsym import x
    >>> weight(x + 1, 10), weight(x + 1, 1)
    (3, 2)
    """
    met, stack = 0, [expression]
    while stack and met <= limit:
        part = stack.pop()
        met += 1
        if part.is_Rational and max(int(part.p).bit_length(), int(part.q).bit_length()) > LONG_NUMBER:
            return limit + 1
        stack.extend(part.args[: limit + 1])
    return met


def name_of(kind: type[sp.Basic]) -> str:
    """What texts call a kind of node: the noun that it gives, or the name of its class.

    Examples
    --------
    >>> from rsym.model.primitives.curve_nodes import SegmentField
    >>> name_of(sp.Add), name_of(SegmentField)
    ('Add', 'Segment')
    """
    return str(getattr(kind, "noun", kind.__name__))


def in_words(part: sp.Expr) -> str:
    """What a part is, and of how many distinct parts."""
    kind = next((word for kind, word in _KINDS if isinstance(part, kind)), name_of(type(part)).lower())
    size = distinct(part)
    return f"{kind} of {f'more than {COUNTED}' if size > COUNTED else size} parts"


def distinct(expression: sp.Basic) -> int:
    """How many distinct parts there are; one more than `COUNTED` for all that are more."""
    seen: set[int] = set()
    stack = [expression]
    while stack and len(seen) <= COUNTED:
        part = stack.pop()
        if id(part) not in seen:
            seen.add(id(part))
            stack.extend(part.args)
    return len(seen)
