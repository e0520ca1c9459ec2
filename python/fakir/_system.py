"""What is pressed onto what: lens, substrate, texture, and the questions one can ask of them."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike

from . import _fakir
from ._comparison import Comparison, compare
from ._cycle import Adhesion, Cycle, Drive, cycle
from ._format import Row, engineering, html_table, text_table
from ._gradient import Gradient, gradient
from ._loading import Approach, approach, checked_path
from ._quantity import Quantity, WithUnit, si
from ._run import Progress, options
from ._state import ContactState, CriticalState, critical_state, contact_state
from ._verification import Verification, verify

if TYPE_CHECKING:
    from .love import Surface

Method = Literal["spectral", "love", "punch", "homogenised"]
Overrides = Mapping[str, Quantity]

_RENAMED_SPREAD = "height_spread is now called height_standard_deviation"


def _set_material(body: object, keys: str, young_modulus: Quantity, poisson_ratio: Quantity) -> None:
    """Both numbers of an elastic body, whose keys in a case file begin so."""
    modulus = si(young_modulus, "pressure", f"{keys}young_modulus")
    object.__setattr__(body, "young_modulus", modulus)
    ratio = si(poisson_ratio, "number", f"{keys}poisson_ratio")
    object.__setattr__(body, "poisson_ratio", ratio)


@dataclass(frozen=True, init=False)
class ElasticBase:
    """A half-space that a lens or a substrate of finite thickness is bonded to.

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
    """What every lens and the substrate take besides their material, where they are no half-spaces."""

    thickness: Quantity | None
    """Thickness of the body as a flat layer (m), without which it is a half-space. Indentations are then the approach of the backs."""
    base: Base
    """What its back is bonded to: ``"rigid"``, or an `ElasticBase`; or ``"frictionless"``, where it lies on something rigid."""


@dataclass(frozen=True, init=False)
class _Body:
    """What lenses and substrates have in common: their thickness."""

    thickness: float | None = field(kw_only=True)
    base: Base = field(kw_only=True)

    def _set_layer(self, part: str, options: LayerOptions) -> None:
        known = LayerOptions.__annotations__
        for name in options:
            if name not in known:
                raise TypeError(f"{type(self).__name__} takes no {name}")
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


def _layer_of(values: Mapping[str, Any], part: str) -> LayerOptions:
    """The layer that a body of a case is, if it is one."""
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


def _refuse_layers(lens: object, substrate: Substrate) -> None:
    """Where both bodies are half-spaces."""
    for part, body in (("lens", lens), ("substrate", substrate)):
        if isinstance(body, _Body) and body.thickness is not None:
            raise ValueError(f"{part}.thickness is known to System only: leave it out here")


@dataclass(frozen=True, init=False)
class _RoundLens(_Body):
    """What the lenses with a radius have in common."""

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
class Lens(_RoundLens):
    """A spherical lens.

    Parameters
    ----------
    radius
        Radius of curvature: a number in m, a text such as ``"2.2 mm"``, or a pint quantity.
    young_modulus
        Young's modulus (Pa).
    poisson_ratio
        Poisson's ratio, from 0 to 0.5.
    **options
        `LayerOptions`, which all lenses take: ``thickness``, ``base``.
    """


@dataclass(frozen=True, init=False)
class ParaboloidLens(_RoundLens):
    """A lens of height r^2/(2R) over its lowest point; parameters as `Lens`.

    Like all lenses but the sphere it is answered by the method ``"spectral"``, without adhesion and without a floor that bears a part.
    """


