"""Value and gradient of leaves in parts: at each place of the parts that matter there, by regions that keep the value.

The derivative of a part by a coordinate is total: those of its operands are inputs of its tape, as their values are.
So the sums are those of the derivative of the whole leaf, and the bits are.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from rsym.arrays import Floats, Ints, Shorts
from rsym.backends.tape import aligned
from rsym.logic.leaf_parts import NONE, OPERANDS
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.expansion import expand
from rsym.program.program import Node, Program, assemble
from rsym.sampling.kernels.form_code import AXES, leaf_outputs
from rsym.sampling.regions.kept_regions import KeptRegions, Narrow
from rsym.sampling.regions.leaf_tapes import SCALE, LeafTapes, check_tape, kind_tape, leaf_numbers
from rsym.sampling.regions.point_groups import by_number
from rsym.sampling.regions.region_calls import call, portions, tapes_of
from rsym.sampling.regions.region_tapes import STEP, FormTapes
from rsym.sampling.regions.regions import Regions

OUTPUTS = 1 + len(AXES)


class LargeLeafTapes:
    """The tapes of value and gradient of parts and of choices, and what each leaf in parts is made of."""

    def __init__(self, parts: LeafTapes, whole: Regions, leaves: int) -> None:
        self._parts = parts
        what, operand, _ = whole.entries.T
        tops = np.flatnonzero((0 <= what) & (what < leaves) & (operand != NONE))
        self._regions = {int(what[top]): _below(whole, int(top)) for top in tops}
        made: dict[tuple[int, ...], int] = {}
        self._kind, programs = np.zeros(parts.count, np.int64), list[Program]()
        # By which coordinates an entry has a derivative, as bits.
        axes = [0] * (len(what) + 1)
        for entry, (number, *below) in enumerate(whole.entries.tolist()):
            if number >= 0:
                key = int(parts.kind[number]), *(axes[one] for one in below)
                if key not in made:
                    made[key] = len(programs)
                    programs.append(total_program(parts.kinds[key[0]].formulas.form, key[1:]))
                self._kind[number] = made[key]
                axes[entry] = _axes(programs[made[key]])
        for program in programs:
            check_tape(program)
        self._tapes = [kind_tape(program, leaf_outputs(0)) for program in programs]
        self._forms = FormTapes(self._tapes, self._kind, len(OPERANDS))

    @property
    def leaves(self) -> frozenset[int]:
        """The numbers of leaves in parts."""
        return frozenset(self._regions)

    def at(self, letters: Sequence[float], scales: Floats, bounds: Bounds | None, narrow: Narrow) -> LargeLeaves:
        """With letters and the scales of all parts."""
        numbers = leaf_numbers(self._tapes, self._kind, self._parts.letters.at(letters, scales))
        kept = {k: KeptRegions(bounds, region, narrow) for k, region in self._regions.items()}
        return LargeLeaves(self._forms, numbers, kept)


class LargeLeaves:
    """Value and gradient of the leaves in parts, for some letters."""

    def __init__(self, forms: FormTapes, numbers: tuple[Floats, Ints], kept: Mapping[int, KeptRegions]) -> None:
        self._forms, self._numbers, self._kept = forms, numbers, kept

    def leaf(self, leaf: Shorts, points: Floats, value: Floats, gradient: Floats) -> None:
        """Value and gradient where the leaf is one of these; points (3, n), leaves of which are numbers (n,)."""
        for number, kept in self._kept.items():
            own = np.flatnonzero(leaf == number)
            if len(own):
                found = self._of_one(kept, points[:, own])
                value[own], gradient[:, own] = found[0], found[1:]

    def slide(self, leaf: Shorts, points: Floats, steps: int) -> None:
        """Newton steps along the gradient where the leaf is one of these."""
        for number, kept in self._kept.items():
            own = np.flatnonzero(leaf == number)
            for _ in range(steps if len(own) else 0):
                f, *g = self._of_one(kept, points[:, own])
                with np.errstate(all="ignore"):
                    points[:, own] -= f / (g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + 1e-300) * np.array(g)

    def without_these(self, leaf: Shorts) -> Shorts:
        """The numbers of leaves, none instead of these."""
        return np.where(np.isin(leaf, list(self._kept)), np.int16(-1), leaf)

    def _of_one(self, kept: KeptRegions, points: Floats) -> Floats:
        """Value and gradient (4, n) of one leaf."""
        numbers, regions = kept.at(points)
        which, begin, padded_places, places, order = by_number(numbers)
        given = points.take(padded_places, axis=1)
        found, sorted_ones = np.empty((OUTPUTS, given.shape[1])), regions[which]
        sizes = len(given), OUTPUTS, given.shape[1]
        for a, b in portions(np.diff(sorted_ones.start)):
            some = sorted_ones[a:b]
            codes = self._forms.codes(some, self._numbers)
            last = self._forms.coordinates + OUTPUTS * (np.diff(some.start) - 1)
            ends = STEP * (last[:, None] + np.arange(OUTPUTS))
            call(
                "leaves", 0, b - a, np.ascontiguousarray(begin[a : b + 1]), given, *sizes, found, ends,
                *tapes_of(codes, aligned(codes.memory)),
            )  # fmt: skip
        result = np.empty((OUTPUTS, points.shape[1]))
        result[:, order] = found[:, places]
        return result


def without_leaves(form: SignForm, leaves: Collection[int]) -> SignForm:
    """The form with 0 in the place of these leaves."""
    zero = form.builder.const(0)
    return replace(form, leaves=tuple(zero if k in leaves else leaf for k, leaf in enumerate(form.leaves)))


def _below(whole: Regions, top: int) -> Regions:
    """The region of one entry and all that it needs."""
    need = np.zeros(top + 1, np.bool_)
    need[top] = True
    for i in range(top, -1, -1):
        if need[i]:
            operands = whole.entries[i, 1:]
            need[operands[operands != NONE]] = True
    place = np.cumsum(need) - 1
    entries = whole.entries[: top + 1][need].copy()
    entries[:, 1:] = np.where(entries[:, 1:] == NONE, NONE, place[entries[:, 1:]])
    return Regions(np.array([0, len(entries)]), entries)


def total_program(form: SignForm, operands: Sequence[int]) -> Program:
    """Value and derivatives of a part times its scale, behind each operand its derivatives as coordinates.

    `operands` tell by bits which of these there are; others are 0 also where a choice has no derivative.
    """
    source = form.builder
    axes = source.coordinates[: len(AXES)]
    given = [name for operand in OPERANDS for name in (operand, *(f"{operand} by {axis}" for axis in axes))]
    b = Builder((*axes, *given), (*source.letters, SCALE))
    made: list[int] = []
    for node in source.nodes:
        made.append(b.make(node.operation, *(made[argument] for argument in node.arguments), data=node.data))
    for operand, some in zip(OPERANDS, operands, strict=True):
        for k, axis in enumerate(axes):
            depends = some >> k & 1
            b.derivatives[b.input(operand), axis] = b.input(f"{operand} by {axis}") if depends else b.const(0)
    value = b.mul(b.input(SCALE), made[form.leaves[0]])
    outputs = (value, *(derivative(b, value, axis) for axis in axes))
    return expand(assemble(b.nodes, b.coordinates, b.letters, dict(zip(leaf_outputs(0), outputs, strict=True))))


def _axes(program: Program) -> int:
    """Which of the derivatives are not 0 by their formula, as bits."""
    zero = Node("const", (), Fraction(0))
    return sum((program.nodes[number] != zero) << k for k, (_, number) in enumerate(program.outputs[1:]))
