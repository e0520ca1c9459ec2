//! Files for other programs and for print, identical to those of the command line.

use crate::answers::{Solved, solve};
use crate::cycle::SolvedCycle;
use crate::hold::{self, Held};
use crate::lines::hold_texts;
use crate::refusal::Refusal;
use crate::request::{self, LoadPoint};
use crate::shown::Shown;
use crate::worker::{Failure, File, Worker};
use fakir::problem::{Load, Point};
use fakir::state::{Contact, ContactState, Run};
use fakir_case::{AnyCase, Case, Key};
use fakir_figure::{Figure, cycle_curve, release_map};
use fakir_study::citations::Topic;
use fakir_study::figures::history_figure;
use fakir_study::provenance::{Provenance, method_words};
use fakir_study::record::Record;
use fakir_study::result::{
    CycleSummary, HistorySummary, control_words, json, pillars, press, transition,
};

const FIGURES: [&str; 5] = [
    "pressure-map",
    "profiles",
    "top-view",
    "floor-gap-map",
    "phase-diagram",
];

/// Figures of loading and unloading with adhesion.
const CYCLE_FIGURES: [&str; 2] = ["cycle", "releases"];

const JSON: &str = "application/json";
const CSV: &str = "text/csv; charset=utf-8";
const TOML: &str = "application/toml";
const SVG: &str = "image/svg+xml";
const PNG: &str = "image/png";

/// `POST /api/export`: `case.toml`, `summary.json`, `pillars.csv`, or a figure such as
/// `pressure-map.svg` or `profiles.png`.
pub(crate) fn export(request: &request::Export, worker: &Worker) -> Result<(), Failure> {
    request.load.check()?;
    let case = match request::any_case(&request.case, request.table.as_ref())? {
        AnyCase::Pillars(case) => *case,
        AnyCase::Asperities(case) => return contact_file(&*case, request, worker),
        AnyCase::Flat(case) => return contact_file(&*case, request, worker),
        AnyCase::HeightMap(_) => return Err(request::on_a_height_map().into()),
    };
    let (name, extension) = request.file.rsplit_once('.').unwrap_or_default();
    let file = match (name, extension) {
        ("case", "toml") => File {
            kind: TOML,
            contents: match &request.hold {
                None => case.to_toml(),
                Some(hold) => hold_texts(&case, hold).case_file().to_owned(),
            }
            .into_bytes(),
        },
        ("history", "json" | "csv" | "svg" | "png") => history(case, request, extension, worker)?,
        ("summary", "json") => File {
            kind: JSON,
            contents: solved(&case, request, worker)?.summary(),
        },
        ("pillars", "csv") => {
            let solved = solved(&case, request, worker)?;
            let state = solved.state();
            let table = state.and_then(|state| pillars(state).some_csv("pillars.csv"));
            File {
                kind: CSV,
                contents: table.ok_or_else(no_pillars)?.contents,
            }
        }
        (name, "svg" | "png") if FIGURES.contains(&name) || CYCLE_FIGURES.contains(&name) => {
            let solved = solved(&case, request, worker)?;
            let figure = figure(name, &case, &solved, &worker.run())?
                .with_provenance(&provenance(&case, &solved).stamp());
            picture(&figure, extension)
        }
        _ => {
            return Err(Refusal::impossible("there is no such file")
                .at("file")
                .accepted(format!(
                    "case.toml, summary.json, pillars.csv, or {}, or with adhesion {}, as .svg or .png; over time history.json, history.csv, history.svg, history.png",
                    FIGURES.join(", "),
                    CYCLE_FIGURES.join(", ")
                ))
                .into());
        }
    };
    worker.send_file(file);
    Ok(())
}

/// A file of a contact on another surface than pillars with flat tops.
fn contact_file<S: Shown>(
    case: &S,
    request: &request::Export,
    worker: &Worker,
) -> Result<(), Failure> {
    let (name, extension) = request.file.rsplit_once('.').unwrap_or_default();
    let (method, topics, text) = case.provenance();
    if request.file == "case.toml" {
        worker.send_file(File {
            kind: TOML,
            contents: text.into_bytes(),
        });
        return Ok(());
    }
    let solved = solve(case, request.load, worker, None, |_, _| {})?;
    let (state, wall_time) = solved.state().ok_or(Failure::Cancelled)?;
    let file = match (name, extension) {
        ("summary", "json") => {
            let object = match (&solved.pressed, &solved.critical) {
                (None, Some((critical, time))) => case.critical(critical, *time),
                _ => case.summary(state, wall_time),
            };
            File {
                kind: JSON,
                contents: format!("{}\n", json(&object)).into_bytes(),
            }
        }
        ("pillars", "csv") => File {
            kind: CSV,
            contents: case.pillar_table(state).ok_or_else(no_pillars)?,
        },
        (name, "svg" | "png") => {
            let question = match &solved.pressed {
                None => "critical state".to_owned(),
                Some((state, _)) => control_words(Load::Indentation(state.indentation())),
            };
            let floor_contact = solved.floor_contact();
            let figure = case.figure(name, &question, state, floor_contact, &worker.run())?;
            let stamp = Provenance::new(question, method, &topics, text).stamp();
            picture(&figure.with_provenance(&stamp), extension)
        }
        _ => {
            return Err(Refusal::impossible("there is no such file")
                .at("file")
                .into());
        }
    };
    worker.send_file(file);
    Ok(())
}

