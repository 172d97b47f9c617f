"""What all primitives have in common: names, signatures, and what they are without arguments."""

import inspect

import pytest

import rsym
from rsym.language.pieces import PIECES, PieceRow

PRIMITIVES = rsym.primitives.__all__


def test_primitives_are_names_of_the_library_and_of_the_language():
    assert PRIMITIVES == sorted(PRIMITIVES)
    assert {name for name in vars(rsym.primitives) if not name.startswith("_")} == set(PRIMITIVES)
    assert all(getattr(rsym, name) is getattr(rsym.primitives, name) for name in PRIMITIVES)
    assert PRIMITIVES == sorted(name for name, piece in PIECES.items() if piece.is_primitive)


@pytest.mark.parametrize("name", PIECES)
def test_a_piece_is_at_home_where_its_row_says(name):
    piece = PIECES[name]
    assert (piece.function.__module__, piece.function.__name__) in (
        (f"rsym.{piece.home}", name),
        ("rsym.model.motions", name if piece.is_method else ""),
    )
    assert getattr(rsym.Shape if piece.is_method else rsym, name) is piece.function


@pytest.mark.parametrize(("home", "name"), [("model.primitives.plane", "dics"), ("model.primitives.space", "disc")])
def test_a_row_that_names_nothing_is_seen(home, name):
    """Red proof."""
    with pytest.raises((AttributeError, AssertionError)):
        assert PieceRow(name, home, "in the plane").function.__module__ == f"rsym.{home}"


@pytest.mark.parametrize("name", PRIMITIVES)
def test_a_primitive_says_what_it_raises_and_shows_an_example(name):
    documentation = inspect.getdoc(getattr(rsym, name))
    assert "Raises\n------\nRsymError\n" in documentation
    assert ">>>" in documentation


@pytest.mark.parametrize("name", sorted(PIECES))
def test_what_a_model_gives_to_its_pieces_is_given_by_name(name):
    parameters = inspect.signature(PIECES[name].function).parameters
    given = [parameters[one] for one in ("letters", "system", "bounds") if one in parameters]
    assert all(parameter.kind == parameter.KEYWORD_ONLY for parameter in given)


@pytest.mark.parametrize("name", PRIMITIVES)
def test_a_primitive_can_be_made_without_arguments_unless_it_is_made_of_something(name):
    make = getattr(rsym, name)
    needed = [item.name for item in inspect.signature(make).parameters.values() if item.default is item.empty]
    if needed:
        assert set(needed) <= {"expression", "f", "g", "points", "edges"}
    else:
        assert isinstance(make(), rsym.Shape)
