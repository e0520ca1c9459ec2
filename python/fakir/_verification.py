"""A second opinion: two independent methods on the same question."""

from __future__ import annotations

import copy
import json
from typing import Any, NamedTuple

from . import _fakir
from ._format import Row, engineering, html_table, text_table
from ._state import ContactState


class Difference(NamedTuple):
    """A relative difference, and what the error estimates allow."""

    relative: float
    allowed: float


class Verification:
    """The answers of both methods, and what they differ by."""

    verdict: str
    """``"agree"``, ``"disagree"``, or ``"cannot tell"`` where a method did not converge or knows no
    digit."""
    doubt: str | None
    """Why it cannot be told; None if it can."""
    spectral: ContactState
    """By the accurate spectral method."""
    elements: tuple[ContactState, ContactState]
    """By Love elements, on half as many cells across a pillar and on all."""
    force: Difference
    """Of the elements from the spectral method."""
    indentation: Difference
    """The same of the indentation."""

    def __init__(self, summary: dict[str, Any], states: list[ContactState]) -> None:
        self._summary = summary
        self.verdict, self.doubt = summary["verdict"], summary["doubt"]
        self.force, self.indentation = (
            Difference(summary["relative_difference"][name], summary["allowed_difference"][name])
            for name in ("force", "indentation")
        )
        self.spectral, coarse, fine = states
        self.elements = coarse, fine

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir verify --json`` prints."""
        return copy.deepcopy(self._summary)

    @property
    def agrees(self) -> bool:
        """Whether both converged and agree within their error estimates."""
        return self.verdict == "agree"

    def _rows(self) -> list[Row]:
        coarse, fine = self.elements
        states = [("spectral", self.spectral), ("elements, coarse", coarse), ("elements", fine)]
        rows = [(name, f"{engineering(s.force, 'N')}, {engineering(s.indentation, 'm')}") for name, s in states]
        for name, (relative, allowed) in [("force", self.force), ("indentation", self.indentation)]:
            rows.append((f"difference in {name}", f"{relative:.1e}, allowed {allowed:.1e}"))
        verdicts = {
            "agree": "the methods agree",
            "disagree": "THE METHODS DISAGREE",
            "cannot tell": f"it cannot be told: {self.doubt}",
        }
        return [*rows, ("", verdicts[self.verdict])]

    def __repr__(self) -> str:
        return text_table("fakir.Verification", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Verification by an independent method", self._rows())


def verify(
    case: _fakir.Case,
    load: tuple[float | None, float | None],
    cells_per_diameter: int,
    options: _fakir.Options,
) -> Verification:
    """Asks both methods."""
    if not 16 <= cells_per_diameter <= 1024:
        raise ValueError(f"cells_per_diameter is {cells_per_diameter}: give 16 to 1024")
    summary, states = _fakir.verify(case, *load, cells_per_diameter, options)
    return Verification(json.loads(summary), [ContactState(state) for state in states])
