"""Lenses, substrates and pillar patterns."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any, ClassVar, Literal, TypedDict, Unpack

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from ._quantity import Quantity, WithUnit, si, whole, without_mask, without_unit

_FORMER_OPTIONS = {"height_spread": "height_standard_deviation", "missing": "vacancy_fraction"}
"""Deprecated names of options, with the present ones."""


def _warn_of_former(name: str) -> None:
    """Warns the caller of the calling function that an option or an attribute was used by its deprecated name."""
    warnings.warn(f"{name} is now called {_FORMER_OPTIONS[name]}", FutureWarning, stacklevel=3)


def _lengths(values: object, name: str) -> npt.NDArray[np.float64]:
    """Lengths of pillars, m; NaN where a pillar has the common one."""
    if isinstance(values, WithUnit):
        values = without_unit(values, "length", name)
    elif isinstance(values, str):
        values = si(values, "length", name)
    return np.asarray(without_mask(values), dtype=float)


def _set_material(body: object, keys: str, young_modulus: Quantity, poisson_ratio: Quantity) -> None:
    """Sets both numbers of an elastic body, whose keys in a case file have this prefix."""
    modulus = si(young_modulus, "pressure", f"{keys}young_modulus")
    object.__setattr__(body, "young_modulus", modulus)
    ratio = si(poisson_ratio, "number", f"{keys}poisson_ratio")
    object.__setattr__(body, "poisson_ratio", ratio)


@dataclass(frozen=True, init=False)
class ElasticBase:
    """An elastic half-space to which a lens or a substrate of finite thickness is bonded.

    Parameters
    ----------
    young_modulus
        Young's modulus (Pa).
    poisson_ratio
        Poisson's ratio, from 0 to 0.5.
    """

    young_modulus: float
    poisson_ratio: float

    def __init__(self, young_modulus: Quantity, poisson_ratio: Quantity) -> None:
        _set_material(self, "substrate.base_", young_modulus, poisson_ratio)


Base = Literal["rigid", "frictionless"] | ElasticBase


class LayerOptions(TypedDict, total=False):
    """Options of lenses and the substrate for bodies that are not half-spaces."""

    thickness: Quantity | None
    """Thickness of the body as a flat layer (m); without it the body is a half-space. Indentations are then the approach of the
    backs."""
    base: Base
    """Condition at its back: bonded to ``"rigid"`` or an `ElasticBase`, or ``"frictionless"`` on a rigid base."""


def _check_names(made: object, options: Iterable[str], known: Iterable[str]) -> None:
    """Refuses the names of arguments that a class does not have."""
    own = [name for name in inspect.signature(type(made)).parameters if name != "options"]
    names = [*own, *(name for name in known if name not in _FORMER_OPTIONS)]
    for name in options:
        if name not in known:
            raise TypeError(f"{type(made).__name__} takes no {name}: it takes {', '.join(names)}")


@dataclass(frozen=True, init=False)
class _Body:
    """Common base of lenses and substrates: their thickness."""

    thickness: float | None = field(kw_only=True)
    base: Base = field(kw_only=True)

    def _set_layer(self, part: str, options: LayerOptions) -> None:
        known = LayerOptions.__annotations__
        _check_names(self, options, known)
        thickness = options.get("thickness")
        base = options.get("base", "rigid")
        if thickness is None and "base" in options and base != "rigid":
            raise TypeError(f"a {part} has a base where it has a thickness: give that too")
        if not isinstance(base, ElasticBase) and base not in ("rigid", "frictionless"):
            raise ValueError(
                f'{part}.base cannot be {base!r}: give "rigid", "frictionless" or an ElasticBase'
            )
        length = None if thickness is None else si(thickness, "length", f"{part}.thickness")
        object.__setattr__(self, "thickness", length)
        object.__setattr__(self, "base", base)

    def _layer(self, part: str) -> tuple[list[tuple[str, float | None]], list[tuple[str, str]]]:
        """The numbers and words of a layer by their keys."""
        if self.thickness is None:
            return [], []
        numbers: list[tuple[str, float | None]] = [(f"{part}.thickness", self.thickness)]
        match self.base:
            case ElasticBase() as base:
                numbers.append((f"{part}.base_young_modulus", base.young_modulus))
                numbers.append((f"{part}.base_poisson_ratio", base.poisson_ratio))
                return numbers, [(f"{part}.base", "elastic")]
            case word:
                return numbers, [(f"{part}.base", word)]


def layer_of(values: Mapping[str, Any], part: str) -> LayerOptions:
    """The layer options of a body of a case, if it is a layer."""
    thickness = values.get(f"{part}.thickness")
    if thickness is None:
        return {}
    match values.get(f"{part}.base", "rigid"):
        case "elastic":
            modulus = values[f"{part}.base_young_modulus"]
            base = ElasticBase(modulus, values[f"{part}.base_poisson_ratio"])
            return {"thickness": thickness, "base": base}
        case "frictionless":
            return {"thickness": thickness, "base": "frictionless"}
    return {"thickness": thickness}


LayerNumbers = tuple[float, str, list[float] | None]


def layer_numbers(body: object) -> LayerNumbers | None:
    """Thickness, base, and modulus and Poisson's ratio of an elastic base; None for a half-space."""
    if not isinstance(body, _Body) or body.thickness is None:
        return None
    match body.base:
        case ElasticBase() as base:
            return body.thickness, "elastic", [base.young_modulus, base.poisson_ratio]
        case word:
            return body.thickness, word, None


