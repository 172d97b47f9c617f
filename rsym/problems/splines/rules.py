"""The splines of the grid of a rule of integration."""

from __future__ import annotations

import numpy as np

from rsym.errors import RsymError
from rsym.problems.splines.web import WebSplines, web_splines
from rsym.sampling.rules.quadrature import Quadrature

# Of a cell: with whole cells alone, more splines are parts of others that are farther away, and the error of an ellipse
# that is turned and shifted at 12 cells of degree 4 changes by a factor of 2.3 and not by 1.2; the condition of the
# scaled matrix is 600 to 1300 then and not 1800 to 2100. With a third it is up to 5400, and nothing is gained.
HALF = 0.5
NOTHING = 1e-6  # of a cell: what is cut off by rounding


def splines_of(rule: Quadrature, degree: int) -> WebSplines:
    """The splines of the cells of a rule; of those that have no cell half inside each is part of others.

    Raises
    ------
    RsymError
        For a part of the shape, joined with no other, that has too few cells.

    Examples
    --------
    >>> import rsym
    >>> splines_of(rsym.quadrature(rsym.disc(1), cells=8), 3).extension.shape
    (109, 77)
    """
    grid = rule.grid
    content = np.bincount(rule.cells, rule.weights, int(np.prod(grid.counts)))
    inner = np.flatnonzero(content >= HALF * grid.size ** len(grid.counts))
    made = web_splines(grid.lower, grid.size, grid.counts, degree, rule.touched, inner, rule.closed)
    if len(made.astray) and content[made.astray].sum() > NOTHING * grid.size ** len(grid.counts):
        most = made.astray[np.argmax(content[made.astray])]
        where = rule.cells == most
        place = ", ".join(f"{value:.4g}" for value in np.average(rule.points[where], 0, rule.weights[where]))
        raise RsymError(
            f"of a part of the shape by itself, about ({place}), cells of {grid.size:.4g} are too few for splines "
            f"of degree {degree}: no block of these, {degree + 1} to each side, has a cell half inside each",
            code="cells",
            remedy="ask for more cells or a lower degree, or take this part as a shape by itself",
        )
    return made
