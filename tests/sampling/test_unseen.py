"""Lines thinner than a cell: closed forms of rings, slots, ovals and discs that touch; what is too thin is told."""

import math

import numpy as np
import pytest
from opponent.thin import Thin, asked

import rsym
from rsym import x, y
from rsym.sampling.cut_cells import UNIT
from rsym.sampling.outlines import Joints, _one_corner, _without_beads
from rsym.sampling.plane_leaves import leaves_of

OVAL = rsym.Shape(x**3 - x**2 - 384 * x - 2772 - y**2, (x, y), bounds=((-30, 40), (-60, 60)))


def lines_of(shape, resolution=128, **options):
    return rsym.level_lines(shape, resolution=resolution, **options)


def test_a_ring_thinner_than_a_cell_is_two_circles():
    lines = lines_of(rsym.disc(1) - rsym.disc(0.994))
    assert [len(lines), lines.status.unseen] == [2, 0]
    assert lines.length == pytest.approx(2 * math.pi * 1.994, rel=1e-5)
    assert lines.area == pytest.approx(math.pi * (1 - 0.994**2), rel=1e-4)


def test_a_slot_and_a_disc_below_a_cell_are_there():
    slot = rsym.rectangle(1, 0.006, (0.1, 0.2))
    lines = lines_of((rsym.rectangle(2, 2) - slot) | rsym.disc(0.004, (1.5, 0.3)))
    assert len(lines) == 3
    assert lines.area == pytest.approx(4 - 0.006 + math.pi * 0.004**2, rel=1e-4)


def test_a_sharp_tip_is_no_doubt():
    lines = lines_of(rsym.polygon([(0, 0), (10, 0), (10, 0.4)]), 64)
    assert lines.length == pytest.approx(10.4 + math.hypot(10, 0.4), rel=1e-12)
    assert (lines.status.unseen, lines.status.unresolved_corners) == (0, 0)


def test_a_needle_that_no_sample_shows_is_no_tip():
    # In all of its cells its two sides alone matter, and cross at its end: it was taken for the end of something seen.
    assert asked(Thin(90974)) == ("right", [])


@pytest.mark.parametrize("resolution", [16, 56, 166, 256, 286])
def test_a_tip_within_one_leaf_is_no_doubt(resolution):
    assert lines_of(rsym.paper.skeleton_body(), resolution).status.unseen == 0


@pytest.mark.filterwarnings("ignore:Unresolved")
@pytest.mark.parametrize(("long", "thick", "turn", "resolution"), [(1, 0.001, 1.1, 24), (0.8, 0.0005, 0.3, 100)])
def test_the_end_of_a_thin_oval_in_pieces_is_told(long, thick, turn, resolution):
    """Samples within cells show one piece where the corners, between which lines go, show several."""
    lines = lines_of(rsym.ellipse(long, thick).rotate(turn), resolution)
    assert len(lines) == 1 or lines.status.unseen


@pytest.mark.parametrize("cut", [False, True])
def test_a_loop_that_touches_a_line_at_its_corner_is_no_bead(cut):
    """A bead runs out along two sides of a tip and is cut off there; a loop comes back by itself."""
    turn = np.linspace(0, np.pi, 16)[1:-1]
    loop = np.stack([np.sin(turn), np.sin(2 * turn) / 2], axis=1)
    sides = [loop[:5], loop[8:]] if cut else [loop, loop[:1] / 2]
    corner, tip = np.zeros((1, 2)), np.array([[-3.0, 1.0], [0.0, 0.0], [-3.0, -1.0]])
    bead = np.concatenate([corner, sides[0], corner, sides[1], corner])
    marks = [np.where((line == 0).all(axis=1)[:, None], np.nan, line) for line in (tip, bead)]
    assert len(_without_beads([tip, bead], marks, 0.1)[0]) == 2 - cut


def test_an_oval_is_found_at_any_resolution():
    for resolution in (16, 64, 512):
        lines = lines_of(OVAL, resolution)
        assert (lines.status.closed, lines.status.open) == (1, 1)


def test_discs_that_touch_are_told_where_they_touch():
    with pytest.warns(rsym.RsymWarning, match=r"Unresolved in \d+ cells? of .* near \(1, "):
        lines = lines_of(rsym.disc(1) | rsym.disc(1, (2, 0)), 512)
    assert lines.length == pytest.approx(4 * math.pi, rel=1e-4)
    assert lines.status.places == (pytest.approx((1, 0), abs=0.05),)


def test_places_that_lie_apart_are_told_each():
    pairs = rsym.disc(1) | rsym.disc(1, (2, 0)) | rsym.disc(1, (6, 0)) | rsym.disc(1, (8, 0))
    with pytest.warns(rsym.RsymWarning, match=r"near \(.*\), \("):
        lines = lines_of(pairs)
    assert sorted(lines.status.places) == [pytest.approx(place, abs=0.1) for place in ((1, 0), (7, 0))]


