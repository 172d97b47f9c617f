"""The lint: what it finds in shapes with known faults, and that it finds nothing in sound ones."""

import json
import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from oracles.many_balls import many_balls

import rsym
import rsym.verify.lint.logic
from rsym import Letter, x, y, z
from rsym.verify.lint.zeros import Functions, functions_of

BOX = ((-2, 2), (-2, 2))
CUBE = ((-2, 2), (-2, 2), (-2, 2))
a, b, r, alpha, m, p = sp.symbols("a b r alpha m p", real=True)
disc = (1 - x**2 - y**2) / 2


def plane(expression, bounds=BOX, **letters):
    return rsym.Shape(expression, (x, y), letters=letters, bounds=bounds)


def space(expression, bounds=CUBE):
    return rsym.Shape(expression, (x, y, z), bounds=bounds)


def kinds(report):
    return [finding.kind for finding in report.findings]


def slab(lower, upper, coordinate):
    return (upper - coordinate) * (coordinate - lower) / (upper - lower)


def box(*sides):
    return rsym.conjunction(*(slab(*side, coordinate) for side, coordinate in zip(sides, (x, y, z), strict=False)))


# Where the car is not normalised, after the paper's formulas: part, definition, a point of the zero set, |grad|
# there. With (x, y, z) on the axes of an ellipse of half-axes p and q the gradient is 2/p or 2/q.
UNNORMALISED = {
    ("roof", "f1"): [(2 / 8, 2 / 4)],
    ("side windows", "fo1"): [(2 / 8, 2 / 4)],
    ("front and rear window", "fo2"): [(10**0.5, 10**0.5), (10**0.5, 10**0.5), (2.5, 2.5)],
    ("headlights", "fa1"): [(2 / 2, 2 / 0.5)],
    ("headlights", "fa2"): [(2 / 2, 2 / 0.5)],
    ("headlights", "fa3"): [(2 / 1.5, 2 / 0.5)],
    ("headlights", "fa4"): [(2 / 1.5, 2 / 0.5)],
}


@pytest.fixture(scope="module")
def car():
    return rsym.lint(rsym.paper.car())


@pytest.mark.slow
def test_the_leaves_of_the_car_that_are_not_normalised(car):
    found = {}
    for finding in car.of("not normalised"):
        (place,) = finding.places
        found.setdefault((place.part, place.definition), []).append(finding.range)
    assert found.keys() == UNNORMALISED.keys()
    for name, ranges in UNNORMALISED.items():
        assert sorted(found[name]) == [pytest.approx(range, rel=2e-3) for range in sorted(ranges)], name


def test_two_boxes_that_touch_have_a_zero_sheet():
    report = rsym.lint(plane(rsym.disjunction(box((-1, 0), (-1, 1)), box((0, 1), (-1, 1)))))
    assert kinds(report) == ["zero sheet"]
    assert report.findings[0].point[0] == pytest.approx(0, abs=1e-9)
    report = rsym.lint(space(box((-1, 0), (-1, 1), (-1, 1))) | space(box((0, 1), (-0.5, 1.5), (-1.2, 0.3))))
    assert kinds(report) == ["zero sheet"]
    across, along, up = report.findings[0].point
    assert across == pytest.approx(0, abs=1e-9)
    assert -0.5 < along < 1  # where both faces are, and nowhere else
    assert -1 < up < 0.3


@pytest.mark.random
@pytest.mark.parametrize(
    "other",
    [
        box((0, 1), (1, 2)),  # an edge in common
        box((-0.5, 1), (-0.5, 0.5)),  # overlapping
        box((0.1, 1), (-1.5, 0.5)),  # apart
        box((0, 1), (-1.9, -1.2)),  # on the same line, but apart
    ],
)
def test_other_boxes_have_none(other):
    assert rsym.lint(plane(rsym.disjunction(box((-1, 0), (-1, 1)), other))).clean


def expected(first, second, operation):
    """What the faces of two boxes have in common, by comparing the ends of their sides."""
    found = set()
    for k, ((low, high), (lower, upper)) in enumerate(zip(first, second, strict=True)):
        others = [(one, other) for j, (one, other) in enumerate(zip(first, second, strict=True)) if j != k]
        if all(max(one[0], other[0]) < min(one[1], other[1]) for one, other in others):
            same, opposite = low == lower or high == upper, low == upper or high == lower
            if operation == "difference":
                same, opposite = opposite, same
            found |= {"coincident faces"} if same else set()
            found |= {"zero sheet" if operation == "union" else "sheet without thickness"} if opposite else set()
    return found


