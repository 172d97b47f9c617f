"""What the source claims of its surfaces and what of it holds, for which letters: verdicts found anew in every run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rsym.analysis.normalisation import normalise
from rsym.model.constructions import revolve
from rsym.model.shape import Shape
from rsym.output.atlas import plot_atlas
from rsym.output.certificates import DEFECT, draw_boundary, draw_window, subject
from rsym.output.verdicts import plot_verdict
from rsym.paper.drawing import Drawing, Table, letters_text
from rsym.paper.models import BODIES, skeleton_body
from rsym.reports.numbers import at_most, measured, number
from rsym.verify.answers.report import SmoothnessReport
from rsym.verify.atlas.atlas import smoothness_atlas
from rsym.verify.normalisation.normalisation import verify_normalisation
from rsym.verify.smoothness import verify_smoothness

LETTERS = ("a2", "p1")
REGION = ((5, 6), (20, 80))
ATLAS_TOLERANCE = 0.04  # of the range of a2, which is less than 1 % of its value
ROWS = (20, 40, 60, 80)
CONDITION = r"a_{2} > a + \frac{p_{1} p_{2}}{a_{1} + a}"
ATLAS_HEADER = ("p1", "a2 is refuted below, proved", "a2 by the formula", "a2 is certified above, proved")
ATLAS_REMARK = (
    "Ours. Each rectangle is proved for every value in it: certified by interval arithmetic with both letters as "
    "intervals, refuted by a corner that is followed over all of it. The formula was not used. The greatest curvature, "
    "which grows without bound at the threshold, is numerical."
)
CURVATURE = "the curvature is continuous"
NOSES = (5.3, 5.35, 6.0)  # a2: as printed, little above what a smooth nose needs, well above
SMOOTH = (5.32, 8.0)
NOSE, TIP = 0.6, 0.15  # what the windows about the left end show, in units of the model
RESOLUTION = 400
TOLERANCE = 1e-2  # proved of a smooth boundary in 12 000 boxes
REMARK = (
    "The source says that its surfaces have a continuous curvature function. The verdicts are found anew in each run: "
    "CERTIFIED and REFUTED are proved by interval arithmetic for every point of the boundary within the bounds. No "
    "picture of curvature values shows the corner of Fig. 11: both one-sided curvatures are equal. Blue: proved to be "
    "one regular arc; green: two arcs meet, proved; orange: a defect; grey: the curvature as a comb. Normal "
    f"derivatives are checked within {TOLERANCE:g}; at a corner there is no normal, so that nothing is proved there."
)
HEADER = ("claim", "of what", "verdict", "what was found")


@dataclass(frozen=True)
class Claim:
    """One claim about one shape, with its verdict."""

    claim: str
    body: str
    shape: Shape
    report: SmoothnessReport

    @property
    def row(self) -> tuple[str, ...]:
        """The claim as a row of the table."""
        return self.claim, self.body, self.report.verdict, finding(self.report)


def finding(report: SmoothnessReport) -> str:
    """What a verdict rests on, in a few words: the worst defect, or what is proved of the whole boundary."""
    if not report.defects:
        bound = f", curvature at most {at_most(report.curvature_bound)}"
        return f"{report.continuity}{bound if math.isfinite(report.curvature_bound) else ''}"
    worst = report.defects[0]
    turn = f", turn {measured(worst.tangent_jump, worst.tangent_jump_error)}°" if worst.tangent_jump > 0 else ""
    status = "proved" if worst.proved else "not proved"
    return f"{worst.kind} at ({', '.join(map(number, worst.point))}){turn}, {status}"


def profiles() -> list[Claim]:
    """Fig. 11's body as it is printed, with a nose that just is smooth, with a round one, and read literally."""
    body = skeleton_body()
    return [
        *(_curvature(f"Fig. 11, a₂ = {value:g}", body.with_letters({"a2": value})) for value in NOSES),
        _curvature(f"Fig. 11, every a₂ from {SMOOTH[0]:g} to {SMOOTH[1]:g}", body, {"a2": SMOOTH}),
        _curvature(f"Fig. 11, literal reading, a₂ = {NOSES[0]:g}", skeleton_body("literal")),
    ]


def bodies() -> list[Claim]:
    """The bodies of revolution of Fig. 12."""
    profile = skeleton_body().with_letters({"a2": 5})
    return [
        _curvature(f"Fig. 12, a₁ = {a1}, p₁ = {p1}", revolve(profile.with_letters({"a1": a1, "p1": p1})))
        for a1, p1 in BODIES
    ]


def _curvature(body: str, shape: Shape, letters: Mapping[str, Any] | None = None) -> Claim:
    report = verify_smoothness(shape, letters=letters)
    assert isinstance(report, SmoothnessReport)  # in the plane, and by the meridian
    return Claim(CURVATURE, body, shape, report)


