"""Interpolants have the data, wherever they are asked, and data that contradict each other are refused."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z

RING = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
HALF = rsym.disc(2).named("rim") & rsym.half_plane((1, 0), 0).named("cut")
HOLES = (
    rsym.disc(2).named("rim")
    - rsym.disc(0.3, (1, 0)).named("right")
    - rsym.disc(0.3, (-1, 0)).named("left")
    - rsym.ellipse(0.2, 0.4, centre=(0, 1)).named("oval")
)
ELL = rsym.rectangle(2, 1).named("long") | rsym.rectangle(1, 2).named("high")
CAP = rsym.sphere(1).named("ball") & rsym.half_space((0, 0, 1), 0.3).named("floor")
TORUS = rsym.torus(2, 0.5).named("torus") - rsym.sphere(1, (2, 0, 0)).named("dent")


def values(shape, expression, points):
    return rsym.compile(shape.replace(expression=expression), backend="numpy")(*points.T)["value"]


def misses(shape, data, **how):
    """How far values and outward slopes are from data on 300 points of each part."""
    u = rsym.compile(rsym.interpolate(shape, data, **how), ("value", "gradient"))
    worst = []
    for part, given in data.items():
        found = rsym.sample(shape, 300, over=part, rng=1)
        value, *slope = given if isinstance(given, tuple) else (given,)
        at = u(*found.points.T)
        worst.append(np.abs(at["value"] - values(shape, sp.sympify(value), found.points)).max())
        if slope:
            along = np.einsum("ij,ij->i", at["gradient"], found.normals)
            worst.append(np.abs(along - values(shape, sp.sympify(slope[0]), found.points)).max())
    return max(worst)


@pytest.mark.parametrize(
    ("shape", "data"),
    [
        (RING, {"rim": x, "bore": 1}),
        (RING, {"rim": (sp.sin(x), y), "bore": (1, x * y)}),
        (HALF, {"rim": (x * y, 3), "cut": (0, y)}),
        (HOLES, {"rim": x, "right": (1, 0), "left": (2, x), "oval": y}),
        (HOLES.with_system(rsym.R1), {"rim": x, "right": (1, 0), "left": (2, x), "oval": (y, x)}),
        (ELL, {"long": (x + y, x), "high": (x + y, 3)}),
        (ELL.with_system(rsym.R0m(2)), {"long": (x * x, 1), "high": (x * x, 3)}),
        (rsym.ellipse(2, 1).named("all"), {"all": (x * y, y)}),
        (CAP, {"ball": (z, x), "floor": (sp.Rational(3, 10), y)}),
        (TORUS, {"torus": (x, y), "dent": (x, 1)}),
    ],
)
@pytest.mark.parametrize("weights", ["inverse", pytest.param("joined", marks=pytest.mark.slow)])
def test_values_and_slopes_are_met(shape, data, weights):
    assert misses(shape, data, weights=weights) < 2e-13


def test_slopes_are_missed_where_they_are_others():
    """Red proof."""
    u = rsym.interpolate(RING, {"rim": (x, 1), "bore": 1})
    found = rsym.sample(RING, 50, over="rim", rng=1)
    gradient = rsym.compile(u, ("gradient",))(*found.points.T)["gradient"]
    assert np.abs(np.einsum("ij,ij->i", gradient, found.normals) - 1.1).min() > 0.09


def test_second_derivatives_along_the_normal():
    """On the bore, whose rays are straight: by differences of the closed form."""
    u = rsym.compile(rsym.interpolate(RING, {"rim": x, "bore": (y, 3, x + 1)}, 2))
    angles, h = np.linspace(0, 6, 9), 1e-3
    rays = np.array([np.cos(angles), np.sin(angles)])
    rows = [u(*(rays * (1 + k * h)))["value"] for k in range(6)]
    second = (45 * rows[0] - 154 * rows[1] + 214 * rows[2] - 156 * rows[3] + 61 * rows[4] - 10 * rows[5]) / (12 * h * h)
    assert np.abs(second - (rays[0] + 1)).max() < 1e-5


def test_letters_live():
    r, c = sp.symbols("r c", real=True)
    shape = rsym.disc(2).named("rim") - rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 1}).named("bore")
    u = rsym.interpolate(shape, {"rim": c * x, "bore": (0, c)}, letters={"c": 1})
    kernel = rsym.compile(u, ("value", "gradient"))
    found = kernel([2.0, 0.0], [0.0, 0.5], letters={"r": 0.5, "c": 3})
    assert found["value"].tolist() == [6, 0]
    assert found["gradient"][1, 1] == -3
    field = rsym.Shape(c * y, (x, y), letters={c: 7})
    assert rsym.interpolate(RING, {"rim": field, "bore": 0}).letters["c"].default == 7


def test_at_corners_the_value_is_that_of_the_data_and_not_nan():
    for kind in ("float64", "float32"):
        u = rsym.compile(rsym.interpolate(HALF, {"cut": y**2, "rim": (4 - x, x)}), dtype=kind)
        assert u([0.0, 0.0], [2.0, -2.0])["value"].tolist() == [4, 4]
    square = rsym.Shape(x * (1 - x), (x, y)).named("a") & rsym.Shape(y * (1 - y), (x, y)).named("b")
    u = rsym.compile(rsym.interpolate(square, {"a": x + 2 * y, "b": x + 2 * y}, weights="joined"))
    assert u([0.0, 1, 0, 1], [0.0, 0, 1, 1])["value"].tolist() == [0, 1, 2, 3]


def test_close_to_a_corner_it_is_continuous():
    u = rsym.compile(rsym.interpolate(HALF, {"cut": y**2, "rim": (4 - x, 5)}))
    rng = np.random.default_rng(2)
    for size in (1e-3, 1e-8, 1e-14):
        points = np.array([0, 2.0]) + size * rng.uniform([0, -1], [1, 0], (200, 2))
        assert np.abs(u(*points.T)["value"] - 4).max() < 30 * size + 1e-14


def test_kernels_of_float32_have_the_data_to_their_rounding():
    found = rsym.sample(HOLES, 500, over="boundary", rng=3)
    u = rsym.compile(rsym.interpolate(HOLES, {"rim": (x, 1), ...: 2}), dtype="float32")
    expected = np.where(found.parts == "rim", found.points[:, 0], 2)
    assert np.abs(u(*found.points.T)["value"] - expected).max() < 1e-5


def test_how_large_the_formula_of_a_part_is_does_not_matter():
    point = 1.3, 0.4
    plain = rsym.compile(rsym.interpolate(RING, {"rim": x, "bore": 1}))(*point)["value"]
    rim = rsym.Shape(10**6 * (4 - x**2 - y**2), (x, y), bounds=((-3, 3), (-3, 3))).named("rim")
    large = rim - rsym.disc(1).named("bore")
    assert abs(rsym.compile(rsym.interpolate(large, {"rim": x, "bore": 1}))(*point)["value"] - plain) < 1e-13


def test_how_large_the_shape_is_does_not_matter():
    at = 0.9, -0.4
    values = []
    for size in (1, 1024, sp.Rational(1, 1024)):
        shape = rsym.ellipse(2, 1).named("rim") - rsym.ellipse(0.5, 0.25).named("bore")
        u = rsym.interpolate(shape.scale(size), {"rim": x / size, "bore": (1, 3 / size)})
        values.append(float(rsym.compile(u)(*(float(size) * one for one in at))["value"]))
    assert np.ptp(values) < 1e-12


def test_it_is_a_shape_in_the_bounds_of_the_shape():
    u = rsym.interpolate(RING.replace(bounds=((-3, 3), (-2, 4))), {"rim": x, "bore": 0})
    assert u.bounds == ((-3, 3), (-2, 4))
    assert len(rsym.level_lines(u, 0.5, resolution=64)) > 0
    assert rsym.interpolate(RING, {"rim": 1}).bounds is not None


@pytest.mark.parametrize(
    ("shape", "data", "place"),
    [
        (HALF, {"rim": x, "cut": 1}, r"'rim' and the part 'cut' meet at \(0, -?2\), where one is given 0, the other 1"),
        (ELL, {"long": 0, "high": y}, r"meet at \(-?0.5, -?0.5\), where one is given 0, the other -?0.5"),
        (
            rsym.disc(2).named("a") - rsym.disc(0.5, (1.5, 0)).named("b"),
            {"a": x, "b": 3},
            r"\(2, -?[\de.-]+\).* 2, .* 3",
        ),
        (CAP, {"ball": x, "floor": x + 0.001 * y}, r"'ball' and the part 'floor' meet"),
        (HALF, {"cut": y, ...: 2}, r"'cut' and the rest meet at \(0, -2\), where one is given -2, the other 2"),
        (HALF, {"rim": sp.sin(x) / x, "cut": 1.01}, "what is undefined, the other 1.01"),
        (HALF, {"rim": 1 + 1e-7 * y, "cut": 1}, "meet"),
    ],
)
def test_data_that_disagree_are_refused_with_place_and_both_values(shape, data, place):
    with pytest.raises(rsym.RsymError, match=place) as raised:
        rsym.interpolate(shape, data)
    assert raised.value.code == "contradiction"


@pytest.mark.parametrize(
    ("shape", "data"),
    [
        (HALF, {"rim": x, "cut": 1e-12}),  # to rounding
        (HALF, {"rim": sp.sin(x) / x, "cut": 1}),  # in the limit, where one is undefined
        (HALF, {"rim": x * sp.log(x), "cut": 0}),
        (rsym.disc(2).named("a") - rsym.disc(0.5, (1.5, 0)).named("b"), {"a": 1000 * y, "b": -1000 * y}),
        (rsym.disc(2).named("a") - rsym.disc(0.5, (1.5, 0)).named("b"), {"a": x, "b": 2 + y}),
        (rsym.disc(2).named("a") - rsym.disc(0.5, (1.499, 0)).named("b"), {"a": x, "b": 3}),  # they do not meet
        (HALF, {"rim": 1e-20 * x, "cut": 1e-35}),
    ],
)
def test_data_that_agree_are_not(shape, data):
    rsym.interpolate(shape, data)


def test_parts_that_vanish_are_refused():
    r = sp.Symbol("r", real=True)
    shape = rsym.disc(2).named("rim") - rsym.Shape(r**2 - (x - 3) ** 2 - y**2, (x, y), letters={r: 1.5}).named("bite")
    rsym.interpolate(shape, {"bite": 1})
    with pytest.raises(rsym.RsymError, match=r"the part 'bite' has nothing of the boundary where r = 0.5") as raised:
        rsym.interpolate(shape.with_letters({"r": 0.5}), {"bite": 1})
    assert raised.value.code == "vanished-part"


def test_slopes_where_a_formula_has_none_are_refused():
    circle = 1 - x**2 - y**2
    flat = rsym.Shape(sp.sin(circle) ** 3 + circle**5, (x, y), bounds=((-2, 2), (-2, 2))).named("flat")
    assert rsym.interpolate(flat, {"flat": x}).expression == x
    for question in (
        lambda: rsym.interpolate(flat, {"flat": (x, 1)}),
        lambda: rsym.solution_structure(flat, rsym.robin(1)),
    ):
        with pytest.raises(rsym.RsymError, match="has no slopes") as raised:
            question()
        assert raised.value.code == "singular-part"
    cubed = rsym.Shape(circle**3, (x, y), bounds=((-2, 2), (-2, 2))).named("cubed")  # its leaf is the root
    assert misses(cubed, {"cubed": (x, y)}) < 1e-14


@pytest.mark.parametrize(
    "shape",
    [
        rsym.Shape(sp.exp(1 - x**2 - y**2) - 1, (x, y), bounds=((-2, 2), (-2, 2))),
        rsym.conjunction(rsym.disc(1), rsym.half_plane((1, 0), 0), system=rsym.Rho(0.2)),
        rsym.conjunction(rsym.disc(1), rsym.half_plane((1, 0), 0), system=rsym.Sardf()),
        rsym.offset(rsym.rectangle(2, 1), -0.3),
        rsym.superellipse(2, 1, 4),
        rsym.polygon([(0, 0), (2, 0), (2, 2), (1, 0.5), (0, 2)]),
    ],
    ids=["exponential", "fillet", "Sardf", "offset", "superellipse", "polygon"],
)
def test_whatever_the_shape_is_made_of(shape):
    assert misses(shape.named("all"), {"all": (x, y)}) < 2e-14


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (({"bor": 1},), "unknown-part", "did you mean 'bore'"),
        (({"rim": (x, 1, 2)},), "order", "order=2"),
        (({"rim": ()},), "order", "give a value"),
        (({"rim": x}, 4), "order", "from 1 to 3, got 4"),
        (({"rim": x}, 0), "integer", "from 1 on"),
        (({"rim": rsym.robin(2)},), "condition", "solution_structure"),
        (({"rim": max},), "formula", "is a function"),
        (({"rim": sp.Symbol("c")},), "unknown-letter", "letters={'c': value}"),
        (({"rim": rsym.sphere(1)},), "coordinates", "is a shape in"),
        (({"rim": "x"},), "number", "the value on 'rim'"),
        (({},), "data", "no data"),
        ((3,), "data", "expected a mapping"),
    ],
)
def test_what_is_refused(arguments, code, said):
    with pytest.raises(rsym.RsymError, match=said) as raised:
        rsym.interpolate(RING, *arguments)
    assert raised.value.code == code


def test_what_else_is_refused():
    with pytest.raises(rsym.RsymError, match="expected a Shape"):
        rsym.interpolate(3, {"rim": 1})
    with pytest.raises(rsym.RsymError, match="did you mean 'joined'"):
        rsym.interpolate(RING, {"rim": 1}, weights="join")
    with pytest.raises(rsym.RsymError) as raised:
        rsym.interpolate(rsym.half_plane((1, 0), 0), {...: 1})
    assert raised.value.code == "unbounded"
    with pytest.raises(rsym.RsymError, match="the length must be positive"):
        rsym.interpolate(RING, {"rim": 1}, length=0)


def test_data_that_are_undefined_where_parts_meet_are_refused():
    half = rsym.disc(2).named("rim") & rsym.half_plane((1, 0), 0).named("cut")
    with pytest.raises(rsym.RsymError, match="is given what is undefined, the other 0"):
        rsym.interpolate(half, {"rim": sp.log(x - 1), "cut": 0})
