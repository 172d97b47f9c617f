"""The parameters: u and v of a patch, t of a curve or a blending function."""

from __future__ import annotations

import sympy as sp

from rsym.model.symbols import real_symbol

u: sp.Symbol = real_symbol("u")
v: sp.Symbol = real_symbol("v")
t: sp.Symbol = real_symbol("t")
