"""Cases in the plane."""

from __future__ import annotations

from random import Random

from opponent.germs_plane import GERMS
from opponent.judge import smoothness
from opponent.placing import placed
from opponent.truth import Case


def case(seed: int) -> Case:
    """The case of a seed; families take turns."""
    random = Random(f"opponent plane {seed}")
    germ = GERMS[seed % len(GERMS)](random)
    return placed(random, germ, 2)


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    return smoothness(case, 1500)
