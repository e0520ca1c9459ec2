//! How a computation is run, as opposed to what is computed: cancellation,
//! progress, threads and memory.

use super::contact::ContactState;
use super::error::SolveError;
use crate::numerics::workers::{CancelToken, Workers};

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
    /// Solving in full with the floor in contact.
    Floor,
    /// Solving by elements.
    Elements,
    /// Solving for a height map; it reports cells in place of pillars.
    Surface,
    /// Loading and unloading with adhesion; it reports events as steps.
    Cycle,
    /// Moving the fronts on a floor that sticks, at one indentation; it reports rounds as steps.
    FloorFronts,
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
            Self::Floor => "spectral solution with the floor",
            Self::Elements => "Love elements",
            Self::Surface => "contact on a height map",
            Self::Cycle => "loading and unloading",
            Self::FloorFronts => "fronts on the floor",
            Self::ErrorEstimate => "error estimate",
        }
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
    /// its own solution before the error is estimated (the estimate is then NaN): past the transition that of the pillar tops
    /// alone, before the floor. Of a cycle the critical state, before the lens jumps onto a floor that sticks. Not told under a prescribed force, or of a
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

    /// What shares the work of this computation.
    pub(crate) fn workers(&self) -> Workers<'_> {
        Workers {
            pool: self.pool,
            cancel: &self.cancel,
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
