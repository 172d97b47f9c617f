"""Readings: every place where the source is doubtful or lost, how it is read here, and what follows from that."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """One doubtful place of the source.

    Attributes
    ----------
    place : str
        What is doubtful.
    transcription : str
        What the source prints.
    repair : str
        What is taken instead.
    reason : str
        Why.
    consequence : str
        What would be, or is, otherwise; a test holds each statement.
    used : str
        The figures that depend on it.
    other : str
        How to ask for the other reading; empty if there is none.

    Examples
    --------
    >>> next(reading.other for reading in READINGS if reading.place == "f_o")
    "skeleton_body(reading='literal')"
    """

    place: str
    transcription: str
    repair: str
    reason: str
    consequence: str
    used: str
    other: str = ""


READINGS: tuple[Reading, ...] = (
    Reading(
        "f_o",
        "f_o = √(((√(f₁⁴+f₂²) − f₂)/2)²) + f₁²: f₁² stands outside the outer root",
        "f_o = √(((√(f₁⁴+f₂²) − f₂)/2)² + f₁²), the trimming of a line by a disc",
        "The source calls f_o normalised; only this form is, and it is the known trimming formula.",
        "In the printed form ∂f_o/∂y tends to 0 on the segment, where that of a normalised f_o is 1. Fig. 11's body "
        "then crosses its skeleton smoothly, with |∇ω| = 0.317; in the form taken it has a corner at x = −4.992121.",
        "Figs 11 and 12",
        "skeleton_body(reading='literal')",
    ),
    Reading(
        "W",
        "W = test5 ∨ ¬ω_far",
        "W = test5 ∧ ¬ω_far",
        "The headlights are to be cut into the body.",
        "As printed all outer space is inside: W is positive everywhere far from the car, and negative only "
        "in the parts of the headlights that lie outside the body.",
        "Figs 9 and 10",
        "car(reading='printed-W')",
    ),
    Reading(
        "z_b",
        "z_b = z₂/2 in the text, z_b = 2 under Fig. 7",
        "z_b is a letter of its own with the value 2",
        "The figure gives a number, and numbers are what was drawn.",
        "The two agree at the letters b (z₂ = 4). At the letters a (z₂ = 5) the text puts the axes of the fenders "
        "at 2.5 instead of 2, and the body has 0.74 % more volume.",
        "Figs 7 to 10",
        "car(reading='text-zb')",
    ),
    Reading(
        "x_s",
        "test2 has the strip |x| ≤ x_s, test3 is built on ω_sk, which has not",
        "as printed: the strip closes Figs 5 and 6 alone",
        "x_s is called an intermediate parameter of the width.",
        "With the strip the body of Fig. 7a ends flat at |x| = 6; without it the fenders reach |x| = 7.3.",
        "Figs 7 to 10",
        "car(reading='strip')",
    ),
    Reading(
        "f₁, roof",
        "lost with a page",
        "f₁ = 1 − y²/a₁² − (z−z₁)²/b₁²",
        "Restored from the letters a₁, b₁, z₁ and their values under Fig. 5; the sides use such an ellipse too.",
        "The roof is a cylinder that reaches |y| = a₁ = 8 at z = z₁ = 4 and z = z₁ + b₁ = 8 at y = 0; "
        "it is not normalised.",
        "Figs 5 to 10",
    ),
    Reading(
        "f₂, boot",
        "lost with a page",
        "f₂ = −y(y+y₂)/y₂ ∧ (z₂−z)",
        "Restored from the letters y₂, z₂ and their values under Fig. 5; the bonnet f₃ is built in the same way.",
        "The boot reaches from y = −y₂ = −15 to y = 0 and up to z = z₂ = 5, "
        "and both its factors are normalised on its boundary.",
        "Figs 5 to 10",
    ),
    Reading(
        "letters of the car",
        "“42 parameters”",
        "46 letters",
        "The formulas and captions name 46.",
        "x_s closes Figs 5 and 6 alone: the whole car depends on 45.",
        "Figs 5 to 10",
    ),
    Reading(
        "Figs 3 and 4, values of Table 1",
        "lost with a page",
        "Figs 3 and 4 are left out, the experiment of Table 1 is repeated",
        "Nothing says what Fig. 3 showed; of Fig. 4 only the caption is left.",
        "Seconds and memory in Table 1 are those of this run.",
        "Figs 3 and 4, Table 1",
    ),
    Reading(
        "valve",
        "its listing is lost",
        "a valve of our own, valve.rf",
        "The text needs one: stem, head and fillet are what an engine valve has.",
        "Figs 1 and 2 and Table 1 are repeated, not reproduced.",
        "Figs 1 and 2, Table 1",
    ),
    Reading(
        "a₁, p₁ of Fig. 12",
        "only a = a₂ = 5 and p₂ = 0.1 are printed",
        "(8, 40), (8, 20), (6, 40), (10, 40), (10, 60), (12, 80)",
        "Round numbers about those of Fig. 11.",
        "At a₂ = a the blend is −p₂ < 0 at the end of the skeleton: every one of these bodies meets its skeleton "
        "and ends there in a conical tip.",
        "Fig. 12",
    ),
    Reading(
        "car of unusual shape",
        "a picture without an equation, lost",
        "a car of our own, streamlined.rf",
        "The text says how: a body blended on a skeleton.",
        "Figs 13 and 14 show the method, not the source's car.",
        "Figs 13 and 14",
    ),
)
