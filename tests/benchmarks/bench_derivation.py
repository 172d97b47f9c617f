"""Derive and compile: rsym against sympy.diff and lambdify."""

import itertools

import numpy as np
import sympy as sp
from rivals import expanded, lambdified

import rsym

SERIAL = itertools.count(1)


def anew(shape):
    """The same shape but for some 1e-15, so that nothing is found in a cache."""
    return shape.replace(expression=shape.expression + sp.Rational(next(SERIAL), 10**15))


def test_six_fields_of_the_skeleton_body(benchmark, contest):
    """Six fields, derive and compile"""
    body = rsym.paper.skeleton_body()
    points = [np.random.default_rng(0).uniform(*side, 1000) for side in body.bounds]
    truth = rsym.compile(body, rsym.SIX)(*points)

    def ours():
        function = rsym.compile(anew(body), rsym.SIX)
        return lambda *columns: [function(*columns)[name] for name in rsym.SIX]

    def error(function):
        shares = [
            np.nanmax(np.abs(values - truth[name]) / (1 + np.abs(truth[name])))
            for name, values in zip(rsym.SIX, function(*points), strict=True)
        ]
        return f"{max(shares):.1e} of 1 + |field|"

    contest.run(benchmark, {"rsym.compile": ours, "sympy.diff, lambdify": lambda: six_by_sympy(anew(body))}, error, 3)


def six_by_sympy(shape):
    omega = expanded(shape)

    def gradient_squared(f):
        return sum(sp.diff(f, v) ** 2 for v in shape.coordinates)

    def laplacian(f):
        return sum(sp.diff(f, v, 2) for v in shape.coordinates)

    both = (omega, omega / sp.sqrt(omega**2 + gradient_squared(omega)))
    return lambdified(shape, [*both, *map(gradient_squared, both), *map(laplacian, both)])


def test_gradient_of_the_car(benchmark, contest):
    """Gradient of the car, derive and compile"""
    car = rsym.paper.car()
    points = [np.random.default_rng(0).uniform(*side, 1000) for side in car.bounds]
    truth = rsym.compile(car, ("gradient",))(*points)["gradient"]

    def ours():
        function = rsym.compile(anew(car), ("gradient",))
        return lambda *columns: function(*columns)["gradient"]

    def by_sympy():
        omega = expanded(anew(car))
        function = lambdified(car, [sp.diff(omega, v) for v in car.coordinates])
        return lambda *columns: np.stack(function(*columns), -1)

    def error(function):
        return f"{np.nanmax(np.abs(function(*points) - truth) / (1 + np.abs(truth))):.1e} of 1 + |gradient|"

    contest.run(benchmark, {"rsym.compile": ours, "sympy.diff, lambdify": by_sympy}, error, rounds=1)
