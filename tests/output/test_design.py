"""The page of a shape without a browser: its text, the commands that it shows, and who is served what."""

import http.client
import json
import re
import signal
import subprocess
import sys
import urllib.request
from types import SimpleNamespace
from urllib.parse import unquote

import pytest
import sympy as sp
from oracles.served import served as serving

import rsym
from rsym import RsymError, x, y, z
from rsym.cli import main
from rsym.logic.sign_form import surface_form
from rsym.output.design.pages import page_of
from rsym.output.design.plane import plane_texts
from rsym.output.design.serving import LONGEST

r = sp.Symbol("r", real=True)
BALL = rsym.Shape(
    (r**2 - x**2 - y**2 - z**2) / (2 * r),
    (x, y, z),
    letters={r: rsym.Letter(1, minimum=0.5, maximum=2, doc="ball: its radius")},
    bounds=((-3, 3),) * 3,
).named("</script><img src=x>")


def data_of(page):
    (text,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    return json.loads(text)


@pytest.mark.slow
def test_the_page_of_the_car_is_small_and_whole(tmp_path):
    page = rsym.write(rsym.paper.car(), tmp_path / "car.html")
    assert page.stat().st_size < 90_000
    text = page.read_text()
    data = data_of(text)
    assert [letter["name"] for letter in data["letters"]] == list(rsym.paper.car().letters)
    assert data["letters"][0] == {
        "name": "a1", "value": 8.0, "low": 4.0, "high": 14.0, "unit": "", "group": "roof", "doc": "half its length"
    }  # fmt: skip
    assert text.count("vec4 model(") == 1
    assert text.count("= model(") == text.count("= form(") == 1
    assert "leaf(int(" not in re.search(r'id="shader-trace">(.*?)</script>', text, re.DOTALL)[1]
    assert "http" not in re.sub(r"http-equiv|&quot;", "", text)


def test_names_never_leave_the_data():
    page = page_of(BALL, title="</title><script>alert(1)</script>")
    assert data_of(page)["leaves"] == ["</script><img src=x>"]
    assert "alert(1)</script>" not in page
    assert "<img src=x" not in page
    assert "letters[0]" in page  # by number: a letter's name is in no formula


def test_a_part_knows_its_letters():
    (part,) = data_of(page_of(BALL))["parts"].values()
    assert part["letters"] == [0]


def test_a_shape_is_written_as_a_page_alone(tmp_path):
    with pytest.raises(RsymError, match="a shape is written as"):
        rsym.write(BALL, tmp_path / "ball.stl")
    with pytest.raises(RsymError, match="takes no options, got unit"):
        rsym.write(BALL, tmp_path / "ball.html", unit="mm")


def test_the_command_writes_a_page_whose_commands_run(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my ball.rf").write_text(
        'coordinates x y z\nbounds x [-3, 3] y [-3, 3] z [-3, 3]\nletter r = 1 in [0.5, 2] "its radius"\n'
        "omega = r^2 - x^2 - y^2 - z^2\n"
    )
    assert main(["design", "my ball.rf", "--set", "r=1.5", "-o", "ball.html"]) == 0
    assert capsys.readouterr().out.strip() == "ball.html"
    services = {row["title"]: row["command"] for row in data_of((tmp_path / "ball.html").read_text())["services"]}
    assert services == {
        "STL": "rsym mesh 'my ball.rf' --set r=1.5{letters} -o 'my ball.stl'",
        "3MF": "rsym mesh 'my ball.rf' --set r=1.5{letters} -o 'my ball.3mf'",
        "GLB": "rsym mesh 'my ball.rf' --set r=1.5{letters} -o 'my ball.glb'",
        "Verdict": "rsym verify 'my ball.rf' --set r=1.5{letters}",
        "Lint": "rsym lint 'my ball.rf' --set r=1.5{letters}",
    }
    assert main(["letters", "my ball.rf", "--set", "r=1.5", "--set", "r=1.25"]) == 0
    assert "1.25" in capsys.readouterr().out
    assert main(["design", "my ball.rf", "-o", "ball.stl"]) == 1


@pytest.mark.slow
def test_the_command_serves_until_it_is_interrupted():
    words = [sys.executable, "-m", "rsym.cli", "design", "solids", "--no-open"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        try:
            address = process.stdout.readline().strip()
            with urllib.request.urlopen(address, timeout=60) as reply:
                assert "<title>solids - rsym</title>" in reply.read().decode()
            process.send_signal(signal.SIGINT)
            assert process.wait(60) == 0
        finally:
            process.kill()  # else a run that was itself told to ignore interrupts would wait for ever


def served():
    return serving(BALL, "<!DOCTYPE html><title>ball</title>", resolution=12)


def asked(server, method, path, body=None, **headers):
    """The status and the answer; `_` in the name of a header stands for a hyphen."""
    return answered(server, method, path, body, **headers)[:2]


def answered(server, method, path, body=None, **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    try:
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, path, None if body is None else body.encode(), given)
        reply = connection.getresponse()
        return reply.status, reply.read(), unquote(reply.headers.get("X-Status", ""))
    finally:
        connection.close()


def test_only_who_knows_the_word_and_this_computer_is_served():
    with served() as server:
        home = f"/{server.word}/"
        assert server.address.endswith(home)
        assert asked(server, "GET", home) == (200, b"<!DOCTYPE html><title>ball</title>")
        assert asked(server, "GET", home, Host=f"localhost:{server.server_port}")[0] == 200
        for path in ("/", "/index.html", f"/{server.word[:-1]}/", f"/{server.word}x/", "/../"):
            assert asked(server, "GET", path)[0] == 403
            assert asked(server, "POST", f"{path}body.stl", "{}")[0] == 403
        for host in ("evil.example", f"evil.example:{server.server_port}", "127.0.0.1:1"):
            assert asked(server, "GET", home, Host=host)[0] == 403
        assert asked(server, "POST", f"{home}lint", "{}", Origin="http://evil.example")[0] == 403
        assert asked(server, "GET", f"{home}etc/passwd")[0] == 404
        assert asked(server, "POST", f"{home}body.exe", "{}")[0] == 404
        assert asked(server, "POST", f"{home}", "{}")[0] == 404


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("", "JSON"),
        ("[1]", "JSON object"),
        ("[" * 50_000, "JSON object"),
        ('{"r": "1"}', "finite real number"),
        ('{"r": true}', "finite real number"),
        ('{"r": NaN}', "finite real number"),
        ('{"r": 1e999}', "finite real number"),
        ('{"r": [1]}', "finite real number"),
        (f'{{"r": 1{"0" * 400}}}', "finite real number"),
        ('{"r": 3}', "must lie in"),
        ('{"__class__": 1}', "no letter"),
        (" " * (LONGEST + 1), "at most"),
    ],
    ids=range(12),
)
def test_numbers_alone_come_in(body, why):
    with served() as server:
        status, answer = asked(server, "POST", f"/{server.word}/body.stl", body)
    assert (status, why in answer.decode()) == (400, True)


