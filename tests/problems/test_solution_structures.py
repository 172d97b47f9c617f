"""Structures on shapes meet their conditions at a thousand points of the boundary, whatever stands in them."""

import os
import pickle

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z

RING = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
HALF = rsym.disc(2).named("rim") & rsym.half_plane((1, 0), 0).named("cut")
OVAL = rsym.ellipse(2, 1).named("oval") & rsym.half_plane((1, 2), -1).named("cut")
ELL = rsym.rectangle(2, 1).named("long") | rsym.rectangle(1, 2).named("high")
SQUARE = rsym.rectangle(2, 2).named("sides") & rsym.half_plane((1, 1), 0).named("cut")  # a line through corners
PLATE = rsym.rectangle(4, 3).named("edge") - rsym.disc(1, (0.4, 0.2)).named("hole")
TORUS = rsym.torus(2, 0.5).named("torus") - rsym.sphere(1, (2, 0, 0)).named("dent")


def random_polynomial(rng, coordinates, degree=4):
    """Coefficients from -1 to 1."""
    monomials = sp.itermonomials(coordinates, degree)
    return sp.Add(*(sp.Float(float(rng.uniform(-1, 1))) * one for one in sorted(monomials, key=str)))


def residuals(shape, conditions, functions, letters=None, points=1000):
    """How far u and du/dn are from what the conditions say, part by part, by compiled values and gradients."""
    structure = rsym.solution_structure(shape, conditions)
    u = structure.with_functions(*functions[: len(structure.unknowns)])
    kernel = rsym.compile(u, ("value", "gradient"))
    worst = {}
    for part, condition in conditions.items():
        found = rsym.sample(shape.with_letters(letters or {}), points, over=part, rng=2)
        at = kernel(*found.points.T, letters=letters)
        slope = np.einsum("ij,ij->i", at["gradient"], found.normals)

        def given(value, places=found.points.T):
            return rsym.compile(u.replace(expression=value), backend="numpy")(*places, letters=letters)["value"]

        if hasattr(condition, "coefficient"):
            gaps = [slope + given(condition.coefficient) * at["value"] - given(condition.flux)]
        else:
            gaps = [at["value"] - given(condition.value)]
            gaps += [slope - given(condition.slope)] if hasattr(condition, "slope") else []
        # Relative to what is in the residual: gradients of the random functions may be large.
        size = 1 + np.abs(at["gradient"]).max() + np.abs(at["value"]).max()
        worst[part] = max(np.abs(gap).max() for gap in gaps) / size
    return worst


CONDITIONS = [
    (RING, {"rim": rsym.robin(2, x), "bore": rsym.robin(x + 3, sp.sin(y))}),
    (RING, {"rim": rsym.robin(3, x), "bore": rsym.dirichlet(y)}),
    (RING, {"rim": rsym.neumann(x * y), "bore": rsym.clamped(x, y)}),
    (RING, {"rim": rsym.clamped(1, x), "bore": rsym.clamped(x, y)}),
    (HALF, {"rim": rsym.robin(1, y), "cut": rsym.dirichlet(y**2)}),
    (HALF, {"rim": rsym.dirichlet(x), "cut": rsym.robin(y, 2)}),
    (HALF.with_system(rsym.R1), {"rim": rsym.robin(1, y), "cut": rsym.dirichlet(y**2)}),
    (OVAL, {"oval": rsym.robin(2, x), "cut": rsym.dirichlet(x * y)}),
    (OVAL, {"oval": rsym.dirichlet(1), "cut": rsym.robin(5, y)}),
    (OVAL, {"oval": rsym.clamped(x, y), "cut": rsym.neumann(0)}),
    (ELL, {"long": rsym.robin(1, x), "high": rsym.dirichlet(x - y)}),
    (SQUARE, {"sides": rsym.robin(1, x), "cut": rsym.dirichlet(x * y)}),
    (SQUARE, {"sides": rsym.dirichlet(x * y), "cut": rsym.robin(x, 3)}),
    (PLATE, {"edge": rsym.robin(1, x), "hole": rsym.neumann(y)}),
    (PLATE, {"edge": rsym.supported(x), "hole": rsym.robin(2, y)}),
    (TORUS, {"torus": rsym.robin(2, z), "dent": rsym.dirichlet(x)}),
]


@pytest.mark.parametrize(("shape", "conditions"), CONDITIONS)
def test_conditions_are_met_whatever_the_functions(shape, conditions):
    rng = np.random.default_rng(6)
    functions = [random_polynomial(rng, shape.coordinates) for _ in range(2)]
    found = residuals(shape, conditions, functions)
    assert max(found.values()) < 1e-13, found


def test_other_conditions_are_not_met():
    """Red proof."""
    given = {"rim": rsym.robin(2, x), "bore": rsym.dirichlet(y)}
    u = rsym.solution_structure(RING, given).with_functions(x, y)
    found = rsym.sample(RING, 100, over="rim", rng=1)
    at = rsym.compile(u, ("value", "gradient"))(*found.points.T)
    gap = np.einsum("ij,ij->i", at["gradient"], found.normals) + 2.01 * at["value"] - found.points[:, 0]
    assert 1e-4 < np.abs(gap).max()


