"""The names of the package, written from what they follow from: `python tests/stubs.py` after a change.

A stub says where each name of a lazy facade stands; its `__all__` follows from its imports, and the imports of pieces
from the table of pieces. So do `rsym.primitives` and the README's table; its list of folders follows from the rooms.
"""

import ast
import re
import textwrap
from pathlib import Path

import rsym
from rsym.language.pieces import PIECES

PACKAGE = Path(rsym.__file__).parent
README = Path(__file__).resolve().parents[1] / "README.md"  # of the checkout, wherever the package is installed
STUBS = [PACKAGE / "__init__.pyi", PACKAGE / "paper/__init__.pyi", PACKAGE / "surfaces/__init__.pyi"]
FAMILIES = "| family | names |\n|---|---|\n"
PRIMITIVES = '"""The primitives by themselves; each is a name of `rsym` too."""\n\n'


def imports_of(stub):
    """The names that a stub imports, by module."""
    found = {}
    for node in ast.parse(stub).body:
        if isinstance(node, ast.ImportFrom):
            found.setdefault(node.module or "", set()).update(alias.name for alias in node.names)
    return found


def with_pieces(imports):
    """The imports of the facade, with the pieces of the table and without primitives that it does not have."""
    rooms = {home: names for home, names in imports.items() if not home.startswith("model.primitives.")}
    for piece in PIECES.values():
        if not piece.is_method:
            rooms[piece.home] = rooms.get(piece.home, set()) | {piece.name}
    return rooms


def kind_of(name):
    """Constants, then classes, then functions, as ruff has it."""
    return 0 if name.isupper() and len(name) > 1 else 1 if name[:1].isupper() else 2


def ordered(names):
    return sorted(names, key=lambda name: (kind_of(name), name))


def lines_of(imports, prefix):
    """Import statements, and the list of all that they import."""
    text = ""
    for home, names in sorted(imports.items(), key=lambda item: item[0].split(".")):
        line = f"from {prefix}{home} import {', '.join(ordered(names))}"
        text += f"{line}\n" if len(line) <= 120 else bracketed(line.split(" import ")[0], ordered(names))
    every = "".join(f'    "{name}",\n' for name in ordered(set().union(*imports.values())))
    return f"{text}\n__all__ = [\n{every}]\n"


def bracketed(opening, names):
    return f"{opening} import (\n" + "".join(f"    {name},\n" for name in names) + ")\n"


def stub_of(path):
    """What a stub is to be, from its own imports and the table."""
    imports = imports_of(path.read_text())
    return lines_of(with_pieces(imports) if path == STUBS[0] else imports, ".")


def primitives():
    return PRIMITIVES + lines_of({"": {piece.name for piece in PIECES.values() if piece.is_primitive}}, "rsym")


def readme():
    """The README with the table of the pieces."""
    families = {}
    for piece in PIECES.values():
        shown = f"`shape.{piece.name}`" if piece.is_method else f"`{piece.name}`"
        families.setdefault(piece.family, []).append(shown)
    before, head, rest = README.read_text().partition(FAMILIES)
    assert head
    rows = "".join(f"| {family} | {', '.join(names)} |\n" for family, names in families.items())
    return with_rooms(before + head + rows + rest[rest.index("\n\n") + 1 :])


def with_rooms(text):
    """The list of folders, each room with the first line of the map in its docstring, in the order of the README."""
    entry = re.compile(r"^- `rsym/(\w+)/`: .*\n(?:  .*\n)*", re.MULTILINE)
    listed = entry.findall(text)
    rooms = [name for name in listed if (PACKAGE / name / "__init__.py").exists()]
    rooms += sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py") if path.parent.name not in listed)
    start, end = entry.search(text).start(), [*entry.finditer(text)][-1].end()
    return text[:start] + "".join(map(told, rooms)) + text[end:]


def told(room):
    """What the README says of a room."""
    first = ast.get_docstring(ast.parse((PACKAGE / room / "__init__.py").read_text())).partition("\n")[0]
    line = f"- `rsym/{room}/`: {first[0].lower()}{first[1:].removesuffix('.')}"
    return "\n".join(textwrap.wrap(line, 120, subsequent_indent="  ")) + "\n"


def written():
    """Every file that follows from the table, and what it is to be."""
    return {**{path: stub_of(path) for path in STUBS}, PACKAGE / "primitives.py": primitives(), README: readme()}


if __name__ == "__main__":
    for path, text in written().items():
        if path.read_text() != text:
            path.write_text(text)
            print(f"{path.name} written")
