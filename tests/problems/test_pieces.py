"""A shape of several pieces: each of them needs something that holds the level of the solution."""

import pytest

import rsym

DISCS = rsym.disc(1).named("a") | rsym.disc(1, (3, 0)).named("b")
BALLS = rsym.sphere(1).named("a") | rsym.sphere(1, (3, 0, 0)).named("b")


@pytest.mark.parametrize(("shape", "cells"), [(DISCS, 20), (BALLS, 10)])
def test_a_piece_that_nothing_holds_is_named(shape, cells):
    with pytest.raises(rsym.RsymError, match=r"on the piece of the shape about \(2\.\d+, ") as raised:
        rsym.solve(shape, "-laplacian(u) = 1", {"a": 0}, cells=cells)
    assert raised.value.code == "singular"


def test_pieces_are_held_by_values_fluxes_and_terms():
    def middle(equation, conditions):
        return rsym.solve(DISCS, equation, conditions, cells=20)(3, 0)

    assert middle("-laplacian(u) = 1", {"a": 0, "b": rsym.robin(1)}) == pytest.approx(0.75, abs=1e-5)
    assert middle("-laplacian(u) = 1", 0) == pytest.approx(0.25, abs=1e-5)
    assert middle("-laplacian(u) + u = 1", {"a": 0}) == pytest.approx(1, abs=1e-5)
    with pytest.raises(rsym.RsymError, match="with it every u"):
        rsym.solve(rsym.disc(1), "-laplacian(u) = 1", {}, cells=8)
