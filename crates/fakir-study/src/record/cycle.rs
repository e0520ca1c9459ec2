//! The numbers of cycles of loading and unloading.

use super::{Kind, Named, Recorded};
use fakir::problem::Method;
use fakir::state::{Critical, Cycle, CycleError, CycleStation, HeldFloor};
use fakir::theory::adhesion::kendall_pull_off;

/// The errors of one figure, which a cycle may not have.
macro_rules! errors {
    ($figure:literal, $of:expr) => {{
        let of: fn(&Cycle) -> Option<CycleError> = $of;
        [
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".numerical"),
                concat!(
                    "estimated relative error of the numerical solution of `",
                    $figure,
                    "`: the sum of the next three; the whole object is `null` where the cycle has no such figure"
                ),
                move |it: &Cycle| Some(of(it)?.numerical()),
            )
            .column(concat!("relative_error_estimate_", $figure))
            .decides(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".levels"),
                "of that from the levels at which fronts on pillar tops stop",
                move |it: &Cycle| Some(of(it)?.levels),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".rim_angles"),
                "of that from the angles at which rims are looked at",
                move |it: &Cycle| Some(of(it)?.rim_angles),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".degree"),
                "of that from the degree of the pressure on pillar tops",
                move |it: &Cycle| Some(of(it)?.degree),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model"),
                "estimated relative error of the model: the sum of the next two",
                move |it: &Cycle| Some(of(it)?.model()),
            )
            .column(concat!("relative_model_error_", $figure)),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model_fronts"),
                "of that from the shapes that fronts can take",
                move |it: &Cycle| Some(of(it)?.fronts),
            )
            .in_objects(),
            Named::number_if_any(
                concat!("relative_error_estimate.", $figure, ".model_columns"),
                "of that from pillars that lean where they are pulled on one side, which columns do not",
                move |it: &Cycle| Some(of(it)?.columns),
            )
            .in_objects(),
        ]
    }};
}

/// Pull-off force of one pillar with a flat top alone (Kendall), N, negative.
fn kendall(cycle: &Cycle) -> f64 {
    let system = &cycle.system;
    let radius = 0.5 * system.pillar().diameter;
    kendall_pull_off(
        system.reduced_modulus(),
        radius,
        system.adhesion().receding(),
    )
}

/// What it takes to part the largest area of tops that was in contact, J.
fn parting(cycle: &Cycle) -> f64 {
    let areas = cycle.stations.iter().map(|station| station.contact_area);
    cycle.system.adhesion().receding() * areas.fold(0.0, f64::max)
}

fn first_contact(cycle: &Cycle) -> Option<&CycleStation> {
    cycle.stations.get(cycle.first_contact?)
}

/// The floor after the jump onto it, and the state then.
fn jump(cycle: &Cycle) -> Option<(&CycleStation, HeldFloor)> {
    cycle.floor?;
    let [_, after] = cycle.floor_jump()?;
    Some((after, after.floor?))
}

