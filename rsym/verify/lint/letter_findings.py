"""Letters in words: what their values and ranges do to the formula."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rsym.backends.kernel import compile
from rsym.model.letters import Letters
from rsym.model.nodes import written_out
from rsym.model.shape import Shape
from rsym.verify.lint.functions import Array
from rsym.verify.lint.letters import Breach, breaches
from rsym.verify.lint.parameters import parameters
from rsym.verify.lint.places import Place, text_of
from rsym.verify.lint.report import LETTER_RANGE, Finding

SEEN = 50  # points inside: of a shape with more of them one without any is no accident


def letter_findings(shape: Shape, cloud: Array) -> Iterator[Finding]:
    """Findings on letters, each under the letters that it is about."""
    letters = shape.letters
    told: set[str] = set()
    for parameter in parameters(shape.expression, letters):
        told.add(parameter.name)
        yield Finding(
            LETTER_RANGE,
            (_place(letters, parameter.name),),
            f"the parameter {parameter.symbol} of an R-operation must be {parameter.wanted}; "
            f"not so {' and '.join(parameter.wrong)}",
            f"declare a range within which it is {parameter.wanted}",
        )
    for breach in breaches(written_out(shape.expression), letters):
        told |= set(breach.values)
        yield _of_breach(breach, letters)
    yield from _at_ends(shape, cloud, told)


def _of_breach(breach: Breach, letters: Letters) -> Finding:
    condition = breach.condition
    values = " and ".join(f"{name} = {value:.4g}" for name, value in breach.values.items())
    which = "which are the values given" if breach.at_default else "which the ranges allow"
    open_ended = [name for name in breach.values if letters[name].minimum is None or letters[name].maximum is None]
    narrow = f"declare a range for {' and '.join(open_ended)}" if open_ended else "narrow the ranges"
    return Finding(
        LETTER_RANGE,
        tuple(_place(letters, name) for name in breach.values),
        f"the {condition.role} {text_of(condition.expression)} {condition.demand}, but is not so from {values} on, "
        f"{which}",
        "choose other values" if breach.at_default else f"{narrow} so that this cannot happen",
    )


def _at_ends(shape: Shape, cloud: Array, told: set[str]) -> Iterator[Finding]:
    """Letters at whose ends omega is undefined where it is not otherwise, or positive nowhere."""
    before, inside = _shares(shape, cloud, {})
    for name, letter in shape.letters.items():
        for word, end in (("minimum", letter.minimum), ("maximum", letter.maximum)):
            if end is None or name in told:
                continue
            undefined, within = _shares(shape, cloud, {name: end})  # as it is: its float may lie beyond it
            here, at = (_place(shape.letters, name),), f"at its {word} {float(end):g}"
            if undefined > before:
                message, share = f"{at} omega is undefined in {undefined:.0%} of the bounds", (undefined, undefined)
                yield Finding(LETTER_RANGE, here, message, "narrow its range", range=share)
            elif within == 0 and inside > SEEN / len(cloud):
                message = f"{at} the shape is empty, or outside its bounds"
                yield Finding(LETTER_RANGE, here, message, "narrow its range, or widen the bounds")


def _shares(shape: Shape, cloud: Array, letters: Mapping[str, Any]) -> tuple[float, float]:
    """In what shares of the bounds omega is undefined, and positive."""
    values = compile(shape)(*cloud.T, letters=letters)["value"]
    return float(np.isnan(values).mean()), float((values > 0).mean())


def _place(letters: Letters, name: str) -> Place:
    letter = letters[name]
    range_text = f" in {letter.range}" if letter.range else " without a range"
    return Place(f"letter, {float(letter.default):g}{range_text}", letter.doc, name)
