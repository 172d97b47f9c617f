"""Unions of boxes against loops over all of them."""

import numpy as np
import pytest

from rsym.verify.curves.region import Region

SHARES = (0, 1, 0.5, -0.25, -0.2, 1.2, 1 + 1e-9)  # of a box: its ends, its middle, within its rim and beyond


def holds(box, point, tolerance):
    return all(low - tolerance <= value <= high + tolerance for (low, high), value in zip(box, point, strict=True))


def surrounds(box, low, high):
    share = (1 - 2.0**-20) / 4
    rims = [(one - share * (other - one), other + share * (other - one)) for one, other in box]
    return all(one <= a and b <= other for (one, other), a, b in zip(rims, low, high, strict=True))


def random_union(chance):
    """Up to thirty boxes of a lattice of many sizes; many share faces."""
    widths = 2.0 ** -chance.integers(0, 25, chance.integers(0, 30))
    corners = np.round(chance.uniform(-1, 1, (len(widths), 3)) / widths[:, None]) * widths[:, None]
    return [[(low, low + width) for low in corner] for corner, width in zip(corners.tolist(), widths, strict=True)]


@pytest.mark.slow
def test_no_box_is_passed_over():
    chance, found = np.random.default_rng(5), np.zeros(2, int)
    for _ in range(40):
        boxes, tolerance = random_union(chance), 10.0 ** -chance.integers(3, 13)
        region = Region(boxes, tolerance)
        for _ in range(40):
            box = np.array(boxes[chance.integers(len(boxes))] if boxes else [(0, 1)] * 3)
            width = box[:, 1] - box[:, 0]
            point = box[:, 0] + chance.choice(SHARES, 3) * width + chance.choice([0, 1, -1, 2], 3) * tolerance
            beyond = point + chance.choice([0, 0.25, 1e-9, 1], 3) * width
            around = [number for number, one in enumerate(boxes) if holds(one, point, tolerance)]
            assert region.around(point).tolist() == around
            inside = any(surrounds(one, point, beyond) for one in boxes)
            assert region.surrounds(point, beyond) == inside
            found += bool(around), inside
    assert found.min() > 200
