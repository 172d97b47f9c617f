"""The caster's kernels: the routines of a sign form along rays, compiled, on NumPy arrays."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.interpreter import interpret, interpret_nodes
from rsym.backends.kernel import lasting_threads
from rsym.backends.llvm_code import machine_code
from rsym.bounds.ray_forms import guarded
from rsym.errors import RsymError
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Bounds
from rsym.program.program import FLOAT64
from rsym.sampling.hits import Seen
from rsym.sampling.kernels.cells_code import CORNER, HEAD, MARGIN, NUMBER, WIDTH
from rsym.sampling.kernels.form_code import WORD
from rsym.sampling.kernels.mesher_kernels import padded
from rsym.sampling.kernels.picture_code import (
    NUMBERS_OF_CAMERA,
    STRETCHES,
    VECTORS_OF_CAMERA,
    caster_code,
    place_of,
)
from rsym.sampling.kernels.ray_code import RayFormulas
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.pencils import Beams, Pencil
from rsym.sampling.ray_steps import ALIKE

Words: TypeAlias = NDArray[np.uint64]  # a bit for each operand of each gate that does not matter
_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_COMMON = (_INTEGER, _INTEGER, _POINTER, _POINTER, _INTEGER, _POINTER)
_OUT = (*[_POINTER] * 4, _INTEGER)
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "beams": (*_COMMON, _INTEGER, *[_POINTER] * 7),
    "picture": (*_COMMON, _INTEGER, *[_POINTER] * 3, *_OUT, _INTEGER),
    "probe": (*[_POINTER] * 4,),
    "rays": (*_COMMON, *[_POINTER] * 3, *_OUT),
}
# Of large forms.
_CELLED: dict[str, tuple[Any, ...]] = {
    "beams": (*_COMMON, _INTEGER, *[_POINTER] * 5),
    "cells": (_INTEGER, _INTEGER, *[_POINTER] * 4, _INTEGER),
    "picture": (*_COMMON, _INTEGER, *[_POINTER] * 2, *_OUT, _INTEGER),
    "probe": (*[_POINTER] * 5,),
    "rays": (*_COMMON, *[_POINTER] * 2, *_OUT),
    "regions": (_INTEGER, _INTEGER, *[_POINTER] * 5),
}
# Cells of the bounds for each leaf, and the most along an axis: of 1000 balls half as many take a quarter longer to
# look, twice as many are as fast. So often at most leaves are asked about cells, 9 ns each: of 5000 half a second.
CELLS, MOST_CELLS, MOST_ASKED = 4, 32, 5e7
# Of the shortest side of a cell: how far it reaches into the next ones; beams as wide as that march by cells.
NEXT = 0.15
AT_ONCE = 1 << 16  # beams: what matters to each takes some bytes
MOST_LEAVES = 32_000  # numbers of leaves, sides of the bounds and cuts have 16 bits
SCALE_POINTS = 64
_JOINS: dict[str, Callable[..., Floats]] = {"min": np.minimum, "max": np.maximum}


class RayKernels:
    """Compiled once for a sign form; `constants` hold the letters."""

    def __init__(self, form: SignForm) -> None:
        if len(form.leaves) > MOST_LEAVES:
            raise RsymError(
                f"rays tell at most {MOST_LEAVES:,} leaves apart, the shape has {len(form.leaves):,}",
                code="leaves",
                remedy="cast rays at parts of it",
            )
        self.formulas = RayFormulas(form)
        self.source = caster_code(self.formulas)
        self._engine = machine_code(self.source)
        self._functions: dict[str, Callable[..., None]] = {
            name: ctypes.CFUNCTYPE(None, *kinds)(self._engine.get_function_address(name))
            for name, kinds in (_CELLED if self.formulas.celled else _SIGNATURES).items()
            if name != "regions" or self.formulas.tabled
        }
        self._check()

    def probe(self, ends: Floats, constants: Floats, words: Words) -> Floats:
        """Low, high, linear, quadratic of the form on segments (9, 8), and value and leaf in the middles: (6, 8)."""
        found = np.empty((6, LANES))
        self._call("probe", ends, constants, words, found, *self._room())
        return found

    def _check(self) -> None:
        """Models contain values of the plain meanings, and points have these: miscompiled code gets no further."""
        s, generator = self.formulas, np.random.default_rng(20130605)
        letters = {name: 1.0 + k / 8 for k, name in enumerate(s.form.builder.letters)}
        constants = self._numbers(letters, ((-1.0, 1.0),) * 3)
        middles, slopes = generator.uniform(-1, 1, (3, LANES)), generator.uniform(-0.05, 0.05, (3, LANES))
        ends = np.concatenate([[middle, middle, slope] for middle, slope in zip(middles, slopes, strict=True)])
        whole = guarded(s.form)
        program = whole.builder.program({f"{k}": node for k, node in enumerate(whole.leaves)})
        leaves: dict[float, Sequence[Floats]] = {}
        for t in (-1.0, 0.0, 0.5):
            inputs = dict(zip(s.coordinates, middles + t * slopes, strict=True))
            leaves[t] = [np.broadcast_to(one, LANES) for one in interpret(program, {**letters, **inputs}).values()]
        wrong = np.zeros(LANES, bool)
        for number, words in ((None, np.zeros(s.words, np.uint64)), *self._alone()):
            wrong |= self._differs(self.probe(ends, constants, words), leaves, whole.gates, number, constants)
        if wrong.any():
            raise RsymError(
                f"the compiled rays differ from their formulas on {int(wrong.sum())} of {LANES} segments",
                code="miscompiled",
                remedy="report the model",
            )

    def _differs(
        self,
        found: Floats,
        leaves: Mapping[float, Sequence[Floats]],
        gates: Sequence[Gate],
        number: int | None,
        constants: Floats,
    ) -> Flags:
        """Where what was found of the form, or of a leaf by its number, is not what leaves are there."""
        s, (low, high, linear, quadratic, value, leaf) = self.formulas, found
        scales = constants[s.scales : s.scales + s.count, None]
        wrong = np.zeros(LANES, bool)
        for t, values in leaves.items():
            with np.errstate(all="ignore"):
                form = through(gates, values, lambda gate, a, b: _JOINS[gate.operation](a, b))[-1]
                sure = np.isfinite(values).all(axis=0)  # elsewhere it counts as outside
                if number is not None:
                    form = values[number]
                    sure = np.isfinite(form)
                room = FLOAT64.tolerance * (1 + np.abs(np.where(np.isfinite(values), values, 0.0)).max(axis=0))
                rest = form - t * linear - t * t * quadratic
                wrong |= sure & ~((low - room <= rest) & (rest <= high + room))
                if t == 0.0 and (number is None or number < s.count):
                    own = (np.stack(values[: s.count]) * scales)[leaf.astype(int), np.arange(LANES)]
                    allowed = room * (1 + np.abs(scales).max())
                    wrong |= sure & ~(np.abs(value - own) <= allowed + constants[s.tolerance])
                    wrong |= sure & (number is not None) & (leaf != number)
        return wrong

    def _alone(self) -> Iterator[tuple[int, Words]]:
        """A leaf of each kind of a large form, and the words that leave it alone."""
        s = self.formulas
        if not s.tabled:
            return
        users = {
            operand: (number, position)
            for number, gate in enumerate(s.gates)
            for position, operand in enumerate(gate[1:])
        }
        first = {kind: number for number, (kind, _) in reversed([*enumerate(s.kinds.leaves)])}
        for leaf in first.values():
            words, operand = np.zeros(s.words, np.uint64), leaf
            while operand in users:
                gate, position = users[operand]
                word, bit = divmod(2 * gate + 1 - position, WORD)
                words[word] |= np.uint64(1 << bit)
                operand = len(s.rays.leaves) + gate
            yield leaf, words

    def constants(self, letters: Mapping[str, float], bounds: Bounds) -> Floats:
        """The array of constants for letters, of a large form with what matters in the cells of its bounds."""
        array = self._numbers(letters, bounds)
        return self._with_cells(array, bounds) if self.formulas.celled else array

    def _numbers(self, letters: Mapping[str, float], bounds: Bounds) -> Floats:
        """The constants without cells."""
        s = self.formulas
        array = np.zeros(s.constants + LANES)
        array[: s.uniforms] = s.rays.uniform_values(letters)
        program = s.points.program
        generator = np.random.default_rng(20130605)
        points = {
            name: generator.uniform(*ends, SCALE_POINTS) for name, ends in zip(s.coordinates, bounds, strict=True)
        }
        values = interpret_nodes(program, {**letters, **points})
        for number, slot in s.points.slots.items():
            array[slot] = values[number]
        outputs = [np.broadcast_to(values[number], SCALE_POINTS) for _, number in program.outputs]
        for k in range(s.count):
            with np.errstate(all="ignore"):
                steepness = _lengths(np.array(outputs[4 * k + 1 : 4 * k + 4]))
                known = steepness[np.isfinite(steepness) & (steepness > 0)]
            array[s.scales + k] = 1 / np.median(known) if known.size else 1.0
        array[s.tolerance] = ALIKE * np.linalg.norm([high - low for low, high in bounds])
        return self._with_tables(array, values) if s.celled else array

    def _with_tables(self, array: Floats, nodes: Sequence[Floats]) -> Floats:
        """The constants of a large form with the tables of its leaves and gates."""
        s = self.formulas
        if not s.tabled:
            return array[: s.constants]
        uniform = [float(node) if known else 0.0 for node, known in zip(nodes, s.points.program.uniform, strict=True)]
        rows = np.concatenate([array[s.scales : s.tolerance], array[: s.uniforms], uniform])[s.kinds.sources]
        return np.concatenate([array[: s.constants], rows, s.integers.view(np.float64)])

    def _with_cells(self, array: Floats, bounds: Bounds) -> Floats:
        """The constants of a large form with what matters in the cells of its bounds."""
        s = self.formulas
        low, high = np.array(bounds, np.float64).T
        leaves = len(s.rays.leaves)
        side = (np.prod(high - low) / min(CELLS * leaves, MOST_ASKED / leaves)) ** (1 / 3)
        number = np.clip(np.ceil((high - low) / side), 1, MOST_CELLS)
        width = (high - low) / number
        margin = NEXT * float(width.min())
        count = int(np.prod(number))
        words = np.zeros((padded(count), s.words), np.uint64)
        given = np.zeros((3, 3, len(words)))  # low, high and slope of each axis
        at = np.indices(number.astype(int)).reshape(3, -1)
        given[:, 0, :count] = low[:, None] + at * width[:, None] - margin
        given[:, 1, :count] = low[:, None] + (at + 1) * width[:, None] + margin
        head = np.zeros(HEAD)
        for place, part in ((CORNER, low), (WIDTH, width), (NUMBER, number), (MARGIN, [margin])):
            head[place : place + len(part)] = part
        self._call("cells", 0, count, given, array, words, *self._room(), len(words))
        places = np.arange(count + 1) * s.words
        known = words[:count].ravel()
        if s.tabled:
            self._call("regions", 0, count, words, array, places, None, *self._room())
            places[1:] = places[:-1].cumsum()
            places[0] = 0
            known = np.empty(places[-1], np.uint64)
            self._call("regions", 0, count, words, array, places, known, *self._room())
        integers = np.concatenate([places[:-1] + HEAD + count, known.view(np.int64)])
        return np.concatenate([array, head, integers.view(np.float64)])

    def _room(self) -> tuple[Ints, ...]:
        """Memory that a call works in."""
        return (np.zeros(self.formulas.room.size, np.int64),) if self.formulas.celled else ()

    def picture(self, pencil: Pencil, near: float, far: float, planes: Floats, constants: Floats, threads: int) -> Seen:
        """What the rays of a pencil meet within planes (n, 4)."""
        width, height = pencil.size
        tile = self.formulas.tile
        rows, columns = -(-height // tile), -(-width // tile)
        tiles, pool = rows * columns, Crowd(threads)
        every = Beams(np.arange(tiles), np.full(tiles, -np.inf), np.full(tiles, np.inf))
        common, of_tiles = self._beams(pencil, columns, every, (near, far), planes, constants, pool)
        shape = rows * tile, columns * tile
        seen = Seen(np.empty(shape), np.empty(shape, np.int16), np.empty((3, *shape)), np.empty(shape, np.uint8))
        out = (seen.depth, seen.leaf, seen.normal, seen.doubt, shape[1], shape[0] * shape[1])
        pool.run(lambda a, b: self._call("picture", a, b, *common, *self._room(), *of_tiles, *out), tiles, columns)
        part = np.s_[:height, :width]
        return Seen(seen.depth[part], seen.leaf[part], seen.normal[(np.s_[:], *part)], seen.doubt[part])

    def starts(self, pencil: Pencil, beams: Beams, planes: Floats, constants: Floats, threads: int) -> Floats:
        """Where beams may meet something; inf where they cannot."""
        tiles, found = pencil.part((0, 0), 1 / self.formulas.tile, pencil.size), np.empty(len(beams.which))
        ends = -np.inf if pencil.eye is None else 0.0, np.inf
        for part in (slice(k, k + AT_ONCE) for k in range(0, len(found), AT_ONCE)):
            some = Beams(beams.which[part], beams.near[part], beams.far[part])
            _, of_tiles = self._beams(tiles, pencil.size[0], some, ends, planes, constants, Crowd(threads))
            found[part] = of_tiles[0][: len(some.which)]
        return found

    def _beams(
        self,
        pencil: Pencil,
        columns: int,
        beams: Beams,
        ends: tuple[float, float],
        planes: Floats,
        constants: Floats,
        pool: Crowd,
    ) -> tuple[tuple[Any, ...], tuple[Floats, ...]]:
        """Cast beams round tiles, of which a row has so many; what they were cast with, and what is known of tiles."""
        some, words = _in_vectors(beams), self.formulas.words
        tiles = len(some.which)
        camera = _camera(pencil, *ends, planes, self.formulas.tile)
        common = (camera, planes, len(planes), constants, columns)
        starts, nothing = np.empty(tiles), np.zeros(words, np.uint64)
        of_tiles: tuple[Floats, ...] = (starts,)
        if not self.formulas.celled:
            of_tiles = (starts, np.empty(tiles), np.empty(tiles * STRETCHES * words, np.uint64))
        before = self._room if self.formulas.celled else lambda: (nothing,)
        beam = -(-tiles // (LANES * pool.threads * 4)) * LANES
        pool.run(lambda a, b: self._call("beams", a, b, *common, *some, *before(), *of_tiles), tiles, beam)
        return common, of_tiles

    def rays(
        self,
        origins: Floats,
        directions: Floats,
        ends: tuple[float, float],
        pixel: tuple[float, float],
        planes: Floats,
        constants: Floats,
        threads: int,
    ) -> Seen:
        """What rays (n, 3) meet within planes (n, 4)."""
        pool = Crowd(threads)
        count = len(origins)
        length = padded(count)
        given = np.empty((6, length))
        given[:3, :count], given[3:, :count] = origins.T, directions.T
        given[:, count:] = np.array([[np.nan] * 3 + [1.0] * 3]).T
        camera = np.zeros(32)
        for name, value in zip(("near", "far", "pixel", "growth"), (*ends, *pixel), strict=True):
            camera[place_of(name)] = value
        seen = Seen(np.empty(length), np.empty(length, np.int16), np.empty((3, length)), np.empty(length, np.uint8))
        of_all: tuple[Any, ...] = ()
        if not self.formulas.celled:
            of_all = np.array([-np.inf]), np.zeros(STRETCHES * self.formulas.words, np.uint64)
        common = (camera, planes, len(planes), constants, given, *of_all)
        out = (seen.depth, seen.leaf, seen.normal, seen.doubt, length)
        step = max(LANES, min(4096, -(-count // (LANES * pool.threads)) * LANES))
        pool.run(lambda a, b: self._call("rays", a, b, *common, *self._room(), *out), count, step)
        return Seen(seen.depth[:count], seen.leaf[:count], seen.normal[:, :count], seen.doubt[:count])

    def _call(self, name: str, *arguments: Any) -> None:
        self._functions[name](*(a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments))


def _in_vectors(beams: Beams) -> Beams:
    """Beams in whole vectors: those that fill them up begin nowhere."""
    more = 0, padded(len(beams.which)) - len(beams.which)
    near, far = (np.pad(one, more, constant_values=np.inf) for one in (beams.near, beams.far))
    return Beams(np.pad(beams.which, more), near, far)


def _lengths(vectors: Floats) -> Floats:
    """The lengths (n,) of vectors (3, n), whose squares may be no numbers."""
    _, exponent = np.frexp(np.abs(vectors).max(axis=0))
    return np.asarray(np.ldexp(np.sqrt(sum(part * part for part in np.ldexp(vectors, -exponent))), exponent))


def _camera(pencil: Pencil, near: float, far: float, planes: Floats, tile: int) -> Floats:
    camera = np.zeros(32)
    eye = pencil.forward if pencil.eye is None else pencil.eye
    for name, vector in zip(VECTORS_OF_CAMERA, (pencil.corner, pencil.across, pencil.down, eye), strict=True):
        camera[place_of(name) : place_of(name) + 3] = vector
    # Half the diagonal of a tile; a little more for what rounding loses.
    diagonal = float(np.linalg.norm([np.linalg.norm(pencil.across), np.linalg.norm(pencil.down)])) * tile / 2 * 1.001
    away = 1.0
    if pencil.eye is not None:
        normal = np.cross(pencil.across, pencil.down)
        away = abs(np.dot(np.subtract(pencil.corner, pencil.eye), normal)) / float(np.linalg.norm(normal))
    # The first planes are the sides of the bounds.
    bounds = [(-planes[2 * axis, 3], planes[2 * axis + 1, 3]) for axis in range(3)]
    corners = np.array(np.meshgrid(*bounds)).reshape(3, -1).T
    farthest = float(np.linalg.norm(corners - np.array(pencil.eye or pencil.corner), axis=1).max())
    flat, spread = (diagonal, 0.0) if pencil.eye is None else (0.0, diagonal / away)
    pixel, growth = pencil.pixel
    values = (float(pencil.eye is not None), near, far, pixel, growth, flat, spread, flat + spread * farthest)
    for name, value in zip(NUMBERS_OF_CAMERA, values, strict=True):
        camera[place_of(name)] = value
    return camera


class Crowd:
    """Threads that share work in pieces of a size that does not depend on how many they are."""

    def __init__(self, threads: int) -> None:
        self.threads = threads

    def run(self, work: Callable[[int, int], None], count: int, step: int) -> None:
        """Work on [first, last) for all pieces of `count`."""
        pieces = [(first, min(first + step, count)) for first in range(0, count, step)]
        if self.threads == 1 or len(pieces) < 2:
            for first, last in pieces:
                work(first, last)
            return
        # To begin them anew for each of the eight casts of a picture takes a twentieth of its time.
        pool = lasting_threads("rsym-rays", self.threads)
        list(pool.map(lambda piece: work(*piece), pieces))


_kernels: dict[str, RayKernels] = {}
_making = threading.Lock()
_MOST_KERNELS = 32  # a notebook has a few models open


def ray_kernels(form: SignForm) -> RayKernels:
    """Compiled once in a process."""
    key = form.key
    with _making:
        if key not in _kernels:
            while len(_kernels) >= _MOST_KERNELS:
                _kernels.pop(next(iter(_kernels)))
            _kernels[key] = RayKernels(form)
        return _kernels[key]
