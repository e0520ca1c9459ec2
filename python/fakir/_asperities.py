"""Pillars with rounded tops: their contact, and heights designed for a target curve."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _fakir
from ._bodies import AnyLens, Substrate, layer_numbers, layer_options, lens_of
from ._cycle import Adhesion, Drive, checked_plan, cycle_rows, load_step_table
from ._floor import FloorContact
from ._format import Row, engineering
from ._gradient import Gradient
from ._loading import Loading, checked_path, in_order
from ._history import Viscoelastic
from ._numbers import AsperityCycleNumbers, AsperityPressNumbers, AsperityTransitionNumbers
from ._quantity import FloatArray, Quantity, array, flat, points_at, si
from ._result import Result
from ._run import Progress, options, warn, warn_of_interactions
from ._settings import SEED, Overrides, load, load_or_critical, overrides_of, settings
from ._verification import Difference, Opinion, checked_cells
from .errors import NotConverged
from .bem import Plate, indenter_settings

if TYPE_CHECKING:
    import pandas


def _bodies_of(system: _fakir.Asperities) -> tuple[AnyLens | Plate, Substrate]:
    """The indenter and the substrate for these numbers."""
    lens = system.lens
    indenter = Plate(*(system.plate or [])) if lens is None else lens_of(lens)
    film, _ = system.layers
    return indenter, Substrate(*system.substrate, **layer_options(film))


def _of_case(text: str, table: str) -> AsperityArray:
    """An array that was sent from another process."""
    with TemporaryDirectory() as folder:
        Path(folder, "pillars.csv").write_text(table, encoding="utf-8")
        case = Path(folder, "case.toml")
        case.write_text(text, encoding="utf-8")
        return AsperityArray.from_file(case)


class AsperityArray(Viscoelastic):
    """Pillars, or asperities of a half-space, with rounded tops under a lens or a plate.

    Parameters
    ----------
    x, y
        Positions of the tops relative to the lens axis (m): one array each.
    height
        Height of each top above the floor (m): an array, or one value for all.
    top_radius
        Radius of curvature of all tops (m).
    indenter
        A `Lens` or a lens of another shape, or a plate: `fakir.bem.Plate`.
    substrate
        The elastic half-space that the tops belong to, or a film.
    diameter
        Diameter of each pillar (m): an array, or one value for all. Without it the tops are asperities of the half-space, which
        end at the floor.
    reference_height
        The height from which indentations are measured (m); by default that of the highest top.
    compliance
        ``"column"`` if pillars with a diameter shorten under load, ``"none"`` if not.
    accuracy
        ``"default"``, or ``"accurate"``: a pressure of degree 2 on each contact, or of degree 4.
    adhesion
        An `Adhesion`, or the work of adhesion (J/m^2), of all tops; with `floor=True` also of the floor.

    Examples
    --------
    Nine asperities under a glass plate:

    >>> x, y = np.meshgrid([-1e-3, 0.0, 1e-3], [-1e-3, 0.0, 1e-3])
    >>> rubber, glass = fakir.Substrate("1.5 MPa", 0.5), fakir.bem.Plate("70 GPa", 0.22)
    >>> tops = fakir.AsperityArray(x, y, 100e-6, "500 um", glass, rubber)
    >>> contact = tops.press(force="10 mN")
    >>> contact.pillars_in_contact
    9
    """

    indenter: AnyLens | Plate
    substrate: Substrate
    top_radius: float
    """Radius of curvature, m."""
    reference_height: float
    """Height from which indentations are measured, m."""
    x: FloatArray
    y: FloatArray
    height: FloatArray
    """Height of every top above the floor, m."""
    diameter: FloatArray
    """Diameter of every pillar, m; NaN for asperities."""

    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        height: Quantity | ArrayLike,
        top_radius: Quantity,
        indenter: AnyLens | Plate,
        substrate: Substrate,
        *,
        diameter: Quantity | ArrayLike | None = None,
        reference_height: Quantity | None = None,
        compliance: Literal["column", "none"] = "column",
        accuracy: Literal["default", "accurate"] = "default",
        adhesion: Adhesion | Quantity | None = None,
    ) -> None:
        works = None
        if adhesion is not None:
            given = adhesion if isinstance(adhesion, Adhesion) else Adhesion(adhesion)
            if given.work_receding is not None:
                raise ValueError("rounded tops support one work of adhesion: leave work_receding out")
            works = (given.work, None, given.floor)
        lens, plate = indenter_settings(indenter, substrate)
        if compliance not in {"column", "none"}:
            raise ValueError(f'compliance is {compliance!r}: give "column" or "none"')
        if accuracy not in {"default", "accurate"}:
            raise ValueError(f'accuracy is {accuracy!r}: give "default" or "accurate"')
        columns = [array(x, "length", "x"), array(y, "length", "y"), array(height, "length", "height")]
        if diameter is not None:
            columns.append(array(diameter, "length", "diameter"))
        try:
            columns = [np.ravel(values) for values in np.broadcast_arrays(*columns)]
        except ValueError as error:
            raise ValueError(
                f"x, y, height and diameter have to be arrays of one length, or single numbers: {error}"
            ) from None
        if diameter is None:
            columns.append(np.full(len(columns[0]), np.nan))
        if len(columns[0]) == 0:
            raise ValueError("there are no tops: give one at least")
        if (columns[2] <= 0.0).any():
            lowest = float(np.min(columns[2]))
            raise ValueError(f"height is {lowest}: heights are above the floor, and have to be greater than 0")
        reference = (
            float(np.max(columns[2]))
            if reference_height is None
            else si(reference_height, "length", "reference_height")
        )
        self._hold(
            _fakir.Asperities(
                np.stack(columns, axis=1).tolist(),
                si(top_radius, "length", "top_radius"),
                reference,
                lens,
                plate,
                [substrate.young_modulus, substrate.poisson_ratio],
                [layer_numbers(substrate), layer_numbers(indenter)],
                compliance == "column",
                accuracy == "accurate",
                works,
            )
        )

    @classmethod
    def _of(cls, rounded: _fakir.Asperities) -> AsperityArray:
        made = cls.__new__(cls)
        made._hold(rounded)
        return made

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        overrides: Overrides | None = None,
        *,
        set: Overrides | None = None,
    ) -> AsperityArray:
        """Reads a case file with ``pattern.top_radius``; ``overrides`` contains values of keys, as ``--set`` of the command
        line. ``set`` is its deprecated name."""
        given = settings(overrides_of(overrides, set))
        return cls._of(_fakir.Asperities.read(fspath(path), given))

    @classmethod
    def from_toml(
        cls, text: str, overrides: Overrides | None = None, *, set: Overrides | None = None
    ) -> AsperityArray:
        """As `from_file`, from the text of a case file."""
        given = settings(overrides_of(overrides, set))
        return cls._of(_fakir.Asperities.parse("case.toml", text, given))

    def _problem(self) -> _fakir.Asperities:
        return self._asperities

    def _hold(self, rounded: _fakir.Asperities) -> None:
        self._asperities = rounded
        self.indenter, self.substrate = _bodies_of(rounded)
        self.top_radius, self.reference_height = rounded.top_radius, rounded.height
        columns = np.ascontiguousarray(np.asarray(rounded.pillars(), dtype=np.float64).T)
        columns.setflags(write=False)
        self.x, self.y, self.height, self.diameter = columns

    def to_toml(self, table: str = "pillars.csv") -> str:
        """The case as a commented file, which reads the tops from a table of that name in the same folder: see `to_csv`."""
        return self._asperities.to_toml(table)

    def __reduce__(self) -> tuple[Any, ...]:
        return _of_case, (self.to_toml(), self._asperities.table())

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the table for ``pillars = "..."`` in a case file."""
        _write(path, self._asperities.table().encode())

    def to_stl(self, path: str | PathLike[str]) -> None:
        """Writes the surface as a solid in STL, lengths in mm."""
        _write(path, bytes(self._asperities.stl()))

    def press(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> AsperityContact:
        """Computes the contact at an indentation (m) or under a force (N): exactly one of them.

        The indentation is zero where the indenter is level with the reference height. Past the transition the
        floor carries load too, under a lens that comes closest to it near its axis. With adhesion of the tops the result is the contact
        on loading, from first touch on; the floor carries pressures only, unless it is adhesive too.
        """
        run = options(threads, progress, memory_limit)
        contact = _fakir.press_asperities(self._asperities, *load(indentation, force), run)
        result = AsperityContact(self, contact)
        warn(contact.warnings)
        if not result.converged:
            raise NotConverged(f"the solution {result.termination}", result)
        return result

    def verify(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        cells_per_diameter: int = 32,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> AsperityVerification:
        """Compares the discs of contact with boundary elements, on ``cells_per_diameter`` cells across every contact and on half as many.

        Past the transition and with adhesion the elements cover tops and floor, on that number of cells across a contact of mean radius. The discs
        are computed with the accurate setting.
        """
        checked_cells(cells_per_diameter)
        run = options(threads, progress, memory_limit)
        question = load(indentation, force)
        warn_of_interactions(self._asperities, "verify", depth=1)
        summary, discs = _fakir.verify_asperities(self._asperities, *question, cells_per_diameter, run)
        return AsperityVerification(json.loads(summary), AsperityContact(self, discs))

    def transition(
        self,
        *,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> AsperityTransition:
        """Computes the state in which the lens just reaches the floor among the tops, at the reference height below their level."""
        run = options(threads, progress, memory_limit)
        found = _fakir.asperity_transition(self._asperities, run)
        result = AsperityTransition(AsperityContact(self, found.contact), found)
        warn(found.warnings)
        if not result.converged:
            raise NotConverged(f"the solution {result.termination}", result)
        return result

    def approach(
        self,
        step: Quantity = "1 um",
        until: Quantity | None = None,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> AsperityApproach:
        """Computes a loading in steps of the indentation (m) from first contact.

        It ends at the critical state, or before it at an indentation ``until``; ``to``, an indentation, and ``to_force`` lead past it too.
        """
        path = checked_path(step, until, False, to, to_force)
        run = options(threads, progress, memory_limit)
        found, reached, others = _fakir.approach_asperities(self._asperities, *path, run)
        critical = None
        if reached is not None:
            critical = AsperityTransition(AsperityContact(self, reached.contact), reached)
        states = [AsperityContact(self, contact) for contact in others]
        for contact in others:
            warn(contact.warnings)
        found_states: list[AsperityContact | AsperityTransition] = [*states]
        found_states.extend([] if critical is None else [critical])
        for state in found_states:
            if not state.converged:
                raise NotConverged(f"a solution {state.termination}", state)
        first = None if critical is None else critical.contact
        summary = json.loads(found)
        return AsperityApproach(summary, in_order(summary, first, iter(states)), critical)

    def gradient(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Gradient[AsperityContact]:
        """Computes the contact at an indentation (m) or under a force (N), or the critical state, with its exact derivatives.

        They are with respect to the numbers of the case, by their keys, and to the height of every top in contact, whose index ``i`` is
        its number. With adhesion they are those of the contact on loading.

        Raises
        ------
        SolveError
            If there is no such contact, or it has no gradient, with the reason.
        """
        run = options(threads, progress, memory_limit)
        question = load_or_critical(indentation, force)
        found, summary = _fakir.gradient_asperities(self._asperities, *question, run)
        warn(found.warnings)
        contact = found.contact if isinstance(found, _fakir.AsperityTransition) else found
        return Gradient(AsperityContact(self, contact), json.loads(summary))

    @property
    def adhesion(self) -> Adhesion | None:
        """The adhesion of the tops, and of the floor if that is adhesive too; None without."""
        adhesion = self._asperities.adhesion
        if adhesion is None:
            return None
        work, receding, floor = adhesion
        return Adhesion(work, receding, floor=floor)

    def cycle(
        self,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        drive: Drive = "displacement",
        machine_stiffness: Quantity | None = None,
        retract: bool = True,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> AsperityCycle:
        """Computes loading, up to the critical state unless another end is given, and unloading with adhesion; parameters as in
        `System.cycle`."""
        plan = checked_plan(to, to_force, drive, machine_stiffness, retract)
        run = options(threads, progress, memory_limit)
        answer, curve, events = _fakir.cycle_asperities(self._asperities, *plan, run)
        warn(answer.warnings)
        return AsperityCycle(answer, curve, events)

    def __len__(self) -> int:
        return len(self.x)

    def __repr__(self) -> str:
        under = "a plate" if isinstance(self.indenter, Plate) else f"a {self.indenter}"
        radius = engineering(self.top_radius, "m", 4)
        return f"fakir.AsperityArray: {len(self)} tops of radius of curvature {radius}, under {under}"


class AsperityContact(AsperityPressNumbers):
    """The contact with rounded tops. Numbers are in SI units; arrays have one value for every top."""

    _titles = ("fakir.AsperityContact", "Contact with rounded tops")

    tops: AsperityArray
    """The problem."""
    x: FloatArray
    """Centre of every contact, m; for a top that is not touched, its point closest to contact."""
    y: FloatArray
    radius: FloatArray
    """Radius of every contact, m; 0 for a top that is not touched."""
    forces: FloatArray
    """Force on every top, N."""
    gap: FloatArray
    """Gap above every top that is not touched, m; 0 for the others."""
    floor: FloorContact | None
    """The contact with the floor; None before the transition."""

    def __init__(self, tops: AsperityArray, contact: _fakir.AsperityContact) -> None:
        super().__init__(contact)
        self.tops, self._contact = tops, contact
        self._columns = dict(contact.pillars())
        cells = contact.floor_cells()
        self.floor = None if cells is None else FloorContact(self, cells)
        self.x, self.y, self.radius, self.forces, self.gap = (
            np.asarray(self._columns[name], dtype=np.float64)
            for name in ["centre_x_m", "centre_y_m", "contact_radius_m", "force_N", "gap_m"]
        )

    def pressure(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Contact pressure (Pa) at points (m from the lens axis), which are broadcast; infinite at the rim of a full top, and at the
        edge of a contact with adhesion, where it is tensile."""
        return self._field(2, x, y, threads, memory_limit)

    def surface_gap(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Gap (m) between the lens and the top below it, or the floor between the tops."""
        return self._field(1, x, y, threads, memory_limit)

    def displacement(
        self, x: object, y: object, *, threads: int = 1, memory_limit: int | None = None
    ) -> Any:
        """Separation of the two surfaces by the pressure (m), without the shortening of pillars."""
        return self._field(0, x, y, threads, memory_limit)

    def _field(
        self, number: int, x: object, y: object, threads: int, memory_limit: int | None
    ) -> Any:
        across, along = points_at(x, y)
        _fakir.check_points(across.size, memory_limit)
        run = options(threads, memory_limit=memory_limit)
        samples = self._contact.sample(flat(across), flat(along), run)
        return samples[number].reshape(across.shape)[()]

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every top: the columns of ``pillars.csv``."""
        import pandas

        return pandas.DataFrame(self._columns)

    def _rows(self) -> list[Row]:
        error = self.error
        known = [] if error is None else [("estimated error of the area", f"{error.contact_area:.0e}")]
        return [
            ("force", engineering(self.force, "N")),
            ("indentation", engineering(self.indentation, "m")),
            ("contact area", f"{self.contact_area * 1e12:.5g} µm²"),
            ("tops in contact", f"{self.pillars_in_contact} of {len(self.tops)}"),
            *known,
            *([] if self.floor is None else self.floor._share_rows()),
            ("left out", ", ".join(self.left_out) or "nothing"),
            ("solution", self.termination),
        ]


class AsperityElements(NamedTuple):
    """A contact with rounded tops with boundary elements."""

    cells_per_diameter: int
    """Cells across every contact."""
    force: float
    """Force, N."""
    indentation: float
    """Indentation, m."""
    contact_area: float
    """Area of the cells in contact, m^2."""
    contact_radius: float | None
    """Distance from the lens axis of the farthest cell in contact, m; None under a level plate."""
    pillars_in_contact: int
    """Number of tops that carry a force."""
    converged: bool
    """Whether the solution converged."""
    floor_share: float | None = None
    """Fraction of the force carried by the floor; None if it carries no load with discs."""


class AsperityVerification(Opinion):
    """A contact with rounded tops as discs and with boundary elements, and their differences."""

    _titles = ("fakir.AsperityVerification", "Verification by an independent method")

    discs: AsperityContact
    """The contact as discs, with the accurate setting."""
    elements: tuple[AsperityElements, AsperityElements]
    """The contacts with boundary elements, on half as many cells and on all."""
    contact_area: Difference
    """Difference of the contact area on the tops with elements from that with discs."""

    def __init__(self, summary: dict[str, Any], discs: AsperityContact) -> None:
        super().__init__(summary)
        coarse, fine = (
            AsperityElements(
                row["cells_per_diameter"],
                row["force_N"],
                row["indentation_m"],
                row["contact_area_m2"],
                row["contact_radius_m"],
                row["pillars_in_contact"],
                row["converged"],
                row.get("floor_share"),
            )
            for row in summary["answers"][1:]
        )
        self.discs, self.elements = discs, (coarse, fine)

    def _rows(self) -> list[Row]:
        coarse, fine = self.elements
        return self._rows_of([("discs", self.discs), ("elements, coarse", coarse), ("elements", fine)])


class AsperityTransition(AsperityTransitionNumbers):
    """The critical state of rounded tops, in which the lens just reaches the floor. Numbers are in SI units."""

    _titles = ("fakir.AsperityTransition", "Critical state with rounded tops")

    contact: AsperityContact
    """The contact in this state."""

    def __init__(self, contact: AsperityContact, found: _fakir.AsperityTransition) -> None:
        super().__init__(found)
        self.contact = contact

    def _rows(self) -> list[Row]:
        x, y = (engineering(value, "m") for value in self.floor_contact)
        return [
            ("critical force", engineering(self.force, "N")),
            ("critical indentation", engineering(self.indentation, "m")),
            ("floor contact", f"at x = {x}, y = {y}"),
            ("contact area", f"{self.contact_area * 1e12:.5g} µm²"),
            ("tops in contact", f"{self.pillars_in_contact} of {len(self.contact.tops)}"),
            ("solution", self.termination),
        ]


class AsperityApproach(Loading[AsperityContact]):
    """The states of a loading on rounded tops, by increasing indentation; iterable."""

    _titles = ("fakir.AsperityApproach: indentation, force", "Approach of rounded tops: indentation, force")

    critical: AsperityTransition | None
    """The critical state, even if the loading ends before it; None without one."""

    def __init__(
        self,
        summary: dict[str, Any],
        states: list[AsperityContact],
        critical: AsperityTransition | None,
    ) -> None:
        super().__init__(summary, states)
        self.critical = critical

    def _rows(self) -> list[Row]:
        rows = []
        for state, row in zip(self.states, self._summary["states"]):
            mark = ", critical" if row["critical"] else ""
            text = f"{engineering(state.force, 'N')}, {state.pillars_in_contact} tops{mark}"
            rows.append((engineering(state.indentation, "m"), text))
        return rows


class AsperityCycle(AsperityCycleNumbers):
    """Loading and unloading of rounded tops with adhesion. Numbers are in SI units; arrays have one value for every load step."""

    _titles = ("fakir.AsperityCycle", "Loading and unloading with adhesion")

    __slots__ = ("branch", "contact_area", "events", "force", "indentation", "tops_in_contact")
    branch: list[str]
    """``"loading"`` or ``"unloading"`` of every load step."""
    indentation: FloatArray
    """Indentation at every load step, m."""
    force: FloatArray
    """Force at every load step, N; negative in tension."""
    contact_area: FloatArray
    """Area of all contacts at every load step, m^2."""
    tops_in_contact: FloatArray
    """Number of tops in contact at every load step."""
    events: list[dict[str, Any]]
    """Contacts that begin and end, in order: ``branch``, ``event`` (``"snap_in"`` or ``"release"``), ``pillar`` (the number of the
    top), ``indentation_m``, ``force_N`` and ``contact_radius_m``."""

    def __init__(
        self,
        answer: _fakir.Answer,
        curve: list[tuple[str, float, float, float, int]],
        events: list[tuple[str, str, int, float, float, float]],
    ) -> None:
        super().__init__(answer)
        self.branch = [step[0] for step in curve]
        columns = np.array([step[1:] for step in curve], dtype=np.float64).T
        self.indentation, self.force, self.contact_area, self.tops_in_contact = columns
        names = ["branch", "event", "pillar", "indentation_m", "force_N", "contact_radius_m"]
        self.events = [dict(zip(names, event)) for event in events]

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every load step."""
        return load_step_table(self, contact_area_m2=self.contact_area, pillars_in_contact=self.tops_in_contact.astype(int))

    def _rows(self) -> list[Row]:
        return cycle_rows(self)


class HeightDesign(Result):
    """Heights of rounded tops for a target curve. Arrays have one value for every point of the curve."""

    _titles = ("fakir.HeightDesign", "Designed heights")

    tops: AsperityArray
    """The tops with the resulting heights."""
    load: FloatArray
    """Forces (N) or indentations (m)."""
    wanted: FloatArray
    """Target areas (m^2) or forces (N)."""
    reached: FloatArray
    """Attained areas or forces."""
    interactions_ignored: FloatArray
    """Areas or forces of heights designed without interaction between tops."""
    scatter: FloatArray | None
    """Relative standard deviation due to the height error, if that was given."""

    def __init__(
        self, summary: dict[str, Any], tops: AsperityArray, columns: list[tuple[str, Any]]
    ) -> None:
        self._summary, self.tops = summary, tops
        self._columns = dict(columns)
        arrays = [np.asarray(values) for _, values in columns]
        self.load, self.wanted, self.reached, _, self.interactions_ignored = arrays[:5]
        self.scatter = arrays[6] if len(arrays) > 6 else None

    @property
    def found(self) -> bool:
        """Whether the curve is met at every load, to 1e-5. If not, the heights are the closest ones."""
        return bool(self._summary["design"]["status"] == "found")

    @property
    def statement(self) -> str:
        """Statement of the result."""
        return str(self._summary["design"]["statement"])

    @property
    def residual(self) -> FloatArray:
        """Relative differences from the target."""
        return self.reached / self.wanted - 1.0

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every point: the columns of ``curve.csv``."""
        import pandas

        return pandas.DataFrame(self._columns)

    def _rows(self) -> list[Row]:
        design = self._summary["design"]
        heights = f"{engineering(design['lowest_height_m'], 'm', 4)} to {engineering(design['highest_height_m'], 'm', 4)}"
        ignored = float(np.max(np.abs(self.interactions_ignored / self.wanted - 1.0)))
        return [
            ("curve", f"{design['wanted']}, {len(self.load)} points"),
            ("result", self.statement),
            ("heights", heights),
            ("in contact", f"{design['pillars_in_contact']} of {design['pillars']}"),
            ("interactions ignored", f"off by {100.0 * ignored:.2g} % at most"),
        ]


def design_heights(
    tops: AsperityArray,
    *,
    force: object = None,
    indentation: object = None,
    area: object = None,
    seed: int = SEED,
    height_error: Quantity | None = None,
    threads: int = 1,
    progress: Progress | None = None,
    memory_limit: int | None = None,
) -> HeightDesign:
    """Finds heights of rounded tops for a target curve: area as a function of force, force of indentation, or area of
    indentation.

    Parameters
    ----------
    tops
        Positions and curvatures of the tops; their own heights are ignored, except the height from which indentations are
        measured.
    force, indentation, area
        The curve: arrays of equal length for two of them (N, m, m^2), increasing.
    seed
        Seed for the assignment of heights to tops.
    height_error
        Standard deviation of manufactured heights (m), for the scatter of the curve.

    Raises
    ------
    ValueError
        If the curve decreases, or a top would be below the floor.
    DesignError
        If no heights of these tops attain such an area under such a force.

    Examples
    --------
    >>> x, y = np.meshgrid(1.5e-3 * np.arange(3.0), 1.5e-3 * np.arange(3.0))
    >>> tops = fakir.AsperityArray(x, y, 200e-6, "526 um", fakir.bem.Plate("70 GPa", 0.22), fakir.Substrate("1.5 MPa", 0.5))
    >>> found = fakir.design_heights(tops, force=[2e-3, 4e-3, 6e-3], area=[2.1e-8, 3.8e-8, 5.4e-8])
    >>> found.found
    True
    """
    given = {"force": force, "indentation": indentation, "area": area}
    names = [name for name, values in given.items() if values is not None]
    if len(names) != 2:
        raise TypeError("give two of force, indentation and area, which define the target curve")
    value = "area" if area is not None else "force"
    over = next(name for name in names if name != value)
    load_values = _curve(given[over], over)
    values = _curve(given[value], value)
    if load_values.shape != values.shape:
        raise ValueError(
            f"{over} has {load_values.size} values and {value} {values.size}: give one for each other"
        )
    error = None if height_error is None else si(height_error, "length", "height_error")
    if error is not None and not 0.0 < error < np.inf:
        raise ValueError(f"height_error is {error}: it must be a length greater than 0")
    run = options(threads, progress, memory_limit)
    warn_of_interactions(tops._asperities, "design", depth=1)
    summary, rounded, columns = _fakir.design_heights(
        tops._asperities,
        f"{value} of the {over}",
        np.stack([load_values, values], axis=1).tolist(),
        seed,
        error,
        run,
    )
    return HeightDesign(json.loads(summary), AsperityArray._of(rounded), columns)


def _curve(values: object, name: str) -> FloatArray:
    dimension: Literal["length", "force", "number"] = "number"
    if name == "force":
        dimension = "force"
    elif name == "indentation":
        dimension = "length"
    return np.ravel(array(values, dimension, name))


def _write(path: str | PathLike[str], contents: bytes) -> None:
    unfinished = Path(f"{fspath(path)}.tmp")
    unfinished.write_bytes(contents)
    unfinished.replace(path)
