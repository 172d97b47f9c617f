"""Problems as model files state them: a shape, an equation and conditions on its parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from types import EllipsisType
from typing import Any

from rsym.analysis.conditions import BoundaryCondition
from rsym.errors import RsymError
from rsym.garbage import uncollected
from rsym.language.loading import read_model
from rsym.language.model import ModelFile
from rsym.language.stating import WrittenEquation, stated
from rsym.language.syntax import ConditionStatement, EquationStatement
from rsym.model.letters import Letter
from rsym.model.shape import Shape
from rsym.problems.conditions import resolved
from rsym.problems.solution import Solution
from rsym.problems.solving import solve
from rsym.sampling.progress import Progress


@dataclass(frozen=True, eq=False)
class StatedProblem:
    """What a model says of a function u on its shape; `load_problem` reads one.

    Attributes
    ----------
    shape : Shape
        With the letters of the equation and of the conditions beside its own.
    equation : WrittenEquation or None
        What `solve` and `modes` take as an equation; ``str(equation)`` is its text.
    conditions : {name or ...: condition}
        As `solve` and `modes` take them.

    Examples
    --------
    >>> import rsym, tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "heated.rf")
    ...     _ = path.write_text("letter q = 1; rim = 1 - x^2 - y^2; equation -laplacian(u) = q; on rim = 0")
    ...     problem = rsym.load_problem(path)
    >>> str(problem.equation), problem.conditions["rim"], list(problem.shape.letters)
    ('-laplacian(u) = q', Dirichlet(value=0), ['q'])
    >>> float(problem.solve(cells=8, letters={"q": 2}).maximum().value.__round__(10))
    0.5
    """

    shape: Shape
    equation: WrittenEquation | None
    conditions: Mapping[str | EllipsisType, BoundaryCondition]

    def solve(
        self,
        *,
        degree: int = 4,
        cells: int | None = None,
        tolerance: float | None = None,
        letters: Mapping[Any, Any] | None = None,
        axis: Any = None,
        poisson: float | None = None,
        progress: Progress | None = None,
    ) -> Solution:
        """The solution; parameters, errors and warnings as in `solve`.

        Raises
        ------
        RsymError
            Where there is no equation, too.
        """
        if self.equation is None:
            raise RsymError(
                "the model states no equation", code="equation", remedy="add one, such as: equation -laplacian(u) = 1"
            )
        return solve(
            self.shape,
            self.equation,
            self.conditions,
            degree=degree,
            cells=cells,
            tolerance=tolerance,
            letters=letters,
            axis=axis,
            poisson=poisson,
            progress=progress,
        )


def load_problem(path: str | PathLike[str], *, shape: str | None = None, variant: str | None = None) -> StatedProblem:
    """The problem that a model file states in its lines ``equation`` and ``on``; `loads` tells the rest of it.

    ``equation -laplacian(u) = 1`` says what a function u on the shape is to meet; letters and formulas of
    the file have their meaning there. ``on rim = 0``, ``on "wheel arch" = robin(2, 1)`` say what holds on a part:
    a value, or ``dirichlet``, ``neumann``, ``robin``, ``constant``, ``clamped``, ``supported``, which are those of
    rsym; ``on others = 0`` is the rest. Nothing of it is run.

    Parameters
    ----------
    path, shape, variant
        As in `load`.

    Raises
    ------
    RsymError
        As `load`, and for a condition on what is no part of the boundary; with line and column.

    Examples
    --------
    >>> import rsym
    >>> rsym.load_problem("skeleton").conditions
    {}
    """
    with uncollected():
        made, model = read_model(path, shape=shape, variant=variant)
    letters = {**model.letters, **model.variants.get(variant or "", {})}
    return problem_stated(model, made, letters, model.equation, model.conditions)


def problem_stated(
    model: ModelFile,
    shape: Shape,
    letters: Mapping[str, Letter],
    equation: EquationStatement | None,
    conditions: Iterable[ConditionStatement],
) -> StatedProblem:
    """An equation and conditions on a shape of a model, in whose words they are."""
    found = stated(model, letters, equation, conditions)
    shape = shape.replace(letters={**{name: letters[name] for name in sorted(found.letters)}, **shape.letters})
    for statement, (part, condition) in zip(found.statements, found.conditions.items(), strict=True):
        try:
            resolved(shape, {part: condition})
        except RsymError as error:
            raise statement.place.refuse(error.message, error.code, error.remedy) from None
    return StatedProblem(shape, found.equation, found.conditions)
