"""The page of a mesh in a real browser: it draws, turns, zooms, and fetches nothing."""

import io

import numpy as np
import pytest
from matplotlib.image import imread
from sampling.test_features import cube

import rsym
from rsym import conjunction, x, y, z
from rsym.sampling.mesh import Mesh

pytestmark = pytest.mark.browser


class Opened:
    """A page in the browser, and what it asked for and complained about."""

    def __init__(self, browser, path):
        self.requests, self.complaints = [], []
        self.page = browser.new_page(viewport={"width": 600, "height": 400})
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", self._listen)
        self.page.context.set_offline(True)
        self.page.goto(path.resolve().as_uri())
        self.wait(1)

    def _listen(self, message):
        # Chromium's own remark on software rendering, when a screenshot is taken.
        if message.type in {"error", "warning"} and "GPU stall due to ReadPixels" not in message.text:
            self.complaints.append(message.text)

    def pictures(self):
        return int(self.page.evaluate("document.querySelector('canvas').dataset.pictures || 0"))

    def wait(self, least):
        """Until so many pictures have been drawn and no more follow."""
        last = -1
        for _ in range(200):
            count = self.pictures()
            if count == last >= least:
                return
            last = count
            self.page.wait_for_timeout(50)
        pytest.fail(f"{last} pictures drawn, expected {least}")

    def picture(self):
        return imread(io.BytesIO(self.page.screenshot()))[..., :3]

    def after(self, act):
        drawn = self.pictures()
        act()
        self.wait(drawn + 1)
        return self.picture()


def drag(page, dx, dy, **button):
    page.mouse.move(300, 200)
    page.mouse.down(**button)
    page.mouse.move(300 + dx, 200 + dy, steps=4)
    page.mouse.up(**button)


def body_of(picture):
    """The pixels that are not paper."""
    return (picture < 0.97).any(axis=2)


def rows_of(picture):
    return np.indices(picture.shape[:2])[0]


@pytest.mark.slow
def test_the_page_draws_turns_zooms_and_fetches_nothing(browser, tmp_path):
    solid = rsym.Shape(conjunction(1 - x**2 - y**2 / 9, 0.36 - z**2), (x, y, z), bounds=((-4, 4),) * 3)
    path = rsym.write(rsym.mesh(solid, 40), tmp_path / "disc.html")
    opened = Opened(browser, path)
    first = opened.picture()
    seen = body_of(first)
    assert 0.1 < seen.mean() < 0.6
    # Bluish, lit from above, in the middle, clear of the window's edges.
    assert (first[seen][:, 2] > first[seen][:, 0]).all()
    rows, columns = np.nonzero(seen)
    assert abs(columns.mean() - 300) < 40
    assert abs(rows.mean() - 200) < 40
    assert not seen[[0, -1]].any()
    assert not seen[:, [0, -1]].any()
    upper, lower = first[seen & (rows_of(first) < 180)], first[seen & (rows_of(first) > 250)]
    assert upper.mean() > 1.1 * lower.mean()

    turned = first
    for step in ((150, 0), (0, 60)):
        before, turned = turned, opened.after(lambda step=step: drag(opened.page, *step))
        assert (np.abs(turned - before).max(axis=2) > 0.05)[body_of(before)].mean() > 0.3
        assert body_of(turned).sum() > 0.5 * seen.sum()
    near = opened.after(lambda: opened.page.mouse.wheel(0, -400))
    assert body_of(near).sum() > 1.5 * body_of(turned).sum()
    moved = opened.after(lambda: drag(opened.page, 100, 0, button="right"))
    assert np.array_equal(moved[:, 320:520], near[:, 220:420])
    again = opened.after(lambda: opened.page.mouse.dblclick(5, 5))
    assert np.array_equal(again, first)
    assert opened.requests == [path.resolve().as_uri()]
    assert opened.complaints == []


@pytest.mark.slow
def test_the_inside_of_an_open_surface_is_warm(browser, tmp_path):
    with pytest.warns(rsym.RsymWarning, match="the upper end of z"):
        bowl = rsym.mesh(
            rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)), 40, bounds=((-2, 2), (-2, 2), (-2, 0.2)), cap=False
        )
    picture = Opened(browser, rsym.write(bowl, tmp_path / "bowl.html")).picture()
    red, _, blue = picture[body_of(picture)].T
    assert 0.2 < (red > blue).mean() < 0.8


@pytest.mark.slow
def test_parts_and_features_show_on_the_page(browser, tmp_path):
    vertices, faces, leaf = cube(3)
    names = ("left", "right", "front", "back", "bottom", "top")
    mesh = Mesh(vertices, faces, leaf=leaf, leaves=names)
    plain, coloured = (
        Opened(browser, rsym.write(mesh, tmp_path / f"{by}.html", colour_by=by)).picture() for by in (None, "part")
    )
    for picture in (plain, coloured):
        assert 100 < (picture.sum(axis=2) < 0.9).sum() < 6000  # the edges, a pixel wide
    body = body_of(plain) & (plain.sum(axis=2) > 1)
    assert (plain[body][:, 2] > plain[body][:, 0]).mean() > 0.98
    pink = coloured[body][:, 2] > coloured[body][:, 1]
    assert 0.1 < pink.mean() < 0.8  # the right side orange, the top light yellow, the back pink
