"""What `rsym/HOWTO.md` tells to do is done in a copy of the package, and works from end to end."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rsym
from rsym.backends.caches import cache_folder

PACKAGE = Path(rsym.__file__).parent
ROOT = Path(__file__).parents[2]
HOWTO = (PACKAGE / "HOWTO.md").read_text()
SECTIONS = {
    part.partition("\n")[0]: re.findall(r"```python\n(.*?)```", part, re.DOTALL) for part in HOWTO.split("\n## ")[1:]
}
# What is seen in the copy, said on a line of JSON each.
SEEN = {
    "A format of mesh files": """
from rsym import x, y, z
ball = rsym.mesh(rsym.sphere(1), 8)
path = rsym.write(ball, folder + "/ball.xyz")
say(len(path.read_text().splitlines()) == len(ball.vertices), ".xyz" in rsym.write.__doc__)
say(".xyz" in help_of("mesh"), main(["mesh", "gear", "-o", folder + "/gear.xyz", "--resolution", "16"]) == 0)
""",
    "A map of curvature that surfaces are coloured by": """
from matplotlib.figure import Figure
ax = Figure().add_subplot(projection="3d")
body = rsym.sphere(2)
artist = rsym.plot_mesh(rsym.mesh(body, 8), ax=ax, colour_by="curvedness", shape=body)
low, high = artist.scale.get_clim()
say(low < 0.5 < high, "``curvedness``" in rsym.plot_mesh.__doc__, "``curvedness``" in rsym.plot_patches.__doc__)
rsym.plot_patches(rsym.surfaces.sphere(2), ax=ax, colour_by="curvedness", resolution=8)
""",
    "A scalar field": """
disc = rsym.disc(2)
found = rsym.compile(disc, ("slope", "normalised_slope", "normalised_gradient_squared"))(1.0, 0.0)
say(found["slope"] == 0.5, abs(found["normalised_slope"] ** 2 - found["normalised_gradient_squared"]) < 1e-12)
say("normalised_slope" in rsym.compile.__doc__)
from matplotlib.figure import Figure
say(rsym.plot_field(disc, "slope", ax=Figure().subplots()).axes.get_title() == r"$|\\nabla\\omega|$")
say(len(rsym.level_lines(disc, 0.5, field="slope")) == 1)
""",
    "A command": """
say("area        print the area" in help_of(), "rsym area gear" in help_of("area"))
say(main(["area", "gear", "--resolution", "16", "--quiet"]) == 0)
""",
    "A primitive": """
made = rsym.loads("omega = rfOR(diamond(2), disc(1))")
say(made.contains(1.5, 0), not made.contains(1.5, 1.5), rsym.diamond(2).contains(1.5, 0))
say("diamond" in rsym.primitives.__all__, "diamond" in rsym.__all__, rsym.loads(rsym.dumps(made)) == made)
""",
}
BEGIN = """
import contextlib, io, json, sys
import rsym
from rsym.cli import main
folder = sys.argv[1]
def say(*answers):
    print("SEEN", json.dumps([bool(answer) for answer in answers]))
def help_of(*command):
    with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.suppress(SystemExit):
        main([*command, "--help"])
    return text.getvalue()
"""


def carried_out(block, root):
    """Put a piece of code where its first line says."""
    head, _, code = block.partition("\n")
    name, _, place = head.removeprefix("# ").partition(", ")
    path = root / name
    if not place:
        assert not path.exists()
        path.write_text(code)
        return
    side, _, line = place.partition(": ")
    lines = path.read_text().splitlines(keepends=True)
    (number,) = [number for number, one in enumerate(lines) if one.strip().startswith(line)]
    lines.insert(number + {"above": 0, "below": 1}[side], code)
    path.write_text("".join(lines))


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The package with all that is told, the stub and the README written anew."""
    root = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, root / "rsym", ignore=shutil.ignore_patterns("__pycache__"))
    (root / "tests").mkdir()
    shutil.copy(ROOT / "tests/stubs.py", root / "tests")
    shutil.copy(ROOT / "README.md", root)
    for blocks in SECTIONS.values():
        for block in blocks:
            carried_out(block, root)
    run(root, "tests/stubs.py")
    return root


def run(root, *arguments):
    # Loops are kept by what they are made of: those of the package itself serve its copy, and save half a minute.
    kept = {"XDG_CACHE_HOME": str(cache_folder("loops").parents[1])}
    environment = {"PYTHONPATH": str(root), "MPLBACKEND": "Agg", "PATH": "", "HOME": str(root), **kept}
    done = subprocess.run([sys.executable, *arguments], cwd=root, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("section", SEEN)
def test_what_is_told_works(section, copy, tmp_path):
    assert SECTIONS[section]
    seen = re.findall(r"SEEN (.*)", run(copy, "-c", BEGIN + SEEN[section], str(tmp_path)))
    answers = [json.loads(line) for line in seen]
    assert answers
    assert all(map(all, answers)), answers


def test_every_section_with_code_is_tried_and_all_are_short():
    assert set(SEEN) == {section for section, blocks in SECTIONS.items() if blocks}
    for part in HOWTO.split("\n## ")[1:]:
        assert len(re.sub(r"```python.*?```", "", part, flags=re.DOTALL).strip().splitlines()) <= 10


def test_a_place_that_is_not_there_is_seen(tmp_path):
    """Red proof."""
    (tmp_path / "page.py").write_text("a = 1\n")
    with pytest.raises(ValueError, match="not enough values"):
        carried_out("# page.py, below: b = 1\nc = 2\n", tmp_path)
