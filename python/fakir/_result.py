"""Base classes of results."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Mapping
from typing import Any, Generic, NamedTuple, NoReturn, Self, TypeVar, overload

from . import _fakir
from ._format import Shown

T = TypeVar("T", covariant=True)


class Limit(NamedTuple):
    """A validity limit of the model, evaluated for a contact."""

    name: str
    """As in `limits` of the results."""
    value: float
    """Its value; if the name ends with a unit, in that unit."""
    threshold: float | None
    """Threshold at which the model becomes doubtful; None if the value indicates only a change of the result."""
    strained: bool
    """Whether the threshold is exceeded."""


class Result(Shown):
    """Result of a computation. Numbers are in SI units."""

    __slots__ = ("_summary",)
    _summary: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The object that the command prints with ``--json``: same names, same numbers."""
        return copy.deepcopy(self._summary)


class Numbered(Result):
    """A result whose numbers are attributes."""

    __slots__ = ("_numbers",)
    _numbers: dict[str, Any]
    """The numbers by the paths of the record."""


class Answer(Numbered):
    """A contact, a critical state or a cycle. Numbers are in SI units."""

    __slots__ = ("_answer",)

    def __init__(self, answer: _fakir.Answer) -> None:
        self._answer = answer
        self._numbers = answer.numbers()
        self._summary = json.loads(answer.json())

    @property
    def termination(self) -> str:
        """Reason for the end of the iteration."""
        return self._answer.termination

    @property
    def wall_time(self) -> float:
        """Computing time, s."""
        return float(self._summary["wall_time_s"])

    @property
    def warnings(self) -> list[str]:
        """Warnings."""
        return self._answer.warnings

    @property
    def limits(self) -> list[Limit]:
        """The validity limits of the model, evaluated for the contact.

        ``any(limit.strained for limit in state.limits)`` is true if a limit is exceeded. Rounded tops have none.
        """
        return [Limit(**limit) for limit in self._summary.get("limits", [])]


class Number(Generic[T]):
    """A number of a result, or a group of them, with documentation from the record."""

    def __init__(self, read: Callable[[Mapping[str, Any]], T], doc: str) -> None:
        self._read, self.__doc__ = read, doc

    @overload
    def __get__(self, answer: None, owner: type) -> Self: ...
    @overload
    def __get__(self, answer: Numbered, owner: type) -> T: ...
    def __get__(self, answer: Numbered | None, owner: type) -> Self | T:
        return self if answer is None else self._read(answer._numbers)

    def __set__(self, answer: Numbered, value: NoReturn) -> None:
        raise AttributeError("numbers of results cannot be set")
