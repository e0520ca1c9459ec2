//! The contact of viscoelastic bodies over time.

/// An elastic contact at an indentation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticSample {
    /// Indentation, m.
    pub indentation: f64,
    /// Normal force, N.
    pub force: f64,
    /// Force on the floor, N; 0 before the transition and without a floor.
    pub floor_force: f64,
    /// Contact radius, m; NaN where there is none.
    pub contact_radius: f64,
    /// Number of pillars in contact, if there are pillars.
    pub pillars_in_contact: Option<usize>,
    /// Estimated relative error of the force.
    pub error: f64,
}

/// How a state of a history was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Approximation {
    /// By superposition of elastic contacts: exact while the contact only grows.
    Superposition,
    /// By time steps.
    Steps,
}

impl Approximation {
    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Superposition => "superposition",
            Self::Steps => "steps",
        }
    }
}

/// A state of a history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HistoryState {
    /// Time since the beginning of the protocol, s.
    pub time: f64,
    /// Normal force, N.
    pub force: f64,
    /// Indentation, m. Of a lens that has detached, that at which it would touch the recovering surface.
    pub indentation: f64,
    /// Indentation of the elastic contact that covers the same area, m.
    pub contact_indentation: f64,
    /// Force on the floor, N.
    pub floor_force: f64,
    /// How it was computed.
    pub by: Approximation,
}

/// What happens in a history.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HistoryEventKind {
    /// The lens touches the surface.
    FirstContact,
    /// The lens touches the surface again, which it had left.
    Recontact,
    /// The lens reaches the floor.
    FloorContact,
    /// The contact begins to recede.
    LargestContact,
    /// The contact, which receded, begins to grow.
    SmallestContact,
    /// The lens leaves the floor.
    FloorLost,
    /// The lens leaves the surface.
    Detachment,
}

impl HistoryEventKind {
    /// Its name in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::FirstContact => "first contact",
            Self::Recontact => "contact again",
            Self::FloorContact => "floor contact",
            Self::LargestContact => "largest contact",
            Self::SmallestContact => "smallest contact",
            Self::FloorLost => "floor lost",
            Self::Detachment => "detachment",
        }
    }
}

/// An event of a history.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HistoryEvent {
    /// Its time, s.
    pub time: f64,
    /// Estimated error of its time, s, without that of the elastic contacts.
    pub time_error: f64,
    /// What happens.
    pub kind: HistoryEventKind,
    /// Force, N.
    pub force: f64,
    /// Indentation, m.
    pub indentation: f64,
}

/// The contact of viscoelastic bodies over time.
#[derive(Debug, Clone, PartialEq)]
pub struct History {
    /// The states in order. Before and after a step of no duration, there are two of the same time.
    pub states: Vec<HistoryState>,
    /// The events in order.
    pub events: Vec<HistoryEvent>,
    /// Time at which the lens reaches the floor, s: in the protocol, or later if its last load is held. `None` if it never does.
    pub time_to_floor_contact: Option<f64>,
    /// The state in which the bodies are relaxed if the last load is held for ever.
    pub equilibrium: HistoryState,
    /// Time from which force and indentation stay within 1 % of that, s: in the protocol, or later if the last load is held. `None` if it
    /// is later and the contact has receded.
    pub time_to_equilibrium: Option<f64>,
    /// Estimated error of the force and of that on the floor, relative to the largest force, without that of the elastic contacts.
    pub force_error: f64,
    /// Estimated error of the indentation, relative to the largest, without that of the elastic contacts.
    pub indentation_error: f64,
    /// Number of time steps, those of the superposition too.
    pub steps: usize,
}
