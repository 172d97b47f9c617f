"""Pieces in model files: the same programs as in Python, other coordinates, clear refusals."""

import math
from fractions import Fraction

import pytest
import sympy as sp

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.language.listing import definitions
from rsym.language.pieces import PIECES

a, b = sp.symbols("a b", real=True)
LETTERS = {a: Fraction(3, 2), b: Fraction(1, 4)}
F, G = 1 - x**2 / 4 - y**2, y - x / 3
PLANE, OTHER = Shape(F, (x, y), letters=LETTERS), Shape(G, (x, y), letters=LETTERS)
HALF = sp.Rational(1, 2)
HEAD = "letter a = 1.5; letter b = 0.25; f = 1 - x^2/4 - y^2; g = y - x/3; h = x*y - z^2; "
BODY = Shape(x * y - z**2, (x, y, z), letters=LETTERS)


def simple(*texts):
    """Calls whose Python differs only in the function's home, points being tuples and numbers exact."""
    return [(text, lambda text=text: python_of(text)) for text in texts]


def python_of(text):
    """The call evaluated by Python itself, decimals as rationals, lists as tuples, letters given."""
    import re

    exact = re.sub(r"(?<![\w.])(\d+\.\d+)", lambda found: f"sp.Rational('{found[0]}')", text)
    names = {"sp": sp, "a": a, "b": b, "x": x, "y": y, "z": z, "pi": sp.pi, "f": PLANE, "g": OTHER, "h": BODY}
    opening, closing = exact.split("(", 1)[0], exact.rstrip().removesuffix(")").split("(", 1)[1]
    shared = {"letters": LETTERS} if PIECES[opening].takes("letters") else {}
    return eval(f"rsym.{opening}({closing}, **shared)", {**names, "rsym": rsym, "shared": shared})


