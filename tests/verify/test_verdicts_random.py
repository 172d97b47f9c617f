"""Verdicts on random shapes of known smoothness: no planted defect is certified, no regular boundary refuted."""

import math

import numpy as np
import pytest
from oracles.closeness import assert_close
from oracles.planted import Field, largest_curvature, planted, regular
from oracles.tiers import some

import rsym
from rsym.verify.plane import Question

SEEDS = 50


@pytest.mark.random
@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_planted_defect_is_not_certified_and_what_is_proved_of_it_is_true(seed):
    case = planted(seed)
    report = rsym.verify_smoothness(case.shape, budget=3000)
    if case.kind == "third":
        assert report.verdict in {"CERTIFIED", "UNDECIDED"}
        return
    assert report.verdict in {"REFUTED", "UNDECIDED"}
    for joint in report.defects:
        if joint.proved:
            place, size = min(case.places, key=lambda known: math.dist(known[0], joint.point))
            assert joint.kind == case.kind
            assert_close(joint.point, place, atol=1e-9)
            assert_close(joint.tangent_jump if joint.kind == "corner" else joint.curvature_jump, size, atol=1e-9)


@pytest.fixture(scope="module")
def verdicts():
    """Reports of regular shapes; the bound of the curvature is as the cover gives it, not sharpened, to save time."""
    cases = [regular(seed, leaves=2, reach=0.5) for seed in some(range(SEEDS), 3)]
    return [(case, Question(case.shape).report(None, budget=4000)) for case in cases]


@pytest.mark.slow
def test_no_regular_boundary_is_refuted_and_few_are_undecided(verdicts):
    found = [report.verdict for _, report in verdicts]
    assert set(found) <= {"CERTIFIED", "UNDECIDED"}
    assert found.count("UNDECIDED") <= max(1, 0.05 * len(found))


def test_no_sampled_curvature_exceeds_the_bound(verdicts):
    for case, report in verdicts:
        assert case.curvature <= 1.0001 * report.curvature_bound + 1e-6
    sharp = regular(3, leaves=2, reach=0.5)
    assert rsym.verify_smoothness(sharp.shape).curvature_bound < 1.2 * sharp.curvature


def test_the_oracle_sees_a_kink_and_a_double_point():
    kinked = _field(lambda u, v: 1 - u * u - v * v - np.abs(u), lambda u, v: u)
    assert largest_curvature(kinked, 1.25) is None
    assert largest_curvature(_field(lambda u, v: u * v), 1.25) is None
    assert_close(largest_curvature(_field(lambda u, v: 1 - u * u - v * v), 1.25), 1.0, rtol=1e-6)


def _field(value, *clearances):
    return Field(rsym.x, value, clearances)
