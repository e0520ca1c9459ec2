//! Results: the contact under a load, the critical state, fields, error estimates, and errors.
//!
//! *Top contact* is governed by `p >= 0`, `gap >= 0`, `p gap = 0` on the pillar tops, where `gap = f - h + w + column - zeta` with `f` the
//! undeformed lens above the floor and `zeta` the indentation: the displacement of the lens from the position in which its lowest point is
//! level with the pillar tops. The gap to the floor between the pillars is `Delta = f + w - zeta`; the *critical state* is the smallest
//! indentation at which it vanishes somewhere.

mod areas;
pub(crate) mod asperity_contact;
pub(crate) mod asperity_cycle;
pub(crate) mod asperity_elements;
pub(crate) mod asperity_fields;
pub(crate) mod asperity_gradient;
mod cell_means;
pub(crate) mod checked;
pub(crate) mod contact;
pub(crate) mod critical;
pub(crate) mod cycle;
pub(crate) mod discs;
pub(crate) mod error;
pub(crate) mod fields;
pub(crate) mod finite;
pub(crate) mod flat;
pub(crate) mod floor_contact;
pub(crate) mod gradient;
pub(crate) mod history;
pub(crate) mod limit;
mod resolution;
pub(crate) mod run;
mod samples;
mod shared;
pub(crate) mod surface;
pub(crate) mod surface_cycle;

pub use crate::numerics::workers::{CancelToken, Threads};
pub use asperity_contact::{
    AsperityContact, AsperityErrors, AsperityFloorGap, AsperitySlopes, AsperityState,
};
pub use asperity_cycle::{AsperityCycle, AsperityCycleErrors, AsperityEvent, AsperityLoadStep};
pub use asperity_elements::{AsperityElements, FloorElements};
pub use asperity_fields::AsperityFields;
pub use asperity_gradient::{AsperityDerivatives, AsperityGradient};
pub use contact::{ContactState, ErrorEstimate, PillarState, PillarStatus, Termination, Warning};
pub use critical::{Critical, CriticalState, Normalized, Regime};
pub use cycle::{
    AdhesiveFloorErrors, Branch, Cycle, CycleError, CycleErrors, CycleEvent, CycleEventKind,
    CycleLoadStep, FloorResolution, HeldContact, HeldFloor, HeldPillar, Passage, PullOff,
};
pub use error::SolveError;
pub use fields::Fields;
pub use flat::{FlatContact, FlatCycle, FlatErrors, FlatLoadStep};
pub use floor_contact::{FloorContact, FloorErrors};
pub use gradient::{Derivatives, Gradient};
pub use history::{
    Approximation, ElasticSample, History, HistoryEvent, HistoryEventKind, HistoryState,
};
pub use limit::Limit;
pub use resolution::{LARGEST_ERROR, Remedy, Unresolved};
pub use run::{Progress, Run, Stage};
pub use samples::FieldSamples;
pub(crate) use samples::{sample_cells, sample_points};
pub use shared::{Contact, Solution};
pub use surface::{
    DualityGap, LoadSharing, OnLargerCells, Share, SurfaceContact, SurfaceTransition,
};
pub use surface_cycle::{SurfaceCycle, SurfaceCycleErrors, SurfaceLoadStep};

/// Former name of [`AdhesiveFloorErrors`].
#[deprecated(note = "renamed to `AdhesiveFloorErrors`")]
pub type StuckFloorErrors = AdhesiveFloorErrors;

/// Former name of [`AsperityContact`].
#[deprecated(note = "renamed to `AsperityContact`")]
pub type CapContact = AsperityContact;

/// Former name of [`AsperityErrors`].
#[deprecated(note = "renamed to `AsperityErrors`")]
pub type CapErrors = AsperityErrors;

/// Former name of [`AsperitySlopes`].
#[deprecated(note = "renamed to `AsperitySlopes`")]
pub type CapSlopes = AsperitySlopes;

/// Former name of [`AsperityState`].
#[deprecated(note = "renamed to `AsperityState`")]
pub type CapState = AsperityState;

/// Former name of [`CycleLoadStep`].
#[deprecated(note = "renamed to `CycleLoadStep`")]
pub type CycleStation = CycleLoadStep;

/// Former name of [`DualityGap`].
#[deprecated(note = "renamed to `DualityGap`")]
pub type Certificate = DualityGap;

/// Former name of [`LoadSharing`].
#[deprecated(note = "renamed to `LoadSharing`")]
pub type Shares = LoadSharing;
