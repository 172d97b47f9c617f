"""`rsym torsion`: how stiff a shaft is when it is twisted, and its stresses."""

from __future__ import annotations

import argparse

from rsym.commands.field_options import add_picture, add_refinement, check_output, cut_shape, error_of, write_output
from rsym.commands.options import Commands, add_command, add_model, add_section, load_shape, progress_bar

GROUP = "fields on shapes"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "torsion",
        "twist a shaft whose section is a plane shape: its rigidity and stresses",
        "rsym torsion shaft.rf -o stresses.png",
        run,
    )
    add_model(parser)
    add_refinement(parser, axis=False)
    add_section(parser)
    add_picture(parser)


def run(options: argparse.Namespace) -> None:
    """Compute the torsion, print it, and draw its stress lines."""
    from rsym.output.pictures import figure_of
    from rsym.output.torsion import plot_torsion
    from rsym.problems.torsion import torsion
    from rsym.reports.numbers import measured, point, short

    shape = cut_shape(load_shape(options), options)
    check_output(options, shape)
    with progress_bar("grid", "solving") as progress:
        found = torsion(
            shape, degree=options.degree, cells=options.cells, tolerance=options.tolerance, progress=progress
        )
    most = found.greatest_stress()
    print(f"rigidity         {measured(found.rigidity, error_of(found.grades, found.rigidity))}")
    print(f"greatest stress  {short(most.value)} at {point(most.point, 4)}, for the shear modulus and the twist 1")
    for level, area in zip(found.levels, found.areas, strict=True):
        print(f"hole             of the area {short(area)}, at the level {short(level)}")
    print(f"unknowns         {found.solution.report.unknowns}")
    write_output(found, lambda: figure_of(plot_torsion(found)), options)
