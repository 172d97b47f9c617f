"""The mesher's kernels: the routines of a sign form, compiled, on NumPy arrays.

Letters and bounds are constants that `set` takes without compiling anything.
Arrays of points are (3, m) float64, contiguous, with m at least the count rounded
up to a multiple of eight lanes; what lies behind the count is scratch.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Arrays, Floats, Ints
from rsym.backends.interpreter import CHECK_POINTS, check_at
from rsym.errors import RsymError
from rsym.logic.sign_form import SignForm, cap_letters
from rsym.model.shape import Bounds
from rsym.program.program import FLOAT64, Program, live
from rsym.sampling.form_signs import check_parameters
from rsym.sampling.kernels.mesher_code import FormCode
from rsym.sampling.kernels.routines import LANES

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
Run: TypeAlias = Callable[[Callable[[int, int], Any], int, int], Sequence[Any]]  # a call over pieces of a range
GRAIN = 2048  # boxes
_SIGNATURES: dict[str, Sequence[Any]] = {
    "point_constants": (_POINTER, _POINTER),
    "box_constants": (_POINTER, _POINTER),
    "boxes": (_INTEGER, _POINTER, _INTEGER, *[_POINTER] * 3),
    "signs": (_INTEGER, _INTEGER, _POINTER, _INTEGER, *[_POINTER] * 3, _INTEGER, *[_POINTER] * 2, _INTEGER, _POINTER),
    "crossings": (_INTEGER, _INTEGER, *[_POINTER] * 3, _INTEGER, *[_POINTER] * 4, _INTEGER, _POINTER),
    "value": (_INTEGER, _POINTER, _INTEGER, *[_POINTER] * 3),
    "leaf": (_INTEGER, *[_POINTER] * 2, _INTEGER, *[_POINTER] * 3, _INTEGER),
    "slide": (_INTEGER, *[_POINTER] * 2, _INTEGER, _POINTER, _INTEGER),
    "enclose": (_INTEGER, *[_POINTER] * 3, _INTEGER, *[_POINTER] * 2, _INTEGER),
}


def padded(count: int) -> int:
    """The length of an array that holds so many points: whole vectors, one to spare.

    Examples
    --------
    >>> padded(9)
    24
    """
    return -(-count // LANES) * LANES + LANES


def columns(points: NDArray[Any]) -> Floats:
    """A copy of points (3, n) with the room that kernels need behind them."""
    array = np.zeros((3, padded(points.shape[1])))
    array[:, : points.shape[1]] = points
    return array


class MesherKernels:
    """Compiled once for a sign form; `set` chooses letters and bounds.

    ``words``: 64-bit words that tell, for each block, which operands of gates do not matter there.
    """

    grain = 2048  # points of a call: handing out fewer takes as long as evaluating them

    def __init__(self, form: SignForm) -> None:
        self.form, self._code = form, FormCode(form)
        self.words = self._code.formulas.words
        self._engines: list[Any] = []
        self._functions: dict[str, Callable[..., None]] = {}
        made = self._code.kept()
        if made is None:
            constants, engines = self._code.made()
        else:
            constants, engines = made
        for engine in engines:
            self._load(engine)
        self._constants = np.zeros(max(1, constants))
        if made is None:
            check_leaves(self)
            self._code.keep()

    @property
    def program(self) -> Program:
        """Value and gradient of every leaf, times its scale."""
        return self._code.formulas.scaled_program

    @property
    def source(self) -> str:
        """All code as text."""
        return self._code.source

    def _load(self, engine: Any) -> None:
        self._engines.append(engine)
        for name, kinds in _SIGNATURES.items():
            if address := engine.get_function_address(name):
                self._functions[name] = ctypes.CFUNCTYPE(None, *kinds)(address)

    def load_enclose(self) -> None:
        """Compile what only certificates need: a third of all code, and a mesh can do without."""
        with _finishing:
            if "enclose" not in self._functions:
                self._load(self._code.enclose())

    def copy(self) -> MesherKernels:
        """The same code with letters of its own."""
        twin = object.__new__(MesherKernels)
        twin.__dict__.update(self.__dict__, _constants=self._constants.copy())
        return twin

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process compiles the form once, and takes the letters as they are."""
        return _revived, (self.form, self._constants)

    def set(self, letters: Mapping[str, float], bounds: Bounds | None = None) -> None:
        """Take the letters of the shape, and the bounds where the form has caps."""
        plain = letters_of_form(self.form, letters, bounds)
        twice = np.repeat(plain, 2)
        self._functions["box_constants"](twice.ctypes.data, self._constants.ctypes.data)
        self.set_points([*plain, *[1.0] * len(self.form.leaves)])
        self.set_points([*plain, *median_scales(self, len(self.form.leaves), bounds)])

    def set_points(self, letters: Sequence[float]) -> None:
        """Take the letters and scales of leaves at points as they are."""
        array = np.array(letters)
        self._functions["point_constants"](array.ctypes.data, self._constants.ctypes.data)

    def kept(self, ends: Floats, parent: Ints, among: Any, run: Run) -> tuple[NDArray[np.bool_], NDArray[np.uint64]]:
        """Which boxes with these ends (6, n) may hold a zero, and the words of all, as rows."""
        count = ends.shape[1]
        places = np.zeros((6, padded(count)))
        places[:, :count] = ends
        keep = np.empty(places.shape[1] // LANES, np.uint8)
        skip = np.empty((self.words, places.shape[1]), np.uint64)
        run(lambda first, last: self.boxes(first, last, places, keep, skip), count, GRAIN)
        words = skip[:, :count].T
        if among is not None:  # bounds of a part may be wider: what does not matter in the whole is not asked again
            words |= among[parent]
        return np.unpackbits(keep, count=count, bitorder="little").view(np.bool_), words

    def boxes(self, first: int, last: int, ends: Floats, keep: NDArray[np.uint8], skip: NDArray[np.uint64]) -> None:
        """Which boxes may hold a zero (a bit each), which operands of gates do not matter (words, m).

        `first` is a multiple of eight, and what lies behind `last` up to the next one is scratch.
        """
        arrays = (self._constants, _from(keep, first // LANES), _from(skip, first))
        self._call("boxes", last - first, _from(ends, first), ends.shape[1], *arrays)

    def signs(
        self,
        first: int,
        last: int,
        corner: Floats,
        words: NDArray[np.uint64],
        lattice: Floats,
        offsets: Floats,
        bits: NDArray[np.uint8],
        undefined: NDArray[np.uint8],
    ) -> None:
        """The signs of the points `offsets` of blocks from first to below last; 0 counts as positive."""
        stride, points = corner.shape[1], offsets.shape[1]
        arrays = (lattice, offsets, points, self._constants, bits, bits.shape[1], undefined)
        self._call("signs", first, last, corner, stride, words, *arrays)

    def crossings(
        self,
        first: int,
        last: int,
        starts: Ints,
        words: NDArray[np.uint64],
        edges: NDArray[np.float32],
        axis: Floats,
        lattice: Floats,
        points: Floats,
        leaf: NDArray[np.int16],
    ) -> None:
        """Where the edges of blocks from first to below last cross the surface, and on which leaf."""
        arrays = (axis, lattice, self._constants, points, points.shape[1], leaf)
        self._call("crossings", first, last, starts, words, edges, edges.shape[1], *arrays)

    def value(self, count: int, points: Floats, value: Floats, leaf: NDArray[np.int16], first: int = 0) -> None:
        """The form, and the active leaf."""
        p, f, n = _from(points, first), _from(value, first), _from(leaf, first)
        self._functions["value"](count, p, points.shape[1], self._constants.ctypes.data, f, n)

    def leaf(
        self, count: int, leaf: NDArray[np.int16], points: Floats, value: Floats, gradient: Floats, first: int = 0
    ) -> None:
        """Value and gradient of the leaf of each point; none where its number is negative."""
        n, p, f, g = _from(leaf, first), _from(points, first), _from(value, first), _from(gradient, first)
        constants = self._constants.ctypes.data
        self._functions["leaf"](count, n, p, points.shape[1], constants, f, g, gradient.shape[1])

    def slide(self, count: int, leaf: NDArray[np.int16], points: Floats, steps: int, first: int = 0) -> None:
        """Newton steps of each point onto its leaf, along the gradient."""
        n, p = _from(leaf, first), _from(points, first)
        self._call("slide", count, n, p, points.shape[1], self._constants, steps)

    def enclose(
        self, count: int, leaf: NDArray[np.int16], lower: Floats, upper: Floats, bounds: Floats, first: int = 0
    ) -> None:
        """Bounds (8, m) of value and gradient of the leaf of each box: value lower, upper, then each derivative's."""
        self.load_enclose()
        n, low, high, out = (_from(array, first) for array in (leaf, lower, upper, bounds))
        self._call("enclose", count, n, low, high, lower.shape[1], self._constants, out, bounds.shape[1])

    def _call(self, name: str, *arguments: Any) -> None:
        self._functions[name](*(a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments))


def _from(array: NDArray[Any], first: int) -> int:
    """The address of a column."""
    return array.ctypes.data + first * array.itemsize


_kernels: dict[str, MesherKernels] = {}
_making, _finishing = threading.Lock(), threading.Lock()
# A megabyte each; a gallery has fifty models open, and comes back to some.
_MOST_KERNELS = 64


def mesher_kernels(form: SignForm) -> MesherKernels:
    """Compiled once in a process; each caller has letters of its own."""
    key = form.key
    with _making:
        kernels = _kernels.get(key)
        if kernels is None:
            while len(_kernels) >= _MOST_KERNELS:
                _kernels.pop(next(iter(_kernels)))
            kernels = _kernels[key] = MesherKernels(form)
    return kernels.copy()


def _revived(form: SignForm, constants: Floats) -> MesherKernels:
    kernels = mesher_kernels(form)
    kernels._constants[:] = constants
    return kernels


# Of so many balls the first mesh of 128 cells takes a third of the time by tapes, of 27 as long as by LLVM, whose code
# is faster then: of 64 balls by a third, of 125 not any more.
SMALL = 64  # gates
# Of balls in one leaf, a sum with their minimum in both its parts, LLVM takes 36 s before the first mesh at 300, where
# the leaf has 5 100 operations, and 29 s for that, a tape 7 and 4; later ones 0.5 and 3.6. At 1 000 operations a first
# mesh of 64 cells takes 5.6 s in all, by a tape 2.8.
LARGE = 2000  # operations
BACKENDS = ("llvm", "tape")


def backend_for(form: SignForm, backend: str | None = None) -> str:
    """How a form is evaluated: as asked, else what pays."""
    if backend is None:
        small = len(form.gates) <= SMALL and len(live(form.builder.nodes, form.leaves)) <= LARGE
        return "llvm" if small else "tape"
    if backend not in BACKENDS:
        raise RsymError(f"no backend {backend!r} meshes", code="unknown-backend", remedy="choose 'llvm' or 'tape'")
    return backend


def compile_ahead(form: SignForm, backend: str | None = None) -> bool:
    """Start compiling in a thread of its own; who asks for the kernels of an equal form meanwhile waits for it.

    LLVM works without the interpreter's lock, so something else can be imported beside it. Whether there is such a
    thread: the form is its own then.
    """

    def work() -> None:
        with suppress(RsymError):  # raised again for those who ask
            mesher_kernels(form).load_enclose()

    ahead = backend_for(form, backend) == "llvm"
    if ahead:
        threading.Thread(target=work, name="rsym-compiler").start()
    return ahead


def letters_of_form(form: SignForm, letters: Mapping[str, float], bounds: Bounds | None) -> tuple[float, ...]:
    """Letters of a shape and bounds in the order of its form, which they must be legal for."""
    values = dict(letters)
    for name, ends in zip(form.builder.coordinates, bounds or [(-np.inf, np.inf)] * 3, strict=True):
        values.update(zip(cap_letters(name), ends, strict=True))
    check_parameters(form, values)
    return in_order(form, values)


def in_order(form: SignForm, letters: Mapping[str, float]) -> tuple[float, ...]:
    """Letters in the order of a form."""
    return tuple(letters.get(name, 1.0) for name in form.builder.letters)


def median_scales(kernels: OneLeaf, count: int, bounds: Bounds | None) -> Floats:
    """Powers of two that give leaves gradients of length 1 to 2, by the median over the bounds.

    Signs, and so the mesh, do not depend on them, but a min of 1e40*f and g is not zero in float64 where f is.
    """
    generator = np.random.default_rng(20130605)
    middle = np.array([generator.uniform(low, high, CHECK_POINTS) for low, high in bounds or ((-1.0, 1.0),) * 3])
    points, every = columns(np.tile(middle, count)), count * CHECK_POINTS
    leaf = np.full(points.shape[1], -1, np.int16)
    leaf[:every] = np.repeat(np.arange(count), CHECK_POINTS)
    value, gradient = np.zeros(points.shape[1]), np.zeros(points.shape)
    kernels.leaf(every, leaf, points, value, gradient)
    with np.errstate(all="ignore"):
        steepness = np.abs(gradient[:, :every]).max(axis=0).reshape(count, CHECK_POINTS)
        known = np.isfinite(steepness) & (steepness > 0)
        some = known.any(axis=1)
        # The median of what is known; np.nanmedian loads all masked arrays for it.
        ordered, last = np.sort(np.where(known, steepness, np.nan)[some], axis=1), known[some].sum(axis=1) - 1
        row = np.arange(len(last))
        usual = (ordered[row, last // 2] + ordered[row, (last + 1) // 2]) / 2
    scales = np.ones(count)
    scales[some] = 2.0 ** -np.clip(np.frexp(usual)[1], -1000, 1000)
    return scales


class OneLeaf(Protocol):
    """Value and gradient of the leaf of each point."""

    def leaf(self, count: int, leaf: NDArray[np.int16], points: Floats, value: Floats, gradient: Floats) -> None:
        """As of `MesherKernels`."""


class CheckedLeaves(OneLeaf, Protocol):
    """What is checked of kernels."""

    @property
    def program(self) -> Program:
        """Value and derivatives of one leaf after the other."""

    def set_points(self, letters: Sequence[float]) -> None:
        """Take letters."""


def check_leaves(kernels: CheckedLeaves) -> None:
    """Compare all leaves with the interpreter: a miscompiled formula must never get any further."""
    generator = np.random.default_rng(20130605)
    points = [generator.uniform(-1, 1, CHECK_POINTS) for _ in range(3)]
    letters = [1.0 + k / 8 for k in range(len(kernels.program.letters))]
    check_at(kernels.program, _AllLeaves(kernels), FLOAT64, points, letters)


class _AllLeaves:
    """Values and gradients of all leaves, as a backend computes outputs."""

    block_size = CHECK_POINTS
    source = ""

    def __init__(self, kernels: Any) -> None:
        self.kernels = kernels

    def run(self, coordinates: Sequence[Floats], letters: Sequence[float], outputs: Arrays) -> None:
        count = len(coordinates[0])
        self.kernels.set_points(letters)
        points = np.zeros((3, count + LANES))
        points[:, :count] = coordinates
        value, gradient = np.zeros(points.shape[1]), np.zeros(points.shape)
        for number in range(len(outputs) // 4):
            self.kernels.leaf(count, np.full(points.shape[1], number, np.int16), points, value, gradient)
            for row, output in zip((value, *gradient), outputs[4 * number : 4 * number + 4], strict=True):
                output[:] = row[:count]
