//! Files for other programs and for print: as the command line saves them.

use crate::answers::{Solved, solve};
use crate::jobs::{Failure, File, Worker};
use crate::refusal::Refusal;
use crate::request;
use fakir::problem::Control;
use fakir::state::{ContactState, Run};
use fakir_case::Case;
use fakir_figure::{
    Figure, FigureError, PhaseDiagram, ProfileState, Series, Style, Text, View, floor_gap_map,
    phase_diagram, phase_point, pressure_map, profiles, top_view,
};
use fakir_study::citations::Topic;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::result::{PressSummary, TransitionSummary, control_words, json, pillars};

const FIGURES: [&str; 5] = [
    "pressure-map",
    "profiles",
    "top-view",
    "floor-gap-map",
    "phase-diagram",
];

const JSON: &str = "application/json";
const CSV: &str = "text/csv; charset=utf-8";
const TOML: &str = "application/toml";
const SVG: &str = "image/svg+xml";
const PNG: &str = "image/png";

/// `POST /api/export`: `case.toml`, `summary.json`, `pillars.csv`, or a figure such as
/// `pressure-map.svg` or `profiles.png`.
pub(crate) fn export(request: &request::Export, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case)?;
    request.load.check()?;
    let (name, extension) = request.file.rsplit_once('.').unwrap_or_default();
    let file = match (name, extension) {
        ("case", "toml") => File {
            kind: TOML,
            contents: case.to_toml().into_bytes(),
        },
        ("summary", "json") => File {
            kind: JSON,
            contents: summary(&solved(&case, request, worker)?),
        },
        ("pillars", "csv") => {
            let solved = solved(&case, request, worker)?;
            let table = solved
                .state()
                .and_then(|(state, _)| pillars(state).some_csv("pillars.csv"));
            File {
                kind: CSV,
                contents: table.ok_or_else(no_pillars)?.contents,
            }
        }
        (name, "svg" | "png") if FIGURES.contains(&name) => {
            let solved = solved(&case, request, worker)?;
            let figure = figure(name, &case, &solved, &worker.run())?
                .with_provenance(&provenance(&case, &solved).stamp());
            match extension {
                "svg" => File {
                    kind: SVG,
                    contents: figure.svg().into_bytes(),
                },
                _ => File {
                    kind: PNG,
                    contents: figure.png(),
                },
            }
        }
        _ => {
            return Err(Refusal::impossible("there is no such file")
                .at("file")
                .accepted(format!(
                    "case.toml, summary.json, pillars.csv, or {} as .svg or .png",
                    FIGURES.join(", ")
                ))
                .into());
        }
    };
    worker.send_file(file);
    Ok(())
}

fn solved(case: &Case, request: &request::Export, worker: &Worker) -> Result<Solved, Failure> {
    solve(case, request.load, worker, None, |_, _| {})
}

fn no_pillars() -> Refusal {
    Refusal::impossible("no pillar is touched, or the method does not resolve pillars").at("file")
}

/// What `fakir transition --json` or `fakir press --json` prints.
fn summary(solved: &Solved) -> Vec<u8> {
    let text = match (&solved.pressed, &solved.critical) {
        (Some((state, time)), _) => json(&PressSummary::new(state, *time)),
        (None, Some((critical, time))) => json(&TransitionSummary::new(critical, *time)),
        (None, None) => return Vec::new(),
    };
    format!("{text}\n").into_bytes()
}

fn question(solved: &Solved) -> String {
    match &solved.pressed {
        None => "critical state".to_owned(),
        Some((state, _)) => control_words(Control::Indentation(state.indentation)),
    }
}

fn provenance(case: &Case, solved: &Solved) -> Provenance {
    Provenance::new(
        question(solved),
        method_words(case.method),
        &[Topic::Method(case.method)],
        case.to_toml(),
    )
}

fn figure(name: &str, case: &Case, solved: &Solved, run: &Run<'_>) -> Result<Figure, FigureError> {
    let Some((state, _)) = solved.state() else {
        return Err(FigureError::NoPillars {
            method: case.method.name(),
        });
    };
    let floor_contact = solved.floor_contact();
    match name {
        "profiles" => {
            let section = ProfileState {
                label: Text::plain(&question(solved)),
                state,
                floor_contact,
            };
            profiles(&[section], run)
        }
        "top-view" => top_view(state, View::Contact, run),
        "floor-gap-map" => floor_gap_map(state, run),
        "phase-diagram" => Ok(phase(case, state)),
        _ => pressure_map(state, floor_contact),
    }
}

/// The phase diagram with the state that is shown.
fn phase(case: &Case, state: &ContactState) -> Figure {
    let fraction = case.system.texture().surface_fraction();
    let label = format!("*φ* = {fraction:.4}");
    phase_diagram(&PhaseDiagram {
        system: case.system,
        critical: vec![Series::new(
            Text::from(label),
            vec![phase_point(&case.system, state.force, state.contact_radius)],
            Style::marks(0),
        )],
        paths: Vec::new(),
        shares: Vec::new(),
    })
}
