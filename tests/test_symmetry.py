"""Motifs repeated by waves, fans and screws, against copies that are moved one by one."""

from rsym import conjunction, x, y
from rsym.model.traversal import substitute


def test_what_collapses_to_a_symbol_is_not_replaced_twice():
    assert substitute(conjunction(1 - y, 1 + y), {y: -y}) == conjunction(1 + y, 1 - y)
    assert substitute(x - y, {x: y, y: x}) == y - x
