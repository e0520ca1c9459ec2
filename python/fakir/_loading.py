"""Quasi-static loading from first contact to the critical state, and beyond."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from . import _fakir
from ._format import Row, engineering
from ._quantity import UNITS, Dimension, Quantity, si
from ._result import Result
from ._state import ContactState, CriticalState, contact_state, critical_state

if TYPE_CHECKING:
    import pandas

    from ._system import System


State = TypeVar("State")


class Loading(Result, Generic[State]):
    """The states of a loading of any problem."""

    states: list[State]
    """The states, including the critical one if it is reached."""

    def __init__(self, summary: dict[str, Any], states: list[State]) -> None:
        self._summary, self.states = summary, states

    def __iter__(self) -> Iterator[State]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, number: int) -> State:
        return self.states[number]

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``approach.csv``."""
        import pandas

        return pandas.DataFrame(self._summary["states"])


def in_order(
    summary: dict[str, Any], critical: State | None, others: Iterator[State]
) -> list[State]:
    """The states of a loading, including the critical one if it is reached."""
    return [
        critical if row["critical"] and critical is not None else next(others)
        for row in summary["states"]
    ]


class Approach(Loading[ContactState]):
    """The states of a loading, by increasing indentation; iterable."""

    _titles = ("fakir.Approach: indentation, force", "Approach of the lens: indentation, force")

    critical: CriticalState | None
    """The critical state, even if the loading ends before it; None under lenses without one."""

    def __init__(
        self, summary: dict[str, Any], states: list[ContactState], critical: CriticalState | None
    ) -> None:
        super().__init__(summary, states)
        self.critical = critical

    def _rows(self) -> list[Row]:
        rows = []
        critical = self.critical.state if self.critical is not None else None
        for state in self.states:
            mark = ", critical" if state is critical else ""
            if state.floor is not None:
                mark = f", {engineering(state.floor.force, 'N', 4)} of it on the floor"
            text = f"{engineering(state.force, 'N')}, {state.pillars_in_contact} pillars{mark}"
            rows.append((engineering(state.indentation, "m"), text))
        return rows


Path = tuple[float, float | None, float | None, float | None]
"""Step, `until`, `to` and `to_force` of a loading, in SI units."""


def checked_path(
    step: Quantity,
    until: Quantity | None,
    past_transition: bool,
    to: Quantity | None,
    to_force: Quantity | None,
) -> Path:
    """A loading in steps with at most one prescribed end."""
    if past_transition:
        if until is None or to is not None:
            raise TypeError("past_transition needs until: the indentation to go to")
        warnings.warn(
            "past_transition is old: give the last indentation as to in place of until",
            FutureWarning,
            stacklevel=3,
        )
        until, to = None, until
    if sum(end is not None for end in (until, to, to_force)) > 1:
        raise TypeError("a loading has one end: give one of until, to and to_force")

    def end(value: Quantity | None, dimension: Dimension, name: str) -> float | None:
        return None if value is None else _positive(value, dimension, name)

    return (
        _positive(step, "length", "step"),
        end(until, "length", "until"),
        end(to, "length", "to"),
        end(to_force, "force", "to_force"),
    )


def _positive(value: Quantity, dimension: Dimension, name: str) -> float:
    number = si(value, dimension, name)
    if not 0.0 < number < float("inf"):
        raise ValueError(f"{name} is {number} {UNITS[dimension]}: it must be greater than 0")
    return number


def approach(system: System, path: Path, options: _fakir.Options) -> Approach:
    """Computes all states of a loading."""
    found, reached, others = _fakir.approach(system._case, *path, options)
    summary = json.loads(found)
    critical = None if reached is None else critical_state(reached, system)
    rest = (_state(state, system) for state in others)
    state = critical.state if critical is not None else None
    return Approach(summary, in_order(summary, state, rest), critical)


def _state(state: _fakir.State, system: System) -> ContactState:
    """The contact state, without a warning that floor contact is ignored, which was requested."""
    contact = ContactState(state, system)
    return contact if contact._ignores_floor else contact_state(state, system)
