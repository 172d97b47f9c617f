"""Value and gradient of leaves in parts: at each place of the parts that matter there, by regions that keep the value.

The derivative of a part by a coordinate is total: those of its operands are inputs of its tape, as their values are.
So the sums are those of the derivative of the whole leaf, and the bits are.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from rsym.arrays import Floats, Ints, Shorts
from rsym.backends.interpreter import CHECK_POINTS, check_at
from rsym.backends.tape import TapeFunction, aligned
from rsym.logic.leaf_parts import NONE, OPERANDS
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.expansion import expand
from rsym.program.program import FLOAT64, Program, assemble
from rsym.sampling.kernels.form_code import AXES, leaf_outputs
from rsym.sampling.regions.kept_regions import KeptRegions, Narrow
from rsym.sampling.regions.leaf_tapes import SCALE, LeafTapes, kind_tape, leaf_numbers
from rsym.sampling.regions.point_groups import by_number
from rsym.sampling.regions.region_calls import ENTRIES, call, tapes_of
from rsym.sampling.regions.region_tapes import STEP, FormTapes
from rsym.sampling.regions.regions import MAX, MIN, Regions

OUTPUTS = 1 + len(AXES)


class LargeLeafTapes:
    """The tapes of value and gradient of parts and of choices, and what each leaf in parts is made of."""

    def __init__(self, parts: LeafTapes, whole: Regions, leaves: int) -> None:
        self._parts = parts
        what, operand, _ = whole.entries.T
        tops = np.flatnonzero((0 <= what) & (what < leaves) & (operand != NONE))
        self._choices = {MIN: parts.count, MAX: parts.count + 1}
        self._regions = {int(what[top]): _below(whole, int(top)) for top in tops}
        forms = [*(kind.formulas.form for kind in parts.kinds), *map(_choice, ("min", "max"))]
        programs = [total_program(form) for form in forms]
        for program in programs:
            _check(program)
        self._tapes = [kind_tape(program, leaf_outputs(0)) for program in programs]
        self._kind = np.array([*parts.kind, len(forms) - 2, len(forms) - 1])
        self._forms = FormTapes(self._tapes, self._kind, len(OPERANDS))

    @property
    def leaves(self) -> frozenset[int]:
        """The numbers of leaves in parts."""
        return frozenset(self._regions)

    def at(self, letters: Sequence[float], scales: Floats, bounds: Bounds | None, narrow: Narrow) -> LargeLeaves:
        """With letters and the scales of all parts."""
        given = [*self._parts.letters.at(letters, scales), [1.0], [1.0]]
        numbers = leaf_numbers(self._tapes, self._kind, given)
        kept = {k: KeptRegions(bounds, region, narrow) for k, region in self._regions.items()}
        return LargeLeaves(self._forms, self._choices, numbers, kept)


class LargeLeaves:
    """Value and gradient of the leaves in parts, for some letters."""

    def __init__(
        self,
        forms: FormTapes,
        choices: dict[int, int],
        numbers: tuple[Floats, Ints],
        kept: dict[int, KeptRegions],
    ) -> None:
        self._forms, self._choices, self._numbers, self._kept = forms, choices, numbers, kept

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
        which, begin, padded_places, places = by_number(numbers)
        given = points.take(padded_places, axis=1)
        found, sorted_ones = np.empty((OUTPUTS, given.shape[1])), regions[which]
        sizes = len(given), OUTPUTS, given.shape[1]
        portion = sorted_ones.start[1:] // ENTRIES
        for a, b in pairwise([0, *(np.flatnonzero(np.diff(portion)) + 1), len(which)]):
            some = self._in_kinds(sorted_ones[a:b])
            codes = self._forms.codes(some, self._numbers)
            last = self._forms.coordinates + OUTPUTS * (np.diff(some.start) - 1)
            ends = STEP * (last[:, None] + np.arange(OUTPUTS))
            call(
                "leaves", 0, b - a, np.ascontiguousarray(begin[a : b + 1]), given, *sizes, found, ends,
                *tapes_of(codes, aligned(codes.memory)),
            )  # fmt: skip
        result = np.empty((OUTPUTS, points.shape[1]))
        result[:, padded_places[places]] = found[:, places]
        return result

    def _in_kinds(self, regions: Regions) -> Regions:
        """The same, their choices as parts."""
        entries = regions.entries.copy()
        for operation, number in self._choices.items():
            entries[regions.entries[:, 0] == operation, 0] = number
        return Regions(regions.start, entries)


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


def _choice(operation: str) -> SignForm:
    builder = Builder((*AXES, *OPERANDS), ())
    return SignForm(builder, (builder.make(operation, *map(builder.input, OPERANDS)),), ())


def total_program(form: SignForm) -> Program:
    """Value and derivatives of a part times its scale, behind each operand its derivatives as coordinates."""
    source = form.builder
    axes = source.coordinates[: len(AXES)]
    given = [name for operand in OPERANDS for name in (operand, *(f"{operand} by {axis}" for axis in axes))]
    b = Builder((*axes, *given), (*source.letters, SCALE))
    made: list[int] = []
    for node in source.nodes:
        made.append(b.make(node.operation, *(made[argument] for argument in node.arguments), data=node.data))
    for operand in OPERANDS:
        for axis in axes:
            b.derivatives[b.input(operand), axis] = b.input(f"{operand} by {axis}")
    value = b.mul(b.input(SCALE), made[form.leaves[0]])
    outputs = (value, *(derivative(b, value, axis) for axis in axes))
    return expand(assemble(b.nodes, b.coordinates, b.letters, dict(zip(leaf_outputs(0), outputs, strict=True))))


def _check(program: Program) -> None:
    """Compare with the interpreter: a miscompiled formula must never get any further."""
    generator = np.random.default_rng(20130605)
    points = [generator.uniform(-1, 1, CHECK_POINTS) for _ in program.coordinates]
    check_at(program, TapeFunction(program), FLOAT64, points, [1.0 + k / 8 for k in range(len(program.letters))])
