"""A program on a line: inputs replaced by nodes of another program, and pieces chosen that hold on an interval."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TypeAlias

from rsym.errors import RsymError
from rsym.program.builder import Builder
from rsym.program.program import live

Part: TypeAlias = tuple[Fraction, Fraction]
# Coefficients by the names of inputs, "" for the constant.
Line: TypeAlias = Mapping[str, Fraction]
ZERO = Fraction(0)
# Where samples find an edge torn, the stretches on both sides of that place end within this share of them.
BESIDE = Fraction(1, 1000)
# The parameter of the program of an edge.
PARAMETER = "t"
# The formulas of a loft of nine splines have 3 000 nodes; a proof about more would take minutes.
MOST_NODES = 60_000


class NoProof(RsymError):
    """Why nothing is proved.

    Examples
    --------
    >>> NoProof("the edges run at different speeds").code
    'no-proof'
    """

    def __init__(self, message: str) -> None:
        super().__init__(message, code="no-proof")

    def __reduce__(self) -> tuple[object, ...]:
        return NoProof, (self.message,)


class Specialised:
    """Copies nodes of one program into another one of the parameter t alone, on an interval of t.

    Where a piecewise node has a border inside the interval, the border is noted in `borders` and the piece of the
    middle is taken: what was copied then holds on the parts between borders only, and they are to be copied anew.
    Where the whole line is a border, the piece on its side `inwards` is taken: an input and the sign of the way.
    What a formula says on such a border itself may be a third thing, as of ``Piecewise((0, u < 1), (0, u > 1), (1,
    True))``: `joins` are the places of the part, its ends among them and what is close by, at which it is asked, and
    `lies_on_border` tells whether it is all along. A copy that is `literal` takes there what the formula says.

    Examples
    --------
    >>> source, target = Builder(("u", "v"), ()), Builder(("t",), ())
    >>> u, v = source.input("u"), source.input("v")
    >>> half = source.const(Fraction(1, 2))
    >>> kinked = source.select(v, half, source.mul(u, v), u)
    >>> inputs = {"u": target.const(1), "v": target.input("t")}
    >>> copy = Specialised(source, target, inputs, (Fraction(0), Fraction(1)))
    >>> copy.node(kinked) == target.input("t"), copy.borders
    (True, {Fraction(1, 2)})
    """

    def __init__(
        self,
        source: Builder,
        target: Builder,
        inputs: Mapping[str, int],
        part: Part,
        inwards: tuple[str, int] | None = None,
        *,
        literal: bool = False,
    ) -> None:
        self.source, self.target, self.inputs, self.part, self.inwards = source, target, inputs, part, inwards
        self.literal = literal
        self.borders: set[Fraction] = set()
        self.joins: set[Fraction] = set()
        self.lies_on_border = False
        self._done: dict[int, int] = {}
        self._taken: dict[int, int] = {}
        self._lines: dict[int, dict[int, Line | None]] = {}

    def node(self, number: int) -> int:
        """The copy of a node; of pieces only the one that is taken is copied."""
        stack = [number]
        while stack:
            current = stack[-1]
            missing = [] if current in self._done else self._missing(current)
            if missing:
                stack += missing
                continue
            if current not in self._done:
                self._done[current] = self._copy(current)
            stack.pop()
        if len(self.target.nodes) > MOST_NODES:
            raise NoProof(f"the formulas have more than {MOST_NODES} nodes")
        return self._done[number]

    def _missing(self, number: int) -> list[int]:
        """What has to be copied before this node."""
        operation, arguments, _ = self.source.nodes[number]
        if operation != "select":
            return [one for one in arguments if one not in self._done]
        missing = [one for one in arguments[:2] if one not in self._done]
        if missing:
            return missing
        if number not in self._taken:
            above = self._sign(*arguments[:2], choosing=True) > 0
            self._taken[number] = arguments[2] if above else arguments[3]
        taken = self._taken[number]
        return [] if taken in self._done else [taken]

    def _copy(self, number: int) -> int:
        operation, arguments, data = self.source.nodes[number]
        if operation == "input":
            return self.inputs[str(data)]
        if operation == "const":
            return self.target.make("const", data=data)
        if operation == "undefined":
            raise NoProof("a formula is undefined on the edge")
        if operation == "select":
            return self._done[self._taken[number]]
        inner = [self._done[one] for one in arguments]
        if operation in _PIECEWISE:
            return _PIECEWISE[operation](self, *arguments)
        if operation in _SINGULAR and self.target.value(inner[_SINGULAR[operation]]) == 0:
            raise NoProof("a formula has a root, a logarithm or a denominator that vanishes on the edge")
        making = getattr(self.target, operation, None) if operation in _FOLDING else None
        if making is None:
            return self.target.make(operation, *inner, data=data)
        return int(making(*inner) if data is None else making(*inner, data))

    def size(self, a: int) -> int:
        """|a|, one of the two pieces."""
        return self._done[a] if self._sign(a) > 0 else self.target.neg(self._done[a])

    def greater(self, a: int, b: int) -> int:
        """The greater of two."""
        return self._done[a if a == b or self._sign(a, b) > 0 else b]

    def smaller(self, a: int, b: int) -> int:
        """The smaller of two."""
        return self._done[b if a == b or self._sign(a, b) > 0 else a]

    def _sign(self, a: int, b: int | None = None, *, choosing: bool = False) -> int:
        """The sign of a - b, linear in t, in the middle of the interval; where it changes inside is noted.

        On the border itself a comparison a > b is false, which counts in a literal copy.
        """
        known = self._done[a] if b is None else self.target.sub(self._done[a], self._done[b])
        line = self._line_of(self.target, known)
        if line is None:
            raise NoProof("where the pieces of a formula meet is not linear in the parameter of the edge")
        low, high = self.part
        constant, slope = line.get("", ZERO), line.get(PARAMETER, ZERO)
        middle = constant + slope * (low + high) / 2
        if slope and low < -constant / slope < high:
            self.borders.add(-constant / slope)
            middle = middle or slope
        beside = BESIDE * (high - low)
        if choosing and slope and low - beside <= -constant / slope <= high + beside:
            self.joins.add(-constant / slope)
            if self._is_oblique(a, b):
                raise NoProof("pieces of a formula meet on a line that crosses the edge obliquely")
        if middle == 0 and slope == 0:
            self.lies_on_border |= choosing
            if self.literal:
                return -1
        if middle == 0:
            middle = self._beside(a, b) if slope == 0 else ZERO
        if middle == 0:
            raise NoProof("the edge is where pieces of a formula meet")
        return 1 if middle > 0 else -1

    def _is_oblique(self, a: int, b: int | None) -> bool:
        """Whether a - b changes inwards too: beside its zero there may be pieces that the edge never has."""
        nodes = self.source.nodes
        parts = live(nodes, [a] if b is None else [a, b])
        return self.inwards is not None and any(
            nodes[part].operation == "input" and nodes[part].data == self.inwards[0] for part in parts
        )

    def _line_of(self, builder: Builder, number: int) -> Line | None:
        return line_of(builder, number, self._lines.setdefault(id(builder), {}))

    def _beside(self, a: int, b: int | None) -> Fraction:
        """How a - b, zero on the line, grows from there inwards."""
        lines = (
            [{}, self._line_of(self.source, a)]
            if b is None
            else [self._line_of(self.source, b), self._line_of(self.source, a)]
        )
        if self.inwards is None or None in lines:
            return ZERO
        name, way = self.inwards
        below, above = (line.get(name, ZERO) for line in lines if line is not None)
        return way * (above - below)


def line_of(builder: Builder, number: int, known: dict[int, Line | None]) -> Line | None:
    """The coefficients of the inputs, "" for the constant, if a node is linear in them; `known` are those found.

    Examples
    --------
    >>> builder = Builder(("u", "v"), ())
    >>> number = builder.sub(builder.input("u"), builder.const(Fraction(1, 2)))
    >>> {name: str(value) for name, value in line_of(builder, number, {}).items()}
    {'u': '1', '': '-1/2'}
    """
    if number not in known:
        known[number] = _new_line(builder, number, known)
    return known[number]


def _new_line(builder: Builder, number: int, known: dict[int, Line | None]) -> Line | None:
    operation, arguments, data = builder.nodes[number]
    if operation == "const":
        return {"": data} if isinstance(data, Fraction) else None
    if operation == "input":
        return {str(data): Fraction(1)}
    inner = [line_of(builder, one, known) for one in arguments] if operation in {"add", "neg", "mul"} else [None]
    lines = [one for one in inner if one is not None]
    if len(lines) < len(inner):
        return None
    if operation == "neg":
        return {name: -value for name, value in lines[0].items()}
    if operation == "add":
        return {name: lines[0].get(name, ZERO) + lines[1].get(name, ZERO) for name in {**lines[0], **lines[1]}}
    constants = [line for line in lines if not any(value for name, value in line.items() if name)]
    if not constants:
        return None
    factor, line = constants[0].get("", ZERO), lines[1] if constants[0] is lines[0] else lines[0]
    return {name: factor * value for name, value in line.items()}


# Operations that are not analytic where the operand at this place vanishes; nought times what they give is no nought.
_SINGULAR: Mapping[str, int] = {"div": -1, "sqrt": -1, "log": 0, "pow": 0, "atan2": -1, "sign": 0}
_FOLDING = frozenset({"add", "mul", "neg", "div", "powi", "sqrt"})
_PIECEWISE: Mapping[str, Callable[..., int]] = {
    "abs": Specialised.size,
    "max": Specialised.greater,
    "min": Specialised.smaller,
}
