//! Viscoelastic bodies over time: a load that is reached in a time and held, as `fakir hold` computes it, with the position of every state on the
//! slider of the load. While the contact only grows, it is the elastic contact at the same contact indentation, so that map and section of any
//! time are those of a load.

use crate::clock::Moment;
use crate::lines;
use crate::refusal::Refusal;
use crate::request::{self, FARTHEST, GivenFile, GivenHold, Ticket, Values, expected_pillars};
use crate::shown::{floor_carries_load, position};
use crate::worker::{Failure, Worker};
use fakir::problem::Load;
use fakir::state::SolveError;
use fakir_case::{Case, Key};
use fakir_study::approach::ApproachError;
use fakir_study::history::{Followed, HistoryPlan, follow_untimed};
use fakir_study::result::HistorySummary;
use serde::{Deserialize, Serialize};

/// Largest number of pillars in contact at the critical state with which a history is computed while one waits: an elastic curve has tens of
/// contacts, each of up to a tenth of a second.
const MOST_PILLARS: f64 = 4_000.0;

/// Largest number of pillars at which contacts with the floor are computed.
const MOST_ON_FLOOR: f64 = 1_500.0;

/// `POST /api/hold`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    pub(crate) ticket: Ticket,
    case: Values,
    /// Contents of the table of pillars, if the case names one.
    #[serde(default)]
    table: Option<GivenFile>,
    hold: GivenHold,
}

#[derive(Serialize)]
struct HistoryLine {
    history: History,
}

#[derive(Serialize)]
struct History {
    /// As `fakir hold --json` prints it.
    summary: HistorySummary,
    /// Load of each state: the fraction of the way to the critical state at which the elastic contact covers the same area.
    loads: Vec<f64>,
    /// The case and the question for other uses.
    case: lines::Texts,
}

/// A history and its case.
pub(crate) struct Held {
    pub(crate) case: Case,
    pub(crate) found: Followed<Case>,
}

/// Computes the history, unless it takes too long or the page cannot show its states.
pub(crate) fn solve(case: Case, hold: &GivenHold, worker: &Worker) -> Result<Held, Failure> {
    hold.check()?;
    let relaxation = case.relaxation.clone().ok_or_else(|| {
        Refusal::impossible("the bodies are elastic: their contact does not change with time")
            .at(Key::RelaxationStrengths.path())
            .accepted("a strength and a relaxation time, as 1 and 10 s")
    })?;
    let command = || lines::hold_texts(&case, hold).command.trim_end().to_owned();
    let too_slow = |words: String| {
        Refusal::impossible(words).at("hold").accepted(format!(
            "fewer pillars or a smaller load; or the command, which takes its time: {}",
            command()
        ))
    };
    let pillars = expected_pillars(&case.system);
    if pillars > MOST_PILLARS {
        return Err(too_slow(format!(
            "a history of about {} pillars in contact takes too long for the page",
            request::significant(pillars)
        ))
        .into());
    }
    let run = worker.run();
    let is_dense = floor_carries_load(&case) && pillars > MOST_ON_FLOOR;
    if is_dense && case.system.adhesion().is_none() {
        // The relaxed critical state decides whether the floor is reached in the end.
        let critical = fakir::transition(&case.system, case.method, &run)?.contact;
        let exceeds = match hold.load() {
            Load::Force(force) => force > critical.force,
            Load::Indentation(indentation) => indentation > critical.indentation,
            Load::FloorContact => false,
        };
        if exceeds {
            return Err(too_slow(format!(
                "a history in which about {} pillars and the floor between them are in contact takes too long for the page",
                request::significant(pillars)
            ))
            .into());
        }
    }
    let plan = HistoryPlan {
        relaxation,
        course: hold.course(),
    };
    let start = Moment::now();
    let mut found = follow_untimed(&case, &plan, &run, &|_| {}).map_err(failure)?;
    found.wall_time = start.elapsed().as_secs_f64();
    Ok(Held { case, found })
}

/// `POST /api/hold`
pub(crate) fn answer(request: &Request, worker: &Worker) -> Result<(), Failure> {
    let case = request::case(&request.case, request.table.as_ref())?;
    let hold = &request.hold;
    let held = solve(case, hold, worker)?;
    let Held { case, found } = &held;
    let critical = match &found.critical {
        Some(critical) => critical.contact.indentation,
        None => {
            fakir::transition(&case.system, case.method, &worker.run())?
                .contact
                .indentation
        }
    };
    let states = found.history.states.iter();
    let loads: Vec<f64> = states
        .map(|state| position(case, critical, state.contact_indentation))
        .collect();
    let farthest = loads.iter().copied().fold(0.0, f64::max);
    if farthest > FARTHEST {
        return Err(Refusal::impossible(format!(
            "the bodies creep to {farthest:.2} times the critical indentation, more than the page shows"
        ))
        .at("hold")
        .accepted(format!(
            "a smaller load, or a shorter hold: up to {FARTHEST} times; or the command: {}",
            lines::hold_texts(case, hold).command.trim_end()
        ))
        .into());
    }
    worker.send(&HistoryLine {
        history: History {
            summary: HistorySummary::new(case, found),
            loads,
            case: lines::hold_texts(case, hold),
        },
    });
    Ok(())
}

fn failure(error: ApproachError) -> Failure {
    match error {
        ApproachError::Solve(SolveError::Interrupted) => Failure::Cancelled,
        other => Refusal::impossible(other.to_string()).at("hold").into(),
    }
}
