"""The page of a reproduction: pictures, equations, tables and readings in the order of the source."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from dataclasses import fields

from rsym.language.listing import definitions
from rsym.output.equations import equation
from rsym.paper.drawing import Reproduced, Table
from rsym.paper.models import model_path
from rsym.paper.readings import READINGS, Reading

# What stood between Figs 2 and 5, on a page that the source lost.
LOST = (
    ("fig03", "Fig. 3", "Lost with its page, caption and all; the text that is left does not speak of it."),
    (
        "fig04",
        "Fig. 4: Appearance of the car that is designed",
        "Lost: only the caption is left.",
    ),
)
AFTER = "fig02"
NOTATION = (
    r"f \wedge_0 g = f + g - \sqrt{f^{2} + g^{2}}",
    r"f \vee_0 g = f + g + \sqrt{f^{2} + g^{2}}",
    r"\rho\left(f;\, t\right) = \sqrt{f^{2} + \left(\frac{\sqrt{f^{4} + t^{2}} - t}{2}\right)^{2}}",
)
READINGS_AFTER = "table1"


def page(results: Sequence[Reproduced], *, whole: bool = False) -> str:
    """The HTML page; `whole` adds what is lost, each thing in its place."""
    sections = list(_sections(results, whole))
    contents = "\n".join(f'<li><a href="#{name}">{title}</a></li>' for name, title, _ in sections)
    bodies = "\n".join(f'<section id="{name}"><h2>{title}</h2>\n{body}\n</section>' for name, title, body in sections)
    notation = "".join(map(equation, NOTATION))
    return _PAGE.format(contents=contents, notation=notation, sections=bodies)


def _sections(results: Sequence[Reproduced], whole: bool) -> Iterator[tuple[str, str, str]]:
    """Name, title and body of each section; a definition is shown where it comes up first."""
    shown: set[tuple[str, str]] = set()
    for result in results:
        yield result.name, html.escape(_title(result)), _section(result, shown)
        if whole and result.name == AFTER:
            yield from ((name, html.escape(title), f"<p>{html.escape(text)}</p>") for name, title, text in LOST)
        if whole and result.name == READINGS_AFTER:
            yield "readings", "Readings", _readings()


def _title(result: Reproduced) -> str:
    for kind, word in (("fig", "Fig. "), ("table", "Table ")):
        if result.name.startswith(kind):
            return f"{word}{result.name.removeprefix(kind).lstrip('0')}: {result.title}"
    return result.title


def _section(result: Reproduced, shown: set[tuple[str, str]]) -> str:
    name, title = html.escape(result.name), html.escape(result.title)
    parts = [
        f'<a href="{name}.png"><img src="{name}.png" alt="{title}"></a>',
        _equations(result, shown),
        _table(result.table) if result.table else "",
        _facts(result),
        _listing(result, shown),
    ]
    return "\n".join(part for part in parts if part)


def _facts(result: Reproduced) -> str:
    triangles = f"{result.triangles:,}".replace(",", " ") if result.triangles else "none: a plane picture"
    rows = [
        ("letters", html.escape(result.letters)),
        ("triangles", triangles),
        ("seconds", f"{result.seconds:.1f}"),
        ("seconds in the source", html.escape(result.published) or "not given"),
        ("remark", html.escape(result.remark)),
        ("files", ", ".join(f'<a href="{html.escape(name)}">{html.escape(name)}</a>' for name in result.files)),
    ]
    lines = "".join(f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in rows if text)
    return f'<table class="facts">{lines}</table>'


def _equations(result: Reproduced, shown: set[tuple[str, str]]) -> str:
    lines = list(result.equations)
    if result.model is not None:
        model, shape = result.model
        named = definitions(model_path(model), shape=shape)
        lines = [one.latex for one in named if (model, one.name) not in shown] + lines
        shown.update((model, one.name) for one in named)
    return f'<div class="equations">{"".join(f"<div>{equation(line)}</div>" for line in lines)}</div>' if lines else ""


def _listing(result: Reproduced, shown: set[tuple[str, str]]) -> str:
    """The whole model file, folded, where the model comes up first."""
    if result.model is None or (result.model[0], "") in shown:
        return ""
    model = result.model[0]
    shown.add((model, ""))
    text = html.escape(model_path(model).read_text(encoding="utf-8"))
    return f"<details><summary>the model file {model}.rf</summary><pre>{text}</pre></details>"


def _table(table: Table) -> str:
    head = "".join(f"<th>{html.escape(text)}</th>" for text in table.header)
    rows = "\n".join("<tr>" + "".join(f"<td>{html.escape(text)}</td>" for text in row) + "</tr>" for row in table.rows)
    return f'<table class="data"><thead><tr>{head}</tr></thead>\n<tbody>{rows}</tbody></table>'


def _readings() -> str:
    """Doubtful and lost places of the source, one row each."""
    names = [part.name for part in fields(Reading)]
    titles = {"used": "used in", "other": "the other reading"}
    rows = tuple(tuple(getattr(reading, name) for name in names) for reading in READINGS)
    table = _table(Table(tuple(titles.get(name, name) for name in names), rows))
    return f"<p>Every place where the source is doubtful or lost, and how it is read here.</p>\n{table}"


_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Car surfaces by R-functions, reproduced</title>
<style>
body {{ font: 16px/1.5 Georgia, "Times New Roman", serif; color: #222; }}
body {{ max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }}
section {{ border-top: 1px solid #ccc; padding: 1rem 0; }}
h1, h2 {{ line-height: 1.25; font-weight: 600; }}
a {{ color: #24598f; }}
img {{ display: block; max-width: 100%; max-height: 52rem; margin: 0 auto 1rem; }}
nav ul {{ columns: 2 20rem; padding-left: 1.2rem; }}
.equations {{ columns: 2 26rem; column-gap: 2rem; margin: 1rem 0; }}
.equations div {{ break-inside: avoid; padding: 0.25rem 0; }}
.equations svg, .notation svg {{ max-width: 100%; height: auto; vertical-align: middle; }}
.notation svg {{ margin: 0.3rem 2rem 0.3rem 0; }}
table {{ border-collapse: collapse; font-size: 0.85rem; margin: 1rem 0; }}
th, td {{ text-align: left; vertical-align: top; padding: 0.2rem 1rem 0.2rem 0; }}
.facts th {{ white-space: nowrap; font-weight: 600; }}
.data th {{ border-bottom: 1px solid #888; font-weight: 600; }}
.data td {{ border-bottom: 1px solid #e4e4e4; }}
pre {{ font-size: 0.78rem; line-height: 1.4; overflow-x: auto; background: #f6f6f4; padding: 0.8rem; }}
summary {{ cursor: pointer; color: #24598f; font-size: 0.9rem; }}
@media print {{ nav, details {{ display: none; }} section {{ break-inside: avoid-page; }} }}
</style></head><body>
<h1>Car surfaces by R-functions, reproduced</h1>
<p>The figures of D. A. Lisin, K. V. Maksimenko-Sheiko and T. I. Sheiko, <em>Mathematical modelling of car surfaces
by R-functions</em> (2013), made again from their equations. Part of the source is lost: where an equation or a
figure was restored, replaced by one of our own, or could not be, the remark under the figure says so, and the
table of readings gives the reasons. From the paraboloid on the figures are those of parametric surfaces, the subject of
the other documents rsym builds on: Coons patches in matrix form, surfaces through curves and networks (N. Golovanov),
B-splines through data (D. F. Rogers, J. A. Adams), patches with shape parameters. Seconds cover
model, mesh and picture; those of the source were measured on a
computer of 2013.</p>
<nav><ul>
{contents}
</ul></nav>
<p class="notation">A shape is a function that is positive inside, zero on the boundary and negative outside.
Shapes are joined by the R-operations of system R<sub>0</sub>, and a line is cut to a segment by trimming:<br>
{notation}</p>
{sections}
</body></html>
"""
