"""What can go wrong, in the words of the command line."""

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
    """Any reason why there is no result."""


class CaseError(FakirError, ValueError):
    """A case or a study that cannot be: it says where, why, and what would be accepted.

    Attributes
    ----------
    file, line, column
        The place in a file or override, as far as there is one.
    key
        The key that is to blame, as in ``"texture.pillar.diameter"``.
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
    """There is no such contact, or it does not fit the memory allowed."""


class NotConverged(FakirError):
    """A solution that is not one. What was reached is in ``result``."""

    result: object

    def __init__(self, message: str, result: object = None) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[NotConverged], tuple[object, ...]]:
        return type(self), (self.args[0],)


class DesignError(FakirError):
    """A design or a spread that cannot be asked for, or found."""


class FitError(FakirError, ValueError):
    """Measurements that cannot be used, or a fit that cannot be asked for."""


class StudyError(FakirError):
    """A sweep that cannot be begun, resumed or written."""


class WorkersLost(FakirError):
    """The workers of a sweep were lost more often than cases are tried again.

    What was answered before is in the journal, if the sweep has an ``output`` folder: go on with
    ``resume=True``.
    """


class FakirWarning(UserWarning):
    """A result to be read with care."""
