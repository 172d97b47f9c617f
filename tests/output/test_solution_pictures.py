"""Pictures of solutions: named boundaries, sheets of modes, stress lines."""

import functools
import operator

import matplotlib.figure
import numpy as np
import pytest
import sympy as sp
from matplotlib.collections import LineCollection

import rsym
from rsym import x, y
from rsym.output.boundaries import part_lines
from rsym.output.panels import colour_bar
from rsym.sampling.plane import plane_sampler


@pytest.fixture
def ax():
    return matplotlib.figure.Figure().add_subplot()


RING = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
r = sp.Symbol("r", real=True)
# (r^2 - x^2 - y^2)/4 on a disc of the radius r.
ROUND = rsym.solve(
    rsym.disc(r, letters={r: rsym.Letter(1, minimum=0.5, maximum=3)}).named("rim"), "-laplacian(u) = 1", 0, cells=6
)
HALF = rsym.disc(1).named("rim") & rsym.Shape(y, (x, y)).named("edge")


def test_parts_of_a_boundary_end_at_its_corners():
    lines = part_lines(plane_sampler(HALF, "value", resolution=64))
    (rim,), (edge,) = lines["rim"], lines["edge"]
    np.testing.assert_allclose(np.hypot(*rim.T), 1, atol=1e-9)
    np.testing.assert_allclose(edge[:, 1], 0, atol=1e-12)
    ends = sorted(map(tuple, np.concatenate([rim[[0, -1]], edge[[0, -1]]]).round(9) + 0.0))
    assert ends == [(-1, 0), (-1, 0), (1, 0), (1, 0)]


def test_a_part_without_a_name_has_none():
    plate = rsym.rectangle(2, 2) - rsym.disc(0.5).named("hole")
    assert set(part_lines(plane_sampler(plate, "value", resolution=32))) == {"", "hole"}


def test_a_solution_is_drawn_with_its_parts_named(ax):
    u = rsym.solve(RING, "-laplacian(u) = 1", {"rim": 0, "bore": rsym.robin(1)}, cells=8)
    rsym.plot_field(u, ax=ax, resolution=48)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["rim", "bore"]
    named = {one.get_label(): one for one in ax.collections if one.get_label() in ("rim", "bore")}
    (bore,) = named["bore"].get_segments()
    np.testing.assert_allclose(np.hypot(*bore.T), 0.5, atol=1e-9)
    assert tuple(named["rim"].get_color()[0]) != tuple(named["bore"].get_color()[0])


def test_a_shape_and_a_boundary_of_one_part_have_no_legend(ax):
    rsym.plot_field(RING, ax=ax, resolution=24)
    assert ax.get_legend() is None
    rsym.plot_field(rsym.solve(rsym.disc(1).named("rim"), "-laplacian(u) = 1", 0, cells=6), ax=ax, resolution=24)
    assert ax.get_legend() is None


def test_a_colour_bar_has_arrows_where_values_lie_beyond(ax):
    """1 - r^2 is from 0 to 1; its slope, and what it goes on to beside the disc, are not asked."""
    u = rsym.solve(rsym.disc(1), "-laplacian(u) = 4", 0, cells=6)
    assert rsym.plot_field(u, ax=ax, resolution=40).extend == "neither"
    for limits, ends in (((0, 0.5), "max"), ((0.1, 1), "min"), ((0.1, 0.5), "both"), ((-1, 2), "neither")):
        assert rsym.plot_field(u, ax=ax, limits=limits, resolution=40).extend == ends
    assert rsym.plot_field(u.shape, ax=ax, limits=(0, 1), resolution=40).extend == "min"
    # The last picture of a sweep is within the levels, but the bar is that of both: omega is up to r/2.
    look = {"limits": (0, 0.6), "outside": "mask", "resolution": 40, "bounds": ((-2.5, 2.5), (-2.5, 2.5))}
    figure = rsym.plot_sweep(ROUND.shape, r, [2, 1], figure=matplotlib.figure.Figure(), **look)
    assert [contours(one).extend for one in figure.axes[:2]] == ["max", "max"]


