"""Natural shapes of kinds that are hard to decide, put to the question: python tests/opponent/kinds.py.

The truth is a grade, derived by hand from how a shape is made; "broken" where its boundary is no manifold. Of each kind
it prints how many are decided, how many not and for which reason, and what is false.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import sympy as sp

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import rsym
from opponent.natural import falsehoods
from rsym import conjunction, disjunction, x, y, z

LIMIT = 20.0  # seconds for one shape
HALF, TINY = sp.Rational(1, 2), sp.Rational(1, 10**7)
ROOT = sp.sqrt(2)
ROUND, LENGTH = x**2 + y**2, sp.sqrt(x**2 + y**2)
SPHERICAL = ROUND + z**2
SIDE = (sp.Rational(3, 2), 0)


def plane(expression, reach=2):
    """A shape within a square."""
    return rsym.Shape(expression, (x, y), bounds=((-reach, reach),) * 2)


def body(expression, reach=2):
    """A body within a cube."""
    return rsym.Shape(expression, (x, y, z), bounds=((-reach, reach),) * 3)


def hull_of_discs(first, second, apart):
    """Of two discs on the x axis and the lines that touch both: they touch at irrational points."""
    s = sp.Rational(first - second) / apart  # x = first s at the first contact
    c = sp.sqrt(1 - s**2)
    lines = [first - s * x - sign * c * y for sign in (1, -1)]
    between = conjunction(*lines, x - first * s, apart + second * s - x)
    return disjunction(first**2 - ROUND, second**2 - (x - apart) ** 2 - y**2, between)


def capsule(direction, radius, half=1):
    """A cylinder about a line through the origin and two balls."""
    u = sp.Matrix(direction) / sp.sqrt(sum(d**2 for d in direction))
    along = sum(a * b for a, b in zip(u, (x, y, z), strict=True))
    balls = [radius**2 - sum((s - e * half * a) ** 2 for s, a in zip((x, y, z), u, strict=True)) for e in (1, -1)]
    return disjunction(conjunction(radius**2 - SPHERICAL + along**2, half - along, half + along), *balls)


def touched(graph, place):
    """A graph over x and its tangent line at an irrational place: the line is beneath."""
    return y - graph, y - graph.subs(x, place) - sp.diff(graph, x).subs(x, place) * (x - place)


PARABOLA, TANGENT = touched(x**2, ROOT / 3)
WAVE, WAVES_TANGENT = touched(-sp.cos(x), sp.S(1))
TUBE = HALF**2 * 2 - (LENGTH - 3) ** 2 - z**2
CONTACTS = {
    "stadium": (
        plane(disjunction(conjunction(2 - y**2, 1 - x**2), 2 - (x - 1) ** 2 - y**2, 2 - (x + 1) ** 2 - y**2), 3),
        "G1",
    ),
    "belt 1, 2": (plane(hull_of_discs(1, 2, 5), 8), "G1"),
    "belt 2, 1": (plane(hull_of_discs(2, 1, 4), 8), "G1"),
    "parabola and tangent": (plane(conjunction(PARABOLA, TANGENT)), "analytic"),
    "parabola or tangent": (plane(disjunction(PARABOLA, TANGENT)), "analytic"),
    "wave and tangent": (plane(conjunction(WAVE, WAVES_TANGENT), 1), None),
    "parabola, half a tangent": (plane(disjunction(PARABOLA, conjunction(TANGENT, ROOT / 3 - x))), "G1"),
    "disc in an ellipse": (plane(disjunction(1 - x**2 / 3 - y**2, 1 - ROUND), 3), "analytic"),
    "disc and a tangent": (plane(disjunction(1 - ROUND, x + y - ROOT)), "broken"),
    "capsule of radius sqrt(2)": (body(capsule((0, 0, 1), ROOT), 3), "G1"),
    "capsule along (1, 1, 0)": (body(capsule((1, 1, 0), 1), 3), "G1"),
    "capsule along (1, 2, 3)": (body(capsule((1, 2, 3), 1), 3), "G1"),
    "ball in a tube": (
        body(disjunction(TUBE, HALF - (x - 3 * ROOT / 2) ** 2 - (y - 3 * ROOT / 2) ** 2 - z**2), 5),
        "analytic",
    ),
    "ring on a plate": (body(disjunction(TUBE, -z - ROOT / 2), 5), "broken"),
    "ring in a slab": (body(conjunction(TUBE, HALF - z**2), 5), "analytic"),
    "ball in a cylinder": (body(disjunction(conjunction(2 - ROUND, 4 - z**2), 2 - SPHERICAL), 3), "G0"),
    "ball and cylinder": (body(conjunction(2 - ROUND, 2 - SPHERICAL)), "analytic"),
    "ball in a cone": (body(disjunction(conjunction(z - LENGTH, HALF - z), HALF - ROUND - (z - 1) ** 2)), "G0"),
    "ice-cream": (
        body(disjunction(conjunction(z + 1 - ROOT * LENGTH, -sp.Rational(1, 3) - z), sp.Rational(1, 3) - SPHERICAL)),
        "G0",
    ),
    "ball in a paraboloid": (
        body(disjunction(z - ROUND, ROOT - sp.Rational(1, 4) - ROUND - (z - ROOT) ** 2), 2),
        "analytic",
    ),
    "roof and lid": (body(conjunction(sp.cos(x) - z, 1 - z), 1), "analytic"),
    "roof or lid": (body(disjunction(sp.cos(x) - z, 1 - z), 1), "analytic"),
}
FOLDS = {
    f"{height}": (rsym.Shape(y - height, (x, y), bounds=((-4, 5), (-4, 5))), grade)
    for height, grade in [
        (sp.asin(sp.sin(x)), "G0"),
        (sp.acos(sp.cos(x)), "G0"),
        (sp.acos(sp.sin(x + 1)), "G0"),
        (sp.asin(sp.cos(ROOT * x)), "G0"),
        (sp.sqrt(1 - sp.cos(x)), "G0"),
        (sp.sqrt(1 + sp.sin(x)), "G0"),
        (sp.sqrt(1 - sp.cos(x)) ** 3, "G2"),
        (sp.asin(99 * sp.sin(x) / 100), "analytic"),
    ]
} | {
    "acos dome": (plane(y - sp.acos(x / 2), 4), "broken"),
    "asin in space": (body(z - sp.asin(sp.sin(x + y / 3)), 3), "G0"),
    "roof sqrt(1 - cos)": (body(z - sp.sqrt(1 - sp.cos(ROOT * x + y))), "G0"),
}
PROFILES = {
    f"{height}": (plane(y - height), "analytic")
    for height in (
        sp.tanh(x),
        sp.tanh(10 * x),
        sp.tanh(100 * x),
        sp.tanh(1000 * x),
        sp.tanh(10**6 * x),
        1 / (1 + sp.exp(-x)),
        1 / (1 + sp.exp(-50 * x)),
        1 / (1 + sp.exp(-1000 * (x - sp.Rational(1, 3)))),
        sp.erf(1000 * x),
        sp.atan(1000 * x),
        sp.tanh(1000 * (x - 1)) - sp.tanh(1000 * (x + 1)),
    )
} | {
    "vase": (body(sp.Rational(3, 2) + sp.tanh(5 * z) / 2 - LENGTH, 3), "analytic"),
    "steep vase": (body(sp.Rational(3, 2) + sp.tanh(200 * z) / 2 - LENGTH, 3), "analytic"),
    "step in space": (body(z - sp.tanh(30 * (x + y)) / 2), "analytic"),
    "steep step in space": (body(z - sp.tanh(1000 * x) / 2), "analytic"),
    "tanh of a ball": (body(sp.tanh(1000 * (1 - SPHERICAL))), "analytic"),
    "tanh of a disc": (plane(sp.tanh(1000 * (1 - ROUND))), "analytic"),
}
DISC = 1 - ROUND
WRITTEN_TWICE = {
    f"{first} | {second} by {condition}": (plane(sp.Piecewise((first, condition), (second, True))), "analytic")
    for first, second, condition in [
        (DISC, 2 * DISC, x > 0),
        (DISC, 1 - LENGTH, x > 0),
        (1 - LENGTH, DISC / 2, y > x),
        (1 - LENGTH, DISC, ROUND < HALF),
        (DISC, DISC * (2 + x), x > y**2),
        (sp.sqrt(1 - x**2) - abs(y), DISC, abs(x) < HALF),
        (sp.log(2 - ROUND), DISC, x > 0),
        (y - sp.exp(x), sp.log(y + 3) - sp.log(sp.exp(x) + 3), x > 0),
    ]
} | {
    "ball twice": (body(sp.Piecewise((1 - SPHERICAL, z > 0), (1 - sp.sqrt(SPHERICAL), True))), "analytic"),
    "ball thrice": (
        body(sp.Piecewise((1 - SPHERICAL, z > HALF), (2 - 2 * SPHERICAL, x > 0), (1 - sp.sqrt(SPHERICAL), True))),
        "analytic",
    ),
}
COINCIDING = {
    "rectangles": (rsym.rectangle(2, 1) | rsym.rectangle(2, 1).translate(1, 0), "G0"),
    "rectangles of different height": (rsym.rectangle(2, 1) | rsym.rectangle(2, 2).translate(1, HALF), "G0"),
    "rectangles side by side": (rsym.rectangle(1, 1) | rsym.rectangle(1, 1).translate(1, 0), "broken"),
    "boxes": (rsym.box(2, 1, 1) | rsym.box(2, 1, 1).translate(1, 0, 0), "G0"),
    "a tower in a plate": (rsym.box(2, 2, 1) | rsym.box(1, 2, 3), "G0"),
    "cylinders": (rsym.cylinder(1, 2) | rsym.cylinder(1, 2).translate(0, 0, 1), "G0"),
    "ball and half of it": (rsym.sphere(1) | (rsym.sphere(1) & body(x, 2)), "analytic"),
    "disc and half of it": (plane(disjunction(DISC, conjunction(DISC, x))), "analytic"),
    "halves of a disc": (plane(disjunction(conjunction(DISC, x), conjunction(DISC, HALF - x))), "analytic"),
    "halves in other words": (
        plane(disjunction(conjunction(DISC, x + HALF), conjunction(1 - LENGTH, HALF - x))),
        "analytic",
    ),
    "halves of a ball": (
        body(disjunction(conjunction(1 - SPHERICAL, z), conjunction(1 - sp.sqrt(SPHERICAL), HALF - z))),
        "analytic",
    ),
    "roofs": (plane(disjunction(conjunction(y - abs(x), x + 1), y - x)), None),
}
RADIAL = {
    "y - r^(3/2)": (plane(y - ROUND ** sp.Rational(3, 4)), "G1"),
    "y - r^(4/3)": (plane(y - ROUND ** sp.Rational(2, 3)), "G1"),
    "y - r^2 log r": (plane(y - ROUND * sp.log(ROUND)), "G1"),
    "y - x^2 log|x|": (plane(y - x**2 * sp.log(abs(x))), "G1"),
    "y - x^2 log(x^2)": (plane(y - x**2 * sp.log(x**2)), "G1"),
    "y - x^3 log|x|": (plane(y - x**3 * sp.log(abs(x))), "G2"),
    "y - |x|^(3/2)": (plane(y - abs(x) ** sp.Rational(3, 2)), "G1"),
    "y - |x|^sqrt(2)": (plane(y - abs(x) ** ROOT), "G1"),
    "y - r^(5/2)": (plane(y - ROUND ** sp.Rational(5, 4)), "G2"),
    "z - r^(3/2)": (body(z - ROUND ** sp.Rational(3, 4)), "G1"),
    "z - r^2 log r": (body(z - ROUND * sp.log(ROUND) / 2), "G1"),
    "z - r^(5/2)": (body(z - ROUND ** sp.Rational(5, 4)), "G2"),
    "y - x log|x|": (plane(y - x * sp.log(abs(x))), "G0"),
}
SMALL = {
    "disc": (plane((rsym.disc(1) | rsym.disc(TINY, SIDE)).expression), "analytic"),
    "disc at an irrational place": (plane((rsym.disc(1) | rsym.disc(TINY, (ROOT, HALF))).expression), "analytic"),
    "square": (plane((rsym.disc(1) | rsym.rectangle(TINY, TINY, SIDE)).expression), "G0"),
    "hole": (plane((rsym.disc(1) - rsym.disc(TINY, (HALF, 0))).expression), "analytic"),
    "ball": (body((rsym.sphere(1) | rsym.sphere(TINY, (*SIDE, 0))).expression), "analytic"),
    "cavity": (body((rsym.sphere(1) - rsym.sphere(TINY, (HALF, 0, 0))).expression), "analytic"),
    "box": (body((rsym.sphere(1) | rsym.box(TINY, TINY, TINY, (*SIDE, 0))).expression), "G0"),
    "channel": (body((rsym.sphere(1) - rsym.cylinder(TINY, 4)).expression), "G0"),
}
KINDS = {
    "contacts at irrational points": CONTACTS,
    "folds of angles": FOLDS,
    "profiles": PROFILES,
    "one curve written twice": WRITTEN_TWICE,
    "sheets that coincide on a part": COINCIDING,
    "powers and logarithms of a distance": RADIAL,
    "parts of 1e-7": SMALL,
}


def corners():
    """Shapes with corners of pieces that are normalised to first order, or else normalised as a whole."""
    rectangle, disc, box = rsym.rectangle(2, 1), rsym.disc(1), rsym.box(2, 1, 1)
    made = {
        "rectangle": rectangle,
        "triangle": rsym.polygon([(0, 0), (2, 0), (0, 1)]),
        "hexagon": rsym.regular_polygon(6, 1),
        "pentagon": rsym.regular_polygon(5, 1),
        "lens": disc & disc.translate(1, 0),
        "two discs": disc | disc.translate(1, 0),
        "moon": disc - disc.translate(1, 0),
        "half disc": disc & plane(y),
        "plate with a hole": rectangle - rsym.disc(HALF),
        "slotted disc": disc - rsym.rectangle(1, HALF / 2).translate(1, 0),
        "L": rectangle | rsym.rectangle(1, 2).translate(-1, 1),
        "turned square": rsym.rectangle(1, 1).rotate(0.3),
        "drop": rsym.normalise(rsym.Shape(conjunction(1 - ROUND, 1 - x - y), (x, y))),
        "sector": disc & plane(y) & plane(x),
        "diamond": rsym.normalise(rsym.Shape(1 - abs(x) - abs(y), (x, y))),
        "parabola cut": rsym.normalise(rsym.Shape(conjunction(1 - y, y - x**2), (x, y))),
        "R1 square": rsym.rectangle(1, 1, system=rsym.R1),
        "normalised rectangle": rsym.normalise(rectangle),
        "box": box,
        "cylinder": rsym.cylinder(1, 2),
        "cone": rsym.cone(1, 2),
        "half ball": rsym.sphere(1) & body(z, 2),
        "drilled box": box - rsym.cylinder(HALF, 4),
        "two balls": rsym.sphere(1) | rsym.sphere(1, (1, 0, 0)),
    }
    return made


def asked(shape, limit=LIMIT):
    """The report, the seconds of the processor."""
    begin = time.process_time()
    report = rsym.verify_smoothness(shape, timeout=limit)
    return report, time.process_time() - begin


def main() -> int:
    """The command."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="part of the name of a kind")
    given = parser.parse_args()
    counts, false = {}, 0
    for kind, shapes in KINDS.items():
        if given.only not in kind:
            continue
        open_ones = reasons = 0
        for name, (shape, grade) in shapes.items():
            report, seconds = asked(shape)
            wrong = falsehoods(report, grade)
            false += bool(wrong)
            said = [text for text, proved in report.statements if not proved]
            if report.verdict == "UNDECIDED":
                open_ones += 1
                reasons += any("near (" in text or "along a curve" in text for text in said)
            print(
                f"{kind[:20]:20} {name[:40]:40} {report.verdict:10} {report.continuity:9} ({grade}) {seconds:5.1f} s",
                "  FALSE: " * bool(wrong) + "; ".join(wrong),
                " | ".join(said) if report.verdict == "UNDECIDED" else "",
                flush=True,
            )
        counts[kind] = len(shapes) - open_ones, open_ones, reasons
    if given.only in "normalisation":
        shapes, open_ones, reasons = corners(), 0, 0
        for name, shape in shapes.items():
            begin = time.process_time()
            report = rsym.verify_normalisation(shape)
            said = [text for text, proved in report.statements if not proved]
            open_ones += report.verdict == "UNDECIDED"
            reasons += report.verdict == "UNDECIDED" and bool(said)
            false += report.verdict == "REFUTED"
            print(
                f"normalisation {name[:40]:40} {report.verdict} {time.process_time() - begin:.1f} s",
                " | ".join(said),
                flush=True,
            )
        counts["normalisation of corners"] = len(shapes) - open_ones, open_ones, reasons
    for kind, (decided, left, told) in counts.items():
        print(f"{kind:40} decided {decided}, undecided {left}, of these with a reason {told}")
    print(f"{false} false")
    return 1 if false else 0


if __name__ == "__main__":
    sys.exit(main())
