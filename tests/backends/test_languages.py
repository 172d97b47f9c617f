"""Texts of other languages, run: value and gradient of shipped models, the bits and the NaN of the kernel."""

import ctypes
import functools
import os
import re
import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp
from backends.test_backends import run as run_backend
from backends.test_backends import single
from oracles.line_texts import lines_of, numbers_of

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.backends.dialects import LANGUAGES
from rsym.backends.languages import frontier, statements
from rsym.backends.source import KNOWN, program_source
from rsym.paper.models import model_path
from rsym.program.expansion import expand
from rsym.program.fields import program_of
from rsym.program.operations import OPERATIONS, PRIMITIVES

pytestmark = pytest.mark.slow

a = sp.Symbol("a", real=True)
ARITHMETIC = "car skeleton valve streamlined bone clip jack lattice snowflake solids".split()
FUNCTIONS = "gear bracket vase spanner".split()  # sin, cos, exp, log, atan2: libraries differ in the last places
LIBRARY = set("sin cos exp log pow atan2".split())
# Every primitive operation over awkward arguments, as a model of its own.
SINGLE = {f"only_{name}": name for name in sorted(set(PRIMITIVES) - {"const", "input", "undefined"})}
ALL = (*ARITHMETIC, *FUNCTIONS, *SINGLE)
FIELDS = ("value", "gradient")
POINTS = 300
COMPILERS = {"c": "gcc", "cuda": "g++", "fortran": "gfortran", "javascript": "node", "matlab": "octave-cli"}
COMPILERS |= {"rust": "rustc", "julia": "julia"}
NOT_IN_CI = {"julia"}  # no package of a system has it


@functools.cache
def shipped(name):
    return rsym.load(model_path(name))


@functools.cache
def case(name):
    """Points, letters and what the kernel says; corners, edges of the bounds, and what is no number among them."""
    if name in SINGLE:
        program, columns = single(SINGLE[name])
        return np.array(columns), [], run_backend("numpy", program, columns)[None]
    shape = shipped(name)
    generator = np.random.default_rng(4)
    points = np.array([generator.uniform(*map(float, side), POINTS) for side in shape.box.ends])
    points[:, :100] = points[:, :100].round()
    points[:, 100:120] = 0
    points[0, 100:104] = np.nan, np.inf, -np.inf, 1e200
    letters = [float(letter.default) for letter in shape.letters.values()]
    found = rsym.compile(shape, FIELDS, threads=1)(*points)
    return points, letters, np.ascontiguousarray(np.vstack([found["value"], found["gradient"].T]))


def texts(language, constants=False):
    """The texts of all models, each with a name of its own."""
    letters = "constants" if constants else None
    found = {name: rsym.source(shipped(name), language, FIELDS, letters=letters) for name in (*ARITHMETIC, *FUNCTIONS)}
    for name, operation in SINGLE.items():
        found[name] = program_source(single(operation)[0], language, {}, constants=constants)
    return {name: text.replace("rsym_kernel", f"kernel_{name}") for name, text in found.items()}


def compiler(language):
    found = shutil.which(COMPILERS[language])
    if found is None and (language in NOT_IN_CI or not os.environ.get("CI")):
        pytest.skip(f"{COMPILERS[language]} is not installed")
    assert found, f"CI installs {COMPILERS[language]}"
    return found


def agree(got, name):
    *_, expected = case(name)
    if name in SINGLE and SINGLE[name] in LIBRARY:
        known = np.isfinite(expected)
        assert np.array_equal(np.isnan(got), np.isnan(expected)), name
        np.testing.assert_allclose(got[known], expected[known], rtol=1e-15, atol=1e-300, err_msg=name)
    elif name in ARITHMETIC or name in SINGLE:
        known = ~np.isnan(expected)
        assert np.array_equal(np.isnan(got), ~known), name
        assert np.array_equal(got[known].view(np.int64), expected[known].view(np.int64)), name
    else:
        # As a share of the largest value of that output: nearer to a zero of it cancellation tells libraries apart.
        known = np.isfinite(expected)
        assert np.array_equal(np.isfinite(got), known), name
        size = np.broadcast_to(np.abs(np.where(known, expected, 0)).max(axis=1, keepdims=True), known.shape)
        assert (np.abs(got[known] - expected[known]) <= 1e-13 * size[known]).all(), name


