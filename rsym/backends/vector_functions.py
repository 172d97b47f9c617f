"""Sine, cosine, exponential, logarithm, power and angle on vectors: below 1 ulp, the angle below 2.

Reductions and polynomials are those of fdlibm (Sun Microsystems 1993, freely
distributable), without branches and without fused operations, so a lane gives
the same bits on every processor and whatever stands beside it. Arguments that
the reduction does not hold go to libm, lane by lane.

No library takes this place. libmvec of glibc is right to 4 ulp, on Linux alone.
SVML (package intel-cmplr-lib-rt) is for x86 alone, under Intel's licence, and
chooses its code by the processor, so the bits would depend on it. SLEEF has no
package that llvmlite could link.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from rsym.backends.vector_angles import atan2, cos, far, sin
from rsym.backends.vector_code import Block, Value
from rsym.backends.vector_exponentials import exp, log, not_plain, pow

# The formula, and where libm takes over.
_FORMULAS: dict[str, tuple[Callable[..., Value], Callable[..., Value] | None]] = {
    "sin": (sin, far),
    "cos": (cos, far),
    "exp": (exp, None),
    "log": (log, None),
    "pow": (pow, not_plain),
    "atan2": (atan2, None),
}
ARITIES = {"sin": 1, "cos": 1, "exp": 1, "log": 1, "pow": 2, "atan2": 2}


def definitions(operations: Iterable[str], lanes: int) -> list[str]:
    """LLVM functions `rsym_<operation>` on vectors of that many lanes."""
    return [_definition(operation, lanes) for operation in operations]


def _definition(operation: str, lanes: int) -> str:
    formula, beyond = _FORMULAS[operation]
    block = Block(lanes)
    arguments = [Value(block, f"%x{k}", "double") for k in range(ARITIES[operation])]
    vector = block.type_of("double")
    value = formula(*arguments)
    if beyond is None:
        lines = [*block.lines, f"  ret {vector} {value.name}"]
    else:
        lines = _with_libm(operation, block, arguments, value, beyond(*arguments))
    parameters = ", ".join(f"{vector} {argument.name}" for argument in arguments)
    return "\n".join([f"define internal {vector} @rsym_{operation}({parameters}) {{", "entry:", *lines, "}"])


def _with_libm(operation: str, block: Block, arguments: list[Value], value: Value, beyond: Value) -> list[str]:
    """The value, but that of libm in the lanes beyond the reach of the formula."""
    vector, lanes = block.type_of("double"), block.lanes
    lines = [
        *block.lines,
        f"  %mask = bitcast <{lanes} x i1> {beyond.name} to i{lanes}",
        f"  %any = icmp ne i{lanes} %mask, 0",
        "  br i1 %any, label %slow, label %done",
        "slow:",
    ]
    result = value.name
    for lane in range(lanes):
        for k, argument in enumerate(arguments):
            lines.append(f"  %a{lane}.{k} = extractelement {vector} {argument.name}, i32 {lane}")
        scalars = ", ".join(f"double %a{lane}.{k}" for k in range(len(arguments)))
        lines.append(f"  %r{lane} = call double @{operation}({scalars})")
        lines.append(f"  %m{lane} = insertelement {vector} {result}, double %r{lane}, i32 {lane}")
        result = f"%m{lane}"
    return [
        *lines,
        f"  %mixed = select <{lanes} x i1> {beyond.name}, {vector} {result}, {vector} {value.name}",
        "  br label %done",
        "done:",
        f"  %result = phi {vector} [ {value.name}, %entry ], [ %mixed, %slow ]",
        f"  ret {vector} %result",
    ]
