"""What a boundary is at a point that is known exactly, proved in one of three ways.

By the arrangement of analytic sheets on small spheres, by second derivatives, or by the one-sided derivative of
omega along all rays.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from rsym.codegen.balls import arb, ctx
from rsym.verify.bodies.candidates import Place, across
from rsym.verify.bodies.contacts import Judgement, touching, without_gradient
from rsym.verify.bodies.corners import (
    PRECISE,
    describe,
    determinant,
    error,
    floats,
    largest_angle,
    numbered,
    outward,
    radius_of,
)
from rsym.verify.bodies.links import Link, link
from rsym.verify.bodies.rays import FINEST, Rays, exact_at, rays_at
from rsym.verify.bodies.report import SingularPoint
from rsym.verify.bodies.sheets import Sheets, sheets
from rsym.verify.bodies.tips import largest_turn
from rsym.verify.generators import generators
from rsym.verify.local import Local, Model
from rsym.verify.vanishing import Exact

Names: TypeAlias = Callable[[int], str]


def classify_place(model: Model, place: Place, names: Names | None = None) -> SingularPoint | None:
    """What the boundary is at a point that is known exactly, proved; None where nothing is, or where it is regular."""
    with ctx.workprec(PRECISE):
        known = exact_at(model, place.point, place.coordinates, place.zeros)
        found = sheets(known.local, model.root)
        smooth = found is not None and all(generators(known.local, leaf).analytic for leaf in found.leaves)
        at = model.on(place.point)
        around = None
        if found is not None and smooth and known.vanishes(*found.leaves):
            judgement = _of_sheets(known, at, found)
            if judgement is not None:
                return _point(place, judgement, called_of(found, names), arb(0))
            around = _arrangement(at, found)
        called = called_of(found, names) if found is not None else ()
        if found is not None and around is not None and around[1]:
            return _corner(place, at, found, around[0], called)
        if found is not None and smooth and len(found.leaves) < 3:
            return None
        rays, judgement = _blown_up(model, known, "corner" if smooth else "cone tip")
        if rays is None or judgement is None:
            return None
        if judgement.continuity == "broken":
            return _point(place, judgement, called, arb(math.nan))
        if found is not None and around is not None and around[0].edges:
            return _point(place, judgement, called, _jump(at, found, around[0]))
        turn, off = largest_turn(rays)
        return replace(_point(place, judgement, called, arb(0)), tangent_jump=turn, tangent_jump_error=off)


def _of_sheets(known: Exact, at: Local, found: Sheets) -> Judgement | None:
    """One leaf without a gradient, or two that touch."""
    model = at.model
    if len(found.leaves) == 1:
        (leaf,) = found.leaves
        return without_gradient(at, leaf) if known.vanishes(*model.gradient(leaf)) else None
    if len(found.leaves) == 2:
        f, g = found.leaves
        for k, slope in enumerate(at.gradient(f)):
            if not slope.contains(0) and known.vanishes(*across(model, f, g, k)):
                return touching(at, f, g, numbered(found))
    return None


def _arrangement(at: Local, found: Sheets) -> tuple[Link, bool] | None:
    """Three or more sheets, and whether the signs of all determinants of their gradients are proved."""
    if len(found.leaves) < 3:
        return None
    gradients = [at.gradient(leaf) for leaf in found.leaves]
    proved = True

    def orientation(i: int, j: int, k: int) -> int:
        nonlocal proved
        value = determinant([gradients[i], gradients[j], gradients[k]])
        proved = proved and not value.contains(0)
        return 1 if value > 0 else -1 if value < 0 else 0

    around = link(numbered(found), orientation, len(gradients))
    return None if around is None else (around, proved)


def _corner(place: Place, at: Local, found: Sheets, around: Link, called: tuple[str, ...]) -> SingularPoint | None:
    if not around.edges:
        return None
    reason = describe(around, f"{len(found.leaves)} analytic sheets meet")
    kind, continuity = ("corner", "G0") if around.is_disc else ("node", "broken")
    return _point(place, Judgement(kind, continuity, reason), called, _jump(at, found, around))


def _jump(at: Local, found: Sheets, around: Link) -> arb:
    return largest_angle(around, [outward(at, leaf, -1) for leaf in found.leaves])


def _blown_up(model: Model, known: Exact, kind: str) -> tuple[Rays | None, Judgement | None]:
    """What the one-sided derivative proves, from coarse cells of directions or from fine ones."""
    rays, judgement = rays_at(model, known), None
    if rays is not None:
        judgement = _of_rays(rays, kind)
        if judgement is None and (rays := rays_at(model, known, FINEST)) is not None:
            judgement = _of_rays(rays, kind)
    return rays, judgement


def _of_rays(rays: Rays, kind: str) -> Judgement | None:
    """What the one-sided derivative proves."""
    start = "the one-sided derivative of omega"
    if rays.signs.all() and len(set(rays.signs.tolist())) == 1:
        return Judgement("isolated point", "broken", f"{start} is zero in no direction")
    pieces = rays.components(1), rays.components(-1)
    if max(pieces) > 1:
        reason = f"small spheres see {pieces[0]} or more pieces of the inside and {pieces[1]} or more of the outside"
        return Judgement("node", "broken", reason)
    if rays.upward is not None and rays.is_bent:
        return Judgement(kind, "G0", f"a surface, as omega grows along one direction, but {start} has no tangent plane")
    return None


def _point(place: Place, judgement: Judgement, called: tuple[str, ...], jump: arb) -> SingularPoint:
    return SingularPoint(
        point=floats(place.point),
        radius=radius_of(place.point),
        kind=judgement.kind,
        continuity=judgement.continuity,
        names=called,
        tangent_jump=float(jump.mid()),
        tangent_jump_error=error(jump),
        proved=True,
        reason=judgement.reason,
    )


def called_of(found: Sheets, names: Names | None) -> tuple[str, ...]:
    """The names of the definitions that some sheets belong to."""
    return tuple(dict.fromkeys(map(names, found.origins))) if names else ()
