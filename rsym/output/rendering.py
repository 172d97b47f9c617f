"""Pictures straight from the equation: rays cast at it, light, edges between pixels, sections; no mesh."""

from __future__ import annotations

import base64
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Integers, Ints, Shorts
from rsym.errors import RsymError, RsymWarning, warn
from rsym.model.requirements import require_count, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import postorder
from rsym.model.wording import documented
from rsym.output.brushes import Brush, Colouring, brush_of, checked_colouring, hatched, part_colours_of
from rsym.output.cameras import VIEWS, Camera, Viewport, camera_of
from rsym.output.edges import Single, edges_of, inked, smoothed
from rsym.output.framing import framed
from rsym.output.images import Image, counted
from rsym.output.ink import INK
from rsym.output.paints import NAMES_OF_MAPS
from rsym.output.shading import HOLLOW_RADIUS, Light, developed, hollows_at, linear, lit
from rsym.output.shadows import shade_of
from rsym.output.sights import UNDECIDED, Probe, Sight
from rsym.output.slender import Slender, slender
from rsym.sampling.hits import Hits
from rsym.sampling.pencils import Cut
from rsym.sampling.plane import fixed_coordinates
from rsym.sampling.rays import Caster
from rsym.sampling.undefined import warn_undefined

SIGNAL = "#ff00c8"  # of rays that came to a limit: nothing else is of that colour
LINE = 1.5e-3  # the width of lines, of the mean side of a picture; at least
THINNEST = 0.75  # pixels
FINER = 8  # than pixels: how closely rays look that say where in a pixel an edge is
BESIDE = (1e-3, 7e-4)  # pixels: so far beside it a ray looks where the one through the middle cannot decide
MOST_PIXELS = 1 << 26  # of a picture: 5 GB of memory
MOST_SAMPLES = 64
NONE = np.zeros(0, np.int64)
THUMBNAIL, MOST_NODES = (240, 180), 400  # pixels; parts of a formula, of which a caster is made in half a second
BATCH = 1 << 14  # pixels shaded at once: what is between steps stays in the cache


@documented(maps=NAMES_OF_MAPS, views=", ".join(VIEWS))
def render(
    shape: Shape,
    *,
    camera: Camera | str | None = None,
    size: tuple[int, int] = (1600, 1200),
    colour_by: str | None = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    lines: bool = True,
    shadows: bool = False,
    background: str | None = "white",
    samples: int = 1,
    threads: int | None = None,
) -> Image:
    """Draw a shape in space by rays cast at its equation: exact edges, normals and curvatures, no mesh.

    A ray meets the surface at the first zero of the sign form along it, found by enclosures; the light is that of
    `plot_mesh`. Beyond its bounds a body is cut off, as meshes are. What rays through the middles of pixels pass by,
    needles and fins thinner than a pixel, is found by enclosures round whole pixels, and shown; gaps as thin are not.

    Parameters
    ----------
    shape : Shape
        In space; without bounds its extent is found.
    camera : Camera or str, optional
        Where the eye stands: a camera, or {views}. The body fills the picture, whatever is cut off.
    size : (int, int)
        Width and height in pixels.
    colour_by : str, optional
        ``part``: a colour for each part of the shape (`Shape.named`); ``zebra``: the reflection of level stripes;
        ``normal``: the outer unit normal n as the colour (n + 1)/2; {maps}: a map of the exact curvature.
    letters : mapping, optional
        Override the defaults.
    section : mapping, optional
        Cut the body in planes, such as ``{{x: 0}}``: the half that faces away from the eye is kept, its cut hatched.
    lines : bool
        Whether outlines and the edges where leaves meet are drawn in ink.
    shadows : bool
        Whether places that the body hides from the light or from the sky are darker.
    background : str or None
        A colour; None for a transparent picture.
    samples : int
        A square number of rays for each pixel beside an edge, such as 4 or 16; 1 smooths edges by where they cross
        the rows and columns of pixels.
    threads : int, optional
        By default as many as there are processors; the picture does not depend on it.

    Returns
    -------
    Image
        An array (h, w, 4) with depth, points, normals, leaves, parts and curvatures; it shows itself in a notebook.

    Raises
    ------
    RsymError
        For a shape in the plane, one without bounds that goes on for ever, an unknown camera, colouring, letter or
        colour, a size that is not two positive integers, a section outside of the bounds, or samples that are no
        square.

    Warns
    -----
    RsymWarning
        Where nothing of the body is seen, rays are undecided, what is thinner than a pixel cannot be found, or omega
        has no value in some of the bounds.

    Examples
    --------
    >>> import rsym
    >>> image = rsym.render(rsym.sphere(2), camera="front", size=(80, 60))
    >>> image.shape, image.points[30, 30].round(1).tolist()
    ((60, 80, 4), [0.7, 1.9, -0.0])
    >>> bool(abs(image.normal[30, 30] - image.points[30, 30] / 2).max() < 1e-12)
    True
    """
    size, camera = _checked_size(size), camera_of(camera)
    require_body(shape)
    _check(samples, background)
    colouring = checked_colouring(colour_by)
    caster = Caster(shape, letters, threads=threads)
    cuts = cuts_of(section, shape, caster.bounds, camera)
    view = framed(caster, camera, size)
    scene = Scene(caster, view, cuts)
    seen = scene.seen()
    sight, between = scene.shown(seen)
    warn_undefined(shape, caster.bounds, letters)
    if not told_unseen(sight, between) and not len(sight.met):
        warn("nothing of the body is seen; remedy: other bounds, another camera or section")
    brush = brush_of(colouring, [sight], lambda: Probe.of(caster))
    width = max(LINE * float(np.sqrt(size[0] * size[1])), THINNEST) if lines else 0.0
    canvas = scene.painted(sight, brush, width, shadows=shadows, samples=samples, between=between.pixels)
    names = (*caster.leaves, *(f"section {name} = {value:g}" for name, value in (section or {}).items()))
    return Image(
        pixels=developed(canvas, background).reshape(size[1], size[0], 4),
        view=view,
        camera=camera,
        hits=replace(seen.hits, undecided=sight.hits.undecided),
        leaves=names,
        coordinates=tuple(symbol.name for symbol in shape.coordinates),
        scale=brush.scale,
        scale_label=brush.label,
        parts_seen=lambda: brush.parts or part_colours_of([sight]),
        legend=colouring == "part",
    )


