"""What a plane zero set is at a point, from one-sided limits along its branches: high precision, not proof."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import mpmath as mp
from mpmath import mpf

from rsym.verify.answers.report import Joint
from rsym.verify.points.branches import Branch, Ends, one_sided
from rsym.verify.points.circles import CircleZeros, zeros_on_circle
from rsym.verify.points.extrapolation import Limit

# Twelve halvings from one hundredth leave 15 digits of a series in square roots and all digits of a power series.
CIRCLES = 14
FEWEST_CIRCLES = 7
# Circles stay this many times larger than what is not known of the centre.
CLEARANCE = mpf(1000)
# Expanded polynomials cancel to the power of the radius: a triple point needs 18 digits more at one millionth.
GUARD = 25
# A jump counts if it exceeds its estimated error this many times; no jump is claimed with an error above TOLERANCE.
DOUBT = 10
TOLERANCE = mpf("1e-6")


@dataclass(frozen=True)
class Sample:
    """w and its derivatives at a point: (w_x, w_y), (w_xx, w_xy, w_yy), (w_xxx, w_xxy, w_xyy, w_yyy) or None.

    Examples
    --------
    >>> Sample(mpf(1), (mpf(0), mpf(2)), (mpf(0), mpf(0), mpf(2))).third is None
    True
    """

    value: mpf
    gradient: tuple[mpf, mpf]
    hessian: tuple[mpf, mpf, mpf]
    third: tuple[mpf, mpf, mpf, mpf] | None = None


Field = Callable[[mpf, mpf], Sample]


def classify(
    field: Field,
    centre: tuple[mpf, mpf],
    radius: float,
    *,
    digits: int = 50,
    value: Callable[[mpf, mpf], mpf] | None = None,
    reach: float = 1e-2,
) -> Joint:
    """What the zero set of `field` is at `centre`, which is known to within `radius`.

    The zeros of w on circles around the centre, r_k = reach 2^-k, are its branches. On each branch, with the inside
    w > 0 on the left, the tangent t = (w_y, -w_x)/|grad w|, the curvature
    kappa = -(w_xx w_y^2 - 2 w_xy w_x w_y + w_yy w_x^2)/|grad w|^3 and dkappa/ds are extrapolated to r = 0;
    the turn goes from the tangent of the arriving branch to that of the leaving one. `value` gives w alone, faster.

    Nothing here is proved: joint.proved is False. Circles stay 1000 times larger than `radius`, and what it does
    to a limit is part of its error. Below seven circles that agree in their branches the answer is "unresolved".

    Examples
    --------
    >>> def parabola(x, y):
    ...     kink = max(x, mpf(0))
    ...     return Sample(y - kink**2, (-2 * kink, mpf(1)), (mpf(-2 if x > 0 else 0), mpf(0), mpf(0)))
    >>> joint = classify(parabola, (mpf(0), mpf(0)), 0.0, digits=30)
    >>> joint.kind, joint.continuity, round(joint.curvature_jump, 12)
    ('curvature jump', 'G1', 2.0)
    """
    with mp.workdps(digits + GUARD):
        centre = (mpf(centre[0]), mpf(centre[1]))
        radii = [mpf(reach) / 2**k for k in range(CIRCLES) if mpf(reach) / 2**k > CLEARANCE * mpf(radius)]
        heights = value or (lambda x, y: field(x, y).value)
        circles = [zeros_on_circle(heights, centre, r, digits) for r in radii]
        joint = Joint((float(centre[0]), float(centre[1])), float(radius), "unresolved", "unknown", branches=0)
        steady = _steady(circles)
        if len(steady) < FEWEST_CIRCLES:
            counts = ", ".join(str(len(c.crossings) + len(c.touches)) for c in circles) or "none"
            return replace(joint, reason=f"the branches on successive circles do not settle: {counts}")
        return _judged(joint, steady, Ends(field, centre, mpf(radius), digits))


def _signature(circle: CircleZeros) -> tuple[int, int, int, int, bool]:
    rising = sum(up for _, up in circle.crossings)
    return len(circle.crossings), rising, len(circle.touches), circle.edges, circle.vanishing


def _steady(circles: list[CircleZeros]) -> list[CircleZeros]:
    """The smallest circles, as far out as they agree in number and kind of their zeros."""
    steady = circles[-1:]
    for circle in reversed(circles[:-1]):
        if _signature(circle) != _signature(steady[0]):
            break
        steady.insert(0, circle)
    return steady


def _judged(joint: Joint, circles: list[CircleZeros], ends: Ends) -> Joint:
    """The kind of point, by the number of branches."""
    last, doubt = circles[-1], joint
    joint = replace(joint, continuity="broken")
    crossings, touches = len(last.crossings), len(last.touches)
    joint, doubt = (replace(one, branches=crossings + touches) for one in (joint, doubt))
    side = "inside" if last.inside else "outside"
    if last.vanishing:
        return replace(doubt, reason="w vanishes on an area")
    if joint.branches == 0 and not last.edges:
        if _vanishes(circles):
            return replace(joint, kind="isolated point", reason=f"all around it is {side}")
        return replace(doubt, reason="w does not vanish at the centre")
    if crossings == 0 and touches:
        return replace(joint, kind="no sign change", reason=f"w is zero on a line; both its sides are {side}")
    if last.edges:
        return replace(joint, kind="end", reason="the domain of w ends here, or w jumps over zero")
    branches = one_sided(circles, ends)
    if joint.branches != 2:
        angles = ", ".join(f"{round(float(mp.degrees(branch.bearing)), 6) % 360:g}" for branch in branches)
        touched = f"; on {touches} more branches w does not change its sign" if touches else ""
        return replace(joint, kind="node", reason=f"branches leave at {angles} degrees{touched}")
    arriving, leaving = sorted(branches, key=lambda branch: branch.leaving)
    return _joined(joint, arriving, leaving)


def _vanishes(circles: list[CircleZeros]) -> bool:
    """Whether w tends to zero at the centre: like a power of the radius, or as good as that."""
    rates = [mp.log(before.least / after.least, 2) for before, after in pairwise(circles) if after.least > 0]
    return not rates or bool(rates[-1] > mpf("0.05"))


def _joined(joint: Joint, arriving: Branch, leaving: Branch) -> Joint:
    """Two branches: compare what they bring to the point, from the tangent on."""
    turn = leaving.tangent.value - arriving.tangent.value
    turn -= 2 * mp.pi * mp.nint(turn / (2 * mp.pi))
    error = arriving.tangent.error + leaving.tangent.error
    joint = replace(
        joint,
        tangent_jump=float(mp.degrees(abs(turn))),
        tangent_jump_error=float(mp.degrees(error)),
        curvatures=(float(arriving.curvature.value), float(leaving.curvature.value)),
    )
    joint = _with_curvatures(joint, arriving, leaving)
    if not error < TOLERANCE:
        return replace(joint, reason="the tangents do not converge well enough")
    if mp.pi - abs(turn) <= DOUBT * error:
        return replace(joint, kind="cusp", continuity="G0", reason="both branches leave in the same direction")
    if abs(turn) > DOUBT * error:
        return replace(joint, kind="corner", continuity="G0", reason="convex" if turn > 0 else "reentrant")
    return _smoothly_joined(joint)


def _with_curvatures(joint: Joint, arriving: Branch, leaving: Branch) -> Joint:
    """Add the jumps of curvature and of its derivative, as far as both limits are finite."""
    jump, error = _jump(arriving.curvature, leaving.curvature)
    derivative, derivative_error = _jump(arriving.slope, leaving.slope)
    return replace(
        joint,
        curvature_jump=jump,
        curvature_jump_error=error,
        derivative_jump=derivative,
        derivative_jump_error=derivative_error,
    )


def _jump(before: Limit, after: Limit) -> tuple[float, float]:
    """The size of the difference of two limits and its error; infinite where one is, NaN where nothing is known."""
    if before.finite and after.finite:
        return float(abs(after.value - before.value)), float(before.error + after.error)
    return math.inf if mp.isinf(before.value) or mp.isinf(after.value) else math.nan, math.nan


def _smoothly_joined(joint: Joint) -> Joint:
    """The tangents agree: the curvature decides, then its derivative."""
    jump, error = joint.curvature_jump, joint.curvature_jump_error
    scale = 1 + max((abs(k) for k in joint.curvatures), default=0.0)
    if jump == math.inf:
        reason = "the curvature grows without bound towards the point"
        return replace(joint, kind="unbounded curvature", continuity="G1", reason=reason)
    if jump > DOUBT * error:
        return replace(joint, kind="curvature jump", continuity="G1", reason="one-sided curvatures differ")
    if not error < TOLERANCE * scale:
        return replace(joint, continuity="G1", reason="the curvatures do not converge well enough")
    jump, error = joint.derivative_jump, joint.derivative_jump_error
    third = jump <= DOUBT * error and error < float(TOLERANCE) * (1 + scale)
    reason = f"curvatures agree to {joint.curvature_jump_error:.1e}"
    return replace(joint, kind="smooth joint", continuity="G3" if third else "G2", reason=reason)