def test_letters_live_in_shape_and_conditions():
    r, c = sp.symbols("r c", real=True)
    bore = rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 1}).named("bore")
    shape = (rsym.disc(2).named("rim") - bore).replace(letters={"r": 1, "c": 2})
    given = {"rim": rsym.dirichlet(x), "bore": rsym.robin(c, r)}
    for letters in ({"r": 0.4}, {"r": 1.5, "c": 9}):
        assert max(residuals(shape, given, [sp.exp(x), x * y], letters).values()) < 1e-13


def test_in_float32_they_are_met_to_its_rounding():
    u = rsym.solution_structure(HALF, {"rim": rsym.robin(1, y), "cut": y**2}).with_functions(sp.exp(x), x * y)
    found = rsym.sample(HALF, 500, over="rim", rng=1)
    at = rsym.compile(u, ("value", "gradient"), dtype="float32")(*found.points.T)
    assert np.isfinite(at["gradient"]).all()
    gap = np.einsum("ij,ij->i", at["gradient"], found.normals) + at["value"] - found.points[:, 1]
    assert np.abs(gap).max() < 1e-3


def test_they_travel():
    structure = rsym.solution_structure(HALF, {"rim": rsym.robin(1, y), "cut": y**2})
    assert pickle.loads(pickle.dumps(structure)) == structure


def test_a_hole_at_an_unknown_level():
    structure = rsym.solution_structure(PLATE, {"edge": 0, "hole": rsym.constant()})
    assert structure.constants == ("C_1",)
    u = structure.with_functions(x * y - 2)
    found = rsym.sample(PLATE, 200, over="hole", rng=1)
    for level in (0, 3.5):
        values = rsym.compile(u)(*found.points.T, letters={"C_1": level})["value"]
        assert np.abs(values - level).max() < 1e-14
    edge = rsym.sample(PLATE, 200, over="edge", rng=1)
    assert np.abs(rsym.compile(u)(*edge.points.T, letters={"C_1": 5})["value"]).max() < 1e-14


def test_at_corners_values_are_those_of_the_conditions():
    u = rsym.solution_structure(HALF, {"rim": rsym.robin(1, y), "cut": 4 - y}).with_functions(sp.exp(x), y)
    assert rsym.compile(u)([0.0, 0.0], [2.0, -2.0])["value"].tolist() == [2, 6]
    # Within a part with slopes, which has no normal there, the value is that of what is undetermined.
    u = rsym.solution_structure(SQUARE, {"sides": rsym.robin(1, y), "cut": x * y}).with_functions(3, x)
    assert abs(rsym.compile(u)(1.0, 1.0)["value"] - (1 + 3 * 2**0.5)) < 1e-14
    u = rsym.solution_structure(SQUARE, {"sides": rsym.clamped(x, y)}).with_functions(3)
    assert rsym.compile(u)(1.0, 1.0)["value"] == 1


def test_one_condition_all_over_and_parts_of_which_nothing_is_said():
    structure = rsym.solution_structure(rsym.ellipse(2, 1), rsym.neumann(0))
    assert structure.unknowns == ("Phi_1", "Phi_2")
    part = rsym.solution_structure(HALF, {"cut": 3})
    phi = sp.Function("Phi_1")(x, y)
    assert part.expression == x * phi + 3


def test_conditions_that_contradict_each_other_or_hold_nowhere_are_refused():
    with pytest.raises(rsym.RsymError, match="'rim' and the part 'cut' meet at") as raised:
        rsym.solution_structure(HALF, {"rim": rsym.clamped(x, 2), "cut": rsym.supported(1)})
    assert raised.value.code == "contradiction"
    rsym.solution_structure(HALF, {"rim": rsym.robin(x, 2), "cut": 1})
    with pytest.raises(rsym.RsymError, match="did you mean 'rim'"):
        rsym.solution_structure(HALF, {"ri": 0})
    with pytest.raises(rsym.RsymError, match="is a function, of which there is no formula"):
        rsym.solution_structure(HALF, {"rim": rsym.robin(max)})
    away = rsym.disc(2).named("rim") - rsym.disc(1, (5, 0)).named("bore")
    with pytest.raises(rsym.RsymError, match="'bore' has nothing of the boundary"):
        rsym.solution_structure(away, {"bore": 1})
    with pytest.raises(rsym.RsymError, match="neither coordinate nor letter"):
        rsym.solution_structure(HALF, {"rim": sp.Symbol("c")})
    with pytest.raises(rsym.RsymError, match="is a shape in"):
        rsym.solution_structure(HALF, {"rim": rsym.sphere(1)})


def test_fields_as_values_bring_their_letters():
    c = sp.Symbol("c", real=True)
    field = rsym.Shape(c * y, (x, y), letters={c: 7})
    structure = rsym.solution_structure(RING, {"rim": rsym.robin(field, 1), "bore": field})
    assert structure.letters["c"].default == 7


def network(jnp, weights, u, v):
    return weights[1] @ jnp.tanh(weights[0] @ jnp.array([u, v, 1.0]))


