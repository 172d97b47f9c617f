"""Texts of fidget and MPR: what is read is what numpy reads, in the sign of rsym; what is written loads again."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.line_texts import ONE, TWO, Writer, blended, differences_of, lattice, lettering, numbers_of

import rsym
from rsym import R1, RsymError, Shape, x, y, z
from rsym.cli import main
from rsym.language.vm import OPERATIONS, shape_of_lines
from rsym.model.rnodes import R1Conjunction, R1Disjunction
from rsym.model.symbols import postorder

POINTS = np.random.default_rng(1).uniform(-1, 1, (3, 200))


def load(folder, text, name="model.vm"):
    """A shape from a file."""
    path = folder / name
    path.write_text(text)
    return rsym.load(path)


def check(text, points=POINTS, rtol=1e-13, known=0.9):
    """Value and gradient of what was read, against numpy; the gradient is NaN on ties of min and max."""
    shape = shape_of_lines(text)
    points = points[: shape.dimension]
    found = rsym.compile(shape, ("value", "gradient"), backend="numpy")(*points)
    expected = numbers_of(text, points)
    assert_close(found["value"], -expected, rtol=rtol, atol=rtol * np.abs(expected).max())
    slopes, clear = -differences_of(text, points), np.isfinite(found["gradient"]).all(axis=1)
    near = np.abs(found["gradient"].T - slopes).max(axis=0) <= 1e-5 * np.abs(slopes).max()
    assert clear.mean() >= known
    assert near[clear].sum() >= 0.99 * clear.sum()  # but where the step of the differences crosses a kink
    assert not {sp.Min, sp.Max} & {type(part) for part in postorder(shape.expression)}
    return shape


def test_a_file_is_a_shape_negative_where_the_text_is_positive(tmp_path):
    text = "# a disc\n\n_0 var-x\n_1\tvar-y  # across\r\n_2 square _0\n_3 square _1\n_4 add _2 _3\n_5 const 2.25e0\n"
    text += "_6 sub _4 _5"
    disc = load(tmp_path, text, "DISC.VM")
    function = sp.Add(sp.Add(x**2, y**2, evaluate=False), -sp.Rational(9, 4), evaluate=False)
    assert disc.expression == sp.Mul(-1, function, evaluate=False)
    assert disc.coordinates == (x, y)
    assert (disc.bounds, disc.parts, disc.definitions, dict(disc.letters)) == (None, (), (), {})
    assert disc.contains([0, 1.4, 1.6], 0).tolist() == [True, True, False]
    assert rsym.load(tmp_path / "DISC.VM") is disc


@pytest.mark.parametrize("operation", OPERATIONS)
def test_every_operation(operation):
    """Of what varies, of a constant and of both; asin and acos within their domain."""
    w = Writer()
    a, b, c = w.line("var-x"), w.line("var-y"), w.const(0.7)
    near = w.line("sub", w.line("mul", a, w.const(0.5)), w.line("abs", b))
    if operation in ONE:
        made = [near if operation in ("asin", "acos", "neg") else w.line("square", near), c]
        results = [w.line(operation, one) for one in made]
    else:
        results = [w.line(operation, *pair) for pair in ((a, near), (near, c), (c, near), (c, c), (near, near))]
    w.folded("add", [*results, w.line("mul", a, b)])
    if operation in ("asin", "acos"):
        inside = POINTS[:, np.abs(0.5 * POINTS[0] - np.abs(POINTS[1])) < 0.9]
        check(w.text(), inside)
    else:
        # min(u, u) and compare(u, v) are not differentiated on their ties.
        check(w.text(), known=0.0 if operation in ("compare", "min", "max") else 0.9)
    assert set(OPERATIONS) == set(ONE) | set(TWO)


def test_constants_are_exact_decimals():
    shape = shape_of_lines("a var-x\nb const 0.1\nc mul a b\nd const -3.\ne add c d\nf const .5\ng div e f")
    numbers = {part for part in postorder(shape.expression) if part.is_Number}
    assert numbers == {sp.Rational(1, 10), sp.Integer(-3), sp.Integer(2), sp.Integer(-1)}
    folded = shape_of_lines("a const 2\nb sqrt a\nc const 3\nd div c a\ne mul b d\nx var-x\nf add x e")
    assert rsym.compile(folded, backend="numpy")(1.0, 0.0)["value"] == -(1 + np.sqrt(2) * 1.5)


def test_a_chain_of_min_is_one_node_and_what_is_shared_is_one_part():
    w = Writer()
    a, b = w.line("var-x"), w.line("var-y")
    twice = w.line("add", a, b)
    again = w.line("add", a, b)
    ends = [w.line("sub", twice, w.const(0.1 * k)) for k in range(9)]
    low = w.folded("min", ends)
    low = w.line("min", w.line("square", again), low)
    w.line("max", low, w.line("min", w.line("neg", low), a))
    shape = check(w.text())
    parts = postorder(shape.expression)
    assert [len(part.args) for part in parts if isinstance(part, R1Conjunction)] == [10, 2]
    assert [len(part.args) for part in parts if isinstance(part, R1Disjunction)] == [2]
    assert sum(part == x + y for part in parts) == 1


def test_minima_that_others_need_are_not_copied():
    """Each of them twice: flat, the last would have more operands than there are atoms."""
    lines = ["_0 var-x", "_1 var-y", "c const 0.5"]
    for k in range(2, 200):
        lines += [f"s{k} sub _{k - 2} c", f"_{k} min _{k - 1} {f's{k}' if k % 3 else f'_{k - 2}'}"]
    shape = check("\n".join(lines), known=0.0)
    assert sum(len(part.args) for part in postorder(shape.expression)) < 5 * len(lines)


@pytest.mark.parametrize("gate", ["min", "max"])
def test_of_two_such_minima_the_smaller(gate):
    other = {"min": "max", "max": "min"}[gate]
    text = f"a var-x\nb var-y\nu {gate} a b\nc neg b\nv {gate} c a\nw {gate} u v\np mul u v\nq {other} w p"
    check(f"{text}\nr add q b", known=0.5)  # where a decides in both, the choice between them is a tie


def test_plane_or_space():
    assert shape_of_lines("a var-x").coordinates == (x, y)
    assert shape_of_lines("a var-z\nb var-x").coordinates == (x, y, z)


BAD = {
    "": ("empty", "line 1, column 1"),
    "# nothing\n\n": ("empty", "line 1, column 1"),
    "a var-x\nb": ("unknown-operation", "line 2, column 1"),
    "a var-x\nb sqroot a": ("unknown-operation", "line 2, column 3"),
    "a var-w": ("unknown-operation", "line 1, column 3"),
    "a var-x\nb mod a a": ("unsupported-function", "line 2, column 3"),
    "a var-x\n\nb  sqrt  c": ("unknown-name", "line 3, column 10"),
    "a var-x\nb add a b": ("unknown-name", "line 2, column 9"),
    "a var-x\nb add a": ("arity", "line 2, column 3"),
    "a var-x\nb sqrt a a": ("arity", "line 2, column 3"),
    "a var-x 1": ("arity", "line 1, column 3"),
    "a const": ("arity", "line 1, column 3"),
    "a var-x\nb var-y\na sqrt b": ("redefinition", "line 3, column 1"),
    "a const 1,5": ("number", "line 1, column 9"),
    "a const 0x10": ("number", "line 1, column 9"),
    "a const NaN": ("number", "line 1, column 9"),
    "a const -inf": ("number", "line 1, column 9"),
    "a const 1e999": ("number-too-large", "line 1, column 9"),
    "a const 1e99999999999999": ("number-too-large", "line 1, column 9"),
    "a const 1e-400": ("number-too-small", "line 1, column 9"),
    f"a const {'1' * 5000}": ("number-too-large", "line 1, column 9"),
    "a const 1\nb sqrt a": ("constant", "line 2, column 3"),
    "a var-x\nb const 0\nc div a b": ("division-by-zero", "line 3, column 9"),
    "a var-x\nb const 0\nc div b b\nd add a c": ("division-by-zero", "line 3, column 3"),
    "a var-x\nb const -1\nc sqrt b\nd add a c": ("not-real", "line 3, column 3"),
    "a var-x\nb const 1e200\nc square b\nd square c\ne add a d": ("number-too-large", "line 3, column 3"),
}


@pytest.mark.parametrize("text", BAD, ids=lambda text: text.replace("\n", ";")[:40])
def test_what_is_no_such_text_is_refused_at_its_place(text):
    with pytest.raises(RsymError) as caught:
        shape_of_lines(text)
    assert (caught.value.code, caught.value.where) == BAD[text]
    assert caught.value.remedy


@pytest.mark.parametrize("text", ["__import__('os').abort() var-x", "a __import__('os').abort()", "a const exit()"])
def test_text_is_never_run(text):
    if text.endswith("var-x"):
        assert shape_of_lines(text).expression == -x
    else:
        with pytest.raises(RsymError):
            shape_of_lines(text)


def test_a_file_is_refused_as_others_are(tmp_path):
    with pytest.raises(RsymError) as caught:
        rsym.load(tmp_path / "none.vm")
    assert caught.value.code == "missing-file"
    (tmp_path / "latin.vm").write_bytes(b"# caf\xe9\na var-x")
    (tmp_path / "long.vm").write_bytes(b"#" * 4_100_000)
    for name, code in (("latin", "encoding"), ("long", "too-large")):
        with pytest.raises(RsymError) as caught:
            rsym.load(tmp_path / f"{name}.vm")
        assert caught.value.code == code
    load(tmp_path, "a var-x")
    for what in ("shape", "variant"):
        with pytest.raises(RsymError) as caught:
            rsym.load(tmp_path / "model.vm", **{what: "b"})
        assert caught.value.code == f"unknown-{what}"


LINKS = {
    "sums": "_{n} add _{k} x",
    "functions": "_{n} sin _{k}",
    "sums of functions": "s{k} sin _{k}\n_{n} add s{k} y",
    "quotients": "_{n} div x _{k}",
    "squares": "q{k} square _{k}\nh{k} mul q{k} half\n_{n} sub h{k} x",
    "min and max": "l{k} sub _{k} half\nm{k} max l{k} x\n_{n} min y m{k}",
    "one long min": "c{k} const {k}.5\nl{k} sub x c{k}\n_{n} min _{k} l{k}",
    "shared": "s{k} sin _{k}\nm{k} mul s{k} _{k}\n_{n} min m{k} _{k}",
}


def chain(link, links):
    """Of so many links."""
    return "\n".join(
        ["x var-x", "y var-y", "half const 0.5", "_0 mul x y", *(link.format(k=k, n=k + 1) for k in range(links))]
    )


def shown(text, folder):
    """Read, shown, read again with a line more, lowered, evaluated."""
    shape = load(folder, text)
    assert len(repr(shape)) < 4000
    assert len(str(shape)) < 4000
    assert len(shape._repr_html_()) < 6000
    assert len(shape._repr_latex_()) < 6000
    more = load(folder, f"{text}\nlast neg {text.splitlines()[-1].split()[0]}")
    points = POINTS[:2, :5]
    with np.errstate(all="ignore"):
        values = [rsym.compile(one, backend="numpy")(*points)["value"] for one in (shape, more)]
    expected = numbers_of(text, points)
    known = np.isfinite(expected)
    assert_close(values[0][known], -expected[known], rtol=1e-9, atol=1e-9)
    assert np.array_equal(values[0], -values[1], equal_nan=True)
    return shape


@pytest.mark.random
@pytest.mark.parametrize("name", LINKS)
def test_deep_texts_are_read_and_shown(name, tmp_path):
    shown(chain(LINKS[name], 350), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sums of functions", "min and max"])
def test_texts_of_ten_thousand_levels(name, tmp_path):
    shape = shown(chain(LINKS[name], 10_000), tmp_path)
    assert rsym.source(shape, "vm").count("\n") >= 10_000


MADE = {"letters": lambda: lettering(2, 3), "lattice": lambda: lattice(2), "blend": lambda: blended(5)}
LARGE = {"letters": lambda: lettering(13, 13), "lattice": lambda: lattice(6), "blend": lambda: blended(60)}


@pytest.mark.parametrize("name", MADE)
def test_models_of_that_kind(name):
    check(MADE[name]())


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGE)
def test_large_models_of_that_kind(name):
    text = LARGE[name]()
    assert name != "letters" or text.count("\n") > 5_000
    shape = check(text)
    again = shape_of_lines(rsym.source(shape, "vm"))
    kernels = [rsym.compile(one, ("value", "gradient"), backend="numpy") for one in (shape, again)]
    first, second = (kernel(*POINTS[: shape.dimension]) for kernel in kernels)
    assert all(np.array_equal(first[field], second[field], equal_nan=True) for field in first)


# Written once, a model has only operations that the format has: from then on the bits stay. What is normalised is
# lowered with its squares in the order of the nodes, which is another one after reading.
SHIPPED = "car skeleton valve streamlined clip gear lattice snowflake solids spring vase".split()


@pytest.mark.random
@pytest.mark.parametrize("name", [*SHIPPED, "gyroid"])
def test_what_is_written_loads(name):
    shape = rsym.load(name)
    again = shape_of_lines(rsym.source(shape, "vm"))
    third = shape_of_lines(rsym.source(again, "vm"))
    assert [one.dimension for one in (again, third)] == [shape.dimension] * 2
    box = np.array(shape.bounds)
    points = box[:, :1] + (POINTS[: shape.dimension] + 1) / 2 * np.diff(box)
    fields = [rsym.compile(one, ("value", "gradient"), backend="numpy")(*points) for one in (shape, again, third)]
    for field in ("value", "gradient"):
        known = np.isfinite(fields[0][field])
        size = np.abs(fields[0][field][known]).max()
        assert_close(fields[1][field][known], fields[0][field][known], rtol=1e-12, atol=1e-12 * size)
        if name == "gyroid":
            assert_close(fields[2][field], fields[1][field], rtol=1e-12, atol=1e-13)
        else:
            assert np.array_equal(fields[2][field], fields[1][field], equal_nan=True)


@pytest.mark.parametrize("shape", [rsym.disc(1), rsym.load("solids"), rsym.load("lattice").with_system(R1)])
def test_what_the_format_has_keeps_its_bits(shape):
    again = shape_of_lines(rsym.source(shape, "vm"))
    points = 3 * POINTS[: shape.dimension]
    first, second = (rsym.compile(one, ("value", "gradient"), backend="numpy")(*points) for one in (shape, again))
    assert first["value"].tobytes() == second["value"].tobytes()
    assert np.array_equal(first["gradient"], second["gradient"], equal_nan=True)


def test_a_body_without_z_stays_one():
    text = rsym.source(Shape(1 - x**2 - y**2, (x, y, z)), "vm")
    assert shape_of_lines(text).coordinates == (x, y, z)


def test_commands_take_such_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    load(tmp_path, "a var-x\nb var-y\nc square a\nd square b\ne add c d\nf sqrt e\ng const 1\nh sub f g\ni max h a")
    for arguments, said in (
        (["show", "model.vm"], "omega = -disjunction(sqrt(x**2 + y**2) - 1, x, system=R1)"),
        (["show", "model.vm", "--latex"], r"\omega &= "),
        (["letters", "model.vm"], "no letters"),
        (["lint", "model.vm"], "no finding in 2 leaves"),
        (["source", "model.vm", "--language", "vm", "-o", "again.vm"], "again.vm"),
        (["show", "again.vm", "--model"], "omega = "),
    ):
        assert main(arguments) == 0, arguments
        assert said in capsys.readouterr().out, arguments
    load(
        tmp_path, "a var-x\nb var-y\nc square a\nd square b\ne add c d\nf const 0.5\ng sub e f\nh max a g", "quarter.vm"
    )
    assert main(["lint", "quarter.vm"]) == 1  # a sum in a sum is a polynomial too
    assert "not normalised" in capsys.readouterr().out
    assert main(["show", "model.vm", "--set", "a=1"]) == 1
    assert main(["show", "model.vm", "--variant", "b"]) == 1
    (tmp_path / "bad.vm").write_text("a var-x\nb tanh a")
    capsys.readouterr()
    assert main(["show", "bad.vm"]) == 1
    assert "line 2, column 3: no operation 'tanh'" in capsys.readouterr().err
