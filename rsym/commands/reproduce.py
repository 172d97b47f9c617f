"""`rsym reproduce`: the figures of the source paper and of parametric surfaces."""

from __future__ import annotations

import argparse
import os

from rsym.commands.options import Commands, add_command

PROCESSES = 2  # one figure may take a gigabyte
GROUP = "the paper"


def add(commands: Commands) -> None:
    """Describe the command."""
    parser = add_command(
        commands,
        "reproduce",
        "draw the figures of the source paper and of parametric surfaces, and a page that shows them",
        "rsym reproduce --only fig11 --out figures",
        run,
    )
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="one figure, such as fig11")
    parser.add_argument("--out", default="figures", metavar="DIR", help="the folder (default: figures)")


def run(options: argparse.Namespace) -> None:
    """Draw, and say what was drawn."""
    from tqdm import tqdm

    from rsym.backends.kernel import checked_threads
    from rsym.paper.reproduction import reproduce

    tqdm.monitor_interval = 0  # without threads, processes that draw begin as copies of this one
    with tqdm(total=1, unit="figure", disable=None) as bar:

        def progress(done: int, total: int, name: str) -> None:
            bar.total, bar.n = total, done
            bar.set_description(name)

        results = reproduce(
            options.out, only=options.only, progress=progress, processes=min(PROCESSES, checked_threads(None))
        )
    for result in results:
        print(f"{result.path}  {result.seconds:.1f} s  {result.triangles} triangles")
    print(os.path.join(options.out, "index.html"))
