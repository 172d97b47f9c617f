"""Networks: two families of curves, each curve of one meeting all of the other at parameters of a grid."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import MEETING, Correction, longest, require_tolerance
from rsym.surfaces.functions.cardinals import checked_knots
from rsym.surfaces.functions.univariate import Sampled, Stack, Univariate, on_interval
from rsym.surfaces.networks.families import family
from rsym.surfaces.networks.intersections import QUOTIENT, meeting_parameters, polygon
from rsym.surfaces.networks.reparametrisation import Composed, Part, increasing
from rsym.surfaces.parameters import LetterValues

# Shares of the size of a network. Curves whose parameters leave a larger gap than the first are given other ones:
# intersections are found to about 1e-15. Beyond the second the curves themselves do not meet.
COMPATIBLE = 2e-13
# Ends of a curve that agree in position to 1e-9 of the size and in tangent to this share of it make it closed.
TANGENT = 1e-5


@dataclass(frozen=True)
class Network:
    """u-curves r_j(u) and v-curves s_i(v) with r_j(u_i) = s_i(v_j) = p_ij.

    In a closed direction the knots end with the first one again, a period later.
    """

    u_curves: Stack
    v_curves: Stack
    u_knots: tuple[float, ...]
    v_knots: tuple[float, ...]
    closed: tuple[bool, bool]
    tolerance: float

    @property
    def points(self) -> Sampled:
        """The points p_ij, (number of v-curves, number of u-curves, 3)."""
        return _at_knots(self.u_curves, self.u_knots, self.v_curves.shape[0])

    def gaps(self, letters: LetterValues = None) -> Floats:
        """The distances of r_j(u_i) and s_i(v_j), indices [i, j]."""
        over = _at_knots(self.v_curves, self.v_knots, self.u_curves.shape[0])
        start = np.zeros(())
        (along,), (across,) = (one.evaluate(start, [0], letters) for one in (self.points, over))
        return np.asarray(np.sqrt(((along - np.swapaxes(across, 0, 1)) ** 2).sum(axis=-1)))

    def correction(self, functions: Univariate) -> Correction:
        """How far a surface with these cardinal functions of u passes from the u-curves; it holds the v-curves.

        On v = v_j that is sum_i phi_i(u) (s_i(v_j) - p_ij).
        """
        gaps = self.gaps()
        over = _at_knots(self.v_curves, self.v_knots, self.u_curves.shape[0])
        start = np.zeros(())
        missed = np.swapaxes(over.evaluate(start, [0])[0], 0, 1) - self.points.evaluate(start, [0])[0]
        found = []
        for j, v in enumerate(self.v_knots[: missed.shape[1]]):
            away, u = longest(functions, missed[:, j])
            found.append((away, (u, v)))
        return Correction(float(gaps.max()), *max(found))

    def check(self, letters: LetterValues) -> None:
        """Refuse letters that move the curves apart."""
        gaps = self.gaps(letters)
        i, j = np.unravel_index(int(gaps.argmax()), gaps.shape)
        if gaps[i, j] > self.tolerance:
            raise RsymError(
                f"these letters part the u-curve {j} and the v-curve {i} by {gaps[i, j]:.3g} at u = "
                f"{self.u_knots[i]:.6g}, v = {self.v_knots[j]:.6g}",
                code="network",
                where=f"the pair (v-curve {i}, u-curve {j})",
                remedy="make the surface anew, with letters= of these values, so that the curves are matched for them",
            )


def network(
    u_curves: Sequence[Any],
    v_curves: Sequence[Any],
    *,
    u_knots: Sequence[Any] | None,
    v_knots: Sequence[Any] | None,
    closed: tuple[bool, bool] | None,
    reparametrise: str,
    tolerance: float,
    letters: Mapping[Any, Any] | None,
) -> Network:
    """The network of two families; parameters are those of `GordonSurface`."""
    require_tolerance(tolerance)
    if reparametrise not in ("auto", "refuse"):
        raise RsymError(f"reparametrise is auto or refuse, got {reparametrise!r}", code="network")
    families = (family(u_curves, letters, "the u-curve"), family(v_curves, letters, "the v-curve"))
    size = float(max(np.ptp(one(np.linspace(*one.domain, 33)), axis=(0, 1)).max() for one in families))
    round_u, round_v = _closed(families, closed, size)
    families = (
        _without_the_last_again(families[0], round_v, size),
        _without_the_last_again(families[1], round_u, size),
    )
    polygons = [
        [polygon(curve, size, ends) for curve in one.curves]
        for one, ends in zip(families, (round_u, round_v), strict=True)
    ]
    own_u, own_v, left = meeting_parameters(polygons[0], polygons[1], tolerance, size)
    own = (own_u, np.ascontiguousarray(own_v.T))
    rounds = (round_u, round_v)
    knots = (
        _knots(own[0], u_knots, families[0], round_u, ("u", "v")),
        _knots(own[1], v_knots, families[1], round_v, ("v", "u")),
    )
    outside = [not _fits(at, one.domain, ends) for at, one, ends in zip(knots, families, rounds, strict=True)]
    if not any(outside):
        plain = _network(families, knots, rounds, (None, None), 2 * tolerance * size)
        gaps = plain.gaps()
        if (gaps <= COMPATIBLE * size + 2 * left).all():
            return plain
    if reparametrise == "refuse":
        raise _unfit("uv"[outside.index(True)]) if any(outside) else _incompatible(gaps, (own_u, own_v), knots)
    return _network(families, knots, rounds, own, 2 * tolerance * size)


def network_latex(net: Network) -> str:
    """The Boolean sum of the curves of a network."""
    i, j = (rf"_{{{index}=0}}^{{{len(one.curves) - 1}}}" for index, one in (("i", net.v_curves), ("j", net.u_curves)))
    return (
        rf"p(u, v) = \sum{j} \psi_j(v)\, r_j(u) + \sum{i} \varphi_i(u)\, s_i(v) "
        rf"- \sum{i} \sum{j} \varphi_i(u)\, \psi_j(v)\, p_{{ij}}"
    )


def _closed(families: tuple[Stack, Stack], asked: tuple[bool, bool] | None, size: float) -> tuple[bool, bool]:
    """Whether each family runs along closed curves: as asked, or if all of them close smoothly."""
    found = []
    for number, (one, name) in enumerate(zip(families, "uv", strict=True)):
        ends, tangents = _ends(one)
        gaps = np.sqrt(((ends[1] - ends[0]) ** 2).sum(axis=-1))
        worst = int(gaps.argmax())
        if asked is not None and asked[number] and gaps[worst] > MEETING * size:
            first, last = (tuple(float(f"{c:.6g}") for c in end[worst]) for end in ends)
            raise RsymError(
                f"the {name}-curve {worst} is not closed: it starts at {first} and ends at {last}, a gap of "
                f"{gaps[worst]:.3g}",
                code="closed",
                remedy="close the curve, or leave closed= out",
            )
        bends = np.abs(tangents[1] - tangents[0]).max(axis=-1)
        speeds = np.abs(tangents).max(axis=(0, 2))
        smooth = bool((gaps <= MEETING * size).all() and (bends <= TANGENT * speeds).all())
        found.append(smooth if asked is None else bool(asked[number]))
    return found[0], found[1]


def _ends(one: Stack) -> tuple[Floats, Floats]:
    """Points and tangents at both ends of all curves; difference quotients, for curves with kinks elsewhere."""
    low, high = one.domain
    step = QUOTIENT * (high - low)
    start, after, before, end = one(np.array([low, low + step, high - step, high]))
    return np.stack([start, end]), np.stack([after - start, end - before]) / step


def _without_the_last_again(one: Stack, cyclic: bool, size: float) -> Stack:
    """A cyclic family without the curve that closes it, which is the first one again."""
    places = np.linspace(*one.domain, 17)
    if (
        cyclic
        and len(one.curves) > 2
        and np.abs(one.curves[0](places) - one.curves[-1](places)).max() <= MEETING * size
    ):
        return Stack(one.curves[:-1])
    return one


def _knots(
    own: Floats, given: Sequence[Any] | None, one: Stack, closed: bool, names: tuple[str, str]
) -> tuple[float, ...]:
    """The parameters of the grid: those given, or the means of the curves' own."""
    along, over = names
    low, high = one.domain
    if closed and len(own) < 3:
        raise RsymError(
            f"the {along}-curves are closed; three {over}-curves across them are the least, got {len(own)}",
            code="closed",
            remedy=f"give more, or with closed= leave the surface open in {along}, between those given",
        )
    if given is not None:
        if len(given) != len(own) + closed:
            again = ", and one for the first again" if closed else ""
            raise RsymError(
                f"{len(own)} {over}-curves need as many {along}_knots{again}: {len(own) + closed}, got {len(given)}",
                code="knots",
                remedy="one knot for each curve across, in their order",
            )
        return checked_knots(given, closed)
    known = own[:, ~np.isnan(own).all(axis=0)]
    if not known.size:
        raise RsymError("all curves of a family are points", code="network", remedy="one or two of them may be")
    means = known.mean(axis=1)
    # 0.5 rather than 0.49999999999999994, where rounding leaves the choice.
    plain = np.round(means, 12)
    means = np.where(np.abs(plain - means) <= 1e-15 * (high - low), plain, means)
    for end in (low, high):
        means = np.where(np.abs(means - end) <= 1e-13 * (high - low), end, means)
    return checked_knots([*means, means[0] + (high - low)] if closed else means, closed)


