"""Fields as functions of coordinates and letters alike, and their derivatives, level by level, as programs.

What packages that differentiate are given: they take the derivatives of rsym, whose rules do not cancel and know
corners, in the place of those that they would make of every single operation.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Any

from rsym.backends.languages import statements
from rsym.backends.numpy_backend import function_of
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.wording import listing, proposal
from rsym.program.builder import Builder
from rsym.program.calculus import order_of
from rsym.program.differentiation import ONE_SIDED, derivative
from rsym.program.expansion import expand
from rsym.program.fields import Jumps, doubt, part_names, program_of, unless
from rsym.program.operations import OPERATIONS, POWERS, those
from rsym.program.program import Node, Precision, Program

CHOICES = ("zero", "one-sided", "nan")
# Their rules of derivation take the last argument for a constant; where it is a letter, the expansion is derived.
PARAMETRIC = those(lambda row: row.parameter is not None) | POWERS | {"monomial"}


@dataclass(frozen=True)
class Output:
    """A function: its name, its node, the node that is computed, and the order of its highest derivative.

    `node` is right where the function exists, `found` says what it is elsewhere too; `doubtful` is a node that is
    positive where it does not exist, else 0.
    """

    name: str
    node: int
    found: int
    order: int
    doubtful: int


class Setting:
    """What all levels have in common: the builder, whose inputs all vary, and what becomes of corners."""

    def __init__(self, builder: Builder, coordinates: Sequence[str], at_corners: str, precision: Precision) -> None:
        self.builder = builder
        self.coordinates = coordinates
        self.at_corners = at_corners
        self.precision = precision
        self.jumps = Jumps(builder)
        self.one_sided: dict[tuple[int, str], int] = {}

    def along(self, output: Output, name: str) -> Output:
        """The derivative of a function along an input."""
        b = self.builder
        node = derivative(b, output.node, name)
        doubtful = self._doubtful(output, node, name)
        if self.at_corners == "one-sided" and output.order == 0:
            found = derivative(b, output.node, name, rules=ONE_SIDED, known=self.one_sided)
        else:
            found = unless(b, doubtful, node)
        return Output(f"{output.name} along {name}", node, found, output.order + 1, doubtful)

    def _doubtful(self, output: Output, node: int, name: str) -> int:
        """Positive where the function jumps, or its derivative; `rsym.program.fields.Existence` does so for fields."""
        b, share = self.builder, self.precision.rounding
        jumps = self.jumps[output.node], self.jumps[node]
        if all(jump == b.const(0) for jump in jumps):
            return output.doubtful
        names = dict.fromkeys((*self.coordinates, name))
        slopes = {one: derivative(b, output.node, one) for one in names}
        steepness = reduce(b.add, [b.abs(slope) for slope in slopes.values()])
        moves = [b.abs(b.mul(slope, b.input(one))) for one, slope in slopes.items()]
        size = reduce(b.add, [b.abs(output.node), *moves])
        found = b.add(doubt(b, jumps[0], size, share), doubt(b, jumps[1], steepness, share))
        return b.add(output.doubtful, found)


class Differentiable:
    """Functions of all inputs, and what they are made of.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.program.program import FLOAT64
    >>> shape = rsym.Shape(rsym.conjunction(x, y), (x, y))
    >>> found = differentiable(shape, ("value",), "zero", FLOAT64).along(("x",))
    >>> list(found.names)
    ['value', 'value along x']
    """

    def __init__(self, setting: Setting, outputs: Sequence[Output]) -> None:
        self.setting = setting
        self.outputs = tuple(outputs)
        self._along: dict[tuple[str, ...], Differentiable] = {}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the functions."""
        return tuple(output.name for output in self.outputs)

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of coordinates and letters."""
        return self.setting.builder.coordinates

    @cached_property
    def program(self) -> Program:
        """The program of primitive operations."""
        return expand(self.setting.builder.program({str(k): one.found for k, one in enumerate(self.outputs)}))

    def along(self, names: tuple[str, ...]) -> Differentiable:
        """The functions themselves, then the derivatives of each along each of these inputs."""
        if names not in self._along:
            slopes = [self.setting.along(output, name) for output in self.outputs for name in names]
            self._along[names] = Differentiable(self.setting, (*self.outputs, *slopes))
        return self._along[names]

    def moving(self, free: Sequence[int]) -> Iterator[tuple[int, int, int]]:
        """Output, input and place in `along` of each derivative by these inputs that is not 0 everywhere."""
        higher, count = self.along(tuple(self.inputs[k] for k in free)), len(self.outputs)
        for k in range(count):
            for place, way in enumerate(free, start=count + k * len(free)):
                if self.setting.builder.value(higher.outputs[place].found) != 0:
                    yield k, way, place

    def function(self, package: Any) -> Callable[..., tuple[Any, ...]]:
        """A function of arrays, of the package whose names are NumPy's."""
        names = {name: f"c{k}" for k, name in enumerate(self.inputs)}
        _, lines, texts = statements(self.program, "numpy", inputs=names, precision=self.setting.precision)
        results = "".join(f"{texts[number]}, " for _, number in self.program.outputs)
        text = "\n    ".join([f"def kernel({', '.join(names.values())}):", *lines, f"return {results}"])
        return function_of(text, self.program, package)