def test_the_end_of_a_slot_is_not_cut_off_in_a_cell():
    slot = rsym.rectangle(1, 0.05).rotate(0.5)
    assert lines_of(slot, 10, bounds=((-2, 2),) * 2).length == pytest.approx(2.1, rel=1e-9)


@pytest.mark.parametrize(("turn", "middle"), [(5.426, (0.075, -0.006)), (2.403, (0.001, -0.097))])
def test_the_end_of_a_slot_whose_sides_are_one_leaf_is_not_cut_off(turn, middle):
    plate = rsym.rectangle(6.4, 4.4) - rsym.rectangle(1.43, 0.012).rotate(turn).translate(*middle)
    lines = lines_of(plate, 50)
    assert lines.length == pytest.approx(21.6 + 2 * 1.442, rel=1e-12)
    assert lines.area == pytest.approx(6.4 * 4.4 - 1.43 * 0.012, rel=1e-12)


def test_lines_do_not_run_along_a_sheet_and_back():
    def brick(x1, x2, y1, y2):
        return rsym.rectangle(x2 - x1, y2 - y1, ((x1 + x2) / 2, (y1 + y2) / 2))

    body = (brick(2, 6, 0, 1) | brick(0, 6, 0, 4)) - brick(0, 2, 0, 4) - brick(2, 3, 0, 4)
    with pytest.warns(rsym.RsymWarning, match="Unresolved"):
        assert lines_of(body, 32, bounds=((-1, 7),) * 2).length == pytest.approx(14, rel=1e-9)


def test_what_is_too_thin_for_the_finest_cells_is_told():
    with pytest.warns(rsym.RsymWarning, match="Unresolved in"):
        lines = lines_of(rsym.disc(1) - rsym.disc(1 - 1e-6))
    assert lines.status.unseen > 100
    assert "lines may be missing" in str(lines.status)


def test_what_is_too_thin_is_told_all_along():
    with pytest.warns(rsym.RsymWarning, match="Unresolved in"):
        lines = lines_of(rsym.rectangle(5, 1e-7).rotate(0.3), 16)
    along = np.sort(np.array(lines.status.places) @ [math.cos(0.3), math.sin(0.3)])
    assert np.diff(along, prepend=-2.5, append=2.5).max() < 2


@pytest.mark.parametrize(
    "shape",
    [rsym.disc(1), rsym.rectangle(2, 1) | rsym.disc(1, (1, 0.5)), rsym.ellipse(3, 1).rotate(0.3) - rsym.disc(0.5)],
    ids=["disc", "union", "hole"],
)
def test_lines_where_nothing_was_wrong_keep_their_bits(shape, monkeypatch):
    lines = lines_of(shape)
    assert lines.status.examined
    monkeypatch.setattr("rsym.sampling.unseen._undecided", lambda *given: None)
    with pytest.warns(rsym.RsymWarning, match=r"not looked for\. Remedy"):
        plain = lines_of(shape)
    assert [line.tobytes() for line in lines] == [line.tobytes() for line in plain]
    assert not plain.status.examined
    assert not lines_of(shape, field="gradient_squared", level=0.5).status.examined


@pytest.mark.slow
def test_lines_that_do_not_go_on_are_told_beside_what_is_unseen(monkeypatch):
    monkeypatch.setattr("rsym.sampling.unseen.loose_sides", lambda cells, lattice: np.array([[0, 0]]) * UNIT)
    with pytest.warns(rsym.RsymWarning, match="Unresolved in"):
        lines = lines_of(rsym.disc(1) - rsym.disc(1 - 1e-6), 16)
    assert min(math.hypot(*place) for place in lines.status.places) < 1.1
    assert max(math.hypot(*place) for place in lines.status.places) > 1.6


def test_a_corner_beyond_all_numbers_is_none():
    leaves = leaves_of(rsym.Shape(rsym.conjunction(y, y - 1 + x / 10**200), (x, y)), (0, 1), {})
    joints = Joints(np.array([[0.0, 0.0]]), np.array([[0.0, 1.0]]), np.array([0]), np.array([1]))
    with np.errstate(all="raise"):
        assert not _one_corner(leaves, joints, 0.1)[1].any()


@pytest.mark.parametrize("field", ["normalised", "normalised_2"])
def test_what_is_normalised_has_the_lines_of_omega(field):
    finned = rsym.disc(1) | rsym.rectangle(0.003, 4)
    lines = rsym.level_lines(finned, [0.2, 0.0], field=field, resolution=64)[1]
    assert lines.field == field
    assert lines.length == pytest.approx(rsym.level_lines(finned, resolution=64).length, rel=1e-12)
    assert lines.length == pytest.approx(2 * math.pi + 4, rel=1e-3)


def test_a_smooth_mesh_says_that_it_did_not_look_for_what_is_thin():
    bored = rsym.box(2, 2, 2) - rsym.cylinder(0.003, 3, (0.3, 0.2, 0))
    assert "thinner than a cell was not looked for" in str(rsym.mesh(bored, 16, method="smooth").status)
