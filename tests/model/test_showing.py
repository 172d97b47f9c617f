"""What a notebook shows of anything public: short, and found with little work; and formulas in named parts."""

import re
import sys

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import surfaces, x, y
from rsym.analysis.latex import field_formulas
from rsym.model.abridging import TOP, abridged, weight
from rsym.model.showing import LONGEST, in_common_parts
from rsym.model.symbols import substitute
from rsym.surfaces import symbols

pytestmark = pytest.mark.filterwarnings("ignore:the shape has corners")

MOST = 4000  # characters
PICTURE = 60_000  # of the surface, 240 x 180
CALLS = 45_000  # of Python functions; a few hundredths of a second
WAVES = rsym.Shape(sp.sin(9 * x) * sp.sin(9 * y), (x, y), bounds=((-3, 3), (-3, 3)))
U, V = symbols.u, symbols.v
MANY = {f"a{k}": rsym.Letter(k, minimum=0, maximum=900, doc=f"the <{k}>th letter " * 20) for k in range(300)}


def long_patch():
    t = sp.Symbol("t", real=True)
    wave = sum(sp.sin(k * t) / k for k in range(1, 60))
    edges = [(t, 0, wave * t * (1 - t)), (t, 1, 0), (0, t, 0), (1, t, 0)]
    return surfaces.CoonsPatch(edges[0], edges[1], edges[2], edges[3])


def nested():
    omega = x
    for k in range(40):
        omega = omega * sp.sin(omega) + k
    return rsym.Shape(omega, (x, y))


SHOWN = {
    "polygon": lambda: rsym.regular_polygon(10),
    "omega_2 of a polygon": lambda: rsym.normalise(rsym.regular_polygon(6), order=2),
    "nest": nested,
    "car": rsym.paper.car,
    "omega_1 of the car": lambda: rsym.normalise(rsym.paper.car()),
    "sum": lambda: rsym.Shape(sp.Add(*(x**k * y for k in range(1, 800))), (x, y)),
    "large number": lambda: rsym.Shape(x - sp.Integer(10) ** 9000, (x, y)),
    "letters": lambda: rsym.Shape(sum(map(sp.Symbol, MANY), x), (x, y), letters=MANY),
    "table of letters": lambda: rsym.Shape(sum(map(sp.Symbol, MANY), x), (x, y), letters=MANY).letters,
    "parts": lambda: rsym.Shape(x, (x, y), parts=tuple((f"part number {k}", x) for k in range(900))),
    "contract": lambda: rsym.regular_polygon(10).contract(),
    "contract of the car": lambda: rsym.paper.car().contract(),
    "kernel": lambda: rsym.compile(rsym.paper.car(), rsym.SIX, backend="numpy"),
    "program": lambda: rsym.compile(rsym.paper.car(), rsym.SIX, backend="numpy").program,
    "lines": lambda: rsym.level_lines(WAVES, 0.5, resolution=128),
    "no lines": lambda: rsym.level_lines(WAVES, 2.0, resolution=32),
    "section": lambda: rsym.sections(rsym.sphere(1), [0.5], resolution=64)[0],
    "mesh": lambda: rsym.mesh(rsym.sphere(1), 24),
    "empty mesh": lambda: rsym.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
    "patch": long_patch,
    "formula": lambda: surfaces.ParametricSurface((U, V, sum(U**k for k in range(200))), ((0, 1), (0, 1))),
    "octant": surfaces.sphere_octant,
    "blend": lambda: surfaces.HermiteBlend.class2(4, 1),
}


def shown(what):
    """Every text, and how many calls of functions it takes."""
    for name in ("__repr__", "_repr_latex_", "_repr_html_"):
        show = getattr(what, name, None)
        if show is None:
            continue
        calls = 0

        def count(frame, event, argument):
            nonlocal calls
            calls += event == "call"

        show()  # what is imported and kept at the first time
        before = sys.getprofile()
        sys.setprofile(count)
        try:
            text = show()
        finally:
            sys.setprofile(before)
        yield name, text, calls


@pytest.mark.random
@pytest.mark.parametrize("make", SHOWN.values(), ids=SHOWN)
def test_whatever_a_notebook_shows_is_short_and_quick(make):
    for name, text, calls in shown(make()):
        pictures = re.findall('<img [^>]*src="data:image/png;base64,[^"]*"[^>]*>', text or "")
        assert all(len(picture) <= PICTURE for picture in pictures), name
        assert len(text or "") - sum(map(len, pictures)) <= MOST, name
        assert calls <= CALLS, name


