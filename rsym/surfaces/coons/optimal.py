"""Shape parameters that make a patch smoothest.

The energy is a quadratic in the parameter of either direction. Its minimum is found from the roots of polynomials,
all of them: there are no starting values and no steps. That the parameters of both families can be found so is our
observation; the thesis asks for them and stops.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.polynomial import Polynomial

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.requirements import require_kind
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.energies import BENDING, Weights, coefficients
from rsym.surfaces.parameters import LetterValues

Range: TypeAlias = tuple[float, float]

# An energy that changes by less over the whole range is flat: then the parameter stays what it was.
FLAT = 1e-12
# What counts as the whole range is at most so far away.
WIDE = 100.0


@dataclass(frozen=True)
class Optimum:
    """The best shape parameters of a patch, and the patch with them.

    Attributes
    ----------
    parameters : mapping
        The letters and their best values.
    clipped : tuple of str
        Those that stand at an end of their range.
    before, after : float
        The energy with the defaults, or the letters that were given, and the least energy.
    patch : BicubicCoons
        The patch with the best values as defaults of its letters.
    coefficients : ndarray
        (3, 3): the energy is the sum of coefficients[a, b] p**a q**b, p and q the parameters in u and in v.

    Examples
    --------
    >>> lam = sp.Symbol("lam")
    >>> bend = np.zeros((4, 4, 3))
    >>> bend[1, :, 2] = [1, 1, 0, 0]  # z = F1(u): the cubic bends least
    >>> best = optimal_parameters(BicubicCoons(bend, HermiteBlend.class1(lam, 1, letters={lam: 1})))
    >>> round(best.parameters["lam"], 9) + 0.0, best.clipped, best.after < best.before
    (0.0, (), True)
    """

    parameters: Mapping[str, float]
    clipped: tuple[str, ...]
    before: float
    after: float
    patch: BicubicCoons
    coefficients: Floats


def optimal_parameters(
    patch: BicubicCoons,
    parameters: Iterable[Any] | None = None,
    *,
    weights: Weights = BENDING,
    monotone: bool = True,
    letters: LetterValues = None,
) -> Optimum:
    """The shape parameters of least energy.

    Parameters
    ----------
    patch : BicubicCoons
        With blends whose shape parameter is a letter: one in u or in v, one in each direction, or one for both.
    parameters : iterable of names or symbols, optional
        The letters to choose; by default the shape parameters of both blends that are letters.
    weights : (w1, w2, w3)
        Of stretch, bending and jerk.
    monotone : bool
        Stay where F1 never decreases (`HermiteBlend.monotone_range`); the ranges of the letters hold in any case.
    letters : mapping, optional
        Values of the other letters.

    Examples
    --------
    >>> mu = sp.Symbol("mu")
    >>> blend = HermiteBlend.class2(mu, 0, letters={mu: 3})
    >>> step = np.zeros((4, 4, 3))
    >>> step[1, :, 2] = [1, 1, 0, 0]  # z = F1(u)
    >>> best = optimal_parameters(BicubicCoons(step, blend_u=blend), weights=(0, 0, 1))
    >>> round(best.parameters["mu"], 9), round(best.before, 6), round(best.after, 6)
    (0.5, 720.0, 120.0)
    """
    require_kind(BicubicCoons, patch, "patch", "BicubicCoons(matrix)")
    names = _names(patch, parameters)
    in_u, in_v = (_one_of(names, blend, name) for blend, name in ((patch.blend_u, "u"), (patch.blend_v, "v")))
    table = coefficients(patch, (in_u, in_v), weights, letters)
    values = patch.letters.values_with(letters)
    start = {name: values[name] for name in names}
    ranges = {name: _range(patch, name, monotone, letters) for name in names}
    if in_u and in_v and in_u != in_v:
        found = dict(
            zip(
                (in_u, in_v),
                _least_in_box(table, (ranges[in_u], ranges[in_v]), (start[in_u], start[in_v])),
                strict=True,
            )
        )
    else:
        (name,) = names
        along = Polynomial(_diagonals(table)) if in_u and in_v else Polynomial(table[:, 0] if in_u else table[0])
        found = {name: _least(along, ranges[name], start[name])}
    return Optimum(
        found,
        tuple(name for name in names if found[name] in ranges[name]),
        _value(table, start.get(in_u or "", 0.0), start.get(in_v or "", 0.0)),
        _value(table, found.get(in_u or "", 0.0), found.get(in_v or "", 0.0)),
        _with_letters(patch, {**values, **found}),
        table,
    )


def _names(patch: BicubicCoons, parameters: Iterable[Any] | None) -> tuple[str, ...]:
    """The letters to choose."""
    if parameters is None:
        families = (blend.family for blend in (patch.blend_u, patch.blend_v))
        symbols = [family.parameter for family in families if family and isinstance(family.parameter, sp.Symbol)]
        names = tuple(dict.fromkeys(symbol.name for symbol in symbols))
    else:
        given = [parameters] if isinstance(parameters, str | sp.Symbol) else parameters
        names = tuple(dict.fromkeys(map(str, given)))
    known = {*patch.blend_u.letters, *patch.blend_v.letters}
    if not names or not set(names) <= known:
        wrong = f", got {', '.join(names)}" if names else ""
        raise RsymError(
            f"the shape parameters to choose must be letters of the blends{wrong}",
            code="parameter",
            remedy="for example HermiteBlend.class2(mu, pi/2, letters={mu: 0}) and parameters=['mu']",
        )
    return names


def _one_of(names: tuple[str, ...], blend: HermiteBlend, direction: str) -> str | None:
    own = [name for name in names if name in blend.letters]
    if len(own) > 1:
        raise RsymError(
            f"one shape parameter can be chosen in {direction}, got {' and '.join(own)}",
            code="parameter",
            remedy="choose them one after the other",
        )
    return own[0] if own else None


def _range(patch: BicubicCoons, name: str, monotone: bool, letters: LetterValues) -> Range:
    """What the letter may be, and what keeps F1 from turning back."""
    letter = patch.letters[name]
    low = -np.inf if letter.minimum is None else float(letter.minimum)
    high = np.inf if letter.maximum is None else float(letter.maximum)
    for blend in (patch.blend_u, patch.blend_v):
        family = blend.family
        if monotone and family is not None and getattr(family.parameter, "name", None) == name:
            own = {key: value for key, value in (letters or {}).items() if str(key) in blend.letters}
            first, last = blend.monotone_range(letters=own)
            low, high = max(low, float(first)), min(high, float(last))
    if not low <= high:
        raise RsymError(f"the range of {name!r} and its monotone range have nothing in common", code="letter-range")
    return low, high


def _least(polynomial: Polynomial, within: Range, start: float) -> float:
    """Where a polynomial that grows both ways is least in a range: a root of its derivative, or an end."""
    if _is_flat(polynomial, within, start):
        return start
    return min(_places(_real_roots(polynomial.deriv()), within, start), key=polynomial)


def _places(roots: list[float], within: Range, start: float) -> list[float]:
    """Where a least value can be: roots in a range, its ends, and the place to stay at."""
    low, high = within
    ends = [end for end in within if np.isfinite(end)]
    return [min(max(start, low), high), *ends, *(root for root in roots if low <= root <= high)]


def _least_in_box(table: Floats, ranges: tuple[Range, Range], start: tuple[float, float]) -> tuple[float, float]:
    """The least of a biquadratic in a box.

    With p = -b(q)/(2 a(q)) eliminated, stationary points are roots of 4a**2 c' - 2abb' + b**2 a', of degree 5.
    """
    c, b, a = (Polynomial(row) for row in table)
    stationary = 4 * a * a * c.deriv() - 2 * a * b * b.deriv() + b * b * a.deriv()
    columns = [*_real_roots(stationary), start[1], *(end for end in ranges[1] if np.isfinite(end))]
    candidates = [
        (_least(_along_u(table, q), ranges[0], start[0]), q) for q in columns if ranges[1][0] <= q <= ranges[1][1]
    ]
    ends = [end for end in ranges[0] if np.isfinite(end)]
    candidates += [(p, _least(_along_v(table, p), ranges[1], start[1])) for p in ends]
    _, q = min(candidates, key=lambda place: _value(table, *place))
    # In turn, each the exact minimum of a quadratic: this takes off the rounding of the roots.
    for _ in range(20):
        p = _least(_along_u(table, q), ranges[0], start[0])
        q = _least(_along_v(table, p), ranges[1], start[1])
    return p, q


def _along_u(table: Floats, q: float) -> Polynomial:
    return Polynomial(table @ q ** np.arange(3))


def _along_v(table: Floats, p: float) -> Polynomial:
    return Polynomial(p ** np.arange(3) @ table)


def _diagonals(table: Floats) -> Floats:
    """The coefficients of the quartic of one parameter in both directions."""
    return np.array([np.trace(table[:, ::-1], 2 - k) for k in range(5)])


def _is_flat(polynomial: Polynomial, within: Range, start: float) -> bool:
    low, high = within
    wide = max(low, start - WIDE), min(high, start + WIDE)
    values = polynomial(np.linspace(*wide, 9))
    return bool(np.ptp(values) <= FLAT * np.abs(values).max())


def _real_roots(polynomial: Polynomial) -> list[float]:
    roots = polynomial.trim().roots()
    return [float(root.real) for root in roots.tolist() if abs(root.imag) <= 1e-6 * (1 + abs(root))]


def _value(table: Floats, p: float, q: float) -> float:
    return float(p ** np.arange(3) @ table @ q ** np.arange(3))


def _with_letters(patch: BicubicCoons, values: Mapping[str, float]) -> BicubicCoons:
    """The patch with other defaults."""
    blends = [blend.with_letters(values) for blend in (patch.blend_u, patch.blend_v)]
    own: Letters = patch.data.letters
    matrix = patch.data.expressions() if own else patch.matrix
    return BicubicCoons(matrix, *blends, letters=own.changed({name: values[name] for name in own}))
