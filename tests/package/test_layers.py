"""The layer table of the design: a module imports to its left, never to its right."""

import ast
import collections
import functools
import re
import sys
from pathlib import Path

import pytest

import rsym

PACKAGE = Path(rsym.__file__).parent
# Layer: third-party packages it may import. Order is the direction of the data.
LAYERS = {
    "errors": set(),
    "version": set(),
    "garbage": set(),
    "atomic": set(),  # files that appear whole or not at all, of whoever writes some
    # Left of all that has something to say.
    "reports": set(),
    "arrays": {"numpy"},  # for those layers that may import numpy themselves
    "model": {"sympy", "mpmath"},  # mpmath: what SymPy evaluates with
    "facade": {"lazy_loader"},
    "analysis": {"sympy"},
    "program": {"sympy", "numpy"},  # numpy: the plain meaning of operations on arrays
    "backends": {"sympy", "numpy", "llvmlite"},
    "logic": {"sympy"},
    "bounds": {"numpy", "flint"},
    "language": {"sympy"},
    "sampling": {"numpy", "scipy", "skimage", "numba"},
    "verify": {"sympy", "numpy", "scipy", "mpmath", "flint"},
    "surfaces": {"sympy", "numpy", "scipy"},
    "problems": {"sympy", "numpy", "scipy", "flint", "numba"},
    # mpl_toolkits is matplotlib's second package.
    "output": {"sympy", "numpy", "matplotlib", "mpl_toolkits", "trimesh", "plotly", "ipywidgets"},
    "paper": {"numpy", "matplotlib"},
    "commands": {"tqdm"},
    "cli": {"argcomplete"},
}
# Methods that go against the flow import what they need when they are called: module, what it imports, and why.
DEFERRED = {
    (
        "model/shape.py",
        "rsym.logic.inside",
    ): "shape.contains(x, y): whether a point is inside is asked of a shape, and"
    " only a compiled one answers for arrays; a free function would be the one question that is not a method",
    (
        "model/shape.py",
        "rsym.analysis.contracts.summary",
    ): "shape.contract(): what a formula promises is asked of a shape, and it takes calculus to know",
    (
        "model/shape.py",
        "rsym.output.rendering",
    ): "a shape in space shows itself in a notebook by a small picture: who asks for its HTML wants to see it",
    (
        "model/constructions.py",
        "rsym.sampling.offsets",
    ): "offset and shell: a length that no leaf knows is measured where it is asked for, or nobody would look at it",
    (
        "model/blends/fillets.py",
        "rsym.sampling.offsets",
    ): "fillet: how far it moves a face that its operands share is measured where it is made, as for offset and shell",
    (
        "model/symmetry/copies.py",
        "rsym.sampling.extent",
    ): "cyclic and row: whether a motif keeps within its cell is proved where it is copied, and decides how",
    (
        "surfaces/patch.py",
        "rsym.surfaces.meshes",
    ): "patch.mesh(resolution): the mesh of a patch is asked of it, as its grid is, and a mesh is made of patches",
    ("surfaces/patch.py", "rsym.sampling.mesh"): "the type of what patch.mesh answers; meshes need a compiler",
}
# Imported by those who need them when they are called, for the package behind them may be missing or slow to load.
OPTIONAL = {
    "rsym.bounds.balls": "python-flint may be missing",
    "rsym.backends.llvm_code": "llvmlite may be missing",
    "rsym.backends.tape": "llvmlite may be missing",
    "rsym.sampling.plane_regions": "numba may be missing",
    "rsym.sampling.rules.leaf_functions": "numba may be missing",
    "rsym.sampling.regions.own_leaves": "numba may be missing",
    "rsym.sampling.regions.region_signs": "numba may be missing",
    "rsym.sampling.kernels.mesher_kernels": "llvmlite may be missing",
    "rsym.sampling.kernels.ray_kernels": "llvmlite may be missing",
    "rsym.sampling.mesher": "numba may be missing",
    "rsym.sampling.triangles": "numba may be missing",
    "rsym.output.explorer": "ipywidgets may be missing",
    "rsym.output.solution_explorer": "ipywidgets may be missing",
}
# A command imports what it needs when it runs: `rsym --help` answers at once.
AT_CALL = ("rsym.commands.", "rsym.cli")
FORBIDDEN_NAMES = {"utils", "helpers", "misc", "common", "core", "base", "tools"}
ORDER = list(LAYERS)
# The rooms of the proofs, in the order of the data; "" is verify itself, what is asked.
PROOFS = (
    "answers",
    "boxes",
    "points",
    "curves",
    "cover",
    "continuity",
    "normalisation",
    "",
    "fairness",
    "repair",
    "atlas",
    "lint",
)


