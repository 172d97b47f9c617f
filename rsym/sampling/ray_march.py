"""Rays in arrays, where there is no compiler: the march of the kernels with the same steps, slower."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats, Ints
from rsym.bounds.ray_forms import ray_form
from rsym.bounds.ray_reference import RayReference, along
from rsym.logic.gates import Gate, through
from rsym.model.shape import Bounds
from rsym.sampling.hits import Seen
from rsym.sampling.leaf_fields import LeafFields
from rsym.sampling.pencils import Beams, Pencil
from rsym.sampling.ray_steps import (
    ALIKE,
    CROSSING,
    HALVINGS,
    LONGER,
    MOST_BEAM_STEPS,
    MOST_STEPS,
    NARROWER,
    NEAR,
    PATIENCE,
    ROUNDED_AWAY,
    SETTLED,
    SHORTEST,
    TOO_OFTEN,
)

NEWTON_STEPS = 8
BLOCK = 20_000  # rays at a time


class MarchLetters(NamedTuple):
    """What a march needs of letters."""

    letters: Mapping[str, float]
    bounds: Bounds


@dataclass
class March:
    """Rays on their way: where the form is first not negative on each."""

    origins: Floats
    directions: Floats
    t: Floats
    stop: Floats
    step: Floats
    low: Floats
    high: Floats
    failed: Ints
    passed: Floats
    met: Ints

    @classmethod
    def started(cls, origins: Floats, directions: Floats, t: Floats, stop: Floats) -> March:
        """At t."""
        count = len(t)
        none = np.zeros(count, np.int64)
        nowhere = np.full(count, np.inf)
        return cls(origins, directions, t.copy(), stop, (stop - t) / 4, t.copy(), t.copy(), none, nowhere, none - 1)

    def points(self, which: Ints, t: Floats) -> Floats:
        """Points of rays."""
        return self.origins[which] + t[:, None] * self.directions[which]


@dataclass(frozen=True)
class ArrayRays:
    """What `RayKernels` are, on the leaves of a shape."""

    fields: LeafFields

    @cached_property
    def reference(self) -> RayReference:
        """The models."""
        return RayReference(ray_form(self.fields.form, lines=True, guards=True))

    def constants(self, letters: Mapping[str, float], bounds: Bounds) -> MarchLetters:
        """Letters as they are."""
        return MarchLetters(letters, bounds)

    def picture(
        self, pencil: Pencil, near: float, far: float, planes: Floats, constants: MarchLetters, threads: int
    ) -> Seen:
        """What the rays of a pencil meet within planes (n, 4)."""
        origins, directions = (part.reshape(-1, 3) for part in pencil.rays())
        seen = self.rays(origins, directions, (near, far), pencil.pixel, planes, constants, threads)
        return seen.reshaped(pencil.size[::-1])

    def starts(self, pencil: Pencil, beams: Beams, planes: Floats, constants: MarchLetters, threads: int) -> Floats:
        """Where beams may meet something; inf where they cannot."""
        row, column = np.divmod(beams.which, pencil.size[0])
        o, d = pencil.rays(column + 0.5, row + 0.5)
        sides, (side, growth) = np.linalg.norm([pencil.across, pencil.down], axis=1), pencil.pixel
        half = float(np.hypot(*sides)) / 2 * 1.001  # a little more for what rounding loses
        still, growing = (half, 0.0) if pencil.eye is None else (0.0, half * growth / float(sides.min()))
        room = still
        if pencil.eye is not None:
            low, high = np.array(constants.bounds).T
            room = growing * float(np.linalg.norm(np.maximum(np.abs(low - pencil.eye), np.abs(high - pencil.eye))))
        wider = np.column_stack([planes[:, :3], planes[:, 3] + room])
        with np.errstate(all="ignore"):
            near = np.maximum(beams.near, -np.inf if pencil.eye is None else 0.0)
            t, stop, _ = _clipped(o, d, (near, beams.far), wider)
            step, live, gone = (stop - t) / 2, np.flatnonzero(t < stop), t >= stop
            for _ in range(MOST_BEAM_STEPS):
                now, length = t[live], np.minimum(step[live], stop[live] - t[live])
                radius = still + growing * (np.abs(now) + length)
                _, high, linear, quadratic = self.reference(
                    constants.letters, along(o[live], d[live], now, length, radius)
                )
                upper = first_root(high + quadratic - linear, linear, quadratic)
                out = upper > 2
                t[live] = np.where(out, now + length, now + upper * length / 2)
                step[live] = np.where(out, 2 * length, np.minimum(now + length - t[live], length / 2))
                gone[live] = t[live] >= stop[live]
                live = live[~gone[live] & (out | (length >= (side + growth * np.abs(now)) * NEAR))]
        return np.where(gone, np.inf, t)

    def rays(
        self,
        origins: Floats,
        directions: Floats,
        ends: tuple[float, float],
        pixel: tuple[float, float],
        planes: Floats,
        constants: MarchLetters,
        threads: int,
    ) -> Seen:
        """What rays (n, 3) meet within planes (n, 4)."""
        parts = [slice(k, k + BLOCK) for k in range(0, max(1, len(origins)), BLOCK)]
        with np.errstate(all="ignore"):
            seen = [self._block(origins[part], directions[part], ends, pixel, planes, constants) for part in parts]
        return Seen(*(np.concatenate([one[k] for one in seen], axis=-1) for k in range(4)))

    def _block(
        self,
        o: Floats,
        d: Floats,
        ends: tuple[float, float],
        pixel: tuple[float, float],
        planes: Floats,
        constants: MarchLetters,
    ) -> tuple[Floats, Ints, Floats, Ints]:
        fields = replace(self.fields, letters=constants.letters)
        scale = ALIKE * float(np.linalg.norm([high - low for low, high in constants.bounds]))
        active = Actives(fields, scale)
        start, stop, entry = _clipped(o, d, ends, planes)
        rays = March.started(o, d, start, stop)
        lost = self._march(rays, active, pixel, constants)
        leaf = np.full(len(o), -1, np.int64)
        room = LONGER * np.maximum((pixel[0] + pixel[1] * np.abs(rays.high)) * SHORTEST, _rounding(rays, rays.high))
        passed = np.isfinite(rays.passed) & ~((rays.met >= 0) & (rays.high - rays.passed < room))
        met = np.flatnonzero(rays.met >= 0)
        leaf[met] = rays.met[met]
        begins = met[rays.low[met] <= start[met]]
        deep = begins[active(rays.points(begins, start[begins]))[0] > scale]
        rays.t[met] = rays.high[met]
        rays.t[deep] = start[deep]
        count = len(fields.form.leaves)
        inner = entry[deep] >= 0
        leaf[deep[inner]] = count + entry[deep[inner]]
        rays.low[deep] = rays.high[deep] = start[deep]
        leaf[lost] = active(rays.points(lost, rays.t[lost]))[1]
        rays.low[lost] = rays.high[lost] = rays.t[lost]
        normal = np.full((3, len(o)), np.nan)
        self._settle(rays, active, leaf, normal, pixel)
        for k, plane in enumerate(planes):
            normal[:, leaf == count + k] = plane[:3, None]
        depth = np.where(leaf >= 0, rays.t, np.inf)
        doubt = passed | (rays.failed > TOO_OFTEN)
        doubt[lost] = True
        return depth, leaf.astype(np.int16), normal, doubt.astype(np.uint8)

    def _march(self, rays: March, active: Actives, pixel: tuple[float, float], constants: MarchLetters) -> Ints:
        """Until each ray has met the form or is gone; those that are lost."""
        live = np.flatnonzero(rays.t < rays.stop)
        for _ in range(MOST_STEPS):
            if not len(live):
                break
            t = rays.t[live]
            step = np.minimum(rays.step[live], rays.stop[live] - t)
            models = along(rays.origins[live], rays.directions[live], t, step)
            low, high, linear, quadratic = self.reference(constants.letters, models)
            bend = quadratic - linear
            upper, lower = (first_root(end + bend, linear, quadratic) for end in (high, low))
            out, certain = upper > 2, lower <= 2
            begin = t + upper * step / 2
            width = np.maximum((lower - upper) * step / 2, 0)
            size = pixel[0] + pixel[1] * np.abs(t)
            shortest = np.maximum(size * SHORTEST, _rounding(rays, t, live)) * 2.0 ** (rays.failed[live] // PATIENCE)
            crosses = certain & (width < CROSSING * size)
            asked = ~out & (crosses | (~certain & (step <= 1.01 * shortest)))
            following = np.maximum(np.minimum(np.where(certain, width, t + step - begin), step / 2), shortest)
            rays.t[live] = np.where(out, t + step, begin)
            rays.step[live] = np.where(out, 2 * step, following)
            end = np.where(crosses, begin + width, t + step)
            which = live[asked]
            value, leaf = active(rays.points(which, end[asked]))
            inside = (crosses[asked] & ~np.isnan(value)) | (value > 0)
            rays.met[which[inside]] = leaf[inside]
            rays.low[which[inside]], rays.high[which[inside]] = begin[asked][inside], end[asked][inside]
            again = which[~inside]
            rays.t[again] = np.where(crosses, np.maximum(end, begin + shortest), end)[asked][~inside]
            rays.step[again] = shortest[asked][~inside]
            rays.failed[again] += 1
            jumped = np.flatnonzero(asked)[~inside & ~crosses[asked]]
            those = live[jumped]
            longer = along(rays.origins[those], rays.directions[those], t[jumped], LONGER * shortest[jumped])
            wide = _width(*self.reference(constants.letters, longer))
            narrow = _width(*(part[jumped] for part in (low, high, linear, quadratic)))
            rays.passed[those] = np.where(
                narrow * NARROWER < wide, np.minimum(t[jumped], rays.passed[those]), rays.passed[those]
            )
            live = live[(rays.met[live] < 0) & (rays.t[live] < rays.stop[live])]
        return live

    def _settle(self, rays: March, active: Actives, leaf: Ints, normal: Floats, pixel: tuple[float, float]) -> None:
        """The root on the active leaf within the bracket, and the outer unit normal.

        What Newton's method has not brought to a root is halved by the signs of the form.
        """
        on = np.flatnonzero((leaf >= 0) & (leaf < len(active.fields.form.leaves)))
        near = self._newton(rays, active, leaf, normal, on, pixel)
        near &= active(rays.points(on, rays.t[on]))[1] == leaf[on]
        far = on[~near]
        for _ in range(HALVINGS if len(far) else 0):
            middle = (rays.low[far] + rays.high[far]) / 2
            value, there = active(rays.points(far, middle))
            inside = value > 0
            rays.high[far], rays.low[far] = (
                np.where(inside, middle, rays.high[far]),
                np.where(inside, rays.low[far], middle),
            )
            leaf[far] = np.where(inside, there, leaf[far])
        rays.t[far] = rays.high[far]
        self._newton(rays, active, leaf, normal, far, pixel)

    def _newton(
        self, rays: March, active: Actives, leaf: Ints, normal: Floats, on: Ints, pixel: tuple[float, float]
    ) -> Flags:
        """Newton's method on the leaves of some rays; whether its last step was short."""
        fields, near = active.fields, np.zeros(len(on), np.bool_)
        for turn in range(NEWTON_STEPS if len(on) else 0):
            t = rays.t[on]
            found = fields.at(leaf[on], rays.points(on, t))
            gradient = found["gradient"]
            moved = t - found["value"] / np.einsum("ij,ij->i", gradient, rays.directions[on])
            kept = np.where(np.isfinite(moved), np.clip(moved, rays.low[on], rays.high[on]), t)
            near = abs(moved - t) <= np.maximum((pixel[0] + pixel[1] * np.abs(t)) * SETTLED, _rounding(rays, t, on))
            rays.t[on] = kept
            normal[:, on] = -gradient.T / np.linalg.norm(gradient, axis=1)
            if turn == NEWTON_STEPS // 2:
                leaf[on] = active(rays.points(on, kept))[1]
        return np.asarray(near)


