r"""The named formulas of a model, one by one, as a page or a terminal shows them: in LaTeX, as they stand in the file.

Nothing is reordered, nothing simplified: SymPy sorts the terms of a sum by rules of its own, and a formula that is to
be compared with a printed one must keep its order.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from os import PathLike
from typing import NamedTuple

import sympy as sp

from rsym.language.assembly import assemble
from rsym.language.functions import PIECEWISE
from rsym.language.loading import read_model, read_text
from rsym.language.model import collect
from rsym.language.parser import parse
from rsym.language.syntax import ARITIES, Call, Expression, Name, Number, Power, Product, Quoted, Sum, Vector, postorder
from rsym.language.vm import is_vm
from rsym.model.abridging import abridged, typeset_name
from rsym.model.functions import FUNCTIONS
from rsym.model.shape import Shape
from rsym.model.showing import line
from rsym.model.systems import RSystem

_LOGIC, _SUM, _PRODUCT, _POWER, _ATOM = range(5)  # how firmly the parts of a text hold together
_ESCAPED = r"\\\1"
_HALF = Fraction(1, 2)
_COMPARED = {"<": "<", ">": ">", "<=": r"\le", ">=": r"\ge", "and": r"\wedge", "or": r"\vee"}


@dataclass(frozen=True)
class Definition:
    """One formula: its name, its expression in which other names are symbols, both as LaTeX, and what part it makes."""

    name: str
    expression: sp.Expr
    latex: str
    doc: str = ""


def definitions(source: str | PathLike[str], *, shape: str | None = None) -> tuple[Definition, ...]:
    r"""The chosen formula of a model and those that it needs, in the order of the file.

    Of a text of fidget and MPR, which names no parts, one formula, its deep parts in words.

    Parameters
    ----------
    source : path or str
        A path object names a file; a str is the text of a model itself.
    shape : str, optional
        As for `loads`.

    Raises
    ------
    RsymError
        As for `load` and `loads`.

    Examples
    --------
    >>> for definition in definitions("f1 = 1 - x^2; g = y*3; omega = rfAND(f1, z)"):
    ...     print(definition.latex)
    f_{1} = 1 - x^{2}
    \omega = f_{1} \wedge_0 z
    """
    if not isinstance(source, str) and is_vm(source):
        return (_glimpse(read_model(source, shape=shape)[0]),)
    model = collect(parse(source if isinstance(source, str) else read_text(source)))
    written = {assignment.name: assignment for assignment in model.assignments}
    return tuple(
        Definition(
            name,
            expression,
            f"{typeset_name(name)} = {typeset(written[name].value, model.system)}",
            written[name].doc,
        )
        for name, expression in assemble(model, shape, None).definitions
    )


def _glimpse(shape: Shape) -> Definition:
    """The formula as far as it can be read."""
    short, named = abridged(shape.expression)
    words = ", ".join(f"{part.name}: {part.words}" for part in named)
    return Definition("omega", short, rf"\omega = {line(short)}", words)


class _Typeset(NamedTuple):
    latex: str
    rank: int

    def within(self, rank: int) -> str:
        """The text, in brackets if it holds together less firmly than its place asks for."""
        return self.latex if self.rank >= rank else rf"\left({self.latex}\right)"


def typeset(expression: Expression, system: RSystem) -> str:
    r"""The LaTeX of a formula; `system` is what rfAND and rfOR belong to.

    Examples
    --------
    >>> from rsym.language.parser import parse
    >>> from rsym.model.systems import R0
    >>> (statement,) = parse("f = rfAND(-y*(y + y2)/y2, rfNOT(g))")
    >>> print(typeset(statement.value, R0))
    \left(-\frac{y \left(y + y_{2}\right)}{y_{2}}\right) \wedge_0 \left(-g\right)
    """
    signs = _logical_signs(system)
    done: list[_Typeset] = []
    for node in postorder(expression):
        first = len(done) - len(node.parts)
        done[first:] = [_combine(node, done[first:], signs)]
    return done[0].latex


def _logical_signs(system: RSystem) -> Mapping[str, str]:
    """The infix signs, from what the system's own nodes print."""
    left, right = sp.Symbol("l"), sp.Symbol("r")
    both, either = (
        sp.latex(operation(left, right)).removeprefix(r"\left(l ").removesuffix(r" r\right)")
        for operation in (system.conjunction, system.disjunction)
    )
    return {
        "rfAND": both,
        "conjunction": both,
        "rfOR": either,
        "disjunction": either,
        "equivalence": r"\sim_{2}",
        "joining": r"\cup_{2}",
    }


def _combine(node: Expression, parts: list[_Typeset], signs: Mapping[str, str]) -> _Typeset:
    match node:
        case Number():
            return _number(node.value)
        case Name():
            return _Typeset(typeset_name(node.name), _ATOM)
        case Sum():
            return _sum(node.signs, parts)
        case Product():
            return _product(node, parts)
        case Power():
            return _power(node, parts)
        case Call():
            return _call(node, parts, signs)
        case Vector():
            return _Typeset(rf"\left[{', '.join(part.latex for part in parts)}\right]", _ATOM)
        case Quoted():
            return _Typeset(_upright(node.value), _ATOM)


