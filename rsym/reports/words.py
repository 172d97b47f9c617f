"""Parts of sentences: counts with their nouns, enumerations, and what is spoken of, where and with which letters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rsym.reports.numbers import number

# Values of so many letters are a sentence; of more only the first few are told.
MOST_LETTERS, FIRST_LETTERS = 8, 3


def plural(count: int, one: str, many: str = "") -> str:
    """A count with its noun.

    Examples
    --------
    >>> plural(1, "box", "boxes"), plural(2, "place")
    ('1 box', '2 places')
    """
    return f"{count} {one if count == 1 else many or one + 's'}"


def listed(words: Sequence[str]) -> str:
    """Words with commas, the last after "and".

    Examples
    --------
    >>> listed(["roof"]), listed(["roof", "boot", "side"]), listed([])
    ('roof', 'roof, boot and side', '')
    """
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def first_of(words: Sequence[str], most: int, last: str = "more") -> str:
    """The first of many, and how many more there are.

    Examples
    --------
    >>> first_of("abc", 3), first_of("abcde", 3), first_of("abcde", 3, "other places")
    ('a, b, c', 'a, b, c and 2 more', 'a, b, c and 2 other places')
    """
    more = f" and {len(words) - most} {last}" if len(words) > most else ""
    return ", ".join(words[:most]) + more


def box_text(bounds: Sequence[tuple[float, float]]) -> str:
    """Intervals and what lies between them.

    Examples
    --------
    >>> box_text(((-1, 1), (0, 2.5)))
    '[-1, 1] x [0, 2.5]'
    """
    return " x ".join(f"[{number(low)}, {number(high)}]" for low, high in bounds)


def within(what: str, bounds: Sequence[tuple[float, float]], letters: str) -> str:
    """What is spoken of: where, and with which letters.

    Examples
    --------
    >>> within("omega", ((-1, 1), (0, 2)), "with a = 5")
    'omega within [-1, 1] x [0, 2], with a = 5,'
    """
    return f"{what} within {box_text(bounds)}{f', {letters},' if letters else ''}"


def letters_text(letters: Mapping[str, tuple[float, float]], which: str = "every") -> str:
    """Letters that are intervals first: what is certified holds for every value in them, what is refuted for some.

    Of many values the first are told.

    Examples
    --------
    >>> letters_text({"a": (5.0, 5.0), "a2": (5.32, 8.0)})
    'for every a2 in [5.32, 8] with a = 5'
    >>> letters_text({f"a{k}": (k, k) for k in range(44)})
    'with a0 = 0, a1 = 1, a2 = 2 and 41 other letters'
    """
    ranges = [f"{name} in [{number(low)}, {number(high)}]" for name, (low, high) in letters.items() if low < high]
    values = [f"{name} = {number(low)}" for name, (low, high) in letters.items() if not low < high]
    of_ranges = f"for {which} {' and '.join(ranges)}" if ranges else ""
    shown = first_of(values, FIRST_LETTERS, "other letters") if len(values) > MOST_LETTERS else ", ".join(values)
    return " ".join(part for part in (of_ranges, f"with {shown}" if shown else "") if part)