def called(library, constants=False):
    """Each function of a shared library at its points."""
    for name in ALL:
        points, letters, expected = case(name)
        out = np.empty(expected.shape)
        arrays = [*points, *([] if constants else [np.array([*letters, 0.0])]), *out]
        pointers = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
        library[f"kernel_{name}"](*pointers, ctypes.c_size_t(points.shape[1]))
        agree(out, name)


def built(folder, file, text, *command):
    (folder / file).write_text(text)
    subprocess.run([*command, folder / file], check=True, cwd=folder)
    return ctypes.CDLL(str(folder / "kernels.so"))


SHARED = ("-O1", "-ffp-contract=off", "-shared", "-fPIC", "-o", "kernels.so")


def c(program, folder):
    text = "".join(texts("c", constants=True).values())
    called(built(folder, "kernels.c", text, program, "-std=c99", *SHARED), constants=True)


# What a compiler for the processor takes the words of the device for: a grid of one thread.
DEVICE = """
#define __global__
static struct { unsigned x; } blockIdx = {0}, threadIdx = {0}, blockDim = {1}, gridDim = {1};
"""


def cuda(program, folder):
    called(built(folder, "kernels.cpp", DEVICE + "".join(texts("cuda").values()), program, *SHARED))


def fortran(program, folder):
    called(built(folder, "kernels.f90", "".join(texts("fortran").values()), program, *SHARED))


def rust(program, folder):
    """A function of C around each."""
    text = ""
    for name, one in texts("rust").items():
        points, letters, expected = case(name)
        reads = [f"c{k}" for k in range(len(points))] + ["letters"]
        writes = [f"out{k}" for k in range(len(expected))]
        lengths, n = {"letters": len(letters)}, points.shape[1]
        taken = [f"{p}: *const f64" for p in reads] + [f"{p}: *mut f64" for p in writes]
        slices = [f"std::slice::from_raw_parts({p}, {lengths.get(p, n)})" for p in reads]
        slices += [f"std::slice::from_raw_parts_mut({p}, {n})" for p in writes]
        text += one.replace(f"kernel_{name}", f"inner_{name}")
        text += f'#[no_mangle]\npub unsafe extern "C" fn kernel_{name}({", ".join(taken)}, _n: usize) {{\n'
        text += f"    inner_{name}({', '.join(slices)});\n}}\n"
    options = ("--edition", "2021", "-C", "opt-level=1", "--crate-type", "cdylib", "-o", "kernels.so")
    called(built(folder, "kernels.rs", text, program, *options))


def in_files(folder):
    """What goes in and comes out, for those that read and write files."""
    for name in ALL:
        points, letters, _ = case(name)
        points.tofile(folder / f"{name}.points")
        np.array(letters).tofile(folder / f"{name}.letters")


def out_of_files(folder):
    for name in ALL:
        *_, expected = case(name)
        agree(np.fromfile(folder / f"{name}.out").reshape(expected.shape), name)


NODE = """
import {readFileSync, writeFileSync} from 'node:fs';
const numbers = (file) => {
    const bytes = readFileSync(file);
    return new Float64Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
};
const run = (name, kernel, inputs, outputs) => {
    const points = numbers(name + '.points'), n = points.length / inputs, out = new Float64Array(n * outputs);
    const columns = (all, count) => Array.from({length: count}, (_, k) => all.subarray(n * k, n * (k + 1)));
    kernel(...columns(points, inputs), numbers(name + '.letters'), ...columns(out, outputs));
    writeFileSync(name + '.out', Buffer.from(out.buffer));
};
"""


def javascript(program, folder):
    in_files(folder)
    text = NODE + "".join(texts("javascript").values())
    for name in ALL:
        points, _, expected = case(name)
        text += f"run('{name}', kernel_{name}, {len(points)}, {len(expected)});\n"
    (folder / "run.mjs").write_text(text)
    subprocess.run([program, "run.mjs"], check=True, cwd=folder)
    out_of_files(folder)


