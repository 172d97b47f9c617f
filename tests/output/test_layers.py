"""Level lines and outlines in files of lines, read back and held against curves that are known."""

import xml.etree.ElementTree as ET

import ezdxf
import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x

SVG = "{http://www.w3.org/2000/svg}"
U = rsym.solve(rsym.disc(1), "-laplacian(u) = 4", 0, cells=8)  # 1 - r^2
PLATE = rsym.rectangle(3, 2) - rsym.disc(0.5)


def lines_of(path):
    """The points of the lines of a DXF file by the names of their layers."""
    drawing = ezdxf.readfile(path)
    assert not drawing.audit().errors
    found = {}
    for line in drawing.query("POLYLINE"):
        points = np.array([tuple(vertex.dxf.location)[:2] for vertex in line.vertices])
        found.setdefault(line.dxf.layer, []).append((points, line.is_closed))
    return found


def test_level_lines_of_a_solution_are_circles(tmp_path):
    found = lines_of(rsym.write(U, tmp_path / "u.dxf", levels=[0.36, 0.75], size="10cm", unit="mm", resolution=64))
    assert {name: len(lines) for name, lines in found.items()} == {"OUTLINE": 1, "U_0P36": 1, "U_0P75": 1}
    for name, radius in (("OUTLINE", 1), ("U_0P36", 0.8), ("U_0P75", 0.5)):
        ((points, closed),) = found[name]
        assert closed
        assert_close(np.hypot(*points.T), np.full(len(points), 50 * radius), rtol=1e-3 if name == "OUTLINE" else 1.1e-3)
        assert np.ptp(np.hypot(*points.T)) < 1e-6


def test_lines_end_with_the_shape(tmp_path):
    slope = rsym.solve(PLATE, "laplacian(u) = 0", x, cells=12)
    ((points, closed),) = lines_of(rsym.write(slope, tmp_path / "u.dxf", levels=1, resolution=60))["U_1"]
    assert not closed
    assert_close(points[:, 0], np.ones(len(points)), rtol=1e-9)
    assert 1.9 < np.ptp(points[:, 1]) <= 2


def test_an_outline_has_its_corners_and_its_length(tmp_path):
    root = ET.parse(rsym.write(PLATE, tmp_path / "plate.svg", unit="cm", resolution=50)).getroot()
    assert (root.get("width"), root.get("height")) == ("3cm", "2cm")
    (outline,) = root.find(f"{SVG}g").findall(f"{SVG}g")
    texts = [path.get("d") for path in outline.findall(f"{SVG}path")]
    assert all(text.endswith(" Z") for text in texts)
    (corner,) = [text for text in texts if "1.5 1 " in text]
    assert "-1.5 -1 " in corner


def test_round_levels_are_chosen_and_missed_ones_told(tmp_path):
    root = ET.parse(rsym.write(U, tmp_path / "u.svg", resolution=48)).getroot()
    names = [group.get("id") for group in root.find(f"{SVG}g")]
    levels = [float(name.removeprefix("u=")) for name in names[1:]]
    assert names[0] == "outline"
    assert len(levels) > 8
    assert 0 < min(levels) < max(levels) < 1
    with pytest.warns(rsym.RsymWarning, match="u has no lines at 2; remedy"):
        rsym.write(U, tmp_path / "u.svg", levels=[0.5, 2], resolution=32)


@pytest.mark.parametrize(
    ("given", "name", "options", "words"),
    [
        (rsym.sphere(1), "a.svg", {}, r"in space; remedy: rsym\.write_sections"),
        (U, "a.dxf", {"colour_by": "part"}, "got colour_by"),
        (U, "a.dxf", {"unit": "ell"}, "units"),
        (U, "a.dxf", {"levels": "high"}, "level"),
        (PLATE, "a.html", {"levels": [0.1]}, "no options, got levels"),
        (rsym.rectangle(1, 1, (9, 0)).replace(bounds=((-1, 1), (-1, 1))), "a.svg", {}, "no outline"),
    ],
)
def test_refusals_leave_no_file(given, name, options, words, tmp_path):
    with pytest.raises(RsymError, match=words):
        rsym.write(given, tmp_path / name, **options)
    assert not list(tmp_path.iterdir())