OPERATIONS = {
    "union": rsym.disjunction,
    "intersection": rsym.conjunction,
    "difference": lambda f, g: rsym.conjunction(f, -g),
}


@pytest.mark.random
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("operation", OPERATIONS)
def test_common_faces_of_boxes_at_random(operation, dimension):
    generator, seen = random.Random(dimension), set()
    for _ in range(10 if dimension == 2 else 6):
        pair = [[sorted(generator.sample(range(5), 2)) for _ in range(dimension)] for _ in range(2)]
        expression = OPERATIONS[operation](*(box(*sides) for sides in pair))
        shape = rsym.Shape(expression, (x, y, z)[:dimension], bounds=((-0.5, 4.5),) * dimension)
        found = set(kinds(rsym.lint(shape)))
        assert found == expected(*pair, operation), pair
        seen |= found
    assert len(seen) == 2


def test_a_common_face_inside_another_operand_is_no_fault():
    halves = rsym.disjunction(box((-1, 0), (-1, 1)), box((0, 1), (-1, 1)))
    assert kinds(rsym.lint(plane(rsym.conjunction(halves, y - 0.5)))) == ["zero sheet"]
    assert rsym.lint(plane(rsym.disjunction(halves, (2.25 - x**2 - y**2) / 3))).clean
    assert rsym.lint(plane(rsym.conjunction(halves, x - 0.25))).clean


def test_a_sheet_of_zeros_survives_min_and_max_and_normalisation():
    pair = [box((-1, 0), (-1, 1)), box((0, 1), (-1, 1))]
    assert kinds(rsym.lint(plane(sp.Max(*pair)))) == ["zero sheet"]
    assert kinds(rsym.lint(rsym.normalise(plane(rsym.disjunction(*pair))))) == ["zero sheet"]
    assert kinds(rsym.lint(plane(-rsym.conjunction(*(-one for one in pair))))) == ["zero sheet"]


def test_sets_that_touch_have_no_thickness_in_common():
    assert kinds(rsym.lint(plane(rsym.conjunction(x, -x)))) == ["sheet without thickness"]
    assert kinds(rsym.lint(space(rsym.conjunction(box((-1, 0), (-1, 1), (-1, 1)), x)))) == ["sheet without thickness"]


@pytest.mark.random
@pytest.mark.parametrize("system", [rsym.R0, rsym.RAlpha(sp.Rational(1, 2)), rsym.Rp(4)])
@pytest.mark.parametrize("operation", [rsym.conjunction, rsym.disjunction])
def test_coincident_faces(operation, system):
    assert kinds(rsym.lint(plane(operation(disc, disc, system=system)))) == ["coincident faces"]
    report = rsym.lint(plane(operation(x, 3 * x, system=system)))
    assert kinds(report) == ["not normalised", "coincident faces"]
    assert report.findings[0].remedy == "divide by 3"
    assert report.findings[1].point[0] == pytest.approx(0, abs=1e-9)


def test_min_max_and_normalisation_bear_coincident_faces():
    assert rsym.lint(plane(rsym.conjunction(disc, disc, system=rsym.R1))).clean
    assert rsym.lint(plane(sp.Min(x, 1 - y, x))).clean
    assert rsym.lint(rsym.normalise(plane(rsym.conjunction(disc, disc)))).clean


def test_flush_boxes_are_told_in_space():
    shape = space(rsym.disjunction(box((-1, 0.5), (-1, 1), (-1, 1)), box((0, 1), (-1.5, 1.5), (-1.5, 1))))
    report = rsym.lint(shape)
    assert kinds(report) == ["coincident faces"]
    across, along, up = report.findings[0].point
    assert up == pytest.approx(1, abs=1e-9)
    assert 0 < across < 0.5
    assert -1 < along < 1


def test_surfaces_that_touch_along_a_curve_are_not_coincident():
    ball, tube = (1 - x**2 - y**2 - z**2) / 2, (1 - x**2 - y**2) / 2
    assert rsym.lint(space(rsym.conjunction(ball, tube))).clean
    assert rsym.lint(space(rsym.disjunction(ball, tube))).clean


def test_leaves_that_touch_to_high_order_are_not_coincident():
    assert "coincident faces" not in kinds(rsym.lint(plane(rsym.conjunction(x, x + y**6))))


