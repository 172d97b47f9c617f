"""What model files say of functions on shapes: equations and conditions, read as data, refused at their places."""

import pytest

import rsym
from rsym import x, y
from rsym.errors import RsymError
from rsym.language.conditions import parse_condition
from rsym.language.loading import loads
from rsym.language.parser import parse

PLATE = """
letter q = 1 in [0, 4] "heat"
letter d = 0.6 "the bore"
letter other = 2
rim = 4 - x^2 - y^2 "rim"
bore = d^2 - x^2 - y^2 "the bore"
k = 1 + x^2/4
equation = 1 + x  % names, for '=' follows
on = 2*k
omega = rfAND(rim, -bore)
"""
STATED = """
equation -div(k*grad(u)) +
   on*u =  q*equation    % a comment
on rim = q/2
on "the bore" = robin(2, 1 + k)
"""


@pytest.fixture
def loaded(tmp_path):
    def load(text, **options):
        path = tmp_path / "plate.rf"
        path.write_text(text)
        return rsym.load_problem(path, **options)

    return load


def test_a_file_states_a_problem(loaded):
    problem = loaded(PLATE + STATED)
    q, k = problem.conditions["rim"].value * 2, 1 + x**2 / 4
    assert str(problem.equation) == "-div(k*grad(u)) + on*u = q*equation"
    assert problem.conditions["the bore"] == rsym.robin(2, 1 + k)
    assert q.name == "q"
    assert list(problem.shape.letters) == ["q", "d"]
    found = problem.solve(cells=6, letters={"q": 3})
    shape = rsym.loads(PLATE)
    text = "-div((1 + x^2/4)*grad(u)) + 2*(1 + x^2/4)*u = 3*(1 + x)"
    alike = rsym.solve(shape, text, {"rim": 1.5, "the bore": rsym.robin(2, 1 + k)}, cells=6)
    places = [[1.0, -0.7, 0.1], [0.2, 1.1, -1.3]]
    assert found(*places) == pytest.approx(alike(*places), rel=1e-12)


def test_a_file_states_a_hollow_shaft(loaded):
    """Of a round one u = (1 - r^2)/2, at its level in the hole, through which twice its area flows."""
    text = 'letter r = 0.5; rim = disc(1) "rim"; bore = disc(r) "bore"; omega = rfAND(rim, -bore); on rim = 0\n'
    found = loaded(text + "on bore = constant(2*pi*r^2); equation -laplacian(u) = 2").solve(cells=8)
    for solution, level in ((found, 0.375), (found.with_letters({"r": 0.4}), 0.42)):
        assert solution.levels == (("bore", pytest.approx(level, rel=1e-4)),)
    with pytest.raises(RsymError, match="contains x, a coordinate") as caught:
        loaded(text + "on bore = constant(1 + x)")
    assert caught.value.where == "line 2, column 1"


def test_the_shape_is_as_without_these_lines():
    with_lines, without = loads(PLATE + STATED), loads(PLATE)
    assert with_lines == without
    assert list(with_lines.letters) == ["d"]
    assert loads("equation = x; on = rfAND(equation, 1 - x^2 - y^2); omega = on").expression.has(x, y)


def test_variants_hold_for_conditions(loaded):
    problem = loaded(PLATE + "variant hot: q = 4\non rim = q\n", variant="hot")
    assert float(problem.shape.letters["q"].default) == 4
    assert problem.equation is None
    with pytest.raises(RsymError, match="states no equation"):
        problem.solve(cells=8)


@pytest.mark.parametrize(
    ("lines", "place", "word"),
    [
        ("on nothing = 0", 1, "no part 'nothing'"),
        ("on rim = robin(1)*2", 10, "no number"),
        ("on rim = robin()", 10, "robin takes"),
        ("on rim", 4, "'='"),
        ("on 3 = 1", 4, "name of a part"),
        ("on rim = q2", 10, "unknown name 'q2'"),
        ("on rim = 0; on rim = 1", 13, "given already"),
        ("on others = 0; on others = 1", 16, "given already"),
        ("equation -laplacian(u)", 22, "'='"),
        ("equation -laplacian(u) = w", 26, "unknown name 'w'"),
        ("equation -laplacian(u) = 1; equation -laplacian(u) = 2", 29, "given already"),
        ("equation -laplacian(u) = system", 26, "expected a number"),
        ("for k = 0:2, on rim = k; end", 14, "formulas only"),
        ("u = 1 + x; equation -laplacian(u) = 1", 12, "unknown function"),
    ],
)
def test_what_is_refused_names_its_place(lines, place, word, loaded):
    with pytest.raises(RsymError) as caught:
        loaded(PLATE + lines)
    assert caught.value.where == f"line {PLATE.count(chr(10)) + 1}, column {place}"
    assert word in caught.value.message
    assert caught.value.remedy


def test_an_equation_that_is_no_linear_one_is_refused_at_its_place_in_the_file(loaded):
    with pytest.raises(RsymError, match="not linear") as caught:
        loaded(PLATE + "equation -laplacian(u) = u^2; on rim = 0").solve(cells=8)
    assert caught.value.where == f"line {PLATE.count(chr(10)) + 1}, column 26"


def test_an_equation_is_written_as_it_stands():
    (statement,) = parse("equation  -laplacian( u )+...\n  2*u =1 # so\n")
    assert statement.text == "-laplacian( u )+ 2*u =1"


@pytest.mark.parametrize(
    ("text", "part", "kind"),
    [
        ("rim=0", "rim", ""),
        (" wheel arch = robin(2, 1)", "wheel arch", "robin"),
        ('"others"=constant()', "others", "constant"),
        ("others=0", None, ""),
        ("...=neumann(x)", None, "neumann"),
        ("cap x lower=1", "cap x lower", ""),
    ],
)
def test_a_condition_of_the_command_line(text, part, kind):
    found = parse_condition(text)
    assert (found.part, found.kind) == (part, kind)


@pytest.mark.parametrize(
    "text", ["rim", "=0", "", "rim=0 1", "rim=robin(2", "rim=0; omega = 1", "rim=__import__('os')"]
)
def test_a_condition_that_is_none(text):
    with pytest.raises(RsymError) as caught:
        parse_condition(text)
    assert caught.value.remedy
