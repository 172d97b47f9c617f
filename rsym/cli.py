# PYTHON_ARGCOMPLETE_OK
"""The command line: `rsym fields`, `rsym mesh` and the others of `rsym.commands`.

Exit codes: 0 done, 1 input refused, 2 usage; `rsym verify` answers 0 certified, 1 refuted,
3 undecided or degenerate; `rsym repair` 0 with candidates or without need, 1 without candidates;
`rsym lint` 0 clean, 1 findings; 130 interrupted by Ctrl-C. Everything heavy is imported by
the command that needs it, so `rsym --help` answers at once.
"""

from __future__ import annotations

import argparse
import gc
import importlib
import logging
import os
import pkgutil
import re
import sys
import textwrap
import warnings
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

from rsym import commands
from rsym.atomic import target_of
from rsym.commands.options import QUIET, OutputFile
from rsym.errors import RsymError, RsymWarning

INTERRUPTED = 130  # what shells call a command that Ctrl-C has ended: 128 and the number of the signal


def _found(*groups: str) -> dict[str, list[ModuleType]]:
    """The commands in these groups, and in others that they name: the modules of `rsym.commands` that name a group."""
    names = sorted(one.name for one in pkgutil.iter_modules(commands.__path__))
    modules = [importlib.import_module(f"{commands.__name__}.{name}") for name in names]
    found: dict[str, list[ModuleType]] = {group: [] for group in groups}
    for module in modules:
        if group := getattr(module, "GROUP", None):
            found.setdefault(group, []).append(module)
    return found


GROUPS = _found("models", "pictures", "meshes", "fields on shapes", "proofs", "the paper")
COMMANDS = tuple(command for group in GROUPS.values() for command in group)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; return its exit code.

    Examples
    --------
    >>> main(["fields", "no-such-model.rf", "-o", "sheet.png"])
    1
    """
    parser = _parser()
    _complete(parser)
    options = parser.parse_args(arguments)
    if arguments is None:  # a process of its own, that soon ends: to look for garbage less often saves a twentieth
        gc.set_threshold(100_000, 20, 20)
    os.environ.setdefault("MPLBACKEND", "Agg")
    notices = _Notices(logging.WARNING)
    if not options.quiet:
        logging.getLogger("rsym").addHandler(notices)
    quiet = QUIET.set(options.quiet)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RsymWarning)
            warnings.showwarning = _show_warning
            for given in vars(options).values():
                if isinstance(given, OutputFile):
                    target_of(Path(given))
            code: int | None = options.command(options)
        sys.stdout.flush()
    except RsymError as error:
        return _refused(_as_typed(str(error)))
    except KeyboardInterrupt:
        _say("interrupted; nothing unfinished was written")
        return INTERRUPTED
    except BrokenPipeError:
        # What is still to be flushed goes nowhere, or Python would complain at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _refused("whoever read the output left before its end; files are written whole all the same")
    finally:
        QUIET.reset(quiet)
        logging.getLogger("rsym").removeHandler(notices)
        if arguments is None:
            gc.freeze()  # else at its end the interpreter looks through all that was imported: a tenth of a second
    return code or 0


def _complete(parser: argparse.ArgumentParser) -> None:
    """Answer a shell that completes, which is no command; without the package argcomplete it gets no answer."""
    if "_ARGCOMPLETE" not in os.environ:
        return
    try:
        import argcomplete
    except ImportError:
        return
    argcomplete.autocomplete(parser)


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
    _say(f"warning: {_as_typed(str(message))}")


def _as_typed(text: str) -> str:
    """Bounds that a message names, as whoever types a command gives them.

    Examples
    --------
    >>> _as_typed("the inside goes on; remedy: give bounds=((xmin, xmax), ...), or cut it off")
    'the inside goes on; remedy: give --bounds x=MIN:MAX,..., or cut it off'
    >>> _as_typed("remedy: bounds=((-1.02, 1.02), (0, 2)), where the boundary lies; else bounds=... fit it")
    'remedy: --bounds x=-1.02:1.02,y=0:2, where the boundary lies; else --bounds ... fit it'
    """
    text = text.replace("bounds=((xmin, xmax), ...)", "--bounds x=MIN:MAX,...").replace("bounds=...", "--bounds ...")

    def ranges(found: re.Match[str]) -> str:
        pairs = re.findall(r"\(([^(), ]+), ([^(), ]+)\)", found[0])
        return "--bounds " + ",".join(f"{name}={low}:{high}" for name, (low, high) in zip("xyz", pairs, strict=False))

    return re.sub(r"bounds=\((\([^()]+\)(, )?)+\)", ranges, text)


def _refused(message: str) -> int:
    _say(message)
    return 1


class _Parser(argparse.ArgumentParser):
    """One that says what was probably meant."""

    def error(self, message: str) -> NoReturn:
        """The message of wrong usage, with the nearest of the words that there are."""
        from rsym.model.wording import proposal

        choice = re.search(r"invalid choice: '(.*?)' \(choose from (.*)\)", message)
        option = re.match(r"unrecognized arguments: (--[\w-]+)", message)
        meant = ""
        if choice:
            meant = proposal(choice.group(1), re.findall(r"[\w.-]+", choice.group(2)), "")
        elif option:
            meant = proposal(option.group(1), _options(self), "")
        super().error(f"{message}; {meant}" if meant else message)


def _options(parser: argparse.ArgumentParser) -> list[str]:
    """The long options of a parser and of its commands."""
    actions = parser._actions
    own = [name for action in actions for name in action.option_strings]
    inner = [one for action in actions if isinstance(action.choices, dict) for one in action.choices.values()]
    return [*own, *(name for one in inner for name in _options(one))]


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="rsym",
        description="Shapes as single equations: R-functions, level lines, meshes.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version of rsym")
    added = parser.add_subparsers(required=True, metavar="COMMAND", parser_class=_Parser)
    for command in COMMANDS:
        command.add(added)
    parser.epilog = _overview(added.choices)
    return parser


def _overview(added: Any) -> str:
    """The commands in groups, a line each."""
    lines = []
    for title, group in GROUPS.items():
        lines.append(f"{title}:")
        for module in group:
            name = module.__name__.rpartition(".")[2]
            summary = added[name].description.rstrip(".")
            text = f"{name:<12}{summary[0].lower()}{summary[1:]}"
            lines.append(textwrap.fill(text, 100, initial_indent="  ", subsequent_indent=" " * 14))
        lines.append("")
    return "\n".join([*lines, "rsym COMMAND --help explains a command and gives an example"])


class _Version(argparse.Action):
    """Looked up when it is asked for: what tells it takes as long to import as all the rest."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from rsym.version import __version__

        print(f"rsym {__version__}")
        parser.exit()


if __name__ == "__main__":
    sys.exit(main())
