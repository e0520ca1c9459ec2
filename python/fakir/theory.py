"""Closed forms: formulas for the critical state, lattice sums, the phase diagram.

The formulas are those of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104, 055007 (2021), as printed and
as corrected. They apply to a lens axis on a pillar, without adhesion. Those for adhesive pillar tops are in `adhesion`, those for
an adhesive floor in `free_annulus`, `annulus_radius`, `largest_tension`, `collapse_threshold`, `net_work`,
`stuck_floor_pull_off`, `patch` and `Grooves`. Numbers are in SI units, and radii in lattice sums in pitches.
"""

from __future__ import annotations

import json
import math
import warnings
from typing import Any, NamedTuple

import numpy as np

from . import _fakir
from ._quantity import Quantity, array, si
from ._run import options
from ._system import System

__all__ = [
    "AdhesionTheory",
    "AdhesiveSphere",
    "AnnulusCoefficients",
    "CollapseThreshold",
    "CollapsedCycle",
    "Constants",
    "FreeAnnulus",
    "GrooveThreshold",
    "Grooves",
    "LargestTension",
    "LatticeSums",
    "Phase",
    "PullOffEstimate",
    "TransitionEstimate",
    "adhesion",
    "annulus_coefficients",
    "annulus_radius",
    "closed_forms",
    "collapse_threshold",
    "collapsed_cycle",
    "constants",
    "fit_sum_coefficients",
    "fitted_lattice_sums",
    "free_annulus",
    "hertz_contact_radius",
    "hollow_potential",
    "inverse_power_sum",
    "large_contact",
    "largest_tension",
    "lattice_potential",
    "lattice_sums",
    "net_work",
    "one_pillar",
    "patch",
    "phase",
    "site_potential",
    "small_contact",
    "stuck_floor_pull_off",
    "sum_coefficients",
    "to_dict",
    "transition_force",
    "transition_from_exact_sums",
]


def __getattr__(name: str) -> Any:
    """Looks up a class by its deprecated name."""
    if name != "StickySphere":  # former name
        raise AttributeError(f"module 'fakir.theory' has no attribute {name!r}")
    warnings.warn("fakir.theory.StickySphere is now called fakir.theory.AdhesiveSphere", FutureWarning, stacklevel=2)
    return AdhesiveSphere


class TransitionEstimate(NamedTuple):
    """A critical state from a formula."""

    force: float
    """Critical force, N."""
    indentation: float
    """Critical indentation, m."""
    top_contact_radius: float
    """Radius of the contact on the pillar tops, m."""
    floor_contact_distance: float
    """Distance of the floor contact from the lens axis, m."""

    @property
    def contact_radius(self) -> float:
        """Critical contact radius: the larger of the two radii, m."""
        return max(self.top_contact_radius, self.floor_contact_distance)


class Constants(NamedTuple):
    """Constants of a system."""

    reduced_modulus: float
    """1/c, Pa."""
    internal_compliance: float
    """gamma_int, 1/Pa."""
    external_compliance: float
    """gamma_ext, 1/Pa."""
    column_compliance_ratio: float
    """4 h/(pi E_s d c)."""
    small_contact_limit: float
    """Surface fraction below which the lens touches only one pillar, by the paper's criterion."""
    homogenised_limit: float
    """Surface fraction below which the homogenised lattice applies."""
    central_force_amplification: float
    """S, the reduced force on the central pillar at the transition."""


CONSTANT_UNITS = {
    "reduced_modulus": "_Pa",
    "internal_compliance": "_per_Pa",
    "external_compliance": "_per_Pa",
}
"""Units in the names of ``fakir theory --json``."""


class PullOffEstimate(NamedTuple):
    """A pull-off force from a formula."""

    force: float
    """Force, N, negative."""
    normalized_force: float
    """Ratio to the force of a single flat pillar."""
    indentation: float | None
    """Indentation, m; None if the formula does not provide it."""
    contact_radius: float | None
    """Contact radius, m; None if the formula does not provide it."""
    tilt: float | None
    """Angle between lens and pillar top, rad, for the formula that includes it."""


