"""Fits of moduli, sizes, works of adhesion and instrument parameters to measured curves."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, Union

import numpy as np

from . import _fakir
from ._asperities import AsperityArray
from ._flat import FlatSystem
from ._format import Row, engineering
from ._quantity import UNITS as SI_UNITS
from ._quantity import Dimension, FloatArray, Quantity, WithUnit, finite, without_mask
from ._result import Limit, Result
from ._run import Progress, options, warn, warn_of_interactions
from ._system import System
from .bem import Surface
from .errors import FitError, NotConverged

if TYPE_CHECKING:
    import pandas

Measurements: TypeAlias = Union[str, PathLike[str], Mapping[str, Any], "pandas.DataFrame", Any]
"""A table as written by instruments, or its columns: a dictionary, a table of pandas, a dataset of xarray, a structured array
of NumPy, or a curve of afmformats."""

UNITS = {
    "J_per_m2": "J/m^2",
    "Pa": "Pa",
    "m_per_N": "m/N",
    "N_per_m": "N/m",
    "N": "N",
    "rad": "rad",
    "m": "m",
}
"""Suffixes of names, and the corresponding units."""


class Estimate(NamedTuple):
    """A fitted parameter, in SI units."""

    value: float
    """The fitted value. Meaningless by itself if the data do not determine it."""
    standard_error: float | None
    """The standard error; ``None`` if the data do not determine the parameter."""
    interval: tuple[float, float] | None
    """Ends of the 95 % confidence interval; None if the data do not determine the parameter."""
    start: float
    """The initial value."""
    unit: str
    """The unit: ``"Pa"``, ``"m"``, ``"m/N"``, ``"N"``, ``"J/m^2"`` or ``"rad"``; ``""`` for plain numbers."""
    one_sided: bool = False
    """Whether the interval starts at the smallest possible value of the parameter, so that the data determine only its upper end:
    for a work of adhesion that is compatible with zero."""

    @property
    def determined(self) -> bool:
        """Whether the data determine the parameter."""
        return self.interval is not None


class FittedPullOff(NamedTuple):
    """Pull-off of the data and of the fitted cycle."""

    measured: float
    """The smallest measured force minus the offset of the instrument, N."""
    fitted: float
    """Pull-off force of the cycle, N."""
    model_error: float
    """Relative model error of that force, due to the shapes of partial contacts."""
    work_error: float | None
    """The corresponding error of the work of adhesion, which is not included in its interval. None if no work was fitted."""


class RunsTest(NamedTuple):
    """Number of sign changes of the residuals of a quantity, in the order of the load."""

    quantity: str
    """``"force"`` or ``"contact radius"``."""
    branch: str
    """``"loading"`` or ``"unloading"``."""
    runs: int
    """Number of runs of residuals of the same sign."""
    expected: float
    """Expected number of runs."""
    p_value: float
    """Probability of at most this many runs by chance."""


class LeftOut(NamedTuple):
    """A fixed parameter, and its test against the data."""

    name: str
    """The parameter."""
    p_value: float
    """p-value of the score test: the probability of such residuals if the fixed value is correct."""
    value: float | None
    """Approximate fitted value, in SI units; None if it is far away."""
    wanted: bool
    """Whether the fit does not describe the data unless the parameter is free."""


class Fit(Result):
    """Result of a fit."""

    _titles = ("fakir.Fit", "Fit")

    def __init__(self, fitted: _fakir.Fitted, understood: Sequence[str] = ()) -> None:
        self._fitted = fitted
        self._understood = list(understood)
        self._summary = json.loads(fitted.json())

    @property
    def parameters(self) -> dict[str, Estimate]:
        """The fitted parameters by name."""
        return {given["name"]: estimate(given) for given in self._summary["parameters"]}

    def __getitem__(self, name: str) -> Estimate:
        return self.parameters[name]

    @property
    def system(self) -> System | FlatSystem | AsperityArray | Surface:
        """The system with the fitted values."""
        case = self._fitted.case
        if isinstance(case, _fakir.Surface):
            return Surface._of(case)
        if isinstance(case, _fakir.Asperities):
            return AsperityArray._of(case)
        return FlatSystem._of(case) if isinstance(case, _fakir.Flat) else System._of(case)

    @property
    def correlation(self) -> FloatArray:
        """Correlation matrix of the parameters; NaN for parameters that are not determined."""
        return np.array(self._summary["correlation"], dtype=float)

    @property
    def undetermined(self) -> list[str]:
        """A sentence for every quantity that the data do not determine."""
        return [given["statement"] for given in self._summary["undetermined"]]

    @property
    def contact_point(self) -> float | None:
        """Displacement at which the lens meets the pillar tops, m; None without displacements."""
        return _optional(self._summary["contact_point_m"])

    @property
    def machine_compliance(self) -> float | None:
        """Compliance of the instrument, m/N; None without displacements."""
        return _optional(self._summary["machine_compliance_m_per_N"])

    @property
    def force_offset(self) -> float:
        """Reading of the instrument at zero force, N."""
        return float(self._summary["force_offset_N"])

    @property
    def displacement_drift(self) -> float:
        """Drift of the displacement from the first row to the last, m."""
        return float(self._summary["displacement_drift_m"])

    @property
    def force_drift(self) -> float:
        """Drift of the force from the first row to the last, N."""
        return float(self._summary["force_drift_N"])

    @property
    def force_slope(self) -> float:
        """Slope of the reading without any force over the displacement, N/m."""
        return float(self._summary["force_slope_N_per_m"])

    @property
    def describes_data(self) -> bool:
        """Whether no test rejects the fit: runs of residuals, chi-square, and fixed parameters."""
        return bool(self._summary["describes_data"])

    @property
    def runs(self) -> list[RunsTest]:
        """The runs tests of the residuals."""
        names = ("quantity", "branch", "runs", "expected_runs", "p_value")
        return [RunsTest(*(test[name] for name in names)) for test in self._summary["tests"]["runs"]]

    @property
    def chi_square_p_value(self) -> float | None:
        """Probability of a chi-square at least as large by chance; None if errors are estimated."""
        return _optional(self._summary["tests"]["chi_square_p_value"])

    @property
    def left_out(self) -> list[LeftOut]:
        """The fixed parameters, the one most likely to be wrong first."""
        return [
            LeftOut(
                name=given["name"],
                p_value=given["p_value"],
                value=next(value for name, value in given.items() if name.startswith("value")),
                wanted=given["wanted"],
            )
            for given in self._summary["tests"]["left_out"]
        ]

    @property
    def limits(self) -> list[Limit]:
        """The validity limits of the model, evaluated for the fitted system under the largest load.

        ``any(limit.strained for limit in fit.limits)`` is true if a limit is exceeded.
        """
        return [Limit(**limit) for limit in self._summary["limits"]]

    @property
    def understood(self) -> list[str]:
        """How every column of the data was interpreted, one line each."""
        return list(self._understood)

    @property
    def pull_off(self) -> FittedPullOff | None:
        """Pull-off of the data and of the fitted cycle; None without adhesion or unloading."""
        given = self._summary.get("pull_off")
        if given is None:
            return None
        return FittedPullOff(
            float(given["measured_force_N"]),
            float(given["fitted_force_N"]),
            float(given["relative_error_of_model"]),
            _optional(given["relative_error_of_work"]),
        )

    @property
    def chi_square(self) -> float:
        """Sum of squares of (measured - computed)/error."""
        return float(self._summary["chi_square"])

    @property
    def degrees_of_freedom(self) -> int:
        """Number of values minus number of parameters."""
        return int(self._summary["degrees_of_freedom"])

    @property
    def reduced_chi_square(self) -> float | None:
        """Chi-square per degree of freedom; None if errors are estimated so as to make it 1."""
        return _optional(self._summary["reduced_chi_square"])

    @property
    def converged(self) -> bool:
        """Whether the search converged and every contact is solved."""
        return bool(self._summary["converged"])

    @property
    def load(self) -> str:
        """The column of `to_pandas` that is used as the load."""
        return self._fitted.load

    @property
    def compared(self) -> list[str]:
        """The quantities compared with the model: ``"force_N"``, ``"contact_radius_m"``."""
        return [{"force": "force_N"}.get(name, f"{name}_m") for name in self._fitted.compared]

    @property
    def curve(self) -> dict[str, FloatArray]:
        """The computed curve over the range of the data, by columns: the load, ``force_N``, ``contact_radius_m``."""
        at, force, contact_radius = self._fitted.curve()
        return {self.load: at, "force_N": force, "contact_radius_m": contact_radius}

    @property
    def unloading(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Whether points of the curve belong to the unloading, with adhesive tops."""
        return self._fitted.unloading()

    def columns(self) -> dict[str, Any]:
        """Data and model, by the columns of ``fitted.csv``."""
        return dict(self._fitted.table())

    def to_pandas(self) -> pandas.DataFrame:
        """Data and model: the columns of ``fitted.csv``."""
        import pandas

        return pandas.DataFrame(self.columns())

    def _rows(self) -> list[Row]:
        rows = []
        for name, estimate in self.parameters.items():
            value = written(estimate.value, estimate.unit)
            if estimate.interval is None:
                rows.append((name, f"{value}: not determined by the data"))
                continue
            low, high = (written(end, estimate.unit) for end in estimate.interval)
            kind = "one-sided 95 % interval" if estimate.one_sided else "95 % interval"
            rows.append((name, f"{value}, {kind} {low} to {high}"))
        reduced = self.reduced_chi_square
        scatter = "scatter estimated" if reduced is None else f"reduced chi-square {reduced:.3g}"
        if self.pull_off is not None:
            measured, fitted, model, of_work = self.pull_off
            error = f"error of the model {model:.1g}"
            if of_work is not None:
                error += f", {of_work:.1g} of the work"
            text = f"{engineering(measured, 'N', 3)} measured, {engineering(fitted, 'N', 3)} fitted"
            rows.append(("pull-off", f"{text}; {error}"))
        rows.append(("residuals", f"{self.degrees_of_freedom} degrees of freedom, {scatter}"))
        if not self.describes_data:
            wanted = [left.name for left in self.left_out if left.wanted]
            text = f"most likely wrong: {wanted[0]}" if wanted else "the residuals are not random"
            rows.append(("does not describe the data", text))
        return rows


