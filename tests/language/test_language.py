"""The model language: what is read, what is refused and where, and that no text can do harm."""

import re
import string
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oracles.tiers import examples

import rsym.paper
from rsym.errors import RsymError
from rsym.language.loading import load, loads
from rsym.model.nodes import Held, expand_nodes
from rsym.model.operations import difference, implication, joining
from rsym.model.rnodes import R0Conjunction, R0Disjunction, R1Conjunction
from rsym.model.shape import Shape
from rsym.model.showing import latex
from rsym.model.symbols import postorder, real_symbol, symbols_of, x, y, z
from rsym.model.systems import Rp

CAR = Path(rsym.paper.__file__).parent / "car.rf"
SKELETON = CAR.with_name("skeleton.rf")
a, r = real_symbol("a"), real_symbol("r")


def formula(text: str) -> sp.Expr:
    """The expression of a one-formula model in x, y, z and the letters a, b."""
    return loads(f"letter a = 2; letter b = 3; omega = {text}").expression


def refusal(text: str, **options: str) -> RsymError:
    with pytest.raises(RsymError) as caught:
        loads(text, **options)
    error = caught.value
    assert error.remedy
    assert error.message
    return error


def values(shape: Shape, points: np.ndarray) -> np.ndarray:
    """Plain evaluation, square roots written out."""
    symbols = [*shape.coordinates, *map(real_symbol, shape.letters)]
    function = sp.lambdify(symbols, expand_nodes(shape.expression), cse=True)
    return function(*points, *(float(letter.default) for letter in shape.letters.values()))


# ---------------------------------------------------------------- what is read


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-x^2", -(x**2)),
        ("2^-1*x", x / 2),
        ("2^3^2*x", 64 * x),
        ("x^2^3", x**6),
        ("2^-x^2", (2**-x) ** 2),
        ("-2^2*x", -4 * x),
        ("x - y - z", x - y - z),
        ("x - (y - z)", x - y + z),
        ("x/y/z", x / (y * z)),
        ("x/(y/z)", x * z / y),
        ("x/2*3", sp.Rational(3, 2) * x),
        ("x*-y", -x * y),
        ("x - -y", x + y),
        ("--x", x),
        ("+x - +y", x - y),
        ("1./x", 1 / x),
        ("2.*x", 2 * x),
        ("2.^x", sp.Integer(2) ** x),
        ("1.5.*x./y.^2", sp.Rational(3, 2) * x / y**2),
        ("x**3", x**3),
        ("(x + y)^2", (x + y) ** 2),
        ("rfNOT(x) + negation(y)", -x - y),
        ("sqrt(y^2 + z^2)^2", y**2 + z**2),
        ("x^0", sp.Integer(1)),
        ("x - x", sp.Integer(0)),
    ],
)
def test_operators_bind_as_in_matlab(text, expected):
    assert sp.expand(formula(text) - expected) == 0


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.1", Fraction(1, 10)),
        ("1.", Fraction(1)),
        (".5", Fraction(1, 2)),
        ("2.5e-3", Fraction(1, 400)),
        ("1E2", Fraction(100)),
        ("1.e+1", Fraction(10)),
        ("0.1 + 0.2", Fraction(3, 10)),
        ("1/3", Fraction(1, 3)),
        ("(2/3)^-2", Fraction(9, 4)),
        ("0^0", Fraction(1)),
        ("(-1)^1000000001", Fraction(-1)),
        ("abs(-2.5) + min(1, 0.5, 2) + max(1, 3)", Fraction(6)),
        ("0e999", Fraction(0)),
        ("1e300", Fraction(10) ** 300),
    ],
)
def test_numbers_are_exact(text, value):
    assert formula(f"x + {text}") == x + sp.Rational(value.numerator, value.denominator)


def test_functions_keep_their_arguments_in_order():
    assert formula("rfAND(z, y, x)").operands == (z, y, x)
    assert isinstance(formula("conjunction(x, y)"), R0Conjunction)
    assert isinstance(formula("rfOR(x, y)"), R0Disjunction)
    assert formula("disjunction(x, y)") == formula("rfOR(x, y)")
    assert str(formula("trimming(y, x)")) == "trimming(y, x)"


@pytest.mark.parametrize("name", ["sqrt", "abs", "sin", "cos", "tan", "exp", "log"])
def test_elementary_functions(name):
    value = formula(f"{name}(x)").subs(x, sp.Rational(7, 10))
    assert float(value) == pytest.approx(float(getattr(np, name)(0.7)), rel=1e-14)