# For every piece one call or more, as a model file and as Python have it.
CALLS = {
    "translate": [
        ("translate(f, a, -0.5)", lambda: PLANE.translate(a, -HALF)),
        ("translate(h, [a, 0, b])", lambda: BODY.translate((a, 0, b))),
    ],
    "rotate": [
        ("rotate(f, pi/6)", lambda: PLANE.rotate(sp.pi / 6)),
        ("rotate(f, a, centre = [1, b])", lambda: PLANE.rotate(a, centre=(1, b))),
        ("rotate(h, 0.5, [1, 2, b])", lambda: BODY.rotate(HALF, (1, 2, b))),
        ("rotate(h, -pi/2, axis = x)", lambda: BODY.rotate(-sp.pi / 2, x)),
    ],
    "scale": [
        ("scale(f, a)", lambda: PLANE.scale(a)),
        ("scale(h, [a, 1, 2], centre = [0, 0, 1])", lambda: BODY.scale((a, 1, 2), (0, 0, 1))),
    ],
    "mirror": [
        ("mirror(f, x)", lambda: PLANE.mirror(x)),
        ("mirror(h, [1, a, 0], b)", lambda: BODY.mirror((1, a, 0), b)),
    ],
    "shear": [("shear(f, x, y, a)", lambda: PLANE.shear(x, y, a))],
    "extrude": [("extrude(f, -a, upper = 2)", lambda: rsym.extrude(PLANE, -a, 2))],
    "revolve": [
        ("revolve(f)", lambda: rsym.revolve(PLANE)),
        ("revolve(f, axis = y)", lambda: rsym.revolve(PLANE, y)),
    ],
    "product": [("product(f, a - z^2)", lambda: rsym.product(PLANE, a - z**2, letters=LETTERS))],
    "sweep": [
        (
            "sweep(a - f, [[a, 2 - b*z]], 0, 4)",
            lambda: rsym.sweep(Shape(a - F, (x, y), letters=LETTERS), {a: 2 - b * z}, 0, 4),
        )
    ],
    "section": [("section(h, y, b + x)", lambda: rsym.section(BODY, y, b + x))],
    "offset": [("offset(f, b)", lambda: rsym.offset(PLANE, b))],
    "segment": [
        ("segment([0, b], [a, 1])", lambda: rsym.segment((0, b), (a, 1), letters=LETTERS)),
        ("segment([0, b, 1], [a, 1, 0])", lambda: rsym.segment((0, b, 1), (a, 1, 0), letters=LETTERS)),
    ],
    "polyline": [
        (
            "polyline([[0, 0], [a, 1], [2, b]], closed = 1, order = 4)",
            lambda: rsym.polyline([(0, 0), (a, 1), (2, b)], True, 4, letters=LETTERS),
        )
    ],
    "graph": [
        (
            "graph([[0, 0, a], [1, 1, 1], [2, 0, b]], [[0, 1], [0, 2]])",
            lambda: rsym.graph([(0, 0, a), (1, 1, 1), (2, 0, b)], [(0, 1), (0, 2)], letters=LETTERS),
        )
    ],
    "circle": [("circle(a, [b, 0])", lambda: rsym.circle(a, (b, 0), letters=LETTERS))],
    "arc": [
        ("arc(a, 0, pi/3, [0, b])", lambda: rsym.arc(a, 0, sp.pi / 3, (0, b), letters=LETTERS)),
        (
            "arc(a, 0.5, 2, [0, b, 0], axis = [0, 3, 4])",
            lambda: rsym.arc(a, HALF, 2, (0, b, 0), (0, 3, 4), letters=LETTERS),
        ),
    ],
    "helix": [("helix(2, a, turns = 3)", lambda: rsym.helix(2, a, 3, letters=LETTERS))],
    "space_curve": [("space_curve(h, x - a)", lambda: rsym.space_curve(BODY, x - a, letters=LETTERS))],
    "blend_on_skeleton": [
        (
            "blend_on_skeleton(segment([-a, 0], [a, 0]), 1 - x^2*b)",
            lambda: rsym.blend_on_skeleton(rsym.segment((-a, 0), (a, 0), letters=LETTERS), 1 - x**2 * b),
        )
    ],
    "displacement_blend": [
        (
            'displacement_blend(f, g, a, 0.5, operation = "intersection")',
            lambda: rsym.displacement_blend(PLANE, OTHER, a, HALF, operation="intersection"),
        )
    ],
    "bounded_blend": [
        (
            "bounded_blend(f, g, 4 - x^2 - y^2, a, a3 = 2)",
            lambda: rsym.bounded_blend(PLANE, OTHER, Shape(4 - x**2 - y**2, (x, y)), a, a3=2),
        )
    ],
    "fillet": [
        ("fillet(f, g, b)", lambda: rsym.fillet(PLANE, OTHER, b)),
        (
            'fillet(f, g, b, "G2", "difference", angle = pi/3)',
            lambda: rsym.fillet(PLANE, OTHER, b, "G2", "difference", sp.pi / 3),
        ),
    ],
    **{
        name: simple(*texts)
        for name, texts in {
            "half_plane": ["half_plane([a, 1], b)"],
            "strip": ["strip(-1, a, [3, 4])"],
            "line": ["line([0, b], [a, 1])"],
            "disc": ["disc(a, [b, 0])", "disc(2.5, exact = 1)"],
            "ellipse": ["ellipse(a, b)"],
            "superellipse": ["superellipse(a, 1, 4, [b, 0])"],
            "rectangle": ["rectangle(a, 1, centre = [b, 0])"],
            "polygon": ["polygon([[0, 0], [a, 0], [b, b], [0, 1]])"],
            "regular_polygon": ["regular_polygon(5, a)"],
            "half_space": ["half_space([1, 2, b], a)"],
            "slab": ["slab(-a, b, direction = [0, 3, 4])"],
            "sphere": ["sphere(a, [0, 0, b])", "sphere(2.5, exact = 1)"],
            "box": ["box(a, 2, 3, centre = [b, 0, 0])"],
            "cylinder": ["cylinder(a)", "cylinder(0.5, a, [b, 0, 1])"],
            "capsule": ["capsule([0, 0, 0], [a, 0, 1], b)"],
            "cone": ["cone(a, 2, [0, b, 0])"],
            "frustum": ["frustum(2, a, 0.5)"],
            "nappe": ["nappe(pi/6)", "nappe(b, [0, 0, a])"],
            "double_cone": ["double_cone(pi/3, [a, 0, 0])"],
            "ellipsoid": ["ellipsoid(a, 2, b)"],
            "torus": ["torus(2, b)", 'torus(a, b, form = "quartic")'],
            "quadric": ["quadric([[1, b, 0], [b, a, 0], [0, 0, -1]], [0, 1, b], a)"],
            "gyroid": ["gyroid(a, b)", "gyroid(2, thickness = b)"],
            "schwarz_p": ["schwarz_p(a)"],
            "schwarz_d": ["schwarz_d(a)"],
            "neovius": ["neovius(2, b)"],
            "lidinoid": ["lidinoid(a)"],
            "helicoid": ["helicoid(a, b)"],
            "helix_tube": ["helix_tube(2, b, a)"],
            "coil": ["coil(a, b, 1)", "coil(2, 0.25, 1.5, turns = 3)"],
            "implicit": ["implicit(h, length = a)"],
            "triangle_wave": ["triangle_wave(x, a)", "triangle_wave(y, 2, terms = 3)"],
            "cyclic": [
                "cyclic(f, 5, radius = a)",
                'cyclic(g, 3, motif = "any")',
                "cyclic(f, 6, radius = 1, terms = 4)",
            ],
            "row": ["row(f, a)", "row(f, 2, axis = y, count = 3)"],
            "grid": ["grid(f, [2, a], counts = [3, 4])"],
            "mirrored": ["mirrored(g, x, b)"],
            "kaleidoscope": ["kaleidoscope(g, 5)"],
            "mirror_group": ['mirror_group(h, "octahedral")'],
            "screw": ["screw(f, a, starts = 2)"],
            "wound": ["wound(f, 3, a)"],
        }.items()
    },
    "shell": [("shell(h, b)", lambda: rsym.shell(BODY, b))],
    "transform": [
        (
            "transform(f, [x, y - b*x^2], renormalise = 1)",
            lambda: rsym.transform(PLANE, [x, y - b * x**2], renormalise=True),
        )
    ],
    "normalise": [("normalise(f, order = 2)", lambda: rsym.normalise(PLANE, 2))],
}
# A primitive without a line of its own is called as it stands.
CALLS |= {name: [(f"{name}()", getattr(rsym, name))] for name in rsym.primitives.__all__ if name not in CALLS}
ROWS = [(text, make) for rows in CALLS.values() for text, make in rows]


