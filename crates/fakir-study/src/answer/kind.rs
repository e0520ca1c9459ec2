//! What answers about cases of one kind consist of. Each kind of surface has one file, which implements [`Kind`]; everything else is the same for all.

use super::request::{AnswerError, Details, Request, Running};
use crate::approach::{Loadable, unsupported};
use crate::citations::Topic;
use crate::output::File;
use crate::provenance::Provenance;
use crate::record::{GradientObject, Record};
use crate::report::state::QuantityList;
use fakir::problem::{CyclePlan, Load, Point, Question, Solver};
use fakir::state::{Critical, Limit, Regime, Run};

/// Contacts of cases of this kind.
pub(super) type ContactOf<K> = <<K as Kind>::Problem as Loadable>::Contact;

/// A case of one kind of surface.
pub(super) trait Kind: Clone + 'static {
    /// What is solved.
    type Problem: Loadable;

    fn problem(&self) -> &Self::Problem;

    fn solver(&self) -> Solver;

    /// `"lens"` or `"plate"`.
    fn indenter(&self) -> &'static str;

    /// The case and the method, a line each, as reports begin.
    fn lines(&self) -> [String; 2];

    /// The method in words, for the provenance.
    fn method(&self) -> String;

    /// The method in words, for what is to be cited.
    fn cited_as(&self) -> String {
        self.method()
    }

    /// What is to be cited.
    fn topics(&self, range: Option<f64>) -> Vec<Topic>;

    /// The case as a case file.
    fn text(&self) -> String;

    /// Refuses requests that do not go with the case, before a long computation.
    fn check(&self, request: &Request, details: &Details, run: &Run<'_>)
    -> Result<(), AnswerError>;

    /// A contact or a critical state with its derivatives.
    fn with_gradient(
        &self,
        _: Load,
        _: &Run<'_>,
    ) -> Result<(Reached<ContactOf<Self>>, GradientObject), AnswerError> {
        Err(unsupported(Question::Gradient, self.solver()).into())
    }

    /// Loading and unloading.
    fn cycle(&self, _: CyclePlan, _: &Running<'_>) -> Result<Box<dyn Found<Self>>, AnswerError> {
        Err(unsupported(Question::Cycle, self.solver()).into())
    }

    fn record(&self, found: &Reached<ContactOf<Self>>) -> Record;

    /// How near a contact comes to where the model ends; none if the kind has no such limits.
    fn limits(&self, contact: &ContactOf<Self>, range: Option<f64>) -> Option<Vec<Limit>>;

    /// The effects that are not computed, in words, if there are any.
    fn left_out(&self, _: &ContactOf<Self>) -> Option<&'static str> {
        None
    }

    /// What the indenter meets first, in words.
    fn meets(&self, regime: Regime) -> String;

    /// The quantities of a report, but for the limits of the model and the solution.
    fn quantities(&self, found: &Reached<ContactOf<Self>>) -> QuantityList;

    /// How the contact was solved: the last row of a report.
    fn solution(&self, list: &mut QuantityList, contact: &ContactOf<Self>, wall_time: f64);

    /// Warnings that need a further computation.
    fn further_warnings(
        &self,
        _: &ContactOf<Self>,
        _: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        Ok(Vec::new())
    }

    /// Tables, maps of so many points across, and figures of a contact.
    fn files(
        &self,
        found: &Reached<ContactOf<Self>>,
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError>;
}

/// A contact at a load, or the critical state.
pub(super) enum Reached<C> {
    Contact(C),
    Critical(Critical<C>),
}

impl<C> Reached<C> {
    pub(super) fn contact(&self) -> &C {
        match self {
            Self::Contact(contact) => contact,
            Self::Critical(critical) => &critical.contact,
        }
    }

    /// Where the floor is touched in the critical state, m.
    pub(super) fn floor_contact(&self) -> Option<Point> {
        match self {
            Self::Contact(_) => None,
            Self::Critical(critical) => Some(critical.floor_contact),
        }
    }
}

/// Files to save, and warnings about them.
#[derive(Default)]
pub(super) struct Saved {
    pub(super) files: Vec<File>,
    pub(super) warnings: Vec<String>,
}

/// What was asked about, and how.
pub(super) struct Context<'a, K> {
    pub(super) case: &'a K,
    pub(super) details: &'a Details,
    /// s.
    pub(super) wall_time: f64,
}

/// The answer to one question, in every form in which it is wanted.
pub(super) trait Found<K: Kind> {
    /// The question in words.
    fn question(&self) -> String;

    /// The numbers; of a loading one record for every state.
    fn records(&self, case: &K) -> Vec<Record>;

    /// Whether the numbers are to be relied on.
    fn is_answer(&self) -> bool;

    /// Why not.
    fn problem(&self) -> Option<String>;

    fn json(&self, of: &Context<'_, K>) -> String;

    fn text(&self, of: &Context<'_, K>) -> String;

    fn limits(&self, of: &Context<'_, K>) -> Vec<Limit>;

    fn warnings(
        &self,
        of: &Context<'_, K>,
        running: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError>;

    fn files(
        &self,
        case: &K,
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError>;
}
