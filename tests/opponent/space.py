"""Cases in space, judged by boxes in space unless the equation shows a meridian."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from opponent.germs_space import GERMS
from opponent.judge import smoothness
from opponent.placing import placed
from opponent.truth import Case


def case(seed: int) -> Case:
    """The case of a seed; families take turns."""
    random = Random(f"opponent space {seed}")
    germ = GERMS[seed % len(GERMS)](random)
    found = placed(random, germ, 3)
    return replace(found, options={**found.options, "method": "space"}) if random.random() < 0.5 else found


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    return smoothness(case, 4000)
