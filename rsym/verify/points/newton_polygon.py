"""What a plane polynomial curve is at a rational point, proved from its half-branches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import sympy as sp

from rsym.verify.answers.report import Joint


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


# Half-branches of a plane polynomial curve at a rational point, proved by Newton's polygon.
# Every step but the last resolves a multiple root; E8 needs one, A_2k in general position k. More is given up.
MOST_STEPS = 12
# Irrational coefficients are only shown, never compared: their width is below that of a float.
WIDTH = sp.Rational(1, 10**25)

Term = tuple[sp.Rational, sp.Rational]


@dataclass(frozen=True)
class HalfBranch:
    """v = sum c_i tau^e_i for small tau > 0, where (u, v) = (sense*tau, v) is (x, y), or (y, x) if `swapped`.

    terms are (e_i, c_i), e_i >= 1 and rising, complete below the first fractional exponent, or up to the last one
    given; smooth says that the same power series in u goes on through the point. `above` is the sign of the
    polynomial on the side where v is larger. The last coefficient is rounded if it is irrational.

    Examples
    --------
    >>> cusp = HalfBranch(False, 1, ((sp.Rational(3, 2), sp.Integer(-1)),), False, 1)
    >>> cusp.fractional, cusp.coefficient(2), cusp.leaving
    ((3/2, -1), 0, True)
    """

    swapped: bool
    sense: int
    terms: tuple[Term, ...]
    smooth: bool
    above: int

    @cached_property
    def fractional(self) -> Term | None:
        """The first term with a fractional exponent."""
        return next((term for term in self.terms if not term[0].is_Integer), None)

    def coefficient(self, order: int) -> sp.Rational:
        """The coefficient of tau^order."""
        return dict(self.terms).get(sp.Integer(order), sp.Integer(0))

    @property
    def turning(self) -> int:
        """1 if larger v lies to the left as one leaves the point, else -1."""
        return -self.sense if self.swapped else self.sense

    @property
    def leaving(self) -> bool:
        """Whether the side where the polynomial is positive is on the left as one leaves the point."""
        return self.above * self.turning > 0

    @property
    def direction(self) -> tuple[sp.Rational, sp.Rational]:
        """The tangent, as one leaves the point."""
        u, v = sp.Integer(self.sense), self.coefficient(1)
        return (v, u) if self.swapped else (u, v)

    def mirrored(self) -> HalfBranch:
        """The same half-branch with u counted backwards."""
        return replace(self, sense=-self.sense)


def half_branches(polynomial: sp.Poly) -> list[HalfBranch] | None:
    """All half-branches at the origin of f(x, y) = 0, f square-free with rational coefficients; None if not found.

    For u > 0 every real zero near the origin with v = O(u) lies on a half-branch v = c u^(p/q) (1 + o(1)), where
    -q/p is the slope of a compact edge of Newton's polygon and c a real root of its edge polynomial phi, or on v = 0.
    With u = t^q, v = t^p (c + w), f = t^N (phi(c + w) + t (...)): if c is a simple root, the implicit
    function theorem gives exactly one such half-branch, w analytic in t, and f has the sign of phi'(c) above it. At a
    multiple rational root the polynomial in (t, w) is treated again; at a multiple irrational one nothing is claimed.
    Roots are counted and isolated exactly. Zeros with u = o(v) are found with x and y exchanged.

    Sources: Walker, Algebraic Curves (1950), ch. IV; Brieskorn and Knörrer, Plane Algebraic Curves (1986), § 8.3.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> [branch.terms for branch in half_branches(sp.Poly(y**2 - x**3, x, y))]
    [((3/2, -1),), ((3/2, 1),)]
    >>> half_branches(sp.Poly(x**2 + y**2, x, y))
    []
    """
    found: list[HalfBranch] = []
    x, y = polynomial.gens
    for swapped in (False, True):
        for sense in (1, -1):
            first, second = (y, x) if swapped else (x, y)
            powers = {(j, i) if swapped else (i, j): a for (i, j), a in polynomial.terms()}
            turned = _poly({(i, j): a * sense**i for (i, j), a in powers.items()}, first, second)
            series = _series(turned, sp.Integer(0), sp.Integer(1), 0)
            if series is None:
                return None
            found += [
                HalfBranch(swapped, sense, terms, smooth, above)
                for terms, smooth, above in series
                if not terms or terms[0][0] > 1 or (terms[0][0] == 1 and not swapped)
            ]
    return found


Series = tuple[tuple[Term, ...], bool, int]


def _series(polynomial: sp.Poly, base: sp.Rational, ramification: sp.Integer, depth: int) -> list[Series] | None:
    """Half-branches v -> 0 for t > 0, as terms that begin beyond the exponent `base`; u = t^ramification."""
    if depth > MOST_STEPS:
        return None
    support = dict(polynomial.terms())
    found: list[Series] = []
    if min(j for _, j in support) > 0:
        lowest = min(i for i, j in support if j == 1)
        found.append(((), ramification == 1, int(sp.sign(support[lowest, 1]))))
    for p, q in _edges(list(support)):
        # Only v = O(u) counts in the end; the rest is found with the coordinates exchanged.
        if depth == 0 and p < q:
            continue
        ends = _on_edge(polynomial, p, q, base, ramification, depth)
        if ends is None:
            return None
        found += ends
    return found


def _edges(support: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """(p, q) in lowest terms of the compact edges q i + p j = N of the polygon."""
    lowest: dict[int, int] = {}
    for i, j in support:
        lowest[j] = min(i, lowest.get(j, i))
    # From the lowest power of v to the lowest power of u, always along the steepest way down in i.
    edges: list[tuple[int, int]] = []
    j = min(lowest)
    while True:
        rising = [
            (sp.Rational(lowest[j] - i, other - j), other) for other, i in lowest.items() if other > j and i < lowest[j]
        ]
        if not rising:
            return edges
        slope, j = max(rising)
        edges.append((int(slope.p), int(slope.q)))


def _on_edge(
    polynomial: sp.Poly, p: int, q: int, base: sp.Rational, ramification: sp.Integer, depth: int
) -> list[Series] | None:
    """Half-branches v = c t^(p/q) + ..., for every real root c of the edge polynomial."""
    v = polynomial.gens[1]
    weight = min(q * i + p * j for i, j in polynomial.monoms())
    on_edge = {j: a for (i, j), a in polynomial.terms() if q * i + p * j == weight}
    edge = _poly({(j - min(on_edge),): a for j, a in on_edge.items()}, v)
    exponent = base + sp.Rational(p, q) / ramification
    found: list[Series] = []
    for root, multiplicity, exact, sign in _real_roots(edge):
        term = (exponent, root)
        if multiplicity == 1:
            smooth = ramification * q == 1
            terms = (
                (term, (exponent + 1, _next(polynomial, root, weight + 1, edge)))
                if smooth and exponent == 1
                else (term,)
            )
            found.append((terms, smooth, sign))
        elif not exact:
            return None
        else:
            inner = _series(_shifted(polynomial, p, q, root, weight), exponent, ramification * q, depth + 1)
            if inner is None:
                return None
            found += [((term, *terms), smooth, above) for terms, smooth, above in inner]
    return found


def _poly(terms: dict[tuple[int, ...], sp.Rational], *symbols: sp.Symbol) -> sp.Poly:
    return sp.Poly.from_dict(terms, *symbols, domain=sp.QQ)


def _shifted(polynomial: sp.Poly, p: int, q: int, root: sp.Rational, weight: int) -> sp.Poly:
    """f(t^q, t^p (c + v)) / t^N."""
    t, v = polynomial.gens
    result: Any = _poly({}, t, v)
    beside = _poly({(0, 1): sp.Integer(1), (0, 0): root}, t, v)
    for (i, j), coefficient in polynomial.terms():
        result += _poly({(q * i + p * j - weight, 0): coefficient}, t, v) * beside**j
    return result


def _next(polynomial: sp.Poly, root: sp.Rational, weight: int, edge: sp.Poly) -> sp.Rational:
    """The coefficient w_1 of w = w_1 t + ... at a simple root of an edge with p = q = 1: phi'(c) w_1 + (...) = 0."""
    beside = sum((a * root**j for (i, j), a in polynomial.terms() if i + j == weight), sp.Integer(0))
    return -beside / edge.diff().eval(root)


def _real_roots(edge: sp.Poly) -> list[tuple[sp.Rational, int, bool, int]]:
    """(root, multiplicity, whether it is exact, sign just above if it is simple) of all real roots."""
    found = []
    for (low, high), multiplicity in edge.intervals(eps=WIDTH):
        rational = _rational_root(edge, low, high)
        root = (low + high) / 2 if rational is None else rational
        # An end of the interval may be a neighbouring root; a simple root has opposite signs on its two sides.
        above = edge.diff().eval(root) if rational is not None else edge.eval(high) or -edge.eval(low)
        found.append((root, multiplicity, rational is not None, int(sp.sign(above))))
    return found


def _rational_root(edge: sp.Poly, low: sp.Rational, high: sp.Rational) -> sp.Rational | None:
    """The root in an isolating interval, if it is rational."""
    if low == high:
        return low
    for factor, _ in edge.factor_list()[1]:
        if factor.degree() == 1:
            root = -factor.nth(0) / factor.nth(1)
            if low < root < high:
                return root
    return None
