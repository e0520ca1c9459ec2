"""Exceptions, with the messages of the command line."""

from __future__ import annotations

__all__ = [
    "CaseError",
    "DesignError",
    "FakirError",
    "FakirWarning",
    "NotConverged",
    "SolveError",
    "StudyError",
    "WorkersLost",
]


class FakirError(Exception):
    """Base class of all errors."""


class CaseError(FakirError, ValueError):
    """An invalid case or study: contains the position, the reason and what is accepted.

    Attributes
    ----------
    file, line, column
        The position in a file or override, if any.
    key
        The invalid key, as in ``"pattern.pillar.diameter"``.
    """

    file: str | None
    line: int | None
    column: int | None
    key: str | None

    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        key: str | None = None,
    ) -> None:
        super().__init__(message)
        self.file, self.line, self.column, self.key = file, line, column, key

    def __reduce__(self) -> tuple[type[CaseError], tuple[object, ...]]:
        return type(self), (self.args[0], self.file, self.line, self.column, self.key)


class SolveError(FakirError):
    """There is no such contact, or it exceeds the memory limit."""


class NotConverged(FakirError):
    """The solution did not converge. ``result`` contains the last iterate."""

    result: object

    def __init__(self, message: str, result: object = None) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[NotConverged], tuple[object, ...]]:
        return type(self), (self.args[0],)


class DesignError(FakirError):
    """A design or a scatter that is invalid, or without a solution."""


class FitError(FakirError, ValueError):
    """Invalid measurements, or an invalid fit."""


class StudyError(FakirError):
    """A sweep that cannot be started, resumed or written."""


class WorkersLost(FakirError):
    """The workers of a sweep were lost more often than cases are repeated.

    If the sweep has an ``output`` folder, its journal contains the results obtained before: continue with ``resume=True``.
    """


class FakirWarning(UserWarning):
    """A result that needs attention."""
