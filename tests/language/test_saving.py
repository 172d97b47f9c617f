"""Shapes as model texts: what is written loads to the same program, letters, bounds and parts."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.tiers import examples

import rsym
from rsym import Letter, R0m, RAlpha, Rho, Rp, RsymError, Sardf, Shape, x, y
from rsym.cli import main
from rsym.program.fields import program_of

a, b = sp.symbols("a b", real=True)
BOX = ((-2, 2), (-2, 2))


def same(shape):
    """Load what is written, and hold it against the shape."""
    text = rsym.dumps(shape)
    again = rsym.loads(text)
    assert program_of(again, ("value",)).digest == program_of(shape, ("value",)).digest
    assert program_of(again, ("gradient",)).digest == program_of(shape, ("gradient",)).digest
    assert list(again.letters.items()) == list(shape.letters.items())
    kinds = [[type(end) for end in (one.default, one.minimum, one.maximum)] for one in again.letters.values()]
    assert kinds == [[type(end) for end in (one.default, one.minimum, one.maximum)] for one in shape.letters.values()]
    assert again.bounds == shape.bounds
    assert [name for name, _ in again.parts] == [name for name, _ in shape.parts]
    for (_, old), (_, new) in zip(shape.parts, again.parts, strict=True):
        part = Shape(new, again.coordinates, letters=again.letters)
        assert program_of(part, ("value",)).digest == program_of(shape.replace(expression=old), ("value",)).digest
    points = np.random.default_rng(1).uniform(-3, 3, (shape.dimension, 40))
    kernels = [rsym.compile(one, backend="numpy") for one in (shape, again)]
    values = [kernel(*points)["value"].tobytes() for kernel in kernels]
    assert values[0] == values[1]
    assert rsym.dumps(again) == text or rsym.loads(rsym.dumps(again)) == again
    return text


@pytest.mark.random
@pytest.mark.parametrize("name", rsym.paper.MODELS)
def test_every_model_loads_as_it_was(name):
    same(rsym.load(name))


@pytest.mark.slow
def test_stages_and_readings_of_the_car_too():
    same(rsym.paper.car("b", "test3", reading="strip"))
    same(rsym.paper.skeleton_body("literal"))


SQUARE, DISC = rsym.rectangle(2, 2), rsym.disc(1)
BALL, BLOCK = rsym.sphere(1), rsym.box(1, 2, 3)
ROOT, THIRD = sp.sqrt(2), sp.Rational(1, 3)
PIECE = sp.Piecewise((x + y, sp.And(x > 0, y <= 1)), (x**2, sp.Or(x < -1, sp.Not(y >= 2))), (y, True))
OPEN_ENDED = sp.Piecewise((x, x > y), (1 - x, x < y - 1))
MADE = {
    "letters": lambda: Shape(
        a * x - b + y,
        (x, y),
        letters={
            a: Letter(0.1, minimum=0.05, unit="mm", doc='the "long" side; 50% of it'),
            b: Letter(Fraction(5, 3), minimum=-1, maximum=2.5),
            "idle": Letter(7, maximum=1e9),
        },
        bounds=((-0.1, 1 / 3), (-1e-7, 12345678.9)),
    ),
    "floats": lambda: Shape(0.1 * x - 2.5e-7 * y + 1e22 - x * 3.0, (x, y)),
    "constants": lambda: Shape(ROOT * x - sp.pi * y**THIRD + sp.E + sp.exp(x) - sp.exp(1) * y, (x, y)),
    "powers": lambda: Shape(
        x**a - 1 / (y**2 + 1) + (x**2 + 1) ** sp.Rational(-3, 2) - 1 / sp.sqrt(1 + y**2), (x, y), letters={a: 2}
    ),
    "unevaluated": lambda: Shape(
        sp.Mul(2, sp.Add(x, y), evaluate=False) + sp.Mul(-1, sp.Add(x, 1), evaluate=False), (x, y)
    ),
    "functions": lambda: Shape(
        sp.sin(x)
        + sp.tan(y)
        - sp.asin(x / 9)
        + sp.acos(y / 9) * sp.atan(x)
        - sp.sinh(x)
        + sp.cosh(y) * sp.tanh(x)
        + sp.log(1 + x**2)
        - sp.Abs(x)
        + sp.sign(y)
        + sp.Min(x, y, 1)
        - sp.Max(x, y)
        + sp.atan2(y, x)
        + sp.cot(x + 5),
        (x, y),
    ),
    "piecewise": lambda: Shape(PIECE, (x, y)),
    "open piecewise": lambda: Shape(OPEN_ENDED, (x, y)) & DISC,
    "motions": lambda: (SQUARE.rotate(0.3).translate(1, -2).scale(1.7).mirror((1, 2), 0.5) | DISC).named("moved"),
    "parts": lambda: (SQUARE.named("plate") - DISC.named("hole") - DISC.translate(2, 0).named("hole")).rotate(
        sp.pi / 7
    ),
    "strange part names": lambda: (SQUARE.named("omega") | DISC.named("3 wheels, £") | DISC.scale(2).named("x")).named(
        "sin"
    ),
    "half-planes": lambda: Shape(x, (x, y)).named("right") & Shape(-x, (x, y)).named("left"),
    "systems": lambda: rsym.conjunction(SQUARE, DISC, system=Rp(4)) | rsym.disjunction(SQUARE, DISC, system=R0m(2)),
    "letter of a system": lambda: (SQUARE & DISC).with_system(RAlpha(a), letters={a: 0.5}),
    "one system": lambda: (SQUARE & DISC).with_system(Rp(4)),
    "decimal of a system": lambda: (SQUARE & DISC).with_system(RAlpha(0.5)),
    "negative decimal of a system": lambda: (SQUARE & DISC).with_system(RAlpha(-0.25)),
    "blends": lambda: rsym.conjunction(SQUARE, DISC, system=Rho(sp.Rational(1, 5))),
    "cubic": lambda: rsym.disjunction(SQUARE, DISC, SQUARE.translate(1, 1), system=Rho(0.2, "G2", 0.1)),
    "sardf": lambda: rsym.conjunction(SQUARE, DISC, system=Sardf(0.5)),
    "equivalence": lambda: rsym.exclusive_or(SQUARE, DISC) | rsym.equivalence(SQUARE, DISC, order=3),
    "curves": lambda: rsym.joining(rsym.segment((0, 0), (1, 1)), rsym.arc(1, 0, 2)),
    "space": lambda: rsym.revolve(SQUARE.translate(3, 0)) | BALL - BLOCK.rotate(0.7, axis=(1, 2, 2)),
    "rows": lambda: rsym.grid(BALL, (3, 2.5, 2), counts=(3, 2, 1)),
    "endless rows": lambda: Shape(1 - rsym.triangle_wave(x, 2) ** 2 - y**2, (x, y)),
    "cyclic": lambda: rsym.cyclic(DISC.translate(3, 0), 5),
    "helix": lambda: rsym.helix_tube(2, 1, 0.3),
    "normalised": lambda: rsym.normalise(SQUARE),
    "normalised to order 2": lambda: rsym.normalise(rsym.ellipse(2, 1), order=2),
    "shell": lambda: rsym.shell(BALL, 0.1),
    "displaced": lambda: rsym.displacement_blend(SQUARE, DISC, 0.1, 0.2, 0.3),
    "deep": lambda: _nest(60),
    "other coordinates": lambda: Shape(1 - sp.Symbol("u", real=True) ** 2, (sp.Symbol("u", real=True), y)),
}


def _nest(depth):
    shape = rsym.disc(1)
    for k in range(depth):
        shape = (shape | rsym.disc(1).translate(k, 0)) - Shape(x - k, (x, y))
    return shape


@pytest.mark.random
@pytest.mark.parametrize("name", MADE)
def test_shapes_made_in_python_load_as_they_were(name):
    shape = MADE[name]()
    same(shape if isinstance(shape, Shape) else Shape(shape, (x, y)))


NUMBERS = st.one_of(
    st.integers(-5, 5),
    st.fractions(-3, 3, max_denominator=7),
    st.floats(-3, 3, allow_nan=False).filter(lambda value: value == 0 or abs(value) > 1e-9),
)
ATOMS = st.one_of(st.sampled_from([x, y, a, sp.pi, sp.sqrt(3)]), NUMBERS.map(sp.sympify))


def grown(inner):
    pairs = st.tuples(inner, inner)
    return st.one_of(
        pairs.map(lambda both: both[0] + both[1]),
        pairs.map(lambda both: both[0] - both[1]),
        pairs.map(lambda both: both[0] * both[1]),
        st.tuples(inner, st.sampled_from([2, 3, -1, -2, sp.Rational(1, 2), sp.Rational(-3, 2)])).map(
            lambda both: (1 + both[0] ** 2) ** both[1]
        ),
        pairs.map(lambda both: rsym.conjunction(*both)),
        pairs.map(lambda both: rsym.disjunction(*both, system=Rp(3))),
        inner.map(lambda one: -one),
        inner.map(lambda one: sp.sin(one, evaluate=False)),
        pairs.map(lambda both: sp.Max(*both, evaluate=False)),
        pairs.map(lambda both: sp.Mul(*both, evaluate=False) if both[0].args and both[1].args else both[0]),
    )


@settings(max_examples=examples(150), deadline=None, derandomize=True)
@given(st.recursive(ATOMS, grown, max_leaves=12))
def test_random_formulas_load_as_they_were_or_are_refused(expression):
    try:
        shape = Shape(expression, (x, y), letters={a: 1.5})
    except RsymError:
        return  # an undefined constant
    try:
        text = rsym.dumps(shape)
    except RsymError as error:
        if error.code != "cannot-write":
            raise
        return
    assert program_of(rsym.loads(text), ("value",)).digest == program_of(shape, ("value",)).digest


@pytest.mark.slow
def test_few_random_formulas_are_refused():
    """The property above would hold of a writer that refuses all."""
    import random

    chance, refused = random.Random(5), 0
    for _ in range(200):
        parts = [x, y, a, sp.Integer(2), sp.Rational(1, 3), sp.Float(0.1)]
        for _ in range(12):
            f, g = chance.choice(parts), chance.choice(parts)
            parts.append(
                chance.choice([f + g, f * g, f - g, rsym.conjunction(f, g), (1 + f**2) ** chance.choice([-1, 2])])
            )
        try:
            rsym.dumps(Shape(parts[-1], (x, y), letters={a: 1}))
        except RsymError:
            refused += 1
    assert refused == 0


@pytest.mark.parametrize(
    ("shape", "named"),
    [
        (Shape(sp.besselj(0, x) - y, (x, y)), "besselj"),
        (Shape(sp.Symbol("α", real=True) - x, (x, y), letters={"α": 1}), "α"),
        (Shape(sp.Symbol("sin", real=True) - x, (x, y), letters={"sin": 1}), "sin"),
        (Shape(a - x, (x, y), letters={a: Letter(1, doc="two\nlines")}), "one line"),
        (Shape(x, (x, y)).named("half \ud800"), "half a character"),
        (Shape(x - sp.EulerGamma, (x, y)), "EulerGamma"),
        (Shape(x - sp.Float("0.1", 50), (x, y)), "0.1"),
    ],
)
def test_what_cannot_be_said_is_named(shape, named):
    with pytest.raises(RsymError, match=named) as caught:
        rsym.dumps(shape)
    assert caught.value.code == "cannot-write"
    assert caught.value.remedy


def test_a_file_is_written_whole_and_read_by_its_name(tmp_path):
    shape = rsym.paper.car().with_letters({"ra": 2.75})
    path = rsym.save(shape, tmp_path / "low.rf")
    assert rsym.load(path) == shape
    with pytest.raises(RsymError):
        rsym.save(Shape(sp.besselj(0, x) - y, (x, y)), tmp_path / "bessel.rf")
    assert [one.name for one in tmp_path.iterdir()] == ["low.rf"]
    for wrong in (None, "car", 3):
        with pytest.raises(RsymError, match="Shape"):
            rsym.dumps(wrong)


@pytest.mark.slow
def test_show_prints_a_model_file(tmp_path, capsys):
    assert main(["show", "car", "--model", "--set", "ra=2.75"]) == 0
    text = capsys.readouterr().out
    assert rsym.loads(text).letters["ra"].default == 2.75
    assert 'part "bonnet" = ' in text
    assert main(["show", "car", "--model", "--latex"]) == 1
    assert "one of them" in capsys.readouterr().err
    (tmp_path / "again.rf").write_text(text)
    assert main(["letters", str(tmp_path / "again.rf")]) == 0
    assert main(["show", str(tmp_path / "again.rf"), "--latex"]) == 0


def test_parts_of_a_hand_written_model_may_be_named_in_statements():
    shape = rsym.loads('f = 1 - x^2; g = y; omega = rfAND(f, g)\npart "band" = f; part "ground" = -g')
    assert shape.parts == (("band", 1 - x**2), ("ground", -y))


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("omega = RpConjunction(4, x)", "line 1, column 9"),
        ("omega = RpConjunction(1/2, x, y)", "line 1, column 9"),
        ("omega = 1 -\n  Segment(x, y, 1)", "line 2, column 3"),
        ("omega = Held(x^2)", "line 1, column 9"),
        ("omega = 1 - AbsolutePower(x, y)", "line 1, column 13"),
        ("omega = SignedPower(x, y + 1)", "line 1, column 9"),
        ("verbatim; omega = 0^-1*x", "line 1, column 19"),
        ("verbatim; omega = x/(2 - 2)", "line 1, column 22"),
        ("verbatim; omega = x*sqrt(-1)", "line 1, column 21"),
        ("verbatim; omega = x*(1 - sqrt(2))^(1/3)", "line 1, column 22"),
        ("verbatim; omega = 2^1000000000*x", "line 1, column 19"),
        ("verbatim; omega = 2^(500000000 + 500000000)*x", "line 1, column 19"),
        ("verbatim; omega = 2^10^10^11*x", "line 1, column 19"),
        ("verbatim; omega = 2^(10^9)*x", "line 1, column 19"),
        ("omega = TriangleRow(x, 1, 1000000)", "line 1, column 9"),
        ("omega = piecewise(x, y, 1)", "line 1, column 22"),
        ("omega = piecewise(x > 1, x)", "line 1, column 19"),
        ("omega = piecewise(x)", "line 1, column 9"),
        ("omega = piecewise(x, and(x, y > 1))", "line 1, column 22"),
        ("omega = x < 1", "line 1, column 11"),
        ('omega = x; part "p" y = x', "line 1, column 21"),
        ('omega = x; part "" = x', "line 1, column 17: a part needs a name"),
        ('omega = x; part "f" = g', "line 1, column 23"),
        ("verbatim; verbatim; omega = x", "line 1, column 11"),
        ("letter a = 1 in [2, inf]; omega = a - x", "line 1, column 8"),
    ],
)
def test_mistakes_keep_line_and_column(text, place):
    with pytest.raises(RsymError) as caught:
        rsym.loads(text)
    assert place in str(caught.value)


def test_a_piecewise_formula_in_a_plain_model():
    shape = rsym.loads("omega = piecewise(1 - x, x > 0, 1 + x)")
    kernel = rsym.compile(shape, backend="numpy")
    assert kernel([0.25, -0.5], 0)["value"].tolist() == [0.75, 0.5]
    assert rsym.loads('letter a = 1 in [0, inf] unit "mm"; omega = a - x').letters["a"] == Letter(
        1, minimum=0, unit="mm"
    )


def test_a_letter_that_is_no_fraction_is_written_as_the_nearest_float_and_told():
    a = sp.Symbol("a", real=True)
    with pytest.warns(rsym.RsymWarning, match=r"of a = sqrt\(2\) the nearest float is written"):
        text = rsym.dumps(rsym.disc(a, letters={a: sp.sqrt(2)}))
    assert rsym.loads(text).letters["a"].default == float(sp.sqrt(2))
