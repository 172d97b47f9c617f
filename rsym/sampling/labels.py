"""Labels: which parts of a shape points of its boundary belong to, for meshes, rays, rules and pictures alike.

An engine says which leaf it found at a point. Of which face of that, or of another leaf that runs there too, the values
of all leaves say: those that are zero to rounding change their sign here, and the walk of `rsym.logic.faces` goes down
to the faces with which the form does. Leaves whose gradient has another direction there are those across an edge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.arrays import Flags, Floats, Integers, Ints
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.errors import RsymError
from rsym.logic.faces import BETWEEN, Faces, shape_faces
from rsym.logic.gates import through
from rsym.logic.leaf_names import face_names, shape_leaf_names
from rsym.logic.sign_form import shape_form
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.program.differentiation import derivative

BOUNDARY = "boundary"
AT_ONCE = 2**20  # values of leaves and places
# Beyond so many leaves only those that stand in several parts are looked at: two formulas of one surface are not found.
FEW = 256
NEWTON_STEPS = 3
# As a share of the largest coordinate: planes so near to each other are one; the sine of the angle of their normals.
NEAR, PARALLEL = 1e-12, 1e-5
ON_BOUNDARY = 1e-9
LEAST: Mapping[str, Any] = {"min": np.minimum, "max": np.maximum}


@dataclass(frozen=True, eq=False)
class Labels:
    """What points are called.

    Attributes
    ----------
    number : (n,)
        Of the name of each point, -1 where there is none.
    names : tuple of str
        Those of single faces in the order of the leaves, whether a point has them or not, then ``A / B`` of several.
    parts : tuple of tuples of str
        For each name the parts that have a face so called.
    """

    number: Ints
    names: tuple[str, ...]
    parts: tuple[tuple[str, ...], ...]

    def require(self, part: str, *others: str) -> None:
        """Refuse what is no part, nor one of the others that may be asked for."""
        single = [name for name in self.names if BETWEEN not in name]
        if part not in (*others, *self.names) and not {*part.split(BETWEEN)} <= {*single}:
            there = ", ".join(dict.fromkeys((*others, *single)))
            raise RsymError(f"no part {part!r}", code="unknown-part", remedy=f"choose from {there}")

    def on(self, part: str) -> Flags:
        """Which points lie on a part, or on the ``boundary``; where several coincide, on each of them."""
        if part == BOUNDARY:
            return np.ones(len(self.number), np.bool_)
        held = np.array([part == name or part in name.split(BETWEEN) for name in self.names] + [False])
        return np.asarray(held[self.number])

    @property
    def each(self) -> NDArray[Any]:
        """The names of the points, empty where there is none."""
        return np.array([*self.names, ""])[self.number]


def labels_of(leaf: ArrayLike, leaves: Sequence[str]) -> Labels:
    """The labels of what is called like its leaf.

    Examples
    --------
    >>> found = labels_of(np.array([2, 0]), ("side", "lid", "side"))
    >>> found.number.tolist(), found.names
    ([0, 0], ('side', 'lid'))
    """
    names = tuple(dict.fromkeys(leaves))
    table = np.array([*map(names.index, leaves), -1])
    return Labels(table[np.asarray(leaf, np.int64)], names, tuple((name,) for name in names))


@dataclass(frozen=True, eq=False)
class Labeller:
    """What asks for the labels of points on the boundary of a shape at letters; `behind` its leaves are more names.

    Examples
    --------
    >>> import rsym
    >>> pair = rsym.rectangle(2, 1).named("A") | rsym.rectangle(2, 1).translate(1, 0).named("B")
    >>> lids = np.array([[-0.5, 0.5], [0.5, 0.5], [1.5, 0.5]])
    >>> Labeller(pair)(lids, np.array([1, 1, 1])).each.tolist()
    ['A', 'A / B', 'B']
    """

    shape: Shape
    letters: Mapping[Any, float] | None = None
    behind: tuple[str, ...] = ()

    def __call__(self, points: Floats, leaf: Integers) -> Labels:
        """The labels of points (n, dim) that were found on leaves (n,)."""
        behind = self.behind
        faces, own = shape_faces(self.shape), face_names(self.shape)
        count = len(faces.form.leaves)
        number, met = self._sets(points, leaf, count + len(behind))
        of_leaf = [tuple(k for k, face in enumerate(faces.faces) if face.leaf == leaf) for leaf in range(count)]
        titles = [BETWEEN.join(faces.title(chosen)) or own[chosen[0]] for chosen in (*of_leaf, *met)]
        titles[count:count] = behind
        single = (*own, *behind)
        there = {titles[k] for k in np.unique(number[number >= 0]).tolist()}
        joint = sorted(there - {*single}, key=lambda title: [*map(single.index, title.split(BETWEEN))])
        names = tuple(dict.fromkeys((*single, *joint)))
        place = {name: number for number, name in enumerate(names)}
        table = np.array([*(place.get(title, -1) for title in titles), -1])
        held: list[dict[str, None]] = [{name: None} if name in behind else {} for name in names]
        for chosen in (*((k,) for k in range(len(own))), *met):
            title = BETWEEN.join(faces.title(chosen)) or own[chosen[0]]
            held[place[title]].update(dict.fromkeys(faces.holding(chosen) or (title,)))
        return Labels(table[number], names, tuple(map(tuple, held)))

    def nearest(self, points: Floats) -> Labels:
        """The labels of points, each on the leaf that is nearest to it."""
        value, gradient = self._values(points)
        with np.errstate(all="ignore"):
            away = np.nan_to_num(np.abs(value) / np.sqrt(np.einsum("kin,kin->kn", gradient, gradient)), nan=np.inf)
        return self(points, away.argmin(axis=0))

    def onto(self, points: Floats, leaf: Ints | None = None) -> tuple[Floats, Floats, Flags]:
        """Points (n, dim) moved onto the leaves that give the form its value, their normals, which are on the boundary.

        With leaves (n,) onto these.

        Examples
        --------
        >>> import rsym
        >>> square = rsym.rectangle(2, 2)
        >>> places, _, there = Labeller(square).onto(np.array([[0.5, 0.99], [1.01, 0.75]]))
        >>> places.round(9).tolist(), there.tolist()
        ([[0.5, 1.0], [1.0, 0.75]], [True, True])
        """
        every, size = np.arange(len(points)), np.abs(points).max(initial=0.0)
        leaf = self._active_leaf(self._values(points)[0]) if leaf is None else leaf
        places, value, gradient = self._on_leaf(points, leaf)
        leaf = self._active_leaf(value)
        with np.errstate(all="ignore"):
            slope = gradient[leaf, :, every]
            length = np.linalg.norm(slope, axis=1)
            there = np.abs(value[leaf, every]) <= ON_BOUNDARY * size * length
            return places, slope / length[:, None], there & (length > 0)

    def there(self, title: str, points: Floats, within: float) -> str:
        """What the leaves of a title are called where they pass points (n, dim), to a distance `within`.

        Examples
        --------
        >>> import rsym
        >>> pair = rsym.rectangle(2, 1).named("A") | rsym.rectangle(2, 1).translate(3, 0).named("B")
        >>> Labeller(pair).there("A / B", np.array([[-1, 0.5], [1, 0.5]]), 1e-9)
        'A'
        """
        if BETWEEN not in title:
            return title
        value, gradient = self._values(points)
        names: dict[str, None] = {}
        for leaf in (leaf for leaf, name in enumerate(shape_leaf_names(self.shape)) if name == title):
            some = points[np.abs(value[leaf]) <= within * np.linalg.norm(gradient[leaf], axis=0)]
            names.update(dict.fromkeys(self(some, np.full(len(some), leaf)).each.tolist()))
        single = {name for one in names for name in one.split(BETWEEN)}
        return BETWEEN.join(name for name in title.split(BETWEEN) if name in single) or title

    def leaves(self, points: Floats, leaf: Integers) -> Ints:
        """The leaves (n,) that bound the body at points: those that were found, or one of the same place."""
        faces = shape_faces(self.shape)
        most = max(len(faces.form.leaves), int(np.max(leaf, initial=0)) + 1)
        number, met = self._sets(points, leaf, most)
        found = np.array(leaf, np.int64)
        for k, chosen in enumerate(met):
            there = [faces.faces[one].leaf for one in chosen]
            found[(number == most + k) & ~np.isin(found, there)] = there[0]
        return found

    def _active_leaf(self, value: Floats) -> Ints:
        """The leaf that gives the form its value, the first of several."""
        return np.asarray((value == _made(shape_faces(self.shape), value)[-1]).argmax(axis=0))

    def _sets(self, points: Floats, leaf: Integers, first_set: int) -> tuple[Ints, Sequence[tuple[int, ...]]]:
        """Of each point the leaf where that tells the face, else the number of a set of faces plus `first_set`."""
        faces = shape_faces(self.shape)
        count = len(faces.form.leaves)
        number = np.array(leaf, np.int64)
        met: dict[tuple[int, ...], int] = {}
        (asked,) = np.nonzero((number >= 0) & (number < count) & _asked(faces)[np.minimum(number, count)])
        size = max(1, AT_ONCE // (len(faces.places) + 4 * count))
        for first in range(0, len(asked), size):
            some = asked[first : first + size]
            doubtful, active = self._active(points[some], number[some])
            packed = np.packbits(active, axis=0).T
            _, one, which = np.unique(packed, axis=0, return_index=True, return_inverse=True)
            sets = [met.setdefault(tuple(np.flatnonzero(active[:, k]).tolist()), len(met)) for k in one]
            number[some[doubtful]] = first_set + np.array(sets, np.int64)[which.ravel()]
        return number, tuple(met)

    def _active(self, points: Floats, leaf: Ints) -> tuple[Ints, Flags]:
        """The points on leaves of which it takes a walk to know the face, and which faces (k, n) are active there."""
        faces, every = shape_faces(self.shape), np.arange(len(leaf))
        points, value, gradient = self._on_leaf(points, leaf)
        with np.errstate(all="ignore"):
            length = np.sqrt(np.einsum("kin,kin->kn", gradient, gradient))
            near = np.abs(value) <= NEAR * (np.abs(points).max(initial=1e-300) * length)
            slope = np.einsum("kin,in->kn", gradient, gradient[leaf, :, every].T)
            here = near & (np.abs(slope) >= np.sqrt(1 - PARALLEL**2) * length * length[leaf, every])
        near[leaf, every] = here[leaf, every] = True
        slope[leaf, every] = 1.0
        value[near] = 0.0
        (doubtful,) = np.nonzero((here.sum(axis=0) > 1) | np.isin(leaf, list(faces.shared)))
        value, here, leaf = value[:, doubtful], here[:, doubtful], leaf[doubtful]
        # What leaves change to from one side of the surface to the other: two that change against each other, as the
        # lid of one box and the floor of the next, may be a face of neither.
        turn = np.where(here, np.sign(slope[:, doubtful]), 0.0)
        sides = np.stack([np.sign(value) + turn, np.sign(value) - turn], axis=1)
        active = np.array(faces.active(list(sides), _alike, LEAST, np.ones(len(leaf), np.bool_)))
        found = active & here[[face.leaf for face in faces.faces]]
        lost = ~found.any(axis=0)  # beside an edge of bent leaves, where the point is on the continuation of one
        if lost.any():
            found[:, lost] = self._nearest(value[:, lost], leaf[lost])
        return doubtful, np.asarray(found)

    def _nearest(self, value: Floats, leaf: Ints) -> Flags:
        """Of the faces of each leaf those on whose way down values are least apart."""
        faces = shape_faces(self.shape)
        made = _made(faces, value)
        apart: list[Floats] = []
        for place in faces.places:
            ways = [
                np.maximum(apart[above], np.abs(made[place.operand] - made[faces.places[above].operand]))
                for above in place.above
            ]
            apart.append(np.minimum.reduce(ways) if ways else np.zeros(value.shape[1]))
        off = np.nan_to_num(np.array([apart[end] for end in faces.ends]), nan=np.inf)
        off[np.array([face.leaf for face in faces.faces])[:, None] != leaf] = np.nan
        return np.asarray(off == np.nanmin(off, axis=0))

    def _on_leaf(self, points: Floats, leaf: Ints) -> tuple[Floats, Floats, Floats]:
        """Points (n, dim) moved onto their leaves, where these are bent; values (k, n), gradients (k, dim, n) there."""
        every = np.arange(len(leaf))
        for step in range(NEWTON_STEPS + 1):
            value, gradient = self._values(points)
            own, slope = value[leaf, every], gradient[leaf, :, every]
            with np.errstate(all="ignore"):
                move = (own / np.einsum("ni,ni->n", slope, slope))[:, None] * slope
            move[~np.isfinite(move).all(axis=1)] = 0.0
            if step == NEWTON_STEPS or not (np.abs(move) > NEAR / 100 * np.abs(points).max(initial=0.0)).any():
                break
            points = points - move
        return points, value, gradient

    def _values(self, points: Floats) -> tuple[Floats, Floats]:
        """The values (k, n) and gradients (k, dim, n) of all leaves at points (n, dim)."""
        kernel = _leaf_kernel(self.shape)
        given = self.shape.letters.values_with(self.letters)  # those of the kernel are of the shape it was made for
        out = np.empty((len(kernel.program.outputs), len(points)))
        letters = [given[name] for name in kernel.program.letters]
        run_in_blocks(kernel.function, list(points.T.copy()), letters, out, kernel.threads)
        parts = out.reshape(-1, 1 + self.shape.dimension, len(points))
        return parts[:, 0], parts[:, 1:]


def _made(faces: Faces, value: Floats) -> list[Floats]:
    """The values of the leaves, then those of the gates."""
    return through(faces.form.gates, list(value), lambda gate, one, other: LEAST[gate.operation](one, other))


def _alike(one: Floats, other: Floats) -> Flags:
    """Where both signs (2, n) are the same."""
    return np.asarray((one == other).all(axis=0))


def _asked(faces: Faces) -> Flags:
    """On which leaves it takes a look to know the face; on none, behind them."""
    count = len(faces.form.leaves)
    asked = np.full(count + 1, (faces.told_apart or faces.doubled) and count <= FEW)
    asked[list(faces.shared)] = True
    asked[count] = False
    return asked


@recently(16, written)
def _leaf_kernel(shape: Shape) -> Kernel:
    """Value and gradient of each leaf."""
    form = shape_form(shape)
    builder = form.builder
    outputs = {}
    for k, leaf in enumerate(form.leaves):
        outputs[f"leaf_{k}"] = leaf
        outputs.update({f"leaf_{k}_{name}": derivative(builder, leaf, name) for name in builder.coordinates})
    return compile_program(builder.program(outputs), (), shape)
