//! The answer to a question about a case of any kind: its numbers, and the report that a command prints and saves.
//!
//! ```
//! use fakir::problem::Load;
//! use fakir::state::Run;
//! use fakir_case::{AnyCase, Case};
//! use fakir_study::answer::{Details, Request, Running, answer};
//!
//! let case = AnyCase::Pillars(Box::new(Case::example()));
//! let running = Running { run: Run::default(), next: &|_| {} };
//! let request = Request::Contact(Load::Force(20e-6));
//! let answer = answer(&case, &request, &Details::default(), &running)?;
//! assert!(answer.records()[0].number("indentation_m").is_some());
//! assert!(answer.report(&running)?.text.starts_with("Contact under load"));
//! # Ok::<(), fakir_study::answer::AnswerError>(())
//! ```

mod asperities;
mod contact;
mod cycle;
mod flat;
mod height_map;
mod history;
mod kind;
mod loading;
mod pillars;
mod request;
mod surface_cycle;

pub use asperities::{quantities_of_tops, turn_and_pull_off_of_tops};
pub use cycle::turn_and_pull_off;
pub use flat::{quantities_of_flat, turn_and_pull_off_of_flat};
pub use height_map::load_and_shares;
pub use request::{AnswerError, Details, Maps, Request, Running};
pub use surface_cycle::turn_and_pull_off_of_surface;

use crate::citations::Topic;
use crate::provenance::Provenance;
use crate::record::Record;
use crate::report::Report;
use crate::report::state::exceeded_limits;
use crate::surfaces::on_wide_enough_a_grid;
use fakir::state::Run;
use fakir_case::{AnyCase, CaseError};
use kind::{Context, Found, Kind, Saved};
use std::borrow::Cow;
use std::time::Instant;

/// The answer to a question about a case.
pub struct Answer<'a>(Box<dyn Answered + 'a>);

impl Answer<'_> {
    /// The numbers: one record, or one for every state of a loading.
    #[must_use]
    pub fn records(&self) -> Vec<Record> {
        self.0.records()
    }

    /// The reason why the numbers are not reliable; `None` if they are.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        self.0.problem()
    }

    /// The complete output of a command, printed and saved.
    ///
    /// # Errors
    /// [`AnswerError`] of a computation for a warning or a map, also where it is interrupted.
    pub fn report(&self, running: &Running<'_>) -> Result<Report, AnswerError> {
        self.0.report(running)
    }
}

/// Answers a question about a case.
///
/// # Errors
/// See [`AnswerError`].
pub fn answer<'a>(
    case: &'a AnyCase,
    request: &Request,
    details: &Details,
    running: &Running<'_>,
) -> Result<Answer<'a>, AnswerError> {
    match case {
        AnyCase::Pillars(case) => of_case(&**case, request, details, running),
        AnyCase::Asperities(case) => of_case(&**case, request, details, running),
        AnyCase::Flat(case) => of_case(&**case, request, details, running),
        AnyCase::HeightMap(file) => {
            let start = Instant::now();
            let limit = running.run.memory_limit();
            let solved = on_wide_enough_a_grid(file, limit, AnswerError::needed_width, |case| {
                solve(case, request, details, running)
            })?;
            Ok(Answer(Box::new(Solved {
                case: Cow::Owned(solved.case),
                found: solved.answer,
                details: *details,
                widened: solved.widened,
                wall_time: start.elapsed().as_secs_f64(),
            })))
        }
    }
}

/// A case in words, for reports.
#[derive(Debug, Clone, PartialEq)]
pub struct Described {
    /// The case and the method, a line each.
    pub lines: [String; 2],
    /// The method, for the provenance.
    pub method: String,
    /// The method, for what is to be cited.
    pub cited_as: String,
    /// What is to be cited.
    pub topics: Vec<Topic>,
    /// The case as a case file.
    pub text: String,
}

