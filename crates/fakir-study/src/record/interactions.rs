//! The numbers of interactions that do not change the normal contact: the one table of what they add to contacts of every kind.
//!
//! Each interaction is a table of the case, a group of these rows in results, and a topic of the references, all of one name. Answers without
//! it do not contain its group.

use super::named::Named;
use super::numbers::Record;
use fakir::problem::{Area, ContactAreas, Interactions, LateralForce};
use fakir::state::{ContactState, CriticalState, Cycle};
use fakir_case::unit::{Dimension, format_quantity};

/// An answer with a contact on which interactions act.
pub(crate) trait Interacting {
    /// The interactions of the case.
    fn interactions(&self) -> &Interactions;

    /// The areas of the contact: at a load, in the critical state, or at the end of the loading of a cycle.
    fn areas(&self) -> ContactAreas;
}

/// The rows of all interactions.
pub(super) fn rows<T: Interacting>() -> Vec<Named<T>> {
    let number = |path, meaning, of: fn(&LateralForce, &ContactAreas) -> Option<f64>| {
        Named::number_if_any(path, meaning, move |it: &T| {
            let friction = it.interactions().friction?;
            let areas = it.areas();
            of(&friction.lateral_force(&areas), &areas)
        })
    };
    let rows = vec![
        number(
            "friction.lateral_force_N",
            "lateral force of the sliding contact, τ_tops A_tops + τ_floor A_floor; of a cycle at the end of loading; `friction` is there only with shear stresses in the case; `null` if the floor is reached and its area not computed",
            |lateral, _| lateral.force,
        )
        .symbol("Q"),
        number(
            "friction.tops_force_N",
            "part of the pillar tops, or of the whole contact on a surface without a floor",
            |lateral, _| Some(lateral.tops),
        )
        .decides(),
        number(
            "friction.floor_force_N",
            "part of the floor",
            |lateral, _| lateral.floor,
        ),
        number(
            "friction.floor_share",
            "part of the floor over the lateral force",
            |lateral, _| {
                let force = lateral.force.filter(|force| *force > 0.0);
                Some(lateral.floor? / force?)
            },
        ),
        number(
            "friction.tops_contact_area_m2",
            "contact area on pillar tops, or the whole one on a surface without a floor",
            |_, areas| Some(areas.tops.value),
        )
        .symbol("A_tops")
        .always(),
        number(
            "friction.floor_contact_area_m2",
            "contact area on the floor; `null` on a surface without a floor, and where the floor is reached and its area not computed",
            |_, areas| Some(areas.floor?.value),
        )
        .symbol("A_floor"),
        number(
            "friction.relative_error_estimate.lateral_force",
            "estimated relative error of the lateral force, from those of both areas; the shear stresses count as exact",
            |lateral, _| {
                let (error, force) = (lateral.error?, lateral.force?);
                Some(if force > 0.0 { error / force } else { 0.0 })
            },
        ),
        number(
            "friction.relative_error_estimate.tops_contact_area",
            "estimated relative error of the contact area on tops",
            |_, areas| areas.tops.relative_error(),
        ),
        number(
            "friction.relative_error_estimate.floor_contact_area",
            "estimated relative error of the contact area on the floor",
            |_, areas| areas.floor.as_ref().and_then(Area::relative_error),
        ),
    ];
    rows.into_iter().map(Named::if_given).collect()
}

/// A line of a report.
pub(crate) struct Line {
    pub(crate) name: &'static str,
    /// `None` if it is not computed.
    pub(crate) value: Option<f64>,
    /// `None` for an area.
    pub(crate) dimension: Option<Dimension>,
    pub(crate) relative_error: Option<f64>,
    pub(crate) remark: String,
}

/// The lines of a report about the interactions of an answer.
pub(crate) fn lines(record: &Record) -> Vec<Line> {
    let number = |name: &str| record.number(&format!("friction.{name}"));
    let error = |name: &str| number(&format!("relative_error_estimate.{name}"));
    let Some(area) = number("tops_contact_area_m2") else {
        return Vec::new();
    };
    let floor = number("floor_contact_area_m2");
    let share = number("floor_share").filter(|share| *share > 0.0);
    let of_area = |name, area, relative_error| Line {
        name,
        value: Some(area),
        dimension: None,
        relative_error,
        remark: String::new(),
    };
    let mut lines = vec![Line {
        name: "lateral force",
        value: number("lateral_force_N"),
        dimension: Some(Dimension::Force),
        relative_error: error("lateral_force"),
        remark: match (number("lateral_force_N"), share) {
            (None, _) => "the contact area on the floor is not computed".to_owned(),
            (Some(_), Some(share)) => format!("{:.1} % on the floor", 100.0 * share),
            (Some(_), None) => String::new(),
        },
    }];
    lines.push(of_area("  area on tops", area, error("tops_contact_area")));
    if let Some(floor) = floor.filter(|area| *area > 0.0) {
        lines.push(of_area(
            "  area on floor",
            floor,
            error("floor_contact_area"),
        ));
    }
    lines
}

/// What the interactions of a case neglect, for reports; empty without any.
pub(crate) fn words(interactions: &Interactions) -> String {
    let stress = |value| format_quantity(value, Dimension::Pressure);
    interactions.friction.map_or_else(String::new, |friction| {
        format!(
            "shear stresses: {} on tops, {} on the floor; they do not change the normal contact\n",
            stress(friction.shear_stress_tops),
            stress(friction.shear_stress_floor)
        )
    })
}

impl<T: Interacting> Interacting for &T {
    fn interactions(&self) -> &Interactions {
        (**self).interactions()
    }

    fn areas(&self) -> ContactAreas {
        (**self).areas()
    }
}

impl Interacting for ContactState {
    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn areas(&self) -> ContactAreas {
        ContactState::areas(self)
    }
}

impl Interacting for CriticalState {
    fn interactions(&self) -> &Interactions {
        self.contact.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.contact.areas()
    }
}

impl Interacting for Cycle {
    fn interactions(&self) -> &Interactions {
        self.turn.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.turn.areas()
    }
}
