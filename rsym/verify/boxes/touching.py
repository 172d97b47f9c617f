"""Sheets that touch along a whole curve: what the logic makes of leaves that are related by exact division.

On a box let s P_g = q P_f + R, with s and q of one sign there and R = h u**k, h of one sign or not changing it
(`contact_relations`). Then the sign of g is never below (or above) that of q f where R is not below (above) zero, and
both are the same where u = 0. These are all combinations of signs that can occur, so:
- where the formula has the sign of one leaf in all of them, the boundary on the box is that leaf: of a ball that lies
  in a tube and touches it along a circle, nothing is left;
- where it has that of one leaf for u > 0 and that of the other for u < 0, and of both for u = 0, the boundary consists
  of {q P_f = 0} and {s P_g = 0}, one on either side of u = 0, which agree there to the order k: their difference is
  h u**k. So a cylinder meets a ball in a capsule, with k = 2, whatever leaf it is that ends them there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product

from rsym.logic.kleene import FEW, Formula, leaves_of, ternary
from rsym.verify.boxes.contact_relations import Contact, Contacts, contacts_of
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, Meeting
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.sheets import Sheets

LEAST = 2  # the order of a contact: sheets that cross are others' business


@dataclass(frozen=True)
class Relation:
    """On a box: sign(second) * way(second) >= sign(first) * way(first) where `above` times the rest is positive.

    Attributes
    ----------
    ways : pair of int
        What the signs of the leaves are multiplied by to be those of q P_f and of s P_g.
    above : int
        The sign of the rest but for its switch: 0 where there is no rest.
    switch : int or None
        The factor of the rest that changes its sign.
    zeros : tuple of (int, int)
        The factors that may vanish, with their powers: there both signs agree.
    """

    contact: Contact
    ways: tuple[int, int]
    above: int
    switch: int | None
    zeros: tuple[tuple[int, int], ...]

    def allows(self, signs: Mapping[int, int], side: int, switch: int | None) -> bool:
        """Whether leaves may have such signs where the switch has the sign `side`."""
        low, high = (way * signs[leaf] for way, leaf in zip(self.ways, self._leaves, strict=True))
        if self.above == 0 or (side == 0 and switch in dict(self.zeros)):
            return low == high
        if self.switch is not None and self.switch != switch:
            return True
        above = self.above * (1 if self.switch is None else side)
        return (high - low) * above >= 0

    @property
    def _leaves(self) -> tuple[int, int]:
        return self.contact.first, self.contact.second


@dataclass(frozen=True)
class Multiple:
    """A leaf that is a power of the switch, times a factor of known sign."""

    leaf: int
    sign: int
    power: int


Choice = tuple[int, int]  # a leaf, and the sign by which it is multiplied


def touching(local: Local, found: Sheets) -> int | Meeting | None:
    """The one leaf that is the boundary on a box, or the two that continue each other in it; None if neither is proved.

    Parameters
    ----------
    local : Local
        A box.
    found : Sheets
        The sheets on it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.sheets import sheets
    >>> from rsym.verify.boxes.local import Model
    >>> body = rsym.disjunction(rsym.conjunction(1 - x**2 - y**2, -z), 1 - x**2 - y**2 - z**2)
    >>> model = Model(rsym.Shape(body, (x, y, z)), {})
    >>> local = model.over(((0.9, 1.1), (-0.1, 0.1), (-0.1, 0.1)))
    >>> touching(local, sheets(local, model.root)).contact
    2
    """
    leaves, contacts = found.leaves, contacts_of(local.model)
    if not 2 <= len(leaves) <= FEW or not contacts.sought:
        return None
    relations = list(_relations(local, contacts, leaves))
    if not relations or not all(generators(local, leaf).analytic for leaf in leaves):
        return None
    constraints = tuple(relations)
    alone = _chosen(found.formula, constraints, (), None, (1,))
    if alone is not None:
        (leaf, sign), builder = alone[0], local.model.builder
        return leaf if sign > 0 else builder.neg(leaf)
    for switch in dict.fromkeys(zero for relation in relations for zero, _ in relation.zeros):
        if (result := _switched(local, contacts, found, constraints, switch)) is not None:
            return result
    return None


def related(local: Local, leaves: Sequence[int]) -> Iterator[tuple[int, int]]:
    """The pairs of leaves that may touch on a box: their gradients are nowhere proved to be independent."""
    for f, g in combinations(leaves, 2):
        p, q = local.gradient(f), local.gradient(g)
        if all((p[i] * q[j] - p[j] * q[i]).contains(0) for i in range(len(p)) for j in range(i)):
            yield f, g


def _relations(local: Local, contacts: Contacts, leaves: Sequence[int]) -> Iterator[Relation]:
    for f, g in related(local, leaves):
        for contact in contacts.between(f, g):
            relation = _relation(local, contacts, contact)
            if relation is not None:
                yield relation


def _relation(local: Local, contacts: Contacts, contact: Contact) -> Relation | None:
    """What a relation says on a box; None where a sign that it needs is not known."""
    forms = contacts.form(contact.first), contacts.form(contact.second)
    assert forms[0] is not None
    assert forms[1] is not None
    quotient = _sign(local, contact.quotient)
    ways = forms[0][0].sign(local) * quotient, forms[1][0].sign(local) * _sign(local, contact.multiplier)
    if 0 in ways:
        return None
    above, zeros = contact.sign, []
    for factor, power in contact.factors:
        sign = _sign(local, factor)
        if sign:
            above *= sign**power
        else:
            zeros.append((factor, power))
    odd = [factor for factor, power in zeros if power % 2]
    if len(odd) > 1:
        return None
    return Relation(contact, ways, above, odd[0] if odd else None, tuple(zeros))


def _sign(local: Local, number: int) -> int:
    local.value(number)
    return local.sign(number)


def _switched(
    local: Local, contacts: Contacts, found: Sheets, relations: tuple[Relation, ...], switch: int
) -> int | Meeting | None:
    """By the sides of a switch: one leaf, or one on each side."""
    multiples = []
    for leaf in found.leaves:
        power, rest = contacts.multiple(leaf, switch)
        form = contacts.form(leaf)
        sign = 0 if form is None else form[0].sign(local) * _sign(local, rest)
        if power and sign:
            multiples.append(Multiple(leaf, sign, power))
    chosen = _chosen(found.formula, relations, tuple(multiples), switch, (1, -1, 0))
    if chosen is None:
        return None
    plus, minus = chosen
    if plus == minus:
        return plus[0] if plus[1] > 0 else local.model.builder.neg(plus[0])
    for relation in relations:
        power = dict(relation.zeros).get(switch, 0)
        if power >= LEAST and {plus[0], minus[0]} == {relation.contact.first, relation.contact.second}:
            return _meeting(local, contacts, relation, (plus, minus), switch, power)
    return None


def _meeting(
    local: Local, contacts: Contacts, relation: Relation, chosen: Sequence[Choice], switch: int, power: int
) -> Meeting | None:
    """The leaves q P_f and s P_g, both with the inside where they are positive: they differ by a multiple of u**k."""
    builder, contact = local.model.builder, relation.contact
    ways = dict(zip((contact.first, contact.second), relation.ways, strict=True))
    signs = {ways[leaf] * sign for leaf, sign in chosen}
    first, second = contacts.form(contact.first), contacts.form(contact.second)
    if len(signs) != 1 or first is None or second is None:
        return None
    functions = {
        contact.first: builder.mul(contact.quotient, first[1]),
        contact.second: builder.mul(contact.multiplier, second[1]),
    }
    contacts.leaves |= {node: leaf for leaf, node in functions.items()}
    (sign,) = signs
    nodes = []
    for leaf, _ in chosen:
        own = functions[leaf] if sign > 0 else builder.neg(functions[leaf])
        contacts.leaves[own] = leaf
        nodes.append(own)
    return Meeting((BoundaryArc(nodes[0], switch), BoundaryArc(nodes[1], builder.neg(switch))), power)


@lru_cache(maxsize=4096)
def _chosen(
    formula: Formula,
    relations: tuple[Relation, ...],
    multiples: tuple[Multiple, ...],
    switch: int | None,
    sides: tuple[int, ...],
) -> tuple[Choice, ...] | None:
    """The leaf whose sign the formula has on each side that is not 0; on side 0 it must be that of all of them."""
    leaves = leaves_of(formula)
    chosen: list[Choice] = []
    for side in sides:
        fixed = {one.leaf: one.sign * side**one.power for one in multiples}
        table = [
            (signs, ternary(formula, signs))
            for values in product((-1, 0, 1), repeat=len(leaves))
            if _is_allowed(signs := dict(zip(leaves, values, strict=True)), fixed, relations, side, switch)
        ]
        if side == 0:
            if any(value != sign * signs[leaf] for signs, value in table for leaf, sign in chosen):
                return None
            continue
        own = next(
            (
                (leaf, sign)
                for leaf in leaves
                for sign in (1, -1)
                if leaf not in fixed and all(value == sign * signs[leaf] for signs, value in table)
            ),
            None,
        )
        if own is None:
            return None
        chosen.append(own)
    return tuple(chosen)


def _is_allowed(
    signs: Mapping[int, int],
    fixed: Mapping[int, int],
    relations: Sequence[Relation],
    side: int,
    switch: int | None,
) -> bool:
    return all(signs[leaf] == sign for leaf, sign in fixed.items()) and all(
        relation.allows(signs, side, switch) for relation in relations
    )
