"""What a check of fairness answers: bounds on curvature and its variation, where its extrema are, and measures."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from rsym.arrays import Floats
from rsym.reports.document import Document, Entry, Sentence, Tabular
from rsym.reports.numbers import at_least, at_most, measured, number, point
from rsym.reports.render import Report
from rsym.reports.words import letters_text, listed, plural, within
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import UNKNOWN, SmoothnessReport, yes_or_no

MEASURES: Mapping[str, str] = {
    "length": "length",
    "area": "area",
    "volume": "volume",
    "bending_energy": "bending energy",
    "variation_energy": "variation energy",
}
KINDS: Mapping[str, str] = {"maximum": "maxima", "minimum": "minima"}
HEADER = ("", "proved", "attained", "at")
COLUMNS = ("place", "kind", "of", "value", "proved")
LISTED = 24  # places; the report has them all
SHOWN = 5  # digits of a bound, and more of what is attained


@dataclass(frozen=True)
class Peak:
    """How far a quantity goes one way: no value goes beyond `bound`; `attained` is its value at `point`.

    `proved` says whether the bound is; the point is one of the boundary and the value is right to rounding.
    """

    bound: float
    attained: float
    point: tuple[float, ...]
    proved: bool = True

    def row(self, name: str, *, up: bool = True) -> tuple[str, ...]:
        """Name, bound, value attained, place."""
        attained = "unknown" if math.isnan(self.attained) else number(self.attained, SHOWN + 3)
        sign = "" if not self.bounded else "<= " if up else ">= "
        return name, sign + self.told(up=up), attained, point(self.point)

    def told(self, *, up: bool) -> str:
        """The bound, from above or below, rounded to the safe side."""
        if not self.bounded:
            return "none"
        return at_most(self.bound, SHOWN) if up else at_least(self.bound, SHOWN)

    @property
    def bounded(self) -> bool:
        """Whether a bound is proved."""
        return self.proved and math.isfinite(self.bound)


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

    def rows(self) -> tuple[tuple[str, ...], ...]:
        """Of a table under `HEADER`."""
        return (
            self.least.row(f"least {self.name}", up=False),
            self.greatest.row(f"greatest {self.name}"),
            self.variation.row(f"variation of the {self.name}"),
        )


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
        proved = "proved" if self.proved else "numerical"
        if self.kind == "inflection":
            return f"inflection, the {self.quantity} changes its sign, at {point(self.point)}; {proved}"
        flat = " without changing its sign" if self.flat else ""
        value = f"{measured(self.curvature, self.error)}{flat}"
        return f"{self.kind} of the {self.quantity} at {point(self.point)}: {value}; {proved}"

    def entry(self) -> Entry:
        """The place in a report."""
        value = "" if self.kind == "inflection" else measured(self.curvature, self.error)
        row = point(self.point), self.kind, self.quantity, value, yes_or_no(self.proved)
        return Entry(str(self), self.proved, row)


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
class FairnessReport(Report):
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

    def __repr__(self) -> str:
        return f"<FairnessReport of a {self.kind}, {self.verdict}, {len(self.extrema)} extrema>"

    def document(self) -> Document:
        """All that the report says."""
        rows = [row for bounds in self.curvatures for row in bounds.rows()]
        measures = {
            name: {"value": measure.value, "estimated_error": measure.error} for name, measure in self.measures.items()
        }
        data = {
            "kind": self.kind,
            "coordinates": self.coordinates,
            "letters": self.smoothness.letters,
            "curvatures": self.curvatures,
            "extrema": self.extrema,
            "inflections": self.inflections,
            "complete": self.complete,
            "constant": self.constant,
            "measures": measures,
        }
        return Document(
            "fairness-report",
            self._headline(),
            self.verdict,
            self.continuity,
            sentences=tuple(self._sentences()),
            statements=tuple(Sentence(*statement) for statement in self.statements),
            tables=(Tabular(HEADER, tuple(rows)),),
            entries=tuple(one.entry() for one in (*self.extrema, *self.inflections)),
            columns=COLUMNS,
            most=LISTED,
            data=data,
        )

    def _headline(self) -> Sentence:
        """The verdict on smoothness, and of what."""
        smoothness = self.smoothness
        what = {"curve": "the boundary", "body": "the surface"}.get(self.kind, "the surface of revolution")
        subject = within(what, smoothness.cover.bounds, letters_text(smoothness.letters))
        known = self.continuity != UNKNOWN
        count = plural(len(smoothness.defects), "place")
        places = f", {'broken' if known else 'in doubt'} at {count}" if smoothness.defects else ""
        is_known = f"{subject} is {self.continuity}" if known else f"how smooth {subject} is, is not known"
        return Sentence(f"{self.verdict}: {is_known}{places}.", smoothness.document().headline.proved)

    def _sentences(self) -> Iterator[Sentence]:
        between = " between the defects" if self.smoothness.defects else ""
        for bounds, constant in zip(self.curvatures, self.constant, strict=True):
            if constant:
                yield Sentence(f"The {bounds.name} is constant{between}; this is proved.", True)
        yield self._extrema_sentence()
        if self.measures:
            told = [f"{MEASURES[name]} {measured(one.value, one.error)}" for name, one in self.measures.items()]
            yield Sentence(f"Numerically: {', '.join(told)}.", False)

    def _extrema_sentence(self) -> Sentence:
        """How many there are, and whether these are all."""
        if all(self.constant):
            return Sentence("Every point is an extremum of the curvature.", True)
        counts = Counter(one.kind for one in self.extrema)
        words = [plural(counts[kind], kind, many) for kind, many in KINDS.items() if counts[kind]]
        if self.kind != "body":
            words.append(plural(len(self.inflections), "inflection") if self.inflections else "no inflection")
        what = "curvature has" if len(self.curvatures) == 1 else "curvatures have"
        all_of_them = "these are all, which is proved" if self.complete else "there may be more"
        smooth = not (self.smoothness.defects or getattr(self.smoothness, "joints", ()))
        start = "The" if smooth else "Between joints the"
        return Sentence(f"{start} {what} {listed(words or ['no isolated extremum'])}; {all_of_them}.", self.complete)
