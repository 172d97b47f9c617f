"""The opponent: shapes whose truth is known by construction; of no verdict may anything be false.

A fixed seed and that of the run; `pytest --seed 738000 tests/verify/test_opponent.py` repeats those of another day.
Many more: `python tests/opponent/hunt.py plane --count 2000`.
"""

import importlib

import pytest
from opponent import natural
from opponent.mutations import AIMS, MUTATIONS, UNNOTICED, catcher
from oracles.tiers import SEED, some

import rsym

# How many of each kind for each of the two seeds, a quarter of a minute in all; every day others.
COUNTS = {"plane": 7, "space": 3, "turned": 4, "made": 3, "lettered": 3, "questions": 1}


@pytest.mark.random
@pytest.mark.parametrize("start", [0, 1000 * SEED], ids=["fixed", f"seed {SEED}"])
@pytest.mark.parametrize("kind", COUNTS)
def test_nothing_false_is_said(kind, start):
    family = importlib.import_module(f"opponent.{kind}")
    found = []
    for seed in some(range(start, start + COUNTS[kind])):
        case = family.case(seed)
        _, wrong = family.asked(case)
        found.extend(f"hunt.py {kind} --start {seed} --count 1 ({case.family}): {line}\n{case}" for line in wrong)
    assert not found, "\n".join(found)


def test_what_is_not_noticed_has_a_reason():
    names = [one.name for one in MUTATIONS]
    assert len(set(names)) == len(names)
    assert set(UNNOTICED) < set(names)
    assert all(UNNOTICED.values())
    assert all(AIMS[name] for name in set(names) - set(UNNOTICED))


@pytest.mark.random
@pytest.mark.parametrize("mutation", [one for one in MUTATIONS if one.name not in UNNOTICED], ids=lambda one: one.name)
def test_a_proof_obligation_that_is_dropped_is_noticed(mutation):
    """Red proofs: without the step something false is said of a shape that is aimed at it."""
    assert catcher(mutation) is not None


@pytest.mark.random
@pytest.mark.parametrize("name", natural.QUICK)
def test_natural_bodies_are_decided(name):
    """Some of those that `python tests/opponent/natural.py` asks for all."""
    make, grade = natural.BODIES[name]
    report = rsym.verify_smoothness(make())
    assert report.verdict != "UNDECIDED"
    assert not natural.falsehoods(report, grade)
