"""Cases with a letter that ranges: CERTIFIED is for every value of it, REFUTED for one."""

from __future__ import annotations

from random import Random

import sympy as sp

from opponent.judge import smoothness
from opponent.kinks import SYSTEMS, ZERO, Q, kink
from opponent.placing import placed
from opponent.truth import Case, Germ, Spot, grade_of, u, v, w

A = sp.Symbol("a", real=True)
RANGES = (
    (Q(1, 2), Q(3, 4)),
    (Q(0), Q(1, 2)),
    (Q(-1, 4), Q(1, 4)),
    (Q(1, 2), Q(1, 2) + Q(1, 10**6)),
    (Q(0), Q(1, 10**30)),
    (Q(1, 10**6), Q(1, 100)),
    (Q(1, 3), Q(1, 3)),
)


def germ(random: Random, dimension: int) -> Germ:
    """The worst over the range decides: that of one value at least, for a word that is said of all."""
    low, high = random.choice(RANGES)
    k = random.choice([1, 2, 3])
    t, base = u, (v if dimension == 2 else w)
    f, *_ = kink(random, t, k)
    g, *_ = kink(random, t - A / 8, k)
    join = random.choice([random.choice(SYSTEMS).conjunction, random.choice(SYSTEMS).disjunction])
    always, once = grade_of(k - 1), grade_of(k - 1) if (low, high) != (0, 0) else "analytic"
    omega, grade = random.choice(
        [
            (base - A * f / 2 ** (k + 2), once),
            (base - g / 2 ** (k + 2), always),
            (base - (A - low) * f / 2 ** (k + 2), once if high > low else "analytic"),
            (join(base, base + (1 + A) * u**k / 2), always if k % 2 else "analytic"),
            ((base - A * u**2) * (2 + sp.Abs(u)), "analytic"),
            (base - A * u**2 / (1 + u**2), "analytic"),
            (base**2 - u**2 - (A - low), "broken"),
            (base**2 - u**2 - (A - low) - Q(1, 1000), "analytic"),
            (base - sp.sqrt(u**2 + A - low), "G0"),
            (base - sp.sqrt(u**2 + A - low + Q(1, 10**6)), "analytic"),
        ]
    )
    place = (ZERO,) * dimension
    spots = () if grade == "analytic" else (Spot(place, grade),)
    return Germ(
        f"{dimension}D letter", omega, spots, 0.3, loose=True, letters={A: (low + high) / 2}, ranges={"a": (low, high)}
    )


def case(seed: int) -> Case:
    """The case of a seed, every third in space; seen through a window that holds the origin well inside."""
    random = Random(f"opponent lettered {seed}")
    dimension = 3 if seed % 3 == 2 else 2
    while True:
        one = germ(random, dimension)
        found = placed(random, one, dimension)
        if not one.spots or (len(found.spots) == 1 and _roomy(found)):
            return found


def _roomy(case: Case) -> bool:
    """Whether the defect stays inside for every value."""
    for spot in case.spots:
        for c, (low, high) in zip(spot.point, case.shape.bounds, strict=True):
            if not low + 0.15 * case.length / 2 < float(c) < high - 0.15 * case.length / 2:
                return False
    return True


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    return smoothness(case, 1500 if case.shape.dimension == 2 else 4000)
