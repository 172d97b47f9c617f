"""Faces: the places of a leaf in the formula, told apart by the parts of the shape that they belong to.

Equal leaves of a sign form are one function. Two boxes side by side have the plane of their lids in common; the lid of
each is a *face* of its own: a leaf with the parts on the way down to it from the top of the form. Which face bounds the
body at a point depends on the values of the leaves there: from the top down through each gate to the operands that
have its value (`Faces.active`). Where several faces do, the names of all are kept, in one order (`Faces.title`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias, TypeVar

import sympy as sp

from rsym.errors import warn
from rsym.logic.gates import through
from rsym.logic.sign_form import SignForm, shape_form, sign_form
from rsym.logic.stripping import bare, scaled, unscaled
from rsym.model.blends.gates import with_gates
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.model.wording import listing
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all
from rsym.program.program import live

BETWEEN = " / "  # the names of faces that coincide
# So many times the operands of a form its places may be: beyond, a place takes the parts of the first way to it.
GROWTH = 16

T = TypeVar("T")
Key: TypeAlias = tuple[int, bool]  # a node without sign and factor, and the sign


class Face(NamedTuple):
    """A leaf by its number, and the names of the parts around it, the smallest first; none of a leaf of no part."""

    leaf: int
    parts: tuple[str, ...]


class Place(NamedTuple):
    """An operand of a form with the parts around it, and the places above it, none of the top."""

    operand: int
    parts: tuple[str, ...]
    above: tuple[int, ...]


@dataclass(frozen=True)
class Faces:
    """The faces of a sign form.

    Attributes
    ----------
    form : SignForm
        The form, without sides of bounds.
    places : tuple of Place
        From the top down.
    ranks : mapping
        The names of parts to what they are ordered by: their number of leaves, and which was named first.

    Examples
    --------
    >>> import rsym
    >>> pair = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0).named("B")
    >>> faces = shape_faces(pair)
    >>> [face for face in faces.faces if face.leaf == 1]
    [Face(leaf=1, parts=('A',)), Face(leaf=1, parts=('B',))]
    """

    form: SignForm
    places: tuple[Place, ...]
    ranks: Mapping[str, tuple[int, int]] = field(repr=False)

    @cached_property
    def ends(self) -> tuple[int, ...]:
        """The places that are faces, by leaf, of one leaf in the order of titles."""
        count = len(self.form.leaves)
        found = [number for number, place in enumerate(self.places) if place.operand < count]
        return tuple(sorted(found, key=lambda number: (self.places[number].operand, *self._rank(self.places[number]))))

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """The faces."""
        return tuple(Face(self.places[end].operand, self.places[end].parts) for end in self.ends)

    @cached_property
    def told_apart(self) -> bool:
        """Whether there are parts enough for faces to have more than one name."""
        return len({face.parts[:1] for face in self.faces}) > 1

    @cached_property
    def doubled(self) -> bool:
        """Whether a leaf is a multiple of another one."""
        keys = [bare(self.form.builder, leaf) for leaf in self.form.leaves]
        return len({*keys}) < len(keys)

    @cached_property
    def shared(self) -> frozenset[int]:
        """The leaves whose faces have several names, and those that are multiples of others with another name."""
        together: defaultdict[int, set[tuple[str, ...]]] = defaultdict(set)
        keys = [scaled(self.form.builder, leaf)[0] for leaf in self.form.leaves]
        for face in self.faces:
            together[keys[face.leaf]].add(face.parts[:1])
        return frozenset(leaf for leaf, key in enumerate(keys) if len(together[key]) > 1)

    def active(self, values: Sequence[T], equal: Callable[[T, T], Any], least: Mapping[str, Any], top: T) -> list[Any]:
        """For each face where it gives the form its value, from the values of the leaves.

        Values may be arrays, such as of signs on both sides of a surface. `equal` compares them, `least` has the
        functions "min" and "max", `top` is true everywhere.
        """
        made = through(self.form.gates, values, lambda gate, first, second: least[gate.operation](first, second))
        found: list[Any] = []
        for place in self.places:
            own = top if not place.above else None
            for above in place.above:
                taken = found[above] & equal(made[place.operand], made[self.places[above].operand])
                own = taken if own is None else own | taken
            found.append(own)
        return [found[end] for end in self.ends]

    def holding(self, chosen: Iterable[int]) -> tuple[str, ...]:
        """The names of all parts that have one of these faces."""
        return tuple(dict.fromkeys(name for number in chosen for name in self.faces[number].parts))

    def title(self, chosen: Iterable[int]) -> tuple[str, ...]:
        """The names of faces at one place: of each the smallest part, the smallest of these first; else which is first.

        A part around another one that is there goes without saying.
        """
        found = [self.faces[number].parts for number in chosen]
        around = {name for parts in found for name in parts[1:]}
        names = {parts[0] for parts in found if parts}
        return tuple(sorted(names - around or names, key=lambda name: self.ranks[name]))

    def _rank(self, place: Place) -> tuple[int, int]:
        return self.ranks[place.parts[0]] if place.parts else (1 << 62, 0)


@recently(16, written)
def shape_faces(shape: Shape) -> Faces:
    """The faces of ``shape_form(shape)``."""
    return faces_of(shape_form(shape), shape)


def faces_of(form: SignForm, shape: Shape) -> Faces:
    """The faces of the sign form of a shape, as it comes from its expression."""
    named = _Named.of(form, shape)
    found = _places(form, named)
    lost = set(range(len(named.parts))) - _placed(found)
    if lost:  # nothing in the formula has their gates any more; their leaves are theirs
        found = _places(form, named.by_leaves(lost))
        named.tell_of_pieces(lost, _placed(found))
    order = [(operand, parts) for operand in sorted(found, reverse=True) for parts in found[operand]]
    number = {key: k for k, key in enumerate(order)}
    above: defaultdict[int, list[int]] = defaultdict(list)
    for (operand, parts), links in ((key, found[key[0]][key[1]]) for key in order):
        above[number[operand, parts]] = sorted({number[link] for link in links})
    places = tuple(
        Place(operand, tuple(dict.fromkeys(named.parts[part].name for part in parts)), tuple(above[k]))
        for k, (operand, parts) in enumerate(order)
    )
    ranks: dict[str, tuple[int, int]] = {}
    for number_of, part in enumerate(named.parts):
        ranks[part.name] = min(ranks.get(part.name, (part.size, number_of)), (part.size, number_of))
    return Faces(form, places, ranks)


# For each operand the parts around it (numbers, the smallest first), with the operands and parts that lead there.
_Found: TypeAlias = dict[int, dict[tuple[int, ...], dict[tuple[int, tuple[int, ...]], None]]]


def _places(form: SignForm, named: _Named) -> _Found:
    count = len(form.leaves)
    top = count + len(form.gates) - 1 if form.gates else 0
    found: _Found = {top: {parts: {} for parts in named.within(top, ())}}
    most, made = GROWTH * (count + len(form.gates)), 1
    for operand in range(top, count - 1, -1):
        _, *below = form.gates[operand - count]
        for parts in tuple(found.get(operand, ())):
            for one in below:
                known = found.setdefault(one, {})
                for inner in named.within(one, parts):
                    if inner not in known and made > most and known:
                        inner = next(iter(known))
                    made += inner not in known
                    known.setdefault(inner, {})[operand, parts] = None
    return found


def _placed(found: _Found) -> set[int]:
    """The parts that are around some operand."""
    return {number for places in found.values() for parts in places for number in parts}


class _Part(NamedTuple):
    """A named part: its formula and node, how many leaves it has, and the keys of these."""

    name: str
    expression: sp.Expr
    node: int
    size: int
    leaves: frozenset[int]


@dataclass(frozen=True)
class _Named:
    """Which parts begin at which operands of a form: one list of parts, the inner ones first, for each of several."""

    parts: tuple[_Part, ...]
    begins: Mapping[int, tuple[tuple[int, ...], ...]]
    keys: tuple[int, ...]  # of the leaves, without sign
    own: frozenset[int]  # parts of one leaf that stand outside of all others

    @classmethod
    def of(cls, form: SignForm, shape: Shape) -> _Named:
        builder = form.builder
        known = {*builder.coordinates, *builder.letters}
        # A part may speak of letters that have cancelled out of the shape: it is no part of it any more.
        given = [part for part in shape.parts if all(symbol.name in known for symbol in symbols_of(part[1]))]
        # SymPy moves the sign of -(a - b) inwards, so a negation may be another formula: b - a. It multiplies out.
        plain = [part.as_coeff_Mul()[1] for _, part in given]
        nodes = lower_all(builder, [signed for part in plain for signed in map(with_gates, (part, -part))])
        written, alike = _Numbers(_as_written, form), _Numbers(unscaled, form)
        at: defaultdict[int, list[int]] = defaultdict(list)
        parts = []
        for number, (name, expression) in enumerate(given):
            both = nodes[2 * number : 2 * number + 2]
            forms = [sign_form(builder, node) for node in (*both, *map(builder.neg, both))]
            leaves = [bare(builder, leaf) for one in forms for leaf in one.leaves]
            parts.append(_Part(name, expression, both[0], len(forms[0].leaves), frozenset(leaves)))
            for operand in written.operands(forms) or alike.operands(forms):
                at[operand].append(number)
        begins = {operand: _chains(builder, parts, same) for operand, same in at.items()}
        keys = tuple(bare(builder, leaf) for leaf in form.leaves)
        named = cls(tuple(parts), begins, keys, frozenset())
        outside = {chain[0] for operand in _outside(form, begins) for chain in begins[operand]}
        own = frozenset(number for number in outside if parts[number].size == 1)
        return cls(named.parts, begins, keys, own)

    def tell_of_pieces(self, lost: Iterable[int], found: Collection[int]) -> None:
        """Warn of names that only some of their parts have, or a part on only some of its leaves."""
        known, keys = {self.parts[number].name for number in found}, {*self.keys}
        pieces = {
            self.parts[number].name for number in lost if number not in found or not self.parts[number].leaves <= keys
        }
        if pieces & known:
            warn(
                f"not all of {listing(sorted(pieces & known))} can be told in the formula, where parts have become one "
                "leaf: what is asked of that name is of the rest; remedy: name what comes out, with shape.named"
            )

    def by_leaves(self, lost: Iterable[int]) -> _Named:
        """The same, some parts at their leaves."""
        begins = dict(self.begins)
        for number in lost:
            for leaf, key in enumerate(self.keys):
                if key in self.parts[number].leaves:
                    begins[leaf] = tuple((number, *chain) for chain in begins.get(leaf, ((),)))
        return _Named(self.parts, begins, self.keys, self.own)

    def within(self, operand: int, around: tuple[int, ...]) -> Iterable[tuple[int, ...]]:
        """The parts around an operand, for those around the place above."""
        for chain in self.begins.get(operand, ((),)):
            # A plane that is a part by itself is none of a box that has a side in it.
            inner = [one for one in chain if not (around and one in self.own)]
            yield tuple(dict.fromkeys((*inner, *around)))


def _as_written(builder: Builder, leaf: int) -> Key:
    """A leaf without sign and factor, sums as they are written: multiples of one plane keep parts apart."""
    key, times = scaled(builder, leaf)
    return key, times > 0


class _Numbers:
    """Numbers for operands: equal ones are equal but for positive factors and the order in a gate."""

    def __init__(self, key: Callable[[Builder, int], Any], form: SignForm) -> None:
        self.key, self.known = key, dict[Any, int]()
        self.whole = self._of(form)

    def operands(self, forms: Iterable[SignForm]) -> list[int]:
        """The operands of the form that one of these forms is."""
        tops = {self._of(one)[-1] for one in forms}
        return [operand for operand, number in enumerate(self.whole) if number in tops]

    def _of(self, form: SignForm) -> list[int]:
        def number(key: Any) -> int:
            return self.known.setdefault(key, len(self.known))

        leaves = [number(self.key(form.builder, leaf)) for leaf in form.leaves]
        return through(form.gates, leaves, lambda gate, one, other: number((gate.operation, *sorted((one, other)))))


def _chains(builder: Builder, parts: Sequence[_Part], same: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """Parts with the same gates: those whose formulas are within each other in one list, copies in several.

    What scales a part multiplies it as a whole: formulas are within each other but for a factor too.
    """
    if len(same) == 1:
        return (tuple(same),)
    inside = {number: set(postorder(parts[number].expression)) for number in same}
    bares = {number: bare(builder, parts[number].node) for number in same}
    below = {
        number: {bare(builder, node) for node in live(builder.nodes, [parts[number].node])} - {bares[number]}
        for number in same
    }

    def holds(outer: int, inner: int) -> bool:
        if bares[inner] in below[outer]:
            return True
        return parts[outer].expression != parts[inner].expression and parts[inner].expression in inside[outer]

    first = [one for one in same if not any(holds(one, other) for other in same)]
    return tuple((one, *(other for other in same if holds(other, one))) for one in first)


def _outside(form: SignForm, begins: Mapping[int, Any]) -> list[int]:
    """The operands at which a part begins that no other part is around, by one way at least."""
    count = len(form.leaves)
    top = count + len(form.gates) - 1 if form.gates else 0
    reached, found = {top}, []
    for operand in range(top, -1, -1):
        if operand not in reached:
            continue
        if operand in begins:
            found.append(operand)
        elif operand >= count:
            reached.update(form.gates[operand - count][1:])
    return found
