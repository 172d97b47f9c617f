"""What the source claims: the verdicts are found in the run, and they are those of the theory."""

import itertools
import math
import re

import matplotlib.pyplot
import numpy as np
import pytest
from oracles import reports
from oracles.closeness import assert_close

import rsym
from rsym.paper import claims
from rsym.paper.models import BODIES


@pytest.fixture(scope="module")
def found():
    """Every claim about Fig. 11, and about the first two bodies of Fig. 12."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(claims, "BODIES", BODIES[:2])
        yield claims.profiles(), claims.bodies(), claims.normalisations()
    matplotlib.pyplot.close("all")


def tip_and_turn(a1, a2, p1, p2=0.1):
    """Where the blend vanishes, and 180 degrees less the angle under which it does: by hand."""
    tip = min(np.roots([-1, a1 - a2, a1 * a2 - p1 * p2]).real)
    return tip, 180 - 2 * math.degrees(math.atan((a1 - a2 - 2 * tip) / p1))


@pytest.mark.slow
def test_the_table_says_what_the_theory_says(found):
    rows = [claim.row[2:] for claim in itertools.chain(*found[:2])]
    assert [verdict for verdict, _ in rows] == ["REFUTED"] + ["CERTIFIED"] * 4 + ["REFUTED"] * 2
    letters = [(8, 5.3, 40), *((a1, 5, p1) for a1, p1 in BODIES[:2])]
    for (_, text), (a1, a2, p1) in zip([rows[0], *rows[5:]], letters, strict=True):
        tip, turn = tip_and_turn(a1, a2, p1)
        assert_close(float(re.search(r"\((-[\d.]+),", text).group(1)), tip, atol=1e-9)
        assert_close(float(re.search(r"turn ([\d.]+)", text).group(1)), turn, atol=1e-8)
        assert text.endswith("°, proved")
    assert all(text.startswith("analytic, curvature at most ") for _, text in rows[1:5])


def test_the_verdicts_are_found_in_the_run(monkeypatch):
    monkeypatch.setattr(claims, "verify_smoothness", lambda *_, **__: reports.undecided_disc())
    assert {claim.row[2] for claim in [*claims.profiles(), *claims.bodies()]} == {"UNDECIDED"}


@pytest.mark.slow
def test_omega_n_is_normalised_to_order_1_and_no_further(found):
    rows = found[2]
    assert [row[2] for row in rows] == ["REFUTED", "UNDECIDED", "CERTIFIED", "REFUTED"]
    kernel = rsym.compile(rsym.paper.skeleton_body(), ("gradient_squared",))
    # At the right tip, where |grad omega| is greatest on the boundary.
    slope = math.sqrt(kernel(5.538102125054145, 0.0)["gradient_squared"])
    assert_close(float(re.search(r"found ([\d.]+)", rows[0][3]).group(1)), slope - 1, atol=1e-9)
    assert all("found 0 ± " in row[3] for row in rows[1:3])
    assert 0 < float(rows[2][3].split()[-2]) <= claims.TOLERANCE


@pytest.mark.slow
def test_the_claims_stand_on_the_page(found, tmp_path, monkeypatch):
    for name, part in zip(("profiles", "bodies", "normalisations"), found, strict=True):
        monkeypatch.setattr(claims, name, lambda part=part: part)
    (result,) = rsym.paper.reproduce(tmp_path, only=["claims"])
    assert result.path.stat().st_size > 40_000
    text = (tmp_path / "index.html").read_text()
    assert "<h2>What the source claims, and what holds</h2>" in text
    assert text.count("<td>REFUTED</td>") == 5
    assert text.count("<td>CERTIFIED</td>") == 5
    assert "144.811726903°" in text
