//! Pillars with rounded tops.

use super::kind::{Kind, Reached, Saved};
use super::request::{AnswerError, Details, Request, Running};
use crate::citations::Topic;
use crate::figures::saved;
use crate::numbers::{LENGTH_DIGITS, digits, seconds, significant};
use crate::provenance::Provenance;
use crate::record::{AsperityAnswer, Record, indenter_name};
use crate::report::asperities::{case_line, method_line};
use crate::report::state::{QuantityList, alone, error_remark};
use crate::result::{asperity_pillars, left_out_words};
use fakir::problem::{Interactions, Solver};
use fakir::state::{AsperityContact, AsperityState, Limit, PillarStatus, Regime, Run};
use fakir_case::AsperityCase;
use fakir_case::unit::Dimension;
use fakir_figure::asperity_map;

impl Kind for AsperityCase {
    type Problem = Self;

    fn problem(&self) -> &Self {
        self
    }

    fn solver(&self) -> Solver {
        Solver::Asperities
    }

    fn indenter(&self) -> &'static str {
        indenter_name(self.field.indenter())
    }

    fn lines(&self) -> [String; 2] {
        [case_line(self), self.method()]
    }

    fn method(&self) -> String {
        method_line(self.accuracy)
    }

    fn interactions(&self) -> &Interactions {
        self.field.interactions()
    }

    fn topics(&self, _: Option<f64>) -> Vec<Topic> {
        vec![Topic::Asperities]
    }

    fn cited_as(&self) -> String {
        "the spectral method on rounded pillar tops".to_owned()
    }

    fn text(&self) -> String {
        self.to_toml()
    }

    fn check(&self, _: &Request, _: &Details, _: &Run<'_>) -> Result<(), AnswerError> {
        Ok(())
    }

    fn record(&self, found: &Reached<AsperityContact>) -> Record {
        Record::of(&AsperityAnswer::of(self, found.contact()))
    }

    fn limits(&self, _: &AsperityContact, _: Option<f64>) -> Option<Vec<Limit>> {
        None
    }

    fn left_out(&self, contact: &AsperityContact) -> Option<&'static str> {
        Some(left_out_words(AsperityAnswer::of(self, contact)))
    }

    fn meets(&self, _: Regime) -> String {
        String::new() // there are no critical states of rounded tops
    }

    fn quantities(&self, found: &Reached<AsperityContact>) -> QuantityList {
        let contact = found.contact();
        let error = contact.error.unwrap_or_default();
        let relative = |error: f64, value: f64| if value > 0.0 { error / value } else { 0.0 };
        let remark = |error: f64| alone(&error_remark(error));
        let depth = relative(error.indentation, contact.indentation.abs());
        let mut list = QuantityList::default();
        list.quantity(
            "force",
            contact.force,
            Dimension::Force,
            digits(error.force),
            remark(error.force),
        )
        .quantity(
            "indentation",
            contact.indentation,
            Dimension::Length,
            digits(depth),
            remark(depth),
        )
        .area(
            "contact area",
            contact.area,
            digits(error.area),
            &remark(error.area),
        );
        if let Some(radius) = contact.contact_radius {
            list.length("contact radius", radius, String::new());
        }
        let full = contact
            .asperities
            .iter()
            .filter(|asperity| asperity.status == PillarStatus::Full);
        let full = match full.count() {
            0 => String::new(),
            full => format!(", {full} of them up to the rim"),
        };
        list.row(
            "pillars in contact",
            contact.touched().to_string(),
            "",
            &format!("of {}{full}", contact.asperities.len()),
        );
        if contact.touched() > 0 {
            let most = |of: fn(&AsperityState) -> f64| {
                contact.asperities.iter().map(of).fold(0.0, f64::max)
            };
            list.length(
                "largest contact on a top",
                most(|asperity| asperity.radius),
                "radius".to_owned(),
            )
            .quantity(
                "largest force on a pillar",
                most(|asperity| asperity.force),
                Dimension::Force,
                LENGTH_DIGITS,
                String::new(),
            )
            .row(
                "stiffness",
                significant(contact.slopes.force_with_indentation, LENGTH_DIGITS),
                "N/m",
                "",
            );
        }
        list
    }

    fn solution(&self, list: &mut QuantityList, contact: &AsperityContact, wall_time: f64) {
        list.row(
            "Newton steps",
            contact.iterations.to_string(),
            "",
            &format!(
                "{}, in {}",
                contact.termination.description(),
                seconds(wall_time)
            ),
        );
    }

    fn files(
        &self,
        found: &Reached<AsperityContact>,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let contact = found.contact();
        let table = asperity_pillars(AsperityAnswer::of(self, contact));
        let mut files = Vec::from_iter(table.some_csv("pillars.csv"));
        files.extend(saved(asperity_map(&self.field, contact), provenance));
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}
