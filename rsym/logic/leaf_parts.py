"""Parts of leaves: a large one is cut at the minima and maxima in it, where few of their operands matter at a place.

A choice is a part of its own, and what lies between two of them, a function of the coordinates and of at most two
operands, which are parts again. In a blend of a thousand balls with a function of their own minimum a place needs one
of them, and a region keeps the rest out as it does with leaves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from rsym.logic.lifting import FEW, TURNED, choices_in
from rsym.logic.sign_form import SignForm
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder

OPERANDS = ("operand 1", "operand 2")  # no coordinate of a user has a space in its name
NONE = -1  # instead of an operand
# So many times as many nodes as a leaf may its parts have together, which share nothing.
GROWTH = 4

Entry: TypeAlias = tuple[int | str, int, int]
Cut: TypeAlias = frozenset[int]


@dataclass(frozen=True)
class LeafParts:
    """A form in parts.

    Attributes
    ----------
    form : SignForm
        The parts as leaves, in two coordinates more, `OPERANDS`; the first ones are the leaves of the form in parts,
        in their order and of their values.
    entries : tuple of (what, first, second)
        In the order of evaluation: a part by its number, or a gate of the form, "min" or "max", and the entries of its
        operands, `NONE` where a part lacks one. The last one is the form.
    choices : mapping
        "min" or "max" of the parts that are nothing else, by their numbers.
    """

    form: SignForm
    entries: tuple[Entry, ...]
    choices: Mapping[int, str]


def parted(form: SignForm) -> LeafParts | None:
    """The form in parts, if one of its leaves is worth it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> row = rsym.disjunction(*[1 - (x - 3 * k) ** 2 - y**2 for k in range(100)], system=rsym.R1)
    >>> parts = parted(surface_form(rsym.Shape(row + 1 / (2 + row**2), (x, y, z))))
    >>> len(parts.form.leaves), parts.entries[-2:], parts.choices[199]
    (200, ((199, 196, 197), (0, 198, -1)), 'max')
    """
    cuts = [_cuts(form.builder, leaf) for leaf in form.leaves]
    return _Parting(form).parted(cuts) if any(cuts) else None


def _cuts(builder: Builder, leaf: int) -> dict[int, Cut] | None:
    """Of each node of a large leaf what its formula is cut at; None of others and where an operation has three such."""
    nodes = builder.nodes
    if choices_in(builder, leaf, TURNED) <= FEW:
        return None
    cut: dict[int, Cut] = {}
    for number, below in with_operands(leaf, lambda one: nodes[one].arguments, int):
        if nodes[number].operation in TURNED:
            cut[number] = frozenset({number})
            continue
        found = {one: cut[one] for one in below}
        while len(frozenset().union(*found.values())) > len(OPERANDS):
            most = max(found, key=lambda one: len(found[one]))
            if len(found[most]) < len(OPERANDS):
                return None
            found[most] = frozenset({most})
        cut[number] = frozenset().union(*found.values())
    return cut


class _Parting:
    """The parts that were made, and the entries."""

    def __init__(self, form: SignForm) -> None:
        source = form.builder
        self._form, self._nodes = form, source.nodes
        self._target = Builder((*source.coordinates, *OPERANDS), source.letters)
        self._entries: list[Entry] = []
        self._parts: list[int] = [NONE] * len(form.leaves)
        self._choices: dict[int, str] = {}
        self._places: dict[int, int] = {}  # of entries, by the nodes of the form that they are
        self._made, self._most = 0, GROWTH * len(source.nodes)

    def parted(self, cuts: Sequence[dict[int, Cut] | None]) -> LeafParts | None:
        """Leaf by leaf, then the gates; None where parts would have too many nodes."""
        ends = []
        for k, (leaf, cut) in enumerate(zip(self._form.leaves, cuts, strict=True)):
            for number, _ in with_operands(leaf, partial(self._operands, leaf, cut), int):
                if number != leaf and number not in self._places:
                    self._places[number] = self._entry(number, cut or {}, NONE)
                if self._made > self._most:
                    return None
            ends.append(self._entry(leaf, cut or {}, k))
        for operation, *operands in self._form.gates:
            ends.append(self._add(operation, *(ends[operand] for operand in operands)))
        return LeafParts(SignForm(self._target, tuple(self._parts), ()), tuple(self._entries), self._choices)

    def _operands(self, leaf: int, cut: dict[int, Cut] | None, number: int) -> Sequence[int]:
        """The nodes whose entries that of a node needs."""
        if cut is None:
            return ()
        if self._nodes[number].operation in TURNED and number != leaf:
            return self._nodes[number].arguments
        return sorted(cut[number] - {number})

    def _entry(self, number: int, cut: dict[int, Cut], leaf: int) -> int:
        """The entry of a node whose operands have theirs."""
        operation, arguments, _ = self._nodes[number]
        if operation in TURNED and leaf == NONE:
            self._parts.append(self._target.make(operation, *map(self._target.input, OPERANDS)))
            self._choices[len(self._parts) - 1] = operation
            return self._add(len(self._parts) - 1, *(self._places[argument] for argument in arguments))
        operands = sorted(cut.get(number, frozenset()) - {number})
        part = self._formula(number, operands)
        if leaf == NONE:
            leaf = len(self._parts)
            self._parts.append(part)
        else:
            self._parts[leaf] = part
        first, second = ([self._places[operand] for operand in operands] + [NONE, NONE])[:2]
        return self._add(leaf, first, second)

    def _add(self, what: int | str, first: int, second: int) -> int:
        self._entries.append((what, first, second))
        return len(self._entries) - 1

    def _formula(self, number: int, operands: Sequence[int]) -> int:
        """A node in the coordinates and its operands."""
        made = {one: self._target.input(name) for one, name in zip(operands, OPERANDS, strict=False)}

        def below(one: int) -> Sequence[int]:
            return () if one in made else self._nodes[one].arguments

        for one, _ in with_operands(number, below, int):
            if one not in made:
                operation, arguments, data = self._nodes[one]
                made[one] = self._target.make(operation, *(made[argument] for argument in arguments), data=data)
        self._made += len(made)
        return made[number]
