"""Work that makes many objects and hardly any garbage: imports, formulas, compilers."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def uncollected() -> Iterator[None]:
    """Do not look for garbage meanwhile: a sixth of the time to the first mesh, in which none is found.

    What there is at the end counts as old, so that the next look at young objects does not go through it either: a
    tenth of a second. Within another one, or where the caller looks for none either, nothing changes.

    Examples
    --------
    >>> with uncollected():
    ...     gc.isenabled()
    False
    >>> gc.isenabled()
    True
    """
    looks = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if looks:
            if not gc.get_freeze_count():  # what the caller has frozen stays so
                gc.freeze()
                gc.unfreeze()
            gc.enable()
