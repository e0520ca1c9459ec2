//! The numbers of contacts and cycles with rounded pillar tops.

use super::contact::{
    MayReachFloor, PULL_OFF, common, critical_load, first_contact, floor, floor_errors, load,
    pull_off, turn,
};
use super::interactions::{self, Interacting};
use super::named::{Kind, Named, Recorded};
use super::object::Object;
use super::surface::indenter_name;
use fakir::problem::{AsperityArray, ContactAreas, Interactions, ShapedLens};
use fakir::state::{
    AsperityContact, AsperityCycle, AsperityErrors, AsperityState, Critical, PillarStatus,
};
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

/// The critical state with rounded tops, and its case.
#[derive(Debug, Clone, Copy)]
pub struct AsperityCritical<'a> {
    /// The contact and its case.
    pub answer: AsperityAnswer<'a>,
    /// The critical state.
    pub critical: &'a Critical<AsperityContact>,
}

impl<'a> AsperityCritical<'a> {
    /// The critical state of a case.
    #[must_use]
    pub fn of(case: &'a AsperityCase, critical: &'a Critical<AsperityContact>) -> Self {
        Self {
            answer: AsperityAnswer::of(case, &critical.contact),
            critical,
        }
    }
}

/// Effects that are neglected in contacts with rounded tops whose floor contact is not computed, without adhesion and with it.
const LEFT_OUT: &[&str] = &["floor", "adhesion"];
const LEFT_OUT_WITH_ADHESION: &[&str] = &["floor"];

