"""The page of a shape in a real browser: pixels of the equation, letters that compile nothing, nothing fetched."""

import base64
import io
import itertools
import math
import warnings

import numpy as np
import pytest
import sympy as sp
from matplotlib.image import imread
from oracles.served import served as serving

import rsym
from rsym import x, y, z
from rsym.output.cameras import Viewport
from rsym.output.design import pages
from rsym.output.design.pages import DesignPage, page_of
from rsym.output.rendering import Scene, _lit
from rsym.output.shading import INSIDE, developed, linear
from rsym.paper.models import MODELS, model_path
from rsym.sampling.rays import Caster

pytestmark = [pytest.mark.browser, pytest.mark.slow]

# Counts what is compiled; one sample for each pixel, so that a picture is soon done.
BEFORE = """
window.design = {samples: 1};
window.compiled = 0;
const compile = WebGL2RenderingContext.prototype.compileShader;
WebGL2RenderingContext.prototype.compileShader = function (shader) { window.compiled++; compile.call(this, shader); };
"""
HITS = """() => {
  const found = design.hits(), text = array => {
    const bytes = new Uint8Array(array.buffer);
    let words = "";
    for (let k = 0; k < bytes.length; k += 8192) words += String.fromCharCode(...bytes.subarray(k, k + 8192));
    return btoa(words);
  };
  return {...found, hits: text(found.hits), surfaces: text(found.surfaces)};
}"""


class Opened:
    """A page in the browser, what it asked for and what it complained about."""

    def __init__(self, browser, address, *, wide=900, tall=420, before=BEFORE, waits=True, **options):
        self.requests, self.complaints = [], []
        context = browser.new_context(viewport={"width": wide, "height": tall}, accept_downloads=True, **options)
        self.page = context.new_page()
        self.page.set_default_timeout(120_000)
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", self._listen)
        self.page.add_init_script(before)
        self.page.goto(address)
        if waits:
            self.wait(1)

    def _listen(self, message):
        # Chromium's own remark on software rendering.
        if message.type in {"error", "warning"} and "GPU stall due to ReadPixels" not in message.text:
            self.complaints.append(message.text)

    def ask(self, code):
        return self.page.evaluate(code)

    def pictures(self):
        return int(self.ask("document.querySelector('canvas')?.dataset.pictures ?? 0"))

    def wait(self, least):
        """Until so many pictures have been drawn, the last one in full, and no more follow."""
        last = -1
        for _ in range(600):
            count = self.pictures()
            still = self.ask("document.querySelector('canvas')?.dataset.samples === '1'")
            if count == last >= least and still:
                return
            last = count
            self.page.wait_for_timeout(60)
        pytest.fail(f"{last} pictures drawn, expected {least}: {self.ask('document.body.innerText')}")

    def after(self, act):
        drawn = self.pictures()
        act()
        self.wait(drawn + 1)
        self.page.wait_for_timeout(350)  # what moved has come to rest, and the address follows
        self.wait(drawn + 1)

    def pixels(self):
        """What the canvas shows."""
        data = self.ask("document.querySelector('canvas').toDataURL()").partition(",")[2]
        return imread(io.BytesIO(base64.b64decode(data)))[..., :3]

    def hits(self):
        """Distance and leaf or code of every pixel, rows from below, and the camera."""
        found = self.ask(HITS)
        size = found["tall"], found["wide"], 4
        hits, surfaces = (
            np.frombuffer(base64.b64decode(found[name]), "f4").reshape(size) for name in ("hits", "surfaces")
        )
        met = hits[..., 0] >= 0
        return np.where(met, surfaces[..., 3], np.inf), np.where(met, hits[..., 1], -1), found

    def middle(self):
        box = self.page.locator("canvas").first.bounding_box()
        return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def letters(self):
        """The names of the letters that are to be seen."""
        return self.ask("[...document.querySelectorAll('.letter')].filter(e => !e.hidden).map(e => e.textContent)")


def body():
    """A ball and a post through it; each part has letters of its own."""
    r, w, h = sp.symbols("r w h", real=True)
    radius = rsym.Letter(2, minimum=1, maximum=3, doc="ball: its radius")
    ball = rsym.Shape((r**2 - x**2 - y**2 - z**2) / (2 * r), (x, y, z), letters={r: radius})
    post = rsym.Shape(
        rsym.conjunction((w**2 - x**2) / (2 * w), (w**2 - y**2) / (2 * w), (h**2 - z**2) / (2 * h)),
        (x, y, z),
        letters={
            w: rsym.Letter(0.6, minimum=0.1, maximum=1, doc="post: half its width"),
            h: rsym.Letter(2.8, minimum=2.1, maximum=3.5, unit="m", doc="post: half its height </script><b>"),
        },
    )
    return (ball.named("ball </script>") | post.named("post")).replace(bounds=((-4, 4),) * 3)


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    return rsym.write(body(), tmp_path_factory.mktemp("pages") / "body.html").resolve().as_uri()