def told_unseen(sight: Sight, between: Slender) -> bool:
    """Whether it was warned of what a picture may lack."""
    count = int(np.count_nonzero(sight.hits.undecided))
    if count:
        warn(
            f"{counted(count)}: the body may have walls there that are thinner than rays tell; remedy: another camera, "
            "or look at what is closer"
        )
    elif between.blind:
        warn(
            "what is thinner than a pixel may be missing: bounds of omega round whole pixels are too wide to find it; "
            "remedy: write omega with fewer terms that cancel, as a product, or build it of rsym's pieces"
        )
    return count > 0 or between.blind


def require_body(shape: Any) -> None:
    """Refuse what rays are not cast at."""
    require_shape(shape)
    if shape.dimension != 3:
        raise RsymError(
            "rays are cast at a shape in space, got one in the plane",
            code="dimension",
            remedy="rsym.revolve(shape) or rsym.extrude(shape, 0, 1) first; in the plane rsym.plot_fields(shape)",
        )


def _check(samples: Any, background: Any) -> None:
    require_count("samples", samples, "1, 4 or 16")
    if samples > MOST_SAMPLES or int(np.sqrt(samples)) ** 2 != samples:
        raise RsymError(
            f"samples are a square number up to {MOST_SAMPLES}, got {samples}", code="samples", remedy="1, 4 or 16"
        )
    if background is not None:
        linear(background)


def _checked_size(size: Any) -> tuple[int, int]:
    sides = tuple(size) if isinstance(size, Iterable) else ()
    if len(sides) != 2 or not all(isinstance(side, Integral) and side > 0 for side in sides):  # type: ignore[operator]
        raise RsymError(f"a size is two positive integers, got {size!r}", code="size", remedy="size=(1600, 1200)")
    width, height = map(int, sides)
    if width * height > MOST_PIXELS:
        raise RsymError(
            f"a picture has at most {MOST_PIXELS:,} pixels, got {width} x {height}", code="size", remedy="a smaller one"
        )
    return width, height


