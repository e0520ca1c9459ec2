"""Shear stresses on tops and floor, fitted to measured lateral forces."""

from __future__ import annotations

import json
from collections.abc import Mapping
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from . import _fakir
from ._asperities import AsperityArray
from ._fit import Measurements, columns_of, error_of
from ._flat import FlatSystem
from ._format import Row, engineering
from ._quantity import FloatArray, Quantity
from ._result import Result
from ._run import Progress, options, warn
from ._system import System
from .bem import Surface

if TYPE_CHECKING:
    import pandas


class ShearStress(NamedTuple):
    """A fitted shear stress, in Pa."""

    value: float | None
    """The fitted value; ``None`` if the data do not determine it."""
    standard_error: float | None
    """The standard error; ``None`` if the data do not determine it."""
    interval: tuple[float, float] | None
    """Ends of the 95 % confidence interval; ``None`` if the data do not determine it."""
    area_error: float
    """Effect of the estimated errors of the contact areas, beside the standard error."""

    @property
    def determined(self) -> bool:
        """Whether the data determine the stress."""
        return self.interval is not None


class FrictionFit(Result):
    """Fitted shear stresses."""

    _titles = ("fakir.FrictionFit", "Fit of shear stresses")

    def __init__(self, fitted: _fakir.FittedFriction) -> None:
        self._fitted = fitted
        self._summary = json.loads(fitted.json())

    @property
    def tops(self) -> ShearStress:
        """The shear stress on pillar tops, or of the whole contact on a surface without a floor."""
        return self._stress(0)

    @property
    def floor(self) -> ShearStress | None:
        """The shear stress on the floor; ``None`` on a surface without a floor."""
        return self._stress(1) if len(self._summary["shear_stresses"]) > 1 else None

    def _stress(self, place: int) -> ShearStress:
        given = self._summary["shear_stresses"][place]
        ends = given["interval_Pa"]
        return ShearStress(
            given["value_Pa"],
            given["standard_error_Pa"],
            None if ends is None else (ends[0], ends[1]),
            given["area_error_Pa"],
        )

    @property
    def determined(self) -> bool:
        """Whether the data determine all stresses."""
        return bool(self._summary["determined"])

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the stresses, Pa^2; zero for those that are not determined."""
        return np.array(self._summary["covariance_Pa2"], dtype=float)

    @property
    def correlation(self) -> float | None:
        """Correlation of both stresses; ``None`` if they are not both determined."""
        found = self._summary["correlation"]
        return None if found is None else float(found)

    @property
    def p_value(self) -> float | None:
        """Probability of a chi-square of at least that of the fit; ``None`` if errors were estimated."""
        found = self._summary["p_value"]
        return None if found is None else float(found)

    @property
    def warnings(self) -> list[str]:
        """Statements about stresses that are not determined, rows left out, and misfits."""
        return self._fitted.warnings

    @property
    def system(self) -> System | FlatSystem | AsperityArray | Surface:
        """The system with the fitted stresses, as far as they are determined and not negative."""
        case = self._fitted.case
        if isinstance(case, _fakir.Case):
            return System._of(case)
        if isinstance(case, _fakir.Flat):
            return FlatSystem._of(case)
        return Surface._of(case) if isinstance(case, _fakir.Surface) else AsperityArray._of(case)

    @property
    def curve(self) -> FloatArray:
        """The curve of the model: normal force (N), lateral force (N), and contact areas on tops and floor (m^2) of each point."""
        return np.array(self._fitted.curve(), dtype=float).reshape(-1, 4)

    def to_pandas(self) -> pandas.DataFrame:
        """Data and model: the table ``fitted.csv`` of the command."""
        import pandas

        return pandas.DataFrame(dict(self._fitted.table()))

    def _rows(self) -> list[Row]:
        rows: list[Row] = []
        for name, stress in (("tops", self.tops), ("floor", self.floor)):
            if stress is None:
                continue
            if stress.value is None or stress.standard_error is None:
                rows.append((name, "not determined"))
            else:
                error = engineering(stress.standard_error, "Pa", 2)
                rows.append((name, f"{engineering(stress.value, 'Pa', 4)}, standard error {error}"))
        return rows


def fit_friction(
    measurements: Measurements,
    system: System | FlatSystem | AsperityArray | Surface,
    *,
    columns: Mapping[str, str] | None = None,
    lateral_error: Quantity | None = None,
    threads: int = 0,
    progress: Progress | None = None,
    memory_limit: int | None = None,
) -> FrictionFit:
    """Fits the shear stresses on pillar tops and floor to lateral forces of a sliding contact.

    The contact of every row is solved; its areas on tops and on the floor determine both stresses by linear least squares. The shear
    does not change the normal contact in this model.

    Parameters
    ----------
    measurements
        A table, or its columns of equal length: ``lateral_force_N`` (also called friction, tangential or shear force) and one of
        ``force_N`` (normal force) and ``indentation_m``, in any unit, and the standard errors ``lateral_force_error_N``.
    system
        Pillars, a flat surface, rounded tops, or a height map that was read from a case file. On surfaces without a floor there is
        one stress.
    columns
        Explicitly assigned columns, headings by quantities: ``{"lateral_force": "Channel 2 [mN]"}``.
    lateral_error
        Standard error (N) of lateral forces without errors in the columns. Without any they are estimated from the residuals.

    Raises
    ------
    FitError
        If the data are invalid or too few.
    """
    named = [(str(quantity), str(heading)) for quantity, heading in dict(columns or {}).items()]
    error = error_of(lateral_error, "force", "lateral_error")
    if isinstance(measurements, (str, PathLike)):
        data = _fakir.LateralData.read(fspath(measurements), named, error)
    else:
        data = _fakir.LateralData.of(columns_of(measurements), named, error)
    run = options(threads, progress, memory_limit)
    result = FrictionFit(_fakir.fit_friction(_case_of(system), data, run))
    warn(result.warnings, depth=1)
    return result


def _case_of(system: System | FlatSystem | AsperityArray | Surface) -> Any:
    if isinstance(system, System):
        return system._case
    if isinstance(system, FlatSystem):
        return system._flat
    if isinstance(system, (AsperityArray, Surface)):
        return system._asperities if isinstance(system, AsperityArray) else system._surface
    raise TypeError(f"system is of type {type(system).__name__}: give a System, FlatSystem, AsperityArray or Surface")
