import ast
import doctest
import importlib
import inspect
import linecache
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from stubs import imports_of, with_pieces, written

import rsym
from rsym.model.spelling import american

PACKAGES = [rsym, rsym.paper, rsym.surfaces]
FILES = sorted(Path(rsym.__file__).parent.rglob("*.py"))
SHOWING = [path for path in FILES if ">>>" in path.read_text()]


@pytest.mark.parametrize("path", written(), ids=lambda path: path.name)
def test_what_follows_from_the_table_of_pieces_is_written(path):
    assert path.read_text() == written()[path], "python tests/stubs.py writes it"


def test_a_name_without_its_row_is_seen(tmp_path):
    """Red proof."""
    stub = tmp_path / "__init__.pyi"
    stub.write_text("from .model.primitives.plane import disc, dodecagon\n")
    assert "dodecagon" in imports_of(stub.read_text())["model.primitives.plane"]
    assert "dodecagon" not in with_pieces(imports_of(stub.read_text()))["model.primitives.plane"]


@pytest.mark.parametrize("package", PACKAGES)
def test_stub_and_modules_agree(package):
    stub = ast.parse(Path(package.__file__).with_name("__init__.pyi").read_text())
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    for node in imports:
        for alias in node.names:
            if node.module is None:
                continue
            module = importlib.import_module(f"{package.__name__}.{node.module}")
            assert getattr(package, alias.name) is getattr(module, alias.name)
    (declared,) = [node.value for node in stub.body if isinstance(node, ast.Assign)]
    names = {alias.name for node in imports for alias in node.names}
    assert set(package.__all__) == names == set(ast.literal_eval(declared))


@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_function_and_class_has_an_example(package):
    for name in package.__all__:
        item = getattr(package, name)
        if inspect.isfunction(item) or inspect.isclass(item):
            assert ">>>" in inspect.getdoc(item), name


def name_of(path):
    """The name of a module of rsym."""
    parts = path.relative_to(FILES[0].parent).with_suffix("").parts
    return ".".join(("rsym", *(part for part in parts if part != "__init__")))


@pytest.mark.parametrize("name", [name_of(path) for path in SHOWING])
def test_examples_run(name, monkeypatch):
    # The debugger that doctest makes for each docstring asks the disk for every file that linecache holds.
    monkeypatch.setattr(linecache, "checkcache", lambda filename=None: None)
    result = doctest.testmod(importlib.import_module(name))
    assert result.failed == 0
    assert result.attempted


def loaded_after(code):
    script = f"import sys\n{code}\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_importing_rsym_loads_nothing_heavy():
    assert not loaded_after("import rsym") & {"sympy", "numpy", "matplotlib", "skimage", "scipy", "llvmlite", "numba"}


@pytest.mark.slow
def test_using_symbols_does_not_load_pictures():
    assert not loaded_after("from rsym import x, Shape, compile") & {"matplotlib", "skimage", "trimesh", "numba"}


@pytest.mark.slow
def test_a_model_of_the_paper_does_not_load_pictures():
    assert not loaded_after("import rsym\nrsym.paper.car()") & {"matplotlib", "skimage", "scipy", "trimesh", "numba"}


@pytest.mark.slow
def test_help_loads_no_sympy():
    code = "import rsym.cli\ntry:\n    rsym.cli.main(['--help'])\nexcept SystemExit:\n    pass"
    assert not loaded_after(code) & {"sympy", "numpy", "matplotlib"}


@pytest.mark.slow
@pytest.mark.parametrize("package", ["numba", "llvmlite"])
def test_without_numba_all_but_sharp_meshes_works(package, tmp_path):
    code = f"""
import sys, warnings
sys.modules["{package}"] = None
import rsym
from rsym import x, y, z
ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z))
with warnings.catch_warnings(record=True, action="always") as caught:
    mesh = rsym.mesh(ball, 16)
for one in caught:
    print(one.category.__name__, one.message)
print(mesh.status.closed, mesh.status.volume)
rsym.write(mesh, r"{tmp_path / "ball.stl"}")
try:
    rsym.Mesher(ball)
except rsym.RsymError as error:
    print(error.code, error.remedy, sep="|")
for name in rsym.__all__:
    getattr(rsym, name)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    warning, status, refused = done.stdout.splitlines()
    assert warning.startswith("RsymWarning edges are not sharp")
    assert "pip install numba" in warning
    closed, volume = status.split()
    assert closed == "True"
    assert 4.0 < float(volume) < 4.19
    assert refused == 'missing-package|pip install numba, or method="smooth"'


def parameters_of(thing):
    try:
        return inspect.signature(thing).parameters
    except (TypeError, ValueError):
        return {}


def callables():
    """All that users call by a public name: functions, classes, and methods of these."""
    for package in PACKAGES:
        for name in package.__all__:
            thing = getattr(package, name)
            if callable(thing):
                yield name, thing
            for method in vars(thing) if inspect.isclass(thing) else ():
                if not method.startswith("_") and inspect.isfunction(getattr(thing, method)):
                    yield f"{name}.{method}", getattr(thing, method)
    yield from (("Shape.rotate", rsym.Shape.rotate), ("Shape.scale", rsym.Shape.scale))


AMERICAN = [(name, thing, american(parameters_of(thing))) for name, thing in callables()]
AMERICAN = {name: (thing, spelt) for name, thing, spelt in AMERICAN if spelt}


@pytest.mark.parametrize("name", AMERICAN)
def test_american_spellings_are_answered_with_the_british_word(name):
    thing, spellings = AMERICAN[name]
    for theirs, ours in spellings.items():
        with pytest.raises(rsym.RsymError) as raised:
            thing(**{theirs: None})
        assert raised.value.remedy == f"rsym spells it {ours!r}"
        assert ours in parameters_of(thing)


def test_spellings_are_those_of_the_issue():
    assert {"disc", "plot_mesh", "plot_field", "Shape.rotate", "Arc"} <= set(AMERICAN)
    assert AMERICAN["plot_mesh"][1] == {"color": "colour", "color_by": "colour_by", "color_map": "colour_map"}


def test_what_answers_spellings_is_what_its_module_holds():
    from rsym.model.primitives import plane

    assert plane.disc is rsym.disc is pickle.loads(pickle.dumps(rsym.disc))
    assert rsym.disc(centre=(1, 2)) == rsym.disc(1, (1, 2))


@pytest.mark.parametrize(
    ("wrong", "meant"),
    [
        ("level_line", "level_lines"),
        ("meshh", "mesh"),
        ("normalize", "normalise"),
        ("disk", "disc"),
        ("Shpae", "Shape"),
    ],
)
def test_a_name_that_is_not_there_says_which_is(wrong, meant):
    with pytest.raises(AttributeError, match=f"did you mean .*{meant!r}"):
        getattr(rsym, wrong)
    assert not hasattr(rsym, wrong)


def test_a_name_that_is_like_none():
    with pytest.raises(AttributeError, match=r"dir\(rsym\) lists"):
        getattr(rsym, "qqqqqqqq")  # noqa: B009


def test_a_model_that_is_not_there_says_which_is():
    with pytest.raises(rsym.RsymError) as raised:
        rsym.load("cars")
    assert raised.value.remedy == "did you mean 'car'?"
    assert rsym.load("car").parts
