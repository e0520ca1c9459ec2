//! Closed forms, lattice sums and the homogenised lattice.

use crate::case::Case;
use crate::error::{solve_error, value_error};
use crate::watched::{Options, watched};
use fakir::problem::{Feature, InvalidQuantity, Question, Solver, System};
use fakir::solve::collapsed_floor::{CollapsedCycle, CollapsedFloor};
use fakir::solve::homogenised::HomogenisedLattice;
use fakir::state::SolveError;
use fakir::theory::adhesion::adhesive_sphere_at_indentation;
use fakir::theory::closed_forms as forms;
use fakir::theory::closed_forms::{Region, TransitionEstimate};
use fakir::theory::lattice_potential as potential;
use fakir::theory::lattice_sums;
use fakir::theory::lattice_sums::{LatticeSums, SumCoefficients, SumFit};
use fakir::theory::stuck_floor::{
    AdhesiveFloor, AnnulusCoefficients, AnnulusEdge, BondedFloorPillar, Grooves,
};
use fakir_study::closed_forms::{Formula, check_arrangement};
use fakir_study::result::{AdhesionObject, TheorySummary, json};
use pyo3::prelude::*;

/// Force, indentation, top contact radius and distance of the floor contact.
type Estimate = (f64, f64, f64, f64);

fn estimate(estimate: &TransitionEstimate) -> Estimate {
    (
        estimate.force,
        estimate.indentation,
        estimate.top_contact_radius,
        estimate.floor_contact_distance,
    )
}

/// The critical state by every applicable formula, by name.
#[pyfunction]
pub(crate) fn closed_forms(case: &Case) -> PyResult<Vec<(&'static str, Estimate)>> {
    let forms = fakir_study::closed_forms::closed_forms(&case.case.system);
    let forms = forms.map_err(|error| value_error(error.to_string()))?;
    let named = forms.iter();
    Ok(named
        .map(|form| (form.formula.key(), estimate(&form.estimate)))
        .collect())
}

/// The system of a case, if the formulas support its arrangement.
fn of_theory(case: &Case) -> PyResult<&System> {
    let system = &case.case.system;
    check_arrangement(system).map_err(|error| value_error(error.to_string()))?;
    Ok(system)
}

/// The system of a case, if the formulas support its bodies: one without pillars holds on every arrangement.
fn of_bodies(case: &Case) -> PyResult<&System> {
    let system = &case.case.system;
    let mut features = Feature::of(system);
    features.retain(|feature| *feature != Feature::OtherArrangement);
    let answered = Question::Theory.check(Solver::Spectral, &features);
    answered.map_err(|error| value_error(error.to_string()))?;
    Ok(system)
}

/// A force or a radius, unless it is negative or not a number.
fn not_negative(name: &str, value: f64) -> PyResult<f64> {
    if value >= 0.0 {
        return Ok(value);
    }
    Err(value_error(format!(
        "{name} is {value}: give a number that is not negative"
    )))
}

/// The critical state by one formula, regardless of its range.
#[pyfunction]
pub(crate) fn closed_form(case: &Case, name: &str) -> PyResult<Estimate> {
    let formula = Formula::named(name)
        .ok_or_else(|| value_error(format!("no formula is called \"{name}\"")))?;
    Ok(estimate(&formula.estimate(of_theory(case)?)))
}

/// The critical state from lattice sums over a contact of this radius (m).
#[pyfunction]
pub(crate) fn transition_from_exact_sums(case: &Case, contact_radius: f64) -> PyResult<Estimate> {
    let state = forms::transition_from_exact_sums(of_theory(case)?, contact_radius);
    Ok(estimate(&state))
}

/// The object that `fakir theory --json` prints. `range` is that of the attraction (m), if known.
#[pyfunction]
pub(crate) fn theory(case: &Case, range: Option<f64>) -> PyResult<String> {
    let summary = TheorySummary::new(&case.case.system, range);
    let summary = summary.map_err(|error| value_error(error.to_string()))?;
    Ok(json(&summary))
}

/// The adhesion part of that object; `null` without adhesion.
#[pyfunction]
pub(crate) fn adhesion(case: &Case, range: Option<f64>) -> PyResult<String> {
    let found = AdhesionObject::new(&case.case.system, range);
    let found = found.map_err(|error| value_error(error.to_string()))?;
    Ok(json(&found))
}

/// The constants of the object returned by [`theory`].
#[pyfunction]
pub(crate) fn constants(case: &Case) -> PyResult<String> {
    Ok(json(&fakir_study::result::constants(of_theory(case)?)))
}

/// Layer compliance (m/Pa), critical force (N) and pressure (Pa) of the central pillar.
#[pyfunction]
pub(crate) fn homogenised(case: &Case) -> PyResult<(f64, f64, f64)> {
    let model = HomogenisedLattice::new(&case.case.system).map_err(|error| solve_error(&error))?;
    Ok((
        model.layer_compliance,
        model.critical_central_force,
        model.critical_central_pressure,
    ))
}