def _rounding(rays: March, t: Floats, which: Ints | slice = slice(None)) -> Floats:
    """How close two points of rays near t can be for their difference to say anything."""
    return np.asarray((np.abs(rays.origins[which]).sum(axis=1) + np.abs(t)) * ROUNDED_AWAY)


def _width(low: Floats, high: Floats, linear: Floats, quadratic: Floats) -> Floats:
    """How far apart two values of a model may be."""
    return np.asarray(high - low + 2 * (np.abs(linear) + np.abs(quadratic)))


@dataclass(frozen=True)
class Actives:
    """The form at points, and its active leaf; of leaves that are closer than the tolerance the first."""

    fields: LeafFields
    tolerance: float

    def __call__(self, points: Floats) -> tuple[Floats, Ints]:
        """Values and leaves at points (n, 3)."""

        def join(gate: Gate, one: tuple[Floats, Ints], other: tuple[Floats, Ints]) -> tuple[Floats, Ints]:
            (f, i), (g, j) = one, other
            take = (f < g if gate.operation == "min" else f > g) | np.isnan(f)
            leaf = np.where(np.abs(f - g) <= self.tolerance, np.minimum(i, j), np.where(take, i, j))
            return np.where(take, f, g), leaf

        values = self.fields.values(points)
        return through(self.fields.form.gates, [(row, np.full(len(row), k)) for k, row in enumerate(values)], join)[-1]


