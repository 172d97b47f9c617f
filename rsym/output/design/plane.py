"""A shape in the plane as the texts of a page: its fields as shaders, omega and its curvature in JavaScript."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np

from rsym.backends.languages import statements
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Shape
from rsym.output.design.forms import Uniforms, dense, outputs_alone
from rsym.output.looks import PLAIN
from rsym.program.builder import Builder
from rsym.program.calculus import Calculus
from rsym.program.expansion import expand
from rsym.program.fields import SIX, fields_program
from rsym.program.lowering import lower
from rsym.program.program import Program
from rsym.sampling.plane import plane_sampler

CELLS = 96  # of the samples that choose levels
MOST_LEVELS = 24  # a picture has some fifteen
FIELDS = SIX
TITLES = (
    "\u03c9",
    "\u03c9\u2099",
    "(\u2207\u03c9)\u00b2",
    "(\u2207\u03c9\u2099)\u00b2",
    "\u0394\u03c9",
    "\u0394\u03c9\u2099",
)


@dataclass(frozen=True)
class PlaneTexts:
    """The fields of a plane shape as GLSL, and the formulas of its page as JavaScript."""

    shaders: tuple[str, ...]
    script: str


def plane_texts(shape: Shape, form: SignForm) -> PlaneTexts:
    """The texts of the page of a shape in the plane."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))
    calculus = Calculus(builder, lower(builder, shape.expression))
    shaders, uploads = [], []
    for field in FIELDS:
        uniforms = Uniforms(builder.letters)
        program = expand(fields_program(calculus, tuple(dict.fromkeys((field, "value")))))
        text = [_function("field", program, program.outputs[0][1], uniforms)]
        # Where a part of omega has no value the form has that of the others, and ends where these leave it open.
        program = _form_program(form) if form.walls else program
        text.append(_function("value", program, program.outputs[-1][1], uniforms))
        shaders.append(uniforms.declaration + "\n".join(text))
        uploads.append(uniforms.script)
    curve = expand(fields_program(calculus, ("value", "gradient", "curvature")))
    leaves = expand(form.builder.program({str(k): leaf for k, leaf in enumerate(form.leaves)}))
    script = ",\n".join(
        [
            f"fields: [{', '.join(uploads)}]",
            f"curve: {_closure(curve, [f'out[{k}] = {{}};' for k in range(4)], 'out')}",
            f"leaves: {_closure(leaves, *_active(form))}",
        ]
    )
    return PlaneTexts(tuple(shaders), f"{{{script}}}")


def _form_program(form: SignForm) -> Program:
    """The value of a form, of the leaves that its gates choose."""
    return expand(form.builder.program({"value": form.value}))


def _function(name: str, program: Program, number: int, uniforms: Uniforms) -> str:
    inputs = dict(zip(program.coordinates, ("p.x", "p.y"), strict=True))
    part = statements(outputs_alone(program, [number]), "glsl", inputs=inputs, known=uniforms.places(program))
    return "\n".join(
        [
            f"float {name}(vec2 p) {{",
            dense([*part.uniform, *part.varying]),
            f"return {part.names[number]};",
            "}",
        ]
    )


def _closure(program: Program, stores: list[str], *more: str) -> str:
    """A function of letters that gives one of a point."""
    part = statements(program, "javascript", inputs=dict(zip(program.coordinates, ("x", "y"), strict=True)))
    values = [part.names[number] for _, number in program.outputs]
    body = [dense(part.varying), *(store.format(value) for store, value in zip(stores, values, strict=True))]
    parameters = ", ".join(["x", "y", *(name for name in more if name.isidentifier())])
    ends = [text for text in more if not text.isidentifier()]
    return "\n".join(["letters => {", dense(part.uniform), f"return ({parameters}) => {{", *body, *ends, "}; }"])


def _active(form: SignForm) -> tuple[list[str], str]:
    """What stores the leaves, and what finds the one that decides."""
    count = len(form.leaves)
    stores = [f"const w{k} = [{{}}, {k}];" for k in range(count)]
    lines = []
    for k, gate in enumerate(form.gates, count):
        a, b = f"w{gate.first}", f"w{gate.second}"
        lines.append(f"const w{k} = {a}[0] {'<' if gate.operation == 'min' else '>'} {b}[0] ? {a} : {b};")
    return stores, "\n".join([*lines, f"return w{count + len(form.gates) - 1}[1];"])


def plane_looks(shape: Shape, bounds: Any) -> list[dict[str, Any]]:
    """The title, levels and colours of each field, those of `plot_field` at the letters of the shape."""
    looks = []
    inside = plane_sampler(shape, "value", resolution=CELLS, bounds=bounds).values() > 0
    for field, title in zip(FIELDS, TITLES, strict=True):
        values = plane_sampler(shape, field, resolution=CELLS, bounds=bounds).values()
        levels = PLAIN.levels_of(values, field, inside)[: MOST_LEVELS - 1]
        name, scale = PLAIN.colours(levels)
        middles = np.concatenate([levels[:1], (levels[1:] + levels[:-1]) / 2, levels[-1:]])
        colours = matplotlib.colormaps[name](scale(middles))[:, :3]
        looks.append(
            {"name": field, "title": title, "levels": levels.tolist(), "colours": np.round(colours, 4).tolist()}
        )
    return looks
