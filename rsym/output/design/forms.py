"""A sign form as functions of shaders: its value and active leaf, its model along a ray, derivatives of each leaf.

What depends on letters alone is computed in JavaScript, in float64, and comes to the shaders as uniforms: another
value of a letter compiles nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rsym.backends.dialects import LANGUAGES
from rsym.backends.languages import frontier, statements
from rsym.bounds.ray_forms import MODEL, NUMBER, PARTS, RayForm, RayValue, input_names, ray_form
from rsym.bounds.ray_models import RayArithmetic, RayModel
from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.program.differentiation import gradient
from rsym.program.expansion import expand
from rsym.program.program import FLOAT32, Program, constant_value, live

# Of leaves whose values differ by less than this share the first is taken: faces in common do not speckle.
TIE = 0.02
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
# By mix, not by ? and : which may become branches.
_TIES = f"""\
vec2 lesser(vec2 a, vec2 b) {{ return mix(a, b, bvec2(b.x < a.x - {TIE} * abs(a.x))); }}
vec2 larger(vec2 a, vec2 b) {{ return mix(a, b, bvec2(b.x > a.x + {TIE} * abs(a.x))); }}
"""
OF_TWO = {"min": "lesser", "max": "larger"}
POINT = ("p.x", "p.y", "p.z")


class Uniforms:
    """Places of numbers that depend on letters alone, equal ones once, and the JavaScript that fills them.

    Examples
    --------
    >>> from rsym.program.program import Node
    >>> nodes = (Node("input", (), "x"), Node("input", (), "a"), Node("neg", (1,)), Node("mul", (0, 2)))
    >>> uniforms = Uniforms(("a",))
    >>> uniforms.places(Program(nodes, ("x",), ("a",), (("value", 3),)))
    {2: 'u[0].x'}
    >>> print(uniforms.script)
    {count: 1, of: (letters, u) => {
    const u0=letters[0],u1=-u0;
    u[0]=u1;
    }}
    """

    def __init__(self, letters: tuple[str, ...]) -> None:
        self._builder = Builder((), letters)
        self._slots: dict[int, int] = {}

    def places(self, program: Program, first: Sequence[int] = ()) -> dict[int, str]:
        """Where a shader finds the nodes of an expanded program that are the same for all points.

        Those that the nodes `first` need come first: shaders that need no others declare no more.
        """
        early = {argument for number in live(program.nodes, first) for argument in program.nodes[number].arguments}
        numbers = sorted(frontier(program), key=lambda number: number not in early)
        copies: dict[int, int] = {}
        for number in live(program.nodes, numbers):
            operation, arguments, data = program.nodes[number]
            copies[number] = self._builder.make(operation, *(copies[one] for one in arguments), data=data)
        slots = {number: self._slots.setdefault(copies[number], len(self._slots)) for number in numbers}
        return {number: f"u[{slot // 4}].{'xyzw'[slot % 4]}" for number, slot in slots.items()}

    @property
    def declaration(self) -> str:
        """What a shader says of them."""
        return f"uniform vec4 u[{max(1, -(-len(self._slots) // 4))}];\n"

    @property
    def script(self) -> str:
        """A function of JavaScript that fills an array."""
        program = self._builder.program({str(slot): number for number, slot in self._slots.items()})
        part = statements(program, "javascript")
        stores = "".join(f"u[{slot}]={part.names[number]};" for slot, number in program.outputs)
        return f"{{count: {len(self._slots)}, of: (letters, u) => {{\n{dense(part.uniform)}\n{stores}\n}}}}"


def outputs_alone(program: Program, numbers: Sequence[int]) -> Program:
    """The program with other nodes as outputs; nodes keep their numbers."""
    return replace(program, outputs=tuple((str(number), number) for number in numbers))


def dense(lines: Sequence[str]) -> str:
    r"""Statements that declare names, of one kind, as one declaration without blanks: a page is mostly these.

    Examples
    --------
    >>> dense(["float a = p.x;", "float b = -a;", "vec2 w = vec2(a, b);"])
    'float a=p.x,b=-a;\nvec2 w=vec2(a,b);'
    """
    kinds: list[tuple[str, list[str]]] = []
    for line in lines:
        kind, _, rest = line.removesuffix(";").partition(" ")
        if not kinds or kinds[-1][0] != kind:
            kinds.append((kind, []))
        kinds[-1][1].append(rest.replace(" ", ""))
    return "\n".join(f"{kind} {','.join(texts)};" for kind, texts in kinds)


@dataclass(frozen=True)
class FormTexts:
    """The functions of a form in GLSL.

    Attributes
    ----------
    point, model, leaf, second : str
        ``vec2 form(vec3)``, the value and the active leaf; ``vec4 model(vec4, vec4, vec4)``, what it can be along a
        ray, and ``float highest(vec4)``; ``vec4 leaf(int, vec3)``, value and gradient of a leaf;
        ``void second(int, vec3, ...)``, gradient and Hessian.
    uniforms : Uniforms
        What the functions read.
    """

    point: str
    model: str
    leaf: str
    second: str
    uniforms: Uniforms


def operations_of(form: SignForm) -> int:
    """How many operations the value of a form takes at a point.

    Examples
    --------
    >>> import rsym
    >>> from rsym.logic.sign_form import shape_form
    >>> operations_of(shape_form(rsym.sphere(1)))
    9
    """
    program = expand(form.builder.program({str(k): leaf for k, leaf in enumerate(form.leaves)}))
    varying = zip(program.nodes, program.uniform, strict=True)
    return len(form.gates) + sum(1 for node, uniform in varying if not uniform and node.operation != "input")


def form_texts(form: SignForm) -> FormTexts:
    """The functions of the sign form of a shape in space."""
    builder, uniforms = form.builder, Uniforms(form.builder.letters)
    model = "\n".join(_model(ray_form(form, FLOAT32, lines=True), uniforms))
    outputs: dict[str, int] = {}
    for k, leaf in enumerate(form.leaves):
        slopes = gradient(builder, leaf)
        outputs[f"{k}"] = leaf
        outputs.update({f"{k} {i}": slope for i, slope in enumerate(slopes)})
        seconds = [gradient(builder, slope) for slope in slopes]
        outputs.update({f"{k} {i} {j}": seconds[i][j] for i, j in PAIRS})
    program = expand(builder.program(outputs))
    numbers, count = dict(program.outputs), len(form.leaves)
    first = [number for name, number in program.outputs if name.count(" ") < 2]
    writer = Writer(program, uniforms.places(program, first), dict(zip(builder.coordinates, POINT, strict=True)))
    return FormTexts(
        _TIES + "\n".join(_point(form, writer, [numbers[f"{k}"] for k in range(count)])),
        model,
        "\n".join(_leaf(writer, numbers, count)),
        "\n".join(_second(writer, numbers, count)),
        uniforms,
    )


class Writer:
    """Writes parts of one program in GLSL."""

    def __init__(self, program: Program, known: Mapping[int, str], inputs: Mapping[str, str]) -> None:
        self._program, self._known, self._inputs = program, known, inputs

    def __call__(self, numbers: Sequence[int]) -> tuple[list[str], list[str]]:
        """The statements of nodes, and the names of the nodes."""
        part = statements(outputs_alone(self._program, numbers), "glsl", inputs=self._inputs, known=self._known)
        return [*part.uniform, *part.varying], [part.names[number] for number in numbers]


def _point(form: SignForm, writer: Writer, leaves: Sequence[int]) -> Iterator[str]:
    lines, names = writer(leaves)
    lines += [f"vec2 w{k} = vec2({name}, {k});" for k, name in enumerate(names)]
    for k, gate in enumerate(form.gates, len(names)):
        lines.append(f"vec2 w{k} = {OF_TWO[gate.operation]}(w{gate.first}, w{gate.second});")
    yield "vec2 form(vec3 p) {"
    yield dense(lines)
    yield f"return w{len(names) + len(form.gates) - 1};\n}}"


def _leaf(writer: Writer, numbers: Mapping[str, int], count: int) -> Iterator[str]:
    yield "vec4 leaf(int k, vec3 p) {\nswitch (k) {"
    for k in range(count):
        lines, names = writer([numbers[name] for name in (f"{k}", *(f"{k} {i}" for i in range(3)))])
        yield f"case {k}: {{\n" + "\n".join([dense(lines), f"return vec4({','.join(names)});", "}"])
    yield "}\nreturn vec4(0);\n}"


def _second(writer: Writer, numbers: Mapping[str, int], count: int) -> Iterator[str]:
    yield "void second(int k, vec3 p, out vec3 g, out vec3 a, out vec3 b) {\ng = a = b = vec3(0);\nswitch (k) {"
    for k in range(count):
        wanted = [*(f"{k} {i}" for i in range(3)), *(f"{k} {i} {j}" for i, j in PAIRS)]
        lines, names = writer([numbers[name] for name in wanted])
        stores = [f"{name} = vec3({','.join(names[3 * i : 3 * i + 3])});" for i, name in enumerate("gab")]
        yield f"case {k}: {{\n" + "\n".join([dense(lines), *stores, "break;", "}"])
    yield "}\n}"


def _model(form: RayForm, uniforms: Uniforms) -> Iterator[str]:
    """The library, and the calls of the form."""
    for function in form.library.values():
        parameters = ", ".join(
            f"{'float' if kind == NUMBER else 'vec4'} {'abcdefgh'[k]}" for k, kind in enumerate(function.parameters)
        )
        yield from _function(f"vec4 ray_{function.name}({parameters})", function.program, _inputs(function.parameters))
    yield from _function("float highest(vec4 a)", _highest(), _inputs((MODEL,)))
    places = uniforms.places(form.uniforms)
    nodes, literal = form.uniforms.nodes, LANGUAGES["glsl"].literal
    written = [places.get(number) or literal(constant_value(nodes[number].data)) for _, number in form.uniforms.outputs]
    size = len(form.coordinates)

    def word(value: RayValue, kind: str = MODEL) -> str:
        if value.kind == MODEL:
            return f"{'XYZ'[value.number]}" if value.number < size else f"v{value.number}"
        number = written[value.number]
        return number if kind == NUMBER else f"vec4({number}, {number}, 0, 0)"

    lines = []
    for k, (name, arguments) in enumerate(form.calls, size):
        kinds = form.library[name].parameters
        words = ", ".join(word(*pair) for pair in zip(arguments, kinds, strict=True))
        lines.append(f"vec4 v{k} = ray_{name}({words});")
    names = [word(leaf) for leaf in form.leaves]
    for gate in form.gates:
        names.append(f"w{len(names)}")
        lines.append(f"vec4 {names[-1]} = ray_{gate.operation}({names[gate.first]}, {names[gate.second]});")
    yield "vec4 model(vec4 X, vec4 Y, vec4 Z) {"
    yield dense(lines)
    yield f"return {names[-1]};\n}}"


def _inputs(kinds: Sequence[str]) -> dict[str, str]:
    """Texts of the inputs of an image function: the parts of a model are those of a vec4."""
    texts: dict[str, str] = {}
    for k, kind in enumerate(kinds):
        letter, names = "abcdefgh"[k], input_names(k, kind)
        texts.update(zip(names, [letter] if kind == NUMBER else [f"{letter}.{part}" for part in "xyzw"], strict=False))
    return texts


def _function(head: str, program: Program, inputs: Mapping[str, str]) -> Iterator[str]:
    lines, names = Writer(program, {}, inputs)([number for _, number in program.outputs])
    yield f"{head} {{"
    yield dense(lines)
    whole = ",".join(names)
    yield f"return {whole if len(names) == 1 else f'vec4({whole})'};\n}}"


def _highest() -> Program:
    """The greatest value of a model on its segment."""
    builder = Builder(input_names(0, MODEL), ())
    model = RayModel(*(builder.input(f"a_{part}") for part in PARTS))
    return expand(builder.program({"high": RayArithmetic(builder, FLOAT32).range(model).high}))