def test_functions_of_two_arguments():
    assert formula("atan2(y, x)") == sp.atan2(y, x)
    assert formula("min(x, y) + max(x, z, y)") == sp.Min(x, y, evaluate=False) + sp.Max(x, y, z, evaluate=False)


def test_constants_that_are_not_rational_are_held():
    expression = formula("sqrt(2)*x + pi + x^(1/2)")
    held = sorted(str(part) for part in postorder(expression) if isinstance(part, Held))
    assert held == ["(sqrt(2))", "pi"]
    whole = [part for part in postorder(formula("x + (sqrt(2) + sin(1)*pi)/3")) if isinstance(part, Held)]
    assert len(whole) == 1
    assert float(whole[0].as_roots()) == pytest.approx((np.sqrt(2) + np.sin(1) * np.pi) / 3, rel=1e-15)


def test_constants_inside_r_operations():
    held = formula("x*rfAND(1, sqrt(2))")
    assert float(expand_nodes(held).subs(x, 1)) == pytest.approx(1 + np.sqrt(2) - np.sqrt(3), rel=1e-15)


def test_names_that_sympy_or_python_reserve_are_plain_letters():
    names = ["E", "I", "S", "N", "Q", "O", "beta", "gamma", "zeta", "lambda", "re", "test", "x0", "class", "None"]
    text = "".join(f"letter {name} = {i + 1}\n" for i, name in enumerate(names)) + "omega = x + " + "*".join(names)
    shape = loads(text)
    assert list(shape.letters) == names
    assert shape.expression == x + sp.Mul(*map(real_symbol, names))


def test_letters_have_exact_values_ranges_and_words():
    shape = loads('letter a = -5/2 in [-10, 1e1] "half – довжина; % not a comment"\nletter r = 0.1;\nomega = a*x + r')
    letter = shape.letters["a"]
    assert (letter.default, letter.minimum, letter.maximum) == (Fraction(-5, 2), -10, 10)
    assert letter.doc == "half – довжина; % not a comment"
    assert shape.letters["r"].default == Fraction(1, 10)
    assert shape.letters["r"].minimum is None


def test_a_shape_has_the_letters_it_uses():
    text = "letter b = 1; letter a = 2; letter c = 3; f = b + c*x; g = a*f; h = x"
    assert list(loads(text).letters) == []
    assert list(loads(text, shape="f").letters) == ["b", "c"]
    assert list(loads(text, shape="g").letters) == ["b", "a", "c"]


def test_the_shape_is_omega_or_the_last_or_the_one_asked_for():
    assert loads("omega = x; f = y").expression == x
    assert loads("g = x; f = y").expression == y
    assert loads("omega = x; f = y", shape="f").expression == y


def test_variants_change_defaults_and_keep_the_rest():
    text = 'letter a = 1 in [0, 9] "length"\nletter b = 2\nvariant wide: a = 17/2,\n  b = -3\nomega = a*x + b'
    letters = loads(text, variant="wide").letters
    assert (letters["a"].default, letters["b"].default) == (Fraction(17, 2), -3)
    assert (letters["a"].maximum, letters["a"].doc) == (9, "length")
    assert loads(text).letters["a"].default == 1


def test_coordinates():
    assert loads("omega = x").coordinates == (x, y)
    assert loads("omega = x + z").coordinates == (x, y, z)
    assert loads("f = z; omega = x").coordinates == (x, y, z)
    assert loads("letter z = 1; omega = x + z").coordinates == (x, y)
    assert loads("coordinates x y z; omega = x").coordinates == (x, y, z)
    assert loads("coordinates u v\nletter x = 1\nomega = u + x").coordinates == (real_symbol("u"), real_symbol("v"))


def test_bounds():
    assert loads("bounds y [-4, 4.5] x [-8, 8]; f = x").bounds == ((-8.0, 8.0), (-4.0, 4.5))
    assert loads("bounds x [0, 1] y [0, 1] z [0, 1/2]; f = x").bounds[2] == (0.0, 0.5)
    assert loads("f = x").bounds is None


def test_systems():
    assert loads("letter q = 1; system Ralpha q; f = rfOR(x, y, rfAND(1, 2))").letters.keys() == {"q"}
    assert loads("system Rp 8/2; f = rfOR(x, y)").expression == Rp(4).disjunction(x, y)
    assert loads("f = implication(x, difference(y, joining(x, y)))").expression == implication(
        x, difference(y, joining(x, y))
    )
    assert isinstance(loads("system R1; f = rfAND(x, y)").expression, R1Conjunction)
    assert isinstance(loads("f = rfAND(x, y); system R0").expression, R0Conjunction)


