"""The usual ways: SymPy's lambdify of the expanded expression, and C by gcc."""

import ctypes
import shutil
import subprocess

import numpy as np
import sympy as sp

import rsym
from rsym.model.symbols import substitute

C_FLAGS = {
    "gcc -O3 -march=native": (),
    "  and -fno-math-errno": ("-fno-math-errno",),
    "  and -ffp-contract=off": ("-fno-math-errno", "-ffp-contract=off"),
    "  and -mprefer-vector-width=512": ("-fno-math-errno", "-ffp-contract=off", "-mprefer-vector-width=512"),
}


def expanded(shape):
    """The expression with square roots written out and numbers in place of letters."""
    numbers = {sp.Symbol(name, real=True): sp.nsimplify(letter.default) for name, letter in shape.letters.items()}
    return substitute(shape.expression, numbers).doit()


def lambdified(shape, expression):
    return sp.lambdify(shape.coordinates, expression, modules="numpy", cse=True)


def compiled_c(shape, points, folder):
    """The value of a shape at the points, by C, for each set of flags; nothing where gcc is missing."""
    if shutil.which("gcc") is None:
        return {}
    (folder / "kernel.c").write_text(rsym.source(shape, "c"))
    return {
        name: _loaded(shape, points, folder, f"kernel{k}.so", flags) for k, (name, flags) in enumerate(C_FLAGS.items())
    }


def _loaded(shape, points, folder, library, flags):
    command = ["gcc", "-O3", "-march=native", *flags, "-shared", "-fPIC", "-o", library, "kernel.c", "-lm"]
    subprocess.run(command, check=True, cwd=folder)
    function = ctypes.CDLL(str(folder / library)).rsym_kernel
    letters = np.array([float(letter.default) for letter in shape.letters.values()])

    def call():
        output = np.empty(len(points[0]))
        arrays = [*points, letters, output]
        function(*(ctypes.c_void_p(array.ctypes.data) for array in arrays), ctypes.c_size_t(len(output)))
        return output

    return call
