"""Results of a computation: the contact under a load, and the critical state."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _fakir
from ._bodies import CylinderLens, PlateLens
from ._floor import FloorContact
from ._format import Row, engineering, known_digits, remark
from ._numbers import PressNumbers, TransitionNumbers
from ._quantity import FloatArray, array, flat, points_at
from ._run import options, warn
from .errors import FakirError, NotConverged

if TYPE_CHECKING:
    import xarray

    from ._system import System

PILLAR = np.dtype(
    [
        ("i", np.int64),
        ("j", np.int64),
        ("x_m", np.float64),
        ("y_m", np.float64),
        ("status", "U9"),
        ("force_N", np.float64),
        ("centre_pressure_Pa", np.float64),
        ("smallest_stress_intensity_factor_Pa", np.float64),
        ("largest_stress_intensity_factor_Pa", np.float64),
    ]
)
"""A pillar of a contact; the columns are those of ``pillars.csv``."""

FIELDS = {
    "pressure": ("Pa", "contact pressure"),
    "gap": ("m", "gap between the lens and the surface below it"),
    "displacement": ("m", "distance by which the pressure has moved the two surfaces apart"),
}


class ContactState(PressNumbers):
    """The contact under a load. Numbers are in SI units."""

    _titles = ("fakir.ContactState", "Contact under load")

    __slots__ = ("_floor", "_pillars", "_state", "_system")

    def __init__(self, state: _fakir.State, system: System) -> None:
        super().__init__(state)
        self._state, self._system = state, system
        self._floor: FloorContact | None = None
        self._pillars: npt.NDArray[np.void] | None = None

    @property
    def system(self) -> System:
        """The solved system, with the method that was used."""
        return self._system._of(self._state.case)

    @property
    def smallest_gap_position(self) -> tuple[float, float]:
        """Position of the smallest floor gap, m from the lens axis."""
        x, y = self._state.smallest_gap_position
        return x, y

    @property
    def floor(self) -> FloorContact | None:
        """The floor contact: None before the transition, and past it if floor contact is ignored.

        It is ignored with ``floor_contact=False`` of the `System`, and by all methods except ``"spectral"``.
        """
        if self._floor is None:
            cells = self._state.floor_cells()
            if cells is not None:
                self._floor = FloorContact(self, cells)
        return self._floor

    @property
    def _ignores_floor(self) -> bool:
        """Whether the lens penetrates the floor, because floor contact is ignored."""
        return self.beyond_transition and self.floor is None

    @property
    def pillars(self) -> npt.NDArray[np.void]:
        """The touched pillars, sorted by distance from the lens axis: a structured array.

        ``state.pillars["force_N"]`` is a column, ``pandas.DataFrame(state.pillars)`` a table. Empty for methods that do not
        resolve pillars.
        """
        if self._pillars is None:
            columns = self._state.pillars()
            pillars = np.zeros(len(columns["i"]), dtype=PILLAR)
            for name, values in columns.items():
                pillars[name] = values
            pillars.flags.writeable = False
            self._pillars = pillars
        return self._pillars

    def pressure(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Contact pressure (Pa) at points (m from the lens axis), which are broadcast.

        On the floor it is constant on each cell: see `floor`. At the rim of a fully touched pillar it is infinite; `on_grid`
        returns finite means over cells. ``memory_limit`` is in bytes; 8 GB if not given.
        """
        return self._field(2, x, y, threads, memory_limit)

    def gap(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Gap (m) between the lens and the pillar top or floor below it.

        Where the floor is in contact it is zero as the mean over a cell; its value at a point depends on details that the cells
        do not resolve. If floor contact is ignored it is negative past the transition.
        """
        return self._field(1, x, y, threads, memory_limit)

    def displacement(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Separation of the two surfaces by the pressure on pillar tops and floor (m), without the shortening of pillars."""
        return self._field(0, x, y, threads, memory_limit)

    def on_pillar(self, x: object, y: object) -> Any:
        """Whether points are on a pillar top rather than above the floor."""
        across, along = points_at(x, y)
        found = self._state.on_pillar(flat(across), flat(along))
        return found.reshape(across.shape)[()]

    def on_grid(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> xarray.Dataset:
        """All fields on the grid of coordinates ``x`` and ``y`` (m), with units.

        The pressure, which is infinite at the rim of a covered pillar, is its mean over the cell around each point: half-way to
        the next points. Its sum times the area of a cell is the force. `pressure` returns the value at a point. Past the
        transition the pressure on the floor is included; the attributes ``floor_force_N``, ``floor_share`` and
        ``floor_contact_area_m2`` describe the floor contact.

        Needs xarray: ``pip install fakir[xarray]``.
        """
        across, along = _axis(x, "x"), _axis(y, "y")
        _fakir.check_points(across.size * along.size, memory_limit)
        points = np.meshgrid(across, along)
        found = self._state.grid(across, along, options(threads, memory_limit=memory_limit))
        samples = self._shaped(found, points[0], points[1])
        on_pillar = self.on_pillar(points[0], points[1])
        return self._dataset(across, along, samples, on_pillar)

    def to_xarray(
        self, points: int = 201, *, threads: int = 1, memory_limit: int | None = None
    ) -> xarray.Dataset:
        """All fields on a square grid around the contact, with this number of points along a side."""
        _fakir.check_points(points * points, memory_limit)
        reach = max(self.contact_radius, 0.5 * self.system.pitch) + self.system.pitch
        axis = np.linspace(-reach, reach, points)
        return self.on_grid(axis, axis, threads=threads, memory_limit=memory_limit)

    def _field(
        self, number: int, x: object, y: object, threads: int, memory_limit: int | None
    ) -> Any:
        across, along = points_at(x, y)
        return self._samples(across, along, threads, memory_limit)[number][()]

    def _samples(
        self, x: FloatArray, y: FloatArray, threads: int, memory_limit: int | None
    ) -> list[FloatArray]:
        _fakir.check_points(x.size, memory_limit)
        run = options(threads, memory_limit=memory_limit)
        found = self._state.sample(flat(x), flat(y), run)
        return self._shaped(found, x, y)

    def _shaped(
        self, samples: list[FloatArray] | None, x: FloatArray, y: FloatArray
    ) -> list[FloatArray]:
        if samples is None:
            raise FakirError(f'the method "{self.method}" does not resolve pillars: it has no fields')
        return [field.reshape(x.shape) for field in samples]

    def _dataset(
        self,
        x: FloatArray,
        y: FloatArray,
        samples: list[FloatArray],
        on_pillar: npt.NDArray[np.bool_],
    ) -> xarray.Dataset:
        import xarray

        displacement, gap, pressure = samples
        values = {"pressure": pressure, "gap": gap, "displacement": displacement}
        variables: dict[str, Any] = {
            name: (("y", "x"), values[name], {"units": unit, "long_name": text})
            for name, (unit, text) in FIELDS.items()
        }
        variables["pressure"][2]["cell_methods"] = "x: y: mean"
        top = {"long_name": "whether a pillar top is there"}
        variables["on_pillar"] = (("y", "x"), on_pillar, top)
        coordinates = {
            name: (name, axis, {"units": "m", "long_name": f"distance from the lens axis along {name}"})
            for name, axis in [("x", x), ("y", y)]
        }
        attributes = {
            "title": "Lens on a surface",
            "source": f"fakir {_fakir.__version__}",
            "method": self.method,
            "case": self._state.case.to_toml(),
            "force_N": self.force,
            "indentation_m": self.indentation,
        }
        floor = self.floor
        if floor is not None:
            attributes["floor_force_N"] = floor.force
            attributes["floor_share"] = floor.share
            attributes["floor_contact_area_m2"] = floor.contact_area
        return xarray.Dataset(variables, coordinates, attributes)

    def _rows(self) -> list[Row]:
        error = self.error
        partial = self.pillars_partially_in_contact
        rows = [
            ("force", engineering(self.force, "N") + remark(error.force)),
            ("indentation", engineering(self.indentation, "m") + remark(error.indentation)),
            ("contact radius", radius(self.contact_radius, error.contact_radius)),
            ("pillars in contact", f"{self.pillars_in_contact}, {partial} of them partially"),
            ("smallest floor gap", engineering(self.smallest_floor_gap, "m", 4)),
        ]
        if self._ignores_floor:
            rows.append(("", "past the transition: computed as if the floor were not there"))
        elif self.floor is not None:
            share = f"{self.floor.share:.{known_digits(self.floor.error.share)}g}"
            rows.append(("fraction on the floor", share + remark(self.floor.error.share)))
        rows.append(("solution", f"{self.method}, {self.termination}"))
        return rows


class CriticalState(TransitionNumbers):
    """The state in which the lens just reaches the floor. Numbers are in SI units."""

    _titles = ("fakir.CriticalState", "Critical state")

    __slots__ = ("state",)

    state: ContactState
    """The contact at the transition, with its pillars and fields."""

    def __init__(self, critical: _fakir.Critical, system: System) -> None:
        super().__init__(critical)
        self.state = ContactState(critical.state, system)

    @property
    def system(self) -> System:
        """The solved system, with the method that was used."""
        return self.state.system

    @property
    def pillars(self) -> npt.NDArray[np.void]:
        """The touched pillars: see `ContactState.pillars`."""
        return self.state.pillars

    def _rows(self) -> list[Row]:
        x, y = self.floor_contact
        reduced = self.normalized
        first = "pillar tops" if self.regime == "top_first" else "the floor, without force"
        partial = self.pillars_partially_in_contact
        force = f"{engineering(self.force, 'N')}, F gamma_int/(h d) = {reduced.force:.6g}"
        depth = f"{engineering(self.indentation, 'm')}, zeta/h = {reduced.indentation:.6g}"
        error = self.error.contact_radius or 0.0
        digits = radius_digits(error)
        across = f"{engineering(self.contact_radius, 'm', digits)}, a/e = {reduced.contact_radius:.{digits}g}"
        return [
            ("the lens meets first", first),
            ("force", force + remark(self.error.force)),
            ("indentation", depth + remark(self.error.indentation)),
            ("contact radius", across + remark(error)),
            ("floor contact at", f"({engineering(x, 'm', 4)}, {engineering(y, 'm', 4)})"),
            ("pillars in contact", f"{self.pillars_in_contact}, {partial} of them partially"),
            ("solution", f"{self.method}, {self.termination}"),
        ]


def contact_state(state: _fakir.State, system: System) -> ContactState:
    """The state with its warnings; raises an error if it is not a solution."""
    contact = ContactState(state, system)
    warn(contact.warnings)
    if contact._ignores_floor:
        method = contact.method
        advice = [] if method == "spectral" else [f"the method {method} does not compute the load of the floor"]
        # The transition of a cylinder or a plate is not computed.
        if not isinstance(system.lens, (CylinderLens, PlateLens)):
            advice.insert(0, "System.transition gives the critical load")
        words = f" ({'; '.join(advice)})" if advice else ""
        warn([f"past the transition: this contact is computed as if the floor were not there{words}"])
    if not contact.converged:
        raise NotConverged(f"the solution {contact.termination}", contact)
    return contact


def critical_state(critical: _fakir.Critical, system: System) -> CriticalState:
    """The critical state with its warnings."""
    result = CriticalState(critical, system)
    warn(result.warnings)
    if not result.converged:
        raise NotConverged(f"the solution {result.termination}", result)
    return result


def _axis(values: object, name: str) -> FloatArray:
    axis = array(values, "length", name)
    if axis.ndim != 1 or axis.size == 0:
        raise ValueError(
            f"{name} has the shape {axis.shape}: give the coordinates of the grid along {name}, "
            "an array of one dimension"
        )
    return axis


def radius_digits(error: float | None) -> int:
    """Number of significant digits of a contact radius with this relative error, two to five."""
    if error is None or not error < 1.0:
        return 2
    return 5 if error <= 0.0 else min(max(int(np.ceil(-np.log10(error))), 2), 5)


def radius(value: float, error: float | None) -> str:
    """A contact radius, rounded to its relative error."""
    return engineering(value, "m", radius_digits(error)) + remark(error or 0.0)