def layer_options(layer: LayerNumbers | None) -> LayerOptions:
    """The options of a body from these numbers."""
    match layer:
        case None:
            return {}
        case (thickness, "elastic", [modulus, ratio]):
            return {"thickness": thickness, "base": ElasticBase(modulus, ratio)}
        case (thickness, "frictionless", _):
            return {"thickness": thickness, "base": "frictionless"}
        case (thickness, *_):
            return {"thickness": thickness}


@dataclass(frozen=True, init=False)
class RoundLens(_Body):
    """Common base of lenses with a radius."""

    radius: float
    young_modulus: float
    poisson_ratio: float

    def __init__(
        self,
        radius: Quantity,
        young_modulus: Quantity,
        poisson_ratio: Quantity,
        **options: Unpack[LayerOptions],
    ) -> None:
        self._set_layer("lens", options)
        object.__setattr__(self, "radius", si(radius, "length", "lens.radius"))
        _set_material(self, "lens.", young_modulus, poisson_ratio)


@dataclass(frozen=True, init=False)
class Lens(RoundLens):
    """A spherical lens.

    Parameters
    ----------
    radius
        Radius of curvature: a number in m, a string such as ``"2.2 mm"``, or a pint quantity.
    young_modulus
        Young's modulus (Pa).
    poisson_ratio
        Poisson's ratio, from 0 to 0.5.
    **options
        `LayerOptions` of all lenses: ``thickness``, ``base``.
    """


@dataclass(frozen=True, init=False)
class ParaboloidLens(RoundLens):
    """A lens of height r^2/(2R) above its lowest point; parameters as `Lens`.

    Lenses of all shapes are supported by the methods ``"spectral"`` and ``"love"``.
    """


@dataclass(frozen=True, init=False)
class CylinderLens(RoundLens):
    """A cylinder with a horizontal axis, above finitely many pillars.

    Parameters
    ----------
    radius, young_modulus, poisson_ratio
        As for a `Lens`.
    angle
        Direction of its lowest line relative to x (rad, or a string such as ``"30 deg"``).

    Examples
    --------
    >>> pattern = fakir.SquarePattern("6 um", "2.2 um", pitch="20 um", columns=9)
    >>> rubber = fakir.Substrate("2 MPa", 0.5)
    >>> system = fakir.System(fakir.CylinderLens("2.2 mm", "2 MPa", 0.5, angle="90 deg"), rubber, pattern)
    >>> len(system.press(indentation="0.2 um").pillars)
    27
    """

    angle: float

    def __init__(
        self,
        radius: Quantity,
        young_modulus: Quantity,
        poisson_ratio: Quantity,
        *,
        angle: Quantity = 0.0,
        **options: Unpack[LayerOptions],
    ) -> None:
        super().__init__(radius, young_modulus, poisson_ratio, **options)
        object.__setattr__(self, "angle", si(angle, "angle", "lens.angle"))


