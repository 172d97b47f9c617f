"""How ten languages write what stands around the texts of operations: a row for each.

To add a language, write its row, and its text for each primitive operation (`rsym.program.texts`). Functions that it
has with other values than NumPy's, NaN outside of the domain, the row brings along, under names that begin with rsym_.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rsym.program.program import FLOAT32, FLOAT64, Precision


@dataclass(frozen=True)
class Language:
    """One language: how statements are written, and what stands around them.

    In lines that are formatted ``{inputs}``, ``{outputs}`` and ``{parameters}`` are what a function takes, declared;
    ``{coordinates}``, ``{places}`` and ``{names}`` their names alone.

    Attributes
    ----------
    suffix : str
        What names of files end in.
    statement : str
        Gives a ``{name}`` the value ``{text}``.
    coordinate, letter : str
        The place of an input, for its number ``{k}``, or ``{k1}`` counted from 1.
    input, given, output, size : str
        How a coordinate, the letters with their ``{defaults}``, an output and the number of points are declared; empty
        where they are not.
    head, loop, store, foot : tuple of str, tuple of str, str, tuple of str
        The lines that begin the function; those that begin the loop over points, none where arrays are computed
        with, or one point is; the statement that puts the ``{value}`` of output ``{k}`` in its place; the lines that
        end it all.
    margin : int
        By how many blanks statements are moved in, those of a loop four more.
    number : callable
        A finite number that is not negative, as it is written.
    nan, infinity : str
        What is no such number.
    precision : Precision
        The format of its numbers.
    comment : tuple of str
        What opens a comment of several lines, what begins each line, and what ends it.
    notes, preamble : tuple of str
        What to know before it is compiled or called; lines of code below that comment.
    uniform : str
        Declares the ``{count}`` letters there, where they are no parameter.
    functions : mapping of str to str
        Functions by name, for each whose name occurs in a statement; they stand above, or ``below``.
    unused : str
        Says that a parameter is not used.
    width : int, optional
        How long a line may be; longer ones are continued after a comma.
    """

    suffix: str
    statement: str
    coordinate: str
    letter: str
    input: str
    output: str
    head: tuple[str, ...]
    store: str
    foot: tuple[str, ...]
    given: str = ""
    size: str = ""
    loop: tuple[str, ...] = ()
    margin: int = 4
    number: Callable[[float], str] = repr
    nan: str = "NaN"
    infinity: str = "Infinity"
    precision: Precision = FLOAT64
    comment: tuple[str, str, str] = ("", "// ", "")
    notes: tuple[str, ...] = ()
    preamble: tuple[str, ...] = ()
    uniform: str = ""
    functions: Mapping[str, str] = field(default_factory=dict)
    below: bool = False
    unused: str = ""
    width: int | None = None

    def literal(self, value: float) -> str:
        """A number; in parentheses if it has a sign."""
        if math.isnan(value):
            return self.nan
        text = self.infinity if math.isinf(value) else self.number(abs(value))
        return text if math.copysign(1, value) > 0 else f"(-{text})"


def _single(value: float) -> str:
    """A number of 32 bits: the largest at most, and unless it is 0 no less than what no machine takes for 0."""
    limits = np.finfo(np.float32)
    held = min(max(value, float(limits.smallest_normal)), float(limits.max)) if value else 0.0
    return repr(float(str(np.float32(held))))


def _double(value: float) -> str:
    """A number of Fortran, whose numbers are single without a d."""
    text = repr(value)
    return text.replace("e", "d") if "e" in text else f"{text}d0"


_NO_CONTRACTION = (
    "Where a product and a sum are not contracted to one operation, arithmetic gives the same bits everywhere."
)
_C_LOOP = ("    for (size_t i = 0; i < n; ++i) {{",)

LANGUAGES: dict[str, Language] = {
    "c": Language(
        suffix=".c",
        statement="const double {name} = {text};",
        coordinate="c{k}[i]",
        letter="letters[{k}]",
        input="const double *restrict c{k}",
        given="const double *restrict letters",
        output="double *restrict out{k}",
        size="size_t n",
        head=("void rsym_kernel({parameters})", "{{"),
        loop=_C_LOOP,
        store="out{k}[i] = {value};",
        foot=("    }}", "}}"),
        nan="NAN",
        infinity="INFINITY",
        comment=("/* ", " * ", " */"),
        notes=(
            "n points are evaluated; no array may overlap an output.",
            "",
            "    cc -O3 -march=native -fno-math-errno -ffp-contract=off -c kernel.c",
            "",
            "-fno-math-errno lets the compiler take square roots in vectors. With -ffp-contract=off arithmetic gives",
            "the same bits on every machine. -ffast-math breaks NaN and signs: never use it.",
        ),
        preamble=(
            "#include <math.h>",
            "#include <stddef.h>",
            "",
            "#if !defined(__GNUC__) || defined(__clang__) /* gcc knows the option only */",
            "#pragma STDC FP_CONTRACT OFF",
            "#endif",
            "",
        ),
        unused="(void){name};",
    ),
    "numpy": Language(
        suffix=".py",
        statement="{name} = {text}",
        coordinate="numpy.asarray(c{k}, float)",
        letter="numpy.float64(letters[{k}])",
        input="c{k}",
        given="letters=({defaults})",
        output="out{k}",
        head=(
            "def rsym_kernel({inputs}):",
            "    shape = numpy.broadcast(0.0, {coordinates}).shape",
            '    with numpy.errstate(all="ignore"):',
        ),
        store="out{k} = numpy.broadcast_to({value}, shape)",
        foot=("    return ({outputs},)",),
        margin=8,
        nan="numpy.nan",
        infinity="numpy.inf",
        comment=("", "# ", ""),
        notes=("Coordinates are arrays that broadcast, or numbers; a tuple of arrays comes back.",),
        preamble=("import numpy", "", ""),
    ),
    "matlab": Language(
        suffix=".m",
        statement="{name} = {text};",
        coordinate="c{k}",
        letter="letters({k1})",
        input="c{k}",
        given="letters",
        output="out{k}",
        head=("function [{outputs}] = rsym_kernel({inputs})",),
        store="out{k} = {value} - zeros(size({points}));",
        foot=("end",),
        infinity="Inf",
        comment=("", "% ", ""),
        notes=(
            "For Octave and for MATLAB from R2016b on, as the file rsym_kernel.m. Coordinates are arrays of compatible",
            "sizes, or numbers.",
        ),
        functions={
            "rsym_select": """function r = rsym_select(test, yes, no)
    none = zeros(size(test)) .* zeros(size(yes)) .* zeros(size(no));
    test = logical(test - none); yes = yes - none; r = no - none;
    r(test) = yes(test);
