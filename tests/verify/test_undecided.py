"""A report that is undecided claims nothing of the whole boundary, in no form that it is given."""

from __future__ import annotations

import json
import math
from functools import partial

import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.verify.answers.report import CONTINUITIES, UNKNOWN, continuity_of

# Nothing resolves these within the boxes allowed.
PLANE = [sp.sin(1 / x) + y, y - abs(x) ** sp.sqrt(2)]


def undecided(report):
    assert report.verdict == "UNDECIDED"
    assert report.continuity == UNKNOWN
    assert json.loads(report.to_json())["continuity"] == UNKNOWN
    first = str(report).splitlines()[0]
    assert "is neither proved nor refuted" in first
    assert f"UNDECIDED, {UNKNOWN}" in repr(report)


@pytest.mark.parametrize("omega", PLANE)
def test_in_the_plane(omega):
    shape = rsym.Shape(omega, (x, y), bounds=((-2, 2), (-2, 2)))
    undecided(rsym.verify_smoothness(shape, budget=200))


def test_in_space():
    shape = rsym.Shape(1 - x**4 - y**4 - z**4 + sp.sin(5 * x * y * z) / 3, (x, y, z), bounds=((-2, 2),) * 3)
    undecided(rsym.verify_smoothness(shape, method="space", budget=50))


def test_what_is_known_is_the_least_of_its_parts():
    rank = CONTINUITIES.index
    assert continuity_of("CERTIFIED", [], math.inf) == "analytic"
    assert [continuity_of("CERTIFIED", [], order) for order in (3, 3.5, 4, 9)] == ["G2", "G3", "G3", "G3"]
    assert continuity_of("REFUTED", [rank("G0"), rank("G3")], math.inf) == "G0"
    assert continuity_of("REFUTED", [rank("analytic")], 1) == "G0"
    assert continuity_of("DEGENERATE", [], math.inf) == "broken"
    assert continuity_of("UNDECIDED", [rank("G3")], math.inf) == "unknown"


def test_what_is_refuted_beside_a_doubt_may_be_worse():
    corner = rsym.Shape(rsym.disjunction(1 - x**2 - y**2, 1 - (x - 1) ** 2 - y**2), (x, y), bounds=((-2, 3), (-2, 2)))
    sure = rsym.verify_smoothness(corner)
    assert "is not G2 but G0; this is proved" in str(sure)
    doubt = rsym.Shape(rsym.conjunction(corner.expression, 3 - x + sp.sin(1 / (y - sp.Rational(1, 9))) / 9), (x, y))
    report = rsym.verify_smoothness(doubt.replace(bounds=((-2, 3), (-2, 2))), budget=600)
    if report.verdict == "REFUTED" and len(report.undecided):
        assert "at best G0" in str(report)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("expression", "equation"),
    [
        (y - sp.sin(x) / x, "x = 0"),
        (y - x**2 * sp.log(abs(x)), "x = 0"),
        (y - (1 - sp.cos(x - 1)) / (x - 1) ** 3, "(x - 1)**3 = 0"),
        (1 - x**2 - y**2 + sp.sin(x * y) / (x - y / 2) / 50, "x - y/2 = 0"),
    ],
)
def test_where_omega_has_no_value_is_said(expression, equation):
    report = rsym.verify_smoothness(rsym.Shape(expression, (x, y), bounds=((-2, 2), (-2, 2))), budget=3000)
    assert report.verdict != "CERTIFIED"
    assert (f"omega has no value where {equation}", True) in report.statements


def test_a_denominator_without_zeros_is_no_hole():
    report = rsym.verify_smoothness(rsym.Shape(y - 1 / (x**2 + 1), (x, y), bounds=((-2, 2), (-2, 2))))
    assert report.verdict == "CERTIFIED"
    assert not any("no value" in sentence for sentence, _ in report.statements)


