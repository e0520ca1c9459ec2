"""The homogenised lattice: pillars as a layer of springs on a half-space."""

from __future__ import annotations

from typing import NamedTuple

from . import _fakir
from ._run import options
from ._state import CriticalState, critical_state
from ._system import System


class HomogenisedLattice(NamedTuple):
    """The constants of the model for one system, and its critical state."""

    layer_compliance: float
    """Compliance of the layer of springs (displacement per pressure), m/Pa."""
    critical_central_force: float
    """Force on the central pillar when the floor is reached, N."""
    critical_central_pressure: float
    """That force divided by the area of a lattice cell, Pa."""
    critical: CriticalState
    """The critical state of the model."""


def homogenised(system: System) -> HomogenisedLattice:
    """Computes the homogenised lattice of a system.

    Raises
    ------
    SolveError
        If the pattern is too dense for the model.
    """
    case = system._case.with_settings(["method.name=homogenised"])
    critical = critical_state(_fakir.transition(case, options()), system)
    return HomogenisedLattice(*_fakir.homogenised(case), critical)
