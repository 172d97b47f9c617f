"""The functions of the language, to SymPy and as plain numbers, and the nodes that a model file may name.

Nodes are what shapes are made of beside arithmetic, by the names of their classes. They are what `dumps` writes of a
shape made in Python: ``RpConjunction(4, f, g)``, ``Scaled(f, k)``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.language.syntax import Call
from rsym.model import powers, rnodes
from rsym.model.abridging import name_of
from rsym.model.blends import displacement, rho, sardf
from rsym.model.blends.rho import Rho
from rsym.model.blends.sardf import Sardf
from rsym.model.choices import Choice
from rsym.model.functions import FUNCTIONS
from rsym.model.nodes import Ahead, Fold, Held, Scaled, Trimming, ZeroWith
from rsym.model.operations import difference, equivalence, exclusive_or, implication, joining
from rsym.model.primitives import curve_nodes
from rsym.model.primitives.helical import Anomaly
from rsym.model.symbols import real_symbol
from rsym.model.symmetry import waves
from rsym.model.systems import R0, R1, R0m, RAlpha, Rp, RSystem

SYSTEMS: dict[str, RSystem] = {"R0": R0, "R1": R1}
# Systems with a parameter, and an example of it.
FAMILIES: dict[str, tuple[Callable[[Any], RSystem], str]] = {
    "Ralpha": (RAlpha, "0.5"),
    "R0m": (R0m, "2"),
    "Rp": (Rp, "4"),
    "Rho": (Rho, "0.2"),
    "Sardf": (Sardf, "0.5"),
}


def written_system(system: RSystem) -> str:
    """The system as a model file names it.

    Examples
    --------
    >>> written_system(R1), written_system(Rp(4))
    ('R1', 'Rp 4')
    """
    for word, known in SYSTEMS.items():
        if system == known:
            return word
    word, parameter = next(
        (word, system.parameters[0]) for word, (family, _) in FAMILIES.items() if family is type(system)
    )
    return f"{word} {float(parameter)!r}" if parameter.is_Float else f"{word} {parameter}"


def named_system(text: Any, letters: Mapping[str, Any]) -> RSystem:
    """The system that a model file names so, its parameter a number or a letter.

    Raises
    ------
    RsymError
        For what is no name of a system, or a parameter out of its range.

    Examples
    --------
    >>> named_system("Rho 1/2", {}), named_system("R1", {})
    (Rho(radius=1/2, continuity='G1', cosine=0, coefficient=None), ROne())
    """
    word, *rest = text.split() if isinstance(text, str) else [""]
    known = [f'"{one}"' for one in SYSTEMS] + [f'"{one} {example}"' for one, (_, example) in FAMILIES.items()]
    if word in SYSTEMS and not rest:
        return SYSTEMS[word]
    if word in FAMILIES and len(rest) == 1:
        family, (parameter,) = FAMILIES[word][0], rest
        if parameter in letters:
            family(letters[parameter].default)
            return family(real_symbol(parameter))
        with suppress(ValueError, ZeroDivisionError):
            return family(sp.Rational(Fraction(parameter)))
    raise RsymError(f"no R-system {text!r}", code="unknown-system", remedy=f"the systems are {', '.join(known)}")


def in_quotes(word: str) -> str | None:
    """How the name of a system is given to a call; None for other words."""
    if word in SYSTEMS:
        return f'write system = "{word}"'
    return f'write system = "{word} {FAMILIES[word][1]}"' if word in FAMILIES else None


@dataclass(frozen=True)
class TextFunction:
    """One function, three times over; SymPy never evaluates `symbolic`, `exact` is there where rationals stay so.

    Without `numeric` a call on constants stays as it is: a letter is hidden in it.
    `sorts` says that SymPy puts the arguments into an order of its own.
    """

    symbolic: Callable[..., sp.Expr]
    numeric: Callable[..., float] | None
    exact: Callable[..., Fraction] | None = None
    sorts: bool = False


def operations(system: RSystem) -> dict[str, TextFunction]:
    """Every function by name, the logical ones in the given R-system."""
    has_letter = any(parameter.free_symbols for parameter in system.parameters)

    def logical(build: Callable[..., sp.Expr]) -> TextFunction:
        return TextFunction(build, None) if has_letter else _node(build)

    both, either = logical(system.conjunction), logical(system.disjunction)
    return {
        **{
            name: TextFunction(_held_back(row.kind), row.number, row.exact, row.sorts)
            for name, row in FUNCTIONS.items()
        },
        "rfAND": both,
        "conjunction": both,
        "rfOR": either,
        "disjunction": either,
        "difference": logical(partial(difference, system=system)),
        "implication": logical(partial(implication, system=system)),
        "exclusive_or": logical(partial(exclusive_or, system=system)),
        "equivalence": _node(equivalence),
        "joining": _node(joining),
        "trimming": _node(Trimming),
    }


def _node(build: Callable[..., sp.Expr]) -> TextFunction:
    """An R-node; its number is the node's own high-precision value."""
    return TextFunction(build, lambda *values: float(build(*map(sp.Float, values)).evalf()))


def _held_back(function: Any) -> Callable[..., sp.Expr]:
    """A SymPy function that does not start to simplify itself, which could take for ever."""
    return lambda *arguments: function(*arguments, evaluate=False)


PIECEWISE = "piecewise"
COMPARISONS: Mapping[str, Callable[..., Any]] = {"<": sp.Lt, "<=": sp.Le, ">": sp.Gt, ">=": sp.Ge}
CONNECTIVES: Mapping[str, Callable[..., Any]] = {"and": sp.And, "or": sp.Or, "not": sp.Not}
MOST_CELLS = 400  # of a finite wave


