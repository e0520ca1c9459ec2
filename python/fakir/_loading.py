"""Quasi-static loading from first touch to the critical state."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING, Any

from . import _fakir
from ._format import Row, engineering, html_table, text_table
from ._state import ContactState, CriticalState, contact_state, critical_state

if TYPE_CHECKING:
    import pandas

MOST_STATES = 10_000
"""More states than anybody wants; a step in the wrong unit asks for this many."""

COLUMNS = [
    "indentation_m",
    "force_N",
    "contact_radius_m",
    "pillars_in_contact",
    "pillars_partially_in_contact",
    "smallest_floor_gap_m",
]


class Approach:
    """The states of a loading, by rising indentation; iterates over them."""

    states: list[ContactState]
    """The states, the critical one among them if the loading gets there."""
    critical: CriticalState
    """The critical state, also if the loading ends before it."""

    def __init__(
        self, states: list[ContactState], critical: CriticalState, wall_time: float
    ) -> None:
        self.states, self.critical, self._wall_time = states, critical, wall_time

    def __iter__(self) -> Iterator[ContactState]:
        return iter(self.states)

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, number: int) -> ContactState:
        return self.states[number]

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir approach --json`` prints."""
        return {
            "method": self.critical.method,
            "critical": self.critical.to_dict(),
            "states": [self._row(state) for state in self.states],
            "converged": all(state.converged for state in self.states),
            "wall_time_s": self._wall_time,
            "fakir_version": _fakir.__version__,
        }

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``approach.csv``."""
        import pandas

        return pandas.DataFrame([self._row(state) for state in self.states])

    def _row(self, state: ContactState) -> dict[str, Any]:
        summary = state.to_dict()
        return {
            **{name: summary[name] for name in COLUMNS},
            "force_error_estimate": state.error.force,
            "contact_radius_error_estimate": state.error.contact_radius,
            "critical": state is self.critical.state,
            "beyond_transition": state.beyond_transition,
            "converged": state.converged,
        }

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
    start = time.perf_counter()
    critical = critical_state(_fakir.transition(case, options))
    states = [
        critical.state
        if indentation == critical.indentation
        else _state(_fakir.press(case, indentation, None, options))
        for indentation in _indentations(step, until, past_transition, critical.indentation)
    ]
    return Approach(states, critical, time.perf_counter() - start)


def _state(state: _fakir.State) -> ContactState:
    """Past the transition is where the loading was told to go: no warning."""
    contact = ContactState(state)
    return contact if contact.beyond_transition else contact_state(state)


def _indentations(
    step: float, until: float | None, past_transition: bool, critical: float
) -> list[float]:
    """Multiples of the step, the end of the path, and the critical state in its place."""
    end = critical
    if until is not None and (past_transition or until < critical):
        end = until
    if end / step > MOST_STATES:
        raise ValueError(
            f"step is {engineering(step, 'm')}, which makes {end / step:.0f} states up to an "
            f"indentation of {engineering(end, 'm')}: at most {MOST_STATES} are computed"
        )

    def same(a: float, b: float) -> bool:
        """What differs by rounding only is the same state."""
        return abs(a - b) <= 1e-9 * step

    found = []
    for multiple in count():
        value = multiple * step
        if value >= end or same(value, end):
            break
        if not same(value, critical):
            found.append(value)
    found.append(end)
    if critical <= end:
        found = [value for value in found if not same(value, critical)]
        found.append(critical)
    return sorted(found)
