"""Tapes: rows against the program they are made of, row by row with the plain meanings."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym.backends.interpreter import interpret_nodes
from rsym.program.expansion import expand
from rsym.program.operations import OPERATIONS
from rsym.program.program import FLOAT64
from rsym.program.tape import END, JOINED, WIDTH, operands_of, patterns, tape_of


def meaning(pattern, operands):
    """The value of a pattern by the table of operations."""
    parts = [operands[part] if isinstance(part, int) else meaning(part, operands) for part in pattern[1:]]
    with np.errstate(all="ignore"):
        return OPERATIONS[pattern[0]].meaning(np, *parts)


def worked_out(program, tape, values):
    """The outputs by rows and by nodes; no register is read before it is filled."""
    registers = dict(enumerate(values[: len(program.coordinates)]))
    letters = dict(zip((*program.coordinates, *program.letters), values, strict=True))
    nodes = interpret_nodes(program, letters)

    def place(number):
        return registers[number] if number >= 0 else nodes[tape.uniform[~number]]

    for row in tape.rows[:-1].tolist():
        pattern = patterns()[row[0] - 1]
        registers[row[1]] = meaning(pattern, [place(o) for o in row[2 : 2 + operands_of(pattern)]])
    assert tape.rows[-1, 0] == END
    assert max(registers) < tape.registers
    return [place(output) for output in tape.outputs], [nodes[number] for _, number in program.outputs]


@pytest.mark.parametrize("model", ["car", "skeleton", "gear", "spring"])
@pytest.mark.parametrize("fields", [("value",), ("value", "gradient")])
def test_rows_mean_what_the_program_means(model, fields):
    shape = rsym.load(model)
    program = expand(rsym.compile(shape, fields, backend="numpy").program)
    tape = tape_of(program)
    generator = np.random.default_rng(3)
    box = shape.bounds or ((-1.0, 1.0),) * shape.dimension
    points = [generator.uniform(low, high, 64) for low, high in box]
    letters = [float(shape.letters[name].default) for name in program.letters]
    found, expected = worked_out(program, tape, [*points, *letters])
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)


def test_every_pattern_fits_a_row():
    assert all(operands_of(pattern) <= WIDTH - 2 for pattern in patterns())
    assert len({str(pattern) for pattern in patterns()}) == len(patterns())
    assert patterns()[-len(JOINED) :] == JOINED


def test_outputs_have_registers_of_their_own_and_coordinates_stay():
    x, y = rsym.x, rsym.y
    program = expand(rsym.compile(rsym.Shape(x + 2 * y, (x, y)), ("value", "gradient"), backend="numpy").program)
    tape = tape_of(program)
    assert len(set(tape.outputs)) == 3
    assert min(tape.outputs) >= 2
    assert not {row[1] for row in tape.rows[:-1].tolist()} & {0, 1}


@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize("model", ["car", "skeleton", "gyroid"])
def test_tape_has_the_bits_of_llvm(model, dtype):
    shape = rsym.load(model)
    fields = rsym.SIX if shape.dimension == 2 else ("value", "gradient")
    generator = np.random.default_rng(5)
    box = shape.bounds or ((-1.0, 1.0),) * shape.dimension
    points = [generator.uniform(low, high, 1003) for low, high in box]
    tape, llvm = (rsym.compile(shape, fields, backend=name, dtype=dtype)(*points) for name in ("tape", "llvm"))
    for field in fields:
        np.testing.assert_array_equal(tape[field], llvm[field])


def test_letters_change_and_nothing_is_made_again():
    a = sp.Symbol("a", real=True)
    shape = rsym.Shape(a * rsym.x + 1, (rsym.x, rsym.y), letters={a: 2})
    kernel = rsym.compile(shape, ("value", "gradient"), backend="tape")
    assert kernel([1.0, 2.0], 0.0)["value"].tolist() == [3.0, 5.0]
    changed = kernel([1.0, 2.0], 0.0, letters={"a": 5})
    assert changed["value"].tolist() == [6.0, 11.0]
    assert changed["gradient"].tolist() == [[5.0, 0.0], [5.0, 0.0]]
    assert FLOAT64.name == kernel.dtype
