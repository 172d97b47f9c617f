"""The mesher's kernels of a form as tapes: nothing is compiled for it, and what matters at a place is evaluated there.

They have the methods of `MesherKernels`, and what these call words are `Regions` here.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.backends.tape import aligned
from rsym.errors import RsymError
from rsym.logic.leaf_parts import NONE, OPERANDS, parted
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds
from rsym.sampling.kernels.mesher_kernels import SMALL, letters_of_form, median_scales
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.regions.kept_regions import KeptRegions
from rsym.sampling.regions.large_leaves import LargeLeafTapes, LargeLeaves, without_leaves
from rsym.sampling.regions.leaf_tapes import LeafNumbers, LeafTapes, check_tape
from rsym.sampling.regions.point_groups import by_number
from rsym.sampling.regions.region_calls import bounds_of, call, portions, tapes_of
from rsym.sampling.regions.region_tapes import VECTOR, Codes, FormTapes, LeafCodes, leaf_codes
from rsym.sampling.regions.regions import (
    DEFINED_SIGN,
    INFINITE,
    KEPT,
    SIGN,
    VALUE,
    Regions,
    choices_of,
    joined_regions,
    reduce,
    whole_form,
    whole_parts,
)

Sides: TypeAlias = NDArray[np.uint8]
Given: TypeAlias = tuple[Sequence[float], Floats, Bounds | None]  # letters, scales of leaves, bounds
Run: TypeAlias = Callable[[Callable[[int, int], Any], int, int], Sequence[Any]]  # a call over pieces of a range

GROUP_GRAIN = 64
# What follows from letters.
_LETTERED = ("_given", "_numbers", "_own", "_code_of_whole", "_kept", "_large")
MOST_LEAVES = 32_000  # their numbers have 16 bits


class RegionKernels:
    """Made once for a sign form; `set` chooses letters and bounds."""

    grain = 16384  # points of a call: of fewer each region has few, and its tape is written for each call

    def __init__(self, form: SignForm, *, shared: bool) -> None:
        if len(form.leaves) > MOST_LEAVES:
            raise RsymError(
                f"a mesher tells at most {MOST_LEAVES:,} leaves apart, the shape has {len(form.leaves):,}",
                code="leaves",
                remedy="mesh parts of it",
            )
        self.form = form
        parts = parted(form)
        if parts is None:
            self._parts, self._whole, operands = LeafTapes(form, shared=shared), whole_form(form), 0
            self._leaf_tapes = self._parts
        else:
            self._parts, self._whole = LeafTapes(parts.form, shared=True, gradients=False), whole_parts(parts)
            operands = len(OPERANDS)
            self._large_tapes = LargeLeafTapes(self._parts, self._whole, len(form.leaves))
            self._leaf_tapes = LeafTapes(without_leaves(form, self._large_tapes.leaves), shared=shared)
        self.in_parts, self._choices, self._shared = parts is not None, choices_of(parts), shared
        self._values, self._boxes = (FormTapes(*self._parts.named(name), operands) for name in ("value", "box"))
        self._made_codes: dict[str, LeafCodes] = {}
        self._last: list[Any] = [(None, None)]  # of all copies: the letters of the last one, and what follows from them
        kinds = (*self._leaf_tapes.kinds, *self._parts.kinds)
        for program in {kind.points.digest: kind.points for kind in kinds}.values():
            check_tape(program)

    def load_enclose(self) -> None:
        """Nothing is compiled."""

    def _tapes(self, name: str) -> LeafTapes:
        """Those that have the tape "gradient", but of leaves in parts, or "enclosure"."""
        return self._enclosed if self.in_parts and name == "enclosure" else self._leaf_tapes

    @cached_property
    def _enclosed(self) -> LeafTapes:
        return LeafTapes(self.form, shared=self._shared)

    def _codes(self, name: str) -> LeafCodes:
        """The tapes "gradient" or "enclosure" of leaves."""
        if name not in self._made_codes:
            self._made_codes[name] = leaf_codes(self._tapes(name), name)
        return self._made_codes[name]

    def _numbers_of(self, name: str) -> tuple[Floats, Ints]:
        """The numbers of these tapes."""
        if name not in self._own:
            letters, scales, _ = self._given
            self._own[name] = self._tapes(name).numbers(letters, scales)[name]
        return self._own[name]

    def copy(self) -> RegionKernels:
        """The same tapes with letters of their own."""
        twin = object.__new__(RegionKernels)
        twin.__dict__.update(self.__dict__)
        return twin

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process makes the tapes again, and takes the letters as they are."""
        return _revived, (self.form, self._given)

    def set(self, letters: Mapping[str, float], bounds: Bounds | None = None) -> None:
        """Take the letters of the shape, and the bounds where the form has caps."""
        plain = letters_of_form(self.form, letters, bounds)
        chosen = np.array(plain).tobytes(), bounds  # 0 and -0 are two letters
        known, made = self._last[0]  # both at once: another thread may replace them
        if known != chosen:
            self.take((plain, np.ones(len(self.form.leaves)), bounds))
            self.take((plain, median_scales(self, len(self.form.leaves), bounds), bounds))
            self._last[0] = chosen, {name: self.__dict__[name] for name in _LETTERED if name in self.__dict__}
        else:
            self.__dict__.update(made)

    _given: Given
    _numbers: LeafNumbers  # of parts
    _own: dict[str, tuple[Floats, Ints]]  # of leaves
    _code_of_whole: Codes
    _kept: KeptRegions
    _large: LargeLeaves

    def take(self, given: Given) -> None:
        """Take the letters of the form, the scales of its leaves and the bounds as they are."""
        self._given = given
        letters, scales, bounds = given
        every = np.concatenate([scales, np.ones(self._parts.count - len(scales))])
        self._numbers, self._own = self._parts.numbers(letters, every), {}
        self._code_of_whole = self._boxes.codes(self._whole, self._numbers["box"])
        self.__dict__.pop("_kept", None)  # a copy that only has these letters narrows for those that are kept
        self._kept = KeptRegions(bounds, self._whole, narrow := self.copy()._narrowed_here)
        if self.in_parts:
            self._large = self._large_tapes.at(letters, every, bounds, narrow)

    def _narrowed_here(self, ends: Floats, parent: Ints, among: Regions) -> Regions:
        return self.valued(ends, parent, among, _here)

    def without(self, leaves: Sequence[int]) -> RegionKernels:
        """The same with the same letters, these leaves infinite wherever the form is asked for."""
        twin, entries = self.copy(), self._whole.entries.copy()
        entries[np.isin(entries[:, 0], leaves)] = INFINITE, NONE, NONE
        twin._whole = replace(self._whole, entries=entries)
        twin.take(self._given)
        return twin

    # What matters where

    def kept(self, ends: Floats, parent: Ints, among: Regions | None, run: Run) -> tuple[Flags, Regions]:
        """Which boxes with these ends (6, n) may hold a zero, and the regions of all; `parent` ascends in `among`."""
        sides, regions = self._narrowed(ends, parent, among, SIGN, run)
        return sides == KEPT, regions

    def sides(self, ends: Floats, parent: Ints, among: Regions | None, run: Run) -> tuple[Sides, Regions]:
        """OUTSIDE, KEPT or INSIDE; where a leaf may be undefined a box is kept."""
        return self._narrowed(ends, parent, among, DEFINED_SIGN, run)

    def valued(self, ends: Floats, parent: Ints, among: Regions | None, run: Run) -> Regions:
        """The regions of boxes that keep the value, not just the sign."""
        return self._narrowed(ends, parent, among, VALUE, run)[1]

    def _narrowed(
        self, ends: Floats, parent: Ints, among: Regions | None, keeps: int, run: Run
    ) -> tuple[Sides, Regions]:
        """Boxes of one parent are bounded eight at a time."""
        count = ends.shape[1]
        first = np.flatnonzero(np.diff(parent, prepend=-1))
        within = np.arange(count) - np.repeat(first, np.diff([*first, count]))
        new = (within % LANES == 0).cumsum() - 1
        groups = int(new[-1]) + 1 if count else 0
        slot = LANES * new + within % LANES
        parents = parent[within % LANES == 0]
        padded_ends = np.empty((6, LANES * groups))
        padded_ends.reshape(6, groups, LANES)[:] = ends[:, within % LANES == 0][:, :, None]
        padded_ends[:, slot] = ends
        keep = np.zeros((groups, LANES), np.uint8)
        keep.reshape(-1)[slot] = KEPT

        def piece(first: int, last: int) -> Regions:
            found = []
            for a, b in self._portions(parents, among, first, last):
                found.append(self._reduced(a, b, padded_ends, parents, among, keeps, keep))
            return joined_regions(found)

        made = joined_regions([self._whole[:0], *run(piece, groups, GROUP_GRAIN)])
        return keep.reshape(-1)[slot], made[slot]

    def _portions(self, parents: Ints, among: Regions | None, first: int, last: int) -> Sequence[tuple[int, int]]:
        """Groups whose tapes are written at once."""
        if among is None:
            size = np.full(last - first, len(self._whole.entries))
        else:
            size = np.diff(among.start)[parents[first:last]]
        return [(first + a, first + b) for a, b in portions(size)]

    def _reduced(
        self,
        first: int,
        last: int,
        ends: Floats,
        parents: Ints,
        among: Regions | None,
        keeps: int,
        keep: NDArray[np.uint8],
    ) -> Regions:
        """The regions of the boxes of some groups."""
        count = last - first
        if among is None:
            regions, codes, own = self._whole[np.zeros(count, np.int64)], self._code_of_whole, np.zeros(count, np.int64)
        else:
            regions = among[parents[first:last]]
            some, own = np.unique(parents[first:last], return_inverse=True)
            codes = self._boxes.codes(among[some], self._numbers["box"])
        bounds = bounds_of(regions, codes[own], ends[:, LANES * first : LANES * last])
        if self._numbers.undefined.any():
            leaf = regions.entries[:, 0]
            bounds[(leaf >= 0) & self._numbers.undefined[np.maximum(leaf, 0)]] = [[-np.inf], [np.inf]]
        sizes = np.zeros((count, LANES), np.int64)
        results = np.empty((LANES * int(regions.start[-1]), 3), np.int32)
        made = reduce(regions.start, regions.entries, self._choices, bounds, keeps, keep[first:last], sizes, results)
        return Regions(np.concatenate([[0], np.cumsum(sizes)]), results[:made].copy())

    # On the lattice

    def signs(
        self,
        first: int,
        last: int,
        corner: Floats,
        words: Regions,
        lattice: Floats,
        offsets: Floats,
        bits: NDArray[np.uint8],
        undefined: NDArray[np.uint8],
    ) -> None:
        """The signs of the points `offsets` of blocks from first to below last; 0 counts as positive."""
        for a, b, _, codes, room in self._portions_of(words, first, last):
            own = np.ascontiguousarray(corner[:, a:b])
            arrays = (offsets, offsets.shape[1], bits[a:b], bits.shape[1], undefined[a:b])
            call("signs", 0, b - a, own, own.shape[1], lattice, *arrays, *tapes_of(codes, room))

    def fill(
        self, corner: Floats, regions: Regions, lattice: Floats, offsets: Floats, starts: Ints, value: Floats
    ) -> None:
        """The form at the points `offsets` of blocks in an array, whose rows they begin at `starts`; else NaN."""
        for a, b, _, codes, room in self._portions_of(regions, 0, len(regions)):
            own = np.ascontiguousarray(corner[:, a:b])
            arrays = (offsets, offsets.shape[1], starts[a:b], value.shape[1], value)
            call("fill", 0, b - a, own, own.shape[1], lattice, *arrays, *tapes_of(codes, room))

    def crossings(
        self,
        first: int,
        last: int,
        starts: Ints,
        words: Regions,
        edges: NDArray[np.float32],
        axis: Floats,
        lattice: Floats,
        points: Floats,
        leaf: NDArray[np.int16],
    ) -> None:
        """Where the edges of blocks from first to below last cross the surface, and on which leaf."""
        for a, b, regions, codes, room in self._portions_of(words, first, last):
            entries = np.diff(regions.start)
            names = np.empty((int(entries.max(initial=1)), LANES), np.int16)
            arrays = (starts[a : b + 1], edges, edges.shape[1], axis, lattice, points, points.shape[1], leaf)
            listed = (regions.start, entries, regions.entries, names)
            call("crossings", 0, b - a, *arrays, *tapes_of(codes, room), *listed)

    def _portions_of(self, words: Regions, first: int, last: int) -> Any:
        """Regions whose tapes are written at once, with these, and a room."""
        for a, b in self._portions(np.arange(len(words)), words, first, last):
            regions = words[a:b]
            codes = self._values.codes(regions, self._numbers["value"])
            yield a, b, regions, codes, aligned(codes.memory)

    # At any points

    def value(self, count: int, points: Floats, value: Floats, leaf: NDArray[np.int16], first: int = 0) -> None:
        """The form, and the active leaf."""
        if not count:
            return
        own = points[:, first : first + count]
        numbers, regions = self._kept.at(own)
        which, begin, padded_places, places, order = by_number(numbers)
        found, names = self.within(own.take(padded_places, axis=1), regions[which], begin)
        value[first + order], leaf[first + order] = found[places], names[places]

    def within(self, points: Floats, regions: Regions, begin: Ints) -> tuple[Floats, Shorts]:
        """The form and its active leaf at points (3, n), those of region k from ``begin[k]`` on, in whole vectors."""
        found, names = np.empty(points.shape[1]), np.empty(points.shape[1], np.int16)
        for a, b, some, codes, room in self._portions_of(regions, 0, len(regions)):
            entries = np.diff(some.start)
            listed = (some.start, entries, some.entries, np.empty((int(entries.max()), LANES), np.int16))
            arrays = (np.ascontiguousarray(begin[a : b + 1]), points, points.shape[1], found, names)
            call("values", 0, b - a, *arrays, *tapes_of(codes, room), *listed)
        return found, names

    def leaf(
        self, count: int, leaf: NDArray[np.int16], points: Floats, value: Floats, gradient: Floats, first: int = 0
    ) -> None:
        """Value and gradient of the leaf of each point; none where its number is negative."""
        own = slice(first, first + count)
        numbers = leaf[own]
        if self.in_parts:
            self._large.leaf(numbers, points[:, own], value[own], gradient[:, own])
            numbers = self._large.without_these(numbers)
        found, order = self._of_leaves("gradient", numbers, points[:, own], 4)
        value[first + order], gradient[:, first + order] = found[0], found[1:]

    def enclose(
        self, count: int, leaf: NDArray[np.int16], lower: Floats, upper: Floats, bounds: Floats, first: int = 0
    ) -> None:
        """Bounds (8, m) of value and gradient of the leaf of each box: value lower, upper, then each derivative's."""
        own = slice(first, first + count)
        ends = np.empty((6, count))
        ends[::2], ends[1::2] = lower[:, own], upper[:, own]
        found, order = self._of_leaves("enclosure", leaf[own], ends, 8)
        bounds[:, first + order] = found

    def _of_leaves(self, name: str, leaf: Shorts, inputs: Floats, outputs: int) -> tuple[Floats, Ints]:
        """Outputs of the leaf of each point that has one, and which points these are."""
        which, begin, padded_places, places, order = by_number(leaf)
        given = inputs.take(padded_places, axis=1)
        found = np.empty((outputs, given.shape[1]))
        codes = self._codes(name)
        tapes, room = self._tapes_of(name, which)
        sizes = (len(inputs), outputs, given.shape[1])
        call(
            "leaves", 0, len(which), begin, given, *sizes, found, np.ascontiguousarray(codes.ends[which]), *tapes, room
        )
        return found.take(places, axis=1), order

    def slide(self, count: int, leaf: NDArray[np.int16], points: Floats, steps: int, first: int = 0) -> None:
        """Newton steps of each point onto its leaf, along the gradient."""
        own = slice(first, first + count)
        numbers = leaf[own]
        if self.in_parts:
            self._large.slide(numbers, points[:, own], steps)
            numbers = self._large.without_these(numbers)
        which, begin, padded_places, places, order = by_number(numbers)
        given = points[:, own].take(padded_places, axis=1)
        tapes, room = self._tapes_of("gradient", which)
        ends = self._codes("gradient").ends[which]
        call("slide", 0, len(which), begin, given, given.shape[1], steps, ends, *tapes, room)
        points[:, first + order] = given[:, places]

    def _tapes_of(self, name: str, which: Ints) -> tuple[Sequence[Any], NDArray[np.uint8]]:
        """The tapes of leaves by their numbers."""
        codes, (numbers, places) = self._codes(name), self._numbers_of(name)
        count, above = places[which + 1] - places[which], codes.above[which]
        room = aligned(int((above + VECTOR * count).max(initial=0)))
        return (codes.rows, numbers, codes.row[which], places[which], count, above, above), room


def _here(call: Callable[[int, int], Any], count: int, grain: int) -> Sequence[Any]:
    return [call(0, count)]


_kernels: dict[Any, RegionKernels] = {}
_making = threading.Lock()
MOST_KERNELS = 64


def region_kernels(form: SignForm) -> RegionKernels:
    """Made once in a process; each caller has letters of its own."""
    shared = len(form.gates) > SMALL  # of few leaves those that are alike spare little, and each has the bits of LLVM
    key = f"{shared}{form.key}"
    with _making:
        kernels = _kernels.get(key)
        if kernels is None:
            while len(_kernels) >= MOST_KERNELS:
                _kernels.pop(next(iter(_kernels)))
            kernels = _kernels[key] = RegionKernels(form, shared=shared)
    return kernels.copy()


def _revived(form: SignForm, given: Given) -> RegionKernels:
    kernels = region_kernels(form)
    kernels.take(given)
    return kernels
