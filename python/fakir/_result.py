"""Results: the classes that all of them are based on."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Mapping
from typing import Any, Generic, NamedTuple, NoReturn, Self, TypeVar, overload

from . import _fakir
from ._format import Shown

T = TypeVar("T", covariant=True)


class Limit(NamedTuple):
    """A condition of the model, and how near a contact comes to where it ends."""

    name: str
    """As in `limits` of the results."""
    value: float
    """Its value; where the name ends in a unit, in that."""
    threshold: float | None
    """From where on the model is doubtful; None of what only would change the answer."""
    strained: bool
    """Whether it is doubtful here."""


class Result(Shown):
    """What a computation returns. Numbers are in SI units."""

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
        """Why the solver stopped."""
        return self._answer.termination

    @property
    def wall_time(self) -> float:
        """Duration of the computation, s."""
        return float(self._summary["wall_time_s"])

    @property
    def warnings(self) -> list[str]:
        """What to be careful about."""
        return self._answer.warnings

    @property
    def limits(self) -> list[Limit]:
        """The conditions of the model, and how near the contact comes to where they end.

        ``any(limit.strained for limit in state.limits)`` is true of an answer beyond its model. Rounded tops have none.
        """
        return [Limit(**limit) for limit in self._summary.get("limits", [])]


class Number(Generic[T]):
    """A number of an answer, or a group of them; its documentation is of the record."""

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
