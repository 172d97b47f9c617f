"""The sign form: a shape as min and max of its leaves, with the zero set and the signs of omega.

The sign of an R-operation depends only on the signs of its arguments, so for the
sign a conjunction is a min and a disjunction a max, of whatever system; where
omega = 0 off the edges, its gradient has the direction of that of the active
argument. Positive factors drop, odd powers and normalisation too, and negations
move to the leaves: -(f and g) is -f or -g. What remains at the ends, a *leaf*,
has no R-operation on top: blends, trimming, joining and R-operations inside
arithmetic stay as they are. A *gate* is a min or a max of two operands; gates are evaluated in order.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import NamedTuple

from rsym.errors import RsymError
from rsym.logic.choices import chosen_by_size
from rsym.logic.domains import ended, keep_walls
from rsym.logic.gates import Gate, gate_of, through
from rsym.logic.steps import has_steps, is_between, parted
from rsym.logic.stripping import Signed, Stripping, constant_sign, formal_sign, of_size, sign_gate, unscaled
from rsym.model.blends.gates import with_gates
from rsym.model.shape import Shape
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.program.calculus import Calculus
from rsym.program.fields import fields_program
from rsym.program.lowering import lower
from rsym.program.operations import KINKED
from rsym.program.program import Program, live


class Operand(NamedTuple):
    """A gate or a leaf by its number among its kind."""

    is_gate: bool
    number: int

    def after(self, leaves: int) -> int:
        """The number among leaves and gates together."""
        return self.number + leaves * self.is_gate


@dataclass(frozen=True)
class SignForm:
    """Leaves, and the gates that join them; the last gate is the form, without gates the only leaf.

    Attributes
    ----------
    builder : Builder
        Where the leaves are nodes.
    leaves : tuple of int
        Their nodes. A leaf is positive where its part of the body is inside.
    gates : tuple of Gate
        In the order of evaluation.
    parameters : tuple of (operation, node)
        The parameters of the R-operations that became gates, which must be legal for the form to hold.
    caps : int
        How many of the last leaves are sides of the bounds.
    folds : tuple of int
        The numbers of the leaves that only say which of others counts, or nothing: no zero of omega is there but of
        others.
    ends : tuple of int
        The numbers of the leaves that are ends of domains.
    """

    builder: Builder = field(repr=False)
    leaves: tuple[int, ...]
    gates: tuple[Gate, ...]
    parameters: tuple[tuple[str, int], ...] = ()
    caps: int = 0
    folds: tuple[int, ...] = ()
    ends: tuple[int, ...] = ()

    @property
    def value(self) -> int:
        """The node of the form."""
        make = self.builder.make
        return through(self.gates, self.leaves, lambda gate, first, second: make(gate.operation, first, second))[-1]

    @property
    def key(self) -> str:
        """Forms with the same key have the same leaves, gates and parameters: what is made for one serves the other."""
        chosen = {f"{k}": node for k, (_, node) in enumerate(self.parameters)}
        chosen |= {f"fold {k}": self.leaves[k] for k in self.folds}  # no gate may have them
        digest = self.builder.program({"value": self.value, **chosen}).digest
        return f"{self.leaves}{self.gates}{self.ends or ''}{[operation for operation, _ in self.parameters]}{digest}"

    @property
    def walls(self) -> dict[int, dict[int, int | None]]:
        """The leaves that are ends of domains: the body ends there, omega is not zero; by leaf what it is at a wall."""
        places = {node: number for number, node in enumerate(self.leaves)}
        limits = [(end, self.builder.walls.get(self.leaves[end], {})) for end in self.ends]
        return {end: {places[leaf]: limit for leaf, limit in at.items() if leaf in places} for end, at in limits}

    def remade(self, leaves: Sequence[int], make: Callable[[str, int, int], int] | None = None) -> int:
        """The node of a form of the same signs with others for the leaves; ends of domains stay that."""
        b, ends = self.builder, set(self.ends)
        make = make or b.make

        def join(gate: Gate, one: tuple[int, bool], other: tuple[int, bool]) -> tuple[int, bool]:
            (f, f_ends), (g, g_ends) = one, other
            if f_ends == g_ends:
                return make(gate.operation, f, g), f_ends
            domain, value = (f, g) if f_ends else (g, f)
            if gate.operation == "min":
                return ended(b, domain, value), False
            f, g = (ended(b, node, b.const(1)) if is_end else node for node, is_end in (one, other))
            return make(gate.operation, f, g), False

        node, is_end = through(self.gates, [(node, number in ends) for number, node in enumerate(leaves)], join)[-1]
        return ended(b, node, b.const(1)) if is_end else node

    @property
    def traced(self) -> bool:
        """Whether all jumps of leaves are at conditions of their own: not those of a floor or a Mod."""
        nodes, uniform = self.builder.nodes, self.builder.uniform
        return not any(nodes[part].operation == "floor" and not uniform[part] for part in live(nodes, self.leaves))

    def require_traced(self) -> None:
        """Refuse leaves with jumps that no condition of their own tells."""
        if not self.traced:
            raise RsymError(
                "the boundary jumps with a floor or a Mod, and where it does cannot be traced",
                code="jump",
                remedy="write the pieces that lie in the bounds as a union, or as a Piecewise of conditions",
            )

    def capped(self) -> SignForm:
        """The form inside its bounds, six leaves more; the bounds are the letters ``x lower``, ``x upper``, ..."""
        b = self.builder
        sides = []
        for name in b.coordinates:
            lower, upper = cap_letters(name)
            sides += [b.sub(b.input(name), b.input(lower)), b.sub(b.input(upper), b.input(name))]
        shift, count = len(sides), len(self.leaves)
        gates = [Gate(op, *(a + shift * (a >= count) for a in operands)) for op, *operands in self.gates]
        form = count + shift + len(gates) - 1 if gates else 0
        # The sides among themselves first: where none of them matters that is one question.
        last = count
        for number in range(1, shift):
            gates.append(Gate("min", last, count + number))
            last = count + shift + len(gates) - 1
        gates.append(Gate("min", form, last))
        return SignForm(b, (*self.leaves, *sides), tuple(gates), self.parameters, shift, ends=self.ends)


def cap_letters(coordinate: str) -> tuple[str, str]:
    """The letters of the bounds of a coordinate; no letter of a user has a space in its name."""
    return f"{coordinate} lower", f"{coordinate} upper"


def surface_form(shape: Shape, *more: str) -> SignForm:
    """The sign form of a shape, whose builder knows its bounds too, and coordinates more on which it does not depend.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> form = surface_form(rsym.Shape(rsym.conjunction(x, -rsym.conjunction(y, z)), (x, y, z)))
    >>> form.gates
    (Gate(operation='max', first=1, second=2), Gate(operation='min', first=0, second=3))
    """
    names = (*(symbol.name for symbol in shape.coordinates), *more)
    builder = Builder(names, (*shape.letters, *(letter for name in names for letter in cap_letters(name))))
    return sign_form(builder, lower(builder, with_gates(shape.expression)))


def shape_builder(shape: Shape, *more: str) -> Builder:
    """A builder of the coordinates of a shape, and more on which it does not depend, and of its letters."""
    return Builder((*(symbol.name for symbol in shape.coordinates), *more), tuple(shape.letters))


def shape_form(shape: Shape, *more: str) -> SignForm:
    """The sign form in the coordinates and letters of a shape alone, and more: the same leaves, in the same order."""
    builder = shape_builder(shape, *more)
    return sign_form(builder, lower(builder, with_gates(shape.expression)))


def known_form(shape: Shape) -> SignForm | None:
    """The form that says where a shape is if omega does not, for parts of it have no value somewhere or jump.

    Examples
    --------
    >>> import rsym, sympy
    >>> from rsym import x, y
    >>> len(known_form(rsym.Shape(sympy.sqrt(x) - y, (x, y))).leaves), known_form(rsym.disc(1))
    (3, None)
    """
    form = shape_form(shape)
    nodes, uniform = form.builder.nodes, form.builder.uniform
    signs = {number for number, node in enumerate(nodes) if node.operation == "sign" and not uniform[number]}
    known = form.traced and not form.builder.rewritten and signs <= set(live(nodes, form.leaves))
    return None if known else form


def surface_program(shape: Shape, fields: Sequence[str]) -> Program:
    """The program of a function with the same zero set and signs: constant factors drop, omega_n goes back to omega.

    Where derivatives of omega do not exist a normalised value need not exist; omega does. Where omega itself does not
    say where the shape is, it is the form that does (`known_form`).
    """
    if (known := known_form(shape)) is not None:
        return fields_program(Calculus(known.builder, known.value), fields)
    builder = shape_builder(shape)
    stripped = Stripping(
        builder, partial(constant_sign, builder), keeps=lambda node: builder.nodes[node].operation == "normalised"
    )
    return fields_program(Calculus(builder, stripped(lower(builder, shape.expression)).made(builder)), fields)


def sign_form(builder: Builder, number: int) -> SignForm:
    """The sign form of a node: leaves that have a value everywhere, and do not jump (`domains`, `steps`)."""
    form = _gated(builder, number)
    made = _known(builder, number, ())
    if made == number:
        return form
    builder.rewritten = True
    found = replace(_gated(builder, made, alike=unscaled), parameters=form.parameters)
    keep_walls(builder, found.leaves, found.ends, lambda domain: _gated(builder, domain).leaves)
    return found


def decided(builder: Builder, number: int) -> int:
    """The node, or one of its sign with the boundary that is lost of it beside parts without a value, and in jumps.

    Where a jump may have a value of its own, which belongs to neither of its sides, the node is left as it is.
    """
    form = _gated(builder, number)
    jumps = any(has_steps(builder, leaf) for leaf in form.leaves)
    if jumps and not all(is_between(builder, leaf) for leaf in form.leaves):
        return number
    return _known(builder, number, ()) if jumps or any(gate.operation == "max" for gate in form.gates) else number


def _known(builder: Builder, number: int, guards: Collection[int]) -> int:
    """The node, or one of the same sign whose leaves have a value everywhere and do not jump."""
    form = _gated(builder, number)
    known = partial(_known, builder)
    leaves = [parted(builder, leaf, guards, known) for leaf in form.leaves]
    if tuple(leaves) == form.leaves:
        return number
    return form.remade(leaves, partial(sign_gate, builder))


def _gated(
    builder: Builder,
    number: int,
    alike: Callable[[Builder, int], Hashable] | None = None,
    faces: Collection[Hashable] = (),
) -> SignForm:
    """The sign form of a node by its gates alone; leaves of which `alike` tells the same are one, the first.

    Conditions and what they choose are often the same leaf, written otherwise. A leaf that is a face in one place and
    the end of a domain in another is two, but those that are `faces` in any case.
    """
    leaves: dict[tuple[Hashable, bool], int] = {}
    nodes: list[int] = []
    joined: list[tuple[str, Operand, Operand]] = []
    parameters: dict[tuple[str, int], None] = {}
    done: dict[_Part, Operand] = {}
    whole = _Part(stripped(builder, number), False)
    for part, operands in with_operands(whole, partial(_operands, builder), tuple):
        if not operands:
            node = of_size(builder, part.part).made(builder)
            key = node if alike is None else alike(builder, node)
            place = leaves.setdefault((key, part.ends and key not in faces), len(nodes))
            nodes += [node] if place == len(nodes) else []
            done[part] = Operand(False, place)
            continue
        operation, arguments, _ = builder.nodes[part.part.number]
        parameters.update(((operation, parameter), None) for parameter in arguments[2:])
        first, second = done[operands[0]], done[operands[-1]]
        if first == second:
            done[part] = first
        else:
            joined.append((gate_of(operation, part.part.sign), first, second))
            done[part] = Operand(True, len(joined) - 1)
    gates = tuple(Gate(op, *(operand.after(len(nodes)) for operand in operands)) for op, *operands in joined)
    ends = {place: key for (key, is_end), place in leaves.items() if is_end}
    form = SignForm(builder, tuple(nodes), gates, tuple(parameters), ends=tuple(ends))
    twins = {place: leaves[key, False] for place, key in ends.items() if (key, False) in leaves}
    bounding = {ends[place] for place in _needless(form, twins)}
    return _gated(builder, number, alike, bounding) if bounding else form


def _needless(form: SignForm, twins: Mapping[int, int]) -> set[int]:
    """Those ends of domains of which a gate above needs the face as well: that is the boundary there."""
    if not twins:
        return set()
    count = len(form.leaves)
    faces = {*twins.values()}
    needed: list[set[int]] = [{number} & faces for number in range(count)]
    for gate in form.gates:
        needed.append(needed[gate.first] | needed[gate.second] if gate.operation == "min" else set())
    around: dict[int, set[int]] = {}
    for number in reversed(range(count, count + len(form.gates))):
        of_gate = around.setdefault(number, set()) | needed[number]
        for operand in form.gates[number - count][1:]:
            around[operand] = around.get(operand, of_gate) & of_gate
    return {end for end, face in twins.items() if face in around[end]}


class _Part(NamedTuple):
    """A node on the way to the leaves, and whether it is the end of a domain."""

    part: Signed
    ends: bool


def _operands(builder: Builder, part: _Part) -> Sequence[_Part]:
    """The operands of a gate; a domain that all counts in stands alone (`domains.ended`)."""
    (number, sign), ends = part
    operation, arguments, _ = builder.nodes[number]
    if not gate_of(operation):
        return ()
    domain = builder.ending.get(number)
    parts = [_Part(stripped(builder, argument, sign), ends or argument == domain) for argument in arguments[:2]]
    return [part for part in parts if part.ends or builder.value(part.part.number) is None] if domain else parts


def beside_idle(
    builder: Builder, number: int, sign_of: Callable[[int], int], legal: Callable[[int], bool]
) -> Signed | None:
    """The operand that an R-operation equals in sign, the other being true in an "and", false in an "or"; else None."""
    operation, arguments, _ = builder.nodes[number]
    kind = gate_of(operation)
    if not kind or not legal(number):
        return None
    idle = 1 if kind == "min" else -1
    return next((Signed(b) for a, b in (arguments[:2], arguments[1::-1]) if sign_of(a) == idle), None)


def stripped(builder: Builder, number: int, sign: int = 1) -> Signed:
    """Without negations and negative constants, which count, positive factors, odd powers and normalisation.

    Choices that are minima or maxima are those.
    """
    kept = Stripping(builder, partial(formal_sign, builder), partial(formal_sign, builder))
    return replace(kept, otherwise=partial(chosen_by_size, builder, sign_like=kept))(number, sign)


def has_kinks(builder: Builder, leaf: int) -> bool:
    """Whether a leaf has an operation inside that may make a kink in its zero set."""
    return any(builder.nodes[number].operation in KINKED for number in live(builder.nodes, [leaf]))
