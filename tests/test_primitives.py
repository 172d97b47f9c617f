"""What all primitives have in common: names, signatures, and what they are without arguments."""

import inspect

import pytest

import rsym
from rsym.language.pieces import PIECES

PRIMITIVES = rsym.primitives.__all__


def test_primitives_are_names_of_the_library_and_of_the_language():
    assert PRIMITIVES == sorted(PRIMITIVES)
    assert {name for name in vars(rsym.primitives) if not name.startswith("_")} == set(PRIMITIVES)
    assert all(getattr(rsym, name) is getattr(rsym.primitives, name) for name in PRIMITIVES)
    assert set(PRIMITIVES) <= PIECES.keys()


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