/// The same where it is computed, and without adhesion in the critical state, in which the floor has no load.
const LEFT_OUT_WITH_FLOOR: &[&str] = &["adhesion"];
const LEFT_OUT_WITH_BOTH: &[&str] = &["adhesion of the floor"];

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

    /// Whether the floor among the pillars is not reached: the smallest gap is not negative. Where that is not computed, it is certain from
    /// the depth of the floor below the level of zero indentation: pressure only moves it away from the lens, whose lowest point is on its axis or, of a tilted plate, above the outermost pillar, and tension lifts it
    /// nowhere by more than the sum of what each contact under tension lifts at its own edge, `2 |F|/(pi E* b)` or less.
    pub(crate) fn floor_is_out_of_reach(&self) -> bool {
        if let Some(beyond) = self.contact.beyond_transition() {
            return !beyond;
        }
        let tensile = self.contact.asperities.iter();
        let tensile = tensile.filter(|asperity| asperity.force < 0.0 && asperity.radius > 0.0);
        let modulus = self.field.reduced_modulus();
        let lifted: f64 = tensile
            .map(|asperity| {
                -2.0 * asperity.force / (std::f64::consts::PI * modulus * asperity.radius)
            })
            .sum();
        let tops = self.field.asperities().iter();
        let depths = tops.map(|asperity| {
            let lens = self.field.indenter().lens();
            lens.map_or(0.0, |lens| -lens.sag(asperity.apex))
        });
        let deepest = depths.fold(0.0, f64::max);
        self.contact.indentation + deepest + lifted < self.height
    }

    /// Whether the load of the floor is neglected: it may be reached, and its contact is not computed.
    pub(crate) fn neglects_floor(&self) -> bool {
        self.contact.on_floor().is_none() && !self.floor_is_out_of_reach()
    }

    /// Effects that are neglected.
    fn left_out(&self) -> &'static [&'static str] {
        if self.field.is_floor_loaded() && self.field.adhesion().floor {
            return &[];
        }
        match (
            self.field.is_floor_loaded(),
            self.field.adhesion().is_none(),
        ) {
            (true, true) => LEFT_OUT_WITH_FLOOR,
            (true, false) => LEFT_OUT_WITH_BOTH,
            (false, true) => LEFT_OUT,
            (false, false) => LEFT_OUT_WITH_ADHESION,
        }
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
            "area of all contacts on tops",
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
        Named::number_if_any(
            "smallest_floor_gap_m",
            "smallest gap between lens and floor; past the transition 0, or negative where the load of the floor is not computed; `null` under a plate and a cylinder, which are closest to it outside the pillars, and where pillars cover all of it",
            |it: &AsperityContact| it.floor_gap.map(|floor| floor.gap),
        ),
        Named::number(
            "stiffness_N_per_m",
            "change of the force with the indentation",
            |it: &AsperityContact| it.slopes.force_with_indentation,
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

fn head() -> [Named<AsperityArray>; 4] {
    [
        Named::word("method", "`spectral`", |_: &AsperityArray| Some("spectral")),
        Named::word("tops", "`rounded`", |_: &AsperityArray| Some("rounded")),
        Named::word("indenter", "`lens` or `plate`", |it: &AsperityArray| {
            Some(indenter_name(it.indenter()))
        }),
        Named::word("lens_shape", "shape of a lens", |it: &AsperityArray| {
            it.indenter().lens().map(ShapedLens::shape_name)
        })
        .in_objects(),
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
        rows.extend(of_contact(floor()));
        rows.push(Named::words(
            "left_out",
            "effects that are not computed",
            |it: &Self| it.left_out(),
        ));
        rows.push(Named::flag(
            "floor_out_of_reach",
            "whether the floor is certainly not reached",
            |it: &Self| it.floor_is_out_of_reach(),
        ));
        rows.extend(interactions::rows());
        rows.extend(of_contact(floor_errors().into()));
        rows.extend(of_contact(solution()));
        rows
    }
}

impl<'a> Recorded for AsperityCritical<'a> {
    const KIND: Kind = Kind::AsperityTransition;

    fn rows() -> Vec<Named<Self>> {
        let of_contact = |rows: Vec<Named<AsperityContact>>| {
            rows.into_iter()
                .map(|row| row.of_part(|it: &AsperityCritical<'a>| &it.critical.contact))
        };
        let mut rows: Vec<Named<Self>> = head()
            .map(|row| row.of_part(|it: &Self| it.answer.field))
            .into();
        let critical = critical_load();
        rows.extend(critical.map(|row| row.of_part(|it: &Self| it.critical)));
        rows.push(
            Named::number(
                "critical_contact_radius_m",
                "the larger of `top_contact_radius_m` and the distance between the lens axis and the floor contact",
                |it: &Self| it.critical.contact_radius(),
            )
            .symbol("a_c"),
        );
        rows.push(Named::number(
            "top_contact_radius_m",
            "distance between the lens axis and the farthest point in contact on a pillar top",
            |it: &Self| it.critical.contact.contact_radius.unwrap_or(0.0),
        ));
        let is_load = |row: &Named<AsperityContact>| {
            ["force_N", "indentation_m", "contact_radius_m"].contains(&row.entry.path)
        };
        rows.extend(of_contact(
            contact().into_iter().filter(|row| !is_load(row)).collect(),
        ));
        rows.push(Named::words(
            "left_out",
            "effects that are not computed",
            |it: &Self| match it.answer.field.adhesion().is_none() {
                true => LEFT_OUT_WITH_FLOOR,
                false => &[],
            },
        ));
        rows.extend(interactions::rows());
        rows.extend(of_contact(solution()));
        rows
    }
}

impl Interacting for AsperityCritical<'_> {
    fn interactions(&self) -> &Interactions {
        self.answer.field.interactions()
    }

    fn areas(&self) -> ContactAreas {
        self.critical.contact.areas()
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

impl Recorded for AsperityCycle {
    const KIND: Kind = Kind::AsperityCycle;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = vec![
            Named::word("method", "`spectral`", |_: &Self| Some("spectral")),
            Named::word(
                "drive",
                "loading mode, the quantity that is constant during a jump: `displacement`, `force` or `machine`",
                |it: &Self| Some(it.plan.drive.name()),
            ),
        ];
        rows.extend(first_contact(|it: &Self| {
            let step = it.load_steps.get(it.first_contact?)?;
            Some([step.indentation, step.force])
        }));
        rows.push(
            Named::number_if_any(
                "zero_load_indentation_m",
                "equilibrium indentation without load",
                |it: &Self| it.zero_load_indentation,
            )
            .in_objects(),
        );
        rows.extend(turn(|it: &Self| [it.turn.force, it.turn.indentation]));
        rows.extend([
            Named::number(
                "turn_contact_area_m2",
                "area of all contacts at the end of loading",
                |it: &Self| it.turn.area,
            ),
            Named::count(
                "turn_pillars_in_contact",
                "pillars in contact at the end of loading",
                |it: &Self| it.turn.touched(),
            ),
        ]);
        rows.extend(pull_off(PULL_OFF, |it: &Self| {
            let contact = it.pull_off.as_ref()?;
            Some([contact.force, contact.indentation])
        }));
        rows.extend([
            Named::number_if_any(
                "pull_off_contact_area_m2",
                "area of all contacts at pull-off",
                |it: &Self| Some(it.pull_off.as_ref()?.area),
            ),
            Named::count_if_any(
                "pull_off_pillars_in_contact",
                "pillars in contact at pull-off",
                |it: &Self| Some(it.pull_off.as_ref()?.touched()),
            ),
            Named::number_if_any(
                "last_release_indentation_m",
                "indentation at which the last pillar detaches; `null` without unloading",
                |it: &Self| it.separation,
            ),
            Named::number_if_any(
                "work_of_separation_J",
                "work against tensile forces during unloading; `null` under a prescribed force, where the lens leaves at once",
                |it: &Self| it.work_of_separation,
            ),
            Named::number_if_any(
                "hysteresis_J",
                "area of the loop of force over indentation; `null` for a path that is not closed",
                |it: &Self| it.loop_area,
            ),
            Named::number(
                "dissipation_J",
                "energy dissipated by all events, summed independently",
                |it: &Self| it.dissipation,
            )
            .in_objects(),
            Named::number_if_any(
                "certificate",
                "relative difference of `dissipation_J` from `hysteresis_J`",
                Self::certificate,
            ),
            Named::number_if_any(
                "relative_error_estimate.turn_force",
                "estimated relative error of the force at the end of loading",
                |it: &Self| it.turn.error.map(|error| error.force),
            ),
            Named::number_if_any(
                "relative_error_estimate.pull_off_force",
                "estimated relative error of the pull-off force",
                |it: &Self| it.pull_off.as_ref().map(|_| it.errors.pull_off_force),
            ),
            Named::number_if_any(
                "relative_error_estimate.hysteresis",
                "estimated relative error of the hysteresis",
                |it: &Self| it.loop_area.map(|_| it.errors.loop_area),
            ),
        ]);
        rows.extend(common());
        rows
    }
}
