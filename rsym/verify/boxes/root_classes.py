"""How smooth a leaf is where the squares under its roots vanish: z = x r is of class 1 there, z = r**3 of class 2.

Let Z be the common zeros of analytic u_1, ..., u_m, r**2 = u_1**2 + ... + u_m**2, and call R of order k if it is
analytic off Z and |D^j R| <= C_j r**(k - j) near Z for all j. Then R is of class C^j for all whole j < k: its
derivatives up to there tend to zero on Z, and are the derivatives, for |R(p)| <= C |p - z|**k. Orders add in products;
an analytic function in the m-th power of the ideal of the u is of order m; so is the m-th power of the root of a
positive definite form in the u, which is homogeneous in them. A sum A + R with A analytic keeps its form under
analytic functions. So a leaf is A + R, by the rules for the products and sums that it is made of.

Where a leaf is F = L(p, s), s = sqrt(q), L analytic, it is A + s O + s**3(...), A = L(p, 0) + q(...) and
O = L_s(p, 0). If it is of order 2 and O = 0 at p, the surface leaves its tangent plane along a tangent v by
-(A''(v, v)/2 + N(v) (grad O . v)) t**2/|n| and along -v by -(A''(v, v)/2 - N(v) (grad O . v)) t**2/|n|, with
N(v)**2 = q''(v, v)/2 and n = grad A: where both differ it has no second derivative. The curvatures along v and -v
differ by 4 N(v) |grad O . v|/(|n| |v|**2).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import sympy as sp

from rsym.bounds.balls import arb, root
from rsym.logic.stripping import bare
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower
from rsym.program.operations import CHOOSING
from rsym.verify.boxes.generators import generators, is_square
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.locus import chosen
from rsym.verify.boxes.polynomials import polynomial_of, sum_of_squares
from rsym.verify.boxes.resolution import put
from rsym.verify.boxes.vanishing import Exact
from rsym.verify.boxes.vectors import dot

MODULI = frozenset({"absolute_power", "signed_power"})
RADIUS = "the root"  # no letter of a user has a space in its name
ANALYTIC = math.inf
GROWS = " grows without bound: the boundary leaves its tangent like a power below 2 of the distance"


@dataclass(frozen=True)
class Axis:
    """The nodes u whose squares stand under a root; `forms` are they as linear polynomials, if all are."""

    nodes: tuple[int, ...]
    forms: tuple[sp.Poly, ...]


class Axes:
    """The axes of the roots of one model, and what is zero on them, each found once."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._axes: dict[int, Axis | None] = {}
        self._zeros: dict[tuple[int, tuple[int, ...]], int] = {}

    def axis(self, radicand: int) -> Axis | None:
        """The axis of a radicand, None if it is no positive definite form."""
        if radicand not in self._axes:
            self._axes[radicand] = _axis_of(self.model, radicand)
        return self._axes[radicand]

    def zero_order(self, number: int, axis: Axis) -> int:
        """A power of the ideal of an axis that a polynomial, or a node of the axis, certainly lies in."""
        key = number, axis.nodes
        if key not in self._zeros:
            self._zeros[key] = _zero_order(self.model, number, axis)
        return self._zeros[key]


def axes_of(model: Model) -> Axes:
    """The axes of a model, remembered with it."""
    return model.remembered(Axes)


def _axis_of(model: Model, radicand: int) -> Axis | None:
    """The nodes of which a radicand is a positive definite form: a sum of squares, or a quadratic polynomial."""
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    nodes = _squares(model.builder, radicand)
    if nodes:
        written = [polynomial_of(model, node) for node in nodes]
        polynomials = [sp.Poly(one, *symbols, domain=sp.QQ) for one in written if one is not None]
        linear = len(polynomials) == len(nodes) and all(one.total_degree() == 1 for one in polynomials)
        return Axis(nodes, tuple(polynomials) if linear else ())
    expression = polynomial_of(model, radicand)
    squares = [] if expression is None else sum_of_squares(sp.Poly(expression, *symbols, domain=sp.QQ))
    forms = tuple(form for _, form in squares)
    return Axis(tuple(lower(model.builder, form.as_expr()) for form in forms), forms) if forms else None


