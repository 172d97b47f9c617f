"""One colour for each part of a mesh: what its leaves are called."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.output.shading import linear
from rsym.sampling.mesh import Mesh

# Paul Tol's "light" scheme and the darker colours of his "muted" one: told apart with each kind of colour vision.
# Behind them, one after the other, the colour that is farthest from all before in Oklab, as it is seen and with the
# cones of one kind missing (Machado, Oliveira and Fernandes, 2009); a car has twenty names.
PALETTE = (
    *("#77aadd", "#ee8866", "#44bb99", "#ffaabb", "#aaaa00", "#eedd88", "#99ddff", "#bbcc33", "#dddddd"),
    *("#aa4499", "#117733", "#cc6677", "#332288", "#999933", "#882255"),
    *("#0077dd", "#664400", "#5544bb", "#9988ff", "#cc3333", "#7788aa", "#554477", "#660066", "#666666", "#22ccff"),
    *("#7766bb", "#99ffbb", "#773399"),
)


def part_colours(mesh: Mesh) -> dict[str, str]:
    """The parts that are on the surface, in the order of the leaves, each with its colour.

    A part keeps its colour when letters change. If there are more parts than
    colours some share one, but not parts that meet.

    Raises
    ------
    RsymError
        If the mesh does not know its leaves.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> part_colours(Mesh(corners, faces, leaf=np.array([0, 0, 0, 2]), leaves=("sides", "none", "slope")))
    {'sides': '#77aadd', 'slope': '#44bb99'}
    """
    if mesh.leaf is None:
        raise RsymError("this mesh does not know its parts", code="parts", remedy='mesh the shape with method="sharp"')
    return colours_of(mesh.parts, np.unique(mesh.part).tolist(), [feature.names for feature in mesh.features])


def colours_of(leaves: Sequence[str], seen: Iterable[int], meet: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The colours of the parts that leaves have the names of, for the leaves that are seen; and which parts meet.

    Examples
    --------
    >>> colours_of(("sides", "none", "slope"), [0, 2], [])
    {'sides': '#77aadd', 'slope': '#44bb99'}
    """
    names = list(dict.fromkeys(leaves))
    beside: dict[str, set[str]] = {name: set() for name in names}
    if len(names) > len(PALETTE):
        for first, second in meet:
            beside[first].add(second)
            beside[second].add(first)
    colours: dict[str, str] = {}
    for number, name in enumerate(names):
        turned = [PALETTE[(number + k) % len(PALETTE)] for k in range(len(PALETTE))]
        taken = {colours.get(other) for other in beside[name]}
        colours[name] = next((colour for colour in turned if colour not in taken), turned[0])
    known = {leaves[leaf] for leaf in seen}
    return {name: colour for name, colour in colours.items() if name in known}


def face_colours(mesh: Mesh) -> NDArray[np.float64]:
    """The linear colour of each face by its part, (m, 3)."""
    colours = part_colours(mesh)
    table = np.array([linear(colours.get(name, PALETTE[0])) for name in mesh.parts])
    return table[mesh.part]