@pytest.mark.parametrize(
    "text",
    [
        "% a comment\nf = x + ... y".replace("... ", "") + " # another",
        "f = x +\n  y",
        "f = x + % goes on\n\n  y",
        "f = (x\n + y\n)",
        "f = (x + y);;\n;",
        "\ufefff = x + y",
        "f = x\r\ng = f + y\r\n",
        "f = x\rg = f + y",
        "\t f\t=\tx+y",
        "f = x; g = f + y",
    ],
)
def test_layout(text):
    assert loads(text).expression == x + y


def test_operands_end_a_call_over_several_lines():
    assert loads("f = rfAND(x,\n  y, % second\n  z\n)").expression.operands == (x, y, z)


def test_definitions_keep_names_and_inline_shared_objects():
    shape = loads("letter a = 1; q = 5; f = x^2 + a; g = y; h = rfAND(f, f - 1); k = rfOR(h, -h)")
    f, h = real_symbol("f"), real_symbol("h")
    assert [name for name, _ in shape.definitions] == ["f", "h", "k"]
    assert shape.definitions[1][1] == R0Conjunction(f, f - 1)
    assert shape.definitions[2][1] == R0Disjunction(h, -h)
    inner = shape.expression.operands[0]
    assert inner == R0Conjunction(x**2 + a, x**2 + a - 1)
    assert any(part is inner for part in (*(-shape.expression.operands[1]).args, -shape.expression.operands[1]))
    assert r"h &= f \wedge_0" in latex(shape)


def test_closed_definitions_are_folded_where_they_are_used():
    shape = loads("n = 1 + 1; s = sqrt(n); f = x^n + s*y")
    assert shape.expression == x**2 + Held(sp.sqrt(2)) * y
    assert dict(shape.definitions)["f"] == x ** real_symbol("n") + real_symbol("s") * y


def test_nested_brackets_up_to_the_limit():
    assert formula("(" * 99 + "x" + ")" * 99) == x
    assert formula("(-1*" * 99 + "x" + "+1)" * 99).free_symbols == {x}
    assert formula("+".join(["(x)", "abs(x)"] * 200)) == 200 * x + 200 * sp.Abs(x)  # beside, not inside one another


# ------------------------------------------------------------- what is refused

