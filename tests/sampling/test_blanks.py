"""Pictures of nothing say so, at the line that asked; what does not fit is refused before it is begun."""

import warnings

import matplotlib.figure
import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, RsymWarning, Shape, cli, x, y, z
from rsym.sampling import memory, mesher, plane

AWAY = Shape(1 - (x - 9) ** 2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
BALL = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def axes():
    return matplotlib.figure.Figure().add_subplot()


def told(call):
    """The one warning of a call, which points here."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RsymWarning)
        call()
    (one,) = [warning for warning in caught if issubclass(warning.category, RsymWarning)]
    assert one.filename == __file__
    return str(one.message)


LETTER = sp.Symbol("r", real=True)
GROWING_BALL = Shape(LETTER - x**2 - y**2 - z**2, (x, y, z), letters={LETTER: 1})
GROWING = Shape(LETTER**2 - (x - 9) ** 2 - y**2, (x, y), letters={LETTER: 1}, bounds=((-2, 2), (-2, 2)))


@pytest.mark.random
@pytest.mark.parametrize(
    ("call", "seen", "remedy"),
    [
        (lambda: rsym.plot_field(AWAY, ax=axes(), resolution=16), "negative all over", "bounds=((7.98, 10.02)"),
        (lambda: rsym.plot_field(AWAY, "laplacian", ax=axes(), resolution=16), "no boundary in the bounds", "7.98"),
        (lambda: rsym.plot_field(~AWAY, ax=axes(), resolution=16), "positive all over", "bounds=((7.98, 10.02)"),
        (lambda: rsym.plot_fields(AWAY, ("value",), resolution=16), "((-2, 2), (-2, 2))", "bounds=((7.98, 10.02)"),
        (
            lambda: rsym.plot_field(BALL, section={z: 1.5}, ax=axes(), resolution=16),
            "no boundary in the section z = 1.5",
            "z between -1.02 and 1.02",
        ),
        (
            lambda: rsym.plot_field(rsym.cylinder().replace(bounds=BALL.bounds), section={z: 7}, ax=axes()),
            "z = 7",
            "between",
        ),
        (
            lambda: rsym.plot_field(
                Shape(1 - x**2 - y**2, (x, y, z), bounds=BALL.bounds), section={z: 7}, ax=axes(), resolution=16
            ),
            "the section z = 7 lies outside the bounds of the shape",
            "z between -2 and 2",
        ),
        (
            lambda: rsym.plot_field(Shape(1 + x**2, (x, y), bounds=AWAY.bounds), ax=axes(), resolution=16),
            "positive all over",
            "there is none anywhere",
        ),
        (
            lambda: rsym.plot_field(Shape(sp.Max(0, x - 5), (x, y), bounds=AWAY.bounds), ax=axes(), resolution=16),
            "omega is 0 all over",
            "other bounds",
        ),
        (
            lambda: rsym.plot_field(Shape(sp.sqrt(x) - y, (x, y), bounds=((-3, 1), (-1, 1))), ax=axes()),
            "omega has no value in 75 % of the bounds, as near (-1.49, 0), where x is negative",
            "",
        ),
        (lambda: rsym.plot_sweep(GROWING, LETTER, [1], resolution=16), "r = 1: no boundary", "7.98"),
        (lambda: rsym.plot_gallery({"far away": AWAY}), "far away: no boundary in the bounds", "7.98"),
    ],
)
def test_a_picture_of_nothing_says_so_and_where_to_look(call, seen, remedy):
    message = told(call)
    assert seen in message
    assert remedy in message.partition("remedy: ")[2]


@pytest.mark.parametrize(
    "shape",
    [
        AWAY.replace(bounds=((7, 11), (-2, 2))),
        Shape(sp.sqrt(x) - y, (x, y), bounds=((0, 1), (-1, 1))),
    ],
)
def test_a_picture_of_something_says_nothing(shape):
    with warnings.catch_warnings():
        warnings.simplefilter("error", RsymWarning)
        rsym.plot_field(shape, ax=axes(), resolution=32)


@pytest.mark.parametrize(
    "shape",
    [
        rsym.circle().replace(bounds=((-2, 2), (-2, 2))),  # a curve: nowhere negative, and zero between samples
        Shape((x**2 + y**2 - 1) ** 2, (x, y), bounds=((-2, 2), (-2, 2))),
    ],
)
def test_of_a_boundary_without_a_change_of_sign_no_line_is_drawn_and_that_is_told(shape):
    places = told(lambda: rsym.plot_field(shape, ax=axes(), resolution=32)).partition("near (")[2].partition(") and")[0]
    points = np.array([[float(number) for number in place.split(", ")] for place in places.split("), (")])
    assert len(points) == 5
    assert_close(np.hypot(*points.T), np.ones(5), atol=0.005)


def test_the_bounds_that_are_named_hold_the_boundary():
    message = told(lambda: rsym.plot_field(AWAY, ax=axes(), resolution=16))
    ends = sp.sympify(message.partition("bounds=(")[2].partition(", where")[0][:-1])
    assert len(rsym.level_lines(AWAY, bounds=[tuple(map(float, end)) for end in ends], resolution=32)) == 1


def test_a_mesh_of_nothing_names_the_bounds_of_something():
    with pytest.raises(RsymError) as caught:
        rsym.mesh(BALL, 16, bounds=((5, 6),) * 3)
    assert caught.value.code == "no-surface"
    assert caught.value.remedy == "bounds=((-1.02, 1.02), (-1.02, 1.02), (-1.02, 1.02))"


@pytest.mark.slow
def test_the_command_line_says_it_beside_its_answer(tmp_path, capsys):
    assert cli.main(["fields", "car", "--section", "z=9", "--resolution", "16", "-o", str(tmp_path / "sheet.png")]) == 0
    out, err = capsys.readouterr()
    assert out.strip().endswith("sheet.png")
    assert err.startswith("rsym: warning: no boundary in the section z = 9")


FREE = 4e9


@pytest.fixture
def _machine(monkeypatch):
    """A machine of four gigabytes."""
    for module in (memory, mesher):
        monkeypatch.setattr(module, "free_memory", lambda: FREE)


@pytest.mark.usefixtures("_machine")
@pytest.mark.parametrize(
    "call",
    [
        lambda cells: rsym.level_lines(AWAY, resolution=cells),
        lambda cells: rsym.plot_field(AWAY, ax=axes(), resolution=cells),
        lambda cells: rsym.plot_fields(AWAY, resolution=cells),
        lambda cells: rsym.plot_sweep(GROWING, LETTER, [1, 2], resolution=cells),
        lambda cells: rsym.sections(BALL, [0], resolution=cells),
        lambda cells: rsym.mesh(BALL, cells),
        lambda cells: rsym.mesh(BALL, cells, method="smooth"),
        lambda cells: rsym.plot_sweep(GROWING_BALL, LETTER, [1], resolution=cells),
    ],
)
def test_what_does_not_fit_is_refused_with_an_estimate_and_a_resolution_that_fits(call):
    with pytest.raises(RsymError) as caught:
        call(100_000)
    error = caught.value
    assert error.code == "memory"
    assert error.message.startswith("resolution 100000: about ")
    assert error.message.endswith(" are needed, 4 GB are free") or "3.9 GB are free" in error.message
    assert "force=True, on the command line --force" in error.remedy
    assert 100 < int(error.remedy.split()[1]) < 20_000


@pytest.mark.usefixtures("_machine")
def test_the_octree_is_refused_long_before_its_boxes_fill_the_memory(monkeypatch):
    largest = []
    claim = memory.Budget.claim
    monkeypatch.setattr(memory.Budget, "claim", lambda *given: largest.append(given[1]) or claim(*given))
    with pytest.raises(RsymError):
        rsym.mesh(BALL, 100_000)
    boxes = [need for need in largest if need < FREE]
    assert len(boxes) > 3
    assert max(boxes) < 1e7  # bytes


def test_force_goes_on(monkeypatch):
    for module in (memory, mesher):
        monkeypatch.setattr(module, "free_memory", lambda: 1e3)
    monkeypatch.setattr(memory, "FEW", 0.0)
    for method in ("sharp", "smooth"):
        with pytest.raises(RsymError, match="of memory"):
            rsym.mesh(BALL, 24, method=method)
        assert rsym.mesh(BALL, 24, method=method, force=True).status.closed
    here = AWAY.replace(bounds=((7, 11), (-2, 2)))
    with pytest.raises(RsymError, match="of memory"):
        rsym.level_lines(here, resolution=24)
    assert len(rsym.level_lines(here, resolution=24, force=True)) == 1
    assert len(rsym.plot_fields(here, ("value",), resolution=24, force=True).axes) == 2


def test_the_estimate_of_a_picture_is_what_it_takes():
    import tracemalloc

    here = AWAY.replace(bounds=((7, 11), (-2, 2)))
    rsym.level_lines(here, resolution=600)
    tracemalloc.start()
    rsym.level_lines(here, resolution=600)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert 0.3 < peak / (600**2 * plane.SAMPLES.memory) < 1.1


@pytest.mark.slow
@pytest.mark.parametrize("command", ["fields", "mesh"])
def test_the_command_line_refuses_and_force_goes_on(command, tmp_path, capsys, monkeypatch):
    for module in (memory, mesher):
        monkeypatch.setattr(module, "free_memory", lambda module=module: mesher.RESERVE * (module is mesher) + 1e5)
    monkeypatch.setattr(memory, "FEW", 0.0)
    name = str(tmp_path / ("sheet.png" if command == "fields" else "body.stl"))
    given = [command, "skeleton", "--resolution", "64", "-o", name, *(["--revolve", "x"] * (command == "mesh"))]
    assert cli.main(given) == 1
    assert "--force" in capsys.readouterr().err
    assert cli.main([*given, "--force"]) == 0


def test_a_sheet_tells_what_is_at_work():
    stages = []

    class Bar:
        def describe(self, stage, undecided):
            stages.append(stage)

        def __call__(self, done, total):
            pass

    rsym.plot_fields(AWAY.replace(bounds=((7, 11), (-2, 2))), ("value", "laplacian"), resolution=16, progress=Bar())
    assert stages == ["compiling", "sampling", "value", "laplacian", "done"]
