"""Transition surfaces between edges, and lines inside, of two patches."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.functions.univariate import Formula
from rsym.surfaces.networks.transition import Across, TransitionSurface, as_line
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v

ONE = (u, v, sp.sin(u + v) / 2)
TWO = (2 + u * sp.cos(v / 2), v + u**2 / 3, 1 + sp.exp(u * v / 2))
PLACES = np.linspace(0, 1, 13)
LINE = (sp.Rational(1, 2) + t * (1 - t), t)
OTHER = (t**2 / 3, 1 - t * sp.Rational(4, 5))


def surfaces():
    return ParametricSurface(ONE), ParametricSurface(TWO)


def on_line(patch, line, places):
    u_t, v_t = (sp.lambdify(t, entry)(places) + 0 * places for entry in line)
    return u_t, v_t


@pytest.mark.random
@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize(("first", "second"), [("u1", "u0"), ("v0", "u1"), ("u0", "v1"), ("v1", "v0")])
def test_edges_are_left_outwards_and_entered_inwards(order, first, second):
    one, two = surfaces()
    surface = TransitionSurface(one, first, two, second, order=order, k1=0.7, k2=2)
    for patch, name, w, k, outwards in ((one, first, 0, 0.7, 1), (two, second, 1, 2, -1)):
        fixed = np.full(13, float(name[1]))
        place = (fixed, PLACES) if name[0] == "u" else (PLACES, fixed)
        across = (1, 0) if name[0] == "u" else (0, 1)
        sign = outwards * (1 if name[1] == "1" else -1)
        assert_close(surface(PLACES, w), patch(*place), atol=1e-14)
        assert_close(surface.derivative(PLACES, w, (0, 1)), sign * k * patch.derivative(*place, across), atol=1e-13)
        if order == 3:
            second_order = tuple(2 * one for one in across)
            assert_close(
                surface.derivative(PLACES, w, (0, 2)), k**2 * patch.derivative(*place, second_order), atol=1e-12
            )


@pytest.mark.parametrize("order", [2, 3])
def test_normals_coincide_along_curved_lines_and_curvatures_too_in_class_3(order):
    one, two = surfaces()
    k1, k2 = 1 + t**2, lambda s: 0.5 + np.cos(s)
    surface = TransitionSurface(one, LINE, two, OTHER, order=order, k1=k1, k2=k2)
    for patch, line, w, weight in ((one, LINE, 0, 1 + PLACES**2), (two, OTHER, 1, 0.5 + np.cos(PLACES))):
        place = on_line(patch, line, PLACES)
        assert_close(surface(PLACES, w), patch(*place), atol=1e-14)
        normals = np.cross(*patch.derivatives(*place, ((1, 0), (0, 1))))
        own = np.cross(*surface.derivatives(PLACES, w, ((1, 0), (0, 1))))
        speed = sum(np.square(sp.lambdify(t, entry.diff(t))(PLACES)) for entry in line)
        assert_close(own, surface.sides[int(w)] * (weight * speed)[:, None] * normals, atol=1e-12)
        sign = surface.sides[int(w)]
        bends = surface.mean_curvature(PLACES, w), sign * patch.mean_curvature(*place)
        if order == 3:
            assert_close(*bends, atol=1e-11)
            assert_close(surface.gaussian_curvature(PLACES, w), patch.gaussian_curvature(*place), atol=1e-11)
        else:
            assert np.abs(bends[0] - bends[1]).max() > 0.1


@pytest.mark.slow
def test_derivatives_along_lines_are_those_of_the_formulas():
    patch = ParametricSurface(ONE)
    for line in ((t / 2 + sp.sin(t) / 3, t**2 / 2), LINE):
        for k in range(3):
            curve = Across(patch, as_line(patch, line), k, -1)
            formulas = curve.expressions()
            expected = [[f.diff(t, n).subs(t, place) for f in formulas] for place in (0.2, 0.7) for n in range(4)]
            found = curve.evaluate(np.array([0.2, 0.7]), [0, 1, 2, 3])
            assert_close(np.stack(found, axis=1).reshape(8, 3), np.array(expected, float), atol=1e-11)


def test_the_surface_is_a_formula_where_the_patches_are():
    one, two = surfaces()
    surface = TransitionSurface(one, LINE, two, "u0", k1=1 + t)
    place = {u: sp.Rational(1, 3), v: sp.Rational(1, 4)}
    for order in ((0, 0), (3, 1)):
        expected = surface.expression().diff(u, order[0]).diff(v, order[1]).subs(place).evalf()
        assert_close(surface.derivative(1 / 3, 0.25, order), np.array(expected, float).ravel(), atol=1e-12)


@pytest.mark.slow
def test_a_closed_line_makes_a_tube_that_closes():
    """From a circle cut out of a paraboloid down to a rim below it."""
    bowl = ParametricSurface((u, v, u**2 + v**2), ((-1, 1), (-1, 1)))
    rim = ParametricSurface(
        (sp.cos(u) * (2 + v), sp.sin(u) * (2 + v), 2), ((0, 2 * sp.pi), (0, 1)), closed=(True, False)
    )
    circle = Formula((sp.cos(t) / 2, sp.sin(t) / 2), domain=(0, 2 * sp.pi))
    surface = TransitionSurface(bowl, circle, rim, "v0", order=3)
    assert surface.closed == (True, False)
    w = np.linspace(0, 1, 9)
    for order in ((0, 0), (1, 0), (0, 1), (2, 0)):
        assert_close(surface.derivative(2 * np.pi, w, order), surface.derivative(0, w, order), atol=1e-12)
    # Out of the circle and out of the rim: to the right of an anticlockwise circle, to the left of the line v = 0.
    assert surface.sides == (-1, 1)
    turned = 2 * np.pi * np.arange(5) / 5
    r = np.linalg.norm(surface.grid(turned, w)[..., :2], axis=-1)
    assert_close(r, np.broadcast_to(r[0], r.shape), atol=1e-13)
    assert (np.diff(r[0]) > 0).all()


def test_a_line_may_be_run_through_backwards_and_given_by_functions():
    one, two = surfaces()
    plain = TransitionSurface(one, "u1", two, (lambda s: s**2 / 3, lambda s: 1 - 0.8 * s), reverse=True)
    other = TransitionSurface(one, "u1", two, ((1 - t) ** 2 / 3, sp.Rational(1, 5) + t * sp.Rational(4, 5)))
    whole = TransitionSurface(one, "u1", two, lambda s: ((1 - s) ** 2 / 3, 0.2 + 0.8 * s))
    for surface in (plain, whole):
        assert_close(surface.grid(PLACES, PLACES), other.grid(PLACES, PLACES), atol=1e-12)


def test_an_edge_over_another_interval_keeps_its_own_derivative_across():
    long = ParametricSurface((5 + u, v / 3, u * v), ((0, 1), (0, 3)))
    surface = TransitionSurface(surfaces()[0], "u1", long, "u0")
    assert surface.domain == ((0, 1), (0, 1))
    assert_close(surface.derivative(0.5, 1, (0, 1)), [1, 0, 1.5], atol=1e-14)


def test_sides_that_do_not_show_are_asked_for():
    floor = ParametricSurface((u, v, 0), ((-2, 2), (-2, 2)))
    above = ParametricSurface((u, v, 1), ((-2, 2), (-2, 2)))
    with pytest.raises(RsymError, match=r"which side of the first line .* mean cosine of"):
        TransitionSurface(floor, (t, 0), above, (t, 0))
    surface = TransitionSurface(floor, (t, 0), above, (t, 0), sides=("left", "right"))
    assert_close(surface(0.5, 0.5), [0.5, 0.25, 0.5], atol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"order": 4}, "class of a transition is 2 or 3"),
        ({"blend": HermiteBlend.quintic()}, "needs a blend of class 2, got one of class 3"),
        ({"k1": t - sp.Rational(1, 2)}, "k1 must be positive, got -0.5 at t = 0"),
        ({"sides": ("up", None)}, "left or right of a line, got 'up'"),
        ({"first_edge": "w0"}, "an edge is one of u0, u1, v0, v1"),
        ({"first_edge": (t, 2 * t)}, r"v must lie in \[0, 1\]"),
        ({"first_edge": 3}, r"u0, u1, v0, v1 or \(u\(t\), v\(t\)\), got 3"),
    ],
)
def test_bad_transitions_are_refused(arguments, message):
    one, two = surfaces()
    arguments = {"first_edge": "u1"} | arguments
    with pytest.raises(RsymError, match=message):
        TransitionSurface(one, arguments.pop("first_edge"), two, "u0", **arguments)