def test_a_common_face_counts_where_it_makes_the_boundary():
    never = rsym.conjunction(rsym.conjunction(x, x), x - 3)  # negative within the bounds
    assert rsym.lint(plane(rsym.disjunction(never, rsym.conjunction(x, y)))).clean


def test_small_faces_in_generous_bounds():
    pair = rsym.box(1, 1, 1) | rsym.box(1, 1, 1, centre=(1, 0, 0))
    turned = pair.rotate(1, axis=(1, 2, 3)).translate(3, -4, 1)
    assert kinds(rsym.lint(turned, bounds=((-20, 20),) * 3)) == ["zero sheet"]


@pytest.mark.parametrize("power", [1, 3])
def test_slopes_and_their_remedies(power):
    (finding,) = rsym.lint(plane(disc**power)).findings if power > 1 else rsym.lint(plane(2 * disc)).findings
    assert finding.kind == "not normalised"
    if power > 1:
        assert "not its power" in finding.remedy
    else:
        assert finding.range == pytest.approx((2, 2), abs=1e-9)


def test_systems_that_do_not_keep_normalisation():
    (finding,) = rsym.lint(plane(rsym.conjunction(x, y, system=rsym.R0m(2)))).findings
    assert finding.kind == "not normalised"
    assert "R_0^m" in finding.message
    assert rsym.lint(rsym.normalise(plane(rsym.conjunction(x, y, system=rsym.R0m(2))))).clean


def test_a_blend_fills_a_seam_and_its_operands_are_leaves():
    assert rsym.lint(plane(rsym.disjunction(x, -x, system=rsym.Rho(0.2)))).clean
    (finding,) = rsym.lint(plane(rsym.conjunction(x, 3 * y, system=rsym.Rho(0.2)))).findings
    assert str(finding.places[0]) == "3*y"


def test_the_curves_of_a_joining_are_leaves():
    path = rsym.polyline([(0, 0), (1, 0), (1, 1)])
    assert rsym.lint(path).clean
    (finding,) = rsym.lint(plane(rsym.joining(rsym.trimming(2 * x, 1 - y**2), y))).findings
    assert str(finding.places[0]) == "2*x"


@pytest.mark.slow
def test_what_is_normalised_is_left_alone():
    ellipse = rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-2.5, 2.5), (-1.5, 1.5)))
    assert kinds(rsym.lint(ellipse)) == ["not normalised"]
    assert rsym.lint(rsym.normalise(ellipse)).clean
    assert rsym.lint(rsym.normalise(ellipse & plane(y))).clean  # the whole mends what its leaves lack
    assert rsym.lint(rsym.paper.valve()).clean
    assert rsym.lint(plane(rsym.trimming(y, 1 - x**2))).clean  # one-sided: it never changes its sign


def test_bounds_and_letters_are_those_asked_for():
    shape = rsym.Shape((r**2 - x**2 - y**2) / 2, (x, y), letters={r: Letter(1, minimum=1, maximum=9)}, bounds=BOX)
    (finding,) = rsym.lint(shape).findings
    assert "at these letters, but not at others" in finding.message
    (finding,) = rsym.lint(shape, letters={"r": 1.5}).findings
    assert finding.range == pytest.approx((1.5, 1.5), abs=1e-9)
    report = rsym.lint(shape, letters={"r": 9})
    assert report.clean  # no zero within the bounds
    assert "no regular zero" in str(report)
    assert report.letters == {"r": 9}
    assert kinds(rsym.lint(shape, letters={"r": 9}, bounds=((-10, 10), (-10, 10)))) == ["not normalised"]
    assert rsym.lint(rsym.Shape(disc, (x, y))).clean  # bounds are found


