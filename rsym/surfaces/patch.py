"""Patches: surfaces p(u, v) in space over a rectangle of parameters.

A kind of patch says what its derivatives are; points, normals, curvatures,
meshes and formulas follow from them here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from operator import index
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.abridging import ROOM, weight
from rsym.model.letters import Letters
from rsym.model.requirements import several
from rsym.surfaces import forms
from rsym.surfaces.parameters import Interval, LetterValues, inside, parameter_arrays

if TYPE_CHECKING:
    from rsym.sampling.mesh import Mesh

Domain: TypeAlias = tuple[Interval, Interval]
Orders: TypeAlias = Sequence[tuple[int, int]]
POSITION = (0, 0)


class Patch(ABC):
    """A surface p(u, v): parameters broadcast, points come back as (..., 3).

    `letters` overrides the defaults of the letters by name. The normal is that of p_u x p_v; curvatures are positive
    where the surface bends towards its normal. In a closed direction parameters are taken modulo the period.

    Examples
    --------
    >>> class Saddle(Patch):
    ...     domain = ((-1.0, 1.0), (-1.0, 1.0))
    ...     def evaluate(self, u, v, orders, letters=None):
    ...         zero = 0 * u * v
    ...         known = {(0, 0): (u + zero, v + zero, u * v), (1, 0): (1, 0, v), (0, 1): (0, 1, u), (1, 1): (0, 0, 1)}
    ...         return [np.stack([zero + one for one in known.get(order, (0, 0, 0))], axis=-1) for order in orders]
    >>> Saddle()(0.5, [0.0, 1.0]).tolist()
    [[0.5, 0.0, 0.0], [0.5, 1.0, 0.5]]
    >>> Saddle().grid([0.0, 0.5, 1.0], [0.0, 1.0]).shape
    (3, 2, 3)
    >>> float(Saddle().gaussian_curvature(0, 0))
    -1.0
    """

    @property
    @abstractmethod
    def domain(self) -> Domain:
        """The intervals of u and v."""

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether the surface closes smoothly in u, and in v."""
        return (False, False)

    @property
    def letters(self) -> Letters:
        """The named parameters."""
        return Letters({})

    @abstractmethod
    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives d^(i+j)p/du^i dv^j for each (i, j), at arrays that broadcast and lie in the domain."""

    def expression(self) -> sp.ImmutableMatrix:
        """The point (x, y, z) as SymPy expressions in `rsym.surfaces.symbols`' u and v and the letters."""
        raise RsymError(
            f"this {type(self).__name__} is not made of formulas alone",
            code="no-formula",
            remedy="give its curves as SymPy expressions",
        )

    def __call__(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """Points (..., 3)."""
        return self.derivatives(u, v, (POSITION,), letters=letters)[0]

    def grid(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """Points (len u, len v, 3) at all pairs of two vectors."""
        rows, columns = (np.atleast_1d(parameter_arrays(one)[0]) for one in (u, v))
        if rows.ndim != 1 or columns.ndim != 1:
            raise RsymError(
                f"a grid is spanned by two vectors, got arrays of the shapes {rows.shape} and {columns.shape}",
                code="array",
                remedy="call the patch itself: patch(u, v) broadcasts",
            )
        return self.derivatives(rows[:, None], columns[None, :], (POSITION,), letters=letters)[0]

    def derivative(
        self, u: ArrayLike, v: ArrayLike, order: tuple[int, int] = (1, 0), *, letters: LetterValues = None
    ) -> Floats:
        """The derivative d^(i+j)p/du^i dv^j of order (i, j), as (..., 3)."""
        return self.derivatives(u, v, (order,), letters=letters)[0]

    def derivatives(self, u: ArrayLike, v: ArrayLike, orders: Orders, *, letters: LetterValues = None) -> list[Floats]:
        """Several derivatives at the same parameters; cheaper than one after the other."""
        whole = [_order(order) for order in orders]
        if letters:
            self.letters.values_with(letters)
        rows, columns = (
            inside(one, interval, closed, name)
            for one, interval, closed, name in zip(parameter_arrays(u, v), self.domain, self.closed, "uv", strict=True)
        )
        return self.evaluate(rows, columns, whole, letters) if whole else []

    def normal(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """Unit normals (..., 3): p_u x p_v over its length; at a pole, where one is 0, the limit from inside."""
        return forms.normals(self, u, v, letters)

    def first_fundamental_form(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """[[E, F], [F, G]] = products of p_u and p_v, (..., 2, 2)."""
        return forms.first_form(self, u, v, letters)

    def second_fundamental_form(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """[[L, M], [M, N]] = products of the normal with p_uu, p_uv, p_vv, (..., 2, 2)."""
        return forms.second_form(self, u, v, letters)

    def gaussian_curvature(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """K = (LN - M**2)/(EG - F**2); at a pole its limit."""
        return forms.curvatures(self, u, v, letters)[0]

    def mean_curvature(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """H = (EN - 2FM + GL)/(2(EG - F**2)); at a pole its limit."""
        return forms.curvatures(self, u, v, letters)[1]

    def principal_curvatures(self, u: ArrayLike, v: ArrayLike, *, letters: LetterValues = None) -> Floats:
        """H + sqrt(H**2 - K) and H - sqrt(H**2 - K), (..., 2)."""
        return forms.principal(*forms.curvatures(self, u, v, letters))

    def mesh(self, resolution: int | tuple[int, int] = 64, *, letters: LetterValues = None) -> Mesh:
        """A mesh with exact normals; see `mesh_patches`, which welds several patches."""
        from rsym.surfaces.meshes import mesh_patches  # meshes need a compiler that patches do without

        return mesh_patches(self, resolution, letters=letters)

    def __repr__(self) -> str:
        intervals = [f"{name} in [{low:.6g}, {high:.6g}]" for name, (low, high) in zip("uv", self.domain, strict=True)]
        closed = [f"closed in {name}" for name, closed in zip("uv", self.closed, strict=True) if closed]
        letters = [f"{name} = {letter.default}" for name, letter in self.letters.items()]
        return f"{type(self).__name__}({', '.join([*intervals, *closed, *letters])})"

    def _repr_latex_(self) -> str | None:
        """The formula for a notebook; none where the patch is not a formula, or a long one."""
        try:
            point = self.expression()
        except RsymError:
            return None
        short = sum(weight(entry, ROOM) for entry in point) <= 2 * ROOM  # of three coordinates: below 4 kB
        return f"$\\displaystyle {sp.latex(point)}$" if short else None


def patches_of(given: Any) -> list[Patch]:
    """One patch or an iterable of them, as a list; anything else is refused.

    Examples
    --------
    >>> patches_of("sphere")
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: expected a Patch or several, got str; remedy: a patch of rsym.surfaces
    """
    return several(Patch, given, "patch")  # type: ignore[type-abstract]


def own_letters(patches: Sequence[Patch], letters: LetterValues) -> list[dict[str, float]]:
    """For each patch the values of its own letters; a letter of none of them is refused.

    Patches may give different defaults to one letter.

    Examples
    --------
    >>> own_letters([], {"a": 1})
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: no letter 'a'; the letters are: none; remedy: use one of these, or none
    """
    Letters({name: letter for patch in patches for name, letter in patch.letters.items()}).values_with(letters)
    given = {str(key): value for key, value in (letters or {}).items()}
    return [{name: given[name] for name in patch.letters if name in given} for patch in patches]


def _order(given: Any) -> tuple[int, int]:
    """A pair of integers of Python."""
    try:
        i, j = given
        order = index(i), index(j)
    except (TypeError, ValueError):
        order = (-1, -1)
    if min(order) < 0 or isinstance(i, bool) or isinstance(j, bool):
        raise RsymError(f"an order is a pair of integers >= 0, got {given!r}", code="order", remedy="(1, 0) for p_u")
    return order
