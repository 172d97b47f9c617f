"""Work without a search for garbage, and what it leaves behind."""

import gc

import pytest

from rsym.garbage import uncollected


@pytest.fixture
def looking():
    """A process that looks for garbage and has nothing frozen, unlike one that runs tests."""
    was, frozen = gc.isenabled(), gc.get_freeze_count()
    gc.unfreeze()
    gc.enable()
    yield
    if not was:
        gc.disable()
    if frozen:
        gc.freeze()


def is_old(thing):
    return any(one is thing for one in gc.get_objects(generation=2))


def test_what_was_made_counts_as_old(looking):
    with uncollected():
        thing = [[]]
        assert not is_old(thing)
    assert is_old(thing)
    assert gc.get_freeze_count() == 0


def test_cycles_are_found_later_all_the_same(looking):
    class Node:
        pass

    with uncollected():
        node = Node()
        node.self = node
        del node
    assert sum(type(one) is Node for one in gc.get_objects()) == 1
    gc.collect()
    assert not any(type(one) is Node for one in gc.get_objects())


def test_what_is_frozen_stays_so(looking):
    frozen = [[]]
    gc.freeze()
    try:
        with uncollected():
            thing = [[]]
        assert gc.get_freeze_count() > 0
        assert not any(one is frozen for one in gc.get_objects())
        assert any(one is thing for one in gc.get_objects())
    finally:
        gc.unfreeze()


def test_within_another_one_nothing_changes(looking):
    with uncollected():
        with uncollected():
            thing = [[]]
        assert not gc.isenabled()
        assert not is_old(thing)
    assert gc.isenabled()
