"""How triangles hang together: half-edge 3*f + k runs from corner k of face f to the next corner.

All loops take faces as (m, 3) int32 and are linear in the number of triangles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def loop(function: Function) -> Function:
    """Compile a loop over arrays, once on each machine."""
    return njit(nogil=True, cache=True, error_model="numpy")(function)  # type: ignore[return-value]


@loop
def following(h: int) -> int:
    """The next half-edge of the same face."""
    return h - 2 if h % 3 == 2 else h + 1


@loop
def pair(faces: Any, count: int) -> tuple[Any, int, int, int]:
    """The mate of each half-edge, -1 where it has not exactly one; edges, boundary edges and repeated ones.

    Half-edges are put into a bucket for the lower of their ends; inside a bucket the other end tells them apart.
    """
    halves = 3 * len(faces)
    flat = faces.ravel()
    start = np.zeros(count + 2, np.int32)
    for h in range(halves):
        start[min(flat[h], flat[following(h)]) + 2] += 1
    for v in range(count):
        start[v + 2] += start[v + 1]
    bucket = np.empty(halves, np.int32)
    for h in range(halves):
        low = min(flat[h], flat[following(h)])
        bucket[start[low + 1]] = h
        start[low + 1] += 1
    mates = np.full(halves, -1, np.int32)
    many, last = np.zeros((2, count), np.int32), np.zeros((2, count), np.int32)
    edges, boundary, repeated = 0, 0, 0
    for v in range(count):
        for i in range(start[v], start[v + 1]):
            h = bucket[i]
            down = 0 if flat[h] == v else 1
            end = flat[following(h)] if down == 0 else flat[h]
            many[down, end] += 1
            last[down, end] = h
        for i in range(start[v], start[v + 1]):
            h = bucket[i]
            end = flat[following(h)] if flat[h] == v else flat[h]
            up, down = many[0, end], many[1, end]
            many[0, end], many[1, end] = 0, 0
            if up + down == 0:
                continue
            edges += 1
            boundary += (up == 0) + (down == 0)
            repeated += (up > 1) + (down > 1)
            if up == 1 and down == 1:
                mates[last[0, end]], mates[last[1, end]] = last[1, end], last[0, end]
    return mates, edges, boundary, repeated


@loop
def pieces(faces: Any, count: int) -> Any:
    """The number of the piece of each vertex, in the order of their first vertices; -1 for vertices of no face."""
    root = np.arange(count).astype(np.int32)
    used = np.zeros(count, np.bool_)
    for f in range(len(faces)):
        used[faces[f, 0]] = used[faces[f, 1]] = used[faces[f, 2]] = True
        for k in range(1, 3):
            a, b = faces[f, 0], faces[f, k]
            while root[a] != a:
                root[a] = root[root[a]]
                a = root[a]
            while root[b] != b:
                root[b] = root[root[b]]
                b = root[b]
            # The lower vertex leads, so a root comes before all that it leads.
            root[max(a, b)] = min(a, b)
    label, found = np.full(count, -1, np.int32), 0
    for v in range(count):
        if used[v] and root[v] == v:
            label[v] = found
            found += 1
        elif used[v]:
            label[v] = label[root[v]]
    return label


@loop
def pinched(faces: Any, mates: Any, count: int) -> int:
    """The number of vertices whose faces are not one fan: where bodies touch in a point."""
    flat = faces.ravel()
    faces_at, first = np.zeros(count, np.int32), np.full(count, -1, np.int32)
    for h in range(len(flat)):
        faces_at[flat[h]] += 1
        if first[flat[h]] < 0 or mates[h] < 0:
            first[flat[h]] = h
    found = 0
    for v in range(count):
        if first[v] < 0:
            continue
        h, turned = first[v], 0
        while True:
            turned += 1
            h = mates[following(following(h))]
            if h < 0 or h == first[v]:
                break
        found += turned < faces_at[v]
    return found


@loop
def loops(faces: Any, mates: Any) -> tuple[Any, Any]:
    """The half-edges without a mate, chained head to tail, and where in that list each closed chain begins.

    At the head of each one the faces are turned through until the next without a mate; that map is one to one.
    """
    free = 0
    for h in range(len(mates)):
        free += mates[h] < 0
    chain, begins = np.empty(free, np.int32), np.empty(free + 1, np.int32)
    done = np.zeros(len(mates), np.bool_)
    n, chains = 0, 0
    for first in range(len(mates)):
        if mates[first] >= 0 or done[first]:
            continue
        begins[chains] = n
        chains += 1
        h = first
        while not done[h]:
            done[h] = True
            chain[n] = h
            n += 1
            h = following(h)
            while mates[h] >= 0:
                h = following(mates[h])
    begins[chains] = n
    return chain, begins[: chains + 1]
