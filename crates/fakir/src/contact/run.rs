//! How a computation is run, as opposed to what is computed: cancellation,
//! progress, threads, memory; and how it ended.

use super::{ContactState, SolveError};
use rayon::prelude::*;
use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that asks a running computation to stop.
///
/// Clones share the flag. The solvers look at it at every iteration.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the computation to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What a computation is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Preparing the influence of pillars on each other.
    Coupling,
    /// Solving with one unknown per pillar, as a start.
    Punch,
    /// Solving in full.
    Spectral,
    /// Solving by elements.
    Elements,
    /// Solving for a height map; it reports cells in place of pillars.
    Surface,
    /// Estimating the error.
    ErrorEstimate,
}

impl Stage {
    /// A few words for a person.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Coupling => "coupling of the pillars",
            Self::Punch => "punch lattice",
            Self::Spectral => "spectral solution",
            Self::Elements => "Love elements",
            Self::Surface => "contact on a height map",
            Self::ErrorEstimate => "error estimate",
        }
    }
}

/// Threads to share work between: as many as were asked for, but no more than there are processors.
/// More would only wait for each other, and thousands of them take long to start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Threads {
    asked: usize,
    processors: usize,
}

impl Threads {
    /// So many; 0 for as many as there are processors.
    #[must_use]
    pub fn asked(asked: usize) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        Self { asked, processors }
    }

    /// How many there are to be.
    #[must_use]
    pub fn number(self) -> usize {
        match self.asked {
            0 => self.processors,
            asked => asked.min(self.processors),
        }
    }

    /// What to tell who asked for more than that.
    #[must_use]
    pub fn warning(self) -> Option<String> {
        let Self { asked, processors } = self;
        (asked > processors).then(|| {
            format!("{asked} threads are more than there are processors: {processors} are used")
        })
    }
}

/// A report from a running computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What it is doing.
    pub stage: Stage,
    /// Newton steps taken in this stage.
    pub step: usize,
    /// Pillars in the window that is being solved.
    pub pillars: usize,
    /// Pillars touched so far.
    pub touched: usize,
}

/// How a computation is run. The default runs on the calling thread, silently.
#[derive(Clone, Default)]
pub struct Run<'a> {
    /// Stops the computation when cancelled.
    pub cancel: CancelToken,
    /// Told what is going on, every Newton step.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Told what there is on the way to a contact by the spectral method: with more than a thousand
    /// pillars the contact of the corrected punch lattice, from which it starts (solved to three digits), and
    /// its own solution before the error is estimated (the estimate is then NaN). Not told under a prescribed force, or of a
    /// contact inside one pillar.
    pub interim: Option<&'a (dyn Fn(&ContactState) + Sync)>,
    /// Threads to share the work between; without it everything runs on the calling thread.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Most memory to use, bytes; 8 GB if not set.
    pub memory_limit: Option<usize>,
}

impl Run<'_> {
    /// Memory a computation may take, bytes: what was set, or 8 GB.
    #[must_use]
    pub fn memory_limit(&self) -> usize {
        self.memory_limit.unwrap_or(8_000_000_000)
    }

    /// The threads, if there are enough `tasks` for more than one.
    fn threads(&self, tasks: usize) -> Option<&rayon::ThreadPool> {
        self.pool
            .filter(|pool| tasks > 1 && pool.current_num_threads() > 1)
    }

    /// `one` of every number below `count`, in their order. A thread takes at least `least` of them at a
    /// time, and makes itself a `work` to do them with.
    pub(crate) fn map<W, T: Send>(
        &self,
        count: usize,
        least: usize,
        work: impl Fn() -> W + Sync + Send,
        one: impl Fn(&mut W, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        match self.threads(count / least) {
            Some(pool) => pool.install(|| {
                let numbers = (0..count).into_par_iter().with_min_len(least);
                numbers.map_init(work, one).collect()
            }),
            None => {
                let mut work = work();
                (0..count).map(|number| one(&mut work, number)).collect()
            }
        }
    }

    /// Does `one` to every piece of `length` values, which it is told by number; threads as in
    /// [`Self::map`].
    pub(crate) fn fill<W, T: Send>(
        &self,
        values: &mut [T],
        length: usize,
        least: usize,
        work: impl Fn() -> W + Sync + Send,
        one: impl Fn(&mut W, usize, &mut [T]) + Sync + Send,
    ) {
        match self.threads(values.len().div_ceil(length) / least) {
            Some(pool) => pool.install(|| {
                let pieces = values.par_chunks_mut(length).enumerate();
                pieces
                    .with_min_len(least)
                    .for_each_init(work, |work, (number, piece)| one(work, number, piece));
            }),
            None => {
                let mut work = work();
                for (number, piece) in values.chunks_mut(length).enumerate() {
                    one(&mut work, number, piece);
                }
            }
        }
    }

    pub(crate) fn report(&self, progress: Progress) {
        if let Some(listener) = self.progress {
            listener(progress);
        }
    }

    pub(crate) fn check_cancelled(&self) -> Result<(), SolveError> {
        if self.cancel.is_cancelled() {
            Err(SolveError::Interrupted)
        } else {
            Ok(())
        }
    }
}

/// Why a solver stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Termination {
    /// The contact conditions hold to the tolerance.
    Converged,
    /// The limit on Newton steps was reached first; the numbers are not the solution.
    IterationLimit,
    /// Steps no longer improved the solution; the numbers are not the solution.
    Stagnated,
    /// A number of the solver became infinite or undefined; the numbers are not the solution.
    NotFinite,
    /// The caller asked to stop.
    Interrupted,
}

impl Termination {
    /// A sentence for a person.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "did not converge: the limit on steps was reached",
            Self::Stagnated => "did not converge: the steps no longer improve the solution",
            Self::NotFinite => "did not converge: a number became infinite or undefined",
            Self::Interrupted => "interrupted",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_no_more_than_processors() {
        let of = |asked| Threads {
            asked,
            processors: 4,
        };
        assert_eq!(
            [0, 1, 4, 5, 9999].map(|asked| of(asked).number()),
            [4, 1, 4, 4, 4]
        );
        assert_eq!(
            [0, 1, 4].map(|asked| of(asked).warning()),
            [None, None, None]
        );
        let told = of(9999).warning().unwrap();
        assert_eq!(
            told,
            "9999 threads are more than there are processors: 4 are used"
        );
    }
}
