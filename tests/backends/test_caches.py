"""Machine code in the user's cache folder: kept, read, made again where it is damaged, forgotten when it is old."""

import ctypes
import os

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y
from rsym.backends import caches, llvm_code
from rsym.backends.caches import cache_folder, keep_entry, read_entry
from rsym.program.expansion import expand
from rsym.program.fields import program_of

TEXT = "define double @twice(double %x) {\n  %y = fadd double %x, %x\n  ret double %y\n}\n"
LONG = TEXT + "; a remark\n" * 5000


def twice(text, effort=2):
    engine = llvm_code.machine_code(text, effort)
    return ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(engine.get_function_address("twice"))(3.5)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path))
    monkeypatch.setattr(caches.Path, "home", lambda: tmp_path)
    return cache_folder(llvm_code.KIND)


@pytest.fixture
def compiled(monkeypatch):
    """The texts that were compiled."""
    texts, parse = [], llvm_code.llvm.parse_assembly

    def noted(text):
        if text:
            texts.append(text)
        return parse(text)

    monkeypatch.setattr(llvm_code.llvm, "parse_assembly", noted)
    return texts


def test_a_long_text_is_compiled_once_and_kept(folder, compiled):
    assert [twice(LONG), twice(LONG)] == [7.0, 7.0]
    assert len(compiled) == 1
    assert twice(LONG, 0) == 7.0  # compiled in another way, another entry
    assert len(compiled) == len(list(folder.iterdir())) == 2


def test_a_kept_module_is_found_by_its_name_alone(compiled):
    assert llvm_code.kept_machine_code(llvm_code.entry_name(TEXT)) is None
    llvm_code.machine_code(TEXT, kept=True)
    engine = llvm_code.kept_machine_code(llvm_code.entry_name(TEXT))
    twice = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(engine.get_function_address("twice"))
    assert twice(2.5) == 5.0
    assert len(compiled) == 1


def test_the_digest_of_rooms_changes_with_any_of_their_modules(tmp_path, monkeypatch):
    monkeypatch.setattr(caches, "__file__", str(tmp_path / "backends" / "caches.py"))
    (tmp_path / "one").mkdir()
    digests = [caches.digest_of_rooms.__wrapped__("one")]
    for name, text in (("a", "1"), ("b", "1"), ("a", "2"), ("a", "1"), ("__init__", "")):
        (tmp_path / "one" / f"{name}.py").write_text(text)
        digests.append(caches.digest_of_rooms.__wrapped__("one"))
    assert digests[0] == ""  # nothing can be told
    assert len(set(digests)) == 5
    assert digests[2] == digests[4]


def test_a_short_text_is_not_worth_a_file(folder, compiled):
    assert [twice(TEXT), twice(TEXT)] == [7.0, 7.0]
    assert len(compiled) == 2
    assert not folder.exists()


@pytest.mark.parametrize("damage", [b"", b"short", None])
def test_a_damaged_entry_is_compiled_again(folder, compiled, damage):
    twice(LONG)
    (entry,) = folder.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(whole[: len(whole) // 2] if damage is None else damage)
    assert [twice(LONG), twice(LONG)] == [7.0, 7.0]
    assert len(compiled) == 2


def test_without_a_folder_all_is_compiled(folder, compiled):
    folder.parent.mkdir()
    folder.write_text("in the way")
    assert [twice(LONG), twice(LONG)] == [7.0, 7.0]
    assert len(compiled) == 2


def test_what_was_not_used_for_longest_is_forgotten(monkeypatch):
    monkeypatch.setattr(caches, "MOST_ENTRIES", 4)
    for k in range(4):
        keep_entry("things", f"{k}", bytes([k]))
        os.utime(cache_folder("things") / f"{k}", (k, k))
    assert read_entry("things", "0") == b"\0"  # used, so it stays
    keep_entry("things", "4", b"\4")
    assert {one.name for one in cache_folder("things").iterdir()} == {"0", "3", "4"}


def test_an_entry_under_the_name_of_another_is_none():
    for k in range(2):
        keep_entry("things", f"{k}", bytes([k]))
    (cache_folder("things") / "0").replace(cache_folder("things") / "1")
    assert read_entry("things", "1") is None


def test_what_is_too_long_to_tune_has_the_same_bits(monkeypatch):
    node = rsym.conjunction(*(sp.sin(k * x) + y - k for k in range(1, 6)))
    program = expand(program_of(rsym.Shape(node, (x, y)), ("value", "hessian")))
    points = np.random.default_rng(2).uniform(-2, 2, (2, 40))

    def bits():
        outputs = [np.empty(40) for _ in program.outputs]
        llvm_code.LlvmFunction(program).run(list(points), [], outputs)
        return [output.tobytes() for output in outputs]

    tuned = bits()
    monkeypatch.setattr(llvm_code, "MOST_TUNED", 0)
    assert bits() == tuned
