//! Contacts and cycles of pillars that have rounded tops.

use super::warnings_of;
use crate::numbers::{LENGTH_DIGITS, significant, with_unit};
use crate::record::AsperityAnswer;
use crate::table::{Column, Table, Values};
use fakir::problem::{Asperity, FloorModel};
use fakir::state::{AsperityCycle, AsperityEvent, AsperityLoadStep, AsperityState};
use fakir_case::AsperityCase;
use fakir_case::unit::Dimension;
use serde::Serialize;

/// Ratio of contact radius to radius of curvature up to which a contact on a rounded top is small.
const SMALL_CONTACT: f64 = 0.3;

/// Description of neglected effects.
#[must_use]
pub fn left_out_words(answer: AsperityAnswer<'_>) -> &'static str {
    let adhesive = !answer.field.adhesion().is_none();
    if answer.contact.floor.is_some() && answer.field.adhesion().floor {
        return "tops and floor carry load, both with adhesion";
    }
    match (
        answer.contact.floor.is_some(),
        answer.neglects_floor(),
        adhesive,
    ) {
        (true, _, false) => "left out: adhesion; tops and floor carry load",
        (true, _, true) => "left out: adhesion of the floor; tops and floor carry load",
        (_, false, false) => "left out: adhesion; the floor carries no load",
        (_, false, true) => "the floor carries no load",
        (_, true, false) => "neglected: adhesion, and the load of the floor if it is reached",
        (_, true, true) => "neglected: the load of the floor if it is reached",
    }
}

/// Warnings.
#[must_use]
pub fn asperity_warnings(answer: AsperityAnswer<'_>) -> Vec<String> {
    let AsperityAnswer {
        field,
        height,
        contact,
    } = answer;
    let mut words = warnings_of(&[], contact.termination, contact.unresolved());
    if contact.converged() && contact.error.is_none() {
        words.push("the error could not be estimated".to_owned());
    }
    if let Some(floor) = contact.floor_gap.filter(|floor| floor.gap < 0.0) {
        let why = match field.floor_model() {
            FloorModel::Ignored => "its load is ignored (floor.contact = false)",
            FloorModel::Contact => "its load is not computed",
        };
        words.push(format!(
            "the lens would be {} below the floor: {why}; `transition` gives the load at which the floor is reached",
            with_unit(-floor.gap, Dimension::Length, LENGTH_DIGITS)
        ));
    } else if answer.neglects_floor() {
        let what = if contact.indentation < height {
            "the lowest point of the lens, with the surface lifted by tension, may be further below the level of zero indentation than"
        } else {
            "the indentation is not below"
        };
        words.push(format!(
            "{what} the height of the common pillar, {}: the floor may be reached, and its load is neglected here",
            with_unit(height, Dimension::Length, LENGTH_DIGITS)
        ));
    }
    let pairs = field.asperities().iter().zip(&contact.asperities);
    let part = pairs
        .map(|(asperity, state): (&Asperity, &AsperityState)| state.radius / asperity.top_radius);
    let part = part.fold(0.0, f64::max);
    if part > SMALL_CONTACT {
        words.push(format!(
            "a contact is as wide as {} of the radius of curvature of its top: tops are paraboloids here, and above {SMALL_CONTACT} a sphere of that radius \
             has some per cent less area under the same force",
            significant(part, 2)
        ));
    }
    words
}

/// Every pillar of a contact with rounded tops: `pillars.csv`.
#[must_use]
pub fn asperity_pillars(answer: AsperityAnswer<'_>) -> Table {
    let AsperityAnswer {
        field,
        height,
        contact,
    } = answer;
    let asperities = field.asperities();
    let numbers = |name: &str, of: &dyn Fn(&Asperity, &AsperityState) -> f64| Column {
        name: name.to_owned(),
        values: Values::Numbers(
            asperities
                .iter()
                .zip(&contact.asperities)
                .map(|(asperity, state)| Some(of(asperity, state)))
                .collect(),
        ),
    };
    let status = contact.asperities.iter();
    Table {
        columns: vec![
            numbers("x_m", &|asperity, _| asperity.apex[0]),
            numbers("y_m", &|asperity, _| asperity.apex[1]),
            numbers("height_m", &|asperity, _| height + asperity.raised),
            Column {
                name: "status".to_owned(),
                values: Values::Words(
                    status
                        .map(|asperity| Some(asperity.status.name().to_owned()))
                        .collect(),
                ),
            },
            numbers("centre_x_m", &|_, state| state.centre[0]),
            numbers("centre_y_m", &|_, state| state.centre[1]),
            numbers("contact_radius_m", &|_, state| state.radius),
            numbers("force_N", &|_, state| state.force),
            numbers("gap_m", &|_, state| state.gap),
        ],
    }
}

/// A load step of a cycle: a row of `cycle.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct AsperityStepRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// Indentation, m.
    pub indentation_m: f64,
    /// Normal force, N; negative in tension.
    pub force_N: f64,
    /// Area of all contacts, m^2.
    pub contact_area_m2: f64,
    /// Distance of the farthest point in contact from the lens axis, m.
    pub contact_radius_m: f64,
    /// Number of pillars in contact.
    pub pillars_in_contact: usize,
    /// Number of events so far.
    pub events: usize,
}

impl From<&AsperityLoadStep> for AsperityStepRow {
    fn from(step: &AsperityLoadStep) -> Self {
        Self {
            branch: step.branch.name(),
            indentation_m: step.indentation,
            force_N: step.force,
            contact_area_m2: step.contact_area,
            contact_radius_m: step.contact_radius,
            pillars_in_contact: step.pillars_in_contact,
            events: step.events,
        }
    }
}

/// A contact that begins or ends: a row of `events.csv`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end with the symbol of the unit
pub struct AsperityEventRow {
    /// `loading` or `unloading`.
    pub branch: &'static str,
    /// `snap_in` or `release`.
    pub event: &'static str,
    /// Indentation after the event, m.
    pub indentation_m: f64,
    /// Force after the event, N.
    pub force_N: f64,
    /// Number of the pillar, from 0.
    pub pillar: usize,
    /// Its position, m.
    pub x_m: f64,
    /// Its position, m.
    pub y_m: f64,
    /// Radius of the contact after it begins or before it ends, m.
    pub contact_radius_m: f64,
}

impl From<&AsperityEvent> for AsperityEventRow {
    fn from(event: &AsperityEvent) -> Self {
        Self {
            branch: event.branch.name(),
            event: event.kind.name(),
            indentation_m: event.indentation,
            force_N: event.force,
            pillar: event.asperity,
            x_m: event.apex[0],
            y_m: event.apex[1],
            contact_radius_m: event.radius,
        }
    }
}

/// Warnings of a cycle.
#[must_use]
pub fn asperity_cycle_warnings(case: &AsperityCase, cycle: &AsperityCycle) -> Vec<String> {
    let mut words = warnings_of(&[], cycle.termination, cycle.unresolved());
    let of_turn = asperity_warnings(AsperityAnswer::of(case, &cycle.turn));
    words.extend(
        of_turn
            .into_iter()
            .filter(|it| !words.contains(it))
            .collect::<Vec<_>>(),
    );
    words
}