def cuts_of(section: Any, shape: Shape, bounds: Bounds, camera: Camera) -> tuple[Cut, ...]:
    """The half-spaces of a section, which face away from the eye."""
    if section is not None and not isinstance(section, Mapping):
        raise RsymError(f"a section is a mapping, got {section!r}", code="section", remedy="section={x: 0}")
    names = [symbol.name for symbol in shape.coordinates]
    cuts = []
    for number, place in fixed_coordinates(names, section).items():
        low, high = bounds[number]
        if not low < place < high:
            raise RsymError(
                f"the section {names[number]} = {place:g} lies outside of the bounds, [{low:g}, {high:g}]",
                code="section",
                remedy=f"for example section={{{names[number]}: {(low + high) / 2:g}}}",
            )
        sign = 1.0 if camera.axes[2, number] >= 0 else -1.0
        normal = [0.0, 0.0, 0.0]
        normal[number] = sign
        cuts.append(Cut((normal[0], normal[1], normal[2]), sign * place))
    return tuple(cuts)


@lru_cache(maxsize=64)  # a notebook shows the same shape again and again
def thumbnail(shape: Shape) -> str:
    """A small picture of a shape in space as an HTML image; empty where it has no bounds or would take long.

    Examples
    --------
    >>> import rsym
    >>> thumbnail(rsym.sphere(1))[:19], thumbnail(rsym.cylinder(1))
    ('<img alt="the body"', '')
    """
    if shape.dimension != 3 or shape.box is None or sum(1 for _ in postorder(shape.expression)) > MOST_NODES:
        return ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RsymWarning)
            image = render(shape, size=THUMBNAIL, background=None)
    except RsymError:  # of a formula that has no picture the text is shown all the same
        return ""
    if not (image.leaf >= 0).any():
        return ""
    data = base64.b64encode(image._repr_png_()).decode()
    return f'<img alt="the body" width="{THUMBNAIL[0]}" height="{THUMBNAIL[1]}" src="data:image/png;base64,{data}">'


