"""Bodies that repeat themselves are searched in one piece, and what breaks the repetition is found all the same."""

import numpy as np
import pytest
import sympy as sp
from sympy import Abs, Rational, atan2, cos, sin

import rsym
from rsym import x, y, z
from rsym.verify.boxes.local import Model
from rsym.verify.cover.repetition import repetition, turning

CUBE = ((-2, 2),) * 3
BALL = 1 - x**2 - y**2 - z**2


def body(expression, bounds=CUBE):
    return rsym.Shape(expression, (x, y, z), bounds=bounds)


def was_searched_in_one_piece(report):
    return any("one piece was searched" in sentence for sentence, proved in report.statements if proved)


def ball(centre, radius):
    return radius**2 - sum((a - b) ** 2 for a, b in zip((x, y, z), centre, strict=True))


class TestReflections:
    @pytest.mark.parametrize(
        ("expression", "count"),
        [
            (BALL, 9),
            (1 - Abs(x) ** 3 - Abs(y) ** 3 - 2 * Abs(z) ** 3, 5),
            (BALL + x * y, 3),
            (rsym.conjunction(1 - Abs(x - y), 1 - Abs(x + y), 1 - z**2), 5),
            (rsym.conjunction(BALL, Rational(1, 2) - x, Rational(1, 2) - y, Rational(1, 2) - z), 3),
            (BALL + x + 2 * y + 3 * z, 0),
            (BALL + x * y * z, 6),
        ],
    )
    def test_those_that_keep_omega_are_seen(self, expression, count):
        found = repetition(Model(body(expression), {}), CUBE)
        assert (0 if found is None else len(found.mirrors)) == count

    def test_those_that_do_not_keep_the_bounds_are_not(self):
        found = repetition(Model(body(BALL), {}), ((-2, 2), (-2, 3), (-2, 2)))
        assert found.mirrors == ((1, 0, 0), (0, 0, 1), (1, 0, -1), (1, 0, 1))

    def test_every_point_has_an_image_in_the_chamber(self):
        found = repetition(Model(body(BALL), {}), CUBE)
        points = np.random.default_rng(3).uniform(-2, 2, (200, 3))
        chamber = points[found.meets(np.stack([points, points], axis=-1))]
        assert 0 < len(chamber) < 20
        images = found.images(np.stack([points, points], axis=-1), CUBE)[..., 0].reshape(len(found.motions), 200, 3)
        inside = [found.meets(np.stack([image, image], axis=-1)) for image in images]
        assert np.any(inside, axis=0).all()

    @pytest.mark.slow
    def test_the_boundary_lies_in_the_boxes_and_their_images(self):
        shape = rsym.mirror_group(body(ball((Rational(1, 2),) * 3, Rational(3, 10))), "octahedral")
        report = rsym.verify_smoothness(shape)
        assert report.verdict == "CERTIFIED"
        assert was_searched_in_one_piece(report)
        rng = np.random.default_rng(5)
        away = rng.normal(size=(500, 3))
        points = 0.3 * away / np.linalg.norm(away, axis=1)[:, None] + rng.choice([-0.5, 0.5], (500, 3))
        low, high = report.cover.certified[..., 0], report.cover.certified[..., 1]
        outside = np.maximum(low - points[:, None], points[:, None] - high).max(axis=2).min(axis=1)
        assert outside.max() < 1e-12

    @pytest.mark.slow
    def test_a_motif_within_one_chamber(self):
        motif = body(ball((Rational(9, 10), Rational(1, 2), Rational(1, 5)), Rational(1, 10)))
        report = rsym.verify_smoothness(rsym.mirror_group(motif, "octahedral"))
        assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
        assert was_searched_in_one_piece(report)


class TestWhatIsNotRepeated:
    @pytest.mark.parametrize("side", [-1, 1])
    def test_a_defect_on_one_side_is_found(self, side):
        cone = Rational(1, 4) - (side * x - Rational(1, 2)) - sp.sqrt(y**2 + z**2)
        report = rsym.verify_smoothness(body(rsym.disjunction(BALL / 4 - Rational(1, 5), cone)))
        assert report.verdict == "REFUTED"

    @pytest.mark.random
    @pytest.mark.parametrize("corner", [(1, 1, 1), (-1, 1, 1), (-1, -1, -1), (1, -1, 1)])
    def test_a_ball_cut_in_one_octant(self, corner):
        plane = Rational(3, 2) - sum(a * b for a, b in zip(corner, (x, y, z), strict=True))
        report = rsym.verify_smoothness(body(rsym.conjunction(BALL, plane)))
        assert (report.verdict, report.continuity) == ("REFUTED", "G0")

    @pytest.mark.slow
    def test_curves_of_a_symmetric_body_are_all_there(self):
        report = rsym.verify_smoothness(rsym.box(1, 1, 1))
        assert report.verdict == "REFUTED"
        assert len(report.curves) == 12
        assert not was_searched_in_one_piece(report)


