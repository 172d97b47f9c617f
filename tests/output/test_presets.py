import json
import math
import re
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

import rsym
from rsym import Letter, RsymError, Shape, x, y


def test_values_and_order_come_back_to_the_last_bit(tmp_path):
    path = tmp_path / "preset.json"
    values = {"b": 0.1 + 0.2, "a": -5e-324, "z": 1.7976931348623157e308, "whole": 3, "third": Fraction(1, 3)}
    assert rsym.save_letters(values, path) == path
    back = rsym.load_letters(path)
    assert list(back) == list(values)
    assert [value.hex() for value in back.values()] == [float(value).hex() for value in values.values()]
    assert path.read_text().splitlines()[4] == '  "whole": 3,'


def test_a_shape_saves_its_defaults_and_takes_them_back(tmp_path):
    a, b = sp.symbols("a b", real=True)
    shape = Shape(a * x + b * y, (x, y), letters={b: Letter(2, minimum=0, maximum=9), a: 0.5})
    path = rsym.save_letters(shape.with_letters({"b": 7}), tmp_path / "preset.json")
    assert json.loads(path.read_text()) == {"b": 7, "a": 0.5}
    again = shape.with_letters(rsym.load_letters(path))
    assert (again.letters["b"].default, again.letters["b"].maximum) == (7.0, 9)


@given(st.dictionaries(st.text(max_size=8), st.floats(allow_nan=False, allow_infinity=False), max_size=5))
def test_any_names_and_values(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("presets") / "preset.json"
    assert rsym.load_letters(rsym.save_letters(values, path)) == values


@pytest.mark.parametrize(
    ("text", "place", "word"),
    [
        ("", "line 1, column 1", "JSON"),
        ('{"a": 1', "line 1, column 8", "JSON"),
        ('{"a": 1}\n{}', "line 2, column 1", "JSON"),
        ('{"a": 1,\n  b: 2}', "line 2, column 3", "JSON"),
        ('{"a": 5,3}', "line 1, column 9", "JSON"),
        ("[1, 2]", "line 1, column 1", "braces"),
        ('[["a", 1]]', "line 1, column 1", "braces"),
        ('{"a": 1,\n "a": 2}', "line 2, column 2", "twice"),
        ('{"b": 1,\n "a": NaN}', "line 2, column 2", "finite"),
        ('{"a": -Infinity}', "line 1, column 2", "finite"),
        ('{"a": 1e999}', "line 1, column 2", "finite"),
        ('{"a": ' + "9" * 5000 + "}", "line 1, column 2", "finite"),
        ('{"a": true}', "line 1, column 2", "finite"),
        ('{"a": null}', "line 1, column 2", "finite"),
        ('{"a": "1"}', "line 1, column 2", "finite"),
        ('{"a": {"b": 1}}', "line 1, column 2", "nested"),
        ('{"a": [1]}', "line 1, column 2", "nested"),
        ('{"a": ' + "[" * 90_000, "line 1, column 1", "nested"),
    ],
)
def test_a_bad_file_is_refused_with_its_place(tmp_path, text, place, word):
    path = tmp_path / "preset.json"
    path.write_text(text)
    with pytest.raises(RsymError, match=word) as caught:
        rsym.load_letters(path)
    assert caught.value.where == f"{path}, {place}"
    assert caught.value.remedy
    assert len(str(caught.value)) < 400


def test_files_that_cannot_be_read(tmp_path):
    (tmp_path / "long.json").write_text('{"a": 1}' + " " * 100_000)
    (tmp_path / "latin.json").write_bytes(b'{"\xe9": 1}')
    for name, word in [
        ("missing.json", "No such file"),
        ("long.json", "at most"),
        ("latin.json", "UTF-8"),
        ("", "dir"),
    ]:
        with pytest.raises(RsymError, match=word) as caught:
            rsym.load_letters(tmp_path / name)
        assert caught.value.where


def test_what_cannot_be_saved_leaves_the_old_file(tmp_path):
    path = rsym.save_letters({"a": 1}, tmp_path / "preset.json")
    for values in ({"a": math.nan}, {"a": math.inf}, {"a": "1"}, {"a": True}):
        with pytest.raises(RsymError):
            rsym.save_letters(values, path)
    assert rsym.load_letters(path) == {"a": 1.0}
    assert [entry.name for entry in tmp_path.iterdir()] == ["preset.json"]


def test_letters_outside_their_range_and_unknown_ones_are_named():
    body = rsym.paper.skeleton_body()
    for change, words in [({"p1": 4}, r"p1.*\[5, 200\]"), ({"p11": 40}, r"'p11'.*'p1'")]:
        with pytest.raises(RsymError, match=words):
            body.with_letters(change)
        with pytest.raises(RsymError, match=words):
            rsym.compile(body)(0.0, 0.0, letters=change)
    with pytest.raises(RsymError, match=r"\[0, \.\.\.\]"):
        Letter(-1, minimum=0)


def test_letters_are_a_table_in_a_notebook():
    letter = Letter(5, minimum=1, maximum=10, unit="m", doc="<reach>")
    table = Shape(x, (x, y), letters={"a": letter, "b": 0.5}).letters._repr_html_()
    rows = [re.findall("<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.findall("<tr>(.*?)</tr>", table)]
    assert rows == [
        ["letter", "value", "range", "unit", "meaning"],
        ["a", "5", "[1, 10]", "m", "&lt;reach&gt;"],
        ["b", "0.5", "", "", ""],
    ]