def taught(shape, conditions):
    """JAX, the solution with a network in it as a function of weights and a point, and some weights."""
    jax = pytest.importorskip("jax") if not os.environ.get("CI") else __import__("jax")
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy
    values = rsym.to_jax(rsym.solution_structure(shape, conditions).with_values())

    def solution(weights, u, v):
        phi, (phi_x, phi_y) = jax.value_and_grad(lambda *at: network(jnp, weights, *at), (0, 1))(u, v)
        return values(u, v, {"Phi_1": phi, "Phi_1_x": phi_x, "Phi_1_y": phi_y, "Phi_2": phi})["value"]

    rng = np.random.default_rng(8)
    return jax, solution, (jnp.asarray(rng.normal(size=(6, 3))), jnp.asarray(rng.normal(size=6)))


def test_a_network_in_jax_meets_them():
    given = {"oval": rsym.robin(2, x), "cut": x * y}
    jax, solution, weights = taught(OVAL, given)
    both = jax.jit(jax.vmap(jax.value_and_grad(solution, (1, 2)), (None, 0, 0)))
    oval, cut = (rsym.sample(OVAL, 1000, over=part, rng=1) for part in given)
    level, slopes = both(weights, *jax.numpy.asarray(oval.points.T))
    gap = sum(slope * way for slope, way in zip(slopes, oval.normals.T, strict=True)) + 2 * level - oval.points[:, 0]
    assert np.abs(gap).max() < 1e-12
    level, _ = both(weights, *jax.numpy.asarray(cut.points.T))
    assert np.abs(level - cut.points.prod(axis=1)).max() < 1e-13


@pytest.mark.slow
def test_a_network_in_jax_learns_from_the_residual_of_an_equation():
    """Its derivative by the weights is that of differences."""
    jax, solution, weights = taught(RING, {"rim": rsym.robin(2, x), "bore": x * y})

    def along(function, at):
        return jax.jvp(lambda s: jax.jvp(function, (s,), (1.0,))[1], (at,), (1.0,))[1]

    def loss(weights, points):
        def residual(u, v):
            second = along(lambda s: solution(weights, s, v), u) + along(lambda s: solution(weights, u, s), v)
            return (second + 1) ** 2

        return jax.numpy.mean(jax.vmap(residual)(*points))

    points = jax.numpy.asarray(rsym.sample(RING, 40, rng=1).points.T)
    plain = jax.jit(loss)
    before, slope = plain(weights, points), jax.jit(jax.grad(loss))(weights, points)
    size = sum(float((one**2).sum()) for one in slope) ** 0.5
    moved = tuple(one - 1e-5 / size * way for one, way in zip(weights, slope, strict=True))
    assert (float(plain(moved, points)) - float(before)) / 1e-5 == pytest.approx(-size, rel=1e-3)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.torch.jit:DeprecationWarning")
def test_a_network_in_pytorch_is_what_its_formula_is():
    """Values, first and second derivatives are those of the kernel of the same network; the conditions are met."""
    torch = pytest.importorskip("torch")
    structure = rsym.solution_structure(OVAL, {"oval": rsym.robin(2, x), "cut": x * y})
    values, rng = rsym.to_torch(structure.with_values()), np.random.default_rng(8)
    inner, outer = rng.normal(size=(6, 3)), rng.normal(size=6)
    formula = sum(c * sp.tanh(a * x + b * y + d) for (a, b, d), c in zip(inner, outer, strict=True))
    compiled = rsym.compile(structure.with_functions(formula, formula), ("value", "gradient", "hessian"))

    def slopes(value, places):
        return torch.autograd.grad(value.sum(), places, create_graph=True)[0]

    def learnt(points):
        places = torch.tensor(points, requires_grad=True)
        weights = torch.tensor(outer, requires_grad=True)
        phi = torch.tanh(places @ torch.tensor(inner[:, :2].T) + torch.tensor(inner[:, 2])) @ weights
        phi_x, phi_y = slopes(phi, places).T
        u = values(*places.T, {"Phi_1": phi, "Phi_1_x": phi_x, "Phi_1_y": phi_y, "Phi_2": phi})["value"]
        gradient = slopes(u, places)
        hessian = torch.stack([slopes(gradient[:, k], places) for k in (0, 1)], -1)
        assert torch.isfinite(slopes(hessian**2, weights)).all()  # what learning asks for
        return [one.detach().numpy() for one in (u, gradient, hessian)]

    inside = rsym.sample(OVAL, 1000, rng=1).points
    expected = compiled(*inside.T)
    for found, name in zip(learnt(inside), ("value", "gradient", "hessian"), strict=True):
        np.testing.assert_allclose(found, expected[name], rtol=1e-12, atol=1e-12, err_msg=name)
    oval, cut = (rsym.sample(OVAL, 1000, over=part, rng=1) for part in ("oval", "cut"))
    u, gradient, _ = learnt(oval.points)
    assert np.abs((gradient * oval.normals).sum(axis=1) + 2 * u - oval.points[:, 0]).max() < 1e-12
    assert np.abs(learnt(cut.points)[0] - cut.points.prod(axis=1)).max() < 1e-13
