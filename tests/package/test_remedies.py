"""Every call that a remedy names is carried out: an error that sends to what is refused helps nobody."""

import ast
import re
from pathlib import Path

import numpy as np
import pytest

import rsym
from rsym import x, y, z

PACKAGE = Path(rsym.__file__).parent
NAMED = re.compile(r"rsym\.[a-z_]+\(")


def texts(tree):
    """The texts of a module that are no docstrings."""
    owners = (ast.Module, ast.ClassDef, ast.FunctionDef)
    first = [node.body[0] for node in ast.walk(tree) if isinstance(node, owners) and node.body]
    docstrings = {id(node.value) for node in first if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.value


def calls_in(text):
    """The calls of rsym that a text names, outermost ones, parentheses closed."""
    end = 0
    for match in NAMED.finditer(text):
        if match.start() < end:
            continue
        depth, end = 1, match.end()
        while depth and end < len(text):
            depth += (text[end] == "(") - (text[end] == ")")
            end += 1
        if not depth:
            yield text[match.start() : end]


def named():
    """All calls that texts of the package name, but those of examples and of code that is made."""
    return {
        call
        for path in PACKAGE.rglob("*.py")
        for module in [path.read_text()]
        if any(NAMED.search(line) and not line.lstrip().startswith((">>>", "...")) for line in module.splitlines())
        for text in texts(ast.parse(module))
        if "\n" not in text and ">>>" not in text
        for call in calls_in(text)
        if "{letters}" not in call
    }


DISC = rsym.disc(1).named("rim")
PLATE = rsym.rectangle(2, 2).named("edge") - rsym.disc(0.5).named("bore")
BALL = rsym.sphere(1)
RADIUS = rsym.loads("letter r = 1 in [0.5, 2]; letter s = 1 in [0.5, 2]; omega = (r^2 - x^2 - s*y^2)/(2*r)")
RIM = {"rim": 0}
PLANE = {"shape": DISC, "half": rsym.half_plane((1, 0), 0), "profile": rsym.disc(1) & rsym.half_plane((0, 1), 0)}
FIELD = {"shape": DISC, "count": 1}
MADE = {"shape": RADIUS, "letter_a": "r", "letter_b": "s", "letter": "r", "letters": ["r"]}
MADE |= {"designs": {"one": {"r": 1}}, "points": np.array([[1.5, 0.0], [0, 1.5], [-1.5, 0], [0, -1.5]])}
SPACE = {"shape": BALL, "resolution": 16, "values": [0.0]}
# Of each call the names that it needs.
CALLS = {
    "rsym.switched(half, 0, rsym.neumann())": PLANE,
    "rsym.robin(2, 1)": {},
    "rsym.neumann(0)": {},
    "rsym.mesh(shape)": SPACE,
    "rsym.mesh(shape, resolution)": SPACE,
    "rsym.mesh(rsym.extrude(shape, 0, 1))": PLANE,
    "rsym.write(rsym.mesh(shape), path)": SPACE,
    "rsym.sections(shape, values)": SPACE,
    "rsym.write_sections(rsym.sections(shape, [0.0]), path)": SPACE,
    "rsym.modes(shape, count)": FIELD,
    "rsym.torsion(shape)": FIELD,
    "rsym.elasticity(shape, conditions, young=1, poisson=0.3)": {"shape": DISC, "conditions": {"rim": rsym.fixed()}},
    "rsym.load(name)": {"name": "car"},
    "rsym.offset(shape, distance)": {"shape": DISC, "distance": 0.25},
    "rsym.disc()": {},
    "rsym.smoothness_atlas(shape, letter_a, letter_b)": MADE,
    "rsym.compare_designs(shape, designs)": MADE,
    "rsym.fairness(shape)": PLANE,
    "rsym.fit(shape, points, letters)": MADE,
    "rsym.sensitivity(shape, letter)": MADE,
    "rsym.render(shape)": SPACE,
    "rsym.revolve(shape)": PLANE,
    "rsym.revolve(profile)": PLANE,
    "rsym.extrude(shape, 0, 1)": PLANE,
    "rsym.plot_fields(shape)": PLANE,
    "rsym.plot_image(image)": {"image": rsym.render(BALL, size=(24, 16))},
    "rsym.repair(shape)": PLANE,
    "rsym.to_meshio(field)": {},
    "rsym.fixed()": {},
    "rsym.roller()": {},
    "rsym.pressure(2)": {},
    'rsym.displacement({"x": 0})': {},
    "rsym.constant()": {},
    "rsym.extent(shape)": PLANE,
    "rsym.clamped()": {},
    "rsym.supported()": {},
    "rsym.normalise(f, length=L)": {"f": DISC, "L": 2},
}
SLOW = {
    *(
        "rsym.modes(shape, count)",
        "rsym.torsion(shape)",
        "rsym.elasticity(shape, conditions, young=1, poisson=0.3)",
        "rsym.fairness(shape)",
    ),
    *("rsym.smoothness_atlas(shape, letter_a, letter_b)", "rsym.compare_designs(shape, designs)"),
    *("rsym.mesh(shape)", "rsym.mesh(rsym.extrude(shape, 0, 1))", "rsym.write(rsym.mesh(shape), path)"),
    *("rsym.render(shape)", "rsym.plot_fields(shape)", "rsym.repair(shape)"),
}


def test_every_call_that_a_remedy_names_is_known_here():
    assert named() == set(CALLS)


@pytest.mark.parametrize("call", [pytest.param(c, marks=pytest.mark.slow) if c in SLOW else c for c in CALLS])
def test_calls_that_remedies_name_are_carried_out(call, tmp_path):
    if call == "rsym.to_meshio(field)":
        pytest.importorskip("meshio")
        assert rsym.to_meshio(rsym.solve(DISC, "-laplacian(u) = 1", RIM, cells=4)) is not None
        return
    path = tmp_path / ("file.dxf" if "sections" in call else "file.stl")
    assert eval(call, {"rsym": rsym, "path": path, **CALLS[call]}) is not None


WRONG = {
    "a structure": (lambda: rsym.to_jax(rsym.solution_structure(DISC, 0)), ".with_values()"),
    "a mesh": (
        lambda: rsym.render(rsym.Mesh(np.zeros((0, 3)), np.zeros((0, 3), int))),
        "the shape that it was made of",
    ),
    "a plane shape": (lambda: rsym.write(DISC, "f.pdf"), "rsym.plot_fields(shape)"),
    "a shape in space": (lambda: rsym.write(BALL, "f.stl"), "rsym.write(rsym.mesh(shape), path)"),
}


@pytest.mark.parametrize(("refused", "remedy"), WRONG.values(), ids=WRONG)
def test_refusals_name_what_helps(refused, remedy):
    with pytest.raises(rsym.RsymError) as raised:
        refused()
    assert remedy in raised.value.remedy


def test_remedies_that_are_methods_are_carried_out(tmp_path):
    structure = rsym.solution_structure(DISC, 0)
    for made in (structure.with_values(), structure.with_functions(x * y)):
        assert rsym.compile(made)(0, 0)
    assert rsym.render(BALL, size=(24, 16)).save(tmp_path / "ball.png").exists()
    assert DISC.replace(bounds=rsym.extent(DISC)).bounds == rsym.extent(DISC)
    assert (DISC & rsym.half_plane((1, 0), 0)).contains(0.5, 0)
    assert rsym.Shape(x * y * z, (x, y, z)).dimension == 3