def differentiable(shape: Shape, fields: Sequence[str], at_corners: str, precision: Precision) -> Differentiable:
    """The scalar outputs that make up the fields, by the names of `part_names`, in order."""
    smooth = program_of(shape, fields, share=None)
    kept = program_of(shape, fields, share=precision.rounding)
    found = kept if at_corners != "one-sided" else program_of(shape, fields, share=precision.rounding, one_sided=True)
    builder = Builder((*smooth.coordinates, *smooth.letters), ())
    nodes, existing, ends = (_copied(builder, program) for program in (smooth, kept, found))
    zero = builder.const(0)
    orders = {str(name): order_of(field) for field in fields for name in part_names(field, shape.dimension).flat}
    outputs = []
    for name, node in nodes.items():
        missing = builder.select(builder.abs(existing[name]), builder.const(-1), zero, builder.const(1))
        outputs.append(Output(str(name), node, ends[name], orders[name], missing if orders[name] else zero))
    return Differentiable(Setting(builder, smooth.coordinates, at_corners, precision), outputs)


def _copied(builder: Builder, program: Program) -> dict[str, int]:
    """The outputs of a program as nodes of another builder, for which a letter varies like a coordinate."""
    done: list[int] = []
    for operation, places, data in program.nodes:
        node = Node(operation, tuple(done[place] for place in places), data)
        expansion = OPERATIONS[operation].expansion
        varies = operation in PARAMETRIC and builder.nodes[node.arguments[-1]].operation != "const"
        if varies and expansion is not None:
            done.append(expansion(builder, node))
        else:
            done.append(builder.make(operation, *node.arguments, data=data))
    return {name: done[number] for name, number in program.outputs}


def without_gaps(whole: Mapping[str, Any], xp: Any) -> dict[str, Any]:
    """Fields made of derivatives as 0 where they are no numbers."""
    return {
        name: finite(array, xp) if order_of(name) and name != "singular" else array for name, array in whole.items()
    }


def finite(array: Any, xp: Any) -> Any:
    """The array, 0 where it is no number."""
    return xp.where(xp.isfinite(array), array, 0.0)


def checked_corners(at_corners: Any) -> str:
    """What becomes of corners, or a refusal."""
    if not isinstance(at_corners, str) or at_corners not in CHOICES:
        raise RsymError(f"at_corners must be one of {listing(CHOICES)}, got {at_corners!r}", code="corners")
    return at_corners


def taken_apart(shape: Shape, arguments: Sequence[Any], letters: Any) -> list[Any]:
    """The inputs in order, from coordinates, perhaps a mapping of letters after them, and letters by name.

    The values may be anything: a package that differentiates hands over what stands for them.
    """
    count = shape.dimension
    if len(arguments) == count + 1 and letters is None:
        letters = arguments[-1]
    elif len(arguments) != count:
        names = ", ".join(symbol.name for symbol in shape.coordinates)
        raise RsymError(f"this function takes {count} coordinates ({names}), got {len(arguments)}", code="arity")
    if not isinstance(letters, Mapping | None):
        raise RsymError(
            f"letters are a dictionary by name, got {type(letters).__name__}", code="letters", remedy="{'a': 2.5}"
        )
    given = {str(key): value for key, value in (letters or {}).items()}
    for name in given:
        if name not in shape.letters:
            raise RsymError(
                f"no letter {name!r}; the letters are: {listing(shape.letters)}",
                code="unknown-letter",
                remedy=proposal(name, shape.letters, "use one of these, or none"),
            )
    return [*arguments[:count], *(given.get(name, float(one.default)) for name, one in shape.letters.items())]
