import matplotlib.figure
import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.output.looks import robust_levels

DISC = Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-1.5, 1.5)))


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def boundary_of(ax):
    (lines,) = [c for c in ax.collections if type(c).__name__ == "LineCollection"]
    return np.concatenate(lines.get_segments())


def test_the_sheet_has_six_panels_with_titles_labels_and_the_boundary():
    figure = rsym.plot_fields(DISC, resolution=48)
    panels = figure.axes[:6]
    assert [ax.get_title() for ax in panels] == [
        r"$\omega$",
        r"$\omega_n$",
        r"$(\nabla\omega)^2$",
        r"$(\nabla\omega_n)^2$",
        r"$\Delta\omega$",
        r"$\Delta\omega_n$",
    ]
    for ax in panels:
        assert ax.get_aspect() == 1
        assert np.abs(np.hypot(*boundary_of(ax).T) - 1).max() < 1e-9
    assert panels[4].get_xlabel() == "$x$"
    assert panels[0].get_ylabel() == "$y$"


@pytest.mark.slow
def test_tall_bounds_take_three_columns_and_colour_bars_are_as_tall_as_panels():
    tall = DISC.replace(bounds=((-1.5, 1.5), (-4, 4)))
    figure = rsym.plot_fields(tall, resolution=48)
    assert figure.axes[0].get_subplotspec().get_gridspec().get_geometry() == (2, 3)
    figure.canvas.draw()
    panel, bar = figure.axes[0].get_window_extent(), figure.axes[6].get_window_extent()
    assert 0.8 < bar.height / panel.height < 1.1


def test_given_axes_are_used_and_pyplot_is_left_alone():
    before = matplotlib.pyplot.get_fignums()
    ax = matplotlib.figure.Figure().add_subplot()
    artist = rsym.plot_field(DISC, "laplacian", ax=ax, resolution=32)
    assert artist.axes is ax
    assert matplotlib.pyplot.get_fignums() == before


def test_levels_are_those_asked_for():
    artist = rsym.plot_field(DISC, levels=[-1, 0, 0.25], resolution=32)
    assert artist.levels.tolist() == [-1, 0, 0.25]
    band = [path for path in artist.get_paths() if len(path.vertices)][2]  # below -1, -1 to 0, 0 to 0.25, above
    radius = np.hypot(*band.vertices.T)
    assert abs(radius.max() - 1) < 0.02
    assert abs(radius.min() - np.sqrt(0.5)) < 0.02


def test_a_singular_spot_does_not_flatten_the_picture():
    values = np.append(np.random.default_rng(0).normal(size=10_000), [1e12, -1e12, np.nan])
    levels = robust_levels(values)
    assert -4 < levels.min() < -1
    assert 1 < levels.max() < 4
    assert len(robust_levels(np.full(5, 3.0))) > 2


@pytest.mark.filterwarnings("ignore:omega has no value:rsym.RsymWarning")
def test_undefined_points_are_hatched():
    half = Shape(sp.sqrt(x) - y, (x, y), bounds=((-1, 1), (-1, 1)))
    ax = rsym.plot_field(half, resolution=32).axes
    assert [patch.get_hatch() for patch in ax.patches] == ["////"]
    assert not rsym.plot_field(DISC, resolution=32).axes.patches


def test_a_section_names_its_own_axes():
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1, 1),) * 3)
    ax = rsym.plot_field(ball, section={x: 0.6}, resolution=48).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$y$", "$z$")
    assert np.abs(np.hypot(*boundary_of(ax).T) - 0.8).max() < 1e-9


@pytest.mark.parametrize(
    "call",
    [
        lambda: rsym.plot_field(DISC, "gradient"),
        lambda: rsym.plot_field(DISC, levels=[1, 0]),
        lambda: rsym.plot_field(Shape(x + y + z, (x, y, z), bounds=((-1, 1),) * 3)),
        lambda: rsym.plot_fields(Shape(x, (x, y))),
        lambda: rsym.plot_field(Shape(sp.sqrt(-1 - x**2) + y, (x, y), bounds=((-1, 1),) * 2)),
    ],
)
def test_bad_input(call):
    with pytest.raises(RsymError):
        call()


def test_one_field_by_its_name_alone_is_one_step():
    disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    seen = []
    rsym.plot_fields(disc, "value", resolution=16, progress=lambda *step: seen.append(step))
    assert {total for _, total in seen} == {1}
    assert seen[-1] == (1, 1)


@pytest.mark.parametrize(
    "axes",
    ["x", 3, matplotlib.figure.Figure(), matplotlib.figure.Figure().subfigures(), np.array([None])],
    ids=lambda one: type(one).__name__,
)
def test_what_nothing_is_drawn_on_is_refused(axes):
    disc = rsym.disc(1)
    stack = rsym.sections(rsym.sphere(1), [0], resolution=16)
    for draw in (
        lambda: rsym.plot_field(disc, ax=axes, resolution=8),
        lambda: rsym.plot_curvature_comb(disc, ax=axes, resolution=32),
        lambda: rsym.plot_sections(stack, ax=axes),
    ):
        with pytest.raises(RsymError, match="ax must be an Axes") as caught:
            draw()
        assert caught.value.code == "axes"


@pytest.mark.parametrize("limits", [None, (-1e308, 1e308)])
def test_values_that_matplotlib_cannot_fill_are_refused_with_the_remedy(limits):
    steep = rsym.Shape(sp.exp(1000 * x) - 1, (x, y), bounds=((-2, 2), (-2, 2)))
    with pytest.raises(RsymError, match=r"cannot be drawn.*limits=\(-1, 1\)"):
        rsym.plot_field(steep, limits=limits, resolution=40)
    rsym.plot_field(steep, limits=(-1, 1), resolution=40)


@pytest.mark.parametrize("fields", [None, 3])
def test_fields_that_are_no_names_are_refused(fields):
    for ask in (rsym.compile, rsym.lambdify, rsym.plot_fields):
        with pytest.raises(RsymError, match="field"):
            ask(rsym.disc(1), fields)
