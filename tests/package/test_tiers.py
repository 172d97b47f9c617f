"""The tiers of the suite: they share nothing, whatever is slow is in the rest, and a battery rotates."""

import runpy
from unittest.mock import Mock

import pytest

pytest_plugins = ["pytester"]
SUITE = """
import pytest

@pytest.mark.random
@pytest.mark.parametrize("seed", range(40))
def test_battery(seed):
    pass

@pytest.mark.slow
@pytest.mark.parametrize("number", range(30))
def test_slow(number):
    pass

def test_always():
    pass
"""


@pytest.fixture
def collected(pytester, request):
    pytester.makeconftest((request.config.rootpath / "tests" / "conftest.py").read_text())
    pytester.makeini("[pytest]\nmarkers =\n    slow\n    random\n")
    pytester.makepyfile(SUITE)

    def collect(*options):
        result = pytester.runpytest_inprocess("--collect-only", "-q", "-p", "no:xdist", *options)
        return {line.partition("::")[2] for line in result.outlines if "::" in line}

    return collect


def test_the_tiers_share_nothing_and_lose_but_what_rotates(collected):
    quick, rest, everything = collected("--seed", "7"), collected("--seed", "7", "--rest"), collected("--everything")
    assert len(everything) == 71
    assert quick | rest < everything
    assert not quick & rest
    assert len(quick) == 3
    assert "test_always" in quick
    assert sum("test_battery" in name for name in rest) == 8


def test_three_days_run_what_is_slow_once(collected):
    days = [{name for name in collected("--rest", "--seed", str(seed)) if "slow" in name} for seed in (7, 8, 9)]
    assert sum(map(len, days)) == len(set.union(*days)) == 30
    assert all(days)


def test_a_seed_repeats_and_another_rotates(collected):
    assert collected("--seed", "7") == collected("--seed", "7") != collected("--seed", "8")


def test_every_item_has_its_day(request):
    tiers = runpy.run_path(str(request.config.rootpath / "tests" / "conftest.py"))["tiers"]
    items = [Mock(nodeid=f"test[{k}]", get_closest_marker={"random": k}.get) for k in range(40)]
    assert set().union(*(set(quick + rest) for quick, rest in (tiers(items, day) for day in range(60)))) == set(items)
