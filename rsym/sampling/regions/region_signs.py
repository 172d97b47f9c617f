"""Bounds of the leaves of a large form over boxes and cones, by tapes: nothing is compiled for it.

Leaves that are the same but for numbers have one bound, in which these are letters.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from rsym.backends.tape import TapeFunction
from rsym.bounds.far_forms import far_leaves
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.sampling.form_signs import Boxes, Signs, signs_between
from rsym.sampling.kernels.mesher_kernels import in_order
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.regions.leaf_tapes import KindTape, LiftedLetters, kind_tape, leaf_numbers
from rsym.sampling.regions.region_calls import ENTRIES, bounds_of
from rsym.sampling.regions.region_tapes import Codes, FormTapes
from rsym.sampling.regions.regions import Regions


class TapedBounds:
    """As `FormBounds`, of a form whose leaves are of few kinds.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import surface_form
    >>> form = surface_form(rsym.Shape(rsym.disjunction(1 - x**2 - y**2, 1 - (x - 4) ** 2 - y**2), (x, y)))
    >>> TapedBounds(form).near([Boxes(np.array([[3.5], [0.0]]), np.array([[4.5], [0.5]]))], {}).tolist()
    [[-1], [1]]
    """

    def __init__(self, form: SignForm) -> None:
        self.form = form
        self._letters = LiftedLetters(form)
        self._forms, self._kind = self._letters.forms()
        count = len(form.leaves)
        leaves = np.zeros((count, 3), np.int32)
        leaves[:, 0] = np.arange(count)
        self._leaves = Regions(np.array([0, count]), leaves)
        self._last: dict[str, tuple[Sequence[float], Codes]] = {}

    def near(self, parts: Sequence[Boxes], letters: Mapping[str, float]) -> Signs:
        """Over boxes, the only part, by images and mean values."""
        return self._signs("near", parts, letters)

    def far(self, parts: Sequence[Boxes], letters: Mapping[str, float]) -> Signs:
        """Over boxes, directions and nearness."""
        return self._signs("far", parts, letters)

    def _signs(self, name: str, parts: Sequence[Boxes], letters: Mapping[str, float]) -> Signs:
        """Eight boxes at a time."""
        count = len(parts[0])
        groups = -(-count // LANES)
        ends = np.zeros((2 * sum(len(part.lower) for part in parts), groups * LANES))
        ends[::2, :count] = np.concatenate([part.lower for part in parts])
        ends[1::2, :count] = np.concatenate([part.upper for part in parts])
        codes, leaves = self._codes(name, letters), len(self.form.leaves)
        signs = np.empty((leaves, groups * LANES), np.int8)
        portion = max(1, ENTRIES // leaves)
        for first in range(0, groups, portion):
            own = np.zeros(min(portion, groups - first), np.int64)
            columns = slice(LANES * first, LANES * (first + len(own)))
            bounds = bounds_of(self._leaves[own], codes[own], ends[:, columns]).reshape(len(own), leaves, 2, LANES)
            signs[:, columns].reshape(leaves, len(own), LANES)[:] = signs_between(
                bounds[:, :, 0].transpose(1, 0, 2), bounds[:, :, 1].transpose(1, 0, 2)
            )
        return signs[:, :count]

    def _codes(self, name: str, letters: Mapping[str, float]) -> Codes:
        """The tape of all leaves at letters; the last one is kept."""
        chosen = in_order(self.form, letters)
        known = self._last.get(name)
        if known is None or known[0] != chosen:
            tapes, form_tapes = self._near if name == "near" else self._far
            numbers = leaf_numbers(tapes, self._kind, self._letters.ends(chosen))
            known = self._last[name] = chosen, form_tapes.codes(self._leaves, numbers)
        return known[1]

    @cached_property
    def _near(self) -> tuple[Sequence[KindTape], FormTapes]:
        tapes = [_tape(one.builder, one.leaves[0], sharpened=True) for one in self._forms]
        return tapes, FormTapes(tapes, self._kind)

    @cached_property
    def _far(self) -> tuple[Sequence[KindTape], FormTapes]:
        tapes = [_tape(builder, leaf, sharpened=False) for builder, (leaf,) in map(far_leaves, self._forms)]
        return tapes, FormTapes(tapes, self._kind)


def _tape(builder: Builder, leaf: int, *, sharpened: bool) -> KindTape:
    program = builder.program({"leaf": leaf})
    numbers = (dict(program.outputs)["leaf"],) if sharpened else ()
    bounds = IntervalFunction(program, "tape", sharpened=numbers)
    assert isinstance(bounds.function, TapeFunction)
    return kind_tape(bounds.function.program, [name for name, _ in bounds.bounds.outputs])
