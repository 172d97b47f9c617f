"""Principal curvatures of a sheet f = 0 in a box, from derivatives of f up to the third, for many boxes at once.

Let c be a point of the box B, and e_1, e_2, n an orthonormal frame, n along the gradient at c. Where w = g.n is
positive all over B, T_i = e_i - a_i n with a_i = g.e_i/w are tangent to the level surfaces. With g the gradient,
H the second and D the third derivatives of f, and S_ij = H(T_i, T_j), the normal curvature along v_1 T_1 + v_2 T_2 is

    kappa = -S(v, v)/(|g| G(v, v)),    G_ij = delta_ij + a_i a_j,    |g| = w sqrt(1 + |a|**2).

For any number K, which is nearly a principal curvature at c, N = -S - K w delta is small along its direction, and

    kappa - K = (N(v, v) + K(w |v|**2 - |g| G(v, v)))/(|g| G(v, v)),
    w |v|**2 <= |g| G(v, v) <= w |v|**2 (1 + |a|**2)**1.5,

where |a| is of the order of the width h of B. Each entry of N is enclosed by the mean-value form with a multiple m
of f, which is zero on the sheet: N = N(c) + m f(c) + (C(B) + m g(B)).(B - c), where

    C_ij = -(D(T_i, T_j) - d_i H(n, T_j) - d_j H(n, T_i)) - K H(n) delta_ij,   d_i = H(T_i)/w = the gradient of a_i.

m cancels the slope along the normal; m = 0, and the image of N itself, are better where letters range and f(c) with
them, so the three are intersected. With the first, bounds exceed what is attained in B by the order of h**2: where a
curvature has an extreme, the slopes C of its entry vanish.

The largest value of N(v, v) on unit vectors is at most the larger eigenvalue for the upper ends of N_11, N_22 and of
|N_12|, the least at least the smaller for the lower ends.

The frame is orthonormal but for rounding: T_i is tangent for any frame, the other formulas are off by FRAME.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.verify.cover.centred import SLACK, Centred, Ends, contracted

FRAME = 2.0**-44  # of a frame of vectors that are normal and of length 1 but for a few units of 2**-53
ENTRIES = (0, 1, 0, 1, 0), (0, 1, 0, 1, 1)  # rows and columns of N with the larger K, the smaller K, and either
UPPER, LOWER, SHEAR = slice(0, 2), slice(2, 4), 4


@dataclass(frozen=True)
class Jet:
    """First (3, n), second (3, 3, n) and third (3, 3, 3, n) derivatives."""

    gradient: Centred
    hessian: Centred
    third: Centred


class Bounds(NamedTuple):
    """Lower and upper bounds (n,), and how much each side of a box adds to how far they are apart (3, n)."""

    low: Floats
    high: Floats
    shares: Floats


@dataclass(frozen=True)
class Frame:
    """Two tangents and the normal of a sheet (3, 3, n), along its principal directions, and its curvatures (2, n)."""

    vectors: Floats
    curvatures: Floats


def frames(gradient: Floats, hessian: Floats) -> Frame:
    """The principal frames, larger curvature first, where f has these derivatives.

    Examples
    --------
    >>> ball = frames(np.array([[0.0], [-2.0], [0.0]]), np.diag([-2.0, -2.0, -2.0])[..., None])
    >>> ball.curvatures.T.tolist(), np.abs(ball.vectors[2, :, 0]).tolist()
    ([[1.0, 1.0]], [0.0, 1.0, 0.0])
    """
    with np.errstate(all="ignore"):
        length = np.sqrt(np.square(gradient).sum(axis=0))
        normal = gradient / length
        u = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=0)].T, axis=0)
        u /= np.sqrt(np.square(u).sum(axis=0))
        v = np.cross(normal, u, axis=0)
        a, b, c = (-np.einsum("kn,ln,kln->n", p, q, hessian) / length for p, q in ((u, u), (u, v), (v, v)))
        turn = np.arctan2(2 * b, a - c) / 2
        first = np.cos(turn) * u + np.sin(turn) * v
        mean, half = (a + c) / 2, np.hypot((a - c) / 2, b)
        vectors = np.stack([first, np.cross(normal, first, axis=0), normal])
    return Frame(vectors, np.stack([mean + half, mean - half]))


@dataclass(frozen=True)
class _Forms:
    """What the formulas need at a point or all over a box: w, a_i, H(T_i) and H(n, T_i) and H(n), S_ij."""

    along: Centred
    slant: Centred
    tangent: Centred
    mixed: Centred
    normal: Centred
    second: Centred


def _forms(frame: Centred, gradient: Centred, hessian: Centred) -> _Forms:
    parts = contracted("ikn,kn->in", frame, gradient)
    slant = contracted("in,n->in", parts[:2], parts[2].reciprocal())
    rows = contracted("ikn,kln->iln", frame, hessian)
    tangent = rows[:2] - contracted("in,ln->iln", slant, rows[2])
    framed = contracted("jln,iln->ijn", frame, tangent)
    second = framed[:, :2] - contracted("in,jn->ijn", framed[:, 2], slant)
    return _Forms(parts[2], slant, tangent, framed[:, 2], rows[2], second)


def _entries(forms: _Forms, shifts: Floats) -> Centred:
    """The five entries of N (5, n)."""
    return -forms.second[ENTRIES] - contracted("en,n->en", Centred.exact(shifts), forms.along)


def _slopes(frame: Centred, forms: _Forms, third: Centred, shifts: Floats) -> Centred:
    """The five rows of C (5, 3, n)."""
    rows = contracted("iln,lmkn->imkn", frame, third)
    once = rows[:2] - contracted("in,mkn->imkn", forms.slant, rows[2])
    columns = contracted("jmn,imkn->ijkn", frame, once)
    twice = columns[:, :2] - contracted("ikn,jn->ijkn", columns[:, 2], forms.slant)
    change = contracted("ikn,n->ikn", forms.tangent, forms.along.reciprocal())
    turned = contracted("ikn,jn->ijkn", change, forms.mixed) + contracted("jkn,in->ijkn", change, forms.mixed)
    return (turned - twice)[ENTRIES] - contracted("en,kn->ekn", Centred.exact(shifts), forms.normal)


def principal_bounds(frame: Frame, value: Centred, point: Jet, box: Jet, offset: Centred) -> Bounds:
    """Bounds of the principal curvatures on f = 0 in boxes.

    Parameters
    ----------
    frame : Frame
        At a point of each box, from rounded derivatives.
    value, point : Centred (n,), Jet
        f and its derivatives at the points.
    box : Jet
        Its derivatives over the boxes; the third are not finite where f is not known to have them.
    offset : Centred (3, n)
        The boxes seen from the points.
    """
    vectors = Centred.exact(frame.vectors)
    shifts = np.stack([*frame.curvatures[[0, 0, 1, 1]], np.zeros_like(frame.curvatures[0])])
    here, over = (_forms(vectors, jet.gradient, jet.hessian) for jet in (point, box))
    slope = _slopes(vectors, over, box.third, shifts)
    lean = _lean(slope.middle, box.gradient.middle, frame.vectors[2])
    tilted = slope + contracted("en,kn->ekn", lean, box.gradient)
    change = contracted("ekn,kn->en", tilted, offset) + contracted("en,n->en", lean, value)
    start = _entries(here, shifts)
    ways = start + change, start + contracted("ekn,kn->en", slope, offset), _entries(over, shifts)
    lows, highs = zip(*(way.ends for way in ways), strict=True)
    low, high = np.maximum.reduce(lows), np.minimum.reduce(highs)
    sizes = np.abs(tilted.middle) + tilted.radius
    with np.errstate(all="ignore"):
        shares = sizes.max(axis=0) * (np.abs(offset.middle) + offset.radius)
    return Bounds(*_quotients(over, frame.curvatures, low, high), shares)


def _lean(slope: Floats, gradient: Floats, normal: Floats) -> Centred:
    """The multiples of f that cancel the slopes along the normal."""
    with np.errstate(all="ignore"):
        lean = -np.einsum("ekn,kn->en", slope, normal) / np.einsum("kn,kn->n", gradient, normal)
    return Centred.exact(np.where(np.isfinite(lean), lean, 0.0))


def _quotients(over: _Forms, curvatures: Floats, low: Floats, high: Floats) -> Ends:
    """The quotients, from ends of the entries of N."""
    along, slant = over.along.ends, np.abs(over.slant.middle) + over.slant.radius
    shear = np.maximum(np.abs(low[SHEAR]), np.abs(high[SHEAR]))
    with np.errstate(all="ignore"):
        ratio = (1 + np.square(slant).sum(axis=0)) ** 1.5 * (1 + FRAME)
        least, most = along[0] * (1 - FRAME), along[1] * ratio
        upper = _bound(curvatures[0], high[UPPER], shear, (along[1], ratio), (least, most))
        lower = _bound(-curvatures[1], -low[LOWER], shear, (along[1], ratio), (least, most))
    known = (along[0] > 0) & np.isfinite(most)
    result = [np.where(known & ~np.isnan(bound), bound, np.inf) for bound in (lower, upper)]
    return -result[0], result[1]


def _bound(curvature: Floats, diagonal: Floats, shear: Floats, metric: Ends, divisors: Ends) -> Floats:
    """The upper bound K + (N + K(w |v|**2 - |g| G))/(|g| G), with |g| G between the divisors.

    The square root errs by a few units of the largest of its operands, as do the other operations.
    """
    a, c = diagonal
    along, ratio = metric
    half = np.hypot((a - c) / 2, shear)
    largest = (a + c) / 2 + half + SLACK * (np.abs(a) + np.abs(c) + shear)
    excess = np.maximum(-curvature * (ratio - 1), curvature * FRAME) * along
    top = largest + excess + SLACK * (np.abs(largest) + np.abs(excess))
    quotient = top / np.where(top >= 0, divisors[0], divisors[1])
    result: Floats = curvature + quotient + SLACK * (np.abs(curvature) + np.abs(quotient))
    return result
