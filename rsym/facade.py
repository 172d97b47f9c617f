"""What the lazy facades answer: names, the nearest where there is none, and British words for American arguments."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FunctionType
from typing import Any

import lazy_loader

from rsym.garbage import uncollected
from rsym.model.spelling import british
from rsym.model.wording import proposal


def attach(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__``, ``__dir__`` and ``__all__`` of a package whose stub says where its names stand.

    Examples
    --------
    >>> import rsym
    >>> rsym.level_lin
    Traceback (most recent call last):
    ...
    AttributeError: rsym has no 'level_lin': did you mean 'level_lines' or 'LevelLines'?
    >>> rsym.normalize
    Traceback (most recent call last):
    ...
    AttributeError: rsym has no 'normalize': did you mean 'normalise'?
    """
    load, listed, names = lazy_loader.attach_stub(package, file)

    def found(name: str) -> Any:
        try:
            with uncollected():
                value = load(name)
        except AttributeError as error:
            if name in names or name.startswith("__"):
                raise
            message = f"{package} has no {name!r}: {proposal(name, names, f'dir({package}) lists what there is')}"
            raise AttributeError(message, name=name, obj=sys.modules[package]) from error
        vars(sys.modules[package])[name] = value = _answering(value)
        return value

    return found, listed, names


def _answering(value: Any) -> Any:
    """The function that answers American spellings, in its module too; of a class it is what makes it."""
    made: Any = value
    if isinstance(value, FunctionType):
        home = sys.modules[value.__module__]
        is_there = getattr(home, value.__name__, None) is value
        if is_there:
            made = british(value)
            setattr(home, value.__name__, made)
    elif isinstance(value, type) and isinstance(vars(value).get("__init__"), FunctionType):
        made.__init__ = british(made.__init__)
    return made
