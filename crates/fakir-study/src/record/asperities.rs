//! The numbers of contacts with rounded pillar tops.

use super::contact::{common, load};
use super::interactions::{self, Interacting};
use super::named::{Kind, Named, Recorded};
use super::object::Object;
use super::surface::indenter_name;
use fakir::problem::{AsperityArray, ContactAreas, Interactions};
use fakir::state::{AsperityContact, AsperityErrors, AsperityState, PillarStatus};
use fakir_case::AsperityCase;

/// A contact with rounded tops, and its case.
#[derive(Debug, Clone, Copy)]
pub struct AsperityAnswer<'a> {
    /// The pillars.
    pub field: &'a AsperityArray,
    /// Height of the common pillar, m.
    pub height: f64,
    /// The contact.
    pub contact: &'a AsperityContact,
}

/// Effects that are neglected in contacts with rounded tops.
const LEFT_OUT: &[&str] = &["floor", "adhesion"];

impl<'a> AsperityAnswer<'a> {
    /// A contact of a case.
    #[must_use]
    pub fn of(case: &'a AsperityCase, contact: &'a AsperityContact) -> Self {
        Self {
            field: &case.field,
            height: case.height,
            contact,
        }
    }

    /// Whether the floor, at this depth below the level of zero indentation, is certainly not reached: pressure only moves it away.
    pub(crate) fn floor_is_out_of_reach(&self) -> bool {
        self.contact.indentation < self.height
    }
}

pub(super) fn largest(contact: &AsperityContact, of: impl Fn(&AsperityState) -> f64) -> f64 {
    contact.asperities.iter().map(of).fold(0.0, f64::max)
}

/// Numbers that depend on the contact only.
fn contact() -> Vec<Named<AsperityContact>> {
    let [force, indentation, radius] = load();
    vec![
        force,
        indentation,
        Named::number(
            "contact_area_m2",
            "area of all contacts",
            |it: &AsperityContact| it.area,
        )
        .symbol("A"),
        radius,
        Named::count("pillars", "number of pillars", |it: &AsperityContact| {
            it.asperities.len()
        }),
        Named::count(
            "pillars_in_contact",
            "number of pillars in contact",
            AsperityContact::touched,
        ),
        Named::count(
            "pillars_fully_in_contact",
            "number of pillars whose top is in contact up to the rim",
            |it: &AsperityContact| {
                let full = |asperity: &&AsperityState| asperity.status == PillarStatus::Full;
                it.asperities.iter().filter(full).count()
            },
        ),
        Named::number(
            "largest_top_contact_radius_m",
            "radius of the largest contact on a top",
            |it: &AsperityContact| largest(it, |asperity| asperity.radius),
        ),
        Named::number(
            "largest_pillar_force_N",
            "largest force on a pillar",
            |it: &AsperityContact| largest(it, |asperity| asperity.force),
        ),
        Named::number(
            "stiffness_N_per_m",
            "change of the force with the indentation",
            |it: &AsperityContact| it.slopes.force_with_indentation,
        ),
        Named::words(
            "left_out",
            "effects that are not computed",
            |_: &AsperityContact| LEFT_OUT,
        ),
    ]
}

fn solution() -> Vec<Named<AsperityContact>> {
    let error =
        |of: fn(&AsperityErrors) -> f64| move |it: &AsperityContact| it.error.as_ref().map(of);
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
    rows.extend(common());
    rows.push(Named::count(
        "iterations",
        "solver iterations",
        |it: &AsperityContact| it.iterations,
    ));
    rows
}

/// Method and indenter of rounded tops, for a summary of many contacts.
pub(crate) fn asperity_head(field: &AsperityArray) -> Object {
    Object::of_rows(&head(), field)
}

fn head() -> [Named<AsperityArray>; 3] {
    [
        Named::word("method", "`spectral`", |_: &AsperityArray| Some("spectral")),
        Named::word("tops", "`rounded`", |_: &AsperityArray| Some("rounded")),
        Named::word("indenter", "`lens` or `plate`", |it: &AsperityArray| {
            Some(indenter_name(it.indenter()))
        }),
    ]
}

impl<'a> Recorded for AsperityAnswer<'a> {
    const KIND: Kind = Kind::AsperityPress;

    fn rows() -> Vec<Named<Self>> {
        let of_contact = |rows: Vec<Named<AsperityContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &AsperityAnswer<'a>| it.contact))
        };
        let mut rows: Vec<Named<Self>> = head().map(|row| row.of_part(|it: &Self| it.field)).into();
        rows.extend(of_contact(contact()));
        rows.push(Named::flag(
            "floor_out_of_reach",
            "whether the floor is certainly not reached",
            |it: &Self| it.floor_is_out_of_reach(),
        ));
        rows.extend(interactions::rows());
        rows.extend(of_contact(solution()));
        rows
    }
}

impl Interacting for AsperityAnswer<'_> {
    fn interactions(&self) -> &Interactions {
        self.field.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.contact.areas()
    }
}
