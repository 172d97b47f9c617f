"""Edges whose parameters run at different speeds: one parameter as an exact function of the other.

A curve c(s) is inverted by linear forms of its coordinates, s = a.(c, 1)/b.(c, 1), wherever there are such: lines,
conics, and the curves of higher degree that are not flat. With c1(t) = c(s) this makes s a rational function of the
coordinates of the other edge. Where both are written with one function, as cos(g(t)) and cos(h(s)), s comes from
g(t) = h(s). What is found is a guess; the patch is then written with it, s = phi(t), and everything is proved of that.

phi maps the stretch of one edge on that of the other if it has the right values at both ends, exactly, and its
derivative is not zero between, which balls enclose.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import sympy as sp

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all
from rsym.surfaces.functions.formulas import exact as decimal
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.proofs.algebra import exact_values
from rsym.surfaces.proofs.edge_formulas import PatchFormula, constant_parameter, formula_of
from rsym.surfaces.proofs.enclosures import BITS
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part
from rsym.surfaces.proofs.stretches import ProofTask, ends_of
from rsym.surfaces.symbols import u, v

# Curves of a higher degree are not inverted.
MOST_DEGREE = 8
# A guess is off by less than this share of the interval at all samples, or it is none.
NEAR = 1e-6
# Intervals on which the derivative is enclosed, each half of one before.
DEEPEST = 8
# Functions that are told apart by their arguments where they are equal.
OUTER = (sp.sin, sp.cos, sp.exp, sp.tan, sp.sinh, sp.tanh, sp.log, sp.atan)
ALONG = sp.Symbol(PARAMETER, real=True)


def evened(task: ProofTask) -> Iterator[tuple[ProofTask, bool, sp.Expr]]:
    """The same edges with one parameter, for each way that is found; whether they change places; and t of the new one.

    Raises
    ------
    NoProof
        A patch is not made of formulas.
    """
    curves = [_curve(formula, edge) for formula, edge in zip(task.formulas, task.edges, strict=True)]
    (low, high), (start, stop) = ends_of(task.stretch)
    samples = np.asarray(task.stretch.t), np.asarray(task.stretch.s)
    for swapped in (False, True):
        one, other = curves[::-1] if swapped else curves
        here, there = samples[::-1] if swapped else samples
        part, ends = ((start, stop), (low, high)) if swapped else ((low, high), (start, stop))
        for guess in _guesses(one, other):
            if _fits(guess, here, there) and _maps(guess, part, ends):
                yield _rewritten(task, guess, part, swapped=swapped), swapped, guess
                break


def _curve(formula: PatchFormula, edge: PatchEdge) -> list[sp.Expr]:
    """The coordinates of an edge as functions of its parameter."""
    across, along = (u, v) if edge.across == 0 else (v, u)
    values = {across: constant_parameter(edge), along: ALONG}
    return [sp.sympify(one).subs(values, simultaneous=True) for one in _numbers(formula)]


def _numbers(formula: PatchFormula) -> list[sp.Expr]:
    """The formula of a patch with numbers for its letters."""
    letters = {name: sp.Rational(value.numerator, value.denominator) for name, value in formula.letters.items()}
    entries = formula_of(formula.patch)
    values = {symbol: letters[symbol.name] for one in entries for symbol in one.free_symbols if symbol.name in letters}
    return [one.xreplace(values) for one in entries]


def _guesses(one: Sequence[sp.Expr], other: Sequence[sp.Expr]) -> Iterator[sp.Expr]:
    """What the parameter of the other curve may be, as a function of that of the first."""
    for forms in _inverses(other):
        above, below = (sum((c * x for c, x in zip(form, [*one, 1], strict=True)), sp.Integer(0)) for form in forms)
        if sp.expand(below) != 0:
            yield sp.cancel(above / below) if above.is_rational_function(ALONG) else above / below
    yield from _square_roots(one, other)
    for function in OUTER:
        for inner in _arguments(function, other):
            slope = sp.diff(inner, ALONG)
            if slope.is_number and slope != 0:
                for outer in _arguments(function, one):
                    yield sp.expand((outer - inner.subs(ALONG, 0)) / slope)


def _square_roots(one: Sequence[sp.Expr], other: Sequence[sp.Expr]) -> Iterator[sp.Expr]:
    """From a coordinate that is quadratic in the parameter of the other curve."""
    for x, entry in zip(one, other, strict=True):
        if entry.is_polynomial(ALONG) and sp.degree(entry, ALONG) == 2:
            a, b, c = sp.Poly(entry, ALONG).all_coeffs()
            root = sp.sqrt(sp.expand(b**2 - 4 * a * (c - x)))
            yield from ((-b + root) / (2 * a), (-b - root) / (2 * a))


def _arguments(function: type[sp.Function], curve: Sequence[sp.Expr]) -> list[sp.Expr]:
    found = {part.args[0] for entry in curve for part in entry.atoms(function)}
    return sorted((one for one in found if one.has(ALONG)), key=sp.default_sort_key)


def _inverses(curve: Sequence[sp.Expr]) -> Iterator[tuple[list[sp.Expr], list[sp.Expr]]]:
    """Linear forms a, b of (x, y, z, 1) with a = t b along a rational curve of rational numbers."""
    if not all(one.is_rational_function(ALONG) for one in curve):
        return
    whole = [sp.fraction(sp.together(one)) for one in curve]
    below = sp.lcm_list([denominator for _, denominator in whole])
    entries = [sp.cancel(above * below / denominator) for above, denominator in whole]
    try:
        rows = [sp.Poly(one, ALONG, domain="QQ") for one in (*entries, below)]
    except sp.PolynomialError:  # other numbers than rational ones
        return
    degree = max(one.degree() for one in rows) + 1
    if degree > MOST_DEGREE:
        return
    columns = [*rows, *(-one * sp.Poly(ALONG, ALONG, domain="QQ") for one in rows)]
    matrix = sp.Matrix([[column.coeff_monomial(ALONG**k) for column in columns] for k in range(degree + 1)])
    vectors = matrix.nullspace()
    # A denominator that vanishes somewhere on the curve may not do so in a sum.
    for vector in (*vectors, *(a + b for a, b in combinations(vectors, 2))):
        first, second = list(vector[:4]), list(vector[4:])
        if not sum((c * row for c, row in zip(second, rows, strict=True)), rows[0] * 0).is_zero:
            yield first, second


def _fits(guess: sp.Expr, here: np.ndarray, there: np.ndarray) -> bool:
    """Whether samples agree with a guess."""
    with np.errstate(all="ignore"):
        values = np.array(sp.lambdify(ALONG, guess, "numpy")(here), np.float64) + 0 * here
    return bool(np.isfinite(values).all() and np.abs(values - there).max() <= NEAR * np.ptp(there))


def _maps(guess: sp.Expr, part: Part, ends: Part) -> bool:
    """Whether a function takes a part onto another one, end to end and one to one."""
    target = Builder((PARAMETER,), ())
    try:
        nodes = lower_all(target, [guess.xreplace({ALONG: sp.Symbol(PARAMETER)})])
        for place, end in zip(part, ends, strict=True):
            (value,) = exact_values(target.nodes, nodes, place)
            if not (value - value.field.rational(end)).is_zero:
                return False
    except NoProof:
        return False
    return _is_monotone(SeriesFunction(target.nodes, nodes), part)


def _is_monotone(function: SeriesFunction, part: Part) -> bool:
    """Whether the derivative is enclosed away from zero on all of a part."""
    waiting = [(*part, 0)]
    with truncated(1, BITS):
        while waiting:
            low, high, depth = waiting.pop()
            (value,) = function(ball(exact(low), exact(high)))
            if value is not None and (value[1] > arb(0) or value[1] < arb(0)):
                continue
            if depth == DEEPEST:
                return False
            middle = (low + high) / 2
            waiting += [(low, middle, depth + 1), (middle, high, depth + 1)]
    return True


def _rewritten(task: ProofTask, guess: sp.Expr, part: Part, *, swapped: bool) -> ProofTask:
    """The task with the second patch written by the parameter of the first, or the other way round."""
    formulas, edges = task.formulas, task.edges
    (kept, formula), (stays, edge) = (formulas[::-1], edges[::-1]) if swapped else (formulas, edges)
    along = v if edge.across == 0 else u
    point = [one.subs(along, guess.subs(ALONG, along)) for one in map(sp.sympify, _numbers(formula))]
    ends = [decimal(end) for end in edge.patch.domain[edge.across]]
    ends[int(edge.upper)] = constant_parameter(edge)
    interval = tuple(sp.Rational(end.numerator, end.denominator) for end in sorted(part))
    domain = (tuple(ends), interval) if edge.across == 0 else (interval, tuple(ends))
    surface = ParametricSurface(point, domain)
    worst = task.worst
    if swapped:
        back = np.interp(task.worst, task.stretch.t, task.stretch.s) if len(task.worst) else np.array([])
        worst = [min(max(float(one), float(min(part))), float(max(part))) for one in back]
    written = PatchFormula(surface, {})
    even = (stays, PatchEdge(surface, edge.name)), (min(part), max(part))
    return replace(task, formulas=(kept, written), worst=worst, even=even)


def place_of(guess: sp.Expr, place: float) -> float:
    """The value of the function at a place, as a float; NaN of NaN."""
    return float(guess.subs(ALONG, sp.Rational(str(Fraction(place))))) if math.isfinite(place) else math.nan
