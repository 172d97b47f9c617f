"""The figure of growth: laws against exact ones, and the stored file has what is drawn."""

import json
from pathlib import Path

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.paper import growth

ROWS = growth.stored()["rows"]


@pytest.mark.parametrize("exponent", [-0.5, 0.0, 0.3, 1.0, 2.5])
def test_an_exact_power_law_is_found(exponent):
    sizes = [1.0, 3.0, 10.0, 400.0]
    law = growth.power_law(sizes, [0.02 * size**exponent for size in sizes])
    assert_close(law.exponent, exponent, atol=1e-12)
    assert_close(law.factor, 0.02, atol=1e-12)
    assert_close(law.at(50.0), 0.02 * 50.0**exponent, atol=1e-10)


def test_the_law_is_the_nearest_in_the_logarithms():
    sizes, values = [2, 5, 11, 90], [1.0, 7.0, 3.0, 40.0]
    law = growth.power_law(sizes, values)
    exponent, factor = np.polyfit(np.log(sizes), np.log(values), 1)
    assert_close([law.exponent, np.log(law.factor)], [exponent, factor], atol=1e-12)


@pytest.mark.parametrize(("sizes", "values"), [([4], [1]), ([4, 4], [1, 2]), ([1, 2], [0, 1]), ([1, 2], [np.nan, 1])])
def test_no_law_of_one_size_or_of_nothing(sizes, values):
    with pytest.raises(RsymError) as caught:
        growth.power_law(sizes, values)
    assert caught.value.code == "power-law"


@pytest.mark.parametrize(("work", "first"), [("balls", 4e3), ("cells", 2e4)])
def test_only_the_larger_sizes_make_the_law(work, first):
    """What is always there hides the law of small ones; from a thirtieth on, of cells an eighth, it is n**2."""
    sizes = (1.0, 10.0, 3e3, 4e3, 1.2e4, 2e4, 1e5)
    line = growth.Series(work, "tape", sizes, tuple(7.0 if size < first else size**2 for size in sizes))
    assert_close(line.law.exponent, 2.0, atol=1e-12)
    assert line.fitted[0] == sizes[sizes.index(first) :]


def test_a_series_is_of_one_work_and_one_way_in_the_order_of_sizes():
    rows = [
        {"work": "balls", "backend": "tape", "size": 10, "leaves": 10, "mesh": 4.0, "triangles": 8},
        {"work": "balls", "backend": "llvm", "size": 10, "leaves": 10, "mesh": 9.0, "triangles": 8},
        {"work": "balls", "backend": "tape", "size": 1, "leaves": 1, "mesh": 1.0, "triangles": 4},
        {"work": "balls", "backend": "tape", "size": 0, "leaves": 1, "mesh": 0.0, "triangles": 4},
    ]
    assert growth.series(rows, "balls", "tape", "mesh") == growth.Series("balls", "tape", (1.0, 10.0), (1.0, 4.0))
    assert growth.series(rows, "balls", "tape", "mesh/triangles").values == (0.25, 0.5)


def test_the_stored_file_has_what_the_figure_needs():
    assert set(growth.stored()["about"]) == {"python", "numpy", "numba", "llvmlite", "sympy", "cores"}
    sizes = {}
    for row in ROWS:
        assert {"work", "size", "backend", "made", "mesh", "bytes", "triangles"} <= set(row), row
        assert ("build" in row and "leaves" in row) or row["backend"] == "lattice"
        assert row["mesh"] > 0
        assert row["bytes"] > 0
        sizes.setdefault((row["work"], row["backend"]), []).append(row["size"])
    assert {1, 10, 100, 1000, 3000, 10000} <= set(sizes["balls", "tape"])
    assert {1, 10, 100, 300} <= set(sizes["balls", "llvm"])
    assert {64, 128, 256, 512, 1024, 2048} <= set(sizes["cells", "tape"]) & set(sizes["cells", "llvm"])
    assert {1, 10, 100, 300} <= set(sizes["letters", "tape"])
    for work in ("gyroids", "text"):
        assert len(sizes[work, "tape"]) >= 4
        assert len(sizes[work, "llvm"]) >= 3
    assert max(row.get("operations", 0) for row in ROWS) >= 3000


def test_the_ways_made_the_same_meshes():
    """Regions and what is compiled have the same triangles: nothing was measured that is not the same work."""
    counts = {}
    for row in ROWS:
        if row["backend"] != "lattice":
            counts.setdefault((row["work"], row["size"]), set()).add(row["triangles"])
    assert all(len(found) == 1 for (work, _), found in counts.items() if work != "letters")


def test_the_file_is_small_and_comes_with_the_package():
    path = Path(rsym.__file__).parent / "paper" / growth.STORED
    assert path.stat().st_size < 50_000
    assert json.loads(path.read_text(encoding="utf-8")) == growth.stored()


def test_six_panels_with_their_laws(monkeypatch):
    """The exponents of the legends are those that NumPy finds in the rows."""
    drawing = growth.draw_growth()
    panels = drawing.figure.axes
    assert len(panels) == 6
    for ax in panels:
        assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
        assert ax.get_xlabel()
        assert ax.get_ylabel() in ("seconds", "megabytes")
    found = [(row["leaves"], row["build"]) for row in ROWS if (row["work"], row["backend"]) == ("balls", "tape")]
    exponent = np.polyfit(*np.log([one for one in found if 30 * one[0] >= 10000]).T, 1)[0]
    labels = [text.get_text() for text in panels[0].get_legend().get_texts()]
    assert labels[0] == rf"balls $\propto n^{{{exponent:.2f}}}$"
    assert len(labels) == 6
    assert all(len(row) == len(drawing.table.header) for row in drawing.table.rows)
    assert "Measured once" in drawing.remark
