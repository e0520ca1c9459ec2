//! Closed forms, as printed and as corrected.

use super::AdhesionObject;
use crate::VERSION;
use crate::closed_forms::{ClosedForm, LARGEST_SUM, closed_forms, touches_one_pillar};
use fakir::problem::{Method, System};
use fakir::solve::homogenised::{central_force_amplification, largest_surface_fraction};
use fakir::state::{CriticalState, Run, SolveError};
use fakir::theory::closed_forms::{
    Form, TransitionEstimate, hertz_contact_radius, large_contact_radius, small_contact_limit,
    transition_force, transition_from_exact_sums,
};
use fakir::theory::lattice_sums::{LatticeSums, SumCoefficients, SumFit};
use serde::Serialize;

/// Contact radii (in pitches) at which lattice sums and transition curve are tabulated.
const RADII: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 32.0];

/// Range (in pitches) and number of contact radii of the fit of the paper's coefficients.
const FIT: ([f64; 2], usize) = ([1.0, 32.0], 497);

/// Closed forms: what `fakir theory --json` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TheorySummary {
    /// Fraction of the surface covered by pillar tops.
    pub surface_fraction: f64,
    /// Distance between neighbouring pillars, m.
    pub pitch_m: f64,
    /// Compliances and limits.
    pub constants: Constants,
    /// Adhesive pillar tops; `None` without adhesion. All other results are without adhesion.
    pub adhesion: Option<AdhesionObject>,
    /// The critical state by every formula, and by the homogenised lattice.
    pub critical_states: Vec<FormulaRow>,
    /// Coefficients of the lattice sums.
    pub coefficients: Vec<CoefficientRow>,
    /// Range of contact radii of the least-squares fit, in pitches.
    pub fit_range: [f64; 2],
    /// Lattice sums by contact radius.
    pub lattice_sums: Vec<SumRow>,
    /// The transition curve.
    pub transition_curve: Vec<CurveRow>,
    fakir_version: &'static str,
    /// Why the homogenised lattice does not apply, if it does not.
    #[serde(skip)]
    pub no_homogenised: Option<SolveError>,
    /// Contact radius of the large-contact formulas, in pitches.
    #[serde(skip)]
    pub own_radius: f64,
}

/// Compliances and limits of a system.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct Constants {
    /// `1/c`, Pa.
    pub reduced_modulus_Pa: f64,
    /// `gamma_int`, 1/Pa.
    pub internal_compliance_per_Pa: f64,
    /// `gamma_ext`, 1/Pa.
    pub external_compliance_per_Pa: f64,
    /// `4 h/(pi E_s d c)`.
    pub column_compliance_ratio: f64,
    /// Surface fraction below which the lens touches only one pillar, by the paper's criterion.
    pub small_contact_limit: f64,
    /// Whether this system is below that limit.
    pub touches_one_pillar: bool,
    /// Surface fraction below which the homogenised lattice applies.
    pub homogenised_limit: f64,
    /// `S`, the reduced force on the central pillar at the transition.
    pub central_force_amplification: f64,
    /// The contact radius of the paper's text, m.
    pub contact_radius_in_text_m: f64,
}

/// A critical state by a formula.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct FormulaRow {
    /// Name of the formula.
    pub formula: &'static str,
    /// Descriptive name.
    #[serde(skip)]
    pub name: &'static str,
    /// Critical force, N.
    pub critical_force_N: f64,
    /// Critical indentation, m.
    pub critical_indentation_m: f64,
    /// Radius of the contact on the pillar tops, m.
    pub top_contact_radius_m: f64,
    /// Distance of the floor contact from the lens axis, m.
    pub floor_contact_distance_m: f64,
    /// The same under its older name.
    pub bottom_contact_distance_m: f64,
    /// Whether the system is in the range of the formula.
    pub applies: bool,
}

/// A coefficient of the lattice sums.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoefficientRow {
    /// `C01`, `C1` or `C11`.
    pub name: &'static str,
    /// The sum to which it belongs.
    pub formula: &'static str,
    /// As printed in the paper.
    pub paper: f64,
    /// By least squares over `fit_range`.
    pub least_squares: f64,
    /// In the limit of a wide contact.
    pub exact_limit: f64,
}

/// Lattice sums at a contact radius, exact and by the paper's fits.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SumRow {
    /// `a/e`.
    pub contact_radius_in_pitches: f64,
    /// `G0`.
    pub g0: f64,
    /// `G0` by the paper's fit.
    pub g0_fit: f64,
    /// `G`.
    pub g: f64,
    /// `G` by the paper's fit.
    pub g_fit: f64,
    /// `G1`.
    pub g1: f64,
    /// `G1` by the paper's fit.
    pub g1_fit: f64,
}

/// A point of the transition curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct CurveRow {
    /// `a/e`.
    pub contact_radius_in_pitches: f64,
    /// `a`, m.
    pub contact_radius_m: f64,
    /// The force at which the floor is touched, N.
    pub force_N: f64,
    /// `F gamma_int/(h d)`.
    pub normalized_force: f64,
    /// The force by exact lattice sums, N.
    pub force_from_exact_sums_N: f64,
    /// Contact radius on a smooth surface under the force, m.
    pub hertz_contact_radius_m: f64,
}

