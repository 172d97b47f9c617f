"""Contests: several ways to the same numbers, in turns, the best time of each and its error."""

import time
from dataclasses import dataclass, field

import pytest


@dataclass
class Contest:
    """The first contender is timed by pytest-benchmark, the others take their turns before each of its rounds."""

    title: str
    points: int = 0
    seconds: dict = field(default_factory=dict)
    errors: dict = field(default_factory=dict)

    def run(self, benchmark, contenders, error, rounds=5, shares=()):
        """Time the contenders; `error` turns what one returns into a text.

        `shares` names those that take a part of the points only, and how many times their time is to be counted.
        """
        first, *others = contenders
        for name, work in contenders.items():
            self.seconds[name] = float("inf")
            self.errors[name] = error(work())

        def turns():
            for name in others:
                start = time.perf_counter()
                contenders[name]()
                self.seconds[name] = min(self.seconds[name], time.perf_counter() - start)

        benchmark.pedantic(contenders[first], setup=turns, rounds=rounds)
        self.seconds[first] = benchmark.stats.stats.min
        for name, times in dict(shares).items():
            self.seconds[name] *= times

    def lines(self):
        """The table: what each takes, how many times as long as the first, millions of points a second."""
        shortest = next(iter(self.seconds.values()))
        yield f"{self.title:42}{'best time':>13}{'ratio':>10}{'Mpoints/s' if self.points else '':>11}   error"
        for name, seconds in self.seconds.items():
            rate = f"{self.points / seconds / 1e6:.1f}" if self.points else ""
            yield f"  {name:40}{seconds * 1e3:>10.1f} ms{seconds / shortest:>10.2f}{rate:>11}   {self.errors[name]}"


CONTESTS = pytest.StashKey[list]()
