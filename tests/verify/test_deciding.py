"""Leaves with branches over many boxes at once: what is said of a box is what balls say of it alone."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.verify import bodies as verdict
from rsym.verify.boxes.joints import Meeting
from rsym.verify.boxes.local import Model
from rsym.verify.cover import deciding
from rsym.verify.cover.box_arrays import halves, listed
from rsym.verify.cover.deciding import MEETING, OPEN, REGULAR, UNKNOWN, Decider, Signs, signs_needed
from rsym.verify.cover.forming import formation
from rsym.verify.cover.images import Images
from rsym.verify.cover.surfaces import SheetInspector
from rsym.verify.smoothness import studied_in_space

BALL, NEAR = 1 - x**2 - y**2 - z**2, 1 - (x - sp.Rational(6, 5)) ** 2 - y**2 - z**2
LEAVES = {
    "kink": z - sp.Abs(x),
    "bend": z - x * sp.Abs(x),
    "tangent to its switch": z**2 - x + sp.Abs(x),
    "two switches": z - sp.Abs(x) - sp.Abs(y),
    "jump": z - (sp.sign(x) + sp.sign(x) ** 2) / 4,  # a choice of two sides is a gate
    "slope of a root": z - sp.Abs(x) * sp.sqrt(y + 1),
    "fillet": rsym.fillet(BALL / 2, NEAR / 2, sp.Rational(3, 10)),
    "G2 fillet": rsym.fillet(BALL / 2, NEAR / 2, sp.Rational(3, 10), "G2"),
    "sign": z - x * sp.sign(x),
    "larger": z - sp.Max(x, y, evaluate=False) / 3,
}


def images_of(expression: sp.Expr) -> Images:
    model = Model(rsym.Shape(expression, (x, y, z)), {})
    return Images(model, formation(model, lambda node: True), {})


def boxes_around(seed: int, count: int = 300) -> np.ndarray:
    generator = np.random.default_rng(seed)
    low = generator.uniform(-1.2, 1.2, (count, 3))
    width = generator.choice([0.3, 0.1, 0.02], (count, 1))
    return np.stack([low, low + width], axis=-1)


def seen(images: Images, leaf: int, boxes: np.ndarray, depth: int = 4) -> set[str]:
    """What balls see in boxes or, where that is nothing, in their parts."""
    found = [SheetInspector().inspect(images.model.over(box), leaf).kind for box in listed(boxes)]
    left = boxes[[kind == "open" for kind in found]]
    kinds = {kind for kind in found if kind != "open"}
    if not len(left):
        return kinds
    return kinds | (seen(images, leaf, halves(left), depth - 1) if depth else {"open"})


@pytest.mark.random
@pytest.mark.parametrize("name", LEAVES)
def test_no_more_is_decided_than_balls_decide(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deciding, "WORTH", 1)
    images = images_of(LEAVES[name])
    leaf = images.formed.leaves[-1]
    boxes = boxes_around(len(name))
    decided = Decider(images).decide(leaf, boxes)
    assert (decided.kinds != UNKNOWN).sum() > 10
    for box, kind in zip(listed(boxes), decided.kinds, strict=True):
        if kind == REGULAR or kind >= MEETING:  # balls do not see that the sheets do not meet in the box
            assert seen(images, leaf, np.array([box])) <= {"regular", "joined", "empty"}


@pytest.mark.parametrize("name", ["jump", "tangent to its switch", "two switches"])
def test_what_is_no_meeting_is_none(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """On boxes around the origin, where the jump is, the sheets are tangent to the plane, or two switches cross."""
    monkeypatch.setattr(deciding, "WORTH", 1)
    images = images_of(LEAVES[name])
    box = np.array([[(-0.1, 0.11), (-0.1, 0.11), (-0.1, 0.11)]])
    (kind,) = Decider(images).decide(images.formed.leaves[-1], box).kinds
    assert kind in {UNKNOWN, OPEN}


def test_two_sheets_lie_on_either_side_of_the_switch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deciding, "WORTH", 1)
    images = images_of(z - sp.Abs(x))
    box = np.array([[(-0.1, 0.11), (-0.1, 0.11), (-0.1, 0.11)]])
    (meeting,) = Decider(images).decide(images.model.root, box).meetings
    assert isinstance(meeting, Meeting)
    point = np.array([[(1.0, 1.0), (0.0, 0.0), (3.0, 3.0)]])
    values = [
        (images.value(arc.function, point)[0].item(), images.value(arc.side, point)[0].item()) for arc in meeting.arcs
    ]
    assert [(round(f, 9), round(side, 9)) for f, side in values] == [(2.0, 1.0), (4.0, -1.0)]


def test_a_sign_that_is_not_known_counts_as_none() -> None:
    model = Model(rsym.Shape(z - sp.Abs(x), (x, y, z)), {})
    (switch,) = signs_needed(model.builder, model.root)
    assert Signs(model, {}).sign(switch) == 0
    assert Signs(model, {switch: -1}).sign(switch) == -1
    assert Signs(model, {}).sign(model.builder.const(-3)) == -1


@pytest.mark.slow
def test_a_fillet_takes_few_balls(monkeypatch: pytest.MonkeyPatch) -> None:
    """It took 4 200 of them: more than are allowed here leave boxes undecided."""
    monkeypatch.setattr(verdict, "INSPECTIONS", 1_000)
    shape = rsym.Shape(LEAVES["fillet"], (x, y, z), bounds=((-1.5, 2.7), (-1.5, 1.5), (-1.5, 1.5)))
    report = verdict.report_body(studied_in_space(shape), sharpened=False)
    assert (report.verdict, report.continuity, len(report.curves)) == ("REFUTED", "G1", 2)
    assert not len(report.cover.undecided)


@pytest.mark.slow
@pytest.mark.parametrize("between", [z, z * x])
def test_a_value_of_its_own_on_the_switch_is_not_passed_over(between):
    """|x| - 1/2 off x = 0, and there z or 0: both sides agree on x = 0, the value between them is another one."""
    off = 1 - sp.sign(x) ** 2
    expression = abs(x) - sp.Rational(1, 2) + off * (sp.Rational(1, 2) + between)
    report = rsym.verify_smoothness(rsym.Shape(expression, (x, y, z), bounds=((-1, 1),) * 3), method="space")
    assert report.verdict == "DEGENERATE"