def _fits(knots: tuple[float, ...], domain: tuple[float, float], closed: bool) -> bool:
    """Whether curves need no other parameters for these knots: they lie inside, or are a whole turn."""
    if closed:
        return math.isclose(knots[-1] - knots[0], domain[1] - domain[0], rel_tol=1e-15)
    return domain[0] <= knots[0] and knots[-1] <= domain[1]


def _network(
    families: tuple[Stack, Stack],
    knots: tuple[tuple[float, ...], tuple[float, ...]],
    closed: tuple[bool, bool],
    own: tuple[Floats | None, Floats | None],
    tolerance: float,
) -> Network:
    """The network of curves cut to the grid, each brought to its parameters from its own ones where they differ."""
    placed = []
    for one, at, ends, parameters in zip(families, knots, closed, own, strict=True):
        columns = [None] * len(one.curves) if parameters is None else list(parameters.T)
        pairs = zip(one.curves, columns, strict=True)
        placed.append(Stack([_placed(curve, at, column, ends) for curve, column in pairs]))
    return Network(placed[0], placed[1], knots[0], knots[1], closed, tolerance)


def _placed(curve: Univariate, knots: tuple[float, ...], own: Floats | None, closed: bool) -> Univariate:
    interval, (low, high) = (knots[0], knots[-1]), curve.domain
    grid = np.array(knots[: len(knots) - closed])
    if own is not None and np.isnan(own).any():
        return Part(on_interval(curve, *interval), interval, closed=closed)
    same = own is None or (_fits(knots, curve.domain, closed) and np.abs(own - grid).max() <= 1e-15 * (high - low))
    if own is None or same:
        return curve if (interval, closed) == (curve.domain, curve.closed) else Part(curve, interval, closed=closed)
    if closed:
        return Composed(
            curve, increasing(np.array(knots), np.append(own, own[0] + high - low), closed=True), closed=True
        )
    return Composed(curve, increasing(grid, own))


def _at_knots(curves: Stack, knots: tuple[float, ...], count: int) -> Sampled:
    return Sampled(curves, knots[:count], (0,) * count)


def _unfit(name: str) -> RsymError:
    return RsymError(
        f"the {name}_knots lie outside the interval of the {name}-curves",
        code="network",
        remedy='reparametrise="auto" brings all curves to these knots',
    )


def _incompatible(gaps: Floats, own: tuple[Floats, Floats], knots: Sequence[tuple[float, ...]]) -> RsymError:
    i, j = (int(k) for k in np.unravel_index(int(gaps.argmax()), gaps.shape))
    return RsymError(
        f"the u-curve {j} and the v-curve {i} meet at u = {own[0][i, j]:.6g}, v = {own[1][i, j]:.6g}, the others of "
        f"their families on the average at u = {knots[0][i]:.6g}, v = {knots[1][j]:.6g}; there these two are "
        f"{gaps[i, j]:.4g} apart, and one of them would be missed",
        code="network",
        where=f"the pair (v-curve {i}, u-curve {j})",
        remedy='reparametrise="auto" brings all curves to common parameters',
    )
