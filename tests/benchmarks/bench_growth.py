"""What models of any size take: seconds and bytes against leaves, cells and letters, each in a process of its own.

`python tests/benchmarks/bench_growth.py` measures all and writes what the figure `growth` is drawn from; a quarter of
an hour. Under pytest one model is measured, beside what is stored.
"""

import json
import math
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

# What measures imports nothing large: a process begins with the peak of the memory of the one that started it.
COUNTS = (1, 3, 10, 30, 100, 300, 1000, 3000, 10000)
CUBES = (1, 2, 3, 4, 5, 7, 10)  # cells of gyroid along a side
GLYPHS = (1, 3, 6, 12, 24, 48, 72)
CELLS = (64, 96, 128, 192, 256, 384, 512, 1024, 2048)
LETTERS = (1, 3, 10, 30, 100, 300)
BALLS = 300  # of which some have a letter each
LONGEST, STEEP = 150.0, 10.0  # seconds that building by LLVM may take, and how many times longer for the next size
PATIENCE = 900.0
ROUNDS, ENOUGH = 9, 1.5  # calls after the first, and seconds for them
CACHES = Path(tempfile.gettempdir()) / "rsym-growth"  # loops stay in it
WORDS = "REAL LOGIC "
SIZE, WIDTH, PITCH, LINE = 1.6, 0.11, 1.35, 2.2  # of a glyph: height, half a stroke, to the next one, to the next line
# Strokes: lines from point to point; arcs about a point, with the half-plane that they are in.
STROKES = {
    "R": ((0, 0, 0, 1.6), (0, 1.6, 0.5, 1.6), (0.5, 1.2, 0.4, "x", 1), (0, 0.8, 0.5, 0.8), (0.5, 0.8, 0.9, 0)),
    "E": ((0, 0, 0, 1.6), (0, 1.6, 0.8, 1.6), (0, 0.8, 0.7, 0.8), (0, 0, 0.8, 0)),
    "A": ((0, 0, 0.45, 1.6), (0.45, 1.6, 0.9, 0), (0.2, 0.6, 0.7, 0.6)),
    "L": ((0, 0, 0, 1.6), (0, 0, 0.8, 0)),
    "O": ((0.45, 1.15, 0.45, "y", 1), (0.45, 0.45, 0.45, "y", -1), (0, 0.45, 0, 1.15), (0.9, 0.45, 0.9, 1.15)),
    "G": ((0.45, 1.15, 0.45, "y", 1), (0.45, 0.45, 0.45, "y", -1), (0, 0.45, 0, 1.15), (0.5, 0.7, 0.9, 0.7)),
    "I": ((0.45, 0, 0.45, 1.6),),
    "C": ((0.45, 1.15, 0.45, "y", 1), (0.45, 0.45, 0.45, "y", -1), (0, 0.45, 0, 1.15)),
}


def balls(count, lettered=0):
    """Disjoint balls on a grid, their centres and radii at random; the first ones have letters as radii."""
    import numpy as np
    import sympy as sp

    import rsym
    from rsym import x, y, z

    side = math.ceil(count ** (1 / 3) - 1e-9)
    generator = np.random.default_rng(7)
    grid = np.stack(np.meshgrid(*[(np.arange(side) + 0.5) / side * 2 - 1] * 3, indexing="ij")).reshape(3, -1).T
    centres = np.round(generator.permutation(grid)[:count] + generator.uniform(-0.1, 0.1, (count, 3)) / side, 6)
    radii = np.round(generator.uniform(0.5, 0.8, count) / side, 6).tolist()
    letters = {f"r{k}": rsym.Letter(radius) for k, radius in enumerate(radii[:lettered])}
    chosen = [*(sp.Symbol(name, real=True) for name in letters), *radii[lettered:]]
    parts = [
        rsym.Shape(
            r**2 - (x - a) ** 2 - (y - b) ** 2 - (z - c) ** 2,
            (x, y, z),
            letters={str(r): letters[str(r)]} if str(r) in letters else None,
        )
        for (a, b, c), r in zip(centres.tolist(), chosen, strict=True)
    ]
    return rsym.disjunction(*parts).replace(bounds=((-1.2, 1.2),) * 3)