REFUSED = [
    # text, code, line, column
    ("f = x + q", "unknown-name", 1, 9),
    ("f = x\ng = x + ff", "unknown-name", 2, 9),
    ("f = g; g = x", "unknown-name", 1, 5),
    ("f = f + x", "unknown-name", 1, 5),
    ("f = sen(x)", "unknown-name", 1, 5),
    ("f = x(y + 1)", "unknown-name", 1, 5),
    ("f = __import__(x)", "name", 1, 5),
    ("_f = x", "name", 1, 1),
    ("letter a = 5,3", "decimal-comma", 1, 13),
    ("letter a = 5 in [1,5, 10]", "decimal-comma", 1, 19),
    ("letter a = 5 in [1, 10,5]", "decimal-comma", 1, 23),
    ("letter a = 1\nvariant b: a = 9,5", "decimal-comma", 2, 17),
    ("bounds x [-8,5, 8] y [0, 1]\nf = x", "decimal-comma", 1, 13),
    ("f = 5,3", "decimal-comma", 1, 6),
    ("f = (5,3)*x", "decimal-comma", 1, 7),
    ("f = sqrt(2,5)", "decimal-comma", 1, 11),
    ("f = trimming(y, 5,3)", "decimal-comma", 1, 18),
    ("f = sqrt(2, 5)", "arity", 1, 5),
    ("f = sqrt()", "arity", 1, 5),
    ("f = rfAND(x)", "arity", 1, 5),
    ("f = rfNOT(x, y)", "arity", 1, 5),
    ("f = x + min(x)", "arity", 1, 9),
    ("f = atan2(x)", "arity", 1, 5),
    ("f = sin + x", "arity", 1, 5),
    ("f = \u0430 + x", "non-ascii", 1, 5),
    ("f = x \u2212 y", "non-ascii", 1, 7),
    ("f = x +\u00a0y", "non-ascii", 1, 8),
    ("f = x\u00b2", "non-ascii", 1, 6),
    ("f = \u0663*x", "non-ascii", 1, 5),
    ("f = x\nf = y", "redefinition", 2, 1),
    ("letter a = 1\na = x", "redefinition", 2, 1),
    ("letter a = 1; letter a = 2", "redefinition", 1, 22),
    ("x = 3", "redefinition", 1, 1),
    ("letter y = 3; f = x", "redefinition", 1, 8),
    ("coordinates x x", "redefinition", 1, 15),
    ("coordinates x y; coordinates x y", "redefinition", 1, 18),
    ("letter a = 1; variant b: a = 1; variant b: a = 2", "redefinition", 1, 41),
    ("letter a = 1; variant b: a = 1, a = 2", "redefinition", 1, 33),
    ("system R0; system R0; f = x", "redefinition", 1, 19),
    ("bounds x [0, 1] y [0, 1]; bounds x [0, 1] y [0, 1]; f = x", "redefinition", 1, 27),
    ("pi = 3", "reserved", 1, 1),
    ("letter sin = 3", "reserved", 1, 8),
    ("letter = 3", "reserved", 1, 1),
    ("variant = 3", "reserved", 1, 1),
    ("in = 3", "reserved", 1, 1),
    ("coordinates x pi", "reserved", 1, 15),
    ("f = " + "(" * 101 + "x" + ")" * 101, "too-deep", 1, 105),
    ("f = x + 9^9^9^9", "number-too-large", 1, 9),
    ("f = x + 1e999", "number-too-large", 1, 9),
    ("f = x + 1e301", "number-too-large", 1, 9),
    ("f = x*1e300*1e300", "number-too-large", 1, 5),
    ("f = x + " + "1" * 101, "number-too-large", 1, 9),
    ("f = x + exp(1000)", "number-too-large", 1, 9),
    ("f = x + 1e-999", "number-too-small", 1, 9),
    ("f = x + 2^-9^9^99", "number-too-small", 1, 9),
    ("f = x + sqrt(-1)", "not-real", 1, 9),
    ("f = x + log(0)", "not-real", 1, 9),
    ("f = x + (-8)^(1/3)", "not-real", 1, 10),
    ("f = x/0", "division-by-zero", 1, 7),
    ("f = x + 1/(y - y)", "division-by-zero", 1, 12),
    ("f = x + 0^-1", "division-by-zero", 1, 9),
    ("f = x + 1/sin(0)", "division-by-zero", 1, 11),
    ("f = x^1001", "too-large", 1, 5),
    ("f = (x^100)^100", "too-large", 1, 6),
    ("f = ((3*x)^100 + y - y)^100", "too-large", 1, 6),
    ("f = min((3*x)^100, (3*x)^100)^100", "too-large", 1, 5),
    ("f = x +", "unfinished", 1, 7),
    ("f = x + ;g = y", "unfinished", 1, 7),
    ("f =", "unfinished", 1, 3),
    ("f", "unfinished", 1, 1),
    ("letter a", "unfinished", 1, 8),
    ("variant b: a = 1,", "unfinished", 1, 17),
    ("system", "unfinished", 1, 1),
    ("f = sin(", "unfinished", 1, 8),
    ("f = (x + y", "unclosed", 1, 5),
    ("f = (x + y\ng = x", "unclosed", 1, 5),
    ("f = rfAND(x, (y + 1)\ng = x", "unclosed", 1, 10),
    ("bounds x [0, 1 y [0, 1]", "syntax", 1, 16),
    ('letter a = 1 "what\nf = x', "unclosed", 1, 14),
    ("f = x y", "syntax", 1, 7),
    ("f = 2x", "syntax", 1, 6),
    ("f = x)", "syntax", 1, 6),
    ("f = *x", "syntax", 1, 5),
    ("f = x\n + y", "syntax", 2, 2),
    ("f == x", "syntax", 1, 4),
    ("f + x", "syntax", 1, 3),
    ("3 = x", "syntax", 1, 1),
    ("f = letter", "syntax", 1, 5),
    ("f = x, y", "syntax", 1, 6),
    ("f = [x]", "syntax", 1, 5),
    ("f = 1.2.3", "syntax", 1, 8),
    ("f = 1e", "syntax", 1, 6),
    ("f = x @ y", "character", 1, 7),
    ("f = x'", "character", 1, 6),
    ("f = x\x00", "character", 1, 6),
    ("letter a = x", "letter-value", 1, 12),
    ("letter a = sqrt(2)", "letter-value", 1, 12),
    ("letter a = 5 in [6, 7]", "letter-range", 1, 8),
    ("letter a = 5 in [7, 1]", "letter-range", 1, 17),
    ("letter a = 5 in [1, 9]\nvariant b: a = 10", "letter-range", 2, 12),
    ("letter a = 1; variant b: aa = 9", "unknown-name", 1, 26),
    ("system Rbeta; f = x", "unknown-system", 1, 8),
    ("system Ralpha; f = x", "parameter", 1, 8),
    ("system Ralpha 2; f = x", "parameter", 1, 15),
    ("letter q = 3; system Rp q - 2; f = x", "letter-value", 1, 25),
    ("letter q = 3; system R0m x; f = x", "letter-value", 1, 26),
    ("letter q = 1; system Rp q; f = x", "parameter", 1, 25),
    ("system R0 0.5; f = x", "parameter", 1, 11),
    ("coordinates x; f = x", "coordinates", 1, 1),
    ("coordinates x y z t; f = x", "coordinates", 1, 1),
    ("bounds x [0, 1]; f = x", "bounds", 1, 1),
    ("bounds x [1, 0] y [0, 1]; f = x", "bounds", 1, 10),
    ("bounds x [0, 1] y [0, 1] w [0, 1]; f = x", "bounds", 1, 26),
    ("bounds x [0, 1] x [0, 1]; f = x", "bounds", 1, 17),
    ("", "empty", 1, 1),
    ("% nothing\nletter a = 1", "empty", 1, 1),
]


