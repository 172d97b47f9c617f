"""Plates whose deflection is known, on discs, ellipses, polygons and rings: `python tests/opponent/hunt.py plates`.

Clamped edges have values and slopes of any function; on those that are supported or free its moment and force vanish:
on discs and rings it is a sum of powers of the radius times a cosine, with whatever coefficients that needs, on a
rectangle a product of sines. The body is typed in several ways. The true error may be three times the estimate.
"""

from dataclasses import dataclass, field

import numpy as np
import sympy as sp

import rsym
from opponent.fields import away, known, put
from opponent.typings import SYSTEMS, body, cut, rational
from rsym import x, y
from rsym.logic.sign_form import shape_form
from rsym.program.raising import raised


@dataclass(frozen=True)
class Case:
    """A plate, its edges, and its deflection."""

    family: str
    shape: rsym.Shape
    conditions: object
    u: sp.Expr
    load: sp.Expr
    cells: int
    more: dict = field(default_factory=dict)

    def __str__(self):
        return f"{self.shape.expression} u={self.u} {self.conditions} {self.more} {self.cells}"


def bilaplacian(u):
    """Of a function of x and y."""
    for _ in range(2):
        u = sp.diff(u, x, 2) + sp.diff(u, y, 2)
    return u


def retyped(random, shape):
    """The same body."""
    way = ("plain", "cut", "system", "times")[random.integers(4)]
    if way == "cut":
        return cut(random, shape)
    if way == "system":
        return shape.with_system(SYSTEMS[random.integers(len(SYSTEMS))])
    return shape.replace(expression=1000 * shape.expression) if way == "times" else shape


def edged(random):
    """A disc, an ellipse or a polygon, clamped with values and slopes of any function."""
    kind, u = known(random)
    if random.random() < 0.5:
        a, b = rational(random, 1, 2), rational(random, 1, 2)
        shape, leaf = rsym.ellipse(a, b), 1 - x**2 / a**2 - y**2 / b**2
        slope = [sp.diff(leaf, one) for one in (x, y)]
        length = sp.sqrt(slope[0] ** 2 + slope[1] ** 2)
        outward = -(slope[0] * sp.diff(u, x) + slope[1] * sp.diff(u, y)) / length
        typed = cut(random, shape) if random.random() < 0.3 else shape
        return f"{kind} ellipse", typed, rsym.clamped(u + leaf**2 * x, outward), u, {}
    count, size = int(random.integers(3, 7)), rational(random, 1, 2)
    angles = np.sort((np.arange(count) + random.uniform(-0.25, 0.25, count)) * 2 * np.pi / count)
    normals = [tuple(sp.Rational(round(100 * one), 100) for one in (np.cos(a), np.sin(a))) for a in angles]
    sides, conditions = [], {}
    for k, (p, q) in enumerate(normals):
        sides.append(rsym.half_plane((-p, -q), -size).named(f"side {k}"))
        along = (p * sp.diff(u, x) + q * sp.diff(u, y)) / sp.sqrt(p**2 + q**2)
        conditions[f"side {k}"] = rsym.clamped(u, along)
    whole = sides[0]
    for side in sides[1:]:
        whole = whole & side
    return f"{kind} polygon", whole, conditions, u, {}


def held(random):
    """Any body, clamped at 0: what is sought is the square of all leaves times a function."""
    kind, shape = body(random)
    form = shape_form(shape)
    leaves = [raised(form.builder.nodes, leaf) for leaf in form.leaves]
    if kind in ("ell", "discs", "polygon"):  # the product of leaves vanishes inside, or has too many terms
        return edged(random)
    smooth = rational(random, -1, 1) + sp.cos(rational(random, 0.5, 3) * x + y)
    return f"weighted {kind}", retyped(random, shape), rsym.clamped(), sp.Mul(*leaves) ** 2 * smooth, {}


def in_rings(random):
    """A disc or a ring, each edge clamped, supported or free."""
    n, nu = int(random.integers(2, 5)), rational(random, 0, 0.45)
    outer, bore = rational(random, 1, 2), rational(random, 0.3, 0.8)
    ring = random.random() < 0.6
    powers = [n, n + 2, n + 4] + ([-n, 2 - n] if ring else [])
    edges = [rsym.clamped(), rsym.supported(), None]
    names = {"rim": (outer, edges[random.integers(3)]), **({"bore": (bore, edges[random.integers(3)])} if ring else {})}
    if all(edge is None for _, edge in names.values()):
        names["rim"] = (outer, edges[1])
    rows = []
    for radius, edge in names.values():
        for power in powers:
            w, slope, second = sp.Integer(1), sp.Integer(power), sp.Integer(power * (power - 1))  # times r**power
            moment = second + nu * (slope - n**2)
            force = (power - 2) * (second + slope - n**2) - (1 - nu) * n**2 * (slope - w)
            pair = {"clamped": (w, slope), "supported": (w, moment), "free": (moment, force)}[_word(edge)]
            rows.append([radius**power * one for one in pair])
    table = [sp.Matrix(rows[k : k + len(powers)]).T for k in range(0, len(rows), len(powers))]
    (found, *_) = sp.Matrix.vstack(*table).nullspace()
    found = found / max(abs(one) for one in found)
    turn = sp.expand((x + sp.I * y) ** n).as_real_imag()[random.integers(2)]
    square = x**2 + y**2
    u = sum(c * square ** sp.Rational(p - n, 2) * turn for c, p in zip(found, powers, strict=True))
    shape = rsym.disc(outer).named("rim")
    if ring:
        shape = shape - rsym.disc(bore).named("bore")
    conditions = {name: edge for name, (_, edge) in names.items() if edge is not None}
    word = " ".join(_word(edge) for _, edge in names.values())
    return word, shape, conditions, u, {"poisson": nu}


def _word(edge):
    return "free" if edge is None else type(edge).__name__.lower()


def supported(random):
    """A rectangle, turned and moved, on its edges."""
    a, b = rational(random, 1, 3), rational(random, 1, 3)
    m, n = (int(one) for one in random.integers(1, 4, 2))
    u = sp.sin(m * sp.pi * (x / a + sp.S.Half)) * sp.sin(n * sp.pi * (y / b + sp.S.Half))
    shape, load = rsym.rectangle(a, b), ((m * sp.pi / a) ** 2 + (n * sp.pi / b) ** 2) ** 2
    turn = sp.Matrix([[3, 4], [-4, 3]]) / 5 if random.random() < 0.5 else sp.eye(2)
    back = dict(zip((x, y), turn * sp.Matrix([x, y]), strict=True))
    shape = rsym.Shape(shape.expression.subs(back, simultaneous=True), (x, y))
    u = u.subs(back, simultaneous=True)
    typed = retyped(random, shape)
    return f"sines {m}{n}", typed, rsym.supported(), u, {"poisson": rational(random, 0, 0.45), "load": load * u}


def case(seed):
    """The case of a seed."""
    random = np.random.default_rng(seed)
    family, shape, conditions, u, more = (edged, held, in_rings, supported)[random.integers(4)](random)
    load = more.pop("load") if "load" in more else bilaplacian(u)
    return Case(family, shape, conditions, u, load, int(random.integers(8, 25)), more)


def asked(case):
    """The word and what is wrong."""

    def question():
        given = {"letters": {"f": case.load}, "cells": case.cells, **case.more}
        found = rsym.solve(case.shape, "bilaplacian(u) = f", case.conditions, **given)
        return away(found, case.u), found.report.estimate

    return put(question)
