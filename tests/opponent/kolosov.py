"""States of elastic bodies by the potentials of Kolosov, for `elastic`: phi and psi of z = x + iy.

2 mu (u + iv) = kappa phi - z conj(phi') - conj(psi), xx + yy = 4 Re phi', yy - xx + 2i xy = 2 (conj(z) phi'' + psi').
"""

import numpy as np
import sympy as sp

from rsym import x, y


def times(one, other):
    """The product of two complex numbers as pairs."""
    return one[0] * other[0] - one[1] * other[1], one[0] * other[1] + one[1] * other[0]


def power(n):
    """z**n as a pair, or z*log(z) for "log"."""
    if n == "log":
        return times((x, y), (sp.log(x**2 + y**2) / 2, sp.atan2(y, x)))
    re, im = sp.expand((x + sp.I * y) ** abs(n)).as_real_imag()
    return (re, im) if n >= 0 else (re / (x**2 + y**2) ** -n, -im / (x**2 + y**2) ** -n)


def of_potentials(phi, psi, young, poisson, plane):
    """2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi), of sums of real multiples of powers."""
    kappa = 3 - 4 * poisson if plane == "strain" else (3 - poisson) / (1 + poisson)
    total = [sp.S.Zero, sp.S.Zero]

    def add(factor, pair):
        for k in range(2):
            total[k] += factor * pair[k]

    for n, factor in phi.items():
        add(kappa * factor, power(n))
        if n == "log":
            slope = 1 + sp.log(x**2 + y**2) / 2, sp.atan2(y, x)
        else:
            slope = tuple(n * one for one in power(n - 1))
        add(-factor, times((x, y), (slope[0], -slope[1])))
    for n, factor in psi.items():
        re, im = power(n)
        add(-factor, (re, -im))
    return tuple(one * (1 + poisson) / young for one in total)


def about_ellipse(a, b, way):
    """The stresses about an elliptic hole in a plate that is pulled along x or y: Inglis (1913), z = size (t + m/t)."""
    size, m, sign = (a + b) / 2, (a - b) / (a + b), 1 - 2 * way

    def stresses(p, q):
        z = (p + 1j * q) / size
        t = (z + np.sqrt(z - 2 * np.sqrt(m)) * np.sqrt(z + 2 * np.sqrt(m))) / 2
        z1, z2 = 1 - m / t**2, 2 * m / t**3
        c = 2 * sign - m
        first, second = 1 - c / t**2, 2 * c / t**3
        slope, bend = first / z1 / 4, (second * z1 - first * z2) / z1**3 / 4 / size
        k = (1 + m**2) * (sign - m) / m
        psi = -(sign - sign / (m * t**2) + k * (t**2 + m) / (t**2 - m) ** 2) / 2 / z1
        both, apart = 4 * slope.real, 2 * (np.conj(z * size) * bend + psi)
        return (both - apart.real) / 2, (both + apart.real) / 2, apart.imag / 2

    return stresses
