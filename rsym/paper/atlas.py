"""For which letters the body of Fig. 11 is smooth: the plane of a2 and p1, with proof."""

from __future__ import annotations

from fractions import Fraction

from matplotlib.figure import Figure

from rsym.output.atlas import plot_atlas
from rsym.paper.drawing import Drawing, Table, letters_text
from rsym.paper.models import skeleton_body
from rsym.verify.atlas.atlas import smoothness_atlas

LETTERS = ("a2", "p1")
REGION = ((5, 6), (20, 80))
TOLERANCE = 0.04  # of the range of a2, which is less than 1 % of its value
ROWS = (20, 40, 60, 80)
CONDITION = r"a_{2} > a + \frac{p_{1} p_{2}}{a_{1} + a}"
HEADER = ("p1", "a2 is refuted below, proved", "a2 by the formula", "a2 is certified above, proved")
REMARK = (
    "Ours. Each rectangle is proved for every value in it: certified by interval arithmetic with both letters as "
    "intervals, refuted by a corner that is followed over all of it. The formula was not used. The greatest curvature, "
    "which grows without bound at the threshold, is numerical."
)


def draw_atlas() -> Drawing:
    """The atlas, found anew in every run, beside the formula for a smooth nose."""
    body = skeleton_body()
    atlas = smoothness_atlas(body, *LETTERS, between=REGION, tolerance=TOLERANCE, sharpening=0)
    figure: Figure = plot_atlas(atlas)
    (curve,) = atlas.thresholds
    rows = []
    for p1 in ROWS:
        low, high = curve.between(p1)
        rows.append((f"{p1}", f"{low:.4f}", f"{float(formula(p1)):.4f}", f"{high:.4f}"))
    fixed = {name: letter for name, letter in body.letters.items() if name not in LETTERS}
    remark = f"{REMARK} {atlas}"
    return Drawing(figure, letters_text(fixed), 0, remark, Table(HEADER, tuple(rows)))


def formula(p1: int) -> Fraction:
    """The value of a2 beyond which the blend is positive on the whole segment, at the letters of Fig. 11.

    Examples
    --------
    >>> formula(40)
    Fraction(69, 13)
    """
    letters = {name: Fraction(str(letter.default)) for name, letter in skeleton_body().letters.items()}
    return letters["a"] + p1 * letters["p2"] / (letters["a1"] + letters["a"])
