"""Models as MATLAB users write them, and angles in degrees."""

import math
import warnings

import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, RsymWarning, Shape, x, y
from rsym.cli import main

SCRIPT = """
% Six discs in a row
clear all; clc
close all
%{
  a block
  of comments ( [
%}
[X, Y] = meshgrid(-5:0.1:5, ...
                  -4:0.1:4);
w = -1;
for k = 0:5
    c = 3*k ...        the centre
        - 7;
    w = rfOR(w, 1 - (x - c).^2 - y.^2);
end
contour(X, Y, w, [0 0]);
hold on; title('six; discs')
"""


def quietly(text, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)
        return rsym.loads(text, **options)


def test_a_script_becomes_the_shape_that_it_draws():
    shape = quietly(SCRIPT)
    wanted = sp.Integer(-1)
    for k in range(6):
        wanted = rsym.disjunction(wanted, 1 - (x - (3 * k - 7)) ** 2 - y**2)
    assert shape.expression == wanted
    assert shape.coordinates == (x, y)
    assert [name for name, _ in shape.definitions][-1] == "w"


def test_what_is_passed_over_is_said_once_with_its_line():
    with pytest.warns(RsymWarning) as caught:
        rsym.loads(SCRIPT)
    texts = [str(one.message) for one in caught]
    assert [text.split(" is passed over")[0] for text in texts] == [
        "line 9: meshgrid",
        "line 17: contour",
        "line 18: hold",
        "line 18: title",
    ]
    assert "bounds x [-5, 5] y [-4, 4]" in texts[0]


@pytest.mark.parametrize(
    ("line", "bounds"),
    [
        ("[x,y]=meshgrid(-2:.01:2)", "bounds x [-2, 2] y [-2, 2]"),
        ("[x, y, z] = meshgrid(-2:1:2, 0:3, linspace(-1, 1, 9));", "bounds x [-2, 2] y [0, 3] z [-1, 1]"),
        ("x = linspace(-3, 3, 100)", "bounds x [-3, 3]"),
        ("x = -3:0.5:4;", "bounds x [-3, 4]"),
        ("[x, y] = meshgrid(u, v)", "bounds x [-5, 5] y [-5, 5]"),
    ],
)
def test_grids_of_points_name_the_bounds_that_they_would_be(line, bounds):
    with pytest.warns(RsymWarning) as caught:
        shape = rsym.loads(f"{line}\nomega = 1 - x^2 - y^2")
    assert shape.expression == 1 - x**2 - y**2
    assert str(caught[0].message).endswith(bounds)


def test_housekeeping_needs_no_word():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rsym.loads("clear; clc; close all; format long\nclear x y\nomega = x").expression == x


def test_names_like_words_of_matlab_are_names_where_they_are_defined():
    shape = rsym.loads("letter view = 1; axis = x - view; close = y; omega = rfAND(axis, close)")
    assert shape.with_letters({"view": 2}).expression == rsym.conjunction(x - sp.Symbol("view", real=True), y)


@pytest.mark.parametrize(
    ("run", "values"),
    [
        ("0:3", [0, 1, 2, 3]),
        ("4:-2:-1", [4, 2, 0]),
        ("0:0.1:0.3", ["0", "1/10", "1/5", "3/10"]),
        ("-1/2:1/2:1/2", ["-1/2", 0, "1/2"]),
        ("3:1", []),
    ],
)
def test_the_values_of_a_counter_are_exact(run, values):
    shape = rsym.loads(f"w = y; for k = {run}, w = rfAND(w, x - k); end; omega = w")
    assert shape.expression == (rsym.conjunction(y, *(x - sp.Rational(value) for value in values)) if values else y)


def test_loops_in_loops_and_names_of_their_own():
    shape = rsym.loads("""
        letter r = 1
        w = -1
        for i = 1:2
            for j = 0:i
                d = (r^2 - (x - i)^2 - (y - j)^2)/(2*r) "disc"
                w = rfOR(w, d)
            end
        end
        omega = rfNOT(w)
    """)
    r = sp.Symbol("r", real=True)
    discs = [(r**2 - (x - i) ** 2 - (y - j) ** 2) / (2 * r) for i in (1, 2) for j in range(i + 1)]
    assert shape.expression == -rsym.disjunction(-1, *discs)
    assert [name for name, _ in shape.parts] == ["disc"] * 5
    plain = rsym.loads("w = -1; for k = 0:2, w = rfOR(w, x - k); end; omega = w")
    assert [name for name, _ in plain.parts] == ["w", "omega"]


def test_a_loop_that_defines_a_name_once_leaves_it_alone():
    assert rsym.loads("for k = 2:2, f = x - k; end; omega = f").expression == x - 2


