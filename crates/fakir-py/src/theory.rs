//! Closed forms, lattice sums and the homogenised lattice.

use crate::case::Case;
use crate::error::solve_error;
use fakir::theory::closed_forms as forms;
use fakir::theory::closed_forms::{Form, Region, TransitionEstimate};
use fakir::theory::homogenised as model;
use fakir::theory::homogenised::HomogenisedLattice;
use fakir::theory::lattice_potential as potential;
use fakir::theory::lattice_sums;
use fakir::theory::lattice_sums::{LatticeSums, SumCoefficients, SumFit};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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

/// Every formula for the critical state, by name; sums over a contact of `contact_radius` (m) if
/// one is given, and otherwise over that of the large-contact formula.
#[pyfunction]
pub(crate) fn closed_forms(
    case: &Case,
    contact_radius: Option<f64>,
) -> Vec<(&'static str, Estimate)> {
    let system = &case.case.system;
    let radius =
        contact_radius.unwrap_or_else(|| forms::large_contact_radius(system, Form::Corrected));
    [
        ("small_contact", forms::small_contact(system)),
        ("one_pillar", forms::one_pillar(system)),
        (
            "large_contact_as_printed",
            forms::large_contact(system, Form::AsPrinted),
        ),
        (
            "large_contact_corrected",
            forms::large_contact(system, Form::Corrected),
        ),
        (
            "exact_lattice_sums",
            forms::transition_from_exact_sums(system, radius),
        ),
        ("homogenised_dense_limit", model::dense_limit(system)),
    ]
    .iter()
    .map(|(name, form)| (*name, estimate(form)))
    .collect()
}

/// The constants of a system, with units in their names.
#[pyfunction]
pub(crate) fn constants<'py>(py: Python<'py>, case: &Case) -> PyResult<Bound<'py, PyDict>> {
    let system = &case.case.system;
    let constants = PyDict::new(py);
    for (name, value) in [
        ("reduced_modulus_Pa", system.reduced_modulus()),
        ("internal_compliance_per_Pa", system.internal_compliance()),
        ("external_compliance_per_Pa", system.external_compliance()),
        ("column_compliance_ratio", system.column_compliance_ratio()),
        ("small_contact_limit", forms::small_contact_limit(system)),
        ("homogenised_limit", model::largest_surface_fraction(system)),
        (
            "central_force_amplification",
            model::central_force_amplification(system),
        ),
    ] {
        constants.set_item(name, value)?;
    }
    Ok(constants)
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
pub(crate) fn transition_force(case: &Case, contact_radius: f64) -> f64 {
    forms::transition_force(&case.case.system, contact_radius)
}

/// Contact radius (m) of a lens on a smooth half-space under a force (N).
#[pyfunction]
pub(crate) fn hertz_contact_radius(case: &Case, force: f64) -> f64 {
    forms::hertz_contact_radius(&case.case.system, force)
}

/// Region of the phase diagram, and whether the two numbers decide it.
#[pyfunction]
pub(crate) fn phase(case: &Case, force: f64, contact_radius: f64) -> (&'static str, bool) {
    let phase = forms::phase(&case.case.system, force, contact_radius);
    let region = match phase.region {
        Region::Top => "top",
        Region::Mixed => "mixed",
    };
    (region, phase.deterministic)
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

/// The same by the paper's fits.
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

/// At a lattice site, without that site.
#[pyfunction]
pub(crate) fn site_potential() -> f64 {
    potential::site_potential()
}

/// At a hollow site.
#[pyfunction]
pub(crate) fn hollow_potential() -> f64 {
    potential::hollow_potential()
}
