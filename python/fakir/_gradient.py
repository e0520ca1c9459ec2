"""Derivatives of a contact with respect to the numbers of its system."""

from __future__ import annotations

import copy
import json
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from . import _fakir
from ._format import Row, engineering
from ._numbers import Contact
from ._result import Result
from ._state import ContactState, contact_state

if TYPE_CHECKING:
    from ._system import System

C = TypeVar("C", bound=Contact)

PILLAR_GRADIENT = np.dtype(
    [
        ("i", np.int64),
        ("j", np.int64),
        ("force_N_per_m", np.float64),
        ("indentation_m_per_m", np.float64),
    ]
)
"""Derivatives with respect to the height of a pillar; the prescribed quantity is constant."""


class Gradient(Result, Generic[C]):
    """A contact with its exact derivatives, each with all other numbers constant.

    They are derivatives of the numerical solution, valid up to the next load at which a pillar is touched or released, in SI
    units: N and m divided by the SI unit of the key.
    """

    _titles = ("fakir.Gradient of a contact", "Contact with its derivatives")

    __slots__ = ("_state",)

    def __init__(self, state: C, summary: dict[str, Any]) -> None:
        self._state = state
        self._summary = summary

    @property
    def state(self) -> C:
        """The contact; the critical state if no load was given."""
        return self._state

    @property
    def stiffness(self) -> float:
        """Derivative of the force with respect to the indentation, N/m."""
        return float(self._summary["stiffness_N_per_m"])

    @property
    def force(self) -> dict[str, float] | None:
        """Derivatives of the force by the keys of the case, such as ``pattern.pillar.height``; None if the force is prescribed.

        The depth of the floor changes with the height of the pillars; with the pitch, the positions of pillars and lens axis in
        units of the pitch are constant.
        """
        return self._by_key("force_N")

    @property
    def indentation(self) -> dict[str, float] | None:
        """Derivatives of the indentation by the keys of the case; None if the indentation is prescribed."""
        return self._by_key("indentation_m")

    @property
    def contact_area(self) -> dict[str, float] | None:
        """Derivatives of the contact area, m^2; None if the contact edge crosses a pillar."""
        return self._by_key("contact_area_m2")

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir press --gradient --json`` prints: that of the contact, with ``gradient``. Without a load it is the
        contact of the critical state."""
        return {**self._state.to_dict(), "gradient": super().to_dict()}

    def _by_key(self, name: str) -> dict[str, float] | None:
        derivatives: dict[str, float] | None = copy.deepcopy(self._summary[name])
        return derivatives

    @property
    def pillars(self) -> npt.NDArray[np.void]:
        """Derivatives with respect to the individual height of every touched pillar, sorted by distance from the lens axis; none
        on a flat surface."""
        names = PILLAR_GRADIENT.names or ()
        rows = [tuple(row[name] or 0 for name in names) for row in self._summary["pillars"]]
        return np.array(rows, dtype=PILLAR_GRADIENT)

    def _rows(self) -> list[Row]:
        return [*self._state._rows(), ("stiffness", engineering(self.stiffness, "N/m"))]


def gradient(
    system: System, load: tuple[float | None, float | None], options: _fakir.Options
) -> Gradient[ContactState]:
    """The gradient at a load, or at the critical state."""
    state, summary = _fakir.gradient(system._case, *load, options)
    return Gradient(contact_state(state, system), json.loads(summary))
