"""What crosses the border of a process or of the library: kernels, contracts, warnings, ends of ranges."""

import copy
import pickle
import warnings
from fractions import Fraction

import numpy as np
import pytest

import rsym
from rsym import x, y
from rsym.errors import warn

BODY = rsym.paper.skeleton_body()


@pytest.mark.parametrize("travel", [copy.deepcopy, copy.copy, lambda one: pickle.loads(pickle.dumps(one))])
@pytest.mark.parametrize("backend", ["numpy", "llvm"])
def test_kernels_travel_as_text_and_letters(travel, backend):
    kernel = rsym.compile(BODY, ("value", "gradient"), backend=backend, threads=1)
    other = travel(kernel)
    assert (other.fields, other.backend, other.threads, other.letters) == (kernel.fields, backend, 1, kernel.letters)
    places = np.linspace(-3, 3, 50), np.linspace(-2, 2, 50)
    for letters in (None, {"p1": 40}):
        first, second = kernel(*places, letters=letters), other(*places, letters=letters)
        assert all(np.array_equal(first[name], second[name], equal_nan=True) for name in first)


def test_contracts_travel():
    contract = BODY.contract()
    other = pickle.loads(pickle.dumps(contract))
    assert other == contract
    assert str(other) == str(contract)
    leaf = contract.leaves[0].expression
    assert other.monotone(leaf) == contract.monotone(leaf)
    assert copy.deepcopy(contract).image({x: (0, 1), y: (0, 1)}) == contract.image({x: (0, 1), y: (0, 1)})


def test_the_end_of_a_range_is_what_a_user_can_type():
    letter = rsym.Letter(7, minimum=Fraction(61, 10), maximum=Fraction("10.1"))
    shape = rsym.Shape(x, (x, y), letters={"a": letter})
    for end in (6.1, 10.1):
        assert shape.with_letters({"a": end}).letters["a"].default == end
        shape.letters.values_with({"a": end})
    for beyond in (np.nextafter(6.1, 0), np.nextafter(10.1, 11)):
        with pytest.raises(rsym.RsymError):
            shape.with_letters({"a": float(beyond)})


def test_a_warning_points_at_who_asked():
    namespace = {"__name__": "rsym.somewhere", "warn": warn}
    exec("def inner():\n    warn('thin')\n\ndef outer():\n    inner()\n", namespace)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        namespace["outer"]()
        rsym.normalise(rsym.rectangle(1, 1), 2)
    assert [one.filename for one in caught] == [__file__, __file__]
    assert all(one.category is rsym.RsymWarning for one in caught)