fn loading() -> Vec<Named<Cycle>> {
    vec![
        Named::number_if_any(
            "first_contact_indentation_m",
            "indentation at the first touch",
            |it: &Cycle| Some(first_contact(it)?.indentation),
        )
        .in_objects(),
        Named::number_if_any(
            "first_contact_force_N",
            "force after the first touch",
            |it: &Cycle| Some(first_contact(it)?.force),
        )
        .in_objects(),
        Named::number_if_any(
            "zero_load_indentation_m",
            "where a lens without load comes to rest",
            |it: &Cycle| it.zero_load_indentation,
        )
        .in_objects(),
        Named::number_if_any(
            "critical_force_N",
            "critical force; none, as all of the critical state, if the lens does not go down so far",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.force),
        )
        .symbol("F_c"),
        Named::number_if_any(
            "critical_indentation_m",
            "critical indentation",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.indentation),
        )
        .symbol("ζ_c"),
        Named::number_if_any(
            "critical_contact_radius_m",
            "critical contact radius",
            |it: &Cycle| it.critical.as_ref().map(Critical::contact_radius),
        )
        .symbol("a_c"),
        Named::count_if_any(
            "critical_pillars_in_contact",
            "pillars in contact in the critical state",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.pillars_in_contact),
        )
        .in_objects(),
        Named::count_if_any(
            "critical_pillars_partially_in_contact",
            "those of them that are in contact in part",
            |it: &Cycle| Some(it.critical.as_ref()?.contact.pillars_partially_in_contact),
        )
        .in_objects(),
        Named::number("turn_force_N", "force where the loading ended", |it: &Cycle| {
            it.turn.force
        }),
        Named::number(
            "turn_indentation_m",
            "indentation where the loading ended",
            |it: &Cycle| it.turn.indentation,
        ),
        Named::number(
            "turn_contact_radius_m",
            "contact radius where the loading ended",
            |it: &Cycle| it.turn.contact_radius,
        )
        .in_objects(),
        Named::count(
            "turn_pillars_in_contact",
            "pillars in contact where the loading ended",
            |it: &Cycle| it.turn.pillars_in_contact,
        ),
        Named::count(
            "turn_pillars_partially_in_contact",
            "those of them that are in contact in part",
            |it: &Cycle| it.turn.pillars_partially_in_contact,
        )
        .in_objects(),
        Named::flag(
            "stopped_by_floor",
            "whether the floor ended the loading before what was asked for",
            |it: &Cycle| it.stopped_by_floor,
        )
        .in_objects(),
    ]
}

fn unloading() -> Vec<Named<Cycle>> {
    vec![
        Named::number_if_any(
            "pull_off_force_N",
            "the largest pull of the unloading, a negative force; none if nothing pulls",
            |it: &Cycle| Some(it.pull_off.as_ref()?.force),
        ),
        Named::number_if_any(
            "pull_off_indentation_m",
            "indentation at pull-off",
            |it: &Cycle| Some(it.pull_off.as_ref()?.indentation),
        ),
        Named::count_if_any(
            "pull_off_pillars_in_contact",
            "pillars in contact at pull-off",
            |it: &Cycle| Some(it.pull_off.as_ref()?.pillars.len()),
        ),
        Named::number(
            "kendall_pull_off_force_N",
            "pull-off force of one pillar with a flat top alone (Kendall)",
            kendall,
        ),
        Named::number_if_any(
            "normalized_pull_off_force",
            "the pull-off force over that: how many pillars would pull as much, each alone",
            |it: &Cycle| Some(it.pull_off.as_ref()?.force / kendall(it)),
        ),
        Named::number_if_any(
            "last_release_indentation_m",
            "where the last pillar was released; none if something is still in contact",
            |it: &Cycle| it.separation,
        ),
        Named::number(
            "work_of_separation_J",
            "work done against the pull of the pillars while the lens was withdrawn",
            |it: &Cycle| it.work_of_separation,
        ),
        Named::number_if_any(
            "hysteresis_J",
            "area of the loop of force over indentation; none of a path that is not closed",
            |it: &Cycle| it.certificate().map(|_| it.loop_area),
        ),
        Named::number_if_any(
            "normalized_hysteresis",
            "that over the receding work of adhesion times the largest area of tops that was in contact; 2 (1 + κ) for flat pillars that come off one by one",
            |it: &Cycle| it.certificate().map(|_| it.loop_area / parting(it)),
        ),
        Named::number(
            "dissipation_J",
            "what all events dissipate, summed up apart",
            |it: &Cycle| it.dissipation,
        )
        .in_objects(),
        Named::number_if_any(
            "certificate",
            "relative difference of `dissipation_J` from `hysteresis_J`",
            Cycle::certificate,
        ),
        Named::number(
            "kendall_strain",
            "the pull on a pillar at its release over the modulus of the substrate",
            |it: &Cycle| it.system.kendall_strain(),
        ),
    ]
}

