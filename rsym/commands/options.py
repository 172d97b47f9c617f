"""What commands share: a model with letters, cells, sections, a bar that shows progress."""

from __future__ import annotations

import argparse
import logging
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from rsym.errors import RsymError

if TYPE_CHECKING:
    from tqdm import tqdm

    from rsym.language.model import ModelFile
    from rsym.model.bounding import Exact
    from rsym.model.letters import Letters
    from rsym.model.shape import Shape
    from rsym.model.systems import RSystem

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
Run: TypeAlias = Callable[[argparse.Namespace], int | None]

QUIET = ContextVar("quiet", default=False)  # whether the command that runs shows no progress
COMPILER = logging.getLogger("rsym.sampling.sharp.loops")
MOST_VALUES = 10_000  # of a run start:stop:step


def add_command(commands: Commands, name: str, summary: str, example: str, run: Run) -> argparse.ArgumentParser:
    """A command with its summary, its example at the end of the help, and what it does."""
    parser = commands.add_parser(
        name,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example:\n  {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(command=run)
    parser.add_argument(
        "-q", "--quiet", action="store_true", help="no progress on the terminal; warnings and errors stay"
    )
    return parser


def add_model(parser: argparse.ArgumentParser, setting: str = "a value that comes first") -> None:
    """The options that say which shape of which model, with which letters."""
    group = parser.add_argument_group("the model")
    add_model_name(group)
    group.add_argument("--shape", metavar="NAME", help="another definition of the model than omega or the last")
    group.add_argument("--variant", metavar="NAME", help="a variant of the model")
    group.add_argument("--letters", metavar="FILE", help="values of letters, as rsym.save_letters writes them")
    group.add_argument("--set", action="append", default=[], metavar="LETTER=VALUE", help=setting)
    group.add_argument("--bounds", metavar="RANGES", help="the box that holds what is of interest: x=-1:1,y=0:2,z=0:4")


def add_model_name(group: argparse._ActionsContainer) -> None:
    """The model; a shell that completes is told the names of those that come with rsym."""
    action = group.add_argument(
        "model", metavar="MODEL", help="a model file (.rf or .vm), or a shipped one; rsym models lists them"
    )
    action.completer = _completed  # type: ignore[attr-defined]


def _completed(prefix: str, **_: Any) -> list[str]:
    """The shipped models and the model files that begin so; loads nothing heavy, for a shell waits."""
    folder = Path(__file__).parent.parent / "paper"
    names = [path.stem for path in (*folder.glob("*.rf"), *folder.glob("*/*.rf"))]
    here = [path for path in glob(f"{prefix}*") if path.endswith((".rf", ".vm")) or Path(path).is_dir()]
    return sorted(name for name in names if name.startswith(prefix)) + here


class Listed:
    """A list in a help text, made when that text is printed: the table that it lists is slow to import."""

    def __init__(self, tell: Callable[[], str]) -> None:
        self.tell = tell

    def __str__(self) -> str:
        return self.tell()


def explain(action: argparse.Action, text: str, tell: Callable[[], str]) -> None:
    """Give an option its help, in which ``%(known)s`` stands for a list."""
    action.known = Listed(tell)  # type: ignore[attr-defined]
    action.help = text


class OutputFile(str):
    """The name of a file to write: before a command begins to work its folder is asked for."""


def add_output(parser: argparse.ArgumentParser, what: str, *names: str, required: bool = False) -> argparse.Action:
    """A file to write; without another name it is -o."""
    return parser.add_argument(
        *(names or ("-o", "--output")), required=required, type=OutputFile, metavar="FILE", help=what
    )


# The resolution that `rsym.mesh` looks for, where a command asks for it.
AUTOMATIC = "auto"
AUTOMATICALLY = f"{AUTOMATIC}: 128, and more where more resolves something, up to 512"


def add_resolution(parser: argparse.ArgumentParser, default: int | str | None, note: str = "") -> None:
    """Cells along the longest side, or along each axis, and going on where they are too many; or "auto"."""
    parser.add_argument(
        "--resolution",
        type=(lambda text: text if text == AUTOMATIC else cells(text)) if default == AUTOMATIC else cells,
        default=default,
        metavar="CELLS",
        help=f"along the longest side, or along each axis: 240,480,420 (default: {note or default})",
    )
    parser.add_argument(
        "--force", action="store_true", help="go on where the estimate says that there is not memory enough"
    )


def add_section(parser: argparse.ArgumentParser) -> None:
    """A cut through a shape in space."""
    parser.add_argument(
        "--section", action="append", default=[], metavar="NAME=VALUE", help="cut a shape in space, such as z=1"
    )


def add_system(parser: argparse.ArgumentParser) -> None:
    """Another R-system for the logic of the model."""
    parser.add_argument(
        "--system", metavar="SYSTEM", help='the same logic in another R-system: R0, R1, "Rp 4", as a model file has it'
    )


def add_revolve(parser: argparse.ArgumentParser) -> None:
    """Turning a plane model, or lifting it."""
    bodies = parser.add_mutually_exclusive_group()
    bodies.add_argument("--revolve", metavar="AXIS", help="turn a plane model about this coordinate first")
    bodies.add_argument("--extrude", type=float, metavar="H", help="make a plane model a prism of this height first")


def cells(text: str) -> int | tuple[int, ...]:
    """A resolution as it is typed.

    Examples
    --------
    >>> cells("128"), cells("240,480,420")
    (128, (240, 480, 420))
    """
    try:
        numbers = tuple(int(part) for part in text.split(","))
    except ValueError:
        message = f"expected a number of cells, or one for each axis such as 240,480,420; got {text!r}"
        raise argparse.ArgumentTypeError(message) from None
    return numbers[0] if len(numbers) == 1 else numbers


def values(text: str) -> list[float]:
    """Numbers as they are typed, one by one or as start:stop:step with both ends.

    Examples
    --------
    >>> values("20,40,80")
    [20.0, 40.0, 80.0]
    >>> values("-0.5:1:0.5,3")
    [-0.5, 0.0, 0.5, 1.0, 3.0]
    """
    try:
        return [number for part in text.split(",") for number in _run(part)]
    except (ValueError, ArithmeticError):
        message = f"expected numbers such as 20,40,80 or start:stop:step such as 0:4:0.5; got {text!r}"
        raise argparse.ArgumentTypeError(message) from None


def _run(text: str) -> list[float]:
    """One number, or start, start + step, ... up to stop; counted in decimals, so that 0:1:0.1 ends at 1."""
    start, *rest = map(Decimal, text.split(":"))
    if not rest:
        return [float(start)]
    stop, step = rest
    count = int((stop - start) / step) + 1
    if not 1 <= count <= MOST_VALUES:
        raise ValueError
    return [float(start + k * step) for k in range(count)]


def numbers(texts: Sequence[str], option: str) -> dict[str, float]:
    """Names and values as they are typed: ``["a=1", "b=2.5"]``.

    Examples
    --------
    >>> numbers(["a=1", "b=2.5"], "--set")
    {'a': 1.0, 'b': 2.5}
    """
    result = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            result[name.strip()] = float(value)
        except ValueError:
            raise RsymError(
                f"{option} needs NAME=NUMBER, got {text!r}", code="number", remedy=f"for example {option} z=1.5"
            ) from None
    return result


def ranges(texts: Sequence[str], option: str) -> tuple[list[str], dict[str, tuple[float, float]]]:
    """Settings with one value as they are, and those with a range: ``name=low:high``.

    Examples
    --------
    >>> ranges(["a=1", "b=2:2.5"], "--set")
    (['a=1'], {'b': (2.0, 2.5)})
    """
    single, found = [], {}
    for text in texts:
        name, _, value = text.partition("=")
        low, colon, high = value.partition(":")
        if not colon:
            single.append(text)
            continue
        start, stop = (numbers([f"{name}={end}"], option)[name.strip()] for end in (low, high))
        if not -math.inf < start < stop < math.inf:
            raise RsymError(
                f"{option} needs NAME=LOW:HIGH with LOW below HIGH, got {text!r}",
                code="number",
                remedy=f"for example {option} a=1:2",
            )
        found[name.strip()] = (start, stop)
    return single, found


def system_named(text: str) -> RSystem:
    """An R-system as a model file names it.

    Examples
    --------
    >>> system_named("Rp 4"), system_named("Ralpha(1/2)")
    (Rp(p=4), RAlpha(alpha=1/2))
    """
    from rsym.language.model import system
    from rsym.language.parser import parse
    from rsym.language.syntax import SystemStatement

    try:
        (statement,) = parse(f"system {text}")
        assert isinstance(statement, SystemStatement)
        return system(statement, {})
    except RsymError as error:
        raise RsymError(f"--system {text}: {error.message}", code=error.code, remedy=error.remedy) from None
    except ValueError:
        raise RsymError(f"--system takes one R-system, got {text!r}", code="unknown-system", remedy="Rp 4") from None


def model_file(name: str) -> Path:
    """The file of a model that is named by its path or, if it comes with rsym, by its name."""
    from rsym.model.wording import proposal
    from rsym.paper.models import MODELS, model_path

    if name in MODELS:
        return model_path(name)
    if not Path(name).exists():
        remedy = proposal(name, MODELS, f"give the path of a model file, or one of {', '.join(MODELS)}")
        raise RsymError(f"no model file {name!r}", code="missing-file", remedy=remedy)
    return Path(name)


@dataclass(frozen=True)
class Chosen:
    """A model file, all its letters with the values that the options give, and the shape that they ask for."""

    path: Path
    model: ModelFile
    letters: Letters
    shape: Shape


def load_model(options: argparse.Namespace) -> Chosen:
    """Read the model and apply the options that `add_model` has added.

    A preset may set letters that the chosen shape does not need: it was written for the whole model.
    """
    from rsym.language.loading import read_model
    from rsym.model.letters import Letters
    from rsym.output.models import load_letters

    path = model_file(options.model)
    shape, model = read_model(path, shape=options.shape, variant=options.variant)
    letters = Letters({**model.letters, **model.variants.get(options.variant, {})})
    preset = load_letters(options.letters) if options.letters else {}
    letters = letters.changed({**preset, **numbers(options.set, "--set")})
    if getattr(options, "bounds", None) is not None:
        shape = shape.replace(bounds=_box(options.bounds, shape))
    return Chosen(path, model, letters, shape.with_letters({name: letters[name] for name in shape.letters}))


def _box(text: str, shape: Shape) -> Exact:
    """Bounds as they are typed, decimals exact, one range for each coordinate."""
    single, box = ranges(text.split(","), "--bounds")
    names = [symbol.name for symbol in shape.coordinates]
    if single or sorted(box) != sorted(names):
        example = ",".join(f"{name}=-1:1" for name in names)
        raise RsymError(f"--bounds needs a range for each coordinate, got {text!r}", code="bounds", remedy=example)
    return tuple((Fraction(repr(low)), Fraction(repr(high))) for low, high in (box[name] for name in names))


def load_shape(options: argparse.Namespace) -> Shape:
    """The shape that the options ask for, in their R-system, turned if they say so."""
    shape = load_model(options).shape
    shape.letters.values_with(numbers(options.set, "--set"))  # refuses a letter that this shape does not need
    if getattr(options, "system", None) is not None:
        shape = shape.with_system(system_named(options.system))
    return made_body(shape, options)


def made_body(shape: Shape, options: argparse.Namespace) -> Shape:
    """A plane shape turned or lifted, if the options of `add_revolve` say so."""
    from rsym.model.constructions import extrude, revolve

    axis, height = getattr(options, "revolve", None), getattr(options, "extrude", None)
    if height is not None and not 0 < height < math.inf:
        raise RsymError(f"--extrude needs a height above 0, got {height:g}", code="number", remedy="--extrude 10")
    if height is not None:
        return extrude(shape, 0, height)
    return revolve(shape, axis=axis) if axis else shape


@contextmanager
def progress_bar(unit: str, label: str) -> Iterator[ProgressBar]:
    """A bar on the terminal, none in a file; what it gives is a ``progress(done, total)``."""
    from tqdm import tqdm

    with tqdm(total=1, unit=unit, desc=label, disable=True if QUIET.get() else None, leave=False) as bar:
        progress = ProgressBar(bar, label)
        notes, before = _Notes(progress), COMPILER.level
        if not QUIET.get():
            COMPILER.addHandler(notes)
            COMPILER.setLevel(logging.INFO)
        try:
            yield progress
        finally:
            COMPILER.removeHandler(notes)
            COMPILER.setLevel(before)


class ProgressBar:
    """A progress as a bar that shows the stage at work and what is undecided so far."""

    def __init__(self, bar: tqdm[Any], label: str) -> None:
        self._bar, self._label, self._noted = bar, label, False

    def describe(self, stage: str, undecided: float) -> None:
        """Show the stage in front of the bar, and behind it the share that is undecided, if it is known."""
        self._bar.set_description_str(f"{self._label}: {stage}", refresh=False)
        if not math.isnan(undecided):
            self._bar.set_postfix_str(f"undecided {100 * undecided:.{2 if undecided < 0.99 else 3}g} %", refresh=False)

    def note(self, text: str) -> None:
        """Show behind the bar what holds it up, until it goes on."""
        self._noted = True
        self._bar.set_postfix_str(text)

    def __call__(self, done: int, total: int) -> None:
        """Show so many of all steps as done."""
        if self._noted:
            self._noted = False
            self._bar.set_postfix_str("", refresh=False)
        self._bar.total, self._bar.n = total, done
        self._bar.refresh()


class _Notes(logging.Handler):
    """What is compiled meanwhile, behind a bar."""

    def __init__(self, progress: ProgressBar) -> None:
        super().__init__(logging.INFO)
        self._progress = progress

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno == logging.INFO:  # what is more stands above the bar
            self._progress.note(record.getMessage())


def add_timeout(parser: argparse.ArgumentParser, end: str) -> None:
    """The option for a limit of time."""
    parser.add_argument("--timeout", type=float, metavar="SECONDS", help=f"the time allowed; {end}")