impl TheorySummary {
    /// The closed forms of a system. `range` is that of the attraction of adhesive tops (m), if known.
    ///
    /// # Errors
    /// A range that is not positive, and [`Unsupported`](fakir::problem::Unsupported) unless equal pillars form the infinite hexagonal
    /// lattice.
    pub fn new(system: &System, range: Option<f64>) -> Result<Self, SolveError> {
        let adhesion = AdhesionObject::new(system, range)?;
        // The other formulas neglect adhesion.
        let system = &system.without_adhesion();
        let (critical_states, no_homogenised) = critical_rows(system)?;
        let radii = radii(system);
        Ok(Self {
            surface_fraction: system.pattern().surface_fraction(),
            pitch_m: system.pitch(),
            constants: constants(system),
            adhesion,
            critical_states,
            coefficients: coefficient_rows(),
            fit_range: FIT.0,
            lattice_sums: radii.iter().map(|ratio| sum_row(*ratio)).collect(),
            transition_curve: radii
                .iter()
                .map(|ratio| curve_row(system, *ratio))
                .collect(),
            fakir_version: VERSION,
            no_homogenised,
            own_radius: own_ratio(system),
        })
    }

    /// Number of contact radii of the least-squares fit.
    pub const FIT_SAMPLES: usize = FIT.1;
}

/// The constants of a system.
#[must_use]
pub fn constants(system: &System) -> Constants {
    Constants {
        reduced_modulus_Pa: system.reduced_modulus(),
        internal_compliance_per_Pa: system.internal_compliance(),
        external_compliance_per_Pa: system.external_compliance(),
        column_compliance_ratio: system.column_compliance_ratio(),
        small_contact_limit: small_contact_limit(system),
        touches_one_pillar: touches_one_pillar(system),
        homogenised_limit: largest_surface_fraction(system),
        central_force_amplification: central_force_amplification(system),
        contact_radius_in_text_m: large_contact_radius(system, Form::AsPrinted),
    }
}

/// All formulas, and the homogenised lattice itself, or why it does not apply.
fn critical_rows(system: &System) -> Result<(Vec<FormulaRow>, Option<SolveError>), SolveError> {
    let mut rows: Vec<FormulaRow> = closed_forms(system)?.iter().map(formula_row).collect();
    let found = match fakir::transition(system, Method::Homogenised, &Run::default()) {
        Ok(critical) => {
            rows.push(homogenised_row(&critical, !touches_one_pillar(system)));
            (rows, None)
        }
        Err(error) => (rows, Some(error)),
    };
    Ok(found)
}

fn formula_row(form: &ClosedForm) -> FormulaRow {
    let TransitionEstimate {
        force,
        indentation,
        top_contact_radius,
        floor_contact_distance,
    } = form.estimate;
    FormulaRow {
        formula: form.formula.key(),
        name: form.formula.name(),
        critical_force_N: force,
        critical_indentation_m: indentation,
        top_contact_radius_m: top_contact_radius,
        floor_contact_distance_m: floor_contact_distance,
        bottom_contact_distance_m: floor_contact_distance,
        applies: form.applies,
    }
}

fn homogenised_row(critical: &CriticalState, applies: bool) -> FormulaRow {
    FormulaRow {
        formula: "homogenised",
        name: "homogenised lattice",
        critical_force_N: critical.contact.force,
        critical_indentation_m: critical.contact.indentation,
        top_contact_radius_m: critical.contact.contact_radius,
        floor_contact_distance_m: critical.floor_contact_distance(),
        bottom_contact_distance_m: critical.floor_contact_distance(),
        applies,
    }
}

fn coefficient_rows() -> Vec<CoefficientRow> {
    let paper = SumCoefficients::PAPER;
    let limit = SumCoefficients::wide_contact_limit();
    let nothing = SumCoefficients {
        displacement: f64::NAN,
        force: f64::NAN,
        curvature: f64::NAN,
    };
    let fit = SumFit::least_squares(FIT.0, FIT.1).map_or(nothing, |fit| fit.coefficients);
    let row = |name, formula, of: fn(&SumCoefficients) -> f64| CoefficientRow {
        name,
        formula,
        paper: of(&paper),
        least_squares: of(&fit),
        exact_limit: of(&limit),
    };
    vec![
        row("C01", "G0 ~ C01 (a/e - 1)", |c| c.displacement),
        row("C1", "G ~ C1 ((a/e)^2 - 1)", |c| c.force),
        row("C11", "G1 ~ C11 (1 - e/a)", |c| c.curvature),
    ]
}

/// The tabulated contact radii, including that of the large-contact formulas, in pitches.
fn radii(system: &System) -> Vec<f64> {
    let own = own_ratio(system);
    let mut radii: Vec<f64> = RADII.to_vec();
    if own <= LARGEST_SUM && !RADII.iter().any(|radius| (radius - own).abs() < 1e-3) {
        radii.push(own);
    }
    radii.sort_by(f64::total_cmp);
    radii
}

/// The contact radius of the large-contact formulas, in pitches.
fn own_ratio(system: &System) -> f64 {
    large_contact_radius(system, Form::Corrected) / system.pitch()
}

fn sum_row(contact_radius: f64) -> SumRow {
    let exact = LatticeSums::exact(contact_radius);
    let fit = SumCoefficients::PAPER.sums(contact_radius);
    SumRow {
        contact_radius_in_pitches: contact_radius,
        g0: exact.displacement,
        g0_fit: fit.displacement,
        g: exact.force,
        g_fit: fit.force,
        g1: exact.curvature,
        g1_fit: fit.curvature,
    }
}

fn curve_row(system: &System, ratio: f64) -> CurveRow {
    let contact_radius = ratio * system.pitch();
    let force = transition_force(system, contact_radius);
    let unit = system.pillar().height * system.pillar().diameter / system.internal_compliance();
    CurveRow {
        contact_radius_in_pitches: ratio,
        contact_radius_m: contact_radius,
        force_N: force,
        normalized_force: force / unit,
        force_from_exact_sums_N: transition_from_exact_sums(system, contact_radius).force,
        hertz_contact_radius_m: hertz_contact_radius(system, force),
    }
}
