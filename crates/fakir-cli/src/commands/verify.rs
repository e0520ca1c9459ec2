//! `fakir verify`: the spectral method and Love elements on the same question.

use super::surface;
use crate::failure::{Failure, not_answered};
use crate::numbers::{DIGITS, seconds, significant};
use crate::report::Report;
use crate::report::state::{difference, radius_digits, texture_line};
use crate::report::table::{Column, table};
use crate::session::Session;
use fakir::problem::{Accuracy, ElementMesh, Load, Method, Question};
use fakir::state::ContactState;
use fakir::{Verdict, Verification};
use fakir_case::unit::Dimension;
use fakir_case::{AnyCase, Case};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::result::{AnswerRow, VerifySummary, control_words, csv, json, warnings};
use std::time::Instant;

/// A second opinion on a case of any kind that has one.
pub(crate) fn run(
    case: &AnyCase,
    load: Load,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    match case {
        AnyCase::Pillars(case) => of_pillars(case, load, cells_per_diameter, session),
        AnyCase::HeightMap(file) => surface::verify(file, load, cells_per_diameter, session),
        AnyCase::Asperities(_) => Err(not_answered(Question::Verify)),
    }
}

fn of_pillars(
    case: &Case,
    control: Load,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let mesh = match case.method {
        Method::Love(mesh) => mesh,
        _ => ElementMesh::default(),
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        ..mesh
    };
    let verification = fakir::verify(&case.system, control, mesh, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let summary = VerifySummary::new(control, &verification, wall_time);
    Ok(Report {
        json: json(&summary),
        text: text(case, &verification, summary.answers(), wall_time),
        provenance: provenance(case, control, mesh),
        tables: vec![csv("verify.csv", summary.answers())],
        warnings: answers(&verification)
            .into_iter()
            .flat_map(warnings)
            .collect(),
        converged: verification.agrees(),
        strained: Vec::new(),
    })
}

fn provenance(case: &Case, control: Load, mesh: ElementMesh) -> Provenance {
    let methods = [Method::Spectral(Accuracy::Accurate), Method::Love(mesh)];
    Provenance::new(
        control_words(control),
        methods.map(method_words).join(" against "),
        &methods.map(Topic::Method),
        case.to_toml(),
    )
}

/// What is compared. The coarse mesh is there for the difference from it alone.
fn answers(verification: &Verification) -> [&ContactState; 2] {
    [&verification.spectral, &verification.elements[1]]
}

fn text(case: &Case, verification: &Verification, rows: &[AnswerRow], wall_time: f64) -> String {
    let mut columns = vec![
        Column::text("Answer", |row: &AnswerRow| row.name.clone()),
        Column::quantity("force", Dimension::Force, rows, |row| Some(row.force_N)),
        Column::right("error", |row| error(row.force_error_estimate)),
        Column::quantity("zeta", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::right("error", |row| error(row.indentation_error_estimate)),
    ];
    if verification.floor_share.is_some() {
        columns.push(Column::number("on the floor", DIGITS, |row| {
            row.floor_share
        }));
        columns.push(Column::right("error", |row| {
            row.floor_share_error_estimate.map_or("-".to_owned(), error)
        }));
    }
    columns.extend([
        Column::radius(
            "radius",
            rows,
            |row| Some(row.contact_radius_m),
            |row| radius_digits(row.contact_radius_error_estimate),
        ),
        Column::right("pillars", |row| row.pillars_in_contact.to_string()),
        Column::right("partially", |row| {
            row.pillars_partially_in_contact.to_string()
        }),
    ]);
    let verdict = match verification.verdict() {
        Verdict::Agree => "The two methods agree within their error estimates".to_owned(),
        Verdict::Disagree => "THE TWO METHODS DISAGREE beyond their error estimates".to_owned(),
        Verdict::CannotTell(doubt) => format!("IT CANNOT BE TOLD whether they agree: {doubt}"),
    };
    format!(
        "Verification by an independent method\n{}\n\n{}\n{}{}{}\n{verdict}, in {}.\n",
        texture_line(&case.system),
        table(rows, &columns),
        difference("force", verification.force),
        difference("indentation", verification.indentation),
        verification
            .floor_share
            .map_or(String::new(), |share| difference(
                "the share of the floor",
                share
            )),
        seconds(wall_time)
    )
}

/// An error estimate; none of what was prescribed.
fn error(value: f64) -> String {
    if value > 0.0 {
        significant(value, 1)
    } else {
        "-".to_owned()
    }
}
