"""Rows: the signs of the atoms of a shape at points that tell where a form has to be positive, and where zero.

A literal is an atom, numbered 2*k, or minus it, 2*k + 1; it holds where it is positive. A row says which literals hold
at a point. Inside, all over and on each atom, those are rows of which a form that is zero on the boundary alone has to
hold, zeros counted as false; on the boundary one of which it must not.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.seams.atoms import SignAtoms, Signs

LATTICE = {2: 65, 3: 17}  # points along each axis
FAR = 2.5, 20.0, 400.0  # times as large are lattices that tell what is outside
OFF = 0.4142  # of a cell: where its point is, for shapes lie on round numbers
NEWTON_STEPS = 8
APART, ON = 1e-4, 1e-10  # of the size: nearer to another atom a point tells nothing; so near it is on its own
PARALLEL = 1e-9  # one less the cosine of atoms that run along each other
MOST_MEETING = 60  # atoms of which all pairs are looked at for points in common
AROUND = 16  # directions from a point where atoms meet
ONTO = 3  # steps of Newton's from there onto an atom


class SignRows(NamedTuple):
    """What holds at points.

    Attributes
    ----------
    inside, outside : (n, literals)
    boundary : (n, literals)
        On one atom each, the literal of which holds inside of the boundary: `own` (n,).
    places : (n, dim)
        Of the rows on the boundary.
    seams : (n, dim)
        Points inside where the form, as it is, is zero.
    """

    inside: Flags
    outside: Flags
    boundary: Flags
    own: Ints
    places: Floats
    seams: Floats

    def joined(self, other: SignRows) -> SignRows:
        """Both."""
        return SignRows(*(np.concatenate([one, two]) for one, two in zip(self, other, strict=True)))


def literals(signs: Signs) -> Flags:
    """Which literals (n, literals) hold, of the signs (atoms, n)."""
    found: Flags = np.stack([signs > 0, signs < 0], axis=1).reshape(2 * len(signs), -1).T
    return found


def lattice(atoms: SignAtoms) -> Floats:
    """Points all over the box, and a little beyond."""
    count = LATTICE[atoms.shape.dimension]
    axes = [low + (high - low) * ((np.arange(count) + OFF) * 1.04 / count - 0.02) for low, high in atoms.box]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def rows_of(atoms: SignAtoms) -> SignRows:
    """The rows that a lattice finds."""
    places = lattice(atoms)
    middle = np.array(atoms.box, float).mean(axis=1)
    found = rows_at(atoms, np.concatenate([places, *(middle + times * (places - middle) for times in FAR)]))
    near = 1.5 * atoms.size / LATTICE[atoms.shape.dimension]
    return found.joined(rows_on(atoms, places, near)).joined(rows_where_atoms_meet(atoms, places))


def _made(atoms: SignAtoms, points: Floats, signs: Signs, one: Flags, other: Flags, literal: int) -> SignRows:
    """The rows of points whose form is positive on both sides of an atom, on one, or on the other."""
    told = literals(signs)
    both, neither = one & other, ~(one | other)
    bounds = [(one & ~other, literal), (other & ~one, literal + 1)]
    zero = np.array(atoms.inside(signs) <= 0)
    return SignRows(
        told[both],
        told[neither],
        np.concatenate([told[on] for on, _ in bounds]),
        np.concatenate([np.full(on.sum(), own) for on, own in bounds]),
        np.concatenate([points[on] for on, _ in bounds]),
        points[both & zero],
    )


def rows_at(atoms: SignAtoms, points: Floats) -> SignRows:
    """The rows of points that lie on no atom."""
    signs = atoms.signs(points)
    clear = (signs != 0).all(axis=0)
    positive = atoms.inside(signs[:, clear]) > 0
    return _made(atoms, points[clear], signs[:, clear], positive, positive, 0)


def rows_on(atoms: SignAtoms, points: Floats, near: float) -> SignRows:
    """The rows of points slid onto each atom that they are near to."""
    found = [rows_at(atoms, points[:0])]
    values = atoms.at(points)
    with np.errstate(all="ignore"):
        close = np.abs(values[:, 0]) <= near * np.linalg.norm(values[:, 1:], axis=1)
    for atom in range(atoms.count):
        places = slid(atoms, (atom,), points[close[atom]])
        away = _away(atoms, places)
        others = np.delete(away, atom, axis=0) > APART * atoms.size
        on = (away[atom] < ON * atoms.size) & _within(atoms, places)
        found.append(_rows_along(atoms, atom, places[on & ~others.all(axis=0)]))
        places = places[on & others.all(axis=0)]
        signs = atoms.signs(places)
        sides = []
        for side in (1, -1):
            signs[atom] = side
            sides.append(atoms.inside(signs) > 0)
        signs[atom] = 0
        found.append(_made(atoms, places, signs, sides[0], sides[1], 2 * atom))
    return SignRows(*map(np.concatenate, zip(*found, strict=True)))


def _rows_along(atoms: SignAtoms, atom: int, points: Floats) -> SignRows:
    """The rows of those points on an atom where others, of other formulas, run along it."""
    slopes = atoms.at(points)[:, 1:]
    with np.errstate(all="ignore"):
        slopes = slopes / np.linalg.norm(slopes, axis=1, keepdims=True)
        across = np.abs(np.einsum("kdn,dn->kn", slopes, slopes[atom]))
    together = (_away(atoms, points) < ON * atoms.size) & (across > 1 - PARALLEL)
    alone = ((_away(atoms, points) > APART * atoms.size) | together).all(axis=0) & (together.sum(axis=0) > 1)
    points, together, way = points[alone], together[:, alone], slopes[atom][:, alone].T
    step = APART * atoms.size * way
    sides = [np.array(atoms.inside(atoms.signs(points + one)) > 0) for one in (step, -step)]
    signs = np.where(together, 0, atoms.signs(points)).astype(np.int8)
    return _made(atoms, points, signs, sides[0], sides[1], 2 * atom)


def rows_where_atoms_meet(atoms: SignAtoms, points: Floats) -> SignRows:
    """The rows inside of points that several atoms pass: parts that touch there leave a zero in nothing but a point."""
    found = [rows_at(atoms, points[:0])]
    if atoms.count <= MOST_MEETING:
        some = points[:: max(1, len(points) // 200)]
        for pair in combinations(range(atoms.count), 2):
            found.append(rows_around(atoms, slid(atoms, pair, some)))
    return SignRows(*map(np.concatenate, zip(*found, strict=True)))


def rows_around(atoms: SignAtoms, points: Floats) -> SignRows:
    """The rows of those points around which all is inside, atoms that pass there counted as zero."""
    points = points[np.isfinite(points).all(axis=1)]
    points = points[_within(atoms, points)]
    points = np.unique(points.round(9), axis=0)
    dimension = atoms.shape.dimension
    ways = np.random.default_rng(37).normal(size=(AROUND * (dimension - 1) ** 2, dimension))
    ways *= APART * atoms.size / np.linalg.norm(ways, axis=1, keepdims=True)
    near = (points[:, None] + ways).reshape(-1, dimension)
    inside: Flags = np.asarray((atoms.inside(atoms.signs(near)) > 0).reshape(-1, len(ways)).all(axis=1))
    for atom in range(atoms.count):
        inside[inside] = _inside_along(atoms, atom, points[inside], ways)
    points = points[inside]
    signs = atoms.signs(points)
    signs[_away(atoms, points) < ON * atoms.size] = 0
    every = np.array(atoms.inside(signs) > 0) | (signs == 0).any(axis=0)
    return _made(atoms, points, signs, every, every, 0)


def _inside_along(atoms: SignAtoms, atom: int, points: Floats, ways: Floats) -> Flags:
    """Whether on both sides of an atom all is inside, next to points: between parts that touch no sector is open."""
    found = np.ones(len(points), np.bool_)
    passing = np.flatnonzero(_away(atoms, points)[atom] < ON * atoms.size)
    near = (points[passing, None] + ways).reshape(-1, points.shape[1])
    for _ in range(ONTO):
        value, *slopes = atoms.at(near)[atom]
        near = near - (value / np.sum(np.square(slopes), axis=0) * np.array(slopes)).T
    signs = atoms.signs(near)
    for side in (1, -1):
        signs[atom] = side
        found[passing] &= np.array(atoms.inside(signs) > 0).reshape(-1, len(ways)).all(axis=1)
    return found


def slid(atoms: SignAtoms, chosen: tuple[int, ...], points: Floats) -> Floats:
    """Points moved by Newton's method to where some atoms are zero."""
    for _ in range(NEWTON_STEPS * len(chosen)):
        if not len(points):
            break
        found = atoms.at(points)[list(chosen)]
        value, slope = found[:, 0].T, found[:, 1:].transpose(2, 0, 1)  # (n, k), (n, k, dim)
        square = np.einsum("nkd,nld->nkl", slope, slope)
        good = np.isfinite(square).all(axis=(1, 2)) & np.isfinite(value).all(axis=1)
        points, value, slope, square = points[good], value[good], slope[good], square[good]
        with np.errstate(all="ignore"):
            size = np.linalg.det(square) / np.prod(np.einsum("nkk->nk", square), axis=1)
        good = size > ON
        points, value, slope, square = points[good], value[good], slope[good], square[good]
        points = points - np.einsum("nkd,nk->nd", slope, np.linalg.solve(square, value[:, :, None])[:, :, 0])
        points = points[np.abs(points).max(axis=1, initial=0) < 1e3 * (np.abs(np.array(atoms.box)).max() + atoms.size)]
    return points


def _away(atoms: SignAtoms, points: Floats) -> Floats:
    """How far points are from each atom, by its slope there (atoms, n)."""
    found = atoms.at(points)
    with np.errstate(all="ignore"):
        away: Floats = np.abs(found[:, 0]) / np.linalg.norm(found[:, 1:], axis=1)
        return away


def _within(atoms: SignAtoms, points: Floats) -> Flags:
    low, high = np.array(atoms.box, float).T
    there: Flags = ((points >= low) & (points <= high)).all(axis=1)
    return there