def _squares(builder: Builder, number: int) -> tuple[int, ...]:
    """The nodes of which a node is a sum of squares with positive factors; () if it is none."""
    operation, arguments, data = builder.nodes[number]
    if operation == "add":
        first, second = (_squares(builder, argument) for argument in arguments)
        return (*first, *second) if first and second else ()
    if is_square(builder, number) or (operation == "powi" and data == 2):
        return (bare(builder, arguments[0]),)
    if operation == "mul":
        value = builder.value(arguments[0])
        return _squares(builder, arguments[1]) if value is not None and value > 0 else ()
    return ()


def _zero_order(model: Model, number: int, axis: Axis) -> int:
    own = 1 if bare(model.builder, number) in axis.nodes else 0
    expression = polynomial_of(model, number) if axis.forms else None
    if expression is None or expression == 0:
        return own
    symbols = axis.forms[0].gens
    names = [sp.Dummy() for _ in axis.forms]
    solved = sp.solve([form.as_expr() - u for form, u in zip(axis.forms, names, strict=True)], symbols, dict=True)
    if len(solved) != 1:
        return own
    moved = sp.Poly(sp.expand(expression.subs(solved[0], simultaneous=True)), *names)
    lowest: int = min(sum(powers) for powers in moved.monoms())
    return max(own, lowest)


def root_order(local: Local, leaf: int) -> float:
    """A number k such that the leaf is of class C^j on the box for all whole j < k; 0 where nothing is known.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> r = sp.sqrt(x**2 + y**2)
    >>> for second in (r, x * r, x * y * r, r**3):
    ...     model = Model(rsym.Shape(z - second, (x, y, z)), {})
    ...     print(root_order(model.over(((-0.1, 0.1),) * 3), model.root))
    1.0
    2.0
    3.0
    3.0
    """
    model, found = local.model, generators(local, leaf)
    if found.switches or not found.hard:
        return 0.0
    exponents = {part: _exponent(model.builder, part) for part in found.hard}
    axis: Axis | None = None
    for part, exponent in exponents.items():
        radicand = model.builder.nodes[part].arguments[0]
        own = axes_of(model).axis(radicand) if exponent else None
        if own is None or not generators(local, radicand).analytic:
            return 0.0
        axis = own if axis is None else axis
        if set(own.nodes) != set(axis.nodes):
            return 0.0
    assert axis is not None
    orders: dict[int, tuple[float, float]] = {}
    for part in model.order(leaf):
        orders[part] = _orders(local, part, axis, exponents, orders)
    return orders[leaf][0]


def _exponent(builder: Builder, part: int) -> float:
    """Twice the exponent of a root of a sum of squares, the exponent of a power of a modulus; 0 of what is neither."""
    operation, arguments, _ = builder.nodes[part]
    if operation == "sqrt":
        return 1.0
    times = 2 if operation == "pow" else 1 if operation in MODULI else 0
    exponent = builder.value(arguments[1]) if times else None
    return 0.0 if exponent is None or exponent <= 0 else float(times * exponent)


def _orders(
    local: Local, part: int, axis: Axis, exponents: Mapping[int, float], orders: Mapping[int, tuple[float, float]]
) -> tuple[float, float]:
    """(order of what is not analytic in a node, order of its zero), both lower bounds."""
    builder = local.model.builder
    operation, arguments, data = builder.nodes[part]
    if part in exponents:
        return exponents[part], exponents[part]
    if operation in CHOOSING and (branch := chosen(local, part)) is not None:
        return orders[branch[0]]
    inner = [orders[argument] for argument in arguments]
    own, zero = min((one for one, _ in inner), default=ANALYTIC), 0.0
    if operation == "const":
        zero = ANALYTIC if builder.value(part) == 0 else 0.0
    elif operation == "mul":
        (first, a), (second, b) = inner
        own, zero = min(first + b, a + second, first + second), a + b
    elif operation == "powi" and isinstance(data, int) and data >= 1:
        own, zero = inner[0][0] + (data - 1) * min(inner[0]), data * inner[0][1]
    elif operation in {"add", "neg", "sin"}:
        zero = min(one for _, one in inner)
    elif operation == "div":
        own, zero = min(inner[0][0], inner[0][1] + inner[1][0]), inner[0][1]
    if own == ANALYTIC and zero < ANALYTIC:
        zero = max(zero, axes_of(local.model).zero_order(part, axis))
    return own, zero


