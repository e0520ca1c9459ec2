"""Design, scatter of samples, and references to cite."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from . import _fakir
from ._asperities import AsperityArray, AsperityContact, AsperityCycle, AsperityTransition
from ._cycle import Cycle
from ._flat import FlatContact, FlatCycle, FlatSystem
from ._format import Row, engineering
from ._quantity import FloatArray, Quantity, several, si
from ._result import Result
from ._run import Progress, options, warn_of_interactions
from ._settings import SEED
from ._state import ContactState, CriticalState, radius
from ._system import System
from .bem import Surface, SurfaceContact, SurfaceCycle, SurfaceTransition
from .errors import DesignError

if TYPE_CHECKING:
    import pandas


class Candidate(NamedTuple):
    """A value of the free quantity, and the resulting state."""

    value: float
    """The value of the free key, in SI units."""
    system: System | AsperityArray | Surface | FlatSystem
    """The system, the rounded tops, the height map or the flat surface, with this value."""
    reached: (
        CriticalState
        | ContactState
        | Cycle
        | AsperityTransition
        | AsperityContact
        | AsperityCycle
        | SurfaceTransition
        | SurfaceContact
        | SurfaceCycle
        | FlatContact
        | FlatCycle
    )
    """Its critical state; its contact under the load for a target of that contact; its cycle for a target pull-off force."""

    @property
    def critical(self) -> CriticalState | AsperityTransition | SurfaceTransition:
        """Its critical state; computed on access for other targets. A flat surface has none."""
        reached = self.reached
        if isinstance(reached, (CriticalState, AsperityTransition, SurfaceTransition)):
            return reached
        if isinstance(self.system, FlatSystem):
            raise DesignError("a flat surface has no critical state: it has no floor between pillars")
        return self.system.transition()

    @property
    def cycle(self) -> Cycle | AsperityCycle | SurfaceCycle | FlatCycle:
        """Its loading and unloading cycle; computed on access unless a pull-off force was the target."""
        reached = self.reached
        if isinstance(reached, (Cycle, AsperityCycle, SurfaceCycle, FlatCycle)):
            return reached
        if isinstance(self.system, FlatSystem):
            return self.system.cycle(to=self.state.indentation)
        return self.system.cycle()

    @property
    def state(self) -> ContactState | AsperityContact | SurfaceContact | FlatContact:
        """Its contact: critical, or under the load for a target of that contact."""
        if isinstance(self.reached, (ContactState, AsperityContact, SurfaceContact, FlatContact)):
            return self.reached
        critical = self.critical
        return critical.state if isinstance(critical, CriticalState) else critical.contact


class Design(Result):
    """The value that attains the target."""

    _titles = ("fakir.Design", "Design")

    free: str
    """The free key."""
    value: float
    """Its value, in SI units."""
    system: System | AsperityArray | Surface | FlatSystem
    """The system, the rounded tops, the height map or the flat surface, with this value."""
    sensitivity: float
    """Relative change of the result divided by that of the value: the required manufacturing accuracy."""

    def __init__(self, summary: dict[str, Any], found: Candidate) -> None:
        self._summary = summary
        answer = summary["design"]
        self.free = answer["free"]
        self.sensitivity = float("nan" if answer["sensitivity"] is None else answer["sensitivity"])
        self._found = found
        self.value, self.system = found.value, found.system

    @property
    def relative_error(self) -> float | None:
        """Estimated relative error of the value, due to the cells of a height map; None for other surfaces."""
        error = self._summary["design"].get("relative_error_estimate")
        return None if error is None else float(error)

    @property
    def critical(self) -> CriticalState | AsperityTransition | SurfaceTransition:
        """Its critical state; computed on access for other targets. A flat surface has none."""
        return self._found.critical

    @property
    def cycle(self) -> Cycle | AsperityCycle | SurfaceCycle | FlatCycle:
        """Its loading and unloading cycle; computed on access unless a pull-off force was the target."""
        return self._found.cycle

    @property
    def state(self) -> ContactState | AsperityContact | SurfaceContact | FlatContact:
        """Its contact: critical, or under the load for a target of that contact."""
        return self._found.state

    def _rows(self) -> list[Row]:
        units = {"fraction": "", "modulus": "Pa", "work": "J/m²", "receding": "J/m²"}
        unit = units.get(self.free.rsplit(".")[-1].rsplit("_")[-1], "m")
        reached = self._found.reached
        contact: list[Row]
        of_tops = (AsperityTransition, AsperityContact, AsperityCycle)
        of_other_surfaces = (SurfaceTransition, SurfaceContact, SurfaceCycle, FlatContact, FlatCycle)
        if isinstance(reached, (Cycle, *of_tops, *of_other_surfaces)):
            contact = reached._rows()
        elif isinstance(reached, CriticalState):
            contact = [
                ("critical force", engineering(reached.force, "N")),
                ("critical contact radius", radius(reached.contact_radius, reached.error.contact_radius)),
            ]
        else:
            contact = [
                ("force", engineering(reached.force, "N")),
                ("indentation", engineering(reached.indentation, "m")),
                *([] if reached.floor is None else reached.floor._share_rows()),
            ]
        return [
            (self.free, engineering(self.value, unit)),
            *contact,
            ("sensitivity", f"{self.sensitivity:.3g} % of the answer for 1 % of the value"),
        ]


class OutOfReach(DesignError):
    """The target is unattainable; ``nearest`` contains the closest candidates."""

    nearest: list[Candidate]

    def __init__(self, message: str, nearest: list[Candidate]) -> None:
        super().__init__(message)
        self.nearest = nearest


def design(
    system: System | AsperityArray | Surface | FlatSystem,
    free: str,
    *,
    critical_force: Quantity | None = None,
    critical_contact_radius: Quantity | None = None,
    floor_share: Quantity | None = None,
    at_force: Quantity | None = None,
    at_indentation: Quantity | None = None,
    pull_off: Quantity | None = None,
    threads: int = 1,
    progress: Progress | None = None,
    memory_limit: int | None = None,
    force: Quantity | None = None,
    contact_radius: Quantity | None = None,
) -> Design:
    """Finds the value of one quantity for a target of the critical state, of the contact under a load, or of the pull-off.

    Parameters
    ----------
    system
        All other quantities; its value of ``free`` is the initial value. Rounded tops, which support no floor share, and a
        `fakir.bem.Surface`, every contact of which is solved on its cells, must be those of a case file.
    free
        Key of the quantity: ``"pattern.pitch"``, ``"pattern.surface_fraction"``, ``"pattern.pillar.height"``,
        ``"pattern.pillar.diameter"``, ``"lens.radius"``, ``"lens.young_modulus"``, ``"substrate.young_modulus"``,
        ``"substrate.thickness"``, ``"lens.thickness"``, the modulus of an elastic base, ``"adhesion.work"`` or
        ``"adhesion.work_receding"``; for rounded tops also
        ``"pattern.top_radius"``; for a height map ``"surface.height_unit"`` and the lengths of its pillars.
    critical_force, critical_contact_radius
        Target of the critical state (N, m).
    floor_share, at_force, at_indentation
        Target fraction of the load carried by the floor past the transition, as in ``0.2`` or ``"20 %"``, and the load at which
        it applies: a force (N) or an indentation (m). It is met within its estimated error.
    force, contact_radius
        Target force (N) of the contact at ``at_indentation``, or contact radius (m) of the contact at ``at_force`` or
        ``at_indentation``. Without a load they are the older names of ``critical_force`` and ``critical_contact_radius``.
    pull_off
        Target pull-off force (N, as a positive number) on unloading from the critical state, or from the contact at ``at_force``
        or ``at_indentation``, for a system with adhesion. It is met within its numerical error.

    Exactly one target must be given. A flat surface has no critical state and no floor: its targets are the force, the contact
    radius and the pull-off force, with a load.

    Raises
    ------
    OutOfReach
        If the target is unattainable; contains the closest attainable value and the reason.
    """
    is_loaded = at_force is not None or at_indentation is not None
    if not is_loaded:
        critical_force = _renamed("force", force, "critical_force", critical_force)
        critical_contact_radius = _renamed(
            "contact_radius", contact_radius, "critical_contact_radius", critical_contact_radius
        )
        force = contact_radius = None
    loaded: list[tuple[str, Quantity | None, Literal["fraction", "force", "length"]]] = [
        ("floor_share", floor_share, "fraction"),
        ("pull_off", pull_off, "force"),
        ("force", force, "force"),
        ("contact_radius", contact_radius, "length"),
    ]
    given = [critical_force, critical_contact_radius, *(value for _, value, _ in loaded)]
    if sum(value is not None for value in given) != 1:
        raise TypeError(
            "give exactly one of critical_force, critical_contact_radius, force, contact_radius, floor_share and pull_off"
        )
    if is_loaded and (critical_force is not None or critical_contact_radius is not None):
        raise TypeError(
            "at_force and at_indentation are the load of floor_share, force, contact_radius or pull_off: give one of these"
        )
    if at_force is not None and at_indentation is not None:
        raise TypeError("give exactly one of at_force and at_indentation")
    if floor_share is not None and not is_loaded:
        raise TypeError("give the load of floor_share: exactly one of at_force and at_indentation")
    run = options(threads, progress, memory_limit)
    load = (
        None if at_force is None else si(at_force, "force", "at_force"),
        None if at_indentation is None else si(at_indentation, "length", "at_indentation"),
    )
    targets = [
        (name, (si(value, dimension, name), *load))
        for name, value, dimension in loaded
        if value is not None
    ]
    wanted = (
        None if critical_force is None else si(critical_force, "force", "critical_force"),
        None
        if critical_contact_radius is None
        else si(critical_contact_radius, "length", "critical_contact_radius"),
        targets[0] if targets else None,
    )
    problem = system._problem()
    warn_of_interactions(problem, "design", depth=1)
    summary, found = _fakir.design(problem, free, wanted, run)
    answer = json.loads(summary)
    candidates = [
        _candidate(value, case, reached)
        for value, case, reached in found
    ]
    if answer["design"]["status"] == "found":
        return Design(answer, candidates[0])
    raise OutOfReach(answer["design"]["statement"], candidates)


def _candidate(
    value: float, case: _fakir.Case | _fakir.Asperities | _fakir.Surface | _fakir.Flat, found: Any
) -> Candidate:
    if isinstance(case, _fakir.Flat):
        flat = FlatSystem._of(case)
        if isinstance(found, _fakir.Answer):
            return Candidate(value, flat, FlatContact(found, flat))
        return Candidate(value, flat, FlatCycle(*found))
    if isinstance(case, _fakir.Surface):
        surface = Surface._of(case)
        if isinstance(found, _fakir.SurfaceTransition):
            return Candidate(value, surface, SurfaceTransition(SurfaceContact(surface, found.contact), found))
        if isinstance(found, tuple):
            return Candidate(value, surface, surface._cycle(found))
        return Candidate(value, surface, SurfaceContact(surface, found))
    if isinstance(case, _fakir.Asperities):
        tops = AsperityArray._of(case)
        if isinstance(found, _fakir.AsperityTransition):
            return Candidate(value, tops, AsperityTransition(AsperityContact(tops, found.contact), found))
        if isinstance(found, _fakir.AsperityContact):
            return Candidate(value, tops, AsperityContact(tops, found))
        return Candidate(value, tops, AsperityCycle(*found))
    system = System._of(case)
    if isinstance(found, _fakir.Cycle):
        return Candidate(value, system, Cycle(found, system))
    if isinstance(found, _fakir.State):
        return Candidate(value, system, ContactState(found, system))
    return Candidate(value, system, CriticalState(found, system))


def _renamed(
    old: str, given: Quantity | None, name: str, value: Quantity | None
) -> Quantity | None:
    """The value of an argument that may be given under its deprecated name, with a warning."""
    if given is None:
        return value
    if value is not None:
        raise TypeError(f"{old} is the older name of {name}: give only {name}")
    warnings.warn(f"{old} is now called {name}", FutureWarning, stacklevel=3)
    return given


class Spread(Result):
    """Critical states of samples about a system, and their unloading with adhesion. Arrays have one value for every sample."""

    _titles = ("fakir.Spread", "Spread of the critical state")

    def __init__(self, summary: dict[str, Any], columns: dict[str, Any]) -> None:
        self._summary, self._columns = summary, columns

    @property
    def force(self) -> FloatArray:
        """Critical forces, N; NaN if there is none."""
        return self._column("critical_force_N")

    @property
    def indentation(self) -> FloatArray:
        """Critical indentations, m."""
        return self._column("critical_indentation_m")

    @property
    def contact_radius(self) -> FloatArray:
        """Critical contact radii, m."""
        return self._column("critical_contact_radius_m")

    @property
    def pull_off_force(self) -> FloatArray | None:
        """Pull-off forces on unloading from the critical state, N, negative; None without adhesion."""
        return self._column("pull_off_force_N") if "pull_off_force_N" in self._columns else None

    @property
    def hysteresis(self) -> FloatArray | None:
        """Hysteresis (area of the force-indentation loop), J; None without adhesion."""
        return self._column("hysteresis_J") if "hysteresis_J" in self._columns else None

    @property
    def first_order(self) -> tuple[float, float] | None:
        """Standard deviations of critical force (N) and indentation (m) from exact derivatives, with the landing position as
        given; None if these derivatives are not available, as with missing pillars. The scatter of the landing position is not
        included."""
        first_order = self._summary["spread"].get("first_order")
        if first_order is None:
            return None
        return first_order["critical_force_N"], first_order["critical_indentation_m"]

    def force_at(self, place: int) -> FloatArray:
        """Forces (N) at one of the requested indentations, by its index; NaN if there is no critical state."""
        columns = [name for name in self._columns if name.startswith("force_at_")]
        return self._column(columns[place])

    def errors(self, of: str = "critical_force_N") -> tuple[float, float] | None:
        """Estimated errors of mean and standard deviation due to the cells of a height map, in the unit of the column; None for other
        surfaces. The error of a finite number of samples is not included."""
        statistics = self._summary["spread"].get(of) or {}
        if "mean_error_estimate" not in statistics:
            return None
        return statistics["mean_error_estimate"], statistics["standard_deviation_error_estimate"]

    @property
    def problems(self) -> list[str]:
        """Why a sample has no critical state; empty for the others."""
        return list(self._columns["problem"])

    def percentile(self, percentage: float, of: str = "critical_force_N") -> float:
        """A percentile of the samples with a critical state."""
        return float(np.nanpercentile(self._column(of), percentage))

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every sample: the columns of ``samples.csv``."""
        import pandas

        return pandas.DataFrame(self._columns)

    def _column(self, name: str) -> FloatArray:
        return np.asarray(self._columns[name], dtype=np.float64)

    def __len__(self) -> int:
        return len(self._columns["problem"])

    def _rows(self) -> list[Row]:
        rows = []
        for name, column, unit in [
            ("critical force", "critical_force_N", "N"),
            ("critical indentation", "critical_indentation_m", "m"),
            ("critical contact radius", "critical_contact_radius_m", "m"),
            ("pull-off force", "pull_off_force_N", "N"),
            ("hysteresis", "hysteresis_J", "J"),
        ]:
            values = self._column(column) if column in self._columns else None
            if values is None or np.isnan(values).all():
                continue
            mean, deviation = float(np.nanmean(values)), float(np.nanstd(values, ddof=1))
            low, high = np.nanpercentile(values, [2.5, 97.5])
            text = f"{engineering(mean, unit, 4)} ± {engineering(deviation, unit, 2)}"
            limits = f"{engineering(float(low), unit, 4)} to {engineering(float(high), unit, 4)}"
            rows.append((name, f"{text}, 95 % in {limits}"))
            if (errors := self.errors(column)) is not None:
                of_mean, of_deviation = (engineering(error, unit, 2) for error in errors)
                rows.append(("  errors of cells", f"{of_mean} of the mean, {of_deviation} of the deviation"))
        failed = sum(bool(problem) for problem in self.problems)
        return [*rows, ("samples", f"{len(self)}, {failed} without a critical state")]