def normalisations() -> list[tuple[str, ...]]:
    """Rows on omega and omega_n of Fig. 11: the first two derivatives along the normal of the boundary."""
    body = skeleton_body()
    printed, smooth = (normalise(body.with_letters({"a2": value})) for value in (NOSES[0], NOSES[-1]))
    return [
        _normalised("∂ω/∂ν is 1", f"ω of Fig. 11, a₂ = {NOSES[0]:g}", body, 1),
        _normalised("∂ωₙ/∂ν is 1: order 1", f"ωₙ of Fig. 11, a₂ = {NOSES[0]:g}", printed, 1),
        _normalised("∂ωₙ/∂ν is 1: order 1", f"ωₙ of Fig. 11, a₂ = {NOSES[-1]:g}", smooth, 1),
        _normalised("∂²ωₙ/∂ν² is 0 too: order 2, not claimed", f"ωₙ of Fig. 11, a₂ = {NOSES[-1]:g}", smooth, 2),
    ]


def _normalised(claim: str, body: str, shape: Shape, order: int) -> tuple[str, ...]:
    report = verify_normalisation(shape, order, tolerance=TOLERANCE)
    worst, bound = report.worst[-1], report.proved_bounds[-1]
    found = f"largest deviation found {measured(worst.deviation, worst.error)}"
    proved = f", at most {at_most(bound)} proved" if report.verdict == "CERTIFIED" else ""
    return claim, body, report.verdict, f"{found}{', proved' if report.verdict == 'REFUTED' else ''}{proved}"


def draw_claims() -> Drawing:
    """The body of Fig. 11, its nose at three values of a2, the tips of Fig. 12; every claim in the table."""
    plane, solid = profiles(), bodies()
    figure = Figure(figsize=(8.4, 7.6), layout="constrained")
    grid = figure.add_gridspec(3, 6, height_ratios=(2.4, 2.6, 1.4))
    plot_verdict(plane[0].report, plane[0].shape, ax=(top := figure.add_subplot(grid[0, :])))
    top.set_title(f"Fig. 11 as printed: {top.get_title()}", fontsize=10)
    for k, claim in enumerate(plane[: len(NOSES)]):
        _draw_nose(figure.add_subplot(grid[1, 2 * k : 2 * k + 2]), claim)
    for k, (claim, (a1, p1)) in enumerate(zip(solid, BODIES, strict=True)):
        _draw_tip(figure.add_subplot(grid[2, k]), claim, f"$a_1 = {a1}$, $p_1 = {p1}$")
    table = Table(HEADER, (*(claim.row for claim in [*plane, *solid]), *normalisations()))
    return Drawing(figure, letters_text(skeleton_body().letters), 0, REMARK, table)


def _draw_nose(ax: Axes, claim: Claim) -> None:
    """The left end, with its curvature as a comb."""
    about = subject(claim.report, claim.shape)
    whole = np.concatenate(about.lines(about.bounds, RESOLUTION))
    tip = whole[:, 0].min()
    window = ((tip - NOSE / 3, tip + NOSE), (-NOSE * 2 / 3, NOSE * 2 / 3))
    draw_boundary(ax, about.lines(window, RESOLUTION), claim.report)
    for joint in claim.report.defects:
        ax.plot(*joint.point, "o", color=DEFECT, zorder=5)
    ax.set(xlim=window[0], ylim=window[1], aspect="equal", xlabel="$x$")
    ax.set_title(f"$a_2 = {about.letters['a2']:g}$: {claim.report.verdict}, {claim.report.continuity}", fontsize=9)
    ax.tick_params(labelsize=7)


def _draw_tip(ax: Axes, claim: Claim, letters: str) -> None:
    """The worst defect of a body, magnified; a body without one as a whole."""
    about = subject(claim.report, claim.shape)
    if claim.report.defects:
        draw_window(ax, claim.report, about, claim.report.defects[0], TIP)
    else:
        draw_boundary(ax, about.lines(about.bounds, RESOLUTION), claim.report)
        ax.autoscale_view()
        ax.set_aspect("equal")
    ax.set_title(letters, fontsize=8)
    ax.set_xlabel(f"{claim.report.verdict}, {claim.report.continuity}", fontsize=7)


def draw_atlas() -> Drawing:
    """The atlas, found anew in every run, beside the formula for a smooth nose."""
    body = skeleton_body()
    atlas = smoothness_atlas(body, *LETTERS, between=REGION, tolerance=ATLAS_TOLERANCE, sharpening=0)
    figure: Figure = plot_atlas(atlas)
    (curve,) = atlas.thresholds
    rows = []
    for p1 in ROWS:
        low, high = curve.between(p1)
        rows.append((f"{p1}", f"{low:.4f}", f"{float(threshold(p1)):.4f}", f"{high:.4f}"))
    fixed = {name: letter for name, letter in body.letters.items() if name not in LETTERS}
    remark = f"{ATLAS_REMARK} {atlas}"
    return Drawing(figure, letters_text(fixed), 0, remark, Table(ATLAS_HEADER, tuple(rows)))


def threshold(p1: int) -> Fraction:
    """The value of a2 beyond which the blend is positive on the whole segment, at the letters of Fig. 11.

    Examples
    --------
    >>> threshold(40)
    Fraction(69, 13)
    """
    letters = {name: Fraction(str(letter.default)) for name, letter in skeleton_body().letters.items()}
    return letters["a"] + p1 * letters["p2"] / (letters["a1"] + letters["a"])