/// Describes a case in words.
///
/// # Errors
/// [`CaseError`] for a general surface that cannot be read or drawn.
pub fn described(case: &AnyCase) -> Result<Described, CaseError> {
    fn of(case: &impl Kind) -> Described {
        Described {
            lines: case.lines(),
            method: case.method(),
            cited_as: case.cited_as(),
            topics: topics(case, None),
            text: case.text(),
        }
    }
    Ok(match case {
        AnyCase::Pillars(case) => of(&**case),
        AnyCase::Asperities(case) => of(&**case),
        AnyCase::Flat(case) => of(&**case),
        AnyCase::HeightMap(file) => of(&file.surface_case(Run::default().memory_limit())?),
    })
}

/// Topics to cite for a case.
fn topics(case: &impl Kind, range: Option<f64>) -> Vec<Topic> {
    let mut topics = case.topics(range);
    topics.extend(Topic::of_interactions(case.interactions()));
    topics
}

/// A rough estimate of the cost of a contact, in a unit that depends on the kind of surface; for a general surface, the number of cells.
pub(crate) fn cost(case: &AnyCase, cells: usize) -> f64 {
    match case {
        AnyCase::Pillars(case) => pillars::cost(&case.system, case.method),
        AnyCase::Asperities(case) => case.field.asperities().len() as f64,
        AnyCase::Flat(_) => 1.0,
        AnyCase::HeightMap(_) => cells.max(1) as f64,
    }
}

fn of_case<'a, K: Kind>(
    case: &'a K,
    request: &Request,
    details: &Details,
    running: &Running<'_>,
) -> Result<Answer<'a>, AnswerError> {
    let start = Instant::now();
    let found = solve(case, request, details, running)?;
    Ok(Answer(Box::new(Solved {
        case: Cow::Borrowed(case),
        found,
        details: *details,
        widened: None,
        wall_time: start.elapsed().as_secs_f64(),
    })))
}

fn solve<K: Kind>(
    case: &K,
    request: &Request,
    details: &Details,
    running: &Running<'_>,
) -> Result<Box<dyn Found<K>>, AnswerError> {
    case.check(request, details, &running.run)?;
    match request {
        Request::Contact(load) => contact::contact(case, *load, details, &running.run),
        Request::Loading(path) => loading::loading(case, path, running),
        Request::Cycle(plan) => case.cycle(*plan, running),
        Request::History(plan) => history::history_of(case, plan, running),
    }
}

/// An answer about a case of one kind.
struct Solved<'a, K: Kind> {
    case: Cow<'a, K>,
    found: Box<dyn Found<K>>,
    details: Details,
    /// A message if the grid is wider than that of the case.
    widened: Option<String>,
    /// s.
    wall_time: f64,
}

/// An answer about a case of any kind.
trait Answered {
    fn records(&self) -> Vec<Record>;

    fn problem(&self) -> Option<String>;

    fn report(&self, running: &Running<'_>) -> Result<Report, AnswerError>;
}

impl<K: Kind> Answered for Solved<'_, K> {
    fn records(&self) -> Vec<Record> {
        self.found.records(&self.case)
    }

    fn problem(&self) -> Option<String> {
        self.found.problem()
    }

    fn report(&self, running: &Running<'_>) -> Result<Report, AnswerError> {
        let (case, found): (&K, _) = (&self.case, &self.found);
        let of = Context {
            case,
            details: &self.details,
            wall_time: self.wall_time,
        };
        let topics = [topics(case, self.details.range), found.topics()].concat();
        let provenance = Provenance::new(found.question(), case.method(), &topics, case.text());
        let mut warnings = found.warnings(&of, running)?;
        let saved = match self.details.maps {
            Maps::None => Saved::default(),
            Maps::Points(points) => found.files(case, points, &provenance, running)?,
        };
        warnings.extend(saved.warnings);
        warnings.extend(self.widened.clone());
        Ok(Report {
            json: found.json(&of),
            text: found.text(&of),
            provenance,
            tables: saved.files,
            warnings,
            converged: found.is_answer(),
            exceeded: exceeded_limits(&found.limits(&of)),
        })
    }
}
