//! `fakir compare`: the critical state by every method, coarse to exact.

use crate::failure::Failure;
use crate::numbers::{seconds, significant};
use crate::session::Session;
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_study::citations::Topic;
use fakir_study::compare::{compare, methods};
use fakir_study::provenance::Provenance;
use fakir_study::report::Report;
use fakir_study::report::state::{pillar_pattern_line, radius_digits};
use fakir_study::report::table::{Column, table};
use fakir_study::result::{CompareSummary, MethodRow, csv, json};

pub(crate) fn run(case: &Case, session: &Session) -> Result<Report, Failure> {
    let next = |part: &str| session.part(part);
    let found = compare(&case.system, &session.run(), &next, &mut |_, _, _| {})?;
    let methods = methods().map(|(method, ..)| Topic::Method(method));
    let provenance = Provenance::new(
        "critical state",
        "every method, coarse to exact",
        &[&[Topic::ClosedForms], methods.as_slice()].concat(),
        case.to_toml(),
    );
    Ok(Report {
        json: json(&found.summary),
        text: text(case, &found.summary),
        provenance,
        tables: vec![csv("compare.csv", &found.summary.methods)],
        converged: found.summary.converged,
        exceeded: Vec::new(),
        warnings: found.warnings,
    })
}

/// The relative error that is assumed of a closed form, so that two digits of it are shown.
const MODEL_ERROR: f64 = 0.1;

fn text(case: &Case, summary: &CompareSummary) -> String {
    let (rows, threads) = (&summary.methods, summary.threads);
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
    let adhesive = if case.system.adhesion().is_none() {
        ""
    } else {
        "\nOnly the method spectral has adhesion: the other numbers are without it, and confirm nothing of it.\n"
    };
    let remarks: String = rows
        .iter()
        .filter_map(|row| Some(format!("  {}: {}\n", row.name, row.remark.as_ref()?)))
        .collect();
    let against = summary.reference_name().map_or(String::new(), |name| {
        format!("\nDifferences are from \"{name}\"; threads: {threads}.\n")
    });
    format!(
        "Comparison of methods\n{}\n\n{}{against}{remarks}{adhesive}",
        pillar_pattern_line(&case.system),
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
