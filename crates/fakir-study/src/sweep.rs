//! Solves the cases of a study on several threads.

use crate::answer::{AnswerError, Details, Request, Running, answer};
use crate::collapsed::collapse;
use crate::error::StudyError;
use crate::history::{HistoryCourse, HistoryPlan};
use crate::plan::{Costed, Plan, Shard, longest_first};
use crate::row::{Row, RowAnswer};
use fakir::state::{CancelToken, Run, SolveError, Termination, Threads};
use fakir_case::Study;
use fakir_case::study::{Question, StudyCase};
use std::any::Any;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant};

/// Interval in which the calling thread checks for cancellation and reports progress.
const TICK: Duration = Duration::from_millis(50);

/// Execution options of a sweep; the results do not depend on them.
#[derive(Default)]
pub struct Options<'a> {
    /// Number of threads; 0 for the number of processors, which is the maximum. Every case is computed by one thread.
    pub threads: usize,
    /// Stops the sweep when cancelled.
    pub cancel: CancelToken,
    /// Memory limit of a single case, bytes; 8 GB if not set.
    pub memory_limit: Option<usize>,
    /// The part of the sweep to compute.
    pub shard: Shard,
    /// Called several times per second with the progress, on the calling thread.
    pub on_progress: Option<&'a mut dyn FnMut(Progress)>,
}

/// Progress of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Cases with a row, including those found in the journal.
    pub done: usize,
    /// Cases found in the journal.
    pub found: usize,
    /// Cases done without a reliable result.
    pub failed: usize,
    /// Total number of cases of this shard.
    pub cases: usize,
    /// Completed fraction of the work that was not in the journal, from 0 to 1. A rough estimate: the cost of cases varies widely, and the
    /// most expensive ones come first.
    pub work: f64,
}

/// Computes every case of a study, or of a shard of it, in memory: rows in the order of the study.
///
/// A case that fails has a row too.
///
/// # Errors
/// [`StudyError::Interrupted`].
pub fn sweep(study: &Study, options: &mut Options<'_>) -> Result<Vec<Row>, StudyError> {
    let mut rows = BTreeMap::new();
    complete(study, &mut rows, options, |_| Ok(()))?;
    Ok(rows.into_values().collect())
}

/// Computes some cases of a study sequentially on the calling thread, each within a memory limit in bytes (8 GB if not set).
///
/// # Errors
/// [`StudyError::Interrupted`] if it is cancelled.
pub fn solve(
    study: &Study,
    cases: &[usize],
    memory_limit: Option<usize>,
    cancel: &CancelToken,
) -> Result<Vec<Row>, StudyError> {
    let shared = SharedSweep {
        study,
        chains: Vec::new(),
        known: BTreeSet::new(),
        next: AtomicUsize::new(0),
        stop: cancel.clone(),
        memory_limit,
    };
    let mut rows = Vec::with_capacity(cases.len());
    for index in cases {
        let row = shared.row(*index).ok_or(StudyError::Interrupted {
            done: rows.len(),
            cases: cases.len(),
        })?;
        rows.push(row);
    }
    Ok(rows)
}

/// Computes the cases of a shard that are not among the `rows`, and adds them. New rows are first passed to `keep`, in the order in which
/// they are computed.
pub(crate) fn complete(
    study: &Study,
    rows: &mut BTreeMap<usize, Row>,
    options: &mut Options<'_>,
    mut keep: impl FnMut(&[Row]) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let plan = Plan::new(study, options.shard);
    let mut progress = Progress {
        done: rows.len(),
        found: rows.len(),
        failed: failed(rows.values()),
        cases: plan.chains().map(|chain| chain.len()).sum(),
        work: 0.0,
    };
    let known = rows.keys().copied().collect();
    let shared = SharedSweep::new(study, &plan, known, options.memory_limit);
    let total = shared.cost();
    let mut outcome = Ok(());
    std::thread::scope(|scope| {
        let threads = Threads::asked(options.threads).number();
        // The bounded channel blocks threads while the journal is slower.
        let (sender, receiver) = sync_channel(threads);
        for _ in 0..threads.min(shared.chains.len()) {
            let (shared, sender) = (&shared, sender.clone());
            scope.spawn(move || shared.run(&sender));
        }
        drop(sender); // every thread has its own sender; the channel closes when all threads are done
        loop {
            let (new, costs): (Vec<Row>, Vec<f64>) = match receiver.recv_timeout(TICK) {
                Ok(row) => std::iter::once(row).chain(receiver.try_iter()).unzip(),
                Err(RecvTimeoutError::Timeout) => (Vec::new(), Vec::new()),
                Err(RecvTimeoutError::Disconnected) => break,
            };
            if !new.is_empty() && outcome.is_ok() {
                outcome = keep(&new);
            }
            if options.cancel.is_cancelled() || outcome.is_err() {
                shared.stop.cancel();
            }
            progress.done += new.len();
            progress.failed += failed(&new);
            progress.work += costs.iter().sum::<f64>() / total;
            rows.extend(new.into_iter().map(|row| (row.index, row)));
            if let Some(listener) = &mut options.on_progress {
                listener(progress);
            }
        }
    });
    outcome?;
    if progress.done < progress.cases {
        return Err(StudyError::Interrupted {
            done: progress.done,
            cases: progress.cases,
        });
    }
    Ok(())
}

