"""R-systems side by side: classes, orders, sizes and slopes whose values are known by construction."""

import json
import math

import pytest
from oracles.closeness import assert_close

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, RsymError, Shape, x, y
from rsym.cli import main


def square():
    """Four half-planes, each an exact distance; lower and right sides meet in a conjunction."""
    sides = [Shape(side, (x, y), bounds=((-2, 2), (-2, 2))) for side in (1 - x, 1 + x, 1 - y, 1 + y)]
    return sides[0] & sides[1] & sides[2] & sides[3]


@pytest.fixture(scope="module")
def table():
    return rsym.compare_systems(square(), systems=(R0, R1, Rp(4), R0m(2)))


@pytest.mark.slow
def test_classes_and_orders_are_those_of_the_contract(table):
    assert [row.name for row in table.rows] == ["R0", "R1", "Rp 4", "R0m 2"]
    assert [row.continuity for row in table.rows] == [0, 0, 0, 2]
    assert [row.order for row in table.rows] == [1, math.inf, 3, 0]
    for row in table.rows:
        contract = square().with_system(row.system).contract()
        assert (row.continuity, row.order) == (contract.continuity, contract.order)
        assert row.corners == len(contract.singular)


@pytest.mark.slow
def test_slopes_on_the_boundary(table):
    """Half-planes have the slope 1, which R_0, R_1 and R_4 keep and R_0^2 does not."""
    r0, r1, r4, r0m = (row.slope_error for row in table.rows)
    assert_close(r0, 0, atol=1e-6)
    assert_close(r1, 0, atol=1e-12)
    assert_close(r4, 0, atol=1e-6)
    assert r0m > 1


def test_operations_are_those_of_the_program(table):
    for row in table.rows:
        program = rsym.compile(square().with_system(row.system), backend="numpy").program
        assert row.operations == sum(node.operation not in ("const", "input") for node in program.nodes)


def test_text_html_and_json_say_the_same(table):
    lines = str(table).splitlines()
    assert lines[0].split()[0] == "system"
    assert "C^2" in lines[4]
    html = table._repr_html_()
    assert html.startswith("<div><table>")
    assert "Rp 4" in html
    record = json.loads(table.to_json())
    assert [row["system"] for row in record["systems"]] == ["R0", "R1", "Rp 4", "R0m 2"]
    assert len(repr(table)) < 200


def test_in_space_the_slope_is_taken_on_the_surface():
    ball = rsym.sphere(1) & rsym.half_space((0, 0, 1), 0)
    found = rsym.compare_systems(ball, systems=(R0, R0m(1)), bounds=((-2, 2), (-2, 2), (-2, 2)))
    assert_close(found.rows[0].slope_error, 0, atol=1e-3)
    assert found.rows[1].slope_error > 0.5


def test_what_cannot_be_compared_is_refused():
    for wrong in ("R0", [], [3], [None], 1j, R0):
        with pytest.raises(RsymError):
            rsym.compare_systems(square(), systems=wrong)
    with pytest.raises(RsymError):
        rsym.compare_systems("car")


def test_a_letter_of_a_system_gets_its_value():
    import sympy as sp

    p = sp.Symbol("p", real=True)
    found = rsym.compare_systems(square(), systems=(RAlpha(p),), letters={p: 0.5})
    assert found.rows[0].name == "Ralpha p"
    assert math.isfinite(found.rows[0].slope_error)


@pytest.mark.slow
def test_the_command_prints_the_table(tmp_path, capsys):
    (tmp_path / "square.rf").write_text("bounds x [-2, 2] y [-2, 2]\nomega = rfAND(1 - x, 1 + x, 1 - y, 1 + y)\n")
    assert main(["compare", str(tmp_path / "square.rf"), "--systems", "R0", "Rp 4"]) == 0
    out = capsys.readouterr().out
    assert [line.split()[0] for line in out.splitlines()[:3]] == ["system", "R0", "Rp"]
    assert main(["compare", str(tmp_path / "square.rf"), "--systems", "Ralfa"]) == 1
    assert "did you mean 'Ralpha'" in capsys.readouterr().err
    assert main(["compare", str(tmp_path / "square.rf"), "--systems", "R0", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["format"] == "rsym-system-table"
