//! The numbers of contacts and cycles with a flat surface.

use super::contact::{common, common_of_states, load, pull_off, turn};
use super::interactions::{self, Interacting};
use super::loading::LoadingState;
use super::named::{Kind, Named, Recorded};
use fakir::problem::{ContactAreas, FlatSystem, Interactions};
use fakir::state::{FlatContact, FlatCycle};

/// The name of what is pressed: `"lens"` or `"punch"`.
pub(crate) fn flat_indenter_name(system: &FlatSystem) -> &'static str {
    match system.lens().punch_radius() {
        Some(_) => "punch",
        None => "lens",
    }
}

/// Name of the method.
pub(crate) const DISC: &str = "disc";

/// A contact with a flat surface, and its case.
#[derive(Debug, Clone, Copy)]
pub struct FlatAnswer<'a> {
    /// The bodies.
    pub system: &'a FlatSystem,
    /// The contact.
    pub contact: &'a FlatContact,
}

/// Numbers of the disc.
fn disc() -> [Named<FlatContact>; 3] {
    [
        Named::number("contact_area_m2", "contact area", |it: &FlatContact| {
            it.contact_area
        })
        .symbol("A"),
        Named::number(
            "mean_pressure_Pa",
            "force over contact area; 0 without contact",
            FlatContact::mean_pressure,
        ),
        stiffness(),
    ]
}

fn stiffness() -> Named<FlatContact> {
    Named::number_if_any(
        "stiffness_N_per_m",
        "change of the force with the indentation on loading; `null` where it is infinite",
        |it: &FlatContact| Some(it.stiffness).filter(|slope| slope.is_finite()),
    )
}

impl<'a> Recorded for FlatAnswer<'a> {
    const KIND: Kind = Kind::FlatPress;

    fn rows() -> Vec<Named<Self>> {
        let of_contact = |rows: Vec<Named<FlatContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &FlatAnswer<'a>| it.contact))
        };
        let mut rows: Vec<Named<Self>> = vec![
            Named::word("method", "`disc`", |_: &FlatAnswer<'a>| Some(DISC)),
            Named::word(
                "lens_shape",
                "`sphere`, `paraboloid`, `profile` or `punch`",
                |it: &FlatAnswer<'a>| Some(it.system.lens().shape_name()),
            )
            .in_objects(),
        ];
        rows.extend(of_contact(load().into()));
        rows.extend(of_contact(disc().into()));
        rows.extend(of_contact(vec![
            Named::number(
                "pressure_on_axis_Pa",
                "pressure on the lens axis: the largest under a lens without adhesion",
                |it: &FlatContact| it.pressure_on_axis,
            ),
            Named::number(
                "punch_stiffness_N_per_m",
                "change of the force with the indentation at a fixed contact radius: the initial slope on unloading",
                |it: &FlatContact| it.punch_stiffness,
            ),
            Named::number(
                "relative_error_estimate.force",
                "estimated relative error of the force",
                |it: &FlatContact| it.error.force,
            ),
            Named::number(
                "relative_error_estimate.indentation",
                "estimated relative error of the indentation",
                |it: &FlatContact| it.error.indentation,
            ),
            Named::number(
                "relative_error_estimate.contact_radius",
                "estimated relative error of the contact radius",
                |it: &FlatContact| it.error.contact_radius,
            ),
        ]));
        rows.extend(interactions::rows());
        rows.extend(of_contact(common()));
        rows
    }
}

impl<'a> Recorded for LoadingState<FlatAnswer<'a>> {
    const KIND: Kind = Kind::FlatLoading;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = vec![
            Named::number("indentation_m", "indentation", |it: &FlatContact| {
                it.indentation
            })
            .symbol("ζ"),
            Named::number("force_N", "normal force on the lens", |it: &FlatContact| {
                it.force
            })
            .symbol("F"),
            Named::number("contact_radius_m", "contact radius", |it: &FlatContact| {
                it.contact_radius
            })
            .symbol("a"),
        ];
        rows.extend(disc());
        rows.push(Named::number(
            "force_error_estimate",
            "estimated relative error of the force",
            |it: &FlatContact| it.error.force,
        ));
        rows.push(Named::number(
            "contact_radius_error_estimate",
            "estimated relative error of the contact radius",
            |it: &FlatContact| it.error.contact_radius,
        ));
        rows.extend(common_of_states());
        let of_contact = |row: Named<FlatContact>| {
            row.of_part(|it: &LoadingState<FlatAnswer<'a>>| it.answer.contact)
        };
        let mut rows: Vec<Named<Self>> = rows.into_iter().map(of_contact).collect();
        rows.extend(interactions::rows());
        rows
    }
}

impl Recorded for FlatCycle {
    const KIND: Kind = Kind::FlatCycle;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = vec![
            Named::word(
                "drive",
                "`displacement`, `force` or `machine`",
                |it: &FlatCycle| Some(it.plan.drive.name()),
            )
            .in_objects(),
            Named::number(
                "first_contact_indentation_m",
                "indentation after the jump into contact",
                |it: &FlatCycle| it.jump.indentation,
            ),
            Named::number(
                "first_contact_force_N",
                "force after the jump into contact",
                |it: &FlatCycle| it.jump.force,
            ),
        ];
        rows.extend(turn(|it: &FlatCycle| [it.turn.force, it.turn.indentation]));
        rows.push(Named::number(
            "turn_contact_radius_m",
            "contact radius at the end of loading",
            |it: &FlatCycle| it.turn.contact_radius,
        ));
        let meaning = "largest tensile force on unloading, negative; `null` without unloading";
        rows.extend(pull_off(meaning, |it: &FlatCycle| {
            let contact = it.pull_off.as_ref()?;
            Some([contact.force, contact.indentation])
        }));
        rows.extend([
            Named::number_if_any(
                "pull_off_contact_radius_m",
                "contact radius at pull-off",
                |it: &FlatCycle| Some(it.pull_off.as_ref()?.contact_radius),
            ),
            Named::number_if_any(
                "last_release_indentation_m",
                "indentation at which the surfaces detach; `null` without unloading",
                |it: &FlatCycle| it.separation,
            ),
            Named::number_if_any(
                "work_of_separation_J",
                "work against tensile forces during unloading; `null` under a prescribed force, where the lens leaves at once",
                |it: &FlatCycle| it.work_of_separation,
            ),
            Named::number_if_any(
                "hysteresis_J",
                "area of the loop of force over indentation; `null` for a path that is not closed",
                |it: &FlatCycle| it.loop_area,
            ),
            Named::number(
                "relative_error_estimate.turn_force",
                "estimated relative error of the force at the end of loading",
                |it: &FlatCycle| it.turn.error.force,
            ),
            Named::number_if_any(
                "relative_error_estimate.pull_off_force",
                "estimated relative error of the pull-off force",
                |it: &FlatCycle| it.pull_off.as_ref().map(|contact| contact.error.force),
            ),
            Named::number_if_any(
                "relative_error_estimate.hysteresis",
                "estimated relative error of the hysteresis",
                |it: &FlatCycle| it.loop_area.map(|_| it.loop_area_error),
            ),
        ]);
        rows.extend(interactions::rows());
        rows.extend(common());
        rows
    }
}

impl Interacting for FlatAnswer<'_> {
    fn interactions(&self) -> &Interactions {
        self.system.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.contact.areas()
    }
}

impl Interacting for FlatCycle {
    fn interactions(&self) -> &Interactions {
        &self.interactions
    }

    fn areas(&self) -> ContactAreas {
        self.turn.areas()
    }
}
