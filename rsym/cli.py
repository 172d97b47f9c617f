"""The command line: `rsym reproduce`, `rsym fields`, `rsym mesh`.

Exit codes: 0 done, 1 input refused, 2 usage. Everything heavy is imported by
the command that needs it, so `rsym --help` answers at once.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rsym.errors import RsymError

if TYPE_CHECKING:
    from rsym.model.shape import Shape


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code.

    Examples
    --------
    >>> main(["fields", "no-such-model.rf", "-o", "sheet.png"])
    1
    """
    options = _parser().parse_args(arguments)
    os.environ.setdefault("MPLBACKEND", "Agg")
    try:
        options.command(options)
    except RsymError as error:
        print(f"rsym: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("rsym: interrupted; nothing unfinished was written", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="rsym", description="Shapes as single equations: R-functions, level lines, meshes."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    reproduce = commands.add_parser("reproduce", help="draw the figures of the source paper and a page that shows them")
    reproduce.add_argument("--only", action="append", default=[], metavar="NAME", help="one figure, such as fig11")
    reproduce.add_argument("--out", default="figures", metavar="DIR", help="the folder (default: figures)")
    reproduce.set_defaults(command=_reproduce)

    fields = commands.add_parser("fields", help="draw the level lines of six fields")
    _add_model_options(fields, "the picture: .png, .svg or .pdf")
    fields.add_argument("--section", action="append", default=[], metavar="z=VALUE", help="cut a shape in space")
    fields.add_argument("--resolution", type=int, default=400, help="cells along the longer side (default: 400)")
    fields.set_defaults(command=_fields)

    mesh = commands.add_parser("mesh", help="triangulate the surface and write it")
    _add_model_options(mesh, "the mesh: .stl")
    mesh.add_argument("--resolution", type=int, default=128, help="cells along the longest side (default: 128)")
    mesh.add_argument("--revolve", metavar="AXIS", help="turn a plane model about this coordinate first")
    mesh.set_defaults(command=_mesh)
    return parser


def _add_model_options(parser: argparse.ArgumentParser, output: str) -> None:
    parser.add_argument("model", metavar="MODEL", help="a model file (.rf), or car, skeleton")
    parser.add_argument("-o", "--output", required=True, metavar="FILE", help=output)
    parser.add_argument("--set", action="append", default=[], metavar="LETTER=VALUE", help="another value of a letter")
    parser.add_argument("--variant", help="a variant of the model by name")
    parser.add_argument("--shape", help="another definition of the model than its last")


def _reproduce(options: argparse.Namespace) -> None:
    from tqdm import tqdm

    from rsym.paper.reproduction import reproduce

    with tqdm(total=1, unit="figure", disable=None) as bar:

        def progress(done: int, total: int, name: str) -> None:
            bar.total, bar.n = total, done
            bar.set_description(name)

        results = reproduce(options.out, only=options.only, progress=progress)
    for result in results:
        print(f"{result.path}  {result.seconds:.1f} s  {result.triangles} triangles")
    print(os.path.join(options.out, "index.html"))


def _fields(options: argparse.Namespace) -> None:
    import io
    from pathlib import Path

    from rsym.output.fields import plot_fields
    from rsym.output.files import write_atomically

    suffix = Path(options.output).suffix
    if suffix not in {".png", ".svg", ".pdf"}:
        raise RsymError(f"a picture cannot be written as {suffix!r}", code="suffix", remedy="use .png, .svg or .pdf")
    figure = plot_fields(
        _load(options),
        resolution=options.resolution,
        letters=_numbers(options.set, "--set"),
        section=_numbers(options.section, "--section"),
    )
    picture = io.BytesIO()
    figure.savefig(picture, format=suffix[1:], dpi=150, bbox_inches="tight")
    print(write_atomically(options.output, picture.getvalue()))


def _mesh(options: argparse.Namespace) -> None:
    from tqdm import tqdm

    from rsym.model.motions import revolve
    from rsym.output.files import write
    from rsym.sampling.meshing import mesh

    shape = _load(options)
    if options.revolve:
        shape = revolve(shape, axis=options.revolve)
    with tqdm(total=1, unit="slab", disable=None, desc="sampling") as bar:

        def progress(done: int, total: int) -> None:
            bar.total, bar.n = total, done
            bar.refresh()

        result = mesh(shape, options.resolution, letters=_numbers(options.set, "--set"), progress=progress)
    print(write(result, options.output))
    print(result.status)


def _load(options: argparse.Namespace) -> Shape:
    from rsym.model.language.loading import load
    from rsym.paper.models import MODELS, model_path

    path: Any = model_path(options.model) if options.model in MODELS else options.model
    return load(path, shape=options.shape, variant=options.variant)


def _numbers(texts: Sequence[str], option: str) -> dict[str, float]:
    numbers = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            numbers[name.strip()] = float(value)
        except ValueError as error:
            raise RsymError(f"{option} needs NAME=NUMBER, got {text!r}", code="number") from error
    return numbers


if __name__ == "__main__":
    sys.exit(main())