@functools.cache
def tree_of(path):
    """The tree of a module of rsym, parsed once for all that is asked of it."""
    return ast.parse(path.read_text())


def statements(tree):
    """The statements of a module, those inside of others too: none stands in an expression."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.stmt | ast.ExceptHandler | ast.match_case):
            yield node
            yield from statements(node)


def complaints(tree, layer):
    """What the imports of a module in this layer break."""
    found = []
    for node in statements(tree):
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
                elif inner == "arrays" and "numpy" not in LAYERS[layer]:
                    found.append(f"{name}: not for the layer {layer}")
            elif top not in sys.stdlib_module_names and top not in LAYERS[layer]:
                found.append(f"{name}: not for the layer {layer}")
    return found


def modules():
    inner = sorted(path.relative_to(PACKAGE) for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE)
    return [*inner, *(Path(f"{layer}.py") for layer in LAYERS if (PACKAGE / f"{layer}.py").exists())]


def test_a_module_imports_only_to_its_left():
    found = []
    for module in modules():
        tree = tree_of(PACKAGE / module)
        allowed = {name for where, name in DEFERRED if where == module.as_posix()}
        told = complaints(tree, module.parts[0].removesuffix(".py"))
        found += [f"{module}: {one}" for one in told if one.partition(":")[0] not in allowed]
        at_once = {node.module for node in tree.body if isinstance(node, ast.ImportFrom)}
        found += [f"{module}: {name} is not deferred" for name in allowed & at_once]
    assert found == []


@pytest.mark.parametrize(
    "line",
    [
        "from rsym.backends.kernel import compile",
        "def f():\n    import rsym.output.fields",
        "import numpy",
        "from rsym.arrays import Floats",
        "from rsym import Shape",
        "from .nodes import Trimming",
        "from rsym.model.nodes import *",
    ],
)
def test_the_test_sees_a_wrong_import(line):
    """Red proof."""
    assert complaints(ast.parse(line), "model")


def against_the_flow(graph):
    """The imports of the rooms of the proofs from a room to the right."""
    places = {name: name.split(".")[2:-1] for name in graph if name.startswith("rsym.verify.")}
    rooms = {name: PROOFS.index(place[0] if place else "") for name, place in places.items()}
    pairs = [(name, other) for name in rooms for other, _ in graph[name] if other in rooms]
    return [(name, other) for name, other in pairs if rooms[other] > rooms[name]]


def test_rooms_of_proofs_import_to_their_left():
    modules = {name: found for name, found in graph().items() if not (PACKAGE.parent / name.replace(".", "/")).is_dir()}
    assert against_the_flow(modules) == []


def test_a_room_of_proofs_that_imports_to_its_right_is_seen():
    """Red proof."""
    wrong = {"rsym.verify.boxes.local": {("rsym.verify.points.plane", "type")}, "rsym.verify.points.plane": set()}
    assert against_the_flow(wrong) == [("rsym.verify.boxes.local", "rsym.verify.points.plane")]


def test_names_and_sizes_of_modules():
    for module in modules():
        assert module.stem not in FORBIDDEN_NAMES
        lines = (PACKAGE / module).read_text().splitlines()
        assert len(lines) <= 400, module
        for node in statements(tree_of(PACKAGE / module)):
            if isinstance(node, ast.FunctionDef):
                body = node.body[1:] if ast.get_docstring(node) else node.body
                assert not body or body[-1].end_lineno - body[0].lineno < 60, f"{module}: {node.name}"


def test_sub_packages_only_re_export():
    for path in PACKAGE.rglob("*/__init__.py"):
        kinds = {type(node) for node in tree_of(path).body[1:]}
        assert kinds <= {ast.ImportFrom, ast.Assign}, path


def module_of(path):
    parts = ("rsym", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def arrows(tree, module, known):
    """The modules of rsym that a module imports, each with when: at once, "deferred" into a function, "type"."""
    found = set()

    def visit(node, when):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            when = "deferred"
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            when = "type"
        names = []
        if isinstance(node, ast.ImportFrom) and not node.level:
            inner = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [one if one in known else node.module for one in inner]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        found.update((name, when) for name in names if name != module and f"{name}.".startswith("rsym."))
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.stmt | ast.ExceptHandler | ast.match_case):
                visit(child, when)

    visit(tree, "at once")
    return found


@functools.cache
def graph():
    """From each module to those it imports, with when."""
    paths = {module_of(path): path for path in PACKAGE.rglob("*.py")}
    return {name: arrows(tree_of(path), name, paths) for name, path in paths.items()}


def circles(graph):
    """The modules that import each other, directly or round about: Tarjan's components of more than one."""
    number, low, path, found = {}, {}, [], []

    def visit(node):
        number[node] = low[node] = len(number)
        path.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in number:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in path:
                low[node] = min(low[node], number[other])
        if low[node] == number[node]:
            place = path.index(node)
            if len(path) > place + 1:
                found.append(sorted(path[place:]))
            del path[place:]

    for node in sorted(graph):
        if node not in number:
            visit(node)
    return found


