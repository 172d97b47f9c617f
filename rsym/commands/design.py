"""`rsym design`: a page with the shape from its equation and a slider for each letter."""

from __future__ import annotations

import argparse
import shlex
from typing import TYPE_CHECKING

from rsym.commands.options import (
    AUTOMATIC,
    AUTOMATICALLY,
    Commands,
    add_command,
    add_model,
    add_output,
    add_resolution,
    add_revolve,
    add_system,
    load_shape,
    model_file,
)

if TYPE_CHECKING:
    from rsym.output.design.pages import Source

GROUP = "pictures"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "design",
        "open a page that draws the equation itself, with a slider for each letter",
        "rsym design car -o car.html",
        run,
    )
    add_model(parser)
    add_system(parser)
    add_revolve(parser)
    add_resolution(parser, AUTOMATIC, f"{AUTOMATICALLY}; of files. A formula too long to be drawn is shown at 128")
    add_output(parser, "write the page, .html, and serve nothing: it needs nothing else")
    parser.add_argument("--port", type=int, default=0, help="where to serve the page (default: one that is free)")
    parser.add_argument("--no-open", action="store_true", help="open no browser, only print the address")


def run(options: argparse.Namespace) -> None:
    """Write the page; or serve it to this computer until Ctrl-C, with files, verdict and lint from Python."""
    import webbrowser

    from rsym.model.requirements import path_ending
    from rsym.output.design.pages import DesignPage, page_of

    shape, title, source = load_shape(options), model_file(options.model).stem, source_of(options)
    cells = 128 if options.resolution == AUTOMATIC else options.resolution
    if options.output:
        path_ending(options.output, ".html", "a page is")
        print(DesignPage(page_of(shape, title=title, source=source, resolution=cells)).write(options.output))
        return
    from rsym.output.design.serving import DesignServer

    html = page_of(shape, title=title, source=source, served=True, resolution=cells)
    with DesignServer(shape, html, port=options.port, resolution=options.resolution, force=options.force) as server:
        print(f"{server.address}\nCtrl-C ends it", flush=True)
        if not options.no_open:
            webbrowser.open(server.address)
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            print()


def source_of(options: argparse.Namespace) -> Source:
    """The commands that do what the page offers, with the options that made the shape."""
    from rsym.output.design.pages import Source

    words = [options.model]
    for name in ("shape", "variant", "letters", "bounds", "system", "revolve", "extrude"):
        value = getattr(options, name)
        if value is not None:
            words += [f"--{name}", f"{value}"]
    for setting in options.set:
        words += ["--set", setting]
    model = shlex.join(words)
    return Source(
        f"rsym mesh {model}{{letters}} -o {{file}}",
        f"rsym verify {model}{{letters}}",
        f"rsym lint {model}{{letters}}",
        python=False,
    )
