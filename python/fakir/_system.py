"""A lens above a pillar pattern, and the computations for it."""

from __future__ import annotations

import warnings
from os import PathLike, fspath
from typing import Any, Literal

import numpy as np

from . import _fakir
from ._bodies import (
    AnyLens,
    HexagonalPattern,
    LatticeOptions,
    LatticePattern,
    ObliquePattern,
    Pillars,
    PlateLens,
    ProfileLens,
    RectangularPattern,
    RoundLens,
    SquarePattern,
    Substrate,
    PillarPattern,
    lens_of,
    shape_of,
    substrate_of,
)
from ._comparison import Comparison, compare
from ._cycle import Adhesion, Cycle, Drive, checked_plan, cycle
from ._format import Row, Shown, engineering
from ._gradient import Gradient, gradient
from ._history import Viscoelastic
from ._loading import Approach, approach, checked_path
from ._quantity import Quantity
from ._run import Progress, options
from ._settings import Overrides, load, load_or_critical, overrides_of, settings
from ._state import ContactState, CriticalState, contact_state, critical_state
from ._verification import Verification, verify
from .bem import Surface

Method = Literal["spectral", "love", "punch", "homogenised"]


class System(Viscoelastic, Shown):
    """A lens above a pillar pattern: the complete, validated problem.

    Parameters
    ----------
    lens, substrate, pattern
        The bodies and the pattern. A lens is a `Lens`, which is a sphere, or another shape: `ParaboloidLens`, `FlatPunch`, `CylinderLens`,
        `PlateLens`, `ProfileLens`.
    floor_contact
        Whether the floor between the pillars carries load past the transition. If False, floor contact is ignored, as in the
        paper.
    adhesion
        Adhesion of the pillar tops: an `Adhesion`, or the work of adhesion alone (J/m^2, or a string such as ``"50 mJ/m2"``).
        Without it there is no adhesion. Only the method ``"spectral"`` supports adhesion.
    texture
        Deprecated name of ``pattern``.

    Examples
    --------
    >>> from fakir import Lens
    >>> system = fakir.System(
    ...     fakir.Lens("2.2 mm", "2 MPa", 0.5),
    ...     fakir.Substrate("2 MPa", 0.5),
    ...     fakir.HexagonalPattern("6 um", "2.2 um", surface_fraction=0.1),
    ... )
    >>> round(1e3 * system.transition().force, 3)
    4.448

    Past the transition the floor carries part of the load:

    >>> sparse = system.replace({"pattern.surface_fraction": 0.03})
    >>> state = sparse.press(indentation="6 um")
    >>> round(state.floor.share, 2)
    0.15

    With adhesion, `cycle` computes loading and unloading:

    >>> adhesive = sparse.replace({"adhesion.work": "50 mJ/m2"})
    >>> round(1e6 * adhesive.cycle().pull_off.force)
    -57
    """

    _titles = ("fakir.System", "System")

    __slots__ = ("_case",)
    _case: _fakir.Case

    def __init__(
        self,
        lens: AnyLens,
        substrate: Substrate,
        pattern: PillarPattern | None = None,
        *,
        floor_contact: bool = True,
        adhesion: Adhesion | Quantity | None = None,
        texture: PillarPattern | None = None,  # former name
    ) -> None:
        if texture is not None:  # former name
            if pattern is not None:
                raise TypeError("texture is the older name of pattern: give only pattern")  # former name
            warnings.warn("texture is now called pattern", FutureWarning, stacklevel=2)  # former name
            pattern = texture  # former name
        if not isinstance(floor_contact, (bool, np.bool_)):
            raise TypeError(
                f"floor_contact is of type {type(floor_contact).__name__}: give True or False"
            )
        kinds: list[tuple[object, type | tuple[type, ...], str]] = [
            (lens, (RoundLens, PlateLens, ProfileLens), "Lens"),
            (substrate, Substrate, "Substrate"),
            (pattern, (LatticePattern, Pillars), "HexagonalPattern"),
        ]
        for part, kind, name in kinds:
            if not isinstance(part, kind):
                raise TypeError(
                    f"a system takes a Lens, a Substrate and a HexagonalPattern or another pattern, in this "
                    f"order: found {type(part).__name__} for {name}"
                )
        assert pattern is not None
        of_shape, words_of_shape = shape_of(lens)
        of_layers = [lens._layer("lens"), substrate._layer("substrate")]
        numbers: list[tuple[str, float | None]] = [
            *of_shape,
            ("lens.young_modulus", lens.young_modulus),
            ("lens.poisson_ratio", lens.poisson_ratio),
            ("substrate.young_modulus", substrate.young_modulus),
            ("substrate.poisson_ratio", substrate.poisson_ratio),
            *of_layers[0][0],
            *of_layers[1][0],
        ]
        if adhesion is not None:
            adhesive = adhesion if isinstance(adhesion, Adhesion) else Adhesion(adhesion)
            numbers.append(("adhesion.work", adhesive.work))
            numbers.append(("adhesion.work_receding", adhesive.work_receding))
        words = [
            *words_of_shape,
            *of_layers[0][1],
            *of_layers[1][1],
            ("pattern.pillar.compliance", pattern.compliance),
            ("floor.contact", "true" if floor_contact else "false"),
        ]
        if isinstance(adhesion, Adhesion) and adhesion.floor:
            words.append(("adhesion.floor", "true"))
        pillars = None
        if isinstance(pattern, Pillars):
            numbers += pattern.reference
            numbers.append(("pattern.axis_x", pattern.axis[0]))
            numbers.append(("pattern.axis_y", pattern.axis[1]))
            words.append(("pattern.lattice", "listed"))
            pillars = pattern._rows()
        else:
            numbers += pattern._numbers()
            words.append(("pattern.lattice", pattern._lattice))
        given = [(key, float(number)) for key, number in numbers if number is not None]
        self._case = _fakir.Case.build(given, words, pillars)

    @classmethod
    def _of(cls, case: _fakir.Case) -> System:
        system = cls.__new__(cls)
        system._case = case
        return system

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        overrides: Overrides | None = None,
        *,
        set: Overrides | None = None,
    ) -> System | Surface:
        """Reads a case file; ``overrides`` contains values of keys, as ``--set`` of the command line. ``set`` is its deprecated
        name.

        The method of the file is the default of all computations. For a case with a general ``[surface]`` a `fakir.bem.Surface`
        is returned, which has the same functions `press`, `transition`, `approach` and `verify`.
        """
        given = settings(overrides_of(overrides, set))
        return cls._described(_fakir.read_case(fspath(path), given, False))

    @classmethod
    def from_toml(
        cls, text: str, overrides: Overrides | None = None, *, set: Overrides | None = None
    ) -> System | Surface:
        """As `from_file`, from the text of a case file."""
        given = settings(overrides_of(overrides, set))
        return cls._described(_fakir.parse_case("case.toml", text, given))

    @classmethod
    def _described(
        cls, found: _fakir.Case | _fakir.Surface | _fakir.Asperities
    ) -> System | Surface:
        if isinstance(found, _fakir.Surface):
            return Surface._of(found)
        assert isinstance(found, _fakir.Case), "rounded tops are refused"
        return cls._of(found)

    def _problem(self) -> _fakir.Case:
        return self._case

    def to_toml(self, table: str = "pillars.csv") -> str:
        """The case as a commented file, which reproduces the system exactly. `Pillars` that were given as arrays are read from a table of that name in
        the same folder: write it by their ``to_csv``."""
        return self._case.to_toml_with_table(table)

    def replace(
        self, overrides: Overrides | None = None, *, set: Overrides | None = None
    ) -> System:
        """The same system with other values: ``system.replace({"pattern.pitch": "25 um"})``."""
        given = settings(overrides_of(overrides, set))
        return self._of(self._case.with_settings(given))

    @property
    def lens(self) -> AnyLens:
        """The lens."""
        lens: AnyLens = lens_of(self._case.values())
        return lens

    @property
    def substrate(self) -> Substrate:
        """The substrate."""
        return substrate_of(self._case.values())

    @property
    def texture(self) -> PillarPattern:  # former name
        """Deprecated name of `pattern`."""
        warnings.warn("texture is now called pattern", FutureWarning, stacklevel=2)  # former name
        return self.pattern

    @property
    def pattern(self) -> PillarPattern:
        """The pillar pattern, given by its pitch."""
        values = self._case.values()
        rows = self._case.listed()
        height, diameter = values["pattern.pillar.height"], values["pattern.pillar.diameter"]
        compliance = values["pattern.pillar.compliance"]
        if rows is not None:
            x, y, heights, diameters = np.array(rows).T
            return Pillars(
                x,
                y,
                heights,
                diameters,
                reference_height=height,
                reference_diameter=diameter,
                compliance=compliance,
            )
        columns = values.get("pattern.columns")
        options: LatticeOptions = {
            "offset": values["pattern.offset"],
            "offset_angle": values["pattern.offset_angle"],
            "rotation": values.get("pattern.rotation", 0.0),
            "columns": None if columns is None else int(columns),
            "height_standard_deviation": values.get("pattern.height_standard_deviation", 0.0),
            "vacancy_fraction": values.get("pattern.vacancy_fraction", 0.0),
            "seed": int(values.get("pattern.seed", 0)),
            "compliance": compliance,
        }
        pitch = values["pattern.pitch"]
        match values["pattern.lattice"]:
            case "square":
                return SquarePattern(diameter, height, pitch=pitch, **options)
            case "rectangular":
                pitch_y = values["pattern.pitch_y"]
                return RectangularPattern(diameter, height, pitch=pitch, pitch_y=pitch_y, **options)
            case "oblique":
                return ObliquePattern(
                    diameter,
                    height,
                    pitch=pitch,
                    pitch_y=values["pattern.pitch_y"],
                    angle=values["pattern.lattice_angle"],
                    **options,
                )
        return HexagonalPattern(diameter, height, pitch=pitch, **options)

    @property
    def _pillar(self) -> tuple[float, float]:
        """Diameter and height of the common pillar, m."""
        values = self._case.values()
        return values["pattern.pillar.diameter"], values["pattern.pillar.height"]

    @property
    def pitch(self) -> float:
        """Distance between neighbouring pillars, m; for listed pillars the mean distance to the nearest neighbour."""
        return float(self._case.values()["pattern.pitch"])

    @property
    def surface_fraction(self) -> float:
        """Fraction of the surface covered by pillar tops."""
        return float(self._case.values()["pattern.surface_fraction"])

    @property
    def floor_contact(self) -> bool:
        """Whether the floor carries load past the transition; if not, floor contact is ignored."""
        return bool(self._case.values()["floor.contact"] == "true")

    @property
    def adhesion(self) -> Adhesion | None:
        """Adhesion of the pillar tops; None without adhesion."""
        values = self._case.values()
        if "adhesion.work" not in values:
            return None
        return Adhesion(
            values["adhesion.work"],
            values.get("adhesion.work_receding"),
            floor=values.get("adhesion.floor") == "true",
        )

    @property
    def method(self) -> str:
        """The default method."""
        return str(self._case.values()["method.name"])

    def pillar_centre(self, i: int, j: int) -> tuple[float, float]:
        """Centre of a pillar by its lattice indices, m from the lens axis."""
        x, y = self._case.centre(i, j)
        return x, y

    def transition(
        self,
        method: Method | None = None,
        *,
        accuracy: Literal["default", "accurate"] | None = None,
        form: Literal["corrected", "plain"] | None = None,
        cells_per_diameter: int | None = None,
        mesh: Literal["pillars", "pattern"] | None = None,
        cells: Literal["matched", "plain"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> CriticalState:
        """Computes the critical state, in which the lens just reaches the floor between the pillars.

        Parameters
        ----------
        method
            ``"spectral"`` (the default unless a case file gives another), ``"love"``, ``"punch"`` or ``"homogenised"``.
        accuracy
            Accuracy of the spectral method: ``"default"`` or ``"accurate"``.
        form
            Form of the punch lattice: ``"corrected"`` or ``"plain"``.
        cells_per_diameter, mesh, cells
            Options of boundary elements, as in a case file.
        threads
            Number of threads; 0 for all processors, which is the maximum.
        progress
            Called at intervals with the stage, the step, and the numbers of pillars solved and touched. An exception in it stops
            the computation.
        memory_limit
            Memory limit in bytes; 8 GB if not given.

        Raises
        ------
        SolveError
            If there is no such contact, or it exceeds the memory limit.
        NotConverged
            If the solution did not converge; ``result`` contains the last iterate.
        KeyboardInterrupt
            Within a fraction of a second of Ctrl-C.
        """
        system = self._with_method(method, accuracy, form, cells_per_diameter, mesh, cells)
        run = options(threads, progress, memory_limit)
        return critical_state(_fakir.transition(system._case, run), system)

    def press(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        method: Method | None = None,
        accuracy: Literal["default", "accurate"] | None = None,
        form: Literal["corrected", "plain"] | None = None,
        cells_per_diameter: int | None = None,
        mesh: Literal["pillars", "pattern"] | None = None,
        cells: Literal["matched", "plain"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> ContactState:
        """Computes the contact at an indentation (m) or under a force (N): exactly one of them.

        Past the transition the floor carries part of the load: `ContactState.floor`. Only the method ``"spectral"`` computes
        this. With the other methods, and with ``floor_contact=False`` of the system, floor contact is ignored, with a warning.
        All other arguments are as in `transition`.
        """
        system = self._with_method(method, accuracy, form, cells_per_diameter, mesh, cells)
        run = options(threads, progress, memory_limit)
        return contact_state(_fakir.press(system._case, *load(indentation, force), run), system)

    def gradient(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        accuracy: Literal["default", "accurate"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Gradient[ContactState]:
        """Computes the contact at an indentation (m) or under a force (N), or the critical state, with its exact derivatives.

        They are with respect to the numbers of the system, and to the height of every pillar. They are supported only by the
        method ``"spectral"`` and without adhesion, also past the transition.

        Raises
        ------
        SolveError
            If there is no such contact, or it has no gradient, with the reason.
        """
        system = self._with_method("spectral", accuracy)
        question = load_or_critical(indentation, force)
        return gradient(system, question, options(threads, progress, memory_limit))

    def approach(
        self,
        step: Quantity = "1 um",
        until: Quantity | None = None,
        past_transition: bool = False,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        method: Method | None = None,
        accuracy: Literal["default", "accurate"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Approach:
        """Computes a loading in steps from first contact, up to the critical state or beyond.

        The critical state is one of the states. Past it the floor carries part of the load, as in `press`.

        Parameters
        ----------
        step
            Step of the indentation (m).
        until
            The last indentation (m), unless the critical state is reached earlier.
        to
            The last indentation (m), before the critical state or past it.
        to_force
            The force (N) at the end of the loading, before the critical state or past it.
        past_transition
            Deprecated: makes ``until`` equivalent to ``to``.
        """
        path = checked_path(step, until, past_transition, to, to_force)
        system = self._with_method(method, accuracy)
        return approach(system, path, options(threads, progress, memory_limit))

    def cycle(
        self,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        drive: Drive = "displacement",
        machine_stiffness: Quantity | None = None,
        retract: bool = True,
        accuracy: Literal["default", "accurate"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Cycle:
        """Computes loading and unloading with adhesive pillar tops, by default up to the critical state.

        If the floor is not adhesive, loading ends at the latest where the lens reaches it, unless floor contact is ignored
        (``floor_contact=False``).

        Parameters
        ----------
        to, to_force
            The indentation (m) or the force (N) at which unloading starts.
        drive
            Quantity held fixed while contacts attach or detach: ``"displacement"``, ``"force"``, or the crosshead position of a
            testing ``"machine"``.
        machine_stiffness
            Stiffness of that machine (N/m).
        retract
            Whether unloading is computed.
        """
        system = self._with_method(None, accuracy)
        plan = checked_plan(to, to_force, drive, machine_stiffness, retract)
        return cycle(system, plan, options(threads, progress, memory_limit))

    def compare(
        self,
        *,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Comparison:
        """Computes the critical state by every method, approximate to exact."""
        return compare(self, options(threads, progress, memory_limit))

    def verify(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        cells_per_diameter: int = 16,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Verification:
        """Compares the spectral method with boundary elements on the same problem.

        The problem is the critical state, or the contact under a load if one is given: with adhesion on loading.
        """
        question = load_or_critical(indentation, force)
        run = options(threads, progress, memory_limit)
        return verify(self, question, cells_per_diameter, run)

    def _with_method(
        self,
        method: str | None,
        accuracy: str | None,
        form: str | None = None,
        cells_per_diameter: int | None = None,
        mesh: str | None = None,
        cells: str | None = None,
    ) -> System:
        asked = {
            "method.name": method,
            "method.accuracy": accuracy,
            "method.form": form,
            "method.cells_per_diameter": cells_per_diameter,
            "method.mesh": mesh,
            "method.cells": cells,
        }
        settings = [f"{key}={value}" for key, value in asked.items() if value is not None]
        return self._of(self._case.with_settings(settings)) if settings else self

    def _rows(self) -> list[Row]:
        values = self._case.values()

        def length(key: str) -> str:
            return engineering(values[key], "m")

        def material(part: str) -> str:
            modulus = engineering(values[f"{part}.young_modulus"], "Pa")
            ratio = f"Poisson's ratio {values[f'{part}.poisson_ratio']:g}"
            if f"{part}.thickness" not in values:
                return f"{modulus}, {ratio}"
            base = values.get(f"{part}.base", "rigid")
            return f"{modulus}, {ratio}, thickness {length(f'{part}.thickness')}, base {base}"

        def shape() -> str:
            match values.get("lens.shape", "sphere"):
                case "plate":
                    return f"plate, tilt {values['lens.tilt']:g} rad"
                case "profile":
                    return f"profile {values['lens.profile']}"
                case "sphere":
                    return f"radius {length('lens.radius')}"
                case other:
                    return f"{other} of radius {length('lens.radius')}"

        rows = [
            ("lens", f"{shape()}, {material('lens')}"),
            ("substrate", material("substrate")),
            (
                "pillars",
                f"diameter {length('pattern.pillar.diameter')}, "
                f"height {length('pattern.pillar.height')}",
            ),
            (
                "lattice",
                f"pitch {length('pattern.pitch')}, "
                f"surface fraction {values['pattern.surface_fraction']:.6g}"
                + (
                    f", lens axis {values['pattern.offset']:g} pitches from a pillar"
                    if "pattern.offset" in values
                    else f", {values['pattern.lattice']}"
                ),
            ),
        ]
        if not self.floor_contact:
            rows.append(("floor", "contact ignored, also past the transition"))
        if self.adhesion is not None:
            work = f"work {1e3 * self.adhesion.work:g} mJ/m2"
            receding = self.adhesion.work_receding
            more = "" if receding is None else f", {1e3 * receding:g} mJ/m2 to part"
            floor = ", of the floor too" if self.adhesion.floor else ""
            rows.append(("adhesion", work + more + floor))
        return rows

    def _has_file(self) -> bool:
        """Whether a case file reproduces it without a further table."""
        return self._case.to_toml() == self._case.to_toml_with_table("pillars.csv")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, System) or self._case.to_toml() != other._case.to_toml():
            return False
        return self._case.listed() == other._case.listed()

    def __hash__(self) -> int:
        return hash(self._case.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        rows = self._case.listed()
        if rows is None:
            return System.from_toml, (self._case.to_toml(),)
        # The copy must not depend on the file of the pillars.
        return _with_listed, (self._case.to_toml(), rows)


def _with_listed(text: str, rows: list[list[float]]) -> System:
    return System._of(_fakir.Case.with_listed(text, rows))

