"""A verdict in words: one paragraph, then a line for each place that decides it, the worst first."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, Context
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rsym.verify.bodies.report import BodyReport
    from rsym.verify.report import Joint, SmoothnessReport

# A double says nothing beyond so many digits, and an error below them is not worth a word.
DIGITS = 12
# Values of so many letters are a sentence; of more only the first few are told.
MOST_LETTERS, FIRST_LETTERS = 8, 3
PLAIN: Mapping[str, str] = {
    "cusp": "the boundary runs back on itself",
    "unbounded curvature": "the curvature grows without bound",
    "isolated point": "the boundary is a single point",
    "end": "the boundary ends",
    "no sign change": "omega is zero but does not change its sign",
    "unresolved": "what happens here is not resolved",
}


def report_text(report: SmoothnessReport) -> str:
    """The whole report.

    Examples
    --------
    >>> import numpy as np
    >>> from rsym.verify.report import Cover, SmoothnessReport
    >>> none = np.empty((0, 2, 2))
    >>> cover = Cover(((-2, 2), (-2, 2)), np.ones((7, 2, 2)), none, none, 40)
    >>> print(report_text(SmoothnessReport("CERTIFIED", "analytic", (), (), 1.5, cover, {"r": (1.0, 2.0)})))
    CERTIFIED: the boundary within [-2, 2] x [-2, 2], for every r in [1, 2], is analytic; this is proved. \
