"""Memory: what is free, and refusing what cannot fit before it is taken."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rsym.errors import RsymError


def free_memory(root: Path = Path("/")) -> float:
    """Bytes that this process may still take: of the machine, its control group, its own limit; inf where unknown.

    Examples
    --------
    >>> free_memory() > 0
    True
    """
    return min([math.inf, *_of_machine(root), *_of_group(root), *_of_process(root)])


def _of_machine(root: Path) -> Iterator[float]:
    fields = _table(root / "proc/meminfo", ":")
    if "MemAvailable" in fields:
        yield 1024.0 * fields["MemAvailable"]


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
                cached = _table(group / folder / "memory.stat", " ").get("inactive_file", 0)
                yield float(max(0, limit - used + cached))


def _of_process(root: Path) -> Iterator[float]:
    try:
        import resource
    except ImportError:  # Windows has none
        return
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    pages = next(_lines(root / "proc/self/statm"), "").split()
    if limit != resource.RLIM_INFINITY and pages:
        yield float(max(0, limit - int(pages[0]) * resource.getpagesize()))


def _table(path: Path, mark: str) -> dict[str, int]:
    """The numbers of a file of lines, name, mark, number."""
    rows = (line.partition(mark) for line in _lines(path))
    return {name: int(rest.split()[0]) for name, _, rest in rows if rest.split()[:1] and rest.split()[0].isdigit()}


def _number(path: Path) -> int | None:
    text = next(_lines(path), "").strip()
    return int(text) if text.isdigit() else None


def _lines(path: Path) -> Iterator[str]:
    try:
        yield from path.read_text().splitlines()
    except (OSError, UnicodeDecodeError):
        return


class TooLarge(RsymError):
    """What does not fit; `share` of the resolution may."""

    def __init__(self, need: float, free: float) -> None:
        super().__init__(
            f"about {_size(need)} of memory are needed, {_size(free)} are free",
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


def _size(amount: float) -> str:
    return f"{amount / 1e9:.3g} GB" if amount >= 1e8 else f"{amount / 1e6:.3g} MB"
