"""What is true of a shape, known by how it was made and by nothing else."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import sympy as sp

GRADES = ("broken", "G0", "G1", "G2", "G3", "analytic")
u, v, w, t = sp.symbols("u v w t", real=True)


def rank(grade: str) -> int:
    """The place of a grade; what is "unknown" says less than all of them."""
    return -1 if grade == "unknown" else GRADES.index(grade)


def grade_of(order: int) -> str:
    """The word for C^order contact: a graph whose first jump is that of the derivative number order + 1."""
    return GRADES[min(order, 3) + 1]


@dataclass(frozen=True)
class Spot:
    """A place where a boundary is less than analytic: exact coordinates, its grade, and the jump there if known."""

    point: tuple[sp.Expr, ...]
    grade: str
    turn: float | None = None  # degrees
    jump: float | None = None  # of the curvature


@dataclass(frozen=True)
class Germ:
    """A function of the local u, v[, w], whose boundary within `reach` of the origin is analytic but for the spots.

    `loose`: the spots are but samples of the defects; `curve`: all of them, by a parameter t from -0.3 to 0.3.
    """

    family: str
    omega: sp.Expr
    spots: tuple[Spot, ...] = ()
    reach: float = 0.5
    loose: bool = False
    curve: tuple[sp.Expr, ...] = ()
    letters: dict[sp.Symbol, object] = field(default_factory=dict)
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)

    def named(self, family: str) -> Germ:
        return replace(self, family=family)

    @property
    def grade(self) -> str:
        return min((spot.grade for spot in self.spots), key=rank, default="analytic")


@dataclass(frozen=True)
class Case:
    """A shape within bounds, with what is true of its boundary there.

    `unsure`: spots so near the edge of the bounds that it does not matter whether they count.
    """

    family: str
    shape: object
    spots: tuple[Spot, ...]
    unsure: tuple[Spot, ...] = ()
    loose: bool = False
    options: dict[str, object] = field(default_factory=dict)
    length: float = 1.0
    placed: bool = True  # whether it is known where the spots are
    empty: bool = False  # whether there is no boundary
    bend: float = 0.0  # a curvature that the boundary has somewhere within the bounds

    def __str__(self) -> str:
        """Enough to repeat it by hand."""
        options = "".join(f", {name}={value!r}" for name, value in self.options.items())
        return f"V(Shape({self.shape.expression}, {self.shape.coordinates}, bounds={self.shape.bounds}){options})"

    @property
    def best(self) -> str:
        """The most that may be said for it."""
        return min((spot.grade for spot in self.spots), key=rank, default="analytic")

    @property
    def worst(self) -> str:
        """The least that may be said of it."""
        return min((spot.grade for spot in (*self.spots, *self.unsure)), key=rank, default="analytic")