@pytest.mark.parametrize(("text", "code", "line", "column"), REFUSED)
def test_what_is_refused_and_where(text, code, line, column):
    error = refusal(text)
    assert (error.code, error.where) == (code, f"line {line}, column {column}")


def test_remedies_name_what_was_probably_meant():
    assert "'rfAND'" in refusal("f = rfand(x, y)").remedy
    assert "'height'" in refusal("letter height = 1; f = heigth*x").remedy
    assert "5.3" in refusal("letter a = 5,3").remedy
    assert "Cyrillic small letter a" in refusal("f = \u0430").message
    assert "'a'" in refusal("f = \u0430").remedy
    assert "R0, R1" in refusal("system R7; f = x").remedy
    assert "line 1, column 1" in refusal("f = x; f = y").message
    assert "later, at line 2, column 1" in refusal("f = g\ng = x").message


def test_unknown_shapes_and_variants_list_the_known():
    text = "letter a = 1; variant b: a = 2; variant c: a = 3; test1 = x; test2 = a*y"
    shape = refusal(text, shape="tset2")
    assert (shape.code, "test1, test2" in shape.message, "'test2'" in shape.remedy) == ("unknown-shape", True, True)
    assert refusal(text, shape="a").code == "unknown-shape"
    variant = refusal(text, variant="d")
    assert (variant.code, "b, c" in variant.message) == ("unknown-variant", True)
    assert "none" in refusal("f = x", variant="b").message


def test_commas_between_digits_separate_arguments_where_the_arity_is_right():
    assert formula("max(2,5) + x") == x + 5
    assert formula("rfAND(x,2,5)").operands == (x, 2, 5)


def test_what_is_not_text_is_refused():
    with pytest.raises(RsymError) as caught:
        loads(b"f = x")  # type: ignore[arg-type]
    assert caught.value.code == "text"


# ----------------------------------------------------------------------- files


def test_files(tmp_path):
    path = tmp_path / "disc.rf"
    path.write_bytes("\ufeff% коло\nletter r = 2\nomega = r^2 - x^2 - y^2\ndisc = -omega".encode())
    assert load(path).expression == r**2 - x**2 - y**2
    assert load(str(path), shape="disc").expression == x**2 + y**2 - r**2


@pytest.mark.parametrize(
    ("name", "content", "code", "where"),
    [
        ("missing.rf", None, "missing-file", ""),
        ("null\0.rf", None, "unreadable-file", ""),
        ("latin.rf", "f = x % \u00e9\n".encode("latin-1"), "encoding", "line 1, column 9"),
        ("binary.rf", "f = x\n% \u00e9 ".encode() + b"\xff", "encoding", "line 2, column 5"),
        ("long.rf", b" " * 900_000, "too-large", ""),
        ("wrong.rf", b"f = x\ng = ", "unfinished", "line 2, column 3"),
    ],
)
def test_files_that_are_refused(tmp_path, name, content, code, where):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(RsymError) as caught:
        load(path)
    assert (caught.value.code, caught.value.where) == (code, where)
    assert caught.value.remedy


def test_a_folder_is_not_a_model(tmp_path):
    with pytest.raises(RsymError, match="cannot read"):
        load(tmp_path)


# --------------------------------------------------------------- hostile texts