@pytest.mark.parametrize(
    ("text", "place", "meant"),
    [
        ("omega = f & g", "line 1, column 11", "rfAND(f, g)"),
        ("f = x; g = y\nomega = f && g", "line 2, column 11", "rfAND(f, g)"),
        ("omega = x | y", "line 1, column 11", "rfOR(f, g)"),
        ("omega = x || y", "line 1, column 11", "rfOR(f, g)"),
        ("omega = ~x", "line 1, column 9", "rfNOT(f)"),
        ("omega = ...\n  !x", "line 2, column 3", "rfNOT(f)"),
        ("%{\n a\n%}\nomega = x +\n  & y", "line 5, column 3", "rfAND"),
        ("omega = x\n %{\nall that follows", "line 2, column 1", "%}"),
        ("title(" + "...\n" * 2000, "line 1, column 6", ""),
        ("clear\nw = x\nw = y", "line 3, column 1", "rename"),
        ("for k = 0:5\n w = x - k", "line 1, column 1", "end"),
        ("for k = 0:n\n w = x - k\nend", "line 1, column 11", "number"),
        ("for k = 0:0:5\n w = x\nend", "line 1, column 1", "step"),
        ("for k = 0:100000\n w = x\nend", "line 1, column 1", "turns"),
        ("for k = 1:40\n for j = 1:40\n  w = x\n end\nend", "line 3, column 3", "fewer"),
        ("for x = 0:5\n w = y\nend", "line 1, column 5", "coordinate"),
        ("for k = 0:5\n letter a = k\nend", "line 2, column 9", "out of the loop"),
        ("for k = 0:2\n  w = rfOR(w, x - k)\nend", "line 2, column 12", "'w'"),
        ("for k = 0:2\n  v = rfOR(x, \n    xx - k)\nend", "line 3, column 5", "xx"),
        ("while x\nend", "line 1, column 1", "for k = 0:5"),
        ("if a\nend", "line 1, column 1", "for k = 0:5"),
        ("end", "line 1, column 1", ""),
        ("letter a = 30 deg; omega = x", "line 1, column 15", "a deg"),
    ],
)
def test_mistakes_are_answered_at_their_place(text, place, meant):
    with pytest.raises(RsymError) as caught:
        quietly(text)
    assert place in str(caught.value)
    assert meant in str(caught.value)


def test_degrees_in_a_model():
    turned = rsym.loads("f = rectangle(4, 2); omega = rotate(f, 30 deg)")
    same = rsym.rectangle(4, 2).rotate(sp.pi / 6)
    assert_close(
        rsym.compile(turned, backend="numpy")([0.3, 1.7], [0.9, -1])["value"],
        rsym.compile(same, backend="numpy")([0.3, 1.7], [0.9, -1])["value"],
        atol=1e-15,
    )
    lettered = rsym.loads("letter a = 45 in [0, 90]\nomega = x*cos(a deg) + y*sin(a deg) - (2*a) deg")
    assert_close(
        rsym.compile(lettered)(1, 2, letters={"a": 60})["value"], 0.5 + math.sqrt(3) - 2 * math.pi / 3, atol=1e-14
    )
    assert rsym.loads("omega = rotate(x - 1, 90, degrees = 1)").expression == y - 1


DISC, BOX, HALF = rsym.disc(1).translate(2, 0), rsym.box(1, 2, 3), [Shape(side, (x, y)) for side in (x, y)]


@pytest.mark.parametrize(
    ("degrees", "radians"),
    [
        (lambda: DISC.rotate(30, degrees=True), lambda: DISC.rotate(sp.pi / 6)),
        (lambda: BOX.rotate(90, "x", degrees=True), lambda: BOX.rotate(sp.pi / 2, "x")),
        (lambda: rsym.arc(2, 0, 90, degrees=True), lambda: rsym.arc(2, 0, sp.pi / 2)),
        (lambda: rsym.nappe(60, degrees=True), lambda: rsym.nappe(sp.pi / 3)),
        (lambda: rsym.double_cone(30, degrees=True), lambda: rsym.double_cone(sp.pi / 6)),
        (
            lambda: rsym.fillet(*HALF, 1, angle=120, degrees=True),
            lambda: rsym.fillet(*HALF, 1, angle=2 * sp.pi / 3),
        ),
    ],
)
def test_degrees_in_python(degrees, radians):
    assert degrees() == radians()


def test_letters_may_be_in_degrees_and_switches_are_switches():
    t = sp.Symbol("t", real=True)
    shape = Shape(x - 1, (x, y)).rotate(t, degrees=True, letters={t: 90})
    assert_close(rsym.compile(shape)(0.25, 1.5)["value"], 0.5, atol=1e-15)
    for wrong in ("yes", None, 2, 1.5):
        with pytest.raises(RsymError, match="degrees must be"):
            rsym.disc(1).rotate(30, degrees=wrong)


def test_a_script_on_the_command_line(tmp_path, capsys):
    path = tmp_path / "discs.m"
    path.write_text(SCRIPT + "bounds x [-9, 9] y [-2, 2]\n")
    assert main(["show", str(path)]) == 0
    streams = capsys.readouterr()
    assert "w = disjunction" in streams.out
    assert streams.err.count("meshgrid is passed over") == 1
    assert main(["show", str(path), "--latex"]) == 0


@pytest.mark.random
@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("for k = 0:900, w = rfOR(x, k*y); end", None),
        ("for a = 1:999\nw = x^a\nend", None),
        ("w = x; for k = 1:60, w = w*w + k; end", "too-large"),
        ("%{\n" * 60000, "unclosed"),
        ("disp(" * 9000, "syntax"),
        ("plot(" + "......\n" * 25000, "syntax"),
    ],
)
def test_hostile_scripts_come_to_an_end(text, code):
    """A search that tried everything twice would not."""
    if code is None:
        assert quietly(text).dimension == 2
        return
    with pytest.raises(RsymError) as caught:
        quietly(text)
    assert caught.value.code == code
