"""Outputs have the bits that were stored, or the numbers within what rounding may do: `stored` says of what.

A change that is meant is stored by `python tests/store.py`, which prints the names of what has changed.
"""

import json

import pytest
import sympy as sp
from store import STORE, made
from stored import items, models
from stored.record import compared

from rsym import Shape, x, y

STORED = json.loads(STORE.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "group", [*items.QUICK, *(pytest.param(group, marks=pytest.mark.slow) for group in items.SLOW)]
)
def test_outputs_are_those_that_are_stored(group):
    changed = compared(STORED.get(group, {}), made(items.GROUPS[group]))
    assert not changed, "\n".join([f"of {group} {len(changed)} have changed", *map(": ".join, changed.items())])


def test_what_is_stored_is_what_is_compared():
    assert list(STORED) == list(items.GROUPS)


def test_a_change_of_one_model_is_seen_there_alone(monkeypatch):
    """Its quartic coefficient grown by 2^-50."""
    bent = Shape(1 - (1 + sp.Rational(1, 2**50)) * x**4 - y**4 + x * y / 2, (x, y), bounds=models.SQUARE)
    monkeypatch.setitem(models.MODELS, "quartic", lambda: bent)
    for cached in (items.model, items.evaluated):
        cached.cache_clear()
    names = ("ellipse", "quartic", "quotients")
    group = {name: make for name, make in items.QUICK["kernels by numpy"].items() if name.partition(",")[0] in names}
    assert len(group) == 9
    stored = {name: STORED["kernels by numpy"][name] for name in group}
    assert list(compared(stored, made(group))) == ["quartic, value", "quartic, gradient", "quartic, six fields"]
    for cached in (items.model, items.evaluated):
        cached.cache_clear()
