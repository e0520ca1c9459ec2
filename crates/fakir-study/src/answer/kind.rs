//! The interface of answers for one kind of surface. Each kind has one file, which implements [`Kind`]; everything else is the same for all.

use super::request::{AnswerError, Details, Request, Running};
use crate::approach::{Loadable, unsupported};
use crate::citations::Topic;
use crate::figures::saved;
use crate::output::File;
use crate::provenance::Provenance;
use crate::record::{GradientObject, Record};
use crate::report::state::QuantityList;
use crate::result::csv;
use fakir::problem::{CyclePlan, Interactions, Load, Point, Question, Solver};
use fakir::state::{Critical, Limit, Regime, Run};
use fakir_figure::{Figure, FigureError};
use serde::Serialize;

/// Contacts of cases of this kind.
pub(super) type ContactOf<K> = <<K as Kind>::Problem as Loadable>::Contact;

/// A case of one kind of surface.
pub(super) trait Kind: Clone + 'static {
    /// The system.
    type Problem: Loadable;

    fn problem(&self) -> &Self::Problem;

    fn solver(&self) -> Solver;

    /// `"lens"` or `"plate"`.
    fn indenter(&self) -> &'static str;

    /// Description of the case and of the method, one line each, for the beginning of reports.
    fn lines(&self) -> [String; 2];

    /// Description of the method, for the provenance.
    fn method(&self) -> String;

    /// Description of the method, for the list of references.
    fn cited_as(&self) -> String {
        self.method()
    }

    /// Topics to cite, without those of interactions.
    fn topics(&self, range: Option<f64>) -> Vec<Topic>;

    /// Interactions that do not change the normal contact.
    fn interactions(&self) -> &Interactions;

    /// The case as a case file.
    fn text(&self) -> String;

    /// Refuses requests that the case does not support, before a long computation.
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

    /// Validity limits of a contact; none if the kind has no such limits.
    fn limits(&self, contact: &ContactOf<Self>, range: Option<f64>) -> Option<Vec<Limit>>;

    /// Description of the effects that are not computed, if any.
    fn left_out(&self, _: &ContactOf<Self>) -> Option<&'static str> {
        None
    }

    /// Description of what the indenter meets first.
    fn meets(&self, regime: Regime) -> String;

    /// The quantities of a report, except the limits of the model and the solution.
    fn quantities(&self, found: &Reached<ContactOf<Self>>) -> QuantityList;

    /// Description of the solution: the last row of a report.
    fn solution(&self, list: &mut QuantityList, contact: &ContactOf<Self>, wall_time: f64);

    /// Warnings that need a further computation.
    fn further_warnings(
        &self,
        _: &ContactOf<Self>,
        _: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        Ok(Vec::new())
    }

    /// Tables, maps with a number of points across, and figures of a contact.
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

/// Saves the load steps of a cycle, and their figure if it has enough of them.
pub(super) fn saved_curve<R: Serialize>(
    rows: impl Iterator<Item = R>,
    figure: Result<Figure, FigureError>,
    provenance: &Provenance,
) -> Saved {
    let mut files = vec![csv("cycle.csv", rows)];
    if let Ok(figure) = figure {
        files.extend(saved(figure, provenance));
    }
    Saved {
        files,
        warnings: Vec::new(),
    }
}

/// The case, and the options of the output.
pub(super) struct Context<'a, K> {
    pub(super) case: &'a K,
    pub(super) details: &'a Details,
    /// s.
    pub(super) wall_time: f64,
}

/// The answer to one question, in every output form.
pub(super) trait Found<K: Kind> {
    /// Description of the question.
    fn question(&self) -> String;

    /// Topics to cite in addition to those of the case.
    fn topics(&self) -> Vec<Topic> {
        Vec::new()
    }

    /// The numbers: one record, or one for every state of a loading.
    fn records(&self, case: &K) -> Vec<Record>;

    /// Whether the numbers are reliable.
    fn is_answer(&self) -> bool;

    /// The reason if not.
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
