"""Names as the source prints them."""

from __future__ import annotations

import re
from collections.abc import Iterable

import sympy as sp

_GREEK = frozenset(
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi"
    " omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega".split()
)


def typeset_name(name: str) -> str:
    r"""A name as the source prints it: one letter or a Greek one, the rest as a subscript; words upright.

    Examples
    --------
    >>> print(*map(typeset_name, ("a1", "xk2", "omega_bkka", "eps", "test1", "W")))
    a_{1} x_{k2} \omega_{bkka} \varepsilon \mathrm{test}_{1} W
    """
    head, _, tail = name.partition("_")
    word, digits = _split(head)
    if word == "eps":
        base, index = r"\varepsilon", ""
    elif word in _GREEK:
        base, index = rf"\{word}", ""
    elif len(word) <= 2:
        base, index = word[:1], word[1:]
    else:
        base, index = rf"\mathrm{{{word}}}", ""
    below = ",".join(part for part in (index + digits, tail.strip("_").replace("_", ",")) if part)
    return f"{base}_{{{below}}}" if below else base


def _split(head: str) -> tuple[str, str]:
    match = re.fullmatch(r"([A-Za-z]+)(\w*)", head)
    assert match is not None
    return match.group(1), match.group(2)


def symbol_names(symbols: Iterable[sp.Symbol]) -> dict[sp.Symbol, str]:
    """What `sympy.latex` takes to print symbols in this way; what no model file could name stays as SymPy has it."""
    return {symbol: typeset_name(symbol.name) for symbol in symbols if re.fullmatch(r"[A-Za-z]\w*", symbol.name)}