/// Of a floor that sticks, in tables: the object `floor` says more.
fn stuck_floor() -> [Named<Cycle>; 10] {
    [
        Named::flag(
            "floor_is_coarse",
            "whether cells of a floor that sticks are so coarse that its figures are orders of magnitude",
            |it: &Cycle| it.floor.is_some_and(|floor| floor.is_coarse()),
        ),
        Named::number_if_any(
            "jump_force_N",
            "force after the jump onto a floor that sticks",
            |it: &Cycle| Some(jump(it)?.0.force),
        ),
        Named::number_if_any(
            "jump_floor_area_m2",
            "area of the floor in contact after the jump",
            |it: &Cycle| Some(jump(it)?.1.area),
        ),
        Named::number_if_any(
            "jump_front_radius_m",
            "distance of its farthest point from the lens axis",
            |it: &Cycle| Some(jump(it)?.1.radius),
        ),
        Named::count_if_any(
            "jump_holes",
            "middles between three pillars that are in contact then",
            |it: &Cycle| Some(jump(it)?.1.holes),
        ),
        Named::number_if_any(
            "floor_lost_indentation_m",
            "indentation of the last state with the floor in contact; none if it still is",
            |it: &Cycle| Some(it.floor_lost()?[0].indentation),
        ),
        Named::number_if_any("floor_lost_force_N", "force in that state", |it: &Cycle| {
            Some(it.floor_lost()?[0].force)
        }),
        Named::number_if_any(
            "relative_error_estimate_jump_force",
            "estimated relative error of the force after the jump",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.jump_force)),
        ),
        Named::number_if_any(
            "relative_error_estimate_jump_floor_area",
            "estimated relative error of the area after the jump",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.jump_area)),
        ),
        Named::number_if_any(
            "relative_error_estimate_floor_lost_indentation",
            "estimated relative error of the indentation at which the floor is lost",
            |it: &Cycle| jump(it).and(Some(it.floor?.errors.lost_indentation)),
        ),
    ]
    .map(Named::in_tables)
}

impl Recorded for Cycle {
    const KIND: Kind = Kind::Cycle;

    fn rows() -> Vec<Named<Self>> {
        let mut rows = vec![
            Named::word("method", "`spectral`", |it: &Self| {
                Some(Method::Spectral(it.accuracy).name())
            }),
            Named::number(
                "surface_fraction",
                "part of the surface that is pillar top",
                |it: &Self| it.system.texture().surface_fraction(),
            )
            .symbol("φ"),
            Named::number(
                "pitch_m",
                "distance of neighbouring pillars",
                |it: &Self| it.system.pitch(),
            )
            .symbol("e"),
            Named::number(
                "work_of_adhesion_J_per_m2",
                "energy per area where contact is made",
                |it: &Self| it.system.adhesion().work,
            )
            .symbol("w"),
            Named::number(
                "receding_work_of_adhesion_J_per_m2",
                "energy per area where contact is broken",
                |it: &Self| it.system.adhesion().receding(),
            ),
            Named::word(
                "drive",
                "what is held while contacts snap: `displacement`, `force` or `machine`",
                |it: &Self| Some(it.plan.drive.name()),
            ),
            Named::number_if_any(
                "machine_stiffness_N_per_m",
                "stiffness of the machine, if one drives the lens",
                |it: &Self| it.plan.drive.stiffness(),
            ),
        ];
        rows.extend(loading());
        rows.extend(unloading());
        rows.extend(stuck_floor());
        rows.extend(errors!("critical_force", |it| {
            it.critical.as_ref().map(|_| it.errors.critical_force)
        }));
        rows.extend(errors!("critical_indentation", |it| {
            it.critical.as_ref().map(|_| it.errors.critical_indentation)
        }));
        rows.extend(errors!("pull_off_force", |it| {
            it.pull_off.as_ref().map(|_| it.errors.pull_off_force)
        }));
        rows.extend(errors!("hysteresis", |it| {
            it.certificate().map(|_| it.errors.loop_area)
        }));
        rows.push(
            Named::flag(
                "converged",
                "whether the numbers are the solution",
                Self::converged,
            )
            .in_objects(),
        );
        rows.push(
            Named::word(
                "unresolved",
                "the quantity whose estimated relative error is above 0.5, if there is one: then the command ends with exit status 1",
                |it: &Self| it.unresolved().map(|found| found.quantity),
            )
            .in_objects(),
        );
        rows
    }
}
