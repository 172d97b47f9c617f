"""Rays against dense signs of omega in float64: no code is shared with what is checked."""

import numpy as np

import rsym
from rsym.paper.models import model_path
from rsym.sampling.pencils import Pencil
from rsym.sampling.rays import Caster


def space(name):
    shape = rsym.load(model_path(name))
    return shape if shape.dimension == 3 else rsym.revolve(shape)


def letters_of(shape, generator):
    """Random ones within their ranges, half of the way from the default."""
    found = {}
    for name, letter in shape.letters.items():
        low = letter.default if letter.minimum is None else letter.minimum
        high = letter.default if letter.maximum is None else letter.maximum
        found[name] = float(letter.default) + 0.5 * generator.random() * (
            float(generator.choice([low, high])) - float(letter.default)
        )
    return found


def camera(bounds, width, height, azimuth, elevation, perspective):
    """A pencil that looks at the middle of the bounds."""
    low, high = np.array(bounds, float).T
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    se, ce, sa, ca = np.sin(elevation), np.cos(elevation), np.sin(azimuth), np.cos(azimuth)
    right, up, back = np.array([-sa, ca, 0]), np.array([-se * ca, -se * sa, ce]), np.array([ce * ca, ce * sa, se])
    size = 1.6 * radius / height
    corner = middle - right * size * width / 2 + up * size * height / 2
    if perspective:
        return Pencil((width, height), corner, right * size, -up * size, eye=middle + back * 4 * radius)
    return Pencil((width, height), corner + back * 2 * radius, right * size, -up * size, direction=-back)


def signs_along(shape, letters, origins, directions, bounds, places):
    """Depths of the first place inside, by dense signs and bisection; the longest chord inside each ray."""
    kernel = rsym.compile(shape, ("value",))
    box = np.array(bounds, float)
    with np.errstate(all="ignore"):
        near, far = (box[:, 0] - origins) / directions, (box[:, 1] - origins) / directions
    first, last = np.fmin(near, far).max(axis=1), np.fmax(near, far).min(axis=1)
    crossing = last > first
    share = np.linspace(0, 1, places)

    def inside(t):
        points = origins[:, None] + directions[:, None] * t[..., None]
        return kernel(*np.moveaxis(points, -1, 0), letters=letters)["value"] > 0

    t = first[:, None] + (last - first)[:, None] * share
    t[:, 0] += 1e-9 * (last - first)
    met = inside(t) & crossing[:, None]
    hit = met.any(axis=1)
    at = met.argmax(axis=1)
    rows = np.arange(len(t))
    low, high = t[rows, np.maximum(at - 1, 0)], t[rows, at]
    for _ in range(50):
        middle = (low + high) / 2
        deep = inside(middle[:, None])[:, 0]
        low, high = np.where(deep, low, middle), np.where(deep, middle, high)
    return np.where(hit, np.where(at == 0, first, high), np.inf)


def near_silhouette(shape, letters, pencil, rays, bounds, depth, hits_wrong, share):
    """Whether within a share of a pixel there are rays that truly hit, and rays that truly miss."""
    columns, rows = rays
    found = []
    for angle in np.linspace(0, 2 * np.pi, 12, endpoint=False):
        for distance in (0.5 * share, share):
            moved = pencil.rays(columns + distance * np.cos(angle), rows + distance * np.sin(angle))
            found.append(signs_along(shape, letters, *moved, bounds, 1500))
    return np.array(found)


def compare(shape, letters, pencil, count, places, generator):
    """Complaints of a picture against dense signs."""
    caster = Caster(shape, letters)
    hits = caster.look(pencil)
    width, height = pencil.size
    columns, rows = generator.integers(0, width, count), generator.integers(0, height, count)
    met = np.argwhere(hits.met)
    if len(met):
        some = met[generator.integers(0, len(met), count // 2)]
        columns[: len(some)], rows[: len(some)] = some[:, 1], some[:, 0]
    rays = pencil.rays(columns + 0.5, rows + 0.5)
    truth = signs_along(shape, letters, *rays, caster.bounds, places)
    depth = hits.depth[rows, columns]
    pixel = pencil.pixel[0] + pencil.pixel[1] * np.abs(np.where(np.isfinite(depth), depth, 0))
    with np.errstate(all="ignore"):
        off = ~((np.isinf(truth) & np.isinf(depth)) | (np.abs(truth - depth) < 0.02 * pixel + 1e-9))
    doubt = hits.undecided[rows, columns]
    bad = np.flatnonzero(off)
    report = {
        "rays": count,
        "met": float(np.isfinite(depth).mean()),
        "off": len(bad),
        "doubt": int(hits.undecided.sum()),
    }
    report["unexplained"] = []
    if len(bad):
        around = near_silhouette(
            shape, letters, pencil, (columns[bad] + 0.5, rows[bad] + 0.5), caster.bounds, depth, off, 0.2
        )
        for k, ray in enumerate(bad):
            seen = np.append(around[:, k], truth[ray])
            # What is seen here is seen within a fifth of a pixel: a miss, or a depth within the spread of depths there.
            if np.isinf(depth[ray]):
                fine = np.isinf(seen).any()
            else:
                near = seen[np.isfinite(seen)]
                fine = len(near) and near.min() - 0.5 * pixel[ray] <= depth[ray] <= near.max() + 0.5 * pixel[ray]
            # A chord shorter than the steps of the dense signs: a point inside, just behind the depth, is enough.
            if not fine and np.isfinite(depth[ray]) and (depth[ray] < truth[ray]):
                kernel = rsym.compile(shape, ("value",))
                o, d = rays[0][ray], rays[1][ray]
                t = depth[ray] + np.array([1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 1e-2, 0.05]) * pixel[ray]
                fine = (kernel(*(o + t[:, None] * d).T, letters=letters)["value"] >= 0).any()
            if not fine:
                report["unexplained"].append(
                    (int(columns[ray]), int(rows[ray]), float(depth[ray]), float(truth[ray]), bool(doubt[ray]))
                )
    return report
