//! Control of a computation, as opposed to its definition: cancellation, progress, threads and memory.

use super::contact::ContactState;
use super::error::SolveError;
use crate::numerics::workers::{CancelToken, Workers};

/// Stage of a computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Computing the interaction of pillars.
    Coupling,
    /// Solving with one unknown per pillar, for an initial guess.
    Punch,
    /// Solving the full problem.
    Spectral,
    /// Solving the full problem with the floor in contact.
    Floor,
    /// Solving with boundary elements.
    Elements,
    /// Solving for a height map; reports cells instead of pillars.
    Surface,
    /// Loading and unloading with adhesion; reports events as steps.
    Cycle,
    /// Moving the fronts on an adhesive floor at constant indentation; reports iterations as steps.
    FloorFronts,
    /// Estimating the error.
    ErrorEstimate,
}

impl Stage {
    /// Description for output.
    #[must_use]
    pub fn description(self) -> &'static str {
        match self {
            Self::Coupling => "coupling of the pillars",
            Self::Punch => "punch lattice",
            Self::Spectral => "spectral solution",
            Self::Floor => "spectral solution with the floor",
            Self::Elements => "boundary elements",
            Self::Surface => "contact on a height map",
            Self::Cycle => "loading and unloading",
            Self::FloorFronts => "fronts on the floor",
            Self::ErrorEstimate => "error estimate",
        }
    }
}

/// A progress report of a running computation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Current stage.
    pub stage: Stage,
    /// Number of Newton steps in this stage.
    pub step: usize,
    /// Number of pillars in the window that is being solved.
    pub pillars: usize,
    /// Number of pillars in contact so far.
    pub touched: usize,
}

/// Control of a computation. By default, it runs on the calling thread, without reports.
#[derive(Clone, Default)]
pub struct Run<'a> {
    /// Stops the computation when cancelled.
    pub cancel: CancelToken,
    /// Called with the progress at every Newton step.
    pub progress: Option<&'a (dyn Fn(Progress) + Sync)>,
    /// Called with intermediate results of the spectral method for a contact: for more than a thousand pillars, the contact of the
    /// corrected punch lattice that is used as the initial guess (solved to three digits); and the solution before its error is estimated
    /// (the estimate is then NaN), which past the transition is that of the pillar tops alone, before floor contact. For a cycle, called
    /// with the critical state, before the lens jumps into contact with an adhesive floor. Not called for a prescribed force, or for a
    /// contact within one pillar. With boundary elements on pillar tops, called for every load with the results on coarser meshes of at
    /// least 8 cells across a pillar.
    pub interim: Option<&'a (dyn Fn(&ContactState) + Sync)>,
    /// Threads that share the work; `None` runs everything on the calling thread.
    pub pool: Option<&'a rayon::ThreadPool>,
    /// Memory limit, bytes; 8 GB if not set. Kernels of recent floor grids, which later solutions reuse, take up to 64 MB per process in
    /// addition.
    pub memory_limit: Option<usize>,
}

impl Run<'_> {
    /// The memory limit of the computation, bytes: as set, or 8 GB.
    #[must_use]
    pub fn memory_limit(&self) -> usize {
        // Addresses of WebAssembly have 32 bits.
        let usual = usize::try_from(8_000_000_000_u64).unwrap_or(usize::MAX);
        self.memory_limit.unwrap_or(usual)
    }

    /// Threads and cancellation of this computation.
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
