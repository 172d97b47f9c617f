"""A shape whose form is zero on its boundary alone: where parts share an edge that is inside, its form is written anew.

What is sought as omega*phi is zero wherever omega is. Of two halves of a disc that is all along the line between
them, of parts that overlap by little nearly so; and where a leaf stands in two parts, more than two leaves are zero at
a corner, whose functions are then not known.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError, warn
from rsym.logic.separation import multiple, separated
from rsym.logic.sign_form import shape_form
from rsym.logic.weights import constant_speed
from rsym.model.operations import conjunction, disjunction
from rsym.model.recent import placed, recently
from rsym.model.shape import Shape
from rsym.problems.seams.atoms import SignAtoms, atoms_of
from rsym.problems.seams.clauses import Clause, clauses_of
from rsym.problems.seams.isolated import isolated_zeros
from rsym.problems.seams.proof import unproved
from rsym.problems.seams.rows import SignRows, rows_around, rows_at, rows_of, rows_on
from rsym.problems.seams.slits import slit_of
from rsym.sampling.extent import extent
from rsym.sampling.labels import Labeller
from rsym.sampling.windows import relettered

BEYOND = 0.05  # of the size: how far extents may differ
MOST_ATOMS = 60  # beyond, a form stays as it is typed, or is refused
ROUNDS = 4  # of clauses, of which each knows the places where those before were wrong
SPREAD = 1e-3, 1e-5  # of the size: how far from a place where nothing is proved is looked
LOOKED_AT = 64  # points about such a place


class LeafOfTwo(NamedTuple):
    """A leaf with other names where a function is positive than where it is negative; the smallest parts first."""

    leaf: sp.Expr
    where: sp.Expr
    inside: tuple[str, ...]
    outside: tuple[str, ...]


class Seamless(NamedTuple):
    """The shape that a problem is solved on, the one that was typed, and leaves that belong to two parts.

    slit : a place on a slit without width that was typed, and is left out.
    """

    shape: Shape
    typed: Shape
    divided: tuple[LeafOfTwo, ...] = ()
    divisible: bool = True
    slit: tuple[float, ...] | None = None

    @property
    def rewritten(self) -> bool:
        """Whether the form is not the one that was typed."""
        return bool(self.shape.expression != self.typed.expression)

    def told(self) -> Seamless:
        """Itself, with a warning of a slit that is left out."""
        if self.slit is not None:
            warn(
                f"at {_told(self.slit)} the formula is zero inside, the shape being on both sides: such a slit without "
                "width is left out; remedy: give it a width, or leave it out of the formula"
            )
        return self

    def relettered(self, values: Mapping[Any, Any]) -> Seamless:
        """The same at other letters; if that has the same form the objects stay, of which others have kernels."""
        made = seamless(relettered(self.typed, values), self.divisible)
        if made.shape.expression != self.shape.expression or made.shape.parts != self.shape.parts:
            return made
        return made._replace(shape=relettered(self.shape, values))


@recently(16, placed)
def seamless(shape: Shape, divisible: bool = True) -> Seamless:
    """The same body by a form that is zero on its boundary alone, where its letters have their defaults.

    divisible : whether a leaf may belong to two parts of different names.

    Raises
    ------
    RsymError
        ``seam`` where it is zero inside, and no form that is not is found or proved, with the place.

    Examples
    --------
    >>> import rsym
    >>> halves = (rsym.disc(2) & rsym.half_plane((1, 0), 0)) | (rsym.disc(2) & rsym.half_plane((-1, 0), 0))
    >>> seamless(halves).shape
    Shape(-x**2/4 - y**2/4 + 1, (x, y))
    """
    typed = Seamless(separated(shape), shape, divisible=divisible)
    form = shape_form(shape)
    if form.ends or form.builder.rewritten:
        return typed
    atoms = atoms_of(shape)
    if any(leaf.sign == 0 for leaf in atoms.leaves):
        return typed
    if atoms.count > MOST_ATOMS:
        if atoms.shared and len(seams := rows_of(atoms).seams):
            raise _refused(_told(seams[0]))
        return typed
    zeros = isolated_zeros(shape, atoms.form, atoms.box)
    atoms = replace(atoms, functions=(*atoms.functions, *(zero.ball(shape) for zero in zeros)))
    changed = len(atoms.form.leaves) != len(form.leaves) or atoms.reduced
    if not (atoms.shared or changed or zeros):
        return typed
    rows, clauses, place = _proved(atoms, np.array([zero.place for zero in zeros], float).reshape(-1, shape.dimension))
    if clauses is None:
        if not (len(rows.seams) or zeros):
            return typed
        raise _refused(_told(rows.seams[0] if place is None else place))
    leaves = [_literal(atoms, k) for k in range(2 * atoms.count)]
    named = _names(shape, rows, leaves)
    if (named is None or named[1]) and not len(rows.seams):
        return typed
    if named is None:
        raise RsymError(
            "an edge that several parts have in common bounds more than two of them, of different names",
            code="ambiguous-part",
            remedy="give these parts one name, or let each have an edge of its own",
        )
    parts, divided = named
    made = _formed(shape, leaves, clauses)
    if not _ends(made, atoms):
        if not (len(rows.seams) or zeros):
            return typed
        raise _refused("beyond its extent")
    if not divisible:
        parts, split = _split(parts, divided)
        made, divided = _formed(shape, [split.get(leaf, leaf) for leaf in leaves], clauses), ()
    return Seamless(replace(made, parts=parts), shape, divided, divisible, slit_of(shape, form, atoms.box))


def _told(place: Iterable[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in place) + ")"


def _refused(where: str) -> RsymError:
    return RsymError(
        "the formula is zero inside, where parts share an edge, and what is sought would be zero there too; that "
        "another formula is zero on the boundary alone could not be proved",
        code="seam",
        where=where,
        remedy="let the parts overlap there, or give the outline as one part",
    )


def _ends(made: Shape, atoms: SignAtoms) -> bool:
    """Whether the new form has nothing beyond the box in which it is proved."""
    if made.bounds is not None:
        return True
    try:
        found = np.array(extent(made))
    except RsymError:
        return False
    low, high = np.array(atoms.box, float).T
    room = BEYOND * atoms.size
    return bool((found[:, 0] >= low - room).all() and (found[:, 1] <= high + room).all())


def _split(
    parts: Sequence[tuple[str, sp.Expr]], divided: Sequence[LeafOfTwo]
) -> tuple[tuple[tuple[str, sp.Expr], ...], dict[sp.Expr, sp.Expr]]:
    """The parts with two leaves for each that belongs to two of them, and what stands for these leaves.

    In place of f, c being positive in the first part, stands min(max(f, -c), max(f', c)), f' being a multiple of f.
    """
    found, split = [*parts], {}
    for leaf, where, _, outside in divided:
        other = multiple(leaf, 2)
        found = [(name, other if one == leaf and name in outside else one) for name, one in found]
        split[leaf] = conjunction(disjunction(leaf, -where), disjunction(other, where))
    return tuple(found), split


def _proved(atoms: SignAtoms, zeros: Floats) -> tuple[SignRows, tuple[Clause, ...] | None, Floats | None]:
    """Rows, clauses that are proved if there are any, and else a place where they are not; zeros are such inside."""
    rows, place = rows_of(atoms).joined(rows_around(atoms, zeros)), None
    for _ in range(ROUNDS):
        clauses = clauses_of(rows.inside, rows.outside, rows.boundary, rows.own)
        if isinstance(clauses, int):
            on = np.flatnonzero(rows.own == clauses)
            return rows, None, rows.places[on[0]] if len(on) else place
        places = unproved(atoms, clauses)
        if not len(places):
            return rows, clauses, None
        place = places[0]
        random = np.random.default_rng(39)
        for spread in SPREAD:
            near = (places[:, None] + spread * atoms.size * random.normal(size=(LOOKED_AT, places.shape[1]))).reshape(
                -1, places.shape[1]
            )
            for more in (rows_at(atoms, near), rows_on(atoms, near, 2 * spread * atoms.size)):
                rows = rows.joined(more)
        rows = rows.joined(rows_around(atoms, places))
    return rows, None, place


def _literal(atoms: SignAtoms, number: int) -> sp.Expr:
    """A literal, of slope 1 on its zeros where that is constant."""
    function = atoms.functions[number // 2]
    speed = constant_speed(atoms.shape.replace(expression=function))
    one = function if speed is None else sp.expand(function / speed) if function.is_Add else function / speed
    return -one if number % 2 else one


def _formed(shape: Shape, leaves: Sequence[sp.Expr], clauses: Sequence[Clause]) -> Shape:
    """The shape by clauses of leaves, without parts."""
    expression = reduce(conjunction, [reduce(disjunction, [leaves[k] for k in clause]) for clause in clauses])
    return replace(shape, expression=expression, parts=(), definitions=())


def _names(
    shape: Shape, rows: SignRows, leaves: Sequence[sp.Expr]
) -> tuple[tuple[tuple[str, sp.Expr], ...], tuple[LeafOfTwo, ...]] | None:
    """The parts of the new form, each a leaf, and the leaves that belong to two; None where one belongs to more."""
    if not shape.parts:
        return (), ()
    labels = Labeller(shape).nearest(rows.places)
    parts: list[tuple[str, sp.Expr]] = []
    divided: list[LeafOfTwo] = []
    for literal in sorted({*rows.own.tolist()}):
        on = rows.own == literal
        groups = sorted({labels.parts[k] for k in labels.number[on].tolist() if k >= 0})
        leaf = leaves[literal]
        if len(groups) > 1:
            held = np.array([labels.parts[k] == groups[0] if k >= 0 else False for k in labels.number[on].tolist()])
            where = _separator(rows.boundary[on], held) if len(groups) == 2 else None
            if where is None:
                return None
            divided.append(LeafOfTwo(leaf, leaves[where], groups[0], groups[1]))
        parts += [(name, leaf) for group in groups for name in group if name]
    own = {name for name, _ in shape.parts}
    return tuple((name, leaf) for name, leaf in parts if name in own), tuple(divided)


def _separator(rows: Floats, held: Ints) -> int | None:
    """A literal that holds of some rows and of none of the others, if there is one."""
    found = np.flatnonzero(rows[held].all(axis=0) & ~rows[~held].any(axis=0))
    return int(found[0]) if len(found) else None