@dataclass(frozen=True, init=False)
class PlateLens(_Body):
    """A flat plate with a fixed orientation that extends beyond all of finitely many pillars.

    Parameters
    ----------
    young_modulus, poisson_ratio
        As for a `Lens`.
    tilt
        Angle between the plate and the floor (rad, or a string such as ``"0.1 deg"``), up to 10 degrees. Indentations are those
        at the origin, the position of the lens axis.
    tilt_direction
        Direction in which the plate rises, relative to x (rad).
    """

    young_modulus: float
    poisson_ratio: float
    tilt: float
    tilt_direction: float

    def __init__(
        self,
        young_modulus: Quantity,
        poisson_ratio: Quantity,
        *,
        tilt: Quantity = 0.0,
        tilt_direction: Quantity = 0.0,
        **options: Unpack[LayerOptions],
    ) -> None:
        self._set_layer("lens", options)
        _set_material(self, "lens.", young_modulus, poisson_ratio)
        object.__setattr__(self, "tilt", si(tilt, "angle", "lens.tilt"))
        direction = si(tilt_direction, "angle", "lens.tilt_direction")
        object.__setattr__(self, "tilt_direction", direction)


@dataclass(frozen=True, init=False)
class ProfileLens(_Body):
    """An axisymmetric lens of any smooth, rising shape, given by a table of its heights.

    Parameters
    ----------
    profile
        A file with the columns ``radius_m`` and ``height_m``, from the axis outwards. It must extend beyond every contact.
    young_modulus, poisson_ratio
        As for a `Lens`.
    """

    profile: str
    young_modulus: float
    poisson_ratio: float

    def __init__(
        self,
        profile: str | PathLike[str],
        young_modulus: Quantity,
        poisson_ratio: Quantity,
        **options: Unpack[LayerOptions],
    ) -> None:
        self._set_layer("lens", options)
        object.__setattr__(self, "profile", str(Path(fspath(profile)).absolute()))
        _set_material(self, "lens.", young_modulus, poisson_ratio)


@dataclass(frozen=True, init=False)
class FlatPunch(RoundLens):
    """A punch with a flat circular end. On pillars its edge must not cross any of them; a `bem.Surface` may have any under it.

    Parameters
    ----------
    radius
        Radius of the end (m).
    young_modulus, poisson_ratio
        As for a `Lens`.
    """


AnyLens = Lens | ParaboloidLens | CylinderLens | PlateLens | ProfileLens | FlatPunch


def lens_of(values: Mapping[str, Any], layer: LayerOptions | None = None) -> Any:
    """The lens of a case with these values; with these layer options instead of those of the case."""
    modulus, ratio = values["lens.young_modulus"], values["lens.poisson_ratio"]
    layer = layer_of(values, "lens") if layer is None else layer
    match values.get("lens.shape", "sphere"):
        case "paraboloid":
            return ParaboloidLens(values["lens.radius"], modulus, ratio, **layer)
        case "cylinder":
            angle = values["lens.angle"]
            return CylinderLens(values["lens.radius"], modulus, ratio, angle=angle, **layer)
        case "plate":
            tilt, direction = values["lens.tilt"], values["lens.tilt_direction"]
            return PlateLens(modulus, ratio, tilt=tilt, tilt_direction=direction, **layer)
        case "profile":
            return ProfileLens(values["lens.profile"], modulus, ratio, **layer)
        case "punch":
            return FlatPunch(values["lens.radius"], modulus, ratio, **layer)
    return Lens(values["lens.radius"], modulus, ratio, **layer)


def substrate_of(values: Mapping[str, Any]) -> Substrate:
    """The substrate of a case with these values."""
    modulus, ratio = values["substrate.young_modulus"], values["substrate.poisson_ratio"]
    return Substrate(modulus, ratio, **layer_of(values, "substrate"))


def check_bodies(indenter: object, substrate: object, *others: type) -> None:
    """Raises an error unless these are a lens, or an indenter of another type, and a substrate."""
    if not isinstance(indenter, (AnyLens, *others)):
        kinds = " or ".join(["a lens", *(f"a {other.__name__}" for other in others)])
        raise TypeError(f"the indenter is of type {type(indenter).__name__}: give {kinds}")
    if not isinstance(substrate, Substrate):
        raise TypeError(f"substrate is of type {type(substrate).__name__}: give a Substrate")


