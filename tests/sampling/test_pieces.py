"""A surface in pieces: the bits of the uncut one, whoever computes them; cancel, dying workers, memory."""

import multiprocessing
import os
import re
import signal
import threading
import time
import tracemalloc
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import sympy as sp
from oracles import dying

import rsym
from rsym import RsymError, x, y, z
from rsym.sampling import mesher
from rsym.sampling.memory import Budget, free_memory
from rsym.sampling.mesh import MeshRequest
from rsym.sampling.progress import Crew
from rsym.sampling.sharp import assembly, pieces

CELLS = (52, 44, 37)
PLENTY = Budget()
a = sp.Symbol("a", real=True)
BOUNDS = ((-0.9, 0.8), (-0.7, 0.7), (-0.5, 1.0))
CUBE = rsym.conjunction(a - abs(x + y / 3), a - abs(y - z / 5), a - abs(z - x / 4))
FOAM = sp.sin(23 * x) * sp.sin(19 * y) * sp.sin(29 * z) + sp.cos(31 * x + 7 * y) * sp.sin(37 * z) / 2 - 0.2


def mesher_of(expression):
    return mesher.SharpMesher(rsym.Shape(expression, (x, y, z), letters={a: 0.6}, bounds=BOUNDS))


@pytest.fixture(scope="module")
def cut_cube():
    """Edges, corners, flat caps."""
    return mesher_of(rsym.conjunction(CUBE, 0.3 - x**2 - y**2 + z))


@pytest.fixture(scope="module")
def body():
    """And a crumbled part, full of ambiguous faces and folds."""
    return mesher_of(rsym.disjunction(rsym.conjunction(CUBE, 0.3 - x**2 - y**2 + z), rsym.conjunction(FOAM, -x - y)))


@pytest.fixture(scope="module")
def whole(body):
    return uncut(job_of(body))


@pytest.fixture(scope="module")
def cell(body):
    """A cell in the middle of the kept blocks."""
    corner = job_of(body).blocks(Crew(), PLENTY).corner
    return corner[:, corner.shape[1] // 2, None]


def job_of(body, cells=CELLS, letters=None, inspect=None):
    return replace(body._job(cells, body.shape.bounds, letters), inspect=inspect)


def uncut(job):
    return assembly.whole(job, Crew(), PLENTY)


def run(job, executor, progress=None):
    return pieces.in_pieces(job, executor, Crew(None, progress), PLENTY)


def assert_same(result, expected):
    """Every bit, of surfaces or meshes."""
    names = ("vertices", "faces", "leaf") if isinstance(expected, rsym.Mesh) else ("faces", "leaf", "flaws", "points")
    for name in names:
        one, other = getattr(result, name), getattr(expected, name)
        if name == "points":
            assert result.vertices == expected.vertices
            one, other = one[:, : result.vertices], other[:, : result.vertices]
        assert one.dtype == other.dtype
        assert one.flags.c_contiguous == other.flags.c_contiguous
        assert one.shape == other.shape
        assert one.tobytes() == other.tobytes()


@pytest.mark.slow
def test_the_body_has_what_is_hard(body, whole):
    job = job_of(body)
    made = assembly.assemble(job, job.blocks(Crew(), PLENTY), Crew(), PLENTY)
    assert made.surface.flips > 0
    assert whole.flaws.any()
    first_cap = len(body.form.leaves) - 6
    assert len(set(whole.leaf[whole.leaf >= first_cap])) == 5
    assert len(set(whole.leaf[whole.leaf < first_cap])) > 4


@pytest.mark.slow
@pytest.mark.parametrize("most", [1, 5, 40, 1000])
def test_any_cut_gives_the_same_bits(body, whole, monkeypatch, most):
    monkeypatch.setattr(pieces, "LEAST", most)
    monkeypatch.setattr(pieces, "MOST", most)
    corner = job_of(body).blocks(Crew(), PLENTY).corner
    held = [((corner >= box[0, :, None]) & (corner < box[1, :, None])).all(axis=0) for box in pieces.cut(corner)]
    assert (np.sum(held, axis=0) == 1).all()
    assert np.sum(held, axis=1).max() <= most
    with ThreadPoolExecutor(3) as threads:
        assert_same(run(job_of(body), threads), whole)


def assert_dead(caught, how):
    """The error that names the cells of a piece whose worker died."""
    assert caught.value.code == "worker-died"
    assert re.search(how + r".* cells \[\d+, \d+, \d+\] to .*coordinates", str(caught.value))


@pytest.mark.slow
def test_processes_give_the_same_bits_and_their_death_is_told(body, whole, cell):
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert_same(run(job_of(body), pool), whole)
        with pytest.raises(RsymError) as caught:
            run(job_of(body, inspect=partial(dying.kill_at, cell)), pool)
    assert_dead(caught, "BrokenProcessPool")


@pytest.mark.slow
def test_a_cluster_gives_the_same_bits_whoever_dies(body, whole, cut_cube, cell, tmp_path):
    import dask
    from distributed import Client, LocalCluster

    local = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        LocalCluster(n_workers=2, threads_per_worker=1, **local) as workers,
        Client(workers) as client,
    ):
        executor = client.get_executor()
        assert_same(
            cut_cube(MeshRequest(70, letters={"a": 0.45}, executor=executor)),
            cut_cube(MeshRequest(70, letters={"a": 0.45})),
        )

        mark = tmp_path / "mark"
        surface = run(job_of(body, inspect=partial(dying.kill_once, str(mark))), executor)
        assert mark.exists()
        assert_same(surface, whole)
        # What was noted of the blocks covers all of them once.
        corner = np.concatenate(surface.notes, axis=1)
        assert (corner[:, np.lexsort(corner[::-1])] == job_of(body).blocks(Crew(), PLENTY).corner).all()

        with pytest.raises(RsymError) as caught:
            run(job_of(body, inspect=partial(dying.kill_at, cell)), executor)
    assert_dead(caught, "KilledWorker")


