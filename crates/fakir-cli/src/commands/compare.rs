//! `fakir compare`: the critical state by every method, coarse to exact.

use super::closed_forms::closed_forms;
use crate::failure::Failure;
use crate::numbers::{seconds, significant};
use crate::report::state::{VERSION, radius_digits, texture_line, warnings};
use crate::report::table::{Column, table};
use crate::report::{Report, csv, json};
use crate::session::Session;
use fakir::problem::ElementMesh;
use fakir::problem::{Accuracy, Method, PunchForm};
use fakir::state::{CriticalState, SolveError};
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_study::citations::Topic;
use fakir_study::provenance::Provenance;
use serde::Serialize;
use std::time::Instant;

/// The methods that solve something, coarse to exact.
fn methods() -> [(Method, &'static str, &'static str); 6] {
    [
        (Method::Homogenised, "homogenised", "homogenised lattice"),
        (
            Method::Punch(PunchForm::Plain),
            "punch_plain",
            "punch, plain",
        ),
        (
            Method::Punch(PunchForm::Corrected),
            "punch_corrected",
            "punch, corrected",
        ),
        (
            Method::Love(ElementMesh::default()),
            "love",
            "Love elements",
        ),
        (
            Method::Spectral(Accuracy::Default),
            "spectral_default",
            "spectral, default",
        ),
        (
            Method::Spectral(Accuracy::Accurate),
            "spectral_accurate",
            "spectral, accurate",
        ),
    ]
}

/// A critical state by one method. What a method does not give is `None`.
#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct MethodRow {
    method: &'static str,
    #[serde(skip)]
    name: &'static str,
    critical_force_N: Option<f64>,
    critical_indentation_m: Option<f64>,
    critical_contact_radius_m: Option<f64>,
    pillars_in_contact: Option<usize>,
    /// Relative to the reference.
    force_difference: Option<f64>,
    indentation_difference: Option<f64>,
    force_error_estimate: Option<f64>,
    contact_radius_error_estimate: Option<f64>,
    converged: bool,
    iterations: Option<usize>,
    wall_time_s: Option<f64>,
    processor_time_s: Option<f64>,
    /// Why there is no answer, or that a formula is used out of its range.
    remark: Option<String>,
}

#[derive(Debug, Serialize)]
struct CompareJson<'a> {
    surface_fraction: f64,
    pitch_m: f64,
    reference: Option<&'static str>,
    methods: &'a [MethodRow],
    threads: usize,
    converged: bool,
    fakir_version: &'static str,
}

pub(crate) fn run(case: &Case, session: &Session) -> Result<Report, Failure> {
    let mut rows = closed_form_rows(case);
    let mut all_warnings = Vec::new();
    for (method, key, name) in methods() {
        session.part(name);
        let clock = Clock::start();
        let row = match fakir::transition(&case.system, method, &session.run()) {
            Ok(critical) => {
                let of_method = warnings(&critical.contact).into_iter();
                all_warnings.extend(of_method.map(|text| format!("{name}: {text}")));
                solved_row(key, name, &critical, &clock)
            }
            Err(SolveError::Interrupted) => return Err(SolveError::Interrupted.into()),
            Err(error) => refused_row(key, name, &error),
        };
        rows.push(row);
    }
    let reference = set_differences(&mut rows);
    let converged = rows.iter().all(|row| row.converged);
    let methods = methods().map(|(method, ..)| Topic::Method(method));
    let provenance = Provenance::new(
        "critical state",
        "every method, coarse to exact",
        &[&[Topic::ClosedForms], methods.as_slice()].concat(),
        case.to_toml(),
    );
    Ok(Report {
        json: json(&CompareJson {
            surface_fraction: case.system.texture().surface_fraction(),
            pitch_m: case.system.lattice().pitch,
            reference: reference.map(|(key, _)| key),
            methods: &rows,
            threads: session.threads(),
            converged,
            fakir_version: VERSION,
        }),
        text: text(
            case,
            &rows,
            reference.map(|(_, name)| name),
            session.threads(),
        ),
        provenance,
        tables: vec![csv("compare.csv", &rows)],
        warnings: all_warnings,
        converged,
    })
}

fn closed_form_rows(case: &Case) -> Vec<MethodRow> {
    closed_forms(&case.system)
        .into_iter()
        .map(|form| MethodRow {
            critical_force_N: Some(form.estimate.force),
            critical_indentation_m: Some(form.estimate.indentation),
            critical_contact_radius_m: Some(form.estimate.contact_radius()),
            contact_radius_error_estimate: None,
            converged: true,
            remark: (!form.applies).then(|| "out of its range".to_owned()),
            ..empty_row(form.key, form.name)
        })
        .collect()
}

