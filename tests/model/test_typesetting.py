import pytest
import sympy as sp

from rsym import RsymError
from rsym.language.listing import definitions
from rsym.language.loading import loads
from rsym.language.syntax import ARITIES
from rsym.model.abridging import typeset_name
from rsym.model.shape import Shape
from rsym.model.showing import latex
from rsym.model.symbols import x, y
from rsym.output.equations import equation


@pytest.mark.parametrize(
    ("formula", "latex"),
    [
        ("1 - x^2/a^2", r"1 - \frac{x^{2}}{a^{2}}"),
        ("-x*y", "-x y"),
        ("x - (y - 2)", r"x - \left(y - 2\right)"),
        ("x + (-y)", r"x + \left(-y\right)"),
        ("(x + y)*x", r"\left(x + y\right) x"),
        ("x*3*2", r"x \cdot 3 \cdot 2"),
        ("x/y*a/2", r"\frac{x a}{y \cdot 2}"),
        ("(x/y)^2", r"\left(\frac{x}{y}\right)^{2}"),
        ("x^2^3", r"\left(x^{2}\right)^{3}"),
        ("x^-a", "x^{-a}"),
        ("sqrt(x + 1)^3", r"\sqrt{x + 1}^{3}"),
        ("2.50*x", "2.5 x"),
        ("1e-20*x", r"1 \cdot 10^{-20} x"),
        ("abs(x - y)", r"\left|x - y\right|"),
        ("atan2(y, x)", r"\mathrm{atan2}\left(y, x\right)"),
        ("trimming(y, x)", r"\rho\left(y;\, x\right)"),
        ("rfOR(x, y - 1, a*x)", r"x \vee_0 \left(y - 1\right) \vee_0 \left(a x\right)"),
        ("rfAND(rfAND(x, y), rfNOT(x))", r"\left(x \wedge_0 y\right) \wedge_0 \left(-x\right)"),
        ("2*rfAND(x, y)", r"2 \left(x \wedge_0 y\right)"),
        ("-rfAND(x, y)", r"-\left(x \wedge_0 y\right)"),
        ("joining(x, y - 1)", r"x \cup_{2} \left(y - 1\right)"),
        ("equivalence(x, y)", r"x \sim_{2} y"),
        ("difference(x, y, a)", r"x \wedge_0 \left(-y\right) \wedge_0 \left(-a\right)"),
        ("implication(x, y)", r"\left(-x\right) \vee_0 y"),
        (
            "exclusive_or(x, y)",
            r"\left(x \wedge_0 \left(-y\right)\right) \vee_0 \left(\left(-x\right) \wedge_0 y\right)",
        ),
    ],
)
def test_formulas_keep_their_order_and_their_brackets(formula, latex):
    (definition,) = definitions(f"letter a = 1; f = {formula}")
    assert definition.latex == f"f = {latex}"


@pytest.mark.parametrize(
    ("name", "latex"),
    [
        ("x", "x"),
        ("zb", "z_{b}"),
        ("ho1", "h_{o1}"),
        ("omega123", r"\omega_{123}"),
        ("f_o", "f_{o}"),
        ("rim2_a_b", r"\mathrm{rim}_{2,a,b}"),
        ("pi", r"\pi"),
        ("a__", "a"),
        ("x1y", "x_{1y}"),
    ],
)
def test_names(name, latex):
    assert typeset_name(name) == latex


def test_definitions_are_those_that_the_shape_needs_with_names_as_symbols(tmp_path):
    text = "letter a = 2; unused = x; f = a*x; g = f + y; omega = f*g"
    listed = definitions(text)
    assert [definition.name for definition in listed] == ["f", "g", "omega"]
    assert listed[2].expression == sp.Symbol("f", real=True) * sp.Symbol("g", real=True)
    assert [definition.name for definition in definitions(text, shape="unused")] == ["unused"]
    (tmp_path / "model.rf").write_text(text)
    assert definitions(tmp_path / "model.rf") == listed


def test_the_sign_is_that_of_the_system():
    assert definitions("system R1; f = rfAND(x, y)")[0].latex == r"f = x \wedge_1 y"
    assert definitions("system Rp 4; f = rfOR(x, y)")[0].latex == r"f = x \vee_{p=4} y"
    assert definitions("letter alpha = 0; system Ralpha alpha; f = rfOR(x, y)")[0].latex == r"f = x \vee_{\alpha} y"


def test_every_function_of_the_language_is_latex_that_mathtext_knows():
    for name, (fewest, _) in ARITIES.items():
        (definition,) = definitions(f"f = {name}({', '.join('xyxyxy'[:fewest])})")
        assert equation(definition.latex)


def test_a_shape_prints_its_names_like_its_file():
    shape = loads("letter ra = 2 in [1, 3]; f_o = ra - x; omega = f_o*xk2; letter xk2 = 1")
    assert r"f_{o} &= r_{a} - x" in shape._repr_latex_()
    assert r"r_{a} = 2" in shape._repr_latex_()
    assert r"f_{o} x_{k2}" in shape._repr_latex_()
    assert latex(Shape(sp.Symbol("a'") * x, (x, y), letters={"a'": 1})).endswith("x")


def test_refusals_are_those_of_the_language(tmp_path):
    with pytest.raises(RsymError, match="line 1, column 9"):
        definitions("f = x + q")
    with pytest.raises(RsymError, match="no file"):
        definitions(tmp_path / "missing.rf")
