"""Likeness: whether a formula is the same, or has the same sign everywhere, when its coordinates are exchanged.

Two formulas are alike if they are one up to the order of sums, products and symmetric operations and to signs that
cancel: |x - y| and |y - x|. That is exact, and may miss a likeness that takes more algebra. Of R-operations only the
sign counts where they join what the whole is made of: there the order in which they are folded does not matter.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from rsym.logic.gates import gate_of
from rsym.program.operations import SYMMETRIC, those
from rsym.verify.boxes.local import Model

Signed = tuple[int, int]  # the number of a form and a sign
_EVEN = those(lambda row: row.parity == "even" and not row.symmetric)
_ODD = those(lambda row: row.parity == "odd" and not row.symmetric)
_SIGNED = _EVEN | _ODD | {"mul", "div", "powi"}


class Likeness:
    """The forms of the parts of a model, numbered as they are met."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._numbers: dict[Any, int] = {}
        self._forms: list[Any] = []
        self._own = self._sign_of_root({name: (name, 1) for name in model.builder.coordinates})

    def holds(self, places: Mapping[str, tuple[str, int]]) -> bool:
        """Whether omega has the same sign everywhere when each coordinate is replaced by another one or its negative.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> likeness = Likeness(Model(rsym.Shape(1 - abs(x - y) - z**2, (x, y, z)), {}))
        >>> same = {name: (name, 1) for name in "xyz"}
        >>> likeness.holds(same | {"x": ("y", 1), "y": ("x", 1)}), likeness.holds(same | {"x": ("x", -1)})
        (True, False)
        """
        return bool(self._sign_of_root(places) == self._own)

    def _number(self, form: Any) -> int:
        if form not in self._numbers:
            self._numbers[form] = len(self._forms)
            self._forms.append(form)
        return self._numbers[form]

    def _sign_of_root(self, places: Mapping[str, tuple[str, int]]) -> Any:
        """The form of the root of which the sign is left."""
        model = self.model
        signed: dict[int, Signed] = {}
        for part in model.order(model.root):
            signed[part] = self._form(part, signed, places)
        joined: dict[tuple[int, int], Any] = {}
        stack = [(model.root, 1)]
        while stack:
            part, sign = stack[-1]
            operation, arguments, _ = model.builder.nodes[part]
            if operation == "neg":
                inner = [(arguments[0], -sign)]
            elif gate_of(operation):
                inner = [(argument, sign) for argument in arguments[:2]]
            else:
                inner = []
            waiting = [one for one in inner if one not in joined]
            if waiting:
                stack.extend(waiting)
                continue
            stack.pop()
            joined[part, sign] = self._joined(operation, sign, [joined[one] for one in inner], signed[part])
        return joined[model.root, 1]

    def _joined(self, operation: str, sign: int, inner: list[Any], own: Signed) -> Any:
        """The sign of a part: of all operands of a kind together, which are a set."""
        if operation == "neg":
            return inner[0]
        if not inner:
            return self._number(("sign", own[0], own[1] * sign))
        kind = gate_of(operation, sign)
        members: set[int] = set()
        for one in inner:
            form = self._forms[one]
            members |= form[1] if form[0] == kind else {one}
        return self._number((kind, frozenset(members)))

    def _form(self, part: int, signed: Mapping[int, Signed], places: Mapping[str, tuple[str, int]]) -> Signed:
        operation, arguments, data = self.model.builder.nodes[part]
        inner = [signed[argument] for argument in arguments]
        if operation == "const" and isinstance(data, Fraction):
            return self._number(("const", abs(data))), 1 if data >= 0 else -1
        if operation == "input":
            name, sign = places.get(str(data), (data, 1))
            return self._number(("input", name)), sign
        if operation == "neg":
            return inner[0][0], -inner[0][1]
        if operation == "add":
            return self._sum(inner)
        if operation in _SIGNED:
            return self._product(operation, data, inner)
        if operation in {"min", "max"}:
            return self._number((operation, frozenset(self._members(operation, inner)))), 1
        if operation in SYMMETRIC:
            return self._number((operation, data, tuple(sorted(inner[:2])), tuple(inner[2:]))), 1
        return self._number((operation, data, tuple(inner))), 1

    def _members(self, operation: str, inner: list[Signed]) -> set[Signed]:
        members: set[Signed] = set()
        for number, sign in inner:
            form = self._forms[number]
            members |= form[1] if sign > 0 and form[0] == operation else {(number, sign)}
        return members

    def _sum(self, inner: list[Signed]) -> Signed:
        """The terms, those of sums among them too, in order, the first with a plus."""
        terms: list[Signed] = []
        for number, sign in inner:
            form = self._forms[number]
            own = form[1] if form[0] == "add" else ((number, 1),)
            terms += [(term, other * sign) for term, other in own]
        terms.sort()
        first = terms[0][1]
        return self._number(("add", tuple((term, sign * first) for term, sign in terms))), first

    def _product(self, operation: str, data: Any, inner: list[Signed]) -> Signed:
        """What has the sign of its factors, or none."""
        numbers = [number for number, _ in inner]
        sign = inner[0][1]
        if operation in _EVEN or (operation == "powi" and data % 2 == 0):
            sign = 1
        if operation == "mul":
            factors: list[int] = []
            for number in numbers:
                form = self._forms[number]
                factors += form[2] if form[0] == "mul" else (number,)
            return self._number(("mul", None, tuple(sorted(factors)))), inner[0][1] * inner[1][1]
        if operation == "div":
            return self._number(("div", None, tuple(numbers))), inner[0][1] * inner[1][1]
        return self._number((operation, data, (numbers[0], *inner[1:]))), sign
