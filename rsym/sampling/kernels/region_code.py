"""The routine that makes a region, what is left of a large form, from the bits of the operands of its gates."""

from __future__ import annotations

from rsym.sampling.kernels.ray_code import RayFormulas
from rsym.sampling.kernels.routines import Routine
from rsym.sampling.kernels.table_code import BOTH, NEITHER, of_gate, of_leaf
from rsym.sampling.kernels.table_layout import FormTable, WorkRoom

PLACE = 2**32 - 1  # the bits of a place, below those that say which region it is of


class _Walk(Routine):
    """From the last gate on, with a stack; an operand that is met twice is made once.

    On the stack lies an operand, and a bit that says whether its own operands have been made.
    """

    def __init__(self, s: RayFormulas) -> None:
        super().__init__("region", dict.fromkeys(("words", "constants", "room"), "ptr"), internal=True)
        self.s = s
        self.top, self.made = (self.emit("alloca i64, align 8") for _ in range(2))
        parts = s.room.region, s.room.places, s.room.stack
        self.target, self.places, self.stack = (self.place("%room", "i64", part) for part in parts)
        self.stamp = self.emit(f"add i64 {self.load('%room', WorkRoom.STAMP, 'i64')}, 1")
        self.store(self.stamp, "%room", WorkRoom.STAMP, "i64")
        for counter in (self.top, self.made):
            self.store("0", counter, 0, "i64")

    def change(self, counter: str, amount: str) -> None:
        """Add to a counter."""
        self.store(self.emit(f"add i64 {self.load(counter, 0, 'i64')}, {amount}"), counter, 0, "i64")

    def push(self, item: str, when: str) -> None:
        """Put something on the stack, if a bit is set."""
        self.store(item, self.stack, self.load(self.top, 0, "i64"), "i64")
        self.change(self.top, when)

    def enter(self, operand: str, *entry: str) -> None:
        """One more entry, which is the value of the operand; on with the walk."""
        number = self.load(self.made, 0, "i64")
        first = self.emit(f"add i64 {self.emit(f'mul i64 {number}, {WorkRoom.ENTRY}')}, 1")
        for k, part in enumerate(entry):
            self.store(part, self.place(self.target, "i64", first), k, "i64")
        mark = self.emit(f"shl i64 {self.stamp}, 32")
        self.store(self.emit(f"or i64 {mark}, {number}"), self.places, operand, "i64")
        self.change(self.made, "1")
        self.do("br label %next")

    def entry_of(self, operand: str) -> str:
        """The entry that is the value of an operand."""
        return self.emit(f"and i64 {self.load(self.places, operand, 'i64')}, {PLACE}")

    def gate(self, item: str, operand: str) -> None:
        """Its busy operands first, then what they make: with one of them it is that."""
        kinds, gate = len(self.s.kinds.kinds), self.emit(f"sub i64 {operand}, {len(self.s.rays.leaves)}")
        operation, first, second = (self.load(of_gate(self.s, self, gate), k, "i64") for k in range(3))
        bit = self.emit(f"shl i64 {gate}, 1")
        word, within = self.emit(f"lshr i64 {bit}, 6"), self.emit(f"and i64 {bit}, 63")
        idle = self.emit(f"lshr i64 {self.load('%words', word, 'i64')}, {within}")
        busy = self.emit(f"and i64 {self.emit(f'xor i64 {idle}, 3')}, 3")
        self.do(f"br i1 {self.emit(f'trunc i64 {item} to i1')}, label %close, label %open")
        self.start("open")
        self.push(self.emit(f"or i64 {item}, 1"), "1")
        self.push(self.emit(f"shl i64 {second}, 1"), self.emit(f"lshr i64 {busy}, 1"))
        self.push(self.emit(f"shl i64 {first}, 1"), self.emit(f"and i64 {busy}, 1"))
        self.do("br label %next")
        self.start("close")
        self.do(f"switch i64 {busy}, label %both [ i64 0, label %none i64 1, label %first i64 2, label %second ]")
        self.start("both")
        joined = self.emit(f"add i64 {operation}, {kinds + BOTH[0]}")
        self.enter(operand, joined, self.entry_of(first), self.entry_of(second))
        self.start("none")
        self.enter(operand, self.emit(f"add i64 {operation}, {kinds + NEITHER[0]}"), "0", "0")
        for label, kept in (("first", first), ("second", second)):
            self.start(label)
            self.store(self.load(self.places, kept, "i64"), self.places, operand, "i64")
            self.do("br label %next")


def region(s: RayFormulas) -> Routine:
    """Make the region of words, in the room."""
    r = _Walk(s)
    r.push(f"{2 * (s.operands - 1)}", "1")
    r.label("next")
    left = r.load(r.top, 0, "i64")
    r.do(f"br i1 {r.emit(f'icmp eq i64 {left}, 0')}, label %end, label %pop")
    r.start("pop")
    r.change(r.top, "-1")
    item = r.load(r.stack, r.emit(f"sub i64 {left}, 1"), "i64")
    operand = r.emit(f"lshr i64 {item}, 1")
    age = r.emit(f"lshr i64 {r.load(r.places, operand, 'i64')}, 32")
    r.do(f"br i1 {r.emit(f'icmp eq i64 {age}, {r.stamp}')}, label %next, label %new")
    r.start("new")
    r.do(f"br i1 {r.emit(f'icmp slt i64 {operand}, {len(s.rays.leaves)}')}, label %leaf, label %gate")
    r.start("leaf")
    leaf = of_leaf(s, r, operand)
    r.enter(operand, *(r.load(leaf, k, "i64") for k in range(FormTable.LEAF)))
    r.start("gate")
    r.gate(item, operand)
    r.start("end")
    r.store(r.load(r.made, 0, "i64"), r.target, 0, "i64")
    r.do("ret void")
    return r
