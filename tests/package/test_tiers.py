"""The two tiers of the suite: nothing is lost between them, and a battery rotates."""

import pytest

pytest_plugins = ["pytester"]
SUITE = """
import pytest

@pytest.mark.random
@pytest.mark.parametrize("seed", range(40))
def test_battery(seed):
    pass

@pytest.mark.random(6)
@pytest.mark.parametrize("seed", range(9))
def test_enough(seed):
    pass

@pytest.mark.slow
def test_slow():
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


def test_the_tiers_share_nothing_and_lose_nothing(collected):
    quick, rest, everything = collected("--seed", "7"), collected("--seed", "7", "--rest"), collected("--everything")
    assert len(everything) == 51
    other_days = {name for name in everything - quick - rest if name.startswith("test_enough")}
    assert quick | rest | other_days == everything
    assert not quick & rest
    assert len(quick) == 5
    assert "test_always" in quick
    assert "test_slow" in rest
    assert len(other_days) == 3


def test_a_battery_that_says_how_many_are_enough_comes_round(collected):
    of_days = [
        {name for name in collected("--seed", seed, "--rest") if name.startswith("test_enough")} for seed in "1234"
    ]
    assert {len(of_day) for of_day in of_days} == {4}
    assert len(set().union(*of_days)) == 9


def test_a_seed_repeats_and_another_rotates(collected):
    assert collected("--seed", "7") == collected("--seed", "7") != collected("--seed", "8")
