"""A shape as a model text that loads to the same formula, operation by operation."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import BooleanAtom

from rsym.errors import RsymError
from rsym.language.functions import FAMILIES, SYSTEMS
from rsym.language.loading import loads
from rsym.language.nodes import NODES, PIECEWISE
from rsym.language.pieces import PIECES
from rsym.language.scanner import LONGEST_NAME
from rsym.language.vocabulary import RESERVED
from rsym.model.contracts.leaves import names_of
from rsym.model.folds import Fold
from rsym.model.letters import Letter, Number
from rsym.model.nodes import Trimming
from rsym.model.requirements import require_shape
from rsym.model.rnodes import ROperation
from rsym.model.shape import Shape
from rsym.model.systems import R0, RSystem
from rsym.model.traversal import postorder

HEADER = "% A model of rsym. After the word verbatim every operation stays as it is written, and decimals are floats."
LONGEST_LINE = 240  # characters of a formula; what is longer is taken apart
SHORT = 12  # characters of a formula that is written as often as it stands
_LOGIC, _SUM, _PRODUCT, _POWER, _ATOM = range(5)
_FUNCTIONS: Mapping[type[sp.Basic], str] = {
    **{getattr(sp, name): name for name in ("sin", "cos", "tan", "cot", "asin", "acos", "atan", "atan2")},
    **{getattr(sp, name): name for name in ("sinh", "cosh", "tanh", "exp", "log", "sign")},
    sp.Abs: "abs",
    sp.Min: "min",
    sp.Max: "max",
    Trimming: "trimming",
    sp.And: "and",
    sp.Or: "or",
    sp.Not: "not",
}
_HALF = sp.Rational(1, 2)


def dumps(shape: Shape) -> str:
    """A model text that `loads` reads as the same shape: the same program, letters, bounds and parts.

    Every operation is written as it stands; shared parts are written once and have names, those of the shape's own
    parts and definitions where they have one.

    Raises
    ------
    RsymError
        For what the language cannot say, by name: a SymPy function that no program holds, names that are none in the
        language, texts of more than one line, formulas larger than a model file may be. What is written was read
        again and is the same.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-1, 1), (-1, 1))).named("disc")
    >>> print(dumps(disc.rotate(1) & rsym.Shape(x, (x, y))))  # doctest: +ELLIPSIS
    % A model of rsym...
    verbatim
    coordinates x y
    bounds x [-1.3817732906760363, 1.3817732906760363] y [-1.3817732906760363, 1.3817732906760363]
    ...
    >>> rsym.loads(dumps(disc)) == disc
    True
    """
    require_shape(shape)
    try:
        text = "\n".join(_Writer(shape).lines()) + "\n"
        again = loads(text)
    except RecursionError:
        raise _unspeakable("a formula nested so deeply") from None
    except RsymError as error:
        if error.code == _CODE:
            raise
        raise _unspeakable(f"this shape: {error.message}") from error
    if found := _difference(shape, again):
        raise _unspeakable(found)
    return text


_CODE = "cannot-write"


def _unspeakable(what: str) -> RsymError:
    remedy = "keep the Python code that makes the shape, or simplify its formula"
    return RsymError(f"the model language cannot say {what}", code=_CODE, remedy=remedy)


class _Text(NamedTuple):
    """A formula as text, and how firmly it holds together."""

    text: str
    rank: int

    def within(self, rank: int) -> str:
        return self.text if self.rank >= rank else f"({self.text})"


class _Writer:
    """The statements of one shape."""

    def __init__(self, shape: Shape) -> None:
        self._shape = shape
        names = [symbol.name for symbol in shape.coordinates]
        self._taken = {*names, *shape.letters, *RESERVED, *PIECES, *NODES, PIECEWISE, "nan", "pi", "inf"}
        for name in (*names, *shape.letters):
            _check_name(name)
        self._roots = list(dict.fromkeys((*(part for _, part in shape.parts), shape.expression)))
        self._order = [part for part in postorder(*self._roots) if not isinstance(part, BooleanAtom)]
        self._system = _common_system(self._order)
        self._names = self._wanted_names()
        self._formulas: list[str] = []
        self._done: dict[sp.Basic, _Text] = {}
        self._count = 0

    def lines(self) -> Iterator[str]:
        """Declarations, formulas, parts."""
        shape = self._shape
        names = [symbol.name for symbol in shape.coordinates]
        yield HEADER
        yield "verbatim"
        yield f"coordinates {' '.join(names)}"
        if shape.bounds is not None:
            box = zip(names, shape.bounds, strict=True)
            yield "bounds " + " ".join(f"{name} [{_number(low)}, {_number(high)}]" for name, (low, high) in box)
        if (title := _system_title(self._system)) != "R0":
            yield f"system {title}"
        yield from (_letter(name, letter) for name, letter in shape.letters.items())
        self._write()
        yield from self._formulas
        for name, part in shape.parts:
            yield f"part {_quoted(name, 'the name of a part')} = {self._done[part].text}"

    def _write(self) -> None:
        users: Counter[sp.Basic] = Counter(argument for part in dict.fromkeys(self._order) for argument in part.args)
        for part in self._order:
            if part in self._done:
                continue
            written = self._written(part)
            is_formula = bool(part.args) and isinstance(part, sp.Expr)
            wanted = part in self._names or part == self._shape.expression
            shared = users[part] > 1 and len(written.text) > SHORT
            if wanted or (is_formula and (shared or len(written.text) > LONGEST_LINE)):
                written = self._defined(part, written)
            self._done[part] = written

    def _defined(self, part: sp.Basic, written: _Text) -> _Text:
        """A statement for this part; its name stands for it from now on."""
        if part == self._shape.expression:
            name = self._fresh("omega")
        else:
            name = self._names.get(part) or self._fresh_numbered()
        self._formulas.append(f"{name} = {written.text}")
        return _Text(name, _ATOM)

    def _fresh(self, wish: str) -> str:
        name, count = wish, 1
        while name in self._taken:
            count += 1
            name = f"{wish}_{count}"
        self._taken.add(name)
        return name

    def _fresh_numbered(self) -> str:
        self._count += 1
        return self._fresh(f"t{self._count}")

    def _wanted_names(self) -> dict[sp.Basic, str]:
        """Names for parts and definitions that stand in the formula as they are."""
        inside, names = set(self._order), dict[sp.Basic, str]()
        for part, title in names_of(self._shape).items():
            if part in inside and part.args and part != self._shape.expression and -part not in names:
                word = re.sub(r"\W+", "_", title, flags=re.ASCII).strip("_")[: LONGEST_NAME - 4]
                if word and not word[0].isdigit() and "omega" != word:
                    names[part] = self._fresh(word)
        return names

    def _written(self, part: sp.Basic) -> _Text:
        if isinstance(part, sp.Symbol):
            return _Text(part.name, _ATOM)
        if part is sp.nan:
            return _Text("nan", _ATOM)
        if part in (sp.pi, sp.E):
            return _Text("pi" if part == sp.pi else "exp(1)", _ATOM)
        if isinstance(part, sp.Number):
            return _constant(part)
        if isinstance(part, sp.Add):
            return self._sum(part)
        if isinstance(part, sp.Mul):
            return self._product(part)
        if isinstance(part, sp.Pow):
            return self._power(part)
        if isinstance(part, sp.Piecewise):
            return self._piecewise(part)
        if isinstance(part, ExprCondPair):
            return _Text("", _ATOM)  # written by the Piecewise that owns it
        if isinstance(part, Relational):
            return self._comparison(part)
        return self._call(part)

    def _of(self, part: sp.Basic) -> _Text:
        return self._done[part]

    def _sum(self, part: sp.Add) -> _Text:
        text = ""
        for term in part.args:
            negative, shown = self._signed(term)
            if text:
                text += f" {'-' if negative else '+'} {shown.within(_PRODUCT)}"
            else:
                text = f"-{shown.within(_PRODUCT)}" if negative else shown.within(_PRODUCT)
        return _Text(text, _SUM)

    def _signed(self, term: sp.Expr) -> tuple[bool, _Text]:
        """Whether a term is written behind a minus, and what is written then."""
        known = self._of(term)
        if known.rank == _ATOM or not known.text.startswith("-"):
            return False, known
        return True, _Text(known.text[1:], _PRODUCT)

    def _product(self, part: sp.Mul) -> _Text:
        first, *rest = part.args
        sign, coefficient = "", None
        if first.is_Number and rest:
            sign = "-" if first.is_negative else ""
            coefficient = abs(first)
        else:
            rest = list(part.args)
        if first == -1 and len(rest) == 1 and rest[0].is_Mul:
            return _Text(f"(-1*({self._of(rest[0]).text}))", _ATOM)  # behind a bare minus it would be one product
        text, divisor = "", ""
        if coefficient is not None and coefficient.is_Rational:
            text = "" if coefficient.p == 1 else str(coefficient.p)
            divisor = "" if coefficient.q == 1 else f"/{coefficient.q}"
        elif coefficient is not None:
            text = _constant(coefficient).text
        for factor in rest:
            below = self._below(factor)
            if below is not None:
                text = f"{text or '1'}/{below}"
            else:
                shown = self._of(factor)
                # A bare number would join the coefficient.
                inner = f"({shown.text})" if factor.is_Rational else shown.within(_POWER)
                text = f"{text}*{inner}" if text else inner
        return _Text(f"{sign}{text}{divisor}", _SUM if sign else _PRODUCT)

    def _below(self, factor: sp.Expr) -> str | None:
        """What a factor is divided by, if it is written so."""
        if not (isinstance(factor, sp.Pow) and factor.exp.is_Rational and factor.exp.is_negative):
            return None
        if factor in self._names or self._of(factor).rank == _ATOM:
            return None
        return self._raised(factor.base, -factor.exp) if self._divides(factor) else None

    @staticmethod
    def _divides(power: sp.Pow) -> bool:
        """Whether 1/... is read as this power: a base that is itself a power would lose its exponent."""
        return power.exp != -1 or not (isinstance(power.base, sp.Pow) and power.base.exp.is_Rational)

    def _raised(self, base: sp.Expr, exponent: sp.Expr) -> str:
        shown = self._of(base)
        if exponent == 1:
            return f"({shown.text})" if base.is_Rational else shown.within(_ATOM)
        if exponent == _HALF:
            return f"sqrt({shown.text})"
        power = str(exponent) if exponent.is_Integer and exponent >= 0 else f"({exponent})"
        return f"{shown.within(_ATOM)}^{power}"

    def _power(self, part: sp.Pow) -> _Text:
        base, exponent = part.args
        if exponent.is_Rational and exponent.is_negative and self._divides(part):
            return _Text(f"1/{self._raised(base, -exponent)}", _PRODUCT)
        if exponent.is_Rational:
            text = self._raised(base, exponent)
            return _Text(text, _ATOM if exponent == _HALF else _POWER)
        return _Text(f"{self._of(base).within(_ATOM)}^{self._of(exponent).within(_ATOM)}", _POWER)

    def _piecewise(self, part: sp.Piecewise) -> _Text:
        items: list[str] = []
        for value, condition in (pair.args for pair in part.args):
            items.append(self._of(value).text)
            if condition is not sp.true:
                items.append(self._condition(condition))
        return _Text(f"{PIECEWISE}({', '.join(items)})", _ATOM)

    def _condition(self, condition: sp.Basic) -> str:
        if isinstance(condition, BooleanAtom):
            raise _unspeakable(f"the condition {condition}")
        return self._of(condition).text

    def _comparison(self, part: Relational) -> _Text:
        signs: dict[type[sp.Basic], str] = {sp.Lt: "<", sp.Le: "<=", sp.Gt: ">", sp.Ge: ">="}
        if type(part) not in signs:
            raise _unspeakable(f"the condition {sp.sstr(part)[:80]}")
        left, right = part.args
        return _Text(f"{self._of(left).text} {signs[type(part)]} {self._of(right).text}", _LOGIC)

    def _call(self, part: sp.Basic) -> _Text:
        arguments, name = part.args, _FUNCTIONS.get(type(part))
        if isinstance(part, Fold) and self._is_of_the_system(part):
            arguments, name = part.operands, "rfAND" if part.sign < 0 else "rfOR"
        if name is None and type(part).__name__ in NODES and NODES[type(part).__name__].kind is type(part):
            name = type(part).__name__
        if name is None:
            raise _unspeakable(f"{type(part).__name__}: {sp.sstr(part)[:80]}")
        return _Text(f"{name}({', '.join(self._of(argument).text for argument in arguments)})", _ATOM)

    def _is_of_the_system(self, part: Fold) -> bool:
        return isinstance(part, ROperation) and _system_of(part) == self._system


def _system_of(part: ROperation) -> RSystem | None:
    """The system that the statement `system` can name and that a node is of."""
    return next((made for made in _candidates(part.parameters) if _makes(made, part)), None)


def _candidates(parameters: tuple[sp.Expr, ...]) -> Iterator[RSystem]:
    if not parameters:
        yield from SYSTEMS.values()
    if len(parameters) == 1 and (parameters[0].is_Symbol or parameters[0].is_Rational or parameters[0].is_Float):
        for word in ("Ralpha", "R0m", "Rp", "Sardf"):
            family, _ = FAMILIES[word]
            try:
                yield family(parameters[0])
            except RsymError:
                continue


def _makes(system: RSystem, part: ROperation) -> bool:
    operation = system.conjunction if part.sign < 0 else system.disjunction
    return type(operation(*part.operands[:2])) is type(part)


def _common_system(order: list[sp.Basic]) -> RSystem:
    """The system of most operations, or R_0."""
    found = Counter(system for part in order if isinstance(part, ROperation) and (system := _system_of(part)))
    return found.most_common(1)[0][0] if found else R0


def _system_title(system: RSystem) -> str:
    for word, known in SYSTEMS.items():
        if known == system:
            return word
    word = next(word for word, (family, _) in FAMILIES.items() if family is type(system))
    parameter = system.parameters[0]
    return f"{word} {parameter.name if parameter.is_Symbol else _constant(parameter).text}"


def _constant(number: sp.Expr) -> _Text:
    if isinstance(number, sp.Rational) and number.is_finite:
        return _Text(str(number), _SUM if number < 0 else _ATOM if number.q == 1 else _PRODUCT)
    if isinstance(number, sp.Float) and sp.Float(float(number)) == number and number._prec == sp.Float(1.0)._prec:
        return _Text(_number(float(number)), _SUM if number < 0 else _ATOM)
    raise _unspeakable(f"the number {number}")


def _number(value: Number) -> str:
    """An int, a fraction, or a float, which has a point or an exponent."""
    if isinstance(value, Fraction):
        return f"{value.numerator}/{value.denominator}"
    return repr(value) if isinstance(value, int) else repr(float(value))


def _letter(name: str, letter: Letter) -> str:
    text = f"letter {name} = {_number(letter.default)}"
    if letter.minimum is not None or letter.maximum is not None:
        low, high = (
            endless if end is None else _number(end)
            for end, endless in ((letter.minimum, "-inf"), (letter.maximum, "inf"))
        )
        text += f" in [{low}, {high}]"
    if letter.unit:
        text += f" unit {_quoted(letter.unit, f'the unit of the letter {name}')}"
    return text + (f" {_quoted(letter.doc, f'the text of the letter {name}')}" if letter.doc else "")


def _quoted(text: str, what: str) -> str:
    if not isinstance(text, str) or any(end in text for end in "\n\r"):
        raise _unspeakable(f"{what}, which has more than one line")
    doubled = text.replace('"', '""')
    return f'"{doubled}"'


def _check_name(name: str) -> None:
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST_NAME - 1}}}", name) or name in RESERVED:
        raise _unspeakable(f"the name {name!r}: a name has up to {LONGEST_NAME} letters A-Z, a-z, digits, underscores")


def _difference(shape: Shape, again: Shape) -> str:
    """What of a shape is another after it was read again, in words; nothing if it is the same."""
    if [symbol.name for symbol in shape.coordinates] != [symbol.name for symbol in again.coordinates]:
        return "these coordinates"
    if list(shape.letters.items()) != list(again.letters.items()):
        return "these letters"
    if shape.bounds != again.bounds:
        return "these bounds"
    if [name for name, _ in shape.parts] != [name for name, _ in again.parts]:
        return "these parts"
    pairs = [(shape.expression, again.expression)]
    pairs += [(old, new) for (_, old), (_, new) in zip(shape.parts, again.parts, strict=True)]
    seen: set[tuple[int, int]] = set()
    while pairs:
        old, new = pairs.pop()
        if (id(old), id(new)) in seen:
            continue
        seen.add((id(old), id(new)))
        alike = type(old) is type(new) and len(old.args) == len(new.args)
        if isinstance(old, sp.Symbol):
            alike = alike and old.name == new.name
        elif not old.args:
            alike = alike and old == new
        if not alike:
            return f"{sp.sstr(old)[:80]} as it stands: it would become {sp.sstr(new)[:80]}"
        pairs.extend(zip(old.args, new.args, strict=True))
    return ""