@pytest.fixture(autouse=True)
def closed(browser):
    """Pages end with their test: each holds shaders and float targets."""
    yield
    for context in browser.contexts:
        context.close()


@pytest.fixture
def opened(browser, address):
    return Opened(browser, address)


def test_a_letter_changes_the_picture_and_compiles_nothing(browser, address, opened):
    page, compiled, first = opened.page, opened.ask("compiled"), opened.pixels()
    assert compiled == 8
    slider = page.get_by_label("w", exact=True)
    opened.after(lambda: slider.press("PageUp"))
    moved = opened.pixels()
    assert (moved != first).any()
    assert opened.ask("design.values[1]") > 0.6
    opened.after(lambda: page.click("#undo"))
    assert np.array_equal(opened.pixels(), first)
    opened.after(lambda: page.keyboard.press("Control+Shift+z"))
    assert np.array_equal(opened.pixels(), moved)
    again = Opened(browser, page.url)
    assert again.ask("design.values") == opened.ask("design.values")
    assert np.array_equal(again.pixels(), moved)
    opened.after(lambda: page.click("#reset"))
    assert np.array_equal(opened.pixels(), first)
    assert opened.ask("compiled") == compiled
    assert opened.requests == [address]
    assert opened.complaints == again.complaints == []


def test_a_hostile_address_is_ignored(browser, address):
    hostile = (
        "#w=%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E&r=1e999&h=NaN&zz=3&~colours=%3Cscript%3E&~zoom=1e9&~__proto__=3"
    )
    opened = Opened(browser, address + hostile)
    assert opened.ask("design.values") == [2, 0.6, 2.8]
    assert opened.ask("[design.view.colours, design.view.zoom]") == [0, 100]
    assert opened.ask("document.querySelectorAll('img').length") == 1
    assert opened.complaints == []
    assert Opened(browser, f"{address}#w=7&h=-3").ask("design.values") == [2, 1, 2.1]


def test_points_parts_and_sections(opened):
    page, (column, row) = opened.page, opened.middle()
    page.mouse.move(column, row)
    page.wait_for_timeout(100)
    words = page.inner_text("#tip")
    assert words.startswith("ball </script>: x ")
    place = [float(word.split()[1]) for word in words.partition(": ")[2].split(", ")]
    assert math.hypot(*place) == pytest.approx(2, abs=1e-3)
    page.mouse.click(column, row)
    assert len(opened.letters()) == 1
    page.click("#all")
    assert len(opened.letters()) == 3
    page.get_by_role("button", name="post", exact=True).click()
    assert len(opened.letters()) == 2
    opened.after(lambda: page.locator("label:has-text('Section') select").select_option("1"))
    _, leaf, camera = opened.hits()
    assert (leaf == -2).mean() > 0.05
    depth = opened.hits()[0]
    points = rays(camera) * depth[..., None] + camera["eye"]
    assert np.abs(points[leaf == -2][:, 0]).max() < 1e-4
    inside = body().contains(*np.moveaxis(points[leaf == -2] - [1e-3, 0, 0], -1, 0))
    assert inside.mean() > 0.999


def test_what_is_taken_away(browser, address, tmp_path):
    opened = Opened(browser, f"{address}#w=0.7")
    page = opened.page
    with page.expect_download() as file:
        page.click("#save-letters")
    assert rsym.load_letters(file.value.path()) == {"r": 2.0, "w": 0.7, "h": 2.8}
    with page.expect_download() as file:
        page.click("#save-picture")
    assert imread(file.value.path(), format="png").shape[:2] == opened.pixels().shape[:2]
    page.get_by_role("button", name="3MF").click()
    assert page.inner_text("#answer-text") == """rsym.write(rsym.mesh(shape, "auto", letters={"w": 0.7}), 'body.3mf')"""
    assert opened.requests[0] == address
    assert all(one.startswith(("file:", "blob:")) for one in opened.requests)


