"""Formulas as model text, operation by operation: `Verbatim` reads each back as the node that it was."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

import sympy as sp
from sympy.core.relational import Relational
from sympy.functions.elementary.piecewise import ExprCondPair
from sympy.logic.boolalg import BooleanAtom

from rsym.errors import RsymError
from rsym.language.functions import FAMILIES, NODES, PIECEWISE, SYSTEMS
from rsym.model.abridging import name_of
from rsym.model.functions import FUNCTIONS
from rsym.model.letters import Number
from rsym.model.nodes import Trimming
from rsym.model.rnodes import ROperation
from rsym.model.systems import R0, RSystem

_LOGIC, _SUM, _PRODUCT, _POWER, ATOM = range(5)
_FUNCTIONS: Mapping[type[sp.Basic], str] = {
    **{row.kind: name for name, row in FUNCTIONS.items()},
    Trimming: "trimming",
    sp.And: "and",
    sp.Or: "or",
    sp.Not: "not",
}
_HALF = sp.Rational(1, 2)


CODE = "cannot-write"


def unspeakable(what: str) -> RsymError:
    """The error for what the language has no words for."""
    remedy = "keep the Python code that makes the shape, or simplify its formula"
    return RsymError(f"the model language cannot say {what}", code=CODE, remedy=remedy)


class Written(NamedTuple):
    """A formula as text, and how firmly it holds together."""

    text: str
    rank: int

    def within(self, rank: int) -> str:
        """The text, in brackets if it holds together less firmly than its place asks for."""
        return self.text if self.rank >= rank else f"({self.text})"


class Sentences:
    """What each part of a formula is written as, given what its arguments are written as."""

    def __init__(self, system: RSystem) -> None:
        self._system = system
        self.done: dict[sp.Basic, Written] = {}

    def written(self, part: sp.Basic) -> Written:
        """One part as text; its arguments are done."""
        if isinstance(part, sp.Symbol):
            return Written(part.name, ATOM)
        if part is sp.nan:
            return Written("nan", ATOM)
        if part in (sp.pi, sp.E):
            return Written("pi" if part == sp.pi else "exp(1)", ATOM)
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
            return Written("", ATOM)  # written by the Piecewise that owns it
        if isinstance(part, Relational):
            return self._comparison(part)
        return self._call(part)

    def _of(self, part: sp.Basic) -> Written:
        return self.done[part]

    def _sum(self, part: sp.Add) -> Written:
        text = ""
        for term in part.args:
            negative, shown = self._signed(term)
            if text:
                text += f" {'-' if negative else '+'} {shown.within(_PRODUCT)}"
            else:
                text = f"-{shown.within(_PRODUCT)}" if negative else shown.within(_PRODUCT)
        return Written(text, _SUM)

    def _signed(self, term: sp.Expr) -> tuple[bool, Written]:
        """Whether a term is written behind a minus, and what is written then."""
        known = self._of(term)
        if known.rank == ATOM or not known.text.startswith("-"):
            return False, known
        return True, Written(known.text[1:], _PRODUCT)

    def _product(self, part: sp.Mul) -> Written:
        first, *rest = part.args
        sign, coefficient = "", None
        if first.is_Number and rest:
            sign = "-" if first.is_negative else ""
            coefficient = abs(first)
        else:
            rest = list(part.args)
        if first == -1 and len(rest) == 1 and rest[0].is_Mul:
            return Written(f"(-1*({self._of(rest[0]).text}))", ATOM)  # behind a bare minus it would be one product
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
        return Written(f"{sign}{text}{divisor}", _SUM if sign else _PRODUCT)

    def _below(self, factor: sp.Expr) -> str | None:
        """What a factor is divided by, if it is written so."""
        if not (isinstance(factor, sp.Pow) and factor.exp.is_Rational and factor.exp.is_negative):
            return None
        if self._of(factor).rank == ATOM:
            return None
        return self._raised(factor.base, -factor.exp) if self._divides(factor) else None

    @staticmethod
    def _divides(power: sp.Pow) -> bool:
        """Whether 1/... is read as this power: a base that is itself a power would lose its exponent."""
        return power.exp != -1 or not (isinstance(power.base, sp.Pow) and power.base.exp.is_Rational)

    def _raised(self, base: sp.Expr, exponent: sp.Expr) -> str:
        shown = self._of(base)
        if exponent == 1:
            return f"({shown.text})" if base.is_Rational else shown.within(ATOM)
        if exponent == _HALF:
            return f"sqrt({shown.text})"
        power = str(exponent) if exponent.is_Integer and exponent >= 0 else f"({exponent})"
        return f"{shown.within(ATOM)}^{power}"

    def _power(self, part: sp.Pow) -> Written:
        base, exponent = part.args
        if exponent.is_Rational and exponent.is_negative and self._divides(part):
            return Written(f"1/{self._raised(base, -exponent)}", _PRODUCT)
        if exponent.is_Rational:
            text = self._raised(base, exponent)
            return Written(text, ATOM if exponent == _HALF else _POWER)
        return Written(f"{self._of(base).within(ATOM)}^{self._of(exponent).within(ATOM)}", _POWER)

    def _piecewise(self, part: sp.Piecewise) -> Written:
        items: list[str] = []
        for value, condition in (pair.args for pair in part.args):
            items.append(self._of(value).text)
            if condition is sp.true:
                continue
            if isinstance(condition, BooleanAtom):
                raise unspeakable(f"the condition {condition}")
            items.append(self._of(condition).text)
        return Written(f"{PIECEWISE}({', '.join(items)})", ATOM)

    def _comparison(self, part: Relational) -> Written:
        signs: dict[type[sp.Basic], str] = {sp.Lt: "<", sp.Le: "<=", sp.Gt: ">", sp.Ge: ">="}
        if type(part) not in signs:
            raise unspeakable(f"the condition {sp.sstr(part)[:80]}")
        left, right = part.args
        return Written(f"{self._of(left).text} {signs[type(part)]} {self._of(right).text}", _LOGIC)

    def _call(self, part: sp.Basic) -> Written:
        arguments, name = part.args, _FUNCTIONS.get(type(part))
        if isinstance(part, ROperation) and _system_of(part) == self._system:
            arguments, name = part.operands, "rfAND" if part.sign < 0 else "rfOR"
        node = NODES.get(name_of(type(part)))
        if name is None and node is not None and node.kind is type(part):
            name = name_of(node.kind)
        if name is None:
            raise unspeakable(f"{type(part).__name__}: {sp.sstr(part)[:80]}")
        return Written(f"{name}({', '.join(self._of(argument).text for argument in arguments)})", ATOM)


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


def common_system(order: list[sp.Basic]) -> RSystem:
    """The system of most operations, or R_0."""
    found = Counter(system for part in order if isinstance(part, ROperation) and (system := _system_of(part)))
    return found.most_common(1)[0][0] if found else R0


def _constant(number: sp.Expr) -> Written:
    if isinstance(number, sp.Rational) and number.is_finite:
        return Written(str(number), _SUM if number < 0 else ATOM if number.q == 1 else _PRODUCT)
    if isinstance(number, sp.Float) and sp.Float(float(number)) == number and number._prec == sp.Float(1.0)._prec:
        return Written(number_text(float(number)), _SUM if number < 0 else ATOM)
    raise unspeakable(f"the number {number}")


def number_text(value: Number) -> str:
    """An int, a fraction, or a float, which has a point or an exponent."""
    if isinstance(value, Fraction):
        return f"{value.numerator}/{value.denominator}"
    return repr(value) if isinstance(value, int) else repr(float(value))