def matlab(program, folder):
    in_files(folder)
    lines = ["numbers = @(file) fread(fopen(file), Inf, 'double');"]
    for name, text in texts("matlab").items():
        (folder / f"kernel_{name}.m").write_text(text)
        points, _, expected = case(name)
        inputs = ", ".join(f"p(:, {k + 1})" for k in range(len(points)))
        outs = " ".join(f"out{k}" for k in range(len(expected)))
        lines.append(f"p = reshape(numbers('{name}.points'), [], {len(points)});")
        lines.append(f"[{outs}] = kernel_{name}({inputs}, numbers('{name}.letters'));")
        lines.append(f"fwrite(fopen('{name}.out', 'w'), [{outs}], 'double');")
    (folder / "main.m").write_text("\n".join([*lines, "fclose('all');"]))
    subprocess.run([program, "--no-gui", "--norc", "--quiet", "main.m"], check=True, cwd=folder)
    out_of_files(folder)


def julia(program, folder):
    in_files(folder)
    text = "".join(texts("julia").values()).replace("!(", "(")
    text += "numbers(file) = collect(reinterpret(Float64, read(file)))\n"
    for name in ALL:
        points, _, expected = case(name)
        n = points.shape[1]
        columns = ", ".join(f"p[{n * k + 1}:{n * (k + 1)}]" for k in range(len(points)))
        outs = ", ".join(f"view(o, {n * k + 1}:{n * (k + 1)})" for k in range(len(expected)))
        text += f'p = numbers("{name}.points"); o = zeros({expected.size})\n'
        text += f'kernel_{name}({columns}, numbers("{name}.letters"), {outs})\nwrite("{name}.out", o)\n'
    (folder / "run.jl").write_text(text)
    subprocess.run([program, "run.jl"], check=True, cwd=folder)
    out_of_files(folder)


@pytest.mark.parametrize("run", [c, cuda, fortran, rust, javascript, matlab, julia], ids=lambda run: run.__name__)
def test_value_and_gradient_are_those_of_the_kernel(run, tmp_path):
    run(compiler(run.__name__), tmp_path)


def numpy_function(text):
    namespace = {}
    exec(text, namespace)
    return namespace["rsym_kernel"]


@pytest.mark.parametrize("letters", ["arguments", "constants"])
@pytest.mark.parametrize("name", ["skeleton", "solids", "clip", "vase"])
def test_the_text_of_numpy_gives_arrays(name, letters):
    points, values, _ = case(name)
    function = numpy_function(rsym.source(shipped(name), "numpy", FIELDS, letters=letters))
    agree(np.array(function(*points)), name)
    if letters == "arguments":
        agree(np.array(function(*points, values)), name)
        column = function(points[0, :, None], *points[1:])[0]
        assert column.shape == (POINTS, POINTS)


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_head_says_what_goes_in_and_what_comes_out(language):
    shape = shipped("skeleton")
    k = 1 if language in {"matlab", "fortran", "julia"} else 0
    open_, close = "()" if language in {"matlab", "fortran"} else "[]"
    for letters in ("arguments", "constants"):
        head = rsym.source(shape, language, FIELDS, letters=letters).partition("rsym_kernel")[0]
        place = "constant" if letters == "constants" else f"letters{open_}{k}{close}"
        for row in ("c0 +x", "c1 +y", "out0 +value", "out2 +gradient_1", rf"{re.escape(place)} +a = 5\.0"):
            assert re.search(rf"^\W* {row}$", head, re.MULTILINE), row
    assert not re.search(r"\bletters\b", rsym.source(shape, language, letters="constants").replace(head, ""))


@pytest.mark.parametrize("language", KNOWN)
def test_names_of_a_model_stay_in_comments(language):
    """However they are called: only numbered names, words of the language and its numbers stand in the code."""
    names = {"abort": 1, "end": 2, "coding": 3}
    total = sum((sp.Symbol(name, real=True) for name in names), x * y)
    text = rsym.source(Shape(total, (x, y), letters=names), language)
    marks = {
        "c": r"/\*.*?\*/",
        "numpy": r"#.*?$",
        "matlab": r"%.*?$",
        "julia": r"#.*?$",
        "fortran": r"!.*?$",
        "vm": r"#.*?$",
    }
    code = re.sub(marks.get(language, r"//.*?$"), "", text, flags=re.MULTILINE | re.DOTALL)
    assert "abort" not in code
    assert "coding" not in code
    assert "x * y" not in code


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_language_writes_every_primitive_operation(language):
    """`test_closure` prints every operation."""
    wanted = set(PRIMITIVES) - {"const", "input", "undefined"}
    assert {name for name in wanted if language not in OPERATIONS[name].texts} == set()
    assert set(LANGUAGES[language].functions) <= {
        name for one in wanted for name in re.findall(r"rsym_\w+", OPERATIONS[one].texts[language])
    }