@dataclass(frozen=True, init=False)
class CylinderLens(_RoundLens):
    """A cylinder on its side, over finitely many pillars.

    Parameters
    ----------
    radius, young_modulus, poisson_ratio
        As of a `Lens`.
    angle
        Direction from x of the line along which it is lowest (rad, or a text such as ``"30 deg"``).

    Examples
    --------
    >>> texture = SquareTexture("6 um", "2.2 um", pitch="20 um", columns=9)
    >>> rubber = Substrate("2 MPa", 0.5)
    >>> system = System(CylinderLens("2.2 mm", "2 MPa", 0.5, angle="90 deg"), rubber, texture)
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
    """A flat plate that is kept from turning and reaches beyond all of finitely many pillars.

    Parameters
    ----------
    young_modulus, poisson_ratio
        As of a `Lens`.
    tilt
        Between the plate and the floor (rad, or a text such as ``"0.1 deg"``), up to 10 degrees. Indentations are those at the origin, the
        place of the lens axis.
    tilt_direction
        In which it rises, from x (rad).
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
    """An axisymmetric lens of any smooth shape that rises, by a table of its heights.

    Parameters
    ----------
    profile
        A file with the columns ``radius_m`` and ``height_m``, from the axis outwards. No contact may come to its end.
    young_modulus, poisson_ratio
        As of a `Lens`.
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


AnyLens = Lens | ParaboloidLens | CylinderLens | PlateLens | ProfileLens


def _shape_of(lens: AnyLens) -> tuple[list[tuple[str, float | None]], list[tuple[str, str]]]:
    """The numbers and words of a lens by their keys, but those of its material."""
    numbers: list[tuple[str, float | None]]
    match lens:
        case ParaboloidLens():
            return [("lens.radius", lens.radius)], [("lens.shape", "paraboloid")]
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
    """The elastic body under the pillars, and what they are made of: a half-space, or a film of some thickness.

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
    >>> film = Substrate("2 MPa", 0.5, thickness="0.2 mm")
    >>> texture = HexagonalTexture("6 um", "2.2 um", surface_fraction=0.1)
    >>> system = System(Lens("2.2 mm", "2 MPa", 0.5), film, texture)
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
class _LatticeTexture:
    """What the textures on lattices have in common."""

    diameter: float
    height: float
    pitch: float | None
    surface_fraction: float | None
    offset: float
    offset_angle: float
    rotation: float
    columns: int | None
    height_standard_deviation: float
    missing: float
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
        for name in options:
            if name not in known:
                raise TypeError(
                    f"{type(self).__name__} takes no {name}: besides its own, it takes {', '.join(known)}"
                )

        def put(name: str, value: object) -> None:
            object.__setattr__(self, name, value)

        put("diameter", si(diameter, "length", "texture.pillar.diameter"))
        put("height", si(height, "length", "texture.pillar.height"))
        put("pitch", None if pitch is None else si(pitch, "length", "texture.pitch"))
        fraction = surface_fraction
        put(
            "surface_fraction",
            None if fraction is None else si(fraction, "fraction", "texture.surface_fraction"),
        )
        put("offset", si(options.get("offset", 0.0), "number", "texture.offset"))
        put("offset_angle", si(options.get("offset_angle", 0.0), "angle", "texture.offset_angle"))
        put("rotation", si(options.get("rotation", 0.0), "angle", "texture.rotation"))
        put("columns", options.get("columns"))
        deviation = options.get("height_standard_deviation", 0.0)
        if "height_spread" in options:
            if "height_standard_deviation" in options:
                raise TypeError(
                    "height_spread is the older name of height_standard_deviation: "
                    "give only height_standard_deviation"
                )
            warnings.warn(_RENAMED_SPREAD, FutureWarning, stacklevel=3)
            deviation = options["height_spread"]
        put(
            "height_standard_deviation",
            si(deviation, "fraction", "texture.height_standard_deviation"),
        )
        put("missing", si(options.get("missing", 0.0), "fraction", "texture.missing"))
        put("seed", options.get("seed", 0))
        put("compliance", options.get("compliance", "column"))

    @property
    def height_spread(self) -> float:
        """Deprecated name of ``height_standard_deviation``."""
        warnings.warn(_RENAMED_SPREAD, FutureWarning, stacklevel=2)
        return self.height_standard_deviation

    def _numbers(self) -> list[tuple[str, float | None]]:
        return [
            ("texture.pillar.diameter", self.diameter),
            ("texture.pillar.height", self.height),
            ("texture.pitch", self.pitch),
            ("texture.surface_fraction", self.surface_fraction),
            ("texture.offset", self.offset),
            ("texture.offset_angle", self.offset_angle),
            ("texture.rotation", self.rotation),
            ("texture.columns", self.columns),
            ("texture.height_standard_deviation", self.height_standard_deviation),
            ("texture.missing", self.missing),
            ("texture.seed", self.seed),
        ]


