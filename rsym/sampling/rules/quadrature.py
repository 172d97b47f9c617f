"""Gauss rules on shapes: points and weights inside and on the boundary, cell by cell."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats, Ints
from rsym.backends.kernel import checked_threads, lasting_threads
from rsym.errors import RsymError, warn
from rsym.logic.sign_form import shape_form
from rsym.model.requirements import optional_package, require_count, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.sampling.labels import Labeller, Labels, labels_of
from rsym.sampling.rules.columns import CellRule, rules_joined
from rsym.sampling.rules.division import (
    INSIDE,
    OPEN,
    Grading,
    close,
    undivided,
)
from rsym.sampling.rules.portions import CellGrid, DividedCells, RulePortion
from rsym.sampling.windows import bounds_or_extent

ORDER = 8
PAIRS = 2**17  # of cells and leaves that are looked at at once
CUT_AT_ONCE = 1024  # cells that the boundary may cross, of which rules are made at once
POINTS = 2**20  # of such rules, about
ASIDE = np.array([0.381966, 0.414214, 0.442777])  # of a cell, as lattices of meshes are


@dataclass(frozen=True, eq=False)
class BoundaryQuadrature:
    """A rule on a boundary: points (m, dim), weights (m,), outward unit normals (m, dim), leaves and cells (m,).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y)).named("disc")
    >>> half = rsym.quadrature(disc & rsym.Shape(y, (x, y)).named("cut"), cells=8)
    >>> half.parts, float(half.boundary.of("cut").weights.sum().round(12))
    (('disc', 'cut'), 2.0)
    >>> half.boundary.of("cut").normals[0].tolist()
    [-0.0, -1.0]
    """

    points: Floats
    weights: Floats
    normals: Floats
    leaves: Ints
    cells: Ints
    parts: tuple[str, ...]
    called: Callable[[Floats, Ints], Labels] | None = field(default=None, repr=False)

    @cached_property
    def labels(self) -> Labels:
        """Which parts the points belong to."""
        given = self.called
        return labels_of(self.leaves, self.parts) if given is None else given(self.points, self.leaves)

    def of(self, part: str) -> BoundaryQuadrature:
        """What lies on a part; where others coincide with it, on each of them."""
        self.labels.require(part)
        some = self.labels.on(part)
        return replace(
            self,
            points=self.points[some],
            weights=self.weights[some],
            normals=self.normals[some],
            leaves=self.leaves[some],
            cells=self.cells[some],
        )


@dataclass(frozen=True, eq=False)
class Quadrature:
    """A rule on a shape: the integral of f is ``sum(weights * f(points))``, on its boundary likewise.

    Attributes
    ----------
    points : (n, dim)
        Inside, sorted by cell.
    weights, cells : (n,)
        The cell is its number in the grid.
    grid : CellGrid
        What was divided.
    full : (f,)
        Cells that the shape fills. Their points are those of the plain Gauss rule, the last coordinate fastest,
        except in cells graded towards a point.
    touched : (t,)
        Cells that the shape meets.
    parts : tuple of str
        The names of the leaves.
    boundary : BoundaryQuadrature
        The rule on the boundary.
    order : int
        Points along each direction; fewer in small parts of cells graded towards corners with functions of their own.
    unresolved : float
        The measure of what is left of cells, divided as far as it goes, in which the heights of leaves are not proved
        to be graphs, and in the plane of squares of where two leaves touch: the rule may be wrong there.
    closed : (k, 2)
        Touched cells next to each other between which nothing of the shape lies, where a problem has looked for them.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rule = rsym.quadrature(rsym.Shape(1 - x**2 - y**2, (x, y)), cells=8, order=6)
    >>> rule.grid.counts, len(rule.full), len(rule.touched)
    ((8, 8), 32, 60)
    """

    points: Floats
    weights: Floats
    cells: Ints
    grid: CellGrid
    full: Ints
    touched: Ints
    parts: tuple[str, ...]
    boundary: BoundaryQuadrature
    order: int
    unresolved: float
    closed: Ints = field(default_factory=lambda: np.empty((0, 2), np.int64))


def quadrature(
    shape: Shape,
    *,
    cells: int = 32,
    order: int = ORDER,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    near: ArrayLike | None = None,
    threads: int | None = None,
) -> Quadrature:
    """Gauss rules on a shape and on its boundary, which know every leaf of its sign form and every corner.

    A cell is divided until along one axis every leaf that matters in it rises or falls, proved by intervals, or does
    not change. There: Gauss points along the base, between the places where a leaf meets the ends of the piece or
    another leaf; on the line above each, the roots of leaves; Gauss points between roots where the gates of the form
    say inside. In space the base is a plane and treated likewise. On the boundary, at the roots, with base weight db:

        ds = |grad f|/|f_k| db

    All points are inside, all weights positive. Where a leaf is undefined is outside. Where two leaves touch, crossings
    closer than rounding are one: the length of each may lack 1e-7 there. R-functions of any system, normalised or not,
    give the same rule.

    Parameters
    ----------
    shape : Shape
        In the plane or in space. Its boundary must be piecewise smooth for the rule to be accurate.
    cells : int
        Cubical cells along the longest side.
    order : int
        Gauss points along each direction: exact to the degree 2 order - 1 in cells without boundary.
    bounds : pairs, optional
        Else the shape's own; both cap the shape, and their sides are parts ``cap x lower`` and so on. A shape without
        any has its `extent`. Own bounds that cut are warned of.
    letters : mapping, optional
        Override the defaults; nothing is compiled for them.
    near : (k, dim), optional
        Points, such as corners, towards which cells are halved up to 28 times, until they are small against their
        distance from them.
    threads : int, optional
        The bits do not depend on it.

    Raises
    ------
    RsymError
        ``unbounded`` without bounds for a shape that goes on for ever; for a number that is no positive integer.

    Warns
    -----
    RsymWarning
        Where the shape's own bounds cut it, as they may where letters or what is united with it make it larger.

    Source: R. I. Saye (2015), High-order quadrature methods for implicitly defined surfaces and volumes, SIAM J. Sci.
    Comput. 37.

    Examples
    --------
    >>> import math, rsym
    >>> from rsym import x, y
    >>> rule = rsym.quadrature(rsym.Shape(1 - x**2 / 4 - y**2, (x, y)))
    >>> bool(abs(rule.weights.sum() / (2 * math.pi) - 1) < 1e-14)
    True
    """
    return prepared(shape, bounds, letters).rule(cells, order, near, threads)


@dataclass(frozen=True)
class Prepared:
    """A shape at letters within bounds, ready for rules.

    `owner` is the leaf of the shape that each leaf of the functions comes from, and `parts` are the names of these;
    `sides` are those that are bounds nobody asked for: those that the shape states, or, if not `stated`, those of a box
    that holds its boundary. `called` labels points of these leaves. `walls` are those where the shape ends with its
    domain or at a pole: omega is not zero there, and nothing of them counts.
    """

    functions: Any
    box: Bounds
    parts: tuple[str, ...]
    owner: Ints
    sides: range = range(0)
    called: Labeller | None = None
    stated: bool = True
    walls: tuple[int, ...] = ()

    def labels(self, rule: CellRule) -> Labels:
        """Which parts the points of the boundary in a rule belong to."""
        leaves = self.owner[rule.edge_leaf]
        return labels_of(leaves, self.parts) if self.called is None else self.called(rule.edge_points.T, leaves)

    def rule(
        self, cells: int, order: int, near: ArrayLike | Grading | None = None, threads: int | None = None
    ) -> Quadrature:
        """The rule with so many cells along the longest side, and so many points along each direction of a cell."""
        grid = self.grid(cells)
        made = list(self.portions(grid, order, near, threads))
        made = made or [
            DividedCells.of(self.functions, grid, np.arange(0), grading(None, self.functions.dimension)).rule(order)
        ]
        rule = rules_joined([portion.rule for portion in made])  # by cell, as portions are
        _, gradient = self.functions.evaluate(rule.edge_leaf, rule.edge_points)
        normals = -(gradient / np.linalg.norm(gradient, axis=0)).T
        leaves = self.owner[rule.edge_leaf]
        if self.called is not None:
            leaves = self.called.leaves(rule.edge_points.T, leaves)
        self.warn_of_cuts(leaves)
        boundary = BoundaryQuadrature(
            rule.edge_points.T, rule.edge_weights, normals, leaves, rule.edge_owner, self.parts, self.called
        )
        full = np.concatenate([portion.full for portion in made])
        met = np.zeros(math.prod(grid.counts), np.bool_)
        met[rule.owner], met[rule.edge_owner] = True, True
        touched = np.flatnonzero(met)
        unresolved = sum(portion.unresolved.content for portion in made)
        return Quadrature(
            rule.points.T, rule.weights, rule.owner, grid, full, touched, self.parts, boundary, order, unresolved
        )

    @property
    def resolution(self) -> float:
        """How far a point of the boundary may be off for rounding."""
        return float(np.finfo(np.float64).eps) * max(abs(end) for pair in self.box for end in pair)

    def _require_finite(self, leaves: Ints, corners: tuple[Floats, Floats]) -> None:
        """Refuse one of these leaves, of which no cell knows bounds, if it has no value in the middle of any."""
        middles = (corners[0] + corners[1]) / 2
        for leaf in leaves:
            value, _ = self.functions.evaluate(np.full(middles.shape[1], leaf), middles)
            if not np.isfinite(value).any():
                raise RsymError(
                    f"{self.parts[self.owner[leaf]]} is infinite or undefined everywhere within the bounds",
                    code="undefined",
                    remedy="change the letters: for one of them it is divided by 0",
                )

    def warn_of_cuts(self, leaves: Ints) -> None:
        """Say which of the bounds that the shape states cut it, where the boundary is on these leaves."""
        cut = [self.parts[leaf].removeprefix("cap ") for leaf in np.unique(leaves) if leaf in self.sides]
        if cut and not self.stated:
            raise _unbounded()
        if cut:
            warn(
                f"the shape's own bounds cut it: {', '.join(cut)}; give bounds=shape.bounds if they are meant to, "
                "else bounds=rsym.extent(shape), or wider ones"
            )
        if np.isin(leaves, self.walls).any():
            warn(
                "the shape ends where a part of it has no value beyond, or at a pole: omega is not zero there, and "
                "that is not counted as boundary"
            )

    def grid(self, cells: int, aside: bool = False) -> CellGrid:
        """Cubical cells, so many along the longest side; moved `aside`, so that planes of symmetry are none of theirs.

        On these leaves cross, touch or are singular along sides of cells.
        """
        require_count("cells", cells, "the number of cells along the longest side, for example 32")
        size = max(high - low for low, high in self.box) / cells
        counts = tuple(max(1, math.ceil((high - low) / size - 1e-9)) for low, high in self.box)
        lower = np.array([low for low, _ in self.box], float)
        if aside:
            return CellGrid(lower - size * ASIDE[: len(counts)], size, tuple(count + 1 for count in counts))
        return CellGrid(lower, size, counts)

    def portions(
        self,
        grid: CellGrid,
        order: int,
        near: ArrayLike | Grading | None,
        threads: int | None,
        number: float = 1.0,
        until: float = math.inf,
        divided: dict[bytes, DividedCells] | None = None,
    ) -> Iterator[RulePortion]:
        """The rule in some cells after the other, in about so many portions or more; they depend on the grid alone.

        At a time of the monotonic clock they end with `OutOfTime`. Cells that were `divided` for a rule of another
        order are not divided again.
        """
        require_count("order", order, "the number of points along each direction of a cell, for example 8")
        towards = grading(near, self.functions.dimension)

        def make(cells: Ints) -> RulePortion:
            found = None if divided is None else divided.get(cells.tobytes())
            if found is None:
                found = DividedCells.of(self.functions, grid, cells, towards, until)
                if divided is not None:
                    divided[cells.tobytes()] = found
            portion = found.rule(order)
            on_walls = np.isin(self.owner[portion.rule.edge_leaf], self.walls)
            if not on_walls.any():
                return portion
            weights = np.where(on_walls, 0.0, portion.rule.edge_weights)
            return replace(portion, rule=replace(portion.rule, edge_weights=weights))

        least = order if divided is None else max(order, ORDER)
        some, count = self._some_cells(grid, least, towards, number), checked_threads(threads)
        many = count > 1 and len(some) > 1
        yield from lasting_threads("rsym-rules", count).map(make, some) if many else map(make, some)

    def _some_cells(self, grid: CellGrid, order: int, near: Grading, number: float) -> list[Ints]:
        """The cells that the shape may meet, in parts of about as much work."""
        functions = self.functions
        size = max(1, PAIRS // functions.count)
        every = np.arange(math.prod(grid.counts))
        cuts, fills = np.zeros(len(every), bool), np.zeros(len(every), bool)
        bounded = np.zeros(functions.count, bool)
        for first in range(0, len(every), size):
            cells = every[first : first + size]
            pieces = undivided(*grid.corners(cells), cells, functions.count)
            value, gradient = functions.enclose(
                pieces.leaf, pieces.lower[:, pieces.piece], pieces.upper[:, pieces.piece]
            )
            bounded[pieces.leaf[np.isfinite(value).any(axis=0)]] = True
            _, verdict, _ = functions.judge(replace(pieces, gradient=gradient), value)
            cuts[cells], fills[cells] = verdict == OPEN, verdict == INSIDE
            cuts[cells] |= close(pieces, near.points) & fills[cells]
        self._require_finite(np.flatnonzero(~bounded), grid.corners(every))
        points = order**functions.dimension
        share = max(1 / min(CUT_AT_ONCE, max(16, POINTS // (4 * points))), number / max(1, int(cuts.sum())))
        work = np.cumsum(cuts * share + fills * (points / POINTS))
        met = np.flatnonzero(cuts | fills)
        return [cells for cells in np.split(met, np.flatnonzero(np.diff(work[met].astype(np.int64))) + 1) if len(cells)]


def prepared(shape: Shape, bounds: Any, letters: Mapping[Any, float] | None, folds: tuple[Any, ...] = ()) -> Prepared:
    """A shape within the bounds given or stated, which cap it, else all of it.

    folds : expressions in its coordinates and letters; where one is zero inside, rules end and begin.
    """
    require_shape(shape)
    optional_package("numba", "a rule of integration")
    # Without numba the rest of the package can be imported.
    from rsym.sampling.rules.leaf_functions import LeafFunctions, rule_form

    known, whole = bounds_or_extent(shape, bounds, letters), bounds is None and shape.bounds is None
    form = rule_form(shape, not whole or shape.box is not None, folds)
    functions = LeafFunctions(shape, form.form, letters, known, np.isin(form.owner, form.walls))
    if whole and functions.sign(np.array([[low] for low, _ in known]))[0] > 0:
        raise _unbounded()
    own = 2 * shape.dimension if bounds is None and shape.box is not None else 0
    count = len(form.names)
    called = Labeller(shape, letters, form.names[len(shape_form(shape).leaves) :])
    sides = range(count - own, count)
    return Prepared(functions, known, form.names, form.owner, sides, called, not whole, form.walls)


def _unbounded() -> RsymError:
    return RsymError(
        "the inside of the shape is unbounded",
        code="unbounded",
        remedy="give bounds=((xmin, xmax), ...), or cut the shape off with a bounded one",
    )


def grading(near: ArrayLike | Grading | None, dimension: int) -> Grading:
    """Points (k, dim) from what was given."""
    if isinstance(near, Grading):
        return near
    found = np.empty((0, dimension)) if near is None else np.asarray(near, np.float64)
    if found.size and (found.ndim != 2 or found.shape[1] != dimension or not np.isfinite(found).all()):
        raise RsymError(
            f"expected finite points (k, {dimension}) near which cells are divided, got the shape {found.shape}",
            code="points",
            remedy="a row for each point",
        )
    return Grading(found.reshape(-1, dimension), np.zeros(len(found)))
