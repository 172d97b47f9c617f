"""What every question to a shape refuses: no shape, sizes and budgets that are none, letters without names."""

import pytest

import rsym
from rsym import x, y, z

DISC = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
BALL = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
QUESTIONS = {
    "verify_smoothness": rsym.verify_smoothness,
    "verify_normalisation": lambda shape, **given: rsym.verify_normalisation(shape, 1, **given),
    "lint": rsym.lint,
    "repair": rsym.repair,
    "fairness": rsym.fairness,
    "compare_designs": lambda shape: rsym.compare_designs(shape, {"one": {}}),
    "smoothness_atlas": lambda shape: rsym.smoothness_atlas(shape, "a", "b"),
}
REFUSED = [
    (rsym.verify_smoothness, {"smallest": -1}, "smallest"),
    (rsym.verify_smoothness, {"smallest": "fine"}, "smallest"),
    (rsym.verify_smoothness, {"budget": 0}, "budget"),
    (rsym.verify_smoothness, {"budget": 1.5}, "budget"),
    (rsym.verify_smoothness, {"letters": "a=1"}, "letters"),
    (rsym.repair, {"radius": "large"}, "radius"),
    (rsym.repair, {"curvature": float("nan")}, "curvature"),
    (rsym.repair, {"tolerance": 0}, "tolerance"),
    (rsym.repair, {"moves": "round"}, "move"),
    (rsym.repair, {"vary": "a"}, "letters"),
    (rsym.fairness, {"budget": -1}, "budget"),
    (rsym.fairness, {"tolerance": "fine"}, "tolerance"),
    (rsym.fairness, {"letters": [1]}, "letters"),
]


@pytest.mark.parametrize("question", QUESTIONS.values(), ids=QUESTIONS)
def test_what_is_no_shape(question):
    with pytest.raises(rsym.RsymError, match=r"expected a Shape, got int") as raised:
        question(3)
    assert raised.value.code == "shape"


@pytest.mark.parametrize(("question", "given", "code"), REFUSED)
@pytest.mark.parametrize("shape", [DISC, BALL], ids=["plane", "space"])
def test_sizes_budgets_and_letters(shape, question, given, code):
    with pytest.raises(rsym.RsymError, match=r"must be a .*got") as raised:
        question(shape, **given)
    assert raised.value.code == code
    assert raised.value.remedy


@pytest.mark.parametrize("draw", [rsym.plot_repair, rsym.plot_designs, rsym.plot_fairness, rsym.plot_atlas])
def test_pictures_of_what_is_no_report(draw):
    with pytest.raises(rsym.RsymError, match=r"expected a \w+, got int") as raised:
        draw(3)
    assert raised.value.code == "report"


@pytest.mark.parametrize("designs", [[{"a": 1}], {"one": 3}], ids=["no mapping", "no letters"])
def test_designs_that_are_none(designs):
    with pytest.raises(rsym.RsymError):
        rsym.compare_designs(DISC, designs)


@pytest.mark.parametrize("question", [rsym.verify_smoothness, rsym.fairness, rsym.repair])
def test_bodies_in_space_report_progress_and_can_be_cancelled(question):
    calls = []
    with pytest.raises(rsym.RsymError) as raised:
        question(BALL, method="space", progress=lambda *count: calls.append(count) or False)
    assert raised.value.code == "cancelled"
    assert len(calls) == 1