class LatticeOptions(TypedDict, total=False):
    """What every texture on a lattice takes besides its pillars and its pitch."""

    offset: Quantity
    """Distance of the lens axis from a pillar centre, in pitches ..."""
    offset_angle: Quantity
    """... in this direction from x (rad, or a text such as ``"30 deg"``)."""
    rotation: Quantity
    """By which the lattice is turned about the lens axis, anticlockwise (rad)."""
    columns: int | None
    """Pillars along each side of a finite lattice; without it the lattice has no end."""
    height_standard_deviation: Quantity
    """Standard deviation of the heights over the height, up to 0.2: every pillar has its own."""
    height_spread: Quantity
    """Deprecated name of ``height_standard_deviation``."""
    missing: Quantity
    """Probability that a pillar is missing."""
    seed: int
    """Whole number that decides which heights and which pillars."""
    compliance: Literal["column", "elastic", "none"]
    """``"column"`` if pillars shorten under load, ``"elastic"`` if they are elastic bodies, ``"none"`` if they do not give way."""


def _one_of(pitch: Quantity | None, surface_fraction: Quantity | None) -> None:
    if (pitch is None) == (surface_fraction is None):
        raise TypeError("give exactly one of pitch and surface_fraction")


class HexagonalTexture(_LatticeTexture):
    """Cylindrical pillars on a hexagonal lattice.

    Parameters
    ----------
    diameter, height
        Of the pillars (m).
    pitch, surface_fraction
        Distance of neighbouring pillars (m), or the fraction of the surface that is pillar top:
        exactly one of them.
    **options
        `LatticeOptions`: ``offset``, ``offset_angle``, ``rotation``, ``columns``,
        ``height_standard_deviation``, ``missing``, ``seed``, ``compliance``. The paper's texture has none of
        ``rotation`` to ``seed``; all methods, floor contact and adhesion are for that one.
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
        _one_of(pitch, surface_fraction)
        self._common(diameter, height, pitch, surface_fraction, options)


class SquareTexture(_LatticeTexture):
    """Cylindrical pillars on a square lattice with its rows along x and y; parameters as `HexagonalTexture`.

    >>> texture = SquareTexture("6 um", "2.2 um", surface_fraction=0.03)
    >>> system = System(Lens("2.2 mm", "1.5 MPa", 0.5), Substrate("1.5 MPa", 0.5), texture)
    >>> round(1e6 * system.transition().force)
    428
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
        _one_of(pitch, surface_fraction)
        self._common(diameter, height, pitch, surface_fraction, options)


@dataclass(frozen=True, init=False)
class RectangularTexture(_LatticeTexture):
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
        object.__setattr__(self, "pitch_y", si(pitch_y, "length", "texture.pitch_y"))

    def _numbers(self) -> list[tuple[str, float | None]]:
        return [*super()._numbers(), ("texture.pitch_y", self.pitch_y)]


@dataclass(frozen=True, init=False)
class ObliqueTexture(_LatticeTexture):
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
        object.__setattr__(self, "pitch_y", si(pitch_y, "length", "texture.pitch_y"))
        object.__setattr__(self, "angle", si(angle, "angle", "texture.lattice_angle"))

    def _numbers(self) -> list[tuple[str, float | None]]:
        own = [("texture.pitch_y", self.pitch_y), ("texture.lattice_angle", self.angle)]
        return [*super()._numbers(), *own]


