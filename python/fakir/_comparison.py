"""The critical state by every method, approximate to exact."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from . import _fakir
from ._format import Row, engineering
from ._result import Result
from ._run import warn_of_interactions
from ._state import CriticalState

if TYPE_CHECKING:
    import pandas

    from ._system import System


class Comparison(Result):
    """Critical states by method; ``remark`` gives the reason if a method does not apply."""

    _titles = ("fakir.Comparison: critical force (difference)", "Critical force by every method (difference)")

    rows: list[dict[str, Any]]
    """A row for every method, with the names of ``fakir compare --json``."""
    states: dict[str, CriticalState]
    """The critical states of the methods with a numerical solution."""

    def __init__(self, summary: dict[str, Any], states: dict[str, CriticalState]) -> None:
        self._summary, self.rows, self.states = summary, summary["methods"], states

    @property
    def reference(self) -> str | None:
        """The reference of the differences: the most accurate method with a result."""
        return self._summary["reference"]  # type: ignore[no-any-return]

    def to_pandas(self) -> pandas.DataFrame:
        """The comparison as a table, one row for every method."""
        import pandas

        return pandas.DataFrame(self.rows).set_index("method")

    def _rows(self) -> list[Row]:
        rows = []
        for row in self.rows:
            if row["critical_force_N"] is None:
                rows.append((row["method"], row["remark"]))
                continue
            force = engineering(row["critical_force_N"], "N", 5)
            difference = row["force_difference"]
            apart = "reference" if difference is None else f"{difference:+.1e}"
            rows.append((row["method"], f"{force}  ({apart})"))
        return rows


def compare(system: System, options: _fakir.Options) -> Comparison:
    """Computes the critical state by every method."""
    warn_of_interactions(system._case, "compare")
    summary, found = _fakir.compare(system._case, options)
    states = {name: CriticalState(state, system) for name, state in found}
    return Comparison(json.loads(summary), states)
