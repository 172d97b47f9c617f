import re

import numpy as np
import pytest

from rsym import RsymError
from rsym.language.listing import definitions
from rsym.output.equations import _for_mathtext, equation
from rsym.paper import MODELS, model_path


@pytest.mark.random
@pytest.mark.parametrize("model", MODELS)
def test_every_definition_of_the_shipped_models_can_be_drawn(model):
    for definition in definitions(model_path(model)):
        text = equation(definition.latex)
        assert text.count("<path") == 1
        assert len(text) > 200


def test_the_drawing_stays_inside_its_box():
    """The path followed by its relative commands, the control points of curves included."""
    text = equation(r"f = \frac{x^{2}}{\sqrt{1 + y}} \wedge_0 z")
    left, top, width, height = map(float, re.search('viewBox="([^"]*)"', text)[1].split())
    here, start, points = np.zeros(2), np.zeros(2), []
    for letter, numbers in re.findall("([mlqcz])([^mlqcz]*)", re.search(' d="([^"]*)"', text)[1]):
        corners = here + np.array(numbers.split(), float).reshape(-1, 2) if letter != "z" else np.array([start])
        points.extend(corners)
        here = corners[-1]
        start = here if letter == "m" else start
    points = np.array(points)
    assert (points.min(axis=0) >= (left, top)).all()
    assert (points.max(axis=0) <= (left + width, top + height)).all()
    assert np.ptp(points, axis=0).min() > 0.9 * min(width, height) - 40


def test_an_r_operation_is_wider_than_its_letters_and_unknown_latex_is_refused():
    widths = [float(re.search('width="([^"]*)"', equation(text))[1]) for text in ("x y", r"x \wedge_0 y")]
    assert widths[1] > widths[0] + 15
    with pytest.raises(RsymError, match="cannot be drawn"):
        equation(r"\begin{aligned}x\end{aligned}")
    assert 'aria-label="x &lt; y"' in equation("x < y")


@pytest.mark.parametrize("sign", [r"\wedge_0", r"\vee_{p=4}", r"\wedge_{0}^{2}", r"\sim_{2}", r"\cup_{m}"])
def test_an_operation_has_room_and_keeps_its_indices_together(sign):
    head, indices = sign.split("_", 1)
    assert _for_mathtext(f"f {sign} g") == rf"f \;{{{head}}}_{indices}\; g"
    assert equation(f"f {sign} g")
