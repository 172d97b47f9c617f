"""The C text of a program, compiled by gcc and compared with the kernel."""

import ctypes
import re
import shutil
import subprocess

import numpy as np
import pytest
import sympy as sp
from backends.test_backends import OPERATION_NAMES, run, single
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, x, y
from rsym.backends.source import program_source
from rsym.program.expansion import expand
from rsym.program.program import Node, Program

a = sp.Symbol("a", real=True)
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror")
FAST = ("-O3", "-march=native", "-fno-math-errno", "-ffp-contract=off")
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")


def compiled(text, folder, flags=FAST):
    (folder / "kernel.c").write_text(text)
    command = ["gcc", *STRICT, *flags, "-shared", "-fPIC", "-o", folder / "kernel.so", folder / "kernel.c", "-lm"]
    subprocess.run(command, check=True)
    return ctypes.CDLL(str(folder / "kernel.so"))


def run_c(function, columns, letters, outputs):
    arrays = [*columns, np.array([*letters, 0.0]), *np.empty((outputs, len(columns[0])))]
    pointers = [ctypes.c_void_p(array.ctypes.data) for array in arrays]
    function(*pointers, ctypes.c_size_t(len(columns[0])))
    return arrays[-outputs:]


@needs_gcc
def test_every_operation_over_awkward_arguments(tmp_path):
    """The bits of the backend `numpy`; libm may differ from NumPy in the last places."""
    cases = {operation: single(operation) for operation in OPERATION_NAMES}
    texts = [
        program_source(expand(program), "c", {}).replace("rsym_kernel", operation + "_")
        for operation, (program, _) in cases.items()
    ]
    library = compiled("\n".join(texts), tmp_path, ("-O1", "-ffp-contract=off"))
    for operation, (program, columns) in cases.items():
        (got,), expected = run_c(library[operation + "_"], columns, [], 1), run("numpy", program, columns)
        known = ~np.isnan(expected)
        assert np.array_equal(np.isnan(got), ~known), operation
        if operation in {"sin", "cos", "exp", "log", "pow", "atan2"}:
            known &= np.isfinite(expected)
            assert_close(got[known], expected[known], rtol=1e-15, atol=1e-300)
        else:
            assert np.array_equal(got[known].view(int), expected[known].view(int)), operation


@needs_gcc
@pytest.mark.parametrize("flags", [FAST, ("-O0", "-ffp-contract=off")])
def test_the_bits_of_the_kernel(flags, tmp_path):
    body = rsym.paper.skeleton_body()
    columns = [np.random.default_rng(1).uniform(*side, 1003) for side in body.box.ends]
    for column in columns:
        column[:3] = 0.0, 3.0, np.nan
    letters = [float(letter.default) for letter in body.letters.values()]
    got = run_c(compiled(rsym.source(body, "c", rsym.SIX), tmp_path, flags).rsym_kernel, columns, letters, 6)
    expected = rsym.compile(body, rsym.SIX)(*columns)
    for name, array in zip(rsym.SIX, got, strict=True):
        assert np.array_equal(array, expected[name], equal_nan=True), name


@needs_gcc
def test_functions_of_libm_letters_and_several_outputs(tmp_path):
    formula = sp.sin(a * x) * sp.exp(y) + sp.atan2(y, x) + sp.log(x + 3) + (x + 3) ** y + sp.Min(x, y) * sp.sign(y)
    shape = Shape(conjunction(formula, sp.Max(x, y) - a), (x, y), letters={a: 2})
    columns = np.random.default_rng(2).uniform(-1, 1, (2, 501))
    library = compiled(rsym.source(shape, "c", ("value", "gradient")), tmp_path, ("-O2",))
    got = run_c(library.rsym_kernel, list(columns), [1.5], 3)
    expected = rsym.compile(shape, ("value", "gradient"))(*columns, letters={"a": 1.5})
    assert_close(got[0], expected["value"], atol=1e-12)
    assert_close(np.stack(got[1:], -1), expected["gradient"], rtol=1e-12, atol=1e-12)


def test_comments_list_coordinates_letters_and_outputs():
    text = rsym.source(Shape(x + a * y, (x, y), letters={a: 2.5}), "c", ("gradient",))
    for place, meaning in {"c1": "y", "letters[0]": "a = 2.5", "out1": "gradient_1"}.items():
        assert re.search(rf"^ \* {re.escape(place)} +{meaning}$", text, re.MULTILINE)


def test_names_of_a_model_stay_in_comments_and_cannot_leave_them():
    """Whatever a name holds: this program never went through the checks of a Shape."""
    hostile = "*/ int main(){} /*\\\n"
    nodes = (Node("input", (), "x"), Node("input", (), hostile), Node("add", (0, 1)))
    text = program_source(Program(nodes, ("x",), (hostile,), (("value", 2),)), "c", {hostile: 1.0})
    assert text.count("*/") == 2  # the head, and the remark on gcc
    assert "main(" not in text
    code = rsym.source(Shape(x + sp.Symbol("abort", real=True), (x, y), letters={"abort": 1}), "c")
    assert "abort" not in code[code.index("*/") :]


@pytest.mark.parametrize(
    ("arguments", "code"), [(("algol",), "unknown-language"), (("c", ("colour",)), "unknown-field")]
)
def test_bad_input_is_refused(arguments, code):
    with pytest.raises(RsymError) as caught:
        rsym.source(Shape(x * y, (x, y)), *arguments)
    assert caught.value.code == code
    assert "'c'" in caught.value.remedy or code != "unknown-language"
