"""Input quantities: numbers in SI units, strings with a unit, pint quantities."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from typing import Any, Literal, Protocol, TypeAlias, Union, cast, runtime_checkable

import numpy as np
import numpy.typing as npt

from . import _fakir

Dimension: TypeAlias = Literal[
    "length",
    "pressure",
    "force",
    "energy per area",
    "stiffness",
    "angle",
    "time",
    "fraction",
    "number",
]

UNITS: dict[Dimension, str] = {
    "length": "m",
    "pressure": "Pa",
    "force": "N",
    "energy per area": "J/m^2",
    "stiffness": "N/m",
    "angle": "rad",
    "time": "s",
    "fraction": "dimensionless",
    "number": "dimensionless",
}


@runtime_checkable
class WithUnit(Protocol):
    """A quantity with a unit, as in pint."""

    @property
    def magnitude(self) -> Any: ...

    def to(self, unit: str, /) -> Any: ...


Quantity: TypeAlias = Union[float, str, np.floating[Any], np.integer[Any], WithUnit]
"""A number in SI units, a string such as ``"2 MPa"``, or a pint quantity."""

FloatArray: TypeAlias = npt.NDArray[np.float64]


def si(value: Quantity, dimension: Dimension, name: str) -> float:
    """The number in SI units; ``name`` is used in error messages."""
    if isinstance(value, str):
        try:
            return _fakir.parse_quantity(value, dimension)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    if isinstance(value, bool):
        raise TypeError(f"{name} is {value}: {_accepted(dimension)}")
    if isinstance(value, WithUnit):
        return float(without_unit(value, dimension, name))
    if isinstance(value, numbers.Real) or (isinstance(value, np.ndarray) and value.ndim == 0):
        return float(value)
    raise TypeError(f"{name} is of type {type(value).__name__}: {_accepted(dimension)}")


def finite(value: Quantity, dimension: Dimension, name: str) -> float:
    """As ``si``, but neither infinite nor NaN."""
    number = si(value, dimension, name)
    if not math.isfinite(number):
        raise ValueError(f"{name} is {number}: it must be a finite number")
    return number


def whole(value: Any, name: str) -> int:
    """A number without a fraction that a float holds exactly."""
    numeric = (int, float, np.integer, np.floating)
    if isinstance(value, bool) or not isinstance(value, numeric) or value % 1 != 0:
        raise TypeError(f"{name} is {value!r}: give a whole number")
    found = int(value)
    if abs(found) > 2**53:
        raise ValueError(f"{name} is {found}: it can be 2^53 at most")
    return found


def several(values: Sequence[Quantity] | Quantity) -> list[Quantity]:
    """The quantities of a list, or a single one: a text is one quantity, not its letters."""
    if isinstance(values, (str, numbers.Real)) or getattr(values, "ndim", None) == 0:
        return [cast(Quantity, values)]
    if isinstance(values, WithUnit) and np.ndim(values.magnitude) == 0:
        return [values]
    return list(cast("Sequence[Quantity]", values))


def array(values: object, dimension: Dimension, name: str) -> FloatArray:
    """An array of float64 in SI units: from float64 without a copy, from float32, or from integers."""
    if isinstance(values, WithUnit):
        values = without_unit(values, dimension, name)
    if isinstance(values, str):
        values = si(values, dimension, name)
    found = without_mask(values)
    if found.dtype.kind not in "fiu" or found.dtype.itemsize > 8:
        raise TypeError(
            f"{name} is an array of {found.dtype}: give float64 or float32 in {UNITS[dimension]}, "
            "or a quantity with a unit"
        )
    result = np.ascontiguousarray(found, dtype=np.float64).reshape(found.shape)
    bad = np.flatnonzero(~np.isfinite(result))
    if bad.size:
        at = tuple(int(k) for k in np.unravel_index(int(bad[0]), result.shape))
        where = f"[{', '.join(map(str, at))}]" if at else ""
        number = result.reshape(-1)[bad[0]]
        raise ValueError(f"{name}{where} is {number}: every value must be a finite number")
    return result


def without_mask(values: object) -> npt.NDArray[Any]:
    """An array with NaN where a masked array has no values."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        found = np.array(values.data, dtype=np.float64)
        found[np.ma.getmaskarray(values)] = np.nan
        return found
    return np.asarray(values)


def points_at(x: object, y: object) -> tuple[FloatArray, FloatArray]:
    """Coordinates of points, m, which are broadcast."""
    across, along = array(x, "length", "x"), array(y, "length", "y")
    try:
        across, along = np.broadcast_arrays(across, along)
    except ValueError:
        raise ValueError(
            f"x of shape {across.shape} and y of shape {along.shape} cannot be broadcast together"
        ) from None
    return across, along


def flat(values: FloatArray) -> FloatArray:
    """The values in one dimension; arrays that were broadcast have no separate memory yet."""
    return np.ascontiguousarray(values).reshape(-1)


def without_unit(value: WithUnit, dimension: Dimension, name: str) -> Any:
    try:
        return value.to(UNITS[dimension]).magnitude
    except Exception as error:
        raise ValueError(f"{name}: {error}; {_accepted(dimension)}") from error


def _accepted(dimension: Dimension) -> str:
    examples = {
        "length": '"6 um"',
        "pressure": '"2 MPa"',
        "force": '"20 uN"',
        "energy per area": '"50 mJ/m2"',
        "stiffness": '"20 N/m"',
        "angle": '"30 deg"',
    }
    if dimension == "number":
        return "give a plain number"
    if dimension == "fraction":
        return 'give a plain number, or a text in per cent such as "3 %"'
    return (
        f"give a number in {UNITS[dimension]}, a text with a unit such as {examples[dimension]}, "
        "or a pint quantity"
    )
