"""The critical state by every method, coarse to exact."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from . import _fakir
from ._format import Row, engineering, html_table, text_table
from ._state import CriticalState
from .errors import SolveError

if TYPE_CHECKING:
    import pandas

METHODS = {
    "homogenised": ["method.name=homogenised"],
    "punch_plain": ["method.name=punch", "method.form=plain"],
    "punch_corrected": ["method.name=punch", "method.form=corrected"],
    "love": ["method.name=love"],
    "spectral_default": ["method.name=spectral", "method.accuracy=default"],
    "spectral_accurate": ["method.name=spectral", "method.accuracy=accurate"],
}


class Comparison:
    """Critical states by method; what does not apply says why in its ``remark``."""

    rows: list[dict[str, Any]]
    """One for every method, with the names of ``fakir compare --json``."""
    states: dict[str, CriticalState]
    """The critical states of the methods that solve something."""

    def __init__(self, rows: list[dict[str, Any]], states: dict[str, CriticalState]) -> None:
        self.rows, self.states = rows, states

    @property
    def reference(self) -> str | None:
        """The method that differences are from: the most accurate one with an answer."""
        solved = [name for name, state in self.states.items() if state.converged]
        return solved[-1] if solved else None

    def to_pandas(self) -> pandas.DataFrame:
        """A table."""
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

    def __repr__(self) -> str:
        return text_table("fakir.Comparison: critical force (difference)", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Critical force by every method (difference)", self._rows())


def compare(case: _fakir.Case, options: _fakir.Options) -> Comparison:
    """Asks every method."""
    rows: list[dict[str, Any]] = []
    for name, (force, indentation, top, floor) in _fakir.closed_forms(case, None):
        if force > 0.0:
            rows.append(_row(name, force, indentation, max(top, floor)))
    states: dict[str, CriticalState] = {}
    for name, settings in METHODS.items():
        start = time.perf_counter()
        try:
            critical = CriticalState(_fakir.transition(case.with_settings(settings), options))
        except SolveError as error:
            rows.append({**_row(name, None, None, None), "remark": str(error)})
            continue
        states[name] = critical
        row = _row(name, critical.force, critical.indentation, critical.contact_radius)
        row["pillars_in_contact"] = critical.pillars_in_contact
        row["force_error_estimate"] = critical.error.force
        row["contact_radius_error_estimate"] = critical.error.contact_radius
        row["iterations"] = critical.iterations
        row["converged"] = critical.converged
        row["wall_time_s"] = time.perf_counter() - start
        row["remark"] = None if critical.converged else critical.state.termination
        rows.append(row)
    comparison = Comparison(rows, states)
    reference = comparison.reference
    if reference is not None:
        exact = states[reference]
        for row in rows:
            if row["method"] != reference:
                row["force_difference"] = _difference(row["critical_force_N"], exact.force)
                row["indentation_difference"] = _difference(
                    row["critical_indentation_m"], exact.indentation
                )
    return comparison


def _row(
    method: str, force: float | None, indentation: float | None, radius: float | None
) -> dict[str, Any]:
    return {
        "method": method,
        "critical_force_N": force,
        "critical_indentation_m": indentation,
        "critical_contact_radius_m": radius,
        "pillars_in_contact": None,
        "force_difference": None,
        "indentation_difference": None,
        "force_error_estimate": None,
        "contact_radius_error_estimate": None,
        "converged": True,
        "iterations": None,
        "wall_time_s": None,
        "remark": None,
    }


def _difference(value: float | None, reference: float) -> float | None:
    return value / reference - 1.0 if value is not None and reference != 0.0 else None
