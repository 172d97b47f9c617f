"""The verifier with one of its proof obligations dropped, and whether the opponent notices.

python tests/opponent/mutations.py [--only name]

A row names the function of rsym.verify that is replaced, and by what: the replacement gets the function as it is. It
is replaced wherever it was imported. What the opponent says is false of the verifier as it is does not count.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import functools
import importlib
import math
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import sympy as sp
from sympy import Abs, Max, Min, Piecewise, sqrt

from opponent import aimed
from opponent.aimed import (
    BALL,
    BEAK,
    DISC,
    FOLDED,
    HIDDEN,
    LEAP,
    LEFT_CUT,
    NO_SCREW,
    ROW,
    SLIVER,
    SPIRAL,
    WAIST,
    C,
    Q,
    r,
)
from rsym import conjunction, disjunction, x, y, z
from rsym.bounds.balls import arb
from rsym.model.powers import AbsolutePower
from rsym.verify.cover import bending


@dataclass(frozen=True)
class Mutation:
    """`place` is module:name of what is replaced, `made` makes the replacement of it."""

    name: str
    place: str
    made: Callable[[Any], Any]


def always(value: Any) -> Callable[[Any], Any]:
    """A function that says the same of everything."""
    return lambda _: lambda *arguments, **options: value


def property_of(value: Any) -> Callable[[Any], Any]:
    """A property that says the same of everything."""
    return lambda _: property(lambda self: value)


@contextlib.contextmanager
def dropped(mutation: Mutation) -> Iterator[None]:
    """The verifier with one obligation less."""
    module, _, path = mutation.place.partition(":")
    holder = importlib.import_module(f"rsym.verify.{module}" if not module.startswith("rsym") else module)
    *outer, name = path.split(".")
    for part in outer:
        holder = getattr(holder, part)
    original = holder.__dict__[name]
    replacement = mutation.made(original)
    for one in [holder] if outer else _holding(name, original):
        setattr(one, name, replacement)
    try:
        yield
    finally:  # a module that was loaded meanwhile has taken the replacement
        for one in [holder] if outer else _holding(name, replacement):
            setattr(one, name, original)


@contextlib.contextmanager
def roughly_bent() -> Iterator[None]:
    """Bounds of the curvatures of bodies as the boxes give them: true as they are, to tighten them is half the time."""
    kept = bending.BUDGET, bending.RANGING
    bending.BUDGET = bending.RANGING = 0
    try:
        yield
    finally:
        bending.BUDGET, bending.RANGING = kept


def _holding(name: str, value: Any) -> list[Any]:
    """The modules in which a name stands for something."""
    modules = [one for key, one in list(sys.modules.items()) if key.startswith("rsym.") and one is not None]
    return [one for one in modules if one.__dict__.get(name) is value]


# R-operations and their kin: analytic except where their first two arguments vanish together.
SMOOTH_OFF_CORNERS = (
    *("r0_conjunction", "r0_disjunction", "versine", "gap", "trimming", "normalised", "norm", "monomial"),
    *("r_alpha_conjunction", "r_alpha_disjunction", "r0m_conjunction", "r0m_disjunction", "r0m_partial"),
    *("rp_conjunction", "rp_disjunction", "rp_versine", "equivalence", "joining"),
)


def _analytic_for(*operations: str) -> Callable[[Any], Any]:
    def made(original: Any) -> Any:
        def changed(local: Any, number: int, clauses: Any) -> bool:
            return local.model.builder.nodes[number].operation in operations or original(local, number, clauses)

        return changed

    return made


def _lossy(original: Any) -> Any:
    """One box of four is lost."""
    return lambda model, box: original(model, box)[:-1]


def _step(original: Any) -> Any:
    def changed(difference: Any, structural: bool) -> str:
        word = original(difference, structural)
        return "equal" if word in ("zero", "open") else word

    return changed


def _exists(original: Any) -> Any:
    from rsym.verify.boxes.krawczyk import Zero

    def changed(values: Any, jacobian: Any, box: Any) -> Any:
        found = original(values, jacobian, box)
        return Zero(True, box) if found is None else found

    return changed


def _none_exists(original: Any) -> Any:
    from rsym.verify.boxes.krawczyk import Zero

    def changed(values: Any, jacobian: Any, box: Any) -> Any:
        found = original(values, jacobian, box)
        return Zero(False) if found is None else found

    return changed


def _proved(original: Any) -> Any:
    def changed(*arguments: Any, **options: Any) -> Any:
        found = original(*arguments, **options)
        return dataclasses.replace(found, proved=True)

    return changed


def _ones(original: Any) -> Any:
    """Everything that is asked of many boxes holds."""

    def changed(*arguments: Any, **options: Any) -> Any:
        return np.ones_like(np.asarray(original(*arguments, **options)), dtype=bool)

    return changed


def _analytic_slopes(original: Any) -> Any:
    def changed(self: Any, *arguments: Any, **options: Any) -> Any:
        low, high, flags = original(self, *arguments, **options)
        return low, high, np.full(np.shape(flags), np.inf)

    return changed


def _shrunk(original: Any) -> Any:
    """A third of what it was."""

    def changed(*arguments: Any, **options: Any) -> Any:
        found = original(*arguments, **options)
        return None if found is None else (found[0] / 3, *found[1:]) if isinstance(found, tuple) else found / 3

    return changed


def _truth(original: Any) -> Any:
    """True wherever it is False."""

    def changed(*arguments: Any, **options: Any) -> Any:
        original(*arguments, **options)
        return True

    return changed


def _signed(original: Any) -> Any:
    """Where a sign is not known, it is positive."""

    def changed(*arguments: Any, **options: Any) -> Any:
        return original(*arguments, **options) or 1

    return changed


def _inertia(original: Any) -> Any:
    """An eigenvalue that may be zero counts as positive."""
    return lambda matrix: original(matrix) or (1,) * len(matrix)


def _fourth(original: Any) -> Any:
    def changed(*arguments: Any) -> Any:
        found = original(*arguments)
        return None if found is None else dataclasses.replace(found, contact=4)

    return changed


def _ones_of_boxes(original: Any) -> Any:
    return lambda self, made, boxes: np.ones(len(boxes), bool)


def _a_cusp(original: Any) -> Any:
    from rsym.verify.points.contacts import Judgement

    return lambda *arguments: original(*arguments) or Judgement("cusp", "G0", "")


def _strictly_inside(original: Any) -> Any:
    """Small boxes on a mirror are left out."""

    def changed(self: Any, boxes: Any) -> Any:
        behind = (tuple(-part for part in normal) for normal in self.mirrors)
        touched = [original(dataclasses.replace(self, mirrors=(normal,)), boxes) for normal in behind]
        small = np.ptp(boxes, axis=2).max(axis=1) < 0.1
        return original(self, boxes) & ~(small & np.logical_or.reduce(touched))

    return changed


def _in_the_middle(original: Any) -> Any:
    """The cells of the middle of the bounds alone."""
    return lambda expression, names, bounds: original(expression, names, tuple((a / 99, b / 99) for a, b in bounds))


PLANE = (
    Mutation("kinks: all is analytic", "boxes.generators:Generators.analytic", property_of(True)),
    Mutation(
        "kinks: |u|, min, max, select, sign",
        "boxes.generators:_is_analytic_at",
        _analytic_for("abs", "min", "max", "select", "sign"),
    ),
    Mutation("kinks: roots", "boxes.generators:_is_analytic_at", _analytic_for("sqrt", "pow", "absolute_power")),
    Mutation("kinks: denominators", "boxes.generators:_is_analytic_at", _analytic_for("div")),
    Mutation("kinks: R-operations", "boxes.generators:_is_analytic_at", _analytic_for(*SMOOTH_OFF_CORNERS)),
    Mutation("domains: all is defined", "boxes.domains:is_defined", always(True)),
    Mutation("domains: every parameter is legal", "boxes.domains:is_legal", always(True)),
    Mutation("locus: every power keeps the sign", "boxes.locus:_keeps_sign", always(True)),
    Mutation("locus: u*|u|: all products share zeros", "boxes.polynomials:same_zeros", always(True)),
    Mutation("covering: a quarter of a box is lost", "cover.covering:halves", _lossy),
    Mutation("joints: arcs are transversal to their sides", "boxes.joints:is_transversal", always(True)),
    Mutation("joints: no jump where enclosures overlap", "boxes.joints:step_of", _step),
    Mutation("resolution: every switch is smooth across", "boxes.resolution:contact", always(math.inf)),
    Mutation("krawczyk: a zero exists where it is open", "boxes.krawczyk:unique_zero", _exists),
    Mutation("krawczyk: no zero where it is open", "boxes.krawczyk:unique_zero", _none_exists),
    Mutation("vanishing: both arcs end in one point", "boxes.vanishing:vanishes_with", always(True)),
    Mutation("arcs: all boxes are small", "cover.arcs:ArcInspector._is_small", always(True)),
    Mutation("arcs: the mean value form excludes zero", "cover.arcs:_centred_excludes_zero", always(True)),
    Mutation("arcs: curvature bound a third", "cover.arcs:curvature_bound", _shrunk),
    Mutation("plane: a third of the bound", "plane:sharpened_bound", _shrunk),
    Mutation("plane: there is always a boundary", "plane:has_boundary", always(True)),
    Mutation("points: limits are proofs", "points.plane:_probed", _proved),
    Mutation("points: none is looked at", "points.plane:classify_joints", always([])),
    Mutation(
        "newton: every branch is smooth",
        "points.newton_polygon:HalfBranch",
        lambda f: lambda swapped, sense, terms, smooth, above: f(swapped, sense, terms, True, above),
    ),
    Mutation(
        "newton: even factors do not count",
        "points.newton_polygon:_signed_parts",
        lambda f: lambda *a: None if f(*a) is None else (f(*a)[0], f(*a)[1].one),
    ),
    Mutation(
        "revolution: the axis is no place",
        "plane:_located",
        lambda f: lambda study: [j for j in f(study) if not study.model.body or j.point[1] > j.radius],
    ),
)
PLANE = (
    *PLANE,
    Mutation("borders: what is beside the bounds counts", "boxes.borders:is_within", always(True)),
    Mutation("cleaning: nothing is negative", "cleaning:_is_never_negative", always(True)),
    Mutation("cleaning: numbers decide equality", "cleaning:_are_equal", always(True)),
    Mutation("directions: every cone is crossed", "points.directions:_is_crossed", always(True)),
    Mutation(
        "directions: all signs agree", "points.directions:same_sign", lambda f: lambda local, known, number: number
    ),
    Mutation("directions: every part is a factor", "points.directions:_is_factor", always(True)),
)
SPACE = (
    Mutation("octree: every gradient is independent", "cover.independence:independent", _ones),
    Mutation("octree: two sheets are always apart", "cover.independence:apart", _ones),
    Mutation("octree: all slopes are analytic", "cover.images:Images.slopes", _analytic_slopes),
    Mutation("octree: conditions are not asked", "cover.images:conditions", always([])),
    Mutation(
        "octree: what is undefined is empty",
        "cover.images:Images.is_empty",
        lambda f: lambda self, boxes: np.ones(len(boxes), bool),
    ),
    Mutation("octree: a double sheet changes its sign", "cover.octree:Octree._changes_sign", _ones),
    Mutation("inspection: sheets are transversal", "cover.inspection:is_transversal", always(True)),
    Mutation("inspection: nothing is even", "rsym.logic.stripping:is_even", always(False)),
    Mutation("points: boxes left over are regular", "points.space:is_regular", always(True)),
    Mutation("roots: every root is even", "points.even_roots:is_even", always(True)),
    Mutation("contacts: an open eigenvalue is positive", "points.contacts:inertia", _inertia),
    Mutation("contacts: leaves touch once", "points.contacts:touch_once", always(True)),
    Mutation("rays: every tip is bent", "points.rays:Rays.is_bent", property_of(True)),
    Mutation("continuation: a curve is unique", "curves.continuation:ZeroCurve.is_unique", always(True)),
    Mutation("continuation: all is analytic", "curves.continuation:ZeroCurve.is_analytic", always(True)),
    Mutation("following: a tube covers", "curves.following:covers", always(True)),
    Mutation("components: two pieces are apart", "curves.components:_are_apart", always(True)),
    Mutation("forming: operands absorb one another", "cover.forming:_is_never_less", always(True)),
    Mutation("relations: polynomials are positive", "cover.forming:_is_positive", always(True)),
    Mutation("octree: what is left is forgotten", "cover.octree:Octree._leave", always(None)),
    Mutation("links: no link is cracked", "points.links:Link.cracked", property_of(False)),
    Mutation("links: every link is a disc", "points.links:Link.is_disc", property_of(True)),
    Mutation(
        "locus: what drops is defined", "boxes.locus:_sure_sign", lambda _: lambda local, number: local.sign(number)
    ),
)
NEWER = (
    Mutation("touching: every factor is positive", "boxes.touching:_sign", _signed),
    Mutation("touching: contacts are of the fourth order", "boxes.touching:_meeting", _fourth),
    Mutation("folds: every piece is regular", "cover.folds:Folds.regular", _ones_of_boxes),
    Mutation("classes: every power is smooth", "boxes.classes:_of_powers", always(4.0)),
    Mutation("classes: every difference vanishes", "boxes.classes:_vanishing", always(4.0)),
    Mutation("classes: no switch has a value of its own", "boxes.classes:_is_taken_from_one_side", always(True)),
    Mutation("resolution: no switch has a value of its own", "boxes.resolution:_thin", always(None)),
    Mutation("deciding: sheets keep away from their side", "cover.deciding:Decider._are_apart", _ones_of_boxes),
    Mutation("joints: omega is continuous everywhere", "boxes.joints:Meeting.continuous", property_of(True)),
    Mutation("cusps: what has no gradient is one", "points.cusps:cusp", _a_cusp),
    Mutation("breaks: what leaps is empty", "boxes.breaks:emptiness", always("empty")),
    Mutation("everywhere: sheets never meet", "everywhere:_never_meet", always(True)),
    Mutation("everywhere: there is always a boundary", "everywhere:exists_for_every_value", always(True)),
    Mutation("root classes: all is of the fourth order", "boxes.root_classes:root_order", always(4.0)),
    Mutation("root classes: all vanishes to the third order", "boxes.root_classes:_zero_order", always(3)),
    Mutation("root free: every conjugate is positive", "boxes.contact_relations:RootFree.sign", always(1)),
    Mutation("fibres: no value but the middle is tried", "fibres:_suspicious", always(())),
    Mutation("account: nothing is missing", "answers.account:missing", always([])),
)
NEWEST = (
    Mutation("kinks: the cut of an angle", "boxes.generators:_is_analytic_at", _analytic_for("atan2")),
    Mutation(
        "resolution: above and below a cut", "boxes.resolution:_angle", lambda f: lambda b, u, v, side: f(b, u, v, 1)
    ),
    Mutation("likeness: all reflections keep omega", "cover.likeness:Likeness.holds", always(True)),
    Mutation("repetition: mirrors are not looked at", "cover.repetition:Repetition.meets", _strictly_inside),
    Mutation("repetition: whatever has a sine turns", "cover.repetition:_turns", always(True)),
    Mutation("cells: a few are enough", "cells:within_cells", _in_the_middle),
    Mutation("edges: all arcs continue each other", "boxes.lifting:continues", always(True)),
    Mutation("edges: arcs meet at their ends alone", "boxes.lifting:across_of", always(arb(1))),
    Mutation("edges: every arc has a tangent", "boxes.lifting:is_regular", always(True)),
)
MUTATIONS = PLANE + SPACE + NEWER + NEWEST
# The shapes of `aimed` that are meant for each: the first of which something false is said is enough.
_CAPSULE = disjunction(conjunction(Q(1, 4) - x**2 - y**2, -z), Q(1, 4) - x**2 - y**2 - z**2)
_SLIT = z + Piecewise((0, x < 0), (0, x > 0), (Q(1, 10), True))
_MAX, _PLAIN = y - Max(x, 0) ** 3, y * (x**2 + y**2)
AIMS = {
    "kinks: all is analytic": (_MAX,),
    "kinks: |u|, min, max, select, sign": (_MAX,),
    "kinks: roots": (z - r, z - r**3, y - sqrt(x**2 + y**2) / 2),
    "kinks: denominators": (y - x**3 / Abs(x),),
    "kinks: R-operations": (z + conjunction(x, z) / 2,),
    "domains: all is defined": (DISC / sqrt(DISC**2 + sqrt(x)),),
    "domains: every parameter is legal": (),
    "locus: every power keeps the sign": (DISC / sqrt(DISC**2 + sqrt(x)), DISC**2),
    "locus: u*|u|: all products share zeros": (_PLAIN,),
    "covering: a quarter of a box is lost": (_PLAIN,),
    "joints: arcs are transversal to their sides": (conjunction(y, x**3 - y), disjunction(y, y + x**3)),
    "joints: no jump where enclosures overlap": (y - x**2 - Q(1, 10**90) * Abs(x - sqrt(2) / 2),),
    "resolution: every switch is smooth across": (_MAX,),
    "krawczyk: a zero exists where it is open": (disjunction(y, y + 1 - sp.cos(x)), x**2 - y**2 - Q(1, 10**30)),
    "krawczyk: no zero where it is open": (conjunction(sp.exp(x) * sp.cos(y) - 1, sp.exp(x) * sp.sin(y)),),
    "vanishing: both arcs end in one point": (
        Piecewise((y - sqrt(2) / 2, x > 0), (y - sqrt(2) / 2 - sp.exp(x**6) / 10**90, True)),
    ),
    "arcs: all boxes are small": (),
    "arcs: the mean value form excludes zero": (_PLAIN,),
    "arcs: curvature bound a third": (DISC, y - 3 * x**2),
    "plane: a third of the bound": (DISC, y - 3 * x**2),
    "plane: there is always a boundary": (DISC,),
    "points: limits are proofs": (disjunction(y, y + 1 - sp.cos(x) + Q(1, 10**30) * x),),
    "points: none is looked at": (y**2 - x**3,),
    "newton: every branch is smooth": (y**5 - x**7,),
    "newton: even factors do not count": (y * (y - x**2) ** 2,),
    "revolution: the axis is no place": (z - r,),
    "borders: what is beside the bounds counts": (
        conjunction(x, y + x / 3),
        conjunction(x - y / 3, y + x / 3 - x**2 / 8),
    ),
    "cleaning: nothing is negative": (y + x / 3 - sqrt(x**2 - 4 * x * y + 4 * y**2) / 4,),
    "cleaning: numbers decide equality": (2 + y - sqrt(x**2 + y**2),),
    "directions: every cone is crossed": ((y - Abs(x)) * (y - Abs(x) - 8 * x**2) * (y - Abs(x) + 8 * x**2),),
    "directions: all signs agree": (y + conjunction(x, y) / 2, 1 - sp.exp(-conjunction(x, y))),
    "directions: every part is a factor": (conjunction(x + y, y - x) * (x - y / 3),),
    "octree: every gradient is independent": (x**2 - y**2 - z**2, x * z),
    "octree: two sheets are always apart": (conjunction(x, z + y / 3), disjunction(z, z + x)),
    "octree: all slopes are analytic": (z - Abs(x) / 10, z - r),
    "octree: conditions are not asked": (z - Abs(x) / 10,),
    "octree: what is undefined is empty": (BALL * (2 + sqrt(x)), z - sqrt(x**2 + y**2 / 4), z - x * r),
    "octree: a double sheet changes its sign": (conjunction(BALL, disjunction(HIDDEN, -HIDDEN)),),
    "inspection: sheets are transversal": (disjunction(z, z + x**3), conjunction(z, x**3 - z)),
    "inspection: nothing is even": (z**2 * (1 + x**2), -(z**2)),
    "points: boxes left over are regular": (z - x * r, z - r, x**2 - y**2 - z**2),
    "roots: every root is even": (z - sp.sin(r), z - r**3),
    "contacts: an open eigenvalue is positive": (z**3 - x**2 - y**2,),
    "contacts: leaves touch once": (disjunction(z, z + x**2),),
    "rays: every tip is bent": (z - x * sp.sqrt(sp.sin(x) ** 2 + y**2),),
    "continuation: a curve is unique": (conjunction(x, z + y / 3),),
    "continuation: all is analytic": (conjunction(x, z + y / 3),),
    "following: a tube covers": (conjunction(x, z + y / 3),),
    "components: two pieces are apart": (conjunction(x, z + y / 3),),
    "forming: operands absorb one another": (conjunction(x, z + y / 3), disjunction(z, z + x)),
    "relations: polynomials are positive": (disjunction(z, z + x**2 - Q(1, 100)),),
    "octree: what is left is forgotten": (x * z, z - x * r, z - r),
    "links: no link is cracked": (conjunction(z, disjunction(conjunction(x, y), conjunction(-x, y))),),
    "links: every link is a disc": (disjunction(conjunction(x, y, z), conjunction(-x, -y, -z)),),
    "locus: what drops is defined": (BALL * (2 + sqrt(x)),),
    "touching: every factor is positive": (disjunction(z, z + x**3),),
    "touching: contacts are of the fourth order": (_CAPSULE,),
    "folds: every piece is regular": (Max(x, y) * Min(x, y) - z**2,),
    "classes: every power is smooth": (z - AbsolutePower(x, Q(3, 2)),),
    "classes: every difference vanishes": (z - Abs(x) * Abs(y) / 4,),
    "classes: no switch has a value of its own": (_SLIT,),
    "resolution: no switch has a value of its own": (_SLIT,),
    "deciding: sheets keep away from their side": (z - Abs(x) / 10,),
    "joints: omega is continuous everywhere": (y - (3 + x) * LEAP,),
    "cusps: what has no gradient is one": (z**4 - x**2 - y**2,),
    "breaks: what leaps is empty": (y - LEAP, y + LEAP.subs(x, x - Q(1, 3)) / 8),
    "everywhere: sheets never meet": (z - Max(x + C - Q(27, 10), 0) / 4,),
    "everywhere: there is always a boundary": (z - C,),
    "root classes: all is of the fourth order": (z - x * r,),
    "root classes: all vanishes to the third order": (z - x * r,),
    "root free: every conjugate is positive": (disjunction(r - Q(1, 2), Q(1, 4) - x**2 - 2 * y**2),),
    "fibres: no value but the middle is tried": (z - Max(x + C - Q(27, 10), 0) / 4,),
    "account: nothing is missing": (z - r,),
    "kinks: the cut of an angle": (FOLDED,),
    "resolution: above and below a cut": (SPIRAL,),
    "likeness: all reflections keep omega": (LEFT_CUT,),
    "repetition: mirrors are not looked at": (WAIST,),
    "repetition: whatever has a sine turns": (NO_SCREW,),
    "cells: a few are enough": (ROW,),
    "edges: all arcs continue each other": (conjunction(sqrt(x) - x / 3 - y, sqrt(x) - x / 3 + y),),
    "edges: arcs meet at their ends alone": (SLIVER,),
    "edges: every arc has a tangent": (BEAK,),
}


# Dropped alone these are not noticed. Of each: which step stands behind it, or why nothing here comes to it.
UNNOTICED = {
    "kinks: denominators": "a ball that is divided by one around 0 is the whole line, of which nothing follows",
    "domains: every parameter is legal": "an operation whose parameter is not legal has no value: it is pruned before",
    "joints: arcs are transversal to their sides": "Krawczyk's operator has the same determinant, and stays open",
    "krawczyk: no zero where it is open": "where arcs are transversal all over a box it is hardly ever open",
    "arcs: all boxes are small": "no obligation: what it delays is true of large boxes as well",
    "points: none is looked at": "no obligation: the boxes stay left over, so the verdict is UNDECIDED",
    "newton: even factors do not count": "a double curve leaves boxes all along it: no cluster around a point",
    "revolution: the axis is no place": "the account: what a box found and no list holds makes the report UNDECIDED",
    "account: nothing is missing": "it stands behind the others: nothing is lost unless one of them is dropped too",
    "cleaning: nothing is negative": "a root that loses thin sets leaves no boundary: DEGENERATE either way",
    "directions: all signs agree": "no obligation: omega itself serves as well, where its slopes say enough",
    "octree: a double sheet changes its sign": "mean value forms exclude what is never zero before that",
    "inspection: sheets are transversal": "their curve is followed by Krawczyk's operator, which asks again",
    "inspection: nothing is even": "the gradient of an even power vanishes with it, so no box with a zero is regular",
    "contacts: leaves touch once": "leaves that meet again within the smallest box of where they touch are not reached",
    "continuation: a curve is unique": "of one contact all curves of two sheets have one class: another adds nothing",
    "continuation: all is analytic": "sheets of a meeting are proved analytic on the grown box, which holds the curve",
    "following: a tube covers": "as with uniqueness: what is followed beyond the boxes is of the same contact",
    "edges: arcs meet at their ends alone": "a box that holds an edge and where its arcs meet again stays open anyway",
    "edges: every arc has a tangent": "an arc without one has no bound of its curvature: the box stays open",
    "fibres: no value but the middle is tried": "no obligation: without a fibre that refutes the verdict is UNDECIDED",
}


def aims_of(mutation: Mutation) -> list[Any]:
    """The cases that are aimed at an obligation."""
    wanted = AIMS[mutation.name]
    return [case for shape in wanted for case in aimed.cases() if case.shape.expression == shape]


def catcher(mutation: Mutation, everything: bool = False) -> str | None:
    """The first case of which something false is said that is not said without the mutation, and what."""
    with contextlib.nullcontext() if everything else roughly_bent():
        for case in aimed.cases() if everything else aims_of(mutation):
            with dropped(mutation):
                wrong = _asked(case)
            if wrong and not _rightly(case.family):
                return f"{case.family}: {wrong[0]}"
    return None


def _asked(case: Any) -> list[str]:
    """What is false; a crash is loud enough and says nothing false."""
    try:
        return aimed.asked(case)[1]
    except Exception:
        return []


@functools.cache
def _rightly(family: str) -> list[str]:
    """What is false of a case by the verifier as it is, asked once for all that are aimed at it."""
    (case,) = (one for one in aimed.cases() if one.family == family)
    return _asked(case)


def main() -> None:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="part of a name")
    parser.add_argument("--everything", action="store_true", help="try all shapes, not those that are aimed at it")
    given = parser.parse_args()
    for mutation in MUTATIONS:
        if given.only in mutation.name or given.only in mutation.place:
            begin = time.process_time()
            found = catcher(mutation, given.everything)
            told = found or f"NOT CAUGHT: {UNNOTICED.get(mutation.name, 'why is not known')}"
            print(f"{mutation.name:50} {time.process_time() - begin:5.1f} s  {told}"[:200], flush=True)


if __name__ == "__main__":
    main()
