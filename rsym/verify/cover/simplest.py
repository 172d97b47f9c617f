"""The simplest function with the same zero set and the same signs, for many boxes at once: `locus.reduce` in float64.

On a box where the sign of a test is known, branches are decided, positive factors drop, and of a conjunction whose
one operand is positive the other is left. What is left has tighter images: a fillet is flat beside its edge.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from rsym.logic.sign_form import beside_idle
from rsym.logic.stripping import Stripping
from rsym.program.builder import Builder
from rsym.program.operations import BRANCHING, LOGICAL
from rsym.program.program import live
from rsym.verify.boxes.domains import switch_of
from rsym.verify.boxes.resolution import remade
from rsym.verify.cover.images import Boxes, Images, is_legal

RARE = 1 / 64  # of the boxes: for fewer another function is not worth its compilation


def simplest(images: Images, node: int, boxes: Boxes, *, rare: float = RARE) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Functions that have the zeros and signs of a node on boxes on which it is defined, and the places of these.

    A function of `rare` of the boxes or less is left out: these stay with the node itself.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.cover.forming import formation
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape((x - 1) * (2 + abs(y)), (x, y, z)), {})
    >>> images = Images(model, formation(model, lambda node: True), {})
    >>> ((found, places),) = simplest(images, model.root, np.array([[(0.9, 1.1), (0.2, 0.3), (0.0, 0.1)]]))
    >>> model.builder.nodes[found].operation, places
    ('add', array([0]))
    """
    builder = images.model.builder
    tests = list(_tests(builder, node))
    signs = images.signs(tests, boxes)
    patterns, inverse = np.unique(signs, axis=1, return_inverse=True)
    found: dict[int, list[NDArray[np.int64]]] = {}
    for k in range(patterns.shape[1]):
        places = np.flatnonzero(inverse.ravel() == k)
        known = {test: int(sign) for test, sign in zip(tests, patterns[:, k], strict=True) if sign}
        found.setdefault(_simple(builder, node, known), []).append(places)
    rest = [np.empty(0, np.int64)]
    for simple, parts in found.items():
        places = np.concatenate(parts)
        if simple != node and len(places) > rare * len(boxes):
            yield simple, places
        else:
            rest.append(places)
    if len(places := np.concatenate(rest)):
        yield node, places


def _tests(builder: Builder, node: int) -> Iterator[int]:
    """The nodes whose signs may make the node simpler; at least one."""
    tests = {node: None}
    outer = {node}  # what the zeros are those of, if factors drop
    for part in reversed(live(builder.nodes, [node])):
        operation, arguments, _ = builder.nodes[part]
        if operation in BRANCHING:
            tests[switch_of(builder, part)] = None
        elif operation in LOGICAL and is_legal(builder, part):
            tests |= dict.fromkeys(arguments[:2])
        if part not in outer or operation == "add":
            continue
        outer |= set(arguments)
        if operation in {"mul", "div"}:
            tests |= dict.fromkeys(arguments)
    return iter(tests)


def _simple(builder: Builder, node: int, known: Mapping[int, int]) -> int:
    """The function where the tests have these signs; on such a box every step keeps its zeros and its signs."""
    done: dict[int, int] = {}
    for part in live(builder.nodes, [node]):
        done[part] = _decided(builder, part, done, known)
    signs = {done.get(test, test): sign for test, sign in known.items()}
    stripped = Stripping(
        builder,
        lambda factor: signs.get(factor, 0),
        lambda divisor: signs.get(divisor, int(builder.nonnegative[divisor])),
        otherwise=lambda part: beside_idle(
            builder, part, lambda one: signs.get(one, 0), lambda one: is_legal(builder, one)
        ),
    )
    return stripped(done[node]).made(builder)


def _decided(builder: Builder, part: int, done: Mapping[int, int], known: Mapping[int, int]) -> int:
    """A node with its branches decided, equal to it on the box."""
    operation, arguments, _ = builder.nodes[part]
    inner = tuple(done[argument] for argument in arguments)
    sign = known.get(switch_of(builder, part), 0) if operation in BRANCHING else 0
    if sign:
        if operation == "abs":
            return inner[0] if sign > 0 else builder.neg(inner[0])
        if operation == "sign":
            return builder.const(sign)
        if operation == "select":
            return inner[2 if sign > 0 else 3]
        return inner[0 if (sign > 0) == (operation == "max") else 1]
    return remade(builder, part, inner)
