"""The tree of an equation's text to terms in the unknown function: nothing of it is run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeAlias

import sympy as sp

from rsym.language.building import FormulaBuilder, symbol_part
from rsym.language.equations import OPERATORS, UNKNOWN
from rsym.language.functions import operations
from rsym.language.syntax import Call, Expression, Name, Product, Sum, Vector, names_in, postorder
from rsym.model.symbols import real_symbol, substitute
from rsym.model.systems import R0
from rsym.model.wording import listing, proposal
from rsym.problems.terms import SECOND, MatrixTerm, Meaning, Row, ScalarTerm, TermCalculus, VectorTerm, too_high

ANISOTROPIC = "what diffuses by a matrix is written -div([[2, k], [k, 3]]*grad(u))"
Read: TypeAlias = ScalarTerm | VectorTerm | MatrixTerm


class EquationReader:
    """The tree of an equation to its coefficients: formulas without u by the builder of the language, the rest here."""

    def __init__(self, calculus: TermCalculus, meanings: Mapping[str, Meaning]) -> None:
        self._d = calculus
        self._meanings = meanings
        self._builder = FormulaBuilder(operations(R0))

    def scalar(self, expression: Expression) -> ScalarTerm:
        """A side of an equation."""
        found = self._read(expression)
        if not isinstance(found, ScalarTerm):
            what = "a vector" if isinstance(found, VectorTerm) else "a matrix"
            raise expression.place.refuse(f"{what} stands where a number must", "equation", "take its divergence")
        return found

    def _read(self, expression: Expression) -> Read:
        done: list[Read | None] = []
        held: list[bool] = []
        for node in postorder(expression):
            first = len(done) - len(node.parts)
            mixed = any(held[first:]) or self._is_mixed(node)
            if mixed:
                parts = [
                    self._plain(part) if one is None else one
                    for part, one in zip(node.parts, done[first:], strict=True)
                ]
                made = self._combined(node, parts)
            done[first:], held[first:] = [made if mixed else None], [mixed]
        return self._plain(expression) if done[0] is None else done[0]

    def _is_mixed(self, node: Expression) -> bool:
        known = isinstance(node, Name) and (node.name == UNKNOWN or isinstance(self._meanings.get(node.name), tuple))
        return known or isinstance(node, Vector) or (isinstance(node, Call) and node.function in OPERATORS)

    def _plain(self, expression: Expression) -> ScalarTerm:
        """A formula without u."""
        known = {name.name: name for name in names_in(expression)}
        coordinates = [symbol.name for symbol in self._d.coordinates]
        for name in known.values():
            if name.name not in coordinates and name.name not in self._meanings and name.name != "pi":
                words = [*coordinates, *self._meanings, UNKNOWN]
                raise name.place.refuse(
                    f"the name {name.name!r} means nothing here; there are {listing(words)}",
                    "unknown-name",
                    proposal(name.name, words, f"letters={{'{name.name}': ...}} says what it is"),
                )
        parts = {name: symbol_part(name) for name in known}
        if "pi" in parts:
            parts["pi"] = replace(parts["pi"], expression=sp.pi, number=float(sp.pi))
        value = self._builder.build(expression, parts).outer
        places = {real_symbol(name): self._meanings[name] for name in known if name in self._meanings}
        return replace(self._d.nothing, value=substitute(value, places) if places else value)

    def _combined(self, node: Expression, parts: list[Read]) -> Read:
        d = self._d
        match node:
            case Name() if node.name == UNKNOWN:
                return replace(d.nothing, zero=sp.S.One)
            case Name():
                return self._meant(node)
            case Vector():
                return self._vector(node, parts)
            case Sum():
                terms = [
                    one if sign > 0 else one.scaled(sp.S.NegativeOne, d)
                    for sign, one in zip(node.signs, parts, strict=True)
                ]
                if len({type(one) for one in terms}) > 1:
                    raise node.place.refuse("a sum of numbers and vectors", "equation", "correct the equation")
                total: Any = terms[0]
                for one in terms[1:]:
                    total = total.plus(one)
                summed: Read = total
                return summed
            case Product():
                return self._product(node, parts)
            case Call():
                return self._called(node, parts)
        raise node.place.refuse(
            f"the equation is not linear in {UNKNOWN}", "equation", "linear equations are solved: no powers of u"
        )

    def _meant(self, node: Name) -> Read:
        """The vector or matrix that a name stands for."""
        d, rows = self._d, self._meanings[node.name]
        assert isinstance(rows, tuple)
        shape = {len(row) if isinstance(row, tuple) else 0 for row in rows}
        if len(rows) != len(d.coordinates) or shape not in ({0}, {len(rows)}) or _deep(rows):
            raise node.place.refuse(
                f"{node.name} is neither a vector of {len(d.coordinates)} numbers nor a matrix of such",
                "equation",
                f"letters={{'{node.name}': ((2, 0), (0, 1))}}",
            )
        known: Any = rows
        return MatrixTerm(known) if shape != {0} else VectorTerm(known, d.zeros, (d.zeros,) * len(rows), sp.S.Zero)

    def _vector(self, node: Vector, parts: list[Read]) -> VectorTerm | MatrixTerm:
        rows = [one.value for one in parts if isinstance(one, VectorTerm) and one.plain]
        if len(rows) == len(parts) == len(self._d.coordinates):
            return MatrixTerm(tuple(rows))
        numbers = [one for one in parts if isinstance(one, ScalarTerm)]
        if len(numbers) != len(parts) or len(parts) != len(self._d.coordinates):
            raise node.place.refuse(
                f"a vector has {len(self._d.coordinates)} numbers", "equation", f"for example [1, 2]; {ANISOTROPIC}"
            )
        if any(one.fourth or any(map(any, one.second)) for one in numbers):
            raise too_high()
        return VectorTerm(
            tuple(one.value for one in numbers),
            tuple(one.zero for one in numbers),
            tuple(one.first for one in numbers),
            sp.S.Zero,
        )

    def _product(self, node: Product, parts: list[Read]) -> Read:
        factor: sp.Expr = sp.S.One
        whole: Read | None = None
        for sign, one in zip(node.signs, parts, strict=True):
            if isinstance(one, ScalarTerm) and one.plain:
                factor = factor * one.value if sign > 0 else factor / one.value
            elif whole is None and sign > 0:
                whole = one
            elif sign > 0 and isinstance(whole, MatrixTerm) and isinstance(one, VectorTerm):
                whole = whole.times(one)
            elif sign > 0 and {type(one), type(whole)} == {ScalarTerm, VectorTerm}:
                whole = self._times(node, *((one, whole) if isinstance(one, ScalarTerm) else (whole, one)))
            else:
                raise node.place.refuse(
                    f"the equation is not linear in {UNKNOWN}, or a product of vectors is in it",
                    "equation",
                    "of vectors take the product by dot(v, w), of a matrix and a vector k*grad(u)",
                )
        return replace(self._d.nothing, value=factor) if whole is None else whole.scaled(factor, self._d)

    def _times(self, node: Product, s: Any, v: Any) -> VectorTerm:
        """A multiple of u times a vector without it."""
        if s.value or any(s.first) or any(map(any, s.second)) or s.fourth or not v.plain:
            raise node.place.refuse(f"the equation is not linear in {UNKNOWN}", "equation", SECOND)
        zeros = self._d.zeros
        return VectorTerm(zeros, tuple(s.zero * one for one in v.value), (zeros,) * len(zeros), sp.S.Zero)

    def _called(self, node: Call, parts: list[Read]) -> Read:
        d, (first, *rest) = self._d, parts
        name = node.function
        if name not in OPERATORS:
            what = UNKNOWN if all(isinstance(one, ScalarTerm) for one in parts) else "a vector or a matrix"
            raise node.place.refuse(f"{name} of {what}: the equation is not linear", "equation", SECOND)
        if isinstance(first, MatrixTerm) or isinstance(first, VectorTerm) != (name in ("div", "dot")):
            what = "a vector" if name in ("div", "dot") else "a number"
            raise node.place.refuse(f"{name} takes {what}", "equation", 'for example "-div(k*grad(u)) = f"')
        if isinstance(first, VectorTerm):
            return d.div(first) if name == "div" else self._dot(node, first, rest[0])
        if name == "diff":
            for word in node.parts[1:]:
                names = [symbol.name for symbol in d.coordinates]
                if not isinstance(word, Name) or word.name not in names:
                    raise node.place.refuse("diff is by coordinates", "equation", f"for example diff(u, {names[0]})")
                first = d.diff(first, names.index(word.name))
            return first
        if name == "grad":
            return d.grad(first)
        once = d.div(d.grad(first))
        return once if name == "laplacian" else d.div(d.grad(once))

    def _dot(self, node: Call, one: VectorTerm, other: Any) -> ScalarTerm:
        pair = [one, other]
        plain = [v for v in pair if isinstance(v, VectorTerm) and v.plain]
        if not plain or not isinstance(other, VectorTerm):
            raise node.place.refuse("dot takes two vectors, one without u", "equation", "dot([1, 2], grad(u))")
        known = plain[0]
        rest = other if known is one else one
        if rest.third:
            raise too_high()
        axes = self._d.axes

        def with_known(row: Row) -> sp.Expr:
            return sum((a * b for a, b in zip(known.value, row, strict=True)), sp.S.Zero)

        first = tuple(with_known(tuple(rest.matrix[i][j] for i in axes)) for j in axes)
        return replace(self._d.nothing, value=with_known(rest.value), zero=with_known(rest.zero), first=first)


def _deep(rows: tuple[Any, ...]) -> bool:
    """Whether entries of a matrix are vectors again."""
    return any(isinstance(one, tuple) for row in rows if isinstance(row, tuple) for one in row)
