"""What a fit of letters to measured points says: values with standard errors, residuals, what was left out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.model.shape import Shape
from rsym.reports.document import Document, Sentence, Tabular, numerical
from rsym.reports.numbers import measured, number, short
from rsym.reports.render import Report
from rsym.reports.words import first_of, listed, plural

MOST_NUMBERS = 5  # of points that are told
# Residuals above this share of the length L are no distances any more: there omega_1 has begun to level off.
LARGE = 0.05


@dataclass(frozen=True, eq=False, repr=False)
class Fit(Report):
    """The letters that measured points determine.

    Attributes
    ----------
    shape : Shape
        With the letters found as its defaults.
    letters, standard_errors, start : {name: value}
        What was found, how far noise may have moved it, and where the search began. A letter that ends at its bound has
        the standard error NaN.
    covariance : (k, k) array
        Of the letters in their order.
    residuals : (n,) array
        The distance of first order of each point from the boundary, positive inside; NaN where omega has none.
    points : (n, dim) array
        As they were given.
    at_bounds : tuple of str
        Letters that would go on if their range did not end.
    left_out, without_derivative : (k,) arrays of int
        Points without a residual, which took no part, and points with a residual but no derivative by letters at the
        end, which moved no letter in the last step.
    loss, scale
        As in `fit`; the scale of a linear loss is 1.
    length : float
        L of the distance omega/sqrt(omega**2/L**2 + |grad omega|**2).
    evaluations : int
        How often the residuals were computed.
    converged : bool
        False where they were computed as often as is allowed.
    section, silhouette
        The plane that the points lie in, or the direction of view that they are an outline in.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> disc = rsym.disc(sp.Symbol("r"), letters={"r": rsym.Letter(1, minimum=0.1)})
    >>> print(rsym.fit(disc, [[2, 0], [0, 2.1], [-1.9, 0], [0, -2]], letters=["r"]))
    4 points determine r: residuals of rms 0.07071, the largest 0.1012.
      letter  value        start  range
      r       2.00 ± 0.05  1      [0.1, ...]
    """

    shape: Shape
    letters: dict[str, float]
    standard_errors: dict[str, float]
    residuals: Floats
    covariance: Floats
    points: Floats
    start: dict[str, float]
    at_bounds: tuple[str, ...]
    left_out: Ints
    without_derivative: Ints
    loss: str
    scale: float
    length: float
    evaluations: int
    converged: bool
    section: Mapping[str, float] | None = None
    silhouette: tuple[float, float, float] | None = None

    @property
    def rms(self) -> float:
        """The root of the mean square of the residuals."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))

    def __repr__(self) -> str:
        return f"<Fit of {first_of(list(self.letters), MOST_NUMBERS)} to {plural(len(self.points), 'point')}>"

    def document(self) -> Document:
        """Values with their standard errors, and what a reader should know of them; measured, not proved."""
        count = len(self.points) - len(self.left_out)
        largest = float(np.nanmax(np.abs(self.residuals)))
        what = "of a silhouette " if self.silhouette is not None else "of a section " if self.section else ""
        verb = "determines" if count == 1 else "determine"
        headline = (
            f"{plural(count, 'point')} {what}{verb} {listed(list(self.letters))}: "
            f"residuals of rms {short(self.rms, self.length)}, the largest {short(largest, self.length)}."
        )
        rows = [
            (
                name,
                measured(value, self.standard_errors[name]),
                number(self.start[name]),
                self.shape.letters[name].range,
            )
            for name, value in self.letters.items()
        ]
        return Document(
            "fit",
            Sentence(headline, False),
            sentences=numerical(self._remarks()),
            tables=(Tabular(("letter", "value", "start", "range"), tuple(rows)),),
            data={
                "letters": self.letters,
                "standard_errors": self.standard_errors,
                "covariance": self.covariance,
                "rms": self.rms,
                "points": len(self.points),
                "left_out": self.left_out,
                "without_derivative": self.without_derivative,
                "at_bounds": self.at_bounds,
                "loss": self.loss,
                "scale": self.scale,
                "length": self.length,
                "evaluations": self.evaluations,
                "converged": self.converged,
            },
        )

    def _remarks(self) -> list[str]:
        told = []
        if self.loss != "linear":
            told.append(
                f"Loss {self.loss} with the scale {number(self.scale, 4)}; standard errors are Huber's of M-estimates."
            )
        if len(self.left_out):
            told.append(f"Left out, for omega has no distance there: {_numbers(self.left_out)}.")
        if len(self.without_derivative):
            told.append(f"Without a derivative by letters at the end: {_numbers(self.without_derivative)}.")
        if self.at_bounds:
            verb = "ends at its bound" if len(self.at_bounds) == 1 else "end at their bounds"
            told.append(f"{listed(self.at_bounds)} {verb}, and would go on: no standard error is known.")
        if len(self.points) - len(self.left_out) == len(self.letters):
            told.append("No more points than letters: standard errors are not known.")
        if self.rms > LARGE * self.length:
            told.append(
                f"The residuals are large beside the length {short(self.length)}: to first order they are no distances."
            )
        if not self.converged:
            told.append(f"The search was stopped after {self.evaluations} evaluations: the letters may still move.")
        return told


def _numbers(which: Ints) -> str:
    """How many points, and the first of their numbers.

    Examples
    --------
    >>> _numbers(np.array([3, 8])), _numbers(np.array([2]))
    ('2 points (3, 8)', '1 point (2)')
    """
    return f"{plural(len(which), 'point')} ({first_of([str(one) for one in which.tolist()], MOST_NUMBERS)})"
