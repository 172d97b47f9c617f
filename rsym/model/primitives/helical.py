"""The helicoid, and the tube about a helix: the nearest point of a helix is the root of Kepler's equation."""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, positive
from rsym.model.nodes import Composition
from rsym.model.primitives.formulas import box_around, normalised, within
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE, x, y, z
from rsym.model.systems import R0, RSystem

# Newton's steps: with two the gradient of the distance from a helix is 1 to 1e-16 on tubes up to 0.8 of its radius,
# of any pitch (1e-9 with one). An error of the root counts squared there, since the distance is least at the root.
STEPS = 2


class Anomaly(Composition):
    """The root E(m, e) of E + e*sin(E) = m next to zero, |m| <= pi, e >= 0: Kepler's equation, e with the other sign.

    Newton's steps from m/(1 + e). On the way to the first maximum the left side is concave, and the start is not
    beyond the root: every step is towards it and none goes past it.
    """

    runtime_name = "anomaly"

    def composition(self) -> sp.Expr:
        """The steps, one in the other."""
        mean, excess = self.args
        root = mean / (1 + excess)
        for _ in range(STEPS):
            sine, cosine = sp.sin(root), sp.cos(root)
            root = (mean + excess * (root * cosine - sine)) / (1 + excess * cosine)
        return root

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = rf"E\left({', '.join(printer._print(argument) for argument in self.args)}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"anomaly({', '.join(printer._print(argument) for argument in self.args)})"


def helicoid(pitch: Any = 1, thickness: Any = None, *, letters: LetterMapping = None) -> Shape:
    """(y*cos(k z) - x*sin(k z))/sqrt(1 + k**2*(x**2 + y**2)), k = 2 pi/pitch: one side of a right-handed helicoid.

    Its lines cross the z-axis at right angles and turn once in a pitch. Normalised to order 2, since a half turn about
    one of them changes the sign of omega alone; analytic everywhere.

    With a thickness t, a sheet about it: Y**2 < a**2 + (X*tan(k*a))**2, a = t/2, X measured along the line at the
    height of the point, Y at right angles; by Rvachev's theorem, of size a at most. Across the axis and far from it
    the sheet is t thick, between them less, by 0.4 % at t = pitch/10 and 1.8 % at pitch/5. Normalised to order 1,
    analytic everywhere. Cut with a cylinder it is the flight of a screw.

    Raises
    ------
    RsymError
        For a pitch that is not positive, or a thickness not between 0 and pitch/2, where the turns meet.

    Examples
    --------
    >>> import rsym, sympy
    >>> rsym.helicoid(2 * sympy.pi).expression
    (-x*sin(z) + y*cos(z))/sqrt(x**2 + y**2 + 1)
    """
    pitch = positive(pitch, "the pitch", letters)
    rate = 2 * sp.pi / pitch
    along, aside = _turned(rate)
    if thickness is None:
        return Shape(-aside / sp.sqrt(1 + rate**2 * (x**2 + y**2)), SPACE, letters=letters)
    half = positive(thickness, "the thickness", letters) / 2
    if default(2 * half * rate, letters) >= math.pi:
        raise RsymError(
            f"the thickness must be below pitch/2 = {default(pitch, letters) / 2:g}, got {thickness}",
            code="thickness",
            remedy="a thicker sheet has no room between its turns",
        )
    spread = sp.tan(rate * half, evaluate=False) ** 2
    function = half**2 + spread * along**2 - aside**2
    squared = 4 * (spread * along) ** 2 + 4 * aside**2 + (2 * rate * (1 + spread) * along * aside) ** 2
    return Shape(normalised(function, squared, half), SPACE, letters=letters)


def helix_tube(
    radius: Any = 3,
    tube: Any = 1,
    pitch: Any = 4,
    turns: Any = None,
    exact: bool = False,
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """(r**2 - d**2)/(2 r), d the distance from a right-handed helix about the z-axis through (R, 0, 0); exact r - d.

    d**2 = (rho - R)**2 + 4*rho*R*sin(E/2)**2 + ((m - E)/k)**2, where E + k**2*R*rho*sin(E) = m, k = 2 pi/pitch and
    m the angle by which the point lies above the turn next to it. With a number of turns, cut by the slab
    |z| < turns*pitch/2, and bounded.

    Normalised to order 1, with `exact` to every order, within rounding for tubes up to r = 0.8 R; cut, to order 1.
    Singular on the z-axis and half-way between two turns, the exact form on the helix too. Turns that overlap
    are one body with creases.

    Raises
    ------
    RsymError
        For a size that is not positive, or unless tube < radius.

    Examples
    --------
    >>> import rsym
    >>> spring = rsym.helix_tube(3, 1, 4)
    >>> rsym.compile(spring)([3.0, 0.0, 4.0], [0.0, 3.0, 0.0], [0.0, 1.0, 0.0])["value"].round(12).tolist()
    [0.5, 0.5, 0.0]
    """
    radius, tube = positive(radius, "the radius", letters), positive(tube, "the radius of the tube", letters)
    pitch = positive(pitch, "the pitch", letters)
    if default(radius - tube, letters) <= 0:
        raise RsymError(f"the tube must be thinner than the helix is wide, got {tube} and {radius}", code="tube")
    rate, rho = 2 * sp.pi / pitch, sp.sqrt(x**2 + y**2)
    across, above = _turned(rate)
    mean = sp.atan2(above, across)
    root = Anomaly(mean, rate**2 * radius * rho)
    squared = (rho - radius) ** 2 + 4 * rho * radius * sp.sin(root / 2) ** 2 + ((mean - root) / rate) ** 2
    expression = within(squared, tube, exact)
    if turns is None:
        return Shape(expression, SPACE, letters=letters)
    half = positive(turns, "the number of turns", letters) * pitch / 2
    reach, top = default(radius + tube, letters), default(half, letters)
    box = box_around([(-reach, -reach, -top), (reach, reach, top)])
    return Shape(system.conjunction(expression, within(z**2, half)), SPACE, letters=letters, box=box)


def _turned(rate: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Rho times cosine and sine of k z - theta: the coordinates along the line at height z, and above it."""
    sine, cosine = sp.sin(rate * z), sp.cos(rate * z)
    return x * cosine + y * sine, x * sine - y * cosine
