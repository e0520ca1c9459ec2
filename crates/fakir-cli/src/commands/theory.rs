//! `fakir theory`: everything that is known in closed form, as printed and as corrected.

use super::closed_forms::{ClosedForm, LARGEST_SUM, closed_forms, touches_one_pillar};
use crate::failure::Failure;
use crate::numbers::{significant, with_unit};
use crate::report::state::{QuantityList, VERSION, texture_line};
use crate::report::table::{Column, table};
use crate::report::{Report, csv, json};
use fakir::problem::Method;
use fakir::problem::System;
use fakir::state::{CriticalState, Run, SolveError};
use fakir::theory::closed_forms::{
    Form, TransitionEstimate, hertz_contact_radius, large_contact_radius, small_contact_limit,
    transition_force, transition_from_exact_sums,
};
use fakir::theory::homogenised::{central_force_amplification, largest_surface_fraction};
use fakir::theory::lattice_sums::{LatticeSums, SumCoefficients, SumFit};
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_study::citations::Topic;
use fakir_study::provenance::Provenance;
use serde::Serialize;

/// Contact radii (in pitches) at which lattice sums and transition curve are tabulated.
const RADII: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 32.0];

/// Range (in pitches) and number of contact radii of the fit that gives the paper's coefficients.
const FIT: ([f64; 2], usize) = ([1.0, 32.0], 497);

#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct TheoryJson<'a> {
    surface_fraction: f64,
    pitch_m: f64,
    constants: &'a Constants,
    critical_states: &'a [CriticalRow],
    coefficients: &'a [CoefficientRow],
    fit_range: [f64; 2],
    lattice_sums: &'a [SumRow],
    transition_curve: &'a [CurveRow],
    fakir_version: &'static str,
}

#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct Constants {
    reduced_modulus_Pa: f64,
    internal_compliance_per_Pa: f64,
    external_compliance_per_Pa: f64,
    column_compliance_ratio: f64,
    small_contact_limit: f64,
    touches_one_pillar: bool,
    homogenised_limit: f64,
    central_force_amplification: f64,
    contact_radius_in_text_m: f64,
}

/// A critical state by a formula.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CriticalRow {
    formula: &'static str,
    #[serde(skip)]
    name: &'static str,
    critical_force_N: f64,
    critical_indentation_m: f64,
    top_contact_radius_m: f64,
    bottom_contact_distance_m: f64,
    applies: bool,
}

#[derive(Debug, Serialize)]
struct CoefficientRow {
    name: &'static str,
    formula: &'static str,
    paper: f64,
    least_squares: f64,
    exact_limit: f64,
}

/// Lattice sums at a contact radius, exact and by the paper's fits.
#[derive(Debug, Serialize)]
struct SumRow {
    contact_radius_in_pitches: f64,
    g0: f64,
    g0_fit: f64,
    g: f64,
    g_fit: f64,
    g1: f64,
    g1_fit: f64,
}

/// A point of the transition curve.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct CurveRow {
    contact_radius_in_pitches: f64,
    contact_radius_m: f64,
    force_N: f64,
    normalized_force: f64,
    force_from_exact_sums_N: f64,
    hertz_contact_radius_m: f64,
}

pub(crate) fn run(case: &Case) -> Result<Report, Failure> {
    let system = &case.system;
    let constants = constants(system);
    let (critical, no_homogenised) = critical_rows(system);
    let coefficients = coefficient_rows();
    let radii = radii(system);
    let sums: Vec<SumRow> = radii.iter().map(|ratio| sum_row(*ratio)).collect();
    let curve: Vec<CurveRow> = radii
        .iter()
        .map(|ratio| curve_row(system, *ratio))
        .collect();
    let summary = TheoryJson {
        surface_fraction: system.texture().surface_fraction(),
        pitch_m: system.lattice().pitch,
        constants: &constants,
        critical_states: &critical,
        coefficients: &coefficients,
        fit_range: FIT.0,
        lattice_sums: &sums,
        transition_curve: &curve,
        fakir_version: VERSION,
    };
    Ok(Report {
        json: json(&summary),
        text: [
            format!("Closed forms\n{}\n", texture_line(system)),
            constants_text(&constants),
            critical_text(&critical, &constants),
            coefficients_text(&coefficients),
            sums_text(&sums, own_ratio(system)),
            curve_text(&curve),
        ]
        .join("\n"),
        provenance: Provenance::new(
            "critical state and transition curve",
            "closed forms and homogenised lattice",
            &[Topic::ClosedForms, Topic::Method(Method::Homogenised)],
            case.to_toml(),
        ),
        tables: vec![
            csv("critical_states.csv", &critical),
            csv("lattice_sums.csv", &sums),
            csv("transition_curve.csv", &curve),
        ],
        warnings: warnings(system, no_homogenised.as_ref()),
        converged: true,
    })
}

fn warnings(system: &System, no_homogenised: Option<&SolveError>) -> Vec<String> {
    let mut warnings = Vec::new();
    if system.lattice().offset != 0.0 {
        warnings.push(
            "the formulas are for a lens axis on a pillar; the offset is left out".to_owned(),
        );
    }
    if let Some(error) = no_homogenised {
        warnings.push(format!("no homogenised lattice: {error}"));
    }
    warnings
}

