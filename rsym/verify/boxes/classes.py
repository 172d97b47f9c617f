"""Classes: how smooth a function is on a box in which several switches are zero, where they cross too.

Let u be continuous with |u| <= c |q - p| near each of its zeros p, and let F be equal to P where u >= 0 and to Q where
u <= 0. If P and Q are of class C^j on the box and |P - Q| <= c |u|**k with a k > j, then F is of class C^j, whatever
the zero set of u looks like: at a zero p of u, P - Q is of class C^j and |P - Q| <= c |q - p|**k, so its derivatives
up to order j vanish at p, and P and Q have one Taylor polynomial there; on either side of u = 0 the derivatives of F
differ from those of that polynomial by what the rest of P or that of Q allows, so they are derivatives of F, and
continuous. Where u = 0, a choice has the value of one of its formulas, and F that of P or of Q if all choices that u
decides take theirs from one side; `sign` has a value of its own there, and nothing is said. P and Q may have switches
of their own: one after the other they are resolved, and the class of F is the lowest that is met. A power |u|**a with
a fraction a is analytic on neither side; it is of class C^j for all whole j < a by itself, and sums, products and
compositions of functions of class C^j are so too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from rsym.logic.stripping import bare, factor
from rsym.program.operations import JUMPING, POWERS
from rsym.verify.boxes.domains import switch_of
from rsym.verify.boxes.folding import CONTINUOUS, WHOLE, folded
from rsym.verify.boxes.generators import Generators, generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.polynomials import multiplicity, ring_of
from rsym.verify.boxes.resolution import contact, resolve

MOST = 6  # switches that are resolved one after the other: 64 functions
PARTED = 3  # switches of a function that is parted by one of them
CURVED = 2  # a function of an order above that has second derivatives, which are continuous
TAKEN = {"sign": 0, "select": -1, "atan2": 1}  # on which side an operation has the value that it has on its switch
_LIPSCHITZ = CONTINUOUS | {"trimming"}


@dataclass(frozen=True)
class Pieces:
    """The functions that a node is on the parts of a box, each of class C^j on the whole box for all whole j < `order`.

    The node itself is of that class too; where it has a gradient, that is the gradient of one of them. With an
    infinite order it is equal to each of them: folds that cancel.
    """

    nodes: tuple[int, ...]
    order: float


NOTHING = Pieces((), 0)


def pieces(local: Local, number: int) -> Pieces:
    """The pieces of a node and their class; no pieces and the order 0 where no order above 2 is proved.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> from rsym.model.powers import AbsolutePower
    >>> from rsym.verify.boxes.local import Model
    >>> ball = 1 - sp.Abs(x)**3 - AbsolutePower(y, sp.Rational(5, 2)) - z**2
    >>> model = Model(rsym.Shape(ball, (x, y, z)), {})
    >>> found = pieces(model.over(((-1, 1),) * 3), model.root)
    >>> len(found.nodes), found.order
    (2, 2.5)
    """
    one = folded(local, number)
    if one is not None:
        return Pieces((ring_of(local.model).lowered(one),), math.inf)
    nodes: dict[int, None] = {}
    order = _order(local, number, nodes, MOST)
    return Pieces(tuple(nodes), order) if order > CURVED else NOTHING


def parted(local: Local, number: int, found: Generators) -> Meeting | None:
    """The two polynomials that a node is on the sides of one switch, where the folds of its others cancel.

    On either side of a switch u the node, which is continuous, is equal to its resolution there; if all folds of that
    cancel on the box, a polynomial. u divides the difference of both, so they agree where it is zero.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(sp.Abs(x) + sp.Max(y, z) + sp.Min(y, z), (x, y, z)), {})
    >>> local = model.over(((-1, 1),) * 3)
    >>> found = parted(local, model.root, generators(local, model.root))
    >>> [ring_of(model).polynomial(arc.function).as_expr() for arc in found.arcs], found.contact
    ([x + y + z, -x + y + z], 1)
    """
    model = local.model
    jumps = any(model.builder.nodes[part].operation not in CONTINUOUS for part in found.switched)
    if jumps or found.hard or len(found.switches) > PARTED:
        return None
    for switch in found.switches:
        if not generators(local, switch).analytic:
            continue
        sides = [folded(local, resolve(local, number, switch, side)) for side in (1, -1)]
        if any(side is None for side in sides):
            continue
        plus, minus = (ring_of(model).lowered(side) for side in sides)
        flat = resolve(local, switch, WHOLE, 1)
        contact = multiplicity(model, model.builder.sub(plus, minus), flat)
        if contact:
            return Meeting((BoundaryArc(plus, flat), BoundaryArc(minus, model.builder.neg(flat))), contact)
    return None


def _order(local: Local, number: int, nodes: dict[int, None], depth: int) -> float:
    """The order of a node, and the functions without switches that it is made of added to `nodes`; 0 if it is low."""
    found = generators(local, number)
    if found.hard or not all(_is_lipschitz(local, part) for part in found.switched):
        return 0
    resolved = _resolved(local, number, found)
    if resolved is None:
        nodes[number] = None
        return _of_powers(local, found)
    if depth == 0:
        return 0
    switch, plus, minus = resolved
    order = contact(local, number, switch) if _tests(local, found) <= {switch} else 0.0
    if order <= CURVED:
        order = _vanishing(local, local.model.builder.sub(plus, minus), switch, depth)
    for side in (plus, minus):
        if order > CURVED:
            order = min(order, _order(local, side, nodes, depth - 1))
    return order if order > CURVED else 0.0


def _tests(local: Local, found: Generators) -> set[int]:
    """The switches of choices, which are not continuous in what they test."""
    builder = local.model.builder
    choices = (part for part in found.switched if builder.nodes[part].operation == "select")
    return {bare(builder, switch_of(builder, part)) for part in choices}


def _is_lipschitz(local: Local, part: int) -> bool:
    """Whether an operation is Lipschitz continuous in its arguments, as the rules of `contact` ask, or a choice."""
    operation, arguments, _ = local.model.builder.nodes[part]
    if operation in POWERS:
        exponent = local.model.builder.value(arguments[1])
        return exponent is not None and exponent >= 1
    return operation in _LIPSCHITZ or operation == "select"


def _is_taken_from_one_side(local: Local, switch: int, found: Generators) -> bool:
    """Whether the node has the value of one of its sides where a switch is zero: all its choices take the same one."""
    builder = local.model.builder
    sides = set()
    for part in found.switched:
        operation = builder.nodes[part].operation
        if operation in JUMPING and bare(builder, tested := switch_of(builder, part)) == switch:
            sides.add(TAKEN[operation] * factor(builder, tested))
    return sides in (set(), {1}, {-1})


def _resolved(local: Local, number: int, found: Generators) -> tuple[int, int, int] | None:
    """An analytic switch that is more than the base of fractional powers, and the functions on its sides."""
    for switch in found.switches:
        if generators(local, switch).analytic and _is_taken_from_one_side(local, switch, found):
            plus, minus = (resolve(local, number, switch, side) for side in (1, -1))
            if (plus, minus) != (number, number):
                return switch, plus, minus
    return None


def _vanishing(local: Local, difference: int, switch: int, depth: int) -> float:
    """A k such that a function is at most c |u|**k on the box.

    Where it is a polynomial, how often u divides it; where it is one on either side of another switch, the least.
    """
    order = multiplicity(local.model, difference, switch)
    resolved = None if order or not depth else _resolved(local, difference, generators(local, difference))
    if resolved is None:
        return order
    first = _vanishing(local, resolved[1], switch, depth - 1)
    return min(first, _vanishing(local, resolved[2], switch, depth - 1)) if first > CURVED else 0.0


def _of_powers(local: Local, found: Generators) -> float:
    """The order of a node without switches but the bases of fractional powers: the least of their exponents."""
    nodes, order = local.model.builder.nodes, math.inf
    for part in found.switched:
        exponent = local.model.builder.value(nodes[part].arguments[1]) if nodes[part].operation in POWERS else None
        order = min(order, 0.0 if exponent is None else float(exponent))
    return order
