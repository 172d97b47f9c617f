"""The words that have a meaning of their own."""

from __future__ import annotations

from rsym.model.functions import FUNCTIONS

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
    **{name: row.arity for name, row in FUNCTIONS.items()},
}

RESERVED = frozenset((*KEYWORDS, *ARITIES, "pi"))
