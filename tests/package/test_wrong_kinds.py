"""Every public function refuses things of a wrong kind by an RsymError, never by an accident further in."""

import contextlib
import inspect

import numpy as np
import pytest

import rsym
from rsym import surfaces

MESH = rsym.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))
PATCH = surfaces.sphere_octant()
WRONG = {
    "None": None,
    "text": "text",
    "1j": 1j,
    "object": object(),
    "list": [],
    "mapping": {},
    "mesh": MESH,
    "patch": PATCH,
    "nan": float("nan"),
    "function": lambda t: t,
}
ABSTRACT = {"Patch", "RsymError", "RsymWarning"}  # a patch is one of its kinds; exceptions take any text


def public():
    for room in (rsym, surfaces):
        for name in room.__all__:
            thing = getattr(room, name)
            if callable(thing) and name not in ABSTRACT:
                yield f"{room.__name__}.{name}", thing


PUBLIC = dict(public())


def needed(function):
    """How many arguments must be given."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except ValueError:
        return 1
    places = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return min(len(parameters), 1) and max(
        1, sum(one.kind in places and one.default is one.empty for one in parameters)
    )


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_things_are_refused(wrong, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # "text" may be a file
    for function in PUBLIC.values():
        with contextlib.suppress(rsym.RsymError):  # some of them are what this or that function takes
            function(*[WRONG[wrong]] * needed(function))


SHAPES = "mesh gradient normalise compile extent plot_field level_lines verify_smoothness lint row cyclic shell".split()


@pytest.mark.parametrize("wrong", ["car", MESH, PATCH, None], ids=["name", "mesh", "patch", "None"])
def test_no_shape_is_called_by_what_it_is(wrong):
    for function in (getattr(rsym, name) for name in SHAPES):
        with pytest.raises(rsym.RsymError, match=rf"expected a Shape, got {type(wrong).__name__}"):
            function(wrong, *[2] * (needed(function) - 1))


def test_a_shipped_model_is_loaded_by_its_name(tmp_path, monkeypatch):
    assert rsym.load("car") == rsym.paper.car()
    assert rsym.load("skeleton", shape="omega_literal") == rsym.paper.skeleton_body("literal")
    for name in rsym.paper.MODELS:
        assert rsym.load(name).expression is not None
    monkeypatch.chdir(tmp_path)
    (tmp_path / "car").write_text("omega = x")
    assert rsym.load("car").expression == rsym.x
    for name in ("no_such_model", "../paper/car", "car.rf", ""):
        with pytest.raises(rsym.RsymError):
            rsym.load(name)


def test_a_name_is_no_shape_and_the_remedy_says_what_is():
    with pytest.raises(rsym.RsymError, match=r"rsym\.load"):
        rsym.mesh("car")


def test_a_patch_is_no_mesh(tmp_path):
    with pytest.raises(rsym.RsymError, match=r"expected a Mesh, got RevolutionPatch.*patch\.mesh"):
        rsym.write(PATCH, tmp_path / "x.stl")


@pytest.mark.parametrize("wrong", [1j, None, "1", [1.0, None], np.array([1j]), object()])
def test_a_kernel_takes_real_numbers(wrong):
    kernel = rsym.compile(rsym.disc(1), backend="numpy")
    with pytest.raises(rsym.RsymError, match="real arrays"):
        kernel(wrong, 0.0)


def test_a_kernel_takes_exact_numbers_and_what_broadcasts():
    import sympy as sp

    kernel = rsym.compile(rsym.Shape(rsym.x + rsym.y, (rsym.x, rsym.y)), backend="numpy")
    assert kernel(sp.Rational(1, 2), [1, 2])["value"].tolist() == [1.5, 2.5]
    assert kernel(np.array([True]), 1)["value"].tolist() == [2.0]
