"""Edges of a lattice, joined to lines."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

Node: TypeAlias = tuple[int, int]


def chains(edges: Iterable[tuple[Node, Node]]) -> list[list[Node]]:
    """The lines that edges make, each edge once: open ones first, a closed one ends where it begins.

    Nodes at which a line goes straight on are left out.

    Examples
    --------
    >>> chains([((0, 1), (0, 2)), ((0, 0), (0, 1)), ((0, 2), (1, 2))])
    [[(0, 0), (0, 2), (1, 2)]]
    """
    ends: dict[Node, list[Node]] = {}
    for first, second in sorted(edges):
        ends.setdefault(first, []).append(second)
        ends.setdefault(second, []).append(first)
    starts = [node for node in sorted(ends) if len(ends[node]) % 2] + sorted(ends)
    found = (_walk(ends, start) for start in starts)
    return [_straightened(line) for line in found if len(line) > 1]


def _walk(ends: dict[Node, list[Node]], start: Node) -> list[Node]:
    """A line from a node along edges that are taken away."""
    line = [start]
    while ends[line[-1]]:
        here = line[-1]
        there = min(ends[here], key=lambda node: _bend(line, node))
        ends[here].remove(there)
        ends[there].remove(here)
        line.append(there)
    return line


def _bend(line: list[Node], node: Node) -> tuple[bool, Node]:
    """Where lines cross one turns: two strips that touch in a corner have borders that do."""
    straight = len(line) > 1 and _is_straight(line[-2], line[-1], node)
    return straight, node


def _is_straight(a: Node, b: Node, c: Node) -> bool:
    return (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])


def _straightened(line: list[Node]) -> list[Node]:
    inner = [b for a, b, c in zip(line, line[1:], line[2:], strict=False) if not _is_straight(a, b, c)]
    return [line[0], *inner, line[-1]]