def first_root(end: Floats, linear: Floats, quadratic: Floats) -> Floats:
    """The smallest w = s + 1 >= 0 at which a parabola is 0, `end` its value at w = 0; beyond 2 if there is none.

    Examples
    --------
    >>> first_root(np.array([-1.0, -1.0, 1.0]), np.array([1.0, -1.0, 0.0]), np.zeros(3)).tolist()
    [1.0, 3.0, 0.0]
    """
    with np.errstate(all="ignore"):
        slope = linear - 2 * quadratic
        discriminant = slope * slope - 4 * quadratic * end
        root = np.sqrt(np.maximum(discriminant, 0))
        far = np.where(quadratic > 0, (root - slope) / (2 * quadratic), 3.0)
        found = np.where(slope >= 0, -2 * end / (slope + root), far)
        found = np.where((discriminant >= 0) & (found >= 0), found, 3.0)
    return np.asarray(np.where(end < 0, found, 0.0))


def _clipped(o: Floats, d: Floats, ends: tuple[ArrayLike, ArrayLike], planes: Floats) -> tuple[Floats, Floats, Ints]:
    """Where rays come into the half-spaces and leave them, and by which plane they come."""
    first, last = np.full(len(o), ends[0]), np.full(len(o), ends[1])
    entry = np.full(len(o), -1, np.int64)
    for k, (*normal, offset) in enumerate(planes):
        slope, room = d @ np.array(normal), offset - o @ np.array(normal)
        at = room / slope
        enters = (slope < 0) & (at > first)
        first[enters], entry[enters] = at[enters], k
        last = np.where((slope > 0) & (at < last), at, last)
        last = np.where((slope == 0) & (room < 0), -np.inf, last)
    return first, last, entry
