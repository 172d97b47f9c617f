"""What was made of an object is kept as long as it is one of the last: by what it is, not by what it equals.

A notebook asks for the same few shapes again and again, and to compare two deep nests recurses too deep.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

S = TypeVar("S")
P = ParamSpec("P")
T = TypeVar("T")


def recently(
    size: int,
) -> Callable[[Callable[Concatenate[S, P], T]], Callable[Concatenate[S, P], T]]:
    """A function whose last results are kept, by the identity of its first argument and the others.

    Examples
    --------
    >>> @recently(4)
    ... def doubled(numbers, times):
    ...     return numbers * times
    >>> one = [1]
    >>> doubled(one, 2) is doubled(one, 2), doubled(one, 2) is doubled([1], 2)
    (True, False)
    """

    def decorated(function: Callable[Concatenate[S, P], T]) -> Callable[Concatenate[S, P], T]:
        known: deque[tuple[S, Any, T]] = deque(maxlen=size)

        @wraps(function)
        def found(first: S, /, *rest: P.args, **named: P.kwargs) -> T:
            others = (rest, named)
            for one, its_others, made in tuple(known):
                if one is first and its_others == others:
                    return made
            made = function(first, *rest, **named)
            known.append((first, others, made))
            return made

        return found

    return decorated
