"""Exponents of elastic bodies and plates at corners, published and counted, and functions put into equations."""

import math

import numpy as np
import pytest

import rsym
from rsym import x, y
from rsym.problems.corners.corners import PlaneCorner, corners
from rsym.problems.corners.goursat import exponents, matrix, of_body, of_plate
from rsym.problems.corners.leaf_jets import leaf_jets
from rsym.problems.corners.wave_functions import wave_functions

FREE, HELD, ROLLER = (False, False), (True, True), (True, False)
STRAIN, STRESS = 3 - 4 * 0.3, 2.7 / 1.3  # Kolosov's number for Poisson's ratio 0.3
BOTH = rsym.disc(1) | rsym.disc(1, (1, 0))


def sector(angle, turn=0.0):
    """A corner with straight edges, the first in a direction."""
    normals = [(-math.sin(turn), math.cos(turn)), (math.sin(turn + angle), -math.cos(turn + angle))]
    return PlaneCorner((0.0, 0.0), angle, (0, 1), ("first", "second"), tuple(normals), 1.0)


@pytest.mark.parametrize(
    ("angle", "held", "kappa", "known"),
    [
        # M. L. Williams (1952); of the L with free and with fixed edges, and of the crack, as in the books.
        (1.5 * math.pi, (FREE, FREE), STRESS, [0.5444837367825, 0.9085291898461, 1.0]),
        (1.5 * math.pi, (HELD, HELD), STRAIN, [0.5951564, 0.7590420]),
        (2 * math.pi, (FREE, FREE), STRESS, [0.5, 1.0, 1.5, 2.0]),
        (0.5 * math.pi, (HELD, FREE), STRAIN, [0.71117293]),
        # A crack along a rigid face: 1/4 + k/2 + i*log(kappa)/(4*pi).
        (2 * math.pi, (HELD, FREE), STRAIN, [k / 2 + 0.25 + 1j * math.log(STRAIN) / (4 * math.pi) for k in range(3)]),
        (1.5 * math.pi, ((True, False), (False, True)), STRAIN, [1 / 3, 1.0]),
    ],
)
def test_published_exponents(angle, held, kappa, known):
    found = [one.rate for one in exponents(of_body(sector(angle), held, kappa).rows, 2.5)]
    np.testing.assert_allclose(found[: len(known)], known, rtol=0, atol=5e-8)


def test_a_clamped_plate_has_those_of_a_free_body_and_a_free_one_those_of_a_held_body():
    corner, nu = sector(1.5 * math.pi), 0.3
    for plate, body in (((2, 2), FREE), ((0, 0), HELD)):
        own, other = of_plate(corner, plate, nu), of_body(corner, (body, body), (3 + nu) / (1 - nu))
        both = ([one.rate for one in exponents(part.rows, 2.5)] for part in (own, other))
        np.testing.assert_allclose(*both, rtol=1e-13)
    supported = [one.rate.real for one in exponents(of_plate(corner, (1, 1), nu).rows, 2.5)]
    np.testing.assert_allclose(supported, [1 / 3, 1, 5 / 3, 7 / 3], rtol=1e-9)  # |k*2/3 -+ 1|


def counted(rows, low, high, tall):
    """How many zeros of the determinant lie in a rectangle: by how often it goes round 0."""
    ends = [low - 1j * tall, high - 1j * tall, high + 1j * tall, low + 1j * tall]
    way = np.concatenate([np.linspace(p, q, 4000) for p, q in zip(ends, [*ends[1:], ends[0]], strict=True)])
    turns = np.diff(np.unwrap(np.angle(np.linalg.det(matrix(way, rows)))))
    assert np.abs(turns).max() < 1
    return turns.sum() / (2 * math.pi)


def test_no_exponent_is_missed():
    generator = np.random.default_rng(3)
    for _ in range(25):
        angle, turn, kappa = generator.uniform(0.4, 6.2), generator.uniform(0, 6), generator.uniform(1.05, 2.9)
        held = [[FREE, HELD, ROLLER][k] for k in generator.integers(0, 3, 2)]
        double = held == [ROLLER, ROLLER]  # along one direction, that of neither edge
        rows = of_body(sector(angle, turn), held, kappa).rows
        found = exponents(rows, 2.52)
        assert all(one.simple != double for one in found)
        wanted = sum(one.ways.shape[1] * (2 if one.rate.imag or double else 1) for one in found)
        assert round(counted(rows, 0.08, 2.52, 12 / angle), 6) == wanted
        for rate, ways, _ in found:
            sizes = np.linalg.svd(matrix(rate, rows), compute_uv=False)
            assert sizes[-1] < 1e-12 * sizes[0]
            assert ways.shape[1] == np.count_nonzero(sizes < 1e-8 * sizes[0])


