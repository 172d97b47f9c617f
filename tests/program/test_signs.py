"""The sign of every R-operation is the truth of its logic, for every pair of finite numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y

HALF = sp.Rational(1, 2)
SIZES = {
    "float64": "5e-324 1e-323 1e-320 2e-308 1e-300 1e-200 1e-162 1e-160 1e-154 1e-100 1e-20 1e-8 0.3 1 3.7 1e8 1e20 "
    "1e100 1e154 1e160 1e200 1e300 8e307 1.7e308 1.7976931348623157e308",
    "float32": "1.4e-45 3e-45 1e-42 1e-38 1e-30 1e-23 1e-20 1e-19 1e-10 1e-8 0.3 1 3.7 1e8 1e10 1e19 1e20 1e30 1.7e38 "
    "3e38 3.4028235e38",
}
SYSTEMS: dict[str, Any] = {
    "R0": rsym.R0,
    "R1": rsym.R1,
    "RAlpha(1/2)": rsym.RAlpha(HALF),
    "RAlpha(-9/10)": rsym.RAlpha(-sp.Rational(9, 10)),
    "RAlpha(1 - 1e-6)": rsym.RAlpha(1 - sp.Rational(1, 10**6)),
    "RAlpha(1)": rsym.RAlpha(1),
    "R0m(1)": rsym.R0m(1),
    "R0m(5)": rsym.R0m(5),
    "Rp(2)": rsym.Rp(2),
    "Rp(3)": rsym.Rp(3),
    "Rp(5/2)": rsym.Rp(sp.Rational(5, 2)),
    "Rp(11/10)": rsym.Rp(sp.Rational(11, 10)),
    "Rp(40)": rsym.Rp(40),
    "Sardf(1/2)": rsym.Sardf(HALF),
    "Sardf(1/100)": rsym.Sardf(sp.Rational(1, 100)),
    "Sardf(1000)": rsym.Sardf(1000),
}
TRUTHS: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "conjunction": (lambda s: rsym.conjunction(x, y, system=s), np.minimum),
    "disjunction": (lambda s: rsym.disjunction(x, y, system=s), np.maximum),
    "implication": (lambda s: rsym.implication(x, y, s), lambda a, b: np.maximum(-a, b)),
    "exclusive_or": (lambda s: rsym.exclusive_or(x, y, s), lambda a, b: -a * b),
}


def pairs(dtype: str) -> tuple[np.ndarray, np.ndarray]:
    """All pairs of awkward numbers of both signs and zeros of both signs; equal, opposite and nearly equal pairs."""
    number = np.dtype(dtype).type
    sizes = [number(size) for size in SIZES[dtype].split()]
    values = np.array([*sizes, *(-size for size in sizes), 0.0, -0.0], dtype)
    f, g = (grid.ravel() for grid in np.meshgrid(values, values))
    with np.errstate(over="ignore", under="ignore"):
        others = [np.nextafter(values, number(end)) for end in (np.inf, -np.inf)]
        others += [values * number(factor) for factor in (1.5, 1.2, 1.01, 0.9)]
    near = np.concatenate([np.stack([values, other]) for other in others], axis=1)
    near = near[:, np.isfinite(near).all(axis=0)]
    f = np.concatenate([f, near[0], near[1], near[0], -near[1]])
    g = np.concatenate([g, near[1], near[0], -near[1], near[0]])
    return f, g


@pytest.mark.parametrize("dtype", SIZES)
@pytest.mark.parametrize("backend", ["numpy", "llvm"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_the_sign_is_the_truth(name: str, backend: str, dtype: str) -> None:
    f, g = pairs(dtype)
    for operation, (make, truth) in TRUTHS.items():
        shape = rsym.Shape(make(SYSTEMS[name]), (x, y))
        values = rsym.compile(shape, backend=backend, dtype=dtype)(f, g)["value"]
        wrong = np.flatnonzero(np.sign(values) != truth(np.sign(f), np.sign(g)))
        assert not wrong.size, (operation, [(f[k], g[k], values[k]) for k in wrong[:3]])


@pytest.mark.parametrize("dtype", SIZES)
@pytest.mark.parametrize("backend", ["numpy", "llvm"])
@pytest.mark.parametrize("order", [1, 2, 3, 20])
def test_equivalence_and_joining_vanish_with_an_operand_alone(order: int, backend: str, dtype: str) -> None:
    f, g = pairs(dtype)
    product = np.sign(f) * np.sign(g)
    for operation, truth in ((rsym.equivalence, product), (rsym.joining, np.abs(product))):
        shape = rsym.Shape(operation(x, y, order=order), (x, y))
        values = rsym.compile(shape, backend=backend, dtype=dtype)(f, g)["value"]
        assert np.array_equal(np.sign(values), truth), operation


@pytest.mark.parametrize("dtype", SIZES)
@pytest.mark.parametrize("backend", ["numpy", "llvm"])
@pytest.mark.parametrize("system", [rsym.Rho(HALF), rsym.Rho(HALF, "G2"), rsym.Rho(HALF, cosine=sp.Rational(1, 3))])
def test_a_fillet_takes_away_from_the_edge_alone(system: Any, backend: str, dtype: str) -> None:
    """Never positive where an operand is not; outside the tube the truth of the logic."""
    f, g = pairs(dtype)
    shape = rsym.Shape(rsym.conjunction(x, y, system=system), (x, y))
    values = rsym.compile(shape, backend=backend, dtype=dtype)(f, g)["value"]
    least = np.minimum(np.sign(f), np.sign(g))
    assert (np.sign(values) <= least).all()
    assert not np.isnan(values).any()
    outside = np.maximum(np.abs(f), np.abs(g)) > 1
    assert np.array_equal(np.sign(values[outside]), least[outside])


@pytest.mark.parametrize("backend", ["interval", "ball"])
@pytest.mark.parametrize("name", SYSTEMS)
def test_an_enclosure_of_a_point_never_has_the_wrong_sign(name: str, backend: str) -> None:
    f, g = pairs("float64")
    if backend == "ball":
        f, g = f[::11], g[::11]
    boxes = np.stack([f, f, g, g], axis=-1).reshape(-1, 2, 2)
    for operation, (make, truth) in TRUTHS.items():
        shape = rsym.Shape(make(SYSTEMS[name]), (x, y))
        low, high = np.moveaxis(rsym.enclose(shape, boxes, backend=backend)["value"], -1, 0)
        signs = truth(np.sign(f), np.sign(g))
        assert not ((low > 0) & (signs <= 0)).any(), operation
        assert not ((high < 0) & (signs >= 0)).any(), operation
        assert not (((low >= 0) & (signs < 0)) | ((high <= 0) & (signs > 0))).any(), operation
