"""The compiled loop of corner functions: at each point one power, sine and cosine, of which all others are products."""

from __future__ import annotations

import cmath
import math
from typing import Any

from rsym.sampling.compiled import loop, step

SIN, COS, LOG = 0, 1, 2
EDGE = 1e-6  # radians: what is on an edge but for rounding
TINY = 1e-100  # of a radius; its powers do not overflow


@step
def turned(angle: float, cut: float) -> float:
    """An angle between the cut and a turn before it."""
    if angle > cut:
        return angle - 2 * math.pi
    if angle < cut - 2 * math.pi:
        return angle + 2 * math.pi
    return angle


@step
def cut_off(share: float, power: int) -> tuple[float, float, float]:
    """The factor (1 - share**2)**power, r times its derivative, and r**2 times its second one."""
    fall = max((1 - share) * (1 + share), 0.0)
    inner = fall ** (power - 2)
    first = -2 * power * share * share * inner * fall
    return inner * fall * fall, first, first + 4 * power * (power - 1) * share**4 * inner


@step
def phased(half: int, sine: float, cosine: float) -> tuple[float, float]:
    """The sine of half*pi/2 - t, and its derivative over the rate of t where t falls, by those of t."""
    if half % 4 == 0:
        return -sine, cosine
    if half % 4 == 1:
        return cosine, sine
    if half % 4 == 2:
        return sine, -cosine
    return -cosine, -sine


@step
def multiples(waves: Any, power: float, angle: float) -> None:
    """Powers, sines and cosines of multiples, from that of one."""
    s, c = math.sin(angle), math.cos(angle)
    waves[0, 0], waves[1, 0], waves[2, 0] = 1.0, 0.0, 1.0
    for k in range(1, waves.shape[1]):
        sine, cosine = waves[1, k - 1], waves[2, k - 1]
        waves[0, k] = waves[0, k - 1] * power
        waves[1, k], waves[2, k] = sine * c + cosine * s, cosine * c - sine * s


@step
def loaded(alpha: float, log: float, t: float) -> tuple[float, float, float, float]:
    """S/r**2, S = -v**2/2 - Im(z**2 log z)/(2 alpha), its derivative by t, and r times those of both by r."""
    s2, c2, sine = math.sin(2 * t), math.cos(2 * t), math.sin(t)
    y = -sine * sine / 2 - (log * s2 + t * c2) / (2 * alpha)
    dy = -s2 / 2 - (2 * log * c2 + c2 - 2 * t * s2) / (2 * alpha)
    return y, dy, -s2 / (2 * alpha), -c2 / alpha


@step
def put(out: Any, k: int, u: Any, v: Any, c: float, s: float, polar: Any) -> None:
    """The derivatives of a term by x and y, from those in polar coordinates: value, r, t, rr, rt and Laplacian."""
    value, dr, dt, rr, rt, flat = polar
    out[0, k] = value
    if out.shape[0] == 1:
        return
    for i in range(1, 3):
        out[i, k] = dr * (c * u[i] + s * v[i]) + dt * (c * v[i] - s * u[i])
    if out.shape[0] == 3:
        return
    for m in range(3):
        i, j = 1 + m // 2, 1 + (m + 1) // 2
        ai, aj = c * u[i] + s * v[i], c * u[j] + s * v[j]
        bi, bj = c * v[i] - s * u[i], c * v[j] - s * u[j]
        # The second derivative across is flat - rr: in the Laplacian what is harmonic cancels.
        bent = dr * (c * u[3 + m] + s * v[3 + m]) + dt * (c * v[3 + m] - s * u[3 + m])
        out[3 + m, k] = rr * (ai * aj - bi * bj) + rt * (ai * bj + aj * bi) + flat * bi * bj + bent


