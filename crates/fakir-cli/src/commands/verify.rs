//! `fakir verify`: the spectral method and Love elements on the same question.

use crate::failure::Failure;
use crate::numbers::{seconds, significant};
use crate::report::state::{VERSION, load_words, radius_digits, texture_line, warnings};
use crate::report::table::{Column, table};
use crate::report::{Report, csv, json};
use crate::session::Session;
use fakir::problem::ElementMesh;
use fakir::problem::{Accuracy, Load, Method};
use fakir::state::ContactState;
use fakir::{Difference, Question, Verdict, Verification};
use fakir_case::Case;
use fakir_case::unit::Dimension;
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::summary::RelativeErrors;
use serde::Serialize;
use std::time::Instant;

#[derive(Debug, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct AnswerRow {
    method: &'static str,
    cells_per_diameter: Option<usize>,
    #[serde(skip)]
    name: String,
    force_N: f64,
    indentation_m: f64,
    contact_radius_m: f64,
    smallest_floor_gap_m: f64,
    pillars_in_contact: usize,
    pillars_partially_in_contact: usize,
    force_error_estimate: f64,
    indentation_error_estimate: f64,
    contact_radius_error_estimate: f64,
    converged: bool,
    iterations: usize,
}

#[derive(Debug, Serialize)]
struct VerifyJson<'a> {
    question: &'static str,
    agree: bool,
    /// `agree`, `disagree` or `cannot tell`.
    verdict: &'static str,
    /// Why it cannot be told; none if it can.
    doubt: Option<String>,
    /// Elements on all cells from the spectral method.
    relative_difference: RelativeErrors,
    /// Sum of both error estimates.
    allowed_difference: RelativeErrors,
    answers: &'a [AnswerRow],
    wall_time_s: f64,
    fakir_version: &'static str,
}

pub(crate) fn run(
    case: &Case,
    load: Option<Load>,
    cells_per_diameter: usize,
    session: &Session,
) -> Result<Report, Failure> {
    let start = Instant::now();
    let question = load.map_or(Question::Transition, Question::Press);
    let mesh = match case.method {
        Method::Love(mesh) => mesh,
        _ => ElementMesh::default(),
    };
    let mesh = ElementMesh {
        cells_per_diameter,
        ..mesh
    };
    let verification = fakir::verify(&case.system, question, mesh, &session.run())?;
    let wall_time = start.elapsed().as_secs_f64();
    let rows: Vec<AnswerRow> = answers(&verification).map(row).collect();
    let verdict = verification.verdict();
    let Verification {
        force, indentation, ..
    } = verification;
    Ok(Report {
        json: json(&VerifyJson {
            question: match question {
                Question::Transition => "transition",
                Question::Press(Load::Indentation(_)) => "press at an indentation",
                Question::Press(Load::Force(_)) => "press under a force",
            },
            agree: verification.agrees(),
            verdict: verdict.name(),
            doubt: verdict.doubt().map(|doubt| doubt.to_string()),
            relative_difference: RelativeErrors {
                force: force.relative,
                indentation: indentation.relative,
                contact_radius: None,
                top_contact_radius: None,
            },
            allowed_difference: RelativeErrors {
                force: force.allowed,
                indentation: indentation.allowed,
                contact_radius: None,
                top_contact_radius: None,
            },
            answers: &rows,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }),
        text: text(case, &verification, &rows, wall_time),
        provenance: provenance(case, question, mesh),
        tables: vec![csv("verify.csv", &rows)],
        warnings: answers(&verification).flat_map(warnings).collect(),
        converged: verification.agrees(),
    })
}

fn provenance(case: &Case, question: Question, mesh: ElementMesh) -> Provenance {
    let methods = [Method::Spectral(Accuracy::Accurate), Method::Love(mesh)];
    Provenance::new(
        match question {
            Question::Transition => "critical state".to_owned(),
            Question::Press(load) => load_words(load),
        },
        methods.map(method_words).join(" against "),
        &methods.map(Topic::Method),
        case.to_toml(),
    )
}

fn answers(verification: &Verification) -> impl Iterator<Item = &ContactState> {
    std::iter::once(&verification.spectral).chain(&verification.elements)
}

fn row(state: &ContactState) -> AnswerRow {
    let cells = match state.method {
        Method::Love(mesh) => Some(mesh.cells_per_diameter),
        _ => None,
    };
    AnswerRow {
        method: state.method.name(),
        cells_per_diameter: cells,
        name: match cells {
            Some(cells) => format!("elements, {cells} cells"),
            None => "spectral, accurate".to_owned(),
        },
        force_N: state.force,
        indentation_m: state.indentation,
        contact_radius_m: state.contact_radius,
        smallest_floor_gap_m: state.smallest_floor_gap,
        pillars_in_contact: state.pillars_in_contact,
        pillars_partially_in_contact: state.pillars_partially_in_contact,
        force_error_estimate: state.error.force,
        indentation_error_estimate: state.error.indentation,
        contact_radius_error_estimate: state.relative_contact_radius_error(),
        converged: state.converged(),
        iterations: state.iterations,
    }
}

fn text(case: &Case, verification: &Verification, rows: &[AnswerRow], wall_time: f64) -> String {
    let columns = [
        Column::text("Answer", |row: &AnswerRow| row.name.clone()),
        Column::quantity("force", Dimension::Force, rows, |row| Some(row.force_N)),
        Column::right("error", |row| error(row.force_error_estimate)),
        Column::quantity("zeta", Dimension::Length, rows, |row| {
            Some(row.indentation_m)
        }),
        Column::right("error", |row| error(row.indentation_error_estimate)),
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
    ];
    let verdict = match verification.verdict() {
        Verdict::Agree => "The two methods agree within their error estimates".to_owned(),
        Verdict::Disagree => "THE TWO METHODS DISAGREE beyond their error estimates".to_owned(),
        Verdict::CannotTell(doubt) => format!("IT CANNOT BE TOLD whether they agree: {doubt}"),
    };
    format!(
        "Verification by an independent method\n{}\n\n{}\n{}{}\n{verdict}, in {}.\n",
        texture_line(&case.system),
        table(rows, &columns),
        difference("force", verification.force),
        difference("indentation", verification.indentation),
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

/// Nothing for what was prescribed.
fn difference(name: &str, difference: Difference) -> String {
    if difference.allowed == 0.0 {
        return String::new();
    }
    format!(
        "Difference in {name}: {:.1e}, allowed {:.1e}\n",
        difference.relative.abs(),
        difference.allowed
    )
}
