"""Loading and unloading with adhesive pillar tops."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _fakir
from ._format import Row, engineering
from ._numbers import CycleError, CycleNumbers
from ._quantity import FloatArray, Quantity, si
from ._run import warn
from ._state import CriticalState, critical_state
from .errors import NotConverged

if TYPE_CHECKING:
    import pandas

    from ._system import System

Drive = Literal["displacement", "force", "machine"]


@dataclass(frozen=True, init=False)
class Adhesion:
    """Short-range work of adhesion between the lens and the pillar tops.

    Parameters
    ----------
    work
        Energy per area released on attachment: a number in J/m^2, or a string such as ``"50 mJ/m2"``.
    work_receding
        Energy per area required for detachment, if it is larger.
    floor
        Whether the floor is adhesive too: the lens jumps into contact with the floor at first touch, and detaches at a smaller
        indentation.
    """

    work: float
    work_receding: float | None
    floor: bool

    def __init__(
        self, work: Quantity, work_receding: Quantity | None = None, *, floor: bool = False
    ) -> None:
        object.__setattr__(self, "work", si(work, "energy per area", "adhesion.work"))
        receding = work_receding
        if receding is not None:
            receding = si(receding, "energy per area", "adhesion.work_receding")
        object.__setattr__(self, "work_receding", receding)
        object.__setattr__(self, "floor", bool(floor))


@dataclass(frozen=True)
class AdhesiveFloor:
    """The floor in a cycle. Numbers are in SI units."""

    force_before_jump: float | None
    """Force before jump-in to an adhesive floor, N."""
    jump: dict[str, Any] | None
    """The state after jump-in to an adhesive floor: a row of ``floor.csv``."""
    last: dict[str, Any] | None
    """The last state with floor contact; None if the contact persists."""
    force_after_loss: float | None
    """Force after detachment of the floor, N."""
    cells_across_ring: float | None
    """Number of cells across the detached ring around a pillar in an adhesive floor."""
    coarse: bool
    """Whether the cells are so coarse that only orders of magnitude are meaningful."""
    errors: dict[str, float]
    """Estimated relative errors of ``turn_force``, ``turn_indentation``, ``turn_share`` and ``turn_contact_area`` at the end of loading, and of
    ``jump_force``, ``jump_contact_area`` and ``lost_indentation``, from two more cycles on larger cells."""
    stations: list[dict[str, Any]]
    """The load steps with floor contact: the rows of ``floor.csv``."""


@dataclass(frozen=True)
class PullOff:
    """The largest tensile force of the unloading."""

    force: float
    """Force, N, negative."""
    indentation: float
    """Indentation, m."""
    error: CycleError
    """Estimated relative errors of the force."""
    pillars: dict[str, Any]
    """The pillars in contact, as arrays: the columns of ``pull-off-pillars.csv``."""


class Cycle(CycleNumbers):
    """Loading and unloading of a lens on adhesive pillars. Numbers are in SI units.

    The force is linear in the indentation between load steps, so that the load steps define the whole curve; where contacts
    attach or detach there are two at (nearly) the same indentation.
    """

    _titles = ("fakir.Cycle", "Loading and unloading with adhesion")

    __slots__ = ("critical", "pull_off")

    critical: CriticalState | None
    """The critical state, if it was reached."""
    pull_off: PullOff | None
    """The pull-off; None without unloading or without tensile force."""

    def __init__(self, cycle: _fakir.Cycle, system: System) -> None:
        super().__init__(cycle)
        self.critical = None if cycle.critical is None else critical_state(cycle.critical, system)
        self.pull_off = None
        pillars, force, at = cycle.pull_off_pillars, self.pull_off_force, self.pull_off_indentation
        error = self.error.pull_off_force
        if pillars is not None and force is not None and at is not None and error is not None:
            self.pull_off = PullOff(force, at, error, pillars)

    def _stations(self, name: str) -> FloatArray:
        return np.array([station[name] for station in self._summary["stations"]], dtype=float)

    @property
    def indentation(self) -> FloatArray:
        """Indentation at every load step, m; negative if tops are stretched above their height."""
        return self._stations("indentation_m")

    @property
    def force(self) -> FloatArray:
        """Force at every load step, N; negative in tension."""
        return self._stations("force_N")

    @property
    def pillars_in_contact(self) -> FloatArray:
        """Number of pillars in contact at every load step."""
        return self._stations("pillars_in_contact")

    @property
    def contact_radius(self) -> FloatArray:
        """Distance of the farthest point in contact from the lens axis at every load step, m."""
        return self._stations("contact_radius_m")

    @property
    def contact_area(self) -> FloatArray:
        """Contact area at every load step, m^2."""
        return self._stations("contact_area_m2")

    @property
    def unloading(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Whether load steps are on the unloading branch."""
        return np.array([it["branch"] == "unloading" for it in self._summary["stations"]], dtype=bool)

    @property
    def events(self) -> list[dict[str, Any]]:
        """All changes of contact, in order: the rows of ``events.csv``."""
        return copy.deepcopy(self._summary["events"])

    @property
    def floor(self) -> AdhesiveFloor | None:
        """Results for the floor; None if it was not touched."""
        found = self._summary.get("floor")
        if found is None or not found["stations"]:
            return None
        found = copy.deepcopy(found)
        return AdhesiveFloor(
            found["force_before_jump_N"],
            found["jump"],
            found["last"],
            found["force_after_loss_N"],
            found["cells_across_ring"],
            found["coarse"],
            found["relative_error_estimate"],
            found["stations"],
        )

    @property
    def hysteresis_error(self) -> CycleError | None:
        """Estimated relative errors of the hysteresis."""
        return self.error.hysteresis

    def to_pandas(self) -> pandas.DataFrame:
        """A table: the columns of ``cycle.csv``."""
        import pandas

        return pandas.DataFrame(self._summary["stations"])

    def _rows(self) -> list[Row]:
        rows = [
            (
                "loaded up to",
                f"{engineering(self.turn_force, 'N')} at {engineering(self.turn_indentation, 'm')}",
            )
        ]
        if self.pull_off is not None:
            at = engineering(self.pull_off.indentation, "m", 4)
            held = len(self.pull_off.pillars["i"])
            text = f"{engineering(self.pull_off.force, 'N', 3)} at {at}, {held} pillars"
            rows.append(("pull-off", text))
        if self.last_release_indentation is not None:
            rows.append(("last release", engineering(self.last_release_indentation, "m", 4)))
        if self.hysteresis is not None:
            rows.append(("hysteresis", engineering(self.hysteresis, "J", 3)))
        return rows


