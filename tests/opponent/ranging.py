"""Problems with letters, against the same with numbers and what is known: `python tests/opponent/hunt.py ranging`.

Radii, places, turns and scales of bodies are letters, as are numbers in data and coefficients; their defaults are not
what is asked. An answer at values that are given, one that was found at the defaults and put to these, and that of the
body typed with numbers differ by three times their estimates at most.
"""

from dataclasses import dataclass

import numpy as np
import sympy as sp

import rsym
from opponent.fields import away, put
from opponent.typings import rational
from rsym import x, y
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.logic.sign_form import shape_form
from rsym.program.raising import raised

A, B, C, T, Q = sp.symbols("a b c t q", real=True)
NEAR = 1e-9


def halves(shape, place, letters):
    """Both sides of an upright line, together again."""
    right = rsym.half_plane((1, 0), place, letters=letters)
    return (shape & right) | (shape & ~right)


def moved(shape, turn, size, letters):
    """Turned about the origin, shifted and scaled."""
    return shape.rotate(turn, letters=letters).translate(size, 1, letters=letters).scale(size, letters=letters)


# Of numbers a, b from 1 to 2, c from -0.4 to 0.4, t of any angle, or letters.
BODIES = {
    "ring": lambda a, b, c, t, m: (
        rsym.disc(a + 1, letters=m).named("rim") - rsym.disc(b / 3, (c, 0), letters=m).named("bore")
    ),
    "ellipse": lambda a, b, c, t, m: moved(rsym.ellipse(a, b, letters=m).named("rim"), t, b, m),
    "rectangle": lambda a, b, c, t, m: rsym.rectangle(a, 2 * b, (c, 1), letters=m).rotate(t, letters=m),
    "ell": lambda a, b, c, t, m: rsym.polygon([(-a, -b), (a, -b), (a, 0), (0, 0), (0, b), (-a, b)], letters=m),
    "triangle": lambda a, b, c, t, m: moved(rsym.polygon([(-a, -1), (b, -1), (c, a)], letters=m), t, a, m),
    "discs": lambda a, b, c, t, m: rsym.disc(a, letters=m) | rsym.disc(b, (a, c), letters=m),
    "hexagon": lambda a, b, c, t, m: rsym.regular_polygon(6, a, letters=m).rotate(t, letters=m),
    "halves": lambda a, b, c, t, m: halves(rsym.disc(a, letters=m), c, m),
    "cut": lambda a, b, c, t, m: (
        rsym.disc(a, letters=m).named("rim") & rsym.half_plane((1, 0), c, letters=m).named("cut")
    ),
    "square": lambda a, b, c, t, m: (
        rsym.rectangle(4, 4).named("outside")
        - moved(rsym.rectangle(a / 3, b / 3, letters=m), t, b / 4, m).named("bore")
    ),
}


@dataclass(frozen=True)
class Case:
    """A body with letters, the same with numbers, the values, what is asked."""

    family: str
    lettered: rsym.Shape
    plain: rsym.Shape
    values: dict
    question: object
    cells: int
    u: sp.Expr

    def __str__(self):
        defaults = {name: letter.default for name, letter in self.lettered.letters.items()}
        return f"{self.lettered.expression} {defaults} at {self.values} u={self.u} {self.cells}"


def case(seed):
    """The case of a seed."""
    random = np.random.default_rng(seed)

    def drawn():
        low = {A: rational(random, 1, 2), B: rational(random, 1, 2), C: rational(random, -0.4, 0.4)}
        return {**low, T: rational(random, 0, 6)}

    defaults, values = drawn(), drawn()
    kind = list(BODIES)[random.integers(len(BODIES))]
    lettered = BODIES[kind](A, B, C, T, defaults)
    plain = BODIES[kind](*values.values(), None)
    question = (field, field, field, drum, rigidity, bent, area)[random.integers(7)]
    p, q = rational(random, -2, 2), rational(random, -2, 2)
    u = [
        A * x**3 + p * x * y + Q * y + B,
        sp.sin((1 + A) * x + q) * sp.cosh(y / 2) + Q,
        sp.log((x - 9 - B) ** 2 + (y - p) ** 2) * Q,
        sp.exp(-((x - A) ** 2) - B * (y - Q) ** 2),
    ][random.integers(4)]
    given = {one.name: value for one, value in {**values, Q: rational(random, 0.5, 2)}.items()}
    return Case(f"{question.__name__} {kind}", lettered, plain, given, question, int(random.integers(12, 25)), u)