def shape_of(lens: AnyLens) -> tuple[list[tuple[str, float | None]], list[tuple[str, str]]]:
    """The numbers and words of a lens by their keys, except those of its material."""
    numbers: list[tuple[str, float | None]]
    match lens:
        case ParaboloidLens():
            return [("lens.radius", lens.radius)], [("lens.shape", "paraboloid")]
        case FlatPunch():
            return [("lens.radius", lens.radius)], [("lens.shape", "punch")]
        case CylinderLens():
            numbers = [("lens.radius", lens.radius), ("lens.angle", lens.angle)]
            return numbers, [("lens.shape", "cylinder")]
        case PlateLens():
            numbers = [("lens.tilt", lens.tilt), ("lens.tilt_direction", lens.tilt_direction)]
            return numbers, [("lens.shape", "plate")]
        case ProfileLens():
            return [], [("lens.shape", "profile"), ("lens.profile", lens.profile)]
        case Lens():
            return [("lens.radius", lens.radius)], []


@dataclass(frozen=True, init=False)
class Substrate(_Body):
    """The elastic body that the pillars belong to: a half-space, or a film of finite thickness.

    Parameters
    ----------
    young_modulus
        Young's modulus (Pa).
    poisson_ratio
        Poisson's ratio, from 0 to 0.5.
    **options
        `LayerOptions`: ``thickness``, ``base``.

    Examples
    --------
    >>> film = fakir.Substrate("2 MPa", 0.5, thickness="0.2 mm")
    >>> pattern = fakir.HexagonalPattern("6 um", "2.2 um", surface_fraction=0.1)
    >>> system = fakir.System(fakir.Lens("2.2 mm", "2 MPa", 0.5), film, pattern)
    >>> round(1e6 * system.transition().indentation, 3)
    10.566
    """

    young_modulus: float
    poisson_ratio: float

    def __init__(
        self, young_modulus: Quantity, poisson_ratio: Quantity, **options: Unpack[LayerOptions]
    ) -> None:
        self._set_layer("substrate", options)
        _set_material(self, "substrate.", young_modulus, poisson_ratio)


@dataclass(frozen=True, init=False)
class LatticePattern:
    """Common base of pillar patterns on lattices."""

    diameter: float
    height: float
    pitch: float | None
    surface_fraction: float | None
    offset: float
    offset_angle: float
    rotation: float
    columns: int | None
    height_standard_deviation: float
    vacancy_fraction: float
    seed: int
    compliance: Literal["column", "elastic", "none"]

    _lattice: ClassVar[str]

    def _common(
        self,
        diameter: Quantity,
        height: Quantity,
        pitch: Quantity | None,
        surface_fraction: Quantity | None,
        options: LatticeOptions,
    ) -> None:
        known = LatticeOptions.__annotations__
        given: dict[str, Any] = {}
        _check_names(self, options, known)
        for name, value in options.items():
            present = _FORMER_OPTIONS.get(name, name)
            if present != name:
                if present in options:
                    raise TypeError(f"{name} is the older name of {present}: give only {present}")
                warnings.warn(f"{name} is now called {present}", FutureWarning, stacklevel=3)
            given[present] = value
        if (pitch is None) == (surface_fraction is None):
            raise TypeError("give exactly one of pitch and surface_fraction")

        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("diameter", si(diameter, "length", "pattern.pillar.diameter"))
        put("height", si(height, "length", "pattern.pillar.height"))
        put("pitch", None if pitch is None else si(pitch, "length", "pattern.pitch"))
        fraction = surface_fraction
        put(
            "surface_fraction",
            None if fraction is None else si(fraction, "fraction", "pattern.surface_fraction"),
        )
        put("offset", si(given.get("offset", 0.0), "number", "pattern.offset"))
        put("offset_angle", si(given.get("offset_angle", 0.0), "angle", "pattern.offset_angle"))
        put("rotation", si(given.get("rotation", 0.0), "angle", "pattern.rotation"))
        columns = given.get("columns")
        put("columns", None if columns is None else whole(columns, "pattern.columns"))
        for name in ("height_standard_deviation", "vacancy_fraction"):
            put(name, si(given.get(name, 0.0), "fraction", f"pattern.{name}"))
        put("seed", whole(given.get("seed", 0), "pattern.seed"))
        put("compliance", given.get("compliance", "column"))

    @property
    def height_spread(self) -> float:
        """Deprecated name of ``height_standard_deviation``."""
        _warn_of_former("height_spread")
        return self.height_standard_deviation

    @property
    def missing(self) -> float:
        """Deprecated name of ``vacancy_fraction``."""
        _warn_of_former("missing")
        return self.vacancy_fraction

    def _numbers(self) -> list[tuple[str, float | None]]:
        return [
            ("pattern.pillar.diameter", self.diameter),
            ("pattern.pillar.height", self.height),
            ("pattern.pitch", self.pitch),
            ("pattern.surface_fraction", self.surface_fraction),
            ("pattern.offset", self.offset),
            ("pattern.offset_angle", self.offset_angle),
            ("pattern.rotation", self.rotation),
            ("pattern.columns", self.columns),
            ("pattern.height_standard_deviation", self.height_standard_deviation),
            ("pattern.vacancy_fraction", self.vacancy_fraction),
            ("pattern.seed", self.seed),
        ]