def test_lines_of_fortran_end_before_the_compiler_cuts_them():
    shape = rsym.revolve(shipped("skeleton"))
    text = rsym.source(
        shape, "fortran", ("value", "gradient", "hessian", "principal_directions", "principal_curvatures")
    )
    assert max(map(len, text.splitlines())) <= 132


def test_what_is_known_needs_no_statement():
    program = expand(program_of(Shape(sp.sqrt(a) * x + 1 / a, (x, y), letters={"a": 4}), ("value",)))
    alone = frontier(program)
    assert [program.nodes[k].operation for k in alone] == ["div", "sqrt"]
    found = statements(program, "glsl", known={k: f"u[{n}]" for n, k in enumerate(alone)})
    assert found.uniform == []
    assert len(found.varying) == 3
    script = statements(program, "javascript")
    assert len(script.uniform) == 3
    assert statements(program, "c", inputs={"x": "here"}).varying[0].endswith("= here;")


def numbers_of_vm(text, points):
    """The last line at points; readers take names for addresses."""
    assert [int(line[0][1:], 16) for line in lines_of(text)] == list(range(text.count("\n") - 1))
    return numbers_of(text, points)


@pytest.mark.parametrize("name", ["car", "skeleton", "valve", "streamlined", "clip", "lattice", "gear", "spring"])
def test_vm_is_negative_inside(name):
    points, _, (expected, *_) = case(name)
    found = -numbers_of_vm(rsym.source(shipped(name), "vm"), points)
    known = np.isfinite(expected) & (np.abs(points).max(axis=0) < 1e100)
    assert known.sum() > 200
    # Written in another way: rounding differs, the sign only where it is that of rounding.
    assert (np.abs(found[known] - expected[known]) <= 1e-12 * np.abs(expected[known]).max()).all()
    clear = known & (np.abs(expected) > 1e-13 * np.abs(expected[known]).max())
    assert np.array_equal(np.sign(found[clear]), np.sign(expected[clear]))


def test_vm_keeps_the_sign_where_terms_cancel():
    """F + g - sqrt(f**2 + g**2) would be 0."""
    text = rsym.source(Shape(rsym.conjunction(x, y), (x, y)), "vm")
    found = numbers_of_vm(text, np.array([[1e-20, 1e-20, -1e-20, 0.0, 0.0, -3.0], [3.0, -3.0, 3.0, 0.0, 3.0, -4.0]]))
    assert np.array_equal(np.sign(found), [-1, 1, 1, 0, 0, 1])
    assert found[-1] == 12.0


REFUSED = [
    (("vm", ("gradient",)), {}, "language"),
    (("vm",), {"letters": "arguments"}, "language"),
    (("c",), {"letters": "numbers"}, "letters"),
    (("algol",), {}, "unknown-language"),
    ((None,), {}, "unknown-language"),
]


@pytest.mark.parametrize(("arguments", "named", "code"), REFUSED)
def test_what_cannot_be_written_is_refused(arguments, named, code):
    with pytest.raises(RsymError) as caught:
        rsym.source(Shape(a * x * y, (x, y), letters={"a": 1}), *arguments, **named)
    assert caught.value.code == code
    assert caught.value.remedy


def test_vm_has_three_coordinates_and_no_choice():
    w = sp.Symbol("w", real=True)
    for expression, symbols in ((x * y * z * w, (x, y, z, w)), (sp.Piecewise((x, y > 0), (2 * x, True)), (x, y))):
        with pytest.raises(RsymError):
            rsym.source(Shape(expression, symbols), "vm")
