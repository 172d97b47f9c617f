"""Waves, cyclic copies, rows and grids, against points carried into the motif's cell one by one."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, x, y, z
from rsym.model.symbols import substitute
from rsym.model.symmetry.cyclic import MOST_IN_A_FAN, cyclic
from rsym.model.symmetry.evenness import check_even
from rsym.model.symmetry.rows import grid, row
from rsym.model.symmetry.waves import triangle_wave

a, b = sp.symbols("a b", real=True)
ELLIPSE = Shape((1 - x**2 / 4 - 2 * y**2) / 2 + x / 9, (x, y), bounds=((-3, 3), (-1, 1)))
DROP = Shape((1 - x**2 - 2 * y**2) / 2 + x * y / 3 + y / 5, (x, y), bounds=((-2, 2), (-1, 1)))


def points(count=4000, reach=7.0, dimension=2):
    return np.random.default_rng(5).uniform(-reach, reach, (dimension, count))


def values(shape, *coordinates, letters=None):
    return rsym.compile(shape, ("value", "gradient"))(*coordinates, letters=letters)


def test_what_collapses_to_a_symbol_is_not_replaced_twice():
    assert substitute(conjunction(1 - y, 1 + y), {y: -y}) == conjunction(1 + y, 1 - y)
    assert substitute(x - y, {x: y, y: x}) == y - x


def test_the_triangle_wave_keeps_its_digits_at_the_peaks():
    wave = Shape(triangle_wave(x, a) + 0 * y, (x, y), letters={a: 2})
    near = np.concatenate([k + s * 10.0 ** -np.arange(1, 15) for k in (-3, -1, 1, 5) for s in (1, -1)])
    t = np.concatenate([points(reach=50)[0], near])
    got = values(wave, t, 0.0)
    folded = np.abs((t - 1) % 4 - 2) - 1
    assert_close(got["value"], folded, atol=2e-14)
    assert_close(got["gradient"][:, 0], np.where((t - 1) % 4 > 2, 1.0, -1.0), atol=1e-9)
    assert_close(values(wave, 3.0, 0.0, letters={"a": 8})["value"], 3.0, atol=1e-15)


def test_the_series_converges_to_the_wave():
    t = np.linspace(-2.5, 2.5, 2001)
    exact = np.abs((t - 1) % 4 - 2) - 1

    def errors(terms):
        gap = np.abs(values(Shape(triangle_wave(x, 2, terms) + 0 * y, (x, y)), t, 0.0)["value"] - exact)
        return gap.max(), gap[np.abs(np.abs(t) - 1) > 0.4].max()

    (peak, between), (peak_2, between_2) = errors(24), errors(48)
    assert_close([peak, peak_2], [2 / (np.pi**2 * 24), 2 / (np.pi**2 * 48)], rtol=1e-3)
    assert_close(np.log2([peak / peak_2, between / between_2]), [1, 2], atol=0.1)


def in_the_first_sector(u, v, order):
    """Turned back by a whole number of sectors, and the turn."""
    turn = 2 * np.pi / order * np.round(np.arctan2(v, u) * order / (2 * np.pi))
    return np.cos(turn) * u + np.sin(turn) * v, np.cos(turn) * v - np.sin(turn) * u, turn


@pytest.mark.random
@pytest.mark.parametrize(
    ("motif", "order", "kind"),
    [(ELLIPSE, n, "even") for n in (1, 2, 3, 4, 6, 7, 10, MOST_IN_A_FAN + 2)] + [(DROP, 1, "any"), (DROP, 5, "any")],
)
def test_cyclic_copies(motif, order, kind):
    """The field and its gradient, also beside the cut of the angle."""
    u, v = points()
    u = np.concatenate([u, [-4.0, -4.0, -5.0, -5.0]])
    v = np.concatenate([v, [1e-12, -1e-12, 1e-7, -1e-7]])
    # With a letter the copies are not known to keep apart for all of its values, and the plane is folded.
    radius, letters = (a, {a: 3}) if kind == "any" else (3, None)
    got = values(cyclic(motif, order, radius=radius, motif=kind, letters=letters), u, v)
    p, q, turn = in_the_first_sector(u, v, order)
    expected = values(motif, p - 3, q)
    assert_close(got["value"], expected["value"], atol=3e-13)
    along, across = np.moveaxis(expected["gradient"], -1, 0)
    turned = np.stack([np.cos(turn) * along - np.sin(turn) * across, np.sin(turn) * along + np.cos(turn) * across], -1)
    assert_close(got["gradient"], turned, atol=1e-9)


@pytest.mark.parametrize("order", [4, 5])
def test_the_centre_and_the_borders_have_values(order):
    border = np.pi / order
    u, v = np.array([0.0, np.cos(border), -1.0]), np.array([0.0, np.sin(border), 0.0])
    got = rsym.compile(cyclic(ELLIPSE, order, radius=3))(u, v)["value"]
    p, q, _ = in_the_first_sector(u, v, order)
    assert_close(got, rsym.compile(ELLIPSE)(p - 3, q)["value"], atol=1e-12)


@pytest.mark.parametrize("axis", [x, y, "z", None])
def test_cyclic_copies_about_an_axis_in_space(axis):
    first, second = {"x": (y, z), "y": (z, x), "z": (x, y)}[str(axis or "z")]
    third = ({x, y, z} - {first, second}).pop()
    motif = Shape(1 - first**2 / 3 - second**2 - third / 2, (x, y, z), bounds=((-1, 2), (-3, 4), (-5, 6)))
    ring = cyclic(motif, 6, axis=axis, radius=a, letters={a: 3})
    place = dict(zip((x, y, z), points(dimension=3), strict=True))
    p, q, _ = in_the_first_sector(place[first], place[second], 6)
    expected = 1 - (p - 3) ** 2 / 3 - q**2 - place[third] / 2
    assert_close(rsym.compile(ring)(*place.values())["value"], expected, atol=1e-12)
    assert ring.bounds[(x, y, z).index(third)] == motif.bounds[(x, y, z).index(third)]


def test_a_truncated_series_is_smooth_where_sectors_meet():
    ring = cyclic(ELLIPSE, 5, radius=3, terms=6)
    u, v = points()
    gap = np.abs(rsym.compile(ring)(u, v)["value"] - rsym.compile(cyclic(ELLIPSE, 5, radius=3))(u, v)["value"])
    assert 1e-3 < gap.max() < 3
    beside = np.array([1e-9, -1e-9])
    hessian = rsym.compile(ring, ("hessian",))(np.full(2, -5.0), beside)["hessian"]
    assert_close(hessian[0], hessian[1], atol=1e-6)


def in_the_nearest_cell(t, period, count):
    return t - period * np.clip(np.round(t / period), 0, np.inf if count is None else count - 1)


@pytest.mark.random
@pytest.mark.parametrize("kind", ["even", "any"])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7, None])
def test_rows(count, kind):
    motif = DROP if kind == "any" else ELLIPSE.replace(expression=ELLIPSE.expression - x / 9)
    made = row(motif, a, count=count, motif=kind, letters={a: 5})
    for period in (5.0, 3.5):
        u, v = points(reach=40)
        u = np.abs(u) if count is None else u
        got = values(made, u, v, letters={"a": period})
        expected = values(motif, in_the_nearest_cell(u, period, count), v)
        assert_close(got["value"], expected["value"], atol=1e-10)
        assert_close(got["gradient"], expected["gradient"], atol=1e-9)


@pytest.mark.parametrize("count", [2, 5])
def test_a_finite_row_has_so_many_copies_and_no_more(count):
    disc = Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    made = row(disc, 3, axis=y, count=count)
    assert made.bounds == ((-2, 2), (-2, 3 * count - 1))
    lines = rsym.level_lines(made, bounds=((-2, 2), (-20, 20)), resolution=400)
    centres = sorted(line.mean(axis=0)[1] for line in lines)
    assert_close(centres, 3.0 * np.arange(count), atol=2e-2)
    gradient = values(made, np.cos(points()[0]), 3 + np.sin(points()[0]))["gradient"]
    assert_close(np.linalg.norm(gradient, axis=-1), np.ones(4000), atol=1e-12)


def test_grids():
    ball = Shape((1 - x**2 - y**2 - z**2) / 2, (x, y, z), bounds=((-1, 1),) * 3)
    made = grid(ball, (3, a, 4), counts=(2, 3, 1), letters={a: 2.5})
    assert made.bounds == ((-1, 4), (-1, 6), (-1, 1))
    u, v, w = points(dimension=3)
    p, q = in_the_nearest_cell(u, 3, 2), in_the_nearest_cell(v, 2.5, 3)
    assert_close(rsym.compile(made)(u, v, w)["value"], (1 - p**2 - q**2 - w**2) / 2, atol=1e-12)
    endless = grid(ball, (3, 4))
    again = rsym.compile(endless)(u + 6, v - 8, w)["value"]
    assert_close(rsym.compile(endless)(u, v, w)["value"], again, atol=1e-12)


@pytest.mark.slow
def test_a_gear_is_closed():
    flank = sp.Rational(6, 5) - x / 3
    tooth = Shape(conjunction(flank - y, flank + y, 2 - x), (x, y, z), bounds=((-3, 3), (-2, 2), (-1.5, 1.5)))
    gear = cyclic(tooth, 12, radius=10)
    body = conjunction(rsym.disjunction(gear.expression, (81 - x**2 - y**2) / 18), (1 - z**2) / 2)
    mesh = rsym.mesh(gear.replace(expression=body), 64)
    assert "closed" in str(mesh.status)
    assert "Unresolved" not in str(mesh.status)
    # The disc, and what of each trapezium lies beyond it: the integral of the half-width over the angle.
    angle = np.linspace(-0.2, 0.2, 400001)
    reach = np.minimum(12 / np.cos(angle), (1.2 + 10 / 3) / (np.abs(np.sin(angle)) + np.cos(angle) / 3))
    beyond = np.trapezoid(np.maximum(reach**2 - 81, 0) / 2, angle)
    corners = mesh.vertices[mesh.faces]
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    assert_close(volume, 2 * (81 * np.pi + 12 * beyond), rtol=2e-3)


def test_a_motif_must_be_even():
    with pytest.raises(RsymError, match=r"even in y.* at x = .*mirrored\(motif, \(0, 1\)\)") as caught:
        cyclic(DROP, 5)
    assert caught.value.code == "not-even"
    with pytest.raises(RsymError, match="even in x"):
        row(ELLIPSE, 3)
    # A bump of a tenth of the box.
    bump = sp.Max(0, sp.Rational(1, 4) - (x - 1) ** 2 - (y - 1) ** 2)
    with pytest.raises(RsymError, match="even in y"):
        check_even(Shape(1 - x**2 - y**2 - bump, (x, y), bounds=((-2.5, 2.5),) * 2), y)


def test_a_motif_must_be_even_for_all_values_of_its_letters():
    symmetric = Shape(a - b * y**2 + x, (x, y), letters={a: 1, b: 2})
    check_even(symmetric, y)
    with pytest.raises(RsymError, match="even in y"):
        check_even(symmetric.replace(expression=symmetric.expression + (a - 1) * y), y)
    held = Shape(a + (b - 2) * y, (x, y), letters={a: 1, b: rsym.Letter(2, minimum=2, maximum=2)})
    check_even(held, y)


def test_a_set_may_be_even_though_its_function_is_not():
    flanks = 1 - y, 1 + y
    check_even(Shape(conjunction(*flanks, 2 - x), (x, y)), y)
    with pytest.raises(RsymError, match="combine what mirrors each other first"):
        check_even(Shape(conjunction(2 - x, *flanks), (x, y)), y)


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: cyclic(ELLIPSE, 0), "integer"),
        (lambda: cyclic(ELLIPSE, a, letters={a: 5}), "integer"),
        (lambda: cyclic(ELLIPSE, 3, axis=z), "axis"),
        (lambda: cyclic(ELLIPSE, 3, motif="odd"), "motif"),
        (lambda: cyclic(ELLIPSE, 3, motif="any", terms=4), "terms"),
        (lambda: cyclic(ELLIPSE, 3, radius=b), "unknown-letter"),
        (lambda: row(DROP, -2), "positive"),
        (lambda: row(DROP, 2, axis=z), "axis"),
        (lambda: row(Shape(1 - x**2 - y, (x, y)), 2, count=3, terms=4), "terms"),
        (lambda: row(Shape(1 - x**2 - y, (x, y)), 2, count=0), "integer"),
        (lambda: grid(DROP, (1, 2, 3)), "grid"),
        (lambda: grid(DROP, (1, 2), counts=(1,)), "grid"),
        (lambda: triangle_wave(x, 0), "positive"),
        (lambda: triangle_wave(x, 1, terms=0), "integer"),
    ],
)
def test_what_is_refused(call, code):
    with pytest.raises(RsymError) as caught:
        call()
    assert caught.value.code == code


TILTED = rsym.ellipse(1, sp.Rational(2, 5)).rotate(sp.Rational(1, 2))


@pytest.mark.parametrize("kind", ["cyclic", "row"])
def test_any_motifs_that_keep_apart_are_as_good_as_their_union(kind):
    if kind == "cyclic":
        made, jumping = (cyclic(TILTED, 5, radius=radius, motif="any", letters={a: 3}) for radius in (3, a))
        copies = [TILTED.translate(3, 0).rotate(2 * sp.pi * k / 5) for k in range(5)]
    else:
        made, jumping = (row(TILTED, period, count=5, motif="any", letters={a: 3}) for period in (3, a))
        copies = [TILTED.translate(3 * k, 0) for k in range(5)]
    union = rsym.disjunction(*copies)
    u, v = points()
    u = u + 6 * (kind == "row")
    assert (made.contains(u, v) == union.contains(u, v)).all()
    assert (made.contains(u, v) == jumping.contains(u, v)).all()
    # The same near the boundary as where the plane is folded.
    near = np.abs(values(jumping, u, v)["value"]) < 0.05
    assert near.sum() > 10
    assert_close(values(made, u, v)["value"][near], values(jumping, u, v)["value"][near], atol=1e-13)
    found = rsym.measure(made, cells=24)
    assert found.area == pytest.approx(5 * np.pi * 0.4, rel=1e-10)
    assert rsym.verify_smoothness(made).verdict == "CERTIFIED"


@pytest.mark.parametrize("motif", [DROP, ~TILTED, TILTED.scale(2), rsym.half_plane((1, 0))])
def test_motifs_that_leave_their_cells_are_cut_off(motif):
    """Half planes, complements, what is too large: the field of the sector, or of the cell, as it was."""
    u, v = points()
    made = cyclic(motif, 5, radius=1, motif="any")
    p, q, _ = in_the_first_sector(u, v, 5)
    assert_close(values(made, u, v)["value"], values(motif, p - 1, q)["value"], atol=1e-12)
    made = row(motif, 2, count=4, motif="any")
    assert_close(values(made, u, v)["value"], values(motif, in_the_nearest_cell(u, 2, 4), v)["value"], atol=1e-12)


@pytest.mark.parametrize("count", [1, 4, 5])
@pytest.mark.parametrize("kind", ["even", "any"])
def test_a_row_about_its_middle(count, kind):
    motif = TILTED if kind == "any" else rsym.ellipse(1, sp.Rational(2, 5))
    plain, centred = (row(motif, a, count=count, centred=one, motif=kind, letters={a: 3}) for one in (False, True))
    u, v = points()
    for period in (3.0, 2.5):
        shift, letters = (count - 1) * period / 2, {"a": period}
        got, same = values(centred, u, v, letters=letters), values(plain, u + shift, v, letters=letters)
        assert_close(got["value"], same["value"], atol=1e-12)
    (left, right), _ = rsym.extent(row(motif, 3, count=count, centred=True, motif=kind))
    assert left == pytest.approx(-right, abs=0.1)


def test_a_grid_about_its_middle():
    made = grid(rsym.disc(1), (3, 4), counts=(2, 3), centred=True)
    for place in [(-1.5, -4), (1.5, 4), (1.5, 0)]:
        assert made.contains(*place)
    assert rsym.measure(made, cells=16).area == pytest.approx(6 * np.pi, rel=1e-9)
    assert not made.contains(0, 0)
    for refused, words in (
        (lambda: row(rsym.disc(1), 3, centred=True), "no middle"),
        (lambda: grid(rsym.disc(1), 3, counts=(2, 2)), "a period for each coordinate"),
    ):
        with pytest.raises(RsymError, match=words):
            refused()
