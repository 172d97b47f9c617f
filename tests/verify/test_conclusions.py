"""The verdict by all combinations of evidence, against its definition; the order of places; the sentences."""

import math
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest

from rsym.verify.answers import conclusions
from rsym.verify.answers.conclusions import SENTENCES, Tally, badness, is_degenerate, sentences, verdict_from

KINDS = {"corner": "G0", "curvature jump": "G1", "smooth joint": "G2", "node": "broken", "unresolved": "unknown"}


def place(kind, continuity=None, proved=True, **more):
    given = {"tangent_jump": math.nan, "curvature_jump": math.nan, "point": (0.0, 0.0)} | more
    return SimpleNamespace(kind=kind, continuity=continuity or KINDS[kind], proved=proved, **given)


def by_definition(kinds, doubts, boxes, exists):
    """REFUTED: there is a curve or surface, not G2. DEGENERATE: there is none. CERTIFIED: nothing is in doubt."""
    if {"corner", "curvature jump"} & kinds:
        return "REFUTED"
    if "node" in kinds or "double" in boxes or exists is False:
        return "DEGENERATE"
    return "CERTIFIED" if exists and not doubts and not {"open", "leap"} & boxes else "UNDECIDED"


def powers(names):
    return [
        {name for name, chosen in zip(names, flags, strict=True) if chosen}
        for flags in product((0, 1), repeat=len(names))
    ]


def differing():
    wrong = 0
    kinds = ("corner", "curvature jump", "smooth joint", "node")
    for found, doubts in product(powers(kinds), powers(("corner", "unresolved"))):
        places = [*map(place, sorted(found)), *(place(kind, proved=False) for kind in sorted(doubts))]
        for boxes, exists in product(powers(("regular", "double", "leap", "open")), (True, False, None)):
            tally = Tally(dict.fromkeys(boxes, 3), math.inf, exists)
            wrong += verdict_from(tally, places) != by_definition(found, doubts, boxes, exists)
    return wrong


def test_the_verdict_is_the_strongest_word_that_the_evidence_bears():
    assert differing() == 0


def test_a_verdict_that_forgets_what_is_degenerate_is_seen(monkeypatch):
    """Red proof."""
    monkeypatch.setattr(conclusions, "is_degenerate", lambda place: False)
    assert differing() > 0


def test_a_tangency_is_degenerate_where_nothing_is_left_of_the_surface():
    assert is_degenerate(place("tangency", "broken"))
    assert not is_degenerate(place("tangency", "G0"))


def test_proved_places_come_first_and_of_these_the_worst():
    flat, steep = place("corner", tangent_jump=10.0), place("corner", tangent_jump=80.0)
    bent, doubt = place("curvature jump", curvature_jump=2.0), place("corner", proved=False)
    curve = place("edge", "G0", tangent_jump=40.0, points=np.zeros((4, 3)))
    assert sorted([doubt, bent, flat, curve, steep], key=badness) == [steep, curve, flat, bent, doubt]


@pytest.mark.parametrize("dimension", [2, 3])
def test_every_kind_of_box_has_its_sentence_and_only_open_ones_prove_nothing(dimension):
    kinds = [kind for kind in SENTENCES[dimension] if kind != "analytic"]
    for order, absent in ((math.inf, "regular"), (2.5, "analytic")):
        said = sentences(Tally(dict.fromkeys(kinds, 1), order, True), dimension)
        assert len(said) == len(kinds)
        assert [proved for _, proved in said] == [kind != "open" for kind in kinds]
        assert any("analytic" in text and "regular" in text for text, _ in said) == (absent == "regular")
        assert any("C^2" in text for text, _ in said) == (absent == "analytic")


def test_that_there_is_no_boundary_is_said_first():
    assert sentences(Tally({"regular": 2}, math.inf, False), 3) == [
        ("no point of the boundary lies within the bounds", True)
    ]
    (found,) = sentences(Tally({}, math.inf, None), 3, ranging=True)
    assert found == ("no point of the boundary was found within the bounds for every value of the letters", False)