def spread(
    system: System | AsperityArray | Surface,
    tolerances: Mapping[str, Quantity],
    *,
    samples: int | None = None,
    seed: int = SEED,
    landing: str = "anywhere",
    force_at: Sequence[Quantity] | Quantity = (),
    threads: int = 0,
    progress: Progress | None = None,
    memory_limit: int | None = None,
) -> Spread:
    """Computes the scatter of the critical state from sample to sample; with adhesive tops also that of pull-off and hysteresis.

    Parameters
    ----------
    system
        Pillars, rounded tops of a case file, or a height map of a case file.
    tolerances
        Standard deviations by key: ``{"pattern.pillar.height": "5 %", "pattern.pitch": "0.1 um"}``, as a fraction of the value
        with ``%``, otherwise in SI units or with a unit.
    samples, seed
        Number of samples, and seed of all random numbers: by default 500, on a height map 50, and 1, as on the command line.
    landing
        Landing position of the lens on the lattice: ``"anywhere"`` or ``"as_given"``.
    force_at
        Indentations (m) at which the force of every sample is computed too.

    Every sample of a height map is solved again on its cells, pillars being drawn again; a map from a file has no lattice, and takes
    ``landing="as_given"`` and the tolerances of a whole: those of lens and substrate, and of the scales of its heights and lengths.

    Every sample of a lattice with a ``height_standard_deviation`` or a ``vacancy_fraction`` has its own random pillars; ``seed`` of
    the pattern is then not used, nor that of pillars at random.
    """
    if landing not in {"anywhere", "as_given"}:
        raise ValueError(f'landing is {landing!r}: give "anywhere" or "as_given"')
    deviations = [_tolerance(key, value) for key, value in tolerances.items()]
    indentations = [si(value, "length", "force_at") for value in several(force_at)]
    run = options(threads, progress, memory_limit)
    problem = system._problem()
    warn_of_interactions(problem, "design", depth=1)
    summary, columns = _fakir.spread(
        problem, deviations, landing == "anywhere", indentations, (samples, seed), run
    )
    return Spread(json.loads(summary), dict(columns))