fn failed<'a>(rows: impl IntoIterator<Item = &'a Row>) -> usize {
    let rows = rows.into_iter();
    rows.filter(|row| row.problem.is_some()).count()
}

/// Shared state of the threads of a sweep.
struct SharedSweep<'a> {
    study: &'a Study,
    chains: Vec<Costed>,
    /// Cases that already have a row.
    known: BTreeSet<usize>,
    /// The next chain to be computed.
    next: AtomicUsize,
    stop: CancelToken,
    memory_limit: Option<usize>,
}

impl<'a> SharedSweep<'a> {
    fn new(
        study: &'a Study,
        plan: &Plan,
        known: BTreeSet<usize>,
        memory_limit: Option<usize>,
    ) -> Self {
        let is_open = |chain: &Range<usize>| chain.clone().any(|case| !known.contains(&case));
        let chains = longest_first(study, plan.chains().filter(is_open));
        Self {
            study,
            chains,
            known,
            next: AtomicUsize::new(0),
            stop: CancelToken::default(),
            memory_limit,
        }
    }

    /// Total cost of all chains, in arbitrary units.
    fn cost(&self) -> f64 {
        let cost = |chain: &Costed| {
            let cases = chain.cases.clone();
            let open = cases.filter(|case| !self.known.contains(case));
            chain.cost * open.count() as f64
        };
        self.chains.iter().map(cost).sum()
    }

    /// Computes one chain after the other, until none is left or the sweep is stopped.
    fn run(&self, sender: &SyncSender<(Row, f64)>) {
        while let Some(chain) = self.chains.get(self.next.fetch_add(1, Ordering::Relaxed)) {
            for index in chain.cases.clone() {
                if self.known.contains(&index) {
                    continue;
                }
                let Some(row) = self.row(index) else {
                    return; // stopped
                };
                if sender.send((row, chain.cost)).is_err() {
                    return;
                }
            }
        }
    }

    /// The row of a case; `None` if the sweep is stopped.
    fn row(&self, index: usize) -> Option<Row> {
        if self.stop.is_cancelled() {
            return None;
        }
        let start = Instant::now();
        let case = self.study.case(index);
        // A panic in one case must not discard the others.
        let outcome = catch_unwind(AssertUnwindSafe(|| self.solve(&case)));
        let (answer, problem) = match outcome {
            Ok(Ok(answered)) => answered,
            Ok(Err(AnswerError::Solve(SolveError::Interrupted))) => return None,
            Ok(Err(error)) => (None, Some(error.to_string())),
            Err(panic) => (None, Some(defect(panic.as_ref()))),
        };
        Some(Row {
            index,
            coordinates: case.coordinates,
            answer,
            problem,
            wall_time: start.elapsed().as_secs_f64(),
        })
    }

    /// The answer to a case, and the reason if it is not reliable.
    fn solve(&self, case: &StudyCase) -> Result<(Option<RowAnswer>, Option<String>), AnswerError> {
        let run = Run {
            cancel: self.stop.clone(),
            memory_limit: self.memory_limit,
            ..Run::default()
        };
        let request = match (case.question, case.case.pattern()) {
            (Question::Contact(load), _) => Request::Contact(load),
            (Question::Cycle(plan), _) => Request::Cycle(plan),
            (Question::Collapse, Some(pattern)) => {
                let (collapsed, termination) = collapse(&pattern.system, pattern.method, &run)?;
                let problem = (termination != Termination::Converged)
                    .then(|| termination.description().to_owned());
                return Ok((Some(RowAnswer::Collapse(Box::new(collapsed))), problem));
            }
            (Question::Hold(hold), _) => {
                let Some(relaxation) = case.relaxation.clone() else {
                    unreachable!("studies of holds refuse elastic bodies")
                };
                Request::History(HistoryPlan {
                    relaxation,
                    course: HistoryCourse::Hold {
                        load: hold.load,
                        ramp: hold.ramp_time,
                        duration: hold.hold_time,
                        back: false,
                    },
                })
            }
            (Question::Collapse, None) => {
                unreachable!("studies refuse adhesion on other surfaces")
            }
        };
        let running = Running { run, next: &|_| {} };
        let answer = answer(&case.case, &request, &Details::default(), &running)?;
        let numbers = answer.records().pop();
        Ok((numbers.map(RowAnswer::Numbers), answer.problem()))
    }
}

fn defect(panic: &(dyn Any + Send)) -> String {
    let message = panic
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| panic.downcast_ref::<&str>().copied());
    format!(
        "a defect of fakir, please report it: {}",
        message.unwrap_or("no message")
    )
}
