"""What the leaves of a sign form are called: by the parts of the shape that they come from."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping

import sympy as sp

from rsym.logic.faces import BETWEEN, faces_of, shape_faces
from rsym.logic.sign_form import SignForm, shape_form, sign_form
from rsym.logic.stripping import scaled
from rsym.model.blends.gates import with_gates
from rsym.model.nodes import Fold
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.model.symbols import postorder
from rsym.program.builder import Builder
from rsym.program.lowering import lower, lower_all

LONGEST_FORMULA = 40  # characters
# A formula of more pieces is too long to be read, and written out it may be exponentially longer than it is stored.
MOST_PIECES = 60
FLOAT_DIGITS = 15  # that SymPy writes at most


def leaf_names(form: SignForm, shape: Shape) -> tuple[str, ...]:
    """One name for each leaf of a sign form of a shape.

    A leaf is called like the smallest part of the shape, the one of fewest
    leaves, that it belongs to; of parts of one size, like the first. A leaf of
    several parts, which has a face of each, has the names of all: ``A / B``;
    which one bounds the body at a point, `rsym.sampling.labels` tells. A leaf of
    no part is called by its formula, a long one by its number, a side of the
    bounds ``cap x lower``.

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
    return tuple(title for title, _ in _named(form, shape))


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
    return tuple(parts for _, parts in _named(form, shape))


@recently(16, written)
def shape_leaf_parts(shape: Shape) -> tuple[tuple[str, ...], ...]:
    """Those of the leaves of ``shape_form(shape)``, which are those of ``surface_form(shape)``."""
    return leaf_parts(shape_form(shape), shape)


@recently(16, written)
def shape_leaf_names(shape: Shape) -> tuple[str, ...]:
    """Their names."""
    return leaf_names(shape_form(shape), shape)


@recently(16, written)
def face_names(shape: Shape) -> tuple[str, ...]:
    """The name of each of the faces of a shape alone; of no part, that of its formula."""
    faces = shape_faces(shape)
    texts = _texts(faces.form, shape) if any(not face.parts for face in faces.faces) else []
    return tuple(face.parts[0] if face.parts else texts[face.leaf] for face in faces.faces)


def _named(form: SignForm, shape: Shape) -> list[tuple[str, tuple[str, ...]]]:
    """Title and parts of each leaf of a form that may have been made from that of the shape."""
    b, count = form.builder, len(form.leaves) - form.caps
    plain = sign_form(b, lower(b, with_gates(shape.expression)))
    faces = faces_of(plain, shape)
    # SymPy moves signs and constant factors about.
    of_key: defaultdict[int, list[int]] = defaultdict(list)
    for number, face in enumerate(faces.faces):
        if face.parts:
            of_key[scaled(b, plain.leaves[face.leaf])[0]].append(number)
    keys = [scaled(b, leaf)[0] for leaf in form.leaves[:count]]
    texts = _texts(form, shape) if not all(key in of_key for key in keys) else [""] * len(keys)
    named = [
        (BETWEEN.join(faces.title(of_key[key])), faces.holding(of_key[key])) if key in of_key else (text, (text,))
        for key, text in zip(keys, texts, strict=True)
    ]
    sides = [f"cap {coordinate} {side}" for coordinate in shape.coordinates for side in ("lower", "upper")]
    return [*named, *((side, (side,)) for side in sides[: form.caps])]


def _texts(form: SignForm, shape: Shape) -> list[str]:
    """The leaves by their formulas, long ones by their numbers."""
    texts = _formulas(form.builder, shape.expression)
    keys = [scaled(form.builder, leaf)[0] for leaf in form.leaves[: len(form.leaves) - form.caps]]
    first = {key: number for number, key in reversed(list(enumerate(keys)))}
    return [texts.get(key) or f"leaf {first[key]}" for key in keys]


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
