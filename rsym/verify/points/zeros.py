"""Which nodes vanish at a point: proved, by algebra where balls cannot, or merely to all digits that were computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import sympy as sp

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.constants import vanishes
from rsym.verify.boxes.local import PRECISE, Model
from rsym.verify.boxes.polynomials import LARGEST
from rsym.verify.boxes.vanishing import AROUND, ZERO, Exact
from rsym.verify.points.locating import ZeroPlace

MOST_TRIED = 24  # nodes at one point that algebra is asked about, which may take a tenth of a second each

_OPERATIONS: dict[str, Callable[..., sp.Expr]] = {
    "add": sp.Add,
    "mul": sp.Mul,
    "neg": lambda a: -a,
    "div": lambda a, b: a / b,
    "sqrt": sp.sqrt,
    "abs": sp.Abs,
    "sin": sp.sin,
    "cos": sp.cos,
    "exp": sp.exp,
}


class Known(Exact):
    """What is known exactly at a point, where its coordinates are rational also by algebra: sqrt(2)**2 is 2."""

    def __init__(self, model: Model, place: ZeroPlace, around: float = AROUND) -> None:
        super().__init__(model.on([part + arb(0, around) for part in place.point]), place.coordinates, place.zeros)
        self.at = model.on(place.point)
        self._tried = 0

    def vanishes(self, *numbers: int) -> bool:
        """Whether all these nodes are known to be zero at the point."""
        return all(super(Known, self).vanishes(number) or self._cancels(number) for number in numbers)

    def _cancels(self, number: int) -> bool:
        """Whether a node is zero by algebra; then it is one of the zeros from now on."""
        value = self.at.value(number)
        if value is None or not value.contains(0) or self._tried >= MOST_TRIED:
            return False
        self._tried += 1
        constant = constant_of(self.local.model, number, self.inputs)
        if constant is None or vanishes(constant) is not True:
            return False
        self.zeros |= {number}
        self.values = {}
        return True


class Apparent(Known):
    """What would be known if all were zero that is smaller than 10**-digits at the point."""

    def __init__(self, model: Model, place: ZeroPlace, digits: int) -> None:
        super().__init__(model, place, 10.0 ** (-digits / 2))  # wide enough for leaves that nearly vanish
        self._least = 10.0**-digits

    def _value(self, part: int) -> Fraction | None:
        known = super()._value(part)
        value = self.at.value(part)
        if known is None and value is not None and value.is_finite() and float(abs(value).upper()) < self._least:
            return ZERO
        return known

    def _cancels(self, number: int) -> bool:
        return False


def known_at(model: Model, place: ZeroPlace, *, apparent: int = 0) -> Known:
    """What is known at a place, or would be if what is zero to so many digits were zero."""
    with ctx.workprec(PRECISE):
        return Apparent(model, place, apparent) if apparent else Known(model, place)


def constant_of(model: Model, number: int, inputs: Mapping[str, Fraction | None]) -> sp.Expr | None:
    """A node as a constant of SymPy, given rational inputs; None if it is no expression of moderate size.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> model = Model(rsym.Shape(sp.sqrt(2) * x - sp.sqrt(8) * y, (x, y, z)), {})
    >>> constant_of(model, model.root, dict.fromkeys("xyz", Fraction(1)))
    -sqrt(2)
    """
    order = model.order(number)
    if len(order) > LARGEST:
        return None
    done: dict[int, sp.Expr] = {}
    for part in order:
        operation, arguments, data = model.builder.nodes[part]
        if operation in {"const", "input"}:
            value = data if operation == "const" else inputs[str(data)]
            if value is None:
                return None
            done[part] = _number(value)
        elif operation == "powi" and isinstance(data, int):
            done[part] = done[arguments[0]] ** data
        elif operation in _OPERATIONS:
            done[part] = _OPERATIONS[operation](*(done[argument] for argument in arguments))
        else:
            return None
        if done[part].has(sp.zoo, sp.nan, sp.I):
            return None
    return done[number]


def _number(value: object) -> sp.Expr:
    if isinstance(value, Fraction):
        return sp.Rational(value.numerator, value.denominator)
    return {"pi": sp.pi, "e": sp.E}[str(value)]