@pytest.mark.parametrize("count", [1, 5])
def test_the_number_of_threads_changes_nothing(body, whole, count):
    with ThreadPoolExecutor(count) as threads:
        assert_same(assembly.whole(job_of(body), Crew(threads), PLENTY), whole)


def lacking(surface, box, halo):
    """How many crossings of a box, of the uncut surface, need a vertex beyond so many blocks around it."""
    blocks = pieces.crossing_places(surface) >> 9, pieces.vertex_places(surface)[surface.quads] >> 9
    crossing, vertices = (np.moveaxis(surface.corner[:, block], 0, -1) for block in blocks)
    own = ((crossing >= box[0]) & (crossing < box[1])).all(axis=-1)
    reach = halo * pieces.BLOCK
    there = ((vertices >= box[0] - reach) & (vertices < box[1] + reach)).all(axis=-1)
    return int((own & ~there.all(axis=1)).sum())


def test_a_halo_is_needed(body, monkeypatch):
    """Red proof, on the uncut surface: a piece without its halo would read what is not there, whatever that is."""
    monkeypatch.setattr(pieces, "LEAST", 40)
    monkeypatch.setattr(pieces, "MOST", 40)
    job = job_of(body)
    blocks = job.blocks(Crew(), PLENTY)
    surface = assembly.assemble(job, blocks, Crew(), PLENTY).surface
    boxes = pieces.cut(blocks.corner)
    assert len(boxes) > 3
    assert not any(lacking(surface, box, assembly.HALO) for box in boxes)
    assert sum(lacking(surface, box, assembly.HALO - 1) > 0 for box in boxes) > 3


def test_one_mesher_in_many_threads(cut_cube):
    sizes = [0.35, 0.6, 0.5, 0.6]
    alone = [cut_cube(MeshRequest(40, letters={"a": size})) for size in sizes]
    with ThreadPoolExecutor(4) as threads:
        together = list(threads.map(lambda size: cut_cube(MeshRequest(40, letters={"a": size})), sizes))
    for one, other in zip(together, alone, strict=True):
        assert_same(one, other)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_forked_process_has_threads_of_its_own(cut_cube):
    cut_cube(MeshRequest(40))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # from Python 3.12 on, where there are threads
        warnings.simplefilter("ignore", RuntimeWarning)  # of JAX, where a test before has loaded it
        child = os.fork()
    if not child:
        try:
            cut_cube(MeshRequest(40))
        except BaseException:
            os._exit(1)
        os._exit(0)
    for _ in range(500):
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            break
        time.sleep(0.02)
    else:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert ended
    assert status == 0


def test_exceptions_arrive_as_they_are(body):
    # Infinity less infinity: no domain of the formula ends there.
    beyond = rsym.Shape(sp.exp(800 * x) - sp.exp(800 * y) + z, (x, y, z), bounds=((-1, 1),) * 3)
    with ThreadPoolExecutor(2) as threads:
        with pytest.raises(RsymError) as caught:
            rsym.Mesher(beyond)(40, executor=threads)
        assert caught.value.code == "undefined"
        with pytest.raises(LookupError, match="nothing to inspect"):
            run(job_of(body, inspect=dying.complain), threads)


class Stop(BaseException):
    """As KeyboardInterrupt is, but none that stops the suite by mistake."""


@pytest.mark.slow
@pytest.mark.parametrize("cut", [False, True])
def test_progress_and_cancel(cut_cube, monkeypatch, cut):
    monkeypatch.setattr(pieces, "LEAST", 4)
    heard, whole = [], cut_cube(MeshRequest(40))
    with ThreadPoolExecutor(1) as threads:
        executor = threads if cut else None
        assert_same(
            cut_cube(MeshRequest(40, executor=executor, progress=lambda done, total: heard.append((done, total)))),
            whole,
        )
        done, total = np.transpose(heard)
        assert (np.diff(done) >= 0).all()
        assert set(total) == {done[-1]}
        assert len(heard) > 10
        for stop in (int(done[0]), 400, int(done[-1])):
            heard.clear()

            def until(done, total, stop=stop):
                heard.append(done)
                return done < stop

            with pytest.raises(RsymError) as caught:
                cut_cube(MeshRequest(40, executor=executor, progress=until))
            assert caught.value.code == "cancelled"
            assert sum(done >= stop for done in heard) == 1

        def interrupt(done, total):
            if done > total / 2:
                raise Stop

        with pytest.raises(Stop):
            cut_cube(MeshRequest(40, executor=executor, progress=interrupt))
        assert threads._work_queue.empty()
        assert mesher._threads()._work_queue.empty()