class LatticeOptions(TypedDict, total=False):
    """Options of every pillar pattern on a lattice besides its pillars and its pitch."""

    offset: Quantity
    """Distance of the lens axis from a pillar centre, in pitches."""
    offset_angle: Quantity
    """Direction of the offset relative to x (rad, or a string such as ``"30 deg"``)."""
    rotation: Quantity
    """Rotation of the lattice about the lens axis, anticlockwise (rad)."""
    columns: int | None
    """Number of pillars along each side of a finite lattice; without it the lattice is infinite."""
    height_standard_deviation: Quantity
    """Standard deviation of the individual pillar heights relative to the height, up to 0.2."""
    height_spread: Quantity
    """Deprecated name of ``height_standard_deviation``."""
    vacancy_fraction: Quantity
    """Probability that a pillar is missing."""
    missing: Quantity
    """Deprecated name of ``vacancy_fraction``."""
    seed: int
    """Integer seed of the random heights and missing pillars."""
    compliance: Literal["column", "elastic", "none"]
    """``"column"`` if pillars shorten under load, ``"elastic"`` if they are elastic bodies, ``"none"`` if they are rigid."""


class HexagonalPattern(LatticePattern):
    """Cylindrical pillars on a hexagonal lattice.

    Parameters
    ----------
    diameter, height
        Diameter and height of the pillars (m).
    pitch, surface_fraction
        Distance between neighbouring pillars (m), or the fraction of the surface covered by pillar tops: exactly one of them.
    **options
        `LatticeOptions`: ``offset``, ``offset_angle``, ``rotation``, ``columns``, ``height_standard_deviation``,
        ``vacancy_fraction``, ``seed``, ``compliance``. The paper's pattern has none of ``rotation`` to ``seed``; all methods,
        floor contact and adhesion support that pattern.
    """

    _lattice = "hexagonal"

    def __init__(
        self,
        diameter: Quantity,
        height: Quantity,
        *,
        pitch: Quantity | None = None,
        surface_fraction: Quantity | None = None,
        **options: Unpack[LatticeOptions],
    ) -> None:
        self._common(diameter, height, pitch, surface_fraction, options)


class SquarePattern(LatticePattern):
    """Cylindrical pillars on a square lattice with its rows along x and y; parameters as `HexagonalPattern`.

    >>> pattern = fakir.SquarePattern("6 um", "2.2 um", surface_fraction=0.03)
    >>> system = fakir.System(fakir.Lens("2.2 mm", "1.5 MPa", 0.5), fakir.Substrate("1.5 MPa", 0.5), pattern)
    >>> round(1e6 * system.transition().force)
    285
    """

    _lattice = "square"

    def __init__(
        self,
        diameter: Quantity,
        height: Quantity,
        *,
        pitch: Quantity | None = None,
        surface_fraction: Quantity | None = None,
        **options: Unpack[LatticeOptions],
    ) -> None:
        self._common(diameter, height, pitch, surface_fraction, options)


@dataclass(frozen=True, init=False)
class RectangularPattern(LatticePattern):
    """Cylindrical pillars on a rectangular lattice: ``pitch`` along x, ``pitch_y`` along y (m)."""

    pitch_y: float

    _lattice = "rectangular"

    def __init__(
        self,
        diameter: Quantity,
        height: Quantity,
        *,
        pitch: Quantity,
        pitch_y: Quantity,
        **options: Unpack[LatticeOptions],
    ) -> None:
        self._common(diameter, height, pitch, None, options)
        object.__setattr__(self, "pitch_y", si(pitch_y, "length", "pattern.pitch_y"))

    def _numbers(self) -> list[tuple[str, float | None]]:
        return [*super()._numbers(), ("pattern.pitch_y", self.pitch_y)]


