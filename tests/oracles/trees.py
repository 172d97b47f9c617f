"""Random R-trees: an expression, and the Boolean truth it must have."""

import sympy as sp
from hypothesis import strategies as st

from rsym.model.systems import R0

x, y, z = sp.symbols("x y z", real=True)
LEAVES = (
    x - sp.Rational(3, 10),
    y + sp.Rational(1, 5),
    1 - x**2 - y**2,
    (1 - x) * (x + sp.Rational(1, 2)),
    z - x * y / 3,
    sp.Rational(3, 2) - x**2 / 4 - (y - z) ** 2,
    x + y + z,
    sp.Rational(1, 2) - z**2,
)


def trees(systems=(R0,), max_leaves=9, more=()):
    """Strategies for expressions built from LEAVES and more by conjunction, disjunction and negation."""

    def grow(children):
        pair = st.tuples(st.sampled_from(systems), st.booleans(), st.lists(children, min_size=2, max_size=3))
        joined = pair.map(lambda p: p[0].conjunction(*p[2]) if p[1] else p[0].disjunction(*p[2]))
        return joined | children.map(lambda f: -f)

    return st.recursive(st.sampled_from((*LEAVES, *more)), grow, max_leaves=max_leaves)


def formulas(count, depth=4):
    """Strategies for (function of R-operations, function of truth values) over `count` inputs."""
    leaf = st.integers(0, count - 1).map(lambda k: lambda f, ops: f[k])

    def grow(children):
        both = st.tuples(st.booleans(), children, children).map(
            lambda p: lambda f, ops: (ops.conjunction if p[0] else ops.disjunction)(p[1](f, ops), p[2](f, ops))
        )
        return both | children.map(lambda c: lambda f, ops: -c(f, ops))

    return st.recursive(leaf, grow, max_leaves=2**depth)