end""",
            "rsym_min": """function r = rsym_min(a, b)  % min(a, b) drops NaN
    none = zeros(size(a)) .* zeros(size(b));
    a = a - none; r = b - none; first = a < r | a ~= a;
    r(first) = a(first);
end""",
            "rsym_max": """function r = rsym_max(a, b)  % max(a, b) drops NaN
    none = zeros(size(a)) .* zeros(size(b));
    a = a - none; r = b - none; first = a > r | a ~= a;
    r(first) = a(first);
end""",
            "rsym_sqrt": """function r = rsym_sqrt(a)  % sqrt(a) is complex for a < 0
    a(a < 0) = NaN;
    r = sqrt(a);
end""",
            "rsym_log": """function r = rsym_log(a)  % log(a) is complex for a < 0
    a(a < 0) = NaN;
    r = log(a);
end""",
            "rsym_power": """function r = rsym_power(a, b)  % a .^ b is complex for a < 0 and fractions b
    none = zeros(size(a)) .* zeros(size(b));
    a = a - none; b = b - none; r = abs(a) .^ b;
    turned = (a < 0 | 1 ./ a < 0) & mod(b, 2) == 1;
    r(turned) = -r(turned);
    r(a < 0 & a > -Inf & b ~= fix(b)) = NaN;
