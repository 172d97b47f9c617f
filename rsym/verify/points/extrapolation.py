"""Limits of sequences sampled at distances that halve, whatever the power law of the approach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import mpmath as mp
from mpmath import mpf

# Below this exponent a sequence of a dozen halvings cannot be told from one that grows like a logarithm.
SLOWEST = mpf("0.02")
# Branches are Puiseux series; denominators above eight have not been met, and a wrong guess only costs a stage.
DENOMINATORS = range(1, 9)
SNAP = mpf("1e-3")
FEWEST = 5


@dataclass(frozen=True)
class Limit:
    """The limit of a sequence, an estimate of its error, and the exponent q of the leading term c r^q.

    value is infinite, with the sign of the sequence, where it grows without bound, and NaN where nothing can be said.

    Examples
    --------
    >>> Limit(mpf(1), mpf("1e-20"), mpf(2)).finite
    True
    """

    value: mpf
    error: mpf
    exponent: mpf

    @property
    def finite(self) -> bool:
        """Whether there is a finite limit."""
        return bool(mp.isfinite(self.value))


def limit(values: Sequence[mpf], noise: mpf) -> Limit:
    """Limit of v_k = L + sum c_i r_k^q_i at r_k = r_0 2^-k as k grows; the exponents q_i are not known.

    Two extrapolations that share no step: Richardson's elimination with fitted exponents (q = log2 of the ratio of
    successive differences, itself extrapolated and rounded to a near fraction), and Wynn's epsilon algorithm, exact
    for finite sums of exponentials in k. The error is their distance, the step between the last two entries
    of the first, or `noise`, whichever is largest; the window of the sequence with the least error is taken.

    Sources: Richardson (1911); Wynn, MTAC 10 (1956) 91-96; Sidi, Practical Extrapolation Methods (2003).

    Examples
    --------
    >>> found = limit([3 + mp.sqrt(mpf(2) ** -k) - mpf(2) ** -k for k in range(12)], mpf("1e-12"))
    >>> mp.nstr(found.value, 8), mp.nstr(found.exponent, 1), bool(found.error < 1e-8)
    ('3.0', '0.5', True)
    >>> mp.nstr(limit([mpf(2) ** (mpf(k) / 3) for k in range(12)], mpf("1e-12")).value)
    '+inf'
    """
    if len(values) < FEWEST or not all(mp.isfinite(value) for value in values):
        return Limit(mp.nan, mp.inf, mp.nan)
    steps = [after - before for before, after in pairwise(values)]
    if max(abs(step) for step in steps[-FEWEST:]) <= noise:
        return Limit(values[-1], noise, mp.nan)
    exponent = _exponent(steps)
    if exponent < SLOWEST:
        return Limit(_direction(values, steps), mp.inf, exponent)
    windows = [list(values[start:]) for start in range(0, len(values) - FEWEST, 2)]
    estimates = [_estimate(window, noise) for window in windows or [list(values)]]
    value, error = min(estimates, key=lambda estimate: estimate[1])
    return Limit(value, error, exponent)


def _estimate(values: list[mpf], noise: mpf) -> tuple[mpf, mpf]:
    """The limit by elimination, and its error by comparison."""
    value, step = _eliminated(values, noise)
    other = _epsilon(values, noise)
    return value, max(abs(value - other), step, noise)


def _eliminated(values: list[mpf], noise: mpf) -> tuple[mpf, mpf]:
    """Eliminate one power after another, each fitted to what the former left."""
    row = values
    while len(row) >= FEWEST - 1:
        steps = [after - before for before, after in pairwise(row)]
        if abs(steps[-1]) <= noise:
            break
        exponent = _exponent(steps)
        if not SLOWEST < exponent < 60:
            break
        factor = mpf(2) ** exponent
        row = [(factor * after - before) / (factor - 1) for before, after in pairwise(row)]
    return row[-1], abs(row[-1] - row[-2])


def _exponent(steps: Sequence[mpf]) -> mpf:
    """The exponent that the last steps tend to, rounded to a fraction that is near enough; NaN without one."""
    tail = list(steps[-4:])
    if any(step == 0 for step in tail):
        return mp.nan
    rates = [mp.log(abs(before / after), 2) for before, after in pairwise(tail)]
    exponent = rates[-1]
    if len(rates) > 2 and (bend := rates[-1] - 2 * rates[-2] + rates[-3]) != 0:
        correction = (rates[-1] - rates[-2]) ** 2 / bend
        exponent -= correction if abs(correction) < mpf("0.5") else 0
    near = [mp.nint(exponent * bottom) / bottom for bottom in DENOMINATORS]
    best = min(near, key=lambda fraction: abs(fraction - exponent))
    return best if abs(best - exponent) < SNAP else exponent


def _direction(values: Sequence[mpf], steps: Sequence[mpf]) -> mpf:
    """Infinite with the sign of a sequence that grows steadily, else NaN: noise also grows."""
    tail, signs = steps[-FEWEST:], {mp.sign(step) for step in steps[-FEWEST:]}
    rates = [mp.log(abs(after / before), 2) for before, after in pairwise(tail) if before * after != 0]
    steady = len(rates) == len(tail) - 1 and max(rates) - min(rates) < mpf("0.3")
    return mp.inf * signs.pop() if len(signs) == 1 and steady and abs(values[-1]) > abs(values[-2]) else mp.nan


def _epsilon(values: list[mpf], noise: mpf) -> mpf:
    """The last entry of even order of Wynn's table that no vanishing difference spoils."""
    before, row = [mpf(0)] * (len(values) + 1), list(values)
    best = row[-1]
    for order in range(1, len(values)):
        steps = [right - left for left, right in pairwise(row)]
        # In odd columns entries are reciprocal differences, large by nature; only even ones can meet the noise.
        if not steps or any(step == 0 for step in steps) or (order % 2 and abs(steps[-1]) <= noise):
            break
        row, before = [inner + 1 / step for inner, step in zip(before[1:], steps, strict=False)], row
        if order % 2 == 0:
            best = row[-1]
    return best