def test_every_piece_is_in_the_table():
    assert CALLS.keys() == PIECES.keys()


def program(shape):
    """With all letters, in one order, so that only the formulas count."""
    whole = Shape(shape.expression, shape.coordinates, letters=LETTERS)
    return rsym.compile(whole, ("value", "gradient")).program


@pytest.mark.random
@pytest.mark.filterwarnings("default:the (offset|thickness) ")  # f and h know no distance
@pytest.mark.parametrize(("text", "make"), ROWS, ids=[text for text, _ in ROWS])
def test_a_model_file_and_python_give_the_same_program(text, make):
    loaded, made = rsym.loads(f"{HEAD} omega = {text}"), make()
    made = made if isinstance(made, Shape) else Shape(made, (x, y), letters=LETTERS)
    assert loaded.expression == made.expression
    whole = Shape(made.expression, (x, y, z), letters=LETTERS)
    assert program(loaded) == program(whole)
    assert dict(loaded.letters) == {name: LETTERS_OF[name] for name in loaded.letters}


LETTERS_OF = {str(symbol): rsym.Letter(value) for symbol, value in LETTERS.items()}


def test_the_system_of_the_model_is_that_of_its_pieces():
    loaded = rsym.loads("system R1; omega = extrude(1 - x^2 - y^2, 0, 1)")
    assert loaded.expression == rsym.R1.conjunction(1 - x**2 - y**2, z * (1 - z))
    assert rsym.loads("system R1; omega = box(1, 2, 3)").expression == rsym.box(1, 2, 3, system=rsym.R1).expression


def test_other_coordinates_mean_the_same():
    own = rsym.loads("coordinates u v w; letter x = 2; omega = extrude(u^2 - v*x, 0, 1)")
    u, v, w, letter = (sp.Symbol(name, real=True) for name in "uvwx")
    assert own.expression == rsym.conjunction(u**2 - v * letter, w * (1 - w))


