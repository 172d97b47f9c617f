"""Random simple polygons of many kinds, and whether points are inside: by winding numbers, apart from rsym."""

import numpy as np


def inside(corners, points):
    """Whether the boundary winds around each point an odd number of times."""
    corners, (px, py) = np.asarray(corners, float), np.asarray(points, float).T
    odd = np.zeros(len(points), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        crossed = (ay > py) != (by > py)
        with np.errstate(divide="ignore", invalid="ignore"):
            odd ^= crossed & (px < ax + (py - ay) * (bx - ax) / (by - ay))
    return odd


def star(random, count):
    """Corners around a point."""
    angles = 2 * np.pi * (np.arange(count) + 0.8 * random.random(count)) / count
    return (0.2 + random.random(count))[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def untangled(random, count):
    """Random points, crossings of the way through them removed one by one: no structure at all."""
    way = list(random.random((count, 2)))
    crossed = True
    while crossed:
        crossed = False
        for i in range(count - 1):
            for j in range(i + 2, count - (i == 0)):
                if _cross(way[i], way[i + 1], way[j], way[(j + 1) % count]):
                    way[i + 1 : j + 1] = way[i + 1 : j + 1][::-1]
                    crossed = True
    return np.array(way)


def spiral(random, count):
    """A band wound up: the deepest nesting of pockets."""
    half = count // 2
    angles = np.linspace(0, 0.35 * half + random.random(), half)
    radii = 1 + angles / 3
    outer = (radii + 0.7)[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inner = radii[::-1, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)[::-1]
    return np.concatenate([outer, inner])


def comb(random, count):
    """Teeth of equal height and gaps of equal depth, turned: many edges on two lines but for rounding."""
    teeth = count // 4
    widths = np.cumsum(0.2 + random.random(2 * teeth))
    top = [
        (widths[2 * tooth + side], height)
        for tooth in range(teeth)
        for side, height in ((0, 0), (0, 1), (1, 1), (1, 0))
    ]
    corners = np.array([(widths[0], -1), *top[1:-1], (widths[-1], -1)])
    angle = 2 * np.pi * random.random()
    return corners @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


def blocks(random, count):
    """The outline of squares of a grid, joined without holes: edges on few lines, both ways."""
    cells = {(0, 0)}
    while len(cells) < count:
        x, y = list(cells)[random.integers(len(cells))]
        step = ((1, 0), (-1, 0), (0, 1), (0, -1))[random.integers(4)]
        cell = (x + step[0], y + step[1])
        if cell not in cells and _stays_simple(cells, cell):
            cells.add(cell)
    edges = {}
    for x, y in cells:
        for start, end, outside in (
            ((x, y), (x + 1, y), (x, y - 1)),
            ((x + 1, y), (x + 1, y + 1), (x + 1, y)),
            ((x + 1, y + 1), (x, y + 1), (x, y + 1)),
            ((x, y + 1), (x, y), (x - 1, y)),
        ):
            if outside not in cells:
                edges[start] = end
    way = [min(edges)]
    while len(way) < len(edges):
        way.append(edges[way[-1]])
    return np.array(way, float)


def _stays_simple(cells, cell):
    """Whether the neighbours around a new square follow one another: then no hole and no touching corner arises."""
    x, y = cell
    ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
    filled = [(x + a, y + b) in cells for a, b in ring]
    changes = sum(filled[index] != filled[index - 1] for index in range(8))
    sides = [step for step, full in zip(ring, filled, strict=True) if full and 0 in step]
    lone = any(filled[k] and not (filled[k - 1] or filled[(k + 1) % 8]) for k in (1, 3, 5, 7))
    return changes == 2 and bool(sides) and not lone


def _cross(a, b, c, d):
    def side(p, q, r):
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
