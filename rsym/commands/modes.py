"""`rsym modes`: the least eigenvalues of a shape, and its modes."""

from __future__ import annotations

import argparse

from rsym.commands.field_options import (
    add_conditions,
    add_equation,
    add_picture,
    add_poisson,
    add_refinement,
    check_output,
    error_of,
    load_problem,
    write_output,
)
from rsym.commands.options import Commands, add_command, add_model, add_section, progress_bar

GROUP = "fields on shapes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "modes",
        "compute the least eigenvalues of a shape, and draw its modes",
        "rsym modes drum.rf --count 6 -o modes.png",
        run,
    )
    add_model(parser)
    parser.add_argument("--count", type=int, default=6, metavar="COUNT", help="how many (default: 6)")
    add_equation(parser, 'that of the model file, or "-laplacian(u) = 0"; its operator is meant')
    add_conditions(parser, "those of the model file, or 0 on all of the boundary")
    add_refinement(parser)
    add_poisson(parser)
    add_section(parser)
    add_picture(parser, lines=False)


def run(options: argparse.Namespace) -> None:
    """Compute them, print the eigenvalues, and draw the modes."""
    from rsym.output.modes import plot_modes
    from rsym.problems.spectra import modes
    from rsym.reports.numbers import measured

    problem = load_problem(options)
    check_output(options, problem.shape)
    with progress_bar("grid", "solving") as progress:
        found = modes(
            problem.shape,
            options.count,
            problem.conditions or None,
            equation="-laplacian(u) = 0" if problem.equation is None else problem.equation,
            degree=options.degree,
            cells=options.cells,
            tolerance=options.tolerance,
            axis=options.axis,
            poisson=options.poisson,
            progress=progress,
        )
    print(f"{'mode':>4}  eigenvalue")
    for number, value in enumerate(found.values, 1):
        print(f"{number:>4}  {measured(float(value), error_of(found.grades, float(value)))}")
    write_output(found, lambda: plot_modes(found), options)