def doubling(operation: str, count: int = 2_000) -> str:
    """a1 = op(a0), a2 = op(a1), ...: twice the size with every line."""
    lines = ["a0 = x + y"]
    lines += [f"a{i + 1} = " + re.sub(r"\bq\b", f"a{i}", operation) for i in range(count)]
    return "\n".join(lines)


HOSTILE = {
    "power tower": ("f = x + 9^9^9^9^9^9", "number-too-large"),
    "tower in a letter": ("letter a = 9^9^9^9\nf = a", "number-too-large"),
    "tower of one half": ("f = x + 2^-9^9^9^9", "number-too-small"),
    "long literal": ("f = x + " + "9" * 190_000, "number-too-large"),
    "long exponent": ("f = x + 1e" + "9" * 190_000, "number-too-large"),
    "exponential tower": ("f = x + exp(exp(exp(exp(100))))", "number-too-large"),
    "hidden exponential tower": ("f = abs(sin(exp(exp(x - x + 100))) - 1) + y", "number-too-large"),
    "brackets": ("f = " + "(" * 5_000 + "x" + ")" * 5_000, "too-deep"),
    "calls": ("f = " + "sin(" * 5_000 + "x" + ")" * 5_000, "too-deep"),
    "square brackets": ("f = " + "[" * 5_000, "syntax"),
    "tower of squares": ("f = x" + "^2" * 5_000, "too-large"),
    "huge name": ("a" * 100_000 + " = x", "name"),
    "dunder": ("__import__('os').system('true')", "name"),
    "code": ("f = eval(x)", "unknown-name"),
    "lambda": ("f = lambda: x", "syntax"),
    "long text": ("%" * 200_001, "too-large"),
    "many words": ("f = x" + "+x" * 10_000, "too-large"),
    "many empty lines": ("\n" * 150_000, "too-large"),
    "doubling sums": (doubling("q + q*y"), "too-large"),
    "doubling products": (doubling("q*q + x"), "too-large"),
    "doubling conjunctions": (doubling("rfAND(q, -q)"), "too-large"),
    "doubling minima": (doubling("min(q, -q)"), "too-large"),
    "doubling roots": (doubling("sqrt(q*q + q)"), "too-large"),
    "doubling moduli": (doubling("abs(q)*sin(q)"), "too-large"),
    "doubling towers": (doubling("q^q"), "too-large"),
    "doubling quotients": (doubling("q/(q + 1)"), "too-large"),
    "doubling constants": ("c0 = sqrt(2)\n" + "\n".join(f"c{i + 1} = c{i}*sin(c{i})" for i in range(99)), "too-large"),
    "a long chain": ("f0 = x\n" + "\n".join(f"f{i + 1} = sin(f{i})" for i in range(1_500)), "too-deep"),
    "long coefficients": (
        "f = (1.234567890123*x)^1000\n" + "\n".join(f"g{i} = f*f/{i + 3}" for i in range(2_000)),
        "too-large",
    ),
    "wide sums": (
        "f = " + "+".join(f"x^{i % 1000}*y" for i in range(1_500)) + "\n" + "\n".join(f"g{i} = 3*f" for i in range(99)),
        "too-large",
    ),
}


@pytest.mark.random
@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_texts_are_refused(name):
    text, code = HOSTILE[name]
    assert refusal(text).code == code


def test_algebraic_zeros_are_not_decided():
    shape = loads("f = x + abs(sqrt(2)*sqrt(3) - sqrt(6)) + sin(exp(100))")
    assert sum(isinstance(part, Held) for part in postorder(shape.expression)) == 2
    shape = loads("f = x/(y + abs(sqrt(2) + sqrt(3) - sqrt(5 + 2*sqrt(6))))")
    assert shape.expression.free_symbols == {x, y}


@pytest.mark.slow
def test_long_flat_formulas_are_read():
    assert formula("+".join(["x"] * 5_000)) == 5_000 * x
    assert formula("*".join(["x"] * 900)) == x**900
    assert len(formula("rfAND(" + ",".join(["x", "y"] * 2_000) + ")").operands) == 4_000
    assert formula("-" * 5_001 + "x") == -x
    deep = loads("f0 = x\n" + "\n".join(f"f{i + 1} = rfOR(rfAND(f{i}, x - {i}), y)" for i in range(300)))
    assert set(symbols_of(deep.expression)) == {x, y}