class AdhesionTheory(NamedTuple):
    """Closed forms for adhesive pillar tops."""

    pull_off: dict[str, PullOffEstimate]
    """Pull-off forces by name of the formula."""
    kendall_strain: float
    """Stress on a flat pillar at pull-off divided by the modulus of the substrate; doubtful above 0.3."""
    tabor_number: float | None
    """Tabor number of a pillar top, if the range of the attraction is given: the short-range assumption is valid above 5."""


class AnnulusCoefficients(NamedTuple):
    """A detached annulus around a pillar of unit radius, in units of the reduced modulus: a step h opens it, a remote pressure p
    closes it."""

    force_per_step: Any
    """F1: the force on the pillar is F1 h + V1 p."""
    volume_per_step: Any
    """V1: the volume of the annulus is V1 h - D p."""
    volume_per_pressure: Any
    """D."""
    intensity_per_step: Any
    """K1: the stress intensity factor at the outer edge is K1 h - K2 p."""
    intensity_per_pressure: Any
    """K2."""


class FreeAnnulus(NamedTuple):
    """A detached annulus around a pillar of a floor that adheres to the lens."""

    outer_radius: float
    """Outer radius, m."""
    step: float
    """Height difference between floor and top with the column shortened, m."""
    pillar_force: float
    """Force on the pillar, N."""
    opened_volume: float
    """Volume between lens and floor, m^3."""
    stress_intensity: float
    """Stress intensity factor at the outer edge, Pa m^(1/2); negative if the annulus closes."""
    energy_release_rate: float
    """Energy release rate at the outer edge, J/m^2."""
    energy: float
    """Energy, J."""


class LargestTension(NamedTuple):
    """The tension above which the annulus around a pillar grows without bound."""

    tension: float
    """Tension, Pa, positive."""
    annulus_radius: float
    """Radius of the annulus at that tension, m."""


class CollapseThreshold(NamedTuple):
    """Collapse of a flat lattice at zero load."""

    work: float
    """Work of adhesion, J/m^2."""
    annulus_radius: float
    """Outer radius of the detached annuli at that work, m."""


class CollapsedCycle(NamedTuple):
    """Loading and unloading of a floor that adheres inside a circle, while it adheres.

    In range, the error of the force is 2 to 8 % of the force on the tops alone, that of the area 10 to 15 %, and that of a
    pull-off force 10 %.
    """

    unloading: Any
    """Whether a load step belongs to the unloading."""
    indentation: Any
    """Indentation, m."""
    front_radius: Any
    """Radius of the circle, m."""
    force: Any
    """Force, N."""
    energy: Any
    """Energy, J."""
    floor_area: Any
    """Adhering area of the floor, m^2."""
    pillars_in_contact: Any
    """Number of pillars inside the circle plus adhesive tops in contact outside."""
    widest_annulus: Any
    """Outer radius of the widest detached annulus, m."""
    in_range: Any
    """Whether annuli are below 0.3 pitches and the front is beyond 2 pitches; otherwise the model is out of range."""
    floor_lost: float | None
    """First indentation of the unloading at which the floor no longer adheres, m; None if it still does."""


class AdhesiveSphere(NamedTuple):
    """A circular contact of an adhesive sphere."""

    radius: float
    """Contact radius, m."""
    force: float
    """Force, N."""
    indentation: float
    """Indentation, m."""


class GrooveThreshold(NamedTuple):
    """Collapse of grooves."""

    work: float
    """Work of adhesion, J/m^2."""
    strip_width: float
    """Width of the adhering strip in every groove, m."""


class LatticeSums(NamedTuple):
    """The sums over all pillars except the central one, or their fitted coefficients."""

    displacement: Any
    """G0."""
    force: Any
    """G."""
    curvature: Any
    """G1."""


class Phase(NamedTuple):
    """A point of the phase diagram."""

    region: str
    """``"top"``: on pillar tops only; ``"mixed"``: on the floor too."""
    deterministic: bool
    """Whether force and radius determine the region; within a pitch it depends on the position of the lens."""


def closed_forms(system: System) -> dict[str, TransitionEstimate]:
    """The critical state by every formula that can be evaluated for the system."""
    forms = _fakir.closed_forms(system._case)
    return {name: TransitionEstimate(*estimate) for name, estimate in forms}


