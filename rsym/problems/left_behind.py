"""Python functions that no pickle holds, such as a lambda: what is solved goes without them, and says so when asked."""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, NoReturn

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition
from rsym.errors import RsymError
from rsym.model.equation import Equation


@dataclass(frozen=True)
class LeftBehind:
    """Stands where a function stood that could not be pickled.

    Examples
    --------
    >>> LeftBehind("k")(1.0, 2.0)
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: k was a Python function that no pickle holds: it stayed where the solution was found; \
remedy: solve again, or let k be an expression, or a function that a module defines by its name
    """

    name: str

    def __call__(self, *coordinates: Any) -> NoReturn:
        """Refuse."""
        raise RsymError(
            f"{self.name} was a Python function that no pickle holds: it stayed where the solution was found",
            code="function",
            remedy=f"solve again, or let {self.name} be an expression, or a function that a module defines by its name",
        )


def portable(value: Any, name: str) -> Any:
    """A value, condition, tuple or mapping of such as a pickle can hold it, itself where it can.

    Examples
    --------
    >>> portable({"k": lambda x, y: x, "c": abs}, "")
    {'k': LeftBehind(name='k'), 'c': <built-in function abs>}
    """
    if isinstance(value, Mapping):
        found = {key: portable(one, name or str(key)) for key, one in value.items()}
        return found if any(found[key] is not value[key] for key in value) else value
    if isinstance(value, tuple):
        several = tuple(portable(one, name) for one in value)
        return several if any(a is not b for a, b in zip(several, value, strict=True)) else value
    if isinstance(value, BoundaryCondition):
        changed = {one.name: portable(getattr(value, one.name), f"the {one.name}") for one in fields(value)}
        kept = all(changed[one.name] is getattr(value, one.name) for one in fields(value))
        return value if kept else replace(value, **changed)
    if not callable(value) or isinstance(value, sp.Basic | Equation):
        return value
    try:
        pickle.dumps(value)
    except (pickle.PicklingError, AttributeError, TypeError):
        return LeftBehind(name)
    return value