def test_keyboards_screen_readers_wheels_and_small_screens(browser, address):
    opened = Opened(browser, address, wide=390, tall=760, color_scheme="dark", has_touch=True)
    page = opened.page
    names = """[...document.querySelectorAll('input, select, button, canvas, summary')].filter(
        one => !(one.labels?.length || one.getAttribute('aria-label') || one.textContent.trim())).length"""
    assert opened.ask(names) == 0
    assert opened.ask("document.documentElement.scrollWidth") <= 390
    box = page.locator("canvas").bounding_box()
    assert box["width"] >= 380
    assert box["height"] > 250
    assert opened.pixels()[0, 0].max() < 0.2  # paper is dark in the dark
    first = opened.hits()[0]
    page.locator("canvas").focus()
    opened.after(lambda: page.keyboard.press("ArrowLeft"))
    assert (opened.hits()[0] != first).any()
    number = page.get_by_label("r, value")
    number.focus()
    number.hover()
    page.mouse.wheel(0, 200)
    slider = page.get_by_label("r", exact=True)
    slider.hover()
    page.mouse.wheel(0, 200)
    page.wait_for_timeout(100)
    assert opened.ask("design.values") == [2, 0.6, 2.8]


def test_curvatures_are_those_of_the_leaf(browser, address):
    """A ball of radius 2: mean curvature 1/2, Gaussian 1/4, greater 1/2; flat sides of the post 0."""
    opened = Opened(browser, f"{address}#~colours=2", wide=520, tall=300)
    _, leaf, _ = opened.hits()
    found = np.array(opened.ask("Array.from(design.curvatures())")).reshape(*leaf.shape, 4)
    for number, curvature in enumerate((0.5, 0.25, 0.5)):
        assert np.abs(found[leaf == 0][:, number] - curvature).max() < 0.05
        assert np.abs(found[leaf > 0][:, number]).max() < 1e-3
    assert (leaf == 0).any()
    assert (leaf > 0).any()
    seen = [opened.pixels()]
    for style in (3, 4):
        opened.after(lambda style=style: opened.ask(f"change({{colours: {style}}})"))
        seen.append(opened.pixels())
        assert (seen[-1] != seen[-2]).any()
    assert opened.complaints == []


def rays(camera):
    """The unit directions of the pixels' middles."""
    (wide, tall), lens = (camera["wide"], camera["tall"]), camera["lens"]
    across = ((np.arange(wide) + 0.5) / wide * 2 - 1 - lens[2]) * lens[0]
    up = ((np.arange(tall) + 0.5) / tall * 2 - 1 - lens[3]) * lens[1]
    seen = np.stack(np.broadcast_arrays(across[None], up[:, None], -1.0), axis=-1)
    found = seen @ np.array(camera["turn"]).reshape(3, 3)
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


def first_inside(kernel, letters, eye, directions, box, count=1500):
    """The oracle: signs of omega in float64 along rays, and bisection; inf where all are negative."""
    box = np.array(box)
    one, two = (box[:, 0] - eye) / directions, (box[:, 1] - eye) / directions
    start, end = np.minimum(one, two).max(axis=1).clip(0), np.maximum(one, two).min(axis=1)

    def inside(depth):
        points = eye + directions.reshape(-1, *[1] * (depth.ndim - 1), 3) * depth[..., None]
        with warnings.catch_warnings(action="ignore"):
            return kernel(*np.moveaxis(points, -1, 0), letters=letters)["value"] > 0

    depth = start[:, None] + (end - start)[:, None] * np.linspace(1e-9, 1, count)
    met = inside(depth) & (end > start)[:, None]
    which, row = met.argmax(axis=1), np.arange(len(met))
    low, high = depth[row, which - 1], depth[row, which]
    for _ in range(45):
        half = (low + high) / 2
        now = inside(half)
        low, high = np.where(now, low, half), np.where(now, half, high)
    found = np.where(which == 0, start, high)
    return np.where(met.any(axis=1), found, np.inf)


def agrees(kernel, letters, camera, box, pixels, depth):
    """Which of these pixels (row, column) show what signs say, maybe 0.2 of a pixel beside."""
    around = [(0.0, 0.0), *((0.2 * math.cos(k * math.pi / 4), 0.2 * math.sin(k * math.pi / 4)) for k in range(8))]
    good = np.zeros(len(pixels), bool)
    for right, up in around:
        left = np.flatnonzero(~good)
        row, column = pixels[left].T
        x_, y_ = ((column + 0.5 + right) / camera["wide"], (row + 0.5 + up) / camera["tall"])
        lens = camera["lens"]
        seen = np.stack([(x_ * 2 - 1 - lens[2]) * lens[0], (y_ * 2 - 1 - lens[3]) * lens[1], -np.ones(len(left))], 1)
        way = seen @ np.array(camera["turn"]).reshape(3, 3)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        truth = first_inside(kernel, letters, np.array(camera["eye"]), way, box)
        shown = depth[row, column]
        near = np.isfinite(truth) & np.isfinite(shown)
        truth[~near], shown[~near] = np.isinf(truth[~near]), np.isinf(shown[~near])
        good[left] = np.abs(truth - shown) < np.where(near, 2 * camera["pixel"] * shown, 0.5)
    return good


