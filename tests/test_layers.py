"""The layer table of the design: a module imports to its left, never to its right."""

import ast
import sys
from pathlib import Path

import pytest

import rsym

PACKAGE = Path(rsym.__file__).parent
# Layer: third-party packages it may import. Order is the direction of the data.
LAYERS = {
    "errors": set(),
    "version": set(),
    "model": {"sympy"},
    "analysis": {"sympy"},
    "language": {"sympy"},
    "codegen": {"sympy", "numpy", "llvmlite", "flint"},
    "sampling": {"numpy", "scipy", "skimage", "numba"},
    "verify": {"sympy", "numpy", "scipy", "mpmath", "flint"},
    "surfaces": {"sympy", "numpy", "scipy", "lazy_loader"},
    # mpl_toolkits is matplotlib's second package.
    "output": {"sympy", "numpy", "matplotlib", "mpl_toolkits", "trimesh", "plotly", "ipywidgets"},
    "paper": {"numpy", "matplotlib", "lazy_loader"},
    "commands": {"tqdm"},
    "cli": {"argcomplete"},
}
# Methods that need a layer to the right import it when they are called: module, what it imports, and why.
DEFERRED = {
    (
        "model/shape.py",
        "rsym.codegen.kernel",
    ): "shape.contains(x, y): whether a point is inside is asked of a shape, and"
    " only a compiled one answers for arrays; a free function would be the one question that is not a method",
}
FORBIDDEN_NAMES = {"utils", "helpers", "misc", "common", "core", "base", "tools"}
ORDER = list(LAYERS)


def complaints(source, layer):
    """What the imports of a module in this layer break."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom):
            if node.level:
                found.append(f"relative import of {node.module}")
                continue
            if any(alias.name == "*" for alias in node.names):
                found.append(f"star import from {node.module}")
            names = [node.module if node.module != "rsym" else f"rsym.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            top, _, rest = name.partition(".")
            inner = rest.partition(".")[0]
            if top == "rsym":
                if inner not in LAYERS:
                    found.append(f"{name}: from the facade, not from a layer")
                elif ORDER.index(inner) > ORDER.index(layer):
                    found.append(f"{name}: {inner} stands right of {layer}")
            elif top not in sys.stdlib_module_names and top not in LAYERS[layer]:
                found.append(f"{name}: not for the layer {layer}")
    return found


def modules():
    inner = sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE)
    return [*inner, Path("errors.py"), Path("version.py"), Path("cli.py")]


@pytest.mark.parametrize("module", modules(), ids=str)
def test_a_module_imports_only_to_its_left(module):
    layer = module.parts[0].removesuffix(".py")
    source = (PACKAGE / module).read_text()
    allowed = {name for where, name in DEFERRED if where == module.as_posix()}
    found = [one for one in complaints(source, layer) if one.partition(":")[0] not in allowed]
    assert found == []
    at_once = {node.module for node in ast.parse(source).body if isinstance(node, ast.ImportFrom)}
    assert not allowed & at_once


def test_deferred_imports_are_all_in_use():
    for (where, name), reason in DEFERRED.items():
        layer = where.partition("/")[0]
        assert any(one.startswith(f"{name}:") for one in complaints((PACKAGE / where).read_text(), layer)), where
        assert reason


@pytest.mark.parametrize(
    "line",
    [
        "from rsym.codegen.kernel import compile",
        "def f():\n    import rsym.output.fields",
        "import numpy",
        "from rsym import Shape",
        "from .nodes import Trimming",
        "from rsym.model.nodes import *",
    ],
)
def test_the_test_sees_a_wrong_import(line):
    """Red proof."""
    assert complaints(line, "model")


def test_names_and_sizes_of_modules():
    for module in modules():
        assert module.stem not in FORBIDDEN_NAMES
        lines = (PACKAGE / module).read_text().splitlines()
        assert len(lines) <= 400, module
        for node in ast.walk(ast.parse("\n".join(lines))):
            if isinstance(node, ast.FunctionDef):
                body = node.body[1:] if ast.get_docstring(node) else node.body
                assert not body or body[-1].end_lineno - body[0].lineno < 60, f"{module}: {node.name}"


def test_sub_packages_only_re_export():
    for path in PACKAGE.rglob("*/__init__.py"):
        kinds = {type(node) for node in ast.parse(path.read_text()).body[1:]}
        assert kinds <= {ast.ImportFrom, ast.Assign}, path