@loop
def corner_terms(
    u: Any, v: Any, w: Any, alpha: float, radius: float, power: int, other: bool, alone: bool,
    kinds: Any, halves: Any, levels: Any, rates: Any, waves: Any, out: Any,
) -> None:  # fmt: skip
    """The derivatives of terms at points to `out` (n, 1, 3 or 6 kinds, terms), which is 0 where they are.

    u, v and w, (6, n), have their derivatives in the order of the kinds. The rate of a term is halves*pi/(2*alpha), its
    exponent that and twice its level; `other`: angles are counted from the second edge. `waves` has room for the
    powers, sines and cosines of all multiples.
    """
    ca, sa, cut, base = math.cos(alpha), math.sin(alpha), alpha / 2 + math.pi, math.pi / (2 * alpha)
    for n in range(u.shape[1]):
        r = math.hypot(u[0, n], v[0, n])
        if r >= radius:
            continue
        angle = turned(math.atan2(v[0, n], u[0, n]), cut)
        rest = turned(math.atan2(w[0, n], u[0, n] * ca + v[0, n] * sa), cut)
        if not alone and (angle <= -EDGE or rest <= -EDGE):
            continue
        r = max(r, TINY)
        # The angle to the nearer edge is exact.
        first = abs(angle) <= abs(rest)
        t = angle if first else rest
        chi, chi1, chi2 = cut_off(r / radius, power)
        multiples(waves, r**base, base * t)
        un, vn, here = u[:, n], v[:, n], out[n]
        c, s = u[0, n] / r, v[0, n] / r
        for k in range(len(kinds)):
            level, rate = levels[k], rates[k]
            e = rate + 2 * level
            # Of F = chi*r**e, over r**e: r F', r**2 F'', and r**2 F'' + r F' - rate**2 F.
            f1 = e * chi + chi1
            f2 = e * (e - 1) * chi + 2 * e * chi1 + chi2
            flat = 4 * level * (rate + level) * chi + (2 * e + 1) * chi1 + chi2
            size = r ** (2 * level)
            if kinds[k] == LOG:
                y, dy, a, b = loaded(alpha, math.log(r), t)
                if not first:  # it looks the same from the second edge
                    dy, b = -dy, -b
                lap = flat * y + 2 * (f1 - 2 * chi) * a - chi
            else:
                size *= waves[0, halves[k]] / (r * r)
                y, dy = waves[1, halves[k]], waves[2, halves[k]]
                if first == other:
                    y, dy = phased(halves[k], y, dy)
                if kinds[k] == COS:
                    y, dy = dy, -y
                dy *= -rate if other else rate
                a, b, lap = 0.0, 0.0, flat * y
            polar = (
                chi * r * r * size * y, (f1 * y + chi * a) * r * size, chi * r * size * dy,
                (f2 * y + (2 * f1 - chi) * a) * size, ((f1 - chi) * dy + chi * b) * size, lap * size,
            )  # fmt: skip
            put(here, k, un, vn, c, s, polar)


@loop
def wave_terms(
    u: Any, v: Any, w: Any, alpha: float, radius: float, power: int, alone: bool,
    rates: Any, top: int, waves: Any, turns: Any, which: Any, levels: Any, out: Any,
) -> None:  # fmt: skip
    """The derivatives of terms at points to `out` (n, components, 1, 3 or 6 kinds, terms), which is 0 where they are.

    u, v and w, (6, n), have those of leaf coordinates in the order of the kinds. With l of `rates` (functions,), and
    `waves` (functions, orders, shifts, 2, components), a function is the real part of the sum of

        r**(l + top + p) * (waves[p, q, 0]*exp(i*m*theta) + waves[p, q, 1]*exp(-i*m*theta)),  m = l + top + p - 2*q,

    and a term is the function of a number in `which` times r**(2*level), cut off. `turns` has room (functions, orders,
    components, 3) for what they turn like.
    """
    ca, sa, cut = math.cos(alpha), math.sin(alpha), alpha / 2 + math.pi
    for n in range(u.shape[1]):
        r = math.hypot(u[0, n], v[0, n])
        if r >= radius:
            continue
        t = turned(math.atan2(v[0, n], u[0, n]), cut)
        rest = turned(math.atan2(w[0, n], u[0, n] * ca + v[0, n] * sa), cut)
        if not alone and (t <= -EDGE or rest <= -EDGE):
            continue
        r = max(r, TINY)
        chi, chi1, chi2 = cut_off(r / radius, power)
        un, vn = u[:, n], v[:, n]
        c, s = u[0, n] / r, v[0, n] / r
        log = math.log(r)
        for f in range(waves.shape[0]):
            for p in range(waves.shape[1]):
                turns[f, p] = 0.0
                size = cmath.exp((rates[f] + (top + p - 2)) * log)
                for q in range(waves.shape[2]):
                    m = rates[f] + (top + p - 2 * q)
                    forth = cmath.exp(1j * m * t)
                    back = size / forth
                    forth *= size
                    for a in range(waves.shape[4]):
                        one, other = waves[f, p, q, 0, a] * forth, waves[f, p, q, 1, a] * back
                        turns[f, p, a, 0] += one + other
                        turns[f, p, a, 1] += 1j * m * (one - other)
                        turns[f, p, a, 2] -= m * m * (one + other)
        for k in range(len(which)):
            f, more = which[k], r ** (2 * levels[k])
            for a in range(waves.shape[4]):
                value, dr, dt, rr, rt, flat = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for p in range(waves.shape[1]):
                    e = rates[f] + (top + p + 2 * levels[k])
                    # Of F = chi*r**e, over r**e: r F' and r**2 F''.
                    f1 = e * chi + chi1
                    f2 = e * (e - 1) * chi + 2 * e * chi1 + chi2
                    y, dy, ddy = turns[f, p, a, 0], turns[f, p, a, 1], turns[f, p, a, 2]
                    value += (y * chi).real * r * r
                    dr += (y * f1).real * r
                    dt += (dy * chi).real * r
                    rr += (y * f2).real
                    rt += (dy * (f1 - chi)).real
                    flat += (y * (f2 + f1) + ddy * chi).real
                polar = (value * more, dr * more, dt * more, rr * more, rt * more, flat * more)
                put(out[n, a], k, un, vn, c, s, polar)
