"""The command line: `rsym fields`, `rsym mesh` and the others of `rsym.commands`.

Exit codes: 0 done, 1 input refused, 2 usage; `rsym verify` answers 0 certified, 1 refuted,
3 undecided or degenerate; `rsym repair` 0 with candidates or without need, 1 without candidates;
`rsym lint` 0 clean, 1 findings; 130 interrupted by Ctrl-C. Everything heavy is imported by
the command that needs it, so `rsym --help` answers at once.
"""

from __future__ import annotations

import argparse
import logging
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any

from rsym.commands import compare, fields, letters, lint, mesh, repair, reproduce, sections, show, sweep, verify, view
from rsym.errors import RsymError, RsymWarning

# Another command is one module beside these, and its name here and above.
INTERRUPTED = 130  # what shells call a command that Ctrl-C has ended: 128 and the number of the signal
COMMANDS = (reproduce, show, letters, fields, sections, sweep, mesh, view, verify, repair, compare, lint)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code.

    Examples
    --------
    >>> main(["fields", "no-such-model.rf", "-o", "sheet.png"])
    1
    """
    options = _parser().parse_args(arguments)
    os.environ.setdefault("MPLBACKEND", "Agg")
    notices = _Notices(logging.WARNING)
    logging.getLogger("rsym").addHandler(notices)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RsymWarning)
            warnings.showwarning = _show_warning
            code: int | None = options.command(options)
        sys.stdout.flush()
    except RsymError as error:
        return _refused(str(error))
    except KeyboardInterrupt:
        _say("interrupted; nothing unfinished was written")
        return INTERRUPTED
    except BrokenPipeError:
        # What is still to be flushed goes nowhere, or Python would complain at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _refused("whoever read the output left before its end; files are written whole all the same")
    finally:
        logging.getLogger("rsym").removeHandler(notices)
    return code or 0


class _Notices(logging.Handler):
    """What the library logs for those who wait."""

    def emit(self, record: logging.LogRecord) -> None:
        _say(record.getMessage())


def _say(text: str) -> None:
    """A line for whoever sits there, above a bar that may show progress."""
    bar: Any = sys.modules.get("tqdm")
    if bar is None:
        print(f"rsym: {text}", file=sys.stderr)
    else:
        bar.tqdm.write(f"rsym: {text}", file=sys.stderr)


def _show_warning(message: Warning | str, category: type[Warning], *_: Any, **__: Any) -> None:
    """One line, without the place in the code where it was found."""
    _say(f"warning: {message}")


def _refused(message: str) -> int:
    _say(message)
    return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="rsym",
        description="Shapes as single equations: R-functions, level lines, meshes.",
        epilog="rsym COMMAND --help explains a command and gives an example",
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version of rsym")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add(commands)
    return parser


class _Version(argparse.Action):
    """Looked up when it is asked for: what tells it takes as long to import as all the rest."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import PackageNotFoundError, version

        try:
            number = version("rsym")
        except PackageNotFoundError:
            number = "(not installed)"
        print(f"rsym {number}")
        parser.exit()


if __name__ == "__main__":
    sys.exit(main())