fn solved_row(
    key: &'static str,
    name: &'static str,
    critical: &CriticalState,
    clock: &Clock,
) -> MethodRow {
    let state = &critical.contact;
    MethodRow {
        critical_force_N: Some(state.force),
        critical_indentation_m: Some(state.indentation),
        critical_contact_radius_m: Some(critical.contact_radius()),
        contact_radius_error_estimate: Some(critical.relative_contact_radius_error()),
        pillars_in_contact: Some(state.pillars_in_contact),
        force_error_estimate: Some(state.error.force),
        converged: state.converged(),
        iterations: Some(state.iterations),
        wall_time_s: Some(clock.wall_time()),
        processor_time_s: clock.processor_time(),
        remark: (!state.converged()).then(|| state.termination.description().to_owned()),
        ..empty_row(key, name)
    }
}

/// A method that does not apply is no failure of the comparison.
fn refused_row(key: &'static str, name: &'static str, error: &SolveError) -> MethodRow {
    MethodRow {
        converged: true,
        remark: Some(error.to_string()),
        ..empty_row(key, name)
    }
}

fn empty_row(method: &'static str, name: &'static str) -> MethodRow {
    MethodRow {
        method,
        name,
        critical_force_N: None,
        critical_indentation_m: None,
        critical_contact_radius_m: None,
        contact_radius_error_estimate: None,
        pillars_in_contact: None,
        force_difference: None,
        indentation_difference: None,
        force_error_estimate: None,
        converged: false,
        iterations: None,
        wall_time_s: None,
        processor_time_s: None,
        remark: None,
    }
}

/// Fills in the differences from the most accurate method that gave an answer, and names it.
fn set_differences(rows: &mut [MethodRow]) -> Option<(&'static str, &'static str)> {
    let best = rows
        .iter()
        .rfind(|row| row.wall_time_s.is_some() && row.converged)?;
    let reference = (best.method, best.name);
    let (force, indentation) = (best.critical_force_N, best.critical_indentation_m);
    let difference = |value: Option<f64>, reference: Option<f64>| match (value, reference) {
        (Some(value), Some(reference)) if reference != 0.0 => Some(value / reference - 1.0),
        _ => None,
    };
    for row in rows.iter_mut().filter(|row| row.method != reference.0) {
        row.force_difference = difference(row.critical_force_N, force);
        row.indentation_difference = difference(row.critical_indentation_m, indentation);
    }
    Some(reference)
}

/// Of a closed form: two digits are shown.
const MODEL_ERROR: f64 = 0.1;

fn text(case: &Case, rows: &[MethodRow], reference: Option<&str>, threads: usize) -> String {
    let columns = [
        Column::text("Critical state", |row: &MethodRow| row.name.to_owned()),
        Column::quantity("force", Dimension::Force, rows, |row| row.critical_force_N),
        Column::right("diff.", |row| per_cent(row.force_difference)),
        Column::quantity("zeta", Dimension::Length, rows, |row| {
            row.critical_indentation_m
        }),
        Column::right("diff.", |row| per_cent(row.indentation_difference)),
        Column::radius(
            "radius",
            rows,
            |row| row.critical_contact_radius_m,
            |row| radius_digits(row.contact_radius_error_estimate.unwrap_or(MODEL_ERROR)),
        ),
        Column::right("pillars", |row| {
            row.pillars_in_contact
                .map_or("-".to_owned(), |n| n.to_string())
        }),
        Column::right("time", |row| {
            row.wall_time_s.map_or("-".to_owned(), seconds)
        }),
        Column::right("processor", |row| {
            row.processor_time_s.map_or("-".to_owned(), seconds)
        }),
    ];
    let remarks: String = rows
        .iter()
        .filter_map(|row| Some(format!("  {}: {}\n", row.name, row.remark.as_ref()?)))
        .collect();
    let against = reference.map_or(String::new(), |name| {
        format!("\nDifferences are from \"{name}\"; threads: {threads}.\n")
    });
    format!(
        "Comparison of methods\n{}\n\n{}{against}{remarks}",
        texture_line(&case.system),
        table(rows, &columns),
    )
}

/// A relative difference in per cent, in parts per million where it is small.
fn per_cent(difference: Option<f64>) -> String {
    match difference {
        None => "-".to_owned(),
        Some(value) if value.abs() >= 1e-4 => {
            let sign = if value > 0.0 { "+" } else { "" };
            format!("{sign}{} %", significant(100.0 * value, 2))
        }
        Some(value) => format!("{:+.1e}", value),
    }
}

/// Wall and processor time of a piece of work.
struct Clock {
    start: Instant,
    processor_start: Option<f64>,
}

impl Clock {
    fn start() -> Self {
        Self {
            start: Instant::now(),
            processor_start: processor_time(),
        }
    }

    fn wall_time(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn processor_time(&self) -> Option<f64> {
        Some(processor_time()? - self.processor_start?)
    }
}

/// Processor time of the process so far, s; `None` where the system does not tell.
#[cfg(unix)]
fn processor_time() -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(ClockId::ProcessCPUTime);
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn processor_time() -> Option<f64> {
    None
}
