"""What vanishes at a singular point: as many equations as there are coordinates, for each way to be one.

In space a corner of three leaves; the place where the squares under a root vanish; a zero of the gradient of a leaf; a
point where two leaves touch, which is a critical point of one on the other. In the plane two leaves, what is under
roots, two switches, a switch and a leaf on one of its sides, the gradient of a leaf.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations, islice, pairwise, permutations

from rsym.bounds.balls import ctx
from rsym.logic.stripping import bare
from rsym.verify.boxes.contact_relations import contacts_of
from rsym.verify.boxes.generators import Generators, generators, square_roots
from rsym.verify.boxes.local import PRECISION, Box, Local, Model
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.resolution import put, resolve
from rsym.verify.boxes.root_classes import MODULI
from rsym.verify.boxes.sheets import Sheets
from rsym.verify.points.locating import PAIRS, Equations

TRIPLES = 12  # of leaves: a pyramid of six sides has twenty, of which one will do


def systems_in_space(local: Local, found: Sheets) -> Iterator[Equations]:
    """Three nodes that may vanish together where the sheets of a box are singular, those first that say most."""
    with ctx.workprec(PRECISION):
        for leaf in found.leaves:
            yield from _of_roots(local, leaf, found.leaves)
        for first, second, third in islice(combinations(found.leaves, 3), TRIPLES):
            yield Equations((first, second, third))
        for f, g in combinations(found.leaves, 2):
            yield _touching(local, f, g)
            yield _touching(local, g, f)
        for leaf in found.leaves:
            x, y, z = local.model.gradient(leaf)
            yield Equations((x, y, z))


def _of_roots(local: Local, leaf: int, leaves: Sequence[int]) -> Iterator[Equations]:
    """What vanishes under the roots of a leaf, and the leaf without them."""
    builder = local.model.builder
    for part in sorted(generators(local, leaf).hard):
        operation, arguments, _ = builder.nodes[part]
        if operation in {"sqrt", "trimming", "gap"}:
            squares = square_roots(builder, arguments[0])
            if operation != "sqrt" and len(squares) == 1:
                squares.append(arguments[1])
        else:
            squares = list(arguments[:2]) if operation in PAIRS else []
        for u, v, w in combinations(squares, 3):
            yield Equations((u, v, w))
        for u, v in combinations(squares, 2):
            rest = put(local.model, leaf, {part: builder.const(0)})
            yield Equations((u, v, rest), ((part, leaf),))
            yield from (Equations((u, v, other)) for other in leaves if other != leaf)


def _touching(local: Local, f: int, g: int) -> Equations:
    """F = 0, and grad f and grad g parallel."""
    sizes = [abs(float(slope.mid())) if slope.is_finite() else 0.0 for slope in local.gradient(f)]
    return Equations((f, *across(local.model, f, g, sizes.index(max(sizes)))))


def across(model: Model, f: int, g: int, k: int) -> tuple[int, int]:
    """The components of grad f x grad g with the component k of grad f: where that is not 0, they decide."""
    b, p, q = model.builder, model.gradient(f), model.gradient(g)
    i, j = (axis for axis in range(3) if axis != k)
    first, second = (b.sub(b.mul(p[k], q[axis]), b.mul(p[axis], q[k])) for axis in (i, j))
    return first, second


def _of_contacts(model: Model, f: int, g: int) -> Iterator[Equations]:
    """One of two leaves that touch, and a double factor h of their relation s P_g = q P_f + h**2 ...

    Where both vanish the other leaf does, if s and its conjugates do not, and both gradients are parallel.
    """
    b, contacts = model.builder, contacts_of(model)
    p, q = model.gradient(f), model.gradient(g)
    parallel = [b.sub(b.mul(p[i], q[j]), b.mul(p[j], q[i])) for i, j in permutations(range(len(p)), 2)]
    for contact in contacts.between(f, g):
        form = contacts.form(contact.second)
        nonzero = () if form is None else (contact.multiplier, *form[0].conjugates)
        for factor, power in contact.factors:
            if power > 1:
                implied = [(factor, node) for node in (contact.second, *parallel)]
                yield Equations((contact.first, factor), tuple(implied), nonzero)


def _of_powers(model: Model, leaf: int, found: Generators) -> Iterator[Equations]:
    """A switch under powers of its modulus, and the leaf without these."""
    nodes = model.builder.nodes
    powers = [part for part in found.switched if nodes[part].operation in MODULI]
    for switch in found.switches:
        own = [part for part in powers if bare(model.builder, nodes[part].arguments[0]) == switch]
        if own:
            rest = put(model, leaf, dict.fromkeys(own, model.builder.const(0)))
            yield Equations((switch, rest), tuple((part, leaf) for part in own[:1]))


def cuts_of_curves(local: Local, leaves: Sequence[int], middle: Sequence[float]) -> Iterator[Equations]:
    """What vanishes along a curve, of one leaf with powers or two that touch, in planes through the middle of a box."""
    with ctx.workprec(PRECISION):
        found = generators(local, leaves[0])
    model, builder = local.model, local.model.builder
    single = len(leaves) == 1
    for equations in _of_powers(model, leaves[0], found) if single else _of_contacts(model, leaves[0], leaves[1]):
        for name, value in zip(builder.coordinates, middle, strict=True):
            plane = builder.sub(builder.input(name), builder.const(Fraction(value)))
            yield equations._replace(nodes=(*equations.nodes, plane))


def systems_in_plane(model: Model, box: Box, locus: Locus) -> Iterator[Equations]:
    """Two nodes that may vanish together where the locus of a box is singular."""
    if locus.kind in {"conjunction", "disjunction", "product"}:
        yield from _of_contacts(model, *locus.nodes[:2])
        yield Equations(locus.nodes[:2])
    leaf = locus.nodes[0] if locus.kind == "leaf" else model.root
    with ctx.workprec(PRECISION):
        local = model.over(box)
        found = generators(local, leaf)
    for number in sorted(found.hard):
        operation, arguments, _ = model.builder.nodes[number]
        roots = square_roots(model.builder, arguments[0]) if operation == "sqrt" else []
        if len(roots) > 1:
            yield Equations((roots[0], roots[1]))
        elif arguments:
            yield Equations((arguments[0], arguments[1] if operation in PAIRS else leaf))
    yield from map(Equations, pairwise(found.switches))
    yield from _of_powers(model, leaf, found)
    for switch in found.switches:
        for way in (1, -1):
            with ctx.workprec(PRECISION):
                beside = resolve(local, leaf, switch, way)
            yield Equations((switch, beside))
    yield Equations(model.gradient(leaf))
