"""Where the tables of a large form lie among its constants, and what lies where in the memory of a thread."""

from __future__ import annotations

from rsym.sampling.kernels.routines import LANES


class FormTable:
    """Where the tables of a form begin among its constants: the rows of its leaves, then integers."""

    LEAF = 3  # integers of a leaf: its kind, where its row begins, its number at points
    GATE = 4  # of a gate: 0 for min, 1 for max; both operands; 1 and 2 where these have a value everywhere

    def __init__(self, begin: int, numbers: int, leaves: int, gates: int) -> None:
        self.rows = begin
        self.leaves = begin + numbers
        self.gates = self.leaves + self.LEAF * leaves
        self.end = self.gates + self.GATE * gates


class WorkRoom:
    """Where the parts of the memory begin that a thread works in, in numbers of eight bytes.

    A region is what matters of a form: how many entries, then for each what to do and with what.
    """

    ENTRY = 3
    STAMP = 0  # how many regions were made

    def __init__(self, words: int, operands: int) -> None:
        self.region = LANES
        self.values = self.region + 1 + self.ENTRY * operands  # of entries, or of operands: four vectors each
        self.places = self.values + 4 * LANES * operands  # of operands in the region
        self.stack = self.places + operands  # a gate is opened once, and puts itself and two operands on it
        self.marks = self.stack + 3 * operands + 1  # the words of eight lanes
        self.size = self.marks + LANES * words
