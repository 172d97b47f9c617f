"""How much is tried: a part that rotates with the seed in the quick tier, all of it with `--everything`."""

import os
import random

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))
EVERYTHING = os.environ.get("RSYM_TEST_TIER") != "quick"


def some(things, count=2):
    """All of them, or in the quick tier `count`, rotating with the seed."""
    things = list(things)
    return things if EVERYTHING else random.Random(f"{SEED} {len(things)}").sample(things, min(count, len(things)))


def of_the_day(things, count):
    """So many of them in every tier, in their order, rotating with the seed: of long batteries that are samples."""
    things = list(things)
    chosen = random.Random(f"{SEED} {len(things)}").sample(range(len(things)), min(count, len(things)))
    return [things[k] for k in sorted(chosen)]


def examples(count):
    """How many examples are tried: `count`, a tenth of them in the quick tier, and no fewer than five."""
    return count if EVERYTHING else max(5, count // 10)