def test_meshes_and_answers_go_out():
    with served() as server:
        home = f"/{server.word}/"
        status, data, told = answered(server, "POST", f"{home}body.stl", '{"r": 2}')
        assert status == 200
        assert told.startswith(f"Resolution 12: {len(data[84:]) // 50} triangles in one piece, closed")
        assert len(data) == 84 + 50 * int.from_bytes(data[80:84], "little")
        status, data = asked(server, "POST", f"{home}body.glb", "{}")
        assert (status, data[:4]) == (200, b"glTF")
        status, data = asked(server, "POST", f"{home}lint", '{"r": 2}')
        assert (status, data.decode()) == (200, str(rsym.lint(BALL.with_letters({"r": 2}))))


def test_the_line_of_a_page_is_there_where_a_part_has_no_value():
    """The text of GLSL, read as Python: the sign is that of a disc, or of what is to the right of 2."""
    shape = rsym.disc(1) | rsym.Shape(sp.sqrt(x - 2) - y, (x, y))
    (shader, *_) = plane_texts(shape, surface_form(shape)).shaders
    lines = re.search(r"float value\(vec2 p\) \{\nfloat (.*);\nreturn (\w+);", shader)
    for place, inside in (((0, 0), True), ((-2, 0), False), ((3, 0.5), True), ((3, 1.5), False), ((0, -3), False)):
        known = {"p": SimpleNamespace(x=place[0], y=place[1]), "min": min, "max": max}
        for name, text in (part.split("=") for part in re.split(r",(?=v\d+=)", lines[1])):
            known[name] = eval(text, known)
        assert (known[lines[2]] > 0) == inside