def load_step_table(cycle: Any, **others: Any) -> pandas.DataFrame:
    """The curve of a cycle of another surface than pillars with flat tops, with further columns: those of ``cycle.csv``."""
    import pandas

    columns: dict[str, Any] = {
        "branch": cycle.branch,
        "indentation_m": cycle.indentation,
        "force_N": cycle.force,
    }
    return pandas.DataFrame(columns | others)


def cycle_rows(cycle: Any) -> list[Row]:
    """The end of loading, the pull-off and the hysteresis of such a cycle."""
    turn = f"{engineering(cycle.turn_force, 'N')} at {engineering(cycle.turn_indentation, 'm')}"
    rows = [("loaded up to", turn)]
    if cycle.pull_off_force is not None:
        rows.append(("pull-off force", engineering(cycle.pull_off_force, "N")))
    if cycle.hysteresis is not None:
        rows.append(("hysteresis", engineering(cycle.hysteresis, "J")))
    return [*rows, ("solution", cycle.termination)]


Plan = tuple[float | None, float | None, Drive, float | None, bool]
"""Indentation and force at the end of loading, loading mode, stiffness, and whether there is unloading, in SI units."""


def checked_plan(
    to: Quantity | None,
    to_force: Quantity | None,
    drive: Drive,
    machine_stiffness: Quantity | None,
    retract: bool,
) -> Plan:
    """A cycle with at most one prescribed end of loading."""
    if to is not None and to_force is not None:
        raise TypeError("a loading has one end: give one of to and to_force")
    if drive not in ("displacement", "force", "machine"):
        raise ValueError(f'no drive "{drive}": give "displacement", "force" or "machine"')
    if not isinstance(retract, (bool, np.bool_)):
        raise TypeError(f"retract is {retract!r}: give True or False")
    if (drive == "machine") != (machine_stiffness is not None):
        raise TypeError('drive="machine" and machine_stiffness go together')
    return (
        None if to is None else si(to, "length", "to"),
        None if to_force is None else si(to_force, "force", "to_force"),
        drive,
        None
        if machine_stiffness is None
        else si(machine_stiffness, "stiffness", "machine_stiffness"),
        retract,
    )


def plan_with_end(
    to: Quantity | None,
    to_force: Quantity | None,
    drive: Drive,
    machine_stiffness: Quantity | None,
    retract: bool,
) -> Plan:
    """A cycle with a prescribed end of loading."""
    if to is None and to_force is None:
        raise TypeError("give either to or to_force: where the loading ends")
    return checked_plan(to, to_force, drive, machine_stiffness, retract)


def cycle(system: System, plan: Plan, options: _fakir.Options) -> Cycle:
    """Computes loading and unloading."""
    result = Cycle(_fakir.cycle(system._case, *plan, options), system)
    if not result.converged:
        raise NotConverged(f"the solution {result.termination}", result)
    warn(result.warnings)
    return result