def _tolerance(key: str, value: Quantity) -> tuple[str, float, bool]:
    if isinstance(value, str):
        return key, *_fakir.parse_deviation(key, value)
    return key, si(value, _fakir.dimension(key), key), False


class Citation(NamedTuple):
    """A reference to cite."""

    text: str
    bibtex: str
    why: str


def cite(*what: object, theory: bool = False) -> list[Citation]:
    """References to cite for systems of any surface, contacts, critical states, loadings and verifications; with ``theory`` also for closed forms.

    Cycles, gradients, histories and samples do not contain their system: give it.

    ``print("\\n".join(entry.bibtex for entry in fakir.cite(critical)))`` prints a bibliography.
    """
    cases: list[_fakir.Case] = []
    flats: list[_fakir.Flat] = []
    surface: bool | None = None
    rounded: bool | None = None
    for item in what:
        states = getattr(item, "states", None) or [getattr(item, "spectral", item)]
        item = states[0]
        system = getattr(item, "system", item)
        if isinstance(system, System):
            cases.append(system._case)
        elif isinstance(system, FlatSystem):
            flats.append(system._flat)
        elif hasattr(item, "periodic"):
            surface = bool(item.periodic)
        elif hasattr(item, "top_radius") or hasattr(item, "tops"):
            rounded = bool(rounded) or hasattr(item, "interactions_ignored")
        else:
            raise TypeError(
                f"a {type(item).__name__} does not contain its system: give the system, or a contact or critical state of it"
            )
    return [Citation(*entry) for entry in _fakir.cite(cases, flats, theory, surface, rounded)]
