"""What a report says, as data: a verdict, sentences that are each proved or numerical, tables, entries."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

# What a proof can answer.
CERTIFIED, REFUTED, DEGENERATE, UNDECIDED = "CERTIFIED", "REFUTED", "DEGENERATE", "UNDECIDED"


class Sentence(NamedTuple):
    """A sentence, and whether it is proved; else it is numerical."""

    text: str
    proved: bool


@dataclass(frozen=True)
class Tabular:
    """Rows of text under a header; the cells (row, column) of `best` are marked; told: whether the text has it too."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    best: frozenset[tuple[int, int]] = frozenset()
    title: str = ""
    told: bool = True


@dataclass(frozen=True)
class Entry:
    """One thing that a report lists: a place, a fault, a candidate.

    text : a line, or several; cells : its row in the table of entries; defect : whether it is one;
    label : instead of a number; told : whether the text has a line for it, for there may be many.
    """

    text: str
    proved: bool
    cells: tuple[str, ...] = ()
    defect: bool = False
    label: str | None = None
    told: bool = True


@dataclass(frozen=True)
class Document:
    """All that a report says.

    name : which report, the word of JSON's "format"; verdict, continuity : a word each, or None.
    headline : the first sentence, which begins with the verdict, if there is one.
    sentences : those after it, each with its full stop.
    statements : clauses without one, which are told as proved or as numerical.
    tables : beside that of the entries.
    entries : what is listed; columns : the header of their table, without the column of their numbers; most : how
        many of them the text tells.
    remarks : last lines.
    data : what programs read of it, by the name of the field.

    Examples
    --------
    >>> from rsym.reports.render import as_text
    >>> print(as_text(Document("x", Sentence("All is well.", True), statements=(Sentence("one is one", True),))))
    All is well. Proved: one is one.
    """

    name: str
    headline: Sentence
    verdict: str | None = None
    continuity: str | None = None
    sentences: tuple[Sentence, ...] = ()
    statements: tuple[Sentence, ...] = ()
    tables: tuple[Tabular, ...] = ()
    entries: tuple[Entry, ...] = ()
    columns: tuple[str, ...] = ()
    most: int | None = None
    remarks: tuple[Sentence, ...] = ()
    data: Mapping[str, Any] = field(default_factory=dict)

    @property
    def defects(self) -> tuple[Entry, ...]:
        """The entries that are defects."""
        return tuple(entry for entry in self.entries if entry.defect)


def proved(texts: Iterable[str]) -> tuple[Sentence, ...]:
    """Sentences that are proved."""
    return tuple(Sentence(text, True) for text in texts)


def numerical(texts: Iterable[str]) -> tuple[Sentence, ...]:
    """Sentences that are not."""
    return tuple(Sentence(text, False) for text in texts)
