"""The one family of exceptions, and the one of warnings."""

from __future__ import annotations

import sys
import warnings


class RsymError(ValueError):
    """Input that rsym refuses: what was expected, what came, where, and the remedy.

    Parameters
    ----------
    message : str
        What was expected and what came.
    code : str
        A stable word for programs, for example ``"unknown-name"``.
    where : str
        The place, for example ``"line 3, column 7"``; empty if there is none.
    remedy : str
        What to do about it.

    Examples
    --------
    >>> error = RsymError("the letter 'a' has no value", code="letter", remedy="give letters={a: 5}")
    >>> print(error)
    the letter 'a' has no value; remedy: give letters={a: 5}
    >>> error.code
    'letter'
    """

    def __init__(self, message: str, *, code: str, where: str = "", remedy: str = "") -> None:
        super().__init__(message, code, where, remedy)
        self.message = message
        self.code = code
        self.where = where
        self.remedy = remedy

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        remedy = f"; remedy: {self.remedy}" if self.remedy else ""
        return f"{place}{self.message}{remedy}"

    def __reduce__(self) -> tuple[object, ...]:
        return _restore, (self.message, self.code, self.where, self.remedy)


class RsymWarning(UserWarning):
    """A result that is not all that was asked for: a clipped surface, say, or detail below the resolution.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", RsymWarning)  # they are known here
    """


def warn(message: str) -> None:
    """Warn of a result, at the line outside rsym that asked for it."""
    frame, level = sys._getframe(1), 2
    # What is warned of at the end of a `with` comes through contextlib.
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in ("rsym", "contextlib"):
        frame, level = frame.f_back, level + 1
    warnings.warn(message, RsymWarning, stacklevel=level)


def _restore(message: str, code: str, where: str, remedy: str) -> RsymError:
    """Rebuild an error that has crossed a process border."""
    return RsymError(message, code=code, where=where, remedy=remedy)