def gyroids(side):
    """A cube of cells, each with walls of gyroid as thick as it says: a graded lattice."""
    import numpy as np
    import sympy as sp

    import rsym
    from rsym import conjunction, disjunction, x, y, z

    generator = np.random.default_rng(8)
    # One period in the whole, whatever the cells.
    wall = sum(sp.sin(sp.pi * u) * sp.cos(sp.pi * v) for u, v in ((x, y), (y, z), (z, x)))
    half = sp.Rational(1, side)
    cells = []
    for place in np.ndindex(side, side, side):
        middle = [(2 * n + 1) * half - 1 for n in place]
        level = round(float(generator.uniform(0.3, 0.5)), 6)
        slabs = [half - sp.Abs(u - m) for u, m in zip((x, y, z), middle, strict=True)]
        cells.append(conjunction(level**2 - wall**2, *slabs))
    return rsym.Shape(disjunction(*cells), (x, y, z), bounds=((-1.1, 1.1),) * 3)


def text(count):
    """So many glyphs of strokes, as a text of operations that is read, then extruded."""
    import rsym

    lines, width, height = page(count)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "text.vm")
        path.write_text("\n".join(lines))
        plane = rsym.load(path)
    bounds = ((-0.4, width), (-0.4, height))
    return rsym.extrude(plane.replace(bounds=bounds), 0, 0.5)


def page(count):
    """The lines of a model of glyphs, its width and its height; inside is negative."""
    lines = ["_x var-x", "_y var-y"]

    def put(*words):
        lines.append(" ".join(["_" + format(len(lines), "x"), *map(str, words)]))
        return lines[-1].split()[0]

    def number(value):
        return put("const", repr(round(float(value), 6)))

    def shifted(axis, by):
        return put("sub", axis, number(by))

    columns = math.ceil(math.sqrt(1.5 * count))
    rows = math.ceil(count / columns)
    strokes = []
    letters = WORDS.replace(" ", "")
    for k in range(count):
        left, foot = PITCH * (k % columns), LINE * (rows - 1 - k // columns)
        for stroke in STROKES[letters[k % len(letters)]]:
            make = arc if isinstance(stroke[3], str) else line
            strokes.append(make(put, number, shifted, left, foot, *stroke))
    while len(strokes) > 1:  # in pairs: no operation waits for more than it must
        pairs = [put("min", *strokes[k : k + 2]) for k in range(0, len(strokes) - 1, 2)]
        strokes = pairs + strokes[2 * len(pairs) :]
    if lines[-1].split()[0] != strokes[0]:
        put("neg", put("neg", strokes[0]))
    return lines, PITCH * columns + 0.1, LINE * rows - LINE + SIZE + 0.4


def line(put, number, shifted, left, foot, a, b, c, d):
    """A rectangle about the line from (a, b) to (c, d)."""
    length = math.hypot(c - a, d - b)
    u, v = (c - a) / length, (d - b) / length
    x, y = shifted("_x", left + (a + c) / 2), shifted("_y", foot + (b + d) / 2)
    along = put("add", put("mul", x, number(u)), put("mul", y, number(v)))
    across = put("sub", put("mul", x, number(v)), put("mul", y, number(u)))
    long, thin = put("abs", along), put("abs", across)
    return put("max", put("sub", long, number(length / 2 + WIDTH)), put("sub", thin, number(WIDTH)))


def arc(put, number, shifted, left, foot, a, b, radius, axis, side):
    """Half a ring about (a, b)."""
    x, y = shifted("_x", left + a), shifted("_y", foot + b)
    distance = put("sqrt", put("add", put("square", x), put("square", y)))
    ring = put("sub", put("abs", put("sub", distance, number(radius))), number(WIDTH))
    beyond = {"x": x, "y": y}[axis]
    return put("max", ring, put("neg", beyond) if side > 0 else beyond)


def car(cells):
    """The car, the same for all cells."""
    import rsym

    return rsym.paper.car()


MODELS = {"balls": balls, "gyroids": gyroids, "text": text, "cells": car, "letters": lambda n: balls(BALLS, n)}


def resolution(work, size):
    """The cells of each work: strokes of a page are thin."""
    return {"cells": size, "text": 256}.get(work, 128)


def measured(work, size, backend):
    """One row, in this process: what making the shape, building its mesher and a mesh take."""
    import rsym

    warnings.simplefilter("ignore", rsym.RsymWarning)
    rsym.Mesher(balls(8), backend=None if backend == "lattice" else backend)(32)  # loads what is compiled once
    before = peak()
    start = time.process_time()
    shape = MODELS[work](size)
    made = time.process_time()
    if backend == "lattice":
        return row(work, size, backend, before, made=made - start, **on_a_lattice(shape, size))
    mesher = rsym.Mesher(shape, backend=backend)
    built = time.process_time()
    after = peak()
    seconds, mesh = [], None
    letters = {}
    cells = resolution(work, size)
    mesher(64 if size >= 1024 and work == "cells" else cells)
    while not seconds or (len(seconds) < ROUNDS and sum(seconds) < ENOUGH):
        del mesh
        if work == "letters":
            letters = {"r0": float(shape.letters["r0"].default) * (1 - 0.01 * (len(seconds) + 1))}
        begun = time.process_time()
        mesh = mesher(cells, letters=letters)
        seconds.append(time.process_time() - begun)
    return row(
        work,
        size,
        backend,
        before,
        leaves=len(mesher.leaves) - 6,
        made=made - start,
        build=built - made,
        build_bytes=after - before,
        mesh=min(seconds),
        triangles=len(mesh.faces),
        **({"operations": len(page(size)[0])} if work == "text" else {}),
    )


def on_a_lattice(shape, cells):
    """The value at every point, and marching cubes."""
    from skimage.measure import marching_cubes

    import rsym
    from rsym.sampling.lattice import lattice_over

    lattice = lattice_over(shape.bounds, cells)
    kernel = rsym.compile(shape, threads=1)
    kernel(0.0, 0.0, 0.0)
    start = time.process_time()
    faces = marching_cubes(kernel(*lattice.open_axes())["value"], 0.0)[1]
    return {"mesh": time.process_time() - start, "triangles": len(faces)}


def row(work, size, backend, before, **found):
    return {"work": work, "size": size, "backend": backend, **found, "bytes": peak() - before}


def peak():
    """The most memory that this process has had, in bytes."""
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else 1024 * most


def alone(work, size, backend):
    """A row, by a process of its own, which finds no code of models on the machine."""
    command = [sys.executable, __file__, work, str(size), backend]
    for kind in ("forms", "kernels"):
        shutil.rmtree(CACHES / "rsym" / kind, ignore_errors=True)
    own = os.environ | {"XDG_CACHE_HOME": str(CACHES)}
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=PATIENCE, env=own)
    return json.loads(done.stdout)


