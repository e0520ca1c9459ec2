"""What is known in closed form: formulas for the critical state, lattice sums, the phase diagram.

The formulas are those of R. Ledesma-Alonso, E. Raphaël, F. Restagno, C. Poulard, Phys. Rev. E 104,
055007 (2021), as printed and as corrected. They are for a lens axis on a pillar, and without adhesion; those of
pillar tops that stick are in `adhesion`, those of a floor that sticks too in `free_annulus`, `annulus_radius`,
`largest_tension`, `collapse_threshold`, `net_work`, `stuck_floor_pull_off`, `patch` and `Grooves`. Numbers are in SI units, and radii in lattice sums in pitches.
"""

from __future__ import annotations

import json
from typing import Any, NamedTuple

import numpy as np

from . import _fakir
from ._quantity import Quantity, array, si
from ._run import options
from ._system import System

__all__ = [
    "AdhesionTheory",
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
    "StickySphere",
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
    """Surface fraction below which the lens touches one pillar only, by the paper's criterion."""
    homogenised_limit: float
    """Surface fraction below which the homogenised lattice applies."""
    central_force_amplification: float
    """S, the reduced force on the central pillar at the transition."""


CONSTANT_UNITS = {
    "reduced_modulus": "_Pa",
    "internal_compliance": "_per_Pa",
    "external_compliance": "_per_Pa",
}
"""The units in the names of ``fakir theory --json``."""


class PullOffEstimate(NamedTuple):
    """A pull-off from a formula."""

    force: float
    """N, negative."""
    normalized_force: float
    """That over the force of one flat pillar alone."""
    indentation: float | None
    """m; none where the formula has none."""
    contact_radius: float | None
    """m; none where the formula has none."""
    tilt: float | None
    """Angle between lens and pillar top, rad, of the formula that has one."""


class AdhesionTheory(NamedTuple):
    """What is known in closed form of pillar tops that stick."""

    pull_off: dict[str, PullOffEstimate]
    """By name of the formula."""
    kendall_strain: float
    """Stress of a flat pillar at pull-off over the modulus of the substrate; doubtful from 0.3 on."""
    tabor_number: float | None
    """Of a pillar top, if the range of the attraction is given: the range counts as small from 5 on."""


class AnnulusCoefficients(NamedTuple):
    """A free annulus round a pillar of unit radius, in units of the reduced modulus: a step h opens it, a pressure p far away closes it."""

    force_per_step: Any
    """F1: the pillar bears F1 h + V1 p."""
    volume_per_step: Any
    """V1: the annulus has the volume V1 h - D p."""
    volume_per_pressure: Any
    """D."""
    intensity_per_step: Any
    """K1: the stress intensity at the outer edge is K1 h - K2 p."""
    intensity_per_pressure: Any
    """K2."""


class FreeAnnulus(NamedTuple):
    """A free annulus round a pillar of a floor that is stuck to the lens."""

    outer_radius: float
    """m."""
    step: float
    """Height between floor and top with the column shortened, m."""
    pillar_force: float
    """N."""
    opened_volume: float
    """Between lens and floor, m^3."""
    stress_intensity: float
    """At the outer edge, Pa m^(1/2); below 0 the annulus closes."""
    energy_release_rate: float
    """There, J/m^2."""
    energy: float
    """J."""


class LargestTension(NamedTuple):
    """The tension under which the floor round a pillar comes off on and on."""

    tension: float
    """Pa, positive."""
    annulus_radius: float
    """Radius of the annulus just before, m."""


class CollapseThreshold(NamedTuple):
    """When a flat lattice that bears no load collapses."""

    work: float
    """Work of adhesion, J/m^2."""
    annulus_radius: float
    """Outer radius of the free annuli there, m."""


class CollapsedCycle(NamedTuple):
    """A loading and an unloading of a floor that is stuck inside a circle, as far as it sticks.

    In range the force is good to 2 to 8 % of what the tops alone would bear, the area to 10 to 15 %, a pull-off to 10 %.
    """

    unloading: Any
    """Whether a point is on the way back."""
    indentation: Any
    """m."""
    front_radius: Any
    """Radius of the circle, m."""
    force: Any
    """N."""
    energy: Any
    """J."""
    floor_area: Any
    """Area of the stuck floor, m^2."""
    pillars_in_contact: Any
    """Those inside the circle, and tops outside that stick."""
    widest_annulus: Any
    """Outer radius of the widest free annulus, m."""
    in_range: Any
    """Whether annuli are below 0.3 pitches and the front beyond 2: elsewhere the model is not good."""
    floor_lost: float | None
    """First indentation on the way back at which the floor no longer sticks, m; none if it still does."""


class StickySphere(NamedTuple):
    """A circular contact of a sphere that sticks."""

    radius: float
    """m."""
    force: float
    """N."""
    indentation: float
    """m."""


class GrooveThreshold(NamedTuple):
    """When grooves collapse."""

    work: float
    """Work of adhesion, J/m^2."""
    strip_width: float
    """Width of the strip that sticks in every groove, m."""


class LatticeSums(NamedTuple):
    """The sums over all pillars but the central one, or their fitted coefficients."""

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
    """Whether force and radius decide it; within a pitch the place of the lens does."""


def closed_forms(system: System) -> dict[str, TransitionEstimate]:
    """The critical state by every formula that gives numbers for the system."""
    forms = _fakir.closed_forms(system._case)
    return {name: TransitionEstimate(*estimate) for name, estimate in forms}


def adhesion(system: System, attraction_range: Quantity | None = None) -> AdhesionTheory:
    """The pull-off of lone contacts of a system that sticks, in closed form.

    ``"kendall"``: one pillar with a flat top (K. Kendall, J. Phys. D 4, 1186 (1971)); ``"pillar_under_lens"``: the same under
    the round lens; ``"tilted_pillar_first_yield"``: where the rim of a tilted one begins to peel; ``"jkr_by_force"`` and
    ``"jkr_by_displacement"``: the lens on the bare substrate (K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301
    (1971)); with a range of attraction ``"maugis_dugdale"``: the same with that range (D. Maugis, J. Colloid Interface Sci. 150, 243
    (1992)).

    Parameters
    ----------
    attraction_range
        The range of the attraction, m or with a unit: for the Tabor number and for Maugis's force.

    Raises
    ------
    ValueError
        If nothing sticks.
    """
    found = json.loads(_fakir.adhesion(system._case, _range(attraction_range)))
    if found is None:
        raise ValueError('nothing sticks: give the system adhesion, as in adhesion="50 mJ/m2"')
    names = ("force_N", "normalized_force", "indentation_m", "contact_radius_m", "tilt_rad")
    forms = {
        row["formula"]: PullOffEstimate(*(row[name] for name in names)) for row in found["pull_off"]
    }
    return AdhesionTheory(forms, found["kendall_strain"], found["tabor_number"])


def _range(value: Quantity | None) -> float | None:
    return None if value is None else si(value, "length", "attraction_range")


def to_dict(system: System, attraction_range: Quantity | None = None) -> dict[str, Any]:
    """The object that ``fakir theory --json`` prints: all that is known of a system in closed form."""
    return json.loads(_fakir.theory(system._case, _range(attraction_range)))  # type: ignore[no-any-return]


def small_contact(system: System) -> TransitionEstimate:
    """The paper's formulas for one pillar in contact."""
    return _form(system, "small_contact")


def one_pillar(system: System) -> TransitionEstimate:
    """One pillar in contact, with the distance of the floor contact found exactly."""
    return _form(system, "one_pillar")


def large_contact(system: System, form: str = "corrected") -> TransitionEstimate:
    """The paper's formulas for many pillars in contact, ``"corrected"`` or ``"as_printed"``."""
    if form not in {"corrected", "as_printed"}:
        raise ValueError(f'form is {form!r}: give "corrected" or "as_printed"')
    return _form(system, f"large_contact_{form}")


def transition_from_exact_sums(
    system: System, contact_radius: Quantity | None = None
) -> TransitionEstimate:
    """From lattice sums over a contact radius (m), that of the large-contact formula if not given."""
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
    """The region of the phase diagram."""
    radius = si(contact_radius, "length", "contact_radius")
    return Phase(*_fakir.phase(system._case, si(force, "force", "force"), radius))


def lattice_sums(contact_radius: object) -> LatticeSums:
    """The sums themselves over contact radii in pitches."""
    return _sums(_fakir.exact_lattice_sums, contact_radius)


def fitted_lattice_sums(contact_radius: object) -> LatticeSums:
    """The paper's fits to them."""
    return _sums(_fakir.fitted_lattice_sums, contact_radius)


def sum_coefficients(origin: str = "paper") -> LatticeSums:
    """C01, C1 and C11: the paper's, or the exact ``"limit"`` of a wide contact."""
    if origin not in {"paper", "limit"}:
        raise ValueError(f'origin is {origin!r}: give "paper" or "limit"')
    found = _fakir.sum_coefficients(origin, (1.0, 32.0), 2)
    assert found is not None
    return LatticeSums(*found)


def fit_sum_coefficients(
    range: tuple[float, float] = (1.0, 32.0), samples: int = 497
) -> LatticeSums:
    """C01, C1 and C11 by least squares over a range of contact radii in pitches."""
    found = _fakir.sum_coefficients("least squares", range, samples)
    if found is None:
        raise ValueError(f"nothing to fit in the range {range} with {samples} samples")
    return LatticeSums(*found)


def inverse_power_sum(exponent: float) -> float:
    """Sum of r^-exponent over a unit hexagonal lattice without the origin, continued analytically."""
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
    """Of free annuli, by their outer radius over that of the pillar (above 1.0001)."""
    ratios = array(radius_ratio, "number", "radius_ratio")
    rows = np.array([_fakir.annulus_coefficients(float(ratio)) for ratio in ratios.flat])
    return AnnulusCoefficients(*np.moveaxis(rows.reshape(*ratios.shape, 5), -1, 0))


def free_annulus(system: System, outer_radius: Quantity, pressure: Quantity = 0.0) -> FreeAnnulus:
    """The annulus of an outer radius round a pillar in a floor that is stuck all round, under a pressure far away (below 0 where the floor is pulled)."""
    radius = si(outer_radius, "length", "outer_radius")
    return FreeAnnulus(
        *_fakir.free_annulus(system._case, radius, si(pressure, "pressure", "pressure"))
    )


def annulus_radius(system: System, pressure: Quantity = 0.0, work: Quantity | None = None) -> float:
    """The outer radius (m) at which the edge of a free annulus stands under a pressure far away (Pa).

    It is the radius of the pillar where the pillar is pressed down to the floor, and infinite under a tension beyond `largest_tension`. ``work`` is the
    work of adhesion, that of the system where contact is broken if not given.
    """
    found = si(pressure, "pressure", "pressure")
    return _fakir.annulus_radius(system._case, _work(system, work), found)


def largest_tension(system: System, work: Quantity | None = None) -> LargestTension:
    """The tension far away from a lone pillar under which its annulus comes off on and on."""
    return LargestTension(*_fakir.largest_tension(system._case, _work(system, work)))


def collapse_threshold(system: System) -> CollapseThreshold:
    """The work of adhesion above which the floor of the flat lattice sticks by itself."""
    return CollapseThreshold(*_fakir.collapse_threshold(system._case))


def net_work(system: System, work: Quantity | None = None) -> float | None:
    """What a stuck floor wins per area, less what bends round the pillars, J/m^2; none where annuli fill the cells."""
    return _fakir.net_work(system._case, _work(system, work))


def stuck_floor_pull_off(system: System, work: Quantity | None = None) -> float | None:
    """The pull-off force (N) of the lens from a stuck floor seen as smooth; none where the net work is not positive."""
    return _fakir.stuck_floor_pull_off(system._case, _work(system, work))


def patch(
    system: System,
    radius: Quantity,
    indentation: Quantity = 0.0,
    work: Quantity | None = None,
) -> StickySphere | None:
    """The patch of floor that sticks after the lens has jumped onto it, small against the hole.

    Parameters
    ----------
    radius
        Radius of curvature of the gap where it is first closed, m.
    indentation
        Below first touch, m.
    work
        Work of adhesion, that of the system where contact is broken if not given.
    """
    lengths = si(radius, "length", "radius"), si(indentation, "length", "indentation")
    found = _fakir.sticky_sphere(system._case, _work(system, work), *lengths)
    return None if found is None else StickySphere(*found)


def collapsed_cycle(system: System, loading: object, unloading: object = ()) -> CollapsedCycle:
    """The lens on a floor that sticks inside a circle, with free annuli round the pillars and tops that stick outside.

    A fast model for large works of adhesion. The loading begins with a small stuck disc: how the lens first reaches the floor it does not say. Only the work of
    adhesion where contact is made counts.

    Parameters
    ----------
    loading
        Rising indentations, from where the floor is reached, m.
    unloading
        Falling ones after that, m.

    Raises
    ------
    ValueError
        If nothing sticks, if the pillars are not alike on the endless hexagonal lattice, or the lens is no sphere.
    """
    down = array(loading, "length", "loading").ravel().tolist()
    back = array(unloading, "length", "unloading").ravel().tolist()
    if not down:
        raise ValueError("loading is empty: give at least one indentation")
    rows, lost = _fakir.collapsed_cycle(system._case, down, back, options())
    columns = (np.array(column) for column in zip(*rows, strict=True))
    return CollapsedCycle._make([*columns, lost])


class Grooves:
    """Parallel ridges with grooves between them in plane strain, whose floor is stuck along a strip in the middle of every groove.

    Parameters
    ----------
    reduced_modulus
        Of both bodies, Pa.
    period
        Of the ridges, m.
    ridge_width
        m.
    depth
        Of the grooves, m.
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
        """Energy per period and length with strips of a width (m) stuck, J/m."""
        return _fakir.groove_energy(*self._numbers, si(strip_width, "length", "strip_width"))

    def threshold(self) -> GrooveThreshold:
        """The work of adhesion above which the grooves collapse by themselves."""
        return GrooveThreshold(*_fakir.groove_threshold(*self._numbers))


def _work(system: System, work: Quantity | None) -> float:
    if work is not None:
        return si(work, "energy per area", "work")
    adhesion = system.adhesion
    if adhesion is None:
        raise ValueError('nothing sticks: give work, as in work="50 mJ/m2", or the system adhesion')
    receding = adhesion.work_receding
    return adhesion.work if receding is None else receding


def _form(system: System, name: str) -> TransitionEstimate:
    return TransitionEstimate(*_fakir.closed_form(system._case, name))


def _each(function: Any, values: Any) -> Any:
    return np.array([function(float(value)) for value in values.flat]).reshape(values.shape)[()]


def _sums(function: Any, contact_radius: object) -> LatticeSums:
    radii = array(contact_radius, "number", "contact_radius")
    rows = np.array([function(float(radius)) for radius in radii.flat]).reshape(*radii.shape, 3)
    return LatticeSums(rows[..., 0][()], rows[..., 1][()], rows[..., 2][()])