/// The load over time: its numbers, the table of its states, or their figure.
fn history(
    case: Case,
    request: &request::Export,
    extension: &str,
    worker: &Worker,
) -> Result<File, Failure> {
    let Some(hold) = &request.hold else {
        return Err(Refusal::impossible("no load is held over time")
            .at("hold")
            .into());
    };
    let Held { case, found } = hold::solve(case, hold, worker)?;
    Ok(match extension {
        "json" => File {
            kind: JSON,
            contents: format!("{}\n", json(&HistorySummary::new(&case, &found))).into_bytes(),
        },
        "csv" => File {
            kind: CSV,
            contents: Record::csv(&found.rows()),
        },
        _ => {
            let question = hold.course().words();
            let stamp = Provenance::new(
                question,
                method_words(case.method),
                &[Topic::Viscoelastic],
                case.to_toml(),
            )
            .stamp();
            picture(&history_figure(&found)?.with_provenance(&stamp), extension)
        }
    })
}

/// A figure as a file with this extension, `svg` or `png`.
fn picture(figure: &Figure, extension: &str) -> File {
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

/// Data of a file.
enum Answer {
    Contact(Box<Solved<ContactState>>),
    /// Loading and unloading with adhesion, and the contact at a load.
    Cycle(Box<SolvedCycle>, Box<ContactState>, LoadPoint),
}

impl Answer {
    fn state(&self) -> Option<&ContactState> {
        match self {
            Self::Contact(solved) => solved.state().map(|(state, _)| state),
            Self::Cycle(_, state, _) => Some(state),
        }
    }

    fn floor_contact(&self) -> Option<Point> {
        match self {
            Self::Contact(solved) => solved.floor_contact(),
            Self::Cycle(solved, _, load) => solved.floor_contact(solved.place_at(load.fraction)),
        }
    }

    /// Output of `fakir transition --json`, `fakir press --json` or `fakir cycle --json`.
    fn summary(&self) -> Vec<u8> {
        let text = match self {
            Self::Cycle(solved, ..) => json(&CycleSummary::new(&solved.cycle, solved.wall_time)),
            Self::Contact(solved) => match (&solved.pressed, &solved.critical) {
                (Some((state, time)), _) => json(&press(state, None, None, *time)),
                (None, Some((critical, time))) => json(&transition(critical, None, None, *time)),
                (None, None) => return Vec::new(),
            },
        };
        format!("{text}\n").into_bytes()
    }

    fn question(&self) -> String {
        let at = |state: &ContactState| control_words(Load::Indentation(state.indentation));
        match self {
            Self::Contact(solved) => match &solved.pressed {
                None => "critical state".to_owned(),
                Some((state, _)) => at(state),
            },
            Self::Cycle(solved, state, load) => {
                let place = solved.place_at(load.fraction);
                match solved.cycle.stations.get(place) {
                    Some(station) if solved.critical != Some(place) => {
                        format!("{}, {}", station.branch.name(), at(state))
                    }
                    _ => "critical state".to_owned(),
                }
            }
        }
    }
}

fn solved(case: &Case, request: &request::Export, worker: &Worker) -> Result<Answer, Failure> {
    let load = request.load;
    if case.system.adhesion().is_none() {
        let solved = solve(case, load, worker, None, |_, _| {})?;
        return Ok(Answer::Contact(Box::new(solved)));
    }
    let solved = SolvedCycle::of_page(case, worker, None)?.0;
    let state = solved.state(solved.place_at(load.fraction));
    Ok(Answer::Cycle(Box::new(solved), Box::new(state), load))
}

fn no_pillars() -> Refusal {
    Refusal::impossible("no pillar is touched, or the method does not resolve pillars").at("file")
}

fn provenance(case: &Case, solved: &Answer) -> Provenance {
    Provenance::new(
        solved.question(),
        method_words(case.method),
        &Topic::of_case(case),
        case.to_toml(),
    )
}

fn figure(name: &str, case: &Case, solved: &Answer, run: &Run<'_>) -> Result<Figure, Failure> {
    let figure = match (name, solved) {
        ("cycle", Answer::Cycle(solved, ..)) => cycle_curve(&solved.cycle),
        ("releases", Answer::Cycle(solved, ..)) => release_map(&solved.cycle),
        ("cycle" | "releases", Answer::Contact(_)) => {
            return Err(Refusal::impossible("without adhesion there is no cycle")
                .at(Key::WorkOfAdhesion.path())
                .into());
        }
        _ => {
            let Some(state) = solved.state() else {
                return Err(Failure::Cancelled);
            };
            let (question, floor_contact) = (solved.question(), solved.floor_contact());
            return case.figure(name, &question, state, floor_contact, run);
        }
    };
    Ok(figure?)
}