def test_a_decimal_in_python_is_the_decimal_of_a_model_file():
    assert rsym.disc(0.6, (0.1, -2.5e-3)).expression == rsym.loads("omega = disc(0.6, [0.1, -0.0025])").expression
    assert rsym.disc(0.6).contract().order == 1
    measured = rsym.disc(0.123456789012)
    assert measured.expression.has(sp.Float)
    assert measured.contract().order is None


def test_what_is_in_space_makes_the_model_one_of_space():
    for text in ("0.2 - segment([0, 0, 0], [2, 0, 0])", "0.5 + sphere(1)", "scale(x, [1, 2, 3])"):
        loaded = rsym.loads(f"omega = {text}")
        assert loaded.dimension == 3
        assert loaded.definitions[0][1].has(sp.Function)
    assert rsym.loads("omega = polygon([[0, 0], [1, 0], [0, 1]])").dimension == 2


def test_decisions_are_made_at_the_values_of_the_variant():
    text = "letter a = 1; variant low: a = -1; omega = extrude(x, 0, a)"
    assert rsym.loads(text).letters["a"].default == 1
    with pytest.raises(RsymError, match=r"line 1, column 44: extrude: .* below the upper one, got 0 and a = -1"):
        rsym.loads(text, variant="low")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f = translate(x, 1)", "needs 2 numbers"),
        ("f = extrude(z, 0, 1)", "contains z"),
        ("f = extrude(x, upper = 1, 0)", "without a name"),
        ("f = rotat(x, 1)", "'rotate'"),
        ('f = rotate(x, "wide")', "number"),
        ("f = rotate(x, angl = 2)", "takes shape, angle"),
        ("f = translate(x, 1, [2, 3])", "number"),
        ("f = kaleidoscope(x, 100000)", "400 is the most"),
        ("f = normalise(x^2 + y, order = 3)", "2 is the most"),
        ("f = grid(1 - x^2 - y^2, [2, 2], counts = [3, 1000000])", "400 is the most"),
        ("f = [1, 2]", "expected a number"),
        ("f = sin([1, 2])", "expected a number"),
        ("letter a = scale(2, 1); f = a*x", "cannot stand here"),
        ("f = sweep(x, 0, 1, 2)", "takes profile, changes"),
        ("f = scale(x, 1/0)", "division by zero"),
        ("f = scale(x, )", "expected a number"),
        ("f = scale(x, [1, 2)", r"\]"),
        ("coordinates x y; f = extrude(x, 0, 1)", "body"),
        ("f = translate(x, [" + ", ".join("1" * 1001) + "])", "1000"),
        (
            "f0 = x + y; " + "".join(f"f{k + 1} = transform(f{k}, [x + y*f{k}, y]);" for k in range(30)),
            "parts|levels|kept",
        ),
    ],
)
def test_what_cannot_be_called_is_refused_at_its_place(text, message):
    with pytest.raises(RsymError, match=message) as refusal:
        rsym.loads(text)
    assert "line 1" in str(refusal.value)


def test_a_call_is_shown_as_it_stands():
    text = "letter r = 2; w = translate(x, r, -2); p = transform(rotate(w, angle=pi/6), [x, y], renormalise=1)"
    shown = [definition.latex for definition in definitions(text)]
    assert shown[0].endswith(r"\mathrm{translate}\left(x, r, -2\right)")
    assert r"\mathrm{rotate}\left(w, \mathrm{angle} = \frac{\pi}{6}\right)" in shown[1]
    assert r"\left[x, y\right], \mathrm{renormalise} = 1" in shown[1]
    assert r"\operatorname{translate}{\left(x,r,-2 \right)}" in rsym.loads(text)._repr_latex_()
    shown = rsym.loads("letter r = 2; f = disc(r, exact = 1); omega = cyclic(f, 6, radius = 2*r)").definitions
    assert [str(value) for _, value in shown] == ["disc(r, exact = 1)", "cyclic(f, 6, radius = 2*r)"]
    assert r"\mathrm{radius} = 2 r" in rsym.loads("letter r = 2; omega = cyclic(x, 6, radius = 2*r)")._repr_latex_()


