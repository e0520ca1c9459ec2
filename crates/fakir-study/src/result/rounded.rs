//! The contact with pillars that have rounded tops.

use super::{indenter_name, warnings_of};
use crate::VERSION;
use crate::numbers::{LENGTH_DIGITS, significant, with_unit};
use crate::table::{Column, Table, Values};
use fakir::problem::{Cap, CapField};
use fakir::state::{CapContact, CapState, PillarStatus};
use fakir_case::unit::Dimension;
use serde::Serialize;

/// Part of the radius of curvature up to which a contact on a rounded top counts as small.
const SMALL_CONTACT: f64 = 0.3;

/// What contacts with rounded tops leave out.
const LEFT_OUT: [&str; 2] = ["floor", "adhesion"];

/// A contact with rounded pillar tops: what `fakir press --json` prints for it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
pub struct RoundedPressSummary {
    method: &'static str,
    tops: &'static str,
    indenter: &'static str,
    force_N: f64,
    indentation_m: f64,
    contact_area_m2: f64,
    /// None under a plate.
    contact_radius_m: Option<f64>,
    pillars: usize,
    pillars_in_contact: usize,
    /// Those whose top is in contact up to the rim.
    pillars_fully_in_contact: usize,
    largest_top_contact_radius_m: f64,
    largest_pillar_force_N: f64,
    stiffness_N_per_m: f64,
    left_out: [&'static str; 2],
    /// Whether it is certain that the floor is not reached.
    floor_out_of_reach: bool,
    /// None if there is no estimate.
    relative_error_estimate: Option<RoundedErrors>,
    converged: bool,
    /// The quantity that is not resolved, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    unresolved: Option<&'static str>,
    iterations: usize,
    wall_time_s: f64,
    fakir_version: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[allow(non_snake_case)] // names end in the symbol of the unit
struct RoundedErrors {
    force: f64,
    contact_area: f64,
    /// Not relative: an indentation counts from a level that may be anywhere.
    indentation_m: f64,
}

impl RoundedPressSummary {
    /// A contact that took so many seconds, of a field whose common pillar has a height (m).
    #[must_use]
    pub fn new(field: &CapField, height: f64, contact: &CapContact, wall_time: f64) -> Self {
        let full = |cap: &&CapState| cap.status == PillarStatus::Full;
        Self {
            method: "spectral",
            tops: "rounded",
            indenter: indenter_name(field.indenter()),
            force_N: contact.force,
            indentation_m: contact.indentation,
            contact_area_m2: contact.area,
            contact_radius_m: contact.contact_radius,
            pillars: contact.caps.len(),
            pillars_in_contact: contact.touched(),
            pillars_fully_in_contact: contact.caps.iter().filter(full).count(),
            largest_top_contact_radius_m: largest(contact, |cap| cap.radius),
            largest_pillar_force_N: largest(contact, |cap| cap.force),
            stiffness_N_per_m: contact.slopes.force_with_indentation,
            left_out: LEFT_OUT,
            floor_out_of_reach: is_out_of_reach(height, contact),
            relative_error_estimate: contact.error.map(|error| RoundedErrors {
                force: error.force,
                contact_area: error.area,
                indentation_m: error.indentation,
            }),
            converged: contact.converged(),
            unresolved: contact.unresolved().map(|it| it.quantity),
            iterations: contact.iterations,
            wall_time_s: wall_time,
            fakir_version: VERSION,
        }
    }
}

fn largest(contact: &CapContact, of: impl Fn(&CapState) -> f64) -> f64 {
    contact.caps.iter().map(of).fold(0.0, f64::max)
}

/// Whether the floor, this far (m) under the level that indentations count from, is certainly not reached: pressure only moves it away.
fn is_out_of_reach(height: f64, contact: &CapContact) -> bool {
    contact.indentation < height
}

/// What is left out, in words.
#[must_use]
pub fn left_out_words(height: f64, contact: &CapContact) -> &'static str {
    if is_out_of_reach(height, contact) {
        "left out: adhesion; the floor is out of reach"
    } else {
        "left out: adhesion, and what the floor bears if it is reached"
    }
}

/// What to be careful about.
#[must_use]
pub fn rounded_warnings(field: &CapField, height: f64, contact: &CapContact) -> Vec<String> {
    let mut words = warnings_of(&[], contact.termination, contact.unresolved());
    if contact.converged() && contact.error.is_none() {
        words.push("the error could not be estimated".to_owned());
    }
    if !is_out_of_reach(height, contact) {
        words.push(format!(
            "the indentation is not below the height of the common pillar, {}: the floor may be reached, and what it bears under rounded tops is left out",
            with_unit(height, Dimension::Length, LENGTH_DIGITS)
        ));
    }
    let pairs = field.caps().iter().zip(&contact.caps);
    let part = pairs.map(|(cap, state): (&Cap, &CapState)| state.radius / cap.top_radius);
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
pub fn rounded_pillars(field: &CapField, height: f64, contact: &CapContact) -> Table {
    let caps = field.caps();
    let numbers = |name: &str, of: &dyn Fn(&Cap, &CapState) -> f64| Column {
        name: name.to_owned(),
        values: Values::Numbers(
            caps.iter()
                .zip(&contact.caps)
                .map(|(cap, state)| Some(of(cap, state)))
                .collect(),
        ),
    };
    let status = contact.caps.iter();
    Table {
        columns: vec![
            numbers("x_m", &|cap, _| cap.apex[0]),
            numbers("y_m", &|cap, _| cap.apex[1]),
            numbers("height_m", &|cap, _| height + cap.raised),
            Column {
                name: "status".to_owned(),
                values: Values::Words(
                    status
                        .map(|cap| Some(cap.status.name().to_owned()))
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