def test_no_modules_import_each_other():
    declared = {(module_of(PACKAGE / where), name) for where, name in DEFERRED}
    at_all = {name: {one for one, _ in found if (name, one) not in declared} for name, found in graph().items()}
    assert {name for circle in circles(at_all) for name in circle} == set()


def test_deferred_imports_are_declared():
    """Inside functions, or for types alone: neither hides an arrow."""
    declared = {(module_of(PACKAGE / where), name) for where, name in DEFERRED}
    found = {
        (name, other)
        for name, imported in graph().items()
        for other, when in imported
        if when != "at once" and not name.startswith(AT_CALL) and other not in OPTIONAL
    }
    assert {" ".join(one) for one in found - declared} == set()
    assert all(reason for reason in (*DEFERRED.values(), *OPTIONAL.values()))


def test_declared_imports_are_all_in_use():
    late = {(name, other) for name, imported in graph().items() for other, when in imported if when != "at once"}
    assert {(module_of(PACKAGE / where), name) for where, name in DEFERRED} <= late
    assert set(OPTIONAL) <= {other for _, other in late}


def test_circles_and_deferred_imports_are_seen():
    """Red proof."""
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == [["b", "c"]]
    source = "if TYPE_CHECKING:\n    from rsym.a import b\ndef f():\n    from rsym.a.c import d\nimport rsym.e"
    expected = {("rsym.a.b", "type"), ("rsym.a.c", "deferred"), ("rsym.e", "at once")}
    assert arrows(ast.parse(source), "rsym.x", {"rsym.a.b"}) == expected


def test_no_public_class_name_stands_for_two_ideas():
    places = collections.defaultdict(list)
    for path in PACKAGE.rglob("*.py"):
        for node in tree_of(path).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(module_of(path))
    twice = {name for name, modules in places.items() if len(modules) > 1}
    assert not twice, {name: places[name] for name in twice}


def rooms():
    return sorted(path.parent for path in PACKAGE.rglob("__init__.py") if path.parent != PACKAGE)


def unmapped(room, text):
    """What is in a room and not in its map, as `name` or name.py, and what is in the map as name.py and not there."""
    there = {path.stem for path in room.glob("*.py")} - {"__init__"}
    there |= {f"{path.parent.name}/" for path in room.glob("*/__init__.py")}
    files = set(re.findall(r"(?<![\w/])(\w+)\.py\b", text))
    return there - files - set(re.findall(r"(?<![\w/])\w+/|(?<=`)\w+(?=`)", text)), files - there


@pytest.mark.parametrize("room", rooms(), ids=lambda room: room.relative_to(PACKAGE).as_posix())
def test_a_room_has_a_map(room):
    """In a few lines its docstring says what comes in, what goes out, and the files in the order of the data."""
    text = ast.get_docstring(tree_of(room / "__init__.py"))
    assert 4 <= len(text.splitlines()) <= 26
    assert unmapped(room, text) == (set(), set())


def test_what_a_map_leaves_out_is_seen(tmp_path):
    """Red proof."""
    (tmp_path / "here.py").touch()
    assert unmapped(tmp_path, "A room.\n\ngone.py  what was here") == ({"here"}, {"gone"})
    assert unmapped(tmp_path, "A room.\n\n`here`: what is here") == (set(), set())


def test_types_of_arrays_stand_once():
    """`rsym.arrays` has them."""
    alias = re.compile(r"^\w+(?:: TypeAlias)? = NDArray\[np\.(?:float64|int64|bool_)\]", re.MULTILINE)
    files = [path for path in PACKAGE.rglob("*.py") if path.name != "arrays.py"]
    assert sum(len(alias.findall(path.read_text())) for path in files) == 0