end""",
        },
        below=True,
    ),
    "javascript": Language(
        suffix=".mjs",
        statement="const {name} = {text};",
        coordinate="c{k}[i]",
        letter="letters[{k}]",
        input="c{k}",
        given="letters",
        output="out{k}",
        head=("export function rsym_kernel({parameters}) {{",),
        loop=("    for (let i = 0; i < out0.length; ++i) {{",),
        store="out{k}[i] = {value};",
        foot=("    }}", "}}"),
        notes=("Arrays of numbers, Float64Array say; as many points are evaluated as out0 is long.",),
    ),
    "fortran": Language(
        suffix=".f90",
        statement="{name} = {text}",
        coordinate="c{k}(i)",
        letter="letters({k1})",
        input="c{k}",
        given="letters",
        output="out{k}",
        size="n",
        head=(
            'subroutine rsym_kernel({parameters}) bind(c, name="rsym_kernel")',
            "    use, intrinsic :: iso_c_binding",
            "    use, intrinsic :: ieee_arithmetic",
            "    implicit double precision (u-v)",
            "    integer(c_size_t), value :: n",
            "    real(c_double), intent(in), dimension(*) :: {inputs}",
            "    real(c_double), intent(out), dimension(n) :: {outputs}",
            "    double precision :: rsym_nan, rsym_inf",
            "    integer(c_size_t) :: i",
            "    rsym_nan = ieee_value(0.0d0, ieee_quiet_nan)",
            "    rsym_inf = ieee_value(0.0d0, ieee_positive_inf)",
        ),
        loop=("    do i = 1, n",),
        store="out{k}(i) = {value}",
        foot=("    end do", "end subroutine"),
        number=_double,
        nan="rsym_nan",
        infinity="rsym_inf",
        comment=("", "! ", ""),
        notes=(
            "n points are evaluated.",
            "",
            "    gfortran -O3 -march=native -ffp-contract=off -c kernel.f90",
            "",
            _NO_CONTRACTION,
        ),
        width=120,
    ),
    "rust": Language(
        suffix=".rs",
        statement="let {name}: f64 = {text};",
        coordinate="c{k}[i]",
        letter="letters[{k}]",
        input="c{k}: &[f64]",
        given="letters: &[f64]",
        output="out{k}: &mut [f64]",
        head=("#[allow(unused, clippy::all)]", "pub fn rsym_kernel({parameters}) {{"),
        loop=("    for i in 0..out0.len() {{",),
        store="out{k}[i] = {value};",
        foot=("    }}", "}}"),
        number=lambda value: f"{value!r}_f64",
        nan="f64::NAN",
        infinity="f64::INFINITY",
        notes=("As many points are evaluated as out0 is long. Edition 2021 or newer.",),
    ),
    "julia": Language(
        suffix=".jl",
        statement="{name} = {text}",
        coordinate="c{k}[i]",
        letter="letters[{k1}]",
        input="c{k}",
        given="letters",
        output="out{k}",
        head=("function rsym_kernel!({parameters})",),
        loop=("    for i in eachindex(out0)",),
        store="out{k}[i] = {value}",
        foot=("    end", "end"),
        infinity="Inf",
        comment=("", "# ", ""),
        notes=(
            "Arrays of Float64; the outputs are filled. Without @fastmath arithmetic gives the same bits everywhere.",
        ),
        functions={
            "rsym_sqrt": "rsym_sqrt(a) = a < 0 ? NaN : sqrt(a)  # sqrt(a) throws",
            "rsym_log": "rsym_log(a) = a < 0 ? NaN : log(a)  # log(a) throws",
            "rsym_power": """function rsym_power(a, b)  # a^b throws
    a < 0 && b != trunc(b) ? (isfinite(a) ? NaN : (-a)^b) : a^b
end""",
            "rsym_sin": "rsym_sin(a) = isinf(a) ? NaN : sin(a)  # sin(a) throws",
            "rsym_cos": "rsym_cos(a) = isinf(a) ? NaN : cos(a)  # cos(a) throws",
        },
    ),
    "cuda": Language(
        suffix=".cu",
        statement="const double {name} = {text};",
        coordinate="c{k}[i]",
        letter="letters[{k}]",
        input="const double *__restrict__ c{k}",
        given="const double *__restrict__ letters",
        output="double *__restrict__ out{k}",
        size="size_t n",
        head=('extern "C" __global__ void rsym_kernel({parameters})', "{{"),
        loop=(
            "    const size_t first = blockIdx.x * (size_t)blockDim.x + threadIdx.x;",
            "    for (size_t i = first; i < n; i += gridDim.x * (size_t)blockDim.x) {{",
        ),
        store="out{k}[i] = {value};",
        foot=("    }}", "}}"),
        nan="NAN",
        infinity="INFINITY",
        notes=(
            "n points are evaluated by a grid of any size; all arrays lie in the memory of the device.",
            "",
            "    nvcc -O3 -fmad=false -c kernel.cu",
            "",
            "With -fmad=false arithmetic gives the same bits as on the processor. -use_fast_math: never.",
        ),
        preamble=("#include <math.h>", "#include <stddef.h>", ""),
    ),
    "glsl": Language(
        suffix=".glsl",
        statement="float {name} = {text};",
        coordinate="c{k}",
        letter="letters[{k}]",
        input="float c{k}",
        output="out float out{k}",
        head=("void rsym_kernel({parameters}) {{",),
        store="out{k} = {value};",
        foot=("}}",),
        number=_single,
        nan="uintBitsToFloat(0x7fc00000u)",
        infinity="uintBitsToFloat(0x7f800000u)",
        precision=FLOAT32,
        notes=(
            "GLSL ES 3.00, in single precision, at one point. The language promises nothing of NaN and infinities: min",
            "and max may drop a NaN, comparisons with one be anything, and so may sqrt, log and pow outside of their",
            "domains. What must be right there too is asked before: clamp what is large, step aside from corners.",
        ),
        preamble=("precision highp float;",),
        uniform="uniform float letters[{count}];",
    ),
}