def fit(
    measurements: Measurements,
    system: System | FlatSystem | AsperityArray | Surface,
    free: Sequence[str],
    *,
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
    progress: Progress | None = None,
    memory_limit: int | None = None,
) -> Fit:
    """Fits parameters to a measured curve by least squares.

    With adhesion in ``system``, or ``"adhesion.work"`` free, the data are one cycle of loading and unloading.

    Parameters
    ----------
    measurements
        A table as written by instruments, or its columns of equal length, with NaN or empty cells for missing measurements: at
        least two of ``displacement_m`` (reading of the instrument) or ``indentation_m``, ``force_N`` and ``contact_radius_m``,
        and their standard errors ``force_error_N`` and so on; other units are accepted, as in ``displacement_um`` or
        ``Load [mN]``. With adhesion, ``branch`` contains ``"loading"`` or ``"unloading"``; without it unloading begins after the
        largest load. ``time_s`` contains the time: with viscoelastic bodies the rows are one history of ramps and holds, between
        which the indentation is linear in time. Columns with pint units need no unit in their name: ``"force"``. Columns that
        are not recognised are not used: see `Fit.understood`. Objects of pandas, xarray (with units in ``attrs["units"]``) and
        afmformats (a whole curve, of which approach and retract are used) are accepted, and structured arrays of NumPy.
    system
        All other quantities: pillars with flat or rounded tops of a case file, a `fakir.bem.Surface` of a case file, or a flat surface. Its values of the free parameters are the initial values.
    free
        Keys such as ``"substrate.young_modulus"``, ``"substrate.thickness"`` or ``"pattern.offset"``, of rounded tops
        ``"pattern.top_radius"``, of a height map ``"surface.height_unit"``; ``"adhesion.work"`` and ``"adhesion.work_receding"`` with data of the unloading; ``"force_offset"``, ``"force_drift"``; and, with
        displacements, ``"contact_point"``, ``"machine_compliance"``, ``"displacement_drift"`` and ``"force_slope"``. With a
        relaxation and times ``"relaxation.strengths[0]"``, ``"relaxation.times[0]"`` and those of further terms, up to ``[3]``.
    contact_point
        Displacement (m) at which the lens would touch the pillar tops, or its initial value.
    machine_compliance
        Compliance of the instrument (m/N), or its initial value. Default: 0, or the compliance of the cantilever.
    force_offset
        Reading of the instrument at zero force (N), or its initial value; contained in all measured forces.
    displacement_drift, force_drift
        Drift of the readings from the first row to the last (m, N), or its initial value: linear in time if there is a column of
        times, otherwise in the row number.
    force_slope
        Slope of the reading without any force over the displacement from the first row on (N/m), or its initial value: a tilted
        base line.
    starts
        Number of starting points of the search, the first of which is the system; the best fit is returned.
    columns
        Explicitly assigned columns, headings by quantities: ``{"force": "Channel 2 [mN]"}``. ``"#2 [mN]"`` is the second column,
        and a minus sign before the heading reverses the sign of its values; ``"Deflection [V]*25 nN/V"`` converts them by a sensitivity.
    spring_constant
        Spring constant (N/m) of a cantilever: its deflection is read as the force.
    rows, cycle, branch, between
        Rows to be used: the first and the last one (from 1, or ``None``), one cycle of loading and unloading (from 1),
        ``"loading"`` or ``"unloading"``, and the smallest and the largest load (a position, or a force if there is none).
    position_error, force_error, contact_radius_error
        Standard errors (m, N, m) of quantities without errors in the columns. Without any they are estimated from the residuals.

    Raises
    ------
    FitError
        If the data or the parameters are invalid.
    NotConverged
        If the search did not converge; ``result`` contains the last iterate.
    """
    check_parameters(free, starts)
    raw, data, instrument = prepared(
        measurements,
        has_pauses=_fakir.has_relaxation(case_of(system), list(free)),
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
    run = options(threads, progress, memory_limit)
    warn_of_interactions(case_of(system), "fit", depth=1)
    fitted = _fakir.fit(case_of(system), data, list(free), instrument, starts, run)
    result = Fit(fitted, raw.understood())
    warn(result._fitted.warnings, depth=1)
    if not result.converged:
        raise NotConverged(f"the fit {result._summary['termination']}", result)
    return result


def case_of(
    system: System | FlatSystem | AsperityArray | Surface,
) -> _fakir.Case | _fakir.Flat | _fakir.Asperities | _fakir.Surface:
    """The case of a system that can be fitted."""
    if isinstance(system, Surface):
        return system._surface
    if isinstance(system, AsperityArray):
        return system._asperities
    return system._flat if isinstance(system, FlatSystem) else system._case


Instrument: TypeAlias = tuple[float | None, float, float, float, float, float]
"""Contact point, machine compliance, force offset, drifts of displacement and force, and force slope."""


def check_parameters(free: Sequence[str], starts: int) -> None:
    """Raises an error for names that are not a list, and for an invalid number of starts."""
    if isinstance(free, str):
        raise TypeError(f'free is the text "{free}": give a list of names')
    if isinstance(starts, bool) or not isinstance(starts, int) or starts < 1:
        raise ValueError(f"starts is {starts!r}: give a number from 1 to 32")


def prepared(
    measurements: Measurements,
    *,
    has_pauses: bool,
    columns: Mapping[str, str] | None,
    spring_constant: Quantity | None,
    rows: tuple[int | None, int | None] | None,
    cycle: int | None,
    branch: str | None,
    between: tuple[Quantity | None, Quantity | None] | None,
    position_error: Quantity | None,
    force_error: Quantity | None,
    contact_radius_error: Quantity | None,
    contact_point: Quantity | None,
    machine_compliance: Quantity | None,
    force_offset: Quantity,
    displacement_drift: Quantity,
    force_drift: Quantity,
    force_slope: Quantity,
) -> tuple[_fakir.Data, _fakir.Data, Instrument]:
    """The data as read and selected, the same with the given errors, and the values of the instrument."""
    errors = [
        error_of(position_error, "length", "position_error"),
        error_of(force_error, "force", "force_error"),
        error_of(contact_radius_error, "length", "contact_radius_error"),
    ]
    if rows is not None and any(row is not None and row < 1 for row in rows):
        raise ValueError(f"rows is {rows}: rows are counted from 1")
    constant = _of_unit(spring_constant, "N/m", "spring_constant")
    last_row = None if rows is None else rows[1]
    raw = _data(measurements, dict(columns or {}), constant, last_row, has_pauses)
    dimension = raw.load_dimension()
    ends = [None if end is None else finite(end, dimension, "between") for end in between or (None, None)]
    raw = raw.select(list(rows or (None, None)), cycle, branch, ends)
    data = raw.with_errors(*errors)
    compliance = _of_unit(machine_compliance, "m/N", "machine_compliance")
    if compliance is None:
        compliance = raw.cantilever_compliance() or 0.0
    instrument = (
        None if contact_point is None else finite(contact_point, "length", "contact_point"),
        compliance,
        finite(force_offset, "force", "force_offset"),
        finite(displacement_drift, "length", "displacement_drift"),
        finite(force_drift, "force", "force_drift"),
        _of_unit(force_slope, "N/m", "force_slope") or 0.0,
    )
    return raw, data, instrument


def _data(
    measurements: Measurements,
    named: Mapping[str, str],
    spring_constant: float | None,
    last_row: int | None = None,
    has_pauses: bool = False,
) -> _fakir.Data:
    by_hand = [(str(quantity), str(heading)) for quantity, heading in named.items()]
    if isinstance(measurements, (str, PathLike)):
        return _fakir.Data.read(fspath(measurements), by_hand, spring_constant, last_row, has_pauses)
    if _is_of_afmformats(measurements):
        spring_constant = _spring_constant(measurements, spring_constant)
    return _fakir.Data.of(columns_of(measurements), by_hand, spring_constant)


def columns_of(measurements: Any) -> list[tuple[str, FloatArray | None]]:
    """Headings and values of whatever has columns; None for columns that are not numeric."""
    return [_column(str(name), values) for name, values in _items(measurements)]


def _items(measurements: Any) -> list[tuple[str, Any]]:
    """Headings and values of whatever has columns."""
    if _is_of_afmformats(measurements):
        return _of_afmformats(measurements)
    if hasattr(measurements, "to_dataset"):  # an array of xarray
        measurements = measurements.to_dataset(name=measurements.name or "values")
    variables = getattr(measurements, "variables", None)
    if isinstance(variables, Mapping):  # a dataset of xarray, whose coordinates are columns too
        return [(_with_unit(str(name), it.attrs.get("units")), it.values) for name, it in variables.items()]
    names = getattr(getattr(measurements, "dtype", None), "names", None)
    if names:  # a structured array of NumPy
        return [(name, measurements[name]) for name in names]
    items = getattr(measurements, "items", None)
    if items is None:
        try:
            is_group = _is_of_afmformats(measurements[0])
        except (TypeError, LookupError):
            is_group = False
        advice = (
            "give one of its curves, as curves[0]"
            if is_group
            else "give the path of a file, a dictionary or table of columns, or a whole curve of afmformats; "
            "fakir.fit_many fits several curves"
        )
        raise TypeError(f"measurements are of type {type(measurements).__name__}: {advice}")
    return list(items())


def _with_unit(name: str, unit: str | None) -> str:
    return f"{name} [{unit}]" if unit else name


def _is_of_afmformats(curve: Any) -> bool:
    """Whether an object is a curve of afmformats."""
    return hasattr(curve, "metadata") and hasattr(curve, "columns") and not hasattr(curve, "items")


def _position_of(curve: Any) -> str | None:
    """The column of positions of a curve of afmformats."""
    there = set(curve.columns)
    return next((name for name in ("tip position", "height (measured)", "height (piezo)") if name in there), None)


def _spring_constant(curve: Any, given: float | None) -> float | None:
    """The spring constant (N/m) of the cantilever of a curve of afmformats; None if its deflection is not in the positions."""
    if _position_of(curve) == "tip position":
        return None
    if given is not None:
        return given
    constant = float(curve.metadata.get("spring constant", np.nan))
    return constant if np.isfinite(constant) and constant > 0.0 else None


def _of_afmformats(curve: Any) -> list[tuple[str, Any]]:
    """The columns of a curve of afmformats, which are in SI units; its positions decrease as the tip moves down."""
    there = set(curve.columns)
    position = _position_of(curve)
    missing = [name for name, found in (("force", "force" in there), ("tip position", position)) if not found]
    if missing:
        raise FitError(f"the curve has no {' and no '.join(missing)}: its columns are {', '.join(sorted(there))}")
    items = [
        ("displacement_m", -np.asarray(curve[position], dtype=float)),
        ("force_N", np.asarray(curve["force"], dtype=float)),
    ]
    if "time" in there:
        items.append(("time_s", np.asarray(curve["time"], dtype=float)))
    if "segment" not in there:
        return items
    # Numbers of the segments depend on the kind of the curve: creep and relaxation have pauses between approach and retract.
    loading, unloading = (
        int(getattr(getattr(curve, name, None), "segment", otherwise))
        for name, otherwise in (("appr", 0), ("retr", 1))
    )
    segment = np.asarray(curve["segment"]).astype(int)
    used = (segment == loading) | (segment == unloading)
    items = [(name, values[used]) for name, values in items]
    branches = np.where(segment[used] == unloading, "unloading", "loading")
    items.append(("branch", branches.astype(object)))
    return items


def _measured(values: WithUnit, name: str) -> tuple[Dimension, Any]:
    """What a quantity of pint measures, by its unit, and its values in SI units."""
    dimensions: tuple[Dimension, ...] = ("length", "force", "time")
    for dimension in dimensions:
        try:
            return dimension, values.to(SI_UNITS[dimension]).magnitude
        except Exception:  # pint's errors have no class in common with those of similar libraries
            continue
    raise ValueError(f"{name} is in {getattr(values, 'units', 'another unit')}: give a quantity in m, N or s")


def _without_unit_in(name: str, dimension: Dimension) -> str:
    """The name of a column without the unit at its end: the quantity has its own."""
    start, _, end = name.rpartition("_")
    try:
        _fakir.parse_quantity(f"1 {end}", dimension)
    except ValueError:
        return name
    return start or name


def _column(name: str, values: Any) -> tuple[str, FloatArray | None]:
    """Heading and values, with NaN for missing measurements. The values are None for a column that is not numeric, which cannot
    be used."""
    if isinstance(values, WithUnit):
        dimension, values = _measured(values, name)
        name = f"{_without_unit_in(name, dimension)}_{SI_UNITS[dimension]}"
    found = without_mask(values) if name != "branch" else np.asarray(values)
    if name == "branch":
        branches = np.asarray(found, dtype=object)
        loading, unloading = branches == "loading", branches == "unloading"
        if found.ndim != 1 or not (loading | unloading).all():
            raise FitError('branch: give "loading" or "unloading" for every row')
        return name, np.ascontiguousarray(unloading, dtype=np.float64)
    if found.ndim != 1 or found.dtype.kind not in "fiu" or found.dtype.itemsize > 8:
        return name, None
    return name, np.ascontiguousarray(found, dtype=np.float64)


def error_of(given: Quantity | None, dimension: Any, name: str) -> float | None:
    """A standard error in SI units, if it is given."""
    if given is None:
        return None
    error = finite(given, dimension, name)
    if error <= 0.0:
        raise ValueError(f"{name} is {error}: it must be greater than 0")
    return error


def _of_unit(given: Quantity | None, unit: str, name: str) -> float | None:
    """A number in its unit, or a quantity of pint."""
    if given is None:
        return None
    if isinstance(given, WithUnit):
        try:
            return float(given.to(unit).magnitude)
        except Exception as error:
            raise ValueError(f"{name}: {error}; give a quantity in {unit}") from error
    if isinstance(given, str):
        raise TypeError(f"{name} is a text: give a number in {unit}, or a pint quantity")
    return finite(given, "number", name)


def estimate(given: Mapping[str, Any]) -> Estimate:
    """An estimate of the JSON object."""
    suffix = next(name.removeprefix("value") for name in given if name.startswith("value"))
    error = given[f"standard_error{suffix}"]
    ends = given[f"confidence_interval_95{suffix}"]
    return Estimate(
        value=given[f"value{suffix}"],
        standard_error=error,
        interval=None if ends is None else (ends[0], ends[1]),
        start=given[f"start{suffix}"],
        unit=UNITS.get(suffix.removeprefix("_"), ""),
        one_sided=bool(given["one_sided"]),
    )


def written(value: float, unit: str) -> str:
    """A value with its unit."""
    return f"{value:.4g} {unit}".strip() if unit not in {"m", "Pa", "N", "J/m^2"} else engineering(value, unit, 4)


def _optional(value: Any) -> float | None:
    return None if value is None else float(value)
