"""The formulas that the mesher's routines share: leaves with their gradients, at points and over boxes."""

from __future__ import annotations

from functools import cached_property

from rsym.bounds.intervals import interval_program
from rsym.logic.gates import Gate
from rsym.logic.sign_form import SignForm
from rsym.program.differentiation import gradient
from rsym.program.expansion import expand
from rsym.program.program import Program, assemble
from rsym.sampling.kernels.routines import Formulas, Routine

AXES = ("x", "y", "z")
ENDS = ("lower", "upper")
WORD = 64  # bits


class LeafFormulas:
    """A sign form as its routines need it."""

    def __init__(self, form: SignForm) -> None:
        self.gates: tuple[Gate, ...] = form.gates
        self.count = len(form.leaves)
        self.program = leaf_program(form)
        self.scaled_program = leaf_program(form, scaled=True)
        self.coordinates = self.program.coordinates

    @cached_property
    def points(self) -> Formulas:
        """Leaves at points, each times its scale, a letter."""
        return Formulas(expand(self.scaled_program))

    @cached_property
    def bounds(self) -> Formulas:
        """Leaves over boxes, by mean values where a coordinate repeats; nothing where one may be undefined."""
        leaves = [number for _, number in self.program.outputs[:: 1 + len(AXES)]]
        return Formulas(expand(interval_program(self.program, leaves, strict=True)), self.points.constants)

    @property
    def words(self) -> int:
        """How many words hold a bit for each operand of each gate."""
        return max(1, -(-2 * len(self.gates) // WORD))

    def at(self, r: Routine, points: str, stride: str, i: str) -> dict[int, str]:
        """The coordinates of points from `i` on, as inputs."""
        places = [r.load(r.row(points, stride, k), i) for k in range(3)]
        return self.points.inputs(dict(zip(self.coordinates, places, strict=True)))


def leaf_outputs(k: int) -> list[str]:
    """The names of value and derivatives of a leaf."""
    return [f"leaf{k}", *(f"leaf{k}_{axis}" for axis in AXES)]


def scale_letters(count: int) -> list[str]:
    """The letters that leaves are multiplied by; no letter of a user has a space in its name."""
    return [f"scale {k}" for k in range(count)]


def leaf_program(form: SignForm, scaled: bool = False) -> Program:
    """Value and gradient of every leaf."""
    b = form.builder
    outputs: dict[str, int] = {}
    scales = scale_letters(len(form.leaves)) if scaled else []
    for k, leaf in enumerate(form.leaves):
        value = b.mul(b.input(scales[k]), leaf) if scaled else leaf
        outputs.update(zip(leaf_outputs(k), (value, *gradient(b, value)), strict=True))
    return assemble(b.nodes, b.coordinates, (*b.letters, *scales), outputs)
