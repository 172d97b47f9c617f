"""Formulas on LLVM vectors, written as formulas: every operator emits one instruction and sets no fast-math flag."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from functools import reduce

_REAL, _INTEGER, _TRUTH = "double", "i64", "i1"
# Added to a number below 2**51, leaves it rounded to an integer in the last bits.
_MAGIC, _MAGIC_BITS = 1.5 * 2.0**52, 0x43380000_00000000


@dataclass
class Block:
    """The instructions of a function of vectors of float64."""

    lanes: int
    lines: list[str] = field(default_factory=list)

    def emit(self, text: str, kind: str) -> Value:
        """One more instruction."""
        name = f"%t{len(self.lines)}"
        self.lines.append(f"  {name} = {text}")
        return Value(self, name, kind)

    def type_of(self, kind: str) -> str:
        """The vector type of a kind of element."""
        return f"<{self.lanes} x {kind}>"

    def constant(self, number: float | int, kind: str) -> str:
        """A number in every lane."""
        text = number_text(number) if kind == _REAL else str(int(number))
        return f"<{', '.join([f'{kind} {text}'] * self.lanes)}>"


@dataclass(frozen=True, eq=False)
class Value:
    """A vector of reals, of 64-bit integers, or of truth values."""

    block: Block
    name: str
    kind: str

    def _text(self, other: Value | float) -> str:
        return other.name if isinstance(other, Value) else self.block.constant(other, self.kind)

    def _join(self, operation: str, other: Value | float, turned: bool = False) -> Value:
        prefix = "f" if self.kind == _REAL else ""
        names = [self.name, self._text(other)]
        if turned:
            names.reverse()
        return self.block.emit(f"{prefix}{operation} {self.block.type_of(self.kind)} {', '.join(names)}", self.kind)

    def __add__(self, other: Value | float) -> Value:
        return self._join("add", other)

    def __radd__(self, other: float) -> Value:
        return self._join("add", other, turned=True)

    def __sub__(self, other: Value | float) -> Value:
        return self._join("sub", other)

    def __rsub__(self, other: float) -> Value:
        return self._join("sub", other, turned=True)

    def __mul__(self, other: Value | float) -> Value:
        return self._join("mul", other)

    def __rmul__(self, other: float) -> Value:
        return self._join("mul", other, turned=True)

    def __truediv__(self, other: Value | float) -> Value:
        return self._join("div", other)

    def __rtruediv__(self, other: float) -> Value:
        return self._join("div", other, turned=True)

    def __and__(self, other: Value | int) -> Value:
        return self._join("and", other)

    def __or__(self, other: Value | int) -> Value:
        return self._join("or", other)

    def __xor__(self, other: Value | int) -> Value:
        return self._join("xor", other)

    def __lshift__(self, places: int) -> Value:
        return self._join("shl", places)

    def __rshift__(self, places: int) -> Value:
        return self._join("ashr", places)

    def __neg__(self) -> Value:
        return self.block.emit(f"fneg {self.block.type_of(_REAL)} {self.name}", _REAL)

    def __abs__(self) -> Value:
        return (self.bits & (2**63 - 1)).real

    def compare(self, condition: str, other: Value | float) -> Value:
        """A comparison by LLVM's name for it: olt, ogt, oeq, uno; slt, eq."""
        comparison = "fcmp" if self.kind == _REAL else "icmp"
        vector = self.block.type_of(self.kind)
        return self.block.emit(f"{comparison} {condition} {vector} {self.name}, {self._text(other)}", _TRUTH)

    def __lt__(self, other: Value | float) -> Value:
        return self.compare("olt" if self.kind == _REAL else "slt", other)

    def __gt__(self, other: Value | float) -> Value:
        return self.compare("ogt" if self.kind == _REAL else "sgt", other)

    def choose(self, yes: Value | float, no: Value | float) -> Value:
        """Of two reals, `yes` where this is true."""
        names = [v.name if isinstance(v, Value) else self.block.constant(v, _REAL) for v in (yes, no)]
        real = self.block.type_of(_REAL)
        flags = f"{self.block.type_of(_TRUTH)} {self.name}"
        return self.block.emit(f"select {flags}, {real} {names[0]}, {real} {names[1]}", _REAL)

    @property
    def bits(self) -> Value:
        """The bits of a real, as an integer."""
        source, target = self.block.type_of(_REAL), self.block.type_of(_INTEGER)
        return self.block.emit(f"bitcast {source} {self.name} to {target}", _INTEGER)

    @property
    def real(self) -> Value:
        """The real with these bits."""
        source, target = self.block.type_of(_INTEGER), self.block.type_of(_REAL)
        return self.block.emit(f"bitcast {source} {self.name} to {target}", _REAL)

    @property
    def rounded(self) -> Value:
        """The nearest integer, as a real; below 2**50."""
        return (self + _MAGIC) - _MAGIC

    @property
    def integer_bits(self) -> Value:
        """An integral real as an integer, right in its last 51 bits."""
        return (self + _MAGIC).bits

    @property
    def integer_to_real(self) -> Value:
        """An integer below 2**50 as a real."""
        return (self + _MAGIC_BITS).real - _MAGIC

    @property
    def power_of_two(self) -> Value:
        """2**k for an integral real k from -1022 to 1023."""
        return ((self + 1023.0).integer_bits << 52).real


def polynomial(z: Value, coefficients: tuple[float, ...]) -> Value:
    """c0 + c1 z + c2 z**2 + ..., by Horner."""
    *lower, last = coefficients
    value = z * last + lower.pop()
    return reduce(lambda sum_, coefficient: sum_ * z + coefficient, reversed(lower), value)


def two_sum(a: Value, b: Value | float) -> tuple[Value, Value]:
    """A + b as rounded, and what rounding lost (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def number_text(number: float) -> str:
    """A float64 as LLVM writes it exactly."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"