def test_a_call_names_a_system_of_its_own():
    made = rsym.loads('letter r = 0.5; system Rp 4; f = box(6, 4, 2, system = "Rho r"); omega = rfAND(f, x)')
    r = sp.Symbol("r", real=True)
    round_box = rsym.box(6, 4, 2, system=rsym.Rho(r), letters={r: HALF})
    assert made.expression == rsym.conjunction(round_box.expression, x, system=rsym.Rp(4))
    assert (
        rsym.loads('omega = rectangle(2, 1, system = "R1")').expression
        == rsym.rectangle(2, 1, system=rsym.R1).expression
    )
    for text in ('"Foo"', "3", '"Rho"', '"Rho -1"', '"Rp q"', '"R1 2"'):
        with pytest.raises(RsymError, match="line 1, column 9: box: "):
            rsym.loads(f"omega = box(1, 1, 1, system = {text})")
    for text, remedy in (("R1", 'write system = "R1"'), ("Rho(0.5)", 'write system = "Rho 0.2"')):
        with pytest.raises(RsymError) as refused:
            rsym.loads(f"omega = box(1, 1, 1, system = {text})")
        assert refused.value.remedy == remedy


def test_a_letter_may_stand_for_a_whole_number():
    """It counts with its default, and is no letter of the shape any more: nothing that is changed later is ignored."""
    for text, python in (
        ("regular_polygon(n)", rsym.regular_polygon(6)),
        ("row(disc(1), 3, count = n + 1)", rsym.row(rsym.disc(1), 3, count=7)),
        ("grid(disc(1), [3, 4], counts = [n, 2])", rsym.grid(rsym.disc(1), (3, 4), counts=(6, 2))),
    ):
        made = rsym.loads(f"letter n = 6; omega = {text}")
        assert (made.expression, dict(made.letters)) == (python.expression, {})
    with pytest.raises(RsymError, match="the number of sides must be an integer"):
        rsym.loads("letter n = 2.5; omega = regular_polygon(n)")
    with pytest.raises(RsymError, match="400 is the most"):
        rsym.loads("letter n = 900; omega = regular_polygon(n)")


MOVED_PARTS = {
    "translate(rfAND(plate, rfNOT(hole)), [1, 0])": {"plate": 10, "hole": math.pi},
    "scale(rotate(rfAND(plate, rfNOT(hole)), 0.3), 2.5)": {"plate": 25, "hole": 2.5 * math.pi},
    "rfOR(plate, translate(rfAND(plate, rfNOT(hole)), [5, 0]))": {"plate": 20, "hole": math.pi},
    "mirrored(translate(hole, [2, 0]), [1, 0])": {"hole": 2 * math.pi},
}


@pytest.mark.parametrize("formula", MOVED_PARTS)
def test_calls_move_the_parts_of_what_they_move(formula):
    shape = rsym.loads(f'plate = rectangle(3, 2) "plate"\nhole = disc(0.5) "hole"\nomega = {formula}')
    assert rsym.measure(shape).parts == {name: pytest.approx(size) for name, size in MOVED_PARTS[formula].items()}


def test_what_is_moved_gets_another_name_as_in_python():
    text = "a = rectangle(1, 1){0}\nb = translate(a, [3, 0]){1}\nomega = rfOR(a, b)"
    for titles in (("", ""), (' "a"', ' "b"')):
        assert rsym.measure(rsym.loads(text.format(*titles))).parts == {name: pytest.approx(4) for name in "ab"}


def test_parts_move_in_other_coordinates_too():
    text = 'coordinates u v\na = disc(1/7, [1/3, 0]) "a"\nb = disc(0.137, [2, 0]) "b"\n'
    shape = rsym.loads(text + "omega = translate(scale(rfOR(a, b), 10), [1, 0])")
    sizes = {"a": 20 * math.pi / 7, "b": 20 * math.pi * 0.137}
    assert rsym.measure(shape).parts == {name: pytest.approx(size) for name, size in sizes.items()}