@pytest.mark.slow
@pytest.mark.parametrize("make", [SHOWN["kernel"], SHOWN["lines"], SHOWN["mesh"], SHOWN["polygon"]])
def test_arrays_and_shapes_show_themselves_in_a_notebook(make):
    assert re.match("<(div|table)>.*(<img|<svg|<td|displaystyle)", make()._repr_html_())


@pytest.mark.slow
def test_deep_parts_are_named_with_their_size():
    text = repr(rsym.normalise(rsym.regular_polygon(6), order=2))
    assert re.search(r"omega_1: \w+ of \d+ parts", text)
    assert r"\omega_{1}" in rsym.normalise(rsym.regular_polygon(6), order=2)._repr_latex_()
    assert repr(rsym.Shape(x - y, (x, y))) == "Shape(x - y, (x, y))"
    short, named = abridged(sp.sqrt(sum((x - k) ** 2 for k in range(99))) - y, ["omega_1"])
    assert [part.name for part in named] == ["omega_2"]
    assert weight(short, 100) <= TOP


def test_a_body_fills_its_still_picture_and_its_near_side_is_seen():
    from rsym.sampling.stills import surface_picture

    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert surface_picture(corners, faces) == surface_picture(corners + 5, faces)
    assert surface_picture(corners, faces[:3]) != surface_picture(corners, faces)


def value_of(parts, result, point):
    """The value of a result whose parts are put in one after the other."""
    known = dict(point)
    for part in parts:
        known[sp.Symbol(part.name, real=True)] = substitute(part.expression, known).evalf(30)
    return substitute(result, known).evalf(30)


@pytest.mark.random
@pytest.mark.parametrize("field", ["gradient", "hessian", "laplacian", "normalised", "normalised_2", "curvature"])
def test_common_parts_mean_the_same_formula(field):
    shape = rsym.conjunction(rsym.ellipse(2, 1), rsym.Shape(x - y**2 / 3, (x, y)))
    sides, _ = field_formulas(shape, field)
    parts, results = in_common_parts(list(sides.values()))
    point = {x: sp.Rational(7, 10), y: sp.Rational(-2, 9)}
    wanted = np.atleast_1d(rsym.compile(shape, (field,))(0.7, -2 / 9)[field])
    wanted = wanted[np.triu_indices(2)] if field == "hessian" else wanted
    for value, result in zip(wanted, results, strict=True):
        assert abs(value_of(parts, result, point) - value) < 1e-12 * (1 + abs(value))
    binary = max(weight(part.expression, 10 * LONGEST) for part in parts)
    assert binary <= 4 * LONGEST
    names = [part.name for part in parts]
    assert len(set(names)) == len(names)


def test_common_parts_are_worked_out_once_each():
    assert len(rsym.latex(nested())) < 10_000


def test_names_of_the_file_are_kept_and_never_taken():
    shape = rsym.loads("letter p_1 = 2; wall = (p_1 - x^2)*y + 1; omega = rfAND(wall, x*wall)")
    text = rsym.latex(shape, "gradient")
    assert r"\mathrm{wall} &:=" in text
    assert r"q_{1} &:=" in text


def test_latex_of_expressions_and_matrices():
    shape = rsym.Shape(x * y, (x, y))
    assert rsym.latex(x / 2) == r"f = \frac{x}{2}"
    assert rsym.latex(rsym.gradient(shape)) == r"\begin{aligned}a_{1,1} &= y\\ a_{2,1} &= x\end{aligned}"
    for what, field in [(shape, "colour"), (shape, None), (shape, "mean_curvature"), (x, "gradient"), ("x", "value")]:
        with pytest.raises(rsym.RsymError):
            rsym.latex(what, field)


def test_the_command_shows_a_field(capsys, tmp_path):
    from rsym.cli import main

    (tmp_path / "m.rf").write_text("letter a = 2; wall = (a - x^2)*y + 1; omega = rfAND(wall, x)")
    assert main(["show", str(tmp_path / "m.rf"), "--latex", "--field", "laplacian"]) == 0
    page = capsys.readouterr().out
    assert r"\Delta \omega &=" in page
    assert page.count(r"\begin{align*}") == 1
    assert main(["show", str(tmp_path / "m.rf"), "--field", "laplacian"]) == 1
    assert main(["show", str(tmp_path / "m.rf"), "--latex", "--field", "colour"]) == 1