@dataclass(frozen=True)
class NodeKind:
    """A class of nodes: how many arguments it takes, and what refuses parameters that it cannot have."""

    kind: type[sp.Basic]
    counts: tuple[int, ...]  # the last of a fold is the fewest
    check: Callable[..., object] | None = None

    @property
    def parameters(self) -> int:
        """How many of the arguments come before the operands of a fold."""
        return self.kind.parameter_count if issubclass(self.kind, Fold) else 0

    def fits(self, count: int) -> bool:
        """Whether it takes so many arguments."""
        return count >= self.counts[-1] if issubclass(self.kind, Fold) else count in self.counts


def _cells(count: sp.Expr) -> None:
    if not (count.is_Integer and 2 <= count <= MOST_CELLS):
        raise RsymError(f"the cells must be 2 to {MOST_CELLS}, got {count}", code="integer")


def _folds(check: Callable[..., object] | None, *kinds: type[Fold]) -> list[NodeKind]:
    return [NodeKind(kind, (kind.parameter_count + 2,), check) for kind in kinds]


_ALL = (
    *_folds(None, rnodes.R0Conjunction, rnodes.R0Disjunction, rnodes.R1Conjunction, rnodes.R1Disjunction),
    *_folds(RAlpha, rnodes.RAlphaConjunction, rnodes.RAlphaDisjunction),
    *_folds(R0m, rnodes.R0mConjunction, rnodes.R0mDisjunction),
    *_folds(Rp, rnodes.RpConjunction, rnodes.RpDisjunction),
    *_folds(lambda r, c: rho.Rho(r, "G1", c), rho.CircularConjunction, rho.CircularDisjunction),
    *_folds(lambda r, c, k: rho.Rho(r, "G2", c, k), rho.CubicConjunction, rho.CubicDisjunction),
    *_folds(sardf.Sardf, sardf.SardfConjunction, sardf.SardfDisjunction),
    *_folds(lambda m: equivalence(sp.Symbol("f"), sp.Symbol("g"), order=m), rnodes.Equivalence, rnodes.Joining),
    *(NodeKind(kind, (2,)) for kind in (Ahead, ZeroWith, Scaled, Anomaly, powers.AbsolutePower, powers.SignedPower)),
    *(NodeKind(kind, (2,)) for kind in (waves.TriangleWave, waves.SawtoothWave)),
    *(NodeKind(kind, (3,), lambda *given: _cells(given[2])) for kind in (waves.TriangleRow, waves.SawtoothRow)),
    NodeKind(Held, (1,)),
    NodeKind(Choice, (4,)),
    NodeKind(displacement.Displacement, (5,)),
    NodeKind(displacement.BoundedDisplacement, (7,)),
    # In the plane or in space: coordinates, other vectors, numbers.
    NodeKind(curve_nodes.SegmentField, (6, 9)),
    NodeKind(curve_nodes.CircleField, (10, 14)),
    NodeKind(curve_nodes.ArcField, (12, 16)),
    NodeKind(curve_nodes.HelixField, (5, 6)),
)
# What is not differentiated through: which argument it is, and what it must be.
_SAME_EVERYWHERE = {
    "Held": (0, "number"),
    "AbsolutePower": (1, "number or an expression in letters"),
    "SignedPower": (1, "number or an expression in letters"),
}
NODES: Mapping[str, NodeKind] = {name_of(node.kind): node for node in _ALL}
MADE = frozenset((*NODES, *COMPARISONS, *CONNECTIVES, PIECEWISE))


def made(call: Call, arguments: Sequence[sp.Basic], varying: frozenset[sp.Symbol] | None = None) -> sp.Basic:
    """What a call of a node, of `piecewise` or of a comparison makes, unevaluated.

    varying: the coordinates, on which a constant and an exponent must not depend; None where names stand for formulas.

    Raises
    ------
    RsymError
        For arguments that do not fit, at the place of the call.

    Examples
    --------
    >>> from rsym import x, y
    >>> from rsym.language.syntax import Position
    >>> made(Call(Position(1, 1), "RpConjunction", ()), [sp.Integer(4), x, y])
    conjunction(x, y, system=Rp(4))
    """
    name = call.function
    if name in COMPARISONS or name in CONNECTIVES:
        return (COMPARISONS.get(name) or CONNECTIVES[name])(*arguments, evaluate=False)
    if name == PIECEWISE:
        conditions = [*arguments[1::2], *([sp.true] if len(arguments) % 2 else [])]
        return sp.Piecewise(*zip(arguments[::2], conditions, strict=True), evaluate=False)
    node = NODES[name]
    if call.keywords or not node.fits(len(arguments)) or any(isinstance(one, sp.Tuple) for one in arguments):
        wanted = " or ".join(map(str, node.counts)) + (" or more" if issubclass(node.kind, Fold) else "")
        raise call.place.refuse(f"{name} takes {wanted} formulas, got {len(arguments)}", "arity", "correct the call")
    if varying is not None and name in _SAME_EVERYWHERE:
        position, kept = _SAME_EVERYWHERE[name]
        found = arguments[position].free_symbols
        if found if kept == "number" else found & varying:
            message = f"argument {position + 1} of {name} must be a {kept}, for its derivative is not taken"
            raise call.place.refuse(message, "parameter", "write the formula with ^ and abs")
    if node.check is not None:
        try:
            node.check(*(arguments[: node.parameters] if node.parameters else arguments))
        except RsymError as error:
            raise call.place.refuse(f"{name}: {error.message}", error.code, error.remedy) from None
    return node.kind(*arguments)