def _number(value: Fraction) -> _Typeset:
    mantissa, _, exponent = f"{float(value):.15g}".partition("e")
    if not exponent:
        return _Typeset(mantissa, _ATOM)
    return _Typeset(rf"{mantissa} \cdot 10^{{{int(exponent)}}}", _PRODUCT)


def _sum(signs: tuple[int, ...], parts: list[_Typeset]) -> _Typeset:
    terms = []
    for position, (sign, part) in enumerate(zip(signs, parts, strict=True)):
        if position == 0 and sign > 0:
            terms.append(part.within(_SUM))
        else:
            space = " " if position else ""
            terms.append(f"{space}{'-' if sign < 0 else '+'}{space}{part.within(_PRODUCT)}")
    return _Typeset("".join(terms), _SUM)


def _product(node: Product, parts: list[_Typeset]) -> _Typeset:
    """A fraction if there are divisors; the minus of the first factor comes before it."""
    first = node.parts[0]
    negative = isinstance(first, Sum) and first.signs == (-1,)
    if negative:
        parts = [_Typeset(parts[0].latex.removeprefix("-"), _PRODUCT), *parts[1:]]
    above = [part for sign, part in zip(node.signs, parts, strict=True) if sign > 0]
    below = [part for sign, part in zip(node.signs, parts, strict=True) if sign < 0]
    text = _factors(above) if not below else rf"\frac{{{_factors(above)}}}{{{_factors(below)}}}"
    if negative:
        return _Typeset(f"-{text}", _SUM)
    return _Typeset(text, _POWER if below else _PRODUCT)


def _factors(parts: list[_Typeset]) -> str:
    if len(parts) == 1:
        return parts[0].latex
    texts = [part.within(_PRODUCT) for part in parts]
    return texts[0] + "".join(rf" \cdot {text}" if text[0].isdigit() else f" {text}" for text in texts[1:])


def _power(node: Power, parts: list[_Typeset]) -> _Typeset:
    text = parts[0]
    for exponent, part in zip(parts[1:], node.parts[1:], strict=True):
        if isinstance(part, Number) and part.value == _HALF:
            text = _Typeset(rf"\sqrt{{{text.latex}}}", _ATOM)
        else:
            text = _Typeset(f"{text.within(_ATOM)}^{{{exponent.latex}}}", _POWER)
    return text


def _upright(word: str) -> str:
    """A word as such; what LaTeX would take for a command is escaped."""
    plain = re.sub(r"[^ -~]|[{}~^\\]", "", word)
    return rf"\mathrm{{{re.sub('([_%#&$])', _ESCAPED, plain)}}}"


def _call(node: Call, parts: list[_Typeset], signs: Mapping[str, str]) -> _Typeset:
    function = node.function
    if function in _COMPOSED:
        return _COMPOSED[function](parts, signs["rfAND"], signs["rfOR"])
    if function in signs:
        return _infix(signs[function], parts)
    if function in _COMPARED:
        return _Typeset(f" {_COMPARED[function]} ".join(part.within(_SUM) for part in parts), _LOGIC)
    if function == "not":
        return _Typeset(rf"\neg {parts[0].within(_ATOM)}", _LOGIC)
    if function == PIECEWISE:
        return _cases([part.latex for part in parts])
    inner = ", ".join(part.latex for part in parts)
    if function == "abs":
        return _Typeset(rf"\left|{inner}\right|", _ATOM)
    if function not in ARITIES:
        first = len(parts) - len(node.keywords)
        named = [rf"{_upright(name)} = {part.latex}" for name, part in zip(node.keywords, parts[first:], strict=True)]
        inner = ", ".join([*(part.latex for part in parts[:first]), *named])
        return _Typeset(rf"{_upright(function)}\left({inner}\right)", _ATOM)
    if function == "trimming":
        return _Typeset(rf"\rho\left({parts[0].latex};\, {parts[1].latex}\right)", _ATOM)
    return _Typeset(rf"{_written(function)}\left({inner}\right)", _ATOM)


def _written(function: str) -> str:
    row = FUNCTIONS.get(function)
    return row.latex if row is not None and row.latex else f"\\{function}"


def _cases(texts: list[str]) -> _Typeset:
    conditions = [*texts[1::2], *([r"\text{otherwise}"] if len(texts) % 2 else [])]
    rows = [f"{value} & {condition}" for value, condition in zip(texts[::2], conditions, strict=True)]
    return _Typeset(r"\begin{cases} " + r" \\ ".join(rows) + r" \end{cases}", _ATOM)


def _opposite(part: _Typeset) -> _Typeset:
    return _Typeset(f"-{part.within(_PRODUCT)}", _SUM)


def _infix(sign: str, parts: list[_Typeset]) -> _Typeset:
    return _Typeset(f" {sign} ".join(part.within(_POWER) for part in parts), _LOGIC)


def _exclusive_or(parts: list[_Typeset], both: str, either: str) -> _Typeset:
    f, g = parts
    return _infix(either, [_infix(both, [f, _opposite(g)]), _infix(both, [_opposite(f), g])])


_COMPOSED: dict[str, Callable[[list[_Typeset], str, str], _Typeset]] = {
    "difference": lambda parts, both, either: _infix(both, [parts[0], *map(_opposite, parts[1:])]),
    "implication": lambda parts, both, either: _infix(either, [_opposite(parts[0]), parts[1]]),
    "exclusive_or": _exclusive_or,
}
