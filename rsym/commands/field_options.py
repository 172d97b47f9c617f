"""What commands share that solve equations on shapes: an equation and conditions, refinement, a section, a picture."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

from rsym.commands.options import add_output, load_model, numbers
from rsym.errors import RsymError

if TYPE_CHECKING:
    from rsym.model.shape import Shape
    from rsym.output.field_data import Field
    from rsym.problems.refinement import Grade
    from rsym.problems.stated import StatedProblem

DATA, LINES = ".vtu", ".dxf"


def add_picture(parser: argparse.ArgumentParser, *, lines: bool = True) -> None:
    """The picture, which need not be; `lines`: whether there are level lines."""
    drawn = f", {LINES} for level lines" if lines else ""
    add_output(parser, f"a picture: .png, .svg, .pdf or .eps; or {DATA} for ParaView{drawn}")
    parser.set_defaults(lined=lines)


def check_output(options: argparse.Namespace, shape: Shape) -> None:
    """Refuse a name that nothing of a field on this shape can be written to: asked before the work, not after it."""
    from rsym.model.requirements import optional_package
    from rsym.output.pictures import picture_suffix

    if options.output is not None:
        if options.output.lower().endswith(DATA):
            optional_package("meshio", f"a file {DATA}")
            return
        if not (options.lined and options.output.lower().endswith(LINES)):
            picture_suffix(options.output)
        if shape.dimension != 2:
            raise RsymError(
                f"a field in space has no picture in the plane, got {options.output}",
                code="section",
                remedy=f"-o field{DATA}, or --section of the shape",
            )


def write_output(found: Field, draw: Callable[[], Any], options: argparse.Namespace) -> None:
    """What was found as a file for ParaView, or its picture, where one was asked for; say where it is."""
    from rsym.output.files import write
    from rsym.output.pictures import write_picture

    if options.output is not None:
        to_others = options.output.lower().endswith((DATA, LINES))
        print(write(found, options.output) if to_others else write_picture(draw(), options.output))


def add_equation(parser: argparse.ArgumentParser, default: str) -> None:
    """A differential equation as text."""
    parser.add_argument(
        "--equation",
        metavar="TEXT",
        help=f'in u, such as "-div(k*grad(u)) + c*u = f", with blanks in it (default: {default})',
    )


def add_conditions(parser: argparse.ArgumentParser, default: str) -> None:
    """Conditions on parts of the boundary, as text."""
    parser.add_argument(
        "--on",
        action="append",
        default=[],
        metavar="PART=CONDITION",
        help='a value, or "neumann(h)", "robin(c, h)", "constant(flow)", "clamped()", "supported()"; '
        f"others=... is the rest (default: {default})",
    )


def add_refinement(parser: argparse.ArgumentParser, *, axis: bool = True) -> None:
    """Splines, cells, and when the error is small enough."""
    parser.add_argument("--degree", type=int, default=4, metavar="DEGREE", help="of the splines, 1 to 6 (default: 4)")
    parser.add_argument("--cells", type=int, metavar="CELLS", help="along the longest side; without refinement")
    parser.add_argument(
        "--tolerance",
        type=float,
        metavar="SHARE",
        help="refine until the estimate of the error is below (default: 1e-8)",
    )
    if axis:
        parser.add_argument(
            "--axis", metavar="NAME", help="the shape is half the section of a body turned about this coordinate"
        )


def add_poisson(parser: argparse.ArgumentParser) -> None:
    """Poisson's ratio of a plate."""
    parser.add_argument(
        "--poisson", type=float, metavar="RATIO", help="Poisson's ratio of a plate, which free and curved edges ask for"
    )


def cut_shape(shape: Shape, options: argparse.Namespace) -> Shape:
    """The plane shape that a section cuts out of one in space, if the options of `add_section` say so."""
    from rsym.model.constructions import section

    for axis, place in numbers(options.section, "--section").items():
        shape = section(shape, axis, place)
    return shape


def load_problem(options: argparse.Namespace) -> StatedProblem:
    """The shape that the options ask for, and what is stated of a function on it there or else in the file."""
    from rsym.language.conditions import parse_condition
    from rsym.language.equations import parse_statement
    from rsym.problems.stated import problem_stated

    chosen = load_model(options)
    equation = chosen.model.equation
    if options.equation is not None:
        with _spoken("--equation"):
            equation = parse_statement(options.equation)
    conditions = chosen.model.conditions
    if options.on:
        with _spoken("--on"):
            conditions = tuple(map(parse_condition, options.on))
    shape = cut_shape(chosen.shape, options)
    with _spoken("--equation and --on") if options.equation or options.on else nullcontext():
        problem = problem_stated(chosen.model, shape, chosen.letters, equation, conditions)
    problem.shape.letters.values_with(numbers(options.set, "--set"))
    return problem


@contextmanager
def _spoken(option: str) -> Iterator[None]:
    """Say in which option of the command line something is refused."""
    try:
        yield
    except RsymError as error:
        raise RsymError(f"{option}: {error.message}", code=error.code, where=error.where, remedy=error.remedy) from None


def error_of(grades: Sequence[Grade], value: float) -> float:
    """The estimate of the error of a value that was refined; unknown where it was not."""
    return grades[-1].estimate * abs(value) if grades else math.nan