def adhesion(system: System, attraction_range: Quantity | None = None) -> AdhesionTheory:
    """Pull-off forces of single contacts of an adhesive system, in closed form.

    ``"kendall"``: one pillar with a flat top (K. Kendall, J. Phys. D 4, 1186 (1971)); ``"pillar_under_lens"``: the same under the
    round lens; ``"tilted_pillar_first_yield"``: first detachment at the rim of a tilted top; ``"jkr_by_force"`` and
    ``"jkr_by_displacement"``: the lens on the bare substrate (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301
    (1971)); with a range of attraction ``"maugis_dugdale"``: the same with that range (D. Maugis, J. Colloid Interface Sci. 150,
    243 (1992)).

    Parameters
    ----------
    attraction_range
        The range of the attraction, m or with a unit: for the Tabor number and for Maugis's force.

    Raises
    ------
    ValueError
        If the system has no adhesion.
    """
    found = json.loads(_fakir.adhesion(system._case, _range(attraction_range)))
    if found is None:
        raise ValueError('no adhesion: give the system adhesion, as in adhesion="50 mJ/m2"')
    names = ("force_N", "normalized_force", "indentation_m", "contact_radius_m", "tilt_rad")
    forms = {
        row["formula"]: PullOffEstimate(*(row[name] for name in names)) for row in found["pull_off"]
    }
    return AdhesionTheory(forms, found["kendall_strain"], found["tabor_number"])


def _range(value: Quantity | None) -> float | None:
    return None if value is None else si(value, "length", "attraction_range")


def to_dict(system: System, attraction_range: Quantity | None = None) -> dict[str, Any]:
    """The object that ``fakir theory --json`` prints: all closed forms of a system."""
    return json.loads(_fakir.theory(system._case, _range(attraction_range)))  # type: ignore[no-any-return]


def small_contact(system: System) -> TransitionEstimate:
    """The paper's formulas for one pillar in contact."""
    return _form(system, "small_contact")


def one_pillar(system: System) -> TransitionEstimate:
    """One pillar in contact, with the exact distance of the floor contact."""
    return _form(system, "one_pillar")


def large_contact(system: System, form: str = "corrected") -> TransitionEstimate:
    """The paper's formulas for many pillars in contact, ``"corrected"`` or ``"as_printed"``."""
    if form not in {"corrected", "as_printed"}:
        raise ValueError(f'form is {form!r}: give "corrected" or "as_printed"')
    return _form(system, f"large_contact_{form}")


def transition_from_exact_sums(
    system: System, contact_radius: Quantity | None = None
) -> TransitionEstimate:
    """Lattice sums over a contact radius (m), by default that of the large-contact formula."""
    if contact_radius is None:
        return _form(system, "exact_lattice_sums")
    radius = si(contact_radius, "length", "contact_radius")
    return TransitionEstimate(*_fakir.transition_from_exact_sums(system._case, radius))


def constants(system: System) -> Constants:
    """Compliances and limits."""
    found = json.loads(_fakir.constants(system._case))
    return Constants(*(found[name + CONSTANT_UNITS.get(name, "")] for name in Constants._fields))


def transition_force(system: System, contact_radius: object) -> Any:
    """The transition curve: the force (N) at contact radii (m) at which the floor is touched."""
    radii = array(contact_radius, "length", "contact_radius")
    return _each(lambda radius: _fakir.transition_force(system._case, radius), radii)


def hertz_contact_radius(system: System, force: object) -> Any:
    """Contact radius (m) on a smooth surface under forces (N)."""
    forces = array(force, "force", "force")
    return _each(lambda force: _fakir.hertz_contact_radius(system._case, force), forces)


def phase(system: System, force: Quantity, contact_radius: Quantity) -> Phase:
    """Region of the phase diagram."""
    radius = si(contact_radius, "length", "contact_radius")
    return Phase(*_fakir.phase(system._case, si(force, "force", "force"), radius))


def lattice_sums(contact_radius: object) -> LatticeSums:
    """The exact sums over contact radii in pitches."""
    return _sums(_fakir.exact_lattice_sums, contact_radius)


def fitted_lattice_sums(contact_radius: object) -> LatticeSums:
    """The paper's fits to these sums."""
    return _sums(_fakir.fitted_lattice_sums, contact_radius)


