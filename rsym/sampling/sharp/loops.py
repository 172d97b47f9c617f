"""Index loops of the mesher: compiled once on a machine, kept in the user's cache folder, run in threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from typing import Any, TypeVar, cast

from numba import njit, types
from numba.extending import intrinsic

from rsym.sampling.sharp.cache import LoopCache

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")


def loop(function: F) -> F:
    """Compile a loop that Python calls: without the interpreter's lock, kept in the user's cache folder."""
    compiled = njit(nogil=True, error_model="numpy")(function)
    # The one place numba offers for a cache of one's own; its environment variables would move the user's caches too.
    compiled._cache = LoopCache(function)
    return cast(F, compiled)


def step(function: F) -> F:
    """Compile a function that only loops call: it is part of them and of their cache entries."""
    return cast(F, njit(nogil=True, error_model="numpy")(function))


@intrinsic  # type: ignore[untyped-decorator]
def popcount(typing: Any, word: Any) -> Any:
    """Count the bits of a 64-bit word."""
    return types.uint64(types.uint64), lambda context, builder, signature, args: builder.ctpop(args[0])


@intrinsic  # type: ignore[untyped-decorator]
def lowest(typing: Any, word: Any) -> Any:
    """Find the number of the lowest bit of a 64-bit word that is set."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], context.get_constant(types.boolean, 1))

    return types.int64(types.uint64), generate


def in_threads(call: Callable[[int, int], R], count: int, grain: int, pool: Executor | None) -> list[R]:
    """Cover range(count) by ``call(first, last)`` over pieces of at least `grain`, run by the pool; answers in order.

    Where the pieces begin depends on count and grain alone, and is a multiple of 8.

    Examples
    --------
    >>> in_threads(lambda first, last: last - first, 100, 64, None)
    [100]
    """
    # 64 pieces leave little to wait for at the end on any number of threads, and cost 20 microseconds each.
    size = max(grain, -(-count // 512) * 8)
    if pool is None or count <= size:
        return [call(0, count)] if count else []
    return list(pool.map(lambda first: call(first, min(first + size, count)), range(0, count, size)))
