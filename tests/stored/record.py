"""What is kept of an output: a digest of its bits, or a few numbers with what rounding may do to them."""

import hashlib
import math

import numpy as np

DIGITS = 12  # of a digest: one in 10^14 that a change is not seen
EPS = np.finfo(float).eps
WAYS = 3


def digest(*parts):
    """A short digest of texts, bytes and arrays; there is one NaN and one zero."""
    whole = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray):
            whole.update(f"{part.dtype.str} {part.shape}".encode())
            if part.dtype.kind == "f":
                part = np.where(np.isnan(part), part.dtype.type(np.nan), part + part.dtype.type(0))
            part = np.ascontiguousarray(part).tobytes()
        whole.update(part.encode() if isinstance(part, str) else part)
    return whole.hexdigest()[:DIGITS]


def numbers(array, error):
    """How many numbers an array holds, and sums over them with three sets of weights in [-1, 1), and their errors.

    `error` bounds the Euclidean norm of the error of the finite numbers. By Cauchy and Schwarz that of a sum is at
    most error*|weights|; the sums themselves are rounded once.
    """
    flat = np.asarray(array, float).ravel()
    finite = np.isfinite(flat)
    kept = {"count": [flat.size, int(finite.sum())], "sums": [], "error": 0.0}
    weights = np.modf(np.arange(1.0, flat.size + 1)[None] * np.sqrt([[2.0], [3.0], [5.0]]))[0][:, finite] * 2 - 1
    kept["sums"] = [math.fsum(row * flat[finite]) for row in weights]
    size = float(np.sqrt((flat[finite] ** 2).sum()))
    kept["error"] = float(f"{(error + EPS * size) * np.sqrt((weights**2).sum(axis=1).max(initial=0)):.2g}")
    return kept


def differs(stored, found):
    """Whether what is found is not what is stored."""
    if not isinstance(stored, dict) or not isinstance(found, dict):
        return stored != found
    if stored["count"] != found["count"]:
        return True
    allowed = stored["error"] + found["error"]
    return not all(abs(a - b) <= allowed for a, b in zip(stored["sums"], found["sums"], strict=True))


def compared(stored, made):
    """What has changed of the items of a group, in words, by name; those that are new or gone too."""
    told = {name: f"{stored.get(name, 'not stored')} -> gone" for name in stored if name not in made}
    for name, found in made.items():
        if name not in stored or differs(stored[name], found):
            told[name] = f"{stored.get(name, 'not stored')} -> {found}"
    return told
