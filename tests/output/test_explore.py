"""Explorations are driven by setting widgets; what is drawn is held against plain formulas."""

import importlib.util
import os
import sys

import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Letter, RsymError, Shape, x, y, z
from rsym.output.surfaces import ShadedMesh

if importlib.util.find_spec("ipywidgets") is None and not os.environ.get("CI"):
    pytest.skip("ipywidgets is not installed", allow_module_level=True)

r, d = sp.symbols("r d", real=True)
LETTERS = {r: Letter(1, minimum=0.5, maximum=3, unit="mm", doc="radius"), d: 0.25}
EGG = Shape((r**2 - x**2 - y**2) / (2 * r) * (1 + d * x), (x, y), letters=LETTERS, bounds=((-2, 2), (-1.5, 1.5)))
BALL = Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: LETTERS[r]}, bounds=((-1.6, 1.6),) * 3)
STEP = 1e-3  # of central differences


def egg(u, v, radius, tilt):
    return (radius**2 - u**2 - v**2) / (2 * radius) * (1 + tilt * u)


def slope(f, u, v):
    return np.hypot((f(u + STEP, v) - f(u - STEP, v)) / (2 * STEP), (f(u, v + STEP) - f(u, v - STEP)) / (2 * STEP))


def bend(f, u, v):
    return (f(u + STEP, v) + f(u - STEP, v) + f(u, v + STEP) + f(u, v - STEP) - 4 * f(u, v)) / STEP**2


def six_by_differences(radius, tilt):
    """The six fields as functions of u, v, by differences of omega alone."""

    def omega(u, v):
        return egg(u, v, radius, tilt)

    def normalised(u, v):
        return omega(u, v) / np.sqrt(omega(u, v) ** 2 + slope(omega, u, v) ** 2)

    return [
        field
        for f in ((omega, normalised))
        for field in (f, lambda u, v, f=f: slope(f, u, v) ** 2, lambda u, v, f=f: bend(f, u, v))
    ]


ORDER = [0, 3, 1, 4, 2, 5]  # of the panels: omega, omega_n, their squared gradients, their Laplacians


def level_sets(ax):
    return [one for one in ax.collections if type(one).__name__ == "QuadContourSet" and not one.filled]


def boundary(ax):
    (lines,) = [one for one in ax.collections if type(one).__name__ == "LineCollection"]
    return np.concatenate(lines.get_segments()).T


def assert_sheet_shows(figure, radius, tilt):
    """Every level line of every panel lies where the field has that level, the heavy one where omega is 0."""
    fields = six_by_differences(radius, tilt)
    for ax, number in zip(figure.axes[:6], ORDER, strict=True):
        u, v = boundary(ax)
        assert_close(egg(u, v, radius, tilt), np.zeros(len(u)), atol=1e-9)
        (lines,) = level_sets(ax)
        steps, drawn = np.diff(lines.levels), 0
        for level, path in zip(lines.levels, lines.get_paths(), strict=True):
            spacing = steps[0] if level <= 0 else steps[-1]  # each side has its own
            # Where the field changes much within a cell, straight lines between samples are not enough.
            smooth = slope(fields[number], *path.vertices.T) < 10 * spacing if len(path.vertices) else []
            got = fields[number](*path.vertices[smooth].T) if len(path.vertices) else np.zeros(0)
            assert_close(got, np.full(len(got), level), atol=0.1 * spacing)
            drawn += len(got)
        assert drawn > 30


def mesh_of(figure):
    (body,) = [artist for artist in figure.axes[0].artists if isinstance(artist, ShadedMesh)]
    return body.mesh


@pytest.mark.slow
def test_the_sheet_follows_the_letters():
    widget = rsym.explore(EGG)
    assert_sheet_shows(widget.figure, 1.0, 0.25)
    before = widget.picture.value
    widget.letters["r"].value = 1.25
    widget.children[1].value = 0.125
    assert widget.values == {"r": 1.25, "d": 0.125}
    assert_sheet_shows(widget.figure, 1.25, 0.125)
    assert widget.picture.value != before
    assert bytes(widget.picture.value).startswith(b"\x89PNG")
    assert widget.message.value == ""


@pytest.mark.slow
def test_nothing_is_compiled_for_another_letter(monkeypatch):
    widget = rsym.explore(EGG, ("value",), resolution=40)
    widget.view.value = "body"

    def refuse(*arguments, **options):
        raise AssertionError("compiled again")

    for place in ("rsym.backends.kernel.make_function", "rsym.program.fields.lower"):
        monkeypatch.setattr(place, refuse)
    widget.letters["r"].value = 1.5
    widget.view.value = "sheet"
    widget.letters["r"].value = 0.75
    assert widget.message.value == ""


@pytest.mark.slow
def test_panels_and_colour_bars_keep_their_places():
    widget = rsym.explore(EGG, ("value",), resolution=40)
    before = [ax.get_position() for ax in widget.figure.axes]
    for value in (1.5, 1.25):
        widget.letters["r"].value = value
    assert len(widget.figure.axes) == 2
    panel, bar = [ax.get_position() for ax in widget.figure.axes]
    assert_close(panel.bounds, before[0].bounds, atol=1e-12)
    assert_close(bar.x0, before[1].x0, atol=1e-12)
    # Arrows take their room from its ends, and a twentieth of its width with them.
    assert_close([bar.x1, bar.y0, bar.y1], [before[1].x1, before[1].y0, before[1].y1], atol=0.05)