@pytest.mark.random
@pytest.mark.parametrize("name", MODELS)
def test_every_shipped_model_opens_and_shows_what_signs_say(browser, tmp_path, name):
    shape = rsym.load(model_path(name))
    shape = rsym.revolve(shape) if shape.dimension == 2 else shape
    address = DesignPage(page_of(shape, title=name)).write(tmp_path / f"{name}.html").as_uri()
    opened = Opened(browser, address, wide=600, tall=300)
    assert opened.complaints == []
    assert len(opened.requests) == 1
    depth, leaf, camera = opened.hits()
    assert np.isfinite(depth).mean() > 0.01
    assert not (leaf == -3).any()  # undecided
    random = np.random.default_rng(5)
    seen = np.argwhere(np.isfinite(depth))
    pixels = np.concatenate([seen[random.integers(0, len(seen), 300)], random.integers(0, depth.shape, (100, 2))])
    box = shape.bounds or rsym.extent(shape)
    kernel = rsym.compile(shape)
    good = agrees(kernel, None, camera, box, pixels, depth)
    assert good.all()
    # Red proof: the same depths a few pixels to the side are wrong.
    assert not agrees(kernel, None, camera, box, pixels, np.roll(depth, 9, axis=1)).all()


def neighbours_agree(leaf, depth):
    """Pixels without a line of the page: the four beside them see the same leaf, as far away."""
    inside = leaf >= 0
    for axis, step in itertools.product((0, 1), (1, -1)):
        with np.errstate(invalid="ignore"):
            inside &= (np.roll(leaf, step, axis) == leaf) & (np.abs(np.roll(depth, step, axis) - depth) < 0.003 * depth)
    return inside


@pytest.mark.parametrize("name", ["car", "gear"])
def test_a_page_and_a_rendered_picture_are_one(browser, tmp_path, name):
    """Hits and leaves differ on a thousandth of the pixels at most, colours elsewhere by a grey level."""
    shape = rsym.load(model_path(name))
    address = DesignPage(page_of(shape, title=name)).write(tmp_path / f"{name}.html").as_uri()
    opened = Opened(browser, address, wide=900, tall=500)
    depth, leaf, seen = opened.hits()
    axes, lens, (wide, tall) = np.array(seen["turn"]).reshape(3, 3), seen["lens"], (seen["wide"], seen["tall"])
    centre = wide * (1 + lens[2]) / 2 - 0.5, tall * (1 - lens[3]) / 2 - 0.5
    view = Viewport((wide, tall), axes, np.array(seen["eye"]) - axes[2], 2 * lens[0] / wide, 1.0, 0.0, centre)
    sight = Scene(Caster(shape), view, ()).seen()
    hits, count = sight.hits, len(Caster(shape).leaves) - 6
    found = hits.leaf[::-1].astype(int)
    same = (np.isfinite(depth) == hits.met[::-1]) & ((leaf == found) | (leaf < 0) & (found >= count) | (found < 0))
    assert (~same).mean() < 1e-3
    colours, names = opened.ask("data.parts"), opened.ask("data.leaves")
    table = np.array([linear(colours[one]["colour"]) for one in names] + [linear(INSIDE)], np.float32)
    canvas = np.zeros((wide * tall, 4), np.float32)
    light = table[np.minimum(sight.leaf, count)]
    canvas[sight.met] = np.insert(_lit(sight, light, np.ones((3, len(light)), np.float32)), 3, 1.0, axis=1)
    mine = developed(canvas, "white").reshape(tall, wide, 4)[..., :3].astype(int)
    theirs = np.rint(255 * opened.pixels()).astype(int)
    inside = (same & neighbours_agree(leaf, depth))[::-1]
    assert inside.mean() > 0.15
    assert np.abs(mine - theirs)[inside].max() <= 1