40 boxes were examined; where they prove the boundary regular, no curvature exceeds 1.5.
    """
    lines = [" ".join(_sentences(report))]
    lines += [f"  {number}. {joint_text(joint)}" for number, joint in enumerate(report.defects, 1)]
    lines += [f"  also {joint_text(joint)}" for joint in report.joints]
    return "\n".join(lines)


def _sentences(report: SmoothnessReport) -> Iterator[str]:
    yield f"{headline(report)}."
    yield cover_text(report)
    yield from statement_sentences(report.statements)


def statement_sentences(statements: Sequence[tuple[str, bool]]) -> Iterator[str]:
    """What is proved in one sentence, what is numerical in another."""
    for proved, word in ((True, "Proved"), (False, "Numerical, not proved")):
        said = [sentence.rstrip(".") for sentence, status in statements if status == proved]
        if said:
            yield f"{word}: {'; '.join(said)}."


def headline(report: SmoothnessReport) -> str:
    """The verdict, of which body with which letters, and whether it is proved."""
    what = "the surface of revolution with the meridian" if report.body else "the boundary"
    return verdict_text(report, what, "curve")


def verdict_text(report: SmoothnessReport | BodyReport, what: str, expected: str) -> str:
    """A verdict on what should be such a curve or surface."""
    letters = letters_text(report.letters, "some" if report.verdict in {"REFUTED", "DEGENERATE"} else "every")
    about = within(what, report.cover.bounds, letters)
    doubt = len(report.undecided) or any(not defect.proved for defect in report.defects)
    answers = {
        "CERTIFIED": f"{about} is {report.continuity}; this is proved",
        "REFUTED": f"{about} is not G2 but {'at best ' if doubt else ''}{report.continuity}; this is proved",
        "DEGENERATE": f"{about} is no {expected}, or not everywhere",
    }
    undecided = f"whether {about} is G2 is neither proved nor refuted"
    return f"{report.verdict}: {answers.get(report.verdict, undecided)}"


def within(what: str, bounds: Sequence[tuple[float, float]], letters: str) -> str:
    """What is spoken of: where, and with which letters.

    Examples
    --------
    >>> within("omega", ((-1, 1), (0, 2)), "with a = 5")
    'omega within [-1, 1] x [0, 2], with a = 5,'
    """
    box = " x ".join(f"[{number(low)}, {number(high)}]" for low, high in bounds)
    return f"{what} within {box}{f', {letters},' if letters else ''}"


def letters_text(letters: Mapping[str, tuple[float, float]], which: str = "every") -> str:
    """Letters that are intervals first: what is certified holds for every value in them, what is refuted for some.

    Of many values the first are told.

    Examples
    --------
    >>> letters_text({"a": (5.0, 5.0), "a2": (5.32, 8.0)})
    'for every a2 in [5.32, 8] with a = 5'
    >>> letters_text({f"a{k}": (k, k) for k in range(44)})
    'with a0 = 0, a1 = 1, a2 = 2 and 41 other letters'
    """
    ranges = [f"{name} in [{number(low)}, {number(high)}]" for name, (low, high) in letters.items() if low < high]
    values = [f"{name} = {number(low)}" for name, (low, high) in letters.items() if not low < high]
    of_ranges = f"for {which} {' and '.join(ranges)}" if ranges else ""
    if len(values) > MOST_LETTERS:
        values = [f"{', '.join(values[:FIRST_LETTERS])} and {len(values) - FIRST_LETTERS} other letters"]
    return " ".join(part for part in (of_ranges, f"with {', '.join(values)}" if values else "") if part)


def cover_text(report: SmoothnessReport) -> str:
    """How many boxes were examined, and what they say of the curvature."""
    examined = f"{plural(report.cover.examined, 'box was', 'boxes were')} examined"
    if not (math.isfinite(report.curvature_bound) and len(report.cover.certified)):
        return f"{examined}."
    bound = rounded_up(report.curvature_bound)
    return f"{examined}; where they prove the boundary regular, no curvature exceeds {bound}."


def joint_text(joint: Joint) -> str:
    """One place in a line.

    Examples
    --------
    >>> from rsym.verify.report import Joint
    >>> joint_text(Joint((1.0, 1.0), 0.0, "curvature jump", "G1", curvatures=(0.0, 1.0), curvature_jump=1.0))
    'curvature jump at (1, 1): the curvature jumps by 1, from 0 to 1; G1, not proved'
    """
    place = f"({', '.join(map(number, joint.point))})"
    near = f" within {rounded_up(joint.radius, 2)}" if joint.radius > significant(*joint.point) else ""
    reason = f"; {joint.reason.rstrip('.')}" if joint.reason else ""
    status = "proved" if joint.proved else "not proved"
    return f"{joint.kind} at {place}{near}: {effect(joint)}; {joint.continuity}, {status}{reason}"


def effect(joint: Joint) -> str:
    """What one sees, walking through the place along the boundary."""
    if joint.kind == "node":
        return f"{joint.branches} branches of the boundary meet"
    if joint.kind in PLAIN:
        return PLAIN[joint.kind]
    if joint.kind == "corner":
        turn = f"the tangent turns by {measured(joint.tangent_jump, joint.tangent_jump_error)} degrees"
        return f"{turn}, {_sides(joint)}" if _known(joint.curvatures) else turn
    if joint.kind == "curvature jump":
        jump = f"the curvature jumps by {measured(joint.curvature_jump, joint.curvature_jump_error)}"
        return f"{jump}, from {number(joint.curvatures[0])} to {number(joint.curvatures[1])}"
    if joint.derivative_jump > 0:
        jump = measured(joint.derivative_jump, joint.derivative_jump_error)
        return f"the curvature is continuous, its derivative jumps by {jump}"
    return "two arcs meet, the curvature is continuous"


def _sides(joint: Joint) -> str:
    first, second = map(number, joint.curvatures)
    return f"the curvature is {first} on both sides" if first == second else f"curvatures {first} and {second}"


def _known(values: Sequence[float]) -> bool:
    return all(map(math.isfinite, values))


def number(value: float) -> str:
    """A number as short as it can be, without a negative zero.

    Examples
    --------
    >>> number(5.32), number(-1e-30), number(-4.992121096289474)
    ('5.32', '-1e-30', '-4.99212109629')
    """
    return f"{value + 0.0:.{DIGITS}g}"


def measured(value: float, error: float) -> str:
    """A value and its error, as many digits as the error leaves, the error rounded up.

    Examples
    --------
    >>> measured(144.8117269, 2.3e-4), measured(144.811726903428, 1e-23), measured(1.0, math.nan)
    ('144.8117 ± 0.0003', '144.811726903', '1')
    >>> measured(-1e-25, 5e-25)
    '0 ± 6e-25'
    """
    if not math.isfinite(error) or error <= significant(value):
        return number(value)
    if abs(value) <= error:
        return f"0 ± {rounded_up(abs(value) + error, 1)}"
    places = max(0, -math.floor(math.log10(error)))
    return f"{value:.{places}f} ± {rounded_up(error + 0.5 * 10.0**-places, 1)}"


def rounded_up(value: float, digits: int = 4) -> str:
    """A bound in few digits that is still a bound.

    Examples
    --------
    >>> rounded_up(108.7101), rounded_up(1.5), rounded_up(2.3e-13), rounded_up(0.0)
    ('108.8', '1.5', '2.3e-13', '0')
    """
    if not math.isfinite(value) or value <= 0:
        return number(value)
    return f"{float(Context(digits, ROUND_CEILING).create_decimal(value)):.{digits}g}"


def significant(*values: float) -> float:
    """Half a unit in the last digit that `number` shows of the largest of some values."""
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    return 0.5 * 10.0 ** (math.floor(math.log10(largest)) + 1 - DIGITS) if largest > 0 else 0.0


def plural(count: int, one: str, many: str = "") -> str:
    """A count with its noun.

    Examples
    --------
    >>> plural(1, "box", "boxes"), plural(2, "place")
    ('1 box', '2 places')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"
