"""Memory: what is free, and refusing what cannot fit before it is taken; with it the time that it would take."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rsym.errors import RsymError

# Of the free memory, what a resolution that is said to fit may take: others take some too.
SURE = 0.9
# Bytes that are taken without asking: what is free stands in a dozen files.
FEW = float(1 << 24)


def free_memory(root: Path = Path("/")) -> float:
    """Bytes that this process may still take: of the machine, its control group, its own limit; inf where unknown.

    Examples
    --------
    >>> free_memory() > 0
    True
    """
    return min([math.inf, *_of_machine(root), *_of_group(root), *_of_process(root)])


def _of_machine(root: Path) -> Iterator[float]:
    available = _entry(root / "proc/meminfo", "MemAvailable:")
    if available is not None:
        yield 1024.0 * available


def _of_group(root: Path) -> Iterator[float]:
    """What is left in each control group that holds this process; cached files there give way."""
    for line in _lines(root / "proc/self/cgroup"):
        _, kind, path = line.split(":", 2)
        if kind not in ("", "memory"):
            continue
        group = root / "sys/fs/cgroup" / kind
        names = ("memory.limit_in_bytes", "memory.usage_in_bytes") if kind else ("memory.max", "memory.current")
        inner = Path(path.strip().lstrip("/"))
        for folder in (inner, *inner.parents):
            limit, used = (_number(group / folder / name) for name in names)
            if limit is not None and used is not None:
                cached = _entry(group / folder / "memory.stat", "inactive_file ")
                yield float(max(0, limit - used + (cached or 0)))


def _of_process(root: Path) -> Iterator[float]:
    try:
        import resource
    except ImportError:  # Windows has none
        return
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    pages = next(_lines(root / "proc/self/statm"), "").split()
    if limit != resource.RLIM_INFINITY and pages:
        yield float(max(0, limit - int(pages[0]) * resource.getpagesize()))


def resident(root: Path = Path("/")) -> float:
    """Bytes of memory that this process has taken, 0 where that is unknown."""
    size = _entry(root / "proc/self/status", "VmRSS:")
    return 0.0 if size is None else 1024.0 * size


def _entry(path: Path, name: str) -> int | None:
    """The number that follows a name in a file of lines."""
    found = next((line for line in _lines(path) if line.startswith(name)), "")
    number = found[len(name) :].split()[:1]
    return int(number[0]) if number and number[0].isdigit() else None


def _number(path: Path) -> int | None:
    text = next(_lines(path), "").strip()
    return int(text) if text.isdigit() else None


def _lines(path: Path) -> Iterator[str]:
    try:
        yield from path.read_text().splitlines()
    except (OSError, UnicodeDecodeError):
        return


class TooLarge(RsymError):
    """What does not fit; `share` of the resolution may, of a surface."""

    def __init__(self, need: float, free: float) -> None:
        self.need, self.free = need, free
        super().__init__(
            f"about {size_of(need)} of memory are needed, {size_of(free)} are free",
            code="memory",
            remedy="take a smaller resolution",
        )
        # Twice the resolution has four times the cells of a surface.
        self.share = math.sqrt(free / need)


@dataclass(frozen=True)
class Budget:
    """Bytes that may be taken.

    Examples
    --------
    >>> Budget(1e9).claim(4e9)
    Traceback (most recent call last):
        ...
    rsym.sampling.memory.TooLarge: about 4 GB of memory are needed, 1 GB are free; remedy: take a smaller resolution
    """

    free: float = math.inf

    def claim(self, need: float, expected: float = 0.0) -> None:
        """Refuse what needs more than is free; `expected` in the end, as far as that is known."""
        if need > self.free:
            raise TooLarge(max(need, expected), self.free)


def refusal(resolution: Any, fits: Any, need: float, seconds: float, free: float, *, force: bool = True) -> RsymError:
    """The error for a resolution that takes more memory than is free; `force` where the caller can go on all the same.

    Examples
    --------
    >>> print(refusal(100_000, 8_000, 3e12, 1e4, 2e10))
    resolution 100000: about 3e+03 GB of memory and 3 hours are needed, 20 GB are free; \
remedy: resolution 8000 fits, or force=True, on the command line --force, to go on all the same
    """
    forced = ", or force=True, on the command line --force, to go on all the same" if force else ""
    return RsymError(
        f"resolution {resolution}: about {size_of(need)} of memory and {_duration(seconds)} are needed, "
        f"{size_of(free)} are free",
        code="memory",
        remedy=f"resolution {fits} fits{forced}",
    )


@dataclass(frozen=True)
class Demand:
    """What each sample of a lattice takes: bytes, and seconds on one core of a few years ago.

    Examples
    --------
    >>> Demand(100.0, 1e-6).check(100_000, (100_002, 50_002), free=4e9)
    Traceback (most recent call last):
        ...
    rsym.errors.RsymError: resolution 100000: about 500 GB of memory and 80 minutes are needed, 4 GB are free; \
remedy: resolution 8049 fits, or force=True, on the command line --force, to go on all the same
    """

    memory: float
    time: float

    def check(
        self, resolution: int | Sequence[int], counts: Sequence[int], *, force: bool | None = False, free: float = -1.0
    ) -> None:
        """Refuse samples that do not fit, unless forced; None where the caller cannot be."""
        samples = math.prod(counts)
        if force or (free < 0 and samples * self.memory <= FEW):
            return
        free = free_memory() if free < 0 else free
        if samples * self.memory <= free:
            return
        fits = scaled(resolution, SURE * (free / (samples * self.memory)) ** (1 / len(counts)))
        raise refusal(resolution, fits, samples * self.memory, samples * self.time, free, force=force is not None)


def scaled(resolution: int | Sequence[int], share: float) -> int | tuple[int, ...]:
    """A share of a resolution, two cells at least.

    Examples
    --------
    >>> scaled(100, 0.5), scaled((100, 3), 0.5)
    (50, (50, 2))
    """
    if isinstance(resolution, Sequence):
        return tuple(max(2, int(cells * share)) for cells in resolution)
    return max(2, int(resolution * share))


def size_of(amount: float) -> str:
    """Bytes in words.

    Examples
    --------
    >>> size_of(1.5e9)
    '1.5 GB'
    """
    return f"{amount / 1e9:.3g} GB" if amount >= 1e8 else f"{amount / 1e6:.3g} MB"


def _duration(seconds: float) -> str:
    """Of one significant digit: nobody knows it better."""
    for name, length in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 1.5 * length:
            return f"{float(f'{seconds / length:.1g}'):.0f} {name}"
    return f"{max(1.0, seconds):.0f} s"


_UNITS = {"": 1.0, "K": 1e3, "M": 1e6, "G": 1e9, "T": 1e12}
_SIZE = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*([KMGT]?)B?\s*", re.IGNORECASE | re.ASCII)


def bytes_of(memory: Any) -> float:
    """Bytes that a number or a text as "2GB" tells; what is taken and what is free where nothing is told.

    Examples
    --------
    >>> bytes_of("1.5GB"), bytes_of(2e9)
    (1500000000.0, 2000000000.0)
    """
    if memory is None:
        return free_memory() + resident()
    given = _SIZE.fullmatch(memory) if isinstance(memory, str) else None
    if given is not None:
        size = float(given[1]) * _UNITS[given[2].upper()]
    else:
        size = float(memory) if isinstance(memory, int | float) and not isinstance(memory, bool) else math.nan
    if not 0 < size < math.inf:
        raise RsymError(
            f"memory must be a number of bytes or a text, got {memory!r}", code="memory", remedy='for example "2GB"'
        )
    return size
