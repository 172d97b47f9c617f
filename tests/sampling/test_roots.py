import numpy as np
from oracles.closeness import assert_close

from rsym.sampling.roots import bracketed_roots


def solve(function, count=1):
    zeros = np.zeros(count)
    return bracketed_roots(function, function(zeros, np.arange(count)), function(zeros + 1, np.arange(count)))


def test_smooth_functions_to_the_last_digits():
    targets = np.linspace(0.01, 0.99, 50)
    assert_close(solve(lambda t, k: t**3 - targets[k] ** 3, 50), targets, atol=2e-13)
    assert_close(solve(lambda t, k: np.exp(5 * t) - np.exp(5 * targets[k]), 50), targets, atol=2e-13)


def test_hard_functions_stay_in_the_bracket():
    for function, root in (
        (lambda t, k: np.sign(t - 0.3) * np.abs(t - 0.3) ** 0.2, 0.3),
        (lambda t, k: (t - 0.7) ** 9, 0.7),
        (lambda t, k: np.where(t < 0.123456, -1.0, 1e-9), 0.123456),
        (lambda t, k: 1e-200 * (t - 0.5), 0.5),
    ):
        (got,) = solve(function)
        assert abs(got - root) < 1e-2 if function(np.array([root]), 0)[0] == 0 else abs(got - root) < 1e-12


def test_steps_are_few(monkeypatch):
    calls = []

    def function(t, k):
        calls.append(len(t))
        return np.cos(3 * t) - 0.2

    solve(function)
    assert len(calls) <= 12