@pytest.mark.slow
def test_sliders_show_range_unit_and_meaning():
    slider, free = rsym.explore(EGG, ("value",), resolution=40).letters.values()
    assert (slider.min, slider.max, slider.description, slider.tooltip) == (0.5, 3, "r [mm]", "radius")
    assert not slider.continuous_update
    assert (free.min, free.max) == (0, 0.5)


@pytest.mark.slow
def test_the_body_of_a_plane_shape():
    disc = Shape((r**2 - x**2 - y**2) / (2 * r), (x, y), letters={r: 1}, bounds=((-2, 2), (-2, 2)))
    widget = rsym.explore(disc, ["value"], axis=y, resolution=40)
    widget.view.value = "body"
    for radius in (1.0, 1.5):
        widget.letters["r"].value = radius
        assert_close(mesh_of(widget.figure).status.volume, 4 / 3 * np.pi * radius**3, rtol=9e-3)
    widget.camera[1].value = 10.0
    assert widget.figure.axes[0].azim == 10
    assert widget.fields.layout.display == "none"


@pytest.mark.slow
def test_a_shape_in_space_and_its_sections():
    widget = rsym.explore(BALL, ("normalised",), resolution=40)
    assert_close(mesh_of(widget.figure).status.volume, 4 / 3 * np.pi, rtol=9e-3)
    widget.view.value = "sheet"
    widget.section[1].value = 0.6
    widget.letters["r"].value = 1.5
    (ax, _) = widget.figure.axes
    assert_close(np.hypot(*boundary(ax)).max(), np.sqrt(1.5**2 - 0.6**2), atol=1e-9)
    widget.section[0].value = "x"
    assert widget.section[1].value == 0
    assert widget.figure.axes[0].get_xlabel() == "$y$"


@pytest.mark.slow
def test_a_bad_letter_is_said_and_the_picture_stays():
    ball = Shape(BALL.expression - 0.5, (x, y, z), letters=BALL.letters, bounds=BALL.bounds)
    widget = rsym.explore(ball, ("normalised",), resolution=40)
    before = widget.picture.value
    widget.letters["r"].value = 0.6
    assert "the surface does not meet the bounds" in widget.message.value
    assert widget.picture.value == before
    widget.letters["r"].value = 1.5
    assert widget.message.value == ""
    assert widget.picture.value != before
    widget.letters["r"].value = 1.8
    assert "leaves the bounds" in widget.message.value


@pytest.mark.slow
def test_reset_and_presets(tmp_path):
    widget = rsym.explore(EGG, ("value",), resolution=40)
    drawn = []
    widget.picture.observe(drawn.append, "value")
    widget.set_letters({"r": 2, "d": 0.5})
    assert len(drawn) == 1
    widget.path.value = str(tmp_path / "egg.json")
    widget.save.click()
    assert rsym.load_letters(tmp_path / "egg.json") == {"r": 2, "d": 0.5}
    widget.reset.click()
    assert widget.values == {"r": 1, "d": 0.25}
    widget.load.click()
    assert widget.values == {"r": 2, "d": 0.5}
    (tmp_path / "egg.json").write_text('{"r": 99}')
    widget.load.click()
    assert "[0.5, 3]" in widget.message.value
    assert widget.values["r"] == 2
    with pytest.raises(RsymError, match="no letter 'q'"):
        widget.set_letters({"q": 1})


@pytest.mark.slow
def test_pyplot_is_left_alone():
    before = matplotlib.pyplot.get_fignums()
    rsym.explore(EGG, ("value",), resolution=40).view.value = "body"
    assert matplotlib.pyplot.get_fignums() == before


@pytest.mark.slow
def test_bounds_that_are_found():
    disc = Shape(r - x**2 - y**2, (x, y), letters={r: LETTERS[r]})
    for shape, other in ((disc, "body"), (rsym.revolve(disc), "sheet")):
        widget = rsym.explore(shape, ("value",), resolution=24)
        assert widget.message.value == ""
        widget.view.value = other
        assert widget.message.value == ""


def test_a_missing_package_and_missing_bounds(monkeypatch):
    with pytest.raises(RsymError, match="bounds"):
        rsym.explore(Shape(x, (x, y)))
    for name in [name for name in sys.modules if name.startswith(("ipywidgets", "rsym.output.explorer"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with pytest.raises(RsymError, match=r'pip install "rsym\[notebook\]"') as caught:
        rsym.explore(EGG)
    assert caught.value.code == "missing-package"


@pytest.mark.parametrize("resolution", [(10, 20), 1, "fine"])
def test_a_resolution_that_is_no_number_of_cells_is_refused(resolution):
    with pytest.raises(rsym.RsymError) as caught:
        rsym.explore(rsym.paper.skeleton_body(), resolution=resolution)
    assert caught.value.code == "resolution"
