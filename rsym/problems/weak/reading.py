"""Forms written as Python functions to their coefficients: each function is called once, with what is traced."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import EllipsisType
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, substitute, symbols_of
from rsym.model.wording import listing, proposal
from rsym.problems.conditions import Name, assigned, require_part
from rsym.problems.equations import meanings_of
from rsym.problems.terms import Meaning
from rsym.problems.weak.traced import (
    AS_LETTER,
    NONE,
    Term,
    Traced,
    coefficient_of,
    coefficients,
    form_functions,
    objects,
)
from rsym.problems.weak.weak_form import BOUNDARY, INSIDE, NORMALS, SIZE, FormTerms, GivenValues, WeakForm

CALLS = "a(u, v, w) gives what is integrated on the left side, l(v, w) what is on the right one"
UNREAD = f"{CALLS}; functions of what SymPy's functions gave are SymPy's too; {AS_LETTER}"


@dataclass(frozen=True)
class FormPlace:
    """The place w of a form.

    x : the array of the coordinates. h : the size of the cells. n : the outward normal, of forms on the boundary.
    Letters go by their names, ``w.k`` or ``w["k"]``.

    Examples
    --------
    >>> from rsym import x, y
    >>> w = FormPlace((x, y), {"k": 1 + x**2}, on_boundary=False)
    >>> w.k * w.x[1], np.sqrt(w["k"])
    (y*(x**2 + 1), sqrt(x**2 + 1))
    """

    coordinates: tuple[sp.Symbol, ...]
    meanings: Mapping[str, Meaning]
    on_boundary: bool

    @property
    def x(self) -> NDArray[Any]:
        """The coordinates (dimension,)."""
        return objects(list(map(coefficient_of, self.coordinates)))

    @property
    def h(self) -> Traced:
        """The size of the cells."""
        self._require_own("h")
        return coefficient_of(real_symbol(SIZE))

    @property
    def n(self) -> NDArray[Any]:
        """The outward normal (dimension,)."""
        self._require_own("n")
        if not self.on_boundary:
            raise RsymError(
                "w.n, the normal, stands in a form inside of the shape",
                code="form",
                remedy='what is on the boundary is a form of its own: {"inside": a, "rim": on_the_rim}',
            )
        return objects([coefficient_of(real_symbol(name)) for name in NORMALS[: len(self.coordinates)]])

    def __getitem__(self, name: str) -> Any:
        if name not in self.meanings:
            words = [*self.meanings, "x", "h", *["n"] * self.on_boundary]
            raise RsymError(
                f"w has no {name!r}; it has {listing(words)}",
                code="unknown-letter",
                remedy=proposal(name, words, f"letters={{{name!r}: ...}} says what it is"),
            )
        return coefficients(self.meanings[name])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self[name]

    def _require_own(self, name: str) -> None:
        if name in self.meanings:
            raise RsymError(
                f"w.{name} is a word of forms, and there is a letter {name!r}",
                code="form",
                remedy=f'the letter is w["{name}"]; rename it to have both',
            )


def weak_form(shape: Shape, a: Any, l: Any, named: Mapping[str, Any], axis: int | None = None) -> WeakForm:  # noqa: E741
    """The coefficients of the forms a(u, v, w) and l(v, w), each a function or one for each of several places.

    named : what names stand for that are no coordinates, as in `equation_of`.

    Raises
    ------
    RsymError
        For a form that is not linear in u or v, or no formula; an unknown name or place.

    Examples
    --------
    >>> import rsym
    >>> form = weak_form(rsym.disc(1), lambda u, v, w: 2 * u.grad @ v.grad, {"inside": lambda v, w: w.x[0] * v}, {})
    >>> form.inside
    FormTerms(form={(1, 1): 2, (2, 2): 2}, load={0: x})
    """
    functions, meanings = meanings_of(named)
    read = _Reader(shape, functions, meanings, axis)
    inside, edges = FormTerms(), list[dict[Name, FormTerms]]()
    for called, given, bilinear in (("a", a, True), ("l", l, False)):
        forms = given if isinstance(given, Mapping) else {INSIDE: given}
        terms = {place: read.terms(called, one, place, bilinear=bilinear) for place, one in forms.items()}
        inside = inside.plus(terms.pop(INSIDE, FormTerms()))
        assigned(shape, [place for place in terms if place != BOUNDARY])
        edges.append(terms)
    functions = {**functions, SIZE: GivenValues(1.0)}
    made = WeakForm(shape.coordinates, inside, tuple(edges), functions)
    return made if made.sized else replace(made, functions={k: f for k, f in functions.items() if k != SIZE})


@dataclass(frozen=True)
class _Reader:
    """What forms on a shape may speak of."""

    shape: Shape
    functions: Mapping[str, Callable[..., Any]]
    meanings: Mapping[str, Meaning]
    axis: int | None

    def terms(self, called: str, function: Any, place: str | EllipsisType, *, bilinear: bool) -> FormTerms:
        """The coefficients of one form."""
        self._require_place(place)
        function = getattr(function, "form", function)  # of what a decorator of scikit-fem has made
        if not callable(function) or isinstance(function, sp.Basic):
            raise RsymError(f"the form {called} must be a function, got {function!r}", code="form", remedy=CALLS)
        u, v = form_functions(tuple(symbol.name for symbol in self.shape.coordinates), self.axis)
        w = FormPlace(self.shape.coordinates, self.meanings, place != INSIDE)
        try:
            found = function(u, v, w) if bilinear else function(v, w)
        except RsymError:
            raise
        except (TypeError, AttributeError, ValueError, IndexError) as error:
            raise RsymError(
                f"the form {called} cannot be read as a formula: {error}",
                code="form",
                remedy=UNREAD,
            ) from error
        if np.ndim(found):
            raise RsymError(
                f"the form {called} gives an array of the shape {np.shape(found)}, not a number",
                code="form",
                remedy="products of vectors are u.grad @ v.grad, of a matrix K and a vector K @ u.grad",
            )
        traced = coefficient_of(np.asarray(found, object).item())
        return self._sorted(called, traced, bilinear, self._known(place))

    def _sorted(self, called: str, traced: Traced, bilinear: bool, known: set[str]) -> FormTerms:
        form: dict[Term, sp.Expr] = {}
        load: dict[int, sp.Expr] = {}
        for (test, trial), value in traced.terms.items():
            if test == NONE or (trial == NONE) == bilinear:
                lost = "u" if trial == NONE and bilinear else "v"
                raise RsymError(
                    f"the form {called} has a term without {lost}: {Traced({(test, trial): value}, traced.words)}",
                    code="form",
                    remedy=f"each term of a has u and v, each of l has v alone; {CALLS}",
                )
            if bilinear:
                form[test, trial] = self._checked(value, known)
            else:
                load[test] = self._checked(value, known)
        return FormTerms(form, load)

    def _checked(self, value: sp.Expr, known: set[str]) -> sp.Expr:
        """A coefficient in which names have their meanings."""
        meant = {
            symbol: self.meanings[symbol.name]
            for symbol in symbols_of(value)
            if symbol.name in self.meanings and not isinstance(self.meanings[symbol.name], tuple)
        }
        found = substitute(value, meant) if meant else value
        for symbol in symbols_of(found):
            if symbol.name not in known:
                raise RsymError(
                    f"a form contains {symbol}, neither coordinate nor letter",
                    code="unknown-letter",
                    remedy=f"letters={{'{symbol}': ...}} says what it is",
                )
        assert isinstance(found, sp.Expr)
        return found

    def _known(self, place: str | EllipsisType) -> set[str]:
        own = {SIZE} if place == INSIDE else {SIZE, *NORMALS}
        return {*(symbol.name for symbol in self.shape.coordinates), *self.shape.letters, *self.functions, *own}

    def _require_place(self, place: Any) -> None:
        parts = shape_leaf_parts(self.shape)
        if place in (INSIDE, BOUNDARY) and any(place in names for names in parts):
            raise RsymError(
                f"{place!r} is a part of this shape, and where forms stand that are integrated over all of it",
                code="unknown-part",
                remedy="give the part another name",
            )
        if place is not ... and place not in (INSIDE, BOUNDARY):
            require_part(place, parts, f"forms stand for {INSIDE!r}, {BOUNDARY!r}, a part, or ... the rest")
