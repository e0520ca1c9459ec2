//! Pillars with rounded tops.

use super::cycle::{certificate_words, change_columns, changes};
use super::kind::{Context, Found, Kind, Reached, Saved};
use super::request::{AnswerError, Details, Request, Running};
use crate::citations::Topic;
use crate::fields::FieldMap;
use crate::figures::saved;
use crate::numbers::{LENGTH_DIGITS, digits, seconds, significant, with_unit};
use crate::provenance::Provenance;
use crate::record::{AsperityAnswer, AsperityCritical, GradientObject, Record, indenter_name};
use crate::report::asperities::{case_line, method_line};
use crate::report::state::{QuantityList, adhesion_words, drive_words, range_warnings, remark};
use crate::report::table::table;
use crate::result::{
    AsperityEventRow, AsperityStepRow, asperity_cycle, asperity_cycle_warnings, asperity_pillars,
    csv, json, left_out_words,
};
use fakir::problem::{
    CyclePlan, Feature, Interactions, Load, Point, Question, Solver, UnloadingPoint,
};
use fakir::state::{
    AsperityContact, AsperityCycle, AsperityState, CycleEventKind, Limit, PillarStatus, Regime,
    Run, Solution, SolveError,
};
use fakir_case::AsperityCase;
use fakir_case::unit::Dimension;
use fakir_figure::{asperity_cycle_curve, asperity_map};

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

    fn topics(&self, range: Option<f64>) -> Vec<Topic> {
        Topic::of_asperities(self, range)
    }

    fn cited_as(&self) -> String {
        "the spectral method on rounded pillar tops".to_owned()
    }

    fn text(&self) -> String {
        self.to_toml()
    }

    fn check(&self, request: &Request, details: &Details, _: &Run<'_>) -> Result<(), AnswerError> {
        if let Request::Cycle(plan) = request {
            if self.field.adhesion().is_none() {
                return Err(AnswerError::Refused(
                    "a cycle needs adhesion: give adhesion.work in the case file, or --set adhesion.work=50mJ/m2",
                ));
            }
            if matches!(plan.turn, UnloadingPoint::Critical(_)) {
                let features = Feature::of_asperities(&self.field);
                let answered = Question::Transition.check(self.solver(), &features);
                answered.map_err(SolveError::from)?;
            }
        }
        details.check_range(self.field.adhesion())
    }

    fn with_gradient(
        &self,
        load: Load,
        run: &Run<'_>,
    ) -> Result<(Reached<AsperityContact>, GradientObject), AnswerError> {
        let found = self.gradient(load, run)?;
        let gradient = GradientObject::from(&found.gradient);
        let reached = match found.critical {
            Some(critical) => Reached::Critical(critical),
            None => Reached::Contact(found.gradient.contact),
        };
        Ok((reached, gradient))
    }

    fn cycle(
        &self,
        plan: CyclePlan,
        running: &Running<'_>,
    ) -> Result<Box<dyn Found<Self>>, AnswerError> {
        let cycle = self.field.cycle(plan, self.accuracy, &running.run)?;
        Ok(Box::new(cycle))
    }

    fn record(&self, found: &Reached<AsperityContact>) -> Record {
        match found {
            Reached::Contact(contact) => Record::of(&AsperityAnswer::of(self, contact)),
            Reached::Critical(critical) => Record::of(&AsperityCritical::of(self, critical)),
        }
    }

    fn limits(&self, contact: &AsperityContact, range: Option<f64>) -> Option<Vec<Limit>> {
        Some(contact.limits(&self.field, range))
    }

    fn left_out(&self, contact: &AsperityContact) -> Option<&'static str> {
        Some(left_out_words(AsperityAnswer::of(self, contact)))
    }

    fn meets(&self, regime: Regime) -> String {
        match regime {
            Regime::TopFirst => "the lens rests on rounded tops and just reaches the floor",
            Regime::BottomFirst => "the lens reaches the floor before any pillar",
        }
        .to_owned()
    }

    fn quantities(&self, found: &Reached<AsperityContact>) -> QuantityList {
        quantities_of_tops(found.contact(), found.floor_contact())
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
        points: Option<usize>,
        provenance: &Provenance,
        running: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let contact = found.contact();
        let table = asperity_pillars(AsperityAnswer::of(self, contact));
        let mut files = Vec::from_iter(table.some_csv("pillars.csv"));
        (running.next)("fields");
        if let Some(map) = FieldMap::of_asperities(self, contact, points, &running.run)? {
            files.extend(map.files(provenance));
        }
        files.extend(saved(asperity_map(&self.field, contact), provenance));
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

impl Found<AsperityCase> for AsperityCycle {
    fn question(&self) -> String {
        "loading and unloading with adhesion".to_owned()
    }

    fn records(&self, _: &AsperityCase) -> Vec<Record> {
        vec![Record::of(self)]
    }

    fn is_answer(&self) -> bool {
        Solution::is_answer(self)
    }

    fn problem(&self) -> Option<String> {
        Solution::problem(self)
    }

    fn json(&self, of: &Context<'_, AsperityCase>) -> String {
        let object = asperity_cycle(self, &of.case.field, of.details.range, of.wall_time);
        json(&object)
    }

    fn text(&self, of: &Context<'_, AsperityCase>) -> String {
        let [case, method] = of.case.lines();
        let left_out = left_out_words(AsperityAnswer::of(of.case, &self.turn));
        // A contact that is made grows and recedes continuously.
        let kinds = [CycleEventKind::SnapIn, CycleEventKind::Release];
        let events = self.events.iter().map(|event| (event.kind, event.branch));
        format!(
            "Loading and unloading with adhesion\n{case}\n{}, {}\n{method}; {left_out}\n\n{}\n{}",
            adhesion_words(of.case.field.adhesion()),
            drive_words(self.plan.drive),
            quantities(self, of),
            table(&changes(kinds, &events), &change_columns())
        )
    }

    fn limits(&self, of: &Context<'_, AsperityCase>) -> Vec<Limit> {
        self.turn.limits(&of.case.field, of.details.range)
    }

    fn warnings(
        &self,
        of: &Context<'_, AsperityCase>,
        _: &Running<'_>,
    ) -> Result<Vec<String>, AnswerError> {
        let mut warnings = asperity_cycle_warnings(of.case, self);
        warnings.extend(range_warnings(&self.limits(of)));
        Ok(warnings)
    }

    fn files(
        &self,
        case: &AsperityCase,
        _: Option<usize>,
        provenance: &Provenance,
        _: &Running<'_>,
    ) -> Result<Saved, AnswerError> {
        let mut files = vec![
            csv(
                "cycle.csv",
                self.load_steps.iter().map(AsperityStepRow::from),
            ),
            csv("events.csv", self.events.iter().map(AsperityEventRow::from)),
        ];
        if let Some(pull_off) = &self.pull_off {
            let table = asperity_pillars(AsperityAnswer::of(case, pull_off));
            files.extend(table.some_csv("pull-off-pillars.csv"));
        }
        if let Ok(figure) = asperity_cycle_curve(self) {
            files.extend(saved(figure, provenance));
        }
        files.extend(saved(asperity_map(&case.field, &self.turn), provenance));
        Ok(Saved {
            files,
            warnings: Vec::new(),
        })
    }
}

/// The numbers of a contact with rounded tops in a report, and where it reaches the floor, if it is that of the critical state.
#[must_use]
pub fn quantities_of_tops(contact: &AsperityContact, floor_contact: Option<Point>) -> QuantityList {
    let error = contact.error.unwrap_or_default();
    let relative = |error: f64, value: f64| if value > 0.0 { error / value } else { 0.0 };
    let depth = relative(error.indentation, contact.indentation.abs());
    let mut list = QuantityList::default();
    list.force_and_indentation([[contact.force, error.force], [contact.indentation, depth]])
        .area(
            match contact.floor.is_some() {
                true => "contact area on the tops",
                false => "contact area",
            },
            contact.area,
            digits(error.area),
            &remark(error.area),
        );
    if let Some(radius) = contact.contact_radius {
        list.length("contact radius", radius, String::new());
    }
    if let Some([x, y]) = floor_contact {
        let place = |value: f64| with_unit(value, Dimension::Length, LENGTH_DIGITS);
        let remark = format!("from the lens axis, at x = {}, y = {}", place(x), place(y));
        list.length("floor contact", x.hypot(y), remark);
    }
    if let Some(floor) = contact.floor_gap
        && (floor_contact.is_none() || floor.gap > 0.0)
        && contact.floor.is_none()
    {
        let remark = match (floor_contact, floor.gap < 0.0) {
            (Some(_), _) => "before a top jumps into contact, during which the floor is reached",
            (None, true) => "negative: past the transition, the load of the floor is neglected",
            (None, false) => "",
        };
        list.length("smallest floor gap", floor.gap, remark.to_owned());
    }
    list.floor(contact);
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
        let most =
            |of: fn(&AsperityState) -> f64| contact.asperities.iter().map(of).fold(0.0, f64::max);
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

fn quantities(cycle: &AsperityCycle, of: &Context<'_, AsperityCase>) -> String {
    let mut list = QuantityList::default();
    let first = cycle
        .first_contact
        .and_then(|place| cycle.load_steps.get(place));
    if let Some(step) = first {
        list.length("first contact", step.indentation, String::new())
            .quantity(
                "  force after it",
                step.force,
                Dimension::Force,
                LENGTH_DIGITS,
                String::new(),
            );
    }
    if let Some(indentation) = cycle.zero_load_indentation {
        list.length("at rest without load", indentation, String::new());
    }
    turn_and_pull_off_of_tops(&mut list, cycle);
    if let Some(indentation) = cycle.separation {
        list.length("last release", indentation, String::new());
    }
    list.works(
        cycle.work_of_separation,
        cycle.loop_area,
        cycle.errors.loop_area,
    );
    if let Some(certificate) = cycle.certificate() {
        list.row(
            "certificate",
            certificate_words(certificate),
            "",
            "relative difference from the dissipation of all events",
        );
    }
    let limits = cycle.turn.limits(&of.case.field, of.details.range);
    list.range(&limits).model(&limits);
    list.row(
        "load steps",
        cycle.load_steps.len().to_string(),
        "",
        &format!(
            "{}, in {}",
            cycle.termination.description(),
            seconds(of.wall_time)
        ),
    );
    list.text()
}

/// Adds the end of the loading of rounded tops, and the pull-off.
pub fn turn_and_pull_off_of_tops(list: &mut QuantityList, cycle: &AsperityCycle) {
    let turn = &cycle.turn;
    let error = turn.error.unwrap_or_default();
    let turn_remark = match cycle.plan.turn {
        UnloadingPoint::Critical(part) if part >= 1.0 => {
            "critical state: the lens just reaches the floor".to_owned()
        }
        _ => remark(error.force),
    };
    list.state(
        "loaded up to a force of",
        [turn.force, error.force],
        turn.indentation,
        turn_remark,
    )
    .area(
        "  with a contact area of",
        turn.area,
        digits(error.area),
        &remark(error.area),
    )
    .row(
        "  with pillars in contact",
        turn.touched().to_string(),
        "",
        &format!("of {}", turn.asperities.len()),
    );
    if let Some(pull_off) = &cycle.pull_off {
        let error = cycle.errors.pull_off_force;
        list.state(
            "pull-off force",
            [pull_off.force, error],
            pull_off.indentation,
            remark(error),
        )
        .row(
            "  with pillars in contact",
            pull_off.touched().to_string(),
            "",
            "",
        );
    }
}
