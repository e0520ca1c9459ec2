"""What a computation gives: the contact under a load, and the critical state."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _fakir
from ._floor import FloorContact
from ._format import Row, engineering, html_table, known_digits, remark, text_table
from ._quantity import FloatArray, array
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
        ("smallest_edge_coefficient_Pa", np.float64),
        ("largest_edge_coefficient_Pa", np.float64),
    ]
)
"""A pillar of a contact; the columns are those of ``pillars.csv``."""

FIELDS = {
    "pressure": ("Pa", "contact pressure"),
    "gap": ("m", "gap between the lens and the surface below it"),
    "displacement": ("m", "distance by which the pressure has moved the two surfaces apart"),
}


class ErrorEstimate(NamedTuple):
    """Estimated relative errors of the numerical solution (not of the model)."""

    force: float
    indentation: float
    contact_radius: float | None = None
    """Relative error of the contact radius, of a critical state the larger one; None under a plate."""
    top_contact_radius: float | None = None
    """Relative error of the radius of the contact on the pillar tops; only critical states have it."""
    contact_area: float | None = None
    """Relative error of the contact area; only contacts with general surfaces have it."""


class Limit(NamedTuple):
    """A condition of the model, and how near a contact comes to where it ends."""

    name: str
    """As in `limits` of the results."""
    value: float
    """Its value; where the name ends in a unit, in that."""
    threshold: float | None
    """From where on the model is doubtful; None of what only would change the answer."""
    strained: bool
    """Whether it is doubtful here."""


class Normalized(NamedTuple):
    """The paper's reduced variables: F gamma_int/(h d), a/e and zeta/h."""

    force: float
    contact_radius: float
    indentation: float


