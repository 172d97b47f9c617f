"""The executor of tapes as LLVM text: one loop over rows, for each operation the code that every backend prints for it.

It knows no model, so it is compiled once on a machine. A row is worked out on several vectors of points, all in one
go; what a vector holds has no part in what another does, so the bits are those of `llvm`.
"""

from __future__ import annotations

from collections.abc import Sequence

from rsym.backends.llvm_code import SCALAR, VECTORS, Emitter, Kind, declarations
from rsym.program.program import Node
from rsym.program.tape import WIDTH, Pattern, operands_of, patterns

# Vectors of a row. Of the speed of `llvm` on the car 4 reach 0.4, 8 a half, 16 as much on value and gradient and 0.6 on
# six fields, but what a block of 8*8 or 9*9*9 points leaves empty is work too.
ROW_VECTORS = 8
VARIES = 1  # the bit of an operand's address that tells a register from a number in every lane


def executor_source(precision: str) -> str:
    """The module: `evaluate`; in float64 `evaluate_uniform` too, on single numbers."""
    kind = VECTORS[precision]
    text = [*head(kind), _run("run", kind, ROW_VECTORS), _evaluate(kind)]
    if precision == "float64":
        text += [_run("run_uniform", SCALAR, 1), EVALUATE_UNIFORM]
    return "\n".join(text)


# One room of registers after the other.
EVALUATE_UNIFORM = """
define void @evaluate_uniform(ptr %code, ptr %rooms, i64 %bytes, i64 %count) {
entry:
  br label %head
head:
  %k = phi i64 [ 0, %entry ], [ %k1, %work ]
  %more = icmp slt i64 %k, %count
  br i1 %more, label %work, label %done
work:
  %at = mul i64 %k, %bytes
  %room = getelementptr i8, ptr %rooms, i64 %at
  call void @run_uniform(ptr %code, ptr %room)
  %k1 = add i64 %k, 1
  br label %head
done:
  ret void
}"""


def head(kind: Kind) -> list[str]:
    """What routines of tapes call."""
    nodes = [Node(pattern[0]) for pattern in patterns()]
    return [*declarations(kind, nodes), "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)"]


def run_routines(kind: Kind) -> list[str]:
    """`run`, on `ROW_VECTORS` vectors of each register, and `run_one`, on the first one."""
    return [_run("run", kind, ROW_VECTORS), _run("run_one", kind, 1)]


def size_of(kind: Kind) -> int:
    """The bytes of a vector."""
    return kind.lanes * (8 if kind.element == "double" else 4)


def _run(name: str, kind: Kind, vectors: int) -> str:
    """Work out the rows from `code` on, on the registers in `memory`."""
    labels = [f"row{number}" for number in range(1, len(patterns()) + 1)]
    cases = " ".join(f"i32 {number}, label %{label}" for number, label in enumerate(labels, 1))
    lines = [
        f"define internal void @{name}(ptr noalias %code, ptr noalias %memory) {{",
        "entry:",
        "  br label %head",
        "head:",
        f"  %row = phi ptr [ %code, %entry ], {', '.join(f'[ %next, %{label}.end ]' for label in labels)}",
        "  %operation = load i32, ptr %row, align 4",
        f"  %next = getelementptr i32, ptr %row, i64 {WIDTH}",
        f"  switch i32 %operation, label %end [ {cases} ]",
    ]
    for pattern, label in zip(patterns(), labels, strict=True):
        lines += [f"{label}:", *_case(pattern, label, kind, vectors), f"  br label %{label}.end", f"{label}.end:"]
        lines.append("  br label %head")
    return "\n".join([*lines, "end:", "  ret void", "}"])


def _case(pattern: Pattern, label: str, kind: Kind, vectors: int) -> list[str]:
    e = Emitter(kind, f"{label}.")
    size = size_of(kind)

    def field(k: int) -> str:
        part = e.emit(f"load i32, ptr {e.emit(f'getelementptr i32, ptr %row, i64 {k}')}, align 4")
        return e.emit(f"zext i32 {part} to i64")

    def at(address: str) -> str:
        return e.emit(f"getelementptr i8, ptr %memory, i64 {address}")

    def made(pattern: Pattern, operands: Sequence[str]) -> str:
        """The value of a pattern."""
        parts = [operands[part] if isinstance(part, int) else made(part, operands) for part in pattern[1:]]
        return e.operation(Node(pattern[0]), parts)

    target, places = at(field(1)), []
    for k in range(operands_of(pattern)):
        address = field(2 + k)
        bit = e.emit(f"and i64 {address}, {VARIES}")
        places.append((at(e.emit(f"xor i64 {address}, {bit}")), e.emit(f"mul i64 {bit}, {size}")))
    for i in range(vectors):
        loads = [e.emit(f"getelementptr i8, ptr {base}, i64 {e.emit(f'mul i64 {step}, {i}')}") for base, step in places]
        values = [e.emit(f"load {kind.type}, ptr {place}, align {size}") for place in loads]
        value = made(pattern, values)
        place = e.emit(f"getelementptr i8, ptr {target}, i64 {i * size}")
        e.lines.append(f"  store {kind.type} {value}, ptr {place}, align {size}")
    return e.lines


def _evaluate(kind: Kind) -> str:
    """`inputs` and `outputs` are arrays of addresses, `from` and `to` those of their registers."""
    size = size_of(kind) * ROW_VECTORS
    element = size_of(kind) // kind.lanes
    return f"""
define void @evaluate(ptr %code, ptr %memory, ptr %inputs, i64 %in, ptr %outputs, i64 %out, ptr %places, i64 %count) {{
entry:
  %bytes = mul i64 %count, {element}
  br label %head
head:
  %at = phi i64 [ 0, %entry ], [ %following, %stored ]
  %left = sub i64 %bytes, %at
  %most = icmp slt i64 %left, {size}
  %some = select i1 %most, i64 %left, i64 {size}
  %going = icmp sgt i64 %left, 0
  br i1 %going, label %loading, label %done
loading:
  %k = phi i64 [ 0, %head ], [ %k1, %load ]
  %more = icmp slt i64 %k, %in
  br i1 %more, label %load, label %work
load:
  %pp = getelementptr ptr, ptr %inputs, i64 %k
  %p = load ptr, ptr %pp, align 8
  %source = getelementptr i8, ptr %p, i64 %at
  %place = getelementptr i64, ptr %places, i64 %k
  %offset = load i64, ptr %place, align 8
  %register = getelementptr i8, ptr %memory, i64 %offset
  call void @llvm.memcpy.p0.p0.i64(ptr %register, ptr %source, i64 %some, i1 false)
  %k1 = add i64 %k, 1
  br label %loading
work:
  call void @run(ptr %code, ptr %memory)
  br label %storing
storing:
  %j = phi i64 [ 0, %work ], [ %j1, %store ]
  %again = icmp slt i64 %j, %out
  br i1 %again, label %store, label %stored
store:
  %qp = getelementptr ptr, ptr %outputs, i64 %j
  %q = load ptr, ptr %qp, align 8
  %target = getelementptr i8, ptr %q, i64 %at
  %number = add i64 %j, %in
  %result = getelementptr i64, ptr %places, i64 %number
  %from = load i64, ptr %result, align 8
  %value = getelementptr i8, ptr %memory, i64 %from
  call void @llvm.memcpy.p0.p0.i64(ptr %target, ptr %value, i64 %some, i1 false)
  %j1 = add i64 %j, 1
  br label %storing
stored:
  %following = add i64 %at, {size}
  br label %head
done:
  ret void
}}"""
