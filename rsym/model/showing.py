r"""A shape as people see it: its equation in LaTeX, a line of text, a table; short and quick, whatever its formula is.

An equation is one line where it can be read, else a line for each named part.
What stands in several places is written once and then called by its name. Equal parts are found from below, by what
they are made of, so the work grows with the distinct parts and not with the text that would come of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from itertools import count
from typing import NamedTuple

import sympy as sp

from rsym.model.abridging import ROOM, abridged, symbol_names, weight
from rsym.model.equation import Equation
from rsym.model.nodes import Fold
from rsym.model.symbols import postorder, real_symbol, substitute, symbols_of, with_arguments
from rsym.model.wording import within

MOST = 1800  # characters of an equation at a glance
TEXT = 2000  # characters of a formula as text
LETTERS = 24  # of a shape that are written out
_IN_A_LINE = 8  # letters
WORTH_A_NAME = 5  # parts: x**2 + y**2 is, 2*x is not
LONGEST = 40  # parts in one line
_FIRST = "pqrstuvwabcdefghijklmno"  # of names; p for part


def latex(shape: Equation) -> str:
    r"""The equation as LaTeX; where a model file named its parts, the definitions one by one.

    A formula of more parts than a line can take is written in named common parts.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> print(latex(rsym.Shape(rsym.conjunction(x, y), (x, y))))
    \omega\left(x, y\right) = x \wedge_0 y
    """
    if shape.definitions:
        *parts, (_, last) = shape.definitions
        lines = [f"{_name(name)} &= {line(value)}" for name, value in parts]
        return aligned([*lines, f"{title(shape)} &= {line(last)}"])
    return written({title(shape): shape.expression}, taken=shape.letters)


def title(shape: Equation) -> str:
    """Omega of its coordinates."""
    return rf"\omega\left({', '.join(map(printed, shape.coordinates))}\right)"


def written(
    sides: Mapping[str, sp.Expr], known: Mapping[str, sp.Expr] | None = None, taken: Collection[str] = ()
) -> str:
    """Left sides and their expressions: one line if there is one and it is short, else common parts line by line."""
    if len(sides) == 1 and not known:
        ((left, expression),) = sides.items()
        if weight(expression, ROOM) <= ROOM:
            return f"{left} = {line(expression)}"
    return aligned(lines_of(sides, known, taken))


def lines_of(
    sides: Mapping[str, sp.Expr], known: Mapping[str, sp.Expr] | None = None, taken: Collection[str] = ()
) -> list[str]:
    """A line for each common part and each side, to be set one under the other."""
    parts, results = in_common_parts(list(sides.values()), known, taken)
    return [
        *(f"{printed(real_symbol(part.name))} &:= {line(part.expression)}" for part in parts),
        *(f"{left} &= {line(result)}" for left, result in zip(sides, results, strict=True)),
    ]


def known_parts(shape: Equation) -> dict[str, sp.Expr]:
    """The names of a model file and what they stand for, written out in coordinates and letters."""
    known: dict[sp.Symbol, sp.Expr] = {}
    for name, value in shape.definitions[:-1]:
        known[real_symbol(name)] = substitute(value, known)
    return {symbol.name: value for symbol, value in known.items()}


def at_a_glance(shape: Equation) -> list[str]:
    """The equation in lines of bounded length; what is left out is said."""
    if not shape.definitions:
        return _glimpse(title(shape), shape.expression, shape.letters)
    *parts, (_, last) = shape.definitions
    ending = _glimpse(title(shape), last, [*shape.letters, *(name for name, _ in parts)])
    room, shown = MOST - sum(map(len, ending)), list[str]()
    for number, (name, value) in enumerate(parts):
        text = f"{_name(name)} &= {line(value)}" if weight(value, ROOM) <= ROOM else f"{_name(name)} &= \\dots"
        room -= len(text)
        if room < 0:
            shown.append(rf"& \text{{and {len(parts) - number} more parts}}")
            break
        shown.append(text)
    return [*shown, ending[0].replace(" = ", " &= ", 1), *(f"& {text}" for text in ending[1:])]


def _glimpse(left: str, expression: sp.Expr, taken: Iterable[str]) -> list[str]:
    short, named = abridged(expression, [*taken])
    text = line(short)
    if len(text) > MOST:
        return [rf"{left} = \dots"]
    return [f"{left} = {text}", *(rf"{_name(part.name)}: \text{{{part.words}}}" for part in named)]


def aligned(lines: Sequence[str]) -> str:
    """Lines under each other."""
    return r"\begin{aligned}" + r"\\ ".join(lines) + r"\end{aligned}"


def _name(name: str) -> str:
    return printed(real_symbol(name))


def printed(expression: sp.Expr) -> str:
    """LaTeX with names as the source prints them."""
    text: str = sp.latex(expression, symbol_names=symbol_names(symbols_of(expression)))
    return text


def line(expression: sp.Expr) -> str:
    """The right side of an equation: the outer brackets of an R-operation are not needed."""
    text = printed(expression)
    return text.removeprefix(r"\left(").removesuffix(r"\right)") if isinstance(expression, Fold) else text


def text(shape: Equation) -> str:
    """Shape(expression, coordinates, ...), its deep parts by name."""
    short, named = abridged(shape.expression, shape.letters)
    formula = sp.sstr(short)
    given = [
        formula if len(formula) <= TEXT else f"{formula[:TEXT]}...",
        f"({', '.join(symbol.name for symbol in shape.coordinates)})",
    ]
    if shape.letters:
        letters = [f"{name}: {float(letter.default):g}" for name, letter in shape.letters.items()]
        given.append(f"letters={{{', '.join(within(letters, 600))}}}")
    if shape.bounds:
        given.append(f"bounds={shape.bounds}")
    if shape.parts:
        given.append(f"parts: {', '.join(within([name for name, _ in shape.parts], 300))}")
    given += [f"{part.name}: {part.words}" for part in named]
    return f"Shape({', '.join(given)})"


def displayed(shape: Equation) -> str:
    """The equation, the bounds and the letters for a notebook."""
    box = zip(map(printed, shape.coordinates), shape.bounds or (), strict=False)
    places = [rf"{name} \in [{low:g}, {high:g}]" for name, (low, high) in box]
    letters = [
        f"{printed(sp.Symbol(name))} = {float(letter.default):g}"
        for name, letter in list(shape.letters.items())[:LETTERS]
    ]
    if len(shape.letters) > LETTERS:
        letters.append(rf"\text{{and {len(shape.letters) - LETTERS} more letters}}")
    groups = [places, *(letters[start : start + _IN_A_LINE] for start in range(0, len(letters), _IN_A_LINE))]
    equation = at_a_glance(shape)
    lines = [r",\quad ".join(group) for group in groups if group]
    first = aligned(equation) if shape.definitions else r" \\ & ".join(equation)
    if not lines and (len(equation) == 1 or shape.definitions):
        return rf"$\displaystyle {first}$"
    whole = r" \\ & ".join([first, *lines])
    return rf"$\displaystyle \begin{{aligned}} & {whole} \end{{aligned}}$"


def table(shape: Equation) -> str:
    """The equation over the table of the letters."""
    letters = shape.letters.table(room=1500) if shape.letters else ""
    return f"<div>{escape(displayed(shape), quote=False)}{letters}</div>"


class CommonPart(NamedTuple):
    """name := expression, in which earlier names are symbols."""

    name: str
    expression: sp.Expr


def in_common_parts(
    expressions: Sequence[sp.Expr], known: Mapping[str, sp.Expr] | None = None, taken: Collection[str] = ()
) -> tuple[tuple[CommonPart, ...], tuple[sp.Expr, ...]]:
    """The common parts by name, each before it is used, and the expressions in terms of them.

    Parameters
    ----------
    expressions : sequence of SymPy expressions
        What is to be written.
    known : mapping, optional
        Names that a reader knows already, of a model file say, and what they stand for.
    taken : collection of names, optional
        Names that mean something else.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> root = sp.sqrt(x**2 + y**2)
    >>> in_common_parts([x / root, y / root])
    ((CommonPart(name='p_1', expression=1/sqrt(x**2 + y**2)),), (p_1*x, p_1*y))
    """
    known = known or {}
    forest = _Forest()
    roots = [forest.add(expression) for expression in expressions]
    inside = forest.below(roots)
    called = {key: name for name, value in known.items() if (key := forest.add(value)) in inside and value.args}
    used = {symbol.name for symbol in symbols_of(*expressions)} | {*taken, *known}
    first = next(letter for letter in _FIRST if not any(name.startswith(f"{letter}_") for name in used))
    fresh = (f"{first}_{number}" for number in count(1))
    uses = Counter(argument for key in inside for argument in forest.arguments[key])
    uses.update(roots)
    parts: list[CommonPart] = []
    shown: dict[int, sp.Expr] = {}
    sizes: dict[int, int] = {}

    def give_name(key: int) -> None:
        parts.append(CommonPart(called.get(key) or next(fresh), shown[key]))
        shown[key], sizes[key] = real_symbol(parts[-1].name), 1

    for key in sorted(inside):
        arguments = forest.arguments[key]
        for longest in sorted(set(arguments), key=lambda argument: -sizes[argument]):
            may_be_named = sizes[longest] >= WORTH_A_NAME and isinstance(forest.items[longest], sp.Expr)
            if may_be_named and sum(sizes[argument] for argument in arguments) > LONGEST:
                give_name(longest)
        shown[key] = forest.remade(key, shown)
        sizes[key] = 1 + sum(sizes[argument] for argument in arguments)
        shared = uses[key] > 1 and sizes[key] >= WORTH_A_NAME
        if (shared or key in called) and isinstance(shown[key], sp.Expr):
            give_name(key)
    return tuple(parts), tuple(shown[root] for root in roots)


class _Forest:
    """Distinct parts by number, arguments before their users; equal parts have one number."""

    def __init__(self) -> None:
        self.items: list[sp.Basic] = []
        self.arguments: list[tuple[int, ...]] = []
        self._numbers: dict[object, int] = {}

    def add(self, expression: sp.Basic) -> int:
        """The number of an expression."""
        here: dict[int, int] = {}
        for part in postorder(expression):
            arguments = tuple(here[id(argument)] for argument in part.args)
            key = (part.func, arguments) if arguments else part
            number = self._numbers.setdefault(key, len(self.items))
            if number == len(self.items):
                self.items.append(part)
                self.arguments.append(arguments)
            here[id(part)] = number
        return here[id(expression)]

    def below(self, roots: Iterable[int]) -> set[int]:
        """The roots and all that they are made of."""
        found: set[int] = set()
        stack = list(roots)
        while stack:
            key = stack.pop()
            if key not in found:
                found.add(key)
                stack.extend(self.arguments[key])
        return found

    def remade(self, key: int, shown: Mapping[int, sp.Basic]) -> sp.Basic:
        """A part over what its arguments are called."""
        part = self.items[key]
        arguments = tuple(shown[argument] for argument in self.arguments[key])
        same = all(new is old for new, old in zip(arguments, part.args, strict=True))
        return part if same else with_arguments(part, arguments)