def plan():
    """What is measured: work, sizes, backend."""
    yield from (("balls", COUNTS, "tape"), ("gyroids", CUBES, "tape"), ("text", GLYPHS, "tape"))
    yield from (("cells", CELLS, "tape"), ("letters", LETTERS, "tape"))
    yield from (("cells", CELLS, "llvm"), ("cells", CELLS[:7], "lattice"), ("letters", (*LETTERS[::2], BALLS), "llvm"))
    yield from (("balls", COUNTS, "llvm"), ("gyroids", CUBES, "llvm"), ("text", GLYPHS, "llvm"))


def test_a_thousand_balls(benchmark, contest):
    """1 000 balls, 128 cells, in a process of its own"""
    stored = json.loads(Path(__file__).parents[2].joinpath("rsym/paper/growth.json").read_text())
    (old,) = [one for one in stored["rows"] if (one["work"], one["size"], one["backend"]) == ("balls", 1000, "tape")]

    def told(found):
        return f"built in {found['build']:.2f} s, meshed in {found['mesh']:.3f} s, {found['bytes'] / 1e6:.0f} MB"

    contest.run(benchmark, {"now": lambda: alone("balls", 1000, "tape"), "stored": lambda: old}, told, rounds=1)


def main(arguments):
    """One row to the standard output; or all of them to the package."""
    if arguments:
        work, size, backend = arguments
        print(json.dumps(measured(work, int(size), backend)))
        return
    import importlib.metadata

    rows = []
    for work, sizes, backend in plan():
        for size in sizes:
            found = alone(work, size, backend)
            rows.append({name: round(value, 6) if isinstance(value, float) else value for name, value in found.items()})
            print(rows[-1], flush=True)
            if backend == "llvm" and work != "letters" and found["build"] * STEEP > LONGEST:
                break
    versions = {name: importlib.metadata.version(name) for name in ("numpy", "numba", "llvmlite", "sympy")}
    about = {
        "python": platform.python_version(),
        **versions,
        "cores": len(os.sched_getaffinity(0)),
    }
    lines = ",\n  ".join(json.dumps(one) for one in rows)
    Path(__file__).parents[2].joinpath("rsym/paper/growth.json").write_text(
        f'{{"about": {json.dumps(about)},\n "rows": [\n  {lines}\n]}}\n'
    )


if __name__ == "__main__":
    main(sys.argv[1:])
