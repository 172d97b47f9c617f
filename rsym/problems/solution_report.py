"""How a solution was found: unknowns, the rule, the system, corners, and the estimate of its error."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rsym.problems.corners.choice import CornerChoice
from rsym.problems.guards import bare_corners
from rsym.problems.interfaces import Interfaces
from rsym.problems.problem import Problem
from rsym.problems.refinement import Grade, observed_order
from rsym.problems.systems.linear import Solved
from rsym.reports.document import Document, Sentence, Tabular, numerical
from rsym.reports.numbers import short
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.sampling.rules.quadrature import Quadrature

# Digits that an amplification takes before it is looked at more closely, at most as many as the degree of the splines:
# between the first eigenvalues it is some 10, for a hundred waves 1000.
STRONG = 2


@dataclass(frozen=True, eq=False)
class SolutionReport(Report):
    """How a solution was found.

    Examples
    --------
    >>> import rsym
    >>> report = rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8).report
    >>> report.unknowns, report.degree, report.steps, report.observed_order
    (132, 4, 0, None)
    >>> 500 < report.condition < 5000
    True
    """

    unknowns: int
    degree: int
    cells: int
    points: int
    steps: int
    residual: float
    estimate: float | None
    grades: tuple[Grade, ...]
    unresolved: float
    eigenvalue: float | None = None
    corners: int = 0
    left: int = 0
    refused: tuple[str, ...] = ()
    condition: float | None = None
    stopped: bool = False
    amplification: float | None = None
    rounding: float = 0.0
    stress: float | None = None
    goal: float | None = None
    interfaces: int = 0
    doubts: tuple[str, ...] = ()
    off: float = 0.0
    treatments: tuple[str, ...] = ()

    @property
    def observed_order(self) -> float | None:
        """By which order in the size of cells the last two estimates fell; None where cells were given."""
        return observed_order(self.grades)

    @property
    def unsure(self) -> float:
        """The share of the answer that rounding, steps that came to their end, or functions given left open."""
        left = self.residual * math.sqrt(self.condition or 1) if self.stopped else 0.0
        return max(left, self.rounding, self.off)

    @property
    def amplified(self) -> bool:
        """Whether errors of an eigenvalue, as grids of few cells have, may become as large as the answer."""
        return self.amplification is not None and self.amplification >= 10.0 ** min(self.degree, STRONG)

    @property
    def nearness(self) -> str:
        """Words for a warning, where errors are amplified."""
        if not self.amplified:
            return ""
        return (
            "; the problem is near to one that has no single answer, see modes, so that changes of it and errors are "
            f"amplified by up to {self.amplification:.1g}"
        )

    def document(self) -> Document:
        """Unknowns, rule, system, its condition, the order and the error, which are estimates: nothing is proved."""
        told = [
            f"{plural(self.unknowns, 'unknown')}: splines of degree {self.degree} on cells of which "
            f"{self.cells} are the longest side, {plural(self.points, 'point')} of integration."
        ]
        way = f"conjugate gradients in {plural(self.steps, 'step')}" if self.steps else "factors"
        way += ", which came to their end" if self.stopped else ""
        told.append(f"The system was solved by {way}; its residual is {short(self.residual)} of the right side.")
        if self.condition is not None:
            told.append(f"The condition of its matrix, scaled by the diagonal, is estimated at {self.condition:.2g}.")
        if self.amplification is not None:
            told.append(
                f"A small change of the equation is amplified by up to {self.amplification:.2g}; rounding leaves some "
                f"{digits_left(self.rounding)} digits of an answer."
            )
        if self.observed_order is not None:
            last = " to ".join(f"{grade.cells} cells of degree {grade.degree}" for grade in self.grades[-2:])
            told.append(f"The order observed, from {last}, is {self.observed_order:.2g}.")
        if self.unresolved:
            told.append(f"The rule of integration is not sure on a measure of {short(self.unresolved)}.")
        if self.off:
            told.append(f"Functions given on the boundary are met to about {short(self.off)} of the largest value.")
        told += [*self.treatments, *self._of_corners()]
        told = [*self._of_goals(), *told]
        if self.estimate is None:
            error = "No estimate of the error was asked for."
        else:
            error = (
                f"The error, an estimate, is about {short(self.estimate)} of the largest value, "
                "in the root of the mean square."
            )
        rows = tuple((str(g.cells), str(g.degree), str(g.unknowns), short(g.estimate)) for g in self.grades)
        tables = (Tabular(("cells", "degree", "unknowns", "estimate"), rows),) if rows else ()
        return Document(
            "solution",
            Sentence(error, False),
            sentences=numerical(told),
            tables=tables,
            data={
                "unknowns": self.unknowns,
                "degree": self.degree,
                "cells": self.cells,
                "points": self.points,
                "steps": self.steps,
                "residual": self.residual,
                "condition": self.condition,
                "amplification": self.amplification,
                "rounding": self.rounding,
                "order observed": self.observed_order,
                "estimate": self.estimate,
                "stress": self.stress,
                "goal": self.goal,
                "corners": self.corners,
                "corners left": self.left + len(self.refused),
                "interfaces": self.interfaces,
                "treatments": list(self.treatments),
            },
        )

    def of_problem(self, problem: Problem) -> SolutionReport:
        """The same, knowing of corners, interfaces, the form, and how values on the boundary go inside."""
        made = replace(self, off=problem.off, treatments=treatments(problem)).of_interfaces(problem.interfaces)
        return replace(made, left=bare_corners(problem)).of_corners(problem.corners)

    def of_interfaces(self, known: Interfaces) -> SolutionReport:
        """The same, knowing where coefficients jump or have kinks."""
        return replace(self, interfaces=len(known.functions), doubts=known.doubts)

    def of_corners(self, choice: CornerChoice | None) -> SolutionReport:
        """The same, knowing of corners."""
        if choice is None:
            return self
        return replace(self, corners=len(choice.corners), left=len(choice.left), refused=choice.reasons)

    def _of_goals(self) -> list[str]:
        """What else than the solution has an estimate."""
        told = []
        if self.goal is not None:
            told.append(f"The number that was asked for is known to about {short(self.goal)} of it, an estimate.")
        if self.stress is not None:
            told.append(
                f"Stresses are known to about {short(self.stress)} of the largest, an estimate, where they are worst."
            )
        return told

    def _of_corners(self) -> list[str]:
        """Which corners and kinks have functions of their own, and which do not though solutions are not smooth."""
        own = f"{plural(self.corners, 'corner')} of the shape: there are functions like solutions there."
        less = f"{plural(self.left, 'corner')} without such functions: splines alone are less accurate there."
        told = [line for line, count in ((own, self.corners), (less, self.left)) if count]
        told += [f"No such functions where corners are not known: {reason}." for reason in self.refused]
        kinks = f"{plural(self.interfaces, 'interface')} of coefficients: functions have kinks like solutions there."
        told += [kinks] if self.interfaces else []
        told += [f"Solutions may be less smooth where coefficients jump or have kinks: {why}." for why in self.doubts]
        return told


def reported(rule: Quadrature, cells: int, degree: int, found: Solved) -> SolutionReport:
    """How the answers of a system were found, nothing estimated yet."""
    return SolutionReport(
        unknowns=len(found.values),
        degree=degree,
        cells=cells,
        points=len(rule.weights),
        steps=found.steps,
        residual=found.residual,
        estimate=None,
        grades=(),
        unresolved=rule.unresolved,
        condition=found.condition,
        stopped=found.stopped,
    )


def treatments(problem: Problem) -> tuple[str, ...]:
    """What was done with a problem beside what is done with all, a line each."""
    told = []
    if problem.seams is not None and problem.seams.rewritten:
        told.append("The formula was written anew, as one that is zero on the boundary alone.")
    if problem.cuts:
        told.append(f"Conditions change on {plural(len({cut.leaf for cut in problem.cuts}), 'leaf', 'leaves')}.")
    return (*told, *problem.lifted.how)


def digits_left(share: float) -> int:
    """How many digits there are where so large a share is not sure.

    Examples
    --------
    >>> digits_left(2e-9), digits_left(0), digits_left(3)
    (8, 15, 0)
    """
    return min(15, max(0, int(-math.log10(share)))) if share > 0 else 15
