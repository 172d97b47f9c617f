"""What a check of fairness answers: bounds on curvature and its variation, where its extrema are, and measures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.verify.bodies.report import BodyReport
from rsym.verify.fairness.markup import fairness_html
from rsym.verify.fairness.records import fairness_json
from rsym.verify.fairness.wording import extremum_text, fairness_text
from rsym.verify.report import SmoothnessReport

Floats: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Peak:
    """How far a quantity goes one way: no value goes beyond `bound`; `attained` is its value at `point`.

    `proved` says whether the bound is; the point is one of the boundary and the value is right to rounding.
    """

    bound: float
    attained: float
    point: tuple[float, ...]
    proved: bool = True


@dataclass(frozen=True)
class CurvatureBounds:
    """The least and the greatest value of a curvature [1/length] and the greatest size of its variation [1/length**2].

    The variation is the derivative with respect to arc length along the curve or the meridian; of a principal
    curvature of a general body it is the length of its gradient along the surface.

    Examples
    --------
    >>> none = Peak(0.0, 0.0, ())
    >>> CurvatureBounds("curvature", Peak(-3.1, -3.0, (1.0, 0.0)), Peak(2.1, 2.0, (0.0, 1.0)), none).size
    Peak(bound=3.1, attained=3.0, point=(1.0, 0.0), proved=True)
    """

    name: str
    least: Peak
    greatest: Peak
    variation: Peak

    @property
    def size(self) -> Peak:
        """The curvature farthest from zero, its size."""
        low, high = self.least, self.greatest
        bound = max(abs(low.bound), abs(high.bound))
        best = max((high, low), key=lambda peak: -1.0 if math.isnan(peak.attained) else abs(peak.attained))
        return Peak(bound, abs(best.attained), best.point, low.proved and high.proved)


@dataclass(frozen=True)
class Extremum:
    """A place where a curvature is extreme along the boundary, or changes its sign.

    kind: "maximum", "minimum" or "inflection"; `quantity` names the curvature. The
    place is within `radius` of `point`, and the curvature within `error` of `curvature`. `proved`: there is exactly
    one such place within the radius. `flat`: the curvature touches zero there without changing its sign.

    Examples
    --------
    >>> print(Extremum("maximum", "curvature", (2.0, 0.0), 1e-30, 2.0, 1e-15, True))
    maximum of the curvature at (2, 0): 2; proved
    """

    kind: str
    quantity: str
    point: tuple[float, ...]
    radius: float
    curvature: float
    error: float
    proved: bool
    flat: bool = False

    def __str__(self) -> str:
        return extremum_text(self)


@dataclass(frozen=True)
class Measure:
    """A number known numerically, and an estimate of its error."""

    value: float
    error: float


@dataclass(frozen=True, eq=False)
class Profile:
    """Curvatures (n, k) and their derivatives with respect to arc length at points (n, 2) of one line, numerically.

    `length` (n,) is the arc length from the first point. A closed line repeats its first point.
    """

    points: Floats
    length: Floats
    curvature: Floats
    variation: Floats

    @property
    def closed(self) -> bool:
        """Whether the line ends where it begins."""
        return bool(np.array_equal(self.points[0], self.points[-1]))


@dataclass(frozen=True, eq=False)
class Bands:
    """What is proved piece by piece: on each of the boxes (n, 2, 2) the curvatures lie in `ranges` (n, k, 2)."""

    boxes: Floats
    ranges: Floats


@dataclass(frozen=True, eq=False, repr=False)
class FairnessReport:
    """How fair a boundary is, beyond its continuity.

    Attributes
    ----------
    kind : str
        "curve", "body of revolution" (all is said of its meridian, with points (axis, radius)) or "body".
    coordinates : tuple of str
        The names of those of a point.
    smoothness : SmoothnessReport or BodyReport
        The verdict: below G2 the boundary is broken at the defects, and the bounds hold between them.
    curvatures : tuple of CurvatureBounds
        One curvature of a curve, two of a body.
    extrema, inflections : tuple of Extremum
        Where a curvature is extreme along the boundary, and where it changes its sign, between the joints.
    complete : bool
        Whether these are proved to be all of them.
    constant : tuple of bool
        Which curvatures are proved to be constant between the joints: every point is an extremum and none is given.
    measures : mapping of str to Measure
        "length" and "area" of a curve, "area" and "volume" of a body, "bending_energy", the integral of the squares of
        the curvatures, and "variation_energy", that of the squares of their variations; numerical.
    profiles, bands
        The curvatures along each line (each half of a meridian), numerically, and piece by piece, proved; for pictures.
    statements : pairs
        Sentences, each with whether it is proved.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.verify.fairness.fairness import fairness
    >>> report = fairness(rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2))))
    >>> (bounds,) = report.curvatures
    >>> bounds.greatest.attained, bounds.greatest.bound < 2.03, report.complete, len(report.extrema)
    (2.0, True, True, 4)
    >>> round(report.measures["area"].value / 3.141592653589793, 9)
    2.0

    Source of the energies: Moreton and Sequin, Functional optimization for fair surface design (1992).
    """

    kind: str
    coordinates: tuple[str, ...]
    smoothness: SmoothnessReport | BodyReport
    curvatures: tuple[CurvatureBounds, ...]
    extrema: tuple[Extremum, ...]
    inflections: tuple[Extremum, ...]
    complete: bool
    constant: tuple[bool, ...]
    measures: Mapping[str, Measure]
    profiles: tuple[Profile, ...]
    bands: Bands
    statements: tuple[tuple[str, bool], ...] = field(default=())

    @property
    def verdict(self) -> str:
        """That on smoothness."""
        return self.smoothness.verdict

    @property
    def continuity(self) -> str:
        """What the boundary is everywhere."""
        return self.smoothness.continuity

    def __str__(self) -> str:
        return fairness_text(self)

    def __repr__(self) -> str:
        return f"<FairnessReport of a {self.kind}, {self.verdict}, {len(self.extrema)} extrema>"

    def to_json(self) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown or has no bound."""
        return fairness_json(self)

    def _repr_html_(self) -> str:
        return fairness_html(self)
