"""Quasi-static loading from first touch to the critical state."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from . import _fakir
from ._format import Row, engineering, html_table, text_table
from ._state import ContactState, CriticalState, contact_state, critical_state

if TYPE_CHECKING:
    import pandas


class Approach:
    """The states of a loading, by rising indentation; iterates over them."""

    states: list[ContactState]
    """The states, the critical one among them if the loading gets there."""
    critical: CriticalState
    """The critical state, also if the loading ends before it."""

    def __init__(
        self, summary: dict[str, Any], states: list[ContactState], critical: CriticalState
    ) -> None:
        self._summary, self.states, self.critical = summary, states, critical

    def __iter__(self) -> Iterator[ContactState]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, number: int) -> ContactState:
        return self.states[number]

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir approach --json`` prints."""
        return copy.deepcopy(self._summary)

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``approach.csv``."""
        import pandas

        return pandas.DataFrame(self._summary["states"])

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


def approach(
    case: _fakir.Case,
    step: float,
    until: float | None,
    past_transition: bool,
    options: _fakir.Options,
) -> Approach:
    """Computes all states of a loading."""
    if not 0.0 < step < float("inf"):
        raise ValueError(f"step is {step} m: it must be greater than 0")
    if until is not None and not 0.0 <= until < float("inf"):
        raise ValueError(f"until is {until} m: it must be 0 or greater")
    if past_transition and until is None:
        raise TypeError("past_transition needs until: the indentation to go to")
    found, reached, others = _fakir.approach(case, step, until, past_transition, options)
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