@pytest.mark.slow
def test_conjunctions_written_out_in_roots_are_read():
    lines = [f"f{i + 1} = f{i} + (y - {i}*x) - sqrt(f{i}^2 + (y - {i}*x)^2)" for i in range(9)]
    shape = loads("f0 = x\n" + "\n".join(lines))
    point = np.array([[0.3], [4.0]])
    expected = conjunction(point[0], *(point[1] - i * point[0] for i in range(9)))
    np.testing.assert_allclose(values(shape, point), expected, rtol=1e-12)


def test_a_deep_caller_gets_the_same_error():
    def within(depth: int, call: Callable[[], object]) -> object:
        return call() if depth == 0 else within(depth - 1, call)

    text = "f = " + "(-1*" * 90 + "x" + "+1)" * 90
    with pytest.raises(RsymError) as caught:
        within(700, lambda: loads(text))
    assert caught.value.code == "too-deep"


FRAGMENTS = st.one_of(
    st.sampled_from(
        [
            *("letter a = ", "letter b = 2 in [1, 3]", "variant v: a = 2", "coordinates x y", "bounds x [0, 1]", "in"),
            *(
                "system R1",
                "omega = ",
                "f = ",
                "g = ",
                "\n",
                "\n",
                ";",
                "x",
                "y",
                "z",
                "a",
                "f",
                "g",
                "pi",
                "E",
                "lambda",
            ),
            *("+", "-", "*", "/", "^", ".^", "**", "./", ",", "(", "(", ")", ")", "[", "]", "=", ":", "%", "#", '"'),
            *("rfAND(", "rfOR(x, ", "rfNOT(", "trimming(", "sqrt(", "abs(", "sin(", "exp(", "log(", "min(", "max(x, "),
            *("atan2(", "0", "1", "2", "9", ".5", "1e300", "1e-300", "5,3", "2.", "x - x", "9^9^9", "exp(exp(100))"),
            *(" ", "\t", "\u0430", "\u2212", "__import__", "'", "\\", "\ufeff", "\x00", "\ud800"),
        ]
    ),
    st.text(max_size=5),
    st.text(alphabet=string.printable, max_size=8),
    st.decimals(allow_nan=False, allow_infinity=False).map(str),
)
FORMULAS = st.recursive(
    st.sampled_from(["x", "y", "z", "a", "2", "0", "0.5", "sqrt(2)", "pi", "-1", "3"]),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/^"), inner).map(lambda t: f"({t[0]}{t[1]}{t[2]})"),
        st.tuples(st.sampled_from(["sin", "abs", "sqrt", "exp", "log", "rfNOT"]), inner).map(
            lambda t: f"{t[0]}({t[1]})"
        ),
        st.tuples(st.sampled_from(["rfAND", "rfOR", "min", "max", "atan2", "trimming"]), inner, inner).map(
            lambda t: f"{t[0]}({t[1]}, {t[2]})"
        ),
    ),
    max_leaves=25,
)
TEXTS = st.one_of(
    st.lists(FRAGMENTS, max_size=40).map("".join),
    st.lists(FORMULAS, min_size=1, max_size=4).map(
        lambda formulas: "letter a = 1\n" + "\n".join(f"f{i} = {text}" for i, text in enumerate(formulas))
    ),
    st.tuples(FORMULAS, FRAGMENTS, FORMULAS).map(lambda t: f"letter a = 1; omega = {t[0]}{t[1]}{t[2]}"),
)


@settings(max_examples=examples(2_000), deadline=1_000, suppress_health_check=[HealthCheck.too_slow])
@given(TEXTS)
def test_any_text_gives_a_shape_or_an_error_of_ours(text):
    try:
        shape = loads(text)
    except RsymError as error:
        assert error.code  # noqa: PT017
        assert error.remedy  # noqa: PT017
    else:
        assert shape.expression.is_commutative
        assert {symbol.name for symbol in shape.expression.free_symbols} <= {"x", "y", "z", *shape.letters}


# ------------------------------------------------------------ the paper's models


def conjunction(*operands):
    total, *rest = operands
    for operand in rest:
        total = total + operand - np.hypot(total, operand)
    return total


def disjunction(*operands):
    return -conjunction(*(-operand for operand in operands))


