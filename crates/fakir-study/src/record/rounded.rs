//! The numbers of contacts with rounded pillar tops.

use super::contact::{ending, load};
use super::named::{Kind, Named, Recorded};
use super::object::Object;
use super::surface::indenter_name;
use fakir::problem::CapField;
use fakir::state::{CapContact, CapErrors, CapState, PillarStatus};
use fakir_case::RoundedCase;

/// A contact with rounded tops, and what was asked about.
#[derive(Debug, Clone, Copy)]
pub struct RoundedAnswer<'a> {
    /// The pillars.
    pub field: &'a CapField,
    /// Height of the common pillar, m.
    pub height: f64,
    /// The contact.
    pub contact: &'a CapContact,
}

/// What contacts with rounded tops leave out.
const LEFT_OUT: &[&str] = &["floor", "adhesion"];

impl<'a> RoundedAnswer<'a> {
    /// A contact of a case.
    #[must_use]
    pub fn of(case: &'a RoundedCase, contact: &'a CapContact) -> Self {
        Self {
            field: &case.field,
            height: case.height,
            contact,
        }
    }

    /// Whether the floor, this far under the level that indentations count from, is certainly not reached: pressure only moves it away.
    pub(crate) fn floor_is_out_of_reach(&self) -> bool {
        self.contact.indentation < self.height
    }
}

pub(super) fn largest(contact: &CapContact, of: impl Fn(&CapState) -> f64) -> f64 {
    contact.caps.iter().map(of).fold(0.0, f64::max)
}

/// What is known of the contact alone.
fn contact() -> Vec<Named<CapContact>> {
    let [force, indentation, radius] = load();
    vec![
        force,
        indentation,
        Named::number(
            "contact_area_m2",
            "area of all contacts",
            |it: &CapContact| it.area,
        )
        .symbol("A"),
        radius,
        Named::count("pillars", "number of pillars", |it: &CapContact| {
            it.caps.len()
        }),
        Named::count(
            "pillars_in_contact",
            "number of pillars in contact",
            CapContact::touched,
        ),
        Named::count(
            "pillars_fully_in_contact",
            "number of pillars whose top is in contact up to the rim",
            |it: &CapContact| {
                let full = |cap: &&CapState| cap.status == PillarStatus::Full;
                it.caps.iter().filter(full).count()
            },
        ),
        Named::number(
            "largest_top_contact_radius_m",
            "radius of the largest contact on a top",
            |it: &CapContact| largest(it, |cap| cap.radius),
        ),
        Named::number(
            "largest_pillar_force_N",
            "largest force on a pillar",
            |it: &CapContact| largest(it, |cap| cap.force),
        ),
        Named::number(
            "stiffness_N_per_m",
            "change of the force with the indentation",
            |it: &CapContact| it.slopes.force_with_indentation,
        ),
        Named::words(
            "left_out",
            "effects that are not computed",
            |_: &CapContact| LEFT_OUT,
        ),
    ]
}

fn solution() -> Vec<Named<CapContact>> {
    let error = |of: fn(&CapErrors) -> f64| move |it: &CapContact| it.error.as_ref().map(of);
    let mut rows = vec![
        Named::number_if_any(
            "relative_error_estimate.force",
            "estimated relative error of the force, from a pressure of higher degree and from ovals that are treated as discs; the whole object is `null` if there is no estimate",
            error(|it| it.force),
        )
        .decides(),
        Named::number_if_any(
            "relative_error_estimate.contact_area",
            "estimated relative error of the contact area",
            error(|it| it.area),
        )
        .always(),
        Named::number_if_any(
            "relative_error_estimate.indentation_m",
            "estimated error of the indentation, not relative: it counts from a level that may be anywhere",
            error(|it| it.indentation),
        )
        .always(),
    ];
    rows.extend(ending());
    rows.push(Named::count(
        "iterations",
        "solver iterations",
        |it: &CapContact| it.iterations,
    ));
    rows
}

/// Method and indenter of rounded tops, for a summary of many contacts.
pub(crate) fn rounded_head(field: &CapField) -> Object {
    Object::of_rows(&head(), field)
}

fn head() -> [Named<CapField>; 3] {
    [
        Named::word("method", "`spectral`", |_: &CapField| Some("spectral")),
        Named::word("tops", "`rounded`", |_: &CapField| Some("rounded")),
        Named::word("indenter", "`lens` or `plate`", |it: &CapField| {
            Some(indenter_name(it.indenter()))
        }),
    ]
}

impl<'a> Recorded for RoundedAnswer<'a> {
    const KIND: Kind = Kind::RoundedPress;

    fn rows() -> Vec<Named<Self>> {
        let of_contact = |rows: Vec<Named<CapContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &RoundedAnswer<'a>| it.contact))
        };
        let mut rows: Vec<Named<Self>> = head().map(|row| row.of_part(|it: &Self| it.field)).into();
        rows.extend(of_contact(contact()));
        rows.push(Named::flag(
            "floor_out_of_reach",
            "whether the floor is certainly not reached",
            |it: &Self| it.floor_is_out_of_reach(),
        ));
        rows.extend(of_contact(solution()));
        rows
    }
}