/// The transition curve: force (N) at a contact radius (m).
#[pyfunction]
pub(crate) fn transition_force(case: &Case, contact_radius: f64) -> PyResult<f64> {
    let radius = not_negative("contact_radius", contact_radius)?;
    Ok(forms::transition_force(of_theory(case)?, radius))
}

/// Contact radius (m) of a lens on a smooth half-space under a force (N).
#[pyfunction]
pub(crate) fn hertz_contact_radius(case: &Case, force: f64) -> PyResult<f64> {
    let force = not_negative("force", force)?;
    Ok(forms::hertz_contact_radius(of_bodies(case)?, force))
}

/// Region of the phase diagram, and whether the two numbers determine it.
#[pyfunction]
pub(crate) fn phase(
    case: &Case,
    force: f64,
    contact_radius: f64,
) -> PyResult<(&'static str, bool)> {
    let force = not_negative("force", force)?;
    let radius = not_negative("contact_radius", contact_radius)?;
    let phase = forms::phase(of_theory(case)?, force, radius);
    let region = match phase.region {
        Region::Top => "top",
        Region::Mixed => "mixed",
    };
    Ok((region, phase.deterministic))
}

type Sums = (f64, f64, f64);

fn sums(sums: &LatticeSums) -> Sums {
    (sums.displacement, sums.force, sums.curvature)
}

fn coefficients(of: &SumCoefficients) -> Sums {
    (of.displacement, of.force, of.curvature)
}

/// `G0`, `G` and `G1` at a contact radius in pitches.
#[pyfunction]
pub(crate) fn exact_lattice_sums(contact_radius: f64) -> Sums {
    sums(&LatticeSums::exact(contact_radius))
}

/// `G0`, `G` and `G1` at a contact radius in pitches, by the paper's fits.
#[pyfunction]
pub(crate) fn fitted_lattice_sums(contact_radius: f64) -> Sums {
    sums(&SumCoefficients::PAPER.sums(contact_radius))
}

/// `C01`, `C1` and `C11`: `"paper"`, `"limit"`, or by least squares.
#[pyfunction]
pub(crate) fn sum_coefficients(origin: &str, range: [f64; 2], samples: usize) -> Option<Sums> {
    match origin {
        "paper" => Some(coefficients(&SumCoefficients::PAPER)),
        "limit" => Some(coefficients(&SumCoefficients::wide_contact_limit())),
        _ => SumFit::least_squares(range, samples).map(|fit| coefficients(&fit.coefficients)),
    }
}

/// Sum of `r^-exponent` over a unit hexagonal lattice without the origin.
#[pyfunction]
pub(crate) fn inverse_power_sum(exponent: f64) -> f64 {
    lattice_sums::inverse_power_sum(exponent)
}

/// Potential of a neutralised unit lattice at a point.
#[pyfunction]
pub(crate) fn lattice_potential(x: f64, y: f64) -> f64 {
    potential::lattice_potential([x, y])
}

/// Potential of a neutralised unit lattice at a site, without the charge of that site.
#[pyfunction]
pub(crate) fn site_potential() -> f64 {
    potential::site_potential()
}

/// Potential of a neutralised unit lattice at a hollow site, between three sites.
#[pyfunction]
pub(crate) fn hollow_potential() -> f64 {
    potential::hollow_potential()
}

fn invalid(error: InvalidQuantity) -> PyErr {
    value_error(error.to_string())
}

/// `F1`, `V1`, `D`, `K1` and `K2` of a detached annulus, by the ratio of its radius to that of the pillar.
#[pyfunction]
pub(crate) fn annulus_coefficients(radius_ratio: f64) -> PyResult<(f64, f64, f64, f64, f64)> {
    let found = AnnulusCoefficients::new(radius_ratio).map_err(invalid)?;
    Ok((
        found.force_per_step,
        found.volume_per_step,
        found.volume_per_pressure,
        found.intensity_per_step,
        found.intensity_per_pressure,
    ))
}

/// A detached annulus: radius, step, force on the pillar, volume, stress intensity factor, energy release rate, energy.
type Annulus = (f64, f64, f64, f64, f64, f64, f64);

/// The detached annulus of a radius (m) under a remote pressure (Pa).
#[pyfunction]
pub(crate) fn free_annulus(case: &Case, outer_radius: f64, pressure: f64) -> PyResult<Annulus> {
    let pillar = BondedFloorPillar::of(&case.case.system);
    let found = pillar.annulus(outer_radius, pressure).map_err(invalid)?;
    Ok((
        found.outer_radius,
        found.step,
        found.pillar_force,
        found.opened_volume,
        found.stress_intensity,
        found.energy_release_rate,
        found.energy,
    ))
}

