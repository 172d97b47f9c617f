"""Letters in words: what their values and ranges do to the formula."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rsym.codegen.kernel import compile
from rsym.model.letters import Letters
from rsym.model.shape import Shape
from rsym.verify.lint.functions import Array
from rsym.verify.lint.letters import Breach, breaches
from rsym.verify.lint.parameters import parameters
from rsym.verify.lint.places import Place, written_out
from rsym.verify.lint.report import LETTER_RANGE, Finding

POINTS = 2000  # where omega is evaluated at the ends of ranges


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
    for breach in breaches(shape.expression, letters):
        told |= set(breach.values)
        yield _of_breach(breach, letters)
    yield from _undefined(shape, cloud[:POINTS], told)


def _of_breach(breach: Breach, letters: Letters) -> Finding:
    condition = breach.condition
    values = " and ".join(f"{name} = {value:.4g}" for name, value in breach.values.items())
    which = "which are the values given" if breach.at_default else "which the ranges allow"
    open_ended = [name for name in breach.values if letters[name].minimum is None or letters[name].maximum is None]
    narrow = f"declare a range for {' and '.join(open_ended)}" if open_ended else "narrow the ranges"
    return Finding(
        LETTER_RANGE,
        tuple(_place(letters, name) for name in breach.values),
        f"the {condition.role} {written_out(condition.expression)} {condition.demand}, but is not so from {values} on, "
        f"{which}",
        "choose other values" if breach.at_default else f"{narrow} so that this cannot happen",
    )


def _undefined(shape: Shape, cloud: Array, told: set[str]) -> Iterator[Finding]:
    """Letters at whose ends omega is undefined where it is not otherwise."""
    kernel = compile(shape)
    columns = list(cloud.T)
    before = np.isnan(kernel(*columns)["value"]).mean()
    for name, letter in shape.letters.items():
        if name in told:
            continue
        for word, end in (("minimum", letter.minimum), ("maximum", letter.maximum)):
            if end is None:
                continue
            at_end: Mapping[str, Any] = {name: end}  # as it is: its float may lie beyond it
            share = np.isnan(kernel(*columns, letters=at_end)["value"]).mean()
            if share > before:
                yield Finding(
                    LETTER_RANGE,
                    (_place(shape.letters, name),),
                    f"at its {word} {float(end):g} omega is undefined in {share:.0%} of the bounds",
                    "narrow its range",
                    range=(float(share), float(share)),
                )


def _place(letters: Letters, name: str) -> Place:
    letter = letters[name]
    range_text = f" in {letter.range}" if letter.range else " without a range"
    return Place(f"letter, {float(letter.default):g}{range_text}", letter.doc, name)
