"""Fields as functions of JAX and of PyTorch: values and derivatives are those of rsym, letters and corners included.

PyTorch's half runs where it is installed: its wheels are large.
"""

import os
import sys

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import RsymError, x, y

# PyTorch's own, of what it loads for derivatives forwards.
pytestmark = [pytest.mark.filterwarnings("ignore:.torch.jit:DeprecationWarning"), pytest.mark.slow]

a, p = sp.symbols("a p", real=True)
CORNER = rsym.Shape(rsym.conjunction(x + a * y, y - x**2), (x, y), letters={a: 1})
CREASE = rsym.Shape(sp.Min(x, a * y) + x**2, (x, y), letters={a: 1})
# Each branch has a derivative at its border, x = 0: that they differ must be seen.
BRANCHES = rsym.Shape(sp.Piecewise((x, x > 0), (3 * a * x, True)) + y**2, (x, y), letters={a: 1})
FIELDS = ("value", "gradient", "hessian", "singular", "normalised_gradient")
POINTS = np.array([[0.0, 1.0, 0.3, -1.0], [0.0, 1.0, 0.9, 1.0]])  # corners at both ends


class Jax:
    """What the tests ask of a package."""

    def __init__(self):
        self.jax = pytest.importorskip("jax") if not os.environ.get("CI") else __import__("jax")
        self.jax.config.update("jax_enable_x64", True)
        self.function, self.array = rsym.to_jax, lambda values, kind="float64": self.jax.numpy.asarray(values, kind)

    def gradient(self, function, values):
        """The derivatives of a number by an array."""
        return np.asarray(self.jax.jit(self.jax.grad(function))(values))

    def hessian(self, function, values):
        return np.asarray(self.jax.jit(self.jax.hessian(function))(values))

    def slope(self, function, values, way):
        """The derivative along a way, forwards."""
        return np.asarray(self.jax.jvp(function, (values,), (way,))[1])

    def mapped(self, function, values):
        """Over the last axis."""
        return np.asarray(self.jax.vmap(function, -1)(values))


class Torch:
    def __init__(self):
        self.torch = pytest.importorskip("torch")
        self.function, self.stack = rsym.to_torch, self.torch.stack

    def array(self, values, kind="float64"):
        return self.torch.as_tensor(np.asarray(values), dtype=getattr(self.torch, kind))

    def gradient(self, function, values):
        given = values.clone().requires_grad_(True)
        function(given).backward()
        return given.grad.numpy()

    def hessian(self, function, values):
        return self.torch.func.hessian(function)(values).numpy()

    def slope(self, function, values, way):
        return self.torch.func.jvp(function, (values,), (way,))[1].detach().numpy()

    def mapped(self, function, values):
        return self.torch.func.vmap(function, -1)(values).detach().numpy()


@pytest.fixture(params=[Jax, Torch], scope="module")
def package(request):
    return request.param()


def kernel(shape, fields=FIELDS, at_corners="nan"):
    return rsym.compile(shape, fields, at_corners=at_corners, backend="numpy", threads=1)


@pytest.mark.parametrize("at_corners", ["nan", "one-sided", "zero"])
def test_fields_are_those_of_the_kernel(package, at_corners):
    function = package.function(CORNER, FIELDS, at_corners=at_corners)
    found = function(*package.array(POINTS))
    expected = kernel(CORNER, at_corners="one-sided" if at_corners == "one-sided" else "nan")(*POINTS)
    for name in FIELDS:
        wanted = expected[name] if at_corners == "nan" else np.nan_to_num(expected[name], nan=0.0)
        # PyTorch's square root may be a last digit away.
        np.testing.assert_allclose(found[name], wanted, rtol=1e-15 if name != "singular" else 0, err_msg=name)
        assert np.asarray(found[name]).dtype == expected[name].dtype


@pytest.mark.parametrize("at_corners", ["nan", "one-sided", "zero"])
@pytest.mark.parametrize("shape", [CORNER, CREASE, BRANCHES], ids=["corner", "crease", "branches"])
def test_derivatives_are_the_fields(package, shape, at_corners):
    """Of the value the gradient and the Hessian; at corners what was asked for, which never spoils a sum."""
    function = package.function(shape, at_corners=at_corners)
    expected = kernel(shape, at_corners="one-sided" if at_corners == "one-sided" else "nan")(*POINTS)
    assert np.isnan(kernel(shape)(*POINTS)["gradient"]).any()

    def total(points):
        return function(*points)["value"].sum()

    slopes = package.gradient(total, package.array(POINTS)).T
    wanted = expected["gradient"] if at_corners == "nan" else np.nan_to_num(expected["gradient"], nan=0.0)
    np.testing.assert_allclose(slopes, wanted, rtol=1e-14)
    bent = package.hessian(total, package.array(POINTS))
    wanted = expected["hessian"] if at_corners == "nan" else np.nan_to_num(expected["hessian"], nan=0.0)
    # A kernel has no Hessian where any first derivative jumps, here a second one is asked for by itself.
    for k in range(POINTS.shape[1]) if shape is not BRANCHES else np.flatnonzero(POINTS[0]):
        np.testing.assert_allclose(bent[:, k, :, k], wanted[k], rtol=1e-13, atol=1e-14)


def test_what_has_no_corner_is_derived_to_the_third_order(package):
    """Derivatives by SymPy."""
    formula = sp.exp(x * y) * sp.sin(a * x) / (2 + y**2)
    function = package.function(rsym.Shape(formula, (x, y), letters={a: 1}), "hessian")
    place = package.array([0.3, -0.7])
    found = package.slope(lambda where: function(*where)["hessian"], place, package.array([1.0, 0.0]))
    values = {x: 0.3, y: -0.7, a: 1}
    wanted = [[float(formula.diff(x, first, second).subs(values)) for second in (x, y)] for first in (x, y)]
    np.testing.assert_allclose(found, wanted, rtol=1e-13)


