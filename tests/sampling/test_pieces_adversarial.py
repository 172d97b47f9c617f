"""What users and hostile model files try on pieces: refused with a remedy, or right."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import RsymError, Shape, x, y, z

DISC, BALL = rsym.disc(), rsym.sphere()
HEAD = "letter a = 1.5; f = 1 - x^2/4 - y^2; h = x*y - z^2; omega = "


@pytest.mark.parametrize(
    "make",
    [
        lambda: DISC.translate(y, 0),
        lambda: DISC.rotate(x),
        lambda: BALL.rotate(1, (0, 0, 1), (z, 0, 0)),
        lambda: DISC.mirror(x, y),
        lambda: DISC.shear(x, y, x),
        lambda: DISC.scale(1 + x**2),
        lambda: rsym.offset(DISC, x),
        lambda: rsym.disc(1 + x**2),
        lambda: rsym.quadric(((x, 0), (0, 1))),
        lambda: rsym.quadric(((1, 0), (0, 1)), (y, 0)),
    ],
)
def test_a_number_that_varies_from_place_to_place_is_refused(make):
    with pytest.raises(RsymError, match="coordinate") as refusal:
        make()
    assert "transform" in refusal.value.remedy


def test_a_letter_may_have_the_name_of_a_coordinate_that_the_shape_has_not():
    moved = DISC.translate(z, 0, letters={z: 2})
    assert float(rsym.compile(moved)(2.0, 0.0)["value"]) == 0.5


@pytest.mark.parametrize("axis", [3, -1, True])
def test_a_coordinate_that_is_not_there_is_no_axis(axis):
    for turn in (lambda: BALL.rotate(1, axis), lambda: BALL.mirror(axis)):
        with pytest.raises(RsymError, match="one of the coordinates"):
            turn()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ('disc(exact = "no")', "0 or 1"),
        ("disc(exact = x)", "0 or 1"),
        ("disc(exact = a)", "0 or 1"),
        ('polyline([[0, 0], [1, 1], [2, 0]], closed = "no")', "0 or 1"),
        ("transform(f, [x, y], renormalise = 2)", "0 or 1"),
        ("disc(radius = 1, radius = 2)", "twice"),
        ("rotate(h, pi, 7)", "one of the coordinates"),
        ("translate(f, y, 0)", "coordinate"),
    ],
)
def test_what_a_call_would_misread_is_refused_at_its_place(call, message):
    with pytest.raises(RsymError, match=message) as refusal:
        rsym.loads(HEAD + call)
    assert f"column {len(HEAD) + 1}" in str(refusal.value)


SWEPT = "".join(f"f{k + 1} = section(sweep(a*f{k}, [[a, (z + a)^9]], 0, 1), z, a);" for k in range(9))


@pytest.mark.parametrize(
    "text",
    [
        "f0 = x; " + "".join(f"f{k + 1} = transform(f{k}, [x^9, y]);" for k in range(9)) + "w = transform(f9, [2, y])",
        "f0 = x; " + "".join(f"f{k + 1} = (f{k} + 1)^9;" for k in range(9)) + "w = transform(f9, [2, y])",
        "f0 = x; " + "".join(f"f{k + 1} = transform(f{k}, [2^1000*x, y]);" for k in range(9)),
        "letter a = 1; f0 = x + y^2;" + SWEPT,
        "w = superellipse(1, 1, 1e300)",
        'w = torus(1e200, 1e199, form = "quartic")',
    ],
)
def test_numbers_that_would_grow_without_end_are_refused_before_they_do(text):
    with pytest.raises(RsymError, match=r"exponent|large|small|bits") as refusal:
        rsym.loads(text)
    assert "line 1" in str(refusal.value)


@pytest.mark.random
@pytest.mark.parametrize(
    "shape", [rsym.cyclic(DISC, 5, radius=2), rsym.cyclic(rsym.strip(), 5, radius=2, motif="any"), rsym.row(DISC, 3)]
)
def test_the_image_of_a_copied_motif_holds_its_values(shape):
    ends = sp.symbols("a b c d", real=True)
    images = shape.contract().image({x: ends[:2], y: ends[2:]})
    random = np.random.default_rng(0)
    kernels = [rsym.compile(Shape(image, ends[:3], letters={ends[3]: 0})) for image in images]
    for corner, side in zip(random.uniform(-4, 4, (20, 2)), 10.0 ** random.uniform(-2, 0.5, 20), strict=True):
        values = rsym.compile(shape)(*(corner[:, None] + side * random.random((2, 300))))["value"]
        box = (corner[0], corner[0] + side, corner[1])
        low, high = (kernel(*box, letters={"d": corner[1] + side})["value"] for kernel in kernels)
        assert low <= values.min() + 1e-12
        assert high >= values.max() - 1e-12


D = sp.Symbol("d", real=True)


@pytest.mark.parametrize("letter", [0, rsym.Letter(1, minimum=0), rsym.Letter(1, minimum=-2, maximum=2)])
@pytest.mark.parametrize(
    ("omega", "continuity"),
    [
        (1 - sp.sqrt(x**2 + y**2 + D**2), 0),
        (1 / (x**2 + D**2) - 1, -1),
        (rsym.conjunction(x**2 + y**2, D), 0),
        (rsym.conjunction(D * x, x - 1), 0),
    ],
)
def test_a_letter_that_may_be_zero_keeps_no_singular_set_empty(omega, continuity, letter):
    assert Shape(omega, (x, y), letters={D: letter}).contract().continuity == continuity


def test_a_letter_that_is_not_zero_does():
    for letter in (1, rsym.Letter(1, minimum=0.5)):
        assert Shape(1 - sp.sqrt(x**2 + y**2 + D**2), (x, y), letters={D: letter}).contract().continuity == float("inf")


def test_a_segment_that_is_drawn_twice_counts_once():
    there = rsym.segment((0, 0), (1, 1))
    for twice in (
        rsym.graph([(0, 0), (1, 1)], [(0, 1), (1, 0)]),
        rsym.polyline([(0, 0), (1, 1), (0, 0)]),
        rsym.graph([(0, 0), (1, 1), (0, 0)], [(0, 1), (2, 1)]),
    ):
        assert twice.expression == there.expression
