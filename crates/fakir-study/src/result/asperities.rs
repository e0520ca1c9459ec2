//! The contact with pillars that have rounded tops.

use super::warnings_of;
use crate::numbers::{LENGTH_DIGITS, significant, with_unit};
use crate::record::AsperityAnswer;
use crate::table::{Column, Table, Values};
use fakir::problem::Asperity;
use fakir::state::AsperityState;
use fakir_case::unit::Dimension;

/// Ratio of contact radius to radius of curvature up to which a contact on a rounded top is small.
const SMALL_CONTACT: f64 = 0.3;

/// Description of neglected effects.
#[must_use]
pub fn left_out_words(answer: AsperityAnswer<'_>) -> &'static str {
    if answer.floor_is_out_of_reach() {
        "left out: adhesion; the floor is out of reach"
    } else {
        "neglected: adhesion, and the load of the floor if it is reached"
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
    if !answer.floor_is_out_of_reach() {
        words.push(format!(
            "the indentation is not below the height of the common pillar, {}: the floor may be reached, and its load is neglected with rounded tops",
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
