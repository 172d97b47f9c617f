"""Cases of bodies of revolution, judged by the meridian or by boxes in space."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from opponent.germs_turned import GERMS
from opponent.judge import smoothness
from opponent.placing import on_an_axis
from opponent.truth import Case


def case(seed: int) -> Case:
    """The case of a seed; families take turns."""
    random = Random(f"opponent turned {seed}")
    found = on_an_axis(random, GERMS[seed % len(GERMS)](random))
    return replace(found, options={**found.options, "method": random.choice(["auto", "auto", "space"])})


def asked(case: Case) -> tuple[str, list[str]]:
    """The verdict, and what is false in it."""
    return smoothness(case, 3000)
