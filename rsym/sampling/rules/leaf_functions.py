"""The leaves of a sign form as functions at points and over boxes, each scaled to gradients of length about 1."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.logic.branches import opened_leaf
from rsym.logic.gates import Gate
from rsym.logic.leaf_names import leaf_names
from rsym.logic.lifting import TURNED, origins
from rsym.logic.sign_form import SignForm, sign_form, surface_form
from rsym.logic.stripping import unscaled as multiple
from rsym.model.recent import recently, written
from rsym.model.shape import Bounds, Shape
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all
from rsym.sampling.compiled import loop, step
from rsym.sampling.kernels.mesher_kernels import (
    MesherKernels,
    backend_for,
    letters_of_form,
    median_scales,
    mesher_kernels,
)
from rsym.sampling.regions.own_leaves import across, unscaled
from rsym.sampling.regions.region_kernels import region_kernels
from rsym.sampling.rules.division import CutPieces
from rsym.sampling.rules.walks import form_sign
from rsym.sampling.sharp.crossings import CompiledLeaves

FEW = 8  # leaves of which all combinations of signs are tried
FAINT = 32.0  # roots of rounding: beside the double zero of a square multiplied out all is noise, a thousandth as steep
FACTOR, MODULUS = 1_000_003, (1 << 31) - 1  # numbers of what is reached are equal by chance once in 2e9
EPSILON = float(np.finfo(np.float64).eps)


class LeafFunctions:
    """The leaves of a shape at letters, seen from a box of bounds.

    Attributes
    ----------
    dimension : int
        2 or 3.
    count : int
        How many leaves there are.
    gates : (n, 3) int
        0 for a min and 1 for a max, and its operands.
    tolerance : float
        A scaled value up to this is zero to rounding: it belongs to a distance of some last places of the bounds.
    domain_ends : (count,)
        Which leaves are ends of domains and poles: of those that have one surface another one bounds.
    folds : (count,)
        Which leaves bound nothing: rules end and begin where they are zero.
    faint : float
        A scaled gradient up to this may be all of rounding: so steep is a square where it is as large as some of that.
    """

    def __init__(
        self,
        shape: Shape,
        form: SignForm,
        letters: Mapping[Any, float] | None,
        bounds: Bounds,
        domain_ends: Flags,
    ) -> None:
        self.dimension, self.count = shape.dimension, len(form.leaves)
        self.gates = gate_array(form.gates)
        self._multiples = _multiples_of(form)
        self.walls = np.ones(self.count, np.bool_)
        self.domain_ends = domain_ends
        self.folds = np.isin(np.arange(self.count), form.folds)
        self.tolerance = 8 * EPSILON * max(abs(end) for pair in bounds for end in pair)
        self.faint = FAINT * math.sqrt(self.tolerance / max(high - low for low, high in bounds))
        box = (*bounds, (-1.0, 1.0))[:3]
        values = shape.letters.values_with(letters)
        kernels: Any = _kernels(form).copy()
        kernels.set(values, box)
        plain = letters_of_form(form, values, box)
        if isinstance(kernels, MesherKernels):
            kernels.set_points([*plain, *[1.0] * self.count])
        else:
            kernels = unscaled(kernels, dict(zip(form.builder.letters, plain, strict=True)), box)
        self.scales = median_scales(kernels, self.count, box)
        self._leaves = CompiledLeaves(kernels)

    def evaluate(self, leaf: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) of leaf[k] at point k of (dim, n), and gradients (dim, n)."""
        value, gradient = self._leaves.evaluate(leaf.astype(np.int16), self._in_space(points))
        scale = self.scales[leaf]
        return value * scale, gradient[: self.dimension] * scale

    def sign(self, points: Floats) -> Any:
        """The sign (n,) of the form at points (dim, n)."""
        count = points.shape[1]
        value, _ = self.evaluate(np.repeat(np.arange(self.count), count), np.tile(points, self.count))
        signs = list(np.sign(value).reshape(self.count, count))
        for is_max, first, second in self.gates:
            signs.append((np.maximum if is_max else np.minimum)(signs[first], signs[second]))
        return signs[-1]

    def judge(self, pieces: CutPieces, value: Floats) -> tuple[Any, Ints, Flags]:
        """From bounds of values the signs of all leaves, the sign of the form, and which leaves that depends on."""
        signs, verdict = pieces.signs.copy(), np.zeros(len(pieces), np.int64)
        kept = np.zeros(len(pieces.leaf), np.bool_)
        steepest = np.abs(pieces.gradient).max(axis=1).sum(axis=0)
        tolerance = self.tolerance * np.minimum(1.0, steepest)
        open_signs = pieces.start, pieces.leaf, *self._multiples, value, signs, verdict, kept
        judge_form(self.gates, self.folds, tolerance, *open_signs)
        return signs, verdict, kept

    def enclose(self, leaf: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of leaf[k] over box k of (dim, n), and (dim, 2, n) of its gradient; infinite if undefined."""
        value, gradient = self._leaves.enclose(leaf.astype(np.int16), self._in_space(lower), self._in_space(upper))
        scale = self.scales[leaf]
        return value * scale, gradient[: self.dimension] * scale

    def _in_space(self, points: Floats) -> Floats:
        return points if self.dimension == 3 else np.vstack([points, np.zeros(points.shape[1])])


@dataclass(frozen=True)
class RuleForm:
    """A sign form as kernels want it, in three coordinates, choices and products in its leaves opened to gates.

    names : of the leaves that the form came with; owner : for each leaf of `form` the number of that it comes from;
    walls : which of those are ends of domains and poles, no zeros.
    """

    form: SignForm
    names: tuple[str, ...]
    owner: Ints
    walls: tuple[int, ...] = ()


@recently(16, written)
def rule_form(shape: Shape, capped: bool, folds: tuple[Any, ...] = ()) -> RuleForm:
    """The form of a shape, with its bounds as leaves behind the others, and then expressions that are to be folds."""
    plain = surface_form(shape, *across(shape))
    plain.require_traced()
    walls = tuple(plain.walls)
    form, owner = _smooth(plain)
    if capped:
        # Those across a plane are never met, and have no names.
        sides = len(plain.leaves) + np.minimum(np.arange(6), 2 * shape.dimension - 1)
        form, owner, plain = form.capped(), np.concatenate([owner, sides]), plain.capped()
    return RuleForm(_folded(form, folds), leaf_names(plain, shape), np.append(owner, np.full(len(folds), -1)), walls)


def _folded(form: SignForm, functions: tuple[Any, ...]) -> SignForm:
    """The form with functions for leaves more, which are folds: no gate has them."""
    if not functions:
        return form
    count, more = len(form.leaves), len(functions)
    gates = [Gate(op, *(a + more * (a >= count) for a in operands)) for op, *operands in form.gates]
    return replace(
        form,
        leaves=(*form.leaves, *lower_all(form.builder, functions)),
        gates=tuple(gates or [Gate("min", 0, 0)]),
        folds=tuple(range(count, count + more)),
    )


def _smooth(form: SignForm) -> tuple[SignForm, Ints]:
    """The form without kinks, nodes and poles in leaves that are choices, products and quotients, and whose they are.

    Slabs are two half-spaces: rules on plane faces then have large parts.
    """
    builder = form.builder
    leaves = [_slab(builder, opened_leaf(builder, leaf)) for leaf in form.leaves]
    smooth = replace(sign_form(builder, form.remade(leaves)), parameters=form.parameters)
    owner = origins(form, leaves, smooth)
    if list(form.leaves) == leaves or -1 in owner:
        return form, np.arange(len(form.leaves))
    return smooth, np.array(owner)


def _slab(builder: Builder, leaf: int) -> int:
    """A leaf c - k*u**2, of a linear u and numbers c and k above 0, as min(r - u, r + u), r the root of c/k.

    So for its negative, a max.
    """
    operation, arguments, _ = builder.nodes[leaf]
    if operation == "neg" and (inner := _slab(builder, arguments[0])) != arguments[0]:
        operation, sides, _ = builder.nodes[inner]
        return builder.make(TURNED[operation], *(builder.neg(side) for side in sides))
    for constant, square in _both_ways(builder, leaf, "add"):
        height = builder.value(constant)
        for share, part in _multiples(builder, square):
            _, sides, _ = builder.nodes[part]
            if height is None or height * share >= 0 or builder.nodes[part].operation != "mul" or sides[0] != sides[1]:
                continue
            if _is_linear(builder, sides[0]):
                half = builder.sqrt(builder.const(-height / share))
                below, above = builder.add(half, sides[0]), builder.sub(half, sides[0])
                if height > 0:
                    return builder.make("min", below, above)
                return builder.make("max", builder.neg(below), builder.neg(above))
    return leaf


def _both_ways(builder: Builder, number: int, operation: str) -> tuple[tuple[int, ...], ...]:
    """The operands of a node of such an operation in both orders; none of another."""
    node = builder.nodes[number]
    return (node.arguments, node.arguments[::-1]) if node.operation == operation else ()


def _multiples(builder: Builder, number: int) -> Iterator[tuple[Fraction, int]]:
    """A node as numbers times nodes: itself, and without a sign and a factor."""
    yield Fraction(1), number
    sign, part = Fraction(1), number
    if builder.nodes[number].operation == "neg":
        sign, part = -sign, builder.nodes[number].arguments[0]
        yield sign, part
    if builder.nodes[part].operation == "mul":
        factor, rest = builder.nodes[part].arguments
        if (value := builder.value(factor)) is not None:
            yield sign * value, rest


def _is_linear(builder: Builder, number: int) -> bool:
    """Whether a node is a sum of multiples of coordinates by numbers and letters."""
    operation, arguments, _ = builder.nodes[number]
    if operation == "input" or builder.uniform[number]:
        return True
    if operation == "mul" and not any(builder.uniform[argument] for argument in arguments):
        return False
    return operation in {"add", "neg", "mul"} and all(_is_linear(builder, argument) for argument in arguments)


def _multiples_of(form: SignForm) -> tuple[Ints, Ints]:
    """For each leaf the first one that it is a multiple of, and the sign of that: so are flush faces."""
    parts = [multiple(form.builder, leaf) for leaf in form.leaves]
    places = {part.number: place for place, part in reversed([*enumerate(parts)])}
    first = np.array([places[part.number] for part in parts], np.int64)
    signs = np.array([part.sign for part in parts], np.int64)
    return first, signs * signs[first]


def gate_array(gates: tuple[Gate, ...]) -> Ints:
    """Gates as rows of whole numbers."""
    return np.array([(operation == "max", *operands) for operation, *operands in gates], np.int64).reshape(-1, 3)


@recently(16)
def _kernels(form: SignForm) -> Any:
    return region_kernels(form) if backend_for(form) == "tape" else mesher_kernels(form)


@loop
def judge_form(
    gates: Any, folds: Any, tolerance: Any, start: Any, leaf: Any, first: Any, turned: Any, value: Any, signs: Any,
    verdict: Any, kept: Any,
) -> None:  # fmt: skip
    """Signs of leaves from their bounds, the sign of the form, and which leaves of open sign that depends on."""
    leaves, count = signs.shape[1], len(gates)
    known = np.zeros(leaves + count, np.int8)
    wanted = np.zeros(leaves + count, np.bool_)
    group = np.zeros(leaves, np.int64)
    for piece in range(len(verdict)):
        own = signs[piece]
        for pair in range(start[piece], start[piece + 1]):
            if value[0, pair] > tolerance[pair]:
                own[leaf[pair]] = 1
            elif value[1, pair] < -tolerance[pair]:
                own[leaf[pair]] = -1
        verdict[piece] = form_sign(gates, own, known)
        if verdict[piece] == 0:
            wanted[:] = False
            wanted[-1] = True
            for k in range(count - 1, -1, -1):
                if wanted[leaves + k]:
                    for j in range(1, 3):
                        if known[gates[k, j]] == 0:
                            wanted[gates[k, j]] = True
            verdict[piece] = tried(gates, first, turned, own.copy(), known, group, wanted)
            for pair in range(start[piece], start[piece + 1]):
                kept[pair] = wanted[leaf[pair]] and own[leaf[pair]] == 0
            # Whatever the others are, the form is the same.
            for k in range(leaves):
                if own[k] == 0 and not wanted[k] and not folds[k]:
                    own[k] = -turned[k]
        for pair in range(start[piece], start[piece + 1]):
            if folds[leaf[pair]] and own[leaf[pair]] == 0 and verdict[piece] >= 0:
                kept[pair], verdict[piece] = True, 0


@step
def tried(gates: Any, first: Any, turned: Any, signs: Any, known: Any, group: Any, wanted: Any) -> int:
    """The sign of a form of open sign whose leaves of open sign may be multiples of one another; wanted are then fewer.

    These have one sign: all combinations of signs are tried, if they are few. A leaf is wanted if the form depends on
    it, or by which of the gates the boundary is.
    """
    free, several = 0, False
    for k in range(len(signs)):
        group[k] = -1
        if signs[k] == 0 and wanted[k]:
            for j in range(k):
                if group[j] >= 0 and first[j] == first[k]:
                    group[k], several = group[j], True
            if group[k] < 0:
                group[k] = free
                free += 1
    if not several or free > FEW:
        return 0
    every = 1 << free
    results, bounding = np.empty(every, np.int8), np.zeros((free, every), np.int64)
    for number in range(every):
        results[number] = sign_with(gates, turned, group, number, free, signs, known)
    matters = np.zeros(free, np.bool_)
    for one in range(free):
        for number in range(every):
            if results[number] != results[number ^ (1 << one)]:
                matters[one] = True
                sign_with(gates, turned, group, number, one, signs, known)
                bounding[one, number] = reached(gates, len(signs), known)
    for one in range(free):
        for other in range(free):
            for number in range(every):
                here, there = bounding[other, number], bounding[other, number ^ (1 << one)]
                if one != other and here != 0 and there != 0 and here != there:
                    matters[one] = True
    for k in range(len(signs)):
        wanted[k] = wanted[k] and (group[k] < 0 or matters[group[k]])
    sign: int = 0 if matters.any() else results[0]
    return sign


@step
def sign_with(gates: Any, turned: Any, group: Any, number: int, zero: int, signs: Any, known: Any) -> int:
    """The sign of the form with signs of groups by the digits of a number, but one of them zero; of others any."""
    for k in range(len(signs)):
        if group[k] == zero:
            signs[k] = 0
        elif group[k] >= 0:
            signs[k] = turned[k] * (1 if number >> group[k] & 1 else -1)
        elif signs[k] == 0:
            signs[k] = -turned[k]
    sign: int = form_sign(gates, signs, known)
    return sign


@step
def reached(gates: Any, leaves: int, known: Any) -> int:
    """A number that tells by which leaves and gates that are zero the form is."""
    found = np.zeros(len(known), np.bool_)
    found[-1] = True
    told = 0
    for k in range(len(gates) - 1, -1, -1):
        if found[leaves + k]:
            for j in range(1, 3):
                operand = gates[k, j]
                if known[operand] == 0 and not found[operand]:
                    found[operand] = True
                    told = (told * FACTOR + operand + 1) % MODULUS
    return told
