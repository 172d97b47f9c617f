"""Roots that do no harm: a leaf that is even in sqrt(s) is analytic where s = 0.

Let F = L(p, sqrt(s(p))) with L analytic, and even in its last argument: then L(p, r) = M(p, r**2) with M analytic,
and F = M(p, s). Its gradient is grad L + L_rr(p, q)/2 grad s for some q between 0 and sqrt(s), as L_r(p, 0) = 0.
So bodies of revolution are smooth on their axes, with meridians in even powers of the radius. Source: Whitney,
Differentiable even functions, Duke Math. J. 10 (1943), 159-160.
"""

from __future__ import annotations

from rsym.bounds.balls import arb, root
from rsym.program.builder import HALF
from rsym.program.differentiation import derivative
from rsym.verify.boxes.domains import is_defined
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.resolution import put

RADIUS = "the root"  # no letter of a user has a space in its name
FREE, EVEN, ODD = 0, 2, 1


def is_regular_through_root(local: Local, leaf: int) -> bool:
    """Whether a leaf is analytic on a box, and its gradient not 0, though a root in it may vanish there.

    Examples
    --------
    >>> import rsym
    >>> import sympy as sp
    >>> from rsym import x, y, z
    >>> box = ((-0.1, 0.1),) * 3
    >>> for meridian in (sp.cos(sp.sqrt(x**2 + y**2)), sp.sin(sp.sqrt(x**2 + y**2))):
    ...     model = Model(rsym.Shape(z + 1 - meridian, (x, y, z)), {})
    ...     is_regular_through_root(model.over(box), model.root)
    True
    False
    """
    model, builder = local.model, local.model.builder
    found = generators(local, leaf)
    if found.switches or len(found.hard) != 1:
        return False
    (part,) = found.hard
    operation, arguments, _ = builder.nodes[part]
    if operation != "sqrt" or not builder.nonnegative[arguments[0]] or not is_defined(local, arguments[0]):
        return False
    radius = builder.input(RADIUS)
    function = put(model, leaf, {part: radius})
    square = local.value(arguments[0])
    if square is None or not generators(local, arguments[0]).analytic or not is_even(model, function, radius):
        return False
    around = Local(model, local.sides)
    largest = root(square)
    if largest is None or not largest.is_finite():
        return False
    around.inputs[RADIUS] = arb(0, 1) * arb(largest.upper())
    if not generators(around, function).analytic:
        return False
    second = derivative(builder, derivative(builder, function, RADIUS), RADIUS)
    half = builder.mul(builder.const(HALF), second)
    for own, inner in zip(model.gradient(function), model.gradient(arguments[0]), strict=True):
        slope = around.value(builder.add(own, builder.mul(half, inner)))
        if slope is not None and slope.is_finite() and not slope.contains(0):
            return True
    return False


def is_even(model: Model, number: int, variable: int) -> bool:
    """Whether the form of a node shows that it is even in an input."""
    parities: dict[int, int | None] = {}
    for part in model.order(number):
        parities[part] = ODD if part == variable else _parity(model, part, parities)
    return parities[number] in (FREE, EVEN)


def _parity(model: Model, part: int, known: dict[int, int | None]) -> int | None:
    """FREE of the variable, EVEN, ODD, or None."""
    operation, arguments, data = model.builder.nodes[part]
    inner = [known[argument] for argument in arguments]
    if all(parity == FREE for parity in inner):
        return FREE
    if all(parity in (FREE, EVEN) for parity in inner):
        return EVEN
    if None in inner:
        return None
    if operation in {"mul", "div"}:
        return ODD if inner.count(ODD) == 1 else EVEN
    if operation == "add":
        return ODD if inner == [ODD, ODD] else None
    if operation == "powi":
        return ODD if int(str(data)) % 2 else EVEN
    if operation in {"abs", "cos"}:
        return EVEN
    return ODD if operation in {"neg", "sin"} else None
