"""Two leaves that touch from outside at a point: discs side by side, or one beside a straight edge.

Let f and g be analytic around p, zero there, with gradients in opposite directions. With n along grad f and s along
the common tangent, f > 0 is n > phi(s) and g > 0 is n < psi(s); phi and psi and their first derivatives vanish at 0.
If phi'' > psi'' the graphs part at once, with a cusp on either side in which neither f nor g is positive; if
phi'' < psi'' one in which both are. So of "f and g", and of "f or g", one has four half-branches of its boundary at p,
and the other has p as its only zero nearby.
"""

from __future__ import annotations

from rsym.verify.answers.report import Joint
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import reduce
from rsym.verify.boxes.vanishing import Exact


def classify_tangency(known: Exact, at: Local) -> Joint | None:
    """What the boundary of two leaves is at a rational point where they touch from outside.

    Parameters
    ----------
    known : Exact
        What is known at the point, and a box around it.
    at : Local
        What is known at the point alone.

    Returns
    -------
    Joint or None
        A "node" or an "isolated point", proved; None if they do not touch so, or to a higher order.

    Examples
    --------
    >>> import rsym
    >>> from fractions import Fraction
    >>> from rsym import x, y
    >>> from rsym.bounds.balls import arb
    >>> from rsym.verify.boxes.local import Model
    >>> beside = rsym.disjunction(1 - (x - 1)**2 - y**2, 1 - (x + 1)**2 - y**2)
    >>> model, origin = Model(rsym.Shape(beside, (x, y)), {}), [arb(0), arb(0)]
    >>> known = Exact(model.on([arb(0, 0.01)] * 2), {"x": Fraction(0), "y": Fraction(0)}, frozenset())
    >>> found = classify_tangency(known, model.on(origin))
    >>> found.kind, found.branches, found.proved
    ('node', 4, True)
    """
    local, model = known.local, known.local.model
    locus = reduce(local, model.root)
    if locus.kind not in {"conjunction", "disjunction"}:
        return None
    f, g = locus.nodes
    if not all(generators(local, leaf).analytic for leaf in (f, g)) or not known.vanishes(f, g):
        return None
    builder, (p, q), (u, v) = model.builder, model.gradient(f), model.gradient(g)
    across = builder.sub(builder.mul(p, v), builder.mul(q, u))
    along = at.value(builder.add(builder.mul(p, u), builder.mul(q, v)))
    bent, against = (at.value(model.curvature(leaf)) for leaf in (f, g))
    if along is None or bent is None or against is None or not (known.vanishes(across) and along < 0):
        return None
    parting = bent + against  # phi'' - psi'': the level line of f bends by -phi'', that of g by psi''
    if not (parting > 0 or parting < 0):
        return None
    place = (float(at.sides[0].mid()), float(at.sides[1].mid()))
    radius = 1e-15 * sum(map(abs, place))
    if (parting > 0) == (locus.kind == "disjunction"):
        return Joint(place, radius, "node", "broken", branches=4, proved=True, reason="two curves touch from outside")
    reason = "two curves touch from outside, and between them is nothing"
    return Joint(place, radius, "isolated point", "broken", branches=0, proved=True, reason=reason)