fn constants(system: &System) -> Constants {
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

/// All formulas, and the homogenised lattice itself, or why it gives no answer.
fn critical_rows(system: &System) -> (Vec<CriticalRow>, Option<SolveError>) {
    let mut rows: Vec<CriticalRow> = closed_forms(system).iter().map(formula_row).collect();
    match fakir::transition(system, Method::Homogenised, &Run::default()) {
        Ok(critical) => {
            rows.push(homogenised_row(&critical, !touches_one_pillar(system)));
            (rows, None)
        }
        Err(error) => (rows, Some(error)),
    }
}

fn formula_row(form: &ClosedForm) -> CriticalRow {
    let TransitionEstimate {
        force,
        indentation,
        top_contact_radius,
        floor_contact_distance,
    } = form.estimate;
    CriticalRow {
        formula: form.key,
        name: form.name,
        critical_force_N: force,
        critical_indentation_m: indentation,
        top_contact_radius_m: top_contact_radius,
        bottom_contact_distance_m: floor_contact_distance,
        applies: form.applies,
    }
}

fn homogenised_row(critical: &CriticalState, applies: bool) -> CriticalRow {
    CriticalRow {
        formula: "homogenised",
        name: "homogenised lattice",
        critical_force_N: critical.contact.force,
        critical_indentation_m: critical.contact.indentation,
        top_contact_radius_m: critical.contact.contact_radius,
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

/// The tabulated contact radii with the one of the large-contact formulas among them, in pitches.
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
    large_contact_radius(system, Form::Corrected) / system.lattice().pitch
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
    let contact_radius = ratio * system.lattice().pitch;
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

fn constants_text(constants: &Constants) -> String {
    let per_mpa = |value: f64| significant(value * 1e6, 6);
    let here = if constants.touches_one_pillar {
        "so it is here"
    } else {
        "not so here"
    };
    let mut list = QuantityList::default();
    list.quantity(
        "reduced modulus 1/c",
        constants.reduced_modulus_Pa,
        Dimension::Pressure,
        6,
        String::new(),
    )
    .row(
        "gamma_int",
        per_mpa(constants.internal_compliance_per_Pa),
        "1/MPa",
        "",
    )
    .row(
        "gamma_ext",
        per_mpa(constants.external_compliance_per_Pa),
        "1/MPa",
        "",
    )
    .row(
        "column compliance ratio",
        significant(constants.column_compliance_ratio, 6),
        "",
        "4 h/(pi E_s d c)",
    )
    .row(
        "one pillar only below",
        significant(constants.small_contact_limit, 4),
        "",
        &format!("surface fraction; {here}"),
    )
    .row(
        "homogenised model below",
        significant(constants.homogenised_limit, 4),
        "",
        "surface fraction",
    );
    list.text()
}

fn critical_text(rows: &[CriticalRow], constants: &Constants) -> String {
    let length = |name, value| Column::quantity(name, Dimension::Length, rows, value);
    let columns = [
        Column::text("Critical state", |row: &CriticalRow| row.name.to_owned()),
        Column::quantity("force", Dimension::Force, rows, |row| {
            Some(row.critical_force_N)
        }),
        length("indentation", |row| Some(row.critical_indentation_m)),
        length("top radius", |row| Some(row.top_contact_radius_m)),
        length("r_c", |row| Some(row.bottom_contact_distance_m)),
        Column::text("applies", |row| {
            if row.applies { "yes" } else { "no" }.to_owned()
        }),
    ];
    let in_text = with_unit(constants.contact_radius_in_text_m, Dimension::Length, 6);
    format!(
        "{}\nThe contact radius of the paper's text, sqrt(e^2 + phi R h), would be {in_text}.\n",
        table(rows, &columns)
    )
}

fn coefficients_text(rows: &[CoefficientRow]) -> String {
    let columns = [
        Column::text("Coefficient", |row: &CoefficientRow| {
            format!("{} in {}", row.name, row.formula)
        }),
        Column::number("paper", 4, |row| Some(row.paper)),
        Column::number("least squares", 6, |row| Some(row.least_squares)),
        Column::number("exact limit", 6, |row| Some(row.exact_limit)),
    ];
    let ([first, last], samples) = FIT;
    format!(
        "{}\nLeast squares on {samples} radii a/e from {first} to {last}; the limit is that of wide contacts.\n",
        table(rows, &columns)
    )
}

fn sums_text(rows: &[SumRow], own: f64) -> String {
    let sums = table(
        rows,
        &[
            Column::number("Lattice sums, a/e", 5, |row: &SumRow| {
                Some(row.contact_radius_in_pitches)
            }),
            Column::number("G0", 5, |row| Some(row.g0)),
            Column::number("fit", 5, |row| Some(row.g0_fit)),
            Column::number("G", 5, |row| Some(row.g)),
            Column::number("fit", 5, |row| Some(row.g_fit)),
            Column::number("G1", 5, |row| Some(row.g1)),
            Column::number("fit", 5, |row| Some(row.g1_fit)),
        ],
    );
    format!(
        "{sums}\nThe fits are those of the paper. {}\n",
        own_radius(own)
    )
}

/// Which of the tabulated radii is not a round number, and why it is there.
fn own_radius(own: f64) -> String {
    let own = significant(own, 5);
    format!("a/e = {own} is the contact radius of the large-contact formulas.")
}

fn curve_text(rows: &[CurveRow]) -> String {
    let force = |name, value| Column::quantity(name, Dimension::Force, rows, value);
    let length = |name, value| Column::quantity(name, Dimension::Length, rows, value);
    let curve = table(
        rows,
        &[
            Column::number("Transition curve, a/e", 5, |row: &CurveRow| {
                Some(row.contact_radius_in_pitches)
            }),
            length("a", |row| Some(row.contact_radius_m)),
            force("force", |row| Some(row.force_N)),
            force("by exact sums", |row| Some(row.force_from_exact_sums_N)),
            length("Hertz radius", |row| Some(row.hertz_contact_radius_m)),
        ],
    );
    format!(
        "{curve}\nUnder a smaller force at that contact radius the lens rests on pillar tops only; within\n\
         one pitch the outcome depends on where it lands. The Hertz radius is that of the lens on the\n\
         bare substrate under the force of the curve.\n"
    )
}
