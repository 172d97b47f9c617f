"""A shape as a model text that loads to the same formula, operation by operation."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

import sympy as sp
from sympy.logic.boolalg import BooleanAtom

from rsym.analysis.contracts.leaves import names_of
from rsym.errors import RsymError, warn
from rsym.language.functions import NODES, PIECEWISE, written_system
from rsym.language.loading import loads
from rsym.language.pieces import PIECES
from rsym.language.scanner import LONGEST_NAME
from rsym.language.sentences import ATOM, CODE, Sentences, Written, common_system, number_text, unspeakable
from rsym.language.syntax import RESERVED
from rsym.model.letters import Letter
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import postorder

HEADER = "% A model of rsym. After the word verbatim every operation stays as it is written, and decimals are floats."
LONGEST_LINE = 240  # characters of a formula; what is longer is taken apart
SHORT = 12  # characters of a formula that is written as often as it stands


def dumps(shape: Shape) -> str:
    """A model text that `loads` reads as the same shape: the same program, letters, bounds if stated, and parts.

    Every operation is written as it stands; shared parts are written once and have names, those of the shape's own
    parts and definitions where they have one.

    Warns
    -----
    RsymWarning
        For a letter that is no fraction, as sqrt(2): the nearest float is written.

    Raises
    ------
    RsymError
        For what the language cannot say, by name: a SymPy function that no program holds, names that are none in the
        language, texts of more than one line, formulas larger than a model file may be. What is written was read
        again and is the same.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-1, 1), (-1, 1))).named("disc")
    >>> print(dumps(disc.rotate(1) & rsym.Shape(x, (x, y))))  # doctest: +ELLIPSIS
    % A model of rsym...
    verbatim
    coordinates x y
    bounds x [-1.3817732906760363, 1.3817732906760363] y [-1.3817732906760363, 1.3817732906760363]
    ...
    >>> rsym.loads(dumps(disc)) == disc
    True
    """
    require_shape(shape)
    exact = {name: letter.default for name, letter in shape.letters.items() if isinstance(letter.default, sp.Expr)}
    if exact:
        named = ", ".join(f"{name} = {value}" for name, value in exact.items())
        warn(f"a letter of a model file is a fraction: of {named} the nearest float is written")
        shape = shape.with_letters({name: float(value) for name, value in exact.items()})
    try:
        text = "\n".join(_Writer(shape).lines()) + "\n"
        again = loads(text)
    except RecursionError:
        raise unspeakable("a formula nested so deeply") from None
    except RsymError as error:
        if error.code == CODE:
            raise
        raise unspeakable(f"this shape: {error.message}") from error
    if found := _difference(shape, again):
        raise unspeakable(found)
    return text


class _Writer:
    """The statements of one shape."""

    def __init__(self, shape: Shape) -> None:
        self._shape = shape
        names = [symbol.name for symbol in shape.coordinates]
        self._taken = {*names, *shape.letters, *RESERVED, *PIECES, *NODES, PIECEWISE, "nan", "pi", "inf"}
        for name in (*names, *shape.letters):
            _check_name(name)
        self._roots = list(dict.fromkeys((*(part for _, part in shape.parts), shape.expression)))
        self._order = [part for part in postorder(*self._roots) if not isinstance(part, BooleanAtom)]
        self._system = common_system(self._order)
        self._sentences = Sentences(self._system)
        self._names = self._wanted_names()
        self._formulas: list[str] = []
        self._count = 0

    def lines(self) -> Iterator[str]:
        """Declarations, formulas, parts."""
        shape = self._shape
        names = [symbol.name for symbol in shape.coordinates]
        yield HEADER
        yield "verbatim"
        yield f"coordinates {' '.join(names)}"
        if shape.box is not None and shape.box.exact is not None:
            box = zip(names, shape.box.exact, strict=True)
            yield "bounds " + " ".join(f"{name} [{number_text(low)}, {number_text(high)}]" for name, (low, high) in box)
        if (title := written_system(self._system)) != "R0":
            yield f"system {title}"
        yield from (_letter(name, letter) for name, letter in shape.letters.items())
        self._write()
        yield from self._formulas
        for name, part in shape.parts:
            yield f"part {_quoted(name, 'the name of a part')} = {self._sentences.done[part].text}"

    def _write(self) -> None:
        users: Counter[sp.Basic] = Counter(argument for part in dict.fromkeys(self._order) for argument in part.args)
        for part in self._order:
            if part in self._sentences.done:
                continue
            written = self._sentences.written(part)
            is_formula = bool(part.args) and isinstance(part, sp.Expr)
            wanted = part in self._names or part == self._shape.expression
            shared = users[part] > 1 and len(written.text) > SHORT
            if wanted or (is_formula and (shared or len(written.text) > LONGEST_LINE)):
                written = self._defined(part, written)
            self._sentences.done[part] = written

    def _defined(self, part: sp.Basic, written: Written) -> Written:
        """A statement for this part; its name stands for it from now on."""
        if part == self._shape.expression:
            name = self._fresh("omega")
        elif part in self._names:
            name = self._names[part]
        else:
            self._count += 1
            name = self._fresh(f"t{self._count}")
        self._formulas.append(f"{name} = {written.text}")
        return Written(name, ATOM)

    def _fresh(self, wish: str) -> str:
        name, count = wish, 1
        while name in self._taken:
            count += 1
            name = f"{wish}_{count}"
        self._taken.add(name)
        return name

    def _wanted_names(self) -> dict[sp.Basic, str]:
        """Names for parts and definitions that stand in the formula as they are."""
        inside, names = set(self._order), dict[sp.Basic, str]()
        for part, title in names_of(self._shape).items():
            if part in inside and part.args and part != self._shape.expression and -part not in names:
                word = re.sub(r"\W+", "_", title, flags=re.ASCII).strip("_")[: LONGEST_NAME - 4]
                if word and not word[0].isdigit() and "omega" != word:
                    names[part] = self._fresh(word)
        return names


def _letter(name: str, letter: Letter) -> str:
    text = f"letter {name} = {number_text(letter.default)}"
    if letter.minimum is not None or letter.maximum is not None:
        low, high = (
            endless if end is None else number_text(end)
            for end, endless in ((letter.minimum, "-inf"), (letter.maximum, "inf"))
        )
        text += f" in [{low}, {high}]"
    if letter.unit:
        text += f" unit {_quoted(letter.unit, f'the unit of the letter {name}')}"
    return text + (f" {_quoted(letter.doc, f'the text of the letter {name}')}" if letter.doc else "")


def _quoted(text: str, what: str) -> str:
    if not isinstance(text, str) or any(end in text for end in "\n\r"):
        raise unspeakable(f"{what}, which has more than one line")
    if any("\ud800" <= character <= "\udfff" for character in text):
        raise unspeakable(f"{what}, which holds half a character")
    doubled = text.replace('"', '""')
    return f'"{doubled}"'


def _check_name(name: str) -> None:
    if not re.fullmatch(rf"[A-Za-z][A-Za-z0-9_]{{0,{LONGEST_NAME - 1}}}", name) or name in RESERVED:
        raise unspeakable(f"the name {name!r}: a name has up to {LONGEST_NAME} letters A-Z, a-z, digits, underscores")


def _difference(shape: Shape, again: Shape) -> str:
    """What of a shape is another after it was read again, in words; nothing if it is the same."""
    if [symbol.name for symbol in shape.coordinates] != [symbol.name for symbol in again.coordinates]:
        return "these coordinates"
    if list(shape.letters.items()) != list(again.letters.items()):
        return "these letters"
    if (shape.box and shape.box.exact) != (again.box and again.box.exact):
        return "these bounds"
    if [name for name, _ in shape.parts] != [name for name, _ in again.parts]:
        return "these parts"
    pairs = [(shape.expression, again.expression)]
    pairs += [(old, new) for (_, old), (_, new) in zip(shape.parts, again.parts, strict=True)]
    seen: set[tuple[int, int]] = set()
    while pairs:
        old, new = pairs.pop()
        if (id(old), id(new)) in seen:
            continue
        seen.add((id(old), id(new)))
        alike = type(old) is type(new) and len(old.args) == len(new.args)
        if isinstance(old, sp.Symbol):
            alike = alike and old.name == new.name
        elif not old.args:
            alike = alike and old == new
        if not alike:
            return f"{sp.sstr(old)[:80]} as it stands: it would become {sp.sstr(new)[:80]}"
        pairs.extend(zip(old.args, new.args, strict=True))
    return ""
