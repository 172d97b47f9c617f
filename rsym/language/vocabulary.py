"""The words that have a meaning of their own."""

from __future__ import annotations

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
    "cot": (1, 1),
    "asin": (1, 1),
    "acos": (1, 1),
    "atan": (1, 1),
    "sinh": (1, 1),
    "cosh": (1, 1),
    "tanh": (1, 1),
    "sign": (1, 1),
    "exp": (1, 1),
    "log": (1, 1),
    "min": (2, None),
    "max": (2, None),
    "atan2": (2, 2),
}

RESERVED = frozenset((*KEYWORDS, *ARITIES, "pi"))
