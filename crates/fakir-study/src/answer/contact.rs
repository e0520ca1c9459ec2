//! A contact at a load, or the critical state, of a case of any kind.

use super::kind::{ContactOf, Context, Found, Kind, Reached, Saved};
use super::request::{AnswerError, Details, Running};
use crate::approach::Loadable;
use crate::provenance::Provenance;
use crate::record::{GradientObject, Record, interactions};
use crate::report::state::{range_warnings, with_derivatives};
use crate::result::{control_words, json};
use fakir::problem::Load;
use fakir::state::{Limit, Run, Solution};

/// A contact or a critical state.
struct Pressed<C> {
    load: Load,
    reached: Reached<C>,
    gradient: Option<GradientObject>,
}

/// The contact of a case at a load, or its critical state.
pub(super) fn contact<K: Kind>(
    case: &K,
    load: Load,
    details: &Details,
    run: &Run<'_>,
) -> Result<Box<dyn Found<K>>, AnswerError> {
    let (reached, gradient) = if details.gradient {
        let (reached, gradient) = case.with_gradient(load, run)?;
        (reached, Some(gradient))
    } else if matches!(load, Load::FloorContact) {
        (Reached::Critical(case.problem().transition(run)?), None)
    } else {
        (Reached::Contact(case.problem().press(load, run)?), None)
    };
    Ok(Box::new(Pressed {
        load,
        reached,
        gradient,
    }))
}

impl<K: Kind> Found<K> for Pressed<ContactOf<K>> {
    fn question(&self) -> String {
        control_words(self.load)
    }

    fn records(&self, case: &K) -> Vec<Record> {
        vec![case.record(&self.reached)]
    }

    fn is_answer(&self) -> bool {
        self.reached.contact().is_answer()
    }

    fn problem(&self) -> Option<String> {
        self.reached.contact().problem()
    }

    fn json(&self, of: &Context<'_, K>) -> String {
        let object = of.case.record(&self.reached).object();
        let limits = of.case.limits(self.reached.contact(), of.details.range);
        let object = match limits {
            Some(limits) => object.with_limits(limits),
            None => object,
        };
        json(
            &object
                .with_gradient(self.gradient.clone())
                .timed(of.wall_time),
        )
    }

    fn text(&self, of: &Context<'_, K>) -> String {
        let (case, contact) = (of.case, self.reached.contact());
        let heading = match &self.reached {
            Reached::Contact(_) => "Contact under load".to_owned(),
            Reached::Critical(critical) => {
                format!("Critical state: {}", case.meets(critical.regime))
            }
        };
        let [of_case, method] = case.lines();
        let left_out = case
            .left_out(contact)
            .map_or(String::new(), |words| format!("; {words}"));
        let mut list = case.quantities(&self.reached);
        list.interactions(&case.record(&self.reached));
        if let Some(limits) = case.limits(contact, of.details.range) {
            list.range(&limits).model(&limits);
        }
        case.solution(&mut list, contact, of.wall_time);
        let text = format!(
            "{heading}\n{of_case}\n{method}{left_out}\n{}\n{}",
            interactions::words(case.interactions()),
            list.text()
        );
        with_derivatives(text, self.gradient.as_ref())
    }

    fn limits(&self, of: &Context<'_, K>) -> Vec<Limit> {
        let limits = of.case.limits(self.reached.contact(), of.details.range);
        limits.unwrap_or_default()
    }

    fn warnings(
        &self,
        of: &Context<'_, K>,
        running: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        let contact = self.reached.contact();
        let mut warnings = of.case.problem().warnings(contact);
        warnings.extend(range_warnings(&self.limits(of)));
        if let Reached::Contact(contact) = &self.reached {
            warnings.extend(of.case.further_warnings(contact, running)?);
        }
        Ok(warnings)
    }

    fn files(
        &self,
        case: &K,
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        case.files(&self.reached, points, provenance, running)
    }
}