@pytest.mark.parametrize(
    ("shape", "name", "value"),
    [
        (CORNER, "a", 1.3),
        (rsym.Shape(rsym.conjunction(x, y, system=rsym.RAlpha(p)), (x, y), letters={p: 0.3}), "p", 0.3),
        (rsym.Shape(rsym.conjunction(x, y, system=rsym.Rp(p)), (x, y), letters={p: 3}), "p", 3.5),
        (rsym.Shape(rsym.trimming(y, p - x**2), (x, y), letters={p: 1}), "p", 1.5),
    ],
    ids=["coefficient", "alpha", "p", "end"],
)
def test_letters_are_inputs_like_others(package, shape, name, value):
    """Parameters of R-systems too; differences of the kernel."""
    function, compiled, step = package.function(shape), kernel(shape, "value"), 1e-6
    place = np.array([[0.4, 1.1], [0.7, 0.2]])
    found = package.gradient(
        lambda letter: function(*package.array(place), {name: letter})["value"].sum(), package.array(value)
    )
    ends = [compiled(*place, letters={name: value + sign * step})["value"].sum() for sign in (1, -1)]
    assert float(found) == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-8, abs=1e-9)


def test_batches_maps_and_precisions(package):
    function = package.function(CORNER, ("value", "gradient"))
    column = function(package.array(POINTS[0])[:, None], package.array(POINTS[1]))
    assert tuple(column["gradient"].shape) == (4, 4, 2)
    # As many letters as points, and a batch of letters against all points.
    each = function(*package.array(POINTS), {"a": package.array([1.0, 2.0, 3.0, 4.0])})["value"]
    every = function(*package.array(POINTS), letters={"a": package.array([[1.0], [2.0], [3.0], [4.0]])})["value"]
    assert np.array_equal(np.asarray(each), np.diagonal(np.asarray(every)))
    assert np.array_equal(np.asarray(column["value"]).diagonal(), np.asarray(every)[0])
    slopes = package.mapped(lambda where: function(*where)["gradient"], package.array(POINTS))
    assert np.array_equal(slopes, np.asarray(column["gradient"])[np.arange(4), np.arange(4)])
    single = function(*package.array(POINTS, "float32"), {"a": 1.0})
    assert np.asarray(single["value"]).dtype == np.float32
    np.testing.assert_allclose(single["value"], np.asarray(every)[0], rtol=3e-7, atol=1e-7)
    assert np.asarray(function(1.0, 2.0)["value"]).shape == ()


def test_omega_is_nan_where_it_is_undefined_and_its_derivatives_are_not(package):
    function = package.function(rsym.Shape(sp.sqrt(x) + y, (x, y)))
    points = package.array([[-1.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    assert np.array_equal(np.isnan(np.asarray(function(*points)["value"])), [True, False, False])
    slopes = package.gradient(lambda where: function(*where)["value"][1:].sum(), points)
    assert slopes.tolist() == [[0.0, 0.0, 0.5], [0.0, 1.0, 1.0]]


def test_what_is_wrong_is_refused(package):
    function = package.function(CORNER)
    for call, code in [
        (lambda: function(1.0), "arity"),
        (lambda: function(1.0, 2.0, {"b": 1.0}), "unknown-letter"),
        (lambda: function(1.0, 2.0, letters=[1.0]), "letters"),
        (lambda: package.function(CORNER, at_corners="kink"), "corners"),
        (lambda: package.function(CORNER, "colour"), "unknown-field"),
    ]:
        with pytest.raises(RsymError) as caught:
            call()
        assert caught.value.code == code


@pytest.mark.parametrize(("name", "function"), [("jax", rsym.to_jax), ("torch", rsym.to_torch)])
def test_without_the_package_it_is_asked_for(name, function, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(RsymError, match=f"pip install {name}") as caught:
        function(CORNER)
    assert caught.value.code == "missing-package"


def test_the_car(package):
    """Values, gradients and the derivatives by 45 letters, where they exist: finite, and those of the kernel."""
    car = rsym.paper.car()
    points = np.random.default_rng(6).uniform(-5, 5, (3, 500))
    points[:, :100] = points[:, :100].round()
    compiled = kernel(car, ("value", "gradient"))
    expected = compiled(*points)
    given = {name: float(letter.default) for name, letter in car.letters.items()}
    both = package.function(car, ("value", "gradient"), at_corners="nan")(*package.array(points))
    assert np.array_equal(np.isnan(np.asarray(both["gradient"])), np.isnan(expected["gradient"]))
    np.testing.assert_allclose(both["value"], expected["value"], rtol=6e-15, atol=6e-15)
    np.testing.assert_allclose(both["gradient"], expected["gradient"], rtol=6e-15, atol=6e-15)
    names = list(given)
    values = package.array([given[name] for name in names])
    clear = points[:, 100:]
    kept = package.function(car, at_corners="nan")

    def total(values):
        return kept(*package.array(clear), dict(zip(names, values, strict=True)))["value"].sum()

    found, step = package.gradient(total, values), 1e-6
    assert np.isfinite(found).all()
    for name, slope in zip(names, found, strict=True):
        ends = [compiled(*clear, letters={name: given[name] + sign * step})["value"].sum() for sign in (1, -1)]
        assert slope == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-5, abs=1e-5), name
    # With corners among the points nothing is spoilt.
    zeros = package.function(car)
    rates = package.gradient(
        lambda values: zeros(*package.array(points), dict(zip(names, values, strict=True)))["value"].sum(), values
    )
    assert np.isfinite(rates).all()
