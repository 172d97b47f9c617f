"""Letters from data: the body of Fig. 11 found from noisy points of its boundary, and what one letter does to it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.fits import plot_fit, plot_sensitivity
from rsym.paper.drawing import Drawing, Table, letters_text
from rsym.paper.models import skeleton_body
from rsym.reports.numbers import measured
from rsym.sampling.fit_report import Fit
from rsym.sampling.fitting import fit
from rsym.sampling.samples import sample
from rsym.sampling.sensitivity import sensitivity

TRUTH: Mapping[str, float] = MappingProxyType({"a": 4.5, "a1": 7.6, "a2": 5.9, "p1": 36.0})
COUNT, NOISE = 500, 0.02  # points, and the standard deviation of each coordinate
MOVED = "a2"
CELLS = 256
EQUATIONS = (
    r"\sum_{k} \omega_{n}\left(x_{k}, y_{k}\right)^{2} \to \min",
    r"V = \frac{\partial\omega / \partial a_{2}}{\left|\nabla\omega\right|}, \quad "
    r"\frac{dA}{da_{2}} = \int_{\omega = 0} V\, ds",
)


def draw_fitted() -> Drawing:
    """The fit with its residuals above, the speed of the boundary when a2 grows below."""
    found = fitted()
    figure = Figure(figsize=(8.4, 6.0), layout="constrained")
    above, below = figure.subplots(2, 1)
    points = plot_fit(found, ax=above, resolution=CELLS)
    moving = sensitivity(found.shape, MOVED)
    teeth = plot_sensitivity(moving, ax=below)
    below.set_title(f"the boundary when ${MOVED[0]}_{MOVED[1]}$ grows", fontsize=11)
    for ax, artist, label in ((above, points, "residual"), (below, teeth, "speed outwards")):
        bar: Any = figure.colorbar(artist, ax=ax, shrink=0.9)  # type: ignore[arg-type]
        bar.set_label(label)
    rows = [
        (name, f"{value:g}", f"{found.start[name]:g}", measured(found.letters[name], found.standard_errors[name]))
        for name, value in TRUTH.items()
    ]
    remark = (
        f"{COUNT} points of the boundary with errors of standard deviation {NOISE:g}; residuals of rms {found.rms:.3g}."
        f" The area grows by {moving.area_derivative:.4g} to a unit of {MOVED}."
    )
    table = Table(("letter", "truth", "start", "found, with its standard error"), tuple(rows))
    return Drawing(figure, letters_text(found.shape.letters), 0, remark, table)


def fitted() -> Fit:
    """The letters from the points.

    Examples
    --------
    >>> found = fitted()
    >>> all(abs(found.letters[name] - value) < 3 * found.standard_errors[name] for name, value in TRUTH.items())
    True
    """
    return fit(skeleton_body(), points_with_noise(), list(TRUTH))


def points_with_noise() -> Floats:
    """Points of the boundary with the errors of measuring; the same every time."""
    exact = sample(skeleton_body().with_letters(TRUTH), COUNT, over="boundary", rng=1).points
    return exact + np.random.default_rng(1).normal(scale=NOISE, size=exact.shape)
