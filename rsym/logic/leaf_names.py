"""What the leaves of a sign form are called: by the parts of the shape that they come from."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from operator import itemgetter

import sympy as sp

from rsym.logic.sign_form import SignForm, shape_form, sign_form
from rsym.logic.stripping import scaled
from rsym.model.blends.gates import with_gates
from rsym.model.nodes import Fold
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all

LONGEST_FORMULA = 40  # characters
# A formula of more pieces is too long to be read, and written out it may be exponentially longer than it is stored.
MOST_PIECES = 60
FLOAT_DIGITS = 15  # that SymPy writes at most


def leaf_names(form: SignForm, shape: Shape) -> tuple[str, ...]:
    """One name for each leaf of the sign form of a shape.

    A leaf is called like the smallest part of the shape, the one of fewest
    leaves, that has it or its negation among its leaves; of parts of one size,
    like the first. A leaf of no part is called by its formula, a long one by its
    number, a side of the bounds ``cap x lower``.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> slab = rsym.Shape(1 - z**2, (x, y, z)).named("slab")
    >>> corner = rsym.Shape(rsym.conjunction(x, y), (x, y, z))
    >>> shape = slab - corner.named("corner") - rsym.Shape(x + y, (x, y, z))
    >>> leaf_names(surface_form(shape), shape)
    ('slab', 'corner', 'corner', '-x - y')
    """
    return tuple(names[0] for names in leaf_parts(form, shape))


def leaf_parts(form: SignForm, shape: Shape) -> tuple[tuple[str, ...], ...]:
    """The names of all parts that have a leaf, for each leaf: the smallest part, after which it is called, is first.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import surface_form
    >>> lens = (rsym.disc(2).named("rim") & rsym.Shape(x, (x, y))).named("half")
    >>> leaf_parts(surface_form(lens - rsym.disc(1)), lens - rsym.disc(1))
    (('rim', 'half'), ('half',), ('x**2/2 + y**2/2 - 1/2',))
    """
    count = len(form.leaves) - form.caps
    # SymPy moves signs and constant factors about.
    keys = [scaled(form.builder, leaf)[0] for leaf in form.leaves[:count]]
    named = _names_of_parts(form.builder, shape)
    texts = {} if all(key in named for key in keys) else _formulas(form.builder, shape.expression)
    names = [named.get(key) or (texts.get(key) or f"leaf {number}",) for number, key in enumerate(keys)]
    sides = [(f"cap {coordinate} {side}",) for coordinate in shape.coordinates for side in ("lower", "upper")]
    return (*names, *sides[: form.caps])


@recently(16, written)
def shape_leaf_parts(shape: Shape) -> tuple[tuple[str, ...], ...]:
    """Those of the leaves of ``shape_form(shape)``, which are those of ``surface_form(shape)``."""
    return leaf_parts(shape_form(shape), shape)


def shape_leaf_names(shape: Shape) -> tuple[str, ...]:
    """Their names."""
    return tuple(names[0] for names in shape_leaf_parts(shape))


def _names_of_parts(builder: Builder, shape: Shape) -> Mapping[int, tuple[str, ...]]:
    """The names of the parts that hold a leaf, the smallest first, by the key of the leaf."""
    known = {*builder.coordinates, *builder.letters}
    # A part may speak of letters that have cancelled out of the shape: it is no part of it any more.
    parts = [part for part in shape.parts if all(symbol.name in known for symbol in symbols_of(part[1]))]
    # SymPy moves the sign of -(a - b) inwards, so a negation may be another formula: b - a.
    nodes = lower_all(builder, [signed for _, part in parts for signed in map(with_gates, (part, -part))])
    leaves = [[scaled(builder, leaf)[0] for leaf in sign_form(builder, node).leaves] for node in nodes]
    holding: defaultdict[int, list[tuple[int, str]]] = defaultdict(list)
    for (name, _), *both in zip(parts, leaves[::2], leaves[1::2], strict=True):
        for keys in both:
            for key in keys:
                holding[key].append((len(keys), name))
    return {
        key: tuple(dict.fromkeys(name for _, name in sorted(found, key=itemgetter(0))))
        for key, found in holding.items()
    }


def _formulas(builder: Builder, expression: sp.Expr) -> Mapping[int, str]:
    """The text of the operands of R-operations, by the key of the leaf that they make."""
    operands = [operand for operand in _operands(expression) if _is_short(operand)]
    texts: dict[int, str] = {}
    for operand, node in zip(operands, lower_all(builder, operands), strict=True):
        leaves = sign_form(builder, node).leaves
        if len(leaves) == 1:
            text = sp.sstr(operand)
            texts.setdefault(scaled(builder, leaves[0])[0], text if len(text) <= LONGEST_FORMULA else "")
    return texts


def _operands(expression: sp.Expr) -> Iterator[sp.Expr]:
    yield expression
    for part in postorder(expression):
        if isinstance(part, Fold | sp.Min | sp.Max):
            skipped = part.parameter_count if isinstance(part, Fold) else 0
            yield from (operand for operand in part.args[skipped:] if not isinstance(operand, Fold))


def _is_short(expression: sp.Expr) -> bool:
    """Whether the text of a formula may be short; of a large one it takes long to write it."""
    pieces: dict[int, int] = {}
    for part in postorder(expression):
        pieces[id(part)] = 1 + sum(pieces[id(argument)] for argument in part.args)
    return pieces[id(expression)] <= MOST_PIECES and _least_length(expression) <= LONGEST_FORMULA


def _least_length(expression: sp.Expr) -> int:
    """So many characters at least has the text of a formula of few pieces: names, digits, powers and plus signs."""
    total, stack = 0, [expression]
    while stack:
        part = stack.pop()
        if isinstance(part, sp.Symbol):
            total += len(part.name)
        elif isinstance(part, sp.Rational):
            total += sum(len(str(abs(int(number)))) for number in (part.p, part.q) if abs(number) != 1)
        elif isinstance(part, sp.Float):
            digits = f"{float(part):.{FLOAT_DIGITS}g}".partition("e")[0]
            total += len(digits.strip("-").replace(".", "").strip("0"))
        elif isinstance(part, sp.Add):
            total += len(" + ") * (len(part.args) - 1)
            stack.extend(part.args)
        elif isinstance(part, sp.Mul):
            stack.extend(part.args)
        elif isinstance(part, sp.Pow):
            stack.append(part.base)
            if part.exp.is_Integer and abs(part.exp) > 1:  # others may be written as a root or a fraction
                total += len("**") + len(str(abs(int(part.exp))))
    return total