def sum_coefficients(origin: str = "paper") -> LatticeSums:
    """C01, C1 and C11: those of the paper, or the exact ``"limit"`` of a wide contact."""
    if origin not in {"paper", "limit"}:
        raise ValueError(f'origin is {origin!r}: give "paper" or "limit"')
    found = _fakir.sum_coefficients(origin, (1.0, 32.0), 2)
    assert found is not None
    return LatticeSums(*found)


def fit_sum_coefficients(
    range: tuple[float, float] = (1.0, 32.0), samples: int = 497
) -> LatticeSums:
    """C01, C1 and C11 by least squares over a range of contact radii in pitches."""
    for radius in range:
        _check_radii(np.asarray(radius), "range")
    found = _fakir.sum_coefficients("least squares", range, samples)
    if found is None:
        raise ValueError(f"nothing to fit in the range {range} with {samples} samples")
    return LatticeSums(*found)


def inverse_power_sum(exponent: float) -> float:
    """Sum of r^-exponent over a unit hexagonal lattice without the origin, continued analytically; at 2 it has a pole."""
    if exponent == 2 or not math.isfinite(exponent):
        raise ValueError(f"exponent is {exponent}: give a finite number other than 2, where the sum diverges")
    return _fakir.inverse_power_sum(exponent)


def lattice_potential(x: object, y: object) -> Any:
    """Potential of a unit hexagonal lattice of unit charges in a neutralising background."""
    across, along = np.broadcast_arrays(array(x, "number", "x"), array(y, "number", "y"))
    values = [_fakir.lattice_potential(*point) for point in zip(across.flat, along.flat)]
    return np.array(values).reshape(across.shape)[()]


def site_potential() -> float:
    """The same at a lattice site, without that site: v_s."""
    return _fakir.site_potential()


def hollow_potential() -> float:
    """The same at a hollow site: v_h."""
    return _fakir.hollow_potential()


def annulus_coefficients(radius_ratio: object) -> AnnulusCoefficients:
    """Coefficients of detached annuli, by the ratio of their outer radius to that of the pillar (above 1.0001)."""
    ratios = array(radius_ratio, "number", "radius_ratio")
    rows = np.array([_fakir.annulus_coefficients(float(ratio)) for ratio in ratios.flat])
    return AnnulusCoefficients(*np.moveaxis(rows.reshape(*ratios.shape, 5), -1, 0))


def free_annulus(system: System, outer_radius: Quantity, pressure: Quantity = 0.0) -> FreeAnnulus:
    """The annulus of an outer radius around a pillar in a floor that adheres all around, under a remote pressure (negative in
    tension)."""
    radius = si(outer_radius, "length", "outer_radius")
    return FreeAnnulus(
        *_fakir.free_annulus(system._case, radius, si(pressure, "pressure", "pressure"))
    )


def annulus_radius(system: System, pressure: Quantity = 0.0, work: Quantity | None = None) -> float:
    """Outer radius (m) at which the edge of a detached annulus is in equilibrium under a remote pressure (Pa).

    It equals the radius of the pillar if the pillar is pressed down to the floor, and is infinite under a tension above
    `largest_tension`. ``work`` is the work of adhesion, by default that of the system on detachment.
    """
    found = si(pressure, "pressure", "pressure")
    return _fakir.annulus_radius(system._case, _work(system, work), found)


def largest_tension(system: System, work: Quantity | None = None) -> LargestTension:
    """Remote tension above which the annulus around a single pillar grows without bound."""
    return LargestTension(*_fakir.largest_tension(system._case, _work(system, work)))


def collapse_threshold(system: System) -> CollapseThreshold:
    """Work of adhesion above which the floor of the flat lattice adheres by itself."""
    return CollapseThreshold(*_fakir.collapse_threshold(system._case))


def net_work(system: System, work: Quantity | None = None) -> float | None:
    """Energy gain per area of an adhering floor, including the elastic energy around the pillars, J/m^2; None if annuli fill the
    cells."""
    return _fakir.net_work(system._case, _work(system, work))


def stuck_floor_pull_off(system: System, work: Quantity | None = None) -> float | None:
    """Pull-off force (N) of the lens from an adhering floor approximated as smooth; None if the net work is not positive."""
    return _fakir.stuck_floor_pull_off(system._case, _work(system, work))