@pytest.mark.parametrize(
    ("system", "value"),
    [
        (rsym.Rp, 1),
        (rsym.RAlpha, 1.5),
        (rsym.R0m, -1),
        (rsym.Rho, -0.5),
        (lambda cosine: rsym.Rho(1, cosine=cosine), 1),
    ],
    ids=["p", "alpha", "m", "rho", "cosine"],
)
def test_nothing_is_proved_with_a_letter_for_which_an_operation_has_no_value(system, value):
    letter = sp.Symbol("a", real=True)
    square = rsym.conjunction(1 - x**2, 1 - y**2, system=system(letter))
    shape = rsym.Shape(square, (x, y), letters={letter: value}, bounds=((-2, 2), (-2, 2)))
    tall = rsym.extrude(shape, 0, 1)
    proofs = (rsym.verify_smoothness, rsym.extent, rsym.verify_normalisation, rsym.level_lines, rsym.measure, rsym.lint)
    meshes = [lambda body, how=how: rsym.mesh(body, 8, method=how) for how in ("sharp", "smooth")]
    cut = partial(rsym.level_lines, section={z: 0.5}, bounds=((-1, 1), (-1, 1)))
    for look, seen in [*((proof, shape) for proof in proofs), *((look, tall) for look in (*meshes, cut))]:
        with pytest.raises(rsym.RsymError, match=f"with a = {value}") as refused:
            look(seen)
        assert refused.value.code == "parameter"
    with pytest.raises(rsym.RsymError, match=f"with a = {value}"):
        rsym.level_lines(shape.with_letters({letter: 2 if value == 1 else 0.5}), letters={letter: value})


def test_of_a_range_that_ends_where_an_operation_has_no_value_the_end_is_named():
    letter = sp.Symbol("a", real=True)
    square = rsym.conjunction(1 - x**2, 1 - y**2, system=rsym.Rp(letter))
    shape = rsym.Shape(square, (x, y), letters={letter: 2}, bounds=((-2, 2), (-2, 2)))
    with pytest.raises(rsym.RsymError, match="out of its range, with a = 1"):
        rsym.verify_smoothness(shape, letters={letter: (1, 2)})


@pytest.mark.parametrize(
    ("omega", "missing"),
    [
        (
            y - abs(x) ** (sp.pi / 2),
            "near (0, 0): derivatives of omega have no bound where the base of its power",
        ),
        (
            y - x**2 * sp.log(abs(x)),
            ": derivatives of omega have no bound where what it takes the logarithm of",
        ),
        (y + sp.sin(1 / x), ": derivatives of omega have no bound where its denominator vanishes"),
        (rsym.conjunction(y, y + x * abs(x)), "near (0, 0): a leaf has other formulas across a switch"),
        (rsym.conjunction(1 - x**2 - y**2, 2 - y - sp.cos(x)), "+ 1 and a leaf may touch, as their gradients may be"),
    ],
    ids=["power", "logarithm", "denominator", "switch", "contact"],
)
def test_what_was_missing_is_said_with_its_place(omega, missing):
    report = rsym.verify_smoothness(rsym.Shape(omega, (x, y), bounds=((-2, 2), (-2, 2))), budget=300)
    assert report.verdict == "UNDECIDED"
    assert any(missing in sentence for sentence, proved in report.statements if not proved)
    assert missing in str(report)


def test_what_was_missing_in_space_is_said_with_its_place_and_names():
    roof, lid = rsym.Shape(sp.cos(x) - z, (x, y, z)).named("roof"), rsym.Shape(1 - z, (x, y, z)).named("lid")
    report = rsym.verify_smoothness(roof & lid, bounds=((-2, 2),) * 3, budget=5000)
    assert report.verdict == "UNDECIDED"
    assert "roof and lid may touch, as their gradients may be parallel" in str(report)


TINY = sp.Rational(1, 10**7)
BESIDE = (sp.Rational(3, 2), 0)


@pytest.mark.parametrize(
    ("part", "verdict"),
    [
        (rsym.disc(TINY, BESIDE), "CERTIFIED"),
        (rsym.disc(TINY, (sp.sqrt(2), sp.Rational(1, 3))), "CERTIFIED"),
        (rsym.rectangle(TINY, TINY, BESIDE), "REFUTED"),
        (rsym.disc(TINY, BESIDE) | rsym.disc(TINY, (sp.Rational(3, 2) + TINY, 0)), "REFUTED"),
        (rsym.disc(TINY, BESIDE) | rsym.disc(TINY, (sp.Rational(3, 2) + 2 * TINY, 0)), "DEGENERATE"),
        (rsym.Shape(-((x - sp.Rational(3, 2)) ** 2) - y**2, (x, y)), "DEGENERATE"),
    ],
    ids=["disc", "irrational", "square", "overlap", "touching", "point"],
)
def test_a_part_smaller_than_the_boxes_is_divided_until_it_is_seen(part, verdict):
    report = rsym.verify_smoothness(rsym.disc(1) | part, bounds=((-2, 2), (-2, 2)))
    assert report.verdict == verdict
    if verdict == "CERTIFIED":
        assert not len(report.undecided)


