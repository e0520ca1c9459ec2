"""Problems with every kind of surface."""

from __future__ import annotations

from os import PathLike, fspath
from typing import Any, overload

import numpy as np

from . import _fakir
from ._bodies import AnyLens, Lens, PillarPattern, Pillars, Substrate
from ._quantity import Quantity
from ._flat import Flat, FlatSystem
from ._asperities import AsperityArray
from ._settings import Overrides, settings
from ._system import System
from .bem import Plate, Surface


@overload
def problem(
    indenter: Lens | Plate,
    substrate: Substrate,
    surface: Pillars,
    *,
    top_radius: Quantity,
    **options: Any,
) -> AsperityArray: ...
@overload
def problem(
    indenter: AnyLens, substrate: Substrate, surface: PillarPattern, **options: Any
) -> System: ...
@overload
def problem(
    indenter: AnyLens, substrate: Substrate, surface: Flat, **options: Any
) -> FlatSystem: ...
@overload
def problem(
    indenter: Lens | Plate, substrate: Substrate, surface: object, **options: Any
) -> Surface: ...
def problem(
    indenter: Any,
    substrate: Substrate,
    surface: Any,
    *,
    top_radius: Quantity | None = None,
    **options: Any,
) -> System | Surface | AsperityArray | FlatSystem:
    """Creates the problem of an indenter and a surface of any kind.

    Parameters
    ----------
    indenter, substrate
        A lens or a plate, and the half-space under the surface.
    surface
        Pillars, such as a `HexagonalPattern` or `Pillars`, a `Flat` surface, or a height map: an array (m) or an object of SurfaceTopography.
    top_radius
        Radius of curvature (m) of `Pillars` with rounded tops.
    options
        Those of `System`, `FlatSystem`, `fakir.bem.Surface` or `AsperityArray`, one of which is returned. All of them have `press`.

    Examples
    --------
    >>> rubber = {"young_modulus": "2 MPa", "poisson_ratio": 0.5}
    >>> lens, substrate = fakir.Lens("2.2 mm", **rubber), fakir.Substrate(**rubber)
    >>> flat = fakir.problem(lens, substrate, np.zeros((64, 64)), cell_size="1 um")
    >>> round(1e6 * flat.press(indentation="0.1 um").force, 1)
    2.6
    """
    if isinstance(surface, type):
        raise TypeError(f"surface is the class {surface.__name__}: give one of its objects, as {surface.__name__}(...)")
    if isinstance(surface, (str, PathLike)):
        raise TypeError(
            f"surface is the name of a file, {fspath(surface)}: read an array, as by numpy.load, or a case file with surface.height_map by fakir.read_case"
        )
    if top_radius is not None:
        if not isinstance(surface, Pillars):
            raise TypeError(f"top_radius is that of Pillars, not of {type(surface).__name__}")
        x, y = (at - axis for at, axis in zip((surface.x, surface.y), surface.axis))
        diameter = None if np.isnan(surface.diameter).all() else surface.diameter
        options.setdefault("diameter", diameter)
        options.setdefault("compliance", surface.compliance)
        given = dict(surface.reference)
        options.setdefault("reference_height", given["pattern.pillar.height"])
        return AsperityArray(x, y, surface.height, top_radius, indenter, substrate, **options)
    if isinstance(surface, Flat):
        return FlatSystem(indenter, substrate, **options)
    if isinstance(surface, PillarPattern):
        return System(indenter, substrate, surface, **options)
    return Surface(surface, indenter, substrate, **options)


def read_case(
    path: str | PathLike[str], overrides: Overrides | None = None
) -> System | Surface | AsperityArray | FlatSystem:
    """Reads a case file with any kind of surface; ``overrides`` contains values of keys, as ``--set`` of the command line."""
    found = _fakir.read_case(fspath(path), settings(overrides), True)
    if isinstance(found, _fakir.Case):
        return System._of(found)
    if isinstance(found, _fakir.Flat):
        return FlatSystem._of(found)
    return Surface._of(found) if isinstance(found, _fakir.Surface) else AsperityArray._of(found)