@pytest.mark.slow
def test_terms_that_saturate(car):
    large = ((-15, 15), (-15, 15))
    ball = plane(25 - x**2 - y**2, large)
    short, long = rsym.normalise(ball), rsym.normalise(ball, length=30)
    other = plane(y - 1, large)
    assert rsym.lint(short).clean  # alone it is what was asked for
    assert kinds(rsym.lint(short | other)) == ["saturates"]
    assert rsym.lint(long | other).clean
    found = rsym.lint(plane(short.expression + y / 2, large))
    assert kinds(found) == ["not normalised", "saturates"]
    assert kinds(rsym.lint(plane(rsym.conjunction(sp.tanh(x), y), large))) == ["saturates"]
    assert rsym.lint(plane(rsym.conjunction(slab(-1.9, 3, x), y))).clean  # high in two fifths, but not flat
    assert [finding.places[0].definition for finding in car.of("saturates")] == ["fb1", "fb2"]


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "letters", "place"),
    [
        ((r**2 - x**2 - y**2) / (2 * r), {"r": Letter(1)}, ["r"]),
        ((r**2 - x**2 - y**2) / (2 * r), {"r": Letter(1, minimum=0, maximum=1)}, ["r"]),
        ((r**2 - x**2 - y**2) / (2 * r), {"r": Letter(1, minimum=0.5)}, []),
        (slab(a, b, x), {"a": Letter(-1, minimum=-2, maximum=1), "b": Letter(1, minimum=0, maximum=2)}, ["a", "b"]),
        (slab(a, b, x), {"a": Letter(-1, minimum=-2, maximum=0), "b": Letter(1, minimum=0.1, maximum=2)}, []),
        ((a * x + b * y) / sp.sqrt(a**2 + b**2), {"a": Letter(1, minimum=0), "b": Letter(1, minimum=-1)}, ["a", "b"]),
        ((a * x + b * y) / sp.sqrt(a**2 + b**2), {"a": Letter(1, minimum=0.1), "b": Letter(1)}, []),
        (x - sp.sqrt(a), {"a": Letter(1, minimum=-1, maximum=2)}, ["a"]),
        (x - sp.sqrt(a), {"a": Letter(1, minimum=0, maximum=2)}, []),
        (x - sp.log(a), {"a": Letter(1, minimum=0, maximum=2)}, ["a"]),
        (x / (a - b), {"a": Letter(-1, minimum=-2, maximum=1), "b": Letter(1, minimum=0, maximum=2)}, ["a", "b"]),
        # fails where all three are at their ends, and only inside the square of both
        (x - sp.sqrt(5.99 - a - b - r), dict.fromkeys("abr", Letter(0.5, minimum=0, maximum=2)), ["a", "b", "r"]),
        (
            x - sp.log((a - 1) ** 2 + (b - 1) ** 2 - 0.1),
            {name: Letter(0, minimum=0, maximum=2) for name in "ab"},
            ["a", "b"],
        ),
        (rsym.conjunction(x, y, system=rsym.RAlpha(alpha)), {"alpha": Letter(0, minimum=-1, maximum=1)}, ["alpha"]),
        (rsym.conjunction(x, y, system=rsym.RAlpha(alpha)), {"alpha": Letter(0, minimum=-0.9, maximum=1)}, []),
        (rsym.conjunction(x, y, system=rsym.Rp(p)), {"p": Letter(4, minimum=1, maximum=8)}, ["p"]),
        (rsym.conjunction(x, y, system=rsym.Rp(p)), {"p": Letter(4, minimum=2, maximum=8)}, []),
        (rsym.equivalence(x, y, order=m), {"m": Letter(2.5, minimum=1, maximum=4)}, ["m"]),
    ],
)
def test_letters_out_of_range(expression, letters, place):
    report = rsym.lint(plane(expression, **letters))
    found = [[one.definition for one in finding.places] for finding in report.of("letter range")]
    assert found == ([place] if place else [])


def test_the_value_that_fails_is_named():
    given = {"a": Letter(3, minimum=2, maximum=5), "b": Letter(1, minimum=0, maximum=2.5)}
    (finding,) = rsym.lint(plane(x / (a - b) + x * (1 - 1 / (a - b)), **given)).of("letter range")
    assert "a - b must not be zero" in finding.message
    values = dict(word.split(" = ") for word in finding.message.split("from ")[1].split(" on,")[0].split(" and "))
    assert float(values["a"]) == pytest.approx(float(values["b"]), abs=1e-2)
    (finding,) = rsym.lint(plane(x / (a - 3) - 2 * x / 3, a=Letter(3, minimum=2, maximum=5))).of("letter range")
    assert "which are the values given" in finding.message


def test_omega_that_is_undefined_at_an_end_of_a_range():
    (finding,) = rsym.lint(plane(y - sp.sqrt(a - x), a=Letter(5, minimum=1, maximum=9))).of("letter range")
    assert "minimum 1 omega is undefined in 2" in finding.message  # for 1 < x < 2, a quarter
    assert finding.range == pytest.approx((0.25, 0.25), abs=0.05)