@dataclass(frozen=True, init=False)
class ObliquePattern(LatticePattern):
    """Cylindrical pillars on an oblique lattice: ``pitch`` along x, ``pitch_y`` (m) along rows at ``angle`` (rad) to x."""

    pitch_y: float
    angle: float

    _lattice = "oblique"

    def __init__(
        self,
        diameter: Quantity,
        height: Quantity,
        *,
        pitch: Quantity,
        pitch_y: Quantity,
        angle: Quantity,
        **options: Unpack[LatticeOptions],
    ) -> None:
        self._common(diameter, height, pitch, None, options)
        object.__setattr__(self, "pitch_y", si(pitch_y, "length", "pattern.pitch_y"))
        object.__setattr__(self, "angle", si(angle, "angle", "pattern.lattice_angle"))

    def _numbers(self) -> list[tuple[str, float | None]]:
        own = [("pattern.pitch_y", self.pitch_y), ("pattern.lattice_angle", self.angle)]
        return [*super()._numbers(), *own]


class Pillars:
    """Cylindrical pillars at arbitrary positions.

    Parameters
    ----------
    x, y
        Centres (m): one array each.
    height, diameter
        Height and diameter of each pillar (m): an array, or one value for all.
    axis
        Position of the lens axis, in the same coordinates (m).
    reference_height, reference_diameter
        The pillar from whose top indentations are measured, and by which results are normalised; by default the highest pillar
        and the mean diameter.
    compliance
        ``"column"`` if pillars shorten under load, ``"elastic"`` if they are elastic bodies, ``"none"`` if they are rigid.

    Examples
    --------
    Three pillars, one of which is lower:

    >>> pillars = fakir.Pillars([0.0, 20e-6, 0.0], [0.0, 0.0, 20e-6], [2.2e-6, 2.2e-6, 2e-6], 6e-6)
    >>> system = fakir.System(fakir.Lens("2.2 mm", "2 MPa", 0.5), fakir.Substrate("2 MPa", 0.5), pillars)
    >>> len(system.press(indentation="0.2 um").pillars)
    2
    """

    __slots__ = ("axis", "compliance", "diameter", "height", "reference", "x", "y")

    def __init__(
        self,
        x: ArrayLike,
        y: ArrayLike,
        height: ArrayLike,
        diameter: ArrayLike,
        *,
        axis: tuple[Quantity, Quantity] = (0.0, 0.0),
        reference_height: Quantity | None = None,
        reference_diameter: Quantity | None = None,
        compliance: Literal["column", "elastic", "none"] = "column",
    ) -> None:
        columns: list[npt.NDArray[np.float64]] = []
        for name, given in (("x", x), ("y", y), ("height", height), ("diameter", diameter)):
            if np.ma.is_masked(given):
                row = int(np.flatnonzero(np.ma.getmaskarray(np.ma.asarray(given)))[0])
                raise ValueError(f"{name}[{row}] is masked: leave this pillar out of all columns")
            columns.append(_lengths(given, name))
        try:
            # Copies: later changes of the given arrays do not change the pillars.
            columns = [np.array(values).ravel() for values in np.broadcast_arrays(*columns)]
        except ValueError as error:
            raise ValueError(
                f"x, y, height and diameter have to be arrays of one length, or single numbers: {error}"
            ) from None
        self.x, self.y, self.height, self.diameter = columns
        self.axis = (
            si(axis[0], "length", "pattern.axis_x"),
            si(axis[1], "length", "pattern.axis_y"),
        )
        common = (
            ("pattern.pillar.height", reference_height),
            ("pattern.pillar.diameter", reference_diameter),
        )
        self.reference = [
            (key, None if value is None else si(value, "length", key)) for key, value in common
        ]
        self.compliance = compliance

    def __len__(self) -> int:
        return len(self.x)

    def _rows(self) -> list[tuple[float, float, float, float]]:
        return list(
            zip(
                self.x.tolist(),
                self.y.tolist(),
                self.height.tolist(),
                self.diameter.tolist(),
                strict=True,
            )
        )

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the table for ``pillars = "..."`` in a case file."""
        lines = ["x_m,y_m,height_m,diameter_m"]
        lines += [",".join(repr(value) for value in row) for row in self._rows()]
        unfinished = Path(f"{fspath(path)}.tmp")
        unfinished.write_text("\n".join(lines) + "\n", encoding="utf-8")
        unfinished.replace(path)


PillarPattern = HexagonalPattern | SquarePattern | RectangularPattern | ObliquePattern | Pillars
