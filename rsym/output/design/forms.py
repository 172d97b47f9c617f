"""A sign form as functions of shaders: its value and active leaf, its model along a ray, derivatives of each leaf.

What depends on letters alone is computed in JavaScript, in float64, and comes to the shaders as uniforms: another
value of a letter compiles nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rsym.backends.languages import frontier, statements
from rsym.logic.sign_form import SignForm, shape_form
from rsym.model.shape import Shape
from rsym.output.design import scaffold
from rsym.program.differentiation import gradient
from rsym.program.expansion import expand
from rsym.program.program import Program, live

# Of leaves whose values differ by less than this share the first is taken: faces in common do not speckle.
TIE = 0.02
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
# Without a choice by ? and : for compilers turn each of those into a branch, and some never end with a loop of many.
_TIES = f"""\
vec2 lesser(vec2 a, vec2 b) {{ return mix(a, b, bvec2(b.x < a.x - {TIE} * abs(a.x))); }}
vec2 larger(vec2 a, vec2 b) {{ return mix(a, b, bvec2(b.x > a.x + {TIE} * abs(a.x))); }}
"""
OF_TWO = {"min": "lesser", "max": "larger"}


class Uniforms:
    """Places of numbers that depend on letters alone, and the JavaScript that fills them.

    Examples
    --------
    >>> from rsym.program.program import Node
    >>> nodes = (Node("input", (), "x"), Node("input", (), "a"), Node("neg", (1,)), Node("mul", (0, 2)))
    >>> uniforms = Uniforms()
    >>> uniforms.places(Program(nodes, ("x",), ("a",), (("value", 3),)))
    {2: 'u[0].x'}
    >>> print(uniforms.script)
    {count: 1, of: (letters, u) => {
    { const u1 = letters[0]; const u2 = -u1; u[0] = u2; }
    }}
    """

    def __init__(self) -> None:
        self.count = 0
        self._blocks: list[str] = []

    def places(self, program: Program, first: Sequence[int] = ()) -> dict[int, str]:
        """Where a shader finds the nodes of an expanded program that are the same for all points.

        Those that the nodes `first` need come first: shaders that need no others declare no more.
        """
        early = {argument for number in live(program.nodes, first) for argument in program.nodes[number].arguments}
        numbers = sorted(frontier(program), key=lambda number: number not in early)
        slots = {number: self.count + k for k, number in enumerate(numbers)}
        self.count += len(numbers)
        part = statements(outputs_alone(program, numbers), "javascript")
        stores = [f"u[{slot}] = {part.names[number]};" for number, slot in slots.items()]
        if numbers:
            self._blocks.append(f"{{ {' '.join([*part.uniform, *stores])} }}")
        return {number: f"u[{slot // 4}].{'xyzw'[slot % 4]}" for number, slot in slots.items()}

    @property
    def declaration(self) -> str:
        """What a shader says of them."""
        return f"uniform vec4 u[{max(1, -(-self.count // 4))}];\n"

    @property
    def script(self) -> str:
        """A function of JavaScript that fills an array."""
        return "\n".join([f"{{count: {self.count}, of: (letters, u) => {{", *self._blocks, "}}"])


def outputs_alone(program: Program, numbers: Sequence[int]) -> Program:
    """The program with other nodes as outputs; nodes keep their numbers."""
    return replace(program, outputs=tuple((str(number), number) for number in numbers))


@dataclass(frozen=True)
class FormTexts:
    """The functions of a form in GLSL, and what it takes to run them.

    Attributes
    ----------
    form : SignForm
        The form itself.
    point, model, leaf, second : str
        ``vec2 form(vec3)``, the value and the active leaf; ``vec4 model(vec4, vec4, vec4)``, what it can be along a
        ray; ``vec4 leaf(int, vec3)``, value and gradient of a leaf; ``void second(...)``, gradient and Hessian.
    uniforms : Uniforms
        What the functions read.
    operations : int
        How many operations the value takes at a point.
    """

    form: SignForm
    point: str
    model: str
    leaf: str
    second: str
    uniforms: Uniforms
    operations: int


def operations_of(form: SignForm) -> int:
    """How many operations the value of a form takes at a point.

    Examples
    --------
    >>> import rsym
    >>> operations_of(shape_form(rsym.ball(1)))
    6
    """
    program = expand(form.builder.program({str(k): leaf for k, leaf in enumerate(form.leaves)}))
    varying = zip(program.nodes, program.uniform, strict=True)
    return len(form.gates) + sum(1 for node, uniform in varying if not uniform and node.operation != "input")


def form_texts(form: SignForm) -> FormTexts:
    """The functions of the sign form of a shape in space."""
    builder, uniforms = form.builder, Uniforms()
    outputs: dict[str, int] = {}
    for k, leaf in enumerate(form.leaves):
        slopes = gradient(builder, leaf)
        outputs[f"{k}"] = leaf
        outputs.update({f"{k} {i}": slope for i, slope in enumerate(slopes)})
        seconds = [gradient(builder, slope) for slope in slopes]
        outputs.update({f"{k} {i} {j}": seconds[i][j] for i, j in PAIRS})
    program = expand(builder.program(outputs))
    numbers = dict(program.outputs)
    below = [number for name, number in program.outputs if name.count(" ") < 2]
    writer = Writer(program, uniforms.places(program, below), dict(zip(builder.coordinates, ("p.x", "p.y", "p.z"), strict=True)))
    leaves = [numbers[f"{k}"] for k in range(len(form.leaves))]
    return FormTexts(
        form,
        _point(form, writer, leaves),
        scaffold.model_text(form, uniforms),
        "\n".join(_leaf(writer, numbers, len(leaves))),
        "\n".join(_second(writer, numbers, len(leaves))),
        uniforms,
        operations_of(form),
    )


class Writer:
    """Writes parts of one program in GLSL."""

    def __init__(self, program: Program, known: Mapping[int, str], inputs: Mapping[str, str]) -> None:
        self._program, self._known, self._inputs = program, known, inputs

    def __call__(self, numbers: Sequence[int]) -> tuple[list[str], list[str]]:
        """The statements of nodes, and the names of the nodes."""
        part = statements(outputs_alone(self._program, numbers), "glsl", inputs=self._inputs, known=self._known)
        return part.varying, [part.names[number] for number in numbers]


def _point(form: SignForm, writer: Writer, leaves: Sequence[int]) -> str:
    lines, names = writer(leaves)
    lines += [f"vec2 w{k} = vec2({name}, {k});" for k, name in enumerate(names)]
    for k, gate in enumerate(form.gates, len(names)):
        lines.append(f"vec2 w{k} = {OF_TWO[gate.operation]}(w{gate.first}, w{gate.second});")
    return "\n".join([f"{_TIES}vec2 form(vec3 p) {{", *lines, f"return w{len(names) + len(form.gates) - 1};", "}"])


def _leaf(writer: Writer, numbers: Mapping[str, int], count: int) -> Iterator[str]:
    yield "vec4 leaf(int k, vec3 p) {\nswitch (k) {"
    for k in range(count):
        lines, names = writer([numbers[name] for name in (f"{k}", *(f"{k} {i}" for i in range(3)))])
        yield f"case {k}: {{\n" + "\n".join([*lines, f"return vec4({', '.join(names)});", "}"])
    yield "}\nreturn vec4(0);\n}"


def _second(writer: Writer, numbers: Mapping[str, int], count: int) -> Iterator[str]:
    yield "void second(int k, vec3 p, out vec3 g, out vec3 a, out vec3 b) {\ng = a = b = vec3(0);\nswitch (k) {"
    for k in range(count):
        wanted = [*(f"{k} {i}" for i in range(3)), *(f"{k} {i} {j}" for i, j in PAIRS)]
        lines, names = writer([numbers[name] for name in wanted])
        stores = [f"{name} = vec3({', '.join(names[3 * i : 3 * i + 3])});" for i, name in enumerate("gab")]
        yield f"case {k}: {{\n" + "\n".join([*lines, *stores, "break;", "}"])
    yield "}\n}"