def asked(case):
    """The word and what is wrong."""
    return put(lambda: case.question(case))


def compared(ask, case, again=None):
    """How far numbers of both typings are apart, and those of other letters put to these: of `ask(shape, letters)`."""
    own = {name: value for name, value in case.values.items() if name in case.lettered.letters}
    (one, near), (other, about) = ask(case.lettered, own), ask(case.plain, None)
    rows = [(abs(one / other - 1), near + about + NEAR)]
    if again is not None:
        rows.append((abs(again(own) / other - 1), near + about + NEAR))
    return rows


def drum(case):
    """The least eigenvalue."""

    def ask(shape, letters):
        found = rsym.modes(shape, 1, cells=case.cells, letters=letters)
        return found.values[0], found.grades[-1].estimate

    first = rsym.modes(case.lettered, 1, cells=case.cells, estimate=False)
    return compared(ask, case, lambda own: first.with_letters(own).values[0])


def rigidity(case):
    """Of torsion."""

    def ask(shape, letters):
        found = rsym.torsion(shape, cells=case.cells, letters=letters)
        return float(found), found.grades[-1].estimate

    first = rsym.torsion(case.lettered, cells=case.cells, estimate=False)
    return compared(ask, case, lambda own: float(first.with_letters(own)))


def bent(case):
    """The energy of an elastic body, whose error is less than that of displacements."""
    material = {"young": 1, "poisson": sp.Rational(3, 10), "loads": (1, x), "cells": case.cells}

    def ask(shape, letters):
        found = rsym.elasticity(shape, {...: rsym.fixed()}, **material, letters=letters)
        return found.energy, found.report.estimate

    first = rsym.elasticity(case.lettered, {...: rsym.fixed()}, **material, estimate=False)
    return compared(ask, case, lambda own: first.with_letters(own).energy)


def area(case):
    """By a rule."""
    return compared(lambda shape, letters: (float(rsym.measure(shape, letters=letters).area), 0.0), case)


def field(case):
    """A solution that is known."""
    u, k = case.u, 1 + Q * x**2
    f = -sp.diff(k * sp.diff(u, x), x) - sp.diff(k * sp.diff(u, y), y) + A * u
    values = {sp.Symbol(name, real=True): value for name, value in case.values.items()}

    def ask(shape, put_in, letters):
        form = shape_form(shape)
        leaves = [raised(form.builder.nodes, leaf) for leaf in form.leaves]
        beside = sp.Mul(*leaves) * (1 + x / 2) if len(leaves) < 4 else 0
        conditions = {...: put_in(u) + beside}
        if case.lettered.parts and len(leaves) == 2:  # one is natural
            slope = [sp.diff(leaves[0], one) for one in (x, y)]
            along = -sum(one * sp.diff(put_in(u), other) for one, other in zip(slope, (x, y), strict=True))
            flux = along / sp.sqrt(slope[0] ** 2 + slope[1] ** 2)
            conditions[shape_leaf_parts(shape)[0][-1]] = rsym.robin(put_in(B), flux + put_in(B * u))
        data = {"k": put_in(k), "r": put_in(A), "f": put_in(f), **letters}
        return rsym.solve(shape, "-div(k*grad(u)) + r*u = f", conditions, cells=case.cells, letters=data)

    more = {name: value for name, value in case.values.items() if name not in case.lettered.letters}
    before = {name: value + 1 for name, value in more.items()}
    found = [
        ask(case.lettered, lambda one: one, case.values),
        ask(case.plain, lambda one: sp.sympify(one).subs(values), {}),
        ask(case.lettered, lambda one: one, before).with_letters(case.values),
    ]
    truth = u.subs(values)
    near = max(one.report.estimate for one in found[:2])
    return [*((away(one, truth), one.report.estimate) for one in found[:2]), (away(found[2], truth), near)]
