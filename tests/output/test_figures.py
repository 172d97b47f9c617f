"""Every plot_* alike: what it takes, where it draws, what it returns, and what becomes of it in a file."""

import functools
import inspect
import os
from fractions import Fraction

import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from oracles import reports

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.output.looks import Look
from rsym.output.pictures import write_picture
from rsym.surfaces import sphere_octant

DISC = Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-1.5, 1.5)))
BALL = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
R = sp.Symbol("r", real=True)
ROUND = Shape(R**2 - x**2 - y**2, (x, y), letters={R: 1}, bounds=((-3, 3), (-3, 3)))
OVAL = Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
ROOF = Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2)))

# Of all plot_*: what is drawn, where ("ax", "ax3d": axes, and the artist or the whole figure comes back; "figure": a
# figure or a part of one), what comes back, and which of the words for the look it takes.
TABLE = {
    "plot_atlas": ("ax", Figure, {"levels", "limits", "colour_map"}),
    "plot_continuity": ("ax3d", Artist, {"colour_by"}),
    "plot_curvature_comb": ("ax", Artist, {"limits", "colour_map"}),
    "plot_deformation": ("ax", Artist, {"levels", "limits", "title", "colour_map"}),
    "plot_designs": ("figure", Figure, {"limits", "titles"}),
    "plot_fairness": ("figure", Figure, {"limits"}),
    "plot_field": ("ax", Artist, {"levels", "limits", "title", "colour_map", "outside"}),
    "plot_fields": ("figure", Figure, {"levels", "limits", "titles", "colour_map", "outside"}),
    "plot_fit": ("ax", Artist, {"limits", "colour_map"}),
    "plot_gallery": ("figure", Figure, {"limits", "titles", "colour_map"}),
    "plot_image": ("ax", Artist, set()),
    "plot_mesh": ("ax3d", Artist, {"limits", "colour_map", "colour_by"}),
    "plot_modes": ("figure", Figure, {"limits", "titles", "colour_map"}),
    "plot_patches": ("ax3d", Artist, {"limits", "colour_map", "colour_by"}),
    "plot_repair": ("figure", Figure, {"titles"}),
    "plot_sections": ("ax", Artist, {"limits", "colour_map"}),
    "plot_sensitivity": ("ax", Artist, {"limits", "colour_map"}),
    "plot_sweep": ("figure", Figure, {"levels", "limits", "titles", "colour_map", "outside"}),
    "plot_torsion": ("ax", Artist, {"limits", "title", "colour_map"}),
    "plot_verdict": ("ax", Figure, {"colour_by"}),
}
WORDS = {"levels", "limits", "title", "titles", "colour_map", "outside", "colour_by"}


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def pixels_of(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


@functools.cache
def atlas():
    a, b = sp.symbols("a b", real=True)
    letters = {a: rsym.Letter(1, minimum=Fraction(1, 2), maximum=2), b: rsym.Letter(0, minimum=-1, maximum=1)}
    shape = Shape(a**2 - (x - b) ** 2 - y**2, (x, y), letters=letters, bounds=((-4, 4), (-4, 4)))
    return rsym.smoothness_atlas(shape, "a", "b")


@pytest.fixture(scope="module")
def pictures():
    """A call of each plot_*, to which the place is given; what is drawn is made once, when it is first asked for."""
    body = functools.cache(lambda: rsym.mesh(BALL, 16))
    stack = functools.cache(lambda: rsym.sections(BALL, [-0.5, 0.0, 0.5], resolution=24))
    designs = {"small": {"r": 1}, "large": {"r": 2}}
    table = functools.cache(lambda: rsym.compare_designs(ROUND, designs, tolerance=0.1))
    repaired = functools.cache(lambda: rsym.repair(ROOF, moves=["round"], radius=0.1))
    fair = functools.cache(lambda: rsym.fairness(OVAL, tolerance=0.1))
    octant = sphere_octant(1.0)
    fitted = functools.cache(lambda: rsym.fit(ROUND, [[2, 0], [0, 2.1], [-1.9, 0], [0, -2]], letters=["r"]))
    moving = functools.cache(lambda: rsym.sensitivity(ROUND, "r", resolution=32))
    held = {...: rsym.fixed()}
    pressed = functools.cache(lambda: rsym.elasticity(OVAL, held, young=1, poisson=0.3, loads=(0, -1), cells=8))
    drum = functools.cache(lambda: rsym.modes(rsym.disc(1), 2, cells=8))
    twisted = functools.cache(lambda: rsym.torsion(rsym.disc(1), cells=8))
    return {
        "plot_atlas": lambda **place: rsym.plot_atlas(atlas(), **place),
        "plot_continuity": lambda **place: rsym.plot_continuity([octant, octant], resolution=6, **place),
        "plot_curvature_comb": lambda **place: rsym.plot_curvature_comb(OVAL, resolution=32, **place),
        "plot_deformation": lambda **place: rsym.plot_deformation(pressed(), resolution=24, **place),
        "plot_designs": lambda **place: rsym.plot_designs(table(), **place),
        "plot_fairness": lambda **place: rsym.plot_fairness(fair(), **place),
        "plot_field": lambda **place: rsym.plot_field(DISC, resolution=24, **place),
        "plot_fields": lambda **place: rsym.plot_fields(DISC, ("value", "laplacian"), resolution=24, **place),
        "plot_fit": lambda **place: rsym.plot_fit(fitted(), resolution=32, **place),
        "plot_gallery": lambda **place: rsym.plot_gallery({"disc": DISC, "ball": BALL}, resolution=16, **place),
        "plot_image": lambda **place: rsym.plot_image(rsym.render(BALL, size=(60, 40)), **place),
        "plot_mesh": lambda **place: rsym.plot_mesh(body(), **place),
        "plot_modes": lambda **place: rsym.plot_modes(drum(), resolution=24, **place),
        "plot_patches": lambda **place: rsym.plot_patches(octant, resolution=6, **place),
        "plot_repair": lambda **place: rsym.plot_repair(repaired(), **place),
        "plot_sections": lambda **place: rsym.plot_sections(stack(), **place),
        "plot_sensitivity": lambda **place: rsym.plot_sensitivity(moving(), **place),
        "plot_sweep": lambda **place: rsym.plot_sweep(ROUND, "r", [1, 2], resolution=24, **place),
        "plot_torsion": lambda **place: rsym.plot_torsion(twisted(), resolution=24, **place),
        "plot_verdict": lambda **place: rsym.plot_verdict(reports.undecided_disc(), DISC, resolution=24, **place),
    }


def test_the_table_has_every_plot_and_every_word_it_takes():
    assert set(TABLE) == {name for name in rsym.__all__ if name.startswith("plot_")}
    for name, (place, _, words) in TABLE.items():
        taken = set(inspect.signature(getattr(rsym, name)).parameters)
        assert taken & WORDS == words, name
        assert taken & {"ax", "figure"} == {place.removesuffix("3d")}, name
        assert getattr(rsym, name).__doc__.count("Returns\n") == 1, name


@pytest.mark.random
@pytest.mark.parametrize("name", TABLE)
def test_a_picture_is_drawn_where_it_is_told_and_pyplot_is_left_alone(name, pictures):
    place, kind, _ = TABLE[name]
    figure = Figure((9, 5), dpi=50, layout="constrained")
    left = figure.subfigures(1, 2)[0]
    given = {
        "ax": lambda: left.add_subplot(),
        "ax3d": lambda: left.add_subplot(projection="3d"),
        "figure": lambda: left,
    }[place]()
    answer = pictures[name](**{place.removesuffix("3d"): given})
    assert isinstance(answer, kind)
    assert (answer if kind is Figure else answer.get_figure(root=True)) is figure
    assert matplotlib.pyplot.get_fignums() == []
    assert tuple(figure.get_size_inches()) == (9, 5)
    image = pixels_of(figure)
    assert image[:, :225].min() < 128
    assert image[:, 235:].min() == 255, "nothing is drawn beside it"


@pytest.mark.parametrize("name", [name for name, (place, _, _) in TABLE.items() if place == "figure"])
def test_figures_that_are_none(name, pictures):
    with pytest.raises(RsymError, match="SubFigure"):
        pictures[name](figure=3)


@pytest.mark.random
@pytest.mark.parametrize("name", [name for name, (_, _, words) in TABLE.items() if "colour_map" in words])
def test_colour_maps_and_limits_are_taken_and_refused(name, pictures):
    options = {"colour_by": "mean_curvature"} if name == "plot_patches" else {}
    if name == "plot_mesh":
        options = {"colour_by": "mean_curvature", "shape": BALL}
    elif name == "plot_fields":
        options = {"limits": {"value": (-2, 1)}}
    drawn = pictures[name](**{"limits": (0.5, 2.0), **options}, colour_map="magma")
    figure = drawn if isinstance(drawn, Figure) else drawn.get_figure()
    maps = [one.get_cmap().name for one in figure.findobj(lambda one: hasattr(one, "get_cmap"))]
    scale = getattr(drawn, "scale", None)
    assert "magma" in [*maps, *([] if scale is None else [scale.get_cmap().name])]
    with pytest.raises(RsymError, match=r"colour map 'viridus'.*'viridis'"):
        pictures[name](**options, colour_map="viridus")
    with pytest.raises(RsymError, match="limits"):
        pictures[name](**{**options, "limits": {"value": (2, 1)} if name == "plot_fields" else (2, 1)})


def test_a_field_of_both_signs_has_zero_at_the_middle_of_its_colours():
    wide = DISC.replace(bounds=((-9, 9), (-9, 9)))  # omega from -80 to 0.5
    artist = rsym.plot_field(wide, resolution=96)
    levels = np.asarray(artist.levels)
    assert isinstance(artist.norm, TwoSlopeNorm)
    assert (levels == 0).any()
    assert (levels > 0).sum() >= 4
    assert (levels < 0).sum() >= 4
    colours = artist.get_cmap()(artist.norm(np.array([-1e-9, 1e-9, levels[0], levels[-1]])))
    assert abs(colours[0] - colours[1]).max() < 0.02
    assert colours[2][2] > colours[2][0] + 0.3, "blue outside"
    assert colours[3][0] > colours[3][2] + 0.2, "red inside"


@pytest.mark.parametrize(("outside", "light"), [("mask", 255), ("dim", 150)])
def test_what_is_outside_is_white_or_pale_and_what_is_inside_chooses_the_levels(outside, light):
    figure = Figure((2, 1.5), dpi=100)
    ax = figure.add_axes((0, 0, 1, 1))
    wide = DISC.replace(bounds=((-9, 9), (-6.75, 6.75)))
    levels = rsym.plot_field(wide, ax=ax, outside=outside, resolution=96).levels
    assert (levels[0] >= 0) == (outside == "mask")
    assert levels[-1] <= 0.6
    assert rsym.plot_field(wide, "gradient_squared", outside=outside, resolution=96).levels[-1] <= 1.2
    image = pixels_of(figure)
    assert image[5, 5].min() >= light
    assert image[75, 100].min() < 128


def test_looks_that_are_none():
    for wrong in ({"outside": "hide"}, {"colour_map": "viridus"}, {"colour_map": 3}):
        with pytest.raises(RsymError):
            Look(**wrong)
    with pytest.raises(RsymError, match="by their names"):
        rsym.plot_fields(DISC, ("value",), levels=[0, 1], resolution=16)
    with pytest.raises(RsymError, match="by their names"):
        rsym.plot_fields(DISC, ("value",), titles={"laplacian": "no panel"}, resolution=16)
    with pytest.raises(RsymError, match="as many as pictures, 2"):
        rsym.plot_gallery({"a": DISC, "b": DISC}, titles=["one"])


def test_titles_levels_and_limits_of_a_sheet_go_by_field():
    figure = rsym.plot_fields(
        DISC,
        ("value", "laplacian"),
        resolution=32,
        titles={"value": "a disc"},
        levels={"value": [-1, 0, 0.25]},
        limits={"laplacian": (-3, -1)},
    )
    first, second = figure.axes[:2]
    assert (first.get_title(), second.get_title()) == ("a disc", r"$\Delta\omega$")
    fills = [next(one for one in ax.collections if one.get_array() is not None) for ax in (first, second)]
    assert list(fills[0].levels) == [-1, 0, 0.25]
    assert (fills[1].levels[0], fills[1].levels[-1]) == (-3, -1)


@pytest.mark.slow
def test_a_sheet_is_less_than_a_megabyte_as_lines_and_the_same_bytes_again(tmp_path):
    figure, again = (rsym.plot_fields(rsym.paper.skeleton_body()) for _ in range(2))
    for suffix, least, most in ((".svg", 2e5, 7e5), (".pdf", 1e5, 4e5), (".eps", 3e5, 1.5e6)):
        path = write_picture(figure, tmp_path / f"sheet{suffix}")
        assert least < os.path.getsize(path) < most
        assert write_picture(again, tmp_path / f"again{suffix}").read_bytes() == path.read_bytes()
    text = (tmp_path / "sheet.svg").read_text()
    assert text.count("<image") == 6  # the fills; lines are lines
    assert (tmp_path / "sheet.eps").read_bytes().startswith(b"%!PS-Adobe-3.0 EPSF")


@pytest.mark.slow
def test_a_body_in_a_format_without_transparency_stands_on_white(tmp_path):
    image = rsym.plot_mesh(rsym.mesh(BALL, 16)).get_figure()
    assert write_picture(image, tmp_path / "ball.eps").stat().st_size > 1e5
    artist = next(one for one in image.axes[0].artists if hasattr(one, "mesh"))
    _, pixels = artist._drawn
    assert (pixels[pixels[..., 3] == 0][:, :3] == 255).all()


def test_the_car_is_seen_from_the_front():
    """The eye stands where the headlights are, at the greater end of y."""
    axes = rsym.plot_mesh(rsym.mesh(BALL, 16)).axes
    assert isinstance(axes, Axes3D)
    assert np.sin(np.radians(axes.azim)) > 0.5
