"""Flat surfaces: contacts in closed form, with adhesion and layers."""

from __future__ import annotations

import json
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from . import _fakir
from ._bodies import AnyLens, Substrate, check_bodies, lens_of, shape_of, substrate_of
from ._cycle import Adhesion, Drive, cycle_rows, load_step_table, plan_with_end
from ._format import Row, Shown, engineering
from ._gradient import Gradient
from ._history import Viscoelastic
from ._loading import Loading, checked_path
from ._numbers import FlatCycleNumbers, FlatPressNumbers
from ._quantity import FloatArray, Quantity, array
from ._run import Progress, options, warn, warn_of_interactions
from ._settings import Overrides, load, settings
from ._verification import Difference, Opinion, checked_cells
from .errors import NotConverged

if TYPE_CHECKING:
    import pandas


class Flat:
    """A flat surface, without pillars: the third argument of `problem`."""

    def __repr__(self) -> str:
        return "fakir.Flat()"


class FlatSystem(Viscoelastic, Shown):
    """A lens or a flat punch on a flat surface.

    The contact is one disc: exact on half-spaces (Hertz, Sneddon; with adhesion Johnson, Kendall and Roberts), and from an
    integral equation on bodies of finite thickness.

    Parameters
    ----------
    lens
        A `Lens`, `ParaboloidLens`, `ProfileLens` or `FlatPunch`.
    substrate
        A `Substrate`, with a thickness or without.
    adhesion
        An `Adhesion`, or the work of adhesion (J/m^2).

    Examples
    --------
    >>> system = fakir.FlatSystem(fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5), adhesion="50 mJ/m2")
    >>> round(1e6 * system.cycle(to="5 um").pull_off_force)  # -(3/2) pi w R
    -518
    """

    _titles = ("fakir.FlatSystem", "Flat surface")

    __slots__ = ("_flat",)
    _flat: _fakir.Flat

    def __init__(
        self,
        lens: AnyLens,
        substrate: Substrate,
        *,
        adhesion: Adhesion | Quantity | None = None,
    ) -> None:
        check_bodies(lens, substrate)
        numbers, words = shape_of(lens)
        numbers = [
            *numbers,
            ("lens.young_modulus", lens.young_modulus),
            ("lens.poisson_ratio", lens.poisson_ratio),
            ("substrate.young_modulus", substrate.young_modulus),
            ("substrate.poisson_ratio", substrate.poisson_ratio),
        ]
        for body, part in ((lens, "lens"), (substrate, "substrate")):
            of_layer, words_of_layer = body._layer(part)
            numbers, words = numbers + of_layer, words + words_of_layer
        if adhesion is not None:
            given = adhesion if isinstance(adhesion, Adhesion) else Adhesion(adhesion)
            if given.floor:
                raise ValueError("a flat surface has no floor between pillars: leave floor=True out")
            numbers.append(("adhesion.work", given.work))
            numbers.append(("adhesion.work_receding", given.work_receding))
        words = [*words, ("surface.flat", "true")]
        known = [(key, float(number)) for key, number in numbers if number is not None]
        self._flat = _fakir.Flat.build(known, words)

    @classmethod
    def _of(cls, flat: _fakir.Flat) -> FlatSystem:
        system = cls.__new__(cls)
        system._flat = flat
        return system

    @classmethod
    def from_file(
        cls, path: str | PathLike[str], overrides: Overrides | None = None
    ) -> FlatSystem:
        """Reads a case file; ``overrides`` are values of keys, as ``--set`` of the command line."""
        return cls._of(_fakir.Flat.read(fspath(path), settings(overrides)))

    @classmethod
    def from_toml(cls, text: str, overrides: Overrides | None = None) -> FlatSystem:
        """As `from_file`, from the text of a case file."""
        return cls._of(_fakir.Flat.parse("case.toml", text, settings(overrides)))

    def to_toml(self) -> str:
        """The case as a commented file, which reproduces the system exactly."""
        return self._flat.to_toml()

    def replace(self, overrides: Overrides) -> FlatSystem:
        """The same system with other values: ``system.replace({"lens.radius": "1 mm"})``."""
        return self._of(self._flat.with_settings(settings(overrides)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FlatSystem) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        return FlatSystem.from_toml, (self.to_toml(),)

    def _problem(self) -> _fakir.Flat:
        return self._flat

    @property
    def lens(self) -> AnyLens:
        """The lens or the punch."""
        lens: AnyLens = lens_of(self._flat.values())
        return lens

    @property
    def substrate(self) -> Substrate:
        """The substrate."""
        return substrate_of(self._flat.values())

    @property
    def adhesion(self) -> Adhesion | None:
        """The adhesion; None without."""
        values = self._flat.values()
        work = values.get("adhesion.work")
        return None if work is None else Adhesion(work, values.get("adhesion.work_receding"))

    @property
    def reduced_modulus(self) -> float:
        """E*, Pa: 1/E* = (1 - ν²)/E, summed over both bodies."""
        return self._flat.reduced_modulus

    def press(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> FlatContact:
        """Computes the contact at an indentation (m) or under a force (N) on loading: exactly one of them."""
        run = options(threads, progress, memory_limit)
        return self._checked(_fakir.press_flat(self._flat, *load(indentation, force), run))

    def approach(
        self,
        step: Quantity = "1 um",
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> FlatApproach:
        """Computes a loading in steps of the indentation (m), up to an indentation (m) or a force (N)."""
        path = checked_path(step, None, False, to, to_force)
        run = options(threads, progress, memory_limit)
        summary, states = _fakir.approach_flat(self._flat, *path, run)
        return FlatApproach(json.loads(summary), [self._checked(state) for state in states])

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
    ) -> FlatCycle:
        """Computes loading and unloading with adhesion; parameters as in `System.cycle`, with a required end of loading."""
        plan = plan_with_end(to, to_force, drive, machine_stiffness, retract)
        run = options(threads, progress, memory_limit)
        answer, curve = _fakir.cycle_flat(self._flat, *plan, run)
        warn(answer.warnings)
        return FlatCycle(answer, curve)

    def gradient(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Gradient[FlatContact]:
        """Computes the contact at an indentation (m) or under a force (N) on loading, with its exact derivatives.

        They are with respect to the numbers of the system, by the keys of the case, such as ``lens.radius`` or ``adhesion.work``.

        Raises
        ------
        SolveError
            If nothing is touched.
        """
        run = options(threads, progress, memory_limit)
        answer, summary = _fakir.gradient_flat(self._flat, *load(indentation, force), run)
        return Gradient(self._checked(answer), json.loads(summary))

    def verify(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        cells_per_diameter: int = 64,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> FlatVerification:
        """Compares the disc of contact with boundary elements, on ``cells_per_diameter`` cells across the contact and on half as many."""
        checked_cells(cells_per_diameter)
        run = options(threads, progress, memory_limit)
        question = load(indentation, force)
        warn_of_interactions(self._flat, "verify", depth=1)
        summary, disc = _fakir.verify_flat(self._flat, *question, cells_per_diameter, run)
        return FlatVerification(json.loads(summary), FlatContact(disc, self))

    def _checked(self, answer: _fakir.Answer) -> FlatContact:
        contact = FlatContact(answer, self)
        warn(answer.warnings)
        if not contact.converged:
            raise NotConverged(f"the solution {contact.termination}", contact)
        return contact

    def _rows(self) -> list[Row]:
        rows = [("lens", str(self.lens)), ("substrate", str(self.substrate))]
        if self.adhesion is not None:
            rows.append(("work of adhesion", f"{1e3 * self.adhesion.work:g} mJ/m²"))
        return rows


class FlatContact(FlatPressNumbers):
    """The contact with a flat surface. Numbers are in SI units."""

    _titles = ("fakir.FlatContact", "Contact with a flat surface")

    __slots__ = ("system",)
    system: FlatSystem
    """The problem."""

    def __init__(self, answer: _fakir.Answer, system: FlatSystem) -> None:
        super().__init__(answer)
        self.system = system

    def pressure(
        self, radius: ArrayLike, *, threads: int = 1, memory_limit: int | None = None
    ) -> FloatArray:
        """Contact pressure (Pa) at distances from the lens axis (m); zero outside of the contact, negative where adhesion pulls.

        Distances may have any shape: ``contact.pressure(np.hypot(x, y))`` is a map.
        """
        return self._field(2, radius, threads, memory_limit)

    def gap(
        self, radius: ArrayLike, *, threads: int = 1, memory_limit: int | None = None
    ) -> FloatArray:
        """Gap (m) between the lens and the surface at distances from the lens axis (m); infinite beyond the rim of a punch."""
        return self._field(1, radius, threads, memory_limit)

    def displacement(
        self, radius: ArrayLike, *, threads: int = 1, memory_limit: int | None = None
    ) -> FloatArray:
        """Separation of the two surfaces by the pressure (m) at distances from the lens axis (m)."""
        return self._field(0, radius, threads, memory_limit)

    def _field(
        self, number: int, radius: ArrayLike, threads: int, memory_limit: int | None
    ) -> FloatArray:
        distances = np.asarray(array(radius, "length", "radius"), dtype=np.float64)
        _fakir.check_points(distances.size, memory_limit)
        run = options(threads, memory_limit=memory_limit)
        flat = np.ascontiguousarray(distances.ravel())
        samples = self.system._flat.sample(self.contact_radius or 0.0, self.indentation, flat, run)
        return np.asarray(samples[number]).reshape(distances.shape)

    def _rows(self) -> list[Row]:
        return [
            ("force", engineering(self.force, "N")),
            ("indentation", engineering(self.indentation, "m")),
            ("contact radius", engineering(self.contact_radius or 0.0, "m")),
            ("mean pressure", engineering(self.mean_pressure, "Pa")),
            ("solution", self.termination),
        ]


class FlatElements(NamedTuple):
    """A contact with a flat surface with boundary elements."""

    cells_per_diameter: int
    """Cells across the contact."""
    force: float
    """Force, N."""
    indentation: float
    """Indentation, m."""
    contact_radius: float | None
    """Contact radius, m; None under a punch, whose contact is given."""
    contact_area: float
    """Area of the cells in contact, m^2."""
    converged: bool
    """Whether the solution converged."""


class FlatVerification(Opinion):
    """A contact with a flat surface as one disc and with boundary elements, and their differences."""

    _titles = ("fakir.FlatVerification", "Verification by an independent method")

    disc: FlatContact
    """The contact as one disc."""
    elements: tuple[FlatElements, FlatElements]
    """The contacts with boundary elements, on half as many cells and on all."""
    contact_area: Difference
    """Difference of the contact area with elements from that of the disc."""

    def __init__(self, summary: dict[str, Any], disc: FlatContact) -> None:
        super().__init__(summary)
        coarse, fine = (
            FlatElements(
                row["cells_per_diameter"],
                row["force_N"],
                row["indentation_m"],
                row["contact_radius_m"],
                row["contact_area_m2"],
                row["converged"],
            )
            for row in summary["answers"][1:]
        )
        self.disc, self.elements = disc, (coarse, fine)

    def _rows(self) -> list[Row]:
        coarse, fine = self.elements
        return self._rows_of([("disc", self.disc), ("elements, coarse", coarse), ("elements", fine)])


class FlatApproach(Loading[FlatContact]):
    """The states of a loading, by increasing indentation; iterable."""

    _titles = ("fakir.FlatApproach: indentation, force", "Loading: indentation, force")

    def _rows(self) -> list[Row]:
        states = self.states
        return [(engineering(it.indentation, "m"), engineering(it.force, "N")) for it in states]


class FlatCycle(FlatCycleNumbers):
    """Loading and unloading with adhesion. Numbers are in SI units; arrays have one value for every load step."""

    _titles = ("fakir.FlatCycle", "Loading and unloading with adhesion")

    __slots__ = ("branch", "contact_radius", "force", "indentation")
    branch: list[str]
    """``"loading"`` or ``"unloading"`` of every load step."""
    indentation: FloatArray
    """Indentation at every load step, m."""
    force: FloatArray
    """Force at every load step, N; negative in tension."""
    contact_radius: FloatArray
    """Contact radius at every load step, m."""

    def __init__(
        self, answer: _fakir.Answer, curve: list[tuple[str, float, float, float]]
    ) -> None:
        super().__init__(answer)
        branch, *numbers = zip(*curve)
        self.branch = list(branch)
        self.indentation, self.force, self.contact_radius = (np.array(it) for it in numbers)

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every load step: the columns of ``cycle.csv``."""
        return load_step_table(self, contact_radius_m=self.contact_radius)

    def _rows(self) -> list[Row]:
        return cycle_rows(self)