def test_levels_hold_all_values_of_a_solution_and_are_told_apart():
    ax = matplotlib.figure.Figure().add_subplot()
    for low, high in ((0, 1), (-1, 1), (100, 100.0001)):
        u = rsym.solve(RING, "-laplacian(u) = 0", {"rim": low, "bore": high}, cells=6)
        artist = rsym.plot_field(u, ax=ax, resolution=40)
        assert artist.levels[0] <= low + 1e-9
        assert artist.levels[-1] >= high - 1e-9
        assert not np.signbit(artist.levels[artist.levels == 0]).any()
        texts = [text.get_text() for text in colour_bar(artist, ax).ax.get_yticklabels()]
        assert len(set(texts)) == len(texts) > 4


def test_modes_have_symmetric_levels_and_their_eigenvalues():
    drum = rsym.modes(rsym.rectangle(2, 1), 5, cells=8)
    figure = rsym.plot_modes(drum, figure=matplotlib.figure.Figure(), resolution=32)
    shown = [axes for axes in figure.axes if axes.axison]
    assert [axes.get_title() for axes in shown] == [
        rf"$\lambda_{{{k}}} = {value:.4g}$" for k, value in enumerate(drum.values, 1)
    ]
    assert len(figure.axes) - len(shown) == 1
    for axes, mode in zip(shown, drum.modes, strict=True):
        levels = axes.collections[0].levels
        np.testing.assert_allclose(levels, -levels[::-1])
        # Modes are sines of the mean square 1: at most 2 sqrt(2)/2.
        assert levels[-1] == pytest.approx(abs(mode.maximum().value), rel=0.05)
        assert axes.get_aspect() == 1


def test_stress_lines_are_equally_spaced_levels_and_colours_the_stress(ax):
    shaft = rsym.torsion(rsym.disc(1), cells=8)
    artist = rsym.plot_torsion(shaft, ax=ax, lines=4, resolution=64)
    assert ax.get_title() == r"$J = 1.571$"
    # u = (1 - r^2)/2, |grad u| = r.
    assert artist.levels[0] == 0
    assert artist.levels[-1] == pytest.approx(1, rel=0.11)
    lines = ax.collections[-1]
    assert not isinstance(lines, LineCollection)
    np.testing.assert_allclose(lines.levels, 0.5 * np.arange(1, 5) / 5, rtol=2e-3)


@pytest.mark.parametrize("draw", [rsym.plot_modes, rsym.plot_torsion, rsym.plot_deformation])
def test_what_is_no_answer_is_refused(draw):
    with pytest.raises(rsym.RsymError, match="expected"):
        draw(rsym.Shape(1 - x**2 - y**2, (x, y)))


def test_a_body_is_drawn_where_its_points_have_come_to(ax):
    # A ring under the pressure 1 from within, held by its rim: the displacement is radial, a*r + b/r.
    ring = rsym.elasticity(RING, {"rim": 0, "bore": rsym.pressure(1)}, young=1, poisson=0.3, cells=10)
    artist = rsym.plot_deformation(ring, ax=ax, scale=0.5, resolution=64)
    rest, bent = (one.get_segments() for one in ax.collections if isinstance(one, LineCollection))
    (bore,) = [line for line in bent if np.hypot(*line[0]) < 0.9]
    grown = 0.5 + 0.5 * float(ring(0.5 + 1e-9, 0)[0])
    np.testing.assert_allclose(np.hypot(*bore.T), grown, atol=1e-3)
    assert min(np.hypot(*line.T).max() for line in rest) == pytest.approx(0.5, abs=1e-9)
    assert artist.levels[0] == 0
    assert artist.levels[-1] == pytest.approx(float(ring.von_mises(0.5 + 1e-9, 0)), rel=0.2)
    assert ax.get_title() == "displacements × 0.5"


SIDES = (6 - x, 6 + x, 4 - y, 4 + y)
SHEET = functools.reduce(
    operator.and_,
    (rsym.Shape(side, (x, y)).named(name) for side, name in zip(SIDES, "right left top foot".split(), strict=True)),
)


