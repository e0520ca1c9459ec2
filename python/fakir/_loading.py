"""Quasi-static loading from first touch to the critical state."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from . import _fakir
from ._format import Row, engineering, html_table, text_table
from ._quantity import Quantity, si
from ._state import ContactState, CriticalState, contact_state, critical_state

if TYPE_CHECKING:
    import pandas


State = TypeVar("State")


class Loading(Generic[State]):
    """The states of a loading, whatever is loaded."""

    states: list[State]
    """The states, the critical one among them if the loading gets there."""

    def __init__(self, summary: dict[str, Any], states: list[State]) -> None:
        self._summary, self.states = summary, states

    def __iter__(self) -> Iterator[State]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, number: int) -> State:
        return self.states[number]

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir approach --json`` prints."""
        return copy.deepcopy(self._summary)

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``approach.csv``."""
        import pandas

        return pandas.DataFrame(self._summary["states"])


class Approach(Loading[ContactState]):
    """The states of a loading, by rising indentation; iterates over them."""

    critical: CriticalState
    """The critical state, also if the loading ends before it."""

    def __init__(
        self, summary: dict[str, Any], states: list[ContactState], critical: CriticalState
    ) -> None:
        super().__init__(summary, states)
        self.critical = critical

    def _rows(self) -> list[Row]:
        rows = []
        for state in self.states:
            mark = ", critical" if state is self.critical.state else ""
            text = f"{engineering(state.force, 'N')}, {state.pillars_in_contact} pillars{mark}"
            rows.append((engineering(state.indentation, "m"), text))
        return rows

    def __repr__(self) -> str:
        return text_table("fakir.Approach: indentation, force", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Approach of the lens: indentation, force", self._rows())


def checked_path(
    step: Quantity, until: Quantity | None, past_transition: bool
) -> tuple[float, float | None]:
    """Step and last indentation of a loading, m."""
    size = si(step, "length", "step")
    end = None if until is None else si(until, "length", "until")
    if not 0.0 < size < float("inf"):
        raise ValueError(f"step is {size} m: it must be greater than 0")
    if end is not None and not 0.0 <= end < float("inf"):
        raise ValueError(f"until is {end} m: it must be 0 or greater")
    if past_transition and end is None:
        raise TypeError("past_transition needs until: the indentation to go to")
    return size, end


def approach(
    case: _fakir.Case,
    step: Quantity,
    until: Quantity | None,
    past_transition: bool,
    options: _fakir.Options,
) -> Approach:
    """Computes all states of a loading."""
    size, end = checked_path(step, until, past_transition)
    found, reached, others = _fakir.approach(case, size, end, past_transition, options)
    summary = json.loads(found)
    critical = critical_state(reached)
    rest = iter(others)
    states = [
        critical.state if row["critical"] else _state(next(rest)) for row in summary["states"]
    ]
    return Approach(summary, states, critical)


def _state(state: _fakir.State) -> ContactState:
    """Past the transition is where the loading was told to go: no warning."""
    contact = ContactState(state)
    return contact if contact.beyond_transition else contact_state(state)
