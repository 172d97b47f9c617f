"""What a plane polynomial curve is at a rational point, proved from its half-branches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import sympy as sp

from rsym.verify.half_branches import HalfBranch, half_branches
from rsym.verify.report import Joint


def classify_polynomial(
    polynomial: sp.Expr, symbols: Sequence[sp.Symbol], point: Sequence[sp.Rational | Fraction | int]
) -> Joint | None:
    """The kind of point that w = 0 has at an exact rational point, w a polynomial with rational coefficients.

    w is moved to the origin and split into square-free factors; those of odd multiplicity change their sign across
    their zeros, those of even multiplicity do not. Newton's polygon (`half_branches`) finds the half-branches of both:

    - none: an isolated point; none with a change of sign: "no sign change"; three or more: a node;
    - two: by Puiseux's theorem they are the two halves t > 0 and t < 0 of one real branch (t^n, psi(t)), so they lie
      along one tangent: in the same direction (cusp) or in opposite ones. The latter are one analytic arc if a power
      series goes through the point; else the first fractional exponent e of v = c_1 u + c_2 u^2 + ... + c u^e
      decides: curvature unbounded (e < 2), continuous (e > 2), with a continuous derivative (e > 3).

    Every answer is proved; None where w is no such polynomial, does not vanish at the point, or needs an irrational
    multiple root.

    Sources: Walker, Algebraic Curves (1950), ch. IV; Brieskorn and Knörrer, Plane Algebraic Curves (1986), § 8.3.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> joint = classify_polynomial(y**3 - x**5, (x, y), (0, 0))
    >>> joint.kind, joint.continuity, joint.branches, joint.proved
    ('unbounded curvature', 'G1', 2, True)
    >>> classify_polynomial((x**2 + y**2) ** 2 - x**2 + y**2, (x, y), (0, 0)).branches
    4
    """
    exact = [sp.Rational(value) for value in point]
    split = _signed_parts(polynomial, symbols, exact)
    if split is None:
        return None
    crossing, touching = (half_branches(part) for part in split)
    if crossing is None or touching is None or len(crossing) % 2:
        return None
    count = len(crossing) + len(touching)
    place = tuple(float(value) for value in exact)
    radius = max(float(abs(sp.Rational(near) - value)) for near, value in zip(place, exact, strict=True))
    joint = Joint(place, 2 * radius, "node", "broken", branches=count, proved=True)
    if count == 0:
        return replace(joint, kind="isolated point", reason="no real half-branch ends here")
    if not crossing:
        return replace(joint, kind="no sign change", reason="w has an even power of a factor as its only zeros")
    if count > 2:
        touched = f", {len(touching)} of them without a change of sign" if touching else ""
        return replace(joint, reason=f"{count} half-branches{touched}")
    return _paired(joint, *crossing)


def _signed_parts(
    polynomial: sp.Expr, symbols: Sequence[sp.Symbol], point: Sequence[sp.Rational]
) -> tuple[sp.Poly, sp.Poly] | None:
    """Square-free polynomials, zero at the origin where w at `point` is: with the sign of w, and without a sign."""
    expression = sp.sympify(polynomial)
    # A float is its exact binary value; left to itself SymPy rounds it to a near fraction.
    expression = expression.xreplace({number: sp.Rational(number) for number in expression.atoms(sp.Float)})
    try:
        whole = sp.Poly(expression, *symbols, domain=sp.QQ)
    except (sp.PolynomialError, sp.CoercionFailed):
        return None
    shifted = whole.shift_list(list(point))
    if shifted.is_zero or shifted.eval((0, 0)) != 0:
        return None
    constant, factors = shifted.sqf_list()
    odd = sp.Poly(sp.sign(constant), *symbols, domain=sp.QQ)
    even = sp.Poly(1, *symbols, domain=sp.QQ)
    for factor, multiplicity in factors:
        height = factor.eval((0, 0))
        if multiplicity % 2:
            odd *= factor if height == 0 else sp.sign(height)
        elif height == 0:
            even *= factor
    return odd, even


def _paired(joint: Joint, first: HalfBranch, second: HalfBranch) -> Joint | None:
    """The two halves of one real branch; None if they contradict each other, which would be a mistake here."""
    arriving, leaving = sorted((first, second), key=lambda half: half.leaving)
    consistent = leaving.leaving and not arriving.leaving and first.swapped == second.swapped
    if not consistent or first.smooth != second.smooth:
        return None
    before, after = -_curvature(arriving), _curvature(leaving)
    jump = math.inf if math.inf in (abs(before), abs(after)) else abs(after - before)
    error = 4 * math.ulp(max(abs(before), abs(after))) if math.isfinite(jump) else math.nan
    joint = replace(
        joint, curvatures=(before, after), curvature_jump=jump, curvature_jump_error=error, tangent_jump_error=0.0
    )
    if first.sense == second.sense:
        reason = "both half-branches leave in the same direction"
        return replace(joint, kind="cusp", continuity="G0", tangent_jump=180.0, reason=reason)
    return _passing(replace(joint, tangent_jump=0.0), first, second)


def _passing(joint: Joint, first: HalfBranch, second: HalfBranch) -> Joint | None:
    """A branch that goes on in its direction: analytic, or as smooth as its first fractional exponent allows."""
    if first.smooth:
        joint = replace(joint, curvatures=(joint.curvatures[0],) * 2)
        reason = "one power series runs through the point"
        return _agreeing(joint, "analytic", 0.0, reason)
    broken = [half.fractional for half in (first, second)]
    exponents = {term[0] for term in broken if term is not None}
    if len(exponents) != 1:
        return None
    exponent = exponents.pop()
    reason = f"the first fractional exponent of the branch is {exponent}"
    if exponent < 2:
        return replace(joint, kind="unbounded curvature", continuity="G1", reason=reason)
    # Below the first fractional exponent all coefficients are exact.
    for order in (1, 2, 3)[: int(exponent)]:
        if first.coefficient(order) != (-1) ** order * second.coefficient(order):
            return None
    return _agreeing(joint, "G2", math.inf, reason) if exponent < 3 else _agreeing(joint, "G3", 0.0, reason)


def _agreeing(joint: Joint, continuity: str, derivative_jump: float, reason: str) -> Joint:
    """A joint whose one-sided curvatures are equal."""
    error = 0.0 if math.isfinite(derivative_jump) else math.nan
    return replace(
        joint,
        kind="smooth joint",
        continuity=continuity,
        curvature_jump=0.0,
        curvature_jump_error=0.0,
        derivative_jump=derivative_jump,
        derivative_jump_error=error,
        reason=reason,
    )


def _curvature(half: HalfBranch) -> float:
    """The limit of the curvature as one leaves the point: 2 c_2/(1 + c_1^2)^(3/2), infinite below exponent two."""
    if half.fractional is not None and half.fractional[0] < 2:
        return math.copysign(math.inf, half.turning * half.fractional[1])
    return float(half.turning * 2 * half.coefficient(2) / (1 + half.coefficient(1) ** 2) ** sp.Rational(3, 2))
