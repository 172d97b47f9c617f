"""`rsym solve`: a differential equation on a shape, with conditions on its parts."""

from __future__ import annotations

import argparse

from rsym.commands.field_options import (
    add_conditions,
    add_equation,
    add_picture,
    add_poisson,
    add_refinement,
    check_output,
    load_problem,
    write_output,
)
from rsym.commands.options import Commands, add_command, add_model, add_section, progress_bar

GROUP = "fields on shapes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "solve",
        "solve an equation on a shape, with conditions on the parts of its boundary",
        'rsym solve plate.rf --equation "-laplacian(u) = 1" --on rim=0 --on "bore=robin(2, 1)" -o field.png',
        run,
    )
    add_model(parser)
    add_equation(parser, "that of the model file")
    add_conditions(parser, "those of the model file; where nothing is said nothing flows")
    add_refinement(parser)
    add_poisson(parser)
    add_section(parser)
    add_picture(parser)


def run(options: argparse.Namespace) -> None:
    """Solve, say how and what came out, and draw it."""
    from rsym.output.fields import plot_field
    from rsym.output.pictures import figure_of
    from rsym.reports.numbers import point, short

    problem = load_problem(options)
    check_output(options, problem.shape)
    with progress_bar("grid", "solving") as progress:
        found = problem.solve(
            degree=options.degree,
            cells=options.cells,
            tolerance=options.tolerance,
            axis=options.axis,
            poisson=options.poisson,
            progress=progress,
        )
    least, most = found.minimum(), found.maximum()
    size, reach = max(abs(least.value), abs(most.value)), float(abs(found.rule.points).max())
    print(found.report)
    for word, one in (("minimum", least), ("maximum", most)):
        print(f"  {word:<8}  {short(one.value, size)} at {point(one.point, 4, reach)}")
    for name, level in found.levels:
        print(f"  level     {short(level, size)} on {name}")
    print(f"  integral  {short(found.integral(), size * float(found.rule.weights.sum()))}")
    write_output(found, lambda: figure_of(plot_field(found)), options)
