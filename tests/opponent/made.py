"""Cases made by mirrors, rows, fans, kaleidoscopes, prisms, sweeps and turning."""

from __future__ import annotations

from random import Random

from opponent.germs_made import PLANE_MADE, SPACE_MADE
from opponent.judge import smoothness
from opponent.placing import as_it_stands, placed
from opponent.truth import Case


def case(seed: int) -> Case:
    """The case of a seed; families take turns."""
    random = Random(f"opponent made {seed}")
    both = [*((make, 2) for make in PLANE_MADE), *((make, 3) for make in SPACE_MADE)]
    make, dimension = both[seed % len(both)]
    where = random.choice([placed, as_it_stands])
    return where(random, make(random), dimension)


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    return smoothness(case, 1500 if case.shape.dimension == 2 else 4000)
