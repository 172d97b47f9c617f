"""Reports say how the form, corners and values on the boundary were treated."""

import pytest
import sympy as sp

import rsym
from rsym import x, y

HEAT = "-laplacian(u) = 0"
SQUARE = (
    rsym.Shape(x, (x, y)).named("left")
    & rsym.Shape(1 - x, (x, y)).named("right")
    & rsym.Shape(y, (x, y)).named("bottom")
    & rsym.Shape(1 - y, (x, y)).named("top")
)
RING = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
RIGHT = rsym.half_plane((1, 0), 0)
HALVES = (rsym.disc(1) & RIGHT) | (rsym.disc(1) & rsym.half_plane((-1, 0), 0))
ANEW = "The formula was written anew, as one that is zero on the boundary alone."
NORMALISED = "Between 2 groups of parts that do not meet values go by normalised weights."
CASES = {
    "one value": (rsym.disc(1), x, []),
    "a pole": (
        rsym.disc(1),
        x / (x**2 + y**2),
        ["Values on the rest are kept to the boundary: their formulas are rough inside."],
    ),
    "jumps": (
        SQUARE,
        {"left": 0, ...: 1},
        ["Values jump at 2 corners: near to it they go as the angle between its edges."],
    ),
    "pairs": (
        SQUARE,
        {"left": y, "bottom": x, "right": 1, "top": 1},
        ["Values of 4 sides that meet go inside by pairs."],
    ),
    "kinks": (
        SQUARE,
        {"left": 0, "bottom": sp.Abs(x - sp.Rational(1, 3)) - sp.Rational(1, 3)},
        [
            "Values of 2 sides that meet go inside by pairs.",
            "Of 1 of these pairs by shares of distances alone: there splines are less accurate.",
        ],
    ),
    "groups": (RING, {"rim": 1, "bore": x}, [NORMALISED]),
    "seams": (HALVES, 0, [ANEW]),
    "switches": (SQUARE, {"left": rsym.switched(y - 0.4, 0, rsym.neumann())}, ["Conditions change on 1 leaf."]),
}


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("name", CASES)
def test_reports_say_which_treatment_was_used(name):
    shape, given, lines = CASES[name]
    report = rsym.solve(shape, HEAT, given, cells=8).report
    assert list(report.treatments) == lines == report.document().data["treatments"]
    assert all(line in str(report) for line in lines)


def test_modes_shafts_and_bodies_say_so_too():
    assert rsym.modes(HALVES, 1, cells=6).modes[0].report.treatments == (ANEW,)
    assert rsym.torsion(HALVES, cells=6).solution.report.treatments == (ANEW,)
    held = {"bore": {"x": x, "y": 0}, "rim": rsym.fixed()}
    assert rsym.elasticity(RING, held, young=1, poisson=0.3, cells=10).report.treatments == (NORMALISED,)