def on_edge(shape, corner, edge, distance):
    """A point of an edge so far away, and the normal there."""
    point = np.array(corner.point) + distance * corner.edges[edge]
    for _ in range(5):
        value, *slope = leaf_jets(shape, corner.leaves).at(point[None])[edge, :3, 0]
        point = point - value * np.array(slope) / np.dot(slope, slope)
    return point[None], np.array(slope) / np.hypot(*slope)


@pytest.mark.parametrize("held", [(FREE, FREE), (HELD, HELD), (HELD, FREE)])
def test_at_curved_edges_equations_and_conditions_are_met_to_the_second_order(held):
    """Lame's numbers 1.5 and 1, so kappa = 1.8; an error of the first order would be a tenth, a hundredth."""
    first, shear = 1.5, 1.0
    corner = corners(BOTH)[0]
    found = wave_functions(BOTH, corner, of_body(corner, held, 1.8), power=5)
    powers = np.array([term.exponent for term in found.terms])
    leading = np.array(
        [
            not term.level and abs(rate - round(rate.real)) > 1e-9
            for term in found.terms
            for rate in [found.rates[term.function]]
        ]
    )

    def gradient(jets):
        return jets.reshape(2, -1, len(powers))[:, 1:3]

    for distance in (1e-2, 1e-3):
        middle = corner.edges.sum(axis=0) * (-1 if corner.is_reentrant else 1)
        point = np.array(corner.point) + distance * middle / np.hypot(*middle)
        (u, v) = found.derivatives(point[None], 2)[0].reshape(2, 6, -1)
        force = [
            shear * (u[3] + u[5]) + (first + shear) * (u[3] + v[4]),
            shear * (v[3] + v[5]) + (first + shear) * (u[4] + v[5]),
        ]
        assert (np.abs(force) / distance ** (powers - 2))[:, leading].max() < 1000 * distance**2
        for edge in (0, 1):
            place, normal = on_edge(BOTH, corner, edge, distance)
            jets = found.derivatives(place, 1)[0]
            if held[edge] is HELD:
                assert np.abs(jets.reshape(2, 3, -1)[:, 0]).max() < 1e-15
                continue
            g = gradient(jets)
            stress = shear * (g + g.transpose(1, 0, 2)) + first * np.multiply.outer(np.eye(2), g[0, 0] + g[1, 1])
            pull = np.einsum("ijk,j->ik", stress, normal)
            assert (np.abs(pull) / distance ** (powers - 1))[:, leading].max() < 300 * distance**2


def test_deflections_are_zero_with_their_slopes_along_clamped_edges_however_curved():
    corner = corners(BOTH)[0]
    for zeros in ((2, 2), (2, 0), (1, 2), (1, 1)):
        found = wave_functions(BOTH, corner, of_plate(corner, zeros, 0.3), power=5)
        for edge, count in enumerate(zeros):
            for distance in (1e-3, 0.1, 0.3):
                place, _ = on_edge(BOTH, corner, edge, distance)
                jets = np.abs(found.derivatives(place, 2)[0])
                assert jets[:count].max(initial=0) < 1e-14
                assert (jets[1:3].max() < 1e-14) == (count == 2)
                assert jets[3:].max() > 1e-3


def test_polynomials_stand_in_where_weights_have_roots():
    """Those of a held edge y = 0 up to the third degree: y, of both components, times all that is quadratic."""
    ell = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y)), (x, y))
    (corner,) = (one for one in corners(ell) if one.is_reentrant)
    held = [HELD if part == "y" else FREE for part in corner.parts]
    found = wave_functions(ell, corner, of_body(corner, held, 1.8), power=5)
    whole = [k for k, term in enumerate(found.terms) if abs(found.rates[term.function] - round(term.exponent)) < 1e-9]
    points = np.random.default_rng(1).uniform(-0.2, 0.2, (40, 2))
    points = points[(points[:, 0] < 0) | (points[:, 1] > 0)]
    cut = (1 - (points**2).sum(axis=1) / found.radius**2) ** 5
    values = found.derivatives(points, 0)[:, :, whole] / cut[:, None, None]
    for component in (0, 1):
        own = values[:, component][:, np.abs(values[:, component]).max(axis=0) > 0]
        wanted = np.stack(
            [
                points[:, 1] * points[:, 0] ** i * points[:, 1] ** j
                for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
            ]
        )
        assert own.shape[1] == 6
        assert np.abs(wanted.T - own @ np.linalg.lstsq(own, wanted.T, rcond=None)[0]).max() < 1e-14