def test_a_shape_in_the_plane(browser, tmp_path):
    a, letter = sp.Symbol("a", real=True), rsym.Letter(2, minimum=1, maximum=3)
    disc = rsym.Shape((a**2 - x**2 - y**2) / (2 * a), (x, y), letters={a: letter}, bounds=((-4, 4), (-4, 4)))
    opened = Opened(browser, rsym.write(disc, tmp_path / "disc.html").as_uri())
    teeth = opened.ask("design.teeth")
    assert len(teeth) > 100
    assert [tooth["bend"] for tooth in teeth] == pytest.approx([0.5] * len(teeth))
    assert [math.hypot(*tooth["at"]) for tooth in teeth] == pytest.approx([2.0] * len(teeth))
    first, compiled = opened.pixels(), opened.ask("compiled")
    assert compiled == 2
    opened.after(lambda: opened.page.get_by_label("a", exact=True).press("PageUp"))
    assert (opened.pixels() != first).any()
    assert opened.ask("compiled") == compiled
    assert 1 / opened.ask("design.teeth")[0]["bend"] == pytest.approx(opened.ask("design.values[0]"))
    seen = [opened.pixels()]
    for k in range(1, 6):
        opened.after(lambda k=k: opened.page.get_by_label("Show", exact=False).first.select_option(f"{k}"))
        seen.append(opened.pixels())
        assert (seen[-1] != seen[-2]).any()
    opened.page.mouse.move(*opened.middle())
    assert "ω" in opened.page.inner_text("#tip")
    assert opened.complaints == []


def test_without_webgl_and_without_a_context_a_still_picture_stays(browser, address):
    none = "HTMLCanvasElement.prototype.getContext = () => null;"
    opened = Opened(browser, address, before=none, waits=False)
    opened.page.wait_for_timeout(300)
    assert opened.page.locator("#still").is_visible()
    assert "WebGL 2" in opened.page.inner_text("#message")
    assert len(opened.letters()) == 3
    opened = Opened(browser, address)
    first = opened.pixels()
    lose = "document.querySelector('canvas').getContext('webgl2').getExtension('WEBGL_lose_context')"
    opened.ask(f"(window.held = {lose}).loseContext()")
    opened.page.wait_for_timeout(300)
    assert opened.page.locator("#still").is_visible()
    assert "lost" in opened.page.inner_text("#message")
    opened.after(lambda: opened.ask("held.restoreContext()"))
    assert not opened.page.locator("#still").is_visible()
    assert np.array_equal(opened.pixels(), first)


def served(shape):
    return serving(shape, page_of(shape, title="body", served=True), resolution=24)


def test_a_served_page_takes_files_and_answers(browser):
    with served(body()) as server:
        opened = Opened(browser, server.address)
        opened.after(lambda: opened.page.get_by_label("w", exact=True).press("PageUp"))
        with opened.page.expect_download() as file:
            opened.page.get_by_role("button", name="STL").click()
        data = file.value.path().read_bytes()
        count = int.from_bytes(data[80:84], "little")
        assert len(data) == 84 + 50 * count > 10_000
        opened.page.get_by_role("button", name="Lint").click()
        opened.page.locator("#answer[open]").wait_for()
        assert opened.page.inner_text("#answer-text").strip()
        assert all(one.startswith((server.address, "blob:")) for one in opened.requests)
        assert opened.complaints == []


def test_a_long_formula_shows_its_mesh_and_a_served_one_meshes_again(browser, monkeypatch):
    monkeypatch.setattr(pages, "MOST_OPERATIONS", 0)
    with served(body()) as server:
        opened = Opened(browser, server.address, waits=False)
        page = opened.page
        page.frame_locator("iframe").locator("canvas[data-pictures]").wait_for()
        first = page.frame_locator("iframe").locator("canvas").screenshot()
        with page.expect_response("**/body.html"):
            page.get_by_label("w", exact=True).press("Home")
        page.frame_locator("iframe").locator("canvas[data-pictures]").wait_for()
        page.wait_for_timeout(300)
        assert page.frame_locator("iframe").locator("canvas").screenshot() != first
        assert opened.complaints == []


def test_a_notebook_that_became_a_page_keeps_its_letters(browser, tmp_path):
    """As a notebook is exported: the HTML of an output, inside a document."""
    path = tmp_path / "notebook.html"
    shown = DesignPage(page_of(body(), title="body"))._repr_html_()
    path.write_text(f"<!DOCTYPE html><meta charset=utf-8><title>notebook</title><body><p>a cell</p>{shown}</body>")
    opened = Opened(browser, path.as_uri(), waits=False)
    inner = opened.page.frame_locator("iframe")
    inner.locator("canvas[data-samples='1']").wait_for()
    first = inner.locator("canvas").screenshot()
    inner.get_by_label("r", exact=True).press("Home")
    opened.page.wait_for_timeout(1500)
    assert inner.locator("canvas").screenshot() != first
    assert opened.complaints == []
    assert opened.requests == [path.as_uri()]