def test_colours_reach_the_peak_of_the_stress(ax):
    """Beside a round hole it is three times that of the sheet, on a two hundredth of it."""
    holed = SHEET - rsym.disc(sp.Rational(1, 2))
    pulled = rsym.elasticity(holed, {"left": 0, "right": rsym.pressure(-1)}, young=1, poisson=0.3, cells=16)
    artist = rsym.plot_deformation(pulled, ax=ax, resolution=128)
    inside = pulled.von_mises(*(np.linspace(-0.7, 0.7, 141)[:, None], np.linspace(-0.7, 0.7, 141)))
    assert np.nanmax(inside) > 2
    assert artist.levels[-1] > 0.9 * np.nanmax(inside)
    assert artist.extend == "neither"


def test_colours_end_before_what_has_no_bound(ax):
    angle = SHEET - rsym.rectangle(8, 6).translate(3, 2)
    twisted = rsym.torsion(angle, cells=10)
    artist = rsym.plot_torsion(twisted, ax=ax, resolution=64)
    assert artist.extend == "max"
    convex = rsym.plot_torsion(rsym.torsion(rsym.rectangle(3, 1), cells=8), ax=ax, resolution=64)
    assert convex.extend == "neither"
    assert convex.levels[-1] > 0.94


def test_a_solution_shows_itself_in_a_notebook():
    u = rsym.solve(RING, "-laplacian(u) = 1", {"rim": 0, "bore": rsym.robin(1)}, cells=8)
    text = u._repr_html_()
    assert "<svg" in text
    assert "&lt;Solution of" in text
    assert len(text) < 60_000
    level = rsym.solve(rsym.disc(1), "-laplacian(u) = 0", 1, cells=6)
    assert "<svg" in level._repr_html_()


def contours(axes):
    return next(one for one in axes.collections if type(one).__name__ == "QuadContourSet")


def test_the_sheet_of_a_solution_has_its_own_fields():
    figure = rsym.plot_fields(ROUND, figure=matplotlib.figure.Figure(), resolution=40)
    value, slope = figure.axes[:2]
    assert [value.get_title(), slope.get_title()] == ["$u$", r"$|\nabla u|^2$"]
    # |grad u|^2 = r^2/4: from 0 to 1/4 inside, which alone chooses the levels.
    assert contours(slope).levels[-1] == pytest.approx(0.25, abs=0.03)
    assert contours(value).levels[-1] == pytest.approx(0.25, abs=0.03)
    every = rsym.plot_fields(ROUND, ["laplacian"], figure=matplotlib.figure.Figure(), resolution=16)
    assert every.axes[0].get_title() == r"$\Delta u$"
    with pytest.raises(rsym.RsymError, match=r"no field 'normalised'.*gradient_squared"):
        rsym.plot_fields(ROUND, ["normalised"], figure=matplotlib.figure.Figure(), resolution=16)


def test_level_lines_of_the_fields_of_a_solution():
    (ring,) = rsym.level_lines(ROUND, 0.09, field="gradient_squared", resolution=40)
    np.testing.assert_allclose(np.hypot(*ring.T), 0.6, atol=1e-9)
    half = rsym.disc(1).named("wall") & rsym.half_plane((0, 1), 0)
    turned = rsym.solve(half, "-laplacian(u) = 6", {"wall": 0}, axis=x, cells=6)
    found = turned.sampled(np.array([0.3, 0.2]), np.array([0.0, 0.5]), field="laplacian")["value"]
    np.testing.assert_allclose(found, -6, atol=1e-6)


def test_a_sweep_solves_anew_and_compiles_nothing(monkeypatch):
    rsym.plot_sweep(ROUND, "r", [0.75], figure=matplotlib.figure.Figure(), resolution=30)

    def refuse(*arguments, **options):
        raise AssertionError("compiled again")

    monkeypatch.setattr("rsym.backends.kernel.make_function", refuse)
    radii = [0.75, 1.25, 2]
    figure = rsym.plot_sweep(ROUND, "r", radii, figure=matplotlib.figure.Figure(), resolution=30)
    axes = figure.axes[:3]
    assert [one.get_title() for one in axes] == ["$r = 0.75$", "$r = 1.25$", "$r = 2$"]
    for one, radius in zip(axes, radii, strict=True):
        lines = [part for part in one.collections if isinstance(part, LineCollection)]
        np.testing.assert_allclose(np.hypot(*np.concatenate(lines[0].get_segments()).T), radius, atol=1e-9)
        assert one.get_xlim()[0] < -2  # all see what the largest needs
        assert contours(one).levels.tolist() == contours(axes[0]).levels.tolist()
    assert contours(axes[0]).levels[-1] == pytest.approx(1, abs=0.1)  # r^2/4 of the largest
    with pytest.raises(rsym.RsymError, match="r"):
        rsym.plot_sweep(ROUND, "r", [4], figure=matplotlib.figure.Figure(), resolution=16)