def patch(
    system: System,
    radius: Quantity,
    indentation: Quantity = 0.0,
    work: Quantity | None = None,
) -> AdhesiveSphere | None:
    """The adhering patch of the floor after jump-in, small compared to the hole.

    Parameters
    ----------
    radius
        Radius of curvature of the gap at first contact, m.
    indentation
        Indentation relative to first contact, m.
    work
        Work of adhesion, by default that of the system on detachment.
    """
    lengths = si(radius, "length", "radius"), si(indentation, "length", "indentation")
    found = _fakir.adhesive_sphere(system._case, _work(system, work), *lengths)
    return None if found is None else AdhesiveSphere(*found)


def collapsed_cycle(system: System, loading: object, unloading: object = ()) -> CollapsedCycle:
    """Computes a lens on a floor that adheres inside a circle, with detached annuli around the pillars and adhesive tops outside.

    A fast model for large works of adhesion. The loading starts with a small adhering disc: the model does not describe first
    contact with the floor. Only the work of adhesion on attachment is used.

    Parameters
    ----------
    loading
        Increasing indentations, from first contact with the floor, m.
    unloading
        Decreasing indentations after that, m.

    Raises
    ------
    ValueError
        If the system has no adhesion, unless equal pillars form the infinite hexagonal lattice, or if the lens is not a sphere.
    """
    down = array(loading, "length", "loading").ravel().tolist()
    back = array(unloading, "length", "unloading").ravel().tolist()
    if not down:
        raise ValueError("loading is empty: give at least one indentation")
    rows, lost = _fakir.collapsed_cycle(system._case, down, back, options())
    columns = (np.array(column) for column in zip(*rows, strict=True))
    return CollapsedCycle._make([*columns, lost])


class Grooves:
    """Parallel ridges with grooves between them in plane strain, whose floor adheres along a strip in the middle of every groove.

    Parameters
    ----------
    reduced_modulus
        Reduced modulus of both bodies, Pa.
    period
        Period of the ridges, m.
    ridge_width
        Width of a ridge, m.
    depth
        Depth of the grooves, m.
    """

    def __init__(
        self, reduced_modulus: Quantity, period: Quantity, ridge_width: Quantity, depth: Quantity
    ) -> None:
        self._numbers = (
            si(reduced_modulus, "pressure", "reduced_modulus"),
            si(period, "length", "period"),
            si(ridge_width, "length", "ridge_width"),
            si(depth, "length", "depth"),
        )
        _fakir.groove_threshold(*self._numbers)  # refuses what cannot be

    def energy(self, strip_width: Quantity) -> float:
        """Energy per period and length with adhering strips of a width (m), J/m."""
        return _fakir.groove_energy(*self._numbers, si(strip_width, "length", "strip_width"))

    def threshold(self) -> GrooveThreshold:
        """Work of adhesion above which the grooves collapse by themselves."""
        return GrooveThreshold(*_fakir.groove_threshold(*self._numbers))


def _work(system: System, work: Quantity | None) -> float:
    if work is not None:
        return si(work, "energy per area", "work")
    adhesion = system.adhesion
    if adhesion is None:
        raise ValueError('no adhesion: give work, as in work="50 mJ/m2", or the system adhesion')
    receding = adhesion.work_receding
    return adhesion.work if receding is None else receding


def _form(system: System, name: str) -> TransitionEstimate:
    return TransitionEstimate(*_fakir.closed_form(system._case, name))


def _each(function: Any, values: Any) -> Any:
    return np.array([function(float(value)) for value in values.flat]).reshape(values.shape)[()]


def _sums(function: Any, contact_radius: object) -> LatticeSums:
    radii = array(contact_radius, "number", "contact_radius")
    _check_radii(radii, "contact_radius")
    rows = np.array([function(float(radius)) for radius in radii.flat]).reshape(*radii.shape, 3)
    return LatticeSums(rows[..., 0][()], rows[..., 1][()], rows[..., 2][()])


def _check_radii(radii: Any, name: str) -> None:
    most = 1000
    if not np.all((radii >= 0) & (radii <= most)):
        raise ValueError(
            f'{name} is in pitches: give values from 0 to {most}; sum_coefficients("limit") holds for wider contacts'
        )