def test_a_shape_that_is_empty_at_an_end_of_a_range():
    given = {"r": Letter(1, minimum=0, maximum=2), "a": Letter(0, minimum=-1, maximum=9)}
    found = rsym.lint(plane(r - sp.sqrt((x - a) ** 2 + y**2), **given)).of("letter range")
    assert [(finding.places[0].definition, finding.message.split(" the")[0]) for finding in found] == [
        ("r", "at its minimum 0"),
        ("a", "at its maximum 9"),
    ]


def test_letters_inside_compositions():
    path = rsym.segment((0, 0), (r, 0), letters={r: Letter(1, minimum=0, maximum=2)})
    (finding,) = rsym.lint(path).of("letter range")
    assert "r = " in finding.message


@pytest.mark.slow
def test_reports_are_text_json_and_a_table(car):
    report = car
    record = json.loads(report.to_json())
    assert record["clean"] is False
    assert record["leaves"] == 31
    assert {finding["kind"] for finding in record["findings"]} == {"not normalised", "coincident faces", "saturates"}
    assert record["findings"][0]["places"][0]["definition"] == "f1"
    for finding in report.findings:
        assert finding.message in str(report)
        assert finding.remedy
    assert report._repr_html_().count("<tr>") == len(report.findings) + 1
    assert str(rsym.lint(plane(x))) == "Clean: no finding in 1 leaf."


def test_refusals():
    for given, code in (((disc,), "shape"), ((rsym.Shape(x, (x, y)),), "unbounded")):
        with pytest.raises(rsym.RsymError) as caught:
            rsym.lint(*given)
        assert caught.value.code == code
    with pytest.raises(rsym.RsymError):
        rsym.lint(plane(x), tolerance=0)
    with pytest.raises(rsym.RsymError):
        rsym.lint(plane(x), letters={"q": 1})


def test_nests_of_hundreds():
    nest = x
    for number in range(300):
        nest = rsym.conjunction(y - number, -nest)
    logic = rsym.verify.lint.logic.logic_of(nest)
    assert len(logic.leaves) == 301
    assert len(logic.literals) == 301
    assert len(logic.gates) == 300


@pytest.mark.parametrize("dimension", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_many_functions_at_points_of_their_own_have_the_bits_of_one_kernel_of_all(dimension):
    shape, _, radii = many_balls(70, dimension)
    every = [*shape.expression.operands, sp.sin(3 * x) - y, shape.expression]
    functions = functions_of(shape, every)
    assert functions.own is not None
    generator = np.random.default_rng(2)
    which, points = generator.integers(len(every), size=500), generator.uniform(-1, 1, (500, dimension))
    value, slope = functions.of(which, points)
    expected, slopes = replace(functions, own=None).of(which, points)
    np.testing.assert_array_equal(value, expected)
    np.testing.assert_array_equal(slope, slopes)
    leaf = which < 70
    squares = (slope[leaf] ** 2).sum(axis=1) / 4 + value[leaf]  # a ball's gradient is twice the way to its centre
    assert np.abs(squares - (radii**2)[:, None]).min(axis=0).max() < 1e-14


@pytest.mark.slow
def test_a_fault_among_many_discs_is_found_and_not_all_of_them_are_asked_everywhere(monkeypatch):
    points = []
    plain = Functions.__call__
    monkeypatch.setattr(Functions, "__call__", lambda self, where: points.append(len(where)) or plain(self, where))
    _, centres, radii = many_balls(70, 2)
    discs = [
        plane((3 if k == 40 else 1) * (r**2 - (x - u) ** 2 - (y - v) ** 2) / (2 * r), ((-1.2, 1.2),) * 2)
        for k, ((u, v), r) in enumerate(zip(centres.tolist(), radii.tolist(), strict=True))
    ]
    (found,) = rsym.lint(rsym.disjunction(*discs)).findings
    assert found.range == pytest.approx((3, 3))
    off = np.linalg.norm(centres - found.point, axis=1) - radii
    assert np.abs(off).argmin() == 40
    assert sum(points) < 400_000


def test_what_is_undefined_has_no_sign():
    """A strip of discs cut where a root ends: no warning, and the findings of the discs."""
    discs = rsym.disjunction(*[sp.Rational(9, 25) - (x + i - 1) ** 2 - y**2 for i in range(5)])
    cut = rsym.conjunction(discs, sp.sqrt(x + 2) - sp.Rational(1, 3))
    assert rsym.lint(rsym.Shape(cut, (x, y), bounds=((-7, 7), (-7, 7)))).findings
