"""A formula times what is known to be positive: meshes need the formula alone."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.nodes import Composition


class Scaled(Composition):
    """f times a factor that is positive wherever the shape has a boundary: the sign and the zero set are those of f."""

    of_shapes = True

    def composition(self) -> sp.Expr:
        """The product."""
        f, factor = self.args
        return f * factor

    def _sympystr(self, printer: Any) -> str:
        text: str = printer._print(self.composition())
        return text

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        text = printer._print(self.composition())
        return text if exp is None else rf"\left({text}\right)^{{{exp}}}"
