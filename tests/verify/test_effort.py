"""A limit of time, and telling how far an answer is: what comes back is proved, however early the time ends."""

from __future__ import annotations

import itertools
from contextlib import suppress

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.sampling import progress as module
from rsym.sampling.progress import Effort

c = sp.Symbol("c", real=True)
SQUARE, CUBE = ((-1.5, 1.6),) * 2, ((-1.5, 1.6), (-1.45, 1.5), (-1.4, 1.55))
BALL = 1 - x**2 - y**2 - z**2
PLANE = {
    "disc": 1 - x**2 - y**2,
    "corner": rsym.conjunction(x, y),
    "cusp": y**3 - x**5,
    "node": x**2 - y**2,
    "two corners": rsym.conjunction(1 - x**2 - y**2, y),
}
SPACE = {
    "ball": BALL,
    "half a ball": rsym.conjunction(BALL, z),
    "cube": rsym.conjunction(1 - x**2, 1 - y**2, 1 - z**2),
    "cone": z**2 - x**2 - y**2,
}
TIMES = (0, 1, 3, 10, 30, 90, 200, 500, 2000)
ENDED = "the time allowed ended before everything was looked at"


@pytest.fixture
def clock(monkeypatch):
    """A clock that goes on by a second whenever it is read."""
    ticks = itertools.count()
    monkeypatch.setattr(module, "monotonic", lambda: float(next(ticks)))


def shape_of(name):
    plane = name in PLANE
    return rsym.Shape((PLANE | SPACE)[name], (x, y) if plane else (x, y, z), bounds=SQUARE if plane else CUBE)


@pytest.mark.random
@pytest.mark.parametrize("name", [*PLANE, *SPACE])
def test_whenever_the_time_ends_what_is_said_is_true(clock, name):
    shape, method = shape_of(name), "auto" if name in PLANE else "space"
    whole = rsym.verify_smoothness(shape, method=method)
    assert (ENDED, False) not in whole.statements
    seen = set()
    for seconds in TIMES:
        report = rsym.verify_smoothness(shape, method=method, timeout=seconds)
        seen.add(report.verdict)
        assert report.verdict in {whole.verdict, "UNDECIDED"}
        cut = (ENDED, False) in report.statements
        assert cut or report.to_json() == whole.to_json()
        assert str(report)
    assert "UNDECIDED" in seen


def test_with_no_time_nothing_is_certified():
    for name in ("disc", "ball", "half a ball"):
        report = rsym.verify_smoothness(shape_of(name), method="auto" if name in PLANE else "space", timeout=0)
        assert report.verdict == "UNDECIDED"
        assert (ENDED, False) in report.statements
        assert len(report.cover.undecided)


@pytest.mark.slow
def test_letters_that_range_have_a_limit_too(clock):
    shape = rsym.Shape(c - x**2 - y**2 - z**2, (x, y, z), letters={c: 1}, bounds=CUBE)
    verdicts = {rsym.verify_smoothness(shape, letters={"c": (1, 2)}, method="space", timeout=t).verdict for t in TIMES}
    assert verdicts == {"CERTIFIED", "UNDECIDED"}


@pytest.mark.parametrize("name", ["disc", "corner", "ball", "half a ball"])
def test_a_budget_of_one_box(name):
    report = rsym.verify_smoothness(shape_of(name), method="auto" if name in PLANE else "space", budget=1)
    assert report.verdict == ("REFUTED" if name == "corner" else "UNDECIDED")  # the first box holds both sides


class Listener:
    """Takes down what it is told."""

    def __init__(self):
        self.stages, self.shares, self.counts = [], [], []

    def describe(self, stage, undecided):
        if stage not in self.stages:
            self.stages.append(stage)
        self.shares.append(undecided)

    def __call__(self, done, total):
        self.counts.append((done, total))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two corners", "cube"])
def test_progress_tells_the_stages_and_what_is_undecided(name):
    listener = Listener()
    rsym.verify_smoothness(shape_of(name), method="auto" if name in PLANE else "space", progress=listener)
    curves = [] if name in PLANE else ["curves"]
    assert listener.stages == ["boxes", *curves, "points", "curvatures"]
    done = [count for count, _ in listener.counts]
    assert done == sorted(done)
    assert listener.counts[-1] == (1000, 1000)
    known = [share for share in listener.shares if share == share]
    assert known[-1] == 0 <= min(known) <= max(known) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["two corners", "cube"])
def test_it_can_be_cancelled_in_every_stage(name):
    method = "auto" if name in PLANE else "space"
    for stage in ["boxes", "points", "curvatures"] + ["curves"] * (name in SPACE):

        class Refusing(Listener):
            def __call__(self, done, total, stage=stage):
                return self.stages[-1] != stage

        with pytest.raises(rsym.RsymError, match="cancelled"):
            rsym.verify_smoothness(shape_of(name), method=method, progress=Refusing())


def test_a_plain_function_is_a_progress():
    seen = []
    rsym.verify_smoothness(shape_of("disc"), progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (1000, 1000)


@pytest.mark.parametrize("wrong", [-1, float("nan"), "soon", True])
def test_times_that_are_none(wrong):
    with pytest.raises(rsym.RsymError, match="timeout"):
        Effort(timeout=wrong)


@pytest.mark.slow
def test_a_threshold_is_a_proved_bracket_whenever_the_time_ends(clock):
    body = rsym.paper.skeleton_body()
    ask = {"between": (5.3, 5.35), "tolerance": 1e-3}
    with pytest.raises(rsym.RsymError) as raised:
        rsym.smoothness_threshold(body, "a2", timeout=1, **ask)
    assert raised.value.code == "timeout"
    whole = rsym.smoothness_threshold(body, "a2", **ask)
    brackets = [rsym.smoothness_threshold(body, "a2", timeout=seconds, **ask) for seconds in (6_000, 12_000, 10**9)]
    assert all(one.refuted <= whole.refuted < 5 + 4 / 13 < whole.certified <= one.certified for one in brackets)


def test_an_atlas_repair_fairness_and_normalisation_end_in_time(clock):
    atlas = rsym.smoothness_atlas(
        rsym.paper.skeleton_body(), "a2", "p1", between=((5.2, 5.4), (39, 41)), timeout=1, sharpening=0
    )
    assert set(atlas.verdicts) == {"UNDECIDED"}
    corner = rsym.Shape(rsym.conjunction(x, y, 1 - x**2 - y**2), (x, y), bounds=((-0.5, 1.5), (-0.5, 1.5)))
    found = rsym.repair(corner, timeout=0)
    assert not found.candidates
    assert all("time" in one.reason for one in found.rejected)
    ellipse = rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
    with pytest.raises(rsym.RsymError, match="time allowed"):
        rsym.fairness(ellipse, timeout=0)
    normal = rsym.verify_normalisation(rsym.normalise(ellipse), resolution=32, tolerance=0.01, timeout=0)
    assert (normal.verdict, normal.statements[-1]) == ("UNDECIDED", (ENDED, False))


@pytest.mark.slow
def test_bounds_of_a_curvature_hold_whenever_the_time_ends(clock):
    ellipse = rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
    reports = []
    for seconds in range(100, 1_000, 150):
        with suppress(rsym.RsymError):
            reports.append(rsym.fairness(ellipse, timeout=seconds))
    assert all(report.curvatures[0].greatest.bound >= 2 for report in reports)
    assert any((ENDED, False) in report.statements for report in reports)


def test_the_command_line_has_a_limit_too(capsys):
    from rsym.cli import main

    assert main(["verify", "skeleton", "--timeout", "0"]) == 3
    assert ENDED in capsys.readouterr().out
