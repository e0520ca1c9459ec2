"""Contact on arbitrary surfaces with boundary elements of constant pressure (A. E. H. Love, 1929).

A lens or a plate on a height map: measured, computed, or a ``SurfaceTopography`` object. The floor is part of the surface, so
that contacts past the transition are included.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _fakir
from ._bodies import AnyLens, Lens, Substrate, check_bodies, layer_numbers, layer_options, lens_of, shape_of
from ._cycle import Adhesion, checked_plan, cycle_rows, load_step_table
from ._format import Row, engineering, remark
from ._history import Viscoelastic
from ._loading import Loading, checked_path, in_order
from ._numbers import SurfaceCycleNumbers, SurfacePressNumbers, SurfaceTransitionNumbers
from ._quantity import FloatArray, Quantity, array, finite, si
from ._run import Progress, options, warn, warn_of_interactions
from ._settings import Overrides, load, load_or_critical, overrides_of, settings
from ._state import FIELDS
from ._verification import Opinion, checked_cells
from .errors import NotConverged

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = [
    "Plate",
    "Surface",
    "SurfaceApproach",
    "SurfaceContact",
    "SurfaceCycle",
    "SurfaceTransition",
    "SurfaceVerification",
]


@dataclass(frozen=True, init=False)
class Plate:
    """A flat plate, larger than the surface and with a fixed orientation; rigid without a material."""

    young_modulus: float | None
    poisson_ratio: float | None

    def __init__(
        self, young_modulus: Quantity | None = None, poisson_ratio: Quantity | None = None
    ) -> None:
        if (young_modulus is None) != (poisson_ratio is None):
            raise TypeError("give young_modulus and poisson_ratio, or neither for a rigid plate")
        modulus = None if young_modulus is None else si(young_modulus, "pressure", "young_modulus")
        ratio = None if poisson_ratio is None else si(poisson_ratio, "number", "poisson_ratio")
        object.__setattr__(self, "young_modulus", modulus)
        object.__setattr__(self, "poisson_ratio", ratio)


def adhesion_numbers(
    adhesion: Adhesion | Quantity | None,
) -> tuple[float, float | None, bool] | None:
    """Works of adhesion (J/m^2), and whether the floor is adhesive."""
    if adhesion is None:
        return None
    given = adhesion if isinstance(adhesion, Adhesion) else Adhesion(adhesion)
    return given.work, given.work_receding, given.floor


def indenter_settings(
    indenter: AnyLens | Plate, substrate: Substrate
) -> tuple[tuple[list[tuple[str, float]], list[tuple[str, str]]] | None, list[float] | None]:
    """The numbers and words of a lens and the substrate by their keys, or the numbers of a plate."""
    check_bodies(indenter, substrate, Plate)
    if isinstance(indenter, Plate):
        if indenter.young_modulus is None or indenter.poisson_ratio is None:
            return None, None
        return None, [indenter.young_modulus, indenter.poisson_ratio]
    numbers, words = shape_of(indenter)
    known = [(key, float(number)) for key, number in numbers if number is not None]
    known += [
        ("lens.young_modulus", indenter.young_modulus),
        ("lens.poisson_ratio", indenter.poisson_ratio),
        ("substrate.young_modulus", substrate.young_modulus),
        ("substrate.poisson_ratio", substrate.poisson_ratio),
    ]
    return (known, words), None


class Surface(Viscoelastic):
    """An indenter above a height map.

    Parameters
    ----------
    heights
        Heights (m), a row for every y: ``heights[y, x]``, float64 or float32, or an array of xarray in the unit of its attribute
        ``units``; or an object with ``heights()`` and ``physical_sizes``, as in SurfaceTopography, whose arrays are ``[x, y]`` and
        which must have a ``unit``.
    indenter
        A `Lens` or a lens of another shape, or a `Plate`.
    substrate
        The elastic body under the surface, a half-space or a film.
    cell_size, width
        Side of a cell, or extent along x (m): exactly one of them, none for an object that defines its size.
    floor
        Cells at this height (m) or below are floor; needed for `transition` and for the load sharing between tops and floor.
    axis
        Position of the lens axis, in m from the centre of the map.
    periodic
        Whether the map is periodic; by default as defined by the object, otherwise not.
    adhesion
        An `Adhesion`, or the work of adhesion (J/m^2), of the whole map; of a floor only with ``Adhesion(..., floor=True)``. Cells must
        be square.
    floor_contact
        Whether the floor carries load where the indenter reaches it.
    """

    indenter: AnyLens | Plate
    substrate: Substrate
    periodic: bool
    adhesion: Adhesion | None
    x: FloatArray
    """Centres of the cells along x, m from the lens axis."""
    y: FloatArray
    """The same along y."""
    heights: FloatArray
    """Heights, m, a row for every y."""
    _arguments: tuple[Any, ...]

    def __init__(
        self,
        heights: object,
        indenter: AnyLens | Plate,
        substrate: Substrate,
        *,
        cell_size: Quantity | None = None,
        width: Quantity | None = None,
        floor: Quantity | None = None,
        axis: tuple[Quantity, Quantity] = (0.0, 0.0),
        periodic: bool | None = None,
        adhesion: Adhesion | Quantity | None = None,
        floor_contact: bool = True,
    ) -> None:
        if floor is None and not floor_contact:
            raise ValueError("which cells are floor is not known, so that they cannot be ignored: give floor, a height")
        if callable(getattr(heights, "heights", None)) and hasattr(heights, "physical_sizes"):
            if cell_size is not None or width is not None:
                raise TypeError("the topography has its size: leave out cell_size and width")
            if periodic is None:
                periodic = bool(getattr(heights, "is_periodic", False))
            values, cell = _of_topography(heights)
        else:
            values, cell = _of_array(heights, cell_size, width)
        rows, columns = values.shape
        centre = [finite(place, "length", "axis") for place in axis]
        origin = [-0.5 * columns * cell[0] - centre[0], -0.5 * rows * cell[1] - centre[1]]
        self._arguments = (
            values,
            cell,
            origin,
            *indenter_settings(indenter, substrate),
            [substrate.young_modulus, substrate.poisson_ratio],
            [layer_numbers(substrate), layer_numbers(indenter)],
            bool(periodic),
            None if floor is None else (finite(floor, "length", "floor"), bool(floor_contact)),
            adhesion_numbers(adhesion),
        )
        self._hold(_fakir.Surface(*self._arguments))

    @classmethod
    def _of(cls, surface: _fakir.Surface) -> Surface:
        made = cls.__new__(cls)
        made._hold(surface)
        return made

    @classmethod
    def from_file(
        cls,
        path: str | PathLike[str],
        overrides: Overrides | None = None,
        *,
        memory_limit: int | None = None,
        set: Overrides | None = None,
    ) -> Surface:
        """Reads a case file with a ``[surface]``; ``overrides`` contains values of keys, as ``--set`` of the command line, and
        ``set`` is its deprecated name. ``memory_limit`` is in bytes; 8 GB if not given."""
        given = settings(overrides_of(overrides, set))
        return cls._of(_fakir.Surface.read(fspath(path), given, memory_limit))

    @classmethod
    def from_toml(
        cls,
        text: str,
        overrides: Overrides | None = None,
        *,
        memory_limit: int | None = None,
        set: Overrides | None = None,
    ) -> Surface:
        """As `from_file`, from the text of a case file."""
        given = settings(overrides_of(overrides, set))
        return cls._of(_fakir.Surface.parse("case.toml", text, given, memory_limit))

    def to_toml(self) -> str:
        """The case as a commented file, for a surface from a case file; a height map is given by its absolute path."""
        text = self._surface.to_toml()
        if text is None:
            raise ValueError(
                "a surface made of an array has no case file: save the array (numpy.save) and name it in "
                "one, as surface.height_map"
            )
        return text

    def __reduce__(self) -> tuple[Any, ...]:
        text = self._surface.to_toml()
        return (_of_arguments, self._arguments) if text is None else (Surface.from_toml, (text,))

    def _problem(self) -> _fakir.Surface:
        return self._surface

    def _hold(self, surface: _fakir.Surface) -> None:
        self._surface, self.periodic = surface, surface.periodic
        film, of_lens = (layer_options(layer) for layer in surface.layers)
        values = surface.lens
        if values is None:
            self.indenter = Plate(*(surface.plate or []))
        else:
            self.indenter = lens_of(values, of_lens)
        self.substrate = Substrate(*surface.substrate, **film)
        given = surface.adhesion
        self.adhesion = None if given is None else Adhesion(given[0], given[1], floor=given[2])
        self.heights = surface.heights()
        rows, columns = self.heights.shape
        self.x = surface.origin[0] + surface.cell[0] * (np.arange(columns, dtype=np.float64) + 0.5)
        self.y = surface.origin[1] + surface.cell[1] * (np.arange(rows, dtype=np.float64) + 0.5)

    def press(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> SurfaceContact:
        """Computes the contact at an indentation (m) or under a force (N): exactly one of them.

        The indentation is zero where the indenter is level with the highest point of the surface; on a periodic surface it is
        relative to the mean displacement.
        """
        run = options(threads, progress, memory_limit)
        contact = _fakir.press_surface(self._surface, *load(indentation, force), run)
        return _checked(SurfaceContact(self, contact))

    def transition(
        self,
        *,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> SurfaceTransition:
        """Computes the state in which the indenter just reaches the floor."""
        run = options(threads, progress, memory_limit)
        found = _fakir.surface_transition(self._surface, run)
        return self._reached(found)

    def approach(
        self,
        step: Quantity = "1 um",
        until: Quantity | None = None,
        past_transition: bool = False,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> SurfaceApproach:
        """Computes a loading in steps from first contact, up to the critical state or beyond.

        Parameters
        ----------
        step
            Step of the indentation (m).
        until
            The last indentation (m), unless the critical state is reached earlier.
        to
            The last indentation (m), before the critical state or past it, where the floor carries part of the load.
        to_force
            The force (N) at the end of the loading, before the critical state or past it.
        past_transition
            Deprecated: makes ``until`` equivalent to ``to``.

        An end is required if the surface defines no floor.
        """
        path = checked_path(step, until, past_transition, to, to_force)
        run = options(threads, progress, memory_limit)
        found, reached, others = _fakir.approach_surface(self._surface, *path, run)
        summary = json.loads(found)
        critical = None if reached is None else self._reached(reached)
        rest = (_checked(SurfaceContact(self, contact)) for contact in others)
        first = None if critical is None else critical.contact
        return SurfaceApproach(summary, in_order(summary, first, rest), critical)

    def cycle(
        self,
        *,
        to: Quantity | None = None,
        to_force: Quantity | None = None,
        retract: bool = True,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> SurfaceCycle:
        """Computes loading and unloading with adhesion at a controlled indentation.

        Loading ends at an indentation (m), at a force (N), or, on a surface with a floor, at the critical state.
        """
        length, force, *_ = checked_plan(to, to_force, "displacement", None, retract)
        run = options(threads, progress, memory_limit)
        found = _fakir.cycle_surface(self._surface, length, force, retract, run)
        warn(found[0].warnings)
        return self._cycle(found)

    def _cycle(self, found: tuple[Any, ...]) -> SurfaceCycle:
        """A cycle on this surface."""
        answer, curve, turn, pull_off = found
        strongest = None if pull_off is None else SurfaceContact(self, pull_off)
        return SurfaceCycle(answer, curve, SurfaceContact(self, turn), strongest)

    def verify(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        cells_per_diameter: int = 16,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> SurfaceVerification:
        """Solves the same problem on two meshes: with ``cells_per_diameter`` cells across a pillar, and with half as many.

        The problem is the critical state, or the contact under a load if one is given. The surface must consist of pillars on a
        lattice given by a case file: height maps are defined on their own cells only, and random pillars have different positions
        on other cells.
        """
        question = load_or_critical(indentation, force)
        checked_cells(cells_per_diameter)
        run = options(threads, progress, memory_limit)
        warn_of_interactions(self._surface, "verify", depth=1)
        summary, found = _fakir.verify_surface(self._surface, *question, cells_per_diameter, run)
        contacts = [SurfaceContact(Surface._of(surface), contact) for surface, contact in found]
        return SurfaceVerification(json.loads(summary), contacts)

    def _reached(self, found: _fakir.SurfaceTransition) -> SurfaceTransition:
        return SurfaceTransition(_checked(SurfaceContact(self, found.contact)), found)

    def __repr__(self) -> str:
        rows, columns = self.heights.shape
        around = "periodic" if self.periodic else "free"
        return f"fakir.bem.Surface: {columns} by {rows} cells, {around}, under a {self.indenter}"


def _of_arguments(*arguments: Any) -> Surface:
    """A surface of an array that was sent from another process."""
    made = Surface._of(_fakir.Surface(*arguments))
    made._arguments = arguments
    return made


class SurfaceContact(SurfacePressNumbers):
    """The contact of an indenter with a height map. Numbers are in SI units."""

    _titles = ("fakir.bem.SurfaceContact", "Contact on a height map")

    surface: Surface
    """The problem."""
    pressure_map: FloatArray
    """Pressure on every cell, Pa, a row for every y."""
    gap_map: FloatArray
    """Gap above every cell, m; infinite beyond the equator of a lens."""
    displacement_map: FloatArray
    """Separation of the two surfaces by the pressure, m."""

    def __init__(self, surface: Surface, contact: _fakir.SurfaceContact) -> None:
        super().__init__(contact)
        self.surface, self._contact = surface, contact
        self.pressure_map, self.gap_map, self.displacement_map = contact.fields()

    @property
    def periodic(self) -> bool:
        """Whether the surface is periodic."""
        return self.surface.periodic

    @property
    def mean_pressure(self) -> float:
        """Force divided by the area of the map, Pa."""
        return self._contact.mean_pressure

    def to_xarray(self) -> xarray.Dataset:
        """Pressure, gap, displacement and heights on the cells, with units."""
        import xarray

        fields = {
            "pressure": self.pressure_map,
            "gap": self.gap_map,
            "displacement": self.displacement_map,
        }
        variables: dict[str, Any] = {
            name: (("y", "x"), fields[name], {"units": unit, "long_name": text})
            for name, (unit, text) in FIELDS.items()
        }
        height = {"units": "m", "long_name": "height of the surface"}
        variables["height"] = (("y", "x"), self.surface.heights, height)
        coordinates = {
            "x": ("x", self.surface.x, {"units": "m"}),
            "y": ("y", self.surface.y, {"units": "m"}),
        }
        attributes = {
            "source": f"fakir {_fakir.__version__}",
            "method": "boundary elements",
            "force_N": self.force,
            "indentation_m": self.indentation,
        }
        return xarray.Dataset(variables, coordinates, attributes)

    def _rows(self) -> list[Row]:
        error = self.error
        of_area = "" if error is None else remark(error.contact_area or 0.0)
        rows = [
            ("force", engineering(self.force, "N")),
            ("indentation", engineering(self.indentation, "m")),
            ("contact area", f"{self.contact_area * 1e12:.5g} µm²{of_area}"),
            ("mean pressure", engineering(self.mean_pressure, "Pa", 5)),
        ]
        for name, share in [("tops", self.tops), ("floor", self.floor)]:
            if share is not None:
                force, area = engineering(share.force, "N"), share.contact_area * 1e12
                rows.append((f"  on the {name}", f"{force} on {area:.5g} µm²"))
        if error is not None:
            rows.append(("estimated error", f"{max(error.force, error.indentation):.0e}"))
        return [*rows, ("solution", f"boundary elements, {self.termination}")]


class SurfaceTransition(SurfaceTransitionNumbers):
    """The state in which the indenter just reaches the floor. Numbers are in SI units."""

    _titles = ("fakir.bem.SurfaceTransition", "Critical state on a height map")

    contact: SurfaceContact
    """The contact."""

    def __init__(self, contact: SurfaceContact, found: _fakir.SurfaceTransition) -> None:
        super().__init__(found)
        self.contact = contact

    def _rows(self) -> list[Row]:
        x, y = self.floor_contact
        first = "tops" if self.regime == "top_first" else "the floor, without force"
        at = f"({engineering(x, 'm', 4)}, {engineering(y, 'm', 4)})"
        return [("meets first", first), ("floor contact at", at), *self.contact._rows()]


class SurfaceCycle(SurfaceCycleNumbers):
    """Loading and unloading with adhesion. Numbers are in SI units; arrays have one value for every load step."""

    _titles = ("fakir.bem.SurfaceCycle", "Loading and unloading with adhesion")

    branch: list[str]
    """``"loading"`` or ``"unloading"`` of every load step."""
    indentation: FloatArray
    """Indentation at every load step, m."""
    force: FloatArray
    """Force at every load step, N; negative in tension."""
    contact_area: FloatArray
    """Contact area at every load step, m^2."""
    turn: SurfaceContact
    """The contact at the end of loading."""
    pull_off: SurfaceContact | None
    """The contact with the largest tensile force of the unloading; None without unloading or without tension."""

    def __init__(
        self,
        answer: _fakir.Answer,
        curve: list[tuple[str, float, float, float]],
        turn: SurfaceContact,
        pull_off: SurfaceContact | None,
    ) -> None:
        super().__init__(answer)
        branch, *numbers = zip(*curve)
        self.branch = list(branch)
        self.indentation, self.force, self.contact_area = (np.array(it) for it in numbers)
        self.turn, self.pull_off = turn, pull_off

    def to_pandas(self) -> pandas.DataFrame:
        """A table, one row for every load step: the columns of ``cycle.csv``."""
        return load_step_table(self, contact_area_m2=self.contact_area)

    def _rows(self) -> list[Row]:
        return cycle_rows(self)


class SurfaceApproach(Loading[SurfaceContact]):
    """The states of a loading on a height map, by increasing indentation; iterable."""

    _titles = ("fakir.bem.SurfaceApproach: indentation, force", "Approach on a height map: indentation, force")

    critical: SurfaceTransition | None
    """The critical state, even if the loading ends before it; None if the surface defines no floor."""

    def __init__(
        self,
        summary: dict[str, Any],
        states: list[SurfaceContact],
        critical: SurfaceTransition | None,
    ) -> None:
        super().__init__(summary, states)
        self.critical = critical

    def _rows(self) -> list[Row]:
        rows = []
        for state, row in zip(self.states, self._summary["states"]):
            mark = ", critical" if row["critical"] else ""
            area = f"{state.contact_area * 1e12:.5g} µm²"
            text = f"{engineering(state.force, 'N')} on {area}{mark}"
            rows.append((engineering(state.indentation, "m"), text))
        return rows


class SurfaceVerification(Opinion):
    """The results on both meshes, and their differences."""

    _titles = ("fakir.bem.SurfaceVerification", "Verification on two meshes")

    elements: tuple[SurfaceContact, SurfaceContact]
    """Results with half as many cells across a pillar, and with all of them."""

    def __init__(self, summary: dict[str, Any], contacts: list[SurfaceContact]) -> None:
        super().__init__(summary)
        coarse, fine = contacts
        self.elements = coarse, fine

    def _rows(self) -> list[Row]:
        return self._rows_of([("coarse", self.elements[0]), ("fine", self.elements[1])])


def _checked(contact: SurfaceContact) -> SurfaceContact:
    warn(contact.warnings)
    if not contact.converged:
        raise NotConverged(f"the solution {contact.termination}", contact)
    return contact


def _unit_of_attributes(heights: object) -> float:
    """The unit (m) in the attributes of an array of xarray; 1 if there is none."""
    attributes = getattr(heights, "attrs", None)
    unit = attributes.get("units") if isinstance(attributes, dict) else None
    return 1.0 if unit is None else _fakir.parse_quantity(f"1 {unit}", "length")


def _of_array(
    heights: object, cell_size: Quantity | None, width: Quantity | None
) -> tuple[FloatArray, list[float]]:
    values = array(heights, "length", "heights")
    unit = _unit_of_attributes(heights)
    if unit != 1.0:
        values = values * unit
    if values.ndim != 2 or values.size == 0:
        raise ValueError(
            f"heights has the shape {values.shape}: give a map, an array with a row for every y"
        )
    if (cell_size is None) == (width is None):
        raise TypeError("give exactly one of cell_size and width")
    if cell_size is not None:
        size = finite(cell_size, "length", "cell_size")
    else:
        assert width is not None
        size = finite(width, "length", "width") / values.shape[1]
    if size <= 0.0:
        raise ValueError(f"cells of {size} m: their side must be greater than 0")
    return values, [size, size]


def _of_topography(topography: Any) -> tuple[FloatArray, list[float]]:
    """Heights and cells of an object of SurfaceTopography."""
    unit = getattr(topography, "unit", None)
    if unit is None:
        raise ValueError('the topography has no unit: create it with one, as SurfaceTopography.Topography(..., unit="um")')
    scale = _fakir.parse_quantity(f"1 {unit}", "length")
    raw = topography.heights()
    if np.ma.is_masked(raw):
        raise ValueError(
            "heights are missing in places: fill them in first, as topography.interpolate_undefined_data()"
        )
    values = array(raw, "length", "heights")
    sizes = [float(size) * scale for size in topography.physical_sizes]
    if values.ndim != 2 or len(sizes) != 2:
        raise ValueError(
            f"a topography of shape {values.shape}: give a map, of two dimensions"
        )
    across, along = values.shape
    turned = np.ascontiguousarray(values.T) * scale
    return turned, [sizes[0] / across, sizes[1] / along]