FOLDS = {
    "asin sin": (sp.asin(sp.sin(x)), 90.0),
    "acos cos": (sp.acos(sp.cos(x)), 90.0),
    "acos sin, turned": (sp.acos(sp.sin(x + 1)), 90.0),
    "asin cos at irrational places": (sp.asin(sp.cos(sp.sqrt(2) * x)), 2 * math.degrees(math.atan(math.sqrt(2)))),
    "sqrt(1 - cos)": (sp.sqrt(1 - sp.cos(x)), 2 * math.degrees(math.atan(math.sqrt(0.5)))),
    "sqrt(1 + sin)": (sp.sqrt(1 + sp.sin(x)), 2 * math.degrees(math.atan(math.sqrt(0.5)))),
    "sqrt(1 - cos**2)": (sp.sqrt(1 - sp.cos(x) ** 2), 90.0),
}


@pytest.mark.parametrize(("height", "turn"), FOLDS.values(), ids=list(FOLDS))
def test_a_fold_of_an_angle_is_a_corner(height, turn):
    report = rsym.verify_smoothness(rsym.Shape(y - height, (x, y), bounds=((-4, 5), (-4, 5))))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert report.defects[0].proved
    assert report.defects[0].tangent_jump == pytest.approx(turn, abs=1e-9)


@pytest.mark.parametrize(
    ("height", "continuity"),
    [
        (sp.asin(sp.Rational(99, 100) * sp.sin(x)), "analytic"),
        (sp.sqrt(sp.Rational(101, 100) - sp.cos(x)), "analytic"),
        (sp.sqrt(1 - sp.cos(x)) ** 3, "G2"),
        (sp.sqrt(1 - sp.cos(x)) ** 2, "analytic"),
    ],
)
def test_what_only_nearly_folds_is_smooth(height, continuity):
    report = rsym.verify_smoothness(rsym.Shape(y - height, (x, y), bounds=((-4, 5), (-4, 5))))
    assert (report.verdict, report.continuity) == ("CERTIFIED", continuity)


def test_a_root_of_a_valley_is_a_corner():
    report = rsym.verify_smoothness(rsym.Shape(y - sp.acos(1 - x**2 / 2), (x, y), bounds=((-1, 1), (-1, 1))))
    assert (report.verdict, report.defects[0].kind, report.defects[0].proved) == ("REFUTED", "corner", True)
    assert report.defects[0].tangent_jump == pytest.approx(90, abs=1e-9)


def test_a_root_that_is_defined_at_points_alone_stays_one():
    nowhere = rsym.Shape(y - sp.sqrt(sp.cos(x) - 1), (x, y), bounds=((-1, 1), (-1, 1)))
    assert rsym.verify_smoothness(nowhere, budget=300).verdict in ("UNDECIDED", "DEGENERATE")


def test_a_fold_in_space_is_an_edge():
    fold = rsym.Shape(z - sp.sqrt(1 - sp.cos(sp.sqrt(2) * x + y)), (x, y, z), bounds=((-2, 2),) * 3)
    report = rsym.verify_smoothness(fold)
    assert (report.verdict, report.curves[0].kind, report.curves[0].proved) == ("REFUTED", "edge", True)


LENGTH = x**2 + y**2


@pytest.mark.parametrize(
    "height",
    [
        LENGTH ** sp.Rational(3, 4),
        LENGTH ** sp.Rational(2, 3),
        LENGTH ** sp.Rational(3, 4) / 3 - x * y - x**2,
        sp.sin(LENGTH ** sp.Rational(3, 4)),
    ],
)
def test_powers_of_a_distance_between_one_and_two_bend_without_bound(height):
    report = rsym.verify_smoothness(rsym.Shape(y - height, (x, y), bounds=((-2, 2), (-2, 2))))
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    (defect,) = report.defects
    assert (defect.kind, defect.proved, defect.curvature_jump) == ("unbounded curvature", True, math.inf)
    assert defect.point == pytest.approx((0, 0), abs=1e-12)


@pytest.mark.parametrize(
    ("height", "verdicts"),
    [
        (LENGTH ** sp.Rational(5, 4), {"CERTIFIED"}),
        ((LENGTH + sp.Rational(1, 1000)) ** sp.Rational(3, 4), {"CERTIFIED"}),
        (LENGTH ** sp.Rational(3, 4) * x, {"CERTIFIED", "UNDECIDED"}),
        (LENGTH ** sp.Rational(3, 4) * (1 - sp.cos(x)), {"CERTIFIED", "UNDECIDED"}),
    ],
)
def test_a_power_that_is_smooth_or_has_a_factor_that_vanishes_is_not_refuted(height, verdicts):
    report = rsym.verify_smoothness(rsym.Shape(y - height, (x, y), bounds=((-1, 1), (-1, 1))))
    assert report.verdict in verdicts
