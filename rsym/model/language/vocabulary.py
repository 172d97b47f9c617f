"""The words that have a meaning of their own, and what to propose instead of an unknown one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

KEYWORDS = ("letter", "variant", "coordinates", "bounds", "system", "in")

# Fewest and most arguments; None: any number.
ARITIES: dict[str, tuple[int, int | None]] = {
    "rfAND": (2, None),
    "rfOR": (2, None),
    "rfNOT": (1, 1),
    "conjunction": (2, None),
    "disjunction": (2, None),
    "negation": (1, 1),
    "difference": (2, None),
    "implication": (2, 2),
    "exclusive_or": (2, 2),
    "equivalence": (2, None),
    "joining": (2, None),
    "trimming": (2, 2),
    "sqrt": (1, 1),
    "abs": (1, 1),
    "sin": (1, 1),
    "cos": (1, 1),
    "tan": (1, 1),
    "exp": (1, 1),
    "log": (1, 1),
    "min": (2, None),
    "max": (2, None),
    "atan2": (2, 2),
}

RESERVED = frozenset((*KEYWORDS, *ARITIES, "pi"))


def proposal(name: object, known: Iterable[str], otherwise: str) -> str:
    """A remedy that names the closest known words, or `otherwise` if none is close.

    Examples
    --------
    >>> proposal("rfand", ARITIES, "see the list of functions")
    "did you mean 'rfAND'?"
    """
    by_lower = {word.lower(): word for word in known}
    lower = str(name).lower()[:40]
    close = [lower] if lower in by_lower else get_close_matches(lower, by_lower, n=3, cutoff=0.6)
    return f"did you mean {' or '.join(repr(by_lower[word]) for word in close)}?" if close else otherwise


def listing(known: Iterable[str]) -> str:
    """The known words for a message, the first thirty."""
    words = list(known)
    more = f" and {len(words) - 30} more" if len(words) > 30 else ""
    return (", ".join(words[:30]) or "none") + more