def curvature_jump(known: Exact, at: Local, leaf: int) -> arb | None:
    """By how much the curvatures of a leaf along opposite tangents differ at a point, if that is more than nothing.

    The leaf and its root must vanish at the point, `at`; None where no jump is proved. Infinite where curvatures grow
    without bound: of A + O q**a with 1/2 < a < 1 and O not zero at the point the surface leaves its tangent plane along
    a tangent v like t**(2 a), by O q(v)**a/|n|, and any C^2 surface like t**2. So of A + O |u|**a, 1 < a < 2, with q =
    u**2; further powers of moduli leave it like their own exponents, which must be larger.
    """
    local = known.local
    model, builder, found = local.model, local.model.builder, generators(local, leaf)
    powers = sorted({*found.hard, *found.switched}, key=lambda part: _exponent(builder, part))
    if not powers or (len(powers) > 1 and not _exponent(builder, powers[0]) < _exponent(builder, powers[1])):
        return None
    part, nothing = powers[0], builder.const(0)
    radicand = _radicand(builder, part)
    moduli = all(builder.nodes[one].operation in MODULI for one in powers)
    if radicand is None or not (moduli or len(powers) == 1) or not known.vanishes(leaf, radicand):
        return None
    least = _exponent(builder, part) if moduli else root_order(local, leaf)
    names = {one: f"{RADIUS} {one}" for one in powers}
    function = put(model, leaf, {one: builder.input(name) for one, name in names.items()})
    first = derivative(builder, function, names[part])
    zeros = {builder.input(name): nothing for name in names.values()}
    even, odd = (put(model, one, zeros) for one in (function, first))
    around = Local(model, local.sides)
    around.inputs |= {name: arb(0, 1) * _largest(local, one) for one, name in names.items()}
    bases = [builder.nodes[one].arguments[0] for one in powers]
    if not (least > 1 and all(generators(around, one).analytic for one in (function, *bases))):
        return None
    normal = at.gradient(even)
    size = dot(normal, normal)
    if not size > 0:
        return None
    rows = [at.gradient(slope) for slope in model.gradient(radicand)]
    if builder.nodes[part].operation != "sqrt":
        value = at.value(odd)
        steep = 1 < _exponent(builder, part) < 2 and value is not None and not value.contains(0)
        leaves = steep and any(dot(v, [dot(row, v) for row in rows]) > 0 for v in tangents(normal))
        return arb(math.inf) if leaves else None
    twist = at.gradient(odd)
    if least < 2 or not known.vanishes(odd):
        return None
    along = [one - dot(twist, normal) / size * n for one, n in zip(twist, normal, strict=True)]
    square = dot(along, [dot(row, along) for row in rows]) / 2
    if not square > 0 or not dot(along, along) > 0:
        return None
    return 4 * square.sqrt() / size.sqrt()


def _radicand(builder: Builder, part: int) -> int | None:
    """What vanishes where a root or a power does, and is never negative; None of other operations."""
    operation, arguments, _ = builder.nodes[part]
    if operation in MODULI:
        return builder.square(arguments[0])
    return arguments[0] if operation in {"sqrt", "pow"} else None


def tangents(normal: Sequence[arb]) -> list[list[arb]]:
    """Vectors at right angles to a normal, among them all that two of its components make.

    Examples
    --------
    >>> [[float(part) for part in vector] for vector in tangents([arb(3), arb(4)])]
    [[-4.0, 3.0]]
    """
    found = []
    for i, j in combinations(range(len(normal)), 2):
        vector = [arb(0)] * len(normal)
        vector[i], vector[j] = -normal[j], normal[i]
        found.append(vector)
    return found


def _largest(local: Local, part: int) -> arb:
    """No more than the root or the power of a form is on a box, by its radicand."""
    radicand = _radicand(local.model.builder, part)
    square = None if radicand is None else local.value(radicand)
    largest = None if square is None else root(square)
    return arb(0, math.inf) if largest is None else arb(largest.upper()) ** arb(_exponent(local.model.builder, part))