def test_a_sweep_has_one_legend_of_its_parts_and_a_sweep_of_a_mode_is_refused():
    holed = rsym.disc(1).named("rim") - rsym.disc(r, letters={r: 0.3}).named("bore")
    u = rsym.solve(holed, "-laplacian(u) = 1", {"rim": 0, "bore": rsym.robin(1)}, cells=8)
    figure = rsym.plot_sweep(u, r, [0.3, 0.5], figure=matplotlib.figure.Figure(layout="compressed"), resolution=24)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["rim", "bore"]
    assert not any(one.get_legend() for one in figure.axes)
    drum = rsym.modes(holed, 1, cells=6)
    with pytest.raises(rsym.RsymError, match="ask modes of other letters"):
        rsym.plot_sweep(drum.modes[0], r, [0.3], figure=matplotlib.figure.Figure(), resolution=24)


def test_a_gallery_refuses_a_solution_in_space():
    solution = rsym.solve(rsym.sphere(1), "-laplacian(u) = 6", 0, cells=4, degree=2)
    with pytest.raises(rsym.RsymError, match="ball: a solution in space has no portrait"):
        rsym.plot_gallery({"ball": solution})


def test_a_gallery_shows_solutions_beside_shapes():
    figure = rsym.plot_gallery({"u": ROUND, "shape": RING}, figure=matplotlib.figure.Figure(figsize=(4, 2)))
    solution, shape = (contours(one) for one in figure.axes)
    assert solution.levels[0] == 0
    assert solution.levels[-1] == pytest.approx(0.25, abs=0.03)
    assert shape.levels[0] < 0
    with pytest.raises(rsym.RsymError, match="expected a Shape, got Solution"):
        rsym.cards({"u": ROUND})


@pytest.mark.parametrize("ask", [rsym.compile, rsym.to_jax, rsym.render, rsym.extent, lambda u: rsym.sample(u, 9)])
def test_what_makes_no_sense_of_a_solution_says_what_does(ask):
    with pytest.raises(rsym.RsymError, match=r"expected a Shape, got Solution.*its \.shape is one"):
        ask(ROUND)


def test_coordinates_that_are_none_are_refused_as_by_kernels():
    for coordinates, words in ((("a", 0), "real arrays, got str"), (([1, 2], [1, 2, 3]), "do not broadcast")):
        with pytest.raises(rsym.RsymError, match=words):
            ROUND(*coordinates)
    with pytest.raises(rsym.RsymError, match="plot_modes draws it"):
        rsym.plot_field(rsym.modes(rsym.disc(1), 1, cells=4, degree=2))


def test_a_shaft_is_drawn_and_swept_as_its_function_is():
    tube = rsym.torsion(rsym.disc(1) - rsym.disc(r, letters={r: 0.5}), cells=12)
    with pytest.raises(rsym.RsymError, match=r"torsion\.with_letters"):
        tube.solution.with_letters({"r": 0.25})
    figure = rsym.plot_sweep(tube, r, [0.25, 0.5], figure=matplotlib.figure.Figure(), resolution=24)
    # (1 - s^2)/2 at the distance s from the middle, (1 - r^2)/2 on the bore.
    assert contours(figure.axes[0]).levels[-1] == pytest.approx((1 - 0.25**2) / 2, abs=0.04)
    (half,) = rsym.level_lines(tube, 0.32, resolution=40)
    np.testing.assert_allclose(np.hypot(*half.T), 0.6, atol=1e-6)