def car_oracle(points, variant):
    """Closed body with arches (Fig. 5) and wheels (Fig. 8a), from the figures' numbers."""
    px, py, pz = points
    first = {"a": (8, 15, 5, 60, 3), "b": (9, 14, 4, 70, 1)}[variant]
    length, boot, lid, plane, radius = first
    roof = 1 - (py / length) ** 2 - ((pz - 4) / 4) ** 2
    back = conjunction(-py * (py + boot) / boot, lid - pz)
    front = conjunction((plane - 2.5 * py - 10 * pz) / np.hypot(2.5, 10), (18 - py) * (py - 1) / 17)
    inner = (9 - px**2) / 6
    arches = [disjunction(((py - axle) ** 2 + pz**2 - radius**2) / (2 * radius), inner) for axle in (-6, 7)]
    body = conjunction(conjunction(disjunction(roof, back, front), pz), conjunction(*arches))
    tyre = radius - 0.2
    wheels = [
        disjunction(
            *(
                conjunction(
                    (tyre**2 - (py - axle) ** 2 - pz**2) / (2 * tyre), (6.5 - side * px) * (side * px - 4) / 2.5
                )
                for side in (1, -1)
            )
        )
        for axle in (-6, 7)
    ]
    return conjunction(body, (36 - px**2) / 12), disjunction(*wheels)


@pytest.fixture(scope="module")
def points():
    low, high = np.array([[-8], [-16], [-4]]), np.array([[8], [17.5], [9]])
    return low + (high - low) * np.random.default_rng(5).random((3, 2_000))


@pytest.mark.slow
@pytest.mark.parametrize("variant", ["a", "b"])
def test_the_car_is_the_formula_of_the_figures(points, variant):
    body, wheels = car_oracle(points, variant)
    scale = np.abs(body).max()
    np.testing.assert_allclose(
        values(load(CAR, shape="test1", variant=variant), points), body, rtol=0, atol=1e-12 * scale
    )
    sides = values(load(CAR, shape="test3", variant=variant), points)
    with_wheels = values(load(CAR, shape="test4", variant=variant), points)
    scale = np.abs(with_wheels).max()
    np.testing.assert_allclose(with_wheels, disjunction(sides, wheels), rtol=0, atol=1e-12 * scale)


@pytest.mark.slow
def test_the_car_has_what_the_figures_show():
    places = {
        **{"middle": (0, 0, 1), "arch": (5, 7, 1), "corner": (5.9, 15.5, 1), "side window": (5.5, 4, 6)},
        **{"headlight": (4.5, 14.5, 2), "sky": (0, 0, 100)},
    }
    inside = {
        stage: dict(zip(places, values(load(CAR, shape=stage), np.array(list(places.values())).T) > 0, strict=True))
        for stage in ("test1", "test2", "test4", "test5", "W")
    }
    assert inside["W"]["middle"]
    assert not inside["test1"]["arch"]
    assert inside["test4"]["arch"]  # the wheel in it
    assert inside["test1"]["corner"]
    assert not inside["test2"]["corner"]  # rounded
    assert inside["test4"]["side window"]
    assert not inside["test5"]["side window"]
    assert inside["test5"]["headlight"]
    assert not inside["W"]["headlight"]
    assert not inside["W"]["sky"]  # the printed W is positive there


def test_the_car_file():
    shape = load(CAR)
    assert shape.definitions[-1][0] == "W"
    box = ((-8.0, 8.0), (-16.0, 17.5), (-4.0, 9.0))  # the least that holds the car
    assert all(low <= lower and upper <= high for (lower, upper), (low, high) in zip(box, shape.bounds, strict=True))
    assert len(shape.letters) == 45  # xs only closes Figs 5 and 6
    assert all(letter.doc and letter.minimum is not None for letter in shape.letters.values())
    assert load(CAR, variant="a").letters == shape.letters
    changed = load(CAR, variant="b").letters
    assert {name: float(changed[name].default) for name in changed if changed[name] != shape.letters[name]} == {
        **{"a1": 9, "y2": 14, "z2": 4, "c3": 70, "ra": 1, "rk": 18, "rb": 16, "ab": 1.4}
    }


def test_the_skeleton_body():
    shape = load(SKELETON)
    assert {name: float(letter.default) for name, letter in shape.letters.items()} == {
        **{"a": 5, "a1": 8, "a2": 5.3, "p1": 40, "p2": 0.1}
    }
    points = np.random.default_rng(6).uniform(-4, 4, (2, 500))
    f, t = points[1], (25 - points[0] ** 2) / 10
    segment = np.sqrt(((np.sqrt(f**4 + t**2) - t) / 2) ** 2 + f**2)
    body = -segment + (8 - points[0]) * (5.3 + points[0]) / 40 - 0.1
    np.testing.assert_allclose(values(shape, points), body, rtol=0, atol=1e-13)
    assert shape.bounds == ((-8.0, 9.0), (-4.0, 4.0))
