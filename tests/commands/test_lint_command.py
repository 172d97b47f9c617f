"""`rsym lint`: what it prints and what its exit code says."""

import json

import pytest

from rsym.cli import main

MODEL = """
letter a = 2 in [0, 3] "half the length"
coordinates x y
bounds x [-3.5, 3.5] y [-2.5, 2.5]
sound = rfAND((4 - x^2)/4, y)
omega = rfAND((a^2 - x^2)/(2*a), 2*y) "body"
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "half.rf"
    path.write_text(MODEL)
    return str(path)


def test_findings_are_code_1_with_line_and_remedy(model, capsys):
    assert main(["lint", model]) == 1
    text = capsys.readouterr().out
    assert "line 6, body, omega: 2*y" in text
    assert "remedy: divide by 2" in text
    assert "line 2, half the length, a: letter, 2 in [0, 3]" in text
    assert "the divisor a must not be zero" in text


@pytest.mark.slow
def test_a_clean_model_is_code_0(model, capsys):
    assert main(["lint", model, "--shape", "sound"]) == 0
    assert capsys.readouterr().out == "Clean: no finding in 2 leaves.\n"
    assert main(["lint", "valve"]) == 0


def test_json_is_all_that_is_printed(model, capsys):
    assert main(["lint", model, "--set", "a=1", "--json"]) == 1
    printed = capsys.readouterr()
    record = json.loads(printed.out)
    assert record["letters"] == {"a": 1}
    assert [finding["kind"] for finding in record["findings"]] == ["not normalised", "letter range"]
    assert record["findings"][0]["places"][0]["line"] == 6
    assert printed.err == ""


def test_the_meridian_and_its_body(model, capsys):
    assert main(["lint", model, "--shape", "sound", "--revolve", "x"]) == 0
    assert main(["lint", "skeleton", "--revolve", "x"]) == 1
    assert "not normalised" in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["missing.rf"], ["car", "--set", "q=1"], ["car", "--set", "ra=99"]])
def test_refused_input_is_code_1_with_one_line(arguments, capsys):
    assert main(["lint", *arguments]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("rsym: ")
    assert len(printed.err.splitlines()) == 1
