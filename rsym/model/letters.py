"""Letters: the named parameters of a model."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from html import escape
from numbers import Real
from textwrap import shorten
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.wording import listing, proposal, within

Number: TypeAlias = int | float | Fraction
Value: TypeAlias = Number | sp.Expr  # of a letter: one that is no fraction as SymPy has it


@dataclass(frozen=True)
class Letter:
    """A named parameter: its value, the range it may take, its unit and what it is.

    Numbers are kept as given: an int, a float, a Fraction or a number of SymPy, as sqrt(2), is exact. What computes
    takes the nearest float; what proves takes the number.

    Examples
    --------
    >>> Letter(5, minimum=1, maximum=10, unit="m", doc="half the length of the segment").default
    5
    """

    default: Value
    minimum: Number | None = None
    maximum: Number | None = None
    unit: str = ""
    doc: str = ""

    def __post_init__(self) -> None:
        for name in ("default", "minimum", "maximum"):
            value = getattr(self, name)
            if name == "default":
                object.__setattr__(self, name, exact_number(value, "the default of a letter"))
            elif value is not None:
                object.__setattr__(self, name, real_number(value, f"the {name} of a letter"))
        self.check(self.default, "a letter")

    @property
    def fraction(self) -> Fraction:
        """The default, or the float that is nearest to it."""
        return Fraction(real_number(self.default, "a letter"))

    def check(self, value: Value, name: str) -> None:
        """Refuse a value outside the range."""
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        # As floats: an end such as 61/10 is not one, and whoever types 6.1 means it.
        if not float(low) <= float(value) <= float(high):
            shown = _plain(value)  # rounded, it may seem to be in the range
            raise RsymError(
                f"{name} must lie in {self.range}, got {shown if float(shown) == float(value) else repr(float(value))}",
                code="letter-range",
                remedy="choose a value inside the range, or widen the range where the letter is declared",
            )

    @property
    def range(self) -> str:
        """The range as text: ``[1, 10]``, with ``...`` for an end that is open; empty without any."""
        if self.minimum is None and self.maximum is None:
            return ""
        low, high = ("..." if end is None else _plain(end) for end in (self.minimum, self.maximum))
        return f"[{low}, {high}]"


class Letters(Mapping[str, Letter]):
    """An immutable, hashable mapping from names to letters, in the order given."""

    def __init__(self, items: Mapping[str, Letter]) -> None:
        self._items = dict(items)

    def __getitem__(self, name: str) -> Letter:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __hash__(self) -> int:
        return hash(frozenset(self._items.items()))

    def __repr__(self) -> str:
        values = [f"{name!r}: {_plain(item.default)}" for name, item in self.items()]
        return f"Letters({{{', '.join(within(values, 3000))}}})"

    def merge(self, other: Mapping[Any, Any] | None) -> Letters:
        """Both, by name, {symbol or name: number or Letter}; the same name must mean the same letter."""
        added = as_letters(other)
        for name in self.keys() & added.keys():
            if self[name] != added[name]:
                raise RsymError(
                    f"the letter {name!r} means two things: {self[name]} and {added[name]}",
                    code="letter-conflict",
                    remedy="rename one of them, or give both shapes the same Letter",
                )
        return Letters({**self, **added})

    def values_with(self, changes: Mapping[Any, Any] | None) -> dict[str, float]:
        """Every letter's value, the defaults overridden by `changes` (names or symbols to numbers)."""
        values = {name: float(item.default) for name, item in self.items()}
        for key, value in mapping_of(changes).items():
            name = str(key)
            if name not in values:
                raise RsymError(
                    f"no letter {name!r}; the letters are: {listing(values)}",
                    code="unknown-letter",
                    remedy=proposal(name, values, "use one of these, or none"),
                )
            number = exact_number(value, f"the letter {name!r}")
            self[name].check(number, f"the letter {name!r}")
            values[name] = float(number)
        return values

    def changed(self, values: Mapping[Any, Any]) -> Letters:
        """The same letters with other defaults: names or symbols to numbers."""
        self.values_with(values)
        named = {str(key): value for key, value in values.items()}
        return Letters({name: replace(item, default=named.get(name, item.default)) for name, item in self.items()})

    def _repr_html_(self) -> str:
        return self.table()

    def table(self, room: int = 3500) -> str:
        """The letters as an HTML table of so many characters; how many are left out is said."""
        head = _html_row("th", ("letter", "value", "range", "unit", "meaning"))
        said = [shorten(item.doc, 80, placeholder="...") for item in self.values()]
        rows = [
            _html_row("td", (name, _plain(item.default), item.range, item.unit, doc))
            for (name, item), doc in zip(self.items(), said, strict=True)
        ]
        return f"<table>{''.join(within([head, *rows], room, '<tr><td colspan=5>and {} more</td></tr>'))}</table>"


def _html_row(tag: str, cells: tuple[str, ...]) -> str:
    """Words to the left, where a notebook would set them to the right."""
    name, *numbers, meaning = (escape(cell) for cell in cells)
    left = f'<{tag} style="text-align: left">{{}}</{tag}>'
    middle = "".join(f"<{tag}>{number}</{tag}>" for number in numbers)
    return f"<tr>{left.format(name)}{middle}{left.format(meaning)}</tr>"


def as_letters(letters: Mapping[Any, Any] | None) -> Letters:
    """Accept {symbol or name: number or Letter}."""
    return Letters(
        {str(key): item if isinstance(item, Letter) else Letter(item) for key, item in mapping_of(letters).items()}
    )


def mapping_of(letters: Any) -> Mapping[Any, Any]:
    """Letters as they were given, none for None; what is no mapping is refused.

    Examples
    --------
    >>> mapping_of({"a": 5})
    {'a': 5}
    """
    if letters is not None and not isinstance(letters, Mapping):
        raise RsymError(
            f"letters must be a mapping of names to values, got {letters!r}",
            code="letters",
            remedy='for example {"a": 5}',
        )
    return letters or {}


def real_number(value: Any, what: str) -> Number:
    """A finite real number as int, float or Fraction."""
    if isinstance(value, sp.Rational):
        value = int(value) if value.is_Integer else Fraction(int(value.p), int(value.q))
    elif isinstance(value, sp.Expr) and value.is_number and value.is_real:
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
        raise RsymError(f"{what} must be a finite real number, got {value!r}", code="number")
    return value if isinstance(value, int | float | Fraction) else float(value)


def exact_number(value: Any, what: str) -> Value:
    """A finite real number as int, float or Fraction, or as SymPy has it where it is none of these.

    Examples
    --------
    >>> exact_number(sp.sqrt(2), "a letter"), exact_number(sp.Float(2.5), "a letter")
    (sqrt(2), 2.5)
    """
    near = real_number(value, what)
    return value if isinstance(value, sp.Expr) and not value.has(sp.Float) and not value.is_Rational else near


def _plain(value: Value) -> str:
    return f"{float(value):g}"
