"""Compiled loops in the user's cache folder, and the threads that run them."""

import gc
import itertools
import logging
import os
import stat
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from rsym.backends import caches
from rsym.sampling.sharp import loops
from rsym.sampling.sharp.loops import in_threads, loop, lowest, popcount, step

SCALE = 3


def twice(a):
    return 2 * a


def scaled(values):
    total = 0
    for value in values:
        total += double(value) * SCALE
    return total


double = step(twice)


def run(values=(1, 2, 4)):
    """A new loop, as in a new process: its answer, and how often it was taken from the folder."""
    compiled = loop(scaled)
    answer = compiled(np.array(values))
    return answer, sum(compiled.stats.cache_hits.values())


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    return caches.cache_folder("loops")


@pytest.mark.slow
def test_a_loop_is_compiled_once_and_kept_in_a_private_folder(folder, caplog, monkeypatch):
    loops._announce.cache_clear()
    monkeypatch.setattr(loops, "_COMPILED", itertools.count(1))
    with caplog.at_level(logging.INFO, "rsym"):
        assert run() == (42, 0)
        assert run() == (42, 1)
        assert run((1.0,)) == (6.0, 0)
    warned = [record.message for record in caplog.records if record.levelno == logging.WARNING]
    assert warned == [loops.NOTICE]
    told = [record.message for record in caplog.records if record.levelno == logging.INFO]
    assert told == ["compiling loop 1: scaled", "compiling loop 2: scaled"]
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert len(list(folder.iterdir())) == 2


@pytest.mark.slow
def test_other_types_and_other_parts_are_other_entries(folder, monkeypatch):
    run()
    assert run((1.0, 2.0, 4.0)) == (42.0, 0)
    monkeypatch.setitem(globals(), "SCALE", 5)
    assert run() == (70, 0)
    monkeypatch.setitem(globals(), "double", step(lambda a: 4 * a))
    assert run() == (140, 0)
    assert len(list(folder.iterdir())) == 4


def test_how_a_loop_is_compiled_is_part_of_its_name(folder, monkeypatch):
    run()
    monkeypatch.setitem(loops.HOW, "error_model", "python")
    assert run() == (42, 0)
    assert len(list(folder.iterdir())) == 2


def test_compiling_leaves_the_search_for_garbage_as_it_was(folder):
    assert gc.isenabled()
    run()
    assert gc.isenabled()
    gc.disable()
    try:
        run((1.0, 2.0))
        assert not gc.isenabled()
    finally:
        gc.enable()


@pytest.mark.random
@pytest.mark.parametrize("damage", [b"", b"short", None])
def test_a_damaged_entry_is_compiled_again(folder, damage):
    run()
    (entry,) = folder.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    assert run() == (42, 0)
    assert run() == (42, 1)


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no modes on this system")
@pytest.mark.parametrize("what", ["folder", "entry"])
def test_what_others_can_write_is_not_read(folder, what):
    run()
    (entry,) = folder.iterdir()
    (folder if what == "folder" else entry).chmod(0o777)
    assert run() == (42, 0)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    assert run() == (42, 1)


@pytest.mark.slow
def test_without_a_folder_the_process_compiles(folder):
    folder.parent.mkdir()
    folder.write_text("in the way")
    assert run() == (42, 0)


@pytest.mark.parametrize(
    ("platform", "variable", "expected"),
    [
        ("linux", "XDG_CACHE_HOME", "rsym/loops"),
        ("win32", "LOCALAPPDATA", "rsym/loops"),
    ],
)
def test_the_folder_follows_the_custom_of_the_system(tmp_path, monkeypatch, platform, variable, expected):
    monkeypatch.setattr(caches.sys, "platform", platform)
    monkeypatch.setenv(variable, str(tmp_path))
    assert caches.cache_folder("loops") == tmp_path / expected


def test_what_is_compiled_is_what_stands_there(folder):
    """So for rows of any length: of such loops LLVM makes wrong vectors of 512 bits, on the processors that it does."""

    def turn(signs, wanted, turned):
        for k in range(len(signs)):
            if signs[k] == 0 and not wanted[k]:
                signs[k] = -turned[k]

    chance, compiled = np.random.default_rng(20260101), loops.loop(turn)
    for count in range(1, 101):
        signs, wanted = chance.integers(-1, 2, count).astype(np.int8), chance.integers(0, 2, count).astype(np.bool_)
        turned = chance.choice([-1, 1], count)
        expected, found = signs.copy(), signs.copy()
        turn(expected, wanted, turned)
        compiled(found, wanted, turned)
        assert (found == expected).all()


def test_words(folder):
    @loop
    def both(word):
        return popcount(word), lowest(word)

    for word in (1, 6, 2**63, 2**64 - 1, 0x8080000000000000):
        assert both(np.uint64(word)) == (word.bit_count(), (word & -word).bit_length() - 1)


@pytest.mark.parametrize("count", [0, 1, 63, 64, 1000, 100_000])
def test_pieces_cover_a_range_once_and_do_not_depend_on_the_pool(count):
    with ThreadPoolExecutor(2) as two, ThreadPoolExecutor(5) as five:
        pieces = in_threads(lambda a, b: (a, b), count, 64, two)
        assert in_threads(lambda a, b: (a, b), count, 64, five) == pieces
    ends = [0, *(b for _, b in pieces)]
    assert ends[:-1] == [a for a, _ in pieces]
    assert ends[-1] == count
    assert all(a % 8 == 0 for a, _ in pieces)
