"""Verification: two independent methods on the same problem."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from . import _fakir
from ._format import Row, engineering
from ._result import Result
from ._run import warn_of_interactions
from ._state import ContactState

if TYPE_CHECKING:
    from ._system import System


class Difference(NamedTuple):
    """A relative difference, and the value accepted by the error estimates."""

    relative: float
    allowed: float


def _number(value: float | None) -> float:
    """A number of a JSON object; null becomes NaN."""
    return float("nan") if value is None else value


class Loaded(Protocol):
    """A result with a force and an indentation."""

    @property
    def force(self) -> float: ...
    @property
    def indentation(self) -> float: ...


class Opinion(Result):
    """Comparison of two results for one problem."""

    verdict: str
    """``"agree"``, ``"disagree"``, or ``"cannot tell"`` if a method did not converge or its result has no significant digit."""
    doubt: str | None
    """Why the comparison is inconclusive; None if it is conclusive."""
    force: Difference
    """Difference of the elements from the spectral method or from discs, or of the coarser cells from the finer ones."""
    indentation: Difference
    """The same for the indentation."""
    contact_radius: Difference | None
    """The same for the contact radius on the tops; None on two meshes, with discs, with adhesion, and where the errors leave no digit."""
    contact_area: Difference | None
    """The same for the contact area, on rounded tops without the floor; None on two meshes, and on flat tops without adhesion."""
    floor_share: Difference | None
    """The same for the fraction of the force carried by the floor; None if it carries no load, and on two meshes."""

    def __init__(self, summary: dict[str, Any]) -> None:
        self._summary = summary
        self.verdict, self.doubt = summary["verdict"], summary["doubt"]
        self.force, self.indentation = (self._difference(name) for name in ("force", "indentation"))
        self.contact_radius, self.contact_area, self.floor_share = (
            self._difference(name) if name in summary["relative_difference"] else None
            for name in ("contact_radius", "contact_area", "floor_share")
        )

    def _difference(self, name: str) -> Difference:
        summary = self._summary
        return Difference(
            _number(summary["relative_difference"][name]),
            _number(summary["allowed_difference"][name]),
        )

    @property
    def agrees(self) -> bool:
        """Whether both converged and agree within their error estimates."""
        return self.verdict == "agree"

    def _rows_of(self, answers: Sequence[tuple[str, Loaded]]) -> list[Row]:
        rows = [
            (name, f"{engineering(s.force, 'N')}, {engineering(s.indentation, 'm')}")
            for name, s in answers
        ]
        differences = [
            ("force", self.force),
            ("indentation", self.indentation),
            ("contact radius", self.contact_radius),
            ("contact area", self.contact_area),
            ("floor share", self.floor_share),
        ]
        for name, of in differences:
            if of is not None:
                rows.append((f"difference in {name}", f"{of.relative:.1e}, allowed {of.allowed:.1e}"))
        verdicts = {
            "agree": "the answers agree",
            "disagree": "THE ANSWERS DISAGREE",
            "cannot tell": f"inconclusive: {self.doubt}",
        }
        return [*rows, ("", verdicts[self.verdict])]


class Verification(Opinion):
    """The results of both methods, and their differences."""

    _titles = ("fakir.Verification", "Verification by an independent method")

    spectral: ContactState
    """Result of the accurate spectral method."""
    elements: tuple[ContactState, ContactState]
    """Results of boundary elements, on half as many cells across a pillar and on all."""

    def __init__(self, summary: dict[str, Any], states: list[ContactState]) -> None:
        super().__init__(summary)
        self.spectral, coarse, fine = states
        self.elements = coarse, fine

    def _rows(self) -> list[Row]:
        coarse, fine = self.elements
        return self._rows_of(
            [("spectral", self.spectral), ("elements, coarse", coarse), ("elements", fine)]
        )


def checked_cells(cells_per_diameter: int) -> None:
    """Raises an error for numbers of cells of which half are too few, or that are too large."""
    if not 16 <= cells_per_diameter <= 1024:
        raise ValueError(f"cells_per_diameter is {cells_per_diameter}: give 16 to 1024")


def verify(
    system: System,
    load: tuple[float | None, float | None],
    cells_per_diameter: int,
    options: _fakir.Options,
) -> Verification:
    """Solves with both methods."""
    checked_cells(cells_per_diameter)
    warn_of_interactions(system._case, "verify")
    summary, states = _fakir.verify(system._case, *load, cells_per_diameter, options)
    return Verification(json.loads(summary), [ContactState(state, system) for state in states])
