"""The mesher on the car: against a dense grid, over resolutions, with a letter changed, from the start of a process."""

import itertools
import os
import subprocess
import sys

import pytest
from skimage.measure import marching_cubes

import rsym
from rsym.sampling.lattice import lattice_over
from rsym.sampling.manifolds import measure

CAR = rsym.paper.car()
MESHER = rsym.Mesher(CAR)
START = "import rsym, warnings; warnings.simplefilter('ignore'); rsym.mesh(rsym.paper.car(), (128,) * 3)"
PEAK = """
import rsym
made = rsym.Mesher(rsym.paper.car())(({},) * 3)
print([int(line.split()[1]) / 1e6 for line in open("/proc/self/status") if line.startswith("VmHWM")][0])
"""


def cube(cells):
    return MESHER((cells,) * 3)


def told(mesh):
    status = mesh.status
    return f"{status.triangles} triangles, volume {status.volume:.3f}, closed {status.closed}, folded {status.folded}"


def run(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_against_a_dense_grid(benchmark, contest):
    """Car, 256 cells along each axis"""
    lattice = lattice_over(CAR.bounds, (256,) * 3)
    kernel = rsym.compile(CAR, backend="numpy", threads=1)

    def dense():
        values = kernel(*lattice.open_axes())["value"]
        return marching_cubes(values, 0.0, spacing=lattice.spacing, gradient_direction="ascent")[:2]

    contest.points = 258**3
    contenders = {
        "rsym.Mesher": lambda: cube(256),
        "  and all that is known of the mesh": lambda: (made := cube(256), made.status)[0],
        "dense NumPy and marching_cubes": dense,
    }

    def error(made):
        return told(made) if hasattr(made, "status") else f"volume {measure(*made).volume:.3f}, staircases on edges"

    contest.run(benchmark, contenders, error, rounds=3)


def test_over_resolutions(benchmark, contest):
    """Car, cells along each axis"""
    contenders = {f"{cells}": lambda cells=cells: cube(cells) for cells in (256, 128, 512, 1024)}
    contest.run(benchmark, contenders, told, rounds=3)


def test_a_letter_changed(benchmark, contest):
    """Car, one letter changed, 128 cells along each axis"""
    radii = itertools.cycle((3.0, 2.8, 2.9))
    made = {"rsym.Mesher": lambda: MESHER((128,) * 3, letters={"ra": next(radii)})}
    contest.run(benchmark, made, told)


def test_from_the_start_of_a_process(benchmark, contest):
    """From the start of a process to the first mesh"""
    run(START)  # compiles the loops where the cache has none
    contenders = {
        "car, 128 cells along each axis": lambda: run(START),
        "  import sympy, numba": lambda: run("import sympy, numba"),
    }
    contest.run(benchmark, contenders, lambda _: f"{os.cpu_count()} processors", rounds=5)


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of the memory is read where Linux tells it")
@pytest.mark.parametrize("cells", [512, 1024])
def test_memory(benchmark, contest, cells):
    contest.title = f"Car, {cells} cells along each axis, in a process of its own"
    work = {"peak of the memory": lambda: run(PEAK.format(cells))}
    contest.run(benchmark, work, lambda text: f"{float(text):.2f} GB", rounds=1)