class TestShiftsAndScrews:
    def test_an_endless_cylinder(self):
        report = rsym.verify_smoothness(body(1 - x**2 - 2 * (y + x / 3) ** 2))
        assert report.verdict == "CERTIFIED"
        assert was_searched_in_one_piece(report)
        low, high = report.cover.certified[:, 2].T
        assert (low.min(), high.max()) == (-2, 2)

    def test_boxes_in_which_sheets_may_meet_have_images_too(self):
        f, g = -(10**6) * z, 5 * 10**11 * x**2 * (10**12 * x**2 + Rational(1, 2)) - 10**6 * z
        bounds = ((-8.573651497465942e-08, 8.573651497465942e-08),) * 3
        cover = rsym.verify_smoothness(body(rsym.disjunction(f, g), bounds)).cover
        point = np.array([2.98652228e-09, -6.14325914e-08, 2.22986860e-12])
        boxes = np.concatenate([cover.certified, cover.joined])
        assert ((boxes[..., 0] <= point) & (point <= boxes[..., 1])).all(axis=1).any()

    @pytest.mark.slow
    @pytest.mark.parametrize("pitch", [4, -3])
    @pytest.mark.parametrize("axis", ["x", "z"])
    def test_a_twisted_bar(self, pitch, axis):
        section = rsym.Shape(1 - x**4 - 2 * y**4, (x, y))
        bar = rsym.screw(section, pitch)
        places = {x: y, y: z, z: x} if axis == "x" else {}
        shape = body(bar.expression.xreplace(places))
        assert turning(shape, CUBE).axis == "xyz".index(axis)
        report = rsym.verify_smoothness(shape)
        assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
        assert was_searched_in_one_piece(report)

    @pytest.mark.parametrize(
        "expression",
        [
            1 - (x * cos(z) + y * sin(z)) ** 2 - 2 * (y * cos(z) - x * sin(z)) ** 2 - z**2 / 9,
            1 - (x * cos(z) + y * sin(z)) ** 2 - 2 * (y * cos(z) + x * sin(z)) ** 2,
            1 - (x * cos(z) + y * sin(z)) ** 2 - 2 * (y * cos(2 * z) - x * sin(2 * z)) ** 2,
            1 - (x * cos(z) + 2 * y * sin(z)) ** 2 - (y * cos(z) - x * sin(z)) ** 2,
            1 - (x * cos(z) + y * sin(z) + x / 5) ** 2 - 2 * (y * cos(z) - x * sin(z)) ** 2,
            1 - x**2 - 2 * y**2 - sin(z),
        ],
    )
    def test_what_only_looks_like_a_screw(self, expression):
        assert turning(body(expression), CUBE) is None

    @pytest.mark.slow
    @pytest.mark.parametrize("make", [rsym.coil, rsym.helix_tube])
    def test_springs(self, make):
        report = rsym.verify_smoothness(make(), bounds=((-5, 5),) * 3)
        assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
        assert was_searched_in_one_piece(report)

    @pytest.mark.slow
    def test_a_twisted_bar_with_edges_is_searched_as_a_whole(self):
        bar = rsym.screw(rsym.Shape(rsym.conjunction(1 - x**2 - y**2, Rational(1, 2) - y), (x, y)), 8)
        report = rsym.verify_smoothness(bar, bounds=CUBE)
        assert (report.verdict, report.continuity) == ("REFUTED", "G0")
        assert not was_searched_in_one_piece(report)


class TestTheCutOfTheAngle:
    """atan2(y, x) on x < 0, where y = 0: pi from above, -pi from below."""

    SQUARE = ((-2, 2),) * 2

    def verdict(self, expression):
        return rsym.verify_smoothness(rsym.Shape(expression, (x, y), bounds=self.SQUARE))

    def test_a_boundary_away_from_it(self):
        report = self.verdict(Rational(1, 2) - (x - 1) ** 2 - y**2 + (atan2(y, x) ** 2 - 10) / 50)
        assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")

    def test_a_spiral_ends_on_it(self):
        report = self.verdict(1 - x**2 - y**2 + atan2(y, x) / 4)
        assert report.verdict == "DEGENERATE"
        places = sorted(joint.point[0] for joint in report.defects if joint.proved)
        assert np.allclose(places, [-np.sqrt(1 + np.pi / 4), -np.sqrt(1 - np.pi / 4)])

    def test_a_kink_on_it_is_not_certified(self):
        assert self.verdict(1 - x**2 - y**2 + atan2(y, x) ** 2 / 20).verdict != "CERTIFIED"

    def test_half_a_plane_that_ends_on_it(self):
        assert self.verdict(atan2(y, x) - 1 - (atan2(y, x) - 3) * 0).verdict != "CERTIFIED"