class Pillars:
    """Cylindrical pillars wherever they stand, and no others.

    Parameters
    ----------
    x, y
        Centres (m): one array each.
    height, diameter
        Of each pillar (m): an array, or one for all.
    axis
        Where the lens axis stands, in the same coordinates (m).
    reference_height, reference_diameter
        The pillar from whose top indentations are counted, and that results are reduced by; without them, the highest pillar and
        the mean diameter.
    compliance
        ``"column"`` if pillars shorten under load, ``"elastic"`` if they are elastic bodies, ``"none"`` if they do not give way.

    Examples
    --------
    Three pillars, of which one is lower:

    >>> pillars = Pillars([0.0, 20e-6, 0.0], [0.0, 0.0, 20e-6], [2.2e-6, 2.2e-6, 2e-6], 6e-6)
    >>> system = System(Lens("2.2 mm", "2 MPa", 0.5), Substrate("2 MPa", 0.5), pillars)
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
        columns = [np.asarray(values, dtype=float) for values in (x, y, height, diameter)]
        try:
            columns = [np.ravel(values) for values in np.broadcast_arrays(*columns)]
        except ValueError as error:
            raise ValueError(
                f"x, y, height and diameter have to be arrays of one length, or single numbers: {error}"
            ) from None
        self.x, self.y, self.height, self.diameter = columns
        self.axis = (
            si(axis[0], "length", "texture.axis_x"),
            si(axis[1], "length", "texture.axis_y"),
        )
        common = (
            ("texture.pillar.height", reference_height),
            ("texture.pillar.diameter", reference_diameter),
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
        """Writes the table that ``pillars = "..."`` of a case file reads."""
        lines = ["x_m,y_m,height_m,diameter_m"]
        lines += [",".join(repr(value) for value in row) for row in self._rows()]
        unfinished = Path(f"{fspath(path)}.tmp")
        unfinished.write_text("\n".join(lines) + "\n", encoding="utf-8")
        unfinished.replace(path)


Texture = HexagonalTexture | SquareTexture | RectangularTexture | ObliqueTexture | Pillars


class System:
    """A lens above a texture: the complete problem, checked.

    Parameters
    ----------
    lens, substrate, texture
        What is pressed onto what. A lens is a `Lens`, a sphere, or another one: `ParaboloidLens`, `CylinderLens`, `PlateLens`, `ProfileLens`.
    floor_contact
        Whether the floor between the pillars bears its part past the transition. False is the fiction of the
        paper, in which the lens goes through the floor.
    adhesion
        How the pillar tops stick: an `Adhesion`, or the work of adhesion alone (J/m^2, or a text such as
        ``"50 mJ/m2"``). Nothing sticks if there is none. Only the method ``"spectral"`` has adhesion.

    Examples
    --------
    >>> system = System(
    ...     Lens("2.2 mm", "2 MPa", 0.5),
    ...     Substrate("2 MPa", 0.5),
    ...     HexagonalTexture("6 um", "2.2 um", surface_fraction=0.1),
    ... )
    >>> round(1e3 * system.transition().force, 3)
    4.448

    Past the transition the floor bears a part of the force:

    >>> sparse = system.replace({"texture.surface_fraction": 0.03})
    >>> state = sparse.press(indentation="6 um")
    >>> round(state.floor.share, 2)
    0.15

    Silicone sticks: `cycle` lowers the lens and pulls it off again.

    >>> sticky = sparse.replace({"adhesion.work": "50 mJ/m2"})
    >>> round(1e6 * sticky.cycle().pull_off.force)
    -57
    """

    __slots__ = ("_case",)
    _case: _fakir.Case

    def __init__(
        self,
        lens: AnyLens,
        substrate: Substrate,
        texture: Texture,
        *,
        floor_contact: bool = True,
        adhesion: Adhesion | Quantity | None = None,
    ) -> None:
        if not isinstance(floor_contact, (bool, np.bool_)):
            raise TypeError(
                f"floor_contact is of type {type(floor_contact).__name__}: give True or False"
            )
        kinds: list[tuple[object, type | tuple[type, ...], str]] = [
            (lens, (_RoundLens, PlateLens, ProfileLens), "Lens"),
            (substrate, Substrate, "Substrate"),
            (texture, (_LatticeTexture, Pillars), "HexagonalTexture"),
        ]
        for part, kind, name in kinds:
            if not isinstance(part, kind):
                raise TypeError(
                    f"a system takes a Lens, a Substrate and a HexagonalTexture or another texture, in this "
                    f"order: found {type(part).__name__} for {name}"
                )
        of_shape, words_of_shape = _shape_of(lens)
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
            sticks = adhesion if isinstance(adhesion, Adhesion) else Adhesion(adhesion)
            numbers.append(("adhesion.work", sticks.work))
            numbers.append(("adhesion.work_receding", sticks.work_receding))
        words = [
            *words_of_shape,
            *of_layers[0][1],
            *of_layers[1][1],
            ("texture.pillar.compliance", texture.compliance),
            ("floor.contact", "true" if floor_contact else "false"),
        ]
        if isinstance(adhesion, Adhesion) and adhesion.floor:
            words.append(("adhesion.floor", "true"))
        pillars = None
        if isinstance(texture, Pillars):
            numbers += texture.reference
            numbers.append(("texture.axis_x", texture.axis[0]))
            numbers.append(("texture.axis_y", texture.axis[1]))
            words.append(("texture.lattice", "listed"))
            pillars = texture._rows()
        else:
            numbers += texture._numbers()
            words.append(("texture.lattice", texture._lattice))
        given = [(key, float(number)) for key, number in numbers if number is not None]
        self._case = _fakir.Case.build(given, words, pillars)

    @classmethod
    def _of(cls, case: _fakir.Case) -> System:
        system = cls.__new__(cls)
        system._case = case
        return system

    @classmethod
    def from_file(
        cls, path: str | PathLike[str], set: Overrides | None = None
    ) -> System | Surface:
        """Reads a case file; ``set`` overrides keys, as ``--set`` of the command line.

        The method of the file is the one that is used where none is asked for. A case with a general
        ``[surface]`` gives a `fakir.love.Surface`, which answers the same questions: `press`,
        `transition`, `approach` and `verify`.
        """
        return cls._described(_fakir.read_case(fspath(path), _settings(set)))

    @classmethod
    def from_toml(cls, text: str, set: Overrides | None = None) -> System | Surface:
        """As `from_file`, from the text of a case file."""
        return cls._described(_fakir.parse_case("case.toml", text, _settings(set)))

    @classmethod
    def _described(cls, found: _fakir.Case | _fakir.Surface) -> System | Surface:
        if isinstance(found, _fakir.Case):
            return cls._of(found)
        from .love import Surface

        return Surface._of(found)

    def to_toml(self) -> str:
        """The case as a commented file, which gives the same system to the bit."""
        return self._case.to_toml()

    def replace(self, set: Overrides) -> System:
        """The same system with other values: ``system.replace({"texture.pitch": "25 um"})``."""
        return self._of(self._case.with_settings(_settings(set)))

    @property
    def lens(self) -> AnyLens:
        """The lens."""
        values = self._case.values()
        modulus, ratio = values["lens.young_modulus"], values["lens.poisson_ratio"]
        layer = _layer_of(values, "lens")
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
        return Lens(values["lens.radius"], modulus, ratio, **layer)

    @property
    def substrate(self) -> Substrate:
        """The substrate."""
        values = self._case.values()
        modulus, ratio = values["substrate.young_modulus"], values["substrate.poisson_ratio"]
        return Substrate(modulus, ratio, **_layer_of(values, "substrate"))

    @property
    def texture(self) -> Texture:
        """The texture, by its pitch."""
        values = self._case.values()
        rows = self._case.listed()
        height, diameter = values["texture.pillar.height"], values["texture.pillar.diameter"]
        compliance = values["texture.pillar.compliance"]
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
        columns = values.get("texture.columns")
        options: LatticeOptions = {
            "offset": values["texture.offset"],
            "offset_angle": values["texture.offset_angle"],
            "rotation": values.get("texture.rotation", 0.0),
            "columns": None if columns is None else int(columns),
            "height_standard_deviation": values.get("texture.height_standard_deviation", 0.0),
            "missing": values.get("texture.missing", 0.0),
            "seed": int(values.get("texture.seed", 0)),
            "compliance": compliance,
        }
        pitch = values["texture.pitch"]
        match values["texture.lattice"]:
            case "square":
                return SquareTexture(diameter, height, pitch=pitch, **options)
            case "rectangular":
                pitch_y = values["texture.pitch_y"]
                return RectangularTexture(diameter, height, pitch=pitch, pitch_y=pitch_y, **options)
            case "oblique":
                return ObliqueTexture(
                    diameter,
                    height,
                    pitch=pitch,
                    pitch_y=values["texture.pitch_y"],
                    angle=values["texture.lattice_angle"],
                    **options,
                )
        return HexagonalTexture(diameter, height, pitch=pitch, **options)

    @property
    def _pillar(self) -> tuple[float, float]:
        """Diameter and height of the common pillar, m."""
        values = self._case.values()
        return values["texture.pillar.diameter"], values["texture.pillar.height"]

    @property
    def pitch(self) -> float:
        """Distance of neighbouring pillars, m; of listed ones the mean distance of nearest neighbours."""
        return float(self._case.values()["texture.pitch"])

    @property
    def surface_fraction(self) -> float:
        """Fraction of the surface that is pillar top."""
        return float(self._case.values()["texture.surface_fraction"])

    @property
    def floor_contact(self) -> bool:
        """Whether the floor bears its part past the transition; if not, the lens goes through it."""
        return bool(self._case.values()["floor.contact"] == "true")

    @property
    def adhesion(self) -> Adhesion | None:
        """How the pillar tops stick; none if nothing does."""
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
        """The method that is used where none is asked for."""
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
        """The critical state, in which the lens just reaches the floor between the pillars.

        Parameters
        ----------
        method
            ``"spectral"`` (what there is unless a case file says otherwise), ``"love"``,
            ``"punch"`` or ``"homogenised"``.
        accuracy
            Of the spectral method: ``"default"`` or ``"accurate"``.
        form
            Of the punch lattice: ``"corrected"`` or ``"plain"``.
        cells_per_diameter, mesh, cells
            Of Love elements, as in a case file.
        threads
            To share the work between; 0 for all processors, which are the most that are used.
        progress
            Called now and then with the stage, the step, and the numbers of pillars solved and
            touched. An exception in it stops the computation.
        memory_limit
            Bytes; 8 GB if not given.

        Raises
        ------
        SolveError
            If there is no such contact, or it takes too much memory.
        NotConverged
            If the solution is none; what was reached is in its ``result``.
        KeyboardInterrupt
            Within a fraction of a second of Ctrl-C.
        """
        case = self._with_method(method, accuracy, form, cells_per_diameter, mesh, cells)
        run = options(threads, progress, memory_limit)
        return critical_state(_fakir.transition(case, run))

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
        """The contact at an indentation (m) or under a force (N): exactly one of them.

        Past the transition the floor bears its part: `ContactState.floor`. Only the method ``"spectral"``
        knows how much. By the other methods, and with ``floor_contact=False`` of the system, such a load is
        answered as if the floor were not there, with a warning. Everything else is as in `transition`.
        """
        case = self._with_method(method, accuracy, form, cells_per_diameter, mesh, cells)
        run = options(threads, progress, memory_limit)
        return contact_state(_fakir.press(case, *load(indentation, force), run))

    def gradient(
        self,
        *,
        indentation: Quantity | None = None,
        force: Quantity | None = None,
        accuracy: Literal["default", "accurate"] | None = None,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Gradient:
        """The contact at an indentation (m) or under a force (N), or the critical state, with its exact derivatives.

        They are with respect to the numbers of the system, and to the height of every pillar. Only the method
        ``"spectral"`` has them, without adhesion, and as long as the floor bears nothing.

        Raises
        ------
        SolveError
            If there is no such contact, or it has no gradient; it says why.
        """
        case = self._with_method("spectral", accuracy, None, None, None, None)
        question = load_or_critical(indentation, force)
        return gradient(case, question, options(threads, progress, memory_limit))

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
        """Loading step by step from first touch, up to the critical state, or through it.

        The critical state is one of the states. Past it the floor bears its part, as in `press`.

        Parameters
        ----------
        step
            Of the indentation (m).
        until
            The last indentation (m), unless the critical state comes earlier.
        to
            The last indentation (m), before the critical state or past it.
        to_force
            The force (N) under which the loading ends, before the critical state or past it.
        past_transition
            Makes ``until`` mean the same as ``to``, which is to be given in its place.
        """
        path = checked_path(step, until, past_transition, to, to_force)
        case = self._with_method(method, accuracy, None, None, None, None)
        return approach(case, path, options(threads, progress, memory_limit))

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
        """Loading and unloading of pillar tops that stick, up to the critical state unless told otherwise.

        The floor does not stick: loading ends at the latest where the lens reaches it, unless it is ignored
        (``floor_contact=False``).

        Parameters
        ----------
        to, to_force
            The indentation (m) or the force (N) at which the lens turns back.
        drive
            What is held while contacts snap in or out: ``"displacement"``, ``"force"``, or the crosshead of a
            ``"machine"``.
        machine_stiffness
            Of that machine (N/m).
        retract
            Whether the lens is pulled off again.
        """
        case = self._with_method(None, accuracy, None, None, None, None)
        run = options(threads, progress, memory_limit)
        return cycle(case, to, to_force, drive, machine_stiffness, retract, run)

    def compare(
        self,
        *,
        threads: int = 1,
        progress: Progress | None = None,
        memory_limit: int | None = None,
    ) -> Comparison:
        """The critical state by every method, coarse to exact."""
        return compare(self._case, options(threads, progress, memory_limit))

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
        """A second opinion: the spectral method and Love elements on the same question.

        The question is the critical state, or the contact under a load if one is given. Elements have no adhesion, so
        that a system with adhesion is refused: ``system.replace({"adhesion.work": 0})`` is the one without.
        """
        question = load_or_critical(indentation, force)
        run = options(threads, progress, memory_limit)
        return verify(self._case, question, cells_per_diameter, run)

    def _with_method(
        self,
        method: str | None,
        accuracy: str | None,
        form: str | None,
        cells_per_diameter: int | None,
        mesh: str | None,
        cells: str | None,
    ) -> _fakir.Case:
        asked = {
            "method.name": method,
            "method.accuracy": accuracy,
            "method.form": form,
            "method.cells_per_diameter": cells_per_diameter,
            "method.mesh": mesh,
            "method.cells": cells,
        }
        settings = [f"{key}={value}" for key, value in asked.items() if value is not None]
        return self._case.with_settings(settings) if settings else self._case

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
                f"diameter {length('texture.pillar.diameter')}, "
                f"height {length('texture.pillar.height')}",
            ),
            (
                "lattice",
                f"pitch {length('texture.pitch')}, "
                f"surface fraction {values['texture.surface_fraction']:.6g}"
                + (
                    f", lens axis {values['texture.offset']:g} pitches from a pillar"
                    if "texture.offset" in values
                    else f", {values['texture.lattice']}"
                ),
            ),
        ]
        if not self.floor_contact:
            rows.append(("floor", "ignored: past the transition the lens goes through it"))
        if self.adhesion is not None:
            work = f"work {1e3 * self.adhesion.work:g} mJ/m2"
            receding = self.adhesion.work_receding
            more = "" if receding is None else f", {1e3 * receding:g} mJ/m2 to part"
            floor = ", of the floor too" if self.adhesion.floor else ""
            rows.append(("adhesion", work + more + floor))
        return rows

    def __repr__(self) -> str:
        return text_table("fakir.System", self._rows())

    def _repr_html_(self) -> str:
        return html_table("System", self._rows())

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, System) or self.to_toml() != other.to_toml():
            return False
        return self._case.listed() == other._case.listed()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __reduce__(self) -> tuple[Any, ...]:
        rows = self._case.listed()
        if rows is None:
            return System.from_toml, (self.to_toml(),)
        # Wherever it is made again, the file of the pillars need not be there.
        return _with_listed, (self.to_toml(), rows)


def _with_listed(text: str, rows: list[list[float]]) -> System:
    return System._of(_fakir.Case.with_listed(text, rows))


def load(
    indentation: Quantity | None, force: Quantity | None
) -> tuple[float | None, float | None]:
    """The one of both that is given, in SI units."""
    if (indentation is None) == (force is None):
        raise TypeError("give exactly one of indentation and force")
    if indentation is not None:
        return si(indentation, "length", "indentation"), None
    assert force is not None
    return None, si(force, "force", "force")


def load_or_critical(
    indentation: Quantity | None, force: Quantity | None
) -> tuple[float | None, float | None]:
    """As :func:`load`; none of both is the critical state."""
    return (None, None) if indentation is None and force is None else load(indentation, force)


def _settings(overrides: Overrides | None) -> list[str]:
    """Overrides as arguments of ``--set``."""
    return [f"{key}={_written(value)}" for key, value in (overrides or {}).items()]


def _written(value: Quantity) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, WithUnit):
        return repr(float(value.to_base_units().magnitude))  # type: ignore[attr-defined]
    return repr(value.item() if hasattr(value, "item") else value)
