"""Fits of several curves, and the statistics of their parameters."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeAlias, TypedDict, Unpack, overload

from . import _fakir
from ._fit import (
    UNITS,
    Estimate,
    Fit,
    Instrument,
    Measurements,
    case_of,
    check_parameters,
    estimate,
    prepared,
    written,
)
from ._asperities import AsperityArray
from ._flat import FlatSystem
from ._format import Row
from ._quantity import Quantity
from ._result import Result
from ._run import options, warn, warn_of_interactions
from ._system import System
from .bem import Surface
from .errors import FitError, NotConverged

if TYPE_CHECKING:
    import pandas

Curves: TypeAlias = Sequence[Measurements] | Mapping[str, Measurements]
"""Several curves, or curves by their names."""

AnySystem: TypeAlias = System | FlatSystem | AsperityArray | Surface
"""A system that can be fitted."""

_Case: TypeAlias = _fakir.Case | _fakir.Flat | _fakir.Asperities | _fakir.Surface


class FittedCurve(NamedTuple):
    """One of several curves."""

    name: str
    """The file, the name that was given, or the number of the curve."""
    fit: Fit | None
    """Its fit; None if the curve cannot be read or fitted."""
    problem: str | None
    """Why there is no result, or why it is not converged; None otherwise."""
    outlier_of: list[str]
    """Parameters whose value is far from those of the other curves."""


class Outlier(NamedTuple):
    """A value far from those of the other curves."""

    name: str
    """Name of the curve."""
    value: float
    """The value, in SI units."""
    score: float
    """Modified z-score, 0.6745 (value - median)/(median absolute deviation): beyond 3.5."""


class Statistics(NamedTuple):
    """A parameter over all curves whose fit converged and determines it, in SI units."""

    curves: int
    """Number of these curves."""
    mean: float | None
    """Arithmetic mean, which includes outliers; None without curves."""
    standard_deviation: float | None
    """Standard deviation of a single value; None for fewer than two curves."""
    standard_error: float | None
    """Standard error of the mean, from the standard deviation."""
    median: float | None
    """Median."""
    weighted_mean: float | None
    """Mean weighted with the inverse squares of the standard errors of the curves."""
    weighted_standard_error: float | None
    """Standard error of the weighted mean, from the standard errors of the curves."""
    p_value: float | None
    """Probability of values at least as different (chi-square) if all curves have the same value and normal errors."""
    outliers: list[Outlier]
    """Values far from the others, for five curves or more."""
    unit: str
    """The unit."""


class Agreement(NamedTuple):
    """Test of whether all curves have the same shared values: joint fit against separate fits."""

    test: str
    """``"chi_square"`` if all errors were given, otherwise ``"f"``."""
    statistic: float
    """Chi-square or F."""
    degrees_of_freedom: tuple[int, ...]
    """One number for chi-square, two for F."""
    p_value: float
    """Probability of a statistic at least as large if the values are the same."""
    agree: bool
    """Whether the probability is at least 0.01."""


class CurveResults(Result):
    """Results of several curves."""

    def __init__(self, fitted: _fakir.FittedCurves, understood: Sequence[Sequence[str]]) -> None:
        self._fitted = fitted
        self._summary = json.loads(fitted.json())
        self._fits = [
            None if one is None else Fit(one, words) for one, words in zip(fitted.curves(), understood)
        ]

    @property
    def curves(self) -> list[FittedCurve]:
        """The curves, in the order in which they were given."""
        given = zip(self._summary["curves"], self._fits)
        return [FittedCurve(one["file"], fit, one["problem"], one.get("outlier_of", [])) for one, fit in given]

    def __len__(self) -> int:
        return len(self._fits)

    @property
    def failed(self) -> list[FittedCurve]:
        """Curves without a converged fit."""
        return [curve for curve in self.curves if curve.problem is not None]

    @property
    def describes_data(self) -> bool:
        """Whether all fits describe their data."""
        return bool(self._summary["describes_data"])

    @property
    def converged(self) -> bool:
        """Whether every curve has a converged fit."""
        return bool(self._summary["converged"])

    def columns(self) -> dict[str, Any]:
        """The results, one row for every curve: the columns of ``fits.csv``."""
        return dict(self._fitted.table())

    def to_pandas(self) -> pandas.DataFrame:
        """The results, one row for every curve: the columns of ``fits.csv``."""
        import pandas

        return pandas.DataFrame(self.columns())

    def table(self) -> pandas.DataFrame | dict[str, Any]:
        """The results as a table of pandas; without pandas, as `columns`."""
        try:
            return self.to_pandas()
        except ImportError:
            return self.columns()


class Fits(CurveResults):
    """Fits of several curves, each separately."""

    _titles = ("fakir.Fits", "Fits of several curves")

    @property
    def parameters(self) -> dict[str, Statistics]:
        """Mean, scatter and outliers of every parameter, by its name."""
        return {given["name"]: _statistics(given) for given in self._summary["parameters"]}

    def __getitem__(self, name: str) -> Statistics:
        return self.parameters[name]

    def _rows(self) -> list[Row]:
        rows: list[Row] = []
        for name, found in self.parameters.items():
            if found.mean is None:
                rows.append((name, "no curve determines it"))
                continue
            text = f"mean {written(found.mean, found.unit)} of {found.curves} curves"
            if found.standard_deviation is not None:
                text += f", standard deviation {written(found.standard_deviation, found.unit)}"
            if found.outliers:
                text += f", outliers {', '.join(outlier.name for outlier in found.outliers)}"
            rows.append((name, text))
        rows.extend((f"no result of {curve.name}", str(curve.problem)) for curve in self.failed)
        wrong = [one.name for one in self.curves if one.fit is not None and not one.fit.describes_data]
        if wrong:
            rows.append(("does not describe the data", ", ".join(wrong)))
        return rows


class JointFit(CurveResults):
    """Fit of several curves together. The fits of its curves contain all parameters, with the errors of the joint fit."""

    _titles = ("fakir.JointFit", "Joint fit")

    @property
    def parameters(self) -> dict[str, Estimate]:
        """The shared parameters by name."""
        return {given["name"]: estimate(given) for given in self._summary["parameters"]}

    def __getitem__(self, name: str) -> Estimate:
        return self.parameters[name]

    @property
    def separate(self) -> list[dict[str, Estimate]]:
        """For every curve, the shared parameters as its separate fit gives them."""
        return [
            {given["name"]: estimate(given) for given in curve["separate"]} for curve in self._summary["curves"]
        ]

    @property
    def agreement(self) -> Agreement | None:
        """Test of the shared values; None for one curve, or if a separate fit did not converge."""
        given = self._summary["agreement"]
        if given is None:
            return None
        return Agreement(**{**given, "degrees_of_freedom": tuple(given["degrees_of_freedom"])})

    @property
    def degrees_of_freedom(self) -> int:
        """Number of values of all curves minus number of shared parameters and of parameters of the curves."""
        return int(self._summary["degrees_of_freedom"])

    @property
    def chi_square(self) -> float:
        """Sum of squares of (measured - computed)/error of all curves."""
        return float(self._summary["chi_square"])

    @property
    def undetermined(self) -> list[str]:
        """A sentence for everything that the curves do not determine."""
        return list(self._summary["undetermined"])

    def _rows(self) -> list[Row]:
        rows: list[Row] = [("curves", str(len(self)))]
        for name, found in self.parameters.items():
            value = written(found.value, found.unit)
            if found.interval is None:
                rows.append((name, f"{value}: not determined by the data"))
                continue
            low, high = (written(end, found.unit) for end in found.interval)
            rows.append((name, f"{value}, 95 % interval {low} to {high}"))
        if self.agreement is not None:
            verdict = "agree" if self.agreement.agree else "do not agree"
            rows.append(("the curves", f"{verdict} (p = {self.agreement.p_value:.2g})"))
        if not self.describes_data:
            rows.append(("does not describe the data", "see the fits of the curves"))
        return rows


class CurveOptions(TypedDict, total=False):
    """Arguments of `fit_many` that are the same for all curves: see `fit`."""

    contact_point: Quantity | None
    machine_compliance: Quantity | None
    force_offset: Quantity
    displacement_drift: Quantity
    force_drift: Quantity
    force_slope: Quantity
    starts: int
    columns: Mapping[str, str] | None
    spring_constant: Quantity | None
    rows: tuple[int | None, int | None] | None
    cycle: int | None
    branch: str | None
    between: tuple[Quantity | None, Quantity | None] | None
    position_error: Quantity | None
    force_error: Quantity | None
    contact_radius_error: Quantity | None
    threads: int
    progress: Callable[[int, int], object] | None
    memory_limit: int | None


@overload
def fit_many(
    curves: Curves,
    system: AnySystem | Sequence[AnySystem],
    free: Sequence[str],
    *,
    joint: Literal[False] = False,
    **options: Unpack[CurveOptions],
) -> Fits: ...
@overload
def fit_many(
    curves: Curves,
    system: AnySystem | Sequence[AnySystem],
    free: Sequence[str],
    *,
    joint: Literal[True],
    shared: Sequence[str] | None = None,
    **options: Unpack[CurveOptions],
) -> JointFit: ...
def fit_many(
    curves: Curves,
    system: AnySystem | Sequence[AnySystem],
    free: Sequence[str],
    *,
    joint: bool = False,
    shared: Sequence[str] | None = None,
    contact_point: Quantity | None = None,
    machine_compliance: Quantity | None = None,
    force_offset: Quantity = 0.0,
    displacement_drift: Quantity = 0.0,
    force_drift: Quantity = 0.0,
    force_slope: Quantity = 0.0,
    starts: int = 1,
    columns: Mapping[str, str] | None = None,
    spring_constant: Quantity | None = None,
    rows: tuple[int | None, int | None] | None = None,
    cycle: int | None = None,
    branch: str | None = None,
    between: tuple[Quantity | None, Quantity | None] | None = None,
    position_error: Quantity | None = None,
    force_error: Quantity | None = None,
    contact_radius_error: Quantity | None = None,
    threads: int = 0,
    progress: Callable[[int, int], object] | None = None,
    memory_limit: int | None = None,
) -> Fits | JointFit:
    """Fits parameters to several curves: each separately, with mean and scatter of every parameter, or all together.

    All other arguments are those of `fit`, and are the same for all curves. A curve that cannot be read or fitted separately is
    part of the result (``Fits.failed``) and of its warnings; a joint fit requires all curves.

    Parameters
    ----------
    curves
        A list of files or tables, or a dictionary of them by names.
    system
        The system with the initial values; a list of systems, one for every curve, for curves that were measured on several surfaces, such as
        pillars and a flat reference of the same material.
    joint
        Whether all curves are fitted together: shared parameters have one value, the others a value for every curve.
    shared
        The shared parameters of a joint fit; by default all keys of the case, except for the position of the lens axis.
    threads
        Number of threads, which share the curves; 0 for all processors, which is the maximum.
    progress
        Called with the number of curves done and the number of curves.

    Raises
    ------
    FitError
        If no curve can be read or fitted, or the parameters are invalid; with ``joint``, if one of the curves cannot be read or
        fitted, or if they contain different quantities.
    NotConverged
        If a joint search did not converge; ``result`` contains the last iterate.
    """
    check_parameters(free, starts)
    if isinstance(shared, str):
        raise TypeError(f'shared is the text "{shared}": give a list of names')
    if shared is not None and not joint:
        raise TypeError("shared needs joint=True")
    run = options(threads, progress, memory_limit, "done, curves")
    given: list[tuple[str, tuple[_fakir.Data, Instrument] | None, str, _Case | None]] = []
    understood: list[list[str]] = []
    pairs = named(curves)
    systems: list[AnySystem] = list(system) if isinstance(system, Sequence) else [system]
    if len(systems) not in (1, len(pairs)):
        raise ValueError(f"{len(systems)} systems for {len(pairs)} curves: give one for all, or one for every curve")
    first = case_of(systems[0])
    owns: list[_Case | None] = [None] * len(pairs)
    if len(systems) > 1:
        owns = [case_of(one) for one in systems]
    for (name, measurements), own in zip(pairs, owns, strict=True):
        try:
            raw, data, instrument = prepared(
                measurements,
                has_pauses=_fakir.has_relaxation(own or first, list(free)),
                columns=columns,
                spring_constant=spring_constant,
                rows=rows,
                cycle=cycle,
                branch=branch,
                between=between,
                position_error=position_error,
                force_error=force_error,
                contact_radius_error=contact_radius_error,
                contact_point=contact_point,
                machine_compliance=machine_compliance,
                force_offset=force_offset,
                displacement_drift=displacement_drift,
                force_drift=force_drift,
                force_slope=force_slope,
            )
        except FitError as error:
            if joint:
                raise
            given.append((name, None, str(error), own))
            understood.append([])
        else:
            given.append((name, (data, instrument), "", own))
            understood.append(raw.understood())
    warn_of_interactions(first, "fit", depth=1)
    if joint:
        names = None if shared is None else list(shared)
        together = _fakir.fit_jointly(first, given, list(free), names, starts, run)
        found = JointFit(together, understood)
        warn(together.warnings, depth=1)
        if not found.converged:
            raise NotConverged(f"the joint fit {found._summary['termination']}", found)
        return found
    fitted = _fakir.fit_curves(first, given, list(free), starts, run)
    result = Fits(fitted, understood)
    if all(curve.fit is None for curve in result.curves):
        raise FitError("; ".join(dict.fromkeys(str(curve.problem) for curve in result.curves)))
    warn(fitted.warnings, depth=1)
    return result


def named(curves: Curves) -> list[tuple[str, Measurements]]:
    """Curves with their names: those given, the paths of files, or numbers from 1."""
    if isinstance(curves, (str, PathLike)):
        raise TypeError(f"curves is the file {fspath(curves)!r}: give a list of files, or use fakir.fit")
    if isinstance(curves, Mapping):
        pairs = [(str(name), one) for name, one in curves.items()]
    elif isinstance(curves, Sequence):
        pairs = [(_name(one, number), one) for number, one in enumerate(curves, 1)]
    else:
        raise TypeError(
            f"curves is of type {type(curves).__name__}: give a list of files or tables, or a dictionary of them by names"
        )
    if not pairs:
        raise ValueError("curves is empty: give one or more files or tables")
    names = [name for name, _ in pairs]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"{twice} is given twice: give every curve once")
    return pairs


def _name(measurements: Measurements, number: int) -> str:
    return fspath(measurements) if isinstance(measurements, (str, PathLike)) else f"curve {number}"


def _statistics(given: Mapping[str, Any]) -> Statistics:
    suffix = next(name.removeprefix("median") for name in given if name.startswith("median"))
    return Statistics(
        curves=given["curves"],
        mean=given[f"mean{suffix}"],
        standard_deviation=given[f"standard_deviation{suffix}"],
        standard_error=given[f"standard_error_of_mean{suffix}"],
        median=given[f"median{suffix}"],
        weighted_mean=given[f"weighted_mean{suffix}"],
        weighted_standard_error=given[f"standard_error_of_weighted_mean{suffix}"],
        p_value=given["agreement_p_value"],
        outliers=[
            Outlier(one["file"], one[f"value{suffix}"], one["modified_z_score"]) for one in given["outliers"]
        ],
        unit=UNITS.get(suffix.removeprefix("_"), ""),
    )