@dataclass(frozen=True)
class Scene:
    """What rays are cast at: a body, how it is seen, and what is cut off."""

    caster: Caster
    view: Viewport
    cuts: tuple[Cut, ...]

    def seen(self) -> Sight:
        """What all pixels see; beside edges rays look closer, for on a rim a quarter of a pixel decides on the leaf."""
        hits = self.caster.look(self.view.pencil, cuts=self.cuts)
        # A ray that touches an edge to the last bit is nobody's business, a wall too thin for all rays is.
        row, column = np.nonzero(hits.undecided)
        self._put(hits, row, column, self.sight(column + BESIDE[0], row + BESIDE[1]))
        first = Sight.of_pixels(self.view, hits)
        pixels = first.unlike()
        if not pixels.size:
            return first
        row, column = np.divmod(pixels, self.view.size[0])
        self._put(hits, row, column, self.sight(column, row))
        return Sight.of_pixels(self.view, hits)

    def shown(self, seen: Sight) -> tuple[Sight, Slender]:
        """What is painted: what is seen, with what is thinner than a pixel wherever in a pixel it was found."""
        found = slender(self.caster, seen, self.sight, self.cuts)
        if not len(found.pixels) and not len(found.undecided):
            return seen, found
        hits = seen.hits
        hits = replace(hits, **{name: getattr(hits, name).copy() for name in ("depth", "leaf", "normal", "undecided")})
        row, column = np.divmod(found.pixels, self.view.size[0])
        self._put(hits, row, column, self.sight(found.columns, found.rows))
        hits.undecided.reshape(-1)[found.undecided] = True
        columns, rows = seen.columns.astype(np.float64), seen.rows.astype(np.float64)
        columns[found.pixels], rows[found.pixels] = found.columns, found.rows
        return Sight(self.view, columns, rows, hits), found

    def _put(self, hits: Hits, row: Integers, column: Integers, closer: Sight) -> None:
        """What was seen closer, in place: a copy of all would take a fifth of the time."""
        for name in ("depth", "leaf", "normal", "undecided"):
            getattr(hits, name)[row, column] = getattr(closer.hits, name)

    def sight(self, columns: NDArray[Any], rows: NDArray[Any]) -> Sight:
        """What the rays of places see."""
        near = -np.inf if self.view.distance is None else 0.0
        origins, ways = self.view.rays(columns, rows)
        still, growing = self.view.pencil.pixel
        hits = self.caster.cast(origins, ways, near=near, cuts=self.cuts, pixel=(still / FINER, growing / FINER))
        return Sight(self.view, columns, rows, hits)

    def look(self, columns: Floats, rows: Floats) -> tuple[Shorts, Floats]:
        """The leaves, and the depths, that the rays of places see."""
        sight = self.sight(columns, rows)
        return sight.labels, sight.hits.depth

    def painted(
        self,
        sight: Sight,
        brush: Brush,
        line: float,
        *,
        shadows: bool = False,
        samples: int = 1,
        between: Ints = NONE,
    ) -> Single:
        """Light times coverage and coverage of all pixels (h*w, 4), with lines of some width in pixels.

        In the pixels `between` another ray than the one through the middle has met the body: it is one sample more.
        """
        width, height = self.view.size
        edges = edges_of(sight, (height, width), self.look)
        canvas = np.zeros((width * height, 4), np.float32)
        shares, colours = self._shares(sight, shadows), brush.begin(sight)
        canvas[sight.met, :3] = self._light(sight, colours(sight, None), shares, brush.lit)
        canvas[sight.met, 3] = 1.0
        if samples == 1:
            crossed, shown = smoothed(edges, canvas)
            canvas[crossed] = shown
        else:
            pixels = edges.pixels
            more = np.isin(pixels, between)[:, None]
            total = self._refined(sight, pixels, brush, colours, shares, samples) + more * canvas[pixels]
            canvas[pixels] = total / np.float32(samples + more)
        canvas[sight.labels == UNDECIDED] = (*linear(SIGNAL), 1.0)
        if line:
            where, share = inked(edges, line)
            canvas[where] *= 1 - share[:, None]
            canvas[where] += share[:, None] * np.append(linear(INK), 1.0).astype(np.float32)
        return canvas

    def _shares(self, sight: Sight, shadows: bool) -> Single:
        """The shares (3, m) of all light, of the key light and of the others that what a sight meets is given."""
        shares = np.ones((3, len(sight.met)), np.float32)
        if shadows:
            size = float(np.ptp(np.array(self.caster.bounds), axis=1).max())
            shade = shade_of(sight, size, self._hidden)
            shares[1:] = shade.key, shade.sky
        elif len(sight.met):
            depth = np.where(np.isinf(sight.depths), np.float32(np.nan), sight.depths).reshape(self.view.size[::-1])
            shares[0] = hollows_at(depth, max(int(HOLLOW_RADIUS * max(self.view.size)), 1))
        return shares

    def _hidden(self, origins: Floats, ways: Floats, far: float) -> Flags:
        hits = self.caster.cast(origins, ways, far=far, cuts=self.cuts, pixel=(self.view.pixel, 0.0))
        return hits.met

    def _light(self, sight: Sight, colours: Light, shares: Single, is_lit: bool) -> Single:
        """The linear light (m, 3) of what a sight meets."""
        light = np.asarray(colours, np.float32)
        if is_lit:
            light = _lit(sight, light, shares)
        caps = np.flatnonzero(sight.leaf >= len(self.caster.leaves))
        if caps.size:
            light = light if light.flags.writeable else light.copy()
            light[caps] = hatched(sight.column[caps], sight.row[caps], self.view.size)
        return light

    def _refined(
        self, sight: Sight, pixels: Ints, brush: Brush, colours: Colouring, shares: Single, samples: int
    ) -> Single:
        """What so many rays on a square lattice in each pixel show, together."""
        side = int(np.sqrt(samples))
        row, column = np.divmod(pixels, self.view.size[0])
        total = np.zeros((len(pixels), 4), np.float32)
        for i, j in np.ndindex(side, side):
            places = (column + (j + 0.5) / side - 0.5, row + (i + 0.5) / side - 0.5)
            seen = self.sight(*places)
            nearest = sight.number[pixels[seen.met]]
            total[seen.met, :3] += self._light(seen, colours(seen, nearest), shares[:, nearest], brush.lit)
            total[seen.met, 3] += 1.0
        return total


def _lit(sight: Sight, colours: Single, shares: Single) -> Single:
    """Colours in the light of printed pictures."""
    result = np.empty((len(colours), 3), np.float32)
    turn = sight.view.axes.astype(np.float32)
    for start in range(0, len(colours), BATCH):
        part = slice(start, start + BATCH)
        x, y, z = sight.normals[part].T.astype(np.float32)
        right, up, towards = (row[0] * x + row[1] * y + row[2] * z for row in turn)
        dark, key, sky = shares[:, part]
        diffuse, shine = lit(right, up, np.maximum(towards, np.float32(0.0)), key, sky)
        for channel in range(3):
            result[part, channel] = (colours[part, channel] * diffuse + shine) * dark
    return result.clip(0.0, 1.0)
