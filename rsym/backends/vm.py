"""The plain text of fidget and MPR, whose public models are of this kind: a line a name, an operation, its arguments.

Names are numbered without a gap in hexadecimal, and one comment stands in front: some readers count on both. Inside is
negative. There is no choice between two values but min and max, so R_0 is written without one, in a form that keeps
the sign all the same. `rsym.load` reads such texts (`rsym.language.vm`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from fractions import Fraction

from rsym.backends.languages import folded, text_of
from rsym.errors import RsymError
from rsym.program.expansion import expand
from rsym.program.program import FLOAT32, Node, Program, constant_value, live
from rsym.program.row import HALF, Expansion, Nodes

AXES = ("var-x", "var-y", "var-z")
# Added where a sum of sizes is divided by, in single precision, as these texts are evaluated: its inverse is no NaN.
TINY = Fraction(1, 10**30)
UNSAFE = re.compile(r"[^A-Za-z0-9_ =;,.+-]")


def vm_source(program: Program, defaults: Mapping[str, float]) -> str:
    """The text of a program of one output, with these values of its letters."""
    if len(program.coordinates) > len(AXES):
        raise RsymError(
            f"the format 'vm' has three coordinates, the shape has {', '.join(program.coordinates)}",
            code="dimension",
            remedy="take a section",
        )
    plain = expand(_with_numbers(program, defaults), RULES)
    ((name, output),) = plain.outputs
    nodes = [_shorter(plain, node) for node in plain.nodes]
    if plain.nodes[output].operation == "neg":
        (output,) = plain.nodes[output].arguments
    else:
        nodes.append(Node("neg", (output,)))
        output = len(nodes) - 1
    used = live(nodes, [output])
    # A coordinate that nothing needs has a line too, for readers tell plane and space by it.
    unused = [name for name in plain.coordinates if not any(nodes[k] == Node("input", (), name) for k in used)]
    kept = [*range(len(nodes), len(nodes) + len(unused)), *used]
    nodes += [Node("input", (), name) for name in unused]
    names = {number: f"_{k:x}" for k, number in enumerate(kept)}
    axes = ", ".join(f"{name} = {axis}" for name, axis in zip(plain.coordinates, AXES, strict=False))
    lines = [f"# {UNSAFE.sub('_', f'{name} of an R-function, inside is negative; {axes}')}"]
    for number in kept:
        text = _text(plain, nodes[number]).format(*(names[argument] for argument in nodes[number].arguments))
        lines.append(f"{names[number]} {text}")
    return "\n".join(lines) + "\n"


def _with_numbers(program: Program, defaults: Mapping[str, float]) -> Program:
    """The program with what does not depend on the point as constants."""
    nodes = list(program.nodes)
    for number, value in folded(program, defaults).items():
        nodes[number] = Node("const", (), Fraction(value)) if math.isfinite(value) else Node("undefined")
    return Program(tuple(nodes), program.coordinates, (), program.outputs)


def _shorter(program: Program, node: Node) -> Node:
    """Squares and differences, which the format has."""
    if node.operation == "mul" and node.arguments[0] == node.arguments[1]:
        return Node("square", node.arguments[:1])
    if node.operation == "add":
        for place, number in enumerate(node.arguments):
            if program.nodes[number].operation == "neg":
                return Node("sub", (node.arguments[1 - place], *program.nodes[number].arguments))
    return node


def _text(program: Program, node: Node) -> str:
    if node.operation == "const":
        return f"const {constant_value(node.data, FLOAT32)!r}"
    if node.operation == "input":
        return AXES[program.coordinates.index(str(node.data))]
    return {"square": "square {}", "sub": "sub {} {}"}.get(node.operation) or text_of(node.operation, "vm")


def _safe_quotient(b: Nodes, top: int, sizes: tuple[int, int]) -> int:
    """The quotient by a sum of sizes, 0 where they and the numerator are."""
    return b.make("div", top, b.make("max", b.add(*sizes), b.const(TINY)))


def _root(b: Nodes, f: int, g: int) -> int:
    return b.sqrt(b.add(b.square(f), b.square(g)))


def _r0(sign: int) -> Expansion:
    """Of the operands m <= M: m + 2 min(M, 0) - m**2/(r + |M|), which does not cancel; the same mirrored for "or"."""

    def rule(b: Nodes, node: Node) -> int:
        near, far = (b.make(name, *node.arguments) for name in (("min", "max") if sign < 0 else ("max", "min")))
        rest = _safe_quotient(b, b.square(near), (_root(b, *node.arguments), b.abs(far)))
        beyond = b.mul(b.const(2), b.make("min" if sign < 0 else "max", far, b.const(0)))
        return b.add(b.add(near, rest if sign > 0 else b.neg(rest)), beyond)

    return rule


def _gap(b: Nodes, node: Node) -> int:
    """s**2/(2 (q + |t|)) + max(-t, 0)."""
    s, t = node.arguments
    rest = _safe_quotient(b, b.mul(b.const(HALF), b.square(s)), (_root(b, s, t), b.abs(t)))
    return b.add(rest, b.make("max", b.neg(t), b.const(0)))


def _trimming(b: Nodes, node: Node) -> int:
    return b.sqrt(b.add(node.arguments[0], b.square(_gap(b, node))))


def _normalised(b: Nodes, node: Node) -> int:
    f, q = node.arguments
    return b.make("div", f, b.sqrt(b.add(b.square(f), q)))


def _pow(b: Nodes, node: Node) -> int:
    """exp(a log(u))."""
    base, exponent = node.arguments
    return b.make("exp", b.mul(exponent, b.make("log", base)))


# In the place of the expansions of the rows, which choose between values.
RULES: dict[str, Expansion] = {
    "r0_conjunction": _r0(-1),
    "r0_disjunction": _r0(1),
    "gap": _gap,
    "trimming": _trimming,
    "normalised": _normalised,
    "pow": _pow,
}