/// Outer radius (m) of the detached annulus in equilibrium for a work of adhesion (J/m^2): that of the pillar if it is closed, infinite if
/// it is unstable.
#[pyfunction]
pub(crate) fn annulus_radius(case: &Case, work: f64, pressure: f64) -> PyResult<f64> {
    let pillar = BondedFloorPillar::of(&case.case.system);
    Ok(match pillar.edge(work, pressure).map_err(invalid)? {
        AnnulusEdge::At(radius) => radius,
        AnnulusEdge::Closed => pillar.radius(),
        AnnulusEdge::Runs => f64::INFINITY,
    })
}

/// Largest tension (Pa) under which an annulus is stable, and its radius (m) there.
#[pyfunction]
pub(crate) fn largest_tension(case: &Case, work: f64) -> PyResult<(f64, f64)> {
    BondedFloorPillar::of(&case.case.system)
        .largest_tension(work)
        .map_err(invalid)
}

/// The adhesive floor of a case.
fn floor_of(case: &Case) -> PyResult<AdhesiveFloor> {
    AdhesiveFloor::of(&case.case.system).map_err(|error| value_error(error.to_string()))
}

/// Work (J/m^2) above which the flat lattice collapses, and radius of its annuli (m).
#[pyfunction]
pub(crate) fn collapse_threshold(case: &Case) -> PyResult<(f64, f64)> {
    let found = floor_of(case)?.collapse_threshold();
    Ok((found.work, found.annulus_radius))
}

/// Energy gain per area of an adhering floor (J/m^2); `None` if annuli fill the cells.
#[pyfunction]
pub(crate) fn net_work(case: &Case, work: f64) -> PyResult<Option<f64>> {
    floor_of(case)?.net_work(work).map_err(invalid)
}

/// Pull-off force (N) of the adhering floor, approximated as smooth; `None` if it does not adhere by itself.
#[pyfunction]
pub(crate) fn stuck_floor_pull_off(case: &Case, work: f64) -> PyResult<Option<f64>> {
    let lens = of_bodies(case)?.lens().sphere_radius();
    floor_of(case)?.pull_off(lens, work).map_err(invalid)
}

/// Radius (m), force (N) and indentation (m) of an adhesive sphere of a radius (m), at an indentation; `None` after detachment.
#[pyfunction]
pub(crate) fn adhesive_sphere(
    case: &Case,
    work: f64,
    radius: f64,
    indentation: f64,
) -> PyResult<Option<(f64, f64, f64)>> {
    let modulus = case.case.system.reduced_modulus();
    let found =
        adhesive_sphere_at_indentation(modulus, radius, work, indentation).map_err(invalid)?;
    Ok(found.map(|it| (it.radius, it.force, it.indentation)))
}

/// A load step of a cycle of the collapsed floor: whether it belongs to the unloading, indentation, radius of the front, force, energy,
/// area of the floor, pillars, widest annulus, whether the state is in the range of the model.
type CollapsedRow = (bool, f64, f64, f64, f64, f64, usize, f64, bool);

/// Loading and unloading of a floor that adheres inside a circle, and the indentation (m) at which the floor detaches.
#[pyfunction]
pub(crate) fn collapsed_cycle(
    py: Python<'_>,
    case: &Case,
    loading: Vec<f64>,
    unloading: Vec<f64>,
    options: Options,
) -> PyResult<(Vec<CollapsedRow>, Option<f64>)> {
    let system = &case.case.system;
    let all = loading.iter().chain(&unloading);
    let largest = all.fold(0.0f64, |most, indentation| most.max(*indentation));
    let found = watched(py, &options, |run| -> Result<CollapsedCycle, SolveError> {
        CollapsedFloor::new(system, largest)?.cycle(&loading, &unloading, run)
    })?;
    let found = found.map_err(|error| solve_error(&error))?;
    let rows = found.points.iter().map(|point| {
        (
            point.unloading,
            point.indentation,
            point.front_radius,
            point.force,
            point.energy,
            point.floor_area,
            point.pillars_in_contact,
            point.widest_annulus.unwrap_or(f64::NAN),
            point.in_range,
        )
    });
    Ok((rows.collect(), found.floor_lost))
}

/// Energy per period and length (J/m) of grooves with an adhering strip of the floor.
#[pyfunction]
pub(crate) fn groove_energy(
    modulus: f64,
    period: f64,
    ridge_width: f64,
    depth: f64,
    strip_width: f64,
) -> PyResult<f64> {
    let grooves = Grooves::new(modulus, period, ridge_width, depth).map_err(invalid)?;
    grooves.energy(strip_width).map_err(invalid)
}

/// Work (J/m^2) above which grooves collapse, and width (m) of the adhering strip.
#[pyfunction]
pub(crate) fn groove_threshold(
    modulus: f64,
    period: f64,
    ridge_width: f64,
    depth: f64,
) -> PyResult<(f64, f64)> {
    let grooves = Grooves::new(modulus, period, ridge_width, depth).map_err(invalid)?;
    let found = grooves.threshold();
    Ok((found.work, found.strip_width))
}