class ContactState:
    """The contact under a load. Numbers are in SI units."""

    __slots__ = ("_floor", "_pillars", "_state", "_summary")

    _system_of: ClassVar[Callable[[_fakir.Case], System]]
    """The system of a case. `System`, which uses states, sets it."""

    def __init__(self, state: _fakir.State) -> None:
        self._state = state
        self._summary: dict[str, Any] = json.loads(state.json())
        self._floor: FloorContact | None = None
        self._pillars: npt.NDArray[np.void] | None = None

    @property
    def system(self) -> System:
        """The system that was solved."""
        return ContactState._system_of(self._state.case)

    @property
    def method(self) -> str:
        """The method that solved it."""
        return str(self._summary["method"])

    @property
    def force(self) -> float:
        """Normal force, N."""
        return float(self._summary["force_N"])

    @property
    def indentation(self) -> float:
        """How far the lens has come down since it was level with the pillar tops, m."""
        return float(self._summary["indentation_m"])

    @property
    def contact_radius(self) -> float:
        """Distance from the lens axis of the farthest point in contact, on a pillar top or on the floor, m."""
        return float(self._summary["contact_radius_m"])

    @property
    def top_contact_radius(self) -> float:
        """Distance from the lens axis of the farthest point of a pillar top in contact, m."""
        return float(self._summary.get("top_contact_radius_m", self.contact_radius))

    @property
    def pillars_in_contact(self) -> int:
        """Number of pillars touched, fully or partially."""
        return int(self._summary["pillars_in_contact"])

    @property
    def pillars_partially_in_contact(self) -> int:
        """Number of pillars crossed by the edge of the contact."""
        return int(self._summary["pillars_partially_in_contact"])

    @property
    def smallest_floor_gap(self) -> float:
        """Smallest gap between lens and floor, m: past the transition 0, or less where the floor is ignored."""
        return float(self._summary["smallest_floor_gap_m"])

    @property
    def smallest_gap_position(self) -> tuple[float, float]:
        """Where the floor gap is smallest, m from the lens axis."""
        x, y = self._state.smallest_gap_position
        return x, y

    @property
    def beyond_transition(self) -> bool:
        """Whether the floor is touched, or would be if it was not to be ignored."""
        return bool(self._summary["beyond_transition"])

    @property
    def floor(self) -> FloorContact | None:
        """What the floor bears: None before the transition, and past it where the floor is ignored.

        It is ignored with ``floor_contact=False`` of the `System`, and by all methods but ``"spectral"``.
        """
        if self._floor is None:
            cells = self._state.floor_cells()
            if cells is not None:
                self._floor = FloorContact(self._summary["floor"], cells)
        return self._floor

    @property
    def _goes_through_floor(self) -> bool:
        """Whether the lens is in the floor, which is ignored."""
        return self.beyond_transition and self._summary["floor"] is None

    @property
    def error(self) -> ErrorEstimate:
        """Estimated relative errors of force, indentation and contact radius."""
        return ErrorEstimate(**self._summary["relative_error_estimate"])

    @property
    def converged(self) -> bool:
        """Whether the numbers are the solution."""
        return bool(self._summary["converged"])

    @property
    def termination(self) -> str:
        """Why the solver stopped."""
        return self._state.termination

    @property
    def iterations(self) -> int:
        """Steps of the solver."""
        return int(self._summary["iterations"])

    @property
    def wall_time(self) -> float:
        """How long it took, s."""
        return float(self._summary["wall_time_s"])

    @property
    def warnings(self) -> list[str]:
        """What to be careful about."""
        return self._state.warnings

    @property
    def limits(self) -> list[Limit]:
        """The conditions of the model, and how near the contact comes to where they end.

        ``any(limit.strained for limit in state.limits)`` tells of an answer beyond its model.
        """
        return [Limit(**limit) for limit in self._summary["limits"]]

    @property
    def pillars(self) -> npt.NDArray[np.void]:
        """The touched pillars, nearest to the lens axis first: a structured array.

        ``state.pillars["force_N"]`` is a column, ``pandas.DataFrame(state.pillars)`` a table. Empty
        for methods that do not resolve pillars.
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

        On the floor it is that of its cells: see `floor`. At the rim of a pillar that is fully in contact it is infinite: `on_grid` gives means over
        cells, which are not. ``memory_limit`` is in bytes; 8 GB if
        not given.
        """
        return self._field(2, x, y, threads, memory_limit)

    def gap(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Gap (m) between the lens and what is below it: pillar top or floor.

        Where the floor is in contact it is zero, as the mean over a cell: at a point it differs from that by
        what the cells do not resolve. Where the floor is ignored it is negative past the transition.
        """
        return self._field(1, x, y, threads, memory_limit)

    def displacement(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """How far the pressure on pillar tops and floor has moved the two surfaces apart (m), pillars not
        shortened."""
        return self._field(0, x, y, threads, memory_limit)

    def on_pillar(self, x: object, y: object) -> Any:
        """Whether points are on a pillar top rather than above the floor."""
        points = np.broadcast_arrays(array(x, "length", "x"), array(y, "length", "y"))
        found = self._state.on_pillar(*(np.ascontiguousarray(p).reshape(-1) for p in points))
        return found.reshape(points[0].shape)[()]

    def on_grid(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> xarray.Dataset:
        """All fields on the grid of coordinates ``x`` and ``y`` (m), with units.

        The pressure, which is infinite at the rim of a covered pillar, is its mean over the cell
        around each point: half-way to the next points. Its sum times the area of a cell is the force.
        `pressure` gives the value at a point. Past the transition the pressure on the floor is in it, and what the
        floor bears is in the attributes ``floor_force_N``, ``floor_share`` and ``floor_contact_area_m2``.

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
        """All fields on a square grid around the contact, with so many points along a side."""
        _fakir.check_points(points * points, memory_limit)
        reach = max(self.contact_radius, 0.5 * self.system.pitch) + self.system.pitch
        axis = np.linspace(-reach, reach, points)
        return self.on_grid(axis, axis, threads=threads, memory_limit=memory_limit)

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir press --json`` prints: same names, same numbers."""
        return json.loads(self._state.json())  # type: ignore[no-any-return]

    def _field(
        self, number: int, x: object, y: object, threads: int, memory_limit: int | None
    ) -> Any:
        across, along = array(x, "length", "x"), array(y, "length", "y")
        try:
            points = np.broadcast_arrays(across, along)
        except ValueError:
            raise ValueError(
                f"x of shape {across.shape} and y of shape {along.shape} cannot be broadcast together"
            ) from None
        return self._samples(points[0], points[1], threads, memory_limit)[number][()]

    def _samples(
        self, x: FloatArray, y: FloatArray, threads: int, memory_limit: int | None
    ) -> list[FloatArray]:
        # Points that were broadcast have no memory of their own yet.
        _fakir.check_points(x.size, memory_limit)
        flat = (np.ascontiguousarray(x).reshape(-1), np.ascontiguousarray(y).reshape(-1))
        found = self._state.sample(*flat, options(threads, memory_limit=memory_limit))
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
        if self._goes_through_floor:
            rows.append(("", "past the transition: computed as if the floor were not there"))
        elif self.floor is not None:
            share = f"{self.floor.share:.{known_digits(self.floor.error.share)}g}"
            rows.append(("share of the floor", share + remark(self.floor.error.share)))
        rows.append(("solution", f"{self.method}, {self.termination}"))
        return rows

    def __repr__(self) -> str:
        return text_table("fakir.ContactState", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Contact under load", self._rows())


class CriticalState:
    """The state in which the lens just reaches the floor. Numbers are in SI units."""

    __slots__ = ("_critical", "_summary", "state")

    state: ContactState
    """The contact at the transition, with its pillars and fields."""

    def __init__(self, critical: _fakir.Critical) -> None:
        self._critical = critical
        self._summary: dict[str, Any] = json.loads(critical.json())
        self.state = ContactState(critical.state)

    @property
    def system(self) -> System:
        """The system that was solved."""
        return self.state.system

    @property
    def method(self) -> str:
        """The method that solved it."""
        return str(self._summary["method"])

    @property
    def regime(self) -> str:
        """What the lens meets first: ``"top_first"`` or ``"bottom_first"``."""
        return str(self._summary["regime"])

    @property
    def force(self) -> float:
        """Critical force, N."""
        return float(self._summary["critical_force_N"])

    @property
    def indentation(self) -> float:
        """Critical indentation, m."""
        return float(self._summary["critical_indentation_m"])

    @property
    def contact_radius(self) -> float:
        """The larger of top contact radius and distance of the floor contact, m."""
        return float(self._summary["critical_contact_radius_m"])

    @property
    def top_contact_radius(self) -> float:
        """Distance from the lens axis of the farthest point of a pillar top in contact, m."""
        return float(self._summary["top_contact_radius_m"])

    @property
    def floor_contact(self) -> tuple[float, float]:
        """Where the floor is touched, m from the lens axis (one of its symmetric copies)."""
        x, y = self._summary["floor_contact_m"]
        return float(x), float(y)

    @property
    def pillars_in_contact(self) -> int:
        """Number of pillars touched, fully or partially."""
        return self.state.pillars_in_contact

    @property
    def pillars_partially_in_contact(self) -> int:
        """Number of pillars crossed by the edge of the contact."""
        return self.state.pillars_partially_in_contact

    @property
    def limits(self) -> list[Limit]:
        """The conditions of the model, and how near the contact comes to where they end.

        ``any(limit.strained for limit in state.limits)`` tells of an answer beyond its model.
        """
        return [Limit(**limit) for limit in self._summary["limits"]]

    @property
    def pillars(self) -> npt.NDArray[np.void]:
        """The touched pillars: see `ContactState.pillars`."""
        return self.state.pillars

    @property
    def normalized(self) -> Normalized:
        """Force, contact radius and indentation in the paper's reduced variables."""
        return Normalized(**self._summary["normalized"])

    @property
    def error(self) -> ErrorEstimate:
        """Estimated relative errors of force, indentation and contact radii."""
        return ErrorEstimate(**self._summary["relative_error_estimate"])

    @property
    def converged(self) -> bool:
        """Whether the numbers are the solution."""
        return self.state.converged

    @property
    def iterations(self) -> int:
        """Steps of the solver."""
        return self.state.iterations

    @property
    def wall_time(self) -> float:
        """How long it took, s."""
        return float(self._summary["wall_time_s"])

    @property
    def warnings(self) -> list[str]:
        """What to be careful about."""
        return self.state.warnings

    def to_dict(self) -> dict[str, Any]:
        """The object that ``fakir transition --json`` prints: same names, same numbers."""
        return json.loads(self._critical.json())  # type: ignore[no-any-return]

    def _rows(self) -> list[Row]:
        x, y = self.floor_contact
        reduced = self.normalized
        first = "pillar tops" if self.regime == "top_first" else "the floor, without force"
        partial = self.pillars_partially_in_contact
        force = f"{engineering(self.force, 'N')}, F gamma_int/(h d) = {reduced.force:.6g}"
        depth = f"{engineering(self.indentation, 'm')}, zeta/h = {reduced.indentation:.6g}"
        error = self.error.contact_radius
        digits = radius_digits(error)
        across = f"{engineering(self.contact_radius, 'm', digits)}, a/e = {reduced.contact_radius:.{digits}g}"
        return [
            ("the lens meets first", first),
            ("force", force + remark(self.error.force)),
            ("indentation", depth + remark(self.error.indentation)),
            ("contact radius", across + remark(error or 0.0)),
            ("floor contact at", f"({engineering(x, 'm', 4)}, {engineering(y, 'm', 4)})"),
            ("pillars in contact", f"{self.pillars_in_contact}, {partial} of them partially"),
            ("solution", f"{self.method}, {self.state.termination}"),
        ]

    def __repr__(self) -> str:
        return text_table("fakir.CriticalState", self._rows())

    def _repr_html_(self) -> str:
        return html_table("Critical state", self._rows())


def contact_state(state: _fakir.State) -> ContactState:
    """The state for the user: with its warnings, and only if it is a solution."""
    contact = ContactState(state)
    warn(contact.warnings)
    if contact._goes_through_floor:
        method = contact.method
        advice = "" if method == "spectral" else f"; the method {method} does not know what the floor bears"
        warn(
            [
                "past the transition: this contact is computed as if the floor were not there "
                f"(System.transition gives the critical load{advice})"
            ]
        )
    if not contact.converged:
        raise NotConverged(f"the solution {contact.termination}", contact)
    return contact


def critical_state(critical: _fakir.Critical) -> CriticalState:
    """The critical state for the user."""
    result = CriticalState(critical)
    warn(result.warnings)
    if not result.converged:
        raise NotConverged(f"the solution {result.state.termination}", result)
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
    """Digits of a contact radius with this relative error that mean something, two to five."""
    if error is None or not error < 1.0:
        return 2
    return 5 if error <= 0.0 else min(max(int(np.ceil(-np.log10(error))), 2), 5)


def radius(value: float, error: float | None) -> str:
    """A contact radius in the digits that its relative error leaves."""
    return engineering(value, "m", radius_digits(error)) + remark(error or 0.0)
