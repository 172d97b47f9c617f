"""Letters as a page or a widget shows them: the range of a slider, groups, what each is."""

from __future__ import annotations

from typing import Any

from rsym.model.letters import Letter, Letters


def slider_range(letter: Letter) -> tuple[float, float]:
    """The range of a letter; an open end lies at 0 or at twice the default.

    Examples
    --------
    >>> slider_range(Letter(5)), slider_range(Letter(-2, maximum=1)), slider_range(Letter(0))
    ((0.0, 10.0), (-4.0, 1.0), (-1.0, 1.0))
    """
    default = float(letter.default)
    low = min(0.0, 2 * default) if letter.minimum is None else float(letter.minimum)
    high = max(0.0, 2 * default) if letter.maximum is None else float(letter.maximum)
    if low < high:
        return low, high
    # Nothing to scale by: the default is 0, or beyond the only end.
    return (
        default - 1 if letter.minimum is None else low,
        default + 1 if letter.maximum is None else high,
    )


def listed_letters(letters: Letters) -> list[dict[str, Any]]:
    """What a page knows of letters; the text of a letter up to its colon names its group.

    Examples
    --------
    >>> listed_letters(Letters({"a": Letter(2, minimum=1, maximum=3, unit="m", doc="roof: half its length")}))
    [{'name': 'a', 'value': 2.0, 'low': 1.0, 'high': 3.0, 'unit': 'm', 'group': 'roof', 'doc': 'half its length'}]
    """
    result = []
    for name, letter in letters.items():
        low, high = slider_range(letter)
        group, colon, doc = letter.doc.partition(":")
        says = {"group": group.strip(), "doc": doc.strip()} if colon else {"group": "", "doc": letter.doc}
        value = float(letter.default)
        result.append({"name": name, "value": value, "low": low, "high": high, "unit": letter.unit, **says})
    return result