def test_a_cancel_leaves_no_pieces_waiting(body, monkeypatch):
    monkeypatch.setattr(pieces, "LEAST", 4)
    begun = []

    def slow(kernels, blocks, lattice, pool):
        begun.append(threading.get_ident())
        time.sleep(0.05)

    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(RsymError, match="cancelled"):
            run(job_of(body, inspect=slow), threads, lambda done, total: done < 100)
        count = len(begun)
    assert count == len(begun) < 10


def test_an_interrupted_loop_leaves_nothing_running():
    begun, ended = [], []

    def slow(number):
        begun.append(number)
        time.sleep(0.02)
        ended.append(number)

    def interrupt(done, total):
        raise Stop

    with ThreadPoolExecutor(2) as threads:
        crew = Crew(threads, interrupt)
        crew.stage(1000)
        with pytest.raises(Stop):
            list(crew.map(slow, range(100)))
        assert len(begun) == len(ended) < 20


class Recorded:
    """A budget that remembers the largest claim."""

    largest = 0.0

    def claim(self, need, expected=0.0):
        self.largest = max(self.largest, need)


@pytest.mark.slow
@pytest.mark.parametrize("cells", [(100,) * 3, (160,) * 3])
def test_what_is_claimed_is_what_is_taken(body, cells):
    job, budget = job_of(body, cells), Recorded()
    assembly.whole(job, Crew(), budget)
    tracemalloc.start()
    assembly.whole(job, Crew(), budget)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert 0.4 * budget.largest < peak < budget.largest


def advised(error):
    assert error.code == "memory"
    return int(error.remedy.split()[1])


@pytest.mark.slow
@pytest.mark.parametrize("free", [4e6, 3e7])
def test_what_cannot_fit_is_refused_with_a_resolution_that_fits(body, monkeypatch, free):
    monkeypatch.setattr(mesher, "free_memory", lambda: mesher.RESERVE + free)
    with pytest.raises(RsymError, match="of memory") as caught:
        body(MeshRequest(400))
    fits = advised(caught.value)
    assert fits > 10
    body(MeshRequest(8))  # loads the loops
    tracemalloc.start()
    assert len(assembly.whole(job_of(body, fits), Crew(), Budget(free)).faces)
    assert tracemalloc.get_traced_memory()[1] < free
    tracemalloc.stop()
    with pytest.raises(RsymError):
        body(MeshRequest(4 * fits))


@pytest.mark.slow
def test_the_octree_is_refused_before_it_is_taken(monkeypatch):
    """A surface everywhere: nothing can be discarded."""
    everywhere = mesher.SharpMesher(rsym.Shape(sp.sin(1e7 * x * y) - z / 9, (x, y, z), bounds=((1, 2),) * 3))
    monkeypatch.setattr(mesher, "free_memory", lambda: mesher.RESERVE + 2e7)
    with pytest.raises(RsymError) as caught:
        everywhere(MeshRequest(20_000))
    assert len(assembly.whole(job_of(everywhere, advised(caught.value)), Crew(), Budget(2e7)).faces)


def test_a_resolution_without_end_is_refused(body):
    with pytest.raises(RsymError) as caught:
        body(MeshRequest(10**8))
    assert caught.value.code == "resolution"


def test_free_memory(tmp_path):
    assert free_memory(tmp_path) == np.inf
    files = {
        "proc/meminfo": "MemTotal: 9000 kB\nMemAvailable:   8000 kB\n",
        "proc/self/cgroup": "0::/user/run\n",
        "sys/fs/cgroup/user/run/memory.max": "max\n",
        "sys/fs/cgroup/user/run/memory.current": "1000\n",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert free_memory(tmp_path) == 8000 * 1024
    # The limit of the group around ours counts too; cached files give way.
    for name, text in {"max": "5000", "current": "4000", "stat": "anon 3300\ninactive_file 700\n"}.items():
        (tmp_path / f"sys/fs/cgroup/user/memory.{name}").write_text(text)
    assert free_memory(tmp_path) == 1700
    (tmp_path / "proc/self/cgroup").write_text("5:cpu,memory:/x\n3:memory:/old\n")
    old = tmp_path / "sys/fs/cgroup/memory/old"
    old.mkdir(parents=True)
    (old / "memory.limit_in_bytes").write_text("900\n")
    (old / "memory.usage_in_bytes").write_text("400\n")
    assert free_memory(tmp_path) == 500
